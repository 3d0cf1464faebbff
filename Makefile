# `make course` and `make test` install everything that a fresh machine needs, in $(VENV): see setup.sh.
#
#   make PYTHON=python3.12 ...     with another Python (default: the environment's own, otherwise python3)
#   make VENV=/some/place ...      with the environment in another place
#   make TESTS=yes setup           with what the tests and linters need, which `make test` installs otherwise

PYTHON ?=
VENV   ?= .venv
TESTS  ?=
BIN    := $(VENV)/bin

# Set by another environment's ROS wheels, it would keep ours from finding their libraries.
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE

# Another installation's modules and settings; a sourced ROS 2, which sets ROS_DISTRO, needs its PYTHONPATH.
unexport PYTHONHOME PYTHONOPTIMIZE PYTHONWARNINGS LD_PRELOAD
ifndef ROS_DISTRO
unexport PYTHONPATH
endif

# Without __pycache__, each of some thousand Pythons would compile Spinbook's modules again.
unexport PYTHONDONTWRITEBYTECODE

# A sourced ROS 2 brings pytest plugins that do not load with a current pytest: only those named here are.
PYTEST := PYTEST_DISABLE_PLUGIN_AUTOLOAD=1 $(BIN)/pytest -p pytest_timeout -p xdist.plugin -p _hypothesis_pytestplugin

# A target's variable is that of its prerequisites, too: here, of `setup`.
test soak: TESTS := yes

.PHONY: help setup course class figures test soak audit doctor wheel lock clean

help:    ## List what can be made.
	@sed -nE 's/^([a-z-]+):.*##/\1\t/p' Makefile | expand -t 10

setup:   ## Make the virtual environment with every pinned dependency, or update it.
	@PYTHON="$(PYTHON)" VENV="$(VENV)" TESTS="$(TESTS)" sh setup.sh
	@VENV="$(VENV)" sh fetch-pyodide.sh

course: setup   ## Build, run and package the real course, make its site, and grade a class of twelve in every exercise.
	@$(BIN)/python benchmarks/class/beside.py \
		"$(BIN)/python benchmarks/class/grade_course.py --count 12 --seed 7 --out build/class" \
		"$(BIN)/spinbook build --execute --strict" \
		"$(BIN)/spinbook site --strict" \
		"$(BIN)/spinbook package"
	@echo
	@echo "The course is in build/notebooks, as it ran here in build/executed, its package in humanoid_ws."
	@echo "Its site is build/site/index.html: open it in any browser."
	@echo "The class's results are in build/class/results/index.html, with links to each exercise's and each student's page."
	@echo "Open a notebook in any editor, with $(BIN)/python as its Python."

class: setup   ## Make a class of 200, grade it, and check every grade; the pages are in build/class/results.
	$(BIN)/python benchmarks/class/grade_all.py --count 200 --out build/class

test: setup   ## Check style and the direction of imports, then run every test; mypy is one of them.
	@sh test-programs.sh
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(PYTEST) -n 4

figures: setup   ## Write docs/figures.md: seconds, memory and ratios to other graders, on an idle machine in half an hour.
	$(BIN)/python benchmarks/figures.py

soak: setup   ## Run the long suites in full, and count how often the same program gets another recording or grade.
	$(PYTEST) -m soak
	$(BIN)/python benchmarks/determinism/determinism.py --rounds 12 --json build/determinism.json

audit: setup   ## Show what every exercise's checks are worth; the report is in build/audit.html, the rules are in build/audit.md.
	@mkdir -p build
	$(BIN)/spinbook audit --html build/audit.html --json build/audit.json --markdown build/audit.md

doctor: setup   ## Say what works on this machine, and how to fix what does not.
	$(BIN)/spinbook doctor

wheel: setup   ## Write wheels of Spinbook, its middleware and the interfaces into build/wheels: nothing to compile elsewhere.
	@rm -rf build/wheels build/lib build/bdist.*
	@$(BIN)/python -m pip --disable-pip-version-check wheel --quiet --no-deps --no-build-isolation --wheel-dir build/wheels .
	@rm -rf build/lib build/bdist.*
	@$(BIN)/spinbook interfaces build
	@$(BIN)/python -m grader.wheels build/wheels

lock:    ## Pin the newest versions of every dependency (needs uv).
	sh lock.sh

clean:   ## Remove what was built; the virtual environment stays.
	rm -rf build humanoid_ws/build humanoid_ws/install humanoid_ws/log
