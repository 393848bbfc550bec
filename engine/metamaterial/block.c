/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The block's linear elasticity, condensed to its coarse displacements.
 *
 * Along a direction with three nodes, functions on them are spanned by 1, x (-1, 0, 1) and the
 * tent (-1, 1, -1), which is orthogonal to the others under the weights 1, 2, 1 that nodes have as
 * parts of the cubes. Products of 1 and x are the coarse functions; products of 1 and tents are
 * periodic, products with a tent and an x are not. A coarse displacement is the projection of the
 * nodes' displacement by weights of nodes as parts of cubes that are not void, so fluctuations have
 * that projection taken off.
 *
 * Invariant: fluctuations have no coarse part. An affine displacement draws periodic ones freely
 * and the others against the resistance of the block's surroundings, the gradients of strain draw
 * all freely. */
#include "metamaterial/block.h"

#include "base/dense.h"

#define WEAK 1e-4          /* a void cube's stiffness, against the mean of the others */
#define MAX_RESISTANCE 1e4 /* of surroundings, against the block: periodic, to as many digits */

int bwi_block_node(const int32_t size[3], int child, int c) {
  int at[3] = {child % size[0], child / size[0] % size[1], child / (size[0] * size[1])};
  return (at[0] + (c & 1)) +
         (size[0] + 1) * ((at[1] + (c >> 1 & 1)) + (size[1] + 1) * (at[2] + (c >> 2 & 1)));
}

void bwi_coarse_functions(const double at[3], double value[8]) {
  double x = at[0], y = at[1], z = at[2];
  double all[8] = {1, x, y, z, x * y, y * z, z * x, x * y * z};
  memcpy(value, all, sizeof all);
}

void bwi_weak_stiffness(double stiffness[BWI_COARSE * BWI_COARSE]) {
  /* |grad u|^2 / 2 at the Gauss points: no resistance to volume alone, none lost to rotation */
  memset(stiffness, 0, BWI_COARSE * BWI_COARSE * sizeof *stiffness);
  const double gauss[2] = {0.5 - 0.5 / sqrt(3.0), 0.5 + 0.5 / sqrt(3.0)};
  for (int p = 0; p < 8; p++) {
    double slope[8][3];
    for (int c = 0; c < 8; c++)
      for (int d = 0; d < 3; d++) {
        slope[c][d] = c >> d & 1 ? 1 : -1;
        for (int e = 0; e < 3; e++) {
          double at = gauss[p >> e & 1];
          slope[c][d] *= e == d ? 1 : c >> e & 1 ? at : 1 - at;
        }
      }
    for (int a = 0; a < 8; a++)
      for (int b = 0; b < 8; b++)
        for (int i = 0; i < 3; i++)
          stiffness[(3 * a + i) * BWI_COARSE + 3 * b + i] += bwi_dot(3, slope[a], slope[b]) / 8;
  }
}

static double trace(const double *stiffness) {
  double sum = 0;
  for (int i = 0; i < BWI_COARSE; i++)
    sum += stiffness[25 * i];
  return sum;
}

/* Everything that condensing needs on the way. */
typedef struct scratch {
  int nodes, rows, free; /* rows = 3 nodes; fluctuations in all */
  bool solid;            /* no void */
  double coarse[BWI_BLOCK_NODES][8];
  double stiffness[BWI_BLOCK_SIZE * BWI_BLOCK_SIZE];
  double fluctuation[BWI_BLOCK_SIZE * BWI_BLOCK_FREE]; /* rows x free, periodic ones first */
  double forces[BWI_BLOCK_SIZE * BWI_BLOCK_FREE];
  double reduced[BWI_BLOCK_FREE * BWI_BLOCK_FREE], side[BWI_BLOCK_FREE];
  double medium[BWI_BLOCK_SIZE * BWI_BLOCK_SIZE]; /* all cubes of bwi_weak_stiffness */
  /* of a medium of unit stiffness to fluctuations that do not repeat */
  double resistance[BWI_BLOCK_FREE * BWI_BLOCK_FREE];
  double product[BWI_BLOCK_SIZE * BWI_COARSE];
} scratch;

