/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A curve graph as a tree of branches. The tree is that of the shortest ways from the middle of the
 * graph: an edge that no shortest way takes closes a ring, at its place farthest from the middle,
 * and is left out. */
#include <math.h>
#include <string.h>

#include "shape/curve.h"

typedef struct net {
  const bwi_curve_graph *graph;
  int32_t *start, *to; /* neighbours */
  int32_t *up;         /* on the shortest way: the point before, or -1 */
  int32_t *degree;     /* in the tree */
  uint8_t *done;
  double *length, *other;
  double *radius;
} net;

static bw_status net_create(bw_context *context, const bwi_curve_graph *graph, net *n) {
  size_t points = (size_t)graph->point_count, edges = (size_t)graph->edge_count;
  n->graph = graph;
  n->start = BW_NEW0(context, int32_t, points + 2);
  n->to = BW_NEW(context, int32_t, 2 * edges);
  n->up = BW_NEW(context, int32_t, points);
  n->degree = BW_NEW0(context, int32_t, points);
  n->done = BW_NEW(context, uint8_t, points);
  n->length = BW_NEW(context, double, points);
  n->other = BW_NEW(context, double, points);
  n->radius = BW_NEW(context, double, points);
  if (!n->start || !n->to || !n->up || !n->degree || !n->done || !n->length || !n->other ||
      !n->radius)
    return BW_MEMORY;
  for (size_t i = 0; i < 2 * edges; i++)
    n->start[graph->edge[i] + 2]++;
  for (size_t i = 0; i < points; i++)
    n->start[i + 2] += n->start[i + 1];
  for (size_t i = 0; i < 2 * edges; i++)
    n->to[n->start[graph->edge[i] + 1]++] = graph->edge[i ^ 1];
  return BW_OK;
}

static void net_clear(net *n) {
  bw_free(n->start);
  bw_free(n->to);
  bw_free(n->up);
  bw_free(n->degree);
  bw_free(n->done);
  bw_free(n->length);
  bw_free(n->other);
  bw_free(n->radius);
}

static double edge_length(const net *n, int32_t a, int32_t b) {
  return bwi_gap(n->graph->point + 4 * (size_t)a, n->graph->point + 4 * (size_t)b);
}

/* Dijkstra's shortest ways; curve graphs have some hundred points. Returns the farthest point that
 * is reached. */
static int32_t shortest_ways(net *n, int32_t from, double *length) {
  int32_t points = n->graph->point_count, last = from;
  for (int32_t i = 0; i < points; i++) {
    length[i] = HUGE_VAL;
    n->done[i] = 0;
    n->up[i] = -1;
  }
  length[from] = 0;
  for (;;) {
    int32_t next = -1;
    for (int32_t i = 0; i < points; i++)
      if (!n->done[i] && length[i] < HUGE_VAL && (next < 0 || length[i] < length[next]))
        next = i;
    if (next < 0)
      return last;
    n->done[next] = 1;
    last = next;
    for (int32_t k = n->start[next]; k < n->start[next + 1]; k++) {
      int32_t to = n->to[k];
      double way = length[next] + edge_length(n, next, to);
      if (!n->done[to] && way < length[to]) {
        length[to] = way;
        n->up[to] = next;
      }
    }
  }
}

/* A point of the component with the most points. */
static int32_t largest_component(net *n) {
  int32_t best = 0, best_size = 0, points = n->graph->point_count;
  memset(n->done, 0, (size_t)points);
  for (int32_t i = 0; i < points; i++) {
    if (n->done[i])
      continue;
    int32_t size = 0, *stack = n->up, depth = 0;
    stack[depth++] = i;
    n->done[i] = 1;
    while (depth > 0) {
      int32_t at = stack[--depth];
      size++;
      for (int32_t k = n->start[at]; k < n->start[at + 1]; k++)
        if (!n->done[n->to[k]]) {
          n->done[n->to[k]] = 1;
          stack[depth++] = n->to[k];
        }
    }
    if (size > best_size) {
      best = i;
      best_size = size;
    }
  }
  return best;
}

/* Points that no surface point was drawn into take the mean of neighbours that have a radius. */
static void fill_radii(net *n) {
  int32_t points = n->graph->point_count;
  for (int32_t i = 0; i < points; i++)
    n->radius[i] = n->graph->point[4 * (size_t)i + 3];
  for (bool missing = true; missing;) {
    missing = false;
    bool some = false;
    for (int32_t i = 0; i < points; i++) {
      n->other[i] = n->radius[i];
      if (n->radius[i] >= 0)
        continue;
      double sum = 0;
      int count = 0;
      for (int32_t k = n->start[i]; k < n->start[i + 1]; k++)
        if (n->radius[n->to[k]] >= 0) {
          sum += n->radius[n->to[k]];
          count++;
        }
      missing = missing || count == 0;
      some = some || count > 0;
      if (count)
        n->other[i] = sum / count;
    }
    memcpy(n->radius, n->other, (size_t)points * sizeof *n->radius);
    if (!some)
      break;
  }
  for (int32_t i = 0; i < points; i++)
    n->radius[i] = fmax(n->radius[i], 0);
}

/* ---- branches -------------------------------------------------------------------------------- */

static bool in_tree(const net *n, int32_t a, int32_t b) {
  return n->up[a] == b || n->up[b] == a;
}

static void put_point(const net *n, int32_t i, double at[4]) {
  memcpy(at, n->graph->point + 4 * (size_t)i, 3 * sizeof *at);
  at[3] = n->radius[i];
}

