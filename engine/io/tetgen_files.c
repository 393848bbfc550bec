/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* TetGen's pair of files. NAME.node: "points dimension attributes marker", then "number x y z
 * attributes... [marker]"; NAME.ele: "elements nodes attributes", then "number nodes...
 * attributes...". Numbers start at 0 or at 1, as the first point does. Attributes become fields
 * "attribute_1", ...; the first attribute of elements, where whole, the region; point markers a
 * field "marker". '#' begins a comment; those before the first row of NAME.ele have the names of
 * regions, "# region 3 insert".
 *
 * TetGen's order of the mid-edge nodes of a ten-node element is 23 03 01 12 13 02 (corners from
 * 0). */
#include "io/raw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const int middle_from[10] = {0, 1, 2, 3, 6, 7, 9, 5, 8, 4}; /* ours from TetGen's */

static bw_status need_record(bwi_cursor *cursor, bwi_cursor *line, const char *what) {
  return bwi_next_record(cursor, line) ? BW_OK
                                       : bwi_fail_word(cursor, (bwi_word){cursor->end, 0}, what);
}

static bw_status make_fields(bw_context *context, int64_t rows, int64_t columns, bw_array **array) {
  return columns > 0 ? bw_array_create(context, BW_F64, rows, columns, array) : BW_OK;
}

/* One field per column. */
static bw_status add_columns(bwi_raw *raw, const bw_array *all, bw_field_place place) {
  for (int64_t c = 0; all && c < all->columns; c++) {
    bw_array *column;
    char name[32];
    bw_status status = bw_array_create(raw->context, BW_F64, all->rows, 1, &column);
    if (status != BW_OK)
      return status;
    for (int64_t i = 0; i < all->rows; i++)
      ((double *)column->data)[i] = ((double *)all->data)[i * all->columns + c];
    int length = snprintf(name, sizeof name, "attribute_%d", (int)c + 1);
    status = bwi_raw_add_field(raw, (bwi_word){(const unsigned char *)name, (size_t)length}, place,
                               column);
    if (status != BW_OK)
      return status;
  }
  return BW_OK;
}

static bw_status read_counts(bwi_cursor *cursor, bwi_cursor *line, int64_t *value, int wanted,
                             const char *what) {
  bw_status status = need_record(cursor, line, what);
  for (int i = 0; i < 4 && status == BW_OK; i++) {
    bwi_skip_blank(line);
    value[i] = 0;
    if (i < wanted || line->at < line->end)
      status = bwi_read_integer(line, &value[i], what);
    if (status == BW_OK && value[i] < 0)
      status = bwi_fail_line(line, "%s is %lld: it cannot be negative", what, (long long)value[i]);
  }
  return status;
}

/* The number of the row must be the next one. */
static bw_status read_number(bwi_cursor *line, int64_t expected) {
  int64_t number;
  bw_status status = bwi_read_integer(line, &number, "the number of a row");
  if (status == BW_OK && number != expected)
    status = bwi_fail_line(line, "row %lld where row %lld was expected", (long long)number,
                           (long long)expected);
  return status;
}

