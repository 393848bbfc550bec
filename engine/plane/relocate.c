/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Relocation: where the nodes of a mesh go when its outline moves.
 *
 * Harmonic: x = base + H (b - base on the boundary), H the harmonic extension on the base mesh.
 * Where a place goes depends on the outline alone, not on the way there. When all that moved is one
 * handle, the displacement of the boundary is w d with one weight w per node and one vector d; then
 * H w is kept, and the next frame costs one multiplication per node. */
#include "plane/harmonic.h"
#include "plane/mesh_motion.h"

#include <math.h>
#include <string.h>

struct bwi_relocator {
  bw_object object;
  const bw_plane_mesh *base; /* retained */
  bwi_harmonic *harmonic;    /* NULL: not needed yet */
  double extent;             /* of the base */
  double *u;                 /* corners x 2 */
  double *shape;             /* corners: w on the boundary and H w inside */
  int32_t pivot;             /* the boundary corner with w = 1, -1: no shape is known */
};

static double extent_of(const bw_plane_mesh *mesh) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int64_t i = 0; i < mesh->topology->nodes->node_count; i++)
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], mesh->point[2 * i + k]);
      high[k] = fmax(high[k], mesh->point[2 * i + k]);
    }
  return fmax(high[0] - low[0], high[1] - low[1]);
}

static void relocator_destroy(void *object) {
  bwi_relocator *relocator = object;
  bw_release(relocator->base);
  bwi_harmonic_destroy(relocator->harmonic);
  bw_free(relocator->u);
  bw_free(relocator->shape);
  bw_free(relocator);
}

static const bw_kind relocator_kind = {"relocator", relocator_destroy, NULL};

bw_status bwi_relocator_create(bw_context *context, const bw_plane_mesh *base,
                               bwi_relocator **out) {
  bw_status status = BW_OK;
  const bw_plane_nodes *nodes = base->topology->nodes;
  bwi_relocator *made = BW_NEW0(context, bwi_relocator, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &relocator_kind);
  made->base = bw_retain(base);
  made->pivot = -1;
  made->extent = extent_of(base);
  made->u = BW_NEW(context, double, 2 * (size_t)nodes->corner_count);
  made->shape = BW_NEW(context, double, nodes->corner_count);
  BW_TRY_MEMORY(made->u && made->shape);
  *out = made;
  made = NULL;
done:
  bw_release(made);
  return status;
}

const bw_plane_mesh *bwi_relocator_base(const bwi_relocator *relocator) {
  return relocator->base;
}

static bw_status need_factor(bw_context *context, bwi_relocator *r) {
  if (r->harmonic)
    return BW_OK;
  return bwi_harmonic_create(context, r->base->topology, r->base->point, &r->harmonic);
}

static void put_on_outline(const bw_plane_nodes *nodes, const bw_outline *outline, double *point) {
  for (int32_t i = 0; i < nodes->node_count; i++)
    if (nodes->segment[i] >= 0)
      bw_outline_evaluate(outline, nodes->segment[i], nodes->parameter[i], point + 2 * (size_t)i,
                          NULL, NULL);
}

/* Whether u on the boundary is the known shape times a vector, which is then u at the pivot. */
static bool has_shape(const bwi_relocator *r, const bw_plane_nodes *nodes) {
  if (r->pivot < 0)
    return false;
  const double *d = r->u + 2 * (size_t)r->pivot;
  for (int32_t i = 0; i < nodes->corner_count; i++) {
    if (nodes->segment[i] < 0)
      continue;
    for (size_t k = 0; k < 2; k++)
      if (fabs(r->u[2 * (size_t)i + k] - r->shape[i] * d[k]) > 1e-13 * r->extent)
        return false;
  }
  return true;
}

