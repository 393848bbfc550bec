/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Signs for the weak regions of Laplacian modes, which have no stress to take them from
 * (docs/theory/worst_case.md, "Laplacian modes").
 *
 * A mode phi strains a region along its gradient, in the direction e with the largest integral of
 * (e . grad phi)^2. Two things can happen there. A region that lies on one side of the body (a
 * notch, a fillet) is pulled or pushed as a whole: the sign of e . grad phi. A region that goes
 * through the body from side to side (a neck, a thin wall) is weakest in bending, about its
 * thinnest direction t across e: the sign of t . (x - c), c its centroid. It goes through when its
 * share of the boundary faces +t and -t alike. */
#include "analysis/weak_internal.h"

#include <math.h>
#include <string.h>

static const double both_sides = 0.5; /* least ratio of the areas that face +t and -t */

static void add_product(double tensor[6], double factor, const double x[3]) {
  tensor[0] += factor * x[0] * x[0];
  tensor[1] += factor * x[1] * x[1];
  tensor[2] += factor * x[2] * x[2];
  tensor[3] += factor * x[1] * x[2];
  tensor[4] += factor * x[2] * x[0];
  tensor[5] += factor * x[0] * x[1];
}

static void centroid(const bw_mesh *mesh, int32_t e, double x[3]) {
  const int32_t *node = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
  for (int k = 0; k < 3; k++) {
    x[k] = 0;
    for (int a = 0; a < 4; a++)
      x[k] += mesh->node[3 * (size_t)node[a] + (size_t)k] / 4;
  }
}

/* The direction across e in which the region extends least, and the region's centroid. */
static void thin_direction(const bw_mesh *mesh, const bw_weak_region *region, const double e[3],
                           double thin[3], double middle[3]) {
  double moment[6] = {0}, values[3], vectors[9];
  memset(middle, 0, 3 * sizeof *middle);
  for (int32_t i = 0; i < region->count; i++) {
    double x[3];
    centroid(mesh, region->element[i], x);
    for (int k = 0; k < 3; k++)
      middle[k] += mesh->volume[region->element[i]] / region->volume * x[k];
  }
  for (int32_t i = 0; i < region->count; i++) {
    double x[3];
    centroid(mesh, region->element[i], x);
    for (int k = 0; k < 3; k++)
      x[k] -= middle[k];
    double along = bw_dot(x, e);
    for (int k = 0; k < 3; k++)
      x[k] -= along * e[k];
    add_product(moment, mesh->volume[region->element[i]], x);
  }
  /* e itself has no moment left: the next larger one is sought. */
  bw_eigen3(moment, values, vectors);
  memcpy(thin, vectors + 3, 3 * sizeof *thin);
}

static bool goes_through(const bw_mesh *mesh, const bw_weak_region *region, const double thin[3]) {
  double front = 0, back = 0;
  for (int32_t i = 0; i < region->count; i++) {
    size_t e = (size_t)region->element[i];
    const int32_t *node = mesh->element + e * (size_t)mesh->nodes_per_element;
    for (int k = 0; k < 4; k++) {
      if (mesh->neighbour[4 * e + (size_t)k] >= 0)
        continue;
      const double *a = mesh->node + 3 * (size_t)node[bw_tet_face[k][0]];
      const double *b = mesh->node + 3 * (size_t)node[bw_tet_face[k][1]];
      const double *c = mesh->node + 3 * (size_t)node[bw_tet_face[k][2]];
      const double ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      const double ac[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      double area[3];
      bw_cross(ab, ac, area);
      double part = bw_dot(area, thin);
      *(part > 0 ? &front : &back) += fabs(part);
    }
  }
  return fmin(front, back) > both_sides * fmax(front, back);
}

void bwi_laplacian_weights(const bw_mesh *mesh, const bw_weak_region *region,
                           const double *gradient, double *weight) {
  double tensor[6] = {0}, values[3], vectors[9], thin[3], middle[3];
  for (int32_t i = 0; i < region->count; i++)
    add_product(tensor, mesh->volume[region->element[i]],
                gradient + 3 * (size_t)region->element[i]);
  bw_eigen3(tensor, values, vectors);
  const double *e = vectors;
  thin_direction(mesh, region, e, thin, middle);
  bool bent = goes_through(mesh, region, thin);
  for (int32_t i = 0; i < region->count; i++) {
    const double *g = gradient + 3 * (size_t)region->element[i];
    double x[3];
    centroid(mesh, region->element[i], x);
    for (int k = 0; k < 3; k++)
      x[k] -= middle[k];
    weight[i] = copysign(bw_norm(g), bent ? bw_dot(thin, x) : bw_dot(e, g));
  }
}
