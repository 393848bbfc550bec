// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The workbench: shows the state that the session sends, sends what the person does. The page keeps nothing of its own
// but what is looked at, chosen and typed, and keeps that through a reload: the rest is the session's, so that windows agree.
import { connect } from "./live_socket.mjs";
import { drawBar } from "./stage.mjs";
import { Draft } from "./workbench_draft.mjs";
import { Handles } from "./workbench_handles.mjs";
import { answerLine, fill, listAdvice, listConditions, listFaces, listMaterial, listNumbers, make } from "./workbench_lists.mjs";
import { keepOnLeaving, kept, putBack } from "./workbench_kept.mjs";
import { listen } from "./workbench_pointer.mjs";
import { Pull } from "./workbench_pull.mjs";
import { Triad } from "./workbench_triad.mjs";
import { View } from "./workbench_view.mjs";
import { digits, faceText, grams, materialName, megapascals, millimetres } from "./workbench_words.mjs";

const byId = (id) => document.getElementById(id);
const click = (id, action) => byId(id).addEventListener("click", action);
const pressed = (id) => byId(id).getAttribute("aria-pressed") === "true";
const press = (id, on) => byId(id).setAttribute("aria-pressed", String(on));
const setText = (id, text) => {
  if (byId(id).textContent !== text) byId(id).textContent = text;
};

let state = null;
let connected = false;
let chosen = new Set(); // faces, from 0
let counter = 0;
let asked = null; // what waits for its answer: {id, what, since}
let bending = true; // whether results are shown deformed, and trueScale in true size
let trueScale = false;
let splitting = null; // a patch that was asked for: {id, add}
let released = 0; // the message of an edit that was dragged while there was an answer
let clicked = null; // where the part was clicked last
let former = kept(); // what this window had before it was loaded again, until it is put back
const counts = { states: 0, scenes: 0 };

const view = new View(byId("view"), () => {
  triad.place(view.stage.camera);
  handles.place();
});
const triad = new Triad(byId("triad"), (direction) => view.fit(direction));
const handles = new Handles(byId("handles"), view);
const { canvas } = view;
canvas.tabIndex = 0;
canvas.setAttribute("role", "application");
canvas.setAttribute("aria-label", "The part. Arrow keys turn it, plus and minus zoom, F shows all. Faces are in the list Faces.");

// ---- talking with the session ------------------------------------------------------------------------------

function say(text, bad = false, details = "") {
  const said = byId("said");
  said.classList.toggle("bad", bad);
  said.replaceChildren(text);
  if (details) said.append(make("details", {}, make("summary", { textContent: "Details" }), make("span", { textContent: details })));
}

const link = connect((message) => heard[message.type]?.(message), (status, reason) => {
  connected = status === "open";
  byId("lost").hidden = connected;
  byId("lost").textContent = status === "ended"
    ? "The workbench has ended. Save the script before the next time; start barwright open again to go on."
    : `The connection is lost${reason ? ` (${reason})` : ""}: trying again …`;
  enable();
});

function send(what, fields = {}) {
  const id = ++counter;
  if (!link.send({ id, do: what, ...fields })) {
    if (what !== "prepare") say("Nothing was done: the connection is lost.", true);
    return 0;
  }
  if (what === "prepare") return id; // which nobody has asked for
  if (what !== "drag") asked = { id, what, since: performance.now() };
  say("");
  return id;
}

const numbers = () => [...chosen].sort((a, b) => a - b).map((i) => state.faces[i].index);
const indexOf = (number) => state.faces.findIndex((f) => f.index === number);

