"""Depthwise spiral convolution: every channel has a weight of its own for each place of the spiral.

A full spiral convolution (Lim et al. 2018) mixes channels and places at once, L W² multiplications a vertex; here
places are mixed channel by channel, L W, and channels afterwards by a matrix of their own, as image networks have done
since MobileNet (Howard et al. 2017). The same compiled loops train and infer.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from sim_core.learn.topology import unsigned

__all__ = ["depthwise", "depthwise_gradients"]

FREE_ORDER = {"contract", "reassoc", "nsz", "arcp"}  # what sums in lanes need


@njit(cache=True, fastmath=FREE_ORDER)
def _depthwise(features, spirals, weights, out):
    for i in range(len(out)):
        row = out[i]
        row[:] = 0
        for k in range(spirals.shape[1]):
            source, weight = features[spirals[i, k]], weights[k]
            for c in range(len(row)):
                row[c] += weight[c] * source[c]


@njit(cache=True, fastmath=FREE_ORDER)
def _gradients(features, spirals, weights, of_out, of_features, of_weights):
    of_features[:], of_weights[:] = 0, 0
    for i in range(len(of_out)):
        row = of_out[i]
        for k in range(spirals.shape[1]):
            n = spirals[i, k]
            source, weight, into, sums = features[n], weights[k], of_features[n], of_weights[k]
            for c in range(len(row)):
                into[c] += weight[c] * row[c]
                sums[c] += source[c] * row[c]


def depthwise(features: np.ndarray, spirals: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """out[i, c] = sum over k of weights[k, c] features[spirals[i, k], c], (V, W) of the features' kind.

    features: (V, W); spirals: (V, L) int32; weights: (L, W).
    """
    out = np.empty_like(features)
    _depthwise(features, unsigned(spirals), weights, out)
    return out


def depthwise_gradients(
    features: np.ndarray, spirals: np.ndarray, weights: np.ndarray, of_out: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Gradients by features (V, W) and by weights (L, W) of what has the gradient of_out (V, W) by `depthwise`."""
    of_features, of_weights = np.empty_like(features), np.empty_like(weights)
    _gradients(features, unsigned(spirals), weights, of_out, of_features, of_weights)
    return of_features, of_weights
