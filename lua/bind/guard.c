/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Guards: what is in use is not closed.
 *
 * A bound function takes pointers out of boxes, and then may allocate in Lua. That may run the
 * collector, and with it a script's finalisers; and the engine may call a function of the script.
 * Neither may take away an object that the bound function works on. So every bound function runs
 * under a guard: while the innermost guard is not open, close() raises, and what the collector
 * finds is released when the guard ends. An open guard stands around a function of the script that
 * may do anything: that of a job, those of a minimiser.
 *
 * Invariant: state->guard is the innermost guard of the bound functions that run, in whatever
 * coroutine; a bound function runs protected, so an error ends its guard too, and the engine is at
 * rest again after it. */
#include "bind.h"

#include <stdlib.h>

struct lbw_late {
  const void *object;
  lbw_late *next;
};

void lbw_guard_begin(lbw_state *state, lbw_guard *guard, bool open) {
  *guard = (lbw_guard){state->guard, state->caller, state->running, open};
  state->guard = guard;
  if (open)
    state->running = 0;
}

bool lbw_busy(const lbw_state *state) {
  return state->guard && !state->guard->open;
}

void lbw_guard_end(lbw_state *state, const lbw_guard *guard) {
  state->guard = guard->outer;
  state->running = guard->running;
  state->caller = guard->caller;
  while (state->late && !lbw_busy(state)) {
    lbw_late *late = state->late;
    state->late = late->next;
    bw_release(late->object);
    free(late);
  }
}

void lbw_release_unused(lbw_state *state, const void *object) {
  if (!object)
    return;
  if (!lbw_busy(state)) {
    bw_release(object);
    return;
  }
  lbw_late *late = (lbw_late *)malloc(sizeof *late);
  if (!late)
    return; /* an object that is never released is better than one that is released in use */
  *late = (lbw_late){object, state->late};
  state->late = late;
}

int lbw_guarded(lua_State *L) {
  const lbw_class *class = (const lbw_class *)lua_touserdata(L, lua_upvalueindex(2));
  if (class)
    lbw_check_box(L, 1, class);
  lbw_state *state = lbw_state_of(L);
  lbw_guard guard;
  luaL_checkstack(L, 1, "too many values");
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lbw_guard_begin(state, &guard, false);
  int failure = lua_pcall(L, lua_gettop(L) - 1, LUA_MULTRET, 0);
  lbw_guard_end(state, &guard);
  return failure == LUA_OK ? lua_gettop(L) : lua_error(L);
}

void lbw_push_guarded(lua_State *L, lua_CFunction function, const lbw_class *class) {
  lua_pushcfunction(L, function);
  if (class)
    lua_pushlightuserdata(L, (void *)class);
  else
    lua_pushnil(L);
  lua_pushcclosure(L, lbw_guarded, 2);
}

void lbw_guard_functions(lua_State *L, int table) {
  table = lua_absindex(L, table);
  luaL_checkstack(L, 8, "too many tables");
  for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
    bool plain = lua_iscfunction(L, -1) && !lua_getupvalue(L, -1, 1);
    if (plain) {
      lbw_push_guarded(L, lua_tocfunction(L, -1), NULL);
      lua_pushvalue(L, -3);
      lua_insert(L, -2);
      lua_rawset(L, table);
    } else if (lua_istable(L, -1)) {
      lbw_guard_functions(L, -1);
      if (lua_getmetatable(L, -1)) {
        lbw_guard_functions(L, -1);
        lua_pop(L, 1);
      }
    } else if (lua_iscfunction(L, -1)) {
      lua_pop(L, 1); /* the upvalue */
    }
  }
}
