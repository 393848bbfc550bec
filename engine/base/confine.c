/* Which files the process may use once it is confined to a folder.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Invariants: the roots are written before confined is set, and never after that; what is allowed
 * can only become less. A path is checked by where it leads with every link followed, and what does
 * not exist yet by its folder. bw_open and its relatives check by themselves, and then go down to
 * that place folder by folder without following any link. So what is checked is what is opened,
 * also where another process moves links about in the meantime. */
#include "barwright/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ROOTS = 12 };

static struct {
  int confined;
  char folder[PATH_MAX];      /* read and written */
  char root[ROOTS][PATH_MAX]; /* read only: folders with what is below them, or files */
  int roots;
} gate;

bool bw_confined(void) {
  return __atomic_load_n(&gate.confined, __ATOMIC_ACQUIRE) != 0;
}

const char *bw_confined_to(void) {
  return bw_confined() ? gate.folder : NULL;
}

bw_status bw_confine_read_also(bw_context *context, const char *path) {
  if (bw_confined())
    return bw_fail(context, BW_INVALID, "the process is confined: nothing can be added");
  char real[PATH_MAX];
  if (!realpath(path, real))
    return bw_fail(context, BW_IO, "%s: %s", path, strerror(errno));
  for (int i = 0; i < gate.roots; i++)
    if (strcmp(gate.root[i], real) == 0)
      return BW_OK;
  if (gate.roots == ROOTS)
    return bw_fail(context, BW_LIMIT, "%s: more than %d folders or files to read from", path,
                   (int)ROOTS);
  memcpy(gate.root[gate.roots++], real, sizeof real);
  return BW_OK;
}

bw_status bw_confine(bw_context *context, const char *folder) {
  if (bw_confined())
    return bw_fail(context, BW_INVALID, "the process is confined already");
  struct stat about;
  if (!realpath(folder, gate.folder))
    return bw_fail(context, BW_IO, "%s: %s", folder, strerror(errno));
  if (stat(gate.folder, &about) != 0 || !S_ISDIR(about.st_mode))
    return bw_fail(context, BW_IO, "%s: a folder expected", folder);
  __atomic_store_n(&gate.confined, 1, __ATOMIC_RELEASE);
  return BW_OK;
}

static bool lies_in(const char *path, const char *root) {
  size_t length = strlen(root);
  if (length == 1 && root[0] == '/')
    return true;
  return strncmp(path, root, length) == 0 && (path[length] == '/' || path[length] == 0);
}

/* Where the path leads: all links followed. Of the last name only where `follow`, and where it is
 * there at all: a new file, or a link to be renamed or removed, is checked by its folder. */
static bool resolve(const char *path, bool follow, char real[PATH_MAX]) {
  struct stat link;
  size_t length = strlen(path);
  if (length == 0 || length >= PATH_MAX)
    return false;
  if (follow && realpath(path, real))
    return true;
  if (follow && (errno != ENOENT || lstat(path, &link) == 0)) /* a link that leads nowhere */
    return false;
  char folder[PATH_MAX];
  memcpy(folder, path, length + 1);
  while (length > 1 && folder[length - 1] == '/')
    folder[--length] = 0;
  char *slash = strrchr(folder, '/');
  const char *name = slash ? slash + 1 : folder;
  char last[NAME_MAX + 1];
  if (!name[0] || strcmp(name, ".") == 0 || strcmp(name, "..") == 0 || strlen(name) > NAME_MAX)
    return false;
  memcpy(last, name, strlen(name) + 1);
  if (slash == folder)
    folder[1] = 0;
  else if (slash)
    *slash = 0;
  if (!realpath(slash ? folder : ".", real))
    return false;
  length = strlen(real);
  if (length + 1 + strlen(last) + 1 > PATH_MAX)
    return false;
  snprintf(real + length, PATH_MAX - length, "%s%s", length > 1 ? "/" : "", last);
  return true;
}

