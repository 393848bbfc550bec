/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elimination order and supernodes, on nodes rather than unknowns: the graph is three times smaller
 * in rows and nine times in entries, and every supernode holds whole nodes.
 *
 * Invariants of a bwi_order: position[node_at[p]] == p; supernodes are postordered (every child
 * comes before its parent, a subtree is a run of consecutive numbers); the rows of a supernode
 * beyond its own columns are a subset of its parent's rows. */
#include <assert.h>
#include <limits.h>
#include <pthread.h>
#include <string.h>

#include "linear/order.h"
#include <amd.h>
#include <cholmod.h>

static void order_destroy(void *object) {
  bwi_order *order = object;
  bw_free(order->node_at);
  bw_free(order->position);
  bw_free(order->super);
  bw_free(order->parent);
  bw_free(order->row_start);
  bw_free(order->row);
  bw_free(order);
}

static size_t order_bytes(const void *object) {
  const bwi_order *o = object;
  return sizeof *o + ((size_t)o->size + (size_t)o->node_count) * sizeof(int32_t) +
         (size_t)o->super_count * 16 +
         (o->row_start ? (size_t)o->row_start[o->super_count] * sizeof(int32_t) : 0);
}

static const bw_kind order_kind = {"order", order_destroy, order_bytes};

/* METIS draws from rand(): one call at a time. */
static pthread_mutex_t metis_mutex = PTHREAD_MUTEX_INITIALIZER;

void bwi_metis_lock(void) {
  pthread_mutex_lock(&metis_mutex);
}

void bwi_metis_unlock(void) {
  pthread_mutex_unlock(&metis_mutex);
}

bw_status bwi_adjacency_create(bw_context *context, const bw_block_pattern *pattern,
                               const uint8_t *take, bwi_adjacency *out) {
  int64_t entries = 0;
  int32_t size = 0;
  *out = (bwi_adjacency){.node_count = pattern->node_count};
  for (int32_t i = 0; i < pattern->node_count; i++)
    size += !take || take[i];
  int32_t *compact = out->compact = BW_NEW(context, int32_t, pattern->node_count);
  out->node_of = BW_NEW(context, int32_t, size);
  out->start = BW_NEW0(context, idx_t, size + 2);
  if (!compact || !out->node_of || !out->start)
    return BW_MEMORY;
  for (int32_t i = 0; i < pattern->node_count; i++) {
    compact[i] = !take || take[i] ? out->size : -1;
    if (!take || take[i])
      out->node_of[out->size++] = i;
  }
  for (int32_t i = 0; i < pattern->node_count; i++)
    if (compact[i] >= 0)
      for (int64_t k = pattern->start[i]; k < pattern->start[i + 1]; k++) {
        int32_t j = pattern->column[k];
        if (j < i && compact[j] >= 0) {
          out->start[compact[i] + 2]++;
          out->start[compact[j] + 2]++;
          entries += 2;
        }
      }
  if (entries > INT_MAX)
    return bw_fail(context, BW_LIMIT,
                   "the mesh has %lld pairs of neighbouring nodes: more than the integers of the "
                   "ordering can count",
                   (long long)entries);
  out->neighbour = BW_NEW(context, idx_t, entries);
  if (!out->neighbour)
    return BW_MEMORY;
  for (int32_t i = 0; i < size; i++)
    out->start[i + 2] += out->start[i + 1];
  for (int32_t i = 0; i < pattern->node_count; i++)
    if (compact[i] >= 0)
      for (int64_t k = pattern->start[i]; k < pattern->start[i + 1]; k++) {
        int32_t j = pattern->column[k];
        if (j < i && compact[j] >= 0) {
          out->neighbour[out->start[compact[i] + 1]++] = compact[j];
          out->neighbour[out->start[compact[j] + 1]++] = compact[i];
        }
      }
  return BW_OK;
}

void bwi_adjacency_clear(bwi_adjacency *near) {
  bw_free(near->start);
  bw_free(near->neighbour);
  bw_free(near->node_of);
  bw_free(near->compact);
  *near = (bwi_adjacency){0};
}

/* How many separators a trial lets METIS choose from. */
enum { SEPARATORS = 4 };

/* More numbers than METIS was seen to take for an entry of the graph and for a node: 4 and 26. */
enum { METIS_PER_ENTRY = 5, METIS_PER_NODE = 32 };

bw_status bwi_dissect(bw_context *context, idx_t size, idx_t *start, idx_t *neighbour,
                      idx_t *permutation) {
  return bwi_dissect_trial(context, size, start, neighbour, 0, permutation);
}

