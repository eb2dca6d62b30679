# Start with `make compare` or `make test`. Both need a Rust toolchain, Python >= 3.11 and make, and set up
# everything else in .venv. `make help` lists the other commands.

# Variables: the Python interpreter, the number of parallel pytest workers, and the number of examples of each kind of
# hostile input. Empty by default are PYTHONS, further interpreters for `make test-wheel`; PAGE, a single page for
# `make extend`; and PYTEST_ARGS, COMPARE_ARGS, STUDIES_ARGS, PRETRAINED_ARGS and INSTRUCTIONS, which are passed on.
PYTHON ?= python3
JOBS ?= 2
FUZZ_EXAMPLES ?= 2000

BIN := .venv/bin
STAMPS := .venv/.stamps
# The versions of `requirements.lock`, which `make lock` renews.
UV := VIRTUAL_ENV="$(CURDIR)/.venv" $(BIN)/uv pip install --constraint requirements.lock
# One thread for each worker's linear algebra, or the workers compete for the cores. Compiled Python modules are kept, even
# if the environment forbids it, since they halve the time of imports.
PYTEST := OMP_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE= PYTHONPYCACHEPREFIX="$(CURDIR)/.venv/pycache" $(BIN)/python -m pytest
RUST_SOURCES := Cargo.toml Cargo.lock $(shell find src)
# A build for this machine may use AVX2, which does not change results by a bit.
CODEGEN := $(if $(findstring avx2,$(shell rustc --print cfg -C target-cpu=native 2> /dev/null)),-- -C target-feature=+avx2)
# One stamp with and one without AVX2: a checkout that moves to a machine without it compiles the core again.
CORE := $(STAMPS)/core$(if $(CODEGEN),-avx2)
JS_TESTS := tests/replay/js

# What each command installs from pyproject.toml: extras of users and groups of developers.
NEEDS_compare := --extra plot
NEEDS_test := --extra train --extra plot --extra render --extra sweep --extra tracks --group test --group dev
NEEDS_browser := --group browser
NEEDS_docs := --group docs
# What the studies install from studies/pyproject.toml.
NEEDS_studies := --extra plots --extra search --extra train --extra data --extra test

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
# Recipes run in parallel only if one sets PARALLEL: a compiler leaves a core idle for about a minute.
ifndef PARALLEL
.NOTPARALLEL:
else
# Otherwise cargo would look for job slots in make's flags, which it does not get.
export CARGO_MAKEFLAGS :=
endif
.PHONY: $(shell sed -n 's/^\([a-z][a-z -]*\):.*/\1/p' Makefile)

help: ## list the commands
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-19s %s\n", $$1, $$2 }' Makefile

compare: $(STAMPS)/venv ## set up, then print and plot the paper's leader-count curve
	$(MAKE) --no-print-directory PARALLEL=yes --jobs 2 $(STAMPS)/compare $(CORE)
	$(BIN)/flockenv compare $(COMPARE_ARGS)

test: $(STAMPS)/venv ## set up, then check style and types and run all tests
	$(MAKE) --no-print-directory PARALLEL=yes --jobs 2 lint test-rust
	$(MAKE) --no-print-directory test-python

setup: $(STAMPS)/test
# TORCH=cpu takes torch's build for processors from PyTorch's own index: without libraries for GPUs.
setup-train: build ## install what trainings and their plots need beside the core, without compiling it again
	$(UV) $(if $(TORCH),--torch-backend $(TORCH)) -r pyproject.toml --extra train --extra plot

# One set of versions for all platforms and interpreters, without addresses, so that it fits any registry.
lock: $(STAMPS)/venv ## choose the newest versions of what is installed here
	$(BIN)/uv pip compile --quiet --upgrade --universal --python-version 3.11 --no-annotate --custom-compile-command "make lock" \
		$(NEEDS_compare) $(NEEDS_test) $(NEEDS_browser) $(NEEDS_docs) $(NEEDS_studies) pyproject.toml studies/pyproject.toml \
		--output-file requirements.lock
build: $(STAMPS)/compare $(CORE) ## build the simulator and install the package, editable, into .venv

lint: lint-sources $(CORE) ## formatting, ruff, Rust module cycles, import layers, mypy, stubs, spelling, clippy
	$(BIN)/stubtest flockenv._core --mypy-config-file tests/modules/stubtest.ini --allowlist tests/modules/stubtest_allowlist.txt
# Last: cargo lets it wait for the compiler of `test-rust` beside it.
	PYO3_PYTHON="$(CURDIR)/$(BIN)/python" cargo clippy --locked --all-targets --features python -- -D warnings

# What needs no core, and runs while that is compiled.
lint-sources: $(STAMPS)/test
	cargo fmt --check && cargo fmt --check --manifest-path web/Cargo.toml
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/python tests/modules/cycles.py src
	$(BIN)/lint-imports --no-logo --no-cache
	$(BIN)/mypy
	git ls-files -z | xargs -0 $(BIN)/codespell

