"""The synthetic sample is what it claims to be, by formulas of its own."""

import numpy as np
from survey_samples import CHI2, KMO, TABLE_3, N, exact_sample, kmo_of, table_3_correlation


def test_the_population_has_the_printed_figures_and_table_3_as_its_component_space():
    r = table_3_correlation()
    p = len(r)
    assert abs(kmo_of(r) - KMO) < 1e-9
    assert abs(-(N - 1 - (2 * p + 5) / 6) * np.linalg.slogdet(r)[1] - CHI2) < 1e-7
    # ΛΛᵀ is the part of R within the space of Λ, so the residual does not reach into it.
    assert np.abs(TABLE_3.T @ (r - TABLE_3 @ TABLE_3.T)).max() < 1e-9


def test_an_exact_sample_has_exactly_the_moments_asked_for():
    r = table_3_correlation()
    sample = exact_sample(r, N, seed=5)
    assert np.abs(np.corrcoef(sample, rowvar=False) - r).max() < 1e-12
    assert np.abs(sample.mean(axis=0)).max() < 1e-14
