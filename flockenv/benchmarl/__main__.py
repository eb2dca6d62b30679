"""The command of BenchMARL with the tasks here: ``python -m flockenv.benchmarl task=...``."""

import sys

from benchmarl.run import hydra_experiment

from flockenv.benchmarl import CONF

if __name__ == "__main__":
    sys.argv.append(f"hydra.searchpath=[file://{CONF}]")
    hydra_experiment()
