// Law: of a link, what the simulator refuses is left out, and nothing else.

import assert from "node:assert/strict";
import { test } from "node:test";
import { follow } from "../../web/follow.mjs";

/** The flocks that a link opens where the simulator refuses a negative number, and what the page says of them. */
async function opened(flock, beside) {
  const flocks = {
    values: { bw_s: "0.3" },
    async update(wanted) {
      const [field] = Object.entries({ ...wanted.flock, ...wanted.beside }).find(([, value]) => Number(value) < 0) ?? [];
      if (field) {
        throw Object.assign(new Error("refused"), { refused: true, field });
      }
      this.shown = structuredClone(wanted);
    },
    runTo: async () => undefined,
  };
  const linked = { flock, beside, changes: [], other: {}, ignored: [] };
  await follow(flocks, linked, () => true);
  return [flocks.shown, linked.ignored];
}

test("a field that is refused", async () => {
  const [shown, ignored] = await opened({ bw_s: "-1", n_boats: "9" }, { n_leaders: "1", c4: "-2" });
  assert.deepEqual(shown, { flock: { n_boats: "9" }, beside: { n_leaders: "1" }, copies: 1 });
  assert.equal(ignored.length, 4);
  assert.ok(ignored.includes("bw_s = 0.3 takes its place."));
});

test("the only field in which the second flock differs: there is no second flock", async () => {
  assert.deepEqual((await opened({ n_boats: "9" }, { c4: "-2" }))[0], { flock: { n_boats: "9" }, beside: null, copies: 1 });
});
