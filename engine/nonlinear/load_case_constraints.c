/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Whether what is constrained stops every group of elements from moving as a rigid body.
 *
 * A constrained component c of a node at y from the group's centre stops the rigid-body motion
 * (t, w) as far as (t + w x y) . e_c is not zero: a row [e_c, y x e_c]. The motion that is stopped
 * least is the eigenvector of the least eigenvalue of the sum of row^T row, lengths taken over the
 * group's size. Contact planes give rows [n, y x n]: that they only push is for the solution to
 * find out. */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "base/union_find.h"
#include "nonlinear/load_case.h"

typedef struct group {
  int32_t nodes, elements, first; /* first: an element of it */
  double low[3], high[3];
  double gram[6][6];
} group;

static void add_row(group *g, const double x[3], const double direction[3]) {
  double row[6], y[3], size = 0;
  for (int d = 0; d < 3; d++) {
    size = fmax(size, g->high[d] - g->low[d]);
    y[d] = x[d] - 0.5 * (g->low[d] + g->high[d]);
    row[d] = direction[d];
  }
  bw_cross(y, direction, row + 3);
  for (int d = 3; d < 6; d++)
    row[d] /= size;
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++)
      g->gram[i][j] += row[i] * row[j];
}

static bw_status fail_unconstrained(bw_context *context, const bw_grid *grid, const group *g,
                                    int groups, const double motion[6]) {
  double turn = bw_norm(motion + 3), move = bw_norm(motion);
  int32_t node = grid->element[8 * (int64_t)g->first];
  double at[3];
  bw_grid_position(grid, node, at);
  const double *d = turn > move ? motion + 3 : motion;
  double length = fmax(turn, move);
  bw_status status =
      bw_fail(context, BW_UNCONSTRAINED,
              "the solid%s can %s as a whole: constrain more of its nodes (a group of %d elements "
              "around element %d at (%g, %g, %g) m, %s (%.3g, %.3g, %.3g))",
              groups > 1 ? " is in several parts, of which one" : "",
              turn > move ? "rotate" : "move", (int)g->elements, (int)g->first + 1, at[0], at[1],
              at[2], turn > move ? "about" : "along", d[0] / length, d[1] / length, d[2] / length);
  bw_detail_number(context, "element", g->first + 1);
  bw_detail_number(context, "groups", groups);
  return status;
}

/* Groups of the nodes: group_of[node]. */
static bw_status find_groups(bw_context *context, const bw_grid *grid, int32_t *group_of,
                             group **out, int32_t *count) {
  for (int32_t n = 0; n < grid->node_count; n++)
    group_of[n] = n;
  for (int32_t e = 0; e < grid->element_count; e++) {
    const int32_t *corner = grid->element + 8 * (int64_t)e;
    for (int c = 1; c < 8; c++)
      bwi_set_join(group_of, corner[0], corner[c]);
  }
  /* roots are the lowest nodes of their groups, so they come before the others */
  *count = 0;
  for (int32_t n = 0; n < grid->node_count; n++) {
    int32_t root = group_of[n];
    group_of[n] = root == n ? (*count)++ : group_of[root];
  }
  group *g = *out = BW_NEW0(context, group, *count);
  if (!g)
    return BW_MEMORY;
  for (int32_t n = 0; n < grid->node_count; n++) {
    group *of = &g[group_of[n]];
    double x[3];
    bw_grid_position(grid, n, x);
    for (int d = 0; d < 3; d++) {
      of->low[d] = of->nodes == 0 ? x[d] : fmin(of->low[d], x[d]);
      of->high[d] = of->nodes == 0 ? x[d] : fmax(of->high[d], x[d]);
    }
    of->nodes++;
  }
  for (int32_t e = grid->element_count - 1; e >= 0; e--) {
    group *of = &g[group_of[grid->element[8 * (int64_t)e]]];
    of->elements++;
    of->first = e;
  }
  return BW_OK;
}

static void add_contact_plane(const bw_grid *grid, const bw_contact_plane *contact_plane,
                              const int32_t *group_of, group *g) {
  if (contact_plane->embedding) {
    for (int64_t p = 0; p < contact_plane->embedding->point_count; p++) {
      int32_t node = grid->element[8 * (int64_t)contact_plane->embedding->element[p]];
      add_row(&g[group_of[node]], contact_plane->rest + 3 * p, contact_plane->normal);
    }
    return;
  }
  for (int32_t n = 0; n < grid->node_count; n++) {
    double x[3];
    bw_grid_position(grid, n, x);
    add_row(&g[group_of[n]], x, contact_plane->normal);
  }
}

bw_status bwi_load_case_check_constraints(bw_context *context, const bw_load_case *it) {
  bw_status status = BW_OK;
  const bw_grid *grid = it->grid;
  group *g = NULL;
  int32_t count = 0, *group_of = BW_NEW(context, int32_t, grid->node_count);
  if (!group_of)
    return BW_MEMORY;
  BW_TRY(find_groups(context, grid, group_of, &g, &count));
  for (int32_t n = 0; n < grid->node_count; n++)
    for (int c = 0; c < 3; c++)
      if (it->constrained[3 * (int64_t)n + c]) {
        double x[3], direction[3] = {c == 0, c == 1, c == 2};
        bw_grid_position(grid, n, x);
        add_row(&g[group_of[n]], x, direction);
      }
  for (int32_t f = 0; f < it->contact_plane_count; f++)
    add_contact_plane(grid, &it->contact_plane[f], group_of, g);
  for (int32_t k = 0; k < count; k++) {
    double vector[6][6], max = 0;
    int min = 0;
    bwi_symmetric_eigen(6, 6, g[k].gram[0], vector[0], 1e-30, 30);
    for (int i = 0; i < 6; i++) {
      max = fmax(max, g[k].gram[i][i]);
      min = g[k].gram[i][i] < g[k].gram[min][min] ? i : min;
    }
    if (g[k].gram[min][min] > 1e-12 * max)
      continue;
    BW_TRY(fail_unconstrained(context, grid, &g[k], count, vector[min]));
  }
done:
  bw_free(group_of);
  bw_free(g);
  return status;
}
