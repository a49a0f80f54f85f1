# Every target does its own set-up: a virtual environment with the pinned dependencies and this project in it.
VENV ?= .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
READY := $(VENV)/.ready
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps
# Why a test in wall time was run again is printed: a rerun hides no cause.
PYTEST := $(BIN)/pytest --durations 10 -raR --rerun-show-tracebacks

# Three targets at a time keep two cores busy: kernels and plants are compiled beside typed messages and `make lint`,
# and what compiles or checks gives way to tests in wall time.
MAKEFLAGS += --jobs=3
# Byte code is kept: the sources are parsed once, not at each start of a command or a worker of the tests.
export PYTHONDONTWRITEBYTECODE =

.PHONY: demo test test-slow docs bench bench-all lint setup messages clean

demo: $(READY)  ## scripted surgeon on mocks: recorded, analysed, shown
	$(BIN)/sher3 demo

test: test-wall lint $(VENV)/.plants test-all-but-wall  ## lint, types and every test but the slow ones

# Tests in wall time (graph and flaky) run beside lint and all others, which give way to them: processes of a robot that
# wake up a thousand times a second leave most of two cores idle, and `nice` lets them have a core the moment they want
# it. In the order of the files: long ones come first, so that neither of the two waits for the other at the end.
.PHONY: test-all-but-wall test-wall
test-all-but-wall: $(READY) lint
	nice -n 5 $(PYTEST) -n 2 --dist loadscope --no-loadscope-reorder \
		-m "not slow and not (graph and flaky)"

# Reads only the files that name the mark it asks for (`conftest.py` sees to it that they do): a quarter of the time to
# collect. What it says is shown at its end, in one piece.
test-wall: $(READY)
	mkdir -p build
	$(PYTEST) -m "graph and flaky and not slow" \
		$$(grep -rl flaky --include='test_*.py' tests $(wildcard sher3_ws/src/*/test)) > build/test-wall.log 2>&1; \
	status=$$?; cat build/test-wall.log; exit $$status

test-slow: $(READY)  ## colcon build and test of the workspace, a sealed challenge end to end
	$(BIN)/pytest -m slow

lint: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	nice -n 5 $(BIN)/pyrefly check

docs: $(READY)  ## the site in build/docs, readable offline; a warning is an error
	$(BIN)/python -m sphinx -W --keep-going -q -j auto -d build/doctrees docs build/docs
	@echo "build/docs/index.html"

bench: $(READY)  ## one page of speed, eleven minutes on a quiet machine; kept in docs/reference/speed.md
	$(BIN)/python bench/page.py --write docs/reference/speed.md

bench-all: $(READY)  ## everything that any page quotes a speed of: hours
	for script in $(filter-out bench/graph_run.py bench/page.py,$(wildcard bench/*.py)); do echo "== $$script"; $(BIN)/python $$script || exit 1; done

setup: $(READY)

messages: $(INSTALLED)  ## typed messages once more, where the set-up could not build them; needs a C compiler
	tools/build-messages $(VENV)

# No download address here or in requirements.txt: pip's own configuration says where from; the hashes say what.
# `requirements.txt` names everything there is to install, so pip need not look for more. Byte code is made where a module
# is first imported: of 148 MB of sources the tests import 41. Two halves at a time: pip waits for the network and unpacks
# one wheel after another.
$(INSTALLED): requirements.txt pyproject.toml tools/find-python
	test -x $(BIN)/python || "$$(tools/find-python)" -m venv $(VENV)
	for half in 0 1; do awk -v half=$$half '/^[a-z]/ { n++ } n % 2 == half' requirements.txt > $(VENV)/half-$$half.txt; done
	$(PIP) --no-compile --require-hashes -r $(VENV)/half-0.txt & first=$$!; \
	$(PIP) --no-compile --require-hashes -r $(VENV)/half-1.txt; second=$$?; wait $$first && exit $$second
	$(PIP) --no-build-isolation -e .
	touch $@

$(VENV)/.kernels: $(INSTALLED)
	$(BIN)/python -m sher3_bringup.processes.warm
	$(BIN)/python -m sher3_gap_cli.warm
	touch $@

# The truth plants of the challenge, which tests alone need at once: beside them, long before the first one asks.
$(VENV)/.plants: $(VENV)/.kernels
	nice -n 5 $(BIN)/python -m sher3_challenge.warm
	touch $@

$(VENV)/.messages: $(INSTALLED)
	tools/build-messages $(VENV) || echo "live topics of these types are left out; everything else works"
	touch $@

$(READY): $(VENV)/.kernels $(VENV)/.messages
	touch $@

clean:
	rm -rf $(VENV) sher3.egg-info build
