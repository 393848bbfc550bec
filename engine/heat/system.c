/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The equations of heat, and their solution in time and temperature: Newton's method for radiation,
 * Picard's for conductivity by temperature, so that every matrix is symmetric and positive
 * definite.
 *
 * The matrix changes little between iterations and steps. The inverse of an earlier one stays as
 * the preconditioner of conjugate gradients as long as these are short. */
#include "heat/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DIRECT_UNKNOWNS = 100000, LAGGED_ITERATIONS = 12 };

void bw_heat_options_default(bw_heat_options *options) {
  *options = (bw_heat_options){.tolerance = 1e-10, .max_iterations = 100};
}

/* ---- what is known --------------------------------------------------------------------------- */

static bw_status number_unknowns(bw_context *context, bwi_heat_system *s) {
  const bw_mesh *mesh = s->heat->mesh;
  int64_t twice = 0;
  s->unknown = BW_NEW(context, int32_t, mesh->node_count);
  s->prescribe = BW_NEW(context, int32_t, mesh->node_count);
  s->node = BW_NEW(context, int32_t, mesh->node_count);
  if (!s->unknown || !s->prescribe || !s->node)
    return BW_MEMORY;
  for (int32_t i = 0; i < mesh->node_count; i++)
    s->prescribe[i] = -1;
  for (int c = 0; c < s->heat->condition_count; c++) {
    const bw_heat_condition *condition = &s->heat->condition[c];
    if (condition->kind != BW_HEAT_TEMPERATURE)
      continue;
    for (int32_t k = 0; k < condition->on->node_count; k++) {
      int32_t *by = &s->prescribe[condition->on->node[k]];
      twice += *by >= 0 && s->heat->condition[*by].value != condition->value && !condition->nodal;
      *by = c;
    }
  }
  if (twice)
    bw_warn(context, "%lld nodes have two prescribed temperatures: the later one counts",
            (long long)twice);
  for (int32_t i = 0; i < mesh->node_count; i++)
    s->unknown[i] = s->prescribe[i] < 0 ? 0 : -1;
  for (int c = 0; c < s->heat->condition_count; c++) {
    const bw_bond *bond = s->heat->condition[c].bond;
    for (int32_t i = 0; bond && i < bond->node_count; i++)
      s->unknown[bond->node[i]] = -1;
  }
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (s->unknown[i] == 0) {
      s->unknown[i] = s->unknowns;
      s->node[s->unknowns++] = i;
    }
  return BW_OK;
}

/* A node that follows others and has a prescribed temperature follows none. */
static bw_status make_expand(bw_context *context, bwi_heat_system *s) {
  bw_status status = BW_OK;
  int32_t n = s->heat->mesh->node_count;
  bwi_entries entries = {0};
  bool joined = false;
  for (int c = 0; c < s->heat->condition_count; c++) {
    const bw_bond *bond = s->heat->condition[c].bond;
    joined = joined || bwi_heat_joins(&s->heat->condition[c]);
    for (int32_t i = 0; bond && i < bond->node_count; i++)
      for (int64_t e = bond->follows->start[i]; e < bond->follows->start[i + 1]; e++) {
        int32_t unknown = s->unknown[bond->follows->column[e]];
        if (s->prescribe[bond->node[i]] < 0 && unknown >= 0)
          BW_TRY(
              bwi_entries_add(context, &entries, bond->node[i], unknown, bond->follows->value[e]));
      }
  }
  if (!joined)
    goto done;
  for (int32_t r = 0; r < s->unknowns; r++)
    BW_TRY(bwi_entries_add(context, &entries, s->node[r], r, 1));
  BW_TRY(bwi_entries_matrix(context, &entries, n, s->unknowns, &s->expand));
done:
  bwi_entries_clear(&entries);
  return status;
}

