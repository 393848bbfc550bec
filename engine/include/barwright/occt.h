/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* occt: the library barwright_occt, which reads STEP and IGES by OpenCASCADE. */
#ifndef BARWRIGHT_OCCT_H
#define BARWRIGHT_OCCT_H

#include "barwright/cad.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The reader for bw_cad_register. OpenCASCADE works in a child process with limits, so that a file
 * that crashes it is a failure of the call. */
BW_API bw_cad_reader bw_occt_read;
/* Such as "7.6.3"; it lives as long as the library. */
BW_API const char *bw_occt_version(void);

#ifdef __cplusplus
}
#endif
#endif
