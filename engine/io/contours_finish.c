/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Pieces of a drawing become the loops of an outline: what is drawn twice is dropped, open pieces
 * are put together, loops divided into material and holes. Matching takes ends two by two: one that
 * finds no other within the tolerance, or more than one, is reported with its position. */
#include "io/contours.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double *edge_start(bwi_contour_edge *edge) {
  return edge->curve.point[0];
}
static double *edge_end(bwi_contour_edge *edge) {
  return edge->curve.point[edge->curve.count - 1];
}

static double apart(const double a[2], const double b[2]) {
  return hypot(a[0] - b[0], a[1] - b[1]);
}

static double size_of(const bwi_contours *c) {
  double low[2] = {DBL_MAX, DBL_MAX}, high[2] = {-DBL_MAX, -DBL_MAX};
  for (size_t e = 0; e < c->edges; e++) {
    double a[2], b[2];
    bwi_curve_hull(&c->edge[e].curve, a, b);
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], a[k]);
      high[k] = fmax(high[k], b[k]);
    }
  }
  return c->edges ? hypot(high[0] - low[0], high[1] - low[1]) : 0;
}

static bw_status fail_at(bw_context *context, const char *name, int64_t line, const double at[2],
                         const char *text) {
  bw_fail(context, BW_GEOMETRY, "%s:%lld: %s", name, (long long)line, text);
  bw_detail_text(context, "file", name);
  bw_detail_number(context, "line", (double)line);
  bw_detail_number(context, "x", at[0]);
  bw_detail_number(context, "y", at[1]);
  return BW_GEOMETRY;
}

/* ---- what is drawn twice --------------------------------------------------------------------- */

static bool same_edge(const bwi_outline_curve *a, const bwi_outline_curve *b, bool backwards,
                      double min) {
  if (a->count != b->count)
    return false;
  for (int i = 0; i < a->count; i++)
    if (apart(a->point[i], b->point[backwards ? b->count - 1 - i : i]) > min)
      return false;
  return true;
}

static bool same_piece(const bwi_contours *c, size_t p, size_t q, bool backwards, double min) {
  const bwi_contour_piece *a = &c->piece[p], *b = &c->piece[q];
  if (a->count != b->count)
    return false;
  for (size_t i = 0; i < a->count; i++)
    if (!same_edge(&c->edge[a->first + i].curve,
                   &c->edge[b->first + (backwards ? b->count - 1 - i : i)].curve, backwards, min))
      return false;
  return true;
}

typedef struct leftmost {
  double x;
  size_t piece;
} leftmost;

static int by_leftmost(const void *a, const void *b) {
  const leftmost *p = a, *q = b;
  if (p->x != q->x)
    return p->x < q->x ? -1 : 1;
  return p->piece < q->piece ? -1 : p->piece > q->piece;
}

/* Marks pieces that lie on an earlier one as used: drawings often hold a line twice. */
static bw_status drop_doubles(bwi_contours *c, double min, bool *used) {
  int64_t dropped = 0;
  leftmost *order = BW_NEW(c->context, leftmost, c->pieces);
  if (!order)
    return BW_MEMORY;
  for (size_t p = 0; p < c->pieces; p++) {
    order[p] = (leftmost){DBL_MAX, p};
    for (size_t e = 0; e < c->piece[p].count; e++) {
      double low[2], high[2];
      bwi_curve_hull(&c->edge[c->piece[p].first + e].curve, low, high);
      order[p].x = fmin(order[p].x, low[0]);
    }
  }
  qsort(order, c->pieces, sizeof *order, by_leftmost);
  for (size_t i = 0; i < c->pieces; i++)
    for (size_t j = i + 1; j < c->pieces && order[j].x - order[i].x <= min; j++) {
      size_t p = order[i].piece, q = order[j].piece;
      size_t later = p > q ? p : q;
      if (!used[p] && !used[q] &&
          (same_piece(c, p, q, false, min) || same_piece(c, p, q, true, min))) {
        used[later] = true;
        dropped++;
      }
    }
  bw_free(order);
  if (dropped > 0)
    bw_warn(c->context, "%s: %lld curves coincide with others and were ignored", c->name,
            (long long)dropped);
  return BW_OK;
}

