/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Building the linear program of worst loads from a pressure basis and a DOF map's rigid-body
 * modes. See load_program.h for the form. */
#include "analysis/load_program.h"
#include "base/dense.h"
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

void bwi_load_program_destroy(bwi_load_program *program) {
  if (!program)
    return;
  bwi_linear_program_clear(&program->lp);
  bw_free(program->source);
  bw_free(program->area);
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
static bw_status order_columns(bw_context *context, bwi_load_program *program,
                               const bw_pressure_basis *basis, bool slack) {
  int32_t n = basis->count, bodies = basis->mesh->component_count;
  int32_t *place = NULL;
  program->lp.levels = 1;
  for (int64_t size = n / basis->directions / LEVEL_FACTOR;
       size >= LEVEL_SMALLEST && program->lp.levels < BWI_MAX_LEVELS; size /= LEVEL_FACTOR)
    program->lp.levels++;
  size_t groups = (size_t)program->lp.levels * (size_t)bodies;
  place = BW_NEW0(context, int32_t, groups + 1);
  program->lp.segment = BW_NEW0(context, bwi_segment, groups + 1);
  if (!place || !program->lp.segment) {
    bw_free(place);
    return BW_MEMORY;
  }
  const int32_t *component = basis->mesh->component;
  for (int32_t j = 0; j < n; j++)
    place[(size_t)level_of(j / basis->directions, program->lp.levels) * (size_t)bodies +
          (size_t)component[basis->node[j]]]++;
  int32_t at = 0;
  for (int level = 0; level < program->lp.levels; level++) {
    if (level == 0 && slack) {
      program->source[0] = -1;
      program->lp.segment[program->lp.segment_count++] = (bwi_segment){0, 1, 0, 0};
      at = 1;
    }
    for (int32_t body = 0; body < bodies; body++) {
      size_t group = (size_t)level * (size_t)bodies + (size_t)body;
      int32_t size = place[group];
      place[group] = at;
      at += size;
      if (size == 0)
        continue;
      bwi_segment *segment = &program->lp.segment[program->lp.segment_count++];
      *segment = (bwi_segment){at - size, at, 0, 0};
      for (int32_t k = 0; k < program->body_count; k++)
        if (bwi_moves(program->body[k].component, body)) {
          segment->row = program->body[k].row;
          segment->rows = program->body[k].rows;
        }
    }
    program->lp.level_end[level] = at;
    program->lp.level_segments[level] = program->lp.segment_count;
  }
  for (int32_t j = 0; j < n; j++)
    program->source[place[(size_t)level_of(j / basis->directions, program->lp.levels) *
                              (size_t)bodies +
                          (size_t)component[basis->node[j]]]++] = j;
  bw_free(place);
  return BW_OK;
}

/* Columns of a node are neighbours: order_columns keeps them together. */
static void group_columns(bwi_load_program *program, int32_t directions) {
  for (int32_t j = 0; j < program->lp.columns; program->lp.groups++) {
    int32_t size = program->source[j] < 0 ? 1 : directions;
    program->lp.group_start[program->lp.groups] = j;
    for (int32_t k = 0; k < size; k++)
      program->lp.group[j++] = program->lp.groups;
  }
  program->lp.group_start[program->lp.groups] = program->lp.columns;
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
      if (bwi_moves(motion->component, basis->mesh->component[basis->node[j]]))
        for (int64_t k = basis->start[j]; k < basis->start[j + 1]; k++) {
          double u[3];
          bwi_motion_at(motion, basis->mesh->node + 3 * (size_t)basis->row[k], u);
          sum += bw_dot(u, basis->coefficient + 3 * k);
        }
      work[(size_t)m * n + j] = sum;
    }
  }
}

/* Orthonormal combinations of a body's rows, weighted with A, without those that are negligible.
 * all: takes the rows of the body's columns. */
