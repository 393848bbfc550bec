/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Paths of equilibrium under a growing load factor (docs/theory/finite.md).
 *
 * A displacement is u = lambda u0 + v with u0 the prescribed values and v at the unknowns. A step
 * goes from a state in equilibrium, with the tangent there, along d lambda and dv = K^-1 q d
 * lambda, and then iterates with a tangent at each iterate. A step that fails is cut. */
#include <math.h>
#include <string.h>

#include "barwright/job.h"
#include "base/dense.h"
#include "finite/internal.h"
#include "linear/blas.h"
#include "linear/internal.h"
#include "model/internal.h"

enum { CUTS = 12, WANTED_ITERATIONS = 5, FREE = 1u << BW_DOF_UNKNOWN };
/* Steps of displacements grow and shrink by at most these factors. */
static const double growth = 2, shrinkage = 0.5;
/* A residual of so many times load and reactions will not converge any more. */
static const double diverged = 1e12;

typedef enum outcome { CONVERGED, SLOW, DIVERGED, INVERTED, SINGULAR, NO_ROOT } outcome;

typedef struct path {
  const bw_model *model;
  bw_nonlinear_options options;
  bw_dof_map *dof_map;
  bw_block_pattern *pattern;
  bwi_symbolic *symbolic;
  bwi_finite_elements elements;
  bwi_factor *factor; /* of the tangent at the last state that it was made of */
  bool counted;
  int64_t size; /* 3 node_count */
  double *block;
  /* fields of the block */
  double *load, *prescribed; /* at factor 1; */
  double *v;                 /* of the last state in equilibrium, */
  double *step, *last; /* what leads from there to the iterate; to there from the one before */
  double *u;           /* of the iterate */
  double *internal, *heat;
  double *right, *solution; /* two fields each: residual and -dR/dlambda */
  double *tangent;
  double lambda, change;           /* of the last state, and to the iterate */
  double length, least;            /* of a step of displacements: where cutting ends */
  double residual, energy, strain; /* of the iterate */
  double scale;                    /* what its residual is relative to */
  double most;                     /* the largest such scale of a state in equilibrium */
  int32_t worst;                   /* node of the largest residual */
  int32_t inverted;
  int iterations; /* of the step, those of what was cut too */
  int32_t bad;    /* node where elimination failed */
  int factorisations;
} path;

/* ---- residuals and tangents ------------------------------------------------------------------ */

static double norm(int64_t size, const double *x) {
  return sqrt(bwi_dot(size, x, x));
}

static void place_iterate(path *p) {
  double lambda = p->lambda + p->change;
  for (int64_t i = 0; i < p->size; i++)
    p->u[i] = lambda * p->prescribed[i] + p->v[i] + p->step[i];
}

/* The residual lambda f - f_int at the unknowns into `right`, and its size. */
static bw_status residual(bw_context *context, path *p) {
  bw_status status = BW_OK;
  double lambda = p->lambda + p->change, scale = 0, largest = -1;
  place_iterate(p);
  bwi_finite_state state = {
      .displacement = p->u, .factor = lambda, .force = p->internal, .heat = p->heat};
  BW_TRY(bwi_finite_evaluate(context, &p->elements, &state));
  p->inverted = state.inverted;
  p->energy = state.energy;
  p->strain = state.strain;
  if (p->inverted >= 0)
    goto done;
  for (int64_t i = 0; i < p->size; i++)
    p->right[i] = lambda * p->load[i] - p->internal[i];
  memcpy(p->solution, p->right, (size_t)p->size * sizeof(double));
  bwi_keep_states(p->dof_map, 1u << BW_DOF_PRESCRIBED, p->solution);
  bwi_keep_states(p->dof_map, FREE, p->right);
  scale = fmax(norm(p->size, p->solution), fabs(lambda) * norm(p->size, p->load));
  if (p->elements.expands)
    scale = fmax(scale, fabs(lambda) * norm(p->size, p->heat));
  p->scale = scale;
  scale = fmax(scale, 0.01 * p->most);
  p->residual = norm(p->size, p->right) / (scale > 0 ? scale : 1);
  for (int64_t i = 0; i < p->size; i += 3) {
    double own = bw_dot(p->right + i, p->right + i);
    if (own > largest) {
      largest = own;
      p->worst = (int32_t)(i / 3);
    }
  }
done:
  return status;
}

