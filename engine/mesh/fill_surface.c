/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The surface for TetGen: the base itself, remeshed, coarsened, or wrapped and remeshed, with the
 * size field's lengths on top. */
#include "mesh/fill_internal.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <string.h>

/* Points of borders this near to straight lines, as a fraction of the diagonal, may go. */
static const double straight = 1e-6;
/* ... of the edge length where the count has no room for more. */
static const double nearly_straight = 0.03;
/* Faces are kept where planes and round faces of at least the second fraction of the area have the
 * first fraction of it: scans have many small ones by chance. */
static const double fraction_of_area = 0.5, min_area = 1e-3;
/* Edges on round faces turn by no more: a facet's area is short by a twenty-fourth of the
 * square. */
static const double round_angle = 0.25;
/* Where there is a tolerance, coarsening leaves the surface by these fractions of the edge length
 * at most: when it takes out what is tiny, and afterwards. */
static const double small_step = 0.05, large_step = 0.15;
/* Fractions of the tolerance: of either step, and what is left for points to return to faces. */
static const double fraction_of_step = 0.3, fraction_of_projection = 0.4;

/* Remeshing runs in a child process with a limit on its time: some surfaces of thousands of needles
 * keep it busy for minutes, and there is another way for those. */
typedef struct remesh_job {
  const bw_surface *from;
  bw_remesh_options options;
  bwi_face_borders borders; /* faces NULL: none are kept */
  int64_t max_steps;
} remesh_job;

typedef struct remesh_head {
  int64_t points, triangles, groups; /* of triangles: none, or a number of each */
  bw_shape_log log;
} remesh_head;

static bw_status remesh_child(bw_context *context, void *data, bwi_child_stream *out) {
  const remesh_job *job = data;
  bw_surface *made = NULL;
  remesh_head head = {.log.count = 0};
  bw_status status;
  BW_TRY(bwi_surface_remesh(context, job->from, &job->options,
                            job->borders.faces ? &job->borders : NULL, job->max_steps, &made,
                            &head.log));
  head.points = made->point_count;
  head.triangles = made->triangle_count;
  head.groups = job->borders.faces ? made->triangle_count : 0;
  BW_TRY(bwi_child_write(out, &head, sizeof head));
  BW_TRY(bwi_child_write(out, made->point, 24 * (size_t)head.points));
  BW_TRY(bwi_child_write(out, made->triangle, 12 * (size_t)head.triangles));
  BW_TRY(bwi_child_write(out, made->group, 4 * (size_t)head.groups));
done:
  bw_release(made);
  return status;
}

/* A size function of a script may fail, and a child cannot hand its error on: it is tried here. */
static bw_status try_sizes(bwi_filler *f, const bw_surface *from) {
  for (int32_t i = 0; f->field.size && i < from->point_count; i++) {
    bwi_size_at(&f->field, from->point + 3 * (size_t)i);
    bw_status status = bw_check_cancel(f->context);
    if (status != BW_OK)
      return status;
  }
  return BW_OK;
}

static bw_status remesh(bwi_filler *f, bwi_fill_way how, const bw_surface *from, double length,
                        bw_surface **made, bw_shape_log *log) {
  remesh_job job = {.from = from};
  bw_remesh_options_default(&job.options);
  job.options.edge_length = length;
  job.options.sharp_angle = f->options->sharp_angle;
  if (how < WAY_REMESH) {
    job.borders.faces = f->faces;
    job.borders.tolerance = how == WAY_CURVES ? nearly_straight * length : straight * f->diagonal;
    job.borders.round_angle = how == WAY_FACES ? round_angle : 0;
  }
  job.options.tolerance = f->options->surface_tolerance;
  job.options.time_limit = f->options->time_limit;
  job.options.memory_limit = f->options->memory_limit;
  job.options.sizes = &f->field;
  double facets = f->area / (0.4330127 * length * length) + 0.5 * from->triangle_count;
  if (how <= WAY_BORDERS)
    facets += 8.0 * (double)f->bends + f->round_facets;
  /* Several times what is usual. Steps and not seconds: which way is taken must not depend on the
   * machine. */
  job.max_steps = (int64_t)(2e7 + 1e3 * fmin(facets, 1e12));
  bwi_child_limits limits = {.seconds = f->options->time_limit, .bytes = f->options->memory_limit};
  unsigned char *bytes = NULL;
  size_t count = 0;
  remesh_head head;
  bw_status status;
  BW_TRY(try_sizes(f, from));
  BW_TRY(bwi_child_run(f->context, "remeshing the surface", &limits, remesh_child, &job, &bytes,
                       &count));
  if (count >= sizeof head)
    memcpy(&head, bytes, sizeof head);
  if (count < sizeof head || head.points < 0 || head.triangles < 0 || head.points > INT32_MAX ||
      head.triangles > INT32_MAX || (head.groups != 0 && head.groups != head.triangles) ||
      count != sizeof head + 24 * (size_t)head.points + 12 * (size_t)head.triangles +
                   4 * (size_t)head.groups)
    BW_TRY(bw_fail(f->context, BW_INTERNAL, "remeshing returned %zu bytes that are not a surface",
                   count));
  const unsigned char *points = bytes + sizeof head; /* aligned: the head is whole doubles long */
  const int32_t *triangles = (const int32_t *)(const void *)(points + 24 * (size_t)head.points);
  BW_TRY(bw_surface_copy(f->context, head.points, (const double *)(const void *)points,
                         head.triangles, triangles,
                         head.groups ? triangles + 3 * head.triangles : NULL, made));
  bwi_fill_append_log(log, &head.log);
done:
  bw_free(bytes);
  return status;
}

