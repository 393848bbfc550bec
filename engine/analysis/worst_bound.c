/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Branch and bound for the largest principal stress over all admissible pressures, elements and
 * directions (docs/theory/worst_case.md, "The upper bound").
 *
 * The mean stress of an element is a linear function of the pressure (worst_response.c). The
 * directions are covered by spherical triangles. A triangle whose points are within the angle delta
 * of its centre n holds no stress larger than max over both signs and all pressures of  s n . sigma
 * n  /  cos(2 delta). That maximum is bounded by a knapsack, with the multipliers of the triangle
 * above; where this does not suffice, the linear program is solved; where that does not suffice,
 * the triangle is divided into four.
 *
 * Every bound is evaluated with multipliers of few digits, which are those of the certificate
 * (worst_leaves.c): any multipliers give a bound.
 *
 * Invariant: the incumbent is the same for all elements of a batch, so that the result does not
 * depend on the number of threads. */
#include "analysis/weak_internal.h"
#include "analysis/worst_internal.h"
#include "barwright/job.h"

#include <math.h>
#include <string.h>

enum { BATCH = 16, HALVINGS = 16, FACES = BWI_HALF_ICOSAHEDRON, MAX_DEPTH = 12 };

/* For the displacements under unit pressures: a quarter of the free memory within these limits. The
 * bound does not depend on it. */
static const double MIN_BYTES = 1 << 29, MAX_BYTES = 4.0 * (1 << 30);

typedef struct found {
  double upper, largest; /* of one element */
  double stress[6];
  int64_t programs;
  bw_bound_leaves leaves;
} found;

typedef struct worker {
  bwi_loads *loads;
  double *response;             /* 6 x pressures */
  double *objective, *pressure; /* pressures */
  double *gain;                 /* pressures and a slack */
} worker;

typedef struct search {
  bw_context *context;
  bw_system *system;
  const bw_pressure_basis *basis;
  const bw_worst_load_options *options;
  double incumbent, tolerance;
  int32_t motions, columns; /* columns: nodes, and a slack where the force may be smaller */
  double *motion;    /* motions x pressures: work of a unit pressure on each rigid-body motion */
  double *projector; /* pressures x motions: the fit's multipliers are projector^T objective */
  double *upper;     /* columns: largest shares of the force */
  found *result;     /* batch */
  worker *worker;
  int workers;
  bwi_triangle face[FACES];
  bwi_responses responses;
  int32_t begin;           /* of the batch, among the elements in order */
  bw_bound_leaves *leaves; /* or NULL */
} search;

/* ---- bounds in one direction ----------------------------------------------------------------- */

/* s n . sigma n of every pressure at full share of it. */
static void objective_of(const search *s, const double *response, const double n[3], double sign,
                         double *objective) {
  size_t count = (size_t)s->basis->count;
  const double t[6] = {sign * n[0] * n[0],     sign * n[1] * n[1],     sign * n[2] * n[2],
                       2 * sign * n[1] * n[2], 2 * sign * n[2] * n[0], 2 * sign * n[0] * n[1]};
  for (size_t j = 0; j < count; j++) {
    double sum = 0;
    for (size_t r = 0; r < 6; r++)
      sum += t[r] * response[r * count + j];
    objective[j] = sum;
  }
}

/* Multipliers of the motions' rows by the least-squares fit, weighted with areas. */
static void fit(const search *s, const double *objective, double *y) {
  size_t count = (size_t)s->basis->count, m = (size_t)s->motions;
  memset(y, 0, m * sizeof *y);
  for (size_t j = 0; j < count; j++)
    for (size_t k = 0; k < m; k++)
      y[k] += s->projector[j * m + k] * objective[j];
}

/* The knapsack of nodes, from the gains of their columns: with friction the largest of a node. `x`
 * becomes the multiplier of the total force. */
static double fill(const search *s, double *gain, double *x) {
  int32_t directions = s->basis->directions, nodes = s->basis->count / directions;
  for (int32_t g = 0; g < nodes; g++) {
    double max = gain[(size_t)g * (size_t)directions];
    for (int32_t k = 1; k < directions; k++)
      max = fmax(max, gain[(size_t)g * (size_t)directions + (size_t)k]);
    gain[g] = max;
  }
  for (int32_t g = nodes; g < s->columns; g++)
    gain[g] = 0; /* the slack */
  *x = bwi_knapsack_multiplier(s->columns, gain, s->upper, HALVINGS);
  bwi_round_multipliers(1, x);
  return bwi_knapsack_value(s->columns, gain, s->upper, *x);
}

