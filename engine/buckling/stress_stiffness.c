/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The initial-stress stiffness: blocks k_ij 1 with k_ij = integral of grad N_i . sigma grad N_j.
 * Every element's numbers are computed once, then rows are summed as those of the mass are. Its
 * derivative by the displacement takes the same strains at the same points. */
#include <math.h>
#include <string.h>

#include "analysis/strain.h"
#include "barwright/buckling.h"
#include "model/internal.h"

typedef struct stress_data {
  bwi_row_sums rows;
  const bw_model *model;
  const double *displacement;
  int pairs;          /* per element: b <= a */
  double *of_element; /* element_count x pairs */
  double *stress;     /* element_count: largest component, and what it would be if nothing in it */
  double *terms;      /* cancelled */
  double *values;
} stress_data;

/* Stress below this part of its terms is rounding. */
static const double rounding = 1e-11;

typedef struct element_points {
  int count, nodes;
  const int32_t *node;
  double l[BW_QUADRATURE_POINTS][4], volume[BW_QUADRATURE_POINTS];
  double gradient[BW_QUADRATURE_POINTS][10][3], strain[BW_QUADRATURE_POINTS][6];
  double slope[BW_QUADRATURE_POINTS][9]; /* du_i/dx_j at 3 i + j */
  double dilatation;                     /* mean of the volumetric strain */
} element_points;

/* Strain at the points of the stiffness's quadrature. */
static bw_status strain_points(bw_context *context, const bw_mesh *mesh, const double *displacement,
                               int64_t e, element_points *at, double *largest) {
  const int32_t *node = mesh->element + e * mesh->nodes_per_element;
  double x[10][3], weight[BW_QUADRATURE_POINTS], whole = 0;
  bwi_element_nodes(mesh, e, x);
  int degree = mesh->order == 1                            ? 1
               : bw_tet_is_straight((const double(*)[3])x) ? 2
                                                           : BWI_CURVED_DEGREE;
  at->count = bw_tet_quadrature(degree, at->l, weight);
  at->nodes = mesh->nodes_per_element;
  at->node = node;
  at->dilatation = 0;
  *largest = 0;
  for (int q = 0; q < at->count; q++) {
    double grad[9] = {0}, size = 0, (*g)[3] = at->gradient[q];
    double determinant = bw_tet_gradient(mesh->order, (const double(*)[3])x, at->l[q], g);
    if (!(determinant > 0))
      return bwi_fail_inverted(context, mesh, e, determinant);
    at->volume[q] = weight[q] * determinant / 6;
    for (int a = 0; a < mesh->nodes_per_element; a++)
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
          double term = displacement[3 * (int64_t)node[a] + i] * g[a][j];
          grad[3 * i + j] += term;
          size = fmax(size, fabs(term));
        }
    *largest = fmax(*largest, size);
    bwi_strain_of(grad, at->strain[q]);
    memcpy(at->slope[q], grad, sizeof grad);
    at->dilatation += at->volume[q] * (at->strain[q][0] + at->strain[q][1] + at->strain[q][2]);
    whole += at->volume[q];
  }
  at->dilatation /= whole;
  return BW_OK;
}

static void add_products(int nodes, const double (*g)[3], double volume, const double t[6],
                         double *out) {
  for (int a = 0; a < nodes; a++) {
    const double *r = g[a];
    double f[3] = {volume * (t[0] * r[0] + t[5] * r[1] + t[4] * r[2]),
                   volume * (t[5] * r[0] + t[1] * r[1] + t[3] * r[2]),
                   volume * (t[4] * r[0] + t[3] * r[1] + t[2] * r[2])};
    for (int b = 0; b <= a; b++)
      *out++ += f[0] * g[b][0] + f[1] * g[b][1] + f[2] * g[b][2];
  }
}

