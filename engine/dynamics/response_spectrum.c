/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The largest response to a base whose motion is known by its response spectrum
 * (docs/theory/dynamics.md): modes, the static response of what they leave out, and their
 * combination. */
#include <math.h>
#include <string.h>

#include "barwright/analysis.h"
#include "dynamics/equations.h"
#include "dynamics/internal.h"
#include "linear/blas.h"
#include "linear/internal.h"
#include "linear/multivector.h"
#include "model/internal.h"

void bw_response_spectrum_options_default(bw_response_spectrum_options *options) {
  *options = (bw_response_spectrum_options){.ratio = 0.05, .missing_mass = true};
}

static void destroy(void *object) {
  bw_response_spectrum *r = object;
  bw_release(r->model);
  bw_release(r->modes);
  bw_free(r->participation);
  bw_free(r->effective_mass);
  bw_free(r->acceleration);
  bw_free(r->displacement);
  bw_free(r->von_mises);
  bw_free(r->point);
  bw_free(r);
}

static size_t bytes(const void *object) {
  const bw_response_spectrum *r = object;
  return sizeof *r + bw_bytes(r->modes) +
         (3 * (size_t)r->count + 4 * (size_t)r->model->mesh->node_count +
          6 * (size_t)r->coupling_count) *
             sizeof(double);
}

static const bw_kind spectrum_kind = {"response spectrum", destroy, bytes};

static bw_status check(bw_context *context, const bw_response_spectrum_options *o) {
  const double *d = o->direction;
  if (o->count < 2)
    return bw_fail(context, BW_INVALID, "a response spectrum has 2 points or more, got %d",
                   o->count);
  for (int k = 0; k < o->count; k++) {
    double f = o->frequency[k], a = o->acceleration[k];
    if (!(f > 0 && f < INFINITY && a > 0 && a < INFINITY))
      return bw_fail(context, BW_INVALID,
                     "point %d of the response spectrum is %g m/s2 at %g Hz; both must be above 0, "
                     "and finite",
                     k + 1, a, f);
    if (k > 0 && !(f > o->frequency[k - 1]))
      return bw_fail(context, BW_INVALID,
                     "the frequencies of the response spectrum must ascend: point %d is at %g Hz, "
                     "behind %g Hz",
                     k + 1, f, o->frequency[k - 1]);
  }
  double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  if (!(length > 0 && length < INFINITY))
    return bw_fail(context, BW_INVALID,
                   "the direction (%g, %g, %g) has no length: give that of the base's acceleration",
                   d[0], d[1], d[2]);
  if (!(o->ratio > 0 && o->ratio < 1))
    return bw_fail(
        context, BW_INVALID,
        "the damping ratio of the response spectrum is %g; it must be above 0, and below "
        "1",
        o->ratio);
  if (o->solver && o->modes)
    return bw_fail(context, BW_INVALID,
                   "a response spectrum takes modes or a solver that finds them, not both");
  if (o->solver && o->solver->options.kind == BW_EIGENSOLVER_SLEPC)
    return bw_fail(context, BW_UNSUPPORTED,
                   "a response spectrum needs the equations in this process: SLEPc does not serve");
  return BW_OK;
}

/* The modes up to the last point, and their accelerations. */
static bw_status take_spectrum(bw_context *context, const bw_response_spectrum_options *o,
                               bw_response_spectrum *r) {
  double last = o->frequency[o->count - 1];
  while (r->count < r->modes->count && r->modes->frequency[r->count] <= last)
    r->count++;
  r->participation = BW_NEW0(context, double, r->count + 1);
  r->effective_mass = BW_NEW0(context, double, r->count + 1);
  r->acceleration = BW_NEW0(context, double, r->count + 1);
  if (!r->participation || !r->effective_mass || !r->acceleration)
    return BW_MEMORY;
  for (int k = 0, piece = 0; k < r->count; k++) {
    double f = r->modes->frequency[k];
    if (f < o->frequency[0])
      return bw_fail(
          context, BW_INVALID,
          "mode %d at %g Hz is below the first point of the response spectrum, at %g Hz: "
          "give points from below it",
          k + 1, f, o->frequency[0]);
    while (piece + 2 < o->count && f > o->frequency[piece + 1])
      piece++;
    r->acceleration[k] = bwi_between(o->frequency + piece, o->acceleration + piece, f);
  }
  if (r->count == 0 && o->missing_mass)
    bw_warn(context,
            "the response spectrum ends at %g Hz, below the first mode at %g Hz: the response is "
            "the static one under the %g m/s2 of the last point. If the base itself has another "
            "largest acceleration, give points beyond that mode",
            last, r->modes->frequency[0], r->base);
  else if (r->count == 0)
    bw_warn(context,
            "the response spectrum ends at %g Hz, below the first mode at %g Hz: without the "
            "missing mass the response is 0. Give points beyond that mode",
            last, r->modes->frequency[0]);
  return BW_OK;
}

