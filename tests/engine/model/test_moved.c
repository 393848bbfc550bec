/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Models and numberings of edited shapes: what is given on the surface goes with it, what is given
 * in space keeps its direction. */
#include "helpers.h"

/* x -> turn by `angle` about the z axis through the origin, stretched by `stretch` along x first.
 */
static bw_mesh *turned_mesh(bw_context *context, const bw_mesh *mesh, double angle,
                            double stretch) {
  bw_mesh *moved = NULL;
  double *node = (double *)malloc(3 * sizeof(double) * (size_t)mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i;
    node[3 * i] = stretch * x[0] * cos(angle) - x[1] * sin(angle);
    node[3 * i + 1] = stretch * x[0] * sin(angle) + x[1] * cos(angle);
    node[3 * i + 2] = x[2];
  }
  check_ok(context, bw_mesh_moved(context, mesh, node, &moved));
  free(node);
  return moved;
}

static void turn_vector(double angle, const double v[3], double out[3]) {
  double x = v[0] * cos(angle) - v[1] * sin(angle), y = v[0] * sin(angle) + v[1] * cos(angle);
  out[0] = x;
  out[1] = y;
  out[2] = v[2];
}

static void loads_go_with_the_surface(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 4, 1, 1, 4, 2, 2, 2);
  bw_model *model = some_model(context, mesh), *moved = NULL;
  bw_selection *tip = face_of(context, mesh, 0, 4), *top = face_of(context, mesh, 2, 1);
  const double force[3] = {3, 0, 0}, torque[3] = {5, 0, 0}, gravity[3] = {0, -10, 0};
  check_ok(context, bw_model_pressure(context, model, tip, 100));
  check_ok(context, bw_model_force(context, model, tip, force));
  check_ok(context, bw_model_torque(context, model, tip, torque, NULL));
  check_ok(context, bw_model_gravity(context, model, gravity));
  check_ok(context, bw_model_pressure(context, model, top, 7));
  const double about[3] = {4, 0.5, 2};
  check_ok(context, bw_model_torque(context, model, tip, torque, about));
  double angle = 0.7, normal[3] = {1, 0, 0}, along[3];
  bw_mesh *other = turned_mesh(context, mesh, angle, 1.5);
  check_ok(context, bw_model_moved(context, model, other, &moved));
  assert_int_equal(moved->load_count, 6);
  assert_ptr_equal(moved->mesh, other);
  assert_ptr_equal(moved->material, model->material);
  assert_ptr_equal(moved->load[0].on->mesh, other);
  assert_ptr_equal(moved->load[0].on, moved->load[1].on); /* shared before, shared now */
  turn_vector(angle, normal, along);
  for (int k = 0; k < 3; k++) {
    check_near(moved->load[0].resultant[k], -100 * along[k], 1e-9); /* pressure turns */
    check_near(moved->load[1].resultant[k], force[k], 1e-12);       /* a force does not */
    check_near(moved->load[2].resultant[k], 0, 1e-12);
  }
  double density = model->material->density;
  check_near(moved->load[3].resultant[1], -10 * 4 * 1.5 * density, 1e-6);
  check_near(moved->load[4].area, 6, 1e-12); /* stretched */
  double centre[3], tip_centre[3] = {6, 0.5, 0.5};
  turn_vector(angle, tip_centre, centre);
  for (int k = 0; k < 3; k++) {
    check_near(moved->load[2].about[k], centre[k], 1e-12);
    check_near(moved->load[5].about[k], centre[k] + (k == 2 ? 1.5 : 0), 1e-12);
  }
  bw_release(moved);
  bw_release(other);

  bw_mesh *finer = box_mesh(context, 4, 1, 1, 5, 2, 2, 2);
  check_fails(context, BW_INVALID, "same elements", bw_model_moved(context, model, finer, &moved));
  bw_release(finer);
  bw_release(top);
  bw_release(tip);
  bw_release(model);
  bw_release(mesh);
}

