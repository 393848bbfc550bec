/* A tree of boxes around the facets of a surface: what is near, what a segment may cross, which
 * facets' boxes meet a box.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_MESH_SURFACE_TREE_H
#define BARWRIGHT_MESH_SURFACE_TREE_H

#include "barwright/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bwi_tree bwi_tree;

/* Borrows the arrays. Facets t with skip[t] are left out (skip may be NULL). */
bw_status bwi_tree_create(bw_context *context, const double *point, int64_t triangles,
                          const int32_t *triangle, const uint8_t *skip, bwi_tree **tree);
void bwi_tree_destroy(bwi_tree *tree);

/* Called with a facet whose box meets what was asked for; false ends the search. */
typedef bool bwi_tree_visit(void *data, int32_t facet);
void bwi_tree_in_box(const bwi_tree *tree, const double low[3], const double high[3],
                     bwi_tree_visit *visit, void *data);
void bwi_tree_on_segment(const bwi_tree *tree, const double p[3], const double q[3],
                         bwi_tree_visit *visit, void *data);

/* The facet nearest to x and the place on it; returns the squared distance. `hint`: a facet that is
 * likely near, or -1. The search ends early once a facet lies within sqrt(enough) of x: what comes
 * back then is at most `enough`, not the minimum. An empty tree gives facet -1 and HUGE_VAL. */
double bwi_tree_nearest(const bwi_tree *tree, const double x[3], int32_t hint, double enough,
                        double place[3], int32_t *facet);

/* Whether a facet lies within a distance of x. `hint`: a facet that is likely near, and then the
 * one that was found, if any. */
bool bwi_tree_is_near(const bwi_tree *tree, const double x[3], double limit, int32_t *hint);

/* The lowest of the facets within a distance of x; -1 where none is. */
int32_t bwi_tree_first_within(const bwi_tree *tree, const double x[3], double limit);

/* The place on a triangle nearest to x; returns the squared distance. */
double bwi_nearest_on_triangle(const double x[3], const double a[3], const double b[3],
                               const double c[3], double place[3]);

#ifdef __cplusplus
}
#endif
#endif
