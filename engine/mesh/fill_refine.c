/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Refinement of a surface to a size field by cutting edges in the middle. The surface itself does
 * not move, so a sound one stays sound.
 *
 * Pass by pass, edges that are too long are marked; where an edge of a triangle is marked its
 * longest edge is marked too, until nothing changes (Rivara). Then every triangle is cut through
 * its longest edge first and through the other marked ones after that: its angles are at least half
 * of what they were, however many passes follow. Of equally long edges the one with the lower
 * number is the longest, so both triangles at an edge agree. */
#include "base/job.h"
#include "base/limit.h"
#include "mesh/fill_internal.h"
#include "mesh/mesh_internal.h"
#include "mesh/surface_internal.h"

#include <math.h>
#include <string.h>

typedef struct pass {
  const bw_surface *surface;
  int32_t edge_count;
  int32_t *edge;   /* triangle_count x 3: edge k runs from corner k to corner k + 1 */
  int32_t *end;    /* edge_count x 2 */
  double *square;  /* edge_count: squared length */
  uint8_t *marked; /* edge_count */
  int32_t *middle; /* edge_count: the number of the new point, or -1 */
  bwi_time_limit time;
} pass;

static void pass_clear(pass *p) {
  bw_free(p->edge);
  bw_free(p->end);
  bw_free(p->square);
  bw_free(p->marked);
  bw_free(p->middle);
}

static bw_status number_edges(bw_context *context, pass *p) {
  const bw_surface *s = p->surface;
  size_t sides = 3 * (size_t)s->triangle_count;
  bw_status status = BW_OK;
  bwi_keyed *list = BW_NEW(context, bwi_keyed, sides);
  int64_t *start = BW_NEW0(context, int64_t, (size_t)s->point_count + 2);
  p->edge = BW_NEW(context, int32_t, sides);
  BW_TRY_MEMORY(list && start && p->edge);
  for (int round = 0; round < 2; round++) {
    for (int32_t t = 0; t < s->triangle_count; t++)
      for (int k = 0; k < 3; k++) {
        const int32_t *c = s->triangle + 3 * (size_t)t;
        int32_t a = c[k], b = c[(k + 1) % 3], low = a < b ? a : b, high = a < b ? b : a;
        if (round == 0)
          start[low + 2]++;
        else
          list[start[low + 1]++] = (bwi_keyed){(uint64_t)high, t, k};
      }
    for (int32_t i = 0; round == 0 && i <= s->point_count; i++)
      start[i + 1] += start[i];
  }
  int32_t count = 0;
  for (int32_t i = 0; i < s->point_count; i++) {
    bwi_sort_keyed(list + start[i], start[i + 1] - start[i]);
    for (int64_t j = start[i]; j < start[i + 1]; j++) {
      count += j == start[i] || list[j].key != list[j - 1].key;
      p->edge[3 * (size_t)list[j].item + (size_t)list[j].part] = count - 1;
    }
  }
  p->edge_count = count;
  p->end = BW_NEW(context, int32_t, 2 * (size_t)count);
  p->square = BW_NEW(context, double, count);
  p->marked = BW_NEW0(context, uint8_t, count);
  p->middle = BW_NEW(context, int32_t, count);
  BW_TRY_MEMORY(p->end && p->square && p->marked && p->middle);
  for (int32_t i = 0; i < s->point_count; i++)
    for (int64_t j = start[i]; j < start[i + 1]; j++) {
      int32_t e = p->edge[3 * (size_t)list[j].item + (size_t)list[j].part];
      p->end[2 * (size_t)e] = i;
      p->end[2 * (size_t)e + 1] = (int32_t)list[j].key;
    }
done:
  bw_free(list);
  bw_free(start);
  return status;
}

/* Which side of triangle t is its longest. */
static int longest(const pass *p, int32_t t) {
  const int32_t *e = p->edge + 3 * (size_t)t;
  int best = 0;
  for (int k = 1; k < 3; k++)
    if (p->square[e[k]] > p->square[e[best]] ||
        (p->square[e[k]] == p->square[e[best]] && e[k] < e[best]))
      best = k;
  return best;
}

/* Mark what is too long and what must be cut with it; returns the number of cuts. */
static bw_status mark(bw_context *context, pass *p, const bw_size_field *field, double slack,
                      int32_t *cuts) {
  const double *x = p->surface->point;
  *cuts = 0;
  for (int32_t e = 0; e < p->edge_count; e++) {
    const double *a = x + 3 * (size_t)p->end[2 * (size_t)e];
    const double *b = x + 3 * (size_t)p->end[2 * (size_t)e + 1];
    double d[3], middle[3];
    for (int k = 0; k < 3; k++) {
      d[k] = b[k] - a[k];
      middle[k] = (a[k] + b[k]) / 2;
    }
    p->square[e] = bw_dot(d, d);
    double wanted = bwi_size_at(field, middle);
    if (wanted < 0)
      return bw_fail(
          context, BW_INVALID,
          "the size function returned no length at (%g, %g, %g) m: it must return an edge "
          "length in m, or 0 for no bound",
          middle[0], middle[1], middle[2]);
    p->marked[e] = wanted > 0 && p->square[e] > slack * slack * wanted * wanted;
    *cuts += p->marked[e];
  }
  /* Chains of ever longer edges run either way through the list: so do the sweeps. */
  bool changed = *cuts > 0;
  for (int sweep = 0; changed; sweep++) {
    int32_t count = p->surface->triangle_count;
    changed = false;
    for (int32_t i = 0; i < count; i++) {
      int32_t t = sweep % 2 ? count - 1 - i : i;
      const int32_t *e = p->edge + 3 * (size_t)t;
      int32_t cut = e[longest(p, t)];
      if (!p->marked[cut] && (p->marked[e[0]] || p->marked[e[1]] || p->marked[e[2]])) {
        p->marked[cut] = 1;
        ++*cuts;
        changed = true;
      }
    }
    bwi_progress_again(context); /* who is shown it may cancel */
    bw_status status = bwi_time_limit_check(context, &p->time);
    if (status != BW_OK)
      return status;
  }
  return bwi_time_limit_check(context, &p->time);
}

