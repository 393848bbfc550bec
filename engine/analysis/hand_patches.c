/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The patches that hands can reach: around each node with a pressure the nodes within a radius that
 * face the same way. Nodes are sorted along x: those of a patch lie in a slab of twice the
 * radius. */
#include "analysis/load_program.h"

#include <stdlib.h>
#include <string.h>

static const double same_way = 0.5; /* cosine between a node's normal and the centre's */

static const double *place_of(const bw_pressure_basis *basis, int32_t node) {
  return basis->at + 3 * (size_t)(node * basis->directions);
}

static int32_t body_of(const bw_pressure_basis *basis, int32_t node) {
  return basis->mesh->component[basis->node[node * basis->directions]];
}

static void find_normals(const bw_pressure_basis *basis, double *normal) {
  for (int32_t g = 0; g < basis->count / basis->directions; g++) {
    double *n = normal + 3 * (size_t)g;
    memset(n, 0, 3 * sizeof *n);
    int32_t first = g * basis->directions; /* the mean of a node's columns has no friction */
    for (int64_t e = basis->start[first]; e < basis->start[first + basis->directions]; e++)
      for (int k = 0; k < 3; k++)
        n[k] -= basis->coefficient[3 * e + k];
    double length = bw_norm(n);
    for (int k = 0; k < 3 && length > 0; k++)
      n[k] /= length;
  }
}

static bool in_patch(const bw_pressure_basis *basis, const double *normal, int32_t centre,
                     int32_t node, double radius) {
  const double *a = place_of(basis, centre), *b = place_of(basis, node);
  double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return node == centre ||
         (body_of(basis, centre) == body_of(basis, node) && bw_norm(d) <= radius &&
          bw_dot(normal + 3 * (size_t)centre, normal + 3 * (size_t)node) >= same_way);
}

typedef struct by_place {
  double x;
  int32_t node;
} by_place;

static int compare_place(const void *a, const void *b) {
  const by_place *p = (const by_place *)a, *q = (const by_place *)b;
  if (p->x != q->x)
    return p->x < q->x ? -1 : 1;
  return (p->node > q->node) - (p->node < q->node);
}

static int compare_node(const void *a, const void *b) {
  const int32_t *p = (const int32_t *)a, *q = (const int32_t *)b;
  return (*p > *q) - (*p < *q);
}

bw_status bwi_hand_patches(bw_context *context, const bw_pressure_basis *basis, double radius,
                           double *normal, int64_t *start, int32_t **member) {
  bw_status status = BW_OK;
  size_t capacity = 0, count = 0;
  int32_t n = basis->count / basis->directions, first = 0;
  by_place *order = BW_NEW(context, by_place, n);
  int32_t *rank = BW_NEW(context, int32_t, n);
  BW_TRY_MEMORY(order && rank);
  find_normals(basis, normal);
  for (int32_t g = 0; g < n; g++)
    order[g] = (by_place){place_of(basis, g)[0], g};
  qsort(order, (size_t)n, sizeof *order, compare_place);
  for (int32_t i = 0; i < n; i++)
    rank[order[i].node] = i;
  for (int32_t g = 0; g < n; g++) {
    double x = place_of(basis, g)[0];
    start[g] = (int64_t)count;
    for (first = rank[g]; first > 0 && order[first - 1].x >= x - radius; first--)
      ;
    for (int32_t i = first; i < n && order[i].x <= x + radius; i++) {
      if (!in_patch(basis, normal, g, order[i].node, radius))
        continue;
      BW_TRY_MEMORY(bw_grow(context, (void **)member, &capacity, count, 1, sizeof **member));
      (*member)[count++] = order[i].node;
    }
    qsort(*member + start[g], count - (size_t)start[g], sizeof **member, compare_node);
  }
  start[n] = (int64_t)count;
done:
  bw_free(order);
  bw_free(rank);
  return status;
}
