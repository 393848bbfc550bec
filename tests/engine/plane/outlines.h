/* Outlines that the tests of plane meshes share. */
#ifndef TEST_PLANE_OUTLINES_H
#define TEST_PLANE_OUTLINES_H

#include "check.h"

typedef struct shape {
  double point[512][2];
  bw_segment segment[256];
  bw_loop loop[16];
  int points, segments, loops;
} shape;

static inline void begin_loop(shape *s, int region, const char *name) {
  bw_loop *l = &s->loop[s->loops++];
  *l = (bw_loop){.first = s->segments, .count = 0, .region = region, .parent = -1};
  snprintf(l->name.text, sizeof l->name.text, "%s", name);
}

/* A closed polygon. */
static inline void add_polygon(shape *s, int region, const char *name, int count,
                               const double (*at)[2]) {
  begin_loop(s, region, name);
  int first = s->points;
  for (int i = 0; i < count; i++) {
    memcpy(s->point[s->points++], at[i], sizeof at[i]);
    s->segment[s->segments++] = (bw_segment){{first + i, -1, -1, first + (i + 1) % count}, 0};
  }
  s->loop[s->loops - 1].count = count;
}

static inline void add_box(shape *s, int region, const char *name, double x0, double y0, double x1,
                           double y1) {
  const double at[4][2] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  add_polygon(s, region, name, 4, at);
}

/* An ellipse of four cubics. */
static inline void add_ellipse(shape *s, int region, const char *name, double x, double y,
                               double rx, double ry) {
  const double k = 0.5522847498307936;
  static const int c[5] = {1, 0, -1, 0, 1}, d[5] = {0, 1, 0, -1, 0};
  begin_loop(s, region, name);
  int first = s->points;
  for (int i = 0; i < 4; i++) {
    double p[3][2] = {{c[i], d[i]},
                      {c[i] - k * d[i], d[i] + k * c[i]},
                      {c[i + 1] + k * d[i + 1], d[i + 1] - k * c[i + 1]}};
    for (int j = 0; j < 3; j++) {
      s->point[s->points + j][0] = x + rx * p[j][0];
      s->point[s->points + j][1] = y + ry * p[j][1];
    }
    s->segment[s->segments++] =
        (bw_segment){{s->points, s->points + 1, s->points + 2, i < 3 ? s->points + 3 : first}, 0};
    s->points += 3;
  }
  s->loop[s->loops - 1].count = 4;
}

static inline bw_outline *outline_of(bw_context *context, const shape *s) {
  static const bw_name tag = {"boundary"};
  bw_outline *outline = NULL;
  check_ok(context, bw_outline_create(context, s->points, &s->point[0][0], s->segments, s->segment,
                                      s->loops, s->loop, 1, &tag, &outline));
  return outline;
}

/* The paper's figure 2: a block with a hole that is dragged through it. */
static inline void block_with_hole(shape *s, double x) {
  *s = (shape){.points = 0};
  add_box(s, 0, "block", 0, 0, 3, 1);
  add_ellipse(s, -1, "hole", x, 0.5, 0.2, 0.2);
}

static inline bw_outline *block_outline(bw_context *context, double x) {
  shape s;
  block_with_hole(&s, x);
  return outline_of(context, &s);
}

/* A box `width` x 1 with a rectangular hole from x0 to x1 and from 0.3 to 0.7. */
static inline bw_outline *box_outline(bw_context *context, double width, double x0, double x1) {
  shape s = {.points = 0};
  add_box(&s, 0, "body", 0, 0, width, 1);
  add_box(&s, -1, "hole", x0, 0.3, x1, 0.7);
  return outline_of(context, &s);
}

/* A mesh of about so many elements, with default options otherwise. */
static inline bw_plane_mesh *mesh_on(bw_context *context, const bw_outline *outline, int order,
                                     int elements) {
  bw_plane_options options;
  bw_plane_options_default(&options);
  options.elements = elements;
  options.order = order;
  bw_plane_mesh *mesh = NULL;
  check_ok(context, bw_plane_fill(context, outline, &options, &mesh));
  return mesh;
}

static inline bw_plane_mesh *mesh_of(bw_context *context, const shape *s, int order, int elements) {
  bw_outline *outline = outline_of(context, s);
  bw_plane_mesh *mesh = mesh_on(context, outline, order, elements);
  bw_release(outline);
  return mesh;
}

static inline bw_plane_mesh *block_mesh(bw_context *context, double x, int order, int elements) {
  shape s;
  block_with_hole(&s, x);
  return mesh_of(context, &s, order, elements);
}

#endif
