/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* barwright.occt: the face of libbarwright_occt, for lua/barwright/cad.lua. A module of its own, so
 * that nothing else loads OpenCASCADE; it shares only libbarwright with barwright.core. */
#include <lauxlib.h>
#include <lua.h>

#include "barwright/occt.h"

int luaopen_barwright_occt(lua_State *L);
int luaopen_barwright_occt(lua_State *L) {
  bw_cad_register(bw_occt_read);
  lua_createtable(L, 0, 1);
  lua_pushstring(L, bw_occt_version());
  lua_setfield(L, -2, "version");
  return 1;
}
