-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Whether stress over strength is known everywhere: where elements are of several materials, each has its own.
return function(material)
  for _, part in ipairs(material.parts or {material}) do
    if not part.strength then return false end
  end
  return true
end
