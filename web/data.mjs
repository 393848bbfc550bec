// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The page's data, parsed once. What it holds: web/README.md.
export const data = JSON.parse(document.getElementById("data").textContent);
