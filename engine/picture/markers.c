/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The shapes of markers. */
#include "picture/canvas.h"

int bwi_marker_corners(bw_marker marker, double size, double corner[BWI_MARKER_CORNERS][2]) {
  /* of the unit marker: shapes are drawn with about the area of the disc */
  static const double a = 0.443, d = 0.627, t = 0.58, c = 0.4;
  const double square[4][2] = {{-a, -a}, {a, -a}, {a, a}, {-a, a}};
  const double diamond[4][2] = {{0, -d}, {d, 0}, {0, d}, {-d, 0}};
  const double up[3][2] = {{0, -1.1 * t}, {t, 0.8 * t}, {-t, 0.8 * t}};
  const double cross[4][2] = {{-c, -c}, {c, c}, {-c, c}, {c, -c}};
  const double plus[4][2] = {{-0.5, 0}, {0.5, 0}, {0, -0.5}, {0, 0.5}};
  const double(*from)[2] = marker == BW_SQUARE    ? square
                           : marker == BW_DIAMOND ? diamond
                           : marker == BW_CROSS   ? cross
                           : marker == BW_PLUS    ? plus
                                                  : up;
  int count = marker == BW_DISC ? 0 : marker == BW_TRIANGLE || marker == BW_TRIANGLE_DOWN ? 3 : 4;
  for (int i = 0; i < count; i++) {
    corner[i][0] = size * from[i][0];
    corner[i][1] = (marker == BW_TRIANGLE_DOWN ? -size : size) * from[i][1];
  }
  return count;
}
