// The robot in 3-D: interactive view of a calibration report; needs scene.js and painter.js before it.
// SPDX-License-Identifier: Apache-2.0
//
// The page holds, before the scripts,
//   <figure id="view3d" class="view3d">
//     <canvas aria-label="Robot in 3-D"></canvas>   hidden until this script draws on it
//     <div class="controls"></div>                  this script fills it
//     <div class="static"><svg ...></svg></div>     shown without script or WebGL, hidden otherwise
//     <figcaption>...</figcaption>
//   </figure>
//   a script element of type "application/json" and id "scene": see scene.js
// and anywhere elements with data-sample="12" (number, from 1): a click on one selects sample 12 and shows
// the view; <a href="#sample=12"> does the same by keyboard, and in the address of the page.
// When the user has selected a sample, `document` gets the event "kinecal:sample" with detail {number}.
// The page's policy needs img-src data:, for printing.  Scripts are inlined as they are, in the order scene,
// painter, report, view3d; so none of them may hold an opening or closing tag of a script.
(() => {
"use strict";
const { numbers, number, poseOf, add, subtract, times, dot, norm, at, ball, compose, alongZ, words, list,
  correctionText, linkPoses, readScene } = kinecalScene;
const { Painter } = kinecalPainter;

const figure = document.getElementById("view3d");
const canvas = figure?.querySelector("canvas");
const panel = figure?.querySelector(".controls");
if (!canvas || !panel || !document.getElementById("scene")) return;

/// An element with attributes and children; strings become text, never markup.
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== false) made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children);
  return made;
}

const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
const scene = readScene();
const { samples } = scene;
let painter;
try {
  painter = gl && new Painter(gl, scene.meshes);
} catch { /* its shaders do not run here */ }
if (!painter) {
  panel.before(element("p", { class: "note" }, "The robot in 3-D is not shown, because this browser has no " +
    "WebGL 2; the charts and tables hold all figures."));
  return;
}

const state = { sample: 0, factor: 1, ranked: -1,
  show: { after: true, before: true, points: true, frames: true, cameras: true, workspace: false } };
const here = () => samples[state.sample] ?? { q: [], features: [] };

// Colours follow the theme of the page.
function colour(name) {
  const text = getComputedStyle(figure).getPropertyValue(`--${name}`).trim();
  const value = /^#[0-9a-f]{6}$/i.test(text) ? parseInt(text.slice(1), 16) : 0x808080;
  return [value >> 16, (value >> 8) & 255, value & 255].map((v) => v / 255);
}
/// Dark blue over green to yellow: lightness rises evenly, and all eyes see the order.
const SCALE = [[0.27, 0.0, 0.33], [0.23, 0.32, 0.55], [0.13, 0.57, 0.55], [0.37, 0.79, 0.38],
  [0.99, 0.91, 0.14]];
function scaleColour(share) {
  const place = Math.max(0, Math.min(1, share)) * (SCALE.length - 1);
  const i = Math.min(Math.floor(place), SCALE.length - 2);
  return add(SCALE[i], times(subtract(SCALE[i + 1], SCALE[i]), place - i));
}

// What is drawn.
/// The visuals and bones of a robot: [{shape, pose, scale, color}].
/// @param plain  colour of what has none of its own
function solidsOf(poses, plain) {
  const solids = [], { shapes, meshes } = painter;
  scene.links.forEach((link, i) => {
    if (!poses[i]) return;
    for (const v of list(link.visuals)) {
      const scales = { box: v.size, cylinder: [v.radius, v.radius, v.length],
        sphere: [v.radius, v.radius, v.radius], mesh: v.scale ?? [1, 1, 1] };
      const shape = v.kind === "mesh" ? meshes[v.mesh] : shapes[v.kind], scale = scales[v.kind];
      if (!shape || !numbers(scale, 3) || scale.some((s) => s === 0)) continue;
      solids.push({ shape, pose: compose(poses[i], poseOf(v.pose)), scale,
        color: numbers(v.color, 3) ? v.color.slice(0, 3) : plain });
    }
  });
  return [...solids, ...bonesOf(poses).map((bone) => ({ ...bone, color: plain }))];
}
const tinted = (solids, color, share) =>
  solids.map((s) => ({ ...s, color: add(times(s.color, 1 - share), times(color, share)) }));
