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

/* The displacement direction of component k at a node. */
static void direction_of(const bw_dof_map *dof_map, int32_t node, int k, double d[3]) {
  int32_t frame = dof_map->frame_of[node];
  for (int l = 0; l < 3; l++)
    d[l] = frame < 0 ? k == l : dof_map->frame[9 * (size_t)frame + (size_t)(3 * k + l)];
}

/* Constrain `count` components of a body whose first motion is `motion`; false when the rigid-body
 * modes cannot be distinguished at the candidates: every stride-th node within `reach` of the
 * centre, and of those (with `among`) only the isostatic constraints of that DOF map. */
static bool choose_constraints(const bw_dof_map *dof_map, int32_t body, int count,
                               const bw_rigid_mode *motion, double reach, int32_t stride,
                               double weakest, const bw_dof_map *among, int32_t *chosen_node,
                               int *chosen_direction) {
  const bw_mesh *mesh = dof_map->mesh;
  const double *centre = dof_map->body_centre + 3 * (size_t)body;
  double done[6][6], first = 0;
  for (int chosen = 0; chosen < count; chosen++) {
    double best = 0, best_row[6] = {0};
    for (int64_t j = dof_map->body_start[body]; j < dof_map->body_start[body + 1]; j += stride) {
      int32_t i = dof_map->body_node[j];
      const double *x = mesh->node + 3 * (size_t)i;
      double y[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]}, u[6][3];
      if (bw_dot(y, y) > reach * reach)
        continue;
      for (int m = 0; m < count; m++)
        bwi_motion_at(&motion[m], x, u[m]);
      for (int k = 0; k < 3; k++) {
        double d[3], row[6] = {0}, size = 0;
        size_t component = 3 * (size_t)i + (size_t)k;
        if (dof_map->state[component] != BW_DOF_UNKNOWN ||
            (among && among->state[component] != BW_DOF_ISOSTATIC))
          continue;
        direction_of(dof_map, i, k, d);
        for (int m = 0; m < count; m++)
          row[m] = bw_dot(d, u[m]);
        for (int pass = 0; pass < 2; pass++)
          for (int p = 0; p < chosen; p++) {
            double part = 0;
            for (int m = 0; m < count; m++)
              part += row[m] * done[p][m];
            for (int m = 0; m < count; m++)
              row[m] -= part * done[p][m];
          }
        for (int m = 0; m < count; m++)
          size += row[m] * row[m];
        if (size > best * (1 + 1e-6)) { /* ties go to the first, whatever the rounding */
          best = size;
          memcpy(best_row, row, sizeof row);
          chosen_node[chosen] = i;
          chosen_direction[chosen] = k;
        }
      }
    }
    best = sqrt(best);
    if (chosen == 0)
      first = best;
    if (!(best > weakest * first) || best == 0)
      return false;
    for (int m = 0; m < count; m++)
      done[chosen][m] = best_row[m] / best;
  }
  return true;
}

bw_status bwi_add_isostatic(bw_context *context, bw_dof_map *dof_map, int32_t body, int count,
                            const bw_rigid_mode *motion, double length,
                            const bw_dof_map *previous) {
  int32_t chosen_node[6];
  int chosen_direction[6];
  int32_t nodes = dof_map->body_start[body + 1] - dof_map->body_start[body];
  if (previous && previous->rigid_mode_start[body + 1] - previous->rigid_mode_start[body] != count)
    previous = NULL;
  if (!(previous &&
        choose_constraints(dof_map, body, count, motion, KEPT_REACH * length, 1, MIN_KEPT_STRENGTH,
                           previous, chosen_node, chosen_direction)) &&
      !choose_constraints(dof_map, body, count, motion, MAX_REACH * length, nodes / CANDIDATES + 1,
                          WEAK, NULL, chosen_node, chosen_direction) &&
      !choose_constraints(dof_map, body, count, motion, HUGE_VAL, 1, 1e-9, NULL, chosen_node,
                          chosen_direction))
    return bw_fail(
        context, BW_INTERNAL,
        "body %d has %d unconstrained rigid-body modes that its nodes cannot distinguish", body + 1,
        count);
  for (int p = 0; p < count; p++)
    dof_map->state[3 * (size_t)chosen_node[p] + (size_t)chosen_direction[p]] = BW_DOF_ISOSTATIC;
  return BW_OK;
}