/* The tangent of the iterate, its factor, and -dR/dlambda behind the residual. BW_SINGULAR alone
 * is no failure of the analysis. */
static bw_status factor_tangent(bw_context *context, path *p, bool *singular) {
  bw_status status = BW_OK;
  double *q = p->right + p->size;
  bwi_finite_state state = {.displacement = p->u,
                            .factor = p->lambda + p->change,
                            .force = p->internal,
                            .heat = p->heat,
                            .tangent = p->tangent};
  BW_TRY(bwi_finite_evaluate(context, &p->elements, &state));
  memset(q, 0, (size_t)p->size * sizeof *q);
  if (p->dof_map->prescribed)
    BW_TRY(bw_block_multiply(context, p->pattern, p->tangent, 9, 3, 1, p->prescribed, q));
  for (int64_t i = 0; i < p->size; i++)
    q[i] = p->load[i] + p->heat[i] - q[i];
  bwi_keep_states(p->dof_map, FREE, q);
  bw_release(p->factor);
  p->factor = NULL;
  bwi_matrix matrix = {.pattern = p->pattern, .stiffness = p->tangent, .dof_map = p->dof_map};
  status =
      bwi_factor_create_indefinite(context, p->symbolic, &matrix, &p->factor, &p->counted, &p->bad);
  p->factorisations++;
  *singular = status == BW_SINGULAR;
  if (*singular)
    status = BW_OK;
done:
  return status;
}

/* ---- Newton's method ------------------------------------------------------------------------- */

/* The change of the load factor that keeps the length of the step (Crisfield 1981): of the two
 * roots that which turns least. False where there is none. */
static bool keep_length(const path *p, double *change) {
  const double *dr = p->solution, *dq = dr + p->size;
  double a = bwi_dot(p->size, dq, dq), b = 0, c = 0, turn = bwi_dot(p->size, dq, p->step);
  for (int64_t i = 0; i < p->size; i++) {
    double at = p->step[i] + dr[i];
    b += at * dq[i];
    c += at * at;
  }
  double inside = b * b - a * (c - p->length * p->length);
  if (!(a > 0) || !(inside >= 0))
    return false;
  *change = (-b + (turn >= 0 ? 1 : -1) * sqrt(inside)) / a;
  return true;
}

/* From the step that `p` has to a state in equilibrium. */
static bw_status iterate(bw_context *context, path *p, bool arc_length, outcome *result) {
  bw_status status = BW_OK;
  bool singular;
  double change = 0;
  for (int k = 0;; k++) {
    BW_TRY(bw_check_cancel(context));
    BW_TRY(residual(context, p));
    *result = INVERTED;
    if (p->inverted >= 0)
      goto done;
    *result = DIVERGED;
    if (!(p->residual < diverged))
      goto done;
    double scale = p->residual > 0 ? norm(p->size, p->right) / p->residual : 1;
    double noise = bwi_residual_noise(p->pattern, p->tangent, p->u) / scale;
    *result = CONVERGED;
    if (p->residual <= fmax(p->options.tolerance, fmin(noise, 1e-4)))
      break;
    *result = SLOW;
    if (k == p->options.max_iterations)
      goto done;
    p->iterations++;
    BW_TRY(factor_tangent(context, p, &singular));
    *result = SINGULAR;
    if (singular)
      goto done;
    BW_TRY(bwi_solve_fields(context, p->factor, p->dof_map, arc_length ? 2 : 1, p->right,
                            p->solution));
    *result = NO_ROOT;
    if (arc_length && !keep_length(p, &change))
      goto done;
    for (int64_t i = 0; i < p->size; i++)
      p->step[i] += p->solution[i] + (arc_length ? change * p->solution[p->size + i] : 0);
    p->change += change;
  }
  BW_TRY(bwi_finite_inverted_at_nodes(context, p->model->mesh, p->u, &p->inverted));
  if (p->inverted >= 0)
    *result = INVERTED;
done:
  return status;
}

