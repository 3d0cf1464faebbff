# Everything a fresh machine needs is installed by these targets: `make course` and `make test`.

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
LOCKS  := constraints.txt $(shell $(PYTHON) -c 'import rclpy' 2>/dev/null || echo constraints-ros.txt)
READY  := $(VENV)/.ready

.PHONY: help setup course test lint soak lock doctor clean

help:    ## List what can be made.
	@grep -hE '^[a-z]+: .*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## /\1\t/' | expand -t 10

setup: $(READY)   ## Make the virtual environment with every pinned dependency.

$(READY): $(LOCKS) pyproject.toml
	@PYTHON="$(PYTHON)" VENV="$(VENV)" LOCKS="$(LOCKS)" sh setup.sh
	@touch $@

course: setup   ## Build, run and package the real course.
	$(BIN)/spinbook build --execute
	$(BIN)/spinbook package
	@echo
	@echo "Open the course:  $(BIN)/jupyter lab build/notebooks      (or any other notebook editor)"

test: setup   ## Check types and style, then run every test.
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/pytest

soak: setup   ## The long suites in their full size.
	$(BIN)/pytest -m soak

doctor: setup   ## Say what works on this machine, and how to mend what does not.
	$(BIN)/spinbook doctor

lock:    ## Pin the newest versions of every dependency (needs uv).
	sh lock.sh

clean:   ## Remove what was built; the virtual environment stays.
	rm -rf build humanoid_ws/build humanoid_ws/install humanoid_ws/log
