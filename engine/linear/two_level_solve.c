/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conjugate gradients with the two-level preconditioner (two_level.h), for one right-hand side or
 * up to eight side by side, each with its own coefficients.
 *
 * The equations are taken times a power of two for the matrix and one for each right-hand side, so
 * that floats hold what the preconditioner works on. The next direction is made conjugate to the
 * last one by the product at hand (Polak and Ribiere): the preconditioner, in floats, is not quite
 * symmetric.
 *
 * A right-hand side is done as in pcg.c: when its error in energy is below the tolerance, and
 * so is its residual, recomputed; or the first alone. The error in energy is r . K^-1 r, between
 * r . z and that over the smallest eigenvalue of the preconditioned matrix; the largest is 1. */
#include "linear/two_level.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { SIDES = BWI_SMOOTHER_SIDES, ROWS = BWI_SMOOTHER_ROWS, STARTS = 4 };

/* In one iteration the energy of the error falls by at least this fraction of what the residual
 * falls by, and mostly by this (as in pcg.c). */
#define ENERGY_FALLS 0.03
#define ENERGY_FALLS_MOSTLY 0.3

/* That smallest eigenvalue: 0.09 on meshes of limbed bodies, more on regular ones. */
#define SMALLEST 0.09

/* ---- one block of right-hand sides ---------------------------------------------------------- */

typedef struct column {
  bool done, restarted; /* restarted: its next direction is its z alone */
  double unit;          /* the force was taken times it */
  double r_dot_z, alpha, beta;
  double load, energy; /* |f| and f . M f, of the force taken times its unit */
  double size, residual;
  int starts;
} column;

typedef struct iteration {
  bw_context *context;
  bwi_two_level *l;
  bwi_two_level_problem *problem;
  int width, used;
  const double *force; /* of the first field */
  double *solution;
  column column[SIDES];
  double *chunk_sum; /* by chunk of rows: 2 x SIDES sums */
  double sum[2 * SIDES];
} iteration;

static bw_status parallel_sums(iteration *it, bw_body *body) {
  bw_status status = BW_OK;
  int64_t chunks = (it->l->smoother->count + ROWS - 1) / ROWS;
  BW_TRY(bw_parallel(it->context, it->l->smoother->count, ROWS, body, it));
  for (int i = 0; i < 2 * SIDES; i++) {
    it->sum[i] = 0;
    for (int64_t c = 0; c < chunks; c++)
      it->sum[i] += it->chunk_sum[2 * SIDES * c + i];
  }
done:
  return status;
}

/* Fields of doubles at the unknowns alone. */
static void keep_unknowns(const bwi_two_level *l, int width, double *field) {
  for (int32_t h = 0; h < l->constrained_count; h++) {
    double *x = field + 3 * (int64_t)width * l->constrained[h];
    for (int f = 0; f < width; f++) {
      double value[3] = {x[f], x[width + f], x[2 * width + f]};
      bwi_project_unknowns(l->dof_map, l->smoother->node[l->constrained[h]], value, value);
      for (int d = 0; d < 3; d++)
        x[d * width + f] = value[d];
    }
  }
}

/* q = K p at the unknowns */
static bw_status multiply(iteration *it, const double *p, double *q) {
  bw_status status = BW_OK;
  BW_TRY(bwi_smoother_product(it->context, it->l->smoother, it->width, p, q));
  keep_unknowns(it->l, it->width, q);
done:
  return status;
}

/* p . q and p . r */
static bw_status p_dot_Ap(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const iteration *it = data;
  const bwi_two_level *l = it->l;
  double *sum = it->chunk_sum + 2 * SIDES * (begin / ROWS);
  int width = it->width;
  memset(sum, 0, 2 * SIDES * sizeof *sum);
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < width; f++) {
      double p = l->p[i * width + f];
      sum[f] += p * l->q[i * width + f];
      sum[SIDES + f] += p * l->r[i * width + f];
    }
  return BW_OK;
}

