/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Internal forces and tangents of St. Venant-Kirchhoff elements in the total Lagrangian formulation
 * (docs/theory/finite.md). Every element's numbers are computed once; forces are then summed in
 * ascending order of elements, and tangents row by row as initial-stress stiffnesses are. */
#include <math.h>
#include <string.h>

#include "analysis/strain.h"
#include "finite/internal.h"
#include "model/internal.h"

enum { ELEMENTS_PER_CHUNK = 64 };

typedef struct evaluation {
  bw_context *context;
  bwi_finite_elements *elements;
  bwi_finite_state *state;
  double *tangent; /* element_count x blocks x 9 */
  int blocks;
} evaluation;

double bwi_finite_strain(const double h[9], double f[9], double strain[6]) {
  static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {2, 0}, {0, 1}};
  bwi_strain_of(h, strain);
  for (int k = 0; k < 6; k++) {
    int i = pair[k][0], j = pair[k][1];
    double product = h[i] * h[j] + h[3 + i] * h[3 + j] + h[6 + i] * h[6 + j];
    strain[k] += k < 3 ? product / 2 : product;
  }
  for (int i = 0; i < 9; i++)
    f[i] = h[i] + (i % 4 == 0);
  return f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) +
         f[2] * (f[3] * f[7] - f[4] * f[6]);
}

void bwi_finite_gradient(int nodes, const double (*g)[3], const int32_t *node,
                         const double *displacement, double h[9]) {
  memset(h, 0, 9 * sizeof *h);
  for (int a = 0; a < nodes; a++)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        h[3 * i + j] += displacement[3 * (int64_t)node[a] + i] * g[a][j];
}

bw_status bwi_finite_deform(bw_context *context, const bw_model *model, const double *displacement,
                            int64_t e, bool expands, bwi_finite_deformed *d) {
  const bw_mesh *mesh = model->mesh;
  const int32_t *node = mesh->element + e * mesh->nodes_per_element;
  double x[10][3], l[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS], h[9];
  bwi_element_nodes(mesh, e, x);
  int degree = mesh->order == 1                            ? 1
               : bw_tet_is_straight((const double(*)[3])x) ? 2
                                                           : BWI_CURVED_DEGREE;
  d->count = bw_tet_quadrature(degree, l, weight);
  d->nodes = mesh->nodes_per_element;
  d->whole = d->dilatation = 0;
  d->inverted = false;
  for (int q = 0; q < d->count; q++) {
    double determinant = bw_tet_gradient(mesh->order, (const double(*)[3])x, l[q], d->gradient[q]);
    if (!(determinant > 0))
      return bwi_fail_inverted(context, mesh, e, determinant);
    d->volume[q] = weight[q] * determinant / 6;
    bwi_finite_gradient(d->nodes, (const double(*)[3])d->gradient[q], node, displacement, h);
    double *strain = d->strain[q];
    d->determinant[q] = bwi_finite_strain(h, d->f[q], strain);
    if (!(d->determinant[q] > 0))
      d->inverted = true;
    d->whole += d->volume[q];
    d->dilatation += d->volume[q] * (strain[0] + strain[1] + strain[2]);
    memset(d->heat[q], 0, sizeof d->heat[q]);
    if (expands)
      bwi_thermal_stress_at(model, (int32_t)e, l[q], d->heat[q]);
  }
  d->dilatation /= d->whole;
  return BW_OK;
}

void bwi_finite_second_stress(const bwi_finite_deformed *d, const double strain[6],
                              const double c[36], double projected, double stress[6]) {
  bwi_multiply6(c, strain, stress);
  for (int i = 0; i < 3; i++)
    stress[i] += projected * (d->dilatation - strain[0] - strain[1] - strain[2]);
}

/* s g of a tensor in Voigt's order. */
static void apply(const double s[6], const double g[3], double out[3]) {
  out[0] = s[0] * g[0] + s[5] * g[1] + s[4] * g[2];
  out[1] = s[5] * g[0] + s[1] * g[1] + s[3] * g[2];
  out[2] = s[4] * g[0] + s[3] * g[1] + s[2] * g[2];
}

