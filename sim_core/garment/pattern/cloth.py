"""Panels meshed so that what is sewn together has equally many steps, and the index lists that join them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sim_core.errors import OutlineError
from sim_core.garment.pattern.panels import Panel, Path, Seam
from sim_core.garment.pattern.pleats import chords, creased
from sim_core.mesh import PanelMesh, SeamFit, SeamSide, SewnPanel, sewn_meshes
from sim_core.mesh import Seam as SewnSeam
from sim_core.mesh.outline import check_edge, signed_area
from sim_core.metrics import components

__all__ = ["MOST_VERTICES", "SIDES", "Cloth", "both_halves", "creases_of", "cut_cloth", "unsided"]

SIDES = (" left", " right")  # of the wearer: a panel of a whole cloth is called so behind its name


MOST_VERTICES = 200_000  # of a panel that is to be draped: a night's work


def unsided(name: str) -> str:
    """A panel's name without the side of a mirrored pattern."""
    return next((name.removesuffix(side) for side in SIDES if name.endswith(side)), name)


def _no_pairs() -> np.ndarray:
    return np.zeros((0, 2), np.int32)


@dataclass(frozen=True)
class Cloth:
    """All panels meshed. P pattern vertices, F faces.

    vertices (P, 2) [m] in pattern axes, each panel in its own; faces (F, 3) int32, positive area in (x, -y);
    panel (F,) and panel_of (P,) number the panels of `names`; joined (P,): vertices joined flat have one number,
    closed (P,): once all seams are sewn; pairs (K, 2): what `sewn` draws together; middle (M,): vertices on x = 0;
    paths: the vertices along each leg; fits: how each seam of two sides came out, of one half; creases (C, 2): edges
    along the folds of pleats; flat, sewn (k, 2): pattern vertices that a seam brings together, of which `joined`,
    `closed` and `pairs` are reckoned.
    """

    names: tuple[str, ...]
    vertices: np.ndarray
    faces: np.ndarray
    panel: np.ndarray
    panel_of: np.ndarray
    joined: np.ndarray
    closed: np.ndarray
    pairs: np.ndarray
    middle: np.ndarray
    paths: dict[str, np.ndarray]
    fits: tuple[SeamFit, ...] = ()
    creases: np.ndarray = field(default_factory=_no_pairs)
    flat: np.ndarray = field(default_factory=_no_pairs)
    sewn: np.ndarray = field(default_factory=_no_pairs)

    @staticmethod
    def of(mesh: PanelMesh, name: str = "cloth") -> Cloth:
        """A single panel without seams."""
        alone = np.arange(len(mesh.vertices), dtype=np.int32)
        none = np.zeros(0, np.int32)
        faces = mesh.faces.astype(np.int32)
        panel, owner = np.zeros(len(faces), np.int32), np.zeros(len(alone), np.int32)
        return Cloth((name,), mesh.vertices, faces, panel, owner, alone, alone, none.reshape(0, 2), none, {})

    def along(self, path: Path, panel: Panel, side: str = "") -> np.ndarray:
        """Numbers of the pattern vertices on a path, in its direction; side: of a whole cloth, one of SIDES."""
        parts = []
        for leg in panel.path(path.start, path.end, ahead=path.ahead):
            index = self.paths[f"{panel.name}{side}/{leg}"]
            parts.append(index if path.ahead else index[::-1])
        return np.concatenate([parts[0][:1], *(part[1:] for part in parts)])

    def mirrored(self) -> Cloth:
        """Both halves: the second is the first turned over about x = 0; middles are joined to their images."""
        count = len(self.vertices)
        flipped = self.faces[:, [0, 2, 1]] + count
        names = tuple(name + side for side in SIDES for name in self.names)
        meeting = np.column_stack([self.middle, self.middle + count])
        flat = np.concatenate([self.flat, self.flat + count, meeting]).astype(np.int32)
        sewn = np.concatenate([self.sewn, self.sewn + count]).astype(np.int32)
        joined, closed, _ = _meeting(2 * count, flat, sewn)
        # Each half's own: what is sewn on the middle is drawn together once for each.
        ends = np.unique(self.joined, return_index=True)[1][self.pairs]
        paths = {f"{name}{SIDES[0]}/{leg}": index for (name, leg), index in self._legs()}
        paths |= {f"{name}{SIDES[1]}/{leg}": index + count for (name, leg), index in self._legs()}
        return Cloth(
            names,
            np.concatenate([self.vertices, self.vertices * [-1.0, 1.0]]),
            np.concatenate([self.faces, flipped]).astype(np.int32),
            np.r_[self.panel, self.panel + len(self.names)].astype(np.int32),
            np.r_[self.panel_of, self.panel_of + len(self.names)].astype(np.int32),
            joined,
            closed,
            np.concatenate([joined[ends], joined[ends + count]]).astype(np.int32).reshape(-1, 2),
            np.zeros(0, np.int32),
            paths,
            self.fits,
            np.concatenate([self.creases, self.creases + count]).astype(np.int32),
            flat,
            sewn,
        )

    def only(self, kept: np.ndarray) -> Cloth:
        """Without the vertices that kept (P,) leaves out, which must be those of whole panels, and without their seams;
        a panel keeps its number and name where it has lost all it had."""
        new = np.cumsum(kept) - 1
        flat, sewn, creases = (new[told[kept[told].all(1)]] for told in (self.flat, self.sewn, self.creases))
        faces = kept[self.faces[:, 0]]
        joined, closed, pairs = _meeting(int(kept.sum()), flat, sewn)
        return replace(
            self,
            vertices=self.vertices[kept],
            faces=new[self.faces[faces]].astype(np.int32),
            panel=self.panel[faces],
            panel_of=self.panel_of[kept],
            joined=joined,
            closed=closed,
            pairs=pairs,
            middle=new[self.middle[kept[self.middle]]].astype(np.int32),
            paths={key: new[index] for key, index in self.paths.items() if kept[index].all()},
            creases=creases.astype(np.int32),
            flat=flat.astype(np.int32),
            sewn=sewn.astype(np.int32),
        )

    def _legs(self) -> Iterator[tuple[tuple[str, str], np.ndarray]]:
        """Panel and number of every leg, with its vertices."""
        for key, index in self.paths.items():
            name, _, leg = key.rpartition("/")
            yield (name, leg), index


