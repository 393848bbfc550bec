/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Nested dissection along the interfaces of groups of elements: the set of groups is bisected where
 * few nodes are shared, those go last, and so on in both halves; inside a group METIS rules. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "linear/order.h"

/* shared[a * count + b]: nodes that groups a and b share. */
void bwi_count_shared(const bwi_membership *of, int32_t size, int32_t count, int32_t *shared) {
  memset(shared, 0, (size_t)count * (size_t)count * sizeof(int32_t));
  for (int32_t i = 0; i < size; i++)
    for (int32_t k = of->start[i]; k < of->start[i + 1]; k++)
      for (int32_t l = of->start[i]; l < of->start[i + 1]; l++)
        if (l != k)
          shared[(size_t)of->group[k] * (size_t)count + (size_t)of->group[l]]++;
}

typedef struct dissection {
  bw_context *context;
  const bwi_adjacency *near;
  const bwi_membership *of;
  int32_t groups;
  int32_t *shared;    /* groups x groups */
  int8_t *side;       /* groups: 0 or 1, or -1: not in the set at work */
  idx_t *permutation; /* filled from its end */
  idx_t left;         /* places not yet filled */
  idx_t *number;      /* size: number in the subgraph at work, or -1 */
} dissection;

/* Order the nodes inside a group by METIS. */
static bw_status order_inside(dissection *cut, const int32_t *node, int32_t count) {
  bw_status status = BW_OK;
  bw_context *context = cut->context;
  const bwi_adjacency *near = cut->near;
  int64_t entries = 0;
  idx_t *neighbour = NULL, *start = BW_NEW(context, idx_t, count + 1),
        *permutation = BW_NEW(context, idx_t, count);
  for (int32_t i = 0; i < count; i++)
    cut->number[node[i]] = i;
  for (int32_t i = 0; i < count; i++)
    for (idx_t k = near->start[node[i]]; k < near->start[node[i] + 1]; k++)
      entries += cut->number[near->neighbour[k]] >= 0;
  neighbour = BW_NEW(context, idx_t, entries);
  BW_TRY_MEMORY(start && neighbour && permutation);
  entries = 0;
  for (int32_t i = 0; i < count; i++) {
    start[i] = (idx_t)entries;
    for (idx_t k = near->start[node[i]]; k < near->start[node[i] + 1]; k++)
      if (cut->number[near->neighbour[k]] >= 0)
        neighbour[entries++] = cut->number[near->neighbour[k]];
  }
  start[count] = (idx_t)entries;
  BW_TRY(bw_check_cancel(context));
  BW_TRY(bwi_dissect(context, count, start, neighbour, permutation));
  cut->left -= count;
  for (int32_t k = 0; k < count; k++)
    cut->permutation[cut->left + k] = node[permutation[k]];
done:
  for (int32_t i = 0; i < count; i++)
    cut->number[node[i]] = -1;
  bw_free(start);
  bw_free(neighbour);
  bw_free(permutation);
  return status;
}

/* Bit 0: a group of side 0 is around the node; bit 1: one of side 1. */
static int sides_of(const dissection *cut, int32_t node) {
  int seen = 0;
  for (int32_t k = cut->of->start[node]; k < cut->of->start[node + 1]; k++) {
    int side = cut->side[cut->of->group[k]];
    if (side >= 0)
      seen |= 1 << side;
  }
  return seen;
}

/* Side 1: what hangs on group `from` in the tree. */
static void take_sides(const dissection *cut, const int32_t *group, int32_t count,
                       const int32_t *tree, int32_t from) {
  for (int32_t i = 0; i < count; i++) {
    int32_t j = i;
    while (j >= 0 && j != from)
      j = tree[j];
    cut->side[group[i]] = j == from;
  }
}

/* A spanning tree of the groups that keeps the largest interfaces together (Prim): tree[i] is the
 * group that i hangs on, or -1. *part: one that hangs on nothing although others do, or -1. Returns
 * the mean interface in the tree. */
static double span(const dissection *cut, const int32_t *group, int32_t count, int32_t *tree,
                   int32_t *best, int32_t *part) {
  double sum = 0;
  *part = -1;
  for (int32_t i = 0; i < count; i++) {
    tree[i] = -1;
    best[i] = 0; /* -1 once it is in the tree */
  }
  for (int32_t round = 0; round < count; round++) {
    int32_t next = -1;
    for (int32_t i = 0; i < count; i++)
      if (best[i] >= 0 && (next < 0 || best[i] > best[next]))
        next = i;
    if (best[next] == 0 && round > 0)
      *part = next;
    sum += best[next];
    best[next] = -1;
    for (int32_t i = 0; i < count; i++) {
      int32_t shared = cut->shared[(size_t)group[next] * (size_t)cut->groups + (size_t)group[i]];
      if (best[i] >= 0 && shared > best[i]) {
        best[i] = shared;
        tree[i] = next;
      }
    }
  }
  return count > 1 ? sum / (count - 1) : 0;
}

