/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bulk operations on arrays: reduce, map by formula, arithmetic, gather, select, sort. */
#include "array.h"
#include "formula/expression.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const bw_array *self(lua_State *L) {
  return (const bw_array *)lbw_check(L, 1, &lbw_array_class);
}

/* ---- reduce ---------------------------------------------------------------------------------- */

/* Compensated (Neumaier): a sum over millions of entries keeps all its digits. */
typedef struct running_sum {
  double sum, lost;
} running_sum;

static void add(running_sum *s, double value) {
  double next = s->sum + value;
  s->lost += fabs(s->sum) >= fabs(value) ? (s->sum - next) + value : (value - next) + s->sum;
  s->sum = next;
}

static double total(const running_sum *s) {
  return isfinite(s->sum) ? s->sum + s->lost : s->sum;
}

/* The place of the largest (sign 1) or smallest (sign -1) entry; NaN is passed over. */
static bool extreme(const bw_array *array, double sign, int64_t *row, int64_t *column) {
  bool found = false;
  double best = 0;
  for (int64_t i = 0; i < array->rows; i++)
    for (int64_t j = 0; j < array->columns; j++) {
      double value = sign * bw_array_get(array, i, j);
      if (value == value && (!found || value > best)) {
        found = true;
        best = value;
        *row = i;
        *column = j;
      }
    }
  return found;
}

static int push_extreme(lua_State *L, double sign, bool place) {
  const bw_array *array = self(L);
  int64_t row = 0, column = 0;
  if (!extreme(array, sign, &row, &column)) {
    lua_pushnil(L); /* of no numbers there is no largest */
    return 1;
  }
  if (!place) {
    lbw_push_number(L, array, row, column);
    return 1;
  }
  lua_pushinteger(L, row + 1);
  lua_pushinteger(L, column + 1);
  return 2;
}

static int array_min(lua_State *L) {
  return push_extreme(L, -1, false);
}
static int array_max(lua_State *L) {
  return push_extreme(L, 1, false);
}
static int array_argmin(lua_State *L) {
  return push_extreme(L, -1, true);
}
static int array_argmax(lua_State *L) {
  return push_extreme(L, 1, true);
}

static running_sum sum_of(const bw_array *array) {
  running_sum s = {0, 0};
  for (int64_t i = 0; i < array->rows; i++)
    for (int64_t j = 0; j < array->columns; j++)
      add(&s, bw_array_get(array, i, j));
  return s;
}

static int array_sum(lua_State *L) {
  running_sum s = sum_of(self(L));
  lua_pushnumber(L, total(&s));
  return 1;
}

static const bw_array *check_weights(lua_State *L, int argument, const bw_array *array) {
  const bw_array *weight = lbw_check_array(L, argument, "weights");
  if (weight->rows != array->rows || weight->columns != 1 || array->columns != 1)
    lbw_argument_error(
        L, argument,
        lua_pushfstring(L, "weights: an array of %I x 1 expected, as the array has, got %s",
                        (LUAI_UACINT)array->rows, lbw_got(L, argument)));
  return weight;
}

/* array:mean(weights) */
static int array_mean(lua_State *L) {
  const bw_array *array = self(L);
  running_sum s, w = {0, 0};
  if (lua_isnoneornil(L, 2)) {
    s = sum_of(array);
    w.sum = (double)(array->rows * array->columns);
  } else {
    const bw_array *weight = check_weights(L, 2, array);
    s = (running_sum){0, 0};
    for (int64_t i = 0; i < array->rows; i++) {
      add(&s, bw_array_get(array, i, 0) * bw_array_get(weight, i, 0));
      add(&w, bw_array_get(weight, i, 0));
    }
  }
  lua_pushnumber(L, total(&s) / total(&w));
  return 1;
}

