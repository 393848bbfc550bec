/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Contact with rigid surfaces and between parts against closed forms, and what it says where it has
 * none. */
#include "parts.h"

static bw_contact *solved(bw_context *context, const bw_model *model, const bw_selection *on,
                          const bw_rigid_surface *with) {
  bw_contact *contact = NULL;
  bw_contact_pair pair = {.on = on, .with = with};
  check_ok(context, bw_contact_solve(context, model, 1, &pair, NULL, NULL, &contact));
  return contact;
}

/* A free block between its load and a plane under it: one pressure, one stress, any elements; the
 * plane may be turned and away. */
static void patch(void **state) {
  bw_context *context = check_context(state);
  const double pressure = 3e6;
  for (int which = 0; which < 4; which++) {
    int order = which % 2 + 1;
    bw_mesh *mesh = body_box(context, 0.3, 0.2, 0.1, 4, 3, 2, order);
    bw_model *model = model_of(context, mesh);
    bw_selection *top = body_face(context, mesh, 2, 0.1), *foot = body_face(context, mesh, 2, 0);
    bw_rigid_surface *floor = NULL;
    const double point[3] = {1, 2, which < 2 ? 0 : -0.01};
    check_ok(context, bw_model_pressure(context, model, top, pressure));
    check_ok(context, bw_rigid_plane(context, point, (double[3]){0, 0, 3}, &floor));
    bw_contact *contact = solved(context, model, foot, floor);
    assert_int_equal(contact->state[0].active, contact->state[0].candidates);
    check_near(contact->state[0].force[2], pressure * 0.06, 1e-9 * pressure);
    check_near(contact->state[0].area, 0.06, 1e-12);
    check_near(contact->state[0].moment[0], pressure * 0.006, 1e-9 * pressure);
    for (int32_t i = 0; i < foot->node_count; i++) {
      check_near(contact->pressure[foot->node[i]], pressure, 1e-6 * pressure);
      check_near(contact->gap[foot->node[i]], 0, 1e-12);
      check_near(contact->solution->displacement[3 * foot->node[i] + 2], point[2], 1e-12);
    }
    for (int32_t i = 0; i < top->node_count; i++)
      check_near(contact->solution->displacement[3 * top->node[i] + 2],
                 point[2] - 0.1 * pressure / young, 1e-12);
    assert_int_equal(contact->free_count, 3); /* along the plane, and about its normal */
    assert_non_null(strstr(contact->free_text, "translation along (1, 0, 0)"));
    assert_non_null(strstr(contact->free_text, "rotation about the axis"));
    bw_release(contact);
    bw_release(floor);
    bw_release(top);
    bw_release(foot);
    bw_release(model);
    bw_release(mesh);
  }
}

/* A free block far above the plane that stops it, under its weight or a light pressure. */
static void falls(void **state) {
  bw_context *context = check_context(state);
  const double away[] = {0.01, 0.1, 1};
  for (int which = 0; which < 6; which++) {
    bw_mesh *mesh = body_box(context, 0.1, 0.1, 0.05, 4, 4, 2, 1);
    bw_model *model = model_of(context, mesh);
    bw_selection *top = body_face(context, mesh, 2, 0.05), *foot = body_face(context, mesh, 2, 0);
    bw_rigid_surface *floor = NULL;
    double gap = away[which / 2], weight = 100;
    if (which % 2) {
      check_ok(context, bw_model_gravity(context, model, (double[3]){0, 0, -9.81}));
      weight = 9.81 * model->material->density * 5e-4;
    } else
      check_ok(context, bw_model_pressure(context, model, top, 1e4));
    check_ok(context, bw_rigid_plane(context, (double[3]){0, 0, -gap}, axis[2], &floor));
    bw_contact *contact = solved(context, model, foot, floor);
    check_near(contact->state[0].force[2], weight, 1e-5 * weight);
    check_near(contact->solution->displacement[3 * foot->node[0] + 2], -gap, 1e-9);
    assert_true(contact->free_count == 3);
    bw_release(contact);
    bw_release(floor);
    bw_release(top);
    bw_release(foot);
    bw_release(model);
    bw_release(mesh);
  }
}

