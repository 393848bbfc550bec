/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions of tetrahedral meshes: lists, names, splits and interfaces; bodies that overlap. Regions
 * of grids are in region.c. */
#include "bind.h"

#include <math.h>
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
    lua_pushfstring(L, "region '%s' (tag %d) of %d elements, %s", r->name.text, (int)r->tag,
                    (int)r->element_count, lbw_quantity(volume[i], "m3").text);
    lbw_prints(L);
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

/* ---- splitting ------------------------------------------------------------------------------- */

typedef struct places {
  bw_context *context;
  lbw_field *field;          /* or NULL */
  const bw_surface *surface; /* or NULL: the box */
  double min[3], max[3];
} places;

static bw_status are_inside(void *data, int64_t count, const double *at, uint8_t *inside) {
  const places *p = (const places *)data;
  if (p->surface)
    return bw_surface_contains(p->context, p->surface, count, at, inside);
  for (int64_t i = 0; i < count; i++) {
    const double *x = at + 3 * i;
    if (i % 4096 == 0) {
      bw_status status = bw_check_cancel(p->context);
      if (status != BW_OK)
        return status;
    }
    if (p->field)
      inside[i] = lbw_field_value(p->field, x) != 0;
    else
      inside[i] = x[0] >= p->min[0] && x[0] <= p->max[0] && x[1] >= p->min[1] &&
                  x[1] <= p->max[1] && x[2] >= p->min[2] && x[2] <= p->max[2];
  }
  return bw_check_cancel(p->context); /* after an error of the script's function too */
}

static void read_places(lua_State *L, int index, places *p) {
  static const lbw_option list[] = {{"min", LBW_VECTOR, offsetof(places, min)},
                                    {"max", LBW_VECTOR, offsetof(places, max)},
                                    {NULL, LBW_OTHER, 0}};
  p->surface = (const bw_surface *)lbw_test(L, index, &lbw_surface_class);
  if (lua_isfunction(L, index) || lua_type(L, index) == LUA_TSTRING)
    p->field = lbw_field_read(L, index, "split");
  else if (lua_istable(L, index))
    lbw_options(L, index, "split", list, p);
  else if (!p->surface)
    lbw_error(
        L,
        "split: a function of x, y, z, a formula, a box {min =, max =} or a surface expected, "
        "got %s",
        lbw_got(L, index));
}

/* mesh:split(where, name): mesh, {volume, misplaced, cut} */
int lbw_mesh_split(lua_State *L) {
  const bw_mesh *mesh = self(L);
  places p = {.min = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, .max = {HUGE_VAL, HUGE_VAL, HUGE_VAL}};
  lua_settop(L, 3);
  const char *name = lbw_check_text(L, 3, NULL);
  read_places(L, 2, &p);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *out = NULL;
  bw_split_log log = {0, 0, 0};
  p.context = lbw_enter(L);
  if (p.field)
    lbw_field_begin(p.field, p.context);
  bw_status status = bw_mesh_split(p.context, mesh, name, are_inside, &p, &out, &log);
  if (p.field)
    lbw_field_end(p.field, p.context);
  lbw_box_fill(L, box, out);
  lua_createtable(L, 0, 3);
  lua_pushnumber(L, log.volume);
  lua_setfield(L, -2, "volume");
  lua_pushnumber(L, log.misplaced);
  lua_setfield(L, -2, "misplaced");
  lua_pushinteger(L, log.cut);
  lua_setfield(L, -2, "cut");
  lua_pushfstring(
      L, "region '%s' of %s; %s is on the other side of what was asked for, %d elements cut", name,
      lbw_quantity(log.volume, "m3").text, lbw_quantity(log.misplaced, "m3").text, (int)log.cut);
  lbw_prints(L);
  return lbw_leave(L, status, 2);
}

/* mesh:separated(name) */
int lbw_mesh_separated(lua_State *L) {
  const bw_mesh *mesh = self(L);
  int32_t region = lbw_check_region(L, 2, mesh);
  lbw_box *box = lbw_box_new(L, &lbw_mesh_class);
  bw_mesh *out = NULL;
  bw_status status = bw_mesh_separate(lbw_enter(L), mesh, region, &out);
  return lbw_leave_object(L, box, out, status);
}

