/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Preconditioned conjugate gradients (pcg_space.h). Each column has its own coefficients; matrix
 * and preconditioner are read once per iteration for all of them.
 *
 * A preconditioner in floats is not quite symmetric. The new direction is then made conjugate to
 * the last one by the product q that is at hand (Polak and Ribiere). */
#include "linear/pcg_space.h"

#include <assert.h>
#include <math.h>

enum { COLUMNS = BWI_PCG_COLUMNS, STARTS = 4 };

/* The rate is judged from this iteration on: until then outlying eigenvalues rule. */
enum { JUDGED_FROM = 6, REMEMBERED = 512 };

typedef struct column {
  bool done, restarted; /* restarted: its next direction is its z alone */
  bool waits;           /* done, and its r is still to be computed from x */
  double r_dot_z, alpha, beta;
  double load, energy; /* what the tolerances are relative to */
  double size;         /* |r| */
  double before;       /* |r|, one iteration ago */
  double residual;     /* |r| over the load when r was last computed from x */
  int starts;
} column;

typedef struct iteration {
  bw_context *context;
  const bwi_pcg_space *space;
  bwi_pcg_task *task;
  column column[COLUMNS];
  int count;                  /* columns that there still are */
  double history[REMEMBERED]; /* r . z over the energy, of the worst column, by iteration: the
                                 smallest until then */
} iteration;

static bool is_active(const iteration *it) {
  for (int k = 0; k < it->count; k++)
    if (!it->column[k].done)
      return true;
  return false;
}

/* Whether columns end by the r of the recurrence. */
static bool trusts_recurrence(const bwi_pcg_task *task) {
  return task->recurrence || isinf(task->residual_tolerance);
}

static void record_residual(iteration *it, const column *c) {
  bool computed = c->done && !c->waits && !trusts_recurrence(it->task);
  double residual = computed ? c->residual : c->size > 0 ? c->size / c->load : c->size;
  it->task->residual = fmax(it->task->residual, residual);
}

/* Takes out columns that are done, where the space does. */
static void retire(iteration *it) {
  for (int k = it->count - 1; it->space->retire && k >= 0; k--)
    if (it->column[k].done) {
      int last = --it->count;
      record_residual(it, &it->column[k]);
      it->space->retire(it->space->data, k, last);
      it->column[k] = it->column[last];
    }
}

static bool is_small(const iteration *it, int k) {
  const column *c = &it->column[k];
  double max = it->task->residual_tolerance * c->load;
  return c->size <= max || (it->space->noise && c->size <= it->space->noise(it->space->data, k));
}

/* r, z = M^-1 r, and what tolerances are relative to; a column without residual is done. */
static bw_status begin(iteration *it) {
  bw_status status = BW_OK;
  const bwi_pcg_task *task = it->task;
  double r_dot_r[COLUMNS], r_dot_z[COLUMNS];
  bool wanted[COLUMNS] = {false};
  it->count = task->columns;
  for (int k = 0; k < it->count; k++)
    wanted[k] = true;
  BW_TRY(it->space->residual(it->context, it->space->data, wanted, r_dot_r));
  for (int k = 0; k < it->count; k++) {
    column *c = &it->column[k];
    *c = (column){.size = sqrt(r_dot_r[k])};
    c->load = task->load ? task->load[k] : c->size;
    c->residual = c->size > 0 ? c->size / c->load : 0;
    c->energy = task->energy ? task->energy[k] : 0;
    c->done = c->size == 0 ||
              (isinf(task->energy_tolerance) && c->size <= task->residual_tolerance * c->load);
  }
  retire(it);
  if (!is_active(it) || task->limit == 0)
    return BW_OK;
  BW_TRY(it->space->precondition(it->context, it->space->data, r_dot_z, NULL));
  for (int k = 0; k < it->count; k++) {
    column *c = &it->column[k];
    c->r_dot_z = r_dot_z[k];
    c->energy = fmax(c->energy, r_dot_z[k]);
  }
done:
  return status;
}

