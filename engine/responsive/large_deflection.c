/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sheets with large deflections: St. Venant-Kirchhoff's law S = D E with Green's strain
 * E = (F^T F - 1) / 2, in equilibrium with loads that keep their direction.
 *
 * Equilibrium is a stationary point of the energy W(u) - f . u. Newton's method with a line search
 * on that energy finds it; the tangent is the sum of the material part B^T D B and the part of the
 * stresses, G^T S G. Under compression far from equilibrium the latter can make it indefinite: then
 * the negative part of each S is left out, which keeps the direction one of descent. An inverted
 * element has infinite energy: no step ends with one, neither at the points of quadrature nor at
 * the nodes.
 *
 * While an outline is dragged the start is close, and what costs is tangents and iterations on the
 * old factor. So the start is moved along the last frame's change, as a drag goes on as it went; a
 * tangent is kept for further steps as long as they come closer by a decade each (chord method);
 * and equations are solved no better than the step after them will be, or than the end needs. */
#include <math.h>
#include <string.h>

#include "incremental/lagged_factor.h"
#include "linear/vectors.h"
#include "responsive/large_deflection.h"

void bw_large_deflection_options_default(bw_large_deflection_options *options) {
  *options = (bw_large_deflection_options){.tolerance = 1e-8, .iterations = 30, .load_steps = 64};
  bw_lagged_factor_options_default(&options->linear);
}

/* A tangent is kept after a step that left no more than this of the residual. */
#define KEPT_ABOVE 0.1
/* The last frames' changes are followed where that leaves no more than this of the residual, and
 * without looking for a better point near there, where it leaves no more than that. */
#define FOLLOWED_ABOVE 0.5
#define FOLLOWED_AT_ONCE 0.05

typedef struct newton {
  bw_context *context;
  bw_sheet *sheet;
  struct bwi_sheet *inner;
  bw_sheet_state *next; /* what this makes; its `before` and `former` are still those that stand */
  const bw_large_deflection_options *options;
  bwi_large_deflection bend;
  size_t size;
  double *u, *trial, *step;      /* displacement */
  double *way;                   /* a second direction */
  double *inside, *inside_trial; /* forces inside, at u and at trial */
  bw_plane_reuse *reuse;
  bw_large_deflection_report *report;
  double reached; /* load factor at which all is in equilibrium */
} newton;

/* Forces inside, the energy of the sheet alone and its sum with the load's, at u; INFINITY when an
 * element is inverted. */
static bw_status evaluate(newton *n, const double *u, double *force, double *inside, double *total,
                          double load) {
  bw_status status = BW_OK;
  double work;
  n->bend.u = u;
  BW_TRY(bwi_large_deflection_evaluate(n->context, &n->bend, inside, force));
  BW_TRY(bwi_blocked_dot(n->context, n->size, n->inner->force, u, &work));
  *total = *inside - load * work;
done:
  return status;
}

/* inner->rhs = load f - force, which is that inside at u, at free unknowns, 0 elsewhere; returns
 * its size relative to the largest of load, reactions and a millionth of what the displacement
 * would need as a stretch, which is left where a motion is rigid. */
static double residual(const newton *n, double load, const double *u, const double *force) {
  struct bwi_sheet *inner = n->inner;
  double out = 0, size = 0, reaction = 0, max = 0, stiff = 0;
  for (size_t i = 0; i < n->size; i++) {
    double f = load * inner->force[i], off = f - force[i], square = off * off;
    size += f * f;
    max = u[i] > max ? u[i] : -u[i] > max ? -u[i] : max;
    if (inner->is_prescribed[i])
      reaction += square;
    else
      out += square;
    inner->rhs[i] = inner->is_prescribed[i] ? 0 : off;
  }
  for (int32_t k = 0; k < inner->section_count; k++)
    stiff = fmax(stiff, inner->section[k].elasticity[0] * inner->section[k].thickness);
  max = fmax(fmax(size, reaction), 1e-12 * stiff * stiff * max * max);
  return out > 0 ? sqrt(out / max) : 0;
}

static void swap(double **a, double **b) {
  double *c = *a;
  *a = *b;
  *b = c;
}

static bool all_prescribed(const newton *n, double load) {
  bool all = true;
  for (size_t k = 0; k < n->size && all; k++)
    all = !n->inner->is_prescribed[k] || n->u[k] == load * n->inner->prescribed[k];
  return all;
}