/* r = f - K u (where `recomputed`; else f) with its floats, and r . r */
static bw_status set_residual(iteration *it, int64_t begin, int64_t end, bool recomputed) {
  bwi_two_level *l = it->l;
  int width = it->width;
  double *sum = it->chunk_sum + 2 * SIDES * (begin / ROWS);
  int64_t size = 3 * (int64_t)l->smoother->count;
  memset(sum, 0, 2 * SIDES * sizeof *sum);
  for (int64_t k = begin; k < end; k++) {
    int64_t node = l->smoother->node[k];
    for (int f = 0; f < width; f++) {
      double value[3] = {0, 0, 0};
      if (f < it->used && recomputed) {
        double residual[3];
        for (int d = 0; d < 3; d++)
          residual[d] = it->column[f].unit * it->force[f * size + 3 * node + d] -
                        l->ku[(3 * k + d) * width + f];
        bwi_project_unknowns(l->dof_map, node, residual, value);
      } else if (f < it->used)
        bwi_project_unknowns(l->dof_map, node, it->force + f * size + 3 * node, value);
      for (int d = 0; d < 3; d++) {
        l->r[(3 * k + d) * width + f] = value[d];
        l->floats[(3 * k + d) * width + f] = (float)value[d];
        sum[f] += value[d] * value[d];
      }
    }
  }
  return BW_OK;
}

static bw_status initial_residual(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  return set_residual(data, begin, end, false);
}

static bw_status true_residual(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  return set_residual(data, begin, end, true);
}

/* The floats of r, and r . r */
static bw_status measure(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const iteration *it = data;
  bwi_two_level *l = it->l;
  double *sum = it->chunk_sum + 2 * SIDES * (begin / ROWS);
  int width = it->width;
  memset(sum, 0, 2 * SIDES * sizeof *sum);
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < width; f++) {
      double r = l->r[i * width + f];
      l->floats[i * width + f] = (float)r;
      sum[f] += r * r;
    }
  return BW_OK;
}

/* Without what there is of rigid-body modes in a field. */
static bw_status remove_modes(iteration *it, double *field) {
  const bwi_field_layout packed = {3 * (int64_t)it->width, it->width, 1};
  return bwi_rigid_space_project(it->context, it->l->rigid, &packed, it->used, field);
}

/* r with its floats, and r . r, by one of the above. */
static bw_status find_residual(iteration *it, bw_body *body) {
  bw_status status = BW_OK;
  BW_TRY(parallel_sums(it, body));
  if (it->l->rigid) {
    BW_TRY(remove_modes(it, it->l->r));
    BW_TRY(parallel_sums(it, measure));
  }
done:
  return status;
}

/* r times the units, and the floats; u = 0 */
static bw_status scale(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const iteration *it = data;
  bwi_two_level *l = it->l;
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < it->width; f++) {
      int64_t at = i * it->width + f;
      l->r[at] *= it->column[f].unit;
      l->floats[at] = (float)l->r[at];
      l->u[at] = 0;
    }
  return BW_OK;
}

/* u += step p, r -= step q; r . r */
static bw_status advance(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const iteration *it = data;
  bwi_two_level *l = it->l;
  double *sum = it->chunk_sum + 2 * SIDES * (begin / ROWS), step[SIDES];
  int width = it->width;
  memset(sum, 0, 2 * SIDES * sizeof *sum);
  for (int f = 0; f < width; f++)
    step[f] = it->column[f].alpha;
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < width; f++) {
      int64_t at = i * width + f;
      l->u[at] += step[f] * l->p[at];
      double r = l->r[at] - step[f] * l->q[at];
      l->r[at] = r;
      l->floats[at] = (float)r;
      sum[f] += r * r;
    }
  return BW_OK;
}

/* r . z and z . q */
static bw_status r_dot_z(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const iteration *it = data;
  const bwi_two_level *l = it->l;
  double *sum = it->chunk_sum + 2 * SIDES * (begin / ROWS);
  int width = it->width;
  memset(sum, 0, 2 * SIDES * sizeof *sum);
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < width; f++) {
      int64_t at = i * width + f;
      double z = (double)l->z[at];
      sum[f] += l->r[at] * z;
      sum[SIDES + f] += z * l->q[at];
    }
  return BW_OK;
}

