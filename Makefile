# Kirigami Studio.  In a fresh clone, `make run` or `make test` is enough; both set up .venv first.
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.setup-done
DOCS_STAMP := .venv/.docs-done
TORCH_INDEX := https://download.pytorch.org/whl/cpu

# Arrays are small: more threads only slow each other down.
export OMP_NUM_THREADS ?= 2
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# The tests start dozens of programs: what Python compiled for one of them is kept for the others.
unexport PYTHONDONTWRITEBYTECODE

# Values and geometry; files that name what takes seconds to import are not even read.
QUICK_TESTS = $(shell grep -rLE --include='test_*.py' 'torch|distributed|PySide6' tests/property \
  $(wildcard $(addprefix tests/unit/,foundation lattice evaluate fabricate project)))

CATALOGUES := $(patsubst %.po,%.mo,$(wildcard resources/locale/*/LC_MESSAGES/*.po))

.PHONY: help setup run test test-all test-durations fuzz soak pinned prints checks readers quick lint bench consumers demo states pairs pictures shapes gallery figures notebook \
  animation site site-serve messages package release clean
.DEFAULT_GOAL := help

help:
	@echo "make setup   create .venv with everything that the program and its tests need"
	@echo "make run     open the window (without a display: play a session off-screen into out/)"
	@echo "make test    run lint, then the tests that fit into a budget of time"
	@echo "make test-all  lint and every test: before a release"
	@echo "make test-durations  measure every test, for the choice that make test makes: tests/durations.json"
	@echo "make fuzz    read INPUTS damaged files with every reader; bad ones are kept in build/fuzz"
	@echo "make pinned  write DESIGNS random pinned designs and read them back without the program"
	@echo "make prints  write PRINTS random designs on printed pins, and read them back by other libraries"
	@echo "make checks  export SETS random designs of every construction, and check their files against their exports"
	@echo "make readers  read ICONS drawings of public packages and test suites, and compare them with what others paint"
	@echo "make soak    call off 500 runs and undo 500 edits in one window, and tell what it holds"
	@echo "make quick   only tests that need neither Qt nor torch; under 20 seconds"
	@echo "make lint    run ruff, mypy and the import contracts"
	@echo "make bench   time the exact geometry"
	@echo "make consumers  check cut files with MeerK40t, installed in an environment of its own"
	@echo "make demo    design a heart on the command line into out/heart"
	@echo "make states  save pictures of every state of the window to out/states, at 200 % to out/states-200, of its pages to out/pages-*"
	@echo "make pairs   make the bundled designs from one shape to another: resources/pairs"
	@echo "make pictures  make the pictures of README, guide and tutorials with the program"
	@echo "make shapes  make docs/pictures/shapes.png: three states of the first design for every library silhouette"
	@echo "make gallery  draw the pictures of docs/gallery, and design what is missing"
	@echo "make figures  draw the figures of docs/mathematics.md"
	@echo "make animation  play and record two minutes of use: docs/pictures/session.mp4"
	@echo "make notebook  play docs/first-design.ipynb and keep what its cells show"
	@echo "make site    build the documentation into build/site; works without a network once .venv is there"
	@echo "make messages  collect all sentences for translators in build/kirigami_studio.pot"
	@echo "make package   wheel, source archive, frozen program and Debian package of this tree in dist, each tried as installed"
	@echo "make release   the same of a commit whose version is in the changelog, with checksums"
	@echo "make clean   remove what the other targets made, except .venv"

setup: $(STAMP) $(CATALOGUES)

# Catalogues as gettext reads them, compiled as setup.py does: pybabel takes "30 % of" for a placeholder, and fails.
COMPILE := import sys; from babel.messages import mofile, pofile; \
  mofile.write_mo(open(sys.argv[2], "wb"), pofile.read_po(open(sys.argv[1], "rb")))
%.mo: %.po | $(STAMP)
	@$(BIN)/python -c '$(COMPILE)' $< $@

# torch first and by itself: only it needs the extra index, and only once.  System libraries come meanwhile.
# pip would compile everything on one core, which takes as long as all the rest; Python compiles what is left out here
# when it is needed.  As pip does, this goes on past files that are no Python: templates that come with PySide.
INSTALL := $(BIN)/python -m pip install -q --no-compile -c packaging/constraints-cpu.txt
# A path, and no import hook, so that type checkers and editors find the program.
EDITABLE := --config-settings editable_mode=compat -e
SELDOM_USED := tests|_inductor|_dynamo|onnx|sympy|networkx|mypy|pip|pygments|mpmath
$(STAMP): pyproject.toml setup.py packaging/constraints-cpu.txt packaging/system_libraries.sh
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "Kirigami Studio needs Python 3.11 or newer. Choose one with: make PYTHON=/path/to/python3 $(MAKECMDGOALS)"; exit 1; }
	sh packaging/system_libraries.sh & libraries=$$!; \
	{ test -x $(BIN)/python || $(PYTHON) -m venv .venv; } \
	  && $(INSTALL) --retries 1 --extra-index-url $(TORCH_INDEX) torch \
	  && $(INSTALL) $(EDITABLE) '.[test,lint]' \
	  && { $(BIN)/python -m compileall -qq -j 0 -x '/($(SELDOM_USED))/' .venv/lib || true; }; made=$$?; \
	  wait $$libraries && exit $$made
	@touch $@

run: setup
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ] || [ "$$(uname)" = Darwin ]; then \
	  $(BIN)/kirigami-studio; \
	else \
	  echo "No display: playing a session off-screen. Pictures and the cut file go to out/"; \
	  QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.lab.demonstrations.offscreen_session --out out; \
	fi

# Lint and tests both run, whichever fails; the summary of pytest stands last.  Two processes of one thread each play the
# tests, and one that has nothing left takes tests from the other: files with few tests hold some of the longest.
# While the types are checked, all tests are read once: pytest keeps what it compiled, and both processes begin with it.
#: Seconds of processors that the tests of `make test` may take; tests/time_budget.py chooses.  make test BUDGET=300
#: Two cores give 960 in eight minutes; lint and reading the tests in both processes take some 200 of them.
BUDGET ?= 930
#: Processes that play tests.
PROCESSES ?= 2
CHOICE = --budget $(BUDGET)
PLAY := OMP_NUM_THREADS=1 QT_QPA_PLATFORM=offscreen $(BIN)/python -m pytest -n $(PROCESSES) --dist worksteal
test: setup
	@{ sh packaging/system_libraries.sh tests; \
	  QT_QPA_PLATFORM=offscreen $(BIN)/python -m pytest --collect-only -qq > /dev/null 2>&1; } & reading=$$!; \
	  failed=0; $(MAKE) --no-print-directory lint || failed=1; wait $$reading; \
	  echo "$(PLAY) $(CHOICE)"; $(PLAY) $(CHOICE) || failed=1; \
	  test $$failed = 0 || echo "make test: lint or tests failed, see above"; exit $$failed

# Every test: before a release, and once a week by itself.
test-all:
	@$(MAKE) --no-print-directory test CHOICE=

# Commit what comes out when tests have become much longer or shorter.
test-durations: setup
	HYPOTHESIS_PROFILE=short $(PLAY) --record-durations

#: Damaged files for every reader, until INPUTS are read: make fuzz INPUTS=20000 SEED=7
INPUTS ?= 1000
SEED ?= 0
#: READERS="target-svg target-dxf target-pdf target-picture" for those of targets by kind; JOBS processes at a time.  A stopped run goes on where it was.
READERS ?=
JOBS ?= 2
fuzz: setup
	OMP_NUM_THREADS=1 QT_QPA_PLATFORM=offscreen $(BIN)/python tests/fuzzed_readers.py --inputs $(INPUTS) --seed $(SEED) \
	  --jobs $(JOBS) --out build/fuzz $(READERS)

#: Random pinned designs, written, and read back without the program: make pinned DESIGNS=200
DESIGNS ?= 200
pinned: setup
	OMP_NUM_THREADS=1 $(BIN)/python tests/random_assemblies.py $(DESIGNS)

#: Icons of npm packages, drawings of test suites from Debian's, and pictures: make readers ICONS=200 SEED=0 KINDS=dxf-tests
KINDS ?=
ICONS ?= 200
readers: setup
	OMP_NUM_THREADS=1 $(BIN)/python tests/drawings_read.py --icons $(ICONS) --seed $(SEED) --out build/readers $(KINDS)

#: Random designs on printed pins, written and read back by lib3mf and numpy-stl.
PRINTS ?= 40
prints: setup
	OMP_NUM_THREADS=1 $(BIN)/python tests/random_prints.py $(PRINTS)

#: Random pinned, backed and printed designs, exported, each file checked alone and beside its design.
SETS ?= 20
checks: setup
	OMP_NUM_THREADS=1 $(BIN)/python tests/exported_sets.py $(SETS)

#: One window for an hour: GENERATIONS runs called off, EDITS undone; what it holds meanwhile, a line of JSON each.
GENERATIONS ?= 500
EDITS ?= 500
soak: setup
	OMP_NUM_THREADS=1 QT_QPA_PLATFORM=offscreen $(BIN)/python tests/soaked_window.py \
	  --generations $(GENERATIONS) --edits $(EDITS)

#: Seconds of processors for the tests of `make quick`; to read them takes 5 more.
QUICK_BUDGET ?= 6
quick: setup
	@HYPOTHESIS_PROFILE=quick $(BIN)/python -m pytest -p no:pytest-qt --budget $(QUICK_BUDGET) $(QUICK_TESTS)

lint: setup
	@$(BIN)/mypy --num-workers 2 & types=$$!; failed=0; \
	  $(BIN)/ruff check . || failed=1; $(BIN)/ruff format --check . || failed=1; $(BIN)/lint-imports || failed=1; \
	  wait $$types || failed=1; exit $$failed

bench: setup
	$(BIN)/python -m kirigami_studio benchmark lattice

# MeerK40t pins its own dependencies, so it has its own environment; the tests look for it here.
CONSUMERS := .venv-consumers
consumers: setup
	test -x $(CONSUMERS)/bin/python || $(PYTHON) -m venv $(CONSUMERS)
	$(CONSUMERS)/bin/python -m pip install -q meerk40t ezdxf Pillow
	$(BIN)/python -m pytest tests/consumers

demo: setup
	$(BIN)/kirigami-studio design heart --k 8 --out out/heart

states: setup
	for language in en de; do for scale in 1 2; do \
	  QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.lab.demonstrations.state_sheet \
	    --language $$language --scale $$scale --out out/states-$$language-$$scale || exit 1; done; done

pairs: setup
	$(BIN)/python packaging/make_pairs.py

#: Designs in plywood for their picture.
PLYWOOD := --material plywood-co2 --width-mm 300 --grid auto --k 8 --out out/plywood
pictures: setup
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.lab.demonstrations.offscreen_session --out out/pictures
	cp out/pictures/4-designs.png docs/pictures/window.png
	$(BIN)/kirigami-studio animate resources/examples/heart.kiri --out docs/pictures/heart.gif
	$(BIN)/python -c "import kirigami_studio as ks; print(ks.load_project('resources/examples/heart.kiri').best._repr_svg_())" \
	  > docs/pictures/python-api.svg
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.lab.demonstrations.offscreen_session --pairs --scale 2 --out out/pictures
	cp out/pictures/pairs.png docs/pictures/pairs.png
	cp out/pictures/pairs-small.png resources/guide/pairs.png
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.lab.demonstrations.guide_pictures --out resources/guide
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.lab.demonstrations.guide_pictures --language de --out resources/guide/de
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.lab.demonstrations.offscreen_session --pairs --scale 2 --language de --out out/pictures/de
	cp out/pictures/de/pairs-small.png resources/guide/de/pairs.png
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.lab.demonstrations.tutorial_pictures --out docs/pictures/tutorials
	$(BIN)/kirigami-studio design heart $(PLYWOOD)/1-heart
	$(BIN)/kirigami-studio design star $(PLYWOOD)/2-star
	$(BIN)/kirigami-studio design square --start circle $(PLYWOOD)/3-disk
	$(BIN)/python -m kirigami_studio.lab.demonstrations.assembled_pieces out/plywood/*/design.kiri --out docs/pictures/plywood.png
	$(BIN)/python -m kirigami_studio.lab.demonstrations.printed_states resources/pairs/02-circle-to-square.kiri \
	  $$($(BIN)/python -c "import pathlib, skimage.data as d; print(pathlib.Path(d.__file__).parent / 'coffee.png')") \
	  --out docs/pictures/artwork.png

shapes: setup
	@mkdir -p out
	$(BIN)/kirigami-studio benchmark designs --targets library --grid auto --k 32 --polish 15 --states \
	  --picture out/shapes.png --out out/shapes.json
	cp out/shapes.png docs/pictures/shapes.png

gallery: setup
	$(BIN)/python packaging/make_gallery.py

figures: setup
	$(BIN)/python -m kirigami_studio.lab.demonstrations.mathematics_figures --out docs/pictures/mathematics

animation: setup $(DOCS_STAMP)
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.lab.demonstrations.screencast --out docs/pictures

notebook: setup $(DOCS_STAMP)
	$(BIN)/python packaging/play_notebook.py docs/first-design.ipynb

# MkDocs and what it needs, and what plays notebooks; the tests build the site too.
$(DOCS_STAMP): $(STAMP)
	$(BIN)/python -m pip install -q -c packaging/constraints-cpu.txt $(EDITABLE) '.[docs]'
	@touch $@

site: setup $(DOCS_STAMP)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	@echo "build/site/index.html"

site-serve: setup $(DOCS_STAMP)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs serve

# The translators' template: every sentence of the program, without line numbers, so that only new words change it.
messages: setup
	@mkdir -p build
	$(BIN)/python packaging/messages.py > build/kirigami_studio.pot

# docs/releasing.md says what has to agree.  Both make environments of their own, below build.
package:
	$(PYTHON) packaging/release.py --any-tree

release:
	$(PYTHON) packaging/release.py

clean:
	rm -rf out build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache .benchmarks
	find kirigami_studio tests packaging -name __pycache__ -prune -exec rm -rf {} +
