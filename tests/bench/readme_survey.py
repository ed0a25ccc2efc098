"""The figures in survey/README.md, written from what `survey bench` measured; nothing is typed in.

survey bench && python tests/bench/readme_survey.py
"""

import json
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
FIGURES = ROOT / "docs" / "figures"
README = ROOT / "survey" / "README.md"
BEGIN, END = "<!-- figures: python tests/bench/readme_survey.py -->", "<!-- end of figures -->"
EXACT = ("r", "probability", "kmo", "kmo_per_item", "chi2", "eigenvalues", "alpha", "alpha_if_deleted", "map")


def read(name: str):
    return json.loads((FIGURES / f"survey_{name}.json").read_text("utf-8"))


def service() -> list[tuple[str, str, str]]:
    found = read("service")
    load, order, kills, full, rules = (found[key] for key in ("load", "order", "kills", "full", "conformity"))
    speeds = load["per_second_of_rounds"]
    speed = (
        f"**{load['per_second']:,.0f} / s** (median of {len(speeds)} rounds, {speeds[0]:,.0f}–{speeds[-1]:,.0f}), "
        f"p50 {load['p50_ms']:.0f} ms, p99 {load['p99_ms']:.0f} ms"
    )
    kept = f"{kills['acknowledged']:,} acknowledged: {kills['lost']} lost, {kills['partial']} partial"
    refused = (
        f"{full['refused']} refused ({', '.join(map(str, full['statuses']))}), {full['taken_after']} taken"
    )
    return [
        (
            f"submissions at {load['clients']} clients, full sync, client and service on {load['cores']} cores",
            speed,
            "≥ 1,000 / s, p99 ≤ 100 ms",
        ),
        ("a bare loop of one write and one sync beside it", f"{load['bare_syncs_per_second']:,.0f} / s", "–"),
        (
            f"receipts sent before the sync, of {order['receipts']}, seen by strace",
            str(order["before_the_sync"]),
            "0",
        ),
        (f"{kills['kills']} kills in mid-write", f"{kept}, {kills['doubled_or_unknown']} doubled", "0, 0, 0"),
        (
            "a full disk, then room again",
            f"{refused} when there was room, {full['lost']} lost",
            "503, all, 0",
        ),
        *(exports(found["exports"]) if "exports" in found else []),
        (
            f"schemathesis, all checks, {rules['examples']} examples an operation",
            f"{rules['failures']} failures in {rules['cases']:,} cases",
            "0",
        ),
    ]


def exports(found: dict) -> list[tuple[str, str, str]]:
    spent = ", ".join(
        f"{kind.upper()} {found['export_s'][kind]:.1f} s" for kind in ("csv", "xlsx", "sav", "json")
    )
    many = f"{found['answers']:,} × {found['items']} answers"
    waiting = " / ".join(f"{found[what]['p99_ms']:.0f} ms" for what in ("submissions", "results"))
    alone = " / ".join(f"{found['alone'][what]['p99_ms']:.0f} ms" for what in ("submissions", "results"))
    took = found["analysis_s"]
    return [
        (
            f"p99 of submissions / of results during exports of {many}",
            f"{waiting} (without: {alone})",
            "≤ 100 ms",
        ),
        (
            f"analysis of {many} from the store, over HTTP / by command with its 1,000 resamples",
            f"{took['http']:.1f} s / {took['command']:.1f} s",
            "≤ 5 s",
        ),
        (f"exports of {many}, each beside visitors", spent, "–"),
    ]


def analysis() -> list[tuple[str, str, str]]:
    found, beside = read("analysis")["targets"], read("analysis")["beside_factor_analyzer"]
    ours = max(row["varimax_error_ours"] for row in beside)
    theirs = max(row["varimax_error_factor_analyzer"] for row in beside)
    return [
        (
            "20 × 12 with 1,000 resamples and parallel analysis, in process",
            f"{found['in_process_20x12_s']:.2f} s",
            "≤ 2 s",
        ),
        ("the same, the whole command", f"{found['command_20x12_s']:.1f} s", "≤ 6 s"),
        (
            "100,000 × 25 without resamples and parallel analysis",
            f"{found['in_process_100000x25_s']:.2f} s",
            "≤ 3 s",
        ),
        *(
            (
                f"100,000 × {items} from the store with 1,000 resamples and parallel analysis, the whole command",
                f"{found[f'command_100000x{items}_s']:.1f} s",
                "≤ 5 s",
            )
            for items in (12, 25)
            if f"command_100000x{items}_s" in found
        ),
        (
            "varimax from the best of a hundred starts, factor_analyzer's beside it",
            f"{ours:.0e} / {theirs:.0e}",
            "≤ 1e-6",
        ),
    ]


def beside_r() -> list[tuple[str, str, str]]:
    found = read("r")
    rows = found["differences"].values()

    scales = found["scales"].values()
    figures = ("alpha", "standardised", "if_deleted", "item_total")
    exact = max(row[key] for row in scales for key in figures)
    omega = max(row["omega"] for row in scales)
    minres = max(row["omega_minres"] for row in scales)

    def most(*keys: str) -> float:
        return max(row[key] for row in rows for key in keys if key in row)

    return [
        (
            f"r, p, KMO, Bartlett, eigenvalues, α, MAP beside psych {found['psych']}, {len(rows)} data sets",
            f"{most(*EXACT):.0e}",
            "≤ 1e-10",
        ),
        (
            "varimax beside GPArotation's optimum, psych's own beside it",
            f"{most('varimax'):.0e} / {most('varimax_of_psych'):.0e}",
            "≤ 1e-6",
        ),
        (
            "bfi by scale through the command: α, item-total r, α without an item beside psych's `alpha`",
            f"{exact:.0e}",
            "≤ 1e-10",
        ),
        (
            "ω beside R's factanal; beside psych's `omega` as it comes (minres, another ω)",
            f"{omega:.0e}; {minres:.0e}",
            "≤ 1e-6; –",
        ),
    ]


def table() -> str:
    lines = ["| What | Measured | Asked |", "|---|---|---|"]
    lines += [f"| {what} | {value} | {asked} |" for what, value, asked in service() + analysis() + beside_r()]
    return "\n".join(lines)


def main() -> int:
    before, rest = README.read_text("utf-8").split(BEGIN)
    made = table()
    README.write_text(before + BEGIN + "\n\n" + made + "\n\n" + END + rest.split(END)[1], "utf-8")
    print(made)
    return 0


if __name__ == "__main__":
    sys.exit(main())
