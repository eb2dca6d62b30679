"""Writes the report from the tables of one run: ``python benches/report DOCS FILES``.

DOCS is the folder that ``speed_vs_error.md`` goes to, with the tables in ``speed_vs_error`` beside
it; FILES is where the peers' versions lie.
"""

from __future__ import annotations

import argparse
from datetime import UTC, datetime
from pathlib import Path

import sections
from bars import bars_table, headline
from machine import machine, versions
from measurements import Measurements
from plots import draw_all
from recommendation import recommendation

TEMPLATE = Path(__file__).parent / "template.md"


def main() -> None:
    """Reads the tables, draws the figures, fills the template."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("docs", type=Path)
    parser.add_argument("files", type=Path)
    parser.add_argument("--trial", action="store_true")
    arguments = parser.parse_args()
    folder = arguments.docs / "speed_vs_error"
    m = Measurements.read(folder)
    draw_all(m, folder)
    warning = "**This is a trial run: too short to mean anything.**\n\n" if arguments.trial else ""
    text = TEMPLATE.read_text().format(
        trial=warning,
        headline=headline(m),
        date=datetime.now(UTC).date(),
        machine=machine(),
        versions=versions(Path(__file__).parents[1], arguments.files),
        spread=sections.spread(m),
        bars=bars_table(m),
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
