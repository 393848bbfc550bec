/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fits the linear elasticity of a coarse cell to that of its block: the constants that come out
 * only serve as a start, but directions of fibres and the spread of points stay. Candidates for
 * directions are those of a cube's edges and diagonals, and at each point the axes found by
 * stretching. A non-negative least squares that lets in no more than so many at a point chooses. */
#include "metamaterial/axes.h"

#include "metamaterial/fit_dense.h"
#include "metamaterial/keys.h"
#include "metamaterial/nnls.h"

enum { ROWS = BWI_SHAPES * (BWI_SHAPES + 1) / 2, SQUARE = BWI_SHAPES * BWI_SHAPES, ROUNDS = 4 };

#define FLOOR 1e-3 /* added stiffness, against a cell of mean constants */
#define LEAST_EIGENVALUE 0.02
#define SAME_DIRECTION 0.999 /* cosine */
#define FIRST_SPREAD 0.7
#define STRETCH 0.3
#define FIBRE_SIZE 0.5 /* of the mean mu: what counts as a fibre's own size */

void bwi_octant_point(int octant, double spread, double at[3]) {
  for (int d = 0; d < 3; d++)
    at[d] = 0.5 + (octant >> d & 1 ? 0.5 : -0.5) * spread / sqrt(3.0);
}

/* Gradients of the coarse functions in the unit cube. */
static void function_gradients(const double at[3], double gradient[8][3]) {
  double x = 2 * at[0] - 1, y = 2 * at[1] - 1, z = 2 * at[2] - 1;
  const double all[8][3] = {
      {0, 0, 0},         {2, 0, 0},         {0, 2, 0},         {0, 0, 2},
      {2 * y, 2 * x, 0}, {0, 2 * z, 2 * y}, {2 * z, 0, 2 * x}, {2 * y * z, 2 * x * z, 2 * x * y}};
  memcpy(gradient, all, sizeof all);
}

static void gradients(const double *shape, const double at[3], double *gradient) {
  double of[8][3];
  function_gradients(at, of);
  memset(gradient, 0, 9 * BWI_SHAPES * sizeof *gradient);
  for (int m = 1; m < 8; m++)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        for (int s = 0; s < BWI_SHAPES; s++)
          gradient[(3 * i + j) * BWI_SHAPES + s] += of[m][j] * shape[(3 * m + i) * BWI_SHAPES + s];
}

void bwi_frame18_gradient(const bwi_frame18 *frame, const double at[3],
                          double gradient[9 * BWI_SHAPES]) {
  gradients(frame->shape, at, gradient);
}

/* Strains xx yy zz yz zx xy (engineering shears) from displacement gradients: 6 x 18. */
static void strains(const double *gradient, double *strain) {
  static const int row[6][2] = {{0, 0}, {4, 4}, {8, 8}, {5, 7}, {2, 6}, {1, 3}};
  for (int k = 0; k < 6; k++)
    for (int s = 0; s < BWI_SHAPES; s++)
      strain[k * BWI_SHAPES + s] =
          gradient[row[k][0] * BWI_SHAPES + s] + (k < 3 ? 0 : gradient[row[k][1] * BWI_SHAPES + s]);
}

/* matrix (18 x 18) += factor v v^T */
static void add_square(double factor, const double *v, double *matrix) {
  for (int a = 0; a < BWI_SHAPES; a++)
    for (int b = 0; b < BWI_SHAPES; b++)
      matrix[a * BWI_SHAPES + b] += factor * v[a] * v[b];
}

/* Stiffness of a point with constants mu, lambda. */
static void add_isotropic(double mu, double lambda, const double *strain, double *matrix) {
  double trace[BWI_SHAPES];
  for (int s = 0; s < BWI_SHAPES; s++)
    trace[s] = strain[s] + strain[BWI_SHAPES + s] + strain[2 * BWI_SHAPES + s];
  if (lambda > 0)
    add_square(lambda, trace, matrix);
  for (int k = 0; k < 6 && mu > 0; k++)
    add_square(k < 3 ? 2 * mu : mu, strain + k * BWI_SHAPES, matrix);
}

