/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How the nodes of subdomains follow the bones.
 *
 * Nodes of a type R subdomain follow its bone alone, also where a subdomain of type F begins: so
 * the posed mesh is continuous. Inside a type F subdomain the weight of each bone solves Laplace's
 * equation with one on the interface with that bone's subdomain and zero on the others (agile,
 * section 4), on linear elements: edge weights w_ij = -integral of grad N_i . grad N_j (the
 * cotangent weights). They can be negative where angles are obtuse, and then so can a solution.
 *
 * Harmonic functions vanish nowhere inside: each bone would move every node of the subdomain, far
 * from it by next to nothing, and every edit would change the equations of the whole subdomain. So
 * what is left of the weights above a small share is taken, and scaled to sum to one: still
 * continuous, still one on the interfaces, and a node follows only the few bones that matter there.
 * Subdomains of type F share no nodes but those of type R, so each is solved for by itself. */
#include "base/dense.h"
#include "base/sort.h"
#include "shape/subdomains_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is taken off every weight. What is left is divided by its sum, 1 - taken * bones at least:
 * slopes stay nearly what they were. */
static const double taken = 0.02;

typedef struct edge {
  int32_t i, j;    /* nodes of the subdomain, i < j; free ones come first */
  int32_t element; /* sums run in the order of elements */
  double weight;
} edge;

typedef struct influence {
  int32_t node, bone;
  double weight;
} influence;

typedef struct blend {
  bw_context *context;
  bw_subdomains *subdomains;
  const bwi_guide *guide;
  int32_t *element_start, *element; /* elements of each subdomain */
  int32_t *local;                   /* node -> number in the subdomain at hand, or -1 */
  int32_t *constrained_bone;        /* node -> the bone of its type R subdomain, or -1 */
  influence *list;                  /* of all free nodes, in any order of nodes */
  size_t count, capacity;
  int32_t *bone; /* the lists of bones of the subdomains, one after the other */
  size_t bone_count, bone_capacity;
  /* the subdomain at hand */
  int32_t *node; /* free ones, then constrained ones */
  int32_t free_count, node_count;
  edge *edges;
  size_t edge_count;
  double *diagonal, *x, *r, *p, *q; /* free_count */
} blend;

/* ---- the equations of one subdomain ---------------------------------------------------------- */

static bw_status collect_nodes(blend *b, int32_t subdomain) {
  const bw_subdomains *d = b->subdomains;
  int32_t first = b->element_start[subdomain], end = b->element_start[subdomain + 1];
  b->node = BW_NEW(b->context, int32_t, 4 * ((int64_t)end - first));
  if (!b->node)
    return BW_MEMORY;
  for (int constrained = 0; constrained < 2; constrained++) {
    for (int32_t at = first; at < end; at++)
      for (int k = 0; k < 4; k++) {
        int32_t i = bwi_nodes_of(d->mesh, b->element[at])[k];
        if (b->local[i] >= 0 || (b->constrained_bone[i] >= 0) != constrained)
          continue;
        b->local[i] = b->node_count;
        b->node[b->node_count++] = i;
      }
    if (!constrained)
      b->free_count = b->node_count;
  }
  return BW_OK;
}

/* -integral of grad N_i . grad N_j for the six edges of a straight tetrahedron. */
static void edge_weights(const bw_mesh *mesh, int32_t e, double weight[6]) {
  const int32_t *node = bwi_nodes_of(mesh, e);
  double jacobian[9], inverse[9], gradient[4][3];
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < 3; j++)
      jacobian[3 * k + j] = mesh->node[3 * (size_t)node[k + 1] + (size_t)j] -
                            mesh->node[3 * (size_t)node[0] + (size_t)j];
  double volume = bw_inverse3(jacobian, inverse) / 6;
  for (int j = 0; j < 3; j++) {
    for (int k = 0; k < 3; k++)
      gradient[k + 1][j] = inverse[3 * j + k];
    gradient[0][j] = -gradient[1][j] - gradient[2][j] - gradient[3][j];
  }
  for (int k = 0; k < 6; k++)
    weight[k] = -volume * bw_dot(gradient[bw_tet_edge[k][0]], gradient[bw_tet_edge[k][1]]);
}

