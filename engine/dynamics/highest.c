/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A bound of a mesh's natural frequencies: none is above the highest one of its elements, each by
 * itself and free. */
#include <math.h>

#include "barwright/assemble.h"
#include "dynamics/internal.h"
#include "linear/blas.h"

enum { NODES = 10 };

static const double pi = 3.14159265358979323846;

/* The trace of M^-1 K of an element: the sum of its eigenvalues ((rad/s)^2). */
static bw_status sum_eigenvalues(bw_context *context, const bw_mesh *mesh,
                                 const bw_material *material, int32_t element, double *sum) {
  double x[NODES][3], stiffness[9 * NODES * NODES], mass[NODES * NODES], by[NODES * NODES];
  int n = mesh->nodes_per_element, pivot[NODES], info = 0;
  const int32_t *node = mesh->element + (size_t)element * (size_t)n;
  for (int a = 0; a < n; a++)
    for (int k = 0; k < 3; k++)
      x[a][k] = mesh->node[3 * (size_t)node[a] + (size_t)k];
  bw_status status =
      bw_element_stiffness(context, mesh->order, (const double(*)[3])x, material, stiffness);
  if (status != BW_OK)
    return status;
  bw_element_mass(mesh->order, (const double(*)[3])x, mass);
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++) {
      by[a * n + b] = 0;
      for (int k = 0; k < 3; k++)
        by[a * n + b] += stiffness[(3 * a + k) * 3 * n + 3 * b + k];
    }
  dgesv_(&n, &n, mass, &n, pivot, by, &n, &info);
  *sum = info == 0 ? 0 : INFINITY;
  for (int a = 0; a < n; a++)
    *sum += by[a * n + a] / material->density;
  return BW_OK;
}

bw_status bwi_frequency_bound(bw_context *context, const bw_model *model, double *bound) {
  const bw_mesh *mesh = model->mesh;
  double most = 0, sum;
  *bound = INFINITY; /* springs add stiffness to that of the elements */
  for (int k = 0; k < model->attachment_count; k++)
    if (bw_norm(model->attachment[k].stiffness) > 0)
      return BW_OK;
  for (int p = 0; p < model->coupling_count; p++)
    for (int k = 0; k < 6; k++)
      if (model->coupling[p].point.spring[k] > 0)
        return BW_OK;
  for (int32_t i = 0; i < mesh->element_count; i++) {
    bw_status status = i % 1000 == 0 ? bw_check_cancel(context) : BW_OK;
    if (status == BW_OK)
      status = sum_eigenvalues(context, mesh, bw_material_of(model->material, i), i, &sum);
    if (status != BW_OK)
      return status;
    most = fmax(most, sum);
  }
  *bound = sqrt(most) / (2 * pi);
  return BW_OK;
}