format: $(STAMPS)/test ## format the Rust and Python sources
	cargo fmt && cargo fmt --manifest-path web/Cargo.toml
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

# Beside the core, after it: the tests wait for its dependencies anyway, and share them.
test-rust: $(if $(PARALLEL),| $(CORE)) ## the physics alone, no Python
	cargo test --locked --features clarabel,draw

# Tests of one file run in one worker and share its fixtures. A worker that dies is not replaced, since pytest-xdist would
# wait forever for its tests.
test-python: $(STAMPS)/test $(CORE) ## the Python package
	$(PYTEST) -n $(JOBS) --dist loadfile --max-worker-restart 0 $(PYTEST_ARGS)

# Which lines the tests run. Without rustup, LLVM_COV and LLVM_PROFDATA name LLVM's tools of another install.
coverage: $(STAMPS)/test $(CORE)
	$(UV) --quiet pytest-cov
	$(PYTEST) -n $(JOBS) --dist loadfile --cov=flockenv --cov-report=term:skip-covered $(PYTEST_ARGS)
	cargo llvm-cov --version || cargo install --locked cargo-llvm-cov
	cargo llvm-cov --locked

fuzz: $(STAMPS)/test $(CORE) ## hostile parameters, options, states, files and command lines, for minutes
	FUZZ_EXAMPLES=$(FUZZ_EXAMPLES) $(PYTEST) -n $(JOBS) --timeout 1800 tests/fuzz $(PYTEST_ARGS)

validate: $(STAMPS)/test $(CORE) ## the slow tests and the published curves
	cargo test --locked --features clarabel,draw -- --ignored
	$(PYTEST) -n $(JOBS) -m slow --timeout 3600 $(PYTEST_ARGS)

test-browser: $(STAMPS)/test $(STAMPS)/browser $(CORE)
	@tests/browser/need_chromium.sh
	$(PYTEST) -m browser tests/browser $(PYTEST_ARGS)

test-live: live $(STAMPS)/test $(STAMPS)/browser $(CORE)
	@tests/need.sh firefox-esr firefox-esr && tests/browser/need_chromium.sh
	$(PYTEST) -m live tests/web tests/browser $(PYTEST_ARGS)

test-js: $(JS_TESTS)/node_modules
	cd $(JS_TESTS) && npm run lint && npm test

live: ## the live page: the simulator compiled to WebAssembly, in one file that the package takes along
	@rustup target add wasm32-unknown-unknown || rustc --print target-libdir --target wasm32-unknown-unknown
	$(PYTHON) web/build.py

# Wheel and source distribution, into dist. `make live` before it adds the live page. For AVX2 the core is in it twice.
wheel: $(STAMPS)/venv
	rm -rf dist
	$(BIN)/maturin build --release --locked --out dist
	$(if $(findstring target_arch="x86_64",$(shell rustc --print cfg)),$(BIN)/maturin build --release --locked --out dist/avx2 \
		-- -C target-feature=+avx2 && $(BIN)/python .github/add_avx2.py)
	$(BIN)/maturin sdist --out dist

test-wheel: $(STAMPS)/test wheel ## wheel, source distribution and `pip install .`, each in an empty environment
	PYTHONS="$(PYTHONS)" $(BIN)/python -m pytest -m wheel tests/package $(PYTEST_ARGS)

# What needs an environment of its own, .venv-NAME.
env-benchmarl env-rllib test-benchmarl test-rllib test-ray test-oldest: $(STAMPS)/venv
	PYTHON="$(PYTHON)" CODEGEN="$(CODEGEN)" tests/other.sh $@ $(PYTEST_ARGS)

test-slurm: $(STAMPS)/test $(CORE)
	@tests/need.sh "munged slurmctld slurmd sbatch" "slurm-wlm munge"
	$(PYTEST) -m slurm tests/cluster $(PYTEST_ARGS)

# Pages with code cells are executed, and what they trained is trained again.
docs: $(STAMPS)/test $(STAMPS)/docs $(CORE) ## build the pages, warnings are errors, into docs/_build/html, and those of the crate
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps
	rm -rf docs/_build/leader
	OMP_NUM_THREADS=1 $(BIN)/python -m sphinx --fail-on-warning --nitpicky --builder html docs docs/_build/html

extend: $(STAMPS)/venv ## follow the pages of docs/extend, or PAGE=policy alone, in a copy of the tree
	$(BIN)/python docs/extend/follow.py $(PAGE)

test-processors: ## the tests of the same bits on aarch64, riscv64 and i686, emulated
	tests/processors.sh

studies: build $(STAMPS)/studies ## make the runs of studies/ that are missing, judge and draw them, list other scripts; STUDIES_ARGS=worth makes one
	OMP_NUM_THREADS=1 $(BIN)/python -m studies.make $(STUDIES_ARGS)

