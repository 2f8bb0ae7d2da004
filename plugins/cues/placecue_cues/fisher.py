"""Fisher vectors: how descriptors pull at the parameters of a Gaussian mixture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Single = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Mixture:
    """A mixture of K Gaussians with diagonal covariances in d dimensions.

    Parameters
    ----------
    weights : ndarray, shape (K,)
    means, variances : ndarray, shape (K, d)
    """

    weights: NDArray[np.floating]
    means: NDArray[np.floating]
    variances: NDArray[np.floating]

    def posteriors(self, x: Single) -> Single:
        """Return the probability of each Gaussian given each descriptor, shape (n, K)."""
        precisions = 1 / self.variances
        constant = np.log(self.weights) - 0.5 * np.sum(
            np.log(2 * np.pi * self.variances) + self.means**2 * precisions, axis=1
        )
        logs = x @ _single(self.means * precisions).T
        logs -= (x**2) @ _single(precisions / 2).T
        logs += _single(constant)
        logs -= logs.max(axis=1, keepdims=True)
        np.exp(logs, out=logs)
        logs /= logs.sum(axis=1, keepdims=True)
        return logs

    def fisher_vector(self, x: Single, posteriors: Single) -> Single:
        """Return the gradient of the log likelihood, by means and deviations.

        Parameters
        ----------
        x : ndarray of float32, shape (n, d)
            Descriptors.
        posteriors : ndarray of float32, shape (n, K)
            Of these descriptors.

        Returns
        -------
        ndarray of float32, shape (2 K d,)
            First by the means, then by the standard deviations, each divided by the square root
            of the Fisher information; 0 for no descriptors.

        References
        ----------
        Perronnin, Sanchez and Mensink, Improving the Fisher kernel for large-scale image
        classification, ECCV 2010.
        """
        if len(x) == 0:
            return np.zeros(2 * self.means.size, np.float32)
        zeroth = posteriors.sum(axis=0, dtype=np.float64)[:, None]
        first = (posteriors.T @ x).astype(np.float64)
        second = (posteriors.T @ (x**2)).astype(np.float64)
        means, deviations = self.means, np.sqrt(self.variances)
        shares = len(x) * np.sqrt(self.weights)[:, None]
        by_mean = (first - zeroth * means) / deviations / shares
        spread = second - 2 * means * first + zeroth * means**2
        by_deviation = (spread / self.variances - zeroth) / (shares * np.sqrt(2))
        return np.concatenate([by_mean.ravel(), by_deviation.ravel()]).astype(np.float32)


def power_normalised(vector: Single) -> Single:
    """Return the signed square roots, made to unit length; zeros stay so."""
    rooted = np.sign(vector) * np.sqrt(np.abs(vector))
    length = np.linalg.norm(rooted)
    return np.asarray(rooted / length if length > 0 else rooted, dtype=np.float32)


def _single(values: NDArray[np.floating]) -> Single:
    return np.asarray(values, dtype=np.float32)
