/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Where stresses and fluxes of heat are recovered: at nodes, and at nodes on an interface between
 * materials once for each of them, since they jump there. A material whose axes turn from element
 * to element is one. */
#include "model/internal.h"

bw_status bw_stress_points_create(bw_context *context, const bw_mesh *mesh,
                                  const bw_material *material, bw_stress_points *points) {
  bw_status status = BW_OK;
  int64_t width = mesh->nodes_per_element;
  size_t capacity = (size_t)mesh->node_count;
  bw_stress_points p = {.count = mesh->node_count};
  BW_TRY(bw_material_fits(context, material, mesh->element_count));
  if (!bw_material_mixed(material))
    goto done;
  p.point = BW_NEW(context, bw_stress_point, capacity);
  p.of_corner = BW_NEW(context, int32_t, mesh->element_count * width);
  BW_TRY_MEMORY(p.point && p.of_corner);
  for (int32_t i = 0; i < mesh->node_count; i++)
    p.point[i] = (bw_stress_point){.node = i, .next = -1};
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const bw_material *own = bw_material_unrotated(material, e);
    for (int64_t k = e * width; k < (e + 1) * width; k++) {
      int32_t node = mesh->element[k], at = node;
      while (at >= 0 && p.point[at].material && p.point[at].material != own)
        at = p.point[at].next;
      if (at < 0) {
        if (p.count == INT32_MAX)
          BW_TRY(bw_fail(context, BW_LIMIT, "more than %d points of stresses", INT32_MAX));
        BW_TRY_MEMORY(
            bw_grow(context, (void **)&p.point, &capacity, (size_t)p.count, 1, sizeof *p.point));
        at = p.count++;
        p.point[at] = (bw_stress_point){.node = node, .next = p.point[node].next};
        p.point[node].next = at;
      }
      p.point[at].material = own;
      p.of_corner[k] = at;
    }
  }
done:
  if (status == BW_OK)
    *points = p;
  else
    bw_stress_points_clear(&p);
  return status;
}

void bw_stress_points_clear(bw_stress_points *points) {
  bw_free(points->point);
  bw_free(points->of_corner);
  *points = (bw_stress_points){0};
}