/* Along the directions; false where A or M is not positive definite. */
static bw_status step(iteration *it, bool *definite) {
  bw_status status = BW_OK;
  double beta[COLUMNS], alpha[COLUMNS], p_dot_q[COLUMNS], r_dot_r[COLUMNS];
  for (int k = 0; k < it->count; k++) {
    const column *c = &it->column[k];
    beta[k] = c->done ? 0 : c->beta;
    *definite &= c->done || (c->r_dot_z > 0 && isfinite(c->r_dot_z));
  }
  if (!*definite)
    return BW_OK;
  BW_TRY(it->space->multiply(it->context, it->space->data, beta, p_dot_q));
  for (int k = 0; k < it->count; k++) {
    column *c = &it->column[k];
    c->before = c->size;
    alpha[k] = c->alpha = c->done ? 0 : c->r_dot_z / p_dot_q[k];
    *definite &= c->done || (p_dot_q[k] > 0 && isfinite(c->alpha));
  }
  if (!*definite)
    return BW_OK;
  BW_TRY(it->space->advance(it->context, it->space->data, alpha, r_dot_r));
  for (int k = 0; k < it->count; k++) {
    it->column[k].size = sqrt(r_dot_r[k]);
    *definite &= it->column[k].done || isfinite(r_dot_r[k]);
  }
done:
  return status;
}

/* Columns whose iteration ended: is r, computed from x, small enough too? Those for which it is
 * not, and still falls, start again from it. Columns that stay where they are wait for the others,
 * since one product serves all. */
static bw_status check(iteration *it, const bool *ended) {
  bw_status status = BW_OK;
  double r_dot_r[COLUMNS];
  bool any = false, trusted = trusts_recurrence(it->task), wanted[COLUMNS];
  for (int k = 0; k < it->count; k++) {
    column *c = &it->column[k];
    any |= ended[k];
    c->done |= ended[k];
    c->waits |= ended[k] && !trusted;
    wanted[k] = c->waits;
  }
  if (!any || (!trusted && !it->space->retire && is_active(it)))
    return BW_OK;
  if (!trusted)
    BW_TRY(it->space->residual(it->context, it->space->data, wanted, r_dot_r));
  for (int k = 0; k < it->count; k++) {
    column *c = &it->column[k];
    if (!wanted[k])
      continue;
    c->size = sqrt(r_dot_r[k]);
    double residual = c->size / c->load;
    bool helped = residual < 0.5 * c->residual;
    c->residual = residual;
    c->restarted = !is_small(it, k) && helped && ++c->starts < STARTS;
    c->done = !c->restarted;
    c->waits = false;
  }
  retire(it);
done:
  return status;
}

/* Columns that are done without another application of M. */
static void find_converged(const iteration *it, bool *ended) {
  double tolerance = it->task->energy_tolerance;
  for (int k = 0; k < it->count; k++) {
    const column *c = &it->column[k];
    double fall = c->size / (c->before * it->task->energy_fall);
    bool energy = isinf(tolerance) ||
                  (fall < 1 && c->r_dot_z * fall * fall <= tolerance * tolerance * c->energy);
    ended[k] = !c->done && energy && is_small(it, k);
  }
}

/* z = M^-1 r, and what the next directions take of the last ones. Those that are done by it go to
 * `ended`. `restarts`: for those that are restarted, after it was called for all. */
static bw_status update_beta(iteration *it, bool restarts, bool *ended) {
  bw_status status = BW_OK;
  double r_dot_z[COLUMNS], z_dot_q[COLUMNS], tolerance = it->task->energy_tolerance;
  bool symmetric = it->space->symmetric;
  BW_TRY(
      it->space->precondition(it->context, it->space->data, r_dot_z, symmetric ? NULL : z_dot_q));
  for (int k = 0; k < it->count; k++) {
    column *c = &it->column[k];
    ended[k] = false;
    if (c->done)
      continue;
    if (c->restarted)
      c->beta = 0;
    else if (!restarts) {
      ended[k] = r_dot_z[k] <= tolerance * tolerance * c->energy && is_small(it, k);
      c->beta = symmetric ? r_dot_z[k] / c->r_dot_z : -c->alpha * z_dot_q[k] / c->r_dot_z;
    }
    c->r_dot_z = r_dot_z[k];
    c->restarted = false;
  }
done:
  return status;
}

