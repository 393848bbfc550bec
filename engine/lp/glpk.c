/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* GLPK's simplex methods.
 *
 * GLPK keeps its state in a thread-local environment and aborts on an error unless a hook takes
 * over. The hook here jumps back into the function that called GLPK; the environment is then only
 * fit to be freed, and with it goes the problem. A host program may use GLPK in the same thread for
 * its own ends, so an environment that was there before is left as it was found, unless the
 * hook has jumped.
 *
 * Cancelling goes the same way: GLPK asks for its terminal several times a second, and the hook
 * that takes what it would write jumps back. Nothing is written. */
#include "lp/solver.h"

#include <glpk.h>
#include <math.h>
#include <setjmp.h>
#include <string.h>

enum { ASK_EVERY = 100 /* ms */ };

typedef struct glpk_state {
  const bwi_linear_program *program;
  bw_context *context; /* of the call at work */
  int max_iterations;
  bool cancelled;
  glp_prob *problem; /* NULL after an error */
  bool own_environment;
  int terminal; /* the environment's own setting, to be put back */
  jmp_buf escape;
} glpk_state;

static void on_error(void *data) {
  longjmp(((glpk_state *)data)->escape, 1);
}

static int on_output(void *data, const char *text) {
  glpk_state *glpk = data;
  (void)text;
  if (bw_cancelled(glpk->context)) {
    glpk->cancelled = true;
    longjmp(glpk->escape, 1);
  }
  return 1;
}

/* After a jump: the environment has to go. */
static bw_status lost(bw_context *context, glpk_state *glpk) {
  glpk->problem = NULL;
  glpk->own_environment = false;
  glp_free_env();
  if (glpk->cancelled)
    return bw_check_cancel(context);
  return bw_fail(context, BW_CONVERGENCE,
                 "GLPK failed on a linear program of %d rows and %d columns (out of memory, or an "
                 "internal error)",
                 glpk->program->rows, glpk->program->columns);
}

static void enter(bw_context *context, glpk_state *glpk) {
  glpk->context = context;
  glp_error_hook(on_error, glpk);
  glp_term_hook(on_output, glpk);
}

static void leave(glpk_state *glpk) {
  glp_error_hook(NULL, NULL);
  glp_term_hook(NULL, NULL);
  if (!glpk->own_environment)
    glp_term_out(glpk->terminal);
}

/* With friction a row for each group follows those of the linear program. */
static int group_rows(const bwi_linear_program *program) {
  return program->grouped ? program->groups : 0;
}

static void fill_problem(glpk_state *glpk, int *row, int *column, double *value) {
  const bwi_linear_program *program = glpk->program;
  int m = program->rows, n = program->columns, entries = 0;
  glp_set_obj_dir(glpk->problem, GLP_MAX);
  glp_add_rows(glpk->problem, m + group_rows(program));
  for (int i = 1; i <= m; i++)
    glp_set_row_bnds(glpk->problem, i, GLP_FX, i == m, i == m);
  for (int g = 0; g < group_rows(program); g++)
    glp_set_row_bnds(glpk->problem, m + 1 + g, GLP_UP, 0, program->upper[program->group_start[g]]);
  glp_add_cols(glpk->problem, n);
  for (int j = 0; j < n; j++) {
    glp_set_col_bnds(glpk->problem, j + 1, group_rows(program) > 0 ? GLP_LO : GLP_DB, 0,
                     program->upper[j]);
    for (int l = 0; l <= program->row_count[j]; l++) {
      bool last = l == program->row_count[j];
      double v = last ? 1 : program->entry[(size_t)l * (size_t)n + (size_t)j];
      if (v == 0)
        continue;
      entries++;
      row[entries] = last ? m : program->first_row[j] + l + 1;
      column[entries] = j + 1;
      value[entries] = v;
    }
    if (group_rows(program) > 0) {
      entries++;
      row[entries] = m + 1 + program->group[j];
      column[entries] = j + 1;
      value[entries] = 1;
    }
  }
  glp_load_matrix(glpk->problem, entries, row, column, value);
}

