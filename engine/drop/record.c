/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What is kept of a drop: energies, rows of its history, and the stress of the states of an impact.
 */
#include <math.h>
#include <string.h>

#include "analysis/stress_peaks.h"
#include "base/dense.h"
#include "drop/internal.h"
#include "linear/blas.h"

enum { BATCH = BWI_PEAK_FIELDS /* states whose stresses are found at once */ };

bwi_drop_energy bwi_drop_energy_of(const bwi_drop_run *run) {
  const bwi_drop_motion *m = &run->motion;
  const bwi_drop_touch *t = &run->touch;
  bwi_drop_energy e = {0};
  double spin[3];
  bwi_drop_spin(m, spin);
  e.motion = 0.5 * m->mass * bw_dot(m->velocity, m->velocity) + 0.5 * bw_dot(spin, m->momentum);
  e.potential = -m->mass * (bw_dot(m->gravity, m->centre) - bw_dot(m->gravity, run->origin));
  for (int k = 0; k < m->modes; k++) {
    double swing = m->omega[k] * m->q[k];
    e.vibration += 0.5 * m->rate[k] * m->rate[k];
    e.strain += 0.5 * swing * swing;
  }
  for (int j = 0; j < t->count; j++) /* force S force = -force gap, since w force = 0 */
    e.strain -= 0.5 * t->force[j] * t->gap[j];
  return e;
}

/* ---- rows ------------------------------------------------------------------------------------ */

bw_status bwi_drop_rows_create(bw_context *context, int capacity, int width, bwi_drop_rows *rows) {
  *rows = (bwi_drop_rows){.capacity = capacity, .width = width, .stride = 1};
  rows->row = BW_NEW(context, double, (int64_t)capacity *width);
  return rows->row ? BW_OK : BW_MEMORY;
}

double *bwi_drop_rows_next(bwi_drop_rows *rows) {
  size_t width = (size_t)rows->width;
  if (rows->seen++ % rows->stride != 0)
    return NULL;
  if (rows->count == rows->capacity) {
    rows->count = 0;
    for (int i = 0; i < rows->capacity; i += 2)
      memcpy(rows->row + (size_t)rows->count++ * width, rows->row + (size_t)i * width,
             width * sizeof *rows->row);
    rows->stride *= 2;
    if ((rows->seen - 1) % rows->stride != 0)
      return NULL;
  }
  return rows->row + (size_t)rows->count++ * width;
}

/* ---- states ---------------------------------------------------------------------------------- */

bw_status bwi_drop_states_take(bw_context *context, const bwi_drop_run *run,
                               bwi_drop_states *states) {
  const bwi_drop_motion *m = &run->motion;
  const bwi_drop_touch *t = &run->touch;
  if (states->capacity == 0 || states->seen++ % states->stride != 0)
    return BW_OK;
  if (states->count == states->capacity) {
    int kept = 0;
    for (int i = 0; i < states->capacity; i++)
      if (i % 2 == 0)
        states->state[kept++] = states->state[i];
      else
        bw_free(states->state[i].data);
    states->count = kept;
    states->stride *= 2;
    if ((states->seen - 1) % states->stride != 0)
      return BW_OK;
  }
  bwi_drop_state *state = &states->state[states->count];
  *state = (bwi_drop_state){.time = m->time, .count = t->count};
  state->data = BW_NEW(context, double, m->modes + t->count);
  if (!state->data)
    return BW_MEMORY;
  memcpy(state->data, m->q, (size_t)m->modes * sizeof *state->data);
  for (int j = 0; j < t->count; j++)
    state->data[m->modes + j] = t->force[j];
  states->count++;
  return BW_OK;
}

void bwi_drop_states_empty(bwi_drop_states *states) {
  for (int i = 0; i < states->count; i++)
    bw_free(states->state[i].data);
  states->count = 0;
  states->seen = 0;
  states->stride = 1;
}

