"""How many pattern sheets of a folder are read, and how many of their pieces are meshed.

    python tests/bench/mesh_sheets.py FOLDER
    python tests/bench/mesh_sheets.py FOLDER --peers       its 32 largest pieces meshed by `best` and by gmsh, in turns

Sheets (.svg, .dxf, GarmentCode's .json) are not kept here: their licences differ. Those behind the README's figures
were written by FreeSewing 4.10 (npm: aaron, bella, brian, charlie, florence, hortensia, huey, paco, sandy, simon,
tamiko with 1 cm of seam allowance, some plain, paperless or without a size) and by Valentina 0.7.52 (flat, AAMA and
ASTM, releases 10 to 2013), and are drawings of ezdxf's own integration tests.
"""

import argparse
import contextlib
import json
import sys
import warnings
from pathlib import Path
from time import perf_counter

import numpy as np
from peers import Peers, add_peers, peer_python

from sim_core.errors import SimCoreError
from sim_core.mesh import panel_mesh
from sim_core.mesh.measures import quality
from sim_core.mesh.outline import signed_area
from sim_core.mesh.sheets import Choice, panel_of, read_sheet

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from exact_delaunay import delaunay_faults  # noqa: E402

FINE = 40  # edges along a piece's longer side


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--json", type=Path, metavar="FILE")
    add_peers(parser, "beside gmsh")
    parser.add_argument("--points", type=int, default=3000, help="of a panel beside gmsh")
    args = parser.parse_args()
    files = sorted(p for p in args.folder.rglob("*") if p.suffix.lower() in (".svg", ".dxf", ".json"))
    if args.peers:
        beside_gmsh(largest_pieces(files, 32), args.points, Peers(peer_python(args.peers)))
        return
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


def largest_pieces(files: list[Path], count: int) -> list[tuple[str, np.ndarray, tuple[np.ndarray, ...]]]:
    """Name, outline and holes [m] of the largest pieces that differ in area or length."""
    found = {}
    for path in files:
        with warnings.catch_warnings(), contextlib.suppress(SimCoreError):
            warnings.simplefilter("ignore")
            sheet = read_sheet(path)
            for piece in sheet.pieces:
                panel, _ = panel_of(path, sheet, Choice(piece.name))
                area = abs(signed_area(np.asarray(panel.outline, float)))
                size = tuple(np.round(np.ptp(panel.outline, axis=0), 3))
                found.setdefault(
                    (round(area, 4), size), (f"{path.stem} {piece.name}", panel.outline, panel.holes)
                )
    return [found[key] for key in sorted(found, reverse=True)[:count]]


def beside_gmsh(pieces: list, points: int, peers: Peers) -> None:
    """`best` and gmsh on one outline, in turns: smallest angle, time, and edges of ours that are not Delaunay."""
    ratios, angles = [], []
    for name, outline, holes in pieces:
        edge = float(np.sqrt(abs(signed_area(np.asarray(outline, float))) / points * 2 / np.sqrt(3)))
        own, other = [], []
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for turn in range(4):
                begin = perf_counter()
                mesh = panel_mesh(outline, edge=edge, holes=holes, quality="best")
                own.append(perf_counter() - begin)
                rims = [mesh.vertices[loop] * (1, -1) for loop in mesh.boundary]
                lengths = np.array([len(rim) for rim in rims])
                made = peers.run("gmsh", points=np.concatenate(rims), lengths=lengths, edge=np.float64(edge))
                other.append(made["seconds"])
                if turn == 0:  # what is compiled or loaded once
                    own, other = [], []
        steps = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in mesh.boundary])
        faults = len(delaunay_faults(mesh.vertices, mesh.faces, steps))
        theirs = quality(made["vertices"] * (1, -1), made["faces"]).min_angle.min()
        mine = mesh.report.min_angle_deg
        ratios.append(np.median(np.array(other) / np.array(own)))
        angles.append((mine, theirs))
        print(
            f"{name:40.40} {len(mesh.vertices):6} {np.median(own):7.4f} s  {mine:5.1f}°  gmsh {len(made['vertices']):6}"
            f" {np.median(other):7.4f} s  {theirs:5.1f}°  {ratios[-1]:5.2f} x  not Delaunay {faults}",
            flush=True,
        )
    mine, theirs = np.array(angles).T
    print(
        f"{len(pieces)} panels: best at or above gmsh on {(mine >= theirs).sum()}, median {np.median(mine):.1f}° and "
        f"{np.median(theirs):.1f}°, least {mine.min():.1f}° and {theirs.min():.1f}°; gmsh takes "
        f"{np.median(ratios):.2f} times as long ({min(ratios):.2f} to {max(ratios):.2f})"
    )


if __name__ == "__main__":
    main()
