import cv2
import numpy as np
import pytest

from placecue import Area, Node, SemanticMap, UsageError
from placecue.evaluation.map_figure import category_styles, cells, draw_semantic_map

CLASSES = ("corridor", "kitchen", "office", "printer")


def map_of(labels, step=1.5):
    areas = tuple(Area(i, label, 1.0) for i, label in enumerate(labels))
    nodes = tuple(Node(i, i * step, 0.0, i) for i in range(len(labels)))
    return SemanticMap(areas, nodes, tuple((i, i + 1) for i in range(len(labels) - 1)), CLASSES)


def pixels(path, colour):
    """Count the pixels of one colour (#RRGGBB) in a picture."""
    picture = cv2.imread(str(path))[..., ::-1]
    wanted = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
    return int((picture == wanted).all(axis=2).sum())


def test_nodes_have_the_colour_of_their_area_s_category(tmp_path):
    styles = category_styles(CLASSES)
    path = draw_semantic_map(map_of(["kitchen", "unknown", "kitchen"]), tmp_path / "map.png")
    legend = draw_semantic_map(map_of([]), tmp_path / "empty.png")
    for label in (*CLASSES, "unknown"):
        more = pixels(path, styles[label][0]) > pixels(legend, styles[label][0])
        assert more == (label in ("kitchen", "unknown"))
        assert pixels(legend, styles[label][0]) > 0  # every category is in the legend


def test_the_picture_is_as_wide_as_asked(tmp_path):
    path = draw_semantic_map(map_of(CLASSES), tmp_path / "deep" / "map.png", size=1600)
    assert max(cv2.imread(str(path)).shape[:2]) == 1600
    assert [p.name for p in path.parent.iterdir()] == ["map.png"]


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_everything_at_once(tmp_path, suffix):
    made = map_of(["office", "strange", "corridor"])
    gateway = Node(3, 0.7, 0.2, 0, gateway=True)
    made = SemanticMap(made.areas, (*made.nodes, gateway), made.edges, CLASSES, "map")
    path = draw_semantic_map(
        made,
        tmp_path / f"map.{suffix}",
        points=np.array([[0.0, 1.0], [np.nan, 2.0], [4.0, -1.0]]),
        truth=[(0.0, 0.0, "office"), (1.0, 0.0, "corridor"), (2.0, 0.0, "elsewhere")],
        title="run 1",
    )
    assert path.stat().st_size > 1000


def test_a_large_map_is_drawn(tmp_path):
    labels = np.random.default_rng(0).choice(CLASSES, 3000).tolist()
    points = np.random.default_rng(1).uniform(0, 100, (200_000, 2))
    assert draw_semantic_map(map_of(labels, 0.05), tmp_path / "map.png", points=points).exists()


def test_an_unwritable_place_is_a_clear_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="cannot write to"):
        draw_semantic_map(map_of([]), tmp_path / "file" / "map.png")


def test_the_suffix_must_be_a_picture_s(tmp_path):
    with pytest.raises(UsageError, match=r"map\.txt.*png"):
        draw_semantic_map(map_of([]), tmp_path / "map.txt")


def test_styles_stay_apart_for_many_categories():
    styles = category_styles([f"class {i}" for i in range(40)])
    assert len(set(styles.values())) == 41
    assert list(category_styles(["unknown", "office"])) == ["office", "unknown"]


def test_one_square_is_drawn_for_the_points_that_share_it():
    points = np.array([[0.01, 0.01], [0.02, -0.02], [0.06, 0.01], [-0.06, 0.01], [np.inf, 0.0]])
    expected = [[-0.05, 0.0], [0.0, 0.0], [0.05, 0.0]]
    np.testing.assert_allclose(cells(points, 0.05), expected, atol=1e-12)
    assert cells(None, 0.05).shape == (0, 2)


def test_background_squares_stand_where_the_points_are(tmp_path):
    wall = np.column_stack([np.linspace(0, 4, 41), np.full(41, 3.0)])
    path = draw_semantic_map(map_of(CLASSES), tmp_path / "map.svg", points=wall)
    assert "<image" in path.read_text()
