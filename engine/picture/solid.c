/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Preparing a solid for drawing: its pixels, the normals that shade it smoothly, its sharp
 * edges. */
#include <math.h>
#include <string.h>

#include "picture/internal.h"

/* Around points where more facets meet than this (the middle of a fine fan), facets keep their own
 * normal: averaging is quadratic in this number. */
enum { MAX_AROUND = 2000, GRAIN = 4096 };
/* Sharper than this an edge gets a line; the rough surface of a scan has many at 40 degrees. */
#define LINE_COSINE 0.5

void bwi_solid_clear(bwi_solid *solid) {
  bw_free(solid->point);
  bw_free(solid->triangle);
  bw_free(solid->pixel);
  bw_free(solid->normal);
  bw_free(solid->lines);
  memset(solid, 0, sizeof *solid);
}

typedef struct job {
  bwi_solid *solid;
  const bwi_view *view;
  double cosine; /* of the crease angle */
  float *facet;  /* triangle_count x 4: unit normal in the view's axes, and area */
  int64_t *start;
  int32_t *around; /* facets at each point */
} job;

static bw_status facet_normals(void *data, int64_t begin, int64_t end, int worker) {
  job *j = (job *)data;
  const bwi_solid *solid = j->solid;
  (void)worker;
  for (int64_t f = begin; f < end; f++) {
    const int32_t *t = solid->triangle + 3 * f;
    const double *x = solid->point + 3 * (size_t)t[0], *p = solid->point + 3 * (size_t)t[1];
    const double *q = solid->point + 3 * (size_t)t[2];
    double a[3], b[3], n[3], scale = j->view->scale;
    for (int k = 0; k < 3; k++) {
      a[k] = scale * (p[k] - x[k]);
      b[k] = scale * (q[k] - x[k]);
    }
    bw_cross(a, b, n);
    double size = bw_norm(n);
    float *out = j->facet + 4 * f;
    for (int k = 0; k < 3; k++)
      out[k] = (float)(size > 0 ? bw_dot(n, j->view->axis[k]) / size : k == 2);
    out[3] = (float)size;
  }
  return BW_OK;
}

/* The facet beyond the edge a b of facet f, or -1. */
static int32_t across(const job *j, int64_t f, int32_t a, int32_t b) {
  for (int64_t i = j->start[a]; i < j->start[a + 1]; i++) {
    int32_t g = j->around[i];
    const int32_t *t = j->solid->triangle + 3 * (size_t)g;
    if (g != f && (t[0] == b || t[1] == b || t[2] == b))
      return g;
  }
  return -1;
}

static float cosine_between(const float *a, const float *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bw_status corner_normals(void *data, int64_t begin, int64_t end, int worker) {
  job *j = (job *)data;
  bwi_solid *solid = j->solid;
  (void)worker;
  for (int64_t f = begin; f < end; f++) {
    const float *own = j->facet + 4 * f;
    const int32_t *t = solid->triangle + 3 * f;
    uint8_t lines = 0;
    for (int k = 0; k < 3; k++) {
      int32_t point = t[k];
      double sum[3] = {0, 0, 0};
      bool crowded = j->start[point + 1] - j->start[point] > MAX_AROUND;
      for (int64_t i = j->start[point]; i < j->start[point + 1] && !crowded; i++) {
        const float *other = j->facet + 4 * (size_t)j->around[i];
        if (cosine_between(own, other) >= j->cosine)
          for (int l = 0; l < 3; l++)
            sum[l] += (double)other[3] * other[l];
      }
      double size = bw_norm(sum);
      for (int l = 0; l < 3; l++)
        solid->normal[9 * f + 3 * k + l] = size > 0 ? (float)(sum[l] / size) : own[l];
      if (crowded)
        continue;
      int32_t g = across(j, f, point, t[(k + 1) % 3]);
      if (g < 0 || cosine_between(own, j->facet + 4 * (size_t)g) < LINE_COSINE)
        lines |= (uint8_t)(1 << k);
    }
    solid->lines[f] = lines;
  }
  return BW_OK;
}

bw_status bwi_solid_prepare(bw_context *context, bwi_solid *solid, const bwi_view *view,
                            double crease, double push) {
  job j = {.solid = solid, .view = view, .cosine = cos(crease)};
  size_t points = (size_t)solid->point_count, facets = (size_t)solid->triangle_count;
  bw_status status = BW_OK;
  solid->pixel = BW_NEW(context, float, 3 * points);
  solid->normal = BW_NEW(context, float, 9 * facets);
  solid->lines = BW_NEW0(context, uint8_t, facets);
  j.facet = BW_NEW(context, float, 4 * facets);
  j.start = BW_NEW0(context, int64_t, points + 1);
  j.around = BW_NEW(context, int32_t, 3 * facets);
  BW_TRY_MEMORY(solid->pixel && solid->normal && solid->lines && j.facet && j.start && j.around);
  for (size_t i = 0; i < points; i++) {
    double pixel[3];
    bwi_view_project(view, solid->point + 3 * i, pixel);
    for (int k = 0; k < 3; k++)
      solid->pixel[3 * i + (size_t)k] = (float)(pixel[k] + (k == 2 ? push : 0));
  }
  for (size_t c = 0; c < 3 * facets; c++)
    j.start[solid->triangle[c] + 1]++;
  for (size_t i = 0; i < points; i++)
    j.start[i + 1] += j.start[i];
  for (size_t c = 3 * facets; c-- > 0;) /* ends as cursors: they become the starts */
    j.around[--j.start[solid->triangle[c] + 1]] = (int32_t)(c / 3);
  memmove(j.start, j.start + 1, points * sizeof *j.start);
  j.start[points] = (int64_t)(3 * facets);
  BW_TRY(bw_parallel(context, solid->triangle_count, GRAIN, facet_normals, &j));
  BW_TRY(bw_parallel(context, solid->triangle_count, GRAIN, corner_normals, &j));
done:
  bw_free(j.facet);
  bw_free(j.start);
  bw_free(j.around);
  return status;
}

void bwi_solid_behind(bwi_solid *solid, int count, const bwi_solid *others, double gap) {
  float far = HUGE_VALF, close = -HUGE_VALF;
  for (size_t i = 0; i < (size_t)solid->point_count; i++)
    close = fmaxf(close, solid->pixel[3 * i + 2]);
  for (int k = 0; k < count; k++)
    for (size_t i = 0; i < (size_t)others[k].point_count; i++)
      far = fminf(far, others[k].pixel[3 * i + 2]);
  double behind = (double)close - (double)far + gap;
  for (size_t i = 0; i < (size_t)solid->point_count; i++)
    solid->pixel[3 * i + 2] -= (float)behind;
}
