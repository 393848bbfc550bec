/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Filling an outline with triangles: nodes along the outline, triangles between them by CGAL, nodes
 * that CGAL put on boundary edges moved onto the curves, smoothing with flips, mid-edge nodes.
 *
 * What can go wrong on the way is answered by denser nodes along the curves: boundary edges that
 * cross where two curves run close to each other, elements inverted by a node moved onto its curve,
 * six-node elements folded by a curved side. */
#include "plane/fill_internal.h"

#include <math.h>
#include <string.h>

enum { DENSER = 8, COUNT_TRIES = 8 };
static const double EQUILATERAL = 0.43301270189221930; /* area over squared side */

void bw_plane_options_default(bw_plane_options *options) {
  *options = (bw_plane_options){.order = 1,
                                .elements = 2000,
                                .minimum_angle = 25,
                                .curvature = 20,
                                .limit = 5000000,
                                .time_limit = 300,
                                .memory_limit = 6e9};
}

static void filling_clear(bwi_filling *filling) {
  bw_free(filling->point);
  bw_free(filling->element);
  bw_free(filling->loop);
  bw_free(filling->chord);
  bw_free(filling->along);
  memset(filling, 0, sizeof *filling);
}

static bw_status check_options(bw_context *context, const bw_plane_options *o) {
  if (o->order != 1 && o->order != 2)
    return bw_fail(context, BW_INVALID, "order %d: a plane mesh has order 1 or 2", o->order);
  if (!(o->size >= 0) || isinf(o->size))
    return bw_fail(context, BW_INVALID, "size %g m: an edge length above 0 expected, or 0 for none",
                   o->size);
  if (o->size == 0 && !o->field && o->elements < 1)
    return bw_fail(context, BW_INVALID, "elements %d: at least 1 expected, or give a size",
                   o->elements);
  if (!(o->minimum_angle >= 0 && o->minimum_angle <= 30))
    return bw_fail(context, BW_INVALID, "minimum angle %g degrees: from 0 to 30 expected",
                   o->minimum_angle);
  if (!(o->curvature > 0 && o->curvature <= 90))
    return bw_fail(context, BW_INVALID,
                   "curvature %g degrees per edge: above 0 and at most 90 expected", o->curvature);
  if (o->limit < 1)
    return bw_fail(context, BW_INVALID, "limit %d elements: at least 1 expected", o->limit);
  if (!(o->time_limit > 0) || !(o->memory_limit > 0))
    return bw_fail(context, BW_INVALID,
                   "time_limit %g s and memory_limit %g bytes must be positive", o->time_limit,
                   o->memory_limit);
  return BW_OK;
}

/* ---- limits ---------------------------------------------------------------------------------- */

/* What a mesh takes while it is made, with CGAL's queues: measured at 2,000 to 5,000,000
 * elements. */
static const double BYTES_OF_ELEMENT = 250;

/* More elements than the limit, or than memory has room for. */
static bw_status too_many(bw_context *context, const bw_plane_options *o, double needed,
                          const char *instead) {
  bool memory = o->limit > o->memory_limit / BYTES_OF_ELEMENT;
  if (memory)
    bw_fail(context, BW_LIMIT,
            "about %.3g elements are needed, and %.3g bytes have room for %.0f: %s, or raise "
            "memory_limit",
            needed, o->memory_limit, o->memory_limit / BYTES_OF_ELEMENT, instead);
  else
    bw_fail(context, BW_LIMIT,
            "about %.3g elements are needed, and the limit is %d: %s, or raise the limit", needed,
            o->limit, instead);
  bw_detail_text(context, "limit", memory ? "memory" : "elements");
  return BW_LIMIT;
}

