/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Coarsening of a surface that never makes it intersect itself: edges shorter than the wanted
 * length there are collapsed, the shortest first, as long as the facets that change stay well
 * shaped, keep their sides, and meet no other facet. Where walls are thinner than the wanted length
 * the surface stays finer instead of cutting through itself.
 *
 * Between passes of collapses, diagonals of nearly flat pairs of facets are exchanged where that
 * makes the worse of the two facets better.
 *
 * A collapsed edge's point goes where the squared distances from the planes of all the facets that
 * ended up in it are minimal (Garland and Heckbert), drawn a little to the middle of the edge: flat
 * parts stay flat and creases stay in place. */
#include "mesh/coarsen.h"

static void clear(bwi_coarsening *c) {
  bw_free(c->x);
  bw_free(c->corner);
  bw_free(c->quadric);
  bw_free(c->first);
  bw_free(c->next);
  bw_free(c->bucket);
  bw_free(c->list);
  bw_free(c->big);
  bw_free(c->lost);
  bw_free(c->hint);
  bw_free(c->seen);
  bwi_tree_destroy(c->tree);
}

/* The plane's quadric, weighted by area, to each corner. */
static void add_quadric(bwi_coarsening *c, int32_t triangle) {
  const double *x[3];
  double n[3];
  for (int k = 0; k < 3; k++)
    x[k] = place(c, c->corner[3 * (size_t)triangle + (size_t)k]);
  normal_of(x, n);
  double size = bw_norm(n);
  if (!(size > 0))
    return;
  double d = -bw_dot(n, x[0]);
  double q[10] = {n[0] * n[0], n[0] * n[1], n[0] * n[2], n[1] * n[1], n[1] * n[2],
                  n[2] * n[2], n[0] * d,    n[1] * d,    n[2] * d,    d * d};
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 10; i++)
      c->quadric[c->corner[3 * (size_t)triangle + (size_t)k]][i] += q[i] / size;
}

static bw_status set_up(bwi_coarsening *c, const bw_surface *surface) {
  size_t points = (size_t)surface->point_count, triangles = (size_t)surface->triangle_count;
  double low[3], high[3];
  c->points = surface->point_count;
  c->triangles = surface->triangle_count;
  c->buckets = 1024;
  while (c->buckets < 2 * triangles)
    c->buckets *= 2;
  c->x = BW_NEW(c->context, double, 3 * points);
  c->corner = BW_NEW(c->context, int32_t, 3 * triangles);
  c->quadric = bw_calloc(c->context, points, sizeof *c->quadric);
  c->first = BW_NEW(c->context, int32_t, points);
  c->next = BW_NEW(c->context, int32_t, 3 * triangles);
  c->bucket = BW_NEW(c->context, int64_t, c->buckets);
  c->lost = BW_NEW0(c->context, double, points);
  c->hint = BW_NEW(c->context, int32_t, points);
  c->seen = BW_NEW0(c->context, int32_t, triangles);
  if (!c->x || !c->corner || !c->quadric || !c->first || !c->next || !c->bucket || !c->lost ||
      !c->hint || !c->seen)
    return BW_MEMORY;
  bw_surface_box(surface, low, high);
  for (int k = 0; k < 3; k++)
    c->origin[k] = (low[k] + high[k]) / 2;
  for (size_t i = 0; i < 3 * points; i++)
    c->x[i] = surface->point[i] - c->origin[i % 3];
  memcpy(c->corner, surface->triangle, 3 * triangles * sizeof *c->corner);
  for (size_t i = 0; i < points; i++)
    c->first[i] = -1;
  for (size_t i = 3 * triangles; i-- > 0;) {
    c->next[i] = c->first[c->corner[i]];
    c->first[c->corner[i]] = (int32_t)i;
    c->hint[c->corner[i]] = (int32_t)(i / 3);
  }
  for (int32_t t = 0; t < c->triangles; t++)
    add_quadric(c, t);
  return BW_OK;
}

