# The only commands to know: make demo, make test, make check, make bench.
# Each makes what it needs in .venv; PYTHON=... chooses another interpreter (3.11 or later).

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt

.PHONY: demo test check bench clean

demo: $(VENV)/installed
	$(BIN)/adonis run macarena --out runs/macarena --video
	@echo "The dance is in runs/macarena: look at filmstrip.png and video.mp4."

test: $(VENV)/installed-dev
	$(BIN)/pytest -q -n 2

check: $(VENV)/installed-dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/pytest -q tests/test_structure.py
	$(BIN)/python tests/smoke_packages.py

bench: $(VENV)/installed
	$(BIN)/adonis bench --out runs/bench.json

clean:
	rm -rf $(VENV) build dist runs *.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(VENV)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "Adonis needs Python 3.11 or later; $(PYTHON) is older. Try: make PYTHON=python3.12"; exit 2; }
	$(PYTHON) -m venv $(VENV)
	@touch $@

$(VENV)/installed: $(VENV)/python pyproject.toml constraints.txt
	@echo "Installing Adonis into $(VENV) (a minute or two, the first time) ..."
	$(PIP) -e .
	@touch $@

$(VENV)/installed-dev: $(VENV)/installed
	$(PIP) -e '.[dev]'
	@touch $@
