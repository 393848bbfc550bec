/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.sparse_matrix, and files of arrays. */
#include "bind.h"

static const bw_sparse_matrix *self(lua_State *L) {
  return (const bw_sparse_matrix *)lbw_check(L, 1, &lbw_sparse_matrix_class);
}

/* sparse_matrix.new(row_count, column_count, rows, columns, values) */
static int matrix_new(lua_State *L) {
  lua_Integer rows = lbw_check_integer(L, 1), columns = lbw_check_integer(L, 2);
  lbw_argument_check(L, rows >= 0 && rows < INT32_MAX, 1, "a number of rows expected");
  lbw_argument_check(L, columns >= 0 && columns < INT32_MAX, 2, "a number of columns expected");
  int64_t count, other;
  lua_settop(L, 5);
  int32_t *row = lbw_to_indices(L, 3, "rows", 1, &count);
  int32_t *column = lbw_to_indices(L, 4, "columns", 1, &other);
  lbw_check_rows(L, 4, "columns", other, count, "entry");
  double *value = lbw_to_doubles(L, 5, "values", 1, &other);
  lbw_check_rows(L, 5, "values", other, count, "entry");
  lbw_box *box = lbw_box_new(L, &lbw_sparse_matrix_class);
  bw_sparse_matrix *matrix = NULL;
  bw_status status = bw_sparse_matrix_create(lbw_enter(L), (int32_t)rows, (int32_t)columns, count,
                                             row, column, value, &matrix);
  return lbw_leave_object(L, box, matrix, status);
}

/* sparse_matrix.read(path) */
static int matrix_read(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  lbw_box *box = lbw_box_new(L, &lbw_sparse_matrix_class);
  bw_sparse_matrix *matrix = NULL;
  bw_status status = bw_sparse_matrix_read(lbw_enter(L), path, &matrix);
  return lbw_leave_object(L, box, matrix, status);
}

