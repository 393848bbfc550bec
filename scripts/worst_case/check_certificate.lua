-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Checks a certificate of the worst case's upper bound (docs/theory/worst_case.md, section 14).
local bw = require "barwright"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "checks a certificate of the worst case's upper bound",
  about = "Prints what the file states and what its multipliers prove.\n\n"
    .. "Exit status: 0 proved; 1 rejected; 2 no certificate, or misuse.",
  arguments = {{name = "file", type = "file", what = "the certificate"}},
}
local proof, message, details = bw.check_certificate(opts.file)
if not proof then script.stop(details.status == "rejected" and 1 or script.REFUSED, message) end
print(("%d elements, %d supports, %d forbidden facets; loads: pressures up to %.6g Pa, %s %.6g N in all%s"):format(
  proof.elements, proof.supports, proof.forbidden_facets, proof.pressure,
  proof.force_is_max and "at most" or "exactly", proof.force,
  proof.friction > 0 and (", friction %g"):format(proof.friction) or ""))
print(("A load reaches %.9g Pa in element %d."):format(proof.reached, proof.element))
print(("No load exceeds %.9g Pa, %.3g %% more: %d leaves were checked. %.2g Pa of it stand for what the linear "
  .. "solves may be off by."):format(proof.upper_bound, 100 * proof.gap, proof.leaves, proof.solve_error))
