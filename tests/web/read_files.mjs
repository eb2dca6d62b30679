// What the live page says of recordings' files, for the tests that compare it with Recording.load.
// Input: {wasm, format, paths}; output: for each path the refusal, or null and the page's series of order.

import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { Core } from "../../web/core.mjs";
import { Flocks } from "../../web/flocks.mjs";
import { derivedOf, runOfFile } from "../../web/share.mjs";

const { wasm, format, paths } = JSON.parse(readFileSync(0, "utf8"));
const core = await Core.load(readFileSync(wasm));
const { fields, laws, phases, quantities, statistics } = core.describe();
// The thread's own answer, without its thread.
globalThis.addEventListener = () => undefined;
const { ANSWERS } = await import("../../web/worker.mjs");
await ANSWERS.start({ bytes: readFileSync(wasm) });
const known = quantities.filter(({ kind }) => kind !== "structure").map(({ name, ...rest }) => ({ key: name, ...rest }));
const series = known.map(({ key }) => key);
const flocks = new Flocks(null, { kinds: Object.fromEntries(fields.map(({ name, kind }) => [name, kind])), laws, series, statistics, phases, version: "" });

async function said(path) {
  const file = { name: basename(path), arrayBuffer: async () => Uint8Array.from(readFileSync(path)).buffer };
  try {
    const run = await runOfFile(file, { format, phases, series, statistics, quantities: known }, {
      check: async (request) => ANSWERS.check({ request }).values,
      describe: (answer, named) => flocks.runDescription(answer, named),
      derive: async (arrays, described) => ANSWERS.derive(derivedOf(arrays, described, series)).series,
    });
    return { refusal: null, signed: Array.from({ length: run.length }, (_, k) => run.value("signed_order", k)) };
  } catch (error) {
    return { refusal: `${path} ${error.message}`, signed: [] };
  }
}

const all = [];
for (const path of paths) {
  all.push(await said(path));
}
process.stdout.write(JSON.stringify(all));
