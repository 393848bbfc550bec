/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* One input through the readers, as the fuzzers and the replay test do it. What comes back is
 * either an object or a failure with a message; either way nothing may be left. */
#ifndef PARSE_BYTES_H
#define PARSE_BYTES_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "barwright/matrix.h"
#include "fill_bytes.h"
#include "io/raw.h"
#include "metamaterial/library.h"
#include "parse_check.h"
#include "shape/internal.h"

static inline bw_status parse_surface(const char *name, const unsigned char *bytes, size_t count) {
  bw_context *context = parse_context();
  bw_surface *surface = NULL;
  bw_read_info info = {0};
  bw_status status = bw_surface_parse(context, name, bytes, count, &surface, &info);
  parse_require((status == BW_OK) == (surface != NULL));
  parse_require(status == BW_OK || bw_message(context)[0]);
  parse_require(!surface || surface->triangle_count > 0);
  bw_release(surface);
  bw_free(info.group_name);
  return status;
}

static inline bw_status parse_mesh(const char *name, const unsigned char *bytes, size_t count) {
  bw_context *context = parse_context();
  bw_mesh_file file;
  bw_status status = bw_mesh_parse(context, name, bytes, count, &file);
  parse_require((status == BW_OK) == (file.mesh != NULL));
  parse_require(status == BW_OK || bw_message(context)[0]);
  for (int i = 0; file.mesh && i < file.field_count; i++)
    parse_require(
        file.field_array[i]->rows ==
        (file.field_place[i] == BW_ON_NODES ? file.mesh->node_count : file.mesh->element_count));
  for (int i = 0; file.mesh && i < file.set_count; i++)
    for (int64_t k = 0; k < file.set[i].count; k++)
      parse_require(file.set[i].member[k] >= 0 &&
                    file.set[i].member[k] < (file.set[i].of_elements ? file.mesh->element_count
                                                                     : file.mesh->node_count));
  bw_mesh_file_clear(&file);
  return status;
}

/* TetGen's two files in one: .node, a line "----", .ele. */
static inline bw_status parse_tetgen(const unsigned char *bytes, size_t count) {
  static const char mark[] = "----\n";
  const unsigned char *cut = count ? memmem(bytes, count, mark, sizeof mark - 1) : NULL;
  bw_context *context = parse_context();
  bwi_cursor node, ele;
  bwi_raw raw;
  bw_mesh_file file;
  const char *format;
  size_t first = cut ? (size_t)(cut - bytes) : count;
  bwi_cursor_init(&node, context, "a.node", bytes, first);
  bwi_cursor_init(&ele, context, "a.ele", cut ? cut + sizeof mark - 1 : bytes,
                  cut ? count - first - (sizeof mark - 1) : 0);
  bwi_raw_init(&raw, context, "a.node");
  memset(&file, 0, sizeof file);
  bw_status status = bwi_tetgen_read(&node, &ele, &raw, &format);
  if (status == BW_OK)
    status = bwi_raw_mesh(&raw, format, &file);
  parse_require(status == BW_OK || bw_message(context)[0]);
  bwi_raw_clear(&raw);
  bw_mesh_file_clear(&file);
  return status;
}

static inline void parse_skeleton(const unsigned char *bytes, size_t count) {
  bw_context *context = parse_context();
  bw_skeleton *skeleton = NULL;
  bw_status status = bwi_tgf_parse(context, "a.tgf", bytes, count, 1e-3, &skeleton);
  parse_require((status == BW_OK) == (skeleton != NULL));
  parse_require(status == BW_OK || bw_message(context)[0]);
  for (int32_t b = 0; skeleton && b < skeleton->bone_count; b++)
    parse_require(skeleton->parent[b] < b &&
                  skeleton->bone[2 * b] == (skeleton->parent[b] < 0
                                                ? skeleton->root
                                                : skeleton->bone[2 * skeleton->parent[b] + 1]));
  bw_release(skeleton);
}

static inline void parse_outline(const char *name, const unsigned char *bytes, size_t count) {
  bw_context *context = parse_context();
  bw_outline *outline = NULL;
  bw_status status = bw_outline_parse(context, name, bytes, count, NULL, &outline, NULL);
  parse_require((status == BW_OK) == (outline != NULL));
  parse_require(status == BW_OK || bw_message(context)[0]);
  for (int32_t s = 0; outline && s < outline->segment_count; s++)
    parse_require(outline->segment[s].point[0] >= 0 &&
                  outline->segment[s].point[0] < outline->point_count &&
                  outline->segment[s].tag < outline->tag_count);
  bw_release(outline);
}

