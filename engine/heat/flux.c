/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Heat flux, -k grad T, in elements and at nodes, and the error estimate of Zienkiewicz and Zhu:
 * the flux at nodes, interpolated, stands for the true one. On an interface between materials the
 * part of the flux along it jumps, so that a node has one flux for each of them there. */
#include "heat/internal.h"

#include "barwright/model.h"

#include <math.h>
#include <string.h>

typedef struct flux_data {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *temperature;
  const double *state;          /* (K, node_count) at which the conductivity is */
  const double *recovered;      /* (W/m2, points->count x 3) of the estimate */
  const struct flux_data *dual; /* whose error is the other factor of the product; itself for the
                                   norm */
  const bw_stress_points *points;
  bwi_incidence incidence;
  double *out, *energy;
} flux_data;

/* The flux of an element at a point; k: its conductivity there. Returns the Jacobian. */
static double flux_at(const flux_data *d, int64_t e, const double l[4], double flux[3], double k[9],
                      double gradient[3]) {
  const bw_mesh *mesh = d->mesh;
  int n = mesh->nodes_per_element;
  const int32_t *node = mesh->element + e * n;
  double x[10][3], slope[10][3], shape[10], t = 0;
  bwi_element_nodes(mesh, e, x);
  double size = bw_tet_gradient(mesh->order, (const double(*)[3])x, l, slope);
  bw_tet_shape(mesh->order, l, shape);
  memset(gradient, 0, 3 * sizeof *gradient);
  for (int a = 0; a < n; a++) {
    t += shape[a] * d->state[node[a]];
    for (int c = 0; c < 3; c++)
      gradient[c] += slope[a][c] * d->temperature[node[a]];
  }
  bwi_heat_conductivity(d->material, e, k);
  double factor = bw_thermal_factor(&bw_material_of(d->material, e)->thermal, t);
  for (int i = 0; i < 9; i++)
    k[i] *= factor;
  for (int i = 0; i < 3; i++)
    flux[i] = -bw_dot(k + 3 * i, gradient);
  return size;
}

static bw_status of_points(void *data, int64_t begin, int64_t end, int worker) {
  const flux_data *d = data;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double sum[3] = {0}, volume = 0;
    int32_t node = bw_stress_point_node(d->points, (int32_t)i);
    for (int64_t p = d->incidence.start[node]; p < d->incidence.start[node + 1]; p++) {
      int64_t e = d->incidence.element[p];
      double l[4], flux[3], k[9], gradient[3];
      if (!bw_stress_point_has(d->points, (int32_t)i, d->material, e))
        continue;
      bwi_node_barycentric(d->incidence.local[p], l);
      flux_at(d, e, l, flux, k, gradient);
      volume += d->mesh->volume[e];
      for (int c = 0; c < 3; c++)
        sum[c] += d->mesh->volume[e] * flux[c];
    }
    for (int c = 0; c < 3; c++)
      d->out[3 * i + c] = volume > 0 ? sum[c] / volume : 0;
  }
  return BW_OK;
}

static bw_status of_elements(void *data, int64_t begin, int64_t end, int worker) {
  const flux_data *d = data;
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  int points = bw_tet_quadrature(d->mesh->order == 1 ? 1 : BWI_CURVED_DEGREE, point, weight);
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    double sum[3] = {0}, volume = 0, flux[3], k[9], gradient[3];
    for (int q = 0; q < points; q++) {
      double v = weight[q] * flux_at(d, e, point[q], flux, k, gradient);
      volume += v;
      for (int c = 0; c < 3; c++)
        sum[c] += v * flux[c];
    }
    for (int c = 0; c < 3; c++)
      d->out[3 * e + c] = sum[c] / volume;
  }
  return BW_OK;
}

/* The recovered flux at a point less that of the element; the inverse of the conductivity there.
 * Returns the Jacobian. */
