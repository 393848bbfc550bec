// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Rows of a report's tables: the first ten of a ranked one, and rows that are chosen with mouse or keyboard.
const FIRST = 10;

// Hides all but the first rows, with a button that shows them.
export function rankedRows(table) {
  const more = table ? Array.from(table.tBodies[0].rows).slice(FIRST) : [];
  if (more.length === 0) return;
  const button = document.createElement("button");
  button.type = "button";
  button.id = "more";
  const show = (all) => {
    for (const row of more) row.hidden = !all;
    button.setAttribute("aria-expanded", all);
    button.textContent = all ? `Show the first ${FIRST}` : `Show all ${FIRST + more.length}`;
  };
  button.addEventListener("click", () => show(button.getAttribute("aria-expanded") !== "true"));
  show(false);
  table.parentElement.after(button);
}

// Rows with a displacement: a click, Enter or the space bar chooses it, the arrow keys go to the next one.
export function rowsByKey(rows, choose) {
  const list = Array.from(rows);
  const near = (i, by) => {
    for (let k = i + by; list[k]; k += by) if (!list[k].hidden) return list[k].focus();
  };
  list.forEach((row, i) => {
    row.tabIndex = 0;
    const chosen = () => choose(Number(row.dataset.motion));
    row.addEventListener("click", chosen);
    row.addEventListener("keydown", (e) => {
      const act = { Enter: chosen, " ": chosen, ArrowDown: () => near(i, 1), ArrowUp: () => near(i, -1) }[e.key];
      if (!act) return;
      e.preventDefault();
      act();
    });
  });
}
