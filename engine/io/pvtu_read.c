/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* PVTU: the pieces that the file names are read one after another and joined to one mesh.
 *
 * Nodes with the same number are one where every piece numbers its nodes, and their order is that
 * of the numbers; else nodes at exactly equal places are one, in the order in which they appear.
 * Elements follow their numbers, or the pieces. Copies that a piece has of its neighbours' elements
 * (vtkGhostType) are left out. */
#include "io/raw.h"
#include "io/vtu.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* VTK's mark of an element that belongs to another piece. */
enum { DUPLICATE_CELL = 1 };
/* Of the largest coordinate: places of one node in several pieces differ by no more. */
#define PLACE_ROUNDING 1e-6

bool bwi_pvtu_joins(const char *name) {
  return !strcmp(name, BW_PVTU_NODE) || !strcmp(name, BW_PVTU_ELEMENT) ||
         !strcmp(name, BWI_PVTU_GHOST);
}

/* A node or an element of a piece. */
typedef struct item {
  int64_t number; /* that the file gives; of nodes without numbers 0 */
  double x[3];    /* of nodes */
  int32_t piece, local;
  int32_t at; /* among those of all pieces, one piece behind the other */
} item;

typedef struct joining {
  bw_context *context;
  const char *path;
  bw_mesh_file *piece;
  size_t count, capacity;
  int64_t skipped;                  /* other elements, of pieces without tetrahedra */
  bool numbered, elements_numbered; /* nodes, elements */
  item *node, *element;
  int64_t nodes, elements; /* of all pieces, ghosts left out */
  int32_t *joined;         /* nodes: of the mesh, by `at` */
  int32_t *from;           /* node of the mesh -> its first place in `node`, ordered by `at` */
  int32_t node_count;
} joining;

/* A failure with the name of the file in message and details. */
__attribute__((format(printf, 3, 4))) static bw_status refuse(const joining *j, bw_status status,
                                                              const char *format, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  bw_fail(j->context, status, "%s: %s", j->path, text);
  bw_detail_text(j->context, "file", j->path);
  return status;
}

/* ---- the names of the pieces ----------------------------------------------------------------- */

static char *beside(bw_context *context, const char *path, bwi_word source) {
  const char *slash = strrchr(path, '/');
  size_t folder = slash && source.at[0] != '/' ? (size_t)(slash - path) + 1 : 0;
  char *name = BW_NEW(context, char, folder + source.length + 1);
  if (name) {
    memcpy(name, path, folder);
    memcpy(name + folder, source.at, source.length);
    name[folder + source.length] = 0;
    bwi_xml_decode(name + folder);
  }
  return name;
}

/* Programs that run in parallel write a piece for each process, also where it has no elements. Such
 * a piece is left out. */
static bw_status parse_piece(joining *j, const char *name, const unsigned char *bytes,
                             size_t count) {
  bw_status status = BW_OK;
  bwi_cursor cursor;
  bwi_raw raw;
  const char *format;
  bwi_cursor_init(&cursor, j->context, name, bytes, count);
  bwi_raw_init(&raw, j->context, name);
  BW_TRY(bwi_vtu_read(&cursor, &raw, &format));
  if (raw.tet_count == 0 && raw.solids == 0)
    j->skipped += raw.skipped + (int64_t)raw.facet_count;
  else {
    BW_TRY(bwi_raw_mesh(&raw, format, &j->piece[j->count]));
    j->count++;
  }
done:
  bwi_raw_clear(&raw);
  return status;
}

