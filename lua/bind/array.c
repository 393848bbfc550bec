/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.array: strided views of numbers; making them, indexing them, turning them into tables and
 * bytes. An array cannot be changed from Lua: operations give new ones, views share memory. */
#include "array.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const bw_array *lbw_check_array(lua_State *L, int argument, const char *what) {
  const bw_array *array = (const bw_array *)lbw_test(L, argument, &lbw_array_class);
  if (!array)
    lbw_argument_error(
        L, argument,
        lua_pushfstring(L, "%s: an array expected, got %s", what, lbw_got(L, argument)));
  return array;
}

bw_array *lbw_push_array(lua_State *L, bw_type type, int64_t rows, int64_t columns) {
  lbw_box *box = lbw_box_new(L, &lbw_array_class);
  bw_array *array = NULL;
  bw_status status = bw_array_create(lbw_enter(L), type, rows, columns, &array);
  lbw_box_fill(L, box, array);
  lbw_leave_or_raise(L, status);
  return array;
}

int lbw_push_borrowed(lua_State *L, bw_type type, int64_t rows, int64_t columns, const void *data,
                      const void *owner) {
  lbw_box *box = lbw_box_new(L, &lbw_array_class);
  bw_array *array = NULL;
  bw_status status = bw_array_borrow(lbw_enter(L), type, rows, columns, data, owner, &array);
  lbw_box_fill(L, box, array);
  lbw_leave_or_raise(L, status);
  return 1;
}

int lbw_push_indices(lua_State *L, int64_t rows, int64_t columns, const int32_t *index) {
  int32_t *out = (int32_t *)lbw_push_array(L, BW_I32, rows, columns)->data;
  for (int64_t i = 0; i < rows * columns; i++)
    out[i] = index[i] + 1;
  return 1;
}

void lbw_push_number(lua_State *L, const bw_array *array, int64_t row, int64_t column) {
  double value = bw_array_get(array, row, column);
  if (array->type == BW_F64)
    lua_pushnumber(L, value);
  else if (array->type == BW_I64) /* beyond 2^53 a double would not do */
    lua_pushinteger(L, (lua_Integer) *
                           (const int64_t *)((const char *)array->data + row * array->row_stride +
                                             column * array->column_stride));
  else
    lua_pushinteger(L, (lua_Integer)value);
}

/* ---- making ---------------------------------------------------------------------------------- */

static bw_type check_type(lua_State *L, int argument) {
  static const char *const names[] = {"f64", "i32", "i64", "u8", NULL};
  static const bw_type types[] = {BW_F64, BW_I32, BW_I64, BW_U8};
  return types[lbw_check_word(L, argument, names)];
}

const char *lbw_type_word(bw_type type) {
  return type == BW_F64 ? "f64" : type == BW_I32 ? "i32" : type == BW_I64 ? "i64" : "u8";
}

/* Stores a number of the stack's top, checking that it fits. */
static bool store(lua_State *L, void *data, bw_type type, int64_t place) {
  int is_integer = 1;
  lua_Integer integer = 0;
  if (lua_isboolean(L, -1) && type == BW_U8)
    integer = lua_toboolean(L, -1);
  else if (lua_type(L, -1) != LUA_TNUMBER)
    return false;
  else if (type != BW_F64)
    integer = lua_tointegerx(L, -1, &is_integer);
  if (!is_integer)
    return false;
  switch (type) {
  case BW_F64:
    ((double *)data)[place] = lua_tonumber(L, -1);
    return true;
  case BW_I32:
    ((int32_t *)data)[place] = (int32_t)integer;
    return integer >= INT32_MIN && integer <= INT32_MAX;
  case BW_I64:
    ((int64_t *)data)[place] = integer;
    return true;
  case BW_U8:
    ((uint8_t *)data)[place] = (uint8_t)integer;
    return integer >= 0 && integer <= 255;
  }
  return false;
}

/* Rows and columns of the table at index: numbers, or rows of as many numbers each. */
static void table_shape(lua_State *L, int index, int64_t *rows, int64_t *columns) {
  *rows = (int64_t)lua_rawlen(L, index);
  *columns = 1;
  if (*rows > 0 && lua_rawgeti(L, index, 1) == LUA_TTABLE)
    *columns = (int64_t)lua_rawlen(L, -1);
  lua_settop(L, *rows > 0 ? -2 : -1);
}

