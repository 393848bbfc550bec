/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Surface files: round trips, odd variants that must be read, bad ones that must be refused with
 * their place, and the shared models. */
#include "check.h"
#include "io_check.h"

#include <sys/stat.h>
#include <unistd.h>

static const char tetra_stl[] = "solid a b\n"
                                "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\n"
                                "vertex 1 0 0\nendloop\nendfacet\n"
                                "facet normal nan nan nan\nouter loop\nvertex 0 0 0\n"
                                "vertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid a b\n"
                                "SOLID c\n"
                                "FACET NORMAL 0 0 0 outer loop vertex 0 0 0 vertex 0 0 1 "
                                "vertex 0 1.0D+0 0 endloop endfacet\r\n"
                                "facet normal 0 0 0\router loop\rvertex +1 0 0\rvertex 0 1. 0\r"
                                "vertex 0 0 .1e+1\rendloop\rendfacet";

static void ascii_stl_variants(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface;
  bw_read_info info;
  check_ok(context, parse_text(context, "a.stl", tetra_stl, &surface, &info));
  assert_int_equal(surface->point_count, 4);
  assert_int_equal(surface->triangle_count, 4);
  assert_int_equal(info.group_count, 2);
  assert_int_equal(surface->group[1], 0);
  assert_int_equal(surface->group[2], 1);
  check_near(bw_surface_volume(surface), 1.0 / 6, 1e-15);
  assert_string_equal(info.format, "STL ASCII");
  bw_release(surface);
}

static void refuse(void **state, const char *name, const char *text, const char *message) {
  bw_context *context = check_context(state);
  bw_surface *surface = NULL;
  check_fails(context, BW_FORMAT, message, parse_text(context, name, text, &surface, NULL));
  assert_null(surface);
}

static void ascii_stl_refusals(void **state) {
  refuse(state, "a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n",
         "a.stl:4: a coordinate of a vertex is 'nan': a finite number");
  refuse(state, "a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1e999\n", "a.stl:4:");
  refuse(state, "a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0,5 0\n",
         "a decimal point, not a comma");
  refuse(state, "a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex",
         "a.stl:5: the file ends where a coordinate");
  refuse(state, "a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop",
         "a facet with 1 vertices");
  refuse(state, "a.stl", "solid\nfacet normal 0 0 1\nouter hoop\n", "found 'hoop'");
  refuse(state, "a.stl", "solid\nfacet normal 0 0 1\n", "the file ends where 'outer loop'");
  refuse(state, "a.stl", "solid x\nfoo\n", "a.stl:2: found 'foo'");
  refuse(state, "a.stl", "solid x\nendsolid x\n", "holds no facet");
  refuse(state, "a.stl", "", "a.stl: byte 0: the file is empty");
  refuse(state, "a.stl", "hello", "a.stl:1: found 'hello' where 'solid'");
}

static void binary_stl_refusals(void **state) {
  bw_context *context = check_context(state);
  unsigned char bytes[84 + 100] = "solid but binary";
  bw_surface *surface = NULL;
  memset(bytes + 80, 0xFF, 4);
  check_fails(context, BW_FORMAT, "byte 80: the header of this binary STL file claims 4294967295",
              bw_surface_parse(context, "b.stl", bytes, sizeof bytes, &surface, NULL));
  memcpy(bytes + 80, "\2\0\0\0", 4);
  memcpy(bytes + 84 + 50 + 12, "\0\0\xC0\x7F", 4);
  check_fails(context, BW_FORMAT, "byte 146: corner 1 of facet 2",
              bw_surface_parse(context, "b.stl", bytes, sizeof bytes, &surface, NULL));
  memcpy(bytes + 80, "\0\0\0\0", 4);
  check_fails(context, BW_FORMAT, "holds no facet",
              bw_surface_parse(context, "b.stl", bytes, 84, &surface, NULL));
  assert_null(surface);
}