/* Every body needs a temperature to which it tends. */
static bw_status check_steady(bw_context *context, const bwi_heat_system *s) {
  const bw_mesh *mesh = s->heat->mesh;
  bw_status status = BW_OK;
  uint8_t *steady = BW_NEW0(context, uint8_t, mesh->component_count);
  BW_TRY_MEMORY(steady);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (s->prescribe[i] >= 0)
      steady[mesh->component[i]] = 1;
  for (int c = 0; c < s->heat->condition_count; c++) {
    const bw_heat_condition *condition = &s->heat->condition[c];
    for (int32_t f = 0; bwi_heat_is_film(condition) && condition->coefficient > 0 &&
                        f < condition->on->facet_count;
         f++)
      steady
          [mesh->component[mesh->facet[(int64_t)condition->on->facet[f] * mesh->nodes_per_facet]]] =
              1;
  }
  for (bool found = true; found;) { /* through contacts and bonds to other bodies */
    found = false;
    for (int c = 0; c < s->heat->condition_count; c++) {
      const bw_bond *bond = s->heat->condition[c].bond;
      const bw_sparse_matrix *joint = bond ? bond->follows : s->heat->condition[c].joint;
      for (int32_t i = 0; joint && i < joint->rows; i++)
        for (int64_t e = joint->start[i]; e < joint->start[i + 1]; e++) {
          if (bond && s->prescribe[bond->node[i]] >= 0)
            continue; /* it follows none */
          uint8_t *one = &steady[mesh->component[bond ? bond->node[i] : i]];
          uint8_t *other = &steady[mesh->component[joint->column[e]]];
          found = found || *one != *other;
          *one = *other = *one | *other;
        }
    }
  }
  for (int32_t b = 0; b < mesh->component_count; b++)
    if (!steady[b]) {
      status =
          bw_fail(context, BW_UNCONSTRAINED,
                  "body %d of %d has no steady temperature: prescribe one, or give convection, "
                  "radiation, or contact or a bond with a body that has one",
                  b + 1, mesh->component_count);
      bw_detail_number(context, "body", b + 1);
      goto done;
    }
done:
  bw_free(steady);
  return status;
}

/* ---- the way of solving ---------------------------------------------------------------------- */

/* Makes of the solver that is given, or of none, one whose kind and preconditioner are named. */
static bw_status choose_solver(bw_context *context, bwi_heat_system *s) {
  const bw_solver *given = s->options.solver;
  bool quadratic = s->heat->mesh->order == 2;
  bw_status status = BW_OK;
  bw_solver *preconditioner = NULL;
  bw_solver_kind way = quadratic ? BW_SOLVER_TWO_LEVEL : BW_SOLVER_JACOBI;
  bw_solver_options inner = {0}, outer = {.kind = BW_SOLVER_PCG};
  if (given && given->options.kind == BW_SOLVER_PCG) {
    outer = given->options;
    if (outer.preconditioner) {
      inner = outer.preconditioner->options;
      way = inner.kind;
    }
  } else if (given) {
    inner = given->options;
    way = inner.kind == BW_SOLVER_CHOLESKY ? BW_SOLVER_CHOLESKY : BW_SOLVER_LU; /* refused below */
  } else if (s->unknowns <= DIRECT_UNKNOWNS)
    way = BW_SOLVER_CHOLESKY;
  if (inner.backend == BW_BACKEND_PETSC || !(way == BW_SOLVER_CHOLESKY || way == BW_SOLVER_JACOBI ||
                                             (way == BW_SOLVER_TWO_LEVEL && quadratic))) {
    char text[BW_SOLVER_TEXT];
    bw_solver_describe(given, text);
    return bw_fail(context, BW_UNSUPPORTED,
                   "%s does not serve heat on %s elements: give bw.solver.cholesky, or "
                   "bw.solver.pcg with the preconditioner jacobi%s or cholesky",
                   text, quadratic ? "quadratic" : "linear", quadratic ? ", two_level" : "");
  }
  inner.kind = way;
  BW_TRY(bw_solver_create(context, &inner, &preconditioner));
  outer.preconditioner = preconditioner;
  if (way == BW_SOLVER_CHOLESKY && !(outer.tolerance > 0))
    outer.tolerance = 1e-12;
  BW_TRY(bw_solver_create(context, &outer, &s->solver));
  if (given)
    snprintf(s->report.reason, sizeof s->report.reason, "it was given");
  else
    snprintf(s->report.reason, sizeof s->report.reason,
             way == BW_SOLVER_CHOLESKY ? "a factor serves up to %d unknowns"
                                       : "a factor of more than %d unknowns is large",
             (int)DIRECT_UNKNOWNS);
done:
  bw_release(preconditioner);
  return status;
}