/* The start of a frame, u, moved along the changes of the last frames.
 *
 * First as a drag at constant speed goes on, along the parabola through the last three solutions.
 * Where that is not close, its direction and the last change span a plane in which the point is
 * taken where the residual, linear between those seen, is orthogonal to the plane: speeds differ,
 * and directions turn. What leaves more than half of the residual is not followed. */
static bw_status go_on(newton *n, double load, double *inside, double *total) {
  bw_status status = BW_OK;
  const struct bwi_sheet *inner = n->inner;
  double plain = residual(n, load, n->u, n->inside), relative = INFINITY;
  double there = INFINITY, all = INFINITY, *way[2] = {n->step, n->way};
  double slope[2], by[2][2], factor[2] = {0, 0};
  const double *before = n->next->before, *former = n->next->former;
  int count = former ? 2 : 1;
  if (plain <= n->options->tolerance || !all_prescribed(n, load))
    return BW_OK;
  for (size_t k = 0; k < n->size; k++) {
    double last = inner->is_prescribed[k] ? 0 : n->u[k] - before[k];
    way[count - 1][k] = last;
    if (count == 2)
      way[0][k] = inner->is_prescribed[k] ? 0 : 2 * last - before[k] + former[k];
  }
  for (int w = 0; w < count; w++)
    BW_TRY(bwi_blocked_dot(n->context, n->size, inner->rhs, way[w], &slope[w]));
  for (int w = 0; w <= count && !(relative <= FOLLOWED_AT_ONCE * plain); w++) {
    if (w < count)
      for (size_t k = 0; k < n->size; k++)
        n->trial[k] = n->u[k] + way[w][k];
    else {
      double det = count == 2 ? by[0][0] * by[1][1] - by[0][1] * by[1][0] : by[0][0];
      factor[0] = count == 2 ? (slope[0] * by[1][1] - by[0][1] * slope[1]) / det : slope[0] / det;
      factor[1] = count == 2 ? (by[0][0] * slope[1] - slope[0] * by[1][0]) / det : 0;
      if (!(fabs(factor[0]) + fabs(factor[1]) < 8))
        return BW_OK;
      for (size_t k = 0; k < n->size; k++)
        n->trial[k] = n->u[k] + factor[0] * way[0][k] + factor[1] * way[count - 1][k];
    }
    BW_TRY(evaluate(n, n->trial, n->inside_trial, &there, &all, load));
    relative = isfinite(all) ? residual(n, load, n->trial, n->inside_trial) : INFINITY;
    if (relative == INFINITY)
      return BW_OK;
    for (int v = 0; v < count && w < count; v++) {
      double end;
      BW_TRY(bwi_blocked_dot(n->context, n->size, inner->rhs, way[v], &end));
      by[v][w] = slope[v] - end;
    }
  }
  if (!(relative <= FOLLOWED_ABOVE * plain))
    return BW_OK;
  swap(&n->u, &n->trial);
  swap(&n->inside, &n->inside_trial);
  *inside = there;
  *total = all;
done:
  return status;
}

/* The step from u into n->step, to a relative accuracy; with the matrix as it is, where it is a
 * tangent of this load to be kept. */
static bw_status solve_tangent(newton *n, double load, double accuracy, bool keep) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = n->inner;
  const bw_solver *given = n->options->linear.solver;
  bw_solver kept = {.options = {.kind = BW_SOLVER_PCG, .preconditioner = given}};
  if (given && given->options.kind == BW_SOLVER_PCG)
    kept.options = given->options;
  bw_lagged_factor_options linear = n->options->linear;
  linear.tolerance = fmax(linear.tolerance, accuracy);
  if (keep && given)
    linear.solver = &kept; /* its factor is there */
  n->bend.u = n->u;
  for (int attempt = keep ? 0 : 1; attempt < 3; attempt++) {
    double start = bw_seconds();
    /* prescribed unknowns go from where they are to where they have to be */
    for (size_t i = 0; i < n->size; i++)
      n->step[i] = inner->is_prescribed[i] ? load * inner->prescribed[i] - n->u[i] : 0;
    memcpy(inner->work, inner->rhs, n->size * sizeof(double));
    if (attempt > 0) {
      linear.solver = given;
      n->bend.convex = attempt == 2;
      BW_TRY(bwi_large_deflection_tangent(n->context, &n->bend, inner->pattern, inner->workspace,
                                          inner->matrix));
      BW_TRY(bw_plane_prescribe(n->context, inner->pattern, 2, inner->is_prescribed, n->step,
                                inner->matrix, inner->work));
    }
    n->reuse->seconds_assemble += bw_seconds() - start;
    status = bw_lagged_factor_solve(n->context, inner->lagged, inner->pattern, inner->matrix,
                                    inner->work, n->step, &linear, n->reuse);
    if (status != BW_SINGULAR && status != BW_CONVERGENCE)
      break;
  }
