/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How the mean stress over a surface patch changes with the shape (docs/theory/strengthen.md).
 *
 * Middle nodes are variables of their own: inside an element, curved or not, the shape changes by
 * V(x) = sum_a dx_a N_a(x), so with nodal values held d(grad u) = -(grad u)(grad V) and
 * d(volume) = tr(grad V) volume at every point of quadrature. */
#include "analysis/pressure.h"
#include "analysis/strain.h"
#include "analysis/surface_patch.h"

#include "barwright/analysis.h"

#include <math.h>
#include <string.h>

enum { ELEMENTS_PER_CHUNK = 128, NODES_PER_CHUNK = 1024 };

/* ---- small pieces ---------------------------------------------------------------------------- */

static void full_tensor(const double s[6], double t[9]) {
  const double full[9] = {s[0], s[5], s[4], s[5], s[1], s[3], s[4], s[3], s[2]};
  memcpy(t, full, sizeof full);
}

static void add(double *to, double factor, const double v[3]) {
  for (int c = 0; c < 3; c++)
    to[c] += factor * v[c];
}

/* grad[3 i + j] = du_i/dx_j of nodal values u, g the gradients of the shape functions */
static void gradient_of(int nodes, const int32_t *node, const double *u, const double (*g)[3],
                        double grad[9]) {
  memset(grad, 0, 9 * sizeof *grad);
  for (int a = 0; a < nodes; a++)
    for (int i = 0; i < 3; i++)
      add(grad + 3 * i, u[3 * (size_t)node[a] + (size_t)i], g[a]);
}

static void stress_at(const bw_material *material, int64_t element, const double grad[9],
                      double t[9]) {
  const double strain[6] = {grad[0],           grad[4],           grad[8],
                            grad[5] + grad[7], grad[6] + grad[2], grad[1] + grad[3]};
  double stress[6];
  bwi_multiply6(bw_material_elasticity(material, element), strain, stress);
  full_tensor(stress, t);
}

/* a += factor * b^T c */
static void add_transposed_product(double a[9], double factor, const double b[9],
                                   const double c[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      a[3 * i + j] += factor * (b[i] * c[j] + b[3 + i] * c[3 + j] + b[6 + i] * c[6 + j]);
}

/* ---- the patch ------------------------------------------------------------------------------- */

typedef struct patch {
  const bw_mesh *mesh;
  bwi_surface_patches patches;
  int32_t centre;
  int32_t *facet; /* of the patch, facet_count */
  double *share;  /* facet_count x samples */
  size_t facets;
  double total;
  double *weight; /* node_count: of the nodal stresses in the mean; sums to one */
} patch;

static void add_facet(void *data, int32_t facet, const double share[BWI_PATCH_SAMPLES]) {
  patch *p = (patch *)data;
  const int32_t *node = p->mesh->facet + (size_t)facet * (size_t)p->mesh->nodes_per_facet;
  p->facet[p->facets] = facet;
  memcpy(p->share + p->facets++ * BWI_PATCH_SAMPLES, share, BWI_PATCH_SAMPLES * sizeof *share);
  for (int k = 0; k < BWI_PATCH_SAMPLES; k++) {
    p->total += share[k];
    for (int a = 0; a < p->mesh->nodes_per_facet; a++)
      p->weight[node[a]] += share[k] * p->patches.weight[k][a];
  }
}

static bw_status patch_begin(bw_context *context, const bw_mesh *mesh, double radius, int32_t node,
                             patch *p) {
  bw_status status;
  *p = (patch){.mesh = mesh, .centre = node};
  p->patches.mesh = mesh;
  BW_TRY(bwi_surface_patches_begin(context, mesh, radius, &p->patches));
  if (node < 0 || node >= mesh->node_count ||
      p->patches.around.start[node] == p->patches.around.start[node + 1])
    return bw_fail(context, BW_INVALID, "node %d is not on the boundary", node);
  p->facet = BW_NEW(context, int32_t, mesh->facet_count);
  p->share = BW_NEW(context, double, (size_t)mesh->facet_count *BWI_PATCH_SAMPLES);
  p->weight = BW_NEW0(context, double, mesh->node_count);
  if (!p->facet || !p->share || !p->weight)
    return BW_MEMORY;
  bwi_surface_patch_visit(&p->patches, node, 1, 0, add_facet, p);
  for (int32_t i = 0; i < mesh->node_count && p->total > 0; i++)
    p->weight[i] /= p->total;
  if (!(p->total > 0)) { /* the radius is less than the first sample's distance */
    p->facets = 0;
    p->weight[node] = 1;
  }
done:
  return status;
}

static void patch_clear(patch *p) {
  bwi_surface_patches_clear(&p->patches);
  bw_free(p->facet);
  bw_free(p->share);
  bw_free(p->weight);
}

bw_status bw_patch_functional(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                              double radius, int32_t node, const double slope[6], double *force) {
  bw_status status;
  patch p;
  int32_t count = 0, *list = NULL;
  double *weight = NULL;
  BW_TRY(patch_begin(context, mesh, radius, node, &p));
  list = BW_NEW(context, int32_t, mesh->node_count);
  weight = BW_NEW(context, double, 6 * (size_t)mesh->node_count);
  if (!list || !weight) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t i = 0; i < mesh->node_count; i++) {
    if (p.weight[i] == 0)
      continue;
    for (int c = 0; c < 6; c++)
      weight[6 * (size_t)count + (size_t)c] = p.weight[i] * slope[c];
    list[count++] = i;
  }
  BW_TRY(bw_stress_functional(context, mesh, material, count, list, weight, force));
done:
  patch_clear(&p);
  bw_free(list);
  bw_free(weight);
  return status;
}

