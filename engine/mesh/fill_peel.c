/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Flat elements on the boundary. Facets of a plane part of a surface lie in one plane only to
 * within rounding or a hair's breadth; where four of their points span an element it has next to no
 * volume, and the surface being fixed TetGen cannot get rid of it. Taking it out exchanges the
 * facets outside it for those inside:
 *
 *   one facet on the boundary     its three other faces come to light, if the fourth corner lies
 *                                 inside the mesh;
 *   two                           the diagonal is exchanged, if the new one is no edge of the
 *                                 boundary yet;
 *   three                         the common corner goes.
 *
 * In each case the boundary stays a manifold. It moves by about the smallest height of the element:
 * one that lies against the boundary with a needle would uncover a point far inside, and stays.
 *
 * Points that were put onto a plane lie in it exactly: then TetGen may leave elements without any
 * volume there. They go the same way, from its arrays, because no mesh may have them. */
#include "mesh/fill_internal.h"
#include "mesh/mesh_internal.h"
#include "mesh/surface_tree.h"

#include <math.h>
#include <string.h>

/* The boundary moves by so many smallest heights of an element at most. */
static const double MAX_HEIGHTS = 2;
/* What goes may uncover more of the kind: so many rounds at most. */
enum { ROUNDS = 4 };
/* The sine of the smallest angle of elements without volume: rounding. */
static const double DEGENERATE = 1e-12;

/* Smallest height and smallest dihedral angle (its sine). */
static void flatness(const bw_mesh *mesh, int32_t element, double *height, double *sine) {
  const int32_t *e = mesh->element + 4 * (size_t)element;
  double area[4], largest = 0;
  for (int k = 0; k < 4; k++) {
    double a[3], b[3], n[3];
    const double *x = mesh->node + 3 * (size_t)e[bw_tet_face[k][0]];
    for (int i = 0; i < 3; i++) {
      a[i] = mesh->node[3 * (size_t)e[bw_tet_face[k][1]] + (size_t)i] - x[i];
      b[i] = mesh->node[3 * (size_t)e[bw_tet_face[k][2]] + (size_t)i] - x[i];
    }
    bw_cross(a, b, n);
    area[k] = bw_norm(n) / 2;
    largest = fmax(largest, area[k]);
  }
  *height = 3 * mesh->volume[element] / largest;
  *sine = INFINITY;
  /* sin(angle) = 3/2 V l / (A_i A_j) along the edge l of faces i and j */
  static const int faces[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 3}, {1, 2}, {2, 3}};
  static const int edge[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (int k = 0; k < 6; k++) {
    double d[3];
    for (int i = 0; i < 3; i++)
      d[i] = mesh->node[3 * (size_t)e[edge[k][1]] + (size_t)i] -
             mesh->node[3 * (size_t)e[edge[k][0]] + (size_t)i];
    *sine = fmin(*sine, 1.5 * mesh->volume[element] * bw_norm(d) /
                            (area[faces[k][0]] * area[faces[k][1]]));
  }
}

static uint64_t edge_key(int32_t a, int32_t b) {
  return a < b ? (uint64_t)a << 32 | (uint64_t)b : (uint64_t)b << 32 | (uint64_t)a;
}

