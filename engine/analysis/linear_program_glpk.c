/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The linear program by GLPK.
 *
 * GLPK keeps its state in a thread-local environment and aborts on an error unless a hook takes
 * over. The hook here jumps back into the function that called GLPK; the environment is then only
 * fit to be freed, and with it goes the problem. A host program may use GLPK in the same thread for
 * its own ends, so an environment that was there before is left as it was found. */
#include "analysis/linear_program.h"

#include <glpk.h>
#include <setjmp.h>
#include <string.h>

struct bwi_glpk {
  const bwi_linear_program *program;
  glp_prob *problem; /* NULL after an error */
  bool own_environment;
  int terminal; /* the environment's own setting, to be put back */
  jmp_buf escape;
};

static void on_error(void *data) {
  longjmp(((bwi_glpk *)data)->escape, 1);
}

/* After an error: the environment has to go. */
static bw_status lost(bw_context *context, bwi_glpk *glpk) {
  glpk->problem = NULL;
  glpk->own_environment = false;
  glp_free_env();
  return bw_fail(context, BW_CONVERGENCE,
                 "GLPK failed on a linear program of %d rows and %d columns (out of memory, or an "
                 "internal error)",
                 glpk->program->rows, glpk->program->columns);
}

static void leave(bwi_glpk *glpk) {
  glp_error_hook(NULL, NULL);
  if (!glpk->own_environment)
    glp_term_out(glpk->terminal);
}

/* With friction a row for each group follows those of the linear program. */
static int group_rows(const bwi_linear_program *program) {
  return program->directions > 1 ? program->groups : 0;
}

static void fill_problem(bwi_glpk *glpk, int *row, int *column, double *value) {
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

bw_status bwi_glpk_create(bw_context *context, const bwi_linear_program *program,
                          bwi_glpk **result) {
  bwi_glpk *volatile glpk = BW_NEW0(context, bwi_glpk, 1);
  volatile bw_status status = BW_OK;
  size_t capacity = (size_t)program->columns * (BWI_LOCAL_ROWS + 2) + 1;
  int *volatile row = BW_NEW(context, int, capacity);
  int *volatile column = BW_NEW(context, int, capacity);
  double *volatile value = BW_NEW(context, double, capacity);
  if (!glpk || !row || !column || !value) {
    status = BW_MEMORY;
    goto done;
  }
  glpk->program = program;
  int fresh = glp_init_env();
  if (fresh > 1) {
    status = bw_fail(context, BW_MEMORY, "GLPK found no memory to start");
    goto done;
  }
  glpk->own_environment = fresh == 0;
  if (setjmp(glpk->escape) == 0) {
    glp_error_hook(on_error, glpk);
    glpk->terminal = glp_term_out(GLP_OFF);
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

bw_status bwi_glpk_solve(bw_context *context, bwi_glpk *glpk, const double *cost, int attempt,
                         bwi_vertex *vertex) {
  const bwi_linear_program *program = glpk->program;
  int m = program->rows, n = program->columns;
  if (!glpk->problem)
    return bw_fail(context, BW_CONVERGENCE, "GLPK is not usable after an error");
  if (setjmp(glpk->escape) != 0)
    return lost(context, glpk);
  glp_error_hook(on_error, glpk);
  glp_term_out(GLP_OFF);
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
  control.msg_lev = GLP_MSG_OFF;
  control.meth = attempt < 2 ? GLP_DUAL : GLP_PRIMAL;
  control.r_test = attempt == 0 ? GLP_RT_FLIP : GLP_RT_HAR;
  control.tol_bnd = 1e-10;
  control.tol_dj = 1e-10;
  control.it_lim = 1000 * m + 4 * n + 4 * group_rows(program);
  int code = glp_simplex(glpk->problem, &control);
  int state = glp_get_status(glpk->problem);
  bw_status status = BW_OK;
  if (code != 0 || state != GLP_OPT) {
    status = bw_fail(context, BW_CONVERGENCE,
                     "GLPK did not solve a linear program of %d rows and %d columns: %s", m, n,
                     trouble(code, state));
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

void bwi_glpk_destroy(bwi_glpk *glpk) {
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
