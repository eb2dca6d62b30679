"""Write the report from the tables of one run: ``python benches/report DOCS FILES``.

DOCS is the folder of ``speed_vs_error.md``, with the tables in ``speed_vs_error`` beside it. FILES
is the folder with the peers' versions; after a measurement it is given, figures are drawn, and
``made.toml`` beside the tables stores the date, the machine and the versions. Without FILES only
the page is written again, from the committed tables.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import sections
from machine import provenance, read_provenance, write_provenance
from measurements import Measurements
from plots import draw_all
from recommendation import recommendation
from summary import headline, summary

TEMPLATE = Path(__file__).parent / "template.md"


def main() -> None:
    """Read the tables, draw the figures, fill the template."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("docs", type=Path)
    parser.add_argument("files", type=Path, nargs="?")
    parser.add_argument("--trial", action="store_true")
    arguments = parser.parse_args()
    folder = arguments.docs / "speed_vs_error"
    m = Measurements.read(folder)
    if arguments.files is not None:
        draw_all(m, folder)
        write_provenance(folder, provenance(Path(__file__).parents[1], arguments.files))
    origin = read_provenance(folder)
    warning = (
        "**This is a trial run, which is too short for results.**\n\n" if arguments.trial else ""
    )
    text = TEMPLATE.read_text().format(
        trial=warning,
        headline=headline(m),
        date=origin["date"],
        machine=origin["machine"],
        versions=origin["versions"],
        spread=sections.spread(m),
        summary=summary(m),
        call_only=sections.call_only(m),
        recommendation=recommendation(m),
        speeds=sections.speeds(m),
        errors=sections.errors(m),
        profile=sections.profile(m),
        lost=sections.lost(m),
        every_setting=sections.every_setting(m),
        larger_flocks=sections.larger_flocks(m),
        solvers=sections.solvers(m),
        order_of_schemes=sections.order_of_schemes(m),
        order_parameters=sections.order_parameters(m),
        parts=sections.parts(m),
        growth=sections.growth(m),
    )
    (arguments.docs / "speed_vs_error.md").write_text(text)


if __name__ == "__main__":
    main()