/* Rings: edges within the component that are not of the tree. */
static bw_status find_cuts(bw_context *context, net *n, bwi_curve *curve, uint8_t *cut) {
  const bwi_curve_graph *g = n->graph;
  for (int pass = 0; pass < 2; pass++) {
    int32_t count = 0;
    for (int32_t e = 0; e < g->edge_count; e++) {
      int32_t a = g->edge[2 * (size_t)e], b = g->edge[2 * (size_t)e + 1];
      if (a == b || n->length[a] == HUGE_VAL || in_tree(n, a, b))
        continue;
      if (pass == 1) {
        cut[a] = cut[b] = 1;
        for (size_t k = 0; k < 3; k++)
          curve->cut_at[3 * (size_t)count + k] =
              0.5 * (g->point[4 * (size_t)a + k] + g->point[4 * (size_t)b + k]);
      }
      count++;
    }
    curve->cut_count = count;
    if (pass == 0 && !(curve->cut_at = BW_NEW(context, double, 3 * (size_t)count)))
      return BW_MEMORY;
  }
  return BW_OK;
}

/* Walk along points of degree 2 from key point `from` over `to`; returns the key point at the end
 * and the number of points, both ends counted. */
static int32_t follow(const net *n, int32_t from, int32_t to, int32_t *count, double *at) {
  int32_t before = from, now = to;
  *count = 2;
  if (at)
    put_point(n, from, at);
  while (n->degree[now] == 2) {
    if (at)
      put_point(n, now, at + 4 * (size_t)(*count - 1));
    for (int32_t k = n->start[now]; k < n->start[now + 1]; k++)
      if (n->to[k] != before && in_tree(n, now, n->to[k])) {
        before = now;
        now = n->to[k];
        break;
      }
    (*count)++;
  }
  if (at)
    put_point(n, now, at + 4 * (size_t)(*count - 1));
  return now;
}

static bw_status make_branches(bw_context *context, net *n, const uint8_t *cut, int32_t *key_of,
                               bwi_curve *curve) {
  int32_t points = n->graph->point_count, keys = 0;
  for (int32_t i = 0; i < points; i++)
    if (n->up[i] >= 0) {
      n->degree[i]++;
      n->degree[n->up[i]]++;
    }
  for (int32_t i = 0; i < points; i++) {
    key_of[i] = -1;
    if (n->degree[i] != 0 && n->degree[i] != 2)
      key_of[i] = keys++;
  }
  curve->key = BW_NEW0(context, bwi_curve_key, keys);
  curve->branch = BW_NEW0(context, bwi_branch, keys);
  if (!curve->key || !curve->branch)
    return BW_MEMORY;
  curve->key_count = keys;
  for (int32_t i = 0; i < points; i++) {
    if (key_of[i] < 0)
      continue;
    bwi_curve_key *key = &curve->key[key_of[i]];
    put_point(n, i, key->at);
    key->degree = n->degree[i];
    key->cut = cut[i] && n->degree[i] == 1;
    for (int32_t k = n->start[i]; k < n->start[i + 1]; k++) {
      if (!in_tree(n, i, n->to[k]))
        continue;
      bwi_branch b = {{0, 0}, 0, NULL};
      int32_t end = follow(n, i, n->to[k], &b.count, NULL);
      if (key_of[end] < key_of[i])
        continue; /* made from its other end */
      b.at = BW_NEW(context, double, 4 * (size_t)b.count);
      if (!b.at)
        return BW_MEMORY;
      follow(n, i, n->to[k], &b.count, b.at);
      b.end[0] = key_of[i];
      b.end[1] = key_of[end];
      curve->branch[curve->branch_count++] = b;
    }
  }
  return BW_OK;
}

bw_status bwi_curve_create(bw_context *context, const bwi_curve_graph *graph, bwi_curve *curve) {
  bw_status status = BW_OK;
  net n = {0};
  uint8_t *cut = NULL;
  int32_t *key_of = NULL;
  int32_t points = graph->point_count;
  memset(curve, 0, sizeof *curve);
  if (points == 0)
    return BW_OK;
  BW_TRY(net_create(context, graph, &n));
  cut = BW_NEW0(context, uint8_t, points);
  key_of = BW_NEW(context, int32_t, points);
  BW_TRY_MEMORY(cut && key_of);
  fill_radii(&n);
  int32_t one = shortest_ways(&n, largest_component(&n), n.length);
  int32_t far = shortest_ways(&n, one, n.length);
  shortest_ways(&n, far, n.other);
  int32_t middle = far;
  for (int32_t i = 0; i < points; i++)
    if (fmax(n.length[i], n.other[i]) < fmax(n.length[middle], n.other[middle]))
      middle = i;
  shortest_ways(&n, middle, n.length);
  BW_TRY(find_cuts(context, &n, curve, cut));
  BW_TRY(make_branches(context, &n, cut, key_of, curve));
done:
  net_clear(&n);
  bw_free(cut);
  bw_free(key_of);
  if (status != BW_OK)
    bwi_curve_clear(curve);
  return status;
}

void bwi_curve_clear(bwi_curve *curve) {
  for (int32_t b = 0; b < curve->branch_count; b++)
    bw_free(curve->branch[b].at);
  bw_free(curve->branch);
  bw_free(curve->key);
  bw_free(curve->cut_at);
  memset(curve, 0, sizeof *curve);
}