/* ---- open pieces ----------------------------------------------------------------------------- */

/* An end of an open piece: 2 piece + (0: its start, 1: its end). */
typedef struct open_end {
  double at[2];
  size_t number;
} open_end;

static int by_x(const void *a, const void *b) {
  const open_end *p = a, *q = b;
  if (p->at[0] != q->at[0])
    return p->at[0] < q->at[0] ? -1 : 1;
  return p->number < q->number ? -1 : p->number > q->number;
}

static void piece_ends(bwi_contours *c, size_t piece, double *ends[2]) {
  const bwi_contour_piece *p = &c->piece[piece];
  ends[0] = edge_start(&c->edge[p->first]);
  ends[1] = edge_end(&c->edge[p->first + p->count - 1]);
}

static bw_status fail_open(const bwi_contours *c, const open_end *end, size_t count, size_t i,
                           double tolerance) {
  double min = DBL_MAX;
  char text[300];
  for (size_t j = 0; j < count; j++)
    if (j != i)
      min = fmin(min, apart(end[i].at, end[j].at));
  snprintf(text, sizeof text,
           "a curve is open at (%g, %g) m: the nearest other end is %.3g m away, and ends are "
           "joined within %.3g m: close it, or read with a larger tolerance",
           end[i].at[0], end[i].at[1], min, tolerance);
  return fail_at(c->context, c->name, c->piece[end[i].number / 2].line, end[i].at, text);
}

/* mate[2 p + side]: the end that it meets. */
static bw_status match_ends(bwi_contours *c, double tolerance, const bool *open, size_t *mate) {
  bw_status status = BW_OK;
  size_t count = 0;
  open_end *end = BW_NEW(c->context, open_end, 2 * c->pieces);
  if (!end)
    return BW_MEMORY;
  for (size_t p = 0; p < c->pieces; p++) {
    double *at[2];
    piece_ends(c, p, at);
    for (size_t side = 0; open[p] && side < 2; side++) {
      memcpy(end[count].at, at[side], sizeof end[count].at);
      end[count++].number = 2 * p + side;
    }
  }
  qsort(end, count, sizeof *end, by_x);
  for (size_t i = 0; i < count; i++)
    mate[end[i].number] = SIZE_MAX;
  for (size_t i = 0; i < count; i++) {
    for (size_t j = i + 1; j < count && end[j].at[0] - end[i].at[0] <= tolerance; j++) {
      if (apart(end[i].at, end[j].at) > tolerance)
        continue;
      if (mate[end[i].number] != SIZE_MAX || mate[end[j].number] != SIZE_MAX) {
        char text[200];
        snprintf(text, sizeof text,
                 "more than two curves end at (%g, %g) m, within %.3g m: which go together cannot "
                 "be distinguished (a line drawn twice?)",
                 end[i].at[0], end[i].at[1], tolerance);
        BW_TRY(fail_at(c->context, c->name, c->piece[end[j].number / 2].line, end[i].at, text));
      }
      mate[end[i].number] = end[j].number;
      mate[end[j].number] = end[i].number;
    }
    if (mate[end[i].number] == SIZE_MAX)
      BW_TRY(fail_open(c, end, count, i, tolerance));
  }
done:
  bw_free(end);
  return status;
}

/* ---- the outline ----------------------------------------------------------------------------- */

/* Edges of a piece, forwards or backwards, to the list of a loop. */
static void take_piece(const bwi_contours *c, size_t piece, bool backwards, double min,
                       bwi_contour_edge *list, size_t *count) {
  const bwi_contour_piece *p = &c->piece[piece];
  for (size_t i = 0; i < p->count; i++) {
    bwi_contour_edge edge = c->edge[p->first + (backwards ? p->count - 1 - i : i)];
    if (backwards)
      for (int a = 0, b = edge.curve.count - 1; a < b; a++, b--)
        for (int k = 0; k < 2; k++) {
          double kept = edge.curve.point[a][k];
          edge.curve.point[a][k] = edge.curve.point[b][k];
          edge.curve.point[b][k] = kept;
        }
    double low[2], high[2];
    bwi_curve_hull(&edge.curve, low, high);
    /* A line of no length, and the closing line where the last edge closes already. */
    bool closing = p->closed && i + 1 == p->count && *count > 0;
    if (apart(low, high) <= min ||
        (closing && apart(edge_start(&edge), edge_end(&edge)) <= 1000 * min))
      continue;
    list[(*count)++] = edge;
  }
}

