/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Building the linear program from a pressure basis and a DOF map's rigid-body modes, and judging a
 * vertex that a solver ended at. See linear_program.h for the form. */
#include "analysis/linear_program.h"
#include "model/internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Balance directions in which all pressures together reach less than this fraction of the natural
 * size (force times lever arm) are fulfilled by every pressure: their rows would only hold
 * rounding. */
static const double negligible_row = 1e-9;
static const double smallest_motion = 1e-3;
/* A sample below this many columns is not worth a level of its own. */
enum { LEVEL_FACTOR = 8, LEVEL_SMALLEST = 600 };

void bwi_linear_program_destroy(bwi_linear_program *program) {
  if (!program)
    return;
  bw_free(program->entry);
  bw_free(program->upper);
  bw_free(program->source);
  bw_free(program->area);
  bw_free(program->first_row);
  bw_free(program->row_count);
  bw_free(program->group_start);
  bw_free(program->group);
  bw_free(program->segment);
  bw_free(program->body);
  bw_free(program);
}

/* ---- columns in levels and segments -------------------------------------------------------- */

static uint32_t scatter(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ x >> 16;
}

/* The coarsest level (0) that holds node j. */
static int level_of(int32_t j, int levels) {
  uint32_t h = scatter((uint32_t)j + 1);
  int level = levels - 1;
  while (level > 0 && h % LEVEL_FACTOR == 0) {
    h /= LEVEL_FACTOR;
    level--;
  }
  return level;
}

/* Counting sort of the columns by level, then body, then number; segments and `source`. */
static bw_status order_columns(bw_context *context, bwi_linear_program *program,
                               const bw_pressure_basis *basis, bool slack) {
  int32_t n = basis->count, bodies = basis->mesh->component_count;
  int32_t *place = NULL;
  program->levels = 1;
  for (int64_t size = n / basis->directions / LEVEL_FACTOR;
       size >= LEVEL_SMALLEST && program->levels < BWI_TWO_LEVEL; size /= LEVEL_FACTOR)
    program->levels++;
  size_t groups = (size_t)program->levels * (size_t)bodies;
  place = BW_NEW0(context, int32_t, groups + 1);
  program->segment = BW_NEW0(context, bwi_segment, groups + 1);
  if (!place || !program->segment) {
    bw_free(place);
    return BW_MEMORY;
  }
  const int32_t *component = basis->mesh->component;
  for (int32_t j = 0; j < n; j++)
    place[(size_t)level_of(j / basis->directions, program->levels) * (size_t)bodies +
          (size_t)component[basis->node[j]]]++;
  int32_t at = 0;
  for (int level = 0; level < program->levels; level++) {
    if (level == 0 && slack) {
      program->source[0] = -1;
      program->segment[program->segment_count++] = (bwi_segment){0, 1, 0, 0};
      at = 1;
    }
    for (int32_t body = 0; body < bodies; body++) {
      size_t group = (size_t)level * (size_t)bodies + (size_t)body;
      int32_t size = place[group];
      place[group] = at;
      at += size;
      if (size == 0)
        continue;
      bwi_segment *segment = &program->segment[program->segment_count++];
      *segment = (bwi_segment){at - size, at, 0, 0};
      for (int32_t k = 0; k < program->body_count; k++)
        if (program->body[k].component == body) {
          segment->row = program->body[k].row;
          segment->rows = program->body[k].rows;
        }
    }
    program->level_end[level] = at;
    program->level_segments[level] = program->segment_count;
  }
  for (int32_t j = 0; j < n; j++)
    program
        ->source[place[(size_t)level_of(j / basis->directions, program->levels) * (size_t)bodies +
                       (size_t)component[basis->node[j]]]++] = j;
  bw_free(place);
  return BW_OK;
}

/* Columns of a node are neighbours: order_columns keeps them together. */
static void group_columns(bwi_linear_program *program) {
  for (int32_t j = 0; j < program->columns; program->groups++) {
    int32_t size = program->source[j] < 0 ? 1 : program->directions;
    program->group_start[program->groups] = j;
    for (int32_t k = 0; k < size; k++)
      program->group[j++] = program->groups;
  }
  program->group_start[program->groups] = program->columns;
}

