// Follows a link: starts its flocks, applies its changes, and runs to its moment.

import { changedFlock, linkTo } from "./request.mjs";

/** The link to the flocks at a time, in s. */
export function linkOf(flocks, other, time) {
  const { other: moment, isWhole: _, ...shown } = flocks.linked(Number(time.toFixed(1)));
  return linkTo({ ...shown, other: { ...moment, ...other } });
}

/**
 * Replaces the flocks by those of a link, with its changes, and lets them run to its moment. Leaves out each
 * parameter that the simulator refuses, and names it in `linked.ignored`. `isWanted` says whether to
 * continue.
 */
export async function follow(flocks, linked, isWanted) {
  const { start = "0", now = start, flocks: copies = "1" } = linked.other;
  await opened(flocks, { flock: linked.flock, beside: linked.beside, copies: Number(copies) }, linked);
  const steps = [{ time: Number(start) }, ...linked.changes, { time: Number(now) }].sort((one, other) => one.time - other.time);
  for (const { time, fields } of steps) {
    await flocks.runTo(time, isWanted);
    if (!isWanted()) {
      return;
    }
    if (fields) {
      await changedTo(flocks, fields, linked);
    } else if (time === Number(start) && time > 0) {
      flocks.restartMeans();
    }
  }
}

async function opened(flocks, wanted, linked) {
  const refused = new Set();
  for (let tries = 0; tries < 40; tries += 1) {
    try {
      await flocks.become(wanted, "open");
      linked.ignored.push(...Array.from(refused, (name) => `${name} = ${flocks.values[name] ?? "its usual value"} takes its place.`));
      return;
    } catch (error) {
      if (!error.refused) {
        throw error;
      }
      linked.ignored.push(`The link asks for what cannot be: ${error.message}.`);
      const held = [wanted.flock, wanted.beside ?? {}].filter((fields) => Object.hasOwn(fields, error.field));
      if (held.length === 0) {
        Object.assign(wanted, { flock: {}, beside: null });
      }
      for (const fields of held) {
        delete fields[error.field];
        refused.add(error.field);
      }
    }
  }
}

async function changedTo(flocks, fields, linked) {
  try {
    await flocks.become({ ...flocks.shown, flock: changedFlock(flocks.shown.flock, fields) }, "change");
  } catch (error) {
    if (!error.refused) {
      throw error;
    }
    linked.ignored.push(`The link asks for what cannot be: ${error.message}.`);
  }
}
