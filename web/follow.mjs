// Follows a link: starts its flocks, makes its changes, and runs to its time.

import { changedFlock, linkTo } from "./request.mjs";

/** The link to the flocks at a time, in s. */
export function linkOf(flocks, other, time) {
  const { other: times, isComplete: _, ...fields } = flocks.linkFields(Number(time.toFixed(1)));
  return linkTo({ ...fields, other: { ...times, ...other } });
}

/**
 * Replaces the flocks by those of a link, makes its changes, and runs to its time. Leaves out each parameter that
 * the simulator refuses, and adds a sentence about it to `linked.ignored`. `isWanted` says whether to continue.
 */
export async function follow(flocks, linked, isWanted) {
  const { start = "0", now = start, flocks: copies = "1" } = linked.other;
  await openFlocks(flocks, { flock: linked.flock, beside: linked.beside, copies: Number(copies) }, linked);
  const steps = [{ time: Number(start) }, ...linked.changes, { time: Number(now) }].sort((a, b) => a.time - b.time);
  for (const { time, fields } of steps) {
    await flocks.runTo(time, isWanted);
    if (!isWanted()) {
      return;
    }
    if (fields) {
      await makeChange(flocks, fields, linked);
    } else if (time === Number(start) && time > 0) {
      flocks.restartMeans();
    }
  }
}

/** Opens flocks without the fields that the simulator refuses. */
async function openFlocks(flocks, wanted, linked) {
  const refused = new Set();
  for (let tries = 0; tries < 40; tries += 1) {
    try {
      await flocks.update(wanted, "open");
      linked.ignored.push(...Array.from(refused, (name) => `${name} = ${flocks.values[name] ?? "its usual value"} takes its place.`));
      return;
    } catch (error) {
      if (!error.refused) {
        throw error;
      }
      linked.ignored.push(`The link asks for what cannot be: ${error.message}.`);
      const groups = [wanted.flock, wanted.beside ?? {}].filter((fields) => Object.hasOwn(fields, error.field));
      if (groups.length === 0) {
        Object.assign(wanted, { flock: {}, beside: null });
      }
      for (const fields of groups) {
        delete fields[error.field];
        refused.add(error.field);
      }
      if (Object.keys(wanted.beside ?? {}).length === 0) {
        wanted.beside = null; // It would be the same flock again.
      }
    }
  }
}

async function makeChange(flocks, fields, linked) {
  try {
    await flocks.update({ ...flocks.shown, flock: changedFlock(flocks.shown.flock, fields) }, "change");
  } catch (error) {
    if (!error.refused) {
      throw error;
    }
    linked.ignored.push(`The link asks for what cannot be: ${error.message}.`);
  }
}
