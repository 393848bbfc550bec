/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear solvers as descriptions (bw_solver): the checks of their options, and their words. */
#include <stdio.h>
#include <string.h>

#include "linear/pcg.h"

static const char *const kind_words[] = {"cholesky", "pcg", "two_level", "amg",
                                         "jacobi",   "lu",  "bicgstab"};
static const char *const backend_words[] = {"auto", "multifrontal", "cholmod", "petsc"};
static const char *const ordering_words[] = {"auto", "metis", "amd", "backend"};

const char *bw_solver_word(bw_solver_kind kind) {
  return kind_words[kind];
}

const char *bw_backend_word(bw_backend backend) {
  return backend_words[backend];
}

const char *bw_ordering_word(bw_ordering ordering) {
  return ordering_words[ordering];
}

static void solver_destroy(void *object) {
  bw_solver *solver = object;
  bw_release(solver->options.preconditioner);
  bw_free(solver);
}

static size_t solver_bytes(const void *object) {
  const bw_solver *solver = object;
  return sizeof *solver;
}

static const bw_kind solver_kind = {"solver", solver_destroy, solver_bytes};

/* ---- checks ---------------------------------------------------------------------------------- */

/* Bits of what each backend of a factor has. */
enum { HAS_ORDERING = 1, HAS_SINGLE = 2 };
static const unsigned backend_has[] = {[BW_BACKEND_AUTO] = HAS_ORDERING | HAS_SINGLE,
                                       [BW_BACKEND_MULTIFRONTAL] = HAS_ORDERING | HAS_SINGLE,
                                       [BW_BACKEND_CHOLMOD] = HAS_ORDERING,
                                       [BW_BACKEND_PETSC] = 0};

static bw_status lacks(bw_context *context, bw_backend backend, const char *what) {
  return bw_fail(context, BW_INVALID, "the backend \"%s\" has no %s", bw_backend_word(backend),
                 what);
}

static bw_status check_factor(bw_context *context, const bw_solver_options *o) {
  unsigned has = backend_has[o->backend];
  if (o->precision != 0 && o->precision != 32 && o->precision != 64)
    return bw_fail(context, BW_INVALID, "the factor's precision is 32 or 64 bits, not %d",
                   o->precision);
  if (o->precision == 32 && !(has & HAS_SINGLE))
    return lacks(context, o->backend, "factor in single precision");
  if (!(has & HAS_ORDERING) && (o->ordering == BW_ORDERING_METIS || o->ordering == BW_ORDERING_AMD))
    return lacks(context, o->backend, "choice of the ordering: it takes its own");
  return BW_OK;
}

static bool is_iterative(bw_solver_kind kind) {
  return kind == BW_SOLVER_PCG || kind == BW_SOLVER_BICGSTAB;
}

static bw_status check_iterative(bw_context *context, const bw_solver_options *o) {
  const bw_solver *m = o->preconditioner;
  if (o->tolerance != 0 && !(o->tolerance > 0 && o->tolerance < 1))
    return bw_fail(context, BW_INVALID, "the tolerance of %s is %g; it must lie between 0 and 1",
                   bw_solver_word(o->kind), o->tolerance);
  if (o->max_iterations < 0)
    return bw_fail(context, BW_INVALID, "%d iterations: at least 1 expected", o->max_iterations);
  if (m && is_iterative(m->options.kind))
    return bw_fail(context, BW_INVALID,
                   "conjugate gradients as preconditioner of conjugate gradients are not "
                   "implemented: they are not linear");
  if (m && (m->options.kind == BW_SOLVER_LU) != (o->kind == BW_SOLVER_BICGSTAB))
    return bw_fail(context, BW_INVALID, "%s does not precondition %s: %s",
                   bw_solver_word(m->options.kind), bw_solver_word(o->kind),
                   o->kind == BW_SOLVER_PCG ? "it is not symmetric" : "lu does");
  if (m && m->options.kind == BW_SOLVER_CHOLESKY && m->options.backend == BW_BACKEND_PETSC)
    return lacks(context, BW_BACKEND_PETSC, "factor that preconditions");
  return BW_OK;
}

/* Options of other kinds, which would be without effect. */
static bw_status check_foreign(bw_context *context, const bw_solver_options *o) {
  const char *key = NULL, *word = bw_solver_word(o->kind);
  bool factor = o->kind == BW_SOLVER_CHOLESKY, iterative = is_iterative(o->kind);
  if (!factor && o->kind != BW_SOLVER_AMG && o->backend != BW_BACKEND_AUTO)
    key = "backend";
  else if (!factor && o->ordering != BW_ORDERING_AUTO)
    key = "ordering";
  else if (!factor && o->precision != 0)
    key = "precision";
  else if (!factor && o->kind != BW_SOLVER_LU && o->full)
    key = "full";
  else if (!iterative && o->preconditioner)
    key = "preconditioner";
  else if (!iterative && o->tolerance != 0)
    key = "tolerance";
  else if (!iterative && o->max_iterations != 0)
    key = "max_iterations";
  return key ? bw_fail(context, BW_INVALID, "the solver \"%s\" has no option '%s'", word, key)
             : BW_OK;
}

