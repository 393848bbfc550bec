/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.operator: a script's function as an operator, and what sparse matrices and operators have in
 * common: solutions, inverses, eigenpairs.
 *
 * The function is kept with the box of its operator, so that a function that refers to the operator
 * is collected with it; a weak table in the registry leads from the engine's data to the box. It is
 * called on the thread of the script, under an open guard: between two of its calls the solver
 * waits, so it may call the engine, and close what it likes. Whatever a solver works on is
 * retained. */
#include "bind.h"

#include <stdio.h>
#include <string.h>

static const char boxes_key; /* registry: weak table, script's data -> box of the operator */

typedef struct script {
  lbw_state *state;
  int64_t size;
} script;

/* One product; what call_function works on. */
typedef struct product {
  const script *script;
  const double *x;
  double *y;
} product;

/* (product), protected: y = function(x) */
static int call_function(lua_State *L) {
  const product *p = (const product *)lua_touserdata(L, 1);
  int64_t size = p->script->size;
  lua_rawgetp(L, LUA_REGISTRYINDEX, &boxes_key);
  if (lua_rawgetp(L, -1, p->script) != LUA_TUSERDATA || lua_getiuservalue(L, -1, 1) != LUA_TTABLE ||
      lua_getfield(L, -1, "apply") == LUA_TNIL)
    return lbw_error(L, "operator: it was closed while it was in use");
  memcpy(lbw_push_array(L, BW_F64, size, 1)->data, p->x, (size_t)size * sizeof *p->x);
  lua_call(L, 1, 1);
  if (!lbw_test(L, -1, &lbw_array_class) && !lua_istable(L, -1))
    return lbw_error(L, "operator: the function 'apply' must return an array of %I numbers, got %s",
                     (LUAI_UACINT)size, lbw_got(L, -1));
  int64_t rows;
  const double *y = lbw_to_doubles(L, -1, "operator: the result of 'apply'", 1, &rows);
  if (rows != size)
    return lbw_error(L, "operator: the function 'apply' must return %I numbers, got %I",
                     (LUAI_UACINT)size, (LUAI_UACINT)rows);
  memcpy(p->y, y, (size_t)size * sizeof *y);
  return 0;
}

enum { MAX_CALLS = 20 }; /* of a traceback */

/* Message handler: where the error came from within the function, if not from itself. */
static int add_calls(lua_State *L) {
  lua_Debug at;
  int frames = 0;
  if (lua_type(L, 1) != LUA_TSTRING)
    return 1;
  lua_pushliteral(L, "");
  for (int level = 1; frames < MAX_CALLS && lua_getstack(L, level, &at); level++) {
    lua_getinfo(L, "Slf", &at);
    bool end = lua_tocfunction(L, -1) == call_function;
    lua_pop(L, 1);
    if (end)
      break;
    if (at.currentline > 0) {
      lua_pushfstring(L, "\n\t%s:%d: in 'apply'", at.short_src, at.currentline);
      lua_concat(L, 2);
      frames++;
    }
  }
  if (frames < 2)
    lua_pop(L, 1);
  else
    lua_concat(L, 2);
  return 1;
}

/* bw_operator_function of a script's function. Where it fails its error is kept, and the solver
 * ends as if it had been cancelled. */
static bw_status apply_function(bw_context *context, void *data, int64_t count, const double *x,
                                double *y) {
  const script *s = (const script *)data;
  lbw_state *state = s->state;
  lua_State *L = state->caller;
  if (!lua_checkstack(L, 10))
    return bw_fail(context, BW_LIMIT, "operators call each other too often");
  for (int64_t k = 0; k < count; k++) {
    product p = {s, x + k * s->size, y + k * s->size};
    bw_status status = bw_check_cancel(context); /* a call to the engine would end the request */
    if (status != BW_OK)
      return status;
    lua_pushcfunction(L, add_calls);
    lua_pushcfunction(L, call_function);
    lua_pushlightuserdata(L, &p);
    lbw_guard guard;
    lbw_guard_begin(state, &guard, true);
    int failure = lua_pcall(L, 1, 0, -3);
    lbw_guard_end(state, &guard);
    if (failure != LUA_OK) {
      lbw_keep_error(state);
      lua_pop(L, 1);
      return bw_fail(context, BW_CANCELLED, "the function of an operator failed");
    }
    lua_pop(L, 1);
  }
  return BW_OK;
}