/// Rods between the joints of links that have no visuals, and a ball at each of these joints; thinner ones
/// to frames that do not move.
function bonesOf(poses) {
  const bones = [], { shapes } = painter;
  for (const { joint } of scene.order) {
    const parent = scene.links[joint.parent];
    if (joint.virtual || list(parent.visuals).length) continue;
    const thick = scene.size * (joint.type === "fixed" ? 0.007 : 0.018);
    const from = poses[joint.parent].slice(0, 3), to = poses[joint.child].slice(0, 3);
    const along = subtract(to, from), far = norm(along);
    if (far > 1e-3) {
      bones.push({ shape: shapes.cylinder, scale: [thick, thick, far],
        pose: [...times(add(from, to), 0.5), ...alongZ(along)] });
    }
    if (far <= 1e-3 && joint.type === "fixed") continue;
    bones.push({ shape: shapes.sphere, scale: [1.7 * thick, 1.7 * thick, 1.7 * thick],
      pose: [...to, 0, 0, 0, 1] });
  }
  return bones;
}
const line = (lines, from, to, color, alpha, width) =>
  lines.push(...from, ...to, ...color, alpha, width * ratio());
const dotAt = (points, place, color, alpha, size) =>
  points.push(...place, ...color, alpha, size * ratio());
const ratio = () => canvas.width / Math.max(1, canvas.clientWidth);

/// Distance of the lines of the grid: 0.1, 0.2, 0.5, 1 m and so on.
function gridStep() {
  const power = 10 ** Math.floor(Math.log10(scene.size / 3)), rest = scene.size / 3 / power;
  return power * (rest < 1.5 ? 1 : rest < 3.5 ? 2 : 5);
}
function gridLines(color) {
  const lines = [], step = gridStep(), count = 25;
  const [x, y] = [0, 1].map((i) => Math.round(scene.middle[i] / step) * step), z = scene.ground;
  for (let i = -count; i <= count; ++i) {
    const a = i * step, far = count * step, width = i % 5 === 0 ? 1.8 : 1;
    line(lines, [x + a, y - far, z], [x + a, y + far, z], color, 1, width);
    line(lines, [x - far, y + a, z], [x + far, y + a, z], color, 1, width);
  }
  return lines;
}
/// Axes of the frames that were corrected: x red, y green, z blue, as robots' viewers have them.
function frameLines(lines, poses, alpha, width) {
  const axes = [["axis-x", [1, 0, 0]], ["axis-y", [0, 1, 0]], ["axis-z", [0, 0, 1]]];
  for (const joint of scene.corrected) {
    const pose = poses[joint.child], far = 0.1 * scene.size;
    for (const [name, axis] of axes) {
      line(lines, pose.slice(0, 3), at(pose, times(axis, far)), colour(name), alpha, width);
    }
  }
}
/// Of each camera its place and the corners of its picture in some distance.
function frusta(poses) {
  const drawable = (c) => poses[c.link] && c.fx > 0 && c.fy > 0;
  return scene.cameras.filter(drawable).map((camera) => {
    const pose = compose(poses[camera.link], poseOf(camera.pose)), depth = 0.17 * scene.size;
    const corner = (u, v) => at(pose, [(u - number(camera.cx)) / camera.fx * depth,
      (v - number(camera.cy)) / camera.fy * depth, depth]);
    const w = number(camera.width), h = number(camera.height);
    return { eye: pose.slice(0, 3), corners: [corner(0, 0), corner(w, 0), corner(w, h), corner(0, h)] };
  });
}
function cameraLines(lines, poses, color, alpha) {
  for (const { eye, corners } of frusta(poses)) {
    corners.forEach((c, i) => {
      line(lines, eye, c, color, alpha, 1.5);
      line(lines, c, corners[(i + 1) % 4], color, alpha, i === 0 ? 3 : 1.5);  // thick: the image's top
    });
  }
}
/// Measured points as discs, predicted ones as rings, and lines between.
function drawFeatures(which, color) {
  const lines = [], points = [];
  for (const feature of here().features) {
    if (!feature[which]) continue;
    const [measured, predicted] = feature[which];
    line(lines, measured, predicted, color, 1, 2);
    dotAt(points, measured, color, 1, 9);
    dotAt(points, predicted, color, 1, -14);
  }
  painter.throughSolids((strength) => {
    painter.lines(lines, { strength });
    painter.points(points, { strength });
  });
}
/// The points of a cloud that are numbers, read once.
function cloudOf(sample) {
  if (!sample.cloud) return null;
  if (typeof sample.cloud === "string") {
    sample.cloud = Array.from(words(Float32Array, sample.cloud), (v) => v);
  }
  return sample.cloud;
}
function drawCloud(poses, color) {
  const cloud = cloudOf(here()), pose = poses[here().cloud_link ?? scene.base];
  if (!cloud || !pose) return;
  const points = new Float32Array(8 * Math.floor(cloud.length / 3)), size = 2.2 * ratio();
  for (let i = 0, j = 0; i + 2 < cloud.length; i += 3, j += 8) {
    points.set([cloud[i], cloud[i + 1], cloud[i + 2], ...color, 1, size], j);
  }
  painter.points(points, { pose });
}
/// The points that were compared with the surface of the robot, in the colours of their distances from it.
function drawMatched(which) {
  const cloud = here().matched?.[which], points = [];
  if (!cloud) return;
  cloud.points.forEach((p, i) => dotAt(points, p, scaleColour(cloud.distances[i] / scene.farOff), 1, 4.5));
  painter.throughSolids((strength) => painter.points(points, { strength }));
}
function drawWorkspace() {
  const points = [], [low, high] = scene.errors;
  for (const [x, y, z, error] of scene.workspacePoints) {
    dotAt(points, [x, y, z], scaleColour((error - low) / (high - low || 1)), 0.95, 7);
  }
  painter.points(points);
}

