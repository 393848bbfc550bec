/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* PVTU: a mesh in pieces, each a VTU file of its own, and a file that names them and their arrays.
 * Programs read the pieces side by side, and the writer packs one after another: what it needs
 * beside the mesh does not grow with it.
 *
 * A piece is a run of elements along a space-filling curve, so that few nodes are in two pieces.
 * The cut depends on the mesh alone. Pieces are written before the file that names them: who
 * finds that file finds all of them. An older one is emptied first, as its pieces are replaced. */
#include "io/raw.h"
#include "io/vtu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

enum { PIECE_ELEMENTS = 100000 };

typedef struct pieces {
  bw_context *context;
  const bw_mesh *mesh;
  const char *path;
  int count, field_count;
  const bw_field *fields;
  int32_t *along;                    /* elements, along the curve */
  int32_t *node, node_count, *local; /* of the piece: of the mesh; mesh node -> its own, or -1 */
  const int32_t *element;            /* of the piece, in `along` */
  int64_t element_count;
} pieces;

static int64_t begin_of(const pieces *p, int k) {
  return (int64_t)p->mesh->element_count * k / p->count;
}

bw_status bw_pvtu_piece_path(bw_context *context, const char *path, int piece, char **piece_path) {
  static const char ending[] = ".pvtu";
  size_t length = strlen(path), size = length + 24;
  if (length < strlen(ending) || strcasecmp(path + length - strlen(ending), ending) != 0)
    return bw_fail(context, BW_INVALID, "%s: the path of a file in pieces ends in %s", path,
                   ending);
  char *name = *piece_path = BW_NEW(context, char, size);
  if (!name)
    return BW_MEMORY;
  snprintf(name, size, "%.*s_%d.vtu", (int)(length - strlen(ending)), path, piece);
  return BW_OK;
}

static void find_nodes(pieces *p, int k) {
  int width = p->mesh->nodes_per_element;
  p->element = p->along + begin_of(p, k);
  p->element_count = begin_of(p, k + 1) - begin_of(p, k);
  p->node_count = 0;
  for (int64_t e = 0; e < p->element_count; e++)
    for (int a = 0; a < width; a++) {
      int32_t i = p->mesh->element[(int64_t)p->element[e] * width + a];
      if (p->local[i] < 0) {
        p->local[i] = p->node_count;
        p->node[p->node_count++] = i;
      }
    }
}

static bw_status numbers(bw_context *context, int64_t count, const int32_t *number,
                         bw_array **array) {
  bw_status status = bw_array_create(context, BW_I64, count, 1, array);
  for (int64_t i = 0; status == BW_OK && i < count; i++)
    ((int64_t *)(*array)->data)[i] = number[i];
  return status;
}

/* The rows of all fields that belong to the piece, and the numbers of its nodes and elements. */
static bw_status cut_fields(pieces *p, bw_field *field, bw_array **array) {
  bw_status status = BW_OK;
  int n = p->field_count;
  for (int i = 0; i < n; i++) {
    bool nodes = p->fields[i].place == BW_ON_NODES;
    BW_TRY(bwi_array_rows(p->context, p->fields[i].array, nodes ? p->node_count : p->element_count,
                          nodes ? p->node : p->element, &array[i]));
    field[i] = (bw_field){p->fields[i].name, p->fields[i].place, array[i]};
  }
  BW_TRY(numbers(p->context, p->node_count, p->node, &array[n]));
  field[n] = (bw_field){BW_PVTU_NODE, BW_ON_NODES, array[n]};
  BW_TRY(numbers(p->context, p->element_count, p->element, &array[n + 1]));
  field[n + 1] = (bw_field){BW_PVTU_ELEMENT, BW_ON_ELEMENTS, array[n + 1]};
done:
  return status;
}

static bw_status write_piece(pieces *p, int k) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = p->mesh;
  int width = mesh->nodes_per_element, fields = p->field_count + 2;
  char *name = NULL;
  find_nodes(p, k);
  double *point = BW_NEW(p->context, double, 3 * (int64_t)p->node_count);
  int32_t *cell = BW_NEW(p->context, int32_t, p->element_count * width);
  int32_t *region = mesh->region ? BW_NEW(p->context, int32_t, p->element_count) : NULL;
  bw_field *field = BW_NEW0(p->context, bw_field, fields);
  bw_array **array = BW_NEW0(p->context, bw_array *, fields);
  BW_TRY_MEMORY(point && cell && (!mesh->region || region) && field && array);
  BW_TRY(bw_pvtu_piece_path(p->context, p->path, k, &name));
  for (int32_t i = 0; i < p->node_count; i++)
    memcpy(point + 3 * (int64_t)i, mesh->node + 3 * (int64_t)p->node[i], 3 * sizeof *point);
  for (int64_t e = 0; e < p->element_count; e++) {
    for (int a = 0; a < width; a++)
      cell[e * width + a] = p->local[mesh->element[(int64_t)p->element[e] * width + a]];
    if (region)
      region[e] = mesh->regions[mesh->region[p->element[e]]].tag;
  }
  BW_TRY(cut_fields(p, field, array));
  bwi_vtu_cells g = {.points = p->node_count,
                     .cells = p->element_count,
                     .point = point,
                     .width = width,
                     .type = mesh->order == 2 ? 24 : 10,
                     .cell = cell,
                     .tag = region,
                     .tag_name = "region",
                     .field_count = fields,
                     .fields = field,
                     .region_count = mesh->region_count,
                     .regions = mesh->regions};
  status = bwi_vtu_write_cells(p->context, &g, name);
