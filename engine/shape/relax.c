/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Relaxation of an edited mesh: the neighbourhoods of bad elements are taken out as patches, each
 * untangled and smoothed on its own, and put back.
 *
 * A patch holds free nodes (corners that may move, off the boundary) within so many rings of a bad
 * element, and all elements around them, so that what it does to any element is seen. Patches that
 * share a free node are one patch; different ones share no free node, hence move nothing of each
 * other's, though both may touch one element. Where a patch cannot be untangled its nodes go back,
 * and it is tried again with more rings. */
#include "shape/mesh_repair_internal.h"

#include <math.h>
#include <string.h>

/* Elements below this, and below half of what they were at rest, are repaired too, though they are
 * the right way round: what is nearly flat spoils the equations. */
static const double poor_quality = 0.05;

typedef struct relaxer {
  bw_context *context;
  const bw_mesh *mesh;
  double *node;
  uint8_t *is_free; /* node_count */
  int64_t *start;   /* node_count + 1: the elements around each corner */
  int32_t *star;    /* ascending */
  double *quality;  /* element_count */
  int32_t *number;  /* node_count: in the ring search the nodes found, then places in a patch */
  int32_t *found;   /* the nodes found, by patch */
  int32_t *element_of_patch;
  uint8_t *seen;  /* element_count */
  uint8_t *stuck; /* element_count: cannot be repaired */
  bw_mesh_repair_report report;
} relaxer;

static double quality_now(const relaxer *r, int32_t e) {
  const int32_t *c = bwi_nodes_of(r->mesh, e);
  const double *const x[4] = {r->node + 3 * (size_t)c[0], r->node + 3 * (size_t)c[1],
                              r->node + 3 * (size_t)c[2], r->node + 3 * (size_t)c[3]};
  return bwi_checked_quality(x);
}

static double quality_at_rest(const relaxer *r, int32_t e) {
  const int32_t *c = bwi_nodes_of(r->mesh, e);
  const double *rest = r->mesh->node;
  return bw_shape_quality(rest + 3 * (size_t)c[0], rest + 3 * (size_t)c[1], rest + 3 * (size_t)c[2],
                          rest + 3 * (size_t)c[3]);
}

static bool is_bad(const relaxer *r, int32_t e) {
  double q = r->quality[e];
  return q <= 0 || (q < poor_quality && q < 0.5 * quality_at_rest(r, e));
}

static bw_status prepare(relaxer *r, const uint8_t *may_move) {
  const bw_mesh *mesh = r->mesh;
  size_t nodes = (size_t)mesh->node_count, elements = (size_t)mesh->element_count;
  r->is_free = BW_NEW0(r->context, uint8_t, nodes);
  r->start = BW_NEW0(r->context, int64_t, nodes + 2);
  r->star = BW_NEW(r->context, int32_t, 4 * elements);
  r->quality = BW_NEW(r->context, double, elements);
  r->number = BW_NEW(r->context, int32_t, nodes);
  r->found = BW_NEW(r->context, int32_t, nodes);
  r->element_of_patch = BW_NEW(r->context, int32_t, elements);
  r->seen = BW_NEW0(r->context, uint8_t, elements);
  r->stuck = BW_NEW0(r->context, uint8_t, elements);
  if (!r->is_free || !r->start || !r->star || !r->quality || !r->number || !r->found ||
      !r->element_of_patch || !r->seen || !r->stuck)
    return BW_MEMORY;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    r->quality[e] = quality_now(r, e);
    for (int k = 0; k < 4; k++) {
      int32_t c = bwi_nodes_of(r->mesh, e)[k];
      r->is_free[c] = may_move[c] != 0;
      r->start[c + 2]++;
    }
  }
  for (int32_t i = 0; i < mesh->boundary_node_count; i++)
    r->is_free[mesh->boundary_node[i]] = 0;
  for (size_t i = 0; i <= nodes; i++)
    r->start[i + 1] += r->start[i];
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++)
      r->star[r->start[bwi_nodes_of(r->mesh, e)[k] + 1]++] = e;
  for (size_t i = 0; i < nodes; i++)
    r->number[i] = -1;
  return BW_OK;
}

/* Free nodes within `rings` of the bad elements that are not stuck, in the order found. */
static int32_t find_nodes(relaxer *r, int rings) {
  int32_t count = 0, done = 0;
  for (int32_t e = 0; e < r->mesh->element_count; e++)
    if (!r->stuck[e] && is_bad(r, e))
      for (int k = 0; k < 4; k++) {
        int32_t c = bwi_nodes_of(r->mesh, e)[k];
        if (r->is_free[c] && r->number[c] < 0) {
          r->number[c] = 0;
          r->found[count++] = c;
        }
      }
  for (int ring = 1; ring < rings; ring++)
    for (int32_t end = count; done < end; done++)
      for (int64_t i = r->start[r->found[done]]; i < r->start[r->found[done] + 1]; i++)
        for (int k = 0; k < 4; k++) {
          int32_t c = bwi_nodes_of(r->mesh, r->star[i])[k];
          if (r->is_free[c] && r->number[c] < 0) {
            r->number[c] = 0;
            r->found[count++] = c;
          }
        }
  return count;
}