static void fill_from_table(lua_State *L, int index, const char *what, bw_type type, int64_t rows,
                            int64_t columns, bool nested, void *data) {
  luaL_checkstack(L, 4, "too many values");
  for (int64_t i = 0; i < rows; i++) {
    int kind = lua_rawgeti(L, index, i + 1);
    if (!nested) {
      if (!store(L, data, type, i))
        lbw_error(L, "%s: entry %I: a number of type %s expected, got %s", what, (LUAI_UACINT)i + 1,
                  lbw_type_word(type), lbw_got(L, -1));
    } else {
      if (kind != LUA_TTABLE || (int64_t)lua_rawlen(L, -1) != columns)
        lbw_error(L, "%s: row %I: a table of %I numbers expected, got %s", what, (LUAI_UACINT)i + 1,
                  (LUAI_UACINT)columns,
                  kind == LUA_TTABLE ? lua_pushfstring(L, "%I", (LUAI_UACINT)lua_rawlen(L, -1))
                                     : lbw_got(L, -1));
      for (int64_t j = 0; j < columns; j++) {
        lua_rawgeti(L, -1, j + 1);
        if (!store(L, data, type, i * columns + j))
          lbw_error(L, "%s: entry (%I, %I): a number of type %s expected, got %s", what,
                    (LUAI_UACINT)i + 1, (LUAI_UACINT)j + 1, lbw_type_word(type), lbw_got(L, -1));
        lua_pop(L, 1);
      }
    }
    lua_pop(L, 1);
  }
}

static bool is_nested(lua_State *L, int index) {
  bool nested = lua_rawgeti(L, index, 1) == LUA_TTABLE;
  lua_pop(L, 1);
  return nested;
}

/* array.new(table, type) */
static int array_new(lua_State *L) {
  lbw_check_type(L, 1, LUA_TTABLE);
  bw_type type = check_type(L, 2);
  int64_t rows, columns;
  table_shape(L, 1, &rows, &columns);
  bw_array *array = lbw_push_array(L, type, rows, columns);
  fill_from_table(L, 1, "array", type, rows, columns, is_nested(L, 1), array->data);
  return 1;
}

/* array{...}: the module table itself is called */
static int module_call(lua_State *L) {
  lua_remove(L, 1);
  return array_new(L);
}

/* array.zeros(rows, columns, type) */
static int array_zeros(lua_State *L) {
  lua_Integer rows = lbw_check_integer(L, 1), columns = lbw_integer_or(L, 2, 1);
  lbw_argument_check(L, rows >= 0, 1, "a number of rows, 0 or more, expected");
  lbw_argument_check(L, columns >= 1, 2, "a number of columns, 1 or more, expected");
  lbw_push_array(L, check_type(L, 3), rows, columns);
  return 1;
}

/* array.range(first, last, step) */
static int array_range(lua_State *L) {
  double first = lbw_check_real(L, 1, "first"), last = lbw_check_real(L, 2, "last");
  double step = lua_isnoneornil(L, 3) ? 1 : lbw_check_real(L, 3, "step");
  lbw_argument_check(L, step != 0, 3, "a step other than 0 expected");
  double count = floor((last - first) / step * (1 + 1e-12)) + 1;
  lbw_argument_check(L, count < 1e9, 3, "a range of less than 1e9 numbers expected");
  int64_t rows = count > 0 ? (int64_t)count : 0;
  double *out = (double *)lbw_push_array(L, BW_F64, rows, 1)->data;
  for (int64_t i = 0; i < rows; i++)
    out[i] = first + (double)i * step;
  return 1;
}

/* ---- bytes ----------------------------------------------------------------------------------- */

typedef struct byte_format {
  bool little;
  char kind; /* f i u */
  int size;
} byte_format;

static byte_format check_format(lua_State *L, int argument) {
  const char *text = lbw_check_text(L, argument, NULL);
  byte_format format = {text[0] != '>', 0, 0};
  const char *at = text + (text[0] == '<' || text[0] == '>');
  if (at[0] && at[1] && !at[2]) {
    format.kind = at[0];
    format.size = at[1] - '0';
  }
  bool known = (format.kind == 'f' && (format.size == 4 || format.size == 8)) ||
               ((format.kind == 'i' || format.kind == 'u') &&
                (format.size == 1 || format.size == 2 || format.size == 4 || format.size == 8));
  lbw_argument_check(L, known, argument,
                     "a byte format expected: < or >, then f4 f8 i1 i2 i4 i8 u1 u2 u4 u8");
  return format;
}

