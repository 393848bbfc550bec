-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A beam in two halves in CalculiX: tied, with a mass on a lever at its tip.
local bw = require "barwright"
local check = require "check"
local deck = require "deck"

--- The nodes of a face move with a point at `at`: equations with the nodes of its displacement and its rotation.
local function rigid_face(face, at, q, turn)
  local lines, places = {"*EQUATION"}, face.mesh.nodes:totable()
  for _, i in ipairs(face.nodes:totable()) do
    local r = {places[i][1] - at[1], places[i][2] - at[2], places[i][3] - at[3]}
    for c = 1, 3 do
      local d, e = c % 3 + 1, (c + 1) % 3 + 1 -- component c of turn x r is turn_d r_e - turn_e r_d
      local terms = {("%d,%d,1."):format(i, c), ("%d,%d,-1."):format(q, c)}
      for _, t in ipairs {{d, -r[e]}, {e, r[d]}} do
        if math.abs(t[2]) > 1e-12 then terms[#terms + 1] = ("%d,%d,%.12g"):format(turn, t[1], t[2]) end
      end
      lines[#lines + 1] = ("%d\n%s"):format(#terms, table.concat(terms, ","))
    end
  end
  return table.concat(lines, "\n")
end

-- What ccx prints for the remote point of a beam of cut_beam.lua with a mass on a lever: lists of displacements
-- and of rotations, each with the `time` or the frequency of its step.
return function(part, tip, at, mass, steps)
  local mesh, stem = part.mesh, os.tmpname()
  local n, middle = #mesh.nodes, mesh.boundary:above("x", 0.499):below("x", 0.501)
  local plain = bw.model {mesh = mesh, material = part.material}
  plain:fix(mesh.boundary:below("x", 0))
  assert(plain:write_inp(stem .. ".inp"))
  local model = check.read(stem .. ".inp"):match "^(.-)%*BOUNDARY"
  check.write(stem .. ".inp", table.concat({model .. deck.node_set("HELD", mesh.boundary:below("x", 0)),
    "*BOUNDARY\nHELD, 1, 3", deck.surface(mesh, middle:facing {1, 0, 0}, "SA"),
    deck.surface(mesh, middle:facing {-1, 0, 0}, "SB"),
    "*TIE, NAME=CUT, POSITION TOLERANCE=1e-6\nSA, SB",
    ("*NODE, NSET=POINT\n%d, %g, %g, %g\n*NODE, NSET=TURN\n%d, %g, %g, %g"):format(n + 1, at[1], at[2], at[3],
      n + 2, at[1], at[2], at[3]), rigid_face(tip, at, n + 1, n + 2),
    ("*ELEMENT, TYPE=MASS, ELSET=LUMP\n%d, %d\n*MASS, ELSET=LUMP\n%g"):format(#mesh.elements + 1, n + 1, mass),
    (steps:gsub("POINT_NODE", tostring(n + 1)):gsub("TURN_NODE", tostring(n + 2)))}, "\n"))
  os.execute(("cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1"):format(stem, stem))
  local numbers, time = {[n + 1] = {}, [n + 2] = {}}, nil
  for line in io.lines(stem .. ".dat") do
    time = tonumber(line:match "for set %u+ and time +(%S+)") or time
    local node, x, y, z = line:match "^%s+(%d+)%s+(%S+)%s+(%S+)%s+(%S+)%s*$"
    local own = node and numbers[tonumber(node)]
    if own then own[#own + 1] = {time = time, tonumber(x), tonumber(y), tonumber(z)} end
  end
  os.execute(("rm -f '%s' '%s'.*"):format(stem, stem))
  return numbers[n + 1], numbers[n + 2]
end
