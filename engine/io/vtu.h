/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The two layers under the VTU reader: XML tags, and the arrays that they announce. And what the
 * writer takes, for cells of any kind. */
#ifndef BWI_IO_VTU_H
#define BWI_IO_VTU_H

#include "io/raw.h"

/* ---- XML tags (vtu_xml.c): as much of XML as VTK writes; no entities but the five in values  */

enum { BWI_XML_ATTRIBUTES = 24 };
typedef struct bwi_tag {
  bwi_word name;
  bool closing, empty; /* </name>, <name/> */
  int count;
  bwi_word key[BWI_XML_ATTRIBUTES], value[BWI_XML_ATTRIBUTES];
} bwi_tag;
/* The next tag; text, comments and declarations before it are passed over. At the end of the file
 * *any is false. */
bw_status bwi_xml_next(bwi_cursor *cursor, bwi_tag *tag, bool *any);
bwi_word bwi_xml_value(const bwi_tag *tag, const char *key); /* length 0: not there */
void bwi_xml_decode(char *text);                             /* the five entities, in place */

/* ---- arrays (vtu_data.c) ------------------------------------------------------------------- */

typedef enum bwi_vtk_type {
  BWI_VTK_NONE,
  BWI_VTK_I8,
  BWI_VTK_U8,
  BWI_VTK_I16,
  BWI_VTK_U16,
  BWI_VTK_I32,
  BWI_VTK_U32,
  BWI_VTK_I64,
  BWI_VTK_U64,
  BWI_VTK_F32,
  BWI_VTK_F64
} bwi_vtk_type;

typedef struct bwi_vtu_file {
  bool wide;                     /* headers are uint64 */
  bool compressed;               /* by zlib */
  bool base64;                   /* the appended data are */
  const unsigned char *appended; /* behind the underscore; NULL: none */
} bwi_vtu_file;

typedef enum bwi_vtu_form { BWI_VTU_ASCII, BWI_VTU_INLINE, BWI_VTU_APPENDED } bwi_vtu_form;

typedef struct bwi_vtu_array {
  bwi_word name;
  bwi_vtk_type type;
  int64_t columns;
  bwi_vtu_form form;
  uint64_t offset;
  const unsigned char *text; /* behind the tag */
  int64_t line;
} bwi_vtu_array;

static inline bool bwi_vtk_is_real(bwi_vtk_type type) {
  return type >= BWI_VTK_F32;
}
/* `count` numbers as double or int64 in a new block: exactly so many must be there. `finite`: NaN
 * and infinities are refused. */
bw_status bwi_vtu_reals(const bwi_cursor *cursor, const bwi_vtu_file *file,
                        const bwi_vtu_array *array, uint64_t count, bool finite, double **values);
bw_status bwi_vtu_integers(const bwi_cursor *cursor, const bwi_vtu_file *file,
                           const bwi_vtu_array *array, uint64_t count, int64_t **values);

/* How many numbers an array has, by what it says of itself. */
bw_status bwi_vtu_count(const bwi_cursor *cursor, const bwi_vtu_file *file,
                        const bwi_vtu_array *array, uint64_t *count);
/* Arrays of the file with the tag and the name of each region. */
#define BWI_VTU_REGION_TAGS "region_tags"
#define BWI_VTU_REGION_NAMES "region_names"

/* ---- writing (vtu_write.c) ----------------------------------------------------------------- */

typedef struct bwi_vtu_cells {
  int64_t points, cells;
  const double *point;
  int width;    /* points of a cell */
  uint8_t type; /* of VTK */
  const int32_t *cell;
  const int32_t *tag; /* a cell array of this name, or NULL */
  const char *tag_name;
  int field_count;
  const bw_field *fields;
  int32_t region_count; /* 0: no names are written */
  const bw_mesh_region *regions;
} bwi_vtu_cells;
bw_status bwi_vtu_write_cells(bw_context *context, const bwi_vtu_cells *cells, const char *path);
/* The value of an attribute, with entities for what XML does not allow. */
void bwi_vtu_print_text(bw_writer *writer, const char *text);
/* The attributes of an array: type, name, components. `tensor`: six components with names. */
void bwi_vtu_print_attributes(bw_writer *writer, const char *type, const char *name,
                              int64_t columns, bool tensor);
/* Those of a field. */
void bwi_vtu_print_field(bw_writer *writer, const bw_field *field);

/* ---- pieces (pvtu_write.c, pvtu_read.c) ------------------------------------------------------ */

/* A mesh and its fields in pieces along a space-filling curve, so that no more than one piece is
 * packed at a time. Nodes between pieces are in both; their numbers join them. */
bw_status bwi_pvtu_write(bw_context *context, const bw_mesh *mesh, const char *path,
                         int field_count, const bw_field *fields);
/* The pieces that a .pvtu names, put together again: by their numbers of nodes and elements where
 * all have them, else nodes at equal places are one. Elements that a piece has only a copy of are
 * left out. Fields are those that all pieces have. */
bw_status bwi_pvtu_read(bw_context *context, const char *path, const unsigned char *bytes,
                        size_t count, bw_mesh_file *file);
#define BWI_PVTU_GHOST "vtkGhostType" /* of nodes and elements that belong to another piece */
/* Whether a field of this name says how pieces belong together. */
bool bwi_pvtu_joins(const char *name);

#endif
