/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Preconditioned conjugate gradients, several right-hand sides side by side: the preconditioner
 * (mostly a factor of a former matrix, or one in single precision) is read once per iteration for
 * all of them, and each has its own coefficients. The new direction is made conjugate to the last
 * one by the product K p that is at hand (Polak and Ribiere), not by r . z alone: so the rounding
 * of a factor in single precision, by which it is not quite symmetric, does no harm.
 *
 * Invariants: columns 0 .. active - 1 of r, z, p, q belong to right-hand sides that go on; side[k]
 * says which. All fields are 0 off the unknowns.
 *
 * A right-hand side is done when its residual measured by the preconditioner (r . z, which is near
 * the energy of the error) has fallen below the tolerance, and so has the residual itself, each
 * relative to the load's; the residual need not fall below what rounding leaves of it. Where the
 * residual has fallen so far that r . z surely has too, it is done without that application of the
 * preconditioner. The residual is then recomputed from the solution; where rounding has parted
 * the two, the iteration starts again from there until that no longer helps. Where the error in
 * energy is all that is asked for, that is left out, and so is the wait for the residual. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "linear/pcg.h"

enum { WIDTH = 8, STARTS = 4 };

/* Convergence is checked from this iteration on: until then outlying eigenvalues rule. */
enum { CHECKED_FROM = 6, REMEMBERED = 512 };

/* In one iteration the energy of the error falls by at least this fraction of what the residual
 * falls by (its root; measured: 0.1 to 1.3); and mostly by this. */
#define ENERGY_FALLS 0.03
#define ENERGY_FALLS_MOSTLY 0.3

typedef struct column {
  int64_t side;
  double r_dot_z;      /* r . z */
  double alpha;        /* step along p */
  double load, energy; /* |f|, f . M f at the start */
  double size;         /* |r| */
  double residual;     /* true, at the last start; relative */
  int starts;
  bool restarted; /* started again in this iteration */
} column;

typedef struct iteration {
  bw_context *context;
  bwi_pcg *problem;
  int64_t size;
  const double *force;
  double *solution;
  double *r, *z, *p, *q;
  column column[WIDTH];
  int active;
  double history[REMEMBERED]; /* r . z over the energy, of the worst column, by iteration: the
                                 smallest until then */
} iteration;

static void keep_unknowns(const iteration *it, double *field) {
  bwi_keep_states(it->problem->dof_map, 1u << BW_DOF_UNKNOWN, field);
}

static bw_status multiply(iteration *it, int count, const double *x, double *y) {
  bw_status status = bw_block_multiply(it->context, it->problem->pattern, it->problem->stiffness, 9,
                                       3, count, x, y);
  for (int k = 0; status == BW_OK && k < count; k++)
    keep_unknowns(it, y + k * it->size);
  return status;
}

/* z = M r. */
static bw_status precondition(iteration *it, int first, int count) {
  return it->problem->precondition(it->context, it->problem->data, count, it->r + first * it->size,
                                   it->z + first * it->size);
}

/* Take column k out: the last active one moves into its place. */
static void retire(iteration *it, int k) {
  int last = --it->active;
  if (k == last)
    return;
  size_t bytes = (size_t)it->size * sizeof(double);
  double *fields[4] = {it->r, it->z, it->p, it->q};
  for (int f = 0; f < 4; f++)
    memcpy(fields[f] + k * it->size, fields[f] + last * it->size, bytes);
  it->column[k] = it->column[last];
}

static double allowed(const iteration *it, const column *c) {
  if (it->problem->energy_alone)
    return INFINITY;
  return fmax(it->problem->tolerance * c->load,
              bwi_residual_noise(it->problem->pattern, it->problem->stiffness,
                                 it->solution + c->side * it->size));
}

