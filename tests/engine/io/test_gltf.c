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
           check_test(refusals), check_test(out_of_memory))