/* A whole file, whose checksums stop most damage; then the bytes as its sections, unpacked: each
 * behind its length in four bytes. */
static inline void parse_library(const unsigned char *bytes, size_t count) {
  bw_context *context = parse_context();
  bw_library *library = NULL;
  bwi_file_section section[BWI_SECTIONS] = {{bytes, 0}};
  for (int way = 0; way < 2; way++) {
    bw_status status = way ? bwi_library_of_sections(context, "a.bwm", section, &library)
                           : bw_library_parse(context, "a.bwm", bytes, count, &library);
    parse_require((status == BW_OK) == (library != NULL));
    parse_require(status == BW_OK || bw_message(context)[0]);
    if (library) {
      const int32_t key[64] = {1};
      bw_solid_material *material = NULL;
      char *text;
      parse_require(bw_library_describe(context, library, &text) == BW_OK);
      bw_free(text);
      for (int level = 1; level <= library->levels; level++) {
        parse_require(bw_library_material(context, library, level, key, &material, NULL) == BW_OK);
        bw_release(material);
      }
    }
    bw_release(library);
    library = NULL;
    for (size_t s = 0, at = 0; s < BWI_SECTIONS; s++) {
      size_t length = 0;
      for (size_t i = 0; i < 4 && at < count; i++)
        length |= (size_t)bytes[at++] << 8 * i;
      section[s].bytes = bytes + at;
      section[s].count = length < count - at ? length : count - at;
      at += section[s].count;
    }
  }
}

/* As a sparse matrix and as an array; the content says which it is. */
static inline void parse_matrix(const unsigned char *bytes, size_t count) {
  bw_context *context = parse_context();
  bw_sparse_matrix *matrix = NULL;
  bw_array *array = NULL;
  bw_status status = bw_sparse_matrix_parse(context, "a.mtx", bytes, count, &matrix);
  parse_require((status == BW_OK) == (matrix != NULL));
  parse_require(status == BW_OK || bw_message(context)[0]);
  for (int32_t i = 0; matrix && i < matrix->rows; i++)
    for (int64_t k = matrix->start[i]; k < matrix->start[i + 1]; k++)
      parse_require(matrix->column[k] >= 0 && matrix->column[k] < matrix->columns &&
                    (k == matrix->start[i] || matrix->column[k] > matrix->column[k - 1]));
  bw_release(matrix);
  status = bw_array_parse(context, "a.npy", bytes, count, &array);
  parse_require((status == BW_OK) == (array != NULL));
  parse_require(status == BW_OK || bw_message(context)[0]);
  bw_release(array);
}

/* By the name of the format: "stl", "msh", ... The bytes are copied to a block of their exact
 * size, so that the address sanitizer sees a read past the end. */
static inline void parse_bytes(const char *format, const unsigned char *bytes, size_t count) {
  char name[32];
  unsigned char *copy = malloc(count ? count : 1);
  parse_require(copy != NULL);
  if (count)
    memcpy(copy, bytes, count);
  int64_t blocks = bw_live_blocks();
  parse_context();
  blocks = bw_live_blocks() > blocks ? bw_live_blocks() : blocks;
  snprintf(name, sizeof name, "a.%s", strcmp(format, "medit") == 0 ? "mesh" : format);
  if (strcmp(format, "tetgen") == 0) {
    parse_tetgen(copy, count);
  } else if (strcmp(format, "tgf") == 0) {
    parse_skeleton(copy, count);
  } else if (strcmp(format, "svg") == 0 || strcmp(format, "dxf") == 0) {
    parse_outline(name, copy, count);
  } else if (strcmp(format, "bwm") == 0) {
    parse_library(copy, count);
  } else if (strcmp(format, "matrix") == 0) {
    parse_matrix(copy, count);
  } else if (strcmp(format, "plane") == 0) {
    fill_bytes(copy, count);
  } else {
    parse_surface(name, copy, count);
    bool surface_only = strcmp(format, "stl") == 0 || strcmp(format, "obj") == 0 ||
                        strcmp(format, "off") == 0 || strcmp(format, "ply") == 0 ||
                        strcmp(format, "3mf") == 0 || strcmp(format, "gltf") == 0;
    if (!surface_only)
      parse_mesh(name, copy, count);
  }
  bw_clear_warnings(parse_context());
  parse_require(bw_live_blocks() <= blocks);
  free(copy);
}

#endif
