/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Finite sliding of parts on each other: what they do at the place that they reach is what parts do
 * that were made there. */
#include "parts.h"

static bw_mesh *box_at(bw_context *context, double x, double z, const double size[3],
                       const int cells[3], int order) {
  bw_mesh *mesh = NULL;
  const double low[3] = {x, 0, z}, high[3] = {x + size[0], size[1], z + size[2]};
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &mesh));
  return mesh;
}

static void move(bw_context *context, bw_model *model, int k, double at, const bool fixed[3],
                 const double value[3]) {
  bw_selection *face = body_face(context, model->mesh, k, at);
  check_ok(context, bw_model_prescribe(context, model, face, fixed, value));
  bw_release(face);
}

static bw_contact *slid(bw_context *context, const bw_model *model, const bw_contact_pair *pair,
                        bool finite, int steps, const bw_contact *after) {
  bw_contact *contact = NULL;
  bw_contact_options options;
  bw_contact_options_default(&options);
  options.finite_sliding = finite;
  options.steps = steps;
  options.after = after;
  check_ok(context, bw_contact_solve(context, model, 1, pair, NULL, &options, &contact));
  return contact;
}

/* A block beside another of its size slides onto it, through elements that do not match: one
 * pressure. */
static void patch(void **state) {
  bw_context *context = check_context(state);
  const double pressure = 3e6, size[3] = {0.3, 0.2, 0.1}, away = 0.35;
  for (int which = 0; which < 3; which++) {
    int order = 1 + which / 2;
    bw_mesh *mesh = both(context, box_at(context, 0, 0, size, (int[3]){4, 3, 2}, order),
                         box_at(context, away, 0.101, size, (int[3]){5, 4, 2}, order));
    bw_model *model = model_of(context, mesh);
    bw_selection *top = body_face(context, mesh, 2, 0.201);
    slide(context, model, 2, 0);
    slide(context, model, 0, 0);
    slide(context, model, 1, 0);
    move(context, model, 0, away, (bool[3]){true, false, false}, (double[3]){-away, 0, 0});
    check_ok(context, bw_model_pressure(context, model, top, pressure));
    bw_contact_pair pair = {.on = body_face(context, mesh, 2, 0.101),
                            .against = body_face(context, mesh, 2, 0.1)};
    bw_contact *contact = slid(context, model, &pair, true, 1 + 2 * (which % 2), NULL);
    check_near(contact->state[0].force[2], pressure * 0.06, 1e-6 * pressure);
    assert_true(contact->iterations > 1);
    check_near(contact->state[0].area, 0.06, 1e-6);
    for (int32_t i = 0; i < mesh->node_count; i++)
      if (fabs(mesh->node[3 * i + 2] - 0.101) < 1e-9)
        check_near(contact->pressure[i], pressure, 0.01 * pressure);
    for (int32_t i = 0; i < top->node_count; i++)
      check_near(contact->solution->displacement[3 * top->node[i] + 2],
                 -1e-3 - 0.2 * pressure / young, 0.01 * 0.2 * pressure / young);
    bw_release(contact);
    bw_release(pair.on);
    bw_release(pair.against);
    bw_release(top);
    bw_release(model);
    bw_release(mesh);
  }
}

/* A block is pushed over seven elements of a long bed. Friction on the whole foot is mu N, its work
 * mu N d, and the pressure's centre is mu h ahead of the load's, also where the bed feels it. */
static void pushed(void **state) {
  bw_context *context = check_context(state);
  const double mu = 0.1, pressure = 1e6, d = 0.35, height = 0.1, load = pressure * 0.02;
  const double bed[3] = {0.9, 0.1, 0.1}, size[3] = {0.2, 0.1, height};
  bw_mesh *mesh = both(context, box_at(context, 0, 0, bed, (int[3]){18, 2, 2}, 1),
                       box_at(context, 0.1, 0.1 + 1e-9, size, (int[3]){6, 3, 3}, 1));
  for (int32_t i = 0; i < mesh->node_count; i++) /* no faces in one plane */
    if (fabs(mesh->node[3 * i + 2] - 0.1 - 1e-9) < 1e-12)
      mesh->node[3 * i + 2] = 0.1 + 1e-8;
  bw_selection *top = body_face(context, mesh, 2, 0.1 + 1e-9 + height);
  bw_contact_pair pair = {.on = body_face(context, mesh, 2, 0.1 + 1e-8),
                          .against = body_face(context, mesh, 2, 0.1),
                          .friction = mu};
  bw_contact *contact = NULL;
  for (int k = 0; k < 2; k++) { /* pressed, then pushed */
    bw_model *model = model_of(context, mesh);
    bw_contact *after = contact;
    slide(context, model, 1, 0);
    slide(context, model, 1, 0.1);
    move(context, model, 2, 0, (bool[3]){true, true, true}, (double[3]){0, 0, 0});
    check_ok(context, bw_model_prescribe(context, model, top, (bool[3]){true, false, false},
                                         (double[3]){k * d, 0, 0}));
    check_ok(context, bw_model_pressure(context, model, top, pressure));
    contact = slid(context, model, &pair, true, k ? 7 : 1, after);
    bw_release(after);
    bw_release(model);
  }
  const bw_contact_state *s = &contact->state[0];
  double sum = 0, first = 0;
  check_near(s->force[2], load, 1e-6 * load);
  check_near(s->friction[0], -mu * load, 1e-6 * load);
  check_near(s->work, mu * load * d, 0.01 * mu * load * d);
  check_near(s->slip, d, 0.01 * d);
  check_near(-s->moment[1] / load, 0.2 + mu * height + mu * 0.1, 0.002);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (fabs(mesh->node[3 * i + 2] - 0.1) < 1e-9) {
      sum += contact->solution->force[3 * i + 2];
      first += contact->solution->force[3 * i + 2] * mesh->node[3 * i];
    }
  check_near(sum, -load, 1e-6 * load);
  check_near(first / sum, 0.2 + d + mu * height, 0.002);
  bw_release(contact);
  bw_release(pair.on);
  bw_release(pair.against);
  bw_release(top);
  bw_release(mesh);
}