/* ---- steps ----------------------------------------------------------------------------------- */

/* dv per load factor at the last state in equilibrium into the second of `solution`. */
static bw_status tangent_at_state(bw_context *context, path *p) {
  bw_status status = BW_OK;
  bool singular;
  p->change = 0;
  memset(p->step, 0, (size_t)p->size * sizeof *p->step);
  place_iterate(p);
  BW_TRY(factor_tangent(context, p, &singular));
  if (p->lambda == 0 && (singular || p->factor->negative > 0 || !p->counted))
    BW_TRY(bwi_fail_singular(context, p->model->mesh, p->bad));
  if (singular)
    BW_TRY(bw_fail(context, BW_SINGULAR,
                   "the tangent stiffness is singular to the last digit at load factor %.6g: take "
                   "another number of steps",
                   p->lambda));
  BW_TRY(bwi_solve_fields(context, p->factor, p->dof_map, 1, p->right + p->size,
                          p->solution + p->size));
done:
  return status;
}

static void begin_step(path *p, const double *slope, double change) {
  p->change = change;
  for (int64_t i = 0; i < p->size; i++)
    p->step[i] = change * slope[i];
}

static bw_status fail_step(bw_context *context, const path *p, outcome result, double tried) {
  static const char *const why[] = {
      [SLOW] = "Newton's method did not converge",
      [DIVERGED] = "Newton's method diverged",
      [SINGULAR] = "the tangent stiffness became singular",
      [NO_ROOT] = "no step of its length has a state",
  };
  const bw_mesh *mesh = p->model->mesh;
  const double *x = mesh->node + 3 * (int64_t)p->worst;
  if (result == INVERTED) {
    bw_fail(context, BW_GEOMETRY,
            "element %d inverts behind load factor %.6g, however small the step: det F is not "
            "positive there. Refine the mesh there, spread the load, or end at a smaller load",
            p->inverted + 1, p->lambda);
    bw_detail_number(context, "element", p->inverted + 1);
    bw_detail_number(context, "factor", p->lambda);
    return BW_GEOMETRY;
  }
  bw_fail(
      context, BW_CONVERGENCE,
      "no state in equilibrium was found behind load factor %.6g: %s in a step of %.3g, and the "
      "residual is largest at node %d, (%g, %g, %g) m, %.2g of the load. %s",
      p->lambda, why[result], tried, p->worst + 1, x[0], x[1], x[2], p->residual,
      p->options.arc_length
          ? "Take more steps, or more iterations"
          : "The load may reach its largest value there: arc_length passes limit points. Else "
            "take more steps, or more iterations");
  bw_detail_number(context, "factor", p->lambda);
  bw_detail_number(context, "node", p->worst + 1);
  bw_detail_number(context, "residual", p->residual);
  return BW_CONVERGENCE;
}

/* A step to a load factor that is given, cut where it fails. *change: what it was, in the end. */
static bw_status step_of_load(bw_context *context, path *p, double *change, int *cuts) {
  bw_status status = BW_OK;
  outcome result;
  double least = p->options.factor / p->options.steps / (1 << CUTS);
  double *slope = BW_NEW(context, double, p->size);
  BW_TRY_MEMORY(slope);
  memcpy(slope, p->solution + p->size, (size_t)p->size * sizeof *slope);
  for (*cuts = 0;; ++*cuts, *change /= 2) {
    begin_step(p, slope, *change);
    BW_TRY(iterate(context, p, false, &result));
    if (result == CONVERGED)
      break;
    if (*cuts == CUTS || *change <= least)
      BW_TRY(fail_step(context, p, result, *change));
  }
done:
  bw_free(slope);
  return status;
}

