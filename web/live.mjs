// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The live view of an edit session: shows the state that the session sends, sends what the person
// does. The page keeps nothing of its own but what is looked at: windows agree because all of them
// show the session.
import * as THREE from "three";
import { Arrows } from "./arrows.mjs";
import { colourMap } from "./colour.mjs";
import { Bones } from "./live_bones.mjs";
import { Handles } from "./live_handles.mjs";
import { connect } from "./live_socket.mjs";
import { drawBar, makeBody, makeStage, number, paint } from "./stage.mjs";

const byId = (id) => document.getElementById(id);
const view = byId("view");
const stage = makeStage(view, () => {});
const bones = new Bones(stage.scene);
const arrows = new Arrows(stage.scene);
const worst = new THREE.Mesh(new THREE.SphereGeometry(1, 16, 12),
  new THREE.MeshBasicMaterial({ color: 0xc62828, depthTest: false, transparent: true, opacity: 0.85 }));
worst.renderOrder = 2;
worst.visible = false;
stage.scene.add(worst);

let me = 0; // this window's number
let scene = null;
let state = null;
let body = null;
let colour = null;
let bone = 0;
let joint = -1; // chosen in place of the bone
let connected = false;
let busy = false;
let arrivals = [];
const touched = { limit: false };
const heardOf = { states: 0, shapes: 0 };

// ---- saying ----------------------------------------------------------------------------------------

// A message stays through so many of the states that follow.
let kept = 0;
let outcome = null; // of a search that has ended, while its state is on the way

function say(text, bad = false, states = 0) {
  kept = states;
  byId("said").textContent = text;
  byId("said").classList.toggle("bad", bad);
}

const link = connect(
  (message) => heard[message.type]?.(message),
  (status, reason) => {
    connected = status === "open";
    byId("lost").hidden = connected;
    byId("lost").textContent = status === "ended"
      ? "The session has ended. Its edits are kept; start barwright live again to go on."
      : `The connection is lost${reason ? ` (${reason})` : ""}: trying again …`;
    if (!connected) {
      handles.drop();
      setBusy(false);
    }
    enable();
  },
);
const send = (message) => link.send(message);
const handles = new Handles(stage, send);

// ---- what the session sends --------------------------------------------------------------------------

const heard = {
  welcome(message) {
    me = message.client;
    byId("saved").textContent = message.saved ? `Edits are kept in ${message.saved}.` : "";
  },

  scene(message) {
    const first = !scene;
    scene = message;
    state = null;
    colour = colourMap(scene.colours);
    drawBar(byId("bar"), colour);
    document.title = `${scene.title} – barwright`;
    byId("title").textContent = scene.title;
    bones.setBones(scene.bones, scene.size);
    worst.scale.setScalar(0.008 * scene.size);
    bone = Math.min(bone, scene.bones.length - 1);
    listBones();
    joint = -1;
    if (first) {
      const thick = scene.bones.findIndex((b) => b.follows);
      bone = Math.max(0, thick);
    }
  },

  state(message) {
    if (!scene || message.scene !== scene.scene) return;
    const aimed = state || body;
    state = message;
    heardOf.states++;
    arrivals = [...arrivals.slice(-9), performance.now()];
    setBody();
    if (!aimed) fit();
    recolour();
    bones.place(state.joints);
    chooseAgain();
    readouts();
    const drag = state.drag;
    if (drag && drag.client === me) handles.handled(drag.seq);
    if (outcome) {
      setBusy(false);
      say(state.failure || outcome.message, !!state.failure || !outcome.met);
      outcome = null;
    } else if (kept > 0 && !state.failure) kept--;
    else say(state.failure || (drag && drag.client !== me ? `another window drags ${drag.bone || drag.joint}` : ""),
      !!state.failure);
  },

  // The stresses of a larger body come later than its shape.
  shape(message) {
    if (!state || message.scene !== state.scene) return;
    heardOf.shapes++;
    if (message.drag && message.drag.client === me) handles.handled(message.drag.seq);
    Object.assign(state, { positions: message.positions, joints: message.joints, axes: message.axes });
    setBody();
    bones.place(state.joints);
    chooseAgain();
    if (kept === 0) say("computing …");
  },

  refused(message) {
    say(message.message, true, message.request === "end" ? 1 : 0);
    if (message.request === "begin") handles.drop();
    else if (message.request === "move") handles.handled(message.seq);
  },

  error(message) {
    say(message.message, true);
  },

  progress(message) {
    setBusy(true);
    byId("progress").value = message.fraction;
    say(message.stage);
  },

  optimised(message) {
    outcome = message; // said with the colours that it is about, which come next
  },

  file(message) {
    const a = document.createElement("a");
    a.href = message.path;
    a.download = "";
    a.click();
    if (message.note) say(message.note);
  },
};

