/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Screening of all targets with a coarse pressure (docs/theory/worst_case.md, "The search").
 * Targets are elements, or patches of the boundary (screening_targets.h).
 *
 * K patches of pressure, one solve each: then the stress of any target under any pressure that is
 * constant on patches is a product with a 6 x K matrix. Combinations of the balance rows are
 * subtracted from the responses (a least-squares fit): no balanced load sees the difference.
 * Without the balance rows the linear program is a knapsack, which gives every target a bound. The
 * targets of the largest bounds get exact linear programs in the K pressures, followed by an ascent
 * of the principal stress.
 *
 * Invariants: `response` holds K numbers for a degree of freedom, its displacement under a unit
 * share of the total force on each patch, less the fit; what follows is by target and does not
 * depend on the number of threads. */
#include "analysis/screening_targets.h"
#include "analysis/surface_stress.h"
#include "analysis/weak_internal.h"
#include "analysis/worst_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SOLVES = 16, TARGETS_PER_CHUNK = 64, ROWS_PER_CHUNK = 64, ASCENT_STEPS = 3, HALVINGS = 12 };
/* So many that balance leaves a choice. */
enum { PATCHES_PER_ROW = 4 };

typedef struct ranked {
  double bound;
  int32_t target;
} ranked;

typedef struct screen {
  bw_context *context;
  bw_system *system;
  const bw_worst_load_options *options;
  bw_pressure_basis *coarse;
  bwi_load_program *program;
  int32_t patches;
  double *response;  /* 3 node_count x patches */
  double *traction;  /* 3 facet_count x patches; NULL where elements are targets */
  double *row;       /* balance rows x patches: entries of the linear program by patch */
  double *projector; /* patches x balance rows: the multipliers of the fit of c are projector^T c */
  double *upper;     /* patches */
  double *scratch;   /* threads x 8 x patches, or x rows where these are more */
  bwi_targets targets;
  int32_t *list; /* targets by descending bound, then those that get linear programs */
  int32_t wanted;
  ranked *rank;      /* targets */
  double *direction; /* targets x 6: tensor of the first direction */
  double *objective; /* wanted x patches */
  double *pressure;  /* wanted x patches */
  double *value;     /* wanted */
  double *stress;    /* wanted x 6: best so far */
  int step;
} screen;

void bw_screening_clear(bw_screening *screening) {
  bw_free(screening->target);
  bw_free(screening->stress);
  memset(screening, 0, sizeof *screening);
}

/* ---- the response to each patch ------------------------------------------------------------ */

/* Traction on each facet of patch `k` of pressure, by the forces of a unit share of the total. */
static void keep_traction(screen *s, const double *area, const double *force, size_t k) {
  const bw_mesh *mesh = s->system->mesh;
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    double t[3];
    bwi_facet_traction(mesh, area, force, f, t);
    for (size_t c = 0; c < 3; c++)
      s->traction[(3 * (size_t)f + c) * (size_t)s->patches + k] =
          t[c] * (s->options->force / s->coarse->area[k]);
  }
}

static bw_status solve_patches(screen *s, bool on_surface) {
  bw_status status = BW_OK;
  double *area = NULL;
  bw_context *context = s->context;
  size_t n = 3 * (size_t)s->system->mesh->node_count, k = (size_t)s->patches;
  double *block = BW_NEW(context, double, SOLVES *n), *unit = BW_NEW0(context, double, k);
  s->response = BW_NEW(context, double, n *k);
  if (on_surface)
    s->traction = BW_NEW(context, double, 3 * (size_t)s->system->mesh->facet_count * k);
  BW_TRY_MEMORY(block && unit && s->response && (!on_surface || s->traction));
  if (on_surface)
    BW_TRY(bwi_facet_areas_around(context, s->system->mesh, &area));
  for (int32_t first = 0; first < s->patches; first += SOLVES) {
    int32_t count = s->patches - first < SOLVES ? s->patches - first : SOLVES;
    bw_progress(context, "screening", (double)first / s->patches);
    BW_TRY(bw_check_cancel(context));
    for (int32_t i = 0; i < count; i++) {
      unit[first + i] = 1;
      bw_pressure_force(s->coarse, unit, block + (size_t)i * n);
      unit[first + i] = 0;
      if (on_surface)
        keep_traction(s, area, block + (size_t)i * n, (size_t)(first + i));
    }
    BW_TRY(bw_system_solve(context, s->system, count, block, block));
    for (size_t j = 0; j < n; j++)
      for (int32_t i = 0; i < count; i++)
        s->response[j * k + (size_t)(first + i)] =
            block[(size_t)i * n + j] * (s->options->force / s->coarse->area[first + i]);
  }
  bw_progress(context, "screening", 1);
done:
  bw_free(area);
  bw_free(block);
  bw_free(unit);
  return status;
}