/* Density times heat capacity of each element, at pairs of nodes or lumped. */
static bw_status add_capacity(bw_context *context, bwi_heat_system *s, bool lumped) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->heat->mesh;
  double *nodal = NULL, *per_volume = BW_NEW(context, double, mesh->element_count);
  s->capacity = BW_NEW0(context, double, s->pattern->block_count);
  BW_TRY_MEMORY(per_volume && s->capacity);
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const bw_material *own = bw_material_of(s->heat->material, e);
    per_volume[e] = own->density * own->thermal.heat_capacity;
  }
  if (lumped) {
    nodal = BW_NEW(context, double, mesh->node_count);
    BW_TRY_MEMORY(nodal);
    BW_TRY(bw_lumped_mass(context, mesh, per_volume, nodal));
    for (int32_t i = 0; i < mesh->node_count; i++)
      s->capacity[s->pattern->start[i + 1] - 1] = nodal[i];
  } else
    BW_TRY(bw_weighted_mass(context, s->pattern, mesh, per_volume, s->capacity));
done:
  bw_free(nodal);
  bw_free(per_volume);
  return status;
}

bw_status bwi_heat_system_open(bw_context *context, const bw_heat *heat,
                               const bw_heat_options *options, bool transient, bool lumped,
                               bwi_heat_system *s) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = heat->mesh;
  const bw_material *material = heat->material;
  int volumes = 0;
  *s = (bwi_heat_system){.heat = heat};
  bw_heat_options_default(&s->options);
  if (options) {
    s->options.solver = options->solver;
    s->options.guess = options->guess;
    s->options.error = options->error;
    if (options->tolerance != 0)
      s->options.tolerance = options->tolerance;
    if (options->max_iterations != 0)
      s->options.max_iterations = options->max_iterations;
  }
  if (!(s->options.tolerance > 0 && s->options.tolerance < 1) || s->options.max_iterations < 1)
    return bw_fail(context, BW_INVALID,
                   "heat: a tolerance between 0 and 1 and at least one iteration expected, got %g "
                   "and %d",
                   s->options.tolerance, s->options.max_iterations);
  BW_TRY(number_unknowns(context, s));
  if (!transient)
    BW_TRY(check_steady(context, s));
  BW_TRY(choose_solver(context, s));
  BW_TRY(make_expand(context, s));
  s->through = BW_NEW0(context, double, heat->condition_count);
  BW_TRY_MEMORY(s->through);
  BW_TRY(bw_block_pattern_create(context, mesh, &s->pattern));
  s->by_temperature = bwi_heat_varies(material);
  s->conduction = BW_NEW0(context, double, s->pattern->block_count);
  BW_TRY_MEMORY(s->conduction);
  if (!s->by_temperature)
    BW_TRY(bwi_heat_conduct(context, s->pattern, mesh, material, NULL, s->conduction));
  for (int c = 0; c < heat->condition_count; c++) {
    const bw_heat_condition *condition = &heat->condition[c];
    volumes += !condition->on;
    if (condition->kind == BW_HEAT_RADIATION && !(condition->about > 0))
      s->radiates = true;
    if (condition->kind != BW_HEAT_CONVECTION && !condition->joint)
      continue;
    if (!s->films)
      s->films = BW_NEW0(context, double, s->pattern->block_count);
    BW_TRY_MEMORY(s->films);
    if (condition->joint)
      BW_TRY(bwi_heat_join(context, s->pattern, condition, s->films, &s->cross));
    else
      bwi_heat_film(s->pattern, mesh, condition, NULL, s->films);
  }
  s->volume = BW_NEW(context, double, (size_t)volumes *(size_t)mesh->node_count);
  BW_TRY_MEMORY(s->volume);
  volumes = 0;
  for (int c = 0; c < heat->condition_count; c++)
    if (!heat->condition[c].on)
      BW_TRY(bwi_heat_volume(context, mesh, heat->condition[c].nodal,
                             s->volume + (size_t)volumes++ * (size_t)mesh->node_count));
  if (transient)
    BW_TRY(add_capacity(context, s, lumped));
