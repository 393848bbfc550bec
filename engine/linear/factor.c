/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Multifrontal factorisation. Every supernode is a front: its panel (pivot columns) takes the
 * matrix entries and the update matrices of its children, front.c eliminates the pivots, and what
 * remains is its own update matrix for its parent.
 *
 * Invariants: children are added in ascending order, whoever computed them, so sums have one order,
 * and a front comes out with the same bits whichever others are done again with it. Within a task,
 * and within the top, update matrices live on a stack: those of the children of the supernode at
 * work are its uppermost blocks. A task's root puts its update matrix in a place of its own, since
 * it outlives the task's stack; so do supernodes whose update matrix is kept for later updates of
 * the factor (elimination_reach.c).
 *
 * Numbers are double or float; what computes with them is in the factor's kernels, and here are
 * only their places. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/pages.h"
#include "linear/blas.h"
#include "linear/cholmod.h"
#include "linear/internal.h"

/* What one worker needs. */
typedef struct workspace {
  int32_t *local; /* order->size: row of a position in the front at work */
  bwi_run *runs;
  double *scale;
  void *panel; /* when L is not kept */
  void *stack;
  int64_t stack_size, fill;
} workspace;

/* Memory to factor in; kept from one update of a factor to the next, since the first touch of
 * memory costs as much as the work of many fronts. */
typedef struct store {
  workspace *space; /* one for each worker */
  int workers;
  void *own; /* update matrices of tasks' roots */
  int64_t own_size;
  void **update;  /* super_count: update matrix while it waits for its parent */
  int32_t *child; /* super_count: first child, then `sibling`; -1 ends */
  int32_t *sibling;
} store;

/* What makes a factor one that can be updated in part. */
typedef struct bwi_refactor_data {
  bwi_elimination_reach *reach; /* retained */
  void *block;                  /* the update matrices kept */
  int64_t *at;                  /* super_count: where in it; those not kept have none */
  uint8_t *wanted;              /* super_count */
  store store;
} bwi_refactor_data;

typedef struct factorisation {
  bw_context *context;
  const bwi_symbolic *symbolic;
  const bwi_matrix *matrix;
  const bwi_kernels *kernels;
  double unit; /* the matrix is taken times this */
  bool signs;
  uint8_t *minus;                /* of the factor, or NULL */
  void *value;                   /* all panels, or NULL when L is not kept */
  const bwi_plan *plan;          /* of the supernodes wanted */
  const uint8_t *wanted;         /* NULL: all */
  const bwi_refactor_data *kept; /* or NULL */
  store *store;
  int64_t negative;     /* atomic */
  int32_t failed, weak; /* lowest position of such a pivot, or INT32_MAX; atomic */
} factorisation;

/* The address of number `at` of a block. */
static void *address(const factorisation *f, void *block, int64_t at) {
  return (char *)block + (size_t)at * f->kernels->size;
}

/* The address of an update matrix that is kept, or NULL. */
static void *saved_update(const factorisation *f, int32_t s) {
  return f->kept && f->kept->reach->keep[s] ? address(f, f->kept->block, f->kept->at[s]) : NULL;
}

static void lower_to(int32_t *lowest, int32_t value) {
  int32_t old = __atomic_load_n(lowest, __ATOMIC_RELAXED);
  while (value < old && !__atomic_compare_exchange_n(lowest, &old, value, false, __ATOMIC_RELAXED,
                                                     __ATOMIC_RELAXED))
    ;
}

/* ---- one front ----------------------------------------------------------------------------- */

typedef struct clearing {
  char *block;
  size_t size; /* of a number */
  int64_t rows;
  bool update; /* an update matrix, else a panel */
} clearing;

static bw_status clear_columns(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const clearing *clear = data;
  for (int64_t j = begin; j < end; j++) {
    int64_t first = clear->update ? j : 0;
    int64_t at = (clear->update ? bwi_update_column(clear->rows, j) : j * clear->rows) + first;
    memset(clear->block + (size_t)at * clear->size, 0, (size_t)(clear->rows - first) * clear->size);
  }
  return BW_OK;
}

