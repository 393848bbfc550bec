/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fits the linear elasticity of a coarse cell to that of its block: the constants that come out
 * only serve as a start, but directions of fibres and the spread of points stay. Candidates for
 * directions are those of a cube's edges and diagonals, and at each point the axes found by
 * stretching. A non-negative least squares that lets in no more than so many at a point chooses. */
#include "metamaterial/axes.h"

#include "base/dense.h"

enum { ROWS = BWI_SHAPES * (BWI_SHAPES + 1) / 2, SQUARE = BWI_SHAPES * BWI_SHAPES, ROUNDS = 4 };

#define FIRST_SPREAD 0.7
#define STRETCH 0.3

static void pack(const double *matrix, const double *weight, double *packed) {
  for (int a = 0, r = 0; a < BWI_SHAPES; a++)
    for (int b = 0; b <= a; b++, r++)
      packed[r] = matrix[a * BWI_SHAPES + b] * weight[a] * weight[b] * (a == b ? 1 : sqrt(2.0));
}

/* T matrix T, with T symmetric. */
static void transform(const double *metric, const double *matrix, double *out) {
  double half[SQUARE];
  bwi_multiply(BWI_SHAPES, BWI_SHAPES, BWI_SHAPES, metric, matrix, half);
  bwi_multiply(BWI_SHAPES, BWI_SHAPES, BWI_SHAPES, half, metric, out);
}

/* Stiffness of one octant with the constants x of all, 0 where the other constants are. */
static void octant_stiffness(int count, int octant, const double *x, const double *strain,
                             const bwi_candidates *c, double *matrix) {
  bwi_add_isotropic(x[octant] / 8, x[8 + octant] / 8, strain, matrix);
  for (int f = 0; f < c->count && 16 + 8 * f < count; f++)
    if (x[16 + 8 * f + octant] > 0) {
      double along[BWI_SHAPES];
      bwi_fibre_strain(c->direction[octant][f], strain, along);
      bwi_add_square(x[16 + 8 * f + octant] / 4, along, matrix);
    }
}

/* The constants of best fit in work->x, their response, and the error. */
static double fit_linear(const bwi_frame18 *frame, const bwi_base *base, double ridge,
                         double spread, const bwi_candidates *c, int limit, bwi_axes_work *work,
                         double *response) {
  int n = BWI_OCTANTS * (2 + c->count);
  double strain[BWI_OCTANTS][6 * BWI_SHAPES], metric[SQUARE], packed[ROWS], moved[SQUARE];
  double error = 0;
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double at[3], gradient[9 * BWI_SHAPES];
    bwi_octant_point(k, spread, at);
    bwi_frame18_gradient(frame, at, gradient);
    bwi_point_strains(gradient, strain[k]);
  }
  memset(metric, 0, sizeof metric);
  for (int s = 0; s < BWI_SHAPES; s++)
    metric[19 * s] = 1;
  for (int round = 0; round <= ROUNDS; round++) {
    for (int k = 0; k < BWI_OCTANTS; k++) { /* columns in the metric */
      double own[6 * BWI_SHAPES];
      bwi_multiply(6, BWI_SHAPES, BWI_SHAPES, strain[k], metric, own);
      for (int j = 0; j < 2 + c->count; j++) {
        double unit[SQUARE] = {0}, along[BWI_SHAPES];
        if (j < 2)
          bwi_add_isotropic(j == 0 ? 0.125 : 0, j == 1 ? 0.125 : 0, own, unit);
        else {
          bwi_fibre_strain(c->direction[k][j - 2], own, along);
          bwi_add_square(0.25, along, unit);
        }
        pack(unit, frame->weight, work->column[8 * j + k]);
      }
    }
    transform(metric, frame->target, moved);
    pack(moved, frame->weight, packed);
    for (int i = 0; i < n; i++) {
      for (int j = 0; j <= i; j++)
        work->gram[(size_t)i * n + j] = work->gram[(size_t)j * n + i] =
            bwi_dot(ROWS, work->column[i], work->column[j]);
      work->side[i] = bwi_dot(ROWS, work->column[i], packed);
    }
    bwi_ridge(base, ridge, n, work->gram, work->side);
    bwi_tied_min(&c->ties, base, work->gram, work->side, limit, work);
    memset(response, 0, SQUARE * sizeof *response);
    for (int k = 0; k < BWI_OCTANTS; k++)
      octant_stiffness(n, k, work->x, strain[k], c, response);
    bwi_metric(response, metric);
  }
  for (int i = 0; i < SQUARE; i++)
    moved[i] = response[i] - frame->target[i];
  double difference[SQUARE];
  transform(metric, moved, difference);
  pack(difference, frame->weight, packed);
  error = bwi_dot(ROWS, packed, packed);
  return error;
}

