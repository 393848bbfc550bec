// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The report's 3D view: a surface that turns, coloured by a field, deformed by a displacement, a
// swinging mode or a motion in time, with the arrows of the chosen load. Reads the page's #data; needs no network.
import * as THREE from "three";
import { Arrows } from "./arrows.mjs";
import { colourMap } from "./colour.mjs";
import { data } from "./data.mjs";
import { Detail } from "./detail.mjs";
import { Edges } from "./edges.mjs";
import { Creases } from "./creases.mjs";
import { Overlay } from "./overlay.mjs";
import { rankedRows, rowsByKey } from "./rows.mjs";
import { drawBar, makeBody, makeStage, number, paint } from "./stage.mjs";

function bytes(base64) {
  const text = atob(base64);
  const out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) out[i] = text.charCodeAt(i);
  return out.buffer;
}
const floats = (base64) => new Float32Array(bytes(base64));
const integers = (base64) => new Uint32Array(bytes(base64));

const rest = floats(data.positions);
const triangles = integers(data.triangles);
const fields = (data.fields || []).map((f) => ({ ...f, values: floats(f.values) }));
const motions = (data.displacements || []).map((d) => {
  const values = floats(d.values);
  let largest = 0;
  for (let i = 0; i < values.length; i += 3) largest = Math.max(largest, Math.hypot(values[i], values[i + 1], values[i + 2]));
  return { ...d, values, imaginary: d.imaginary && floats(d.imaginary), largest };
});

// Frame k of what has one for each instant of a motion in time; all that there is of what has a single one.
function frame(values, k, length) {
  return values.length > length ? values.subarray(k * length, (k + 1) * length) : values;
}

// ---- scene ---------------------------------------------------------------------------------------

const colour = colourMap(data.colours);
const view = document.getElementById("view");
const stage = makeStage(view, (now) => {
  overlay.place(position.array);
  detail.hold(state.playing);
  if (!state.playing) return;
  const { times, seconds } = motions[state.motion] || {};
  if (times) {
    const k = frameAt(times, ((now - state.since) / 1000 / seconds) % 1);
    return k === state.frame ? undefined : showFrame(k);
  }
  const angle = (now / 1000) * 2 * Math.PI * 0.7;
  state.behind = Math.cos(angle);
  // What lies on something rigid swings to one side.
  state.phase = data.rigid && motions[state.motion]?.kind === "load" ? (1 - state.behind) / 2 : Math.sin(angle);
  deform();
}, { onDemand: true });
const { scene, camera, controls, aim, start, touch } = stage;
const body = makeBody(new Float32Array(rest), triangles);
const position = body.geometry.getAttribute("position");
scene.add(body);
const detail = new Detail(stage, body);
// Lines may reach beyond the body: an obstacle does.
const seen = body.geometry.boundingBox.clone();
for (const line of data.lines || []) for (const [x, y, z] of line) seen.expandByPoint(new THREE.Vector3(x, y, z));
const extentAtRest = seen.getSize(new THREE.Vector3()).length();

// Scale 1: the largest displacement is 4 % of the diagonal of the box, of modes and what swings a tenth, which shows
// their form. A load that moves the body farther by itself is drawn as it is, up to a tenth. A motion in time is never drawn smaller than
// it is, since it may carry the body away: the view has room for it. Data may give the factor of scale 1.
function factorOf(motion) {
  if (motion.kind === "shape") return 1;
  if (motion.factor) return motion.factor;
  if (!(motion.largest > 0)) return 0;
  const tenth = (0.1 * extentAtRest) / motion.largest;
  if (motion.times) return Math.max(1, tenth);
  return motion.kind === "load" ? Math.max(0.4 * tenth, Math.min(1, tenth)) : tenth;
}
const place = new THREE.Vector3();
for (const motion of motions) {
  motion.factor = factorOf(motion);
  const { factor, times, values } = motion;
  for (let i = 0; times && i < values.length; i += 3) {
    const r = i % rest.length;
    seen.expandByPoint(place.set(rest[r] + factor * values[i], rest[r + 1] + factor * values[i + 1],
      rest[r + 2] + factor * values[i + 2]));
  }
}
// Shapes that are drawn at scale 1 are in the picture too.
const swing = Math.max(0, ...motions.map((m) => (m.times ? 0 : m.factor * m.largest)));
const size = aim(seen.expandByScalar(Number.isFinite(swing) ? swing : 0), data.view || [1, -1.4, 0.8]);

