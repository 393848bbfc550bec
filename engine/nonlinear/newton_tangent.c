/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The tangent of a solid under a case, and solving with it.
 *
 * Contact adds entries inside elements, so the solid's pattern serves. Follower pressures add a
 * part K' that is not symmetric and goes beyond the pattern; its symmetric part S within the
 * pattern goes into the factor, of M = K + S. GMRES on M^-1 (K + K') = 1 - M^-1 (S - K') then
 * solves with the exact tangent: a few solutions with the factor instead of a larger and
 * unsymmetric one. */
#include "nonlinear/internal.h"
#include "nonlinear/newton.h"

#include <math.h>
#include <string.h>

enum { BASIS = 40 };
#define GROWTH 5 /* of shifts that are not enough */
#define FOLLOWER_TOLERANCE 1e-6

static bw_status reserve(bwi_newton_state *state) {
  bw_newton *newton = state->newton;
  int64_t blocks = state->solid->pattern->block_count;
  if (newton->block_count == blocks)
    return BW_OK;
  bw_free(newton->stiffness);
  newton->block_count = 0;
  newton->stiffness = BW_NEW(state->context, double, 9 * blocks);
  if (!newton->stiffness)
    return BW_MEMORY;
  newton->block_count = blocks;
  return BW_OK;
}

static bw_status linearise(bwi_newton_state *state, bool project) {
  bw_status status = BW_OK;
  bw_newton *newton = state->newton;
  double before = bw_seconds();
  if (newton->linear_of != state->solid) {
    bw_solid_linear_destroy(newton->linear);
    bw_release(newton->linear_of);
    newton->linear = NULL;
    newton->linear_of = NULL;
    BW_TRY(bw_solid_linear_create(state->context, state->solid, &newton->linear));
    newton->linear_of = (const bw_solid *)bw_retain(state->solid);
  }
  BW_TRY(bw_solid_linear_set(state->context, newton->linear, state->now.u, project));
  if (state->quadratic)
    BW_TRY(bwi_solid_linear_add(state->context, newton->linear, state->quadratic->of_mass,
                                state->quadratic->linear, state->quadratic->of_stiffness));
  BW_TRY(bw_solid_linear_diagonal(state->context, newton->linear, state->blocks));
  state->report->evaluations++;
  state->report->seconds_quadrature += bw_seconds() - before;
done:
  return status;
}

static double mean_diagonal(const bwi_newton_state *state) {
  double mean = 0;
  for (int64_t i = 0; i < state->size; i++)
    mean += state->blocks[3 * i + i % 3] / (double)state->size;
  return mean;
}

/* The preconditioner for what is linearised, with `shift` on the diagonal, and the points that
 * push. */
static bw_status precondition(bwi_newton_state *state, double shift) {
  bw_status status = BW_OK;
  double before = bw_seconds();
  int factorisations = 0;
  double *shifted = NULL; /* the Newton state's own blocks say how large forces are */
  if (!state->precondition)
    BW_TRY(bwi_precondition_create(state->context, state->solid, state->load_case->constrained,
                                   state->plan.two_level ? state->options : NULL, state->contact,
                                   &state->precondition));
  factorisations = bwi_precondition_factorisations(state->precondition);
  if (shift > 0) {
    shifted = BW_NEW(state->context, double, 3 * state->size);
    if (!shifted)
      return BW_MEMORY;
    memcpy(shifted, state->blocks, 3 * (size_t)state->size * sizeof *shifted);
    for (int64_t i = 0; i < state->size; i++)
      shifted[3 * i + i % 3] += shift;
  }
  BW_TRY(bwi_precondition_set(state->context, state->precondition, state->newton->linear,
                              state->now.u, shifted ? shifted : state->blocks));
  state->report->seconds_factor += bw_seconds() - before;
  state->report->factorisations +=
      bwi_precondition_factorisations(state->precondition) - factorisations;
done:
  bw_free(shifted);
  return status;
}