/* ---- what changes at held displacements ------------------------------------------------------ */

/* Shape functions' gradients at local node a of an element, and du/dx there. */
static void gradients_at_node(const bw_mesh *mesh, int64_t element, int a, const double *u,
                              double (*g)[3], double grad[9]) {
  bwi_gradients_at_node(mesh, element, a, g);
  gradient_of(mesh->nodes_per_element, mesh->element + element * mesh->nodes_per_element, u,
              (const double(*)[3])g, grad);
}

/* slope . sigma of one element at one of its nodes; S = C : slope in full, for the derivative */
static double slope_stress(const bw_material *material, int64_t element, const double slope[6],
                           const double grad[9], double s[9]) {
  double conjugate[6], sum = 0;
  bwi_multiply6(bw_material_elasticity(material, element), slope, conjugate);
  full_tensor(conjugate, s);
  for (int i = 0; i < 9; i++)
    sum += s[i] * grad[i];
  return sum;
}

/* slope . sigma at a node: the mean by volume of the elements around; gradient += factor times its
 * derivative where `gradient` is given. */
static double nodal_value(const bw_mesh *mesh, const bw_material *material,
                          const bwi_incidence *around, const double *u, const double slope[6],
                          int32_t node, double factor, double *gradient) {
  double value = 0, volume = 0, g[10][3], grad[9], s[9];
  for (int64_t k = around->start[node]; k < around->start[node + 1]; k++) {
    int64_t e = around->element[k];
    gradients_at_node(mesh, e, around->local[k], u, g, grad);
    volume += mesh->volume[e];
    value += mesh->volume[e] * slope_stress(material, e, slope, grad, s);
  }
  value /= volume;
  for (int64_t k = around->start[node]; gradient && k < around->start[node + 1]; k++) {
    int64_t e = around->element[k];
    const int32_t *own = mesh->element + e * mesh->nodes_per_element;
    double corner[4][3], a[9] = {0}, share = factor * mesh->volume[e] / volume;
    gradients_at_node(mesh, e, around->local[k], u, g, grad);
    double off = slope_stress(material, e, slope, grad, s) - value;
    add_transposed_product(a, -share, grad, s);
    for (int i = 0; i < mesh->nodes_per_element; i++)
      for (int c = 0; c < 3; c++)
        gradient[3 * (size_t)own[i] + (size_t)c] += bw_dot(a + 3 * c, g[i]);
    bw_tet_barycentric_gradient(mesh->node + 3 * (int64_t)own[0], mesh->node + 3 * (int64_t)own[1],
                                mesh->node + 3 * (int64_t)own[2], mesh->node + 3 * (int64_t)own[3],
                                corner);
    for (int i = 0; i < 4; i++)
      add(gradient + 3 * (size_t)own[i], share * off, corner[i]);
  }
  return value;
}

/* gradient += factor * d (area) of a facet */
static void add_area(const bw_mesh *mesh, const int32_t *node, double factor, double *gradient) {
  const double *a = mesh->node + 3 * (size_t)node[0], *b = mesh->node + 3 * (size_t)node[1],
               *c = mesh->node + 3 * (size_t)node[2];
  double u[3], v[3], n[3], by_b[3], by_c[3];
  for (int k = 0; k < 3; k++)
    u[k] = b[k] - a[k], v[k] = c[k] - a[k];
  bw_cross(u, v, n);
  double size = bw_norm(n);
  for (int k = 0; k < 3; k++)
    n[k] /= 2 * size;
  bw_cross(v, n, by_b);
  bw_cross(n, u, by_c);
  add(gradient + 3 * (size_t)node[1], factor, by_b);
  add(gradient + 3 * (size_t)node[2], factor, by_c);
  add(gradient + 3 * (size_t)node[0], -factor, by_b);
  add(gradient + 3 * (size_t)node[0], -factor, by_c);
}

