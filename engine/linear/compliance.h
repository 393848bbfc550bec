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

/* How a system gives compliances. */
typedef struct bwi_compliance {
  bw_system *system; /* borrowed */
  bool by_halves;    /* of solves: the system has a factor of doubles of the engine's own */
  double *relaxed;   /* (6 x size) where bodies are free: Z = A^-1 W R, each body's k-th motion */
  double *inertia;   /* (motions x 6) R^T W Z, body by body */
  int32_t *body;     /* (node_count) */
} bwi_compliance;
/* Those of bw_system_solve. */
bw_status bwi_compliance_open(bw_context *context, bw_system *system, bwi_compliance *compliance);
void bwi_compliance_close(bwi_compliance *compliance);
/* Rows and columns from `first` on of `matrix` (count x count); the others are left as they are.
 * Statuses of bw_system_solve. */
bw_status bwi_compliance_of(bw_context *context, const bwi_compliance *compliance,
                            const bwi_nodal_columns *columns, int first, double *matrix);

#endif
