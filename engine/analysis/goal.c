/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Goals of an analysis: the derivative of stresses at nodes by the displacement, which is the load
 * of the dual problem, and the product of recovered primal and dual errors
 * (docs/theory/error_control.md). */
#include "analysis/strain.h"
#include "model/internal.h"

#include "barwright/analysis.h"

#include <math.h>
#include <string.h>

typedef struct product {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *displacement[2], *recovered[2]; /* recovered at points */
  bw_stress_points points;
  double *element;
  bwi_rule rule;
} product;

/* N sigma* - sigma at point q of an element. */
static double stress_error(const product *p, int which, const bwi_element_state *state, int64_t e,
                           int q, double error[6]) {
  double strain[6], v = bwi_strain_at(state, p->rule.by_l[q], p->rule.l[q], strain);
  bwi_stress_of(state, bw_material_elasticity(p->material, e), strain, error);
  for (int c = 0; c < 6; c++)
    error[c] = -error[c];
  for (int a = 0; a < state->nodes; a++) {
    const double *own =
        p->recovered[which] + 6 * (int64_t)bw_stress_point_of(&p->points, p->mesh, e, a);
    for (int c = 0; c < 6; c++)
      error[c] += p->rule.value[q][a] * own[c];
  }
  return v;
}

static bw_status product_of_elements(void *data, int64_t begin, int64_t end, int worker) {
  const product *p = (const product *)data;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    bwi_element_state state[2];
    double sum = 0;
    for (int k = 0; k < 2; k++)
      bwi_element_state_load(p->mesh, p->material, p->displacement[k], e, &state[k]);
    for (int q = 0; q < p->rule.points; q++) {
      double one[6], two[6], strain[6];
      double v = p->rule.weight[q] * stress_error(p, 0, &state[0], e, q, one);
      stress_error(p, 1, &state[1], e, q, two);
      bwi_multiply6(bw_material_compliance(p->material, e), two, strain);
      sum += v * bwi_dot6(one, strain);
    }
    p->element[e] = sum;
  }
  return BW_OK;
}

bw_status bw_error_product(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                           const double *primal, const double *dual, double *element) {
  bw_status status = BW_OK;
  product p = {.mesh = mesh, .material = material, .element = element};
  double *recovered = NULL;
  BW_TRY(bw_stress_points_create(context, mesh, material, &p.points));
  int64_t numbers = 6 * (int64_t)p.points.count;
  recovered = BW_NEW(context, double, 2 * numbers);
  BW_TRY_MEMORY(recovered);
  p.displacement[0] = primal;
  p.displacement[1] = dual;
  p.recovered[0] = recovered;
  p.recovered[1] = primal == dual ? recovered : recovered + numbers;
  BW_TRY(bwi_recovered_point_stress(context, mesh, material, primal, &p.points, recovered));
  if (primal != dual)
    BW_TRY(
        bwi_recovered_point_stress(context, mesh, material, dual, &p.points, recovered + numbers));
  bwi_rule_make(mesh->order, mesh->order == 1 ? 2 : BWI_CURVED_DEGREE, &p.rule);
  BW_TRY(bw_parallel(context, mesh->element_count, 256, product_of_elements, &p));
done:
  bw_stress_points_clear(&p.points);
  bw_free(recovered);
  return status;
}

/* Means of the gradients of the shape functions over an element. */
static void mean_gradient(const bw_mesh *mesh, int64_t element, double (*mean)[3]) {
  double x[10][3], l[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS], whole = 0;
  int points = bw_tet_quadrature(BWI_CURVED_DEGREE, l, weight), nodes = mesh->nodes_per_element;
  bwi_element_nodes(mesh, element, x);
  memset(mean, 0, (size_t)nodes * sizeof *mean);
  for (int q = 0; q < points; q++) {
    double gradient[10][3];
    double v = weight[q] * bw_tet_gradient(mesh->order, (const double(*)[3])x, l[q], gradient);
    whole += v;
    for (int a = 0; a < nodes; a++)
      for (int c = 0; c < 3; c++)
        mean[a][c] += v * gradient[a][c];
  }
  for (int a = 0; a < nodes; a++)
    for (int c = 0; c < 3; c++)
      mean[a][c] /= whole;
}