done:
  for (int32_t i = 0; i < p->node_count; i++)
    p->local[p->node[i]] = -1;
  for (int i = 0; array && i < fields; i++)
    bw_release(array[i]);
  bw_free(array);
  bw_free(field);
  bw_free(region);
  bw_free(cell);
  bw_free(point);
  bw_free(name);
  return status;
}

static void print_fields(bw_writer *writer, int count, const bw_field *fields,
                         bw_field_place place) {
  for (int i = 0; i < count; i++)
    if (fields[i].place == place) {
      bw_writer_print(writer, "<PDataArray ");
      bwi_vtu_print_field(writer, &fields[i]);
      bw_writer_print(writer, "/>\n");
    }
}

static void print_array(bw_writer *writer, const char *type, const char *name, int64_t columns) {
  bw_writer_print(writer, "<PDataArray ");
  bwi_vtu_print_attributes(writer, type, name, columns, false);
  bw_writer_print(writer, "/>\n");
}

/* Pieces are named by paths relative to that of the file. */
bw_status bw_pvtu_write_index(bw_context *context, const char *path, int piece_count, bool regions,
                              int field_count, const bw_field *fields) {
  bw_writer *writer;
  bw_status status = bw_writer_open(context, path, &writer);
  if (status != BW_OK)
    return status;
  const bool big = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
  bw_writer_print(writer,
                  "<?xml version=\"1.0\"?>\n"
                  "<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" "
                  "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
                  "<PUnstructuredGrid GhostLevel=\"0\">\n<PPoints>\n",
                  big ? "BigEndian" : "LittleEndian");
  print_array(writer, "Float64", "Points", 3);
  bw_writer_print(writer, "</PPoints>\n<PPointData GlobalIds=\"" BW_PVTU_NODE "\">\n");
  print_fields(writer, field_count, fields, BW_ON_NODES);
  print_array(writer, "Int64", BW_PVTU_NODE, 1);
  bw_writer_print(writer, "</PPointData>\n<PCellData GlobalIds=\"" BW_PVTU_ELEMENT "\">\n");
  if (regions)
    print_array(writer, "Int32", "region", 1);
  print_fields(writer, field_count, fields, BW_ON_ELEMENTS);
  print_array(writer, "Int64", BW_PVTU_ELEMENT, 1);
  bw_writer_print(writer, "</PCellData>\n");
  for (int k = 0; k < piece_count; k++) {
    char *name = NULL;
    status = bw_pvtu_piece_path(context, path, k, &name);
    if (status != BW_OK) {
      bw_writer_discard(writer);
      return status;
    }
    const char *slash = strrchr(name, '/');
    bw_writer_print(writer, "<Piece Source=\"");
    bwi_vtu_print_text(writer, slash ? slash + 1 : name);
    bw_writer_print(writer, "\"/>\n");
    bw_free(name);
  }
  bw_writer_print(writer, "</PUnstructuredGrid>\n</VTKFile>\n");
  return bw_writer_commit(writer);
}

bw_status bw_pvtu_empty(bw_context *context, const char *path) {
  struct stat old;
  if (stat(path, &old) != 0 || !S_ISREG(old.st_mode))
    return BW_OK;
  return bw_pvtu_write_index(context, path, 0, false, 0, NULL);
}

bw_status bwi_pvtu_write(bw_context *context, const bw_mesh *mesh, const char *path,
                         int field_count, const bw_field *fields) {
  bw_status status = BW_OK;
  pieces p = {.context = context,
              .mesh = mesh,
              .path = path,
              .count = (mesh->element_count + PIECE_ELEMENTS - 1) / PIECE_ELEMENTS,
              .field_count = field_count,
              .fields = fields};
  BW_TRY(bwi_check_fields(context, mesh->node_count, mesh->element_count, field_count, fields));
  for (int i = 0; i < field_count; i++)
    if (bwi_pvtu_joins(fields[i].name))
      return bw_fail(context, BW_INVALID,
                     "%s: a field named '%s', by which pieces are joined: give it another name",
                     path, fields[i].name);
  BW_TRY(bw_mesh_curve_order(context, mesh, &p.along));
  p.local = BW_NEW(context, int32_t, mesh->node_count);
  p.node = BW_NEW(context, int32_t, mesh->node_count);
  BW_TRY_MEMORY(p.local && p.node);
  memset(p.local, 0xff, (size_t)mesh->node_count * sizeof *p.local);
  BW_TRY(bw_pvtu_empty(context, path));
  for (int k = 0; k < p.count; k++) {
    BW_TRY(bw_check_cancel(context));
    bw_progress(context, "writing", (double)k / p.count);
    BW_TRY(write_piece(&p, k));
  }
  BW_TRY(bw_pvtu_write_index(context, path, p.count, mesh->region != NULL, field_count, fields));
done:
  bw_free(p.along);
  bw_free(p.local);
  bw_free(p.node);
  return status;
}