const heard = {
  state(message) {
    counts.states++;
    state = message;
    // A support's kind says which directions it constrains.
    for (const condition of state.conditions || [])
      if (condition.kind === "all" || condition.kind === "normal") Object.assign(condition, { constrains: condition.kind, kind: "fix" });
    if (asked && (message.reply === undefined || message.reply >= asked.id)) {
      const took = message.latency_ms ?? performance.now() - asked.since;
      setText("latency", `The last step took ${took < 2000 ? `${Math.round(took)} ms` : `${digits(took / 1000)} s`}.`);
      if (asked.what === "advice" && state.advice && !state.advice.length && !state.message)
        say("No place was found where thickening helps: choose a stronger material, or push a wall.");
      asked = null;
    }
    if (splitting?.done && state.grown_faces) {
      chosen = new Set([...(splitting.add ? chosen : []), ...state.grown_faces.map(indexOf)]);
      splitting = null;
    }
    if (message.message) say(message.message.text, true, message.message.details);
    render();
    if (former && !state.file) former = putBack(former); // no part: only what was typed
    else if (former && view.scene && state.faces) restore();
  },

  scene(message) {
    counts.scenes++;
    if (!message.faces || typeof message.faces === "number")
      message.faces = new Uint32Array(message.triangles.length / 3).fill(0xffffffff);
    if (message.kind === "file") [chosen, clicked] = [new Set(), null]; // another part has come
    view.setScene(message);
    pull.seen(message.kind);
    drawBar(byId("bar"), view.colour);
    byId("drop").hidden = true;
    if (state) render();
    if (former && state?.faces) restore();
  },

  refused(message) {
    if (asked?.id === message.id) asked = null;
    splitting = null;
    say(message.message || message.text, true, message.details);
    pull.refused();
    enable();
  },

  // An action was done; the state that it made follows.
  done(message) {
    if (message.message) say(message.message);
    if (splitting?.id === message.id) splitting.done = true;
    if (released === message.id) ask(); // the converged answer of what was dragged
  },

  // How far long work is: many small messages.
  busy(message) {
    if (!state) return;
    state.busy = message.busy;
    renderAnswer();
    enable();
  },

  // The stresses of a shape that is tried while a handle is dragged.
  drag(message) {
    setText("latency", `While dragging: ${Math.round(message.latency_ms)} ms a step.`);
    if (message.answer?.mass) setText("mass", grams(message.answer.mass));
    if (pull.dragging && message.answer?.utilisation) {
      setText("verdict-words", message.answer.sentence);
      setText("verdict-more", answerLine({ ...message.answer, force: undefined }));
    }
    pull.handled();
  },

  probe(message) {
    if (message.von_mises !== undefined) setText("said", `Stress there: ${megapascals(message.von_mises)}.`);
  },

  file(message) {
    make("a", { href: message.url, download: message.name || "" }).click();
    say([`${message.name || "The file"} is downloaded.`, message.deviation].filter(Boolean).join(" "));
  },
};

// ---- a reload -----------------------------------------------------------------------------------------------

keepOnLeaving(() => former, () => ({ part: state?.part, camera: view.scene && view.camera(),
  chosen: state?.faces ? numbers() : [], clicked, bending, trueScale, draft: draft.kept() }));

// This window goes on as it was left; of another part only what is no face and no place.
function restore() {
  const found = former;
  former = null;
  [bending, trueScale] = [found.bending, found.trueScale];
  const same = found.part === state.part;
  if (same) choose(new Set(found.chosen.map(indexOf)));
  putBack(found); // after what choosing writes into fields
  if (view.lines) view.lines.visible = pressed("edges");
  byId("section").hidden = !pressed("cut");
  if (same) {
    clicked = found.clicked;
    view.look(found.camera);
    draft.restore(found.draft);
  }
  modes();
  section();
  bend();
  enable();
}

// A field shows what the session has until something is typed: it follows where that changes.
const followed = {};
function follow(id, value) {
  if (followed[id] === value) return;
  followed[id] = value;
  if (document.activeElement !== byId(id)) byId(id).value = value;
}

// ---- showing the state --------------------------------------------------------------------------------------