static void supports_go_with_the_surface(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 2, 1, 1, 2, 2, 2, 1);
  bw_model *model = some_model(context, mesh), *moved = NULL;
  bw_selection *side = face_of(context, mesh, 1, 0), *root = face_of(context, mesh, 0, 0);
  const double given[3] = {0, 0, 1}, by[3] = {0, 0, 0};
  const bool fixed[3] = {true, true, false};
  check_ok(context, bw_model_slide(context, model, side, NULL));
  check_ok(context, bw_model_slide(context, model, side, given));
  check_ok(context, bw_model_prescribe(context, model, root, fixed, by));
  double angle = 0.4;
  bw_mesh *other = turned_mesh(context, mesh, angle, 1);
  check_ok(context, bw_model_moved(context, model, other, &moved));
  assert_int_equal(moved->support_count, 3);
  bw_dof_map *dof_map = NULL;
  check_ok(context, bw_dof_map_create(context, moved, &dof_map));
  /* a node of the side off the root is constrained along the rotated normal and along z */
  int32_t node = -1;
  for (int32_t i = 0; i < side->node_count; i++)
    if (mesh->node[3 * side->node[i]] > 1.5)
      node = side->node[i];
  assert_true(node >= 0);
  double sum[3][3] = {{0}}, normal[3] = {0, -1, 0}, n[3], z[3] = {0, 0, 1};
  turn_vector(angle, normal, n);
  int32_t row = dof_map->frame_of[node];
  assert_true(row >= 0);
  for (int k = 0; k < 3; k++)
    if (dof_map->state[3 * node + k] == BW_DOF_PRESCRIBED)
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          sum[i][j] += dof_map->frame[9 * row + 3 * k + i] * dof_map->frame[9 * row + 3 * k + j];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      check_near(sum[i][j], n[i] * n[j] + z[i] * z[j], 1e-12);
  bw_release(dof_map);
  bw_release(moved);
  bw_release(other);
  bw_release(root);
  bw_release(side);
  bw_release(model);
  bw_release(mesh);
}

/* Inner elements refilled: the boundary stays, inner nodes are others. */
static void transferred_to_a_refilled_mesh(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 4, 2, 2, 8, 4, 4, 1), *refilled = NULL;
  bw_model *model = some_model(context, mesh), *moved = NULL;
  uint8_t *replace = (uint8_t *)calloc((size_t)mesh->element_count, 1);
  int32_t *node_from = NULL, *element_from = NULL;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    double x = 0;
    for (int a = 0; a < 4; a++)
      x += mesh->node[3 * mesh->element[4 * e + a]] / 4;
    replace[e] = x > 1 && x < 3;
  }
  check_ok(context, bw_mesh_refill(context, mesh, mesh->node, replace, &refilled, &node_from,
                                   &element_from));
  bw_selection *root = face_of(context, mesh, 0, 0), *top = face_of(context, mesh, 2, 2);
  const bool fixed[3] = {true, true, true};
  bw_array *field = NULL, *force = NULL, *warm = NULL;
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &field));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 3, &force));
  check_ok(context, bw_array_create(context, BW_F64, mesh->node_count, 1, &warm));
  for (int32_t i = 0; i < mesh->node_count; i++) {
    ((double *)field->data)[3 * i] = 1e-3 * mesh->node[3 * i + 1];
    ((double *)warm->data)[i] = 20;
    if (mesh->node[3 * i] > 3.9)
      ((double *)force->data)[3 * i + 2] = 1 + mesh->node[3 * i + 1];
  }
  check_ok(context, bw_model_prescribe_field(context, model, root, fixed, field));
  check_ok(context, bw_model_pressure(context, model, top, 5));
  check_ok(context, bw_model_nodal_forces(context, model, force));
  check_ok(context, bw_model_temperature(context, model, warm, &(double){1e-5}));
  check_ok(context, bw_model_transferred(context, model, refilled, node_from, &moved));
  for (int l = 0; l < 3; l++)
    for (int k = 0; k < 3; k++) {
      check_near(moved->load[l].resultant[k], model->load[l].resultant[k], 1e-6);
      check_near(moved->load[l].moment[k], model->load[l].moment[k], 1e-6);
    }
  bw_dof_map *a = NULL, *b = NULL;
  check_ok(context, bw_dof_map_create(context, model, &a));
  check_ok(context, bw_dof_map_create(context, moved, &b));
  for (int32_t i = 0; i < refilled->node_count; i++)
    for (int k = 0; k < 3; k++) {
      int state_before = node_from[i] < 0 ? BW_DOF_UNKNOWN : a->state[3 * node_from[i] + k];
      assert_int_equal(b->state[3 * i + k], state_before);
      check_near(b->value[3 * i + k], node_from[i] < 0 ? 0 : a->value[3 * node_from[i] + k], 0);
    }
  bw_release(a);
  bw_release(b);
  bw_release(moved);
  /* what cannot be said on the new nodes */
  double *own_warm = (double *)model->load[2].nodal->data; /* models keep copies */
  double *own_force = (double *)model->load[1].nodal->data;
  own_warm[3] = 21;
  check_fails(context, BW_UNSUPPORTED, "temperature that varies",
              bw_model_transferred(context, model, refilled, node_from, &moved));
  own_warm[3] = 20;
  uint8_t *there = (uint8_t *)calloc((size_t)mesh->node_count, 1);
  for (int32_t i = 0; i < refilled->node_count; i++)
    if (node_from[i] >= 0)
      there[node_from[i]] = 1;
  int32_t gone = 0;
  while (gone < mesh->node_count && there[gone])
    gone++;
  assert_true(gone < mesh->node_count);
  own_force[3 * gone] = 1;
  check_fails(context, BW_UNSUPPORTED, "inside the part",
              bw_model_transferred(context, model, refilled, node_from, &moved));
  own_force[3 * gone] = 0;
  check_fails(context, BW_INVALID, "boundary",
              bw_model_transferred(context, model, mesh, node_from, &moved));
  free(there);
  free(replace);
  bw_free(node_from);
  bw_free(element_from);
  bw_release(warm);
  bw_release(force);
  bw_release(field);
  bw_release(top);
  bw_release(root);
  bw_release(model);
  bw_release(refilled);
  bw_release(mesh);
}