/* ---- balance rows -------------------------------------------------------------------------- */

/* <motion, G e_j> / A_j for the body's motions. */
static void raw_rows(const bw_pressure_basis *basis, const bw_dof_map *dof_map,
                     const bwi_balance *body, int32_t j, double raw[BWI_LOCAL_ROWS]) {
  for (int m = 0; m < body->motions; m++) {
    const bw_rigid_mode *motion = &dof_map->rigid_mode[body->motion[m]];
    double sum = 0;
    for (int64_t k = basis->start[j]; k < basis->start[j + 1]; k++) {
      double u[3];
      bwi_motion_at(motion, basis->mesh->node + 3 * (size_t)basis->row[k], u);
      sum += bw_dot(u, basis->coefficient + 3 * k);
    }
    raw[m] = sum / basis->area[j];
  }
}

void bwi_column_motions(const bw_pressure_basis *basis, const bw_dof_map *dof_map, double *work) {
  size_t n = (size_t)basis->count;
  for (int32_t m = 0; m < dof_map->rigid_mode_count; m++) {
    const bw_rigid_mode *motion = &dof_map->rigid_mode[m];
    for (size_t j = 0; j < n; j++) {
      double sum = 0;
      if (basis->mesh->component[basis->node[j]] == motion->component)
        for (int64_t k = basis->start[j]; k < basis->start[j + 1]; k++) {
          double u[3];
          bwi_motion_at(motion, basis->mesh->node + 3 * (size_t)basis->row[k], u);
          sum += bw_dot(u, basis->coefficient + 3 * k);
        }
      work[(size_t)m * n + j] = sum;
    }
  }
}

/* Eigenvalues (diagonal of a) and eigenvectors (rows of v) of a small symmetric matrix, by cyclic
 * Jacobi rotations. */
static void jacobi(int n, double a[BWI_LOCAL_ROWS][BWI_LOCAL_ROWS],
                   double v[BWI_LOCAL_ROWS][BWI_LOCAL_ROWS]) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      v[i][j] = i == j;
  for (int sweep = 0; sweep < 40; sweep++) {
    double off = 0, on = 0;
    for (int i = 0; i < n; i++) {
      on += a[i][i] * a[i][i];
      for (int j = 0; j < i; j++)
        off += a[i][j] * a[i][j];
    }
    if (off <= 1e-40 * on)
      return;
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) {
        if (a[p][q] == 0)
          continue;
        double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(1 + theta * theta));
        double c = 1 / sqrt(1 + t * t), s = t * c;
        for (int k = 0; k < n; k++) {
          double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y;
          a[k][q] = s * x + c * y;
        }
        for (int k = 0; k < n; k++) {
          double x = a[p][k], y = a[q][k], f = v[p][k], g = v[q][k];
          a[p][k] = c * x - s * y;
          a[q][k] = s * x + c * y;
          v[p][k] = c * f - s * g;
          v[q][k] = s * f + c * g;
        }
      }
  }
}

