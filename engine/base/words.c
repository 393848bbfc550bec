/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the operating system's refusals are called in sentences. */
#include "base/words.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

const char *bwi_system_words(int code, char text[BWI_WORDS]) {
  struct rlimit sizes;
  if (code != EFBIG)
    return strerror_r(code, text, BWI_WORDS);
  if (getrlimit(RLIMIT_FSIZE, &sizes) == 0 && sizes.rlim_cur != RLIM_INFINITY)
    snprintf(text, BWI_WORDS,
             "the file may not grow beyond %llu bytes, a limit on the size of files (ulimit -f)",
             (unsigned long long)sizes.rlim_cur);
  else
    snprintf(text, BWI_WORDS, "the file may not grow further: its file system has no larger ones");
  return text;
}

bw_status bwi_fail_system(bw_context *context, const char *path, const char *doing) {
  char text[BWI_WORDS];
  bw_fail(context, BW_IO, "%s: %s: %s", path, doing, bwi_system_words(errno, text));
  bw_detail_text(context, "file", path);
  return BW_IO;
}
