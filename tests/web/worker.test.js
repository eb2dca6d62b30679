// Law: a request that is refused leaves every flock where it was.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Core } from "../../web/core.mjs";

globalThis.addEventListener = () => undefined;
const { ANSWERS } = await import("../../web/worker.mjs");

/** A simulator that refuses odd numbers, and counts what happened to its flocks. */
function simulator() {
  const flocks = [];
  const accept = (request) => {
    if (request % 2 === 1) {
      throw new Error("refused");
    }
  };
  const open = (flock, request) => {
    accept(request);
    flocks[flock] = { request, samples: 0 };
  };
  const change = (flock, request) => {
    accept(request);
    flocks[flock].request = request;
    return { continued: true };
  };
  const advance = (flock, samples) => {
    flocks[flock].samples += samples;
    return samples;
  };
  return { flocks, describe: () => null, open, change, advance, close: () => undefined, steer: () => undefined, look: () => undefined, take: () => ({}) };
}

for (const kind of ["open", "change"]) {
  for (const requests of [[1], [4, 1], [1, 4]]) {
    test(`${kind}: ${requests.join(" beside ")}`, async () => {
      const loaded = [];
      Core.load = async () => loaded[loaded.push(simulator()) - 1];
      await ANSWERS.start({});
      ANSWERS.open({ requests: requests.map(() => 2) });
      ANSWERS.advance({ samples: 4, milliseconds: 1000 });
      assert.throws(() => ANSWERS[kind]({ requests }), /refused/);
      assert.deepEqual(loaded[0].flocks, requests.map(() => ({ request: 2, samples: 4 })));
      ANSWERS.change({ requests: requests.map(() => 6) });
      assert.deepEqual(loaded[0].flocks, requests.map(() => ({ request: 6, samples: 4 })));
    });
  }
}
