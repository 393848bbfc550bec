/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How the work of an adjoint field on a surface load, lambda . f(x), changes with the corners of
 * straight facets. With edges a = x1 - x0, b = x2 - x0, normal n = a x b of twice the area S,
 *     d(n . v) = da . (b x v) + db . (v x a),       dS = d(n . n0) / 2 with n0 = n / |n| fixed. */
#include "analysis/gradient.h"
#include "model/internal.h"

#include <math.h>
#include <string.h>

enum { ROTATING_DEGREE = 4 }; /* adjoint (2), arm (1), and the weight of a corner (1) */

typedef struct facet_state {
  const int32_t *node; /* corners, then mid-edge nodes */
  double x[3][3], a[3], b[3], middle[3], normal[3], area, unit[3];
} facet_state;

static void facet_load(const bw_mesh *mesh, int32_t facet, facet_state *f) {
  f->node = mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
  for (int k = 0; k < 3; k++)
    memcpy(f->x[k], mesh->node + 3 * (size_t)f->node[k], sizeof f->x[k]);
  for (int c = 0; c < 3; c++) {
    f->a[c] = f->x[1][c] - f->x[0][c];
    f->b[c] = f->x[2][c] - f->x[0][c];
    f->middle[c] = (f->x[0][c] + f->x[1][c] + f->x[2][c]) / 3;
  }
  bw_cross(f->a, f->b, f->normal);
  double size = bw_norm(f->normal);
  f->area = size / 2;
  for (int c = 0; c < 3; c++)
    f->unit[c] = size > 0 ? f->normal[c] / size : 0;
}

/* gradient += factor * d (n . v), v fixed */
static void add_normal(const facet_state *f, double factor, const double v[3], double *gradient) {
  double one[3], two[3];
  bw_cross(f->b, v, one);
  bw_cross(v, f->a, two);
  for (size_t c = 0; c < 3; c++) {
    gradient[3 * (size_t)f->node[0] + c] -= factor * (one[c] + two[c]);
    gradient[3 * (size_t)f->node[1] + c] += factor * one[c];
    gradient[3 * (size_t)f->node[2] + c] += factor * two[c];
  }
}

/* gradient += factor * d (area) */
static void add_area(const facet_state *f, double factor, double *gradient) {
  add_normal(f, factor / 2, f->unit, gradient);
}

/* Integral of the adjoint over a facet of unit area: a third of those nodes whose shape functions
 * have an integral, corners of order 1 and mid-edge nodes of order 2. */
static void mean_adjoint(const bw_mesh *mesh, const facet_state *f, const double *adjoint,
                         double mean[3]) {
  const int32_t *node = f->node + (mesh->order == 1 ? 0 : 3);
  for (size_t c = 0; c < 3; c++)
    mean[c] = (adjoint[3 * (size_t)node[0] + c] + adjoint[3 * (size_t)node[1] + c] +
               adjoint[3 * (size_t)node[2] + c]) /
              3;
}

/* ---- torque ---------------------------------------------------------------------------------- */

/* Traction w x y with y = x - about, w = I^-1 T and I = integral |y|^2 1 - y y^T. With
 * m = integral y x lambda and p = I^-1 m, fixed,
 *     lambda . f = w . m,   d (lambda . f) = w . dm - w . dI p = d integral phi,
 *     phi(y) = w . (y x lambda) - (y . y)(w . p) + (w . y)(p . y).
 * The point goes with the centre of the area (bw_model_moved). */