/* The stretch of a fibre for each coordinate. */
static void fibre_strain(const double v[3], const double *strain, double *along) {
  const double factor[6] = {v[0] * v[0], v[1] * v[1], v[2] * v[2],
                            v[1] * v[2], v[2] * v[0], v[0] * v[1]};
  bwi_multiply(1, 6, BWI_SHAPES, factor, strain, along);
}

void bwi_frame18_of(const bwi_condensed *condensed, const bwi_base *base, bwi_frame18 *frame) {
  double shape[BWI_COARSE * BWI_SHAPES] = {0}, half[BWI_COARSE * BWI_SHAPES];
  double stiffness[SQUARE] = {0}, lower[SQUARE];
  static const int pair[3][2] = {{1, 2}, {2, 0}, {0, 1}};
  for (int d = 0; d < 3; d++) {
    int i = pair[d][0], j = pair[d][1];
    shape[(3 * (1 + d) + d) * BWI_SHAPES + d] = 1;
    shape[(3 * (1 + j) + i) * BWI_SHAPES + 3 + d] = sqrt(0.5);
    shape[(3 * (1 + i) + j) * BWI_SHAPES + 3 + d] = sqrt(0.5);
  }
  for (int g = 0; g < BWI_SHAPES - BWI_STRAINS; g++)
    shape[(BWI_AFFINE + g) * BWI_SHAPES + BWI_STRAINS + g] = 1;
  bwi_multiply(BWI_COARSE, BWI_COARSE, BWI_SHAPES, condensed->stiffness, shape, half);
  bwi_multiply_add(BWI_SHAPES, BWI_COARSE, BWI_SHAPES, shape, half, stiffness);
  memcpy(lower, stiffness, sizeof lower);
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double at[3], gradient[9 * BWI_SHAPES], strain[6 * BWI_SHAPES];
    bwi_octant_point(k, 1, at);
    gradients(shape, at, gradient);
    strains(gradient, strain);
    add_isotropic(FLOOR * base->mean_mu / 8, 0, strain, lower);
  }
  bwi_cholesky(BWI_SHAPES, lower, 0);
  /* shape <- shape L^-T, row by row: (L^-1 row^T)^T */
  memcpy(frame->shape, shape, sizeof shape);
  for (int r = 0; r < BWI_COARSE; r++)
    bwi_lower_solve(BWI_SHAPES, lower, frame->shape + (size_t)r * BWI_SHAPES);
  memset(frame->target, 0, sizeof frame->target);
  bwi_multiply(BWI_COARSE, BWI_COARSE, BWI_SHAPES, condensed->stiffness, frame->shape, half);
  bwi_multiply_add(BWI_SHAPES, BWI_COARSE, BWI_SHAPES, frame->shape, half, frame->target);
  for (int s = 0; s < BWI_SHAPES; s++)
    frame->weight[s] = s < BWI_STRAINS ? 1 : BWI_GRADIENT_WEIGHT;
}

