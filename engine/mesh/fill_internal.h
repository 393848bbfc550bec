/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of filling share. */
#ifndef BWI_FILL_INTERNAL_H
#define BWI_FILL_INTERNAL_H

#include "mesh/tetgen_run.h"

/* A point strictly inside every cavity of a closed surface without intersections: shells are nested
 * by containment alone, whatever way they face; those inside an odd number of others bound
 * cavities, all others bodies. *hole is a block of *holes points for bw_free. */
bw_status bwi_find_cavities(bw_context *context, const bw_surface *surface, double **hole,
                            int32_t *holes);

/* Cut the edges of a surface that are longer than the size field asks for (times `slack`), always
 * the longest edge of a triangle first, so that shapes stay as good as they were; the surface does
 * not move. Stops at `limit` triangles, or after `seconds` (0: no limit), with BW_LIMIT. */
bw_status bwi_refine_surface(bw_context *context, const bw_surface *surface,
                             const bwi_size_field *field, double slack, int64_t limit,
                             double seconds, bw_surface **refined);

/* Collapse edges shorter than `shorter` of a sound surface, keeping it sound, and exchange
 * diagonals for better shapes; no edge grows much longer than `length`. Where walls are too thin it
 * stays finer. After `seconds` (0: no limit) what has been reached, sound too, is the result. */
bw_status bwi_coarsen_surface(bw_context *context, const bw_surface *surface, double length,
                              double shorter, double error, double seconds, bw_surface **coarsened);

/* Take flat elements off the boundary: those with a dihedral angle below `angle`, where it stays a
 * manifold. *gone counts them, *moved is the largest height of one. *mesh (order 1) is replaced. */
bw_status bwi_peel_flat(bw_context *context, bw_mesh **mesh, double angle, int64_t *gone,
                        double *moved);

#endif