function render() {
  const faces = state.faces || [];
  document.title = state.file ? `${state.file.split("/").pop()} – barwright workbench` : "barwright workbench";
  setText("file", state.file ? state.file.split("/").pop() : "");
  setText("size", state.size ? `${state.size.map((x) => digits(1000 * x)).join(" × ")} mm` : "");
  setText("mass", state.mass ? grams(state.mass) : "");
  byId("units").hidden = state.units_plausible !== false;
  if (state.units_plausible === false)
    setText("units-words", state.units_message || `In ${state.unit || "mm"} the part would be ${state.size.map((x) => digits(1000 * x)).join(" × ")} mm. ` +
      "Choose the unit it was drawn in.");
  renderRepair();
  listFaces(byId("faces"), faces, byId("search").value, (i, on) => {
    const next = new Set(chosen);
    if (on) next.add(i);
    else next.delete(i);
    choose(next);
  }, point);
  listConditions(byId("conditions"), state.conditions || [], faces, {
    change: (condition) => draft.change(condition),
    remove: (condition) => send("remove", { condition: condition.index }),
    point: (list) => point(list.length ? indexOf(list[0]) : -1),
  });
  listAdvice(byId("advices"), state.advice || [], { apply: (advice) => send("apply", { advice }),
    point: (list) => point(list.length ? indexOf(list[0]) : -1) });
  fill(byId("material"), state.materials || [], () => [make("option", { value: "", textContent: "choose …" }),
    ...(state.materials || []).map((name) => make("option", { value: name, textContent: materialName(name) }))]);
  const name = state.material?.name || "";
  if (document.activeElement !== byId("material") || !asked) byId("material").value = name;
  setText("material-words", name ? materialName(name) : "not chosen");
  listMaterial(byId("material-data"), state.material);
  byId("symmetry").value = state.symmetry || "none";
  byId("thickness-form").hidden = !state.thickness;
  if (state.thickness) follow("thickness", Number((1000 * state.thickness).toPrecision(6)));
  setText("note", state.note || "");
  setText("deviation", state.deviation?.text || "");
  byId("undo").title = `Undo${state.undo_words ? ` ${state.undo_words}` : ""} (Ctrl+Z)`;
  byId("redo").title = `Redo${state.redo_words ? ` ${state.redo_words}` : ""} (Ctrl+Shift+Z)`;
  const pushed = loaded();
  setText("target-words", pushed ? "It must carry its loads" : "It must carry");
  setText("target-unit", pushed ? "times" : "N");
  byId("must").hidden = !state.file || pushed;
  setText("script", (state.script || []).join("\n"));
  setText("saved", state.saved ? `saved in ${String(state.saved).split("/").pop()}` : "");
  view.locked = new Set(faces.flatMap((f, i) => (f.locked ? [i] : [])));
  renderAnswer();
  choose(chosen);
  symbols();
  if (view.scene) view.recolour();
  enable();
}

function renderRepair() {
  const repair = state.repair;
  setText("part-words", state.faces ? `${state.faces.length} faces` : "");
  setText("repair-words", !repair ? "" : repair.sound ? (repair.log?.length ? "" : "The surface is closed and sound.") :
    "The surface had faults and was repaired.");
  fill(byId("repair"), repair?.log || [], () => (repair?.log || []).map((line) => make("li", { textContent: line })));
}

function nextStep() {
  const conditions = state.conditions || [];
  if (!state.file) return "Open a part, choose faces, and say which are fixed and which are pushed.";
  if (state.units_plausible === false) return "Choose the unit of the file first.";
  if (!state.material) return "Choose a material, then faces that are fixed and faces that are pushed.";
  if (!conditions.some((c) => c.kind === "fix"))
    return conditions.length ? "Choose the faces where the part is screwed or glued, and press Fix." : "Choose the faces where the part is screwed or glued, and press Fix; or press Answer to see where it breaks first.";
  if (!conditions.some((c) => c.kind !== "fix")) return "Choose a face and press Push, Press or Turn; then Answer.";
  return "Ready: press Answer.";
}

