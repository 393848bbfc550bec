/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Isostatic constraints of a body with rigid-body modes.
 *
 * A body with rigid-body modes has a singular stiffness matrix. Constraining as many components as
 * there are rigid-body modes, such that no rigid-body mode vanishes at all of them, makes it
 * regular without making it stiffer: the constraints are statically determinate, so their reactions
 * are zero when the load is balanced. They are picked by pivoting: each one where the motions not
 * yet constrained move most. */
#include <math.h>
#include <string.h>

#include "model/internal.h"

/* The constraints are chosen within this many radii of gyration: the far tips of thin limbs are
 * soft and would make the matrix ill-conditioned. */
#define MAX_REACH 1.5
/* Where a constraint is this weak (relative to the first), all nodes are tried. */
#define WEAK 0.1
/* So many nodes of a body, evenly spread over their numbers, are tried before that. */
enum { CANDIDATES = 4096 };

/* Constraints of a shape before it was edited stay as long as none is weaker than this, relative to
 * the first, and all lie within KEPT_REACH radii of gyration. */
#define MIN_KEPT_STRENGTH 0.03
#define KEPT_REACH 3.0

void bwi_direction_of(const bw_dof_map *dof_map, int32_t node, int k, double d[3]) {
  int32_t frame = dof_map->frame_of[node];
  for (int l = 0; l < 3; l++)
    d[l] = frame < 0 ? k == l : dof_map->frame[9 * (size_t)frame + (size_t)(3 * k + l)];
}

/* At every stride-th node within `reach` of the centre, and of those (with `former`) only the
 * constraints of the former shape. */
static bool choose_among(bwi_isostatic_choice *c, double reach, int64_t stride, double weakest,
                         bool former) {
  double done[6][6], first = 0;
  for (int chosen = 0; chosen < c->count; chosen++) {
    double best = 0, best_row[6] = {0};
    for (int64_t at = 0; at < c->node_count; at += stride) {
      const double *x = c->dof_map->mesh->node + 3 * (size_t)c->node[at];
      double y[3] = {x[0] - c->centre[0], x[1] - c->centre[1], x[2] - c->centre[2]}, u[6][3];
      if (bw_dot(y, y) > reach * reach)
        continue;
      for (int m = 0; m < c->count; m++)
        bwi_motion_at(&c->mode[m], x, u[m]);
      for (int k = 0; k < 3; k++) {
        double d[3], row[6] = {0}, size = 0;
        if (!c->open(c->data, at, k, former))
          continue;
        bwi_direction_of(c->dof_map, c->node[at], k, d);
        for (int m = 0; m < c->count; m++)
          row[m] = bw_dot(d, u[m]);
        for (int pass = 0; pass < 2; pass++)
          for (int p = 0; p < chosen; p++) {
            double part = 0;
            for (int m = 0; m < c->count; m++)
              part += row[m] * done[p][m];
            for (int m = 0; m < c->count; m++)
              row[m] -= part * done[p][m];
          }
        for (int m = 0; m < c->count; m++)
          size += row[m] * row[m];
        if (size > best * (1 + 1e-6)) { /* ties go to the first, whatever the rounding */
          best = size;
          memcpy(best_row, row, sizeof row);
          c->at[chosen] = at;
          c->component[chosen] = k;
        }
      }
    }
    best = sqrt(best);
    if (chosen == 0)
      first = best;
    if (!(best > weakest * first) || best == 0)
      return false;
    for (int m = 0; m < c->count; m++)
      done[chosen][m] = best_row[m] / best;
  }
  return true;
}

bool bwi_choose_isostatic(bwi_isostatic_choice *c) {
  return (c->former && choose_among(c, KEPT_REACH * c->length, 1, MIN_KEPT_STRENGTH, true)) ||
         choose_among(c, MAX_REACH * c->length, c->node_count / CANDIDATES + 1, WEAK, false) ||
         choose_among(c, HUGE_VAL, 1, 1e-9, false);
}

typedef struct dof_maps {
  const bw_dof_map *own, *previous;
  int32_t first; /* of the body's nodes */
} dof_maps;

static bool is_open(const void *data, int64_t at, int k, bool former) {
  const dof_maps *d = data;
  int64_t i = 3 * (int64_t)d->own->body_node[d->first + at] + k;
  return d->own->state[i] == BW_DOF_UNKNOWN &&
         (!former || d->previous->state[i] == BW_DOF_ISOSTATIC);
}

bw_status bwi_add_isostatic(bw_context *context, bw_dof_map *dof_map, int32_t body, int count,
                            const bw_rigid_mode *motion, double length,
                            const bw_dof_map *previous) {
  int32_t first = dof_map->body_start[body];
  const dof_maps data = {dof_map, previous, first};
  bwi_isostatic_choice choice = {.dof_map = dof_map,
                                 .count = count,
                                 .mode = motion,
                                 .centre = dof_map->body_centre + 3 * (size_t)body,
                                 .length = length,
                                 .node_count = dof_map->body_start[body + 1] - first,
                                 .node = dof_map->body_node + first,
                                 .open = is_open,
                                 .data = &data,
                                 .former = previous && previous->rigid_mode_start[body + 1] -
                                                               previous->rigid_mode_start[body] ==
                                                           count};
  if (!bwi_choose_isostatic(&choice))
    return bw_fail(
        context, BW_INTERNAL,
        "body %d has %d unconstrained rigid-body modes that its nodes cannot distinguish", body + 1,
        count);
  for (int p = 0; p < count; p++)
    dof_map->state[3 * (size_t)choice.node[choice.at[p]] + (size_t)choice.component[p]] =
        BW_DOF_ISOSTATIC;
  return BW_OK;
}
