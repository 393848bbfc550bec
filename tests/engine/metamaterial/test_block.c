/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Blocks condensed to their corners: rigid-body modes are unconstrained, bounds hold, pairs and
 * symmetries. */
#include "check.h"
#include "metamaterial/block.h"
#include "metamaterial/keys.h"

static void material_stiffness(bw_context *context, double young, double stiffness[576]) {
  bw_solid_material *m;
  check_ok(context, bw_solid_material_create(context, "it", BW_NEO_HOOKEAN, young, 0.45, 0, &m));
  bwi_material_stiffness(m, stiffness);
  bw_release(m);
}

static double energy(const double stiffness[576], const double u[24]) {
  double sum = 0;
  for (int i = 0; i < 24; i++)
    for (int j = 0; j < 24; j++)
      sum += 0.5 * u[i] * stiffness[24 * i + j] * u[j];
  return sum;
}

/* Corners of a box of these sides moved by x -> g x. */
static void linear(const int32_t size[3], const double g[9], double u[24]) {
  for (int c = 0; c < 8; c++)
    for (int i = 0; i < 3; i++) {
      u[3 * c + i] = 0;
      for (int j = 0; j < 3; j++)
        u[3 * c + i] += g[3 * i + j] * size[j] * (c >> j & 1);
    }
}

static void a_homogeneous_box_is_that_box(void **state) {
  bw_context *context = check_context(state);
  static const int32_t sizes[][3] = {{2, 2, 2}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}, {1, 1, 1}};
  double own[576], block[576], u[24];
  const double turn[9] = {0, 1, -2, -1, 0, 3, 2, -3, 0};
  const double strain[9] = {0.3, 0.2, 0.1, 0.2, -0.1, 0.4, 0.1, 0.4, 0.2}, mu = 1e6 / 2.9;
  const double lambda = 1e6 * 0.45 / (1.45 * 0.1);
  double density = lambda * 0.16 / 2;
  for (int i = 0; i < 9; i++)
    density += mu * strain[i] * strain[i];
  material_stiffness(context, 1e6, own);
  const double *child[8];
  for (int c = 0; c < 8; c++)
    child[c] = own;
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
    const int32_t *size = sizes[s];
    double volume = (double)size[0] * size[1] * size[2];
    bwi_block_stiffness(size, child, block);
    linear(size, turn, u);
    check_near(energy(block, u), 0, 1e-6 * own[0]);
    linear(size, strain, u);
    check_near(energy(block, u), volume * density, 1e-9 * volume * density);
    for (int i = 0; i < 24; i++)
      for (int j = 0; j < 24; j++)
        check_near(block[24 * i + j], block[24 * j + i], 1e-9 * own[0]);
  }
  for (int i = 0; i < 576; i++) /* a block of one cube is the cube */
    check_near(block[i], own[i], 1e-8 * own[0]);
}

/* A homogeneous block bends more easily than a trilinear cell of its size, by what the locking of
 * hexahedra is at one and at two cells. */
static void bending_locks_less(void **state) {
  bw_context *context = check_context(state);
  double own[576], block[576], u[24] = {0};
  material_stiffness(context, 1e6, own);
  const double *child[8];
  for (int c = 0; c < 8; c++)
    child[c] = own;
  const int32_t size[3] = {2, 2, 2};
  bwi_block_stiffness(size, child, block);
  for (int c = 0; c < 8; c++) /* u_x = x z about the middle */
    u[3 * c] = ((c & 1) - 0.5) * ((c >> 2) - 0.5);
  double ratio = energy(block, u) / (2 * energy(own, u)); /* a cube of side 2 is twice as stiff */
  assert_true(ratio > 0.3 && ratio < 0.5);
}

/* Between the children in series and in parallel, whatever they are. */
static void between_reuss_and_voigt(void **state) {
  bw_context *context = check_context(state);
  double own[3][576], block[576], low[576], high[576], u[24];
  const int32_t size[3] = {2, 2, 2};
  bw_random random;
  bw_random_seed(&random, 3);
  for (int i = 0; i < 3; i++)
    material_stiffness(context, 1e5 * pow(10, i), own[i]);
  for (int trial = 0; trial < 20; trial++) {
    const double *child[8];
    double compliance = 0, mean = 0, g[9];
    for (int c = 0; c < 8; c++) {
      int which = (int)(3 * bw_random_uniform(&random));
      child[c] = own[which];
      compliance += 1 / pow(10, which) / 8;
      mean += pow(10, which) / 8;
    }
    for (int i = 0; i < 9; i++)
      g[i] = bw_random_normal(&random);
    bwi_block_stiffness(size, child, block);
    linear(size, g, u);
    for (int i = 0; i < 576; i++) {
      low[i] =
          2 * own[0][i] / compliance / 1; /* in proportion to the softest: one ratio of Poisson */
      high[i] = 2 * own[0][i] * mean;
    }
    for (int i = 0; i < 24; i++)
      u[i] /= 1; /* corners at 0 and 2: a cube of side 2 */
    assert_true(energy(block, u) >= energy(low, u) * (1 - 1e-9));
    assert_true(energy(block, u) <= energy(high, u) * (1 + 1e-9));
  }
}

/* Energy of x -> g x in a body that repeats a block of 2 x 2 x 2 cubes: eight nodes, of which one
 * is constrained and the others move besides, by Gauss's elimination of a 21 x 21 system. */