static void assemble(const int32_t size[3], const double *const child[8], double weak, scratch *s) {
  double empty[BWI_COARSE * BWI_COARSE];
  bwi_weak_stiffness(empty);
  memset(s->stiffness, 0, sizeof s->stiffness);
  memset(s->medium, 0, sizeof s->medium);
  for (int e = 0; e < size[0] * size[1] * size[2]; e++)
    for (int a = 0; a < 8; a++)
      for (int b = 0; b < 8; b++) {
        int from = 3 * bwi_block_node(size, e, a), to = 3 * bwi_block_node(size, e, b);
        for (int i = 0; i < 3; i++)
          for (int j = 0; j < 3; j++) {
            int entry = (3 * a + i) * BWI_COARSE + 3 * b + j;
            size_t at = (size_t)(from + i) * s->rows + to + j;
            s->stiffness[at] += child[e] ? child[e][entry] : weak * empty[entry];
            s->medium[at] += empty[entry];
          }
      }
}

/* Takes the coarse part off a function on the nodes. */
static void project(const scratch *s, const double *factor, const double *weight, double *values) {
  double part[8] = {0};
  for (int n = 0; n < s->nodes; n++)
    for (int m = 0; m < 8; m++)
      part[m] += weight[n] * values[n] * s->coarse[n][m];
  bwi_lower_solve(8, factor, part);
  bwi_upper_solve(8, factor, part);
  for (int n = 0; n < s->nodes; n++)
    values[n] -= bwi_dot(8, part, s->coarse[n]);
}

static void place(const int32_t size[3], int node, int at[3]) {
  at[0] = node % (size[0] + 1);
  at[1] = node / (size[0] + 1) % (size[1] + 1);
  at[2] = node / ((size[0] + 1) * (size[1] + 1));
}

/* Coarse functions and fluctuations at the nodes; returns the number of periodic columns. */
static int functions(const int32_t size[3], const double *const child[8], scratch *s) {
  double weight[BWI_BLOCK_NODES] = {0}, factor[64] = {0}, values[BWI_BLOCK_NODES];
  int kinds[27], kind_count = 0, periodic = 0;
  for (int e = 0; e < size[0] * size[1] * size[2]; e++)
    for (int c = 0; c < 8 && child[e]; c++)
      weight[bwi_block_node(size, e, c)] += 1;
  for (int n = 0; n < s->nodes; n++) {
    int at[3];
    double where[3];
    place(size, n, at);
    for (int d = 0; d < 3; d++)
      where[d] = 2.0 * at[d] / size[d] - 1;
    bwi_coarse_functions(where, s->coarse[n]);
    for (int a = 0; a < 8; a++)
      for (int b = 0; b < 8; b++)
        factor[8 * a + b] += weight[n] * s->coarse[n][a] * s->coarse[n][b];
  }
  bwi_cholesky(8, factor, 0);
  for (int mixed = 0; mixed < 2; mixed++)
    for (int kind = 0; kind < 27; kind++) { /* digits in base 3: 1, x, tent */
      int digit[3] = {kind % 3, kind / 3 % 3, kind / 9}, tents = 0, slopes = 0;
      bool there = true;
      for (int d = 0; d < 3; d++) {
        tents += digit[d] == 2;
        slopes += digit[d] == 1;
        there = there && (digit[d] < 2 || size[d] == 2);
      }
      if (there && tents > 0 && (slopes > 0) == mixed)
        kinds[kind_count++] = kind;
      if (!mixed)
        periodic = kind_count;
    }
  s->free = 3 * kind_count;
  memset(s->fluctuation, 0, sizeof s->fluctuation);
  for (int k = 0; k < kind_count; k++) {
    int digit[3] = {kinds[k] % 3, kinds[k] / 3 % 3, kinds[k] / 9};
    for (int n = 0; n < s->nodes; n++) {
      int at[3];
      place(size, n, at);
      values[n] = 1;
      for (int d = 0; d < 3; d++)
        values[n] *= digit[d] == 0   ? 1
                     : digit[d] == 1 ? 2.0 * at[d] / size[d] - 1
                     : at[d] == 1    ? 1
                                     : -1;
    }
    project(s, factor, weight, values);
    for (int n = 0; n < s->nodes; n++)
      for (int i = 0; i < 3; i++)
        s->fluctuation[(size_t)(3 * n + i) * s->free + 3 * k + i] = values[n];
  }
  return 3 * periodic;
}