/* Jacobi's method: matrix = V diag(value) V^T, columns of V. */
static void eigen(double *a, double *value, double *v) {
  memset(v, 0, SQUARE * sizeof *v);
  for (int i = 0; i < BWI_SHAPES; i++)
    v[19 * i] = 1;
  for (int sweep = 0; sweep < 30; sweep++) {
    double off = 0, whole = 0;
    for (int i = 0; i < BWI_SHAPES; i++)
      for (int j = 0; j < BWI_SHAPES; j++)
        *(i == j ? &whole : &off) += a[18 * i + j] * a[18 * i + j];
    if (off <= 1e-24 * whole)
      break;
    for (int p = 0; p < BWI_SHAPES; p++)
      for (int q = p + 1; q < BWI_SHAPES; q++) {
        double apq = a[18 * p + q];
        if (fabs(apq) <= 1e-300)
          continue;
        double theta = (a[19 * q] - a[19 * p]) / (2 * apq);
        double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
        double c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < BWI_SHAPES; k++) {
          double x = a[18 * k + p], y = a[18 * k + q];
          a[18 * k + p] = c * x - s * y;
          a[18 * k + q] = s * x + c * y;
        }
        for (int k = 0; k < BWI_SHAPES; k++) {
          double x = a[18 * p + k], y = a[18 * q + k];
          a[18 * p + k] = c * x - s * y;
          a[18 * q + k] = s * x + c * y;
          x = v[18 * k + p];
          y = v[18 * k + q];
          v[18 * k + p] = c * x - s * y;
          v[18 * k + q] = s * x + c * y;
        }
      }
  }
  for (int i = 0; i < BWI_SHAPES; i++)
    value[i] = a[19 * i];
}

void bwi_metric(const double response[SQUARE], double metric[SQUARE]) {
  double a[SQUARE], value[BWI_SHAPES], v[SQUARE];
  memcpy(a, response, sizeof a);
  eigen(a, value, v);
  memset(metric, 0, SQUARE * sizeof *metric);
  for (int k = 0; k < BWI_SHAPES; k++) {
    double column[BWI_SHAPES];
    for (int i = 0; i < BWI_SHAPES; i++)
      column[i] = v[18 * i + k];
    add_square(1 / sqrt(sqrt(fmax(value[k], LEAST_EIGENVALUE))), column, metric);
  }
}

void bwi_ridge(const bwi_base *base, double ridge, int count, double *gram, double *side) {
  for (int j = 0; j < count; j++) {
    double own = j < 8 ? base->mu[j] : j < 16 ? base->lambda[j - 8] : 0;
    double size = own > 0 ? own : j >= 8 && j < 16 ? base->mean_lambda : base->mean_mu;
    size *= j < 16 ? 1 : FIBRE_SIZE;
    double stiffness = size > 0 ? ridge * ridge / (size * size) : 0;
    gram[(size_t)j * count + j] += stiffness;
    side[j] += stiffness * own;
  }
}

/* Directions and their number at each point, while choosing. */
typedef struct candidates {
  int count;
  double direction[BWI_OCTANTS][BWI_DIRECTIONS][3]; /* zero: none */
  bwi_ties ties;
} candidates;

/* The direction of octant k that is v or -v; -1: none. */
static int find_direction(const candidates *c, int octant, const double v[3]) {
  for (int f = 0; f < c->count; f++)
    if (fabs(bw_dot(v, c->direction[octant][f])) > SAME_DIRECTION)
      return f;
  return -1;
}

/* Where a symmetry takes a constant. */
static int image(const candidates *c, int s, int constant) {
  bwi_symmetry symmetry = bwi_symmetry_of(s);
  int octant = bwi_symmetry_octant(symmetry, constant % 8), f = constant / 8 - 2;
  double v[3];
  if (f < 0)
    return constant - constant % 8 + octant;
  bwi_symmetry_vector(symmetry, c->direction[constant % 8][f], v);
  f = find_direction(c, octant, v);
  return f < 0 ? -1 : 8 * (2 + f) + octant;
}

static void tie(uint64_t symmetries, candidates *c) {
  bwi_ties *ties = &c->ties;
  ties->constants = BWI_OCTANTS * (2 + c->count);
  ties->variables = 0;
  for (int j = 0; j < ties->constants; j++)
    ties->variable[j] = -1;
  for (int j = 0; j < ties->constants; j++) {
    int f = j / 8 - 2, v = ties->variables, low = j % 8;
    if (ties->variable[j] >= 0 || (f >= 0 && !(bw_norm(c->direction[j % 8][f]) > 0)))
      continue;
    bool closed = true;
    for (int s = 0; s < BWI_SYMMETRIES && closed; s++)
      closed = !(symmetries >> s & 1) || image(c, s, j) >= 0;
    if (!closed)
      continue;
    ties->size[v] = 0;
    for (int s = 0; s < BWI_SYMMETRIES; s++)
      if (symmetries >> s & 1) {
        int to = image(c, s, j);
        ties->variable[to] = v;
        low = to % 8 < low ? to % 8 : low;
      }
    for (int other = 0; other < c->count; other++)
      ties->size[v] += ties->variable[8 * (2 + other) + j % 8] == v;
    ties->group[v] = f < 0 ? -1 : low;
    ties->variables++;
  }
}

