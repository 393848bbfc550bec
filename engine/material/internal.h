/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of material share. */
#ifndef BARWRIGHT_MATERIAL_INTERNAL_H
#define BARWRIGHT_MATERIAL_INTERNAL_H

#include "barwright/material.h"

/* A zeroed material with one reference and a name (cut to fit; `fallback` when NULL or empty). */
bw_material *bwi_material_create(bw_context *context, const char *name, const char *fallback);
/* Values from means given by the user: no scatter, no source. */
void bwi_material_values(bw_material *material);
/* BW_INVALID unless density, strengths and toughness are finite and not negative. */
bw_status bwi_material_check_common(bw_context *context, const char *name, double density,
                                    const double strength[3], double toughness);
/* BW_INVALID when a number of the two matrices has left the range of doubles. */
bw_status bwi_material_check_finite(bw_context *context, const bw_material *material);
/* BW_INVALID unless the rows are orthonormal and right-handed (1e-6); cleans them to rounding. */
bw_status bwi_material_check_rotation(bw_context *context, const char *what, double axes[9]);
/* elasticity and compliance of an orthotropic material from its constants and axes. */
bw_status bwi_material_orthotropic_matrices(bw_context *context, bw_material *material);
/* A copy without parts, with one reference. */
bw_material *bwi_material_copy(bw_context *context, const bw_material *material);
/* rotated: rows R e_i of the axes' rows e_i */
void bwi_material_rotate_axes(const double axes[9], const double rotation[9], double rotated[9]);

void bwi_material_parts_destroy(bw_material_parts *parts);

#endif
