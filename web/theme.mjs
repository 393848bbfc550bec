// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Light or dark, as the person's system asks for: what is drawn on canvases follows the page's style.

const dark = window.matchMedia("(prefers-color-scheme: dark)");

// Calls `apply(background)` now and where the system changes.
export function themed(apply) {
  const now = () => apply(dark.matches ? 0x1a2027 : 0xf7f8fa);
  dark.addEventListener("change", now);
  now();
}

// The colour of lines on the background.
export const ink = () => (dark.matches ? "#e4e9f1" : "#1d2733");
