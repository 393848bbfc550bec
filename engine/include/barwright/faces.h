/* faces: parts of a surface bounded by sharp edges, with the plane, cylinder, cone or sphere that
 * each lies on. */
#ifndef BARWRIGHT_FACES_H
#define BARWRIGHT_FACES_H

#include "barwright/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The primitive that a face lies on. */
typedef enum bw_face_kind {
  BW_FACE_PLANE,    /* a plane */
  BW_FACE_CYLINDER, /* a circular cylinder */
  BW_FACE_CONE,     /* a circular cone */
  BW_FACE_SPHERE,   /* a sphere */
  BW_FACE_FREE      /* none of these */
} bw_face_kind;
BW_API const char *bw_face_word(bw_face_kind kind); /* "plane", ... */

/* A face and its primitive. */
typedef struct bw_face {
  bw_face_kind kind; /* of the primitive */
  int32_t triangle_count;
  double area;      /* (m2) */
  double centre[3]; /* (m) centroid of the area */
  double normal[3]; /* (-) mean outward, unit; 0 where it closes on itself */
  double point[3];  /* (m) of the plane, of the axis, the centre of the sphere */
  double axis[3];   /* (-) unit: the plane's outward normal; of cylinder and cone */
  double radius;    /* (m) of cylinder and sphere; of the cone at `point`; else 0 */
  double slope;     /* (-) of the cone: growth of the radius per length along the axis; else 0 */
  double residual;  /* (m) largest distance of a corner from the primitive; 0 for free ones */
} bw_face;

/* The faces of a surface. */
typedef struct bw_faces {
  bw_object object;
  int32_t count;
  bw_face *face; /* by descending area */
  int32_t triangle_count;
  int32_t *of_triangle; /* (index, triangle_count) its face */
} bw_faces;

/* Facets whose normals differ by at most `angle` (radians; 0: 30 degrees) are of one face, unless
 * primitives part them (docs/theory/faces.md). */
BW_API bw_status bw_faces_find(bw_context *context, const bw_surface *surface, double angle,
                               bw_faces **faces);
/* The number of the face nearest to a point of the surface that the faces were found on; -1 where
 * the surface has no facets. */
BW_API int32_t bw_faces_near(const bw_faces *faces, const bw_surface *surface,
                             const double point[3]);
/* The signed distance (m) of a point x (m) from a face's primitive and its gradient (-), which may
 * be NULL; 0 for a free one. Inside a cylinder, cone or sphere it is negative. */
BW_API double bw_face_distance(const bw_face *face, const double x[3], double gradient[3]);

/* The face of the surface that each facet of a mesh's boundary lies on: label (index, facet_count),
 * -1 where it is not clear. */
BW_API bw_status bw_faces_on_mesh(bw_context *context, const bw_surface *surface,
                                  const bw_faces *faces, const bw_mesh *mesh, int32_t *label);

/* The same of the triangles of another surface, such as an edited one: label (index,
 * triangle_count). */
BW_API bw_status bw_faces_on_surface(bw_context *context, const bw_surface *surface,
                                     const bw_faces *faces, const bw_surface *other,
                                     int32_t *label);

/* A mesh of order 2 with the nodes of its boundary's edges on the primitives of the surface that it
 * was filled from. Nodes stay where an element would become too distorted. `count` (may be NULL):
 * how many moved. BW_INVALID for a mesh of order 1. */
BW_API bw_status bw_mesh_curved(bw_context *context, const bw_mesh *mesh, const bw_surface *surface,
                                bw_mesh **curved, int64_t *count);

#ifdef __cplusplus
}
#endif
#endif