bw_status bwi_minimum_degree(bw_context *context, idx_t size, idx_t *start, idx_t *neighbour,
                             idx_t *permutation) {
  if (sizeof(idx_t) != sizeof(int32_t))
    return bwi_dissect(context, size, start, neighbour, permutation);
  int code = amd_order((int32_t)size, (const int32_t *)start, (const int32_t *)neighbour,
                       (int32_t *)permutation, NULL, NULL);
  if (code == AMD_OUT_OF_MEMORY)
    return bw_fail(context, BW_MEMORY, "no memory to order %d nodes", (int)size);
  if (code != AMD_OK && code != AMD_OK_BUT_JUMBLED)
    return bw_fail(context, BW_INTERNAL, "AMD failed to order %d nodes (code %d)", (int)size, code);
  return BW_OK;
}

bw_status bwi_dissect_trial(bw_context *context, idx_t size, idx_t *start, idx_t *neighbour,
                            int trial, idx_t *permutation) {
  if (size < 8 || start[size] == 0) {
    for (idx_t i = 0; i < size; i++)
      permutation[i] = i;
    return BW_OK;
  }
  idx_t *inverse = BW_NEW(context, idx_t, size);
  if (!inverse)
    return BW_MEMORY;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_SEED] = trial > 0 ? trial : 1;
  if (trial > 0)
    options[METIS_OPTION_NSEPS] = SEPARATORS;
  options[METIS_OPTION_COMPRESS] = 0; /* nodes are compressed already */
  /* METIS_NodeND catches SIGTERM by a jump out of whatever runs, the allocator too, after which the
   * process may wait for ever. METIS_NodeNDP for one process finds the same order and catches
   * nothing. It ends the process where memory is short, so that what it takes is tried before. */
  idx_t separator[2];
  idx_t *room =
      BW_NEW(context, idx_t, METIS_PER_ENTRY * (size_t)start[size] + METIS_PER_NODE * (size_t)size);
  bw_free(room);
  if (!room) {
    bw_free(inverse);
    return BW_MEMORY;
  }
  bwi_metis_lock();
  int done =
      METIS_NodeNDP(size, start, neighbour, NULL, 1, options, permutation, inverse, separator);
  bwi_metis_unlock();
  bw_free(inverse);
  if (done != METIS_OK)
    return bw_fail(context, BW_INTERNAL, "METIS failed to order %lld nodes (code %d)",
                   (long long)size, done);
  return BW_OK;
}

/* CHOLMOD's supernodal analysis under the given order, copied into `order`. */
static bw_status analyse(bw_context *context, const bwi_adjacency *adjacency,
                         const idx_t *permutation, bwi_order *order) {
  bw_status status = BW_OK;
  int32_t size = adjacency->size;
  cholmod_common common;
  cholmod_sparse *pattern = NULL;
  cholmod_factor *factor = NULL;
  cholmod_start(&common);
  common.print = 0;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_GIVEN;
  common.postorder = 1;
  common.supernodal = CHOLMOD_SUPERNODAL;

  pattern = cholmod_allocate_sparse((size_t)size, (size_t)size,
                                    (size_t)(adjacency->start[size] / 2 + size), 0, 1, -1,
                                    CHOLMOD_PATTERN, &common);
  if (pattern) {
    int32_t *start = pattern->p, *row = pattern->i, fill = 0;
    for (int32_t j = 0; j < size; j++) {
      start[j] = fill;
      row[fill++] = j;
      for (idx_t k = adjacency->start[j]; k < adjacency->start[j + 1]; k++)
        if (adjacency->neighbour[k] > j)
          row[fill++] = adjacency->neighbour[k];
    }
    start[size] = fill;
    factor = cholmod_analyze_p(pattern, (int *)permutation, NULL, 0, &common);
  }
  if (!factor) {
    status = common.status == CHOLMOD_TOO_LARGE
                 ? bw_fail(context, BW_LIMIT, "the factor of %d nodes is too large", size)
                 : bw_fail(context, BW_MEMORY, "no memory to analyse %d nodes", size);
    goto done;
  }
  if (!factor->is_super)
    BW_TRY(bw_fail(context, BW_INTERNAL, "the analysis of %d nodes is not supernodal", size));

  int32_t supers = (int32_t)factor->nsuper;
  const int32_t *super = factor->super, *row_start = factor->pi, *row = factor->s,
                *perm = factor->Perm;
  order->super_count = supers;
  order->super = BW_NEW(context, int32_t, supers + 1);
  order->parent = BW_NEW(context, int32_t, supers);
  order->row_start = BW_NEW(context, int64_t, supers + 1);
  order->row = BW_NEW(context, int32_t, row_start[supers]);
  int32_t *super_of = BW_NEW(context, int32_t, size);
  if (!order->super || !order->parent || !order->row_start || !order->row || !super_of) {
    bw_free(super_of);
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t s = 0; s <= supers; s++) {
    order->super[s] = super[s];
    order->row_start[s] = row_start[s];
  }
  memcpy(order->row, row, (size_t)row_start[supers] * sizeof(int32_t));
  for (int32_t s = 0; s < supers; s++)
    for (int32_t p = super[s]; p < super[s + 1]; p++)
      super_of[p] = s;
  for (int32_t s = 0; s < supers; s++) {
    int32_t below = row_start[s] + super[s + 1] - super[s];
    order->parent[s] = below < row_start[s + 1] ? super_of[row[below]] : -1;
  }
  bw_free(super_of);
  for (int32_t p = 0; p < size; p++) {
    order->node_at[p] = adjacency->node_of[perm[p]];
    order->position[order->node_at[p]] = p;
  }
done:
  cholmod_free_factor(&factor, &common);
  cholmod_free_sparse(&pattern, &common);
  cholmod_finish(&common);
  return status;
}

