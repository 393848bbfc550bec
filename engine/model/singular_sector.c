/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Singular places where sectors of cyclic symmetry meet (docs/theory/singular.md). A cut is no
 * surface: an edge on the border of the low face has the rest of its wedge at the matching edge of
 * the high face, in the next sector. */
#include "model/singular_sector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/internal.h"

/* Of the size of the mesh. */
static const double in_cut = 1e-6;

/* An edge between a cut and another facet. */
typedef struct half {
  int32_t node[2]; /* of the low face, ascending */
  bool high;
  int32_t facet; /* that is no cut */
  int64_t side;  /* of the facet that is one */
  double angle, inward[3];
} half;

static int by_nodes(const void *a, const void *b) {
  const half *x = a, *y = b;
  for (int k = 0; k < 2; k++)
    if (x->node[k] != y->node[k])
      return x->node[k] < y->node[k] ? -1 : 1;
  return (int)x->high - (int)y->high;
}

static half half_of(const bwi_sector_border *b, const int64_t *side, bool first) {
  const bwi_topology *top = b->top;
  const double *p = top->point + 3 * (size_t)bwi_side_from(top, side[0]);
  const double *q = top->point + 3 * (size_t)bwi_side_to(top, side[0]);
  half h = {.facet = (int32_t)(side[first ? 1 : 0] / 3), .side = side[first ? 0 : 1]};
  const int32_t *node = b->mesh->facet + h.side / 3 * b->mesh->nodes_per_facet;
  for (int k = 0; k < 2; k++) {
    int32_t own = node[(h.side % 3 + k) % 3], partner = b->cyclic->partner[own];
    h.high |= partner >= 0 && partner != own;
    h.node[k] = partner >= 0 ? partner : own;
  }
  if (h.node[0] > h.node[1]) {
    int32_t other = h.node[0];
    h.node[0] = h.node[1];
    h.node[1] = other;
  }
  h.angle =
      bwi_opening(p, q, b->normal + 3 * (side[0] / 3), b->normal + 3 * (side[1] / 3), h.inward);
  return h;
}

/* The bisector of both wedges: the direction in the cut, away from the edge, turned into the larger
 * one by half of the difference. On a face that slides it is along that. */
static void find_bisector(const bwi_sector_border *b, const half *own, double difference,
                          double inward[3]) {
  const bwi_topology *top = b->top;
  const double *p = top->point + 3 * (size_t)bwi_side_from(top, own->side);
  const double *q = top->point + 3 * (size_t)bwi_side_to(top, own->side);
  const double edge[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
  double along[3], across[3];
  bw_cross(b->normal + 3 * (own->side / 3), edge, along);
  double size = bw_norm(along);
  for (int k = 0; k < 3; k++)
    along[k] /= size > 0 ? size : 1;
  double part = bw_dot(own->inward, along);
  for (int k = 0; k < 3; k++)
    across[k] = own->inward[k] - part * along[k];
  size = bw_norm(across);
  for (int k = 0; k < 3; k++)
    inward[k] =
        cos(difference / 2) * along[k] + (size > 0 ? sin(difference / 2) * across[k] / size : 0);
}

static bw_status add_pair(bw_context *context, const bwi_sector_border *b, const half *low,
                          const half *high, bw_corner corner, bwi_seams *seams) {
  const double pi = 3.14159265358979323846;
  int one = b->corner[low->facet], two = b->corner[high->facet];
  double angle = low->angle + high->angle;
  if (one + two != (int)corner || (corner != BW_CORNER_FREE && one == two))
    return BW_OK;
  if (corner == BW_CORNER_FREE && angle - pi <= b->margin)
    return BW_OK;
  if (corner == BW_CORNER_SLIDING && 2 * angle - pi <= BWI_FACET_MARGIN)
    return BW_OK;
  const half *own = low->angle >= high->angle ? low : high, *other = own == low ? high : low;
  bwi_seam seam = {
      .end = {bwi_side_from(b->top, own->side), bwi_side_to(b->top, own->side)},
      .key = {b->faces->of_triangle[own->facet], b->faces->of_triangle[other->facet], own->high},
      .angle = angle};
  find_bisector(b, own, own->angle - other->angle, seam.inward);
  return bwi_seams_add(context, seams, &seam);
}

bw_status bwi_sector_seams(bw_context *context, const bwi_sector_border *b, bw_corner corner,
                           bwi_seams *seams) {
  bw_status status = BW_OK;
  const bwi_topology *top = b->top;
  int64_t count = 0;
  half *list = BW_NEW(context, half, top->edges);
  BW_TRY_MEMORY(list);
  for (int64_t e = 0; e < top->edges; e++) {
    const int64_t *side = top->side + top->start[e];
    if (top->start[e + 1] - top->start[e] == 2 && b->cut[side[0] / 3] != b->cut[side[1] / 3])
      list[count++] = half_of(b, side, b->cut[side[0] / 3] != 0);
  }
  if (count > 0)
    qsort(list, (size_t)count, sizeof *list, by_nodes);
  for (int64_t i = 0; i + 1 < count; i++)
    if (list[i].node[0] == list[i + 1].node[0] && list[i].node[1] == list[i + 1].node[1] &&
        !list[i].high && list[i + 1].high)
      BW_TRY(add_pair(context, b, &list[i], &list[i + 1], corner, seams));
done:
  bw_free(list);
  return status;
}

/* ---- edges of the boundary that the wheel has not -------------------------------------------- */

static bool is_in_cut(const bw_model *model, const double *point, double near) {
  const bw_selection *cut[2] = {model->cyclic->low, model->cyclic->high};
  double weight[3];
  for (int c = 0; c < 2; c++)
    for (int32_t f = 0; f < cut[c]->facet_count; f++)
      if (bwi_boundary_nearest(model->mesh, cut[c]->facet[f], point, weight) <= near * near)
        return true;
  return false;
}

bw_status bwi_sector_without_cuts(bw_context *context, const bw_model *model,
                                  bw_singular_places **places) {
  bw_status status = BW_OK;
  const bw_singular_places *given = *places;
  bw_singular_places *kept = NULL;
  double low[3], high[3], size = 0;
  memcpy(low, model->mesh->node, sizeof low);
  memcpy(high, low, sizeof high);
  for (int64_t i = 0; i < 3 * (int64_t)model->mesh->node_count; i++) {
    low[i % 3] = fmin(low[i % 3], model->mesh->node[i]);
    high[i % 3] = fmax(high[i % 3], model->mesh->node[i]);
  }
  for (int k = 0; k < 3; k++)
    size = fmax(size, high[k] - low[k]);
  double near = in_cut * size + model->cyclic->distance;
  BW_TRY(bwi_singular_create(context, &kept));
  for (int32_t i = 0; i < given->count; i++) {
    const bw_singular_place *place = &given->place[i];
    bool inside = true;
    BW_TRY(bw_check_cancel(context));
    for (int32_t p = place->first; p < place->first + place->count && inside; p++)
      inside = is_in_cut(model, given->point + 3 * (int64_t)p, near);
    if (!inside)
      BW_TRY(bwi_singular_add(context, kept, place, place->count,
                              given->point + 3 * (int64_t)place->first,
                              given->inward + 3 * (int64_t)place->first));
  }
  bw_release(*places);
  *places = kept;
  kept = NULL;
done:
  bw_release(kept);
  return status;
}
