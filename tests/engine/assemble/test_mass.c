/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Mass and Laplacian: sums, moments, closed forms against quadrature. */
#include "assemble/dense.h"

typedef struct fixture {
  bw_mesh *mesh;
  bw_block_pattern *pattern;
  double *values;
} fixture;

static void open_fixture(bw_context *context, int kind, fixture *f) {
  memset(f, 0, sizeof *f);
  perturbed_box(context, 2, 3, 2, kind ? 2 : 1, 0.3, kind == 2 ? 0.2 : 0, &f->mesh);
  check_ok(context, bw_block_pattern_create(context, f->mesh, &f->pattern));
  f->values = (double *)malloc(sizeof *f->values * (size_t)f->pattern->block_count);
}

static void close_fixture(fixture *f) {
  free(f->values);
  bw_release(f->pattern);
  bw_release(f->mesh);
}

/* x^T A y with nodal fields given by functions of position */
static double form(const fixture *f, double (*x)(const double *), double (*y)(const double *)) {
  double sum = 0;
  for (int i = 0; i < f->mesh->node_count; i++)
    for (int64_t p = f->pattern->start[i]; p < f->pattern->start[i + 1]; p++) {
      int j = f->pattern->column[p];
      const double *xi = f->mesh->node + 3 * i, *xj = f->mesh->node + 3 * j;
      sum += f->values[p] * (i == j ? x(xi) * y(xi) : x(xi) * y(xj) + x(xj) * y(xi));
    }
  return sum;
}

static double one(const double *x) {
  (void)x;
  return 1;
}

static double linear(const double *x) {
  return 2 * x[0] - x[1] + 0.5 * x[2];
}

static double square(const double *x) {
  return x[0] * x[0] - 0.3 * x[1] * x[2];
}

/* Box 0.6 x 0.6 x 0.5, for the straight kinds. */
static void mass_integrates_products(void **state) {
  bw_context *context = check_context(state);
  double a = 0.6, b = 0.6, c = 0.5, volume = a * b * c;
  for (int kind = 0; kind < 3; kind++) {
    fixture f;
    open_fixture(context, kind, &f);
    check_ok(context, bw_mass(context, f.pattern, f.mesh, NULL, f.values));
    if (kind < 2) {
      check_near(form(&f, one, one), volume, 1e-15);
      check_near(form(&f, one, linear), volume * (2 * a - b + 0.5 * c) / 2, 1e-15);
      double squares =
          4 * a * a / 3 + b * b / 3 + 0.25 * c * c / 3 + 2 * (-2 * a * b + a * c - 0.5 * b * c) / 4;
      check_near(form(&f, linear, linear), volume * squares, 1e-15);
    }
    if (kind == 1)
      check_near(form(&f, one, square), volume * (a * a / 3 - 0.3 * b * c / 4), 1e-15);
    /* against quadrature */
    int per = f.mesh->nodes_per_element;
    for (int e = 0; e < f.mesh->element_count; e++) {
      double x[10][3], m[100];
      const int32_t *node = f.mesh->element + per * e;
      for (int i = 0; i < per; i++)
        memcpy(x[i], f.mesh->node + 3 * node[i], sizeof x[i]);
      bw_element_mass(f.mesh->order, (const double(*)[3])x, m);
      for (int i = 0; i < per; i++)
        for (int j = 0; j < per; j++)
          for (int64_t p = f.pattern->start[node[i]]; p < f.pattern->start[node[i] + 1]; p++)
            if (f.pattern->column[p] == node[j])
              f.values[p] -= m[per * i + j];
    }
    for (int64_t p = 0; p < f.pattern->block_count; p++)
      check_near(f.values[p], 0, 1e-17);
    close_fixture(&f);
  }
}

static void lumped_mass_is_positive_and_sums_to_the_volume(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 3; kind++) {
    fixture f;
    open_fixture(context, kind, &f);
    check_ok(context, bw_mass(context, f.pattern, f.mesh, NULL, f.values));
    double volume = form(&f, one, one), sum = 0;
    double *lumped = (double *)malloc(sizeof *lumped * (size_t)f.mesh->node_count);
    check_ok(context, bw_lumped_mass(context, f.mesh, NULL, lumped));
    for (int i = 0; i < f.mesh->node_count; i++) {
      assert_true(lumped[i] > 0);
      sum += lumped[i];
    }
    check_near(sum, volume, 1e-15);
    free(lumped);
    close_fixture(&f);
  }
}

static void one_element_is_lumped_by_its_diagonal(void **state) {
  bw_context *context = check_context(state);
  double x[10][3] = {{0, 0, 0}, {6, 0, 0}, {0, 1, 0}, {0, 0, 1}}, lumped[10];
  int32_t element[10] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  for (int m = 0; m < 6; m++)
    for (int k = 0; k < 3; k++)
      x[4 + m][k] = 0.5 * (x[bw_tet_edge[m][0]][k] + x[bw_tet_edge[m][1]][k]);
  bw_mesh *mesh = NULL;
  check_ok(context, bw_mesh_copy(context, 2, 10, x[0], 1, element, NULL, &mesh));
  check_ok(context, bw_lumped_mass(context, mesh, NULL, lumped));
  for (int a = 0; a < 10; a++)
    check_near(lumped[a], a < 4 ? 1.0 / 36 : 4.0 / 27, 1e-15);
  bw_release(mesh);
}

/* The energy of a field of the element's degree is the integral of its squared gradient. */
static void laplacian_integrates_gradients(void **state) {
  bw_context *context = check_context(state);
  double a = 0.6, b = 0.6, c = 0.5, volume = a * b * c;
  for (int kind = 0; kind < 3; kind++) {
    fixture f;
    open_fixture(context, kind, &f);
    if (kind == 2) { /* curved edges on the surface change the volume */
      check_ok(context, bw_mass(context, f.pattern, f.mesh, NULL, f.values));
      volume = form(&f, one, one);
    }
    check_ok(context, bw_laplacian(context, f.pattern, f.mesh, f.values));
    check_near(form(&f, one, linear), 0, 1e-13);
    check_near(form(&f, linear, linear), volume * (4 + 1 + 0.25), 1e-13);
    if (kind == 1)
      check_near(form(&f, square, square), volume * (4 * a * a / 3 + 0.09 * (b * b + c * c) / 3),
                 1e-14);
    close_fixture(&f);
  }
}

check_main(check_test(mass_integrates_products),
           check_test(lumped_mass_is_positive_and_sums_to_the_volume),
           check_test(one_element_is_lumped_by_its_diagonal),
           check_test(laplacian_integrates_gradients))
