"""What the report is made from: tables that it has in full, and the files of the page."""

TABLES = ("validation", "capacity", "weights", "cases", "fit", "best_fit", "variants")
FILES = tuple(f"analysis/report/{name}" for name in ("page.html.j2", "report.css", "report.js"))
REPORT = "report.html"