/* gradient += d (mean) by the weights of the samples, `value` at the nodes held */
static void add_weights(const patch *p, const double *value, double mean, double *gradient) {
  const bw_mesh *mesh = p->mesh;
  const double *centre = mesh->node + 3 * (size_t)p->centre;
  double square = p->patches.radius * p->patches.radius;
  for (size_t f = 0; f < p->facets; f++) {
    const int32_t *node = mesh->facet + (size_t)p->facet[f] * (size_t)mesh->nodes_per_facet;
    double by_area = 0, area = p->patches.area[p->facet[f]];
    for (int k = 0; k < BWI_PATCH_SAMPLES; k++) {
      double share = p->share[f * BWI_PATCH_SAMPLES + (size_t)k], off = -mean, arm[3];
      const double *weight = p->patches.weight[k];
      if (!(share > 0))
        continue;
      for (int c = 0; c < 3; c++)
        arm[c] = -centre[c];
      for (int a = 0; a < mesh->nodes_per_facet; a++) {
        off += weight[a] * value[node[a]];
        add(arm, weight[a], mesh->node + 3 * (size_t)node[a]);
      }
      off /= p->total;
      by_area += off * share / area;
      double factor = -2 * off * area / (BWI_PATCH_SAMPLES * square);
      for (int a = 0; a < mesh->nodes_per_facet; a++)
        add(gradient + 3 * (size_t)node[a], factor * weight[a], arm);
      add(gradient + 3 * (size_t)p->centre, -factor, arm);
    }
    add_area(mesh, node, by_area, gradient);
  }
}

/* ---- adjoint . (G p - K u) ------------------------------------------------------------------- */

typedef struct work_data {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *u, *adjoint;
  bwi_incidence around;
  bwi_rule straight, curved;
  double *part; /* element_count x nodes x 3 */
  double *gradient;
} work_data;

static bw_status element_pass(void *data, int64_t begin, int64_t end, int worker) {
  const work_data *d = (const work_data *)data;
  int nodes = d->mesh->nodes_per_element;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    const int32_t *node = d->mesh->element + e * nodes;
    double x[10][3], *part = d->part + 3 * e * nodes;
    bwi_element_nodes(d->mesh, e, x);
    bool straight = d->mesh->order == 1 || bw_tet_is_straight((const double(*)[3])x);
    const bwi_rule *rule = straight ? &d->straight : &d->curved;
    memset(part, 0, 3 * (size_t)nodes * sizeof *part);
    for (int q = 0; q < rule->points; q++) {
      double g[10][3], grad_u[9], grad[9], tau[9], sigma[9], a[9] = {0}, work = 0;
      double volume = rule->weight[q] / 6 *
                      bw_tet_gradient(d->mesh->order, (const double(*)[3])x, rule->l[q], g);
      gradient_of(nodes, node, d->u, (const double(*)[3])g, grad_u);
      gradient_of(nodes, node, d->adjoint, (const double(*)[3])g, grad);
      stress_at(d->material, e, grad_u, tau);
      stress_at(d->material, e, grad, sigma);
      for (int i = 0; i < 9; i++)
        work += tau[i] * grad[i];
      add_transposed_product(a, volume, grad, tau);
      add_transposed_product(a, volume, grad_u, sigma);
      for (int i = 0; i < 3; i++)
        a[4 * i] -= volume * work;
      for (int i = 0; i < nodes; i++)
        for (int c = 0; c < 3; c++)
          part[3 * i + c] += bw_dot(a + 3 * c, g[i]);
    }
  }
  return BW_OK;
}

static bw_status gather_pass(void *data, int64_t begin, int64_t end, int worker) {
  const work_data *d = (const work_data *)data;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    for (int64_t k = d->around.start[i]; k < d->around.start[i + 1]; k++)
      add(d->gradient + 3 * i, 1,
          d->part + 3 * ((int64_t)d->around.element[k] * d->mesh->nodes_per_element +
                         d->around.local[k]));
  return BW_OK;
}

/* gradient += d of - integral of p (adjoint . n + price) dA over a facet. With s = x_u x x_v, n dA
 * is s/2 times the weight. */
