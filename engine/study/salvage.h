/* What salvage.c takes of salvage_tables.c. */
/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_STUDY_SALVAGE_H
#define BWI_STUDY_SALVAGE_H

#include <sqlite3.h>

#include "barwright/study.h"

/* Whether the file that is open as `from` lacks a list of its tables, or `always`: then `*rebuilt`,
 * and the first page of `copy`, which is that file and is to be opened again, becomes that of an
 * empty file with the tables of `schema`. The empty file is made at `scratch` and left there. */
bw_status bwi_salvage_tables(bw_context *context, sqlite3 *from, const char *schema,
                             const char *copy, const char *scratch, bool always, bool *rebuilt);

#endif