/* A step of displacements, which may end where the load factor is `until`. */
static bw_status step_of_length(bw_context *context, path *p, bool first, int *cuts) {
  bw_status status = BW_OK;
  outcome result = SLOW;
  double until = p->options.factor, most = until / p->options.steps;
  double *slope = BW_NEW(context, double, p->size);
  BW_TRY_MEMORY(slope);
  memcpy(slope, p->solution + p->size, (size_t)p->size * sizeof *slope);
  double size = norm(p->size, slope);
  double sign = first || bwi_dot(p->size, slope, p->last) >= 0 ? 1 : -1;
  if (!(size > 0))
    BW_TRY(bw_fail(context, BW_INVALID,
                   "the load moves nothing: arc_length needs displacements at unknowns"));
  p->length = first ? most * size : fmin(p->length, most * size);
  p->least = first ? p->length / (1 << CUTS) : p->least;
  for (*cuts = 0;; ++*cuts, p->length *= shrinkage) {
    begin_step(p, slope, sign * p->length / size);
    BW_TRY(iterate(context, p, true, &result));
    if (result == CONVERGED)
      break;
    if (*cuts == CUTS || p->length <= p->least)
      BW_TRY(fail_step(context, p, result, sign * p->length / size));
  }
  if (p->lambda + p->change > until) { /* the same step, cut where it ends */
    double part = (until - p->lambda) / p->change;
    for (int64_t i = 0; i < p->size; i++)
      p->step[i] *= part;
    p->change = until - p->lambda;
    BW_TRY(iterate(context, p, false, &result));
    if (result != CONVERGED)
      BW_TRY(fail_step(context, p, result, p->change));
  }
done:
  bw_free(slope);
  return status;
}

/* ---- the path -------------------------------------------------------------------------------- */

static double largest_displacement(const path *p, int32_t *node) {
  double most = -1;
  for (int64_t i = 0; i < p->size; i += 3) {
    double own = bw_dot(p->u + i, p->u + i);
    if (own > most) {
      most = own;
      *node = (int32_t)(i / 3);
    }
  }
  return sqrt(most);
}

/* Takes the iterate as the state in equilibrium, and as a step of the result. */
static bw_status accept(bw_context *context, path *p, int cuts, bw_nonlinear *out) {
  int32_t node;
  size_t count = (size_t)out->count + 1, columns = 3 * (size_t)out->monitor_count;
  bw_nonlinear_step *step = bw_resize(context, out->step, count, sizeof *step);
  if (!step)
    return BW_MEMORY;
  out->step = step;
  double *monitored = bw_resize(context, out->monitored, count * columns, sizeof *monitored);
  if (!monitored)
    return BW_MEMORY;
  out->monitored = monitored;
  for (int64_t i = 0; i < p->size; i++)
    p->v[i] += p->step[i];
  memcpy(p->last, p->step, (size_t)p->size * sizeof *p->last);
  p->lambda += p->change;
  p->change = 0;
  p->most = fmax(p->most, p->scale);
  out->step[out->count] = (bw_nonlinear_step){.factor = p->lambda,
                                              .residual = p->residual,
                                              .energy = p->energy,
                                              .strain = p->strain,
                                              .displacement = largest_displacement(p, &node),
                                              .iterations = p->iterations,
                                              .cuts = cuts};
  for (int k = 0; k < out->monitor_count; k++)
    memcpy(monitored + (size_t)out->count * columns + 3 * (size_t)k,
           p->u + 3 * (int64_t)out->monitor[k], 3 * sizeof *monitored);
  out->count++;
  return BW_OK;
}

