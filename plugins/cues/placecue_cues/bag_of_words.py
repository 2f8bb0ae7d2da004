"""Histograms of visual words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.cluster import MiniBatchKMeans

from placecue.cue import Cue
from placecue.errors import UsageError
from placecue.observation import Observation, Part

from .dense_sift import DenseSift
from .descriptor_sample import descriptor_sample
from .local_descriptors import check_descriptors, patches_of
from .pyramid import cells, check_pyramid


class BagOfWords(Cue):
    """Histogram of visual words over local descriptors, float64 summing to one.

    Its shape is (words * cells of the pyramid,). An image without any contrast gives zeros. The
    words are cluster centres learned from a random sample of the training images' descriptors.

    Parameters
    ----------
    words : int
        Size of the codebook.
    descriptors : Cue, optional
        A cue of local descriptors, such as SIFT; by default DenseSift().
    pyramid : sequence of int
        A level of k cuts the image into k x k cells with a histogram each; all levels weigh the
        same.
    sample : int
        Descriptors to learn from.
    random_state : int
        Seed of the sample and of the clustering.

    Attributes
    ----------
    words_ : ndarray of float32, shape (words, d)
        The cluster centres.

    References
    ----------
    Csurka, Dance, Fan, Willamowski and Bray, Visual categorization with bags of keypoints, ECCV
    workshop, 2004. Sculley, Web-scale k-means clustering, WWW 2010.
    """

    requires: ClassVar[tuple[Part, ...]] = ("image",)
    learns: ClassVar[bool] = True

    def __init__(
        self,
        words: int = 500,
        descriptors: Cue | None = None,
        pyramid: Sequence[int] = (1,),
        sample: int = 50_000,
        random_state: int = 0,
    ) -> None:
        self.words = words
        self.descriptors = descriptors
        self.pyramid = pyramid
        self.sample = sample
        self.random_state = random_state

    def fit(self, observations: Iterable[Observation], labels: Any = None) -> Self:
        """Learn the words from training images; labels are not used.

        Raises
        ------
        DataError
            If the images have fewer descriptors than there are words.
        UsageError
            If a parameter cannot be.
        """
        local = self._local()
        if not 1 <= self.words <= self.sample:
            raise UsageError(
                f"bag_of_words needs words >= 1 and a sample of as many or more, got {self.words} "
                f"and {self.sample}"
            )
        descriptors = descriptor_sample(
            observations,
            lambda each: patches_of(local, each, "bag_of_words").descriptors,
            self.sample,
            self.random_state,
            self.words,
            "bag_of_words",
        )
        kmeans = MiniBatchKMeans(self.words, random_state=self.random_state, n_init=1)
        self.words_ = kmeans.fit(descriptors).cluster_centers_.astype(np.float32)
        return self

    def extract(self, observation: Observation) -> NDArray[np.float64]:
        """Return the histogram of the observation's image.

        Raises
        ------
        UnusableObservation
            If the image is not an 8-bit RGB or 8 or 16-bit grey one, or smaller than a patch.
        """
        if not hasattr(self, "words_"):
            raise UsageError("bag_of_words learns: fit it on training images first")
        patches = patches_of(self._local(), observation, "bag_of_words")
        likeness = patches.descriptors @ self.words_.T
        likeness -= np.einsum("ij,ij->i", self.words_, self.words_) / 2
        nearest = likeness.argmax(axis=1)
        counts = [
            np.bincount(nearest[inside], minlength=len(self.words_))
            for inside in cells(patches.places, self.pyramid)
        ]
        histogram = np.concatenate(counts)
        return np.asarray(histogram / max(histogram.sum(), 1))

    def _local(self) -> Cue:
        check_pyramid(self.pyramid, "bag_of_words")
        local = DenseSift() if self.descriptors is None else self.descriptors
        check_descriptors(local, self.pyramid, "bag_of_words")
        return local
