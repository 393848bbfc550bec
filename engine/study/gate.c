/* Which files SQLite opens, looks for and removes: it asks by the functions of its VFS, and these
 * ask bw_may_use before the system's.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * The path of a database alone does not say what SQLite will use. A rollback journal that stands
 * beside it can name a file anywhere, of which SQLite removes what it takes for a list of journals
 * that are done with; and what stands under the names of the journals may be links. */
#include <pthread.h>
#include <string.h>

#include "barwright/confine.h"
#include "study/internal.h"

static pthread_once_t once = PTHREAD_ONCE_INIT;
static sqlite3_vfs gate, *below;
static int registered = SQLITE_ERROR;

/* Files without a name are temporary ones outside of the folder; ours stay in memory. */
static int gate_open(sqlite3_vfs *vfs, const char *name, sqlite3_file *file, int flags, int *out) {
  (void)vfs;
  bw_use use = flags & SQLITE_OPEN_READONLY ? BW_TO_READ : BW_TO_WRITE;
  if (bw_confined() && (!name || bw_may_use(NULL, name, use) != BW_OK)) {
    file->pMethods = NULL;
    return SQLITE_CANTOPEN;
  }
  return below->xOpen(below, name, file, flags, out);
}

static int gate_delete(sqlite3_vfs *vfs, const char *name, int sync) {
  (void)vfs;
  if (bw_may_use(NULL, name, BW_TO_REPLACE) != BW_OK)
    return SQLITE_IOERR_DELETE;
  return below->xDelete(below, name, sync);
}

static int gate_access(sqlite3_vfs *vfs, const char *name, int flags, int *out) {
  (void)vfs;
  *out = 0;
  if (bw_may_use(NULL, name, BW_TO_READ) != BW_OK)
    return SQLITE_OK; /* as if it were not there */
  return below->xAccess(below, name, flags, out);
}

static void *gate_load(sqlite3_vfs *vfs, const char *name) {
  (void)vfs, (void)name;
  return NULL;
}

static void put_up(void) {
  below = sqlite3_vfs_find(NULL);
  if (!below)
    return;
  gate = *below;
  gate.pNext = NULL;
  gate.zName = "barwright";
  gate.xOpen = gate_open;
  gate.xDelete = gate_delete;
  gate.xAccess = gate_access;
  gate.xDlOpen = gate_load;
  registered = sqlite3_vfs_register(&gate, 0);
}

const char *bwi_gate(void) {
  pthread_once(&once, put_up);
  return registered == SQLITE_OK ? gate.zName : NULL;
}