static int array_norm(lua_State *L) {
  const bw_array *array = self(L);
  double largest = 0;
  for (int64_t i = 0; i < array->rows; i++)
    for (int64_t j = 0; j < array->columns; j++)
      largest = fmax(largest, fabs(bw_array_get(array, i, j)));
  running_sum s = {0, 0};
  int exponent = 0; /* squares must not overflow; a power of two rounds nothing */
  if (largest > 0 && isfinite(largest))
    frexp(largest, &exponent);
  for (int64_t i = 0; i < array->rows; i++)
    for (int64_t j = 0; j < array->columns; j++) {
      double value = ldexp(bw_array_get(array, i, j), -exponent);
      add(&s, value * value);
    }
  lua_pushnumber(L, ldexp(sqrt(total(&s)), exponent));
  return 1;
}

static int array_dot(lua_State *L) {
  const bw_array *a = self(L), *b = lbw_check_array(L, 2, "other");
  lbw_argument_check(L, a->rows == b->rows && a->columns == b->columns, 2,
                     "other: an array of the same shape expected");
  running_sum s = {0, 0};
  for (int64_t i = 0; i < a->rows; i++)
    for (int64_t j = 0; j < a->columns; j++)
      add(&s, bw_array_get(a, i, j) * bw_array_get(b, i, j));
  lua_pushnumber(L, total(&s));
  return 1;
}

/* array:column_sums(): a table of one sum per column */
static int array_column_sums(lua_State *L) {
  const bw_array *array = self(L);
  lbw_argument_check(L, array->columns <= 100000, 1, "an array of at most 100000 columns expected");
  lua_createtable(L, (int)array->columns, 0);
  for (int64_t j = 0; j < array->columns; j++) {
    running_sum s = {0, 0};
    for (int64_t i = 0; i < array->rows; i++)
      add(&s, bw_array_get(array, i, j));
    lua_pushnumber(L, total(&s));
    lua_rawseti(L, -2, j + 1);
  }
  return 1;
}

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double *packed_column(lua_State *L, const bw_array *array) {
  lbw_argument_check(L, array->columns == 1, 1, "an array of one column expected");
  int64_t rows;
  return lbw_to_doubles(L, 1, "array", 1, &rows);
}

static int array_sorted(lua_State *L) {
  const bw_array *array = self(L);
  double *data = packed_column(L, array);
  for (int64_t i = 0; i < array->rows; i++)
    lbw_argument_check(L, data[i] == data[i], 1, "an array without NaN expected");
  double *out = (double *)lbw_push_array(L, BW_F64, array->rows, 1)->data;
  memcpy(out, data, (size_t)array->rows * sizeof *data);
  qsort(out, (size_t)array->rows, sizeof *out, compare_doubles);
  return 1;
}

typedef struct ranked {
  double value;
  int64_t place;
} ranked;

static int compare_ranked(const void *a, const void *b) {
  const ranked *x = (const ranked *)a, *y = (const ranked *)b;
  int order = (x->value > y->value) - (x->value < y->value);
  return order ? order : (x->place > y->place) - (x->place < y->place);
}

/* array:order(): the rows' numbers in ascending order of the entries; equal ones stay in place */
static int array_order(lua_State *L) {
  const bw_array *array = self(L);
  lbw_argument_check(L, array->columns == 1, 1, "an array of one column expected");
  ranked *list = (ranked *)lua_newuserdatauv(L, (size_t)(array->rows + 1) * sizeof *list, 0);
  for (int64_t i = 0; i < array->rows; i++) {
    list[i] = (ranked){bw_array_get(array, i, 0), i};
    lbw_argument_check(L, list[i].value == list[i].value, 1, "an array without NaN expected");
  }
  qsort(list, (size_t)array->rows, sizeof *list, compare_ranked);
  int64_t *out = (int64_t *)lbw_push_array(L, BW_I64, array->rows, 1)->data;
  for (int64_t i = 0; i < array->rows; i++)
    out[i] = list[i].place + 1;
  return 1;
}

/* array:quantile(p, weights): linear between entries; with weights the smallest entry up to which
 * the fraction p of the weight lies */
