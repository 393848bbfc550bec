-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright help [COMMAND]
local help_text = require "barwright.command.help_text"

return {
  summary = "what the commands are, or how one is used",
  about = "The same texts as `barwright --help` and `barwright COMMAND --help`.",
  arguments = {{name = "command", optional = true, what = "the command to describe"}},
  examples = {"barwright help worst"},
  run = function(opts, out)
    local commands = require "barwright.command"
    if not opts.command then
      out:say(commands.help())
    elseif commands.known(opts.command) then
      out:say(help_text.of(opts.command, commands.load(opts.command)))
    else
      return out:misuse(("there is no command '%s': %s"):format(opts.command,
        commands.suggestion(opts.command)))
    end
    local names = commands.names()
    out:json {commands = names}
  end,
}