static bw_status glpk_open(bw_context *context, const bwi_linear_program *program,
                           int max_iterations, void **result) {
  glpk_state *volatile glpk = BW_NEW0(context, glpk_state, 1);
  volatile bw_status status = BW_OK;
  size_t capacity = (size_t)program->columns * (BWI_LOCAL_ROWS + 2) + 1;
  int *volatile row = BW_NEW(context, int, capacity);
  int *volatile column = BW_NEW(context, int, capacity);
  double *volatile value = BW_NEW(context, double, capacity);
  BW_TRY_MEMORY(glpk && row && column && value);
  glpk->program = program;
  glpk->max_iterations = max_iterations;
  int fresh = glp_init_env();
  if (fresh > 1)
    BW_TRY(bw_fail(context, BW_MEMORY, "GLPK found no memory to start"));
  glpk->own_environment = fresh == 0;
  if (setjmp(glpk->escape) == 0) {
    glpk->terminal = glp_term_out(GLP_ON);
    enter(context, glpk);
    glpk->problem = glp_create_prob();
    fill_problem(glpk, row, column, value);
    leave(glpk);
  } else {
    status = lost(context, glpk);
  }
done:
  bw_free(row);
  bw_free(column);
  bw_free(value);
  if (status == BW_OK)
    *result = glpk;
  else
    bw_free(glpk);
  return status;
}

/* A full group has no slack: the largest of its basic columns is the one at the upper bound. */
static void full_groups(glp_prob *problem, const bwi_linear_program *program, uint8_t *at_upper) {
  for (int g = 0; g < group_rows(program); g++) {
    int largest = -1;
    if (glp_get_row_stat(problem, program->rows + 1 + g) == GLP_BS)
      continue;
    for (int j = program->group_start[g]; j < program->group_start[g + 1]; j++)
      if (glp_get_col_stat(problem, j + 1) == GLP_BS &&
          (largest < 0 ||
           glp_get_col_prim(problem, j + 1) > glp_get_col_prim(problem, largest + 1)))
        largest = j;
    if (largest >= 0)
      at_upper[largest] = 1;
  }
}

static const char *trouble(int code, int state) {
  switch (code) {
  case GLP_EITLIM:
    return "the iteration limit was reached";
  case GLP_ETMLIM:
    return "the time limit was reached";
  case GLP_ESING:
  case GLP_ECOND:
    return "the basis is singular";
  case GLP_EFAIL:
    return "numerical difficulties";
  case 0:
    return state == GLP_NOFEAS  ? "no feasible point"
           : state == GLP_UNBND ? "no bound"
                                : "no optimal point";
  default:
    return "an unexpected state";
  }
}

static bw_status glpk_solve(bw_context *context, void *state, const double *cost, int attempt,
                            bwi_vertex *vertex) {
  glpk_state *glpk = state;
  const bwi_linear_program *program = glpk->program;
  int m = program->rows, n = program->columns;
  if (!glpk->problem)
    return bw_fail(context, BW_CONVERGENCE, "GLPK is not usable after an error");
  if (setjmp(glpk->escape) != 0)
    return lost(context, glpk);
  glp_term_out(GLP_ON);
  enter(context, glpk);
  for (int j = 0; j < n; j++)
    glp_set_obj_coef(glpk->problem, j + 1, cost[j]);
  /* Always from the same start: what was solved before must not show. */
  glp_std_basis(glpk->problem);
  glp_set_it_cnt(glpk->problem, 0);
  if (attempt > 0)
    glp_scale_prob(glpk->problem, GLP_SF_AUTO);
  else
    glp_unscale_prob(glpk->problem);
  glp_smcp control;
  glp_init_smcp(&control);
  control.msg_lev = GLP_MSG_ON;
  control.out_frq = ASK_EVERY;
  control.meth = attempt < 2 ? GLP_DUAL : GLP_PRIMAL;
  control.r_test = attempt == 0 ? GLP_RT_FLIP : GLP_RT_HAR;
  control.tol_bnd = 1e-10;
  control.tol_dj = 1e-10;
  control.it_lim =
      glpk->max_iterations > 0 ? glpk->max_iterations : 1000 * m + 4 * n + 4 * group_rows(program);
  int code = glp_simplex(glpk->problem, &control);
  int found = glp_get_status(glpk->problem);
  bw_status status = BW_OK;
  if (code != 0 || found != GLP_OPT) {
    status = bw_fail(context, BW_CONVERGENCE,
                     "GLPK did not solve a linear program of %d rows and %d columns: %s", m, n,
                     trouble(code, found));
  } else {
    int basics = 0;
    for (int i = 0; i < m; i++)
      if (glp_get_row_stat(glpk->problem, i + 1) == GLP_BS)
        vertex->basic[basics++] = -1 - i;
    for (int j = 0; j < n; j++)
      vertex->at_upper[j] = glp_get_col_stat(glpk->problem, j + 1) == GLP_NU;
    full_groups(glpk->problem, program, vertex->at_upper);
    for (int j = 0; j < n; j++)
      if (glp_get_col_stat(glpk->problem, j + 1) == GLP_BS && !vertex->at_upper[j] && basics < m)
        vertex->basic[basics++] = j;
    vertex->iterations = glp_get_it_cnt(glpk->problem);
  }
  leave(glpk);
  return status;
}

