// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Search over the sections of all pages (search.js holds them), and the menu of narrow windows.
const input = document.getElementById("search"), found = document.getElementById("found");
const menu = document.getElementById("menu"), pages = document.getElementById("pages");

menu.addEventListener("click", () => {
  const open = pages.classList.toggle("open");
  menu.setAttribute("aria-expanded", String(open));
});

// All words must stand in a section; those in its heading count most.
function score(section, words) {
  let sum = 0;
  const heading = section.heading.toLowerCase(), page = section.page.toLowerCase(), text = section.text.toLowerCase();
  for (const word of words) {
    const at = (heading.includes(word) ? 20 : 0) + (page.includes(word) ? 5 : 0) + (text.includes(word) ? 1 : 0);
    if (!at) return 0;
    sum += at;
  }
  return sum;
}

function excerpt(text, word) {
  const at = Math.max(0, text.toLowerCase().indexOf(word) - 60);
  return (at > 0 ? "…" : "") + text.slice(at, at + 180) + "…";
}

function show() {
  const words = input.value.toLowerCase().split(/\s+/).filter((word) => word.length > 1);
  found.replaceChildren();
  found.hidden = words.length === 0;
  if (found.hidden) return;
  const hits = sections.map((section) => ({ section, value: score(section, words) })).filter((hit) => hit.value)
    .sort((a, b) => b.value - a.value).slice(0, 20);
  if (!hits.length) found.append("No section contains all of these words.");
  for (const { section } of hits) {
    const line = document.createElement("p"), link = document.createElement("a"), small = document.createElement("small");
    link.href = root + section.address;
    link.textContent = section.heading === section.page ? section.page : section.page + ": " + section.heading;
    small.textContent = excerpt(section.text, words[0]);
    line.append(link, small);
    found.append(line);
  }
}

input.addEventListener("input", show);
// Words may be typed before this script runs.
if (input.value) show();
input.addEventListener("keydown", (event) => {
  if (event.key === "Escape") { input.value = ""; show(); }
  if (event.key === "Enter") found.querySelector("a")?.click();
});
found.addEventListener("click", () => { found.hidden = true; });
document.addEventListener("keydown", (event) => {
  if (event.key === "/" && document.activeElement !== input) { event.preventDefault(); input.focus(); }
});
