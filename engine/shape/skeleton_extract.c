/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Skeletons of surfaces. The surface is brought to a size of one and an even, moderate number of
 * facets, contracted to a curve in a child process (skeleton_cgal.cpp), and the curve is pruned and
 * replaced by bones (curve_*.c). Joints, all inside, are numbered from the root outwards. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "shape/curve.h"
#include "shape/internal.h"
#include "shape/skeleton_cgal.h"

enum {
  FACETS = 6000,     /* of the remeshed surface */
  FACETS_LOW = 3000, /* a surface with so many even facets is taken as it is */
  FACETS_HIGH = 45000,
  FACETS_MAX = 200000, /* where remeshing fails */
  MAX_BONES = 500
};

void bw_skeleton_options_default(bw_skeleton_options *options) {
  *options = (bw_skeleton_options){.bones = 0, .prune = 1.5, .bend = 0.5, .minutes = 5};
}

/* ---- the surface ----------------------------------------------------------------------------- */

/* x = scale * (given - origin): a box diagonal of one about the origin. */
typedef struct frame {
  double origin[3], scale;
} frame;

static bw_status to_unit(bw_context *context, const bw_surface *surface, frame *f,
                         bw_surface **unit) {
  double low[3], high[3], size;
  bw_surface_box(surface, low, high);
  size = hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
  if (!(size > 1e-100))
    return bw_fail(context, BW_GEOMETRY, "the surface has no size");
  f->scale = 1 / size;
  double matrix[12] = {0};
  for (int k = 0; k < 3; k++) {
    f->origin[k] = 0.5 * (low[k] + high[k]);
    matrix[5 * k] = f->scale;
    matrix[4 * k + 3] = -f->scale * f->origin[k];
  }
  return bw_surface_transform(context, surface, matrix, unit);
}

/* Of FACETS equilateral triangles. */
static double edge_length(const bw_surface *surface) {
  return sqrt(4 / sqrt(3.) * bw_surface_area(surface) / FACETS);
}

static bool even_facets(const bw_surface *surface) {
  if (surface->triangle_count < FACETS_LOW || surface->triangle_count > FACETS_HIGH)
    return false;
  double max = 2.5 * edge_length(surface);
  for (int64_t i = 0; i < 3 * (int64_t)surface->triangle_count; i++) {
    int32_t a = surface->triangle[i], b = surface->triangle[i % 3 == 2 ? i - 2 : i + 1];
    if (bwi_gap(surface->point + 3 * (size_t)a, surface->point + 3 * (size_t)b) > max)
      return false;
  }
  return true;
}

/* Creases do not matter here, and keeping them costs facets; where that fails, with creases. */
static bw_status make_even(bw_context *context, const bw_surface *surface, bw_surface **even) {
  bw_remesh_options options;
  bw_remesh_options_default(&options);
  options.edge_length = edge_length(surface);
  options.tolerance = 0.5 * options.edge_length;
  options.iterations = 3;
  if (even_facets(surface)) {
    *even = bw_retain(surface);
    return BW_OK;
  }
  double plain = options.sharp_angle;
  options.sharp_angle = 1.2;
  bw_status status = bw_surface_remesh(context, surface, &options, even, NULL);
  if (status == BW_GEOMETRY) {
    options.sharp_angle = plain;
    status = bw_surface_remesh(context, surface, &options, even, NULL);
  }
  if (status == BW_GEOMETRY && surface->triangle_count <= FACETS_MAX) {
    *even = bw_retain(surface);
    status = BW_OK;
  }
  return status;
}

/* Welded, closed, manifold, outwards, one shell: repaired where it must be. */
static bw_status make_sound(bw_context *context, const bw_surface *surface, bw_surface **sound) {
  bw_status status = BW_OK;
  bw_surface_report report = {0};
  bw_surface *welded = NULL, *repaired = NULL;
  bw_shape_log log = {0};
  BW_TRY(bw_surface_weld(context, surface, 0, &welded));
  BW_TRY(bw_surface_check(context, welded, 0, &report));
  if (!report.closed || !report.oriented || report.count[BW_DEFECT_NONMANIFOLD_EDGE] ||
      report.count[BW_DEFECT_NONMANIFOLD_POINT] || report.count[BW_DEFECT_DUPLICATE_FACET] ||
      report.count[BW_DEFECT_ZERO_AREA]) {
    BW_TRY(bw_surface_repair(context, welded, NULL, &repaired, &log));
    bw_warn(context, "the skeleton is that of the repaired surface (moved by up to %g m)",
            log.moved);
    bw_surface_report_clear(&report);
    BW_TRY(bw_surface_check(context, repaired, 0, &report));
  }
  if (report.shells > 1) {
    status = bw_fail(context, BW_GEOMETRY,
                     "the surface has %lld separate shells: a skeleton is that of one body without "
                     "cavities; take the outer shell of one body",
                     (long long)report.shells);
    bw_detail_number(context, "shells", (double)report.shells);
    goto done;
  }
  *sound = bw_retain(repaired ? repaired : welded);
done:
  bw_surface_report_clear(&report);
  bw_release(welded);
  bw_release(repaired);
  return status;
}

