/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Meshes of drawings, as the fuzzer and the replay test make them: a byte of options, then an SVG
 * file or points in five bytes each. */
#ifndef FILL_BYTES_H
#define FILL_BYTES_H

#include <math.h>

#include "parse_check.h"

/* What follows a point, in its fifth byte; its lowest bits are an exponent of the point. */
enum { FILL_CURVE = 0x80, FILL_LOOP = 0x40, FILL_HOLE = 0x20, FILL_POINTS = 200, FILL_LOOPS = 12 };

static inline bw_status fill_outline(bw_context *context, const unsigned char *bytes, size_t count,
                                     bw_outline **outline) {
  static const bw_name tag = {"boundary"};
  double point[2 * FILL_POINTS];
  bw_segment segment[FILL_POINTS];
  bw_loop loop[FILL_LOOPS] = {{.count = 0}};
  int points = 0, segments = 0, loops = 0, first = 0, controls = 0;
  bw_loop *now = &loop[0];
  *now = (bw_loop){.parent = -1};
  for (size_t i = 0; i + 5 <= count && points < FILL_POINTS && loops < FILL_LOOPS; i += 5) {
    const unsigned char *b = bytes + i;
    double scale = ldexp(1, 4 * (b[4] & 15) - 30);
    point[2 * points] = scale * (int16_t)(b[0] | b[1] << 8);
    point[2 * points + 1] = scale * (int16_t)(b[2] | b[3] << 8);
    if (controls == 0)
      segment[segments++] = (bw_segment){{points, -1, -1, points + 1}, 0};
    else
      segment[segments - 1].point[3 - controls--] = points;
    if (controls == 0 && segment[segments - 1].point[2] >= 0)
      segment[segments - 1].point[3] = points + 1;
    else if (controls == 0 && (b[4] & FILL_CURVE))
      controls = 2;
    points++;
    if (controls > 0 || !(b[4] & FILL_LOOP))
      continue;
    segment[segments - 1].point[3] = first;
    now->count = segments - now->first;
    now->region = b[4] & FILL_HOLE ? -1 : 0;
    first = points;
    if (++loops < FILL_LOOPS) {
      now++;
      *now = (bw_loop){.first = segments, .parent = -1};
    }
  }
  if (loops > 0) {
    segments = loop[loops - 1].first + loop[loops - 1].count;
    points = first;
  }
  return bw_outline_create(context, points, point, segments, segment, loops, loop, 1, &tag,
                           outline);
}

static inline void fill_bytes(const unsigned char *bytes, size_t count) {
  bw_context *context = parse_context();
  bw_outline *outline = NULL;
  bw_plane_mesh *mesh = NULL;
  bw_plane_options options;
  if (count < 1)
    return;
  bw_status status =
      count > 1 && bytes[1] == '<'
          ? bw_outline_parse(context, "a.svg", bytes + 1, count - 1, NULL, &outline, NULL)
          : fill_outline(context, bytes + 1, count - 1, &outline);
  if (status != BW_OK)
    return;
  bw_plane_options_default(&options);
  options.order = 1 + (bytes[0] & 1);
  options.elements = 2 << (bytes[0] >> 1 & 7);
  options.minimum_angle = bytes[0] & 16 ? 0 : 25;
  options.curvature = bytes[0] & 32 ? 80 : 20;
  options.limit = 20000;
  options.time_limit = 1e6; /* work is bounded without a clock */
  status = bw_plane_fill(context, outline, &options, &mesh);
  parse_require((status == BW_OK) == (mesh != NULL));
  parse_require(status == BW_OK || bw_message(context)[0]);
  if (mesh) {
    bw_plane_quality quality;
    bw_plane_measure(mesh, &quality);
    parse_require(quality.inverted == 0);
    parse_require(mesh->topology->element_count > 0);
  }
  bw_release(mesh);
  bw_release(outline);
}

#endif