typedef struct found {
  const bw_mesh *mesh;
  int32_t a, b; /* regions */
  bw_mesh_interface interface;
} found;

/* The interface as a table; runs protected. */
static int push_interface(lua_State *L) {
  const found *f = (const found *)lua_touserdata(L, 1);
  lua_createtable(L, 0, 3);
  lbw_push_indices(L, f->interface.count, f->mesh->nodes_per_facet, f->interface.facet);
  lua_setfield(L, -2, "facets");
  lbw_push_indices(L, f->interface.count, 2, f->interface.element);
  lua_setfield(L, -2, "elements");
  lua_pushnumber(L, f->interface.area);
  lua_setfield(L, -2, "area");
  lua_pushfstring(L, "interface of '%s' and '%s': %d facets, %s", f->mesh->regions[f->a].name.text,
                  f->mesh->regions[f->b].name.text, (int)f->interface.count,
                  lbw_quantity(f->interface.area, "m2").text);
  lbw_prints(L);
  return 1;
}

/* mesh:interface(a, b): {facets, elements, area} */
int lbw_mesh_interface(lua_State *L) {
  found f = {.mesh = self(L)};
  f.a = lbw_check_region(L, 2, f.mesh);
  f.b = lbw_check_region(L, 3, f.mesh);
  lua_pushcfunction(L, push_interface);
  lua_pushlightuserdata(L, &f);
  lbw_leave_or_raise(L, bw_mesh_interface_find(lbw_enter(L), f.mesh, f.a, f.b, &f.interface));
  int failure = lua_pcall(L, 1, 1, 0);
  bw_mesh_interface_clear(&f.interface);
  return failure ? lua_error(L) : 1;
}

/* The overlaps as a list; runs protected. */
static int push_overlaps(lua_State *L) {
  const bw_mesh_overlaps *overlaps = (const bw_mesh_overlaps *)lua_touserdata(L, 1);
  lua_createtable(L, overlaps->count, 1);
  for (int32_t i = 0; i < overlaps->count; i++) {
    const bw_mesh_overlap *o = &overlaps->overlap[i];
    lua_createtable(L, 0, 6);
    lbw_push_indices(L, 1, 2, o->body);
    lua_setfield(L, -2, "bodies");
    lbw_push_indices(L, 1, 2, o->element);
    lua_setfield(L, -2, "elements");
    lbw_push_vector(L, o->at);
    lua_setfield(L, -2, "at");
    lua_pushnumber(L, o->depth);
    lua_setfield(L, -2, "depth");
    lua_pushnumber(L, o->volume);
    lua_setfield(L, -2, "volume");
    lua_pushnumber(L, o->fraction);
    lua_setfield(L, -2, "fraction");
    lua_pushfstring(L, "bodies %d and %d overlap by at least %s, volume %s", (int)o->body[0] + 1,
                    (int)o->body[1] + 1, lbw_quantity(o->depth, "m").text,
                    lbw_quantity(o->volume, "m3").text);
    lbw_prints(L);
    lua_rawseti(L, -2, i + 1);
  }
  lua_pushboolean(L, overlaps->more);
  lua_setfield(L, -2, "more");
  return 1;
}

/* mesh:overlaps(): {{bodies, elements, at, depth, volume, fraction}, ..., more =} */
int lbw_mesh_overlaps(lua_State *L) {
  bw_mesh_overlaps overlaps;
  const bw_mesh *mesh = self(L);
  lua_pushcfunction(L, push_overlaps);
  lua_pushlightuserdata(L, &overlaps);
  lbw_leave_or_raise(L, bw_mesh_overlaps_find(lbw_enter(L), mesh, &overlaps));
  int failure = lua_pcall(L, 1, 1, 0);
  bw_mesh_overlaps_clear(&overlaps);
  return failure ? lua_error(L) : 1;
}