/* ---- the curve ------------------------------------------------------------------------------- */

static bw_status contract(bw_context *context, bw_surface *surface, double minutes,
                          bwi_curve_graph *graph) {
  bw_status status = BW_OK;
  unsigned char *bytes = NULL;
  size_t count = 0;
  int64_t head[2] = {-1, -1};
  bwi_child_limits limits = {.seconds = 60 * minutes, .bytes = 4e9};
  BW_TRY(bwi_child_run(context, "contracting the surface to a skeleton", &limits, bwi_cgal_skeleton,
                       surface, &bytes, &count));
  if (count >= sizeof head)
    memcpy(head, bytes, sizeof head);
  if (head[0] < 0 || head[1] < 0 || head[0] > INT32_MAX / 8 || head[1] > INT32_MAX / 8 ||
      count != sizeof head + (size_t)head[0] * 4 * sizeof(double) +
                   (size_t)head[1] * 2 * sizeof(int32_t))
    BW_TRY(bw_fail(context, BW_INTERNAL, "the contraction returned %zu bytes that are not a graph",
                   count));
  graph->point_count = (int32_t)head[0];
  graph->edge_count = (int32_t)head[1];
  graph->point = BW_NEW(context, double, 4 * head[0]);
  graph->edge = BW_NEW(context, int32_t, 2 * head[1]);
  BW_TRY_MEMORY(graph->point && graph->edge);
  size_t points = 4 * (size_t)head[0] * sizeof(double);
  memcpy(graph->point, bytes + sizeof head, points);
  memcpy(graph->edge, bytes + sizeof head + points, 2 * (size_t)head[1] * sizeof(int32_t));
done:
  bw_free(bytes);
  return status;
}

/* ---- numbering ------------------------------------------------------------------------------- */

/* Joints numbered from the root outwards, level by level, the longer limb first. */
static bw_status renumber(bw_context *context, const bw_skeleton *s, bw_skeleton **out) {
  bw_status status = BW_OK;
  size_t bones = (size_t)s->bone_count, joints = (size_t)s->joint_count;
  double *below = BW_NEW0(context, double, bones), *joint = BW_NEW(context, double, 3 * joints);
  int32_t *order = BW_NEW(context, int32_t, bones), *to = BW_NEW(context, int32_t, joints);
  int32_t *bone = BW_NEW(context, int32_t, 2 * bones);
  BW_TRY_MEMORY(below && joint && order && to && bone);
  for (size_t b = bones; b-- > 0;) {
    below[b] +=
        bwi_gap(s->joint + 3 * (size_t)s->bone[2 * b], s->joint + 3 * (size_t)s->bone[2 * b + 1]);
    if (s->parent[b] >= 0)
      below[s->parent[b]] += below[b];
  }
  size_t count = 0;
  for (size_t next = 0; next <= count && count < bones; next++) {
    int32_t parent = next == 0 ? -1 : order[next - 1];
    size_t first = count;
    for (size_t b = 0; b < bones; b++) {
      if (s->parent[b] != parent)
        continue;
      size_t at = count++;
      for (; at > first && below[order[at - 1]] < below[b]; at--)
        order[at] = order[at - 1];
      order[at] = (int32_t)b;
    }
  }
  to[s->root] = 0;
  memcpy(joint, s->joint + 3 * (size_t)s->root, 3 * sizeof *joint);
  for (size_t i = 0; i < bones; i++) {
    size_t b = (size_t)order[i];
    int32_t tail = s->bone[2 * b + 1];
    to[tail] = (int32_t)i + 1;
    memcpy(joint + 3 * (i + 1), s->joint + 3 * (size_t)tail, 3 * sizeof *joint);
    bone[2 * i] = to[s->bone[2 * b]];
    bone[2 * i + 1] = to[tail];
  }
  BW_TRY(
      bw_skeleton_create(context, s->joint_count, joint, NULL, s->bone_count, bone, NULL, 0, out));
done:
  bw_free(below);
  bw_free(joint);
  bw_free(order);
  bw_free(to);
  bw_free(bone);
  return status;
}