/* Work supernode s off. `own`: where its update matrix goes, NULL: on the stack. */
static bw_status do_front(factorisation *f, int32_t s, void *own, workspace *space) {
  bw_status status = BW_OK;
  bw_context *context = f->context;
  const bwi_symbolic *symbolic = f->symbolic;
  const bwi_order *order = symbolic->order;
  int32_t rows = symbolic->rows[s], pivots = bwi_pivots(symbolic, s), outer = rows - pivots;
  int64_t numbers = bwi_update_size(outer), children = 0;

  for (int64_t k = order->row_start[s], offset = 0; k < order->row_start[s + 1]; k++) {
    int32_t p = order->row[k];
    space->local[p] = (int32_t)offset;
    offset += symbolic->first[p + 1] - symbolic->first[p];
  }
  const bwi_kernels *kernels = f->kernels;
  void *panel = f->value ? address(f, f->value, symbolic->panel[s]) : space->panel;
  void *update = own ? own : address(f, space->stack, space->fill);
  clearing clear_panel = {panel, kernels->size, rows, false};
  clearing clear_update = {update, kernels->size, outer, true};
  int64_t grain = 1 + (1 << 18) / (rows + 1);
  BW_TRY(bw_parallel(context, pivots, grain, clear_columns, &clear_panel));
  BW_TRY(bw_parallel(context, outer, grain, clear_columns, &clear_update));
  kernels->entries(symbolic, f->matrix, f->unit, s, space->local, panel, space->scale);
  for (int32_t c = f->store->child[s]; c >= 0; c = f->store->sibling[c]) {
    const void *of_child = saved_update(f, c);
    BW_TRY(kernels->child(context, symbolic, s, c, of_child ? of_child : f->store->update[c],
                          space->local, space->runs, panel, update));
    if (f->plan->task_of[c] < 0 && !saved_update(f, c))
      children += bwi_update_size(symbolic->rows[c] - bwi_pivots(symbolic, c));
  }
  bwi_front front = {.rows = rows,
                     .pivots = pivots,
                     .panel = panel,
                     .update = update,
                     .scale = space->scale,
                     .signs = f->signs,
                     .minus = f->minus ? f->minus + symbolic->first[order->super[s]] : NULL};
  status = kernels->eliminate(context, &front);
  if (status == BW_SINGULAR)
    lower_to(&f->failed, symbolic->first[order->super[s]] + front.failed);
  if (status != BW_OK)
    goto done;
  if (front.weak >= 0)
    lower_to(&f->weak, symbolic->first[order->super[s]] + front.weak);
  __atomic_add_fetch(&f->negative, front.negative, __ATOMIC_RELAXED);
  space->fill -= children;
  if (!own) {
    void *to = address(f, space->stack, space->fill);
    if (children > 0)
      memmove(to, update, (size_t)numbers * kernels->size);
    space->fill += numbers;
    f->store->update[s] = to;
  } else
    f->store->update[s] = own;
done:
  return status;
}

static bw_status reserve(const factorisation *f, int64_t wanted, void **block, int64_t *size) {
  if (wanted <= *size)
    return BW_OK;
  bw_free(*block);
  *size = 0;
  *block = (f->kept ? bw_alloc : bwi_alloc_once)(f->context, (size_t)wanted, f->kernels->size);
  if (!*block)
    return BW_MEMORY;
  *size = wanted;
  return BW_OK;
}

