/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Points and facets as a reader meets them, on their way to a surface. Groups are numbered in the
 * order of their first facet; a surface of one group gets no group array. */
#include "base/sort.h"
#include "io/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void bwi_soup_init(bwi_soup *soup, bw_context *context, const char *name) {
  memset(soup, 0, sizeof *soup);
  soup->context = context;
  soup->name = name;
}

void bwi_soup_clear(bwi_soup *soup) {
  bw_free(soup->point);
  bw_free(soup->triangle);
  bw_free(soup->group);
  soup->point = NULL;
  soup->triangle = soup->group = NULL;
}

static bw_status too_many(const bwi_soup *soup, const char *what) {
  bw_fail(soup->context, BW_LIMIT, "%s: more than 2147483647 %s", soup->name, what);
  bw_detail_text(soup->context, "file", soup->name);
  return BW_LIMIT;
}

bw_status bwi_soup_point(bwi_soup *soup, const double point[3]) {
  if (soup->point_count >= INT32_MAX)
    return too_many(soup, "points");
  if (!bw_grow(soup->context, (void **)&soup->point, &soup->point_capacity, soup->point_count, 1,
               3 * sizeof(double)))
    return BW_MEMORY;
  memcpy(soup->point + 3 * soup->point_count++, point, 3 * sizeof(double));
  return BW_OK;
}

/* Room for `count` more facets of the current group; their groups are filled in. */
static bw_status more_facets(bwi_soup *soup, size_t count) {
  if (count > (size_t)INT32_MAX - soup->triangle_count)
    return too_many(soup, "facets");
  if (!bw_grow(soup->context, (void **)&soup->triangle, &soup->triangle_capacity,
               soup->triangle_count, count, 3 * sizeof(int32_t)) ||
      !bw_grow(soup->context, (void **)&soup->group, &soup->group_capacity, soup->triangle_count,
               count, sizeof(int32_t)))
    return BW_MEMORY;
  if (!soup->group_used) {
    soup->group_used = true;
    soup->current_group = soup->group_count++;
  }
  for (size_t i = 0; i < count; i++)
    soup->group[soup->triangle_count + i] = soup->current_group;
  return BW_OK;
}

bw_status bwi_soup_triangle(bwi_soup *soup, int32_t a, int32_t b, int32_t c) {
  bw_status status = more_facets(soup, 1);
  if (status != BW_OK)
    return status;
  int32_t *facet = soup->triangle + 3 * soup->triangle_count++;
  facet[0] = a, facet[1] = b, facet[2] = c;
  return BW_OK;
}

bw_status bwi_soup_polygon(bwi_soup *soup, const int32_t *corner, size_t count) {
  bw_status status = more_facets(soup, count - 2);
  if (status == BW_OK)
    status = bwi_triangulate(soup->context, soup->point, corner, count,
                             soup->triangle + 3 * soup->triangle_count);
  if (status != BW_OK)
    return status;
  soup->triangle_count += count - 2;
  soup->polygons += count > 3;
  return BW_OK;
}

void bwi_soup_next_group(bwi_soup *soup) {
  soup->group_used = false;
}

void bwi_soup_regroup(bwi_soup *soup, size_t first, int32_t group) {
  for (size_t i = first; i < soup->triangle_count; i++)
    soup->group[i] = group;
  soup->numbered = soup->numbered || first < soup->triangle_count;
}

/* How many different numbers there are, when the file gave them. */
static bw_status count_groups(bwi_soup *soup) {
  if (!soup->numbered)
    return BW_OK;
  int32_t *sorted = BW_NEW(soup->context, int32_t, soup->triangle_count);
  if (!sorted)
    return BW_MEMORY;
  memcpy(sorted, soup->group, soup->triangle_count * sizeof *sorted);
  bwi_sort_columns(sorted, (int64_t)soup->triangle_count);
  soup->group_count = 1;
  for (size_t i = 1; i < soup->triangle_count; i++)
    soup->group_count += sorted[i] != sorted[i - 1];
  bw_free(sorted);
  return BW_OK;
}

bw_status bwi_soup_finish(bwi_soup *soup, const char *format, bool weld, bw_surface **surface,
                          bw_read_info *info) {
  bw_status status = BW_OK;
  bw_surface *made = NULL;
  if (soup->triangle_count == 0) {
    bw_fail(soup->context, BW_FORMAT, "%s: the %s file holds no facet (%zu points): nothing to use",
            soup->name, format, soup->point_count);
    bw_detail_text(soup->context, "file", soup->name);
    return BW_FORMAT;
  }
  BW_TRY(count_groups(soup));
  if (soup->group_count < 2) {
    bw_free(soup->group);
    soup->group = NULL;
  }
  /* Growth left up to half of the blocks unused. */
  void *fitted = bw_resize(soup->context, soup->point, soup->point_count, 3 * sizeof(double));
  soup->point = fitted ? (double *)fitted : soup->point;
  fitted = bw_resize(soup->context, soup->triangle, soup->triangle_count, 3 * sizeof(int32_t));
  soup->triangle = fitted ? (int32_t *)fitted : soup->triangle;
  BW_TRY(bw_surface_adopt(soup->context, (int64_t)soup->point_count, soup->point,
                          (int64_t)soup->triangle_count, soup->triangle, soup->group, &made));
  soup->point = NULL;
  soup->triangle = soup->group = NULL;
  if (weld) {
    bw_surface *welded;
    BW_TRY(bw_surface_weld(soup->context, made, 0, &welded));
    bw_release(made);
    made = welded;
  }
  if (info) {
    snprintf(info->format, sizeof info->format, "%s", format);
    info->polygons = soup->polygons;
    info->skipped = soup->skipped;
    info->group_count = soup->group_count;
  }
  *surface = made;
  return BW_OK;
done:
  bw_release(made);
  return status;
}
