// What the 3-D view of a report shows: reads the scene, poses and kinematics.
// SPDX-License-Identifier: Apache-2.0
//
// Scene: metres and radians; pose = [x,y,z, qx,qy,qz,qw]; any key may be absent, any number null.
// { "base": 0,                        index of the link in whose frame all is drawn
//   "links": [{"name", "visuals": [{"kind": "box" | "cylinder" | "sphere" | "mesh", "pose", "color": [r,g,b],
//              "size": [x,y,z] | "radius", "length" | "radius" | "mesh": 0, "scale": [x,y,z]}]}],
//   "joints": [{"name", "type", "parent": 0, "child": 1, "origin": pose, "axis": [3], "virtual": false,
//               "drive": [i, multiplier, offset]   position = multiplier q[i] + offset; i = -1: offset
//               "before": {"t": [3], "r": [3], "offset": 0}, "after": ...  corrections; absent: none}],
//   "meshes": [{"vertices": float32 xyz, "triangles": uint32 abc}],       base64, little-endian
//   "samples": [{"number": 1, "source": "a.yaml:12", "bad": false, "left_out": false, "note", "q": [...],
//                "times": 3.2   of sigma, its worst feature: ranks samples (all have it, or none: then by
//                               the largest distance of "after")
//                "cloud": base64 float32 xyz in the frame of link "cloud_link": 3,
//                "matched": {"before": {"low": [3], "step": 0.0001, "points": base64 uint16 x y z distance}, "after"},
//                               points on the surface of the robot: low + step xyz in the base, distances step d
//                "features": [{"block": 0, "name", "error": "3.2 mm",
//                              "before": [measured, predicted], "after": ...}]}],   points in the base
//   "blocks": [name], "cameras": [{"name", "link", "pose", "width", "height", "fx", "fy", "cx", "cy"}],
//   "workspace": {"unit": "mm", "points": [[x,y,z, error in that unit]]} }
const kinecalScene = (() => {
"use strict";

// Vectors, quaternions, poses.
const IDENTITY = [0, 0, 0, 0, 0, 0, 1];
const numbers = (list, n) =>
  Array.isArray(list) && list.length >= n && list.slice(0, n).every(Number.isFinite);
const vector = (list) => (numbers(list, 3) ? list.slice(0, 3) : [0, 0, 0]);
const poseOf = (list) => (numbers(list, 7) ? list : IDENTITY);
const number = (value, otherwise = 0) => (Number.isFinite(value) ? value : otherwise);
const add = (a, b) => a.map((v, i) => v + b[i]);
const subtract = (a, b) => a.map((v, i) => v - b[i]);
const times = (a, k) => a.map((v) => v * k);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(...a);
const rotate = (q, v) => {
  const u = q.slice(-4, -1), t = times(cross(u, v), 2);
  return add(add(v, times(t, q[q.length - 1])), cross(u, t));
};
/// The pose a · b.
function compose(a, b) {
  const [ax, ay, az, aw] = a.slice(3), [bx, by, bz, bw] = b.slice(3);
  return [...add(a.slice(0, 3), rotate(a, b.slice(0, 3))),
    aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz];
}
function inverse(a) {
  const q = [-a[3], -a[4], -a[5], a[6]];
  return [...times(rotate(q, a.slice(0, 3)), -1), ...q];
}
const at = (pose, point) => add(pose.slice(0, 3), rotate(pose, point));
/// The pose of a translation and a rotation vector.
function moved(translation, rotation) {
  const angle = norm(rotation), s = angle > 1e-12 ? Math.sin(angle / 2) / angle : 0.5;
  return [...translation, ...times(rotation, s), Math.cos(angle / 2)];
}
/// Rotation that takes the z axis to a direction.
function alongZ(direction) {
  const n = norm(direction), c = direction[2] / n, axis = cross([0, 0, 1], direction);
  const s = norm(axis), angle = Math.acos(Math.max(-1, Math.min(1, c)));
  return moved([0, 0, 0], s > 1e-12 * n ? times(axis, angle / s) : [angle, 0, 0]).slice(3);
}
/// Centre and radius of points.
function ball(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const p of points) {
    p.forEach((v, i) => {
      low[i] = Math.min(low[i], v);
      high[i] = Math.max(high[i], v);
    });
  }
  if (!(low[0] <= high[0])) return { middle: [0, 0, 0.5], radius: 0.5, low: [0, 0, 0] };
  return { middle: times(add(low, high), 0.5), radius: Math.max(norm(subtract(high, low)) / 2, 1e-3),
    low };
}
/// 4x4 matrix by columns.
function matrix(pose, scale = [1, 1, 1]) {
  const x = rotate(pose, [scale[0], 0, 0]), y = rotate(pose, [0, scale[1], 0]);
  const z = rotate(pose, [0, 0, scale[2]]);
  return new Float32Array([...x, 0, ...y, 0, ...z, 0, pose[0], pose[1], pose[2], 1]);
}
const bytes = (base64) => {
  try {
    return Uint8Array.from(atob(base64 ?? ""), (c) => c.charCodeAt(0)).buffer;
  } catch {
    return new ArrayBuffer(0);
  }
};
const words = (Type, base64) => {
  const buffer = bytes(base64);
  return new Type(buffer, 0, Math.floor(buffer.byteLength / Type.BYTES_PER_ELEMENT));
};
const median = (list) => list.slice().sort((a, b) => a - b)[Math.floor((list.length - 1) / 2)];
/// Points in the base with their distances from the surface of the robot; null if there are none.
function matchedOf(cloud) {
  const { low, step, points } = cloud ?? {};
  if (!numbers(low, 3) || !(step > 0)) return null;
  const counts = words(Uint16Array, points), of = { points: [], distances: [] };
  for (let i = 0; i + 3 < counts.length; i += 4) {
    of.points.push(low.map((v, k) => v + step * counts[i + k]));
    of.distances.push(step * counts[i + 3]);
  }
  return of.points.length ? { ...of, median: median(of.distances) } : null;
}

// Kinematics.
const parts = (correction) => ({ t: vector(correction?.t), r: vector(correction?.r),
  offset: number(correction?.offset) });
/// The correction of a joint: before, or after with its difference to before times `factor`.
function correction(joint, which, factor) {
  const a = parts(joint.before), b = parts(joint.after);
  if (which === "before") return a;
  const grow = (u, v) => add(u, times(subtract(v, u), factor));
  return { t: grow(a.t, b.t), r: grow(a.r, b.r),
    offset: a.offset + factor * (b.offset - a.offset) };
}
function isCorrected(joint) {
  const a = parts(joint.before), b = parts(joint.after);
  return norm(subtract(a.t, b.t)) + norm(subtract(a.r, b.r)) + Math.abs(a.offset - b.offset) > 0;
}
/// "1.15°", "7.8 mm, 1.54°": by how much the calibration moved a joint or frame.
function correctionText(joint) {
  const [a, b] = [parts(joint.before), parts(joint.after)], slides = joint.type === "prismatic";
  const offset = Math.abs(b.offset - a.offset);
  const metres = norm(subtract(b.t, a.t)) + (slides ? offset : 0);
  const turned = norm(subtract(b.r, a.r)) + (slides ? 0 : offset);
  return [metres > 0 ? `${(1000 * metres).toFixed(1)} mm` : "",
    turned > 0 ? `${(turned * 180 / Math.PI).toFixed(2)}°` : ""].filter(Boolean).join(", ");
}
/// Pose of the child in the parent.
function jointPose(joint, q, which, factor) {
  const c = correction(joint, which, factor);
  const placed = compose(poseOf(joint.origin), moved(c.t, c.r));
  const [index, multiplier, offset] = joint.drive ?? [-1, 1, 0];
  const position = number(multiplier, 1) * number(q[index]) + number(offset) + c.offset;
  const axis = vector(joint.axis), length = norm(axis);
  if (length === 0) return placed;
  const motion = times(axis, position / length);
  if (joint.type === "prismatic") return compose(placed, moved(motion, [0, 0, 0]));
  const turns = joint.type === "revolute" || joint.type === "continuous";
  return turns ? compose(placed, moved([0, 0, 0], motion)) : placed;
}
/// Joints in the order in which links are reached from the base: [{joint, from, to, up}].
function walk(scene) {
  const order = [], reached = new Set([scene.base]), waiting = [scene.base];
  while (waiting.length) {
    const from = waiting.shift();
    for (const joint of scene.joints) {
      const up = joint.child === from, to = up ? joint.parent : joint.child;
      if ((!up && joint.parent !== from) || reached.has(to) || !scene.links[to]) continue;
      reached.add(to);
      waiting.push(to);
      order.push({ joint, from, to, up });
    }
  }
  return order;
}
/// Pose of each link in the base; undefined for links that are not connected to it.
function linkPoses(scene, q, which, factor) {
  const poses = [];
  poses[scene.base] = IDENTITY;
  for (const { joint, from, to, up } of scene.order) {
    const step = jointPose(joint, q, which, factor);
    poses[to] = compose(poses[from], up ? inverse(step) : step);
  }
  return poses;
}

// The scene as it is used.
const list = (value) => (Array.isArray(value) ? value.map((v) => v ?? {}) : []);
function pairOf(pair) {
  return numbers(pair?.[0], 3) && numbers(pair?.[1], 3) ? [vector(pair[0]), vector(pair[1])] : null;
}
const length = (pair) => (pair ? norm(subtract(pair[0], pair[1])) : -1);
/// The next of 1, 2, 5, 10, 20 and so on.
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value)), rest = value / power;
  return power * (rest <= 1 ? 1 : rest <= 2 ? 2 : rest <= 5 ? 5 : 10);
}
function readScene() {
  const scene = JSON.parse(document.getElementById("scene").textContent);
  for (const key of ["links", "joints", "meshes", "samples", "blocks", "cameras"]) {
    scene[key] = list(scene[key]);
  }
  scene.base ??= 0;
  scene.order = walk(scene);
  scene.corrected = scene.order.map((step) => step.joint).filter(isCorrected);
  for (const sample of scene.samples) {
    sample.q = list(sample.q);
    sample.features = list(sample.features).map((f) =>
      ({ ...f, before: pairOf(f.before), after: pairOf(f.after) }));
    sample.matched = { before: matchedOf(sample.matched?.before), after: matchedOf(sample.matched?.after) };
    sample.worst = sample.features.reduce(
      (worst, f) => (length(f.after) > length(worst?.after) ? f : worst), null);
  }
  const rank = (s) => number(s.times, length(s.worst?.after));
  scene.ranked = scene.samples.map((s, i) => i).sort((a, b) => {
    const [s, t] = [scene.samples[a], scene.samples[b]];
    return (t.bad === true) - (s.bad === true) || rank(t) - rank(s) || a - b;
  });
  // Where the colours of distances end, metres: few are farther after the calibration.
  const matched = scene.samples.map((s) => s.matched.after?.median).filter((v) => v !== undefined);
  scene.farOff = matched.length ? roundUp(Math.max(5 * median(matched), 1e-4)) : 0;
  scene.workspacePoints = list(scene.workspace?.points).filter((p) => numbers(p, 4));
  return scene;
}

return { IDENTITY, numbers, number, poseOf, add, subtract, times, dot, norm, at, ball, compose, alongZ, matrix,
  words, list, correctionText, linkPoses, readScene };
})();
