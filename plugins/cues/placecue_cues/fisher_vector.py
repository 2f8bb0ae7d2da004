"""Fisher vectors of dense local descriptors."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.decomposition import PCA
from sklearn.exceptions import ConvergenceWarning
from sklearn.mixture import GaussianMixture

from placecue.cue import Cue
from placecue.errors import UsageError
from placecue.observation import Observation, Part

from .dense_sift import DenseSift
from .descriptor_sample import descriptor_sample
from .fisher import Mixture, Single, power_normalised
from .local_descriptors import check_descriptors, patches_of
from .pyramid import cells, check_pyramid


class FisherVector(Cue):
    """Fisher vector of local descriptors, float32 of unit length.

    Its shape is (2 * components * gaussians * cells of the pyramid,). An image without any
    contrast gives zeros. Principal components and Gaussian mixture are learned from a random
    sample of the training images' descriptors.

    Parameters
    ----------
    components : int
        Principal components that descriptors are reduced to.
    gaussians : int
        Gaussians of the mixture.
    descriptors : Cue, optional
        A cue of local descriptors, such as SIFT; by default DenseSift().
    pyramid : sequence of int
        A level of k cuts the image into k x k cells with a Fisher vector each.
    sample : int
        Descriptors to learn from.
    iterations : int
        At most so many of expectation maximisation.
    random_state : int
        Seed of the sample and of the mixture's start.

    Attributes
    ----------
    center_ : ndarray of float32, shape (d,)
    components_ : ndarray of float32, shape (components, d)
    weights_ : ndarray of float64, shape (gaussians,)
    means_, variances_ : ndarray of float64, shape (gaussians, components)

    References
    ----------
    Perronnin, Sanchez and Mensink, ECCV 2010. Arandjelovic and Zisserman, CVPR 2012 (RootSIFT).
    """

    requires: ClassVar[tuple[Part, ...]] = ("image",)
    learns: ClassVar[bool] = True

    def __init__(
        self,
        components: int = 48,
        gaussians: int = 64,
        descriptors: Cue | None = None,
        pyramid: Sequence[int] = (1,),
        sample: int = 50_000,
        iterations: int = 30,
        random_state: int = 0,
    ) -> None:
        self.components = components
        self.gaussians = gaussians
        self.descriptors = descriptors
        self.pyramid = pyramid
        self.sample = sample
        self.iterations = iterations
        self.random_state = random_state

    def fit(self, observations: Iterable[Observation], labels: Any = None) -> Self:
        """Learn principal components and mixture from training images; labels are not used.

        Raises
        ------
        DataError
            If the images have too few descriptors.
        UsageError
            If a parameter cannot be.
        """
        local = self._local()
        enough = max(self.components, self.gaussians) + 1
        if min(self.components, self.gaussians, self.iterations) < 1 or self.sample < enough:
            raise UsageError(
                "fisher_vector needs components, gaussians and iterations >= 1 and a sample "
                f"larger than the first two, got {self.components}, {self.gaussians}, "
                f"{self.iterations} and {self.sample}"
            )
        descriptors = descriptor_sample(
            observations,
            lambda each: patches_of(local, each, "fisher_vector").descriptors,
            self.sample,
            self.random_state,
            enough,
            "fisher_vector",
        )
        if self.components > descriptors.shape[1]:
            raise UsageError(
                f"fisher_vector has components up to {descriptors.shape[1]}, the length of its "
                f"descriptors, got {self.components}"
            )
        pca = PCA(self.components, svd_solver="covariance_eigh").fit(descriptors)
        self.center_ = pca.mean_.astype(np.float32)
        self.components_ = pca.components_.astype(np.float32)
        self._fit_mixture(self._project(descriptors))
        return self

    def extract(self, observation: Observation) -> NDArray[np.float32]:
        """Return the Fisher vector of the observation's image.

        Raises
        ------
        UnusableObservation
            If the image is not an 8-bit RGB or 8 or 16-bit grey one, or smaller than a patch.
        """
        if not hasattr(self, "means_"):
            raise UsageError("fisher_vector learns: fit it on training images first")
        patches = patches_of(self._local(), observation, "fisher_vector")
        x = self._project(patches.descriptors)
        mixture = Mixture(self.weights_, self.means_, self.variances_)
        posteriors = mixture.posteriors(x)
        parts = [
            power_normalised(mixture.fisher_vector(x[inside], posteriors[inside]))
            for inside in cells(patches.places, self.pyramid)
        ]
        joined = np.concatenate(parts)
        return joined / max(np.linalg.norm(joined), np.float32(1e-12))

    def _local(self) -> Cue:
        check_pyramid(self.pyramid, "fisher_vector")
        local = DenseSift() if self.descriptors is None else self.descriptors
        check_descriptors(local, self.pyramid, "fisher_vector")
        return local

    def _project(self, descriptors: Single) -> Single:
        return np.asarray((descriptors - self.center_) @ self.components_.T)

    def _fit_mixture(self, x: Single) -> None:
        mixture = GaussianMixture(
            self.gaussians,
            covariance_type="diag",
            max_iter=self.iterations,
            random_state=self.random_state,
        )
        with warnings.catch_warnings():
            # A few dozen iterations are enough for Fisher vectors.
            warnings.simplefilter("ignore", ConvergenceWarning)
            mixture.fit(x)
        self.weights_, self.means_ = mixture.weights_, mixture.means_
        self.variances_ = mixture.covariances_
