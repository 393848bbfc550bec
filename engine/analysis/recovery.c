/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Superconvergent patch recovery (Zienkiewicz and Zhu 1992): at every corner node a polynomial of
 * the order of the elements is fitted by least squares to the stresses at points inside the
 * elements around it, where these are most accurate: the centre of tet4, the four points of degree
 * 2 of tet10.
 *
 * Patches at the boundary are one-sided and may be small: they grow across faces until they have
 * ENOUGH elements. Invariant: a stress that is a polynomial of that order is recovered exactly
 * wherever the fit is regular; elsewhere the order of the fit falls to 1 and to 0, the mean.
 *
 * The stress jumps where materials meet: a patch has elements of one material, and a node on an
 * interface has a stress point for each. */
#include "analysis/strain.h"
#include "base/dense.h"

#include "barwright/analysis.h"

#include <math.h>
#include <string.h>

enum { TERMS = 10, ENOUGH = 10, MAX_PATCH = 512, GROWTHS = 2, CORNERS_PER_CHUNK = 64 };

typedef struct recovery {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *displacement;
  const bw_stress_points *points;
  bwi_incidence around;
  bwi_rule rule;
  int32_t *corner; /* corner_count points */
  double *fit;     /* corner_count x TERMS x 6 */
  double *scale;   /* corner_count */
} recovery;

/* 1, x, y, z, then the products. */
static void monomials(const double y[3], double p[TERMS]) {
  const double all[TERMS] = {1,           y[0],        y[1],        y[2],        y[0] * y[0],
                             y[1] * y[1], y[2] * y[2], y[1] * y[2], y[2] * y[0], y[0] * y[1]};
  memcpy(p, all, sizeof all);
}

/* Solves A X = B for six right-hand sides and n terms; false where A is nearly singular. */
static bool solve_normal(int n, double a[TERMS][TERMS], double b[TERMS][6], double (*x)[6]) {
  double factor[TERMS * TERMS], column[TERMS];
  for (int i = 0; i < n; i++)
    memcpy(factor + (size_t)i * (size_t)n, a[i], (size_t)n * sizeof *factor);
  if (!bwi_cholesky(n, factor, 1e-8))
    return false;
  for (int c = 0; c < 6; c++) {
    for (int i = 0; i < n; i++)
      column[i] = b[i][c];
    bwi_lower_solve(n, factor, column);
    bwi_upper_solve(n, factor, column);
    for (int i = 0; i < n; i++)
      x[i][c] = column[i];
  }
  return true;
}

/* The elements of a corner's patch, its own first. */
static int patch_of(const recovery *r, int32_t point, int32_t *patch) {
  int32_t node = bw_stress_point_node(r->points, point);
  int count = 0;
  for (int64_t k = r->around.start[node]; k < r->around.start[node + 1] && count < MAX_PATCH; k++)
    if (bw_stress_point_has(r->points, point, r->material, r->around.element[k]))
      patch[count++] = r->around.element[k];
  for (int growth = 0; growth < GROWTHS && count < ENOUGH; growth++) {
    int before = count;
    for (int i = 0; i < before; i++)
      for (int f = 0; f < 4 && count < MAX_PATCH; f++) {
        int32_t next = r->mesh->neighbour[4 * (int64_t)patch[i] + f];
        bool known = next < 0 || !bw_stress_point_has(r->points, point, r->material, next);
        for (int j = 0; j < count && !known; j++)
          known = patch[j] == next;
        if (!known)
          patch[count++] = next;
      }
  }
  return count;
}

typedef struct sums {
  double a[TERMS][TERMS], b[TERMS][6];
} sums;

static void add_element(const recovery *r, int32_t e, const double centre[3], double scale,
                        sums *s) {
  bwi_element_state state;
  bwi_element_state_load(r->mesh, r->material, r->displacement, e, &state);
  const int32_t *node = r->mesh->element + (int64_t)e * state.nodes;
  for (int q = 0; q < r->rule.points; q++) {
    double strain[6], stress[6], y[3] = {0}, p[TERMS];
    bwi_strain_at(&state, r->rule.by_l[q], r->rule.l[q], strain);
    bwi_stress_of(&state, bw_material_elasticity(r->material, e), strain, stress);
    for (int k = 0; k < 3; k++) {
      for (int a = 0; a < state.nodes; a++)
        y[k] += r->rule.value[q][a] * r->mesh->node[3 * (int64_t)node[a] + k];
      y[k] = (y[k] - centre[k]) / scale;
    }
    monomials(y, p);
    for (int i = 0; i < TERMS; i++) {
      for (int j = 0; j <= i; j++)
        s->a[i][j] += p[i] * p[j];
      for (int c = 0; c < 6; c++)
        s->b[i][c] += p[i] * stress[c];
    }
  }
}