done:
  return status;
}

/* Newton's method at one load. BW_CONVERGENCE where it fails, and n->u is then of no use. */
static bw_status equilibrium(newton *n, double load, bool follow) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = n->inner;
  const double tolerance = n->options->tolerance;
  double relative = INFINITY, inside, total, best = INFINITY;
  bool keep = false; /* the tangent */
  BW_TRY(evaluate(n, n->u, n->inside, &inside, &total, load));
  if (!isfinite(total))
    BW_TRY(bw_fail(n->context, BW_CONVERGENCE, "element %d is inverted before the load acts",
                   n->bend.inverted + 1));
  if (follow)
    BW_TRY(go_on(n, load, &inside, &total));
  for (int i = 0; i < n->options->iterations; i++) {
    BW_TRY(bw_check_cancel(n->context));
    double last = relative;
    bool arrived = all_prescribed(n, load), kept = keep;
    relative = residual(n, load, n->u, n->inside);
    n->report->residual = relative;
    /* the end; or rounding is all that is left, and a new tangent did not make it better */
    if (arrived && (relative <= tolerance || (relative < 1e-6 && relative >= best && !kept))) {
      n->report->energy = inside;
      goto done;
    }
    keep = arrived && i > 0 && relative <= KEPT_ABOVE * last;
    if (relative < 1e-6)
      best = fmin(best, relative);
    n->report->iterations++;
    double accuracy = fmin(1e-2, keep ? relative / last : 0.1 * relative);
    BW_TRY(solve_tangent(n, load, fmax(accuracy, 0.1 * tolerance / relative), keep));
    double slope, length = 1, next_inside = 0, next = 0;
    bool refused = false;
    BW_TRY(bwi_blocked_dot(n->context, n->size, inner->rhs, n->step, &slope));
    /* While prescribed unknowns are on their way energy may well rise: only inversion counts. */
    double rounding = 1e-13 * (fabs(inside) + fabs(total - inside));
    for (;; length *= 0.5) {
      if (length < 1.0 / 4096) {
        status = bw_fail(n->context, BW_CONVERGENCE,
                         "Newton's method found no step that lowers the energy without inverting "
                         "element %d",
                         n->bend.inverted + 1);
        bw_detail_number(n->context, "element", n->bend.inverted + 1);
        goto done;
      }
      for (size_t k = 0; k < n->size; k++)
        n->trial[k] = length == 1 && inner->is_prescribed[k] ? load * inner->prescribed[k]
                                                             : n->u[k] + length * n->step[k];
      BW_TRY(evaluate(n, n->trial, n->inside_trial, &next_inside, &next, load));
      if (isfinite(next) && (!arrived || next <= total - 1e-4 * length * fmax(slope, 0) + rounding))
        break;
      if (keep) { /* a new tangent first */
        refused = true;
        break;
      }
    }
    if (refused)
      continue;
    swap(&n->u, &n->trial);
    swap(&n->inside, &n->inside_trial);
    inside = next_inside;
    total = next;
  }
  status = bw_fail(
      n->context, BW_CONVERGENCE,
      "Newton's method reached a relative residual of %.3g in %d iterations; %.3g was requested",
      relative, n->options->iterations, tolerance);
done:
  return status;
}

static bool is_not_converged(bw_status status) {
  return status == BW_CONVERGENCE || status == BW_SINGULAR;
}

