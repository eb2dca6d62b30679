#!/usr/bin/env bash
# Chromium and chromedriver of the same version; CHROMIUM and CHROMEDRIVER may name their programs.
exec "$(dirname "${BASH_SOURCE[0]}")/../need.sh" \
  "${CHROMIUM:-chromium} ${CHROMEDRIVER:-chromedriver}" "chromium chromium-driver fonts-dejavu-core"