static bw_status read_nodes(bwi_cursor *cursor, bwi_raw *raw, int64_t *first) {
  bw_status status = BW_OK;
  bwi_cursor line;
  bw_array *attributes = NULL, *marker = NULL;
  int64_t head[4], number;
  BW_TRY(read_counts(cursor, &line, head, 2, "a number of the first line (points, 3, ...)"));
  if (head[1] != 3 || head[2] > 1000 || head[3] > 1)
    BW_TRY(bwi_fail_line(&line,
                         "points in %lld dimensions with %lld attributes and %lld markers: "
                         "3 dimensions and 0 or 1 markers were expected",
                         (long long)head[1], (long long)head[2], (long long)head[3]));
  BW_TRY(bwi_check_count(cursor, (uint64_t)head[0], 8 + 2 * (size_t)(head[2] + head[3]),
                         "the number of points"));
  BW_TRY(make_fields(raw->context, head[0], head[2], &attributes));
  if (head[3])
    BW_TRY(bw_array_create(raw->context, BW_I32, head[0], 1, &marker));
  for (int64_t i = 0; i < head[0]; i++) {
    double x[3];
    BW_TRY(need_record(cursor, &line, "a point"));
    if (i == 0) {
      bwi_cursor peek = line;
      BW_TRY(bwi_read_integer(&peek, first, "the number of a point"));
      if (*first != 0 && *first != 1)
        BW_TRY(bwi_fail_line(&line, "the first point has the number %lld: 0 or 1 was expected",
                             (long long)*first));
    }
    BW_TRY(read_number(&line, *first + i));
    for (int k = 0; k < 3; k++)
      BW_TRY(bwi_read_real(&line, &x[k], "a coordinate of a point"));
    for (int64_t k = 0; k < head[2]; k++)
      BW_TRY(bwi_read_any_real(&line, (double *)attributes->data + i * head[2] + k,
                               "an attribute of a point"));
    if (marker) {
      BW_TRY(bwi_read_integer(&line, &number, "the marker of a point"));
      ((int32_t *)marker->data)[i] = (int32_t)number;
    }
    BW_TRY(bwi_raw_point(raw, x));
  }
  BW_TRY(add_columns(raw, attributes, BW_ON_NODES));
  if (marker) {
    bw_array *taken = marker;
    marker = NULL;
    BW_TRY(
        bwi_raw_add_field(raw, (bwi_word){(const unsigned char *)"marker", 6}, BW_ON_NODES, taken));
  }
done:
  bw_release(attributes);
  bw_release(marker);
  return status;
}

/* The first attribute is the region when all of them are whole numbers. */
static bool take_region(bwi_raw *raw, const bw_array *attributes) {
  for (int64_t i = 0; attributes && i < attributes->rows; i++) {
    double value = bw_array_get(attributes, i, 0);
    if (!(fabs(value) <= INT32_MAX) || value != floor(value))
      return false;
  }
  for (int64_t i = 0; attributes && i < attributes->rows; i++)
    raw->region[i] = (int32_t)bw_array_get(attributes, i, 0);
  return attributes && attributes->rows > 0;
}

static bw_status read_elements(bwi_cursor *cursor, bwi_raw *raw, int64_t first) {
  bw_status status = BW_OK;
  bwi_cursor line;
  bw_array *attributes = NULL;
  int64_t head[4], value;
  BW_TRY(read_counts(cursor, &line, head, 2, "a number of the first line (elements, 4, ...)"));
  if ((head[1] != 4 && head[1] != 10) || head[2] > 1000)
    BW_TRY(
        bwi_fail_line(&line, "elements of %lld nodes: 4 or 10 were expected", (long long)head[1]));
  BW_TRY(bwi_check_count(cursor, (uint64_t)head[0], 2 + 2 * (size_t)(head[1] + head[2]),
                         "the number of elements"));
  BW_TRY(make_fields(raw->context, head[0], head[2], &attributes));
  for (int64_t i = 0; i < head[0]; i++) {
    int32_t given[10], node[10];
    BW_TRY(need_record(cursor, &line, "an element"));
    BW_TRY(read_number(&line, first + i));
    for (int64_t k = 0; k < head[1]; k++) {
      BW_TRY(bwi_read_integer(&line, &value, "a node of an element"));
      if (value < first || value - first >= (int64_t)raw->point_count)
        BW_TRY(bwi_fail_line(&line,
                             "element %lld names point %lld, but the points are %lld to "
                             "%lld",
                             (long long)(first + i), (long long)value, (long long)first,
                             (long long)(first + (int64_t)raw->point_count - 1)));
      given[k] = (int32_t)(value - first);
    }
    for (int k = 0; k < 10 && k < head[1]; k++)
      node[k] = given[head[1] == 10 ? middle_from[k] : k];
    for (int64_t k = 0; k < head[2]; k++)
      BW_TRY(bwi_read_any_real(&line, (double *)attributes->data + i * head[2] + k,
                               "an attribute of an element"));
    BW_TRY(bwi_raw_tet(raw, (int)head[1], node, 0));
  }
  if (take_region(raw, attributes))
    raw->regions = true;
  if (!raw->regions || attributes->columns > 1)
    BW_TRY(add_columns(raw, attributes, BW_ON_ELEMENTS));
done:
  bw_release(attributes);
  return status;
}

