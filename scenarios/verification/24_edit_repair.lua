-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What becomes of large turns that invert elements: inner nodes relaxed, blended subdomains refilled, or
-- the edit refused; and that what was made is a sound mesh of about the volume of the posed one.
local bw = require "barwright"
local bodies = require "bodies"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Edit sessions: repair",
  text = [[One bone of a body at rest, drawn at random, is turned about a random axis by an angle of the band (or
its negative). "As posed": no element was poorer than allowed. Quality is the mean ratio of the worst element of
the meshes made. The volume is that beside rest: bending by blending thins a joint, whatever the mesh; what
repair itself changes of it is in the rows above the table.]]}

local bands = {{10, 30}, {30, 50}, {50, 70}, {70, 90}, {90, 120}}

local function turns(t, each)
  local rows, random = {}, bodies.random(31)
  for _, body in ipairs {bodies.list[1], bodies.list[2]} do
    local session = bodies.session(body)
    local names, rest = session.skeleton.bone_names, session.mesh.volume
    local poorest, changed, solved, repaired, wrong = 1, 0, 0, 0, 0
    local at_rest = session.mesh.nodes
    for _, band in ipairs(bands) do
      local seen = {posed = 0, relaxed = 0, refilled = 0, refused = 0}
      local min, max, worst = math.huge, 0, 1
      for _ = 1, each do
        local name = names[math.random(#names)]
        local turn = {axis = bodies.random_axis(random),
          degrees = random(band[1], band[2]) * (random(-1, 1) < 0 and -1 or 1)}
        local ok, message, details = session:bone(name):rotate(turn)
        if not ok then
          if details.status ~= "geometry" then error(message) end
          seen.refused = seen.refused + 1
          if #session.edits > 0 or (session.mesh.nodes - at_rest):norm() > 0 then wrong = wrong + 1 end
        else
          local how, mesh = session.edits[1].mesh, session.mesh
          seen[how] = seen[how] + 1
          local quality, ratio = mesh:shapes():min(), mesh.volume / rest
          worst, min, max = math.min(worst, quality), math.min(min, ratio), math.max(max, ratio)
          if how ~= "posed" then
            repaired = repaired + 1
            if how == "relaxed" then -- the boundary stays where it was posed, and with it the volume
              local nodes = session.subdomains:posed_nodes(session.skeleton:pose_maps(session.current_pose))
              local facets = mesh.facets
              for column = 1, 3 do
                local on = facets:column(column)
                changed = math.max(changed, (mesh.nodes:gather(on) - nodes:gather(on)):norm())
              end
            end
            local result = session:solve()
            solved = solved + (result and 1 or 0)
            if result then result:close() end
          end
          assert(session:undo())
        end
      end
      poorest = math.min(poorest, worst)
      rows[#rows + 1] = {body.name, ("%d to %d"):format(band[1], band[2]), seen.posed,
        seen.relaxed, seen.refilled, seen.refused, ("%.3f"):format(worst),
        ("%.3f to %.3f"):format(min, max)}
    end
    expect(poorest, body.name .. ": poorest element of any mesh made")
      :above(1e-4, {how = "mean ratio; positive: not inverted"})
    expect(repaired - solved, body.name .. ": repaired meshes that do not solve")
      :below(0, {how = ("%d repaired"):format(repaired)})
    expect(changed, body.name .. ": moves of boundary nodes by relaxing", "m")
      :below(1e-15, {how = "none is moved"})
    expect(wrong, body.name .. ": sessions changed by a refused edit"):below(0, {how = "nodes and list of edits"})
    session:close()
  end
  t:table {heads = {"body", "degrees", "as posed", "relaxed", "refilled", "refused", "worst quality",
    "volume of rest"}, rows = rows}
end

scenario("Repair of 200 turns", {tags = {"slow"}}, function(t) turns(t, 20) end)

scenario("Repair of 1,000 turns", {tags = {"slow", "long"}, seconds = 3600}, function(t) turns(t, 100) end)
