"""Confirmatory factor analysis against R's lavaan, recorded with the versions that made it.

Of Holzinger and Swineford's answers (1939) only sums are recorded. Likelihood depends on nothing else, so rows with the
same sums come through the command to the same figures; for DWLS the correlations and the covariance of their errors
take the place of the rows. Our own synthetic samples come through as rows for every estimator.
"""

import json

import numpy as np
import pytest
from lavaan_record import LIMIT, apart, recorded, same_sums, write_rows
from scipy.special import ndtri

from survey.analysis.confirmatory import Fit, Polychorics, parsed, weighted_of
from survey.analysis.correlation import INFINITY, solved_tables
from survey.cli import main
from survey.demonstration import sample_file

TOLD = recorded()
FITS = TOLD["fits"]
SCHOOL = tuple(f"x{at}" for at in range(1, 10))


def confirmed(capsys, *arguments: object) -> dict:
    assert main(["confirm", *map(str, arguments), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def within(found: dict[str, float]) -> bool:
    return all(value <= LIMIT for value in found.values()) and bool(found)


def test_the_record_names_its_makers_and_holds_no_rows():
    assert TOLD["lavaan"].startswith("0.6")
    assert TOLD["R"].startswith("R version")
    assert "1939" in TOLD["source"]
    assert all(part["n"] > len(part["items"]) for part in FITS["school_gaps"]["moments"])
    assert sum(part["n"] for part in FITS["school"]["moments"]) == 301


@pytest.mark.parametrize("name", ["school", "school_more", "school_one"])
def test_maximum_likelihood_is_lavaan_s(name, tmp_path, capsys):
    rows = write_rows(tmp_path / "rows.csv", SCHOOL, same_sums(FITS["school"]["moments"], SCHOOL))
    found = confirmed(capsys, rows, "--model", FITS[name]["model"])
    assert found["estimator"] == "ml"
    assert found["n"] == FITS[name]["n"] == 301
    assert within(apart(FITS[name], found)), apart(FITS[name], found)


def test_full_information_with_gaps_is_lavaan_s(tmp_path, capsys):
    told = FITS["school_gaps"]
    rows = write_rows(tmp_path / "gaps.csv", SCHOOL, same_sums(told["moments"], SCHOOL))
    found = confirmed(capsys, rows, "--model", told["model"])
    assert found["estimator"] == "fiml"
    assert within(apart(told, found)), apart(told, found)
    whole = confirmed(capsys, rows, "--model", told["model"], "--missing", "listwise")
    assert whole["n"] == 120
    assert whole["fit"]["chi2"] != pytest.approx(found["fit"]["chi2"], abs=1.0)


@pytest.mark.parametrize(
    ("name", "sample", "more"),
    [
        ("likert", "likert-200", []),
        ("likert_gaps", "likert-200-gaps", []),
        ("likert_ordinal", "likert-200", ["--estimator", "dwls"]),
    ],
)
def test_our_samples_from_their_rows_to_lavaan_s_figures(name, sample, more, capsys):
    found = confirmed(capsys, sample_file(sample), "--model", FITS[name]["model"], *more)
    assert found["n"] == 200
    assert within(apart(FITS[name], found)), apart(FITS[name], found)


def test_answers_cut_into_five_categories_come_to_lavaan_s_dwls_and_wlsmv():
    told = FITS["school_five"]
    p, r = len(SCHOOL), np.array(told["correlations"])
    errors = np.array(told["errors"])
    assert told["items"] == list(SCHOOL)
    by_column = [(i, j) for j in range(p) for i in range(j + 1, p)]
    order = [by_column.index((int(i), int(j))) for i, j in zip(*np.tril_indices(p, -1), strict=True)]
    nothing = np.full((p, 6), np.nan)
    seen = Polychorics(301, r, errors[np.ix_(order, order)], nothing, nothing, None)  # pyright: ignore[reportArgumentType]
    found = weighted_of(seen, SCHOOL, parsed(told["model"]))
    assert max(differences(told["fit"], found.fit, "")) <= LIMIT
    assert max(differences(told["robust"], found.scaled, ".scaled")) <= LIMIT
    assert found.factor == pytest.approx(told["robust"]["chisq.scaling.factor"], abs=LIMIT)
    assert found.shift == pytest.approx(told["shift"], abs=LIMIT)
    loads, spread, _ = found.structure.matrices(found.theta)
    names = ("visual", "textual", "speed")
    errors = np.sqrt(np.diag(found.variance))
    free = {cell: errors[at] for at, cell in enumerate(found.structure.loadings)}
    for one in told["estimates"]:
        if one["op"] == "=~":
            cell = SCHOOL.index(one["rhs"]), names.index(one["lhs"])
            assert loads[cell] == pytest.approx(one["est"], abs=LIMIT)
            assert free.get(cell, 0.0) == pytest.approx(one["se"], abs=LIMIT)
        if one["op"] == "~~" and one["lhs"] in names:
            cell = names.index(one["lhs"]), names.index(one["rhs"])
            assert spread[cell] == pytest.approx(one["est"], abs=LIMIT)


def test_thresholds_and_polychorics_of_the_cut_answers_are_lavaan_s():
    """From the tables of all pairs, which is all that both depend on."""
    told = FITS["school_five"]
    counts = np.array([one["counts"] for one in told["tables"]], dtype=np.float64)
    cuts = {}
    for one, table in zip(told["tables"], counts, strict=True):
        for item, often in ((one["row"], table.sum(axis=1)), (one["col"], table.sum(axis=0))):
            cuts[item] = np.array([-INFINITY, *ndtri(np.cumsum(often)[:-1] / 301), INFINITY])
    for item, own in cuts.items():
        theirs = [told["thresholds"][f"{item}|t{at}"] for at in range(1, 5)]
        assert own[1:-1] == pytest.approx(theirs, abs=LIMIT)
    across, down = (np.array([cuts[one[side]] for one in told["tables"]]) for side in ("row", "col"))
    r = np.array(told["correlations"])
    for one, rho in zip(told["tables"], solved_tables(counts, across, down), strict=True):
        assert rho == pytest.approx(r[SCHOOL.index(one["row"]), SCHOOL.index(one["col"])], abs=LIMIT)


def differences(theirs: dict, ours: Fit, suffix: str) -> list[float]:
    mine = {
        "chisq": ours.chi2, "df": ours.df, "pvalue": ours.p, "cfi": ours.cfi, "tli": ours.tli, "rmsea": ours.rmsea,
        "rmsea.ci.lower": ours.rmsea_low, "rmsea.ci.upper": ours.rmsea_high, "baseline.chisq": ours.base.chi2,
    }  # fmt: skip
    return [abs(theirs[f"{key}{suffix}"] - value) for key, value in mine.items() if value is not None]