function renderAnswer() {
  const { answer, busy } = state;
  const shown = answer?.sentence ? answer : null;
  byId("verdict").dataset.colour = shown && shown.verdict !== "none" ? shown.colour : "none";
  byId("verdict").setAttribute("aria-busy", String(!!busy));
  setText("verdict-words", busy ? `${busy.what.charAt(0).toUpperCase()}${busy.what.slice(1)} …` : shown ? shown.sentence : nextStep());
  setText("verdict-more", busy ? [busy.stage, busy.to_go_s && `about ${Math.ceil(busy.to_go_s)} s to go`].filter(Boolean).join(", ")
    : shown ? answerLine(shown) : "");
  byId("progress").hidden = !busy;
  byId("progress").value = busy?.fraction || 0;
  byId("cancel").hidden = !busy;
  byId("verdict-details").hidden = !shown;
  byId("place").hidden = !shown?.at || !!busy; // beside Answer there is room for one of both
  if (shown) {
    listNumbers(byId("numbers"), shown);
    fill(byId("notes"), shown.notes || [], () => (shown.notes || []).map((note) => make("li", { textContent: note })));
  }
  view.marker.visible = !!shown?.at;
  if (shown?.at) {
    view.marker.position.set(...shown.at);
    view.marker.scale.setScalar(0.011 * (view.size || 0));
  }
  const results = !!view.scene?.von_mises && (!!shown || pull.dragging);
  view.coloured = results;
  byId("legend").hidden = !results;
  if (results) setText("high", digits(view.range[1] / 1e6));
  bend();
}

// The deformation as large as is chosen; its factor is printed.
function bend() {
  const there = view.coloured && view.largest > 0;
  const factor = !there || !bending ? 0 : trueScale ? 1 : view.sensible;
  byId("bend").disabled = byId("true").disabled = !there;
  press("bend", bending && !trueScale);
  press("true", bending && trueScale);
  setText("times", !there ? "" : factor === 0 ? "at rest" : factor === 1 ? "true size" : `× ${digits(factor, 2)}`);
  if (view.scene && factor !== view.factor) view.deform(factor);
}

function symbols() {
  if (!view.surface || !state) return;
  const known = (state.conditions || []).filter((c) => !draft.changes(c));
  view.symbols.show([...known, ...draft.conditions()].map((c) => ({ ...c, faces: (c.faces || []).map((n) => indexOf(n) + 1) })),
    view.surface, view.rest, view.size);
  view.stage.touch();
}

function enable() {
  const ready = connected && !!state && !state.busy;
  const part = ready && !!state.file && state.units_plausible !== false;
  const some = part && chosen.size > 0;
  byId("undo").disabled = !(ready && state.undo);
  byId("redo").disabled = !(ready && state.redo);
  for (const id of ["save", "export", "advice", "optimise", "material", "symmetry"]) byId(id).disabled = !part;
  for (const id of ["push", "lock", "clear", "grow"]) byId(id).disabled = !some;
  for (const button of document.querySelectorAll("[data-act]")) button.disabled = !(button.dataset.act === "gravity" ? part : some);
  byId("thicken").disabled = !(part && clicked);
  byId("answer").disabled = !(part && state.material);
  byId("set-radius").disabled = !(some && chosen.size === 1 && state.faces[[...chosen][0]]?.radius);
}

// ---- faces: pointed at and chosen -------------------------------------------------------------------------------

function point(face) {
  view.hover(face);
}

