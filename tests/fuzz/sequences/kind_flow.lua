-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
return require "flow_kind"("flow", {"velocity", "pressure", "vorticity", "time"}, {})
