/* What studies stand on: files of results, points that fill a cube evenly, minimisers.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_STUDY_H
#define BARWRIGHT_STUDY_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- database files -------------------------------------------------------------------------- */

/* A SQLite file in write-ahead mode: one writer at a time, readers beside it, and what was
 * committed survives the death of the process at any moment. Failures carry the detail "reason":
 *   BW_FORMAT      "damaged"; "foreign": not a file of barwright; "newer": of a later version
 *   BW_LIMIT       "full": no room on the disk; "busy": another process holds it for too long
 *   BW_INFEASIBLE  "constraint": a row that the table's rules forbid
 *   BW_IO          the rest that the operating system refuses
 *   BW_INVALID     SQL that is wrong
 * Of SQL there is what studies need, whoever made the file or the statement: tables, indices, rows
 * and transactions, the functions count, max, min and sum. Views are made and not read; triggers
 * and virtual tables of a file do nothing. A name is the name of a file, never a URI.
 *
 * A transaction in which the file turned out full, damaged or unreadable is rolled back.
 *
 * A database belongs to the process that opened it: in a forked child it can only be released,
 * which there does nothing to the file. */
typedef struct bw_database bw_database; /* an object */
typedef struct bw_statement bw_statement;

enum { BW_DATABASE_FORMAT = 1 };

typedef struct bw_database_options {
  bool read_only;      /* the file must exist */
  double busy_seconds; /* to wait for another process */
} bw_database_options;
BW_API void bw_database_options_default(bw_database_options *options);

/* A file that does not exist, or is empty, becomes a database. */
BW_API bw_status bw_database_open(bw_context *context, const char *path,
                                  const bw_database_options *options, bw_database **database);
BW_API const char *bw_database_path(const bw_database *database);
BW_API bool bw_database_inside_transaction(const bw_database *database);
/* Statements one after the other; rows that they give are dropped. */
BW_API bw_status bw_database_execute(bw_context *context, bw_database *database, const char *sql);
/* Rows that the last statement changed. */
BW_API int64_t bw_database_changed(const bw_database *database);
/* What SQLite's own check finds, one line each, at most `most`, to be released with bw_free; NULL
 * when the file is sound. */
BW_API bw_status bw_database_check(bw_context *context, bw_database *database, int max,
                                   char **problems);

/* The statement for one SQL text, kept by it with the database; its parameters are NULL again. It
 * is in use until it has been stepped to the end or put back. */
BW_API bw_status bw_database_prepare(bw_context *context, bw_database *database, const char *sql,
                                     bw_statement **statement);
BW_API int bw_statement_parameters(const bw_statement *statement);
/* Parameters are counted from 0. NaN, which SQL does not know, becomes NULL. Text with zero bytes
 * is kept as a blob. */
BW_API bw_status bw_statement_bind_integer(bw_context *context, bw_statement *s, int i,
                                           int64_t value);
BW_API bw_status bw_statement_bind_real(bw_context *context, bw_statement *s, int i, double value);
BW_API bw_status bw_statement_bind_text(bw_context *context, bw_statement *s, int i,
                                        const char *text, size_t length);
/* *row is false at the end, and then the statement is put back. */
BW_API bw_status bw_statement_step(bw_context *context, bw_statement *statement, bool *row);
BW_API void bw_statement_put_back(bw_statement *statement);

typedef enum bw_sql_type { BW_SQL_NONE, BW_SQL_INTEGER, BW_SQL_REAL, BW_SQL_TEXT } bw_sql_type;
typedef struct bw_sql_value {
  bw_sql_type type;
  int64_t integer;
  double real;
  const char *text; /* until the next step */
  size_t length;
} bw_sql_value;
BW_API int bw_statement_columns(const bw_statement *statement);
BW_API const char *bw_statement_column_name(const bw_statement *statement, int column);
BW_API bw_status bw_statement_value(bw_context *context, bw_statement *statement, int column,
                                    bw_sql_value *value);

/* Copy what can be read of a damaged file into a new one: tables row by row, past what is
 * unreadable, then indices and views. The damaged file is not touched. What was saved and what was
 * lost, table by table, are warnings of the context.
 *
 * `schema`: the statements that make the tables of such a file, in their order; where the list of
 * tables is gone, or `relist` is set, it is taken from a file made by them (`relisted`). NULL: it
 * is not known, and without a list nothing can be saved. */
