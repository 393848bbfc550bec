/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Surfaces with colours and fields: one writer per format (see internal.h for those without). */
#ifndef BWI_IO_SURFACE_WRITE_H
#define BWI_IO_SURFACE_WRITE_H

#include "barwright/surface_file.h"
#include "io/internal.h"

/* Of each point its object from 0, and how many there are: groups that share no point, in the order
 * of their first facets; else one. */
bw_status bwi_surface_objects(bw_context *context, const bw_surface *surface, int32_t *object_of,
                              int32_t *count);
/* An sRGB byte as linear light, 0 to 1. */
double bwi_linear_light(unsigned char byte);

bw_status bwi_3mf_write(bw_context *context, const bw_surface *surface, const char *path,
                        const bw_surface_write_options *options);
bw_status bwi_obj_write(bw_writer *writer, const bw_surface *surface,
                        const bw_surface_write_options *options);
bw_status bwi_ply_write(bw_writer *writer, const bw_surface *surface,
                        const bw_surface_write_options *options);
bw_status bwi_step_write(bw_writer *writer, const bw_surface *surface,
                         const bw_surface_write_options *options);
bw_status bwi_usd_write(bw_writer *writer, const bw_surface *surface,
                        const bw_surface_write_options *options);

#endif