// ---- the body ----------------------------------------------------------------------------------------

function setBody() {
  if (!body || body.userData.scene !== scene.scene) {
    if (body) {
      stage.scene.remove(body);
      body.geometry.dispose();
      body.material.dispose();
    }
    body = makeBody(new Float32Array(state.positions), new Uint32Array(scene.triangles));
    body.userData.scene = scene.scene;
    stage.scene.add(body);
  }
  deform();
}

// The slider at 1 shows the largest deflection as a tenth of the body's size.
function deform() {
  const slider = Number(byId("deflection").value);
  const position = body.geometry.getAttribute("position");
  let factor = 0;
  if (slider > 0 && state.displacement) {
    const u = state.displacement;
    let largest = 0;
    for (let i = 0; i < u.length; i += 3) largest = Math.max(largest, Math.hypot(u[i], u[i + 1], u[i + 2]));
    if (largest > 0) factor = (slider * 0.1 * scene.size) / largest;
    for (let i = 0; i < u.length; i++) position.array[i] = state.positions[i] + factor * u[i];
  } else position.array.set(state.positions);
  position.needsUpdate = true;
  arrows.place(position.array);
  body.geometry.computeBoundingBox();
  body.geometry.computeBoundingSphere();
  byId("times").textContent = factor > 0 ? number(factor) : "0";
}

function recolour() {
  const byLimit = byId("range").value === "limit" && state.limit;
  const high = byLimit ? state.limit : state.maximum || 1;
  paint(body, state.von_mises, 0, high, colour);
  byId("high").textContent = `${byLimit ? "≥ " : ""}${number(high / 1e6)}`;
  worst.visible = !!state.at;
  if (state.at) worst.position.set(...state.at);
  arrows.show(state.loads.arrows || [], state.positions, scene.triangles, scene.size);
  arrows.place(body.geometry.getAttribute("position").array);
}

function fit() {
  // Room for what edits make of it.
  if (body) stage.aim(body.geometry.boundingBox, [1, -1.4, 0.8], 1.5);
}

function zoom(factor) {
  const { camera, controls } = stage;
  camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
}

// ---- readouts ------------------------------------------------------------------------------------------

function readouts() {
  const over = state.limit && state.maximum > state.limit;
  const maximum = byId("maximum");
  maximum.textContent = state.maximum === undefined ? "–" : `${number(state.maximum / 1e6)} `;
  const unit = document.createElement("small");
  unit.textContent = over ? "MPa, above the limit" : "MPa";
  maximum.append(unit);
  maximum.classList.toggle("over", !!over);
  byId("error").textContent = state.error === undefined ? "–" : `${Number((100 * state.error).toPrecision(2))} %`;
  byId("edits").textContent = state.edits;
  byId("reused").textContent = state.reused || "–";
  byId("mesh").textContent = `${scene.elements} elements, ${state.mesh}`;
  const span = arrivals[arrivals.length - 1] - arrivals[0];
  const rate = arrivals.length > 2 && span < 3000 ? (1000 * (arrivals.length - 1)) / span : 0;
  byId("time").textContent = `${Math.round(1000 * state.seconds)} ms${rate ? `, ${rate.toFixed(1)} a second` : ""}`;
  if (!touched.limit && state.limit) byId("limit").value = Number((state.limit / 1e6).toPrecision(6));
  showLoads();
  showTies();
  byId("script").replaceChildren(...state.script.map((line) => {
    const item = document.createElement("li");
    item.textContent = line.replace(/^session:/, "")
      .replace(/-?\d+\.\d{5,}(e-?\d+)?/g, (x) => String(Number(Number(x).toPrecision(5))));
    return item;
  }));
  enable();
}

function enable() {
  const idle = connected && !busy && !!state && !state.drag;
  byId("undo").disabled = !(idle && state.can_undo);
  byId("redo").disabled = !(idle && state.can_redo);
  for (const id of ["reset", "optimise", "stl", "lua", "loads", "again", "swing", "twist_min", "twist_max"])
    byId(id).disabled = !idle;
}

function setBusy(on) {
  busy = on;
  byId("progress").hidden = !on;
  byId("stop").hidden = !on;
  enable();
}

function showLoads() {
  const { loads } = state;
  byId("loads").value = loads.kind;
  byId("worst").hidden = loads.kind === "own";
  if (loads.kind === "own") return;
  byId("worst_words").textContent = `${number(loads.force)} N in total, in the worst distribution` +
    (loads.outdated ? "; found for an earlier shape." : ".");
  byId("again").hidden = !loads.outdated;
}