static uint64_t to_bits(byte_format format, double value) {
  uint64_t bits = 0;
  if (format.kind == 'f' && format.size == 8)
    memcpy(&bits, &value, 8);
  else if (format.kind == 'f') {
    float single = (float)value;
    uint32_t half;
    memcpy(&half, &single, 4);
    bits = half;
  } else if (format.kind == 'i')
    bits = (uint64_t)(int64_t)value;
  else
    bits = (uint64_t)value;
  return bits;
}

static double from_bits(byte_format format, uint64_t bits) {
  if (format.kind == 'f' && format.size == 8) {
    double value;
    memcpy(&value, &bits, 8);
    return value;
  }
  if (format.kind == 'f') {
    uint32_t half = (uint32_t)bits;
    float single;
    memcpy(&single, &half, 4);
    return single;
  }
  if (format.kind == 'i') {
    int unused = 64 - 8 * format.size;
    return (double)((int64_t)(bits << unused) >> unused);
  }
  return (double)bits;
}

/* Numbers outside an integer format have no bits: converting them in C would be undefined. */
static bool fits(byte_format format, double value) {
  if (format.kind == 'f')
    return true;
  double top = ldexp(1, 8 * format.size - (format.kind == 'i'));
  return value < top && value >= (format.kind == 'i' ? -top : 0);
}

/* array:tostring(format, offset): row after row; `offset` is added to every number first (-1 turns
 * numbers that count from 1 into such that count from 0) */
static int array_bytes(lua_State *L) {
  const bw_array *array = (const bw_array *)lbw_check(L, 1, &lbw_array_class);
  byte_format format = check_format(L, 2);
  double offset = lbw_number_or(L, 3, 0);
  size_t count = (size_t)(array->rows * array->columns);
  luaL_Buffer buffer;
  unsigned char *out =
      (unsigned char *)luaL_buffinitsize(L, &buffer, count * (size_t)format.size + 1);
  for (int64_t i = 0; i < array->rows; i++)
    for (int64_t j = 0; j < array->columns; j++) {
      double value = bw_array_get(array, i, j) + offset;
      if (!fits(format, value))
        return lbw_error(L, "tostring: entry (%I, %I) = %f does not fit the format %s",
                         (LUAI_UACINT)i + 1, (LUAI_UACINT)j + 1, value, lua_tostring(L, 2));
      uint64_t bits = to_bits(format, value);
      for (int b = 0; b < format.size; b++)
        *out++ = (unsigned char)(bits >> 8 * (format.little ? b : format.size - 1 - b));
    }
  luaL_pushresultsize(&buffer, count * (size_t)format.size);
  return 1;
}

/* base64(bytes) */
static int core_base64(lua_State *L) {
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  size_t length;
  const unsigned char *in = (const unsigned char *)lbw_check_text(L, 1, &length);
  size_t size = (length + 2) / 3 * 4;
  luaL_Buffer buffer;
  char *out = luaL_buffinitsize(L, &buffer, size + 1);
  for (size_t i = 0; i < length; i += 3) {
    size_t left = length - i;
    uint32_t bits = (uint32_t)in[i] << 16 | (left > 1 ? (uint32_t)in[i + 1] << 8 : 0) |
                    (left > 2 ? in[i + 2] : 0);
    *out++ = digit[bits >> 18];
    *out++ = digit[bits >> 12 & 63];
    *out++ = left > 1 ? digit[bits >> 6 & 63] : '=';
    *out++ = left > 2 ? digit[bits & 63] : '=';
  }
  luaL_pushresultsize(&buffer, size);
  return 1;
}