/* Bring the found nodes [first, ...) that hang together with found[first] to stand side by side;
 * returns the end of this patch. Numbers count within the patch from 1. */
static int32_t gather_patch(relaxer *r, int32_t first, int32_t *place) {
  int32_t end = first + 1;
  r->number[r->found[first]] = 1;
  for (int32_t at = first; at < end; at++)
    for (int64_t i = r->start[r->found[at]]; i < r->start[r->found[at] + 1]; i++)
      for (int k = 0; k < 4; k++) {
        int32_t c = bwi_nodes_of(r->mesh, r->star[i])[k];
        if (r->number[c] != 0)
          continue;
        int32_t other = r->found[end], from = place[c];
        r->found[end] = c;
        r->found[from] = other;
        place[other] = from;
        place[c] = end;
        r->number[c] = ++end - first;
      }
  return end;
}

static void patch_clear(bwi_patch *p) {
  bw_free(p->x);
  bw_free(p->corner);
  bw_free(p->fixed);
  bw_free(p->length);
}

static bw_status make_patch(relaxer *r, int32_t first, int32_t end, bwi_patch *p) {
  int32_t elements = 0;
  *p = (bwi_patch){.free_count = end - first};
  for (int32_t at = first; at < end; at++)
    for (int64_t i = r->start[r->found[at]]; i < r->start[r->found[at] + 1]; i++)
      if (!r->seen[r->star[i]]) {
        r->seen[r->star[i]] = 1;
        r->element_of_patch[elements++] = r->star[i];
      }
  for (int32_t i = 0; i < elements; i++)
    r->seen[r->element_of_patch[i]] = 0;
  p->element_count = elements;
  p->x = BW_NEW(r->context, double, 3 * (size_t)p->free_count);
  p->corner = BW_NEW(r->context, int32_t, 4 * (size_t)elements);
  p->fixed = BW_NEW(r->context, double, 12 * (size_t)elements);
  p->length = BW_NEW(r->context, double, elements);
  if (!p->x || !p->corner || !p->fixed || !p->length)
    return BW_MEMORY;
  for (int32_t i = first; i < end; i++)
    memcpy(p->x + 3 * (size_t)(i - first), r->node + 3 * (size_t)r->found[i], 3 * sizeof(double));
  for (int32_t i = 0; i < elements; i++) {
    int32_t e = r->element_of_patch[i];
    for (int k = 0; k < 4; k++) {
      int32_t c = bwi_nodes_of(r->mesh, e)[k];
      /* only numbers of this patch: those of others are for nodes that stay */
      bool ours = r->number[c] > 0 && first + r->number[c] - 1 < end &&
                  r->found[first + r->number[c] - 1] == c;
      p->corner[4 * (size_t)i + (size_t)k] = ours ? r->number[c] - 1 : -1;
      memcpy(p->fixed + 12 * (size_t)i + 3 * (size_t)k, r->node + 3 * (size_t)c,
             3 * sizeof(double));
    }
    p->length[i] = cbrt(8.4852813742385702 * r->mesh->volume[e]); /* V = h^3 / (6 sqrt 2) */
  }
  return BW_OK;
}

/* Repair the patch of found[first, end): the nodes move only when it is untangled. */
static bw_status repair_patch(relaxer *r, int32_t first, int32_t end, bool *repaired) {
  bwi_patch p;
  bw_status status;
  BW_TRY(make_patch(r, first, end, &p));
  BW_TRY(bwi_patch_untangle(r->context, &p, repaired));
  if (*repaired) {
    BW_TRY(bwi_patch_smooth(r->context, &p));
    for (int32_t i = first; i < end; i++)
      memcpy(r->node + 3 * (size_t)r->found[i], p.x + 3 * (size_t)(i - first), 3 * sizeof(double));
    for (int32_t i = 0; i < p.element_count; i++)
      r->quality[r->element_of_patch[i]] = quality_now(r, r->element_of_patch[i]);
  }
  r->report.iterations += p.iterations;
done:
  patch_clear(&p);
  return status;
}

/* One pass over all bad places with so many rings; *left counts what is still inverted. */
static bw_status repair_with(relaxer *r, int rings, int32_t *place, int32_t *left, int32_t *nodes) {
  bw_status status = BW_OK;
  int32_t count = find_nodes(r, rings);
  *nodes = count;
  for (int32_t i = 0; i < count; i++)
    place[r->found[i]] = i;
  for (int32_t first = 0; first < count;) {
    int32_t end = gather_patch(r, first, place);
    bool repaired;
    BW_TRY(repair_patch(r, first, end, &repaired));
    first = end;
  }
  *left = 0;
  for (int32_t e = 0; e < r->mesh->element_count; e++) {
    *left += r->quality[e] <= 0;
    r->stuck[e] = r->quality[e] > 0; /* what is only poor has had its turn */
  }
done:
  for (int32_t i = 0; i < count; i++)
    r->number[r->found[i]] = -1;
  return status;
}

