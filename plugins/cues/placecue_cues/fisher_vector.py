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
from .pyramid import cells, check_pyramid


class FisherVector(Cue):
    """Fisher vector of dense RootSIFT descriptors, float32 of unit length.

    Its shape is (2 * components * gaussians * cells of the pyramid,). An image without any
    contrast gives zeros. Principal components and Gaussian mixture are learned from a random
    sample of the training images' descriptors.

    Parameters
    ----------
    components : int
        Principal components that descriptors are reduced to.
    gaussians : int
        Gaussians of the mixture.
    longest_side, step, cells, contrast
        Of the descriptors' grid, see :class:`placecue_cues.dense_sift.DenseSift`: pixels, pixels,
        pixels, grey levels a pixel.
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
    center_ : ndarray of float32, shape (128,)
    components_ : ndarray of float32, shape (components, 128)
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
        longest_side: int = 320,
        step: int = 6,
        cells: Sequence[int] = (4, 6, 8, 10),
        contrast: float = 1.0,
        pyramid: Sequence[int] = (1,),
        sample: int = 50_000,
        iterations: int = 30,
        random_state: int = 0,
    ) -> None:
        self.components = components
        self.gaussians = gaussians
        self.longest_side = longest_side
        self.step = step
        self.cells = cells
        self.contrast = contrast
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
        grid = self._grid()
        enough = max(self.components, self.gaussians) + 1
        if min(self.components, self.gaussians, self.iterations) < 1 or self.sample < enough:
            raise UsageError(
                "fisher_vector needs components, gaussians and iterations >= 1 and a sample "
                f"larger than the first two, got {self.components}, {self.gaussians}, "
                f"{self.iterations} and {self.sample}"
            )
        if self.components > 128:
            raise UsageError(f"fisher_vector has components up to 128, got {self.components}")
        descriptors = descriptor_sample(
            observations,
            lambda each: grid.extract(each, "fisher_vector").descriptors,
            self.sample,
            self.random_state,
            enough,
            "fisher_vector",
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
        patches = self._grid().extract(observation, "fisher_vector")
        x = self._project(patches.descriptors)
        mixture = Mixture(self.weights_, self.means_, self.variances_)
        posteriors = mixture.posteriors(x)
        parts = [
            power_normalised(mixture.fisher_vector(x[inside], posteriors[inside]))
            for inside in cells(patches.places, self.pyramid)
        ]
        joined = np.concatenate(parts)
        return joined / max(np.linalg.norm(joined), np.float32(1e-12))

    def _grid(self) -> DenseSift:
        check_pyramid(self.pyramid, "fisher_vector")
        grid = DenseSift(self.longest_side, self.step, tuple(self.cells), self.contrast)
        grid.check("fisher_vector")
        return grid

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
