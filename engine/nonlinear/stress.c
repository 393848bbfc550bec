/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Cauchy stress of elements, and its means at nodes. */
#include "nonlinear/internal.h"

#include <string.h>

enum { ELEMENTS_PER_CHUNK = 256 };

typedef struct data {
  bw_context *context;
  const bw_solid *solid;
  const double *u;
  double *stress; /* elements x 6 */
} data;

/* sigma = P F^T / J. Its mean over the deformed element is the sum of w P F^T over the sum of w J:
 * nothing is divided by the J of a single point, which may be zero. */
static bw_status elements(void *of, int64_t begin, int64_t end, int worker) {
  const data *d = (const data *)of;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    double t[9], ratio, *out = d->stress + 6 * e;
    memset(out, 0, 6 * sizeof *out);
    if (!bwi_element_kirchhoff(d->solid, (int32_t)e, d->u, t, &ratio))
      return bwi_fail_undefined(d->context, e);
    if (ratio == 0)
      continue;
    out[0] = t[0] / ratio;
    out[1] = t[4] / ratio;
    out[2] = t[8] / ratio;
    out[3] = 0.5 * (t[5] + t[7]) / ratio;
    out[4] = 0.5 * (t[2] + t[6]) / ratio;
    out[5] = 0.5 * (t[1] + t[3]) / ratio;
  }
  return BW_OK;
}

bw_status bw_solid_stress(bw_context *context, const bw_solid *solid, const double *u,
                          double *of_elements, double *of_nodes) {
  bw_status status = BW_OK;
  const bw_grid *grid = solid->grid;
  double *own = NULL, *weight = NULL;
  data d = {context, solid, u, of_elements};
  if (!of_elements) {
    own = BW_NEW(context, double, 6 * (int64_t)grid->element_count);
    if (!own)
      return BW_MEMORY;
    d.stress = own;
  }
  BW_TRY(bw_parallel(context, grid->element_count, ELEMENTS_PER_CHUNK, elements, &d));
  if (!of_nodes)
    goto done;
  weight = BW_NEW0(context, double, grid->node_count);
  BW_TRY_MEMORY(weight);
  memset(of_nodes, 0, 6 * (size_t)grid->node_count * sizeof *of_nodes);
  for (int32_t e = 0; e < grid->element_count; e++)
    for (int c = 0; c < 8; c++) {
      int64_t node = grid->element[8 * (int64_t)e + c];
      double volume = bwi_solid_volume(grid, e);
      weight[node] += volume;
      for (int k = 0; k < 6; k++)
        of_nodes[6 * node + k] += volume * d.stress[6 * (int64_t)e + k];
    }
  for (int64_t i = 0; i < grid->node_count; i++)
    for (int k = 0; k < 6; k++)
      of_nodes[6 * i + k] /= weight[i];
done:
  bw_free(own);
  bw_free(weight);
  return status;
}
