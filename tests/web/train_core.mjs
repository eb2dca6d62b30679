// Trains in the compiled simulator as the page does, for the test that compares it with the native training.
// Input: {wasm, flock, values, settings, seed}; output: the policy's file, and the page's command.

import { readFileSync } from "node:fs";
import { Core } from "../../web/core.mjs";
import { requestOf } from "../../web/request.mjs";
import { trainingCommand } from "../../web/texts.mjs";
import { SETTINGS } from "../../web/training.mjs";

const { wasm, flock, settings, seed } = JSON.parse(readFileSync(0, "utf8"));
const core = await Core.load(readFileSync(wasm));
const kinds = Object.fromEntries(core.describe().fields.map(({ name, kind }) => [name, kind]));
const options = { ...SETTINGS, ...settings };
const command = trainingCommand(flock, flock, options, seed);
const asked = { flock: { ...requestOf(flock, kinds), seed: String(seed) }, options, provenance: { command } };
let training = core.train(asked);
while (!training.has_ended) {
  training = core.learn(1);
}
process.stdout.write(JSON.stringify({ policy: training.policy, command }));
