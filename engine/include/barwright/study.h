/* The base of studies: files of results, points that fill a cube evenly, minimisers.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_STUDY_H
#define BARWRIGHT_STUDY_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- database files -------------------------------------------------------------------------- */

/* A SQLite file in write-ahead mode: one writer at a time, readers at the same time, and what
 * was committed survives a crash of the process at any moment. Failures carry the detail "reason":
 *   BW_FORMAT      "damaged"; "foreign": not a file of barwright; "newer": of a later version
 *   BW_LIMIT       "full": no room on the disk; "busy": another process has locked it for too long
 *   BW_INFEASIBLE  "constraint": a row that the table's rules forbid
 *   BW_IO          other refusals of the operating system
 *   BW_INVALID     SQL that is wrong
 * The SQL is limited to that of studies, for every file and statement: tables, indices, rows and
 * transactions, the functions count, max, min and sum. Views can be created and not read; triggers
 * and virtual tables of a file do nothing. A name is the name of a file, never a URI.
 *
 * A transaction in which the file turned out full, damaged or unreadable is rolled back.
 *
 * A database belongs to the process that opened it: in a forked child it can only be released,
 * which does not change the file. */
typedef struct bw_database bw_database; /* an object */
/* A prepared statement. Its database owns it; it lives as long as that. */
typedef struct bw_statement bw_statement;

enum { BW_DATABASE_FORMAT = 1 /* of files: one of a higher number is refused as "newer" */ };

/* How a database is opened. */
typedef struct bw_database_options {
  bool read_only;      /* the file must exist; default false */
  double busy_seconds; /* (s) to wait for another process; default 20, 0 or more */
} bw_database_options;
BW_API void bw_database_options_default(bw_database_options *options);

/* Opens a file; one that does not exist, or is empty, becomes a database. `options` may be NULL.
 * BW_IO, BW_FORMAT and BW_LIMIT as listed above. */
BW_API bw_status bw_database_open(bw_context *context, const char *path,
                                  const bw_database_options *options, bw_database **database);
/* The path that it was opened by; lives as long as the database. */
BW_API const char *bw_database_path(const bw_database *database);
/* Whether a transaction has begun and not ended. */
BW_API bool bw_database_inside_transaction(const bw_database *database);
/* Executes the statements of `sql` one after the other; rows that they give are dropped. Statuses
 * as listed above. */
BW_API bw_status bw_database_execute(bw_context *context, bw_database *database, const char *sql);
/* Rows that the last statement changed. */
BW_API int64_t bw_database_changed(const bw_database *database);
/* The *problems that SQLite's own check finds, one line each, at most `max`, to be released with
 * bw_free; NULL when the file is sound. BW_LIMIT as bw_database_prepare, BW_IO as listed above. */
BW_API bw_status bw_database_check(bw_context *context, bw_database *database, int max,
                                   char **problems);

/* The statement for one text of `sql`, owned and kept by the database; its parameters are NULL
 * again. It is in use until it has been stepped to the end or put back. BW_LIMIT where too many are
 * in use at once; BW_FORMAT and BW_IO as listed above. */
BW_API bw_status bw_database_prepare(bw_context *context, bw_database *database, const char *sql,
                                     bw_statement **statement);
/* How many parameters it has. */
BW_API int bw_statement_parameters(const bw_statement *statement);
/* Gives the i-th parameter, counted from 0, a value; BW_INVALID where there is none of this
 * number. */
BW_API bw_status bw_statement_bind_integer(bw_context *context, bw_statement *s, int i,
                                           int64_t value);
/* Gives the i-th parameter a value (any). NaN, which SQL does not know, becomes NULL. */
BW_API bw_status bw_statement_bind_real(bw_context *context, bw_statement *s, int i, double value);
/* Gives the i-th parameter a text of `length` bytes, which is copied. Text with zero bytes is
 * stored as a blob. */
BW_API bw_status bw_statement_bind_text(bw_context *context, bw_statement *s, int i,
                                        const char *text, size_t length);
/* Goes to the next row. *row is false at the end, and then the statement is put back. Statuses as
 * listed above; *row is always written. */
BW_API bw_status bw_statement_step(bw_context *context, bw_statement *statement, bool *row);
/* Ends its use: it is reset, and its parameters are NULL. NULL is fine. */
BW_API void bw_statement_put_back(bw_statement *statement);

/* The type of a value. */
typedef enum bw_sql_type {
  BW_SQL_NONE,    /* NULL */
  BW_SQL_INTEGER, /* in `integer` */
  BW_SQL_REAL,    /* in `real` */
  BW_SQL_TEXT     /* in `text`; a blob too */
} bw_sql_type;
/* A value of a row. */
typedef struct bw_sql_value {
  bw_sql_type type; /* which of the others holds it */
  int64_t integer;  /* of BW_SQL_INTEGER */
  double real;      /* (any) of BW_SQL_REAL */
  const char *text; /* of BW_SQL_TEXT; valid until the next step */
  size_t length;    /* of the text, in bytes */
} bw_sql_value;
/* How many columns its rows have. */
BW_API int bw_statement_columns(const bw_statement *statement);
/* The name of a `column`, counted from 0; valid until the statement is prepared again. */
BW_API const char *bw_statement_column_name(const bw_statement *statement, int column);
/* The value in a `column` of the row that bw_statement_step went to. */
BW_API bw_status bw_statement_value(bw_context *context, bw_statement *statement, int column,
                                    bw_sql_value *value);