static double difference_at(const flux_data *d, int64_t e, const double l[4], double difference[3],
                            double inverse[9], double *power) {
  double flux[3], k[9], gradient[3], shape[10];
  double size = flux_at(d, e, l, flux, k, gradient);
  bw_tet_shape(d->mesh->order, l, shape);
  bw_inverse3(k, inverse);
  for (int c = 0; c < 3; c++)
    difference[c] = -flux[c];
  for (int a = 0; a < d->mesh->nodes_per_element; a++) {
    const double *at = d->recovered + 3 * (int64_t)bw_stress_point_of(d->points, d->mesh, e, a);
    for (int c = 0; c < 3; c++)
      difference[c] += shape[a] * at[c];
  }
  *power = -bw_dot(flux, gradient);
  return size;
}

static bw_status errors(void *data, int64_t begin, int64_t end, int worker) {
  const flux_data *d = data;
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  int points = bw_tet_quadrature(d->mesh->order == 1 ? 2 : BWI_CURVED_DEGREE, point, weight);
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    d->out[e] = d->energy[e] = 0;
    for (int q = 0; q < points; q++) {
      double one[3], two[3], inverse[9], power, unused;
      double v = weight[q] / 6 * difference_at(d, e, point[q], one, inverse, &power);
      difference_at(d->dual, e, point[q], two, inverse, &unused);
      d->energy[e] += v * power;
      for (int c = 0; c < 3; c++)
        d->out[e] += v * one[c] * bw_dot(inverse + 3 * c, two);
    }
  }
  return BW_OK;
}

static flux_data data_of(const bw_heat_solution *solution, double *out) {
  return (flux_data){.mesh = solution->mesh,
                     .material = solution->material,
                     .temperature = solution->temperature,
                     .state = solution->temperature,
                     .out = out};
}

/* The flux (W/m2, count x 3) at all points, which the caller clears and frees. */
static bw_status recover(bw_context *context, flux_data d, bw_stress_points *points,
                         double **flux) {
  bw_status status = BW_OK;
  BW_TRY(bw_stress_points_create(context, d.mesh, d.material, points));
  d.points = points;
  d.out = *flux = BW_NEW(context, double, 3 * (size_t)points->count);
  BW_TRY_MEMORY(d.out);
  BW_TRY(bwi_incidence_create(context, d.mesh, &d.incidence));
  BW_TRY(bw_parallel(context, points->count, 256, of_points, &d));
done:
  bwi_incidence_clear(&d.incidence);
  return status;
}

bw_status bw_heat_flux(bw_context *context, const bw_heat_solution *solution, double *flux) {
  bw_status status = BW_OK;
  bw_stress_points points = {0};
  double *all = NULL;
  BW_TRY(recover(context, data_of(solution, NULL), &points, &all));
  for (int32_t i = 0; i < solution->mesh->node_count; i++) {
    const double *most = all + 3 * (int64_t)i;
    for (int32_t k = points.point ? points.point[i].next : -1; k >= 0; k = points.point[k].next) {
      const double *own = all + 3 * (int64_t)k;
      most = bw_dot(own, own) > bw_dot(most, most) ? own : most;
    }
    memcpy(flux + 3 * (int64_t)i, most, 3 * sizeof *flux);
  }
done:
  bw_free(all);
  bw_stress_points_clear(&points);
  return status;
}

bw_status bw_heat_element_flux(bw_context *context, const bw_heat_solution *solution,
                               double *flux) {
  flux_data d = data_of(solution, flux);
  return bw_parallel(context, d.mesh->element_count, 256, of_elements, &d);
}

/* Averages are superconvergent on tet4; on tet10 they fall short, as those of stress do. */
static double correction(const bw_mesh *mesh) {
  return mesh->order == 1 ? 1 : 1.5;
}

bw_status bw_heat_error(bw_context *context, const bw_heat_solution *solution, double *element,
                        double *relative) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = solution->mesh;
  bw_stress_points points = {0};
  double *recovered = NULL;
  double *own = element ? NULL : BW_NEW(context, double, mesh->element_count);
  double *energy = BW_NEW(context, double, mesh->element_count), error = 0, whole = 0;
  flux_data d = data_of(solution, element ? element : own);
  BW_TRY_MEMORY(energy && d.out);
  BW_TRY(recover(context, d, &points, &recovered));
  d.recovered = recovered;
  d.points = &points;
  d.energy = energy;
  d.dual = &d;
  BW_TRY(bw_parallel(context, mesh->element_count, 256, errors, &d));
  for (int32_t e = 0; e < mesh->element_count; e++) {
    error += d.out[e];
    whole += energy[e];
  }
  *relative = whole > 0 ? correction(mesh) * sqrt(error / whole) : 0;
