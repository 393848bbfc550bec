/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How the mean surface stress over a patch changes with the shape (docs/theory/strengthen.md).
 *
 * Mid-edge nodes are variables of their own: inside an element, curved or not, the shape changes by
 * V(x) = sum_a dx_a N_a(x), so with nodal values fixed d(grad u) = -(grad u)(grad V) and
 * d(volume) = tr(grad V) volume at every point of quadrature. */
#include "analysis/pressure.h"
#include "analysis/strain.h"
#include "analysis/surface_patch.h"
#include "analysis/surface_stress.h"

#include "barwright/analysis.h"

#include <math.h>
#include <string.h>

enum { ELEMENTS_PER_CHUNK = 128, NODES_PER_CHUNK = 1024 };

/* ---- small pieces ---------------------------------------------------------------------------- */

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
  bwi_full_tensor(stress, t);
}

static void multiply(const double a[9], const double x[3], double y[3]) {
  for (int i = 0; i < 3; i++)
    y[i] = bw_dot(a + 3 * i, x);
}

/* ---- the patch ------------------------------------------------------------------------------- */

typedef struct patch {
  const bw_mesh *mesh;
  bwi_surface_patches patches;
  int32_t centre;
  int32_t *facet; /* of the patch, facet_count */
  double *weight; /* facet_count x 3: of corners, not divided by the total */
  size_t facets;
  double total;
} patch;

static void add_facet(void *data, int32_t facet, const double weight[3]) {
  patch *p = (patch *)data;
  p->facet[p->facets] = facet;
  memcpy(p->weight + 3 * p->facets++, weight, 3 * sizeof *weight);
  p->total += weight[0] + weight[1] + weight[2];
}

static bw_status patch_begin(bw_context *context, const bw_mesh *mesh, const bw_dof_map *dof_map,
                             double radius, int32_t node, patch *p) {
  bw_status status;
  *p = (patch){.mesh = mesh, .centre = node};
  p->patches.mesh = mesh;
  BW_TRY(bwi_surface_patches_begin(context, mesh, dof_map, radius, &p->patches));
  if (!bwi_surface_patch_exists(&p->patches, node))
    return bw_fail(context, BW_INVALID, "node %d is not on the boundary, or inside of a support",
                   node + 1);
  p->facet = BW_NEW(context, int32_t, mesh->facet_count);
  p->weight = BW_NEW(context, double, 3 * (size_t)mesh->facet_count);
  if (!p->facet || !p->weight)
    return BW_MEMORY;
  bwi_surface_patch_visit(&p->patches, node, 1, 0, add_facet, p);
done:
  return status;
}

static void patch_clear(patch *p) {
  bwi_surface_patches_clear(&p->patches);
  bw_free(p->facet);
  bw_free(p->weight);
}

bw_status bw_patch_functional(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                              const bw_dof_map *dof_map, double radius, int32_t node,
                              const double slope[6], double *force, double *by_force) {
  bw_status status;
  double *area = NULL;
  patch p = {.mesh = mesh};
  BW_TRY(bw_material_fits(context, material, mesh->element_count));
  BW_TRY(patch_begin(context, mesh, dof_map, radius, node, &p));
  BW_TRY(bwi_facet_areas_around(context, mesh, &area));
  memset(force, 0, 3 * (size_t)mesh->node_count * sizeof *force);
  memset(by_force, 0, 3 * (size_t)mesh->node_count * sizeof *by_force);
  for (size_t k = 0; k < 3 * p.facets; k++) {
    double tensor[6];
    int32_t corner = 3 * p.facet[k / 3] + (int32_t)(k % 3);
    for (int c = 0; c < 6; c++) /* the dot product of tensors counts shears twice */
      tensor[c] = p.weight[k] / p.total * slope[c] / (c < 3 ? 1 : 2);
    bwi_facet_corner_functional(mesh, material, corner, tensor, force);
    bwi_facet_corner_by_force(mesh, material, area, corner, tensor, by_force);
  }
done:
  bw_free(area);
  patch_clear(&p);
  return status;
}

/* ---- what changes with the shape at constant displacements ----------------------------------- */

/* What the mean depends on at constant u and nodal forces. */
typedef struct constants {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *u, *force, *area, *slope;
} constants;

