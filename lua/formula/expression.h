/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Formulas over arrays: "a*2 + b", "x > 0.1 and norm(u) < 1e-3". Knows nothing of Lua.
 *
 *   or  <  and  <  not  <  == ~= < <= > >=  <  + -  <  * / %  <  unary -  <  ^
 *
 * A name stands for a variable, name[k] for its k-th column (from 1), name.x name.y name.z for the
 * first three. A variable of one column fits every column of the others. Functions: sqrt abs exp
 * log sin cos tan asin acos atan floor ceil sign (of one), min max atan2 hypot mod (of two),
 * norm(name) (of a row of a variable), where(condition, yes, no). Constants: pi, inf, nan.
 * Truth is 1 and 0; anything but 0 counts as true. */
#ifndef LBW_EXPRESSION_H
#define LBW_EXPRESSION_H

#include "barwright/base.h"

typedef struct lbw_variable {
  const char *name;
  bw_type type;
  int64_t rows, columns;
  ptrdiff_t row_stride, column_stride;
  const void *data;
} lbw_variable;

enum { LBW_CODE = 256, LBW_DEPTH = 32, LBW_BLOCK = 128 };

typedef struct lbw_instruction {
  unsigned char code, variable;
  int32_t column; /* -1: the column at hand */
  double constant;
} lbw_instruction;

typedef struct lbw_expression {
  int length;
  bool boolean;    /* the outermost operation is a comparison, and, or, not */
  int64_t columns; /* of the result */
  const lbw_variable *variable;
  lbw_instruction code[LBW_CODE];
} lbw_expression;

/* False with a sentence in `error`. At most 255 variables, which must outlive the expression. */
bool lbw_expression_compile(const char *text, const lbw_variable *variable, int count,
                            lbw_expression *expression, char *error, size_t error_size);
/* Column `column` of rows first..first+count-1, count <= LBW_BLOCK. */
void lbw_expression_block(const lbw_expression *expression, int64_t first, int count,
                          int64_t column, double *result);

#endif
