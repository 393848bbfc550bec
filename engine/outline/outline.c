/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The making of an outline: what a script, a reader or an edit hands over is checked, turned and
 * nested. After that nothing in it changes.
 *
 * Invariants of every bw_outline:
 *   - segments are grouped by loops, loops in order: loop l has segments [first, first + count),
 *     and the next loop begins there; each segment ends where the next of its loop begins;
 *   - every point starts one segment or controls one, and all are used;
 *   - the gap is kept (crossing.c); loops with a region run counter-clockwise and holes clockwise;
 *   - `parent` is the loop directly around a loop, -1 where there is none; a hole lies directly in
 *     a loop with a region;
 *   - regions are numbered without gaps; names of loops and tags are not empty and differ;
 *   - outlines with the same `segment` pointer have the same topology: one of them owns it, the
 *     others retain that one as `origin`. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "outline/internal.h"

/* Beyond this powers of coordinates lose their meaning. */
static const double farthest = 1e12;

static void outline_destroy(void *object) {
  bw_outline *outline = object;
  bw_free(outline->point);
  if (outline->origin) {
    bw_release(outline->origin);
  } else {
    bw_free(outline->segment);
    bw_free(outline->loop);
    bw_free(outline->tag);
  }
  bw_free(outline);
}

static size_t outline_bytes(const void *object) {
  const bw_outline *outline = object;
  size_t bytes = sizeof *outline + 2 * sizeof(double) * (size_t)outline->point_count;
  if (!outline->origin)
    bytes += (size_t)outline->segment_count * sizeof(bw_segment) +
             (size_t)outline->loop_count * sizeof(bw_loop) +
             (size_t)outline->tag_count * sizeof(bw_name);
  return bytes;
}

static const bw_kind outline_kind = {"outline", outline_destroy, outline_bytes};

/* ---- the description ------------------------------------------------------------------------- */

static bw_status check_points(bw_context *context, int32_t count, const double *point) {
  for (int64_t i = 0; i < 2 * (int64_t)count; i++)
    if (!(fabs(point[i]) <= farthest)) {
      bw_fail(context, BW_INVALID,
              "point %lld is (%g, %g) m: finite coordinates of at most %g m are needed",
              (long long)(i / 2) + 1, point[i - i % 2], point[i - i % 2 + 1], farthest);
      bw_detail_number(context, "point", (double)(i / 2 + 1));
      return BW_INVALID;
    }
  return BW_OK;
}

/* Loops one behind the other over all segments. */
static bw_status check_loops(bw_context *context, int32_t loops, const bw_loop *loop,
                             int32_t segments, int32_t *regions) {
  int64_t end = 0;
  *regions = 0;
  for (int32_t l = 0; l < loops; l++) {
    if (loop[l].first != end || loop[l].count < 1 || loop[l].count > segments - loop[l].first)
      return bw_fail(context, BW_INVALID,
                     "loop %d has %d segments from %d; the loops must have at least one each, in "
                     "order, of the %d there are",
                     l + 1, loop[l].count, loop[l].first + 1, segments);
    end += loop[l].count;
    if (loop[l].region < -1 || loop[l].region >= loops)
      return bw_fail(
          context, BW_INVALID,
          "loop %d has region %d: 0 for a hole, or a number from 1 without gaps, expected", l + 1,
          loop[l].region + 1);
    if (loop[l].region >= *regions)
      *regions = loop[l].region + 1;
  }
  if (end != segments)
    return bw_fail(context, BW_INVALID, "%lld of %d segments belong to no loop",
                   (long long)(segments - end), segments);
  for (int32_t r = 0; r < *regions; r++) {
    bool found = false;
    for (int32_t l = 0; l < loops && !found; l++)
      found = loop[l].region == r;
    if (!found)
      return bw_fail(context, BW_INVALID, "no loop has region %d although one has region %d", r + 1,
                     *regions);
  }
  return BW_OK;
}

static bw_status use_point(bw_context *context, int32_t points, uint8_t *used, int32_t point,
                           int32_t segment) {
  if (point < 0 || point >= points)
    return bw_fail(context, BW_INVALID, "segment %d names point %lld; there are %d", segment + 1,
                   (long long)point + 1, points);
  if (used[point])
    return bw_fail(context, BW_INVALID,
                   "segment %d uses point %d, which another uses: a point starts one segment or "
                   "controls one",
                   segment + 1, point + 1);
  used[point] = 1;
  return BW_OK;
}

