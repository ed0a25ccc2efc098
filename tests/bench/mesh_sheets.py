"""How many pattern sheets of a folder are read, and how many of their pieces are meshed.

    python tests/bench/mesh_sheets.py FOLDER

Sheets (.svg, .dxf, GarmentCode's .json) are not kept here: their licences differ. Those behind the README's figures
were written by FreeSewing 4.10 (npm: aaron, bella, brian, charlie, florence, hortensia, huey, paco, sandy, simon,
tamiko with 1 cm of seam allowance, some plain, paperless or without a size) and by Valentina 0.7.52 (flat, AAMA and
ASTM, releases 10 to 2013), and are drawings of ezdxf's own integration tests.
"""

import argparse
import json
import warnings
from pathlib import Path
from time import perf_counter

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.mesh import panel_mesh
from sim_core.mesh.sheets import Choice, panel_of, read_sheet

FINE = 40  # edges along a piece's longer side


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--json", type=Path, metavar="FILE")
    args = parser.parse_args()
    files = sorted(p for p in args.folder.rglob("*") if p.suffix.lower() in (".svg", ".dxf", ".json"))
    rows = [measured(path) for path in files]
    for row in rows:
        told = f"{row['pieces']:3} pieces, {row['meshed']:3} meshed  {row['problem']}"
        print(f"{row['file']:40} {row['seconds']:6.2f} s  {told}")
    for kind in sorted({row["kind"] for row in rows}):
        own = [row for row in rows if row["kind"] == kind]
        read = sum(row["pieces"] > 0 for row in own)
        pieces, meshed = (sum(row[key] for row in own) for key in ("pieces", "meshed"))
        print(
            f"{kind}: {read} of {len(own)} sheets read, {meshed} of {pieces} pieces meshed along their outline"
        )
    if args.json:
        args.json.write_text(json.dumps(rows, indent=2))


def measured(path: Path) -> dict:
    """What became of one sheet."""
    row = {"file": path.name, "kind": path.suffix.lower(), "pieces": 0, "meshed": 0, "problem": ""}
    begin = perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            sheet = read_sheet(path)
        except SimCoreError as error:
            return {
                **row,
                "seconds": perf_counter() - begin,
                "problem": str(error).removeprefix(f"{path}: ")[:90],
            }
        row["seconds"] = perf_counter() - begin
        row["pieces"] = len(sheet.pieces)
        for piece in sheet.pieces:
            try:
                panel, _ = panel_of(path, sheet, Choice(piece.name))
                edge = float(np.ptp(panel.outline, axis=0).max()) / FINE
                panel_mesh(panel.outline, edge=edge, holes=panel.holes, constraints=panel.lines)
                row["meshed"] += 1
            except SimCoreError as error:
                row["problem"] = f"{piece.name}: {error}"[:90]
    return row


if __name__ == "__main__":
    main()