/* What the parts of the response, the modes and the rigid one, are made of. */
typedef struct parts {
  int count;
  double *size;  /* (count) by which a part's field is multiplied */
  double *force; /* (count x 3) on the supports */
  double *rigid; /* (node_count x 3) the static displacement of what the modes leave out */
} parts;

static bw_status find_parts(bw_context *context, const bwi_equations *equations,
                            bw_response_spectrum *r, parts *p) {
  bw_status status = BW_OK;
  int64_t size = equations->size;
  double *field = BW_NEW0(context, double, 5 * size),
         *along = BW_NEW0(context, double, r->count + 1);
  double left[3] = {0};
  p->size = BW_NEW0(context, double, r->count + 1);
  p->force = BW_NEW0(context, double, 3 * ((int64_t)r->count + 1));
  p->rigid = BW_NEW(context, double, size);
  BW_TRY_MEMORY(field && along && p->size && p->force && p->rigid);
  double *moved = field + 3 * size, *unit = moved + size;
  for (int j = 0; j < 3; j++) { /* M times a unit motion along an axis */
    for (int64_t i = 0; i < size; i++)
      unit[i] = i % 3 == j;
    BW_TRY(bwi_equations_mass(context, equations, unit, field + j * size));
  }
  for (int64_t i = 0; i < size; i++) {
    unit[i] = r->direction[i % 3];
    for (int j = 0; j < 3; j++)
      moved[i] += r->direction[j] * field[j * size + i];
  }
  BW_TRY(bwi_multi_dot(context, size, 1, unit, 1, moved, &r->mass));
  BW_TRY(bwi_multi_dot(context, size, 3, field, 1, unit, left));
  r->missing_mass = r->mass;
  if (r->count > 0)
    BW_TRY(bwi_multi_dot(context, size, r->count, r->modes->shape, 1, moved, r->participation));
  for (int j = 0; j < 3 && r->count > 0; j++) {
    BW_TRY(bwi_multi_dot(context, size, r->count, r->modes->shape, 1, field + j * size, along));
    for (int k = 0; k < r->count; k++) {
      p->force[3 * k + j] = along[k] * r->participation[k] * r->acceleration[k];
      left[j] -= along[k] * r->participation[k];
    }
  }
  for (int k = 0; k < r->count; k++) {
    r->effective_mass[k] = r->participation[k] * r->participation[k];
    r->missing_mass -= r->effective_mass[k];
    p->size[k] = r->participation[k] * r->acceleration[k] / r->modes->eigenvalue[k];
  }
  p->count = r->count;
  if (r->base == 0)
    goto done;
  if (r->count > 0)
    BW_TRY(bwi_multi_combine(context, size, r->count, r->modes->shape, 1, r->participation,
                             r->count, -1, 1, unit));
  BW_TRY(bwi_equations_mass(context, equations, unit, moved));
  BW_TRY(bwi_equations_solve(context, equations, moved, p->rigid));
  p->size[p->count] = r->base;
  for (int j = 0; j < 3; j++)
    p->force[3 * p->count + j] = r->base * left[j];
  p->count++;
done:
  bw_free(field);
  bw_free(along);
  return status;
}

/* The correlation of two modes (Der Kiureghian, 1981, equation 16 for white noise, in the form of
 * Wilson, Der Kiureghian and Bayo, 1981). */
static double correlation(double ratio, double a, double b) {
  double beta = fmin(a, b) / fmax(a, b), z = 4 * ratio * ratio;
  double part = 2 * z * (1 + beta) * beta * sqrt(beta);
  return part / ((1 - beta * beta) * (1 - beta * beta) + z * beta * (1 + beta) * (1 + beta));
}

/* The combinations of parts whose squares are summed, in columns (count x count): those of CQC are
 * the eigenvectors of the correlation; else the parts themselves. */