static void add_forces(const bwi_finite_deformed *d, int q, const double stress[6], double *force) {
  const double *f = d->f[q];
  for (int a = 0; a < d->nodes; a++) {
    double t[3];
    apply(stress, d->gradient[q][a], t);
    for (int i = 0; i < 3; i++)
      force[3 * a + i] +=
          d->volume[q] * (f[3 * i] * t[0] + f[3 * i + 1] * t[1] + f[3 * i + 2] * t[2]);
  }
}

/* Rows of b: the derivative of the strain by a node's displacement. */
static void strain_rows(const double f[9], const double g[3], double b[6][3]) {
  for (int i = 0; i < 3; i++) {
    const double *r = f + 3 * i;
    b[0][i] = r[0] * g[0];
    b[1][i] = r[1] * g[1];
    b[2][i] = r[2] * g[2];
    b[3][i] = r[1] * g[2] + r[2] * g[1];
    b[4][i] = r[2] * g[0] + r[0] * g[2];
    b[5][i] = r[0] * g[1] + r[1] * g[0];
  }
}

/* mean: nodes x 3, volume times the derivative of the dilatation. */
static void add_tangent(const bwi_finite_deformed *d, int q, const double c[36], double projected,
                        const double stress[6], double *mean, double *out) {
  double b[10][6][3], volume = d->volume[q];
  const double(*g)[3] = (const double(*)[3])d->gradient[q];
  for (int a = 0; a < d->nodes; a++) {
    double t[3], cb[6][3] = {{0}}, *sum = mean + 3 * a;
    strain_rows(d->f[q], g[a], b[a]);
    apply(stress, g[a], t);
    double trace[3];
    for (int i = 0; i < 3; i++) {
      trace[i] = b[a][0][i] + b[a][1][i] + b[a][2][i];
      sum[i] += volume * trace[i];
    }
    for (int k = 0; k < 6; k++)
      for (int m = 0; m < 6; m++)
        for (int i = 0; i < 3; i++)
          cb[k][i] += c[6 * k + m] * b[a][m][i];
    for (int k = 0; k < 3; k++)
      for (int i = 0; i < 3; i++)
        cb[k][i] -= projected * trace[i];
    for (int o = 0; o <= a; o++, out += 9) {
      double geometric = volume * (t[0] * g[o][0] + t[1] * g[o][1] + t[2] * g[o][2]);
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
          double s = 0;
          for (int k = 0; k < 6; k++)
            s += cb[k][i] * b[o][k][j];
          out[3 * i + j] += volume * s;
        }
      for (int i = 0; i < 9; i += 4)
        out[i] += geometric;
    }
  }
}

static void lower_to(int32_t *lowest, int32_t value) {
  int32_t old = __atomic_load_n(lowest, __ATOMIC_RELAXED);
  while (
      (old < 0 || value < old) &&
      !__atomic_compare_exchange_n(lowest, &old, value, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
    ;
}

static double size_of(const double e[6]) {
  return sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] +
              (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]) / 2);
}

