/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* MSH, MEDIT, TetGen and INP: round trips, hand-written variants, refusals, memory. */
#include "mesh_check.h"

static bw_status parse(bw_context *context, const char *name, const char *text,
                       bw_mesh_file *file) {
  return bw_mesh_parse(context, name, (const unsigned char *)text, strlen(text), file);
}

static void write_as(bw_context *context, const sample *s, const char *name, const char *path) {
  if (strcmp(name, "22.msh") == 0)
    check_ok(context, bw_msh22_write(context, s->mesh, path, FIELDS, s->field));
  else
    check_ok(context, bw_mesh_write(context, s->mesh, path, FIELDS, s->field));
}

static void round_trips(void **state) {
  bw_context *context = check_context(state);
  static const char *const name[] = {"a.msh", "22.msh", "a.mesh", "a.node", "a.ele", "a.inp"};
  for (int order = 1; order <= 2; order++)
    for (int regions = 0; regions < 2; regions++)
      for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
        char path[300], other[300];
        bw_mesh_file file;
        sample s = make_sample(context, order, regions == 1);
        bool inp = strcmp(name[i], "a.inp") == 0;
        if (inp) { /* 20 characters to a number: sixteen digits of 1e4 fit, seventeen of 1e-17 not
                    */
          bw_mesh *plain;
          check_ok(context, bw_mesh_box_grid(context, (double[3]){0, 0, 0}, (double[3]){1, 2, 0.5},
                                             (int[3]){2, 2, 2}, order, &plain));
          if (s.mesh->region)
            plain = check_tagged(context, plain, s.mesh->region);
          bw_release(s.mesh);
          s.mesh = plain;
          check_ok(context, bw_mesh_write(context, s.mesh, temporary(path, name[i]), 0, NULL));
        } else {
          write_as(context, &s, name[i], temporary(path, name[i]));
        }
        check_ok(context, bw_mesh_read(context, path, &file));
        if (inp) {
          assert_int_equal(file.mesh->region_count, regions ? 3 : 0);
          if (regions)
            assert_memory_equal(s.mesh->region, file.mesh->region,
                                4 * (size_t)s.mesh->element_count);
          assert_int_equal(file.set_count, regions ? 5 : 2); /* NALL, EALL, REGION_1 to 3 */
          assert_int_equal(file.set[0].count, s.mesh->node_count);
          assert_int_equal(file.set[1].count, s.mesh->element_count);
          assert_memory_equal(s.mesh->node, file.mesh->node, 24 * (size_t)s.mesh->node_count);
          assert_memory_equal(s.mesh->element, file.mesh->element,
                              4 * (size_t)(s.mesh->element_count * s.mesh->nodes_per_element));
        } else {
          same_mesh(s.mesh, file.mesh);
        }
        if (strstr(name[i], ".msh")) {
          same_field(&file, &s.field[0], true);
          same_field(&file, &s.field[2], false);
          same_field(&file, &s.field[3], false);
          assert_int_equal(file.set_count, regions ? 3 : 0);
        }
        bw_mesh_file_clear(&file);
        free_sample(&s);
        unlink(path);
        unlink(temporary(other, "a.node"));
        unlink(temporary(other, "a.ele"));
      }
}