/* ---- the bound ----------------------------------------------------------------------------- */

static bw_status fit_body(void *data, int64_t begin, int64_t end, int worker) {
  const screen *s = (const screen *)data;
  size_t k = (size_t)s->patches, m = (size_t)s->program->lp.rows - 1;
  double *y = s->scratch + (size_t)worker * (8 * k > m ? 8 * k : m + 1);
  for (int64_t i = begin; i < end; i++) {
    double *c = s->response + (size_t)i * k;
    memset(y, 0, m * sizeof *y);
    for (size_t j = 0; j < k; j++)
      for (size_t a = 0; a < m; a++)
        y[a] += s->projector[j * m + a] * c[j];
    for (size_t a = 0; a < m; a++)
      for (size_t j = 0; j < k; j++)
        c[j] -= y[a] * s->row[a * k + j];
  }
  return BW_OK;
}

/* Subtract the fit y^T R, y = (R W R^T)^-1 R W c with the patches' areas as W, from every row. */
static bw_status subtract_fit(screen *s) {
  bw_status status = BW_OK;
  bw_context *context = s->context;
  const bwi_load_program *program = s->program;
  const bwi_linear_program *p = &program->lp;
  size_t m = (size_t)p->rows - 1, k = (size_t)s->patches;
  double *gram = BW_NEW0(context, double, m *m + 1);
  int32_t *pivot = BW_NEW(context, int32_t, m + 1);
  s->row = BW_NEW0(context, double, m *k + 1);
  s->projector = BW_NEW0(context, double, m *k + 1);
  s->upper = BW_NEW(context, double, k);
  BW_TRY_MEMORY(gram && pivot && s->row && s->projector && s->upper);
  for (int32_t j = 0; j < p->columns; j++) {
    int32_t from = program->source[j];
    if (from < 0)
      continue;
    s->upper[from] = p->upper[j];
    for (int32_t l = 0; l < p->row_count[j]; l++)
      s->row[(size_t)(p->first_row[j] + l) * k + (size_t)from] =
          p->entry[(size_t)l * (size_t)p->columns + (size_t)j];
  }
  for (size_t a = 0; a < m; a++)
    for (size_t b = 0; b < m; b++)
      for (size_t j = 0; j < k; j++)
        gram[a * m + b] += s->coarse->area[j] * s->row[a * k + j] * s->row[b * k + j];
  /* Fewer patches than rows have no fit; any multipliers give a bound, zero ones too. */
  if (m == 0 || m > k || !bwi_dense_factor((int32_t)m, gram, pivot))
    goto done;
  for (size_t j = 0; j < k; j++) {
    double *right = s->projector + j * m;
    for (size_t a = 0; a < m; a++)
      right[a] = s->coarse->area[j] * s->row[a * k + j];
    bwi_dense_solve((int32_t)m, gram, pivot, right);
  }
  BW_TRY(
      bw_parallel(context, 3 * (int64_t)s->system->mesh->node_count, ROWS_PER_CHUNK, fit_body, s));
done:
  bw_free(gram);
  bw_free(pivot);
  return status;
}

/* T : sigma by patch. */
static void normal_stress(const screen *s, const double *response, const double t[6], double *d) {
  size_t k = (size_t)s->patches;
  for (size_t j = 0; j < k; j++) {
    double c[6];
    for (size_t r = 0; r < 6; r++)
      c[r] = response[r * k + j];
    d[j] = bwi_dot_tensor(t, c);
  }
}

/* The tensor T = n n^T whose n is the direction of the largest mean square of stress vectors over
 * the patches. */
static void first_direction(const screen *s, const double *response, double t[6]) {
  size_t k = (size_t)s->patches;
  double square[6] = {0};
  for (size_t j = 0; j < k; j++) {
    double a = s->coarse->area[j], c[6];
    for (size_t r = 0; r < 6; r++)
      c[r] = response[r * k + j];
    square[0] += a * (c[0] * c[0] + c[5] * c[5] + c[4] * c[4]);
    square[1] += a * (c[5] * c[5] + c[1] * c[1] + c[3] * c[3]);
    square[2] += a * (c[4] * c[4] + c[3] * c[3] + c[2] * c[2]);
    square[3] += a * (c[5] * c[4] + c[1] * c[3] + c[3] * c[2]);
    square[4] += a * (c[0] * c[4] + c[5] * c[3] + c[4] * c[2]);
    square[5] += a * (c[0] * c[5] + c[5] * c[1] + c[4] * c[3]);
  }
  bwi_directed_weight(square, 1, t);
}