/* Remeshing sees no further than the facets around a point: where walls are thin and edges long,
 * they may cut through each other. */
static bw_status check_sound(bwi_filler *f, const bw_surface *surface, double length) {
  bw_surface_report report = {0};
  bw_status status = bw_surface_check(f->context, surface, 0, &report);
  if (status == BW_OK && !report.sound) {
    char text[200];
    bwi_fill_describe_defects(&report, text, sizeof text);
    status = bw_fail(f->context, BW_GEOMETRY,
                     "remeshing the surface to an edge length of %.3g m makes it invalid (%s)",
                     length, text);
  }
  bw_surface_report_clear(&report);
  return status;
}

/* Collapse what is short, log it, and measure how far that moved the surface. */
static bw_status collapse_short(bwi_filler *f, const bwi_coarsen_options *options,
                                const bw_surface *from, bw_surface **out, bw_shape_log *log) {
  bw_surface *made;
  double moved;
  bw_status status = bwi_coarsen_surface(f->context, from, options, &made);
  if (status != BW_OK)
    return status;
  status = bw_surface_distance(f->context, from, made, &moved);
  if (status != BW_OK) {
    bw_release(made);
    return status;
  }
  bw_shape_log_add(
      log, "coarsen", from->triangle_count - made->triangle_count, moved,
      "edges shorter than %.3g m were collapsed where facets stay clear of each other; "
      "%d facets are left",
      options->shorter, made->triangle_count);
  *out = made;
  return BW_OK;
}

/* The shortest edge length that is wanted near a point. */
static double shortest_bound(const bwi_filler *f, double length) {
  for (int64_t i = 0; i < f->field.point_count; i++)
    length = fmin(length, f->field.point[i].length);
  return length;
}

/* Remesh, and drop the very short edges that sharp edges with many points leave behind: they would
 * make flat elements. */
static bw_status remesh_sound(bwi_filler *f, bwi_fill_way how, const bw_surface *from,
                              double length, bw_surface **out, bw_shape_log *log) {
  bw_surface *made = NULL;
  bw_status status;
  BW_TRY(remesh(f, how, from, length, &made, log));
  BW_TRY(check_sound(f, made, length));
  double min = shortest_bound(f, length);
  const bwi_coarsen_options options = {.length = length,
                                       .shorter = 0.4 * min,
                                       .error = 0.02 * min,
                                       .seconds = f->options->time_limit};
  if (how >= WAY_REMESH) {
    BW_TRY(collapse_short(f, &options, made, out, log));
  } else {
    *out = made;
    made = NULL;
  }
done:
  bw_release(made);
  return status;
}

typedef struct size_limit {
  const bw_size_field *field;
  double length;
} size_limit;

/* What the field asks for, or the length where that is less. */
static double limited_size(void *data, const double at[3]) {
  const size_limit *limit = (const size_limit *)data;
  double bound = bwi_size_at(limit->field, at);
  return bound == 0 || bound > limit->length ? limit->length : bound;
}

/* Cut what is too long, where it lies, and collapse what is too short: the surface stays sound. */
static bw_status coarsen(bwi_filler *f, double length, bw_surface **out, bw_shape_log *log) {
  const double tolerance = f->options->surface_tolerance;
  size_limit limit = {&f->field, length};
  const bw_size_field sizes = {.size = limited_size, .data = &limit};
  bwi_coarsen_options options = {.length = length,
                                 .shorter = 0.3 * length,
                                 .error = 0.02 * length,
                                 .allowed = fmin(fraction_of_step * tolerance, small_step * length),
                                 .field = &f->field,
                                 .seconds = f->options->time_limit};
  bw_surface *cut = NULL;
  bw_status status;
  /* Needles would be cut into needles: repair what can be repaired first. */
  if (!f->tidy || f->tidy_length > 1.2 * length) {
    bw_surface *tidy;
    BW_TRY(bwi_coarsen_surface(f->context, f->base, &options, &tidy));
    bw_release(f->tidy);
    f->tidy = tidy;
    f->tidy_length = length;
  }
  BW_TRY(
      bwi_refine_surface(f->context, f->tidy, &sizes, 1.4, 4000000, f->options->time_limit, &cut));
  options.shorter = 0.8 * length;
  options.error = 0.05 * length;
  options.allowed = fmin(fraction_of_step * tolerance, large_step * length);
  BW_TRY(collapse_short(f, &options, cut, out, log));
done:
  bw_release(cut);
  return status;
}

