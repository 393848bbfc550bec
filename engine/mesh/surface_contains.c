/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which points a closed surface holds: a segment from each to the outside crosses it an odd number
 * of times. */
#include "mesh/surface_contains.h"

#include <string.h>

void bwi_container_clear(bwi_container *c) {
  bwi_tree_destroy(c->tree);
  bwi_topology_destroy(c->topology);
  *c = (bwi_container){NULL, NULL, 0, {0}, {0}};
}

bw_status bwi_container_create(bw_context *context, const bw_surface *surface, bwi_container *c) {
  bw_status status = BW_OK;
  double d[3];
  *c = (bwi_container){NULL, NULL, 0, {0}, {0}};
  bw_surface_box(surface, c->low, c->high);
  for (int k = 0; k < 3; k++)
    d[k] = c->high[k] - c->low[k];
  c->size = 2 * bw_norm(d);
  BW_TRY(bwi_topology_create(context, surface, &c->topology));
  BW_TRY(bwi_tree_create(context, c->topology->point, surface->triangle_count, c->topology->corner,
                         c->topology->degenerate, &c->tree));
done:
  if (status != BW_OK)
    bwi_container_clear(c);
  return status;
}

bw_status bwi_container_holds(bw_context *context, const bwi_container *c, const double x[3],
                              bool *inside, bool *unclear) {
  *inside = *unclear = false;
  for (int k = 0; k < 3; k++)
    if (!(x[k] >= c->low[k] && x[k] <= c->high[k]))
      return BW_OK;
  return bwi_inside(context, c->topology, c->tree, x, c->size, inside, unclear);
}

bw_status bw_surface_contains(bw_context *context, const bw_surface *surface, int64_t count,
                              const double *at, uint8_t *inside) {
  bw_status status;
  bw_surface_report report = {0};
  bwi_container c = {NULL, NULL, 0, {0}, {0}};
  BW_TRY(bw_surface_check(context, surface, 0, &report));
  if (!report.closed)
    BW_TRY(bw_fail(context, BW_GEOMETRY,
                   "the surface is not closed (%lld open edges): it has no inside; repair it first",
                   (long long)report.count[BW_DEFECT_OPEN_EDGE]));
  BW_TRY(bwi_container_create(context, surface, &c));
  for (int64_t i = 0; i < count; i++) {
    bool in, unclear;
    if (i % 4096 == 0)
      BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_container_holds(context, &c, at + 3 * i, &in, &unclear));
    inside[i] = in || unclear;
  }
done:
  bw_surface_report_clear(&report);
  bwi_container_clear(&c);
  return status;
}
