"""What the report is made from beside tables: the files of the page."""

FILES = tuple(f"analysis/report/{name}" for name in ("page.html.j2", "report.css", "report.js"))
REPORT = "report.html"
