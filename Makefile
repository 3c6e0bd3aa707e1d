# Everything a developer types. `make` alone lists the targets.

.DEFAULT_GOAL := help
SHELL := /bin/bash
VENV := .venv
BIN := $(VENV)/bin
# Stamps: pip runs again only when what is to be installed has changed.
RUN := $(VENV)/.installed-run
DEV := $(VENV)/.installed-dev
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt

.PHONY: help demo test bare quick peers fuzz check licences site generated screenshots bench constraints clean

help:  ## list the targets
	@grep -hE '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

demo: $(RUN)  ## play the simulated robot
	@$(BIN)/woz demo

test: $(DEV)  ## run the tests; ARGS="-k stop" passes options on
	@.ci/test $(ARGS)

quick: $(DEV)  ## run the tests of the core and of what you changed, in under a minute
	@$(BIN)/python -m tools.quick_tests

bare: $(DEV)  ## run the tests of drivers, commands and host without tmux, alsa-utils and the like
	@.ci/bare $(ARGS)

peers: $(DEV)  ## install robots' own programs and run the tests against them; ARGS="-k goto"
	@.ci/peers $(ARGS)

fuzz: $(DEV)  ## run the property tests with many new random examples
	@HYPOTHESIS_PROFILE=fuzz .ci/test -m hypothesis --timeout 3600 $(ARGS)

check: $(DEV)  ## lint, format, types, import rules
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/lint-imports

licences: $(BIN)/python  ## see that every file has a licence (REUSE), with a program of its own
	@test -x $(VENV)/reuse/bin/reuse || { .ci/venv $(VENV)/reuse && $(VENV)/reuse/bin/pip install --quiet 'reuse>=6,<7'; }
	@$(VENV)/reuse/bin/reuse lint

generated: $(DEV)  ## write the pages, schemas and examples that come from the code
	@$(BIN)/python -m tools.generated
	@$(BIN)/python -m tests.protocol.examples
	@$(BIN)/python -m tests.log.story

site: $(DEV)  ## build the documents as a site with search, into build/site, with a program of its own
	@test -x $(VENV)/site/bin/zensical || { .ci/venv $(VENV)/site && $(VENV)/site/bin/pip install --quiet 'zensical>=0.0.70,<0.2'; }
	@$(BIN)/python -m tools.docs_tree build/pages
	@$(VENV)/site/bin/zensical build --clean --strict --config-file mkdocs.yml

screenshots: $(DEV)  ## draw the pictures of the documentation again
	@$(BIN)/python -m tools.screenshots
	@$(BIN)/python -m tools.film
	@$(BIN)/python -m tools.report_picture
	@$(BIN)/python -m tools.robot_pictures

bench: $(DEV)  ## measure what benchmarks/ measures; ARGS=--quick only sees that they run
	@$(BIN)/python -m benchmarks $(ARGS)

constraints: $(DEV)  ## look up the newest versions of all dependencies and pin them
	@$(BIN)/python .ci/pin.py

clean:  ## remove everything that make can make again
	@rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis \
	  .import_linter_cache .benchmarks
	@find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(BIN)/python:
	@PYTHON="$(PYTHON)" .ci/venv $(VENV)

$(RUN): pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing woz-tui into $(VENV) ..."
	@$(PIP) -e .
	@touch $@

$(DEV): pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing woz-tui and its development tools into $(VENV) ..."
	@$(PIP) -e '.[dev]'
	@touch $@ $(RUN)
