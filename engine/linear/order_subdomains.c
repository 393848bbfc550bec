/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elimination orders for edits subdomain by subdomain.
 *
 * An edit does the path from its subdomain to the root again. Nested dissection that knows nothing
 * of subdomains puts the largest separators, those across the thick parts, at the top, where every
 * edit passes. Here the tree of subdomains is bisected along its interfaces, so that the thick
 * parts become subtrees like all others and the top holds interfaces only.
 *
 * Interfaces everywhere would make the whole factor several times costlier: a chunky subdomain
 * between large interfaces has fronts as long as those. So subdomains are first put together into
 * groups across their largest interfaces; inside a group METIS rules. How far to go is decided by
 * trying: candidates with fewer and fewer groups are analysed, and so is METIS alone, several times
 * over: in thick bodies, where separators across the trunk are large wherever they lie, those that
 * happen to be small and out of the way of most edits matter more than interfaces at the top.
 * The order with the lowest predicted cost is taken. The prediction is what sessions then measure:
 * which supernodes an edit touches is known exactly. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/cost.h"
#include "linear/order.h"

/* More subdomains than this are ordered as if there were none: what is counted here grows with
 * their square. */
enum { MAX_SUBDOMAINS = 512 };

/* Of more subdomains than this nearly every second one is joined to another at least: interfaces of
 * all make the factor several times costlier. */
enum { FEW_SUBDOMAINS = 16 };

/* How often METIS is tried for the body as a whole. */
enum { TRIALS = 3 };

/* ---- what subdomains share ------------------------------------------------------------------- */

static void membership_clear(bwi_membership *of) {
  bw_free(of->start);
  bw_free(of->group);
  *of = (bwi_membership){0};
}

/* `element`: elements sorted by subdomain. */
static bw_status membership_of_subdomains(bw_context *context, const bwi_adjacency *near,
                                          const bw_mesh *mesh, const int32_t *element,
                                          const int32_t *element_subdomain, bwi_membership *of) {
  int npe = mesh->nodes_per_element;
  size_t size = (size_t)near->size;
  int32_t *seen = BW_NEW(context, int32_t, size);
  of->start = BW_NEW0(context, int32_t, size + 2);
  if (!seen || !of->start) {
    bw_free(seen);
    return BW_MEMORY;
  }
  for (int fill = 0; fill < 2; fill++) {
    memset(seen, 0xff, size * sizeof(int32_t));
    for (int64_t k = 0; k < mesh->element_count; k++)
      for (int a = 0; a < npe; a++) {
        int32_t d = element_subdomain[element[k]];
        int32_t i = near->compact[mesh->element[(int64_t)element[k] * npe + a]];
        if (i < 0 || seen[i] == d)
          continue;
        seen[i] = d;
        if (fill)
          of->group[of->start[i + 1]++] = d;
        else
          of->start[i + 2]++;
      }
    if (fill)
      break;
    for (size_t i = 0; i < size; i++)
      of->start[i + 2] += of->start[i + 1];
    of->group = BW_NEW(context, int32_t, of->start[size + 1]);
    if (!of->group) {
      bw_free(seen);
      return BW_MEMORY;
    }
  }
  bw_free(seen);
  return BW_OK;
}

static bw_status sort_elements(bw_context *context, const bw_mesh *mesh, int32_t subdomain_count,
                               const int32_t *element_subdomain, int32_t *element) {
  int32_t *first = BW_NEW0(context, int32_t, subdomain_count + 1);
  if (!first)
    return BW_MEMORY;
  for (int64_t e = 0; e < mesh->element_count; e++)
    first[element_subdomain[e] + 1]++;
  for (int32_t d = 0; d < subdomain_count; d++)
    first[d + 1] += first[d];
  for (int32_t e = 0; e < mesh->element_count; e++)
    element[first[element_subdomain[e]]++] = e;
  bw_free(first);
  return BW_OK;
}

/* ---- groups -------------------------------------------------------------------------------- */

typedef struct grouping {
  int32_t subdomains, groups;
  int32_t *group_of; /* subdomains: named by its lowest subdomain */
  int32_t *shared;   /* subdomains x subdomains, between groups by their names */
} grouping;

/* Join groups across their largest interfaces until `wanted` are left, or no two share a node. */
static void join(grouping *g, int32_t wanted) {
  size_t n = (size_t)g->subdomains;
  while (g->groups > wanted) {
    int32_t max = 0;
    size_t low = 0, high = 0;
    for (size_t a = 0; a < n; a++)
      for (size_t b = a + 1; b < n; b++)
        if (g->shared[a * n + b] > max) {
          max = g->shared[a * n + b];
          low = a;
          high = b;
        }
    if (max == 0)
      return;
    for (size_t a = 0; a < n; a++) {
      g->shared[low * n + a] += g->shared[high * n + a];
      g->shared[a * n + low] += g->shared[a * n + high];
      g->shared[high * n + a] = g->shared[a * n + high] = 0;
      if (g->group_of[a] == (int32_t)high)
        g->group_of[a] = (int32_t)low;
    }
    g->shared[low * n + low] = 0;
    g->groups--;
  }
}

