/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stress and energy of elements, stress at nodes. Each element, or node, is computed by one thread
 * from the displacement alone, so results do not depend on how the work was cut. */
#include "analysis/strain.h"

#include "barwright/analysis.h"

#include <math.h>
#include <string.h>

enum { ELEMENTS_PER_CHUNK = 1024, NODES_PER_CHUNK = 256 };

typedef struct element_data {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *displacement;
  double *out;
  bwi_rule rule;             /* for curved elements */
  double mean[10][4];        /* means of dN_a/dL_k over a straight element */
  double at_node[10][10][4]; /* dN_a/dL_k at each node */
  double node_l[10][4];
} element_data;

static void prepare(const bw_mesh *mesh, const bw_material *material, const double *displacement,
                    double *out, element_data *d) {
  static const double centre[4] = {0.25, 0.25, 0.25, 0.25};
  d->mesh = mesh;
  d->material = material;
  d->displacement = displacement;
  d->out = out;
  bwi_rule_make(mesh->order, BWI_CURVED_DEGREE, &d->rule);
  bw_tet_shape_gradient(mesh->order, centre, d->mean); /* linear: the centre has the mean */
  for (int a = 0; a < mesh->nodes_per_element; a++) {
    double *l = d->node_l[a];
    bwi_node_barycentric(a, l);
    bw_tet_shape_gradient(mesh->order, l, d->at_node[a]);
  }
}

static bw_status stress_of_elements(void *data, int64_t begin, int64_t end, int worker) {
  const element_data *d = (const element_data *)data;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    bwi_element_state state;
    double strain[6];
    bwi_element_state_load(d->mesh, d->material, d->displacement, e, &state);
    if (state.straight)
      bwi_strain_at(&state, d->mean, d->node_l[0], strain);
    else { /* the volume mean */
      double sum[6] = {0}, volume = 0;
      for (int q = 0; q < d->rule.points; q++) {
        double v = d->rule.weight[q] * bwi_strain_at(&state, d->rule.by_l[q], d->rule.l[q], strain);
        volume += v;
        for (int i = 0; i < 6; i++)
          sum[i] += v * strain[i];
      }
      for (int i = 0; i < 6; i++)
        strain[i] = sum[i] / volume;
    }
    bwi_multiply6(bw_material_elasticity(d->material, e), strain, d->out + 6 * e);
  }
  return BW_OK;
}

/* The mean of a product of fields that are linear over a straight element, from their values at the
 * corners: mean of e.s = (sum_k e_k.s_k + (sum_k e_k).(sum_k s_k)) / 20. */
static bw_status energy_of_elements(void *data, int64_t begin, int64_t end, int worker) {
  const element_data *d = (const element_data *)data;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    const double *c = bw_material_elasticity(d->material, e);
    bwi_element_state state;
    double strain[6], stress[6], sum[6] = {0}, stress_sum[6] = {0}, energy = 0;
    bwi_element_state_load(d->mesh, d->material, d->displacement, e, &state);
    if (state.order == 1) {
      bwi_strain_at(&state, d->mean, d->node_l[0], strain);
      bwi_stress_of(&state, c, strain, stress);
      energy = state.volume * bwi_dot6(strain, stress);
    } else if (state.straight) {
      for (int k = 0; k < 4; k++) {
        bwi_strain_at(&state, d->at_node[k], d->node_l[k], strain);
        bwi_stress_of(&state, c, strain, stress);
        energy += bwi_dot6(strain, stress);
        for (int i = 0; i < 6; i++) {
          sum[i] += strain[i];
          stress_sum[i] += stress[i];
        }
      }
      energy = state.volume / 20 * (energy + bwi_dot6(sum, stress_sum));
    } else
      for (int q = 0; q < d->rule.points; q++) {
        double v = d->rule.weight[q] * bwi_strain_at(&state, d->rule.by_l[q], d->rule.l[q], strain);
        bwi_stress_of(&state, c, strain, stress);
        energy += v * bwi_dot6(strain, stress);
      }
    d->out[e] = 0.5 * energy;
  }
  return BW_OK;
}

bw_status bw_element_stress(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                            const double *displacement, double *stress) {
  element_data d;
  bw_status status =
      bwi_check_stress_input(context, mesh, material, displacement, "a stress field");
  if (status != BW_OK)
    return status;
  prepare(mesh, material, displacement, stress, &d);
  return bw_parallel(context, mesh->element_count, ELEMENTS_PER_CHUNK, stress_of_elements, &d);
}