static bw_status do_tasks(void *data, int64_t begin, int64_t end, int worker) {
  bw_status status = BW_OK;
  factorisation *f = data;
  workspace *space = &f->store->space[worker];
  for (int64_t t = begin; t < end; t++) {
    const bwi_task *task = &f->plan->task[t];
    if (worker == 0) /* the caller's thread */
      bw_progress(f->context, "factorisation", 0);
    BW_TRY(reserve(f, task->stack, &space->stack, &space->stack_size));
    space->fill = 0;
    for (int32_t s = task->first; s <= task->root; s++) {
      if (f->wanted && !f->wanted[s])
        continue;
      if (bw_cancelled(f->context))
        return bw_check_cancel(f->context);
      void *own = saved_update(f, s);
      if (!own && s == task->root)
        own = address(f, f->store->own, task->own);
      BW_TRY(do_front(f, s, own, space));
    }
  }
done:
  return status;
}

/* ---- memory to work in --------------------------------------------------------------------- */

static void store_clear(store *fronts) {
  for (int w = 0; fronts->space && w < fronts->workers; w++) {
    bw_free(fronts->space[w].local);
    bw_free(fronts->space[w].runs);
    bw_free(fronts->space[w].scale);
    bw_free(fronts->space[w].panel);
    bw_free(fronts->space[w].stack);
  }
  bw_free(fronts->space);
  bw_free(fronts->own);
  bw_free(fronts->update);
  bw_free(fronts->child);
  bw_free(fronts->sibling);
  *fronts = (store){0};
}

static bw_status link_children(bw_context *context, const bwi_order *order, store *fronts) {
  int32_t supers = order->super_count;
  fronts->update = BW_NEW0(context, void *, supers);
  fronts->child = BW_NEW(context, int32_t, supers);
  fronts->sibling = BW_NEW(context, int32_t, supers);
  if (!fronts->update || !fronts->child || !fronts->sibling)
    return BW_MEMORY;
  for (int32_t s = 0; s < supers; s++)
    fronts->child[s] = -1;
  for (int32_t s = supers - 1; s >= 0; s--)
    if (order->parent[s] >= 0) {
      fronts->sibling[s] = fronts->child[order->parent[s]];
      fronts->child[order->parent[s]] = s;
    }
  return BW_OK;
}

/* Make the store fit for the plan and the number of threads. */
static bw_status store_prepare(factorisation *f) {
  bw_status status = BW_OK;
  bw_context *context = f->context;
  const bwi_symbolic *symbolic = f->symbolic;
  store *fronts = f->store;
  int workers = bw_threads(context);
  if (workers > fronts->workers) {
    workspace *space = bw_resize(context, fronts->space, (size_t)workers, sizeof *space);
    if (!space)
      return BW_MEMORY;
    fronts->space = space;
    for (; fronts->workers < workers; fronts->workers++)
      space[fronts->workers] = (workspace){0};
  }
  for (int w = 0; w < workers; w++) {
    workspace *space = &fronts->space[w];
    if (!space->local)
      space->local = BW_NEW(context, int32_t, symbolic->order->size);
    if (!space->runs)
      space->runs = BW_NEW(context, bwi_run, symbolic->max_rows);
    if (!space->scale)
      space->scale = BW_NEW(context, double, symbolic->max_rows);
    if (!space->panel && !f->value)
      space->panel = bw_alloc(context, (size_t)symbolic->max_panel, f->kernels->size);
    if (!space->local || !space->runs || !space->scale || (!space->panel && !f->value))
      return BW_MEMORY;
  }
  if (!fronts->sibling)
    BW_TRY(link_children(context, symbolic->order, fronts));
  BW_TRY(reserve(f, f->plan->own, &fronts->own, &fronts->own_size));
done:
  return status;
}

static bw_status factorise(factorisation *f) {
  bw_status status = BW_OK;
  bw_context *context = f->context;
  const bwi_plan *plan = f->plan;
  int threads = bw_threads(context);
  bwi_blas_enter();
  BW_TRY(bwi_blas_check_memory(context, threads));
  f->failed = f->weak = INT32_MAX;
  BW_TRY(store_prepare(f));
  BW_TRY(bw_parallel(context, plan->task_count, 1, do_tasks, f));
  for (int w = 0; !f->kept && w < f->store->workers; w++) {
    workspace *space = &f->store->space[w];
    bw_free(space->stack);
    space->stack = NULL;
    space->stack_size = 0;
  }
  workspace *space = &f->store->space[0];
  BW_TRY(reserve(f, plan->top_stack, &space->stack, &space->stack_size));
  space->fill = 0;
  for (int32_t k = 0; k < plan->top_count; k++) {
    BW_TRY(bw_check_cancel(context));
    bw_progress(context, "factorisation", (double)k / plan->top_count);
    BW_TRY(do_front(f, plan->top[k], saved_update(f, plan->top[k]), space));
  }
done:
  bwi_blas_leave();
  return status;
}