static int compare_edges(const void *a, const void *b) {
  const edge *x = a, *y = b;
  if (x->i != y->i)
    return x->i < y->i ? -1 : 1;
  if (x->j != y->j)
    return x->j < y->j ? -1 : 1;
  return (x->element > y->element) - (x->element < y->element);
}

static bw_status collect_edges(blend *b, int32_t subdomain) {
  int32_t first = b->element_start[subdomain], end = b->element_start[subdomain + 1];
  b->edges = BW_NEW(b->context, edge, 6 * ((int64_t)end - first));
  if (!b->edges)
    return BW_MEMORY;
  size_t count = 0;
  for (int32_t at = first; at < end; at++) {
    int32_t e = b->element[at];
    const int32_t *node = bwi_nodes_of(b->subdomains->mesh, e);
    double weight[6];
    edge_weights(b->subdomains->mesh, e, weight);
    for (int k = 0; k < 6; k++) {
      int32_t i = b->local[node[bw_tet_edge[k][0]]], j = b->local[node[bw_tet_edge[k][1]]];
      if (i < b->free_count || j < b->free_count)
        b->edges[count++] = (edge){i < j ? i : j, i < j ? j : i, e, weight[k]};
    }
  }
  if (count > 0)
    qsort(b->edges, count, sizeof *b->edges, compare_edges);
  for (size_t at = 0; at < count; at++) {
    edge *last = b->edge_count ? b->edges + b->edge_count - 1 : NULL;
    if (last && last->i == b->edges[at].i && last->j == b->edges[at].j)
      last->weight += b->edges[at].weight;
    else
      b->edges[b->edge_count++] = b->edges[at];
  }
  return BW_OK;
}

/* y = (Laplacian of free nodes) x, the constrained ones being zero. */
static void multiply(const blend *b, const double *x, double *y) {
  memset(y, 0, (size_t)b->free_count * sizeof *y);
  for (size_t k = 0; k < b->edge_count; k++) {
    const edge *e = b->edges + k;
    double flow = e->weight * (x[e->i] - (e->j < b->free_count ? x[e->j] : 0));
    y[e->i] += flow;
    if (e->j < b->free_count)
      y[e->j] -= flow;
  }
}

/* Conjugate gradients with the diagonal as preconditioner: a subdomain has a few thousand nodes,
 * and what rounding leaves does not matter beyond 1e-13. x: the weight of `bone`. */
static bw_status solve(blend *b, int32_t subdomain, int32_t bone, double *x) {
  int32_t n = b->free_count;
  memset(x, 0, (size_t)n * sizeof *x);
  memset(b->r, 0, (size_t)n * sizeof *b->r);
  for (size_t k = 0; k < b->edge_count; k++) {
    const edge *e = b->edges + k;
    if (e->j >= n && b->constrained_bone[b->node[e->j]] == bone)
      b->r[e->i] += e->weight;
  }
  double rho = 0, start = 0, min = INFINITY;
  int32_t limit = n < 100000 ? 10 * n + 100 : 1000000;
  for (int32_t step = 0; step <= limit; step++) {
    for (int32_t i = 0; i < n; i++)
      b->q[i] = b->r[i] / b->diagonal[i];
    double next = bwi_dot(n, b->r, b->q);
    if (step == 0)
      start = next;
    min = fmin(min, next);
    if (!(next > 1e-26 * start))
      return BW_OK;
    double keep = step > 0 ? next / rho : 0;
    for (int32_t i = 0; i < n; i++)
      b->p[i] = b->q[i] + keep * b->p[i];
    rho = next;
    multiply(b, b->p, b->q);
    double curvature = bwi_dot(n, b->p, b->q);
    if (!(curvature > 0))
      break;
    double alpha = rho / curvature;
    for (int32_t i = 0; i < n; i++) {
      x[i] += alpha * b->p[i];
      b->r[i] -= alpha * b->q[i];
    }
    if (step % 256 == 255) {
      bw_status status = bw_check_cancel(b->context);
      if (status != BW_OK)
        return status;
    }
  }
  if (min <= 1e-16 * start) /* as good as rounding lets it be on needle elements */
    return BW_OK;
  bw_fail(
      b->context, BW_CONVERGENCE,
      "the blending weights of subdomain %d (%d elements) did not converge: its elements are too "
      "thin; refill or coarsen the mesh there",
      subdomain + 1, b->subdomains->elements[subdomain]);
  bw_detail_number(b->context, "subdomain", subdomain + 1.0);
  return BW_CONVERGENCE;
}

