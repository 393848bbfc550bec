-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Reports of solvers that worked for one result in several calls, summed.
local solver_reports = {}

local SUMMED = {"predicted_cost", "rival_cost", "flops", "seconds", "iterations"}
local LARGEST = {"bytes", "residual"}

--- Adds a report to reports[name], which has the words of the first one.
function solver_reports.add(reports, name, report)
  local total = reports[name]
  if not total then
    total = {}
    for key, value in pairs(report) do total[key] = value end
    reports[name] = setmetatable(total, getmetatable(report))
    return
  end
  for _, key in ipairs(SUMMED) do
    if report[key] then total[key] = (total[key] or 0) + report[key] end
  end
  for _, key in ipairs(LARGEST) do
    if report[key] then total[key] = math.max(total[key] or 0, report[key]) end
  end
end

return solver_reports