function choose(faces) {
  chosen = new Set([...faces].filter((i) => i >= 0 && i < (state?.faces || []).length));
  if (view.scene) view.setSelected(chosen);
  for (const box of byId("faces").querySelectorAll("input")) box.checked = chosen.has(Number(box.value));
  const one = chosen.size === 1 ? state.faces[[...chosen][0]] : null;
  setText("chosen-words", chosen.size === 0 ? "none chosen" : one ? faceText(one) : `${chosen.size} chosen`);
  const all = chosen.size > 0 && [...chosen].every((i) => state.faces[i].locked);
  setText("lock", all ? "Unlock" : "Lock");
  if (one?.radius) follow("radius", Number((1000 * one.radius).toPrecision(4)));
  draft.facesChanged();
  pull.facesChanged();
  enable();
}

function tip(text, x, y) {
  const box = byId("view").getBoundingClientRect();
  byId("tip").hidden = !text;
  if (!text) return;
  byId("tip").textContent = text;
  const wide = byId("tip").offsetWidth;
  byId("tip").style.transform = `translate(${Math.max(4, Math.min(box.width - wide - 4, x - box.left + 14))}px, ` +
    `${Math.max(4, y - box.top - 34)}px)`;
}

function probeText(hit) {
  const moved = hit.displacement ? `\nmoves ${millimetres(Math.hypot(...hit.displacement))}` : "";
  return hit.von_mises === undefined || hit.von_mises === null ? "No stress yet: press Answer" : `${megapascals(hit.von_mises)}${moved}`;
}

listen(view, byId("frame"), () => pressed("box"), {
  point(hit, x, y) {
    point(hit ? hit.face : -1);
    byId("view").classList.toggle("picking", !!hit);
    const face = hit && state?.faces?.[hit.face];
    tip(!hit ? "" : pressed("probe") ? probeText(hit) : face ? faceText(face) : "", x, y);
  },
  choose(hit, add) {
    if (pressed("probe")) {
      if (hit) {
        say(probeText(hit).replace("\n", ", "));
        send("probe", { point: hit.rest });
      }
      return;
    }
    if (pressed("patch")) {
      if (!hit) return;
      splitting = { add: add || draft.open, id: send("grow", { point: hit.rest, radius: reach(), angle: 1.05 }) };
      return;
    }
    clicked = hit ? hit.rest : null;
    if (!hit || hit.face < 0) return add ? undefined : choose(new Set());
    const next = new Set(add || draft.open ? chosen : []);
    if (chosen.has(hit.face) && (add || chosen.size === 1)) next.delete(hit.face);
    else next.add(hit.face);
    choose(next);
  },
  within(faces, add, sides) {
    press("box", false);
    modes();
    if (faces.length) return choose(new Set([...(add ? chosen : []), ...faces]));
    // No whole face lies in the rectangle: what lies there becomes a face.
    splitting = { add, id: send("patch", view.planes(...sides)) };
  },
});

// How far a patch reaches (m).
function reach() {
  return Number((Number(byId("reach").value) * view.size).toPrecision(2));
}

const loaded = () => (state?.conditions || []).some((c) => c.kind !== "fix");

function modes() {
  byId("reach-of-patch").hidden = !pressed("patch");
  if (pressed("patch") && view.size) setText("reach-words", millimetres(reach()));
  view.stage.controls.enabled = !pressed("box");
  byId("view").classList.toggle("boxing", pressed("box") || pressed("patch"));
  byId("view").classList.toggle("probing", pressed("probe"));
}

function grow() {
  choose(new Set([...chosen, ...[...chosen].flatMap((f) => [...(view.surface.neighbours.get(f) || [])])]));
}

// ---- what is asked ------------------------------------------------------------------------------------------------

const context = { byId, view, handles, send, released: (id) => (released = state.answer || pull.live ? id : 0), say, symbols, numbers, chosen: () => chosen, state: () => state,
  choose: (list) => choose(new Set(list.map(indexOf))) };
const draft = new Draft(context);
const pull = new Pull(context);

byId("edit").addEventListener("toggle", () => pull.facesChanged());

