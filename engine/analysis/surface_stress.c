/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stress of the surface. See surface_stress.h.
 *
 * The strain along the surface and sigma n = t give all of sigma: C_s takes any displacement
 * gradient that continues the surface's own to the same stress, since gradients a n^T change the
 * traction alone. So the stress needs the displacement of the facet's nodes and no other. */
#include "analysis/surface_stress.h"

#include "analysis/strain.h"
#include "analysis/surface_patch.h"
#include "analysis/weak_internal.h"

#include <string.h>

enum { CORNERS_PER_CHUNK = 768 };

/* Gradients along the surface by the dual basis of its two tangents. */
static void surface_gradients(const bw_mesh *mesh, int corner, bwi_facet_corner *at) {
  double l[3] = {0}, by[6][3], u[3] = {0}, v[3] = {0};
  l[corner] = 1;
  bw_triangle_shape_gradient(mesh->order, l, by);
  for (int a = 0; a < at->nodes; a++)
    for (int c = 0; c < 3; c++) {
      double x = mesh->node[3 * (size_t)at->node[a] + (size_t)c];
      u[c] += (by[a][1] - by[a][0]) * x;
      v[c] += (by[a][2] - by[a][0]) * x;
    }
  double uu = bw_dot(u, u), uv = bw_dot(u, v), vv = bw_dot(v, v);
  double determinant = uu * vv - uv * uv, scale = determinant > 0 ? 1 / determinant : 0;
  bw_cross(u, v, at->normal);
  double size = bw_norm(at->normal);
  for (int c = 0; c < 3 && size > 0; c++)
    at->normal[c] /= size;
  for (int a = 0; a < at->nodes; a++)
    for (int c = 0; c < 3; c++)
      at->gradient[a][c] = scale * ((by[a][1] - by[a][0]) * (vv * u[c] - uv * v[c]) +
                                    (by[a][2] - by[a][0]) * (uu * v[c] - uv * u[c]));
}

/* C_s, Q^-1 and (C n) Q^-1. Column i of B is the strain of the displacement gradient e_i n^T. */
static void free_surface(const double c[36], bwi_facet_corner *at) {
  const double *n = at->normal;
  const double b[3][6] = {
      {n[0], 0, 0, 0, n[2], n[1]}, {0, n[1], 0, n[2], 0, n[0]}, {0, 0, n[2], n[1], n[0], 0}};
  double cb[3][6], q[9];
  for (int i = 0; i < 3; i++)
    bwi_multiply6(c, b[i], cb[i]);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      q[3 * i + j] = bwi_dot6(b[i], cb[j]);
  bw_inverse3(q, at->softness);
  for (int r = 0; r < 6; r++)
    for (int j = 0; j < 3; j++)
      at->by_traction[3 * r + j] = cb[0][r] * at->softness[j] + cb[1][r] * at->softness[3 + j] +
                                   cb[2][r] * at->softness[6 + j];
  for (int r = 0; r < 6; r++)
    for (int s = 0; s < 6; s++)
      at->elasticity[6 * r + s] = c[6 * r + s] - (at->by_traction[3 * r] * cb[0][s] +
                                                  at->by_traction[3 * r + 1] * cb[1][s] +
                                                  at->by_traction[3 * r + 2] * cb[2][s]);
}

void bwi_facet_corner_load(const bw_mesh *mesh, const bw_material *material, int32_t corner,
                           bwi_facet_corner *at) {
  at->nodes = mesh->nodes_per_facet;
  at->node = mesh->facet + (size_t)(corner / 3) * (size_t)at->nodes;
  surface_gradients(mesh, corner % 3, at);
  free_surface(bw_material_elasticity(material, mesh->facet_element[corner / 3]), at);
}

