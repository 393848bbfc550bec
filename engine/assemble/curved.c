/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which tet10 are curved, and so need quadrature, and what is reported of inverted ones. */
#include "assemble/internal.h"

typedef struct search {
  const bw_mesh *mesh;
  int32_t *number;
} search;

static bw_status classify(void *data, int64_t begin, int64_t end, int worker) {
  const search *s = (const search *)data;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    double x[10][3];
    bwi_element_nodes(s->mesh, e, x);
    s->number[e] = bw_tet_is_straight((const double(*)[3])x) ? -1 : 0;
  }
  return BW_OK;
}

bw_status bwi_find_curved(bw_context *context, const bw_mesh *mesh, int32_t **number,
                          int64_t *count) {
  bw_status status = BW_OK;
  *number = NULL;
  *count = 0;
  if (mesh->order == 1)
    return BW_OK;
  search s = {mesh, BW_NEW(context, int32_t, mesh->element_count)};
  if (!s.number)
    return BW_MEMORY;
  BW_TRY(bw_parallel(context, mesh->element_count, 1024, classify, &s));
  int32_t curved = 0;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (s.number[e] == 0)
      s.number[e] = curved++;
  *count = curved;
  if (curved) {
    *number = s.number;
    return BW_OK;
  }
done:
  bw_free(s.number);
  return status;
}

bw_status bwi_fail_inverted(bw_context *context, const bw_mesh *mesh, int64_t element,
                            double determinant) {
  double at[3] = {0};
  for (int a = 0; a < 4; a++)
    for (int k = 0; k < 3; k++)
      at[k] +=
          0.25 * mesh->node[3 * (int64_t)mesh->element[element * mesh->nodes_per_element + a] + k];
  bw_status status = bw_fail(
      context, BW_GEOMETRY,
      "element %lld near (%g, %g, %g) m is %s: the Jacobian determinant there is %g m3, and must "
      "be positive; move its %s or mesh again",
      (long long)element + 1, at[0], at[1], at[2], determinant < 0 ? "inverted" : "flat",
      determinant, mesh->order == 2 ? "mid-edge nodes" : "nodes");
  bw_detail_number(context, "element", (double)(element + 1));
  bw_detail_number(context, "determinant", determinant);
  return status;
}

/* The mean volumetric strain couples a node's x with another's y, and not y with x. */
bw_status bwi_blocks_even(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                          bool *even) {
  int32_t *number = NULL;
  int64_t curved = 0;
  bw_status status = bwi_find_curved(context, mesh, &number, &curved);
  *even = curved == 0 && !material->parts && !(bw_material_projected_bulk(material) > 0);
  bw_free(number);
  return status;
}
