/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Formulas over arrays: a recursive-descent compiler to a stack machine whose registers are blocks
 * of rows, so that the cost of interpreting is shared by LBW_BLOCK numbers. */
#include "formula/expression.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum code {
  CONSTANT,
  LOAD,
  NORM,
  /* one operand */
  NEGATE,
  NOT,
  SQRT,
  ABS,
  EXP,
  LOG,
  SIN,
  COS,
  TAN,
  ASIN,
  ACOS,
  ATAN,
  FLOOR,
  CEIL,
  SIGN,
  /* two */
  ADD,
  SUBTRACT,
  MULTIPLY,
  DIVIDE,
  MODULO,
  POWER,
  MINIMUM,
  MAXIMUM,
  ATAN2,
  HYPOT,
  EQUAL,
  UNEQUAL,
  LESS,
  LESS_EQUAL,
  GREATER,
  GREATER_EQUAL,
  AND,
  OR,
  /* three */
  WHERE
};

static const struct {
  const char *name;
  enum code code;
  int operands;
} function_table[] = {
    {"sqrt", SQRT, 1},   {"abs", ABS, 1},     {"exp", EXP, 1},     {"log", LOG, 1},
    {"sin", SIN, 1},     {"cos", COS, 1},     {"tan", TAN, 1},     {"asin", ASIN, 1},
    {"acos", ACOS, 1},   {"atan", ATAN, 1},   {"floor", FLOOR, 1}, {"ceil", CEIL, 1},
    {"sign", SIGN, 1},   {"min", MINIMUM, 2}, {"max", MAXIMUM, 2}, {"atan2", ATAN2, 2},
    {"hypot", HYPOT, 2}, {"mod", MODULO, 2},  {"where", WHERE, 3}};

typedef struct parser {
  const char *text, *at;
  const lbw_variable *variable;
  int count;
  lbw_expression *out;
  int depth, nesting;
  char *error;
  size_t error_size;
  bool failed;
} parser;

static void fail(parser *p, const char *what) {
  if (!p->failed)
    snprintf(p->error, p->error_size, "%s at character %d of \"%s\"", what,
             (int)(p->at - p->text) + 1, p->text);
  p->failed = true;
}

static void emit(parser *p, enum code code, int operands, int variable, int32_t column,
                 double constant) {
  if (p->failed)
    return;
  if (p->out->length == LBW_CODE) {
    fail(p, "the formula is too long");
    return;
  }
  p->depth += 1 - operands;
  if (p->depth > LBW_DEPTH) {
    fail(p, "the formula is nested too deeply");
    return;
  }
  p->out->code[p->out->length++] =
      (lbw_instruction){(unsigned char)code, (unsigned char)variable, column, constant};
}

static void space(parser *p) {
  while (isspace((unsigned char)*p->at))
    p->at++;
}

static bool accept(parser *p, const char *token) {
  space(p);
  size_t length = strlen(token);
  if (strncmp(p->at, token, length) != 0)
    return false;
  if (isalpha((unsigned char)token[0]) &&
      (isalnum((unsigned char)p->at[length]) || p->at[length] == '_'))
    return false; /* "or" is not the start of "origin" */
  p->at += length;
  return true;
}

static void expect(parser *p, const char *token) {
  if (!accept(p, token)) {
    char what[40];
    snprintf(what, sizeof what, "'%s' expected", token);
    fail(p, what);
  }
}

/* Decimal digits read by hand: strtod depends on the locale. Exact for up to 15 digits and small
 * exponents, which is what is written in a formula; one rounding more otherwise. */
static double number(parser *p) {
  double value = 0, scale = 1;
  int exponent = 0;
  bool digits = false;
  for (; isdigit((unsigned char)*p->at); p->at++, digits = true)
    value = 10 * value + (*p->at - '0');
  if (*p->at == '.')
    for (p->at++; isdigit((unsigned char)*p->at); p->at++, digits = true) {
      value = 10 * value + (*p->at - '0');
      exponent--;
    }
  if (!digits) {
    fail(p, "a number, a name or '(' expected");
    return 0;
  }
  if (*p->at == 'e' || *p->at == 'E') {
    const char *start = p->at++;
    int sign = 1, power = 0;
    if (*p->at == '+' || *p->at == '-')
      sign = *p->at++ == '-' ? -1 : 1;
    if (!isdigit((unsigned char)*p->at)) {
      p->at = start;
      fail(p, "digits expected after the exponent's 'e'");
      return 0;
    }
    for (; isdigit((unsigned char)*p->at); p->at++)
      power = power < 10000 ? 10 * power + (*p->at - '0') : power;
    exponent += sign * power;
  }
  int size = exponent < 0 ? -exponent : exponent;
  if (size > 400)
    size = 400;
  for (int i = 0; i < size; i++)
    scale *= 10;
  return exponent < 0 ? value / scale : value * scale;
}