/* Where nothing is monitored: the node that moves most at first. */
static bw_status choose_monitor(bw_context *context, path *p, bw_nonlinear *out) {
  const double *slope = p->solution + p->size;
  double most = -1;
  if (out->monitor_count > 0)
    return BW_OK;
  out->monitor = BW_NEW0(context, int32_t, 1);
  if (!out->monitor)
    return BW_MEMORY;
  out->monitor_count = 1;
  for (int64_t i = 0; i < p->size; i += 3) {
    double own = 0;
    for (int k = 0; k < 3; k++)
      own += (slope[i + k] + p->prescribed[i + k]) * (slope[i + k] + p->prescribed[i + k]);
    if (own > most) {
      most = own;
      out->monitor[0] = (int32_t)(i / 3);
    }
  }
  return BW_OK;
}

static void count_negative(const path *p, bw_nonlinear *out) {
  if (out->count == 0)
    return;
  out->step[out->count - 1].negative = (int32_t)p->factor->negative;
  out->step[out->count - 1].counted = p->counted;
}

static bw_status follow(bw_context *context, path *p, bw_nonlinear *out) {
  bw_status status = BW_OK;
  const bw_nonlinear_options *o = &p->options;
  double most = o->factor / o->steps, change = most;
  int cuts = 0;
  for (;;) {
    bw_progress(context, "load steps", fmin(1, fmax(0, p->lambda / o->factor)));
    BW_TRY(tangent_at_state(context, p));
    count_negative(p, out);
    BW_TRY(choose_monitor(context, p, out));
    if (p->lambda >= o->factor * (1 - 1e-12)) {
      out->end = BW_NONLINEAR_FACTOR;
      break;
    }
    if (out->count > 0 && o->displacement > 0 &&
        out->step[out->count - 1].displacement >= o->displacement) {
      out->end = BW_NONLINEAR_DISPLACEMENT;
      break;
    }
    if (out->count == o->max_steps) {
      out->end = BW_NONLINEAR_STEPS;
      break;
    }
    p->iterations = 1; /* with the tangent at the state */
    if (o->arc_length) {
      BW_TRY(step_of_length(context, p, out->count == 0, &cuts));
      p->length *= fmin(growth, fmax(shrinkage, sqrt((double)WANTED_ITERATIONS / p->iterations)));
    } else {
      change = fmin(change, o->factor - p->lambda);
      if (o->factor - p->lambda - change < 1e-9 * o->factor)
        change = o->factor - p->lambda;
      BW_TRY(step_of_load(context, p, &change, &cuts));
    }
    BW_TRY(accept(context, p, cuts, out));
    if (!o->arc_length && cuts == 0)
      change = fmin(most, 2 * change);
  }
done:
  return status;
}

/* ---- begin and end --------------------------------------------------------------------------- */

void bw_nonlinear_options_default(bw_nonlinear_options *options) {
  *options = (bw_nonlinear_options){
      .factor = 1, .steps = 10, .max_steps = 500, .tolerance = 1e-8, .max_iterations = 20};
}

static bw_status check_options(bw_context *context, const bw_model *model,
                               const bw_nonlinear_options *o) {
  if (!(o->factor > 0 && o->factor < INFINITY))
    return bw_fail(context, BW_INVALID, "the load factor is %g: a positive one is expected",
                   o->factor);
  if (o->steps < 1 || o->steps > 100000 || o->max_steps < 1 || o->max_steps > 100000)
    return bw_fail(context, BW_INVALID, "1 to 100000 steps are expected, not %d and at most %d",
                   o->steps, o->max_steps);
  if (!(o->tolerance > 0 && o->tolerance < 1))
    return bw_fail(context, BW_INVALID, "the tolerance is %g: above 0 and below 1 is expected",
                   o->tolerance);
  if (o->max_iterations < 2 || o->max_iterations > 1000)
    return bw_fail(context, BW_INVALID, "2 to 1000 iterations are expected, not %d",
                   o->max_iterations);
  if (!(o->displacement >= 0 && o->displacement < INFINITY))
    return bw_fail(context, BW_INVALID, "a displacement of 0 m or more is expected, not %g",
                   o->displacement);
  for (int k = 0; k < o->monitor_count; k++)
    if (o->monitor[k] < 0 || o->monitor[k] >= model->mesh->node_count)
      return bw_fail(context, BW_INVALID, "node %d is not one of the %d nodes of the mesh",
                     o->monitor[k] + 1, model->mesh->node_count);
  return BW_OK;
}

