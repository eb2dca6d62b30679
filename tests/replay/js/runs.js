// Runs that are small enough to be checked on paper.

import { Column } from "../../../flockenv/replay/packing.mjs";
import { Run } from "../../../flockenv/replay/shared/run.mjs";

/** A series from whole numbers of quanta, channel after channel. */
export function column(values, quantum = 1, channels = 1) {
  return new Column({ length: values.length / channels, channels, quantum }, Int32Array.from(values));
}

/** Three samples of a leader that moves and a boat that rests; contacts from the second sample on. */
export function runOf(forces = [5, 20, 40]) {
  const columns = new Map(Object.entries({
    time_s: column([0, 1, 2], 0.5),
    phase: column([0, 0, 0]),
    in_analysis_window: column([0, 1, 0]),
    position_cm: column([0, 10, 20, 0, 4, 8, 30, 30, 30, 0, 0, 0], 1, 4),
    heading: column([0, 2, 4, 4, 4, 4], 0.25, 2),
    speed_cm_s: column([1, 2, 3, 0, 0, 0], 1, 2),
    turning_rate: column([0, 1, 2, 0, 0, 0], 0.5, 2),
    rudder: column([0, 50, -100], 0.01),
    leader_phi: column([0, 3, 6], 0.5),
    psi_o: column([1, 2, 3], 0.25),
    contact_count: column([0, forces.length - 1, 1]),
    contact_i: column(forces.map((_, k) => Math.min(k, 1))),
    contact_j: column(forces.map((_, k) => (k === 0 ? 1 : -1))),
    contact_along_cm: column(forces.map(() => 0)),
    contact_angle: column(forces.map(() => 0)),
    contact_force: column(forces),
  }));
  return new Run({ boats: 2, leaders: 1, phases: ["fw"], lengths: { hull_radius_cm: 5, hull_half_length_cm: 5 } }, columns);
}
