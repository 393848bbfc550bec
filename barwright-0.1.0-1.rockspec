rockspec_format = "3.0"
package = "barwright"
version = "0.1.0-1"
source = {
   url = "git+file://.",
   tag = "v0.1.0",
}
description = {
   summary = "A structural-design engine",
   detailed = [[
Where does a shape break, whatever happens to it? Surfaces, tetrahedra, linear
elasticity, modes and worst-case loads in C, driven from Lua. Needs the C and C++
libraries listed in scripts/packages.txt.
]],
   license = "AGPL-3.0-or-later",
}
dependencies = {
   "lua ~> 5.4",
}
build = {
   type = "cmake",
   variables = {
      CMAKE_BUILD_TYPE = "Release",
      CMAKE_INSTALL_PREFIX = "$(PREFIX)",
      BARWRIGHT_TESTS = "OFF",
      BARWRIGHT_WERROR = "OFF",
      BARWRIGHT_ROCK = "ON",
      BARWRIGHT_LUA_DIR = "$(LUADIR)",
      BARWRIGHT_LUA_LIBDIR = "$(LIBDIR)",
   },
}
