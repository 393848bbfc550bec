/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of responsive/ share. */
#ifndef BWI_RESPONSIVE_INTERNAL_H
#define BWI_RESPONSIVE_INTERNAL_H

#include <string.h>

#include "assemble/plane_matrix.h"
#include "barwright/responsive.h"

/* A copy of a block of numbers (NULL: of none), for the caller to free. */
static inline bw_status bwi_copy_block(bw_context *context, const double *from, size_t count,
                                       double **to) {
  *to = NULL;
  if (!from)
    return BW_OK;
  *to = BW_NEW(context, double, count);
  if (!*to)
    return BW_MEMORY;
  memcpy(*to, from, count * sizeof **to);
  return BW_OK;
}

/* ---- conditions (conditions.c) ------------------------------------------------------------- */

/* BW_INVALID for components, tags and values that are none, BW_EMPTY for tags without a segment. */
bw_status bwi_conditions_check(bw_context *context, const bw_plane_mesh *mesh, int components,
                               int32_t count, const bw_condition *condition);
/* A copy of conditions for another outline, by the names of their tags; BW_INVALID where it has
 * none of a name. */
bw_status bwi_conditions_renamed(bw_context *context, const bw_outline *from, const bw_outline *to,
                                 int32_t count, const bw_condition *condition, bw_condition **out);
/* A copy without changes. */
bw_status bwi_conditions_copy(bw_context *context, int32_t count, const bw_condition *condition,
                              bw_condition **out);
/* Whether two lists have the same kinds and components. */
bool bwi_conditions_alike(int32_t count, const bw_condition *a, const bw_condition *b);
/* Copies the tags of one list to another; kinds, components and values there stay. */
void bwi_conditions_take_tags(int32_t count, const bw_condition *from, bw_condition *to);
/* Whether a condition's tag is that of a side, and its value at a place (BW_INVALID: not
 * finite). */
bool bwi_condition_applies(const bw_plane_mesh *mesh, const bw_condition *condition, int32_t side);
bw_status bwi_condition_value(bw_context *context, const bw_condition *condition,
                              const double at[2], double time, double *value);
/* Gauss points on 0..1, exact to degree 5. */
enum { BWI_SIDE_POINTS = 3 };
extern const double bwi_side_at[BWI_SIDE_POINTS], bwi_side_weight[BWI_SIDE_POINTS];
/* Shape functions of a side of 2 or 3 nodes (start, end, middle) at t in 0..1, and by t; the place
 * there and its derivative by t. */
void bwi_side_shape(int width, double t, double n[3], double d[3]);
void bwi_side_place(const bw_plane_mesh *mesh, const int32_t *node, int width, const double *n,
                    const double *d, double at[2], double along[2]);
/* bw_conditions_force with a thickness for each region (or one: thickness_count 1). A side takes
 * that of the element beside it; between two regions, of the one on its left, which pressure
 * presses on. */
bw_status bwi_conditions_force(bw_context *context, const bw_plane_mesh *mesh, int components,
                               int32_t count, const bw_condition *condition, double time,
                               int32_t thickness_count, const double *thickness, double *force);
/* Add to gradient (node_count x 2) what sum_i weight_i force_i changes by with the nodes; the
 * values of functions go with the nodes. */
bw_status bwi_conditions_force_gradient(bw_context *context, const bw_plane_mesh *mesh,
                                        int32_t count, const bw_condition *condition, double time,
                                        int32_t thickness_count, const double *thickness,
                                        const double *weight, double *gradient);

#endif
