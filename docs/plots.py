"""Draw every plot of the pages whose data have changed: `make tables`."""

from committed_data import DOCS
from interval_plots import DATA, Plot
from leader_plots import PLOTS as LEADERS
from model_plots import PLOTS as MODEL
from PIL import Image
from speed_plots import PLOTS as SPEED
from suite_plots import PLOTS as SUITE
from track_plots import PLOTS as TRACKS
from training_plots import PLOTS as TRAINING

PLOTS: dict[str, Plot] = {**LEADERS, **SUITE, **MODEL, **SPEED, **TRACKS, **TRAINING}
"""How each is drawn, by its file below docs."""


def is_drawn(name: str) -> bool:
    """Return whether a picture was drawn from the data that are there."""
    if not (DOCS / name).is_file():
        return False
    with Image.open(DOCS / name) as picture:
        return picture.info.get(DATA) == PLOTS[name].digest()


def main() -> None:
    """Draw what is older than its data."""
    for name, plot in PLOTS.items():
        if not is_drawn(name):
            plot.save(name)


if __name__ == "__main__":
    main()