static bw_status read_piece(bwi_cursor *cursor, joining *j, bwi_word source) {
  bw_status status = BW_OK;
  char *name = NULL;
  unsigned char *bytes = NULL;
  size_t count;
  if (source.length == 0)
    return bwi_fail_line(cursor, "a Piece without Source: the path of a .vtu file expected");
  name = beside(j->context, j->path, source);
  if (!name ||
      !bw_grow(j->context, (void **)&j->piece, &j->capacity, j->count, 1, sizeof *j->piece)) {
    status = BW_MEMORY;
    goto done;
  }
  status = bw_read_file(j->context, name, &bytes, &count);
  if (status == BW_IO) {
    refuse(j, status, "a piece that it names cannot be read: %s", bw_message(j->context));
    bw_detail_text(j->context, "piece", name);
  }
  BW_TRY(status);
  BW_TRY(parse_piece(j, name, bytes, count));
  if (j->count > 0 && j->piece[j->count - 1].mesh->order != j->piece[0].mesh->order)
    status = refuse(j, BW_FORMAT, "elements of %d nodes in %s, but of %d in the first piece",
                    j->piece[j->count - 1].mesh->nodes_per_element, name,
                    j->piece[0].mesh->nodes_per_element);
done:
  bw_free(bytes);
  bw_free(name);
  return status;
}

static bw_status read_pieces(bwi_cursor *cursor, joining *j) {
  bw_status status = BW_OK;
  bwi_tag tag;
  bool any, started = false, named = false, whole = false;
  for (;;) {
    BW_TRY(bwi_xml_next(cursor, &tag, &any));
    if (!any)
      break;
    if (tag.closing) {
      whole = whole || bwi_word_is(tag.name, "PUnstructuredGrid");
      continue;
    }
    if (bwi_word_is(tag.name, "VTKFile")) {
      bwi_word type = bwi_xml_value(&tag, "type");
      if (!bwi_word_is(type, "PUnstructuredGrid"))
        return bwi_fail_line(cursor,
                             "a VTK file of type '%s': PUnstructuredGrid is expected in a .pvtu",
                             bwi_show(type));
      started = true;
    } else if (!started)
      return bwi_fail_line(cursor, "found the XML tag '%s' where VTKFile was expected",
                           bwi_show(tag.name));
    else if (bwi_word_is(tag.name, "Piece")) {
      named = true;
      BW_TRY(read_piece(cursor, j, bwi_xml_value(&tag, "Source")));
    }
  }
  if (!named)
    status = bwi_fail_line(cursor, "the file names no Piece");
  else if (!whole) /* it may have named more */
    status = bwi_fail_line(cursor, "the file ends before </PUnstructuredGrid>");
  else if (j->count == 0)
    status = bwi_fail_line(cursor, "no Piece holds tetrahedra");
done:
  return status;
}

/* ---- joining --------------------------------------------------------------------------------- */

/* A field of one component per row, or NULL. */
static const bw_array *find(const bw_mesh_file *file, bw_field_place place, const char *name) {
  for (int i = 0; i < file->field_count; i++)
    if (file->field_place[i] == place && strcmp(file->field_name[i], name) == 0 &&
        file->field_array[i]->columns == 1 && file->field_array[i]->type != BW_F64)
      return file->field_array[i];
  return NULL;
}

static bool all_have(const joining *j, bw_field_place place, const char *name) {
  for (size_t k = 0; k < j->count; k++)
    if (!find(&j->piece[k], place, name))
      return false;
  return true;
}

static int64_t integer(const bw_array *array, int64_t row) {
  const void *at = (const char *)array->data + row * array->row_stride;
  int64_t wide;
  int32_t narrow;
  if (array->type == BW_U8)
    return *(const uint8_t *)at;
  if (array->type == BW_I32) {
    memcpy(&narrow, at, sizeof narrow);
    return narrow;
  }
  memcpy(&wide, at, sizeof wide);
  return wide;
}

static int by_place(const item *p, const item *q) {
  return p->at < q->at ? -1 : p->at > q->at;
}

static int compare_numbers(const item *p, const item *q) {
  return p->number < q->number ? -1 : p->number > q->number;
}

static int by_node(const void *a, const void *b) {
  const item *p = a, *q = b;
  int order = memcmp(p->x, q->x, sizeof p->x);
  return order ? order : by_place(p, q);
}

static int by_number(const void *a, const void *b) {
  int order = compare_numbers(a, b);
  return order ? order : by_place(a, b);
}

