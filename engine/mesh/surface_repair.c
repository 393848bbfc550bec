/* Repair: from whatever was read to a sound surface, or a refusal.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Steps go from those that move nothing to those that move much, each only where the check calls
 * for it. A step that fails or makes things worse is left out. What cannot be repaired in place is
 * wrapped. */
#include "mesh/surface_repair.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/limit.h"
#include "mesh/surface_cgal.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"

void bw_repair_options_default(bw_repair_options *options) {
  *options = (bw_repair_options){.weld = -1,
                                 .fill_holes = true,
                                 .intersections = true,
                                 .wrap = true,
                                 .wrap_alpha = 0.01,
                                 .wrap_offset = 0.001,
                                 .time_limit = 120,
                                 .memory_limit = 6e9};
}

typedef struct repairer {
  bw_context *context;
  bw_repair_options options;
  bw_shape_log *log;
  bw_surface *now; /* replaced by each step */
  bw_surface_report report;
  double diagonal, weld;
  bwi_time_limit time;
  double in_children; /* seconds of computing, beside those that `time` counts */
} repairer;

static double seconds_left(const repairer *r) {
  return bwi_time_limit_left(&r->time) - r->in_children;
}

static bw_status fail_time(repairer *r) {
  bw_status status = bw_fail(
      r->context, BW_LIMIT,
      "repair took more than the %.3g seconds of computing it may use: repair the surface before "
      "it is used, with a larger time_limit, or in the program it comes from",
      r->options.time_limit);
  bw_detail_text(r->context, "limit", "time");
  return status;
}

static bw_status check_time(repairer *r) {
  bw_status status = bw_check_cancel(r->context);
  return status == BW_OK && seconds_left(r) <= 0 ? fail_time(r) : status;
}

/* What a step in a child process may use. */
static bwi_child_limits limits_of(repairer *r) {
  return (bwi_child_limits){seconds_left(r), r->options.memory_limit, &r->in_children};
}

/* Failures that end the repair; others only say that a step did not work. Time that ran out ends
 * it: which steps are taken must not depend on the machine. */
static bool is_final(const repairer *r, bw_status status) {
  return status == BW_MEMORY || status == BW_CANCELLED || status == BW_INTERNAL ||
         bwi_time_ran_out(r->context, status);
}

static bw_status inspect(repairer *r) {
  bw_status status = check_time(r);
  if (status != BW_OK)
    return status;
  bw_surface_report report;
  BW_TRY(bw_surface_check(r->context, r->now, 0, &report));
  bw_surface_report_clear(&r->report);
  r->report = report;
done:
  return status;
}

/* Steps that take inner walls out move the outside little, and that is what counts. */
static bool outside_only(const char *name) {
  return strcmp(name, "union") == 0 || strcmp(name, "drop duplicates") == 0 ||
         strcmp(name, "drop walls") == 0;
}

/* Take a step's result over. With a name, log it with the distance it moved. */
static bw_status take(repairer *r, bw_surface *next, const char *name, int64_t count,
                      const char *text) {
  bw_status status = BW_OK;
  double moved = 0;
  BW_TRY(bwi_take_groups(r->context, r->now, next));
  if (name) {
    if (next->triangle_count && r->now->triangle_count)
      BW_TRY(outside_only(name) ? bwi_moved_outside(r->context, r->now, next, &moved)
                                : bw_surface_distance(r->context, r->now, next, &moved));
    bw_shape_log_add(r->log, name, count, moved, "%lld %s", (long long)count, text);
  }
  bw_release(r->now);
  r->now = next;
  next = NULL;
done:
  bw_release(next);
  return status;
}

static bw_status step(repairer *r, bwi_surface_change *function, const char *name,
                      const char *text) {
  bw_status status = check_time(r);
  bw_surface *next = NULL;
  int64_t changed = 0;
  if (status != BW_OK)
    return status;
  BW_TRY(function(r->context, r->now, &next, &changed));
  if (changed)
    return take(r, next, name, changed, text);
  bw_release(next);
done:
  return status;
}

static int64_t bad_edges(const bw_surface_report *report) {
  return report->count[BW_DEFECT_OPEN_EDGE] + report->count[BW_DEFECT_NONMANIFOLD_EDGE];
}

