/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stiffness and mass of sheets of three-node triangles, in closed form.
 *
 * The gradients g_a are constant on an element. With T = sum over elements of (area thickness)
 * g_a g_b^T, a block of the stiffness is linear in T: T is summed for a block and the material
 * applied once. An element is one line of eight numbers, its gradients times the root of area and
 * thickness and its mass by 12, so that what the sums read stays in the cache. */
#include <math.h>

#include "responsive/sheet.h"

enum { LINE = 8 };

typedef struct lines {
  const bw_sheet *sheet;
  const bw_plane_pattern *pattern;
  double *line;
  double *values;
} lines;

static bw_status make_lines(void *data, int64_t begin, int64_t end, int worker) {
  lines *l = data;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    const bwi_section *section = bwi_section_of(l->sheet, (int32_t)e);
    double x[6][2], *out = l->line + LINE * e;
    bwi_element_points(l->sheet->mesh, (int32_t)e, 3, x);
    double ax = x[1][0] - x[0][0], ay = x[1][1] - x[0][1];
    double bx = x[2][0] - x[0][0], by = x[2][1] - x[0][1];
    double twice = ax * by - ay * bx;
    if (!(twice > 0))
      return BW_GEOMETRY; /* the caller says which */
    double scale = sqrt(0.5 * twice * section->thickness) / twice;
    out[0] = scale * (ay - by);
    out[1] = scale * (bx - ax);
    out[2] = scale * by;
    out[3] = -scale * bx;
    out[4] = -scale * ay;
    out[5] = scale * ax;
    out[6] = twice * section->thickness * section->density / 24;
  }
  return BW_OK;
}

static inline void add_block(const double d[9], const double t[4], double k[4]) {
  k[0] += d[0] * t[0] + d[2] * (t[1] + t[2]) + d[8] * t[3];
  k[1] += d[1] * t[1] + d[2] * t[0] + d[5] * t[3] + d[8] * t[2];
  k[2] += d[1] * t[2] + d[2] * t[0] + d[5] * t[3] + d[8] * t[1];
  k[3] += d[4] * t[3] + d[5] * (t[1] + t[2]) + d[8] * t[0];
}

/* First number of a local node's gradient in a line, by the local pair a * 6 + b. */
static const uint8_t row_of[15] = {0, 0, 0, 0, 0, 0, 2, 2, 2, 0, 0, 0, 4, 4, 4};
static const uint8_t column_of[15] = {0, 2, 4, 0, 0, 0, 0, 2, 4, 0, 0, 0, 0, 2, 4};

static bw_status stiffness_rows(void *data, int64_t begin, int64_t end, int worker) {
  const lines *l = data;
  const bw_plane_pattern *pattern = l->pattern;
  bool one = l->sheet->inner->section_count == 1;
  (void)worker;
  for (int64_t p = pattern->start[begin]; p < pattern->start[end]; p++) {
    double k[4] = {0}, t[4] = {0};
    for (int64_t c = pattern->gather_start[p]; c < pattern->gather_start[p + 1]; c++) {
      int32_t e = pattern->gather_element[c];
      const double *line = l->line + LINE * (int64_t)e;
      const double *g = line + row_of[pattern->gather_local[c]];
      const double *h = line + column_of[pattern->gather_local[c]];
      if (one) {
        t[0] += g[0] * h[0];
        t[1] += g[0] * h[1];
        t[2] += g[1] * h[0];
        t[3] += g[1] * h[1];
      } else {
        double own[4] = {g[0] * h[0], g[0] * h[1], g[1] * h[0], g[1] * h[1]};
        add_block(bwi_section_of(l->sheet, e)->elasticity, own, k);
      }
    }
    if (one)
      add_block(l->sheet->inner->section[0].elasticity, t, k);
    for (int i = 0; i < 4; i++)
      l->values[4 * p + i] = k[i];
  }
  return BW_OK;
}

static bw_status mass_rows(void *data, int64_t begin, int64_t end, int worker) {
  const lines *l = data;
  const bw_plane_pattern *pattern = l->pattern;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++) {
      double sum = 0;
      for (int64_t c = pattern->gather_start[p]; c < pattern->gather_start[p + 1]; c++)
        sum += l->line[LINE * (int64_t)pattern->gather_element[c] + 6];
      l->values[p] = p == pattern->diagonal[i] ? 2 * sum : sum;
    }
  return BW_OK;
}

static bw_status run(bw_context *context, const bw_sheet *sheet, bw_body *rows, double *values) {
  lines l = {.sheet = sheet,
             .pattern = sheet->inner->pattern,
             .line = sheet->inner->workspace,
             .values = values};
  bw_status status = bw_parallel(context, sheet->mesh->topology->element_count, BWI_GRAIN_ELEMENTS,
                                 make_lines, &l);
  if (status == BW_OK)
    status = bw_parallel(context, l.pattern->node_count, BWI_GRAIN_NODES, rows, &l);
  return status;
}

bw_status bwi_sheet_tri3_stiffness(bw_context *context, const bw_sheet *sheet, double *values) {
  return run(context, sheet, stiffness_rows, values);
}

bw_status bwi_sheet_tri3_mass(bw_context *context, const bw_sheet *sheet, double *values) {
  return run(context, sheet, mass_rows, values);
}