static void either(parser *p);

static int find_variable(parser *p, const char *name, size_t length) {
  for (int i = 0; i < p->count; i++)
    if (strlen(p->variable[i].name) == length && strncmp(p->variable[i].name, name, length) == 0)
      return i;
  return -1;
}

static void unknown_name(parser *p, const char *name, size_t length) {
  char what[160];
  int used = snprintf(what, sizeof what,
                      "unknown name '%.*s' (known:", (int)(length < 40 ? length : 40), name);
  for (int i = 0; i < p->count && used < 110; i++)
    used += snprintf(what + used, sizeof what - (size_t)used, " %.30s", p->variable[i].name);
  snprintf(what + used, sizeof what - (size_t)used, ")");
  p->at = name;
  fail(p, what);
}

static const char *word(parser *p, size_t *length) {
  space(p);
  const char *start = p->at;
  while (isalnum((unsigned char)*p->at) || *p->at == '_')
    p->at++;
  *length = (size_t)(p->at - start);
  return start;
}

static void variable(parser *p, const char *name, size_t length) {
  int index = find_variable(p, name, length);
  if (index < 0) {
    unknown_name(p, name, length);
    return;
  }
  const lbw_variable *v = &p->variable[index];
  int32_t column = -1;
  if (accept(p, "[")) {
    space(p);
    double k = number(p);
    if (!p->failed && (k < 1 || k > (double)v->columns || k != floor(k)))
      fail(p, "no such column");
    else
      column = (int32_t)k - 1;
    expect(p, "]");
  } else if (*p->at == '.' && p->at[1] >= 'x' && p->at[1] <= 'z' &&
             !isalnum((unsigned char)p->at[2])) {
    column = p->at[1] - 'x';
    if (column >= v->columns)
      fail(p, "no such column");
    p->at += 2;
  } else if (v->columns == 1) {
    column = 0;
  } else if (p->out->columns == 1 || p->out->columns == v->columns) {
    p->out->columns = v->columns;
  } else {
    fail(p, "arrays of different numbers of columns");
  }
  emit(p, LOAD, 0, index, column, 0);
}

static void call(parser *p, const char *name, size_t length) {
  if (length == 4 && strncmp(name, "norm", 4) == 0) {
    size_t inner;
    const char *operand = word(p, &inner);
    int index = find_variable(p, operand, inner);
    if (index < 0)
      unknown_name(p, operand, inner);
    else
      emit(p, NORM, 0, index, -1, 0);
    expect(p, ")");
    return;
  }
  for (size_t f = 0; f < sizeof function_table / sizeof *function_table; f++)
    if (strlen(function_table[f].name) == length &&
        strncmp(function_table[f].name, name, length) == 0) {
      for (int i = 0; i < function_table[f].operands; i++) {
        if (i > 0)
          expect(p, ",");
        either(p);
      }
      expect(p, ")");
      emit(p, function_table[f].code, function_table[f].operands, 0, 0, 0);
      return;
    }
  p->at = name;
  fail(p, "unknown function");
}

static void primary(parser *p) {
  p->out->boolean = false;
  space(p);
  if (accept(p, "(")) {
    either(p);
    expect(p, ")");
    return;
  }
  if (!isalpha((unsigned char)*p->at) && *p->at != '_') {
    emit(p, CONSTANT, 0, 0, 0, number(p));
    return;
  }
  size_t length;
  const char *name = word(p, &length);
  if (accept(p, "(")) {
    call(p, name, length);
    p->out->boolean = false;
  } else if (find_variable(p, name, length) >= 0)
    variable(p, name, length);
  else if (length == 2 && strncmp(name, "pi", 2) == 0)
    emit(p, CONSTANT, 0, 0, 0, 3.14159265358979323846);
  else if (length == 3 && strncmp(name, "inf", 3) == 0)
    emit(p, CONSTANT, 0, 0, 0, INFINITY);
  else if (length == 3 && strncmp(name, "nan", 3) == 0)
    emit(p, CONSTANT, 0, 0, 0, NAN);
  else
    unknown_name(p, name, length);
}

