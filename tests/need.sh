#!/usr/bin/env bash
# need.sh "PROGRAMS" "PACKAGES": programs that are there, or whose Debian packages are installed here where
# that takes no questions, or a word on what to do.
set -euo pipefail
read -ra programs <<< "$1"
read -ra packages <<< "$2"
PATH="$PATH:/usr/local/sbin:/usr/sbin"

are_there() {
  local program
  for program in "${programs[@]}"; do
    command -v "$program" > /dev/null || return 1
  done
}

are_there && exit 0
as_root=()
[[ $EUID -eq 0 ]] || as_root=(sudo --non-interactive)
if command -v apt-get > /dev/null && "${as_root[@]}" true 2> /dev/null; then
  echo "Installing ${packages[*]} with apt-get"
  "${as_root[@]}" apt-get update --quiet --quiet
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install --quiet --quiet --yes --no-install-recommends "${packages[@]}" > /dev/null
  are_there && exit 0
fi
echo "These programs are needed and were not all found: ${programs[*]}" >&2
echo "On Debian and Ubuntu: apt-get install ${packages[*]}" >&2
exit 1