function draw() {
  const [ink, before, after] = [colour("ink"), colour("before"), colour("after")];
  const { show } = state, { q } = here(), exact = state.factor === 1;
  const was = linkPoses(scene, q, "before", 1), is = linkPoses(scene, q, "after", state.factor);
  painter.begin(cameraView(), colour("card"));
  painter.gl.depthMask(false);
  painter.lines(gridLines(colour("grid")), { fade: [...scene.middle, 5 * scene.size] });
  painter.gl.depthMask(true);
  if (show.after) painter.solids(solidsOf(is, colour("robot")), false);
  else if (show.before) painter.solids(tinted(solidsOf(was, colour("robot")), before, 0.5), false);
  if (show.points && exact) {
    if (show.after) drawCloud(is, after);
    else if (show.before) drawCloud(was, ink);
    if (show.after || show.before) drawMatched(show.after ? "after" : "before");
  }
  if (show.workspace) drawWorkspace();
  const lines = [];
  if (show.cameras && show.before && show.after) cameraLines(lines, was, before, 0.8);
  if (show.cameras) cameraLines(lines, show.after ? is : was, ink, 0.7);
  painter.lines(lines);
  const axes = [];
  if (show.frames && show.before && show.after) frameLines(axes, was, 0.35, 2);
  if (show.frames) frameLines(axes, show.after ? is : was, 1, 2.5);
  painter.throughSolids((strength) => painter.lines(axes, { strength }));
  if (show.after && show.before) {
    painter.ghosts(tinted(solidsOf(was, before), before, 1));
  }
  if (show.points && exact) {
    if (show.before) drawFeatures("before", before);
    if (show.after) drawFeatures("after", here().left_out ? colour("bad") : after);
  }
  placeLabels(show.frames ? (show.after ? is : was) : []);
}

// The viewer: looks at `target` from `distance`, turned by yaw about z and lifted by pitch.
const FIELD = 0.6;  // vertical field of view, radians
const view = { yaw: -0.9, pitch: 0.35, distance: 3, target: [0, 0, 0] };
function viewAxes({ yaw, pitch } = view) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return { right: [-sy, cy, 0], up: [-sp * cy, -sp * sy, cp], back: [cp * cy, cp * sy, sp] };
}
function cameraView() {
  const { right, up, back } = viewAxes(), eye = add(view.target, times(back, view.distance));
  const near = view.distance / 50, far = view.distance * 20 + 20 * scene.size;
  const f = 1 / Math.tan(FIELD / 2), aspect = canvas.width / canvas.height;
  const rows = [times([...right, -dot(right, eye)], f / aspect), times([...up, -dot(up, eye)], f),
    times([...back, -dot(back, eye)], -(far + near) / (far - near)), times([...back, -dot(back, eye)], -1)];
  rows[2][3] -= (2 * far * near) / (far - near);
  const camera = new Float32Array(16);
  rows.forEach((row, i) => row.forEach((v, j) => { camera[4 * j + i] = v; }));
  return { camera, eye, near, viewport: [canvas.width, canvas.height] };
}
function robotPoints() {
  const poses = linkPoses(scene, here().q, "after", 1);
  const points = poses.filter(Boolean).map((p) => p.slice(0, 3));
  for (const { shape, pose, scale } of solidsOf(poses, [0, 0, 0])) {
    for (let k = 0; k < 8; ++k) {
      const corner = [0, 1, 2].map((i) => ((k >> i) & 1 ? shape.high : shape.low)[i] * scale[i]);
      points.push(at(pose, corner));
    }
  }
  return points;
}
const featurePoints = () =>
  [...here().features.flatMap((f) => f.after ?? []), ...here().matched?.after?.points ?? []];
