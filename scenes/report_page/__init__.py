"""One HTML page that holds all of a run, a comparison or a study: what was run, tables, pictures, a view to turn."""

from scenes.report_page.write import write_report

__all__ = ["write_report"]
