/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Energy of a solid, its gradient and its second derivatives.
 *
 * Elements are computed window by window, into a ring that holds no more of them than the nodes
 * still to be gathered need; after each window the nodes all of whose elements are done sum what
 * these hold, in ascending order of elements. So the element stiffnesses of a large solid pass
 * through the cache instead of memory, and no number depends on the threads. */
#include "nonlinear/internal.h"

/* Contributions are asked for so many ahead: the ring is larger than the near caches. */
enum { ELEMENTS_PER_CHUNK = 32, ROWS_PER_CHUNK = 64, WINDOW = 1024, AHEAD = 24 };

typedef struct data {
  const bw_solid *solid;
  const double *u;
  bool project;
  bwi_want want;
  bwi_hexahedron_state *state; /* by element */
  int64_t ring;                /* elements that fit; element e lies at e modulo ring: */
  int64_t pivot;               /* the last multiple of ring among the elements so far */
  double *force, *matrix;      /* ring x 24, ring x 300, or NULL */
  double *gradient, *stiffness;
  int64_t end;   /* of the elements so far */
  int64_t first; /* element or node that item 0 of the loop is */
} data;

/* Of an element that the ring holds now. */
static inline int64_t slot_of(const data *d, int64_t element) {
  return element - d->pivot + (element < d->pivot ? d->ring : 0);
}

static bw_status elements(void *of, int64_t begin, int64_t end, int worker) {
  const data *d = (const data *)of;
  (void)worker;
  for (int64_t e = d->first + begin; e < d->first + end; e++) {
    int64_t slot = slot_of(d, e);
    bwi_element_evaluate(d->solid, (int32_t)e, d->u, d->want, d->project, &d->state[e],
                         d->force ? d->force + BWI_ELEMENT_FORCES * slot : NULL,
                         d->matrix ? d->matrix + BWI_ELEMENT_NUMBERS * slot : NULL);
  }
  return BW_OK;
}

/* Where the k-th contribution of the pattern lies. */
static inline const double *block_of(const data *d, int64_t k) {
  const bwi_contributions *list = d->solid->contributions;
  int code = list->local[k];
  return d->matrix + BWI_ELEMENT_NUMBERS * slot_of(d, list->element[k]) +
         bwi_element_block(code >> 4, code & 15);
}

static inline void gather_block(const data *d, int64_t index, double *block) {
  const bwi_contributions *list = d->solid->contributions;
  bwi_lanes sum = {0}, part;
  double last = 0;
  for (int64_t k = list->start[index]; k < list->start[index + 1]; k++) {
    const double *from = block_of(d, k);
    if (k + AHEAD < list->count && list->element[k + AHEAD] < d->end) {
      const double *next = block_of(d, k + AHEAD);
      __builtin_prefetch(next);
      __builtin_prefetch(next + 8);
    }
    memcpy(&part, from, sizeof part);
    sum += part;
    last += from[8];
  }
  memcpy(block, &sum, sizeof sum);
  block[8] = last;
}

static bw_status rows(void *of, int64_t begin, int64_t end, int worker) {
  const data *d = (const data *)of;
  const bw_block_pattern *pattern = d->solid->pattern;
  const bwi_contributions *list = d->solid->contributions;
  (void)worker;
  for (int64_t i = d->first + begin; i < d->first + end; i++) {
    int64_t diagonal = pattern->start[i + 1] - 1;
    double force[3] = {0}, six[6] = {0};
    for (int64_t k = list->start[diagonal]; k < list->start[diagonal + 1]; k++) {
      int64_t slot = slot_of(d, list->element[k]);
      int a = list->local[k] >> 4;
      for (int r = 0; r < 3 && d->force; r++)
        force[r] += d->force[BWI_ELEMENT_FORCES * slot + 3 * a + r];
      for (int r = 0; r < 6 && d->matrix; r++)
        six[r] += d->matrix[BWI_ELEMENT_NUMBERS * slot + bwi_element_block(a, a) + r];
    }
    if (d->gradient)
      memcpy(d->gradient + 3 * i, force, sizeof force);
    if (!d->stiffness)
      continue;
    for (int64_t index = pattern->start[i]; index < diagonal; index++)
      gather_block(d, index, d->stiffness + 9 * index);
    double full[9] = {six[0], six[1], six[2], six[1], six[3], six[4], six[2], six[4], six[5]};
    memcpy(d->stiffness + 9 * diagonal, full, sizeof full);
  }
  return BW_OK;
}

/* First and last element around a node. */
static inline int32_t first_of(const bw_solid *solid, int64_t node) {
  const bwi_contributions *list = solid->contributions;
  return list->element[list->start[solid->pattern->start[node + 1] - 1]];
}
static inline int32_t last_of(const bw_solid *solid, int64_t node) {
  const bwi_contributions *list = solid->contributions;
  return list->element[list->start[solid->pattern->start[node + 1]] - 1];
}

