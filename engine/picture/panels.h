/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Between the files of pictures of grids. */
#ifndef BW_PICTURE_PANELS_H
#define BW_PICTURE_PANELS_H

#include "picture/internal.h"

typedef struct bwi_panel_sheet {
  bw_context *context;
  const bw_grid_picture_options *options;
  int count, columns, rows;
  const bw_grid_panel *panel;
  bwi_solid (*solid)[2]; /* body, ghost */
  int32_t **category;    /* of facets; owned here */
  double **value;        /* of facets, where values are of elements; owned here */
  int32_t max_material;
  bool valued, missing;
  double min, max, value_min, value_max; /* of the colours, of the values */
  bwi_view view;
  int wide, high_pixels;     /* of the canvas */
  double u, head, foot, bar; /* a pixel of a 640 x 560 panel; strips above, below, to the right */
} bwi_panel_sheet;

/* Fills solid, category and value of one panel. What was made on failure stays the sheet's. */
bw_status bwi_panel_solids(bwi_panel_sheet *s, int which);

#endif
