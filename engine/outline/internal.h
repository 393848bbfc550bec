/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of outlines share. */
#ifndef BWI_OUTLINE_INTERNAL_H
#define BWI_OUTLINE_INTERNAL_H

#include "barwright/outline.h"

static inline bool bwi_is_line(const bw_segment *segment) {
  return segment->point[1] < 0;
}

/* ---- curves (curve.c): a line with 2 or a cubic with 4 control points ------------------------ */

typedef struct bwi_outline_curve {
  int count;
  double point[4][2];
} bwi_outline_curve;
bwi_outline_curve bwi_curve_of(const double *point, const bw_segment *segment);
void bwi_curve_at(const bwi_outline_curve *curve, double t, double position[2],
                  double derivative[2], double second[2]);
/* de Casteljau. The common end is one point, and the outer ends are those of the whole, bit for
 * bit. */
void bwi_curve_split(const bwi_outline_curve *curve, double t, bwi_outline_curve *left,
                     bwi_outline_curve *right);
/* A bound of the distance from the curve to its chord. */
double bwi_curve_sag(const bwi_outline_curve *curve);
/* The box of the control points, or of the curve itself. */
void bwi_curve_hull(const bwi_outline_curve *curve, double low[2], double high[2]);
void bwi_curve_box(const bwi_outline_curve *curve, double low[2], double high[2]);

/* ---- validity -------------------------------------------------------------------------------- */

/* How close segments may come: BW_OUTLINE_GAP times the size of these points. */
double bwi_outline_gap(int32_t count, const double *point);
/* Segments against each other and themselves (crossing.c); names as in the outline's loops. */
bw_status bwi_outline_check_crossings(bw_context *context, const double *point, double gap,
                                      int32_t loops, const bw_loop *loop,
                                      const bw_segment *segment);
/* Which loop lies directly in which (nesting.c); -1: in none. The loops are simple and disjoint.
 * area: of every loop, positive counter-clockwise. */
bw_status bwi_outline_nesting(bw_context *context, const double *point, int32_t loops,
                              const bw_loop *loop, const bw_segment *segment, double *area,
                              int32_t *parent);

/* ---- measures (measure.c) -------------------------------------------------------------------- */

/* The first of them alone, about any origin. */
double bwi_loop_area(const double *point, const bw_loop *loop, const bw_segment *segment);
double bwi_curve_length(const bwi_outline_curve *curve);

/* Whether a loop is `around`, or lies in it. */
static inline bool bwi_lies_in(const bw_outline *outline, int32_t loop, int32_t around) {
  for (; loop >= 0; loop = outline->loop[loop].parent)
    if (loop == around)
      return true;
  return false;
}

/* A loop's segments [first, first + count) in a circle. */
static inline int32_t bwi_next_segment(const bw_loop *loop, int32_t segment) {
  return segment + 1 < loop->first + loop->count ? segment + 1 : loop->first;
}
static inline int32_t bwi_previous_segment(const bw_loop *loop, int32_t segment) {
  return segment > loop->first ? segment - 1 : loop->first + loop->count - 1;
}

/* The direction in which a curve leaves its start or comes to its end: the unit vector towards the
 * first control point that lies elsewhere. (curve.c) */
void bwi_curve_leaves(const bwi_outline_curve *curve, double direction[2]);
void bwi_curve_arrives(const bwi_outline_curve *curve, double direction[2]);

bw_status bwi_check_loop(bw_context *context, const bw_outline *outline, int32_t loop);
bw_status bwi_check_segment(bw_context *context, const bw_outline *outline, int32_t segment);
/* A point at which a segment begins; that segment comes back. */
bw_status bwi_check_vertex(bw_context *context, const bw_outline *outline, int32_t vertex,
                           int32_t *segment);

/* ---- putting outlines together (draft.c) ----------------------------------------------------- */

/* Loops added one after the other. The first failure of memory sticks and comes back at the end. */
typedef struct bwi_draft {
  bw_context *context;
  double *point;
  bw_segment *segment;
  bw_loop *loop;
  bw_name *tag;
  size_t points, point_capacity, segments, segment_capacity, loops, loop_capacity, tags,
      tag_capacity;
  bw_status status;
} bwi_draft;
void bwi_draft_init(bwi_draft *draft, bw_context *context);
void bwi_draft_clear(bwi_draft *draft);
int32_t bwi_draft_point(bwi_draft *draft, const double at[2]);
void bwi_draft_segment(bwi_draft *draft, int32_t start, int32_t control1, int32_t control2,
                       int32_t end, int32_t tag);
/* The segments added from now on belong to a new loop. */
bw_loop *bwi_draft_loop(bwi_draft *draft, const char *name, int32_t region);
/* The number of the tag of this name (cut to what a name holds), added when it is new. */
int32_t bwi_draft_tag(bwi_draft *draft, const char *name);
/* A name, cut at the end of a character where it is too long. */
bw_name bwi_name(const char *text, size_t length);
/* All of an outline but the points. */
void bwi_draft_copy(bwi_draft *draft, const bw_outline *outline);
bw_status bwi_draft_finish(bwi_draft *draft, bw_outline **outline);

#endif
