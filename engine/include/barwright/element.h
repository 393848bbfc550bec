/* element: shape functions and quadrature of tet4, tet10 and their facets, tri3 and tri6. */
#ifndef BARWRIGHT_ELEMENT_H
#define BARWRIGHT_ELEMENT_H

#include "barwright/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Values of the shape functions at a point: value (-, 4 or 10). */
BW_API void bw_tet_shape(int order, const double barycentric[4], double *value);
/* Their derivatives by the barycentric coordinates L0..L3: gradient (-, 4 or 10 x 4). */
BW_API void bw_tet_shape_gradient(int order, const double barycentric[4], double (*gradient)[4]);
/* Values of the shape functions of a facet at a point: value (-, 3 or 6). */
BW_API void bw_facet_shape(int order, const double barycentric[3], double *value);

enum { BW_QUADRATURE_POINTS = 64 /* a bound on the points of a rule */ };
/* A quadrature rule on the tetrahedron that is exact for polynomials to `degree` (1 to 6):
 * barycentric coordinates, point (-, BW_QUADRATURE_POINTS x 4), and weights that sum to one, weight
 * (-, BW_QUADRATURE_POINTS). Returns the number of points that it has; the rest of the arrays is
 * not written. */
BW_API int bw_tet_quadrature(int degree, double (*point)[4], double *weight);
/* The same on the triangle, to `degree` (1 to 6): point (-, BW_QUADRATURE_POINTS x 3), weight (-,
 * BW_QUADRATURE_POINTS). */
BW_API int bw_triangle_quadrature(int degree, double (*point)[3], double *weight);

/* Gradients in space of the shape functions of an element with node positions x (m, 4 or 10 x 3) at
 * a point: gradient (1/m, 4 or 10 x 3). Returns the Jacobian determinant (m3), 6 times the volume
 * for straight elements. */
BW_API double bw_tet_gradient(int order, const double (*x)[3], const double barycentric[4],
                              double (*gradient)[3]);
/* Gradients of the barycentric coordinates of a straight tetrahedron with corners x0, x1, x2, x3
 * (m, 3): gradient (1/m). Returns its volume (m3), negative where it is inverted. */
BW_API double bw_tet_barycentric_gradient(const double *x0, const double *x1, const double *x2,
                                          const double *x3, double gradient[4][3]);
/* True when all mid-edge nodes of a quadratic element x (m, 10 x 3) lie on the middles of their
 * edges (relative 1e-9): closed forms hold. */
BW_API bool bw_tet_is_straight(const double (*x)[3]);

/* Derivatives of the shape functions of a triangle by barycentric coordinates: gradient (-, 3 or 6
 * x 3). The values are those of bw_facet_shape. */
BW_API void bw_triangle_shape_gradient(int order, const double barycentric[3],
                                       double (*gradient)[3]);
/* Gradients in the plane of the shape functions of a triangle with node positions x (m, 3 or 6 x
 * 2): gradient (1/m, 3 or 6 x 2). Returns the Jacobian determinant (m2), twice the area for
 * straight sides, negative for clockwise triangles. */
BW_API double bw_triangle_gradient(int order, const double (*x)[2], const double barycentric[3],
                                   double (*gradient)[2]);

#ifdef __cplusplus
}
#endif
#endif
