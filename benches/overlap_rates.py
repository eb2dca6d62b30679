"""Count the runs of 27 boats with deep overlaps: ``python benches/overlap_rates.py [FOLDER]``.

Three scenes at dt = 0.1 s, 200 seeds each, with the default tolerance and with gaps that are solved
once. The rates go to overlap_rates.csv, by default in docs/speed_vs_error.
"""

import csv
import io
import math
import sys
from collections.abc import Iterator
from pathlib import Path

import flockenv
from flockenv._io.atomic_write import write_text

OUT = Path(__file__).parents[1] / "docs" / "speed_vs_error"
SEEDS = range(12_000, 12_200)
#: Seconds of a run, pool and backward duration of the scenes.
SCENES = {
    "cycle": (60.0, "narrow", 2.0),
    "wide": (460.0, "wide", 0.31),
    "narrow": (460.0, "narrow", 0.45),
}
DEPTHS_CM = (1e-5, 1e-4, 1e-3, 0.01, 0.1)


def rows() -> Iterator[dict[str, object]]:
    """Yield the rates of each scene, scheme and tolerance."""
    for scene, (seconds, pool, bw_s) in SCENES.items():
        for scheme in ("leapfrog", "moreau"):
            for tolerance_cm in (1e-4, math.inf):
                p = flockenv.FlockParameters.preset("simulation").replace(
                    n_boats=27,
                    pool=pool,
                    bw_s=bw_s,
                    scheme=scheme,
                    dt_s=0.1,
                    tolerance_cm=tolerance_cm,
                )
                runs = [statistics(p, seed, seconds) for seed in SEEDS]
                deepest = [run.worst_overlap_cm for run in runs]
                yield (
                    {"scene": scene, "scheme": scheme, "tolerance_cm": tolerance_cm}
                    | {"seconds": seconds, "bw_s": bw_s, "runs": len(runs)}
                    | {f"beyond_{cm:g}_cm": sum(d > cm for d in deepest) for cm in DEPTHS_CM}
                    | {"deepest_cm": f"{max(deepest):.3g}"}
                    | {"unsolved": sum(run.unsolved for run in runs)}
                    | {"halved_substeps": sum(run.halved_substeps for run in runs)}
                    | {"substeps": sum(run.substeps for run in runs)}
                )


def statistics(p: flockenv.FlockParameters, seed: int, seconds: float) -> flockenv.Statistics:
    """Return the statistics of a run."""
    flock = flockenv.Flock(p, seed)
    flock.advance(seconds)
    return flock.statistics


def main() -> None:
    """Measure, print and write."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else OUT
    text = io.StringIO()
    table = list(rows())
    writer = csv.DictWriter(text, list(table[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(table)
    write_text(folder / "overlap_rates.csv", text.getvalue())
    print(text.getvalue(), end="")


if __name__ == "__main__":
    main()
