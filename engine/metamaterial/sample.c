/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Samples of a block's energy: forces conjugate to its coarse shape in a random direction, with
 * magnitude growing step by step; the equilibrium of each from the last by Newton's method.
 * Translations and rotations are not among the unknowns. */
#include "metamaterial/sample.h"

#include "base/dense.h"
#include "nonlinear/internal.h"

#define TOLERANCE 1e-6 /* of the residual against the force */
#define ITERATIONS 20
#define HALVINGS 12
#define DESCENT 1e-4

void bwi_sampler_set(bwi_sampler *sampler, const bwi_block *block, const bwi_condensed *condensed,
                     const bwi_frame18 *frame) {
  double weak[BWI_COARSE * BWI_COARSE];
  memset(sampler, 0, sizeof *sampler);
  sampler->block = *block;
  bwi_weak_stiffness(weak);
  for (int c = 0; c < 8; c++) {
    for (int corner = 0; corner < 8; corner++)
      for (int i = 0; i < 3; i++) {
        int row = 3 * bwi_block_node(block->size, c, corner) + i;
        double *to = sampler->map[c][3 * corner + i];
        bwi_multiply(1, BWI_COARSE, BWI_SHAPES, condensed->shape + (size_t)row * BWI_COARSE,
                     frame->shape, to);
        memcpy(to + BWI_SHAPES, condensed->ripple + (size_t)row * condensed->periodic,
               (size_t)condensed->periodic * sizeof *to);
      }
    if (block->child[c])
      continue;
    bwi_multiply(BWI_COARSE, BWI_COARSE, BWI_STRIDE, weak, &sampler->map[c][0][0],
                 &sampler->half[0][0]);
    for (int i = 0; i < BWI_UNKNOWNS; i++) /* a cube's side is 1/2 */
      for (int r = 0; r < BWI_COARSE; r++)
        for (int j = 0; j < BWI_STRIDE; j++)
          sampler->weak[i][j] +=
              0.5 * condensed->weak * sampler->map[c][r][i] * sampler->half[r][j];
  }
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double at[3];
    bwi_octant_point(k, 1, at);
    bwi_frame18_gradient(frame, at, sampler->gradient + (size_t)9 * BWI_SHAPES * k);
  }
}

static void unpack(const double packed[BWI_ELEMENT_NUMBERS], double full[BWI_COARSE][BWI_COARSE]) {
  static const int upper[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  for (int a = 0; a < 8; a++)
    for (int b = 0; b <= a; b++) {
      const double *block = packed + bwi_element_block(a, b);
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
          double value = a == b ? block[upper[i][j]] : block[3 * i + j];
          full[3 * a + i][3 * b + j] = full[3 * b + j][3 * a + i] = value;
        }
    }
}

/* tangent += map^T full map, columns up to the row's */
static void add_tangent(bwi_sampler *s, int child) {
  for (int r = 0; r < BWI_COARSE; r++) {
    double row[BWI_STRIDE] = {0};
    for (int l = 0; l < BWI_COARSE; l++) {
      double factor = s->full[r][l];
      for (int j = 0; j < BWI_STRIDE; j++)
        row[j] += factor * s->map[child][l][j];
    }
    memcpy(s->half[r], row, sizeof row);
  }
  for (int i = 0; i < BWI_UNKNOWNS; i++) {
    int end = (i / 8 + 1) * 8;
    for (int r = 0; r < BWI_COARSE; r++) {
      double factor = s->map[child][r][i];
      for (int j = 0; j < end; j++)
        s->tangent[i][j] += factor * s->half[r][j];
    }
  }
}

/* Energy, and as far as wanted its derivatives, at y (BWI_STRIDE numbers, the last ones 0). */
static bool evaluate(bwi_sampler *s, const double *y, bwi_want want, bool project) {
  const double spacing[3] = {0.5, 0.5, 0.5};
  double held[BWI_STRIDE] = {0};
  for (int i = 0; i < BWI_UNKNOWNS; i++)
    held[i] = bwi_dot(BWI_STRIDE, s->weak[i], y);
  s->energy = 0.5 * bwi_dot(BWI_STRIDE, held, y);
  memcpy(s->residual, held, sizeof held);
  if (want == BWI_TANGENT)
    memcpy(s->tangent, s->weak, sizeof s->tangent);
  for (int c = 0; c < 8; c++) {
    double u[8][3], force[BWI_ELEMENT_FORCES], packed[BWI_ELEMENT_NUMBERS];
    bwi_hexahedron_state state;
    if (!s->block.child[c])
      continue;
    for (int r = 0; r < BWI_COARSE; r++)
      u[r / 3][r % 3] = bwi_dot(BWI_STRIDE, s->map[c][r], y);
    bwi_cell_evaluate(s->block.child[c], spacing, 0.125, (const double(*)[3])u, want, project,
                      &state, force, packed);
    if (!state.defined || !isfinite(state.energy))
      return false;
    s->energy += state.energy;
    if (want >= BWI_STRESS)
      for (int r = 0; r < BWI_COARSE; r++)
        for (int j = 0; j < BWI_STRIDE; j++)
          s->residual[j] += force[r] * s->map[c][r][j];
    if (want == BWI_TANGENT) {
      unpack(packed, s->full);
      add_tangent(s, c);
    }
  }
  return true;
}