// Bones that the optimiser changes alike: those of the chosen bone can be added to, all be undone.
function showTies() {
  const name = scene.bones[bone].name;
  byId("tied").textContent = name;
  const option = (text, value) => Object.assign(document.createElement("option"), { textContent: text, value });
  const mine = state.ties.find((tie) => tie.includes(name)) || [name];
  byId("tie").replaceChildren(option("…", ""),
    ...scene.bones.filter((b) => !mine.includes(b.name)).map((b) => option(b.name, b.name)));
  byId("ties").replaceChildren(...state.ties.map((tie, i) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = `${tie.join(" = ")} ×`;
    button.title = "no longer alike";
    button.addEventListener("click", () => send({ type: "ties", ties: state.ties.filter((_, k) => k !== i) }));
    return button;
  }));
}

function showBend() {
  byId("rotated-bone").textContent = scene.bones[bone].name;
  const limits = state?.joint_limits[bone];
  const text = (x) => (x === undefined || x === null ? "" : Number(x.toPrecision(6)));
  for (const [id, value] of [["swing", limits?.swing], ["twist_min", limits?.twist?.[0]], ["twist_max", limits?.twist?.[1]]])
    if (document.activeElement !== byId(id) || document.activeElement.dataset.of !== scene.bones[bone].name) {
      byId(id).value = text(value);
      byId(id).dataset.of = scene.bones[bone].name;
    }
}

// ---- picking -------------------------------------------------------------------------------------------

function listBones() {
  byId("bones").replaceChildren(...scene.bones.map((b, i) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = b.name;
    button.title = b.follows ? "a part follows this bone alone" : "this bone only takes part in blending";
    button.addEventListener("click", () => pick(i));
    return button;
  }));
  byId("joints").replaceChildren(...scene.joints.map((name, i) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.title = name === scene.root ? "the root: it takes everything along" : "bones rotate so that it gets there";
    button.addEventListener("click", () => pickJoint(i));
    return button;
  }));
}

function pick(index) {
  bone = index;
  joint = -1;
  chooseAgain();
}

// A joint, and with it the bone that ends there.
function pickJoint(index) {
  if (handles.dragging) return;
  joint = index;
  const ends = scene.bones.findIndex((b) => b.tail === index);
  bone = ends >= 0 ? ends : scene.bones.findIndex((b) => b.head === index);
  chooseAgain();
}

function chooseAgain() {
  for (const [i, button] of [...byId("bones").children].entries()) press(button, i === bone && joint < 0);
  for (const [i, button] of [...byId("joints").children].entries()) press(button, i === joint);
  const b = scene.bones[bone];
  if (!b || !state) return handles.setBone(null, scene.size);
  bones.choose(bone, joint);
  handles.setBone(joint < 0
    ? { name: b.name, head: bones.joints[b.head], tail: bones.joints[b.tail], axes: state.axes[bone] }
    : { joint: scene.joints[joint], tail: bones.joints[joint], axes: state.axes[bone] }, scene.size);
  showModes();
  showBend();
  showTies();
}

function toScreen(point) {
  const box = stage.renderer.domElement.getBoundingClientRect();
  const p = point.clone().project(stage.camera);
  return new THREE.Vector2(box.left + ((p.x + 1) / 2) * box.width, box.top + ((1 - p.y) / 2) * box.height);
}

let pressed = null;
stage.renderer.domElement.addEventListener("pointerdown", (event) => {
  pressed = handles.controls.axis ? null : { x: event.clientX, y: event.clientY };
});
stage.renderer.domElement.addEventListener("pointerup", (event) => {
  if (!pressed || !state || Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > 4) return;
  const pixel = new THREE.Vector2(event.clientX, event.clientY);
  const ball = bones.nearJoint(pixel, toScreen);
  if (ball >= 0) return pickJoint(ball);
  const drawn = bones.near(pixel, toScreen);
  if (drawn >= 0) return pick(drawn);
  const box = stage.renderer.domElement.getBoundingClientRect();
  const ray = new THREE.Raycaster();
  ray.setFromCamera(new THREE.Vector2(((pixel.x - box.left) / box.width) * 2 - 1,
    1 - ((pixel.y - box.top) / box.height) * 2), stage.camera);
  const hit = ray.intersectObject(body)[0];
  if (hit) pick(bones.nearest(hit.point));
});

// ---- buttons and keys ------------------------------------------------------------------------------------

function press(button, on) {
  button.classList.toggle("on", on);
  button.setAttribute("aria-pressed", on);
}