/* ---- what others call ---------------------------------------------------------------------- */

static void kept_destroy(bwi_refactor_data *kept) {
  if (!kept)
    return;
  bw_release(kept->reach);
  bw_free(kept->block);
  bw_free(kept->at);
  bw_free(kept->wanted);
  store_clear(&kept->store);
  bw_free(kept);
}

static void factor_destroy(void *object) {
  bwi_factor *factor = object;
  bw_release(factor->symbolic);
  bw_free(factor->value);
  bw_free(factor->minus);
  bwi_cholmod_destroy(factor->cholmod);
  kept_destroy(factor->kept);
  bw_free(factor);
}

double bwi_factor_peak_bytes(const bwi_symbolic *symbolic, int threads) {
  const bwi_plan *plan = &symbolic->plan;
  double stack = 0;
  for (int32_t t = 0; t < plan->task_count; t++)
    stack = fmax(stack, (double)plan->task[t].stack);
  stack = fmax(stack * threads, (double)plan->top_stack);
  return sizeof(double) *
         ((double)symbolic->panel[symbolic->order->super_count] + (double)plan->own + stack);
}

size_t bwi_factor_bytes(const bwi_factor *factor) {
  if (factor->cholmod)
    return bwi_cholmod_bytes(factor->cholmod);
  const bwi_symbolic *symbolic = factor->symbolic;
  return (size_t)symbolic->panel[symbolic->order->super_count] * factor->kernels->size;
}

int64_t bwi_factor_entries(const bwi_factor *factor) {
  const bwi_symbolic *symbolic = factor->symbolic;
  return factor->cholmod ? (int64_t)bwi_cholmod_entries(factor->cholmod)
                         : symbolic->panel[symbolic->order->super_count];
}

double bwi_factor_flops(const bwi_factor *factor) {
  return factor->cholmod ? bwi_cholmod_flops(factor->cholmod) : factor->symbolic->flops;
}

void bwi_factor_update_bytes(const bwi_factor *factor, size_t *updates, size_t *work) {
  *updates = *work = 0;
  const bwi_refactor_data *kept = factor->kept;
  if (!kept)
    return;
  int64_t numbers = kept->store.own_size;
  for (int w = 0; w < kept->store.workers; w++)
    numbers += kept->store.space[w].stack_size;
  *updates = kept->block ? (size_t)kept->reach->kept_numbers * factor->kernels->size : 0;
  *work = (size_t)numbers * factor->kernels->size;
}

static size_t factor_bytes(const void *object) {
  const bwi_factor *factor = object;
  size_t updates, work;
  bwi_factor_update_bytes(factor, &updates, &work);
  return sizeof *factor + updates + work + bwi_factor_bytes(factor);
}

static const bw_kind factor_kind = {"factor", factor_destroy, factor_bytes};

static int32_t node_of_unknown(const bwi_symbolic *symbolic, int32_t unknown) {
  int32_t low = 0, high = symbolic->order->size;
  while (high - low > 1) {
    int32_t middle = low + (high - low) / 2;
    if (symbolic->first[middle] <= unknown)
      low = middle;
    else
      high = middle;
  }
  return symbolic->order->node_at[low];
}