click("fit", () => view.fit());
click("clear", () => choose(new Set()));
click("grow", grow);
click("undo", () => send("undo"));
click("redo", () => send("redo"));
click("save", () => send("save"));
click("advice", () => send("advice"));
click("cancel", () => send("cancel"));
function ask() {
  const force = number("must-carry");
  send("answer", { accuracy: byId("accuracy").value, ...(!loaded() && force > 0 ? { force } : {}) });
}
click("answer", ask);
click("lock", () => {
  const all = new Set(state.faces.filter((f) => f.locked).map((f) => f.index));
  const on = byId("lock").textContent === "Lock";
  for (const face of numbers()) all[on ? "add" : "delete"](face);
  send("lock", { faces: [...all] });
});
click("bend", () => {
  bending = !(bending && !trueScale);
  trueScale = false;
  bend();
});
click("true", () => {
  bending = !(bending && trueScale);
  trueScale = bending;
  bend();
});
click("place", () => {
  const at = state.answer.at;
  const [x, y, z] = view.outwards(at);
  view.fit([x + 0.3, y - 0.4, z + (z < -0.5 ? -0.3 : 0.3)]); // from outside, and not along the face's normal
});
const tools = ["box", "probe", "patch"]; // of which one is in use
for (const id of [...tools, "edges", "cut", "flip"])
  click(id, () => {
    press(id, !pressed(id));
    if (id === "edges" && view.lines) view.lines.visible = pressed(id);
    if (tools.includes(id) && pressed(id)) for (const other of tools) press(other, other === id);
    if (id === "cut") byId("section").hidden = !pressed(id);
    modes();
    section();
  });
function section() {
  view.section(pressed("cut") ? Number(byId("axis").value) : -1, Number(byId("share").value), pressed("flip"));
}
byId("axis").addEventListener("change", section);
byId("share").addEventListener("input", section);
byId("reach").addEventListener("input", modes);
byId("symmetry").addEventListener("change", () => send("symmetry", { across: byId("symmetry").value }));
byId("search").addEventListener("input", () => state && render());
byId("material").addEventListener("change", () => byId("material").value && send("material", { name: byId("material").value }));
byId("export").addEventListener("change", () => {
  if (byId("export").value) send("export", { format: byId("export").value });
  byId("export").value = "";
});
byId("unit-choices").append(...["mm", "cm", "m", "in"].map((unit) => make("button", { type: "button",
  textContent: { mm: "Millimetres", cm: "Centimetres", m: "Metres", in: "Inches" }[unit], on: { click: () => send("unit", { unit }) } })));

const number = (id) => (byId(id).value === "" ? NaN : Number(byId(id).value));
function submit(id, what) {
  byId(id).addEventListener("submit", (event) => {
    event.preventDefault();
    what();
  });
}
submit("push-form", () => {
  if (!number("distance")) return say("Give a distance in mm, not 0.", true);
  send("push", { faces: numbers(), distance: number("distance") / 1000 });
});
submit("radius-form", () => {
  if (!(number("radius") > 0)) return say("Give the radius in mm, above 0.", true);
  send("radius", { face: numbers()[0], radius: number("radius") / 1000 });
});
submit("offset-form", () => {
  if (!number("offset")) return say("Give a thickness in mm, not 0.", true);
  send("offset", { distance: number("offset") / 1000 });
});
submit("thicken-form", () => {
  if (!(number("bump") > 0 && number("bump-radius") > 0)) return say("Give both lengths in mm, above 0.", true);
  send("thicken", { at: clicked, radius: number("bump-radius") / 1000, offset: number("bump") / 1000 });
});
submit("thickness-form", () => {
  if (!(number("thickness") > 0)) return say("Give the thickness in mm, above 0.", true);
  send("thickness", { thickness: number("thickness") / 1000 });
});
submit("own-form", () => {
  const strength = number("own-strength");
  const density = number("own-density");
  send("material", { young: 1e9 * number("own-young"), poisson: number("own-poisson"),
    ...(strength > 0 ? { strength: 1e6 * strength } : {}), ...(density > 0 ? { density } : {}) });
});
submit("optimise-form", () => {
  const target = number("target");
  if (!(target > 0)) return say(loaded() ? "Give how many times its loads the part must carry." :
    "Give the force that the part must carry, in N.", true);
  send("optimise", loaded() ? { factor: target } : { force: target });
});