static bool factorise(bwi_sampler *s, double shift) {
  for (int i = 0; i < BWI_UNKNOWNS; i++) {
    memcpy(s->factor + (size_t)i * BWI_UNKNOWNS, s->tangent[i], BWI_UNKNOWNS * sizeof(double));
    s->factor[(size_t)i * BWI_UNKNOWNS + i] *= 1 + shift;
  }
  return bwi_cholesky(BWI_UNKNOWNS, s->factor, 1e-12);
}

/* Newton's method on energy - force . coordinates from y; afterwards s->energy is that at y. */
static bool solve(bwi_sampler *s, const double force[BWI_SHAPES], double *y) {
  double size = sqrt(bwi_dot(BWI_SHAPES, force, force));
  if (!evaluate(s, y, BWI_TANGENT, false))
    return false;
  for (int iteration = 0; iteration < ITERATIONS; iteration++) {
    double left[BWI_STRIDE], slope = 0, part = 1;
    for (int i = 0; i < BWI_STRIDE; i++)
      left[i] = s->residual[i] - (i < BWI_SHAPES ? force[i] : 0);
    if (sqrt(bwi_dot(BWI_UNKNOWNS, left, left)) <= TOLERANCE * size)
      return true;
    if (!factorise(s, 0) && !(evaluate(s, y, BWI_TANGENT, true) && factorise(s, 1e-6)))
      return false;
    memcpy(s->step, left, sizeof s->step);
    bwi_lower_solve(BWI_UNKNOWNS, s->factor, s->step);
    bwi_upper_solve(BWI_UNKNOWNS, s->factor, s->step);
    slope = bwi_dot(BWI_UNKNOWNS, s->step, left);
    double before = s->energy - bwi_dot(BWI_SHAPES, force, y);
    bool accepted = false;
    for (int half = 0; half < HALVINGS && !accepted; half++, part /= 2) {
      for (int i = 0; i < BWI_STRIDE; i++)
        s->trial[i] = i < BWI_UNKNOWNS ? y[i] - part * s->step[i] : 0;
      if (!evaluate(s, s->trial, BWI_TANGENT, false))
        continue;
      double after = s->energy - bwi_dot(BWI_SHAPES, force, s->trial);
      accepted = after <= before - DESCENT * part * slope + 1e-13 * fabs(before);
    }
    if (!accepted)
      return false;
    memcpy(y, s->trial, sizeof s->trial);
  }
  return false;
}

/* Mean size of strain of a coarse shape. */
static double strain_size(const bwi_sampler *s, const double coordinate[BWI_SHAPES]) {
  double sum = 0;
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double h[9];
    bwi_multiply(9, BWI_SHAPES, 1, s->gradient + (size_t)9 * BWI_SHAPES * k, coordinate, h);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        double e = 0.5 * (h[3 * i + j] + h[3 * j + i]);
        sum += e * e / BWI_OCTANTS;
      }
  }
  return sqrt(sum);
}

int bwi_sample_direction(bwi_sampler *s, const bwi_frame18 *frame, double strain, int magnitudes,
                         bw_random *random, bwi_sample *sample) {
  double drawn[BWI_SHAPES], coordinate[BWI_SHAPES], force[BWI_SHAPES], y[BWI_STRIDE] = {0}, size;
  for (int i = 0; i < BWI_SHAPES; i++)
    drawn[i] = frame->weight[i] * bw_random_normal(random);
  /* nearly the same, without the shapes that meet no resistance (hinges between voids) */
  bwi_multiply(BWI_SHAPES, BWI_SHAPES, 1, frame->target, drawn, coordinate);
  size = strain_size(s, coordinate);
  if (!(size > 0))
    return 0;
  for (int i = 0; i < BWI_SHAPES; i++)
    coordinate[i] *= strain / (size * magnitudes);
  bwi_multiply(BWI_SHAPES, BWI_SHAPES, 1, frame->target, coordinate, force);
  memcpy(y, coordinate, sizeof coordinate);
  for (int m = 1; m <= magnitudes; m++) {
    double now[BWI_SHAPES], guess[BWI_STRIDE];
    for (int i = 0; i < BWI_SHAPES; i++)
      now[i] = m * force[i];
    for (int i = 0; i < BWI_STRIDE; i++)
      guess[i] = m > 1 ? y[i] * m / (m - 1) : y[i];
    if (!solve(s, now, guess)) {
      if (m == 1)
        memset(guess, 0, sizeof guess);
      else
        memcpy(guess, y, sizeof guess);
      if (!solve(s, now, guess))
        return m - 1;
    }
    memcpy(y, guess, sizeof y);
    memcpy(sample[m - 1].coordinate, y, sizeof sample->coordinate);
    memcpy(sample[m - 1].force, now, sizeof now);
    sample[m - 1].energy = s->energy;
  }
  return magnitudes;
}
