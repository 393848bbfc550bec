/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Non-negative least squares for the constants of a coarse cell. Each sample gives 19 equations,
 * linear in the constants: that the cell's energy at the sample's coarse shape is the block's, and
 * that its 18 derivatives are the forces that were applied. Forces are measured in a metric of the
 * cell's own stiffness, from one round to the next, so that to be too soft by a factor is as bad as
 * to be too stiff by it. */
#include "base/dense.h"
#include "metamaterial/fit.h"
#include "nonlinear/law.h"

#define ENERGY_FRACTION 0.1 /* of the equation for energy against one for a force */

#define MISSED 0.2 /* relative error that halves a sample's weight */

enum { ROUNDS = 3, SQUARE = BWI_SHAPES * BWI_SHAPES };

/* Energy and gradient for a unit of each constant: 19 numbers a column, energy first. */
typedef double columns[BWI_CONSTANTS][1 + BWI_SHAPES];

static void put(const bwi_response *response, int octant, const double gradient[9 * BWI_SHAPES],
                double *column) {
  column[0] = response->energy[octant] / BWI_OCTANTS;
  for (int s = 0; s < BWI_SHAPES; s++)
    column[1 + s] = 0;
  for (int i = 0; i < 9; i++) {
    double stress = response->stress[i][octant] / BWI_OCTANTS;
    for (int s = 0; s < BWI_SHAPES; s++)
      column[1 + s] += stress * gradient[i * BWI_SHAPES + s];
  }
}

/* False where the energy of some law does not exist at the sample's shape. */
static bool evaluate(const bwi_axes *axes, const uint8_t law[8],
                     double gradient[BWI_OCTANTS][9 * BWI_SHAPES], const bwi_sample *sample,
                     columns column) {
  bwi_lanes h[9], zero = {0}, one = zero + 1;
  bwi_response response;
  for (int k = 0; k < BWI_OCTANTS; k++)
    for (int i = 0; i < 9; i++)
      h[i][k] = bwi_dot(BWI_SHAPES, gradient[k] + (size_t)i * BWI_SHAPES, sample->coordinate);
  for (int which = 0; which < BW_LAWS; which++) {
    bool there = false;
    for (int k = 0; k < BWI_OCTANTS; k++)
      there = there || law[k] == which;
    for (int constant = 0; constant < 2 && there; constant++) {
      bwi_law((bw_law)which, constant ? &zero : &one, constant ? &one : &zero, h, BWI_STRESS, false,
              &response);
      for (int k = 0; k < BWI_OCTANTS; k++) {
        if (law[k] != which)
          continue;
        if (!response.defined[k] || !isfinite(response.energy[k]))
          return false;
        put(&response, k, gradient[k], column[8 * constant + k]);
      }
    }
  }
  for (int f = 0; f < axes->fibres; f++) {
    bwi_lanes v[3];
    for (int k = 0; k < BWI_OCTANTS; k++)
      for (int d = 0; d < 3; d++)
        v[d][k] = axes->direction[k][f][d];
    memset(&response.energy, 0, sizeof response.energy);
    memset(response.stress, 0, sizeof response.stress);
    bwi_fibre(&one, v, h, BWI_STRESS, false, &response);
    for (int k = 0; k < BWI_OCTANTS; k++)
      put(&response, k, gradient[k], column[16 + 8 * f + k]);
  }
  return true;
}

/* The equations of a sample, 1 + 18, at rows x n. */
static void equations(int n, const bwi_frame18 *frame, const double *metric,
                      const bwi_sample *sample, columns column,
                      double row[1 + BWI_SHAPES][BWI_CONSTANTS], double value[1 + BWI_SHAPES]) {
  double relative = sqrt(ENERGY_FRACTION) / sample->energy;
  for (int j = 0; j < n; j++)
    row[0][j] = column[j][0] * relative;
  value[0] = sample->energy * relative;
  for (int a = 0; a < BWI_SHAPES; a++) {
    const double *line = metric + (size_t)a * BWI_SHAPES;
    double weight = frame->weight[a] / sqrt(2 * sample->energy);
    for (int j = 0; j < n; j++)
      row[1 + a][j] = weight * bwi_dot(BWI_SHAPES, line, column[j] + 1);
    value[1 + a] = weight * bwi_dot(BWI_SHAPES, line, sample->force);
  }
}

/* Samples that the constants of the round before miss count for less: a block that has buckled has
 * left the shapes that a coarse cell knows. */
static void add_sample(int n, double row[1 + BWI_SHAPES][BWI_CONSTANTS],
                       const double value[1 + BWI_SHAPES], const double *constant, double weight,
                       double *gram, double *side) {
  double missed = 0;
  for (int e = 0; e <= BWI_SHAPES; e++) {
    double left = bwi_dot(n, row[e], constant) - value[e];
    missed += left * left;
  }
  weight /= 1 + missed / (MISSED * MISSED);
  for (int e = 0; e <= BWI_SHAPES; e++)
    for (int i = 0; i < n; i++) {
      double factor = weight * row[e][i];
      for (int j = 0; j < n; j++)
        gram[(size_t)i * n + j] += factor * row[e][j];
      side[i] += factor * value[e];
    }
}

void bwi_fit_constants(const bwi_frame18 *frame, const bwi_base *base, const uint8_t law[8],
                       const bwi_sample *sample, int count, double ridge, bwi_axes_work *work,
                       bwi_axes *axes) {
  int n = axes->ties.constants, used = 0;
  double gradient[BWI_OCTANTS][9 * BWI_SHAPES], metric[SQUARE], size = 0;
  double row[1 + BWI_SHAPES][BWI_CONSTANTS], value[1 + BWI_SHAPES];
  columns column;
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double at[3];
    bwi_octant_point(k, axes->spread, at);
    bwi_frame18_gradient(frame, at, gradient[k]);
  }
  for (int s = 0; s < BWI_SHAPES; s++)
    size += frame->weight[s] * frame->weight[s];
  for (int round = 0; round < ROUNDS; round++) {
    bwi_metric(axes->response, metric);
    memset(work->gram, 0, (size_t)n * n * sizeof *work->gram);
    memset(work->side, 0, (size_t)n * sizeof *work->side);
    used = 0;
    for (int s = 0; s < count; s++) {
      if (!(sample[s].energy > 0) || !evaluate(axes, law, gradient, sample + s, column))
        continue;
      equations(n, frame, metric, sample + s, column, row, value);
      add_sample(n, row, value, axes->constant, size / count, work->gram, work->side);
      used++;
    }
    if (used < n)
      return; /* too few to say more than linear elasticity */
    bwi_ridge(base, ridge, n, work->gram, work->side);
    bwi_tied_min(&axes->ties, base, work->gram, work->side, axes->fibres, work);
    memcpy(axes->constant, work->x, (size_t)n * sizeof(double));
    bwi_axes_response(frame, axes);
  }
}
