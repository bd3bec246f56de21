# make study   the whole study: tables, figures and a summary in $(RESULTS)
# make case    one case, CASE=n3-mesh0.02-e0.1a (and MODEL=static)
# make calibrate  which geometry fits the published numbers
# make decks   decks for 3DEC; results.txt that comes back beside them is read by make study
# make times   how long each model takes, after a study
# make test    lint and all tests, real runs of the engines included
# make lint    ruff, snakefmt and mypy alone
# make lock    pin the newest versions that pyproject.toml allows
# Another study: make study CONFIG=my.yaml RESULTS=my-results

CONFIG ?= config.yaml
RESULTS ?=
MODEL ?=
BIN := .venv/bin
TO = $(if $(RESULTS),--results "$(RESULTS)")
OPTIONS = --configfile "$(CONFIG)" --config $(if $(RESULTS),"results=$(RESULTS)")
FOLDER = folder=$$($(BIN)/python -m workflow.configuration folder "$(CONFIG)" $(TO))
ENGINES = engines=$$($(BIN)/python -m workflow.configuration engines "$(CONFIG)")
COMPILE = $(BIN)/uv pip compile --quiet --upgrade --universal --no-annotate --no-emit-index-url \
	--custom-compile-command "make lock" pyproject.toml

.PHONY: study case calibrate decks times test lint format lock system clean
.DELETE_ON_ERROR:

study: .venv/study.ready
	@$(FOLDER) && \
	$(ENGINES) && \
	$(BIN)/snakemake $(OPTIONS) "dem={engines: [$$engines]}" && cat "$$folder/summary.txt"

case: .venv/study.ready
	@test -n "$(CASE)" || { echo "CASE: missing, such as make case CASE=n3-mesh0.02-e0.1a"; exit 2; }
	@folder=$$($(BIN)/python -m workflow.cases "$(CONFIG)" "$(CASE)" $(if $(MODEL),--model "$(MODEL)") $(TO)) && \
	$(BIN)/snakemake "$$folder/result.json" $(OPTIONS) && \
	$(BIN)/python -m analysis.case "$$folder"

# The best geometries are a study of their own, whose configuration the first step writes.
calibrate: .venv/study.ready
	@$(FOLDER) && \
	$(ENGINES) && \
	$(BIN)/snakemake calibrate $(OPTIONS) && \
	$(BIN)/snakemake "$$folder/calibration/tables/capacity.csv" \
		--configfile "$$folder/calibration/best.yaml" --config "dem={engines: [$$engines]}" && \
	$(BIN)/snakemake confirmation $(OPTIONS) && cat "$$folder/calibration/best.txt"

decks: .venv/study.ready
	@$(FOLDER) && \
	$(BIN)/snakemake decks $(OPTIONS) && echo "Decks: $$folder/decks/3dec"

times: .venv/study.ready
	@OMP_NUM_THREADS=1 $(BIN)/python -m analysis.times "$(CONFIG)" $(TO)

test: .venv/test.ready lint
	$(BIN)/pytest

lint: .venv/test.ready
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/snakefmt --check Snakefile workflow/rules
	$(BIN)/mypy

format: .venv/test.ready
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .
	$(BIN)/snakefmt Snakefile workflow/rules

.venv/study.ready: requirements.txt pyproject.toml | system
	python3 -m venv .venv
	$(BIN)/pip install --quiet --requirement requirements.txt
	$(BIN)/pip install --quiet --no-deps --editable .
	@touch $@

.venv/test.ready: requirements-dev.txt .venv/study.ready
	$(BIN)/pip install --quiet --requirement requirements-dev.txt
	@touch $@

system:
	@sh workflow/system.sh

lock: .venv/test.ready
	$(COMPILE) --output-file requirements.txt
	$(COMPILE) --extra dev --constraint requirements.txt --output-file requirements-dev.txt

clean:
	rm -rf .venv .snakemake results
