/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Folders, locks between processes, temporary files, SHA-256 of text. */
#include "bind.h"

#include <unistd.h>

static const luaL_Reg nothing[] = {{NULL, NULL}}; /* close alone, which all classes have */
const lbw_class lbw_lock_class = {"lock", nothing, nothing, NULL, NULL};

/* sha256_of(text) */
static int core_sha256_of(lua_State *L) {
  size_t length;
  const char *text = lbw_check_text(L, 1, &length);
  char digest[65];
  bw_sha256_bytes(text, length, digest);
  lua_pushstring(L, digest);
  return 1;
}

/* make_folder(path): with those above it */
static int core_make_folder(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  bw_status status = bw_folder_make(lbw_enter(L), path);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* touch(path): changed now */
static int core_touch(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  bw_status status = bw_file_touch(lbw_enter(L), path);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* The entries are kept in memory of the engine until the walk is over: Lua may raise. */
typedef struct entry {
  char name[256];
  bool folder;
  int64_t bytes;
  double changed;
} entry;
typedef struct entries {
  bw_context *context;
  entry *list;
  size_t count, capacity;
} entries;

static bw_status keep_entry(void *data, const char *name, bool folder, int64_t bytes,
                            double changed) {
  entries *all = (entries *)data;
  if (!bw_grow(all->context, (void **)&all->list, &all->capacity, all->count, 1, sizeof(entry)))
    return BW_MEMORY;
  entry *one = &all->list[all->count++];
  size_t i = 0;
  for (; name[i] && i < sizeof one->name - 1; i++)
    one->name[i] = name[i];
  one->name[i] = 0;
  one->folder = folder;
  one->bytes = bytes;
  one->changed = changed;
  return BW_OK;
}

static int push_entries(lua_State *L) {
  const entries *all = (const entries *)lua_touserdata(L, 1);
  lua_createtable(L, (int)all->count, 0);
  for (size_t i = 0; i < all->count; i++) {
    const entry *one = &all->list[i];
    lua_createtable(L, 0, 4);
    lua_pushstring(L, one->name);
    lua_setfield(L, -2, "name");
    lua_pushboolean(L, one->folder);
    lua_setfield(L, -2, "folder");
    lua_pushinteger(L, one->bytes);
    lua_setfield(L, -2, "bytes");
    lua_pushnumber(L, one->changed);
    lua_setfield(L, -2, "changed");
    lua_rawseti(L, -2, (lua_Integer)i + 1);
  }
  return 1;
}

/* list_folder(path): {{name, folder, bytes, changed}, ...} in no order */
static int core_list_folder(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  entries all = {0};
  all.context = lbw_enter(L);
  bw_status status = bw_folder_visit(all.context, path, keep_entry, &all);
  int failure = LUA_OK;
  if (status == BW_OK) {
    lua_pushcfunction(L, push_entries);
    lua_pushlightuserdata(L, &all);
    failure = lua_pcall(L, 1, 1, 0);
  }
  bw_free(all.list);
  if (failure != LUA_OK)
    status = BW_MEMORY; /* the only thing that making tables can raise */
  return lbw_leave(L, status, 1);
}

/* lock(path, seconds): waits so long for whoever has it */
static int core_lock(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  double seconds = lbw_number_or(L, 2, 0);
  lbw_box *box = lbw_box_new(L, &lbw_lock_class);
  bw_lock *lock = NULL;
  bw_status status = bw_lock_take(lbw_enter(L), path, seconds, &lock);
  if (status == BW_OK)
    lbw_box_fill(L, box, lock);
  return lbw_leave(L, status, 1);
}

/* ---- temporary files ------------------------------------------------------------------------- */

static int push_temporary(lua_State *L, lbw_box *box, bw_status status, bw_temporary *temporary) {
  if (status == BW_OK)
    lbw_box_fill(L, box, temporary);
  return lbw_leave(L, status, 1);
}

/* temporary(target): an empty file beside it, removed with those whose names begin with its own
 * when it is closed */
static int core_temporary(lua_State *L) {
  const char *target = lbw_check_text(L, 1, NULL);
  lbw_box *box = lbw_box_new(L, &lbw_temporary_class);
  bw_temporary *temporary = NULL;
  bw_status status = bw_temporary_create(lbw_enter(L), target, true, &temporary);
  return push_temporary(L, box, status, temporary);
}

/* temporary_folder(): an empty folder, removed with what is in it when it is closed */
static int core_temporary_folder(lua_State *L) {
  lbw_box *box = lbw_box_new(L, &lbw_temporary_class);
  bw_temporary *temporary = NULL;
  bw_status status = bw_temporary_folder_create(lbw_enter(L), &temporary);
  return push_temporary(L, box, status, temporary);
}

static int temporary_path(lua_State *L) {
  const bw_temporary *temporary = (const bw_temporary *)lbw_check(L, 1, &lbw_temporary_class);
  lua_pushstring(L, bw_temporary_path(temporary));
  return 1;
}

static const luaL_Reg temporary_properties[] = {{"path", temporary_path}, {NULL, NULL}};
const lbw_class lbw_temporary_class = {"temporary file", nothing, temporary_properties, NULL, NULL};

/* sweep(folder): removes what killed processes left in it */
static int core_sweep(lua_State *L) {
  const char *folder = lbw_check_text(L, 1, NULL);
  bw_temporaries_sweep(folder);
  return 0;
}

/* process(): the number of this process */
static int core_process(lua_State *L) {
  lua_pushinteger(L, (lua_Integer)getpid());
  return 1;
}

/* processors(): how many can be used */
static int core_processors(lua_State *L) {
  long count = sysconf(_SC_NPROCESSORS_ONLN);
  lua_pushinteger(L, count > 0 ? (lua_Integer)count : 1);
  return 1;
}

void lbw_open_files(lua_State *L) {
  static const luaL_Reg functions[] = {{"sha256_of", core_sha256_of},
                                       {"make_folder", core_make_folder},
                                       {"list_folder", core_list_folder},
                                       {"touch", core_touch},
                                       {"lock", core_lock},
                                       {"temporary", core_temporary},
                                       {"temporary_folder", core_temporary_folder},
                                       {"sweep", core_sweep},
                                       {"process", core_process},
                                       {"processors", core_processors},
                                       {NULL, NULL}};
  luaL_setfuncs(L, functions, 0);
  lbw_class_register(L, &lbw_lock_class);
  lbw_class_register(L, &lbw_temporary_class);
}