/* What a medium around the block has against the fluctuations that do not repeat, those from
 * `periodic` on. Uses forces. */
static void resist(scratch *s, int periodic) {
  bwi_multiply(s->rows, s->rows, s->free, s->medium, s->fluctuation, s->forces);
  memset(s->resistance, 0, sizeof s->resistance);
  for (int i = periodic; i < s->free; i++)
    for (int j = periodic; j <= i; j++) {
      double sum = 0;
      for (int r = 0; r < s->rows; r++)
        sum += s->fluctuation[(size_t)r * s->free + i] * s->forces[(size_t)r * s->free + j];
      s->resistance[(size_t)i * s->free + j] = sum;
    }
}

/* Adds to columns first..first + 11 of the shapes what the first `count` fluctuations do in a
 * medium of stiffness `around`. */
static bool relax(scratch *s, int first, int count, double around, double *shape) {
  for (int i = 0; i < count; i++)
    for (int j = 0; j <= i; j++) {
      double sum = 0;
      for (int r = 0; r < s->rows; r++)
        sum += s->fluctuation[(size_t)r * s->free + i] * s->forces[(size_t)r * s->free + j];
      s->reduced[(size_t)i * count + j] = sum + around * s->resistance[(size_t)i * s->free + j];
    }
  if (count > 0 && !bwi_cholesky(count, s->reduced, 1e-13))
    return false;
  for (int c = first; c < first + BWI_AFFINE; c++) {
    for (int i = 0; i < count; i++) {
      s->side[i] = 0;
      for (int r = 0; r < s->rows; r++)
        s->side[i] -= s->forces[(size_t)r * s->free + i] * shape[(size_t)r * BWI_COARSE + c];
    }
    bwi_lower_solve(count, s->reduced, s->side);
    bwi_upper_solve(count, s->reduced, s->side);
    for (int r = 0; r < s->rows; r++)
      shape[(size_t)r * BWI_COARSE + c] +=
          bwi_dot(count, s->side, s->fluctuation + (size_t)r * s->free);
  }
  return true;
}

static void coarse_shapes(const scratch *s, double *shape) {
  memset(shape, 0, BWI_BLOCK_SIZE * BWI_COARSE * sizeof *shape);
  for (int n = 0; n < s->nodes; n++)
    for (int m = 0; m < 8; m++)
      for (int i = 0; i < 3; i++)
        shape[(size_t)(3 * n + i) * BWI_COARSE + 3 * m + i] = s->coarse[n][m];
}

/* Twice the energy of the uniform strains without change of volume, summed over six of them. */
static double shear_energy(const scratch *s, const double *stiffness, const double *shape) {
  double sum = 0;
  for (int k = 0; k < 6; k++) {
    double u[BWI_BLOCK_SIZE];
    int i = (k + 1) % 3,
        j = (k + 2) % 3; /* shears, then a stretch along i and as much less along j */
    int first = k < 3 ? 3 * (1 + j) + i : 3 * (1 + i) + i;
    int second = k < 3 ? 3 * (1 + i) + j : 3 * (1 + j) + j;
    for (int r = 0; r < s->rows; r++) {
      const double *row = shape + (size_t)r * BWI_COARSE;
      u[r] = row[first] + (k < 3 ? row[second] : -row[second]);
    }
    for (int r = 0; r < s->rows; r++)
      sum += u[r] * bwi_dot(s->rows, stiffness + (size_t)r * s->rows, u);
  }
  return sum;
}

