/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sweeps over vertex stars, the smoother of two_level.h for bodies that are nearly incompressible.
 *
 * The star of a corner has the corner and the mid-edge nodes of all its edges, about 15 nodes. Its
 * equations are solved together, by an inverse in doubles, and each mid-edge node is in the stars
 * of both its corners. Motions that keep the volume of every element have parts in single stars,
 * and none at single nodes (docs/theory/preconditioners.md).
 *
 * Stars of one colour have no element and no neighbour in common. They are solved side by side, and
 * colours one after the other. Colours depend on the mesh alone: the same bits for any number of
 * threads. A star has what it reads in a row: its inverse, and K between its nodes and those next
 * to them. */
#ifndef BWI_LINEAR_STARS_H
#define BWI_LINEAR_STARS_H

#include "linear/two_level.h"

/* Over the blocks below the diagonal of K (boxes): bytes that a sweep forwards and one backwards
 * read, bytes that stars take, and what making them costs, as operations. */
#define BWI_STARS_READ 370.0
#define BWI_STARS_BYTES 190.0
#define BWI_STARS_FLOPS 2500.0

/* Of the shape that the preconditioner follows. *stars is NULL where the equations of a star are
 * not positive definite, or so badly conditioned that floats do not tell. Release with bw_release.
 */
bw_status bwi_stars_create(bw_context *context, const bwi_two_level *two_level,
                           const double *stiffness, bwi_stars **stars);
/* z = what a sweep over all stars makes of r, from z = 0, and residual = r - K z, where it is of no
 * meaning off the unknowns. For fields as in smoother.h. */
bw_status bwi_stars_forward(bw_context *context, const bwi_stars *stars, int width, const float *r,
                            float *z, float *residual);
/* Each star's equations hold in its turn, those swept last first: z as the equations of the first
 * one leave it. */
bw_status bwi_stars_backward(bw_context *context, const bwi_stars *stars, int width, const float *r,
                             float *z);
/* Bytes that a sweep forwards and one backwards read. */
double bwi_stars_read(const bwi_stars *stars);

#endif