/// The view from a direction that shows points as large as the picture allows.
function fitted(points, yaw = view.yaw, pitch = view.pitch) {
  const { right, up, back } = viewAxes({ yaw, pitch }), tangent = 0.9 * Math.tan(FIELD / 2);
  const aspect = canvas.width / canvas.height;
  const seen = points.map((p) => [dot(p, right), dot(p, up), dot(p, back)]);
  const { middle: [x, y, z], radius } = ball(seen);
  const distance = seen.reduce((most, p) => Math.max(most, p[2] - z +
    Math.max(Math.abs(p[0] - x) / aspect, Math.abs(p[1] - y)) / tangent), 1.5 * radius);
  return { yaw, pitch, distance, target: add(add(times(right, x), times(up, y)), times(back, z)) };
}
function shown() {
  const cameras = frusta(linkPoses(scene, here().q, "after", 1)).flatMap((f) => f.corners);
  return [...robotPoints(), ...featurePoints(), ...cameras];
}
/// Whether a point is not in the picture.
function leaves(points) {
  const { right, up, back } = viewAxes(), eye = add(view.target, times(back, view.distance));
  const tangent = Math.tan(FIELD / 2), aspect = canvas.width / canvas.height;
  return points.some((p) => {
    const ray = subtract(p, eye), depth = -dot(ray, back);
    return !(Math.abs(dot(ray, up)) < depth * tangent && Math.abs(dot(ray, right)) < depth * tangent * aspect);
  });
}
const VIEWS = {
  Reset: () => fitted(shown(), -0.9, 0.35),
  Front: () => fitted(shown(), 0, 0),
  Side: () => fitted(shown(), -Math.PI / 2, 0),
  Top: () => fitted(shown(), -Math.PI, Math.PI / 2),
  Points: () => {
    const points = featurePoints(), view = fitted(points.length ? points : shown());
    return { ...view, distance: 2 * view.distance };
  },
};
const still = matchMedia("(prefers-reduced-motion: reduce)");
let flight = 0;
/// Turns the viewer to another view: in a third of a second, or at once for who does not want motion.
function look(goal) {
  const from = structuredClone(view), began = performance.now(), mine = ++flight;
  if (goal.yaw !== undefined) goal.yaw += 2 * Math.PI * Math.round((from.yaw - goal.yaw) / (2 * Math.PI));
  const mix = (a, b, s) => (Array.isArray(a) ? a.map((v, i) => mix(v, b[i], s)) : a + (b - a) * s);
  const step = (now) => {
    if (mine !== flight) return;
    const s = still.matches ? 1 : Math.max(0, Math.min(1, (now - began) / 330)), smooth = s * s * (3 - 2 * s);
    for (const key of Object.keys(goal)) view[key] = mix(from[key], goal[key], smooth);
    redraw();
    if (s < 1) requestAnimationFrame(step);
  };
  step(began);
}
let asked = false;
function redraw() {
  if (asked) return;
  asked = true;
  requestAnimationFrame(() => {
    asked = false;
    if (!gl.isContextLost()) draw();
  });
}
function turn(yaw, pitch) {
  ++flight;
  view.yaw += yaw;
  view.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, view.pitch + pitch));
  redraw();
}
/// @param right, up  in pixels of the page
function pan(right, up) {
  ++flight;
  const scale = (2 * view.distance * Math.tan(FIELD / 2)) / Math.max(1, canvas.clientHeight);
  const axes = viewAxes();
  view.target = add(view.target, add(times(axes.right, right * scale), times(axes.up, up * scale)));
  redraw();
}
function zoom(factor) {
  ++flight;
  view.distance = Math.max(0.02 * scene.size, Math.min(30 * scene.size, view.distance * factor));
  redraw();
}