/* Orthonormal combinations of a body's rows, weighted with A, without those that are negligible. */
static void orthonormalise(const bw_pressure_basis *basis, const bw_dof_map *dof_map,
                           bwi_balance *body) {
  int n = body->motions;
  double natural[BWI_LOCAL_ROWS] = {0}, gram[BWI_LOCAL_ROWS][BWI_LOCAL_ROWS] = {{0}};
  double vector[BWI_LOCAL_ROWS][BWI_LOCAL_ROWS], square[BWI_LOCAL_ROWS] = {0}, area = 0;
  for (int32_t j = 0; j < basis->count; j++) {
    if (basis->mesh->component[basis->node[j]] != body->component)
      continue;
    for (int m = 0; m < n; m++) {
      double u[3];
      bwi_motion_at(&dof_map->rigid_mode[body->motion[m]],
                    basis->mesh->node + 3 * (size_t)basis->node[j], u);
      natural[m] = fmax(natural[m], bw_norm(u));
    }
  }
  /* The motions move a body by about 1. Few nodes, near an axis, hardly move with that rotation. */
  for (int m = 0; m < n; m++)
    natural[m] = fmax(natural[m], smallest_motion);
  for (int32_t j = 0; j < basis->count; j++) {
    double raw[BWI_LOCAL_ROWS];
    if (basis->mesh->component[basis->node[j]] != body->component)
      continue;
    raw_rows(basis, dof_map, body, j, raw);
    area += basis->area[j];
    for (int m = 0; m < n; m++)
      for (int k = 0; k < n; k++)
        gram[m][k] += basis->area[j] * raw[m] / natural[m] * (raw[k] / natural[k]);
  }
  jacobi(n, gram, vector);
  /* Eigenvalues are exact to rounding of the largest: the size of a combination that should vanish
   * is that of the combination itself. */
  for (int32_t j = 0; j < basis->count; j++) {
    double raw[BWI_LOCAL_ROWS];
    if (basis->mesh->component[basis->node[j]] != body->component)
      continue;
    raw_rows(basis, dof_map, body, j, raw);
    for (int i = 0; i < n; i++) {
      double sum = 0;
      for (int m = 0; m < n; m++)
        sum += vector[i][m] * raw[m] / natural[m];
      square[i] += basis->area[j] * sum * sum;
    }
  }
  body->rows = 0;
  for (int i = 0; i < n; i++) {
    double size = area > 0 ? sqrt(square[i] / area) : 0;
    if (!(size > negligible_row))
      continue;
    for (int m = 0; m < n; m++)
      body->transform[body->rows][m] = vector[i][m] / natural[m] / size;
    body->rows++;
  }
}

static bw_status make_bodies(bw_context *context, bwi_linear_program *program,
                             const bw_pressure_basis *basis, const bw_dof_map *dof_map) {
  program->rigid_mode_count = dof_map->rigid_mode_count;
  program->body = BW_NEW0(context, bwi_balance, dof_map->rigid_mode_count + 1);
  if (!program->body)
    return BW_MEMORY;
  for (int32_t m = 0; m < dof_map->rigid_mode_count; m++) {
    int32_t k = 0;
    while (k < program->body_count &&
           program->body[k].component != dof_map->rigid_mode[m].component)
      k++;
    bwi_balance *body = &program->body[k];
    if (k == program->body_count) {
      program->body_count++;
      body->component = dof_map->rigid_mode[m].component;
    }
    if (body->motions == BWI_LOCAL_ROWS)
      return bw_fail(context, BW_INTERNAL, "body %d has more than six rigid-body motions",
                     body->component);
    body->motion[body->motions++] = m;
  }
  for (int32_t k = 0; k < program->body_count; k++) {
    program->body[k].row = program->rows;
    orthonormalise(basis, dof_map, &program->body[k]);
    program->rows += program->body[k].rows;
  }
  program->rows++; /* the fractions */
  return BW_OK;
}

/* ---- the whole ----------------------------------------------------------------------------- */

static bw_status check_options(bw_context *context, const bw_pressure_basis *basis,
                               const bw_worst_load_options *options) {
  double area = 0;
  if (!(options->pressure > 0) || isinf(options->pressure))
    return bw_fail(context, BW_INVALID, "the largest pressure is %g Pa: it must be positive",
                   options->pressure);
  if (!(options->force > 0) || isinf(options->force))
    return bw_fail(context, BW_INVALID, "the total force is %g N: it must be positive",
                   options->force);
  if (basis->count < 1)
    return bw_fail(context, BW_INVALID, "the mesh has no boundary for pressures");
  for (int32_t j = 0; j < basis->count; j += basis->directions)
    area += basis->area[j];
  if (!options->force_is_max && options->force > options->pressure * area) {
    bw_status status = bw_fail(context, BW_INFEASIBLE,
                               "a total force of %g N was requested, but a pressure of at most %g "
                               "Pa on the whole admissible surface, %g m2, gives %g N: raise the "
                               "pressure (a smaller contact) or lower the force",
                               options->force, options->pressure, area, options->pressure * area);
    bw_detail_number(context, "force", options->force);
    bw_detail_number(context, "largest_force", options->pressure * area);
    return status;
  }
  return BW_OK;
}