def cut_cloth(panels: Sequence[Panel], seams: Sequence[Seam], edge: float) -> Cloth:
    """Meshes all panels at `edge` [m]; both sides of every seam get equal steps, counted from their first points.

    Raises OutlineError naming the panel where one cannot be meshed.
    """
    for panel in panels:
        try:
            check_edge(edge, [panel.outline()], MOST_VERTICES)
        except OutlineError as error:
            raise OutlineError(f"{_named(panel)}: {error}") from error
    by_name = {panel.name: panel for panel in panels}
    drawn = [
        SewnPanel(
            panel.outline(),
            _corners(panel),
            constraints=chords(panel.outline(), panel.pleats),
            name=_named(panel),
        )
        for panel in panels
    ]
    pairs = [(seam, seam.b) for seam in seams if seam.b is not None]
    wanted = [SewnSeam(_side(seam.a, by_name), _side(b, by_name), seam.notches) for seam, b in pairs]
    meshes, fits = sewn_meshes(drawn, wanted, edge=edge)
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    twins: dict[str, list[np.ndarray]] = {"joined": [], "sewn": []}
    for (seam, _), sewn, fit in zip(pairs, wanted, fits, strict=True):
        twins[seam.kind].append(fit.pairs + starts[[sewn.a.panel, sewn.b.panel]])
    cloth = _laid_out(panels, meshes, starts, twins)
    middle = [cloth.along(seam.a, by_name[seam.a.panel]) for seam in seams if seam.b is None]
    numbers = np.unique(np.concatenate([np.zeros(0, np.int32), *middle])).astype(np.int32)
    creases = creases_of(panels, cloth.vertices, cloth.faces, cloth.panel)
    return replace(cloth, middle=numbers, fits=tuple(fits), creases=creases)


