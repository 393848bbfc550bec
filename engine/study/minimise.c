/* NLopt's minimisers behind one interface. See study.h.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * NLopt calls back; a failure there is kept, NLopt asked to stop, and from then on nothing more is
 * asked of the caller's function. The best point that keeps to the constraints is kept as well:
 * some methods end elsewhere, or a little outside. */
#include <math.h>
#include <nlopt.h>
#include <stdio.h>
#include <string.h>

#include "barwright/study.h"

typedef struct method {
  const char *word;
  nlopt_algorithm algorithm;
  bool constraints, global;
  bool models; /* built from values: these must be finite */
} method;

static const method methods[] = {
    {"cobyla", NLOPT_LN_COBYLA, true, false, true},
    {"bobyqa", NLOPT_LN_BOBYQA, false, false, true},
    {"neldermead", NLOPT_LN_NELDERMEAD, false, false, false},
    {"sbplx", NLOPT_LN_SBPLX, false, false, false},
    {"direct_l", NLOPT_GN_DIRECT_L, false, true, false},
    {"crs2", NLOPT_GN_CRS2_LM, false, true, false},
    {"isres", NLOPT_GN_ISRES, true, true, false},
    {"mma", NLOPT_LD_MMA, true, false, true},
    {"slsqp", NLOPT_LD_SLSQP, true, false, true},
    {"lbfgs", NLOPT_LD_LBFGS, false, false, true},
};
enum { METHODS = sizeof methods / sizeof *methods };

const char *bw_minimiser_word(bw_minimiser minimiser) {
  return (int)minimiser >= 0 && (int)minimiser < METHODS ? methods[minimiser].word : NULL;
}

bool bw_minimiser_takes_constraints(bw_minimiser minimiser) {
  return methods[minimiser].constraints;
}

bool bw_minimiser_is_global(bw_minimiser minimiser) {
  return methods[minimiser].global;
}

const char *bw_minimise_end_word(bw_minimise_end end) {
  static const char *const word[] = {"tolerance", "good enough", "evaluations", "roundoff",
                                     "stuck"};
  return word[end];
}

void bw_minimise_options_default(bw_minimise_options *options) {
  *options = (bw_minimise_options){.method = BW_COBYLA,
                                   .tolerance = 1e-6,
                                   .constraint_tolerance = 1e-6,
                                   .good_enough = -INFINITY,
                                   .evaluations = 10000,
                                   .seed = 1};
}

/* ---- calling back ---------------------------------------------------------------------------- */

struct run;
typedef struct callback { /* one function, as NLopt sees it */
  struct run *run;
  int which;
} callback;

typedef struct run {
  bw_context *context;
  bw_minimised *function;
  void *data;
  const method *method;
  nlopt_opt nlopt;
  int n;
  bw_status failure;
  bool wrong_point; /* NLopt asked for a value at a point that is not finite */
  bool over_limit;  /* NLopt asked for more evaluations than it may have */
  int64_t evaluations, max_evaluations;
  int constraints;
  double tolerance;

  /* What is known of one point; NLopt asks for all of it before it goes to the next. */
  double *here;
  uint8_t *seen; /* function by function */
  int known;     /* how many */
  double value, violation;

  double *best; /* the best point so far that keeps to the constraints */
  double best_value, best_violation;
} run;

static const char *name_of(int which, char text[40]) {
  if (which == 0)
    return "the objective";
  snprintf(text, 40, "constraint %d", which);
  return text;
}

/* x as text, cut where it is long. */
static const char *point_text(const run *r, const double *x, char text[160]) {
  int at = 0;
  for (int i = 0; i < r->n && at < 130; i++)
    at += snprintf(text + at, 160 - (size_t)at, "%s%.6g", i ? ", " : "", x[i]);
  if (at >= 130)
    snprintf(text + at, 160 - (size_t)at, ", ...");
  return text;
}

