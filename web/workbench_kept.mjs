// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// What a window of the workbench has for itself survives a reload: the chosen faces, the camera, the section plane, the
// tools in use, open panels, and values that were typed and not yet applied. The browser keeps it with the tab.

const key = `barwright workbench ${location.pathname}`; // of one session

// What belongs to the session, and comes from its state; files cannot be kept.
const ofSession = "#upload, #export, #material, #symmetry, #faces input";

const fields = () => [...document.querySelectorAll("input, select")].filter((one) => one.id && !one.matches(ofSession));
const panels = () => [...document.querySelectorAll("details")].filter((one) => one.id);
const switches = () => [...document.querySelectorAll("button[aria-pressed]")];

// waiting(): what was kept and is not put back yet, which stays kept; more(): what else is kept, a plain object.
export function keepOnLeaving(waiting, more) {
  window.addEventListener("pagehide", () => {
    const kept = waiting() || { ...more(), scrolled: document.querySelector("aside").scrollTop,
      fields: fields().map((one) => [one.id, one.value]), panels: panels().map((one) => [one.id, one.open]),
      switches: switches().map((one) => [one.id, one.getAttribute("aria-pressed")]) };
    try {
      sessionStorage.setItem(key, JSON.stringify(kept));
    } catch {
      // A browser without storage: the page begins as if it were new.
    }
  });
}

// What was kept when the page was left, once; null where there is nothing.
export function kept() {
  try {
    const found = JSON.parse(sessionStorage.getItem(key));
    sessionStorage.removeItem(key);
    return found;
  } catch {
    return null;
  }
}

// Puts values, panels and switches back; nothing is left to be put back.
export function putBack(found) {
  const at = (id) => document.getElementById(id);
  for (const [id, value] of found.fields) if (at(id)) at(id).value = value;
  for (const [id, open] of found.panels) if (at(id)) at(id).open = open;
  for (const [id, on] of found.switches) at(id)?.setAttribute("aria-pressed", on);
  document.querySelector("aside").scrollTop = found.scrolled;
  return null;
}
