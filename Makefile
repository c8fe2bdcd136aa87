# make demo: install and run the main job on the fixture logs. make test: what CI runs.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
QUICK := -m "not slow"
FUZZ_MINUTES ?= 60

.PHONY: demo test check lint layers docs golden fixtures bench soak clean

$(VENV)/.installed: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1"
	$(BIN)/python -m pip install --quiet --editable .
	touch $@

$(VENV)/.installed-tools: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --group dev
	touch $@

demo: $(VENV)/.installed
	BIN=$(BIN) sh docs/demo.sh

lint: $(VENV)/.installed-tools
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/codespell
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache
	$(BIN)/python docs/make_reference.py --check
	$(BIN)/python docs/make_schematics.py --check

check: lint
	$(BIN)/python -m pytest -q -n 2 $(QUICK) --cov --cov-report=term

test: lint
	$(BIN)/python -m pytest -q -n 2 --cov --cov-report=term --durations=10

layers: $(VENV)/.installed-tools
	$(BIN)/lint-imports --no-cache

docs: $(VENV)/.installed-tools
	$(BIN)/python docs/make_reference.py
	$(BIN)/python docs/make_schematics.py

golden: $(VENV)/.installed-tools
	MPAP_REWRITE_GOLDEN=1 $(BIN)/python -m pytest -q tests/commands

fixtures: $(VENV)/.installed
	$(BIN)/python fixtures/make.py

bench: $(VENV)/.installed-tools
	$(BIN)/python benchmarks/run.py

soak: $(VENV)/.installed-tools
	HYPOTHESIS_PROFILE=soak $(BIN)/python -m pytest -q -n 2 --durations=10
	PYTHONPATH=. $(BIN)/python benchmarks/robustness/fuzz.py --minutes $(FUZZ_MINUTES) fixtures \
		$(if $(MPAP_SHARED),$(MPAP_SHARED)/data/logs)
	PYTHONPATH=. $(BIN)/python benchmarks/robustness/kills.py --kills 30
	PYTHONPATH=. $(BIN)/python benchmarks/long_histories/long_runs.py --hours 100

clean:
	rm -rf $(VENV) mpap-out .mypy_cache .pytest_cache .ruff_cache .hypothesis .coverage
