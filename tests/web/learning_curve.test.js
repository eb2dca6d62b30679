// Law: the name of the law's line can be read, whatever the curve does.

import assert from "node:assert/strict";
import { test } from "node:test";
import { LearningCurve } from "../../web/learning_curve.mjs";
import { canvas } from "./pictures.js";

test("the law's name stands at the start of its line, over the curve", () => {
  const picture = canvas(300, 150);
  const curve = new LearningCurve(picture);
  curve.clear(60, 0.19);
  curve.add(0, 0.01);
  curve.add(60, 0.2);
  curve.draw({});
  const name = picture.calls.findIndex(({ name: call, words }) => call === "fillText" && words[0] === "the paper's law +0.19");
  assert.ok(picture.calls.findLastIndex(({ name: call }) => call === "arc") < name);
  assert.equal(picture.calls[name].words[1], 38);
});
