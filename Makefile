# Two front doors: `make compare` and `make test`. Both need a Rust toolchain, Python >= 3.11 and make, and set
# up the rest themselves in .venv. `make help` lists the others.

PYTHON ?= python3
# Parallel pytest workers, and options passed on to pytest or to the comparison.
JOBS ?= 2
PYTEST_ARGS ?=
COMPARE_ARGS ?=
THROUGHPUT_ARGS ?=
SOAK_ARGS ?=
# `make speed-vs-error SPEED_ARGS=--trial`: everything, but too short to mean anything, outside docs.
SPEED_ARGS ?=

VENV := .venv
BIN := $(VENV)/bin
STAMPS := $(VENV)/.stamps
UV := VIRTUAL_ENV="$(CURDIR)/$(VENV)" $(BIN)/uv
# Directories are listed too: their times change when a file is removed.
RUST_SOURCES := Cargo.toml Cargo.lock $(shell find src)
STUBS := flockenv/_core.pyi

# The comparison with other engines: a crate and a Python environment of their own.
PEERS := benches/peers/.venv
SPEED_BIN := benches/target/release
SPEED := $(SPEED_BIN)/speed_vs_error
SPEED_FILES := benches/target/peer_files
SPEED_DOCS := $(if $(SPEED_ARGS),benches/target/trial,docs)

# Which extras each front door needs, out of pyproject.toml.
COMPARE_EXTRAS := --extra plot
TEST_EXTRAS := --extra train --extra plot --extra fit --extra render --extra sweep --extra test --extra dev

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.NOTPARALLEL:
.PHONY: help setup build compare test lint format test-rust test-python test-browser test-rllib test-ray \
        validate pages replay-animation \
        learning-check throughput soak fuzz speed-vs-error lint-benches clean

help: ## list the commands
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-18s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

compare: build ## set up, then print and plot the paper's leader-count curve
	$(BIN)/flockenv compare $(COMPARE_ARGS)

test: lint test-rust test-python ## set up, then check style and types and run all tests

setup: $(STAMPS)/test

build: $(STAMPS)/core ## build the simulator and install the package, editable, into .venv

lint: $(STAMPS)/test $(STAMPS)/core ## formatting, clippy, ruff, mypy, stubs
	cargo fmt --check
	$(BIN)/ruff format --check
	cargo clippy --locked --all-targets -- -D warnings
	PYO3_PYTHON="$(CURDIR)/$(BIN)/python" cargo clippy --locked --all-targets --features python -- -D warnings
	$(BIN)/ruff check
	$(BIN)/mypy
	$(if $(wildcard $(STUBS)),$(BIN)/stubtest flockenv._core --mypy-config-file pyproject.toml)

format: $(STAMPS)/test ## format the Rust and Python sources
	cargo fmt
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

test-rust: ## the physics alone, no Python
	cargo test --locked

# One thread for each worker's linear algebra, or the workers fight over the cores.
test-python: $(STAMPS)/test $(STAMPS)/core ## the Python package
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) $(PYTEST_ARGS)

fuzz: $(STAMPS)/test $(STAMPS)/core ## hostile parameters, options, states, files and command lines, for minutes
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) --hypothesis-profile thorough --timeout 1800 tests/fuzz $(PYTEST_ARGS)

test-browser: $(STAMPS)/browser $(STAMPS)/core ## the replay page, clicked and read in headless Chromium
	@tests/browser/need_chromium.sh
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m browser tests/browser $(PYTEST_ARGS)

validate: $(STAMPS)/test $(STAMPS)/core ## the slow tests and the published curves
	cargo test --locked -- --ignored
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) -m "slow or validation" --timeout 3600 $(PYTEST_ARGS)

pages: $(STAMPS)/test $(STAMPS)/core ## write docs/environments from the docstrings
	$(BIN)/python docs/environment_pages.py

replay-animation: $(STAMPS)/browser $(STAMPS)/core ## photograph the replay page into docs/replay.webp
	@tests/browser/need_chromium.sh
	$(BIN)/python docs/replay_animation.py

learning-check: $(STAMPS)/test $(STAMPS)/core ## train 500 000 samples through each face, write docs/learning-check.md
	$(BIN)/python baselines/learning_check.py

# RLlib pins an older gymnasium, and the peers pin other things: environments of their own.
test-rllib: $(STAMPS)/test ## RLlib on the parallel environment, in .venv-rllib
	$(PYTHON) -m venv .venv-rllib
	VIRTUAL_ENV="$(CURDIR)/.venv-rllib" $(BIN)/uv pip install -r pyproject.toml --extra ray pytest \
	  pytest-timeout "torch>=2.5" --excludes requirements-excluded.txt
	VIRTUAL_ENV="$(CURDIR)/.venv-rllib" PATH="$(CURDIR)/$(BIN):$$PATH" maturin develop --release --locked --uv
	OMP_NUM_THREADS=1 .venv-rllib/bin/python -m pytest -m rllib tests/env/test_rllib.py