static void list_nodes(joining *j, size_t k) {
  const bw_mesh_file *file = &j->piece[k];
  const bw_array *number = find(file, BW_ON_NODES, BW_PVTU_NODE);
  for (int32_t i = 0; i < file->mesh->node_count; i++) {
    item *n = &j->node[j->nodes];
    *n = (item){.piece = (int32_t)k, .local = i, .at = (int32_t)j->nodes};
    j->nodes++;
    if (j->numbered)
      n->number = integer(number, i);
    for (int c = 0; c < 3; c++) /* -0 is 0 */
      n->x[c] = file->mesh->node[3 * (int64_t)i + c] + 0.0;
  }
}

static void list_elements(joining *j, size_t k) {
  const bw_mesh_file *file = &j->piece[k];
  const bw_array *number = find(file, BW_ON_ELEMENTS, BW_PVTU_ELEMENT);
  const bw_array *ghost = find(file, BW_ON_ELEMENTS, BWI_PVTU_GHOST);
  for (int32_t e = 0; e < file->mesh->element_count; e++)
    if (!ghost || !(integer(ghost, e) & DUPLICATE_CELL)) {
      j->element[j->elements] = (item){.number = j->elements_numbered ? integer(number, e) : 0,
                                       .piece = (int32_t)k,
                                       .local = e,
                                       .at = (int32_t)j->elements};
      j->elements++;
    }
}

static bw_status list_items(joining *j) {
  int64_t nodes = 0, elements = 0;
  j->elements_numbered = all_have(j, BW_ON_ELEMENTS, BW_PVTU_ELEMENT);
  j->numbered = all_have(j, BW_ON_NODES, BW_PVTU_NODE);
  for (size_t k = 0; k < j->count; k++) {
    nodes += j->piece[k].mesh->node_count;
    elements += j->piece[k].mesh->element_count;
  }
  if (nodes > INT32_MAX || elements > INT32_MAX)
    return refuse(j, BW_LIMIT, "pieces of %lld nodes and %lld elements: at most 2147483647 of each",
                  (long long)nodes, (long long)elements);
  j->node = BW_NEW(j->context, item, nodes);
  j->element = BW_NEW(j->context, item, elements);
  j->joined = BW_NEW(j->context, int32_t, nodes);
  j->from = BW_NEW(j->context, int32_t, nodes);
  if (!j->node || !j->element || !j->joined || !j->from)
    return BW_MEMORY;
  for (size_t k = 0; k < j->count; k++) {
    list_nodes(j, k);
    list_elements(j, k);
  }
  return bw_check_cancel(j->context);
}

/* Nodes of one number lie at one place, but for the rounding of a file's single precision. */
static bw_status check_places(const joining *j) {
  double largest = 0;
  for (int64_t i = 0; i < j->nodes; i++)
    for (int c = 0; c < 3; c++)
      largest = fmax(largest, fabs(j->node[i].x[c]));
  for (int64_t i = 1; i < j->nodes; i++) {
    const item *p = &j->node[i - 1], *q = &j->node[i];
    for (int c = 0; c < 3 && p->number == q->number; c++)
      if (fabs(p->x[c] - q->x[c]) > PLACE_ROUNDING * largest)
        return refuse(j, BW_FORMAT,
                      "node number %lld lies at (%g, %g, %g) in one piece and at (%g, %g, %g) in "
                      "another: " BW_PVTU_NODE " must number the nodes of all pieces together",
                      (long long)q->number, p->x[0], p->x[1], p->x[2], q->x[0], q->x[1], q->x[2]);
  }
  return BW_OK;
}

/* Which node of the mesh each node of a piece is. */
static bw_status join_nodes(joining *j) {
  item *node = j->node;
  int (*compare)(const void *, const void *) = j->numbered ? by_number : by_node;
  qsort(node, (size_t)j->nodes, sizeof *node, compare);
  if (j->numbered && check_places(j) != BW_OK)
    return BW_FORMAT;
  for (int64_t i = 0, first = 0; i < j->nodes; i++) {
    if (i == 0 || (j->numbered ? node[i - 1].number != node[i].number
                               : memcmp(node[i - 1].x, node[i].x, sizeof node->x) != 0)) {
      first = i;
      if (j->numbered)
        j->from[j->node_count++] = node[i].at;
    }
    j->joined[node[i].at] = j->numbered ? j->node_count - 1 : node[first].at;
  }
  /* In the order of appearance: the first of equals stands before them, and has its number. */
  for (int32_t at = 0; at < j->nodes && !j->numbered; at++)
    if (j->joined[at] == at) {
      j->from[j->node_count] = at;
      j->joined[at] = j->node_count++;
    } else
      j->joined[at] = j->joined[j->joined[at]];
  return bw_check_cancel(j->context);
}