static bw_name free_name(const bwi_draft *draft, const bw_name *wanted) {
  bw_name name = *wanted;
  for (int n = 2; name.text[0]; n++) {
    bool taken = false;
    for (size_t l = 0; l < draft->loops && !taken; l++)
      taken = strcmp(draft->loop[l].name.text, name.text) == 0;
    if (!taken)
      break;
    char text[BW_NAME + 16];
    size_t capacity = BW_NAME - 12, length = strlen(wanted->text);
    snprintf(text, sizeof text, "%.*s %d", (int)(length < capacity ? length : capacity),
             wanted->text, n);
    name = bwi_name(text, strlen(text));
  }
  return name;
}

/* A loop from edges that follow each other to within the tolerance. */
static void add_loop(bwi_contours *c, const bwi_contour_piece *from, bwi_contour_edge *list,
                     size_t count) {
  bwi_draft *d = &c->draft;
  bw_name name = free_name(d, &from->name);
  bw_loop *loop = bwi_draft_loop(d, "", from->region);
  loop->name = name;
  int32_t first = 0, start = 0;
  for (size_t i = 0; i < count; i++) {
    const bwi_outline_curve *curve = &list[i].curve;
    if (i == 0)
      first = start = bwi_draft_point(d, curve->point[0]);
    int32_t control[2] = {-1, -1};
    for (int k = 0; k < 2 && curve->count == 4; k++)
      control[k] = bwi_draft_point(d, curve->point[k + 1]);
    int32_t end = i + 1 == count ? first : bwi_draft_point(d, list[i + 1].curve.point[0]);
    bwi_draft_segment(d, start, control[0], control[1], end, list[i].tag);
    start = end;
  }
}

static bw_status build_loops(bwi_contours *c, double tolerance, double min, int64_t **lines) {
  bw_status status = BW_OK;
  bool *open = BW_NEW0(c->context, bool, c->pieces), *used = BW_NEW0(c->context, bool, c->pieces);
  size_t *mate = BW_NEW0(c->context, size_t, 2 * c->pieces);
  bwi_contour_edge *list = BW_NEW(c->context, bwi_contour_edge, c->edges);
  *lines = BW_NEW(c->context, int64_t, c->pieces);
  BW_TRY_MEMORY(open && used && mate && list && *lines);
  BW_TRY(drop_doubles(c, min, used));
  for (size_t p = 0; p < c->pieces; p++) {
    double *at[2];
    piece_ends(c, p, at);
    open[p] = !used[p] && !c->piece[p].closed && apart(at[0], at[1]) > tolerance;
  }
  BW_TRY(match_ends(c, tolerance, open, mate));
  for (size_t p = 0; p < c->pieces; p++) {
    size_t count = 0, piece = p;
    bool backwards = false;
    while (!used[piece]) {
      used[piece] = true;
      take_piece(c, piece, backwards, min, list, &count);
      if (!open[piece])
        break;
      size_t next = mate[2 * piece + !backwards];
      piece = next / 2;
      backwards = next % 2 == 1; /* entered by its end */
    }
    if (count > 0) {
      (*lines)[c->draft.loops] = c->piece[p].line;
      add_loop(c, &c->piece[p], list, count);
    }
  }
  status = c->draft.status;
done:
  bw_free(list);
  bw_free(mate);
  bw_free(used);
  bw_free(open);
  return status;
}

/* Loops inside an even number of others are material. Numbers that the file gives are kept in their
 * order, without gaps. */
