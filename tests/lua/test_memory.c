/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Lua itself running out of memory, at every allocation in turn: the error comes out of lua_pcall,
 * the state can be closed, and no block of the engine is left. */
#include "check.h"

#include <lauxlib.h>
#include <lualib.h>
#include <unistd.h>

#include "bind.h"

typedef struct budget {
  long left; /* allocations until they fail, all from there on */
  bool failed;
} budget;

static void *allocate(void *data, void *block, size_t old_size, size_t size) {
  budget *b = (budget *)data;
  (void)old_size;
  if (size == 0) {
    free(block);
    return NULL;
  }
  if (!block || size > old_size) { /* shrinking never fails: Lua relies on it */
    if (b->left <= 0) {
      b->failed = true;
      return NULL;
    }
    b->left--;
  }
  return realloc(block, size);
}

static const char script[] =
    "local bw = ...\n"
    "local mesh = assert(bw.mesh.box{min = {0, 0, 0}, max = {1, 1, 1}, cells = {2, 2, 2}})\n"
    "local all = mesh.boundary\n"
    "local part = assert(bw.model{mesh = mesh, material = bw.material.named 'steel'})\n"
    "part:fix(all:below(1, 0) | all:where 'x < 0.1')\n"
    "part:load{on = all:above(1, 1), force = {1, 0, 0}}\n"
    "local static = assert(part:solve())\n"
    "local a = static.von_mises:map('a*2 + b', {b = 1}):gather(all.nodes):sorted()\n"
    "local surface = assert(mesh:surface())\n"
    "assert(surface:check().sound)\n"
    "local text = tostring(part) .. tostring(surface) .. tostring(a) .. #a:tostring '<f8'\n"
    "part:clear_supports()\n"
    "assert(#part:rigid_modes() == 6)\n"
    "local modes = assert(part:modes{count = 2})\n"
    "local weak = assert(bw.weak_regions(mesh, part.material, modes, {regions = 1}))\n"
    "local basis = assert(bw.pressure_basis(mesh))\n"
    "local loads = assert(bw.worst_loads(part:system(), basis, weak, {force = 1, pressure = 10}))\n"
    "assert(#basis:arrows(loads.pressures[1]) > 0)\n"
    "assert(bw.drops(part:system(), {drops = 2}))\n"
    "local ball = bw.surface.implicit(function(x, y, z) return x*x + y*y + z*z - 0.5 end,\n"
    "  {min = {-1, -1, -1}, max = {1, 1, 1}, cells = 3})\n"
    "bw.surface.read 'no such file'\n"
    "local grid = assert(bw.grid.voxels(ball, {cells = 4, material = '1 + (x > 0)'}))\n"
    "grid = assert(grid:set({side = 'min x'}, 0)):set(function(x) return x > 0.2 end, 3)\n"
    "assert(grid:coarse():nodes{side = 'max x', where = 'y > 0'})\n"
    "assert(grid:embed(ball, {reach = 9}):moved(grid.points))\n"
    "local canvas = assert(bw.canvas(60, 40, {name = 'x'}))\n"
    "canvas:markers('disc', 5, {{1, 2}, {3, 4}}, {fill = '#ff0000'}, {'a', false}):text('b', 5, "
    "5)\n"
    "canvas:line({1, 2, 3, 4}, {stroke = '#000000', dash = {2, 2}}):text_width('b', 9)\n"
    "assert(#canvas:svg{outlines = true} > 100)\n"
    "local file <close> = assert(bw.database(os.getenv 'MEMORY_FILE'))\n"
    "assert(file:execute 'CREATE TABLE IF NOT EXISTS t (a, b); DELETE FROM t')\n"
    "assert(file:change('INSERT INTO t VALUES (?, ?)', 'one', 2.5) == 1)\n"
    "assert(file:rows('SELECT * FROM t WHERE b > ?', 1)[1].a == 'one')\n"
    "assert(#bw.sobol(8, 3, {seed = 1}) == 8)\n"
    "assert(bw.minimise{start = {1}, objective = function(x) return x[1]^2 end,\n"
    "  constraints = {function(x) return -x[1] end}, evaluations = 9})\n"
    "local job <close> = assert(bw.job(function() return 'done' end, {name = 'j'}))\n"
    "assert(bw.wait{job} == 1)\n"
    "assert(job:result())\n"
    "return #a:totable()\n";

static int work(lua_State *L) {
  luaL_openlibs(L);
  luaL_requiref(L, "barwright.core", luaopen_barwright_core, 0);
  if (luaL_loadstring(L, script) != LUA_OK)
    return lua_error(L);
  lua_insert(L, -2);
  lua_call(L, 1, 1);
  return 1;
}

/* True when the budget was enough. */
static bool attempt(long allocations) {
  int64_t blocks = bw_live_blocks();
  budget b = {allocations, false};
  lua_State *L = lua_newstate(allocate, &b);
  bool fine = false;
  if (L) {
    /* A collection in the midst of work that finds no memory to call a finaliser loses the object:
     * Lua's own limit. Closing calls them all. */
    lua_gc(L, LUA_GCSTOP);
    lua_pushcfunction(L, work);
    int status = lua_pcall(L, 0, 1, 0);
    fine = status == LUA_OK;
    if (!fine && !b.failed)
      fail_msg("%s", lua_tostring(L, -1));
    lua_close(L);
  }
  if (bw_live_blocks() != blocks)
    fail_msg("allocation %ld: %lld blocks left", allocations,
             (long long)(bw_live_blocks() - blocks));
  return fine;
}

static void test_every_allocation_may_fail(void **state) {
  (void)state;
  char folder[] = "/tmp/barwright_memory_XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/file", folder);
  setenv("MEMORY_FILE", path, 1);
  assert_true(attempt(1L << 40));
  long n = 0;
  while (!attempt(n))
    n++;
  assert_true(n > 1000);
  unlink(path);
  rmdir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_allocation_may_fail)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