/* The same membership with groups in the place of subdomains, numbered 0 to groups - 1. */
static bw_status membership_of_groups(bw_context *context, const bwi_membership *subdomains,
                                      int32_t size, const grouping *g, bwi_membership *of) {
  int32_t *number = BW_NEW(context, int32_t, g->subdomains), next = 0, fill = 0;
  of->start = BW_NEW0(context, int32_t, size + 1);
  of->group = BW_NEW(context, int32_t, subdomains->start[size]);
  if (!number || !of->start || !of->group) {
    bw_free(number);
    return BW_MEMORY;
  }
  for (int32_t d = 0; d < g->subdomains; d++)
    number[d] = g->group_of[d] == d ? next++ : -1;
  for (int32_t i = 0; i < size; i++) {
    for (int32_t k = subdomains->start[i]; k < subdomains->start[i + 1]; k++) {
      int32_t group = number[g->group_of[subdomains->group[k]]];
      bool there = false;
      for (int32_t l = of->start[i]; l < fill; l++)
        there |= of->group[l] == group;
      if (!there)
        of->group[fill++] = group;
    }
    of->start[i + 1] = fill;
  }
  bw_free(number);
  return BW_OK;
}

/* ---- choosing ------------------------------------------------------------------------------ */

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

/* The work of each edit: of the subdomains that it touches. Returns how many touch any. */
static int32_t work_of_edits(const bwi_elimination_reach *reach, const bw_edits *edits,
                             uint8_t *touched, double *flops) {
  int32_t subdomains = reach->subdomain_count, count = 0;
  for (int32_t e = 0; e < (edits ? edits->count : subdomains); e++) {
    bool any = false;
    for (int32_t d = 0; d < subdomains; d++) {
      touched[d] = !edits && d == e;
      for (int32_t k = edits ? edits->start[d] : 0; k < (edits ? edits->start[d + 1] : 0); k++)
        touched[d] |= edits->edit[k] == e;
      any |= touched[d] != 0;
    }
    if (any)
      flops[count++] = bwi_elimination_reach_flops(reach, touched);
  }
  return count;
}

/* Predicted seconds of an edit and a solve: the work of the median edit, a quarter of the mean
 * (large subdomains are edited too), a fiftieth of the whole factor (made once per session), and L
 * read twice. */
static bw_status predict(bw_context *context, bwi_order *order, const bw_mesh *mesh,
                         int32_t subdomain_count, const int32_t *element_subdomain,
                         const bw_edits *edits, double *cost) {
  bw_status status = BW_OK;
  bwi_symbolic *symbolic = NULL;
  bwi_elimination_reach *reach = NULL;
  int32_t *unknown = BW_NEW(context, int32_t, 3 * (size_t)order->node_count);
  uint8_t *touched = BW_NEW(context, uint8_t, subdomain_count);
  double *flops = BW_NEW(context, double, edits ? edits->count : subdomain_count), mean = 0;
  BW_TRY_MEMORY(unknown && touched && flops);
  for (int64_t i = 0; i < order->node_count; i++)
    for (int c = 0; c < 3; c++)
      unknown[3 * i + c] = order->position[i] >= 0 ? 0 : -1;
  BW_TRY(bwi_symbolic_create(context, order, 3, unknown, &symbolic));
  BW_TRY(bwi_elimination_reach_create(context, symbolic, mesh, subdomain_count, element_subdomain,
                                      &reach));
  int32_t count = work_of_edits(reach, edits, touched, flops);
  for (int32_t e = 0; e < count; e++)
    mean += flops[e] / count;
  qsort(flops, (size_t)count, sizeof *flops, ascending);
  *cost = ((count ? flops[count / 2] : 0) + mean / 4 + symbolic->flops / 50) /
              BWI_COST_EDIT_FLOPS_PER_SECOND +
          16 * (double)symbolic->panel[order->super_count] / BWI_COST_BYTES_PER_SECOND;
done:
  bw_free(unknown);
  bw_free(touched);
  bw_free(flops);
  bw_release(symbolic);
  bw_release(reach);
  return status;
}

typedef struct search {
  bw_context *context;
  const bwi_adjacency *near;
  const bw_mesh *mesh;
  int32_t subdomain_count;
  const int32_t *element_subdomain;
  const bw_edits *edits;
  idx_t *permutation;
  bwi_order *best;
  double lowest;
} search;

/* Analyse the permutation and keep its order if it is the best so far. */
static bw_status consider(search *s, double *cost) {
  bw_status status = BW_OK;
  bw_context *context = s->context;
  bwi_order *order = NULL;
  BW_TRY(bw_check_cancel(context));
  BW_TRY(bwi_order_analyse(context, s->near, s->permutation, &order));
  BW_TRY(
      predict(context, order, s->mesh, s->subdomain_count, s->element_subdomain, s->edits, cost));
  if (!s->best || *cost < s->lowest) {
    bw_release(s->best);
    s->best = order;
    s->lowest = *cost;
    order = NULL;
  }
done:
  bw_release(order);
  return status;
}

