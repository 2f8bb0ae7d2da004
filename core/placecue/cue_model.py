"""A cue and its classifier: the paper's single-cue model."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from placecue import contracts
from placecue.attempts import attempt
from placecue.classifier import Classifier
from placecue.cue import Cue
from placecue.errors import described
from placecue.estimator import clone
from placecue.features import FeatureBatch, n_samples, take
from placecue.folds import FoldScheme, Rows
from placecue.guard import call, step
from placecue.observation import Observation
from placecue.progress import track
from placecue.scores import Layout, Scores
from placecue.training_set import TrainingSet

if TYPE_CHECKING:
    from placecue.learning.samples import Which


class CueModel:
    """What one cue says of a place.

    Parameters
    ----------
    cue : Cue
        Turns observations into features.
    classifier : Classifier
        Turns features into scores.

    Attributes
    ----------
    trained_on : Which or None
        The samples that it was trained on, where that is known; not saved with a model.
    """

    def __init__(self, cue: Cue, classifier: Classifier) -> None:
        self.cue = cue
        self.classifier = classifier
        self.trained_on: Which | None = None

    @classmethod
    def of(cls, model: CueModel | tuple[Cue, Classifier]) -> CueModel:
        """Return a model as it is, or that of a cue and its classifier."""
        return model if isinstance(model, CueModel) else cls(*model)

    @property
    def layout(self) -> Layout:
        """What the columns of the scores are; there once the model is fitted."""
        return self.classifier.layout_

    def fit(self, training: TrainingSet) -> CueModel:
        """Train the classifier on features of the cue, which has learned already."""

        def wrong(_: object) -> str | None:
            return contracts.trained(self.classifier, np.asarray(training.labels))

        call(self.classifier, "train", training, check=wrong)
        return self

    def scores(self, features: FeatureBatch, at: Observation | None = None) -> Scores:
        """Return the scores of n samples, shape (n, V).

        Parameters
        ----------
        features : batch of n samples
            What the cue makes of observations.
        at : Observation, optional
            The one that the features are of, for messages.
        """
        check = partial(contracts.scores, n=n_samples(features), layout=self.layout)
        scores: Scores = call(self.classifier, "scores", features, check=check, at=at)
        return scores

    def tried(self, features: FeatureBatch, *, skip: bool = False) -> Scores:
        """Return the scores of n samples; NaN where the classifier fails, if ``skip`` says so."""

        def score(rows: Rows) -> Scores:
            return self.scores(take(features, rows))

        values = np.full((n_samples(features), len(self.layout.columns)), np.nan)
        for rows, scores in attempt(score, n_samples(features), skip=skip).answers:
            values[rows] = scores.values
        return Scores(values, self.layout)

    def held_out(
        self, training: TrainingSet, folds: FoldScheme | None = None, *, name: str = "cue"
    ) -> Scores:
        """Return the scores that each sample gets from a copy of the model which has not seen it.

        Parameters
        ----------
        training : TrainingSet
            n samples, on which the model has been fitted; copies of the classifier with what its
            search found are trained in each fold. Augmented copies are trained on, not scored.
        folds : FoldScheme, optional
            How the samples are cut; by default as the set says.
        name : str
            The name of the cue, for progress.

        Returns
        -------
        Scores
            Shape (n, V) in the model's layout; NaN for a sample that no fold held out.
        """
        splits = track(training.split(folds), f"{name}: out-of-fold scores")
        values = np.full((len(training), len(self.layout.columns)), np.nan)
        parts = iter(call(self.classifier, "out_of_fold", training, splits))
        while True:
            part = step(self.classifier, "out_of_fold", next, parts, None, check=self._fold)
            if part is None:
                return Scores(values, self.layout)
            values[part[0]] = part[1].values

    def _fold(self, made: Any) -> str | None:
        """Check what ``out_of_fold`` yields: held-out rows with their scores."""
        if made is None:
            return None
        if not isinstance(made, tuple) or len(made) != 2:
            return f"yielded {described(made)}, not held-out rows and their scores"
        wrong = contracts.scores(made[1], len(made[0]))
        columns = made[1].values.shape[1] if wrong is None else 0
        if wrong is None and columns != len(self.layout.columns):
            wrong = f"yielded scores of {columns} columns, not {len(self.layout.columns)}"
        return wrong

    def unfitted(self) -> CueModel:
        """Return a copy that has learned nothing, with the same parameters."""
        return CueModel(clone(self.cue), clone(self.classifier))