/* slope . sigma at a corner of a facet; gradient += factor times its derivative at a constant
 * traction t, by_traction += factor times that by t. Gradients g_a along the surface change by
 * -(grad V)^T g_a and along the normal n; the latter is taken to zero by s = C_s : slope, as s n =
 * 0. The normal changes by dn = -(grad V)^T n, and the stress by it: with q = Q^-1 (C : slope) n
 * and r = Q^-1 ((C : strain) n - t), d (slope : sigma) = -(sigma q + s r) . dn
 * (docs/theory/strengthen.md). */
static double corner_value(const constants *h, int32_t corner, double factor, double *gradient,
                           double by_traction[3]) {
  bwi_facet_corner at;
  double full[9], strain[6], t[3], conjugate[6], stress[6], s[9], sigma[9], a[9] = {0};
  bwi_facet_corner_load(h->mesh, h->material, corner, &at);
  bwi_facet_corner_strain(&at, h->u, full, strain);
  bwi_facet_traction(h->mesh, h->area, h->force, corner / 3, t);
  bwi_multiply6(at.elasticity, h->slope, conjugate);
  bwi_multiply6(at.elasticity, strain, stress);
  for (int k = 0; k < 6; k++)
    stress[k] += bw_dot(at.by_traction + 3 * k, t);
  bwi_full_tensor(conjugate, s);
  bwi_full_tensor(stress, sigma);
  const double *c = bw_material_elasticity(h->material, h->mesh->facet_element[corner / 3]);
  const double *given[2] = {h->slope, strain}, *other[2] = {sigma, s};
  double along[3] = {0};
  for (int k = 0; k < 2; k++) {
    double whole[6], tensor[9], traction[3], q[3];
    bwi_multiply6(c, given[k], whole);
    bwi_full_tensor(whole, tensor);
    multiply(tensor, at.normal, traction);
    if (k == 1)
      add(traction, -1, t);
    multiply(at.softness, traction, q);
    multiply(other[k], q, traction);
    add(along, 1, traction);
  }
  bwi_add_transposed_product(a, -factor, full, s);
  for (int i = 0; i < at.nodes; i++) {
    double *to = gradient + 3 * (size_t)at.node[i];
    for (int k = 0; k < 3; k++)
      to[k] += bw_dot(a + 3 * k, at.gradient[i]);
    add(to, factor * bw_dot(at.gradient[i], along), at.normal);
  }
  for (int k = 0; k < 6; k++)
    add(by_traction, factor * h->slope[k], at.by_traction + 3 * k);
  return bwi_dot6(h->slope, stress);
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

/* gradient += the derivative by the areas by which nodal forces are spread; of_facet: by the
 * tractions of the patch's facets, 3 each. */
static bw_status add_spread(bw_context *context, const patch *p, const constants *h,
                            const double *of_facet, double *gradient) {
  const bw_mesh *mesh = p->mesh;
  double *slope = BW_NEW0(context, double, mesh->node_count);
  if (!slope)
    return BW_MEMORY;
  size_t nodes = (size_t)mesh->nodes_per_facet;
  for (size_t f = 0; f < p->facets; f++)
    for (size_t a = 0; a < nodes; a++) {
      int32_t i = mesh->facet[(size_t)p->facet[f] * nodes + a];
      slope[i] -= bw_dot(of_facet + 3 * f, h->force + 3 * (size_t)i) / (h->area[i] * h->area[i]);
    }
  for (size_t f = 0; f < (size_t)mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + f * nodes;
    double sum = 0;
    for (size_t a = 0; a < nodes; a++)
      sum += slope[node[a]];
    if (sum != 0)
      add_area(mesh, node, sum, gradient);
  }
  bw_free(slope);
  return BW_OK;
}

/* gradient += d (mean) by the weights of the samples, `value` at the corners of the patch's facets
 * constant */
static void add_weights(const patch *p, const double *value, double mean, double *gradient) {
  const bw_mesh *mesh = p->mesh;
  const double *centre = mesh->node + 3 * (size_t)p->centre;
  double square = p->patches.radius * p->patches.radius;
  for (size_t f = 0; f < p->facets; f++) {
    const int32_t *node = mesh->facet + (size_t)p->facet[f] * (size_t)mesh->nodes_per_facet;
    double by_area = 0, area = p->patches.area[p->facet[f]], sample[BWI_PATCH_SAMPLES];
    for (int a = 0; a < 3; a++)
      by_area += p->weight[3 * f + a] * (value[3 * f + a] - mean) / (p->total * area);
    bwi_surface_patch_weights(&p->patches, p->facet[f], p->centre, sample);
    for (int k = 0; k < BWI_PATCH_SAMPLES; k++) {
      const double *at = p->patches.at[k];
      double off = -mean, arm[3];
      if (!(sample[k] > 0))
        continue;
      for (int c = 0; c < 3; c++)
        arm[c] = -centre[c];
      for (int a = 0; a < 3; a++) {
        off += at[a] * value[3 * f + (size_t)a];
        add(arm, at[a], mesh->node + 3 * (size_t)node[a]);
      }
      double factor = -2 * off / p->total * area / (BWI_PATCH_SAMPLES * square);
      for (int a = 0; a < 3; a++)
        add(gradient + 3 * (size_t)node[a], factor * at[a], arm);
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
      bwi_add_transposed_product(a, volume, grad, tau);
      bwi_add_transposed_product(a, volume, grad_u, sigma);
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
static void add_pressure(const bw_patch_state *state, const double *adjoint,
                         const bwi_pressure_rule *rule, int32_t facet, double *gradient) {
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
      add(v, shape[a], adjoint + 3 * (size_t)node[a]);
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
  double *at_corner = NULL, *of_facet = NULL, *force = NULL, *adjoint = NULL, *area = NULL,
         mean = 0;
  size_t size = 3 * (size_t)mesh->node_count;
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
  bool projects = false;
  for (int32_t i = 0; i < bw_material_part_count(material); i++)
    projects |= bwi_projected_bulk(mesh, bw_material_part(material, i)) > 0;
  if (projects)
    return bw_fail(context, BW_UNSUPPORTED,
                   "the shape gradient is not implemented for the B-bar formulation");
  BW_TRY(patch_begin(context, mesh, state->dof_map, state->radius, state->node, &p));
  BW_TRY(bwi_incidence_create(context, mesh, &d.around));
  d.part = BW_NEW(context, double, 3 * mesh->element_count * mesh->nodes_per_element);
  at_corner = BW_NEW(context, double, 3 * p.facets);
  of_facet = BW_NEW0(context, double, 3 * p.facets);
  force = BW_NEW(context, double, size);
  adjoint = BW_NEW(context, double, size);
  BW_TRY_MEMORY(d.part && at_corner && of_facet && force && adjoint);
  BW_TRY(bwi_facet_areas_around(context, mesh, &area));
  bw_pressure_force(state->basis, state->pressure, force);
  memset(gradient, 0, size * sizeof *gradient);
  bwi_rule_make(mesh->order, mesh->order == 1 ? 1 : 3, &d.straight); /* grad V is linear */
  bwi_rule_make(mesh->order, BWI_CURVED_DEGREE, &d.curved);
  BW_TRY(bw_parallel(context, mesh->element_count, ELEMENTS_PER_CHUNK, element_pass, &d));
  BW_TRY(bw_parallel(context, mesh->node_count, NODES_PER_CHUNK, gather_pass, &d));
  const constants h = {mesh, material, state->displacement, force, area, state->slope};
  for (size_t k = 0; k < 3 * p.facets; k++) {
    double weight = p.weight[k] / p.total;
    at_corner[k] = corner_value(&h, 3 * p.facet[k / 3] + (int32_t)(k % 3), weight, gradient,
                                of_facet + 3 * (k / 3));
    mean += weight * at_corner[k];
  }
  add_weights(&p, at_corner, mean, gradient);
  BW_TRY(add_spread(context, &p, &h, of_facet, gradient));
  /* What acts on G p: the adjoint, and the traction of the patch. */
  memcpy(adjoint, state->adjoint, size * sizeof *adjoint);
  for (size_t f = 0; f < p.facets; f++)
    for (int a = 0; a < mesh->nodes_per_facet; a++) {
      int32_t i = mesh->facet[(size_t)p.facet[f] * (size_t)mesh->nodes_per_facet + (size_t)a];
      add(adjoint + 3 * (size_t)i, 1 / area[i], of_facet + 3 * f);
    }
  BW_TRY(bwi_pressure_rules_create(context, state->basis, &rules));
  for (int32_t f = 0; f < mesh->facet_count; f++)
    add_pressure(state, adjoint, bwi_facet_rule(&rules, state->basis, f), f, gradient);
  *value = mean;
done:
  bwi_pressure_rules_clear(&rules);
  patch_clear(&p);
  bwi_incidence_clear(&d.around);
  bw_free(d.part);
  bw_free(at_corner);
  bw_free(of_facet);
  bw_free(force);
  bw_free(adjoint);
  bw_free(area);
  return status;
}
