/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* PVTU: meshes in pieces, written and joined again; pieces of other programs; refusals. */
#include "mesh_check.h"

#include <sys/stat.h>

static char folder[300];

static const char *in_folder(char path[400], const char *name) {
  snprintf(path, 400, "%s/%s", folder, name);
  return path;
}

static int make_folder(void **state) {
  (void)state;
  temporary(folder, "pieces");
  return mkdir(folder, 0700);
}

static int remove_folder(void **state) {
  (void)state;
  char command[400];
  snprintf(command, sizeof command, "rm -r '%s'", folder);
  return system(command);
}

static void write_text(const char *name, const char *text) {
  char path[400];
  FILE *file = fopen(in_folder(path, name), "w");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

/* More elements than a piece has. */
static bw_mesh *large(bw_context *context, int order) {
  bw_mesh *box;
  check_ok(context, bw_mesh_box_grid(context, (double[3]){0, 0, 0}, (double[3]){1, 2, 3},
                                     (int[3]){20, 30, 45}, order, &box));
  int32_t *region = malloc(sizeof *region * (size_t)box->element_count);
  for (int i = 0; i < box->element_count; i++)
    region[i] = i % 7;
  box = check_tagged(context, box, region);
  free(region);
  return box;
}

/* Mesh, regions and fields come back bit by bit, in their order, from two pieces. */
static void round_trip(void **state) {
  bw_context *context = check_context(state);
  char path[400], piece[400];
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = large(context, order);
    bw_mesh_file file, second;
    bw_array *u, *stress;
    check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &u));
    check_ok(context, bw_array_create(context, BW_F64, mesh->element_count, 6, &stress));
    fill(u, 1);
    fill(stress, 2);
    bw_field field[2] = {{"u < 0", BW_ON_NODES, u}, {"stress", BW_ON_ELEMENTS, stress}};
    check_ok(context, bw_mesh_write(context, mesh, in_folder(path, "a&b.pvtu"), 2, field));
    check_ok(context, bw_mesh_read(context, path, &file));
    same_mesh(mesh, file.mesh);
    assert_int_equal(file.field_count, 2);
    for (int f = 0; f < 2; f++)
      same_field(&file, &field[f], true);
    check_ok(context, bw_mesh_read(context, in_folder(piece, "a&b_1.vtu"), &second));
    assert_int_equal(second.mesh->element_count, mesh->element_count / 2);
    /* a run of a curve that fills space: a block with few nodes of the other half */
    assert_in_range(second.mesh->node_count, mesh->node_count / 2, 0.56 * mesh->node_count);
    assert_int_not_equal(access(in_folder(piece, "a&b_2.vtu"), F_OK), 0);
    bw_mesh_file_clear(&second);
    bw_mesh_file_clear(&file);
    bw_surface *boundary, *surface;
    check_ok(context, bw_mesh_boundary(context, mesh, &boundary, NULL));
    check_ok(context, bw_surface_read(context, path, &surface, NULL));
    assert_int_equal(surface->triangle_count, boundary->triangle_count);
    assert_memory_equal(surface->point, boundary->point, 24 * (size_t)boundary->point_count);
    bw_release(surface);
    bw_release(boundary);
    static const char *const joins[] = {"GlobalNodeId", "GlobalElementId", "vtkGhostType"};
    for (int k = 0; k < 3; k++) {
      field[0].name = joins[k];
      check_fails(context, BW_INVALID, joins[k], bw_mesh_write(context, mesh, path, 2, field));
    }
    bw_release(u);
    bw_release(stress);
    bw_release(mesh);
  }
}

static void threads_do_not_matter(void **state) {
  bw_context *context = check_context(state);
  char path[400], digest[2][3][65];
  static const char *const name[] = {"t.pvtu", "t_0.vtu", "t_1.vtu"};
  bw_mesh *mesh = large(context, 1);
  for (int i = 0; i < 2; i++) {
    check_ok(context, bw_set_threads(context, i ? 3 : 1));
    check_ok(context, bw_mesh_write(context, mesh, in_folder(path, "t.pvtu"), 0, NULL));
    for (int k = 0; k < 3; k++)
      check_ok(context, bw_sha256_file(context, in_folder(path, name[k]), digest[i][k]));
  }
  for (int k = 0; k < 3; k++)
    assert_string_equal(digest[0][k], digest[1][k]);
  bw_release(mesh);
}

#define PIECE(points, cells, data)                                                                 \
  "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"5\" "              \
  "NumberOfCells=\"2\">" data                                                                      \
  "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">" points                           \
  "</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\">" cells             \
  "</DataArray><DataArray type=\"Int32\" Name=\"offsets\">4 8</DataArray><DataArray "              \
  "type=\"UInt8\" Name=\"types\">10 10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
