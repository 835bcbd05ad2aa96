# Everything that one does with this repository. `make run` and `make test` need nothing but
# Python 3.11 to 3.14; PYTHON=python3.13 picks the interpreter.
SHELL := /bin/bash
.DEFAULT_GOAL := help
.PHONY: help setup-run setup-test run editor test attack check format lint type bench bench-peers accuracy chart screenshots screens wheel levels docs

export PYTHON
# Arguments for the editor (`make run ARGS=levels/s/first_flight.json`) and for pytest.
ARGS ?=
# Whom `make accuracy` measures.
PHYSICS ?= jax2d fast balanced accurate
# `make check TESTS=0` leaves the tests out.
TESTS ?= 1
# The suite runs in this many processes, each with whole files; 0 is the process of pytest itself.
WORKERS ?= 2

VENV := .venv/bin
PYTEST := $(VENV)/python -m pytest -n $(WORKERS) --dist loadfile --no-loadscope-reorder

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-12s %s\n", $$1, $$2 }' Makefile

setup-run:
	@scripts/setup.sh run

setup-test:
	@scripts/setup.sh test

run: setup-run ## set everything up and open the editor (without a display: a filmed tour under out/, or ARGS=--serve)
	@$(VENV)/python scripts/run.py $(ARGS)

editor: run ## the same as run

test: setup-test ## set everything up and run the whole test suite
	$(PYTEST) $(ARGS)

attack: setup-test ## damage every kind of input and kill every writer for an hour; prints what was lost
	$(VENV)/python -m tests.attack $(ARGS)

check: setup-test ## format, lint, types, layers and the tests that are not slow
	$(VENV)/ruff format --check
	$(VENV)/ruff check
	$(VENV)/basedpyright
	$(VENV)/lint-imports
ifneq ($(TESTS),0)
	$(PYTEST) -m "not slow" $(ARGS)
endif

format: setup-test ## write the source in the house's format
	$(VENV)/ruff format
	$(VENV)/ruff check --fix

lint: setup-test ## ruff, layers and, for information, the longest files and functions
	$(VENV)/ruff check
	$(VENV)/lint-imports
	$(VENV)/python scripts/longest.py

type: setup-test ## the type checker
	$(VENV)/basedpyright

bench-peers: setup-run ## install other engines beside .venv and measure them and us in turn
	@scripts/peers/install.sh
	@mkdir -p bench
	$(VENV)/kinetix bench peers --chart all --json $(ARGS) | tee bench/peers.jsonl
	@$(VENV)/python scripts/accuracy_docs.py

accuracy: setup-run ## measure PHYSICS in all scenes of the suite, two at a time, for docs/accuracy.md
	@mkdir -p bench/accuracy
	@printf '%s\n' $(PHYSICS) | xargs -P 2 -I NAME sh -c '$(VENV)/kinetix bench accuracy \
	  --scenes all --physics NAME --json >bench/accuracy/.NAME && \
	  mv bench/accuracy/.NAME bench/accuracy/NAME.jsonl && echo bench/accuracy/NAME.jsonl'
	@$(VENV)/python scripts/accuracy_docs.py

chart: setup-test ## measure our speed in the suite's scenes and draw docs/chart.png
	$(VENV)/kinetix bench chart $(ARGS)

bench: setup-run ## measure speed and rendering into bench/, one JSON object a line
	@mkdir -p bench
	$(VENV)/kinetix bench speed --json | tee bench/speed.jsonl
	$(VENV)/kinetix bench render --json | tee bench/render.jsonl

screenshots: setup-run ## take the pictures of docs/pictures anew, without a display
	@$(VENV)/python scripts/docs_pictures.py
	@$(VENV)/python -m scripts.contact_sheet

screens: setup-run ## picture the app in every size, scale and theme, into out/screens
	@$(VENV)/python -m scripts.screen_matrix $(ARGS)

wheel: setup-run ## check the wheel in empty environments outside of the checkout, for each Python at hand
	@$(VENV)/python scripts/check_wheel.py $(ARGS)

levels: setup-run ## build the bundled levels and their sets, pictures and catalogue anew
	@$(VENV)/python -m scripts.build_levels
	@$(VENV)/python -m scripts.contact_sheet
	@$(VENV)/python -m scripts.reference_docs

docs: setup-test ## write the documents as a site into site/, to be read without a network
	@NO_MKDOCS_2_WARNING=1 $(VENV)/mkdocs build --quiet
	@echo "site/index.html    (to search it as well: python3 -m http.server -d site)"
