/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* 3MF: what its reader keeps of a file before objects are put where they are built. */
#ifndef BWI_IO_THREEMF_H
#define BWI_IO_THREEMF_H

#include "io/internal.h"

/* An object put somewhere: a component of another object, or an item of what is built. */
typedef struct bwi_3mf_use {
  int64_t id, line;
  int part;             /* the member of the archive that has the object */
  double transform[12]; /* rows: the images of the axes, then of the origin */
} bwi_3mf_use;

typedef struct bwi_3mf_object {
  int64_t id;
  int part;
  bool ignored;  /* supports of a printer and the like */
  int open;      /* while its components are followed */
  bool counted;  /* `facets` is known */
  double facets; /* with all components */
  bw_name name;
  size_t first_point, point_count, first_facet, facet_count, first_use, use_count;
} bwi_3mf_object;

enum { BWI_3MF_PARTS = 256, BWI_3MF_DEPTH = 64 };

typedef struct bwi_3mf {
  bw_context *context;
  const char *name;
  double unit; /* (m) of the root model; 0: not read yet */
  bool any_item;
  int part_count; /* members that hold models: the root first */
  char *part[BWI_3MF_PARTS];
  bwi_3mf_object *object;
  size_t object_count, object_capacity;
  double *point;
  size_t point_count, point_capacity;
  int32_t *facet;
  size_t facet_count, facet_capacity;
  bwi_3mf_use *use;
  size_t use_count, use_capacity;
  bwi_3mf_use *item;
  size_t item_count, item_capacity;
  bw_name *group_name; /* of what was placed */
  size_t name_count, name_capacity;
  int64_t skipped;
  size_t bytes; /* of all models, unpacked */
} bwi_3mf;

/* One model (threemf_model.c): objects and items are added. */
bw_status bwi_3mf_model(bwi_cursor *cursor, int part, bwi_3mf *file);

#endif
