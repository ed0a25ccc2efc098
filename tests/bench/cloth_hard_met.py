"""Hard cases of contact: a spike, a ring, ten layers, a twisted tube, a knot."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from cloth_course import Course, Outcome, Setting, calm

from sim_core.cloth import Capsule, Contact, HalfSpace, Sheet, Solid, Union
from sim_core.cloth.scenes import GF_CM, equilateral_sheet


def settling(first: float, then: float, frames: int) -> Callable[[int], float]:
    """Damping [1/s]: little for so many frames, then much."""
    return lambda frame: first if frame < frames else then


def on_a_spike() -> Outcome:
    """A cloth falls level on a spike of 4 mm over a floor: it stays outside both, and comes to rest."""
    rest, faces = equilateral_sheet(0.4, 0.4, 0.02)
    sheet = Sheet.of(rest, faces, replace(GF_CM, friction=0.6))
    start = np.column_stack([rest[:, 0] - 0.2, np.full(len(rest), 0.27), rest[:, 1] - 0.2])
    spike = Union((Capsule((0, 0, 0), (0, 0.25, 0), 0.004), HalfSpace()))
    contact = Contact(clearance=0.003, thickness=0.002)
    damping = settling(1.0, 6.0, 25)
    return calm(Setting(sheet, start, 250, collider=spike, contact=contact, damping=damping))


def ring(radius: float, thick: float, parts: int = 24) -> Solid:
    angle = 2 * np.pi * np.arange(parts + 1) / parts
    at = [(float(radius * np.cos(a)), 0.0, float(radius * np.sin(a))) for a in angle]
    return Union(tuple(Capsule(p, q, thick) for p, q in zip(at[:-1], at[1:], strict=True)))


def through_a_ring(speed: float) -> Outcome:
    """A cloth of 0.3 m is drawn by its middle through a ring 9 cm wide, and held when it is through."""
    rest, faces = equilateral_sheet(0.3, 0.3, 0.012)
    sheet = Sheet.of(rest, faces, replace(GF_CM, friction=0.2))
    start = np.column_stack([rest[:, 0] - 0.15, np.full(len(rest), 0.02), rest[:, 1] - 0.15])
    middle = np.argsort(((rest - 0.15) ** 2).sum(1))[:7].tolist()
    contact = Contact(
        clearance=0.003,
        thickness=0.002,
        skin=0.003,
        spring=0.1,  # with .03 a few edges of the crease slip through at 8 m/s
        cap=0.003,
        speed_limit=max(3.0, 1.5 * speed),
    )
    home, drawn = start[middle], int(np.ceil(0.48 / speed * 25))

    def drive(frame: int) -> np.ndarray:
        return home - [0.0, min(0.48, speed * (frame + 1) / 25), 0.0]

    def through(run: Course) -> tuple[bool, str]:
        share = float((run.end[:, 1] < 0.0).mean())
        return share > 0.99, f"{100 * share:.0f} % through"

    damping = settling(4.0, 6.0, drawn)
    kinds = {"collider": ring(0.051, 0.006), "contact": contact, "damping": damping, "drive": drive}
    return calm(Setting(sheet, start, drawn + 125, middle, free=drawn, **kinds), also=through)


def layers(count: int = 10) -> Outcome:
    """Ten sheets fall on each other on a floor: none passes another, all come to rest."""
    rest, faces = equilateral_sheet(0.12, 0.12, 0.02)
    rng, size = np.random.default_rng(5), len(rest)
    flat = np.concatenate([rest + [0.5 * k, 0.0] for k in range(count)])
    index = np.concatenate([faces + size * k for k in range(count)])
    level = [
        np.column_stack([rest[:, 0], np.full(size, 0.004 + 0.005 * k), rest[:, 1]]) for k in range(count)
    ]
    start = np.concatenate(
        [
            one + np.array([a, 0.0, b])
            for one, (a, b) in zip(level, rng.normal(0, 0.004, (count, 2)), strict=True)
        ]
    )
    contact = Contact(clearance=0.002, sample_clearance=0.001, thickness=0.003)

    def apart(run: Course) -> tuple[bool, str]:
        gap = 1e3 * float(np.diff(run.end[:, 1].reshape(count, size).mean(1)).min())
        return gap > 0.5, f"least gap {gap:.2f} mm"

    damping = settling(2.0, 10.0, 10)
    sheet = Sheet.of(flat, index, GF_CM)
    given = Setting(sheet, start, 45, collider=HalfSpace(), contact=contact, damping=damping)
    return calm(given, also=apart)


def twisted() -> Outcome:
    """A tube of cloth, 10 cm wide and 30 long, twisted by a full turn and back: nothing has passed."""
    around, along, radius, step = 24, 24, 0.05, 0.0125
    grid = np.arange(around * (along + 1)).reshape(along + 1, around)
    side = 2 * np.pi * radius / around
    faces, corner = [], []
    for row in range(along):
        for c in range(around):
            d = (c + 1) % around
            a, b, e, f = grid[row, c], grid[row, d], grid[row + 1, c], grid[row + 1, d]
            u, w, h = np.array([c * side, row * step]), np.array([side, 0.0]), np.array([0.0, step])
            faces += [(a, b, f), (a, f, e)]
            corner += [(u, u + w, u + w + h), (u, u + w + h, u + h)]
    faces = np.array(faces)
    sheet = Sheet.of_corners(np.array(corner), faces, [GF_CM], np.zeros(len(faces), int))
    angle = 2 * np.pi * np.arange(around) / around
    circle = np.column_stack([radius * np.cos(angle), 0 * angle, radius * np.sin(angle)])
    start = np.concatenate([circle - [0, k * step, 0] for k in range(along + 1)])
    ends = [*grid[0].tolist(), *grid[-1].tolist()]
    still = start[ends]

    def drive(frame: int) -> np.ndarray:
        turn = 2 * np.pi * float(np.interp(frame + 1, [0, 50, 60, 110], [0, 1, 1, 0]))
        place, x, z = still.copy(), still[around:, 0], still[around:, 2]
        place[around:, 0] = np.cos(turn) * x - np.sin(turn) * z
        place[around:, 2] = np.sin(turn) * x + np.cos(turn) * z
        return place

    contact, damping = Contact(thickness=0.002, speed_limit=5.0), settling(3.0, 6.0, 110)
    kinds = {"contact": contact, "damping": damping, "drive": drive, "gravity": 0.0}

    def never(run: Course) -> tuple[bool, str]:
        return run.worst_crossed == 0, f"at most {run.worst_crossed} crossings on the way"

    return calm(Setting(sheet, start, 235, ends, free=110, **kinds), also=never)


def knot_determinant(line: np.ndarray) -> int:
    """3 for a trefoil, 1 for none: from the crossings of a long line (N, 3) as seen along y (Fox colouring)."""
    met = []  # (place along the line, is it over, the other place)
    for i in range(len(line) - 1):
        for j in range(i + 2, len(line) - 1):
            p, q = line[i + 1] - line[i], line[j + 1] - line[j]
            det = p[0] * q[2] - p[2] * q[0]
            if det == 0.0:
                continue
            off = line[j] - line[i]
            s, t = (off[0] * q[2] - off[2] * q[0]) / det, (off[0] * p[2] - off[2] * p[0]) / det
            if 0 <= s < 1 and 0 <= t < 1:
                over = line[i, 1] + s * p[1] > line[j, 1] + t * q[1]
                met += [(i + s, over, j + t), (j + t, not over, i + s)]
    under = sorted(place for place, over, _ in met if not over)
    rows = np.zeros((len(under), len(under) + 1))
    for place, over, other in met:
        if not over:
            k = under.index(place)
            rows[k, int(np.searchsorted(under, other))] += 2
            rows[k, [k, k + 1]] -= 1
    return round(abs(np.linalg.det(rows[:, 1:]))) if len(under) else 1


def knot() -> Outcome:
    """A ribbon of 15 mm in an overhand knot, its ends drawn apart at 0.5 m/s: the knot tightens and stays one."""
    t = np.linspace(-2.15, 2.15, 2001)
    curve = 0.02 * np.column_stack([2.2 * (t**3 - 3 * t), 1.6 * (t**4 - 4 * t**2), 0.5 * (t**5 - 10 * t)])
    length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))]
    rest, faces = equilateral_sheet(0.015, float(length[-1]), 0.0075)
    along = np.gradient(curve, length, axis=0)
    across = np.zeros_like(curve)  # carried along without turning about the line
    across[0] = np.cross(along[0], [0.0, 1.0, 0.0])
    for k in range(1, len(t)):
        across[k] = across[k - 1] - (across[k - 1] @ along[k]) * along[k]
        across[k] /= np.linalg.norm(across[k])
    across[0] = across[1]

    def at(s: np.ndarray, of: np.ndarray) -> np.ndarray:
        return np.column_stack([np.interp(s, length, of[:, k]) for k in range(3)])

    start = at(rest[:, 1], curve) + (rest[:, :1] - 0.0075) * at(rest[:, 1], across)
    low, high = (np.flatnonzero(abs(rest[:, 1] - s) < 1e-6) for s in (0.0, rest[:, 1].max()))
    pins = [*low.tolist(), *high.tolist()]
    home = start[pins]
    apart = home[len(low) :].mean(0) - home[: len(low)].mean(0)
    room, apart = float(length[-1]) - 0.38 - float(np.linalg.norm(apart)), apart / np.linalg.norm(apart)
    drawn = int(np.ceil(room / 0.5 * 25))

    def drive(frame: int) -> np.ndarray:
        way = 0.5 * min(room, 0.5 * (frame + 1) / 25) * apart
        return home + np.concatenate([np.tile(-way, (len(low), 1)), np.tile(way, (len(high), 1))])

    def tied(run: Course) -> tuple[bool, str]:
        rows = np.unique(np.round(rest[:, 1], 9))
        line = np.stack([run.end[np.abs(rest[:, 1] - r) < 1e-6].mean(0) for r in rows])
        found = knot_determinant(line)
        return found == 3 and run.worst_crossed == 0, f"knot's determinant {found} (a trefoil's is 3)"

    contact, damping = Contact(thickness=0.002, speed_limit=5.0), settling(4.0, 8.0, drawn)
    kinds = {"contact": contact, "damping": damping, "drive": drive, "gravity": 0.0}
    sheet = Sheet.of(rest, faces, GF_CM)
    return calm(Setting(sheet, start, drawn + 150, pins, free=drawn, **kinds), also=tied)


MET: dict[str, Callable[[], Outcome]] = {
    "cloth on a spike": on_a_spike,
    "cloth through a ring, 0.5 m/s": lambda: through_a_ring(0.5),
    "cloth through a ring, 8 m/s": lambda: through_a_ring(8.0),
    "ten stacked layers": layers,
    "twisted cylinder": twisted,
    "knot drawn tight": knot,
}