/* A quarter of what lies below z = 0 about the z-axis, or with a width a half: cells of one size to
 * `fine`, which are the fraction `share`, and larger and larger ones from there to `size`. */
typedef struct graded {
  double size, fine, share, steep, width;
} graded;

static double grade(const graded *g, double s) {
  if (s <= g->share)
    return g->fine * s / g->share;
  s = (s - g->share) / (1 - g->share);
  return g->fine + (g->size - g->fine) * (exp(g->steep * s) - 1) / (exp(g->steep) - 1);
}

static void quarter(void *data, const double unit[3], double out[3]) {
  const graded *g = data;
  out[0] = grade(g, unit[0]);
  out[1] = g->width > 0 ? g->width * unit[1] : grade(g, unit[1]);
  out[2] = -grade(g, 1 - unit[2]);
}

/* A rigid sphere or cylinder along y on a half-space (Johnson 1985, sections 4.1 and 4.2): its
 * force on the quarter or half of the model, the largest pressure and the area. */
static void hertz(bw_context *context, bool line, double a, double radius, double depth,
                  double pressure, bw_contact_state *state) {
  graded how = {.size = 40 * a, .fine = 1.2 * a, .share = 0.5, .steep = 4.5};
  int n = line ? 44 : 16;
  const int cells[3] = {n, line ? 1 : n, n};
  if (line)
    how = (graded){.size = 40 * a, .fine = 1.3 * a, .share = 0.7, .steep = 4.5, .width = 0.3 * a};
  bw_mesh *mesh = NULL;
  bw_rigid_surface *with = NULL;
  const double centre[3] = {0, 0, radius - depth};
  check_ok(context, bw_mesh_mapped_box(context, cells, 2, quarter, &how, &mesh));
  bw_model *model = model_of(context, mesh);
  bw_selection *top = body_face(context, mesh, 2, 0),
               *foot = body_face(context, mesh, 2, -how.size);
  slide(context, model, 0, 0);
  slide(context, model, 1, 0);
  if (line)
    slide(context, model, 1, how.width);
  if (pressure > 0)
    check_ok(context, bw_model_pressure(context, model, foot, pressure));
  else
    check_ok(context, bw_model_fix(context, model, foot));
  check_ok(context, line ? bw_rigid_cylinder(context, centre, axis[1], radius, false, &with)
                         : bw_rigid_sphere(context, centre, radius, false, &with));
  bw_contact *contact = solved(context, model, top, with);
  *state = *contact->state;
  for (int32_t i = 0; i < mesh->node_count; i++)
    assert_true(contact->pressure[i] >= 0);
  assert_true(contact->solution->residual < 1e-8);
  bw_release(contact);
  bw_release(with);
  bw_release(top);
  bw_release(foot);
  bw_release(model);
  bw_release(mesh);
}

static void hertz_sphere(void **state) {
  bw_context *context = check_context(state);
  const double radius = 0.05, depth = 2e-5, modulus = young / (1 - poisson * poisson);
  const double a = sqrt(radius * depth), force = 4. / 3 * modulus * sqrt(radius) * pow(depth, 1.5);
  bw_contact_state s;
  hertz(context, false, a, radius, depth, 0, &s);
  check_near(pow(-4 * s.force[2] / force, 2. / 3), 1, 0.02); /* the approach */
  check_near(s.pressure, 2 * modulus / M_PI * sqrt(depth / radius), 0.02 * s.pressure);
  check_near(sqrt(4 * s.area / M_PI), a, 0.02 * a);
}

