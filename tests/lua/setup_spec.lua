-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- scripts/setup with and without Node, in a copy of the project whose CMake and Node only write down
-- that they were called.
local check = require "check"

local tools = "bash env dirname grep mkdir find nproc tail touch id cat rm"

-- Runs setup in a folder with these programs: exit status and what it printed.
local function set_up(folder, programs)
  local made = {("mkdir -p %s/bin %s/scripts %s/web"):format(folder, folder, folder),
    ("cp %s/scripts/setup %s/scripts/packages.txt %s/scripts/"):format(check.root, check.root, folder),
    ("cp %s/web/*.mjs %s/web/*.json %s/web/"):format(check.root, check.root, folder),
    ("for t in %s; do ln -sf \"$(command -v $t)\" %s/bin/; done"):format(tools, folder)}
  assert(os.execute(table.concat(made, " && ")))
  for name, text in pairs(programs) do
    check.write(folder .. "/bin/" .. name, "#!/bin/bash\n" .. text .. "\n")
    assert(os.execute(("chmod +x %s/bin/%s"):format(folder, name)))
  end
  local _, _, status = os.execute(("cd %s && PATH=%s/bin scripts/setup --no-install >out 2>&1"):format(folder,
    folder))
  return status, check.read(folder .. "/out")
end

local cmake = 'echo "$@" >>called'

local function exists(path)
  local file = io.open(path, "rb")
  if file then file:close() end
  return file ~= nil
end

describe("scripts/setup", function()
  it("builds everything but the pages' scripts where there is no Node", function()
    local folder = check.folder()
    local status, out = set_up(folder, {cmake = cmake})
    assert.equal(0, status, out)
    assert.truthy(out:find("no Node", 1, true), out)
    assert.truthy(out:find("there is no live view", 1, true), out)
    local called = check.read(folder .. "/called")
    assert.truthy(called:find("-S . -B build", 1, true), called)
    assert.truthy(called:find("--build build", 1, true), called)
    assert.is_false(exists(folder .. "/build/web/live.js"))
  end)

  it("shows how far the build is, and what a build that fails said", function()
    local folder = check.folder()
    local steps = 'echo "[1/2] Building a"; echo "warning: odd"; echo "[2/2] Linking b"'
    local status = set_up(folder, {cmake = steps})
    assert.equal(0, status)
    local kept = check.read(folder .. "/build/build.log")
    assert.equal("[1/2] Building a\nwarning: odd\n[2/2] Linking b\n", kept)
    local out
    status, out = set_up(folder, {cmake = steps
      .. '; [ "$1" != --build ] || { echo "no space left"; exit 1; }'})
    assert.equal(1, status)
    assert.truthy(out:find("no space left", 1, true), out)
    -- On a terminal, in one line that is removed at the end.
    if not os.execute "command -v script >/dev/null" then return end
    set_up(folder, {cmake = steps})
    local pipe = io.popen(("cd %s && terminal=$(command -v script) && "
      .. "PATH=%s/bin $terminal -qec 'scripts/setup --no-install' /dev/null </dev/null"):format(folder, folder))
    local shown = pipe:read "a"
    pipe:close()
    assert.truthy(shown:find("\r   [1/2] 0 s", 1, true) and shown:find("\r   [2/2] ", 1, true), shown)
    assert.truthy(shown:find("\r\27[K== built", 1, true), shown)
  end)

  it("bundles the pages where there is, and again only when they changed", function()
    local folder = check.folder()
    local programs = {cmake = cmake, node = "true", npm = "mkdir -p node_modules",
      npx = 'for last; do :; done; echo bundle >"${last#--outfile=}"; echo bundled >>../bundled'}
    local status, out = set_up(folder, programs)
    assert.equal(0, status, out)
    assert.is_true(exists(folder .. "/build/web/live.js"))
    assert.is_true(exists(folder .. "/build/web/plane.js"))
    assert.is_true(exists(folder .. "/build/web/workbench.js"))
    assert.is_true(exists(folder .. "/build/web/viewer.js"))
    local _, first = check.read(folder .. "/bundled"):gsub("\n", "")
    assert.equal(4, first)
    assert(os.execute(("cd %s && PATH=%s/bin scripts/setup --no-install >out 2>&1"):format(folder, folder)))
    local _, second = check.read(folder .. "/bundled"):gsub("\n", "")
    assert.equal(4, second)
  end)

  it("puts the licence of three.js into every script, and so into every report", function()
    if not exists(check.root .. "/build/web/viewer.js") then return pending "the pages are not bundled" end
    local folder = check.folder()
    assert(require("barwright.report").page(folder .. "/report.html", {title = "", answer = "", body = "",
      manifest = {}, data = {}}))
    for _, path in ipairs {check.root .. "/build/web/viewer.js", check.root .. "/build/web/live.js",
      check.root .. "/build/web/plane.js", check.root .. "/build/web/workbench.js", folder .. "/report.html"} do
      local text = check.read(path)
      for _, words in ipairs {"Copyright © 2010-2024 three.js authors", "SPDX-License-Identifier: MIT",
        "Permission is hereby granted, free of charge", "The above copyright notice and this permission notice"} do
        assert.message(path).truthy(text:find(words, 1, true))
      end
    end
  end)

  it("goes on where the packages of the pages cannot be had", function()
    local folder = check.folder()
    local status, out = set_up(folder, {cmake = cmake, node = "true", npm = "exit 1", npx = "exit 1"})
    assert.equal(0, status, out)
    assert.truthy(out:find("npm failed", 1, true), out)
    assert.truthy(check.read(folder .. "/called"):find("--build build", 1, true))
  end)
end)