/* p = z + beta p */
static bw_status update_direction(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const iteration *it = data;
  const bwi_two_level *l = it->l;
  int width = it->width;
  double beta[SIDES];
  for (int f = 0; f < width; f++)
    beta[f] = it->column[f].beta;
  for (int64_t i = 3 * begin; i < 3 * end; i++)
    for (int f = 0; f < width; f++) {
      int64_t at = i * width + f;
      l->p[at] = (double)l->z[at] + beta[f] * l->p[at];
    }
  return BW_OK;
}

/* That, projected onto the unknowns: the floats of z leave a remainder along constrained
 * directions. */
static bw_status update_directions(iteration *it) {
  bw_status status = BW_OK;
  BW_TRY(bw_parallel(it->context, it->l->smoother->count, ROWS, update_direction, it));
  keep_unknowns(it->l, it->width, it->l->p);
  if (it->l->rigid) /* K does not see them, but its rounding does */
    BW_TRY(remove_modes(it, it->l->p));
done:
  return status;
}

static bw_status store_solution(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const iteration *it = data;
  const bwi_two_level *l = it->l;
  int64_t size = 3 * (int64_t)l->smoother->count;
  for (int64_t k = begin; k < end; k++)
    for (int d = 0; d < 3; d++)
      for (int f = 0; f < it->used; f++)
        it->solution[f * size + 3 * (int64_t)l->smoother->node[k] + d] =
            l->u[(3 * k + d) * it->width + f] * (l->smoother->unit / it->column[f].unit);
  return BW_OK;
}

/* The size to which rounding lets the residual of field f fall, as bwi_residual_noise has it. */
static double noise(const iteration *it, int f) {
  const bwi_two_level *l = it->l;
  double sum = 0;
  for (int64_t k = 0; k < l->smoother->count; k++)
    for (int d = 0; d < 3; d++) {
      double term = 0;
      for (int c = 0; c < 3; c++)
        term += fabs(l->smoother->diagonal[9 * k + 3 * c + d] * l->u[(3 * k + c) * it->width + f]);
      sum += term * term;
    }
  return BWI_RESIDUAL_NOISE * DBL_EPSILON * sqrt(sum);
}

static double allowed(const iteration *it, int f) {
  const column *c = &it->column[f];
  if (it->problem->energy_alone)
    return INFINITY;
  double max = 0.5 * it->problem->tolerance * c->load; /* whoever looks at it takes other norms */
  return c->size <= max ? max : fmax(max, noise(it, f));
}

/* r = f, z = M r, p = z, for all fields; forces that are 0 are done at once. */
static bw_status begin(iteration *it) {
  bw_status status = BW_OK;
  const bwi_two_level_problem *problem = it->problem;
  BW_TRY(find_residual(it, initial_residual));
  for (int f = 0; f < it->width; f++) {
    column *c = &it->column[f];
    double size = sqrt(it->sum[f]);
    int exponent = 0;
    *c = (column){.done = !(size > 0), .unit = 1};
    if (c->done)
      continue;
    frexp(size, &exponent);
    c->unit = ldexp(1, -exponent);
    c->size = c->unit * size;
    c->load = problem->load ? c->unit * problem->load[f] : c->size;
    c->residual = c->size / c->load;
  }
  BW_TRY(bw_parallel(it->context, it->l->smoother->count, ROWS, scale, it));
  BW_TRY(bwi_two_level_precondition(it->context, it->l, it->width, it->used));
  size_t numbers = 3 * (size_t)it->l->smoother->count * (size_t)it->width;
  memset(it->l->q, 0, numbers * sizeof *it->l->q);
  memset(it->l->p, 0, numbers * sizeof *it->l->p);
  BW_TRY(parallel_sums(it, r_dot_z));
  for (int f = 0; f < it->used; f++) {
    column *c = &it->column[f];
    c->r_dot_z = c->energy = it->sum[f];
    if (problem
            ->energy) /* in equations taken times units: u . f goes with unit^2 over the matrix' */
      c->energy = fmax(c->energy, problem->energy[f] * c->unit * c->unit / it->l->smoother->unit);
  }
  BW_TRY(update_directions(it));
done:
  return status;
}

