/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which rank has which elements and nodes, and the rows of the nodes.
 *
 * METIS cuts the dual graph (an element and its neighbours across faces, which the mesh has), so
 * that the graph takes 20 bytes for each element; a graph of the nodes would take as many as the
 * block sparsity pattern. A node belongs to a rank of one of its elements. Rows follow the elements
 * of a rank along a space-filling curve: rows near each other belong to nodes near each other. */
#include <metis.h>
#include <string.h>

#include "distributed/internal.h"

enum { RECURSIVE_RANKS = 8 };

/* Rank 0 has the mesh and the fields of the whole body too, and so a tenth less of the rest. */
static double part_of(int rank, int ranks) {
  double first = ranks > 1 ? 0.9 / ranks : 1;
  return rank == 0 ? first : (1 - first) / (ranks - 1);
}

void bwd_partition_clear(bwd_partition *partition) {
  bw_free(partition->rank_of_element);
  bw_free(partition->owner);
  bw_free(partition->row_of);
  *partition = (bwd_partition){0};
}

/* ---- elements to ranks ----------------------------------------------------------------------- */

static bw_status cut(bw_context *context, const bw_mesh *mesh, int ranks, idx_t *rank_of) {
  bw_status status = BW_OK;
  idx_t elements = mesh->element_count, one = 1, parts = ranks, cut_faces = 0, next = 0;
  idx_t *start = NULL, *neighbour = NULL;
  real_t *target = NULL;
  if (4 * (int64_t)elements > INT32_MAX)
    return bw_fail(context, BW_LIMIT,
                   "%d elements: the partitioning into ranks takes at most %d, since it counts "
                   "their faces with 32 bits",
                   mesh->element_count, INT32_MAX / 4);
  start = BW_NEW(context, idx_t, (int64_t)elements + 1);
  neighbour = BW_NEW(context, idx_t, 4 * (int64_t)elements);
  target = BW_NEW(context, real_t, ranks);
  BW_TRY_MEMORY(start && neighbour && target);
  for (idx_t e = 0; e < elements; e++) {
    start[e] = next;
    for (int k = 0; k < 4; k++)
      if (mesh->neighbour[4 * (int64_t)e + k] >= 0)
        neighbour[next++] = mesh->neighbour[4 * (int64_t)e + k];
  }
  start[elements] = next;
  for (int r = 0; r < ranks; r++)
    target[r] = (real_t)part_of(r, ranks);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_SEED] = 1;
  /* Recursive bisection balances best for a few parts, by the manual of METIS. */
  int code = ranks <= RECURSIVE_RANKS
                 ? METIS_PartGraphRecursive(&elements, &one, start, neighbour, NULL, NULL, NULL,
                                            &parts, target, NULL, options, &cut_faces, rank_of)
                 : METIS_PartGraphKway(&elements, &one, start, neighbour, NULL, NULL, NULL, &parts,
                                       target, NULL, options, &cut_faces, rank_of);
  if (code != METIS_OK)
    status = bw_fail(context, code == METIS_ERROR_MEMORY ? BW_MEMORY : BW_INTERNAL,
                     "METIS failed to distribute %d elements among %d ranks", mesh->element_count,
                     ranks);
done:
  bw_free(start);
  bw_free(neighbour);
  bw_free(target);
  return status;
}

/* ---- nodes to ranks -------------------------------------------------------------------------- */

/* A node between ranks goes to the one of the two that lacks more nodes so far. Of more than two
 * ranks the lowest and the highest are candidates. */
static bw_status share_nodes(bw_context *context, const bw_mesh *mesh, int ranks,
                             bwd_partition *partition) {
  bw_status status = BW_OK;
  int32_t *low = partition->owner;
  int32_t *high = BW_NEW(context, int32_t, mesh->node_count);
  int32_t *count = BW_NEW0(context, int32_t, ranks);
  BW_TRY_MEMORY(high && count);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    low[i] = ranks;
    high[i] = -1;
  }
  for (int64_t e = 0; e < mesh->element_count; e++) {
    int32_t rank = partition->rank_of_element[e];
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      int32_t i = mesh->element[e * mesh->nodes_per_element + a];
      low[i] = rank < low[i] ? rank : low[i];
      high[i] = rank > high[i] ? rank : high[i];
    }
  }
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (low[i] == high[i])
      count[low[i]]++;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (low[i] != high[i]) {
      partition->owner[i] =
          count[low[i]] * part_of(high[i], ranks) <= count[high[i]] * part_of(low[i], ranks)
              ? low[i]
              : high[i];
      count[partition->owner[i]]++;
    }
  partition->start[0] = 0;
  for (int r = 0; r < ranks; r++) {
    partition->start[r + 1] = partition->start[r] + count[r];
    if (count[r] == 0) {
      status = bw_fail(context, BW_LIMIT,
                       "the mesh of %d elements leaves rank %d of %d without a node; use fewer "
                       "ranks",
                       mesh->element_count, r, ranks);
      goto done;
    }
  }