/* array.from_string(format, bytes, columns) */
static int array_from_string(lua_State *L) {
  byte_format format = check_format(L, 1);
  size_t length;
  const unsigned char *in = (const unsigned char *)lbw_check_text(L, 2, &length);
  lua_Integer columns = lbw_integer_or(L, 3, 1);
  lbw_argument_check(L, columns >= 1 && columns <= INT32_MAX, 3,
                     "a number of columns, 1 or more, expected");
  size_t row = (size_t)columns * (size_t)format.size;
  if (length % row != 0)
    return lbw_error(L, "from_string: whole rows of %I bytes expected, got %I bytes",
                     (LUAI_UACINT)row, (LUAI_UACINT)length);
  bw_type type = format.kind == 'f' || format.size == 8   ? BW_F64
                 : format.kind == 'u' && format.size == 1 ? BW_U8
                 : format.kind == 'u' && format.size == 4 ? BW_I64
                                                          : BW_I32;
  if (format.kind != 'f' && format.size == 8)
    type = BW_I64;
  int64_t count = (int64_t)(length / (size_t)format.size);
  void *out = lbw_push_array(L, type, (int64_t)(length / row), columns)->data;
  for (int64_t i = 0; i < count; i++) {
    uint64_t bits = 0;
    for (int b = 0; b < format.size; b++)
      bits |= (uint64_t)*in++ << 8 * (format.little ? b : format.size - 1 - b);
    if (type == BW_F64)
      ((double *)out)[i] = from_bits(format, bits);
    else if (type == BW_I64)
      ((int64_t *)out)[i] = (int64_t)bits;
    else if (type == BW_I32)
      ((int32_t *)out)[i] = (int32_t)from_bits(format, bits);
    else
      ((uint8_t *)out)[i] = (uint8_t)bits;
  }
  return 1;
}

/* ---- indexing -------------------------------------------------------------------------------- */

int lbw_push_view(lua_State *L, const bw_array *array, int64_t first_row, int64_t rows,
                  int64_t row_step, int64_t first_column, int64_t columns, int64_t column_step) {
  lbw_box *box = lbw_box_new(L, &lbw_array_class);
  bw_array *view = NULL;
  bw_status status = bw_array_view(lbw_enter(L), array, first_row, rows, row_step, first_column,
                                   columns, column_step, &view);
  lbw_box_fill(L, box, view);
  lbw_leave_or_raise(L, status);
  return 1;
}

/* One row as a column: #a[i] is then the number of its entries, and a[i][j] a number. */
static int push_row(lua_State *L, const bw_array *array, int64_t row) {
  lbw_push_view(L, array, row, 1, 1, 0, array->columns, 1);
  bw_array *view = (bw_array *)lbw_test(L, -1, &lbw_array_class);
  view->rows = array->columns;
  view->columns = 1;
  view->row_stride = view->column_stride;
  return 1;
}

static int array_index(lua_State *L) {
  const bw_array *array = (const bw_array *)lbw_check(L, 1, &lbw_array_class);
  int64_t row = lbw_check_index(L, 2, "row", array->rows);
  if (array->columns > 1)
    return push_row(L, array, row);
  lbw_push_number(L, array, row, 0);
  return 1;
}

static int array_call(lua_State *L) {
  const bw_array *array = (const bw_array *)lbw_check(L, 1, &lbw_array_class);
  int64_t row = lbw_check_index(L, 2, "row", array->rows);
  int64_t column = lua_isnoneornil(L, 3) && array->columns == 1
                       ? 0
                       : lbw_check_index(L, 3, "column", array->columns);
  lbw_push_number(L, array, row, column);
  return 1;
}

LBW_PUSH(array_length,
         lua_pushinteger(L, ((const bw_array *)lbw_check(L, 1, &lbw_array_class))->rows))

/* first, last, step at argument 2..4 into a range of 0..count-1 */
static void check_range(lua_State *L, int64_t count, int64_t *first, int64_t *number,
                        int64_t *step) {
  lua_Integer from = lbw_integer_or(L, 2, 1), to = lbw_integer_or(L, 3, (lua_Integer)count);
  *step = lbw_integer_or(L, 4, 1);
  lbw_argument_check(L, *step != 0, 4, "a step other than 0 expected");
  if (from < 0)
    from += count + 1;
  if (to < 0)
    to += count + 1;
  bool any = *step > 0 ? to >= from : from >= to;
  if (any && (from < 1 || from > count || to < 1 || to > count))
    lbw_error(L, "rows or columns from 1 to %I expected, got %I to %I", (LUAI_UACINT)count,
              (LUAI_UACINT)from, (LUAI_UACINT)to);
  /* A longer step leaves the range at once, and could not be negated or multiplied. */
  *step = *step > count ? count : *step < -count ? -count : *step;
  int64_t n = any ? (to - from) / *step + 1 : 0;
  *first = n > 0 ? from - 1 : 0;
  *number = n;
}

