/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Curved tetrahedra: the nodes of boundary facets of quadratic elements on the primitives of the
 * surface's faces. Corners of a filled mesh are there already; those of a refined one may be
 * mid-edge nodes that a coarser element did not have. */
#include "mesh/faces_internal.h"

#include <math.h>
#include <string.h>

#include "mesh/surface_internal.h"

static const double longest_move = 0.25; /* of the edge */
static const double min_jacobian = 0.2;  /* of the straight element's */

/* The Jacobian's determinant at barycentric coordinates. */
static double jacobian(const double *node, const int32_t *element, const double l[4]) {
  double g[4][3] = {{0}}, a[3], b[3], c[3], n[3];
  for (int k = 0; k < 4; k++)
    for (int i = 0; i < 3; i++)
      g[k][i] = (4 * l[k] - 1) * node[3 * (size_t)element[k] + (size_t)i];
  for (int e = 0; e < 6; e++) {
    int p = bw_tet_edge[e][0], q = bw_tet_edge[e][1];
    for (int i = 0; i < 3; i++) {
      double x = node[3 * (size_t)element[4 + e] + (size_t)i];
      g[p][i] += 4 * l[q] * x;
      g[q][i] += 4 * l[p] * x;
    }
  }
  for (int i = 0; i < 3; i++) {
    a[i] = g[1][i] - g[0][i];
    b[i] = g[2][i] - g[0][i];
    c[i] = g[3][i] - g[0][i];
  }
  bw_cross(a, b, n);
  return bw_dot(n, c);
}

/* The smallest Jacobian at corners, mid-edge nodes and centre, which bounds it well, against the
 * straight element's. */
static bool is_distorted(const bw_mesh *mesh, const double *node, int32_t e) {
  const int32_t *element = mesh->element + 10 * (size_t)e;
  double limit = min_jacobian * 6 * mesh->volume[e];
  const double centre[4] = {0.25, 0.25, 0.25, 0.25};
  if (jacobian(node, element, centre) < limit)
    return true;
  for (int k = 0; k < 10; k++) {
    double l[4] = {0};
    if (k < 4)
      l[k] = 1;
    else
      l[bw_tet_edge[k - 4][0]] = l[bw_tet_edge[k - 4][1]] = 0.5;
    if (jacobian(node, element, l) < limit)
      return true;
  }
  return false;
}

/* Nodes of distorted elements back to where they were; true when there were some. */
static bool straighten(const bw_mesh *mesh, double *node, uint8_t *moved) {
  bool some = false;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *own = mesh->element + 10 * (size_t)e;
    bool touched = false;
    for (int k = 0; k < 10; k++)
      touched = touched || moved[own[k]];
    if (!touched || !is_distorted(mesh, node, e))
      continue;
    for (int k = 0; k < 10; k++)
      if (moved[own[k]]) {
        memcpy(node + 3 * (size_t)own[k], mesh->node + 3 * (size_t)own[k], 3 * sizeof *node);
        moved[own[k]] = 0;
        some = true;
      }
  }
  return some;
}

bw_status bw_mesh_curved(bw_context *context, const bw_mesh *mesh, const bw_surface *surface,
                         bw_mesh **curved, int64_t *count) {
  bw_status status;
  bw_faces *faces = NULL;
  bw_surface *boundary = NULL;
  int32_t *label = NULL;
  bwi_faces_around *at = NULL;
  uint8_t *moved = NULL;
  double *node = NULL;
  int64_t total = 0;
  if (mesh->order != 2)
    return bw_fail(context, BW_INVALID,
                   "only elements of order 2 have curved edges: this mesh has order %d",
                   mesh->order);
  double diagonal = bwi_surface_diagonal(surface);
  BW_TRY(bw_faces_find(context, surface, 0, &faces));
  BW_TRY(bw_mesh_boundary(context, mesh, &boundary, NULL));
  label = BW_NEW(context, int32_t, mesh->facet_count);
  at = BW_NEW0(context, bwi_faces_around, mesh->node_count);
  moved = BW_NEW0(context, uint8_t, mesh->node_count);
  node = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
  BW_TRY_MEMORY(label && at && moved && node);
  BW_TRY(bwi_faces_label(context, surface, faces, boundary, label));
  memcpy(node, mesh->node, 3 * (size_t)mesh->node_count * sizeof *node);
  for (int32_t f = 0; f < mesh->facet_count; f++)
    for (int k = 0; k < 6 && label[f] >= 0; k++)
      bwi_around_add(&at[mesh->facet[6 * (size_t)f + (size_t)k]], faces, label[f]);
  for (int32_t f = 0; f < mesh->facet_count; f++)
    for (size_t k = 0; k < 6; k++) {
      const int32_t *own = mesh->facet + 6 * (size_t)f;
      const double *a = mesh->node + 3 * (size_t)own[k % 3];
      const double *b = mesh->node + 3 * (size_t)own[(k + 1) % 3];
      const double *from = mesh->node + 3 * (size_t)own[k];
      double x[3] = {from[0], from[1], from[2]}, edge[3], move[3];
      if (moved[own[k]] || at[own[k]].count == 0 ||
          !bwi_around_project(faces, &at[own[k]], BW_FACE_SPHERE, diagonal, x))
        continue;
      for (int i = 0; i < 3; i++) {
        edge[i] = b[i] - a[i];
        move[i] = x[i] - from[i];
      }
      if (bw_norm(move) > longest_move * bw_norm(edge) || bw_norm(move) < 1e-12 * bw_norm(edge))
        continue;
      memcpy(node + 3 * (size_t)own[k], x, sizeof x);
      moved[own[k]] = 1;
    }
  while (straighten(mesh, node, moved))
    BW_TRY(bw_check_cancel(context));
  for (int32_t i = 0; i < mesh->node_count; i++)
    total += moved[i];
  BW_TRY(bw_mesh_moved(context, mesh, node, curved));
  if (count)
    *count = total;
done:
  bw_release(faces);
  bw_release(boundary);
  bw_free(label);
  bw_free(at);
  bw_free(moved);
  bw_free(node);
  return status;
}
