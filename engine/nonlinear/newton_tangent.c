/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The tangent of a solid under a case, and solving with it.
 *
 * Contact adds entries inside elements, so the solid's graph serves. Follower pressures add a part
 * K' that is not symmetric and goes beyond the graph; its symmetric part S within the graph goes
 * into the factor, of M = K + S. GMRES on M^-1 (K + K') = 1 - M^-1 (S - K') then solves with the
 * exact tangent: a few solutions with the factor instead of a larger and unsymmetric one. */
#include "nonlinear/internal.h"
#include "nonlinear/newton.h"

#include <math.h>
#include <string.h>

enum { BASIS = 40 };
#define GROWTH 5 /* of shifts that are not enough */
#define FOLLOWER_TOLERANCE 1e-6

static bw_status make_room(bwi_walk *walk) {
  bw_newton *newton = walk->newton;
  int64_t pairs = walk->solid->graph->pair_count;
  if (newton->pairs == pairs)
    return BW_OK;
  bw_free(newton->stiffness);
  newton->pairs = 0;
  newton->stiffness = BW_NEW(walk->context, double, 9 * pairs);
  if (!newton->stiffness)
    return BW_MEMORY;
  newton->pairs = pairs;
  return BW_OK;
}

static bw_status linearise(bwi_walk *walk, bool project) {
  bw_status status = BW_OK;
  bw_newton *newton = walk->newton;
  double before = bw_seconds();
  if (newton->linear_of != walk->solid) {
    bw_solid_linear_free(newton->linear);
    bw_release(newton->linear_of);
    newton->linear = NULL;
    newton->linear_of = NULL;
    BW_TRY(bw_solid_linear_create(walk->context, walk->solid, &newton->linear));
    newton->linear_of = (const bw_solid *)bw_retain(walk->solid);
  }
  BW_TRY(bw_solid_linear_set(walk->context, newton->linear, walk->now.u, project));
  if (walk->quadratic)
    BW_TRY(bwi_solid_linear_add(walk->context, newton->linear, walk->quadratic->of_mass,
                                walk->quadratic->linear, walk->quadratic->of_stiffness));
  BW_TRY(bw_solid_linear_diagonal(walk->context, newton->linear, walk->blocks));
  walk->report->evaluations++;
  walk->report->seconds_quadrature += bw_seconds() - before;
done:
  return status;
}

static double mean_diagonal(const bwi_walk *walk) {
  double mean = 0;
  for (int64_t i = 0; i < walk->size; i++)
    mean += walk->blocks[3 * i + i % 3] / (double)walk->size;
  return mean;
}

/* The preconditioner for what is linearised, with `shift` on the diagonal, and the points that
 * push. */
static bw_status precondition(bwi_walk *walk, double shift) {
  bw_status status = BW_OK;
  double before = bw_seconds();
  int factorisations = 0;
  double *shifted = NULL; /* the walk's own blocks say how large forces are */
  if (!walk->precondition)
    BW_TRY(bwi_precondition_create(walk->context, walk->solid, walk->the->held, walk->options,
                                   walk->contact, &walk->precondition));
  factorisations = bwi_precondition_factorisations(walk->precondition);
  if (shift > 0) {
    shifted = BW_NEW(walk->context, double, 3 * walk->size);
    if (!shifted)
      return BW_MEMORY;
    memcpy(shifted, walk->blocks, 3 * (size_t)walk->size * sizeof *shifted);
    for (int64_t i = 0; i < walk->size; i++)
      shifted[3 * i + i % 3] += shift;
  }
  BW_TRY(bwi_precondition_set(walk->context, walk->precondition, walk->newton->linear, walk->now.u,
                              shifted ? shifted : walk->blocks));
  walk->report->seconds_factor += bw_seconds() - before;
  walk->report->factorisations +=
      bwi_precondition_factorisations(walk->precondition) - factorisations;
done:
  bw_free(shifted);
  return status;
}

