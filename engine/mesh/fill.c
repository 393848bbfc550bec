/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Filling a surface with tetrahedra: check, repair, remesh, TetGen, and the search for the surface
 * size and volume bound that give the wanted number of elements. docs/theory/filling.md explains
 * the steps and their limits.
 *
 * While it runs, `base` is the sound surface everything starts from, `surface` the one made from it
 * for TetGen, `best` the mesh that came closest to the wanted number so far. */
#include "mesh/fill_internal.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* How the surface for TetGen is made from the base, from the mildest to the last resort. */
typedef enum way {
  WAY_AS_IS,   /* the base itself */
  WAY_REMESH,  /* remeshed to the edge length */
  WAY_COARSEN, /* long edges cut, short ones collapsed where that makes no intersections */
  WAY_WRAP,    /* wrapped, which drops detail below the edge length, then remeshed */
  WAYS
} way;

typedef struct filler {
  bw_context *context;
  const bw_fill_options *options;
  bwi_size_field field;
  bw_surface *base;
  double volume, area, diagonal;
  bw_shape_log base_log;

  bw_surface
      *tidy; /* the base without very short edges, for lengths from tidy_length on; or NULL */
  double tidy_length;

  bw_surface *surface;
  way how;
  double length; /* the edge length that `surface` was made for */
  bw_shape_log surface_log;
  double *hole;
  int32_t holes;

  bwi_tetgen_result best; /* node NULL: none yet */
  bw_surface *best_surface;
  double best_miss; /* |log(count / wanted)| */
  bw_shape_log best_log;
  double best_length;

  int attempts;
  double seconds_repair, seconds_remesh, seconds_fill;
  bool repaired;
  double start; /* of the search: no new run begins after time_limit, once there is a mesh */
} filler;

/* Elements per facet of the surface and per volume of an edge length, for the first guess. */
static const double facet_share = 1.7, volume_share = 1.6;
/* The volume bound that goes with an edge length, in cubes of it: the edges inside may be about
 * half as long again as those on the surface. */
static const double volume_of_length = 0.5;
/* Elements on the boundary with a dihedral angle below this are taken off: 3 degrees. */
static const double flat_angle = 0.05;
enum { MOST_ATTEMPTS = 14 };

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

static bw_status check_options(bw_context *context, const bw_fill_options *o) {
  if (o->order != 1 && o->order != 2)
    return bw_fail(context, BW_INVALID, "order %d: a mesh of tetrahedra has order 1 or 2",
                   o->order);
  if (o->elements < 0 || o->elements > INT32_MAX / 4)
    return bw_fail(context, BW_INVALID, "%lld elements: give 0 (no wish) to %d",
                   (long long)o->elements, INT32_MAX / 4);
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
          (long long)i, o->size_point[i].length, o->size_point[i].radius);
      return BW_INVALID;
    }
  return BW_OK;
}

/* ---- the base ------------------------------------------------------------------------------- */

static void describe_defects(const bw_surface_report *report, char *text, size_t size) {
  size_t used = 0;
  text[0] = 0;
  for (int k = 0; k < BW_DEFECT_KINDS; k++)
    if (report->count[k] && used < size) {
      int put = snprintf(text + used, size - used, "%s%lld x %s", used ? ", " : "",
                         (long long)report->count[k], bw_defect_word((bw_defect_kind)k));
      used += put > 0 ? (size_t)put : 0;
    }
}

/* Adopt a surface as the base. */
static void set_base(filler *f, bw_surface *surface) {
  double low[3], high[3], d[3];
  bw_release(f->base);
  f->base = surface;
  bw_surface_box(surface, low, high);
  for (int k = 0; k < 3; k++)
    d[k] = high[k] - low[k];
  f->diagonal = bw_norm(d);
  f->area = bw_surface_area(surface);
  f->volume = fabs(bw_surface_volume(surface));
}

static void append_log(bw_shape_log *to, const bw_shape_log *from) {
  for (int i = 0; i < from->count; i++)
    bw_shape_log_add(to, from->step[i].name, from->step[i].count, from->step[i].moved, "%s",
                     from->step[i].text);
}