done:
  return status;
}

void bwi_heat_system_close(bwi_heat_system *s) {
  bw_release(s->solver);
  bw_release(s->pattern);
  bw_release(s->matrix);
  bw_release(s->inverse);
  bw_free(s->unknown);
  bw_free(s->prescribe);
  bw_free(s->node);
  bw_free(s->conduction);
  bw_free(s->films);
  bwi_entries_clear(&s->cross);
  bw_release(s->expand);
  bw_free(s->through);
  bw_free(s->capacity);
  bw_free(s->volume);
}

/* The temperatures of nodes that follow others. */
static void follow(const bwi_heat_system *s, double *temperature) {
  for (int c = 0; c < s->heat->condition_count; c++) {
    const bw_bond *bond = s->heat->condition[c].bond;
    for (int32_t i = 0; bond && i < bond->node_count; i++) {
      if (s->prescribe[bond->node[i]] >= 0)
        continue;
      double sum = 0;
      for (int64_t e = bond->follows->start[i]; e < bond->follows->start[i + 1]; e++)
        sum += bond->follows->value[e] * temperature[bond->follows->column[e]];
      temperature[bond->node[i]] = sum;
    }
  }
}

/* Moves heat from nodes that follow others to these. */
static void gather(bwi_heat_system *s, double *heat) {
  for (int c = 0; c < s->heat->condition_count; c++) {
    const bw_bond *bond = s->heat->condition[c].bond;
    s->through[c] = 0;
    for (int32_t i = 0; bond && i < bond->node_count; i++) {
      double *own = &heat[bond->node[i]];
      if (s->prescribe[bond->node[i]] >= 0)
        continue;
      for (int64_t e = bond->follows->start[i]; e < bond->follows->start[i + 1]; e++)
        heat[bond->follows->column[e]] += bond->follows->value[e] * *own;
      s->through[c] += *own;
      *own = 0;
    }
  }
}

void bwi_heat_prescribe(const bwi_heat_system *s, double *temperature) {
  for (int32_t i = 0; i < s->heat->mesh->node_count; i++)
    if (s->prescribe[i] >= 0) {
      const bw_heat_condition *by = &s->heat->condition[s->prescribe[i]];
      temperature[i] = by->value * (by->nodal ? bw_array_get(by->nodal, i, 0) : 1);
    }
  follow(s, temperature);
}

bw_status bwi_heat_inflow(bw_context *context, bwi_heat_system *s, const double *temperature,
                          double *q, double *heat_in) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = s->heat->mesh;
  int32_t n = mesh->node_count;
  const double *volume = s->volume;
  if (s->by_temperature) {
    memset(s->conduction, 0, (size_t)s->pattern->block_count * sizeof *s->conduction);
    BW_TRY(
        bwi_heat_conduct(context, s->pattern, mesh, s->heat->material, temperature, s->conduction));
  }
  BW_TRY(bw_block_multiply(context, s->pattern, s->conduction, 1, 1, 1, temperature, q));
  for (int32_t i = 0; i < n; i++)
    q[i] = -q[i];
  for (int c = 0; c < s->heat->condition_count; c++) {
    const bw_heat_condition *condition = &s->heat->condition[c];
    heat_in[c] = 0;
    if (!condition->on) {
      double size =
          condition->kind == BW_HEAT_POWER ? condition->value / condition->size : condition->value;
      for (int32_t i = 0; i < n; i++) {
        q[i] += size * volume[i];
        heat_in[c] += size * volume[i];
      }
      volume += n;
    } else if (condition->joint)
      bwi_heat_contact(condition, temperature, q, &heat_in[c]);
    else if (condition->kind != BW_HEAT_TEMPERATURE && !condition->bond)
      BW_TRY(bwi_heat_boundary(context, mesh, condition, temperature, q, &heat_in[c]));
  }
done:
  return status;
}

/* ---- linear systems -------------------------------------------------------------------------- */