/* Start column k again from the residual of its solution; *more is false when it is done. */
static bw_status restart(iteration *it, int k, bool *more) {
  bw_status status = BW_OK;
  column *c = &it->column[k];
  *more = false;
  if (it->problem->energy_alone)
    return BW_OK;
  double *r = it->r + k * it->size, *z = it->z + k * it->size, *p = it->p + k * it->size;
  BW_TRY(multiply(it, 1, it->solution + c->side * it->size, it->q + k * it->size));
  memcpy(r, it->force + c->side * it->size, (size_t)it->size * sizeof *r);
  keep_unknowns(it, r);
  for (int64_t i = 0; i < it->size; i++)
    r[i] -= it->q[k * it->size + i];
  double residual = sqrt(bwi_dot(it->size, r, r)) / c->load;
  bool helped = residual < 0.5 * c->residual;
  c->residual = residual;
  *more = residual * c->load > allowed(it, c) && helped && ++c->starts < STARTS;
  if (*more) {
    BW_TRY(precondition(it, k, 1));
    memcpy(p, z, (size_t)it->size * sizeof *p);
    c->r_dot_z = bwi_dot(it->size, r, z);
    c->size = residual * c->load;
    c->restarted = true;
  }
done:
  return status;
}

/* r = f, u = 0, z = p = M r; loads that are 0 are done at once. */
static bw_status begin(iteration *it, int64_t first, int count) {
  bw_status status = BW_OK;
  int64_t size = it->size;
  it->active = 0;
  for (int64_t side = first; side < first + count; side++) {
    double *r = it->r + it->active * size;
    memcpy(r, it->force + side * size, (size_t)size * sizeof *r);
    keep_unknowns(it, r);
    memset(it->solution + side * size, 0, (size_t)size * sizeof(double));
    double left = sqrt(bwi_dot(size, r, r)),
           load = it->problem->load ? it->problem->load[side] : left;
    if (left > 0)
      it->column[it->active++] =
          (column){.side = side, .load = load, .size = left, .residual = left / load};
  }
  if (it->active == 0)
    return BW_OK;
  BW_TRY(precondition(it, 0, it->active));
  memcpy(it->p, it->z, (size_t)it->active * (size_t)size * sizeof(double));
  for (int k = 0; k < it->active; k++) {
    column *c = &it->column[k];
    c->r_dot_z = bwi_dot(size, it->r + k * size, it->z + k * size);
    c->energy = c->r_dot_z;
    if (it->problem->energy)
      c->energy = fmax(c->energy, it->problem->energy[c->side]);
  }
done:
  return status;
}

/* Whether more iterations are to come than max_remaining allows, by how r . z has fallen
 * since half of those made. Rates grow as the outlying eigenvalues are found one by one, mostly to
 * twice of what is seen; while they are, hardly anything may fall. Where that makes it give up a
 * little too soon, no more is lost than what max_remaining would have been lost on. */
static bool beyond_bound(iteration *it, int made) {
  bwi_pcg *problem = it->problem;
  double worst = 0, wanted = problem->tolerance * problem->tolerance;
  if (!(problem->max_remaining > 0) || made >= REMEMBERED)
    return false;
  for (int k = 0; k < it->active; k++)
    worst = fmax(worst, it->column[k].r_dot_z / it->column[k].energy);
  it->history[made] = made > 1 ? fmin(worst, it->history[made - 1]) : worst;
  if (made < CHECKED_FROM || it->active == 0 || !(it->history[made] > wanted))
    return false;
  double fallen = log(it->history[made / 2] / it->history[made]) / (made - made / 2);
  double left = 0.5 * log(it->history[made] / wanted) / fallen;
  if (left <= problem->max_remaining)
    return false;
  problem->predicted_iterations = made + left;
  return true;
}

/* Column k along its direction; *sound is false where the matrix is not positive definite. */
static void step(iteration *it, int k, bool *sound) {
  column *c = &it->column[k];
  int64_t size = it->size;
  double *r = it->r + k * size, *u = it->solution + c->side * size;
  const double *p = it->p + k * size, *q = it->q + k * size;
  double p_dot_Ap = bwi_dot(size, p, q);
  c->alpha = c->r_dot_z / p_dot_Ap;
  *sound = p_dot_Ap > 0 && isfinite(c->alpha);
  for (int64_t i = 0; *sound && i < size; i++) {
    u[i] += c->alpha * p[i];
    r[i] -= c->alpha * q[i];
  }
}

