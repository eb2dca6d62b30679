# Two front doors: `make compare` and `make test`. Both need a Rust toolchain, Python >= 3.11 and make, and set
# up the rest themselves in .venv. `make help` lists the others.

PYTHON ?= python3
# Other interpreters that `make test-wheel` tries the wheel on, such as "python3.12 python3.13".
PYTHONS ?=
# `make audit AUDIT=--strict`: what cannot be checked here fails.
AUDIT ?=
# Parallel pytest workers, and options passed on to pytest or to the comparison.
JOBS ?= 2
PYTEST_ARGS ?=
COMPARE_ARGS ?=
THROUGHPUT_ARGS ?=
SOAK_ARGS ?=
# `make publish-check PUBLISH_ARGS=--allow-dirty`: with changes that are not committed.
PUBLISH_ARGS ?=
# Which of those that `make help` names `make test-other` and `make bench` run.
OTHER ?= benchmarl
BENCH ?= throughput
# `make instructions INSTRUCTIONS=--strict`: fails where there is no valgrind.
INSTRUCTIONS ?=
# The page of docs/extend that `make extend` follows, if not all.
PAGE ?=
# Of each kind of hostile input in `make fuzz`.
FUZZ_EXAMPLES ?= 2000
# `make speed-vs-error SPEED_ARGS=--trial`: everything, but too short to mean anything, outside docs.
SPEED_ARGS ?=
PAPER_ARGS ?=

VENV := .venv
BIN := $(VENV)/bin
STAMPS := $(VENV)/.stamps
# Compiled once here, where Python itself may not be allowed to: imports take half the time.
UV := VIRTUAL_ENV="$(CURDIR)/$(VENV)" UV_COMPILE_BYTECODE=1 $(BIN)/uv
# Directories are listed too: their times change when a file is removed.
RUST_SOURCES := Cargo.toml Cargo.lock $(shell find src)
STUBS := flockenv/_core.pyi
# This machine's own build may use AVX2, which alters no bit. Wheels run on every processor.
CODEGEN := $(if $(findstring avx2,$(shell rustc --print cfg -C target-cpu=native 2> /dev/null)),-- -C target-feature=+avx2)
# One stamp a kind: where a checkout is moved to a machine without AVX2, the core is compiled again.
CORE := $(STAMPS)/core$(if $(CODEGEN),-avx2)
JS_TESTS := tests/replay/js

# The comparison with other engines: a crate and a Python environment of their own.
PEERS := benches/peers/.venv
SPEED_BIN := benches/target/release
SPEED := $(SPEED_BIN)/speed_vs_error
SPEED_FILES := benches/target/peer_files
SPEED_DOCS := $(if $(SPEED_ARGS),benches/target/trial,docs)

# Which extras each front door needs, out of pyproject.toml.
COMPARE_EXTRAS := --extra plot
OLDEST_EXTRAS := --extra plot --extra render --extra video --extra sweep
AUDIT_EXTRAS := --extra train --extra plot --extra search --extra render --extra ray --extra sweep --extra tracks
TEST_EXTRAS := --extra train --extra plot --extra search --extra render --extra sweep --extra tracks --extra test --extra dev

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
# Only where a recipe says so: compilers leave a core idle for a minute each.
ifndef PARALLEL
.NOTPARALLEL:
else
# Cargo would look for job slots in make's flags, which are not handed on to it.
export CARGO_MAKEFLAGS :=
endif
.PHONY: help test-pages test-other bench setup build compare live test lint format test-rust test-python coverage test-js test-browser test-live test-wheel test-oldest \
        test-benchmarl test-rllib test-ray test-slurm validate docs wheel audit licenses tables replay-animation publish-check release-check \
        extend instructions throughput env-benchmarl env-rllib soak fuzz speed-vs-error \
        lint-benches paper clean

help: ## list the commands
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-19s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

compare: build ## set up, then print and plot the paper's leader-count curve
	$(BIN)/flockenv compare $(COMPARE_ARGS)

test: $(STAMPS)/venv ## set up, then check style and types and run all tests
	$(MAKE) --no-print-directory PARALLEL=yes --jobs 2 lint test-rust
	$(MAKE) --no-print-directory test-python