/* Names of regions are names of element sets where they are words that no other set has. */
static void inp_names(void **state) {
  bw_context *context = check_context(state);
  sample s = make_sample(context, 1, true);
  bw_mesh_regions regions = bw_mesh_regions_of(s.mesh);
  bw_mesh_region region[2][3] = {{{1, 0, {"Insert-2"}}, {2, 0, {"steel insert"}}, {3, 0, {"eall"}}},
                                 {{1, 0, {"a"}}, {2, 0, {"A"}}, {3, 0, {"3a"}}}};
  static const char *const expected[2][3] = {{"Insert-2", "REGION_2", "REGION_3"},
                                             {"REGION_1", "REGION_2", "REGION_3"}};
  char path[300];
  temporary(path, "names.inp");
  for (int i = 0; i < 2; i++) {
    bw_mesh *named;
    bw_mesh_file file;
    regions.region = region[i];
    check_ok(context, bw_mesh_with_regions(context, s.mesh, &regions, &named));
    check_ok(context, bw_mesh_write(context, named, path, 0, NULL));
    check_ok(context, bw_mesh_read(context, path, &file));
    assert_int_equal(file.set_count, 5);
    for (int k = 0; k < 3; k++) {
      int32_t found = 0;
      assert_string_equal(file.set[2 + k].name, expected[i][k]);
      assert_string_equal(file.mesh->regions[k].name.text, expected[i][k]);
      for (int32_t e = 0; e < named->element_count; e++)
        if (named->region[e] == k)
          assert_int_equal(file.set[2 + k].member[found++], e);
      assert_int_equal(file.set[2 + k].count, found);
    }
    bw_mesh_file_clear(&file);
    bw_release(named);
  }
  unlink(path);
  free_sample(&s);
}

#define TWO_TETS                                                                                   \
  "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,1\n*ELEMENT,TYPE=C3D4,ELSET=Volume1\n"         \
  "1,1,2,3,4\n*ELEMENT,TYPE=C3D4,ELSET=Volume2\n2,2,3,4,5\n"

/* Sets that divide the mesh are regions, the later ones before those of the geometry. */
static void inp_division(void **state) {
  bw_context *context = check_context(state);
  static const struct {
    const char *more, *first, *second; /* the regions of the elements */
  } decks[] = {
      {"", "Volume1", "Volume2"},
      {"*ELSET,ELSET=pla\n1,1\n*ELSET,ELSET=steel\n2\n", "pla", "steel"},
      {"*ELSET,ELSET=steel\n2\n*ELSET,ELSET=pla\n1\n*ELSET,ELSET=all\n1,2\n", "pla", "steel"},
      {"*SOLID SECTION,ELSET=Volume2,MATERIAL=A\n", "Volume1", "Volume2"},
      {"*ELSET,ELSET=watched\n2\n", "Volume1", "watched"},
  };
  for (size_t i = 0; i < sizeof decks / sizeof *decks; i++) {
    char text[600];
    bw_mesh_file file;
    snprintf(text, sizeof text, "%s%s", TWO_TETS, decks[i].more);
    check_ok(context, parse(context, "division.inp", text, &file));
    assert_int_equal(file.mesh->region_count, 2);
    assert_string_equal(file.mesh->regions[file.mesh->region[0]].name.text, decks[i].first);
    assert_string_equal(file.mesh->regions[file.mesh->region[1]].name.text, decks[i].second);
    bw_mesh_file_clear(&file);
  }
  bw_mesh_file file; /* the sets leave an element out */
  check_ok(context, parse(context, "part.inp",
                          "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,1\n*ELEMENT,TYPE=C3D4\n"
                          "1,1,2,3,4\n2,2,3,4,5\n*ELSET,ELSET=one\n1\n",
                          &file));
  assert_int_equal(file.mesh->region_count, 0);
  bw_mesh_file_clear(&file);
}

/* MEDIT files have the names of regions as comments. */
static void medit_names(void **state) {
  bw_context *context = check_context(state);
  sample s = make_sample(context, 1, true);
  bw_mesh_regions regions = bw_mesh_regions_of(s.mesh);
  bw_mesh_region region[3] = {{1, 0, {"steel insert"}}, {2, 0, {"two\nlines"}}, {3, 0, {"\u00e4"}}};
  bw_mesh *named;
  bw_mesh_file file;
  char path[300];
  regions.region = region;
  check_ok(context, bw_mesh_with_regions(context, s.mesh, &regions, &named));
  check_ok(context, bw_mesh_write(context, named, temporary(path, "names.mesh"), 0, NULL));
  check_ok(context, bw_mesh_read(context, path, &file));
  assert_string_equal(file.mesh->regions[0].name.text, "steel insert");
  assert_string_equal(file.mesh->regions[1].name.text, "region 2");
  assert_string_equal(file.mesh->regions[2].name.text, "\u00e4");
  assert_memory_equal(file.mesh->region, named->region, 4 * (size_t)named->element_count);
  unlink(path);
  bw_mesh_file_clear(&file);
  bw_release(named);
  free_sample(&s);
}