/* Close cracks with a tolerance that grows as long as that helps. */
static bw_status stitch(repairer *r) {
  bw_status status = BW_OK;
  bw_surface *next = NULL;
  double tolerance = r->weld;
  for (int round = 0; round < 4 && r->report.count[BW_DEFECT_OPEN_EDGE] > 0; round++) {
    int64_t changed = 0;
    bw_surface_report report;
    BW_TRY(check_time(r));
    BW_TRY(bwi_stitch(r->context, r->now, tolerance, &next, &changed));
    tolerance *= 10;
    if (changed == 0) {
      bw_release(next);
      next = NULL;
      continue;
    }
    BW_TRY(bw_surface_check(r->context, next, 0, &report));
    if (bad_edges(&report) < bad_edges(&r->report)) {
      bw_surface *taken = next;
      next = NULL;
      BW_TRY(take(r, taken, "stitch", changed, "points and edges along cracks joined"));
      r->report = report;
    } else {
      bw_release(next);
      next = NULL;
    }
  }
done:
  bw_release(next);
  return status;
}

static bw_status orient(repairer *r) {
  bw_status status = BW_OK;
  bw_surface *next = NULL;
  int64_t flipped = 0;
  BW_TRY(check_time(r));
  status = bw_surface_orient(r->context, r->now, &next, &flipped);
  if (status == BW_GEOMETRY)
    return BW_OK; /* one-sided: it stays misoriented, and only a wrap can help */
  if (status != BW_OK)
    goto done;
  if (flipped)
    return take(r, next, "orient", flipped, "facets reversed");
done:
  bw_release(next);
  return status;
}

static bw_status fill(repairer *r) {
  bw_status status = BW_OK;
  bw_surface *next = NULL;
  int64_t filled = 0, left = 0;
  BW_TRY(check_time(r));
  const bwi_child_limits limits = limits_of(r);
  status = bwi_fill_holes(r->context, r->now, 0.3 * r->diagonal, &limits, &next, &filled, &left);
  if (status != BW_OK) {
    if (!is_final(r, status))
      status = BW_OK;
    goto done;
  }
  if (filled) {
    bw_surface *taken = next;
    next = NULL;
    BW_TRY(take(r, taken, "fill holes", filled, "holes filled"));
    BW_TRY(orient(r));
    BW_TRY(inspect(r));
  }
done:
  bw_release(next);
  return status;
}

static bw_status pull_apart(repairer *r) {
  bw_status status = BW_OK;
  bw_surface *next = NULL;
  bw_surface_report report;
  int64_t changed = 0;
  BW_TRY(check_time(r));
  BW_TRY(bwi_separate(r->context, r->now, r->weld, &next, &changed));
  if (changed == 0)
    goto done;
  BW_TRY(bw_surface_check(r->context, next, 0, &report));
  if (report.count[BW_DEFECT_NONMANIFOLD_POINT] < r->report.count[BW_DEFECT_NONMANIFOLD_POINT] &&
      report.count[BW_DEFECT_OPEN_EDGE] <= r->report.count[BW_DEFECT_OPEN_EDGE] &&
      report.count[BW_DEFECT_SELF_INTERSECTION] <= r->report.count[BW_DEFECT_SELF_INTERSECTION]) {
    bw_surface *taken = next;
    next = NULL;
    BW_TRY(take(r, taken, "separate", changed, "points where parts only touched pulled apart"));
    r->report = report;
  }
done:
  bw_release(next);
  return status;
}

/* ---- intersections ------------------------------------------------------------------------- */

/* Run a child's step on the present surface; keep what it makes when that is closed and has fewer
 * intersections. *kept says whether. */
static bw_status try_child(repairer *r, const char *what, bwi_child_work *work, void *job,
                           const char *name, const char *text, bool *kept) {
  bw_status status = BW_OK;
  bw_surface *made = NULL, *next = NULL;
  bw_surface_report report = {0};
  int64_t dropped;
  *kept = false;
  BW_TRY(check_time(r));
  const bwi_child_limits limits = limits_of(r);
  status = bwi_cgal_surface(r->context, what, &limits, work, job, &made);
  if (status != BW_OK) {
    if (!is_final(r, status))
      status = BW_OK;
    goto done;
  }
  /* Rounding exact points may have made some equal. */
  BW_TRY(bwi_split_flat(r->context, made, &next, &dropped));
  BW_TRY(bw_surface_check(r->context, next, 0, &report));
  if (report.closed &&
      report.count[BW_DEFECT_SELF_INTERSECTION] < r->report.count[BW_DEFECT_SELF_INTERSECTION]) {
    bw_surface *taken = next;
    next = NULL;
    *kept = true;
    BW_TRY(take(r, taken, name,
                r->report.count[BW_DEFECT_SELF_INTERSECTION] -
                    report.count[BW_DEFECT_SELF_INTERSECTION],
                text));
    r->report = report;
  }
done:
  bw_release(made);
  bw_release(next);
  return status;
}

