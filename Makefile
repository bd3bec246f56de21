# make study   run the whole study: tables, figures, report and a summary in $(RESULTS)
# make case    run one case, CASE=n3-mesh0.02-e0.1a (and MODEL=static)
# make cases  list the cases of a study and their state: done, failed, outdated, to do; FORMAT=json or csv
# make report  write only the report, report.html in $(RESULTS)
# make explore open pages with sliders for any joint and for structures, served to this machine only
# make calibrate  find the geometry and friction that fit the published numbers
# make locks   run the study of the law on 640 joints; takes less than an hour, continues where it stopped
# make study PROFILE=slurm  run the study on a SLURM cluster, see docs/howto/study.md
# make decks   write decks for 3DEC; make study reads the results.txt that 3DEC leaves beside a deck
# make test    run lint and all tests, including real runs of the engines
# make quick   run the everyday tests, which take two minutes
# make test-slurm  run a study through SLURM, which is set up on this machine; needs root
# make test-container  build the container without a registry and run a study in it; needs root
# make faults  disturb runs FAULTS=500 times and check that the next run gives the same results
# make fuzz    change inputs at random, FUZZ=100000; each must give an answer or a one-line error
# make same    compare tables and figures byte for byte: on one core, under four kernels, PYTHONS=other bin/python
# make attack  search for joints whose safe load exceeds their capacity, EVALUATIONS=1800 per start
# make measured  compare loads of walls and dry contacts in laboratories with computed ones; ENGINE=yade: a wall in YADE too
# make structures  compare structures of blocks with published results; PEERS=1: with compas_cra as well
# make scaling measure time, files and memory of large studies, CASES=100000
# make docs    build the pages as a site: build/docs/index.html
# make bench   measure run times on this machine; BASE=folder: also of another checkout; PEERS=1: other programs
# make mutants insert faults into the code and count those that the tests detect, MUTANTS=200
# make lint    run ruff, snakefmt, mypy and import-linter
# make lock    pin the newest versions that pyproject.toml allows
# Another study: make study CONFIG=my.yaml RESULTS=my-results
# Another Python than python3 for the environment: make study PYTHON=python3.13
# Retry cases that ended without a result, although nothing has changed: make study RETRY=1

CONFIG ?= config.yaml
RESULTS ?=
CASE ?=
FORMAT ?= table
MODEL ?=
BASE ?=
PROFILE ?=
RETRY ?=
FAULTS ?= 500
FUZZ ?= 100000
MUTANTS ?= 200
CASES ?= 100000
PYTHON ?= python3
PYTHONS ?=
PEERS ?=
ENGINE ?=
EVALUATIONS ?= 1800
# Exported, so that the shell receives the values unchanged, whatever characters they contain.
export PYTHON CONFIG RESULTS CASE FORMAT MODEL BASE PROFILE RETRY FAULTS FUZZ MUTANTS CASES EVALUATIONS
export MPLBACKEND := Agg
BIN := .venv/bin
# A run ends with make, however that ends.
RUN = @exec setpriv --pdeathsig KILL env PYTHONUTF8=1 $(BIN)/python -m
TO = "$$CONFIG" $(INTO)
INTO = --results="$$RESULTS"
COMPILE = $(BIN)/uv pip compile --quiet --generate-hashes --upgrade --universal --no-annotate --no-emit-index-url \
	--custom-compile-command "make lock" --extra study pyproject.toml

.PHONY: study locks case cases report explore calibrate decks docs bench test quick test-slurm test-container faults fuzz mutants same attack measured structures scaling lint format lock early system system-test clean
.DELETE_ON_ERROR:

study: .venv/study.ready $(if $(filter slurm,$(PROFILE)),.venv/slurm.ready)
	$(RUN) workflow study $(TO) --profile="$$PROFILE"

locks: .venv/study.ready $(if $(filter slurm,$(PROFILE)),.venv/slurm.ready)
	$(RUN) workflow study studies/locks/config.yaml $(INTO) --profile="$$PROFILE"

case: .venv/study.ready
	$(RUN) analysis case $(TO) --case="$$CASE" --model="$$MODEL"

