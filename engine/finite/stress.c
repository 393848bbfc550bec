/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Cauchy stress of deformed states, sigma = F S F^T / det F. */
#include <string.h>

#include "analysis/strain.h"
#include "finite/internal.h"
#include "model/internal.h"

typedef struct stress_work {
  bw_context *context;
  const bw_model *model;
  const double *displacement;
  double factor;
  bool expands;
  double (*of_element)[60]; /* element_count: at its nodes; NULL: means are wanted */
  double *mean;             /* element_count x 6 */
  int32_t inverted;
} stress_work;

/* F S F^T / det F */
static void push_forward(const double f[9], double determinant, const double s[6], double out[6]) {
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
}

/* By volume of the deformed element. */
static void mean_stress(const stress_work *work, const bwi_finite_deformed *d, const double c[36],
                        double projected, double mean[6]) {
  double whole = 0, s[6], own[6];
  memset(mean, 0, 6 * sizeof *mean);
  for (int q = 0; q < d->count; q++) {
    double volume = d->volume[q] * d->determinant[q];
    bwi_finite_second_stress(d, d->strain[q], c, projected, s);
    for (int i = 0; i < 6; i++)
      s[i] -= work->factor * d->heat[q][i];
    push_forward(d->f[q], d->determinant[q], s, own);
    whole += volume;
    for (int i = 0; i < 6; i++)
      mean[i] += volume * own[i];
  }
  for (int i = 0; i < 6; i++)
    mean[i] /= whole;
}

/* False where det F is not positive at one of the nodes. */
static bool nodal_stress(const stress_work *work, int64_t e, const bwi_finite_deformed *d,
                         const double c[36], double projected, double (*out)[6]) {
  const bw_mesh *mesh = work->model->mesh;
  const int32_t *node = mesh->element + e * mesh->nodes_per_element;
  bool positive = true;
  for (int a = 0; a < mesh->nodes_per_element; a++) {
    double g[10][3], h[9], f[9], strain[6], s[6], heat[6] = {0}, at[4];
    bwi_gradients_at_node(mesh, e, a, g);
    bwi_finite_gradient(mesh->nodes_per_element, (const double(*)[3])g, node, work->displacement,
                        h);
    double determinant = bwi_finite_strain(h, f, strain);
    positive = positive && determinant > 0;
    bwi_finite_second_stress(d, strain, c, projected, s);
    if (work->expands) {
      bwi_node_barycentric(a, at);
      bwi_thermal_stress_at(work->model, (int32_t)e, at, heat);
    }
    for (int i = 0; i < 6; i++)
      s[i] -= work->factor * heat[i];
    push_forward(f, determinant, s, out[a]);
  }
  return positive;
}

static bw_status stress_of_elements(void *data, int64_t begin, int64_t end, int worker) {
  stress_work *work = data;
  bw_status status = BW_OK;
  const bw_model *model = work->model;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    const double *c = bw_material_elasticity(model->material, e);
    double projected = bwi_projected_bulk(model->mesh, bw_material_of(model->material, e));
    bwi_finite_deformed d;
    BW_TRY(bwi_finite_deform(work->context, model, work->displacement, e, work->expands, &d));
    bool positive = !d.inverted;
    if (work->of_element)
      positive =
          nodal_stress(work, e, &d, c, projected, (double(*)[6])work->of_element[e]) && positive;
    else
      mean_stress(work, &d, c, projected, work->mean + 6 * e);
    if (!positive)
      __atomic_store_n(&work->inverted, (int32_t)e, __ATOMIC_RELAXED);
  }
done:
  return status;
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
  stress_work work = {.context = context,
                      .model = model,
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