/* Whether a path may be used, and where it leads. */
static bool allowed(const char *path, bw_use use, char real[PATH_MAX]) {
  if (!resolve(path, use != BW_TO_REPLACE, real))
    return false;
  bool inside = lies_in(real, gate.folder);
  for (int i = 0; i < gate.roots && !inside && use == BW_TO_READ; i++)
    inside = lies_in(real, gate.root[i]);
  /* The folder itself can be looked at, not taken away. */
  return inside && !(use == BW_TO_REPLACE && strcmp(real, gate.folder) == 0);
}

bw_status bw_may_use(bw_context *context, const char *path, bw_use use) {
  char real[PATH_MAX];
  if (!bw_confined() || allowed(path, use, real))
    return BW_OK;
  bw_status status =
      bw_fail(context, BW_IO, "%s: refused in the sandbox, which %s only what lies in %s",
              path[0] ? path : "(empty name)", use == BW_TO_READ ? "reads" : "writes", gate.folder);
  bw_detail_text(context, "file", path);
  bw_detail_text(context, "sandbox", gate.folder);
  return status;
}

bw_status bw_may_start(bw_context *context, const char *what) {
  if (!bw_confined())
    return BW_OK;
  bw_status status = bw_fail(context, BW_UNSUPPORTED, "%s: refused in the sandbox", what);
  bw_detail_text(context, "sandbox", gate.folder);
  return status;
}

/* ---- opening, making, removing --------------------------------------------------------------- */

/* Opens the folder in which a real path lies, without following a link; *name is what follows it
 * there. -1 and errno where that is not possible. */
static int open_parent(const char *path, bw_use use, char real[PATH_MAX], const char **name) {
  if (!allowed(path, use, real)) {
    errno = EACCES;
    return -1;
  }
  int at = open("/", O_PATH | O_DIRECTORY | O_CLOEXEC);
  char *part = real + 1, *slash;
  for (; at >= 0 && (slash = strchr(part, '/')); part = slash + 1) {
    *slash = 0;
    int next = openat(at, part, O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC), why = errno;
    close(at);
    at = next;
    errno = why;
  }
  *name = *part ? part : ".";
  return at;
}

static int close_after(int folder, int result) {
  int why = errno;
  if (folder >= 0)
    close(folder);
  errno = why;
  return folder < 0 ? -1 : result;
}

int bw_open(const char *path, int flags, unsigned mode) {
  if (!bw_confined())
    return open(path, flags | O_CLOEXEC, (mode_t)mode);
  char real[PATH_MAX];
  const char *name;
  bool reads = (flags & O_ACCMODE) == O_RDONLY && !(flags & (O_CREAT | O_TRUNC));
  int folder = open_parent(path, reads ? BW_TO_READ : BW_TO_WRITE, real, &name);
  return close_after(
      folder, folder < 0 ? -1 : openat(folder, name, flags | O_CLOEXEC | O_NOFOLLOW, (mode_t)mode));
}

int bw_make_folder(const char *path) {
  if (!bw_confined())
    return mkdir(path, 0777);
  char real[PATH_MAX];
  const char *name;
  int folder = open_parent(path, BW_TO_WRITE, real, &name);
  return close_after(folder, folder < 0 ? -1 : mkdirat(folder, name, 0777));
}

int bw_remove(const char *path) {
  if (!bw_confined())
    return remove(path);
  char real[PATH_MAX];
  const char *name;
  int folder = open_parent(path, BW_TO_REPLACE, real, &name);
  int result = folder < 0 ? -1 : unlinkat(folder, name, 0);
  if (result != 0 && folder >= 0 && errno == EISDIR)
    result = unlinkat(folder, name, AT_REMOVEDIR);
  return close_after(folder, result);
}

int bw_rename(const char *from, const char *to) {
  if (!bw_confined())
    return rename(from, to);
  char real[2][PATH_MAX];
  const char *name[2];
  int old = open_parent(from, BW_TO_REPLACE, real[0], &name[0]);
  int new = old < 0 ? -1 : open_parent(to, BW_TO_REPLACE, real[1], &name[1]);
  return close_after(old, close_after(new, new < 0 ? -1 : renameat(old, name[0], new, name[1])));
}
