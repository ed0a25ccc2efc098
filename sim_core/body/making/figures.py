"""The figures there are, by name: what anny is asked for, and whose stature that is."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["FIGURES", "Made"]


@dataclass(frozen=True)
class Made:
    """anny's sliders, the stature [m] they give, with the head, and whose it is; web [m]: between thumb and hand."""

    sliders: dict[str, float]
    stature: float
    words: str
    web: float = 0.0


def _woman(height: float) -> dict[str, float]:
    return {
        "gender": 1.0,
        "age": 0.667,
        "muscle": 0.45,
        "weight": 0.35,
        "height": height,
        "proportions": 0.5,
    }


def _man(height: float) -> dict[str, float]:
    return _woman(height) | {"gender": 0.0, "muscle": 0.5, "weight": 0.4}


WEB = 0.014  # [m] men's thumbs come near their hands
# Mean statures from skeletons: Qin and Han on the Yangtze (Peng Wei), Tang at Zhengzhou; field note han-garments, 10.
FIGURES: dict[str, Made] = {
    "woman": Made(_woman(0.36), 1.62, "a woman of today, slim"),
    "woman-150": Made(_woman(0.2534), 1.50, "a woman of Qin and Han times on the Yangtze, on average"),
    "woman-158": Made(_woman(0.3267), 1.58, "a woman of Tang times at Zhengzhou, on average"),
    "man-161": Made(_man(0.2259), 1.61, "a man of Qin and Han times on the Yangtze, on average", WEB),
    "man-167": Made(_man(0.2809), 1.67, "a man of Tang times at Zhengzhou, on average", WEB),
}
