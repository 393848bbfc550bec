-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The tables of the four papers, ours beside each printed number: every part is a run of a script in a job
-- of its own; a part that is done with the same program and the same words is not run again.
local folder = arg[0]:match "^(.*)/[^/]*$" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local core = require "barwright.core"
local files = require "barwright.scenario.files"
local page = require "page"
local parts = require "parts"
local printed = require "printed"
local read_file = require "barwright.read_file"
local script = require "barwright.command.script"

local DONE, NOT_DONE = 0, 1

local function read_arguments()
  local opts = script.read {
    summary = "the tables of the four papers, ours beside each printed number",
    about = "Runs every part in a job of its own. A part that is done with the same program and the same options "
      .. "is not run again. DIR gets SCALE/index.html, result.json, manifest.json, and a folder of results for "
      .. "each part.\n\n"
      .. "Exit status: 0 every part is done; 1 one is not; 2 the input was refused; 130 interrupted.",
    options = {
      {name = "quick", type = "flag", what = "in minutes: smaller, and the page says what is (this is the "
        .. "default)"},
      {name = "full", type = "flag", what = "overnight: the papers' sizes"},
      {name = "tiny", type = "flag", what = "in seconds: for the tests"},
      {name = "out", value = "DIR", type = "folder", default = "reproduced", what = "where the results go"},
      {name = "only", value = "TEXT", what = "parts whose name contains this text; what others gave before stays "
        .. "in the page"},
      {name = "again", type = "flag", what = "run what is done, too"},
      {name = "list", type = "flag", what = "print the parts, run none"},
    },
  }
  opts.scale = opts.full and "full" or opts.tiny and "tiny" or "quick"
  return opts
end

local function read_json(path)
  local text = read_file(path)
  local value = text and bw.json.decode(text)
  return type(value) == "table" and value or nil
end

-- ---- one part --------------------------------------------------------------------------------------------

local function words_of(part, out)
  local words = {}
  for i, word in ipairs(part.words) do
    words[i] = word == "OUT" and out .. "/" .. part.name
      or word == "LIBRARY" and out .. "/data_driven_library/three.bwm" or word
  end
  return words
end

-- What identifies the engine where the commit does not: it may have been built since.
local function engine_digest()
  for line in io.lines "/proc/self/maps" do
    local path = line:match "%s(/[^%s]*libbarwright[^%s]*)$"
    if path then return core.sha256(path) or "" end
  end
  return ""
end
local engine = engine_digest()

-- What must be the same for a part to be done: the program, the script, and what it was asked for.
local function key_of(words)
  return ("%s %s, engine %s, script %s: %s"):format(core.version, core.commit, engine:sub(1, 16),
    (core.sha256(words[1]) or ""):sub(1, 16), table.concat(words, " "))
end

local function program()
  local pipe = assert(io.popen "readlink /proc/$PPID/exe")
  local path = pipe:read "l"
  pipe:close()
  return path
end

-- Runs the words in a job; what they print goes into the part's folder. {status, message, seconds}.
local function run(part, words, out)
  -- What runs ends with the process that waits for it, also where that one is killed.
  local line = {"exec setpriv --pdeathsig KILL " .. files.quoted(program())}
  for i, word in ipairs(words) do line[i + 1] = files.quoted(word) end
  local command = ("%s >%s 2>&1 </dev/null"):format(table.concat(line, " "), files.quoted(out .. "/printed.txt"))
  local job, message = core.job(function()
    local _, how, code = os.execute(command)
    return ("%s %d"):format(how, code)
  end, {name = part.name, seconds = part.seconds})
  if not job then return {status = "failed", message = message, seconds = 0} end
  local at, why = core.wait({job})
  if not at then
    job:cancel()
    return {status = "interrupted", message = why, seconds = job.seconds}
  end
  local answer, details
  answer, message, details = job:result()
  if not answer then
    return {status = details.limit or details.status, message = message, seconds = job.seconds}
  end
  local how, code = answer:match "^(%a+) (%d+)$"
  if how == "exit" and code == "0" then
    return {status = "done", seconds = job.seconds, seconds_processor = job.processor_seconds}
  end
  local text = read_file(out .. "/printed.txt") or ""
  local last = text:match ".*\nbarwright: ([^\n]+)" or text:match "([^\n]+)\n*$"
  return {status = "failed", message = ("%s status %s: %s"):format(how, code, last or "it printed nothing"),
    seconds = job.seconds, exit_status = tonumber(code)}
