"""The `Weave` value: a draft, its two yarns and the sett."""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft import Draft
from sim_core.weave.yarn import Yarn

__all__ = ["Weave"]

MOST_PER_METRE = 1e6


@dataclass(frozen=True)
class Weave:
    """A cloth on the loom: draft, warp and weft yarn, and how many of each lie side by side.

    ends_per_m, picks_per_m: [1/m].  friction: coefficient between two layers of the cloth.
    Raises WeaveError where the sett is not positive or the yarns do not fit beside each other.
    """

    name: str
    draft: Draft
    warp: Yarn
    weft: Yarn
    ends_per_m: float
    picks_per_m: float
    friction: float = 0.3

    def __post_init__(self) -> None:
        for key in ("ends_per_m", "picks_per_m"):
            value = getattr(self, key)
            if not 1 <= value <= MOST_PER_METRE:
                raise WeaveError(
                    f"weave {self.name}: {key} is {value} – give 1 to {MOST_PER_METRE:g} yarns per metre"
                )
        if not 0 <= self.friction <= 2:
            raise WeaveError(f"weave {self.name}: friction is {self.friction} – between 0 and 2")

    @property
    def end_spacing(self) -> float:
        """Distance of neighbouring warp ends [m]."""
        return 1 / self.ends_per_m

    @property
    def pick_spacing(self) -> float:
        """Distance of neighbouring weft picks [m]."""
        return 1 / self.picks_per_m

    @property
    def openness(self) -> float:
        """Open fraction of the area: (1 - warp width x ends) (1 - weft width x picks), 0 where yarns touch."""
        warp = min(1.0, self.warp.width * self.ends_per_m)
        weft = min(1.0, self.weft.width * self.picks_per_m)
        return (1 - warp) * (1 - weft)

    @property
    def size(self) -> tuple[float, float]:
        """Width (along the weft) and height (along the warp) of one repeat [m]."""
        return self.draft.ends * self.end_spacing, self.draft.picks * self.pick_spacing

    @classmethod
    def load(cls, path: str | Path) -> "Weave":
        """Read a weave file (TOML); raises FileProblem or WeaveError naming file, key, value and remedy."""
        from sim_core.weave.reading import read_weave

        return read_weave(Path(path))

    def to_dict(self) -> dict:
        """A plain dictionary that JSON can hold and `from_dict` reads back."""
        values = {key: getattr(self, key) for key in ("name", "ends_per_m", "picks_per_m", "friction")}
        draft = {"name": self.draft.name, "lift": self.draft.lift.astype(int).tolist()}
        return {**values, "draft": draft, "warp": asdict(self.warp), "weft": asdict(self.weft)}

    @classmethod
    def from_dict(cls, values: dict) -> "Weave":
        """The inverse of `to_dict`; raises WeaveError for a missing or unknown key."""
        try:
            rest = dict(values)
            draft = rest.pop("draft")
            lift = np.array(draft["lift"], dtype=bool)
            yarns = {side: Yarn(**{**rest.pop(side)}) for side in ("warp", "weft")}
            return cls(draft=Draft(draft["name"], lift), **yarns, **rest)
        except (KeyError, TypeError) as error:
            raise WeaveError(
                f"weave: {error} – the dictionary must be one that Weave.to_dict wrote"
            ) from error
