import pytest

from placecue import Area, Node, SemanticMap
from placecue_accumulators.same_label import merge_same_label

CLASSES = ("corridor", "kitchen", "office", "printer")


def area(number, label, confidence=1.0, points=1, **scores):
    trajectory = tuple((float(number), float(i)) for i in range(points))
    sure = {"office": confidence, "kitchen": 1 - confidence}
    told = {"margin": 2 * confidence, "probabilities": sure}
    return Area(number, label, confidence, scores, number * 10, number * 10 + 5, trajectory, **told)


def chain(*areas):
    """Areas side by side: one node each, with a gateway of the former between them."""
    nodes, edges = [], []
    for i, one in enumerate(areas):
        nodes += [Node(2 * i, i, 0, one.id), Node(2 * i + 1, i + 0.5, 0, one.id, gateway=True)]
        edges += [(2 * i, 2 * i + 1), (2 * i + 1, 2 * i + 2)]
    return SemanticMap(areas, tuple(nodes[:-1]), tuple(edges[:-2]), CLASSES)


def test_neighbours_of_one_label_become_one():
    first = area(3, "office", 1.0, points=1, office=0.8)
    second = area(5, "office", 0.6, points=3, office=0.4)
    made = merge_same_label(chain(first, second, area(8, "kitchen")))
    assert [a.id for a in made.areas] == [3, 8]
    joined = made.area(3)
    # Weighted by one and three positions.
    assert joined.confidence == pytest.approx((1.0 + 3 * 0.6) / 4)
    assert joined.margin == pytest.approx((2.0 + 3 * 1.2) / 4)
    assert joined.probabilities == pytest.approx({"office": 0.7, "kitchen": 0.3})
    assert joined.scores == {"office": pytest.approx((0.8 + 3 * 0.4) / 4)}
    assert (joined.start, joined.end) == (30, 55)
    assert joined.trajectory == first.trajectory + second.trajectory
    assert [node.area for node in made.nodes] == [3, 3, 3, 3, 8]


def test_equal_labels_apart_stay_apart_and_unknown_is_no_label():
    before = chain(
        area(0, "office"), area(1, "corridor"), area(2, "office"), area(3, "unknown", 0.0),
        area(4, "unknown", 0.0),
    )  # fmt: skip
    assert merge_same_label(before) == before


def test_an_empty_map_stays_empty():
    empty = SemanticMap((), (), (), ())
    assert merge_same_label(empty) == empty


def test_only_areas_without_a_door_between_them_are_merged_if_so_wanted():
    doors = chain(area(0, "office"), area(1, "office"))
    assert merge_same_label(doors, "open") == doors
    assert merge_same_label(doors, "none") == doors
    nodes = (Node(0, 0.0, 0.0, 0), Node(1, 1.0, 0.0, 1))
    open_ = SemanticMap(doors.areas, nodes, ((0, 1),), CLASSES)
    assert [a.id for a in merge_same_label(open_, "open").areas] == [0]
    assert merge_same_label(open_, "none") == open_
