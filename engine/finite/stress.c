/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Cauchy stress of deformed states, sigma = F S F^T / det F. */
#include <string.h>

#include "analysis/strain.h"
#include "finite/internal.h"
#include "model/internal.h"

/* One element at points l (count): stress (count x 6) and the deformed volume by the reference's
 * determinant, without weights. */
typedef struct stress_work {
  const bw_model *model;
  const double *displacement;
  double factor;
  bool expands;
  double (*of_element)[60]; /* element_count: at its nodes; NULL: means are wanted */
  double *mean;             /* element_count x 6 */
  int32_t inverted;
} stress_work;

static double stress_of(const double f[9], double determinant, const double s[6], double out[6]) {
  static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {2, 0}, {0, 1}};
  double t[9], fs[9] = {0};
  bwi_full_tensor(s, t);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        fs[3 * i + j] += f[3 * i + k] * t[3 * k + j];
  for (int p = 0; p < 6; p++) {
    const double *row = fs + 3 * pair[p][0], *other = f + 3 * pair[p][1];
    out[p] = (row[0] * other[0] + row[1] * other[1] + row[2] * other[2]) / determinant;
  }
  return determinant;
}

typedef struct point_state {
  double f[9], strain[6], determinant, reference;
} point_state;

static void point_at(const stress_work *work, int64_t e, const double (*x)[3], const double l[4],
                     point_state *p) {
  const bw_mesh *mesh = work->model->mesh;
  const int32_t *node = mesh->element + e * mesh->nodes_per_element;
  double g[10][3], h[9] = {0};
  p->reference = bw_tet_gradient(mesh->order, x, l, g);
  for (int a = 0; a < mesh->nodes_per_element; a++)
    for (int i = 0; i < 9; i++)
      h[i] += work->displacement[3 * (int64_t)node[a] + i / 3] * g[a][i % 3];
  p->determinant = bwi_finite_strain(h, p->f, p->strain);
}

static void stress_at(const stress_work *work, int64_t e, const double l[4], double projected,
                      double dilatation, const point_state *p, double out[6]) {
  const bw_model *model = work->model;
  double s[6], heat[6] = {0};
  bwi_multiply6(bw_material_elasticity(model->material, e), p->strain, s);
  for (int i = 0; i < 3; i++)
    s[i] += projected * (dilatation - p->strain[0] - p->strain[1] - p->strain[2]);
  if (work->expands)
    bwi_thermal_stress_at(model, (int32_t)e, l, heat);
  for (int i = 0; i < 6; i++)
    s[i] -= work->factor * heat[i];
  stress_of(p->f, p->determinant, s, out);
}

static bw_status stress_of_elements(void *data, int64_t begin, int64_t end, int worker) {
  stress_work *work = data;
  const bw_mesh *mesh = work->model->mesh;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    double projected = bwi_projected_bulk(mesh, bw_material_of(work->model->material, e)),
           dilatation = 0;
    double l[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS], x[10][3], whole = 0;
    double deformed = 0, sum[6] = {0}, own[6];
    point_state p;
    bwi_element_nodes(mesh, e, x);
    int points = bw_tet_quadrature(mesh->order == 1                            ? 1
                                   : bw_tet_is_straight((const double(*)[3])x) ? 2
                                                                               : BWI_CURVED_DEGREE,
                                   l, weight);
    for (int q = 0; q < points; q++) {
      point_at(work, e, (const double(*)[3])x, l[q], &p);
      if (!(p.determinant > 0 && p.reference > 0))
        __atomic_store_n(&work->inverted, (int32_t)e, __ATOMIC_RELAXED);
      dilatation += weight[q] * p.reference * (p.strain[0] + p.strain[1] + p.strain[2]);
      whole += weight[q] * p.reference;
    }
    dilatation /= whole;
    for (int q = 0; !work->of_element && q < points; q++) {
      point_at(work, e, (const double(*)[3])x, l[q], &p);
      stress_at(work, e, l[q], projected, dilatation, &p, own);
      double volume = weight[q] * p.reference * p.determinant;
      deformed += volume;
      for (int i = 0; i < 6; i++)
        sum[i] += volume * own[i];
    }
    for (int i = 0; !work->of_element && i < 6; i++)
      work->mean[6 * e + i] = sum[i] / deformed;
    for (int a = 0; work->of_element && a < mesh->nodes_per_element; a++) {
      double at[4];
      bwi_node_barycentric(a, at);
      point_at(work, e, (const double(*)[3])x, at, &p);
      if (!(p.determinant > 0))
        __atomic_store_n(&work->inverted, (int32_t)e, __ATOMIC_RELAXED);
      stress_at(work, e, at, projected, dilatation, &p, work->of_element[e] + 6 * a);
    }
  }
  return BW_OK;
}

/* Means by volume at points, in ascending order of elements. */
static bw_status average(bw_context *context, const bw_model *model, const bw_stress_points *points,
                         const double (*of_element)[60], double *out) {
  const bw_mesh *mesh = model->mesh;
  double *volume = BW_NEW0(context, double, points->count);
  if (!volume)
    return BW_MEMORY;
  memset(out, 0, 6 * (size_t)points->count * sizeof *out);
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      int64_t at = bw_stress_point_of(points, mesh, e, a);
      volume[at] += mesh->volume[e];
      for (int i = 0; i < 6; i++)
        out[6 * at + i] += mesh->volume[e] * of_element[e][6 * a + i];
    }
  for (int64_t i = 0; i < points->count; i++)
    for (int k = 0; k < 6 && volume[i] > 0; k++)
      out[6 * i + k] /= volume[i];
  bw_free(volume);
  return BW_OK;
}

bw_status bw_finite_stress(bw_context *context, const bw_model *model, const double *displacement,
                           double factor, bool on_nodes, double *stress) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = model->mesh;
  bw_stress_points points = {0};
  double *all = NULL;
  stress_work work = {.model = model,
                      .displacement = displacement,
                      .factor = factor,
                      .expands = bwi_model_expands(model),
                      .mean = stress,
                      .inverted = -1};
  BW_TRY(bwi_check_stress_input(context, mesh, model->material, displacement, "a stress field"));
  if (on_nodes) {
    work.of_element = bw_alloc(context, (size_t)mesh->element_count, sizeof *work.of_element);
    BW_TRY_MEMORY(work.of_element);
    BW_TRY(bw_stress_points_create(context, mesh, model->material, &points));
    all = BW_NEW(context, double, 6 * (int64_t)points.count);
    BW_TRY_MEMORY(all);
  }
  BW_TRY(bw_parallel(context, mesh->element_count, 256, stress_of_elements, &work));
  if (work.inverted >= 0)
    BW_TRY(bw_fail(context, BW_GEOMETRY,
                   "the displacement inverts an element: det F is not positive there, and it has "
                   "no Cauchy stress"));
  if (on_nodes) {
    BW_TRY(average(context, model, &points, (const double(*)[60])work.of_element, all));
    bwi_governing_stress(&points, mesh->node_count, all, stress);
  }
done:
  bw_free(work.of_element);
  bw_free(all);
  bw_stress_points_clear(&points);
  return status;
}
