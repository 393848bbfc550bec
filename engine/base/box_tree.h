/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A tree of boxes around items in the plane or in space, and the search for the nearest item.
 *
 * The items come in an order in which neighbours lie near each other and are cut into leaves; the
 * tree is a complete binary one in heap order (children of k: 2k+1, 2k+2), its last level the
 * leaves, padded with empty boxes to a power of two. */
#ifndef BWI_BASE_BOX_TREE_H
#define BWI_BASE_BOX_TREE_H

#include "barwright/base.h"

typedef struct bwi_box_tree {
  int dimension, leaf; /* 2 or 3; items of a leaf */
  int32_t *item;       /* in order */
  int64_t count, leaves;
  double *box; /* (2 leaves - 1) x 2 dimension: min, max */
} bwi_box_tree;

/* The box of an item; min and max have `dimension` numbers. */
typedef void bwi_item_box(const void *data, int32_t item, double *min, double *max);
/* The squared distance of a point from an item. */
typedef double bwi_item_distance(void *data, int32_t item, const double *point);

/* `item`: from bw_alloc, and the tree's in any case. */
bw_status bwi_box_tree_create(bw_context *context, int dimension, int leaf, int64_t count,
                              int32_t *item, bwi_item_box *box_of, const void *data,
                              bwi_box_tree *tree);
void bwi_box_tree_clear(bwi_box_tree *tree);
size_t bwi_box_tree_bytes(const bwi_box_tree *tree);

/* The nearest item, the lowest of those at the same distance; -1 where no distance is a finite
 * number. *square: of the distance. The search ends at the distance 0. */
int32_t bwi_box_tree_nearest(const bwi_box_tree *tree, const double *point,
                             bwi_item_distance *distance, void *data, double *square);

/* Called with each item of the leaves whose boxes meet a box; another status than BW_OK ends the
 * search and is its result. The item's own box may lie apart. */
typedef bw_status bwi_item_visit(void *data, int32_t item);
bw_status bwi_box_tree_in_box(const bwi_box_tree *tree, const double *min, const double *max,
                              bwi_item_visit *visit, void *data);

#endif
