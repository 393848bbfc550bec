/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Couplings of faces with remote points. A distributed one has the mean motion of its face, which
 * is the motion of a rigid one too: with the centroid c and y = x - c,
 *
 *     q_c = 1/A integral u dA,   theta = J^-1 1/A integral y x u dA,
 *     J = 1/A integral (|y|^2 1 - y y^T) dA,   q = q_c + theta x (at - c).
 *
 * A node set without facets has sums over its nodes instead. */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "model/internal.h"

void bwi_coupling_clear(bw_coupling *coupling) {
  bw_release(coupling->on);
  bw_free(coupling->node);
  bw_free(coupling->mean);
}

/* Nodes lie on one line where the smallest moment of area is below this part of the largest. */
static const double line_part = 1e-10;
/* The distance of a point from the centre of its face, in the smallest radii of gyration of the
 * face. A rigid coupling loses digits with its square, which the residual does not show: on a thin
 * plate the error is 8e-6 at 3e3, 1e-3 at 3e4 and 0.05 at 3e5 (docs/theory/joints.md). */
static const double longest_lever = 1e4;

static bw_status check_finite(bw_context *context, const char *what, int count, const double *v) {
  for (int k = 0; k < count; k++)
    if (!isfinite(v[k]))
      return bw_fail(context, BW_INVALID,
                     "component %d of the remote point's %s is not a finite number", k + 1, what);
  return BW_OK;
}

static bw_status check_point(bw_context *context, const bw_remote_point *p) {
  bw_status status = BW_OK;
  double inertia[9], vector[9];
  BW_TRY(check_finite(context, "place", 3, p->at));
  BW_TRY(check_finite(context, "force", 3, p->load));
  BW_TRY(check_finite(context, "moment", 3, p->load + 3));
  BW_TRY(check_finite(context, "displacement", 3, p->displacement));
  BW_TRY(check_finite(context, "rotation", 3, p->displacement + 3));
  BW_TRY(check_finite(context, "spring", 3, p->spring));
  BW_TRY(check_finite(context, "rotational spring", 3, p->spring + 3));
  BW_TRY(check_finite(context, "inertia", 9, p->inertia));
  for (int k = 0; k < 6; k++)
    if (p->spring[k] < 0)
      return bw_fail(context, BW_INVALID,
                     "component %d of the remote point's %sspring is %g %s; it must be 0 or more",
                     k % 3 + 1, k < 3 ? "" : "rotational ", p->spring[k],
                     k < 3 ? "N/m" : "N m/rad");
  if (!(p->mass >= 0) || !isfinite(p->mass))
    return bw_fail(context, BW_INVALID, "the remote point's mass is %g kg; it must be 0 or more",
                   p->mass);
  memcpy(inertia, p->inertia, sizeof inertia);
  bwi_symmetric_eigen(3, 3, inertia, vector, 1e-30, 60);
  double largest = fmax(fabs(inertia[0]), fmax(fabs(inertia[4]), fabs(inertia[8])));
  for (int k = 0; k < 3; k++)
    if (inertia[4 * k] < -1e-12 * largest || p->inertia[k] != p->inertia[3 * k] ||
        p->inertia[5] != p->inertia[7])
      return bw_fail(context, BW_INVALID,
                     "the remote point's inertia is not symmetric, or a moment of inertia is below "
                     "0 kg m2");
done:
  return status;
}

/* The nodes of the facets; without facets those of the selection. */
static bw_status take_nodes(bw_context *context, const bw_selection *on, bw_coupling *coupling) {
  const bw_mesh *mesh = on->mesh;
  uint8_t *mark = BW_NEW0(context, uint8_t, mesh->node_count);
  if (!mark)
    return BW_MEMORY;
  int width = mesh->nodes_per_facet;
  for (int32_t f = 0; f < on->facet_count; f++)
    for (int k = 0; k < width; k++)
      mark[mesh->facet[(int64_t)on->facet[f] * width + k]] = 1;
  for (int32_t i = 0; i < on->node_count && on->facet_count == 0; i++)
    mark[on->node[i]] = 1;
  for (int32_t i = 0; i < mesh->node_count; i++)
    coupling->node_count += mark[i];
  coupling->node = BW_NEW(context, int32_t, coupling->node_count);
  int32_t count = 0;
  for (int32_t i = 0; coupling->node && i < mesh->node_count; i++)
    if (mark[i])
      coupling->node[count++] = i;
  bw_free(mark);
  return coupling->node ? BW_OK : BW_MEMORY;
}

