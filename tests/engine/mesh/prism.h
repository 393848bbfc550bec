/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Surfaces of prisms for tests. */
#ifndef BARWRIGHT_TESTS_PRISM_H
#define BARWRIGHT_TESTS_PRISM_H

#include "check.h"

/* A star-shaped profile (x, y) from z = 0, scaled by `top` at z = height; caps are fans around
 * `centre`. */
static bw_surface *prism(bw_context *context, int n, const double (*profile)[2],
                         const double centre[2], double height, double top) {
  double *point = malloc(3 * (2 * (size_t)n + 2) * sizeof *point);
  int32_t *triangle = malloc(12 * (size_t)n * sizeof *triangle), at = 0;
  bw_surface *surface = NULL;
  assert_true(point && triangle);
  for (int i = 0; i <= n; i++)
    for (int level = 0; level < 2; level++) {
      double *x = point + 3 * (2 * i + level), scale = level ? top : 1;
      const double *from = i < n ? profile[i] : centre;
      x[0] = scale * from[0];
      x[1] = scale * from[1];
      x[2] = level * height;
    }
  for (int i = 0; i < n; i++) {
    int32_t a = 2 * i, b = 2 * ((i + 1) % n);
    const int32_t four[12] = {a, b, b + 1, a, b + 1, a + 1, 2 * n, b, a, 2 * n + 1, a + 1, b + 1};
    memcpy(triangle + at, four, sizeof four);
    at += 12;
  }
  check_ok(context, bw_surface_copy(context, 2 * n + 2, point, 4 * n, triangle, NULL, &surface));
  free(point);
  free(triangle);
  return surface;
}

#endif
