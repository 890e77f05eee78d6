# The two commands a newcomer needs: `make explore` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OLDEST := .venv-oldest
OLDEST_PYTHON ?= python3.11
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check
# Exact versions; with the hash of every file too where these are listed for this Python and machine (`make lock`).
LIST = constraints/$(shell $(BIN)/python -c 'import sys, sysconfig; print(f"cp{sys.version_info.major}{sys.version_info.minor}-{sysconfig.get_platform()}")')
# The solvers are compiled by the first answer that needs them: now, not when somebody waits for it.
COMPILED = $(BIN)/hpsop evaluate dtc-p4119 --level 2 > /dev/null
# One thread of linear algebra a process: the same bits everywhere, and two cores for two workers.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1

.PHONY: explore test test-core test-oldest lint soak faults benchmark docs pictures chromium lock clean

explore: $(VENV)/installed
	$(BIN)/hpsop-explore $(ARGS)

# Two files of tests side by side, all that need the browser in one of the two (tests/conftest.py). One after another:
# make test TWO_AT_ONCE=
TWO_AT_ONCE := --numprocesses 2 --dist loadfile --no-loadscope-reorder --max-worker-restart 0

test: lint chromium
	$(BIN)/python -m pytest -m "not soak" $(TWO_AT_ONCE)

test-core: lint
	$(BIN)/python -m pytest -m "not soak and not browser" $(TWO_AT_ONCE)

lint: $(VENV)/installed-for-tests
	$(BIN)/ruff check .
	$(BIN)/ruff format --check --quiet .
	$(BIN)/mypy

# The wheel, as a stranger gets it, with the oldest versions that pyproject.toml allows. Not from the checkout: no -m,
# no pythonpath. Compiled kernels have a folder of their own, so that two numbas do not overwrite each other's.
test-oldest: $(OLDEST)/installed
	NUMBA_CACHE_DIR=$(CURDIR)/$(OLDEST)/numba $(OLDEST)/bin/pytest -m oldest -o pythonpath= -p no:cacheprovider -W ignore

soak: $(VENV)/installed-for-tests
	$(BIN)/python -m pytest -m soak

# Plants faults into a copy of the tree, one at a time, and expects red tests; about an hour, no part of `make test`.
faults: $(VENV)/installed-for-tests
	$(BIN)/python -m tools.faults $(ARGS)

benchmark: $(VENV)/installed-for-tests
	for script in benchmarks/bench_*.py; do echo "== $$script"; PYTHONPATH=. $(BIN)/python $$script || exit 1; done

# The documentation as a site in site/; nothing is fetched while it is built. To read it: python -m http.server -d site
docs: $(VENV)/installed-for-docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict

# Every picture of the docs, anew.
pictures: $(VENV)/installed-for-tests chromium
	for what in hull own_files propeller rankine blade_panels; do \
		$(BIN)/python -m tools.pictures.$${what} --to docs/pictures || exit 1; done
	$(BIN)/python -m tools.pictures.page --docs --to docs/pictures

chromium:
	@.ci/chromium

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "hpsop needs Python 3.11 or newer; set PYTHON=python3.11" >&2; exit 1; }
	@$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); echo "no virtual environment: install the package python3-venv" >&2; exit 1; }

$(VENV)/installed: $(VENV)/bin/python pyproject.toml constraints.txt $(wildcard constraints/*.txt)
	@if [ -f $(LIST).txt ]; then \
		$(PIP) --require-hashes --requirement $(LIST).txt && $(PIP) --no-deps --no-build-isolation --editable .; \
	else $(PIP) --constraint constraints.txt --editable .; fi
	@$(COMPILED)
	@touch $@

$(VENV)/installed-for-tests: $(VENV)/bin/python pyproject.toml constraints.txt $(wildcard constraints/*.txt)
	@if [ -f $(LIST)-tests.txt ]; then \
		$(PIP) --require-hashes --requirement $(LIST)-tests.txt && $(PIP) --no-deps --no-build-isolation --editable .; \
	else $(PIP) --constraint constraints.txt --editable '.[test]'; fi
	@$(COMPILED)
	@touch $@ $(VENV)/installed

$(VENV)/installed-for-docs: $(VENV)/bin/python pyproject.toml constraints.txt $(wildcard constraints/*.txt)
	@if [ -f $(LIST)-docs.txt ]; then \
		$(PIP) --require-hashes --requirement $(LIST)-docs.txt && $(PIP) --no-deps --no-build-isolation --editable .; \
	else $(PIP) --constraint constraints.txt --editable '.[docs]'; fi
	@touch $@

# After constraints.txt was changed: the hashes of the files that this Python and machine take.
lock: $(VENV)/bin/python
	$(BIN)/python -m tools.lock

$(OLDEST)/bin/python:
	@$(OLDEST_PYTHON) -m venv $(OLDEST) || { rm -rf $(OLDEST); \
		echo "the oldest versions are for Python 3.11; set OLDEST_PYTHON=..." >&2; exit 1; }

# Installed anew where anything that goes into the wheel has changed.
$(OLDEST)/installed: $(OLDEST)/bin/python pyproject.toml constraints-oldest.txt \
		$(shell find hpsop_core explorer assets -type f -not -name '*.pyc')
	$(OLDEST)/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints-oldest.txt '.[dask]' pytest
	$(OLDEST)/bin/python -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps .
	@rm -rf build
	@touch $@

clean:
	rm -rf $(VENV) $(OLDEST) build site *.egg-info .mypy_cache .ruff_cache .pytest_cache
