/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The contact of the drop test: areas by closed forms, the same on any mesh, and forces that are
 * those of the impulse. */
#include "analysis/drop_contact.h"
#include "bodies.h"

typedef struct pressed {
  bwi_contact_patch patch;
  double *share;
  int nodes; /* that carry a part */
} pressed;

static pressed press(bw_context *context, const bw_mesh *mesh, const bwi_peg *peg, double force,
                     double modulus) {
  pressed it = {.share = BW_NEW0(context, double, mesh->node_count)};
  bwi_contact_part *part = BW_NEW(context, bwi_contact_part, bwi_contact_capacity(mesh));
  bwi_contact_press(mesh, peg, force, modulus, part, it.share, &it.patch);
  double sum = 0, centre[3] = {0, 0, 0};
  for (int64_t i = 0; i < mesh->node_count; i++) {
    sum += it.share[i];
    it.nodes += it.share[i] != 0;
    for (int k = 0; k < 3; k++)
      centre[k] += it.share[i] * mesh->node[3 * i + k];
  }
  /* nothing sideways, and the moment is that of the force at the centre of pressure */
  check_near(sum, 1, 1e-12);
  for (int k = 0; k < 3; k++)
    check_near(centre[k], it.patch.centre[k], 1e-12);
  bw_free(part);
  return it;
}

/* A cylinder across a flat face of width L: half of the breadth is sqrt(2 R d - d^2), and the
 * integral of the stiffness gives the force. The area is that of the closed form to 2 % where one
 * facet is a hundred times the contact as where it is a tenth of it. */
static void flat_face(void **state) {
  bw_context *context = check_context(state);
  const double radius = 0.05, modulus = 1e9, length = 1;
  double area[3];
  for (int kind = 0; kind < 3; kind++) {
    int cells = kind == 0 ? 1 : kind == 1 ? 3 : 40;
    bw_mesh *mesh =
        make_box(context, 1, length, 1, cells, kind == 2 ? 4 : cells, 2, kind == 1 ? 2 : 1);
    bwi_peg peg = {
        .at = {0.47, 0.5, 1}, .direction = {0, 0, -1}, .along = {0, 1, 0}, .radius = radius};
    double depth = 2e-4, force = 4 * modulus * sqrt(2 * length * sqrt(2 * radius) / M_PI) *
                                 pow(depth, 1.25) / 1.25;
    pressed it = press(context, mesh, &peg, force, modulus);
    area[kind] = 2 * sqrt(2 * radius * depth) * length;
    check_near(it.patch.indentation, depth, 0.02 * depth);
    check_near(it.patch.area, area[kind], 0.03 * area[kind]);
    check_near(it.patch.centre[0], 0.47, 2e-3);
    check_near(it.patch.centre[1], 0.5, 0.02);
    check_near(it.patch.centre[2], 1, 1e-12);
    assert_true(it.nodes >= 3);
    bw_free(it.share);
    bw_release(mesh);
  }
}

static void a_ball(void *data, const double unit[3], double out[3]) {
  double largest = 0, length = 0;
  (void)data;
  for (int k = 0; k < 3; k++) {
    out[k] = 2 * unit[k] - 1;
    largest = fmax(largest, fabs(out[k]));
    length += out[k] * out[k];
  }
  for (int k = 0; k < 3 && length > 0; k++)
    out[k] *= largest / sqrt(length);
}

/* A ball of radius 1 on a cylinder: the contact is an ellipse of area 2 pi d sqrt(R1 R2), and the
 * force that of Hertz, 4/3 E* (R1 R2)^(1/4) approach^(3/2). Facets make it wrong, less with each
 * refinement. */
static void ball_converges(void **state) {
  bw_context *context = check_context(state);
  const double radius = 0.5, modulus = 1e9, depth = 8e-3;
  double mean = sqrt(1 / (1 + 1 / radius)), error[3]; /* sqrt(R1 R2) */
  double force = 4.0 / 3 * modulus * sqrt(mean) * pow(2 * depth, 1.5);
  double exact = 2 * M_PI * depth * mean;
  for (int k = 0; k < 3; k++) {
    bw_mesh *mesh = NULL;
    const int cells[3] = {6 << k, 6 << k, 6 << k};
    check_ok(context, bw_mesh_mapped_box(context, cells, 1, a_ball, NULL, &mesh));
    bwi_peg peg = {.at = {0, 0, 1}, .direction = {0, 0, -1}, .along = {0, 1, 0}, .radius = radius};
    pressed it = press(context, mesh, &peg, force, modulus);
    error[k] = fabs(it.patch.area / exact - 1);
    assert_true(fabs(it.patch.centre[0]) < 0.1 && fabs(it.patch.centre[1]) < 0.1);
    bw_free(it.share);
    bw_release(mesh);
  }
  assert_true(error[1] < error[0] && error[2] < error[1]);
  assert_true(error[2] < 0.06);
}

/* An edge that the cylinder crosses: the area grows with the force, the contact stays where the
 * edge is, and no facet that faces away carries anything. */
static void edge(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = make_box(context, 1, 1, 1, 4, 4, 4, 1);
  double r = sqrt(0.5), area = 0;
  bwi_peg peg = {.at = {0, 0.4, 1}, .direction = {r, 0, -r}, .along = {r, 0, r}, .radius = 0.1};
  for (double force = 1e3; force < 2e5; force *= 10) {
    pressed it = press(context, mesh, &peg, force, 1e9);
    assert_true(it.patch.area > area);
    area = it.patch.area;
    check_near(it.patch.centre[1], 0.4, 5e-3);
    check_near(it.patch.centre[0], 1 - it.patch.centre[2], 5e-3);
    for (int32_t i = 0; i < mesh->node_count; i++)
      if (it.share[i] > 0)
        assert_true(mesh->node[3 * (int64_t)i] < 1e-9 || mesh->node[3 * (int64_t)i + 2] > 1 - 1e-9);
    assert_true(it.nodes >= 3);
    bw_free(it.share);
  }
  bw_release(mesh);
}

check_main(check_test(flat_face), check_test(ball_converges), check_test(edge))