static bw_status evaluate(bwi_newton_state *state, bool project) {
  bw_status status = BW_OK;
  if (state->iterative) {
    if (project || !state->stiffness_current)
      BW_TRY(linearise(state, project));
    state->stiffness_current = !project;
    goto done;
  }
  const bw_block_pattern *pattern = state->solid->pattern;
  double before = bw_seconds();
  bw_solid_shape shape;
  BW_TRY(reserve(state));
  if (project || !state->stiffness_current) {
    BW_TRY(bw_solid_evaluate(state->context, state->solid, state->now.u, project, NULL, NULL,
                             state->newton->stiffness, &shape));
    state->report->evaluations++;
    state->report->seconds_quadrature += bw_seconds() - before;
  }
  state->stiffness_current = !project;
  for (int64_t n = 0; n < pattern->node_count; n++)
    memcpy(state->blocks + 9 * n, state->newton->stiffness + 9 * (pattern->start[n + 1] - 1),
           9 * sizeof(double));
done:
  return status;
}

bw_status bwi_tangent_blocks(bwi_newton_state *state) {
  return evaluate(state, false);
}

static bw_status factor(bwi_newton_state *state, bool *definite) {
  const bw_block_pattern *pattern = state->solid->pattern;
  bw_newton *newton = state->newton;
  double before = bw_seconds();
  state->report->analyses +=
      !bwi_direct_keeps(newton->direct, pattern, state->load_case->constrained);
  bw_status status =
      bwi_direct_analyse(state->context, newton->direct, pattern, state->load_case->constrained);
  double between = bw_seconds();
  state->report->seconds_analysis += between - before;
  if (status == BW_OK)
    status = bwi_direct_factor(state->context, newton->direct, pattern,
                               state->load_case->constrained, newton->stiffness, definite, NULL);
  state->report->seconds_factor += bw_seconds() - between;
  state->report->factorisations++;
  return status;
}

/* Add to the diagonal, `part` of its mean and then more and more, until the matrix is definite. A
 * step then is between Newton's and one along the residual, and goes down in any case. */
static bw_status factor_shifted(bwi_newton_state *state, double part, double growth,
                                bool *definite) {
  bw_status status = BW_OK;
  const bw_block_pattern *pattern = state->solid->pattern;
  double mean = mean_diagonal(state), shift = 0;
  state->stiffness_current = false;
  state->shift = 0;
  for (; part <= 1 && !*definite && mean > 0; part *= growth) {
    for (int64_t n = 0; n < pattern->node_count; n++)
      for (int c = 0; c < 3; c++)
        state->newton->stiffness[9 * (pattern->start[n + 1] - 1) + 4 * c] += part * mean - shift;
    shift = part * mean;
    state->shift = part;
    BW_TRY(factor(state, definite));
  }
done:
  return status;
}

/* `part` of the diagonal's mean on the diagonal of the plain tangent that is linearised. */
static bw_status shift_linear(bwi_newton_state *state, double part) {
  bw_status status = BW_OK;
  double value = part * mean_diagonal(state);
  state->stiffness_current = false;
  state->shift = part;
  BW_TRY(bwi_solid_linear_shift(state->context, state->newton->linear, value));
  BW_TRY(precondition(state, value));
done:
  return status;
}

/* After a whole step, shifts begin well below the last one that sufficed, so that they end where
 * none is needed. After a short step they begin above it: the tangent was valid no further. */
#define FIRST_SHIFT 1e-3
#define MIN_SHIFT 1e-7
/* Projected tangents with follower loads, or of a solid whose only supports are contact planes, may
 * need one too. */
#define MIN_PROJECTED_SHIFT 1e-9
#define PROJECTED_SHIFT_GROWTH 30

