/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* occt: the library barwright_occt, which reads STEP and IGES by OpenCASCADE. */
#ifndef BARWRIGHT_OCCT_H
#define BARWRIGHT_OCCT_H

#include "barwright/cad.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The reader for bw_cad_register, with the statuses of bw_cad_reader; BW_FORMAT also where the
 * child process crashes. OpenCASCADE works in a child process with limits, so that a file
 * that crashes it is a failure of the call. */
BW_API bw_status bw_occt_read(bw_context *context, const char *name, const unsigned char *bytes,
                              size_t count, const bw_cad_options *options, bw_cad_file *file);
/* Such as "7.6.3"; it lives as long as the library. */
BW_API const char *bw_occt_version(void);

#ifdef __cplusplus
}
#endif
#endif
