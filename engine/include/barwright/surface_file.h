/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Files of surfaces with colours: what shows a result in programs that know no fields. */
#ifndef BARWRIGHT_SURFACE_FILE_H
#define BARWRIGHT_SURFACE_FILE_H

#include "barwright/io.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a surface is written; all zeros are the defaults. Pointers are borrowed. */
typedef struct bw_surface_write_options {
  bool ascii;  /* text where the format has both; default false */
  double unit; /* (m) of one unit of the points, which .3mf .usda .step name and .glb needs; default
                  0: 1 */
  const unsigned char *colour; /* (-, 3 each) red, green and blue in sRGB; default NULL: none */
  bool colour_on_facets;       /* one for each facet; default false: for each point */
  int field_count;             /* default 0 */
  const bw_field *fields;      /* (field_count) on points or facets, as numbers */
  bool flat; /* .step: curved faces are written as their flat facets; default false */
} bw_surface_write_options;

/* By the ending of the path, .glb (glTF 2.0, in metres, y up), .usda (USD as text, z up) and .step
 * (solids: chords of a cylinder or cone become a face of it where their group is curved, other
 * facets flat faces) beside those of bw_surface_write. Colours go to .glb .usda .ply .3mf, and on
 * points to .obj. Fields go to .vtu, and those of one component to .ply and .usda; BW_INVALID for
 * another ending, as for colours and fields that the format cannot hold, and units that 3MF or STEP
 * does not know. BW_GEOMETRY where the shells of a .step are not closed and oriented. BW_LIMIT
 * beyond 4 GB. */
BW_API bw_status bw_surface_write_with(bw_context *context, const bw_surface *surface,
                                       const char *path, const bw_surface_write_options *options);

#ifdef __cplusplus
}
#endif
#endif
