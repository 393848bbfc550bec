/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Whole solids of every law against closed forms: pulled with free sides, sheared, pressed from all
 * sides by a pressure that follows. */
#include "nonlinear/whole.h"

static const double young = 1, poisson = 0.3;
static const double mu = 1 / 2.6, lambda = 0.3 / (1.3 * 0.4);

/* Principal stress (first Piola-Kirchhoff) s[0] of a law at principal stretches. */
static double principal(bw_law law, const double s[3]) {
  double j = s[0] * s[1] * s[2], sum = s[0] + s[1] + s[2] - 3;
  double green = (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - 3) / 2;
  switch (law) {
  case BW_NEO_HOOKEAN:
    return mu * (s[0] - 1 / s[0]) + lambda * log(j) / s[0];
  case BW_ST_VENANT_KIRCHHOFF:
    return s[0] * (mu * (s[0] * s[0] - 1) + lambda * green);
  case BW_COROTATED:
    return 2 * mu * (s[0] - 1) + lambda * sum;
  default:
    return 2 * mu * (s[0] - 1) + lambda * (j - 1) * s[1] * s[2];
  }
}

/* The lateral stretch that leaves the sides free. */
static double lateral(bw_law law, double stretch) {
  double low = 0.3, high = 2;
  for (int k = 0; k < 200; k++) {
    double t = (low + high) / 2, s[3] = {t, t, stretch};
    *(principal(law, s) > 0 ? &high : &low) = t;
  }
  return low;
}

/* Sides slide on the planes x = 0, y = 0, z = 0; the top is moved. */
static void test_uniaxial(void **state) {
  bw_context *context = check_context(state);
  /* stretches, with P / E of the neo-Hookean solid as published with the reference values */
  static const double stretch[4] = {0.7, 0.9, 1.5, 2},
                      neo[4] = {-0.4052304242943268, -0.10872218513629549, 0.3782801763943185,
                                0.646744660173608},
                      neo_side[4] = {1.1079347328, 1.0317024344, 0.8801745918, 0.7980775445};
  for (int law = 0; law < BW_LAWS; law++)
    for (int k = 0; k < 4; k++) {
      double s = stretch[k], t = lateral((bw_law)law, s), at[3] = {s, t, t}, sum[3];
      double nominal = principal((bw_law)law, at);
      if (law == BW_NEO_HOOKEAN) {
        check_near(t, neo_side[k], 1e-9);
        check_near(nominal, neo[k], 1e-9);
      } else if (law == BW_ST_VENANT_KIRCHHOFF)
        check_near(nominal, young * s * (s * s - 1) / 2, 1e-12);
      else if (law == BW_COROTATED)
        check_near(nominal, young * (s - 1), 1e-12);
      body b = body_box(context, 2, 2, 3, 0.5, 0.4, 1.2, (bw_law)law, young, poisson, 0);
      bw_load_case *load_case;
      check_ok(context, bw_load_case_create(context, b.grid, &load_case));
      hold_side(context, load_case, 0, 0, 1, 0, 0, 0);
      hold_side(context, load_case, 1, 0, 2, 0, 0, 0);
      hold_side(context, load_case, 2, 0, 4, 0, 0, 0);
      hold_side(context, load_case, 2, 1.2, 4, 0, 0, 1.2 * (s - 1));
      bw_solid_static *result = solve(context, &b, load_case, 4);
      side_reaction(context, result, 2, 1.2, sum);
      const double *corner = result->displacement + 3 * (int64_t)node_near(b.grid, 0.5, 0.4, 0.6);
      double value = sum[2] / (0.5 * 0.4);
      printf(
          "VERIFY | %s pulled by %g, sides free | nominal stress over E | %.10g | %.10g | 1e-8 | "
          "closed form\n",
          bw_law_word((bw_law)law), s, nominal, value);
      check_near(value, nominal, 1e-8);
      check_near(corner[0], 0.5 * (t - 1), 1e-8);
      check_near(corner[1], 0.4 * (t - 1), 1e-8);
      bw_release(result);
      bw_release(load_case);
      body_release(&b);
    }
}