/* ---- what each subdomain follows ------------------------------------------------------------- */

static bw_status add_influence(blend *b, int32_t node, int32_t bone, double weight) {
  if (!bw_grow(b->context, (void **)&b->list, &b->capacity, b->count, 1, sizeof *b->list))
    return BW_MEMORY;
  b->list[b->count++] = (influence){node, bone, weight};
  return BW_OK;
}

/* Appends the bones of the type R subdomains that a type F subdomain touches to b->bone, in
 * ascending order. */
static bw_status touched_bones(blend *b, int32_t *count) {
  size_t first = b->bone_count;
  for (int32_t k = b->free_count; k < b->node_count; k++) {
    int32_t bone = b->constrained_bone[b->node[k]];
    bool known = false;
    for (size_t i = first; i < b->bone_count && !known; i++)
      known = b->bone[i] == bone;
    if (known)
      continue;
    if (!bw_grow(b->context, (void **)&b->bone, &b->bone_capacity, b->bone_count, 1,
                 sizeof *b->bone))
      return BW_MEMORY;
    b->bone[b->bone_count++] = bone;
  }
  *count = (int32_t)(b->bone_count - first);
  if (*count > 1)
    bwi_sort_columns(b->bone + first, *count);
  return BW_OK;
}

/* A subdomain that touches no type R subdomain follows one bone, the one its guide speaks for. */
static bw_status follow_guide(blend *b, int32_t subdomain) {
  const bw_subdomains *d = b->subdomains;
  double *score = BW_NEW0(b->context, double, d->skeleton->bone_count);
  if (!score)
    return BW_MEMORY;
  for (int32_t at = b->element_start[subdomain]; at < b->element_start[subdomain + 1]; at++)
    bwi_guide_score(b->guide, d->mesh, d->skeleton, b->element[at], score);
  int32_t bone = bwi_highest(score, d->skeleton->bone_count);
  bw_free(score);
  if (!bw_grow(b->context, (void **)&b->bone, &b->bone_capacity, b->bone_count, 1, sizeof *b->bone))
    return BW_MEMORY;
  b->bone[b->bone_count++] = bone < 0 ? 0 : bone;
  return BW_OK;
}

/* Free nodes that no chain of edges joins to a constrained one (in a subdomain of several parts)
 * have no equation of their own: they take the bone of the nearest constrained node. lost[i] says
 * which. */
static bw_status find_lost(blend *b, int32_t *lost, int32_t *lost_count) {
  int32_t n = b->node_count;
  int32_t *group = BW_NEW(b->context, int32_t, n);
  uint8_t *constrained = BW_NEW0(b->context, uint8_t, n);
  if (!group || !constrained) {
    bw_free(group);
    bw_free(constrained);
    return BW_MEMORY;
  }
  for (int32_t i = 0; i < n; i++)
    group[i] = i;
  for (size_t k = 0; k < b->edge_count; k++)
    bwi_set_join(group, b->edges[k].i, b->edges[k].j);
  for (int32_t i = b->free_count; i < n; i++)
    constrained[bwi_set_root(group, i)] = 1;
  for (int32_t i = 0; i < b->free_count; i++)
    if (!constrained[bwi_set_root(group, i)])
      lost[(*lost_count)++] = i;
  bw_free(group);
  bw_free(constrained);
  return BW_OK;
}

static int32_t nearest_constrained(const blend *b, int32_t i) {
  const double *x = b->subdomains->mesh->node, *at = x + 3 * (size_t)b->node[i];
  double min = INFINITY;
  int32_t bone = -1;
  for (int32_t k = b->free_count; k < b->node_count; k++) {
    const double *to = x + 3 * (size_t)b->node[k];
    double d[3] = {to[0] - at[0], to[1] - at[1], to[2] - at[2]}, square = bw_dot(d, d);
    if (square < min) {
      min = square;
      bone = b->constrained_bone[b->node[k]];
    }
  }
  return bone;
}

