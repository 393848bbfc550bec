// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The colour map: 0..1 -> sRGB bytes, between knots that the engine gave, so that pictures and pages
// show the same colours.
export function colourMap(knots) {
  return (t) => {
    const x = Math.min(1, Math.max(0, t)) * (knots.length - 1);
    const i = Math.min(knots.length - 2, Math.floor(x));
    const f = x - i;
    return [0, 1, 2].map((k) => Math.round(knots[i][k] * (1 - f) + knots[i + 1][k] * f));
  };
}

// For values about zero: blue below, nearly white at 0.5, red above.
export const diverging = colourMap([[33, 72, 160], [74, 128, 201], [150, 190, 229], [243, 243, 241], [240, 178, 140],
  [212, 98, 72], [150, 24, 40]]);
