// Law: a link is followed where it can be, what cannot be followed is named, and what is shown makes the same link.

import assert from "node:assert/strict";
import { test } from "node:test";
import { commandLine, linkTo, pythonText, readLink, requestsOf, textOf, tomlOf, valueFrom, valuesOfToml } from "../../web/request.mjs";

const FIELDS = ["n_boats", "n_leaders", "pool", "bw_s", "target", "dt_s", "discs"];

test("parameters of one flock, of a second beside it, and the rest", () => {
  const wanted = readLink("#preset=paper&n_boats=27&pool=180,0&beside.leaders=tuned law&speed=max&lesson=noise", FIELDS);
  assert.deepEqual(wanted.flock, { preset: "paper", n_boats: "27", pool: "180,0" });
  assert.deepEqual(wanted.beside, { leaders: "tuned law" });
  assert.deepEqual(wanted.other, { speed: "max", lesson: "noise" });
  assert.deepEqual(wanted.ignored, []);
});

test("a second flock may differ in several fields, up to the limits", () => {
  const { beside, ignored } = readLink("#beside.n_boats=300&beside.n_leaders=8&n_boats=2", FIELDS);
  assert.deepEqual(beside, { n_boats: "300", n_leaders: "8" });
  assert.deepEqual(ignored, []);
});

test("an empty link asks for nothing", () => {
  assert.deepEqual(readLink("", FIELDS), { flock: {}, beside: null, other: {}, ignored: [] });
});

for (const [fragment, sentence] of [
  ["n_boats=1000000", "The link's n_boats=1000000 is ignored: n_boats is 2 to 300 on this page."],
  ["n_boats=NaN", "The link's n_boats=NaN is ignored: n_boats is 2 to 300 on this page."],
  ["n_boats=", "The link's n_boats= is ignored: n_boats is 2 to 300 on this page."],
  ["beside.n_leaders=9", "The link's beside.n_leaders=9 is ignored: n_leaders is 0 to 8 on this page."],
  ["dt_s=1e-6", "The link's dt_s=1e-6 is ignored: dt_s is 0.001 to 1 on this page."],
  ["speed=3", "The link's speed=3 is ignored: speed is one of 1, 2, 4, 8, 16, 32, 64 and max."],
  ["lesson=<script>alert(1)</script>", "The link's lesson=<script>alert(1)</script> is ignored: lesson is a word."],
  ["<img src=x>=1", "The link's <img src=x>=1 is ignored: this page knows no such parameter."],
  ["__proto__=1", "The link's __proto__=1 is ignored: this page knows no such parameter."],
  ["toString=1", "The link's toString=1 is ignored: this page knows no such parameter."],
  ["bw_s=1%0Aseed=5", "The link's bw_s=1\nseed=5 is ignored: this page knows no such parameter."],
]) {
  test(`${fragment} is ignored in words, and what is beside it is not`, () => {
    const wanted = readLink(`#${fragment}&bw_s=0.4`, FIELDS);
    assert.deepEqual(wanted.ignored, [sentence]);
    assert.deepEqual(wanted.flock, { bw_s: "0.4" });
  });
}

test("long texts are cut", () => {
  assert.ok(readLink(`#n_boats=${"9".repeat(5000)}`, FIELDS).ignored[0].length < 150);
});

test("what is shown makes a link that asks for it", () => {
  const shown = { flock: { preset: "experiment", n_boats: "27", target: "cw,ccw" }, beside: { leaders: "tuned law" }, other: { speed: "8" } };
  const { ignored, ...wanted } = readLink(linkTo(shown), FIELDS);
  assert.deepEqual(wanted, shown);
  assert.deepEqual(ignored, []);
});

const KINDS = { n_boats: "count", n_leaders: "count", pool: "pool", bw_s: "real", leaders_reverse: "flag", target: "choices", scheme: "choice", discs: "rows" };

test("a request has the values of its parameters, that of the second flock with its own", () => {
  assert.deepEqual(requestsOf({ flock: { n_boats: "27" }, beside: null }, KINDS), [{ parameters: { n_boats: 27 } }]);
  assert.deepEqual(requestsOf({ flock: { n_boats: "27", seed: "18446744073709551615", leaders: "learned" }, beside: { leaders: "you" } }, KINDS),
    ["learned", "you"].map((leaders) => ({ parameters: { n_boats: 27 }, seed: "18446744073709551615", leaders })));
});

