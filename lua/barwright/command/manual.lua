-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright manual: the man page barwright(1), as roff, made from the commands' tables.
local core = require "barwright.core"
local arguments = require "barwright.command.arguments"
local help_text = require "barwright.command.help_text"

-- A text as roff shows it: no escapes, no hyphens for minus signs, no control lines.
local function roff(text)
  text = text:gsub("\\", "\\e"):gsub("%-", "\\-"):gsub("`([^`]*)`", "\\fB%1\\fR")
  return (text:gsub("^([.'])", "\\&%1"):gsub("\n([.'])", "\n\\&%1"))
end

local function paragraphs(text, lines)
  for block in (text .. "\n\n"):gmatch "(.-)\n\n" do
    lines[#lines + 1] = ".PP"
    if block:match "^%s" then -- an example, as it stands
      lines[#lines + 1] = ".nf"
      lines[#lines + 1] = roff((block:gsub("^  ", ""):gsub("\n  ", "\n")))
      lines[#lines + 1] = ".fi"
    else
      lines[#lines + 1] = roff((block:gsub("\n", " ")))
    end
  end
end

local function option(rule, dash)
  local text = ("\\fB%s%s\\fR"):format(dash and "\\-" or "\\-\\-", roff(rule.name))
  return rule.type ~= "flag" and ("%s \\fI%s\\fR"):format(text, roff(rule.value)) or text
end

local function entry(head, text, lines)
  lines[#lines + 1] = ".TP"
  lines[#lines + 1] = head
  lines[#lines + 1] = roff(text)
end

local function command_page(name, command, lines)
  lines[#lines + 1] = (".SS %s"):format(roff(name))
  local places = {}
  for i, rule in ipairs(command.arguments or {}) do
    places[i] = " \\fI" .. roff(help_text.place(rule)) .. "\\fR"
  end
  for _, rule in ipairs(command.options or {}) do
    if rule.needed then places[#places + 1] = " " .. option(rule) end
  end
  lines[#lines + 1] = ("\\fBbarwright %s\\fR%s [options]"):format(roff(name), table.concat(places))
  paragraphs(command.about or command.summary .. ".", lines)
  for _, rule in ipairs(command.arguments or {}) do
    entry("\\fI" .. roff(help_text.place(rule):gsub("[%[%]]", "")) .. "\\fR",
      rule.what .. help_text.notes(rule, true), lines)
  end
  for _, rule in ipairs(command.options or {}) do
    entry(option(rule), rule.what .. help_text.notes(rule), lines)
  end
  for _, example in ipairs(command.examples or {}) do
    local what = type(example) == "table" and example[2] or "for example"
    lines[#lines + 1] = ".PP"
    lines[#lines + 1] = roff(what:gsub("^%l", string.upper)) .. ":"
    lines[#lines + 1] = ".PP"
    lines[#lines + 1] = ".nf"
    lines[#lines + 1] = ".RS 4"
    lines[#lines + 1] = roff(type(example) == "string" and example or example[1])
    lines[#lines + 1] = ".RE"
    lines[#lines + 1] = ".fi"
  end
end

local about = [[
barwright computes where a part breaks, its natural frequencies, and what changes with its shape. Its commands
take files: surfaces (STL OBJ OFF PLY 3MF glTF STEP IGES), meshes of tetrahedra (MSH VTU PVTU MEDIT INP TetGen),
drawings (SVG DXF). A word that is the name of a command is one; any other is a script in Lua, which finds
the engine with
`require "barwright"`. A script whose file is named like a command is run as `./NAME`. Without either, a prompt
opens.

Numbers on the command line are in SI units, or have a unit behind them: 20N, 0.2MPa, 30mm, 5min.
Lengths and areas need one.]]

local sandbox = [[
With `--sandbox` a script or a command reads and writes files in one folder only, where links are followed before
that is judged, and starts no program, server or job; scripts are loaded as text only with and without it. The
kernel holds the same line where it has Landlock. `--memory` and `--seconds` limit what it may use, with and
without a sandbox: a script whose time is over is ended whatever it does.]]

local function page(commands)
  local lines = {'.\\" Made by `barwright manual` from the commands\' tables.',
    (".TH BARWRIGHT 1 \"\" \"barwright %s\" \"User Commands\""):format(core.version), ".SH NAME",
    "barwright \\- where a part breaks, its natural frequencies, and changes of its shape", ".SH SYNOPSIS",
    "\\fBbarwright\\fR \\fICOMMAND\\fR ...", ".br",
    "\\fBbarwright\\fR [options] [\\fISCRIPT.lua\\fR [arguments]]", ".SH DESCRIPTION"}
  paragraphs(about, lines)
  lines[#lines + 1] = ".SH OPTIONS"
  for _, rule in ipairs(commands.program_options) do entry(option(rule, rule.short), rule.what, lines) end
  lines[#lines + 1] = ".PP"
  lines[#lines + 1] = "Of every command:"
  for _, rule in ipairs(arguments.common) do entry(option(rule), rule.what, lines) end
  lines[#lines + 1] = ".SH COMMANDS"
  for _, name in ipairs(commands.names()) do command_page(name, commands.load(name), lines) end
  lines[#lines + 1] = ".SH SANDBOX"
  paragraphs(sandbox, lines)
  lines[#lines + 1] = ".SH EXIT STATUS"
  for _, row in ipairs {{"0", "done; the answer is yes"},
    {"1", "the answer is no (not sound, breaks), or the error leaves it open"},
    {"2", "misuse or refused"},
    {"3", "it could not be computed, or a file could not be read or written"},
    {"124", "the time that `--seconds` allows was over"},
    {"130", "interrupted by Ctrl-C"}} do
    entry("\\fB" .. row[1] .. "\\fR", row[2], lines)
  end
  lines[#lines + 1] = ".PP"
  lines[#lines + 1] = "A script ends with what it gives os.exit."
  lines[#lines + 1] = ".SH ENVIRONMENT"
  entry("\\fBBARWRIGHT_THREADS\\fR", "number of threads; results do not depend on it", lines)
  entry("\\fBBARWRIGHT_QUIET\\fR", "1: show no progress", lines)
  entry("\\fBBARWRIGHT_UNIT\\fR", "the unit of surfaces that have none, as \\-\\-unit", lines)
  return table.concat(lines, "\n")
end

return {
  summary = "the man page, as roff",
  about = "Prints the man page barwright(1), which is made from the same tables as the commands' --help.",
  examples = {"barwright manual | man -l -"},
  run = function(_, out)
    local text = page(require "barwright.command")
    out:say("%s", text)
    out:json {text = text}
  end,
}