/* Names of regions are physical names of volumes; the second of two that have one name gets its tag
 * too, and groups of surfaces alone make no regions. */
static void msh_names(void **state) {
  bw_context *context = check_context(state);
  sample s = make_sample(context, 2, true);
  bw_mesh_regions regions = bw_mesh_regions_of(s.mesh);
  bw_mesh_region region[3] = {{1, 0, {"a \"b\""}}, {2, 0, {"steel insert"}}, {3, 0, {"\u00e4"}}};
  bw_mesh *named;
  bw_mesh_file file;
  char path[300];
  assert_int_equal(regions.count, 3);
  regions.region = region;
  check_ok(context, bw_mesh_with_regions(context, s.mesh, &regions, &named));
  for (int i = 0; i < 2; i++) {
    temporary(path, "names.msh");
    check_ok(context, i ? bw_msh22_write(context, named, path, 0, NULL)
                        : bw_mesh_write(context, named, path, 0, NULL));
    check_ok(context, bw_mesh_read(context, path, &file));
    assert_string_equal(file.mesh->regions[0].name.text, "a 'b'");
    assert_string_equal(file.mesh->regions[1].name.text, "steel insert");
    assert_string_equal(file.mesh->regions[2].name.text, "\u00e4");
    assert_memory_equal(file.mesh->region, named->region, 4 * (size_t)named->element_count);
    bw_mesh_file_clear(&file);
  }
  unlink(path);
  static const char start[] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n%s"
                              "$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
                              "5 1 1 1\n$EndNodes\n$Elements\n2\n%s$EndElements\n";
  char text[600];
  snprintf(text, sizeof text, start, "3 4 \"one\"\n3 5 \"one\"\n",
           "1 4 2 4 1 1 2 3 4\n2 4 2 5 1 2 3 4 5\n");
  check_ok(context,
           bw_mesh_parse(context, "two.msh", (const unsigned char *)text, strlen(text), &file));
  assert_string_equal(file.mesh->regions[0].name.text, "one");
  assert_string_equal(file.mesh->regions[1].name.text, "one (5)");
  bw_mesh_file_clear(&file);
  snprintf(text, sizeof text, start, "2 4 \"side\"\n2 5 \"top\"\n",
           "1 2 2 4 1 1 2 3\n2 4 2 0 1 1 2 3 4\n");
  check_ok(context,
           bw_mesh_parse(context, "sides.msh", (const unsigned char *)text, strlen(text), &file));
  assert_int_equal(file.mesh->region_count, 0);
  assert_int_equal(file.set_count, 1);
  bw_mesh_file_clear(&file);
  bw_release(named);
  free_sample(&s);
}

/* Tags that Gmsh cannot have as groups come back through the field "region". */
static void msh_negative_regions(void **state) {
  bw_context *context = check_context(state);
  sample s = make_sample(context, 1, true);
  bw_mesh *mesh;
  bw_mesh_file file;
  char path[300];
  int32_t *region = malloc(sizeof *region * (size_t)s.mesh->element_count);
  for (int i = 0; i < s.mesh->element_count; i++)
    region[i] = i % 3 - 1;
  mesh = check_tagged(context, bw_retain(s.mesh), region);
  for (int i = 0; i < 2; i++) {
    temporary(path, "n.msh");
    check_ok(context, i ? bw_msh22_write(context, mesh, path, 0, NULL)
                        : bw_mesh_write(context, mesh, path, 0, NULL));
    check_ok(context, bw_mesh_read(context, path, &file));
    same_mesh(mesh, file.mesh);
    assert_int_equal(file.field_count, 0);
    bw_mesh_file_clear(&file);
  }
  unlink(path);
  free(region);
  bw_release(mesh);
  free_sample(&s);
}

