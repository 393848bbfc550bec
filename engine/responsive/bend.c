/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sheets that bend largely: St. Venant-Kirchhoff's law S = D E with Green's strain
 * E = (F^T F - 1) / 2, in equilibrium with loads that keep their direction.
 *
 * Equilibrium is a stationary point of the energy W(u) - f . u. Newton's method with a line search
 * on that energy finds it; the tangent is the sum of the material part B^T D B and the part of the
 * stresses, G^T S G. Under compression far from equilibrium the latter can make it indefinite: then
 * the negative part of each S is left out, which keeps the direction one of descent. An inverted
 * element has infinite energy: no step ends with one, neither at the points of quadrature nor at
 * the nodes. */
#include <math.h>
#include <string.h>

#include "responsive/bend.h"
#include "responsive/vectors.h"

void bw_bend_options_default(bw_bend_options *options) {
  *options = (bw_bend_options){.tolerance = 1e-8, .iterations = 30, .load_steps = 64};
  bw_stale_options_default(&options->linear);
}

typedef struct newton {
  bw_context *context;
  bw_sheet *sheet;
  struct bwi_sheet *inner;
  const bw_bend_options *options;
  bwi_bend bend;
  size_t size;
  double *u, *trial, *step, *inside; /* displacement; forces inside */
  bw_kept *kept;
  bw_bend_report *report;
  double reached; /* load factor at which all is in equilibrium */
} newton;

/* Energy of the sheet alone and its product with the load; INFINITY when an element is inverted. */
static bw_status energy(newton *n, const double *u, double *inside, double *total, double load) {
  bw_status status = BW_OK;
  double work;
  n->bend.u = u;
  BW_TRY(bwi_bend_energy(n->context, &n->bend, inside));
  BW_TRY(bwi_dot(n->context, n->size, n->inner->force, u, &work));
  *total = *inside - load * work;
done:
  return status;
}

/* inner->rhs = load f - inside(u) at free unknowns, 0 elsewhere; *relative to the largest of load,
 * reactions and a millionth of what the displacement would need as a stretch, which is left where a
 * motion is rigid. */
static bw_status residual(newton *n, double load, double *relative) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = n->inner;
  double out = 0, size = 0, reaction = 0, most = 0, stiff = 0;
  n->bend.u = n->u;
  BW_TRY(bwi_bend_force(n->context, &n->bend, n->inside));
  for (size_t i = 0; i < n->size; i++) {
    double f = load * inner->force[i];
    inner->rhs[i] = inner->held[i] ? 0 : f - n->inside[i];
    out += inner->rhs[i] * inner->rhs[i];
    size += f * f;
    if (inner->held[i])
      reaction += (n->inside[i] - f) * (n->inside[i] - f);
    most = fmax(most, fabs(n->u[i]));
  }
  for (int32_t k = 0; k < inner->section_count; k++)
    stiff = fmax(stiff, inner->section[k].elasticity[0] * inner->section[k].thickness);
  most = fmax(fmax(size, reaction), 1e-12 * stiff * stiff * most * most);
  *relative = out > 0 ? sqrt(out / most) : 0;
done:
  return status;
}

/* The Newton step into n->step. */
static bw_status solve_tangent(newton *n, double load, double relative) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = n->inner;
  bw_stale_options linear = n->options->linear;
  /* no more digits than Newton's next step will have */
  linear.tolerance = fmax(linear.tolerance, fmin(1e-2, 0.1 * relative));
  for (int convex = 0; convex < 2; convex++) {
    double start = bw_seconds();
    n->bend.convex = convex == 1;
    BW_TRY(bwi_bend_tangent(n->context, &n->bend, inner->graph, inner->room, inner->matrix));
    /* held unknowns go from where they are to where they have to be */
    for (size_t i = 0; i < n->size; i++)
      n->step[i] = inner->held[i] ? load * inner->prescribed[i] - n->u[i] : 0;
    memcpy(inner->work, inner->rhs, n->size * sizeof(double));
    BW_TRY(bw_plane_prescribe(n->context, inner->graph, 2, inner->held, n->step, inner->matrix,
                              inner->work));
    n->kept->seconds_assemble += bw_seconds() - start;
    status = bw_stale_solve(n->context, inner->stale, inner->graph, inner->matrix, inner->work,
                            n->step, &linear, n->kept);
    if (status != BW_SINGULAR && status != BW_CONVERGENCE)
      break;
  }
done:
  return status;
}

