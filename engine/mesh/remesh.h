/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The state of a surface that is being remeshed (surface_remesh.c), and what its steps share. */
#ifndef BWI_REMESH_H
#define BWI_REMESH_H

#include <math.h>

#include "barwright/faces.h"
#include "barwright/mesh.h"
#include "base/limit.h"
#include "mesh/remesh_mesh.h"
#include "mesh/surface_tree.h"

static const double longest = 4.0 / 3, shortest = 4.0 / 5; /* of the wanted length */
static const double chord = 2;    /* chords of round faces may be so much longer */
static const double growth = 0.5; /* of the wanted length, per distance */
static const double turn = 0.5;   /* cosine of the largest turn of a facet in one change */

/* A point where edges must be finer than asked for. */
typedef struct bwi_fine_point {
  double at[3], size;
} bwi_fine_point;

typedef struct bwi_remesher {
  bw_context *context;
  const bw_surface *original;
  const struct bwi_face_borders *borders; /* NULL: none are kept */
  const bw_faces *faces; /* of the original, or NULL: their borders are sharp edges */
  bwi_changing *mesh;
  bwi_tree *tree, *creases;
  int32_t *crease; /* sharp edges of the original as triangles a b b */
  double length, tolerance;
  double finest;               /* of the edge length asked for: where features are small */
  double tiny;                 /* edges so short go even where they are features */
  double max_facets;           /* no more edges are split beyond */
  double memory;               /* bytes allowed */
  int64_t *checks, max_checks; /* how often loops checked their limits, and may (0: no limit) */
  bwi_time_limit time;
  double fraction;            /* done of the whole, for progress */
  const bw_size_field *sizes; /* NULL: none */
  double
      *clearance; /* per facet of the original: how far what lies opposite is, inside or outside */
  bwi_fine_point *fine_points;
  size_t fine_count, fine_capacity;
} bwi_remesher;

static inline double distance(const double a[3], const double b[3]) {
  double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return bw_norm(d);
}

static inline double side_length(const bwi_changing *mesh, int32_t side) {
  return distance(bwi_at(mesh, bwi_from(mesh, side)), bwi_at(mesh, bwi_to(mesh, side)));
}

static inline double wanted(const bwi_changing *mesh, int32_t side) {
  return 0.5 * (mesh->size[bwi_from(mesh, side)] + mesh->size[bwi_to(mesh, side)]);
}

static inline void normal_of(const double a[3], const double b[3], const double c[3], double n[3]) {
  double u[3], v[3];
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
  }
  bw_cross(u, v, n);
}

/* 4 sqrt(3) area over the sum of squared sides: 1 for an equilateral triangle, 0 for a flat one. */
static inline double quality(const double a[3], const double b[3], const double c[3]) {
  double n[3], ab = distance(a, b), bc = distance(b, c), ca = distance(c, a);
  normal_of(a, b, c, n);
  double sum = ab * ab + bc * bc + ca * ca;
  return sum > 0 ? 3.4641016151377544 * bw_norm(n) / sum : 0;
}

static inline bool turns_too_far(const double before[3], const double after[3]) {
  return bw_dot(before, after) <= turn * bw_norm(before) * bw_norm(after);
}

/* What a facet takes while it is remeshed: measured, with what its points and the search take. */
#define BWI_REMESH_BYTES_OF_FACET 300.0

/* Long loops check their limits now and then: cancelled, out of steps, time or memory? */
enum { BWI_REMESH_CHECK_BITS = 10 }; /* every 2^10 steps */
bw_status bwi_remesh_check(const bwi_remesher *r);
static inline bw_status check_limits(const bwi_remesher *r, size_t step) {
  return step % ((size_t)1 << BWI_REMESH_CHECK_BITS) == 0 ? bwi_remesh_check(r) : BW_OK;
}

/* remesh_guard.c: how far the surface may be left near a point; whether a point, a side and a facet
 * stay near enough; the size wanted at a point; the clearance of each facet. */
double bwi_remesh_slack(const bwi_remesher *r, double size);
bool bwi_remesh_near_crease(const bwi_remesher *r, const double a[3], const double b[3],
                            double limit);
bool bwi_remesh_facet_near_surface(const bwi_remesher *r, const double a[3], const double b[3],
                                   const double c[3], double limit);
double bwi_remesh_size_near(const bwi_remesher *r, const double x[3]);
bw_status bwi_remesh_find_clearance(void *data, int64_t begin, int64_t end, int worker);

/* remesh_faces.c: borders of faces are sharp edges, groups the numbers of faces; edges on round
 * faces are short beside the radius. Is a side a chord of a round face beside a plane? */
bw_status bwi_remesh_mark_faces(bwi_remesher *r, double tolerance, double round_angle);
bool bwi_remesh_is_chord(const bwi_remesher *r, int32_t side);

/* remesh_edges.c: split long sides, collapse short ones, let wanted sizes grow no faster than they
 * may. */
bw_status bwi_remesh_split_long(bwi_remesher *r);
bw_status bwi_remesh_collapse_short(bwi_remesher *r, bool coarse, bool learn);
void bwi_remesh_grade(bwi_changing *mesh);

/* remesh_smooth.c: flips for larger angles; points to the middle of their neighbours. */
bw_status bwi_remesh_flip_edges(bwi_remesher *r, int passes);
bw_status bwi_remesh_relax(bwi_remesher *r);

#endif
