# The whole study: `snakemake`. One case: `snakemake results/cases/yade/n3-mesh0.02-e0.1a/result.json`.
# Another study: `snakemake --configfile my.yaml --config results=my-results`.
# Jobs that would run: `snakemake --dry-run`. Graph of the rules: `snakemake --rulegraph`.
import sys
from pathlib import Path

# Run the code of this checkout, whatever the working directory and the installed packages are.
CHECKOUT = str(workflow.current_basedir)
sys.path.insert(0, CHECKOUT)

from workflow.configuration import (
    ConfigError,
    load_configuration,
    read_study,
    with_installed_engines,
)
from workflow.jobs import case_jobs

# Snakemake reads the configuration too and merges it with defaults; this reader checks every key and
# does not mix two studies.
CONFIG = workflow.config_settings.config or {}
FILES = [Path(path) for path in workflow.config_settings.configfiles]
FILES = FILES or [Path(CHECKOUT, "config.yaml")]
try:
    for path in reversed(FILES):
        CONFIG = load_configuration(path, CONFIG)
    STUDY = read_study(CONFIG)
    if workflow.is_main_process:  # nodes of a cluster may have other programs than its front end
        STUDY = with_installed_engines(STUDY)
    JOBS = case_jobs(STUDY)
except ConfigError as error:
    sys.exit(f"Error in the configuration: {error.of(FILES[0])}")

RESULTS = STUDY.results


report: "workflow/captions/study.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/cases.smk"


STUDY_FILES = [*OF_CASES]
if STUDY.samples:

    include: "analysis/rules/joints.smk"

    STUDY_FILES += [
        *rules.collect.output,
        *rules.capacity.output,
        *rules.comparisons.output,
        *rules.figures.output,
    ]


if STUDY.structures:

    include: "analysis/rules/structures.smk"

    STUDY_FILES += STRUCTURE_FILES


if STUDY.earthquakes:

    include: "workflow/rules/earthquakes.smk"

    STUDY_FILES += EARTHQUAKE_FILES


if STUDY.samples or STUDY.structures or STUDY.earthquakes:

    include: "analysis/rules/report.smk"

    STUDY_FILES += [*rules.summary.output, *rules.complete.output, *rules.report.output]


if STUDY.samplings:

    include: "workflow/rules/samplings.smk"

    STUDY_FILES += [*OF_SAMPLINGS, *rules.samplings.output]


if STUDY.campaign is not None:

    include: f"studies/{STUDY.campaign}/rules.smk"

    STUDY_FILES += OF_CAMPAIGN


note_all(workflow.rules)


rule all:
    default_target: True
    input:
        STUDY_FILES,
