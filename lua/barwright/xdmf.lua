-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- XDMF version 3: fields of a surface at several times in one file of text.
local core = require "barwright.core"

local xdmf = {}

-- An array as a DataItem: rows of numbers, less `first`.
local function item(array, kind, format, first)
  local lines, rows = {}, array:totable()
  for i, row in ipairs(rows) do
    if type(row) ~= "table" then row = {row} end
    local words = {}
    for k, value in ipairs(row) do words[k] = format:format(value - first) end
    lines[i] = table.concat(words, " ")
  end
  local size = array.column_count == 1 and tostring(#rows) or ("%d %d"):format(#rows, array.column_count)
  return ('<DataItem DataType="%s" Dimensions="%s" Format="XML" Precision="%d">\n%s\n</DataItem>'):format(kind,
    size, kind == "Int" and 4 or 8, table.concat(lines, "\n"))
end

local SHARED = '<xi:include xpointer="xpointer(//Grid[@Name=&quot;surface&quot;]'
  .. '/*[self::Topology or self::Geometry])"/>'

--- Writes states {time =, fields = {name = array per point}} of a surface.
function xdmf.write(surface, states, path)
  local out = {'<?xml version="1.0"?>\n<Xdmf Version="3.0" xmlns:xi="http://www.w3.org/2001/XInclude">\n<Domain>\n'
    .. '<Grid Name="surface" GridType="Uniform">',
    ('<Topology TopologyType="Triangle" NumberOfElements="%d">'):format(surface.triangle_count),
    item(surface.triangles, "Int", "%d", 1), '</Topology>\n<Geometry GeometryType="XYZ">',
    item(surface.points, "Float", "%.17g", 0), "</Geometry>\n</Grid>",
    '<Grid Name="states" GridType="Collection" CollectionType="Temporal">'}
  for _, state in ipairs(states) do
    out[#out + 1] = ('<Grid Name="state" GridType="Uniform">\n%s\n<Time Value="%.17g"/>'):format(SHARED,
      state.time)
    local names = {}
    for name in pairs(state.fields) do names[#names + 1] = name end
    table.sort(names)
    for _, name in ipairs(names) do
      local array = state.fields[name]
      out[#out + 1] = ('<Attribute Name="%s" AttributeType="%s" Center="Node">\n%s\n</Attribute>'):format(name,
        array.column_count == 3 and "Vector" or "Scalar", item(array, "Float", "%.17g", 0))
    end
    out[#out + 1] = "</Grid>"
  end
  out[#out + 1] = "</Grid>\n</Domain>\n</Xdmf>\n"
  return core.write_file(path, table.concat(out, "\n"))
end

return xdmf
