/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The modes of a wheel from one sector: for each number of nodal diameters the lowest ones of a
 * real symmetric problem, twice as large where displacements are complex, and of all of them the
 * lowest (docs/theory/symmetry.md). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "barwright/job.h"
#include "eigen/modes.h"
#include "joint/cyclic.h"

/* The lowest modes so far, ascending. */
typedef struct lowest {
  int capacity, count;
  int64_t size; /* 3 node_count */
  double *value, *residual;
  double *shape, *quadrature; /* capacity x size: real and imaginary part */
  int *diameter;
  double **kept; /* capacity + 1: rows of both parts, 2 x size */
} lowest;

static bw_status lowest_open(bw_context *context, int capacity, int64_t size, lowest *l) {
  *l = (lowest){.capacity = capacity, .size = size};
  l->value = BW_NEW(context, double, capacity);
  l->residual = BW_NEW(context, double, capacity);
  l->diameter = BW_NEW(context, int, capacity);
  l->kept = BW_NEW0(context, double *, capacity);
  return l->value && l->residual && l->diameter && l->kept ? BW_OK : BW_MEMORY;
}

static void lowest_clear(lowest *l) {
  for (int i = 0; l->kept && i < l->count; i++)
    bw_free(l->kept[i]);
  bw_free(l->kept);
  bw_free(l->value);
  bw_free(l->residual);
  bw_free(l->diameter);
  bw_free(l->shape);
  bw_free(l->quadrature);
}

/* Inserts a mode: those of fewer diameters come first where eigenvalues are equal. NULL where it is
 * none of the lowest; `place` for its shape else. */
static bw_status insert(bw_context *context, lowest *l, double value, double residual, int diameter,
                        double **place) {
  int at = l->count;
  double *kept;
  *place = NULL;
  if (l->count == l->capacity && value >= l->value[l->count - 1])
    return BW_OK;
  if (l->count == l->capacity)
    kept = l->kept[--l->count];
  else
    kept = BW_NEW(context, double, 2 * l->size);
  if (!kept)
    return BW_MEMORY;
  for (at = l->count++; at > 0 && l->value[at - 1] > value; at--) {
    l->value[at] = l->value[at - 1];
    l->residual[at] = l->residual[at - 1];
    l->diameter[at] = l->diameter[at - 1];
    l->kept[at] = l->kept[at - 1];
  }
  l->value[at] = value;
  l->residual[at] = residual;
  l->diameter[at] = diameter;
  l->kept[at] = *place = kept;
  return BW_OK;
}

typedef struct sector {
  const bw_model *model;
  bw_modes_options options;
  bw_block_pattern *pattern;
  double *stiffness, *mass;
  lowest lowest;
  int rigid_count, found; /* of all numbers of diameters */
  bwi_eigen_result sum;   /* what is added up over them */
} sector;

static bw_status reduced(bw_context *context, const sector *s, const bwi_reduction *r,
                         const double *values, int block, const char *name, bw_operator **out) {
  bw_sparse_matrix *matrix = NULL;
  bw_status status = bwi_reduce_matrix(context, r, s->pattern, values, block, &matrix);
  if (status == BW_OK)
    status = bw_operator_of_matrix(context, matrix, name, out);
  bw_release(matrix);
  return status;
}

/* What eigenpairs of one number of diameters add. */
static bw_status take_pairs(bw_context *context, sector *s, const bwi_reduction *r, int diameter,
                            int rigid, const bw_eigenpairs *pairs) {
  bw_status status = BW_OK;
  lowest *l = &s->lowest;
  for (int k = rigid; k < pairs->count; k++) {
    double *place;
    BW_TRY(insert(context, l, pairs->value[k], pairs->residual[k], diameter, &place));
    if (!place)
      break;
    memset(place, 0, 2 * (size_t)l->size * sizeof *place);
    BW_TRY(bw_sparse_matrix_apply(context, r->t, 1, pairs->vector + k * pairs->size, place));
  }
  s->sum.recovered += pairs->recovered;
  s->sum.counted &= pairs->counted;
  s->sum.tested &= pairs->tested;
  double seconds = s->sum.report.seconds, bytes = s->sum.report.bytes;
  int iterations = s->sum.report.iterations;
  s->sum.report = pairs->report;
  s->sum.report.seconds += seconds;
  s->sum.report.iterations += iterations;
  s->sum.report.bytes = fmax(bytes, s->sum.report.bytes);
done:
  return status;
}

