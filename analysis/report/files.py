"""Names of the files that the report is made from: what a plan needs to know of it."""

PARTS = ("joints", "structures")  # of which each has a template and a script
FOLDER = "analysis/report"
SHARED = "sidmacib/scene"  # with the explorer and the command
STYLE = f"{SHARED}/report.css"
SCRIPTS = (f"{SHARED}/chart.js", f"{SHARED}/parts.js", f"{FOLDER}/report.js")
ADDRESS = f"{FOLDER}/address.js"  # the last one
TEMPLATES = (
    *(f"{FOLDER}/{name}.html.j2" for name in ("page", "answer", "end", *PARTS)),
    f"{SHARED}/structure.html.j2",
)
SCRIPTS_OF_PARTS = {
    "joints": tuple(f"{FOLDER}/{name}.js" for name in ("joints", "answer", "paths")),
    "structures": (f"{SHARED}/structure.js", f"{FOLDER}/structures.js"),
}
FILES = (
    *TEMPLATES,
    STYLE,
    *SCRIPTS,
    ADDRESS,
    *(name for part in SCRIPTS_OF_PARTS.values() for name in part),
)
