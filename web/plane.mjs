// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The live view of what follows an outline in the plane: sheets, vibrating plates, flows. Shows the state
// that it receives, sends what the person does; keeps nothing of its own but what is looked at.
import { colourMap, diverging } from "./colour.mjs";
import { connect } from "./live_socket.mjs";
import { Field, largest } from "./plane_field.mjs";
import { Outline } from "./plane_outline.mjs";
import { readouts, unitOf } from "./plane_readouts.mjs";
import { Sound } from "./plane_sound.mjs";
import { makePlane } from "./plane_stage.mjs";
import { Tools } from "./plane_tools.mjs";
import { drawBar, number } from "./stage.mjs";

const byId = (id) => document.getElementById(id);
const plane = makePlane(byId("view"), draw);
const outline = new Outline(plane);
const field = new Field(plane);
const sound = new Sound();

let me = 0; // this window's number
let scene = null;
let mesh = null;
let state = null;
let colour = null;
let chosen = null; // key of the field that is looked at
let connected = false;
let busy = false;
let aimed = false;
let arrivals = [];
let highest = 0; // of the field so far
let deflection = { states: 0, most: 0 }; // what deformations are measured by
let arrowCount = 0;
let painted = null; // the map of the bar
const heardOf = { states: 0, refused: 0 };

// ---- saying ----------------------------------------------------------------------------------------

// A message stays for so many milliseconds, then the failure of the state is shown.
let keptUntil = 0;
let refusal = false; // what is said is why something failed; it goes with the next edit that counts

function say(text, bad = false, stay = 4000) {
  refusal = bad && stay === 4000;
  keptUntil = performance.now() + stay;
  byId("said").textContent = text;
  byId("said").classList.toggle("bad", bad);
}

const link = connect(
  (message) => heard[message.type]?.(message),
  (status, reason) => {
    connected = status === "open";
    byId("lost").hidden = connected;
    byId("lost").textContent = status === "ended"
      ? "The view has ended. Its edits are kept; start barwright live again to go on."
      : `The connection is lost${reason ? ` (${reason})` : ""}: trying again …`;
    if (connected && chosen) send({ type: "show", field: chosen });
    if (!connected) {
      tools.drop();
      setBusy(false);
    }
    enable();
  },
);
const send = (message) => link.send(message);
const tools = new Tools(plane, outline, send, say);

// ---- readouts --------------------------------------------------------------------------------------

const heard = {
  welcome(message) {
    me = message.client;
    byId("saved").textContent = message.saved ? `Edits are kept in ${message.saved}.` : "";
  },

  scene(message) {
    const first = !scene;
    scene = message;
    tools.size = scene.size;
    outline.setScene(scene);
    document.title = `${scene.title} – barwright`;
    byId("title").textContent = scene.title;
    if (first) prepare();
  },

  mesh(message) {
    mesh = message;
    field.setMesh(mesh, scene?.mirror);
  },

  state(message) {
    if (!scene || !mesh || message.scene !== scene.scene || message.mesh !== mesh.mesh) return;
    const before = state;
    state = message;
    heardOf.states++;
    arrivals = [...arrivals.slice(-59), performance.now()];
    outline.points = state.outline;
    deform();
    if (!aimed) fit();
    aimed = true;
    recolour();
    readouts(scene, state);
    enable();
    if (state.drag && state.drag.client === me) tools.drag.handled(state.drag.seq);
    if (refusal && before && (state.edits !== before.edits || state.can_redo !== before.can_redo)) keptUntil = 0;
    if (state.failure) say(state.failure, true);
    else if (performance.now() > keptUntil)
      say(state.drag && state.drag.client !== me ? "another window drags the outline" : "", false, 0);
    if (state.tone) beep(before);
  },

  refused(message) {
    heardOf.refused++;
    say(message.message, true);
    if (message.request === "begin") tools.drop();
    else if (message.request === "move") tools.drag.handled(message.seq);
  },

  error(message) {
    say(message.message, true);
  },

  progress(message) {
    setBusy(true);
    say(message.stage);
  },

  tuned(message) {
    setBusy(false);
    say(message.message, !message.met, 15000);
    if (message.met && state?.tone && sound.context) sound.strike(state.tone);
  },

  file(message) {
    const a = document.createElement("a");
    a.href = message.path;
    a.download = "";
    a.click();
  },
};