static bw_status refuse(const relaxer *r, int32_t left, const double *before) {
  bw_mesh_repair_report now;
  bw_mesh_shape_check(r->mesh, r->node, 0, &now);
  const int32_t *c = bwi_nodes_of(r->mesh, now.worst);
  const double *x = before + 3 * (size_t)c[0];
  int constrained = 0;
  for (int k = 0; k < 4; k++)
    constrained += !r->is_free[c[k]];
  bw_fail(r->context, BW_GEOMETRY,
          "moving inner nodes leaves the mesh folded over itself at %d of %d places, at worst near "
          "(%g, %g, %g) m, where %d of 4 corners are on the boundary or must stay: undo the edit, "
          "make it smaller, or remesh there",
          left, r->report.inverted, x[0], x[1], x[2], constrained);
  bw_detail_number(r->context, "element", now.worst + 1.0);
  bw_detail_number(r->context, "inverted", left);
  return BW_GEOMETRY;
}

/* Whether an inverted element has no corner that may move: no relaxation repairs it. */
static bool has_constrained_inverted(const relaxer *r) {
  for (int32_t e = 0; e < r->mesh->element_count; e++) {
    const int32_t *c = bwi_nodes_of(r->mesh, e);
    if (r->quality[e] <= 0 &&
        !(r->is_free[c[0]] || r->is_free[c[1]] || r->is_free[c[2]] || r->is_free[c[3]]))
      return true;
  }
  return false;
}

static void place_mid_edge_nodes(const bw_mesh *mesh, const uint8_t *moved, double *node) {
  for (int32_t e = 0; e < mesh->element_count && mesh->order == 2; e++) {
    const int32_t *n = mesh->element + 10 * (size_t)e;
    for (int k = 0; k < 6; k++) {
      int32_t a = n[bw_tet_edge[k][0]], b = n[bw_tet_edge[k][1]];
      for (size_t i = 0; i < 3 && (moved[a] || moved[b]); i++)
        node[3 * (size_t)n[4 + k] + i] = 0.5 * (node[3 * (size_t)a + i] + node[3 * (size_t)b + i]);
    }
  }
}

static void relaxer_clear(relaxer *r) {
  bw_free(r->is_free);
  bw_free(r->start);
  bw_free(r->star);
  bw_free(r->quality);
  bw_free(r->number);
  bw_free(r->found);
  bw_free(r->element_of_patch);
  bw_free(r->seen);
  bw_free(r->stuck);
  bw_free(r->node);
}

bw_status bw_mesh_relax(bw_context *context, const bw_mesh *mesh, const uint8_t *may_move,
                        double *node, bw_mesh_repair_report *report) {
  static const int rings[] = {2, 4, 8};
  bw_status status = BW_OK;
  size_t numbers = 3 * (size_t)mesh->node_count;
  relaxer r = {.context = context, .mesh = mesh};
  int32_t *place = NULL, left, nodes = 0;
  bw_mesh_shape_check(mesh, node, 0, &r.report);
  if (!isfinite(r.report.worst_before)) {
    const int32_t *c = bwi_nodes_of(r.mesh, r.report.worst);
    return bw_fail(context, BW_INVALID,
                   "element %d (nodes %d %d %d %d) has a corner that is not at a finite place",
                   r.report.worst + 1, c[0] + 1, c[1] + 1, c[2] + 1, c[3] + 1);
  }
  r.node = BW_NEW(context, double, numbers);
  place = BW_NEW(context, int32_t, mesh->node_count);
  BW_TRY_MEMORY(r.node && place);
  memcpy(r.node, node, numbers * sizeof *node);
  BW_TRY(prepare(&r, may_move));
  left = r.report.inverted;
  for (int i = 0; i < (int)(sizeof rings / sizeof *rings) && (i == 0 || left > 0); i++) {
    if (has_constrained_inverted(&r))
      break;
    int32_t left_before = left, nodes_before = nodes;
    BW_TRY(repair_with(&r, rings[i], place, &left, &nodes));
    if (nodes == nodes_before && left == left_before)
      break; /* there are no more rings */
  }
  if (left > 0) {
    status = refuse(&r, left, node);
    goto done;
  }
  for (int32_t i = 0; i < mesh->node_count; i++) { /* is_free: moved, from here on */
    r.is_free[i] = memcmp(r.node + 3 * (size_t)i, node + 3 * (size_t)i, 3 * sizeof *node) != 0;
    r.report.moved += r.is_free[i];
  }
  place_mid_edge_nodes(mesh, r.is_free, r.node);
  memcpy(node, r.node, numbers * sizeof *node);
  r.report.worst_after = INFINITY;
  for (int32_t e = 0; e < mesh->element_count; e++)
    r.report.worst_after = fmin(r.report.worst_after, r.quality[e]);
done:
  if (report)
    *report = r.report;
  bw_free(place);
  relaxer_clear(&r);
  return status;
}