static bw_status check_segments(bw_context *context, int32_t points, int32_t loops,
                                const bw_loop *loop, const bw_segment *segment, int32_t tags) {
  bw_status status = BW_OK;
  uint8_t *used = BW_NEW0(context, uint8_t, points);
  if (!used)
    return BW_MEMORY;
  for (int32_t l = 0; l < loops; l++)
    for (int32_t s = loop[l].first; s < loop[l].first + loop[l].count; s++) {
      const int32_t *p = segment[s].point;
      BW_TRY(use_point(context, points, used, p[0], s));
      if ((p[1] < 0) != (p[2] < 0))
        BW_TRY(bw_fail(context, BW_INVALID,
                       "segment %d has one control point: a line has none, a cubic two", s + 1));
      for (int i = 1; i < 3 && p[1] >= 0; i++)
        BW_TRY(use_point(context, points, used, p[i], s));
      int32_t next = bwi_next_segment(&loop[l], s);
      if (p[3] != segment[next].point[0])
        BW_TRY(bw_fail(context, BW_INVALID,
                       "segment %d ends at point %lld and the next one of its loop begins at point "
                       "%lld: they must be the same",
                       s + 1, (long long)p[3] + 1, (long long)segment[next].point[0] + 1));
      if (segment[s].tag < 0 || segment[s].tag >= tags)
        BW_TRY(bw_fail(context, BW_INVALID, "segment %d has tag %d; there are %d", s + 1,
                       segment[s].tag + 1, tags));
    }
  for (int32_t p = 0; p < points; p++)
    if (!used[p])
      BW_TRY(bw_fail(context, BW_INVALID, "point %d belongs to no segment", p + 1));
done:
  bw_free(used);
  return status;
}

/* ---- names ----------------------------------------------------------------------------------- */

static bool name_ends(const bw_name *name) {
  return memchr(name->text, 0, sizeof name->text) != NULL;
}

static int32_t find_before(const char *text, int32_t count, const bw_loop *loop) {
  for (int32_t l = 0; l < count; l++)
    if (strcmp(loop[l].name.text, text) == 0)
      return l;
  return -1;
}

static bw_status name_loops(bw_context *context, int32_t count, bw_loop *loop) {
  for (int32_t l = 0; l < count; l++) {
    if (!name_ends(&loop[l].name))
      return bw_fail(context, BW_INVALID, "the name of loop %d is longer than %d bytes", l + 1,
                     BW_NAME - 1);
    int32_t same = loop[l].name.text[0] ? find_before(loop[l].name.text, l, loop) : -1;
    if (same >= 0)
      return bw_fail(context, BW_INVALID, "loops %d and %d are both called '%s'", same + 1, l + 1,
                     loop[l].name.text);
  }
  /* Names by number, going on where one is taken. */
  for (int32_t l = 0; l < count; l++)
    for (int32_t n = l + 1; !loop[l].name.text[0]; n += count) {
      char text[BW_NAME];
      snprintf(text, sizeof text, "loop %d", n);
      if (find_before(text, count, loop) < 0)
        memcpy(loop[l].name.text, text, sizeof text);
    }
  return BW_OK;
}

static bw_status copy_tags(bw_context *context, int32_t count, const bw_name *tag,
                           bw_outline *outline) {
  outline->tag_count = count > 0 ? count : 1;
  outline->tag = BW_NEW0(context, bw_name, outline->tag_count);
  if (!outline->tag)
    return BW_MEMORY;
  if (count == 0) {
    strcpy(outline->tag[0].text, "boundary");
    return BW_OK;
  }
  for (int32_t t = 0; t < count; t++) {
    if (!tag[t].text[0] || !name_ends(&tag[t]))
      return bw_fail(context, BW_INVALID, "the name of tag %d must have 1 to %d bytes", t + 1,
                     BW_NAME - 1);
    for (int32_t u = 0; u < t; u++)
      if (strcmp(tag[u].text, tag[t].text) == 0)
        return bw_fail(context, BW_INVALID, "tags %d and %d are both called '%s'", u + 1, t + 1,
                       tag[t].text);
    memcpy(&outline->tag[t], &tag[t], sizeof tag[t]);
  }
  return BW_OK;
}

/* ---- direction and nesting ------------------------------------------------------------------- */