bw_status bwi_linear_program_create(bw_context *context, const bw_pressure_basis *basis,
                                    const bw_dof_map *dof_map, const bw_worst_load_options *options,
                                    bwi_linear_program **result) {
  bw_status status = check_options(context, basis, options);
  if (status != BW_OK)
    return status;
  bwi_linear_program *program = BW_NEW0(context, bwi_linear_program, 1);
  if (!program)
    return BW_MEMORY;
  size_t n = (size_t)basis->count + (options->force_is_max ? 1 : 0);
  program->columns = (int32_t)n;
  program->force = options->force;
  program->pressure = options->pressure;
  program->entry = BW_NEW0(context, double, BWI_LOCAL_ROWS *n);
  program->upper = BW_NEW(context, double, n);
  program->source = BW_NEW(context, int32_t, n);
  program->area = BW_NEW(context, double, n);
  program->first_row = BW_NEW0(context, int32_t, n);
  program->row_count = BW_NEW0(context, int32_t, n);
  program->directions = basis->directions;
  program->group_start = BW_NEW(context, int32_t, n + 1);
  program->group = BW_NEW(context, int32_t, n);
  if (!program->group_start || !program->group || !program->entry || !program->upper ||
      !program->source || !program->area || !program->first_row || !program->row_count) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(make_bodies(context, program, basis, dof_map));
  BW_TRY(order_columns(context, program, basis, options->force_is_max));
  group_columns(program);
  for (int32_t s = 0; s < program->segment_count; s++) {
    const bwi_segment *segment = &program->segment[s];
    const bwi_balance *body = NULL;
    for (int32_t k = 0; k < program->body_count && segment->rows > 0; k++)
      if (program->body[k].row == segment->row && program->body[k].rows > 0)
        body = &program->body[k];
    for (int32_t j = segment->begin; j < segment->end; j++) {
      int32_t from = program->source[j];
      program->area[j] = from < 0 ? 1 : basis->area[from];
      program->upper[j] = from < 0 ? 1 : program->area[j] * (options->pressure / options->force);
      program->first_row[j] = segment->row;
      program->row_count[j] = segment->rows;
      if (!body)
        continue;
      double raw[BWI_LOCAL_ROWS];
      raw_rows(basis, dof_map, body, from, raw);
      for (int l = 0; l < body->rows; l++) {
        double sum = 0;
        for (int m = 0; m < body->motions; m++)
          sum += body->transform[l][m] * raw[m];
        program->entry[(size_t)l * n + (size_t)j] = sum;
      }
    }
  }
done:
  if (status == BW_OK)
    *result = program;
  else
    bwi_linear_program_destroy(program);
  return status;
}

/* ---- judging a vertex ---------------------------------------------------------------------- */

static void add_column(const bwi_linear_program *program, int32_t j, double factor, double *sum) {
  for (int32_t l = 0; l < program->row_count[j]; l++)
    sum[program->first_row[j] + l] +=
        factor * program->entry[(size_t)l * (size_t)program->columns + (size_t)j];
  sum[program->rows - 1] += factor;
}

/* The column at the upper bound in the group of basic column j, or -1. */
static int32_t full_column(const bwi_linear_program *program, const bwi_vertex *vertex, int32_t j) {
  int32_t g = program->group[j];
  for (int32_t k = program->group_start[g]; k < program->group_start[g + 1]; k++)
    if (k != j && vertex->at_upper[k])
      return k;
  return -1;
}

/* b - A t. */
static void residual(const bwi_linear_program *program, const double *fraction, double *rest) {
  int32_t m = program->rows;
  for (int32_t i = 0; i < m; i++)
    rest[i] = i == m - 1;
  for (int32_t j = 0; j < program->columns; j++)
    if (fraction[j] != 0)
      add_column(program, j, -fraction[j], rest);
}

