#!/usr/bin/env bash
# Chromium and its driver: there, or installed where that takes no questions, or a word on what to do.
set -euo pipefail

packages=(chromium chromium-driver fonts-dejavu-core)

is_there() {
  command -v "${CHROMIUM:-chromium}" > /dev/null && command -v "${CHROMEDRIVER:-chromedriver}" > /dev/null
}

is_there && exit 0
if [[ $EUID -eq 0 ]] && command -v apt-get > /dev/null; then
  echo "Installing ${packages[*]} with apt-get"
  apt-get update --quiet --quiet
  DEBIAN_FRONTEND=noninteractive apt-get install --quiet --quiet --yes --no-install-recommends "${packages[@]}" > /dev/null
  is_there && exit 0
fi
cat >&2 << TEXT
The browser tests need Chromium and chromedriver of the same version, which were not found.
On Debian and Ubuntu: apt-get install ${packages[*]}
Elsewhere install them your way; CHROMIUM and CHROMEDRIVER may name their programs.
TEXT
exit 1
