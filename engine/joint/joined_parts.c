/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Joined models whose bodies may move against one another until contact stops them, also along
 * preloads (docs/theory/contact.md, "Joined bodies"). */
#include <math.h>
#include <string.h>

#include "barwright/job.h"
#include "joint/fields.h"
#include "joint/joined_solution.h"
#include "statics/internal.h"

enum { MOST_MOTIONS = 200 /* fields of all nodes */ };

static bw_status find_motions(bw_context *context, const bw_model *model, const bw_dof_map *dof_map,
                              bwi_joined_solution *s) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = model->mesh;
  double volume = 0, *mass = NULL;
  if (s->q.rigid_count > MOST_MOTIONS)
    return bw_fail(context, BW_LIMIT,
                   "%d rigid-body modes are free, and contact of joined models takes at most %d: "
                   "add supports or bonds",
                   s->q.rigid_count, (int)MOST_MOTIONS);
  for (int32_t b = 0; b < mesh->component_count; b++)
    volume += dof_map->body_volume[b];
  BW_TRY(bwi_bonded_rigid_fields(context, model, dof_map, &s->motions, &s->motion));
  if (s->motions > 0) {
    mass = BW_NEW(context, double, s->q.pattern->block_count);
    BW_TRY_MEMORY(mass);
    BW_TRY(bw_mass(context, s->q.pattern, mesh, NULL, mass));
  }
  BW_TRY(bwi_joined_solution_weigh(context, model, mass, volume, cbrt(volume), s));
done:
  bw_free(mass);
  return status;
}

bw_status bwi_joined_parts_system(bw_context *context, const bw_model *model,
                                  const bw_solver *solver, const bwi_joined_solution **solution,
                                  bw_system **system) {
  bw_status status = BW_OK;
  bw_dof_map *dof_map = NULL;
  double start = bw_seconds();
  bwi_joined_solution *s = NULL;
  if (model->cyclic)
    return bw_model_refuse_joints(context, model);
  s = BW_NEW0(context, bwi_joined_solution, 1);
  BW_TRY_MEMORY(s);
  BW_TRY(bwi_dof_map_apart(context, model, &dof_map));
  BW_TRY(bwi_joined_open(context, model, false, NULL, &s->q));
  BW_TRY(find_motions(context, model, dof_map, s));
  *solution = s;
  s = NULL;
  BW_TRY(bwi_joined_solution_system(context, model, solver, dof_map, start,
                                    (bwi_joined_solution *)*solution, system));
done:
  bwi_joined_solution_destroy(s);
  bw_release(dof_map);
  return status;
}

bw_status bwi_joined_parts_start(bw_context *context, const bw_model *model, bw_system *system,
                                 const bwi_joined_solution *s, bw_static **out) {
  bw_status status = BW_OK;
  const bwi_reduction *r = &s->q.reduction;
  const bw_statics_options options = {.inertia_relief = true};
  int64_t size = 3 * (int64_t)model->mesh->node_count;
  bw_static *result = NULL;
  double *given = BW_NEW(context, double, size);
  BW_TRY_MEMORY(given);
  BW_TRY(bwi_static_begin(context, model, &options, r->dof_map, &result));
  BW_TRY(bwi_preload_add(context, model, r, result->force));
  bwi_point_loads(model, result->force);
  bwi_point_weights(model, result->force);
  BW_TRY(bwi_joined_multiply(context, model, &s->q, r->g, given));
  for (int64_t i = 0; i < size; i++)
    result->force[i] -= given[i];
  BW_TRY(bw_system_solve(context, system, 1, result->force, result->displacement));
  for (int64_t i = 0; i < size; i++)
    result->displacement[i] += r->g[i];
  result->system = bw_retain(system);
  *out = result;
  result = NULL;
done:
  bw_release(result);
  bw_free(given);
  return status;
}

bw_status bwi_joined_parts_static(bw_context *context, const bw_model *model,
                                  const bwi_joined_solution *s, const double *now,
                                  bw_static **out) {
  bw_status status = BW_OK;
  const bwi_reduction *r = &s->q.reduction;
  bwi_joined_equations q = s->q; /* borrowed */
  double *place = BW_NEW0(context, double, r->unknown_count);
  BW_TRY_MEMORY(place);
  for (int m = 0; m < s->motions; m++)
    place[r->t->column[r->t->start[s->at[m]]]] = now[s->at[m]];
  q.inverse = s->inverse;
  q.held = s->held;
  q.place = place;
  BW_TRY(bwi_joined_static(context, model, NULL, &q, bw_seconds(), out));
done:
  bw_free(place);
  return status;
}

static bool same_matrix(const bw_sparse_matrix *a, const bw_sparse_matrix *b) {
  size_t rows = (size_t)a->rows;
  if (a->rows != b->rows || a->columns != b->columns ||
      memcmp(a->start, b->start, (rows + 1) * sizeof *a->start) != 0)
    return false;
  size_t entries = (size_t)a->start[rows];
  return memcmp(a->column, b->column, entries * sizeof *a->column) == 0 &&
         memcmp(a->value, b->value, entries * sizeof *a->value) == 0;
}

bool bwi_joined_parts_same(const bwi_joined_solution *a, const bwi_joined_solution *b) {
  if (!a || !b)
    return a == b;
  return same_matrix(a->q.reduction.t, b->q.reduction.t) &&
         same_matrix(a->q.k->matrix, b->q.k->matrix);
}