bw_status bw_element_energy(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                            const double *displacement, double *energy) {
  element_data d;
  bw_status status =
      bwi_check_stress_input(context, mesh, material, displacement, "an energy field");
  if (status != BW_OK)
    return status;
  prepare(mesh, material, displacement, energy, &d);
  return bw_parallel(context, mesh->element_count, ELEMENTS_PER_CHUNK, energy_of_elements, &d);
}

/* ---- stress at nodes ----------------------------------------------------------------------- */

typedef struct node_data {
  element_data element;
  const bw_stress_points *points;
  bwi_incidence incidence;
} node_data;

static bw_status stress_of_points(void *data, int64_t begin, int64_t end, int worker) {
  const node_data *d = (const node_data *)data;
  const element_data *of = &d->element;
  const bw_material *material = of->material;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double sum[6] = {0}, volume = 0, pressure = 0; /* pressure: what the projection adds */
    int32_t node = bw_stress_point_node(d->points, (int32_t)i);
    for (int64_t k = d->incidence.start[node]; k < d->incidence.start[node + 1]; k++) {
      bwi_element_state state;
      double strain[6];
      int a = d->incidence.local[k];
      if (!bw_stress_point_has(d->points, (int32_t)i, material, d->incidence.element[k]))
        continue;
      bwi_element_state_load(of->mesh, material, of->displacement, d->incidence.element[k], &state);
      bwi_strain_at(&state, of->at_node[a], of->node_l[a], strain);
      pressure +=
          state.volume * state.projected * (state.dilatation - (strain[0] + strain[1] + strain[2]));
      if (material->parts) {
        double own[6];
        bwi_multiply6(bw_material_elasticity(material, d->incidence.element[k]), strain, own);
        memcpy(strain, own, sizeof strain); /* stresses are averaged then */
      }
      volume += state.volume;
      for (int c = 0; c < 6; c++)
        sum[c] += state.volume * strain[c];
    }
    for (int c = 0; c < 6; c++)
      sum[c] = volume > 0 ? sum[c] / volume : 0;
    if (material->parts)
      memcpy(of->out + 6 * i, sum, sizeof sum);
    else
      bwi_multiply6(material->elasticity, sum, of->out + 6 * i);
    for (int c = 0; c < 3 && volume > 0; c++)
      of->out[6 * i + c] += pressure / volume;
  }
  return BW_OK;
}

bw_status bw_point_stress(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                          const double *displacement, const bw_stress_points *points,
                          double *stress) {
  bw_status status;
  node_data d = {.points = points};
  BW_TRY(bwi_check_stress_input(context, mesh, material, displacement, "a stress field"));
  BW_TRY(bwi_incidence_create(context, mesh, &d.incidence));
  prepare(mesh, material, displacement, stress, &d.element);
  BW_TRY(bw_parallel(context, points->count, NODES_PER_CHUNK, stress_of_points, &d));
done:
  bwi_incidence_clear(&d.incidence);
  return status;
}

void bwi_governing_stress(const bw_stress_points *points, int32_t node_count,
                          const double *of_points, double *stress) {
  for (int32_t i = 0; i < node_count; i++) {
    int32_t most = i;
    double largest = bw_von_mises(of_points + 6 * (int64_t)i);
    for (int32_t k = points->point ? points->point[i].next : -1; k >= 0;
         k = points->point[k].next) {
      double own = bw_von_mises(of_points + 6 * (int64_t)k);
      most = own > largest ? k : most;
      largest = fmax(own, largest);
    }
    memmove(stress + 6 * (int64_t)i, of_points + 6 * (int64_t)most, 6 * sizeof *stress);
  }
}

bw_status bw_nodal_stress(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                          const double *displacement, double *stress) {
  bw_status status;
  bw_stress_points points = {0};
  double *all = NULL;
  BW_TRY(bwi_check_stress_input(context, mesh, material, displacement, "a stress field"));
  BW_TRY(bw_stress_points_create(context, mesh, material, &points));
  if (points.point)
    all = BW_NEW(context, double, 6 * (int64_t)points.count);
  BW_TRY_MEMORY(all || !points.point);
  BW_TRY(bw_point_stress(context, mesh, material, displacement, &points, all ? all : stress));
  if (all)
    bwi_governing_stress(&points, mesh->node_count, all, stress);
done:
  bw_free(all);
  bw_stress_points_clear(&points);
  return status;
}
