"""Places from objects, by a table of which objects stand in which place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Self

import numpy as np
import yaml
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize
from scipy.special import log_softmax, softmax

from placecue.checks import check_whole
from placecue.classifier import Classifier, UnfitSamples, wrong_kind
from placecue.errors import DataError, UsageError, choices, described
from placecue.features import FeatureBatch, FeatureKind, kind_of
from placecue.scores import Probabilities, Scores

Matrix = NDArray[np.float64]

#: How strongly what is learned is drawn to what it is without training.
_PRIOR = 1.0


class Knowledge(Classifier):
    """Which place the objects that are seen belong to, by a table; needs no training.

    A place's score is the mean of the largest scores among its objects. Without training the
    probability of a place is the softmax of the scores; :meth:`fit` learns a temperature and an
    offset for each place from labelled samples, and nothing else. Names of places are compared
    without regard to capitals, blanks and underscores.

    Parameters
    ----------
    table : str, optional
        A YAML file, ``place: [object, ...]``; placecue's own by default, written from general
        knowledge.
    more : str, optional
        Another one on top: its places are added, or take the place of those of the same name.
    objects : str, optional
        A file with the name of each object, a line each in the order of the scores; those of
        ImageNet by default.
    places : sequence of str, optional
        Those that there are where the robot drives; all of the table by default.
    top : int
        How many of a place's objects count.

    Attributes
    ----------
    layout_ : Probabilities
    members_ : ndarray of bool, shape (M, objects)
        Which objects belong to each place.
    temperature_ : float
        What scores are multiplied by.
    offsets_ : ndarray of float64, shape (M,)
        What is added to them.

    References
    ----------
    Rottmann, Martinez Mozos, Stachniss and Burgard, AAAI 2005: objects seen in the image beside
    the geometry of a laser scan.
    """

    def __init__(
        self,
        table: str | None = None,
        more: str | None = None,
        objects: str | None = None,
        places: Sequence[str] | None = None,
        top: int = 3,
    ) -> None:
        self.table = table
        self.more = more
        self.objects = objects
        self.places = places
        self.top = top

    def check_parameters(self) -> None:  # noqa: D102
        check_whole("top", self.top, least=1)
        places = self.places
        if places is not None and (isinstance(places, str) or not isinstance(places, Sequence)):
            raise UsageError(f"places is {places!r}; give a list, such as [office, kitchen]")
        for name in ("table", "more", "objects"):
            value = getattr(self, name)
            if value is not None and not isinstance(value, str):
                raise UsageError(f"{name} is {value!r}; give a file, or null")

    def untrained(self) -> Self:
        """Get ready without any training: every place of the table, or those of ``places``.

        Raises
        ------
        UsageError
            If a place is not in the table, or the table names an object that is none.
        DataError
            If a file cannot be read.
        """
        table = self._table()
        return self._know(np.array(sorted(self.places or table)), table)

    def fit(
        self, features: FeatureBatch, labels: ArrayLike, stamps: ArrayLike | None = None
    ) -> Self:
        """Learn a temperature and an offset a place from n samples.

        The places are those of the labels, and those of ``places`` where that is given.

        Raises
        ------
        UsageError
            If a place is not in the table.
        DataError
            If the features are not as many as the objects, or there is one class only.
        """
        table = self._table()
        features = self.training_samples(_dense(self, features), labels)
        codes = self.learn_classes(labels)
        names = self.labels_[codes]
        if self.places is not None:
            missing = set(self.class_names) - set(self.places)
            if missing:
                raise UnfitSamples(
                    f"there are samples of {', '.join(sorted(missing))}, which places= leaves out: "
                    f"it has {', '.join(self.places)}"
                )
            self.labels_ = np.array(sorted(self.places))
        self._know(self.labels_, table)
        self._check_objects(features)
        values = self._places(np.asarray(features, np.float64))
        self._learn(values, np.searchsorted(self.labels_, names))
        return self

    def scores(self, features: FeatureBatch) -> Scores:
        """Return the probabilities of the places for n samples, shape (n, M)."""
        checked = self.samples(_dense(self, features))
        self._check_objects(checked)
        values = self._places(np.asarray(checked, np.float64))
        return Scores(softmax(self.temperature_ * values + self.offsets_, axis=1), self.layout_)

    def check_learned(self) -> None:
        """Raise ValueError unless what a model folder says fits together."""
        classes = len(self.labels_)
        right = self.members_.ndim == 2 and len(self.members_) == classes
        if not right or self.members_.dtype != np.bool_ or not self.members_.any(axis=1).all():
            raise ValueError("members_ are not objects of each place")
        if self.offsets_.shape != (classes,):
            raise ValueError("offsets_ are not those of the places")

    # ------------------------------------------------------------------ privately

    def _know(self, labels: NDArray[Any], table: Mapping[str, Sequence[str]]) -> Self:
        """Look up the objects of places, and begin with what is known without training."""
        objects = object_names(self.objects)
        columns = {name: number for number, name in enumerate(objects)}
        self.members_ = np.zeros((len(labels), len(objects)), dtype=bool)
        for row, place in enumerate(labels):
            for each in table[_entry(str(place), table)]:
                self.members_[row, columns[each]] = True
        self.labels_ = labels
        self.layout_ = Probabilities(self.class_names)
        self.temperature_, self.offsets_ = 1.0, np.zeros(len(labels))
        return self

    def _table(self) -> dict[str, Sequence[str]]:
        """Return the table, every object of it known."""
        self.check_parameters()
        known = set(object_names(self.objects))
        table: dict[str, Sequence[str]] = {}
        for where in (self.table, *([self.more] if self.more is not None else [])):
            for place, objects in read_table(where).items():
                for each in objects:
                    if each not in known:
                        raise UsageError(
                            f"{where or 'the table'}: {place} has '{each}', which is none of the "
                            f"{len(known)} objects; {_near(each, known)}"
                        )
                same = [name for name in table if _plain(name) == _plain(place)]
                table[same[0] if same else place] = objects
        return table

    def _places(self, features: Matrix) -> Matrix:
        """Return the score of each place, shape (n, M)."""
        made = []
        for members in self.members_:
            own = np.sort(features[:, members], axis=1)
            made.append(own[:, -self.top :].mean(axis=1))
        return np.stack(made, axis=1)

    def _learn(self, values: Matrix, codes: NDArray[np.int64]) -> None:
        """Learn temperature and offsets, each class weighing the same."""
        counts = np.bincount(codes, minlength=values.shape[1])
        weights = len(codes) / (np.count_nonzero(counts) * counts[codes])
        rows = np.arange(len(codes))

        def loss(parameters: Matrix) -> tuple[float, Matrix]:
            temperature, offsets = np.exp(parameters[0]), parameters[1:]
            logits = temperature * values + offsets
            chances = log_softmax(logits, axis=1)
            slope = np.exp(chances)
            slope[rows, codes] -= 1
            slope *= weights[:, None]
            own = np.sum(slope * temperature * values)
            gradient = np.concatenate([[own], slope.sum(axis=0)]) + _PRIOR * parameters
            value = -weights @ chances[rows, codes] + _PRIOR * parameters @ parameters / 2
            return float(value), gradient

        start = np.zeros(1 + values.shape[1])
        best = minimize(loss, start, jac=True, method="L-BFGS-B").x
        self.temperature_, self.offsets_ = float(np.exp(best[0])), np.asarray(best[1:])

    def _check_objects(self, features: FeatureBatch) -> None:
        width, known = features.shape[1], self.members_.shape[1]
        if width != known:
            raise UnfitSamples(
                f"the cue scores {width} objects, and there are {known} names of objects: give "
                "classifier.objects=FILE with a name for each, in their order"
            )


def _dense(classifier: Knowledge, features: FeatureBatch) -> FeatureBatch:
    if not isinstance(features, list) and kind_of(features) is not FeatureKind.DENSE:
        raise wrong_kind(classifier, "dense vectors", features)
    return features


def _entry(place: str, table: Mapping[str, Any]) -> str:
    """Return the name that a table has for a place."""
    for name in table:
        if _plain(name) == _plain(place):
            return name
    raise UsageError(
        f"the table has no place '{place}'; {choices(place, table)}; a line of YAML adds it: "
        "classifier.more=FILE"
    )


def _plain(name: str) -> str:
    return name.lower().replace(" ", "").replace("_", "").replace("-", "")


def _near(name: str, known: set[str]) -> str:
    """Return the names that come nearest; all would fill pages."""
    return choices(name, known).split("available:")[0].rstrip() or "see classifier.objects"


@lru_cache
def object_names(path: str | None) -> tuple[str, ...]:
    """Return the names of objects in a file, or those of ImageNet.

    Raises
    ------
    DataError
        If the file cannot be read, or a name stands there twice or is empty.
    """
    text = _text(path, "imagenet.txt")
    names = tuple(line.strip() for line in text.rstrip("\n").split("\n"))
    for name in names:
        if not name or names.count(name) > 1:
            raise DataError(
                f"{path}: '{name}' {'stands there twice' if name else 'is no name'}; give a name "
                "for each object, a line each"
            )
    return names


def read_table(path: str | None) -> dict[str, list[str]]:
    """Return the objects of each place in a YAML file, or placecue's own table.

    Raises
    ------
    DataError
        If the file cannot be read or is no such table.
    """
    where = path or "places.yaml"
    try:
        made = yaml.safe_load(_text(path, "places.yaml"))
    except yaml.YAMLError as error:
        raise DataError(f"{where} is no YAML: {' '.join(str(error).split())}") from error
    if not isinstance(made, dict) or not made:
        raise DataError(f"{where} holds {described(made)}, not place: [object, ...]")
    return {str(place): list(_objects(where, place, value)) for place, value in made.items()}


def _objects(where: str, place: object, value: object) -> Iterator[str]:
    if not isinstance(value, list) or not value:
        raise DataError(f"{where}: {place} has {described(value)}, not a list of objects")
    for each in value:
        yield str(each)


def _text(path: str | None, own: str) -> str:
    try:
        if path is None:
            folder = files("placecue_classifiers") / "knowledge_data"
            return (folder / own).read_text(encoding="utf-8")
        return Path(path).expanduser().read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{path} cannot be read: {' '.join(str(error).split())}") from error
