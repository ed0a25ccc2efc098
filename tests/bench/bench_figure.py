"""How a figure's joints crease: linear blend against dual quaternions, by joint and angle; prints a table, writes JSON.

Each joint is bent alone, from the T-pose of every figure in assets/mannequins. Volume: of the whole figure against that
of its T-pose, as a share of the volume that the joint's weights are mixed in (where no bone has more than 95 %).
Narrowest: the smallest section at the joint, across the bisector of both bones, against that of the straight limb.
Sharpest: the 1st percentile of the angle between neighbouring faces there, 180 degrees being flat, and that at rest.
Cuts: pairs of faces that pass through each other.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from sim_core import metrics
from sim_core.body import JOINTS, PARENTS, Mannequin, Pose, dual_quaternion_skin, linear_skin

FOLDER = Path(__file__).parents[2] / "assets" / "mannequins"
BENT = {  # the joint bent, the joint its limb ends at, and the rotation vector [degrees] at an angle
    "elbow": ("elbow_l", "wrist_l", (0.0, -1.0, 0.0)),
    "hip": ("hip_l", "knee_l", (-1.0, 0.0, 0.0)),
    "knee": ("knee_l", "ankle_l", (1.0, 0.0, 0.0)),
    "shoulder": ("shoulder_l", "elbow_l", (0.0, 0.0, -1.0)),
    "wrist, rolled": ("wrist_l", "tip_l", (1.0, 0.0, 0.0)),
}
CASES = (
    ("elbow", 45),
    ("elbow", 90),
    ("hip", 30),
    ("hip", 60),
    ("knee", 60),
    ("shoulder", 60),
    ("wrist, rolled", 45),
)
SKINS = {"linear": linear_skin, "dual": dual_quaternion_skin}


def measured(figure: Mannequin, joint: str, angle: float, skin: str) -> dict[str, float]:
    """Volume, section, sharpness and cuts of one joint bent by an angle [degrees]."""
    name, end, axis = BENT[joint]
    pose = Pose.from_rotvecs({name: tuple(angle * c for c in axis)})
    rest = figure.vertices
    bent = SKINS[skin](rest, figure.weights, figure.skeleton, pose)
    column = figure.weights[:, _under(name)].sum(1)
    mixed = (column > 0.05) & (column < 0.95)
    near = mixed[figure.faces].all(1)
    before, after = figure.landmarks(), figure.landmarks(pose)
    bone = after[end] - after[name], before[end] - before[name]
    # the plane through the joint that halves the angle of its bones; at rest both go the same way
    normal = bone[0] / np.linalg.norm(bone[0]) + bone[1] / np.linalg.norm(bone[1])
    sections = [
        section_area(x, figure.faces, at[name], n, near)
        for x, at, n in ((bent, after, normal), (rest, before, bone[1]))
    ]
    edges = sharp(bent, figure.faces, near), sharp(rest, figure.faces, near)
    space = volume(rest, figure.faces[near], before[name])
    return {
        "volume": (volume(bent, figure.faces) - volume(rest, figure.faces)) / space,
        "section": sections[0] / sections[1] - 1.0 if sections[1] > 0 else float("nan"),
        "sharpest_deg": edges[0],
        "sharpest_rest_deg": edges[1],
        "cuts": metrics.intersections(bent, figure.faces),
    }


def _under(joint: str) -> list[int]:
    """Indices of a joint and of all that hang on it."""
    kept = [JOINTS.index(joint)]
    for number, parent in enumerate(PARENTS):
        if parent in kept:
            kept.append(number)
    return kept


def volume(x: np.ndarray, faces: np.ndarray, about: np.ndarray | float = 0.0) -> float:
    """Of a closed mesh, or of the cone of faces over a point [m3]."""
    a, b, c = (x[faces[:, k]] - about for k in range(3))
    return float(abs((np.cross(a, b) * c).sum()) / 6)


def sharp(x: np.ndarray, faces: np.ndarray, near: np.ndarray) -> float:
    """1st percentile of the angle [degrees] between neighbouring faces, 180 where flat."""
    normal = np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
    order = np.argsort(edges[:, 0] * len(x) + edges[:, 1], kind="stable")
    pair = order.reshape(-1, 2) // 3
    pair = pair[near[pair].all(1)]
    cosine = (normal[pair[:, 0]] * normal[pair[:, 1]]).sum(1).clip(-1, 1)
    return 180.0 - float(np.degrees(np.percentile(np.arccos(cosine), 99)))


def section_area(
    x: np.ndarray, faces: np.ndarray, at: np.ndarray, normal: np.ndarray, near: np.ndarray
) -> float:
    """Area [m2] that the faces `near` enclose in the plane through `at` across `normal`."""
    n = normal / np.linalg.norm(normal)
    u = np.cross(n, [0.0, 0.0, 1.0] if abs(n[2]) < 0.9 else [1.0, 0.0, 0.0])
    u /= np.linalg.norm(u)
    v = np.cross(n, u)
    height, total = (x - at) @ n, 0.0
    for face in faces[near]:
        cut = []
        for i, j in ((face[0], face[1]), (face[1], face[2]), (face[2], face[0])):
            if (height[i] < 0) != (height[j] < 0):
                t = height[i] / (height[i] - height[j])
                p = (1 - t) * x[i] + t * x[j] - at
                cut.append((p @ u, p @ v, height[i] < 0))
        if len(cut) == 2:
            (a, b, up), (c, d, _) = cut
            total += 0.5 * (a * d - b * c) * (1.0 if up else -1.0)
    return abs(total)


def main() -> None:
    """Measures all figures and prints the table of each."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--quick", action="store_true", help="the elbow at 90 and the hip at 60 of one figure"
    )
    parser.add_argument("--json", type=Path, help="where to write the table")
    args = parser.parse_args()
    files = sorted(FOLDER.glob("*.npz"))
    cases = (("elbow", 90), ("hip", 60)) if args.quick else CASES
    rows = []
    for file in files[:1] if args.quick else files:
        figure = Mannequin.load(file)
        print(f"{figure.name:12} {'joint':>14}  skin    volume  section  sharpest (rest)  cuts")
        for joint, angle in cases:
            for skin in SKINS:
                row = measured(figure, joint, angle, skin)
                rows.append({"figure": figure.name, "joint": joint, "angle_deg": angle, "skin": skin, **row})
                print(
                    f"{'':12} {joint:>14} {angle:3d}° {skin:7} {row['volume']:+6.1%}  {row['section']:+6.1%}  "
                    f"{row['sharpest_deg']:6.1f} ({row['sharpest_rest_deg']:5.1f})°  {row['cuts']:4d}"
                )
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
