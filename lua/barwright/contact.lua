-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Contact: files and pictures of its pressure and friction. docs/theory/contact.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"

local contact = core.classes.contact.methods

--- The fields of the static solution, the contact pressure and friction, as .vtu (or what the ending says).
function contact:write(path)
  local fields = {contact_pressure = {self.pressure, on = "nodes"}}
  if self.traction then
    fields.friction = {self.traction, on = "nodes"}
    fields.slip = {self.slip, on = "nodes"}
    fields.contact_status = {self.status, on = "nodes"}
  end
  return self.static:write(path, {fields = fields})
end

--- The deformed part coloured by its contact pressure; options of static:picture.
function contact:picture(path, given)
  local opts = options.copied(given)
  opts.field, opts.unit, opts.scale = self.pressure, opts.unit or "contact pressure, MPa", opts.scale or 1e-6
  return self.static:picture(path, opts)
end

arguments.methods("contact", contact, nil, {write = "path: string", picture = "path: string, options?: options"})
