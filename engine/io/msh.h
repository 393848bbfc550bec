/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The state of a reader of Gmsh files. Text and binary differ only in how one number is read, so
 * both go through bwi_msh_int, _size and _real. */
#ifndef BWI_IO_MSH_H
#define BWI_IO_MSH_H

#include "io/raw.h"

typedef struct bwi_msh_group { /* a physical group; several elements' tags lead to it */
  int64_t dimension, tag;
  bwi_word name; /* length 0: none was given */
  bool has_set;
  size_t set;
} bwi_msh_group;

typedef struct bwi_msh_entity { /* version 4.1: what a geometric entity's physical groups are */
  int64_t dimension, tag;
  size_t first, count; /* in physical */
} bwi_msh_entity;

typedef struct bwi_msh {
  bwi_cursor *cursor;
  bwi_raw *raw;
  bool binary;
  bwi_ids nodes, elements; /* elements: the tetrahedra only */
  int64_t *tet_id;
  size_t tet_capacity;
  bwi_msh_group *group;
  size_t group_count, group_capacity, last_group;
  bwi_msh_entity *entity;
  size_t entity_count, entity_capacity, last_entity;
  int64_t *physical;
  size_t physical_count, physical_capacity;
} bwi_msh;

bw_status bwi_msh_int(bwi_msh *msh, int64_t *value, const char *what);  /* int32 when binary */
bw_status bwi_msh_size(bwi_msh *msh, int64_t *value, const char *what); /* uint64 when binary */
bw_status bwi_msh_real(bwi_msh *msh, double *value, const char *what);
/* A count that the rest of the file must be able to hold: `text` or `binary` bytes each. */
bw_status bwi_msh_check(bwi_msh *msh, int64_t count, size_t text, size_t binary, const char *what);
bw_status bwi_msh_fail(bwi_msh *msh, const char *format, ...) BW_PRINTF(2, 3);

/* The group of a dimension and a tag, a new one where there is none. */
bw_status bwi_msh_find_group(bwi_msh *msh, int64_t dimension, int64_t tag, bwi_msh_group **group);
/* Nodes of an element type; 0: the type is not known. */
int bwi_msh_width(int64_t type);
/* One element with node tags and physical groups (tag 0 is none). */
bw_status bwi_msh_element(bwi_msh *msh, int64_t id, int64_t type, const int64_t *node,
                          const int64_t *physical, size_t physical_count);
/* Node tags in file order, a block of bw_alloc that is taken over. */
bw_status bwi_msh_nodes_done(bwi_msh *msh, int64_t *id, size_t count);

bw_status bwi_msh22_nodes(bwi_msh *msh);
bw_status bwi_msh22_elements(bwi_msh *msh);
bw_status bwi_msh41_entities(bwi_msh *msh);
bw_status bwi_msh41_nodes(bwi_msh *msh);
bw_status bwi_msh41_elements(bwi_msh *msh);

#endif
