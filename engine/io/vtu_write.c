/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* VTU: an XML header that gives each array an offset, then all arrays appended as raw bytes, each
 * cut into blocks that are compressed by zlib on their own (in parallel: the cut does not depend on
 * the number of threads, so neither do the bytes).
 *
 * Layout of an array: number of blocks, size of a block, size of the last one (0: full), compressed
 * size of each, all uint64; then the compressed blocks. */
#include "io/vtu.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

enum { BLOCK_BYTES = 1 << 18, LEVEL = 4, INT32_BYTES = 4 };

typedef struct packed {
  unsigned char *bytes; /* the header and the blocks behind it */
  size_t count;
} packed;

typedef struct packing {
  const unsigned char *source;
  size_t bytes, stride; /* stride: room for one compressed block */
  unsigned char *out;
  uint64_t *size;
} packing;

static bw_status pack_blocks(void *data, int64_t begin, int64_t end, int worker) {
  packing *p = (packing *)data;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    size_t from = (size_t)i * BLOCK_BYTES;
    size_t bytes = p->bytes - from < BLOCK_BYTES ? p->bytes - from : BLOCK_BYTES;
    uLongf size = (uLongf)p->stride;
    if (compress2(p->out + (size_t)i * p->stride, &size, p->source + from, (uLong)bytes, LEVEL) !=
        Z_OK)
      return BW_MEMORY; /* the only way to fail, as stride is a bound */
    p->size[i] = size;
  }
  return BW_OK;
}

static bw_status pack(bw_context *context, const void *source, size_t bytes, packed *to) {
  bw_status status = BW_OK;
  size_t blocks = (bytes + BLOCK_BYTES - 1) / BLOCK_BYTES, all = 0;
  packing p = {(const unsigned char *)source, bytes, compressBound(BLOCK_BYTES), NULL, NULL};
  p.out = BW_NEW(context, unsigned char, blocks *p.stride);
  p.size = BW_NEW(context, uint64_t, blocks);
  BW_TRY_MEMORY(p.out && p.size);
  status = bw_parallel(context, (int64_t)blocks, 1, pack_blocks, &p);
  if (status == BW_MEMORY)
    bw_fail(context, BW_MEMORY, "out of memory while compressing %zu bytes", bytes);
  if (status != BW_OK)
    goto done;
  for (size_t i = 0; i < blocks; i++)
    all += p.size[i];
  to->count = (3 + blocks) * sizeof(uint64_t) + all;
  to->bytes = BW_NEW(context, unsigned char, to->count);
  BW_TRY_MEMORY(to->bytes);
  uint64_t head[3] = {blocks, BLOCK_BYTES, bytes % BLOCK_BYTES};
  unsigned char *at = to->bytes;
  memcpy(at, head, sizeof head);
  at += sizeof head;
  memcpy(at, p.size, blocks * sizeof *p.size);
  at += blocks * sizeof *p.size;
  for (size_t i = 0; i < blocks; i++) {
    memcpy(at, p.out + i * p.stride, p.size[i]);
    at += p.size[i];
  }
done:
  bw_free(p.out);
  bw_free(p.size);
  return status;
}

/* ---- what is written ----------------------------------------------------------------------- */

/* Row by row, tensors in VTK's order xx yy zz xy yz zx. */
static bw_status pack_field(bw_context *context, const bw_array *array, packed *to) {
  static const int64_t tensor[6] = {0, 1, 2, 5, 3, 4};
  size_t size = bw_type_size(array->type);
  unsigned char *flat =
      BW_NEW(context, unsigned char, (size_t)array->rows *(size_t)array->columns *size);
  if (!flat)
    return BW_MEMORY;
  unsigned char *at = flat;
  bool permuted = array->columns == 6 && array->type == BW_F64;
  for (int64_t i = 0; i < array->rows; i++)
    for (int64_t j = 0; j < array->columns; j++, at += size)
      memcpy(at,
             (const unsigned char *)array->data + i * array->row_stride +
                 (permuted ? tensor[j] : j) * array->column_stride,
             size);
  bw_status status = pack(context, flat, (size_t)(at - flat), to);
  bw_free(flat);
  return status;
}

