/* A closed triangle mesh that can be changed: edges split, collapsed, flipped.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_MESH_REMESH_MESH_H
#define BARWRIGHT_MESH_REMESH_MESH_H

#include "barwright/mesh.h"

/* Side k of facet t, number 3*t+k, runs from corner k to corner k+1 (mod 3). Invariants: the
 * opposite of a side runs the other way along the same edge; `sharp` is the same for both; a dead
 * facet has corner[0] = -1; a dead point has side -1; the side of a live point starts there. */
typedef struct bwi_changing {
  bw_context *context;
  size_t point_count, point_capacity;
  size_t facet_count, facet_capacity; /* dead ones included */
  double *point;                      /* 3 per point */
  double *size;                       /* per point: the edge length wanted there */
  uint8_t *fixed;                     /* per point: BWI_FREE, BWI_CREASE, BWI_CORNER */
  int32_t *side;                      /* per point: one side that starts there */
  int32_t *corner;                    /* 3 per facet */
  int32_t *opposite;                  /* per side */
  uint8_t *sharp;                     /* per side */
  int32_t *group;                     /* per facet */
} bwi_changing;

enum { BWI_FREE, BWI_CREASE, BWI_CORNER };

/* From a welded surface in which every edge has two facets running against each other; edges whose
 * facets' normals differ by more than the angle are sharp. */
bw_status bwi_changing_create(bw_context *context, const bw_surface *surface, double sharp_angle,
                              bwi_changing **mesh);
/* Points on no sharp edge are free; on two that run on nearly straight, crease points; others are
 * corners. */
void bwi_changing_classify(bwi_changing *mesh);
void bwi_changing_destroy(bwi_changing *mesh);
bw_status bwi_changing_surface(const bwi_changing *mesh, bool groups, bw_surface **surface);

static inline int32_t bwi_next(int32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}
static inline int32_t bwi_previous(int32_t side) {
  return side % 3 == 0 ? side + 2 : side - 1;
}
static inline int32_t bwi_from(const bwi_changing *mesh, int32_t side) {
  return mesh->corner[side];
}
static inline int32_t bwi_to(const bwi_changing *mesh, int32_t side) {
  return mesh->corner[bwi_next(side)];
}
/* The next side that starts at the same point, counter-clockwise. */
static inline int32_t bwi_around(const bwi_changing *mesh, int32_t side) {
  return mesh->opposite[bwi_previous(side)];
}
static inline double *bwi_at(const bwi_changing *mesh, int32_t point) {
  return mesh->point + 3 * (int64_t)point;
}

/* Put a new point on an edge; *made is its number. The new point is a crease point on a sharp
 * edge and free otherwise; its wanted size is the mean of the ends'. */
bw_status bwi_split(bwi_changing *mesh, int32_t side, const double at[3], int32_t *made);
/* May the edge be collapsed without the mesh ceasing to be a manifold? */
bool bwi_may_collapse(const bwi_changing *mesh, int32_t side);
/* Move the start of the side onto its end; the start and two facets die. */
void bwi_collapse(bwi_changing *mesh, int32_t side);
/* Would flipping give an edge that exists already? */
bool bwi_may_flip(const bwi_changing *mesh, int32_t side);
void bwi_flip(bwi_changing *mesh, int32_t side);

#endif