/* Directions of a cube's edges and diagonals; the same at all points. */
static int cube_directions(double direction[13][3]) {
  int count = 0;
  for (int code = 14; code < 27; code++) { /* digits -1, 0, 1 in base 3, half of them */
    double v[3] = {code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1}, length = bw_norm(v);
    for (int d = 0; d < 3; d++)
      direction[count][d] = v[d] / length;
    count++;
  }
  return count;
}

/* The axes of the figure that directions v, stretched as the point stretches when the block is
 * pulled along v, describe (data-driven, section 4.3). Rows of axes: the most stretched first. */
static void stretch_axes(const bwi_frame18 *frame, const double *gradient, int stretches,
                         double axes[9]) {
  double lower[SQUARE], sum[6] = {0}, largest = 0;
  double centre[3] = {0.5, 0.5, 0.5}, middle[9 * BWI_SHAPES], strain[6 * BWI_SHAPES];
  double own[6 * BWI_SHAPES];
  memcpy(lower, frame->target, sizeof lower);
  for (int s = 0; s < BWI_SHAPES; s++)
    lower[19 * s] += BWI_FLOOR;
  bwi_cholesky(BWI_SHAPES, lower, 0);
  bwi_frame18_gradient(frame, centre, middle);
  bwi_point_strains(middle, strain);
  bwi_point_strains(gradient, own);
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < stretches; i++) { /* a spiral over the sphere */
      double z = 1 - (2 * i + 1.0) / stretches, r = sqrt(1 - z * z), turn = 2.399963229728653 * i;
      double v[3] = {r * cos(turn), r * sin(turn), z}, force[BWI_SHAPES], along[BWI_SHAPES];
      bwi_fibre_strain(v, strain, force); /* work of the traction v v^T */
      bwi_lower_solve(BWI_SHAPES, lower, force);
      bwi_upper_solve(BWI_SHAPES, lower, force);
      bwi_fibre_strain(v, own, along);
      double stretch = bwi_dot(BWI_SHAPES, along, force);
      if (pass == 0) {
        largest = fmax(largest, fabs(stretch));
        continue;
      }
      double length = 1 + (largest > 0 ? STRETCH * stretch / largest : 0);
      double square = length * length;
      sum[0] += square * v[0] * v[0];
      sum[1] += square * v[1] * v[1];
      sum[2] += square * v[2] * v[2];
      sum[3] += square * v[1] * v[2];
      sum[4] += square * v[2] * v[0];
      sum[5] += square * v[0] * v[1];
    }
  double values[3];
  bw_eigen3(sum, values, axes);
}

/* Where a block has a symmetry, its axes are among the cube's directions. */
static void all_candidates(const bwi_frame18 *frame, uint64_t symmetries, int stretches,
                           bwi_candidates *c) {
  double cube[13][3];
  int cubes = cube_directions(cube);
  stretches = symmetries == 1 ? stretches : 0;
  c->count = cubes + (stretches > 0 ? 3 : 0);
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double at[3], gradient[9 * BWI_SHAPES], axes[9];
    memcpy(c->direction[k], cube, sizeof cube);
    if (stretches == 0)
      continue;
    bwi_octant_point(k, FIRST_SPREAD, at);
    bwi_frame18_gradient(frame, at, gradient);
    stretch_axes(frame, gradient, stretches, axes);
    for (int a = 0; a < 3; a++) {
      double *to = c->direction[k][cubes + a];
      memcpy(to, axes + 3 * a, 3 * sizeof *to);
      for (int other = 0; other < cubes; other++)
        if (fabs(bw_dot(to, cube[other])) > BWI_SAME_DIRECTION) /* no second column of the same */
          memset(to, 0, 3 * sizeof *to);
    }
  }
  bwi_tie(symmetries, c);
}

