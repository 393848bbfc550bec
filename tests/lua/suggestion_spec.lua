-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What an unknown name is answered with: what it resembles, or what there is.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"

local keys = {"pressure", "force", "modes", "regions", "elements", "temperature", "mm", "m", "von_mises"}

describe("A name that is not known", function()
  it("is answered with the one that it resembles", function()
    for word, meant in pairs {
      preasure = "pressure", presure = "pressure", pressuer = "pressure", -- more, less, swapped
      fource = "force", ["Force"] = "force", ["FORCES"] = "force", mods = "modes", rejoins = "regions",
      temp = "temperature", elementsize = "elements", -- a beginning
      MM = "mm", ["von-mises"] = "von_mises", vonmises = "von_mises",
    } do
      assert.equal(("did you mean '%s'?"):format(meant), core.suggestion(word, keys), word)
    end
    assert.equal("did you mean --force?", core.suggestion("--forse", {"--force", "--out"}))
    assert.equal("did you mean 'Größe'?", core.suggestion("Grösse", {"Länge", "Größe"}))
    assert.equal("did you mean 'ab'?", core.suggestion("aa", {"ac", "ab"})) -- ties go to the alphabet
  end)

  it("that resembles none is answered with what there is", function()
    for _, word in ipairs {"", "x", "te", "zebra", "colour", "pre", "fortune", "bananas", "--", "\xff\xfe\x80",
      ("a"):rep(1000)} do
      local reported = core.suggestion(word, {"steel", "pla", "abs"})
      assert.equal("known are abs, pla, steel", reported, word)
    end
    assert.equal("known is only pla", core.suggestion("steel", {"pla"}))
    assert.equal("there are none", core.suggestion("steel", {}))
    local many = {}
    for i = 1, 25 do many[i] = ("name%02d"):format(i) end
    assert.equal("none of the 25 known names resembles it", core.suggestion("steel", many))
    assert.equal("known are --force, --out", core.suggestion("--zzz", {"--out", "--force"}))
  end)

  it("is answered alike wherever names are read", function()
    local body = bw.mesh.box {max = {1, 1, 1}, cells = {2, 2, 2}}
    local part = bw.model {mesh = body, material = bw.material.pla}
    local skeleton = assert(bw.skeleton.create {joints = {{0, 0, 0}, {1, 0, 0}},
      bones = {{1, 2, name = "shank"}}})
    local outline = assert(bw.outline {name = "rim", {0, 0}, {1, 0}, {1, 1}, {0, 1}})
    check.raises("there is no material 'unobtainium': known are abs,", function()
      return bw.material.unobtainium
    end)
    check.raises("unknown option 'zzz': known are ", bw.model, {zzz = 1})
    check.raises("a model has no 'qqq': ", function() return part.qqq end)
    check.raises("a model has no 'boundary_of_all_things': none of the", function() -- too many to be listed
      return part.boundary_of_all_things
    end)
    check.raises("a skeleton has no 'boundary_of_all_things': known are ", function()
      return skeleton.boundary_of_all_things
    end)
    check.raises("none of the", function() return bw.zebra end)
    check.raises("bw.solver has no 'unknown': known are amg, bicgstab, cholesky, jacobi, lu, pcg, two_level",
      function() return bw.solver.unknown {} end)
    check.raises("bw.solver has no 'cholesy': did you mean 'cholesky'?", function()
      return bw.solver.cholesy {}
    end)
    check.raises("bw.eigensolver has no 'lanzcos': did you mean 'lanczos'?", function()
      return bw.eigensolver.lanzcos {}
    end)
    check.raises("bw.lp has no 'gplk': did you mean 'glpk'?", function() return bw.lp.gplk {} end)
    check.raises("bw.mesh has no 'bx': did you mean 'box'?", function() return bw.mesh.bx {} end)
    check.raises("bw.responsive has no 'stedy': did you mean 'steady'?", function()
      return bw.responsive.stedy
    end)
    assert.is_nil(bw.solver[1])
    check.raises("there is no bone 'q': known is only shank", function() skeleton:bone "q" end)
    check.raises("did you mean 'shank'?", function() skeleton:bone "shnak" end)
    check.raises("there is no loop 'hole 7': known is only outline", function() outline:loop "hole 7" end)
    check.raises("'xyz' is not known: known are ", function()
      bw.grid.box {size = {1, 1, 1}, cells = {1, 1, 1}}:nodes {side = "xyz"}
    end)
  end)

  it("is the first where several are wrong", function()
    local options = require "barwright.options"
    local wrong, rules = {}, {}
    for i = 10, 49 do
      wrong["zz" .. i], rules["zz" .. i] = "text", {type = "number", needed = true}
    end
    check.raises("unknown option 'zz10'", bw.model, wrong)
    check.raises("unknown option 'zz10'", options.read, "f", wrong, {})
    check.raises("option 'zz10': a number expected", options.read, "f", wrong, rules)
    check.raises("option 'zz10' is missing", options.read, "f", {}, rules)
    local heat = bw.heat {mesh = bw.mesh.box {cells = {1, 1, 1}}, material = bw.material.pla}
    check.raises("option 'tolerance'", heat.solve, heat, {tolerance = "a", max_iterations = "b", error = "c"})
  end)
end)
