// Law: what packing.py packs comes out again; the bytes were written by it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { unpack } from "../../../flockenv/replay/packing.mjs";

const PACKED =
  "H4sIAAAAAAAAA/vBwMAQXa2Ul5ibqmSlVJybn1+SoaSjlJOalw5kWJnoKCVnJOblpeYUK1kZ6SgVlibmlZTmKlkZ6BmZ6iilZKal" +
  "pRal5iWnQqQLchLzQEzjWh24mUCxzDxcRhoiGWmoZ4BmogHCRBMkE/Py81KRDDQgy0CD2lgGFpbJHOJSPMAg6GaAAA4QwcbMgAwU" +
  "AAHPuu0kAQAA";

test("series by name, channel and sample", async () => {
  const columns = await unpack(PACKED);
  assert.deepEqual([...columns.keys()], ["smooth", "plain", "none"]);
  const channel = (name, place) => Array.from({ length: 4 }, (_, k) => columns.get(name).at(k, place));
  assert.deepEqual(channel("smooth", 0), [0, 0.5, 1.5, -70000]);
  assert.deepEqual(channel("smooth", 1), [1, -1, 0.25, 3]);
  assert.deepEqual(channel("plain", 0), [3, -2, 0, 268435456]);
  assert.equal(columns.get("none").length, 0);
});

test("text that is not a page's is refused", async () => {
  await assert.rejects(unpack("A".repeat(40)));
});