#define CELL_DATA(ghost, extra)                                                                    \
  "<CellData><DataArray type=\"UInt8\" Name=\"vtkGhostType\">" ghost "</DataArray>" extra          \
  "</CellData>"
#define NODE_DATA(t)                                                                               \
  "<PointData><DataArray type=\"Float64\" Name=\"t\">" t "</DataArray></PointData>"

static const char whole[] = "<VTKFile type=\"PUnstructuredGrid\">\n<PUnstructuredGrid>\n"
                            "<Piece Source=\"e.vtu\"/>\n<Piece Source=\"p.vtu\"/>\n"
                            "<Piece Source=\"q.vtu\"/>\n"
                            "</PUnstructuredGrid></VTKFile>\n";

/* Two tetrahedra on either side of a face; each piece has the other's as a copy, and one piece has
 * none. Without numbers nodes are joined by their places. */
static void write_pieces(void) {
  write_text("e.vtu", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece "
                      "NumberOfPoints=\"0\" NumberOfCells=\"0\"><Points><DataArray "
                      "type=\"Float32\" NumberOfComponents=\"3\"/></Points></Piece>"
                      "</UnstructuredGrid></VTKFile>");
  write_text("p.vtu", PIECE("0 0 0 1 0 0 0 1 0 0 0 1 1 1 1", "0 1 2 3 1 2 3 4",
                            NODE_DATA("0 1 2 3 4")
                                CELL_DATA("0 1", "<DataArray type=\"Int32\" Name=\"c\">7 8"
                                                 "</DataArray>")));
  write_text("q.vtu", PIECE("1 1 1 1 -0 0 0 1 0 0 0 1 0 0 0", "1 2 3 0 4 1 2 3",
                            CELL_DATA("0 1", "<DataArray type=\"Int32\" Name=\"c\">8 7"
                                             "</DataArray>") NODE_DATA("4 1 2 3 0")));
  write_text("w.pvtu", whole);
}

static void pieces_of_others(void **state) {
  bw_context *context = check_context(state);
  char path[400];
  bw_mesh_file file;
  write_pieces();
  check_ok(context, bw_mesh_read(context, in_folder(path, "w.pvtu"), &file));
  assert_int_equal(file.mesh->node_count, 5);
  assert_int_equal(file.mesh->element_count, 2);
  assert_memory_equal(file.mesh->element, ((int32_t[]){0, 1, 2, 3, 1, 2, 3, 4}),
                      8 * sizeof(int32_t));
  assert_int_equal(file.field_count, 2);
  for (int f = 0; f < 2; f++)
    for (int i = 0; i < file.field_array[f]->rows; i++)
      assert_true(bw_array_get(file.field_array[f], i, 0) ==
                  (strcmp(file.field_name[f], "t") == 0 ? i : 7 + i));
  bw_mesh_file_clear(&file);
}

/* The last failure has this detail, and its text ends so. */
static void check_detail(bw_context *context, const char *name, const char *end) {
  const char *key, *text = NULL, *file = "";
  double number;
  for (int i = 0; bw_detail(context, i, &key, &number, &text); i++)
    if (strcmp(key, name) == 0)
      file = text;
  assert_true(strlen(file) > strlen(end));
  assert_string_equal(file + strlen(file) - strlen(end), end);
}

#define IDS(ids)                                                                                   \
  "<PointData><DataArray type=\"Int64\" Name=\"GlobalNodeId\">" ids "</DataArray></PointData>"

