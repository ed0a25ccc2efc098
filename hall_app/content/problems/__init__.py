"""What is wrong with a content folder, in English and in Chinese.

problem: one thing to put right, several, the error that carries them; catalogue: their texts in Chinese (zh.toml).
"""

from hall_app.content.problems.catalogue import catalogue, in_language
from hall_app.content.problems.problem import ContentError, Problem, Problems

__all__ = ["ContentError", "Problem", "Problems", "catalogue", "in_language"]