static void add_pressure(const bw_patch_state *state, const bwi_pressure_rule *rule, int32_t facet,
                         double *gradient) {
  const bw_mesh *mesh = state->basis->mesh;
  const int32_t *node = mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
  const int32_t *column = state->basis->facet_column + state->basis->facet_start[facet];
  for (int q = 0; q < rule->points; q++) {
    double by[6][3], shape[6], xu[3] = {0}, xv[3] = {0}, s[3], v[3] = {0}, p = 0;
    for (int i = rule->per_point * q; i < rule->per_point * (q + 1); i++) {
      int32_t j = column[rule->which[i]];
      p += j < 0 ? 0 : rule->value[i] * state->pressure[j];
    }
    if (p == 0)
      continue;
    bw_facet_shape(mesh->order, rule->barycentric[q], shape);
    bw_triangle_shape_gradient(mesh->order, rule->barycentric[q], by);
    for (int a = 0; a < mesh->nodes_per_facet; a++) {
      add(xu, by[a][1] - by[a][0], mesh->node + 3 * (size_t)node[a]);
      add(xv, by[a][2] - by[a][0], mesh->node + 3 * (size_t)node[a]);
      add(v, shape[a], state->adjoint + 3 * (size_t)node[a]);
    }
    bw_cross(xu, xv, s);
    add(v, state->price / bw_norm(s), s);
    double factor = -0.5 * rule->weight[q] * p, by_u[3], by_v[3];
    bw_cross(xv, v, by_u);
    bw_cross(v, xu, by_v);
    for (int a = 0; a < mesh->nodes_per_facet; a++) {
      add(gradient + 3 * (size_t)node[a], factor * (by[a][1] - by[a][0]), by_u);
      add(gradient + 3 * (size_t)node[a], factor * (by[a][2] - by[a][0]), by_v);
    }
  }
}

bw_status bw_patch_shape_gradient(bw_context *context, const bw_mesh *mesh,
                                  const bw_material *material, const bw_patch_state *state,
                                  double *value, double *gradient) {
  bw_status status;
  patch p = {.mesh = NULL};
  bwi_pressure_rules rules;
  double *nodal = NULL, mean = 0;
  work_data d = {.mesh = mesh,
                 .material = material,
                 .u = state->displacement,
                 .adjoint = state->adjoint,
                 .gradient = gradient};
  memset(&rules, 0, sizeof rules);
  BW_TRY(bwi_check_stress_input(context, mesh, material, state->displacement, "a shape gradient"));
  if (state->basis->mesh != mesh || state->basis->directions > 1 || !state->basis->parts)
    return bw_fail(context, BW_UNSUPPORTED,
                   "the shape gradient is for pressures without friction on the same mesh");
  if (bwi_projected_bulk(mesh, material) > 0)
    return bw_fail(context, BW_UNSUPPORTED,
                   "the shape gradient is not implemented for the B-bar formulation");
  BW_TRY(patch_begin(context, mesh, state->radius, state->node, &p));
  BW_TRY(bwi_incidence_create(context, mesh, &d.around));
  d.part = BW_NEW(context, double, 3 * mesh->element_count * mesh->nodes_per_element);
  nodal = BW_NEW0(context, double, mesh->node_count);
  if (!d.part || !nodal) {
    status = BW_MEMORY;
    goto done;
  }
  memset(gradient, 0, 3 * (size_t)mesh->node_count * sizeof *gradient);
  bwi_rule_make(mesh->order, mesh->order == 1 ? 1 : 3, &d.straight); /* grad V is linear */
  bwi_rule_make(mesh->order, BWI_CURVED_DEGREE, &d.curved);
  BW_TRY(bw_parallel(context, mesh->element_count, ELEMENTS_PER_CHUNK, element_pass, &d));
  BW_TRY(bw_parallel(context, mesh->node_count, NODES_PER_CHUNK, gather_pass, &d));
  for (int32_t i = 0; i < mesh->node_count; i++) {
    if (p.weight[i] == 0)
      continue;
    nodal[i] = nodal_value(mesh, material, &d.around, state->displacement, state->slope, i,
                           p.weight[i], gradient);
    mean += p.weight[i] * nodal[i];
  }
  add_weights(&p, nodal, mean, gradient);
  BW_TRY(bwi_pressure_rules_create(context, state->basis, &rules));
  for (int32_t f = 0; f < mesh->facet_count; f++)
    add_pressure(state, bwi_facet_rule(&rules, state->basis, f), f, gradient);
  *value = mean;
done:
  bwi_pressure_rules_clear(&rules);
  patch_clear(&p);
  bwi_incidence_clear(&d.around);
  bw_free(d.part);
  bw_free(nodal);
  return status;
}
