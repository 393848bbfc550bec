-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Wrong invocations of the commands that judge a part: one sentence each, and the right exit status.
local bw = require "barwright"
local check = require "check"

local folder = check.folder()

local function write(name, text) check.write(folder .. "/" .. name, text) end

-- Files of every kind in the folder where the commands run.
local function make_files()
  assert(bw.surface.box {max = {0.1, 0.01, 0.01}}:write(folder .. "/part.stl"))
  assert(bw.mesh.box({max = {0.1, 0.01, 0.01}, cells = {5, 1, 1}, order = 2}):write(folder .. "/bar.msh"))
  for _, name in ipairs {"empty.stl", "empty.msh", "empty.csv"} do write(name, "") end
  local bytes = {}
  for i = 1, 1000 do bytes[i] = string.char(i * i * 7 % 256) end
  for _, name in ipairs {"junk.stl", "junk.msh", "junk.csv"} do write(name, table.concat(bytes)) end
  write("text.stl", "hello\n")
  write("cut.stl", "solid a\n")
  write("facet.stl", "solid f\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 10 0 0\nvertex 0 10 0\n"
    .. "endloop\nendfacet\nendsolid f\n")
  write("plate.svg", '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="20mm" viewBox="0 0 40 20">'
    .. '<path d="M0 0H40V20H0Z"/></svg>')
  write("ok.csv", "10 5\n100 20\n4000 3\n")
  write("comma.csv", "10;5,5\n")
  write("curve.png", "10 5\n100 20\n")
  assert(os.execute("mkdir '" .. folder .. "/folder.stl'"))
end

-- The exit status and standard error of a command in the folder.
local function run(words, where)
  local pipe = assert(io.popen(("cd '%s' && '%s' 2>&1 >%s %s </dev/null; echo $?"):format(folder,
    check.program, where or "/dev/null", words)))
  local text = pipe:read "a"
  pipe:close()
  local err, status = text:match "^(.-)(%d+)\n$"
  return tonumber(status), err
end

local FIXED, PUSHED, SHAKEN = " --fix min:x ", " --fix min:x --force max:x=0,0,1 ", " --fix min:x --damping 0.02 "