static int array_quantile(lua_State *L) {
  const bw_array *array = self(L);
  lua_settop(L, 3);
  double p = lbw_check_real(L, 2, "p");
  lbw_argument_check(L, p >= 0 && p <= 1, 2, "p: a fraction from 0 to 1 expected");
  double *data = packed_column(L, array);
  if (array->rows == 0) {
    lua_pushnil(L);
    return 1;
  }
  if (!lua_isnoneornil(L, 3)) {
    check_weights(L, 3, array);
    int64_t rows;
    double *weight = lbw_to_doubles(L, 3, "weights", 1, &rows), quantile = 0;
    bw_status status = bw_weighted_quantile(lbw_enter(L), rows, data, weight, p, &quantile);
    lbw_leave_or_raise(L, status);
    lua_pushnumber(L, quantile);
    return 1;
  }
  qsort(data, (size_t)array->rows, sizeof *data, compare_doubles);
  double place = p * (double)(array->rows - 1);
  int64_t below = (int64_t)place;
  int64_t above = below + 1 < array->rows ? below + 1 : below;
  double quantile = data[below], rest = place - (double)below;
  if (rest > 0 && data[above] > quantile) /* two infinities have no difference */
    quantile += rest * (data[above] - quantile);
  lua_pushnumber(L, quantile);
  return 1;
}

/* ---- map ------------------------------------------------------------------------------------- */

static void set_variable(lbw_variable *v, const char *name, const bw_array *array) {
  *v = (lbw_variable){.name = name,
                      .type = array->type,
                      .rows = array->rows,
                      .columns = array->columns,
                      .row_stride = array->row_stride,
                      .column_stride = array->column_stride,
                      .data = array->data};
}

static int evaluate(lua_State *L, const lbw_expression *expression, int64_t rows) {
  bw_type type = expression->boolean ? BW_U8 : BW_F64;
  int64_t columns = expression->columns;
  void *out = lbw_push_array(L, type, rows, columns)->data;
  double block[LBW_BLOCK];
  for (int64_t first = 0; first < rows; first += LBW_BLOCK) {
    int count = (int)(rows - first < LBW_BLOCK ? rows - first : LBW_BLOCK);
    for (int64_t j = 0; j < columns; j++) {
      lbw_expression_block(expression, first, count, j, block);
      for (int i = 0; i < count; i++)
        if (type == BW_U8)
          ((uint8_t *)out)[(first + i) * columns + j] = block[i] != 0;
        else
          ((double *)out)[(first + i) * columns + j] = block[i];
    }
  }
  return 1;
}

/* Formula at `formula`, variables from the table at `table` (arrays and numbers), `a` for `array`.
 * The strings and arrays stay on the stack while they are used. */
static int map(lua_State *L, int formula, int table, const bw_array *array) {
  enum { VARIABLES = 32 };
  lbw_variable variable[VARIABLES];
  double number[VARIABLES];
  int count = 0;
  const char *text = lbw_check_text(L, formula, NULL);
  luaL_checkstack(L, 2 * VARIABLES, "too many variables");
  if (array)
    set_variable(&variable[count++], "a", array);
  if (!lua_isnoneornil(L, table)) {
    lbw_check_type(L, table, LUA_TTABLE);
    for (lua_pushnil(L); lua_next(L, table);) {
      if (lua_type(L, -2) != LUA_TSTRING)
        return lbw_error(L, "map: named variables expected, {name = array}, got a value at %s",
                         lbw_got(L, -2));
      const char *name = lua_tostring(L, -2);
      if (count == VARIABLES)
        return lbw_error(L, "map: at most %d variables expected", VARIABLES);
      const bw_array *value = (const bw_array *)lbw_test(L, -1, &lbw_array_class);
      if (value)
        set_variable(&variable[count], name, value);
      else if (lua_type(L, -1) == LUA_TNUMBER) {
        number[count] = lua_tonumber(L, -1);
        variable[count] = (lbw_variable){
            .name = name, .type = BW_F64, .rows = -1, .columns = 1, .data = &number[count]};
      } else
        return lbw_error(L, "map: variable '%s': an array or a number expected, got %s", name,
                         lbw_got(L, -1));
      count++;
      lua_pushvalue(L, -2); /* the value stays below, the key goes on */
      lua_remove(L, -3);
    }
  }
  int64_t rows = -1;
  for (int i = 0; i < count; i++) {
    if (rows >= 0 && variable[i].rows >= 0 && variable[i].rows != rows)
      return lbw_error(L, "map: variable '%s': %I rows expected, as the others have, got %I",
                       variable[i].name, (LUAI_UACINT)rows, (LUAI_UACINT)variable[i].rows);
    if (variable[i].rows >= 0)
      rows = variable[i].rows;
  }
  if (rows < 0)
    return lbw_error(L, "map: at least one array expected among the variables");
  lbw_expression expression;
  char error[256];
  if (!lbw_expression_compile(text, variable, count, &expression, error, sizeof error))
    return lbw_error(L, "map: %s", error);
  return evaluate(L, &expression, rows);
}