/* Columns that are done without another application of the preconditioner. */
static bw_status retire_sure(iteration *it) {
  bw_status status = BW_OK;
  double tolerance = it->problem->tolerance;
  double min = it->problem->energy_alone ? ENERGY_FALLS_MOSTLY : ENERGY_FALLS;
  for (int k = 0; k < it->active;) {
    column *c = &it->column[k];
    const double *r = it->r + k * it->size;
    double size = sqrt(bwi_dot(it->size, r, r)), fall = size / (c->size * min);
    bool more = true;
    c->restarted = false;
    c->size = size;
    if (fall < 1 && c->r_dot_z * fall * fall <= tolerance * tolerance * c->energy &&
        size <= allowed(it, c))
      BW_TRY(restart(it, k, &more));
    if (more)
      k++;
    else
      retire(it, k);
  }
done:
  return status;
}

/* The next direction of column k; *more is false when it is done. */
static bw_status update_direction(iteration *it, int k, bool *more) {
  column *c = &it->column[k];
  int64_t size = it->size;
  double tolerance = it->problem->tolerance;
  const double *z = it->z + k * size;
  double *p = it->p + k * size, r_dot_z = bwi_dot(size, it->r + k * size, z);
  if (r_dot_z <= tolerance * tolerance * c->energy && c->size <= allowed(it, c))
    return restart(it, k, more);
  double beta = -c->alpha * bwi_dot(size, z, it->q + k * size) / c->r_dot_z;
  c->r_dot_z = r_dot_z;
  for (int64_t i = 0; i < size; i++)
    p[i] = z[i] + beta * p[i];
  return BW_OK;
}

#ifndef NDEBUG
/* Columns of different right-hand sides of the block. */
static bool is_separate(const iteration *it, int64_t first, int count) {
  for (int k = 0; k < it->active; k++) {
    if (it->column[k].side < first || it->column[k].side >= first + count)
      return false;
    for (int j = 0; j < k; j++)
      if (it->column[j].side == it->column[k].side)
        return false;
  }
  return it->active <= count && count <= WIDTH;
}
#endif

/* One block of right-hand sides. */
static bw_status run(iteration *it, int64_t first, int count) {
  bw_status status = BW_OK;
  bwi_pcg *problem = it->problem;
  int iterations = 0;
  BW_TRY(begin(it, first, count));
  while (it->active > 0) {
    assert(is_separate(it, first, count));
    if (iterations >= problem->limit) {
      problem->converged = false;
      break;
    }
    iterations++;
    BW_TRY(bw_check_cancel(it->context));
    BW_TRY(multiply(it, it->active, it->p, it->q));
    for (int k = 0; k < it->active; k++) {
      bool sound;
      step(it, k, &sound);
      if (!sound) {
        problem->converged = false;
        goto done;
      }
    }
    BW_TRY(retire_sure(it));
    if (it->active > 0)
      BW_TRY(precondition(it, 0, it->active));
    for (int k = 0; k < it->active;) {
      bool more = true;
      if (!it->column[k].restarted)
        BW_TRY(update_direction(it, k, &more));
      if (more)
        k++;
      else
        retire(it, k);
    }
    if (beyond_bound(it, iterations)) {
      problem->converged = false;
      break;
    }
  }
done:
  if (iterations > problem->iterations)
    problem->iterations = iterations;
  for (int k = 0; !problem->converged && k < it->active; k++)
    problem->residual = fmax(problem->residual, it->column[k].size / it->column[k].load);
  return status;
}

bw_status bwi_pcg_solve(bw_context *context, bwi_pcg *problem, int64_t count, const double *force,
                        double *displacement) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)problem->dof_map->mesh->node_count;
  int64_t width = count < WIDTH ? count : WIDTH;
  assert(problem->tolerance > 0 && problem->limit >= 0);
  assert(size == 3 * (int64_t)problem->pattern->node_count);
  iteration it = {.context = context,
                  .problem = problem,
                  .size = size,
                  .force = force,
                  .solution = displacement};
  problem->iterations = 0;
  problem->predicted_iterations = problem->residual = 0;
  problem->converged = true;
  it.r = BW_NEW(context, double, width *size);
  it.z = BW_NEW(context, double, width *size);
  it.p = BW_NEW(context, double, width *size);
  it.q = BW_NEW(context, double, width *size);
  if (!it.r || !it.z || !it.p || !it.q) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t first = 0; first < count && problem->converged; first += WIDTH)
    BW_TRY(run(&it, first, (int)(count - first < WIDTH ? count - first : WIDTH)));
done:
  bw_free(it.r);
  bw_free(it.z);
  bw_free(it.p);
  bw_free(it.q);
  return status;
}