-- Words, the exit status and what the sentence has.
local wrong = {
  {"buckle", 2, "MODEL is missing"},
  {"buckle nofile.stl" .. PUSHED, 3, "nofile.stl: cannot be read: No such file"},
  {"buckle folder.stl" .. PUSHED, 3, "folder.stl: cannot be read: it is a directory"},
  {"buckle empty.stl" .. PUSHED, 3, "empty.stl: byte 0: the file is empty"},
  {"buckle junk.stl" .. PUSHED, 3, "junk.stl: byte 80: the header of this binary STL file claims"},
  {"buckle plate.svg" .. PUSHED, 2, "plate.svg: a drawing is flat"},
  {"buckle facet.stl" .. PUSHED, 3, "a surface of 1 facet in a box"},
  {"buckle part.stl" .. FIXED, 2, "--force, --pressure or --gravity is missing"},
  {"buckle part.stl" .. PUSHED .. "--worst 10", 2, "--worst finds the load: leave out --force"},
  {"buckle part.stl" .. PUSHED .. "--forbid max:x", 2, "--forbid is for the search of --worst"},
  {"buckle part.stl" .. PUSHED .. "--count 0", 2, "--count: a whole number from 1 up to 500 expected"},
  {"buckle part.stl" .. PUSHED .. "--sign up", 2, "--sign: one of positive, negative, either expected"},
  {"buckle bar.msh --unit m --fix min:x --force max:x=0,0,0", 2, "nothing can buckle. Add a load"},
  {"statics text.stl" .. PUSHED, 3, "text.stl:1: found 'hello' where 'solid'"},
  {"statics cut.stl" .. PUSHED, 3, "cut.stl: the STL ASCII file holds no facet"},
  {"statics empty.msh" .. PUSHED, 3, "empty.msh: byte 0: the file is empty"},
  {"statics junk.msh" .. PUSHED, 3, "is of no format that is read here"},
  {"statics part.stl" .. FIXED .. "--gravity 0,0", 2, "--gravity: three numbers such as 0,0,-10 expected"},
  {"statics part.stl" .. FIXED .. "--gravity 0,0,nan", 2, "--gravity: a number of m/s2 expected, got 'nan'"},
  {"statics part.stl" .. FIXED .. "--pressure max:x=", 2, "--pressure: a number of Pa expected"},
  {"statics part.stl --gravity 0,0,1g --fix near:0,0,0", 2, "near:X,Y,Z:RADIUS expected, got 'near:0,0,0'"},
  {"statics part.stl --gravity 0,0,1g --fix below:x", 2, "below:AXIS:COORDINATE expected, got 'below:x'"},
  {"statics part.stl --gravity 0,0,1g --fix min:x:1mm", 2, "min:AXIS expected, got 'min:x:1mm'"},
  {"statics part.stl --gravity 0,0,1g --fix all:x", 2, "all expected, got 'all:x'"},
  {"statics part.stl --gravity 0,0,1g --fix ''", 2, "--fix: a value expected, got an empty one"},
  {"statics part.stl" .. PUSHED .. "--report x.pdf", 2, "a file that ends in .html, .htm expected"},
  {"statics part.stl" .. PUSHED .. "--picture no/such/x.png", 3, "no/such/x.png: cannot write"},
  {"statics part.stl part.stl" .. PUSHED, 2, "'part.stl' is one argument too many"},
  {"statics bar.msh --unit m" .. PUSHED .. "--vtu ./bar.msh", 2, "./bar.msh is the MODEL: give another file"},
  {"statics bar.msh --unit m --fix all --force max:x=1,0,0", 2, "no load reaches the body"},
  {"statics bar.msh --unit m" .. FIXED .. "--force min:x=0,0,1", 2, "the load at min:x lies on a support"},
  {"statics bar.msh --unit m" .. FIXED .. "--force max:x=0,0,0", 2, "every load is 0, so that nothing is tried"},
  {"statics bar.msh --unit m" .. FIXED .. "--gravity 0,0,0", 2, "every load is 0, so that nothing is tried"},
  {"statics part.stl" .. PUSHED .. "--material young=2GPa", 2, "young= and poisson= are needed"},
  {"statics part.stl" .. PUSHED .. "--material young=2GPa,poisson=0.7", 2, "poisson: a number from 0 up to 0.499"},
  {"statics part.stl" .. PUSHED .. "--material young=2GPa,poisson=0.3,colour=3", 2, "got 'colour=3'"},
  {"statics part.stl" .. PUSHED .. "--material young=2m,poisson=0.3", 2, "young: a number with one of the units"},
  {"statics bar.msh" .. PUSHED .. "--material lid=young=2GPa,poisson=0.3", 2, "bar.msh has no regions"},
  {"modes", 2, "MODEL is missing"},
  {"modes nofile.stl", 3, "nofile.stl: cannot be read"},
  {"modes part.stl --fix top", 2, "--fix: "},
  {"modes part.stl --count 1.5", 2, "--count: a whole number"},
  {"modes part.stl --solver qr", 2, "--solver: one of auto, lanczos, arpack, lobpcg, slepc expected"},
  {"modes part.stl --vtu x.stl", 2, "--vtu: a file that ends in"},
  {"modes part.stl --material adamant", 2, "'adamant' is not known"},
  {"check", 2, "MODEL is missing"},
  {"check nofile.stl", 3, "nofile.stl: cannot be read"},
  {"check part.stl --unit furlong", 2, "'furlong' is not known"},
  {"check part.stl --thin 3", 2, "'3' has no unit"},
  {"check part.stl --report ./part.stl", 2, "--report: a file that ends in .html, .htm expected"},
  {"check part.stl --material adamant", 2, "'adamant' is not known"},
  {"check plate.svg --material pla", 2, "which is flat and has no mass"},
  {"check part.stl --edges maybe", 2, "--edges: one of yes, no expected"},
  {"heat part.stl", 2, "--"},
  {"heat part.stl --temperature min:x=80C --convection all", 2, "--convection: "},
  {"convert part.stl", 2, "is missing"},
  {"convert nofile.stl out.obj", 3, "nofile.stl: cannot be read"},
  {"convert part.stl out.doc", 2, "out.doc"},
  {"convert part.stl part.igs", 2, "IGES files are read, and not written"},
  {"convert part.stl /dev/full", 2, "/dev/full: the name has no ending, which says the format"},
  {"check /dev/null", 3, "/dev/null: cannot be read: it is not a regular file"},
  {"statics /dev/null" .. PUSHED, 3, "/dev/null: cannot be read: it is not a regular file"},
  {"nofile.lua", 3, "cannot open nofile.lua: No such file"},
  {"./folder.stl/", 3, "cannot read ./folder.stl/: Is a directory"},
  {"junk.csv", 1, "junk.csv:1: "},
  {"part.3mf", 2, "part.3mf is no script: `barwright check part.3mf` describes it"},
  {"part.step", 2, "part.step is no script"},
  {"part.glb", 2, "part.glb is no script"},
  {"strengthen part.stl --keep hole --force 5 --out o.stl", 2, "--keep: holes or a place: 'hole' is no place"},
  {"open nofile.stl --no-open", 3, "nofile.stl: No such file"},
  {"open folder.stl --no-open", 3, "folder.stl: Is a directory"},
  {"live folder.stl --no-open", 2, "folder.stl is no script"},
  {"live junk.csv --no-open", 3, "junk.csv:1: "},
  {"live empty.csv --no-open", 2, "the file must return a session"},
  {"study run junk.csv --out o", 3, "junk.csv:1: "},
  {"study run empty.csv --out o", 2, "empty.csv returned nothing"},
  {"rerun junk.csv", 3, "junk.csv: line 1, byte 1: a value expected"},
  {"materials unobtainium", 2, "unobtainium"},
  {"live", 2, "is missing"},
  {"live nofile.lua", 3, "nofile.lua"},
  {"study", 2, "is missing"},
  {"study run nofile.lua --out o", 3, "nofile.lua"},
  {"rerun", 2, "is missing"},
  {"rerun nofile.json", 3, "nofile.json"},
  {"test", 2, "is missing"},
  {"completion tcsh", 2, "one of bash, zsh, fish expected"},
  {"manual now", 2, "no argument expected"},
  {"help wrost", 2, "wrost"},
  {"worst part.stl --strenght 3MPa", 2, "unknown option --strenght: did you mean --strength"},
  {"worst part.stl --force=20N --force=30N", 2, "option --force is given twice"},
  {"worst part.stl --json=yes", 2, "option --json takes no value"},
  {"respond part.stl" .. SHAKEN .. "--base 0,0,1g", 2, "--to FREQUENCY is missing"},
  {"respond part.stl" .. SHAKEN .. "--base 0,0,1g --to 100 --from 200", 2, "below the 100 Hz of --to expected"},
  {"respond bar.msh --unit m" .. SHAKEN .. "--base 0,0,0 --to 100", 2, "nothing excites the body"},
  {"respond part.stl" .. SHAKEN .. "--spectrum ok.csv", 2, "--direction: one to three directions expected, got 0"},
  {"respond part.stl" .. SHAKEN .. "--spectrum no.csv --direction 0,0,1", 3, "no.csv: No such file"},
  {"respond part.stl" .. SHAKEN .. "--spectrum folder.stl --direction 0,0,1", 3, "folder.stl: Is a directory"},
  {"respond part.stl" .. SHAKEN .. "--spectrum empty.csv --direction 0,0,1", 3, "no row with a frequency"},
  {"respond part.stl" .. SHAKEN .. "--spectrum junk.csv --direction 0,0,1", 3, "junk.csv: no text file"},
  {"respond part.stl" .. SHAKEN .. "--spectrum comma.csv --direction 0,0,1", 3, "with decimal points, expected"},
  {"respond part.stl --fix min:x --base 0,0,1g --to 9 --damping 2%", 2, "a number without a unit above 0"},
  {"respond part.stl" .. SHAKEN .. "--base 0,0,1g --to 9 --csv part.stl", 2, "a file that ends in .csv expected"},
  {"respond part.stl" .. SHAKEN .. "--base 0,0,1g --psd curve.png --duration 1s --picture ./curve.png", 2,
    "./curve.png is the file of --psd: give another file"},
  {"drop part.stl --height 1", 2, "'1' has no unit: write 1mm or 1m"},
  {"drop part.stl --down 0,0,0", 2, "--down: a direction expected"},
  {"drop part.stl --peg 5mm --edge 5mm", 2, "--peg and --edge: leave out one of them"},
  {"drop part.stl --edge 5mm", 2, "--edge: give its direction by --along"},
  {"drop part.stl --edge 5mm --along 0,0,1", 2, "the part falls along the edge"},
  {"drop part.stl --at 0,0,0", 2, "--at: give --peg or --edge, too"},
  {"drop part.stl --seed 5", 2, "--seed: it is that of random drops; give --drops, too"},
  {"drop part.stl --drops 3 --csv x.csv", 2, "--csv: the history is that of one drop"},
  {"drop part.stl --fix min:x", 2, "unknown option --fix"},
  {"drop empty.stl", 3, "empty.stl: byte 0: the file is empty"},
  {"worst part.stl --force 5m", 2, "--force: a number with one of the units"},
  {"worst part.stl --contact 1", 2, "'1' has no unit: write 1mm2, 1cm2 or 1m2"},
  {"worst part.stl --hands 1", 2, "moves freely under the load of one hand"},
  {"worst part.stl --length short", 2, "--length: 'critical' or a number of m above 0 expected"},
  {"worst part.stl --material", 2, "--material: a value is missing (NAME)"},
  {"worst part.stl --out part.stl", 2, "--out: part.stl is the MODEL: give another file"},
  {"modes bar.msh --unit m --fix near:9,9,9m:1mm", 2, "selects no boundary node: the nearest one is at ("},
  {"modes bar.msh --unit m --fix face:lid", 2, "no face has the name 'lid': "},
  {"respond part.stl" .. SHAKEN .. "--base 0,0,1g --to 9 --first-passage 0.1", 2, "--first-passage is for --psd"},
  {"respond part.stl" .. SHAKEN .. "--base 0,0,1g --to 9 --band-limited maybe", 2, "--band-limited: "},
  {"worst plate.svg", 2, "a drawing is flat"},
  {"convert part.stl ./part.stl --scale 2", 2, "OUT: ./part.stl is IN: give another file"},
  {"test nofile.lua", 3, "nofile.lua: there is no such file or folder"},
  {"strengthen part.stl --force 5 --out ./part.stl", 2, "--out: ./part.stl is the MODEL: give another file"},
}

