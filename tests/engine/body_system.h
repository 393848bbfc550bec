/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Equations with a factor of a body whose supports are a DOF map: bw_system_of_model without a
 * model and without a choice. */
#ifndef BODY_SYSTEM_H
#define BODY_SYSTEM_H

#include "barwright/job.h"
#include "linear/internal.h"

/* `previous` (may be NULL): a system whose pattern, ordering and analysis are reused where they
 * fit. */
static inline bw_status body_system(bw_context *context, const bw_mesh *mesh,
                                    const bw_material *material, const bw_dof_map *dof_map,
                                    const bw_system *previous, bw_system **out) {
  bw_status status = BW_OK;
  bw_system *system = NULL;
  *out = NULL;
  if (!bwi_system_reusable(previous, mesh))
    previous = NULL;
  BW_TRY(bwi_system_begin(context, mesh, material, dof_map, previous, &system));
  BW_TRY(bwi_system_factor(context, system, NULL, previous ? previous->factor->symbolic : NULL,
                           bw_available_memory()));
done:
  if (status == BW_OK)
    *out = system;
  else
    bw_release(system);
  return status;
}

#endif