static bw_status check(bw_context *context, const bw_solver_options *o) {
  bw_status status = BW_OK;
  if ((unsigned)o->kind > BW_SOLVER_BICGSTAB || (unsigned)o->backend > BW_BACKEND_PETSC ||
      (unsigned)o->ordering > BW_ORDERING_BACKEND)
    return bw_fail(context, BW_INVALID, "solver %d, backend %d or ordering %d is not known",
                   (int)o->kind, (int)o->backend, (int)o->ordering);
  BW_TRY(check_foreign(context, o));
  if (o->kind == BW_SOLVER_CHOLESKY)
    BW_TRY(check_factor(context, o));
  if (is_iterative(o->kind))
    BW_TRY(check_iterative(context, o));
  if (o->kind == BW_SOLVER_AMG && o->backend != BW_BACKEND_AUTO && o->backend != BW_BACKEND_PETSC)
    status = lacks(context, o->backend, "algebraic multigrid");
done:
  return status;
}

bw_status bwi_solver_refused(bw_context *context, const bw_solver *solver) {
  bw_solver_kind kind = solver->options.kind;
  const char *word = bw_solver_word(kind);
  if (kind == BW_SOLVER_LU || kind == BW_SOLVER_BICGSTAB)
    return bw_fail(context, BW_INVALID,
                   "\"%s\" is for the unsymmetric equations of flows, these are symmetric: give "
                   "cholesky or pcg",
                   word);
  return bw_fail(context, BW_INVALID, "\"%s\" is a preconditioner and no solver: give it to pcg",
                 word);
}

bw_status bwi_two_level_refused(bw_context *context, const char *instead) {
  return bw_fail(
      context, BW_INVALID,
      "the two-level preconditioner needs quadratic elements, and these are linear: give "
      "%s",
      instead);
}

/* ---- life ------------------------------------------------------------------------------------ */

bw_status bw_solver_create(bw_context *context, const bw_solver_options *options,
                           bw_solver **solver) {
  bw_status status = check(context, options);
  if (status != BW_OK)
    return status;
  bw_solver *made = BW_NEW0(context, bw_solver, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &solver_kind);
  made->options = *options;
  bw_retain(options->preconditioner);
  *solver = made;
  return BW_OK;
}

/* Words of what is not the default, separated by commas. */
static void add(char *list, size_t size, const char *word) {
  size_t used = strlen(list);
  snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", word);
}

static void describe(const bw_solver_options *o, char *text, size_t size) {
  char list[200] = "", inner[100], number[64];
  if (o->backend != BW_BACKEND_AUTO)
    add(list, sizeof list, bw_backend_word(o->backend));
  if (o->ordering != BW_ORDERING_AUTO) {
    snprintf(inner, sizeof inner, "ordering %s", bw_ordering_word(o->ordering));
    add(list, sizeof list, inner);
  }
  if (o->precision != 0) {
    snprintf(number, sizeof number, "%d bits", o->precision);
    add(list, sizeof list, number);
  }
  if (o->full)
    add(list, sizeof list, "full refactorisation");
  if (is_iterative(o->kind)) {
    if (o->preconditioner)
      describe(&o->preconditioner->options, inner, sizeof inner);
    else
      snprintf(inner, sizeof inner, "%s",
               bw_solver_word(o->kind == BW_SOLVER_PCG ? BW_SOLVER_TWO_LEVEL : BW_SOLVER_LU));
    add(list, sizeof list, inner);
    if (o->tolerance > 0) {
      snprintf(number, sizeof number, "tolerance %g", o->tolerance);
      add(list, sizeof list, number);
    }
    if (o->max_iterations > 0) {
      snprintf(number, sizeof number, "at most %d iterations", o->max_iterations);
      add(list, sizeof list, number);
    }
  }
  bool some = list[0] != 0;
  snprintf(text, size, "%s%s%s%s", bw_solver_word(o->kind), some ? " (" : "", list,
           some ? ")" : "");
}

void bw_solver_describe(const bw_solver *solver, char text[BW_SOLVER_TEXT]) {
  if (solver)
    describe(&solver->options, text, BW_SOLVER_TEXT);
  else
    snprintf(text, BW_SOLVER_TEXT, "auto");
}