/* A DOF map in the frames of two subdomains: which nodes take them, what they make of prescribed
 * values, what makes the unknowns others. */
static void dof_map_in_frames(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 4, 1, 1, 4, 2, 2, 1);
  bw_model *model = some_model(context, mesh);
  bw_selection *root = face_of(context, mesh, 0, 0), *side = face_of(context, mesh, 1, 0);
  const bool all[3] = {true, true, true};
  const double by[3] = {0, 0, 3}; /* along the side, however it turns: the two agree */
  check_ok(context, bw_model_prescribe(context, model, root, all, by));
  check_ok(context, bw_model_slide(context, model, side, NULL));
  int32_t *subdomain = (int32_t *)malloc(sizeof *subdomain * (size_t)mesh->node_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    subdomain[i] = mesh->node[3 * i] > 2 ? 1 : mesh->node[3 * i] > 1.5 ? -1 : 0;
  double c = cos(0.3), s = sin(0.3);
  const double frame[18] = {c, s, 0, -s, c, 0, 0, 0, 1, 1, 0, 0, 0, c, s, 0, -s, c};
  bw_dof_map *first = NULL, *next = NULL;
  bool same = true;
  check_ok(context, bw_dof_map_follow(context, model, NULL, 2, subdomain, frame, &same, &first));
  assert_false(same);
  int32_t supports = first->frame_count - 2;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * i;
    bool slides = x[1] == 0 && x[0] > 0;
    if (slides) {
      assert_true(first->frame_of[i] >= 0 && first->frame_of[i] < supports);
      assert_int_equal(first->state[3 * i], BW_DOF_PRESCRIBED);
      assert_int_equal(first->state[3 * i + 1], BW_DOF_UNKNOWN);
    } else
      assert_int_equal(first->frame_of[i], subdomain[i] < 0 ? -1 : supports + subdomain[i]);
    for (int k = 0; x[0] == 0 && k < 3; k++) { /* the value back in global directions */
      double value = 0;
      const double *rows = first->frame + 9 * first->frame_of[i];
      for (int r = 0; r < 3; r++)
        value += rows[3 * r + k] * first->value[3 * i + r];
      check_near(value, by[k], 1e-14);
    }
  }
  /* turned as a whole, the side's normals with it: the same unknowns */
  bw_mesh *turned = turned_mesh(context, mesh, 0.5, 1.2);
  bw_model *moved = NULL;
  check_ok(context, bw_model_moved(context, model, turned, &moved));
  check_ok(context, bw_dof_map_follow(context, moved, first, 2, subdomain, frame, &same, &next));
  assert_true(same);
  assert_memory_equal(next->unknown, first->unknown,
                      3 * sizeof(int32_t) * (size_t)mesh->node_count);
  bw_release(next);
  subdomain[0] = 2;
  check_fails(context, BW_INVALID, "subdomain 3: the subdomains are 1 to 2",
              bw_dof_map_follow(context, moved, first, 2, subdomain, frame, &same, &next));
  subdomain[0] = 0;
  /* fixed in other directions: other unknowns */
  check_ok(context, bw_model_fix(context, moved, moved->support[1].on));
  check_fails(context, BW_INVALID, "earlier supports",
              bw_dof_map_follow(context, moved, first, 2, subdomain, frame, &same, &next));
  bw_model_clear_supports(moved);
  check_ok(context, bw_dof_map_follow(context, moved, first, 2, subdomain, frame, &same, &next));
  assert_false(same);
  bw_release(next);
  bw_release(moved);
  bw_release(turned);
  bw_release(first);
  free(subdomain);
  bw_release(side);
  bw_release(root);
  bw_release(model);
  bw_release(mesh);
}