/* u (node_count x 3 x BATCH) of states first, first + 1, ..., 0 behind the last: modes and columns.
 */
static bw_status displacements(bw_context *context, const bwi_drop_run *run,
                               const bwi_drop_states *states, int first, double *u) {
  bw_status status = BW_OK;
  const bwi_drop_touch *t = &run->touch;
  int m = run->motion.modes, size = 3 * run->model->mesh->node_count;
  const int batch = BATCH, count = states->count - first < BATCH ? states->count - first : BATCH;
  const double one = 1, none = 0;
  double *factor =
      BW_NEW0(context, double, (int64_t)BATCH *(m > BWI_DROP_COLUMNS ? m : BWI_DROP_COLUMNS));
  BW_TRY_MEMORY(factor);
  for (int i = 0; i < count; i++)
    memcpy(factor + (size_t)i * (size_t)m, states->state[first + i].data,
           (size_t)m * sizeof *factor);
  bwi_blas_enter();
  dgemm_("T", "T", &batch, &size, &m, &one, factor, &m, run->modes->shape, &size, &none, u, &batch);
  for (const bwi_drop_columns *c = t->columns; c; c = c->next) {
    int width = c->count;
    memset(factor, 0, (size_t)BATCH * (size_t)width * sizeof *factor);
    for (int j = 0; j < t->count; j++) {
      if (t->column[j] < c->field || t->column[j] >= c->field + (int64_t)width * size)
        continue;
      int column = (int)((t->column[j] - c->field) / size);
      for (int i = 0; i < count; i++) {
        const bwi_drop_state *state = &states->state[first + i];
        factor[i * width + column] = j < state->count ? state->data[m + j] : 0;
      }
    }
    dgemm_("T", "T", &batch, &size, &width, &one, factor, &width, c->field, &size, &one, u, &batch);
  }
  bwi_blas_leave();
done:
  bw_free(factor);
  return status;
}

bw_status bwi_drop_states_stress(bw_context *context, const bwi_drop_run *run,
                                 const bwi_drop_states *states, bw_drop *drop) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = run->model->mesh;
  size_t size = 3 * (size_t)mesh->node_count;
  double *u = NULL, most[BATCH];
  int32_t where[BATCH];
  int count = states->count;
  if (count == 0)
    return BW_OK;
  double *time = BW_NEW(context, double, drop->sample_count + count);
  double *largest = BW_NEW(context, double, drop->sample_count + count);
  u = BW_NEW(context, double, BATCH *size);
  BW_TRY_MEMORY(time && largest && u);
  for (int first = 0; first < count; first += BATCH) {
    BW_TRY(bw_check_cancel(context));
    BW_TRY(displacements(context, run, states, first, u));
    BW_TRY(bwi_stress_peaks(context, mesh, run->model->material, u, drop->stress, drop->utilisation,
                            most, where));
    for (int i = 0; i < BATCH && first + i < count; i++) {
      int row = drop->sample_count + first + i;
      time[row] = states->state[first + i].time;
      largest[row] = most[i];
      if (drop->peak_element < 0 || most[i] > drop->peak) {
        drop->peak = most[i];
        drop->peak_element = where[i];
        drop->peak_time = time[row];
        for (size_t k = 0; k < size; k++)
          drop->displacement[k] = u[k * BATCH + (size_t)i];
      }
    }
  }
  if (drop->sample_count > 0) {
    memcpy(time, drop->sample, (size_t)drop->sample_count * sizeof *time);
    memcpy(largest, drop->sample_stress, (size_t)drop->sample_count * sizeof *largest);
  }
  bw_free(drop->sample);
  bw_free(drop->sample_stress);
  drop->sample = time;
  drop->sample_stress = largest;
  drop->sample_count += count;
  time = largest = NULL;
done:
  bw_free(time);
  bw_free(largest);
  bw_free(u);
  return status;
}
