/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Filling a surface with tetrahedra: check, repair, remesh, TetGen, and the search for the surface
 * size and volume bound that give the wanted number of elements. docs/theory/filling.md explains
 * the steps and their limits.
 *
 * While it runs, `base` is the sound surface everything starts from, `surface` the one made from it
 * for TetGen, `best` the mesh that came closest to the wanted number so far. */
#include "mesh/fill_internal.h"

#include "base/warning.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Elements on the boundary with a dihedral angle below this are taken off: 3 degrees. */
static const double flat_angle = 0.05;
/* ... where borders of faces are kept, if their height is no more than rounding: in shares of the
 * diagonal. */
static const double of_rounding = 1e-7;

void bw_fill_options_default(bw_fill_options *options) {
  *options = (bw_fill_options){.order = 1,
                               .radius_edge = 1.4,
                               .remesh = true,
                               .repair = true,
                               .sharp_angle = 40 * 0.017453292519943295,
                               .time_limit = 300,
                               .memory_limit = 6e9,
                               .tolerance = 0.15};
}

bw_status bwi_fill_check_options(bw_context *context, const bw_fill_options *o) {
  if (o->order != 1 && o->order != 2)
    return bw_fail(context, BW_INVALID, "order %d: a mesh of tetrahedra has order 1 or 2",
                   o->order);
  if (o->elements < 0 || o->elements > INT32_MAX / 4)
    return bw_fail(context, BW_INVALID, "%lld elements: give 0 (no bound) to %d",
                   (long long)o->elements, INT32_MAX / 4);
  if (!(o->edge_length >= 0) || (o->edge_length > 0 && o->elements > 0))
    return bw_fail(context, BW_INVALID,
                   "edge_length %g with %lld elements: give a length in m, or a number of elements",
                   o->edge_length, (long long)o->elements);
  if (!(o->surface_tolerance >= 0))
    return bw_fail(context, BW_INVALID, "surface_tolerance %g: give a length in m, or 0 for none",
                   o->surface_tolerance);
  if (!(o->max_volume >= 0))
    return bw_fail(context, BW_INVALID, "max_volume %g: give a volume in m3, or 0 for none",
                   o->max_volume);
  if (!(o->radius_edge == 0 || o->radius_edge >= 1))
    return bw_fail(
        context, BW_INVALID,
        "radius_edge %g: no mesh can do better than 0.612, and TetGen ends for sure only "
        "from 2 on; give 1 to 2, or 0 for no quality bound",
        o->radius_edge);
  if (!(o->dihedral >= 0 && o->dihedral <= 0.35))
    return bw_fail(context, BW_INVALID,
                   "dihedral %g: give a smallest angle of 0 (none) to 0.35 (20 degrees) in radians",
                   o->dihedral);
  if (!(o->tolerance > 0 && o->tolerance < 1))
    return bw_fail(context, BW_INVALID, "tolerance %g: give a fraction between 0 and 1",
                   o->tolerance);
  if (!(o->sharp_angle > 0))
    return bw_fail(context, BW_INVALID, "sharp_angle %g: give an angle above 0 in radians",
                   o->sharp_angle);
  if (!(o->time_limit > 0) || !(o->memory_limit > 0))
    return bw_fail(context, BW_INVALID, "limits of %g seconds and %g bytes: both must be positive",
                   o->time_limit, o->memory_limit);
  if (o->size_point_count < 0 || (o->size_point_count > 0 && !o->size_point))
    return bw_fail(context, BW_INVALID, "%lld size points without a list",
                   (long long)o->size_point_count);
  for (int64_t i = 0; i < o->size_point_count; i++)
    if (!(o->size_point[i].length > 0) || !(o->size_point[i].radius >= 0)) {
      bw_fail(
          context, BW_INVALID,
          "size point %lld: length %g and radius %g; the length must be positive and the radius "
          "not negative",
          (long long)i + 1, o->size_point[i].length, o->size_point[i].radius);
      return BW_INVALID;
    }
  return BW_OK;
}

/* ---- the base ------------------------------------------------------------------------------- */

/* Adopt a surface as the base. */
static void set_base(bwi_filler *f, bw_surface *surface) {
  double low[3], high[3], d[3];
  bw_release(f->base);
  bw_release(f->faces);
  f->faces = NULL;
  f->base = surface;
  bw_surface_box(surface, low, high);
  for (int k = 0; k < 3; k++)
    d[k] = high[k] - low[k];
  f->diagonal = bw_norm(d);
  f->area = bw_surface_area(surface);
  f->volume = fabs(bw_surface_volume(surface));
}

/* The end of a warning on a change of the surface: how far it moved (of `size`, where that is above
 * 0), or that the boundary did not leave the input. */
static const char *describe_move(char text[96], double moved, double size) {
  if (!(moved > 0))
    return ": the boundary lies on the input";
  int used = snprintf(text, 96, ", which moved it by up to %.3g m", moved);
  if (size > 0)
    snprintf(text + used, 96 - (size_t)used, " (%.2g of its size)", moved / size);
  return text;
}