/* After u was extended: the shape, where there is one. Small moves would bring out rounding. */
static void learn_shape(bwi_relocator *r, const bw_plane_nodes *nodes) {
  int32_t pivot = -1;
  double largest = 1e-4 * r->extent;
  for (int32_t i = 0; i < nodes->corner_count; i++) {
    double size = hypot(r->u[2 * (size_t)i], r->u[2 * (size_t)i + 1]);
    if (nodes->segment[i] >= 0 && size > largest) {
      largest = size;
      pivot = i;
    }
  }
  r->pivot = -1;
  if (pivot < 0)
    return;
  const double *d = r->u + 2 * (size_t)pivot;
  double square = d[0] * d[0] + d[1] * d[1];
  for (int32_t i = 0; i < nodes->corner_count; i++) {
    const double *u = r->u + 2 * (size_t)i;
    r->shape[i] = i == pivot ? 1 : (u[0] * d[0] + u[1] * d[1]) / square;
  }
  r->pivot = pivot;
  if (!has_shape(r, nodes))
    r->pivot = -1;
}

bw_status bwi_relocate(bw_context *context, bwi_relocator *r, const bw_outline *outline,
                       double *point) {
  bw_status status = BW_OK;
  const bw_plane_topology *t = r->base->topology;
  const bw_plane_nodes *nodes = t->nodes;
  const double *base = r->base->point;
  memcpy(point, base, 2 * (size_t)nodes->node_count * sizeof *point);
  put_on_outline(nodes, outline, point);
  for (int32_t i = 0; i < nodes->corner_count; i++)
    for (size_t k = 0; k < 2; k++)
      r->u[2 * (size_t)i + k] = point[2 * (size_t)i + k] - base[2 * (size_t)i + k];
  if (has_shape(r, nodes)) {
    double d[2] = {r->u[2 * (size_t)r->pivot], r->u[2 * (size_t)r->pivot + 1]};
    for (int32_t i = 0; i < nodes->corner_count; i++)
      for (size_t k = 0; k < 2; k++)
        r->u[2 * (size_t)i + k] = r->shape[i] * d[k];
  } else {
    BW_TRY(need_factor(context, r));
    bwi_harmonic_extend(r->harmonic, r->u);
    learn_shape(r, nodes);
  }
  for (int32_t i = 0; i < nodes->corner_count; i++)
    if (nodes->segment[i] < 0)
      for (size_t k = 0; k < 2; k++)
        point[2 * (size_t)i + k] = base[2 * (size_t)i + k] + r->u[2 * (size_t)i + k];
  if (nodes->order == 2)
    for (int64_t h = 0; h < 3 * (int64_t)t->element_count; h++) {
      const int32_t *n = t->element + 6 * (size_t)(h / 3);
      int32_t middle = n[3 + h % 3];
      if (nodes->segment[middle] >= 0)
        continue;
      const double *a = r->u + 2 * (size_t)n[h % 3], *b = r->u + 2 * (size_t)n[(h % 3 + 1) % 3];
      for (size_t k = 0; k < 2; k++)
        point[2 * (size_t)middle + k] = base[2 * (size_t)middle + k] + (a[k] + b[k]) / 2;
    }
done:
  return status;
}

/* ---- springs --------------------------------------------------------------------------------- */

static void centre_mid_edge_nodes(const bw_plane_topology *t, double *point) {
  for (int64_t h = 0; h < 3 * (int64_t)t->element_count; h++) {
    const int32_t *n = t->element + 6 * (size_t)(h / 3);
    if (t->nodes->segment[n[3 + h % 3]] >= 0)
      continue;
    for (size_t k = 0; k < 2; k++)
      point[2 * (size_t)n[3 + h % 3] + k] =
          (point[2 * (size_t)n[h % 3] + k] + point[2 * (size_t)n[(h % 3 + 1) % 3] + k]) / 2;
  }
}

/* Springs of rest length zero between neighbours, all alike: at rest every inner node lies at the
 * mean of its neighbours. Each edge with an inner end is met once from either side. */