/* The bound for multipliers y of the motions; y[motions] becomes that of the total. */
static double knapsack(const search *s, const double *objective, double *y, double *gain) {
  size_t count = (size_t)s->basis->count;
  bwi_round_multipliers(s->motions, y);
  for (size_t j = 0; j < count; j++) {
    double d = objective[j];
    for (int32_t m = 0; m < s->motions; m++)
      d -= y[m] * s->motion[(size_t)m * count + j];
    gain[j] = d * (s->options->force / s->basis->area[j]);
  }
  return fill(s, gain, &y[s->motions]);
}

/* A bound over all directions at once: what a pressure contributes in any direction is at most the
 * norm of its stress, the fit of the balance rows subtracted. `y`: 6 x motions, and the total's. */
static double in_all_directions(const search *s, const double *response, double *y, double *gain) {
  size_t count = (size_t)s->basis->count, m = (size_t)s->motions;
  for (size_t r = 0; r < 6; r++) {
    fit(s, response + r * count, y + r * m);
    bwi_round_multipliers(s->motions, y + r * m);
  }
  for (size_t j = 0; j < count; j++) {
    double sum = 0;
    for (size_t r = 0; r < 6; r++) {
      double d = response[r * count + j];
      for (size_t k = 0; k < m; k++)
        d -= y[r * m + k] * s->motion[k * count + j];
      sum += (r < 3 ? 1 : 2) * d * d;
    }
    gain[j] = sqrt(sum) * (s->options->force / s->basis->area[j]);
  }
  return fill(s, gain, &y[6 * m]);
}

/* What a triangle hands down to its parts: multipliers for both signs. */
typedef struct node {
  bwi_triangle cell;
  int64_t number; /* as in bw_bound_leaves */
  int depth;
  double *y; /* 2 x (motions + 1) */
} node;

/* Bounds of one triangle; false when it must be divided. */
static bool closed(const search *s, worker *w, const double *response, const node *at, double *y,
                   found *out, bw_status *status) {
  size_t count = (size_t)s->basis->count, width = (size_t)s->motions + 1;
  double n[3], cosine = bwi_triangle_centre(&at->cell, n), bound = 0;
  double *former = y + 2 * width; /* scratch */
  for (int sign = 0; sign < 2; sign++) {
    double goal = (1 + s->tolerance) * fmax(s->incumbent, out->largest);
    double *own = y + (size_t)sign * width;
    objective_of(s, response, n, sign ? -1 : 1, w->objective);
    if (at->depth == 0)
      fit(s, w->objective, own);
    else
      memcpy(own, at->y + (size_t)sign * width, width * sizeof *own);
    double max = knapsack(s, w->objective, own, w->gain);
    if (max > goal * cosine) {
      double value, stress[6];
      memcpy(former, own, width * sizeof *own);
      *status = bwi_loads_solve(s->context, w->loads, 1, w->objective, w->pressure, &value, own);
      if (*status != BW_OK)
        return true;
      out->programs++;
      double proved = knapsack(s, w->objective, own, w->gain); /* of the dual: proved again */
      if (proved > max)
        memcpy(own, former, width * sizeof *own);
      max = fmin(max, proved);
      for (size_t r = 0; r < 6; r++) {
        stress[r] = 0;
        for (size_t j = 0; j < count; j++)
          stress[r] += response[r * count + j] * w->pressure[j];
      }
      if (bwi_largest_principal(stress) > out->largest) {
        out->largest = bwi_largest_principal(stress);
        memcpy(out->stress, stress, sizeof stress);
      }
    }
    bound = fmax(bound, max);
  }
  if (bound > (1 + s->tolerance) * fmax(s->incumbent, out->largest) * cosine &&
      at->depth < MAX_DEPTH)
    return false;
  out->upper = fmax(out->upper, bound / cosine);
  if (s->leaves)
    *status = bwi_keep_leaf(s->context, &out->leaves, at->number, bound / cosine, s->motions, y);
  return true;
}