static bw_status finish(bw_context *context, const bwi_sketch *sketch, const frame *f,
                        bw_skeleton **skeleton) {
  bw_skeleton *first = NULL;
  double *joint = BW_NEW(context, double, 3 * (size_t)sketch->joint_count);
  if (!joint)
    return BW_MEMORY;
  for (int32_t j = 0; j < sketch->joint_count; j++)
    for (size_t k = 0; k < 3; k++)
      joint[3 * (size_t)j + k] = f->origin[k] + sketch->joint[4 * (size_t)j + k] / f->scale;
  bw_status status = bw_skeleton_create(context, sketch->joint_count, joint, NULL,
                                        sketch->bone_count, sketch->bone, NULL, -1, &first);
  bw_free(joint);
  if (status == BW_OK)
    status = renumber(context, first, skeleton);
  bw_release(first);
  return status;
}

static void warning_cuts(bw_context *context, const bwi_curve *curve, const frame *f) {
  for (int32_t i = 0; i < curve->cut_count; i++) {
    const double *at = curve->cut_at + 3 * (size_t)i;
    double x[3];
    for (int k = 0; k < 3; k++)
      x[k] = f->origin[k] + at[k] / f->scale;
    if (i < 8)
      bw_warn(context,
              "the skeleton has a ring, which was cut open at (%.4g, %.4g, %.4g) m: a skeleton "
              "is a tree",
              x[0], x[1], x[2]);
  }
  if (curve->cut_count > 8)
    bw_warn(context, "%d more rings of the skeleton were cut open", curve->cut_count - 8);
}

/* ---- public ---------------------------------------------------------------------------------- */

static bw_status check_options(bw_context *context, const bw_skeleton_options *o) {
  if (o->bones < 0 || o->bones > MAX_BONES || !(o->prune >= 0) || !(o->bend > 0) ||
      !(o->minutes > 0))
    return bw_fail(context, BW_INVALID,
                   "options of a skeleton: bones %d (0 to %d), prune %g (at least 0), bend %g "
                   "(above 0), minutes %g (above 0)",
                   o->bones, MAX_BONES, o->prune, o->bend, o->minutes);
  return BW_OK;
}

bw_status bw_skeleton_extract(bw_context *context, const bw_surface *surface,
                              const bw_skeleton_options *given, bw_skeleton **skeleton) {
  bw_status status = BW_OK;
  bw_skeleton_options options;
  bw_surface *sound = NULL, *unit = NULL, *even = NULL;
  bwi_curve_graph graph = {0};
  bwi_curve curve = {0};
  bwi_sketch sketch = {0};
  frame f = {{0}, 1};
  bw_skeleton_options_default(&options);
  if (given)
    options = *given;
  BW_TRY(check_options(context, &options));
  BW_TRY(make_sound(context, surface, &sound));
  BW_TRY(to_unit(context, sound, &f, &unit));
  BW_TRY(make_even(context, unit, &even));
  BW_TRY(contract(context, even, options.minutes, &graph));
  BW_TRY(bwi_curve_create(context, &graph, &curve));
  BW_TRY(bwi_curve_prune(context, &curve, options.prune, options.bones));
  BW_TRY(bwi_curve_bones(context, &curve, options.bend, options.bones, &sketch));
  if (sketch.bone_count == 0 || bwi_branches_length(&curve) < 0.02)
    BW_TRY(bwi_sketch_one_bone(context, unit, &sketch));
  BW_TRY(bwi_sketch_settle(context, unit, &sketch));
  BW_TRY(finish(context, &sketch, &f, skeleton));
  warning_cuts(context, &curve, &f);
done:
  bwi_sketch_clear(&sketch);
  bwi_curve_clear(&curve);
  bw_free(graph.point);
  bw_free(graph.edge);
  bw_release(even);
  bw_release(unit);
  bw_release(sound);
  return status;
}
