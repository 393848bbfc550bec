/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From supernodes of nodes to panels of unknowns, and the plan of the work: the supernodal tree is
 * cut into subtrees (tasks), each for one thread, and a top, whose fronts are large enough to be
 * cut into tiles. The cut depends on the tree alone, never on the number of threads, so that every
 * sum is taken in the same order on any machine. */
#include <stdlib.h>
#include <string.h>

#include "solve/internal.h"

/* A subtree becomes a task when it holds no more than this fraction of the work. */
enum { TASKS_AT_LEAST = 24 };

static void symbolic_destroy(void *object) {
  bwi_symbolic *symbolic = object;
  bw_release(symbolic->order);
  bw_free(symbolic->first);
  bw_free(symbolic->at);
  bw_free(symbolic->panel);
  bw_free(symbolic->rows);
  bw_free(symbolic->task);
  bw_free(symbolic->top);
  bw_free(symbolic->task_of);
  bw_free(symbolic);
}

static size_t symbolic_bytes(const void *object) {
  const bwi_symbolic *s = object;
  const bwi_order *o = s->order;
  return sizeof *s + (size_t)o->size * 4 + (size_t)o->node_count * (size_t)s->components * 4 +
         (size_t)o->super_count * 24 + (size_t)s->task_count * sizeof(bwi_task);
}

static const bw_kind symbolic_kind = {"symbolic factor", symbolic_destroy, symbolic_bytes};

bool bwi_symbolic_fits(const bwi_symbolic *symbolic, int components, const int32_t *unknown) {
  if (!symbolic || symbolic->components != components)
    return false;
  int64_t entries = (int64_t)symbolic->order->node_count * components;
  for (int64_t i = 0; i < entries; i++)
    if ((symbolic->at[i] >= 0) != (unknown[i] >= 0))
      return false;
  return true;
}

static bw_status number_unknowns(bw_context *context, bwi_symbolic *symbolic,
                                 const int32_t *unknown) {
  const bwi_order *order = symbolic->order;
  int components = symbolic->components;
  int64_t entries = (int64_t)order->node_count * components, wanted = 0;
  for (int64_t i = 0; i < entries; i++) {
    symbolic->at[i] = -1;
    wanted += unknown[i] >= 0;
  }
  int32_t next = 0;
  for (int32_t p = 0; p < order->size; p++) {
    int64_t node = order->node_at[p];
    symbolic->first[p] = next;
    for (int c = 0; c < components; c++)
      if (unknown[node * components + c] >= 0)
        symbolic->at[node * components + c] = next++;
  }
  symbolic->first[order->size] = next;
  symbolic->unknowns = next;
  if (next != wanted)
    return bw_fail(context, BW_INTERNAL, "%lld unknowns lie outside the elimination order",
                   (long long)(wanted - next));
  return BW_OK;
}

static int by_flops(const void *a, const void *b) {
  const bwi_task *x = a, *y = b;
  if (x->flops != y->flops)
    return x->flops < y->flops ? 1 : -1;
  return x->first < y->first ? -1 : x->first > y->first;
}

/* Numbers on a stack of update matrices while supernodes are worked off in postorder. */
typedef struct stack_count {
  int64_t now, peak;
} stack_count;

static void count_stack(stack_count *count, int64_t children, int64_t own) {
  int64_t high = count->now + own;
  if (high > count->peak)
    count->peak = high;
  count->now += own - children;
}

