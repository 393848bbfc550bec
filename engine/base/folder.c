/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Folders: making them, looking into them. */
#include "barwright/confine.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bw_status refuse(bw_context *context, const char *path, const char *what, int why) {
  bw_fail(context, BW_IO, "%s: %s: %s", path[0] ? path : "(empty name)", what, strerror(why));
  bw_detail_text(context, "file", path);
  return BW_IO;
}

bw_status bw_folder_make(bw_context *context, const char *path) {
  int why = 0;
  size_t length = strlen(path);
  char *part = BW_NEW(context, char, length + 1);
  if (!part)
    return BW_MEMORY;
  memcpy(part, path, length + 1);
  struct stat about;
  for (size_t i = 1; i <= length && !why; i++) {
    if (path[i] != '/' && path[i])
      continue;
    part[i] = 0;
    /* Asked first: making may be refused in a folder that is there (a file system that is only
     * read). What a confined process may not use is not looked for. */
    if (bw_may_use(NULL, part, BW_TO_READ) == BW_OK && stat(part, &about) != 0 &&
        bw_make_folder(part) != 0 && errno != EEXIST)
      why = errno;
    part[i] = path[i];
  }
  bw_free(part);
  bw_status status = bw_may_use(context, path, BW_TO_READ);
  if (status == BW_OK && (stat(path, &about) != 0 || !S_ISDIR(about.st_mode)))
    status = refuse(context, path, "cannot be made as a folder",
                    why      ? why
                    : length ? ENOTDIR
                             : ENOENT);
  return status;
}

bw_status bw_folder_visit(bw_context *context, const char *path, bw_folder_entry *entry,
                          void *data) {
  bw_status status = bw_may_use(context, path, BW_TO_READ);
  if (status != BW_OK)
    return status;
  int file = bw_open(path, O_RDONLY | O_DIRECTORY, 0);
  DIR *folder = file >= 0 ? fdopendir(file) : NULL;
  if (!folder) {
    int why = errno;
    if (file >= 0)
      close(file);
    return refuse(context, path, "cannot be read as a folder", why);
  }
  for (const struct dirent *at; status == BW_OK && (at = readdir(folder));) {
    struct stat about;
    if (strcmp(at->d_name, ".") == 0 || strcmp(at->d_name, "..") == 0 ||
        fstatat(dirfd(folder), at->d_name, &about, AT_SYMLINK_NOFOLLOW) != 0)
      continue;
    status = entry(data, at->d_name, S_ISDIR(about.st_mode), (int64_t)about.st_size,
                   (double)about.st_mtim.tv_sec + 1e-9 * (double)about.st_mtim.tv_nsec);
  }
  closedir(folder);
  return status;
}

bw_status bw_file_touch(bw_context *context, const char *path) {
  bw_status status = bw_may_use(context, path, BW_TO_WRITE);
  if (status != BW_OK)
    return status;
  int file = bw_open(path, O_RDONLY | O_NONBLOCK, 0);
  bool set = file >= 0 && futimens(file, NULL) == 0;
  int why = errno;
  if (file >= 0)
    close(file);
  return set ? BW_OK : refuse(context, path, "its time cannot be set", why);
}
