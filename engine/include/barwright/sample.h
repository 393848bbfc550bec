/* sample: what meshes and surfaces have at points. */
#ifndef BARWRIGHT_SAMPLE_H
#define BARWRIGHT_SAMPLE_H

#include "barwright/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A nodal field, value (any, node_count x columns), at points, point (m, count x 3): out (any,
 * count x columns) by the shape functions of the element that holds the point, or at the nearest
 * place of the mesh. `locator`: of the mesh. outside (m, count), which may be NULL: the distance of
 * that place from the point, 0 inside. */
BW_API bw_status bw_mesh_sample(bw_context *context, const bw_mesh *mesh, const bw_locator *locator,
                                int columns, const double *value, int64_t count,
                                const double *point, double *out, double *outside);

/* The facet of a surface that is nearest to each point, point (m, count x 3): facet (index, count),
 * the place on it, place (m, count x 3), and how far it is, distance (m, count). Each may be NULL.
 * Of facets that are as near, to 1e-12 of the largest coordinate, the first. BW_GEOMETRY where the
 * surface has no facets. */
BW_API bw_status bw_surface_nearest(bw_context *context, const bw_surface *surface, int64_t count,
                                    const double *point, int32_t *facet, double *place,
                                    double *distance);

#ifdef __cplusplus
}
#endif
#endif
