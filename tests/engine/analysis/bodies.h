/* Small bodies and numberings made by formula, for the tests of this folder. */
#ifndef BODIES_H
#define BODIES_H

#include "check.h"

/* A body of revolution-like bar along x, from 0 to 1, of square cross-section with half width
 * profile(x). */
typedef double (*bar_profile)(double x);

static inline void bar_map(void *data, const double unit[3], double out[3]) {
  bar_profile profile = *(bar_profile *)data;
  double h = profile(unit[0]);
  out[0] = unit[0];
  out[1] = h * (2 * unit[1] - 1);
  out[2] = h * (2 * unit[2] - 1);
}

static inline bw_mesh *make_bar(bw_context *context, bar_profile profile, int along, int across,
                                int order) {
  bw_mesh *mesh = NULL;
  const int cells[3] = {along, across, across};
  check_ok(context, bw_mesh_mapped_box(context, cells, order, bar_map, &profile, &mesh));
  return mesh;
}

static inline bw_mesh *make_box(bw_context *context, double x, double y, double z, int nx, int ny,
                                int nz, int order) {
  bw_mesh *mesh = NULL;
  const double low[3] = {0, 0, 0}, high[3] = {x, y, z};
  const int cells[3] = {nx, ny, nz};
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
  return mesh;
}

/* A cube with curved faces, for bw_mesh_mapped_box. */
static inline void bulge(void *data, const double unit[3], double out[3]) {
  (void)data;
  out[0] = unit[0] + 0.1 * sin(3 * unit[1]);
  out[1] = unit[1] * (1 + 0.3 * unit[0] * unit[0]);
  out[2] = 0.5 * unit[2] + 0.2 * unit[0] * unit[1];
}

static inline double straight_profile(double x) {
  (void)x;
  return 0.1;
}

/* Two heavy ends and a neck at x = 0.4. */
static inline double dumbbell_profile(double x) {
  double d = (x - 0.4) / 0.12;
  return 0.15 - 0.1 * exp(-d * d);
}

#endif
