-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- 3MF: units, objects, transforms; archives that mean harm; prusa-slicer and assimp where they are installed.
local bw = require "barwright"

local function find(program)
  local pipe = assert(io.popen("command -v " .. program .. " 2>/dev/null"))
  local found = pipe:read "a"
  pipe:close()
  return found ~= ""
end

-- An archive of stored members, made by Python.
local function archive(path, model)
  local text = assert(io.open(path .. ".xml", "w"))
  text:write(model)
  text:close()
  local script = assert(io.open(path .. ".py", "w"))
  script:write(([[
import zipfile
rels = '<Relationships><Relationship Target="/3D/3dmodel.model" Type="x/3dmodel"/></Relationships>'
with zipfile.ZipFile(%q, "w", zipfile.ZIP_DEFLATED) as z:
    z.writestr("_rels/.rels", rels)
    z.writestr("3D/3dmodel.model", open(%q).read())
]]):format(path, path .. ".xml"))
  script:close()
  assert(os.execute("python3 " .. path .. ".py"))
end

local TETRAHEDRON = [[<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="10" y="0" z="0"/>
<vertex x="0" y="10" z="0"/><vertex x="0" y="0" z="10"/></vertices><triangles>
<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/>
<triangle v1="0" v2="3" v3="2"/></triangles></mesh>]]

local function model(objects, items, unit)
  return ('<model unit="%s"><resources>%s</resources><build>%s</build></model>'):format(unit or "millimeter",
    objects, items)
end

describe("3MF", function()
  local folder
  before_each(function()
    folder = os.tmpname()
    os.remove(folder)
    assert(os.execute("mkdir " .. folder))
  end)
  after_each(function() os.execute("rm -r " .. folder) end)

  it("comes back bit by bit in metres, and with the unit that the file names", function()
    local box = bw.surface.box {max = {0.03, 0.02, 0.017}}
    assert(box:write(folder .. "/a.3mf", {unit = "m"}))
    local back, info = assert(bw.surface.read(folder .. "/a.3mf"))
    assert.equal("3MF", info.format)
    assert.equal(1, info.metres_per_unit)
    assert.equal(box.point_count, back.point_count)
    for i = 1, box.point_count do
      for k = 1, 3 do assert.equal(box.points(i, k), back.points(i, k)) end
    end
    for _, unit in ipairs {"mm", "cm", "in", "ft", "um"} do
      assert(box:write(folder .. "/b.3mf", {unit = unit}))
      back = assert(bw.surface.read(folder .. "/b.3mf"))
      assert.near(box.volume, back.volume, 1e-12 * box.volume)
    end
  end)

  it("puts objects and components where transforms say, mirrored ones too", function()
    archive(folder .. "/c.3mf", model('<object id="1" name="tip">' .. TETRAHEDRON .. "</object>"
      .. '<object id="2"><components><component objectid="1"/>'
      .. '<component objectid="1" transform="-2 0 0 0 1 0 0 0 1 -5 0 0"/></components></object>',
      '<item objectid="2" transform="1 0 0 0 1 0 0 0 1 100 0 0"/>', "centimeter"))
    local body, info = assert(bw.surface.read(folder .. "/c.3mf"))
    assert.equal(2, info.groups)
    assert.same({"tip", "tip"}, info.group_names)
    assert.near(3 * 1e3 / 6 * 1e-6, body.volume, 1e-15)
    assert.near(0.75, body.box.min[1], 1e-12)
    assert.near(1.10, body.box.max[1], 1e-12)
  end)

  it("refuses what is damaged or means harm, in one sentence", function()
    local bomb = {'<object id="1">' .. TETRAHEDRON .. "</object>"}
    for i = 2, 30 do
      bomb[i] = ('<object id="%d"><components>%s</components></object>'):format(i,
        ('<component objectid="%d"/>'):format(i - 1):rep(10))
    end
    local cases = {
      {model('<object id="1"><components><component objectid="1"/></components></object>',
        '<item objectid="1"/>'), "component of itself"},
      {model("", '<item objectid="7"/>'), "object 7 is not in the file"},
      {model('<object id="1">' .. TETRAHEDRON:gsub('v1="0"', 'v1="4"') .. "</object>", '<item objectid="1"/>'),
        "from 0 to 3"},
      {model(table.concat(bomb), '<item objectid="30"/>'), "repeat meshes"},
      {model("", "", "furlong"), "furlong"},
      {("x"):rep(40000000), "unpacks from"},
    }
    for i, case in ipairs(cases) do
      archive(("%s/%d.3mf"):format(folder, i), case[1])
      local nothing, message = bw.surface.read(("%s/%d.3mf"):format(folder, i))
      assert.is_nil(nothing)
      assert.truthy(message:find(case[2], 1, true), message)
    end
  end)

  it("is read by assimp and written by prusa-slicer with the same volume", function()
    local ball = bw.surface.box {max = {0.03, 0.02, 0.017}}
    assert(ball:write(folder .. "/d.3mf"))
    if find "prusa-slicer" then
      local pipe = assert(io.popen("prusa-slicer --info " .. folder .. "/d.3mf 2>/dev/null"))
      local text = pipe:read "a"
      pipe:close()
      assert.near(ball.volume * 1e9, tonumber(text:match "volume = ([%d.]+)"), 1e-6 * ball.volume * 1e9)
      assert(ball:write(folder .. "/e.stl"))
      os.execute(("prusa-slicer --export-3mf -o %s/f.3mf %s/e.stl >/dev/null 2>&1"):format(folder, folder))
      local back, info = assert(bw.surface.read(folder .. "/f.3mf"))
      assert.equal(1e-3, info.metres_per_unit)
      assert.near(ball.volume, back.volume, 1e-6 * ball.volume)
      assert.near(ball.area, back.area, 1e-6 * ball.area)
    end
    if find "assimp" then
      local pipe = assert(io.popen("assimp info " .. folder .. "/d.3mf 2>/dev/null"))
      local text = pipe:read "a"
      pipe:close()
      assert.equal(tostring(ball.triangle_count), text:match "Faces:%s*(%d+)")
    end
  end)
end)