studies-trial: build $(STAMPS)/studies ## run every study in its shortest form, and judge the committed results (minutes)
	$(PYTEST) -c studies/pyproject.toml -n $(JOBS) --max-worker-restart 0 studies $(PYTEST_ARGS)

check-entries: build $(STAMPS)/studies ## score every entry of suite v3 again, and refuse a row that differs by a digit (thousands of flock-hours)
	OMP_NUM_THREADS=1 $(BIN)/python -m studies.levels.score_levels --check

train-levels: build $(STAMPS)/studies env-benchmarl ## train and enter what suite v3 lacks, 1.6 hours of a core for everything
	studies/levels/train.sh $(BIN) .venv-benchmarl/bin

pretrained: $(STAMPS)/test $(CORE) ## search leaders in both pools again (an hour and a half; PRETRAINED_ARGS=--trial shortly)
	OMP_NUM_THREADS=1 $(BIN)/python baselines/pretrained.py $(PRETRAINED_ARGS)

floors pictures environment-pages: build ## print the floors of ARCHITECTURE.md; draw pages' plots whose data changed; print the environments' pages
	$(BIN)/python -m docs.scripts.$(subst -,_,$@)
	$(if $(filter pictures,$@),$(BIN)/python -m docs.scripts.dark)

audit: $(STAMPS)/test ## licenses, sources and known vulnerabilities of what this depends on
	$(UV) --quiet pip-audit
	.github/release.sh audit $(NEEDS_test)

# The notices of the crates that are compiled in; the crate as it would be published, its API against the last release.
licenses publish-check:
	.github/release.sh $@
# One declaration of repository and site, in .github/addresses.toml.
addresses check-addresses: $(STAMPS)/venv
	$(BIN)/python .github/addresses.py $(if $(filter check-%,$@),--check)

release-check: check-addresses audit publish-check test-processors docs test-oldest test-wheel extend studies-trial check-entries ## all of a release that can run here, and what is left for the owner
	.github/release.sh owner

throughput soak speed-vs-error lint-benches: build $(STAMPS)/test ## measure, and compare with other engines (minutes; benches/Makefile)
	$(MAKE) -f benches/Makefile $@

# Counts hold on a busy machine, unlike times. INSTRUCTIONS=--write writes new ones; --strict fails without valgrind.
instructions:
	@tests/need.sh valgrind valgrind || true
	cargo bench --locked --bench instructions -- $(INSTRUCTIONS)

clean: ## remove everything that was built or installed here
	cargo clean
	rm -rf benches/target benches/peers/.venv $(JS_TESTS)/node_modules docs/_build docs/studies dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	rm -rf .venv .venv-* flockenv/_core.*.so flockenv/_core.*.pyd
	find . -name __pycache__ -prune -exec rm -rf {} +

# --- setting up -----------------------------------------------------------------------------------------------

$(STAMPS)/venv:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed; name one with `make PYTHON=...`")'
	@cargo --version > /dev/null || { echo "A Rust toolchain is needed: cargo was not found." >&2; exit 1; }
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check uv
	$(UV) --quiet "maturin>=1.16,<2"
	@mkdir -p $(@D) && touch $@

$(STAMPS)/compare $(STAMPS)/test $(STAMPS)/browser $(STAMPS)/docs: pyproject.toml requirements.lock | $(STAMPS)/venv
	$(UV) -r pyproject.toml $(NEEDS_$(@F))
	@touch $@ $(if $(filter test,$(@F)),$(STAMPS)/compare)

$(STAMPS)/studies: studies/pyproject.toml requirements.lock | $(STAMPS)/venv
	$(UV) -r $< $(NEEDS_studies)
	@touch $@

$(JS_TESTS)/node_modules: $(JS_TESTS)/package.json
	@node --version > /dev/null && npm --version > /dev/null || { echo "Node 20 or newer and npm are needed for the scripts' tests." >&2; exit 1; }
	cd $(JS_TESTS) && npm install --no-package-lock --no-audit --no-fund
	@touch $@

# The core is compiled again if another install, such as `pip install .` in this .venv, has replaced the editable one, or if
# `git clean` has removed the compiled module.
ifeq ($(and $(wildcard flockenv/_core.*.so flockenv/_core.*.pyd),$(shell grep -lxF "$(CURDIR)" .venv/lib/python3*/site-packages/flockenv.pth 2> /dev/null)),)
.PHONY: $(CORE)
endif

# The profile of a checkout shares its dependencies with the Rust tests, and gives the same bits. Wheels, pinned counts and
# the comparison with engines are compiled as a release.
$(CORE): $(RUST_SOURCES) pyproject.toml | $(STAMPS)/venv
	VIRTUAL_ENV="$(CURDIR)/.venv" PATH="$(CURDIR)/$(BIN):$$PATH" maturin develop --locked --uv $(CODEGEN)
	@touch $@
