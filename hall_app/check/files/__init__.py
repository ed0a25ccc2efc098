"""What the files hold: words, media, models and their weight, bakes, mannequins, and what nobody names."""

from hall_app.check.files.bakes import bake_problems
from hall_app.check.files.budget import budget_problems
from hall_app.check.files.mannequins import figure_problems
from hall_app.check.files.media import AUDIO, ENDINGS, VIDEO, media_problems
from hall_app.check.files.models import scale_problems
from hall_app.check.files.unused import unused_problems
from hall_app.check.files.words import word_problems

__all__ = [
    "AUDIO",
    "ENDINGS",
    "VIDEO",
    "bake_problems",
    "budget_problems",
    "figure_problems",
    "media_problems",
    "scale_problems",
    "unused_problems",
    "word_problems",
]
