/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A cover of the half sphere by spherical triangles, which are divided into four. */
#include "analysis/worst_internal.h"

#include <math.h>
#include <string.h>

enum { FACES = BWI_HALF_ICOSAHEDRON };

static void normalise(double v[3]) {
  double length = bw_norm(v);
  for (int k = 0; k < 3; k++)
    v[k] /= length;
}

void bwi_half_icosahedron(bwi_triangle *face) {
  const double g = (1 + sqrt(5)) / 2;
  static const int list[FACES][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8}};
  const double point[12][3] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                               {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                               {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  for (int f = 0; f < FACES; f++)
    for (int c = 0; c < 3; c++) {
      memcpy(face[f].corner[c], point[list[f][c]], sizeof face[f].corner[c]);
      normalise(face[f].corner[c]);
    }
}

double bwi_triangle_centre(const bwi_triangle *t, double n[3]) {
  double min = 1;
  for (int k = 0; k < 3; k++)
    n[k] = t->corner[0][k] + t->corner[1][k] + t->corner[2][k];
  normalise(n);
  for (int c = 0; c < 3; c++)
    min = fmin(min, bw_dot(n, t->corner[c]));
  return 2 * min * min - 1;
}

void bwi_divide_triangle(const bwi_triangle *t, bwi_triangle part[4]) {
  double middle[3][3];
  for (int c = 0; c < 3; c++) {
    for (int k = 0; k < 3; k++)
      middle[c][k] = t->corner[c][k] + t->corner[(c + 1) % 3][k];
    normalise(middle[c]);
  }
  for (int c = 0; c < 3; c++) {
    memcpy(part[c].corner[0], t->corner[c], sizeof middle[0]);
    memcpy(part[c].corner[1], middle[c], sizeof middle[0]);
    memcpy(part[c].corner[2], middle[(c + 2) % 3], sizeof middle[0]);
  }
  memcpy(part[3].corner, middle, sizeof middle);
}
