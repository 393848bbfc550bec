/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Shape measures of tetrahedra, all of the straight-edged element. */
#include "barwright/mesh.h"

#include <math.h>

/* With N_k the outward normal of face k, twice its area long, l the length of an edge and V the
 * volume: |N_i x N_j| = 6 V l for the two faces that meet in the edge, so the dihedral angle there
 * is atan2(6 V l, -N_i . N_j), accurate also near 0 and 180 degrees; the height on face k is
 * 6 V / |N_k|. */
static void measure(const double *x[4], double volume, double *dihedral_min, double *dihedral_max,
                    double *radius_edge, double *aspect) {
  double normal[4][3], area = 0, side[3][3], square[3], shortest = INFINITY, longest = 0;
  for (int k = 0; k < 4; k++) {
    double a[3], b[3];
    for (int i = 0; i < 3; i++) {
      a[i] = x[bw_tet_face[k][1]][i] - x[bw_tet_face[k][0]][i];
      b[i] = x[bw_tet_face[k][2]][i] - x[bw_tet_face[k][0]][i];
    }
    bw_cross(a, b, normal[k]);
    area = fmax(area, bw_norm(normal[k]));
  }
  /* Face k lies opposite corner 3 2 0 1: the edge between corners i and j belongs to the faces
   * opposite the other two. */
  static const int faces[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 3}, {1, 2}, {2, 3}};
  static const int edge[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  *dihedral_min = INFINITY;
  *dihedral_max = 0;
  for (int k = 0; k < 6; k++) {
    double d[3];
    for (int i = 0; i < 3; i++)
      d[i] = x[edge[k][1]][i] - x[edge[k][0]][i];
    double length = bw_norm(d);
    shortest = fmin(shortest, length);
    longest = fmax(longest, length);
    double angle = atan2(6 * volume * length, -bw_dot(normal[faces[k][0]], normal[faces[k][1]]));
    *dihedral_min = fmin(*dihedral_min, angle);
    *dihedral_max = fmax(*dihedral_max, angle);
  }
  *aspect = longest * area / (6 * volume);

  double centre[3] = {0, 0, 0};
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < 3; i++)
      side[k][i] = x[k + 1][i] - x[0][i];
    square[k] = bw_dot(side[k], side[k]);
  }
  for (int k = 0; k < 3; k++) {
    double c[3];
    bw_cross(side[(k + 1) % 3], side[(k + 2) % 3], c);
    for (int i = 0; i < 3; i++)
      centre[i] += square[k] * c[i];
  }
  *radius_edge = bw_norm(centre) / (12 * volume) / shortest;
}

void bw_mesh_quality_of(const bw_mesh *mesh, bw_mesh_quality *quality) {
  bw_mesh_quality q = {.dihedral_min = INFINITY, .volume_min = INFINITY, .worst = -1};
  for (int32_t i = 0; i < mesh->element_count; i++) {
    const int32_t *e = mesh->element + (size_t)i * (size_t)mesh->nodes_per_element;
    const double *x[4];
    for (int k = 0; k < 4; k++)
      x[k] = mesh->node + 3 * (size_t)e[k];
    double low, high, radius_edge, aspect;
    measure(x, mesh->volume[i], &low, &high, &radius_edge, &aspect);
    if (low < q.dihedral_min) {
      q.dihedral_min = low;
      q.worst = i;
    }
    q.dihedral_max = fmax(q.dihedral_max, high);
    q.radius_edge_max = fmax(q.radius_edge_max, radius_edge);
    q.aspect_max = fmax(q.aspect_max, aspect);
    q.volume_min = fmin(q.volume_min, mesh->volume[i]);
    q.volume_max = fmax(q.volume_max, mesh->volume[i]);
  }
  *quality = q;
}
