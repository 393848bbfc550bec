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
  e.strain += 0.5 * bwi_drop_contact_energy(t);
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
  *state = (bwi_drop_state){.time = m->time,
                            .reach = bwi_drop_contact_reach(t, bwi_drop_contact_energy(t)),
                            .count = t->count};
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

/* Displacements G b under forces on candidates. Where fewer candidates push than there are states,
 * they are those of a unit force on each, for all states; else those of the states at work. */
typedef struct pushed {
  bool by_state;
  int count;      /* fields */
  int32_t *which; /* (count) candidates, where they are of these */
  double *field;  /* (count x node_count x 3) */
} pushed;

static void pushed_clear(pushed *p) {
  bw_free(p->which);
  bw_free(p->field);
}

static bw_status solve(bw_context *context, bwi_drop_run *run, int count, double *field) {
  run->solves += count;
  return bw_system_solve(context, run->system, count, field, field);
}

static void add_push(const bwi_drop_run *run, int candidate, double force, double *field) {
  const bwi_drop_touch *t = &run->touch;
  double *at = field + 3 * (int64_t)run->points.node[t->point[candidate]];
  for (int k = 0; k < 3; k++)
    at[k] += force * t->push[3 * (int64_t)candidate + k];
}

static bw_status pushed_create(bw_context *context, bwi_drop_run *run,
                               const bwi_drop_states *states, pushed *p) {
  bw_status status = BW_OK;
  const int m = run->motion.modes;
  int64_t size = 3 * (int64_t)run->model->mesh->node_count;
  p->which = BW_NEW(context, int32_t, run->touch.count);
  BW_TRY_MEMORY(p->which);
  for (int j = 0; j < run->touch.count; j++) {
    bool pushes = false;
    for (int i = 0; i < states->count && !pushes; i++)
      pushes = j < states->state[i].count && states->state[i].data[m + j] > 0;
    if (pushes)
      p->which[p->count++] = j;
  }
  p->by_state = p->count > states->count;
  if (p->by_state)
    p->count = BATCH;
  BW_TRY(bwi_drop_check_memory(context, (double)size * (p->count + BATCH),
                               "the displacements at the samples of the stress",
                               "take fewer samples, or fewer elements"));
  p->field = BW_NEW0(context, double, size * p->count);
  BW_TRY_MEMORY(p->field);
  for (int first = 0; first < p->count && !p->by_state; first += BATCH) {
    int count = p->count - first < BATCH ? p->count - first : BATCH;
    for (int j = first; j < first + count; j++)
      add_push(run, p->which[j], 1, p->field + j * size);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(solve(context, run, count, p->field + first * size));
  }
done:
  return status;
}

/* The longest motion of a point by contact, over its bound then, in states first, first + 1, ... */
static void check_reach(bwi_drop_run *run, const bwi_drop_states *states, int first, int count,
                        const double *u) {
  const bwi_drop_points *p = &run->points;
  int m = run->motion.modes;
  for (int i = 0; i < count; i++) {
    const bwi_drop_state *state = &states->state[first + i];
    double most = 0;
    for (int32_t j = 0; state->reach > 0 && j < p->count; j++) {
      double by_contact[3];
      for (int k = 0; k < 3; k++)
        by_contact[k] = u[(3 * (int64_t)p->node[j] + k) * BATCH + i] -
                        bwi_dot(m, p->basis + (3 * (int64_t)j + k) * m, state->data);
      most = fmax(most, bw_norm(by_contact));
    }
    run->beyond = fmax(run->beyond, state->reach > 0 ? most / state->reach : 0);
  }
}

/* u (node_count x 3 x BATCH) of states first, first + 1, ..., 0 behind the last:
 * phi (q - phi^T b / omega^2) + G b under the forces b. */
static bw_status displacements(bw_context *context, bwi_drop_run *run,
                               const bwi_drop_states *states, int first, pushed *p, double *u) {
  bw_status status = BW_OK;
  const bwi_drop_touch *t = &run->touch;
  int m = run->motion.modes, size = 3 * run->model->mesh->node_count;
  const int batch = BATCH, count = states->count - first < BATCH ? states->count - first : BATCH;
  const double one = 1, none = 0;
  double *factor = BW_NEW0(context, double, (int64_t)BATCH *m), *modal = BW_NEW(context, double, m);
  double *weight = BW_NEW0(context, double, (int64_t)BATCH * p->count);
  BW_TRY_MEMORY(factor && modal && weight);
  for (int i = 0; i < count; i++)
    memcpy(factor + (size_t)i * (size_t)m, states->state[first + i].data,
           (size_t)m * sizeof *factor);
  for (int j = 0; j < t->count; j++) {
    bwi_drop_modal_force(run, t->point[j], t->push + 3 * (int64_t)j, modal);
    for (int i = 0; i < count; i++) {
      const bwi_drop_state *state = &states->state[first + i];
      for (int k = 0; k < m && j < state->count; k++)
        factor[i * m + k] -= state->data[m + j] * modal[k] / run->modes->eigenvalue[k];
    }
  }
  if (p->by_state)
    memset(p->field, 0, (size_t)BATCH * (size_t)size * sizeof *p->field);
  for (int i = 0; i < count; i++) {
    const bwi_drop_state *state = &states->state[first + i];
    if (p->by_state) {
      weight[i * p->count + i] = 1;
      for (int j = 0; j < state->count; j++)
        add_push(run, j, state->data[m + j], p->field + (int64_t)i * size);
    } else
      for (int j = 0; j < p->count; j++)
        weight[i * p->count + j] = p->which[j] < state->count ? state->data[m + p->which[j]] : 0;
  }
  if (p->by_state)
    BW_TRY(solve(context, run, count, p->field));
  bwi_blas_enter();
  dgemm_("T", "T", &batch, &size, &m, &one, factor, &m, run->modes->shape, &size, &none, u, &batch);
  if (p->count > 0)
    dgemm_("T", "T", &batch, &size, &p->count, &one, weight, &p->count, p->field, &size, &one, u,
           &batch);
  bwi_blas_leave();
  check_reach(run, states, first, count, u);
done:
  bw_free(factor);
  bw_free(modal);
  bw_free(weight);
  return status;
}