static const char msh22[] =
    "$MeshFormat\r\n2.2 0 8\r\n$EndMeshFormat\r\n$Comments\nhello $Nodes\n$EndComments\n"
    "$PhysicalNames\n3\n2 7 \"clamped face\"\n3 5 \"body\"\n3 9 \"unused\"\n$EndPhysicalNames\n"
    "$Nodes\n6\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1\n60 7 7 7\n$EndNodes\n"
    "$Elements\n5\n1 15 2 0 1 10\n2 2 2 7 1 10 20 30\n3 4 2 5 1 10 20 30 40\n"
    "4 4 3 5 1 0 20 30 40 50\n5 1 0 10 20\n$EndElements\n"
    "$NodeData\n1\n\"T\"\n1\n0.5\n3\n0\n1\n6\n10 1\n20 2\n30 3\n40 4\n50 5\n60 6\n$EndNodeData\n"
    "$ElementData\n1\n\"E\"\n0\n3\n0\n3\n2\n4 1 2 3\n3 4 5 6\n$EndElementData\n";

static void msh22_text(void **state) {
  bw_context *context = check_context(state);
  bw_mesh_file file;
  check_ok(context, parse(context, "a.msh", msh22, &file));
  assert_string_equal(file.info.format, "MSH 2.2");
  assert_int_equal(file.mesh->node_count, 5);
  assert_int_equal(file.mesh->element_count, 2);
  assert_int_equal(file.mesh->regions[file.mesh->region[1]].tag, 5);
  assert_int_equal(file.info.skipped, 3);
  assert_int_equal(file.set_count, 2);
  assert_string_equal(file.set[0].name, "clamped face");
  assert_int_equal(file.set[0].count, 3);
  assert_false(file.set[0].of_elements);
  assert_string_equal(file.set[1].name, "body");
  assert_int_equal(file.set[1].member[1], 1);
  assert_true(bw_array_get(file.field_array[0], 4, 0) == 5);
  assert_true(bw_array_get(file.field_array[1], 0, 2) == 6);
  bw_mesh_file_clear(&file);
}

static void refuse(void **state, const char *name, const char *text, const char *message) {
  bw_context *context = check_context(state);
  bw_mesh_file file;
  check_fails(context, BW_FORMAT, message, parse(context, name, text, &file));
  assert_null(file.mesh);
}

#define MSH "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define MSH4 "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"

static void msh_refusals(void **state) {
  refuse(state, "a.msh", "$MeshFormat\n3.0 0 8\n", "a.msh:2: found '3.0'");
  refuse(state, "a.msh", "$MeshFormat\n4.1 1 4\n", "numbers of 4 bytes");
  refuse(state, "a.msh", "$Nodes\n1\n", "no format that is read here");
  refuse(state, "a.msh", MSH "$Nodes\n4000000000\n1 0 0 0\n", "a.msh:5: the number of nodes is 4");
  refuse(state, "a.msh", MSH "$Nodes\n1\n1 0 0 nan\n", "a.msh:6: a coordinate of a node is 'nan'");
  refuse(state, "a.msh", MSH "$Nodes\n2\n1 0 0 0\n1 0 0 1\n$EndNodes\n", "node 1 is defined twice");
  refuse(state, "a.msh", MSH "$Nodes\n1\n1 0 0 0\n$EndNode\n", "found '$EndNode'");
  refuse(state, "a.msh", MSH "$Foo\n1\n", "'$Foo' has no '$EndFoo'");
  refuse(state, "a.msh", MSH "$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n", "names node 1");
  refuse(state, "a.msh", MSH "$Elements\n9999\n1 4 0 1 2 3 4\n$EndElements\n", "is 9999, but only");
  refuse(state, "a.msh", MSH "$Elements\n1\n1 444 0 1 2 3 4\n$EndElements\n", "unknown type 444");
  refuse(state, "a.msh", MSH4 "$Nodes\n1 99999999 1 1\n3 1 0 2\n",
         "the number of nodes is 99999999");
  refuse(state, "a.msh", MSH4 "$Nodes\n1 1 1 1\n3 1 0 2\n1\n2\n", "a block of 2 nodes");
  refuse(state, "a.msh", MSH4 "$Elements\n1 1 1 1\n3 1 4 99999\n1 1 2 3 4\n", "is 99999, but only");
  refuse(state, "a.msh", MSH4 "$Entities\n99999999 0 0 0\n1\n", "99999999");
  refuse(state, "a.msh", MSH, "holds no tetrahedra");
}