/* What r . z is to fall to. Where solutions are to be as exact as a direct one, errors must be
 * small beside any part of the solution that is seen, and the energy of a load at a support, say,
 * is that of its neighbourhood: ten times less. */
static double target(const bwi_two_level_problem *problem) {
  return sqrt(SMALLEST) * problem->tolerance * (problem->energy_alone ? 1 : 0.1);
}

/* Fields whose iteration ended: is the residual, recomputed, small enough too? Those for which
 * it is not, and still falls, start again from it: they are restarted. */
static bw_status check(iteration *it, const bool *ended) {
  bw_status status = BW_OK;
  bwi_two_level *l = it->l;
  bool any = false;
  for (int f = 0; f < it->used; f++) {
    any |= ended[f];
    if (it->problem->energy_alone)
      it->column[f].done |= ended[f];
  }
  if (!any || it->problem->energy_alone)
    return BW_OK;
  BW_TRY(multiply(it, l->u, l->ku));
  BW_TRY(find_residual(it, true_residual)); /* of the others too: they go on with these */
  for (int f = 0; f < it->used; f++) {
    column *c = &it->column[f];
    if (!ended[f])
      continue;
    c->size = sqrt(it->sum[f]);
    double residual = c->size / c->load;
    bool helped = residual < 0.5 * c->residual;
    c->residual = residual;
    c->restarted = c->size > allowed(it, f) && helped && ++c->starts < STARTS;
    c->done = !c->restarted;
  }
done:
  return status;
}

/* z = M r, and from it what the next directions take of the last ones. Those that are done by it go
 * to `ended`. `restarts`: for those that are restarted, after it was called for all. */
static bw_status update_beta(iteration *it, bool restarts, bool *ended) {
  bw_status status = BW_OK;
  double tolerance = target(it->problem);
  BW_TRY(bwi_two_level_precondition(it->context, it->l, it->width, it->used));
  BW_TRY(parallel_sums(it, r_dot_z));
  for (int f = 0; f < it->used; f++) {
    column *c = &it->column[f];
    double next_r_dot_z = it->sum[f];
    ended[f] = false;
    if (c->done || c->restarted)
      c->beta = 0;
    else if (!restarts) {
      ended[f] = next_r_dot_z <= tolerance * tolerance * c->energy && c->size <= allowed(it, f);
      c->beta = -c->alpha * it->sum[SIDES + f] / c->r_dot_z;
    }
    if (!c->done)
      c->r_dot_z = next_r_dot_z;
    c->restarted = false;
  }
done:
  return status;
}

/* Fields whose residual has fallen so far that r . z surely has too. */
static bool find_converged(const iteration *it, const double *before, bool *ended) {
  double tolerance = target(it->problem);
  double min = it->problem->energy_alone ? ENERGY_FALLS_MOSTLY : ENERGY_FALLS;
  bool any = false;
  for (int f = 0; f < it->used; f++) {
    const column *c = &it->column[f];
    double fall = c->size / (before[f] * min);
    ended[f] = !c->done && fall < 1 &&
               c->r_dot_z * fall * fall <= tolerance * tolerance * c->energy &&
               c->size <= allowed(it, f);
    any |= ended[f];
  }
  return any;
}

/* How far the slowest has come, in digits. */
static double fraction_done(const iteration *it) {
  double wanted = log(target(it->problem)), min = 1;
  for (int f = 0; f < it->used; f++)
    if (!it->column[f].done)
      min = fmin(min, 0.5 * log(it->column[f].r_dot_z / it->column[f].energy) / wanted);
  return fmax(0, min);
}