static bw_status evaluate(bwi_walk *walk, bool project) {
  bw_status status = BW_OK;
  if (walk->iterative) {
    if (project || !walk->fresh)
      BW_TRY(linearise(walk, project));
    walk->fresh = !project;
    goto done;
  }
  const bw_graph *graph = walk->solid->graph;
  double before = bw_seconds();
  bw_solid_shape shape;
  BW_TRY(make_room(walk));
  if (project || !walk->fresh) {
    BW_TRY(bw_solid_evaluate(walk->context, walk->solid, walk->now.u, project, NULL, NULL,
                             walk->newton->stiffness, &shape));
    walk->report->evaluations++;
    walk->report->seconds_quadrature += bw_seconds() - before;
  }
  walk->fresh = !project;
  for (int64_t n = 0; n < graph->node_count; n++)
    memcpy(walk->blocks + 9 * n, walk->newton->stiffness + 9 * (graph->start[n + 1] - 1),
           9 * sizeof(double));
done:
  return status;
}

bw_status bwi_tangent_blocks(bwi_walk *walk) {
  return evaluate(walk, false);
}

static bw_status factor(bwi_walk *walk, bool *definite) {
  const bw_graph *graph = walk->solid->graph;
  bw_newton *newton = walk->newton;
  double before = bw_seconds();
  walk->report->analyses += !bwi_direct_keeps(newton->direct, graph, walk->the->held);
  bw_status status = bwi_direct_analyse(walk->context, newton->direct, graph, walk->the->held);
  double between = bw_seconds();
  walk->report->seconds_analysis += between - before;
  if (status == BW_OK)
    status = bwi_direct_factor(walk->context, newton->direct, graph, walk->the->held,
                               newton->stiffness, definite, NULL);
  walk->report->seconds_factor += bw_seconds() - between;
  walk->report->factorisations++;
  return status;
}

/* Add to the diagonal, `part` of its mean and then more and more, until the matrix is definite. A
 * step then is between Newton's and one along the residual, and goes down in any case. */
static bw_status factor_shifted(bwi_walk *walk, double part, double growth, bool *definite) {
  bw_status status = BW_OK;
  const bw_graph *graph = walk->solid->graph;
  double mean = mean_diagonal(walk), shift = 0;
  walk->fresh = false;
  walk->shift = 0;
  for (; part <= 1 && !*definite && mean > 0; part *= growth) {
    for (int64_t n = 0; n < graph->node_count; n++)
      for (int c = 0; c < 3; c++)
        walk->newton->stiffness[9 * (graph->start[n + 1] - 1) + 4 * c] += part * mean - shift;
    shift = part * mean;
    walk->shift = part;
    BW_TRY(factor(walk, definite));
  }
done:
  return status;
}

/* `part` of the diagonal's mean on the diagonal of the plain tangent that is linearised. */
static bw_status shift_linear(bwi_walk *walk, double part) {
  bw_status status = BW_OK;
  double value = part * mean_diagonal(walk);
  walk->fresh = false;
  walk->shift = part;
  BW_TRY(bwi_solid_linear_shift(walk->context, walk->newton->linear, value));
  BW_TRY(precondition(walk, value));
done:
  return status;
}

/* After a whole step, shifts begin well below the last that was enough, so that they end where none
 * is needed; after a short one above it, as where to go is seen no further than that. */
#define FIRST_SHIFT 1e-3
#define LEAST_SHIFT 1e-7
/* Projected tangents with followers, or of a solid that floors alone hold, may need one too. */
#define LEAST_LIFT 1e-9
#define LIFT_GROWTH 30