/* A free body's pins stay, turn with it, and are chosen again where the shape makes them poor. */
static void pins_stay(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 4, 1, 1, 8, 2, 2, 1);
  bw_model *model = some_model(context, mesh), *moved = NULL;
  int32_t *subdomain = (int32_t *)calloc((size_t)mesh->node_count, sizeof *subdomain);
  const double rest[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  bw_dof_map *first = NULL, *next = NULL;
  bool same;
  check_ok(context, bw_dof_map_follow(context, model, NULL, 1, subdomain, rest, &same, &first));
  assert_int_equal(first->rigid_mode_count, 6);
  double c = cos(2.), s = sin(2.);
  const double frame[9] = {c, s, 0, -s, c, 0, 0, 0, 1};
  bw_mesh *turned = turned_mesh(context, mesh, 2., 1.3);
  check_ok(context, bw_model_moved(context, model, turned, &moved));
  check_ok(context, bw_dof_map_follow(context, moved, first, 1, subdomain, frame, &same, &next));
  assert_true(same);
  assert_int_equal(next->rigid_mode_count, 6);
  bw_release(next);
  bw_release(moved);
  bw_release(turned);
  /* isostatic near one end, by hand: far too weak on what is seen as a longer body */
  memset(first->state, BW_DOF_UNKNOWN, 3 * (size_t)mesh->node_count);
  int isostatic = 0;
  for (int32_t i = 0; i < mesh->node_count && isostatic < 6; i++)
    if (mesh->node[3 * i] < 0.1)
      for (int k = 0; k < 3 && isostatic < 6; k++, isostatic++)
        first->state[3 * i + k] = BW_DOF_ISOSTATIC;
  check_ok(context, bw_dof_map_follow(context, model, first, 1, subdomain, rest, &same, &next));
  assert_false(same);
  bw_release(next);
  bw_release(first);
  free(subdomain);
  bw_release(model);
  bw_release(mesh);
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = box_mesh(context, 2, 1, 1, 2, 1, 1, 2);
  bw_model *model = some_model(context, mesh);
  bw_selection *root = face_of(context, mesh, 0, 0), *side = face_of(context, mesh, 1, 0);
  const double torque[3] = {1, 0, 0};
  check_ok(context, bw_model_fix(context, model, root));
  check_ok(context, bw_model_slide(context, model, side, NULL));
  check_ok(context, bw_model_torque(context, model, side, torque, NULL));
  int32_t *subdomain = (int32_t *)calloc((size_t)mesh->node_count, sizeof *subdomain);
  const double rest[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  check_each_allocation(context, status, 1) {
    bw_model *moved = NULL;
    bw_dof_map *dof_map = NULL;
    bool same;
    status = bw_model_moved(context, model, mesh, &moved);
    if (status == BW_OK)
      status = bw_dof_map_follow(context, moved, NULL, 1, subdomain, rest, &same, &dof_map);
    bw_release(dof_map);
    bw_release(moved);
  }
  free(subdomain);
  bw_release(side);
  bw_release(root);
  bw_release(model);
  bw_release(mesh);
}

check_main(check_test(loads_go_with_the_surface), check_test(supports_go_with_the_surface),
           check_test(transferred_to_a_refilled_mesh), check_test(dof_map_in_frames),
           check_test(pins_stay), check_test(no_memory))
