/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Worst loads of few hands: the search against all pairs and triples of patches, admissible loads,
 * bounds. */
#include "pressed.h"

/* Patches counted from a pressure: loaded nodes that no former centre covers. A patch has a node as
 * its centre, so try all; enough for small bodies. */
static bool within(const pressed_body *s, const double *p, int hands, double radius, int32_t from) {
  int32_t loaded = -1;
  double normal[2][3];
  for (int32_t j = from; j < s->basis->count && loaded < 0; j++)
    if (p[j] > 1e-9)
      loaded = j;
  if (loaded < 0)
    return true;
  if (hands == 0)
    return false;
  double *rest = (double *)malloc(s->n * sizeof *rest);
  bool found = false;
  for (int32_t c = 0; c < s->basis->count && !found; c += s->basis->directions) {
    bool covers = false;
    memcpy(rest, p, s->n * sizeof *rest);
    for (int32_t j = 0; j < s->basis->count; j++) {
      const int32_t pair[2] = {c, j - j % s->basis->directions};
      const double *x = s->mesh->node + 3 * (size_t)s->basis->node[c];
      const double *y = s->mesh->node + 3 * (size_t)s->basis->node[j];
      double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      for (int i = 0; i < 2; i++) {
        memset(normal[i], 0, sizeof normal[i]);
        int64_t end = s->basis->start[pair[i] + s->basis->directions];
        for (int64_t e = s->basis->start[pair[i]]; e < end; e++)
          for (int k = 0; k < 3; k++)
            normal[i][k] += s->basis->coefficient[3 * e + k];
      }
      if (pair[1] != c &&
          (bw_norm(d) > radius || bw_dot(normal[0], normal[1]) <
                                      0.5 * bw_norm(normal[0]) * bw_norm(normal[1]) * (1 - 1e-9)))
        continue;
      covers = covers || j == loaded;
      rest[j] = 0;
    }
    found = covers && within(s, rest, hands - 1, radius, loaded);
  }
  free(rest);
  return found;
}

/* The best of all sets of patches: each by the search with a basis that has these nodes only. */
static void loads_are_admissible(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 4; kind++) {
    pressed_body s;
    pressed_open(context, &s, make_box(context, 1, 0.5, 0.25, 8, 4, 2, 1), kind == 1,
                 kind == 2 ? 0.5 : 0, 4);
    for (int hands = kind == 1 ? 1 : 2; hands <= 4; hands++) {
      bw_worst_load_options options = {.pressure = 1, .force = 0.06, .force_is_max = kind == 3};
      for (int which = 0; which < 3; which++) {
        double *f = pressed_objective(context, &s, which);
        double *p = BW_NEW(context, double, s.n), *q = BW_NEW(context, double, s.n);
        double all, few, dual[7], total = 0, value = 0;
        options.hands = 0;
        check_ok(context,
                 bw_worst_loads(context, s.basis, s.dof_map, &options, 1, f, q, &all, dual, NULL));
        options.hands = hands;
        options.hand_area = 0.06;
        check_ok(context,
                 bw_worst_loads(context, s.basis, s.dof_map, &options, 1, f, p, &few, NULL, NULL));
        assert_true(few <= all + 1e-8 * fabs(all));
        assert_true(within(&s, p, hands, sqrt(0.06 / 3.14159265358979), 0));
        double *force = BW_NEW(context, double, 3 * (size_t)s.mesh->node_count), motions[6];
        bw_pressure_force(s.basis, p, force);
        bw_rigid_modes_dot(s.dof_map, force, motions);
        for (int m = 0; m < s.dof_map->rigid_mode_count; m++)
          check_near(motions[m], 0, 1e-8);
        for (size_t j = 0; j < s.n; j++) {
          assert_true(p[j] >= 0 && p[j] <= 1);
          total += p[j] * s.basis->area[j];
          value += p[j] * f[j];
        }
        check_near(value, few, 1e-9 * fabs(few));
        if (kind < 3)
          check_near(total, 0.06, 1e-9);
        else
          assert_true(total <= 0.06 * (1 + 1e-9));
        bw_free(force);
        bw_free(f);
        bw_free(p);
        bw_free(q);
      }
    }
    pressed_close(&s);
    bw_release(s.mesh);
  }
}

/* Every set of centres by a linear program of its own: forbid the rest by an objective that pays
 * for nothing else. */