/* Comments before the first row. */
static bw_status read_names(bwi_cursor cursor, bwi_raw *raw) {
  bwi_cursor line;
  while (bwi_next_line(&cursor, &line)) {
    bwi_skip_blank(&line);
    if (line.at < line.end && *line.at != '#')
      break;
    if (line.at < line.end) {
      line.at++;
      bw_status status = bwi_read_region_comment(&line, raw);
      if (status != BW_OK)
        return status;
    }
  }
  return BW_OK;
}

bw_status bwi_tetgen_read(bwi_cursor *node, bwi_cursor *ele, bwi_raw *raw, const char **format) {
  int64_t first = 1;
  *format = "TetGen";
  bw_status status = read_nodes(node, raw, &first);
  if (status == BW_OK)
    status = read_names(*ele, raw);
  return status == BW_OK ? read_elements(ele, raw, first) : status;
}

/* ---- writing ------------------------------------------------------------------------------- */

static void write_nodes(bw_writer *writer, const bw_mesh *mesh) {
  bw_writer_print(writer, "%d 3 0 0\n", (int)mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    bw_writer_integer(writer, (int64_t)i + 1);
    for (size_t k = 0; k < 3; k++) {
      bw_writer_bytes(writer, " ", 1);
      bw_writer_number(writer, mesh->node[3 * (size_t)i + k]);
    }
    bw_writer_bytes(writer, "\n", 1);
  }
}

static void write_elements(bw_writer *writer, const bw_mesh *mesh) {
  int width = mesh->nodes_per_element, place[10];
  for (int k = 0; k < 10; k++)
    place[width == 10 ? middle_from[k] : k] = k;
  bwi_write_region_comments(writer, mesh);
  bw_writer_print(writer, "%d %d %d\n", (int)mesh->element_count, width, mesh->region ? 1 : 0);
  for (int32_t e = 0; e < mesh->element_count; e++) {
    bw_writer_integer(writer, (int64_t)e + 1);
    for (int k = 0; k < width; k++) {
      bw_writer_bytes(writer, " ", 1);
      bw_writer_integer(writer, (int64_t)mesh->element[(int64_t)e * width + place[k]] + 1);
    }
    if (mesh->region)
      bw_writer_print(writer, " %d", (int)mesh->regions[mesh->region[e]].tag);
    bw_writer_bytes(writer, "\n", 1);
  }
}

/* Both files are written before either is put in place. */
bw_status bwi_tetgen_write(bw_context *context, const bw_mesh *mesh, const char *node_path,
                           const char *ele_path) {
  bw_status status = BW_OK;
  bw_writer *node = NULL, *ele = NULL;
  BW_TRY(bw_writer_open(context, node_path, &node));
  BW_TRY(bw_writer_open(context, ele_path, &ele));
  write_nodes(node, mesh);
  write_elements(ele, mesh);
  BW_TRY(bw_writer_bytes(node, NULL, 0));
  BW_TRY(bw_writer_bytes(ele, NULL, 0));
  status = bw_writer_commit(ele);
  ele = NULL;
  if (status == BW_OK) {
    status = bw_writer_commit(node);
    node = NULL;
  }
done:
  bw_writer_discard(node);
  bw_writer_discard(ele);
  return status;
}