void bwi_facet_corner_strain(const bwi_facet_corner *at, const double *displacement, double full[9],
                             double strain[6]) {
  memset(full, 0, 9 * sizeof *full);
  for (int a = 0; a < at->nodes; a++)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        full[3 * i + j] += displacement[3 * (size_t)at->node[a] + (size_t)i] * at->gradient[a][j];
  for (int i = 0; i < 3; i++)
    strain[i] = full[4 * i];
  strain[3] = full[5] + full[7];
  strain[4] = full[6] + full[2];
  strain[5] = full[1] + full[3];
}

void bwi_facet_corner_functional(const bw_mesh *mesh, const bw_material *material, int32_t corner,
                                 const double tensor[6], double *force) {
  bwi_facet_corner at;
  double s[6];
  bwi_facet_corner_load(mesh, material, corner, &at);
  bwi_conjugate_stress(at.elasticity, tensor, s);
  const double full[3][3] = {{s[0], s[5], s[4]}, {s[5], s[1], s[3]}, {s[4], s[3], s[2]}};
  for (int a = 0; a < at.nodes; a++)
    for (int c = 0; c < 3; c++)
      force[3 * (size_t)at.node[a] + (size_t)c] += bw_dot(full[c], at.gradient[a]);
}

bw_status bwi_facet_areas_around(bw_context *context, const bw_mesh *mesh, double **area) {
  double *sum = *area = BW_NEW0(context, double, mesh->node_count);
  if (!sum)
    return BW_MEMORY;
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
    double own = bwi_facet_area(mesh, f);
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      sum[node[a]] += own;
  }
  return BW_OK;
}

void bwi_facet_traction(const bw_mesh *mesh, const double *area, const double *force, int32_t facet,
                        double traction[3]) {
  const int32_t *node = mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
  for (size_t c = 0; c < 3; c++) {
    traction[c] = 0;
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      traction[c] += force[3 * (size_t)node[a] + c] / area[node[a]];
  }
}

void bwi_facet_corner_by_force(const bw_mesh *mesh, const bw_material *material, const double *area,
                               int32_t corner, const double tensor[6], double *by_force) {
  bwi_facet_corner at;
  bwi_facet_corner_load(mesh, material, corner, &at);
  for (size_t c = 0; c < 3; c++) {
    double column[6];
    for (size_t r = 0; r < 6; r++)
      column[r] = at.by_traction[3 * r + c];
    double slope = bwi_dot_tensor(tensor, column);
    for (int a = 0; a < at.nodes; a++)
      by_force[3 * (size_t)at.node[a] + c] += slope / area[at.node[a]];
  }
}

typedef struct field {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *displacement, *force;
  double *area, *stress;
} field;

static bw_status stress_of_corners(void *data, int64_t begin, int64_t end, int worker) {
  const field *d = (const field *)data;
  (void)worker;
  for (int64_t k = begin; k < end; k++) {
    bwi_facet_corner at;
    double full[9], strain[6], traction[3], *stress = d->stress + 6 * k;
    bwi_facet_corner_load(d->mesh, d->material, (int32_t)k, &at);
    bwi_facet_corner_strain(&at, d->displacement, full, strain);
    bwi_multiply6(at.elasticity, strain, stress);
    if (!d->force)
      continue;
    bwi_facet_traction(d->mesh, d->area, d->force, (int32_t)(k / 3), traction);
    for (int r = 0; r < 6; r++)
      stress[r] += bw_dot(at.by_traction + 3 * r, traction);
  }
  return BW_OK;
}

bw_status bw_surface_stress(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                            const double *displacement, const double *force, double *stress) {
  field d = {mesh, material, displacement, force, NULL, stress};
  bw_status status;
  BW_TRY(bwi_check_stress_input(context, mesh, material, displacement, "a surface stress"));
  if (force)
    BW_TRY(bwi_facet_areas_around(context, mesh, &d.area));
  BW_TRY(bw_parallel(context, 3 * (int64_t)mesh->facet_count, CORNERS_PER_CHUNK, stress_of_corners,
                     &d));
done:
  bw_free(d.area);
  return status;
}