static void hertz_cylinder(void **state) {
  bw_context *context = check_context(state);
  const double radius = 0.05, guess = 1e-3, modulus = young / (1 - poisson * poisson);
  bw_contact_state s;
  hertz(context, true, guess, radius, 6e-5, 0, &s);
  double force = -2 * s.force[2] / (0.3 * guess), a = sqrt(4 * force * radius / (M_PI * modulus));
  check_near(s.area / (0.3 * guess), a, 0.02 * a);
  check_near(s.pressure, 2 * force / (M_PI * a), 0.02 * s.pressure);
}

/* The ball is away from a body that nothing but it holds along z. */
static void pressed_on_ball(void **state) {
  bw_context *context = check_context(state);
  const double radius = 0.05, a = 1e-3, modulus = young / (1 - poisson * poisson);
  const double force = 4. / 3 * modulus * pow(a, 3) / radius;
  bw_contact_state s;
  hertz(context, false, a, radius, -0.01, force / pow(80 * a, 2), &s);
  check_near(-4 * s.force[2], force, 1e-5 * force);
  check_near(s.pressure, 2 * modulus / M_PI * a / radius, 0.02 * s.pressure);
  check_near(sqrt(4 * s.area / M_PI), a, 0.05 * a); /* half a cell */
  assert_true(s.penetration < 0.1 * a * a / radius);
}

/* A free block in a corner of three planes: each takes its part of the load, as one pressure. */
static void corner(void **state) {
  bw_context *context = check_context(state);
  const double stress[3] = {1e6, 2e6, 5e6};
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = body_box(context, 0.2, 0.2, 0.2, 3, 4, 3, order);
    bw_model *model = model_of(context, mesh);
    bw_selection *wall[3];
    bw_rigid_surface *with[3];
    bw_contact_pair pair[3];
    bw_contact *contact = NULL;
    for (int k = 0; k < 3; k++) {
      bw_selection *loaded = body_face(context, mesh, k, 0.2);
      check_ok(context, bw_model_pressure(context, model, loaded, stress[k]));
      bw_release(loaded);
      wall[k] = body_face(context, mesh, k, 0);
      check_ok(context, bw_rigid_plane(context, (double[3]){-1e-3, -2e-3, 0}, axis[k], &with[k]));
      pair[k] = (bw_contact_pair){.on = wall[k], .with = with[k]};
    }
    check_ok(context, bw_contact_solve(context, model, 3, pair, NULL, NULL, &contact));
    for (int k = 0; k < 3; k++)
      for (int l = 0; l < 3; l++)
        check_near(contact->state[k].force[l], k == l ? stress[k] * 0.04 : 0, 40);
    assert_int_equal(contact->free_count, 0);
    for (int32_t i = 0; i < mesh->node_count; i++) { /* where walls meet, the larger */
      double p = 0;
      for (int k = 0; k < 3; k++)
        if (mesh->node[3 * (int64_t)i + k] < 1e-9)
          p = fmax(p, stress[k]);
      check_near(contact->pressure[i], p, 1e-4 * p);
    }
    for (int k = 0; k < 3; k++) {
      bw_release(wall[k]);
      bw_release(with[k]);
    }
    bw_release(contact);
    bw_release(model);
    bw_release(mesh);
  }
}

/* A bar fixed at one end over a stop: it touches where its end sinks by more than the gap. Then the
 * force is that which brings the end back to the gap, by the compliance of the end. */