/* Thin out, scale, and write down the weights of one free node. */
static bw_status write_weights(blend *b, int32_t node, const int32_t *bone, int32_t bones,
                               double *weight) {
  double sum = 0, max = 0;
  for (int32_t k = 0; k < bones; k++)
    max = fmax(max, weight[k]);
  double off = fmin(taken, max / 2); /* something is left among any number of bones */
  for (int32_t k = 0; k < bones; k++) {
    weight[k] = fmax(weight[k] - off, 0);
    sum += weight[k];
  }
  for (int32_t k = 0; k < bones; k++)
    if (weight[k] > 0) {
      bw_status status = add_influence(b, node, bone[k], weight[k] / sum);
      if (status != BW_OK)
        return status;
    }
  return BW_OK;
}

static bw_status blend_several(blend *b, int32_t subdomain, size_t first_bone, int32_t bones) {
  bw_status status = BW_OK;
  int32_t n = b->free_count, lost_count = 0, at = 0;
  double *x = BW_NEW(b->context, double, (int64_t)n *bones);
  double *weight = BW_NEW(b->context, double, bones);
  int32_t *lost = BW_NEW(b->context, int32_t, n);
  b->diagonal = BW_NEW0(b->context, double, 4 * (int64_t)n);
  BW_TRY_MEMORY(x && weight && lost && b->diagonal);
  b->r = b->diagonal + n;
  b->p = b->r + n;
  b->q = b->p + n;
  BW_TRY(collect_edges(b, subdomain));
  for (size_t k = 0; k < b->edge_count; k++) {
    b->diagonal[b->edges[k].i] += b->edges[k].weight;
    if (b->edges[k].j < n)
      b->diagonal[b->edges[k].j] += b->edges[k].weight;
  }
  BW_TRY(find_lost(b, lost, &lost_count));
  for (int32_t k = 0; k + 1 < bones; k++)
    BW_TRY(solve(b, subdomain, b->bone[first_bone + (size_t)k], x + (size_t)k * (size_t)n));
  for (int32_t i = 0; i < n; i++) {
    if (at < lost_count && lost[at] == i) {
      at++;
      BW_TRY(add_influence(b, b->node[i], nearest_constrained(b, i), 1));
      continue;
    }
    weight[bones - 1] = 1;
    for (int32_t k = 0; k + 1 < bones; k++) {
      weight[k] = x[(size_t)k * (size_t)n + (size_t)i];
      weight[bones - 1] -= weight[k];
    }
    BW_TRY(write_weights(b, b->node[i], b->bone + first_bone, bones, weight));
  }
done:
  bw_free(x);
  bw_free(weight);
  bw_free(lost);
  return status;
}

static bw_status blend_subdomain(blend *b, int32_t subdomain) {
  bw_status status = BW_OK;
  int32_t bones = 0;
  size_t first_bone = b->bone_count;
  b->node_count = b->free_count = 0;
  b->edge_count = 0;
  BW_TRY(collect_nodes(b, subdomain));
  BW_TRY(touched_bones(b, &bones));
  if (bones == 0)
    BW_TRY(follow_guide(b, subdomain));
  if (bones > 1) {
    BW_TRY(blend_several(b, subdomain, first_bone, bones));
  } else {
    for (int32_t i = 0; i < b->free_count; i++)
      BW_TRY(add_influence(b, b->node[i], b->bone[first_bone], 1));
  }
done:
  for (int32_t k = 0; k < b->node_count; k++)
    b->local[b->node[k]] = -1;
  bw_free(b->node);
  bw_free(b->edges);
  bw_free(b->diagonal);
  b->node = NULL;
  b->edges = NULL;
  b->diagonal = NULL;
  return status;
}

/* ---- all subdomains -------------------------------------------------------------------------- */

static bw_status sort_elements(blend *b) {
  const bw_subdomains *d = b->subdomains;
  int32_t elements = d->mesh->element_count;
  b->element_start = BW_NEW0(b->context, int32_t, d->count + 2);
  b->element = BW_NEW(b->context, int32_t, elements);
  if (!b->element_start || !b->element)
    return BW_MEMORY;
  /* counted one place up: filling moves each start to its own place */
  for (int32_t e = 0; e < elements; e++)
    b->element_start[d->element_subdomain[e] + 2]++;
  for (int32_t i = 0; i < d->count; i++)
    b->element_start[i + 2] += b->element_start[i + 1];
  for (int32_t e = 0; e < elements; e++)
    b->element[b->element_start[d->element_subdomain[e] + 1]++] = e;
  return BW_OK;
}

