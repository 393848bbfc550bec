/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Time steps and steady states. A step is linear in the new state: the velocity that carries is
 * extrapolated from the two states before (second order, like the scheme), or improved by a few
 * rounds. The steady state is found by Newton's method after a few rounds of Picard's; where that
 * does not converge, by implicit steps of a length that grows as the residual falls. */
#include <math.h>
#include <string.h>

#include "flow/internal.h"
#include "incremental/lagged_factor.h"
#include "responsive/internal.h"

enum {
  PICARD = 3,
  LOST = 12 /* rounds after which a change of half the state says that they lead nowhere */
};

void bw_flow_options_default(bw_flow_options *options) {
  *options = (bw_flow_options){.bdf = 2, .tolerance = 1e-8};
  bw_lagged_factor_options_default(&options->linear);
  options->linear.tolerance = 1e-6;
}

/* ---- one linear problem -------------------------------------------------------------------- */

typedef struct assembly {
  bw_context *context;
  const bwi_linear *linear;
  double *vector; /* of all elements */
} assembly;

static bw_status fail_inverted(const assembly *a, int32_t element) {
  const bw_plane_mesh *mesh = a->linear->mesh;
  const double *x = mesh->point + 2 * (int64_t)mesh->topology->element[3 * (int64_t)element];
  bw_status status = bw_fail(a->context, BW_GEOMETRY, "element %d near (%g, %g) m is inverted",
                             element + 1, x[0], x[1]);
  bw_detail_number(a->context, "element", element + 1);
  return status;
}

/* And the element's right-hand side. */
static bw_status matrix_of(void *data, int32_t element, double *matrix) {
  const assembly *a = data;
  bwi_flow_element e;
  if (!bwi_flow_element_make(a->linear, element, &e))
    return fail_inverted(a, element);
  bwi_flow_element_matrix(a->linear, &e, matrix);
  bwi_flow_element_vector(a->linear, element, &e,
                          a->vector + 3 * (int64_t)a->linear->components * element);
  return BW_OK;
}

static bw_status assemble(bw_context *context, bw_flow *flow, const bwi_linear *linear) {
  bwi_flow_workspace *workspace = &flow->inner->workspace;
  const bw_plane_topology *topology = flow->mesh->topology;
  assembly data = {context, linear, workspace->vector};
  int c = flow->components;
  bw_status status = bwi_plane_assemble(context, flow->inner->now->pattern, c, matrix_of, &data,
                                        workspace->block, workspace->values);
  memset(workspace->load, 0,
         (size_t)topology->nodes->node_count * (size_t)c * sizeof *workspace->load);
  for (int64_t k = 0; k < topology->element_count; k++)
    for (int i = 0; i < 3; i++)
      for (int d = 0; d < c; d++)
        workspace->load[c * (int64_t)topology->element[3 * k + i] + d] +=
            workspace->vector[c * (3 * k + i) + d];
  return status;
}

/* Whether fluid can leave nowhere, and no pressure is given: then it is determined up to a
 * constant. */
static bool is_enclosed(const bw_flow *flow) {
  const bw_plane_topology *topology = flow->mesh->topology;
  const uint8_t *is_prescribed = flow->inner->workspace.is_prescribed;
  int c = flow->components;
  for (int64_t i = 0; i < topology->nodes->node_count; i++)
    if (is_prescribed[c * i + 2])
      return false;
  for (int64_t k = 0; k < topology->side_count; k++) {
    if (topology->side_element[2 * k + 1] >= 0)
      continue;
    for (int end = 0; end < 2; end++) {
      int64_t node = topology->side[2 * k + end];
      if (!is_prescribed[c * node] || !is_prescribed[c * node + 1])
        return false;
    }
  }
  return true;
}

