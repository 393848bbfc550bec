/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The paper's formulas against quadrature, and derivatives by a subdomain's map. */
#include "assemble/subdomain_bar.h"

/* Elasticity tensor of a material. */
static double tensor_of(const bw_material *material, int i, int j, int k, int l) {
  static const int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
  return material->elasticity[6 * voigt[i][j] + voigt[k][l]];
}

/* alpha of eq. A.7 with the factor 1 / V that the printed one lacks (eq. 15 has it); l[k] = (b_k,
 * c_k, d_k) of eq. 11. */
static double paper_alpha(int i, int j, int first, int second, const double l[4][3],
                          double volume) {
#define S(u, v) ((u) == (v) ? 1.0 / 10 : 1.0 / 20)
  int m = i < 4 ? i : bw_tet_edge[i - 4][0], n = i < 4 ? i : bw_tet_edge[i - 4][1];
  int p = j < 4 ? j : bw_tet_edge[j - 4][0], q = j < 4 ? j : bw_tet_edge[j - 4][1];
  double sum;
  if (i < 4 && j < 4)
    sum = (4.0 / 9 * S(i, j) - 1.0 / 36) * l[i][first] * l[j][second];
  else if (i >= 4 && j >= 4)
    sum = 4.0 / 9 *
          (S(n, q) * l[m][first] * l[p][second] + S(m, q) * l[n][first] * l[p][second] +
           S(n, p) * l[m][first] * l[q][second] + S(m, p) * l[n][first] * l[q][second]);
  else if (i < 4)
    sum = (4.0 / 9 * S(i, q) - 1.0 / 36) * l[i][first] * l[p][second] +
          (4.0 / 9 * S(i, p) - 1.0 / 36) * l[i][first] * l[q][second];
  else
    sum = (4.0 / 9 * S(n, j) - 1.0 / 36) * l[m][first] * l[j][second] +
          (4.0 / 9 * S(m, j) - 1.0 / 36) * l[n][first] * l[j][second];
#undef S
  return sum / volume;
}

/* m of eq. A.8. */
static double paper_variable(int first, int second, const double s[3]) {
  return s[0] * s[1] * s[2] / (s[first] * s[second]);
}

/* Each entry of a scaled tetrahedron by A.7 and A.8 and by this engine's coefficients, against
 * quadrature on the scaled tetrahedron; isotropic and orthotropic. */
static void paper_formulas_against_quadrature(void **state) {
  bw_context *context = check_context(state);
  bw_material *material[2] = {plain_material(context, 2e9, 0.3), odd_material(context)};
  bw_random random;
  bw_random_seed(&random, 11);
  for (int trial = 0; trial < 50; trial++) {
    double x[10][3], scaled[10][3], l[4][3], inverse[9], edge[9], k[900];
    double s[3];
    do {
      for (int a = 0; a < 4; a++)
        for (int c = 0; c < 3; c++)
          x[a][c] = uniform(&random, -1, 1);
      for (int a = 1; a < 4; a++)
        for (int c = 0; c < 3; c++)
          edge[3 * (a - 1) + c] = x[a][c] - x[0][c];
    } while (bw_inverse3(edge, inverse) < 0.3);
    double volume = bw_inverse3(edge, inverse) / 6;
    for (int m = 0; m < 6; m++)
      for (int c = 0; c < 3; c++)
        x[4 + m][c] = 0.5 * (x[bw_tet_edge[m][0]][c] + x[bw_tet_edge[m][1]][c]);
    for (int c = 0; c < 3; c++)
      s[c] = uniform(&random, 0.3, 3);
    for (int a = 0; a < 10; a++)
      for (int c = 0; c < 3; c++)
        scaled[a][c] = s[c] * x[a][c];
    for (int c = 0; c < 3; c++) { /* eq. 11: L_k = (a_k + b_k x + c_k y + d_k z) / 6V */
      l[0][c] = 0;
      for (int a = 1; a < 4; a++) {
        l[a][c] = 6 * volume * inverse[3 * c + a - 1];
        l[0][c] -= l[a][c];
      }
    }
    int32_t element[10] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, zero[10] = {0};
    bw_mesh *mesh = NULL, *moved = NULL;
    bw_block_pattern *pattern = NULL;
    check_ok(context, bw_mesh_copy(context, 2, 10, &x[0][0], 1, element, NULL, &mesh));
    check_ok(context, bw_mesh_moved(context, mesh, &scaled[0][0], &moved));
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    for (int kind = 0; kind < 2; kind++) {
      bw_subdomain_stiffness *kept = NULL;
      bw_subdomain_motion motion;
      check_ok(context, bw_subdomain_stiffness_create(context, pattern, mesh, material[kind], false,
                                                      1, zero, zero, &kept));
      bw_subdomain_motion_rest(&motion);
      for (int c = 0; c < 3; c++)
        motion.linear[4 * c] = s[c];
      check_ok(context,
               bw_subdomain_stiffness_update(context, kept, moved, kept->material, &motion, NULL));
      check_ok(context,
               bw_element_stiffness(context, 2, (const double(*)[3])scaled, material[kind], k));
      double size = 0;
      for (int a = 0; a < 900; a++)
        size = fmax(size, fabs(k[a]));
      for (int i = 0; i < 10; i++)
        for (int j = 0; j <= i; j++)
          for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) {
              double sum = 0;
              for (int first = 0; first < 3; first++)
                for (int second = 0; second < 3; second++)
                  sum += tensor_of(material[kind], r, first, c, second) *
                         paper_alpha(i, j, first, second, (const double(*)[3])l, volume) *
                         paper_variable(first, second, s);
              double expected = k[(3 * i + r) * 30 + 3 * j + c];
              check_near(sum, expected, 1e-13 * size);
              check_near(kept->values[9 * (i * (i + 1) / 2 + j) + 3 * r + c], expected,
                         1e-13 * size);
            }
      bw_release(kept);
    }
    bw_release(pattern);
    bw_release(moved);
    bw_release(mesh);
  }
  bw_release(material[0]);
  bw_release(material[1]);
}