static bool any_restarted(const iteration *it) {
  for (int k = 0; k < it->count; k++)
    if (it->column[k].restarted)
      return true;
  return false;
}

/* Whether more iterations are to come than max_remaining allows, by how r . z has fallen
 * since half of those made. Rates grow as the outlying eigenvalues are found one by one, mostly to
 * twice of what is seen; while they are, hardly anything may fall. Where that makes it give up a
 * little too soon, no more is lost than what max_remaining would have been lost on. */
static bool is_beyond(iteration *it, int made) {
  bwi_pcg_task *task = it->task;
  double worst = 0, wanted = task->energy_tolerance * task->energy_tolerance;
  if (!(task->max_remaining > 0) || made >= REMEMBERED)
    return false;
  for (int k = 0; k < it->count; k++)
    if (!it->column[k].done)
      worst = fmax(worst, it->column[k].r_dot_z / it->column[k].energy);
  it->history[made] = made > 1 ? fmin(worst, it->history[made - 1]) : worst;
  if (made < JUDGED_FROM || !(it->history[made] > wanted))
    return false;
  double fallen = log(it->history[made / 2] / it->history[made]) / (made - made / 2);
  double left = 0.5 * log(it->history[made] / wanted) / fallen;
  if (left <= task->max_remaining)
    return false;
  task->predicted_iterations = made + left;
  return true;
}

/* How far the slowest has come, in digits. */
static double fraction_done(const iteration *it) {
  const bwi_pcg_task *task = it->task;
  bool energy = isfinite(task->energy_tolerance) != 0;
  double wanted = log(energy ? task->energy_tolerance : task->residual_tolerance), min = 1;
  for (int k = 0; k < it->count; k++) {
    const column *c = &it->column[k];
    double left = energy ? 0.5 * log(c->r_dot_z / c->energy) : log(c->size / c->load);
    if (!c->done)
      min = fmin(min, left / wanted);
  }
  return fmax(0, min);
}

/* One iteration; *more is false where it is the last. */
static bw_status iterate(iteration *it, bool *more) {
  bw_status status = BW_OK;
  bool ended[COLUMNS], definite = true;
  *more = false;
  if (it->task->progress) /* who is shown it may cancel */
    bw_progress(it->context, "conjugate gradients", fraction_done(it));
  BW_TRY(bw_check_cancel(it->context));
  BW_TRY(step(it, &definite));
  if (!definite) {
    it->task->indefinite = true;
    it->task->converged = false;
    return BW_OK;
  }
  find_converged(it, ended);
  BW_TRY(check(it, ended));
  if (!is_active(it))
    return BW_OK;
  if (it->task->adapt) /* the next direction is conjugate to the last one in any case */
    BW_TRY(it->task->adapt(it->context, it->task->data, it->task->iterations, fraction_done(it)));
  BW_TRY(update_beta(it, false, ended));
  BW_TRY(check(it, ended));
  if (any_restarted(it))
    BW_TRY(update_beta(it, true, ended));
  *more = is_active(it);
  if (*more && is_beyond(it, it->task->iterations)) {
    it->task->converged = false;
    *more = false;
  }
done:
  return status;
}

bw_status bwi_pcg_run(bw_context *context, const bwi_pcg_space *space, bwi_pcg_task *task) {
  bw_status status = BW_OK;
  iteration it = {.context = context, .space = space, .task = task};
  assert(task->columns >= 1 && task->columns <= COLUMNS && task->limit >= 0);
  assert(task->energy_tolerance > 0 && task->residual_tolerance > 0);
  task->iterations = 0;
  task->predicted_iterations = task->residual = 0;
  task->converged = true;
  task->indefinite = false;
  BW_TRY(begin(&it));
  for (bool more = is_active(&it); more;) {
    if (task->iterations >= task->limit) {
      task->converged = false;
      break;
    }
    task->iterations++;
    BW_TRY(iterate(&it, &more));
  }
  for (int k = 0; k < it.count; k++)
    record_residual(&it, &it.column[k]);
done:
  return status;
}