/* Join subdomains into `wanted` groups and consider the order along their interfaces. */
static bw_status consider_groups(search *s, const bwi_membership *of_subdomains, int32_t wanted,
                                 double *cost) {
  bw_status status = BW_OK;
  bw_context *context = s->context;
  int32_t subdomains = s->subdomain_count;
  bwi_membership of = {0};
  grouping g = {.subdomains = subdomains, .groups = subdomains};
  g.group_of = BW_NEW(context, int32_t, subdomains);
  g.shared = BW_NEW(context, int32_t, (size_t)subdomains * (size_t)subdomains);
  BW_TRY_MEMORY(g.group_of && g.shared);
  bwi_count_shared(of_subdomains, s->near->size, subdomains, g.shared);
  for (int32_t d = 0; d < subdomains; d++)
    g.group_of[d] = d;
  join(&g, wanted);
  BW_TRY(membership_of_groups(context, of_subdomains, s->near->size, &g, &of));
  BW_TRY(bwi_order_along_interfaces(context, s->near, &of, g.groups, s->permutation));
  BW_TRY(consider(s, cost));
done:
  bw_free(g.group_of);
  bw_free(g.shared);
  membership_clear(&of);
  return status;
}

/* METIS alone. */
static bw_status search_whole(search *s) {
  bw_status status = BW_OK;
  bw_context *context = s->context;
  const bwi_adjacency *near = s->near;
  double cost;
  for (int trial = 1; trial <= TRIALS; trial++) {
    bw_progress(context, "ordering", 0.5 * (trial - 1) / TRIALS);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_dissect_trial(context, near->size, near->start, near->neighbour, trial,
                             s->permutation));
    BW_TRY(consider(s, &cost));
  }
done:
  return status;
}

/* A few numbers of groups, then those midway between the best of them and its neighbours. */
static bw_status search_groups(search *s) {
  static const double fraction[] = {0.8, 0.4, 0.25, 0.12};
  enum { FRACTIONS = sizeof fraction / sizeof *fraction };
  bw_status status = BW_OK;
  bw_context *context = s->context;
  int32_t wanted[FRACTIONS], count = 0, best = 0;
  double cost[FRACTIONS], ignored;
  bwi_membership of_subdomains = {0};
  int32_t *element = BW_NEW(context, int32_t, s->mesh->element_count);
  BW_TRY_MEMORY(element);
  BW_TRY(sort_elements(context, s->mesh, s->subdomain_count, s->element_subdomain, element));
  BW_TRY(membership_of_subdomains(context, s->near, s->mesh, element, s->element_subdomain,
                                  &of_subdomains));
  for (int k = 0; k < FRACTIONS; k++) {
    int32_t groups = (int32_t)ceil(fraction[k] * s->subdomain_count);
    groups = groups < 2 ? 2 : groups;
    if ((k == 0 && s->subdomain_count > FEW_SUBDOMAINS) ||
        (count > 0 && groups == wanted[count - 1]))
      continue;
    wanted[count] = groups;
    bw_progress(context, "ordering", 0.5 + 0.5 * k / (FRACTIONS + 2));
    BW_TRY(consider_groups(s, &of_subdomains, groups, &cost[count]));
    if (cost[count] < cost[best])
      best = count;
    count++;
  }
  if (best > 0 && wanted[best - 1] - wanted[best] > 1)
    BW_TRY(consider_groups(s, &of_subdomains, (wanted[best - 1] + wanted[best]) / 2, &ignored));
  if (best + 1 < count && wanted[best] - wanted[best + 1] > 1)
    BW_TRY(consider_groups(s, &of_subdomains, (wanted[best] + wanted[best + 1]) / 2, &ignored));
done:
  bw_free(element);
  membership_clear(&of_subdomains);
  return status;
}

bw_status bwi_order_create_subdomains(bw_context *context, const bw_block_pattern *pattern,
                                      const uint8_t *take, const bw_mesh *mesh,
                                      int32_t subdomain_count, const int32_t *element_subdomain,
                                      const bw_edits *edits, bwi_order **order) {
  bw_status status = BW_OK;
  bwi_adjacency near = {0};
  search s = {.context = context,
              .near = &near,
              .mesh = mesh,
              .subdomain_count = subdomain_count,
              .element_subdomain = element_subdomain,
              .edits = edits};
  for (int64_t e = 0; e < mesh->element_count; e++)
    if (element_subdomain[e] < 0 || element_subdomain[e] >= subdomain_count)
      return bw_fail(context, BW_INVALID,
                     "element %lld is in subdomain %d: the subdomains are 1 to %d",
                     (long long)(e + 1), element_subdomain[e] + 1, subdomain_count);
  if (subdomain_count < 2 || subdomain_count > MAX_SUBDOMAINS)
    return bwi_order_create(context, pattern, take, order);
  BW_TRY(bwi_adjacency_create(context, pattern, take, &near));
  s.permutation = BW_NEW(context, idx_t, near.size);
  BW_TRY_MEMORY(s.permutation);
  BW_TRY(search_whole(&s));
  BW_TRY(search_groups(&s));
  *order = s.best;
  s.best = NULL;
done:
  bwi_adjacency_clear(&near);
  bw_free(s.permutation);
  bw_release(s.best);
  return status;
}