static bw_status check_solution(run *r, int which, const double *x, double value,
                                const double *gradient) {
  char name[40], at[160];
  bool ok = r->method->models ? isfinite(value) : !isnan(value) && value != -INFINITY;
  if (!ok)
    return bw_fail(r->context, BW_CONVERGENCE,
                   "%s is %g at (%s): %s expects a %s; give a large number where there is no value",
                   name_of(which, name), value, point_text(r, x, at), r->method->word,
                   r->method->models ? "finite number" : "number");
  for (int i = 0; gradient && i < r->n; i++)
    if (!isfinite(gradient[i]))
      return bw_fail(r->context, BW_CONVERGENCE,
                     "the gradient of %s by variable %d is %g at (%s): a finite number expected",
                     name_of(which, name), i + 1, gradient[i], point_text(r, x, at));
  return BW_OK;
}

static void remember(run *r, int which, const double *x, double value) {
  size_t size = (size_t)r->n * sizeof *x;
  if (r->known == 0 || memcmp(r->here, x, size) != 0) {
    memcpy(r->here, x, size);
    memset(r->seen, 0, (size_t)r->constraints + 1);
    r->known = 0;
    r->violation = 0;
  }
  r->known += !r->seen[which];
  r->seen[which] = 1;
  if (which == 0)
    r->value = value;
  else
    r->violation = fmax(r->violation, value);
  if (r->known == r->constraints + 1 && r->violation <= r->tolerance && r->value < r->best_value) {
    r->best_value = r->value;
    r->best_violation = r->violation;
    memcpy(r->best, x, size);
  }
}

static double ask(unsigned n, const double *x, double *gradient, void *data) {
  const callback *f = (const callback *)data;
  run *r = f->run;
  double value = 0;
  if (gradient)
    memset(gradient, 0, n * sizeof *gradient);
  if (r->failure != BW_OK || r->wrong_point || r->over_limit)
    return 0;
  for (unsigned i = 0; i < n; i++)
    r->wrong_point = r->wrong_point || !isfinite(x[i]);
  r->over_limit = f->which == 0 && r->evaluations == r->max_evaluations;
  if (!r->wrong_point && !r->over_limit) {
    r->failure = bw_check_cancel(r->context);
    if (r->failure == BW_OK)
      r->failure = r->function(r->context, r->data, f->which, x, &value, gradient);
    if (r->failure == BW_OK)
      r->failure = check_solution(r, f->which, x, value, gradient);
    r->evaluations += f->which == 0;
  }
  if (r->failure != BW_OK || r->wrong_point || r->over_limit) {
    nlopt_force_stop(r->nlopt);
    return 0;
  }
  remember(r, f->which, x, value);
  return value;
}

/* ---- checks ---------------------------------------------------------------------------------- */

/* "cobyla, isres, mma, slsqp" */
static void list_methods(bool constraints, bool local, char text[160]) {
  int at = 0;
  text[0] = 0;
  for (int i = 0; i < METHODS; i++)
    if ((!constraints || methods[i].constraints) && (!local || !methods[i].global))
      at += snprintf(text + at, 160 - (size_t)at, "%s%s", at ? ", " : "", methods[i].word);
}