static bw_status element_numbers(bw_context *context, stress_data *s, int64_t e) {
  const bw_model *model = s->model;
  const double *c = bw_material_elasticity(model->material, e);
  double projected = bwi_projected_bulk(model->mesh, bw_material_of(model->material, e)), largest,
         stiffest = 0;
  double *out = s->of_element + e * s->pairs;
  element_points at;
  memset(out, 0, (size_t)s->pairs * sizeof *out);
  bw_status status = strain_points(context, model->mesh, s->displacement, e, &at, &largest);
  if (status != BW_OK)
    return status;
  for (int i = 0; i < 36; i++)
    stiffest = fmax(stiffest, fabs(c[i]));
  s->stress[e] = 0;
  s->terms[e] = largest * stiffest;
  for (int q = 0; q < at.count; q++) {
    double stress[6], heat[6] = {0}, *strain = at.strain[q];
    bwi_multiply6(c, strain, stress);
    for (int i = 0; i < 3; i++)
      stress[i] += projected * (at.dilatation - strain[0] - strain[1] - strain[2]);
    bwi_thermal_stress_at(model, (int32_t)e, at.l[q], heat);
    for (int i = 0; i < 6; i++) {
      stress[i] -= heat[i];
      s->stress[e] = fmax(s->stress[e], fabs(stress[i]));
      s->terms[e] = fmax(s->terms[e], fabs(heat[i]));
    }
    add_products(model->mesh->nodes_per_element, (const double(*)[3])at.gradient[q], at.volume[q],
                 stress, out);
  }
  return BW_OK;
}

typedef struct element_range {
  bw_context *context;
  stress_data *s;
} element_range;

static bw_status fill_elements(void *data, int64_t begin, int64_t end, int worker) {
  const element_range *range = data;
  (void)worker;
  bw_status status = BW_OK;
  for (int64_t e = begin; e < end && status == BW_OK; e++)
    status = element_numbers(range->context, range->s, e);
  return status;
}

static bw_status check_stress(bw_context *context, const stress_data *s) {
  double stress = 0, terms = 0;
  for (int64_t e = 0; e < s->model->mesh->element_count; e++) {
    stress = fmax(stress, s->stress[e]);
    terms = fmax(terms, s->terms[e]);
  }
  if (stress > rounding * terms)
    return BW_OK;
  return bw_fail(context, BW_INVALID,
                 "the loads and supports cause no stress (a body that is not loaded, or moved "
                 "without deformation): nothing can buckle. Add a load");
}

static bw_status gather_rows(void *data, int64_t begin, int64_t end, int worker) {
  const stress_data *s = data;
  const bwi_row_sums *r = &s->rows;
  int32_t *place = r->place + (int64_t)worker * r->pattern->node_count;
  for (int64_t i = begin; i < end; i++) {
    double *row = s->values + r->pattern->start[i];
    memset(row, 0, (size_t)bwi_row_places(r, i, place) * sizeof *row);
    for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++) {
      const int32_t *node = bwi_row_element(r, k);
      const double *own = s->of_element + (int64_t)r->incidence.element[k] * s->pairs;
      int a = r->incidence.local[k];
      for (int b = 0; b < r->nodes_per_element; b++)
        if (node[b] <= i)
          row[place[node[b]]] += a >= b ? own[a * (a + 1) / 2 + b] : own[b * (b + 1) / 2 + a];
    }
  }
  return BW_OK;
}

bw_status bw_stress_stiffness(bw_context *context, const bw_block_pattern *pattern,
                              const bw_model *model, const double *displacement, double *values) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = model->mesh;
  int n = mesh->nodes_per_element;
  stress_data s = {
      .model = model, .displacement = displacement, .pairs = n * (n + 1) / 2, .values = values};
  element_range range = {context, &s};
  BW_TRY(bwi_block_pattern_fits(context, pattern, mesh));
  s.of_element = BW_NEW(context, double, (int64_t)mesh->element_count *s.pairs);
  s.stress = BW_NEW(context, double, mesh->element_count);
  s.terms = BW_NEW(context, double, mesh->element_count);
  BW_TRY_MEMORY(s.of_element && s.stress && s.terms);
  BW_TRY(bw_parallel(context, mesh->element_count, 64, fill_elements, &range));
  BW_TRY(check_stress(context, &s));
  BW_TRY(bwi_row_sums_open(context, pattern, mesh->element_count, n, mesh->element, &s.rows));
  BW_TRY(bw_parallel(context, mesh->node_count, BWI_ROWS_PER_CHUNK, gather_rows, &s));
