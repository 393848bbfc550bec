-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Harmonic motions of real and imaginary displacements over the nodes, at a phase of their period.
local deflection = {}

--- The displacement at a phase (rad).
function deflection.at_phase(real, imaginary, phase)
  return real * math.cos(phase) - imaginary * math.sin(phase)
end

--- The phase at which the displacement is largest, over all nodes together.
function deflection.largest_phase(real, imaginary)
  local aa, bb, ab = real:dot(real), imaginary:dot(imaginary), real:dot(imaginary)
  return 0.5 * math.atan(-2 * ab, aa - bb)
end

return deflection