static bw_status plan(bw_context *context, bwi_symbolic *symbolic) {
  bw_status status = BW_OK;
  const bwi_order *order = symbolic->order;
  int32_t supers = order->super_count;
  double *below = BW_NEW0(context, double, supers);      /* work of the subtree */
  int32_t *lowest = BW_NEW(context, int32_t, supers);    /* its first supernode */
  int64_t *children = BW_NEW0(context, int64_t, supers); /* numbers in children's updates */
  uint8_t *in_task = BW_NEW0(context, uint8_t, supers);
  if (!below || !lowest || !children || !in_task) {
    status = BW_MEMORY;
    goto done;
  }
  for (int32_t s = 0; s < supers; s++)
    lowest[s] = s;
  for (int32_t s = 0; s < supers; s++) {
    double n = bwi_pivots(symbolic, s), m = symbolic->rows[s];
    below[s] += n * m * m - n * n * m + n * n * n / 3;
    int32_t parent = order->parent[s];
    if (parent >= 0) {
      below[parent] += below[s];
      if (lowest[s] < lowest[parent])
        lowest[parent] = lowest[s];
    } else
      symbolic->flops += below[s];
  }
  double limit = symbolic->flops / TASKS_AT_LEAST;
  for (int32_t s = 0; s < supers; s++) {
    int32_t parent = order->parent[s];
    in_task[s] = below[s] <= limit;
    if (in_task[s] && (parent < 0 || below[parent] > limit))
      symbolic->task_count++;
    symbolic->top_count += !in_task[s];
  }
  symbolic->task = BW_NEW0(context, bwi_task, symbolic->task_count);
  symbolic->top = BW_NEW(context, int32_t, symbolic->top_count);
  symbolic->task_of = BW_NEW(context, int32_t, supers);
  if (!symbolic->task || !symbolic->top || !symbolic->task_of) {
    status = BW_MEMORY;
    goto done;
  }
  int32_t tasks = 0, tops = 0;
  stack_count stack = {0, 0}, top_stack = {0, 0};
  for (int32_t s = 0; s < supers; s++) {
    int32_t parent = order->parent[s];
    int64_t update = bwi_update_size(symbolic->rows[s] - bwi_pivots(symbolic, s));
    bool root = in_task[s] && (parent < 0 || !in_task[parent]);
    symbolic->task_of[s] = -1;
    if (in_task[s]) {
      /* a task's root puts its update matrix in a block of its own */
      count_stack(&stack, children[s], root ? 0 : update);
      if (root) {
        symbolic->task[tasks++] = (bwi_task){lowest[s], s, below[s], stack.peak};
        stack = (stack_count){0, 0};
      }
    } else {
      symbolic->top[tops++] = s;
      count_stack(&top_stack, children[s], update);
    }
    if (parent >= 0 && !root)
      children[parent] += update;
  }
  symbolic->top_stack = top_stack.peak;
  qsort(symbolic->task, (size_t)tasks, sizeof *symbolic->task, by_flops);
  for (int32_t t = 0; t < tasks; t++)
    symbolic->task_of[symbolic->task[t].root] = t;
done:
  bw_free(below);
  bw_free(lowest);
  bw_free(children);
  bw_free(in_task);
  return status;
}

bw_status bwi_symbolic_create(bw_context *context, bwi_order *order, int components,
                              const int32_t *unknown, bwi_symbolic **out) {
  bw_status status = BW_OK;
  bwi_symbolic *symbolic = BW_NEW0(context, bwi_symbolic, 1);
  if (!symbolic)
    return BW_MEMORY;
  bw_object_init(symbolic, &symbolic_kind);
  symbolic->order = bw_retain(order);
  symbolic->components = components;
  symbolic->first = BW_NEW(context, int32_t, order->size + 1);
  symbolic->at = BW_NEW(context, int32_t, (int64_t)order->node_count * components);
  symbolic->panel = BW_NEW(context, int64_t, order->super_count + 1);
  symbolic->rows = BW_NEW(context, int32_t, order->super_count);
  if (!symbolic->first || !symbolic->at || !symbolic->panel || !symbolic->rows) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(number_unknowns(context, symbolic, unknown));
  symbolic->panel[0] = 0;
  for (int32_t s = 0; s < order->super_count; s++) {
    int64_t rows = 0;
    for (int64_t k = order->row_start[s]; k < order->row_start[s + 1]; k++)
      rows += symbolic->first[order->row[k] + 1] - symbolic->first[order->row[k]];
    int64_t panel = rows * bwi_pivots(symbolic, s);
    symbolic->rows[s] = (int32_t)rows;
    symbolic->panel[s + 1] = symbolic->panel[s] + panel;
    if (rows > symbolic->max_rows)
      symbolic->max_rows = rows;
    if (panel > symbolic->max_panel)
      symbolic->max_panel = panel;
  }
  BW_TRY(plan(context, symbolic));
done:
  if (status == BW_OK)
    *out = symbolic;
  else
    bw_release(symbolic);
  return status;
}