/* What bw_database_salvage saved. */
typedef struct bw_salvage_report {
  int64_t tables, rows; /* that are in the new file */
  int64_t lost;  /* rows that there were, at most: places in the tables that could not be read */
  bool whole;    /* all was readable */
  bool relisted; /* the list of tables is the schema's */
} bw_salvage_report;
/* Copies what can be read of a `damaged` file into a new one, `to`: tables row by row, past what is
 * unreadable, then indices and views. The damaged file is not touched. What was saved and what was
 * lost, table by table, are warnings of the context.
 *
 * `schema`: the statements that make the tables of such a file, in their order; where the list of
 * tables is gone, or `relist` is set, it is taken from a file made by them (`relisted`). NULL: it
 * is not known, and without a list nothing can be saved: BW_FORMAT. BW_IO where a file cannot be
 * read or written, BW_LIMIT where the disk is full. */
BW_API bw_status bw_database_salvage(bw_context *context, const char *damaged, const char *to,
                                     const char *schema, bool relist, bw_salvage_report *report);

/* ---- points that fill a cube evenly ---------------------------------------------------------- */

enum { BW_SOBOL_DIMENSIONS = 1111 /* the most that a point may have */ };

/* Which points of which sequence. */
typedef struct bw_sobol_options {
  int64_t skip;   /* the number of the first point, from 0 */
  bool scrambled; /* digits mixed and shifted at random by the seed */
  uint64_t seed;  /* of scrambled sequences */
} bw_sobol_options;

/* Points skip, ..., skip + count - 1 of Sobol's sequence in 1 to BW_SOBOL_DIMENSIONS `dimensions`:
 * point (-, count x dimensions) in [0, 1). Of any 2^k points
 * that begin at a multiple of 2^k, each dyadic interval of length 2^-k holds one in every
 * dimension. Point 0 is the origin, unless scrambled. A dimension's numbers do not depend on how
 * many there are. BW_INVALID for points beyond the sequence's end. */
BW_API bw_status bw_sobol(bw_context *context, int64_t count, int dimensions,
                          const bw_sobol_options *options, double *point);

/* ---- minimisers ------------------------------------------------------------------------------ */

/* NLopt's methods under one interface. Constraints are inequalities: value <= 0. */
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
/* Whether it takes constraints. */
BW_API bool bw_minimiser_takes_constraints(bw_minimiser minimiser);
BW_API bool bw_minimiser_is_global(bw_minimiser minimiser); /* needs finite bounds */

/* The *value (any), and where it is not NULL the derivatives, gradient (any, n), at x (any, n): of
 * the objective (`which` 0) or a constraint (from 1). A failure ends the run and is what
 * bw_minimise returns. */
typedef bw_status bw_minimised(bw_context *context, void *data, int which, const double *x,
                               double *value, double *gradient);

/* By which method, and when to stop. */
typedef struct bw_minimise_options {
  bw_minimiser method;    /* default BW_COBYLA */
  double tolerance;       /* (-) steps of x, relative, 0 or more; default 1e-6; 0: not tested */
  double value_tolerance; /* (-) changes of the objective, 0 or more; default 0: not tested */
  double constraint_tolerance; /* (any) a constraint's value that passes; default 1e-6, 0 or more */
  double good_enough;          /* (any) objective at which to stop; default -INFINITY: none */
  int64_t evaluations;         /* of the objective, at most; default 10000, 1 to 2^31 - 1 */
  int population;              /* of crs2 and isres, 0 or more; default 0: NLopt's */
  const double *step;          /* (any, n) first steps without gradients, > 0; NULL: NLopt's */
  uint64_t seed;               /* of crs2 and isres; default 1 */
} bw_minimise_options;
BW_API void bw_minimise_options_default(bw_minimise_options *options);

/* Why a run ended. */
typedef enum bw_minimise_end {
  BW_END_TOLERANCE,   /* steps or changes below their tolerance */
  BW_END_GOOD_ENOUGH, /* the objective reached good_enough */
  BW_END_EVALUATIONS, /* so many as the options allow */
  BW_END_ROUNDOFF,    /* no better in these digits: most often a minimum */
  BW_END_STUCK        /* the method found no way on */
} bw_minimise_end;
BW_API const char *bw_minimise_end_word(bw_minimise_end end);

/* The best point's values. */
typedef struct bw_minimise_result {
  double value;        /* (any) of the objective */
  double violation;    /* (any) the largest constraint at x, or 0 */
  int64_t evaluations; /* of the objective */
  bw_minimise_end end; /* why the run ended */
} bw_minimise_result;

/* Minimise over n variables under so many `constraints` from x (any, n), which becomes
 * the best point, between bounds min and max (any, n), which may be infinite, or NULL. `options`
 * may be NULL. BW_INVALID      what the method does not take, with the methods that do
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
