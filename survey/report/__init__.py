"""The report: one self-contained page in both languages, its tables as CSV, its figures as SVG.

`words` are the texts of a language, `indicators` the way of the paper's 25. `tables`, `figures` and the `chapters` of
other analyses stand in `sections`, these on the `page`, and `files` writes it all into a folder.
"""

from survey.report.files import write_report
from survey.report.indicators import evidence, way_of
from survey.report.page import Report, build
from survey.report.sections import Part
from survey.report.words import Words, coefficient

__all__ = ["Part", "Report", "Words", "build", "coefficient", "evidence", "way_of", "write_report"]