static bw_status one_diameter(bw_context *context, sector *s, int diameter) {
  bw_status status = BW_OK;
  bwi_reduction r = {0};
  bw_operator *k = NULL, *m = NULL;
  bw_eigenpairs *pairs = NULL;
  int rigid;
  int32_t body;
  BW_TRY(bwi_cyclic_reduction_open(context, s->model, diameter, &r));
  if (r.unknown_count == 0)
    goto done;
  BW_TRY(bwi_cyclic_rigid_modes(context, s->model, r.dof_map, diameter, &rigid, &body));
  s->rigid_count += rigid;
  BW_TRY(reduced(context, s, &r, s->stiffness, 9, "stiffness of the sector", &k));
  BW_TRY(reduced(context, s, &r, s->mass, 1, "mass of the sector", &m));
  BW_TRY(bwi_joined_pairs(context, &s->options, rigid, k, m, &pairs));
  BW_TRY(take_pairs(context, s, &r, diameter, rigid, pairs));
done:
  bwi_reduction_clear(&r);
  bw_release(k);
  bw_release(m);
  bw_release(pairs);
  return status;
}

/* The largest component of the real part is positive, as bwi_modes_from makes it; the other part
 * goes with it. */
static bool is_negative(const double *shape, int64_t size) {
  double largest = 0;
  for (int64_t i = 0; i < size; i++)
    largest = fmax(largest, fabs(shape[i]));
  for (int64_t i = 0; i < size; i++)
    if (fabs(shape[i]) >= largest * (1 - 1e-6))
      return shape[i] < 0;
  return false;
}

static bw_status make_modes(bw_context *context, sector *s, bw_modes **out) {
  bw_status status = BW_OK;
  lowest *l = &s->lowest;
  int64_t size = l->size;
  bwi_eigen_result result = s->sum;
  bw_modes *modes = NULL;
  l->shape = BW_NEW(context, double, l->count *size);
  l->quadrature = BW_NEW(context, double, l->count *size);
  BW_TRY_MEMORY(l->shape && l->quadrature);
  for (int k = 0; k < l->count; k++) {
    double sign = is_negative(l->kept[k], size) ? -1 : 1;
    for (int64_t i = 0; i < size; i++) {
      l->shape[k * size + i] = sign * l->kept[k][i];
      l->quadrature[k * size + i] = sign * l->kept[k][size + i];
    }
  }
  result.count = l->count;
  result.value = l->value;
  result.residual = l->residual;
  result.vector = l->shape;
  l->value = l->residual = l->shape = NULL;
  status =
      bwi_modes_from(context, s->model->mesh, s->model->material, s->rigid_count, &result, &modes);
  bwi_eigen_result_clear(&result);
  BW_TRY(status);
  modes->cyclic = bw_retain(s->model->cyclic);
  modes->quadrature = l->quadrature;
  modes->nodal_diameter = l->diameter;
  l->quadrature = NULL;
  l->diameter = NULL;
  *out = modes;
done:
  return status;
}

bw_status bwi_cyclic_modes(bw_context *context, const bw_model *model,
                           const bw_modes_options *options, bw_modes **modes) {
  bw_status status = BW_OK;
  sector s = {.model = model, .options = *options};
  int most = model->cyclic->count / 2, only = options->nodal_diameter;
  s.sum.counted = s.sum.tested = true;
  if (only > most)
    return bw_fail(context, BW_INVALID,
                   "%d nodal diameters were requested: a wheel of %d sectors has 0 to %d", only,
                   model->cyclic->count, most);
  BW_TRY(lowest_open(context, options->count, 3 * (int64_t)model->mesh->node_count, &s.lowest));
  BW_TRY(bw_block_pattern_create(context, model->mesh, &s.pattern));
  s.stiffness = BW_NEW(context, double, 9 * s.pattern->block_count);
  s.mass = BW_NEW(context, double, s.pattern->block_count);
  BW_TRY_MEMORY(s.stiffness && s.mass);
  BW_TRY(bw_stiffness(context, s.pattern, model->mesh, model->material, s.stiffness));
  BW_TRY(bw_mass(context, s.pattern, model->mesh, model->material, s.mass));
  bwi_add_attachments(model, s.pattern, 9, s.stiffness);
  bwi_add_attachments(model, s.pattern, 1, s.mass);
  for (int d = only < 0 ? 0 : only; d <= (only < 0 ? most : only); d++) {
    bw_progress(context, "nodal diameters", only < 0 ? (double)d / (most + 1) : 0);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(one_diameter(context, &s, d));
  }
  BW_TRY(make_modes(context, &s, modes));
done:
  lowest_clear(&s.lowest);
  bw_release(s.pattern);
  bw_free(s.stiffness);
  bw_free(s.mass);
  return status;
}
