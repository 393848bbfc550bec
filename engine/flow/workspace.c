/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The blocks of memory that the steps of a flow work in. */
#include "flow/internal.h"
#include "responsive/internal.h"

void bwi_flow_workspace_clear(bwi_flow_workspace *workspace) {
  bw_free(workspace->block);
  bw_free(workspace->vector);
  bw_free(workspace->values);
  bw_free(workspace->system);
  bw_free(workspace->load);
  bw_free(workspace->rhs);
  bw_free(workspace->prescribed);
  bw_free(workspace->solution);
  bw_free(workspace->history);
  bw_free(workspace->reaction);
  bw_free(workspace->convect);
  bw_free(workspace->laplacian);
  bw_free(workspace->is_prescribed);
  *workspace = (bwi_flow_workspace){0};
}

bw_status bwi_flow_workspace_make(bw_context *context, const bw_plane_pattern *pattern,
                                  int components, bwi_flow_workspace *workspace) {
  size_t entries = (size_t)pattern->block_count * (size_t)(components * components);
  size_t unknowns = (size_t)pattern->node_count * (size_t)components;
  *workspace = (bwi_flow_workspace){
      .block = BW_NEW(context, double, bwi_plane_workspace_size(pattern, components)),
      .vector = BW_NEW(context, double,
                       3 * (size_t)components * (size_t)pattern->topology->element_count),
      .values = BW_NEW(context, double, entries),
      .system = BW_NEW(context, double, entries),
      .load = BW_NEW(context, double, unknowns),
      .rhs = BW_NEW(context, double, unknowns),
      .prescribed = BW_NEW(context, double, unknowns),
      .solution = BW_NEW(context, double, unknowns),
      .history = BW_NEW(context, double, unknowns),
      .reaction = BW_NEW(context, double, unknowns),
      .convect = BW_NEW(context, double, 2 * (size_t)pattern->node_count),
      .laplacian = BW_NEW(context, double, 3 * (size_t)pattern->topology->element_count),
      .is_prescribed = BW_NEW(context, uint8_t, unknowns),
  };
  if (workspace->block && workspace->vector && workspace->values && workspace->system &&
      workspace->load && workspace->rhs && workspace->prescribed && workspace->solution &&
      workspace->history && workspace->reaction && workspace->convect && workspace->laplacian &&
      workspace->is_prescribed)
    return BW_OK;
  bwi_flow_workspace_clear(workspace);
  return BW_MEMORY;
}
