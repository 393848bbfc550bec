/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Singular places at the ends of bonds (docs/theory/singular.md): where a covered facet of one body
 * meets a free one, and the surface of the other body goes on beyond the edge, the two make up a
 * re-entrant wedge. */
#include "model/singular_bond.h"

#include <math.h>

#include "base/box_tree.h"
#include "model/internal.h"

enum { LEAF = 8 };

/* Of the edge, where the gap is not more: how far the other body is looked for, and its distance
 * from there. */
static const double beyond = 0.05, on_surface = 0.01;
static const double pi = 3.14159265358979323846;

typedef struct search {
  const bw_mesh *mesh;
  const double *normal; /* of facets */
  double facing[3];     /* of the covered facet: the other one has the opposite normal */
  bwi_box_tree tree;
} search;

static void box_of(const void *data, int32_t facet, double *min, double *max) {
  bwi_boundary_box(((const search *)data)->mesh, facet, min, max);
}

static double distance_to(void *data, int32_t facet, const double *p) {
  const search *s = data;
  double weight[3];
  if (bw_dot(s->normal + 3 * (int64_t)facet, s->facing) > BWI_FACING)
    return INFINITY;
  return bwi_boundary_nearest(s->mesh, facet, p, weight);
}

static bw_status plant(bw_context *context, search *s) {
  int32_t count = s->mesh->facet_count, *item = BW_NEW(context, int32_t, count);
  if (!item)
    return BW_MEMORY;
  for (int32_t t = 0; t < count; t++)
    item[t] = t;
  return bwi_box_tree_create(context, 3, LEAF, count, item, box_of, s, &s->tree);
}

/* The unit direction on a facet away from its side. */
static void away_from(const bwi_topology *top, int64_t side, const double *normal,
                      double direction[3]) {
  const double *a = top->point + 3 * (int64_t)bwi_side_from(top, side);
  const double *b = top->point + 3 * (int64_t)bwi_side_to(top, side);
  const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  bw_cross(normal + 3 * (side / 3), d, direction);
  double size = bw_norm(direction);
  for (int k = 0; k < 3 && size > 0; k++)
    direction[k] /= size;
}

/* Whether the other body goes on beyond the edge, in the plane of the covered facet. */
static bool goes_on(search *s, const bwi_topology *top, int64_t side, const double direction[3],
                    double gap) {
  const double *a = top->point + 3 * (int64_t)bwi_side_from(top, side);
  const double *b = top->point + 3 * (int64_t)bwi_side_to(top, side);
  double edge[3], p[3], square;
  for (int k = 0; k < 3; k++) {
    edge[k] = b[k] - a[k];
    s->facing[k] = s->normal[3 * (side / 3) + k];
  }
  double length = bw_norm(edge), reach = fmax(2 * gap, on_surface * length);
  double far = fmax(4 * gap, beyond * length);
  for (int k = 0; k < 3; k++)
    p[k] = 0.5 * (a[k] + b[k]) - far * direction[k];
  return bwi_box_tree_nearest(&s->tree, p, distance_to, s, &square) >= 0 && square <= reach * reach;
}

static bw_status add_end(bw_context *context, search *s, const bwi_sector_border *border,
                         const int64_t side[2], double gap, bwi_seams *seams) {
  const bwi_topology *top = border->top;
  int32_t covered = (int32_t)(side[0] / 3), open = (int32_t)(side[1] / 3);
  double along[3], up[3];
  bwi_seam seam = {
      .end = {bwi_side_from(top, side[0]), bwi_side_to(top, side[0])},
      .key = {border->faces->of_triangle[covered], border->faces->of_triangle[open], 0}};
  seam.angle =
      pi + bwi_opening(top->point + 3 * (int64_t)seam.end[0], top->point + 3 * (int64_t)seam.end[1],
                       s->normal + 3 * (int64_t)covered, s->normal + 3 * (int64_t)open,
                       seam.inward);
  away_from(top, side[0], s->normal, along);
  if (seam.angle - pi <= BWI_FACET_MARGIN || seam.angle >= 2 * pi - BWI_FACET_MARGIN ||
      !goes_on(s, top, side[0], along, gap))
    return BW_OK;
  /* the bisector is opposite to that of what is open: between the free facet and the other body */
  away_from(top, side[1], s->normal, up);
  double size = 0;
  for (int k = 0; k < 3; k++) {
    seam.inward[k] = along[k] - up[k];
    size += seam.inward[k] * seam.inward[k];
  }
  for (int k = 0; k < 3 && size > 0; k++)
    seam.inward[k] /= sqrt(size);
  return bwi_seams_add(context, seams, &seam);
}

bw_status bwi_bond_seams(bw_context *context, const bw_model *model,
                         const bwi_sector_border *border, bwi_seams *seams) {
  bw_status status = BW_OK;
  const bwi_topology *top = border->top;
  search s = {.mesh = model->mesh, .normal = border->normal};
  double *gap = BW_NEW(context, double, model->mesh->facet_count); /* -1: in no bond */
  BW_TRY_MEMORY(gap);
  for (int32_t t = 0; t < model->mesh->facet_count; t++)
    gap[t] = -1;
  for (int b = 0; b < model->bond_count; b++)
    for (int32_t j = 0; model->bond[b].covered && j < model->bond[b].covered->facet_count; j++)
      gap[model->bond[b].covered->facet[j]] = model->bond[b].gap;
  BW_TRY(plant(context, &s));
  for (int64_t e = 0; e < top->edges; e++) {
    int64_t side[2] = {top->side[top->start[e]], top->side[top->start[e] + 1]};
    if (top->start[e + 1] - top->start[e] != 2)
      continue;
    for (int turn = 0; turn < 2; turn++) {
      const int64_t of[2] = {side[turn], side[1 - turn]};
      if (gap[of[0] / 3] >= 0 && gap[of[1] / 3] < 0 && border->corner[of[1] / 3] == BW_CORNER_FREE)
        BW_TRY(add_end(context, &s, border, of, gap[of[0] / 3], seams));
    }
  }
done:
  bwi_box_tree_clear(&s.tree);
  bw_free(gap);
  return status;
}