// What the kind of analysis has to be shown and asked for.
function prepare() {
  colour = colourMap(scene.colours);
  byId("stress").hidden = !scene.stress;
  byId("ring").hidden = !scene.tune;
  byId("time_tools").hidden = !scene.steps;
  byId("deformed").hidden = !scene.deform;
  byId("deflection").value = scene.true_size || scene.tune ? 0 : 0.4;
  byId("range").value = scene.steps ? "history" : "largest";
  byId("range").querySelector("[value=limit]").hidden = !scene.stress;
  byId("field").replaceChildren(...scene.fields.map((f) => Object.assign(document.createElement("option"),
    { value: f.key, textContent: f.name })));
  chosen = scene.fields[0].key;
  byId("radius").value = Number((25 * scene.size).toPrecision(2));
  tools.radius = byId("radius").value / 1000;
  byId("reach").value = Number((150 * scene.size).toPrecision(2));
  tools.reach = byId("reach").value / 1000;
}

// ---- the body ------------------------------------------------------------------------------------------

// The slider at 1 shows the largest deflection as a tenth of the size, where that is not as it is. In
// time the first states give the measure, so that a growing swing is seen to grow.
function deform() {
  const slider = Number(byId("deflection").value);
  let factor = scene.true_size ? 1 : 0;
  if (state.deform && !scene.true_size && slider > 0) {
    if (!scene.steps) deflection.most = largest(state.deform, mesh.nodes);
    else if (deflection.states++ < 60) deflection.most = Math.max(deflection.most, largest(state.deform, mesh.nodes));
    if (deflection.most > 0) factor = (slider * 0.1 * scene.size) / deflection.most;
  } else if (scene.true_size && slider > 0) factor = 1 + 9 * slider;
  field.place(state.positions, state.deform, scene.tune ? factor * Math.cos(performance.now() / 160) : factor);
  byId("times").textContent = factor > 0 ? number(factor) : "0";
  plane.touch();
}

const described = () => scene.fields.find((f) => f.key === chosen);

function recolour() {
  const f = described();
  const values = state[chosen];
  const [low, high] = state.fields[chosen] || [0, 0];
  const most = Math.max(Math.abs(low), Math.abs(high));
  highest = Math.max(0.995 * highest, most); // a jolt is forgotten in some seconds
  const wanted = byId("range").value;
  const limited = wanted === "limit" && state.limit && chosen === "von_mises";
  const map = f.signed ? diverging : colour;
  if (painted !== map) drawBar(byId("bar"), map);
  painted = map;
  const end = limited ? state.limit : wanted === "history" ? highest : most;
  const from = f.signed ? -end : f.full_range ? low : 0;
  const to = f.full_range && !f.signed ? high : end;
  field.paint(values, from, to > from ? to : from + 1, map);
  const [unit, scale] = unitOf(f, Math.max(Math.abs(from), Math.abs(to)));
  byId("low").textContent = number(from * scale);
  byId("unit").textContent = unit;
  byId("high").textContent = `${limited ? "≥ " : ""}${number(to * scale)}`;
  plane.touch();
}

// A mode swings, slowly, where it is drawn deformed.
const swings = () => scene?.tune && state?.deform && Number(byId("deflection").value) > 0;

function draw(pen) {
  if (swings()) deform();
  if (!state || !scene) return;
  if (scene.arrows && state.arrows) arrowCount = field.arrows(pen, state.positions, state.arrows);
  if (scene.goal) drawGoal(pen);
  if (state.lines) drawLines(pen);
  outline.draw(pen, tools.tool);
  tools.draw(pen);
  if (state.at) {
    const [x, y] = plane.toScreen(...state.at);
    pen.beginPath();
    pen.arc(x, y, 6, 0, 2 * Math.PI);
    pen.strokeStyle = "#c62828";
    pen.lineWidth = 2;
    pen.stroke();
  }
}

// The shape that is to be met.
function drawGoal(pen) {
  pen.beginPath();
  for (let i = 0, on = false; i < scene.goal.length; i += 2) {
    const [x, y] = [scene.goal[i], scene.goal[i + 1]];
    if (Number.isNaN(x)) on = false;
    else {
      pen[on ? "lineTo" : "moveTo"](...plane.toScreen(x, y));
      on = true;
    }
  }
  pen.strokeStyle = "#c62828";
  pen.lineWidth = 2;
  pen.stroke();
}

