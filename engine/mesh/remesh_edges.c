/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Splitting, collapsing, and the sizes wanted where features are small. */
#include <stdlib.h>
#include <string.h>

#include "mesh/remesh.h"

/* ---- split ---------------------------------------------------------------------------------- */

/* Is a side, relative to what is wanted, the longest of both facets along it? Splitting others
 * first would leave ever thinner triangles. */
static bool is_longest(const bwi_changing *mesh, int32_t side, double ratio) {
  int32_t other = mesh->opposite[side];
  const int32_t sides[4] = {bwi_next(side), bwi_previous(side), bwi_next(other),
                            bwi_previous(other)};
  for (int k = 0; k < 4; k++)
    if (side_length(mesh, sides[k]) > 1.0001 * ratio * wanted(mesh, sides[k]))
      return false;
  return true;
}

bw_status bwi_remesh_split_long(bwi_remesher *r) {
  bwi_changing *mesh = r->mesh;
  bw_status status = BW_OK;
  for (int pass = 0; pass < 100; pass++) {
    int64_t splits = 0;
    int32_t sides = 3 * (int32_t)mesh->facet_count;
    if ((double)mesh->facet_count > r->max_facets)
      break; /* needles that come out of needles: better too long than without end */
    for (int32_t s = 0; s < sides; s++) {
      BW_TRY(check_limits(r, (size_t)s));
      if (mesh->corner[s] < 0 || s > mesh->opposite[s])
        continue;
      double ratio = side_length(mesh, s) / wanted(mesh, s);
      if (ratio <= longest || !is_longest(mesh, s, ratio) ||
          (ratio <= chord * longest && bwi_remesh_is_chord(r, s)))
        continue;
      double at[3];
      int32_t made;
      const double *a = bwi_at(mesh, bwi_from(mesh, s)), *b = bwi_at(mesh, bwi_to(mesh, s));
      for (int k = 0; k < 3; k++)
        at[k] = 0.5 * (a[k] + b[k]);
      BW_TRY(bwi_split(mesh, s, at, &made));
      mesh->size[made] = fmin(mesh->size[made], bwi_remesh_size_near(r, at));
      splits++;
    }
    if (splits == 0)
      break;
  }
done:
  return status;
}

/* ---- collapse ------------------------------------------------------------------------------ */

typedef enum verdict { FINE, REFUSED, FEATURE } verdict;

/* May the start of a side go to its end? FEATURE: no, because something small would be lost. */
static verdict check_collapse(const bwi_remesher *r, int32_t side, bool coarse) {
  const bwi_changing *mesh = r->mesh;
  int32_t a = bwi_from(mesh, side), b = bwi_to(mesh, side);
  bool tiny = side_length(mesh, side) < r->tiny;
  if (!tiny &&
      (mesh->fixed[a] == BWI_CORNER || (mesh->fixed[a] == BWI_CREASE && !mesh->sharp[side])))
    return FEATURE;
  if (!bwi_may_collapse(mesh, side))
    return FEATURE;
  const double *xa = bwi_at(mesh, a), *xb = bwi_at(mesh, b);
  double limit = bwi_remesh_slack(r, fmin(mesh->size[a], mesh->size[b])), nearest = HUGE_VAL;
  double worst_before = 1, worst_after = 1;
  bool too_long = false;
  /* Very short edges may go at the price of long ones, which are split again. */
  double max = side_length(mesh, side) < 0.4 * wanted(mesh, side) ? 1.25 * longest : longest;
  int32_t s = bwi_around(mesh, side);
  for (; s != side; s = bwi_around(mesh, s)) {
    int32_t q = bwi_to(mesh, s), p = bwi_to(mesh, bwi_next(s));
    if (mesh->sharp[s] && !tiny) {
      if (!bwi_remesh_near_crease(r, xb, bwi_at(mesh, q), limit))
        return FEATURE;
    }
    if (q == b || p == b)
      continue;
    const double *xq = bwi_at(mesh, q), *xp = bwi_at(mesh, p);
    double before[3], after[3], place[3];
    double quality_before = quality(xa, xq, xp), quality_after = quality(xb, xq, xp);
    worst_before = fmin(worst_before, quality_before);
    worst_after = fmin(worst_after, quality_after);
    normal_of(xa, xq, xp, before);
    normal_of(xb, xq, xp, after);
    if (quality_before > 1e-6 && turns_too_far(before, after))
      return FEATURE;
    double reach = distance(xb, xq);
    if (reach > max * 0.5 * (mesh->size[b] + mesh->size[q]) && reach > distance(xa, xq))
      too_long = true;
    nearest = fmin(nearest, bwi_nearest_on_triangle(xa, xb, xq, xp, place));
  }
  if (coarse ? worst_after < 1e-4 && worst_after < worst_before
             : too_long || (worst_after < 0.1 && worst_after < 0.5 * worst_before))
    return REFUSED;
  if (nearest > limit * limit)
    return FEATURE;
  for (s = bwi_around(mesh, side); s != side; s = bwi_around(mesh, s)) {
    int32_t q = bwi_to(mesh, s), p = bwi_to(mesh, bwi_next(s));
    if (q != b && p != b &&
        !bwi_remesh_facet_near_surface(r, xb, bwi_at(mesh, q), bwi_at(mesh, p), limit))
      return FEATURE;
  }
  return FINE;
}

