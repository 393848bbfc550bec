/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of the stress gradient share.
 *
 * A derivative by the shape is a covector on corner positions: gradient[3 i + c] is by component c
 * of corner node i. Edges stay straight, so mid-edge nodes are no variables of their own. */
#ifndef BARWRIGHT_GRADIENT_H
#define BARWRIGHT_GRADIENT_H

#include "analysis/strain.h"

/* gradient += d (adjoint . f) for one load on facets (pressure, traction, force, torque), with the
 * adjoint's nodal values fixed: node_count x 3 both. */
bw_status bwi_gradient_surface_load(bw_context *context, const bw_model *model, const bw_load *load,
                                    const double *adjoint, double *gradient);

#endif
