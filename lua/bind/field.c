/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fields over space from Lua (functions, formulas, numbers), units of length, boxes and logs as
 * tables, named arrays as fields of a file. */
#include "bind.h"
#include "formula/expression.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

struct lbw_field {
  lbw_state *state;
  int function; /* stack index of a Lua function, or 0 */
  int threads;
  lbw_expression formula;
  double constant;
  bool is_constant;
};

static const lbw_variable coordinates[3] = {{.name = "x", .type = BW_F64, .rows = 1, .columns = 1},
                                            {.name = "y", .type = BW_F64, .rows = 1, .columns = 1},
                                            {.name = "z", .type = BW_F64, .rows = 1, .columns = 1}};

lbw_field *lbw_field_read(lua_State *L, int index, const char *what) {
  index = lua_absindex(L, index);
  lbw_field *field = (lbw_field *)lua_newuserdatauv(L, sizeof *field, 0);
  memset(field, 0, sizeof *field);
  field->state = lbw_state_of(L);
  char error[256];
  switch (lua_type(L, index)) {
  case LUA_TNUMBER:
    field->is_constant = true;
    field->constant = lua_tonumber(L, index);
    break;
  case LUA_TFUNCTION:
    field->function = index;
    break;
  case LUA_TSTRING:
    if (!lbw_expression_compile(lua_tostring(L, index), coordinates, 3, &field->formula, error,
                                sizeof error))
      lbw_error(L, "%s: %s", what, error);
    break;
  default:
    lbw_error(L, "%s: a function of x, y, z, a formula in them, or a number expected, got %s", what,
              lbw_got(L, index));
  }
  return field;
}

void lbw_field_begin(lbw_field *field, bw_context *context) {
  field->threads = bw_threads(context);
  if (field->function && bw_set_threads(context, 1) != BW_OK)
    field->threads = 0;
}

void lbw_field_end(lbw_field *field, bw_context *context) {
  if (field->function && field->threads > 0 && bw_set_threads(context, field->threads) != BW_OK)
    field->threads = 0; /* fewer threads than before: slower, nothing worse */
}

double lbw_field_value(void *data, const double at[3]) {
  lbw_field *field = (lbw_field *)data;
  if (field->is_constant)
    return field->constant;
  if (field->function)
    return lbw_call_field(field->state, field->function, at, 1);
  lbw_variable variable[3];
  memcpy(variable, coordinates, sizeof variable);
  for (int i = 0; i < 3; i++)
    variable[i].data = &at[i];
  lbw_expression formula = field->formula; /* engine threads share the field: a copy each */
  formula.variable = variable;
  double value;
  lbw_expression_block(&formula, 0, 1, 0, &value);
  return value;
}

/* ---- units ----------------------------------------------------------------------------------- */

static const struct {
  const char *name;
  double metres;
} units[] = {{"um", 1e-6}, {"mm", 0.001},  {"cm", 0.01},  {"m", 1},
             {"km", 1000}, {"in", 0.0254}, {"ft", 0.3048}}; /* those of the command line */
enum { UNITS = sizeof units / sizeof *units };

double lbw_unit_option(lua_State *L, int options, const char *function, double otherwise) {
  double metres = otherwise;
  switch (lbw_option_get(L, options, "unit")) {
  case LUA_TNIL:
    break;
  case LUA_TNUMBER:
    metres = lua_tonumber(L, -1);
    if (!(metres > 0) || !isfinite(metres))
      lbw_option_refused(L, function, "unit", "a number of metres above 0");
    break;
  case LUA_TSTRING: {
    const char *name[UNITS];
    const char *wanted = lua_tostring(L, -1);
    metres = 0;
    for (int i = 0; i < UNITS; i++) {
      name[i] = units[i].name;
      if (strcmp(wanted, units[i].name) == 0)
        metres = units[i].metres;
    }
    if (metres == 0)
      lbw_error(L, "%s: unknown unit '%s': %s", function, wanted,
                lbw_suggestion(L, wanted, name, UNITS));
    break;
  }
  default:
    lbw_option_refused(L, function, "unit", "a name such as \"mm\" or a number of metres");
  }
  lua_pop(L, 1);
  return metres;
}

double lbw_unit_of_path(const char *path) {
  static const char *const mesh_endings[] = {".msh", ".vtu",  ".pvtu", ".mesh",
                                             ".inp", ".node", ".ele",  ".glb"};
  size_t length = strlen(path);
  for (size_t i = 0; i < sizeof mesh_endings / sizeof *mesh_endings; i++) {
    size_t ending = strlen(mesh_endings[i]);
    if (length >= ending && strcasecmp(path + length - ending, mesh_endings[i]) == 0)
      return 1;
  }
  return 0.001;
}