/* A block with a round foot, of radius 1 m. */
static void crown(void *data, const double unit[3], double out[3]) {
  const double *at = (const double *)data, x = 0.12 * (unit[0] - 0.5);
  out[0] = at[0] + x;
  out[1] = 0.02 * unit[1];
  out[2] = 0.1 + at[1] + 0.06 * unit[2] + (1 - unit[2]) * x * x / 2;
}

/* Pressed on a bed after it slid there, or made there. */
static void round_foot(void **state) {
  bw_context *context = check_context(state);
  const double depth = 1e-4, bed[3] = {0.6, 0.02, 0.1}, place = 0.4137, d = 0.2531;
  double largest[2], force[2], area[2];
  for (int finite = 0; finite < 2; finite++) {
    double at[2] = {finite ? place - d : place, 1e-6};
    bw_mesh *upper = NULL, *mesh;
    check_ok(context, bw_mesh_mapped_box(context, (int[3]){24, 1, 6}, 2, crown, at, &upper));
    mesh = both(context, box_at(context, 0, 0, bed, (int[3]){60, 1, 6}, 2), upper);
    bw_model *model = model_of(context, mesh);
    bw_selection *foot = NULL, *lower = body_face(context, mesh, 2, 0.1);
    const double low[3] = {at[0] - 0.03, -1, 0.1 + 5e-7}, high[3] = {at[0] + 0.03, 1, 0.1 + 6e-4};
    slide(context, model, 1, 0);
    move(context, model, 2, 0, (bool[3]){true, true, true}, (double[3]){0, 0, 0});
    move(context, model, 2, 0.16 + at[1], (bool[3]){true, true, true},
         (double[3]){finite ? d : 0, 0, -depth});
    check_ok(context, bw_select_box(context, mesh, low, high, &foot));
    bw_contact_pair pair = {.on = foot, .against = lower};
    bw_contact *contact = slid(context, model, &pair, finite, 2, NULL);
    assert_true(strstr(contact->notes, "slides by") == NULL);
    largest[finite] = contact->state[0].pressure;
    force[finite] = contact->state[0].force[2];
    area[finite] = contact->state[0].area;
    bw_release(contact);
    bw_release(foot);
    bw_release(lower);
    bw_release(model);
    bw_release(mesh);
  }
  assert_true(force[0] > 1e3);
  check_near(largest[1], largest[0], 0.002 * largest[0]);
  check_near(force[1], force[0], 0.002 * force[0]);
  check_near(area[1], area[0], 0.002 * area[0]);
}

/* A body that turns far is warned of, then refused. */
static void turns(void **state) {
  bw_context *context = check_context(state);
  const double angle[] = {0.01, 0.06, 0.3}, size[3] = {0.1, 0.1, 0.1};
  for (int k = 0; k < 3; k++) {
    bw_mesh *mesh = both(context, box_at(context, 0, 0, size, (int[3]){2, 2, 2}, 1),
                         box_at(context, 0, 0.12, size, (int[3]){3, 3, 3}, 1));
    bw_model *model = model_of(context, mesh);
    bw_selection *top = body_face(context, mesh, 2, 0.22);
    bw_contact_pair pair = {.on = body_face(context, mesh, 2, 0.12),
                            .against = body_face(context, mesh, 2, 0.1)};
    bw_contact *contact = NULL;
    bw_contact_options options;
    bw_array *field = NULL;
    bw_contact_options_default(&options);
    options.finite_sliding = true;
    check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &field));
    for (int32_t i = 0; i < mesh->node_count; i++) {
      ((double *)field->data)[3 * i] = -angle[k] * (mesh->node[3 * i + 1] - 0.05);
      ((double *)field->data)[3 * i + 1] = angle[k] * (mesh->node[3 * i] - 0.05);
    }
    move(context, model, 2, 0, (bool[3]){true, true, true}, (double[3]){0, 0, 0});
    check_ok(context,
             bw_model_prescribe_field(context, model, top, (bool[3]){true, true, true}, field));
    if (k < 2) {
      check_ok(context, bw_contact_solve(context, model, 1, &pair, NULL, &options, &contact));
      check_near(contact->rotation, angle[k], 1e-3 * angle[k]);
      assert_int_equal(strstr(contact->notes, "small, also in finite sliding: points") != NULL,
                       k == 1);
      bw_release(contact);
      contact = NULL;
      if (k == 0)
        check_allocations(context, contact,
                          bw_contact_solve(context, model, 1, &pair, NULL, &options, &contact));
    } else {
      check_fails(context, BW_LIMIT, "rotates by 17.2 degrees, and finite sliding allows 11.5",
                  bw_contact_solve(context, model, 1, &pair, NULL, &options, &contact));
      options.finite_sliding = false;
      check_ok(context, bw_contact_solve(context, model, 1, &pair, NULL, &options, &contact));
      assert_non_null(strstr(contact->notes, "rotates by 17.2 degrees on its contact, and"));
      bw_release(contact);
      contact = NULL;
      options.finite_sliding = true;
    }
    bw_release(field);
    bw_release(pair.on);
    bw_release(pair.against);
    bw_release(top);
    bw_release(model);
    bw_release(mesh);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(patch), check_test(pushed), check_test(round_foot),
                                     check_test(turns)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