/* Is there a boundary facet with both nodes? Asked only for the few candidates. */
static bool on_boundary_edge(const bwi_keyed *edge, int64_t count, int32_t a, int32_t b) {
  uint64_t key = edge_key(a, b);
  int64_t low = 0, high = count;
  while (low < high) {
    int64_t middle = (low + high) / 2;
    if (edge[middle].key < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && edge[low].key == key;
}

/* Edges of the boundary whose nodes are both `asked` for, sorted. */
static bw_status boundary_edges(bw_context *context, const bw_mesh *mesh, const uint8_t *asked,
                                bwi_keyed **edge, int64_t *count) {
  size_t found = 0, capacity = 0;
  bwi_keyed *list = NULL;
  for (int32_t f = 0; f < mesh->facet_count; f++)
    for (int k = 0; k < 3; k++) {
      int32_t a = mesh->facet[3 * (size_t)f + (size_t)k];
      int32_t b = mesh->facet[3 * (size_t)f + (size_t)(k + 1) % 3];
      if (!asked[a] || !asked[b])
        continue;
      if (!bw_grow(context, (void **)&list, &capacity, found, 1, sizeof *list)) {
        bw_free(list);
        return BW_MEMORY;
      }
      list[found++] = (bwi_keyed){.key = edge_key(a, b)};
    }
  bwi_sort_keyed(list, (int64_t)found);
  *edge = list;
  *count = (int64_t)found;
  return BW_OK;
}

static const int opposite[4] = {3, 2, 0, 1}; /* the corner off face k */

/* The squared distance of a point from face k. */
static double apart(const bw_mesh *mesh, const int32_t *e, int k, const double at[3]) {
  const double *x[3];
  double found[3];
  for (int i = 0; i < 3; i++)
    x[i] = mesh->node + 3 * (size_t)e[bw_tet_face[k][i]];
  return bwi_nearest_on_triangle(at, x[0], x[1], x[2], found);
}

/* How far the boundary moves where the element goes: what comes to light lies so far from its faces
 * on the boundary, or what goes from the others. */
static double uncovered(const bw_mesh *mesh, int32_t element, unsigned faces) {
  const int32_t *e = mesh->element + 4 * (size_t)element;
  int on[4], count = 0, off = 0;
  for (int k = 0; k < 4; k++)
    if (faces & 1u << k)
      on[count++] = k;
    else
      off = k;
  if (count == 1)
    return sqrt(apart(mesh, e, on[0], mesh->node + 3 * (size_t)e[opposite[on[0]]]));
  if (count == 3)
    return sqrt(apart(mesh, e, off, mesh->node + 3 * (size_t)e[opposite[off]]));
  const double *p = mesh->node + 3 * (size_t)e[opposite[on[0]]];
  const double *q = mesh->node + 3 * (size_t)e[opposite[on[1]]];
  double far = 0;
  for (int i = 1; i < 4; i++) { /* points of the new edge */
    double x[3];
    for (int k = 0; k < 3; k++)
      x[k] = p[k] + 0.25 * i * (q[k] - p[k]);
    far = fmax(far, fmin(apart(mesh, e, on[0], x), apart(mesh, e, on[1], x)));
  }
  return sqrt(far);
}

/* May the element go? Its faces on the boundary are given as bits. */
static bool may_go(const bw_mesh *mesh, int32_t element, unsigned faces, const uint8_t *outside,
                   const bwi_keyed *edge, int64_t edges) {
  const int32_t *e = mesh->element + 4 * (size_t)element;
  int off[4], count = 0;
  for (int k = 0; k < 4; k++)
    if (faces & 1u << k)
      off[count++] = opposite[k];
  switch (count) {
  case 1:
    return !outside[e[off[0]]];
  case 2: /* the facets off[0] and off[1] are missing from each hold the other one */
    return !on_boundary_edge(edge, edges, e[off[0]], e[off[1]]);
  case 3:
    return true;
  }
  return false;
}

/* Which elements to keep. Those that go have no angle above sine_limit, no larger height than
 * `highest`, and move the boundary by MAX_HEIGHTS of them or by `max`. */
static bw_status choose(bw_context *context, const bw_mesh *mesh, double sine_limit, double highest,
                        double max, uint8_t *keep, int64_t *gone, double *moved) {
  bw_status status = BW_OK;
  bwi_keyed *edge = NULL;
  int64_t edges = 0;
  uint8_t *asked = BW_NEW0(context, uint8_t, mesh->node_count);
  uint8_t *outside = BW_NEW0(context, uint8_t, mesh->node_count);
  *gone = 0;
  BW_TRY_MEMORY(asked && outside);
  for (int32_t i = 0; i < mesh->boundary_node_count; i++)
    outside[mesh->boundary_node[i]] = 1;
  for (int32_t i = 0; i < mesh->element_count; i++) {
    const int32_t *n = mesh->neighbour + 4 * (size_t)i;
    double height, sine = 1;
    keep[i] = 1;
    if (n[0] < 0 || n[1] < 0 || n[2] < 0 || n[3] < 0)
      flatness(mesh, i, &height, &sine);
    if (sine >= sine_limit || height > highest)
      continue;
    keep[i] = 0; /* a candidate */
    for (int k = 0; k < 4; k++)
      asked[mesh->element[4 * (size_t)i + (size_t)k]] = 1;
  }
  BW_TRY(boundary_edges(context, mesh, asked, &edge, &edges));
  for (int32_t i = 0; i < mesh->element_count; i++) {
    if (keep[i])
      continue;
    const int32_t *e = mesh->element + 4 * (size_t)i, *n = mesh->neighbour + 4 * (size_t)i;
    unsigned faces = 0;
    bool free = true; /* nothing that has gone in this round touches it */
    for (int k = 0; k < 4; k++) {
      faces |= (n[k] < 0 ? 1u : 0u) << k;
      free &= asked[e[k]] != 2;
    }
    double height, sine, far = 0;
    flatness(mesh, i, &height, &sine);
    if (free && may_go(mesh, i, faces, outside, edge, edges))
      far = uncovered(mesh, i, faces);
    else
      free = false;
    if (!free || far > fmax(MAX_HEIGHTS * height, max)) {
      keep[i] = 1;
      continue;
    }
    *moved = fmax(*moved, far);
    ++*gone;
    for (int k = 0; k < 4; k++)
      asked[e[k]] = 2;
  }
  if (*gone == mesh->element_count) /* never eat all of it */
    *gone = 0;
done:
  bw_free(edge);
  bw_free(asked);
  bw_free(outside);
  return status;
}

bw_status bwi_peel_flat(bw_context *context, bw_mesh **mesh, double angle, double highest,
                        int64_t *gone, double *moved) {
  bw_status status = BW_OK;
  uint8_t *keep = BW_NEW(context, uint8_t, (*mesh)->element_count);
  *gone = 0;
  *moved = 0;
  if (!keep)
    return BW_MEMORY;
  for (int round = 0; round < ROUNDS; round++) {
    bw_mesh *made;
    int64_t now;
    BW_TRY(choose(context, *mesh, sin(angle), highest, 0, keep, &now, moved));
    if (now == 0)
      break;
    BW_TRY(bw_mesh_subset(context, *mesh, keep, &made));
    bw_release(*mesh);
    *mesh = made;
    *gone += now;
  }
done:
  bw_free(keep);
  return status;
}

bw_status bwi_peel_degenerate(bw_context *context, bwi_tetgen_result *result, double max) {
  bw_status status = BW_OK;
  bw_mesh *mesh = NULL;
  uint8_t *keep = BW_NEW(context, uint8_t, result->element_count);
  if (!keep)
    return BW_MEMORY;
  for (int round = 0; round < ROUNDS; round++) {
    int64_t gone, kept = 0;
    double moved = 0;
    BW_TRY(bwi_mesh_adopt(context, 1, result->node_count, result->node, result->element_count,
                          result->element, NULL, true, &mesh));
    status = choose(context, mesh, DEGENERATE, max, max, keep, &gone, &moved);
    result->node_count = mesh->node_count; /* the arrays go back */
    result->node = mesh->node;
    result->element = mesh->element;
    mesh->node = NULL;
    mesh->element = NULL;
    bw_release(mesh);
    if (status != BW_OK || gone == 0)
      break;
    for (int64_t i = 0; i < result->element_count; i++)
      if (keep[i])
        memmove(result->element + 4 * kept++, result->element + 4 * i, 4 * sizeof(int32_t));
    result->element_count = kept;
  }
done:
  bw_free(keep);
  return status;
}