/* Refinement ends nowhere: the shortest segment and its place say why. */
static bw_status endless(bw_context *context, const bw_outline *outline, double across) {
  int32_t shortest = 0;
  double min = INFINITY;
  for (int32_t s = 0; s < outline->segment_count; s++) {
    double from[2], to[2];
    bw_outline_evaluate(outline, s, 0, from, NULL, NULL);
    bw_outline_evaluate(outline, s, 1, to, NULL, NULL);
    double length = hypot(to[0] - from[0], to[1] - from[1]);
    if (length > 0 && length < min) {
      min = length;
      shortest = s;
    }
  }
  const double *at = outline->point + 2 * (size_t)outline->segment[shortest].point[0];
  bw_fail(
      context, BW_GEOMETRY,
      "no triangles of the wanted size fit between the outline's nodes: the outline is %.4g "
      "across, and the ends of segment %d, which begins at (%.9g, %.9g), are %.4g apart; are the "
      "coordinates right?",
      across, (int)shortest + 1, at[0], at[1], min);
  bw_detail_number(context, "x", at[0]);
  bw_detail_number(context, "y", at[1]);
  return BW_GEOMETRY;
}

/* ---- filling --------------------------------------------------------------------------------- */

static double across_of(const bw_outline_measures *measures) {
  return hypot(measures->max[0] - measures->min[0], measures->max[1] - measures->min[1]);
}

/* One filling with a size; `turn` is halved while boundary edges cross. Where refinement towards
 * the angle finds no end, a smaller one will do, then none, and at last boundary edges stay
 * whole. */
static bw_status fill_once(bw_context *context, const bw_outline *outline,
                           const bw_plane_options *options, const bw_outline_measures *measures,
                           const bwi_time_limit *time, bwi_plane_size_field *field, double *turn,
                           double *angle, bwi_fill_boundary *boundary, bwi_filling *filling) {
  bw_status status = BW_OK;
  int64_t max = (int64_t)fmin(options->limit, options->memory_limit / BYTES_OF_ELEMENT);
  for (int denser = 0;;) {
    bwi_fill_boundary_clear(boundary);
    filling_clear(filling);
    BW_TRY(bwi_fill_boundary_create(context, outline, field, *turn, max, boundary));
    int64_t limit = max;
    if (!field->function && *angle > BWI_WHOLE_EDGES && options->minimum_angle > 0) {
      double expected = measures->area / (EQUILATERAL * field->size * field->size);
      limit = (int64_t)fmin((double)limit, 6 * expected + 16.0 * boundary->count + 4000);
    }
    BW_TRY(bwi_fill_cgal(context, outline, boundary, field, *angle, limit, time, filling));
    BW_TRY(bwi_size_check(context, field));
    if (filling->crossed) {
      if (denser++ == DENSER)
        BW_TRY(bw_fail(context, BW_GEOMETRY,
                       "two parts of the outline come so close to each other that edges along "
                       "them cross even with %d nodes on it",
                       boundary->count));
      *turn /= 2;
    } else if (filling->full || filling->stuck) {
      if (filling->full && (limit == max || *angle == BWI_WHOLE_EDGES)) {
        status = too_many(context, options, (double)max + 1, "give a larger size");
        goto done;
      }
      if (*angle == BWI_WHOLE_EDGES) {
        status = endless(context, outline, across_of(measures));
        goto done;
      }
      *angle = *angle > 20 ? 20 : *angle > 0 ? 0 : BWI_WHOLE_EDGES;
    } else {
      return BW_OK;
    }
  }
done:
  return status;
}

