/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* glTF 2.0: its reader (gltf_read.c) and its writer (gltf_write.c). */
#ifndef BWI_IO_GLTF_H
#define BWI_IO_GLTF_H

#include "barwright/surface_file.h"
#include "io/internal.h"

/* By the mark of .glb, or JSON that has an "asset". */
bool bwi_is_gltf(const bwi_cursor *cursor);
bw_status bwi_gltf_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info);
/* As .glb. */
bw_status bwi_gltf_write(bw_writer *writer, const bw_surface *surface,
                         const bw_surface_write_options *options);

#endif
