"""Our confirmatory factor analysis beside R's lavaan, from the same rows, in one run: differences and times.

    apt-get install r-cran-lavaan r-cran-jsonlite
    survey bench --only lavaan [-- --record] [--json FILE]

--record writes what lavaan says to tests/survey/recorded/lavaan.json, which the tests read where there is no R. The
Holzinger–Swineford answers (1939) come with lavaan; only sums of them are recorded, the rows stay in a folder that is
gone when the run ends.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from signature import signed

from survey.cli import main as survey
from survey.demonstration import sample_file

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent
sys.path.append(str(HERE.parent / "survey"))
from lavaan_record import LIMIT, RECORDED, apart  # noqa: E402

# Of each fit the table and what `survey confirm` is told.
FITS = {
    "school": ("school-rows", []),
    "school_more": ("school-rows", []),
    "school_one": ("school-rows", []),
    "school_gaps": ("school-gaps", []),
    "school_five": ("school-five", ["--estimator", "dwls"]),
    "likert": ("likert-200", []),
    "likert_gaps": ("likert-200-gaps", []),
    "likert_ordinal": ("likert-200", ["--estimator", "dwls"]),
}


def there() -> bool:
    """Whether R has what it needs."""
    if shutil.which("Rscript") is None:
        return False
    asked = "library(lavaan); library(jsonlite)"
    return subprocess.run(["Rscript", "-e", asked], capture_output=True, check=False).returncode == 0


def compared(folder: Path) -> tuple[dict, dict[str, dict[str, float]], float, float]:
    """lavaan's record, the differences by fit, and the seconds that each side took."""
    for name in ("likert-200", "likert-200-gaps"):
        shutil.copy(sample_file(name), folder / f"{name}.csv")
    start = perf_counter()
    subprocess.run(
        ["Rscript", str(HERE / "survey_lavaan.R"), str(folder), str(folder / "out.json")],
        check=True,
        stderr=subprocess.DEVNULL,
    )
    theirs = perf_counter() - start
    made = json.loads((folder / "out.json").read_text("utf-8"))
    rows = {}
    start = perf_counter()
    for name, (table, more) in FITS.items():
        told = made["fits"][name]
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            survey(["confirm", str(folder / f"{table}.csv"), "--model", told["model"], *more, "--json"])
        rows[name] = apart(told, json.loads(out.getvalue()))
    return made, rows, theirs, perf_counter() - start


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--json", type=Path, default=ROOT / "docs" / "figures" / "survey_lavaan.json")
    args = parser.parse_args()
    if not there():
        print("left out: no Rscript with lavaan – apt-get install r-cran-lavaan r-cran-jsonlite")
        return 0
    with tempfile.TemporaryDirectory() as name:
        made, rows, theirs, ours = compared(Path(name))
    keys = list(dict.fromkeys(key for row in rows.values() for key in row))
    print(f"{'largest difference':20}" + "".join(f"{key[:12]:>14}" for key in keys))
    for name, row in rows.items():
        print(f"{name:20}" + "".join(f"{row[key]:14.1e}" if key in row else f"{'–':>14}" for key in keys))
    print(f"{made['R']}, lavaan {made['lavaan']}: {theirs:.1f} s; ours {ours:.2f} s")
    if args.record:
        RECORDED.write_text(json.dumps(made, indent=None), "utf-8")
    told = {
        "R": made["R"],
        "lavaan": made["lavaan"],
        "r_seconds": theirs,
        "our_seconds": ours,
        "differences": rows,
    }
    args.json.parent.mkdir(parents=True, exist_ok=True)
    args.json.write_text(json.dumps(signed(told), indent=1) + "\n", "utf-8")
    bad = [
        f"{name}: {key} {value:.1e} apart"
        for name, row in rows.items()
        for key, value in row.items()
        if value > LIMIT
    ]
    for problem in bad:
        print(f"survey bench: {problem}", file=sys.stderr)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
