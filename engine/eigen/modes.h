/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_EIGEN_MODES_H
#define BWI_EIGEN_MODES_H

#include "eigen/internal.h"

bw_status bwi_modes_options_check(bw_context *context, const bw_modes_options *given,
                                  bw_modes_options *options);
/* A bw_modes object from an eigenvalue result, whose arrays it takes over; elastic modes with a
 * material, Laplacian ones without. */
bw_status bwi_modes_from(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                         int rigid_count, bwi_eigen_result *result, bw_modes **modes);
/* As bw_modes_elastic, of equations in this process. */
bw_status bwi_modes_elastic(bw_context *context, bw_system *system, const bw_modes_options *options,
                            bw_modes **modes);
/* The modes of a model with a factor or without one; as bw_modes_of_model, but for external
 * solvers. */
bw_status bwi_modes_of_model(bw_context *context, const bw_model *model, bw_system *given,
                             const bw_modes_options *options, bw_system **system, bw_modes **modes);

#endif
