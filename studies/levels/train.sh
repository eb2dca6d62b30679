#!/usr/bin/env bash
# Trains and enters the algorithms of suite v3, by the seeds of `train_levels.py` that are not there yet.
# train.sh BIN BENCHMARL: the folders of the interpreters with the studies' packages and with BenchMARL.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
export OMP_NUM_THREADS=1

train() { # BIN ALGORITHM...
  local command=("$1/python" -m studies.levels.train_levels --algorithms "${@:2}")
  "${command[@]}" --levels order-easy
  "${command[@]}" --levels order-noisy order-narrow order-wide --seeds {0..5}
  "${command[@]}" --levels order-noisy --seeds 6
}

train "$1" trpo ppo a2c sac evolution branches
"$1/python" -m studies.levels.train_levels --algorithms evolution branches --flock-hours 100
train "$2" ippo mappo