bw_status bwi_fill_find_faces(bwi_filler *f) {
  if (f->faces)
    return BW_OK;
  bw_surface_report report = {0};
  bw_surface *welded = NULL; /* what remeshing works on */
  bw_status status;
  BW_TRY(bw_faces_find(f->context, f->base, 0, &f->faces));
  BW_TRY(bw_surface_weld(f->context, f->base, 0, &welded));
  BW_TRY(bw_surface_check(f->context, welded, 1, &report));
  if (welded->triangle_count != f->base->triangle_count || !report.closed ||
      report.count[BW_DEFECT_MISORIENTED_EDGE] || report.count[BW_DEFECT_NONMANIFOLD_EDGE] ||
      report.count[BW_DEFECT_NONMANIFOLD_POINT] || report.count[BW_DEFECT_DUPLICATE_FACET])
    goto done; /* such a surface is not remeshed */
  BW_TRY(bwi_faces_min(f->context, welded, f->faces, f->options->sharp_angle,
                       straight * f->diagonal, round_angle, &f->bends, &f->round_facets));
  double kept = 0;
  for (int32_t i = 0; i < f->faces->count; i++) {
    const bw_face *face = &f->faces->face[i];
    kept += face->kind != BW_FACE_FREE && face->area >= min_area * f->area ? face->area : 0;
  }
  f->has_faces = kept >= fraction_of_area * f->area;
done:
  bw_surface_report_clear(&report);
  bw_release(welded);
  return status;
}

/* Points that remeshing moved off the planes and round faces of the base go back onto them. */
static bw_status onto_faces(bwi_filler *f, double length, bw_surface **surface, bw_shape_log *log) {
  bw_surface *made;
  int64_t count;
  double moved;
  bw_status status = bwi_fill_find_faces(f);
  double limit = 0.3 * length, tolerance = f->options->surface_tolerance;
  if (tolerance > 0)
    limit = fmin(limit, fraction_of_projection * tolerance);
  if (status == BW_OK)
    status =
        bwi_faces_project(f->context, f->base, f->faces, *surface, limit, &made, &count, &moved);
  if (status != BW_OK)
    return status;
  if (count > 0)
    bw_shape_log_add(log, "project", count, moved,
                     "%lld points were put back onto the planes and round faces of the surface",
                     (long long)count);
  bw_release(*surface);
  *surface = made;
  return BW_OK;
}

bw_status bwi_fill_make_surface(bwi_filler *f, bwi_fill_way how, double length) {
  bw_context *context = f->context;
  bw_status status = BW_OK;
  bw_surface *made = NULL, *between = NULL;
  bw_shape_log log = {0};
  double start = bw_seconds();
  double *hole = NULL;
  int32_t holes;
  bw_wrap_options wrap = {.alpha = 0.7 * length,
                          .offset = 0.07 * length,
                          .time_limit = f->options->time_limit,
                          .memory_limit = f->options->memory_limit};
  switch (how) {
  case WAY_AS_IS:
    made = bw_retain(f->base);
    break;
  case WAY_FACES:
  case WAY_BORDERS:
  case WAY_CURVES:
    BW_TRY(bwi_fill_find_faces(f));
    BW_TRY(remesh_sound(f, how, f->base, length, &made, &log));
    break;
  case WAY_REMESH:
    BW_TRY(remesh_sound(f, how, f->base, length, &made, &log));
    break;
  case WAY_COARSEN:
    BW_TRY(coarsen(f, length, &made, &log));
    break;
  default:
    BW_TRY(bw_surface_wrap(context, f->base, &wrap, &between, &log));
    BW_TRY(remesh_sound(f, how, between, length, &made, &log));
    break;
  }
  if (f->field.point_count || f->field.size) {
    if (how != WAY_AS_IS || (f->options->remesh && !f->options->keep_surface)) {
      bw_surface *refined;
      BW_TRY(bwi_refine_surface(context, made, &f->field, 1.3, 4000000, f->options->time_limit,
                                &refined));
      bw_release(made);
      made = refined;
    }
  }
  if (how != WAY_AS_IS)
    BW_TRY(onto_faces(f, length, &made, &log));
  BW_TRY(bwi_find_cavities(context, made, &hole, &holes));
  bw_release(f->surface);
  bw_free(f->hole);
  f->surface = made;
  f->hole = hole;
  f->holes = holes;
  f->surface_log = log;
  f->how = how;
  f->length = length;
  made = NULL;
done:
  f->seconds_remesh += bw_seconds() - start;
  bw_release(made);
  bw_release(between);
  return status;
}