/* part (K + films at these temperatures) + rate C. */
static void make_values(bwi_heat_system *s, const bwi_heat_task *task, const double *temperature,
                        double *values) {
  int64_t blocks = s->pattern->block_count;
  for (int64_t k = 0; k < blocks; k++)
    values[k] = s->conduction[k] + (s->films ? s->films[k] : 0);
  for (int c = 0; c < s->heat->condition_count; c++)
    if (s->heat->condition[c].kind == BW_HEAT_RADIATION)
      bwi_heat_film(s->pattern, s->heat->mesh, &s->heat->condition[c], temperature, values);
  for (int64_t k = 0; k < blocks; k++)
    values[k] = task->part * values[k] + (task->rate > 0 ? task->rate * s->capacity[k] : 0);
}

/* The rows and columns of `count` nodes, node (count), each of which has its place in the matrix in
 * `place` (node_count), or -1: both triangles. */
static bw_status reduce(bw_context *context, const bw_block_pattern *p, int32_t count,
                        const int32_t *node, const int32_t *place, const double *values,
                        bw_sparse_matrix **matrix) {
  bw_status status = BW_OK;
  int64_t *start = BW_NEW0(context, int64_t, (size_t)count + 1), used = 0;
  int32_t *column = NULL;
  double *value = NULL;
  BW_TRY_MEMORY(start);
  for (int pass = 0; pass < 2; pass++) {
    if (pass) {
      column = BW_NEW(context, int32_t, used);
      value = BW_NEW(context, double, used);
      BW_TRY_MEMORY(column && value);
    }
    used = 0;
    for (int32_t r = 0; r < count; r++) {
      int32_t i = node[r];
      start[r] = used;
      for (int64_t k = p->start[i]; k < p->start[i + 1]; k++)
        if (place[p->column[k]] >= 0) {
          if (pass)
            column[used] = place[p->column[k]], value[used] = values[k];
          used++;
        }
      for (int64_t u = p->upper_start[i]; u < p->upper_start[i + 1]; u++)
        if (place[p->upper_row[u]] >= 0) {
          if (pass)
            column[used] = place[p->upper_row[u]], value[used] = values[bw_upper_block(p, u)];
          used++;
        }
    }
    start[count] = used;
  }
  BW_TRY(bw_sparse_matrix_adopt(context, count, count, start, column, value, matrix));
  return BW_OK;
done:
  bw_free(start);
  bw_free(column);
  bw_free(value);
  return status;
}

/* The matrix of all nodes, with `part` of what joins the sides of contacts. */
static bw_status join(bw_context *context, const bwi_heat_system *s, const double *values,
                      double part, bw_sparse_matrix **matrix) {
  bw_status status = BW_OK;
  const bw_block_pattern *p = s->pattern;
  const bwi_entries *cross = &s->cross;
  int64_t used = 0, most = 2 * p->block_count + (int64_t)cross->count;
  int32_t *row = BW_NEW(context, int32_t, most), *column = BW_NEW(context, int32_t, most);
  double *value = BW_NEW(context, double, most);
  BW_TRY_MEMORY(row && column && value);
  for (int32_t i = 0; i < p->node_count; i++)
    for (int64_t k = p->start[i]; k < p->start[i + 1]; k++) {
      int32_t j = p->column[k];
      row[used] = i, column[used] = j, value[used++] = values[k];
      if (i != j)
        row[used] = j, column[used] = i, value[used++] = values[k];
    }
  for (size_t k = 0; k < cross->count; k++)
    row[used] = cross->row[k], column[used] = cross->column[k],
    value[used++] = part * cross->value[k];
  BW_TRY(bw_sparse_matrix_create(context, p->node_count, p->node_count, used, row, column, value,
                                 matrix));
done:
  bw_free(row);
  bw_free(column);
  bw_free(value);
  return status;
}

/* Whether the matrix depends on the rate and the part of a task alone. */
static bool is_linear(const bwi_heat_system *s) {
  return !s->radiates && !s->by_temperature;
}