// Nodal lines, and where the bar may be supported.
function drawLines(pen) {
  pen.beginPath();
  for (let i = 0; i < state.lines.length; i += 4) {
    pen.moveTo(...plane.toScreen(state.lines[i], state.lines[i + 1]));
    pen.lineTo(...plane.toScreen(state.lines[i + 2], state.lines[i + 3]));
  }
  pen.setLineDash([6, 4]);
  pen.strokeStyle = "#1d2733";
  pen.lineWidth = 1.5;
  pen.stroke();
  pen.setLineDash([]);
  for (const at of state.holes || []) {
    pen.beginPath();
    pen.arc(...plane.toScreen(...at), 5, 0, 2 * Math.PI);
    pen.fillStyle = "#fff";
    pen.fill();
    pen.lineWidth = 2;
    pen.stroke();
  }
}

// All that is drawn: outline, deformed shape, goal.
function fit() {
  if (!outline.points) return;
  const low = [Infinity, Infinity];
  const high = [-Infinity, -Infinity];
  const add = (list, columns) => {
    for (let i = 0; list && i < list.length; i += columns)
      for (const k of [0, 1])
        if (!Number.isNaN(list[i + k])) {
          low[k] = Math.min(low[k], list[i + k]);
          high[k] = Math.max(high[k], list[i + k]);
          if (k === 0 && scene.mirror) low[0] = Math.min(low[0], -list[i]);
        }
  };
  add(outline.points, 2);
  add(scene.goal, 2);
  add(field.drawn(), 3);
  plane.fit(low, high);
}

// ---- readouts ------------------------------------------------------------------------------------------

// Frames of the last second; a rest shows no rate. What was said long enough ago goes.
function rate() {
  const now = performance.now();
  if (now > keptUntil && byId("said").textContent && !state?.failure && !busy) say("", false, 0);
  const recent = arrivals.filter((t) => now - t < 1000);
  byId("fps").textContent = recent.length > 1
    ? ((1000 * (recent.length - 1)) / Math.max(1, recent[recent.length - 1] - recent[0])).toFixed(0) : "–";
}

function enable() {
  const idle = connected && !busy && !!state && !state.drag;
  byId("undo").disabled = !(idle && state.can_undo);
  byId("redo").disabled = !(idle && state.can_redo);
  byId("reset").disabled = !(idle && state.can_undo);
  for (const id of ["svg", "dxf", "lua", "tune"]) byId(id).disabled = !idle;
  tools.enabled = connected && !busy && !!state;
}

function setBusy(on) {
  busy = on;
  byId("progress").hidden = !on;
  byId("stop").hidden = !on;
  enable();
}

// ---- sound ---------------------------------------------------------------------------------------------

// While this window drags, the tone is heard as it changes; at the end a stroke.
function beep(before) {
  if (!byId("beep").checked) return sound.hush();
  if (state.drag && state.drag.client === me) sound.follow(state.frequency);
  else {
    sound.hush();
    if (before?.drag) sound.strike(state.tone);
  }
}

// ---- what the person does ------------------------------------------------------------------------------

function press(button, on) {
  button.classList.toggle("on", on);
  button.setAttribute("aria-pressed", on);
}

function setTool(tool) {
  tools.setTool(tool);
  for (const button of document.querySelectorAll("[data-tool]"))
    press(button, button.dataset.tool === tools.tool);
}
setTool("drag");

for (const button of document.querySelectorAll("[data-tool]"))
  button.addEventListener("click", () => setTool(button.dataset.tool));
