/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of faces share. */
#ifndef BWI_FACES_INTERNAL_H
#define BWI_FACES_INTERNAL_H

#include "barwright/faces.h"
#include "mesh/surface_topology.h"

/* Points with unit normals and areas of facets, which a primitive is fitted to. */
typedef struct bwi_cloud {
  int64_t points, facets;
  double *point;  /* 3 per point */
  double *normal; /* 3 per facet, unit */
  double *area;   /* per facet */
} bwi_cloud;

/* ---- faces_regions.c ------------------------------------------------------------------------- */

typedef struct bwi_link { /* smooth border of two regions */
  int32_t from, to;
  double length;
} bwi_link;

typedef struct bwi_face_finder {
  bw_context *context;
  const bwi_topology *top;
  double diagonal, smooth; /* cosine of the largest angle inside of a face */
  double *normal, *area;   /* per facet; normal 0 for one without area */
  int32_t *order;          /* facets by descending area */
  int32_t *label;          /* per facet: its region */
  int32_t regions;
  double *region_area;
  int32_t *first, *member; /* facets by region */
  bwi_link *links;         /* by `from`, both ways */
  size_t link_count, link_capacity;
  int64_t *link_start;
  int32_t *face_of; /* per region */
  bw_face *face;
  size_t face_count, face_capacity;
  uint8_t *seen; /* per welded point */
  double limit;  /* how far corners may be from the primitive that was fitted last */
  bwi_cloud cloud;
} bwi_face_finder;

/* 0 .. count - 1 by descending size. */
bw_status bwi_order_by(bw_context *context, int32_t count, const double *size, int32_t *order);
/* Normals and areas; flat regions; their members, areas and smooth borders. */
bw_status bwi_faces_measure(bwi_face_finder *f);
bw_status bwi_find_regions(bwi_face_finder *f);
bw_status bwi_link_regions(bwi_face_finder *f);

/* ---- fits and projection --------------------------------------------------------------------- */

/* faces_fit.c: the primitive of a kind by least squares of distances; false where there is
 * none. Fills kind, point, axis, radius, slope, residual. */
bool bwi_face_fit(const bwi_cloud *cloud, bw_face_kind kind, bw_face *face);

/* faces_project.c: the faces that meet at a point, planes first; free forms are left out. */
enum { BWI_AROUND = 8 };
typedef struct bwi_faces_around {
  int count;
  int32_t face[BWI_AROUND];
} bwi_faces_around;
void bwi_around_add(bwi_faces_around *around, const bw_faces *faces, int32_t face);
/* x onto the primitives, up to a kind; false when the steps do not end. */
bool bwi_around_project(const bw_faces *faces, const bwi_faces_around *around, bw_face_kind last,
                        double diagonal, double x[3]);
/* The face of the base that each facet of a surface lies on; -1 where it is not clear. */
bw_status bwi_faces_label(bw_context *context, const bw_surface *base, const bw_faces *faces,
                          const bw_surface *surface, int32_t *label);

/* `surface`, which was made from `base` by remeshing, with its points on the
 * primitives of the faces of `base`. Points stay where they are where a move would be long or turn
 * a facet. *moved is the longest move; the same surface is retained where nothing moves. */
bw_status bwi_faces_project(bw_context *context, const bw_surface *base, const bw_faces *faces,
                            const bw_surface *surface, double longest, bw_surface **projected,
                            int64_t *count, double *moved);

/* Borders of faces that remeshing keeps as sharp edges. */
typedef struct bwi_face_borders {
  const bw_faces *faces; /* of the surface as it is when welded */
  double tolerance;      /* m: points of a border that lie so near to a straight line may go */
  double round_angle;    /* radians: the most that an edge on a round face turns; 0: no bound */
} bwi_face_borders;

/* surface_remesh.c: bw_surface_remesh that keeps borders (NULL: none). The remeshed surface has the
 * number of the face of each facet as its groups then. After about max_steps steps of its loops
 * (0: no limit) BW_LIMIT. */
bw_status bwi_surface_remesh(bw_context *context, const bw_surface *surface,
                             const bw_remesh_options *options, const bwi_face_borders *borders,
                             int64_t max_steps, bw_surface **remeshed, bw_shape_log *log);

/* remesh_faces.c: how many points bend the borders of faces, which remeshing keeps, and how many
 * facets the round faces need (bwi_face_borders). */
bw_status bwi_faces_min(bw_context *context, const bw_surface *surface, const bw_faces *faces,
                        double sharp_angle, double tolerance, double round_angle, int64_t *bends,
                        double *round_facets);

#endif
