/* The alpha wrap, asked for by itself.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <math.h>

#include "mesh/surface_cgal.h"
#include "mesh/surface_internal.h"

void bw_wrap_options_default(bw_wrap_options *options) {
  *options = (bw_wrap_options){.time_limit = 300, .memory_limit = 6e9};
}

/* The finest wrap: alpha in the box around it. */
static const double FINEST_WRAP = 3000;

static bw_status check_wrap(bw_context *context, const bw_surface *surface, bw_wrap_options *o) {
  double diagonal = bwi_surface_diagonal(surface);
  if (!(o->alpha >= 0) || !(o->offset >= 0) || !isfinite(o->alpha) || !isfinite(o->offset))
    return bw_fail(context, BW_INVALID, "wrapping needs positive lengths: alpha %g m, offset %g m",
                   o->alpha, o->offset);
  if (!(o->time_limit > 0) || !(o->memory_limit > 0))
    return bw_fail(context, BW_INVALID,
                   "time_limit %g s and memory_limit %g bytes must be positive", o->time_limit,
                   o->memory_limit);
  if (surface->triangle_count == 0)
    return bw_fail(context, BW_EMPTY, "there is nothing to wrap: the surface has no facets");
  if (o->alpha == 0)
    o->alpha = diagonal / 50;
  if (o->offset == 0)
    o->offset = o->alpha / 12;
  if (!(o->alpha > 0) || !(o->offset > 0))
    return bw_fail(context, BW_GEOMETRY, "there is nothing to wrap: the surface has no size");
  double across = (diagonal + 2 * o->offset) / o->alpha;
  if (across > FINEST_WRAP) {
    bw_fail(context, BW_LIMIT,
            "alpha %g m is 1/%.0f of the wrap's size (the surface's, %g m, and twice the offset of "
            "%g m): a wrap finer than 1/%.0f would not fit into memory",
            o->alpha, across, diagonal, o->offset, FINEST_WRAP);
    bw_detail_text(context, "limit", "memory");
    return BW_LIMIT;
  }
  return BW_OK;
}

bw_status bw_surface_wrap(bw_context *context, const bw_surface *surface,
                          const bw_wrap_options *given, bw_surface **wrapped, bw_shape_log *log) {
  bw_status status = BW_OK;
  bw_surface *made = NULL;
  double moved = 0;
  bw_wrap_options options;
  if (given)
    options = *given;
  else
    bw_wrap_options_default(&options);
  BW_TRY(check_wrap(context, surface, &options));
  bwi_wrap_job job = {surface, options.alpha, options.offset};
  bwi_child_limits limits = {.seconds = options.time_limit, .bytes = options.memory_limit};
  BW_TRY(bwi_cgal_surface(context, "the alpha wrap", &limits, bwi_cgal_wrap, &job, &made));
  BW_TRY(bwi_take_groups(context, surface, made));
  BW_TRY(bw_surface_distance(context, surface, made, &moved));
  bw_shape_log_add(log, "wrap", made->triangle_count, moved,
                   "%d facets wrapped around it with alpha %.3g m and offset %.3g m",
                   made->triangle_count, options.alpha, options.offset);
  *wrapped = made;
  made = NULL;
done:
  bw_release(made);
  return status;
}