static void stop(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 1, 0.1, 0.1, 20, 2, 2, 2);
  bw_model *model = model_of(context, mesh);
  bw_selection *root = body_face(context, mesh, 0, 0), *end = body_face(context, mesh, 0, 1),
               *low = NULL;
  bw_selection *below = body_face(context, mesh, 2, 0), *tip = NULL,
               *top = body_face(context, mesh, 2, 0.1);
  check_ok(context, bw_select_half_space(context, mesh, (double[3]){0.95, 0, 0},
                                         (double[3]){-1, 0, 0}, 1e-9, &tip));
  check_ok(context, bw_select_combine(context, below, tip, BW_INTERSECTION, &low));
  check_ok(context, bw_model_fix(context, model, root));
  check_ok(context, bw_model_pressure(context, model, top, 1e5)); /* 10 kN/m */
  const double inertia = 1e-4 / 12, sink = 1e4 / (8 * young * inertia);
  for (int far = 0; far < 2; far++) {
    double gap = far ? 1.1 * sink : 0.4 * sink;
    bw_rigid_surface *floor = NULL;
    check_ok(context, bw_rigid_plane(context, (double[3]){0, 0, -gap}, axis[2], &floor));
    bw_contact *contact = solved(context, model, low, floor);
    if (far) {
      assert_int_equal(contact->state[0].active, 0);
      check_near(contact->state[0].gap, 0.1 * sink, 0.02 * sink);
      assert_non_null(strstr(bw_warning_at(context, 0), "contact pair 1 stays open"));
    } else { /* Euler and Bernoulli; the stop touches from x = 0.95 on, shear and ends are left out
              */
      double expected = 3 * young * inertia * 0.6 * sink;
      check_near(contact->state[0].force[2], expected, 0.07 * expected);
    }
    bw_release(contact);
    bw_release(floor);
  }
  bw_release(root);
  bw_release(end);
  bw_release(low);
  bw_release(below);
  bw_release(tip);
  bw_release(top);
  bw_release(model);
  bw_release(mesh);
}

/* A turned block fixed at its foot, which lies in the plane but for rounding. */
static void fixed_foot(void **state) {
  bw_context *context = check_context(state);
  for (int turn = 1; turn < 12; turn++) {
    double c = cos(0.5 * turn), s = sin(0.5 * turn);
    bw_mesh *straight = body_box(context, 0.3, 0.2, 0.1, 6, 4, 2, 1), *mesh = NULL;
    double *node = numbers(3 * (int64_t)straight->node_count);
    for (int64_t i = 0; i < straight->node_count; i++) {
      const double *x = straight->node + 3 * i;
      node[3 * i] = c * x[0] + s * x[2];
      node[3 * i + 1] = x[1];
      node[3 * i + 2] = c * x[2] - s * x[0];
    }
    check_ok(context, bw_mesh_copy(context, 1, straight->node_count, node, straight->element_count,
                                   straight->element, NULL, &mesh));
    bw_model *model = model_of(context, mesh);
    bw_selection *all = NULL, *foot = NULL;
    bw_rigid_surface *floor = NULL;
    const double normal[3] = {s, 0, c};
    check_ok(context, bw_select_all(context, mesh, &all));
    check_ok(context, bw_select_plane(context, mesh, (double[3]){0}, normal, 1e-9, &foot));
    check_ok(context, bw_model_fix(context, model, foot));
    check_ok(context, bw_model_gravity(context, model, (double[3]){1, 0, 0}));
    check_ok(context, bw_rigid_plane(context, (double[3]){0}, normal, &floor));
    bw_contact *contact = solved(context, model, all, floor);
    assert_true(contact->state[0].active == 0 && contact->state[0].penetration == 0);
    bw_release(contact);
    bw_release(floor);
    bw_release(foot);
    bw_release(all);
    bw_release(model);
    bw_release(mesh);
    bw_release(straight);
    free(node);
  }
}

/* A free block on a fixed one whose facets do not match: one stress, but for the rule at the edges
 * of the facets. */