/* Whether a facet of the boundary has both nodes. */
static bool share_facet(const bw_mesh *mesh, int32_t i, int32_t j) {
  for (int f = 0; f < mesh->facet_count; f++) {
    int found = 0;
    for (int a = 0; a < mesh->nodes_per_facet; a++) {
      int32_t node = mesh->facet[f * mesh->nodes_per_facet + a];
      found += (node == i) + (node == j);
    }
    if (found == 2)
      return true;
  }
  return false;
}

/* The skew half of T is an integral over the boundary: the blocks of nodes that share no facet of
 * it are symmetric to rounding, those of others are not. */
static void skew_halves_are_of_the_boundary(void **state) {
  bw_context *context = check_context(state);
  bw_material *material[2] = {plain_material(context, 2e9, 0.3), odd_material(context)};
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = NULL;
    bw_block_pattern *pattern = NULL;
    perturbed_box(context, 4, 3, 3, order, 0, 0, &mesh);
    check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
    double *values = (double *)malloc(sizeof *values * 9 * (size_t)pattern->block_count);
    for (int m = 0; m < 2; m++) {
      check_ok(context, bw_stiffness(context, pattern, mesh, material[m], values));
      double largest = 0, inside = 0, boundary = 0;
      for (int64_t k = 0; k < 9 * pattern->block_count; k++)
        largest = fmax(largest, fabs(values[k]));
      for (int32_t i = 0; i < mesh->node_count; i++)
        for (int64_t block = pattern->start[i]; block < pattern->start[i + 1] - 1; block++) {
          const double *k = values + 9 * block;
          double skew = fmax(fabs(k[1] - k[3]), fmax(fabs(k[2] - k[6]), fabs(k[5] - k[7])));
          if (share_facet(mesh, i, pattern->column[block]))
            boundary = fmax(boundary, skew);
          else
            inside = fmax(inside, skew);
        }
      if (!(inside <= 1e-15 * largest) || !(boundary >= 1e-3 * largest))
        fail_msg("order %d: skew by %g inside and %g at the boundary, of %g", order,
                 inside / largest, boundary / largest, largest);
    }
    free(values);
    bw_release(pattern);
    bw_release(mesh);
  }
  bw_release(material[0]);
  bw_release(material[1]);
}

check_main(check_test(skew_halves_are_of_the_boundary),
           check_test(paper_formulas_against_quadrature))