cases: .venv/study.ready
	$(RUN) workflow cases $(TO) --format="$$FORMAT"

calibrate: .venv/study.ready
	$(RUN) analysis calibrate $(TO)

report: .venv/study.ready
	$(RUN) workflow report $(TO)

explore: .venv/study.ready
	@exec $(BIN)/python -m analysis.explore.app

decks: .venv/study.ready
	$(RUN) workflow decks $(TO)

docs: .venv/test.ready
	$(BIN)/sphinx-build -q -W --keep-going -b html docs build/docs
	@echo "Pages: build/docs/index.html"

bench: .venv/test.ready $(if $(PEERS),.venv/peers.ready)
	@OPENBLAS_NUM_THREADS=1 exec $(BIN)/python -m benchmarks.bench $(if $(BASE),--base "$$BASE") $(if $(RESULTS),--results "$$RESULTS")

# With packages that users may add, so that no test is skipped.
test: .venv/test.ready .venv/compas.ready .venv/rhino.ready .venv/step.ready lint
	$(BIN)/pytest --numprocesses 2 --dist worksteal

quick: .venv/test.ready
	$(BIN)/pytest --numprocesses 2 --dist worksteal -m "not engine and not study and not long and not machine"

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

measured: .venv/study.ready
	$(if $(filter-out yade,$(ENGINE)),$(error ENGINE: $(ENGINE) is not allowed; it must be yade))
	@export OPENBLAS_NUM_THREADS=1; results="$${RESULTS:-results-measured}"; \
	$(BIN)/python -m studies.measured.walls --results "$$results" && \
	$(BIN)/python -m studies.measured.contacts --results "$$results" && \
	$(BIN)/python -m studies.measured.specimens "$$results/tables/specimens.csv" && \
	$(if $(ENGINE),$(BIN)/python -m studies.measured.yade --results "$$results" && )exec $(BIN)/python -m studies.pages "$$results" docs/measured.md

structures: .venv/study.ready $(if $(PEERS),.venv/peers.ready)
	@export OPENBLAS_NUM_THREADS=1; results="$${RESULTS:-results-structures}"; \
	$(BIN)/python -m studies.structures.compare --results "$$results" && \
	exec $(BIN)/python -m studies.pages "$$results" docs/structures.md

scaling: .venv/test.ready
	@exec $(BIN)/python -m benchmarks.scaling --cases "$$CASES" $(if $(RESULTS),--results "$$RESULTS")

lint: .venv/test.ready
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/snakefmt --check Snakefile workflow/rules analysis/rules studies
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

format: .venv/test.ready
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .
	$(BIN)/snakefmt Snakefile workflow/rules analysis/rules studies

.venv/study.ready: requirements/study.txt pyproject.toml | early system
	@sh workflow/environment.sh

.venv/test.ready: requirements/dev.txt .venv/study.ready | system-test
	@sh workflow/install.sh requirements/dev.txt
	@touch $@

.venv/%.ready: requirements/%.txt .venv/study.ready
	@sh workflow/install.sh $<
	@touch $@

# Nothing is installed for a file that is not there.
early:
	@test -f "$$CONFIG" || { echo "$$CONFIG: not a file" >&2; exit 1; }

system: early
	@sh workflow/system.sh

system-test:
	@sh workflow/system.sh test

# Each extra has a file with the packages that it adds to the study's. One file for all is not possible: pip takes
# no digests from constraints, and users who run studies should not install the developers' packages.
lock: .venv/test.ready
	$(COMPILE) --output-file requirements/study.txt
	for extra in installer dev slurm peers compas rhino step; do \
		$(COMPILE) --extra $$extra --constraint requirements/study.txt --output-file requirements/$$extra.txt \
			$$(sed -n 's/^\([A-Za-z0-9._-]*\)==.*/--no-emit-package \1/p' requirements/study.txt) && \
		{ [ $$extra = installer ] || sed -i '2a --requirement study.txt' requirements/$$extra.txt; } || exit 1; \
	done

clean:
	rm -rf .venv .venv.old .snakemake results
