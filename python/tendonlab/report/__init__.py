"""report.html, report.json and the figures of a diagnosis."""

from tendonlab.report.document import effects_table, page
from tendonlab.report.write import write_report

__all__ = ["effects_table", "page", "write_report"]
