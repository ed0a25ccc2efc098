"""`Loom`: yarns at rest and maps of the weaves of one piece of work, each solved and drawn once."""

from __future__ import annotations

from sim_core.weave.maps import SurfaceMaps, drawn_maps
from sim_core.weave.model import Weave
from sim_core.weave.yarns import FiguredGeometry, ParticleCell, YarnGeometry, solve

__all__ = ["Loom"]


class Loom:
    """Remembers what `solve` and `drawn_maps` made of each weave; equal weaves are one, whoever holds them.

    It is handed along with what it is made for (an outfit's layers share one) and gone with it.
    """

    def __init__(self) -> None:
        self._yarns: dict[str, ParticleCell | YarnGeometry | FiguredGeometry] = {}
        self._maps: dict[tuple[str, int], SurfaceMaps] = {}

    def yarns(self, weave: Weave) -> ParticleCell | YarnGeometry | FiguredGeometry:
        """The yarns of a weave at rest, down to particles; raises what `solve` raises."""
        key = weave.key
        if key not in self._yarns:
            self._yarns[key] = solve(weave, particles=True)
        return self._yarns[key]

    def maps(self, weave: Weave, pixels: int) -> SurfaceMaps:
        """Tileable maps of a weave, `pixels` wide; raises what `solve` and `drawn_maps` raise."""
        key = weave.key, pixels
        if key not in self._maps:
            self._maps[key] = drawn_maps(weave, self.yarns(weave), pixels=pixels)
        return self._maps[key]
