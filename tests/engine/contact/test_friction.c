/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Contact with Coulomb's friction against closed forms and its own law, and what it says where
 * there is no equilibrium. */
#include "parts.h"

static bw_contact *solved(bw_context *context, const bw_model *model, const bw_contact_pair *pair,
                          int steps, const bw_contact *after) {
  bw_contact *contact = NULL;
  bw_contact_options options;
  bw_contact_options_default(&options);
  options.steps = steps;
  options.after = after;
  check_ok(context, bw_contact_solve(context, model, 1, pair, NULL, &options, &contact));
  return contact;
}

static bw_rigid_surface *floor_at(bw_context *context, double z) {
  bw_rigid_surface *floor = NULL;
  check_ok(context, bw_rigid_plane(context, (double[3]){0, 0, z}, axis[2], &floor));
  return floor;
}

static void move(bw_context *context, bw_model *model, const bw_selection *on, double x, double z) {
  const bool all[3] = {true, true, true};
  bw_model_clear_supports(model);
  check_ok(context, bw_model_prescribe(context, model, on, all, (double[3]){x, 0, z}));
}

/* Coulomb's law at the corners: |t| <= mu p; what slips is on the cone and slips against t. */
static void check_law(const bw_contact *contact, double mu) {
  double largest = contact->state[0].pressure;
  for (int32_t i = 0; i < contact->model->mesh->node_count; i++) {
    const double *t = contact->traction + 3 * (int64_t)i, *s = contact->slip + 3 * (int64_t)i;
    assert_true(bw_norm(t) <= mu * contact->pressure[i] + 1e-9 * mu * largest);
    if (contact->status[i] == BW_CONTACT_OPEN)
      continue;
    if (contact->status[i] == BW_CONTACT_STICKS) {
      if (contact->steps == 1)
        check_near(bw_norm(s), 0, 1e-12);
      continue;
    }
    check_near(bw_norm(t), mu * contact->pressure[i], 1e-7 * mu * largest);
    if (contact->steps == 1)
      check_near(bw_dot(s, t), -bw_norm(s) * bw_norm(t), 1e-6 * bw_norm(s) * mu * largest);
  }
}

/* A free block on an incline: it sticks where tan(angle) < mu, and slides else. */
static void incline(void **state) {
  bw_context *context = check_context(state);
  const double mu = 0.3, angles[] = {0, 0.1, 0.28, 0.29, 0.3, 0.5};
  block b = block_of(context, 6, 4, 2, 2);
  bw_rigid_surface *floor = floor_at(context, 0);
  const double weight = 9.81 * b.model->material->density * 0.006;
  for (int i = 0; i < 6; i++) {
    double c = cos(angles[i]), s = sin(angles[i]);
    bw_contact_pair pair = {.on = b.foot, .with = floor, .friction = mu};
    bw_contact *contact = NULL;
    bw_model_clear_loads(b.model);
    check_ok(context, bw_model_gravity(context, b.model, (double[3]){9.81 * s, 0, -9.81 * c}));
    if (s > mu * c) {
      check_fails(context, BW_UNCONSTRAINED, "nothing stops the translation along (1, 0, 0)",
                  bw_contact_solve(context, b.model, 1, &pair, NULL, NULL, &contact));
      continue;
    }
    contact = solved(context, b.model, &pair, 1, NULL);
    check_near(contact->state[0].friction[0], -weight * s, 1e-5 * weight);
    check_near(contact->state[0].force[2], weight * c, 1e-5 * weight);
    assert_int_equal(contact->free_count, 0);
    check_law(contact, mu);
    bw_release(contact);
  }
  bw_release(floor);
  block_release(&b);
}

/* A patch: one pressure p and one shear 0.29 p, without lateral strain, on a foot of friction 0.3.
 * It sticks, and is as the bonded one: u = (gamma z, 0, epsilon z). */