/* Pressure less its mean over the area. */
static void center_pressure(const bw_flow *flow, double *state) {
  const bw_plane_topology *topology = flow->mesh->topology;
  const double *x = flow->mesh->point;
  int c = flow->components;
  double area = 0, sum = 0;
  for (int64_t k = 0; k < topology->element_count; k++) {
    const int32_t *node = topology->element + 3 * k;
    const double *p = x + 2 * (int64_t)node[0], *q = x + 2 * (int64_t)node[1],
                 *r = x + 2 * (int64_t)node[2];
    double twice = (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
    area += 3 * twice;
    for (int i = 0; i < 3; i++)
      sum += twice * state[c * (int64_t)node[i] + 2];
  }
  for (int64_t i = 0; i < topology->nodes->node_count; i++)
    state[c * i + 2] -= sum / area;
}

/* The residual that ends an iteration is one number for equations of different units. Rows are
 * multiplied so that each kind counts alike: those of continuity by what makes its diagonal as
 * large as that of momentum, those of heat so that its right-hand side is. (What a row is
 * multiplied by does not change the solution.) */
static void balance(const bw_flow *flow) {
  const bw_plane_pattern *pattern = flow->inner->now->pattern;
  const bwi_flow_workspace *workspace = &flow->inner->workspace;
  int c = flow->components;
  double diagonal[BWI_FLOW_UNKNOWNS] = {0}, right[BWI_FLOW_UNKNOWNS] = {0},
         by[BWI_FLOW_UNKNOWNS] = {1, 1, 1, 1};
  for (int64_t i = 0; i < pattern->node_count; i++)
    for (int d = 0; d < c; d++) {
      diagonal[d] += fabs(workspace->system[c * (c * pattern->diagonal[i] + d) + d]);
      right[d] += workspace->rhs[c * i + d] * workspace->rhs[c * i + d];
    }
  double momentum = diagonal[0] + diagonal[1], force = sqrt(right[0] + right[1]);
  if (diagonal[2] > 0)
    by[2] = sqrt(0.5 * momentum / diagonal[2]);
  if (c == 4 && right[3] > 0 && force > 0)
    by[3] = force / sqrt(right[3]);
  else if (c == 4 && diagonal[3] > 0)
    by[3] = sqrt(0.5 * momentum / diagonal[3]);
  for (int d = 2; d < c; d++)
    if (!isfinite(by[d]) || !(by[d] > 0))
      by[d] = 1;
  for (int64_t p = 0; p < pattern->block_count; p++)
    for (int d = 2; d < c; d++)
      for (int e = 0; e < c; e++)
        workspace->system[c * (c * p + d) + e] *= by[d];
  for (int64_t i = 0; i < pattern->node_count; i++)
    for (int d = 2; d < c; d++)
      workspace->rhs[c * i + d] *= by[d];
}

/* Assembles and solves; workspace.solution is the first guess and the result, workspace.reaction
 * follows from it. */
static bw_status solve(bw_context *context, bw_flow *flow, const bwi_linear *linear, double time,
                       const bw_flow_options *options, bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  bwi_flow_workspace *workspace = &in->workspace;
  const bw_flow_description *about = &in->about;
  int c = flow->components;
  size_t unknowns = (size_t)in->now->pattern->node_count * (size_t)c;
  double started = bw_seconds();
  BW_TRY(bwi_flow_recover(context, flow->mesh, c, workspace->solution, workspace->laplacian));
  BW_TRY(assemble(context, flow, linear));
  memset(workspace->is_prescribed, 0, unknowns);
  BW_TRY(bw_conditions_prescribe(context, flow->mesh, c, about->condition_count, about->condition,
                                 time, workspace->is_prescribed, workspace->prescribed,
                                 &in->conflicts_reported));
  BW_TRY(bwi_flow_boundary(context, flow, time));
  bool enclosed = is_enclosed(flow);
  if (enclosed) {
    workspace->is_prescribed[2] = 1;
    workspace->prescribed[2] = 0;
  }
  size_t entries = (size_t)in->now->pattern->block_count * (size_t)(c * c);
  memcpy(workspace->system, workspace->values, entries * sizeof *workspace->system);
  memcpy(workspace->rhs, workspace->load, unknowns * sizeof *workspace->rhs);
  BW_TRY(bw_plane_prescribe(context, in->now->pattern, c, workspace->is_prescribed,
                            workspace->prescribed, workspace->system, workspace->rhs));
  balance(flow);
  for (size_t i = 0; i < unknowns; i++)
    if (workspace->is_prescribed[i])
      workspace->solution[i] = workspace->prescribed[i];
  reuse->seconds_assemble += bw_seconds() - started;
  BW_TRY(bw_lagged_factor_solve(context, in->lagged, in->now->pattern, workspace->system,
                                workspace->rhs, workspace->solution, &options->linear, reuse));
  BW_TRY(bw_plane_multiply(context, in->now->pattern, c, workspace->values, workspace->solution,
                           workspace->reaction));
  for (size_t i = 0; i < unknowns; i++)
    workspace->reaction[i] -= workspace->load[i];
  if (enclosed)
    center_pressure(flow, workspace->solution);
done:
  return status;
}

/* Largest change of velocity, and of temperature, against the largest there is. */
static double change(const bw_flow *flow, const double *from, const double *to) {
  int c = flow->components;
  double moved[2] = {0}, size[2] = {0};
  for (int64_t i = 0; i < flow->mesh->topology->nodes->node_count; i++)
    for (int d = 0; d < c; d++) {
      int which = d == 3;
      if (d == 2)
        continue;
      moved[which] = fmax(moved[which], fabs(to[c * i + d] - from[c * i + d]));
      size[which] = fmax(size[which], fabs(to[c * i + d]));
    }
  double velocity = size[0] > 0 ? moved[0] / size[0] : moved[0];
  double heat = size[1] > 0 ? moved[1] / size[1] : 0;
  return isfinite(velocity + heat) ? fmax(velocity, heat) : INFINITY;
}

/* ---- a time step --------------------------------------------------------------------------- */

/* u' = rate u - one u(before) + two u(before that), along the paths of the nodes. */
typedef struct scheme {
  double rate, one, two;
} scheme;

/* What carries is the velocity less that of the nodes, by the same scheme: then a field that is
 * steady and linear in space stays what it is however the nodes move through it. */
static void set_convection(const bw_flow *flow, const double *state, const scheme *moving) {
  const struct bwi_flow *in = flow->inner;
  int c = flow->components;
  const double *now = flow->mesh->point, *old = in->now->old_point ? in->now->old_point : now,
               *older = in->now->older_point ? in->now->older_point : old;
  for (int64_t i = 0; i < in->now->pattern->node_count; i++)
    for (int d = 0; d < 2; d++) {
      int64_t k = 2 * i + d;
      double mesh =
          moving ? moving->rate * now[k] - moving->one * old[k] + moving->two * older[k] : 0;
      in->workspace.convect[k] = state[c * i + d] - mesh;
    }
}

static bw_status march(bw_context *context, bw_flow *flow, const bw_flow_options *options,
                       bw_flow_state *next, bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  int c = flow->components;
  size_t unknowns = (size_t)in->now->pattern->node_count * (size_t)c;
  double dt = options->step, ratio = in->now->known == 2 ? dt / in->now->last_step : 0;
  bool second = options->bdf == 2 && in->now->known == 2;
  double *x = in->workspace.solution, *last = NULL;
  /* u' = rate u - history, from the parabola through the new and the two former states */
  scheme s = {1 / dt, 1 / dt, 0};
  if (second)
    s = (scheme){(1 + 2 * ratio) / (1 + ratio) / dt, (1 + ratio) / dt,
                 ratio * ratio / (1 + ratio) / dt};
  for (size_t i = 0; i < unknowns; i++) {
    in->workspace.history[i] = s.one * flow->state[i] - s.two * flow->before[i];
    x[i] = flow->state[i] + ratio * (flow->state[i] - flow->before[i]);
  }
  bwi_linear linear = {.mesh = flow->mesh,
                       .about = &in->about,
                       .components = c,
                       .rate = s.rate,
                       .convect = in->workspace.convect,
                       .laplacian = in->workspace.laplacian,
                       .history = in->workspace.history};
  int rounds = options->iterations > 0 ? options->iterations : 1;
  last = BW_NEW(context, double, unknowns);
  if (!last)
    return BW_MEMORY;
  for (int k = 0; k < rounds; k++) {
    set_convection(flow, x, options->ale ? &s : NULL);
    memcpy(last, x, unknowns * sizeof *x);
    BW_TRY(solve(context, flow, &linear, flow->time + dt, options, reuse));
    if (k > 0 && change(flow, last, x) <= options->tolerance)
      break;
  }
  memcpy(next->before, flow->state, unknowns * sizeof *x);
  memcpy(next->state, x, unknowns * sizeof *x);
  next->time += dt;
  next->last_step = dt;
  next->known = 2;
  bw_free(next->older_point);
  next->older_point = next->old_point;
  next->old_point = NULL;
done:
  bw_free(last);
  return status;
}

/* ---- the steady state ---------------------------------------------------------------------- */

/* The fastest rate at which anything crosses an element: sets the first step of the search. */
static double fastest(const bw_flow *flow, const bwi_linear *linear) {
  double rate = 0;
  for (int32_t k = 0; k < flow->mesh->topology->element_count; k++) {
    bwi_flow_element e;
    if (bwi_flow_element_make(linear, k, &e) && e.tau > 0)
      rate = fmax(rate, 1 / e.tau);
  }
  return rate;
}

/* Rounds from workspace.solution. `pseudo`: the rate of the first implicit step, falling as the
 * change from round to round allows; 0: none, Picard and Newton at once. */
static bw_status search(bw_context *context, bw_flow *flow, const bw_flow_options *options,
                        double pseudo, int rounds, double *reached, double *last,
                        bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  int c = flow->components;
  size_t unknowns = (size_t)in->now->pattern->node_count * (size_t)c;
  double *x = in->workspace.solution, rate = pseudo;
  *reached = INFINITY;
  for (int k = 0; k < rounds; k++) {
    BW_TRY(bw_check_cancel(context));
    set_convection(flow, x, NULL);
    memcpy(last, x, unknowns * sizeof *x);
    for (size_t i = 0; i < unknowns; i++)
      in->workspace.history[i] = rate * x[i];
    bwi_linear linear = {.mesh = flow->mesh,
                         .about = &in->about,
                         .components = c,
                         .rate = rate,
                         .convect = in->workspace.convect,
                         .laplacian = in->workspace.laplacian,
                         .history = in->workspace.history,
                         .newton = pseudo > 0 || k >= PICARD ? last : NULL};
    BW_TRY(solve(context, flow, &linear, flow->time, options, reuse));
    double moved = change(flow, last, x), before = *reached;
    /* a steady state does not move however long the step */
    *reached = moved;
    if (moved <= options->tolerance && rate <= 1e-6 * pseudo)
      break;
    if (!isfinite(moved) || (pseudo == 0 && k > PICARD && moved > 10 * before) ||
        (pseudo == 0 && k > LOST && moved > 0.5))
      break;
    if (pseudo > 0) {
      if (moved > 0.5)
        rate *= 2;
      else
        rate /= moved > 0.1 ? 1.5 : moved > 1e-2 ? 3 : 10;
      if (rate < 1e-8 * pseudo)
        rate = 0;
    }
  }
done:
  return status;
}

/* Whether heat that comes in has no temperature to come to rest at. */
static bool heats_up(const bw_flow *flow) {
  const bw_flow_description *about = &flow->inner->about;
  bool comes_in = false;
  for (int32_t i = 0; i < about->condition_count; i++) {
    const bw_condition *c = &about->condition[i];
    comes_in = comes_in || (c->kind == BW_TRACTION && c->component == 3);
    if ((c->kind == BW_PRESCRIBED && c->component == 3) ||
        (c->kind == BW_CONVECTION && c->coefficient > 0))
      return false;
  }
  return comes_in;
}

static bw_status settle(bw_context *context, bw_flow *flow, const bw_flow_options *options,
                        bw_flow_state *next, bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  if (heats_up(flow))
    return bw_fail(
        context, BW_INVALID,
        "there is a heat flux, but neither a temperature nor convection: no steady state "
        "is determined. Prescribe a temperature somewhere, or give a time step");
  size_t unknowns = (size_t)in->now->pattern->node_count * (size_t)flow->components;
  double *x = in->workspace.solution, reached = INFINITY;
  double *last = BW_NEW(context, double, unknowns);
  int rounds = options->iterations > 0 ? options->iterations : 30;
  if (!last)
    return BW_MEMORY;
  memcpy(x, flow->state, unknowns * sizeof *x);
  BW_TRY(search(context, flow, options, 0, rounds, &reached, last, reuse));
  if (!(reached <= options->tolerance)) {
    memcpy(x, flow->state, unknowns * sizeof *x);
    set_convection(flow, x, NULL);
    bwi_linear linear = {.mesh = flow->mesh,
                         .about = &in->about,
                         .components = flow->components,
                         .convect = in->workspace.convect};
    double pseudo = fastest(flow, &linear) / 10;
    BW_TRY(search(context, flow, options, pseudo, 10 * rounds, &reached, last, reuse));
  }
  if (!(reached <= options->tolerance)) {
    status = bw_fail(context, BW_CONVERGENCE,
                     "no steady state was found: the last iteration changed it by %.3g of its "
                     "magnitude (tolerance %.3g). The flow may be unsteady: give a time step",
                     reached, options->tolerance);
    bw_detail_number(context, "change", reached);
    goto done;
  }
  memcpy(next->state, x, unknowns * sizeof *x);
  memcpy(next->before, x, unknowns * sizeof *x);
  next->known = 1;
  bw_free(next->old_point);
  bw_free(next->older_point);
  next->old_point = next->older_point = NULL;
done:
  bw_free(last);
  return status;
}

/* The next state is made beside the one that stands, which is in nobody's way until then. */
bw_status bw_flow_step(bw_context *context, bw_flow *flow, const bw_flow_options *given,
                       bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_flow *in = flow->inner;
  bw_flow_state *next = NULL;
  bw_flow_options options;
  bw_plane_reuse ignored = {0};
  bw_flow_options_default(&options);
  if (given)
    options = *given;
  reuse = bwi_reuse_of(reuse, &ignored);
  if (!(options.step >= 0) || !isfinite(options.step) || options.bdf < 1 || options.bdf > 2 ||
      options.iterations < 0 || !(options.tolerance > 0))
    return bw_fail(context, BW_INVALID,
                   "a step of at least 0 s, scheme 1 or 2, at least 0 iterations and a tolerance "
                   "above 0 are needed, not %g, %d, %d, %g",
                   options.step, options.bdf, options.iterations, options.tolerance);
  if (options.step == 0)
    options.linear.tolerance = fmin(options.linear.tolerance, 0.01 * options.tolerance);
  if (!in->workspace.block)
    BW_TRY(bwi_flow_workspace_make(context, in->now->pattern, flow->components, &in->workspace));
  BW_TRY(bwi_flow_next(context, flow, &next));
  if (options.step > 0)
    BW_TRY(march(context, flow, &options, next, reuse));
  else
    BW_TRY(settle(context, flow, &options, next, reuse));
  memcpy(next->reaction, in->workspace.reaction,
         (size_t)in->now->pattern->node_count * (size_t)flow->components * sizeof(double));
  next->reacted = true;
  BW_TRY(bwi_flow_commit(context, flow, next));
done:
  bw_release(next);
  return status;
}
