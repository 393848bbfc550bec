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
  refuse(state, "a.stl", "hello", "the header of a binary STL file takes 84 bytes");
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
  check_fails(context, BW_FORMAT, "byte 146: corner 0 of facet 1",
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
  refuse(state, "a.obj", "v 0 0\nf 1 1 1\n", "a.obj:1: the file ends where the z coordinate");
  refuse(state, "a.obj", "v 0 0 -inf\n", "'-inf'");
  refuse(state, "a.obj", "v 99999999999999999999 0 0\nf 99999999999999999999 1 1\n", "a.obj:2:");
  refuse(state, "a.obj", "# nothing\n", "holds no facet");
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
  for (size_t i = 0; i < 3; i++) {
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
    if (!float32)
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
    if (strstr(model[i].name, ".off") || strstr(model[i].name, ".ply") ||
        !shared_file(path, "models", model[i].name))
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
  static const char *const name[] = {"a.stl", "a.obj"};
  static const char *const text[] = {
      tetra_stl, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv \\\n1 1 0\nf 1 2 \\\n3 4\nf 1 2 3\ng\nf 1 2 3\n"};
  for (int i = 0; i < 2; i++)
    for (int64_t n = 1;; n++) {
      bw_surface *surface = NULL;
      bw_fail_allocation(n, true);
      bw_status status = parse_text(context, name[i], text[i], &surface, NULL);
      bw_fail_allocation(0, false);
      if (status == BW_OK) {
        bw_release(surface);
        assert_true(n > 5);
        break;
      }
      assert_int_equal(status, BW_MEMORY);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(ascii_stl_variants),  check_test(ascii_stl_refusals),
      check_test(binary_stl_refusals), check_test(obj_variants),
      check_test(obj_refusals),        check_test(concave_polygons),
      check_test(unknown_content),     check_test(round_trips),
      check_test(shared_models),       check_test(files_that_are_none),
      check_test(out_of_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
