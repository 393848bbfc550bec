/* lp: solvers of linear programs. */
#ifndef BARWRIGHT_LP_H
#define BARWRIGHT_LP_H

#include "barwright/base.h"
#include "barwright/report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How linear programs are solved. A description: it does not change, and serves any thread. Where
 * NULL is given for one, counted operations and bytes choose it, and where its answer fails a check
 * the other is asked. */
typedef struct bw_lp_solver {
  bw_object object;
  const char *name;   /* static: "dual_simplex" or "glpk" */
  int max_iterations; /* of an attempt at a program; 0: chosen by its size */
} bw_lp_solver;

/* Options of a solver of linear programs. */
typedef struct bw_lp_options {
  int max_iterations; /* of an attempt at a program; default 0: chosen by its size */
} bw_lp_options;

/* The engine's dual simplex method with the bound-flipping ratio test (Koberstein 2005,
 * section 3.3) on nested samples of the columns; columns in groups with a common bound follow
 * Dantzig and Van Slyke (1967). A second attempt perturbs the costs. `options` may be NULL. */
BW_API bw_status bw_lp_dual_simplex(bw_context *context, const bw_lp_options *options,
                                    bw_lp_solver **solver);
/* GLPK: its dual simplex method with the bound-flipping ratio test, then with the textbook's on
 * scaled rows, then its primal simplex method. `options` may be NULL. */
BW_API bw_status bw_lp_glpk(bw_context *context, const bw_lp_options *options,
                            bw_lp_solver **solver);

#ifdef __cplusplus
}
#endif
#endif
