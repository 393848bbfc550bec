/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the parts of the worst-case search share. */
#ifndef BARWRIGHT_ANALYSIS_WORST_INTERNAL_H
#define BARWRIGHT_ANALYSIS_WORST_INTERNAL_H

#include <math.h>

#include "analysis/load_program.h"

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
void bwi_half_icosahedron(bwi_triangle *face); /* one of each pair of opposite faces */
/* The centre, and cos(2 delta) of the largest angle delta from it to a corner. A spherical triangle
 * smaller than a half sphere lies within the cap of its corners. */
double bwi_triangle_centre(const bwi_triangle *triangle, double centre[3]);
void bwi_divide_triangle(const bwi_triangle *triangle, bwi_triangle part[4]);

/* The mean stresses of elements under a unit of each pressure, from one solve for each pressure.
 * Displacements are kept for a slab of elements at a time, as many as fit into `max` bytes. */
typedef struct bwi_responses {
  bw_context *context;
  bw_system *system;
  const bw_pressure_basis *basis;
  size_t max;
  int32_t *order;       /* element_count: the elements along the longest side of the box */
  int32_t first, count; /* the slab: order[first] to order[first + count - 1] */
  int32_t *place;       /* node_count: of a node among those of the slab, or -1 */
  int32_t *node;        /* the slab's nodes */
  int32_t node_count, capacity;
  double *displacement;          /* slab's nodes x 3 x pressures */
  double *block;                 /* several displacements of all nodes */
  int32_t pressure, block_count; /* whose */
} bwi_responses;
bw_status bwi_responses_open(bw_context *context, bw_system *system, const bw_pressure_basis *basis,
                             size_t max, bwi_responses *responses);
/* The next slab: a multiple of `batch` elements but for the last one. count is 0 behind it. */
bw_status bwi_responses_next(bwi_responses *responses, int32_t batch);
/* 6 x pressures (xx yy zz yz zx xy) of an element of the slab. */
void bwi_response_of(const bwi_responses *responses, int32_t element, double *response);
void bwi_responses_close(bwi_responses *responses);

/* Round multipliers of one vector to few digits. */
void bwi_round_multipliers(int32_t count, double *y);
/* Add a leaf with rounded multipliers: for all directions (cell 0) 6 x motions and that of the
 * total; for a triangle motions and that of the total, for both signs. */
bw_status bwi_keep_leaf(bw_context *context, bw_bound_leaves *leaves, int64_t cell, double bound,
                        int32_t motions, const double *y);
bw_status bwi_append_leaves(bw_context *context, bw_bound_leaves *leaves, int32_t element,
                            const bw_bound_leaves *more);

/* The largest size of a principal stress. */
static inline double bwi_largest_principal(const double stress[6]) {
  double value[3];
  bw_eigen3(stress, value, NULL);
  return fmax(fabs(value[0]), fabs(value[2]));
}

#endif
