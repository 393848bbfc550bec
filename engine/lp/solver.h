/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* One interface to the solvers of linear programs: which one is taken, and how many programs with
 * the same rows and columns are solved by it. An answer is judged by its own violation and duality
 * gap before it is believed. */
#ifndef BARWRIGHT_LP_SOLVER_H
#define BARWRIGHT_LP_SOLVER_H

#include "lp/linear_program.h"

/* What a solver costs: operations and bytes moved. */
typedef struct bwi_lp_cost {
  double flops, bytes;
} bwi_lp_cost;

/* One of the solvers. */
typedef struct bwi_lp_method {
  const char *name, *solver, *backend; /* the last two as in bw_solver_report */
  int attempts;                        /* ways to solve a program, in the order they are tried */
  bw_status (*open)(bw_context *context, const bwi_linear_program *program, int max_iterations,
                    void **state);
  /* Where it ends. BW_CONVERGENCE where this attempt finds no optimum. The same costs give the same
   * vertex, whatever was solved before. */
  bw_status (*solve)(bw_context *context, void *state, const double *cost, int attempt,
                     bwi_vertex *vertex);
  void (*close)(void *state); /* NULL is fine */
  bool of_thread;             /* the state serves only the thread that opened it */
  bwi_lp_cost (*open_cost)(const bwi_linear_program *program);
  /* Of so many iterations. */
  bwi_lp_cost (*cost)(const bwi_linear_program *program, double iterations);
  double (*iterations)(const bwi_linear_program *program); /* expected */
  double (*memory)(const bwi_linear_program *program);     /* bytes of a state */
} bwi_lp_method;
extern const bwi_lp_method bwi_lp_dual_simplex, bwi_lp_glpk;

/* Who solves the programs. */
typedef struct bwi_lp_choice {
  const bwi_lp_method *method,
      *other; /* other: asked where the first fails; NULL for a given one */
  int max_iterations;
  double predicted, rival; /* s of the reference machine for a program; 0: there was no choice */
  char reason[160];
} bwi_lp_choice;
/* `solver` may be NULL: auto. */
void bwi_lp_choose(const bwi_linear_program *program, const bw_lp_solver *solver,
                   bwi_lp_choice *choice);
/* How many of `count` programs a thread takes at once. */
int64_t bwi_lp_grain(const bwi_lp_choice *choice, int64_t count);

/* What was done: sums, and the largest violation. */
typedef struct bwi_lp_counts {
  int64_t programs, by_other, iterations;
  double flops, seconds, violation;
} bwi_lp_counts;
void bwi_lp_counts_add(bwi_lp_counts *sum, const bwi_lp_counts *term);
void bwi_lp_report(const bwi_lp_choice *choice, const bwi_linear_program *program, int states,
                   const bwi_lp_counts *counts, bw_solver_report *report);

/* The scratch memory of one thread at a time. */
typedef struct bwi_lp_workspace {
  const bwi_linear_program *program; /* borrowed, like the choice */
  const bwi_lp_choice *choice;
  void *state[2]; /* of choice->method and choice->other; NULL: not opened */
  bwi_vertex vertex;
  bwi_lp_counts counts;
} bwi_lp_workspace;
bw_status bwi_lp_open(bw_context *context, const bwi_linear_program *program,
                      const bwi_lp_choice *choice, bwi_lp_workspace *workspace);
/* The optimum for these costs; the workspace's solution arrays are the caller's. BW_CONVERGENCE
 * where no attempt gives one that passes the check. */
bw_status bwi_lp_solve(bw_context *context, bwi_lp_workspace *workspace, const double *cost,
                       bwi_solution *solution);
/* Before the workspace goes on in another thread. */
void bwi_lp_leave_thread(bwi_lp_workspace *workspace);
void bwi_lp_close(bwi_lp_workspace *workspace);

#endif