/* The matrix of the unknowns, where the one at hand is another. */
static bw_status need_matrix(bw_context *context, bwi_heat_system *s, const bwi_heat_task *task,
                             const double *temperature) {
  bw_status status = BW_OK;
  double *values = NULL;
  bw_sparse_matrix *joined = NULL, *matrix = NULL;
  if (s->matrix && is_linear(s) && s->rate == task->rate && s->part == task->part)
    return BW_OK;
  bw_release(s->matrix); /* before the next one takes memory */
  s->matrix = NULL;
  values = BW_NEW(context, double, s->pattern->block_count);
  BW_TRY_MEMORY(values);
  make_values(s, task, temperature, values);
  if (s->expand) {
    BW_TRY(join(context, s, values, task->part, &joined));
    BW_TRY(bwi_galerkin(context, joined, s->expand, &matrix));
  } else
    BW_TRY(reduce(context, s->pattern, s->unknowns, s->node, s->unknown, values, &matrix));
  BW_TRY(bw_operator_of_matrix(context, matrix, "the matrix of heat", &s->matrix));
  s->rate = task->rate;
  s->part = task->part;
done:
  bw_free(values);
  bw_release(joined);
  bw_release(matrix);
  return status;
}

static bw_status make_inverse(bw_context *context, bwi_heat_system *s,
                              const bw_sparse_matrix *matrix) {
  const bw_solver *way = s->solver->options.preconditioner;
  bw_release(s->inverse); /* before the next one takes memory */
  s->inverse = NULL;
  s->served = 0;
  return way->options.kind == BW_SOLVER_TWO_LEVEL
             ? bwi_heat_two_level(context, s, matrix, &s->inverse)
             : bw_operator_inverse(context, matrix, way, &s->inverse);
}

static void add_report(bwi_heat_system *s, const bw_solver_report *one, bool fresh) {
  bw_solver_report *all = &s->report;
  bw_solver_kind way = s->solver->options.preconditioner->options.kind;
  const bw_solver *given = s->options.solver;
  bool asked = given && given->options.kind == BW_SOLVER_PCG;
  bool direct = way == BW_SOLVER_CHOLESKY && fresh && !asked;
  if (!all->solver || !direct) {
    all->solver = bw_solver_word(direct ? BW_SOLVER_CHOLESKY : BW_SOLVER_PCG);
    all->preconditioner = direct ? "" : bw_solver_word(way);
  }
  all->backend = one->backend;
  all->bytes = fmax(all->bytes, one->bytes);
  all->seconds += one->seconds;
  all->residual = fmax(all->residual, one->residual);
  all->iterations += direct ? 0 : one->iterations;
}

/* A x = b for the unknowns, with the matrix of a task at these temperatures. */
static bw_status solve_linear(bw_context *context, bwi_heat_system *s, const bwi_heat_task *task,
                              const double *temperature, const double *b, double *x) {
  bw_status status = BW_OK;
  bw_solver *pcg = NULL;
  bw_solver_options options = s->solver->options;
  bw_solver_kind way = options.preconditioner->options.kind;
  bw_solver_report report;
  bool fresh = !s->inverse || way == BW_SOLVER_JACOBI;
  double start = bw_seconds();
  options.preconditioner = NULL; /* it is the inverse that is kept */
  BW_TRY(bw_solver_create(context, &options, &pcg));
  BW_TRY(need_matrix(context, s, task, temperature));
  for (;;) {
    if (fresh)
      BW_TRY(make_inverse(context, s, s->matrix->matrix));
    const bw_linear_solve_options by = {.solver = pcg, .preconditioner = s->inverse};
    status = bw_linear_solve(context, s->matrix, &by, 1, b, x, &report);
    if (status != BW_CONVERGENCE || fresh)
      break;
    bw_clear_failure(context);
    fresh = true;
  }
  BW_TRY(status);
  report.seconds = bw_seconds() - start;
  add_report(s, &report, fresh);
  if (fresh)
    s->served = report.iterations;
  else if (report.iterations >
           (way == BW_SOLVER_CHOLESKY ? LAGGED_ITERATIONS : 2 * s->served + 10)) {
    bw_release(s->inverse);
    s->inverse = NULL;
  }
done:
  bw_release(pcg);
  return status;
}

/* ---- solutions ------------------------------------------------------------------------------- */

