-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright help [COMMAND]
local help_text = require "barwright.command.help_text"

return {
  summary = "what the commands are, or how one is used",
  about = "The same texts as `barwright --help` and `barwright COMMAND --help`.",
  arguments = {{name = "command", optional = true, what = "the command to tell about"}},
  examples = {"barwright help worst"},
  run = function(wish, out)
    local commands = require "barwright.command"
    if not wish.command then
      out:say(commands.help())
    elseif commands.known(wish.command) then
      out:say(help_text.of(wish.command, commands.load(wish.command)))
    else
      return out:misuse(("there is no command '%s': %s"):format(wish.command,
        commands.suggestion(wish.command)))
    end
    local names = commands.names()
    out:json {commands = names}
  end,
}