done:
  bw_free(high);
  bw_free(count);
  return status;
}

/* ---- rows ------------------------------------------------------------------------------------ */

/* The elements of a rank in turn along the curve, and what of their nodes has no row yet. */
static bw_status number_rows(bw_context *context, const bw_mesh *mesh, int ranks,
                             bwd_partition *partition) {
  bw_status status = BW_OK;
  int32_t *along = NULL;
  int32_t *next = BW_NEW(context, int32_t, ranks);
  if (!next)
    return BW_MEMORY;
  BW_TRY(bw_mesh_curve_order(context, mesh, &along));
  memcpy(next, partition->start, (size_t)ranks * sizeof *next);
  for (int32_t i = 0; i < mesh->node_count; i++)
    partition->row_of[i] = -1;
  for (int32_t k = 0; k < mesh->element_count; k++) {
    const int32_t *node = mesh->element + (int64_t)along[k] * mesh->nodes_per_element;
    int32_t rank = partition->rank_of_element[along[k]];
    for (int a = 0; a < mesh->nodes_per_element; a++)
      if (partition->owner[node[a]] == rank && partition->row_of[node[a]] < 0)
        partition->row_of[node[a]] = next[rank]++;
  }
done:
  bw_free(along);
  bw_free(next);
  return status;
}

/* ---- elements by groups of nodes ------------------------------------------------------------- */

/* The groups of an element's nodes, each once. */
static int groups_around(int width, const int32_t *node, const int32_t *group_of,
                         int32_t group[10]) {
  int count = 0;
  for (int a = 0; a < width; a++) {
    int32_t g = group_of[node[a]];
    int k = 0;
    while (k < count && group[k] != g)
      k++;
    if (k == count && g >= 0)
      group[count++] = g;
  }
  return count;
}

bw_status bwd_group_elements(bw_context *context, int32_t elements, int width,
                             const int32_t *element, const int32_t *group_of, int32_t groups,
                             int64_t **first, int32_t **list) {
  int32_t group[10];
  int64_t *start = *first = BW_NEW0(context, int64_t, (int64_t)groups + 2);
  if (!start)
    return BW_MEMORY;
  /* Counted two places behind: while the lists are written start[g + 1] moves to its end. */
  for (int32_t e = 0; e < elements; e++)
    for (int k = groups_around(width, element + (int64_t)e * width, group_of, group); k-- > 0;)
      start[group[k] + 2]++;
  for (int32_t g = 0; g < groups; g++)
    start[g + 2] += start[g + 1];
  *list = BW_NEW(context, int32_t, start[groups + 1]);
  if (!*list)
    return BW_MEMORY;
  for (int32_t e = 0; e < elements; e++)
    for (int k = groups_around(width, element + (int64_t)e * width, group_of, group); k-- > 0;)
      (*list)[start[group[k] + 1]++] = e;
  return BW_OK;
}

/* ---- all of it ------------------------------------------------------------------------------- */

bw_status bwd_partition_create(bw_context *context, const bw_mesh *mesh, int ranks, int32_t *start,
                               bwd_partition *partition) {
  bw_status status = BW_OK;
  idx_t *rank_of = NULL;
  if (mesh->element_count < ranks)
    return bw_fail(context, BW_LIMIT, "the mesh has %d elements, fewer than the %d ranks",
                   mesh->element_count, ranks);
  *partition = (bwd_partition){.start = start,
                               .rank_of_element = BW_NEW0(context, int32_t, mesh->element_count),
                               .owner = BW_NEW(context, int32_t, mesh->node_count),
                               .row_of = BW_NEW(context, int32_t, mesh->node_count)};
  BW_TRY_MEMORY(partition->rank_of_element && partition->owner && partition->row_of);
  if (ranks > 1) {
    rank_of = BW_NEW(context, idx_t, mesh->element_count);
    BW_TRY_MEMORY(rank_of);
    BW_TRY(cut(context, mesh, ranks, rank_of));
    for (int32_t e = 0; e < mesh->element_count; e++)
      partition->rank_of_element[e] = (int32_t)rank_of[e];
  }
  BW_TRY(share_nodes(context, mesh, ranks, partition));
  BW_TRY(number_rows(context, mesh, ranks, partition));
done:
  bw_free(rank_of);
  if (status != BW_OK)
    bwd_partition_clear(partition);
  return status;
}
