/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Gmsh files: 4.1 binary, 2.2 text. Nodes and elements are numbered from 1 in mesh order. Regions
 * whose tags are all positive become named physical groups; others, which Gmsh has no place for, an
 * element field "region". Fields have 1, 3 or 9 components there: symmetric tensors are written
 * with all nine, other widths filled up with zeros, more than nine left out with a warning. */
#include "base/sort.h"
#include "io/raw.h"

#include <stdlib.h>
#include <string.h>

typedef struct cells {
  int dimension, type, width; /* type: of Gmsh */
  int64_t points, count;
  const double *point;
  const int32_t *node;
  const int32_t *tag;  /* or NULL */
  int32_t shift;       /* added to a tag to give the physical group */
  bool physical;       /* tags are written as physical groups */
  const bw_mesh *mesh; /* whose regions have names; or NULL */
  int32_t *group;      /* the different tags, ascending */
  size_t group_count;
  int field_count;
  const bw_field *fields;
} cells;

static bw_status find_groups(bw_context *context, cells *c) {
  if (!c->tag)
    return BW_OK;
  c->group = BW_NEW(context, int32_t, c->count);
  if (!c->group)
    return BW_MEMORY;
  memcpy(c->group, c->tag, (size_t)c->count * sizeof *c->group);
  bwi_sort_columns(c->group, c->count);
  for (int64_t i = 0; i < c->count; i++)
    if (i == 0 || c->group[i] != c->group[c->group_count - 1])
      c->group[c->group_count++] = c->group[i];
  c->physical = (int64_t)c->group[0] + c->shift > 0 &&
                (int64_t)c->group[c->group_count - 1] + c->shift <= INT32_MAX;
  return BW_OK;
}

/* The geometric entity of an element: one per tag, numbered from 1. */
static int32_t entity_of(const cells *c, int64_t i) {
  if (!c->physical)
    return 1;
  return (int32_t)bwi_sorted_index(c->group, 0, (int64_t)c->group_count, c->tag[i]) + 1;
}

/* The mid-edge nodes of the edges 13 and 23 change places. */
static int32_t node_at(const cells *c, int64_t i, int k) {
  int from = c->width == 10 && k >= 8 ? 17 - k : k;
  return c->node[i * c->width + from];
}

static void put_i32(bw_writer *writer, int64_t value) {
  int32_t small = (int32_t)value;
  bw_writer_bytes(writer, &small, sizeof small);
}

static void put_u64(bw_writer *writer, int64_t value) {
  bw_writer_bytes(writer, &value, sizeof value);
}

/* ---- fields -------------------------------------------------------------------------------- */

static double component(const bw_array *array, int64_t row, int column, int columns) {
  static const int symmetric[9] = {0, 5, 4, 5, 1, 3, 4, 3, 2};
  if (columns == 9 && array->columns == 6)
    return bw_array_get(array, row, symmetric[column]);
  return column < array->columns ? bw_array_get(array, row, column) : 0;
}

/* There is no way to write a quotation mark. */
static void write_quoted(bw_writer *writer, const char *text) {
  for (; *text; text++)
    bw_writer_bytes(writer, *text == '"' || (unsigned char)*text < 32 ? "'" : text, 1);
}

static void write_field(bw_context *context, bw_writer *writer, const bw_field *field,
                        bool binary) {
  const bw_array *array = field->array;
  bool nodes = field->place == BW_ON_NODES;
  int columns = array->columns == 1 ? 1 : array->columns <= 3 ? 3 : 9;
  if (array->columns > 9) {
    bw_warn(context, "the field '%s' has %lld components, more than MSH can hold: left out",
            field->name, (long long)array->columns);
    return;
  }
  bw_writer_print(writer, "$%sData\n1\n\"", nodes ? "Node" : "Element");
  write_quoted(writer, field->name);
  bw_writer_print(writer, "\"\n1\n0\n3\n0\n%d\n%lld\n", columns, (long long)array->rows);
  for (int64_t i = 0; i < array->rows; i++) {
    if (binary)
      put_i32(writer, i + 1);
    else
      bw_writer_integer(writer, i + 1);
    for (int j = 0; j < columns; j++) {
      double value = component(array, i, j, columns);
      if (binary) {
        bw_writer_bytes(writer, &value, sizeof value);
      } else {
        bw_writer_bytes(writer, " ", 1);
        bw_writer_number(writer, value);
      }
    }
    if (!binary)
      bw_writer_bytes(writer, "\n", 1);
  }
  bw_writer_print(writer, "%s$End%sData\n", binary ? "\n" : "", nodes ? "Node" : "Element");
}

