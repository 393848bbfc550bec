/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies with conditions of heat, for the tests of this folder. */
#ifndef HEAT_BODIES_H
#define HEAT_BODIES_H

#include "bodies.h"

static inline bw_material *heat_material(bw_context *context, double conductivity, double density,
                                         double heat_capacity) {
  bw_material *plain = NULL, *material = NULL;
  const bw_isotropic constants = {
      .name = "test", .young = 200e9, .poisson = 0.3, .density = density};
  const bw_thermal thermal = {.conductivity = {conductivity, conductivity, conductivity},
                              .heat_capacity = heat_capacity};
  check_ok(context, bw_material_isotropic(context, &constants, &plain));
  check_ok(context, bw_material_with_thermal(context, plain, &thermal, &material));
  bw_release(plain);
  return material;
}

/* The first material where coordinate `axis` of an element's centre is below `at`, else the second.
 * Takes over both. */
static inline bw_material *heat_layers(bw_context *context, const bw_mesh *mesh, int axis,
                                       double at, bw_material *first, bw_material *second) {
  const bw_material *part[2] = {first, second};
  bw_material *material = NULL;
  int32_t *of = malloc(sizeof *of * (size_t)mesh->element_count);
  for (int64_t e = 0; e < mesh->element_count; e++) {
    double centre = 0;
    for (int a = 0; a < 4; a++)
      centre += mesh->node[3 * mesh->element[e * mesh->nodes_per_element + a] + axis] / 4;
    of[e] = centre > at;
  }
  check_ok(context, bw_material_by_element(context, mesh->element_count, 2, of, part, &material));
  free(of);
  bw_release(first);
  bw_release(second);
  return material;
}

/* Takes over mesh and material. */
static inline bw_heat *heat_body(bw_context *context, bw_mesh *mesh, bw_material *material) {
  bw_heat *heat = NULL;
  check_ok(context, bw_heat_create(context, mesh, material, &heat));
  bw_release(mesh);
  bw_release(material);
  return heat;
}

/* A condition on the plane where coordinate `axis` is `at`. */
static inline void heat_on_plane(bw_context *context, bw_heat *heat, int axis, double at,
                                 bw_heat_condition condition) {
  bw_selection *on = NULL;
  double point[3] = {0}, normal[3] = {0};
  point[axis] = at, normal[axis] = 1;
  check_ok(context, bw_select_plane(context, heat->mesh, point, normal, 1e-9, &on));
  condition.on = on;
  check_ok(context, bw_heat_add(context, heat, &condition));
  bw_release(on);
}

/* A condition on the whole boundary. */
static inline void heat_on_all(bw_context *context, bw_heat *heat, bw_heat_condition condition) {
  bw_selection *on = NULL;
  check_ok(context, bw_select_all(context, heat->mesh, &on));
  condition.on = on;
  check_ok(context, bw_heat_add(context, heat, &condition));
  bw_release(on);
}

static inline bw_heat_solution *heat_steady(bw_context *context, const bw_heat *heat,
                                            const bw_solver *solver) {
  bw_heat_solution *solution = NULL;
  bw_heat_options options;
  bw_heat_options_default(&options);
  options.solver = solver;
  check_ok(context, bw_heat_steady(context, heat, &options, &solution));
  check_near(solution->imbalance, 0, 1e-9 * solution->throughput);
  return solution;
}

/* The temperature at the node nearest to a place. */
static inline double heat_at(const bw_heat_solution *solution, double x, double y, double z) {
  const bw_mesh *mesh = solution->mesh;
  int32_t nearest = 0;
  double least = INFINITY;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *p = mesh->node + 3 * (size_t)i;
    double d = hypot(hypot(p[0] - x, p[1] - y), p[2] - z);
    if (d < least)
      least = d, nearest = i;
  }
  return solution->temperature[nearest];
}

/* The root of the mean square of the difference from a field, over the volume. */
static inline double heat_error(const bw_heat_solution *solution,
                                double (*exact)(const double x[3])) {
  const bw_mesh *mesh = solution->mesh;
  int n = mesh->nodes_per_element;
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS], sum = 0, volume = 0;
  int points = bw_tet_quadrature(6, point, weight);
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int q = 0; q < points; q++) {
      double x[10][3], slope[10][3], shape[10], at[3] = {0}, t = 0;
      bw_tet_shape(mesh->order, point[q], shape);
      for (int a = 0; a < n; a++) {
        int32_t node = mesh->element[e * n + a];
        t += shape[a] * solution->temperature[node];
        for (int c = 0; c < 3; c++)
          x[a][c] = mesh->node[3 * (size_t)node + (size_t)c], at[c] += shape[a] * x[a][c];
      }
      double v = weight[q] * bw_tet_gradient(mesh->order, (const double(*)[3])x, point[q], slope);
      sum += v * (t - exact(at)) * (t - exact(at));
      volume += v;
    }
  return sqrt(sum / volume);
}

#endif
