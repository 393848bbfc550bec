/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the parts of the worst-case search share. */
#ifndef BARWRIGHT_ANALYSIS_WORST_INTERNAL_H
#define BARWRIGHT_ANALYSIS_WORST_INTERNAL_H

#include "analysis/programme.h"

/* Pressures that are constant on patches: column k is the sum of the basis's columns in patch k,
 * its node the patch's seed. Patches never span two bodies. At least one per body, at most
 * basis->count; `patches` otherwise. Seeds are chosen by farthest points; the metric sees position
 * and normal, so that the two sides of a thin wall belong to different patches. */
bw_status bwi_pressure_patches(bw_context *context, const bw_pressure_basis *basis, int32_t patches,
                               bw_pressure_basis **coarse);

/* Spherical triangles that cover a half sphere, so that of every direction n or -n lies in one. */
enum { BWI_HALF_ICOSAHEDRON = 10 };
typedef struct bwi_triangle {
  double corner[3][3]; /* unit vectors */
} bwi_triangle;
void bwi_half_icosahedron(bwi_triangle *face);

#endif