/* The shapes of affine displacements. The surroundings of a block are taken to be as stiff in shear
 * as the block is itself when it repeats; but more, by the fourth power of the factor by which it
 * would be softer if nothing held it: what only hangs together at edges is held by its
 * neighbours. */
static bool relax_affine(scratch *s, int periodic, double *shape) {
  double own, loose;
  if (!relax(s, 0, periodic, 0, shape))
    return false;
  if (periodic == s->free || !s->solid)
    return true;
  own = shear_energy(s, s->stiffness, shape);
  coarse_shapes(s, shape);
  double unit = 2 * shear_energy(s, s->medium, shape); /* of shear modulus 1: 2 e : e */
  if (!relax(s, 0, s->free, 0, shape))
    return false;
  loose = shear_energy(s, s->stiffness, shape);
  double ratio = loose > 0 ? own / loose : MAX_RESISTANCE;
  double factor = fmin(ratio * ratio * ratio * ratio, MAX_RESISTANCE);
  coarse_shapes(s, shape);
  return relax(s, 0, s->free, factor * own / unit, shape);
}

bool bwi_condense(const int32_t size[3], const double *const child[8], bwi_condensed *out) {
  scratch s;
  double mean = 0, empty[BWI_COARSE * BWI_COARSE];
  int present = 0;
  for (int e = 0; e < size[0] * size[1] * size[2]; e++)
    if (child[e]) {
      mean += trace(child[e]);
      present++;
    }
  memset(out, 0, sizeof *out);
  if (present == 0 || !(mean > 0))
    return false;
  bwi_weak_stiffness(empty);
  out->weak = WEAK * mean / present / trace(empty);
  out->nodes = s.nodes = (size[0] + 1) * (size[1] + 1) * (size[2] + 1);
  s.rows = 3 * s.nodes;
  s.solid = present == size[0] * size[1] * size[2];
  assemble(size, child, out->weak, &s);
  out->periodic = functions(size, child, &s);
  for (int r = 0; r < s.rows; r++)
    for (int j = 0; j < out->periodic; j++)
      out->ripple[(size_t)r * out->periodic + j] = s.fluctuation[(size_t)r * s.free + j];
  resist(&s, out->periodic);
  bwi_multiply(s.rows, s.rows, s.free, s.stiffness, s.fluctuation, s.forces);
  coarse_shapes(&s, out->shape);
  if (!relax_affine(&s, out->periodic, out->shape) || !relax(&s, BWI_AFFINE, s.free, 0, out->shape))
    return false;
  bwi_multiply(s.rows, s.rows, BWI_COARSE, s.stiffness, out->shape, s.product);
  bwi_multiply_add(BWI_COARSE, s.rows, BWI_COARSE, out->shape, s.product, out->stiffness);
  return true;
}

void bwi_block_stiffness(const int32_t size[3], const double *const child[8],
                         double stiffness[576]) {
  bwi_condensed condensed;
  double to_functions[BWI_COARSE * BWI_COARSE] = {0}, half[BWI_COARSE * BWI_COARSE];
  memset(stiffness, 0, 576 * sizeof *stiffness);
  if (!bwi_condense(size, child, &condensed))
    return;
  for (int c = 0; c < 8; c++) {
    double at[3] = {c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1}, value[8];
    bwi_coarse_functions(at, value);
    for (int m = 0; m < 8; m++)
      for (int i = 0; i < 3; i++)
        to_functions[(3 * m + i) * BWI_COARSE + 3 * c + i] = value[m] / 8;
  }
  bwi_multiply(BWI_COARSE, BWI_COARSE, BWI_COARSE, condensed.stiffness, to_functions, half);
  bwi_multiply_add(BWI_COARSE, BWI_COARSE, BWI_COARSE, to_functions, half, stiffness);
}