/* array:map("a*2 + b", {b = other}) */
static int array_map(lua_State *L) {
  return map(L, 2, 3, self(L));
}

/* bw.array.map("x*2 + b", {x = ..., b = ...}) */
static int function_map(lua_State *L) {
  return map(L, 1, 2, NULL);
}

/* ---- arithmetic: the same machine ------------------------------------------------------------ */

static int arithmetic(lua_State *L, const char *formula) {
  lbw_variable variable[2];
  double number[2];
  int64_t rows = -1;
  for (int i = 0; i < 2; i++) {
    const char *name = i ? "b" : "a";
    const bw_array *array = (const bw_array *)lbw_test(L, i + 1, &lbw_array_class);
    if (array) {
      set_variable(&variable[i], name, array);
      if (rows >= 0 && rows != array->rows)
        return lbw_error(L, "arithmetic: arrays of equally many rows expected, got %I and %I",
                         (LUAI_UACINT)rows, (LUAI_UACINT)array->rows);
      rows = array->rows;
    } else if (lua_type(L, i + 1) == LUA_TNUMBER) {
      number[i] = lua_tonumber(L, i + 1);
      variable[i] = (lbw_variable){
          .name = name, .type = BW_F64, .rows = -1, .columns = 1, .data = &number[i]};
    } else
      return lbw_error(L, "arithmetic: an array or a number expected beside an array, got %s",
                       lbw_got(L, i + 1));
  }
  lbw_expression expression;
  char error[256];
  if (!lbw_expression_compile(formula, variable, 2, &expression, error, sizeof error))
    return lbw_error(L, "%s", error);
  return evaluate(L, &expression, rows);
}

static int array_add(lua_State *L) {
  return arithmetic(L, "a+b");
}
static int array_subtract(lua_State *L) {
  return arithmetic(L, "a-b");
}
static int array_multiply(lua_State *L) {
  return arithmetic(L, "a*b");
}
static int array_divide(lua_State *L) {
  return arithmetic(L, "a/b");
}
static int array_power(lua_State *L) {
  return arithmetic(L, "a^b");
}
static int array_negate(lua_State *L) {
  lua_settop(L, 1);
  lua_pushvalue(L, 1);
  return arithmetic(L, "-a");
}
/* array:above(x), array:below(x): masks for select, subset and where */
static int array_above(lua_State *L) {
  lua_settop(L, 2);
  return arithmetic(L, "a>b");
}
static int array_below(lua_State *L) {
  lua_settop(L, 2);
  return arithmetic(L, "a<b");
}

/* ---- gather ---------------------------------------------------------------------------------- */

static char *entry(const bw_array *array, int64_t row, int64_t column) {
  return (char *)array->data + row * array->row_stride + column * array->column_stride;
}

static void copy_row(const bw_array *from, int64_t row, bw_array *to, int64_t place) {
  size_t size = bw_type_size(from->type);
  for (int64_t j = 0; j < from->columns; j++)
    memcpy(entry(to, place, j), entry(from, row, j), size);
}