/* Nodes of one number at two places are not one node; rounding to single precision is none. */
static void numbers_of_other_places(void **state) {
  bw_context *context = check_context(state);
  char path[400];
  bw_mesh_file file;
  in_folder(path, "n.pvtu");
  write_text("n.pvtu", "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>"
                       "<Piece Source=\"p.vtu\"/><Piece Source=\"q.vtu\"/>"
                       "</PUnstructuredGrid></VTKFile>");
  write_text("p.vtu", PIECE("0 0 0 1 0 0 0 1 0 0 0 1 1 1 1", "0 1 2 3 1 2 3 4", IDS("0 1 2 3 4")));
  for (int wrong = 0; wrong < 2; wrong++) {
    write_text("q.vtu", wrong ? PIECE("2 2 2 1 2 2 2 1 2 2 2 1 1 1.01 1", "0 1 2 3 1 2 3 4",
                                      IDS("5 6 7 8 4"))
                              : PIECE("2 2 2 1 2 2 2 1 2 2 2 1 1 1.0000001 1", "0 1 2 3 1 2 3 4",
                                      IDS("5 6 7 8 4")));
    if (wrong) {
      check_fails(context, BW_FORMAT, "node number 4 lies at (1, 1, 1)",
                  bw_mesh_read(context, path, &file));
      check_detail(context, "file", "n.pvtu");
    } else {
      check_ok(context, bw_mesh_read(context, path, &file));
      assert_int_equal(file.mesh->node_count, 9);
      bw_mesh_file_clear(&file);
    }
  }
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  char path[400];
  bw_mesh_file file;
  in_folder(path, "r.pvtu");
  write_pieces();
  static const struct {
    bw_status status;
    const char *message, *text;
  } bad[] = {
      {BW_FORMAT, "PUnstructuredGrid is expected", "<VTKFile type=\"UnstructuredGrid\"/>"},
      {BW_FORMAT, "where VTKFile was expected", "<Piece Source=\"p.vtu\"/>"},
      {BW_FORMAT, "names no Piece", "<VTKFile type=\"PUnstructuredGrid\"></VTKFile>"},
      {BW_FORMAT, "without Source", "<VTKFile type=\"PUnstructuredGrid\"><Piece/></VTKFile>"},
      {BW_FORMAT, "ends before </PUnstructuredGrid>",
       "<VTKFile type=\"PUnstructuredGrid\"><Piece Source=\"p.vtu\"/>"},
      {BW_FORMAT, "no Piece holds tetrahedra",
       "<VTKFile type=\"PUnstructuredGrid\"><Piece Source=\"e.vtu\"/></PUnstructuredGrid>"},
      {BW_IO, "r.pvtu: a piece that it names cannot be read: ",
       "<VTKFile type=\"PUnstructuredGrid\"><Piece Source=\"none.vtu\"/>"},
      {BW_FORMAT, "only UnstructuredGrid",
       "<VTKFile type=\"PUnstructuredGrid\"><Piece Source=\"r.pvtu\"/>"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    write_text("r.pvtu", bad[i].text);
    check_fails(context, bad[i].status, bad[i].message, bw_mesh_read(context, path, &file));
    check_detail(context, "file", "r.pvtu");
    if (bad[i].status == BW_IO)
      check_detail(context, "piece", "none.vtu");
  }
  write_text("p.vtu", PIECE("0 0 0 1 0 0 0 1 0 0 0 1 1 1 1", "0 1 2 3 1 2 3 4",
                            CELL_DATA("0 0", "<DataArray type=\"Int32\" "
                                             "Name=\"GlobalElementId\">3 3</DataArray>")));
  write_text("r.pvtu", "<VTKFile type=\"PUnstructuredGrid\"><Piece Source=\"p.vtu\"/>"
                       "</PUnstructuredGrid>");
  check_fails(context, BW_FORMAT, "element number 3 occurs twice",
              bw_mesh_read(context, path, &file));
  check_detail(context, "file", "r.pvtu");
}

/* A file that names old pieces is not left beside new ones. */
static void failure_leaves_no_mixture(void **state) {
  bw_context *context = check_context(state);
  char path[400], piece[400];
  bw_mesh_file file;
  bw_mesh *mesh = large(context, 1);
  check_ok(context, bw_mesh_write(context, mesh, in_folder(path, "m.pvtu"), 0, NULL));
  in_folder(piece, "m_1.vtu");
  assert_int_equal(unlink(piece), 0);
  assert_int_equal(mkdir(piece, 0700), 0);
  check_fails(context, BW_IO, "m_1.vtu", bw_mesh_write(context, mesh, path, 0, NULL));
  assert_int_equal(rmdir(piece), 0);
  check_fails(context, BW_FORMAT, "names no Piece", bw_mesh_read(context, path, &file));
  bw_release(mesh);
}

static void out_of_memory(void **state) {
  bw_context *context = check_context(state);
  char path[400];
  sample s = make_sample(context, 1, true);
  write_pieces();
  for (int writing = 1; writing >= 0; writing--)
    check_each_allocation(context, status, 10) {
      bw_mesh_file file = {0};
      in_folder(path, writing ? "memory.pvtu" : "w.pvtu");
      status = writing ? bw_mesh_write(context, s.mesh, path, FIELDS, s.field)
                       : bw_mesh_read(context, path, &file);
      bw_mesh_file_clear(&file);
      if (writing && status != BW_OK)
        assert_int_not_equal(access(path, F_OK), 0);
    }
  free_sample(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(round_trip),       check_test(threads_do_not_matter),
      check_test(pieces_of_others), check_test(numbers_of_other_places),
      check_test(refusals),         check_test(failure_leaves_no_mixture),
      check_test(out_of_memory)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