/* After factorise: a pivot without digits left is as bad as one that is not positive. */
static bw_status check(const factorisation *f, bw_status status, int32_t *bad_node) {
  if (status == BW_OK && f->weak < INT32_MAX)
    status = BW_SINGULAR;
  if (status == BW_SINGULAR) {
    int32_t node = node_of_unknown(f->symbolic, f->failed < f->weak ? f->failed : f->weak);
    if (bad_node)
      *bad_node = node;
    bw_fail(f->context, BW_SINGULAR, "the matrix is not positive definite at node %d", node + 1);
  }
  return status;
}

static bw_status kept_create(bw_context *context, const bwi_symbolic *symbolic,
                             bwi_elimination_reach *reach, bwi_factor *factor) {
  int32_t supers = symbolic->order->super_count;
  bwi_refactor_data *kept = factor->kept = BW_NEW0(context, bwi_refactor_data, 1);
  if (!kept)
    return BW_MEMORY;
  kept->reach = bw_retain(reach);
  factor->broken = true; /* until it has been factored */
  if (factor->cholmod) {
    kept->wanted = BW_NEW(context, uint8_t, supers);
    return kept->wanted ? BW_OK : BW_MEMORY;
  }
  kept->block = bw_alloc(context, (size_t)reach->kept_numbers, factor->kernels->size);
  kept->at = BW_NEW(context, int64_t, supers);
  kept->wanted = BW_NEW(context, uint8_t, supers);
  if (!kept->block || !kept->at || !kept->wanted)
    return BW_MEMORY;
  int64_t at = 0;
  for (int32_t s = 0; s < supers; s++) {
    kept->at[s] = at;
    if (reach->keep[s])
      at += bwi_update_size(symbolic->rows[s] - bwi_pivots(symbolic, s));
  }
  return BW_OK;
}

/* CHOLMOD's numbers, whatever was touched. */
static bw_status refactor_by_cholmod(bw_context *context, bwi_factor *factor,
                                     const bwi_matrix *matrix, int32_t *bad_node) {
  int32_t bad = -1;
  bw_progress(context, "factorisation", 0);
  bw_status status = bwi_cholmod_factorise(context, factor->cholmod, factor->symbolic, matrix,
                                           factor->kept != NULL, &bad);
  if (status == BW_SINGULAR) {
    int32_t node = node_of_unknown(factor->symbolic, bad);
    if (bad_node)
      *bad_node = node;
    bw_fail(context, BW_SINGULAR, "the matrix is not positive definite at node %d", node + 1);
  }
  return status;
}

/* What brings the largest diagonal entry near 1, to a factor of 2^16: a step so coarse that an
 * edit hardly ever makes it another. */
static double unit_of(const bwi_kernels *kernels, const bwi_matrix *matrix, int components) {
  const bw_block_pattern *pattern = matrix->pattern;
  double max = 0;
  int exponent = 0;
  if (kernels->bits == 64)
    return 1;
  for (int64_t i = 0; i < pattern->node_count; i++) {
    int64_t index = pattern->start[i + 1] - 1; /* the last of a row is its diagonal */
    for (int c = 0; c < components; c++)
      max = fmax(
          max,
          fabs(matrix->stiffness[index * components * components + (int64_t)c * (components + 1)]));
  }
  if (max > 0 && isfinite(max))
    frexp(fmax(max, 1e-280), &exponent);
  return ldexp(1, -(exponent < 0 ? exponent - 16 : exponent + 16) / 32 * 32);
}