static void bonded(void **state) {
  bw_context *context = check_context(state);
  const double p = 1e7, shear = 0.29 * p, lateral = p * poisson / (1 - poisson);
  const double gamma = shear * 2 * (1 + poisson) / young;
  const double epsilon = -p * (1 + poisson) * (1 - 2 * poisson) / (1 - poisson) / young;
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = body_box(context, 0.3, 0.2, 0.1, 5, 4, 3, order);
    bw_model *model = model_of(context, mesh);
    bw_rigid_surface *floor = floor_at(context, 0);
    bw_selection *foot = body_face(context, mesh, 2, 0);
    const double size[3] = {0.3, 0.2, 0.1};
    const double traction[3][3] = {{-lateral, 0, shear}, {0, -lateral, 0}, {shear, 0, -p}};
    for (int k = 0; k < 3; k++)
      for (int far = k == 2; far < 2; far++) {
        bw_selection *face = body_face(context, mesh, k, far ? size[k] : 0);
        double t[3];
        for (int l = 0; l < 3; l++)
          t[l] = (far ? 1 : -1) * traction[k][l];
        check_ok(context, bw_model_traction(context, model, face, t));
        bw_release(face);
      }
    bw_contact_pair pair = {.on = foot, .with = floor, .friction = 0.3};
    bw_contact *contact = solved(context, model, &pair, 1, NULL);
    check_near(contact->state[0].stick_area, 0.06, 1e-9);
    assert_true(contact->state[0].work == 0 && contact->free_count == 0);
    for (int32_t i = 0; i < foot->node_count; i++) {
      const double *t = contact->traction + 3 * (int64_t)foot->node[i];
      check_near(contact->pressure[foot->node[i]], p, 1e-6 * p);
      check_near(t[0], -shear, 1e-6 * p);
      check_near(t[1], 0, 1e-6 * p);
    }
    for (int32_t i = 0; i < mesh->node_count; i++) {
      const double *u = contact->solution->displacement + 3 * (int64_t)i;
      double z = mesh->node[3 * (int64_t)i + 2];
      check_near(u[0], gamma * z, 1e-6 * gamma * 0.1);
      check_near(u[1], 0, 1e-6 * gamma * 0.1);
      check_near(u[2], epsilon * z, 1e-6 * gamma * 0.1);
    }
    bw_release(contact);
    bw_release(floor);
    bw_release(foot);
    bw_release(model);
    bw_release(mesh);
  }
}

/* A block pressed and then pulled by its top: the friction never passes mu N, and reaches it when
 * all slips. Its work is then mu N times the slip. Pushed back, it turns. */
static void pulled(void **state) {
  bw_context *context = check_context(state);
  const double mu = 0.4, pull[] = {0, 1e-7, 1e-5, 1e-3, -1e-3};
  for (int order = 1; order <= 2; order++) {
    block b = block_of(context, 5, 4, 2, order);
    bw_rigid_surface *floor = floor_at(context, 0);
    bw_contact_pair pair = {.on = b.foot, .with = floor, .friction = mu};
    bw_contact *before = NULL;
    for (int i = 0; i < 5; i++) {
      move(context, b.model, b.top, pull[i], -1e-5);
      bw_contact *contact = solved(context, b.model, &pair, 1, before);
      const bw_contact_state *s = contact->state;
      check_law(contact, mu);
      assert_int_equal(contact->steps, i + 1);
      assert_true(bw_norm(s->friction) <= mu * s->force[2] * (1 + 1e-12));
      if (i >= 3) {
        double moved = pull[i] - pull[i - 1], sense = moved > 0 ? 1 : -1;
        check_near(s->friction[0], -sense * mu * s->force[2], 1e-3 * mu * s->force[2]);
        check_near(s->work - before->state->work, fabs(s->friction[0] * moved),
                   0.02 * fabs(s->friction[0] * moved));
        assert_true(s->stick_area == 0);
      }
      assert_true(s->work >= (before ? before->state->work : 0));
      if (before)
        bw_release(before);
      before = contact;
    }
    bw_release(before);
    bw_release(floor);
    block_release(&b);
  }
}

/* A block slides down an incline to a wall, which takes what friction leaves. */
static void wall(void **state) {
  bw_context *context = check_context(state);
  const double mu = 0.3, angle = 0.6, gap = 1e-4;
  bw_mesh *mesh = body_box(context, 0.3, 0.2, 0.1, 6, 4, 2, 2);
  bw_model *model = model_of(context, mesh);
  bw_selection *foot = body_face(context, mesh, 2, 0), *front = body_face(context, mesh, 0, 0.3);
  bw_rigid_surface *floor = floor_at(context, 0), *stop = NULL;
  const double weight = 9.81 * model->material->density * 0.006;
  check_ok(context,
           bw_rigid_plane(context, (double[3]){0.3 + gap, 0, 0}, (double[3]){-1, 0, 0}, &stop));
  check_ok(context,
           bw_model_gravity(context, model, (double[3]){9.81 * sin(angle), 0, -9.81 * cos(angle)}));
  bw_contact_pair pair[2] = {{.on = foot, .with = floor, .friction = mu},
                             {.on = front, .with = stop}};
  bw_contact *contact = NULL;
  check_ok(context, bw_contact_solve(context, model, 2, pair, NULL, NULL, &contact));
  check_near(contact->state[1].force[0], -weight * (sin(angle) - mu * cos(angle)), 1e-3 * weight);
  check_near(contact->state[0].work, weight * mu * cos(angle) * gap, 1e-3 * weight * gap);
  check_near(contact->state[0].slip, gap, 1e-2 * gap);
  bw_release(contact);
  bw_release(floor);
  bw_release(stop);
  bw_release(foot);
  bw_release(front);
  bw_release(model);
  bw_release(mesh);
}

