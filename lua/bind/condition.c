/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conditions by tag from Lua. Values are numbers, formulas in x, y, t, or functions of them. The
 * engine keeps the conditions for as long as its object lives: they are read into a userdata that
 * the object's box keeps, and Lua functions are put on the stack for the length of each call. */
#include "condition.h"

#include <math.h>
#include <string.h>

typedef struct value {
  lbw_state *state;
  int function; /* place on the stack during a call; 0: a formula */
  lbw_expression formula;
} value;

enum { SIZE = BW_CONVECTION + 1 }; /* in the list of words */

struct lbw_conditions {
  int32_t count; /* with the size */
  bw_condition *condition;
  value *value;
  bool sized; /* the last one is the size of the mesh */
};

static const lbw_variable place_and_time[3] = {
    {.name = "x", .type = BW_F64, .rows = 1, .columns = 1},
    {.name = "y", .type = BW_F64, .rows = 1, .columns = 1},
    {.name = "t", .type = BW_F64, .rows = 1, .columns = 1}};

static double value_at(void *data, const double at[2], double time) {
  value *v = (value *)data;
  const double all[3] = {at[0], at[1], time};
  if (v->function)
    return lbw_call_field(v->state, v->function, all, 0);
  lbw_variable variable[3];
  memcpy(variable, place_and_time, sizeof variable);
  for (int i = 0; i < 3; i++)
    variable[i].data = &all[i];
  v->formula.variable = variable;
  double result;
  lbw_expression_block(&v->formula, 0, 1, 0, &result);
  return result;
}

/* A function that failed has its error kept, and the answer counts for nothing: any size will do.
 */
static double size_at(void *data, const double at[2]) {
  value *v = (value *)data;
  if (v->function)
    return lbw_call_field(v->state, v->function, (double[3]){at[0], at[1], 0}, INFINITY);
  return value_at(data, at, 0);
}

/* The condition's table is on the top, the userdata below it. */
static void read_value(lua_State *L, const char *what, lbw_conditions *all, int32_t i) {
  bw_condition *c = &all->condition[i];
  value *v = &all->value[i];
  char error[256];
  v->state = lbw_state_of(L);
  switch (lua_getfield(L, -1, "value")) {
  case LUA_TNUMBER:
    c->value = lua_tonumber(L, -1);
    if (!isfinite(c->value))
      lbw_error(L, "%s: a finite number expected, got %s", what, lbw_got(L, -1));
    break;
  case LUA_TSTRING:
    if (!lbw_expression_compile(lua_tostring(L, -1), place_and_time, 3, &v->formula, error,
                                sizeof error))
      lbw_error(L, "%s: %s", what, error);
    c->function = value_at;
    break;
  case LUA_TFUNCTION: /* kept by number in the userdata's table */
    c->function = value_at;
    lua_getiuservalue(L, -3, 1);
    lua_pushvalue(L, -2);
    lua_rawseti(L, -2, i + 1);
    lua_pop(L, 1);
    break;
  default:
    lbw_error(L, "%s: a number, a formula in x, y, t, or a function of them expected, got %s", what,
              lbw_got(L, -1));
  }
  c->data = v;
  lua_pop(L, 1);
}

lbw_conditions *lbw_conditions_read(lua_State *L, int index, const char *what,
                                    const bw_outline *outline) {
  static const char *const kinds[] = {"prescribed", "traction", "pressure",
                                      "convection", "size",     NULL};
  index = lua_absindex(L, index);
  lbw_check_type(L, index, LUA_TTABLE);
  size_t count = lua_rawlen(L, index);
  lbw_conditions *all = (lbw_conditions *)lua_newuserdatauv(
      L, sizeof *all + count * (sizeof(bw_condition) + sizeof(value)), 1);
  all->count = (int32_t)count;
  all->sized = false;
  all->value = (value *)(all + 1);
  all->condition = (bw_condition *)(all->value + count);
  memset(all->value, 0, count * (sizeof(bw_condition) + sizeof(value)));
  lua_newtable(L);
  lua_setiuservalue(L, -2, 1);
  for (int32_t i = 0; i < all->count; i++) {
    bw_condition *c = &all->condition[i];
    lua_rawgeti(L, index, i + 1);
    lbw_check_type(L, -1, LUA_TTABLE);
    c->tag = -1;
    if (lua_getfield(L, -1, "tag") != LUA_TNIL) {
      const char *tag = lua_tostring(L, -1);
      c->tag = tag ? bw_outline_find_tag(outline, tag) : -1;
      if (c->tag < 0) {
        const char **name =
            (const char **)lua_newuserdatauv(L, (size_t)outline->tag_count * sizeof *name, 0);
        for (int32_t t = 0; t < outline->tag_count; t++)
          name[t] = outline->tag[t].text;
        lbw_error(L, "%s: the outline has no tag '%s': %s", what, tag ? tag : "",
                  lbw_suggestion(L, tag ? tag : "", name, (size_t)outline->tag_count));
      }
    }
    lua_pop(L, 1);
    int kind = lbw_word_option(L, -1, what, "kind", kinds, BW_PRESCRIBED);
    all->sized = kind == SIZE;
    c->kind = (bw_condition_kind)kind;
    lua_getfield(L, -1, "component");
    c->component = (int)lua_tointeger(L, -1) - 1;
    lua_pop(L, 1);
    lua_getfield(L, -1, "coefficient");
    c->coefficient = lua_tonumber(L, -1);
    lua_pop(L, 1);
    lua_getfield(L, -1, "order");
    c->order = (int32_t)lua_tointeger(L, -1);
    lua_pop(L, 1);
    read_value(L, what, all, i);
    lua_pop(L, 1);
  }
  return all;
}

const bw_condition *lbw_conditions_list(const lbw_conditions *all, int32_t *count) {
  *count = all->count - all->sized;
  return all->condition;
}

void lbw_conditions_size(const lbw_conditions *all, bw_plane_options *fill) {
  if (!all->sized)
    return;
  fill->field = size_at;
  fill->field_data = &all->value[all->count - 1];
}

void lbw_conditions_keep(lua_State *L, int box, int conditions) {
  box = lua_absindex(L, box);
  lua_pushvalue(L, conditions);
  lua_setiuservalue(L, box, 1);
}

void lbw_conditions_begin(lua_State *L, int box) {
  if (lua_getiuservalue(L, box, 1) != LUA_TUSERDATA) {
    lua_pop(L, 1);
    return;
  }
  lbw_conditions *all = (lbw_conditions *)lua_touserdata(L, -1);
  lua_getiuservalue(L, -1, 1);
  int functions = lua_gettop(L);
  luaL_checkstack(L, all->count + 20, "too many conditions");
  for (int32_t i = 0; i < all->count; i++) {
    bool is_function = lua_rawgeti(L, functions, i + 1) == LUA_TFUNCTION;
    all->value[i].function = is_function ? lua_gettop(L) : 0;
  }
}