describe("a wrong invocation", function()
  setup(make_files)

  for _, case in ipairs(wrong) do
    local words, status, sentence = table.unpack(case)
    it("is refused with a sentence: " .. words, function()
      local code, err = run(words)
      assert.truthy(err:find(sentence, 1, true), err)
      assert.equal(1, select(2, err:gsub("\n", "")), err)
      assert.equal(status, code, err)
    end)
  end

  it("says where standard output cannot be written", function()
    for _, words in ipairs {"materials", "check part.stl", "check part.stl --json", "--help", "manual",
      "check --help", "-e 'print(1)'"} do
      local code, err = run(words, "/dev/full")
      assert.equal(3, code, words)
      assert.truthy(err:find("standard output: ", 1, true), err)
    end
  end)

  it("writes nothing", function()
    local pipe = assert(io.popen(("ls '%s'"):format(folder)))
    local names = {}
    for name in pipe:lines() do names[#names + 1] = name end
    pipe:close()
    assert.equal("bar.msh comma.csv curve.png cut.stl empty.csv empty.msh empty.stl facet.stl folder.stl junk.csv "
      .. "junk.msh junk.stl ok.csv part.stl plate.svg text.stl", table.concat(names, " "))
  end)

  it("leaves the files as they were", function()
    local before = check.read(folder .. "/bar.msh")
    run("statics bar.msh --unit m" .. PUSHED .. "--vtu bar.msh")
    assert.equal(before, check.read(folder .. "/bar.msh"))
  end)
end)