bw_status bwi_tangent_set(bwi_newton_state *state, bwi_tangent kind, bool *definite) {
  bw_status status = BW_OK;
  double change = state->step >= 1 ? 0.2 : state->step > 0.5 ? 1 : 4;
  double shift = state->shift > 0 ? fmin(0.3, fmax(MIN_SHIFT, change * state->shift)) : FIRST_SHIFT;
  *definite = false;
  state->tangent = kind;
  state->have_tangent = true;
  if (state->iterative) { /* what is not definite shows when it is solved with */
    BW_TRY(evaluate(state, kind == BWI_PROJECTED));
    state->shift = kind == BWI_PROJECTED ? 0 : state->shift;
    if (kind == BWI_SHIFTED)
      BW_TRY(shift_linear(state, shift));
    else
      BW_TRY(precondition(state, 0));
    *definite = true;
    goto done;
  }
  BW_TRY(evaluate(state, kind == BWI_PROJECTED));
  if (state->quadratic) {
    bwi_quadratic_stiffness(state);
    state->stiffness_current = false;
  }
  if (state->contact) {
    bwi_contact_stiffness(state->contact, state->solid->pattern, state->newton->stiffness);
    state->stiffness_current = false;
  }
  if (state->follows) {
    size_t size = 9 * (size_t)state->solid->pattern->block_count;
    memset(state->follower, 0, size * sizeof(double));
    BW_TRY(bwi_load_case_follow_stiffness(state->context, state->load_case, state->now.u,
                                          state->initial_residual ? 1 : state->load,
                                          state->solid->pattern, state->follower));
    for (size_t i = 0; i < size; i++)
      state->newton->stiffness[i] += state->follower[i];
    state->stiffness_current = false;
  }
  if (kind == BWI_SHIFTED) {
    BW_TRY(factor_shifted(state, shift, GROWTH, definite));
    goto done;
  }
  double projected_shift =
      kind == BWI_PROJECTED ? state->projected_shift / PROJECTED_SHIFT_GROWTH : 0;
  if (projected_shift < MIN_PROJECTED_SHIFT)
    BW_TRY(factor(state, definite));
  state->projected_shift = 0;
  if (kind == BWI_PROJECTED && !*definite) {
    BW_TRY(factor_shifted(state, fmax(projected_shift, MIN_PROJECTED_SHIFT), PROJECTED_SHIFT_GROWTH,
                          definite));
    state->projected_shift = state->shift;
  }
  if (kind == BWI_PROJECTED)
    state->shift = 0;
done:
  return status;
}

bw_status bwi_tangent_stiffen(bwi_newton_state *state, bool *stiffer) {
  bw_status status = BW_OK;
  *stiffer = state->iterative && state->tangent == BWI_SHIFTED && GROWTH * state->shift <= 1;
  if (*stiffer) {
    BW_TRY(evaluate(state, false));
    BW_TRY(shift_linear(state, GROWTH * state->shift));
  }
done:
  return status;
}

bw_status bwi_tangent_predict_contact(bwi_newton_state *state, bool *changed, bool *definite) {
  *changed = bwi_contact_predict(state->contact, state->direction, state->solid->pattern,
                                 state->iterative ? NULL : state->newton->stiffness) > 0;
  *definite = true;
  if (state->iterative)
    return *changed
               ? precondition(
                     state, state->tangent == BWI_SHIFTED ? state->shift * mean_diagonal(state) : 0)
               : BW_OK;
  return *changed ? factor(state, definite) : BW_OK;
}

bw_status bwi_tangent_multiply(bwi_newton_state *state, const double *x, double *y) {
  if (!state->iterative)
    return bw_block_multiply(state->context, state->solid->pattern, state->newton->stiffness, 9, 3,
                             1, x, y);
  bw_status status = bw_solid_linear_multiply(state->context, state->newton->linear, x, y);
  if (state->contact)
    bwi_contact_multiply(state->contact, x, y);
  return status;
}

/* d = K^-1 f */
static bw_status solve(bwi_newton_state *state, const double *force, double tolerance,
                       double *displacement, int32_t *iterations) {
  *iterations = 0;
  if (state->iterative) {
    bwi_cg_report report;
    int64_t left;
    bwi_newton_left(state, &left);
    int32_t limit = bwi_choice_limit(state);
    limit = left < limit ? (int32_t)left + 1 : limit;
    double *x = BW_NEW(state->context, double, state->size); /* force may be displacement */
    if (!x)
      return BW_MEMORY;
    bw_status status = bwi_cg_solve(state->context, state->precondition,
                                    state->follows ? 1e-8 : tolerance, limit, force, x, &report);
    state->report->cg_iterations += report.iterations;
    memcpy(displacement, x, (size_t)state->size * sizeof *x);
    bw_free(x);
    state->negative = report.negative;
    if (status == BW_OK && !report.negative)
      bwi_choice_learn(state, report.iterations, report.residual);
    *iterations = report.iterations;
    return status;
  }
  return bwi_direct_solve(state->context, state->newton->direct, force, displacement);
}