done:
  bwi_row_sums_close(&s.rows);
  bw_free(s.of_element);
  bw_free(s.stress);
  bw_free(s.terms);
  return status;
}

/* ---- the derivative by the displacement -------------------------------------------------------
 */

/* (grad u)^T grad v + (grad v)^T grad u over two, of grad[3 i + j] = du_i/dx_j, with twice the
 * shears. */
static void product_of(const double u[9], const double v[9], double product[6]) {
  static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {2, 0}, {0, 1}};
  for (int k = 0; k < 6; k++) {
    int i = pair[k][0], j = pair[k][1];
    double sum = 0;
    for (int c = 0; c < 3; c++)
      sum += u[3 * c + i] * v[3 * c + j] + v[3 * c + i] * u[3 * c + j];
    product[k] = k < 3 ? sum / 2 : sum;
  }
}

/* x . K_sigma(u) y = sum over points of volume C e : strain(u), with e the product of grad x and
 * grad y. The mean dilatation acts on both sides of the product alike. */
static void add_derivative(const element_points *x, const element_points *y, const double c[36],
                           double projected, double *gradient, double *work) {
  double e[BW_QUADRATURE_POINTS][6], mean = 0, whole = 0;
  for (int q = 0; q < x->count; q++) {
    product_of(x->slope[q], y->slope[q], e[q]);
    mean += x->volume[q] * (e[q][0] + e[q][1] + e[q][2]);
    whole += x->volume[q];
  }
  mean /= whole;
  for (int q = 0; q < x->count; q++) {
    double t[6], stress[6], volume = x->volume[q];
    const double *strain = x->strain[q];
    bwi_multiply6(c, e[q], t);
    bwi_multiply6(c, strain, stress);
    for (int i = 0; i < 3; i++) {
      t[i] += projected * (mean - e[q][0] - e[q][1] - e[q][2]);
      stress[i] += projected * (x->dilatation - strain[0] - strain[1] - strain[2]);
    }
    *work += volume * bwi_dot6(stress, y->strain[q]);
    for (int a = 0; a < x->nodes; a++) {
      const double *g = x->gradient[q][a];
      double *to = gradient + 3 * (int64_t)x->node[a];
      to[0] += volume * (t[0] * g[0] + t[5] * g[1] + t[4] * g[2]);
      to[1] += volume * (t[5] * g[0] + t[1] * g[1] + t[3] * g[2]);
      to[2] += volume * (t[4] * g[0] + t[3] * g[1] + t[2] * g[2]);
    }
  }
}

bw_status bw_stress_stiffness_gradient(bw_context *context, const bw_mesh *mesh,
                                       const bw_material *material, const double *x,
                                       const double *y, double *gradient, double *work) {
  bw_status status = BW_OK;
  element_points at[2];
  double largest;
  BW_TRY(bwi_check_stress_input(context, mesh, material, x, "the derivative"));
  memset(gradient, 0, 3 * (size_t)mesh->node_count * sizeof *gradient);
  *work = 0;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    BW_TRY(strain_points(context, mesh, x, e, &at[0], &largest));
    if (y != x)
      BW_TRY(strain_points(context, mesh, y, e, &at[1], &largest));
    add_derivative(&at[0], &at[y != x], bw_material_elasticity(material, e),
                   bwi_projected_bulk(mesh, bw_material_of(material, e)), gradient, work);
  }
done:
  return status;
}
