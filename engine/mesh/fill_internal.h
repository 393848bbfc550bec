/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of filling share. */
#ifndef BWI_FILL_INTERNAL_H
#define BWI_FILL_INTERNAL_H

#include "mesh/faces_internal.h"
#include "mesh/tetgen_run.h"

/* A point strictly inside every cavity of a closed surface without intersections: shells are nested
 * by containment alone, whatever way they face; those inside an odd number of others bound
 * cavities, all others bodies. *hole is a block of *holes points for bw_free. */
bw_status bwi_find_cavities(bw_context *context, const bw_surface *surface, double **hole,
                            int32_t *holes);

/* Cut the edges of a surface that are longer than the size field asks for (times `slack`), always
 * the longest edge of a triangle first, so that shapes stay as good as they were; the surface does
 * not move. Stops at `limit` triangles, or after `seconds` of computing, with BW_LIMIT. */
bw_status bwi_refine_surface(bw_context *context, const bw_surface *surface,
                             const bw_size_field *field, double slack, int64_t limit,
                             double seconds, bw_surface **refined);

typedef struct bwi_coarsen_options {
  double length;  /* no edge grows much longer */
  double shorter; /* shorter edges are collapsed */
  double error;   /* root mean square distance from the facets that a collapse joins */
  double allowed; /* distance from the surface at points of new facets; 0: any */
  double seconds; /* of computing */
  /* NULL, or lengths: where they are below `length` all of the above is as much less. */
  const bw_size_field *field;
} bwi_coarsen_options;

/* Collapse short edges of a sound surface, keeping it sound, and exchange diagonals for better
 * shapes. Where walls are too thin it stays finer. BW_LIMIT after `seconds`. */
bw_status bwi_coarsen_surface(bw_context *context, const bw_surface *surface,
                              const bwi_coarsen_options *options, bw_surface **coarsened);

/* Take flat elements off the boundary: those with a dihedral angle below `angle`, where it stays a
 * manifold and their height is at most `highest`. *gone counts them, *moved is the largest height
 * of one. *mesh (order 1) is replaced. */
bw_status bwi_peel_flat(bw_context *context, bw_mesh **mesh, double angle, double highest,
                        int64_t *gone, double *moved);

/* Take elements without volume off the boundary of what TetGen made, as bwi_peel_flat does. Those
 * inside, and those whose removal moves the boundary by more than `max`, stay. */
bw_status bwi_peel_degenerate(bw_context *context, bwi_tetgen_result *result, double max);

/* How the surface for TetGen is made from the base, from the mildest to the last resort. */
typedef enum bwi_fill_way {
  WAY_AS_IS,   /* the base itself */
  WAY_FACES,   /* remeshed with the borders of faces as they are, and round faces as fine as they
                  need */
  WAY_BORDERS, /* with the borders as they are */
  WAY_CURVES,  /* with the borders as sharp edges, of fewer points */
  WAY_REMESH,  /* remeshed to the edge length */
  WAY_COARSEN, /* long edges cut, short ones collapsed where that makes no intersections */
  WAY_WRAP,    /* wrapped, which drops detail below the edge length, then remeshed */
  WAYS
} bwi_fill_way;

typedef struct bwi_filler {
  bw_context *context;
  const bw_fill_options *options;
  bw_size_field field;
  bw_surface *base;
  double volume, area, diagonal;
  bw_shape_log base_log;
  bw_faces *faces;     /* of the base, once they have been asked for; or NULL */
  int64_t bends;       /* points of their borders that stay */
  bool has_faces;      /* planes and round ones have most of the area */
  double round_facets; /* on round faces at least */

  bw_surface
      *tidy; /* the base without very short edges, for lengths from tidy_length on; or NULL */
  double tidy_length;

  bw_surface *surface;
  bwi_fill_way how;
  double length; /* the edge length that `surface` was made for */
  bw_shape_log surface_log;
  double *hole;
  int32_t holes;

  bwi_tetgen_result best; /* node NULL: none yet */
  bw_surface *best_surface;
  double best_miss; /* |log(count / wanted)| */
  bw_shape_log best_log;
  double best_length;
  bwi_fill_way best_how;

  int attempts;
  double seconds_repair, seconds_remesh, seconds_fill;
  bool repaired;
} bwi_filler;

/* fill.c */
bw_status bwi_fill_check_options(bw_context *context, const bw_fill_options *options);
/* fill_state.c */
void bwi_fill_describe_defects(const bw_surface_report *report, char *text, size_t size);
void bwi_fill_append_log(bw_shape_log *to, const bw_shape_log *from);
/* Whether another way of making the surface may cure this failure. */
bool bwi_fill_may_cure(const bwi_filler *f, bw_status status);
/* fill_surface.c: the surface for TetGen from the base, for an edge length. */
bw_status bwi_fill_make_surface(bwi_filler *f, bwi_fill_way how, double length);
/* The faces of the base and what keeping them takes, once. */
bw_status bwi_fill_find_faces(bwi_filler *f);
/* fill_count.c: attempts until the count is met, or one that quality and volume ask for. */
bw_status bwi_fill_meet_count(bwi_filler *f);
bw_status bwi_fill_once(bwi_filler *f);

#endif
