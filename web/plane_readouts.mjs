// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// What the plane's page shows in numbers: stress or tone, level, what was reused, the shape, the edits.
import { number } from "./stage.mjs";

const byId = (id) => document.getElementById(id);

// Stresses and pressures in the unit that suits their size.
const pascals = [["Pa", 1], ["kPa", 1e-3], ["MPa", 1e-6], ["GPa", 1e-9]];
export const unitOf = (f, most) => /^[kMG]?Pa$/.test(f.unit)
  ? pascals[Math.min(3, Math.max(0, Math.floor(Math.log10(most || 1) / 3)))] : [f.unit, f.scale];

function rows(list, pairs) {
  byId(list).replaceChildren(...pairs.flatMap(([name, text]) => [
    Object.assign(document.createElement("dt"), { textContent: name }),
    Object.assign(document.createElement("dd"), { textContent: text })]));
}

function withUnit(element, text, unit) {
  element.textContent = `${text} `;
  element.append(Object.assign(document.createElement("small"), { textContent: unit }));
}

// The numbers of a state.
export function readouts(scene, state) {
  byId("level").textContent = state.level === "none" ? "same mesh" : state.level;
  byId("level").className = state.level;
  byId("reused").textContent = (state.reused.match(/reused ([^;]*)/) || [""])[0];
  byId("area").textContent = state.area < 0.01 ? `${number(state.area * 1e6)} mm²` : `${number(state.area)} m²`;
  byId("elements").textContent = state.elements;
  byId("iterations").textContent = state.iterations;
  byId("quality").textContent = state.quality === undefined ? "–" : number(state.quality);
  byId("time").textContent = state.seconds ? `${number(1000 * state.seconds)} ms` : "–";
  byId("levels").textContent = ["relocation", "reconnecting", "reconstruction"]
    .map((name) => state.levels[name] || 0).join(" / ");
  byId("levels").title = "relocation / reconnecting / reconstruction";
  byId("edits").textContent = state.edits;
  if (scene.stress) {
    const over = state.limit && state.maximum > state.limit;
    const [unit, scale] = unitOf({ unit: "Pa" }, state.maximum);
    withUnit(byId("maximum"), number(state.maximum * scale), over ? `${unit}, above the limit` : unit);
    byId("maximum").classList.toggle("over", !!over);
    if (document.activeElement !== byId("limit"))
      byId("limit").value = state.limit ? Number((state.limit / 1e6).toPrecision(6)) : "";
  }
  if (state.frequency)
    withUnit(byId("tone"), `${state.frequency.toFixed(1)} Hz`, `${state.note} ${state.cents >= 0 ? "+" : "−"}${Math.abs(state.cents).toFixed(1)} cents`);
  rows("results", [...(state.time === undefined ? [] : [["time", `${number(state.time)} s`]]), ...state.readouts]);
  if (scene.steps) {
    byId("pause").textContent = state.running ? "Pause" : "Go on";
    if (document.activeElement !== byId("pace")) byId("pace").value = state.pace;
  }
  byId("script").replaceChildren(...state.script.map((line) =>
    Object.assign(document.createElement("li"), { textContent: line.replace(/^assert\(object:/, "").replace(/\)$/, "")
      .replace(/-?\d+\.\d{5,}(e-?\d+)?/g, (x) => String(Number(Number(x).toPrecision(5)))) })));
}
