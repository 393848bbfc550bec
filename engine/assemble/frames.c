/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The frames of all elements (gather.h), from node positions. */
#include "assemble/gather.h"

#include <math.h>
#include <string.h>

enum { ELEMENTS_PER_CHUNK = 1024 };

double bwi_element_frame(const bw_mesh *mesh, int64_t e, bwi_vector *h) {
  const int32_t *node = mesh->element + e * mesh->nodes_per_element;
  double a[3], b[3], c[3], g[4][3];
  const double *x0 = mesh->node + 3 * (int64_t)node[0], *x1 = mesh->node + 3 * (int64_t)node[1],
               *x2 = mesh->node + 3 * (int64_t)node[2], *x3 = mesh->node + 3 * (int64_t)node[3];
  for (int k = 0; k < 3; k++) {
    a[k] = x1[k] - x0[k];
    b[k] = x2[k] - x0[k];
    c[k] = x3[k] - x0[k];
  }
  for (int k = 0; k < 3; k++) { /* cross products; divided by the determinant they are gradients */
    int l = (k + 1) % 3, m = (k + 2) % 3;
    g[1][k] = b[l] * c[m] - b[m] * c[l];
    g[2][k] = c[l] * a[m] - c[m] * a[l];
    g[3][k] = a[l] * b[m] - a[m] * b[l];
  }
  double determinant = a[0] * g[1][0] + a[1] * g[1][1] + a[2] * g[1][2];
  double scale = 1 / sqrt(6 * determinant); /* sqrt(V) / determinant */
  for (int k = 0; k < 3; k++) {
    for (int i = 1; i < 4; i++)
      h[i][k] = scale * g[i][k];
    h[0][k] = -(h[1][k] + h[2][k] + h[3][k]);
  }
  for (int i = 0; i < 4; i++)
    h[i][3] = 0;
  if (mesh->order == 2)
    for (int m = 0; m < 6; m++)
      h[4 + m] = h[bw_tet_edge[m][0]] + h[bw_tet_edge[m][1]];
  return determinant;
}

static bw_status fill_frames(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_frames *f = (const bwi_frames *)data;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    double determinant = bwi_element_frame(f->mesh, e, f->vector + e * f->vectors);
    bool curved = f->curved && f->curved[e] >= 0;
    if (!(determinant > 0) && !curved)
      return BW_GEOMETRY; /* named by the caller: threads race here, the message must not */
  }
  return BW_OK;
}

typedef struct curved_data {
  bwi_frames *frames;
  int points;
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
} curved_data;

static bw_status fill_curved(void *data, int64_t begin, int64_t end, int worker) {
  const curved_data *c = (const curved_data *)data;
  const bwi_frames *f = c->frames;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    if (f->curved[e] < 0)
      continue;
    double *tensor = f->curved_tensor + (int64_t)f->curved[e] * 55 * 9;
    double x[10][3], gradient[10][3];
    bwi_vector *mean = f->curved_mean + (int64_t)f->curved[e] * 10;
    double whole = 0;
    bwi_element_nodes(f->mesh, e, x);
    memset(tensor, 0, 55 * 9 * sizeof *tensor);
    memset(mean, 0, 10 * sizeof *mean);
    for (int q = 0; q < c->points; q++) {
      double determinant = bw_tet_gradient(2, (const double(*)[3])x, c->point[q], gradient);
      if (!(determinant > 0))
        return BW_GEOMETRY;
      double volume = c->weight[q] * determinant / 6;
      double *t = tensor;
      whole += volume;
      for (int a = 0; a < 10; a++)
        for (int r = 0; r < 3; r++)
          mean[a][r] += volume * gradient[a][r];
      for (int a = 0; a < 10; a++)
        for (int b = 0; b <= a; b++, t += 9)
          for (int r = 0; r < 3; r++)
            for (int s = 0; s < 3; s++)
              t[3 * r + s] += volume * gradient[a][r] * gradient[b][s];
    }
    for (int a = 0; a < 10; a++)
      mean[a] /= sqrt(whole);
  }
  return BW_OK;
}

/* The first element that has no positive Jacobian, found again in order. */
static bw_status name_inverted(bw_context *context, const bwi_frames *f, const curved_data *c) {
  for (int64_t e = 0; e < f->mesh->element_count; e++) {
    double x[10][3], gradient[10][3], centre[4] = {0.25, 0.25, 0.25, 0.25};
    bwi_element_nodes(f->mesh, e, x);
    bool curved = f->curved && f->curved[e] >= 0;
    for (int q = 0; q < (curved ? c->points : 1); q++) {
      double determinant = bw_tet_gradient(curved ? 2 : 1, (const double(*)[3])x,
                                           curved ? c->point[q] : centre, gradient);
      if (!(determinant > 0))
        return bwi_fail_inverted(context, f->mesh, e, determinant);
    }
  }
  return bw_fail(context, BW_GEOMETRY,
                 "an element has no positive volume: move its nodes, or mesh again");
}

bw_status bwi_frames_create(bw_context *context, const bw_mesh *mesh, bwi_frames *frames) {
  bw_status status = BW_OK;
  int64_t curved_count = 0;
  curved_data c = {.frames = frames};
  memset(frames, 0, sizeof *frames);
  frames->mesh = mesh;
  frames->vectors = mesh->order == 1 ? 4 : 10;
  c.points = bw_tet_quadrature(BWI_CURVED_DEGREE, c.point, c.weight);
  BW_TRY(bwi_find_curved(context, mesh, &frames->curved, &curved_count));
  frames->vector = BW_NEW(context, bwi_vector, (int64_t)mesh->element_count * frames->vectors);
  BW_TRY_MEMORY(frames->vector);
  status = bw_parallel(context, mesh->element_count, ELEMENTS_PER_CHUNK, fill_frames, frames);
  if (status == BW_OK && curved_count) {
    frames->curved_tensor = BW_NEW(context, double, curved_count * 55 * 9);
    frames->curved_mean = BW_NEW(context, bwi_vector, curved_count * 10);
    BW_TRY_MEMORY(frames->curved_tensor && frames->curved_mean);
    status = bw_parallel(context, mesh->element_count, 64, fill_curved, &c);
  }
  if (status == BW_GEOMETRY)
    status = name_inverted(context, frames, &c);
done:
  if (status != BW_OK)
    bwi_frames_clear(frames);
  return status;
}

void bwi_frames_clear(bwi_frames *frames) {
  bw_free(frames->vector);
  bw_free(frames->curved);
  bw_free(frames->curved_tensor);
  bw_free(frames->curved_mean);
  memset(frames, 0, sizeof *frames);
}