static bw_status check_supports(bw_context *context, const bw_dof_map *dof_map) {
  bw_status status = BW_OK;
  char *text = NULL;
  if (dof_map->rigid_mode_count == 0)
    return BW_OK;
  BW_TRY(bw_dof_map_describe_rigid_modes(context, dof_map, &text));
  status = bw_fail(context, BW_UNCONSTRAINED,
                   "a body that can move freely has no state that a growing load leads to; %s. Add "
                   "supports that constrain it",
                   text);
done:
  bw_free(text);
  return status;
}

static bw_status check_memory(bw_context *context, const path *p) {
  const bw_mesh *mesh = p->model->mesh;
  double blocks = mesh->nodes_per_element * (mesh->nodes_per_element + 1) / 2.0;
  double tangents =
      9 * sizeof(double) * (blocks * mesh->element_count + (double)p->pattern->block_count);
  double needed = bwi_factor_peak_bytes(p->symbolic, bw_threads(context)) + tangents;
  double available = bw_available_memory();
  if (needed <= available)
    return BW_OK;
  bw_fail(context, BW_MEMORY,
          "the tangent stiffness and its factor take %.3g bytes, and %.3g are free: coarsen the "
          "mesh",
          needed, available);
  bw_detail_number(context, "bytes", needed);
  bw_detail_number(context, "free_bytes", available);
  return BW_MEMORY;
}

/* Dead loads; temperatures act by the stress. */
static bw_status sum_loads(bw_context *context, path *p) {
  bw_status status = BW_OK;
  for (int k = 0; k < p->model->load_count; k++) {
    if (p->model->load[k].kind == BW_LOAD_TEMPERATURE)
      continue;
    BW_TRY(bwi_load_force(context, p->model, &p->model->load[k], p->internal));
    for (int64_t i = 0; i < p->size; i++)
      p->load[i] += p->internal[i];
  }
done:
  return status;
}

static bw_status path_open(bw_context *context, const bw_model *model,
                           const bw_nonlinear_options *given, path *p) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = model->mesh;
  p->model = model;
  if (given)
    p->options = *given;
  else
    bw_nonlinear_options_default(&p->options);
  BW_TRY(check_options(context, model, &p->options));
  BW_TRY(bw_model_refuse_joints(context, model));
  BW_TRY(bw_dof_map_create(context, model, &p->dof_map));
  BW_TRY(check_supports(context, p->dof_map));
  BW_TRY(bw_model_check_absorbed(context, model, p->dof_map));
  BW_TRY(bw_block_pattern_create(context, mesh, &p->pattern));
  bw_progress(context, "ordering", 0);
  BW_TRY(bwi_symbolic_for(context, p->pattern, p->dof_map, BW_ORDERING_AUTO, 0, NULL, NULL, NULL,
                          &p->symbolic));
  BW_TRY(check_memory(context, p));
  BW_TRY(bwi_finite_elements_open(context, model, p->pattern, &p->elements));
  p->size = 3 * (int64_t)mesh->node_count;
  p->block = BW_NEW0(context, double, 12 * p->size);
  p->tangent = BW_NEW0(context, double, 9 * p->pattern->block_count);
  BW_TRY_MEMORY(p->block && p->tangent);
  double **field[] = {&p->load, &p->prescribed, &p->v,        &p->step,
                      &p->last, &p->u,          &p->internal, &p->heat};
  for (int k = 0; k < 8; k++)
    *field[k] = p->block + k * p->size;
  p->right = p->block + 8 * p->size;
  p->solution = p->block + 10 * p->size;
  bwi_prescribed_field(p->dof_map, p->prescribed);
  BW_TRY(sum_loads(context, p));
  if (!p->dof_map->prescribed && !p->elements.expands && !(norm(p->size, p->load) > 0))
    BW_TRY(bw_fail(context, BW_INVALID,
                   "nothing acts on the model: add a load, a temperature or a prescribed "
                   "displacement"));
