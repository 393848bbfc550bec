/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Flat regions of a surface and their smooth borders, which faces are made of (faces.c). */
#include "mesh/faces_internal.h"

#include <math.h>
#include <stdlib.h>

#include "mesh/surface_internal.h"

static const double flat_angle = 2 * 0.017453292519943295;
static const double flat_distance = 2e-5; /* of the diagonal: rounding in files */

/* The facet across side k of facet t, or -1 where there is not just one. */
static int32_t across_side(const bwi_topology *top, int32_t t, int k) {
  int64_t edge = top->edge_of[3 * (int64_t)t + k];
  if (edge < 0 || top->start[edge + 1] - top->start[edge] != 2)
    return -1;
  int64_t side = top->side[top->start[edge]];
  if (side / 3 == t)
    side = top->side[top->start[edge] + 1];
  return side / 3 == t ? -1 : (int32_t)(side / 3);
}

typedef struct sized {
  double size;
  int32_t item;
} sized;

static int by_size(const void *a, const void *b) {
  const sized *x = (const sized *)a, *y = (const sized *)b;
  if (x->size != y->size)
    return x->size > y->size ? -1 : 1;
  return (x->item > y->item) - (x->item < y->item);
}

/* 0 .. count - 1 by descending size. */
bw_status bwi_order_by(bw_context *context, int32_t count, const double *size, int32_t *order) {
  sized *list = BW_NEW(context, sized, count);
  if (!list)
    return BW_MEMORY;
  for (int32_t i = 0; i < count; i++)
    list[i] = (sized){size[i], i};
  if (count > 1)
    qsort(list, (size_t)count, sizeof *list, by_size);
  for (int32_t i = 0; i < count; i++)
    order[i] = list[i].item;
  bw_free(list);
  return BW_OK;
}

bw_status bwi_faces_measure(bwi_face_finder *f) {
  const bwi_topology *top = f->top;
  size_t facets = (size_t)top->facets;
  f->normal = BW_NEW0(f->context, double, 3 * facets);
  f->area = BW_NEW0(f->context, double, facets);
  f->order = BW_NEW(f->context, int32_t, facets);
  f->label = BW_NEW(f->context, int32_t, facets);
  f->seen = BW_NEW0(f->context, uint8_t, top->points);
  if (!f->normal || !f->area || !f->order || !f->label || !f->seen)
    return BW_MEMORY;
  for (int32_t t = 0; t < top->facets; t++) {
    double n[3];
    f->label[t] = -1;
    if (top->degenerate[t])
      continue;
    bwi_facet_normal(top->point, top->corner + 3 * (size_t)t, n);
    double size = bw_norm(n);
    f->area[t] = size / 2;
    for (int k = 0; k < 3 && size > 0; k++)
      f->normal[3 * (size_t)t + (size_t)k] = n[k] / size;
  }
  return bwi_order_by(f->context, top->facets, f->area, f->order);
}

/* ---- flat regions ---------------------------------------------------------------------------- */

static bool lies_on(const bwi_face_finder *f, int32_t t, const double normal[3],
                    const double origin[3]) {
  const double *n = f->normal + 3 * (size_t)t;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int k = 0; k < 3; k++) {
    const double *x = f->top->point + 3 * (size_t)f->top->corner[3 * (size_t)t + (size_t)k];
    double d[3] = {x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]};
    double away = bw_dot(d, normal);
    low = fmin(low, away);
    high = fmax(high, away);
  }
  double limit = flat_distance * f->diagonal;
  return low >= -limit && high <= limit &&
         (bw_dot(n, normal) >= cos(flat_angle) || f->area[t] < limit * limit);
}

