/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The linear functional of a weak region as nodal forces: the right-hand side of the one adjoint
 * solve that gives the objective (docs/theory/worst_case.md, "The objective by one solve").
 *
 * Stress: J(u) = sum_e w_e integral over e of tr sigma(u). With s = C : I (a symmetric tensor, the
 * stress that a unit volumetric strain's dual asks for), tr sigma = s : grad u because C is
 * symmetric, so the force at node a is sum_e w_e s (integral over e of grad phi_a).
 * Direction: J(u) = sum_e integral over e of T_e : sigma(u); the same with s = C : T_e. Where the
 * region names corners of facets, J(u) = sum of T : sigma over them, sigma the surface stress, to
 * which the load's traction adds.
 * Displacement: J(u) = sum_e integral over e of w_e . u; the force is sum_e w_e (integral of
 * phi_a). */
#include "analysis/surface_stress.h"
#include "analysis/weak_internal.h"
#include "assemble/internal.h"

#include <string.h>

double bwi_shape_integrals(const bw_mesh *mesh, int32_t e, double (*gradient)[3], double *value) {
  int nodes = mesh->nodes_per_element;
  double x[10][3];
  bwi_element_nodes(mesh, e, x);
  if (mesh->order == 1 || bw_tet_is_straight((const double(*)[3])x)) {
    double corner[4][3];
    double volume = bw_tet_barycentric_gradient(x[0], x[1], x[2], x[3], corner);
    if (mesh->order == 1) {
      for (int a = 0; a < 4; a++) {
        for (int k = 0; gradient && k < 3; k++)
          gradient[a][k] = volume * corner[a][k];
        if (value)
          value[a] = volume / 4;
      }
      return volume;
    }
    /* phi = L (2 L - 1) at corners: mean gradient (4/4 - 1) grad L = 0; phi = 4 La Lb between. */
    for (int a = 0; a < 4; a++) {
      for (int k = 0; gradient && k < 3; k++)
        gradient[a][k] = 0;
      if (value)
        value[a] = -volume / 20;
    }
    for (int m = 0; m < 6; m++) {
      const double *a = corner[bw_tet_edge[m][0]], *b = corner[bw_tet_edge[m][1]];
      for (int k = 0; gradient && k < 3; k++)
        gradient[4 + m][k] = volume * (a[k] + b[k]);
      if (value)
        value[4 + m] = volume / 5;
    }
    return volume;
  }
  /* Curved: grad phi times the Jacobian is a polynomial of degree 5, phi times it of degree 5. */
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS], volume = 0;
  int points = bw_tet_quadrature(5, point, weight);
  for (int a = 0; a < nodes; a++) {
    for (int k = 0; gradient && k < 3; k++)
      gradient[a][k] = 0;
    if (value)
      value[a] = 0;
  }
  for (int q = 0; q < points; q++) {
    double here[10][3], shape[10];
    double w = weight[q] * bw_tet_gradient(2, (const double(*)[3])x, point[q], here) / 6;
    bw_tet_shape(2, point[q], shape);
    volume += w;
    for (int a = 0; a < nodes; a++) {
      for (int k = 0; gradient && k < 3; k++)
        gradient[a][k] += w * here[a][k];
      if (value)
        value[a] += w * shape[a];
    }
  }
  return volume;
}

/* right_hand_side += that of entry i, an element. */
static void add_element(const bw_mesh *mesh, const bw_material *material, bw_worst_target target,
                        const bw_weak_region *r, int32_t i, double *right_hand_side) {
  int nodes = mesh->nodes_per_element;
  int32_t e = r->element[i];
  bool stress = target != BW_WORST_DISPLACEMENT;
  const int32_t *node = mesh->element + (size_t)e * (size_t)nodes;
  const double *c = bw_material_elasticity(material, e);
  double gradient[10][3], value[10], s[6], w = 1;
  if (target == BW_WORST_DIRECTION)
    bwi_conjugate_stress(c, r->weight + 6 * (size_t)i, s);
  for (int k = 0; k < 6 && target == BW_WORST_STRESS; k++)
    s[k] = c[6 * k] + c[6 * k + 1] + c[6 * k + 2];
  if (target == BW_WORST_STRESS)
    w = r->weight[i];
  bwi_shape_integrals(mesh, e, stress ? gradient : NULL, stress ? NULL : value);
  for (int a = 0; a < nodes; a++) {
    double *to = right_hand_side + 3 * (size_t)node[a];
    if (stress) {
      const double *g = gradient[a];
      to[0] += w * (s[0] * g[0] + s[5] * g[1] + s[4] * g[2]);
      to[1] += w * (s[5] * g[0] + s[1] * g[1] + s[3] * g[2]);
      to[2] += w * (s[4] * g[0] + s[3] * g[1] + s[2] * g[2]);
    } else {
      for (int k = 0; k < 3; k++)
        to[k] += r->weight[3 * i + k] * value[a];
    }
  }
}

static bw_status check_region(bw_context *context, const bw_weak_regions *regions, int region,
                              const bw_material *material) {
  if (region < 0 || region >= regions->count)
    return bw_fail(context, BW_INVALID, "region %d: the regions are 1 to %d", region + 1,
                   regions->count);
  return bw_material_fits(context, material, regions->mesh->element_count);
}

bw_status bw_region_objective(bw_context *context, const bw_weak_regions *regions, int region,
                              const bw_material *material, double *right_hand_side) {
  const bw_mesh *mesh = regions->mesh;
  bw_status status = check_region(context, regions, region, material);
  if (status != BW_OK)
    return status;
  const bw_weak_region *r = &regions->region[region];
  memset(right_hand_side, 0, 3 * (size_t)mesh->node_count * sizeof *right_hand_side);
  for (int32_t i = 0; i < r->count; i++)
    if (r->corner)
      bwi_facet_corner_functional(mesh, material, r->corner[i], r->weight + 6 * (size_t)i,
                                  right_hand_side);
    else
      add_element(mesh, material, regions->options.target, r, i, right_hand_side);
  return BW_OK;
}

bw_status bw_region_by_force(bw_context *context, const bw_weak_regions *regions, int region,
                             const bw_material *material, double *by_force) {
  bw_status status;
  double *area = NULL;
  BW_TRY(check_region(context, regions, region, material));
  const bw_weak_region *r = &regions->region[region];
  if (!r->corner)
    return BW_OK;
  BW_TRY(bwi_facet_areas_around(context, regions->mesh, &area));
  for (int32_t i = 0; i < r->count; i++)
    bwi_facet_corner_by_force(regions->mesh, material, area, r->corner[i],
                              r->weight + 6 * (size_t)i, by_force);
done:
  bw_free(area);
  return status;
}
