/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Loads of a case as forces at nodes.
 *
 * A triangle with the points x0, x1, x2 and the pressure p pushes with -p a, where a = (x1 - x0) x
 * (x2 - x0) / 2, one third at each point: the integral of constant pressure with linear functions.
 * Points go with the solid's trilinear displacements. */
#include <math.h>
#include <string.h>

#include "nonlinear/load_case.h"

void bwi_embedding_rest(const bw_embedding *embedding, double *rest) {
  const bw_grid *grid = embedding->grid;
  for (int64_t p = 0; p < embedding->point_count; p++) {
    const int32_t *corner = grid->element + 8 * (int64_t)embedding->element[p];
    double *x = rest + 3 * p;
    x[0] = x[1] = x[2] = 0;
    for (int c = 0; c < 8; c++) {
      double at[3];
      bw_grid_position(grid, corner[c], at);
      for (int d = 0; d < 3; d++)
        x[d] += embedding->weight[8 * p + c] * at[d];
    }
  }
}

/* Positions of a patch's points, moved by u (NULL: at rest), in x; v there in y where it is
 * given. */
static bw_status patch_points(bw_context *context, const bw_pressure_patch *patch, const double *u,
                              const double *v, double **x, double **y, double **force) {
  const bw_embedding *embedding = patch->embedding;
  size_t size = 3 * (size_t)embedding->point_count;
  *x = BW_NEW(context, double, size);
  *y = v || u ? BW_NEW(context, double, size) : NULL;
  *force = BW_NEW0(context, double, size);
  if (!*x || ((v || u) && !*y) || !*force)
    return BW_MEMORY;
  bwi_embedding_rest(embedding, *x);
  if (u) {
    bw_embedding_values(embedding, 3, u, *y);
    for (size_t i = 0; i < size; i++)
      (*x)[i] += (*y)[i];
  }
  if (v)
    bw_embedding_values(embedding, 3, v, *y);
  return BW_OK;
}

static void push(const bw_pressure_patch *patch, const double *x, const double *along,
                 double factor, double *force) {
  for (int64_t t = 0; t < patch->triangle_count; t++) {
    const int32_t *point = patch->triangle + 3 * t;
    double e[2][3], s[2][3], area[3], other[3];
    for (int k = 0; k < 2; k++)
      for (int d = 0; d < 3; d++) {
        e[k][d] = x[3 * (int64_t)point[k + 1] + d] - x[3 * (int64_t)point[0] + d];
        s[k][d] =
            along ? along[3 * (int64_t)point[k + 1] + d] - along[3 * (int64_t)point[0] + d] : 0;
      }
    if (along) {
      bw_cross(s[0], e[1], area);
      bw_cross(e[0], s[1], other);
      for (int d = 0; d < 3; d++)
        area[d] += other[d];
    } else
      bw_cross(e[0], e[1], area);
    for (int c = 0; c < 3; c++)
      for (int d = 0; d < 3; d++)
        force[3 * (int64_t)point[c] + d] -= factor * patch->pressure[t] * area[d] / 6;
  }
}

/* `u` NULL: at rest; `v`: the derivative along it. */
static bw_status add_patch(bw_context *context, const bw_pressure_patch *patch, const double *u,
                           const double *v, double factor, double *force) {
  bw_status status = BW_OK;
  double *x = NULL, *y = NULL, *at_points = NULL;
  BW_TRY(patch_points(context, patch, u, v, &x, &y, &at_points));
  push(patch, x, v ? y : NULL, factor, at_points);
  bw_embedding_add(patch->embedding, 3, at_points, force);
done:
  bw_free(x);
  bw_free(y);
  bw_free(at_points);
  return status;
}

bw_status bwi_load_case_dead(bw_context *context, const bw_solid *solid, const bw_load_case *it,
                             double *force) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)it->grid->node_count;
  bool heavy = bw_norm(it->gravity) > 0;
  if (heavy && solid->weightless)
    return bw_fail(context, BW_INVALID,
                   "gravity needs the density of the material, which is not given");
  for (int64_t i = 0; i < size; i++)
    force[i] = it->force[i] + (heavy ? solid->mass[i / 3] * it->gravity[i % 3] : 0);
  for (int32_t p = 0; p < it->patch_count; p++)
    if (!it->patch[p].follower)
      BW_TRY(add_patch(context, &it->patch[p], NULL, NULL, 1, force));
done:
  return status;
}

bool bwi_load_case_follows(const bw_load_case *it) {
  for (int32_t p = 0; p < it->patch_count; p++)
    if (it->patch[p].follower)
      return true;
  return false;
}

bw_status bwi_load_case_follow(bw_context *context, const bw_load_case *it, const double *u,
                               double factor, double *force) {
  return bwi_load_case_follow_along(context, it, u, NULL, factor, force);
}

bw_status bwi_load_case_follow_along(bw_context *context, const bw_load_case *it, const double *u,
                                     const double *v, double factor, double *force) {
  bw_status status = BW_OK;
  for (int32_t p = 0; p < it->patch_count; p++)
    if (it->patch[p].follower)
      BW_TRY(add_patch(context, &it->patch[p], u, v, factor, force));
done:
  return status;
}

/* Moving point k of a triangle by v changes its area vector by s_k x v / 2, s_k the side opposite
 * to it, from the next point to the one after, so every point's force by -p/6 s_k x v. The
 * potential's second derivative between points c and k then is p/6 [s_k x], its symmetric part p/12
 * [(s_k - s_c) x]. */
static void add_block(const bw_embedding *embedding, int32_t c, int32_t k, const double axis[3],
                      const bw_block_pattern *pattern, double *values) {
  const bw_grid *grid = embedding->grid;
  const double cross[9] = {0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0};
  for (int a = 0; a < 8; a++)
    for (int b = 0; b < 8; b++) {
      int32_t row = grid->element[8 * (int64_t)embedding->element[c] + a],
              column = grid->element[8 * (int64_t)embedding->element[k] + b];
      double weight = embedding->weight[8 * (int64_t)c + a] * embedding->weight[8 * (int64_t)k + b];
      int64_t block = column <= row && weight != 0 ? bwi_block_index(pattern, row, column) : -1;
      for (int i = 0; block >= 0 && i < 9; i++)
        values[9 * block + i] += weight * cross[i];
    }
}

bw_status bwi_load_case_follow_stiffness(bw_context *context, const bw_load_case *it,
                                         const double *u, double factor,
                                         const bw_block_pattern *pattern, double *values) {
  bw_status status = BW_OK;
  for (int32_t p = 0; p < it->patch_count; p++) {
    const bw_pressure_patch *patch = &it->patch[p];
    double *x = NULL, *y = NULL, *force = NULL;
    if (!patch->follower)
      continue;
    status = patch_points(context, patch, u, NULL, &x, &y, &force);
    for (int64_t t = 0; status == BW_OK && t < patch->triangle_count; t++) {
      const int32_t *point = patch->triangle + 3 * t;
      double side[3][3], axis[3];
      for (int c = 0; c < 3; c++)
        for (int d = 0; d < 3; d++)
          side[c][d] =
              x[3 * (int64_t)point[(c + 2) % 3] + d] - x[3 * (int64_t)point[(c + 1) % 3] + d];
      for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
          for (int d = 0; d < 3; d++)
            axis[d] = factor * patch->pressure[t] / 12 * (side[k][d] - side[c][d]);
          if (c != k)
            add_block(patch->embedding, point[c], point[k], axis, pattern, values);
        }
    }
    bw_free(x);
    bw_free(y);
    bw_free(force);
    BW_TRY(status);
  }
done:
  return status;
}