static bw_status keep(bw_context *context, bwi_drop_run *run, bwi_drop_states *states) {
  const bwi_drop_touch *t = &run->touch;
  bwi_drop_sampled *sampled = &run->sampled[run->sampled_count++];
  sampled->count = t->count;
  sampled->point = BW_NEW(context, int32_t, t->count);
  sampled->push = BW_NEW(context, double, 3 * (int64_t)t->count);
  if (!sampled->point || !sampled->push)
    return BW_MEMORY;
  memcpy(sampled->point, t->point, (size_t)t->count * sizeof *t->point);
  memcpy(sampled->push, t->push, 3 * (size_t)t->count * sizeof *t->push);
  sampled->states = *states;
  *states = (bwi_drop_states){0};
  return BW_OK;
}

void bwi_drop_sampled_clear(bwi_drop_run *run) {
  for (int i = 0; i < run->sampled_count; i++) {
    bwi_drop_states_empty(&run->sampled[i].states);
    bw_free(run->sampled[i].states.state);
    bw_free(run->sampled[i].point);
    bw_free(run->sampled[i].push);
  }
  bw_free(run->sampled);
}

/* Its stress is s . u with few forces s at its nodes for each component. G is symmetric: G s has
 * that of all forces of contact, s . G b = b . G s, for six solutions in all. */
bw_status bwi_drop_peak_history(bw_context *context, bwi_drop_run *run, bw_drop *drop) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = run->model->mesh;
  const int64_t size = 3 * (int64_t)mesh->node_count;
  const int m = run->motion.modes;
  double weight[6][10][3], stress[6], *field = NULL, *by_mode = NULL, *by_force = NULL;
  double *modal = NULL;
  int row = 0;
  if (drop->peak_element < 0)
    return BW_OK;
  field = BW_NEW0(context, double, 6 * size);
  by_mode = BW_NEW0(context, double, 6 * (int64_t)m);
  modal = BW_NEW(context, double, m);
  drop->peak_stress = BW_NEW(context, double, drop->sample_count);
  BW_TRY_MEMORY(field && by_mode && modal && drop->peak_stress);
  bwi_mean_stress_weights(mesh, run->model->material, drop->peak_element, weight);
  for (int a = 0; a < mesh->nodes_per_element; a++) {
    int64_t at =
        3 * (int64_t)mesh->element[(int64_t)drop->peak_element * mesh->nodes_per_element + a];
    for (int i = 0; i < 6; i++) {
      memcpy(field + i * size + at, weight[i][a], sizeof weight[i][a]);
      for (int k = 0; k < m; k++)
        by_mode[i * m + k] += bw_dot(weight[i][a], run->modes->shape + k * size + at);
    }
  }
  BW_TRY(solve(context, run, 6, field));
  for (int s = 0; s < run->sampled_count; s++) {
    const bwi_drop_sampled *sampled = &run->sampled[s];
    const int count = sampled->count;
    bw_free(by_force);
    by_force = BW_NEW(context, double, 6 * (int64_t)count);
    BW_TRY_MEMORY(by_force);
    for (int j = 0; j < count; j++) {
      const double *push = sampled->push + 3 * (int64_t)j;
      const int64_t at = 3 * (int64_t)run->points.node[sampled->point[j]];
      bwi_drop_modal_force(run, sampled->point[j], push, modal);
      for (int k = 0; k < m; k++)
        modal[k] /= run->modes->eigenvalue[k];
      for (int i = 0; i < 6; i++)
        by_force[i * count + j] =
            bw_dot(field + i * size + at, push) - bwi_dot(m, by_mode + i * m, modal);
    }
    for (int n = 0; n < sampled->states.count; n++) {
      const bwi_drop_state *state = &sampled->states.state[n];
      for (int i = 0; i < 6; i++)
        stress[i] = bwi_dot(m, by_mode + i * m, state->data) +
                    bwi_dot(state->count, by_force + i * count, state->data + m);
      drop->peak_stress[row++] = bwi_max_principal(stress);
    }
  }
done:
  bw_free(field);
  bw_free(by_mode);
  bw_free(by_force);
  bw_free(modal);
  return status;
}

bw_status bwi_drop_states_stress(bw_context *context, bwi_drop_run *run, bwi_drop_states *states,
                                 bw_drop *drop) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = run->model->mesh;
  size_t size = 3 * (size_t)mesh->node_count;
  double *u = NULL, most[BATCH];
  int32_t where[BATCH];
  pushed forces = {0};
  int count = states->count;
  if (count == 0)
    return BW_OK;
  double *time = BW_NEW(context, double, drop->sample_count + count);
  double *largest = BW_NEW(context, double, drop->sample_count + count);
  u = BW_NEW(context, double, BATCH *size);
  BW_TRY_MEMORY(time && largest && u);
  BW_TRY(pushed_create(context, run, states, &forces));
  for (int first = 0; first < count; first += BATCH) {
    BW_TRY(bw_check_cancel(context));
    BW_TRY(displacements(context, run, states, first, &forces, u));
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
  if (run->options.history)
    BW_TRY(keep(context, run, states));
done:
  bw_free(time);
  bw_free(largest);
  bw_free(u);
  pushed_clear(&forces);
  return status;
}