typedef struct short_side {
  double ratio;
  int32_t side, from, to; /* the ends tell whether the side is still the same edge */
} short_side;

static int by_ratio(const void *a, const void *b) {
  const short_side *x = (const short_side *)a, *y = (const short_side *)b;
  if (x->ratio != y->ratio)
    return x->ratio < y->ratio ? -1 : 1;
  return (x->side > y->side) - (x->side < y->side);
}

/* Collapse what may be, shortest first. With `learn`, note where features keep edges short. */
bw_status bwi_remesh_collapse_short(bwi_remesher *r, bool coarse, bool learn) {
  bwi_changing *mesh = r->mesh;
  bw_status status = BW_OK;
  short_side *list = NULL;
  size_t capacity = 0;
  for (int pass = 0; pass < 6; pass++) {
    size_t count = 0;
    int64_t done_count = 0;
    for (int32_t s = 0; s < 3 * (int32_t)mesh->facet_count; s++) {
      if (mesh->corner[s] < 0 || s > mesh->opposite[s])
        continue;
      double ratio = side_length(mesh, s) / wanted(mesh, s);
      if (ratio >= shortest)
        continue;
      BW_TRY_MEMORY(bw_grow(r->context, (void **)&list, &capacity, count, 1, sizeof *list));
      list[count++] = (short_side){ratio, s, bwi_from(mesh, s), bwi_to(mesh, s)};
    }
    if (count > 1)
      qsort(list, count, sizeof *list, by_ratio);
    BW_TRY(bw_check_cancel(r->context));
    for (size_t i = 0; i < count; i++) {
      int32_t s = list[i].side;
      BW_TRY(check_limits(r, i));
      if (mesh->corner[s] != list[i].from || bwi_to(mesh, s) != list[i].to ||
          side_length(mesh, s) >= shortest * wanted(mesh, s))
        continue;
      int32_t o = mesh->opposite[s];
      /* the freer end goes */
      if (mesh->fixed[bwi_from(mesh, s)] > mesh->fixed[bwi_from(mesh, o)]) {
        int32_t keep = s;
        s = o;
        o = keep;
      }
      verdict there = check_collapse(r, s, coarse), back = REFUSED;
      if (there != FINE) {
        back = check_collapse(r, o, coarse);
        s = o;
      }
      if (there == FINE || back == FINE) {
        int32_t b = bwi_to(mesh, s);
        mesh->size[b] = fmin(mesh->size[b], mesh->size[bwi_from(mesh, s)]);
        if (mesh->fixed[bwi_from(mesh, s)] > mesh->fixed[b])
          mesh->fixed[b] = mesh->fixed[bwi_from(mesh, s)];
        bwi_collapse(mesh, s);
        done_count++;
      } else if (learn && there == FEATURE && back == FEATURE && pass == 0) {
        double size = fmax(1.8 * side_length(mesh, s), r->finest * r->length);
        int32_t ends[2] = {bwi_from(mesh, s), bwi_to(mesh, s)};
        for (int k = 0; k < 2; k++)
          mesh->size[ends[k]] = fmin(mesh->size[ends[k]], size);
      }
    }
    if (done_count == 0)
      break;
  }
done:
  bw_free(list);
  return status;
}

/* Let the wanted length grow no faster than it may. */
void bwi_remesh_grade(bwi_changing *mesh) {
  for (int sweep = 0; sweep < 20; sweep++) {
    bool changed = false;
    for (int32_t s = 0; s < 3 * (int32_t)mesh->facet_count; s++) {
      if (mesh->corner[s] < 0)
        continue;
      int32_t a = bwi_from(mesh, s), b = bwi_to(mesh, s);
      double max = mesh->size[a] + growth * side_length(mesh, s);
      if (mesh->size[b] > 1.0001 * max) {
        mesh->size[b] = max;
        changed = true;
      }
    }
    if (!changed)
      break;
  }
}
