/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* glTF and the JSON in it: what a strict reader refuses, with the byte; nodes; memory. */
#include "io/json.h"
#include "io_check.h"

static bw_status parse(bw_context *context, const char *text, bw_surface **surface) {
  *surface = NULL;
  return bw_surface_parse(context, "a.gltf", (const unsigned char *)text, strlen(text), surface,
                          NULL);
}

static void refuse(void **state, const char *text, const char *message) {
  bw_context *context = check_context(state);
  bw_surface *surface;
  assert_int_not_equal(parse(context, text, &surface), BW_OK);
  assert_null(surface);
  if (!strstr(bw_message(context), message))
    fail_msg("expected '%s' in '%s'", message, bw_message(context));
}

static bw_status read_json(bw_context *context, const char *text, bwi_json *json) {
  bwi_cursor cursor;
  memset(json, 0, sizeof *json);
  bwi_cursor_init(&cursor, context, "a.json", (const unsigned char *)text, strlen(text));
  return bwi_json_parse(&cursor, json);
}

static void json_values(void **state) {
  bw_context *context = check_context(state);
  bwi_json json;
  char text[32];
  check_ok(context, read_json(context,
                              " {\"a\" : [1, -2.5e-1, true, null, \"\\u00e9\\ud83d\\ude00\\n\"],\n"
                              "\"b\":{}, \"c\": 0 } ",
                              &json));
  int32_t list = bwi_json_member(&json, 0, "a");
  assert_int_equal(json.value[list].count, 5);
  int32_t second = json.value[json.value[list].first].next;
  assert_true(json.value[second].number == -0.25);
  assert_int_equal(json.value[bwi_json_member(&json, 0, "b")].count, 0);
  assert_int_equal(bwi_json_member(&json, 0, "d"), 0);
  int32_t string = list;
  for (int32_t at = json.value[list].first; at; at = json.value[at].next)
    string = at;
  assert_int_equal(bwi_json_text(&json.value[string], text, sizeof text), 7);
  assert_string_equal(text, "\xC3\xA9\xF0\x9F\x98\x80\n");
  assert_int_equal(bwi_json_text(&json.value[string], text, 5), 7);
  assert_string_equal(text, "\xC3\xA9"); /* no half characters */
  bw_free(json.value);
  /* Characters of one to four bytes, and halves of pairs that stand alone. */
  check_ok(
      context,
      read_json(context, "\"\\u007F\\u0080\\u07FF\\u0800\\uDbFf\\uDfFf\\uD800x\\udc00\"", &json));
  bwi_json_text(&json.value[0], text, sizeof text);
  assert_string_equal(text,
                      "\x7F\xC2\x80\xDF\xBF\xE0\xA0\x80\xF4\x8F\xBF\xBF\xEF\xBF\xBDx\xEF\xBF\xBD");
  bw_free(json.value);
}

static void json_refusals(void **state) {
  static const char *const bad[] = {"",         "{",
                                    "[1,]",     "{\"a\":1,}",
                                    "{a:1}",    "{\"a\" 1}",
                                    "[1 2]",    "01",
                                    "1.",       ".5",
                                    "+1",       "1e",
                                    "-",        "nan",
                                    "Infinity", "1e999",
                                    "\"a",      "\"\\x\"",
                                    "\"\\u12",  "\"\t\"",
                                    "tru",      "[]]",
                                    "1 2",      "{1:2}",
                                    "'a'",      "[\"\\u12g4\"]",
                                    "//x\n1",   "{\"a\":}",
                                    "[,1]",     "]",
                                    "\"\\",     "{\"a\"}"};
  bw_context *context = check_context(state);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    bwi_json json;
    if (read_json(context, bad[i], &json) != BW_FORMAT || !strstr(bw_message(context), "byte"))
      fail_msg("'%s': %s", bad[i], bw_message(context));
    bw_free(json.value);
  }
  char deep[400];
  for (int depth = BWI_JSON_DEPTH; depth <= BWI_JSON_DEPTH + 1; depth++) {
    bwi_json json;
    memset(deep, '[', (size_t)depth);
    memset(deep + depth, ']', (size_t)depth);
    deep[2 * depth] = 0;
    assert_int_equal(read_json(context, deep, &json), depth > BWI_JSON_DEPTH ? BW_FORMAT : BW_OK);
    bw_free(json.value);
  }
}

/* Four points and the facets of a tetrahedron of volume 1/6, in one buffer. */
#define DATA                                                                                       \
  "data:application/octet-stream;base64,"                                                          \
  "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAIBAAEDAQIDAAMC"
#define FILE_OF(nodes, extra, count, offset, uri)                                                  \
  "{\"asset\":{\"version\":\"2.0\"}," nodes extra                                                  \
  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"               \
  "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"        \
  "{\"bufferView\":1,\"componentType\":5121,\"count\":" count ",\"type\":\"SCALAR\"}],"            \
  "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":" offset         \
  ",\"byteLength\":12}],\"buffers\":[{\"byteLength\":60,\"uri\":\"" uri "\"}]}"
#define NODES(nodes) FILE_OF("\"nodes\":" nodes ",", "", "12", "48", DATA)

static void nodes_place_meshes(void **state) {
  static const struct {
    const char *text;
    double volume, max_x;
  } good[] = {
      {FILE_OF("", "", "12", "48", DATA), 1, 1},
      {NODES("[{\"mesh\":0,\"scale\":[2,2,-2],\"translation\":[3,0,0]}]"), 8, 5},
      {NODES("[{\"children\":[1],\"scale\":[3,1,1]},{\"mesh\":0}]"), 3, 3},
      {NODES("[{\"mesh\":0},{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,9,0,0,1]}]"), 2, 10}};
  bw_context *context = check_context(state);
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    bw_surface *surface;
    check_ok(context, parse(context, good[i].text, &surface));
    double max = -1;
    for (int32_t p = 0; p < surface->point_count; p++)
      max = surface->point[3 * p] > max ? surface->point[3 * p] : max;
    assert_true(fabs(max - good[i].max_x) < 1e-6);
    assert_true(fabs(6 * bw_surface_volume(surface) / good[i].volume - 1) < 1e-6);
    bw_release(surface);
  }
}

/* A strip of four facets; a fan of three and the base of its cone, which weld to one shell. */
static void strips_and_fans(void **state) {
  static const char data[] =
      "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
      "{\"bufferView\":1,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"},"
      "{\"bufferView\":2,\"componentType\":5121,\"count\":5,\"type\":\"SCALAR\"},"
      "{\"bufferView\":3,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}],"
      "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},"
      "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":6},"
      "{\"buffer\":0,\"byteOffset\":54,\"byteLength\":5},"
      "{\"buffer\":0,\"byteOffset\":59,\"byteLength\":3}],"
      "\"buffers\":[{\"byteLength\":62,\"uri\":\"data:;base64,"
      "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAIBAwACAwABAgAAAgE=\"}]}";
  static const char *const primitives[] = {
      "{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":5}",
      "{\"attributes\":{\"POSITION\":0},\"indices\":2,\"mode\":6},"
      "{\"attributes\":{\"POSITION\":0},\"indices\":3}"};
  bw_context *context = check_context(state);
  for (size_t i = 0; i < 2; i++) {
    char text[2000];
    bw_surface *surface;
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[%s]}],%s",
             primitives[i], data);
    check_ok(context, parse(context, text, &surface));
    assert_int_equal(surface->triangle_count, 4);
    assert_int_equal(surface->point_count, 4);
    check_near(6 * bw_surface_volume(surface), 1, 1e-6);
    bw_release(surface);
  }
}

/* What a node's translation, rotation q (of no unit length) and scale make of a point. */
static void move(const double q[4], const double scale[3], const double by[3], double x[3]) {
  double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), u[3], v[3];
  const double axis[3] = {q[0] / size, q[1] / size, q[2] / size};
  for (int k = 0; k < 3; k++)
    x[k] *= scale[k];
  bw_cross(axis, x, u); /* x + 2 w (axis x x) + 2 axis x (axis x x) */
  bw_cross(axis, u, v);
  for (int k = 0; k < 3; k++)
    x[k] += 2 * q[3] / size * u[k] + 2 * v[k] + by[k];
}