static double best_of_all(bw_context *context, const pressed_body *s,
                          const bw_worst_load_options *options, const double *f, int hands,
                          double radius) {
  int32_t n = s->basis->count, c[3] = {0, 0, 0};
  double best = -INFINITY;
  for (c[0] = 0; c[0] < n; c[0]++)
    for (c[1] = hands > 1 ? c[0] + 1 : n - 1; c[1] < n; c[1]++)
      for (c[2] = hands > 2 ? c[1] + 1 : n - 1; c[2] < n; c[2]++) {
        bw_pressure_basis part = *s->basis;
        int32_t node[512];
        double area[512], given[512], p[512], value;
        int64_t start[513] = {0};
        int32_t *row = BW_NEW(context, int32_t, s->basis->start[n]);
        double *coefficient = BW_NEW(context, double, 3 * s->basis->start[n]);
        part.node = node;
        part.area = area;
        part.start = start;
        part.row = row;
        part.coefficient = coefficient;
        part.count = 0;
        part.complete = false;
        for (int32_t j = 0; j < n; j++) {
          bool in = false;
          for (int i = 0; i < hands; i++) {
            double d[3], normal[2][3] = {{0}};
            const int32_t pair[2] = {c[i], j};
            for (int k = 0; k < 3; k++)
              d[k] = s->mesh->node[3 * s->basis->node[c[i]] + k] -
                     s->mesh->node[3 * s->basis->node[j] + k];
            for (int l = 0; l < 2; l++)
              for (int64_t e = s->basis->start[pair[l]]; e < s->basis->start[pair[l] + 1]; e++)
                for (int k = 0; k < 3; k++)
                  normal[l][k] += s->basis->coefficient[3 * e + k];
            in = in || j == c[i] ||
                 (bw_norm(d) <= radius &&
                  bw_dot(normal[0], normal[1]) >= 0.5 * bw_norm(normal[0]) * bw_norm(normal[1]));
          }
          if (!in)
            continue;
          int64_t size = s->basis->start[j + 1] - s->basis->start[j], at = start[part.count];
          node[part.count] = s->basis->node[j];
          area[part.count] = s->basis->area[j];
          given[part.count] = f[j];
          memcpy(row + at, s->basis->row + s->basis->start[j], (size_t)size * sizeof *row);
          memcpy(coefficient + 3 * at, s->basis->coefficient + 3 * s->basis->start[j],
                 3 * (size_t)size * sizeof *coefficient);
          start[++part.count] = at + size;
        }
        bw_status status =
            bw_worst_loads(context, &part, s->dof_map, options, 1, given, p, &value, NULL, NULL);
        if (status == BW_OK)
          best = fmax(best, value);
        else
          assert_int_equal(status, BW_INFEASIBLE);
        bw_free(row);
        bw_free(coefficient);
      }
  return best;
}

/* The search is a heuristic: here it is measured. */
static void reaches_the_best_of_all_sets(void **state) {
  bw_context *context = check_context(state);
  double sum = 0, min = 1;
  int count = 0;
  bool full = getenv("BARWRIGHT_FULL") != NULL;
  for (int kind = 0; kind < 2; kind++) {
    pressed_body s;
    pressed_open(context, &s, make_box(context, 1, 0.4, 0.3, full ? 6 : 4, 2, full ? 2 : 1, 1),
                 kind == 1, 0, 4);
    assert_true(s.n <= 512);
    for (int hands = kind == 1 ? 1 : 2; hands <= (full ? 3 : 2); hands++)
      for (int which = 0; which < (full ? 6 : 3); which++) {
        bw_worst_load_options options = {.pressure = 1, .force = 0.08};
        double *f = pressed_objective(context, &s, which), *p = BW_NEW(context, double, s.n), value;
        double best = best_of_all(context, &s, &options, f, hands, sqrt(0.15 / 3.14159265358979));
        options.hands = hands;
        options.hand_area = 0.15;
        check_ok(context, bw_worst_loads(context, s.basis, s.dof_map, &options, 1, f, p, &value,
                                         NULL, NULL));
        assert_true(value <= best * (1 + 1e-7));
        if (full)
          printf("  fixed %d, %d hands, objective %d: %.4f of the best\n", kind, hands, which,
                 value / best);
        sum += value / best;
        min = fmin(min, value / best);
        count++;
        bw_free(f);
        bw_free(p);
      }
    pressed_close(&s);
    bw_release(s.mesh);
  }
  assert_true(sum / count > 0.95);
  assert_true(min > 0.7);
}

static void impossible_hands_are_refused(void **state) {
  bw_context *context = check_context(state);
  pressed_body s;
  pressed_open(context, &s, make_box(context, 1, 0.5, 0.25, 4, 2, 1, 1), false, 0, 4);
  double *f = pressed_objective(context, &s, 0), *p = BW_NEW(context, double, s.n), value;
  bw_worst_load_options options = {.pressure = 1, .force = 0.06, .hands = 1, .hand_area = 0.1};
  /* One hand pushes a free body away. */
  assert_int_equal(
      bw_worst_loads(context, s.basis, s.dof_map, &options, 1, f, p, &value, NULL, NULL),
      BW_INFEASIBLE);
  options.force_is_max = true;
  check_ok(context,
           bw_worst_loads(context, s.basis, s.dof_map, &options, 1, f, p, &value, NULL, NULL));
  check_near(value, 0, 1e-9);
  options = (bw_worst_load_options){.pressure = 1, .force = 1, .hands = 2, .hand_area = 0.01};
  assert_int_equal(
      bw_worst_loads(context, s.basis, s.dof_map, &options, 1, f, p, &value, NULL, NULL),
      BW_INFEASIBLE);
  options.hands = BW_MAX_HANDS + 1;
  assert_int_equal(
      bw_worst_loads(context, s.basis, s.dof_map, &options, 1, f, p, &value, NULL, NULL),
      BW_INVALID);
  options.hands = 2;
  options.hand_area = 0;
  assert_int_equal(
      bw_worst_loads(context, s.basis, s.dof_map, &options, 1, f, p, &value, NULL, NULL),
      BW_INVALID);
  bw_free(f);
  bw_free(p);
  pressed_close(&s);
  bw_release(s.mesh);
}

static void allocation_failures(void **state) {
  bw_context *context = check_context(state);
  pressed_body s;
  pressed_open(context, &s, make_box(context, 1, 1, 1, 1, 1, 1, 1), true, 0, 4);
  check_ok(context, bw_set_threads(context, 1));
  bw_worst_load_options options = {.pressure = 1, .force = 0.1, .hands = 2, .hand_area = 0.5};
  check_each_allocation(context, status, 20) {
    double f[8], p[8], value;
    for (int j = 0; j < 8; j++)
      f[j] = j % 3;
    status = bw_worst_loads(context, s.basis, s.dof_map, &options, 1, f, p, &value, NULL, NULL);
  }
  pressed_close(&s);
  bw_release(s.mesh);
}

check_main(check_test(loads_are_admissible), check_test(reaches_the_best_of_all_sets),
           check_test(impossible_hands_are_refused), check_test(allocation_failures))