static bw_status rank_body(void *data, int64_t begin, int64_t end, int worker) {
  screen *s = (screen *)data;
  size_t k = (size_t)s->patches;
  double *response = s->scratch + (size_t)worker * 8 * k, *d = response + 6 * k, *negative = d + k;
  for (int64_t e = begin; e < end; e++) {
    double *t = s->direction + 6 * e;
    bwi_target_stress(&s->targets, (int32_t)e, worker, response);
    first_direction(s, response, t);
    normal_stress(s, response, t, d);
    for (size_t j = 0; j < k; j++)
      negative[j] = -d[j];
    double up = bwi_knapsack(s->patches, d, s->upper, HALVINGS);
    double down = bwi_knapsack(s->patches, negative, s->upper, HALVINGS);
    s->rank[e] = (ranked){fmax(up, down), (int32_t)e};
    for (int r = 0; r < 6 && down > up; r++)
      t[r] = -t[r];
  }
  return BW_OK;
}

static int by_bound(const void *a, const void *b) {
  const ranked *x = (const ranked *)a, *y = (const ranked *)b;
  if (x->bound != y->bound)
    return x->bound > y->bound ? -1 : 1;
  return (x->target > y->target) - (x->target < y->target);
}

/* ---- linear programs in the patches' pressures ----------------------------------------------- */

/* Step 0: the first direction, with the sign of the larger bound; then that of the best stress. */
static bw_status objective_body(void *data, int64_t begin, int64_t end, int worker) {
  screen *s = (screen *)data;
  size_t k = (size_t)s->patches;
  double *response = s->scratch + (size_t)worker * 8 * k;
  for (int64_t i = begin; i < end; i++) {
    double t[6], *f = s->objective + (size_t)i * k;
    bwi_target_stress(&s->targets, s->list[i], worker, response);
    if (s->step == 0)
      memcpy(t, s->direction + 6 * (size_t)s->list[i], sizeof t);
    else
      bwi_directed_weight(s->stress + 6 * i, 1, t);
    normal_stress(s, response, t, f);
    for (size_t j = 0; j < k; j++)
      f[j] *= s->coarse->area[j] / s->options->force;
  }
  return BW_OK;
}

static bw_status stress_body(void *data, int64_t begin, int64_t end, int worker) {
  screen *s = (screen *)data;
  size_t k = (size_t)s->patches;
  double *response = s->scratch + (size_t)worker * 8 * k;
  for (int64_t i = begin; i < end; i++) {
    const double *p = s->pressure + (size_t)i * k;
    double found[6];
    bwi_target_stress(&s->targets, s->list[i], worker, response);
    for (size_t r = 0; r < 6; r++) {
      double sum = 0;
      for (size_t j = 0; j < k; j++)
        sum += response[r * k + j] * (p[j] * s->coarse->area[j] / s->options->force);
      found[r] = sum;
    }
    if (bwi_largest_principal(found) > bwi_largest_principal(s->stress + 6 * i))
      memcpy(s->stress + 6 * i, found, sizeof found);
  }
  return BW_OK;
}

static bw_status solve_linear_programs(screen *s, bw_solver_report *report) {
  bw_status status = BW_OK;
  bw_context *context = s->context;
  bwi_loads *loads = NULL;
  size_t capacity = (size_t)s->wanted * (size_t)s->patches;
  s->objective = BW_NEW(context, double, capacity);
  s->pressure = BW_NEW(context, double, capacity);
  s->value = BW_NEW(context, double, s->wanted);
  s->stress = BW_NEW0(context, double, 6 * (size_t)s->wanted);
  BW_TRY_MEMORY(s->objective && s->pressure && s->value && s->stress);
  BW_TRY(bwi_loads_create(context, s->coarse, s->system->dof_map, s->options, &loads));
  for (s->step = 0; s->step <= ASCENT_STEPS; s->step++) {
    BW_TRY(bw_parallel(context, s->wanted, 8, objective_body, s));
    BW_TRY(bwi_loads_solve(context, loads, s->wanted, s->objective, s->pressure, s->value, NULL));
    BW_TRY(bw_parallel(context, s->wanted, 8, stress_body, s));
  }
  bwi_loads_report(loads, NULL, report);
done:
  bwi_loads_destroy(loads);
  return status;
}