static void orthonormalise(const bw_pressure_basis *basis, const bw_dof_map *dof_map,
                           bwi_balance *body, double (*all)[BWI_LOCAL_ROWS]) {
  int n = body->motions;
  double natural[BWI_LOCAL_ROWS] = {0}, gram[BWI_LOCAL_ROWS][BWI_LOCAL_ROWS] = {{0}};
  double vector[BWI_LOCAL_ROWS][BWI_LOCAL_ROWS], square[BWI_LOCAL_ROWS] = {0}, area = 0;
  for (int32_t j = 0; j < basis->count; j++) {
    if (!bwi_moves(body->component, basis->mesh->component[basis->node[j]]))
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
    double *raw = all[j];
    if (!bwi_moves(body->component, basis->mesh->component[basis->node[j]]))
      continue;
    raw_rows(basis, dof_map, body, j, raw);
    area += basis->area[j];
    for (int m = 0; m < n; m++)
      for (int k = 0; k < n; k++)
        gram[m][k] += basis->area[j] * raw[m] / natural[m] * (raw[k] / natural[k]);
  }
  bwi_symmetric_eigen(n, BWI_LOCAL_ROWS, gram[0], vector[0], 2e-40, 40);
  /* Eigenvalues are exact to rounding of the largest: the size of a combination that should vanish
   * is that of the combination itself. */
  for (int32_t j = 0; j < basis->count; j++) {
    const double *raw = all[j];
    if (!bwi_moves(body->component, basis->mesh->component[basis->node[j]]))
      continue;
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

static bw_status make_bodies(bw_context *context, bwi_load_program *program,
                             const bw_pressure_basis *basis, const bw_dof_map *dof_map,
                             double (*raw)[BWI_LOCAL_ROWS]) {
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
    program->body[k].row = program->lp.rows;
    orthonormalise(basis, dof_map, &program->body[k], raw);
    program->lp.rows += program->body[k].rows;
  }
  program->lp.rows++; /* the fractions */
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

bw_status bwi_load_program_create(bw_context *context, const bw_pressure_basis *basis,
                                  const bw_dof_map *dof_map, const bw_worst_load_options *options,
                                  bwi_load_program **result) {
  bw_status status = check_options(context, basis, options);
  if (status != BW_OK)
    return status;
  bwi_load_program *program = BW_NEW0(context, bwi_load_program, 1);
  if (!program)
    return BW_MEMORY;
  double(*raw)[BWI_LOCAL_ROWS] = NULL;
  size_t n = (size_t)basis->count + (options->force_is_max ? 1 : 0);
  program->lp.columns = (int32_t)n;
  program->force = options->force;
  program->pressure = options->pressure;
  program->lp.entry = BW_NEW0(context, double, BWI_LOCAL_ROWS *n);
  program->lp.upper = BW_NEW(context, double, n);
  program->source = BW_NEW(context, int32_t, n);
  program->area = BW_NEW(context, double, n);
  program->lp.first_row = BW_NEW0(context, int32_t, n);
  program->lp.row_count = BW_NEW0(context, int32_t, n);
  program->lp.grouped = basis->directions > 1;
  program->lp.group_start = BW_NEW(context, int32_t, n + 1);
  program->lp.group = BW_NEW(context, int32_t, n);
  raw = (double(*)[BWI_LOCAL_ROWS])BW_NEW(context, double, BWI_LOCAL_ROWS *(size_t)basis->count);
  BW_TRY_MEMORY(raw && program->lp.group_start && program->lp.group && program->lp.entry &&
                program->lp.upper && program->source && program->area && program->lp.first_row &&
                program->lp.row_count);
  BW_TRY(make_bodies(context, program, basis, dof_map, raw));
  BW_TRY(order_columns(context, program, basis, options->force_is_max));
  group_columns(program, basis->directions);
  for (int32_t s = 0; s < program->lp.segment_count; s++) {
    const bwi_segment *segment = &program->lp.segment[s];
    const bwi_balance *body = NULL;
    for (int32_t k = 0; k < program->body_count && segment->rows > 0; k++)
      if (program->body[k].row == segment->row && program->body[k].rows > 0)
        body = &program->body[k];
    for (int32_t j = segment->begin; j < segment->end; j++) {
      int32_t from = program->source[j];
      program->area[j] = from < 0 ? 1 : basis->area[from];
      program->lp.upper[j] = from < 0 ? 1 : program->area[j] * (options->pressure / options->force);
      program->lp.first_row[j] = segment->row;
      program->lp.row_count[j] = segment->rows;
      if (!body)
        continue;
      for (int l = 0; l < body->rows; l++) {
        double sum = 0;
        for (int m = 0; m < body->motions; m++)
          sum += body->transform[l][m] * raw[from][m];
        program->lp.entry[(size_t)l * n + (size_t)j] = sum;
      }
    }
  }
done:
  bw_free(raw);
  if (status == BW_OK)
    *result = program;
  else
    bwi_load_program_destroy(program);
  return status;
}