bw_status bwi_find_regions(bwi_face_finder *f) {
  const bwi_topology *top = f->top;
  int32_t *stack = BW_NEW(f->context, int32_t, top->facets);
  if (!stack)
    return BW_MEMORY;
  for (int32_t i = 0; i < top->facets; i++) {
    int32_t seed = f->order[i], depth = 0;
    if (f->label[seed] >= 0)
      continue;
    const double *origin = top->point + 3 * (size_t)top->corner[3 * (size_t)seed];
    f->label[seed] = f->regions;
    stack[depth++] = seed;
    while (depth > 0) {
      int32_t t = stack[--depth];
      for (int k = 0; k < 3; k++) {
        int32_t next = across_side(top, t, k);
        if (next >= 0 && f->label[next] < 0 &&
            lies_on(f, next, f->normal + 3 * (size_t)seed, origin)) {
          f->label[next] = f->regions;
          stack[depth++] = next;
        }
      }
    }
    f->regions++;
  }
  bw_free(stack);
  return BW_OK;
}

static int by_regions(const void *a, const void *b) {
  const bwi_link *x = (const bwi_link *)a, *y = (const bwi_link *)b;
  return x->from != y->from ? (x->from > y->from) - (x->from < y->from)
                            : (x->to > y->to) - (x->to < y->to);
}

/* Members and areas of the regions, and the lengths of their smooth borders. */
bw_status bwi_link_regions(bwi_face_finder *f) {
  const bwi_topology *top = f->top;
  size_t regions = (size_t)f->regions;
  f->region_area = BW_NEW0(f->context, double, regions);
  f->first = BW_NEW0(f->context, int32_t, regions + 1);
  f->member = BW_NEW(f->context, int32_t, top->facets);
  f->link_start = BW_NEW0(f->context, int64_t, regions + 1);
  f->face_of = BW_NEW(f->context, int32_t, regions);
  if (!f->region_area || !f->first || !f->member || !f->link_start || !f->face_of)
    return BW_MEMORY;
  for (int32_t t = 0; t < top->facets; t++) {
    f->region_area[f->label[t]] += f->area[t];
    f->first[f->label[t] + 1]++;
  }
  for (size_t r = 0; r < regions; r++) {
    f->first[r + 1] += f->first[r];
    f->face_of[r] = -1;
  }
  for (int32_t t = top->facets - 1; t >= 0; t--) /* ends as cursors: they become the starts */
    f->member[--f->first[f->label[t] + 1]] = t;
  for (size_t r = 0; r < regions; r++)
    f->first[r] = f->first[r + 1];
  f->first[regions] = top->facets;
  for (int32_t t = 0; t < top->facets; t++)
    for (int k = 0; k < 3; k++) {
      int32_t next = across_side(top, t, k);
      if (next < 0 || f->label[next] == f->label[t] ||
          bw_dot(f->normal + 3 * (size_t)t, f->normal + 3 * (size_t)next) < f->smooth)
        continue;
      const double *a = top->point + 3 * (size_t)bwi_side_from(top, 3 * (int64_t)t + k);
      const double *b = top->point + 3 * (size_t)bwi_side_to(top, 3 * (int64_t)t + k);
      double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      if (!bw_grow(f->context, (void **)&f->links, &f->link_capacity, f->link_count, 1,
                   sizeof *f->links))
        return BW_MEMORY;
      f->links[f->link_count++] = (bwi_link){f->label[t], f->label[next], bw_norm(d)};
    }
  if (f->link_count > 1)
    qsort(f->links, f->link_count, sizeof *f->links, by_regions);
  size_t kept = 0;
  for (size_t i = 0; i < f->link_count; i++)
    if (kept > 0 && f->links[kept - 1].from == f->links[i].from &&
        f->links[kept - 1].to == f->links[i].to)
      f->links[kept - 1].length += f->links[i].length;
    else
      f->links[kept++] = f->links[i];
  f->link_count = kept;
  for (size_t i = 0; i < kept; i++)
    f->link_start[f->links[i].from + 1]++;
  for (size_t r = 0; r < regions; r++)
    f->link_start[r + 1] += f->link_start[r];
  return BW_OK;
}
