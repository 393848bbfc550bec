/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions of tetrahedral meshes: mesh.regions, mesh:region(name), selection:region(name). Those of
 * grids are in region.c. */
#include "bind.h"

#include <string.h>

static const bw_mesh *self(lua_State *L) {
  return (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
}

int32_t lbw_check_region(lua_State *L, int argument, const bw_mesh *mesh) {
  const char *wanted = lbw_check_text(L, argument, NULL);
  int32_t found = bw_mesh_find_region(mesh, wanted);
  if (found >= 0)
    return found;
  if (mesh->region_count == 0)
    return lbw_error(L, "there is no region '%s': the mesh has no regions", wanted);
  size_t count = (size_t)mesh->region_count;
  const char **candidate = (const char **)lua_newuserdatauv(L, count * sizeof *candidate, 0);
  for (size_t i = 0; i < count; i++)
    candidate[i] = mesh->regions[i].name.text;
  return lbw_error(L, "there is no region '%s': %s", wanted,
                   lbw_suggestion(L, wanted, candidate, count));
}

bw_mesh_region *lbw_read_region_names(lua_State *L, int index, const char *what, int32_t *count) {
  int32_t names = 0;
  if (!lua_isnoneornil(L, index) && !lua_istable(L, index))
    lbw_error(L, "%s: a table {[tag] = name} expected, got %s", what, lbw_got(L, index));
  if (lua_istable(L, index))
    for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1))
      names++;
  bw_mesh_region *named =
      (bw_mesh_region *)lua_newuserdatauv(L, ((size_t)names + 1) * sizeof *named, 0);
  *count = names;
  if (names == 0)
    return named;
  names = 0;
  for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
    lua_Integer tag = lua_isinteger(L, -2) ? lua_tointeger(L, -2) : INT64_MAX;
    if (tag < INT32_MIN || tag > INT32_MAX)
      lbw_error(L, "%s: a tag, a whole number of 32 bits, expected, got %s", what, lbw_got(L, -2));
    named[names] = (bw_mesh_region){.tag = (int32_t)tag};
    lbw_read_name(L, -1, what, &named[names++].name);
  }
  return named;
}

const char *lbw_region_text(lua_State *L, const bw_mesh *mesh) {
  enum { SHOWN = 8 };
  luaL_Buffer text;
  luaL_buffinit(L, &text);
  for (int32_t i = 0; i < mesh->region_count && i < SHOWN; i++) {
    luaL_addstring(&text, i > 0 ? ", '" : mesh->region_count > 1 ? ", regions '" : ", region '");
    luaL_addstring(&text, mesh->regions[i].name.text);
    luaL_addstring(&text, "'");
  }
  if (mesh->region_count > SHOWN) {
    lua_pushfstring(L, " and %d more", (int)mesh->region_count - SHOWN);
    luaL_addvalue(&text);
  }
  luaL_pushresult(&text);
  return lua_tostring(L, -1);
}

/* {name, tag, volume, elements}, one for each */
static int list_regions(lua_State *L) {
  const bw_mesh *mesh = self(L);
  int32_t count = mesh->region_count;
  double *volume = (double *)lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *volume, 0);
  int32_t **next = (int32_t **)lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *next, 0);
  bw_mesh_region_volumes(mesh, volume);
  lua_createtable(L, count, 0);
  for (int32_t i = 0; i < count; i++) {
    const bw_mesh_region *r = &mesh->regions[i];
    lua_createtable(L, 0, 4);
    lua_pushstring(L, r->name.text);
    lua_setfield(L, -2, "name");
    lua_pushinteger(L, r->tag);
    lua_setfield(L, -2, "tag");
    lua_pushnumber(L, volume[i]);
    lua_setfield(L, -2, "volume");
    next[i] = (int32_t *)lbw_push_array(L, BW_I32, r->element_count, 1)->data;
    lua_setfield(L, -2, "elements");
    lua_rawseti(L, -2, (lua_Integer)i + 1);
  }
  for (int32_t e = 0; count > 0 && e < mesh->element_count; e++)
    *next[mesh->region[e]]++ = e + 1;
  return 1;
}

int lbw_mesh_regions(lua_State *L) {
  return lbw_cached(L, "regions", list_regions);
}

/* The place of each element's region in mesh.regions; nil without regions. */
int lbw_mesh_element_regions(lua_State *L) {
  const bw_mesh *mesh = self(L);
  return mesh->region ? lbw_push_indices(L, mesh->element_count, 1, mesh->region) : 0;
}

/* mesh:region(name) */
int lbw_mesh_region(lua_State *L) {
  int32_t region = lbw_check_region(L, 2, self(L));
  lbw_mesh_regions(L);
  lua_rawgeti(L, -1, (lua_Integer)region + 1);
  return 1;
}

/* mesh:with_regions(tags, names): tags nil: without regions */
int lbw_mesh_with_regions(lua_State *L) {
  const bw_mesh *mesh = self(L);
  int32_t *tag = NULL, named_count;
  lua_settop(L, 3);
  if (!lua_isnil(L, 2))
    tag = lbw_to_tags(L, 2, "with_regions: tags", mesh->element_count);
  bw_mesh_region *named = lbw_read_region_names(L, 3, "with_regions: names", &named_count);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *out = NULL;
  bw_mesh_regions regions = {0, NULL, NULL};
  bw_status status = BW_OK;
  bw_context *context = lbw_enter(L);
  if (tag)
    BW_TRY(bw_mesh_regions_by_tag(context, mesh->element_count, tag, named_count, named, &regions));
  status = bw_mesh_with_regions(context, mesh, &regions, &out);
done:
  bw_mesh_regions_clear(&regions);
  return lbw_leave_object(L, box, out, status);
}
