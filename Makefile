# `make help` lists what there is. Every target sets up `.venv` first where it is missing.
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.DEFAULT_GOAL := help
.PHONY: help test test-slow lint suites

help: ## list the targets
	@grep -hE '^[a-z][a-z-]*:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 22

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[analysis,pddl,execution,cluster,dev]'
	$(BIN)/python -m smash.planners.warm
	touch $@

test: $(STAMP) ## run the tests (minutes); slow ones with `make test-slow`
	$(BIN)/python -m pytest

test-slow: $(STAMP) ## run the slow tests too
	$(BIN)/python -m pytest -m 'slow or not slow' --timeout=900

lint: $(STAMP) ## ruff and mypy, both strict
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

suites: $(STAMP) ## make the committed instance sets again, byte for byte
	$(BIN)/python -m smash.problem.make_suites