/* The load in steps from nothing, as large as they succeed. */
static bw_status in_steps(newton *n) {
  bw_status status = BW_OK;
  double *good = BW_NEW0(n->context, double, n->size), increment = 0.5;
  if (!good)
    return BW_MEMORY;
  while (n->reached < 1) {
    double load = fmin(1, n->reached + increment);
    if (n->report->load_steps >= n->options->load_steps || increment < 1e-4) {
      status = bw_fail(n->context, BW_CONVERGENCE,
                       "the load continuation of the sheet stopped at %.3g of its load after %d "
                       "load steps: it snaps through or folds there, or an element (%d) inverts; "
                       "refine the mesh or lower the load",
                       n->reached, n->report->load_steps, n->bend.inverted + 1);
      bw_detail_number(n->context, "load", n->reached);
      goto done;
    }
    memcpy(n->u, good, n->size * sizeof(double));
    n->report->load_steps++;
    status = equilibrium(n, load, false);
    if (status != BW_OK && !is_not_converged(status))
      goto done;
    if (status == BW_OK) {
      memcpy(good, n->u, n->size * sizeof(double));
      n->reached = load;
      increment *= 1.5;
    } else
      increment *= 0.4;
    bw_progress(n->context, "load steps", n->reached);
  }
  status = BW_OK;
done:
  bw_free(good);
  return status;
}

/* The displacement, about to be replaced by the next, as the one before it. */
static bw_status remember(newton *n) {
  bw_sheet_state *next = n->next;
  if (!next->solved)
    return BW_OK;
  double **oldest = next->before ? &next->former : &next->before;
  if (!*oldest && !(*oldest = BW_NEW(n->context, double, n->size)))
    return BW_MEMORY;
  memcpy(*oldest, n->sheet->displacement, n->size * sizeof(double));
  if (oldest == &next->former)
    swap(&next->former, &next->before);
  return BW_OK;
}

bw_status bw_sheet_large_deflection(bw_context *context, bw_sheet *sheet,
                                    const bw_large_deflection_options *options,
                                    bw_large_deflection_report *report, bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  bw_large_deflection_options defaults;
  bw_plane_reuse ignored = {0};
  bw_large_deflection_report unread;
  newton n = {.context = context, .sheet = sheet, .inner = inner};
  double *workspace = NULL;
  bool made;
  bw_large_deflection_options_default(&defaults);
  n.options = options ? options : &defaults;
  n.reuse = bwi_reuse_of(reuse, &ignored);
  n.report = report ? report : &unread;
  *n.report = (bw_large_deflection_report){0};
  if (!(n.options->tolerance > 0) || n.options->iterations < 1 || n.options->load_steps < 1)
    return bw_fail(context, BW_INVALID,
                   "Newton's method with tolerance %g, %d iterations, %d load steps: all above 0 "
                   "expected",
                   n.options->tolerance, n.options->iterations, n.options->load_steps);
  BW_TRY(bwi_sheet_next(context, sheet, sheet->mesh, true, &n.next));
  BW_TRY(bwi_sheet_prepare(context, sheet, &made));
  n.reuse->pattern = !made;
  n.reuse->solution = n.next->solved;
  n.size = 2 * (size_t)inner->pattern->node_count;
  workspace = BW_NEW(context, double, 6 * n.size);
  BW_TRY_MEMORY(workspace);
  n.u = workspace;
  n.trial = workspace + n.size;
  n.step = workspace + 2 * n.size;
  n.inside = workspace + 3 * n.size;
  n.inside_trial = workspace + 4 * n.size;
  n.way = workspace + 5 * n.size;
  BW_TRY(bwi_large_deflection_prepare(context, sheet, &n.bend));
  BW_TRY(bwi_sheet_prescribe(context, sheet, sheet->time));
  if (!inner->prescribed_checked)
    BW_TRY(bwi_sheet_check_constraints(context, sheet));
  inner->prescribed_checked = true;
  BW_TRY(bwi_sheet_force(context, sheet, sheet->time));
  inner->matrix_step[0] = 0; /* the matrix is used for tangents */
  memcpy(n.u, sheet->displacement, n.size * sizeof(double));
  n.report->load_steps = 1;
  status = equilibrium(&n, 1, n.next->before && n.next->solved && n.next->large);
  if (is_not_converged(status)) {
    n.report->load_steps = 0;
    status = in_steps(&n);
  }
  if (status != BW_OK)
    goto done;
  BW_TRY(remember(&n));
  memcpy(n.next->displacement, n.u, n.size * sizeof(double));
  n.next->solved = n.next->large = true;
  n.next->moving = n.next->statics = false;
  BW_TRY(bwi_sheet_commit(context, sheet, n.next));
done:
  bw_release(n.next);
  bwi_large_deflection_clear(&n.bend);
  bw_free(workspace);
  return status;
}