static bw_status pack_cells(bw_context *context, const bwi_vtu_cells *g, packed *offsets,
                            packed *types) {
  bw_status status = BW_OK;
  int64_t *end = BW_NEW(context, int64_t, g->cells);
  uint8_t *type = BW_NEW(context, uint8_t, g->cells);
  BW_TRY_MEMORY(end && type);
  for (int64_t i = 0; i < g->cells; i++) {
    end[i] = (i + 1) * g->width;
    type[i] = g->type;
  }
  BW_TRY(pack(context, end, (size_t)g->cells * sizeof *end, offsets));
  BW_TRY(pack(context, type, (size_t)g->cells, types));
done:
  bw_free(end);
  bw_free(type);
  return status;
}

void bwi_vtu_print_text(bw_writer *writer, const char *name) {
  for (; *name; name++) {
    const char *entity = *name == '&'   ? "&amp;"
                         : *name == '<' ? "&lt;"
                         : *name == '>' ? "&gt;"
                         : *name == '"' ? "&quot;"
                                        : NULL;
    if (entity)
      bw_writer_print(writer, "%s", entity);
    else
      bw_writer_bytes(writer, (unsigned char)*name < 32 ? " " : name, 1);
  }
}

void bwi_vtu_print_attributes(bw_writer *writer, const char *type, const char *name,
                              int64_t columns, bool tensor) {
  static const char *const component[6] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
  bw_writer_print(writer, "type=\"%s\" Name=\"", type);
  bwi_vtu_print_text(writer, name);
  bw_writer_print(writer, "\" NumberOfComponents=\"%lld\"", (long long)columns);
  for (int i = 0; tensor && i < 6; i++)
    bw_writer_print(writer, " ComponentName%d=\"%s\"", i, component[i]);
}

static void print_place(bw_writer *writer, size_t *offset, const packed *data) {
  bw_writer_print(writer, " format=\"appended\" offset=\"%zu\"/>\n", *offset);
  *offset += data->count;
}

static void print_array(bw_writer *writer, const char *type, const char *name, int64_t columns,
                        size_t *offset, const packed *data) {
  bw_writer_print(writer, "<DataArray ");
  bwi_vtu_print_attributes(writer, type, name, columns, false);
  print_place(writer, offset, data);
}

static const char *vtk_type(bw_type type) {
  return type == BW_F64 ? "Float64" : type == BW_I32 ? "Int32" : type == BW_I64 ? "Int64" : "UInt8";
}

void bwi_vtu_print_field(bw_writer *writer, const bw_field *field) {
  const bw_array *array = field->array;
  bwi_vtu_print_attributes(writer, vtk_type(array->type), field->name, array->columns,
                           array->columns == 6 && array->type == BW_F64);
}

static void print_fields(bw_writer *writer, const bwi_vtu_cells *g, bw_field_place place,
                         const packed *data, size_t *offset) {
  for (int i = 0; i < g->field_count; i++)
    if (g->fields[i].place == place) {
      bw_writer_print(writer, "<DataArray ");
      bwi_vtu_print_field(writer, &g->fields[i]);
      print_place(writer, offset, data + i);
    }
}

/* Parts 0 to 4: points, connectivity, offsets, types, tag; then the fields: first all on points,
 * then all on cells, which is the order of the offsets. */
enum { POINTS, CONNECTIVITY, OFFSETS, TYPES, TAG, FIELDS };