bw_status bwi_linear_program_evaluate(bw_context *context, const bwi_linear_program *program,
                                      const double *cost, const bwi_vertex *vertex,
                                      bwi_solution *solution) {
  bw_status status = BW_OK;
  int32_t m = program->rows, n = program->columns;
  double *fraction = solution->fraction, *y = solution->multiplier;
  double *basis = BW_NEW0(context, double, (size_t)m *(size_t)m);
  double *rest = BW_NEW(context, double, m), *x = BW_NEW(context, double, m);
  int32_t *pivot = BW_NEW(context, int32_t, m), *full = BW_NEW(context, int32_t, m);
  if (!basis || !rest || !x || !pivot || !full) {
    status = BW_MEMORY;
    goto done;
  }
  solution->value = 0;
  solution->violation = solution->gap = INFINITY;
  for (int32_t j = 0; j < n; j++)
    fraction[j] = vertex->at_upper[j] ? program->upper[j] : 0;
  for (int32_t i = 0; i < m; i++) {
    /* The transpose of the basis is filled: column i as row i. */
    double *column = basis + (size_t)i * (size_t)m;
    if (vertex->basic[i] < 0) {
      column[-1 - vertex->basic[i]] = 1;
    } else {
      add_column(program, vertex->basic[i], 1, column);
      fraction[vertex->basic[i]] = 0;
    }
    y[i] = vertex->basic[i] < 0 ? 0 : cost[vertex->basic[i]];
    full[i] = vertex->basic[i] < 0 ? -1 : full_column(program, vertex, vertex->basic[i]);
    if (full[i] >= 0) {
      add_column(program, full[i], -1, column);
      y[i] -= cost[full[i]];
    }
  }
  if (!bwi_dense_factor(m, basis, pivot))
    goto done;
  bwi_dense_solve(m, basis, pivot, y); /* B^T y = c_B */

  /* Basic values, with one step of refinement: x on top of what the fractions already hold. */
  double artificial = 0;
  for (int pass = 0; pass < 2; pass++) {
    residual(program, fraction, rest);
    if (pass == 1)
      for (int32_t i = 0; i < m; i++)
        if (vertex->basic[i] < 0)
          rest[-1 - vertex->basic[i]] -= x[i];
    double *step = rest;
    bwi_dense_solve_transposed(m, basis, pivot, step); /* B step = rest */
    for (int32_t i = 0; i < m; i++) {
      x[i] = pass == 0 ? step[i] : x[i] + step[i];
      if (vertex->basic[i] >= 0)
        fraction[vertex->basic[i]] = x[i];
      if (full[i] >= 0)
        fraction[full[i]] -= step[i];
    }
  }
  double violation = 0;
  for (int32_t i = 0; i < m; i++) {
    int32_t j = vertex->basic[i];
    if (j < 0) {
      artificial = fmax(artificial, fabs(x[i]));
      continue;
    }
    violation = fmax(violation, fmax(-fraction[j], fraction[j] - program->upper[j]));
    fraction[j] = fmin(fmax(fraction[j], 0), program->upper[j]);
    if (full[i] >= 0) {
      violation = fmax(violation, -fraction[full[i]]);
      fraction[full[i]] = fmax(fraction[full[i]], 0);
    }
  }
  residual(program, fraction, rest);
  for (int32_t i = 0; i < m; i++)
    violation = fmax(violation, fabs(rest[i]));
  solution->violation = fmax(violation, artificial);

  /* Weak duality: the multipliers bound every feasible value from above. */
  double bound = y[m - 1], value = 0, largest = 0;
  for (int32_t g = 0; g < program->groups; g++) {
    double max = 0;
    for (int32_t j = program->group_start[g]; j < program->group_start[g + 1]; j++) {
      double reduced = cost[j] - y[m - 1];
      for (int32_t l = 0; l < program->row_count[j]; l++)
        reduced -= y[program->first_row[j] + l] * program->entry[(size_t)l * (size_t)n + (size_t)j];
      max = fmax(max, reduced);
      value += cost[j] * fraction[j];
      largest = fmax(largest, fabs(cost[j]));
    }
    if (max > 0)
      bound += program->upper[program->group_start[g]] * max;
  }
  solution->value = value;
  solution->gap = largest > 0 ? fabs(bound - value) / (fabs(value) + 1e-3 * largest) : 0;
done:
  bw_free(basis);
  bw_free(rest);
  bw_free(x);
  bw_free(pivot);
  bw_free(full);
  return status;
}
