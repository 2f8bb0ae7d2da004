import cv2
import numpy as np
import pytest

from placecue import Area, Node, SemanticMap, UsageError
from placecue.evaluation.map_figure import cells, draw_semantic_map, map_figure
from placecue.evaluation.map_styles import category_styles, shade
from placecue.evaluation.scale_bar import round_length

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


def square(x, y, side, number, label="office", confidence=0.9):
    """Return an area that is a square, with a square hole of a tenth of its side."""
    outline = ((x, y), (x + side, y), (x + side, y + side), (x, y + side))
    a, b = x + 0.45 * side, y + 0.45 * side
    hole = ((a, b), (a, b + side / 10), (a + side / 10, b + side / 10), (a + side / 10, b))
    return Area(number, label, confidence, surface=((outline, hole),))


def boxes(figure):
    """Return the captions of a figure, and the corners of each in the map, by area."""
    axes = figure.axes[0]
    texts = {int(t.get_gid().split("-")[1]): t for t in axes.texts if t.get_gid()}
    back = axes.transData.inverted()
    return {n: (t, back.transform(t.get_window_extent())) for n, t in texts.items()}


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_nodes_have_the_colour_of_their_area_s_category(tmp_path):
    styles = category_styles(CLASSES)
    path = draw_semantic_map(map_of(["kitchen", "unknown", "kitchen"]), tmp_path / "map.png")
    for label in (*CLASSES, "unknown"):
        assert (pixels(path, styles[label][0]) > 0) == (label in ("kitchen", "unknown"))


def test_the_legend_has_what_is_there_only():
    gateway = Node(9, 0.7, 0.2, 0, gateway=True)
    made = map_of(["kitchen", "unknown"])
    assert legend(map_figure(made)) == ["kitchen", "unknown"]
    made = SemanticMap(made.areas, (*made.nodes, gateway), made.edges, CLASSES)
    seen, way = np.array([[0.0, 1.0]]), [(0.0, 0.0, "office")]
    figure = map_figure(made, points=seen, beliefs=way, truth=way)
    others = ["door passed", "seen by the laser", "single belief", "true class (ring)"]
    assert legend(figure) == ["kitchen", "office", "unknown", *others]


def test_areas_are_filled_the_paler_the_less_sure_and_holes_are_not(tmp_path):
    rooms = (square(0, 0, 4, 0, confidence=1.0), square(4, 0, 4, 1, confidence=0.6))
    path = draw_semantic_map(SemanticMap(rooms, (), (), CLASSES), tmp_path / "map.png", size=800)
    counts = [pixels(path, shade(category_styles(CLASSES)["office"][0], c)) for c in (1.0, 0.6)]
    metre = 800 / 10  # 8 m and a margin of a metre on each side, less what axes take
    assert all(0.6 * 15 * metre**2 < count < 15.84 * metre**2 for count in counts)


def test_captions_of_200_areas_lie_inside_them_and_do_not_meet():
    rng = np.random.default_rng(3)
    rooms = [square(3 * (i % 20), 3 * (i // 20), rng.uniform(1.5, 3.0), i) for i in range(200)]
    found = boxes(map_figure(SemanticMap(tuple(rooms), (), (), CLASSES)))
    assert set(found) == set(range(200))
    for number, (_, (low, high)) in found.items():
        corners = np.array(rooms[number].surface[0][0])
        assert (low >= corners.min(axis=0)).all()
        assert (high <= corners.max(axis=0)).all()
    assert {text.get_fontsize() for text, _ in found.values()} <= {12, 10, 8.5, 7, 6}


def test_a_narrow_area_has_its_caption_upright_and_a_tiny_one_none():
    corridor = ((0.0, 0.0), (0.6, 0.0), (0.6, 12.0), (0.0, 12.0))
    hall = Area(0, "corridor", 0.97, surface=((corridor,),))
    tiny, far = square(1, 0, 0.1, 1), square(12, 0, 3, 2)
    found = boxes(map_figure(SemanticMap((hall, tiny, far), (), (), CLASSES), size=900))
    assert set(found) == {0, 2}
    assert [found[n][0].get_rotation() for n in (0, 2)] == [90, 0]
    assert found[0][0].get_text() == "corridor 0  97 %"


def test_areas_without_a_surface_have_captions_that_do_not_meet():
    ways = [tuple((0.1 * i, 0.2 * n) for i in range(100)) for n in range(6)]
    areas = tuple(Area(n, "corridor", 0.9, trajectory=way) for n, way in enumerate(ways))
    found = [box for _, box in boxes(map_figure(SemanticMap(areas, (), (), CLASSES))).values()]
    assert len(found) >= 2
    for i, (low, high) in enumerate(found):
        assert all((low >= b).any() or (high <= a).any() for a, b in found[:i])


def test_areas_of_another_frame_are_not_drawn_and_that_is_said():
    rooms = (square(0, 0, 4, 0), Area(1, "office", 0.9, frame="map", trajectory=((50.0, 0.0),)))
    axes = map_figure(SemanticMap(rooms, (Node(0, 50, 0, 1),), (), CLASSES)).axes[0]
    assert "1 areas in other frames than 'odom'" in axes.get_title()
    assert axes.get_xlim()[1] < 10


@pytest.mark.parametrize(("width", "length"), [(40, 5), (9.9, 1), (10, 2), (3, 0.5), (700, 100)])
def test_the_scale_bar_has_a_round_length(width, length):
    assert round_length(width) == pytest.approx(length)


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