static bw_status prepare_base(filler *f, const bw_surface *given) {
  bw_context *context = f->context;
  bw_status status;
  bw_surface_report report = {0};
  bw_surface *welded = NULL, *made = NULL;
  char text[200];
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
  describe_defects(&report, text, sizeof text);
  if (f->options->repair) {
    bw_repair_options repair;
    bw_repair_options_default(&repair);
    if (repair.time_limit > f->options->time_limit)
      repair.time_limit = f->options->time_limit;
    BW_TRY(bw_surface_repair(context, welded, &repair, &made, &f->base_log));
    f->repaired = f->base_log.count > 0;
    if (f->repaired)
      bw_remark(context, "the surface was repaired (%s) and moved by up to %.3g m", text,
                f->base_log.moved);
  } else if (report.closed) { /* orientation does not matter to TetGen; it will see the rest */
    BW_TRY(bw_surface_orient(context, welded, &made, NULL));
  } else {
    status = bw_fail(context, BW_GEOMETRY,
                     "the surface is not closed (%s): mend it, or let it be repaired", text);
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

/* Errors that another way of making the surface may cure. */
static bool may_cure(bw_status status) {
  return status == BW_GEOMETRY || status == BW_LIMIT || status == BW_INTERNAL ||
         status == BW_UNSUPPORTED || status == BW_CONVERGENCE;
}

/* ---- the surface for TetGen ----------------------------------------------------------------- */

/* Remeshing runs in a child process with a limit on its time: some surfaces of thousands of needles
 * keep it busy for minutes, and there is another way for those. */
typedef struct remesh_job {
  const bw_surface *from;
  bw_remesh_options options;
} remesh_job;

typedef struct remesh_head {
  int64_t points, triangles;
  bw_shape_log log;
} remesh_head;

static bw_status remesh_child(bw_context *context, void *data, bwi_child_stream *out) {
  const remesh_job *job = data;
  bw_surface *made = NULL;
  remesh_head head = {.log.count = 0};
  bw_status status;
  BW_TRY(bw_surface_remesh(context, job->from, &job->options, &made, &head.log));
  head.points = made->point_count;
  head.triangles = made->triangle_count;
  BW_TRY(bwi_child_write(out, &head, sizeof head));
  BW_TRY(bwi_child_write(out, made->point, 24 * (size_t)head.points));
  BW_TRY(bwi_child_write(out, made->triangle, 12 * (size_t)head.triangles));
done:
  bw_release(made);
  return status;
}

static bw_status remesh(filler *f, const bw_surface *from, double length, double sharp,
                        bw_surface **made, bw_shape_log *log) {
  remesh_job job = {.from = from};
  bw_remesh_options_default(&job.options);
  job.options.edge_length = length;
  job.options.sharp_angle = sharp;
  double facets = f->area / (0.4330127 * length * length) + 0.5 * from->triangle_count;
  bwi_child_limits limits = {fmin(5 + 2.5e-4 * facets, f->options->time_limit),
                             f->options->memory_limit};
  unsigned char *bytes = NULL;
  size_t count = 0;
  remesh_head head;
  bw_status status;
  BW_TRY(bwi_child_run(f->context, "remeshing the surface", &limits, remesh_child, &job, &bytes,
                       &count));
  if (count >= sizeof head)
    memcpy(&head, bytes, sizeof head);
  if (count < sizeof head || head.points < 0 || head.triangles < 0 || head.points > INT32_MAX ||
      head.triangles > INT32_MAX ||
      count != sizeof head + 24 * (size_t)head.points + 12 * (size_t)head.triangles) {
    status = bw_fail(f->context, BW_INTERNAL, "%zu bytes are no remeshed surface", count);
    goto done;
  }
  const unsigned char *points = bytes + sizeof head; /* aligned: the head is whole doubles long */
  BW_TRY(bw_surface_copy(
      f->context, head.points, (const double *)(const void *)points, head.triangles,
      (const int32_t *)(const void *)(points + 24 * (size_t)head.points), NULL, made));
  append_log(log, &head.log);
done:
  bw_free(bytes);
  return status;
}

/* Remeshing sees no further than the facets around a point: where walls are thin and edges long,
 * they may cut through each other. */
static bw_status check_sound(filler *f, const bw_surface *surface, double length) {
  bw_surface_report report = {0};
  bw_status status = bw_surface_check(f->context, surface, 0, &report);
  if (status == BW_OK && !report.sound) {
    char text[200];
    describe_defects(&report, text, sizeof text);
    status =
        bw_fail(f->context, BW_GEOMETRY,
                "remeshing the surface to an edge length of %.3g m spoils it (%s)", length, text);
  }
  bw_surface_report_clear(&report);
  return status;
}

static double one_length(void *data, const double at[3]) {
  (void)at;
  return *(const double *)data;
}

/* Collapse what is shorter than `shorter`, and log it. */
static bw_status collapse_short(filler *f, double length, double shorter, double error,
                                bw_surface **surface, bw_shape_log *log) {
  bw_surface *made;
  double moved;
  bw_status status = bwi_coarsen_surface(f->context, *surface, length, shorter, error,
                                         f->options->time_limit, &made);
  if (status != BW_OK)
    return status;
  status = bw_surface_distance(f->context, *surface, made, &moved);
  if (status != BW_OK) {
    bw_release(made);
    return status;
  }
  bw_shape_log_add(
      log, "coarsen", (*surface)->triangle_count - made->triangle_count, moved,
      "edges shorter than %.3g m were collapsed where facets stay clear of each other; "
      "%d facets are left",
      shorter, made->triangle_count);
  bw_release(*surface);
  *surface = made;
  return BW_OK;
}

/* Remesh, and drop the very short edges that sharp edges with many points leave behind: they would
 * make flat elements. */
static bw_status remesh_sound(filler *f, const bw_surface *from, double length, bw_surface **out,
                              bw_shape_log *log) {
  bw_surface *made = NULL;
  bw_status status;
  BW_TRY(remesh(f, from, length, f->options->sharp_angle, &made, log));
  BW_TRY(check_sound(f, made, length));
  BW_TRY(collapse_short(f, length, 0.4 * length, 0.02 * length, &made, log));
  *out = made;
  made = NULL;
done:
  bw_release(made);
  return status;
}

/* Cut what is too long, where it lies, and collapse what is too short: the surface stays sound. */
static bw_status coarsen(filler *f, double length, bw_surface **out, bw_shape_log *log) {
  bwi_size_field field = {.size = one_length, .data = &length};
  bw_surface *made = NULL;
  bw_status status;
  /* Needles would be cut into needles: mend what can be mended first. */
  if (!f->tidy || f->tidy_length > 1.2 * length) {
    BW_TRY(bwi_coarsen_surface(f->context, f->base, length, 0.3 * length, 0.02 * length,
                               f->options->time_limit, &made));
    bw_release(f->tidy);
    f->tidy = made;
    f->tidy_length = length;
    made = NULL;
  }
  BW_TRY(
      bwi_refine_surface(f->context, f->tidy, &field, 1.4, 4000000, f->options->time_limit, &made));
  BW_TRY(collapse_short(f, length, 0.8 * length, 0.05 * length, &made, log));
  *out = made;
  made = NULL;
done:
  bw_release(made);
  return status;
}

static bw_status make_surface(filler *f, way how, double length) {
  bw_context *context = f->context;
  bw_status status = BW_OK;
  bw_surface *made = NULL, *between = NULL;
  bw_shape_log log = {0};
  double start = bw_seconds();
  double *hole = NULL;
  int32_t holes;
  switch (how) {
  case WAY_AS_IS:
    made = bw_retain(f->base);
    break;
  case WAY_REMESH:
    BW_TRY(remesh_sound(f, f->base, length, &made, &log));
    break;
  case WAY_COARSEN:
    BW_TRY(coarsen(f, length, &made, &log));
    break;
  default:
    BW_TRY(bw_surface_wrap(context, f->base, 0.7 * length, 0.07 * length, &between, &log));
    BW_TRY(remesh_sound(f, between, length, &made, &log));
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

/* TetGen's last step may leave elements of no volume, which no mesh may have. */
static bw_status check_volumes(bw_context *context, const bwi_tetgen_result *result) {
  for (int64_t i = 0; i < result->element_count; i++) {
    const int32_t *e = result->element + 4 * i;
    const double *x[4];
    for (int k = 0; k < 4; k++)
      x[k] = result->node + 3 * (int64_t)e[k];
    double error, volume = bwi_tet_determinant(x[0], x[1], x[2], x[3], &error);
    if (!(fabs(volume) > error))
      return bw_fail(context, BW_GEOMETRY,
                     "TetGen left an element without volume near (%g, %g, %g)", x[0][0], x[0][1],
                     x[0][2]);
  }
  return BW_OK;
}

/* ---- one attempt ---------------------------------------------------------------------------- */

static bw_status attempt(filler *f, double max_volume, int64_t *count) {
  const bw_fill_options *o = f->options;
  bool fields = f->field.point_count || f->field.size;
  if (o->max_volume > 0 && (max_volume <= 0 || max_volume > o->max_volume))
    max_volume = o->max_volume;
  bwi_tetgen_job job = {.point_count = f->surface->point_count,
                        .triangle_count = f->surface->triangle_count,
                        .point = f->surface->point,
                        .triangle = f->surface->triangle,
                        .hole_count = f->holes,
                        .hole = f->hole,
                        .max_volume = max_volume,
                        .radius_edge = o->radius_edge,
                        .dihedral = o->dihedral,
                        .keep_surface = o->keep_surface || o->remesh,
                        .field = fields ? &f->field : NULL,
                        .limits = {o->time_limit, o->memory_limit}};
  if (o->elements > 0) { /* far beyond what is wanted there is nothing to learn */
    job.max_points = 4 * (o->elements + f->surface->point_count) + 10000;
    job.limits.seconds = fmin(o->time_limit, 40 + 4e-4 * (double)o->elements);
  }
  bwi_tetgen_result result;
  double start = bw_seconds();
  f->attempts++;
  bw_status status = bwi_tetgen_run(f->context, &job, &result);
  f->seconds_fill += bw_seconds() - start;
  bw_progress(f->context, "fill", 0.1 + 0.85 * (1 - pow(0.6, f->attempts)));
  if (status != BW_OK)
    return status;
  status = check_volumes(f->context, &result);
  if (status != BW_OK) {
    bw_free(result.node);
    bw_free(result.element);
    return status;
  }
  *count = result.element_count;
  double miss = o->elements > 0 ? fabs(log((double)*count / (double)o->elements)) : 0;
  if (!f->best.node || miss < f->best_miss) {
    bw_free(f->best.node);
    bw_free(f->best.element);
    f->best = result;
    f->best_miss = miss;
    bw_release(f->best_surface);
    f->best_surface = bw_retain(f->surface);
    f->best_log = f->surface_log;
    f->best_length = f->length;
  } else {
    bw_free(result.node);
    bw_free(result.element);
  }
  return BW_OK;
}

/* Make the surface for an edge length and fill it, by the mildest way from *how on that works. */
static bw_status fill_at(filler *f, way *how, double length, double max_volume, int64_t *count) {
  bw_status status = BW_OK;
  char why[300] = "";
  for (; *how < WAYS; ++*how) {
    /* What TetGen stumbles over is often an accident of this very surface: one of slightly other
     * edges is tried before the next way. */
    bool filled = false;
    for (int try = 0; try < (*how == WAY_AS_IS ? 1 : 2); try++) {
      status = make_surface(f, *how, try ? 0.96 * length : length);
      if (status != BW_OK)
        break;
      filled = true;
      status = attempt(f, max_volume, count);
      if (status == BW_OK || status == BW_LIMIT || !may_cure(status))
        break;
    }
    if (status == BW_OK || !may_cure(status))
      break;
    if (filled && status == BW_LIMIT && *how != WAY_AS_IS)
      break; /* well-shaped facets already: another surface takes as long */
    snprintf(why, sizeof why, "%s", bw_message(f->context));
    if (!f->options->remesh || f->options->keep_surface)
      break;
  }
  if (status == BW_OK && why[0] && *how == WAY_WRAP)
    bw_remark(f->context, "%s; a surface wrapped around it and remeshed serves instead", why);
  return status;
}

/* ---- the wanted number ---------------------------------------------------------------------- */

static double expected_count(const filler *f, double length) {
  double facets = f->area / (0.4330127 * length * length) * 1.15;
  double cube = length * length * length;
  return facet_share * facets + volume_share * f->volume / cube;
}

static double first_length(const filler *f, double count) {
  double low = 1e-6 * f->diagonal, high = f->diagonal;
  for (int i = 0; i < 60; i++) {
    double middle = sqrt(low * high);
    if (expected_count(f, middle) > count)
      low = middle;
    else
      high = middle;
  }
  return sqrt(low * high);
}

static bool too_late(const filler *f) {
  return f->best.node && bw_seconds() - f->start > f->options->time_limit;
}

/* On one surface the count is about a + b / volume bound: two runs give both. Used for surfaces
 * that must stay as they are, and to close in when a remeshed surface is nearly right. */
static bw_status tune_volume(filler *f, double wanted, double volume, int64_t count, int most) {
  bw_status status = BW_OK;
  double last_inverse = volume > 0 ? 1 / volume : 0, last_count = (double)count;
  double slope = 1.4 * f->volume;
  for (int i = 0; i < most && f->attempts < MOST_ATTEMPTS && !too_late(f); i++) {
    if (f->best_miss <= log1p(f->options->tolerance) * 0.999)
      break;
    double inverse = last_inverse + (wanted - last_count) / slope;
    if (!(inverse > 1e-3 / f->volume)) { /* no bound at all is the least there is */
      if (last_inverse == 0)
        break;
      inverse = 0;
    }
    BW_TRY(attempt(f, inverse > 0 ? 1 / inverse : 0, &count));
    if (fabs((double)count - last_count) < 0.01 * last_count)
      break; /* walls with nothing inside */
    double steepness = ((double)count - last_count) / (inverse - last_inverse);
    if (inverse != last_inverse && steepness > 0.05 * f->volume)
      slope = steepness;
    last_inverse = inverse;
    last_count = (double)count;
  }
done:
  return status;
}

/* Tunnels through the surface: marching surfaces of walls thinner than their grid are full of them.
 * Coarsening keeps each, with the ten facets or so that it takes. */
static int64_t tunnels_of(const bw_surface *surface, int64_t bodies) {
  return bodies - ((int64_t)surface->point_count - surface->triangle_count / 2) / 2;
}

/* A surface much finer than wanted needs coarsening only, which is faster than remeshing. */
static way first_way(const filler *f, double length) {
  double own = sqrt(f->area / (0.4330127 * f->base->triangle_count));
  return own < 0.6 * length ? WAY_COARSEN : WAY_REMESH;
}

static bw_status meet_count(filler *f) {
  double wanted = (double)f->options->elements, tolerance = log1p(f->options->tolerance) * 0.999;
  bw_status status = BW_OK;
  int64_t count = 0;
  way how = WAY_AS_IS;
  if (f->options->keep_surface || !f->options->remesh) {
    double volume = 1.8 * f->volume / wanted;
    BW_TRY(fill_at(f, &how, 0, volume, &count));
    BW_TRY(tune_volume(f, wanted, volume, count, 6));
    goto done;
  }
  /* Secant on the logarithms of length and count; the slope lies between that of a sheet, -2, and
   * that of a solid, -3, unless detail that must be kept flattens it. */
  double length = first_length(f, wanted), slope = -2.4, last_length = 0, last_count = 0;
  double low = 0, high = INFINITY; /* lengths known to give too many, too few */
  how = first_way(f, length);
  for (int i = 0; i < 8 && f->attempts < MOST_ATTEMPTS && !too_late(f); i++) {
    double volume = volume_of_length * length * length * length;
    status = fill_at(f, &how, length, volume, &count);
    if (status != BW_OK) {
      if (f->best.node && may_cure(status)) {
        status = BW_OK;
        break;
      }
      goto done;
    }
    if (f->best_miss <= tolerance)
      break;
    double ratio = (double)count / wanted;
    int64_t tunnels = tunnels_of(f->surface, 1);
    if (ratio > 1 && how < WAY_WRAP && 40.0 * (double)tunnels > wanted) {
      /* A wrap would close them, but it also fills the walls' surroundings: not the user's body. */
      bw_remark(
          f->context,
          "the surface has about %lld tunnels, which alone take more elements than wanted: "
          "walls thinner than the grid that it was made on look like that, and a finer grid "
          "would keep them. The count is not met; bw_surface_wrap closes tunnels where that is "
          "what you want",
          (long long)tunnels);
      break;
    }
    if (ratio > 1)
      low = fmax(low, length);
    else
      high = fmin(high, length);
    if (ratio > 0.4 && ratio < 1) { /* more elements inside do it */
      BW_TRY(tune_volume(f, wanted, volume, count, 2));
      if (f->best_miss <= tolerance)
        break;
    }
    if (last_length > 0 && fabs(log(length / last_length)) > 0.02) {
      slope = log((double)count / last_count) / log(length / last_length);
      slope = fmin(fmax(slope, -3.5), -1.0);
    }
    last_length = length;
    last_count = (double)count;
    length *= exp(fmin(fmax(-log(ratio) / slope, -1.5), 1.5));
    if (low > 0 && high < INFINITY && (length <= low || length >= high))
      length = sqrt(low * high);
    if (length > 0.5 * f->diagonal) {
      if (last_length > 0.49 * f->diagonal)
        break;
      length = 0.5 * f->diagonal;
    }
  }
done:
  return status;
}

/* Without a wish for the count: the surface at its own resolution, or one that fits the volume
 * bound, whichever is finer. */
static bw_status fill_once(filler *f) {
  const bw_fill_options *o = f->options;
  int64_t count;
  double length = sqrt(f->area / (0.4330127 * 1.15 * (double)f->base->triangle_count));
  double bound = 0;
  if (o->max_volume > 0)
    length = fmin(length, cbrt(o->max_volume / volume_of_length));
  way how = o->remesh && !o->keep_surface ? first_way(f, length) : WAY_AS_IS;
  if (o->max_volume == 0 && how != WAY_AS_IS)
    bound = 8 * length * length * length;
  bw_status status = fill_at(f, &how, length, bound, &count);
  return status;
}

/* ---- the whole ------------------------------------------------------------------------------ */

static bw_status report(filler *f, const bw_mesh *mesh, bw_fill_log *log) {
  bw_fill_log whole = {.shape = f->base_log,
                       .repaired = f->repaired,
                       .attempts = f->attempts,
                       .seconds_repair = f->seconds_repair,
                       .seconds_remesh = f->seconds_remesh,
                       .seconds_fill = f->seconds_fill};
  double moved = 0;
  append_log(&whole.shape, &f->best_log);
  if (f->best_log.count) { /* the steps may undo each other: measure from end to end */
    bw_status status = bw_surface_distance(f->context, f->base, f->best_surface, &moved);
    if (status != BW_OK)
      return status;
    moved = fmin(moved, f->best_log.moved);
    bw_remark(f->context,
              "the surface was remeshed to an edge length of about %.3g m, which moved it by up to "
              "%.3g m (%.2g of its size)",
              f->best_length, moved, moved / f->diagonal);
  }
  whole.surface_moved = f->base_log.moved + moved;
  if (f->options->elements > 0 && f->best_miss > log1p(f->options->tolerance))
    bw_remark(
        f->context,
        "%lld elements were asked for; %d is the nearest number that %d runs of TetGen came to%s",
        (long long)f->options->elements, mesh->element_count, f->attempts,
        too_late(f) ? " within time_limit" : "");
  if (log)
    *log = whole;
  return BW_OK;
}

bw_status bw_mesh_fill(bw_context *context, const bw_surface *surface,
                       const bw_fill_options *options, bw_mesh **mesh, bw_fill_log *log) {
  bw_fill_options defaults;
  bw_mesh *made = NULL;
  bw_fill_options_default(&defaults);
  filler f = {.context = context, .options = options ? options : &defaults};
  bw_status status;
  BW_TRY(check_options(context, f.options));
  f.field = (bwi_size_field){f.options->size_point_count, f.options->size_point, f.options->size,
                             f.options->size_data};
  f.start = bw_seconds();
  bw_progress(context, "fill", 0);
  BW_TRY(prepare_base(&f, surface));
  bw_progress(context, "fill", 0.1);
  if (f.options->elements > 0)
    BW_TRY(meet_count(&f));
  else
    BW_TRY(fill_once(&f));
  BW_TRY(bw_mesh_own(context, 1, f.best.node_count, f.best.node, f.best.element_count,
                     f.best.element, NULL, &made));
  f.best.node = NULL;
  f.best.element = NULL;
  if (!f.options->keep_surface) {
    int64_t gone;
    double moved;
    BW_TRY(bwi_peel_flat(context, &made, flat_angle, &gone, &moved));
    if (gone > 0)
      bw_shape_log_add(&f.best_log, "peel", gone, moved,
                       "%lld flat elements of less than %.3g m height were taken off the boundary",
                       (long long)gone, moved);
  }
  if (f.options->order == 2) {
    bw_mesh *wide;
    BW_TRY(bw_mesh_with_order(context, made, 2, &wide));
    bw_release(made);
    made = wide;
  }
  BW_TRY(report(&f, made, log));
  bw_progress(context, "fill", 1);
  *mesh = made;
  made = NULL;
done:
  bw_release(made);
  bw_release(f.base);
  bw_release(f.best_surface);
  bw_release(f.tidy);
  bw_release(f.surface);
  bw_free(f.hole);
  bw_free(f.best.node);
  bw_free(f.best.element);
  return status;
}