/* A part of the body left out in silence would be another body. */
static void leave_out(void **state, const char *name, const char *text) {
  bw_context *context = check_context(state);
  bw_mesh_file file;
  check_fails(context, BW_UNSUPPORTED, "1 hexahedra, prisms or pyramids beside 1 tetrahedra",
              parse(context, name, text, &file));
}

static void mixed_meshes(void **state) {
  leave_out(state, "a.msh",
            MSH "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 0 1\n6 0 1 1\n$EndNodes\n"
                "$Elements\n2\n1 4 0 1 2 3 4\n2 6 0 1 2 3 4 5 6\n$EndElements\n");
  leave_out(state, "a.mesh",
            "MeshVersionFormatted 1\nDimension 3\nVertices 5\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n"
            "0 0 1 0\nTetrahedra 1\n1 2 3 5 0\nPyramids 1\n1 2 3 4 5 0\nEnd\n");
  leave_out(state, "a.inp",
            "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,0,1\n6,0,1,1\n*ELEMENT,TYPE=C3D4\n"
            "1,1,2,3,4\n*ELEMENT,TYPE=c3d6\n2,1,2,3,4,5,6\n");
}

static void medit_text(void **state) {
  bw_context *context = check_context(state);
  static const char text[] =
      "# comment\nmeshversionformatted 1\n\nDimension\n3\nVertices 5\n0 0 0 1\n1 0 0 2\n0 1 0 3\n"
      "0 0 1 4\n1 1 1 0\nCorners 2\n1 2\nTriangles\n1\n1 2 3 4\nTetrahedra\n2\n1 2 3 4 -7\n"
      "2 3 4 5 9\nRequiredVertices\n1\n3\nEnd";
  bw_mesh_file file;
  check_ok(context, parse(context, "a.mesh", text, &file));
  assert_int_equal(file.mesh->element_count, 2);
  assert_int_equal(file.mesh->regions[file.mesh->region[0]].tag, -7);
  assert_int_equal(file.info.skipped, 1);
  bw_mesh_file_clear(&file);
  refuse(state, "a.mesh", "MeshVersionFormatted 2\nDimension 2\n", "a.mesh:2: a mesh in 2");
  refuse(state, "a.mesh", "MeshVersionFormatted 2\nVertices 2000000000\n0 0 0 0\n",
         "the number of vertices is 2000000000");
  refuse(state, "a.mesh", "MeshVersionFormatted 2\nTetrahedra 1\n1 2 3 4 0\n",
         "names vertex 1, but there are 0");
  refuse(state, "a.mesh", "MeshVersionFormatted 2\n!\n", "found '!'");
}

