/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Points, tetrahedra, facets, fields and named sets as a reader of mesh files meets them. */
#ifndef BWI_IO_RAW_H
#define BWI_IO_RAW_H

#include "io/internal.h"

typedef struct bwi_raw_field {
  char *name;
  bw_field_place place;
  bw_array *array; /* a row per raw point or tetrahedron */
} bwi_raw_field;

typedef struct bwi_raw_set {
  char *name;
  bool of_elements;
  int32_t *member; /* raw points or tetrahedra; may repeat */
  size_t count, capacity;
} bwi_raw_set;

typedef struct bwi_raw {
  bw_context *context;
  const char *name;
  double *point;
  size_t point_count, point_capacity;
  int width; /* nodes of a tetrahedron, 4 or 10; 0: none yet */
  int32_t *tet, *region;
  size_t tet_count, tet_capacity, region_capacity;
  bool regions;          /* some tetrahedron has a tag other than 0 */
  bw_mesh_region *named; /* the names that the file gives to tags */
  size_t named_count, named_capacity;
  int32_t *facet; /* for each: number of corners, group, corners */
  size_t facet_count, facet_used, facet_capacity;
  size_t field_count, field_capacity, set_count, set_capacity;
  bwi_raw_field *field;
  bwi_raw_set *set;
  int64_t skipped;
  int64_t solids; /* of them hexahedra, prisms, pyramids: parts of the body */
} bwi_raw;

/* Sets are looked up one by one. */
enum { BWI_MAX_SETS = 10000 };

void bwi_raw_init(bwi_raw *raw, bw_context *context, const char *name);
void bwi_raw_clear(bwi_raw *raw);
bw_status bwi_raw_point(bwi_raw *raw, const double point[3]);
/* The name of a tag, cut to the bytes that a name may have. */
bw_status bwi_raw_name_region(bwi_raw *raw, int32_t tag, bwi_word name);
/* Names of regions in comments: takes the name that the rest of a line behind '#' may have, and
 * writes a line for each. Names with a line break are left out. */
bw_status bwi_read_region_comment(bwi_cursor *line, bwi_raw *raw);
void bwi_write_region_comments(bw_writer *writer, const bw_mesh *mesh);
/* Node numbers must lie in 0..point_count-1 by the time of bwi_raw_mesh, which relies on it. Order
 * of nodes as in bw_mesh. */
bw_status bwi_raw_tet(bwi_raw *raw, int width, const int32_t *node, int32_t region);
bw_status bwi_raw_facet(bwi_raw *raw, size_t corners, const int32_t *corner, int32_t group);
/* Takes the array over, also on failure. */
bw_status bwi_raw_add_field(bwi_raw *raw, bwi_word name, bw_field_place place, bw_array *array);
/* The set of this name and kind, made when it is not there; *set is its index in raw->set. */
bw_status bwi_raw_find_set(bwi_raw *raw, bwi_word name, bool of_elements, size_t *set);
bw_status bwi_raw_member(bwi_raw *raw, size_t set, int32_t member);

/* Hand over as a mesh (unused points dropped, fields and sets renumbered; an element field of one
 * column called "region" becomes the mesh's), or as a surface: the boundary when there are
 * tetrahedra, else the facets. */
bw_status bwi_raw_mesh(bwi_raw *raw, const char *format, bw_mesh_file *file);
/* The boundary of a mesh that was read. Clears the file. */
bw_status bwi_mesh_file_surface(bw_context *context, bw_mesh_file *file, bw_surface **surface,
                                bw_read_info *info);
bw_status bwi_raw_surface(bwi_raw *raw, const char *format, bw_surface **surface,
                          bw_read_info *info);

/* Numbers that a file gives to its nodes or elements -> 0.. in order of appearance. (ids.c) */
typedef struct bwi_ids {
  size_t count;
  int64_t *id;    /* ascending */
  int32_t *place; /* of id[i]; NULL: id[i] = id[0] + i and index i */
} bwi_ids;
/* Takes `id` (a block of count numbers in file order) over, also on failure. *twice is a number
 * that occurs twice, with BW_FORMAT returned and no message recorded. */
bw_status bwi_ids_build(bw_context *context, int64_t *id, size_t count, bwi_ids *ids,
                        int64_t *twice);
int32_t bwi_ids_find(const bwi_ids *ids, int64_t id); /* -1: there is none */
void bwi_ids_clear(bwi_ids *ids);

/* Readers. They fill raw, and *format with a static string. */
bw_status bwi_vtu_read(bwi_cursor *cursor, bwi_raw *raw, const char **format);
bw_status bwi_msh_read(bwi_cursor *cursor, bwi_raw *raw, const char **format);
bw_status bwi_medit_read(bwi_cursor *cursor, bwi_raw *raw, const char **format);
bw_status bwi_inp_read(bwi_cursor *cursor, bwi_raw *raw, const char **format);
bw_status bwi_tetgen_read(bwi_cursor *node, bwi_cursor *ele, bwi_raw *raw, const char **format);

/* Writers that open and commit on their own. */
bw_status bwi_vtu_write(bw_context *context, const bw_mesh *mesh, const char *path, int field_count,
                        const bw_field *fields);
bw_status bwi_msh41_write(bw_context *context, const bw_mesh *mesh, const char *path,
                          int field_count, const bw_field *fields);
bw_status bwi_tetgen_write(bw_context *context, const bw_mesh *mesh, const char *node_path,
                           const char *ele_path);
bw_status bwi_msh_write_surface(bw_context *context, const bw_surface *surface, const char *path,
                                bool ascii);

/* Fields whose rows fit the mesh; BW_INVALID names the one that does not. (fields.c) */
bw_status bwi_check_fields(bw_context *context, int64_t points, int64_t elements, int field_count,
                           const bw_field *fields);
/* Rows row_from[0], ..., row_from[rows - 1] of an array, as a new one. */
bw_status bwi_array_rows(bw_context *context, const bw_array *from, int64_t rows,
                         const int32_t *row_from, bw_array **out);

#endif