setup: $(STAMPS)/test

build: $(CORE) ## build the simulator and install the package, editable, into .venv

lint: $(STAMPS)/test $(CORE) ## formatting, clippy, Rust module cycles, ruff, import layers, mypy, stubs, spelling
	cargo fmt --check
	$(BIN)/ruff format --check
	PYO3_PYTHON="$(CURDIR)/$(BIN)/python" cargo clippy --locked --all-targets --features python -- -D warnings
	$(BIN)/python tests/modules/cycles.py src
	$(BIN)/ruff check
	$(BIN)/lint-imports --no-logo --no-cache
	$(BIN)/mypy
	$(if $(wildcard $(STUBS)),$(BIN)/stubtest flockenv._core --mypy-config-file tests/modules/stubtest.ini --allowlist tests/modules/stubtest_allowlist.txt)
	git ls-files -z | xargs -0 $(BIN)/codespell

format: $(STAMPS)/test ## format the Rust and Python sources
	cargo fmt
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

test-rust: ## the physics alone, no Python
	cargo test --locked --features clarabel,draw

# One thread for each worker's linear algebra, or the workers fight over the cores. Tests of one file share what
# it prepares. A worker that dies is not replaced: pytest-xdist would wait forever for what the dead one had left.
test-python: $(STAMPS)/test $(CORE) ## the Python package
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) --dist loadfile --max-worker-restart 0 $(PYTEST_ARGS)

# Where rustup cannot fetch LLVM's tools, or there is none, LLVM_COV and LLVM_PROFDATA name those of another install.
# Which lines the tests run, of the package and of the physics.
coverage: $(STAMPS)/coverage $(CORE)
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) --dist loadfile --cov=flockenv --cov-report=term:skip-covered $(PYTEST_ARGS)
	cargo llvm-cov --locked

fuzz: $(STAMPS)/test $(CORE) ## hostile parameters, options, states, files and command lines, for minutes
	OMP_NUM_THREADS=1 FUZZ_EXAMPLES=$(FUZZ_EXAMPLES) $(BIN)/python -m pytest -n $(JOBS) --timeout 1800 tests/fuzz $(PYTEST_ARGS)

test-pages: test-js test-browser test-live ## the replay page and the live page: scripts in Node, clicks in headless Chromium

# The replay page, clicked and read in headless Chromium.
test-browser: $(STAMPS)/browser $(CORE)
	@tests/browser/need_chromium.sh
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m browser tests/browser $(PYTEST_ARGS)

# The live page: its bits against the native ones, and every control in headless Chromium.
test-live: live $(STAMPS)/browser
	@tests/browser/need_chromium.sh
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m live tests/web tests/browser $(PYTEST_ARGS)

# The pages' scripts: style, and unit tests, with Node.
test-js: $(JS_TESTS)/node_modules
	cd $(JS_TESTS) && npm run lint && npm test

# The crate itself needs nothing of this; without rustup, another toolchain's cargo and target will do.
live: $(CORE) ## the live page: the simulator compiled to WebAssembly, in one file, web/live.html
	@rustup target add wasm32-unknown-unknown || rustc --print target-libdir --target wasm32-unknown-unknown
	$(BIN)/python web/build.py

# The wheel and the source distribution, into dist.
wheel: $(STAMPS)/venv
	rm -rf dist
	$(BIN)/maturin build --release --locked --out dist
	$(BIN)/maturin sdist --out dist

test-wheel: $(STAMPS)/test wheel ## wheel, source distribution and `pip install .`, each in an empty environment
	PYTHONS="$(PYTHONS)" $(BIN)/python -m pytest -m wheel tests/package $(PYTEST_ARGS)

