// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The report's 3D view: a surface that turns, coloured by a field, deformed by a displacement or a
// swinging mode, with the arrows of the chosen load. Reads the page's #data; needs no network.
import * as THREE from "three";
import { Arrows } from "./arrows.mjs";
import { colourMap } from "./colour.mjs";
import { data } from "./data.mjs";
import { Edges } from "./edges.mjs";
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
const motions = (data.displacements || []).map((d) => ({ ...d, values: floats(d.values) }));

// ---- scene ---------------------------------------------------------------------------------------

const colour = colourMap(data.colours);
const { scene, camera, aim, start } = makeStage(document.getElementById("view"), (now) => {
  if (state.playing) {
    state.phase = Math.sin((now / 1000) * 2 * Math.PI * 0.7);
    deform();
  }
});
const body = makeBody(new Float32Array(rest), triangles);
const position = body.geometry.getAttribute("position");
scene.add(body);
// Lines may reach beyond the body: an obstacle does.
const seen = body.geometry.boundingBox.clone();
for (const line of data.lines || []) for (const [x, y, z] of line) seen.expandByPoint(new THREE.Vector3(x, y, z));
const size = aim(seen, data.view || [1, -1.4, 0.8]);

const arrows = new Arrows(scene);
const edges = new Edges(scene, data.lines || [], rest, size);

// ---- state and controls ----------------------------------------------------------------------------

const byId = (id) => document.getElementById(id);
const state = { field: 0, motion: 0, scale: 1, range: 1, playing: false, phase: 1 };

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
  const field = fields[state.field];
  if (!field) return paint(body);
  const [low, full] = extent(field);
  const high = low + (full - low) * state.range;
  paint(body, field.values, low, high, colour);
  byId("low").textContent = number(Math.abs(low) < 1e-6 * Math.abs(full) ? 0 : low);
  byId("high").textContent = `${state.range < 1 ? "≥ " : ""}${number(high)}`;
  byId("unit").textContent = field.unit || "";
}

function deform() {
  const motion = motions[state.motion];
  const p = position.array;
  if (!motion || state.scale === 0) p.set(rest);
  else {
    let largest = 0;
    for (let i = 0; i < motion.values.length; i += 3)
      largest = Math.max(largest, Math.hypot(motion.values[i], motion.values[i + 1], motion.values[i + 2]));
    // Slider 1: the largest motion is a tenth of the box's diagonal; another shape is there as it is.
    const whole = motion.kind === "shape" ? 1 : largest > 0 ? (0.1 * size) / largest : 0;
    const factor = state.scale * state.phase * whole;
    for (let i = 0; i < p.length; i++) p[i] = rest[i] + factor * motion.values[i];
    const shown = state.scale * whole;
    byId("scaletext").textContent = motion.kind === "mode" ? "" : `× ${number(shown)}`;
  }
  position.needsUpdate = true;
  arrows.place(position.array);
  if (!data.rigid) edges.place(position.array);
}

function showArrows() {
  arrows.show(motions[state.motion]?.arrows || [], rest, triangles, size);
  arrows.place(position.array);
}

function select(motion) {
  state.motion = motion;
  const chosen = motions[motion];
  state.playing = !!chosen && chosen.kind === "mode";
  byId("play").textContent = state.playing ? "Pause" : "Play";
  state.phase = 1;
  if (chosen && chosen.field !== undefined && chosen.field !== null) {
    state.field = chosen.field;
    byId("field").value = state.field;
    recolour();
  }
  byId("motion").value = motion;
  document.querySelectorAll("tr[data-motion]").forEach((row) =>
    row.classList.toggle("chosen", Number(row.dataset.motion) === motion));
  deform();
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
byId("range").addEventListener("input", (e) => {
  state.range = Math.max(0.02, Number(e.target.value));
  recolour();
});
byId("play").addEventListener("click", () => {
  state.playing = !state.playing;
  state.phase = 1;
  byId("play").textContent = state.playing ? "Pause" : "Play";
  deform();
});
document.querySelectorAll("tr[data-motion]").forEach((row) =>
  row.addEventListener("click", () => select(Number(row.dataset.motion))));

drawBar(byId("bar"), colour);
recolour();
if (motions.length > 0) select(0);
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
    triangles: triangles.length / 3,
  }),
};
