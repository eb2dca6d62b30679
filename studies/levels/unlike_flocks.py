"""Score the entries of suite v3 in flocks unlike those that they learned in.

    python -m studies.levels.unlike_flocks      # about 40 minutes of one core in all

Rule, fixed before any policy was judged by it:

- Conditions. The twenty cells of `studies.other_flocks.beyond_one_noise`, which judged the policies
  of suite v2, each put upon a level: what a cell names replaces the level's own, and all else stays
  the level's, its observation, episode, target, control steps and coarse physics. No cell needs an
  observation of another size, since leaders see a fixed number of neighbors or none.
- Cells that are no condition. "As trained" is the level's own flock. So are four leaders in
  `order-easy` and `order-noisy`. They leave 18 cells in those two levels and 19 in `order-narrow`
  and `order-wide`. Nothing stands in for them.
- Cells that say another thing here. The numbers of a cell are absolute: 15 boats are more than the
  ten of two levels and fewer than the 27 of the others. The scheme `paper` has its critical noise
  in the level's pool, and keeps its steps of 0.02 s, on which its noise depends. Targets alternate
  each quarter of an episode: every 2 min in `order-wide`, 1 min in `order-narrow`, else 30 s.
- Scale. Without steering and under the damped law a condition has 128 flocks, whose seeds follow
  from a hash of its name. The condition counts in a level if the 95 % interval of the law's gain,
  paired by flock, lies above 0.05 of order. Otherwise the law is not shown to lead, or so little
  that luck decides, and the condition is left out for every entry.
- Score of a training in a condition: (order - no steering) / (damped law - no steering). The order
  is the mean over the first 24 of these flocks in levels of ten boats, the first 12 in those of 27;
  the other two are means over all 128. The column is the mean over the level's conditions that
  count, each with the same weight. Its 95 % interval is over trainings and flocks, as the suite's.
  It leaves out the luck of the scale, which is common to all entries.
- Power, from the orders of the suite's own flocks. In score, the SD of what all trainings share in
  a flock is 0.5 in `order-easy` and `order-narrow` and 0.7 in the two others, and of the rest 0.55.
  With 15 conditions the luck of flocks alone has a half width of 0.06, 0.08, 0.08 and 0.12, in the
  order of the levels; of that, 0.02 to 0.03 can change ranks of ten trainings, whose own luck is
  larger. Half widths of 0.05 would take 24 to 50 flocks and an hour and a half.
- Answer. What ranks best in its own flocks ranks best in unlike ones, in a level, if one entry of
  30 flock-hours has both highest scores. The rank correlation (Spearman) of the two scores of the
  entries has a 95 % interval by bootstrap over each entry's trainings.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flockenv import FlockParameters
from flockenv.comparison.levels import Level
from studies.other_flocks.beyond_one_noise import CELLS, Cell

LAW_FLOCKS, MARGIN = 128, 0.05


@dataclass(frozen=True)
class Condition:
    """A cell put upon a level."""

    cell: Cell
    flock: FlockParameters
    #: Options of the environment.
    options: Mapping[str, Any]

    @classmethod
    def from_cell(cls, cell: Cell, level: Level) -> "Condition":
        """Return what a cell changes in a level."""
        own, changes = level.parameters, {**cell.parameters}
        if cell.preset != "simulation":
            changes = {name: getattr(own, name) for name in ("pool", "n_boats", "n_leaders")}
            changes["bw_s"] = FlockParameters.critical_bw_s(cell.preset, own.pool)
            own = FlockParameters.preset(cell.preset)
        return cls(cell, own.replace(**changes), {**level.environment, **cell.options})

    def is_of(self, level: Level) -> bool:
        """Return whether these are the level's own flocks."""
        return self.flock == level.parameters and self.options == level.environment


def conditions(level: Level) -> list[Condition]:
    """Return the conditions that are unlike the level's own flocks."""
    found = (Condition.from_cell(cell, level) for cell in CELLS)
    return [each for each in found if not each.is_of(level)]


def led_flocks(level: Level) -> int:
    """Return how many flocks of a condition each policy leads."""
    return 24 if level.parameters.n_boats == 10 else 12