/* Where a node is in the ascending list. */
static int32_t place_of(const bw_coupling *coupling, int32_t node) {
  int32_t low = 0, high = coupling->node_count - 1;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (coupling->node[middle] < node)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Calls `take` with each integration point: its part of the area, place, nodes and shape. */
typedef void take_point(void *data, double weight, const double x[3], int count,
                        const int32_t *node, const double *shape);
static void integrate(const bw_coupling *coupling, take_point *take, void *data) {
  const bw_selection *on = coupling->on;
  const bw_mesh *mesh = on->mesh;
  const double one = 1;
  for (int32_t f = 0; f < on->facet_count; f++) {
    bwi_boundary_point point[BW_QUADRATURE_POINTS];
    int points = bwi_boundary_points(mesh, on->facet[f], point);
    const int32_t *node = mesh->facet + (int64_t)on->facet[f] * mesh->nodes_per_facet;
    for (int p = 0; p < points; p++)
      take(data, bw_norm(point[p].area), point[p].at, mesh->nodes_per_facet, node, point[p].shape);
  }
  for (int32_t i = 0; i < coupling->node_count && on->facet_count == 0; i++)
    take(data, 1, mesh->node + 3 * (int64_t)coupling->node[i], 1, &coupling->node[i], &one);
}

typedef struct face {
  const bw_coupling *coupling;
  double weight, centre[3], j[9], inverse[9];
  double radius; /* the smallest one of gyration */
  double *mean;
} face;

static void add_centre(void *data, double weight, const double x[3], int count, const int32_t *node,
                       const double *shape) {
  face *s = data;
  (void)count, (void)node, (void)shape;
  s->weight += weight;
  for (int c = 0; c < 3; c++)
    s->centre[c] += weight * x[c];
}

static void add_moments(void *data, double weight, const double x[3], int count,
                        const int32_t *node, const double *shape) {
  face *s = data;
  double y[3] = {x[0] - s->centre[0], x[1] - s->centre[1], x[2] - s->centre[2]};
  (void)count, (void)node, (void)shape;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      s->j[3 * a + b] += weight / s->weight * ((a == b ? bw_dot(y, y) : 0) - y[a] * y[b]);
}

/* Column (node, c) of the mean: unit displacement e_c there. */
static void add_mean(void *data, double weight, const double x[3], int count, const int32_t *node,
                     const double *shape) {
  face *s = data;
  int64_t width = 3 * (int64_t)s->coupling->node_count;
  double y[3] = {x[0] - s->centre[0], x[1] - s->centre[1], x[2] - s->centre[2]};
  for (int i = 0; i < count; i++)
    for (int c = 0; c < 3; c++) {
      double part = weight / s->weight * shape[i], turn[3];
      int64_t column = 3 * (int64_t)place_of(s->coupling, node[i]) + c;
      bw_cross(y, (double[3]){c == 0, c == 1, c == 2}, turn);
      s->mean[c * width + column] += part;
      for (int k = 0; k < 3; k++)
        s->mean[(3 + k) * width + column] += part * bw_dot(s->inverse + 3 * k, turn);
    }
}

/* q = q_c + theta x (at - c) */
static void move_to_point(const face *s, double *mean) {
  const double *at = s->coupling->point.at;
  int64_t width = 3 * (int64_t)s->coupling->node_count;
  double arm[3] = {at[0] - s->centre[0], at[1] - s->centre[1], at[2] - s->centre[2]};
  for (int64_t i = 0; i < width; i++) {
    double turn[3] = {mean[3 * width + i], mean[4 * width + i], mean[5 * width + i]}, shift[3];
    bw_cross(turn, arm, shift);
    for (int c = 0; c < 3; c++)
      mean[c * width + i] += shift[c];
  }
}

/* J^-1 and the radius, or BW_GEOMETRY where a rotation is undefined. */
static bw_status invert(bw_context *context, face *s, const char *what) {
  double value[9], vector[9];
  memcpy(value, s->j, sizeof value);
  bwi_symmetric_eigen(3, 3, value, vector, 1e-30, 60);
  double largest = fmax(value[0], fmax(value[4], value[8]));
  double least = fmin(value[0], fmin(value[4], value[8]));
  if (!(least > line_part * largest))
    return bw_fail(context, BW_GEOMETRY,
                   "the %d node%s of %s lie on one line, which leaves the rotation of its remote "
                   "point about that line undefined: couple a face, or nodes that span one",
                   s->coupling->node_count, s->coupling->node_count == 1 ? "" : "s", what);
  s->radius = sqrt(least);
  memset(s->inverse, 0, sizeof s->inverse);
  for (int k = 0; k < 3; k++)
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++)
        s->inverse[3 * a + b] += vector[3 * k + a] * vector[3 * k + b] / value[4 * k];
  return BW_OK;
}