typedef struct bw_salvage_report {
  int64_t tables, rows;
  int64_t lost;  /* rows that there were, at most: places in the tables that could not be read */
  bool whole;    /* nothing was in the way */
  bool relisted; /* the list of tables is the schema's */
} bw_salvage_report;
BW_API bw_status bw_database_salvage(bw_context *context, const char *damaged, const char *to,
                                     const char *schema, bool relist, bw_salvage_report *report);

/* ---- points that fill a cube evenly ---------------------------------------------------------- */

enum { BW_SOBOL_DIMENSIONS = 1111 };

typedef struct bw_sobol_options {
  int64_t skip;   /* the number of the first point */
  bool scrambled; /* digits mixed and shifted at random by the seed */
  uint64_t seed;
} bw_sobol_options;

/* Points skip, ..., skip + count - 1 of Sobol's sequence, row by row, in [0, 1). Of any 2^k points
 * that begin at a multiple of 2^k, each dyadic interval of length 2^-k holds one in every
 * dimension. Point 0 is the origin, unless scrambled. A dimension's numbers do not depend on how
 * many there are. */
BW_API bw_status bw_sobol(bw_context *context, int64_t count, int dimensions,
                          const bw_sobol_options *options, double *point);

/* ---- minimisers ------------------------------------------------------------------------------ */

/* NLopt's, one face for all. Constraints are inequalities: value <= 0. */
typedef enum bw_minimiser {
  BW_COBYLA,     /* linear models; constraints */
  BW_BOBYQA,     /* quadratic models */
  BW_NELDERMEAD, /* a simplex */
  BW_SBPLX,      /* a simplex in subspaces */
  BW_DIRECT_L,   /* global: dividing rectangles */
  BW_CRS2,       /* global: controlled random search */
  BW_ISRES,      /* global: evolution; constraints */
  BW_MMA,        /* gradients: moving asymptotes; constraints */
  BW_SLSQP,      /* gradients: sequential quadratic programs; constraints */
  BW_LBFGS       /* gradients */
} bw_minimiser;

BW_API const char *bw_minimiser_word(bw_minimiser minimiser); /* "cobyla"; NULL past the last */
BW_API bool bw_minimiser_takes_gradients(bw_minimiser minimiser);
BW_API bool bw_minimiser_takes_constraints(bw_minimiser minimiser);
BW_API bool bw_minimiser_is_global(bw_minimiser minimiser); /* needs finite bounds */

/* The value, and where `gradient` is not NULL its derivatives, at x: of the objective (which 0) or
 * a constraint (from 1). A failure ends the run and is what bw_minimise returns. */
typedef bw_status bw_minimised(bw_context *context, void *data, int which, const double *x,
                               double *value, double *gradient);

typedef struct bw_minimise_options {
  bw_minimiser method;
  double tolerance;            /* steps of x, relative; 0: not asked */
  double value_tolerance;      /* changes of the objective, relative; 0: not asked */
  double constraint_tolerance; /* a constraint's value that passes */
  double good_enough;          /* objective at which to stop; -INFINITY: none */
  int64_t evaluations;         /* of the objective, at most */
  int population;              /* of crs2 and isres; 0: NLopt's */
  const double *step;          /* first steps without gradients; NULL: NLopt's */
  uint64_t seed;               /* of crs2 and isres */
} bw_minimise_options;
BW_API void bw_minimise_options_default(bw_minimise_options *options);

typedef enum bw_minimise_end {
  BW_END_TOLERANCE,
  BW_END_GOOD_ENOUGH,
  BW_END_EVALUATIONS,
  BW_END_ROUNDOFF, /* no better in these digits: most often a minimum */
  BW_END_STUCK     /* the method found no way on */
} bw_minimise_end;
BW_API const char *bw_minimise_end_word(bw_minimise_end end);

typedef struct bw_minimise_result {
  double value;
  double violation;    /* the largest constraint at x, or 0 */
  int64_t evaluations; /* of the objective */
  bw_minimise_end end;
} bw_minimise_result;

/* Minimise over n variables from x, which becomes the best point. Bounds may be infinite, or NULL.
 *   BW_INVALID      what the method does not take, with the methods that do
 *   BW_INFEASIBLE   a constraint is violated at the end (detail "violation"); x and result are set
 *   BW_CONVERGENCE  a value that is not a number
 *   the function's own status */
BW_API bw_status bw_minimise(bw_context *context, int n, double *x, const double *min,
                             const double *max, int constraints, bw_minimised *function, void *data,
                             const bw_minimise_options *options, bw_minimise_result *result);

#ifdef __cplusplus
}
#endif
#endif
