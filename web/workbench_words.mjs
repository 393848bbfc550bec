// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Quantities as the workbench prints them: a few digits, with their unit.

export const digits = (x, n = 3) => {
  if (!Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e6 || size < 1e-3) return x.toExponential(n - 1).replace("e+", "e");
  return String(Number(x.toPrecision(Math.max(n, Math.min(6, Math.floor(Math.log10(size)) + 1)))));
};
export const millimetres = (x) => `${digits(1000 * x)} mm`;
export const squared = (x) => (x < 1e-4 ? `${digits(1e6 * x)} mm²` : `${digits(1e4 * x)} cm²`);
export const grams = (x) => (x >= 1 ? `${digits(x)} kg` : `${digits(1000 * x)} g`);
export const megapascals = (x) => `${digits(x / 1e6)} MPa`;
export const newtons = (x) => (x >= 1e4 ? `${digits(x / 1e3)} kN` : `${digits(x)} N`);
export const hertz = (x) => (x >= 1e4 ? `${digits(x / 1e3)} kHz` : `${digits(x)} Hz`);

const kinds = { plane: "flat face", cylinder: "round face", hole: "hole", cone: "cone", sphere: "ball", torus: "fillet", free: "curved face" };
const axes = [["right", "left"], ["back", "front"], ["up", "down"]];

// Where a flat face looks to: of the axis it is nearest to.
export function looks(normal) {
  if (!normal) return "";
  const k = [0, 1, 2].reduce((a, b) => (Math.abs(normal[b]) > Math.abs(normal[a]) ? b : a), 0);
  return Math.abs(normal[k]) > 0.99 ? `, ${axes[k][normal[k] > 0 ? 0 : 1]}` : "";
}

// Where a vector points to: an axis, or nothing where it is none.
export function heading(vector) {
  const size = Math.hypot(...vector) || 1;
  const k = [0, 1, 2].find((i) => Math.abs(vector[i]) > 0.999 * size);
  return k === undefined ? "" : k === 2 ? (vector[2] > 0 ? " up" : " down") : ` to ${vector[k] > 0 ? "+" : "−"}${"XY"[k]}`;
}

export function faceName(face) {
  const kind = face.name || kinds[face.kind] || face.kind || "face";
  return `${kind}${face.radius ? `, R ${millimetres(face.radius)}` : face.kind === "plane" ? looks(face.normal) : ""}`;
}

export const faceText = (face) => `${faceName(face)} · ${squared(face.area)}${face.locked ? " · locked" : ""}`;

const acronyms = new Set(["pla", "abs", "petg", "pa12", "pa", "pc", "asa", "tpu", "pom", "zp150", "pmma"]);
export const materialName = (name) => (acronyms.has(name) ? name.toUpperCase()
  : name.charAt(0).toUpperCase() + name.slice(1)).replaceAll("_", " ");