/* As text, so that a reader needs no offset: VTK has strings as bytes that end with 0. */
static void print_regions(bw_writer *writer, const bwi_vtu_cells *g) {
  if (g->region_count == 0)
    return;
  bw_writer_print(writer,
                  "<FieldData>\n<DataArray type=\"Int32\" Name=\"%s\" NumberOfTuples=\"%d\" "
                  "format=\"ascii\">\n",
                  BWI_VTU_REGION_TAGS, g->region_count);
  for (int32_t i = 0; i < g->region_count; i++)
    bw_writer_print(writer, "%d ", g->regions[i].tag);
  bw_writer_print(writer,
                  "\n</DataArray>\n<DataArray type=\"String\" Name=\"%s\" NumberOfTuples=\"%d\" "
                  "format=\"ascii\">\n",
                  BWI_VTU_REGION_NAMES, g->region_count);
  for (int32_t i = 0; i < g->region_count; i++) {
    for (const char *c = g->regions[i].name.text; *c; c++)
      bw_writer_print(writer, "%d ", (unsigned char)*c);
    bw_writer_print(writer, "0\n");
  }
  bw_writer_print(writer, "</DataArray>\n</FieldData>\n");
}

static void print_header(bw_writer *writer, const bwi_vtu_cells *g, const packed *part) {
  size_t offset = 0;
  const bool big = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
  bw_writer_print(writer,
                  "<?xml version=\"1.0\"?>\n"
                  "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" "
                  "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
                  "<UnstructuredGrid>\n",
                  big ? "BigEndian" : "LittleEndian");
  print_regions(writer, g);
  bw_writer_print(writer, "<Piece NumberOfPoints=\"%lld\" NumberOfCells=\"%lld\">\n<Points>\n",
                  (long long)g->points, (long long)g->cells);
  print_array(writer, "Float64", "Points", 3, &offset, part + POINTS);
  bw_writer_print(writer, "</Points>\n<Cells>\n");
  print_array(writer, "Int32", "connectivity", 1, &offset, part + CONNECTIVITY);
  print_array(writer, "Int64", "offsets", 1, &offset, part + OFFSETS);
  print_array(writer, "UInt8", "types", 1, &offset, part + TYPES);
  bw_writer_print(writer, "</Cells>\n<PointData>\n");
  print_fields(writer, g, BW_ON_NODES, part + FIELDS, &offset);
  bw_writer_print(writer, "</PointData>\n<CellData>\n");
  if (g->tag)
    print_array(writer, "Int32", g->tag_name, 1, &offset, part + TAG);
  print_fields(writer, g, BW_ON_ELEMENTS, part + FIELDS, &offset);
  bw_writer_print(writer, "</CellData>\n</Piece>\n</UnstructuredGrid>\n"
                          "<AppendedData encoding=\"raw\">\n_");
}

static void write_parts(bw_writer *writer, const bwi_vtu_cells *g, const packed *part) {
  for (int i = 0; i < TAG; i++)
    bw_writer_bytes(writer, part[i].bytes, part[i].count);
  for (int place = 0; place < 2; place++) {
    if (place == 1 && g->tag)
      bw_writer_bytes(writer, part[TAG].bytes, part[TAG].count);
    for (int i = 0; i < g->field_count; i++)
      if ((g->fields[i].place == BW_ON_NODES) == (place == 0))
        bw_writer_bytes(writer, part[FIELDS + i].bytes, part[FIELDS + i].count);
  }
  bw_writer_print(writer, "\n</AppendedData>\n</VTKFile>\n");
}