typedef struct rotation {
  int points;
  double at[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  double shape[BW_QUADRATURE_POINTS][6];
  double about[3], w[3], p[3];
  double area, centre[3]; /* of the selection */
  double by_about[3];     /* - integral of dphi/dy, summed facet by facet */
} rotation;

static void point_state(const bw_mesh *mesh, const facet_state *f, const rotation *r, int q,
                        const double *adjoint, double y[3], double lambda[3]) {
  for (size_t c = 0; c < 3; c++) {
    y[c] = lambda[c] = 0;
    for (int k = 0; k < 3; k++)
      y[c] += r->at[q][k] * (f->x[k][c] - r->about[c]);
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      lambda[c] += r->shape[q][a] * adjoint[3 * (size_t)f->node[a] + c];
  }
}

static bw_status prepare(bw_context *context, const bw_mesh *mesh, const bw_load *load,
                         const double *adjoint, rotation *r) {
  double inertia[9] = {0}, moment[3] = {0}, inverse[9];
  memset(r, 0, sizeof *r);
  r->points = bw_triangle_quadrature(ROTATING_DEGREE, r->at, r->weight);
  memcpy(r->about, load->about, sizeof r->about);
  for (int q = 0; q < r->points; q++)
    bw_facet_shape(mesh->order, r->at[q], r->shape[q]);
  for (int32_t i = 0; i < load->on->facet_count; i++) {
    facet_state f;
    facet_load(mesh, load->on->facet[i], &f);
    r->area += f.area;
    for (int c = 0; c < 3; c++)
      r->centre[c] += f.area * f.middle[c];
    for (int q = 0; q < r->points; q++) {
      double y[3], lambda[3], turn[3], size = r->weight[q] * f.area;
      point_state(mesh, &f, r, q, adjoint, y, lambda);
      bw_cross(y, lambda, turn);
      for (int k = 0; k < 3; k++) {
        moment[k] += size * turn[k];
        for (int l = 0; l < 3; l++)
          inertia[3 * k + l] += size * ((k == l ? bw_dot(y, y) : 0) - y[k] * y[l]);
      }
    }
  }
  if (bw_inverse3(inertia, inverse) == 0)
    return bw_fail(context, BW_GEOMETRY,
                   "the %d facets that a torque acts on have no lever arm about its point",
                   load->on->facet_count);
  for (int k = 0; k < 3; k++) {
    r->centre[k] /= r->area;
    r->w[k] = bw_dot(inverse + 3 * k, load->vector);
    r->p[k] = bw_dot(inverse + 3 * k, moment);
  }
  return BW_OK;
}

static void add_rotation(const bw_mesh *mesh, const facet_state *f, rotation *r,
                         const double *adjoint, double *gradient) {
  double mean = 0, wp = bw_dot(r->w, r->p);
  for (int q = 0; q < r->points; q++) {
    double y[3], lambda[3], turn[3], size = r->weight[q] * f->area;
    point_state(mesh, f, r, q, adjoint, y, lambda);
    double wy = bw_dot(r->w, y), py = bw_dot(r->p, y);
    bw_cross(lambda, r->w, turn); /* w . (y x lambda) = y . (lambda x w) */
    mean += r->weight[q] * (bw_dot(y, turn) - bw_dot(y, y) * wp + wy * py);
    for (size_t c = 0; c < 3; c++) {
      double slope = size * (turn[c] - 2 * wp * y[c] + py * r->w[c] + wy * r->p[c]);
      r->by_about[c] -= slope;
      for (int k = 0; k < 3; k++)
        gradient[3 * (size_t)f->node[k] + c] += r->at[q][k] * slope;
    }
  }
  add_area(f, mean, gradient);
}

/* The centre of the area moves by sum (S (dx0 + dx1 + dx2) / 3 + (middle - centre) dS) / area. */
static void add_centre(const bw_mesh *mesh, const bw_load *load, const rotation *r,
                       double *gradient) {
  for (int32_t i = 0; i < load->on->facet_count; i++) {
    facet_state f;
    double arm[3];
    facet_load(mesh, load->on->facet[i], &f);
    for (size_t c = 0; c < 3; c++) {
      arm[c] = f.middle[c] - r->centre[c];
      for (int k = 0; k < 3; k++)
        gradient[3 * (size_t)f.node[k] + c] += f.area / (3 * r->area) * r->by_about[c];
    }
    add_area(&f, bw_dot(arm, r->by_about) / r->area, gradient);
  }
}

/* ---- all loads on facets --------------------------------------------------------------------- */

bw_status bwi_gradient_surface_load(bw_context *context, const bw_model *model, const bw_load *load,
                                    const double *adjoint, double *gradient) {
  const bw_mesh *mesh = model->mesh;
  double area = 0, work = 0; /* of a total force: of the selection, and lambda . f */
  rotation r;
  facet_state f;
  if (load->kind == BW_LOAD_TORQUE) {
    bw_status status = prepare(context, mesh, load, adjoint, &r);
    if (status != BW_OK)
      return status;
  }
  if (load->kind == BW_LOAD_FORCE) {
    for (int32_t i = 0; i < load->on->facet_count; i++) {
      double mean[3];
      facet_load(mesh, load->on->facet[i], &f);
      mean_adjoint(mesh, &f, adjoint, mean);
      area += f.area;
      work += f.area * bw_dot(load->vector, mean);
    }
    if (!(area > 0))
      return bw_fail(context, BW_GEOMETRY, "the %d facets that a force acts on have no area",
                     load->on->facet_count);
    work /= area;
  }
  for (int32_t i = 0; i < load->on->facet_count; i++) {
    double mean[3];
    facet_load(mesh, load->on->facet[i], &f);
    mean_adjoint(mesh, &f, adjoint, mean);
    switch (load->kind) {
    case BW_LOAD_PRESSURE:
      add_normal(&f, -load->vector[0] / 2, mean, gradient);
      break;
    case BW_LOAD_TRACTION:
      add_area(&f, bw_dot(load->vector, mean), gradient);
      break;
    case BW_LOAD_FORCE:
      add_area(&f, (bw_dot(load->vector, mean) - work) / area, gradient);
      break;
    case BW_LOAD_TORQUE:
      add_rotation(mesh, &f, &r, adjoint, gradient);
      break;
    default:
      return bw_fail(context, BW_INTERNAL, "load kind %d does not act on a surface",
                     (int)load->kind);
    }
  }
  if (load->kind == BW_LOAD_TORQUE)
    add_centre(mesh, load, &r, gradient);
  return BW_OK;
}