bw_status bwi_factor_create_in(bw_context *context, bwi_symbolic *symbolic,
                               const bwi_matrix *matrix, bwi_elimination_reach *reach,
                               const bwi_kernels *kernels, bwi_factor **out, int32_t *bad_node) {
  bw_status status = BW_OK;
  store fronts = {0};
  assert(symbolic->order->node_count == matrix->pattern->node_count);
  assert(!matrix->dof_map || symbolic->components == 3);
  bwi_factor *factor = BW_NEW0(context, bwi_factor, 1);
  if (!factor)
    return BW_MEMORY;
  bw_object_init(factor, &factor_kind);
  factor->symbolic = bw_retain(symbolic);
  factor->kernels = kernels;
  factor->unit = unit_of(kernels, matrix, symbolic->components);
  if (kernels == &bwi_kernels_cholmod) {
    BW_TRY(bwi_cholmod_create(context, symbolic, matrix, &factor->cholmod));
    if (reach)
      BW_TRY(kept_create(context, symbolic, reach, factor));
    BW_TRY(refactor_by_cholmod(context, factor, matrix, bad_node));
    factor->broken = false;
    goto done;
  }
  factor->value = (reach ? bw_alloc : bwi_alloc_once)(
      context, (size_t)symbolic->panel[symbolic->order->super_count], kernels->size);
  BW_TRY_MEMORY(factor->value);
  if (reach) {
    BW_TRY(kept_create(context, symbolic, reach, factor));
    BW_TRY(bwi_factor_update(context, factor, matrix, NULL, NULL, bad_node));
  } else {
    factorisation f = {.context = context,
                       .symbolic = symbolic,
                       .matrix = matrix,
                       .kernels = kernels,
                       .unit = factor->unit,
                       .value = factor->value,
                       .plan = &symbolic->plan,
                       .store = &fronts};
    status = check(&f, factorise(&f), bad_node);
  }
done:
  store_clear(&fronts);
  if (status == BW_OK)
    *out = factor;
  else
    bw_release(factor);
  return status;
}

bw_status bwi_factor_create(bw_context *context, bwi_symbolic *symbolic, const bwi_matrix *matrix,
                            bwi_factor **factor, int32_t *bad_node) {
  return bwi_factor_create_in(context, symbolic, matrix, NULL, &bwi_kernels_double, factor,
                              bad_node);
}

bw_status bwi_factor_create_indefinite(bw_context *context, bwi_symbolic *symbolic,
                                       const bwi_matrix *matrix, bwi_factor **out, bool *trusted,
                                       int32_t *bad_node) {
  bw_status status = BW_OK;
  store fronts = {0};
  bwi_factor *factor = BW_NEW0(context, bwi_factor, 1);
  if (!factor)
    return BW_MEMORY;
  bw_object_init(factor, &factor_kind);
  factor->symbolic = bw_retain(symbolic);
  factor->kernels = &bwi_kernels_double;
  factor->unit = 1;
  factor->value = bwi_alloc_once(context, (size_t)symbolic->panel[symbolic->order->super_count],
                                 sizeof(double));
  factor->minus = BW_NEW0(context, uint8_t, symbolic->unknowns);
  BW_TRY_MEMORY(factor->value && factor->minus);
  factorisation f = {.context = context,
                     .symbolic = symbolic,
                     .matrix = matrix,
                     .kernels = factor->kernels,
                     .unit = 1,
                     .signs = true,
                     .minus = factor->minus,
                     .value = factor->value,
                     .plan = &symbolic->plan,
                     .store = &fronts};
  BW_TRY(factorise(&f));
  factor->negative = f.negative;
  *trusted = f.weak == INT32_MAX;
done:
  if (status == BW_SINGULAR) {
    *bad_node = node_of_unknown(symbolic, f.failed);
    bw_fail(context, BW_SINGULAR, "the matrix is singular at node %d", *bad_node + 1);
  }
  store_clear(&fronts);
  if (status == BW_OK)
    *out = factor;
  else
    bw_release(factor);
  return status;
}

bwi_elimination_reach *bwi_factor_reach(const bwi_factor *factor) {
  return factor->kept && !factor->cholmod ? factor->kept->reach : NULL;
}

void bwi_factor_release_work(bwi_factor *factor) {
  if (factor->kept)
    store_clear(&factor->kept->store);
}