bw_status bwi_plane_fill(bw_context *context, const bw_outline *outline,
                         const bw_plane_options *given, double *guess, bw_plane_mesh **mesh) {
  bw_status status = BW_OK;
  bw_plane_options options = *given;
  bwi_fill_boundary boundary = {0};
  bwi_filling filling = {0};
  bw_outline_measures measures;
  bw_plane_mesh *made = NULL;
  BW_TRY(check_options(context, &options));
  BW_TRY(bw_outline_measure(context, outline, -1, &measures));
  double across = across_of(&measures);
  bwi_time_limit time = bwi_time_limit_begin("filling the outline", options.time_limit);
  double turn = options.curvature * 0.017453292519943295, angle = options.minimum_angle;
  bool counted = options.size == 0 && !options.field;
  bwi_plane_size_field field = {
      .size = options.size, .function = options.field, .data = options.field_data};
  if (counted) {
    /* thin shapes have about as many triangles as boundary edges */
    double estimate = fmin(fmax(sqrt(measures.area / (EQUILATERAL * options.elements)),
                                measures.perimeter / options.elements),
                           across);
    /* a guess from a far smaller shape would ask for far too many */
    field.size = *guess > estimate / 4 ? *guess : estimate;
  } else if (options.size == 0) {
    field.size = across;
  }
  double expected = measures.area / (EQUILATERAL * field.size * field.size);
  if (!options.field &&
      expected > 2 * fmin(options.limit, options.memory_limit / BYTES_OF_ELEMENT)) {
    status = too_many(context, &options, expected,
                      counted ? "ask for fewer elements" : "give a larger size");
    goto done;
  }
  double off = INFINITY, best = field.size, before = 0;
  for (int tries = 0; tries <= COUNT_TRIES; tries++) {
    bw_progress(context, "filling", 0.8 * tries / (tries + 1));
    if (tries == COUNT_TRIES)
      field.size = best; /* no size gives the number wanted: the nearest */
    BW_TRY(fill_once(context, outline, &options, &measures, &time, &field, &turn, &angle, &boundary,
                     &filling));
    if (!counted)
      break;
    double ratio = (double)filling.element_count / options.elements;
    if (fabs(ratio - 1) < off) {
      off = fabs(ratio - 1);
      best = field.size;
    }
    /* details ask for more than is wanted, whatever the size */
    bool stuck = ratio > 1.1 && (field.size >= across || fabs(ratio - before) < 0.01 * ratio);
    before = ratio;
    if (stuck && field.size == best)
      break;
    if (off <= (tries < 3 ? 0.06 : 0.1) && field.size == best)
      break;
    field.size = fmin(field.size * fmin(fmax(sqrt(ratio), 0.25), 4), across);
  }
  for (int denser = 0;; denser++) {
    bool fits;
    if (filling.element_count < 1)
      BW_TRY(bw_fail(context, BW_GEOMETRY, "the outline encloses no area that elements fit into"));
    bw_release(made);
    made = NULL;
    BW_TRY(bwi_fill_mesh(context, outline, &boundary, &filling, options.order, &fits, &made));
    if (fits)
      break;
    if (denser == DENSER) { /* thinner than any element: only what is inverted is refused */
      int32_t which = 0;
      if (bwi_plane_worst(made->topology, made->point, &which) > 0)
        break;
      const double *at =
          made->point +
          2 * (size_t)made->topology
                  ->element[(size_t)bwi_plane_width(made->topology->nodes) * (size_t)which];
      status =
          bw_fail(context, BW_GEOMETRY,
                  "no element fits between the outline's curves near (%g, %g) m: the wall there "
                  "is too thin",
                  at[0], at[1]);
      bw_detail_number(context, "x", at[0]);
      bw_detail_number(context, "y", at[1]);
      goto done;
    }
    turn /= 2;
    BW_TRY(fill_once(context, outline, &options, &measures, &time, &field, &turn, &angle, &boundary,
                     &filling));
  }
  bw_progress(context, "filling", 1);
  *guess = counted ? field.size : 0;
  *mesh = made;
  made = NULL;
done:
  bw_release(made);
  bwi_fill_boundary_clear(&boundary);
  filling_clear(&filling);
  return status;
}

bw_status bw_plane_fill(bw_context *context, const bw_outline *outline,
                        const bw_plane_options *options, bw_plane_mesh **mesh) {
  double guess = 0;
  bw_plane_options standard;
  if (!options) {
    bw_plane_options_default(&standard);
    options = &standard;
  }
  bw_status status = bwi_plane_fill(context, outline, options, &guess, mesh);
  if (status != BW_OK || guess == 0)
    return status;
  double count = (*mesh)->topology->element_count;
  if (fabs(count / options->elements - 1) > 0.1)
    bw_warn(context,
            "%d elements were made, %d were requested: the details of the outline need that many",
            (*mesh)->topology->element_count, options->elements);
  return BW_OK;
}