static void patch_between_parts(void **state) {
  bw_context *context = check_context(state);
  const double pressure = 3e6;
  for (int order = 1; order <= 2; order++) {
    bw_mesh *lower = body_box(context, 0.3, 0.2, 0.1, 4, 3, 2, order), *mesh = NULL;
    bw_mesh *upper = NULL;
    const double low[3] = {0, 0, 0.101}, high[3] = {0.3, 0.2, 0.2};
    const int cells[3] = {5, 4, 2};
    check_ok(context, bw_mesh_box_grid(context, low, high, cells, order, &upper));
    mesh = both(context, lower, upper);
    bw_model *model = model_of(context, mesh);
    bw_selection *top = body_face(context, mesh, 2, 0.2), *on = body_face(context, mesh, 2, 0.101);
    bw_selection *against = body_face(context, mesh, 2, 0.1);
    bw_contact *contact = NULL;
    slide(context, model, 2, 0);
    slide(context, model, 0, 0);
    slide(context, model, 1, 0);
    check_ok(context, bw_model_pressure(context, model, top, pressure));
    bw_contact_pair pair = {.on = on, .against = against};
    check_ok(context, bw_contact_solve(context, model, 1, &pair, NULL, NULL, &contact));
    check_near(contact->state[0].force[2], pressure * 0.06, 1e-6 * pressure);
    for (int32_t i = 0; i < on->node_count; i++)
      check_near(contact->pressure[on->node[i]], pressure, 0.01 * pressure);
    for (int32_t i = 0; i < top->node_count; i++)
      check_near(contact->solution->displacement[3 * top->node[i] + 2],
                 -1e-3 - 0.199 * pressure / young, 0.01 * 0.199 * pressure / young);
    bw_release(contact);
    bw_release(top);
    bw_release(on);
    bw_release(against);
    bw_release(model);
    bw_release(mesh);
  }
}

/* A quarter of a ring between two radii. */
static void ring(void *data, const double unit[3], double out[3]) {
  const double *size = (const double *)data;
  double r = size[0] + (size[1] - size[0]) * unit[0], angle = M_PI / 2 * unit[1];
  out[0] = r * cos(angle);
  out[1] = r * sin(angle);
  out[2] = size[2] * unit[2];
}

/* The same between two radii; with flat facets along the angle. */
typedef struct ring_shape {
  double size[3];
  int facets; /* along the angle, or 0: curved ones */
} ring_shape;

static void ring_of(void *data, const double unit[3], double out[3]) {
  const ring_shape *shape = (const ring_shape *)data;
  double size[3] = {shape->size[0], shape->size[1], shape->size[2]}, end[2][3];
  double at = unit[1] * shape->facets, part = at - floor(at);
  if (shape->facets == 0) {
    ring(size, unit, out);
    return;
  }
  for (int k = 0; k < 2; k++) {
    double corner[3] = {unit[0], (floor(at) + k) / shape->facets, unit[2]};
    ring(size, corner, end[k]);
  }
  for (int k = 0; k < 3; k++)
    out[k] = (1 - part) * end[0][k] + part * end[1][k];
}

static const double fit_radius[3] = {0.02, 0.03, 0.05}, fit_width = 0.004, fit_interference = 2e-5;

/* The equations of many loads have the displacement of a contact without a load. */
static void check_many_loads(bw_context *context, const bw_model *model,
                             const bw_contact_pair *pair, const bw_contact *contact) {
  bw_contact_system *many = NULL;
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  double *u = numbers(size), off = 0, largest = 0;
  check_ok(context, bw_contact_system_create(context, model, 1, pair, NULL, NULL, &many));
  check_ok(context, bw_contact_system_solve(context, many, 1, u, u, NULL));
  for (int64_t i = 0; i < size; i++) {
    off = fmax(off, fabs(u[i] - contact->solution->displacement[i]));
    largest = fmax(largest, fabs(u[i]));
  }
  assert_true(off < 1e-7 * largest);
  bw_release(many);
  free(u);
}

/* A ring in a ring that is too small for it, in plane strain, of so many cells along the angle
 * (Lame; Timoshenko and Goodier 1970, section 28); the largest error of a pressure at a corner. */
