-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright live FILE: the live view of what a file makes: a session, a part and the options of bw.edit,
-- or an object of bw.responsive; or of saved edits of one. docs/live.md has more.
local browser = require "barwright.command.browser"
local core = require "barwright.core"
local edit = require "barwright.edit"
local edit_script = require "barwright.edit_script"
local kinds = require "barwright.live_plane_kinds"
local live = require "barwright.live"
local plane_edits = require "barwright.live_plane_edits"
local read_file = require "barwright.read_file"
local script_file = require "barwright.script_file"

-- One sentence that ends the command: caught where it is run.
local function fail(text, status)
  error({text = text, status = status})
end

-- ---- sessions --------------------------------------------------------------------------------------

local function read(path)
  local refusal = script_file.refusal(path)
  if refusal then fail(("%s, `barwright open %s` opens it in the browser"):format(refusal, path)) end
  local text, why = read_file(path)
  return text or fail(why, "io")
end

local function exists(path)
  local file = io.open(path, "rb")
  if file then file:close() end
  return file ~= nil
end

local function folder(path)
  return path:match "^(.*[/\\])" or ""
end

-- How the file of edits names the file that it replays on: beside it, else by its whole path.
local function name_for(file, save)
  if folder(file) == folder(save) then return file:sub(#folder(file) + 1) end
  if file:sub(1, 1) == "/" then return file end
  return (os.getenv "PWD" or ".") .. "/" .. file
end

local function checked(what, value, message, ...)
  if value == nil or value == false then
    message = tostring(message)
    fail(message:sub(1, #what) == what and message or what .. ": " .. message)
  end
  return value, message, ...
end

-- A file of edits: replayed, and grown further unless they are to be kept elsewhere.
local function open_edits(opts)
  local session, cut = checked(opts.file, edit.load(opts.file, nil, {resume = not opts.save}))
  if cut then print(opts.file .. ": the last line was cut off in the middle and is left out") end
  if opts.save then checked(opts.save, edit_script.keep(session, opts.save)) end
  return session, {}, opts.save or opts.file
end

-- Edits of an outline that were kept before: their lines are done again by the view.
local function open_outline(opts, object, about, save)
  local lines = {}
  if exists(save) and not opts.fresh then
    local script
    script, lines = plane_edits.read(read(save))
    if not script then fail(save .. ": there, but not a file of edits of an outline (--save, --fresh)") end
    print(("%s: %d edits made again (--fresh begins without them)"):format(save, #lines))
  elseif exists(save) then
    os.rename(save, save .. "~")
  end
  about.lines, about.script = lines, name_for(opts.file, save)
  return object, about, save
end

local function open_script(opts)
  local before = rawget(_G, "arg")
  rawset(_G, "arg", {[0] = opts.file}) -- the words of this command are none of the script's
  local ok, made, about = pcall(dofile, opts.file)
  rawset(_G, "arg", before)
  if not ok then fail(tostring(made), "format") end
  if made == nil and type(about) == "string" then fail(opts.file .. ": " .. about) end
  local save = opts.save or opts.file:gsub("%.lua$", "") .. ".edits.lua"
  local session = made
  about = type(about) == "table" and about or {}
  if kinds.of(made) then return open_outline(opts, made, about, save) end
  if core.class_name(made) == "model" then
    session, about = checked(opts.file, edit(made, about)), {}
  elseif getmetatable(made) ~= edit.class then
    fail(opts.file .. ": the file must return a session (bw.edit), a part and options of bw.edit, or an "
      .. "object of bw.responsive")
  end
  session.opts.script = name_for(opts.file, save)
  if exists(save) and not opts.fresh then
    local _, cut = checked(save, edit.load(save, session, {resume = true}))
    print(("%s: %d edits replayed (--fresh begins without them)%s"):format(save, #session.edits,
      cut and "; the last line was cut off in the middle and is left out" or ""))
  else
    checked(save, edit_script.keep(session, save))
  end
  return session, about, save
end

-- A file of edits of an outline stands for the script that it names.
local function open_kept(opts, text)
  local script = plane_edits.read(text)
  opts.save = opts.save or opts.file
  if script:sub(1, 1) ~= "/" then script = folder(opts.file) .. script end
  opts.file = script
  return open_script(opts)
end

-- ---- the view ---------------------------------------------------------------------------------------

-- What of a script's table of options goes on to the view.
local function passed(about, served)
  local list = kinds.of(served) and {"von_mises", "pace", "paused", "goal", "script", "lines"}
    or {"von_mises", "solve", "worst", "ties"}
  local out = {}
  for _, name in ipairs(list) do out[name] = about[name] end
  return out
end

local function open_file(opts)
  local text = read(opts.file)
  if plane_edits.read(text) then return open_kept(opts, text) end
  return (text:find('require%("barwright"%)%.edit%.begin%(') and open_edits or open_script)(opts)
end

local function serve(opts, out)
  local served, about, saved = open_file(opts)
  local name = opts.file:match "([^/\\]*)$":gsub("%.lua$", ""):gsub("[^%w_.-]", "_")
  local opened
  local given = passed(about, served)
  given.port, given.name, given.saved = opts.port, name, saved
  given.title = about.title or not kinds.of(served) and name or nil -- else the kind's
  function given.ready(address)
    print(address) -- also under --quiet: nobody could open it else
    out:say("Open it in a browser of this machine. Edits are kept in %s. Ctrl-C ends.", saved)
    io.stdout:flush()
    if not opts.no_open then opened = browser.open(address) end
  end
  local ok, message, details = live.run(served, given)
  if opened then opened:close() end
  if not ok then fail(message, details and details.status) end
  local count
  if kinds.of(served) then
    local _, lines = plane_edits.read(read(saved))
    count = #lines
  else
    count = #served.edits
    served:close()
  end
  out:say("%d edits in force, kept in %s", count, saved)
  out:json {edits = count, kept = saved}
end

local function run(opts, out)
  local ok, problem = xpcall(serve, function(problem)
    return type(problem) == "table" and problem or debug.traceback(problem, 2)
  end, opts, out)
  if ok then return end
  if type(problem) ~= "table" then error(problem, 0) end
  return out:fail(problem.text, {status = problem.status or "misuse"})
end

return {
  summary = "an edit session in the browser",
  about = "Opens the live view of what a file makes: a session (bw.edit), a part and the options of bw.edit, "
    .. "or an object of bw.responsive; or of a file of edits that was kept of one. Only this machine can reach "
    .. "the page, and only with the address that is printed. Ctrl-C ends it.",
  server = true,
  arguments = {{name = "file", type = "file", what = "a script that returns the session, or saved edits"}},
  options = {
    {name = "port", value = "N", type = "integer", default = 0, min = 0, max = 65535,
      what = "the port to listen at; 0: any that is free"},
    {name = "save", value = "FILE", type = "file", what = "where the edits are kept; else SESSION.edits.lua "
      .. "beside the file. They are replayed when they are there already"},
    {name = "fresh", type = "flag", what = "begin without the edits kept before; the file is kept as FILE~"},
    {name = "no-open", type = "flag", what = "print the address only, do not open a browser"},
  },
  examples = {"barwright live hook.lua", {"barwright live hook.edits.lua", "goes on from the edits kept before"}},
  run = run,
}
