/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_MODEL_INP_JOINTS_H
#define BWI_MODEL_INP_JOINTS_H

#include "barwright/model.h"
#include "io/inp_joints.h"

/* The joints of a model in a deck, of a frequency step or a static one. Marks in `joined`
 * (node_count) the nodes whose supports they contain. BW_UNSUPPORTED for prescribed values of a
 * distributed coupling, and in a frequency step for an inertia that no body has. */
bw_status bwi_inp_joints_make(bw_context *context, const bw_model *model, const bw_dof_map *dof_map,
                              const char *path, bool frequency, bwi_inp_joints *j, uint8_t *joined);
/* Adds the weight of attached masses to forces (N, node_count x 3). */
void bwi_inp_add_weights(const bw_model *model, double *force);

#endif