/* remainder = rate C (T - base) - part q - rest; stored: the sum of its first term. */
static bw_status find_remainder(bw_context *context, bwi_heat_system *s, const bwi_heat_task *task,
                                const double *temperature, const double *q, double *work,
                                double *remainder, double *stored) {
  bw_status status = BW_OK;
  int32_t n = s->heat->mesh->node_count;
  *stored = 0;
  memset(remainder, 0, (size_t)n * sizeof *remainder);
  if (task->rate > 0) {
    for (int32_t i = 0; i < n; i++)
      work[i] = task->rate * (temperature[i] - task->base[i]);
    BW_TRY(bw_block_multiply(context, s->pattern, s->capacity, 1, 1, 1, work, remainder));
  }
  for (int32_t i = 0; i < n; i++) {
    *stored += remainder[i];
    remainder[i] -= task->part * q[i] + (task->rest ? task->rest[i] : 0);
  }
  gather(s, remainder);
done:
  return status;
}

/* Adds the correction; radiation takes no temperature below half of what it was. */
static double correct(const bwi_heat_system *s, const double *x, double *temperature) {
  double most = 0, largest = 0;
  for (int32_t r = 0; r < s->unknowns; r++) {
    double *t = &temperature[s->node[r]], next = *t + x[r];
    if (s->radiates && next < 0.5 * *t)
      next = 0.5 * *t;
    most = fmax(most, fabs(next - *t));
    *t = next;
  }
  follow(s, temperature);
  for (int32_t i = 0; i < s->heat->mesh->node_count; i++)
    largest = fmax(largest, fabs(temperature[i]));
  return largest > 0 ? most / largest : 0;
}

bw_status bwi_heat_solve(bw_context *context, bwi_heat_system *s, const bwi_heat_task *task,
                         double *temperature, double *q, double *heat_in, double *remainder,
                         double *stored, int *iterations, double *change) {
  bw_status status = BW_OK;
  int32_t n = s->heat->mesh->node_count;
  bool linear = is_linear(s), done = s->unknowns == 0;
  double *work = BW_NEW(context, double, 2 * (size_t)n);
  BW_TRY_MEMORY(work);
  *iterations = 0;
  *change = 0;
  while (!done) {
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_heat_inflow(context, s, temperature, q, heat_in));
    BW_TRY(find_remainder(context, s, task, temperature, q, work, remainder, stored));
    double *b = work, *x = work + n;
    for (int32_t r = 0; r < s->unknowns; r++)
      b[r] = -remainder[s->node[r]];
    BW_TRY(solve_linear(context, s, task, temperature, b, x));
    *change = correct(s, x, temperature);
    done = linear || *change <= s->options.tolerance;
    if (++*iterations >= s->options.max_iterations && !done) {
      status = bw_fail(context, BW_CONVERGENCE,
                       "the temperature still changes by %.2g of its largest after %d iterations; "
                       "%.0e was requested: give more iterations, a guess, or a smoother table of "
                       "conductivity",
                       *change, *iterations, s->options.tolerance);
      bw_detail_number(context, "iterations", *iterations);
      bw_detail_number(context, "change", *change);
      goto done;
    }
  }
  if (linear)
    *change = 0;
  BW_TRY(bwi_heat_inflow(context, s, temperature, q, heat_in));
  BW_TRY(find_remainder(context, s, task, temperature, q, work, remainder, stored));
done:
  bw_free(work);
  return status;
}

bw_status bwi_heat_dual(bw_context *context, bwi_heat_system *s, const double *temperature,
                        int32_t node, double *z) {
  bw_status status = BW_OK;
  int32_t n = s->heat->mesh->node_count;
  const bwi_heat_task task = {.part = 1};
  const bw_solver_report kept = s->report;
  double *load = BW_NEW0(context, double, n), *b = BW_NEW(context, double, 2 * (size_t)n);
  BW_TRY_MEMORY(load && b);
  memset(z, 0, (size_t)n * sizeof *z);
  load[node] = s->prescribe[node] < 0;
  gather(s, load);
  for (int32_t r = 0; r < s->unknowns; r++)
    b[r] = load[s->node[r]];
  if (s->unknowns)
    BW_TRY(solve_linear(context, s, &task, temperature, b, b + n));
  for (int32_t r = 0; r < s->unknowns; r++)
    z[s->node[r]] = b[n + r];
  follow(s, z);
done:
  s->report = kept;
  bw_free(load);
  bw_free(b);
  return status;
}
