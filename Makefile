# One command a task; `make help` lists them. Everything runs in .venv, which `make setup` builds.

PYTHON ?= python3
UV ?=
BIN := .venv/bin
STAMP := .venv/.petalfoil-installed
JOBS ?= 2

# Two BLAS threads make the small blocks of this package many times slower; parallel work is over cases.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1
export MKL_NUM_THREADS := 1

# Compiled modules are kept, those that pytest rewrites too: without them every process compiles the package anew.
unexport PYTHONDONTWRITEBYTECODE

# With pip as it comes with Python, or quicker with uv: make test UV=uv
ifdef UV
VENV := $(UV) venv --quiet --seed --allow-existing --python $(PYTHON) .venv
INSTALL := $(UV) pip install --quiet --python $(BIN)/python --constraint constraints.txt
else
VENV := $(PYTHON) -m venv .venv
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt
endif

.DEFAULT_GOAL := help
.PHONY: help setup docs package ross demo test test-all test-studio test-classic test-long fuzz fuzz-verbs check lint types layers format bench constraints clean

help: ## List the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup: $(STAMP) ## Build .venv and install petalfoil with its tools

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "petalfoil needs Python 3.11 or newer")'
	$(VENV)
	$(INSTALL) --editable '.[dev]'
	@touch $@

DOCS_STAMP := .venv/.petalfoil-docs-installed

$(DOCS_STAMP): $(STAMP)
	$(INSTALL) --editable '.[docs]'
	@touch $@

docs: $(DOCS_STAMP) ## Documentation site in build/docs, offline
	$(BIN)/python -m sphinx -W --keep-going -q -b html -d build/doctrees docs build/docs

package: setup ## Wheel and sdist: built, checked, tried in empty environments (.ci/package)
	$(INSTALL) --editable '.[release]'
	.ci/package

ross: setup ## The tutorial with ROSS in an environment of its own (ROSS_PYTHON: a Python from 3.12 on)
	.ci/ross

demo: setup ## Load characteristic of the paper's packages: figures and data in demo/
	$(BIN)/python examples/demo.py demo

test: setup ## Fast tests
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal -m "not slow and not long" tests

test-studio: setup ## The page of `petalfoil studio` in a browser, under attack, and its processes
	$(BIN)/python -m pytest -n 0 -m "not long" tests/studio

test-classic: setup ## Tests of what numba compiles: the paper's own method, long motions
	$(INSTALL) --editable '.[classic]'
	$(BIN)/python -m pytest -n 0 -m "compiled and not long" tests
	$(BIN)/python -m pytest -n 0 tests/unit/system/test_compiled_points.py tests/unit/dynamics/test_compiled_stages.py

test-all: setup ## All tests
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal --durations 40 --durations-min 5 -m "not long" tests

test-long: setup ## Tests that take minutes to hours each
	$(BIN)/python -m pytest -n $(JOBS) -m long tests

N ?= 200
fuzz: setup ## N random bearings over the whole domain: a table by stratum (docs/random-bearings.md)
	$(BIN)/python -m tests.fuzz $(N) --jobs $(JOBS)

fuzz-verbs: setup ## Every analysis on N random bearings: converged, or a typed error
	$(BIN)/python -m tests.fuzz_verbs $(N) --jobs $(JOBS)

check: lint types layers ## Everything that reads the code without running it

lint: setup ## Style and mistakes (ruff)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: setup ## Types (mypy --strict)
	$(BIN)/mypy

layers: setup ## Who may import whom (import-linter)
	$(BIN)/lint-imports

format: setup ## Bring the code into shape
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: setup ## Ratios against other methods and sizes: a table, and benchmarks/results.json
	$(BIN)/python benchmarks/run.py --json benchmarks/results.json

constraints: ## Renew constraints.txt (needs uv)
	uv pip compile --quiet --universal --no-header --no-annotate --no-emit-index-url --all-extras pyproject.toml \
	  -o constraints.txt

clean: ## Remove what was built, .venv included
	rm -rf .venv build dist demo docs/gallery docs/tutorials/worked .mypy_cache .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