end

-- The state of a part after it was seen to: {status, message, seconds, result}.
local function see_to(part, opts, out, states)
  local own, words = out .. "/" .. part.name, words_of(part, out)
  local result = own .. "/" .. (part.result or "result.json")
  local key, before = key_of(words), read_json(own .. "/part.json")
  local known = before and before.key == key and before.status == "done" and read_json(result)
  local wanted = not opts.only or part.name:find(opts.only, 1, true)
  if known and not (opts.again and wanted) then
    before.result, before.kept = known, true
    return before
  end
  if not wanted then return {status = "not asked for", result = known or nil} end
  if part.after and states[part.after].status ~= "done" then
    return {status = "left out", message = ("%s is not done"):format(part.after)}
  end
  assert(files.make_folder(own))
  os.remove(result) -- what another commit left behind is not this one's
  local state = run(part, words, own)
  state.key, state.words = key, bw.json.list(words)
  assert(core.write_file(own .. "/part.json", bw.json.encode(state, "  ") .. "\n"))
  state.result = read_json(result)
  if state.status == "done" and not state.result then
    state.status, state.message = "failed", "it wrote no " .. result
  end
  return state
end

-- ---- all of them -----------------------------------------------------------------------------------------

-- Ours beside what is printed, taken out of the parts' results and nowhere else.
local function fill_in(states)
  local tables = bw.json.list {}
  for i, about in ipairs(printed.tables) do
    local rows = bw.json.list {}
    for k, row in ipairs(about.rows) do
      local state = row.part and states[row.part]
      local made = {what = row.what, unit = row.unit, printed = row.printed, part = row.part,
        want = not (state and state.shrunk) and row.want or nil}
      if state and state.result then
        local ok, ours, note = pcall(row.pick, state.result)
        if ok and type(ours) == "number" then
          -- what the clock decides has a name that says so
          made[row.timed and "ours_timed" or "ours"], made.note = ours, note
        else
          made.why = "not in this run"
        end
      elseif state then
        made.why = state.status
      else
        made.why = row.part and "not run at this scale" or "of metal, not made"
      end
      rows[k] = made
    end
    tables[i] = {paper = about.paper, place = about.place, title = about.title, note = about.note, rows = rows}
  end
  return tables
end

local function main()
  local opts = read_arguments()
  local list = parts.of(opts.scale)
  if opts.list then
    for _, part in ipairs(list) do print(part.name .. "  " .. table.concat(part.words, " ")) end
    return DONE
  end
  local out = opts.out .. "/" .. opts.scale
  local results, message = bw.results.open(out, {script = "scripts/reproduce", options = {scale = opts.scale}})
  if not results then script.refuse(message) end
  local states, order, start, status = {}, bw.json.list {}, bw.seconds(), DONE
  local selected = 0
  for i, part in ipairs(list) do
    if status ~= script.INTERRUPTED then
      if not opts.only or part.name:find(opts.only, 1, true) then selected = selected + 1 end
      local state = see_to(part, opts, out, states)
      state.shrunk = part.shrunk
      states[part.name] = state
      if state.status == "interrupted" or bw.interrupted() then status = script.INTERRUPTED
      elseif state.status ~= "done" and state.status ~= "not asked for" then status = NOT_DONE end
      print(("%2d of %d  %-26s %-9s %s"):format(i, #list, part.name, state.kept and "kept" or state.status,
        state.message or state.seconds and ("%.1f s, processor %.1f s"):format(state.seconds,
        state.seconds_processor or 0) or ""))
      io.stdout:flush()
    else
      states[part.name] = {status = "not asked for"}
    end
    local state = states[part.name]
    order[i] = {name = part.name, status = state.status, message = state.message, seconds = state.seconds,
      seconds_processor = state.seconds_processor, smaller = part.smaller,
      words = bw.json.list(words_of(part, out))}
  end
  if selected == 0 and opts.only then script.refuse(("no part's name holds '%s'"):format(opts.only)) end
  local tables = fill_in(states)
  assert(results:write {scale = opts.scale, parts = order, tables = tables, seconds_total = bw.seconds() - start})
  assert(core.write_file(results:path "index.html", page.document {scale = opts.scale, parts = order,
    tables = tables, papers = printed.papers, manifest = results.manifest}))
  print("wrote " .. results:path "index.html")
  return status
end

script.run(main, NOT_DONE)