static void glpk_close(void *state) {
  glpk_state *glpk = state;
  if (!glpk)
    return;
  if (glpk->problem && setjmp(glpk->escape) == 0) {
    glp_error_hook(on_error, glpk);
    glp_delete_prob(glpk->problem);
    glp_error_hook(NULL, NULL);
  }
  if (glpk->own_environment)
    glp_free_env();
  bw_free(glpk);
}

/* ---- what it costs ------------------------------------------------------------------------- */

/* A non-zero has a value and an index; an iteration forms a row of the tableau and updates reduced
 * costs and weights. Loading makes an element with four links of each non-zero. */
enum {
  BYTES_OF_ENTRY = 12,
  PRODUCTS = 2,
  VECTORS = 40,
  ITERATIONS_OF_ROW = 6,
  BYTES_OF_ELEMENT = 48
};

static double entries_of(const bwi_linear_program *program) {
  double count = program->columns * (program->grouped ? 2.0 : 1.0);
  for (int32_t k = 0; k < program->segment_count; k++) {
    const bwi_segment *segment = &program->segment[k];
    count += (double)segment->rows * (segment->end - segment->begin);
  }
  return count;
}

/* A group that is full at the optimum has a row of its own to be pivoted on. */
static double expected_iterations(const bwi_linear_program *program) {
  double upper = 0, iterations = ITERATIONS_OF_ROW * (double)program->rows;
  if (!program->grouped)
    return iterations;
  for (int32_t g = 0; g < program->groups; g++)
    upper += program->upper[program->group_start[g]];
  return iterations + program->groups / fmax(upper, 1);
}

static bwi_lp_cost cost_of(const bwi_linear_program *program, double iterations) {
  double vectors = VECTORS * 8.0 * (program->columns + program->rows + group_rows(program));
  double entries = entries_of(program);
  return (bwi_lp_cost){2 * iterations * entries,
                       iterations * (PRODUCTS * BYTES_OF_ENTRY * entries + vectors)};
}

static bwi_lp_cost open_cost(const bwi_linear_program *program) {
  return (bwi_lp_cost){0, (BYTES_OF_ELEMENT + 2 * 16) * entries_of(program)};
}

static double memory_of(const bwi_linear_program *program) {
  double vectors = VECTORS * 8.0 * (program->columns + program->rows + group_rows(program));
  return (BYTES_OF_ELEMENT + BYTES_OF_ENTRY) * entries_of(program) + vectors;
}

const bwi_lp_method bwi_lp_glpk = {.name = "glpk",
                                   .solver = "simplex",
                                   .backend = "glpk",
                                   .attempts = 3,
                                   .open = glpk_open,
                                   .solve = glpk_solve,
                                   .close = glpk_close,
                                   .of_thread = true,
                                   .open_cost = open_cost,
                                   .cost = cost_of,
                                   .iterations = expected_iterations,
                                   .memory = memory_of};