# Ray core without RLlib pins nothing, but what it starts outlives a test that fails: kept apart.
test-ray: $(STAMPS)/test ## the ray engine on a real local Ray, in .venv-ray
	$(PYTHON) -m venv .venv-ray
	VIRTUAL_ENV="$(CURDIR)/.venv-ray" $(BIN)/uv pip install -r pyproject.toml --extra sweep "ray>=2.40" pytest pytest-timeout
	VIRTUAL_ENV="$(CURDIR)/.venv-ray" PATH="$(CURDIR)/$(BIN):$$PATH" maturin develop --release --locked --uv
	.venv-ray/bin/python -m pytest -m ray tests/analysis/test_engines.py

throughput: $(STAMPS)/test $(STAMPS)/core ## measure speed beside VMAS and MPE2, write docs/throughput.md
	$(PYTHON) -m venv .venv-peers
	VIRTUAL_ENV="$(CURDIR)/.venv-peers" $(BIN)/uv pip install vmas mpe2 "torch>=2.5" \
	  --excludes requirements-excluded.txt
	$(BIN)/python benches/throughput.py $(THROUGHPUT_ARGS)

soak: $(STAMPS)/test $(STAMPS)/core ## ten million control steps with random rudders, write docs/soak.md (minutes)
	$(BIN)/python benches/soak.py $(SOAK_ARGS)

# Timed parts run one after another, the rest on all cores. Measure on a machine that does nothing else.
speed-vs-error: $(STAMPS)/compare $(STAMPS)/peers ## measure speed and error against other engines, into docs (minutes)
	cargo build --release --manifest-path benches/Cargo.toml
	rm -rf $(SPEED_DOCS)/speed_vs_error && mkdir -p $(SPEED_DOCS)/speed_vs_error
	$(SPEED) $(SPEED_ARGS) $(SPEED_DOCS)/speed_vs_error speed profile solvers parts
	$(SPEED_BIN)/growth $(SPEED_DOCS)/speed_vs_error $(SPEED_ARGS)
	$(SPEED) $(SPEED_ARGS) $(SPEED_DOCS)/speed_vs_error tasks $(SPEED_FILES)
	$(PEERS)/bin/python benches/peers/run.py $(SPEED_FILES) $(SPEED)
	$(SPEED) $(SPEED_ARGS) $(SPEED_DOCS)/speed_vs_error judge $(SPEED_FILES) \
		overlap slide wall_push momentum horizon order
	$(BIN)/python benches/report $(SPEED_DOCS) $(SPEED_FILES) $(SPEED_ARGS)

lint-benches: ## formatting and clippy of the comparison with other engines
	cargo fmt --check --manifest-path benches/Cargo.toml
	cargo clippy --release --all-targets --manifest-path benches/Cargo.toml -- -D warnings

clean: ## remove everything that was built or installed here
	cargo clean
	rm -rf benches/target $(PEERS)
	rm -rf $(VENV) .venv-rllib .venv-ray .venv-peers flockenv/_core.*.so flockenv/_core.*.pyd dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -prune -exec rm -rf {} +

# --- setting up -----------------------------------------------------------------------------------------------

$(STAMPS)/venv:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed; name one with `make PYTHON=...`")'
	@cargo --version > /dev/null || { echo "A Rust toolchain is needed: cargo was not found." >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check uv
	$(UV) pip install --quiet "maturin>=1.16,<2"
	@mkdir -p $(@D) && touch $@

$(STAMPS)/compare: pyproject.toml | $(STAMPS)/venv
	$(UV) pip install -r pyproject.toml $(COMPARE_EXTRAS)
	@touch $@

# On Linux PyPI's torch links against CUDA even where it only ever uses the processor. The two of its
# dependencies that it runs without here (a GPU compiler and bindings to it, 1 GB) are left out.
$(STAMPS)/test: pyproject.toml requirements-excluded.txt | $(STAMPS)/venv
	$(UV) pip install -r pyproject.toml $(TEST_EXTRAS) --excludes requirements-excluded.txt
	@touch $@ $(STAMPS)/compare

$(STAMPS)/browser: pyproject.toml $(STAMPS)/test
	$(UV) pip install -r pyproject.toml --extra browser
	@touch $@

$(STAMPS)/peers: benches/peers/requirements.txt | $(STAMPS)/venv
	$(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check -r benches/peers/requirements.txt
	@touch $@

$(STAMPS)/core: $(RUST_SOURCES) pyproject.toml | $(STAMPS)/compare
	VIRTUAL_ENV="$(CURDIR)/$(VENV)" PATH="$(CURDIR)/$(BIN):$$PATH" maturin develop --release --locked --uv
	@touch $@