static void unary(parser *p);

static void power(parser *p) {
  primary(p);
  if (accept(p, "^")) {
    unary(p);
    emit(p, POWER, 2, 0, 0, 0);
    p->out->boolean = false;
  }
}

static void unary(parser *p) {
  if (++p->nesting > 200)
    fail(p, "the formula is nested too deeply");
  if (!p->failed) {
    if (accept(p, "-")) {
      unary(p);
      emit(p, NEGATE, 1, 0, 0, 0);
      p->out->boolean = false;
    } else if (accept(p, "+"))
      unary(p);
    else
      power(p);
  }
  p->nesting--;
}

static void product(parser *p) {
  unary(p);
  while (!p->failed) {
    enum code code;
    if (accept(p, "*"))
      code = MULTIPLY;
    else if (accept(p, "/"))
      code = DIVIDE;
    else if (accept(p, "%"))
      code = MODULO;
    else
      return;
    unary(p);
    emit(p, code, 2, 0, 0, 0);
    p->out->boolean = false;
  }
}

static void sum(parser *p) {
  product(p);
  while (!p->failed) {
    enum code code;
    if (accept(p, "+"))
      code = ADD;
    else if (accept(p, "-"))
      code = SUBTRACT;
    else
      return;
    product(p);
    emit(p, code, 2, 0, 0, 0);
    p->out->boolean = false;
  }
}

static void comparison(parser *p) {
  static const struct {
    const char *token;
    enum code code;
  } table[] = {{"==", EQUAL}, {"~=", UNEQUAL},       {"!=", UNEQUAL}, {"<=", LESS_EQUAL},
               {"<", LESS},   {">=", GREATER_EQUAL}, {">", GREATER}};
  sum(p);
  for (size_t i = 0; i < sizeof table / sizeof *table && !p->failed; i++)
    if (accept(p, table[i].token)) {
      sum(p);
      emit(p, table[i].code, 2, 0, 0, 0);
      p->out->boolean = true;
      return;
    }
}

static void negation(parser *p) {
  if (++p->nesting > 200)
    fail(p, "the formula is nested too deeply");
  if (!p->failed) {
    if (accept(p, "not")) {
      negation(p);
      emit(p, NOT, 1, 0, 0, 0);
      p->out->boolean = true;
    } else
      comparison(p);
  }
  p->nesting--;
}

static void both(parser *p) {
  negation(p);
  while (!p->failed && accept(p, "and")) {
    negation(p);
    emit(p, AND, 2, 0, 0, 0);
    p->out->boolean = true;
  }
}

static void either(parser *p) {
  if (++p->nesting > 200)
    fail(p, "the formula is nested too deeply");
  if (!p->failed) {
    both(p);
    while (!p->failed && accept(p, "or")) {
      both(p);
      emit(p, OR, 2, 0, 0, 0);
      p->out->boolean = true;
    }
  }
  p->nesting--;
}

bool lbw_expression_compile(const char *text, const lbw_variable *variables, int count,
                            lbw_expression *expression, char *error, size_t error_size) {
  parser p = {.text = text,
              .at = text,
              .variable = variables,
              .count = count,
              .out = expression,
              .error = error,
              .error_size = error_size};
  expression->length = 0;
  expression->boolean = false;
  expression->columns = 1;
  expression->variable = variables;
  either(&p);
  space(&p);
  if (!p.failed && *p.at)
    fail(&p, "an operator expected");
  return !p.failed;
}

/* ---- evaluation ------------------------------------------------------------------------------ */

static void load(const lbw_variable *v, int64_t first, int count, int64_t column, double *out) {
  const char *data = (const char *)v->data + first * v->row_stride + column * v->column_stride;
  for (int i = 0; i < count; i++, data += v->row_stride)
    switch (v->type) {
    case BW_F64:
      out[i] = *(const double *)data;
      break;
    case BW_I32:
      out[i] = *(const int32_t *)data;
      break;
    case BW_I64:
      out[i] = (double)*(const int64_t *)data;
      break;
    case BW_U8:
      out[i] = *(const uint8_t *)data;
      break;
    }
}

