"""What other analyses add to the report: a `Chapter` of texts, tables and drawings, whoever sets the page."""

from survey.report.chapters.chapter import Chapter, Drawing, Further
from survey.report.chapters.comparison import comparison_chapter
from survey.report.chapters.confirmation import confirmation_chapter

__all__ = ["Chapter", "Drawing", "Further", "comparison_chapter", "confirmation_chapter"]