/* F = 1 + gamma e_x (x) e_y given at the boundary: Cauchy stress. */
static void test_shear(void **state) {
  bw_context *context = check_context(state);
  for (int law = 0; law < BW_LAWS; law++)
    for (int k = 0; k < 2; k++) {
      double gamma = k ? 0.5 : 0.1;
      body b = body_box(context, 3, 3, 3, 1, 1, 1, (bw_law)law, young, poisson, 0);
      bw_load_case *load_case;
      check_ok(context, bw_load_case_create(context, b.grid, &load_case));
      for (int32_t i = 0; i < b.nodes; i++) {
        double x[3];
        const bool fixed[3] = {true, true, true};
        bw_grid_position(b.grid, i, x);
        bool inside = true;
        for (int d = 0; d < 3; d++)
          inside = inside && x[d] > 1e-9 && x[d] < 1 - 1e-9;
        if (!inside)
          check_ok(context, bw_load_case_fix(context, load_case, 1, &i, fixed,
                                             (const double[3]){gamma * x[1], 0, 0}));
      }
      bw_solid_static *result = solve(context, &b, load_case, 1);
      double *cauchy = BW_NEW(context, double, 6 * b.grid->element_count);
      check_ok(context, bw_solid_stress(context, b.solid, result->displacement, cauchy, NULL));
      /* F = R S with the rotation by theta, tan theta = gamma / 2; S = R^T F; stretches in the
         plane have the sum 2 / cos theta and the product 1. */
      double theta = atan(gamma / 2), c = cos(theta), s = sin(theta);
      double r[4] = {c, s, -s, c}, p[4], sigma[3];                /* in the plane, row by row */
      double e[4] = {0, gamma / 2, gamma / 2, gamma * gamma / 2}; /* Green's strain */
      switch ((bw_law)law) {
      case BW_NEO_HOOKEAN: /* sigma = mu (b - 1), as published with the reference values */
        sigma[0] = mu * gamma * gamma, sigma[1] = 0, sigma[2] = mu * gamma;
        break;
      case BW_ST_VENANT_KIRCHHOFF: { /* P = F S, S = 2 mu E + lambda tr E */
        double trace = lambda * (e[0] + e[3]);
        double second[4] = {2 * mu * e[0] + trace, 2 * mu * e[1], 2 * mu * e[2],
                            2 * mu * e[3] + trace};
        p[0] = second[0] + gamma * second[2], p[1] = second[1] + gamma * second[3];
        p[2] = second[2], p[3] = second[3];
        sigma[0] = p[0] + gamma * p[1], sigma[1] = p[3], sigma[2] = p[1];
        break;
      }
      default: { /* P = 2 mu (F - R) + lambda (tr S - 3) R; fixed: J = 1 leaves no second term */
        double f[4] = {1, gamma, 0, 1};
        double volume = law == BW_COROTATED ? lambda * (2 / c - 2) : 0;
        for (int i = 0; i < 4; i++)
          p[i] = 2 * mu * (f[i] - r[i]) + volume * r[i];
        sigma[0] = p[0] + gamma * p[1], sigma[1] = p[3], sigma[2] = p[1];
      }
      }
      for (int32_t el = 0; el < b.grid->element_count; el++) {
        check_near(cauchy[6 * el], sigma[0], 1e-9);
        check_near(cauchy[6 * el + 1], sigma[1], 1e-9);
        check_near(cauchy[6 * el + 5], sigma[2], 1e-9);
        check_near(cauchy[6 * el + 3], 0, 1e-9);
      }
      printf(
          "VERIFY | %s sheared by %g | shear stress over E | %.10g | %.10g | 1e-9 | closed form\n",
          bw_law_word((bw_law)law), gamma, sigma[2], cauchy[5]);
      bw_free(cauchy);
      bw_release(result);
      bw_release(load_case);
      body_release(&b);
    }
}

