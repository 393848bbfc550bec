-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Checks a certificate of the worst case's upper bound (docs/theory/worst_case.md, section 14).
--   build/barwright scripts/worst_case/check_certificate.lua FILE
-- Prints what the file states and what its multipliers prove. Exit status 0: proved. 1: rejected. 2: no
-- certificate, or misuse.
local bw = require "barwright"

local path = arg[1]
if not path or arg[2] or path:match "^%-" then
  io.stderr:write("check_certificate: one FILE expected\n")
  os.exit(2, true)
end
local proof, message, details = bw.check_certificate(path)
if not proof then
  io.stderr:write("check_certificate: ", message, "\n")
  os.exit(details.status == "rejected" and 1 or 2, true)
end
print(("%d elements, %d supports, %d forbidden facets; loads: pressures up to %.6g Pa, %s %.6g N in all%s"):format(
  proof.elements, proof.supports, proof.forbidden_facets, proof.pressure,
  proof.force_is_max and "at most" or "exactly", proof.force,
  proof.friction > 0 and (", friction %g"):format(proof.friction) or ""))
print(("A load reaches %.9g Pa in element %d."):format(proof.reached, proof.element))
print(("No load exceeds %.9g Pa, %.3g %% more: %d leaves were checked. %.2g Pa of it stand for what the linear "
  .. "solves may be off by."):format(proof.upper_bound, 100 * proof.gap, proof.leaves, proof.solve_error))