done:
  return status;
}

static void path_clear(path *p) {
  bw_release(p->dof_map);
  bw_release(p->pattern);
  bw_release(p->symbolic);
  bw_release(p->factor);
  bwi_finite_elements_clear(&p->elements);
  bw_free(p->block);
  bw_free(p->tangent);
}

static void nonlinear_destroy(void *object) {
  bw_nonlinear *result = object;
  bw_release(result->model);
  bw_free(result->step);
  bw_free(result->monitor);
  bw_free(result->monitored);
  bw_free(result->displacement);
  bw_free(result->reaction);
  bw_free(result->force);
  bw_free(result);
}

static size_t nonlinear_bytes(const void *object) {
  const bw_nonlinear *result = object;
  size_t columns = 3 * (size_t)result->monitor_count;
  return sizeof *result + 9 * (size_t)result->model->mesh->node_count * sizeof(double) +
         (size_t)result->count * (sizeof *result->step + columns * sizeof(double));
}

static const bw_kind nonlinear_kind = {"geometrically nonlinear statics", nonlinear_destroy,
                                       nonlinear_bytes};

static bw_status nonlinear_create(bw_context *context, const path *p, bw_nonlinear **out) {
  bw_nonlinear *result = BW_NEW0(context, bw_nonlinear, 1);
  if (!result)
    return BW_MEMORY;
  bw_object_init(result, &nonlinear_kind);
  result->model = bw_retain(p->model);
  *out = result;
  result->displacement = BW_NEW(context, double, p->size);
  result->reaction = BW_NEW(context, double, p->size);
  result->force = BW_NEW(context, double, p->size);
  if (!result->displacement || !result->reaction || !result->force)
    return BW_MEMORY;
  if (p->options.monitor_count > 0) {
    size_t size = (size_t)p->options.monitor_count * sizeof *result->monitor;
    result->monitor = BW_NEW(context, int32_t, p->options.monitor_count);
    if (!result->monitor)
      return BW_MEMORY;
    memcpy(result->monitor, p->options.monitor, size);
    result->monitor_count = p->options.monitor_count;
  }
  return BW_OK;
}

static void fill(const path *p, double start, bw_nonlinear *out) {
  size_t size = (size_t)p->size * sizeof(double);
  memcpy(out->displacement, p->u, size);
  memcpy(out->force, p->load, size);
  for (int64_t i = 0; i < p->size; i++)
    out->reaction[i] = p->internal[i] - p->lambda * p->load[i];
  bwi_keep_states(p->dof_map, 1u << BW_DOF_PRESCRIBED, out->reaction);
  out->report = (bw_solver_report){.solver = "newton",
                                   .backend = p->factor->kernels->backend,
                                   .preconditioner = "",
                                   .flops = p->factorisations * bwi_factor_flops(p->factor),
                                   .bytes = (double)bwi_factor_bytes(p->factor),
                                   .residual = out->step[out->count - 1].residual,
                                   .seconds = bw_seconds() - start};
  for (int k = 0; k < out->count; k++)
    out->report.iterations += out->step[k].iterations;
}

bw_status bw_nonlinear_statics(bw_context *context, const bw_model *model,
                               const bw_nonlinear_options *options, bw_nonlinear **result) {
  bw_status status = BW_OK;
  path p = {0};
  bw_nonlinear *out = NULL;
  double start = bw_seconds();
  bwi_blas_enter();
  BW_TRY(path_open(context, model, options, &p));
  BW_TRY(nonlinear_create(context, &p, &out));
  BW_TRY(follow(context, &p, out));
  fill(&p, start, out);
  *result = out;
  out = NULL;
done:
  bwi_blas_leave();
  bw_release(out);
  path_clear(&p);
  return status;
}