static void obj_variants(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface;
  bw_read_info info;
  /* a cube of quads: continuation, all corner forms, negative numbers, a facet before its vertices,
     colours, a comment behind a facet, Windows line ends, a byte order mark */
  static const char cube[] = "\xEF\xBB\xBF# cube\r\nf 1 4 3 2 # below\r\no box\r\n"
                             "v 0 0 0 1 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\n"
                             "vn 0 0 1\r\nv 0 0 1 1.0\r\nv 1 0 1\r\nv 1 1 1\r\nv 0 1 1\r\n"
                             "f 5/1 6/1 \\\r\n7/1 8/1\r\nusemtl x\r\ng side\r\n"
                             "f -8//1 -7//1 -3//1 -4//1\r\nf 2/1/1 3/1/1 7/1/1 6/1/1\r\n"
                             "s off\r\nl 1 2\r\ng\r\nf 3 4 8 7\r\nf 4 1 5 8";
  check_ok(context, parse_text(context, "cube.obj", cube, &surface, &info));
  assert_int_equal(surface->point_count, 8);
  assert_int_equal(surface->triangle_count, 12);
  check_near(bw_surface_volume(surface), 1, 1e-15);
  check_near(bw_surface_area(surface), 6, 1e-15);
  assert_int_equal(info.polygons, 6);
  assert_int_equal(info.skipped, 1);
  assert_int_equal(info.group_count, 4);
  bw_release(surface);
}

static void obj_refusals(void **state) {
  refuse(state, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
         "a.obj:4: a facet names vertex 4, but there are 3 vertices in the file");
  refuse(state, "a.obj", "v 0 0 0\nf -2 1 1\n", "a.obj:2: a facet names vertex -2");
  refuse(state, "a.obj", "v 0 0 0\nf 0 1 1\n", "vertex 0");
  refuse(state, "a.obj", "v 0 0 0\nf 1 1\n", "a facet of 2 corners");
  refuse(state, "a.obj", "v 0 0 0\nf 1/x 1 1\n", "found '1/x'");
  refuse(state, "a.obj", "v 0 0 0\nf 1/1/1/1 1 1\n", "found '1/1/1/1'");
  refuse(state, "a.obj", "v 0 0\nf 1 1 1\n", "a.obj:1: the line ends where the z coordinate");
  refuse(state, "a.obj", "v 0 0 -inf\n", "'-inf'");
  refuse(state, "a.obj", "v 99999999999999999999 0 0\nf 99999999999999999999 1 1\n", "a.obj:2:");
  refuse(state, "a.obj", "# nothing\n", "holds no facet");
}

static void off_variants(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface;
  bw_read_info info;
  static const char *const text[] = {
      /* counts behind the word, comments, colours, a line, no last newline */
      "COFF 5 4 0 # counts\n\n0 0 0 255 0 0\n1 0 0 1 1 1 # one\n1 1 0\n0 1 0\n0 0 1\n"
      "4 0 3 2 1 0.5 0.5 0.5\n2 0 1\n3 0 1 4\r\n3 1 2 4",
      /* without the word; without the number of edges */
      "4 4\n0 0 0\n0 1 0\n1 0 0\n0 0 1\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n"};
  check_ok(context, parse_text(context, "a.off", text[0], &surface, &info));
  assert_int_equal(surface->triangle_count, 4);
  assert_int_equal(info.polygons, 1);
  assert_int_equal(info.skipped, 1);
  bw_release(surface);
  check_ok(context, parse_text(context, "a.off", text[1], &surface, &info));
  check_near(bw_surface_volume(surface), 1.0 / 6, 1e-15);
  bw_release(surface);
}