/* Backwards, beginning at the same point. */
static void turn_loop(const bw_loop *loop, bw_segment *segment) {
  bw_segment *s = segment + loop->first;
  for (int32_t i = 0, j = loop->count - 1; i < j; i++, j--) {
    bw_segment kept = s[i];
    s[i] = s[j];
    s[j] = kept;
  }
  for (int32_t i = 0; i < loop->count; i++)
    for (int k = 0; k < 2; k++) {
      int32_t kept = s[i].point[k];
      s[i].point[k] = s[i].point[3 - k];
      s[i].point[3 - k] = kept;
    }
}

static bw_status fail_loop(bw_context *context, const double *point, const bw_loop *loop,
                           const bw_segment *segment, const char *what) {
  const double *at = point + 2 * (int64_t)segment[loop->first].point[0];
  bw_fail(context, BW_GEOMETRY, "loop '%s' at (%g, %g) m %s", loop->name.text, at[0], at[1], what);
  bw_detail_text(context, "loop", loop->name.text);
  bw_detail_number(context, "x", at[0]);
  bw_detail_number(context, "y", at[1]);
  return BW_GEOMETRY;
}

/* By loop: its signed area, and which one it lies in. Release both with bw_free, on failure too. */
static bw_status find_nesting(bw_context *context, const bw_outline *o, double **area,
                              int32_t **parent) {
  *area = BW_NEW(context, double, o->loop_count);
  *parent = BW_NEW(context, int32_t, o->loop_count);
  if (!*area || !*parent)
    return BW_MEMORY;
  return bwi_outline_nesting(context, o->point, o->loop_count, o->loop, o->segment, *area, *parent);
}

static bw_status nest(bw_context *context, bw_outline *o) {
  bw_status status = BW_OK;
  double *area = NULL;
  int32_t *parent = NULL;
  BW_TRY(find_nesting(context, o, &area, &parent));
  for (int32_t l = 0; l < o->loop_count; l++) {
    bw_loop *loop = &o->loop[l];
    loop->parent = parent[l];
    if (!(fabs(area[l]) > 0))
      BW_TRY(fail_loop(context, o->point, loop, o->segment, "encloses no area"));
    if (loop->region < 0 && parent[l] < 0)
      BW_TRY(fail_loop(context, o->point, loop, o->segment,
                       "is a hole and lies in no other loop: give it a region, or move it into "
                       "one"));
    if (loop->region < 0 && o->loop[parent[l]].region < 0)
      BW_TRY(fail_loop(context, o->point, loop, o->segment,
                       "is a hole that lies directly in another hole: there is nothing to cut"));
    if ((area[l] > 0) != (loop->region >= 0))
      turn_loop(loop, o->segment);
  }
done:
  bw_free(parent);
  bw_free(area);
  return status;
}

/* ---- making ---------------------------------------------------------------------------------- */

static bw_status outline_new(bw_context *context, int32_t points, const double *point,
                             bw_outline **outline) {
  bw_outline *o = BW_NEW0(context, bw_outline, 1);
  if (!o)
    return BW_MEMORY;
  bw_object_init(o, &outline_kind);
  o->point = BW_NEW(context, double, 2 * (size_t)points);
  if (!o->point) {
    bw_release(o);
    return BW_MEMORY;
  }
  o->point_count = points;
  memcpy(o->point, point, 2 * (size_t)points * sizeof *point);
  *outline = o;
  return BW_OK;
}

bw_status bw_outline_create(bw_context *context, int32_t points, const double *point,
                            int32_t segments, const bw_segment *segment, int32_t loops,
                            const bw_loop *loop, int32_t tags, const bw_name *tag,
                            bw_outline **outline) {
  bw_status status = BW_OK;
  bw_outline *o = NULL;
  int32_t regions;
  if (points < 1 || segments < 1 || loops < 1 || tags < 0)
    return bw_fail(context, BW_INVALID,
                   "an outline of %d points, %d segments and %d loops: at least one of each is "
                   "needed",
                   points, segments, loops);
  BW_TRY(check_points(context, points, point));
  BW_TRY(check_loops(context, loops, loop, segments, &regions));
  BW_TRY(check_segments(context, points, loops, loop, segment, tags > 0 ? tags : 1));
  BW_TRY(outline_new(context, points, point, &o));
  o->segment_count = segments;
  o->loop_count = loops;
  o->region_count = regions;
  o->segment = BW_NEW(context, bw_segment, segments);
  o->loop = BW_NEW(context, bw_loop, loops);
  BW_TRY_MEMORY(o->segment && o->loop);
  memcpy(o->segment, segment, (size_t)segments * sizeof *segment);
  memcpy(o->loop, loop, (size_t)loops * sizeof *loop);
  BW_TRY(copy_tags(context, tags, tag, o));
  BW_TRY(name_loops(context, loops, o->loop));
  BW_TRY(bwi_outline_check_crossings(context, point, bwi_outline_gap(points, point), loops, o->loop,
                                     o->segment));
  BW_TRY(nest(context, o));
  *outline = o;
  o = NULL;
done:
  bw_release(o);
  return status;
}