static double press_fit_error(bw_context *context, int inner, int outer, bool flat, bool smooth,
                              bw_contact **contact) {
  double a = fit_radius[0], b = fit_radius[1], c = fit_radius[2], off = 0;
  const int cells[2][3] = {{4, inner, 1}, {6, outer, 1}};
  bw_mesh *part[2] = {NULL, NULL};
  bw_selection *face[2] = {NULL, NULL};
  for (int k = 0; k < 2; k++) {
    ring_shape shape = {{fit_radius[k], fit_radius[k + 1], fit_width}, flat ? cells[k][1] : 0};
    check_ok(context, bw_mesh_mapped_box(context, cells[k], 2, ring_of, &shape, &part[k]));
  }
  int32_t first = part[0]->node_count;
  bw_mesh *mesh = both(context, part[0], part[1]);
  bw_model *model = model_of(context, mesh);
  for (int k = 0; k < 3; k++)
    slide(context, model, k, 0);
  slide(context, model, 2, fit_width);
  for (int side = 0; side < 2; side++) {
    uint8_t *mask = (uint8_t *)calloc((size_t)mesh->facet_count, 1);
    for (int32_t f = 0; f < mesh->facet_count; f++) {
      bool all = true;
      for (int k = 0; k < 3; k++) {
        int32_t i = mesh->facet[(int64_t)f * mesh->nodes_per_facet + k];
        double r = hypot(mesh->node[3 * (int64_t)i], mesh->node[3 * (int64_t)i + 1]);
        all = all && fabs(r - b) < 1e-9 && (i < first) == (side == 0);
      }
      mask[f] = all;
    }
    check_ok(context, bw_select_mask(context, mesh, mask, NULL, &face[side]));
    free(mask);
  }
  bw_contact_pair pair = {
      .on = face[0], .against = face[1], .interference = fit_interference, .smooth = smooth};
  check_ok(context, bw_contact_solve(context, model, 1, &pair, NULL, NULL, contact));
  check_many_loads(context, model, &pair, *contact);
  double sum = (b * b + a * a) / (b * b - a * a) + (c * c + b * b) / (c * c - b * b);
  double exact = young / (1 - poisson * poisson) * fit_interference / (b * sum);
  for (int32_t f = 0; f < face[0]->facet_count; f++)
    for (int k = 0; k < 3; k++) {
      int32_t i = mesh->facet[(int64_t)face[0]->facet[f] * mesh->nodes_per_facet + k];
      off = fmax(off, fabs((*contact)->pressure[i] - exact) / exact);
    }
  bw_release(face[0]);
  bw_release(face[1]);
  bw_release(model);
  bw_release(mesh);
  return off;
}

static void press_fit(void **state) {
  bw_context *context = check_context(state);
  bw_contact *contact = NULL;
  double area = M_PI / 2 * fit_radius[1] * fit_width;
  assert_true(press_fit_error(context, 11, 14, false, false, &contact) < 0.01);
  check_near(contact->state[0].area, area, 1e-3 * area);
  assert_string_equal(contact->notes, "");
  bw_release(contact);
}

/* Flat facets that do not match are as far apart as the interference: the pressure is that of the
 * facets, and the result says so. Where gaps are those of round faces it is Lame's. */
static void press_fit_of_flat_facets(void **state) {
  bw_context *context = check_context(state);
  bw_contact *contact = NULL;
  assert_true(press_fit_error(context, 22, 31, true, false, &contact) > 1);
  assert_non_null(strstr(contact->notes, "uncertain"));
  bw_release(contact);
  assert_true(press_fit_error(context, 22, 31, true, true, &contact) < 0.01);
  assert_string_equal(contact->notes, "");
  bw_release(contact);
  assert_true(press_fit_error(context, 11, 14, true, true, &contact) < 0.03);
  bw_release(contact);
  assert_true(press_fit_error(context, 14, 14, true, false, &contact) < 0.03); /* they match */
  assert_string_equal(contact->notes, "");
  bw_release(contact);
}

