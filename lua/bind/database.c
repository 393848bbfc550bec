/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* core.database: SQL on files of results.
 *
 * Rows become Lua tables between the steps of a statement, where Lua may run out of memory: the
 * calls therefore run protected, and put their statement back in every case. */
#include "bind.h"

static bw_database *self(lua_State *L) {
  return (bw_database *)lbw_check(L, 1, &lbw_database_class);
}

/* What went wrong with a file is more than a status: its reason takes the place of it. */
static int leave(lua_State *L, bw_status status, int results) {
  bw_context *context = lbw_state_of(L)->context;
  const char *key, *text;
  double number;
  for (int i = 0; status != BW_OK && bw_detail(context, i, &key, &number, &text); i++)
    if (text && key[0] == 'r') { /* "reason" */
      bw_detail_text(context, "status", text);
      break;
    }
  return lbw_leave(L, status, results);
}

/* database(path, {read_only, busy_seconds}) */
static int core_database(lua_State *L) {
  static const lbw_option list[] = {
      {"read_only", LBW_BOOLEAN, offsetof(bw_database_options, read_only)},
      {"busy_seconds", LBW_REAL, offsetof(bw_database_options, busy_seconds)},
      {NULL, LBW_OTHER, 0}};
  const char *path = lbw_check_text(L, 1, NULL);
  bw_database_options options;
  bw_database_options_default(&options);
  lbw_options(L, 2, "database", list, &options);
  lbw_box *box = lbw_box_new(L, &lbw_database_class);
  bw_database *database = NULL;
  bw_status status = bw_database_open(lbw_enter(L), path, &options, &database);
  lbw_box_fill(L, box, database);
  return leave(L, status, 1);
}

/* database:execute(sql) */
static int database_execute(lua_State *L) {
  bw_database *database = self(L);
  const char *sql = lbw_check_text(L, 2, NULL);
  bw_status status = bw_database_execute(lbw_enter(L), database, sql);
  lua_pushboolean(L, 1);
  return leave(L, status, 1);
}

/* ---- one statement with parameters ----------------------------------------------------------- */

typedef struct call {
  bw_database *database;
  bw_statement *statement; /* in use, or NULL */
} call;

enum { FIRST_PARAMETER = 4 }; /* behind the call, the database, and the SQL */

static bw_status bind(lua_State *L, bw_context *context, bw_statement *s, int i, int index) {
  size_t length;
  switch (lua_type(L, index)) {
  case LUA_TNUMBER:
    if (lua_isinteger(L, index))
      return bw_statement_bind_integer(context, s, i, lua_tointeger(L, index));
    return bw_statement_bind_real(context, s, i, lua_tonumber(L, index));
  case LUA_TBOOLEAN:
    return bw_statement_bind_integer(context, s, i, lua_toboolean(L, index));
  case LUA_TSTRING: {
    const char *text = lua_tolstring(L, index, &length);
    return bw_statement_bind_text(context, s, i, text, length);
  }
  default:
    return BW_OK; /* nil */
  }
}

/* Returns 0, or the number of results that say what failed. */
static int prepare(lua_State *L, call *c) {
  const char *sql = lbw_check_text(L, 3, NULL);
  int given = lua_gettop(L) - FIRST_PARAMETER + 1;
  for (int i = 0; i < given; i++) {
    int type = lua_type(L, FIRST_PARAMETER + i);
    if (type != LUA_TNIL && type != LUA_TNUMBER && type != LUA_TBOOLEAN && type != LUA_TSTRING)
      return lbw_error(L, "parameter %d: nil, a number, a boolean or a text expected, got %s",
                       i + 1, lbw_got(L, FIRST_PARAMETER + i));
  }
  bw_context *context = lbw_enter(L);
  bw_status status = bw_database_prepare(context, c->database, sql, &c->statement);
  if (status == BW_OK && bw_statement_parameters(c->statement) != given)
    status = bw_fail(context, BW_INVALID, "%d parameters expected, got %d: %.200s",
                     bw_statement_parameters(c->statement), given, sql);
  for (int i = 0; i < given && status == BW_OK; i++)
    status = bind(L, context, c->statement, i, FIRST_PARAMETER + i);
  return leave(L, status, 0);
}

static void push_value(lua_State *L, const bw_sql_value *value) {
  switch (value->type) {
  case BW_SQL_INTEGER:
    lua_pushinteger(L, value->integer);
    break;
  case BW_SQL_REAL:
    lua_pushnumber(L, value->real);
    break;
  case BW_SQL_TEXT:
    lua_pushlstring(L, value->text, value->length);
    break;
  default:
    lua_pushnil(L);
  }
}

/* Pushes the row that the statement stands at; the columns' names begin at `names`. */
static int push_row(lua_State *L, bw_statement *s, int names, int columns) {
  lua_createtable(L, 0, columns);
  for (int i = 0; i < columns; i++) {
    bw_sql_value value;
    bw_status status = bw_statement_value(lbw_enter(L), s, i, &value);
    int failed = leave(L, status, 0);
    if (failed)
      return failed;
    lua_pushvalue(L, names + i);
    push_value(L, &value);
    lua_rawset(L, -3);
  }
  return 0;
}