bw_status bwi_factor_create_updated(bw_context *context, const bwi_factor *former,
                                    const bwi_matrix *matrix, const uint8_t *touched_subdomain,
                                    double *flops, bwi_factor **out, int32_t *bad_node) {
  bw_status status = BW_OK;
  const bwi_symbolic *symbolic = former->symbolic;
  size_t numbers = (size_t)symbolic->panel[symbolic->order->super_count];
  bwi_elimination_reach *reach = bwi_factor_reach(former);
  bwi_factor *factor = BW_NEW0(context, bwi_factor, 1);
  if (!factor)
    return BW_MEMORY;
  bw_object_init(factor, &factor_kind);
  factor->symbolic = bw_retain(symbolic);
  factor->kernels = former->kernels;
  factor->unit = former->unit;
  factor->value = bwi_alloc_once(context, numbers, factor->kernels->size);
  BW_TRY_MEMORY(factor->value);
  BW_TRY(kept_create(context, symbolic, reach, factor));
  memcpy(factor->value, former->value, numbers * factor->kernels->size);
  memcpy(factor->kept->block, former->kept->block,
         (size_t)reach->kept_numbers * factor->kernels->size);
  factor->broken = former->broken;
  BW_TRY(bwi_factor_update(context, factor, matrix, touched_subdomain, flops, bad_node));
done:
  if (status == BW_OK)
    *out = factor;
  else
    bw_release(factor);
  return status;
}

bw_status bwi_factor_update(bw_context *context, bwi_factor *factor, const bwi_matrix *matrix,
                            const uint8_t *touched_subdomain, double *flops, int32_t *bad_node) {
  bw_status status = BW_OK;
  const bwi_symbolic *symbolic = factor->symbolic;
  bwi_refactor_data *kept = factor->kept;
  bwi_plan plan = {0};
  factorisation f = {.context = context,
                     .symbolic = symbolic,
                     .matrix = matrix,
                     .kernels = factor->kernels,
                     .value = factor->value,
                     .plan = &plan,
                     .kept = kept};
  if (flops)
    *flops = 0;
  if (!kept)
    return bw_fail(context, BW_INTERNAL, "this factor was not created for updates");
  if (factor->broken && touched_subdomain)
    return bw_fail(context, BW_INTERNAL, "the last update of this factor failed: refactorise it");
  f.store = &kept->store;
  if (touched_subdomain) {
    if (bwi_elimination_reach_supernodes(kept->reach, touched_subdomain, kept->wanted) == 0)
      goto done;
    f.wanted = kept->wanted;
  } else if (!factor->cholmod)
    factor->unit = unit_of(factor->kernels, matrix, symbolic->components);
  f.unit = factor->unit;
  if (factor->cholmod) {
    factor->broken = true;
    BW_TRY(refactor_by_cholmod(context, factor, matrix, bad_node));
    factor->broken = false;
    if (flops)
      *flops = symbolic->flops;
    goto done;
  }
  BW_TRY(bwi_plan_create(context, symbolic, f.wanted, kept->reach->keep, &plan));
  factor->broken = true;
  BW_TRY(check(&f, factorise(&f), bad_node));
  factor->broken = false;
  if (flops)
    *flops = plan.flops;
done:
  bwi_plan_clear(&plan);
  return status;
}

bw_status bwi_count_negative(bw_context *context, bwi_symbolic *symbolic, const bwi_matrix *matrix,
                             int64_t *negative, bool *trusted) {
  store fronts = {0};
  factorisation f = {.context = context,
                     .symbolic = symbolic,
                     .matrix = matrix,
                     .kernels = &bwi_kernels_double,
                     .unit = 1,
                     .signs = true,
                     .plan = &symbolic->plan,
                     .store = &fronts};
  bw_status status = factorise(&f);
  store_clear(&fronts);
  bool singular = status == BW_SINGULAR;
  if (status != BW_OK && !singular)
    return status;
  *negative = f.negative;
  *trusted = !singular && f.weak == INT32_MAX;
  return BW_OK;
}

bw_status bwi_solve_fields(bw_context *context, const bwi_factor *factor, const bw_dof_map *dof_map,
                           int64_t count, const double *force, double *displacement) {
  return factor->kernels->solve_fields(context, factor, dof_map, count, force, displacement);
}