/* v = M^-1 (K + K') v0 */
static bw_status exact(bwi_newton_state *state, const double *v0, double tolerance, double *work,
                       double *v, int32_t *iterations) {
  bw_status status = BW_OK;
  int32_t cg;
  if (state->follower)
    BW_TRY(bw_block_multiply(state->context, state->solid->pattern, state->follower, 9, 3, 1, v0,
                             work));
  else
    memset(work, 0, (size_t)state->size * sizeof *work);
  BW_TRY(bwi_load_case_follow_along(state->context, state->load_case, state->now.u, v0,
                                    state->initial_residual ? 1 : state->load, work));
  for (int64_t i = 0; i < state->size; i++)
    if (state->load_case->constrained[i])
      work[i] = 0;
  BW_TRY(solve(state, work, tolerance, work, &cg));
  *iterations += cg;
  for (int64_t i = 0; i < state->size; i++)
    v[i] = v0[i] - work[i];
done:
  return status;
}

/* GMRES without restarts: d holds M^-1 f and becomes the solution. */
static bw_status with_followers(bwi_newton_state *state, double tolerance, double *d,
                                int32_t *iterations) {
  bw_status status = BW_OK;
  int64_t n = state->size;
  double h[BASIS + 1][BASIS], cosine[BASIS], sine[BASIS], right[BASIS + 1] = {0};
  double *basis[BASIS + 1] = {NULL}, *work = BW_NEW(state->context, double, n);
  int used = 0;
  double size = sqrt(bwi_newton_state_dot(state, d, d));
  basis[0] = BW_NEW(state->context, double, n);
  BW_TRY_MEMORY(work && basis[0]);
  if (!(size > 0) || !isfinite(size))
    goto done;
  for (int64_t i = 0; i < n; i++)
    basis[0][i] = d[i] / size;
  right[0] = size;
  while (used < BASIS && fabs(right[used]) > FOLLOWER_TOLERANCE * size) {
    int j = used;
    double *next = basis[j + 1] = BW_NEW(state->context, double, n);
    BW_TRY_MEMORY(next);
    BW_TRY(exact(state, basis[j], tolerance, work, next, iterations));
    for (int i = 0; i <= j; i++) {
      h[i][j] = bwi_newton_state_dot(state, basis[i], next);
      for (int64_t k = 0; k < n; k++)
        next[k] -= h[i][j] * basis[i][k];
    }
    double length = h[j + 1][j] = sqrt(bwi_newton_state_dot(state, next, next));
    for (int i = 0; i < j; i++) {
      double a = h[i][j], b = h[i + 1][j];
      h[i][j] = cosine[i] * a + sine[i] * b;
      h[i + 1][j] = cosine[i] * b - sine[i] * a;
    }
    double r = hypot(h[j][j], h[j + 1][j]);
    if (!(r > 0) || !isfinite(r))
      break;
    cosine[j] = h[j][j] / r;
    sine[j] = h[j + 1][j] / r;
    h[j][j] = r;
    right[j + 1] = -sine[j] * right[j];
    right[j] *= cosine[j];
    used++;
    if (length <= 1e-14 * size || length == 0)
      break;
    for (int64_t k = 0; k < n; k++)
      next[k] /= length;
  }
  for (int i = used - 1; i >= 0; i--) {
    for (int j = i + 1; j < used; j++)
      right[i] -= h[i][j] * right[j];
    right[i] /= h[i][i];
  }
  if (used > 0)
    memset(d, 0, (size_t)n * sizeof *d);
  for (int j = 0; j < used; j++)
    for (int64_t k = 0; k < n; k++)
      d[k] += right[j] * basis[j][k];
done:
  for (int j = 0; j <= BASIS; j++)
    bw_free(basis[j]);
  bw_free(work);
  return status;
}

bw_status bwi_tangent_solve(bwi_newton_state *state, const double *force, double tolerance,
                            double *displacement, int32_t *iterations) {
  bw_status status = BW_OK;
  double before = bw_seconds();
  int32_t cg = 0;
  BW_TRY(solve(state, force, tolerance, displacement, &cg));
  if (state->follows) {
    /* where pressures alone decide, the direction may point up: then without them */
    double down = bwi_newton_state_dot(state, force, displacement);
    double *plain = state->trial.u; /* not in use here */
    memcpy(plain, displacement, (size_t)state->size * sizeof *plain);
    BW_TRY(with_followers(state, tolerance, displacement, &cg));
    double now = bwi_newton_state_dot(state, force, displacement);
    if (down > 0 && !(now > 0))
      memcpy(displacement, plain, (size_t)state->size * sizeof *plain);
  }
  state->report->seconds_solve += bw_seconds() - before;
done:
  if (iterations)
    *iterations = cg;
  return status;
}