static void write_fields(bw_context *context, bw_writer *writer, const cells *c, bool binary) {
  if (c->tag && !c->physical) {
    bw_array tags = {.type = BW_I32,
                     .rows = c->count,
                     .columns = 1,
                     .row_stride = sizeof(int32_t),
                     .column_stride = sizeof(int32_t),
                     .data = (void *)(uintptr_t)c->tag};
    bw_field field = {"region", BW_ON_ELEMENTS, &tags};
    write_field(context, writer, &field, binary);
  }
  for (int i = 0; i < c->field_count; i++)
    write_field(context, writer, &c->fields[i], binary);
}

/* The names of regions, which are text in binary files too. */
static void write_names(bw_writer *writer, const cells *c) {
  if (!c->physical || !c->mesh)
    return;
  bw_writer_print(writer, "$PhysicalNames\n%d\n", (int)c->mesh->region_count);
  for (int32_t i = 0; i < c->mesh->region_count; i++) {
    bw_writer_print(writer, "3 %d \"", (int)c->mesh->regions[i].tag);
    write_quoted(writer, c->mesh->regions[i].name.text);
    bw_writer_print(writer, "\"\n");
  }
  bw_writer_print(writer, "$EndPhysicalNames\n");
}

/* ---- 4.1 binary ---------------------------------------------------------------------------- */

static void write_entities(bw_writer *writer, const cells *c) {
  double box[6] = {0, 0, 0, 0, 0, 0};
  for (int64_t i = 0; i < c->points; i++)
    for (int k = 0; k < 3; k++) {
      double x = c->point[3 * i + k];
      box[k] = i == 0 || x < box[k] ? x : box[k];
      box[3 + k] = i == 0 || x > box[3 + k] ? x : box[3 + k];
    }
  int64_t entities = c->physical ? (int64_t)c->group_count : 1;
  bw_writer_print(writer, "$Entities\n");
  for (int d = 0; d < 4; d++)
    put_u64(writer, d == c->dimension ? entities : 0);
  for (int64_t i = 0; i < entities; i++) {
    put_i32(writer, i + 1);
    bw_writer_bytes(writer, box, sizeof box);
    put_u64(writer, c->physical ? 1 : 0);
    if (c->physical)
      put_i32(writer, (int64_t)c->group[i] + c->shift);
    put_u64(writer, 0);
  }
  bw_writer_print(writer, "\n$EndEntities\n");
}

static void write_nodes(bw_writer *writer, const cells *c) {
  bw_writer_print(writer, "$Nodes\n");
  put_u64(writer, 1);
  put_u64(writer, c->points);
  put_u64(writer, 1);
  put_u64(writer, c->points);
  put_i32(writer, c->dimension);
  put_i32(writer, 1);
  put_i32(writer, 0);
  put_u64(writer, c->points);
  for (int64_t i = 0; i < c->points; i++)
    put_u64(writer, i + 1);
  bw_writer_bytes(writer, c->point, (size_t)c->points * 3 * sizeof *c->point);
  bw_writer_print(writer, "\n$EndNodes\n");
}

/* Elements keep their order: a block is a run of elements of one entity. */
static int64_t run_end(const cells *c, int64_t i) {
  int64_t end = c->physical ? i + 1 : c->count;
  while (c->physical && end < c->count && c->tag[end] == c->tag[i])
    end++;
  return end;
}

static void write_elements(bw_writer *writer, const cells *c) {
  int64_t blocks = 0;
  for (int64_t i = 0; i < c->count; i = run_end(c, i))
    blocks++;
  bw_writer_print(writer, "$Elements\n");
  put_u64(writer, blocks);
  put_u64(writer, c->count);
  put_u64(writer, 1);
  put_u64(writer, c->count);
  for (int64_t i = 0; i < c->count;) {
    int64_t end = run_end(c, i);
    put_i32(writer, c->dimension);
    put_i32(writer, entity_of(c, i));
    put_i32(writer, c->type);
    put_u64(writer, end - i);
    for (; i < end; i++) {
      put_u64(writer, i + 1);
      for (int k = 0; k < c->width; k++)
        put_u64(writer, (int64_t)node_at(c, i, k) + 1);
    }
  }
  bw_writer_print(writer, "\n$EndElements\n");
}