void bwi_tied_least(const bwi_ties *ties, const bwi_base *base, const double *gram,
                    const double *side, int limit, bwi_axes_work *work) {
  double least[2 * BWI_OCTANTS];
  memcpy(least, base->least_mu, sizeof base->least_mu);
  memcpy(least + BWI_OCTANTS, base->least_lambda, sizeof base->least_lambda);
  int n = ties->constants, m = ties->variables;
  memset(work->tied, 0, (size_t)m * m * sizeof *work->tied);
  memset(work->tied_side, 0, (size_t)m * sizeof *work->tied_side);
  for (int i = 0; i < n; i++) {
    int row = ties->variable[i];
    if (row < 0)
      continue;
    work->tied_side[row] += side[i] - bwi_product(2 * BWI_OCTANTS, gram + (size_t)i * n, least);
    for (int j = 0; j < n; j++)
      if (ties->variable[j] >= 0)
        work->tied[(size_t)row * m + ties->variable[j]] += gram[(size_t)i * n + j];
  }
  bwi_nnls(m, work->tied, work->tied_side, ties->group, ties->size, limit, work->value, work->nnls);
  for (int i = 0; i < n; i++)
    work->x[i] = (i < 2 * BWI_OCTANTS ? least[i] : 0) +
                 (ties->variable[i] < 0 ? 0 : work->value[ties->variable[i]]);
}

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
                             const candidates *c, double *matrix) {
  add_isotropic(x[octant] / 8, x[8 + octant] / 8, strain, matrix);
  for (int f = 0; f < c->count && 16 + 8 * f < count; f++)
    if (x[16 + 8 * f + octant] > 0) {
      double along[BWI_SHAPES];
      fibre_strain(c->direction[octant][f], strain, along);
      add_square(x[16 + 8 * f + octant] / 4, along, matrix);
    }
}

/* The constants of best fit in work->x, their response, and the error. */
static double fit_linear(const bwi_frame18 *frame, const bwi_base *base, double ridge,
                         double spread, const candidates *c, int limit, bwi_axes_work *work,
                         double *response) {
  int n = BWI_OCTANTS * (2 + c->count);
  double strain[BWI_OCTANTS][6 * BWI_SHAPES], metric[SQUARE], packed[ROWS], moved[SQUARE];
  double error = 0;
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double at[3], gradient[9 * BWI_SHAPES];
    bwi_octant_point(k, spread, at);
    bwi_frame18_gradient(frame, at, gradient);
    strains(gradient, strain[k]);
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
          add_isotropic(j == 0 ? 0.125 : 0, j == 1 ? 0.125 : 0, own, unit);
        else {
          fibre_strain(c->direction[k][j - 2], own, along);
          add_square(0.25, along, unit);
        }
        pack(unit, frame->weight, work->column[8 * j + k]);
      }
    }
    transform(metric, frame->target, moved);
    pack(moved, frame->weight, packed);
    for (int i = 0; i < n; i++) {
      for (int j = 0; j <= i; j++)
        work->gram[(size_t)i * n + j] = work->gram[(size_t)j * n + i] =
            bwi_product(ROWS, work->column[i], work->column[j]);
      work->side[i] = bwi_product(ROWS, work->column[i], packed);
    }
    bwi_ridge(base, ridge, n, work->gram, work->side);
    bwi_tied_least(&c->ties, base, work->gram, work->side, limit, work);
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
  error = bwi_product(ROWS, packed, packed);
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
    lower[19 * s] += FLOOR;
  bwi_cholesky(BWI_SHAPES, lower, 0);
  bwi_frame18_gradient(frame, centre, middle);
  strains(middle, strain);
  strains(gradient, own);
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < stretches; i++) { /* a spiral over the sphere */
      double z = 1 - (2 * i + 1.0) / stretches, r = sqrt(1 - z * z), turn = 2.399963229728653 * i;
      double v[3] = {r * cos(turn), r * sin(turn), z}, force[BWI_SHAPES], along[BWI_SHAPES];
      fibre_strain(v, strain, force); /* work of the traction v v^T */
      bwi_lower_solve(BWI_SHAPES, lower, force);
      bwi_upper_solve(BWI_SHAPES, lower, force);
      fibre_strain(v, own, along);
      double stretch = bwi_product(BWI_SHAPES, along, force);
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
                           candidates *c) {
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
        if (fabs(bw_dot(to, cube[other])) > SAME_DIRECTION) /* no second column of the same */
          memset(to, 0, 3 * sizeof *to);
    }
  }
  tie(symmetries, c);
}