bw_status bwi_vtu_write_cells(bw_context *context, const bwi_vtu_cells *g, const char *path) {
  bw_status status = BW_OK;
  bw_writer *writer = NULL;
  int parts = FIELDS + g->field_count;
  packed *part = BW_NEW0(context, packed, parts);
  if (!part)
    return BW_MEMORY;
  BW_TRY(bwi_check_fields(context, g->points, g->cells, g->field_count, g->fields));
  /* First of all: a path that cannot be written should not cost the packing. */
  BW_TRY(bw_writer_open(context, path, &writer));
  BW_TRY(pack(context, g->point, (size_t)g->points * 3 * sizeof(double), part + POINTS));
  BW_TRY(pack(context, g->cell, (size_t)g->cells * (size_t)g->width * INT32_BYTES,
              part + CONNECTIVITY));
  BW_TRY(pack_cells(context, g, part + OFFSETS, part + TYPES));
  if (g->tag)
    BW_TRY(pack(context, g->tag, (size_t)g->cells * INT32_BYTES, part + TAG));
  for (int i = 0; i < g->field_count; i++)
    BW_TRY(pack_field(context, g->fields[i].array, part + FIELDS + i));
  print_header(writer, g, part);
  write_parts(writer, g, part);
  status = bw_writer_commit(writer);
  writer = NULL;
done:
  bw_writer_discard(writer);
  for (int i = 0; i < parts; i++)
    bw_free(part[i].bytes);
  bw_free(part);
  return status;
}

bw_status bwi_vtu_write(bw_context *context, const bw_mesh *mesh, const char *path, int field_count,
                        const bw_field *fields) {
  int32_t *tag;
  bw_status status = bw_mesh_element_tags(context, mesh, &tag);
  if (status != BW_OK)
    return status;
  bwi_vtu_cells g = {mesh->node_count,
                     mesh->element_count,
                     mesh->node,
                     mesh->nodes_per_element,
                     mesh->order == 2 ? 24 : 10,
                     mesh->element,
                     tag,
                     "region",
                     field_count,
                     fields,
                     mesh->region_count,
                     mesh->regions};
  status = bwi_vtu_write_cells(context, &g, path);
  bw_free(tag);
  return status;
}

bw_status bw_surface_write_vtu(bw_context *context, const bw_surface *surface, const char *path,
                               int field_count, const bw_field *fields) {
  bwi_vtu_cells g = {surface->point_count,
                     surface->triangle_count,
                     surface->point,
                     3,
                     5,
                     surface->triangle,
                     surface->group,
                     "group",
                     field_count,
                     fields,
                     0,
                     NULL};
  return bwi_vtu_write_cells(context, &g, path);
}

/* Places and fields of two components get a third that is 0: VTK's vectors have three. */
static bw_status to_space(bw_context *context, const bw_array *flat, bw_array **space) {
  bw_status status = bw_array_create(context, BW_F64, flat->rows, 3, space);
  if (status != BW_OK)
    return status;
  for (int64_t i = 0; i < flat->rows; i++)
    for (int64_t k = 0; k < 2; k++)
      ((double *)(*space)->data)[3 * i + k] = bw_array_get(flat, i, k);
  return BW_OK;
}

bw_status bw_plane_write_vtu(bw_context *context, const bw_plane_mesh *mesh, const char *path,
                             int field_count, const bw_field *fields) {
  bw_status status = BW_OK;
  const bw_plane_topology *t = mesh->topology;
  int32_t nodes = t->nodes->node_count;
  double *point = BW_NEW0(context, double, 3 * (size_t)nodes);
  bw_field *list = BW_NEW(context, bw_field, field_count);
  bw_array **space = BW_NEW0(context, bw_array *, field_count);
  BW_TRY_MEMORY(point && list && space);
  for (int64_t i = 0; i < nodes; i++)
    memcpy(point + 3 * i, mesh->point + 2 * i, 2 * sizeof *point);
  for (int i = 0; i < field_count; i++) {
    list[i] = fields[i];
    if (fields[i].array->columns != 2 || fields[i].array->type != BW_F64)
      continue;
    BW_TRY(to_space(context, fields[i].array, &space[i]));
    list[i].array = space[i];
  }
  bool six = t->nodes->order == 2;
  bwi_vtu_cells g = {
      nodes,    t->element_count, point, six ? 6 : 3, six ? 22 : 5, t->element, t->region,
      "region", field_count,      list,  0,           NULL};
  status = bwi_vtu_write_cells(context, &g, path);
done:
  for (int i = 0; space && i < field_count; i++)
    bw_release(space[i]);
  bw_free(point);
  bw_free(list);
  bw_free(space);
  return status;
}