/* array:gather(rows): an array or a table of row numbers */
static int array_gather(lua_State *L) {
  const bw_array *array = self(L);
  int64_t count;
  lua_settop(L, 2);
  int32_t *row = lbw_to_indices(L, 2, "rows", 1, &count);
  bw_array *out = lbw_push_array(L, array->type, count, array->columns);
  for (int64_t i = 0; i < count; i++) {
    if (row[i] >= array->rows)
      return lbw_error(L, "gather: rows from 1 to %I expected, got %d", (LUAI_UACINT)array->rows,
                       (int)row[i] + 1);
    copy_row(array, row[i], out, i);
  }
  return 1;
}

/* array:select(mask): the rows whose mask is not 0 */
static int array_select(lua_State *L) {
  const bw_array *array = self(L);
  uint8_t *mask = lbw_to_mask(L, 2, "mask", array->rows);
  int64_t count = 0;
  for (int64_t i = 0; i < array->rows; i++)
    count += mask[i];
  bw_array *out = lbw_push_array(L, array->type, count, array->columns);
  for (int64_t i = 0, place = 0; i < array->rows; i++)
    if (mask[i])
      copy_row(array, i, out, place++);
  return 1;
}

/* array:where(): the numbers of the rows whose entry is not 0 */
static int array_where(lua_State *L) {
  const bw_array *array = self(L);
  lbw_argument_check(L, array->columns == 1, 1, "an array of one column expected");
  int64_t count = 0;
  for (int64_t i = 0; i < array->rows; i++)
    count += bw_array_get(array, i, 0) != 0;
  int64_t *out = (int64_t *)lbw_push_array(L, BW_I64, count, 1)->data;
  for (int64_t i = 0; i < array->rows; i++)
    if (bw_array_get(array, i, 0) != 0)
      *out++ = i + 1;
  return 1;
}

/* array:copy(): packed, with memory of its own, so that the owner can go */
static int array_copy(lua_State *L) {
  const bw_array *array = self(L);
  bw_array *out = lbw_push_array(L, array->type, array->rows, array->columns);
  for (int64_t i = 0; i < array->rows; i++)
    copy_row(array, i, out, i);
  return 1;
}

/* array:scatter(rows, count): a new array of `count` rows of zeros with row i put at rows[i] */
static int array_scatter(lua_State *L) {
  const bw_array *array = self(L);
  int64_t given;
  lua_Integer count = lbw_check_integer(L, 3);
  lbw_argument_check(L, count >= 0, 3, "a number of rows, 0 or more, expected");
  int32_t *row = lbw_to_indices(L, 2, "rows", 1, &given);
  lbw_check_rows(L, 2, "rows", given, array->rows, "row of the array");
  bw_array *out = lbw_push_array(L, array->type, count, array->columns);
  for (int64_t i = 0; i < given; i++) {
    if (row[i] >= count)
      return lbw_error(L, "scatter: rows from 1 to %I expected, got %d", (LUAI_UACINT)count,
                       (int)row[i] + 1);
    copy_row(array, i, out, row[i]);
  }
  return 1;
}

void lbw_add_array_operations(lua_State *L) {
  static const luaL_Reg methods[] = {
      {"min", array_min},         {"max", array_max},       {"argmin", array_argmin},
      {"argmax", array_argmax},   {"sum", array_sum},       {"mean", array_mean},
      {"norm", array_norm},       {"dot", array_dot},       {"column_sums", array_column_sums},
      {"sorted", array_sorted},   {"order", array_order},   {"quantile", array_quantile},
      {"map", array_map},         {"above", array_above},   {"below", array_below},
      {"gather", array_gather},   {"select", array_select}, {"where", array_where},
      {"scatter", array_scatter}, {"copy", array_copy},     {NULL, NULL}};
  static const luaL_Reg operators[] = {{"__add", array_add},
                                       {"__sub", array_subtract},
                                       {"__mul", array_multiply},
                                       {"__div", array_divide},
                                       {"__pow", array_power},
                                       {"__unm", array_negate},
                                       {NULL, NULL}};
  lbw_add_operators(L, &lbw_array_class, operators);
  lbw_add_methods(L, &lbw_array_class, methods);
}

void lbw_add_array_functions(lua_State *L) {
  lua_pushcfunction(L, function_map);
  lua_setfield(L, -2, "map");
}