function showModes() {
  for (const button of document.querySelectorAll("[data-mode]"))
    press(button, button.dataset.mode === handles.act);
}

function setMode(mode) {
  handles.setMode(mode);
  if (joint >= 0 && !handles.dragging) pick(bone); // back to the bone
  showModes();
}
for (const button of document.querySelectorAll("[data-mode]"))
  button.addEventListener("click", () => setMode(button.dataset.mode));
setMode("rotate");

const click = (id, action) => byId(id).addEventListener("click", action);
for (const word of ["undo", "redo", "reset"]) click(word, () => send({ type: word }));
for (const format of ["stl", "lua"]) click(format, () => send({ type: "export", format }));
click("in", () => zoom(0.8));
click("out", () => zoom(1.25));
click("fit", fit);
click("stop", () => send({ type: "stop" }));
click("optimise", () => {
  const limit = Number(byId("limit").value) * 1e6;
  if (!(limit > 0)) return say("give the limit first, in MPa", true);
  touched.limit = false;
  const choice = { move_supports: byId("move_supports").checked };
  if (send({ type: "optimise", von_mises: limit, ...choice })) setBusy(true);
});
byId("limit").addEventListener("input", () => (touched.limit = true));
byId("limit").addEventListener("change", () => {
  const limit = Number(byId("limit").value) * 1e6;
  touched.limit = false;
  send({ type: "limit", von_mises: limit > 0 ? limit : null });
});
byId("loads").addEventListener("change", () => {
  const wanted = byId("loads").value;
  if (send({ type: "loads", loads: wanted }) && wanted === "worst") setBusy(true);
});
click("again", () => send({ type: "loads", loads: "worst" }) && setBusy(true));
byId("tie").addEventListener("change", () => {
  const [name, other] = [scene.bones[bone].name, byId("tie").value];
  if (!other) return;
  const joined = (tie) => tie.includes(name) || tie.includes(other);
  const together = new Set([name, other, ...state.ties.filter(joined).flat()]);
  send({ type: "ties", ties: [...state.ties.filter((tie) => !joined(tie)), [...together]] });
});
for (const id of ["swing", "twist_min", "twist_max"])
  byId(id).addEventListener("change", () => {
    const [swing, low, high] = ["swing", "twist_min", "twist_max"].map((field) => byId(field).value)
      .map((text) => (text === "" ? null : Number(text)));
    if ((low === null) !== (high === null)) return; // the other one is still to come
    send({ type: "joint_limits", bone: scene.bones[bone].name, swing, twist: low === null ? null : [low, high] });
  });
byId("deflection").addEventListener("input", () => state && deform());
byId("range").addEventListener("change", () => state && recolour());

const keys = {
  r: () => setMode("rotate"),
  s: () => setMode("scale"),
  m: () => setMode("translate"),
  e: () => setMode("reach"),
  f: fit,
  "+": () => zoom(0.8),
  "=": () => zoom(0.8),
  "-": () => zoom(1.25),
  "[": () => scene && !handles.dragging && pick((bone + scene.bones.length - 1) % scene.bones.length),
  "]": () => scene && !handles.dragging && pick((bone + 1) % scene.bones.length),
  Escape: () => handles.cancel(),
};
window.addEventListener("keydown", (event) => {
  if (event.target.matches("input, select")) return;
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
stage.start();

// For whoever drives the page by script.
window.barwright = {
  state: () => ({
    connected, busy, me, bone: scene?.bones[bone]?.name, mode: handles.mode, dragging: handles.dragging, underWay: handles.waiting,
    scene: scene?.scene, revision: state?.revision, maximum: state?.maximum, error: state?.error,
    edits: state?.edits, limit: state?.limit, drag: state?.drag, said: byId("said").textContent,
    canUndo: state?.can_undo, canRedo: state?.can_redo,
    box: body && [...body.geometry.boundingBox.min, ...body.geometry.boundingBox.max],
    positions: state && Array.from(state.positions),
    rate: arrivals.length, ...heardOf,
    joint: scene?.joints[joint], loads: state?.loads, ties: state?.ties, joint_limits: state?.joint_limits, factors: state?.factors, seconds: state?.seconds,
    joints: state && Object.fromEntries(scene.joints.map((name, i) => [name, state.joints[i]])),
    arrows: arrows.count,
  }),
  ball: (name) => toScreen(bones.joints[scene.joints.indexOf(name)]).toArray(),
  handle: (axis) => toScreen(handles.at(axis)).toArray(),
  place: (name) => toScreen(bones.joints[scene.bones.find((b) => b.name === name).head].clone()
    .lerp(bones.joints[scene.bones.find((b) => b.name === name).tail], 0.5)).toArray(),
  send,
};
