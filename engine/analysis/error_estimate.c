/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The error estimate of Zienkiewicz and Zhu (1987). The stress at nodes, interpolated by the shape
 * functions, is taken for the true one: the error e = N sigma* - D B u has the energy
 * 1/2 integral of e . D^-1 e in each element (the agile paper, equations 30 to 32). */
#include "analysis/strain.h"

#include "barwright/analysis.h"

#include <math.h>
#include <string.h>

/* Averaged stresses are superconvergent for tet4, where the estimate tends to the true error, but
 * not for tet10, where it falls short by a third: the agile paper's factor makes up for it. The
 * tests measure both (docs/theory/elements.md has the figures). */
static double correction(const bw_mesh *mesh) {
  return mesh->order == 1 ? 1 : 1.5;
}

typedef struct estimate {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *displacement, *nodal;
  bw_stress_points points; /* of `nodal` */
  double *error, *energy;  /* per element */
  bwi_rule rule;
} estimate;

static bw_status of_elements(void *data, int64_t begin, int64_t end, int worker) {
  const estimate *s = (const estimate *)data;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    bwi_element_state state;
    bwi_element_state_load(s->mesh, s->material, s->displacement, e, &state);
    double error = 0, energy = 0, own[10][6];
    for (int a = 0; a < state.nodes; a++)
      memcpy(own[a], s->nodal + 6 * (int64_t)bw_stress_point_of(&s->points, s->mesh, e, a),
             sizeof own[a]);
    for (int q = 0; q < s->rule.points; q++) {
      double strain[6], stress[6], difference[6];
      double v = s->rule.weight[q] * bwi_strain_at(&state, s->rule.by_l[q], s->rule.l[q], strain);
      bwi_stress_of(&state, bw_material_elasticity(s->material, e), strain, stress);
      energy += v * bwi_dot6(strain, stress);
      for (int c = 0; c < 6; c++)
        stress[c] = -stress[c];
      for (int a = 0; a < state.nodes; a++)
        for (int c = 0; c < 6; c++)
          stress[c] += s->rule.value[q][a] * own[a][c];
      bwi_multiply6(bw_material_compliance(s->material, e), stress, difference);
      error += v * bwi_dot6(stress, difference);
    }
    s->error[e] = 0.5 * error;
    s->energy[e] = 0.5 * energy;
  }
  return BW_OK;
}

bw_status bw_error_estimate(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                            const double *displacement, double *element, double *relative) {
  bw_status status;
  estimate s = {.mesh = mesh, .material = material, .displacement = displacement};
  double *nodal = NULL, *own = NULL;
  BW_TRY(bwi_check_stress_input(context, mesh, material, displacement, "a stress field"));
  BW_TRY(bw_stress_points_create(context, mesh, material, &s.points));
  nodal = BW_NEW(context, double, 6 * (int64_t)s.points.count);
  own = element ? NULL : BW_NEW(context, double, mesh->element_count);
  s.energy = BW_NEW(context, double, mesh->element_count);
  s.nodal = nodal;
  s.error = element ? element : own;
  BW_TRY_MEMORY(nodal && s.error && s.energy);
  BW_TRY(bw_point_stress(context, mesh, material, displacement, &s.points, nodal));
  /* products of shape functions: exact on straight elements */
  bwi_rule_make(mesh->order, mesh->order == 1 ? 2 : BWI_CURVED_DEGREE, &s.rule);
  BW_TRY(bw_parallel(context, mesh->element_count, 256, of_elements, &s));
  double error = 0, energy = 0;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    error += s.error[e];
    energy += s.energy[e];
  }
  *relative = energy > 0 ? correction(mesh) * sqrt(error / energy) : 0;
done:
  bw_stress_points_clear(&s.points);
  bw_free(nodal);
  bw_free(own);
  bw_free(s.energy);
  return status;
}