static bw_status find_columns(bw_context *context, const bw_response_spectrum *r, int count,
                              double *column) {
  bw_status status = BW_OK;
  int info = 0, length = 4 * count + 64;
  double *mu = BW_NEW(context, double, count + 1), *work = BW_NEW(context, double, length);
  BW_TRY_MEMORY(mu && work);
  for (int j = 0; j < count; j++)
    for (int i = 0; i < count; i++) {
      bool modes = r->combination == BW_CQC && i < r->count && j < r->count;
      column[j * count + i] =
          i == j  ? 1
          : modes ? correlation(r->ratio, r->modes->frequency[i], r->modes->frequency[j])
                  : 0;
    }
  if (r->combination != BW_CQC || count == 0)
    goto done;
  dsyev_("V", "L", &count, column, &count, mu, work, &length, &info);
  if (info != 0)
    BW_TRY(bw_fail(context, BW_INTERNAL, "dsyev failed on a correlation of %d (%d)", count, info));
  for (int j = 0; j < count; j++)
    for (int i = 0; i < count; i++)
      column[j * count + i] *= sqrt(fmax(mu[j], 0));
done:
  bw_free(mu);
  bw_free(work);
  return status;
}

static void add(bool absolute, int64_t count, const double *value, double *sum) {
  for (int64_t i = 0; i < count; i++)
    sum[i] += absolute ? fabs(value[i]) : value[i] * value[i];
}

static void finish(bool absolute, int64_t count, double *sum) {
  for (int64_t i = 0; i < count && !absolute; i++)
    sum[i] = sqrt(sum[i]);
}

/* Sums over the columns: `mises` (points->count). */
static bw_status combine(bw_context *context, const parts *p, const double *column,
                         const bw_stress_points *points, double *mises, bw_response_spectrum *r) {
  bw_status status = BW_OK;
  const bw_model *model = r->model;
  bool absolute = r->combination == BW_ABSOLUTE;
  int64_t size = 3 * (int64_t)model->mesh->node_count, motions = 6 * (int64_t)r->coupling_count;
  double *field = BW_NEW(context, double, size), *motion = BW_NEW(context, double, motions);
  double *weight = BW_NEW(context, double, p->count + 1);
  double *stress = BW_NEW(context, double, 6 * (int64_t)points->count);
  BW_TRY_MEMORY(field && motion && weight && stress);
  for (int k = 0; k < p->count; k++) {
    double force[3] = {0};
    BW_TRY(bw_check_cancel(context));
    for (int i = 0; i < p->count; i++) {
      weight[i] = column[(int64_t)k * p->count + i] * p->size[i];
      for (int j = 0; j < 3; j++)
        force[j] += column[(int64_t)k * p->count + i] * p->force[3 * i + j];
    }
    memset(field, 0, (size_t)size * sizeof *field);
    if (r->count > 0)
      BW_TRY(bwi_multi_combine(context, size, r->count, r->modes->shape, 1, weight, r->count, 1, 0,
                               field));
    if (p->count > r->count)
      BW_TRY(bwi_multi_combine(context, size, 1, p->rigid, 1, weight + r->count, 1, 1, 1, field));
    add(absolute, size, field, r->displacement);
    add(absolute, 3, force, r->base_force);
    bwi_point_motions(model, field, motion);
    add(absolute, motions, motion, r->point);
    BW_TRY(bw_point_stress(context, model->mesh, model->material, field, points, stress));
    for (int64_t i = 0; i < points->count; i++) {
      double own = bw_von_mises(stress + 6 * i);
      add(absolute, 1, &own, mises + i);
    }
    bw_progress(context, "combining modes", (double)(k + 1) / p->count);
  }
  finish(absolute, size, r->displacement);
  finish(absolute, 3, r->base_force);
  finish(absolute, motions, r->point);
  finish(absolute, points->count, mises);
done:
  bw_free(field);
  bw_free(motion);
  bw_free(weight);
  bw_free(stress);
  return status;
}