static bw_status evaluate_element(evaluation *work, int64_t e) {
  const bwi_finite_elements *elements = work->elements;
  const bw_model *model = elements->model;
  const double *c = bw_material_elasticity(model->material, e);
  double projected = bwi_projected_bulk(model->mesh, bw_material_of(model->material, e));
  int n = model->mesh->nodes_per_element;
  double *force = elements->of_element + e * (6 * n + 2), *heat = force + 3 * n;
  double *energy = heat + 3 * n, mean[30] = {0};
  double *tangent = work->tangent ? work->tangent + e * work->blocks * 9 : NULL;
  bwi_finite_deformed d;
  memset(force, 0, (size_t)(6 * n + 2) * sizeof *force);
  if (tangent)
    memset(tangent, 0, (size_t)work->blocks * 9 * sizeof *tangent);
  bw_status status =
      bwi_finite_deform(work->context, model, work->state->displacement, e, elements->expands, &d);
  if (status != BW_OK)
    return status;
  if (d.inverted) {
    lower_to(&work->state->inverted, (int32_t)e);
    return BW_OK;
  }
  for (int q = 0; q < d.count; q++) {
    double stress[6];
    bwi_finite_second_stress(&d, d.strain[q], c, projected, stress);
    *energy += d.volume[q] * 0.5 * bwi_dot6(stress, d.strain[q]);
    energy[1] = fmax(energy[1], size_of(d.strain[q]));
    if (elements->expands) {
      *energy -= work->state->factor * d.volume[q] * bwi_dot6(d.heat[q], d.strain[q]);
      for (int i = 0; i < 6; i++)
        stress[i] -= work->state->factor * d.heat[q][i];
      add_forces(&d, q, d.heat[q], heat);
    }
    add_forces(&d, q, stress, force);
    if (tangent)
      add_tangent(&d, q, c, projected, stress, mean, tangent);
  }
  if (tangent && projected > 0)
    for (int a = 0; a < n; a++)
      for (int b = 0; b <= a; b++, tangent += 9)
        for (int i = 0; i < 9; i++)
          tangent[i] += projected / d.whole * mean[3 * a + i / 3] * mean[3 * b + i % 3];
  return BW_OK;
}

static bw_status evaluate_elements(void *data, int64_t begin, int64_t end, int worker) {
  bw_status status = BW_OK;
  (void)worker;
  for (int64_t e = begin; e < end && status == BW_OK; e++)
    status = evaluate_element(data, e);
  return status;
}

static bw_status gather_rows(void *data, int64_t begin, int64_t end, int worker) {
  const evaluation *work = data;
  const bwi_row_sums *r = &work->elements->rows;
  int32_t *place = r->place + (int64_t)worker * r->pattern->node_count;
  for (int64_t i = begin; i < end; i++) {
    double *row = work->state->tangent + 9 * r->pattern->start[i];
    memset(row, 0, 9 * (size_t)bwi_row_places(r, i, place) * sizeof *row);
    for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++) {
      const int32_t *node = bwi_row_element(r, k);
      const double *own = work->tangent + (int64_t)r->incidence.element[k] * work->blocks * 9;
      int a = r->incidence.local[k];
      for (int b = 0; b < r->nodes_per_element; b++) {
        if (node[b] > i)
          continue;
        double *to = row + 9 * (int64_t)place[node[b]];
        const double *block = own + 9 * (a >= b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a);
        for (int j = 0; j < 9; j++)
          to[j] += a >= b ? block[j] : block[3 * (j % 3) + j / 3];
      }
    }
  }
  return BW_OK;
}

bw_status bwi_finite_elements_open(bw_context *context, const bw_model *model,
                                   const bw_block_pattern *pattern, bwi_finite_elements *elements) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = model->mesh;
  int n = mesh->nodes_per_element;
  *elements = (bwi_finite_elements){
      .model = model, .pattern = pattern, .expands = bwi_model_expands(model)};
  BW_TRY(bwi_block_pattern_fits(context, pattern, mesh));
  elements->of_element = BW_NEW(context, double, (int64_t)mesh->element_count *(6 * n + 2));
  BW_TRY_MEMORY(elements->of_element);
  BW_TRY(
      bwi_row_sums_open(context, pattern, mesh->element_count, n, mesh->element, &elements->rows));
done:
  return status;
}

void bwi_finite_elements_clear(bwi_finite_elements *elements) {
  bwi_row_sums_close(&elements->rows);
  bw_free(elements->of_element);
  *elements = (bwi_finite_elements){0};
}