bw_status bw_stress_functional(bw_context *context, const bw_mesh *mesh,
                               const bw_material *material, int64_t count, const int32_t *node,
                               const double *weight, double *force) {
  bw_status status;
  bwi_incidence around = {NULL, NULL, NULL};
  BW_TRY(bw_material_fits(context, material, mesh->element_count));
  BW_TRY(bwi_incidence_create(context, mesh, &around));
  memset(force, 0, 3 * (size_t)mesh->node_count * sizeof *force);
  for (int64_t i = 0; i < count; i++) {
    double volume = 0;
    for (int64_t k = around.start[node[i]]; k < around.start[node[i] + 1]; k++) {
      volume += mesh->volume[around.element[k]];
      if (bw_material_unrotated(material, around.element[k]) !=
          bw_material_unrotated(material, around.element[around.start[node[i]]]))
        BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                       "node %d at (%g, %g, %g) m lies between two materials, where the stress has "
                       "two values: give a place inside a region, or another quantity",
                       node[i] + 1, mesh->node[3 * (int64_t)node[i]],
                       mesh->node[3 * (int64_t)node[i] + 1], mesh->node[3 * (int64_t)node[i] + 2]));
    }
    for (int64_t k = around.start[node[i]]; k < around.start[node[i] + 1]; k++) {
      int64_t e = around.element[k];
      const int32_t *own = mesh->element + e * mesh->nodes_per_element;
      double gradient[10][3], s[6], fraction = mesh->volume[e] / volume;
      /* acts on the mean dilatation */
      double projected = bwi_projected_bulk(mesh, bw_material_of(material, e));
      bwi_gradients_at_node(mesh, e, around.local[k], gradient);
      bwi_multiply6(bw_material_elasticity(material, e), weight + 6 * i, s);
      const double full[3][3] = {{s[0], s[5], s[4]}, {s[5], s[1], s[3]}, {s[4], s[3], s[2]}};
      for (int a = 0; a < mesh->nodes_per_element; a++)
        for (int c = 0; c < 3; c++)
          force[3 * (int64_t)own[a] + c] += fraction * bw_dot(full[c], gradient[a]);
      if (projected > 0) {
        double mean[10][3], trace = weight[6 * i] + weight[6 * i + 1] + weight[6 * i + 2];
        mean_gradient(mesh, e, mean);
        for (int a = 0; a < mesh->nodes_per_element; a++)
          for (int c = 0; c < 3; c++)
            force[3 * (int64_t)own[a] + c] +=
                fraction * projected * trace * (mean[a][c] - gradient[a][c]);
      }
    }
  }
done:
  bwi_incidence_clear(&around);
  return status;
}

bw_status bw_internal_force(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                            const double *displacement, double *force) {
  bwi_rule rule;
  bw_status status = bwi_check_stress_input(context, mesh, material, displacement, "a force");
  if (status != BW_OK)
    return status;
  bwi_rule_make(mesh->order, mesh->order == 1 ? 1 : BWI_CURVED_DEGREE, &rule);
  memset(force, 0, 3 * (size_t)mesh->node_count * sizeof *force);
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *own = mesh->element + e * mesh->nodes_per_element;
    bwi_element_state state;
    double x[10][3];
    bool moves = false;
    bwi_element_state_load(mesh, material, displacement, e, &state);
    for (int a = 0; a < state.nodes; a++)
      moves = moves || bw_norm(state.u[a]) > 0;
    if (!moves)
      continue;
    bwi_element_nodes(mesh, e, x);
    for (int q = 0; q < rule.points; q++) {
      double strain[6], s[6], gradient[10][3];
      double v = rule.weight[q] * bwi_strain_at(&state, rule.by_l[q], rule.l[q], strain);
      bwi_stress_of(&state, bw_material_elasticity(material, e), strain, s);
      bw_tet_gradient(mesh->order, (const double(*)[3])x, rule.l[q], gradient);
      const double full[3][3] = {{s[0], s[5], s[4]}, {s[5], s[1], s[3]}, {s[4], s[3], s[2]}};
      for (int a = 0; a < state.nodes; a++)
        for (int c = 0; c < 3; c++)
          force[3 * (int64_t)own[a] + c] += v * bw_dot(full[c], gradient[a]);
    }
  }
  return BW_OK;
}

/* ---- kinks of the boundary ----------------------------------------------------------------- */

/* Facets with a node for a corner or mid-edge node, by number: at most `max`. */
static int facets_at(const bw_mesh *mesh, int32_t node, int max, int32_t *facet) {
  int count = 0;
  for (int32_t f = 0; f < mesh->facet_count && count < max; f++)
    for (int k = 0; k < mesh->nodes_per_facet; k++)
      if (mesh->facet[(int64_t)f * mesh->nodes_per_facet + k] == node) {
        facet[count++] = f;
        break;
      }
  return count;
}

static double angle_between(const double a[3], const double b[3]) {
  double c[3];
  bw_cross(a, b, c);
  return atan2(bw_norm(c), bw_dot(a, b));
}

/* Whether a facet rises above the plane through one of its nodes across a normal: then the kink is
 * concave. */
static bool rises(const bw_mesh *mesh, int32_t facet, int32_t node, const double normal[3]) {
  const int32_t *corner = mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
  double height = 0;
  for (int k = 0; k < 3; k++)
    for (int d = 0; d < 3; d++)
      height +=
          (mesh->node[3 * (int64_t)corner[k] + d] - mesh->node[3 * (int64_t)node + d]) * normal[d];
  return height > 0;
}

bw_status bw_boundary_kink(bw_context *context, const bw_mesh *mesh, int32_t node, double limit,
                           double *kink) {
  enum { MAX_FACETS = 64 };
  int32_t around[MAX_FACETS];
  int width = mesh->nodes_per_facet, count = facets_at(mesh, node, MAX_FACETS, around);
  *kink = 0;
  for (int i = 0; i < count; i++)
    for (int j = 0; j < i; j++)
      for (int a = 0; a < width; a++)
        for (int b = 0; b < width; b++) {
          double one[3], two[3];
          int32_t shared = mesh->facet[(int64_t)around[i] * width + a];
          if (shared != mesh->facet[(int64_t)around[j] * width + b])
            continue;
          bwi_boundary_normal_at(mesh, around[i], a, one);
          bwi_boundary_normal_at(mesh, around[j], b, two);
          double angle = angle_between(one, two);
          if (angle < limit && rises(mesh, around[j], shared, one))
            *kink = fmax(*kink, angle);
        }
  return bw_check_cancel(context);
}
