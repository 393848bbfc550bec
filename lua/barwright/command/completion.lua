-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright completion SHELL: what a shell needs to complete commands, options and their values; made from the
-- commands' tables.
local arguments = require "barwright.command.arguments"

-- "'" in a text in single quotes.
local function quoted(text)
  return "'" .. tostring(text):gsub("'", "'\\''") .. "'"
end

local function words(list)
  local texts = {}
  for i, word in ipairs(list) do texts[i] = tostring(word) end
  return table.concat(texts, " ")
end

local function names_of(command)
  local list = {}
  for _, rule in ipairs(arguments.options(command)) do list[#list + 1] = "--" .. rule.name end
  return list
end

local function program_names(commands)
  local list = {}
  for i, rule in ipairs(commands.program_options) do list[i] = (rule.short and "-" or "--") .. rule.name end
  return list
end

-- ---- bash ------------------------------------------------------------------------------------------

-- What completes a value: bash code that fills COMPREPLY, or nil.
local function bash_values(rule)
  if rule.one_of then return ("COMPREPLY=($(compgen -W %s -- \"$word\"))"):format(quoted(words(rule.one_of))) end
  if rule.type == "file" then return "_barwright_files" end
  if rule.type == "folder" then return "COMPREPLY=($(compgen -d -- \"$word\"))" end
  if rule.type ~= "flag" then return "return" end
end

local function bash_command(name, command, out)
  out[#out + 1] = ("    %s)"):format(name)
  out[#out + 1] = "      case $before in"
  for _, rule in ipairs(arguments.options(command)) do
    local code = bash_values(rule)
    if code then out[#out + 1] = ("        --%s) %s; return ;;"):format(rule.name, code) end
  end
  out[#out + 1] = "      esac"
  out[#out + 1] = ("      if [[ $word == -* ]]; then COMPREPLY=($(compgen -W %s -- \"$word\")); return; fi")
    :format(quoted(words(names_of(command))))
  local first = command.arguments and command.arguments[1]
  if name == "help" then
    out[#out + 1] = "      COMPREPLY=($(compgen -W \"$commands\" -- \"$word\")) ;;"
  elseif first and first.one_of then
    out[#out + 1] = "      if [[ $((COMP_CWORD - at)) == 1 ]]; then"
    out[#out + 1] = "        COMPREPLY=($(compgen -W " .. quoted(words(first.one_of)) .. " -- \"$word\")); return"
    out[#out + 1] = "      fi"
    out[#out + 1] = "      _barwright_files ;;"
  else
    out[#out + 1] = "      _barwright_files ;;"
  end
end

local function bash(commands)
  local out = {"# Completion of barwright in bash, made by `barwright completion bash`.", "",
    "_barwright_files() { compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -f -- \"$word\")); }", "",
    "_barwright() {",
    "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command= at=1",
    "  local IFS=$' \\t\\n' commands=" .. quoted(words(commands.names())),
    "  # \"--name=value\" comes as three words.",
    "  if [[ $before == = && COMP_CWORD -gt 2 ]]; then before=${COMP_WORDS[COMP_CWORD-2]}; fi",
    "  if [[ $word == = ]]; then before=${COMP_WORDS[COMP_CWORD-1]}; word=; fi",
    "  while [[ $at -lt $COMP_CWORD ]]; do",
    "    case ${COMP_WORDS[at]} in",
    "      -e|--sandbox|--memory|--seconds) at=$((at + 1)) ;;",
    "      -*|=) ;;",
    "      *) command=${COMP_WORDS[at]}; break ;;",
    "    esac",
    "    at=$((at + 1))",
    "  done",
    "  COMPREPLY=()",
    "  case $command in",
    "    '')",
    "      if [[ $before == --sandbox ]]; then COMPREPLY=($(compgen -d -- \"$word\")); return; fi",
    ("      if [[ $word == -* ]]; then COMPREPLY=($(compgen -W %s -- \"$word\")); return; fi")
      :format(quoted(words(program_names(commands)))),
    "      compopt -o filenames 2>/dev/null",
    "      COMPREPLY=($(compgen -W \"$commands\" -- \"$word\") $(compgen -f -X '!*.lua' -- \"$word\") "
      .. "$(compgen -d -- \"$word\")) ;;"}
  for _, name in ipairs(commands.names()) do bash_command(name, commands.load(name), out) end
  out[#out + 1] = "    *) _barwright_files ;;"
  out[#out + 1] = "  esac"
  out[#out + 1] = "}"
  out[#out + 1] = "complete -F _barwright barwright"
  return out
end

-- ---- zsh -------------------------------------------------------------------------------------------

-- In the middle of an _arguments specification these mean something.
local function zsh_text(text)
  return (text:gsub("[%[%]:\\]", "\\%0"))
end

local function zsh_action(rule)
  if rule.one_of then return "(" .. words(rule.one_of) .. ")" end
  if rule.type == "file" then return "_files" end
  if rule.type == "folder" then return "_files -/" end
  return " "
end

local function zsh_option(rule, dash)
  local spec = ("%s%s%s[%s]"):format(rule.many and "*" or "", dash or "--", rule.name, zsh_text(rule.what))
  if rule.type ~= "flag" then spec = spec .. (":%s:%s"):format(zsh_text(rule.value), zsh_action(rule)) end
  return quoted(spec)
end

local function zsh_command(name, command, out)
  local line = {"    " .. name .. ") _arguments"}
  for _, rule in ipairs(arguments.options(command)) do line[#line + 1] = zsh_option(rule) end
  for i, rule in ipairs(command.arguments or {}) do
    local action = zsh_action(name == "help" and {one_of = require("barwright.command").names()} or rule)
    action = action == " " and "_files" or action
    line[#line + 1] = quoted((rule.many and "*" or tostring(i)) .. ":" .. zsh_text(rule.name) .. ":" .. action)
  end
  out[#out + 1] = table.concat(line, " \\\n        ") .. " ;;"
end

local function zsh(commands)
  local out = {"#compdef barwright", "# Completion of barwright in zsh, made by `barwright completion zsh`.", "",
    "_barwright() {", "  local context state line", "  local -a commands", "  commands=("}
  for _, name in ipairs(commands.names()) do
    out[#out + 1] = "    " .. quoted(name .. ":" .. zsh_text(commands.load(name).summary))
  end
  out[#out + 1] = "  )"
  local line = {"  _arguments -C"}
  for _, rule in ipairs(commands.program_options) do
    local spec = {name = rule.name, what = rule.what, value = rule.value,
      type = rule.name == "sandbox" and "folder" or rule.type}
    line[#line + 1] = zsh_option(spec, rule.short and "-" or "--")
  end
  line[#line + 1] = "'1:command or script:->first'"
  line[#line + 1] = "'*::arguments:->rest'"
  out[#out + 1] = table.concat(line, " \\\n    ")
  for _, text in ipairs {"  case $state in",
    "  first) _describe -t commands command commands; _files -g '*.lua' ;;", "  rest) case $words[1] in"} do
    out[#out + 1] = text
  end
  for _, name in ipairs(commands.names()) do zsh_command(name, commands.load(name), out) end
  for _, text in ipairs {"    *) _files ;;", "    esac ;;", "  esac", "}", "_barwright \"$@\""} do
    out[#out + 1] = text
  end
  return out
end

-- ---- fish ------------------------------------------------------------------------------------------

local function fish_values(rule)
  if rule.type == "flag" then return "" end
  if rule.one_of then return " -x -a " .. quoted(words(rule.one_of)) end
  if rule.type == "file" then return " -r -F" end
  if rule.type == "folder" then return " -x -a '(__fish_complete_directories)'" end
  return " -x"
end

local before = 'complete -c barwright -n "not __fish_seen_subcommand_from $commands" '

local function fish(commands)
  local out = {"# Completion of barwright in fish, made by `barwright completion fish`.",
    "set -l commands " .. words(commands.names()),
    before .. "-k -a '(__fish_complete_suffix .lua)'"}
  for _, rule in ipairs(commands.program_options) do
    local values = fish_values {type = rule.name == "sandbox" and "folder" or rule.type}
    out[#out + 1] = before .. ("%s %s%s -d %s"):format(rule.short and "-s" or "-l", rule.name, values,
      quoted(rule.what))
  end
  for _, name in ipairs(commands.names()) do
    local command = commands.load(name)
    local behind = ("complete -c barwright -n '__fish_seen_subcommand_from %s' "):format(name)
    out[#out + 1] = before .. ("-f -a %s -d %s"):format(name, quoted(command.summary))
    for _, rule in ipairs(arguments.options(command)) do
      out[#out + 1] = behind .. ("-l %s%s -d %s"):format(rule.name, fish_values(rule), quoted(rule.what))
    end
    local first = command.arguments and command.arguments[1]
    local values = name == "help" and commands.names() or first and first.one_of
    if values then
      out[#out + 1] = behind .. "-a " .. quoted(words(values))
    end
  end
  return out
end

local shells = {bash = bash, zsh = zsh, fish = fish}

return {
  summary = "completion of commands and options for bash, zsh or fish",
  about = "Prints what a shell needs to complete barwright's commands, options and their values. The installation "
    .. "puts it where the shells look; for a build tree:\n\n  source <(build/barwright completion bash)",
  arguments = {{name = "shell", one_of = {"bash", "zsh", "fish"}, what = "for which shell"}},
  examples = {"source <(barwright completion bash)"},
  run = function(opts, out)
    local text = table.concat(shells[opts.shell](require "barwright.command"), "\n")
    out:say("%s", text)
    out:json {text = text}
  end,
}