def both_halves(panels: Sequence[Panel]) -> Iterator[tuple[int, Panel, float]]:
    """Number, panel and sign of x of each panel of a whole cloth, which may be no more than one half: the second half's
    panels follow the first's."""
    for half, sign in enumerate((1.0, -1.0)):
        for number, panel in enumerate(panels):
            yield number + half * len(panels), panel, sign


def creases_of(
    panels: Sequence[Panel], vertices: np.ndarray, faces: np.ndarray, panel: np.ndarray
) -> np.ndarray:
    """Edges (C, 2) int32 along the folds of pleats, of pattern vertices (P, 2) [m] and faces (F, 3), of which `panel`
    (F,) tells whose they are; of a mirrored cloth the second half's panels follow the first's."""
    found = [np.zeros((0, 2), np.int32)]
    for number, own, sign in both_halves(panels):
        if own.pleats:
            mine = faces[panel == number]
            edges = np.unique(np.sort(mine[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
            found.append(creased(sign * vertices[:, 0], edges, own.pleats))
    return np.concatenate(found).astype(np.int32)


def _laid_out(
    panels: Sequence[Panel], meshes: list[PanelMesh], starts: np.ndarray, twins: dict[str, list[np.ndarray]]
) -> Cloth:
    """All meshes in one list of vertices, of which each begins at `starts`; twins: (k, 2) of them that are sewn."""
    flat, sewn = (np.concatenate([_no_pairs(), *twins[kind]]).astype(np.int32) for kind in ("joined", "sewn"))
    joined, closed, pairs = _meeting(int(starts[-1]), flat, sewn)
    numbers = np.arange(len(panels), dtype=np.int32)
    parts = list(zip(panels, meshes, starts.tolist(), strict=False))
    return Cloth(
        names=tuple(panel.name for panel in panels),
        vertices=np.concatenate([mesh.vertices for mesh in meshes]),
        faces=np.concatenate([mesh.faces + start for _, mesh, start in parts]).astype(np.int32),
        panel=np.repeat(numbers, [len(mesh.faces) for mesh in meshes]),
        panel_of=np.repeat(numbers, np.diff(starts)),
        joined=joined,
        closed=closed,
        pairs=pairs,
        middle=np.zeros(0, np.int32),
        paths={
            f"{panel.name}/{leg}": index + start
            for panel, mesh, start in parts
            for leg, index in enumerate(_legs(panel, mesh))
        },
        flat=flat,
        sewn=sewn,
    )


def _meeting(count: int, flat: np.ndarray, sewn: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`joined`, `closed` and `pairs` of so many pattern vertices, of which flat, sewn (k, 2) are brought together."""
    joined = components(count, *flat.T)
    pairs = np.unique(np.sort(joined[sewn], axis=1), axis=0)
    closed = components(count, *np.concatenate([flat, sewn]).T)
    return joined, closed, pairs[pairs[:, 0] != pairs[:, 1]].astype(np.int32)


def _named(panel: Panel) -> str:
    """A panel as errors call it."""
    return f"panel.{panel.name}"


def _corners(panel: Panel) -> list[int]:
    """The outline point each leg begins at."""
    return np.cumsum([0, *(len(leg) - 1 for leg in panel.legs[:-1])]).tolist()


def _side(path: Path, panels: dict[str, Panel]) -> SeamSide:
    """A path as the side of a seam."""
    panel = panels[path.panel]
    first, last = (_corners(panel)[panel.corners.index(name)] for name in (path.start, path.end))
    return SeamSide(list(panels).index(path.panel), first, last, backward=not path.ahead)


def _legs(panel: Panel, mesh: PanelMesh) -> list[np.ndarray]:
    """Per leg the numbers of its vertices in the outline's order, both ends included."""
    loop = mesh.boundary[0] if signed_area(panel.outline()) > 0 else mesh.boundary[0][::-1]
    place = {tuple(point): k for k, point in enumerate(mesh.vertices[loop].tolist())}
    at = [place[tuple(leg[0].tolist())] for leg in panel.legs]
    count = len(loop)
    return [
        loop[np.arange(begin, begin + (end - begin - 1) % count + 2) % count]
        for begin, end in zip(at, [*at[1:], at[0]], strict=True)
    ]