/* When which nodes are gathered, and how many elements the ring must hold meanwhile. */
typedef struct schedule {
  int64_t windows, ring;
  int64_t *ready; /* windows: the nodes before it have all their elements in windows up to this */
} schedule;

/* The ring reaches from the first element that a node not yet gathered needs to the end of the
 * window that is being computed. */
static bw_status plan(bw_context *context, const bw_solid *solid, schedule *it) {
  const bw_block_pattern *pattern = solid->pattern;
  int64_t nodes = pattern->node_count, elements_all = solid->grid->element_count;
  int32_t *oldest = BW_NEW(context, int32_t, nodes + 1); /* element needed by nodes from here on */
  it->windows = (elements_all + WINDOW - 1) / WINDOW;
  it->ready = BW_NEW(context, int64_t, it->windows);
  it->ring = 1;
  if (!oldest || !it->ready) {
    bw_free(oldest);
    return BW_MEMORY;
  }
  oldest[nodes] = (int32_t)elements_all;
  for (int64_t n = nodes - 1; n >= 0; n--)
    oldest[n] = first_of(solid, n) < oldest[n + 1] ? first_of(solid, n) : oldest[n + 1];
  int64_t node = 0;
  for (int64_t w = 0; w < it->windows; w++) {
    int64_t end = w + 1 < it->windows ? (w + 1) * WINDOW : elements_all;
    if (end - oldest[node] > it->ring)
      it->ring = end - oldest[node];
    while (node < nodes && last_of(solid, node) < end)
      node++;
    it->ready[w] = node;
  }
  bw_free(oldest);
  return BW_OK;
}

/* All elements, and with gradient or stiffness the rows that they complete. */
static bw_status run(bw_context *context, data *d, const schedule *it) {
  bw_status status = BW_OK;
  int64_t count = d->solid->grid->element_count, node = 0;
  if (d->want == BWI_ENERGY)
    return bw_parallel(context, count, ELEMENTS_PER_CHUNK, elements, d);
  for (int64_t w = 0; w < it->windows; w++) {
    int64_t begin = w * WINDOW, end = begin + WINDOW < count ? begin + WINDOW : count;
    d->first = begin;
    d->end = end;
    d->pivot = (end - 1) / d->ring * d->ring;
    BW_TRY(bw_parallel(context, end - begin, ELEMENTS_PER_CHUNK, elements, d));
    d->first = node;
    BW_TRY(bw_parallel(context, it->ready[w] - node, ROWS_PER_CHUNK, rows, d));
    node = it->ready[w];
    BW_TRY(bw_check_cancel(context));
  }
done:
  return status;
}

/* The sum of the energies, and the worst shape, in the order of the elements. */
static double sum_up(const bw_solid *solid, const bwi_hexahedron_state *state,
                     bw_solid_shape *shape) {
  double sum = 0;
  *shape = (bw_solid_shape){.min_ratio = INFINITY, .defined = true};
  for (int32_t e = 0; e < solid->grid->element_count; e++) {
    sum += state[e].energy;
    shape->inverted += !(state[e].ratio > 0);
    shape->defined = shape->defined && state[e].defined;
    if (!(state[e].ratio >= shape->min_ratio) && !isnan(shape->min_ratio)) {
      shape->min_ratio = state[e].ratio;
      shape->worst = e;
    }
  }
  shape->defined = shape->defined && isfinite(sum);
  return sum;
}

bw_status bw_solid_evaluate(bw_context *context, const bw_solid *solid, const double *u,
                            bool project, double *energy, double *gradient, double *stiffness,
                            bw_solid_shape *shape) {
  bw_status status = BW_OK;
  schedule it = {0};
  data d = {.solid = solid,
            .u = u,
            .project = project,
            .want = stiffness  ? BWI_TANGENT
                    : gradient ? BWI_STRESS
                               : BWI_ENERGY,
            .gradient = gradient,
            .stiffness = stiffness,
            .ring = 1};
  d.state = BW_NEW(context, bwi_hexahedron_state, solid->grid->element_count);
  BW_TRY_MEMORY(d.state);
  if (d.want > BWI_ENERGY) {
    BW_TRY(plan(context, solid, &it));
    d.ring = it.ring;
    d.force = BW_NEW(context, double, BWI_ELEMENT_FORCES *it.ring);
    d.matrix = stiffness ? BW_NEW(context, double, BWI_ELEMENT_NUMBERS *it.ring) : NULL;
    BW_TRY_MEMORY(d.force && (!stiffness || d.matrix));
  }
  BW_TRY(run(context, &d, &it));
  double sum = sum_up(solid, d.state, shape);
  if (energy && shape->defined)
    *energy = sum;
done:
  bw_free(it.ready);
  bw_free(d.state);
  bw_free(d.force);
  bw_free(d.matrix);
  return status;
}