static int array_rows(lua_State *L) {
  const bw_array *array = (const bw_array *)lbw_check(L, 1, &lbw_array_class);
  int64_t first, number, step;
  check_range(L, array->rows, &first, &number, &step);
  return lbw_push_view(L, array, first, number, step, 0, array->columns, 1);
}

static int array_columns(lua_State *L) {
  const bw_array *array = (const bw_array *)lbw_check(L, 1, &lbw_array_class);
  int64_t first, number, step;
  check_range(L, array->columns, &first, &number, &step);
  return lbw_push_view(L, array, 0, array->rows, 1, first, number, step);
}

static int array_column(lua_State *L) {
  const bw_array *array = (const bw_array *)lbw_check(L, 1, &lbw_array_class);
  int64_t column = lbw_check_index(L, 2, "column", array->columns);
  return lbw_push_view(L, array, 0, array->rows, 1, column, 1, 1);
}

/* ---- tables and text ------------------------------------------------------------------------- */

/* array:totable(): numbers, or rows of numbers */
static int array_totable(lua_State *L) {
  const bw_array *array = (const bw_array *)lbw_check(L, 1, &lbw_array_class);
  lbw_argument_check(L, array->rows <= INT32_MAX, 1,
                     "an array of at most 2147483647 rows expected");
  lua_createtable(L, (int)array->rows, 0);
  for (int64_t i = 0; i < array->rows; i++) {
    if (array->columns == 1)
      lbw_push_number(L, array, i, 0);
    else {
      lua_createtable(L, (int)array->columns, 0);
      for (int64_t j = 0; j < array->columns; j++) {
        lbw_push_number(L, array, i, j);
        lua_rawseti(L, -2, j + 1);
      }
    }
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

static void add_number(luaL_Buffer *buffer, const bw_array *array, int64_t row, int64_t column) {
  char text[40];
  snprintf(text, sizeof text, "%.6g", bw_array_get(array, row, column));
  luaL_addstring(buffer, text);
}

static int array_tostring(lua_State *L) {
  enum { SHOWN = 6 };
  const bw_array *array = (const bw_array *)lbw_check(L, 1, &lbw_array_class);
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  char head[80];
  snprintf(head, sizeof head, "array of %lld x %lld %s: {", (long long)array->rows,
           (long long)array->columns, lbw_type_word(array->type));
  luaL_addstring(&buffer, head);
  for (int64_t i = 0; i < array->rows && i < SHOWN; i++) {
    luaL_addstring(&buffer, i ? ", " : "");
    if (array->columns > 1)
      luaL_addchar(&buffer, '{');
    for (int64_t j = 0; j < array->columns && j < 2 * SHOWN; j++) {
      luaL_addstring(&buffer, j ? ", " : "");
      add_number(&buffer, array, i, j);
    }
    if (array->columns > 2 * SHOWN)
      luaL_addstring(&buffer, ", ...");
    if (array->columns > 1)
      luaL_addchar(&buffer, '}');
  }
  luaL_addstring(&buffer, array->rows > SHOWN ? ", ...}" : "}");
  luaL_pushresult(&buffer);
  return 1;
}

/* ---- for the other files: packed blocks from arrays and tables ------------------------------- */

static void *to_packed(lua_State *L, int index, const char *what, bw_type type, int64_t columns,
                       int64_t *rows) {
  index = lua_absindex(L, index);
  const bw_array *array = (const bw_array *)lbw_test(L, index, &lbw_array_class);
  int64_t width = 1;
  if (array) {
    *rows = array->rows;
    width = array->columns;
  } else if (lua_istable(L, index))
    table_shape(L, index, rows, &width);
  else
    lbw_error(L, "%s: an array or a table of rows expected, got %s", what, lbw_got(L, index));
  if (columns > 0 && width != columns && *rows > 0)
    lbw_error(L, "%s: rows of %I numbers expected, got %I", what, (LUAI_UACINT)columns,
              (LUAI_UACINT)width);
  void *data = lua_newuserdatauv(L, (size_t)(*rows * width) * bw_type_size(type) + 1, 0);
  if (!array) {
    fill_from_table(L, index, what, type, *rows, width, is_nested(L, index), data);
    return data;
  }
  for (int64_t i = 0; i < *rows; i++)
    for (int64_t j = 0; j < width; j++) {
      double value = bw_array_get(array, i, j);
      if (type == BW_F64)
        ((double *)data)[i * width + j] = value;
      else if (value >= INT32_MIN && value <= INT32_MAX && value == floor(value))
        ((int32_t *)data)[i * width + j] = (int32_t)value;
      else
        lbw_error(L, "%s: entry (%I, %I): a whole number expected, got %f", what,
                  (LUAI_UACINT)i + 1, (LUAI_UACINT)j + 1, value);
    }
  return data;
}

double *lbw_to_doubles(lua_State *L, int index, const char *what, int64_t columns, int64_t *rows) {
  return (double *)to_packed(L, index, what, BW_F64, columns, rows);
}

int32_t *lbw_to_indices(lua_State *L, int index, const char *what, int64_t columns, int64_t *rows) {
  int32_t *data = (int32_t *)to_packed(L, index, what, BW_I32, columns, rows);
  int64_t count = (int64_t)(lua_rawlen(L, -1) / sizeof *data);
  for (int64_t i = 0; i < count; i++) {
    if (data[i] < 1)
      lbw_error(L, "%s: indices count from 1, got %d", what, (int)data[i]);
    data[i]--;
  }
  return data;
}

int32_t *lbw_to_tags(lua_State *L, int index, const char *what, int64_t rows) {
  int64_t count;
  int32_t *tag = (int32_t *)to_packed(L, index, what, BW_I32, 1, &count);
  lbw_require_rows(L, what, count, rows, "element");
  return tag;
}

uint8_t *lbw_to_mask(lua_State *L, int index, const char *what, int64_t count) {
  const bw_array *array = (const bw_array *)lbw_test(L, index, &lbw_array_class);
  if (!array || array->columns != 1)
    lbw_error(L, "%s: an array of one column expected, got %s", what, lbw_got(L, index));
  else if (array->rows != count)
    lbw_error(L, "%s: %I rows expected, got %I", what, (LUAI_UACINT)count,
              (LUAI_UACINT)array->rows);
  uint8_t *mask = (uint8_t *)lua_newuserdatauv(L, (size_t)count + 1, 0);
  for (int64_t i = 0; i < count; i++)
    mask[i] = bw_array_get(array, i, 0) != 0;
  return mask;
}

/* ---- the class ------------------------------------------------------------------------------- */

LBW_PUSH(array_row_count,
         lua_pushinteger(L, ((const bw_array *)lbw_check(L, 1, &lbw_array_class))->rows))
LBW_PUSH(array_column_count,
         lua_pushinteger(L, ((const bw_array *)lbw_check(L, 1, &lbw_array_class))->columns))
LBW_PUSH(array_type,
         lua_pushstring(L,
                        lbw_type_word(((const bw_array *)lbw_check(L, 1, &lbw_array_class))->type)))

static const luaL_Reg methods[] = {{"rows", array_rows},      {"columns", array_columns},
                                   {"column", array_column},  {"totable", array_totable},
                                   {"tostring", array_bytes}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"row_count", array_row_count},
                                      {"column_count", array_column_count},
                                      {"type", array_type},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__len", array_length},
                                {"__call", array_call},
                                {"__index", array_index},
                                {"__tostring", array_tostring},
                                {NULL, NULL}};
const lbw_class lbw_array_class = {"array", methods, properties, meta, NULL};

void lbw_open_array(lua_State *L) {
  static const luaL_Reg functions[] = {{"new", array_new},
                                       {"zeros", array_zeros},
                                       {"range", array_range},
                                       {"from_string", array_from_string},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_array_class);
  lbw_add_array_operations(L);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lbw_add_array_functions(L);
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, module_call);
  lua_setfield(L, -2, "__call");
  lua_setmetatable(L, -2);
  lua_setfield(L, -2, "array");
  lua_pushcfunction(L, core_base64);
  lua_setfield(L, -2, "base64");
}