/* Enter everything that lives in a fresh grid. */
static bw_status fresh_grid(bwi_coarsening *c) {
  c->entries = c->big_count = 0;
  for (size_t i = 0; i < c->buckets; i++)
    c->bucket[i] = -1;
  for (int32_t t = 0; t < c->triangles; t++)
    if (c->corner[3 * (size_t)t] >= 0 && !bwi_coarsen_enter(c, t))
      return BW_MEMORY;
  return BW_OK;
}

/* Collapse to this length. Where shapes bring that to a halt, worse ones are accepted for a while:
 * exchanges and moves repair them afterwards. */
static bw_status coarsen_to(bwi_coarsening *c, double length, double shorter) {
  static const double contact_planes[] = {0.45, 0.3, 0.15};
  bw_status status = BW_OK;
  c->length = length;
  c->shorter = shorter;
  int easier = 0;
  for (int i = 0; i < 12; i++) {
    int64_t collapsed, living = 0;
    c->floor = contact_planes[easier];
    BW_TRY(fresh_grid(c));
    BW_TRY(bwi_coarsen_collapse(c, &collapsed));
    BW_TRY(bwi_coarsen_exchange(c));
    BW_TRY(bwi_coarsen_move(c));
    for (int32_t t = 0; t < c->triangles; t++)
      living += c->corner[3 * (size_t)t] >= 0;
    if (collapsed > living / 100)
      continue;
    if (easier == 2)
      break;
    easier++;
  }
  for (int i = 0; i < 2; i++) {
    BW_TRY(bwi_coarsen_exchange(c));
    BW_TRY(bwi_coarsen_move(c));
  }
done:
  return status;
}

static bw_status hand_over(bwi_coarsening *c, bw_surface **out) {
  int32_t triangles = 0, points = 0;
  for (int32_t i = 0; i < c->points; i++)
    c->first[i] = -1; /* from here on: the new number */
  for (int32_t t = 0; t < c->triangles; t++) {
    if (c->corner[3 * (size_t)t] < 0)
      continue;
    for (size_t k = 0; k < 3; k++)
      c->first[c->corner[3 * (size_t)t + k]] = 0;
    memmove(c->corner + 3 * (size_t)triangles++, c->corner + 3 * (size_t)t, 3 * sizeof *c->corner);
  }
  for (int32_t i = 0; i < c->points; i++)
    if (c->first[i] == 0) {
      for (size_t k = 0; k < 3; k++)
        c->x[3 * (size_t)points + k] = c->x[3 * (size_t)i + k] + c->origin[k];
      c->first[i] = points++;
    }
  for (size_t i = 0; i < 3 * (size_t)triangles; i++)
    c->corner[i] = c->first[c->corner[i]];
  return bw_surface_copy(c->context, points, c->x, triangles, c->corner, NULL, out);
}

bw_status bwi_coarsen_surface(bw_context *context, const bw_surface *surface,
                              const bwi_coarsen_options *options, bw_surface **coarsened) {
  double length = options->length, shorter = options->shorter;
  bwi_coarsening c = {.context = context,
                      .options = options,
                      .time = bwi_time_limit_begin("coarsening the surface", options->seconds)};
  bw_status status;
  BW_TRY(set_up(&c, surface));
  if (options->allowed > 0)
    BW_TRY(bwi_tree_create(context, surface->point, surface->triangle_count, surface->triangle,
                           NULL, &c.tree));
  /* Step by step from the present length: a grid of long cells would hold too many small
   * triangles each. */
  double area = bw_surface_area(surface), now = sqrt(area / (0.4330127 * c.triangles));
  for (now = fmax(1.5 * now, 1e-4 * length); now < 0.75 * length && now < shorter; now *= 1.8)
    BW_TRY(coarsen_to(&c, now, 0.8 * now));
  BW_TRY(coarsen_to(&c, length, shorter));
  BW_TRY(hand_over(&c, coarsened));
done:
  clear(&c);
  return status;
}
