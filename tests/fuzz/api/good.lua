-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Good arguments by the entry's name: functions of the pool and random numbers. Entries that are not here get what
-- their types say, which most functions refuse; a new function needs no line here to be called.
require "good_bodies"
require "good_plane"
require "good_data"

return require("good_lists").list
