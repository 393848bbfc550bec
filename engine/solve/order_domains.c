/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elimination orders for edits by domains. */
#include "solve/internal.h"

bw_status bwi_order_create_domains(bw_context *context, const bw_graph *graph, const uint8_t *take,
                                   const bw_mesh *mesh, int32_t domain_count,
                                   const int32_t *element_domain, bwi_order **order) {
  (void)mesh;
  (void)domain_count;
  (void)element_domain;
  return bwi_order_create(context, graph, take, order);
}