/* A block on a block; the whole surface of the upper one may touch the lower one's top and sides:
 * only the facets that face each other do. */
static void facing(void **state) {
  bw_context *context = check_context(state);
  const double pressure = 1e6, low[3] = {0, 0, 0.1}, high[3] = {0.3, 0.2, 0.2};
  const int cells[3] = {4, 3, 2};
  bw_mesh *lower = body_box(context, 0.3, 0.2, 0.1, 4, 3, 2, 1), *upper = NULL;
  int32_t first = lower->node_count;
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, 1, &upper));
  bw_mesh *mesh = both(context, lower, upper);
  bw_model *model = model_of(context, mesh);
  bw_selection *top = body_face(context, mesh, 2, 0.2), *joint = body_face(context, mesh, 2, 0.1);
  bw_selection *foot = body_face(context, mesh, 2, 0), *side[2] = {NULL, NULL}, *whole = NULL;
  bw_contact *contact = NULL;
  for (int k = 0; k < 2; k++) {
    uint8_t *mask = (uint8_t *)calloc((size_t)mesh->facet_count, 1);
    for (int32_t f = 0; f < mesh->facet_count; f++)
      mask[f] = (mesh->facet[(int64_t)f * mesh->nodes_per_facet] < first) == (k == 1);
    check_ok(context, bw_select_mask(context, mesh, mask, NULL, &side[k]));
    free(mask);
  }
  check_ok(context, bw_select_all(context, mesh, &whole));
  check_ok(context, bw_model_fix(context, model, foot));
  check_ok(context, bw_model_pressure(context, model, top, pressure));
  bw_contact_pair pair = {.on = side[0], .against = side[1]};
  check_ok(context, bw_contact_solve(context, model, 1, &pair, NULL, NULL, &contact));
  check_near(contact->state[0].force[2], pressure * 0.06, 1e-3 * pressure * 0.06);
  for (int k = 0; k < 2; k++)
    check_near(contact->state[0].force[k], 0, 1e-6 * pressure);
  check_near(contact->state[0].area, 0.06, 1e-3 * 0.06);
  bw_release(contact);
  pair.on = whole;
  check_fails(context, BW_INVALID, "is on both sides of contact pair 1",
              bw_contact_solve(context, model, 1, &pair, NULL, NULL, &contact));
  pair.on = pair.against = joint;
  check_fails(context, BW_INVALID, "no node in common",
              bw_contact_solve(context, model, 1, &pair, NULL, NULL, &contact));
  bw_release(top);
  bw_release(joint);
  bw_release(foot);
  bw_release(side[0]);
  bw_release(side[1]);
  bw_release(whole);
  bw_release(model);
  bw_release(mesh);
}

static void same_bits(void **state) {
  check_same_bits(check_context(state), 0, 1);
}

