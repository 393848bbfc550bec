/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The compliance C = F^T G F of a body at nodal forces F of few nodes each, with the G of
 * bw_system_solve (docs/theory/contact.md, "Cost"). */
#ifndef BWI_LINEAR_COMPLIANCE_H
#define BWI_LINEAR_COMPLIANCE_H

#include "barwright/linear.h"

/* Column j of F has the forces force[3 k] at node[k], for k from start[j] to start[j + 1] - 1. */
typedef struct bwi_nodal_columns {
  int count;
  const int64_t *start; /* (count + 1) */
  const int32_t *node;
  const double *force;
} bwi_nodal_columns;

/* Whether half of each solve is enough: the system has a factor of doubles of the engine's own. */
bool bwi_compliance_by_halves(const bw_system *system);
/* Rows and columns from `first` on of `matrix` (count x count); the others are left as they are.
 * The system keeps what that takes for bodies that are free. Statuses of bw_system_solve. */
bw_status bwi_compliance_of(bw_context *context, bw_system *system,
                            const bwi_nodal_columns *columns, int first, double *matrix);

#endif