/* Two half-planes in plane strain, the upper one with a parabola of radius R in the middle: cells
 * of one size to `fine` on both sides of x = 0, larger ones to `size`. */
typedef struct half {
  double size, fine, radius, width;
  bool upper;
} half;

static void half_plane(void *data, const double unit[3], double out[3]) {
  const half *h = data;
  double s = 2 * unit[0] - 1, share = 0.7, side = s < 0 ? -1 : 1, t = fabs(s);
  double deep = h->upper ? unit[2] : 1 - unit[2];
  out[0] = side * (t <= share
                       ? h->fine * t / share
                       : h->fine + (h->size - h->fine) *
                                       (exp(4.5 * (t - share) / (1 - share)) - 1) / (exp(4.5) - 1));
  out[1] = h->width * unit[1];
  out[2] = (h->upper ? 1 : -1) * h->size * (exp(5.5 * deep) - 1) / (exp(5.5) - 1);
  if (h->upper)
    out[2] += (1 - deep) * pow(fmin(fabs(out[0]), 2 * h->fine), 2) / (2 * h->radius);
}

/* Cattaneo and Mindlin in the plane (Johnson 1985, section 7.2): pressed, then sheared, the middle
 * |x| < c sticks, c / a = sqrt(1 - Q / (mu P)). */
static void cattaneo(void **state) {
  bw_context *context = check_context(state);
  const double mu = 0.5, a = 1e-3, radius = 0.05;
  half how = {.size = 25 * a, .fine = 1.25 * a, .radius = radius, .width = 0.1 * a};
  const int cells[3] = {56, 1, 20};
  bw_mesh *part[2] = {NULL, NULL};
  for (int k = 0; k < 2; k++) {
    how.upper = k == 1;
    check_ok(context, bw_mesh_mapped_box(context, cells, 2, half_plane, &how, &part[k]));
  }
  int32_t first = part[0]->node_count;
  bw_mesh *mesh = both(context, part[0], part[1]);
  bw_model *model = model_of(context, mesh);
  bw_selection *side[2] = {NULL, NULL}, *foot = body_face(context, mesh, 2, -how.size),
               *top = body_face(context, mesh, 2, how.size);
  for (int k = 0; k < 2; k++) { /* the top of the lower part, the bottom of the upper one */
    uint8_t *mask = (uint8_t *)calloc((size_t)mesh->facet_count, 1);
    for (int32_t f = 0; f < mesh->facet_count; f++) {
      mask[f] = 1;
      for (int i = 0; i < 3; i++) {
        int32_t node = mesh->facet[(int64_t)f * mesh->nodes_per_facet + i];
        const double *x = mesh->node + 3 * (int64_t)node;
        double z = k ? x[0] * x[0] / (2 * radius) : 0;
        mask[f] =
            mask[f] && (node >= first) == (k == 1) && fabs(x[2] - z) < 1e-9 && fabs(x[0]) < 1.3 * a;
      }
    }
    check_ok(context, bw_select_mask(context, mesh, mask, NULL, &side[k]));
    free(mask);
  }
  bw_contact_pair pair = {.on = side[1], .against = side[0], .friction = mu};
  bw_contact *pressed = NULL;
  double half_width = 0;
  for (int k = 0; k < 3; k++) {
    move(context, model, top, k * 1.2e-5, -3.6e-5);
    check_ok(context, bw_model_fix(context, model, foot));
    slide(context, model, 1, 0);
    slide(context, model, 1, how.width);
    bw_contact *contact = solved(context, model, &pair, 1, pressed);
    const bw_contact_state *s = contact->state;
    double p = s->force[2] / how.width, q = fabs(s->friction[0]) / how.width;
    half_width = sqrt(4 * p * radius * 2 * (1 - poisson * poisson) / (M_PI * young));
    check_law(contact, mu);
    check_near(s->area / how.width / 2, half_width, 0.03 * half_width);
    check_near(s->stick_area / how.width / 2, half_width * sqrt(1 - q / (mu * p)),
               0.04 * half_width);
    if (k > 0)
      assert_true(q > 0.2 * mu * p && q < 0.9 * mu * p);
    if (k == 0)
      pressed = bw_retain(contact);
    bw_release(contact);
  }
  bw_release(pressed);
  bw_release(side[0]);
  bw_release(side[1]);
  bw_release(foot);
  bw_release(top);
  bw_release(model);
  bw_release(mesh);
}

