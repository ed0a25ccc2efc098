"""What yields by sliding: stiff until friction is overcome, softer beyond; and the loop of a load to and fro."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Sliding"]


@dataclass(frozen=True)
class Sliding:
    """A response y(x): slope `first` while friction holds, `second` once y has passed `limit`.

    Loops follow Masing's rule: turned back, the curve is the first one, twice as large.
    """

    first: float
    second: float
    limit: float

    def once(self, x: float) -> float:
        """y as x is reached for the first time."""
        held = self.limit / self.first
        size = abs(x)
        y = self.first * size if size <= held else self.limit + self.second * (size - held)
        return y if x >= 0 else -y

    def rising(self, x: float, turn: float) -> float:
        """y on the way up, after turning round at -turn."""
        return -self.once(turn) + 2 * self.once((x + turn) / 2)

    def slope(self, begin: float, end: float, turn: float) -> float:
        """Mean slope between two places of a loop between -turn and turn."""
        return (self.rising(end, turn) - self.rising(begin, turn)) / (end - begin)

    def width(self, x: float, turn: float) -> float:
        """Height of the loop at x: y on the way up less y on the way down."""
        return self.rising(x, turn) + self.rising(-x, turn)