/* Keeps, at each point, the directions that were let in. */
static void keep(const candidates *all, uint64_t symmetries, int limit, const double *x,
                 candidates *kept) {
  kept->count = limit;
  for (int k = 0; k < BWI_OCTANTS; k++) {
    int count = 0;
    for (int f = 0; f < all->count && count < limit; f++)
      if (x[16 + 8 * f + k] > 0)
        memcpy(kept->direction[k][count++], all->direction[k][f], 3 * sizeof(double));
    for (; count < limit; count++)
      memset(kept->direction[k][count], 0, 3 * sizeof(double));
  }
  tie(symmetries, kept);
}

void bwi_axes_choose(const bwi_frame18 *frame, const bwi_base *base, uint64_t symmetries,
                     int stretches, int fibres, double ridge, bwi_axes_work *work, bwi_axes *axes) {
  candidates all, kept;
  double least = INFINITY, best = 1, response[SQUARE];
  fibres = fibres < 0 ? 0 : fibres > BWI_FIBRES ? BWI_FIBRES : fibres;
  memset(&kept, 0, sizeof kept);
  tie(symmetries, &kept);
  if (fibres > 0) {
    all_candidates(frame, symmetries, stretches, &all);
    fit_linear(frame, base, ridge, FIRST_SPREAD, &all, fibres, work, response);
    keep(&all, symmetries, fibres, work->x, &kept);
  }
  for (int step = 0; step < 5; step++) { /* a coarse search, then thirds */
    double spread = 0.2 + 0.2 * step;
    double error = fit_linear(frame, base, ridge, spread, &kept, fibres, work, response);
    if (error < least) {
      least = error;
      best = spread;
    }
  }
  for (double width = 0.1; width > 0.02; width /= 2)
    for (int side = -1, turn = 0; turn < 2; side = 1, turn++) {
      double spread = best + side * width, error;
      if (!(spread <= 1 && spread >= 0.1))
        continue;
      error = fit_linear(frame, base, ridge, spread, &kept, fibres, work, response);
      if (error < least) {
        least = error;
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
  candidates c = {0};
  c.count = axes->fibres;
  memset(axes->response, 0, sizeof axes->response);
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double at[3], gradient[9 * BWI_SHAPES], strain[6 * BWI_SHAPES];
    for (int f = 0; f < axes->fibres; f++)
      memcpy(c.direction[k][f], axes->direction[k][f], 3 * sizeof(double));
    bwi_octant_point(k, axes->spread, at);
    bwi_frame18_gradient(frame, at, gradient);
    strains(gradient, strain);
    octant_stiffness(BWI_OCTANTS * (2 + axes->fibres), k, axes->constant, strain, &c,
                     axes->response);
  }
}