static bw_status check(bw_context *context, const method *m, int n, const double *x,
                       const double *min, const double *max, int constraints,
                       const bw_minimise_options *o) {
  char others[160];
  if (n < 1)
    return bw_fail(context, BW_INVALID, "%d variables to minimise over: at least 1 expected", n);
  if (m->algorithm == NLOPT_LN_BOBYQA && n < 2)
    return bw_fail(context, BW_INVALID, "bobyqa works on 2 or more variables: use cobyla for one");
  list_methods(true, false, others);
  if (constraints > 0 && !m->constraints)
    return bw_fail(context, BW_INVALID, "%s takes no constraints; these methods do: %s", m->word,
                   others);
  list_methods(false, true, others);
  for (int i = 0; i < n; i++) {
    double low = min ? min[i] : -INFINITY, high = max ? max[i] : INFINITY;
    if (m->global && !(isfinite(low) && isfinite(high)))
      return bw_fail(
          context, BW_INVALID,
          "%s searches between bounds, and variable %d lacks one; these methods need none: %s",
          m->word, i + 1, others);
    if (!(low <= high))
      return bw_fail(
          context, BW_INVALID,
          "variable %d: bounds from %g to %g: the lower one must not exceed the upper one", i + 1,
          low, high);
    if (!(x[i] >= low && x[i] <= high))
      return bw_fail(context, BW_INVALID, "variable %d starts at %g, outside of %g to %g", i + 1,
                     x[i], low, high);
    if (o->step && !(isfinite(o->step[i]) && o->step[i] > 0))
      return bw_fail(context, BW_INVALID,
                     "variable %d: a first step of %g: a positive number expected", i + 1,
                     o->step[i]);
  }
  if (!(o->tolerance >= 0) || !(o->value_tolerance >= 0) || !(o->constraint_tolerance >= 0))
    return bw_fail(context, BW_INVALID,
                   "tolerance %g, value_tolerance %g, constraint_tolerance %g: 0 or more expected",
                   o->tolerance, o->value_tolerance, o->constraint_tolerance);
  if (o->evaluations < 1 || o->evaluations > INT32_MAX)
    return bw_fail(context, BW_INVALID, "%lld evaluations: 1 to 2147483647 expected",
                   (long long)o->evaluations);
  if (o->population < 0)
    return bw_fail(context, BW_INVALID,
                   "a population of %d: 0 for the method's default, or more, expected",
                   o->population);
  return BW_OK;
}

/* ---- a run ----------------------------------------------------------------------------------- */

static nlopt_result prepare(nlopt_opt nlopt, const double *min, const double *max, int constraints,
                            callback *callbacks, const bw_minimise_options *o) {
  nlopt_result got = nlopt_set_min_objective(nlopt, ask, &callbacks[0]);
  if (got > 0 && min)
    got = nlopt_set_lower_bounds(nlopt, min);
  if (got > 0 && max)
    got = nlopt_set_upper_bounds(nlopt, max);
  for (int i = 1; i <= constraints && got > 0; i++)
    got = nlopt_add_inequality_constraint(nlopt, ask, &callbacks[i], o->constraint_tolerance);
  if (got > 0 && o->tolerance > 0)
    got = nlopt_set_xtol_rel(nlopt, o->tolerance);
  if (got > 0 && o->value_tolerance > 0)
    got = nlopt_set_ftol_rel(nlopt, o->value_tolerance);
  if (got > 0 && o->good_enough > -INFINITY)
    got = nlopt_set_stopval(nlopt, o->good_enough);
  if (got > 0)
    got = nlopt_set_maxeval(nlopt, (int)o->evaluations);
  if (got > 0 && o->population > 0)
    got = nlopt_set_population(nlopt, (unsigned)o->population);
  if (got > 0 && o->step)
    got = nlopt_set_initial_step(nlopt, o->step);
  nlopt_srand((unsigned long)o->seed);
  return got;
}

static bw_status outcome(run *r, nlopt_result got, bw_minimise_result *result) {
  if (r->failure != BW_OK)
    return r->failure;
  if (r->over_limit)
    got = NLOPT_MAXEVAL_REACHED;
  switch (got) {
  case NLOPT_SUCCESS:
  case NLOPT_FTOL_REACHED:
  case NLOPT_XTOL_REACHED:
    result->end = BW_END_TOLERANCE;
    return BW_OK;
  case NLOPT_STOPVAL_REACHED:
    result->end = BW_END_GOOD_ENOUGH;
    return BW_OK;
  case NLOPT_MAXEVAL_REACHED:
  case NLOPT_MAXTIME_REACHED:
    result->end = BW_END_EVALUATIONS;
    return BW_OK;
  case NLOPT_ROUNDOFF_LIMITED:
    result->end = BW_END_ROUNDOFF;
    return BW_OK;
  case NLOPT_OUT_OF_MEMORY:
    return bw_fail(r->context, BW_MEMORY, "no memory to minimise over %d variables by %s", r->n,
                   r->method->word);
  case NLOPT_INVALID_ARGS:
    return bw_fail(r->context, BW_INVALID, "%s does not take these arguments%s%s", r->method->word,
                   nlopt_get_errmsg(r->nlopt) ? ": " : "",
                   nlopt_get_errmsg(r->nlopt) ? nlopt_get_errmsg(r->nlopt) : "");
  default: /* NLOPT_FAILURE, or stopped at a wrong point */
    result->end = BW_END_STUCK;
    return r->evaluations > 0 ? BW_OK
                              : bw_fail(r->context, BW_CONVERGENCE,
                                        "%s failed before its first evaluation", r->method->word);
  }
}

