/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* VTU: round trips, every encoding that VTK writes, refusals. */
#include "mesh_check.h"

static void round_trip(void **state) {
  bw_context *context = check_context(state);
  char path[300];
  temporary(path, "a.vtu");
  for (int order = 1; order <= 2; order++) {
    sample s = make_sample(context, order, order == 2);
    bw_mesh_file file;
    check_ok(context, bw_mesh_write(context, s.mesh, path, FIELDS, s.field));
    check_ok(context, bw_mesh_read(context, path, &file));
    same_mesh(s.mesh, file.mesh);
    assert_int_equal(file.field_count, FIELDS);
    for (int f = 0; f < FIELDS; f++)
      same_field(&file, &s.field[f], true);
    bw_mesh_file_clear(&file);
    bw_surface *boundary, *read;
    check_ok(context, bw_mesh_boundary(context, s.mesh, &boundary, NULL));
    check_ok(context, bw_surface_read(context, path, &read, NULL));
    check_near(bw_surface_area(read), bw_surface_area(boundary), 1e-15);
    bw_release(read);
    check_ok(context, bw_surface_write(context, boundary, path, false));
    check_ok(context, bw_surface_read(context, path, &read, NULL));
    assert_int_equal(read->triangle_count, boundary->triangle_count);
    assert_memory_equal(read->point, boundary->point, 24 * (size_t)read->point_count);
    bw_release(read);
    bw_release(boundary);
    check_fails(context, BW_FORMAT, "holds no tetrahedra", bw_mesh_read(context, path, &file));
    s.field[0].place = BW_ON_ELEMENTS;
    check_fails(context, BW_INVALID, "field 'u' on elements has",
                bw_mesh_write(context, s.mesh, path, FIELDS, s.field));
    free_sample(&s);
  }
  unlink(path);
}

/* The same bytes whatever the number of threads. */
static void threads_do_not_matter(void **state) {
  bw_context *context = check_context(state);
  char path[300], digest[2][65];
  bw_mesh *mesh;
  check_ok(context, bw_mesh_box_grid(context, (double[3]){0, 0, 0}, (double[3]){1, 2, 3},
                                     (int[3]){25, 25, 25}, 1, &mesh));
  temporary(path, "threads.vtu");
  for (int i = 0; i < 2; i++) {
    check_ok(context, bw_set_threads(context, i ? 3 : 1));
    check_ok(context, bw_mesh_write(context, mesh, path, 0, NULL));
    check_ok(context, bw_sha256_file(context, path, digest[i]));
  }
  assert_string_equal(digest[0], digest[1]);
  unlink(path);
  bw_release(mesh);
}

static bw_status parse(bw_context *context, const char *text, bw_mesh_file *file) {
  return bw_mesh_parse(context, "a.vtu", (const unsigned char *)text, strlen(text), file);
}

static const char ascii[] =
    "\n<?xml version='1.0'?>\n<!-- <Piece/> -->\n<VTKFile type=\"UnstructuredGrid\" "
    "byte_order=\"BigEndian\"><UnstructuredGrid>\n<FieldData><DataArray type=\"String\" "
    "Name=\"TIME\" format=\"ascii\">1 2</DataArray></FieldData>"
    "<Piece NumberOfPoints='6' NumberOfCells='3'>\n"
    "<PointData Scalars=\"t\"><DataArray type=\"Float32\" Name=\"t &lt; 0\" format=\"ascii\">\n"
    "1 2 nan 4 -inf 6\n</DataArray></PointData>\n"
    "<CellData><DataArray type=\"Int64\" Name=\"c\" NumberOfComponents=\"2\">1 2 3 4 5 6"
    "</DataArray><DataArray type=\"Int32\" Name=\"region\">9 8 7</DataArray></CellData>\n"
    "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0\n"
    "0 1 0 9 9 9 0 0 1 1 1 1</DataArray></Points><Cells>"
    "<DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 0 1 2 4 1 2 4 5</DataArray>"
    "<DataArray type=\"Int32\" Name=\"offsets\">3 7 11</DataArray>"
    "<DataArray type=\"UInt8\" Name=\"types\">5 10 10</DataArray></Cells></Piece>\n"
    "</UnstructuredGrid></VTKFile>";

static void text_form(void **state) {
  bw_context *context = check_context(state);
  bw_mesh_file file;
  check_ok(context, parse(context, ascii, &file));
  assert_int_equal(file.mesh->node_count, 5); /* point 3 is not used */
  assert_int_equal(file.mesh->element_count, 2);
  assert_int_equal(file.mesh->regions[file.mesh->region[0]].tag, 8);
  assert_int_equal(file.mesh->regions[file.mesh->region[1]].tag, 7);
  assert_int_equal(file.info.skipped, 1);
  assert_int_equal(file.field_count, 2);
  assert_string_equal(file.field_name[0], "t < 0");
  assert_true(isnan(bw_array_get(file.field_array[0], 2, 0)));
  assert_true(isinf(bw_array_get(file.field_array[0], 3, 0)));
  assert_true(bw_array_get(file.field_array[0], 4, 0) == 6);
  assert_int_equal(file.field_array[1]->type, BW_I64);
  assert_true(bw_array_get(file.field_array[1], 1, 1) == 6);
  bw_mesh_file_clear(&file);
}