# The bounds of pyproject.toml, each at its lowest; all else is the newest, which old ones may use in ways
# that it deprecates.
test-oldest: $(STAMPS)/venv ## the oldest supported versions, in .venv-oldest
	$(PYTHON) -m venv --clear .venv-oldest
	VIRTUAL_ENV="$(CURDIR)/.venv-oldest" $(BIN)/uv pip install -r pyproject.toml $(OLDEST_EXTRAS) \
	  --resolution lowest-direct
	VIRTUAL_ENV="$(CURDIR)/.venv-oldest" $(BIN)/uv pip install hypothesis pytest pytest-timeout
	VIRTUAL_ENV="$(CURDIR)/.venv-oldest" PATH="$(CURDIR)/$(BIN):$$PATH" maturin develop --release --locked --uv $(CODEGEN)
	OMP_NUM_THREADS=1 .venv-oldest/bin/python -m pytest -W ignore::DeprecationWarning \
	  tests/boundary tests/envs tests/policies tests/rendering tests/runs tests/statistics \
	  tests/comparison tests/cli $(PYTEST_ARGS)

# Pages with code cells are executed, and what they trained is trained again.
docs: $(STAMPS)/docs $(CORE) ## build the pages, warnings are errors, into docs/_build/html, and those of the crate
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps
	rm -rf docs/_build/leader
	OMP_NUM_THREADS=1 $(BIN)/python -m sphinx --fail-on-warning --nitpicky --builder html docs docs/_build/html

# Advisories come from elsewhere than the packages: where that is out of reach, it is said.
audit: $(STAMPS)/audit ## licenses, sources and known vulnerabilities of what this depends on
	cargo deny --locked --all-features check licenses bans sources
	if cargo deny --locked fetch db; then cargo deny --locked --all-features check advisories; \
	  else echo "NOT CHECKED: advisories on crates, their database is out of reach"; test -z "$(AUDIT)"; fi
	$(UV) pip compile --quiet --universal pyproject.toml $(AUDIT_EXTRAS) --output-file $(STAMPS)/requirements.txt
	$(BIN)/pip-audit $(AUDIT) --disable-pip --no-deps --requirement $(STAMPS)/requirements.txt > $(STAMPS)/audit.txt 2>&1; \
	  found=$$?; cat $(STAMPS)/audit.txt; \
	  if grep -q "could not be audited" $(STAMPS)/audit.txt; then echo "NOT CHECKED: advisories on the Python packages above"; fi; \
	  exit $$found

# Collect the notices of the crates that are compiled in, into LICENSES.
licenses:
	cargo about --version || cargo install --locked cargo-about --features cli
	cargo about generate --locked --all-features --config .cargo/about.toml .cargo/about.hbs --output-file LICENSES/crates.txt

# Nothing is uploaded. Before the first release there is no tag to compare with.
# The crate as it would be published: its files, built alone; and its API against the last release.
publish-check:
	cargo clippy --locked --all-targets -- -D warnings
	cargo test --locked
	cargo publish --dry-run --locked $(PUBLISH_ARGS)
	@base="$${SEMVER_BASELINE:-$$(git describe --tags --abbrev=0 --match 'v*' 2> /dev/null)}"; \
	if [ -z "$$base" ]; then echo "NOT RUN: cargo semver-checks, for want of a release; SEMVER_BASELINE=COMMIT names another."; else \
	  { cargo semver-checks --version || cargo install --locked cargo-semver-checks; } && \
	  cargo semver-checks --baseline-rev "$$base"; fi

# The pages of docs/extend as the patches that they are; `make extend PAGE=policy` follows one.
extend: $(STAMPS)/venv
	$(BIN)/python docs/extend/follow.py $(PAGE)

release-check: audit publish-check docs test-oldest test-wheel extend ## all of a release that can run here, and what is left for the owner
	@echo "Left for the owner of the accounts:"
	@echo "1. Name this repository and publish.yml as trusted publisher, with the environments pypi and crates-io."
	@echo "2. Turn on the static host for the documentation and the live page."
	@echo "3. Date the section of CHANGELOG.md, and push the tag v$$(cargo metadata --no-deps --format-version 1 | $(PYTHON) -c 'import json, sys; print(json.load(sys.stdin)["packages"][0]["version"])')."

validate: $(STAMPS)/test $(CORE) ## the slow tests and the published curves
	cargo test --locked --features clarabel,draw -- --ignored
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) -m slow --timeout 3600 $(PYTEST_ARGS)

# Goes on where it ended; `make paper PAPER_ARGS="fig14 --workers 1"` makes one figure.
paper: $(STAMPS)/compare $(CORE) ## make every figure and question of paper/ that has runs missing, or draw it again
	OMP_NUM_THREADS=1 $(BIN)/python paper/make.py $(PAPER_ARGS)

