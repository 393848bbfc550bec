/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Helpers of the tests of file formats. */
#ifndef IO_CHECK_H
#define IO_CHECK_H

#include "check.h"

#include <unistd.h>

/* A path for a file of this test program, in $TMPDIR or /tmp. */
static inline const char *temporary(char path[300], const char *name) {
  const char *folder = getenv("TMPDIR");
  snprintf(path, 300, "%s/barwright-io-%ld-%s", folder ? folder : "/tmp", (long)getpid(), name);
  return path;
}

/* The path of a shared file; false when it is not there. */
static inline bool shared_file(char path[400], const char *folder, const char *name) {
  const char *root = getenv("BARWRIGHT_SHARED");
  snprintf(path, 400, "%s/%s/%s", root ? root : "../shared", folder, name);
  return access(path, R_OK) == 0;
}

static inline bw_status parse_text(bw_context *context, const char *name, const char *text,
                                   bw_surface **surface, bw_read_info *info) {
  return bw_surface_parse(context, name, (const unsigned char *)text, strlen(text), surface, info);
}

#endif