static void replace(char *text, const char *from, const char *to) {
  char *at = strstr(text, from);
  assert_non_null(at);
  memmove(at + strlen(to), at + strlen(from), strlen(at + strlen(from)) + 1);
  memcpy(at, to, strlen(to));
}

/* VTK orders a symmetric tensor xx yy zz xy yz zx, the engine xx yy zz yz zx xy. */
static void tensor_order(void **state) {
  bw_context *context = check_context(state);
  char text[3000];
  bw_mesh_file file;
  strcpy(text, ascii);
  replace(text, "<DataArray type=\"Int64\" Name=\"c\" NumberOfComponents=\"2\">1 2 3 4 5 6",
          "<DataArray type=\"Float64\" Name=\"c\" NumberOfComponents=\"6\">0 0 0 0 0 0 11 22 33 12 "
          "23 31 0 0 0 0 0 0");
  check_ok(context, parse(context, text, &file));
  static const double expected[6] = {11, 22, 33, 23, 31, 12};
  for (int k = 0; k < 6; k++)
    assert_true(bw_array_get(file.field_array[1], 0, k) == expected[k]);
  bw_mesh_file_clear(&file);
}

/* Points and cells of two tetrahedra as appended raw data with 32-bit headers, big endian, not
 * compressed; then all in base64 in the tags, header and data encoded together. */
static void put(unsigned char **to, uint64_t value, int bytes) {
  for (int k = bytes - 1; k >= 0; k--)
    *(*to)++ = (unsigned char)(value >> 8 * k);
}

