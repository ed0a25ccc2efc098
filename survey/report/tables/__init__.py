"""The report's tables.

Rows of text set as HTML (`table`) or as CSV (`csv_text`), and what the `paper` printed beside what was computed.
"""

from survey.report.tables.csv_text import as_csv, matrix_csv
from survey.report.tables.paper import paper_rows, paper_table
from survey.report.tables.table import MANY, Table, as_html, tables_of

__all__ = ["MANY", "Table", "as_csv", "as_html", "matrix_csv", "paper_rows", "paper_table", "tables_of"]