static bw_status resolve(repairer *r) {
  bw_status status = BW_OK;
  bw_surface *welded = NULL;
  bwi_topology *topology = NULL;
  bwi_pair *pairs = NULL;
  uint8_t *flat = NULL, *cavity = NULL;
  double *volume = NULL;
  int64_t count = 0, within = 0;
  bool kept = false;
  BW_TRY(bw_surface_weld(r->context, r->now, 0, &welded));
  BW_TRY(bwi_topology_create(r->context, welded, &topology));
  flat = BW_NEW0(r->context, uint8_t, topology->facets);
  cavity = BW_NEW(r->context, uint8_t, topology->shells);
  volume = BW_NEW0(r->context, double, topology->shells);
  BW_TRY_MEMORY(flat && cavity && volume);
  BW_TRY(bwi_intersections(r->context, topology, flat, &pairs, &count));
  for (int64_t i = 0; i < count; i++)
    within += topology->shell[pairs[i].first] == topology->shell[pairs[i].second];
  if (within > 0)
    BW_TRY(try_child(r, "taking out self-intersections", bwi_cgal_resolve, welded, "resolve",
                     "self-intersections taken out locally", &kept));
  if (within < count && !kept) {
    for (int32_t t = 0; t < topology->facets; t++)
      volume[topology->shell[t]] +=
          bwi_facet_volume(topology->point, topology->corner + 3 * (int64_t)t, topology->point);
    for (int32_t s = 0; s < topology->shells; s++)
      cavity[s] = volume[s] < 0;
    bwi_union_job job = {welded, topology->shells, topology->shell, cavity};
    BW_TRY(try_child(r, "joining shells", bwi_cgal_union, &job, "union",
                     "intersections of overlapping shells taken out by joining them", &kept));
  }
done:
  bw_release(welded);
  bwi_topology_destroy(topology);
  bw_free(pairs);
  bw_free(flat);
  bw_free(cavity);
  bw_free(volume);
  return status;
}

/* ---- the whole ----------------------------------------------------------------------------- */

/* What is wrong, in words: "12 open edges, 3 self-intersections". */
static void describe(const bw_surface_report *report, char *text, size_t size) {
  size_t at = 0;
  text[0] = 0;
  for (int k = 0; k < BW_DEFECT_KINDS; k++)
    if (report->count[k] && at < size)
      at += (size_t)snprintf(text + at, size - at, "%s%lld %s%s", at ? ", " : "",
                             (long long)report->count[k], bw_defect_word((bw_defect_kind)k),
                             report->count[k] > 1 ? "s" : "");
}

static bw_status repair(repairer *r) {
  bw_status status = BW_OK;
  bw_surface *next = NULL;
  int64_t before = r->now->point_count;
  bool open = r->report.count[BW_DEFECT_OPEN_EDGE] > 0;
  BW_TRY(bw_surface_weld(r->context, r->now, open ? r->weld : 0, &next));
  int64_t merged = before - next->point_count;
  bw_surface *taken = next;
  next = NULL;
  BW_TRY(take(r, taken, open && merged ? "weld" : NULL, merged, "points merged or dropped"));

  static const struct {
    bwi_surface_change *function;
    const char *name, *text;
  } steps[] = {
      {bwi_drop_repeated, "drop degenerates", "facets with repeated points dropped"},
      {bwi_drop_duplicates, "drop duplicates", "duplicate facets dropped"},
      {bwi_split_flat, "split flat facets", "facets of no area dropped, neighbours split"},
      {bwi_drop_fins, "drop fins", "facets that stick out of the surface dropped"},
      {bwi_drop_walls, "drop walls", "facets of inner and hanging sheets dropped"},
  };
  for (int round = 0; round < 2; round++) {
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
      BW_TRY(step(r, steps[i].function, steps[i].name, steps[i].text));
    BW_TRY(inspect(r));
    if (r->report.count[BW_DEFECT_OPEN_EDGE] == 0 || round > 0)
      break;
    BW_TRY(stitch(r));
  }
  BW_TRY(orient(r));
  BW_TRY(inspect(r));
  if (r->report.count[BW_DEFECT_OPEN_EDGE] > 0 && r->options.fill_holes)
    BW_TRY(fill(r));
  if (!r->report.sound && r->report.count[BW_DEFECT_NONMANIFOLD_POINT] > 0)
    BW_TRY(pull_apart(r));
  for (int round = 0; round < 3 && r->options.intersections; round++) {
    int64_t cuts = r->report.count[BW_DEFECT_SELF_INTERSECTION];
    if (r->report.sound || cuts == 0 || !r->report.closed)
      break;
    BW_TRY(resolve(r));
    if (r->report.count[BW_DEFECT_SELF_INTERSECTION] == cuts)
      break;
    BW_TRY(orient(r));
    BW_TRY(inspect(r));
  }
done:
  bw_release(next);
  return status;
}