static bw_status find_constrained(blend *b) {
  const bw_subdomains *d = b->subdomains;
  int32_t nodes = d->mesh->node_count;
  b->local = BW_NEW(b->context, int32_t, nodes);
  b->constrained_bone = BW_NEW(b->context, int32_t, nodes);
  if (!b->local || !b->constrained_bone)
    return BW_MEMORY;
  for (int32_t i = 0; i < nodes; i++) {
    b->local[i] = -1;
    b->constrained_bone[i] = d->bone_of[d->node_subdomain[i]];
  }
  return BW_OK;
}

/* The lists by node: the free nodes' entries stand together, ascending by bone. */
static bw_status sort_influences(blend *b) {
  bw_subdomains *d = b->subdomains;
  const bw_mesh *mesh = d->mesh;
  bw_status status = BW_OK;
  int32_t nodes = mesh->node_count;
  uint8_t *corner = BW_NEW0(b->context, uint8_t, nodes);
  int64_t *start = d->influence_start = BW_NEW0(b->context, int64_t, (int64_t)nodes + 1);
  BW_TRY_MEMORY(corner && start);
  for (int32_t e = 0; e < mesh->element_count; e++)
    for (int k = 0; k < 4; k++)
      corner[bwi_nodes_of(mesh, e)[k]] = 1;
  for (size_t k = 0; k < b->count; k++)
    start[b->list[k].node + 1]++;
  for (int32_t i = 0; i < nodes; i++) {
    if (corner[i] && b->constrained_bone[i] >= 0)
      start[i + 1] = 1;
    start[i + 1] += start[i];
  }
  d->influence_bone = BW_NEW(b->context, int32_t, start[nodes]);
  d->influence_weight = BW_NEW(b->context, double, start[nodes]);
  BW_TRY_MEMORY(d->influence_bone && d->influence_weight);
  for (int32_t i = 0; i < nodes; i++)
    if (corner[i] && b->constrained_bone[i] >= 0) {
      d->influence_bone[start[i]] = b->constrained_bone[i];
      d->influence_weight[start[i]] = 1;
    }
  for (size_t k = 0, first = 0; k < b->count; k++) {
    if (b->list[k].node != b->list[first].node)
      first = k;
    int64_t at = start[b->list[k].node] + (int64_t)(k - first);
    d->influence_bone[at] = b->list[k].bone;
    d->influence_weight[at] = b->list[k].weight;
  }
done:
  bw_free(corner);
  return status;
}

bw_status bwi_subdomains_blend(bw_context *context, bw_subdomains *subdomains,
                               const bwi_guide *guide) {
  blend b = {.context = context, .subdomains = subdomains, .guide = guide};
  bw_status status = BW_OK;
  subdomains->bone_start = BW_NEW0(context, int32_t, subdomains->count + 1);
  BW_TRY_MEMORY(subdomains->bone_start);
  BW_TRY(sort_elements(&b));
  BW_TRY(find_constrained(&b));
  for (int32_t i = 0; i < subdomains->count; i++) {
    if (subdomains->bone_of[i] < 0) {
      BW_TRY(blend_subdomain(&b, i));
      BW_TRY(bw_check_cancel(context));
    } else {
      BW_TRY_MEMORY(
          bw_grow(context, (void **)&b.bone, &b.bone_capacity, b.bone_count, 1, sizeof *b.bone));
      b.bone[b.bone_count++] = subdomains->bone_of[i];
    }
    subdomains->bone_start[i + 1] = (int32_t)b.bone_count;
  }
  BW_TRY(sort_influences(&b));
  subdomains->bone = b.bone;
  b.bone = NULL;
done:
  bw_free(b.element_start);
  bw_free(b.element);
  bw_free(b.local);
  bw_free(b.constrained_bone);
  bw_free(b.list);
  bw_free(b.bone);
  return status;
}
