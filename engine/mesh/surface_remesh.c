/* Isotropic remeshing: triangles of a wanted size that follow a surface.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Rounds of: split edges longer than 4/3 of the wanted length, collapse those shorter than 4/5,
 * flip where the smallest angle grows, move points towards the middle of their neighbours and back
 * onto the surface (Botsch and Kobbelt, A remeshing approach to multiresolution modeling, 2004).
 * Every change is refused that turns a facet over, leaves the surface by more than a tenth of the
 * wanted length there (or the tolerance), or merges sharp edges. An edge that stays short because
 * its collapse is refused marks a feature smaller than the wanted length: the length wanted there
 * is taken down to suit, and grows from there by at most a half of the distance. The result is
 * checked; where it cuts itself the same is done around the cut, and all starts again. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "barwright/mesh.h"
#include "base/limit.h"
#include "mesh/faces_internal.h"
#include "mesh/remesh.h"
#include "mesh/surface_cgal.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"

void bw_remesh_options_default(bw_remesh_options *options) {
  *options = (bw_remesh_options){.sharp_angle = 40 * 3.14159265358979323846 / 180,
                                 .iterations = 5,
                                 .time_limit = 300,
                                 .memory_limit = 6e9};
}

static const double EQUILATERAL = 0.43301270189221930; /* area over squared side */

static bw_status too_many(const bwi_remesher *r, double area, double facets) {
  bw_fail(
      r->context, BW_LIMIT,
      "edges of %g m cut this surface of %g m2 into about %.3g facets; %.3g bytes have room for "
      "%.3g: ask for longer edges, or raise memory_limit",
      r->length, area, facets, r->memory, r->memory / BWI_REMESH_BYTES_OF_FACET);
  bw_detail_text(r->context, "limit", "memory");
  return BW_LIMIT;
}

static bw_status find_creases(bwi_remesher *r) {
  const bwi_changing *mesh = r->mesh;
  bw_status status = BW_OK;
  int64_t count = 0;
  r->crease = BW_NEW(r->context, int32_t, 9 * mesh->facet_count + 3);
  if (!r->crease)
    return BW_MEMORY;
  for (int32_t s = 0; s < 3 * (int32_t)mesh->facet_count; s++)
    if (mesh->sharp[s] && s < mesh->opposite[s]) {
      int32_t *t = r->crease + 3 * count++;
      t[0] = bwi_from(mesh, s);
      t[1] = t[2] = bwi_to(mesh, s);
    }
  BW_TRY(bwi_tree_create(r->context, r->original->point, count, r->crease, NULL, &r->creases));
done:
  return status;
}

static bw_status run(bwi_remesher *r, const bw_remesh_options *options, bw_surface **made) {
  bw_status status = BW_OK;
  bwi_changing_destroy(r->mesh);
  r->mesh = NULL;
  BW_TRY(bwi_changing_create(r->context, r->original, options->sharp_angle, &r->mesh));
  for (size_t p = 0; p < r->mesh->point_count; p++)
    r->mesh->size[p] = bwi_remesh_size_near(r, r->mesh->point + 3 * p);
  if (r->faces)
    BW_TRY(bwi_remesh_mark_faces(r, r->borders->tolerance, r->borders->round_angle));
  if (!r->creases)
    BW_TRY(find_creases(r));
  BW_TRY(bwi_remesh_flip_edges(r, 10));
  for (int i = 0; i < options->iterations; i++) {
    r->fraction = (double)i / options->iterations;
    BW_TRY(bwi_remesh_collapse_short(r, i == 0, i > 0));
    bwi_remesh_grade(r->mesh);
    BW_TRY(bwi_remesh_split_long(r));
    BW_TRY(bwi_remesh_collapse_short(r, false, i > 0));
    BW_TRY(bwi_remesh_flip_edges(r, 4));
    BW_TRY(bwi_remesh_relax(r));
    BW_TRY(bwi_remesh_flip_edges(r, 2));
  }
  BW_TRY(bwi_changing_surface(r->mesh, r->faces || r->original->group, made));
  if (!r->faces) /* else the groups are faces */
    bwi_keep_names(r->original, *made);
done:
  return status;
}

