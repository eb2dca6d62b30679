// Law: a link is followed where it can be, what cannot be followed is named, and what is shown makes the same link.

import assert from "node:assert/strict";
import { test } from "node:test";
import { changedFlock, differences, linkTo, readLink, requestsOf, textOf, tomlOf, valueFrom, valuesOfToml } from "../../web/request.mjs";
import { commandLine, isSchedule, pythonText } from "../../web/texts.mjs";

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
  assert.deepEqual(readLink("", FIELDS), { flock: {}, beside: null, changes: [], other: {}, ignored: [] });
});

for (const [fragment, sentence] of [
  ["n_boats=1000000", "The link's n_boats=1000000 is ignored: n_boats is 2 to 300 on this page."],
  ["n_boats=NaN", "The link's n_boats=NaN is ignored: n_boats is 2 to 300 on this page."],
  ["n_boats=", "The link's n_boats= is ignored: n_boats is 2 to 300 on this page."],
  ["beside.n_leaders=9", "The link's beside.n_leaders=9 is ignored: n_leaders is 0 to 8 on this page."],
  ["dt_s=1e-6", "The link's dt_s=1e-6 is ignored: dt_s is 0.001 to 1 on this page."],
  ["speed=3", "The link's speed=3 is ignored: speed is one of 1, 2, 4, 8, 16, 32, 64 and max."],
  ["lesson=<script>alert(1)</script>", "The link's lesson=<script>alert(1)</script> is ignored: lesson is one of steer, noise, leaders, learned, train, forces, opposed."],
  ["lesson=nothing", "The link's lesson=nothing is ignored: lesson is one of steer, noise, leaders, learned, train, forces, opposed."],
  ["at.7200.1.bw_s=1", "The link's at.7200.1.bw_s=1 is ignored: a change comes by 7200 s."],
  ["at.5.wheels=1", "The link's at.5.wheels=1 is ignored: this page knows no such parameter."],
  ["at.5.n_leaders=9", "The link's at.5.n_leaders=9 is ignored: n_leaders is 0 to 8 on this page."],
  ["at.5.speed=8", "The link's at.5.speed=8 is ignored: this page knows no such parameter."],
  ["now=1e3", "The link's now=1e3 is ignored: now is a number of seconds up to 7200."],
  ["flocks=4", "The link's flocks=4 is ignored: flocks is 1, 2 or 3."],
  ["<img src=x>=1", "The link's <img src=x>=1 is ignored: this page knows no such parameter."],
  ["__proto__=1", "The link's __proto__=1 is ignored: this page knows no such parameter."],
  ["toString=1", "The link's toString=1 is ignored: this page knows no such parameter."],
  ["bw_s=1%0Aseed=5", "The link's bw_s=1\nseed=5 is ignored: this page knows no such parameter."],
]) {
  test(`${fragment} is ignored in words, and what is beside it is not`, () => {
    const wanted = readLink(`#${fragment}&bw_s=0.4`, FIELDS);
    assert.deepEqual(wanted.ignored, [sentence]);
    assert.deepEqual([wanted.flock, wanted.changes], [{ bw_s: "0.4" }, []]);
  });
}

test("long texts are cut", () => {
  assert.ok(readLink(`#n_boats=${"9".repeat(5000)}`, FIELDS).ignored[0].length < 150);
});

test("what is shown makes a link that asks for it", () => {
  const shown = { flock: { preset: "experiment", n_boats: "27", target: "cw,ccw" }, beside: { leaders: "tuned law" },
    changes: [{ time: 3.5, fields: { bw_s: "0.5", target: "cw,cw" } }, { time: 40, fields: { bw_s: "" } }], other: { speed: "8" } };
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

test("flocks of several seeds, and then those beside them", () => {
  const requests = requestsOf({ flock: { seed: "18446744073709551613" }, beside: { n_boats: "3" }, copies: 3 }, KINDS);
  const seeds = ["18446744073709551613", "18446744073709551614", "18446744073709551615"];
  assert.deepEqual(requests, [{}, { n_boats: 3 }].flatMap((parameters) => seeds.map((seed) => ({ parameters, seed }))));
  assert.equal(requestsOf({ flock: { seed: "-1" }, beside: null, copies: 2 }, KINDS)[1].seed, "-1");
});

test("changes are what is other, and make the flock that it became", () => {
  const [before, after] = [{ n_boats: "2", c4: "0.1" }, { n_boats: "2", bw_s: "0.5" }];
  assert.deepEqual(differences(before, after), { c4: "", bw_s: "0.5" });
  assert.deepEqual(changedFlock(before, differences(before, after)), after);
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

test("what is not a value of its kind stays text, for the simulator to refuse", () => {
  for (const [kind, text] of [["real", "NaN"], ["real", "Infinity"], ["real", ""], ["count", "many"], ["flag", "1"], ["real", "1,2"]]) {
    assert.equal(valueFrom(kind, text), text);
  }
  assert.deepEqual(valueFrom("pool", "inf,0"), ["inf", 0]);
});

test("the same flock as a command", () => {
  assert.equal(commandLine({}, 480), "flockenv run --seed 0 --minutes 8");
  assert.equal(commandLine({ preset: "paper", n_boats: "27", pool: "180,0", leaders: "tuned law", seed: "7" }, 60),
    "flockenv run --preset paper --n-boats 27 --pool '(180, 0)' --policy \"tuned law\" --seed 7 --minutes 1");
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

test("numbers are spelled as TOML and Python have them", () => {
  const flock = { n_boats: "027", c4: ".3", pool: "180,0.", target: "cw, ccw", discs: "100,.5,6;" };
  const spelled = { n_boats: "27", c4: "0.3", pool: "180,0", target: "cw,ccw", discs: "100,0.5,6;" };
  const kinds = { n_boats: "count", c4: "real", pool: "pool", target: "choices", discs: "rows" };
  const changes = (c4) => [{ time: 5, fields: { c4 } }];
  assert.equal(commandLine(flock, 60, changes(".4")), commandLine(spelled, 60, changes("0.4")));
  assert.equal(pythonText([flock], 60, kinds, changes(".4")), pythonText([spelled], 60, kinds, changes("0.4")));
});

test("what changes on the way is an option of the command, and a schedule in Python", () => {
  const changes = [{ time: 183.5, fields: { bw_s: "2.85", target: "cw,ccw" } }];
  assert.equal(commandLine({ n_boats: "27", c4: "0.1" }, 480, changes),
    "flockenv run --n-boats 27 --set c4=0.1 --seed 0 --minutes 8 --at 183.5:bw_s=2.85 --at '183.5:target=[cw, ccw]'");
  const kinds = { n_boats: "count", target: "choices", bw_s: "real" };
  assert.match(pythonText([{ n_boats: "27" }], 480, kinds, changes),
    /simulate\(\n {4}parameters, seed=0, duration_s=480,\n {4}schedule=\[\(183\.5, \{"bw_s": 2\.85, "target": \["cw", "ccw"\]\}\)\],\n\)/);
  assert.equal(isSchedule(changes), true);
  for (const fields of [{ leaders: "learned" }, { n_leaders: "2" }, { preset: "paper" }, { c4: "" }]) {
    assert.equal(isSchedule([{ time: 1, fields }]), false);
  }
});

test("leaders with policies of their own have no command, and are a dictionary in Python", () => {
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