static bw_status respond(bw_context *context, const bwi_equations *equations,
                         bw_response_spectrum *r) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = r->model->mesh;
  parts p = {0};
  bw_stress_points points = {0};
  double *column = NULL, *mises = NULL;
  BW_TRY(find_parts(context, equations, r, &p));
  column = BW_NEW(context, double, (int64_t)p.count *p.count + 1);
  r->displacement = BW_NEW0(context, double, 3 * (int64_t)mesh->node_count);
  r->von_mises = BW_NEW0(context, double, mesh->node_count);
  r->coupling_count = r->model->coupling_count;
  r->point = BW_NEW0(context, double, 6 * (int64_t)r->coupling_count);
  BW_TRY_MEMORY(column && r->displacement && r->von_mises && r->point);
  BW_TRY(find_columns(context, r, p.count, column));
  BW_TRY(bw_stress_points_create(context, mesh, r->model->material, &points));
  mises = BW_NEW0(context, double, points.count);
  BW_TRY_MEMORY(mises);
  BW_TRY(combine(context, &p, column, &points, mises, r));
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int32_t k = i; k >= 0; k = points.point ? points.point[k].next : -1)
      r->von_mises[i] = fmax(r->von_mises[i], mises[k]);
done:
  bw_stress_points_clear(&points);
  bw_free(p.size);
  bw_free(p.force);
  bw_free(p.rigid);
  bw_free(column);
  bw_free(mises);
  return status;
}

/* Those of remote points too. */
static int count_loads(const bw_model *model) {
  int count = model->load_count;
  for (int p = 0; p < model->coupling_count; p++) {
    bool acts = false;
    for (int k = 0; k < 6; k++)
      acts = acts || model->coupling[p].point.load[k] != 0;
    count += acts;
  }
  return count;
}

/* The equations and the modes, which are found unless they are given. */
static bw_status open(bw_context *context, bw_system *given, const bw_response_spectrum_options *o,
                      bw_system **used, bwi_equations *equations, bw_response_spectrum *r) {
  bw_status status = BW_OK;
  bw_dof_map *dof_map = NULL;
  double last = o->frequency[o->count - 1];
  if (!o->modes) {
    BW_TRY(bwi_modes_up_to(context, r->model, given, o->solver, 0, last, used, &r->modes));
    return bwi_equations_open(context, r->model, *used, equations);
  }
  if (!bw_model_joined(r->model)) {
    BW_TRY(bw_dof_map_create(context, r->model, &dof_map));
    BW_TRY(bwi_equations_system(context, r->model, dof_map, given, used));
  }
  BW_TRY(bwi_equations_open(context, r->model, *used, equations));
  BW_TRY(bwi_equations_check_modes(context, r->model, equations, o->modes));
  int n = o->modes->count;
  double end = o->modes->frequency[n - 1];
  if (n < equations->unknown_count && !(end >= last))
    BW_TRY(bw_fail(context, BW_INVALID,
                   "the modes end at %g Hz, below the last point of the response spectrum at %g "
                   "Hz: give more of them",
                   end, last));
  r->modes = bw_retain(o->modes);
done:
  bw_release(dof_map);
  return status;
}

bw_status bw_response_spectrum_of_model(bw_context *context, const bw_model *model,
                                        bw_system *given,
                                        const bw_response_spectrum_options *options,
                                        bw_system **system, bw_response_spectrum **response) {
  bw_status status = BW_OK;
  bw_system *used = NULL;
  bwi_equations equations = {0};
  bw_response_spectrum *r = NULL;
  bwi_blas_enter();
  BW_TRY(check(context, options));
  BW_TRY(bwi_check_held_model(context, model, "a response spectrum"));
  int loads = count_loads(model);
  if (loads > 0)
    bw_warn(context,
            "the loads of the part, %d of them, are not in a response spectrum, which has the "
            "motion of the base alone: add their static stresses to it, of either sign",
            loads);
  r = BW_NEW0(context, bw_response_spectrum, 1);
  BW_TRY_MEMORY(r);
  bw_object_init(r, &spectrum_kind);
  r->model = bw_retain(model);
  r->revision = model->object.revision;
  r->ratio = options->ratio;
  r->combination = options->combination;
  const double *d = options->direction;
  for (int j = 0; j < 3; j++)
    r->direction[j] = d[j] / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  r->base = options->missing_mass ? options->acceleration[options->count - 1] : 0;
  BW_TRY(open(context, given, options, &used, &equations, r));
  BW_TRY(take_spectrum(context, options, r));
  BW_TRY(respond(context, &equations, r));
  *response = r;
  r = NULL;
done:
  bwi_blas_leave();
  if (system)
    *system = bw_retain(used);
  bwi_equations_clear(&equations);
  bw_release(used);
  bw_release(r);
  return status;
}