// Names of corrected frames over the picture; a name that would cover another one is left out.
const labels = element("div", { class: "labels", "aria-hidden": "true" });
function placeLabels(poses) {
  const { camera } = cameraView(), placed = [];
  const named = scene.corrected.filter((joint) => poses[joint.child]).map((joint) =>
    ({ name: shortened(joint.name ?? "", 24), value: correctionText(joint), place: poses[joint.child] }));
  labels.replaceChildren(...named.flatMap(({ name, value, place }) => {
    const [x, y, w] = [0, 1, 3].map((i) =>
      camera[i] * place[0] + camera[4 + i] * place[1] + camera[8 + i] * place[2] + camera[12 + i]);
    const left = (0.5 + x / w / 2) * canvas.clientWidth, top = (0.5 - y / w / 2) * canvas.clientHeight;
    const width = 7 * (name.length + 1 + value.length) + 16;
    const covers = placed.some(([l, t, s]) =>
      left < l + s && l < left + width && Math.abs(top - t) < 17);
    if (w <= 0 || left < 0 || top < 10 || left + width > canvas.clientWidth || covers ||
        top > canvas.clientHeight - 10) return [];
    placed.push([left, top, width]);
    const label = element("span", {}, element("bdi", {}, name), ` ${value}`);
    label.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px)`;
    return [label];
  }));
}

// Controls.
const badge = element("div", { class: "badge bad" });
const status = element("p", { class: "status", role: "status", id: "view3d-status" });
const slider = element("input", { type: "range", min: 0, max: Math.max(0, samples.length - 1), step: 1,
  value: 0, id: "view3d-sample" });
const factor = element("input", { type: "range", min: 1, max: 50, step: 1, value: 1, id: "view3d-factor" });
const factorText = element("output", { for: "view3d-factor" }, "1×");

/// A text of at most so many characters, shortened in the middle.
function shortened(text, most) {
  const all = [...text], head = Math.ceil((most - 1) / 2);
  return all.length > most ? `${all.slice(0, head).join("")}…${all.slice(head + 1 - most).join("")}` : text;
}
/// Text of a file inside a sentence: letters that run from right to left do not turn the rest of it.
function quoted(text, most = 80) {
  const short = shortened(text.replace(/\S{81,}/g, (word) => shortened(word, 80)), most);
  return /^[ -~…]*$/.test(short) ? short : `\u2068${short}\u2069`;
}
function describe(sample) {
  let text = `Sample ${sample.number ?? state.sample + 1}`;
  if (sample.source) text += `, ${quoted(sample.source)}`;
  if (sample.bad) text += sample.left_out ? ", left out" : ", bad";
  if (sample.note) text += `: ${quoted(sample.note, 400)}`;
  const { worst } = sample;
  if (worst) {
    const parts = [scene.blocks[worst.block], worst.name, worst.error].filter(Boolean);
    text += `. Largest error: ${parts.map((part) => quoted(part)).join(", ")}`;
  }
  const { before, after } = sample.matched ?? {};
  if (after) {
    const mm = (cloud) => `${Number((1000 * cloud.median).toPrecision(3))} mm`;
    text += `. Points off the robot by ${before ? `${mm(before)} before, ` : ""}${mm(after)} after (median)`;
  }
  return `${text.replace(/[.]$/, "")}.`;
}
/// Shows a sample.  @param ranked  its place among the worst ones, if it was chosen by that
function select(index, ranked = -1) {
  if (!samples[index]) return;
  show(index, ranked);
  document.dispatchEvent(new CustomEvent("kinecal:sample",
    { detail: { number: here().number ?? index + 1 } }));
}
function show(index, ranked = -1) {
  state.sample = index;
  state.ranked = ranked;
  const sample = here(), text = describe(sample);
  slider.value = index;
  slider.setAttribute("aria-valuetext", text);
  status.textContent = ranked < 0 ? text : `${text} Number ${ranked + 1} of the worst.`;
  status.classList.toggle("bad", sample.bad === true);
  badge.textContent = sample.left_out ? `sample ${sample.number ?? index + 1}: left out` : "";
  redraw();
  const points = featurePoints();
  if (leaves(points.length ? points : robotPoints())) look(fitted(shown()));
}
function selectWorst(step) {
  const count = samples.length;
  const rank = state.ranked < 0 ? (step > 0 ? 0 : count - 1) : (state.ranked + step + count) % count;
  select(scene.ranked[rank], rank);
}
/// Selects the sample of a number and scrolls to the view.
function selectNumber(wanted) {
  const index = samples.findIndex((s, i) => (s.number ?? i + 1) === wanted);
  if (index >= 0) select(index);
  else status.textContent = `Sample ${wanted} is not among the ${samples.length} that this page shows in 3-D.`;
  figure.scrollIntoView({ behavior: still.matches ? "instant" : "smooth", block: "nearest" });
}
function setFactor(value) {
  state.factor = value;
  factorText.textContent = `${value}×`;
  factor.setAttribute("aria-valuetext", `${value} times`);
  figure.classList.toggle("exaggerated", value !== 1);
  redraw();
}
const button = (text, action, name) => {
  const made = element("button", { type: "button", "aria-label": name ?? false }, text);
  made.addEventListener("click", action);
  return made;
};
function toggle(key, text) {
  const box = element("input", { type: "checkbox", name: key });
  box.checked = state.show[key];
  box.addEventListener("change", () => {
    state.show[key] = box.checked;
    figure.classList.toggle(`shows-${key}`, box.checked);
    redraw();
  });
  figure.classList.toggle(`shows-${key}`, state.show[key]);
  return element("label", {}, box, text);
}
function fillPanel() {
  const row = (...children) => element("div", { class: "row" }, ...children);
  const label = (id, text) => element("label", { for: id }, text);
  if (samples.length > 1) {
    panel.append(row(label("view3d-sample", "Sample"), slider,
      button("‹ Worst", () => selectWorst(-1), "Previous worst sample"),
      button("Worst ›", () => selectWorst(1), "Next worst sample")));
  }
  if (scene.corrected.length) {
    panel.append(row(label("view3d-factor", "Exaggeration"), factor, factorText));
  }
  const has = { points: samples.some((s) => s.features.length || s.cloud || s.matched.after),
    frames: scene.corrected.length, cameras: scene.cameras.some((c) => c.fx > 0 && c.fy > 0),
    workspace: scene.workspacePoints.length };
  const names = { after: "After", before: "Before", points: "Points", frames: "Frames",
    cameras: "Cameras", workspace: "Workspace" };
  const toggles = Object.keys(names).filter((key) => has[key] ?? true).map((key) =>
    toggle(key, names[key]));
  panel.append(element("div", { class: "row toggles", role: "group", "aria-label": "Shown" }, ...toggles));
  panel.append(element("div", { class: "row views", role: "group", "aria-label": "View" },
    ...Object.keys(VIEWS).filter((name) => name !== "Points" || has.points).map((name) =>
      button(name, () => look(VIEWS[name]()), `View: ${name}`))));
  slider.addEventListener("input", () => select(Number(slider.value)));
  factor.addEventListener("input", () => setFactor(Number(factor.value)));
}
/// What the colours mean, in the corner of the picture.
function legend() {
  const entry = (kind, text) =>
    element("span", { class: kind }, element("i", { class: "sign", "aria-hidden": "true" }), text);
  const made = element("div", { class: "legend" }, entry("before", "before"), entry("after", "after"),
    ...samples.some((s) => s.features.length) ? [entry("measured", "measured"), entry("predicted", "predicted")] : [],
    element("span", { class: "grid" }, `grid ${Number(gridStep().toPrecision(1))} m`));
  const errors = scene.workspacePoints.map((p) => p[3]);
  scene.errors = errors.reduce(([a, b], e) => [Math.min(a, e), Math.max(b, e)], [Infinity, -Infinity]);
  const scale = (kind, low, high) => {
    const bar = element("i", { class: "bar", "aria-hidden": "true" });
    const css = SCALE.map((c) => `rgb(${c.map((v) => Math.round(255 * v)).join(" ")})`);
    bar.style.background = `linear-gradient(to right, ${css.join(", ")})`;
    made.append(element("span", { class: kind }, low, bar, high));
  };
  if (errors.length) {
    const [low, high] = scene.errors.map((e) => Number(e.toPrecision(2)));
    scale("workspace", `predicted error ${low}`, `${high} ${scene.workspace.unit ?? ""}`);
  }
  if (scene.farOff) scale("matched", "points off the robot 0", `${Number((1000 * scene.farOff).toPrecision(2))} mm`);
  return made;
}

// Mouse, fingers, keys.
const fingers = new Map();
function pointerMoved(event) {
  const last = fingers.get(event.pointerId);
  if (!last) return;
  const now = [event.clientX, event.clientY], [dx, dy] = subtract(now, last);
  if (fingers.size === 1) {
    if (event.buttons & 6 || event.shiftKey) pan(-dx, dy);
    else turn(-dx * 0.008, dy * 0.008);
  } else {
    const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
    pan(-dx / 2, dy / 2);
    zoom(Math.max(1, norm(subtract(last, other))) / Math.max(1, norm(subtract(now, other))));
  }
  fingers.set(event.pointerId, now);
}
const KEYS = { ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0),
  ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1), "+": () => zoom(0.85),
  "=": () => zoom(0.85), "-": () => zoom(1 / 0.85), Home: () => look(VIEWS.Reset()),
  PageUp: () => select(state.sample - 1), PageDown: () => select(state.sample + 1) };
const SHIFTED = { ArrowLeft: () => pan(-30, 0), ArrowRight: () => pan(30, 0),
  ArrowUp: () => pan(0, 30), ArrowDown: () => pan(0, -30) };
function listen() {
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", pointerMoved);
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  // The wheel scrolls the page until the picture was clicked.
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    zoom(Math.exp(Math.max(-0.5, Math.min(0.5, event.deltaY * 0.002))));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const act = (event.shiftKey ? SHIFTED : {})[event.key] ?? KEYS[event.key];
    if (!act || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    act();
  });
  document.addEventListener("click", (event) => {
    const wanted = event.target.closest?.("[data-sample]")?.getAttribute("data-sample");
    if (wanted && getSelection().isCollapsed) selectNumber(Number(wanted));  // not while copying text
  });
  addEventListener("hashchange", fromHash);
  addEventListener("beforeprint", drawOnPaper);
  addEventListener("afterprint", () => {
    paper.remove();
    resize();
  });
  document.addEventListener("kinecal:theme", redraw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => {
    painter = new Painter(gl, scene.meshes);
    redraw();
  });
}
function fromHash() {
  const wanted = /^#sample=(\d+)$/.exec(location.hash);
  if (wanted) selectNumber(Number(wanted[1]));
}
function resize() {
  const sharp = Math.min(devicePixelRatio || 1, 3);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((v) =>
    Math.max(1, Math.round(v * sharp)));
  if (canvas.width === width && canvas.height === height) return;
  [canvas.width, canvas.height] = [width, height];
  draw();  // at once: a canvas is empty when its size has changed
}

/// Browsers print the last picture that was on the screen, which may be dark or coarse; this one is a copy.
const paper = element("img", { class: "paper", alt: "", decoding: "sync" });
function drawOnPaper() {
  const finer = Math.max(1, 2000 / canvas.width);
  [canvas.width, canvas.height] = [canvas.width, canvas.height].map((v) => Math.round(v * finer));
  draw();
  paper.src = canvas.toDataURL();
  canvas.after(paper);
}

function begin() {
  const stage = element("div", { class: "stage" });
  canvas.replaceWith(stage);
  stage.append(canvas, labels);
  panel.before(status);
  for (const [name, value] of Object.entries({ tabindex: 0, role: "application",
    "aria-roledescription": "3-D view", "aria-describedby": "view3d-status view3d-hint" })) {
    canvas.setAttribute(name, value);
  }
  if (!canvas.hasAttribute("aria-label")) canvas.setAttribute("aria-label", "Robot in 3-D");
  scene.size = 1;  // bones are as thick as the robot is large
  scene.size = ball(robotPoints()).radius;
  const { middle, low } = ball(robotPoints());
  scene.ground = Math.min(0, low[2]);
  scene.middle = [middle[0], middle[1], scene.ground];
  stage.append(legend(), badge);
  fillPanel();
  panel.append(element("p", { class: "hint", id: "view3d-hint" },
    element("span", { class: "for-mouse" }, "Drag to turn, with Shift to move. After a click the wheel zooms ",
      "and keys work: arrows, + and −, Page Up and Page Down for samples. "),
    element("span", { class: "for-fingers" }, "One finger turns, two move and zoom. "),
    "Measured and predicted points are drawn at 1× only.",
    samples.some((s) => s.matched.before) ? " Points of clouds are those after; without After, those before." : ""));
  figure.classList.add("live");
  resize();
  Object.assign(view, VIEWS.Reset());
  if (samples.length) show(0);
  listen();
  new ResizeObserver(resize).observe(canvas);
  fromHash();
}
begin();
})();