static int by_at(const void *a, const void *b) {
  return by_place(a, b);
}

static bw_status join_elements(joining *j) {
  qsort(j->element, (size_t)j->elements, sizeof *j->element, by_number);
  for (int64_t e = 1; e < j->elements && j->elements_numbered; e++)
    if (j->element[e].number == j->element[e - 1].number)
      return refuse(j, BW_FORMAT,
                    "element number %lld occurs twice: an element that is in several pieces must "
                    "be marked as a copy (" BWI_PVTU_GHOST ") in all but one",
                    (long long)j->element[e].number);
  return BW_OK;
}

/* Regions by the tags of all pieces; an element of a piece without regions has tag 0. */
static bw_status join_regions(const joining *j, bw_mesh_regions *regions) {
  bw_status status = BW_OK;
  int32_t named = 0;
  for (size_t k = 0; k < j->count; k++)
    named += j->piece[k].mesh->region_count;
  if (named == 0)
    return BW_OK;
  int32_t *tag = BW_NEW(j->context, int32_t, j->elements);
  bw_mesh_region *region = BW_NEW(j->context, bw_mesh_region, named);
  BW_TRY_MEMORY(tag && region);
  named = 0;
  for (size_t k = 0; k < j->count; k++)
    for (int32_t i = 0; i < j->piece[k].mesh->region_count; i++)
      region[named++] = j->piece[k].mesh->regions[i];
  for (int64_t e = 0; e < j->elements; e++) {
    const bw_mesh *from = j->piece[j->element[e].piece].mesh;
    tag[e] = from->region ? from->regions[from->region[j->element[e].local]].tag : 0;
  }
  status = bw_mesh_regions_by_tag(j->context, j->elements, tag, named, region, regions);
done:
  bw_free(tag);
  bw_free(region);
  return status;
}

static bw_status make_mesh(joining *j, bw_mesh **mesh) {
  bw_status status = BW_OK;
  int width = j->piece[0].mesh->nodes_per_element;
  double *x = BW_NEW(j->context, double, 3 * (int64_t)j->node_count);
  int32_t *element = BW_NEW(j->context, int32_t, j->elements * width);
  int32_t *start = BW_NEW0(j->context, int32_t, j->count);
  bw_mesh_regions regions = {0, NULL, NULL};
  BW_TRY_MEMORY(x && element && start);
  BW_TRY(join_regions(j, &regions));
  for (size_t k = 1; k < j->count; k++)
    start[k] = start[k - 1] + j->piece[k - 1].mesh->node_count;
  for (int32_t i = 0; i < j->node_count; i++) {
    const item *n = &j->node[j->from[i]];
    memcpy(x + 3 * (int64_t)i, j->piece[n->piece].mesh->node + 3 * (int64_t)n->local,
           3 * sizeof *x);
  }
  for (int64_t e = 0; e < j->elements; e++) {
    const item *cell = &j->element[e];
    const int32_t *node = j->piece[cell->piece].mesh->element + (int64_t)cell->local * width;
    for (int a = 0; a < width; a++)
      element[e * width + a] = j->joined[start[cell->piece] + node[a]];
  }
  BW_TRY(bw_mesh_adopt(j->context, j->piece[0].mesh->order, j->node_count, x, j->elements, element,
                       &regions, mesh));
  x = NULL;
  element = NULL;
done:
  bw_free(x);
  bw_free(element);
  bw_mesh_regions_clear(&regions);
  bw_free(start);
  return status;
}

/* ---- fields ---------------------------------------------------------------------------------- */

