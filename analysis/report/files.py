"""Names of the report and of the files that it is made from: what a plan needs to know of it."""

REPORT = "report.html"
PARTS = ("joints", "structures")  # of which each has a template and a script
FOLDER = "analysis/report"
STYLE = f"{FOLDER}/report.css"
SCRIPTS = ("analysis/drawing/chart.js", f"{FOLDER}/report.js")
TEMPLATES = (f"{FOLDER}/page.html.j2", *(f"{FOLDER}/{part}.html.j2" for part in PARTS))
SCRIPTS_OF_PARTS = {part: f"{FOLDER}/{part}.js" for part in PARTS}
FILES = (*TEMPLATES, STYLE, *SCRIPTS, *SCRIPTS_OF_PARTS.values())
