"""Yarns: size, weight and stiffness, with the bounds between which a bundle of fibres can bend."""

from dataclasses import dataclass
from math import pi, sqrt

from sim_core.errors import WeaveError

__all__ = ["SILK_DENSITY", "SILK_FILAMENT", "SILK_MODULUS", "Yarn"]

SILK_DENSITY = 1340.0  # [kg/m3] degummed silk, textbook value 1.34 g/cm3
SILK_MODULUS = 10e9  # [Pa] initial modulus of degummed Bombyx silk, 8-13 GPa in textbooks
SILK_FILAMENT = 11e-6  # [m] diameter of one fibroin filament (brin) of about 1.3 dtex, assumption 10-13 um

# From a single filament to a rope: what lies outside is a slip of units, and would overflow further on.
LIMITS = {
    "diameter": (1e-6, 0.05, "m"),
    "tex": (1e-9, 1.0, "kg/m"),
    "modulus": (1e4, 1e13, "Pa"),
    "density": (1.0, 1e5, "kg/m3"),
    "filament": (1e-8, 0.05, "m"),
}
MOST_TENSION = 1e4  # [N]
MOST_TWIST = 1e4  # [1/m]
SPREAD = 0.35  # of its width: how much farther filaments without twist spread on a float, assumption
HOLDING = 600.0  # [1/m] twist that holds filaments together on a float, assumption (crêpe has 2,000 and more)
STIFFNESS = 1e-20, 1.0  # EI [N m2]


@dataclass(frozen=True)
class Yarn:
    """One kind of yarn.

    diameter: [m] of the round yarn before flattening.  tex: [kg/m] linear density (1 tex = 1e-6 kg/m).
    flattening: width / height of the pressed section, a racetrack with the area of the round yarn.
    stiffness: EI [N m2] of the yarn as it bends in the cloth.  colour: (3,) sRGB, 0 to 1.
    modulus [Pa], density [kg/m3], filament [m]: of the fibre, for the bending bounds and the axial stiffness.
    tension: [N] of one yarn while the cloth was woven and finished, which sets its shape: floats lie flatter.
    unevenness: coefficient of variation of the diameter along the yarn; only the texture maps use it.
    twist: [1/m] turns a metre, below 0 for S; none in reeled silk. It holds the filaments together and turns them.
    Raises WeaveError for a value that no yarn can have.
    """

    diameter: float
    tex: float
    flattening: float = 1.0
    stiffness: float = 0.0
    colour: tuple[float, float, float] = (0.93, 0.9, 0.82)
    modulus: float = SILK_MODULUS
    density: float = SILK_DENSITY
    filament: float = SILK_FILAMENT
    tension: float = 0.0
    unevenness: float = 0.0
    twist: float = 0.0

    def __post_init__(self) -> None:
        for name, (least, most, unit) in LIMITS.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise WeaveError(
                    f"yarn: {name} is {value} – give a number in SI units, {least:g} to {most:g} {unit}"
                )
        if not 1 <= self.flattening <= 12:
            raise WeaveError(f"yarn: flattening is {self.flattening} – width / height lies between 1 and 12")
        if not 0 <= self.tension <= MOST_TENSION:
            raise WeaveError(
                f"yarn: tension is {self.tension} – give newtons per yarn, 0 to {MOST_TENSION:g}"
            )
        if not 0 <= self.unevenness <= 0.5:
            raise WeaveError(f"yarn: unevenness is {self.unevenness} – a fraction between 0 and 0.5")
        if not abs(self.twist) <= MOST_TWIST:
            raise WeaveError(
                f"yarn: twist is {self.twist} – turns a metre, Z above 0 and S below, to {MOST_TWIST:g}"
            )
        if len(self.colour) != 3 or not all(0 <= c <= 1 for c in self.colour):
            raise WeaveError(f"yarn: colour is {self.colour} – three sRGB values between 0 and 1")
        if self.tex > self.density * pi / 4 * self.diameter**2:
            least = sqrt(4 * self.tex / (pi * self.density))
            raise WeaveError(
                f"yarn: diameter {self.diameter * 1e6:.0f} um is denser than its fibre – at least {least * 1e6:.0f} um"
            )
        if self.stiffness == 0:
            object.__setattr__(self, "stiffness", sqrt(self.stiffness_free * self.stiffness_stuck))
        if not STIFFNESS[0] <= self.stiffness <= STIFFNESS[1]:
            raise WeaveError(
                f"yarn: stiffness is {self.stiffness} – EI in N m2, or 0 to derive it from the fibre"
            )
        object.__setattr__(self, "colour", tuple(float(c) for c in self.colour))

    @property
    def height(self) -> float:
        """Height [m] of the flattened section, Kemp's racetrack: two half rounds and a flat piece between them."""
        return self.diameter * sqrt(pi / 4 / (self.flattening - 1 + pi / 4))

    @property
    def width(self) -> float:
        """Width [m] of the flattened section."""
        return self.flattening * self.height

    @property
    def spread(self) -> float:
        """How much wider than its width the yarn may become on a float, where nothing but twist holds it together."""
        return SPREAD * max(0.0, 1.0 - abs(self.twist) / HOLDING)

    @property
    def fibre_area(self) -> float:
        """Area of solid fibre in the section [m2]: linear density / fibre density."""
        return self.tex / self.density

    @property
    def axial(self) -> float:
        """EA [N]: fibre modulus times fibre area, fibres parallel to the yarn."""
        return self.modulus * self.fibre_area

    @property
    def stiffness_free(self) -> float:
        """Lower bound of EI [N m2]: every filament bends about its own axis."""
        return self.axial * self.filament**2 / 16

    @property
    def stiffness_stuck(self) -> float:
        """Upper bound of EI [N m2]: the fibres stick together as one solid round rod of the same fibre area."""
        return self.axial * max(self.fibre_area / (4 * pi), self.filament**2 / 16)