const arrows = new Arrows(scene);
const edges = new Edges(scene, data.lines || [], rest, size);
const creases = new Creases(scene, body.geometry, rest, triangles);
const overlay = new Overlay(view, camera, data.callout, rest);

// ---- state and controls ----------------------------------------------------------------------------

const byId = (id) => document.getElementById(id);
const state = { field: 0, motion: 0, scale: 1, range: 1, own: false, playing: false, phase: 1, behind: 0, frame: 0, since: 0 };

function fill(select, names) {
  for (const [i, name] of names.entries()) {
    const option = document.createElement("option");
    option.value = i;
    option.textContent = name;
    select.appendChild(option);
  }
  select.disabled = names.length === 0;
}
fill(byId("field"), fields.map((f) => f.name));
fill(byId("motion"), motions.map((d) => d.name));

function extent(field) {
  let low = Infinity;
  let high = -Infinity;
  for (const v of field.values)
    if (Number.isFinite(v)) {
      if (v < low) low = v;
      if (v > high) high = v;
    }
  return low <= high ? [low, high] : [0, 1];
}

function recolour() {
  touch();
  const field = fields[state.field];
  if (!field) return paint(body);
  const [least, greatest] = (field.extent ??= extent(field));
  const byLimit = field.limit > 0 && !state.own;
  const [low, full] = byLimit ? [0, field.limit] : [least, greatest];
  byId("upto").hidden = !(field.limit > 0);
  byId("top").options[0].textContent = `the strength, ${number(field.limit || 0)} ${field.unit}`;
  byId("top").options[1].textContent = `the largest value here, ${number(greatest)} ${field.unit}`;
  const high = low + (full - low) * state.range;
  paint(body, frame(field.values, state.frame, rest.length / 3), low, high, colour);
  byId("low").textContent = number(Math.abs(low) < 1e-6 * Math.abs(full) ? 0 : low);
  byId("high").textContent = `${high < greatest ? "≥ " : ""}${number(high)}`;
  byId("unit").textContent = field.unit || "";
}

function deform() {
  touch();
  const motion = motions[state.motion];
  const p = position.array;
  if (!motion || state.scale === 0) p.set(rest);
  else {
    const shown = state.scale * motion.factor;
    const values = frame(motion.values, state.frame, rest.length);
    for (let i = 0; i < p.length; i++) p[i] = rest[i] + state.phase * shown * values[i];
    for (let i = 0; motion.imaginary && i < p.length; i++) p[i] += state.behind * shown * motion.imaginary[i];
    byId("scaletext").textContent = motion.kind === "mode" ? "" : `× ${shown >= 1e4 ? Math.round(shown) : number(shown)}`;
  }
  position.needsUpdate = true;
  arrows.place(position.array);
  if (!data.rigid) edges.place(position.array);
}

// Each frame is shown until the next one, the last one for a mean interval.
const shownTime = (times) => ((times[times.length - 1] - times[0]) * times.length) / Math.max(1, times.length - 1);

// The frame of a part of the whole time.
function frameAt(times, part) {
  const now = times[0] + part * shownTime(times);
  let k = 0;
  while (k + 1 < times.length && times[k + 1] <= now) k++;
  return k;
}

// Playing begins, or goes on at the frame that is shown.
function play() {
  state.playing = true;
  const { times, seconds } = motions[state.motion] || {};
  if (!times) return;
  const part = times.length > 1 ? (times[state.frame] - times[0]) / shownTime(times) : 0;
  state.since = performance.now() - 1000 * seconds * part;
}

function timeText(times) {
  const last = times[times.length - 1];
  const [factor, unit] = last < 1e-3 ? [1e6, "µs"] : last < 1 ? [1e3, "ms"] : [1, "s"];
  return `${number(times[state.frame] * factor)} of ${number(last * factor)} ${unit}`;
}

function showFrame(k) {
  state.frame = k;
  const { times } = motions[state.motion];
  byId("time").value = k;
  byId("timetext").textContent = timeText(times);
  recolour();
  deform();
}

function showArrows() {
  arrows.show(motions[state.motion]?.arrows || [], rest, triangles, size);
  arrows.place(position.array);
  touch();
}

// What swings is shown where it is largest.
function showLargest() {
  state.phase = 1;
  state.behind = 0;
}