tables: $(STAMPS)/compare $(CORE) ## fill the tables and draw the curves of README and docs from the committed data
	$(BIN)/python docs/tables.py
	$(BIN)/python docs/leader_curves.py

# Photograph the replay page into docs/replay.webp.
replay-animation: $(STAMPS)/browser $(CORE)
	@tests/browser/need_chromium.sh
	$(BIN)/python docs/replay_animation.py

# RLlib pins an older gymnasium, BenchMARL an older TorchRL, and the peers other things: environments of their own.
env-rllib: $(STAMPS)/test
	$(PYTHON) -m venv .venv-rllib
	VIRTUAL_ENV="$(CURDIR)/.venv-rllib" $(BIN)/uv pip install -r pyproject.toml --extra ray hypothesis pytest \
	  pytest-timeout "torch>=2.5" --excludes requirements-excluded.txt
	VIRTUAL_ENV="$(CURDIR)/.venv-rllib" PATH="$(CURDIR)/$(BIN):$$PATH" maturin develop --release --locked --uv $(CODEGEN)

env-benchmarl: $(STAMPS)/test
	$(PYTHON) -m venv .venv-benchmarl
	VIRTUAL_ENV="$(CURDIR)/.venv-benchmarl" $(BIN)/uv pip install -r pyproject.toml --extra benchmarl hypothesis \
	  pytest pytest-timeout --excludes requirements-excluded.txt
	VIRTUAL_ENV="$(CURDIR)/.venv-benchmarl" PATH="$(CURDIR)/$(BIN):$$PATH" maturin develop --release --locked --uv $(CODEGEN)

test-other: test-$(OTHER) ## OTHER=rllib, benchmarl, ray or slurm: what needs an environment of its own

# RLlib on the vector environment and on the parallel one, in .venv-rllib.
test-rllib: env-rllib
	OMP_NUM_THREADS=1 .venv-rllib/bin/python -m pytest -m rllib tests/rllib $(PYTEST_ARGS)

# The tasks of BenchMARL and its learners, in .venv-benchmarl.
test-benchmarl: env-benchmarl
	OMP_NUM_THREADS=1 .venv-benchmarl/bin/python -m pytest -m "benchmarl or not benchmarl" tests/benchmarl \
	  tests/torchrl tests/baselines/test_train_with_benchmarl.py $(PYTEST_ARGS)

# Ray core without RLlib pins nothing, but what it starts outlives a test that fails: kept apart.
# The ray engine on a real local Ray, in .venv-ray.
test-ray: $(STAMPS)/test
	$(PYTHON) -m venv .venv-ray
	VIRTUAL_ENV="$(CURDIR)/.venv-ray" $(BIN)/uv pip install -r pyproject.toml --extra plot --extra sweep "ray>=2.40" \
	  hypothesis pytest pytest-timeout
	VIRTUAL_ENV="$(CURDIR)/.venv-ray" PATH="$(CURDIR)/$(BIN):$$PATH" maturin develop --release --locked --uv $(CODEGEN)
	.venv-ray/bin/python -m pytest -m ray tests/runs/test_executors.py tests/cluster

# The recipe for Slurm on a real one of one node, started here (Linux, root).
test-slurm: $(STAMPS)/test $(CORE)
	@tests/need.sh "munged slurmctld slurmd sbatch" "slurm-wlm munge"
	$(BIN)/python -m pytest -m slurm tests/cluster $(PYTEST_ARGS)

bench: $(BENCH) ## BENCH=throughput, soak, instructions or speed-vs-error (minutes; on a machine that does nothing else)

# Measure speed beside VMAS, MPE2 and the learners' interfaces.
throughput: $(STAMPS)/test $(CORE) env-rllib env-benchmarl
	$(PYTHON) -m venv .venv-peers
	VIRTUAL_ENV="$(CURDIR)/.venv-peers" $(BIN)/uv pip install vmas mpe2 "torch>=2.5" \
	  --excludes requirements-excluded.txt
	$(BIN)/python benches/throughput.py $(THROUGHPUT_ARGS)
	$(BIN)/python benches/learners.py $(THROUGHPUT_ARGS)