bw_status bwi_tangent_set(bwi_walk *walk, bwi_tangent kind, bool *definite) {
  bw_status status = BW_OK;
  double change = walk->step >= 1 ? 0.2 : walk->step > 0.5 ? 1 : 4;
  double shift = walk->shift > 0 ? fmin(0.3, fmax(LEAST_SHIFT, change * walk->shift)) : FIRST_SHIFT;
  *definite = false;
  walk->tangent = kind;
  walk->have_tangent = true;
  if (walk->iterative) { /* what is not definite shows when it is solved with */
    BW_TRY(evaluate(walk, kind == BWI_PROJECTED));
    walk->shift = kind == BWI_PROJECTED ? 0 : walk->shift;
    if (kind == BWI_SHIFTED)
      BW_TRY(shift_linear(walk, shift));
    else
      BW_TRY(precondition(walk, 0));
    *definite = true;
    goto done;
  }
  BW_TRY(evaluate(walk, kind == BWI_PROJECTED));
  if (walk->quadratic) {
    bwi_quadratic_stiffness(walk);
    walk->fresh = false;
  }
  if (walk->contact) {
    bwi_contact_stiffness(walk->contact, walk->solid->graph, walk->newton->stiffness);
    walk->fresh = false;
  }
  if (walk->follows) {
    size_t size = 9 * (size_t)walk->solid->graph->pair_count;
    memset(walk->follower, 0, size * sizeof(double));
    BW_TRY(bwi_case_follow_stiffness(walk->context, walk->the, walk->now.u,
                                     walk->fade ? 1 : walk->load, walk->solid->graph,
                                     walk->follower));
    for (size_t i = 0; i < size; i++)
      walk->newton->stiffness[i] += walk->follower[i];
    walk->fresh = false;
  }
  if (kind == BWI_SHIFTED) {
    BW_TRY(factor_shifted(walk, shift, GROWTH, definite));
    goto done;
  }
  double lift = kind == BWI_PROJECTED ? walk->lift / LIFT_GROWTH : 0;
  if (lift < LEAST_LIFT)
    BW_TRY(factor(walk, definite));
  walk->lift = 0;
  if (kind == BWI_PROJECTED && !*definite) {
    BW_TRY(factor_shifted(walk, fmax(lift, LEAST_LIFT), LIFT_GROWTH, definite));
    walk->lift = walk->shift;
  }
  if (kind == BWI_PROJECTED)
    walk->shift = 0;
done:
  return status;
}

bw_status bwi_tangent_stiffen(bwi_walk *walk, bool *stiffer) {
  bw_status status = BW_OK;
  *stiffer = walk->iterative && walk->tangent == BWI_SHIFTED && GROWTH * walk->shift <= 1;
  if (*stiffer) {
    BW_TRY(evaluate(walk, false));
    BW_TRY(shift_linear(walk, GROWTH * walk->shift));
  }
done:
  return status;
}

bw_status bwi_tangent_foresee(bwi_walk *walk, bool *changed, bool *definite) {
  *changed = bwi_contact_foresee(walk->contact, walk->direction, walk->solid->graph,
                                 walk->iterative ? NULL : walk->newton->stiffness) > 0;
  *definite = true;
  if (walk->iterative)
    return *changed
               ? precondition(walk,
                              walk->tangent == BWI_SHIFTED ? walk->shift * mean_diagonal(walk) : 0)
               : BW_OK;
  return *changed ? factor(walk, definite) : BW_OK;
}

bw_status bwi_tangent_multiply(bwi_walk *walk, const double *x, double *y) {
  if (!walk->iterative)
    return bw_graph_multiply(walk->context, walk->solid->graph, walk->newton->stiffness, 9, 3, 1, x,
                             y);
  bw_status status = bw_solid_linear_multiply(walk->context, walk->newton->linear, x, y);
  if (walk->contact)
    bwi_contact_multiply(walk->contact, x, y);
  return status;
}

/* d = K^-1 f */
static bw_status solve(bwi_walk *walk, const double *force, double tolerance, double *displacement,
                       int32_t *iterations) {
  *iterations = 0;
  if (walk->iterative) {
    bwi_cg_report report;
    int64_t left;
    bwi_newton_left(walk, &left);
    int32_t limit = bwi_choice_limit(walk);
    limit = left < limit ? (int32_t)left + 1 : limit;
    double *x = BW_NEW(walk->context, double, walk->size); /* force may be displacement */
    if (!x)
      return BW_MEMORY;
    bw_status status = bwi_cg_solve(walk->context, walk->precondition,
                                    walk->follows ? 1e-8 : tolerance, limit, force, x, &report);
    walk->report->cg_iterations += report.iterations;
    memcpy(displacement, x, (size_t)walk->size * sizeof *x);
    bw_free(x);
    walk->negative = report.negative;
    if (status == BW_OK && !report.negative)
      bwi_choice_learn(walk, report.iterations, report.residual);
    *iterations = report.iterations;
    return status;
  }
  return bwi_direct_solve(walk->context, walk->newton->direct, force, displacement);
}