/* Corners and middle of every boundary face, five points each: four triangles around the middle
 * share a pressure among the corners alike, as the faces' bilinear functions do. */
static void boundary_of(bw_context *context, const bw_grid *grid, bw_embedding **embedding) {
  bw_grid_face *face;
  int64_t faces;
  check_ok(context, bw_grid_boundary(context, grid, &face, &faces));
  double *point = BW_NEW0(context, double, 15 * faces);
  for (int64_t f = 0; f < faces; f++)
    for (int c = 0; c < 4; c++) {
      bw_grid_position(grid, face[f].node[c], point + 15 * f + 3 * c);
      for (int d = 0; d < 3; d++)
        point[15 * f + 12 + d] += 0.25 * point[15 * f + 3 * c + d];
    }
  check_ok(context, bw_embedding_create(context, grid, 5 * faces, point, 0.1, embedding));
  bw_free(point);
  bw_free(face);
}

/* All sides of a block under the same pressure, along the normals of the deformed shape: it shrinks
 * alike in all directions, to where the Cauchy stress is -p. */
static void test_pressed(void **state) {
  bw_context *context = check_context(state);
  for (int law = 0; law < BW_LAWS; law++)
    for (int k = 0; k < 2; k++) {
      double pressure = k ? 0.25 : -0.1; /* of E */
      double low = 0.6, high = 1.3;
      for (int i = 0; i < 200; i++) {
        double s = (low + high) / 2, all[3] = {s, s, s};
        *(principal((bw_law)law, all) / (s * s) > -pressure ? &high : &low) = s;
      }
      body b = body_box(context, 2, 3, 2, 1, 1.5, 1, (bw_law)law, young, poisson, 0);
      bw_embedding *embedding;
      bw_load_case *load_case;
      boundary_of(context, b.grid, &embedding);
      int64_t triangles = embedding->point_count / 5 * 4;
      int32_t *triangle = BW_NEW(context, int32_t, 3 * triangles);
      double *all = BW_NEW(context, double, triangles);
      for (int64_t t = 0; t < triangles; t++) {
        all[t] = pressure;
        triangle[3 * t] = (int32_t)(t / 4 * 5 + t % 4);
        triangle[3 * t + 1] = (int32_t)(t / 4 * 5 + (t + 1) % 4);
        triangle[3 * t + 2] = (int32_t)(t / 4 * 5 + 4);
      }
      check_ok(context, bw_load_case_create(context, b.grid, &load_case));
      check_ok(context, bw_load_case_pressure(context, load_case, embedding, triangles, triangle,
                                              all, true));
      hold_side(context, load_case, 0, 0, 1, 0, 0, 0);
      hold_side(context, load_case, 1, 0, 2, 0, 0, 0);
      hold_side(context, load_case, 2, 0, 4, 0, 0, 0);
      bw_solid_static *result = solve(context, &b, load_case, 1);
      double worst = 0;
      for (int32_t i = 0; i < b.nodes; i++) {
        double x[3];
        bw_grid_position(b.grid, i, x);
        for (int d = 0; d < 3; d++)
          worst = fmax(worst, fabs(result->displacement[3 * i + d] - (low - 1) * x[d]));
      }
      printf("VERIFY | %s under pressure %g E from all sides | stretch | %.10g | %.10g | 1e-8 | "
             "closed form\n",
             bw_law_word((bw_law)law), pressure, low, 1 + result->displacement[3 * (b.nodes - 1)]);
      check_near(worst, 0, 1e-8);
      bw_free(all);
      bw_free(triangle);
      bw_release(embedding);
      bw_release(result);
      bw_release(load_case);
      body_release(&b);
    }
}

check_main(check_test(test_uniaxial), check_test(test_shear), check_test(test_pressed))