static bw_status bound_element(const search *s, worker *w, const double *response, found *out) {
  bw_status status = BW_OK;
  bw_context *context = s->context;
  size_t width = 2 * ((size_t)s->motions + 1), count = 0, capacity = 0;
  node *stack = NULL;
  /* Own multipliers, by depth, and scratch behind the last. */
  double *y = BW_NEW0(context, double, width *(MAX_DEPTH + 5));
  if (!y)
    return BW_MEMORY;
  out->upper = in_all_directions(s, response, y, w->gain);
  if (out->upper <= (1 + s->tolerance) * s->incumbent) {
    if (s->leaves)
      status = bwi_keep_leaf(context, &out->leaves, 0, out->upper, s->motions, y);
    goto done;
  }
  out->upper = 0;
  for (int f = FACES - 1; f >= 0; f--) {
    BW_TRY_MEMORY(bw_grow(context, (void **)&stack, &capacity, count, 1, sizeof *stack));
    stack[count++] = (node){s->face[f], BW_FIRST_FACE + f, 0, NULL};
  }
  while (count > 0) {
    node at = stack[--count];
    double *own = y + (size_t)(at.depth + 1) * width;
    /* The parts of a triangle are visited before its neighbours: depth tells whose multipliers
     * hold. */
    at.y = y + (size_t)at.depth * width;
    bool done = closed(s, w, response, &at, own, out, &status);
    if (status != BW_OK)
      goto done;
    if (done)
      continue;
    bwi_triangle part[4];
    bwi_divide_triangle(&at.cell, part);
    BW_TRY_MEMORY(bw_grow(context, (void **)&stack, &capacity, count, 4, sizeof *stack));
    for (int k = 0; k < 4; k++)
      stack[count++] = (node){part[k], 4 * at.number + k, at.depth + 1, NULL};
  }
done:
  bw_free(y);
  bw_free(stack);
  return status;
}

/* ---- batches of elements --------------------------------------------------------------------- */

static bw_status element_body(void *data, int64_t begin, int64_t end, int number) {
  const search *s = (const search *)data;
  worker *w = &s->worker[number];
  bw_status status = BW_OK;
  for (int64_t i = begin; i < end; i++) {
    found *result = &s->result[i];
    bwi_response_of(&s->responses, s->responses.order[s->begin + i], w->response);
    bw_bound_leaves kept = result->leaves;
    *result = (found){.leaves = kept};
    result->leaves.count = result->leaves.number_count = 0;
    BW_TRY(bound_element(s, w, w->response, result));
  }
done:
  return status;
}

