/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a body is made of: the options mesh, material and materials. */
#include "bind.h"

#include <string.h>

/* The option 'materials', {name of a region = material}, on the top of the stack, as one material
 * of the mesh. It is pushed. */
static const bw_material *by_region(lua_State *L, const char *function, const bw_mesh *mesh) {
  int table = lua_gettop(L);
  if (!lua_istable(L, table))
    lbw_option_refused(L, function, "materials", "a table of materials by the names of regions");
  size_t bytes = ((size_t)mesh->region_count + 1) * sizeof(void *);
  const bw_material **part = (const bw_material **)lua_newuserdatauv(L, bytes, 0);
  memset(part, 0, bytes);
  for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
    if (lua_type(L, -2) != LUA_TSTRING)
      lbw_error(L, "%s: option 'materials': names of regions expected, got %s", function,
                lbw_got(L, -2));
    int32_t region = lbw_check_region(L, lua_absindex(L, -2), mesh);
    part[region] = (const bw_material *)lbw_test(L, -1, &lbw_material_class);
    if (!part[region])
      lbw_error(L, "%s: option 'materials': region '%s': an open material expected, got %s",
                function, mesh->regions[region].name.text, lbw_got(L, -1));
  }
  lbw_box *box = lbw_box_new(L, &lbw_material_class);
  bw_material *material = NULL;
  bw_status status = bw_material_by_region(lbw_enter(L), mesh, part, &material);
  lbw_box_fill(L, box, material);
  lbw_leave_or_raise(L, status);
  return material;
}

const bw_mesh *lbw_check_body(lua_State *L, const char *function, const bw_material **material) {
  lbw_option_get(L, 1, "mesh");
  const bw_mesh *mesh = (const bw_mesh *)lbw_test(L, -1, &lbw_mesh_class);
  if (!mesh)
    lbw_error(L, "%s: option 'mesh': an open mesh expected, got %s", function, lbw_got(L, -1));
  bool several = lbw_option_get(L, 1, "materials") != LUA_TNIL;
  bool one = lbw_option_get(L, 1, "material") != LUA_TNIL;
  if (several && one)
    lbw_error(L, "%s: option 'material' or option 'materials' expected, not both", function);
  if (several) {
    lua_pop(L, 1);
    *material = by_region(L, function, mesh);
    return mesh;
  }
  *material = (const bw_material *)lbw_test(L, -1, &lbw_material_class);
  if (!*material)
    lbw_error(L, "%s: option 'material': an open material expected, got %s", function,
              lbw_got(L, -1));
  return mesh;
}
