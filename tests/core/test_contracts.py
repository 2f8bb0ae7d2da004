"""What the methods of components promise: what is right passes, what is wrong is said."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import sparse

from placecue import (
    Area,
    AreaUpdate,
    DescriptorSets,
    LaserScan,
    Node,
    Observation,
    OneAgainstAll,
    OneAgainstOne,
    Pose2D,
    Probabilities,
    Scores,
    SemanticMap,
    contracts,
)
from placecue.camera import PinholeCamera
from placecue.semantic_map import UNKNOWN

CLASSES = ("corridor", "kitchen", "lab", "office")
ROW = sparse.csr_array(np.array([[0.0, 2.0, 1.0]]))
DENSE = np.arange(6.0).reshape(2, 3)
SPARSE = sparse.csr_array(DENSE)
SETS = DescriptorSets(np.ones((3, 8), np.float32), np.array([0, 0, 3]))
OAO = OneAgainstOne(CLASSES)  # six pairs
SIX = np.zeros((2, 6))
PIXELS = np.zeros((4, 5, 3), np.uint8)
SCAN = LaserScan(np.zeros(3), np.ones(3), 0.0, 5.0)
UPDATE = AreaUpdate(1, "lab", 0.5)
MAP = SemanticMap(
    areas=(Area(0, "lab", 0.5),),
    nodes=(Node(0, 0.0, 0.0, 0), Node(1, 1.0, 0.0, 0)),
    edges=((0, 1),),
    classes=CLASSES,
)


def seen(**parts: Any) -> Observation:
    return Observation(**{"stamp": 5, "image": PIXELS, "scan": SCAN, "label": "lab"} | parts)


def strays(index: int) -> sparse.csr_array:
    """Return a row with a number outside its three bins."""
    row = ROW.copy()
    row.indices[0] = index
    return row


RIGHT = [
    ("features", (np.ones(3),)),
    ("features", (np.ones(3, np.float32),)),
    ("features", (np.array([1, 2], np.uint8),)),
    ("features", (ROW,)),
    ("features", (sparse.csr_matrix(DENSE[:1]),)),
    ("features", (np.ones((4, 128), np.float32),)),
    ("features", (np.ones((0, 128), np.float32),)),
    ("features", (np.array([np.nan, 1.0]),)),  # for finite() to say
    ("finite", (np.ones(3),)),
    ("finite", (np.array([1e308, 1e308]),)),  # though their sum is not
    ("finite", (np.array([1, 2], np.int64),)),
    ("finite", (SPARSE,)),
    ("finite", (SETS,)),
    ("batch", (DENSE, 2)),
    ("batch", (SPARSE, 2, SPARSE[[0]])),
    ("batch", (SETS, 2, SETS)),
    ("batch", (DENSE, 2, np.zeros((9, 3)))),
    ("families", (None, DENSE)),
    ("families", (("gaps", "gaps", "size"), DENSE)),
    ("families", (["red", "green", "blue"], SPARSE)),
    ("gram", (DENSE, 2, 3)),
    ("gram", (DENSE.astype(np.float32), 2, 3)),
    ("scaled", (DENSE, (2, 3))),
    ("scores", (Scores(SIX, OAO), 2)),
    ("scores", (Scores(SIX, OAO), 2, OneAgainstOne(CLASSES))),
    ("folds", (np.array([0, 1, -1]), 3, 2)),
    ("folds", (np.array([], np.int64), 0, 2)),
    ("area_update", (None,)),
    ("area_update", (UPDATE,)),
    ("area_update", (AreaUpdate(np.int64(1), UNKNOWN, np.float64(0), True),)),
    ("texts", ([],)),
    ("texts", (["a line"],)),
    ("behind", (None,)),
    ("behind", (1.5,)),
    ("crossing", (None,)),
    ("crossing", (Pose2D(1, np.float64(2), 0.5),)),
    ("pose", (Pose2D(np.nan, 0, 0),)),
    ("semantic_map", (MAP,)),
    ("semantic_map", (SemanticMap((), (), (), ()),)),
    ("observation", (seen(),)),
    ("observation", (Observation(np.int64(5)),)),
    ("observation", (seen(image=PIXELS[..., 0]),)),
    ("observation", (seen(image=lambda: PIXELS),)),
    ("scan", (SCAN,)),
    ("stamp", (10**30,)),  # whether it fits is fits()
    ("text", ("a.mcap",)),
    ("count", (None,)),
    ("count", (0,)),
    ("metadata", ({"run": "1"},)),
    ("metadata", ({},)),
    ("camera", (None,)),
    ("camera", (PinholeCamera(4, 5, 1.0, 1.0, 2.0, 2.0),)),
]


@pytest.mark.parametrize(("name", "arguments"), RIGHT)
def test_what_is_right_passes(name: str, arguments: tuple[Any, ...]) -> None:
    assert getattr(contracts, name)(*arguments) is None


def test_scores_may_have_gaps_where_that_is_allowed() -> None:
    holey = Scores(np.where(np.eye(2, 6), np.nan, 0.0), OAO)
    assert contracts.scores(holey, 2, gaps=True) is None
    assert contracts.scores(holey, 2) == "returned NaN or infinite scores"
    endless = Scores(np.where(np.eye(2, 6), np.inf, 0.0), OAO)
    assert contracts.scores(endless, 2, gaps=True) == "returned infinite scores"


WRONG = [
    ("families", ("gap", DENSE), "is 'gap', not a sequence of names or None"),
    ("families", (3, DENSE), "is 3, not a sequence of names or None"),
    ("families", (("gaps", 1, "size"), DENSE), "is a tuple, not a sequence of names or None"),
    ("families", (["gaps"], DENSE), "names 1 column of 3"),
    ("features", ([1.0],), "returned a list, not a vector, a CSR row or descriptors"),
    ("features", (None,), "returned None, not a vector"),
    ("features", (3.5,), "returned a float, not a vector"),
    ("features", (np.array(["a"], object),), "returned an array of object, not of real numbers"),
    ("features", (np.array(["a"]),), "returned an array of <U1, not of real numbers"),
    ("features", (np.array([1j]),), "returned an array of complex128, not of real numbers"),
    ("features", (np.float64(1) + np.zeros(()),), "returned a float64, not a vector"),
    ("features", (np.zeros(()),), r"returned an array of shape \(\), not a vector"),
    ("features", (np.zeros((1, 2, 3)),), r"returned an array of shape \(1, 2, 3\), not a vector"),
    ("features", (np.zeros(0),), r"returned an array of shape \(0,\), not a vector"),
    ("features", (np.zeros((3, 0)),), r"returned an array of shape \(3, 0\), not a vector"),
    ("features", (SPARSE,), "returned 2 rows for 1 sample"),
    ("features", (ROW.tocsc(),), r"returned a csc_array of shape \(1, 3\), not a CSR array of"),
    ("features", (ROW.tocoo(),), "returned a coo_array"),
    ("features", (SETS,), "returned a DescriptorSets, not"),
    ("features", (strays(3),), "returned a CSR array of 3 bins with indices of others"),
    ("features", (strays(-1),), "returned a CSR array of 3 bins with indices of others"),
    ("finite", (np.array([1.0, np.nan]),), "returned NaN or infinite numbers"),
    ("finite", (np.array([np.inf, -np.inf]),), "returned NaN or infinite numbers"),
    ("finite", (SPARSE * np.inf,), "returned NaN or infinite numbers"),
    ("finite", (replace(SETS, values=SETS.values * np.nan),), "returned NaN or infinite numbers"),
    ("batch", (DENSE[:1], 3), "returned 1 row for 3 samples"),
    ("batch", (SPARSE, 1), "returned 2 rows for 1 sample"),
    ("batch", (SETS, 3), "returned 2 rows for 3 samples"),
    ("batch", (list(DENSE), 2), "returned a list, not a batch of features"),
    ("batch", (DENSE[0], 2), r"returned an array of shape \(3,\)"),
    ("batch", (DENSE.astype(object), 2), "returned an array of object"),
    ("batch", (DENSE, 2, DENSE[:, :2]), "returned features of width 3 where training had 2"),
    ("batch", (DENSE, 2, SPARSE), "returned a dense vector where training had a sparse histogram"),
    ("batch", (replace(SETS, values=SETS.values[0]), 2), "descriptor sets whose values are no arr"),
    ("batch", (replace(SETS, offsets=np.array([0, 2])), 1), "offsets do not part 3 descriptors"),
    ("batch", (replace(SETS, offsets=np.array([0, 4, 3])), 2), "offsets do not part 3 descriptors"),
    ("batch", (replace(SETS, offsets=[0, 0, 3]), 2), "offsets do not part 3 descriptors"),
    ("gram", (DENSE, 3, 2), r"returned an array of shape \(2, 3\), not \(3, 2\)"),
    ("gram", (DENSE.astype(int), 2, 3), "returned an array of int64, not an array of floats"),
    ("gram", (SPARSE, 2, 3), "returned a csr_array, not an array of floats"),
    ("gram", (DENSE * np.nan, 2, 3), "returned NaN or infinite numbers"),
    ("scaled", (DENSE[:, :2], (2, 3)), r"returned an array of shape \(2, 2\), not \(2, 3\)"),
    ("scaled", (None, (2, 3)), "returned None, not an array of floats"),
    ("scores", (SIX, 2), "returned a ndarray, not Scores"),
    ("scores", (Scores(SIX, CLASSES), 2), "returned scores whose layout is a tuple"),
    ("scores", (Scores(SIX[:1], OAO), 3), "returned 1 row for 3 samples"),
    ("scores", (Scores(SIX[:, :4], OAO), 2), r"scores that are an array of shape \(2, 4\), not"),
    ("scores", (Scores(SIX[0], OAO), 1), r"scores that are an array of shape \(6,\), not \(1, 6\)"),
    ("scores", (Scores(SIX.astype(int), OAO), 2), "scores that are an array of int64"),
    ("scores", (Scores(SIX.tolist(), OAO), 2), "scores that are a list"),
    (
        "scores",
        (Scores(SIX[:, :4], OneAgainstAll(CLASSES)), 2, Probabilities(CLASSES)),
        r"layout one_against_all \(corridor, kitchen, lab, office\), not of probabilities \(corr",
    ),
    ("folds", (np.array([0.0, 1.0]), 2, 2), "returned an array of float64, not whole numbers"),
    ("folds", ([0, 1], 2, 2), "returned a list, not whole numbers"),
    ("folds", (np.array([0, 1]), 3, 2), r"returned an array of shape \(2,\), not \(3,\)"),
    ("folds", (np.array([0, 2]), 2, 2), "returned folds 0 to 2, not -1 to 1"),
    ("folds", (np.array([-2, 1]), 2, 2), "returned folds -2 to 1, not -1 to 1"),
    ("area_update", (MAP,), "returned a SemanticMap, not an AreaUpdate or None"),
    ("area_update", (replace(UPDATE, area="1"),), "whose area is '1', not a whole number"),
    ("area_update", (replace(UPDATE, area=True),), "whose area is True, not a whole number"),
    ("area_update", (replace(UPDATE, label=None),), "whose label is None, not a text"),
    ("area_update", (replace(UPDATE, confidence=np.nan),), "whose confidence is nan, not a finite"),
    ("area_update", (replace(UPDATE, confidence="1"),), "whose confidence is '1', not a finite"),
    ("area_update", (replace(UPDATE, finished=None),), "whose finished is None, not true or"),
    ("texts", ("a line",), "returned 'a line', not a list of texts"),
    ("texts", ([1],), "not a list of texts"),
    ("behind", (-0.1,), "returned -0.1, not a distance of at least 0 or None"),
    ("behind", (np.nan,), "returned nan, not a distance of at least 0 or None"),
    ("crossing", (True,), "returned a bool, not a Pose2D or None"),
    ("crossing", (Pose2D(0, np.inf, 0),), "returned a Pose2D whose y is inf, not a finite number"),
    ("crossing", (Pose2D(0, 0, None),), "whose theta is None, not a finite number"),
    ("pose", ((1, 2, 3),), "returned a tuple, not a Pose2D"),
    ("pose", (Pose2D("1", 0, 0),), "whose x is '1', not a number"),
    ("semantic_map", ({"areas": []},), "returned a dict, not a SemanticMap"),
    ("semantic_map", (replace(MAP, areas=({},)),), "returned a map with a dict among its areas"),
    ("semantic_map", (replace(MAP, nodes=(None,)),), "returned a map with None among its nodes"),
    ("semantic_map", (replace(MAP, areas=()),), "whose node 0 is in area 0, which it has not"),
    ("semantic_map", (replace(MAP, edges=((0, 7),)),), r"an edge \(0, 7\) between no two nodes"),
    ("observation", ({"stamp": 5},), "returned a dict, not an Observation"),
    ("observation", (None,), "returned None, not an Observation"),
    ("observation", (seen(stamp=5.0),), "whose stamp is 5.0, not a whole number of ns"),
    ("observation", (seen(stamp=2**63),), "whose stamp is 9223372036854775808, not a whole"),
    ("observation", (seen(label=3),), "whose label is 3, not a text or None"),
    ("observation", (seen(pose=(0, 0, 0)),), "whose pose is a tuple, not a Pose2D or None"),
    ("observation", (seen(scan=np.ones(3)),), "whose scan is a ndarray, not a LaserScan or None"),
    ("observation", (seen(image="a.jpg"),), "whose image is a str, not an array"),
    ("observation", (seen(image=PIXELS / 255),), r"whose image is of float64, shape \(4, 5, 3\)"),
    ("observation", (seen(image=PIXELS[None]),), r"whose image is of uint8, shape \(1, 4, 5, 3\)"),
    (
        "observation",
        (seen(scan=replace(SCAN, ranges=np.ones(2))),),
        "a LaserScan of 3 angles and 2 ranges",
    ),
    ("scan", (replace(SCAN, ranges=[1.0]),), "whose ranges are a list, not"),
    ("scan", (replace(SCAN, angles=np.zeros(3, int)),), "whose angles are an array of int64, not"),
    ("scan", (replace(SCAN, angles=np.zeros((3, 1))),), "whose angles are an array of float64, n"),
    ("scan", (None,), "returned None, not a LaserScan"),
    ("stamp", (1.5,), "returned 1.5, not a whole number of ns"),
    ("stamp", (None,), "returned None, not a whole number of ns"),
    ("text", ("",), "is '', not a text"),
    ("text", (b"abc",), "is a bytes, not a text"),
    ("count", (-1,), "returned -1, not a number of observations or None"),
    ("count", (2.0,), "returned 2.0, not a number of observations or None"),
    ("metadata", (None,), "is None, not a mapping of texts"),
    ("metadata", ({"run": 1},), "holds an int under 'run', not a text"),
    ("camera", ("left",), "is 'left', not a PinholeCamera or None"),
]


@pytest.mark.parametrize(("name", "arguments", "said"), WRONG)
def test_what_is_wrong_is_said(name: str, arguments: tuple[Any, ...], said: str) -> None:
    told = getattr(contracts, name)(*arguments)
    assert told is not None
    assert re.search(said, told), told
    assert "\n" not in told


def test_what_fits_64_bits() -> None:
    assert contracts.fits(2**63 - 1)
    assert contracts.fits(-(2**63))
    assert not contracts.fits(2**63)


def test_every_check_has_been_seen_to_pass_and_to_fail() -> None:
    elsewhere = {"fits", "image", "trained", "augmentations"}  # seen in other tests
    public = set(contracts.__all__) - elsewhere
    assert {name for name, _ in RIGHT} == public
    assert {name for name, _, _ in WRONG} == public
