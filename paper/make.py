"""Make figures and questions by name, or all of them: `make paper`."""

import itertools
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
FIGURES = (
    *("noise_makes_motion", "fig04", "states", "fig07", "fig08", "fig09", "fig10"),
    *("fig11", "fig12", "fit", "fig14", "fig15", "fig16", "fig17"),
    *("headlines", "what_leaders_see", "sizes", "worth", "hysteresis", "transition"),
    "readings",
)
"""The files of this folder that are run, the shortest first."""


def main(arguments: list[str] | None = None) -> None:
    """Run each file in a process of its own: names first, then the options of every file."""
    given = sys.argv[1:] if arguments is None else arguments
    names = list(itertools.takewhile(lambda text: not text.startswith("-"), given))
    options = given[len(names) :]
    unknown = [name for name in names if name not in FIGURES]
    if unknown:
        sys.exit(f"Error: {unknown[0]!r} is no figure of this folder: {', '.join(FIGURES)}")
    commands = {name: [sys.executable, HERE / f"{name}.py", *options] for name in names or FIGURES}
    failed = [n for n, each in commands.items() if subprocess.run(each, check=False).returncode]
    if failed:
        sys.exit(f"{', '.join(failed)} did not end well; the same command resumes from there")


if __name__ == "__main__":
    main()
