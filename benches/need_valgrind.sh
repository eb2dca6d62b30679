#!/usr/bin/env bash
# Valgrind: there, or installed where that takes no questions, or a word on what to do.
set -euo pipefail

command -v valgrind > /dev/null && exit 0
as_root=()
[[ $EUID -eq 0 ]] || as_root=(sudo --non-interactive)
if command -v apt-get > /dev/null && "${as_root[@]}" true 2> /dev/null; then
  echo "Installing valgrind with apt-get"
  "${as_root[@]}" apt-get update --quiet --quiet
  "${as_root[@]}" apt-get install --quiet --quiet --yes --no-install-recommends valgrind > /dev/null
  command -v valgrind > /dev/null && exit 0
fi
echo "Valgrind was not found. On Debian and Ubuntu: apt-get install valgrind" >&2
exit 1