/* (call, database, sql, ...), protected */
static int rows(lua_State *L) {
  call *c = (call *)lua_touserdata(L, 1);
  int failed = prepare(L, c);
  if (failed)
    return failed;
  int columns = bw_statement_columns(c->statement);
  luaL_checkstack(L, columns + 20, "too many columns");
  lua_newtable(L);
  int list = lua_gettop(L), names = list + 1;
  for (int i = 0; i < columns; i++)
    lua_pushstring(L, bw_statement_column_name(c->statement, i));
  for (lua_Integer n = 1;; n++) {
    bool row;
    failed = leave(L, bw_statement_step(lbw_enter(L), c->statement, &row), 0);
    if (failed)
      return failed;
    if (!row)
      break;
    failed = push_row(L, c->statement, names, columns);
    if (failed)
      return failed;
    lua_rawseti(L, list, n);
  }
  lua_pushvalue(L, list);
  return 1;
}

/* (call, database, sql, ...), protected */
static int change(lua_State *L) {
  call *c = (call *)lua_touserdata(L, 1);
  int failed = prepare(L, c);
  bool row = true;
  while (!failed && row)
    failed = leave(L, bw_statement_step(lbw_enter(L), c->statement, &row), 0);
  if (failed)
    return failed;
  lua_pushinteger(L, bw_database_changed(c->database));
  return 1;
}

static int run(lua_State *L, lua_CFunction body) {
  call c = {self(L), NULL};
  luaL_checkstack(L, 20, "too many parameters");
  lua_pushcfunction(L, body);
  lua_insert(L, 1);
  lua_pushlightuserdata(L, &c);
  lua_insert(L, 2);
  int failure = lua_pcall(L, lua_gettop(L) - 1, LUA_MULTRET, 0);
  bw_statement_put_back(c.statement);
  return failure == LUA_OK ? lua_gettop(L) : lua_error(L);
}

/* database:rows(sql, ...) */
static int database_rows(lua_State *L) {
  return run(L, rows);
}

/* database:change(sql, ...) */
static int database_change(lua_State *L) {
  return run(L, change);
}

/* salvage(damaged, to[, schema[, relist]]): {tables, rows, lost, whole, relisted, log} */
static int core_salvage(lua_State *L) {
  const char *damaged = lbw_check_text(L, 1, NULL), *to = lbw_check_text(L, 2, NULL);
  const char *schema = lua_isnoneornil(L, 3) ? NULL : lbw_check_text(L, 3, NULL);
  bool relist = lua_toboolean(L, 4);
  bw_salvage_report report = {0};
  bw_context *context = lbw_enter(L);
  bw_clear_warnings(context); /* of earlier calls: there is room for so many only */
  int failed = leave(L, bw_database_salvage(context, damaged, to, schema, relist, &report), 0);
  if (failed)
    return failed;
  lua_createtable(L, 0, 6);
  lua_pushinteger(L, report.tables);
  lua_setfield(L, -2, "tables");
  lua_pushinteger(L, report.rows);
  lua_setfield(L, -2, "rows");
  lua_pushinteger(L, report.lost);
  lua_setfield(L, -2, "lost");
  lua_pushboolean(L, report.whole);
  lua_setfield(L, -2, "whole");
  lua_pushboolean(L, report.relisted);
  lua_setfield(L, -2, "relisted");
  lua_newtable(L);
  for (int i = 0; bw_warning_at(context, i); i++) {
    lua_pushstring(L, bw_warning_at(context, i));
    lua_rawseti(L, -2, i + 1);
  }
  lua_setfield(L, -2, "log");
  return 1;
}

/* ---- the rest -------------------------------------------------------------------------------- */

/* database:check(): true, or false and what is wrong with the file */
static int database_check(lua_State *L) {
  bw_database *database = self(L);
  char *problems = NULL;
  bw_status status = bw_database_check(lbw_enter(L), database, 20, &problems);
  if (status != BW_OK || !problems) {
    lua_pushboolean(L, 1);
    return leave(L, status, 1);
  }
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  luaL_addstring(&buffer, problems);
  bw_free(problems);
  luaL_pushresult(&buffer);
  lua_pushboolean(L, 0);
  lua_insert(L, -2);
  return leave(L, BW_OK, 2);
}

LBW_PUSH(database_path, lua_pushstring(L, bw_database_path(self(L))))
LBW_PUSH(database_inside_transaction, lua_pushboolean(L, bw_database_inside_transaction(self(L))))
LBW_PUSH(database_tostring, lua_pushfstring(L, "database: %s", bw_database_path(self(L))))

static const luaL_Reg methods[] = {{"execute", database_execute},
                                   {"change", database_change},
                                   {"rows", database_rows},
                                   {"check", database_check},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {
    {"path", database_path}, {"inside_transaction", database_inside_transaction}, {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", database_tostring}, {NULL, NULL}};
const lbw_class lbw_database_class = {"database", methods, properties, meta, NULL};

void lbw_open_database(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"database", core_database}, {"salvage", core_salvage}, {NULL, NULL}};
  lbw_class_register(L, &lbw_database_class);
  luaL_setfuncs(L, functions, 0);
}
