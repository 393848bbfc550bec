/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The plan of the work: the supernodal tree, or the part of it that has to be done again, is cut
 * into subtrees (tasks), each for one thread, and a top, whose fronts are large enough to be cut
 * into tiles. The cut depends on the tree and on sizes alone, never on the number of threads, and
 * no sum depends on the cut. */
#include <stdlib.h>

#include "linear/internal.h"

/* A subtree becomes a task when it holds no more than this fraction of the work. */
enum { MIN_TASKS = 24 };

double bwi_front_flops(const bwi_symbolic *symbolic, int32_t s) {
  double n = bwi_pivots(symbolic, s), m = symbolic->rows[s];
  return n * m * m - n * n * m + n * n * n / 3;
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

void bwi_plan_clear(bwi_plan *plan) {
  bw_free(plan->task);
  bw_free(plan->top);
  bw_free(plan->task_of);
  *plan = (bwi_plan){0};
}

bw_status bwi_plan_create(bw_context *context, const bwi_symbolic *symbolic, const uint8_t *wanted,
                          const uint8_t *keep, bwi_plan *plan) {
  bw_status status = BW_OK;
  const bwi_order *order = symbolic->order;
  int32_t supers = order->super_count;
  *plan = (bwi_plan){0};
  double *below = BW_NEW0(context, double, supers);      /* work of the subtree */
  int32_t *lowest = BW_NEW(context, int32_t, supers);    /* its first wanted supernode */
  int64_t *children = BW_NEW0(context, int64_t, supers); /* numbers of children on the stack */
  uint8_t *in_task = BW_NEW0(context, uint8_t, supers);
  BW_TRY_MEMORY(below && lowest && children && in_task);
  for (int32_t s = 0; s < supers; s++)
    lowest[s] = s;
  for (int32_t s = 0; s < supers; s++) {
    if (wanted && !wanted[s])
      continue;
    below[s] += bwi_front_flops(symbolic, s);
    int32_t parent = order->parent[s];
    if (parent >= 0) {
      below[parent] += below[s];
      if (lowest[s] < lowest[parent])
        lowest[parent] = lowest[s];
    } else
      plan->flops += below[s];
  }
  double limit = plan->flops / MIN_TASKS;
  for (int32_t s = 0; s < supers; s++) {
    if (wanted && !wanted[s])
      continue;
    int32_t parent = order->parent[s];
    in_task[s] = below[s] <= limit;
    if (in_task[s] && (parent < 0 || below[parent] > limit))
      plan->task_count++;
    plan->top_count += !in_task[s];
  }
  plan->task = BW_NEW0(context, bwi_task, plan->task_count);
  plan->top = BW_NEW(context, int32_t, plan->top_count);
  plan->task_of = BW_NEW(context, int32_t, supers);
  BW_TRY_MEMORY(plan->task && plan->top && plan->task_of);
  int32_t tasks = 0, tops = 0;
  stack_count stack = {0, 0}, top_stack = {0, 0};
  for (int32_t s = 0; s < supers; s++) {
    plan->task_of[s] = -1;
    if (wanted && !wanted[s])
      continue;
    int32_t parent = order->parent[s];
    bool kept = keep && keep[s];
    int64_t update = bwi_update_size(symbolic->rows[s] - bwi_pivots(symbolic, s));
    bool root = in_task[s] && (parent < 0 || !in_task[parent]);
    /* kept ones and those of tasks' roots have places of their own */
    int64_t stacked = root || kept ? 0 : update;
    if (in_task[s]) {
      count_stack(&stack, children[s], stacked);
      if (root) {
        plan->task[tasks++] = (bwi_task){lowest[s], s, below[s], stack.peak, plan->own};
        plan->own += kept ? 0 : update;
        stack = (stack_count){0, 0};
      }
    } else {
      plan->top[tops++] = s;
      count_stack(&top_stack, children[s], stacked);
    }
    if (parent >= 0)
      children[parent] += stacked;
  }
  plan->top_stack = top_stack.peak;
  qsort(plan->task, (size_t)tasks, sizeof *plan->task, by_flops);
  for (int32_t t = 0; t < tasks; t++)
    plan->task_of[plan->task[t].root] = t;
done:
  bw_free(below);
  bw_free(lowest);
  bw_free(children);
  bw_free(in_task);
  return status;
}
