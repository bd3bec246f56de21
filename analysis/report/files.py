"""Names of the report and of the files that it is made from: what a plan needs to know of it."""

REPORT = "report.html"
STYLE = "analysis/report/report.css"
SCRIPTS = ("analysis/drawing/chart.js", "analysis/report/report.js")
FILES = ("analysis/report/page.html.j2", STYLE, *SCRIPTS)
