# make study   the whole study: tables, figures and a summary in $(RESULTS)
# make case    one case, CASE=n3-mesh0.02-e0.1a (and MODEL=static)
# make report  the report alone, one page: report.html in $(RESULTS); make study writes it too
# make explore a page with sliders for a joint of your own, on this machine only
# make calibrate  which geometry fits the published numbers
# make locks   the study of the law: how many locks work, over 640 joints; hours, goes on where stopped
# make study PROFILE=slurm  the same on a SLURM cluster, see docs/howto/cluster.md
# make decks   decks for 3DEC; results.txt that comes back beside them is read by make study
# make test    lint and all tests, real runs of the engines included
# make test-slurm  a study through SLURM on this one machine, which is set up for it; as root
# make test-container  the container, built here without a registry, and a study in it; as root
# make faults  a campaign of faults, FAULTS=500: whatever happens, the next run ends as if nothing had
# make fuzz    configurations, names and files changed at random, FUZZ=100000: an answer or one line, every time
# make same    tables and figures byte for byte: on one core, under four kernels, PYTHONS=other environments' bin/python
# make attack  an optimiser looks for joints whose safe load is above what they carry, EVALUATIONS=1800 a start
# make structures  structures of blocks beside published answers; PEERS=1: compas_cra as well
# make scaling what a large study takes, CASES=100000: time, files, memory
# make docs    the pages as a site: build/docs/index.html
# make bench   how long everything takes on this machine; BASE=folder: another checkout beside it; PEERS=1: other programs
# make mutants whether the tests notice faults in the code, MUTANTS=200
# make lint    ruff, snakefmt, mypy and import-linter alone
# make lock    pin the newest versions that pyproject.toml allows
# Another study: make study CONFIG=my.yaml RESULTS=my-results
# Cases that have no answer once more, although nothing has changed: make study RETRY=1

CONFIG ?= config.yaml
RESULTS ?=
CASE ?=
MODEL ?=
BASE ?=
PROFILE ?=
RETRY ?=
FAULTS ?= 500
FUZZ ?= 100000
MUTANTS ?= 200
CASES ?= 100000
PYTHONS ?=
PEERS ?=
EVALUATIONS ?= 1800
# They reach the shell as they are, whatever is in them.
export CONFIG RESULTS CASE MODEL BASE PROFILE RETRY FAULTS FUZZ MUTANTS CASES EVALUATIONS
BIN := .venv/bin
# `exec`: a signal to make reaches the run itself, not only the shell between them. `trap`: so does ^C
# before Python has begun, as it looks whether make was told to end.
WORKFLOW = @trap '' INT; exec $(BIN)/python -m workflow --end-with-parent
TO = "$$CONFIG" --results="$$RESULTS"
COMPILE = $(BIN)/uv pip compile --quiet --generate-hashes --upgrade --universal --no-annotate --no-emit-index-url \
	--custom-compile-command "make lock" --extra study pyproject.toml

.PHONY: study locks case report explore calibrate decks docs bench test test-slurm test-container faults fuzz mutants same attack structures scaling lint format lock early system system-test clean
.DELETE_ON_ERROR:

study: .venv/study.ready $(if $(filter slurm,$(PROFILE)),.venv/slurm.ready)
	$(WORKFLOW) study $(TO) --profile="$$PROFILE"

locks: .venv/study.ready $(if $(filter slurm,$(PROFILE)),.venv/slurm.ready)
	$(WORKFLOW) study studies/locks/config.yaml --results="$$RESULTS" --profile="$$PROFILE"

case: .venv/study.ready
	$(WORKFLOW) case $(TO) --case="$$CASE" --model="$$MODEL"

calibrate: .venv/study.ready
	$(WORKFLOW) calibrate $(TO)

report: .venv/study.ready
	$(WORKFLOW) report $(TO)

explore: .venv/study.ready
	@exec $(BIN)/python -m analysis.explore.app

decks: .venv/study.ready
	$(WORKFLOW) decks $(TO)

docs: .venv/test.ready
	$(BIN)/sphinx-build -q -W --keep-going -b html docs build/docs
	@echo "Pages: build/docs/index.html"

bench: .venv/test.ready $(if $(PEERS),.venv/peers.ready)
	@exec $(BIN)/python -m benchmarks.bench $(if $(BASE),--base "$$BASE") $(if $(RESULTS),--results "$$RESULTS")

test: .venv/test.ready lint
	$(BIN)/pytest --numprocesses 2 --dist worksteal

test-slurm: .venv/test.ready .venv/slurm.ready
	@sh workflow/system.sh slurm
	MULTILOCK_MACHINE=1 $(BIN)/pytest -m machine tests/test_slurm.py

test-container: .venv/test.ready
	@sh workflow/system.sh container
	MULTILOCK_MACHINE=1 $(BIN)/pytest -m machine tests/test_container.py

faults: .venv/test.ready
	@PYTHONPATH=.:tests exec $(BIN)/python -m campaigns.faults --faults "$$FAULTS"

fuzz: .venv/test.ready
	@PYTHONPATH=.:tests OPENBLAS_NUM_THREADS=1 exec $(BIN)/python -m campaigns.fuzz --inputs "$$FUZZ"

mutants: .venv/test.ready
	@PYTHONPATH=.:tests exec $(BIN)/python -m campaigns.mutants --mutants "$$MUTANTS"

same: .venv/test.ready
	@PYTHONPATH=.:tests exec $(BIN)/python -m campaigns.same_bytes $(PYTHONS)

attack: .venv/study.ready
	@export OPENBLAS_NUM_THREADS=1; exec $(BIN)/python -m studies.attack.search --evaluations "$$EVALUATIONS"

structures: .venv/study.ready $(if $(PEERS),.venv/peers.ready)
	@export OPENBLAS_NUM_THREADS=1; results="$${RESULTS:-results-structures}"; \
	$(BIN)/python -m studies.structures.compare --results "$$results" && \
	exec $(BIN)/python -m studies.pages "$$results" docs/structures.md

scaling: .venv/test.ready
	@exec $(BIN)/python -m benchmarks.scaling --cases "$$CASES" $(if $(RESULTS),--results "$$RESULTS")

lint: .venv/test.ready
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/snakefmt --check Snakefile workflow/rules studies
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

format: .venv/test.ready
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .
	$(BIN)/snakefmt Snakefile workflow/rules studies

.venv/study.ready: requirements.txt pyproject.toml | early system
	@sh workflow/environment.sh

.venv/test.ready: requirements-dev.txt .venv/study.ready | system-test
	@sh workflow/install.sh requirements-dev.txt
	@touch $@

.venv/%.ready: requirements-%.txt .venv/study.ready
	@sh workflow/install.sh $<
	@touch $@

# Errors in the configuration are reported before anything is installed.
early:
	@python3 workflow/run/before_install.py "$$CONFIG"

system: early
	@sh workflow/system.sh

system-test:
	@sh workflow/system.sh test

# Each extra has a file of what it adds to the study's. One file for all would not do: pip takes no digests
# from constraints, and whoever runs studies installs nothing of the developers.
lock: .venv/test.ready
	$(COMPILE) --output-file requirements.txt
	for extra in installer dev slurm peers compas; do \
		$(COMPILE) --extra $$extra --constraint requirements.txt --output-file requirements-$$extra.txt \
			$$(sed -n 's/^\([A-Za-z0-9._-]*\)==.*/--no-emit-package \1/p' requirements.txt) && \
		{ [ $$extra = installer ] || sed -i '2a --requirement requirements.txt' requirements-$$extra.txt; } || exit 1; \
	done

clean:
	rm -rf .venv .venv.old .snakemake results