static void off_refusals(void **state) {
  refuse(state, "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
         "a.off:6: facet 1 names vertex 3, but there are 3");
  refuse(state, "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 nan\n3 0 1 2\n", "a.off:5:");
  refuse(state, "a.off", "OFF\n3000000000 1 0\n0 0 0\n", "the number of vertices is 3000000000");
  refuse(state, "a.off", "OFF\n3 4294967295 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         "the number of facets is 4294967295");
  refuse(state, "a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         "the file ends after 1 of 2 facets");
  refuse(state, "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n999999 0 1 2\n", "999999");
  refuse(state, "a.off", "OFF\n-3 1 0\n", "cannot be negative");
  refuse(state, "a.off", "OFF BINARY\n", "binary OFF is not read");
  refuse(state, "a.off", "4OFF\n1 1 1", "'4OFF'");
  refuse(state, "a.off", "OFF\n", "the number of vertices");
  refuse(state, "a.off", "OFF\n1 0 0\n0 0 0\n", "holds no facet");
}

static void ply_variants(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface;
  bw_read_info info;
  static const char text[] =
      "ply\r\nformat ascii 1.0\r\ncomment x\r\nobj_info y\r\nelement camera 1\r\n"
      "property float a\r\nproperty list uchar float b\r\nelement vertex 4\r\n"
      "property uchar red\r\nproperty float x\r\nproperty double y\r\nproperty int z\r\n"
      "property float quality\r\nelement empty 3\r\nelement face 3\r\n"
      "property list uint8 int32 vertex_index\r\nproperty list uchar float texcoord\r\n"
      "property short group\r\nelement edge 1\r\nproperty int vertex1\r\n"
      "end_header\r\n1.5 2 nan 4\r\n255 0 0 0 nan\r\n1 1 0 0 0\r\n2 0 1 0 0\r\n3 0 0 1 0\r\n"
      "3 0 2 1 0 7\r\n4 0 1 2 3 2 0.5 0.5 -2\r\n2 0 1 0 7\r\n12";
  check_ok(context, parse_text(context, "a.ply", text, &surface, &info));
  assert_int_equal(surface->point_count, 4);
  assert_int_equal(surface->triangle_count, 3);
  assert_int_equal(surface->group[0], 7);
  assert_int_equal(surface->group[1], -2);
  assert_int_equal(info.group_count, 2);
  bw_release(surface);
  static const char strip[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                              "property float y\nproperty float z\nelement tristrips 1\n"
                              "property list int int vertex_indices\nend_header\n"
                              "0 0 0\n1 0 0\n0 1 0\n1 1 0\n9 0 1 2 3 -1 3 2 1 0\n";
  check_ok(context, parse_text(context, "a.ply", strip, &surface, NULL));
  static const int32_t expected[] = {0, 1, 2, 2, 1, 3, 3, 2, 1, 1, 2, 0};
  assert_int_equal(surface->triangle_count, 4);
  assert_memory_equal(surface->triangle, expected, sizeof expected);
  bw_release(surface);
}

/* The same tetrahedron in both byte orders, with types of every width. */
static void ply_byte_orders(void **state) {
  bw_context *context = check_context(state);
  for (int big = 0; big < 2; big++) {
    unsigned char bytes[1000];
    size_t at = (size_t)sprintf((char *)bytes,
                                "ply\nformat binary_%s_endian 1.0\nelement vertex 4\n"
                                "property float x\nproperty double y\nproperty short z\n"
                                "element face 4\nproperty list ushort uint vertex_indices\n"
                                "property char flags\nend_header\n",
                                big ? "big" : "little");
    static const int corner[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    for (int i = 0; i < 4; i++) {
      float x = i == 1;
      double y = i == 2;
      int16_t z = i == 3 ? -1000 : 0;
      unsigned char part[14];
      memcpy(part, &x, 4), memcpy(part + 4, &y, 8), memcpy(part + 12, &z, 2);
      static const int start[4] = {0, 4, 12, 14};
      for (int p = 0; p < 3; p++)
        for (int k = start[p]; k < start[p + 1]; k++)
          bytes[at++] = part[big ? start[p] + start[p + 1] - 1 - k : k];
    }
    for (int i = 0; i < 4; i++) {
      bytes[at++] = big ? 0 : 3, bytes[at++] = big ? 3 : 0;
      for (int c = 0; c < 3; c++)
        for (int k = 0; k < 4; k++)
          bytes[at++] = k == (big ? 3 : 0) ? (unsigned char)corner[i][c] : 0;
      bytes[at++] = 13;
    }
    bw_surface *surface;
    check_ok(context, bw_surface_parse(context, "a.ply", bytes, at, &surface, NULL));
    check_near(bw_surface_volume(surface), -1000.0 / 6, 1e-12);
    bw_release(surface);
    check_fails(context, BW_FORMAT, "a.ply: byte",
                bw_surface_parse(context, "a.ply", bytes, at - 1, &surface, NULL));
  }
}

#define PLY_HEAD(vertices, faces)                                                                  \
  "ply\nformat ascii 1.0\nelement vertex " vertices                                                \
  "\nproperty float x\nproperty float y\nproperty float z\nelement face " faces                    \
  "\nproperty list uchar int vertex_indices\nend_header\n"

static void ply_refusals(void **state) {
  refuse(state, "a.ply", PLY_HEAD("4294967295", "1") "0 0 0\n", "is 4294967295, but only");
  refuse(state, "a.ply", PLY_HEAD("3", "99999999") "0 0 0\n0 0 0\n0 0 0\n",
         "is 99999999, but only");
  refuse(state, "a.ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
         "a.ply:13: a facet names vertex 3, but there are 3");
  refuse(state, "a.ply", PLY_HEAD("3", "1") "0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n",
         "a.ply:11: a number is 'inf'");
  refuse(state, "a.ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n200 0 1 2\n", "200");
  refuse(state, "a.ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n", "a.ply:13: the file ends");
  refuse(state, "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty foo x\n",
         "a.ply:4: found 'foo'");
  refuse(state, "a.ply", "ply\nformat ascii 2.0\n", "version 1.0");
  refuse(state, "a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n",
         "no property y");
  refuse(state, "a.ply", "ply\nelement vertex 1", "'end_header'");
}

/* Concave polygons: the area in the plane must be that of the polygon, with no overlap. */
static void concave_polygons(void **state) {
  bw_context *context = check_context(state);
  /* a comb with n teeth in a tilted plane; area by the shoelace formula */
  for (int teeth = 1; teeth <= 40; teeth += 13) {
    static char text[20000];
    int at = 0, corners = 0;
    double expected = 0, x[200], y[200];
    for (int i = 0; i < teeth; i++) {
      x[corners] = i, y[corners++] = 0;
      x[corners] = i + 0.8, y[corners++] = 3 + i % 3;
      x[corners] = i + 0.9, y[corners++] = 1;
    }
    x[corners] = teeth, y[corners++] = 9;
    x[corners] = -1, y[corners++] = 9;
    for (int i = 0; i < corners; i++) {
      int j = (i + 1) % corners;
      expected += (x[i] * y[j] - x[j] * y[i]) / 2;
      at += sprintf(text + at, "v %.17g %.17g %.17g\n", x[i] * 0.6 - 3, y[i], x[i] * 0.8);
    }
    at += sprintf(text + at, "f");
    for (int i = 1; i <= corners; i++)
      at += sprintf(text + at, " %d", i);
    bw_surface *surface;
    check_ok(context, parse_text(context, "comb.obj", text, &surface, NULL));
    assert_int_equal(surface->triangle_count, corners - 2);
    check_near(bw_surface_area(surface), expected, 1e-12 * expected);
    bw_release(surface);
  }
}

static void unknown_content(void **state) {
  refuse(state, "a.xyz", "1 2 3", "is of no format that is read here: STL");
  refuse(state, "a.step", "ISO-10303-21;\nHEADER;", "a STEP file");
  refuse(state, "a.obj", "\xFF\xFEv\0", "UTF-16");
  refuse(state, "a.stl.gz", "\x1F\x8B\x08", "gzip");
}

/* A sheet of 9 x 7 cells with coordinates that need all digits. */
static bw_surface *wavy_sheet(bw_context *context) {
  enum { NX = 9, NY = 7 };
  double point[(NX + 1) * (NY + 1) * 3];
  int32_t triangle[NX * NY * 2 * 3], *t = triangle;
  for (int j = 0; j <= NY; j++)
    for (int i = 0; i <= NX; i++) {
      double *p = point + 3 * (j * (NX + 1) + i);
      p[0] = i / 3.0, p[1] = 1e-9 * j / 7.0, p[2] = sin(i + 0.1) * cos(j) - 1e5 / 3;
    }
  for (int j = 0; j < NY; j++)
    for (int i = 0; i < NX; i++) {
      int a = j * (NX + 1) + i, b = a + 1, c = b + NX + 1, d = a + NX + 1;
      int corner[6] = {a, b, c, a, c, d};
      for (int k = 0; k < 6; k++)
        *t++ = corner[k];
    }
  bw_surface *surface;
  check_ok(context, bw_surface_copy(context, (NX + 1) * (NY + 1), point, NX * NY * 2, triangle,
                                    NULL, &surface));
  return surface;
}

static void round_trips(void **state) {
  bw_context *context = check_context(state);
  static const char *const path[] = {"a.stl", "ascii.stl", "a.obj", "a.off", "a.ply", "ascii.ply"};
  bw_surface *made, *grouped, *again;
  made = wavy_sheet(context);
  int32_t *group = malloc(sizeof *group * (size_t)made->triangle_count);
  for (int i = 0; i < made->triangle_count; i++)
    group[i] = i < 7 ? 0 : 1;
  check_ok(context, bw_surface_copy(context, made->point_count, made->point, made->triangle_count,
                                    made->triangle, group, &grouped));
  free(group);
  for (size_t i = 0; i < sizeof path / sizeof *path; i++) {
    bool ascii = strncmp(path[i], "ascii", 5) == 0, float32 = i == 0;
    char full[300];
    check_ok(context, bw_surface_write(context, grouped, temporary(full, path[i]), ascii));
    check_ok(context, bw_surface_read(context, full, &again, NULL));
    assert_int_equal(again->triangle_count, made->triangle_count);
    assert_int_equal(again->point_count, made->point_count);
    for (int t = 0; t < 3 * made->triangle_count; t++)
      for (int k = 0; k < 3; k++) {
        double expected = made->point[3 * made->triangle[t] + k];
        expected = float32 ? (double)(float)expected : expected;
        assert_true(again->point[3 * again->triangle[t] + k] == expected);
      }
    if (!float32 && i != 3) /* binary STL and OFF have no place for groups */
      for (int t = 0; t < made->triangle_count; t++)
        assert_int_equal(again->group ? again->group[t] : -1, grouped->group[t]);
    bw_release(again);
    unlink(full);
  }
  bw_release(made);
  bw_release(grouped);
}

static void shared_models(void **state) {
  bw_context *context = check_context(state);
  static const struct {
    const char *name;
    int triangles; /* 0: must be refused */
    const char *message;
  } model[] = {
      {"bottle_opener_round.stl", 2010, NULL},
      {"triceratops.off", 5660, NULL},
      {"chair.ply", 7444, NULL},
      {"engine_bracket.obj", 2000, NULL},
      {"anchor.off", 7598, NULL},
      {"tray_bottom.stl", 4520, NULL},
      {"fan_blade.stl", 12980, NULL},
      {"fertility.off", 9000, NULL},
      {"screwdriver.ply", 6786, NULL},
      {"gear_spur.stl", 1020, NULL},
      {"armadillo.obj", 86482, NULL},
      {"bad_horse_selfint.ply", 96966, NULL},
      {"bad_raptor_quads.obj", 17632, NULL},
      {"bad_chair_doublesided.obj", 12756, NULL},
      {"bad_pliers_shells.stl", 10712, NULL},
      {"bad_spider_ascii.stl", 1368, NULL},
      {"bad_idler_riser_inch.stl", 1572, NULL},
      {"bad_multibody_flipped.stl", 32, NULL},
      {"bad_truncated.stl", 0, "claims 20 facets, which take 1084 bytes, but the file has 584"},
      {"bad_count.stl", 0, "claims 22 facets, which take 1184 bytes, but the file has 1084"},
      {"bad_index.obj", 0, "bad_index.obj:20: a facet names vertex 8, but there are 6"},
      {"ok_negative_indices.obj", 12, NULL},
      {"bad_quads_gear_two_shells.obj", 440, NULL},
      {"bad_empty.off", 0, "the file is empty"},
      {"bad_empty_ascii.stl", 0, "holds no facet"},
      {"ok_ascii_odd_whitespace.stl", 1020, NULL},
      {"ok_solid_header_binary.stl", 1020, NULL},
      {"bad_huge_count.stl", 0, "claims 4294967295 facets"},
      {"bad_zero_area_dup.off", 7616, NULL},
      {"bad_flipped_normals.stl", 7598, NULL},
      {"bad_nan_inf.obj", 0, "bad_nan_inf.obj:8: the x coordinate of a vertex is 'nan'"},
  };
  for (size_t i = 0; i < sizeof model / sizeof *model; i++) {
    char path[400];
    if (!shared_file(path, "models", model[i].name))
      continue;
    bw_surface *surface;
    if (model[i].message) {
      check_fails(context, BW_FORMAT, model[i].message,
                  bw_surface_read(context, path, &surface, NULL));
    } else {
      check_ok(context, bw_surface_read(context, path, &surface, NULL));
      assert_int_equal(surface->triangle_count, model[i].triangles);
      bw_release(surface);
    }
  }
}

static void files_that_are_none(void **state) {
  bw_context *context = check_context(state);
  bw_surface *surface;
  char path[300];
  check_fails(context, BW_IO, "it is a directory",
              bw_surface_read(context, "/tmp", &surface, NULL));
  check_fails(context, BW_IO, "No such file",
              bw_surface_read(context, "/tmp/none/none.stl", &surface, NULL));
  check_fails(context, BW_IO, "not a regular file",
              bw_surface_read(context, "/dev/zero", &surface, NULL));
  temporary(path, "fifo.stl");
  assert_int_equal(mkfifo(path, 0600), 0);
  check_fails(context, BW_IO, "not a regular file", bw_surface_read(context, path, &surface, NULL));
  unlink(path);
  FILE *huge = fopen(temporary(path, "huge.stl"), "w");
  assert_int_equal(ftruncate(fileno(huge), (off_t)5 << 30), 0);
  fclose(huge);
  check_fails(context, BW_LIMIT, "5368709120 bytes",
              bw_surface_read(context, path, &surface, NULL));
  unlink(path);
}

static void out_of_memory(void **state) {
  bw_context *context = check_context(state);
  static const char *const name[] = {"a.stl", "a.obj", "a.off", "a.ply"};
  static const char *const text[] = {
      tetra_stl, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv \\\n1 1 0\nf 1 2 \\\n3 4\nf 1 2 3\ng\nf 1 2 3\n",
      "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
      PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"};
  for (int i = 0; i < 4; i++)
    check_each_allocation(context, status, 5) {
      bw_surface *surface = NULL;
      status = parse_text(context, name[i], text[i], &surface, NULL);
      bw_release(surface);
    }
}

check_main(check_test(ascii_stl_variants), check_test(ascii_stl_refusals),
           check_test(binary_stl_refusals), check_test(obj_variants), check_test(obj_refusals),
           check_test(off_variants), check_test(off_refusals), check_test(ply_variants),
           check_test(ply_byte_orders), check_test(ply_refusals), check_test(concave_polygons),
           check_test(unknown_content), check_test(round_trips), check_test(shared_models),
           check_test(files_that_are_none), check_test(out_of_memory))