static void nodes_rotate(void **state) {
  static const double point[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  static const double q[2][4] = {{0.1, 0.2, 0.3, 0.4}, {-0.5, 0.1, 0.2, 0.7}};
  static const double scale[2][3] = {{1, 2, 3}, {1, 1, 0.5}}, by[2][3] = {{5, 6, 7}, {0.1, 0, -2}};
  bw_context *context = check_context(state);
  bw_surface *surface;
  check_ok(context,
           parse(context,
                 NODES("[{\"children\":[1],\"rotation\":[0.1,0.2,0.3,0.4],\"scale\":[1,2,3],"
                       "\"translation\":[5,6,7]},{\"mesh\":0,\"rotation\":[-0.5,0.1,0.2,0.7],"
                       "\"scale\":[1,1,0.5],\"translation\":[0.1,0,-2]}]"),
                 &surface));
  assert_int_equal(surface->point_count, 4);
  for (int i = 0; i < 4; i++) {
    double x[3] = {point[i][0], point[i][1], point[i][2]}, least = HUGE_VAL;
    for (int n = 1; n >= 0; n--)
      move(q[n], scale[n], by[n], x);
    for (int p = 0; p < 4; p++) { /* y is up in the file */
      const double *y = surface->point + 3 * p;
      least = fmin(least, fabs(y[0] - x[0]) + fabs(y[1] + x[2]) + fabs(y[2] - x[1]));
    }
    assert_true(least < 1e-6);
  }
  check_near(6 * bw_surface_volume(surface), 3, 1e-6);
  bw_release(surface);
}

/* Integers that stand for fractions, with bytes between and before the points. */
#define SHORTS(offset, length)                                                                     \
  "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}" \
  ","                                                                                              \
  "\"indices\":1}]}],\"accessors\":[{\"bufferView\":0,\"byteOffset\":" offset                      \
  ",\"componentType\":5122,\"normalized\":true,\"count\":4,\"type\":\"VEC3\"},"                    \
  "{\"bufferView\":1,\"componentType\":5121,\"count\":12,\"type\":\"SCALAR\"}],\"bufferViews\":["  \
  "{\"buffer\":0,\"byteStride\":8,\"byteLength\":" length "},{\"buffer\":0,\"byteOffset\":36,"     \
  "\"byteLength\":12}],\"buffers\":[{\"byteLength\":48,\"uri\":\"data:;base64,"                    \
  "f39/fwAAAAAAAE0A/38AAAAATQAAAP9/AABNAAAAAAD/f00AAAIBAAEDAQIDAAMC\"}]}"

static void accessors(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface;
  check_ok(context, parse(context, SHORTS("4", "36"), &surface));
  check_near(6 * bw_surface_volume(surface), 1, 1e-12);
  bw_release(surface);
  check_ok(context, parse(context, SHORTS("4", "34"), &surface)); /* the last stride is not full */
  bw_release(surface);
  refuse(state, SHORTS("4", "33"), "4 elements do not fit into the 33 bytes");
}

static void scenes_and_names(void **state) {
  static const char text[] = FILE_OF(
      "\"scene\":1,\"scenes\":[{\"nodes\":[0]},{\"nodes\":[1,2]}],\"nodes\":[{\"mesh\":0},"
      "{\"mesh\":0,\"scale\":[2,2,2],\"name\":\"knob\"},{\"mesh\":0,\"translation\":[9,0,0]}],",
      "", "12", "48", DATA);
  bw_context *context = check_context(state);
  bw_surface *surface = NULL;
  bw_read_info info;
  char named[sizeof text + 20];
  const char *meshes = strstr(text, "[{\"primitives");
  snprintf(named, sizeof named, "%.*s[{\"name\":\"part\",%s", (int)(meshes - text), text,
           meshes + 2);
  check_ok(context, parse_text(context, "a.gltf", named, &surface, &info));
  check_near(6 * bw_surface_volume(surface), 8 + 1, 1e-6);
  assert_string_equal(info.group_name[0].text, "knob"); /* of the node, before that of the mesh */
  assert_string_equal(info.group_name[1].text, "part");
  bw_release(surface);
  bw_free(info.group_name);
}

/* A thousand nodes that place the same thousand facets. */
static void repeated_meshes(void **state) {
  enum { COUNT = 1000 };
  char *text = malloc(30 * COUNT), *at = text;
  at += sprintf(at, "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}");
  for (int i = 1; i < COUNT; i++)
    at += sprintf(at, ",{\"mesh\":0}");
  at += sprintf(
      at,
      "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
      "\"accessors\":[{\"bufferView\":0,\"componentType\":5121,\"count\":3,\"type\":\"VEC3\"},"
      "{\"bufferView\":0,\"componentType\":5121,\"count\":%d,\"type\":\"SCALAR\"}],"
      "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%d}],\"buffers\":[{\"byteLength\":%d,"
      "\"uri\":\"data:;base64,",
      3 * COUNT, 3 * COUNT, 3 * COUNT);
  for (int i = 0; i < COUNT; i++)
    at += sprintf(at, "AAEC"); /* 0, 1, 2 */
  sprintf(at, "\"}]}");
  refuse(state, text, "nodes repeat meshes");
  free(text);
}

/* The tetrahedron, of which elements are replaced: a byte of its facets says which. */
#define SPARSE(index, count)                                                                       \
  "{\"asset\":{\"version\":\"2.0\"},"                                                              \
  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"               \
  "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\","         \
  "\"sparse\":{\"count\":" count ",\"indices\":{\"bufferView\":1,\"byteOffset\":" index            \
  ",\"componentType\":5121},\"values\":{\"bufferView\":2}}},"                                      \
  "{\"bufferView\":1,\"componentType\":5121,\"count\":12,\"type\":\"SCALAR\"}],"                   \
  "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,"             \
  "\"byteLength\":12},{\"buffer\":1,\"byteLength\":12}],"                                          \
  "\"buffers\":[{\"byteLength\":60,\"uri\":\"" DATA "\"},"                                         \
  "{\"byteLength\":12,\"uri\":\"data:;base64,AABAQAAAAAAAAAAA\"}]}"

/* (3, 0, 0) in the place of the point (1, 0, 0), whose number stands at byte 2 of the facets. */
static void sparse_elements(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface;
  check_ok(context, parse(context, SPARSE("2", "1"), &surface));
  assert_true(fabs(6 * bw_surface_volume(surface) / 3 - 1) < 1e-6);
  bw_release(surface);
  check_ok(context, parse(context, SPARSE("2", "0"), &surface));
  assert_true(fabs(6 * bw_surface_volume(surface) - 1) < 1e-6);
  bw_release(surface);
  /* Without data of its own: zeros, but for the four points that are replaced. */
  static const char zeros[] =
      "{\"asset\":{\"version\":\"2.0\"},"
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
      "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[9,0,0]}],"
      "\"accessors\":[{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{"
      "\"count\":1,\"indices\":{\"bufferView\":0,\"byteOffset\":2,\"componentType\":5121},"
      "\"values\":{\"bufferView\":1}}},"
      "{\"bufferView\":0,\"componentType\":5121,\"count\":12,\"type\":\"SCALAR\"}],"
      "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12},"
      "{\"buffer\":1,\"byteLength\":12}],"
      "\"buffers\":[{\"byteLength\":60,\"uri\":\"" DATA "\"},"
      "{\"byteLength\":12,\"uri\":\"data:;base64,AABAQAAAAAAAAAAA\"}]}";
  check_ok(context, parse(context, zeros, &surface));
  assert_true(bw_surface_volume(surface) == 0);
  bw_release(surface);
  refuse(state, SPARSE("2", "2"), "2 elements do not fit into the 12 bytes");
  refuse(state, SPARSE("2", "5"), "an integer from 0 to 4");
  refuse(state, SPARSE("12", "1"), "1 elements do not fit");
}

static void refusals(void **state) {
  refuse(state, FILE_OF("", "", "13", "48", DATA), "13 elements do not fit into the 12 bytes");
  refuse(state, FILE_OF("", "", "-1", "48", DATA), "\"count\"");
  refuse(state, FILE_OF("", "", "12", "49", DATA), "ends at byte 61 of a buffer of 60");
  refuse(state, FILE_OF("", "", "12", "40", DATA), "names point 128");
  refuse(state, FILE_OF("", "", "12", "48", "data:;base64,A*AA"), "inside base64");
  refuse(state, FILE_OF("", "", "12", "48", "../a.bin"), "no file beside this one");
  refuse(state, FILE_OF("", "", "12", "48", "/etc/passwd"), "no file beside this one");
  refuse(state, FILE_OF("", "", "12", "48", "http://a/b"), "no file beside this one");
  refuse(state, FILE_OF("", "", "12", "48", "none.bin"), "none.bin");
  refuse(state, NODES("[{\"children\":[0]}]"), "holds no facet");
  refuse(state, NODES("[{\"children\":[1]},{\"children\":[2]},{\"children\":[1]}]"), "two nodes");
  refuse(state, NODES("[{\"mesh\":7}]"), "an integer from 0 to 0");
  refuse(state,
         "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[{\"attributes\":{"
         "\"POSITION\":3}}]}]}",
         "none of these");
  refuse(state, NODES("[{\"mesh\":0,\"scale\":[1,1]}]"), "3 numbers");
  refuse(state, FILE_OF("", "\"scenes\":[{\"nodes\":[5]}],", "12", "48", DATA), "a node from 0");
  refuse(state,
         FILE_OF("", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],", "12", "48", DATA),
         "KHR_draco_mesh_compression");
  refuse(state, "{\"asset\":{\"version\":\"1.0\"}}", "save it as glTF 2.0");
  refuse(state, "{\"asset\":{}}", "\"version\"");
  refuse(state, "glTF\2", "the head takes 12 bytes");
}

static void out_of_memory(void **state) {
  bw_context *context = check_context(state);
  check_each_allocation(context, status, 10) {
    bw_surface *surface = NULL;
    status = parse(context, NODES("[{\"mesh\":0},{\"mesh\":0,\"translation\":[9,0,0]}]"), &surface);
    bw_release(surface);
  }
}

check_main(check_test(json_values), check_test(json_refusals), check_test(nodes_place_meshes),
           check_test(strips_and_fans), check_test(nodes_rotate), check_test(accessors),
           check_test(scenes_and_names), check_test(repeated_meshes), check_test(sparse_elements),
           check_test(refusals), check_test(out_of_memory))