/* matrix:write(path) */
static int matrix_write(lua_State *L) {
  const bw_sparse_matrix *matrix = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  bw_status status = bw_sparse_matrix_write(lbw_enter(L), matrix, path);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* matrix:apply(x) */
static int matrix_apply(lua_State *L) {
  const bw_sparse_matrix *matrix = self(L);
  int64_t rows;
  double *x = lbw_to_doubles(L, 2, "x", 1, &rows);
  lbw_check_rows(L, 2, "x", rows, matrix->columns, "column");
  double *y = (double *)lbw_push_array(L, BW_F64, matrix->rows, 1)->data;
  return lbw_leave(L, bw_sparse_matrix_apply(lbw_enter(L), matrix, 1, x, y), 1);
}

/* matrix:entries(): rows, columns, values */
static int matrix_entries(lua_State *L) {
  const bw_sparse_matrix *matrix = self(L);
  int64_t count = matrix->start[matrix->rows];
  int32_t *row = (int32_t *)lbw_push_array(L, BW_I32, count, 1)->data;
  for (int32_t i = 0; i < matrix->rows; i++)
    for (int64_t k = matrix->start[i]; k < matrix->start[i + 1]; k++)
      row[k] = i + 1;
  lbw_push_indices(L, count, 1, matrix->column);
  lbw_push_borrowed(L, BW_F64, count, 1, matrix->value, matrix);
  return 3;
}

LBW_PUSH(matrix_row_count, lua_pushinteger(L, self(L)->rows))
LBW_PUSH(matrix_column_count, lua_pushinteger(L, self(L)->columns))
LBW_PUSH(matrix_entry_count, lua_pushinteger(L, self(L)->start[self(L)->rows]))
LBW_PUSH(matrix_symmetric, lua_pushboolean(L, bw_sparse_matrix_is_symmetric(self(L))))

static int matrix_tostring(lua_State *L) {
  const bw_sparse_matrix *matrix = self(L);
  lua_pushfstring(L, "sparse matrix of %d x %d, %I entries", (int)matrix->rows,
                  (int)matrix->columns, (LUAI_UACINT)matrix->start[matrix->rows]);
  return 1;
}

static const luaL_Reg methods[] = {
    {"write", matrix_write}, {"apply", matrix_apply}, {"entries", matrix_entries}, {NULL, NULL}};
static const luaL_Reg properties[] = {{"row_count", matrix_row_count},
                                      {"column_count", matrix_column_count},
                                      {"entry_count", matrix_entry_count},
                                      {"symmetric", matrix_symmetric},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", matrix_tostring}, {NULL, NULL}};
const lbw_class lbw_sparse_matrix_class = {"sparse_matrix", methods, properties, meta, NULL};

/* ---- arrays ---------------------------------------------------------------------------------- */

/* array.read(path) */
static int array_read(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  lbw_box *box = lbw_box_new(L, &lbw_array_class);
  bw_array *array = NULL;
  bw_status status = bw_array_read(lbw_enter(L), path, &array);
  return lbw_leave_object(L, box, array, status);
}

/* array:write(path) */
static int array_write(lua_State *L) {
  const bw_array *array = (const bw_array *)lbw_check(L, 1, &lbw_array_class);
  const char *path = lbw_check_text(L, 2, NULL);
  bw_status status = bw_array_write(lbw_enter(L), array, path);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* ---- systems --------------------------------------------------------------------------------- */

/* system:matrix("stiffness" | "mass", {whole}) */
static int system_matrix(lua_State *L) {
  static const char *const words[] = {"stiffness", "mass", NULL};
  struct opts {
    bool whole;
  } opts = {false};
  static const lbw_option list[] = {{"whole", LBW_BOOLEAN, offsetof(struct opts, whole)},
                                    {NULL, LBW_OTHER, 0}};
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  lua_settop(L, 3);
  int part = lbw_check_word(L, 2, words);
  lbw_options(L, 3, "matrix", list, &opts);
  lbw_box *box = lbw_box_new(L, &lbw_sparse_matrix_class);
  bw_sparse_matrix *matrix = NULL;
  bw_status status =
      bw_system_matrix(lbw_enter(L), system, (bw_system_part)part, opts.whole, &matrix);
  return lbw_leave_object(L, box, matrix, status);
}

/* system:right_hand_side(force) */
static int system_right_hand_side(lua_State *L) {
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  int64_t rows;
  double *force = lbw_to_doubles(L, 2, "force", 3, &rows);
  lbw_check_rows(L, 2, "force", rows, system->mesh->node_count, "node");
  double *b = (double *)lbw_push_array(L, BW_F64, system->dof_map->unknown_count, 1)->data;
  return lbw_leave(L, bw_system_right_hand_side(lbw_enter(L), system, force, b), 1);
}

/* system:displacement(x) */
static int system_displacement(lua_State *L) {
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  int64_t rows;
  double *x = lbw_to_doubles(L, 2, "x", 1, &rows);
  lbw_check_rows(L, 2, "x", rows, system->dof_map->unknown_count, "unknown");
  double *u = (double *)lbw_push_array(L, BW_F64, system->mesh->node_count, 3)->data;
  bw_system_displacement(system, x, u);
  return 1;
}

void lbw_open_sparse_matrix(lua_State *L) {
  static const luaL_Reg functions[] = {{"new", matrix_new}, {"read", matrix_read}, {NULL, NULL}};
  static const luaL_Reg array_methods[] = {{"write", array_write}, {NULL, NULL}};
  static const luaL_Reg system_methods[] = {{"matrix", system_matrix},
                                            {"right_hand_side", system_right_hand_side},
                                            {"displacement", system_displacement},
                                            {NULL, NULL}};
  lbw_class_register(L, &lbw_sparse_matrix_class);
  lbw_add_methods(L, &lbw_array_class, array_methods);
  lbw_add_methods(L, &lbw_system_class, system_methods);
  lua_getfield(L, -1, "array");
  lua_pushcfunction(L, array_read);
  lua_setfield(L, -2, "read");
  lua_pop(L, 1);
  luaL_newlib(L, functions);
  lua_setfield(L, -2, "sparse_matrix");
}
