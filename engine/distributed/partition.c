/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which rank has which nodes, and in which order. Meshes come with nodes in no useful order; a rank
 * whose nodes lie together has few neighbours on others, and one whose neighbours are near each
 * other in memory multiplies faster. */
#include <metis.h>
#include <string.h>

#include "distributed/internal.h"

/* The neighbours of all nodes. */
typedef struct adjacency {
  idx_t *start, *neighbour;
} adjacency;

static bw_status neighbours(bw_context *context, const bw_block_pattern *pattern, adjacency *a) {
  int32_t nodes = pattern->node_count;
  int64_t entries = 2 * (pattern->block_count - nodes);
  a->start = BW_NEW(context, idx_t, (int64_t)nodes + 1);
  a->neighbour = BW_NEW(context, idx_t, entries);
  if (!a->start || !a->neighbour)
    return BW_MEMORY;
  idx_t next = 0;
  for (int64_t i = 0; i < nodes; i++) {
    a->start[i] = next;
    for (int64_t k = pattern->start[i]; k < pattern->start[i + 1] - 1; k++)
      a->neighbour[next++] = pattern->column[k];
    for (int64_t k = pattern->upper_start[i]; k < pattern->upper_start[i + 1]; k++)
      a->neighbour[next++] = pattern->upper_row[k];
  }
  a->start[nodes] = next;
  return BW_OK;
}

/* Places by breadth-first search, rank after rank. */
static bw_status number(bw_context *context, const adjacency *a, int32_t nodes, int ranks,
                        const idx_t *rank_of, int32_t *row_of, int32_t *start) {
  int32_t *queue = BW_NEW(context, int32_t, nodes);
  if (!queue)
    return BW_MEMORY;
  memset(start, 0, ((size_t)ranks + 1) * sizeof *start);
  for (int32_t i = 0; i < nodes; i++) {
    start[rank_of[i] + 1]++;
    row_of[i] = -1;
  }
  for (int r = 0; r < ranks; r++)
    start[r + 1] += start[r];
  for (int r = 0; r < ranks; r++) {
    int32_t next = start[r];
    for (int32_t root = 0; root < nodes && next < start[r + 1]; root++) {
      if (rank_of[root] != r || row_of[root] >= 0)
        continue;
      int32_t head = 0, tail = 0;
      queue[tail++] = root;
      row_of[root] = next++;
      while (head < tail) {
        int32_t i = queue[head++];
        for (idx_t k = a->start[i]; k < a->start[i + 1]; k++) {
          int32_t j = (int32_t)a->neighbour[k];
          if (rank_of[j] == r && row_of[j] < 0) {
            row_of[j] = next++;
            queue[tail++] = j;
          }
        }
      }
    }
  }
  bw_free(queue);
  return BW_OK;
}

bw_status bwd_partition(bw_context *context, const bw_block_pattern *pattern, int ranks,
                        int32_t *row_of, int32_t *start) {
  bw_status status = BW_OK;
  adjacency a = {0};
  idx_t nodes = pattern->node_count, one = 1, parts = ranks, cut = 0;
  idx_t *rank_of = NULL;
  if (2 * (pattern->block_count - nodes) > INT32_MAX)
    return bw_fail(
        context, BW_LIMIT,
        "the mesh has %lld pairs of neighbouring nodes; the partitioning into ranks takes "
        "at most %d",
        (long long)(pattern->block_count - nodes), INT32_MAX / 2);
  if (nodes < ranks)
    return bw_fail(context, BW_LIMIT, "the mesh has %d nodes, fewer than the %d ranks", (int)nodes,
                   ranks);
  rank_of = BW_NEW0(context, idx_t, nodes);
  if (!rank_of) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(neighbours(context, pattern, &a));
  if (ranks > 1) {
    idx_t options[METIS_NOPTIONS];
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_NUMBERING] = 0;
    options[METIS_OPTION_SEED] = 1;
    int code = METIS_PartGraphKway(&nodes, &one, a.start, a.neighbour, NULL, NULL, NULL, &parts,
                                   NULL, NULL, options, &cut, rank_of);
    if (code != METIS_OK) {
      status = bw_fail(context, code == METIS_ERROR_MEMORY ? BW_MEMORY : BW_INTERNAL,
                       "METIS failed to distribute %d nodes among %d ranks", (int)nodes, ranks);
      goto done;
    }
  }
  BW_TRY(number(context, &a, (int32_t)nodes, ranks, rank_of, row_of, start));
done:
  bw_free(rank_of);
  bw_free(a.start);
  bw_free(a.neighbour);
  return status;
}