/* Requests finer edges where the result cuts itself. */
static bw_status refine_cuts(bwi_remesher *r, const bw_surface *made,
                             const bw_surface_report *report) {
  for (int64_t i = 0; i < report->defect_count; i++) {
    const bw_defect *defect = &report->defect[i];
    if (defect->kind != BW_DEFECT_SELF_INTERSECTION)
      continue;
    if (!bw_grow(r->context, (void **)&r->fine_points, &r->fine_capacity, r->fine_count, 1,
                 sizeof *r->fine_points))
      return BW_MEMORY;
    bwi_fine_point *place = &r->fine_points[r->fine_count++];
    const int32_t *corner = made->triangle + 3 * (int64_t)defect->facet;
    double size = 0;
    for (int k = 0; k < 3; k++)
      size = fmax(size, distance(made->point + 3 * (int64_t)corner[k],
                                 made->point + 3 * (int64_t)corner[(k + 1) % 3]));
    memcpy(place->at, defect->at, sizeof place->at);
    place->size = fmax(0.4 * size, r->finest * r->length);
  }
  return BW_OK;
}

/* Take the last intersections out, where that makes the result sound. */
static bw_status resolve(const bwi_remesher *r, bw_surface **made, bw_surface_report *report,
                         double *moved) {
  bw_surface *next = NULL;
  bw_surface_report after = {0};
  bwi_child_limits limits = {.seconds = r->time.seconds, .bytes = r->memory};
  bw_status status = bwi_cgal_surface(r->context, "taking out self-intersections", &limits,
                                      bwi_cgal_resolve, *made, &next);
  if (status == BW_MEMORY || status == BW_CANCELLED || bwi_time_ran_out(r->context, status))
    goto done;
  if (status != BW_OK) {
    bw_clear_failure(r->context); /* the surface stays as it is */
    return BW_OK;
  }
  BW_TRY(bw_surface_check(r->context, next, 0, &after));
  if (!after.sound)
    goto done;
  BW_TRY(bwi_take_groups(r->context, *made, next));
  BW_TRY(bw_surface_distance(r->context, r->original, next, moved));
  bw_release(*made);
  *made = next;
  next = NULL;
  bw_surface_report_clear(report);
  *report = after;
done:
  bw_release(next);
  return status;
}

