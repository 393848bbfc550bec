/* From the graph of a contracted surface to joints and bones: a graph becomes a tree of branches,
 * which is pruned and then replaced by straight bones.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_SHAPE_CURVE_H
#define BWI_SHAPE_CURVE_H

#include "barwright/mesh.h"

/* Points are x y z and the local radius, the mean distance to the surface points that were drawn
 * into them (-1 in a graph where there are none). */
typedef struct bwi_curve_graph {
  int32_t point_count, edge_count;
  double *point; /* point_count x 4 */
  int32_t *edge; /* edge_count x 2 */
} bwi_curve_graph;

/* A junction of three or more branches, or the tip of one. */
typedef struct bwi_curve_key {
  double at[4];
  int32_t degree; /* branches that end here; 0: no longer in use */
  bool cut;       /* a tip that was made by cutting a ring open */
} bwi_curve_key;

typedef struct bwi_branch {
  int32_t end[2]; /* keys */
  int32_t count;
  double *at; /* count x 4, from end[0] to end[1]; NULL: no longer in use */
} bwi_branch;

typedef struct bwi_curve {
  int32_t key_count, branch_count;
  bwi_curve_key *key;
  bwi_branch *branch;
  int32_t cut_count;
  double *cut_at; /* cut_count x 3: where rings were cut open */
} bwi_curve;

typedef struct bwi_sketch {
  int32_t joint_count, bone_count;
  double *joint; /* joint_count x 4 */
  uint8_t *tip;  /* joint_count: 1: the end of a limb */
  int32_t *bone; /* bone_count x 2 */
} bwi_sketch;

/* The largest component as a tree: rings are cut where they are farthest from the middle. No branch
 * comes back for a graph of a single point. (curve_tree.c) */
bw_status bwi_curve_create(bw_context *context, const bwi_curve_graph *graph, bwi_curve *curve);
void bwi_curve_clear(bwi_curve *curve);

/* Leave out branches that reach no farther out of their junction than `prune` of its radii, and
 * contract those between junctions that lie in each other's ball. With `max` > 0 go on with those
 * that reach out least until no more than so many branches are left. (curve_prune.c) */
bw_status bwi_curve_prune(bw_context *context, bwi_curve *curve, double prune, int32_t max);
double bwi_branches_length(const bwi_curve *curve);

/* Straight bones that stray at most `bend` local radii from the curve; with `wanted` > 0 just so
 * many, as far as there are no more branches than that. No bone where the curve has no branch.
 * (curve_bones.c) */
bw_status bwi_curve_bones(bw_context *context, const bwi_curve *curve, double bend, int32_t wanted,
                          bwi_sketch *sketch);
void bwi_sketch_clear(bwi_sketch *sketch);

/* Tips go on to half a radius below the surface; joints that lie outside it are taken in.
 * (curve_settle.c) */
bw_status bwi_sketch_settle(bw_context *context, const bw_surface *surface, bwi_sketch *sketch);
/* For a body that contracts to a point: one bone along its longest direction. */
bw_status bwi_sketch_one_bone(bw_context *context, const bw_surface *surface, bwi_sketch *sketch);

static inline double bwi_gap(const double *a, const double *b) {
  double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return bw_norm(d);
}

#endif
