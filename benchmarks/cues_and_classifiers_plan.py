"""What benchmarks/cues_and_classifiers.py compares: samples, cues (rows), classifiers (columns).

Rows and columns are overrides of the shipped options, as after ``placecue train``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

EXTENSIONS = ("oaa", "modified_oaa", "oao")
KERNELS = ("chi2", "match", "rbf", "linear", "hi", "sum", "product")
BOOSTED = {"adaboost": "confidence", "adaboost_probability": "probability"}
#: Estimators of scikit-learn with their parameters.
SKLEARN = {
    "forest": (
        "sklearn.ensemble.RandomForestClassifier",
        "{n_estimators: 300, class_weight: balanced}",
    ),
    "logistic": (
        "sklearn.linear_model.LogisticRegression",
        "{C: 1.0, class_weight: balanced, max_iter: 500}",
    ),
    "knn": ("sklearn.neighbors.KNeighborsClassifier", "{n_neighbors: 5}"),
}
FOUR = ("bathroom", "bedroom", "kitchen", "living_room")
#: The plans that have rooms, hallways and doorways.
BUILDINGS = ("Fr101", "Fr52", "intel", "lab_d_furniture", "lab_ipa", "office_e")
#: Those without furniture.
BARE = ("Fr101", "Fr52", "intel", "lab_ipa")


@dataclass(frozen=True)
class Part:
    """Samples, and how they are cut.

    Parameters
    ----------
    source : sequence of str
        Overrides that choose the source.
    paths : sequence of str
        What it reads below ``PLACECUE_DATA``, one log each.
    scheme : str
        Folds that are scored, and folds of a parameter search in their training samples.
    outer, inner : int
        How many of them.
    tests : mapping of str to classes
        Which classes are told apart; None for all.
    """

    source: Sequence[str]
    paths: Sequence[str]
    scheme: str
    outer: int
    inner: int
    tests: Mapping[str, Sequence[str] | None]


def _plans(names: Sequence[str], degrees: int, beams: int, scheme: str = "by_log") -> Part:
    # Doorways are 1 to 2 % of the area: drawn by area, a building would hold three of them.
    scanner = (f"source.field_of_view={degrees}", f"source.beams={beams}")
    return Part(
        source=("source=floorplan", "source.balance=class", "source.samples=300", *scanner),
        paths=[f"maps/{name}.png" for name in names],
        scheme=scheme,
        outer=len(names),
        inner=len(names) - 1,
        tests={"three": None, "two": ("room", "hallway")},
    )


PARTS = {
    "nyuv2": Part(
        source=("source=nyuv2", "source.min_frames=20"),
        paths=["nyuv2"],
        scheme="scenes",
        outer=5,
        inner=5,
        tests={"eight": None, "four": FOUR},
    ),
    "maps_360": _plans(BUILDINGS, 360, 720),
    "maps_180": _plans(BUILDINGS, 180, 361),
    "bare_360": _plans(BARE, 360, 720),
    "bare_180": _plans(BARE, 180, 361),
    "places_360": _plans(BUILDINGS, 360, 720, "shuffled"),
    "places_180": _plans(BUILDINGS, 180, 361, "shuffled"),
}


@dataclass(frozen=True)
class Row:
    """A cue in one part.

    Parameters
    ----------
    part, name, cue : str
        Where it is used, what the tables call it, and the option it starts from.
    columns : mapping of str to sequence of str
        For each test the columns.
    changes : sequence of str
        Overrides, ``CUE`` standing for the place of the cue in the config.
    kernel : str
        Kernel of its shipped classifier.
    scaling : str
        Scaling of its shipped classifier.
    rbf : sequence of float
        Gammas for an RBF kernel where it is not the shipped one.
    svm : sequence of str
        Overrides of the shipped SVM, after its place.
    """

    part: str
    name: str
    cue: str
    columns: Mapping[str, Sequence[str]]
    changes: Sequence[str] = ()
    kernel: str = "rbf"
    scaling: str = "null"
    rbf: Sequence[float] = (0.1, 0.3, 1, 3)
    svm: Sequence[str] = ()

    def overrides(self, column: str) -> list[str]:
        """Return what chooses this cue with the classifier of a column."""
        cue = f"cues.{self.cue}"
        chosen = [f"cue=[{self.cue}]", "integrator=none", *PARTS[self.part].source]
        changes = [change.replace("CUE", cue) for change in self.changes]
        return [*chosen, *self._classifier(column, f"{cue}.classifier"), *changes]

    def _classifier(self, column: str, place: str) -> list[str]:
        part = PARTS[self.part]
        folds = [f"{place}.folds={{plugin:{part.scheme},n_folds:{part.inner}}}"]
        if column in EXTENSIONS:
            return [f"{place}.multiclass={column}", *folds, *(f"{place}.{o}" for o in self.svm)]
        if column in KERNELS:
            return [f"kernel@{place}.kernel={column}", *self._kernel(column, place), *folds]
        if column in BOOSTED:
            return [f"classifier@{place}=adaboost", f"{place}.output={BOOSTED[column]}"]
        name, params = SKLEARN[column]
        return [
            f"classifier@{place}=sklearn",
            f"{place}.estimator={name}",
            f"++{place}.params={params}",
            f"{place}.scaling={self.scaling}",
        ]

    def _kernel(self, kernel: str, place: str) -> list[str]:
        """Return the grid of a kernel that is not the shipped one."""
        # Dot products of histograms are as small as their bins, so C has to be larger.
        grid: dict[str, list[float]] = {"C": [1, 10, 100]}
        if kernel == "linear" and self.scaling == "null":
            grid["C"] = [1, 10, 100, 1000, 10000]
        gammas = {"rbf": self.rbf, "chi2": (0.3, 1, 3), "match": (0.1, 0.3, 1, 2)}
        if kernel in gammas:
            grid["gamma"] = list(gammas[kernel])
        joined = f"{place}.kernel.kernels=[{{plugin: chi2, gamma: 1.0}},{{plugin: hi}}]"
        written = "{" + ",".join(f"{name}: {values}" for name, values in grid.items()) + "}"
        return [
            f"~{place}.search",
            f"+{place}.search={written}",
            *([joined] if kernel in ("sum", "product") else []),
        ]


VECTORS = ("chi2", "match", "rbf", "linear", "hi")
HISTOGRAMS = (*VECTORS, "sum", "product")
SHORT = (*EXTENSIONS, "adaboost", "forest")
LONG = (*SHORT, "logistic", "knn")
SCANS = (*EXTENSIONS, *BOOSTED, "forest", "logistic", "knn")
TWO = ("oaa", "adaboost", "forest")


def _frames(
    name: str, cue: str, kernel: str, kernels: Sequence[str], *changes: str, **more: object
) -> Row:
    others = [each for each in kernels if each != kernel]
    columns = {"eight": (*LONG, *others), "four": SHORT}
    return Row("nyuv2", name, cue, columns, changes, kernel, **more)  # type: ignore[arg-type]


def _scans(part: str, name: str, *changes: str, columns: Sequence[str] = SCANS) -> Row:
    of_test = {"three": columns, "two": [name for name in columns if name in TWO]}
    return Row(part, name, "laser", of_test, changes, scaling="quantiles")


def _pair(part: str, name: str, *changes: str) -> list[Row]:
    """Return a variant for both fields of view, with a short grid: some have many samples."""
    columns = (*EXTENSIONS, "adaboost")
    plain = [
        _scans(f"{part}_{degrees}", f"laser, full, {degrees}°, {name}", *changes, columns=columns)
        for degrees in (360, 180)
    ]
    return [replace(row, svm=[SHORT_GRID]) for row in plain]


FULL = "CUE.preset=full"
MORE = ("CUE.keypoints=400",)
SHORT_GRID = "search={C: [1,10], gamma: [0.001,0.003,0.01]}"
#: The shipped grid begins at gamma 0.003.
SMALL = "search={C: [1,10,100], gamma: [0.0003,0.001,0.003,0.01]}"
SCALES = "CUE.scales=[0.8,1,1.25]"
NEAR = "source.clearance=0.2"
QUANTILES = {"scaling": "quantiles"}
ROWS = [
    _frames("crfh", "crfh", "chi2", HISTOGRAMS),
    _frames("sift", "sift", "match", VECTORS),
    _frames("laser, group", "laser", "rbf", VECTORS, **QUANTILES),
    _frames("laser, full", "laser", "rbf", VECTORS, FULL, **QUANTILES),
    _frames("gist", "gist", "rbf", VECTORS, scaling="range"),
    _frames("color_histogram", "color_histogram", "chi2", HISTOGRAMS),
    _frames("fisher_vector", "fisher_vector", "linear", VECTORS),
    _frames("bag_of_words", "bag_of_words", "chi2", HISTOGRAMS, rbf=(10, 100, 1000)),
    _frames("sift, 400 keypoints", "sift", "match", VECTORS, *MORE),
    _scans("maps_360", "laser, full, 360°", FULL),
    _scans("maps_180", "laser, full, 180°", FULL),
    _scans("maps_180", "laser, group, 180°"),
    *_pair("maps", "short grid", FULL),
    *_pair("maps", "scales", FULL, SCALES),
    *_pair("maps", "0.2 m from walls", FULL, NEAR),
    *_pair("bare", "bare plans", FULL),
    *_pair("bare", "bare plans, scales", FULL, SCALES),
    *_pair("places", "known buildings", FULL),
]


def _variant(row: Row, name: str, *changes: str, svm: Sequence[str] = ()) -> Row:
    return replace(
        row,
        name=f"{row.name}, {name}",
        columns={"four": ("oaa",)},
        changes=(*row.changes, *changes),
        svm=(*row.svm, *svm),
    )


BY_NAME = {row.name: row for row in ROWS}
SIFT, COLOR = BY_NAME["sift, 400 keypoints"], BY_NAME["color_histogram"]
LASER = _variant(BY_NAME["laser, full"], "small gammas", svm=[SMALL])
NARROW = ("CUE.gaps=[0.05,0.1,0.2,0.3,0.5,0.75,1,1.5,2,3]", "CUE.clips=[1,2,3,5]")
HIGHER = "source.horizon=174"
#: What was tried on the four rooms to explain differences from the prototype.
TRIED = {
    "sift": [
        BY_NAME["sift"],
        SIFT,
        _variant(SIFT, "contrast 0.02", "CUE.contrast_threshold=0.02"),
    ],
    "laser": [
        BY_NAME["laser, group"],
        BY_NAME["laser, full"],
        _variant(BY_NAME["laser, group"], "small gammas", svm=[SMALL]),
        LASER,
        _variant(LASER, "range", svm=["scaling=range"]),
        _variant(LASER, "standard", svm=["scaling=standard"]),
        _variant(LASER, "gaps from 0.05 m and clips from 1 m", *NARROW),
        _variant(LASER, "one row", "source.band=1"),
        _variant(LASER, "20 rows", "source.band=20"),
        _variant(LASER, "200 rows", "source.band=200"),
        _variant(LASER, "median of 60 rows", "source.percentile=50"),
        _variant(LASER, "80 rows higher", HIGHER),
        _variant(LASER, "80 rows lower", "source.horizon=334"),
        _variant(LASER, "80 rows higher and these gaps", HIGHER, *NARROW),
    ],
    "color_histogram": [
        COLOR,
        _variant(COLOR, "4 x 8 x 8", "CUE.bins=[4,8,8]"),
        _variant(COLOR, "8 x 8 x 8", "CUE.bins=[8,8,8]"),
        _variant(COLOR, "10 x 20 x 20", "CUE.bins=[10,20,20]"),
        _variant(COLOR, "chroma to 96", "CUE.chroma_limit=96"),
    ],
}
