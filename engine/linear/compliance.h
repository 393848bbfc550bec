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
/* What the forward halves of columns leave for others to come. Zeros at first. */
typedef struct bwi_half_solves {
  int count;                   /* columns so far */
  int32_t super_count;         /* of the factor */
  struct bwi_half_columns *at; /* (super_count) */
} bwi_half_solves;
void bwi_half_solves_clear(bwi_half_solves *kept);
/* Rows and columns from `first` on of `matrix` (count x count); the others are left as they are.
 * `kept` has at most `first` columns of the same system before, and all of them after; empty after
 * a failure. It takes 8 bytes for each column and unknown above its nodes in the factor. NULL: all
 * columns are solved. The system keeps what that takes for bodies that are free. Statuses of
 * bw_system_solve. */
bw_status bwi_compliance_of(bw_context *context, bw_system *system,
                            const bwi_nodal_columns *columns, int first, bwi_half_solves *kept,
                            double *matrix);

#endif
