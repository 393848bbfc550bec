-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
local bw = require "barwright"
local check = require "check"

local function halves()
  local mesh = assert(bw.mesh.box {max = {2, 1, 1}, cells = {4, 2, 2}, order = 2})
  local tags = {}
  for e, corners in ipairs(mesh.elements:totable()) do
    local x = 0
    for a = 1, 4 do x = x + mesh.nodes:rows(corners[a], corners[a]):totable()[1][1] / 4 end
    tags[e] = x < 0.5 and 9 or -2
  end
  return mesh, tags
end

describe("regions of a mesh", function()
  it("are listed, found by name and selected", function()
    local plain, tags = halves()
    local mesh = assert(plain:with_regions(tags, {[9] = "insert"}))
    assert.equal(2, #mesh.regions)
    assert.equal(0, #plain.regions)
    assert.is_nil(plain.element_regions)
    assert.equal("region -2", mesh.regions[1].name)
    assert.equal("insert", mesh.regions[2].name)
    assert.equal(9, mesh:region("insert").tag)
    check.near(0.5, mesh:region("insert").volume, 1e-12)
    check.near(1.5, mesh:region("region -2").volume, 1e-12)
    assert.equal(mesh.element_count, mesh.regions[1].elements.row_count + mesh.regions[2].elements.row_count)
    for i = 1, mesh:region("insert").elements.row_count do
      local e = mesh:region("insert").elements[i]
      assert.equal(9, tags[e])
      assert.equal(2, mesh.element_regions[e])
    end
    check.near(1 + 4 * 0.5, mesh.boundary:region("insert").area, 1e-12)
    check.near(1, mesh.boundary:region("insert"):below("x", 0).area, 1e-12)
    assert.truthy(tostring(mesh):find("regions 'region -2', 'insert'", 1, true))
    local other = assert(bw.mesh.new {nodes = plain.nodes, elements = plain.elements, order = 2, regions = tags,
      region_names = {[9] = "insert"}})
    assert.equal(tostring(mesh), tostring(other))
    assert.equal(0, #assert(mesh:with_regions()).regions)
    assert.equal("insert", assert(assert(mesh:with_order(1)):renumbered()).regions[2].name)
  end)

  it("refuse wrong names and tags", function()
    local plain, tags = halves()
    local mesh = assert(plain:with_regions(tags, {[9] = "insert"}))
    check.raises("did you mean 'insert'", mesh.region, mesh, "insret")
    check.raises("the mesh has no regions", plain.region, plain, "insert")
    check.raises("did you mean 'insert'", mesh.boundary.region, mesh.boundary, "Insert")
    check.raises("two regions are called 'a'", plain.with_regions, plain, tags, {[9] = "a", [-2] = "a"})
    check.raises("a tag, a whole number of 32 bits", plain.with_regions, plain, tags, {[2 ^ 31 | 0] = "a"})
    check.raises("a name of at most 47 bytes", plain.with_regions, plain, tags, {[9] = ("n"):rep(48)})
    check.raises("rows", plain.with_regions, plain, {1, 2})
    check.raises("whole number", plain.with_regions, plain, bw.array.zeros(plain.element_count, 1) + 0.5)
  end)

  it("are named by print(model) with their material", function()
    local mesh = bw.mesh.box {max = {1, 1, 1}, cells = {3, 1, 1}}
    mesh = assert(mesh:split({max = {0.4, 1, 1}}, "left"))
    mesh = assert(mesh:split({min = {0.6, 0, 0}, max = {1, 1, 1}}, "right"))
    local steel = bw.material.steel
    local text = tostring(bw.model {mesh = mesh,
      materials = {left = steel, rest = bw.material.pla, right = steel}})
    assert.truthy(text:find("\nmaterial of 'left', 'right': steel, ", 1, true), text)
    assert.truthy(text:find("\nmaterial of 'rest': pla, ", 1, true), text)
  end)

  it("are split off by a function, a formula, a box and a surface", function()
    local mesh = halves()
    local ways = {function(x) return x < 0.5 end, "x < 0.5", {max = {0.5, 1, 1}},
      bw.surface.box {min = {-1, -1, -1}, max = {0.5, 2, 2}}}
    for _, where in ipairs(ways) do
      local split, log = assert(mesh:split(where, "left"))
      check.near(0.5, split:region("left").volume, 1e-12)
      check.near(0.5, log.volume, 1e-12)
      assert.equal(0, log.misplaced)
      assert.matches("^region 'left' of .* m3; 0 cm3 is on the other side .*, 0 elements cut$", tostring(log))
      assert.matches("^region 'left' %(tag %d%) of %d+ elements, .* m3$", tostring(split:region "left"))
      assert.matches("^interface of 'left' and 'rest': %d+ facets, .* [cm]*m2$",
        tostring(split:interface("left", "rest")))
      local face, back = split:interface("left", "rest"), split:interface("rest", "left")
      check.near(1, face.area, 1e-12)
      assert.equal(face.area, back.area)
      assert.equal(6, face.facets.column_count)
      assert.equal(split.element_regions[face.elements:rows(1, 1):totable()[1][1]], 2)
    end
    check.raises("a function of x, y, z, a formula, a box", mesh.split, mesh, 7, "left")
    check.raises("already a region", mesh.split, assert(mesh:split("x < 0.5", "left")), "x > 1", "left")
    check.raises("would be empty", mesh.split, mesh, "x < -5", "left")
    check.raises("stop here", mesh.split, mesh, function() error "stop here" end, "left")
    check.raises("did you mean 'left'", mesh.interface, assert(mesh:split("x < 0.5", "left")), "lift", "rest")
  end)

  it("come from several surfaces", function()
    local strip = {brass = bw.surface.box {max = {10, 1, 0.5}},
      steel = bw.surface.box {min = {0, 0, 0.5}, max = {10, 1, 1}}}
    local mesh = assert(bw.mesh.fill_parts(strip, {max_volume = 0.1, order = 2}))
    check.near(10, mesh:interface("brass", "steel").area, 1e-12)
    check.near(5, mesh:region("steel").volume, 1e-12)
    assert.equal(1, mesh:region("brass").tag)
    assert.truthy(mesh.element_count > 100)
    local fine = assert(bw.mesh.fill_parts(strip, {size = "0.2 + 0.05 * x"}))
    assert.truthy(fine.element_count > 2000)
    check.fails("geometry", "'a' and 'b' overlap", bw.mesh.fill_parts {a = strip.brass,
      b = bw.surface.box {min = {1, 0.25, 0.25}, max = {2, 0.5, 0.75}}})
    check.raises("part 'a': a surface expected", bw.mesh.fill_parts, {a = 1})
    check.raises("at least one part", bw.mesh.fill_parts, {})
    check.raises("edge_length", bw.mesh.fill_parts, strip, {edge_lenght = 1})
  end)

  it("keep their names in VTU files and pieces", function()
    local mesh = assert(bw.mesh.box {max = {2, 1, 1}, cells = {4, 2, 2}}:split("x < 1", 'left <&> "\u{e4}"'))
    for _, ending in ipairs {".vtu", ".pvtu"} do
      local path = os.tmpname()
      os.remove(path)
      assert(mesh:write(path .. ending))
      local back = assert(bw.mesh.read(path .. ending))
      assert.equal(2, #back.regions)
      for i = 1, 2 do
        assert.equal(mesh.regions[i].name, back.regions[i].name)
        assert.equal(mesh.regions[i].tag, back.regions[i].tag)
        check.near(1, back.regions[i].volume, 1e-12)
      end
      os.remove(path .. ending)
      os.remove(path .. "_0.vtu")
    end
  end)

  it("of sections of an INP file count as the later one says, also of a repeated set", function()
    local path = os.tmpname()
    os.remove(path)
    path = path .. ".inp"
    local file = assert(io.open(path, "w"))
    file:write [[
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
5, 1, 1, 1
*ELEMENT, TYPE=C3D4
1, 1, 2, 3, 4
2, 2, 5, 3, 4
*ELSET, ELSET=A
1
*ELSET, ELSET=B
1, 2
*SOLID SECTION, ELSET=A, MATERIAL=M
*SOLID SECTION, ELSET=B, MATERIAL=N
*SOLID SECTION, ELSET=A, MATERIAL=M
]]
    file:close()
    local mesh = assert(bw.mesh.read(path))
    os.remove(path)
    assert.equal(2, #mesh.regions)
    for _, region in ipairs(mesh.regions) do
      assert.equal(region.name == "A" and 1 or 2, region.elements[1])
    end
  end)

  local function base64(bytes)
    local digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
    return (bytes:gsub("..?.?", function(part)
      local a, b, c = part:byte(1, 3)
      local bits, out = a << 16 | (b or 0) << 8 | (c or 0), {}
      for k = 1, 4 do
        local digit = bits >> 24 - 6 * k & 63
        out[k] = k > #part + 1 and "=" or digits:sub(digit + 1, digit + 1)
      end
      return table.concat(out)
    end))
  end

  --- A zlib stream of one stored block.
  local function stored(bytes)
    local a, b = 1, 0
    for k = 1, #bytes do
      a = (a + bytes:byte(k)) % 65521
      b = (b + a) % 65521
    end
    return "\x78\x01\x01" .. ("<I2I2"):pack(#bytes, ~#bytes & 0xffff) .. bytes .. (">I4"):pack(b << 16 | a)
  end

  local function read_vtu(attributes, format, tags, names)
    local path = os.tmpname()
    os.remove(path)
    path = path .. ".vtu"
    local file = assert(io.open(path, "wb"))
    file:write(([[<VTKFile type="UnstructuredGrid" byte_order="LittleEndian" %s><UnstructuredGrid><FieldData>
<DataArray type="String" Name="region_names" NumberOfTuples="1" format="%s">%s</DataArray>
<DataArray type="Int32" Name="region_tags" NumberOfTuples="1" format="%s">%s</DataArray>
</FieldData><Piece NumberOfPoints="4" NumberOfCells="1">
<Points>
<DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">10</DataArray></Cells>
<CellData><DataArray type="Int32" Name="region" format="ascii">7</DataArray></CellData>
</Piece></UnstructuredGrid></VTKFile>
]]):format(attributes, format, names, format, tags))
    file:close()
    local mesh, message = bw.mesh.read(path)
    os.remove(path)
    return mesh, message
  end

  it("have names in VTU files that others wrote", function()
    local packed = 'header_type="UInt32" compressor="vtkZLibDataCompressor"'
    local tags, names = ("<i4"):pack(7), "bone\0"
    local function block(bytes)
      return base64(("<I4I4I4I4"):pack(1, 1000, #bytes, #stored(bytes))) .. base64(stored(bytes))
    end
    local ways = {{"", "ascii", "7", "98 111 110 101 0"},
      {"", "binary", base64(("<s4"):pack(tags)), base64(("<s4"):pack(names))},
      {packed, "binary", block(tags), block(names)}}
    for _, way in ipairs(ways) do
      assert.equal("bone", assert(read_vtu(table.unpack(way))).regions[1].name)
    end
    local mesh, message = read_vtu("", "ascii", "7 8", "98 0")
    assert.is_nil(mesh)
    assert.matches("1 names for the 2 tags of regions", message)
    for _, byte in ipairs {"300", "-5"} do
      mesh, message = read_vtu("", "ascii", "7", byte .. " 0")
      assert.is_nil(mesh)
      assert.matches(byte .. " in the names of regions, where bytes", message, 1, true)
    end
    local damaged = base64(("<I4I4I4I4"):pack(1 << 31, 1 << 31, 1, 9))
    mesh, message = read_vtu(packed, "binary", block(tags), damaged)
    assert.is_nil(mesh)
    assert.matches("region_names", message)
  end)

  it("have their names, blanks and quotes too, in files of formats without names", function()
    local box = bw.mesh.box {max = {1, 1, 1}, cells = {3, 1, 1}}
    local tags, names = {}, {" left ", '"quoted"', "steel insert"}
    for e = 1, box.element_count do tags[e] = (e - 1) * 3 // box.element_count + 1 end
    local mesh, stem = assert(box:with_regions(tags, names)), os.tmpname()
    for _, ending in ipairs {".mesh", ".ele", ".vtu"} do
      assert(mesh:write(stem .. ending))
      local read = assert(bw.mesh.read(stem .. ending))
      for i, name in ipairs(names) do assert.equal(name, read.regions[i].name) end
      os.remove(stem .. ending)
    end
    os.remove(stem .. ".node")
    os.remove(stem)
  end)
end)