/* Keeps, at each point, the directions that were let in. */
static void keep(const bwi_candidates *all, uint64_t symmetries, int limit, const double *x,
                 bwi_candidates *kept) {
  kept->count = limit;
  for (int k = 0; k < BWI_OCTANTS; k++) {
    int count = 0;
    for (int f = 0; f < all->count && count < limit; f++)
      if (x[16 + 8 * f + k] > 0)
        memcpy(kept->direction[k][count++], all->direction[k][f], 3 * sizeof(double));
    for (; count < limit; count++)
      memset(kept->direction[k][count], 0, 3 * sizeof(double));
  }
  bwi_tie(symmetries, kept);
}

void bwi_axes_choose(const bwi_frame18 *frame, const bwi_base *base, uint64_t symmetries,
                     int stretches, int fibres, double ridge, bwi_axes_work *work, bwi_axes *axes) {
  bwi_candidates all, kept;
  double min = INFINITY, best = 1, response[SQUARE];
  fibres = fibres < 0 ? 0 : fibres > BWI_FIBRES ? BWI_FIBRES : fibres;
  memset(&kept, 0, sizeof kept);
  bwi_tie(symmetries, &kept);
  if (fibres > 0) {
    all_candidates(frame, symmetries, stretches, &all);
    fit_linear(frame, base, ridge, FIRST_SPREAD, &all, fibres, work, response);
    keep(&all, symmetries, fibres, work->x, &kept);
  }
  for (int step = 0; step < 5; step++) { /* a coarse search, then thirds */
    double spread = 0.2 + 0.2 * step;
    double error = fit_linear(frame, base, ridge, spread, &kept, fibres, work, response);
    if (error < min) {
      min = error;
      best = spread;
    }
  }
  for (double width = 0.1; width > 0.02; width /= 2)
    for (int side = -1, turn = 0; turn < 2; side = 1, turn++) {
      double spread = best + side * width, error;
      if (!(spread <= 1 && spread >= 0.1))
        continue;
      error = fit_linear(frame, base, ridge, spread, &kept, fibres, work, response);
      if (error < min) {
        min = error;
        best = spread;
        break;
      }
    }
  if (fibres > 0) { /* once more, now that the points are known */
    fit_linear(frame, base, ridge, best, &all, fibres, work, response);
    keep(&all, symmetries, fibres, work->x, &kept);
  }
  fit_linear(frame, base, ridge, best, &kept, fibres, work, axes->response);
  axes->spread = best;
  axes->fibres = fibres;
  axes->ties = kept.ties;
  memset(axes->constant, 0, sizeof axes->constant);
  memcpy(axes->constant, work->x, (size_t)(BWI_OCTANTS * (2 + fibres)) * sizeof(double));
  for (int k = 0; k < BWI_OCTANTS; k++)
    for (int f = 0; f < fibres; f++)
      memcpy(axes->direction[k][f], kept.direction[k][f], 3 * sizeof(double));
}

void bwi_axes_response(const bwi_frame18 *frame, bwi_axes *axes) {
  bwi_candidates c = {0};
  c.count = axes->fibres;
  memset(axes->response, 0, sizeof axes->response);
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double at[3], gradient[9 * BWI_SHAPES], strain[6 * BWI_SHAPES];
    for (int f = 0; f < axes->fibres; f++)
      memcpy(c.direction[k][f], axes->direction[k][f], 3 * sizeof(double));
    bwi_octant_point(k, axes->spread, at);
    bwi_frame18_gradient(frame, at, gradient);
    bwi_point_strains(gradient, strain);
    octant_stiffness(BWI_OCTANTS * (2 + axes->fibres), k, axes->constant, strain, &c,
                     axes->response);
  }
}
