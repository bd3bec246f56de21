# The whole study: `snakemake`. One case: `snakemake results/cases/yade/n3-mesh0.02-e0.1a/result.json`.
# Another study: `snakemake --configfile my.yaml --config results=my-results`.
import re
import shlex
import sys
from pathlib import Path

from analysis.figures.catalogue import figures_of
from workflow.cases import case_folder, cases_of
from workflow.configuration import ConfigError, read_study
from workflow.engines import ENGINES
from workflow.results import CASE_FILES
from workflow.threedec import deck_folder, decks

# A study of one's own is not mixed with this one.
if not workflow.config_settings.configfiles:

    configfile: workflow.source_path("config.yaml")


try:
    STUDY = read_study(config)
    CASES = cases_of(STUDY)
except ConfigError as error:
    sys.exit(f"Error in the configuration: {error}")

RESULTS = STUDY.results
# Results of 3DEC that came back count like those of any other model.
CASES |= {
    (case.model, name): case
    for name, case in decks(STUDY).items()
    if Path(f"{deck_folder(RESULTS, name)}/results.txt").is_file()
}
PYTHON = shlex.quote(sys.executable)
SOURCES = workflow.current_basedir


wildcard_constraints:
    case="|".join(re.escape(name) for _, name in CASES),


include: "workflow/rules/cases.smk"
include: "workflow/rules/decks.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/calibration.smk"


rule all:
    default_target: True
    input:
        f"{RESULTS}/summary.txt",
        [rules.weights.output, rules.fit.output, rules.models.output],
        expand(rules.figure.output, figure=FIGURE_SPECS),