static bw_status check_lever(bw_context *context, const face *s) {
  const double *at = s->coupling->point.at;
  double arm[3] = {at[0] - s->centre[0], at[1] - s->centre[1], at[2] - s->centre[2]};
  double lever = bw_norm(arm), longest = longest_lever * s->radius;
  if (lever <= longest)
    return BW_OK;
  bw_fail(context, BW_GEOMETRY,
          "the remote point is %.4g m from the centre of its face, which is a lever too long for "
          "double precision: for this face at most %.4g m are possible. Give the place in metres, "
          "or couple a larger face, or put the point nearer and add the moment of its force",
          lever, longest);
  bw_detail_number(context, "lever", lever);
  return BW_GEOMETRY;
}

static bw_status measure(bw_context *context, bw_coupling *coupling) {
  bw_status status = BW_OK;
  face s = {.coupling = coupling};
  const double *x = coupling->on->mesh->node;
  integrate(coupling, add_centre, &s);
  for (int c = 0; c < 3; c++)
    s.centre[c] /= s.weight;
  integrate(coupling, add_moments, &s);
  BW_TRY(invert(context, &s,
                coupling->point.kind == BW_RIGID ? "a rigid coupling" : "a distributed coupling"));
  BW_TRY(check_lever(context, &s));
  for (int32_t i = 0; i < coupling->node_count; i++)
    for (int c = 0; c < 3; c++) {
      double arm = x[3 * (int64_t)coupling->node[i] + c] - coupling->point.at[c];
      coupling->reach += arm * arm / coupling->node_count;
    }
  coupling->reach = sqrt(coupling->reach);
  s.mean = coupling->mean = BW_NEW0(context, double, 18 * (int64_t)coupling->node_count);
  BW_TRY_MEMORY(s.mean);
  integrate(coupling, add_mean, &s);
  move_to_point(&s, coupling->mean);
done:
  return status;
}

/* A node moves with one remote point only. */
static bw_status check_apart(bw_context *context, const bw_model *model, const bw_coupling *made) {
  for (int c = 0; c < model->coupling_count; c++) {
    const bw_coupling *other = &model->coupling[c];
    if (made->point.kind != BW_RIGID || other->point.kind != BW_RIGID)
      continue;
    for (int32_t i = 0; i < made->node_count; i++) {
      int32_t node = made->node[i];
      const double *x = model->mesh->node + 3 * (int64_t)node;
      if (other->node[place_of(other, node)] != node)
        continue;
      bw_fail(context, BW_INVALID,
              "node %d at (%g, %g, %g) m is in the rigid coupling %d already: a node can move with "
              "one remote point only; couple faces without a common edge, or make one coupling "
              "distributed",
              node + 1, x[0], x[1], x[2], c + 1);
      bw_detail_number(context, "node", node + 1.0);
      return BW_INVALID;
    }
  }
  return BW_OK;
}

bw_status bwi_coupling_make(bw_context *context, const bw_model *model, const bw_selection *on,
                            const bw_remote_point *point, bw_coupling *out) {
  bw_status status = BW_OK;
  bw_coupling made = {.point = *point};
  BW_TRY(check_point(context, point));
  made.on = bw_retain(on);
  made.area = bw_selection_area(on);
  if (on->facet_count > 0 && !(made.area > 0))
    BW_TRY(
        bw_fail(context, BW_GEOMETRY, "the %d facets of a coupling have no area", on->facet_count));
  BW_TRY(take_nodes(context, on, &made));
  BW_TRY(measure(context, &made));
  BW_TRY(check_apart(context, model, &made));
  *out = made;
done:
  if (status != BW_OK)
    bwi_coupling_clear(&made);
  return status;
}