static bw_status wrap(repairer *r, const bw_surface *original) {
  bw_status status = BW_OK;
  char text[200];
  bw_surface *wrapped = NULL;
  bwi_wrap_job job = {original, r->options.wrap_alpha * r->diagonal,
                      r->options.wrap_offset * r->diagonal};
  describe(&r->report, text, sizeof text);
  BW_TRY(check_time(r));
  const bwi_child_limits limits = limits_of(r);
  BW_TRY(bwi_cgal_surface(r->context, "the alpha wrap", &limits, bwi_cgal_wrap, &job, &wrapped));
  /* The wrap starts from the surface as given: the steps before it do not count. */
  bw_release(r->now);
  r->now = (bw_surface *)bw_retain(original);
  if (r->log) {
    r->log->count = 0;
    r->log->moved = 0;
  }
  bw_surface *taken = wrapped;
  wrapped = NULL;
  char why[300];
  snprintf(why, sizeof why,
           "facets wrapped around it, since it could not be repaired in place (%s)", text);
  BW_TRY(take(r, taken, "wrap", taken->triangle_count, why));
  BW_TRY(inspect(r));
done:
  bw_release(wrapped);
  return status;
}

bw_status bw_surface_repair(bw_context *context, const bw_surface *surface,
                            const bw_repair_options *options, bw_surface **repaired,
                            bw_shape_log *log) {
  bw_status status = BW_OK;
  bw_shape_log own_log = {0};
  repairer r = {.context = context, .log = &own_log};
  if (options)
    r.options = *options;
  else
    bw_repair_options_default(&r.options);
  if (!(r.options.wrap_alpha > 0) || !(r.options.wrap_offset > 0) || !(r.options.time_limit > 0) ||
      !(r.options.memory_limit > 0))
    return bw_fail(
        context, BW_INVALID,
        "wrap_alpha %g, wrap_offset %g, time_limit %g and memory_limit %g must be positive",
        r.options.wrap_alpha, r.options.wrap_offset, r.options.time_limit, r.options.memory_limit);
  r.time = bwi_time_limit_begin("the repair", r.options.time_limit);
  r.diagonal = bwi_surface_diagonal(surface);
  r.weld = r.options.weld >= 0 ? r.options.weld : 1e-6 * r.diagonal;
  r.now = (bw_surface *)bw_retain(surface);
  if (surface->triangle_count < 4 || !(r.diagonal > 0))
    BW_TRY(bw_fail(context, BW_GEOMETRY,
                   "a surface of %d facet%s in a box of diagonal %g m encloses nothing",
                   surface->triangle_count, surface->triangle_count == 1 ? "" : "s", r.diagonal));
  if (!(r.diagonal > 1e-90 && r.diagonal < 1e90)) { /* volumes and their squares must be numbers */
    BW_TRY(bw_fail(context, BW_GEOMETRY,
                   "the bounding box of the surface has a diagonal of %g m, outside the range "
                   "1e-90 to 1e90: check the coordinates and the unit",
                   r.diagonal));
  }
  BW_TRY(inspect(&r));
  if (!r.report.sound) {
    BW_TRY(repair(&r));
    if (!r.report.sound && r.options.wrap)
      BW_TRY(wrap(&r, surface));
  }
  if (!r.report.sound) {
    char text[300];
    describe(&r.report, text, sizeof text);
    status = bw_fail(context, BW_GEOMETRY, "the surface could not be repaired: %s remain", text);
    bw_detail_number(context, "open_edges", (double)r.report.count[BW_DEFECT_OPEN_EDGE]);
    bw_detail_number(context, "self_intersections",
                     (double)r.report.count[BW_DEFECT_SELF_INTERSECTION]);
    goto done;
  }
  bw_clear_failure(context); /* of steps that did not work out */
  *repaired = r.now;
  r.now = NULL;
  if (log)
    *log = own_log;
done:
  if (bwi_time_ran_out(context, status)) /* in a step: the limit is that of the whole */
    fail_time(&r);
  bw_release(r.now);
  bw_surface_report_clear(&r.report);
  return status;
}