/* The loops lie in each other as before, and the same way round. */
static bw_status check_nesting(bw_context *context, const bw_outline *o) {
  bw_status status = BW_OK;
  double *area = NULL;
  int32_t *parent = NULL;
  BW_TRY(find_nesting(context, o, &area, &parent));
  for (int32_t l = 0; l < o->loop_count; l++) {
    const bw_loop *loop = &o->loop[l];
    if (!(loop->region >= 0 ? area[l] > 0 : area[l] < 0))
      BW_TRY(fail_loop(context, o->point, loop, o->segment, "is inverted"));
    if (parent[l] != loop->parent) {
      char text[200];
      const char *was = loop->parent < 0 ? "none" : o->loop[loop->parent].name.text;
      const char *is = parent[l] < 0 ? "none" : o->loop[parent[l]].name.text;
      snprintf(text, sizeof text, "now lies in another loop: directly in %s, before in %s", is,
               was);
      BW_TRY(fail_loop(context, o->point, loop, o->segment, text));
    }
  }
done:
  bw_free(parent);
  bw_free(area);
  return status;
}

bw_status bw_outline_moved(bw_context *context, const bw_outline *outline, const double *point,
                           bw_outline **moved) {
  bw_status status = BW_OK;
  bw_outline *o = NULL;
  int32_t points = outline->point_count;
  BW_TRY(check_points(context, points, point));
  BW_TRY(outline_new(context, points, point, &o));
  o->origin = bw_retain(outline->origin ? outline->origin : outline);
  o->segment_count = outline->segment_count;
  o->loop_count = outline->loop_count;
  o->region_count = outline->region_count;
  o->tag_count = outline->tag_count;
  o->segment = outline->segment;
  o->loop = outline->loop;
  o->tag = outline->tag;
  BW_TRY(bwi_outline_check_crossings(context, point, bwi_outline_gap(points, point), o->loop_count,
                                     o->loop, o->segment));
  BW_TRY(check_nesting(context, o));
  *moved = o;
  o = NULL;
done:
  bw_release(o);
  return status;
}

/* ---- looking things up ----------------------------------------------------------------------- */

bool bw_outline_same_topology(const bw_outline *a, const bw_outline *b) {
  return a->segment == b->segment;
}

int32_t bw_outline_find_loop(const bw_outline *outline, const char *name) {
  return find_before(name, outline->loop_count, outline->loop);
}

int32_t bw_outline_find_tag(const bw_outline *outline, const char *name) {
  for (int32_t t = 0; t < outline->tag_count; t++)
    if (strcmp(outline->tag[t].text, name) == 0)
      return t;
  return -1;
}

int32_t bw_segment_loop(const bw_outline *outline, int32_t segment) {
  int32_t low = 0, high = outline->loop_count - 1;
  while (low < high) {
    int32_t middle = low + (high - low + 1) / 2;
    if (outline->loop[middle].first <= segment)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

bw_status bwi_check_loop(bw_context *context, const bw_outline *outline, int32_t loop) {
  if (loop >= 0 && loop < outline->loop_count)
    return BW_OK;
  return bw_fail(context, BW_INVALID, "loop %lld: the outline has loops 1 to %d",
                 (long long)loop + 1, outline->loop_count);
}

bw_status bwi_check_segment(bw_context *context, const bw_outline *outline, int32_t segment) {
  if (segment >= 0 && segment < outline->segment_count)
    return BW_OK;
  return bw_fail(context, BW_INVALID, "segment %lld: the outline has segments 1 to %d",
                 (long long)segment + 1, outline->segment_count);
}

bw_status bwi_check_vertex(bw_context *context, const bw_outline *outline, int32_t vertex,
                           int32_t *segment) {
  if (vertex < 0 || vertex >= outline->point_count)
    return bw_fail(context, BW_INVALID, "point %lld: the outline has points 1 to %d",
                   (long long)vertex + 1, outline->point_count);
  for (int32_t s = 0; s < outline->segment_count; s++)
    if (outline->segment[s].point[0] == vertex) {
      *segment = s;
      return BW_OK;
    }
  return bw_fail(context, BW_INVALID, "point %d is a control point, not a vertex", vertex + 1);
}
