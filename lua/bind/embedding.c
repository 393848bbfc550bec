/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* grid:embed(surface or points): what goes with a grid's nodes. The box of an embedding holds the
 * surface as its second reference. */
#include "grid.h"

#include <stdio.h>
#include <string.h>

static const bw_embedding *self(lua_State *L) {
  return (const bw_embedding *)lbw_check(L, 1, &lbw_embedding_class);
}

/* grid:embed(surface or places, {reach}) */
static int grid_embed(lua_State *L) {
  static const lbw_option list[] = {{"reach", LBW_REAL, 0}, {NULL, LBW_OTHER, 0}};
  const bw_grid *grid = (const bw_grid *)lbw_check(L, 1, &lbw_grid_class);
  const bw_surface *surface = (const bw_surface *)lbw_test(L, 2, &lbw_surface_class);
  double reach = 1;
  int64_t count;
  const double *point;
  lua_settop(L, 3);
  lbw_options(L, 3, "embed", list, &reach);
  if (surface) {
    point = surface->point;
    count = surface->point_count;
  } else {
    point = lbw_to_doubles(L, 2, "embed: places", 3, &count);
  }
  lbw_box *box = lbw_box_new(L, &lbw_embedding_class);
  bw_embedding *out = NULL;
  bw_status status = bw_embedding_create(lbw_enter(L), grid, count, point, reach, &out);
  if (out)
    box->extra = bw_retain(surface);
  return lbw_leave_object(L, box, out, status);
}

static const double *check_rows(lua_State *L, int index, const char *what, int64_t expected,
                                int64_t *columns) {
  const bw_array *array = (const bw_array *)lbw_test(L, index, &lbw_array_class);
  int64_t rows;
  *columns = array ? array->columns : 0;
  const double *data = lbw_to_doubles(L, index, what, 0, &rows);
  if (!array) /* a table of rows */
    *columns = rows ? (int64_t)(lua_rawlen(L, -1) / sizeof *data) / rows : 1;
  if (rows != expected)
    lbw_error(L, "%s: %I rows expected, got %I", what, (LUAI_UACINT)expected, (LUAI_UACINT)rows);
  return data;
}

/* embedding:values(values at nodes): at the points */
static int embedding_values(lua_State *L) {
  const bw_embedding *it = self(L);
  int64_t columns;
  lua_settop(L, 2);
  const double *value = check_rows(L, 2, "values", it->grid->node_count, &columns);
  bw_array *out = lbw_push_array(L, BW_F64, it->point_count, columns);
  bw_embedding_values(it, (int)columns, value, (double *)out->data);
  return 1;
}

/* embedding:forces(forces at points): the equivalent ones at nodes */
static int embedding_forces(lua_State *L) {
  const bw_embedding *it = self(L);
  int64_t columns;
  lua_settop(L, 2);
  const double *force = check_rows(L, 2, "forces", it->point_count, &columns);
  bw_array *out = lbw_push_array(L, BW_F64, it->grid->node_count, columns);
  bw_embedding_add(it, (int)columns, force, (double *)out->data);
  return 1;
}

/* embedding:moved(displacements of nodes): the surface, moved */
static int embedding_moved(lua_State *L) {
  const bw_embedding *it = self(L);
  const bw_surface *surface = (const bw_surface *)((lbw_box *)lua_touserdata(L, 1))->extra;
  int64_t columns;
  lua_settop(L, 2);
  if (!surface)
    return lbw_error(L, "moved: this embedding is of places, not of a surface");
  const double *u = check_rows(L, 2, "displacements", it->grid->node_count, &columns);
  if (columns != 3)
    return lbw_error(L, "moved: displacements of three columns expected, got %I",
                     (LUAI_UACINT)columns);
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *out = NULL;
  bw_status status = BW_MEMORY;
  bw_context *context = lbw_enter(L);
  double *point = BW_NEW(context, double, 3 * it->point_count);
  if (point) {
    bw_embedding_values(it, 3, u, point);
    for (int64_t i = 0; i < 3 * it->point_count; i++)
      point[i] += surface->point[i];
    status = bw_surface_copy(context, it->point_count, point, surface->triangle_count,
                             surface->triangle, surface->group, &out);
    if (status == BW_OK && out->group)
      out->names = bw_retain(surface->names);
  }
  bw_free(point);
  return lbw_leave_object(L, box, out, status);
}

LBW_PUSH(embedding_grid, lbw_push(L, &lbw_grid_class, self(L)->grid))

static int embedding_elements(lua_State *L) {
  const bw_embedding *it = self(L);
  return lbw_push_indices(L, it->point_count, 1, it->element);
}

LBW_PUSH(embedding_point_count, lua_pushinteger(L, self(L)->point_count))

static int embedding_tostring(lua_State *L) {
  const bw_embedding *it = self(L);
  char text[100];
  snprintf(text, sizeof text, "embedding of %lld points in %d elements", (long long)it->point_count,
           (int)it->grid->element_count);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg methods[] = {{"values", embedding_values},
                                   {"forces", embedding_forces},
                                   {"moved", embedding_moved},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"grid", embedding_grid},
                                      {"elements", embedding_elements},
                                      {"point_count", embedding_point_count},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", embedding_tostring}, {NULL, NULL}};
const lbw_class lbw_embedding_class = {"embedding", methods, properties, meta, NULL};

void lbw_open_embedding(lua_State *L) {
  static const luaL_Reg embed[] = {{"embed", grid_embed}, {NULL, NULL}};
  lbw_class_register(L, &lbw_embedding_class);
  lbw_add_methods(L, &lbw_grid_class, embed);
}
