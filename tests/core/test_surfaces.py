"""Free space from scans, and how it is shared out to areas."""

import json
from dataclasses import replace

import numpy as np
import pytest

from placecue import Area, LaserScan, Node, Observation, Pose2D, SemanticMap
from placecue.evaluation.surroundings import walls
from placecue.free_space import FREE, OCCUPIED, UNSEEN, FreeSpace, Grid
from placecue.labels.rooms import read_rooms
from placecue.surfaces import with_surfaces

CLASSES = ("kitchen", "office")
ANGLES = np.radians(np.arange(-180, 180, 0.5))


def box_scan(pose, low=(0.0, 0.0), high=(6.0, 4.0)):
    """Return what a scanner sees within a rectangular room."""
    d = np.stack([np.cos(ANGLES + pose.theta), np.sin(ANGLES + pose.theta)])
    at = np.array([pose.x, pose.y])
    with np.errstate(divide="ignore"):
        walls = np.where(
            d > 0, (np.array(high) - at)[:, None] / d, (np.array(low) - at)[:, None] / d
        )
    return LaserScan(ANGLES, walls.min(axis=0), 0.01, 30.0)


def seen(*poses):
    space = FreeSpace()
    for i, pose in enumerate(poses):
        space.observe(Observation(i, pose=pose, scan=box_scan(pose)))
    return space


def state(grid, x, y):
    [(row, column)] = grid.cells_of(np.array([[x, y]]))
    return grid.states[row, column]


def test_a_room_is_free_inside_occupied_at_its_walls_and_unseen_beyond():
    grid = seen(Pose2D(2, 2, 0.3), Pose2D(4, 2.5, 2.0)).grid()
    for x, y in ((0.5, 0.5), (5.5, 3.5), (3.0, 2.0), (0.5, 3.5)):
        assert state(grid, x, y) == FREE
    assert state(grid, 6.05, 2.0) == OCCUPIED
    assert state(grid, 6.3, 2.0) == UNSEEN
    # Beams are followed to a cell before their end: of 20 m of wall 0.1 m may be missing.
    assert 24 - 2 <= (grid.states == FREE).sum() * grid.cell**2 <= 24
    assert grid.frame == "odom"


def test_who_walked_past_vanishes():
    space = seen(Pose2D(2, 2, 0))
    pose = Pose2D(2, 2, 0.5)
    scan = box_scan(pose)
    ranges = np.where(np.abs(scan.angles) < 0.1, 1.0, scan.ranges)
    space.observe(Observation(5, pose=pose, scan=LaserScan(ANGLES, ranges, 0.01, 30.0)))
    where = 2 + np.cos(0.5) * 1.03, 2 + np.sin(0.5) * 1.03
    assert state(space.grid(), *where) == OCCUPIED
    for i in range(1, 5):
        turned = Pose2D(2, 2, 0.5 + i)
        space.observe(Observation(5 + i, pose=turned, scan=box_scan(turned)))
    assert state(space.grid(), *where) == FREE


def test_standing_still_and_other_frames_change_nothing():
    space = seen(Pose2D(2, 2, 0))
    before = space.grid().states
    nonsense = LaserScan(ANGLES, np.full(len(ANGLES), 0.5), 0.01, 30.0)
    for pose in (Pose2D(2.01, 2, 0), Pose2D(4, 2, 0, "map"), Pose2D(np.nan, 0, 0), None):
        space.observe(Observation(9, pose=pose, scan=nonsense))
    np.testing.assert_array_equal(space.grid().states, before)


def test_without_scans_the_way_is_free():
    space = FreeSpace()
    assert space.grid() is None
    for i, x in enumerate(np.arange(0, 5, 0.1)):
        space.observe(Observation(i, pose=Pose2D(x, 0, 0)))
    grid = space.grid()
    # A stadium of 0.25 m around 4.9 m of way.
    expected = 4.9 * 0.5 + np.pi * 0.25**2
    assert (grid.states == FREE).sum() * 0.01 == pytest.approx(expected, rel=0.25)
    assert not (grid.states == OCCUPIED).any()


def two_rooms(door=True):
    """Two rooms of 3 m by 2 m with a doorway of 1 m between them, and a robot's map of them."""
    states = np.full((24, 64), UNSEEN)
    states[2:22, 2:32], states[2:22, 33:63], states[7:17, 32] = FREE, FREE, FREE
    areas = (
        Area(
            0,
            "office",
            0.9,
            probabilities={"office": 0.9, "kitchen": 0.1},
            trajectory=((1.0, 1.2),),
        ),
        Area(
            1,
            "kitchen",
            0.8,
            probabilities={"office": 0.2, "kitchen": 0.8},
            trajectory=((3.4, 1.2),),
        ),
    )
    nodes = (Node(0, 1.0, 1.2, 0), Node(1, 3.25, 1.2, 0, True), Node(2, 3.4, 1.2, 1))
    made = SemanticMap(areas, nodes if door else (nodes[0], nodes[2]), ((0, 2),), CLASSES)
    return made, Grid(states, 0.1, 0.0, 0.0, "odom")


