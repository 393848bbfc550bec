/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_SOLVE_MODES_H
#define BWI_SOLVE_MODES_H

#include "solve/internal.h"

bw_status bwi_modes_options_check(bw_context *context, const bw_modes_options *given,
                                  bw_modes_options *options);
/* A bw_modes object from an eigenvalue result, whose arrays it takes over. */
bw_status bwi_modes_from(bw_context *context, const bw_mesh *mesh, int components, int rigid_count,
                         bool frequencies, bwi_eigen_result *result, bw_modes **modes);

#endif