static double repeated_energy(const double *const child[8], const double g[9]) {
  enum { N = 21 };
  double a[N][N + 1] = {{0}}, sum = 0;
  for (int e = 0; e < 8; e++)
    for (int r = 0; r < 24; r++)
      for (int q = 0; q < 24; q++) {
        double k = child[e][24 * r + q], own[2] = {0};
        const int at[2] = {r, q};
        int unknown[2];
        for (int side = 0; side < 2; side++) {
          int corner = at[side] / 3, i = at[side] % 3, node = 0;
          for (int d = 0; d < 3; d++) {
            int place = (e >> d & 1) + (corner >> d & 1);
            own[side] += g[3 * i + d] * place;
            node |= (place & 1) << d;
          }
          unknown[side] = 3 * node + i - 3;
        }
        sum += 0.5 * own[0] * k * own[1];
        if (unknown[0] >= 0 && unknown[1] >= 0)
          a[unknown[0]][unknown[1]] += k;
        if (unknown[0] >= 0)
          a[unknown[0]][N] -= k * own[1];
      }
  double force[N];
  for (int i = 0; i < N; i++)
    force[i] = a[i][N];
  for (int i = 0; i < N; i++)
    for (int r = 0; r < N; r++)
      if (r != i) {
        double factor = a[r][i] / a[i][i];
        for (int q = i; q <= N; q++)
          a[r][q] -= factor * a[i][q];
      }
  for (int i = 0; i < N; i++)
    sum -= 0.5 * force[i] * a[i][N] / a[i][i];
  return sum;
}

/* What its surroundings let it do makes a block softer than where it repeats; not layers, which
 * repeat either way; where one column of four is soft, and by less than two where stiff columns
 * meet along edges, which would be hinges if nothing fixed them. */
static void surroundings_give_way(void **state) {
  bw_context *context = check_context(state);
  double own[2][576], block[576], u[24], min = 1, hinged = 1;
  const int32_t size[3] = {2, 2, 2};
  bw_random random;
  bw_random_seed(&random, 5);
  material_stiffness(context, 1e5, own[0]);
  material_stiffness(context, 1e7, own[1]);
  for (int trial = 0; trial < 40; trial++) {
    const double *child[8];
    double g[9];
    int kind = trial % 4;
    for (int c = 0; c < 8; c++) { /* columns along z; layers across z; checkered columns; random */
      int of[4] = {(c & 3) != 3, c >> 2, (c ^ c >> 1) & 1, (int)(2 * bw_random_uniform(&random))};
      child[c] = own[of[kind]];
    }
    for (int i = 0; i < 9; i++)
      g[i] = bw_random_normal(&random);
    bwi_block_stiffness(size, child, block);
    linear(size, g, u);
    double part = energy(block, u) / repeated_energy(child, g);
    assert_true(part < 1 + 1e-9);
    if (kind == 0)
      min = fmin(min, part);
    if (kind == 1)
      check_near(part, 1, 1e-9);
    if (kind == 2)
      hinged = fmin(hinged, part);
  }
  assert_true(min < 0.9);
  assert_true(hinged > 0.45); /* 0.14 in a medium of the block's own stiffness */
}

static void a_turned_block_is_the_block_turned(void **state) {
  bw_context *context = check_context(state);
  double own[3][576], block[576], turned[576], image[576];
  static const int key[8] = {0, 1, 2, 2, 0, 0, 1, 2};
  const int32_t size[3] = {2, 2, 2};
  for (int i = 0; i < 3; i++)
    material_stiffness(context, 1e5 * pow(10, i), own[i]);
  const double *child[8];
  for (int c = 0; c < 8; c++)
    child[c] = own[key[c]];
  bwi_block_stiffness(size, child, block);
  for (int s = 0; s < BWI_SYMMETRIES; s += 5) {
    for (int c = 0; c < 8; c++)
      child[bwi_symmetry_octant(bwi_symmetry_of(s), c)] = own[key[c]];
    bwi_block_stiffness(size, child, turned);
    bwi_symmetry_stiffness(s, block, image);
    for (int i = 0; i < 576; i++)
      check_near(turned[i], image[i], 1e-8 * block[0]);
  }
}

static void features_are_logarithms(void **state) {
  bw_context *context = check_context(state);
  double soft[576], hard[576], of_soft[BWI_FEATURES], of_hard[BWI_FEATURES], none[576] = {0};
  material_stiffness(context, 1e5, soft);
  material_stiffness(context, 1e7, hard);
  bwi_features(soft, of_soft);
  bwi_features(hard, of_hard);
  for (int f = 0; f < BWI_FEATURES; f++)
    check_near(of_hard[f] - of_soft[f], log(100), 1e-9);
  bwi_features(none, of_soft);
  for (int f = 0; f < BWI_FEATURES; f++)
    assert_true(isfinite(of_soft[f]));
  const int32_t size[3] = {2, 2, 2};
  const double *child[8] = {NULL};
  bwi_block_stiffness(size, child, soft);
  for (int i = 0; i < 576; i++)
    check_near(soft[i], 0, 0);
  child[3] = hard; /* one cube holds all corners, by extrapolation */
  bwi_block_stiffness(size, child, soft);
  for (int i = 0; i < 24; i++)
    assert_true(soft[25 * i] > 0);
}

check_main(check_test(a_homogeneous_box_is_that_box), check_test(bending_locks_less),
           check_test(between_reuss_and_voigt), check_test(surroundings_give_way),
           check_test(a_turned_block_is_the_block_turned), check_test(features_are_logarithms))