def test_a_door_is_where_rooms_end():
    made = with_surfaces(*two_rooms())
    office, kitchen = made.areas
    assert office.size + kitchen.size == pytest.approx(3 * 2 * 2 + 0.1 * 1.0)
    assert office.size == pytest.approx(6, abs=0.11)
    assert made.at(3.1, 0.3).label == "office"
    assert made.at(3.4, 0.3).label == "kitchen"


def test_a_way_that_is_handed_over_behind_the_door_takes_nothing_there():
    made, grid = two_rooms()
    late = replace(made.areas[0], trajectory=((1.0, 1.2), (3.3, 1.2), (3.6, 0.4)))
    beyond = replace(made.areas[1], trajectory=((3.4, 1.2), (5.0, 1.2)))
    office, kitchen = with_surfaces(replace(made, areas=(late, beyond)), grid).areas
    assert office.size == pytest.approx(6, abs=0.11)
    assert kitchen.size == pytest.approx(6, abs=0.11)


def test_what_lies_between_two_doors_has_its_owner_too():
    made, grid = two_rooms()
    door = replace(made.nodes[1], id=9, x=4.4)
    nook = replace(made.areas[1], id=2, label="office", trajectory=((4.0, 1.2),))
    far = replace(made.areas[1], trajectory=((5.9, 1.2),))
    nodes = (made.nodes[0], made.nodes[1], door, replace(made.nodes[2], x=5.9))
    nodes += (Node(3, 4.0, 1.2, 2),)
    areas = (made.areas[0], far, nook)
    states = grid.states.copy()
    states[2:7, 44:46] = states[17:22, 44:46] = UNSEEN  # a wall with the second door in it
    shared = with_surfaces(SemanticMap(areas, nodes, (), CLASSES), replace(grid, states=states))
    assert shared.at(3.8, 1.2).id == 2
    assert shared.at(5.5, 1.2).id == 1
    bare = SemanticMap(areas, nodes[:-1], (), CLASSES)  # no node: its way is at doors altogether
    assert with_surfaces(bare, replace(grid, states=states)).at(3.8, 1.2).id == 2


def test_hits_where_it_is_free_later_are_no_walls():
    grid = two_rooms()[1]
    points = np.array([[1.0, 1.2], [0.2, 1.2], [2.0, 0.0], [50.0, 50.0]])  # inside, edge, beyond
    np.testing.assert_array_equal(walls(points, grid), points[1:])
    np.testing.assert_array_equal(walls(points, None), points)


def test_without_a_door_who_arrives_first_has_it():
    made = with_surfaces(*two_rooms(door=False))
    # 1.0 and 3.4 are as far from 2.2; the kitchen has 1.1 m of the first room.
    assert made.at(2.0, 1.2).label == "office"
    assert made.at(2.6, 1.2).label == "kitchen"
    assert made.areas[0].size + made.areas[1].size == pytest.approx(12.1)


def test_what_is_too_far_from_all_belongs_to_none():
    made = with_surfaces(*two_rooms(), reach=0.5)
    assert 0 < made.areas[0].size < 1.1
    assert with_surfaces(two_rooms()[0], None) == two_rooms()[0]


def test_where_is_answered_beside_the_surfaces_too():
    made, grid = two_rooms()
    assert made.at(1.0, 1.9).label == "office"  # no surfaces: the way within a metre
    assert made.at(1.0, 2.3) is None
    made = with_surfaces(made, grid)
    assert made.at(0.3, 2.0).label == "office"
    assert made.at(50.0, 50.0) is None


def test_the_map_with_surfaces_is_plain_data_and_can_be_given_back_as_rooms(tmp_path):
    made = with_surfaces(*two_rooms())
    assert SemanticMap.from_json(json.loads(json.dumps(made.to_json()))) == made
    collection = made.to_geojson()
    ids = [feature["id"] for feature in collection["features"]]
    assert len(set(ids)) == len(ids)
    assert (collection["frame"], collection["units"]) == ("odom", "m")
    (tmp_path / "rooms.geojson").write_text(json.dumps(collection))
    rooms = read_rooms(tmp_path / "rooms.geojson")
    assert rooms.classes == CLASSES
    assert (rooms.at(0.5, 0.5), rooms.at(5.5, 0.5), rooms.at(9, 9)) == ("office", "kitchen", None)


def test_a_pose_far_away_makes_no_huge_grid(caplog):
    space = FreeSpace()
    for x in (0.0, 1.0, 2.0, 1000.0, 3.0):
        scan = LaserScan(np.linspace(-1.5, 1.5, 31), np.full(31, 2.0), 0.0, 10.0)
        space.observe(Observation(int(x * 1e9), scan=scan, pose=Pose2D(x, x, 0.0)))
    grid = space.grid()
    assert grid is not None
    assert grid.states.size < 100_000
    assert len(grid.cells_of(np.array([[1.0, 1.0]])))
    assert not len(grid.cells_of(np.array([[1000.0, 1000.0]])))
    assert "lie so far from the others" in caplog.text


def test_a_large_building_is_whole():
    space = FreeSpace()
    for x in np.arange(0.0, 250.0, 5.0):
        space.observe(Observation(int(x * 1e9), pose=Pose2D(float(x), 0.0, 0.0)))
    grid = space.grid()
    assert grid is not None
    ends = np.array([[0.0, 0.0], [245.0, 0.0]])
    assert len(grid.cells_of(ends)) == 2