static bw_status prepare_base(bwi_filler *f, const bw_surface *given) {
  bw_context *context = f->context;
  bw_status status;
  bw_surface_report report = {0};
  bw_surface *welded = NULL, *made = NULL;
  char text[200], move[96];
  if (given->triangle_count == 0)
    return bw_fail(context, BW_GEOMETRY, "the surface has no facets: there is nothing to fill");
  double start = bw_seconds();
  BW_TRY(bw_surface_weld(context, given, 0, &welded));
  BW_TRY(bw_surface_check(context, welded, 0, &report));
  if (report.sound) {
    set_base(f, welded);
    welded = NULL;
    goto done;
  }
  bwi_fill_describe_defects(&report, text, sizeof text);
  if (f->options->repair) {
    bw_repair_options repair;
    bw_repair_options_default(&repair);
    if (repair.time_limit > f->options->time_limit)
      repair.time_limit = f->options->time_limit;
    repair.memory_limit = f->options->memory_limit;
    BW_TRY(bw_surface_repair(context, welded, &repair, &made, &f->base_log));
    f->repaired = f->base_log.count > 0;
    if (f->repaired)
      bw_warn(context, "the surface was repaired (%s)%s", text,
              describe_move(move, f->base_log.moved, 0));
  } else if (report.closed) { /* orientation does not matter to TetGen; it will see the rest */
    BW_TRY(bw_surface_orient(context, welded, &made, NULL));
  } else {
    status = bw_fail(context, BW_GEOMETRY,
                     "the surface is not closed (%s): repair it, or allow the repair", text);
    goto done;
  }
  set_base(f, made);
  made = NULL;
done:
  f->seconds_repair += bw_seconds() - start;
  bw_surface_report_clear(&report);
  bw_release(welded);
  bw_release(made);
  return status;
}

/* ---- the whole ------------------------------------------------------------------------------ */

static bw_status report(bwi_filler *f, bw_mesh *mesh, bw_fill_log *log) {
  bw_fill_log whole = {.shape = f->base_log,
                       .repaired = f->repaired,
                       .edge_length = f->best_length,
                       .attempts = f->attempts,
                       .seconds_repair = f->seconds_repair,
                       .seconds_remesh = f->seconds_remesh,
                       .seconds_fill = f->seconds_fill};
  double moved = 0;
  char move[96];
  bwi_fill_append_log(&whole.shape, &f->best_log);
  if (f->best_log.count) { /* the steps may undo each other: measure from end to end */
    bw_status status = bw_surface_distance(f->context, f->base, f->best_surface, &moved);
    if (status != BW_OK)
      return status;
    moved = fmin(moved, f->best_log.moved);
    bwi_warn_largest(f->context, moved,
                     "the surface was remeshed to an edge length of about %.3g m%s", f->best_length,
                     describe_move(move, moved, f->diagonal));
  }
  whole.surface_moved = mesh->surface_moved = f->base_log.moved + moved;
  if (f->options->elements > 0 && f->best_miss > log1p(f->options->tolerance))
    bw_warn(
        f->context,
        "%lld elements were requested; %d is the nearest number that %d run%s of TetGen reached",
        (long long)f->options->elements, mesh->element_count, f->attempts,
        f->attempts == 1 ? "" : "s");
  if (log)
    *log = whole;
  return BW_OK;
}

bw_status bw_mesh_fill(bw_context *context, const bw_surface *surface,
                       const bw_fill_options *options, bw_mesh **mesh, bw_fill_log *log) {
  bw_fill_options defaults;
  bw_mesh *made = NULL, *other = NULL;
  bw_fill_options_default(&defaults);
  bwi_filler f = {.context = context, .options = options ? options : &defaults};
  bw_status status;
  BW_TRY(bwi_fill_check_options(context, f.options));
  f.field = (bw_size_field){f.options->size_point_count, f.options->size_point, f.options->size,
                            f.options->size_data};
  bw_progress(context, "filling", 0);
  BW_TRY(prepare_base(&f, surface));
  bw_progress(context, "filling", 0.1);
  if (f.options->elements > 0)
    BW_TRY(bwi_fill_meet_count(&f));
  else
    BW_TRY(bwi_fill_once(&f));
  BW_TRY(bw_mesh_adopt(context, 1, f.best.node_count, f.best.node, f.best.element_count,
                       f.best.element, NULL, &made));
  f.best.node = NULL;
  f.best.element = NULL;
  if (!f.options->keep_surface) {
    int64_t gone;
    double moved;
    const bool borders = f.best_how >= WAY_FACES && f.best_how <= WAY_CURVES;
    BW_TRY(bwi_peel_flat(context, &made, flat_angle, borders ? of_rounding * f.diagonal : HUGE_VAL,
                         &gone, &moved));
    if (gone > 0)
      bw_shape_log_add(&f.best_log, "peel", gone, moved,
                       "%lld flat elements of less than %.3g m height were taken off the boundary",
                       (long long)gone, moved);
  }
  if (f.options->order == 2) {
    BW_TRY(bw_mesh_with_order(context, made, 2, &other));
    bw_release(made);
    made = other;
  }
  BW_TRY(bw_mesh_renumbered(context, made, NULL, NULL, &other));
  bw_release(made);
  made = other;
  BW_TRY(bwi_mesh_take_names(context, f.base, made));
  BW_TRY(report(&f, made, log));
  bw_progress(context, "filling", 1);
  *mesh = made;
  made = NULL;
done:
  bw_release(made);
  bw_release(f.base);
  bw_release(f.faces);
  bw_release(f.best_surface);
  bw_release(f.tidy);
  bw_release(f.surface);
  bw_free(f.hole);
  bw_free(f.best.node);
  bw_free(f.best.element);
  return status;
}