static bw_status cut(bw_context *context, pass *p, int32_t cuts, bw_surface **out) {
  const bw_surface *s = p->surface;
  bw_status status = BW_OK;
  size_t points = (size_t)s->point_count, triangles = 0, at = 0;
  for (int32_t t = 0; t < s->triangle_count; t++)
    for (size_t k = 0; k < 3; k++)
      triangles += p->marked[p->edge[3 * (size_t)t + k]];
  triangles += (size_t)s->triangle_count;
  double *point = BW_NEW(context, double, 3 * (points + (size_t)cuts));
  int32_t *triangle = BW_NEW(context, int32_t, 3 * triangles);
  int32_t *group = s->group ? BW_NEW(context, int32_t, triangles) : NULL;
  BW_TRY_MEMORY(point && triangle && (!s->group || group));
  memcpy(point, s->point, 3 * points * sizeof *point);
  for (int32_t e = 0; e < p->edge_count; e++) {
    p->middle[e] = -1;
    if (!p->marked[e])
      continue;
    const double *a = s->point + 3 * (size_t)p->end[2 * (size_t)e];
    const double *b = s->point + 3 * (size_t)p->end[2 * (size_t)e + 1];
    for (size_t k = 0; k < 3; k++)
      point[3 * points + k] = (a[k] + b[k]) / 2;
    p->middle[e] = (int32_t)points++;
  }
  for (int32_t t = 0; t < s->triangle_count; t++) {
    size_t first = at;
    int k = longest(p, t);
    const int32_t *c = s->triangle + 3 * (size_t)t, *e = p->edge + 3 * (size_t)t;
    int32_t a = c[k], b = c[(k + 1) % 3], o = c[(k + 2) % 3];
    int32_t ab = p->middle[e[k]], bo = p->middle[e[(k + 1) % 3]], oa = p->middle[e[(k + 2) % 3]];
    int32_t piece[4][3];
    int pieces = 0;
#define PIECE(x, y, z) memcpy(piece[pieces++], (int32_t[3]){x, y, z}, sizeof piece[0])
    if (ab < 0) {
      PIECE(a, b, o);
    } else {
      if (oa < 0) {
        PIECE(a, ab, o);
      } else {
        PIECE(a, ab, oa);
        PIECE(oa, ab, o);
      }
      if (bo < 0) {
        PIECE(ab, b, o);
      } else {
        PIECE(ab, b, bo);
        PIECE(ab, bo, o);
      }
    }
#undef PIECE
    memcpy(triangle + 3 * at, piece, (size_t)pieces * sizeof piece[0]);
    at += (size_t)pieces;
    for (size_t i = first; group && i < at; i++)
      group[i] = s->group[t];
  }
  BW_TRY(bw_surface_adopt(context, (int64_t)points, point, (int64_t)at, triangle, group, out));
  bwi_keep_names(s, *out);
done:
  if (status != BW_OK) {
    bw_free(point);
    bw_free(triangle);
    bw_free(group);
  }
  return status;
}

bw_status bwi_refine_surface(bw_context *context, const bw_surface *surface,
                             const bw_size_field *field, double slack, int64_t limit,
                             double seconds, bw_surface **refined) {
  bw_status status = BW_OK;
  bw_surface *now = bw_retain(surface);
  pass p = {.surface = NULL};
  bwi_time_limit time =
      bwi_time_limit_begin("refining the surface to the requested sizes", seconds);
  for (;;) { /* every pass adds facets, of which there may be `limit` */
    int32_t cuts;
    p = (pass){.surface = now, .time = time};
    BW_TRY(number_edges(context, &p));
    BW_TRY(mark(context, &p, field, slack, &cuts));
    if (cuts == 0)
      break;
    if (now->triangle_count + 2 * (int64_t)cuts > limit)
      BW_TRY(bw_fail(
          context, BW_LIMIT,
          "the requested sizes need more than %lld facets on the surface alone: give larger sizes",
          (long long)limit));
    bw_surface *next;
    BW_TRY(cut(context, &p, cuts, &next));
    pass_clear(&p);
    p = (pass){.surface = NULL};
    bw_release(now);
    now = next;
  }
  *refined = now;
  now = NULL;
done:
  pass_clear(&p);
  bw_release(now);
  return status;
}
