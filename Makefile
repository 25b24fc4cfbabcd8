# Everything a developer or a curious person runs. Needs python3 with venv, and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-warn-script-location -c constraints.txt
DEMO_OUT ?= out/demo
DEMO_CLINIC ?= out/demo-clinic

# Linear solvers repeat bit for bit only with one thread (design/numerics.md, finding 5).
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1

.DEFAULT_GOAL := help
.PHONY: help demo test test-slow test-postgres check format evidence frontend serve-demo test-pages wheel clean

help: ## this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  make \1\t\2/' | expand -t 22

demo: $(VENV)/.installed ## install, analyse the demo recordings, then serve the web application with them in it
	$(BIN)/gaitlab demo --out $(DEMO_OUT)
	$(BIN)/gaitlab demo-clinic --results $(DEMO_OUT) --data-dir $(DEMO_CLINIC)

test: $(VENV)/.installed-dev ## all tests but the slow ones, on two cores
	$(BIN)/python -m pytest -m "not slow" -n 2 --dist loadfile

test-slow: $(VENV)/.installed-dev ## samples of what is heavy, on two cores
	$(BIN)/python -m pytest -m slow -n 2 --dist loadfile --durations=25

test-postgres: $(VENV)/.installed-dev ## tests of storage, jobs and API on the server at GAITLAB_TEST_DATABASE_URL
	$(BIN)/python -m pytest -m "not slow" tests/storage tests/jobs tests/api

check: $(VENV)/.installed-dev ## linters, types, layers, house style
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/pyright
	$(BIN)/lint-imports
	$(BIN)/python -m pytest -q tests/test_house_style.py

format: $(VENV)/.installed-dev ## rewrite the sources in the house's format
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

evidence: $(VENV)/.installed-dev ## measure every "Must hold" line (ONLY=word: some) into benchmarks/evidence/*.csv
	PYTHONPATH=tests $(BIN)/python benchmarks/evidence.py $(ONLY)

frontend: $(VENV)/.installed-dev ## build the web pages; Node comes as a wheel
	$(BIN)/python frontend/build_frontend.py

serve-demo: frontend ## run the web application on out/serve; drop data/demo_cp_child into a visit
	$(BIN)/gaitlab serve --data-dir out/serve

test-pages: frontend ## logic of the web pages; `make test-slow` drives them in a real Chromium
	$(BIN)/python frontend/build_frontend.py test

wheel: $(VENV)/.installed-dev ## build dist/*.whl, demo recordings included
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir dist .

clean: ## forget the environment and the outputs
	rm -rf $(VENV) out dist build

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: pyproject.toml constraints.txt | $(BIN)/python
	$(INSTALL) -e '.[server]'
	touch $@

$(VENV)/.installed-dev: pyproject.toml constraints.txt | $(BIN)/python
	$(INSTALL) -e '.[dev]'
	touch $@ $(VENV)/.installed
