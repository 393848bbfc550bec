-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Contact: files and pictures of its pressure. docs/theory/contact.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"

local contact = core.classes.contact.methods

--- The fields of the static solution and the contact pressure, as .vtu (or what the ending says).
function contact:write(path)
  return self.static:write(path, {fields = {contact_pressure = {self.pressure, on = "nodes"}}})
end

--- The deformed part coloured by its contact pressure; options of static:picture.
function contact:picture(path, given)
  local opts = options.copied(given)
  opts.field, opts.unit, opts.scale = self.pressure, opts.unit or "contact pressure, MPa", opts.scale or 1e-6
  return self.static:picture(path, opts)
end

arguments.methods("contact", contact, nil, {write = "path: string", picture = "path: string, options?: options"})
