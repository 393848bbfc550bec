// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The lists beside the view: faces, supports and loads, advice, numbers of the answer. All text comes from the state.
import { digits, faceName, faceText, grams, heading, hertz, megapascals, millimetres, newtons, squared } from "./workbench_words.mjs";

const mostFaces = 200;

export function make(name, attributes = {}, ...children) {
  const { on, ...rest } = attributes;
  const one = Object.assign(document.createElement(name), rest);
  for (const [event, action] of Object.entries(on || {})) one.addEventListener(event, action);
  one.append(...children);
  return one;
}

// Replaces the children where what they show has changed, and keeps the focus where it was.
export function fill(element, key, children) {
  const text = JSON.stringify(key);
  if (element.dataset.key === text) return;
  element.dataset.key = text;
  const place = [...element.querySelectorAll("button, input")].indexOf(document.activeElement);
  element.replaceChildren(...children());
  if (place < 0) return;
  const now = element.querySelectorAll("button, input");
  (now[Math.min(place, now.length - 1)] || element).focus();
}

// Boxes to tick, one for each face that the search finds; the largest first.
export function listFaces(element, faces, search, toggle, point) {
  const wanted = search.toLowerCase();
  const found = faces.map((face, i) => ({ face, i })).filter(({ face }) => faceText(face).toLowerCase().includes(wanted))
    .sort((a, b) => b.face.area - a.face.area);
  fill(element, [faces, wanted], () => [
    make("legend", { className: "aside-of-sight", textContent: "Faces of the part" }),
    ...found.slice(0, mostFaces).map(({ face, i }) => make("label", {
      on: { pointerenter: () => point(i), pointerleave: () => point(-1) } },
      make("input", { type: "checkbox", value: i, on: { change: (e) => toggle(i, e.target.checked), focus: () => point(i),
        blur: () => point(-1) } }),
      make("span", { textContent: `${faceName(face)}${face.locked ? ", locked" : ""}` }),
      make("span", { textContent: squared(face.area) }))),
    ...(found.length > mostFaces ? [make("p", { className: "hint",
      textContent: `${found.length - mostFaces} smaller faces: search, or click them.` })] : [])]);
}

export const unitOf = { force: "N", pressure: "MPa", moment: "N m", gravity: "m/s²" };

const verbs = { force: "Push", pressure: "Press", moment: "Turn", gravity: "Gravity" };

function conditionWords({ kind, constrains, faces, value, vector }, all) {
  const of = (number) => all.find((f) => f.index === number);
  const where = !faces?.length ? "" : faces.length > 2 ? `: ${faces.length} faces` : `: ${faces.map((n) => faceName(of(n) || {})).join(" and ")}`;
  if (kind === "fix") return `${constrains === "normal" ? "Slides along" : "Fixed"}${where}`;
  const much = kind === "pressure" ? megapascals(value) : `${digits(value ?? Math.hypot(...vector))} ${unitOf[kind]}`;
  return `${verbs[kind] || kind} ${much}${vector && kind !== "moment" ? heading(vector) : ""}${where}`;
}

// does: {change(condition), remove(condition), point(faces)}
export function listConditions(element, conditions, faces, does) {
  fill(element, [conditions, faces], () => conditions.map((condition) => {
    const words = conditionWords(condition, faces);
    return make("li", { on: { pointerenter: () => does.point(condition.faces || []), pointerleave: () => does.point([]) } },
      make("span", { className: `dot ${condition.kind}` }), make("span", { textContent: words }),
      ...(condition.kind === "fix" ? [] : [make("button", { type: "button", className: "small", textContent: "Change",
        ariaLabel: `Change: ${words}`, on: { click: () => does.change(condition) } })]),
      make("button", { type: "button", className: "small", textContent: "Remove", ariaLabel: `Remove: ${words}`,
        on: { click: () => does.remove(condition) } }));
  }));
}

export function listAdvice(element, advice, does) {
  fill(element, advice, () => advice.map((one, i) => make("li", { on: { pointerenter: () => does.point(one.faces || []),
    pointerleave: () => does.point([]) } },
    make("span", { textContent: `${one.text}${one.gain ? ` (${one.gain > 0 ? "+" : ""}${Math.round(100 * one.gain)} %)` : ""}` }),
    make("button", { type: "button", className: "small", textContent: "Apply", ariaLabel: `Apply: ${one.text}`,
      on: { click: () => does.apply(i + 1) } }))));
}

// A value with its interval, as the sentences of the engine have it (shown.lua).
function interval(value, low, high, words) {
  const bounds = Number.isFinite(high) ? `${words(low)} to ${words(high)}`
    : low > 0 ? `at least ${words(low)}` : "error unknown";
  return `${words(value)} (${bounds})`;
}

const pairs = (rows) => rows.filter(Boolean).flatMap(([name, value]) => [make("dt", { textContent: name }),
  make("dd", { textContent: value })]);

export function listNumbers(element, answer) {
  const percent = (x) => `${digits(100 * x)} %`;
  fill(element, answer, () => pairs([
    answer.utilisation !== undefined && ["share of the strength",
      interval(answer.utilisation, answer.low, answer.high, percent)],
    answer.force !== undefined && ["breaks at",
      interval(answer.force, answer.force_low, answer.force_high, newtons)],
    answer.max_displacement !== undefined && ["moves by", millimetres(answer.max_displacement)],
    answer.frequency !== undefined && ["first natural frequency", hertz(answer.frequency)],
    answer.mass !== undefined && ["mass", grams(answer.mass)],
    answer.elements !== undefined && ["elements", String(answer.elements)],
    answer.seconds !== undefined && ["computed in", `${digits(answer.seconds)} s`]]));
}

export function listMaterial(element, material) {
  fill(element, material, () => (material ? pairs([["stiffness (Young's modulus)", `${digits(material.young / 1e9)} GPa`],
    material.strength && ["strength", megapascals(material.strength)],
    ["density", `${digits(material.density)} kg/m³`]]) : []));
}

// One line under the verdict: what a maker asks next.
export function answerLine(answer) {
  return [answer.force !== undefined && !/breaks at/.test(answer.sentence) &&
      `breaks at ${interval(answer.force, answer.force_low, answer.force_high, newtons)}`,
    answer.max_displacement !== undefined && `moves ${millimetres(answer.max_displacement)}`,
    answer.mass !== undefined && grams(answer.mass),
    answer.frequency !== undefined && `hums at ${hertz(answer.frequency)}`].filter(Boolean).join(" · ");
}
