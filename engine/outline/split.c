/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A segment cut in two, and two made one. Neither changes the other points' order: those that come
 * are the last, those behind one that goes move up. */
#include <math.h>
#include <string.h>

#include "outline/internal.h"

bw_status bw_outline_split(bw_context *context, const bw_outline *outline, int32_t segment,
                           double t, bw_outline **finer) {
  bwi_draft draft;
  bw_status status = bwi_check_segment(context, outline, segment);
  if (status != BW_OK)
    return status;
  if (!(t > 0 && t < 1))
    return bw_fail(context, BW_INVALID,
                   "a segment cannot be cut at %g: a parameter between 0 and 1 expected", t);
  bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[segment]), left, right;
  bwi_curve_split(&curve, t, &left, &right);
  bwi_draft_init(&draft, context);
  for (int64_t i = 0; i < outline->point_count; i++)
    bwi_draft_point(&draft, outline->point + 2 * i);
  for (int32_t tag = 0; tag < outline->tag_count; tag++)
    bwi_draft_tag(&draft, outline->tag[tag].text);
  for (int32_t l = 0; l < outline->loop_count; l++) {
    const bw_loop *loop = &outline->loop[l];
    bwi_draft_loop(&draft, loop->name.text, loop->region);
    for (int32_t s = loop->first; s < loop->first + loop->count; s++) {
      const int32_t *p = outline->segment[s].point, tag = outline->segment[s].tag;
      if (s != segment) {
        bwi_draft_segment(&draft, p[0], p[1], p[2], p[3], tag);
        continue;
      }
      int32_t cut = bwi_draft_point(&draft, right.point[0]), control[2] = {-1, -1};
      if (curve.count == 4) {
        control[0] = bwi_draft_point(&draft, right.point[1]);
        control[1] = bwi_draft_point(&draft, right.point[2]);
        if (draft.status == BW_OK)
          for (int i = 1; i < 3; i++)
            memcpy(draft.point + 2 * (int64_t)p[i], left.point[i], sizeof left.point[i]);
      }
      bwi_draft_segment(&draft, p[0], p[1], p[2], cut, tag);
      bwi_draft_segment(&draft, cut, control[0], control[1], p[3], tag);
    }
  }
  status = bwi_draft_finish(&draft, finer);
  bwi_draft_clear(&draft);
  return status;
}

static void raise(bwi_outline_curve *curve) {
  if (curve->count == 4)
    return;
  for (int k = 0; k < 2; k++) {
    double from = curve->point[0][k], to = curve->point[1][k];
    curve->point[1][k] = from + (to - from) / 3;
    curve->point[2][k] = from + (to - from) * 2 / 3;
    curve->point[3][k] = to;
  }
  curve->count = 4;
}

/* One cubic in place of two: undoes bwi_curve_split exactly, and keeps the directions at the ends
 * in any case. The cut of a cubic at t divides the line between its neighbours in the ratio t :
 * 1-t. */
static bwi_outline_curve unite(bwi_outline_curve left, bwi_outline_curve right) {
  raise(&left);
  raise(&right);
  double before = hypot(left.point[3][0] - left.point[2][0], left.point[3][1] - left.point[2][1]);
  double after =
      hypot(right.point[1][0] - right.point[0][0], right.point[1][1] - right.point[0][1]);
  if (!(before + after > 0)) {
    before = bwi_curve_length(&left);
    after = bwi_curve_length(&right);
  }
  double t = fmin(0.99, fmax(0.01, before / (before + after)));
  bwi_outline_curve whole = {4, {{0, 0}}};
  for (int k = 0; k < 2; k++) {
    whole.point[0][k] = left.point[0][k];
    whole.point[1][k] = left.point[0][k] + (left.point[1][k] - left.point[0][k]) / t;
    whole.point[2][k] = right.point[3][k] + (right.point[2][k] - right.point[3][k]) / (1 - t);
    whole.point[3][k] = right.point[3][k];
  }
  return whole;
}

/* The points that stay get their new numbers. Of two cubics the first's and the last's control
 * points stay; a cubic beside a line keeps both of its own. */
bw_status bw_outline_joined(bw_context *context, const bw_outline *outline, int32_t vertex,
                            bw_outline **coarser) {
  bwi_draft draft;
  bwi_draft_init(&draft, context);
  int32_t after, *number = NULL;
  bw_status status = bwi_check_vertex(context, outline, vertex, &after);
  if (status != BW_OK)
    return status;
  const bw_loop *around = &outline->loop[bw_segment_loop(outline, after)];
  if (around->count == 1)
    return bw_fail(context, BW_INVALID,
                   "point %d is the only vertex of loop '%s': a loop keeps at least one",
                   vertex + 1, around->name.text);
  int32_t before = bwi_previous_segment(around, after);
  const bw_segment *a = &outline->segment[before], *b = &outline->segment[after];
  bool both_lines = bwi_is_line(a) && bwi_is_line(b);
  bwi_outline_curve whole = unite(bwi_curve_of(outline->point, a), bwi_curve_of(outline->point, b));
  int32_t control[2] = {a->point[1], b->point[2]};
  if (bwi_is_line(a))
    control[0] = b->point[1];
  if (bwi_is_line(b))
    control[1] = a->point[2];
  number = BW_NEW(context, int32_t, outline->point_count);
  if (!number)
    return BW_MEMORY;
  for (int32_t p = 0; p < outline->point_count; p++) {
    bool gone = p == vertex;
    for (int i = 1; i < 3; i++)
      gone = gone || ((p == a->point[i] || p == b->point[i]) && p != control[0] && p != control[1]);
    const double *at = p == control[0]   ? whole.point[1]
                       : p == control[1] ? whole.point[2]
                                         : outline->point + 2 * (int64_t)p;
    number[p] = gone ? -1 : bwi_draft_point(&draft, at);
  }
  for (int32_t tag = 0; tag < outline->tag_count; tag++)
    bwi_draft_tag(&draft, outline->tag[tag].text);
  for (int32_t l = 0; l < outline->loop_count; l++) {
    const bw_loop *loop = &outline->loop[l];
    bwi_draft_loop(&draft, loop->name.text, loop->region);
    for (int32_t s = loop->first; s < loop->first + loop->count; s++) {
      const bw_segment *from = &outline->segment[s];
      bool line = s == before ? both_lines : bwi_is_line(from);
      if (s == after)
        continue;
      bwi_draft_segment(&draft, number[from->point[0]],
                        line ? -1 : number[s == before ? control[0] : from->point[1]],
                        line ? -1 : number[s == before ? control[1] : from->point[2]],
                        number[s == before ? b->point[3] : from->point[3]], from->tag);
    }
  }
  status = bwi_draft_finish(&draft, coarser);
  bw_free(number);
  bwi_draft_clear(&draft);
  return status;
}