done:
  bw_free(recovered);
  bw_stress_points_clear(&points);
  bw_free(own);
  bw_free(energy);
  return status;
}

/* The slope of the temperature from node a of an element to node b, at one of them, by the
 * recovered flux. */
static double slope_at(const flux_data *d, int64_t e, int at, const double step[3]) {
  double k[9], inverse[9], slope = 0;
  double t = d->state[d->mesh->element[e * d->mesh->nodes_per_element + at]];
  const double *flux = d->recovered + 3 * (int64_t)bw_stress_point_of(d->points, d->mesh, e, at);
  bwi_heat_conductivity(d->material, e, k);
  bw_inverse3(k, inverse);
  for (int c = 0; c < 3; c++)
    slope -= step[c] * bw_dot(inverse + 3 * c, flux);
  return slope / bw_thermal_factor(&bw_material_of(d->material, e)->thermal, t);
}

/* By how much the temperature between a node and those of the elements around it is above that of
 * the node: cubic, with the slopes of the recovered flux at both ends. */
static double above_node(const flux_data *d, int32_t node) {
  enum { PARTS = 16 };
  const bw_mesh *mesh = d->mesh;
  const int n = mesh->nodes_per_element;
  double most = 0, first = d->temperature[node];
  for (int64_t p = d->incidence.start[node]; p < d->incidence.start[node + 1]; p++) {
    int64_t e = d->incidence.element[p];
    const int32_t *element = mesh->element + e * n;
    int a = d->incidence.local[p];
    for (int b = 0; b < n; b++) {
      double step[3], jump = d->temperature[element[b]] - first;
      for (int c = 0; c < 3; c++)
        step[c] = mesh->node[3 * (int64_t)element[b] + c] - mesh->node[3 * (int64_t)node + c];
      double one = slope_at(d, e, a, step), two = slope_at(d, e, b, step);
      for (int i = 1; b != a && i < PARTS; i++) {
        double t = (double)i / PARTS;
        double rise = t * t * (3 - 2 * t) * jump + t * (1 - t) * ((1 - t) * one - t * two);
        most = fmax(most, rise);
      }
    }
  }
  return most;
}

bw_status bwi_heat_highest_error(bw_context *context, const bw_heat_solution *solution,
                                 const double *dual, double *error) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = solution->mesh;
  bw_stress_points points[2] = {{0}, {0}};
  double *recovered[2] = {NULL, NULL};
  double *product = BW_NEW(context, double, mesh->element_count);
  double *energy = BW_NEW(context, double, mesh->element_count), sum = 0;
  flux_data one = data_of(solution, product), two = data_of(solution, NULL);
  BW_TRY_MEMORY(product && energy);
  two.temperature = dual;
  BW_TRY(recover(context, one, &points[0], &recovered[0]));
  BW_TRY(recover(context, two, &points[1], &recovered[1]));
  one.recovered = recovered[0];
  two.recovered = recovered[1];
  one.points = two.points = &points[0];
  one.energy = energy;
  one.dual = &two;
  BW_TRY(bw_parallel(context, mesh->element_count, 256, errors, &one));
  for (int32_t e = 0; e < mesh->element_count; e++)
    sum += product[e];
  BW_TRY(bwi_incidence_create(context, mesh, &one.incidence));
  *error = fabs(sum) + above_node(&one, solution->highest_node);
done:
  bwi_incidence_clear(&one.incidence);
  for (int k = 0; k < 2; k++) {
    bw_free(recovered[k]);
    bw_stress_points_clear(&points[k]);
  }
  bw_free(product);
  bw_free(energy);
  return status;
}
