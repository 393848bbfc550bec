/* What studies stand on: files of results, points that fill a cube evenly, minimisers.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_STUDY_H
#define BARWRIGHT_STUDY_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __cplusplus
}
#endif
#endif
