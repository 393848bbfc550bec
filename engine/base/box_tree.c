/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Building a tree of boxes, and searching it. */
#include "base/box_tree.h"

#include <math.h>

#define ALWAYS_INLINE static inline __attribute__((always_inline))

static void fill_boxes(bwi_box_tree *tree, bwi_item_box *box_of, const void *data) {
  int dimension = tree->dimension;
  for (int64_t leaf = 0; leaf < tree->leaves; leaf++) {
    double *box = tree->box + 2 * dimension * (tree->leaves - 1 + leaf);
    for (int k = 0; k < dimension; k++) {
      box[k] = INFINITY;
      box[dimension + k] = -INFINITY;
    }
    for (int64_t i = leaf * tree->leaf; i < (leaf + 1) * tree->leaf && i < tree->count; i++) {
      double min[3], max[3];
      box_of(data, tree->item[i], min, max);
      for (int k = 0; k < dimension; k++) {
        box[k] = fmin(box[k], min[k]);
        box[dimension + k] = fmax(box[dimension + k], max[k]);
      }
    }
  }
  for (int64_t node = tree->leaves - 1; node-- > 0;) {
    double *box = tree->box + 2 * dimension * node;
    const double *a = tree->box + 2 * dimension * (2 * node + 1), *b = a + 2 * dimension;
    for (int k = 0; k < dimension; k++) {
      box[k] = fmin(a[k], b[k]);
      box[dimension + k] = fmax(a[dimension + k], b[dimension + k]);
    }
  }
}

bw_status bwi_box_tree_create(bw_context *context, int dimension, int leaf, int64_t count,
                              int32_t *item, bwi_item_box *box_of, const void *data,
                              bwi_box_tree *tree) {
  *tree = (bwi_box_tree){
      .dimension = dimension, .leaf = leaf, .item = item, .count = count, .leaves = 1};
  while (tree->leaves * leaf < count)
    tree->leaves *= 2;
  tree->box = BW_NEW(context, double, (size_t)(2 * tree->leaves - 1) * 2 * (size_t)dimension);
  if (!tree->box) {
    bwi_box_tree_clear(tree);
    return BW_MEMORY;
  }
  fill_boxes(tree, box_of, data);
  return BW_OK;
}

void bwi_box_tree_clear(bwi_box_tree *tree) {
  bw_free(tree->item);
  bw_free(tree->box);
  *tree = (bwi_box_tree){0};
}

size_t bwi_box_tree_bytes(const bwi_box_tree *tree) {
  return (size_t)tree->count * sizeof *tree->item +
         (size_t)(2 * tree->leaves - 1) * 2 * (size_t)tree->dimension * sizeof *tree->box;
}

ALWAYS_INLINE double on_box(int dimension, const double *p, const double *box) {
  double square = 0;
  for (int k = 0; k < dimension; k++) {
    double d = fmax(fmax(box[k] - p[k], p[k] - box[dimension + k]), 0);
    square += d * d;
  }
  return square;
}

ALWAYS_INLINE int32_t nearest(const bwi_box_tree *tree, int dimension, const double *point,
                              bwi_item_distance *distance, void *data, double *square) {
  int64_t stack[80]; /* one sibling per level */
  int depth = 0;
  double best = INFINITY;
  int32_t found = -1;
  stack[depth++] = 0;
  while (depth > 0 && best > 0) {
    int64_t node = stack[--depth];
    if (on_box(dimension, point, tree->box + 2 * dimension * node) > best)
      continue;
    if (node < tree->leaves - 1) {
      int64_t near = 2 * node + 1, far = near + 1;
      if (on_box(dimension, point, tree->box + 2 * dimension * far) <
          on_box(dimension, point, tree->box + 2 * dimension * near)) {
        far = near;
        near = far + 1;
      }
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    int64_t first = (node - (tree->leaves - 1)) * tree->leaf;
    for (int64_t i = first; i < first + tree->leaf && i < tree->count; i++) {
      int32_t item = tree->item[i];
      double here = distance(data, item, point);
      if (here < best || (here == best && item < found)) {
        best = here;
        found = item;
      }
    }
  }
  *square = best;
  return found;
}

int32_t bwi_box_tree_nearest(const bwi_box_tree *tree, const double *point,
                             bwi_item_distance *distance, void *data, double *square) {
  return tree->dimension == 2 ? nearest(tree, 2, point, distance, data, square)
                              : nearest(tree, 3, point, distance, data, square);
}

static bool meets(const bwi_box_tree *tree, int64_t node, const double *min, const double *max) {
  const double *box = tree->box + 2 * tree->dimension * node;
  for (int k = 0; k < tree->dimension; k++)
    if (box[k] > max[k] || box[tree->dimension + k] < min[k])
      return false;
  return true;
}

bw_status bwi_box_tree_in_box(const bwi_box_tree *tree, const double *min, const double *max,
                              bwi_item_visit *visit, void *data) {
  bw_status status = BW_OK;
  int64_t stack[80]; /* one sibling per level */
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    int64_t node = stack[--depth];
    if (!meets(tree, node, min, max))
      continue;
    if (node < tree->leaves - 1) {
      stack[depth++] = 2 * node + 2;
      stack[depth++] = 2 * node + 1;
      continue;
    }
    int64_t first = (node - (tree->leaves - 1)) * tree->leaf;
    for (int64_t i = first; i < first + tree->leaf && i < tree->count; i++)
      BW_TRY(visit(data, tree->item[i]));
  }
done:
  return status;
}
