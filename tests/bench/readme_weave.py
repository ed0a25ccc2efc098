"""The table of figures in the weave room's README, written from what the bench measured; nothing is typed in.

simcore bench weave -- --large --peers --json docs/figures/weave.json --plot docs/pictures/weave-speed-error.png
python tests/bench/readme_weave.py
"""

import json
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
BEGIN, END = "<!-- figures: python tests/bench/readme_weave.py -->", "<!-- end of figures -->"


def rows(found: dict) -> list[tuple[str, str, str]]:
    """(what, aim, measured) of every figure in docs/figures/weave.json."""
    made = [
        ("stage A against closed forms", "≤ 1e-5", f"{max(r['error'] for r in found['closed']):.0e}"),
        ("stage A against a dense solver", "", f"{max(r['error'] for r in found['dense']):.0e}"),
    ]
    for row in found["plain"]:
        if row["p/d"] < 2:
            aim, value = "19.9 ± .3 %", f"{row['crimp']:.2%} (flexible yarns {row['reference']:.2%})"
            made.append((f"plain near jam, p = .88 D, P = {row['per']}", aim, value))
        else:
            what = f"plain crimp against the elastica, p/d = {row['p/d']:g}, P = {row['per']}"
            made.append((what, "± 1.5 %", f"{row['error']:+.2%}"))
    deepest = max(r["penetration"] for r in found["plain"] + found["per"])
    rest = max(r["residual"] for r in found["plain"])
    made.append(
        (
            "stage B: deepest penetration (of curves), largest residual",
            "5e-4 D, 1e-3",
            f"{deepest:.1e} D, {rest:.1e}",
        )
    )
    for flattening in (1.0, 2.0):
        of = {r["per"]: r for r in found["per"] if r["flattening"] == flattening}
        if 32 in of:
            change = of[32]["crimp"] / of[16]["crimp"] - 1
            made.append(
                (f"8 × 8 satin, flattened {flattening:g}: crimp from P = 16 to 32", "≤ 2 %", f"{change:+.2%}")
            )
        each = ", ".join(f"{p}: {r['seconds'] * 1e3:.0f} ms" for p, r in of.items())
        made.append((f"8 × 8 satin, flattened {flattening:g}: time by P", "P = 8 ≤ 200 ms", each))
    for mu in (0.3, 0.0):
        skew = max(r["skew_d"] for r in found["skew"] if r["friction"] == mu)
        made.append((f"sideways skew of a 2/2 twill, μ = {mu:g}", "≤ .05 d" if mu else "", f"{skew:.3f} d"))
    for row in found["size"]:
        aim = {40: "B ≤ 1.5 s", 400: "A ≤ 20 (8) s, B ≤ 300 (120) s"}.get(row["size"], "")
        stage_b = f", B {row['stage_b']:.1f} s" if "stage_b" in row else ""
        name = f"{row['size']} × {row['size']} damask, P = {row['per']}"
        made.append((name, aim, f"A {row['stage_a']:.2f} s{stage_b}"))
    peer = found.get("texgen")
    if peer and "ratio" in peer:
        value = f"{peer['ours_s'] * 1e3:.0f} ms against {peer['texgen_s']:.0f} s: {peer['ratio']:.0f} times"
        made.append(("8 × 8 satin, P = 8, against TexGen's refine", "≥ 200 times", value))
    maps, fuzz = found["maps_1024"], found["fuzz"]
    made.append(("map set of 1024², all seven", "≤ 1 s", f"{maps['seconds']:.2f} s"))
    value = f"{maps['share_beyond_1_255']:.1e} of the pixels beyond it"
    made.append(("tile drawn half a tile further: difference", "≤ 1/255", value))
    value = f"{fuzz['files']:,}: {fuzz['refused']:,} refused, {fuzz['not_one_line']} not in one line, "
    value += f"slowest {fuzz['slowest_s']:.2f} s"
    made.append(("WIF files damaged at random", "each ≤ 1 s", value))
    aims = {"satin": "≥ 4", "twill": "≥ 2.5"}
    for row in found.get("gleam", ()):
        what = f"highlight of {row['weave']}, lamp tilted by 40° across / along its floats"
        made.append((what, aims.get(row["weave"], ""), f"{row['ratio']:.1f}"))
    for row in found.get("damask", ()):
        value = f"{row['across']:.2f}, {row['shade']:.2f}, {row['along']:.2f}"
        what = f"figure / ground of {row['weave']}: lamp across the warp, upper left, along the warp"
        made.append((what, "≥ 1.5 one way, ≤ 1.1 the other", value))
    closed = [row for row in found.get("open", ()) if row["open"] <= 0.05]
    if closed:
        most = max(closed, key=lambda row: row["open"])
        made.append(
            (f"open, of {len(closed)} opaque weaves", "≤ .5 %", f"most {most['open']:.1%} ({most['weave']})")
        )
    for row in found.get("figured", ()):
        value = f"draft {row['draft']:.1f} s, cells {row['cells']:.1f} s, maps {row['maps']:.1f} s"
        what = f"repeat of {row['ends']:,} × {row['picks']:,} crossings, maps of 1,024², 2,048², 4,096²"
        made.append((what, "draft ≤ 2 s, cells and maps ≤ 60 s", value))
    for row in found["density"]:
        value = f"{row['g_m2']:.1f} against {row['catalogue']:g} g/m² ({row['error']:+.1%})"
        made.append((f"areal density, {row['cloth']}", "± 5 %", value))
    for row in found.get("thickness", ()):
        value = f"{row['um']:.0f} against {row['published']:g} µm ({row['error']:+.1%})"
        made.append((f"thickness, {row['cloth']}", "± 20 %", value))
    return made


def table(found: dict) -> str:
    lines = ["| What | Aim | Measured |", "|---|---|---|"]
    return "\n".join([*lines, *(f"| {what} | {aim} | {value} |" for what, aim, value in rows(found))])


def main() -> int:
    made = table(json.loads((ROOT / "docs/figures/weave.json").read_text("utf-8")))
    path = ROOT / "sim_core/weave/README.md"
    before, rest = path.read_text("utf-8").split(BEGIN)
    path.write_text(before + BEGIN + "\n\n" + made + "\n\n" + END + rest.split(END)[1], "utf-8")
    print(made)
    return 0


if __name__ == "__main__":
    sys.exit(main())
