/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A Lua module for scripts/bench/agile.lua: what the shape of an edit session costs from scratch.
 *   local cholmod = require "cholmod"
 *   times = cholmod.baseline(incremental_system, metis_order)
 * The stiffness is assembled from all elements; CHOLMOD factorises and solves once, with the
 * unknowns in the order that was chosen for edits or (metis_order) in that of a single solution,
 * METIS's of the nodes, whose computation counts as analysis. Seconds: stiffness, analysis, factor,
 * solve; flops and entries of the factor. The system needs a factor, and stays as it is. */
#include <string.h>

#include "bind.h"

#include "bench/cholmod_baseline.h"
#include "incremental/incremental.h"

typedef struct baseline_times {
  double stiffness, ordering;
  cholmod_times cholmod;
} baseline_times;

static bw_status measure(bw_context *context, const bw_incremental_system *incremental,
                         bool metis_order, baseline_times *times) {
  bw_status status = BW_OK;
  const bwi_incremental *inner = incremental->inner;
  const bw_system *view = incremental->system;
  if (!inner->factor)
    return bw_fail(context, BW_INVALID, "the system has no factor yet: solve it once first");
  const bwi_symbolic *symbolic = inner->factor->symbolic;
  bwi_symbolic *own = NULL;
  size_t entries = 9 * (size_t)view->pattern->block_count;
  /* set beforehand: the first touch of new memory is not what is timed */
  double *values = BW_NEW0(context, double, entries);
  double *x = BW_NEW(context, double, symbolic->unknowns);
  if (!values || !x) {
    status = BW_MEMORY;
    goto done;
  }
  memset(values, 1, entries * sizeof *values);
  double start = bw_seconds();
  BW_TRY(bw_stiffness(context, view->pattern, view->mesh, inner->model->material, values));
  times->stiffness = bw_seconds() - start;
  start = bw_seconds();
  if (metis_order) {
    BW_TRY(bwi_symbolic_for(context, view->pattern, view->dof_map, BW_ORDERING_AUTO, 0, NULL, NULL,
                            NULL, &own));
    symbolic = own;
  }
  times->ordering = bw_seconds() - start;
  bwi_matrix matrix = {
      .pattern = view->pattern, .stiffness = view->stiffness, .dof_map = view->dof_map};
  for (int32_t i = 0; i < symbolic->unknowns; i++)
    x[i] = i % 7 - 3;
  BW_TRY(cholmod_baseline(context, symbolic, &matrix, x, &times->cholmod));
done:
  bw_release(own);
  bw_free(values);
  bw_free(x);
  return status;
}

static void store(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

static int baseline(lua_State *L) {
  const lbw_box *box = lua_touserdata(L, 1);
  bool fits = box && luaL_getmetafield(L, 1, "__name") == LUA_TSTRING &&
              strcmp(lua_tostring(L, -1), "barwright.incremental_system") == 0;
  luaL_argcheck(L, fits, 1, "an incremental system expected");
  baseline_times times = {0};
  luaL_argcheck(L, box->object, 1, "it is closed");
  bw_context *context = bw_context_create();
  if (!context)
    return luaL_error(L, "no memory");
  bw_status status = measure(context, box->object, lua_toboolean(L, 2), &times);
  if (status != BW_OK)
    lua_pushstring(L, bw_message(context));
  bw_context_destroy(context);
  if (status != BW_OK)
    return lua_error(L);
  lua_createtable(L, 0, 6);
  store(L, "stiffness", times.stiffness);
  store(L, "analysis", times.ordering + times.cholmod.analysis);
  store(L, "factor", times.cholmod.factor);
  store(L, "solve", times.cholmod.solve);
  store(L, "flops", times.cholmod.flops);
  store(L, "entries", times.cholmod.entries);
  return 1;
}

int luaopen_cholmod(lua_State *L);
int luaopen_cholmod(lua_State *L) {
  lua_createtable(L, 0, 1);
  lua_pushcfunction(L, baseline);
  lua_setfield(L, -2, "baseline");
  return 1;
}
