# Every target sets up what it needs: a virtual environment in .venv from the hashed lock.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
# A process for each core, so one thread for the linear algebra of each: more of them wait
# for each other. An idle worker takes tests from a busy one: some take minutes.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1
# Workers and the commands that tests start share the bytecode that the first of them makes.
unexport PYTHONDONTWRITEBYTECODE
# Every n-th case: make test-long EVERY=4.
EVERY ?= 1
PYTEST := $(BIN)/pytest -n auto --dist worksteal --every $(EVERY)

# The newest supported Python on this machine that is newer than the oldest; may be empty.
NEWEST := $(firstword $(shell for v in 3.14 3.13 3.12; do \
  for p in python$$v $$HOME/.pyenv/versions/$$v.*/bin/python$$v; do \
  $$p -c "" 2>/dev/null && echo $$p; done; done))
# Rooms without an engine, and the planar one: minutes, not half an hour.
QUICK := tests/core tests/geometry tests/mechanics tests/rom tests/tracking tests/allocation \
  tests/planning tests/taskfile tests/planar studies/tests/allocation

.PHONY: demo test test-long ladder test-all test-newest quick search mutants lint results \
  random-tasks picture figures docs size lock clean

demo: $(READY)
	$(BIN)/pps run any-mode --out runs/demo --force

test: $(READY) lint
	$(PYTEST) -m "not long" --durations=20

test-long: $(READY)
	$(PYTEST) -m long --durations=20

# Only the long tests in the worlds of the tiers: a small part of the published ladder.
ladder: $(READY)
	$(PYTEST) -m long tests/jobs/test_tiers.py tests/jobs/test_tier_sweep.py

test-all: test test-long

quick: $(READY)
	$(PYTEST) -m "not long" $(QUICK)

# The laws on cases drawn anew, other ones every time.
search: $(READY)
	$(PYTEST) -m "not long" --hypothesis-profile=search $(QUICK)

test-newest:
ifeq ($(NEWEST),)
	@echo "No Python newer than 3.11 is on this machine: tested on one version only."
else
	$(MAKE) quick PYTHON=$(NEWEST) VENV=.venv-newest
endif

# Small faults in physics and control, each against the tests of its own package; resumable.
mutants: $(READY)
	$(BIN)/python tools/mutants.py

# The paper's experiments, and the documents that show their figures.
results: $(READY)
	$(BIN)/pps reproduce --out runs/results --force
	$(BIN)/python -m pushpressslide_studies.paper.documents \
	  runs/results/table.md studies/docs/results.md README.md

# The random tasks of studies/docs/random-tasks.md: hours; goes on where it ended.
random-tasks: $(READY)
	$(BIN)/python studies/tools/random_tasks.py run
	$(BIN)/python studies/tools/random_tasks.py write

picture: $(READY)
	$(BIN)/pps reproduce --only rear-push --out runs/picture --force
	cp runs/picture/rear-push/left/pictures.png docs/figures/rear-push-left.png
	$(BIN)/pps run post --video --out runs/picture/post --force
	$(BIN)/python tools/small_film.py runs/picture/post/run.mp4 docs/figures/post.webp

# The figures of README.md, docs/mechanics.md and docs/getting-started.md.
figures: $(READY)
	$(BIN)/python tools/mode_icons.py docs/figures
	$(BIN)/python tools/mechanics_figures.py docs/figures
	$(BIN)/python tools/tutorial_figures.py docs/figures

# The site in runs/site, read without a network; a link that leads nowhere is an error.
docs: $(READY)
	$(BIN)/mkdocs build

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

$(READY): requirements.lock pyproject.toml studies/pyproject.toml
	$(PYTHON) -c "import sys; sys.exit(0 if sys.version_info >= (3, 11) else 'Python 3.11 or newer is needed; say make PYTHON=python3.12')"
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation \
	  -e . -e ./studies
	touch $(READY)

# Megabytes that an installation downloads and takes, without extras and with Drake.
size:
	$(PYTHON) tools/size.py

# Needs uv; resolves for every Python from 3.11 on.
lock:
	uv pip compile pyproject.toml --extra dev --universal --generate-hashes --python-version 3.11 \
	  --no-emit-index-url --no-annotate --no-header -o requirements.lock

clean:
	rm -rf .venv .venv-newest runs .mypy_cache .ruff_cache .pytest_cache .hypothesis