/* operator{size, apply, name} */
static int operator_new(lua_State *L) {
  struct opts {
    int64_t size;
  } opts = {-1};
  static const lbw_option list[] = {{"size", LBW_COUNT, offsetof(struct opts, size)},
                                    {"apply", LBW_OTHER, 0},
                                    {"name", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  lbw_options(L, 1, "operator", list, &opts);
  if (lbw_option_get(L, 1, "size") == LUA_TNIL)
    lbw_option_missing(L, "operator", "size", ": the number of rows");
  if (opts.size < 1 || opts.size > INT32_MAX)
    lbw_option_refused(L, "operator", "size", "a number of rows of 1 or more");
  int type = lbw_option_get(L, 1, "name");
  if (type != LUA_TNIL && type != LUA_TSTRING)
    lbw_option_refused(L, "operator", "name", "a string");
  const char *name = type == LUA_TNIL ? NULL : lua_tostring(L, -1);
  if (lbw_option_get(L, 1, "apply") != LUA_TFUNCTION)
    lbw_option_refused(L, "operator", "apply", "a function of x");
  int function = lua_gettop(L);
  lbw_box *box = lbw_box_new(L, &lbw_operator_class);
  lua_newtable(L);
  lua_pushvalue(L, function);
  lua_setfield(L, -2, "apply");
  lua_setiuservalue(L, -2, 1);
  if (lua_rawgetp(L, LUA_REGISTRYINDEX, &boxes_key) != LUA_TTABLE)
    return lbw_error(L, "operator: the module was not opened");
  bw_operator *a = NULL;
  bw_context *context = lbw_enter(L);
  script *s = BW_NEW(context, script, 1);
  bw_status status = s ? BW_OK : BW_MEMORY;
  if (s) {
    *s = (script){lbw_state_of(L), opts.size};
    status = bw_operator_create(context, opts.size, apply_function, s, bw_free, name, &a);
    if (status != BW_OK)
      bw_free(s);
  }
  lua_insert(L, -2); /* the box behind the weak table */
  lbw_box_fill(L, box, a);
  if (status == BW_OK) {
    lua_pushvalue(L, -1);
    lua_rawsetp(L, -3, s);
  }
  return lbw_leave(L, status, 1);
}

/* ---- operators and matrices as arguments ----------------------------------------------------- */

/* An operator, or a sparse matrix that becomes one within the engine; or neither. */
typedef struct either {
  const bw_operator *a;
  const bw_sparse_matrix *matrix;
} either;

static bool read_either(lua_State *L, int index, either *e) {
  e->a = (const bw_operator *)lbw_test(L, index, &lbw_operator_class);
  e->matrix = (const bw_sparse_matrix *)lbw_test(L, index, &lbw_sparse_matrix_class);
  return e->a || e->matrix;
}

/* options[key], which stays on the stack. */
static either either_option(lua_State *L, int index, const char *function, const char *key) {
  either e = {NULL, NULL};
  if (lbw_option_get(L, index, key) != LUA_TNIL && !read_either(L, -1, &e))
    lbw_option_refused(L, function, key, "an operator or a sparse matrix");
  return e;
}

/* Self; a matrix or an operator. */
static either self_either(lua_State *L) {
  either e;
  if (!read_either(L, 1, &e))
    lbw_check(L, 1, &lbw_operator_class);
  return e;
}

static int64_t size_of(const either *e) {
  return e->a ? e->a->size : e->matrix->columns;
}

/* A reference for the time of a call: the script's functions may close what they like. */
static bw_status hold(bw_context *context, const either *e, const char *name, bw_operator **held) {
  *held = NULL;
  if (e->a)
    *held = (bw_operator *)bw_retain(e->a);
  else if (e->matrix)
    return bw_operator_of_matrix(context, e->matrix, name, held);
  return BW_OK;
}

/* Columns of `size` rows, one after the other, in a userdata that is pushed. */
static double *read_columns(lua_State *L, int index, const char *what, int64_t size,
                            int64_t *count) {
  int64_t rows;
  double *row = lbw_to_doubles(L, index, what, 0, &rows);
  lbw_require_rows(L, what, rows, size, "row of the matrix");
  *count = rows > 0 ? (int64_t)(lua_rawlen(L, -1) / sizeof *row) / rows : 1;
  if (*count == 1)
    return row;
  double *column = (double *)lua_newuserdatauv(L, (size_t)(size * *count + 1) * sizeof *row, 0);
  for (int64_t i = 0; i < size; i++)
    for (int64_t k = 0; k < *count; k++)
      column[k * size + i] = row[i * *count + k];
  return column;
}

/* ---- methods of both ------------------------------------------------------------------------- */

/* solve(b, {solver, preconditioner, guess}): x, report */
static int either_solve(lua_State *L) {
  static const lbw_option list[] = {{"solver", LBW_OTHER, 0},
                                    {"preconditioner", LBW_OTHER, 0},
                                    {"guess", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  either self = self_either(L);
  int64_t size = size_of(&self), count, guesses;
  lua_settop(L, 3);
  luaL_checkstack(L, 30, "too many values");
  lbw_options(L, 3, "solve", list, &(char){0});
  either preconditioner = either_option(L, 3, "solve", "preconditioner");
  const bw_solver *solver = lbw_solver_option(L, 3, "solve");
  const double *b = read_columns(L, 2, "b", size, &count), *guess = NULL;
  if (lbw_option_get(L, 3, "guess") != LUA_TNIL) {
    guess = read_columns(L, lua_gettop(L), "guess", size, &guesses);
    if (guesses != count)
      return lbw_error(L, "solve: option 'guess': %I columns expected, as b has, got %I",
                       (LUAI_UACINT)count, (LUAI_UACINT)guesses);
  }
  double *column = NULL;
  if (count != 1)
    column = (double *)lua_newuserdatauv(L, (size_t)(size * count + 1) * sizeof *column, 0);
  double *x = (double *)lbw_push_array(L, BW_F64, size, count)->data;
  bw_operator *a = NULL, *m = NULL;
  bw_solver_report report;
  bw_status status;
  bw_context *context = lbw_enter(L);
  bw_retain(solver);
  BW_TRY(hold(context, &self, NULL, &a));
  BW_TRY(hold(context, &preconditioner, "preconditioner", &m));
  const bw_linear_solve_options options = {.solver = solver, .preconditioner = m, .guess = guess};
  BW_TRY(bw_linear_solve(context, a, &options, count, b, column ? column : x, &report));
  for (int64_t i = 0; column && i < size; i++)
    for (int64_t k = 0; k < count; k++)
      x[i * count + k] = column[k * size + i];
done:
  bw_release(a);
  bw_release(m);
  bw_release(solver);
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  lbw_leave(L, status, 0);
  lbw_push_report(L, &report);
  return 2;
}

/* eigenpairs{count, mass, solver, preconditioner, tolerance, shift, test, seed} */
static int either_eigenpairs(lua_State *L) {
  static const lbw_option list[] = {
      {"count", LBW_INT, offsetof(bw_eigen_solve_options, count)},
      {"mass", LBW_OTHER, 0},
      {"solver", LBW_OTHER, 0},
      {"preconditioner", LBW_OTHER, 0},
      {"tolerance", LBW_REAL, offsetof(bw_eigen_solve_options, tolerance)},
      {"shift", LBW_REAL, offsetof(bw_eigen_solve_options, shift)},
      {"test", LBW_BOOLEAN, offsetof(bw_eigen_solve_options, test)},
      {"seed", LBW_SEED, offsetof(bw_eigen_solve_options, seed)},
      {NULL, LBW_OTHER, 0}};
  either self = self_either(L);
  bw_eigen_solve_options options;
  bw_eigen_solve_options_default(&options);
  lua_settop(L, 2);
  luaL_checkstack(L, 30, "too many values");
  lbw_options(L, 2, "eigenpairs", list, &options);
  either mass = either_option(L, 2, "eigenpairs", "mass");
  either preconditioner = either_option(L, 2, "eigenpairs", "preconditioner");
  options.solver = lbw_eigensolver_option(L, 2, "eigenpairs");
  lbw_box *box = lbw_box_new(L, &lbw_eigenpairs_class);
  bw_operator *k = NULL, *m = NULL, *b = NULL;
  bw_eigenpairs *pairs = NULL;
  bw_status status;
  bw_context *context = lbw_enter(L);
  bw_retain(options.solver);
  BW_TRY(hold(context, &self, NULL, &k));
  BW_TRY(hold(context, &mass, "mass", &m));
  BW_TRY(hold(context, &preconditioner, "preconditioner", &b));
  options.preconditioner = b;
  status = bw_eigen_solve(context, k, m, &options, &pairs);
done:
  bw_release(k);
  bw_release(m);
  bw_release(b);
  bw_release(options.solver);
  return lbw_leave_object(L, box, pairs, status);
}

/* matrix:inverse(solver) */
static int matrix_inverse(lua_State *L) {
  const bw_sparse_matrix *matrix =
      (const bw_sparse_matrix *)lbw_check(L, 1, &lbw_sparse_matrix_class);
  lua_settop(L, 2);
  const bw_solver *solver = NULL;
  if (!lua_isnil(L, 2))
    solver = (const bw_solver *)lbw_check(L, 2, &lbw_solver_class);
  lbw_box *box = lbw_box_new(L, &lbw_operator_class);
  bw_operator *a = NULL;
  bw_status status = bw_operator_inverse(lbw_enter(L), matrix, solver, &a);
  return lbw_leave_object(L, box, a, status);
}

/* ---- the classes ----------------------------------------------------------------------------- */

static const bw_operator *self(lua_State *L) {
  return (const bw_operator *)lbw_check(L, 1, &lbw_operator_class);
}

/* operator:apply(x) */
static int operator_apply(lua_State *L) {
  const bw_operator *a = self(L);
  int64_t rows;
  lua_settop(L, 2);
  const double *x = lbw_to_doubles(L, 2, "x", 1, &rows);
  lbw_check_rows(L, 2, "x", rows, a->size, "row of the operator");
  double *y = (double *)lbw_push_array(L, BW_F64, a->size, 1)->data;
  bw_context *context = lbw_enter(L);
  bw_retain(a);
  bw_status status = bw_operator_apply(context, a, 1, x, y);
  bw_release(a);
  return lbw_leave(L, status, 1);
}

LBW_PUSH(operator_size, lua_pushinteger(L, (lua_Integer)self(L)->size))
LBW_PUSH(operator_name, lua_pushstring(L, self(L)->name.text))

static int operator_tostring(lua_State *L) {
  const bw_operator *a = self(L);
  lua_pushfstring(L, "operator \"%s\" of %I rows", a->name.text, (LUAI_UACINT)a->size);
  return 1;
}

static const luaL_Reg operator_methods[] = {{"apply", operator_apply},
                                            {"solve", either_solve},
                                            {"eigenpairs", either_eigenpairs},
                                            {NULL, NULL}};
static const luaL_Reg operator_properties[] = {
    {"size", operator_size}, {"name", operator_name}, {NULL, NULL}};
static const luaL_Reg operator_meta[] = {{"__tostring", operator_tostring}, {NULL, NULL}};
const lbw_class lbw_operator_class = {"operator", operator_methods, operator_properties,
                                      operator_meta, NULL};

static const bw_eigenpairs *pairs_self(lua_State *L) {
  return (const bw_eigenpairs *)lbw_check(L, 1, &lbw_eigenpairs_class);
}

LBW_PUSH(pairs_count, lua_pushinteger(L, pairs_self(L)->count))

static int pairs_values(lua_State *L) {
  const bw_eigenpairs *pairs = pairs_self(L);
  return lbw_push_borrowed(L, BW_F64, pairs->count, 1, pairs->value, pairs);
}

static int pairs_errors(lua_State *L) {
  const bw_eigenpairs *pairs = pairs_self(L);
  return lbw_push_borrowed(L, BW_F64, pairs->count, 1, pairs->error, pairs);
}

static int pairs_residuals(lua_State *L) {
  const bw_eigenpairs *pairs = pairs_self(L);
  return lbw_push_borrowed(L, BW_F64, pairs->count, 1, pairs->residual, pairs);
}

LBW_PUSH(pairs_counted, lua_pushboolean(L, pairs_self(L)->counted))
LBW_PUSH(pairs_tested, lua_pushboolean(L, pairs_self(L)->tested))
LBW_PUSH(pairs_recovered, lua_pushinteger(L, pairs_self(L)->recovered))
LBW_PUSH(pairs_report, lbw_push_report(L, &pairs_self(L)->report))

/* pairs:vector(k) */
static int pairs_vector(lua_State *L) {
  const bw_eigenpairs *pairs = pairs_self(L);
  int64_t k = lbw_check_index(L, 2, "eigenpair", pairs->count);
  return lbw_push_borrowed(L, BW_F64, pairs->size, 1, pairs->vector + k * pairs->size, pairs);
}

/* "6 eigenpairs: 0.000967 (within 1e-12) to 0.0347 (within 3e-11); lanczos ..." */
static int pairs_tostring(lua_State *L) {
  const bw_eigenpairs *pairs = pairs_self(L);
  char text[200];
  int last = pairs->count - 1;
  if (last < 0)
    snprintf(text, sizeof text, "no eigenpairs");
  else
    snprintf(text, sizeof text, "%d eigenpair%s: %.6g (within %.1e)", pairs->count,
             last > 0 ? "s" : "", pairs->value[0], pairs->error[0]);
  lua_pushstring(L, text);
  if (last > 0) {
    snprintf(text, sizeof text, " to %.6g (within %.1e)", pairs->value[last], pairs->error[last]);
    lua_pushstring(L, text);
    lua_concat(L, 2);
  }
  lua_pushfstring(L, " by %s", pairs->report.solver);
  lua_concat(L, 2);
  return 1;
}

static const luaL_Reg pairs_methods[] = {{"vector", pairs_vector}, {NULL, NULL}};
static const luaL_Reg pairs_properties[] = {
    {"count", pairs_count},         {"values", pairs_values},   {"errors", pairs_errors},
    {"residuals", pairs_residuals}, {"counted", pairs_counted}, {"tested", pairs_tested},
    {"recovered", pairs_recovered}, {"report", pairs_report},   {NULL, NULL}};
static const luaL_Reg pairs_meta[] = {{"__tostring", pairs_tostring}, {NULL, NULL}};
const lbw_class lbw_eigenpairs_class = {"eigenpairs", pairs_methods, pairs_properties, pairs_meta,
                                        NULL};

void lbw_open_operator(lua_State *L) {
  static const luaL_Reg matrix_methods[] = {{"solve", either_solve},
                                            {"eigenpairs", either_eigenpairs},
                                            {"inverse", matrix_inverse},
                                            {NULL, NULL}};
  static const luaL_Reg functions[] = {{"operator", operator_new}, {NULL, NULL}};
  lbw_class_register(L, &lbw_operator_class);
  lbw_class_register(L, &lbw_eigenpairs_class);
  lbw_add_methods(L, &lbw_sparse_matrix_class, matrix_methods);
  luaL_setfuncs(L, functions, 0);
  lua_newtable(L);
  lua_createtable(L, 0, 1);
  lua_pushliteral(L, "v");
  lua_setfield(L, -2, "__mode");
  lua_setmetatable(L, -2);
  lua_rawsetp(L, LUA_REGISTRYINDEX, &boxes_key);
}
