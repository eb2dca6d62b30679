#!/usr/bin/env bash
# release.sh audit EXTRAS... | licenses | publish-check | owner: what `make release-check` is made of.
# AUDIT=--strict: what cannot be checked here fails. PUBLISH_ARGS=--allow-dirty: with changes that are not committed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
what=$1
shift

# A cargo command, installed first if it is missing.
tool() {
  cargo "$1" --version || cargo install --locked "cargo-$1" ${2:+--features "$2"}
}

audit() {
  local found=0 requirements=target/requirements.txt
  tool deny
  cargo deny --locked --all-features check licenses bans sources
  # Advisories come from elsewhere than the packages: if that is out of reach, it is said.
  if cargo deny --locked fetch db; then
    cargo deny --locked --all-features check advisories
  else
    echo "NOT CHECKED: advisories on crates, their database is out of reach"
    test -z "${AUDIT:-}"
  fi
  # What a user installs, with what is left out of .venv.
  .venv/bin/uv pip compile --no-config --quiet --universal pyproject.toml "$@" --output-file "$requirements"
  # shellcheck disable=SC2086 # one word or none
  .venv/bin/pip-audit ${AUDIT:-} --disable-pip --no-deps --requirement "$requirements" 2>&1 \
    | tee target/audit.txt || found=$?
  if grep -q "could not be audited" target/audit.txt; then
    echo "NOT CHECKED: advisories on the Python packages above"
  fi
  return "$found"
}

licenses() {
  tool about cli
  cargo about generate --locked --all-features --config .cargo/about.toml .cargo/about.hbs \
    --output-file LICENSES/crates.txt
}

# The crate's files, built alone; and its API against the last release. Nothing is uploaded.
publish-check() {
  cargo clippy --locked --all-targets -- -D warnings
  cargo test --locked
  # shellcheck disable=SC2086 # some words or none
  cargo publish --dry-run --locked ${PUBLISH_ARGS:-}
  # Before the first release there is no tag to compare with.
  local base="${SEMVER_BASELINE:-$(git describe --tags --abbrev=0 --match 'v*' 2> /dev/null || true)}"
  if [[ -z $base ]]; then
    echo "NOT RUN: cargo semver-checks, for want of a release; SEMVER_BASELINE=COMMIT names another."
  else
    tool semver-checks
    cargo semver-checks --baseline-rev "$base"
  fi
}

owner() {
  local version
  version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
  echo "Left for the owner of the accounts:"
  echo "1. Name this repository and publish.yml as trusted publisher, with the environments pypi and crates-io."
  echo "2. Turn on the static host for the documentation and the live page."
  echo "3. Date the section of CHANGELOG.md, and push the tag v$version."
}

"$what" "$@"
