#!/usr/bin/env bash
# other.sh env-NAME, or other.sh test-NAME [PYTEST OPTIONS]: the environment .venv-NAME, and the tests in it.
# RLlib pins an older gymnasium and BenchMARL an older TorchRL. Ray alone pins nothing, but what it starts outlives a
# test that fails. "oldest" has the bounds of pyproject.toml, each at its lowest; all else is the newest, which old
# ones may use in ways that it deprecates.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
what=$1 name=${1#*-}
shift
export VIRTUAL_ENV="$PWD/.venv-$name" PATH="$PWD/.venv/bin:$PATH"

case $name in
  benchmarl)
    needs=(--extra benchmarl --extra train --extra plot sb3-contrib)
    tests=(-m "benchmarl or not benchmarl" tests/benchmarl tests/torchrl studies/suite/test_suite_grid.py)
    ;;
  rllib)
    needs=(--extra ray "torch>=2.5")
    tests=(-m rllib tests/rllib)
    ;;
  ray)
    needs=(--extra plot --extra sweep "ray>=2.40")
    tests=(-m ray tests/runs/test_executors.py tests/cluster)
    ;;
  oldest)
    needs=(--extra plot --extra render --extra video --extra sweep --resolution lowest-direct)
    tests=(-W "ignore::DeprecationWarning" tests/{boundary,envs,policies,rendering,runs,statistics,comparison,cli})
    ;;
  *)
    echo "There is no environment $name: benchmarl, rllib, ray or oldest." >&2
    exit 1
    ;;
esac

"${PYTHON:-python3}" -m venv "$VIRTUAL_ENV"
uv pip install -r pyproject.toml "${needs[@]}"
uv pip install hypothesis pytest pytest-timeout
# shellcheck disable=SC2086 # two words or none
maturin develop --locked --uv ${CODEGEN:-}
[[ $what == env-* ]] || OMP_NUM_THREADS=1 "$VIRTUAL_ENV/bin/python" -m pytest "${tests[@]}" "$@"