/* ---- the whole ----------------------------------------------------------------------------- */

static bw_status hand_over(const screen *s, bw_screening *out) {
  bw_context *context = s->context;
  bw_status status = BW_OK;
  ranked *order = BW_NEW(context, ranked, s->wanted);
  out->target = BW_NEW(context, int32_t, s->wanted);
  out->stress = BW_NEW(context, double, 6 * (size_t)s->wanted);
  BW_TRY_MEMORY(order && out->target && out->stress);
  for (int32_t i = 0; i < s->wanted; i++)
    order[i] = (ranked){bwi_largest_principal(s->stress + 6 * (size_t)i), i};
  qsort(order, (size_t)s->wanted, sizeof *order, by_bound);
  for (int32_t i = 0; i < s->wanted && order[i].bound > 0; i++) {
    int32_t from = order[i].target, target = s->list[from];
    out->target[i] = s->targets.node ? s->targets.node[target] : target;
    memcpy(out->stress + 6 * (size_t)i, s->stress + 6 * (size_t)from, 6 * sizeof(double));
    out->count++;
  }
done:
  bw_free(order);
  return status;
}

bw_status bw_worst_screening(bw_context *context, bw_system *system, const bw_pressure_basis *basis,
                             const bw_worst_load_options *options, int32_t patches, double radius,
                             int32_t wanted, bw_screening *screening) {
  bw_status status = BW_OK;
  bw_worst_load_options limits = *options;
  screen s = {.context = context, .system = system, .options = &limits};
  memset(screening, 0, sizeof *screening);
  if (basis->mesh->node_count != system->mesh->node_count)
    return bw_fail(context, BW_INVALID,
                   "pressures of %d nodes for a system of %d nodes: they must be of the same mesh",
                   basis->mesh->node_count, system->mesh->node_count);
  if (patches < 1 || wanted < 1)
    return bw_fail(context, BW_INVALID,
                   "a screening of %d targets with %d patches: both must be positive", wanted,
                   patches);
  /* Pressures by patch may miss the balance that pressures by node reach. */
  limits.force_is_max = options->force_is_max || !basis->complete;
  limits.hands = 0; /* the screening ranks targets by what pressures anywhere do */
  int32_t fewest = PATCHES_PER_ROW * (system->dof_map->rigid_mode_count + 1);
  BW_TRY(bwi_pressure_patches(context, basis, patches > fewest ? patches : fewest, &s.coarse));
  s.patches = s.coarse->count;
  BW_TRY(bwi_load_program_create(context, s.coarse, system->dof_map, options, &s.program));
  size_t capacity = 8 * (size_t)s.patches, rows = (size_t)s.program->lp.rows;
  s.scratch =
      BW_NEW(context, double, (size_t)bw_threads(context) * (capacity > rows ? capacity : rows));
  BW_TRY_MEMORY(s.scratch);
  BW_TRY(solve_patches(&s, radius > 0));
  BW_TRY(subtract_fit(&s));
  BW_TRY(bwi_targets_begin(context, system->mesh, system->material, system->dof_map, s.patches,
                           s.response, s.traction, radius, &s.targets));
  s.rank = BW_NEW(context, ranked, s.targets.count);
  s.list = BW_NEW(context, int32_t, s.targets.count);
  s.direction = BW_NEW(context, double, 6 * (size_t)s.targets.count);
  BW_TRY_MEMORY(s.rank && s.list && s.direction);
  BW_TRY(bw_parallel(context, s.targets.count, TARGETS_PER_CHUNK, rank_body, &s));
  qsort(s.rank, (size_t)s.targets.count, sizeof *s.rank, by_bound);
  for (int32_t i = 0; i < s.targets.count; i++)
    s.list[i] = s.rank[i].target;
  s.wanted = bwi_targets_apart(&s.targets, wanted, s.list);
  BW_TRY(solve_linear_programs(&s, &screening->report));
  BW_TRY(hand_over(&s, screening));
done:
  if (status != BW_OK)
    bw_screening_clear(screening);
  bw_release(s.coarse);
  bwi_load_program_destroy(s.program);
  bw_free(s.response);
  bw_free(s.traction);
  bw_free(s.row);
  bw_free(s.projector);
  bw_free(s.upper);
  bw_free(s.scratch);
  bw_free(s.rank);
  bw_free(s.list);
  bwi_targets_clear(&s.targets);
  bw_free(s.direction);
  bw_free(s.objective);
  bw_free(s.pressure);
  bw_free(s.value);
  bw_free(s.stress);
  return status;
}
