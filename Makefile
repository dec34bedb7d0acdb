# Kirigami Studio.  `make run` and `make test` are all a fresh clone needs; both set up .venv first.
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.setup-done
TORCH_INDEX := https://download.pytorch.org/whl/cpu

# Designs are small: more threads only get in each other's way.
export OMP_NUM_THREADS ?= 2
export PIP_DISABLE_PIP_VERSION_CHECK := 1

# Values and geometry; the readers of files and the raster scores take longer and wait for `make test`.
QUICK_TESTS := tests/architecture tests/property $(wildcard $(addprefix tests/unit/,foundation lattice evaluate fabricate project)) \
  --ignore=tests/unit/evaluate/test_siou.py

.PHONY: help setup run test quick lint bench consumers demo states pictures messages clean
.DEFAULT_GOAL := help

help:
	@echo "make setup   create .venv with everything the program and its tests need"
	@echo "make run     open the studio (without a display: play the session off-screen into out/)"
	@echo "make test    lint, then every test"
	@echo "make quick   the tests that need neither Qt nor torch, in under 20 seconds"
	@echo "make lint    ruff, mypy and the import contracts"
	@echo "make bench   print the timings of the exact geometry"
	@echo "make consumers  let MeerK40t, in an environment of its own, plan our cut files"
	@echo "make demo    design a heart on the command line into out/heart"
	@echo "make states  pictures of every state of the window into out/states, at 200 % into out/states-200"
	@echo "make pictures  the pictures of the README, from the real program"
	@echo "make messages  collect the sentences for translators in resources/locale"
	@echo "make clean   remove what the other targets made, .venv excepted"

setup: $(STAMP)

# torch first and by itself: only it needs the extra index, and only once.
$(STAMP): pyproject.toml setup.py packaging/constraints-cpu.txt packaging/system_libraries.sh
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "Kirigami Studio needs Python 3.11 or newer; name one with: make PYTHON=/path/to/python3 $(MAKECMDGOALS)"; exit 1; }
	@sh packaging/system_libraries.sh
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install -q --retries 1 --extra-index-url $(TORCH_INDEX) -c packaging/constraints-cpu.txt torch
	$(BIN)/python -m pip install -q -c packaging/constraints-cpu.txt -e '.[test,lint]'
	@touch $@

run: setup
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ] || [ "$$(uname)" = Darwin ]; then \
	  $(BIN)/kirigami-studio; \
	else \
	  echo "No display here: playing the session off-screen; pictures and the cut file go to out/"; \
	  QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.demonstrations.offscreen_session --out out; \
	fi

# What watches a clock, alone; then everything else, file by file in two processes of one thread each.
test: lint
	@sh packaging/system_libraries.sh tests
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m pytest -m clock
	OMP_NUM_THREADS=1 QT_QPA_PLATFORM=offscreen $(BIN)/python -m pytest -n 2 --dist loadfile -m "not clock"

quick: setup
	HYPOTHESIS_PROFILE=quick $(BIN)/python -m pytest -p no:pytest-qt -p no:benchmark \
	  -m "not slow and not torch and not qt" $(QUICK_TESTS)

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: setup
	$(BIN)/python -m kirigami_studio benchmark lattice

# MeerK40t pins what it likes, so it lives apart; the tests find it here.
CONSUMERS := .venv-consumers
consumers: setup
	test -x $(CONSUMERS)/bin/python || $(PYTHON) -m venv $(CONSUMERS)
	$(CONSUMERS)/bin/python -m pip install -q meerk40t ezdxf Pillow
	$(BIN)/python -m pytest tests/consumers

demo: setup
	$(BIN)/kirigami-studio design heart --k 8 --out out/heart

states: setup
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.demonstrations.state_sheet --out out/states
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.demonstrations.state_sheet --out out/states-200 --scale 2

pictures: setup
	QT_QPA_PLATFORM=offscreen $(BIN)/python -m kirigami_studio.demonstrations.offscreen_session --out out/pictures
	cp out/pictures/4-designs.png docs/pictures/window.png
	$(BIN)/kirigami-studio animate resources/examples/heart.kiri --out docs/pictures/heart.gif

# What translators start from: every sentence of the program, without places, so that it changes with the words alone.
messages: setup
	$(BIN)/pybabel -q extract -k tr -k mark -k tr_n:1,2 --no-default-keywords --no-location --sort-output --omit-header \
	  -o resources/locale/kirigami_studio.pot kirigami_studio

clean:
	rm -rf out build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache .benchmarks
	find kirigami_studio tests packaging -name __pycache__ -prune -exec rm -rf {} +