/* Newton's method at one load. BW_CONVERGENCE where it fails, and n->u is then of no use. */
static bw_status equilibrium(newton *n, double load) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = n->inner;
  double relative = INFINITY, inside, total, best = INFINITY;
  BW_TRY(energy(n, n->u, &inside, &total, load));
  if (!isfinite(total)) {
    status = bw_fail(n->context, BW_CONVERGENCE, "element %d is inverted before the load acts",
                     n->bend.inverted + 1);
    goto done;
  }
  for (int i = 0; i < n->options->iterations; i++) {
    bool held = true;
    BW_TRY(bw_check_cancel(n->context));
    BW_TRY(residual(n, load, &relative));
    for (size_t k = 0; k < n->size && held; k++)
      held = !inner->held[k] || n->u[k] == load * inner->prescribed[k];
    n->report->residual = relative;
    /* the end; or rounding is all that is left, and it did not get better any more */
    if (held && (relative <= n->options->tolerance || (relative < 1e-6 && relative >= best))) {
      n->report->energy = inside;
      goto done;
    }
    if (relative < 1e-6)
      best = relative;
    n->report->iterations++;
    BW_TRY(solve_tangent(n, load, relative));
    double slope, length = 1, next_inside = 0, next = 0;
    BW_TRY(bwi_dot(n->context, n->size, inner->rhs, n->step, &slope));
    /* With held unknowns on their way the energy may well rise: only inversion is looked at. */
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
        n->trial[k] = length == 1 && inner->held[k] ? load * inner->prescribed[k]
                                                    : n->u[k] + length * n->step[k];
      BW_TRY(energy(n, n->trial, &next_inside, &next, load));
      if (isfinite(next) && (!held || next <= total - 1e-4 * length * fmax(slope, 0) + rounding))
        break;
    }
    double *swap = n->u;
    n->u = n->trial;
    n->trial = swap;
    inside = next_inside;
    total = next;
  }
  status = bw_fail(n->context, BW_CONVERGENCE,
                   "Newton's method came to a relative residual of %.3g in %d iterations; %.3g was "
                   "wanted",
                   relative, n->options->iterations, n->options->tolerance);
done:
  return status;
}

static bool gave_up(bw_status status) {
  return status == BW_CONVERGENCE || status == BW_SINGULAR;
}

/* The load in steps from nothing, as large as they succeed. */
static bw_status in_steps(newton *n) {
  bw_status status = BW_OK;
  double *good = BW_NEW0(n->context, double, n->size), share = 0.5;
  if (!good)
    return BW_MEMORY;
  while (n->reached < 1) {
    double load = fmin(1, n->reached + share);
    if (n->report->load_steps >= n->options->load_steps || share < 1e-4) {
      status = bw_fail(n->context, BW_CONVERGENCE,
                       "the sheet was followed to %.3g of its load in %d load steps and not "
                       "further: it snaps or folds there, or an element (%d) inverts; refine the "
                       "mesh or lower the load",
                       n->reached, n->report->load_steps, n->bend.inverted + 1);
      bw_detail_number(n->context, "load", n->reached);
      goto done;
    }
    memcpy(n->u, good, n->size * sizeof(double));
    n->report->load_steps++;
    status = equilibrium(n, load);
    if (status != BW_OK && !gave_up(status))
      goto done;
    if (status == BW_OK) {
      memcpy(good, n->u, n->size * sizeof(double));
      n->reached = load;
      share *= 1.5;
    } else
      share *= 0.4;
    bw_progress(n->context, "load", n->reached);
  }
  status = BW_OK;
done:
  bw_free(good);
  return status;
}

bw_status bw_sheet_bend(bw_context *context, bw_sheet *sheet, const bw_bend_options *options,
                        bw_bend_report *report, bw_kept *kept) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  bw_bend_options defaults;
  bw_kept ignored = {0};
  bw_bend_report unread;
  newton n = {.context = context, .sheet = sheet, .inner = inner};
  double *room = NULL;
  bool made;
  bw_bend_options_default(&defaults);
  n.options = options ? options : &defaults;
  n.kept = kept ? kept : &ignored;
  n.report = report ? report : &unread;
  *n.report = (bw_bend_report){0};
  if (!(n.options->tolerance > 0) || n.options->iterations < 1 || n.options->load_steps < 1)
    return bw_fail(context, BW_INVALID,
                   "Newton's method with tolerance %g, %d iterations, %d load steps: all have to "
                   "be positive",
                   n.options->tolerance, n.options->iterations, n.options->load_steps);
  BW_TRY(bwi_sheet_prepare(context, sheet, &made));
  n.kept->pattern = !made;
  n.kept->solution = inner->solved;
  n.size = 2 * (size_t)inner->graph->node_count;
  room = BW_NEW(context, double, 4 * n.size);
  if (!room) {
    status = BW_MEMORY;
    goto done;
  }
  n.u = room;
  n.trial = room + n.size;
  n.step = room + 2 * n.size;
  n.inside = room + 3 * n.size;
  BW_TRY(bwi_bend_prepare(context, sheet, &n.bend));
  BW_TRY(bwi_sheet_hold(context, sheet, sheet->time));
  if (!inner->held_checked)
    BW_TRY(bwi_sheet_check_free(context, sheet));
  inner->held_checked = true;
  BW_TRY(bwi_sheet_force(context, sheet, sheet->time));
  inner->matrix_step[0] = 0; /* the matrix is used for tangents */
  memcpy(n.u, sheet->displacement, n.size * sizeof(double));
  n.report->load_steps = 1;
  status = equilibrium(&n, 1);
  if (gave_up(status)) {
    n.report->load_steps = 0;
    status = in_steps(&n);
  }
  if (status != BW_OK)
    goto done;
  memcpy(sheet->displacement, n.u, n.size * sizeof(double));
  inner->solved = inner->large = true;
  inner->moving = false;
  sheet->object.revision++;
done:
  bwi_bend_clear(&n.bend);
  bw_free(room);
  return status;
}