/* The two files written out, read by either name. */
static void tetgen_text(void **state) {
  bw_context *context = check_context(state);
  char node[300], ele[300];
  bw_mesh_file file;
  FILE *out = fopen(temporary(node, "t.node"), "w");
  fputs("# x\n4 3 2 1\n0 0 0 0 1.5 -2 7\n1 1 0 0 1 1 8\n\n2 0 1 0 1 1 9\n3 0 0 1 1 nan 10 # y\n",
        out);
  fclose(out);
  out = fopen(temporary(ele, "t.ele"), "w");
  fputs("1 4 2\n0 0 1 2 3 17 0.25\n", out);
  fclose(out);
  for (int i = 0; i < 2; i++) {
    check_ok(context, bw_mesh_read(context, i ? ele : node, &file));
    assert_int_equal(file.mesh->regions[file.mesh->region[0]].tag, 17);
    assert_int_equal(file.field_count, 5);
    assert_string_equal(file.field_name[0], "attribute_1");
    assert_true(bw_array_get(file.field_array[1], 0, 0) == -2);
    assert_string_equal(file.field_name[2], "marker");
    assert_true(bw_array_get(file.field_array[2], 3, 0) == 10);
    assert_true(bw_array_get(file.field_array[4], 0, 0) == 0.25);
    bw_mesh_file_clear(&file);
  }
  out = fopen(ele, "w");
  fputs("1 4 0\n0 0 1 2 4\n", out);
  fclose(out);
  check_fails(context, BW_FORMAT, "t.ele:2: element 0 names point 4",
              bw_mesh_read(context, node, &file));
  out = fopen(ele, "w");
  fputs("100000000 4 0\n0 0 1 2 3\n", out);
  fclose(out);
  check_fails(context, BW_FORMAT, "t.ele:2: the number of elements is 100000000",
              bw_mesh_read(context, node, &file));
  unlink(ele);
  check_fails(context, BW_IO, "t.ele: cannot be read", bw_mesh_read(context, node, &file));
  unlink(node);
}

/* TetGen's order of mid-edge nodes, as its manual and its library have it: 23 03 01 12 13 02. */
static void tetgen_ten_nodes(void **state) {
  bw_context *context = check_context(state);
  char node[300], ele[300];
  FILE *out = fopen(temporary(node, "q.node"), "w");
  fputs("10 3 0 0\n1 0 0 0\n2 2 0 0\n3 0 2 0\n4 0 0 2\n5 0 1 1\n6 0 0 1\n7 1 0 0\n8 1 1 0\n"
        "9 1 0 1\n10 0 1 0\n",
        out);
  fclose(out);
  out = fopen(temporary(ele, "q.ele"), "w");
  fputs("1 10 0\n1 1 2 3 4 5 6 7 8 9 10\n", out);
  fclose(out);
  bw_mesh_file file;
  check_ok(context, bw_mesh_read(context, ele, &file));
  const bw_mesh *mesh = file.mesh;
  for (int e = 0; e < 6; e++)
    for (int k = 0; k < 3; k++)
      check_near(mesh->node[3 * mesh->element[4 + e] + k],
                 (mesh->node[3 * mesh->element[bw_tet_edge[e][0]] + k] +
                  mesh->node[3 * mesh->element[bw_tet_edge[e][1]] + k]) /
                     2,
                 1e-15);
  bw_mesh_file_clear(&file);
  unlink(node);
  unlink(ele);
}

static void inp_text(void **state) {
  bw_context *context = check_context(state);
  static const char text[] =
      "** comment\n*Heading\n a title\n*NODE, nset=All\n 1 , 0.,0,0\n2,1.,0.0D0,\n3,0,1,0,\n"
      "** more\n40,0,0,1\n50,1,1,1\n*Element, Type=c3d10,\n elset=none\n*ELEMENT,TYPE=C3D4, "
      "ELSET=Eall\n1,1,2,\n3,40\n12, 2,3,40,50\n*ELEMENT,TYPE=B31\n7,1,2\n*NSET,NSET=ends\n1,50,\n"
      "*NSET, NSET=range, GENERATE\n2,42,2\n*Nset, nset=both\nends, RANGE\n*ELSET,ELSET=E,GENERATE"
      "\n12,12\n*MATERIAL,NAME=x\n*ELASTIC\n1,2\n*STEP\n";
  bw_mesh_file file;
  check_ok(context, parse(context, "a.inp", text, &file));
  assert_int_equal(file.mesh->node_count, 5);
  assert_int_equal(file.mesh->element_count, 2);
  assert_int_equal(file.info.skipped, 1);
  static const struct {
    const char *name;
    int count, last;
  } set[] = {{"All", 5, 4},   {"Eall", 2, 1}, {"ends", 2, 4},
             {"range", 2, 3}, {"both", 4, 4}, {"E", 1, 1}};
  for (size_t i = 0; i < sizeof set / sizeof *set; i++) {
    bool found = false;
    for (int k = 0; k < file.set_count; k++)
      if (strcmp(file.set[k].name, set[i].name) == 0) {
        found = true;
        assert_int_equal(file.set[k].count, set[i].count);
        assert_int_equal(file.set[k].member[set[i].count - 1], set[i].last);
      }
    assert_true(found);
  }
  bw_mesh_file_clear(&file);
}