/* v = M^-1 (K + K') v0 */
static bw_status exact(bwi_walk *walk, const double *v0, double tolerance, double *work, double *v,
                       int32_t *iterations) {
  bw_status status = BW_OK;
  int32_t cg;
  if (walk->follower)
    BW_TRY(bw_graph_multiply(walk->context, walk->solid->graph, walk->follower, 9, 3, 1, v0, work));
  else
    memset(work, 0, (size_t)walk->size * sizeof *work);
  BW_TRY(bwi_case_follow_along(walk->context, walk->the, walk->now.u, v0,
                               walk->fade ? 1 : walk->load, work));
  for (int64_t i = 0; i < walk->size; i++)
    if (walk->the->held[i])
      work[i] = 0;
  BW_TRY(solve(walk, work, tolerance, work, &cg));
  *iterations += cg;
  for (int64_t i = 0; i < walk->size; i++)
    v[i] = v0[i] - work[i];
done:
  return status;
}

/* GMRES without restarts: d holds M^-1 f and becomes the solution. */
static bw_status with_followers(bwi_walk *walk, double tolerance, double *d, int32_t *iterations) {
  bw_status status = BW_OK;
  int64_t n = walk->size;
  double h[BASIS + 1][BASIS], cosine[BASIS], sine[BASIS], right[BASIS + 1] = {0};
  double *basis[BASIS + 1] = {NULL}, *work = BW_NEW(walk->context, double, n);
  int used = 0;
  double size = sqrt(bwi_walk_dot(walk, d, d));
  basis[0] = BW_NEW(walk->context, double, n);
  if (!work || !basis[0]) {
    status = BW_MEMORY;
    goto done;
  }
  if (!(size > 0) || !isfinite(size))
    goto done;
  for (int64_t i = 0; i < n; i++)
    basis[0][i] = d[i] / size;
  right[0] = size;
  while (used < BASIS && fabs(right[used]) > FOLLOWER_TOLERANCE * size) {
    int j = used;
    double *next = basis[j + 1] = BW_NEW(walk->context, double, n);
    if (!next) {
      status = BW_MEMORY;
      goto done;
    }
    BW_TRY(exact(walk, basis[j], tolerance, work, next, iterations));
    for (int i = 0; i <= j; i++) {
      h[i][j] = bwi_walk_dot(walk, basis[i], next);
      for (int64_t k = 0; k < n; k++)
        next[k] -= h[i][j] * basis[i][k];
    }
    double length = h[j + 1][j] = sqrt(bwi_walk_dot(walk, next, next));
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

bw_status bwi_tangent_solve(bwi_walk *walk, const double *force, double tolerance,
                            double *displacement, int32_t *iterations) {
  bw_status status = BW_OK;
  double before = bw_seconds();
  int32_t cg = 0;
  BW_TRY(solve(walk, force, tolerance, displacement, &cg));
  if (walk->follows) {
    /* where pressures alone decide, the direction may point up: then without them */
    double down = bwi_walk_dot(walk, force, displacement);
    double *plain = walk->trial.u; /* not in use here */
    memcpy(plain, displacement, (size_t)walk->size * sizeof *plain);
    BW_TRY(with_followers(walk, tolerance, displacement, &cg));
    double now = bwi_walk_dot(walk, force, displacement);
    if (down > 0 && !(now > 0))
      memcpy(displacement, plain, (size_t)walk->size * sizeof *plain);
  }
  walk->report->seconds_solve += bw_seconds() - before;
done:
  if (iterations)
    *iterations = cg;
  return status;
}
