// Runs flocks in the compiled simulator, for the tests that compare them with the native one.
// Input: {wasm, runs: [{request, samples, heading}]}; output: for each the bytes of the last poses and velocities in base64.

import { readFileSync } from "node:fs";
import { Core } from "../../web/core.mjs";

const { wasm, runs } = JSON.parse(readFileSync(0, "utf8"));
const core = await Core.load(readFileSync(wasm));
const last = (numbers, count) => Buffer.from(numbers.slice(-count).buffer).toString("base64");
const ends = runs.map(({ request, samples, heading = 0 }) => {
  core.open(0, request);
  core.steer(0, heading);
  // What is steered from the start on is another flock's start: the first decision is older.
  core.change(0, request);
  for (let missing = samples; missing > 0;) {
    missing -= core.advance(0, missing, 50_000);
  }
  const { time_s: time, pose, velocity } = core.take(0);
  const count = pose.length / time.length;
  return { samples: time.length, pose: last(pose, count), velocity: last(velocity, count) };
});
process.stdout.write(JSON.stringify(ends));
