// Tests of the kinematics of the 3-D view (report/page/scene.js): node --test scene_test.mjs
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

const source = new URL("../../../include/kinecal/report/page/scene.js", import.meta.url);
/// The module, on a page that holds a scene.
function pageWith(scene) {
  const document = { getElementById: () => ({ textContent: JSON.stringify(scene) }) };
  return new Function("document", `${readFileSync(source, "utf8")}; return kinecalScene;`)(document);
}
/// Positions of all links.
function positions(scene, q, which = "after", factor = 1) {
  const module = pageWith(scene);
  return module.linkPoses(module.readScene(), q, which, factor)
    .map((pose) => pose && pose.slice(0, 3));
}
const near = (value, expected) => {
  assert.equal(value.length, expected.length);
  value.forEach((v, i) => assert.ok(Math.abs(v - expected[i]) < 1e-12, `${value} is not ${expected}`));
};

const turned = Math.SQRT1_2;
const joint = (parent, child, values) =>
  ({ type: "revolute", parent, child, origin: [1, 0, 0, 0, 0, 0, 1], axis: [0, 0, 2], drive: [0, 1, 0], ...values });
const links = [{ name: "a" }, { name: "b" }, { name: "c" }, { name: "alone" }];
/// Two joints about z with links of one metre.
const arm = (first = {}, second = {}) =>
  ({ links, joints: [joint(0, 1, first), joint(1, 2, { drive: [1, 1, 0], ...second })] });

test("a revolute joint turns about its axis, of any length", () => {
  near(positions(arm(), [Math.PI / 2, 0])[2], [1, 1, 0]);
});
test("a prismatic joint slides along its axis", () => {
  near(positions(arm({ type: "prismatic" }), [0.3, 0])[2], [2, 0, 0.3]);
});
test("a mimicking joint follows with multiplier and offset", () => {
  near(positions(arm({ drive: [0, -2, Math.PI] }), [Math.PI / 4, 0])[2], [1, 1, 0]);
});
test("a joint without a position stays at its offset", () => {
  near(positions(arm({ drive: [-1, 1, Math.PI / 2] }), [null, null])[2], [1, 1, 0]);
});
test("an origin turns what follows", () => {
  near(positions(arm({ origin: [1, 0, 0, 0, 0, turned, turned] }), [0, 0])[2], [1, 1, 0]);
});
test("a correction is applied after the origin and before the motion", () => {
  const after = { t: [0, 0, 0.5], r: [0, 0, Math.PI / 2], offset: -Math.PI / 2 };
  near(positions(arm({ after }), [0, 0])[2], [2, 0, 0.5]);
});
test("exaggeration scales the difference of after to before", () => {
  const scene = arm({ type: "fixed", before: { t: [0.1, 0, 0] }, after: { t: [0.1, 0.02, 0] } });
  near(positions(scene, [0, 0], "before", 1)[2], [2.1, 0, 0]);
  near(positions(scene, [0, 0], "after", 1)[2], [2.1, 0.02, 0]);
  near(positions(scene, [0, 0], "after", 10)[2], [2.1, 0.2, 0]);
});
test("from another base, all links have the same places relative to each other", () => {
  const q = [0.3, -0.7], module = pageWith({});
  const poses = (base) => {
    const page = pageWith({ ...arm(), base });
    return page.linkPoses(page.readScene(), q, "after", 1);
  };
  const [from_a, from_c] = [poses(0), poses(2)];
  [0, 1, 2].forEach((i) => near(module.compose(from_a[2], from_c[i]).slice(0, 3), from_a[i].slice(0, 3)));
});
test("links that no joint connects to the base have no pose", () => {
  assert.equal(positions(arm(), [0, 0])[3], undefined);
});
test("the worst samples come first: bad ones, then by their errors", () => {
  const sample = (number, error, bad = false) =>
    ({ number, bad, features: [{ after: [[0, 0, 0], [error, 0, 0]] }, { after: [[0, 0, null], [9, 0, 0]] }] });
  const scene = { samples: [sample(1, 0.1), sample(2, 0.3), sample(3, 0.05, true), null] };
  assert.deepEqual(pageWith(scene).readScene().ranked, [2, 1, 0, 3]);
});
test("a correction is described in millimetres and degrees", () => {
  const { correctionText } = pageWith({});
  assert.equal(correctionText({ after: { t: [0.003, 0, 0.004], r: [0, 0.1, 0] } }), "5.0 mm, 5.73°");
  assert.equal(correctionText({ type: "prismatic", after: { offset: -0.001 } }), "1.0 mm");
  assert.equal(correctionText({ before: { offset: 0.1 }, after: { offset: 0.1 } }), "");
});
test("a cloud on the surface is read as points with distances; its scale ends at five times their median", () => {
  const points = Buffer.from(new Uint16Array([0, 10000, 20, 40, 15000, 0, 5, 60]).buffer).toString("base64");
  const module = pageWith({ samples: [{ matched: { after: { low: [-1, 0, 2], step: 1e-4, points } } }, {}] });
  const { samples, farOff } = module.readScene();
  near(samples[0].matched.after.points[0], [-1, 1, 2.002]);
  near(samples[0].matched.after.points[1], [0.5, 0, 2.0005]);
  near(samples[0].matched.after.distances, [0.004, 0.006]);
  assert.equal(samples[0].matched.before, null);
  assert.equal(samples[1].matched.after, null);
  assert.equal(farOff, 0.02);
});
