/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a solver did, as a table. */
#include "bind.h"

#include <stdio.h>

static void text(lua_State *L, const char *key, const char *value) {
  if (value && *value) {
    lua_pushstring(L, value);
    lua_setfield(L, -2, key);
  }
}

static void number(lua_State *L, const char *key, double value) {
  if (value != 0) {
    lua_pushnumber(L, value);
    lua_setfield(L, -2, key);
  }
}

bool lbw_has_report(const bw_solver_report *report) {
  return report->solver && report->solver[0];
}

void lbw_push_report(lua_State *L, const bw_solver_report *report) {
  lua_createtable(L, 0, 12);
  text(L, "solver", report->solver);
  text(L, "backend", report->backend);
  text(L, "preconditioner", report->preconditioner);
  text(L, "reason", report->reason);
  number(L, "predicted_cost", report->predicted_cost);
  number(L, "rival_cost", report->rival_cost);
  number(L, "flops", report->flops);
  number(L, "bytes", report->bytes);
  number(L, "seconds", report->seconds);
  if (report->iterations > 0) {
    lua_pushinteger(L, report->iterations);
    lua_setfield(L, -2, "iterations");
  }
  number(L, "residual", report->residual);
  number(L, "reused", report->reused);
  luaL_setmetatable(L, "barwright.solver_report");
}

static const char *field(lua_State *L, const char *key) {
  lua_getfield(L, 1, key);
  return lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : NULL;
}

static double figure(lua_State *L, const char *key) {
  lua_getfield(L, 1, key);
  return lua_type(L, -1) == LUA_TNUMBER ? lua_tonumber(L, -1) : 0;
}

/* "pcg (two_level): 23 iterations, residual 4e-11, 12.3 MB, 0.2 s; it was given" */
static int report_tostring(lua_State *L) {
  lbw_check_type(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  const char *solver = field(L, "solver"), *backend = field(L, "backend"),
             *preconditioner = field(L, "preconditioner"), *reason = field(L, "reason");
  double iterations = figure(L, "iterations"), residual = figure(L, "residual"),
         bytes = figure(L, "bytes"), seconds = figure(L, "seconds");
  luaL_Buffer text;
  char part[80];
  luaL_buffinit(L, &text);
  luaL_addstring(&text, solver ? solver : "unknown solver");
  if (backend || preconditioner) {
    luaL_addstring(&text, " (");
    luaL_addstring(&text, preconditioner ? preconditioner : backend);
    if (backend && preconditioner) {
      luaL_addstring(&text, ", ");
      luaL_addstring(&text, backend);
    }
    luaL_addstring(&text, ")");
  }
  const char *before = ": ";
  if (iterations > 0) {
    snprintf(part, sizeof part, "%s%.0f iteration%s", before, iterations,
             iterations == 1 ? "" : "s");
    luaL_addstring(&text, part);
    before = ", ";
  }
  if (residual > 0) {
    snprintf(part, sizeof part, "%sresidual %.1e", before, residual);
    luaL_addstring(&text, part);
    before = ", ";
  }
  if (bytes > 0) {
    snprintf(part, sizeof part, "%s%s", before, lbw_quantity(bytes, "B").text);
    luaL_addstring(&text, part);
    before = ", ";
  }
  if (seconds > 0) {
    snprintf(part, sizeof part, "%s%s", before, lbw_quantity(seconds, "s").text);
    luaL_addstring(&text, part);
  }
  if (reason) {
    luaL_addstring(&text, "; ");
    luaL_addstring(&text, reason);
  }
  luaL_pushresult(&text);
  return 1;
}

void lbw_open_report(lua_State *L) {
  luaL_newmetatable(L, "barwright.solver_report");
  lua_pushcfunction(L, report_tostring);
  lua_setfield(L, -2, "__tostring");
  lua_pop(L, 1);
}