static void inp_refusals(void **state) {
  refuse(state, "a.inp", "*NODE\n1,0,0,0\n*INCLUDE, INPUT=b.inp\n",
         "a.inp:3: *INCLUDE: included files are not read");
  refuse(state, "a.inp", "*NODE\n1,0,x,0\n", "a.inp:2: found 'x'");
  refuse(state, "a.inp", "*NODE\n1,0,inf,0\n", "a.inp:2: found 'inf'");
  refuse(state, "a.inp", "*NODE\nx,0,0,0\n", "a.inp:2: found 'x' where the number of a node");
  refuse(state, "a.inp", "*NODE\n1,0,0,0\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n",
         "a.inp:4: element 1 names node 2");
  refuse(state, "a.inp", "*NODE\n1,0,0,0\n1,0,0,0\n*NSET,NSET=a\n1\n", "node 1 is defined twice");
  refuse(state, "a.inp", "*NODE\n1,0,0,0\n*ELEMENT,TYPE=C3D4\n1,1,1\n", "an element of 3 numbers");
  refuse(state, "a.inp", "*NODE\n1,0,0,0\n*NSET,NSET=a,GENERATE\n5,1\n", "GENERATE from 5 to 1");
  refuse(state, "a.inp", "*NODE\n1,0,0,0\n*NSET,NSET=a\nb\n", "found 'b'");
  refuse(state, "a.inp", "*NODE\n1,0,0,0\n", "holds no tetrahedra");
}

/* A failure inside the mesh names the file as well. */
static void flat_element(void **state) {
  bw_context *context = check_context(state);
  bw_mesh_file file;
  check_fails(context, BW_GEOMETRY, "a.mesh: ",
              parse(context, "a.mesh",
                    "MeshVersionFormatted 2\nVertices 4\n0 0 0 0\n1 0 0 0\n"
                    "0 1 0 0\n1 1 0 0\nTetrahedra 1\n1 2 3 4 0\n",
                    &file));
  check_fails(context, BW_FORMAT, "read it as a surface",
              parse(context, "a.stl", "solid\nendsolid\n", &file));
}

static void out_of_memory(void **state) {
  bw_context *context = check_context(state);
  sample s = make_sample(context, 1, true);
  static const char *const name[] = {"m.msh", "m.mesh", "m.node", "m.inp"};
  char path[300];
  for (size_t i = 0; i < 4; i++) {
    for (int writing = 1; writing >= 0; writing--)
      check_each_allocation(context, status, 1) {
        bw_mesh_file file = {0};
        temporary(path, name[i]);
        status = writing ? bw_mesh_write(context, s.mesh, path, FIELDS, s.field)
                         : bw_mesh_read(context, path, &file);
        bw_mesh_file_clear(&file);
      }
    unlink(path);
  }
  unlink(temporary(path, "m.ele"));
  free_sample(&s);
}

check_main(check_test(round_trips), check_test(inp_names), check_test(inp_division),
           check_test(medit_names), check_test(msh_names), check_test(msh_negative_regions),
           check_test(msh22_text), check_test(msh_refusals), check_test(mixed_meshes),
           check_test(medit_text), check_test(tetgen_text), check_test(tetgen_ten_nodes),
           check_test(inp_text), check_test(inp_refusals), check_test(flat_element),
           check_test(out_of_memory))