static double largest_residual(const iteration *it) {
  double max = 0;
  for (int f = 0; f < it->used; f++)
    if (!it->column[f].done)
      max = fmax(max, it->column[f].size / it->column[f].load);
  return max;
}

static bool is_active(const iteration *it) {
  for (int f = 0; f < it->used; f++)
    if (!it->column[f].done)
      return true;
  return false;
}

static bool any_restarted(const iteration *it) {
  for (int f = 0; f < it->used; f++)
    if (it->column[f].restarted)
      return true;
  return false;
}

/* Along the directions; *definite is false where the matrix is not positive definite. */
static bw_status step(iteration *it, double *before, bool *definite) {
  bw_status status = BW_OK;
  BW_TRY(multiply(it, it->l->p, it->l->q));
  BW_TRY(parallel_sums(it, p_dot_Ap));
  for (int f = 0; f < it->used; f++) {
    column *c = &it->column[f];
    before[f] = c->size;
    /* p . r in place of r . z: where r was recomputed the two are not the same, and only the
       first lets no step make the error in energy larger */
    c->alpha = c->done ? 0 : it->sum[SIDES + f] / it->sum[f];
    *definite &= c->done || (it->sum[f] > 0 && isfinite(c->alpha));
  }
  if (!*definite)
    return BW_OK;
  BW_TRY(parallel_sums(it, advance));
  for (int f = 0; f < it->used; f++)
    it->column[f].size = sqrt(it->sum[f]);
done:
  return status;
}

static bw_status run(iteration *it) {
  bw_status status = BW_OK;
  bwi_two_level_problem *problem = it->problem;
  int iterations = 0;
  BW_TRY(begin(it));
  while (is_active(it)) {
    double before[SIDES];
    bool ended[SIDES], definite = true;
    if (iterations >= problem->limit) {
      problem->converged = false;
      break;
    }
    iterations++;
    BW_TRY(bw_check_cancel(it->context));
    bw_progress(it->context, "conjugate gradients", fraction_done(it));
    BW_TRY(step(it, before, &definite));
    if (!definite) {
      problem->converged = false;
      break;
    }
    if (find_converged(it, before, ended))
      BW_TRY(check(it, ended));
    if (!is_active(it))
      break;
    BW_TRY(update_beta(it, false, ended));
    BW_TRY(check(it, ended));
    if (any_restarted(it))
      BW_TRY(update_beta(it, true, ended));
    BW_TRY(update_directions(it));
  }
  BW_TRY(bw_parallel(it->context, it->l->smoother->count, ROWS, store_solution, it));
  problem->reached = largest_residual(it);
done:
  problem->iterations = iterations;
  return status;
}

bw_status bwi_two_level_solve(bw_context *context, bwi_two_level *l, bwi_two_level_problem *problem,
                              int64_t count, const double *force, double *displacement) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)l->smoother->count;
  iteration it = {.context = context, .l = l, .width = count > 1 ? SIDES : 1};
  bwi_two_level_problem part = *problem;
  problem->iterations = 0;
  problem->converged = true;
  it.problem = &part;
  BW_TRY(bwi_two_level_reserve(context, l, it.width));
  it.chunk_sum = BW_NEW(context, double, 2 * SIDES * (l->smoother->count / ROWS + 1));
  if (!it.chunk_sum) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t first = 0; first < count && problem->converged; first += SIDES) {
    part = *problem;
    part.load = problem->load ? problem->load + first : NULL;
    part.energy = problem->energy ? problem->energy + first : NULL;
    it.used = (int)(count - first < it.width ? count - first : it.width);
    it.force = force + first * size;
    it.solution = displacement + first * size;
    BW_TRY(run(&it));
    problem->iterations =
        part.iterations > problem->iterations ? part.iterations : problem->iterations;
    problem->converged = part.converged;
    problem->reached = part.reached;
  }
done:
  bw_free(it.chunk_sum);
  return status;
}
