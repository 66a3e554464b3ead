# Everything runs in a local .venv built from requirements.lock. Needs python3 (3.11 or newer), its venv module and make.

SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
LOCKED := $(VENV)/.locked
READY := $(VENV)/.ready
BUILT := $(VENV)/.kernels
PEERS := $(VENV)/.peers
UV_VERSION := 0.13.8
ON_ALL_CORES := --numprocesses auto --dist worksteal
N ?= 20000

export PIP_DISABLE_PIP_VERSION_CHECK := 1

.DEFAULT_GOAL := help
.PHONY: help setup run test test-deep test-python audit lint format golden bench docs page lock clean

help:  ## show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup: $(READY)  ## install cagepose and all of its tools into .venv
	@echo "Ready. Try: $(BIN)/cagepose run scenes/rail-pitch.yaml"

$(LOCKED): requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	    echo "cagepose needs Python 3.11 or newer, and $(PYTHON) is not one; try: make setup PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
	    echo "$(PYTHON) cannot make virtual environments; on Debian and Ubuntu: apt install python3-venv" >&2; exit 1; }
	@echo "Step 1 of 4: a Python environment of its own in $(VENV)"
	@$(PYTHON) -m venv --clear $(VENV)
	@echo "Step 2 of 4: fetch and install the locked packages (a minute or two, once)"
	@set -o pipefail; $(BIN)/python -m pip install --progress-bar off --require-hashes -r requirements.lock | awk ' \
	    /^Collecting/ { n++; if (n % 10 == 0) { print "  " n " packages fetched"; fflush() } } \
	    /^Installing/ { print "  all " n " packages fetched; now they are installed"; fflush() }'
	@touch $@

# A kernel's change makes a new library; `pip install` below then finds it built.
$(BUILT): $(LOCKED) $(shell find src/cagepose/kernels -name '*.py') $(wildcard build_kernels/*.*)
	@echo "Step 3 of 4: compile the kernels (some five minutes the first time, later only what has changed)"
	@PYTHONPATH=src $(BIN)/python -m build_kernels
	@touch $@

$(READY): $(LOCKED) $(BUILT) pyproject.toml
	@echo "Step 4 of 4: install cagepose itself"
	@$(BIN)/python -m pip install -qq --no-deps --no-build-isolation -e .
	@touch $@

run: $(READY)  ## run the sample scene
	@$(BIN)/cagepose run scenes/sample.yaml

test: $(READY)  ## run all tests and the examples in docstrings (N=10000: with many random cases, see test-deep)
	@echo "Running all tests, some five minutes ..."
	@$(BIN)/python -m pytest $(ON_ALL_CORES) $(if $(filter file,$(origin N)),,--scenes $(N))

test-deep: $(READY)  ## run the tests that draw random cases with many of them, minutes (N=20000: scenes of the largest)
	@$(BIN)/python -m pytest $(ON_ALL_CORES) --only-random --scenes $(N)

test-python: $(READY)  ## run the tests of kernels and of stepwise runs with kernels as plain Python
	@CAGEPOSE_KERNELS=python $(BIN)/python -m pytest $(ON_ALL_CORES) tests/kernels tests/stepwise

audit: $(READY)  ## ask independent oracles about seeded scenes, six minutes (N=510: so many; CASE=grid:12: that one)
	@$(BIN)/python -m audit $(if $(filter file,$(origin N)),,--scenes $(N)) $(if $(CASE),--case $(CASE))

lint: $(READY)  ## check style, types and the floors' import contract
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@$(BIN)/python -m mypy
	@$(BIN)/lint-imports --no-logo

format: $(READY)  ## put all code into the project's style
	@$(BIN)/ruff check --fix
	@$(BIN)/ruff format

golden: $(READY)  ## write the golden runs of all scenes anew (say why in the commit)
	@$(BIN)/python tests/golden_runs.py

bench: $(PEERS)  ## measure cagepose beside its peers, minutes (ONLY=rail: that table alone)
	@$(BIN)/python -m bench $(if $(ONLY),--only $(ONLY))

$(PEERS): $(READY) bench/requirements.lock
	@echo "Installing the peers of the benchmark into $(VENV), once ..."
	@if $(BIN)/python -m pip install -qq --require-hashes -r bench/requirements.lock; then touch $@; \
	    else echo "Not all peers can be installed here; the benchmark skips those that are missing." >&2; fi

docs: $(READY)  ## build the documentation into build/docs
	@$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet --builder html docs build/docs
	@echo "Open build/docs/index.html"

page:  ## bundle the page of `cagepose view` and its editor anew, from page/ (needs node)
	@cd page && npm ci --silent && node build.mjs

lock:  ## renew requirements.lock from pyproject.toml
	@$(PYTHON) -m venv build/lock
	@build/lock/bin/python -m pip install -qq uv==$(UV_VERSION)
	@build/lock/bin/uv pip compile pyproject.toml --extra cad --extra dask --extra files --extra film --extra plot --extra shapes --extra study --extra view --group dev --group docs --output-file requirements.lock --upgrade \
	    --universal --python-version 3.11 --fork-strategy fewest --generate-hashes --no-annotate --no-emit-index-url \
	    --no-config --custom-compile-command "make lock" --quiet
	@build/lock/bin/uv pip compile pyproject.toml --extra bench --constraint requirements.lock --output-file bench/requirements.lock \
	    --universal --python-version 3.11 --fork-strategy fewest --generate-hashes --no-annotate --no-emit-index-url \
	    --no-config --custom-compile-command "make lock" --quiet

clean:  ## remove .venv and all that was built
	@rm -rf $(VENV) build dist docs/generated .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis
	@find src tests docs bench audit -name __pycache__ -type d -prune -exec rm -rf {} +