static void sum_forces(const bwi_finite_elements *elements, bwi_finite_state *state) {
  const bw_mesh *mesh = elements->model->mesh;
  int n = mesh->nodes_per_element;
  size_t size = 3 * (size_t)mesh->node_count * sizeof(double);
  memset(state->force, 0, size);
  if (state->heat)
    memset(state->heat, 0, size);
  state->energy = state->strain = 0;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const double *own = elements->of_element + e * (6 * n + 2);
    for (int a = 0; a < n; a++) {
      int64_t at = 3 * (int64_t)mesh->element[e * n + a];
      for (int i = 0; i < 3; i++) {
        state->force[at + i] += own[3 * a + i];
        if (state->heat)
          state->heat[at + i] += own[3 * (n + a) + i];
      }
    }
    state->energy += own[6 * n];
    state->strain = fmax(state->strain, own[6 * n + 1]);
  }
}

bw_status bwi_finite_evaluate(bw_context *context, bwi_finite_elements *elements,
                              bwi_finite_state *state) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = elements->model->mesh;
  int n = mesh->nodes_per_element;
  evaluation work = {
      .context = context, .elements = elements, .state = state, .blocks = n * (n + 1) / 2};
  state->inverted = -1;
  if (state->tangent) {
    work.tangent = BW_NEW(context, double, (int64_t)mesh->element_count *work.blocks * 9);
    BW_TRY_MEMORY(work.tangent);
  }
  BW_TRY(bw_parallel(context, mesh->element_count, ELEMENTS_PER_CHUNK, evaluate_elements, &work));
  if (state->inverted >= 0)
    goto done;
  sum_forces(elements, state);
  if (state->tangent)
    BW_TRY(bw_parallel(context, mesh->node_count, BWI_ROWS_PER_CHUNK, gather_rows, &work));
done:
  bw_free(work.tangent);
  return status;
}

/* ---- states that are not to be inverted ------------------------------------------------------ */

typedef struct node_check {
  const bw_mesh *mesh;
  const double *displacement;
  int32_t inverted;
} node_check;

static bw_status check_elements(void *data, int64_t begin, int64_t end, int worker) {
  node_check *check = data;
  const bw_mesh *mesh = check->mesh;
  (void)worker;
  for (int64_t e = begin; e < end; e++)
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      double g[10][3], h[9], f[9], strain[6];
      bwi_gradients_at_node(mesh, e, a, g);
      bwi_finite_gradient(mesh->nodes_per_element, (const double(*)[3])g,
                          mesh->element + e * mesh->nodes_per_element, check->displacement, h);
      if (!(bwi_finite_strain(h, f, strain) > 0))
        lower_to(&check->inverted, (int32_t)e);
    }
  return BW_OK;
}

bw_status bwi_finite_inverted_at_nodes(bw_context *context, const bw_mesh *mesh,
                                       const double *displacement, int32_t *inverted) {
  node_check check = {mesh, displacement, -1};
  bw_status status =
      bw_parallel(context, mesh->element_count, ELEMENTS_PER_CHUNK, check_elements, &check);
  *inverted = check.inverted;
  return status;
}

static bw_status fail_inverted(bw_context *context, int32_t element) {
  bw_fail(context, BW_GEOMETRY, "the displacement inverts element %d: det F is not positive there",
          element + 1);
  bw_detail_number(context, "element", element + 1);
  return BW_GEOMETRY;
}

bw_status bw_finite_forces(bw_context *context, const bw_model *model,
                           const bw_block_pattern *pattern, const double *displacement,
                           double factor, double *energy, double *force, double *tangent) {
  bw_status status = BW_OK;
  bwi_finite_elements elements = {0};
  bwi_finite_state state = {
      .displacement = displacement, .factor = factor, .force = force, .tangent = tangent};
  BW_TRY(bwi_finite_elements_open(context, model, pattern, &elements));
  BW_TRY(bwi_finite_evaluate(context, &elements, &state));
  if (state.inverted >= 0)
    BW_TRY(fail_inverted(context, state.inverted));
  *energy = state.energy;
done:
  bwi_finite_elements_clear(&elements);
  return status;
}