for (const id of ["undo", "redo", "reset", "stop"]) byId(id).addEventListener("click", () => send({ type: id }));
for (const id of ["svg", "dxf", "lua"]) byId(id).addEventListener("click", () => send({ type: "export", format: id }));
byId("in").addEventListener("click", () => plane.zoom(1.25));
byId("out").addEventListener("click", () => plane.zoom(0.8));
byId("fit").addEventListener("click", fit);
byId("field").addEventListener("change", (event) => {
  chosen = event.target.value;
  highest = 0;
  send({ type: "show", field: chosen });
});
byId("range").addEventListener("change", () => {
  highest = 0;
  if (state) recolour();
});
byId("deflection").addEventListener("input", () => {
  deflection = { states: 0, most: 0 };
  if (state) deform();
});
byId("mesh").addEventListener("change", (event) => {
  field.showLines = event.target.checked;
  if (state) deform();
});
byId("controls").addEventListener("change", (event) => {
  outline.allControls = event.target.checked;
  plane.touch();
});
byId("radius").addEventListener("change", (event) => (tools.radius = Number(event.target.value) / 1000));
byId("reach").addEventListener("change", (event) => (tools.reach = Number(event.target.value) / 1000));
byId("limit").addEventListener("change", (event) => {
  const limit = Number(event.target.value);
  send({ type: "limit", von_mises: limit > 0 ? limit * 1e6 : null });
});
const pause = () => scene?.steps && state && send({ type: "pace", running: !state.running });
byId("pause").addEventListener("click", pause);
byId("pace").addEventListener("change", (event) =>
  send({ type: "pace", steps: Math.min(1000, Math.max(1, Math.round(Number(event.target.value) || 1))) }));
const strike = () => state?.tone && sound.strike(state.tone);
byId("strike").addEventListener("click", strike);
byId("beep").addEventListener("change", () => byId("beep").checked && sound.start());
function tune() {
  const text = byId("target").value.trim();
  const hertz = Number(text.replace(/\s*Hz$/i, ""));
  if (!text) return say("a note like C5, or a frequency in Hz, to tune to", true);
  const pins = outline.pins.size ? { pins: [...outline.pins].sort((a, b) => a - b) } : {}; // stay where they are
  send({ type: "tune", target: Number.isFinite(hertz) ? hertz : text, ...pins });
}
byId("tune").addEventListener("click", tune);
byId("target").addEventListener("keydown", (event) => event.key === "Enter" && tune());

const keys = {
  d: () => setTool("drag"),
  p: () => setTool("pull"),
  h: () => setTool("hole"),
  a: () => setTool("add"),
  x: () => setTool("remove"),
  s: () => setTool("smooth"),
  t: strike,
  f: fit,
  " ": pause,
  "+": () => plane.zoom(1.25),
  "=": () => plane.zoom(1.25),
  "-": () => plane.zoom(0.8),
  Escape: () => tools.cancel(),
};
window.addEventListener("keydown", (event) => {
  if (event.target.matches("input:not([type=checkbox]):not([type=range]), select")) return;
  if (event.key === " " && event.target.matches("button, input")) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (event.ctrlKey || event.metaKey) {
    if (key !== "z" && key !== "y") return;
    event.preventDefault();
    const redo = key === "y" || event.shiftKey;
    if (!byId(redo ? "redo" : "undo").disabled) send({ type: redo ? "redo" : "undo" });
  } else if (keys[key]) {
    event.preventDefault();
    keys[key]();
  }
});
plane.start();
setInterval(rate, 200);

// For whoever drives the page by script.
window.barwright = {
  state: () => ({
    connected, busy, me, tool: tools.tool, dragging: tools.drag.going, underWay: tools.drag.waiting,
    scene: scene?.scene, mesh: mesh?.mesh, said: byId("said").textContent, ...heardOf, fps: byId("fps").textContent,
    ...(state && { revision: state.revision, maximum: state.maximum, area: state.area, level: state.level,
      levels: state.levels, reused: state.reused, iterations: state.iterations, edits: state.edits, drag: state.drag,
      canUndo: state.can_undo, canRedo: state.can_redo, script: state.script, time: state.time, running: state.running,
      frequency: state.frequency, note: state.note, cents: state.cents, holes: state.holes, seconds: state.seconds,
      limit: state.limit, fields: state.fields, failure: state.failure, points: Array.from(state.outline),
      lines: state.lines?.length || 0, goal: scene.goal?.length || 0, elements: state.elements }),
    field: chosen, arrows: arrowCount, pins: [...outline.pins], sound: sound.state(),
    loops: scene?.loops.map((loop) => loop.name),
  }),
  // places on the screen: of a vertex, the middle of an edge, a place in metres
  vertex: (v) => outline.at(outline.segments[v - 1].start),
  edge: (e) => outline.along(outline.segments[e - 1], 16)[outline.segments[e - 1].control ? 8 : 0]
    .map((x, k) => (outline.segments[e - 1].control ? x : 0.5 * (x + outline.at(outline.segments[e - 1].end)[k]))),
  control: (e, k) => outline.at(outline.segments[e - 1].control[k - 1]),
  place: (x, y) => plane.toScreen(x, y),
  send,
};