static void write_41(bw_context *context, bw_writer *writer, const cells *c) {
  bw_writer_print(writer, "$MeshFormat\n4.1 1 8\n");
  put_i32(writer, 1);
  bw_writer_print(writer, "\n$EndMeshFormat\n");
  write_names(writer, c);
  write_entities(writer, c);
  write_nodes(writer, c);
  write_elements(writer, c);
  write_fields(context, writer, c, true);
}

/* ---- 2.2 text ------------------------------------------------------------------------------ */

static void write_22(bw_context *context, bw_writer *writer, const cells *c) {
  bw_writer_print(writer, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
  write_names(writer, c);
  bw_writer_print(writer, "$Nodes\n%lld\n", (long long)c->points);
  for (int64_t i = 0; i < c->points; i++) {
    bw_writer_integer(writer, i + 1);
    for (int k = 0; k < 3; k++) {
      bw_writer_bytes(writer, " ", 1);
      bw_writer_number(writer, c->point[3 * i + k]);
    }
    bw_writer_bytes(writer, "\n", 1);
  }
  bw_writer_print(writer, "$EndNodes\n$Elements\n%lld\n", (long long)c->count);
  for (int64_t i = 0; i < c->count; i++) {
    bw_writer_print(writer, "%lld %d 2 %lld %d", (long long)i + 1, c->type,
                    c->physical ? (long long)c->tag[i] + c->shift : 0, (int)entity_of(c, i));
    for (int k = 0; k < c->width; k++) {
      bw_writer_bytes(writer, " ", 1);
      bw_writer_integer(writer, (int64_t)node_at(c, i, k) + 1);
    }
    bw_writer_bytes(writer, "\n", 1);
  }
  bw_writer_print(writer, "$EndElements\n");
  write_fields(context, writer, c, false);
}

static bw_status write_cells(bw_context *context, cells *c, const char *path, bool binary) {
  bw_writer *writer = NULL;
  bw_status status = BW_OK;
  BW_TRY(bwi_check_fields(context, c->points, c->count, c->field_count, c->fields));
  BW_TRY(find_groups(context, c));
  BW_TRY(bw_writer_open(context, path, &writer));
  if (binary)
    write_41(context, writer, c);
  else
    write_22(context, writer, c);
  status = bw_writer_commit(writer);
done:
  bw_free(c->group);
  return status;
}

static bw_status write_mesh(bw_context *context, const bw_mesh *mesh, const char *path, bool binary,
                            int field_count, const bw_field *fields) {
  int32_t *tag;
  bw_status status = bw_mesh_element_tags(context, mesh, &tag);
  if (status != BW_OK)
    return status;
  cells c = {.tag = tag,
             .mesh = mesh,
             .dimension = 3,
             .type = mesh->order == 2 ? 11 : 4,
             .width = mesh->nodes_per_element,
             .points = mesh->node_count,
             .count = mesh->element_count,
             .point = mesh->node,
             .node = mesh->element,
             .field_count = field_count,
             .fields = fields};
  status = write_cells(context, &c, path, binary);
  bw_free(tag);
  return status;
}

bw_status bwi_msh41_write(bw_context *context, const bw_mesh *mesh, const char *path,
                          int field_count, const bw_field *fields) {
  return write_mesh(context, mesh, path, true, field_count, fields);
}

bw_status bw_msh22_write(bw_context *context, const bw_mesh *mesh, const char *path,
                         int field_count, const bw_field *fields) {
  return write_mesh(context, mesh, path, false, field_count, fields);
}

/* Groups of a surface are numbered from 0, physical groups from 1. */
bw_status bwi_msh_write_surface(bw_context *context, const bw_surface *surface, const char *path,
                                bool ascii) {
  cells c = {.dimension = 2,
             .type = 2,
             .width = 3,
             .points = surface->point_count,
             .count = surface->triangle_count,
             .point = surface->point,
             .node = surface->triangle,
             .tag = surface->triangle_count ? surface->group : NULL,
             .shift = 1};
  return write_cells(context, &c, path, !ascii);
}