static size_t big_endian_arrays(unsigned char *bytes, size_t start[5]) {
  static const float x[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  static const int corner[8] = {0, 1, 2, 3, 1, 2, 3, 4};
  unsigned char *at = bytes;
  start[0] = 0;
  put(&at, 60, 4);
  for (int i = 0; i < 15; i++) {
    uint32_t bits;
    memcpy(&bits, &x[0][0] + i, 4);
    put(&at, bits, 4);
  }
  start[1] = (size_t)(at - bytes);
  put(&at, 64, 4);
  for (int i = 0; i < 8; i++)
    put(&at, (uint64_t)corner[i], 8);
  start[2] = (size_t)(at - bytes);
  put(&at, 4, 4);
  put(&at, 4, 2), put(&at, 8, 2);
  start[3] = (size_t)(at - bytes);
  put(&at, 2, 4);
  put(&at, 10, 1), put(&at, 10, 1);
  return start[4] = (size_t)(at - bytes);
}

static size_t base64(char *to, const unsigned char *from, size_t count) {
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char *start = to;
  for (size_t i = 0; i < count; i += 3) {
    uint32_t bits = (uint32_t)from[i] << 16;
    bits |= i + 1 < count ? (uint32_t)from[i + 1] << 8 : 0;
    bits |= i + 2 < count ? from[i + 2] : 0;
    for (int k = 0; k < 4; k++)
      *to++ = i + (size_t)k <= count ? digit[bits >> (18 - 6 * k) & 63] : '=';
  }
  return (size_t)(to - start);
}

static void binary_forms(void **state) {
  bw_context *context = check_context(state);
  unsigned char data[400];
  size_t start[5], count = big_endian_arrays(data, start);
  static const char *const name[4] = {"Points", "connectivity", "offsets", "types"};
  static const char *const type[4] = {"Float32", "Int64", "UInt16", "UInt8"};
  for (int form = 0; form < 3; form++) { /* inline base64, appended raw, appended base64 */
    char text[4000], *at = text;
    at += sprintf(at, "<VTKFile type=\"UnstructuredGrid\" byte_order=\"BigEndian\" "
                      "header_type=\"UInt32\"><UnstructuredGrid>"
                      "<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">");
    size_t offset = 0;
    for (int i = 0; i < 4; i++) {
      size_t bytes = start[i + 1] - start[i];
      at += sprintf(at, "%s<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" ",
                    i == 0   ? "<Points>"
                    : i == 1 ? "</Points><Cells>"
                             : "",
                    type[i], name[i], i ? 1 : 3);
      if (form == 0) {
        at += sprintf(at, "format=\"binary\">\n");
        at += base64(at, data + start[i], bytes);
        at += sprintf(at, "\n</DataArray>");
      } else {
        at += sprintf(at, "format=\"appended\" offset=\"%zu\"/>", offset);
        offset += form == 1 ? bytes : (bytes + 2) / 3 * 4;
      }
    }
    at += sprintf(at, "</Cells></Piece></UnstructuredGrid>");
    if (form == 1) {
      at += sprintf(at, "<AppendedData encoding=\"raw\">_");
      memcpy(at, data, count);
      at += count;
    } else if (form == 2) {
      at += sprintf(at, "<AppendedData encoding=\"base64\">\n_");
      for (int i = 0; i < 4; i++)
        at += base64(at, data + start[i], start[i + 1] - start[i]);
    }
    at += sprintf(at, "</AppendedData></VTKFile>");
    bw_mesh_file file;
    check_ok(context,
             bw_mesh_parse(context, "a.vtu", (unsigned char *)text, (size_t)(at - text), &file));
    assert_int_equal(file.mesh->element_count, 2);
    check_near(bw_mesh_volume(file.mesh), 1.0 / 6 + 1.0 / 3, 1e-15);
    bw_mesh_file_clear(&file);
  }
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  static const char *const change[][3] = {
      {"'6' ", "'4000000000' ", "at most 2147483647"},
      {"'6' ", "'2000000000' ", "the number of values of 'a' is 6000000000, but only"},
      {"'6' ", "'7' ", "the number of values of 'a' is 21, but only 35 bytes follow"},
      {"'6' ", "'5' ", "goes on behind the 15 numbers"},
      {"'6' ", "'x' ", "found NumberOfPoints=\"x\""},
      {"'3'", "'2000000000'", "the number of cells is"},
      {"4 5<", "4 6<", "number 10 of the connectivity is point 6"},
      {"4 5<", "4 -1<", "number 10 of the connectivity is point -1"},
      {">3 7 11<", ">3 2 11<", "offsets of cells must grow"},
      {">3 7 11<", ">3 7 4611686018427387904<", "is 4611686018427387904"},
      {"9 9 9", "9 nan 9", "'nan': a finite number was expected"},
      {"UnstructuredGrid", "PolyData", "of type 'PolyData'"},
      {"\"BigEndian\"", "\"BigEndian\" compressor=\"vtkLZ4DataCompressor\"", "vtkLZ4"},
      {"\"BigEndian\"", "\"MiddleEndian\"", "found 'MiddleEndian'"},
      {"<VTKFile", "<VTKPile", "found the XML tag 'VTKPile'"},
      {"\"types\"", "\"typos\"", "has no array of types"},
      {"\"offsets\">", "\"offsets\" format=\"appended\" offset=\"99\">", "beyond the end"},
      {"type=\"Int32\" Name=\"offsets\"", "type=\"Float32\" Name=\"offsets\"", "integer type"},
  };
  for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
    char text[3000];
    bw_mesh_file file;
    strcpy(text, ascii);
    if (strncmp(change[i][2], "the number of values", 20) == 0)
      replace(text, "<DataArray type=\"Float64\"", "<DataArray Name=\"a\" type=\"Float64\"");
    replace(text, change[i][0], change[i][1]);
    check_fails(context, BW_FORMAT, change[i][2], parse(context, text, &file));
    assert_null(file.mesh);
  }
}

/* A compressed array whose header lies, each word in turn. */
static void damaged_compression(void **state) {
  bw_context *context = check_context(state);
  char path[300];
  sample s = make_sample(context, 1, false);
  unsigned char *bytes;
  size_t count;
  check_ok(context, bw_mesh_write(context, s.mesh, temporary(path, "c.vtu"), 0, NULL));
  check_ok(context, bw_read_file(context, path, &bytes, &count));
  unsigned char *data = memmem(bytes, count, "\n_", 2);
  for (int word = 0; word < 5; word++)
    for (int value = 0; value < 3 && word != 1; value++) { /* one block: only its own size counts */
      unsigned char kept[8];
      bw_mesh_file file;
      memcpy(kept, data + 2 + 8 * word, 8);
      memset(data + 2 + 8 * word, value == 0 ? 0xFF : value == 1 ? 0x7F : 0, value == 1 ? 5 : 8);
      check_fails(context, BW_FORMAT, "c.vtu: byte",
                  bw_mesh_parse(context, path, bytes, count, &file));
      memcpy(data + 2 + 8 * word, kept, 8);
    }
  bw_free(bytes);
  free_sample(&s);
  unlink(path);
}

static void out_of_memory(void **state) {
  bw_context *context = check_context(state);
  sample s = make_sample(context, 1, true);
  char path[300];
  temporary(path, "memory.vtu");
  for (int writing = 1; writing >= 0; writing--)
    check_each_allocation(context, status, 10) {
      bw_mesh_file file = {0};
      status = writing ? bw_mesh_write(context, s.mesh, path, FIELDS, s.field)
                       : bw_mesh_read(context, path, &file);
      bw_mesh_file_clear(&file);
      if (writing && status != BW_OK)
        assert_int_not_equal(access(path, F_OK), 0);
    }
  free_sample(&s);
  unlink(path);
}

check_main(check_test(round_trip), check_test(threads_do_not_matter), check_test(text_form),
           check_test(binary_forms), check_test(tensor_order), check_test(refusals),
           check_test(damaged_compression), check_test(out_of_memory))