// ---- opening a file ---------------------------------------------------------------------------------------------------

async function upload(file) {
  if (!file) return;
  say(`Reading ${file.name} …`);
  choose(new Set());
  try {
    const answer = await fetch(`upload?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file });
    if (!answer.ok) say((await answer.text()).trim() || `${file.name} cannot be opened.`, true);
    else say("");
  } catch {
    say(`${file.name} did not reach the workbench: the connection is lost.`, true);
  }
}
click("open", () => byId("upload").click());
byId("upload").addEventListener("change", () => {
  upload(byId("upload").files[0]);
  byId("upload").value = "";
});
for (const kind of ["dragenter", "dragover"])
  window.addEventListener(kind, (event) => {
    event.preventDefault();
    byId("view").classList.add("over");
  });
window.addEventListener("dragleave", (event) => !event.relatedTarget && byId("view").classList.remove("over"));
window.addEventListener("drop", (event) => {
  event.preventDefault();
  byId("view").classList.remove("over");
  upload(event.dataTransfer.files[0]);
});

// ---- keys ------------------------------------------------------------------------------------------------------------------

const keys = { f: "fit", b: "box", g: "grow", e: "edges", p: "probe", x: "cut", n: "patch" };
window.addEventListener("keydown", (event) => {
  const key = event.key.toLowerCase();
  if (event.ctrlKey || event.metaKey) {
    const id = { z: event.shiftKey ? "redo" : "undo", y: "redo", s: "save" }[key];
    if (!id || (id !== "save" && event.target.matches("input[type=number], input[type=search]"))) return;
    event.preventDefault();
    if (!byId(id).disabled) byId(id).click();
  } else if (key === "escape") {
    draft.close();
    for (const tool of tools) press(tool, false);
    modes();
  } else if (!event.altKey && keys[key] && !event.target.matches("input, select")) byId(keys[key]).click();
});

const dark = window.matchMedia("(prefers-color-scheme: dark)");
const scheme = () => view.setDark(dark.matches);
dark.addEventListener("change", scheme);
scheme();
enable();

// For whoever drives the page by script.
window.barwright = {
  state: () => ({ connected, ...counts, file: state?.file, revision: state?.revision, chosen: state ? numbers() : [], hovered: view.hovered,
    conditions: state?.conditions, faces: state?.faces, answer: state?.answer, material: state?.material?.name, mass: state?.mass,
    script: state?.script, undo: state?.undo, redo: state?.redo, busy: state?.busy, size: state?.size, saved: state?.saved,
    said: byId("said").textContent, verdict: byId("verdict").dataset.colour, symbols: view.symbols.count, factor: view.factor,
    triangles: view.scene ? view.scene.triangles.length / 3 : 0, waiting: asked?.what, draft: draft.kind }),
  // A place of the window where a face is seen, or null where it is hidden.
  place(number) {
    const face = indexOf(number);
    const { positions, triangles } = view.scene;
    for (const t of view.surface.trianglesOfFaces.get(face) || []) {
      const middle = [0, 1, 2].map((k) => (positions[3 * triangles[3 * t] + k] + positions[3 * triangles[3 * t + 1] + k] +
        positions[3 * triangles[3 * t + 2] + k]) / 3);
      const [x, y] = view.toWindow(middle);
      if (document.elementFromPoint(x, y) === canvas && view.pick(x, y)?.face === face) return [x, y];
    }
    return null;
  },
  corners: () => view.corners(),
  young: () => state.material.young,
  view,
  send,
};