/* The largest constraint at x. */
static bw_status measure(run *r, const double *x, bw_minimise_result *result) {
  for (int i = 1; i <= r->constraints; i++) {
    double value = 0;
    bw_status status = r->function(r->context, r->data, i, x, &value, NULL);
    if (status != BW_OK)
      return status;
    result->violation = fmax(result->violation, value);
  }
  return BW_OK;
}

bw_status bw_minimise(bw_context *context, int n, double *x, const double *min, const double *max,
                      int constraints, bw_minimised *function, void *data,
                      const bw_minimise_options *options, bw_minimise_result *result) {
  bw_minimise_options defaults;
  bw_minimise_options_default(&defaults);
  options = options ? options : &defaults;
  if ((int)options->method < 0 || (int)options->method >= METHODS)
    return bw_fail(context, BW_INVALID, "minimiser %d is not known", (int)options->method);
  const method *m = &methods[options->method];
  bw_status status = check(context, m, n, x, min, max, constraints, options);
  if (status != BW_OK)
    return status;
  run r = {.context = context,
           .function = function,
           .data = data,
           .method = m,
           .n = n,
           .constraints = constraints,
           .tolerance = options->constraint_tolerance,
           .max_evaluations = options->evaluations,
           .best_value = INFINITY};
  bw_minimise_result found = {.value = INFINITY};
  callback *callbacks = BW_NEW(context, callback, constraints + 1);
  double *at = BW_NEW(context, double, n);
  r.best = BW_NEW(context, double, n);
  r.here = BW_NEW(context, double, n);
  r.seen = BW_NEW(context, uint8_t, constraints + 1);
  BW_TRY_MEMORY(callbacks && at && r.best && r.here && r.seen);
  memcpy(at, x, (size_t)n * sizeof *at);
  for (int i = 0; i <= constraints; i++)
    callbacks[i] = (callback){&r, i};
  r.nlopt = nlopt_create(m->algorithm, (unsigned)n);
  nlopt_result got =
      r.nlopt ? prepare(r.nlopt, min, max, constraints, callbacks, options) : NLOPT_OUT_OF_MEMORY;
  if (got > 0)
    got = nlopt_optimize(r.nlopt, at, &found.value);
  BW_TRY(outcome(&r, got, &found));
  found.evaluations = r.evaluations;
  if (r.best_value < INFINITY) {
    memcpy(at, r.best, (size_t)n * sizeof *at);
    found.value = r.best_value;
    found.violation = r.best_violation;
  } else
    BW_TRY(measure(&r, at, &found));
  memcpy(x, at, (size_t)n * sizeof *x);
  *result = found;
  if (!(found.violation <= options->constraint_tolerance)) {
    status = bw_fail(
        context, BW_INFEASIBLE,
        "%s found no point that satisfies the constraints: the largest is %g at the end "
        "(%lld evaluations; %s)",
        m->word, found.violation, (long long)found.evaluations, bw_minimise_end_word(found.end));
    bw_detail_number(context, "violation", found.violation);
    bw_detail_number(context, "evaluations", (double)found.evaluations);
  }
done:
  nlopt_destroy(r.nlopt);
  bw_free(callbacks);
  bw_free(at);
  bw_free(r.best);
  bw_free(r.here);
  bw_free(r.seen);
  return status;
}