bw_status bwi_relocate_springs(bw_context *context, const bw_plane_mesh *mesh,
                               const bw_outline *outline, int rounds, double *point) {
  const bw_plane_topology *t = mesh->topology;
  const bw_plane_nodes *nodes = t->nodes;
  size_t width = (size_t)bwi_plane_width(nodes);
  double *sum = BW_NEW(context, double, 3 * (size_t)nodes->corner_count);
  if (!sum)
    return BW_MEMORY;
  memcpy(point, mesh->point, 2 * (size_t)nodes->node_count * sizeof *point);
  put_on_outline(nodes, outline, point);
  for (int sweep = 0; sweep < rounds; sweep++) {
    memset(sum, 0, 3 * (size_t)nodes->corner_count * sizeof *sum);
    for (int64_t h = 0; h < 3 * (int64_t)t->element_count; h++) {
      /* around an inner node each neighbour is the end of one directed edge */
      const int32_t *n = t->element + width * (size_t)(h / 3);
      double *to = sum + 3 * (size_t)n[h % 3];
      const double *other = point + 2 * (size_t)n[(h % 3 + 1) % 3];
      to[0] += other[0];
      to[1] += other[1];
      to[2] += 1;
    }
    for (int32_t i = 0; i < nodes->corner_count; i++)
      if (nodes->segment[i] < 0)
        for (size_t k = 0; k < 2; k++)
          point[2 * (size_t)i + k] = sum[3 * (size_t)i + k] / sum[3 * (size_t)i + 2];
  }
  if (nodes->order == 2)
    centre_mid_edge_nodes(t, point);
  bw_free(sum);
  return BW_OK;
}

/* ---- adjoint --------------------------------------------------------------------------------- */

bw_status bwi_relocate_adjoint(bw_context *context, bwi_relocator *r, const bw_plane_mesh *mesh,
                               const double *node_gradient, double *point_gradient) {
  bw_status status = BW_OK;
  const bw_plane_topology *t = r->base->topology;
  const bw_plane_nodes *nodes = t->nodes;
  const bw_outline *outline = mesh->outline;
  if (mesh->topology->nodes != nodes)
    return bw_fail(
        context, BW_INVALID,
        "a gradient by %d nodes of a mesh that this mesh motion does not move: its mesh has %d",
        mesh->topology->nodes->node_count, nodes->node_count);
  double *g = BW_NEW(context, double, 2 * (size_t)nodes->node_count);
  if (!g)
    return BW_MEMORY;
  memcpy(g, node_gradient, 2 * (size_t)nodes->node_count * sizeof *g);
  BW_TRY(need_factor(context, r));
  if (nodes->order == 2)
    for (int64_t h = 0; h < 3 * (int64_t)t->element_count; h++) {
      const int32_t *n = t->element + 6 * (size_t)(h / 3);
      int32_t middle = n[3 + h % 3];
      if (nodes->segment[middle] >= 0 || t->neighbour[h] > h / 3)
        continue;
      for (size_t k = 0; k < 2; k++) {
        g[2 * (size_t)n[h % 3] + k] += g[2 * (size_t)middle + k] / 2;
        g[2 * (size_t)n[(h % 3 + 1) % 3] + k] += g[2 * (size_t)middle + k] / 2;
      }
    }
  bwi_harmonic_gather(r->harmonic, g);
  memset(point_gradient, 0, 2 * (size_t)outline->point_count * sizeof *point_gradient);
  for (int32_t i = 0; i < nodes->node_count; i++) {
    if (nodes->segment[i] < 0)
      continue;
    double weight[4];
    const bw_segment *segment = &outline->segment[nodes->segment[i]];
    bw_outline_basis(outline, nodes->segment[i], nodes->parameter[i], weight);
    for (int j = 0; j < 4; j++)
      if (segment->point[j] >= 0)
        for (size_t k = 0; k < 2; k++)
          point_gradient[2 * (size_t)segment->point[j] + k] += weight[j] * g[2 * (size_t)i + k];
  }
done:
  bw_free(g);
  return status;
}