/* The field of a piece that is number i of the first one, or NULL. */
static const bw_array *counterpart(const joining *j, size_t k, int i) {
  const bw_mesh_file *first = &j->piece[0], *file = &j->piece[k];
  for (int f = 0; f < file->field_count; f++)
    if (file->field_place[f] == first->field_place[i] &&
        strcmp(file->field_name[f], first->field_name[i]) == 0 &&
        file->field_array[f]->columns == first->field_array[i]->columns &&
        file->field_array[f]->type == first->field_array[i]->type)
      return file->field_array[f];
  return NULL;
}

static bw_status join_field(const joining *j, int i, bw_mesh_file *out) {
  bw_status status = BW_OK;
  const bw_array *like = j->piece[0].field_array[i];
  bool nodes = j->piece[0].field_place[i] == BW_ON_NODES;
  int64_t rows = nodes ? j->node_count : j->elements;
  size_t size = bw_type_size(like->type);
  bw_array *array = NULL;
  for (size_t k = 0; k < j->count; k++)
    if (!counterpart(j, k, i)) {
      out->info.skipped++;
      return BW_OK;
    }
  BW_TRY(bw_array_create(j->context, like->type, rows, like->columns, &array));
  for (int64_t r = 0; r < rows; r++) {
    const item *n = nodes ? &j->node[j->from[r]] : &j->element[r];
    const bw_array *part = counterpart(j, (size_t)n->piece, i);
    for (int64_t c = 0; c < like->columns; c++)
      memcpy((char *)array->data + r * array->row_stride + c * array->column_stride,
             (const char *)part->data + n->local * part->row_stride + c * part->column_stride,
             size);
  }
  /* The name moves from the piece, which is read no more under it. */
  out->field_name[out->field_count] = j->piece[0].field_name[i];
  out->field_place[out->field_count] = j->piece[0].field_place[i];
  out->field_array[out->field_count++] = array;
done:
  return status;
}

static bw_status join_fields(joining *j, bw_mesh_file *out) {
  bw_status status = BW_OK;
  int count = j->piece[0].field_count;
  if (count == 0)
    return BW_OK;
  out->field_name = BW_NEW0(j->context, char *, count);
  out->field_place = BW_NEW0(j->context, bw_field_place, count);
  out->field_array = BW_NEW0(j->context, bw_array *, count);
  if (!out->field_name || !out->field_place || !out->field_array)
    return BW_MEMORY;
  for (int i = 0; i < count; i++)
    if (!bwi_pvtu_joins(j->piece[0].field_name[i]))
      BW_TRY(join_field(j, i, out));
done:
  /* names that moved are the mesh's now */
  for (int i = 0; i < out->field_count; i++)
    for (int f = 0; f < count; f++)
      if (j->piece[0].field_name[f] == out->field_name[i])
        j->piece[0].field_name[f] = NULL;
  return status;
}

bw_status bwi_pvtu_read(bw_context *context, const char *path, const unsigned char *bytes,
                        size_t count, bw_mesh_file *file) {
  bw_status status = BW_OK;
  bwi_cursor cursor;
  joining j = {.context = context, .path = path};
  bw_mesh_file out = {0};
  bwi_cursor_init(&cursor, context, path, bytes, count);
  BW_TRY(read_pieces(&cursor, &j));
  BW_TRY(list_items(&j));
  BW_TRY(join_nodes(&j));
  BW_TRY(join_elements(&j));
  qsort(j.node, (size_t)j.nodes, sizeof *j.node, by_at);
  out.info = (bw_read_info){.format = "PVTU", .group_count = 1, .skipped = j.skipped};
  for (size_t k = 0; k < j.count; k++)
    out.info.skipped += j.piece[k].info.skipped;
  BW_TRY(make_mesh(&j, &out.mesh));
  BW_TRY(join_fields(&j, &out));
done:
  for (size_t k = 0; k < j.count; k++)
    bw_mesh_file_clear(&j.piece[k]);
  bw_free(j.piece);
  bw_free(j.node);
  bw_free(j.element);
  bw_free(j.joined);
  bw_free(j.from);
  if (status == BW_OK)
    *file = out;
  else
    bw_mesh_file_clear(&out);
  return status;
}
