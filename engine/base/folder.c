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
  bw_status status = BW_OK;
  size_t length = strlen(path);
  char *part = BW_NEW(context, char, length + 1);
  if (!part)
    return BW_MEMORY;
  memcpy(part, path, length + 1);
  struct stat about;
  for (size_t i = 1; i <= length && status == BW_OK; i++) {
    if (path[i] != '/' && path[i])
      continue;
    part[i] = 0;
    /* Asked first: making may be refused in a folder that is there (a file system that is only
     * read). */
    if (stat(part, &about) == 0)
      ;
    else if ((status = bw_may_use(context, part, BW_TO_WRITE)) == BW_OK && mkdir(part, 0777) != 0 &&
             errno != EEXIST)
      status = refuse(context, path, "cannot be made as a folder", errno);
    part[i] = path[i];
  }
  if (status == BW_OK)
    status = bw_may_use(context, path, BW_TO_READ);
  if (status == BW_OK && (stat(path, &about) != 0 || !S_ISDIR(about.st_mode)))
    status = refuse(context, path, "cannot be made as a folder", length ? ENOTDIR : ENOENT);
  bw_free(part);
  return status;
}

bw_status bw_folder_visit(bw_context *context, const char *path, bw_folder_entry *entry,
                          void *data) {
  bw_status status = bw_may_use(context, path, BW_TO_READ);
  if (status != BW_OK)
    return status;
  DIR *folder = opendir(path);
  if (!folder)
    return refuse(context, path, "cannot be read as a folder", errno);
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
  if (utimensat(AT_FDCWD, path, NULL, 0) != 0)
    return refuse(context, path, "its time cannot be set", errno);
  return BW_OK;
}
