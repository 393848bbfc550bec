/* element: shape functions and quadrature of tet4, tet10 and their facets, tri3 and tri6. */
#ifndef BARWRIGHT_ELEMENT_H
#define BARWRIGHT_ELEMENT_H

#include "barwright/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Values and gradients (by barycentric coordinates L0..L3) of the 4 or 10 shape functions. */
BW_API void bw_tet_shape(int order, const double barycentric[4], double *value);
BW_API void bw_tet_shape_gradient(int order, const double barycentric[4], double (*gradient)[4]);
/* Values of the 3 or 6 shape functions of a facet. */
BW_API void bw_facet_shape(int order, const double barycentric[3], double *value);

/* Quadrature on the tetrahedron and the triangle exact to `degree` (1..6 and 1..6): weights sum to
 * one. Returns the number of points (at most BW_QUADRATURE_POINTS); barycentric coordinates. */
enum { BW_QUADRATURE_POINTS = 64 };
BW_API int bw_tet_quadrature(int degree, double (*point)[4], double *weight);
BW_API int bw_triangle_quadrature(int degree, double (*point)[3], double *weight);

/* Gradients in space of the shape functions of an element with node positions x at a point;
 * returns the Jacobian determinant (6 times the volume for straight elements). */
BW_API double bw_tet_gradient(int order, const double (*x)[3], const double barycentric[4],
                              double (*gradient)[3]);
/* Gradients of the four barycentric coordinates of a straight tetrahedron; returns its volume. */
BW_API double bw_tet_barycentric_gradient(const double *x0, const double *x1, const double *x2,
                                          const double *x3, double gradient[4][3]);
/* True when all mid-edge nodes lie on the middles of their edges (relative 1e-9): closed forms
 * hold. */
BW_API bool bw_tet_is_straight(const double (*x)[3]);

/* The same for triangles of the plane: values are bw_facet_shape. */
BW_API void bw_triangle_shape_gradient(int order, const double barycentric[3],
                                       double (*gradient)[3]);
/* Gradients in the plane; returns the Jacobian determinant (twice the area for straight sides),
 * negative for clockwise triangles. */
BW_API double bw_triangle_gradient(int order, const double (*x)[2], const double barycentric[3],
                                   double (*gradient)[2]);
/* x: six nodes. */
BW_API bool bw_triangle_is_straight(const double (*x)[2]);

#ifdef __cplusplus
}
#endif
#endif