# Ten million control steps with random rudders (minutes).
soak: $(STAMPS)/test $(CORE)
	$(BIN)/python benches/soak.py $(SOAK_ARGS)

# Counts hold on a busy machine, unlike times. INSTRUCTIONS=--write writes new ones.
# Count instructions of substeps and control steps, compare with benches/instructions.csv.
instructions:
	@tests/need.sh valgrind valgrind || true
	cargo bench --locked --bench instructions -- $(INSTRUCTIONS)

# Timed parts run one after another, the rest on all cores. Measure on a machine that does nothing else.
# Measure speed and error against other engines, into docs (minutes).
speed-vs-error: $(STAMPS)/compare $(STAMPS)/peers
	cargo build --release --manifest-path benches/Cargo.toml
	rm -rf $(SPEED_DOCS)/speed_vs_error && mkdir -p $(SPEED_DOCS)/speed_vs_error
	$(SPEED) $(SPEED_ARGS) $(SPEED_DOCS)/speed_vs_error speed profile solvers parts
	$(SPEED_BIN)/growth $(SPEED_DOCS)/speed_vs_error $(SPEED_ARGS)
	$(SPEED) $(SPEED_ARGS) $(SPEED_DOCS)/speed_vs_error tasks $(SPEED_FILES)
	$(PEERS)/bin/python benches/peers/run.py $(SPEED_FILES) $(SPEED)
	$(SPEED) $(SPEED_ARGS) $(SPEED_DOCS)/speed_vs_error judge $(SPEED_FILES) \
		overlap slide wall_push momentum horizon order
	$(BIN)/python benches/report $(SPEED_DOCS)/speed_vs_error $(SPEED_FILES)

# Formatting and clippy of the comparison with other engines.
lint-benches:
	cargo fmt --check --manifest-path benches/Cargo.toml
	cargo clippy --release --all-targets --manifest-path benches/Cargo.toml -- -D warnings

clean: ## remove everything that was built or installed here
	cargo clean
	rm -rf benches/target $(PEERS) $(JS_TESTS)/node_modules
	rm -rf docs/_build
	rm -rf $(VENV) .venv-benchmarl .venv-rllib .venv-ray .venv-peers .venv-oldest flockenv/_core.*.so flockenv/_core.*.pyd dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
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

# One package of one version, which names its own parts exactly: there is nothing for a lock file to hold.
$(JS_TESTS)/node_modules: $(JS_TESTS)/package.json
	@node --version > /dev/null && npm --version > /dev/null || { echo "Node 20 or newer and npm are needed for the scripts' tests." >&2; exit 1; }
	cd $(JS_TESTS) && npm install --no-package-lock --no-audit --no-fund
	@touch $@

$(STAMPS)/docs: pyproject.toml $(STAMPS)/test
	$(UV) pip install -r pyproject.toml --extra docs
	@touch $@

$(STAMPS)/audit: pyproject.toml $(STAMPS)/test
	cargo deny --version || cargo install --locked cargo-deny
	$(UV) pip install --quiet pip-audit
	@touch $@

$(STAMPS)/coverage: pyproject.toml $(STAMPS)/test
	cargo llvm-cov --version || cargo install --locked cargo-llvm-cov
	$(UV) pip install --quiet pytest-cov
	@touch $@

$(STAMPS)/peers: benches/peers/requirements.txt | $(STAMPS)/venv
	$(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check -r benches/peers/requirements.txt
	@touch $@

# An install from elsewhere, such as `pip install .` in this .venv, takes the place of the editable one; and
# `git clean` removes what was compiled.
ifeq ($(and $(wildcard flockenv/_core.*.so flockenv/_core.*.pyd),$(shell grep -lxF "$(CURDIR)" $(VENV)/lib/python3*/site-packages/flockenv.pth 2> /dev/null)),)
.PHONY: $(CORE)
endif

$(CORE): $(RUST_SOURCES) pyproject.toml | $(STAMPS)/$(if $(PARALLEL),test,compare)
	VIRTUAL_ENV="$(CURDIR)/$(VENV)" PATH="$(CURDIR)/$(BIN):$$PATH" maturin develop --release --locked --uv $(CODEGEN)
	@touch $@