/* Where to cut the tree: a small interface, near the middle. A path to the root passes the
 * separator, whose cost grows with its square at least, and about log2 of the groups more. */
static int32_t choose_cut(const dissection *cut, const int32_t *group, int32_t count,
                          const int32_t *tree, double mean, const int32_t *node, int32_t nodes) {
  int32_t choice = -1;
  double lowest = DBL_MAX;
  for (int32_t e = 0; e < count; e++) {
    if (tree[e] < 0)
      continue;
    double shared = 0, high = 0;
    take_sides(cut, group, count, tree, e);
    for (int32_t i = 0; i < nodes; i++)
      shared += sides_of(cut, node[i]) == 3;
    for (int32_t i = 0; i < count; i++)
      high += cut->side[group[i]];
    double low = count - high;
    double score = shared * shared + mean * mean * (low * log2(low) + high * log2(high)) / count;
    if (score < lowest) {
      lowest = score;
      choice = e;
    }
  }
  return choice;
}

/* Order the nodes whose groups are all among these. Reorders both lists. */
static bw_status dissect_groups(dissection *cut, int32_t *group, int32_t count, int32_t *node,
                                int32_t nodes) {
  bw_status status = BW_OK;
  bw_context *context = cut->context;
  if (count == 1 || nodes == 0)
    return order_inside(cut, node, nodes);
  int32_t *tree = BW_NEW(context, int32_t, count), *other = BW_NEW(context, int32_t, count),
          *moved = BW_NEW(context, int32_t, nodes);
  BW_TRY_MEMORY(tree && other && moved);
  int32_t choice, size[4] = {0, 0, 0, 0}, groups[2] = {0, 0};
  double mean = span(cut, group, count, tree, other, &choice);
  if (choice < 0)
    choice = choose_cut(cut, group, count, tree, mean, node, nodes);
  take_sides(cut, group, count, tree, choice);
  for (int32_t i = 0; i < nodes; i++)
    size[sides_of(cut, node[i])]++;
  int32_t low = size[1], high = size[2], separator = size[3];
  for (int32_t i = 0, to[4] = {0, 0, low, low + high}; i < nodes; i++)
    moved[to[sides_of(cut, node[i])]++] = node[i];
  memcpy(node, moved, (size_t)nodes * sizeof(int32_t));
  for (int side = 0, at = 0; side < 2; side++)
    for (int32_t i = 0; i < count; i++)
      if (cut->side[group[i]] == side) {
        other[at++] = group[i];
        groups[side]++;
      }
  for (int32_t i = 0; i < count; i++) {
    group[i] = other[i];
    cut->side[group[i]] = -1;
  }
  cut->left -= separator;
  for (int32_t i = 0; i < separator; i++)
    cut->permutation[cut->left + i] = node[low + high + i];
  BW_TRY(dissect_groups(cut, group + groups[0], groups[1], node + low, high));
  BW_TRY(dissect_groups(cut, group, groups[0], node, low));
done:
  bw_free(tree);
  bw_free(other);
  bw_free(moved);
  return status;
}

bw_status bwi_order_along_interfaces(bw_context *context, const bwi_adjacency *near,
                                     const bwi_membership *of, int32_t groups, idx_t *permutation) {
  bw_status status = BW_OK;
  dissection cut = {.context = context,
                    .near = near,
                    .of = of,
                    .groups = groups,
                    .permutation = permutation,
                    .left = near->size};
  int32_t *group = BW_NEW(context, int32_t, groups), *node = BW_NEW(context, int32_t, near->size);
  cut.shared = BW_NEW(context, int32_t, (size_t)groups * (size_t)groups);
  cut.side = BW_NEW(context, int8_t, groups);
  cut.number = BW_NEW(context, idx_t, near->size);
  BW_TRY_MEMORY(group && node && cut.shared && cut.side && cut.number);
  bwi_count_shared(of, near->size, groups, cut.shared);
  for (int32_t g = 0; g < groups; g++) {
    group[g] = g;
    cut.side[g] = -1;
  }
  for (int32_t i = 0; i < near->size; i++) {
    node[i] = i;
    cut.number[i] = -1;
  }
  BW_TRY(dissect_groups(&cut, group, groups, node, near->size));
done:
  bw_free(group);
  bw_free(node);
  bw_free(cut.shared);
  bw_free(cut.side);
  bw_free(cut.number);
  return status;
}