/* Blocks on surfaces of any coefficient up to 1, pressed and sheared at random: the law holds, and
 * with more steps too. */
static void law(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 7);
  for (int n = 0; n < 24; n++) {
    double mu = pow(10, -1.5 * bw_random_uniform(&random));
    block b = block_of(context, 4 + n % 4, 3 + n % 3, 2, 1 + n % 2);
    bw_rigid_surface *with = NULL;
    const double centre[3] = {0.1 + 0.1 * bw_random_uniform(&random), 0.1, -30};
    const double along[3] = {bw_random_uniform(&random), bw_random_uniform(&random), 0};
    if (n % 3 == 0)
      check_ok(context, bw_rigid_sphere(context, centre, 30, false, &with));
    else if (n % 3 == 1)
      check_ok(context, bw_rigid_cylinder(context, centre, along, 30, false, &with));
    else
      with = floor_at(context, 0);
    move(context, b.model, b.top, 1e-4 * (2 * bw_random_uniform(&random) - 1),
         -1e-4 * (0.2 + bw_random_uniform(&random)));
    bw_contact_pair pair = {.on = b.foot, .with = with, .friction = mu};
    for (int steps = 1; steps <= 4; steps += 3) {
      bw_contact *contact = solved(context, b.model, &pair, steps, NULL);
      check_law(contact, mu);
      assert_true(contact->state[0].active > 0 && contact->state[0].work >= 0);
      bw_release(contact);
    }
    bw_release(with);
    block_release(&b);
  }
}

static void same_bits(void **state) {
  check_same_bits(check_context(state), 0.3, 2);
}

static void refused(void **state) {
  bw_context *context = check_context(state);
  bw_mesh *mesh = body_box(context, 0.3, 0.2, 0.1, 3, 2, 2, 1);
  bw_mesh *other = body_box(context, 0.3, 0.2, 0.1, 3, 2, 2, 1);
  bw_model *model = model_of(context, mesh), *second = model_of(context, other);
  bw_selection *top = body_face(context, mesh, 2, 0.1), *foot = body_face(context, mesh, 2, 0);
  bw_selection *same = body_face(context, mesh, 2, 0), *elsewhere = body_face(context, other, 2, 0);
  bw_rigid_surface *floor = floor_at(context, 0);
  bw_contact *c = NULL;
  bw_contact_options options;
  bw_contact_options_default(&options);
  check_ok(context, bw_model_traction(context, model, top, (double[3]){1e4, 0, -1e6}));
  bw_contact_pair pair = {.on = foot, .with = floor, .friction = -0.1};
  check_fails(context, BW_INVALID, "coefficient of friction -0.1",
              bw_contact_solve(context, model, 1, &pair, NULL, NULL, &c));
  pair.friction = 0.2;
  options.steps = 0;
  check_fails(context, BW_INVALID, "0 steps",
              bw_contact_solve(context, model, 1, &pair, NULL, &options, &c));
  bw_contact *contact = solved(context, model, &pair, 1, NULL);
  options.steps = 1;
  options.after = contact;
  bw_contact_pair wrong = pair;
  wrong.on = same;
  check_fails(context, BW_INVALID, "same selections",
              bw_contact_solve(context, model, 1, &wrong, NULL, &options, &c));
  wrong = pair;
  wrong.friction = 0;
  check_fails(context, BW_INVALID, "both have friction",
              bw_contact_solve(context, model, 1, &wrong, NULL, &options, &c));
  wrong.on = elsewhere;
  check_fails(context, BW_INVALID, "needs its mesh",
              bw_contact_solve(context, second, 1, &wrong, NULL, &options, &c));
  bw_release(contact);
  bw_release(floor);
  bw_release(top);
  bw_release(foot);
  bw_release(same);
  bw_release(elsewhere);
  bw_release(model);
  bw_release(second);
  bw_release(mesh);
  bw_release(other);
}

static void memory_failures(void **state) {
  check_memory(check_context(state), 0.5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(incline),   check_test(bonded),   check_test(pulled),
      check_test(wall),      check_test(cattaneo), check_test(law),
      check_test(same_bits), check_test(refused),  check_test(memory_failures)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