static void load_norm(const lbw_variable *v, int64_t first, int count, double *out) {
  double part[LBW_BLOCK];
  for (int i = 0; i < count; i++)
    out[i] = 0;
  for (int64_t c = 0; c < v->columns; c++) {
    load(v, first, count, c, part);
    for (int i = 0; i < count; i++)
      out[i] += part[i] * part[i];
  }
  for (int i = 0; i < count; i++)
    out[i] = sqrt(out[i]);
}

#define EACH(result)                                                                               \
  for (int i = 0; i < n; i++)                                                                      \
    a[i] = (result);                                                                               \
  break

static void apply_one(enum code code, int n, double *a) {
  switch (code) {
  case NEGATE:
    EACH(-a[i]);
  case NOT:
    EACH(a[i] == 0);
  case SQRT:
    EACH(sqrt(a[i]));
  case ABS:
    EACH(fabs(a[i]));
  case EXP:
    EACH(exp(a[i]));
  case LOG:
    EACH(log(a[i]));
  case SIN:
    EACH(sin(a[i]));
  case COS:
    EACH(cos(a[i]));
  case TAN:
    EACH(tan(a[i]));
  case ASIN:
    EACH(asin(a[i]));
  case ACOS:
    EACH(acos(a[i]));
  case ATAN:
    EACH(atan(a[i]));
  case FLOOR:
    EACH(floor(a[i]));
  case CEIL:
    EACH(ceil(a[i]));
  default: /* SIGN */
    EACH((a[i] > 0) - (a[i] < 0));
  }
}

static void apply_two(enum code code, int n, double *a, const double *b) {
  switch (code) {
  case ADD:
    EACH(a[i] + b[i]);
  case SUBTRACT:
    EACH(a[i] - b[i]);
  case MULTIPLY:
    EACH(a[i] * b[i]);
  case DIVIDE:
    EACH(a[i] / b[i]);
  case MODULO: /* as Lua's %: the sign of the divisor */
    EACH(a[i] - floor(a[i] / b[i]) * b[i]);
  case POWER:
    EACH(b[i] == 2 ? a[i] * a[i] : pow(a[i], b[i]));
  case MINIMUM:
    EACH(b[i] < a[i] ? b[i] : a[i]);
  case MAXIMUM:
    EACH(b[i] > a[i] ? b[i] : a[i]);
  case ATAN2:
    EACH(atan2(a[i], b[i]));
  case HYPOT:
    EACH(hypot(a[i], b[i]));
  case EQUAL:
    EACH(a[i] == b[i]);
  case UNEQUAL:
    EACH(a[i] != b[i]);
  case LESS:
    EACH(a[i] < b[i]);
  case LESS_EQUAL:
    EACH(a[i] <= b[i]);
  case GREATER:
    EACH(a[i] > b[i]);
  case GREATER_EQUAL:
    EACH(a[i] >= b[i]);
  case AND:
    EACH(a[i] != 0 && b[i] != 0);
  default: /* OR */
    EACH(a[i] != 0 || b[i] != 0);
  }
}

void lbw_expression_block(const lbw_expression *expression, int64_t first, int count,
                          int64_t column, double *result) {
  double stack[LBW_DEPTH][LBW_BLOCK];
  int top = -1;
  for (int k = 0; k < expression->length; k++) {
    const lbw_instruction *in = &expression->code[k];
    enum code code = (enum code)in->code;
    if (code == CONSTANT) {
      top++;
      for (int i = 0; i < count; i++)
        stack[top][i] = in->constant;
    } else if (code == LOAD)
      load(&expression->variable[in->variable], first, count, in->column < 0 ? column : in->column,
           stack[++top]);
    else if (code == NORM)
      load_norm(&expression->variable[in->variable], first, count, stack[++top]);
    else if (code < ADD)
      apply_one(code, count, stack[top]);
    else if (code < WHERE) {
      top--;
      apply_two(code, count, stack[top], stack[top + 1]);
    } else {
      top -= 2;
      for (int i = 0; i < count; i++)
        stack[top][i] = stack[top][i] != 0 ? stack[top + 1][i] : stack[top + 2][i];
    }
  }
  memcpy(result, stack[0], sizeof *result * (size_t)count);
}