static bw_status assign_regions(bwi_contours *c) {
  bw_status status = BW_OK;
  bwi_draft *d = &c->draft;
  double *area = BW_NEW(c->context, double, d->loops);
  int32_t *parent = BW_NEW(c->context, int32_t, d->loops), next = 0;
  BW_TRY_MEMORY(area && parent);
  BW_TRY(bwi_outline_nesting(c->context, d->point, (int32_t)d->loops, d->loop, d->segment, area,
                             parent));
  for (size_t l = 0; l < d->loops; l++) {
    size_t depth = 0;
    /* Loops that cross may each seem to lie in the other. */
    for (int32_t p = parent[l]; p >= 0 && depth <= d->loops; p = parent[p])
      depth++;
    if (d->loop[l].region == BWI_REGION_BY_NESTING)
      d->loop[l].region = depth % 2 == 0 ? 0 : -1;
  }
  for (size_t k = 0; k < d->loops; k++) { /* the least number that is not yet in place */
    int32_t min = INT32_MAX;
    for (size_t l = 0; l < d->loops; l++)
      if (d->loop[l].region >= next && d->loop[l].region < min)
        min = d->loop[l].region;
    if (min == INT32_MAX)
      break;
    for (size_t l = 0; l < d->loops && min > next; l++)
      if (d->loop[l].region == min)
        d->loop[l].region = next;
    next++;
  }
done:
  bw_free(parent);
  bw_free(area);
  return status;
}

/* What bw_outline_create refused, with the line of the loop. */
static bw_status fail_outline(bwi_contours *c, const int64_t *lines) {
  const char *key, *text;
  double number, value[4] = {0};
  static const char *const keys[4] = {"segment", "other_segment", "x", "y"};
  bool have[4] = {false};
  int64_t line = lines[0];
  char message[600];
  snprintf(message, sizeof message, "%s", bw_message(c->context));
  for (int i = 0; bw_detail(c->context, i, &key, &number, &text); i++) {
    for (int k = 0; k < 4; k++)
      if (strcmp(key, keys[k]) == 0) {
        have[k] = true;
        value[k] = number;
      }
    for (size_t l = 0; l < c->draft.loops; l++) {
      const bw_loop *loop = &c->draft.loop[l];
      if ((strcmp(key, "loop") == 0 && text && strcmp(text, loop->name.text) == 0) ||
          (strcmp(key, "segment") == 0 && number > loop->first))
        line = lines[l];
    }
  }
  bw_fail(c->context, BW_GEOMETRY, "%s:%lld: %s", c->name, (long long)line, message);
  bw_detail_text(c->context, "file", c->name);
  bw_detail_number(c->context, "line", (double)line);
  for (int k = 0; k < 4; k++)
    if (have[k])
      bw_detail_number(c->context, keys[k], value[k]);
  return BW_GEOMETRY;
}

bw_status bwi_contours_finish(bwi_contours *c, double tolerance, bw_outline **outline) {
  bw_status status = c->status;
  int64_t *lines = NULL;
  if (status != BW_OK)
    return status;
  for (size_t e = 0; e < c->edges; e++)
    for (int i = 0; i < c->edge[e].curve.count; i++)
      if (!(fabs(c->edge[e].curve.point[i][0]) <= 1e12 &&
            fabs(c->edge[e].curve.point[i][1]) <= 1e12))
        return bw_fail(c->context, BW_FORMAT, "%s: a curve leads beyond 1e12 m", c->name);
  double size = size_of(c), min = 10 * BW_OUTLINE_GAP * size;
  if (tolerance == 0)
    tolerance = 1e-5 * size;
  if (c->pieces == 0)
    return bw_fail(c->context, BW_FORMAT, "%s: it contains no curve", c->name);
  BW_TRY(build_loops(c, tolerance, min, &lines));
  if (c->draft.loops == 0)
    BW_TRY(bw_fail(c->context, BW_FORMAT, "%s: its curves have no length", c->name));
  BW_TRY(assign_regions(c));
  status = bwi_draft_finish(&c->draft, outline);
  if (status == BW_GEOMETRY)
    status = fail_outline(c, lines);
  else if (status == BW_INVALID)
    status = bw_fail(c->context, BW_FORMAT, "%s: no outline can be made of it", c->name);
done:
  bw_free(lines);
  return status;
}