function select(motion) {
  state.motion = motion;
  const chosen = motions[motion];
  state.playing = !!chosen && (chosen.kind === "mode" || chosen.kind === "harmonic" || !!chosen.times);
  byId("play").textContent = state.playing ? "Pause" : "Play";
  showLargest();
  if (chosen && chosen.field !== undefined && chosen.field !== null) {
    state.field = chosen.field;
    byId("field").value = state.field;
    recolour();
  }
  byId("motion").value = motion;
  document.querySelectorAll("tr[data-motion]").forEach((row) =>
    row.setAttribute("aria-current", row.classList.toggle("chosen", Number(row.dataset.motion) === motion)));
  byId("true").disabled = !chosen || chosen.kind === "mode";
  byId("instant").hidden = !chosen?.times;
  if (chosen?.times) {
    byId("time").max = chosen.times.length - 1;
    showFrame(0);
    play();
  } else deform();
  showArrows();
}

byId("field").addEventListener("change", (e) => {
  state.field = Number(e.target.value);
  recolour();
});
byId("motion").addEventListener("change", (e) => select(Number(e.target.value)));
byId("scale").addEventListener("input", (e) => {
  state.scale = Number(e.target.value);
  deform();
});
// To the displacement as it is, and back.
function switchScale() {
  if (byId("true").disabled) return;
  const { factor } = motions[state.motion];
  const trueScale = factor > 0 ? 1 / factor : 1;
  state.scale = state.scale === trueScale ? 1 : trueScale;
  byId("scale").value = state.scale;
  deform();
}
byId("true").addEventListener("click", switchScale);
byId("top").addEventListener("change", (e) => {
  state.own = e.target.value === "own";
  recolour();
});

// Turns the camera about what it looks at, or comes nearer.
function turn(sideways, upwards, nearer) {
  const away = camera.position.clone().sub(controls.target);
  const at = new THREE.Spherical().setFromVector3(new THREE.Vector3(away.y, away.z, away.x));
  at.theta += sideways;
  at.phi = Math.min(Math.PI - 0.01, Math.max(0.01, at.phi + upwards));
  at.radius *= nearer;
  const p = new THREE.Vector3().setFromSpherical(at);
  camera.position.set(p.z, p.x, p.y).add(controls.target);
}
const step = Math.PI / 24;
const keys = {
  ArrowLeft: () => turn(-step, 0, 1),
  ArrowRight: () => turn(step, 0, 1),
  ArrowUp: () => turn(0, -step, 1),
  ArrowDown: () => turn(0, step, 1),
  "+": () => turn(0, 0, 0.9),
  "=": () => turn(0, 0, 0.9),
  "-": () => turn(0, 0, 1 / 0.9),
  t: switchScale,
};
view.addEventListener("keydown", (e) => {
  const act = !e.ctrlKey && !e.metaKey && !e.altKey && keys[e.key];
  if (!act) return;
  e.preventDefault();
  act();
});
byId("time").addEventListener("input", (e) => {
  state.playing = false;
  byId("play").textContent = "Play";
  showFrame(Number(e.target.value));
});
byId("range").addEventListener("input", (e) => {
  state.range = Math.max(0.02, Number(e.target.value));
  recolour();
});
byId("play").addEventListener("click", () => {
  if (state.playing) state.playing = false;
  else play();
  showLargest();
  byId("play").textContent = state.playing ? "Pause" : "Play";
  deform();
});
rankedRows(document.querySelector("table.ranked"));
rowsByKey(document.querySelectorAll("tr[data-motion]"), select);

drawBar(byId("bar"), colour);
for (const e of document.querySelectorAll(".colours")) e.hidden = fields.length === 0;
recolour();
if (motions.length > 0) select(0);
for (const id of ["shape", "deformation", "play", "true", "swings"]) byId(id).hidden = motions.length === 0;
start();

// For whoever drives the page by script.
window.barwright = {
  state: () => ({
    ...state,
    camera: camera.position.toArray(),
    first: Array.from(position.array.slice(0, 3)),
    arrows: arrows.count,
    arrowEnds: arrows.ends,
    edges: edges.count,
    creases: creases.count,
    shown: motions[state.motion] ? state.scale * motions[state.motion].factor : 0,
    largest: motions[state.motion]?.largest || 0,
    triangles: triangles.length / 3,
    drawn: detail.triangles,
    sharpness: stage.sharpness,
  }),
  // Milliseconds of one picture, the mean of some while the camera turns: drawn whole, or coarse as it is then.
  cost: (whole, pictures = 5) => detail.cost(whole, pictures),
};