static bw_status fit_corners(void *data, int64_t begin, int64_t end, int worker) {
  const recovery *r = (const recovery *)data;
  static const int terms[3] = {TERMS, 4, 1};
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    int32_t patch[MAX_PATCH];
    int count = patch_of(r, r->corner[i], patch);
    const double *centre =
        r->mesh->node + 3 * (int64_t)bw_stress_point_node(r->points, r->corner[i]);
    double volume = 0, scale, (*fit)[6] = (double(*)[6])(r->fit + 6 * TERMS * i);
    for (int k = 0; k < count; k++)
      volume += r->mesh->volume[patch[k]];
    r->scale[i] = scale = cbrt(volume);
    sums s = {.a = {{0}}};
    for (int k = 0; k < count; k++)
      add_element(r, patch[k], centre, scale, &s);
    memset(fit, 0, 6 * TERMS * sizeof(double));
    bool fitted = false;
    for (int degree = r->mesh->order == 2 ? 0 : 1; degree < 3 && !fitted; degree++)
      fitted = solve_normal(terms[degree], s.a, s.b, fit);
  }
  return BW_OK;
}

/* stress += fraction of the polynomial of corner i at x */
static void add_fit(const recovery *r, int64_t i, const double x[3], double fraction,
                    double *stress) {
  int64_t node = bw_stress_point_node(r->points, r->corner[i]);
  const double *centre = r->mesh->node + 3 * node, *fit = r->fit + 6 * TERMS * i;
  double y[3], p[TERMS];
  for (int k = 0; k < 3; k++)
    y[k] = (x[k] - centre[k]) / r->scale[i];
  monomials(y, p);
  for (int t = 0; t < TERMS; t++)
    for (int c = 0; c < 6; c++)
      stress[c] += fraction * p[t] * fit[6 * t + c];
}

/* A place in the incidence of an element of the point's material. */
static int64_t first_around(const recovery *r, int32_t point) {
  int64_t k = r->around.start[bw_stress_point_node(r->points, point)];
  while (!bw_stress_point_has(r->points, point, r->material, r->around.element[k]))
    k++;
  return k;
}

bw_status bwi_recovered_point_stress(bw_context *context, const bw_mesh *mesh,
                                     const bw_material *material, const double *displacement,
                                     const bw_stress_points *points, double *stress) {
  bw_status status;
  recovery r = {.mesh = mesh, .material = material, .displacement = displacement, .points = points};
  int32_t corners = 0, *number = NULL;
  BW_TRY(bwi_check_stress_input(context, mesh, material, displacement, "a stress field"));
  BW_TRY(bwi_incidence_create(context, mesh, &r.around));
  bwi_rule_make(mesh->order, mesh->order == 2 ? 2 : 1, &r.rule);
  number = BW_NEW(context, int32_t, points->count);
  r.corner = BW_NEW(context, int32_t, points->count);
  r.scale = BW_NEW(context, double, points->count);
  BW_TRY_MEMORY(number && r.corner && r.scale);
  for (int32_t i = 0; i < points->count; i++) {
    number[i] = r.around.local[first_around(&r, i)] < 4 ? corners : -1;
    if (number[i] >= 0)
      r.corner[corners++] = i;
  }
  r.fit = BW_NEW(context, double, 6 * TERMS * (int64_t)corners);
  BW_TRY_MEMORY(r.fit);
  BW_TRY(bw_parallel(context, corners, CORNERS_PER_CHUNK, fit_corners, &r));
  memset(stress, 0, 6 * (size_t)points->count * sizeof *stress);
  for (int32_t i = 0; i < points->count; i++) {
    const double *x = mesh->node + 3 * (int64_t)bw_stress_point_node(points, i);
    if (number[i] >= 0) {
      add_fit(&r, number[i], x, 1, stress + 6 * (int64_t)i);
      continue;
    }
    int64_t at = first_around(&r, i);
    const int *end = bw_tet_edge[r.around.local[at] - 4];
    for (int k = 0; k < 2; k++)
      add_fit(&r, number[bw_stress_point_of(points, mesh, r.around.element[at], end[k])], x, 0.5,
              stress + 6 * (int64_t)i);
  }
done:
  bwi_incidence_clear(&r.around);
  bw_free(number);
  bw_free(r.corner);
  bw_free(r.scale);
  bw_free(r.fit);
  return status;
}

bw_status bw_recovered_stress(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                              const double *displacement, double *stress) {
  bw_status status;
  bw_stress_points points = {0};
  double *all = NULL;
  BW_TRY(bwi_check_stress_input(context, mesh, material, displacement, "a stress field"));
  BW_TRY(bw_stress_points_create(context, mesh, material, &points));
  all = BW_NEW(context, double, 6 * (int64_t)points.count);
  BW_TRY_MEMORY(all);
  BW_TRY(bwi_recovered_point_stress(context, mesh, material, displacement, &points, all));
  bwi_governing_stress(&points, mesh->node_count, all, stress);
done:
  bw_free(all);
  bw_stress_points_clear(&points);
  return status;
}