static bw_status bound_batch(search *s, int32_t count, bw_worst_bound *bound) {
  bw_status status = BW_OK;
  BW_TRY(bw_parallel(s->context, count, 1, element_body, s));
  for (int32_t i = 0; i < count; i++) {
    const found *f = &s->result[i];
    int32_t element = s->responses.order[s->begin + i];
    bound->upper = fmax(bound->upper, f->upper);
    bound->linear_programs += f->programs;
    if (f->largest > bound->largest) {
      bound->largest = f->largest;
      bound->element = element;
      memcpy(bound->stress, f->stress, sizeof f->stress);
    }
    if (s->leaves)
      BW_TRY(bwi_append_leaves(s->context, s->leaves, element, &f->leaves));
  }
  s->incumbent = bound->largest;
done:
  return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static bw_status prepare_rows(search *s) {
  bw_context *context = s->context;
  bw_status status = BW_OK;
  size_t count = (size_t)s->basis->count, m = (size_t)s->motions;
  double *gram = BW_NEW0(context, double, m *m + 1);
  int32_t *pivot = BW_NEW(context, int32_t, m + 1);
  s->motion = BW_NEW(context, double, m *count + 1);
  s->projector = BW_NEW0(context, double, m *count + 1);
  BW_TRY_MEMORY(gram && pivot && s->motion && s->projector);
  bwi_column_motions(s->basis, s->system->dof_map, s->motion);
  for (size_t a = 0; a < m; a++)
    for (size_t b = 0; b < m; b++)
      for (size_t j = 0; j < count; j++)
        gram[a * m + b] += s->motion[a * count + j] * s->motion[b * count + j] / s->basis->area[j];
  /* Dependent rows (a ball's moments) have no fit: zero multipliers give a bound as well. */
  if (m == 0 || !bwi_dense_factor(s->motions, gram, pivot))
    goto done;
  for (size_t j = 0; j < count; j++) {
    double *right = s->projector + j * m;
    for (size_t a = 0; a < m; a++)
      right[a] = s->motion[a * count + j] / s->basis->area[j];
    bwi_dense_solve(s->motions, gram, pivot, right);
  }
done:
  bw_free(gram);
  bw_free(pivot);
  return status;
}

static bw_status prepare_workers(search *s) {
  bw_context *context = s->context;
  bw_status status = BW_OK;
  size_t count = (size_t)s->basis->count;
  s->workers = bw_threads(context);
  s->worker = BW_NEW0(context, worker, s->workers);
  if (!s->worker)
    return BW_MEMORY;
  for (int i = 0; i < s->workers; i++) {
    worker *w = &s->worker[i];
    BW_TRY(bwi_loads_create(context, s->basis, s->system->dof_map, s->options, &w->loads));
    w->response = BW_NEW(context, double, 6 * count);
    w->objective = BW_NEW(context, double, count);
    w->pressure = BW_NEW(context, double, count);
    w->gain = BW_NEW(context, double, count + 1);
    BW_TRY_MEMORY(w->response && w->objective && w->pressure && w->gain);
  }
done:
  return status;
}

static void search_clear(search *s) {
  for (int i = 0; s->worker && i < s->workers; i++) {
    bwi_loads_destroy(s->worker[i].loads);
    bw_free(s->worker[i].response);
    bw_free(s->worker[i].objective);
    bw_free(s->worker[i].pressure);
    bw_free(s->worker[i].gain);
  }
  bw_free(s->worker);
  bw_free(s->motion);
  bw_free(s->projector);
  bw_free(s->upper);
  bwi_responses_close(&s->responses);
  for (int i = 0; s->result && i < BATCH; i++)
    bw_bound_leaves_clear(&s->result[i].leaves);
  bw_free(s->result);
}

bw_status bw_worst_bound_find(bw_context *context, bw_system *system,
                              const bw_pressure_basis *basis, const bw_worst_load_options *options,
                              double incumbent, double tolerance, bw_worst_bound *bound,
                              bw_bound_leaves *leaves) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = system->mesh;
  bw_worst_load_options anywhere = *options;
  anywhere.hands = 0; /* what pressures anywhere do bounds what hands do */
  search s = {.context = context,
              .system = system,
              .basis = basis,
              .options = &anywhere,
              .incumbent = incumbent,
              .tolerance = tolerance,
              .leaves = leaves,
              .motions = system->dof_map->rigid_mode_count,
              .columns = basis->count / basis->directions + (options->force_is_max ? 1 : 0)};
  *bound = (bw_worst_bound){.largest = incumbent, .element = -1};
  if (basis->mesh->node_count != mesh->node_count)
    return bw_fail(context, BW_INVALID,
                   "pressures of %d nodes for a system of %d nodes: they must be of the same mesh",
                   basis->mesh->node_count, mesh->node_count);
  if (!(incumbent >= 0) || isinf(incumbent))
    return bw_fail(context, BW_INVALID, "the stress known to be reached is %g Pa", incumbent);
  if (!(tolerance >= 0.001 && tolerance <= 0.5))
    return bw_fail(context, BW_INVALID, "the tolerance of the bound is %g: give from 0.001 to 0.5",
                   tolerance);
  bwi_half_icosahedron(s.face);
  BW_TRY(prepare_workers(&s));
  BW_TRY(prepare_rows(&s));
  s.upper = BW_NEW(context, double, s.columns);
  s.result = BW_NEW0(context, found, BATCH);
  BW_TRY_MEMORY(s.upper && s.result);
  for (int32_t g = 0; g < s.columns; g++)
    s.upper[g] = g < basis->count / basis->directions
                     ? basis->area[(size_t)g * (size_t)basis->directions] *
                           (options->pressure / options->force)
                     : 1; /* the slack */
  double available = fmax(MIN_BYTES, fmin(MAX_BYTES, bw_available_memory() / 4));
  BW_TRY(bwi_responses_open(context, system, basis, (size_t)available, &s.responses));
  BW_TRY(bwi_responses_next(&s.responses, BATCH));
  while (s.responses.count > 0) {
    int32_t end = s.responses.first + s.responses.count;
    for (s.begin = s.responses.first; s.begin < end; s.begin += BATCH) {
      bw_progress(context, "upper bound", (double)s.begin / mesh->element_count);
      BW_TRY(bw_check_cancel(context));
      BW_TRY(bound_batch(&s, end - s.begin < BATCH ? end - s.begin : BATCH, bound));
    }
    BW_TRY(bwi_responses_next(&s.responses, BATCH));
  }
  bound->upper = fmax(bound->upper, bound->largest);
  bw_progress(context, "upper bound", 1);
  bwi_lp_counts counts = {0};
  for (int i = 0; i < s.workers; i++)
    bwi_loads_count(s.worker[i].loads, &counts);
  bwi_loads_report(s.worker[0].loads, &counts, &bound->report);
done:
  search_clear(&s);
  return status;
}
