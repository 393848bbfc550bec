/* What the operating system's refusals are called in sentences. */
/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_BASE_WORDS_H
#define BARWRIGHT_BASE_WORDS_H

#include "barwright/base.h"

enum { BWI_WORDS = 160 };
/* What an errno means, as strerror says it; of EFBIG the limit that was met is named. */
const char *bwi_system_words(int code, char text[BWI_WORDS]);
/* BW_IO: "path: doing: " and the words of errno. */
bw_status bwi_fail_system(bw_context *context, const char *path, const char *doing);

#endif
