// Law: an .npz file holds what was put into it, and a file that is none is refused in words.

import assert from "node:assert/strict";
import { test } from "node:test";
import { array, readNpz, writeNpz } from "../../web/npz.mjs";

const whole = () => writeNpz({
  pose: array.reals([1, 2, 3, 4, 5, 6], [2, 1, 3]),
  phase: array.texts(["fw", "nop1"], [2]),
  in_analysis_window: array.flags([true, false], [2]),
  seed: array.whole("18446744073709551615"),
  none: array.reals([], [0]),
});

test("arrays come out as they went in", async () => {
  const arrays = await readNpz(whole().buffer);
  assert.deepEqual(Object.keys(arrays), ["pose", "phase", "in_analysis_window", "seed", "none"]);
  assert.deepEqual(arrays.pose, { shape: [2, 1, 3], descr: "<f8", values: Float64Array.of(1, 2, 3, 4, 5, 6) });
  assert.deepEqual(arrays.phase, { shape: [2], descr: "<U4", values: ["fw", "nop1"] });
  assert.deepEqual([...arrays.in_analysis_window.values], [1, 0]);
  assert.deepEqual(arrays.seed, { shape: [], descr: "<u8", values: ["18446744073709551615"] });
  assert.equal(arrays.none.values.length, 0);
});

test("the bytes are the same at every time", () => {
  assert.deepEqual(whole(), whole());
});

test("anything else is refused in words", async () => {
  await assert.rejects(readNpz(new ArrayBuffer(0)), { message: "its end is missing" });
  await assert.rejects(readNpz(new TextEncoder().encode("<script>".repeat(100)).buffer), { message: "its end is missing" });
});

test("wherever a file is cut off, it is refused", async () => {
  const bytes = whole();
  for (let length = 0; length < bytes.length; length += 7) {
    await assert.rejects(readNpz(bytes.slice(0, length).buffer), Error);
  }
});

test("an array whose shape does not match its size is refused", async () => {
  const bytes = writeNpz({ pose: { shape: [9, 1, 3], descr: "<f8", bytes: new Uint8Array(48) } });
  await assert.rejects(readNpz(bytes.buffer), { message: "an array has a shape that does not match its size" });
});

test("no byte of an array or of its name changes unseen", async () => {
  const bytes = whole();
  const dated = new Set();
  for (let place = 0; place < bytes.length; place += 1) {
    const harmed = Uint8Array.from(bytes);
    harmed[place] ^= 1;
    await readNpz(harmed.buffer).then(() => dated.add(place), () => undefined);
  }
  // Versions, dates, attributes and what a header repeats of the directory: no more than so many bytes an array.
  const [arrays, header] = [5, 46 + 30];
  assert.ok(dated.size < arrays * header, `${dated.size} of ${bytes.length}`);
  const arraysAgain = await Promise.all([...dated].map((place) => readNpz(Uint8Array.from(bytes, (each, k) => (k === place ? each ^ 1 : each)).buffer)));
  const expected = await readNpz(bytes.buffer);
  for (const each of arraysAgain) {
    assert.deepEqual(each, expected);
  }
});

test("long texts are read whole", async () => {
  const text = "n_boats = 27\n".repeat(20_000);
  const { parameters } = await readNpz(writeNpz({ parameters: array.texts([text], []) }).buffer);
  assert.ok(parameters.values[0] === text);
});

test("objects are refused", async () => {
  const bytes = writeNpz({ pose: { shape: [1], descr: "|O", bytes: new Uint8Array(8) } });
  await assert.rejects(readNpz(bytes.buffer), { message: "an array of |O is not accepted" });
});

test("texts keep their zeros, but for those at the end, which NumPy leaves out", async () => {
  const { names } = await readNpz(writeNpz({ names: array.texts(["a\0b", "c\0"], [2]) }).buffer);
  assert.deepEqual(names.values, ["a\0b", "c"]);
});

test("bytes after the archive are not a part of it, as for NumPy", async () => {
  const whole = writeNpz({ numbers: array.reals([1, 2], [2]) });
  const { numbers } = await readNpz(Uint8Array.of(...whole, 1, 2, 3).buffer);
  assert.deepEqual([...numbers.values], [1, 2]);
});

test("an array that is there twice is refused", async () => {
  const letters = writeNpz({ one: array.reals([1], [1]), two: array.reals([2], [1]) });
  const twice = Buffer.from(Buffer.from(letters).toString("latin1").replaceAll("two.npy", "one.npy"), "latin1");
  await assert.rejects(readNpz(Uint8Array.from(twice).buffer), { message: "it holds 'one' twice" });
});