bw_status bwi_surface_remesh(bw_context *context, const bw_surface *surface,
                             const bw_remesh_options *given, const bwi_face_borders *borders,
                             int64_t max_steps, bw_surface **remeshed, bw_shape_log *log) {
  bw_status status = BW_OK;
  int64_t checks = 0;
  bw_remesh_options options;
  bw_surface *welded = NULL, *made = NULL;
  bw_surface_report report = {0};
  double moved = 0;
  if (given)
    options = *given;
  else
    bw_remesh_options_default(&options);
  bwi_remesher r = {.context = context,
                    .memory = options.memory_limit,
                    .sizes = options.sizes,
                    .checks = &checks,
                    .max_checks = max_steps >> BWI_REMESH_CHECK_BITS,
                    .time = bwi_time_limit_begin("remeshing", options.time_limit)};
  if (!(options.edge_length >= 0) || options.triangles < 0 || !(options.sharp_angle > 0) ||
      options.iterations < 1 || options.iterations > 100 || !(options.tolerance >= 0) ||
      !(options.time_limit > 0) || !(options.memory_limit > 0))
    return bw_fail(
        context, BW_INVALID,
        "remeshing options: edge_length %g m, triangles %lld, sharp_angle %g, iterations "
        "%d, tolerance %g m, time_limit %g s, memory_limit %g bytes",
        options.edge_length, (long long)options.triangles, options.sharp_angle, options.iterations,
        options.tolerance, options.time_limit, options.memory_limit);
  BW_TRY(bw_surface_weld(context, surface, 0, &welded));
  BW_TRY(bw_surface_check(context, welded, 1, &report));
  if (!report.closed || report.count[BW_DEFECT_MISORIENTED_EDGE] ||
      report.count[BW_DEFECT_NONMANIFOLD_POINT] || report.count[BW_DEFECT_DUPLICATE_FACET])
    BW_TRY(bw_fail(context, BW_GEOMETRY,
                   "remeshing needs a closed manifold surface; this one has %lld open, %lld "
                   "non-manifold and %lld misoriented edges: repair it first",
                   (long long)report.count[BW_DEFECT_OPEN_EDGE],
                   (long long)report.count[BW_DEFECT_NONMANIFOLD_EDGE],
                   (long long)report.count[BW_DEFECT_MISORIENTED_EDGE]));
  int64_t wanted_count = options.triangles > 0 ? options.triangles : welded->triangle_count;
  r.length = options.edge_length > 0 ? options.edge_length
                                     : sqrt(4 / sqrt(3.0) * report.area / (double)wanted_count);
  const double allowed = options.tolerance > 0 ? options.tolerance : 0.25 * r.length;
  r.tolerance = allowed;
  double expected = report.area / (EQUILATERAL * r.length * r.length);
  if (!(expected * BWI_REMESH_BYTES_OF_FACET <= r.memory)) {
    status = too_many(&r, report.area, expected);
    goto done;
  }
  r.max_facets = 8.0 * welded->triangle_count + 400 * report.area / (r.length * r.length) + 1e4;
  if (borders && borders->faces->triangle_count != welded->triangle_count)
    BW_TRY(bw_fail(context, BW_GEOMETRY,
                   "%d facets have a face, but the welded surface has %d facets: find the faces "
                   "of the welded surface",
                   borders->faces->triangle_count, welded->triangle_count));
  r.borders = borders;
  r.faces = borders ? borders->faces : NULL;
  r.finest = r.faces && borders->tolerance < 1e-3 * r.length ? 0.02 : 1.0 / 12;
  r.tiny = r.faces ? borders->tolerance : fmin(0.03 * r.length, 0.3 * r.tolerance);
  bool sound_before = report.sound;
  int attempt = 0;
  r.original = welded;
  BW_TRY(bwi_tree_create(context, welded->point, welded->triangle_count, welded->triangle, NULL,
                         &r.tree));
  r.clearance = BW_NEW(context, double, welded->triangle_count);
  BW_TRY_MEMORY(r.clearance);
  BW_TRY(bw_parallel(context, welded->triangle_count, 512, bwi_remesh_find_clearance, &r));
  for (; attempt < 5; attempt++) {
    bw_release(made);
    made = NULL;
    BW_TRY(bwi_remesh_check(&r));
    BW_TRY(run(&r, &options, &made));
    bw_surface_report_clear(&report);
    BW_TRY(bw_surface_check(context, made, 1000, &report));
    BW_TRY(bw_surface_distance(context, welded, made, &moved));
    if (attempt > 0 && sound_before && !report.sound)
      BW_TRY(resolve(&r, &made, &report, &moved));
    if ((report.sound || !sound_before) && moved <= 1.0001 * allowed)
      break;
    BW_TRY(refine_cuts(&r, made, &report));
    if (moved > allowed) /* changes are checked at few points of each facet: be stricter */
      r.tolerance *= 0.9 * fmax(allowed / moved, 0.5);
  }
  if (attempt == 5)
    BW_TRY(bw_fail(context, BW_GEOMETRY,
                   "remeshing with edges of %g m failed: %lld self-intersections, moved by %g m; "
                   "ask for shorter edges",
                   r.length, (long long)report.count[BW_DEFECT_SELF_INTERSECTION], moved));
  bw_shape_log_add(log, "remesh", made->triangle_count, moved,
                   "%d facets where there were %d, edges of about %.3g m%s", made->triangle_count,
                   surface->triangle_count, r.length,
                   attempt ? ", finer where the surface is near itself" : "");
  *remeshed = made;
  made = NULL;
done:
  bw_surface_report_clear(&report);
  bw_release(made);
  bw_release(welded);
  bwi_changing_destroy(r.mesh);
  bwi_tree_destroy(r.tree);
  bwi_tree_destroy(r.creases);
  bw_free(r.crease);
  bw_free(r.fine_points);
  bw_free(r.clearance);
  return status;
}

bw_status bw_surface_remesh(bw_context *context, const bw_surface *surface,
                            const bw_remesh_options *options, bw_surface **remeshed,
                            bw_shape_log *log) {
  return bwi_surface_remesh(context, surface, options, NULL, 0, remeshed, log);
}
