/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files local*.c share: the inside of a system that follows edits.
 *
 * Invariants. Numbering and stiffness are of the model last synchronised. The factor is that of the
 * stiffness when it was last brought up to date; since then the domains marked in `touched` have
 * changed in the frames of their nodes, and no others: with no mark it is the factor of the present
 * stiffness, whatever has turned. It is always applied in the present frames. `symbolic` fits the
 * present unknowns; the factor is dropped when they change and when an update of it fails. */
#ifndef BWI_SOLVE_LOCAL_H
#define BWI_SOLVE_LOCAL_H

#include "solve/internal.h"

typedef struct bwi_local {
  const bw_model *rest;  /* retained: all domains at rest */
  const bw_model *model; /* retained: last synchronised */
  bool material_turns;
  int32_t domain_count;
  int32_t *element_domain, *node_domain;
  bw_domain_motion *motion; /* since rest */
  double *frame;            /* domain_count x 9: those of `motion` */
  uint8_t *touched;         /* domain_count */
  bwi_factor *factor;       /* or NULL */
} bwi_local;

/* Whether the factor is that of the present stiffness. */
bool bwi_local_current(const bw_local_system *local);

#endif