/* ---- tables ---------------------------------------------------------------------------------- */

void lbw_push_box(lua_State *L, const double min[3], const double max[3]) {
  lua_createtable(L, 0, 3);
  lbw_push_vector(L, min);
  lua_setfield(L, -2, "min");
  lbw_push_vector(L, max);
  lua_setfield(L, -2, "max");
  const double size[3] = {max[0] - min[0], max[1] - min[1], max[2] - min[2]};
  lbw_push_vector(L, size);
  lua_setfield(L, -2, "size");
}

void lbw_push_box_text(lua_State *L, const double min[3], const double max[3]) {
  double longest = fmax(max[0] - min[0], fmax(max[1] - min[1], max[2] - min[2])), scale;
  const char *unit = lbw_shown_unit(longest, "m", &scale);
  char text[200];
  snprintf(text, sizeof text, "%.4g x %.4g x %.4g %s from %s", (max[0] - min[0]) / scale,
           (max[1] - min[1]) / scale, (max[2] - min[2]) / scale, unit,
           lbw_triple(min, scale, unit).text);
  lua_pushstring(L, text);
}

void lbw_push_shape_log(lua_State *L, const bw_shape_log *log) {
  lua_createtable(L, 0, 2);
  lua_pushnumber(L, log->moved);
  lua_setfield(L, -2, "moved");
  lua_createtable(L, log->count, 0);
  for (int i = 0; i < log->count && i < BW_SHAPE_STEPS; i++) {
    const bw_shape_step *step = &log->step[i];
    lua_createtable(L, 0, 4);
    lua_pushstring(L, step->name);
    lua_setfield(L, -2, "name");
    lua_pushinteger(L, step->count);
    lua_setfield(L, -2, "count");
    lua_pushnumber(L, step->moved);
    lua_setfield(L, -2, "moved");
    lua_pushstring(L, step->text);
    lua_setfield(L, -2, "text");
    lua_rawseti(L, -2, i + 1);
  }
  lua_setfield(L, -2, "steps");
  luaL_setmetatable(L, "barwright.shape_log");
}

/* ---- fields of files ------------------------------------------------------------------------- */

static int compare_fields(const bw_field *a, const bw_field *b) {
  return strcmp(a->name, b->name);
}

/* {name = array} or {name = {array, on = "elements"}}; in the order of the names, so that the file
 * has the same bytes every time. */
bw_field *lbw_fields(lua_State *L, int index, const char *function, int64_t nodes, int64_t elements,
                     int *count) {
  enum { FIELDS = 100 };
  static const char *const places[] = {"nodes", "elements", NULL};
  index = lua_absindex(L, index);
  bw_field *field = (bw_field *)lua_newuserdatauv(L, FIELDS * sizeof *field, 0);
  *count = 0;
  if (lua_isnoneornil(L, index))
    return field;
  if (!lua_istable(L, index))
    lbw_error(L, "%s: fields: a table {name = array} expected, got %s", function,
              lbw_got(L, index));
  for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
    if (lua_type(L, -2) != LUA_TSTRING)
      lbw_error(L, "%s: fields: a table {name = array} expected, got a value at %s", function,
                lbw_got(L, -2));
    const char *name = lua_tostring(L, -2);
    int place = -1;
    int top = lua_gettop(L);
    if (lua_istable(L, -1)) {
      place = lbw_word_option(L, -1, function, "on", places, -1);
      lua_rawgeti(L, -1, 1);
    }
    const bw_array *array = (const bw_array *)lbw_test(L, -1, &lbw_array_class);
    if (!array)
      lbw_error(L, "%s: field '%s': an array expected, got %s", function, name, lbw_got(L, -1));
    if (place < 0)
      place = array->rows == nodes ? 0 : 1;
    if (array->rows != (place ? elements : nodes))
      lbw_error(
          L, "%s: field '%s': a row for each of %I nodes or %I elements expected, got %I rows",
          function, name, (LUAI_UACINT)nodes, (LUAI_UACINT)elements, (LUAI_UACINT)array->rows);
    if (*count == FIELDS)
      lbw_error(L, "%s: at most %d fields expected", function, FIELDS);
    lua_settop(L, top);
    bw_field new = {name, place ? BW_ON_ELEMENTS : BW_ON_NODES, array};
    int at = (*count)++;
    for (; at > 0 && compare_fields(&new, &field[at - 1]) < 0; at--)
      field[at] = field[at - 1];
    field[at] = new;
  }
  return field;
}