static void refused(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.2, 0.1, 3, 2, 2, 1);
  bw_mesh *other = body_box(context, 0.3, 0.2, 0.1, 3, 2, 2, 1);
  bw_model *model = model_of(context, mesh);
  bw_selection *top = body_face(context, mesh, 2, 0.1), *foot = body_face(context, mesh, 2, 0);
  bw_selection *elsewhere = body_face(context, other, 2, 0), *nodes = NULL;
  bw_rigid_surface *with = NULL;
  bw_contact *c = NULL;
  const double zero[3] = {0};
  check_ok(context, bw_select_nearest(context, mesh, zero, 2, &nodes));
  check_fails(context, BW_INVALID, "a normal", bw_rigid_plane(context, zero, zero, &with));
  check_fails(context, BW_INVALID, "radius", bw_rigid_sphere(context, zero, -1, false, &with));
  check_fails(context, BW_INVALID, "finite",
              bw_rigid_plane(context, (double[3]){NAN, 0, 0}, axis[0], &with));
  check_ok(context, bw_rigid_plane(context, zero, axis[2], &with));
  bw_contact_pair pair = {.on = elsewhere, .with = with};
  check_fails(context, BW_INVALID, "another mesh",
              bw_contact_solve(context, model, 1, &pair, NULL, NULL, &c));
  pair.on = nodes;
  check_fails(context, BW_EMPTY, "without a facet",
              bw_contact_solve(context, model, 1, &pair, NULL, NULL, &c));
  pair.on = foot; /* pushed along the plane, then off it */
  pair.against = top;
  check_fails(context, BW_INVALID, "either a rigid surface or facets",
              bw_contact_solve(context, model, 1, &pair, NULL, NULL, &c));
  pair.against = NULL;
  check_ok(context, bw_model_force(context, model, top, (double[3]){1, 0, -100}));
  check_fails(context, BW_UNCONSTRAINED, "stops the translation along (1, 0, 0).",
              bw_contact_solve(context, model, 1, &pair, NULL, NULL, &c));
  bw_model_clear_loads(model);
  check_ok(context, bw_model_force(context, model, top, (double[3]){0, 0, 100}));
  check_fails(context, BW_UNCONSTRAINED, "stops the translation along (0, 0, 1).",
              bw_contact_solve(context, model, 1, &pair, NULL, NULL, &c));
  bw_release(with); /* above the block's foot, which supports hold */
  check_ok(context, bw_rigid_plane(context, (double[3]){0, 0, 1e-3}, axis[2], &with));
  pair.with = with;
  check_ok(context, bw_model_fix(context, model, foot));
  check_fails(context, BW_INVALID, "supports constrain the body",
              bw_contact_solve(context, model, 1, &pair, NULL, NULL, &c));
  bw_release(with);
  bw_release(top);
  bw_release(foot);
  bw_release(elsewhere);
  bw_release(nodes);
  bw_release(model);
  bw_release(mesh);
  bw_release(other);
}

static void memory_failures(void **state) {
  check_memory(check_context(state), 0);
}

static void memory_failures_of_many_loads(void **state) {
  bw_context *context = check_context(state);
  block b = block_of(context, 2, 1, 1, 1);
  bw_rigid_surface *with = NULL;
  bw_contact_system *c = NULL;
  bw_system *closed = NULL;
  double *u = numbers(3 * (int64_t)b.mesh->node_count);
  uint8_t touching[6];
  check_ok(context, bw_model_fix(context, b.model, b.top));
  check_ok(context, bw_rigid_plane(context, (double[3]){0}, axis[2], &with));
  bw_contact_pair pair = {.on = b.foot, .with = with, .interference = 1e-6};
  check_ok(context, bw_set_threads(context, 1));
  check_allocations(context, c,
                    bw_contact_system_create(context, b.model, 1, &pair, NULL, NULL, &c));
  check_ok(context, bw_contact_system_create(context, b.model, 1, &pair, NULL, NULL, &c));
  assert_int_equal(c->count, 6);
  check_each_allocation(context, status, 0) {
    memset(u, 0, 3 * (size_t)b.mesh->node_count * sizeof *u);
    status = bw_contact_system_solve(context, c, 1, u, u, touching);
  }
  for (int k = 0; k < 6; k++)
    assert_int_equal(touching[k], 1);
  check_allocations(context, closed, bw_contact_system_in_state(context, c, touching, &closed));
  bw_release(c);
  bw_release(with);
  free(u);
  block_release(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(patch),
                                     check_test(hertz_sphere),
                                     check_test(hertz_cylinder),
                                     check_test(corner),
                                     check_test(stop),
                                     check_test(patch_between_parts),
                                     check_test(press_fit),
                                     check_test(press_fit_of_flat_facets),
                                     check_test(pressed_on_ball),
                                     check_test(same_bits),
                                     check_test(refused),
                                     check_test(falls),
                                     check_test(fixed_foot),
                                     check_test(facing),
                                     check_test(memory_failures),
                                     check_test(memory_failures_of_many_loads)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
