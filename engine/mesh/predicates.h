/* Exact geometric predicates: the sign of a determinant of points, never wrong by rounding.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_MESH_PREDICATES_H
#define BARWRIGHT_MESH_PREDICATES_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* 1 when a, b, c turn counter-clockwise, -1 clockwise, 0 when they lie on a line. */
int bwi_orient2(const double a[2], const double b[2], const double c[2]);
/* The sign of det[b-a, c-a, d-a]: 1 when a, b, c turn counter-clockwise seen from d's other side,
 * that is, when abcd is a tetrahedron of positive volume; 0 when the four lie in a plane. */
int bwi_orient3(const double a[3], const double b[3], const double c[3], const double d[3]);
/* The axis along which to look at a triangle so that it does not vanish: 0, 1 or 2, or -1 when the
 * three points lie on a line. */
int bwi_projection(const double a[3], const double b[3], const double c[3]);
/* bwi_orient2 of the points seen along an axis. */
int bwi_orient_seen(int axis, const double a[3], const double b[3], const double c[3]);

/* Closed sets: touching counts. The triangle must not be degenerate. */
bool bwi_segment_meets_triangle(const double p[3], const double q[3], const double a[3],
                                const double b[3], const double c[3]);

#ifdef __cplusplus
}
#endif
#endif
