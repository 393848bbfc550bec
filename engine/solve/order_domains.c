/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elimination orders for edits domain by domain.
 *
 * An edit does the path from its domain to the root again. Nested dissection that knows nothing of
 * domains puts the largest separators, those across the thick parts, at the top, where every edit
 * passes. Here the tree of domains is bisected along its interfaces, so that the thick parts become
 * subtrees like all others and the top holds interfaces only.
 *
 * Interfaces everywhere would make the whole factor several times dearer: a chunky domain between
 * large interfaces has fronts as long as those. So domains are first put together into groups
 * across their largest interfaces; inside a group METIS rules. How far to go is decided by trying:
 * candidates with fewer and fewer groups, and METIS alone, are analysed, and the one with the
 * lowest predicted cost is taken. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solve/order.h"

/* More domains than this are ordered as if there were none: what is counted here grows with their
 * square. */
enum { MOST_DOMAINS = 512 };

/* ---- what domains share -------------------------------------------------------------------- */

/* The groups around each node, ascending. */
typedef struct membership {
  int32_t *start; /* size + 1 (and one to count with) */
  int32_t *group;
} membership;

static void membership_clear(membership *of) {
  bw_free(of->start);
  bw_free(of->group);
  *of = (membership){0};
}

/* `element`: elements sorted by domain. */
static bw_status membership_of_domains(bw_context *context, const bwi_adjacency *near,
                                       const bw_mesh *mesh, const int32_t *element,
                                       const int32_t *element_domain, membership *of) {
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
        int32_t d = element_domain[element[k]];
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

static bw_status sort_elements(bw_context *context, const bw_mesh *mesh, int32_t domain_count,
                               const int32_t *element_domain, int32_t *element) {
  int32_t *first = BW_NEW0(context, int32_t, domain_count + 1);
  if (!first)
    return BW_MEMORY;
  for (int64_t e = 0; e < mesh->element_count; e++)
    first[element_domain[e] + 1]++;
  for (int32_t d = 0; d < domain_count; d++)
    first[d + 1] += first[d];
  for (int32_t e = 0; e < mesh->element_count; e++)
    element[first[element_domain[e]]++] = e;
  bw_free(first);
  return BW_OK;
}

/* shared[a * count + b]: nodes that groups a and b share. */
static void count_shared(const membership *of, int32_t size, int32_t count, int32_t *shared) {
  memset(shared, 0, (size_t)count * (size_t)count * sizeof(int32_t));
  for (int32_t i = 0; i < size; i++)
    for (int32_t k = of->start[i]; k < of->start[i + 1]; k++)
      for (int32_t l = of->start[i]; l < of->start[i + 1]; l++)
        if (l != k)
          shared[(size_t)of->group[k] * (size_t)count + (size_t)of->group[l]]++;
}

/* ---- groups -------------------------------------------------------------------------------- */

typedef struct grouping {
  int32_t domains, groups;
  int32_t *group_of; /* domains: named by its lowest domain */
  int32_t *shared;   /* domains x domains, between groups by their names */
} grouping;

/* Join groups across their largest interfaces until `wanted` are left, or no two share a node. */
static void join(grouping *g, int32_t wanted) {
  size_t n = (size_t)g->domains;
  while (g->groups > wanted) {
    int32_t most = 0;
    size_t low = 0, high = 0;
    for (size_t a = 0; a < n; a++)
      for (size_t b = a + 1; b < n; b++)
        if (g->shared[a * n + b] > most) {
          most = g->shared[a * n + b];
          low = a;
          high = b;
        }
    if (most == 0)
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

/* The same membership with groups in the place of domains, numbered 0 to groups - 1. */
static bw_status membership_of_groups(bw_context *context, const membership *domains, int32_t size,
                                      const grouping *g, membership *of) {
  int32_t *number = BW_NEW(context, int32_t, g->domains), next = 0, fill = 0;
  of->start = BW_NEW0(context, int32_t, size + 1);
  of->group = BW_NEW(context, int32_t, domains->start[size]);
  if (!number || !of->start || !of->group) {
    bw_free(number);
    return BW_MEMORY;
  }
  for (int32_t d = 0; d < g->domains; d++)
    number[d] = g->group_of[d] == d ? next++ : -1;
  for (int32_t i = 0; i < size; i++) {
    for (int32_t k = domains->start[i]; k < domains->start[i + 1]; k++) {
      int32_t group = number[g->group_of[domains->group[k]]];
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

/* ---- dissection along interfaces ----------------------------------------------------------- */

typedef struct dissection {
  bw_context *context;
  const bwi_adjacency *near;
  const membership *of;
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
  if (!start || !neighbour || !permutation) {
    status = BW_MEMORY;
    goto done;
  }
  entries = 0;
  for (int32_t i = 0; i < count; i++) {
    start[i] = (idx_t)entries;
    for (idx_t k = near->start[node[i]]; k < near->start[node[i] + 1]; k++)
      if (cut->number[near->neighbour[k]] >= 0)
        neighbour[entries++] = cut->number[near->neighbour[k]];
  }
  start[count] = (idx_t)entries;
  BW_TRY(bw_check_cancel(context));
  BW_TRY(bwi_dissect(context, count, start, neighbour, NULL, permutation));
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
  if (!tree || !other || !moved) {
    status = BW_MEMORY;
    goto done;
  }
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

static bw_status along_interfaces(bw_context *context, const bwi_adjacency *near,
                                  const membership *of, int32_t groups, idx_t *permutation) {
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
  if (!group || !node || !cut.shared || !cut.side || !cut.number) {
    status = BW_MEMORY;
    goto done;
  }
  count_shared(of, near->size, groups, cut.shared);
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

/* ---- choosing ------------------------------------------------------------------------------ */

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

/* Predicted seconds of an edit and a solve: the work of the median domain, a quarter of the mean
 * (large domains are edited too), a fiftieth of the whole factor (made once per session), and L
 * read twice. Rates are those of a machine with two cores; only their ratio matters. */
static bw_status predict(bw_context *context, bwi_order *order, const bw_mesh *mesh,
                         int32_t domain_count, const int32_t *element_domain, double *cost) {
  const double operations = 40e9, bytes = 15e9;
  bw_status status = BW_OK;
  bwi_symbolic *symbolic = NULL;
  bwi_reach *reach = NULL;
  int32_t *unknown = BW_NEW(context, int32_t, 3 * (size_t)order->node_count);
  uint8_t *touched = BW_NEW0(context, uint8_t, domain_count);
  double *flops = BW_NEW(context, double, domain_count), mean = 0;
  if (!unknown || !touched || !flops) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t i = 0; i < order->node_count; i++)
    for (int c = 0; c < 3; c++)
      unknown[3 * i + c] = order->place[i] >= 0 ? 0 : -1;
  BW_TRY(bwi_symbolic_create(context, order, 3, unknown, &symbolic));
  BW_TRY(bwi_reach_create(context, symbolic, mesh, domain_count, element_domain, &reach));
  for (int32_t d = 0; d < domain_count; d++) {
    touched[d] = 1;
    flops[d] = bwi_reach_flops(reach, touched);
    mean += flops[d] / domain_count;
    touched[d] = 0;
  }
  qsort(flops, (size_t)domain_count, sizeof *flops, ascending);
  *cost = (flops[domain_count / 2] + mean / 4 + symbolic->flops / 50) / operations +
          16 * (double)symbolic->panel[order->super_count] / bytes;
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
  int32_t domain_count;
  const int32_t *element_domain;
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
  BW_TRY(predict(context, order, s->mesh, s->domain_count, s->element_domain, cost));
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

/* Join domains into `wanted` groups and consider the order along their interfaces. */
static bw_status consider_groups(search *s, const membership *of_domains, int32_t wanted,
                                 double *cost) {
  bw_status status = BW_OK;
  bw_context *context = s->context;
  int32_t domains = s->domain_count;
  membership of = {0};
  grouping g = {.domains = domains, .groups = domains};
  g.group_of = BW_NEW(context, int32_t, domains);
  g.shared = BW_NEW(context, int32_t, (size_t)domains * (size_t)domains);
  if (!g.group_of || !g.shared) {
    status = BW_MEMORY;
    goto done;
  }
  count_shared(of_domains, s->near->size, domains, g.shared);
  for (int32_t d = 0; d < domains; d++)
    g.group_of[d] = d;
  join(&g, wanted);
  BW_TRY(membership_of_groups(context, of_domains, s->near->size, &g, &of));
  BW_TRY(along_interfaces(context, s->near, &of, g.groups, s->permutation));
  BW_TRY(consider(s, cost));
done:
  bw_free(g.group_of);
  bw_free(g.shared);
  membership_clear(&of);
  return status;
}

/* A few numbers of groups, then those half-way between the best of them and its neighbours. */
static bw_status search_groups(search *s) {
  static const double share[] = {0.8, 0.6, 0.4, 0.25, 0.12};
  enum { SHARES = sizeof share / sizeof *share };
  bw_status status = BW_OK;
  bw_context *context = s->context;
  int32_t wanted[SHARES], count = 0, best = 0;
  double cost[SHARES], ignored;
  membership of_domains = {0};
  int32_t *element = BW_NEW(context, int32_t, s->mesh->element_count);
  if (!element) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(sort_elements(context, s->mesh, s->domain_count, s->element_domain, element));
  BW_TRY(membership_of_domains(context, s->near, s->mesh, element, s->element_domain, &of_domains));
  for (int k = 0; k < SHARES; k++) {
    int32_t groups = (int32_t)ceil(share[k] * s->domain_count);
    groups = groups < 2 ? 2 : groups;
    if (count > 0 && groups == wanted[count - 1])
      continue;
    wanted[count] = groups;
    bw_progress(context, "order", (k + 1) / (SHARES + 3.0));
    BW_TRY(consider_groups(s, &of_domains, groups, &cost[count]));
    if (cost[count] < cost[best])
      best = count;
    count++;
  }
  if (best > 0 && wanted[best - 1] - wanted[best] > 1)
    BW_TRY(consider_groups(s, &of_domains, (wanted[best - 1] + wanted[best]) / 2, &ignored));
  if (best + 1 < count && wanted[best] - wanted[best + 1] > 1)
    BW_TRY(consider_groups(s, &of_domains, (wanted[best] + wanted[best + 1]) / 2, &ignored));
done:
  bw_free(element);
  membership_clear(&of_domains);
  return status;
}

bw_status bwi_order_create_domains(bw_context *context, const bw_graph *graph, const uint8_t *take,
                                   const bw_mesh *mesh, int32_t domain_count,
                                   const int32_t *element_domain, bwi_order **order) {
  bw_status status = BW_OK;
  bwi_adjacency near = {0};
  search s = {.context = context,
              .near = &near,
              .mesh = mesh,
              .domain_count = domain_count,
              .element_domain = element_domain};
  for (int64_t e = 0; e < mesh->element_count; e++)
    if (element_domain[e] < 0 || element_domain[e] >= domain_count)
      return bw_fail(context, BW_INVALID, "element %lld is of domain %d, there are %d",
                     (long long)(e + 1), element_domain[e] + 1, domain_count);
  if (domain_count < 2 || domain_count > MOST_DOMAINS)
    return bwi_order_create(context, graph, take, order);
  BW_TRY(bwi_adjacency_create(context, graph, take, &near));
  s.permutation = BW_NEW(context, idx_t, near.size);
  if (!s.permutation) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bwi_dissect(context, near.size, near.start, near.neighbour, NULL, s.permutation));
  double cost;
  BW_TRY(consider(&s, &cost));
  BW_TRY(search_groups(&s));
  *order = s.best;
  s.best = NULL;
done:
  bwi_adjacency_clear(&near);
  bw_free(s.permutation);
  bw_release(s.best);
  return status;
}