test("a link's text is a value of its kind, and the value is the text again", () => {
  for (const [name, text, value] of [
    ["n_boats", "27", 27], ["bw_s", "0.3", 0.3], ["bw_s", "-1e-7", -1e-7], ["pool", "wide", "wide"], ["pool", "180,0", [180, 0]],
    ["leaders_reverse", "true", true], ["leaders_reverse", "false", false], ["target", "cw", "cw"], ["target", "cw,ccw", ["cw", "ccw"]],
    ["scheme", "moreau", "moreau"], ["discs", "1,2,3;4,5,6.5", [[1, 2, 3], [4, 5, 6.5]]], ["discs", "", []],
  ]) {
    assert.deepEqual(valueFrom(KINDS[name], text), value, `${name}=${text}`);
    assert.equal(textOf(value), text === "-1e-7" ? String(-1e-7) : text);
  }
});

test("what is no value of its kind stays text, for the simulator to refuse", () => {
  for (const [kind, text] of [["real", "NaN"], ["real", "Infinity"], ["real", ""], ["count", "many"], ["flag", "1"], ["real", "1,2"]]) {
    assert.equal(valueFrom(kind, text), text);
  }
  assert.deepEqual(valueFrom("pool", "inf,0"), ["inf", 0]);
});

test("the same flock as a command", () => {
  assert.equal(commandLine({}, 480), "flockenv run --seed 0 --minutes 8");
  assert.equal(commandLine({ preset: "paper", n_boats: "27", pool: "180,0", leaders: "tuned law", seed: "7" }, 60),
    "flockenv run --preset paper --set n_boats=27 --set 'pool=[180, 0]' --policy \"tuned law\" --seed 7 --minutes 1");
});

test("the same flock in Python", () => {
  const kinds = { n_boats: "count", pool: "pool", target: "choices" };
  assert.equal(pythonText([{ n_boats: "27", pool: "inf,0", target: "cw,ccw", leaders: "learned" }], 60, kinds), [
    "import flockenv", "",
    'parameters = flockenv.FlockParameters.preset("simulation").replace(',
    '    n_boats=27, pool=(float("inf"), 0), target=["cw", "ccw"]', ")",
    'recording = flockenv.simulate(parameters, seed=0, duration_s=60, policy="learned")', "",
  ].join("\n"));
});

test("leaders with policies of their own are no command, and a dictionary in Python", () => {
  const flock = { n_leaders: "2", leaders: "learned,paper's law" };
  assert.equal(commandLine(flock, 60), "");
  assert.match(pythonText([flock], 60, { n_leaders: "count" }), /policy=\{"leader_0": "learned", "leader_1": "paper's law"\}\)\n$/);
});

test("parameters as TOML are read back as they were", () => {
  const values = { n_boats: 27, pool: ["inf", 0], bw_s: 1e-7, leaders_reverse: true, target: ["cw", "ccw"], discs: [[1, 2, 3], [4, 5, 6.5]], walls: [] };
  const toml = tomlOf(values);
  assert.match(toml, /^pool = \[inf,0\]$/m);
  assert.match(toml, /^target = \["cw","ccw"\]$/m);
  assert.deepEqual(valuesOfToml(toml), values);
});

test("lists over several lines, as Python writes them", () => {
  assert.deepEqual(valuesOfToml('pool = [\n    180.0,\n    inf,\n]\nscheme = "leapfrog"\n'), { pool: [180, "inf"], scheme: "leapfrog" });
  assert.deepEqual(valuesOfToml("discs = [\n    [\n        1.0,\n        2.0,\n        3.0,\n    ],\n]\nwalls = []\n"), { discs: [[1, 2, 3]], walls: [] });
  assert.deepEqual(valuesOfToml("bw_s = nan\n"), { bw_s: "nan" });
});

test("infinity in TOML may have a sign", () => {
  assert.deepEqual(valuesOfToml("pool = [+inf, 0.0]\nbw_s = inf\n"), { pool: ["inf", 0], bw_s: "inf" });
});
