// Law: a page is one script, in an order in which nothing is used before it is there; no file of the live page is long.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { Script } from "node:vm";

const ROOT = new URL("../../", import.meta.url);
const read = (path) => readFileSync(new URL(path, ROOT), "utf8");
/** The scripts that a Python tuple of this name lists. */
const listed = (path, name) => [...new RegExp(`${name} = \\(([^)]*)\\)`).exec(read(path))[1].matchAll(/"([^"]+)"/g)].map(([, each]) => each);

const shared = listed("web/build.py", "_SHARED").map((name) => `flockenv/replay/shared/${name}`);
const own = listed("web/build.py", "_OWN").map((name) => `web/${name}`);
const PAGES = {
  "the live page": [...shared, ...own],
  "the replay page": listed("flockenv/replay/page.py", "_SCRIPTS").map((name) => `flockenv/replay/${name}`),
};

for (const [page, paths] of Object.entries(PAGES)) {
  test(`${page} imports what stands before, and declares no name twice`, () => {
    paths.forEach((path, place) => {
      for (const [, from] of read(path).matchAll(/^import .* from "([^"]+)";$/gm)) {
        const found = paths.findIndex((each) => new URL(each, ROOT).href === new URL(from, new URL(path, ROOT)).href);
        assert.ok(found >= 0 && found < place, `${path} imports ${from}`);
      }
    });
    // A syntax error if a name is declared twice; nothing runs.
    const script = paths.map(read).join("\n").replaceAll(/^(?:import .*;\n|export )/gm, "");
    assert.ok(new Script(script));
  });
}

test("what is shared imports nothing of either page, and no script is a page in one file", () => {
  for (const path of shared) {
    assert.ok([...read(path).matchAll(/from "([^"]+)"/g)].every(([, from]) => from.startsWith("./")), path);
  }
  for (const path of own) {
    assert.ok(read(path).split("\n").length <= 241, path);
  }
});

test("no text is written over several lines, whose indents the page leaves out", () => {
  for (const path of [...shared, ...own]) {
    const broken = read(path).split("\n").filter((line) => !/^\s*(?:\/\/|\/?\*)/.test(line) && (line.split("`").length - 1) % 2 > 0);
    assert.deepEqual(broken, [], path);
  }
});