#ifndef NDEBUG
/* The invariants at the top of this file. */
static bool is_postordered(const bwi_order *order) {
  for (int32_t p = 0; p < order->size; p++)
    if (order->position[order->node_at[p]] != p)
      return false;
  for (int32_t s = 0; s < order->super_count; s++) {
    int64_t first = order->row_start[s], columns = order->super[s + 1] - order->super[s];
    int32_t parent = order->parent[s];
    if (columns <= 0 || order->row_start[s + 1] - first < columns || (parent != -1 && parent <= s))
      return false;
    for (int64_t k = first; k < order->row_start[s + 1]; k++)
      if (k < first + columns ? order->row[k] != order->super[s] + (int32_t)(k - first)
                              : order->row[k] <= order->row[k - 1])
        return false;
    if (parent == -1 ? order->row_start[s + 1] - first > columns
                     : order->row[first + columns] >= order->super[parent + 1])
      return false;
  }
  return order->super[order->super_count] == order->size;
}
#endif

bw_status bwi_order_analyse(bw_context *context, const bwi_adjacency *near,
                            const idx_t *permutation, bwi_order **out) {
  bw_status status = BW_OK;
  bwi_order *order = BW_NEW0(context, bwi_order, 1);
  if (!order)
    return BW_MEMORY;
  bw_object_init(order, &order_kind);
  order->node_count = near->node_count;
  order->size = near->size;
  order->node_at = BW_NEW(context, int32_t, near->size);
  order->position = BW_NEW(context, int32_t, near->node_count);
  BW_TRY_MEMORY(order->node_at && order->position);
  for (int32_t i = 0; i < near->node_count; i++)
    order->position[i] = -1;
  if (near->size == 0) {
    order->super = BW_NEW0(context, int32_t, 1);
    order->parent = BW_NEW(context, int32_t, 0);
    order->row_start = BW_NEW0(context, int64_t, 1);
    order->row = BW_NEW(context, int32_t, 0);
    if (!order->super || !order->parent || !order->row_start || !order->row)
      status = BW_MEMORY;
  } else
    status = analyse(context, near, permutation, order);
  assert(status != BW_OK || is_postordered(order));
done:
  if (status == BW_OK)
    *out = order;
  else
    bw_release(order);
  return status;
}

bw_status bwi_order_create(bw_context *context, const bw_block_pattern *pattern,
                           const uint8_t *take, bwi_order **order) {
  return bwi_order_create_by(context, pattern, take, BW_ORDERING_METIS, order);
}

bw_status bwi_order_create_by(bw_context *context, const bw_block_pattern *pattern,
                              const uint8_t *take, bw_ordering ordering, bwi_order **order) {
  bw_status status = BW_OK;
  bwi_adjacency near = {0};
  idx_t *permutation = NULL;
  BW_TRY(bwi_adjacency_create(context, pattern, take, &near));
  permutation = BW_NEW(context, idx_t, near.size);
  BW_TRY_MEMORY(permutation);
  BW_TRY(bw_check_cancel(context));
  if (ordering == BW_ORDERING_AMD)
    BW_TRY(bwi_minimum_degree(context, near.size, near.start, near.neighbour, permutation));
  else
    BW_TRY(bwi_dissect(context, near.size, near.start, near.neighbour, permutation));
  BW_TRY(bw_check_cancel(context));
  BW_TRY(bwi_order_analyse(context, &near, permutation, order));
  (*order)->ordering = ordering == BW_ORDERING_AUTO ? BW_ORDERING_METIS : ordering;
done:
  bwi_adjacency_clear(&near);
  bw_free(permutation);
  return status;
}
