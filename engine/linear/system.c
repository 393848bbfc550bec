/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The equations of a body. Prescribed components are left out of the matrix; so are the isostatic
 * constraints
 * of an unconstrained body, which makes the rest positive definite: with P = 1 - R R^T W (model.h)
 *     u = P K_c^-1 P^T f
 * is the solution free of rigid-body motion for the balanced load P^T f, whichever isostatic
 * constraints are chosen. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "assemble/internal.h"
#include "barwright/job.h"
#include "linear/external.h"
#include "linear/pcg.h"
#include "linear/system_two_level.h"
#include "linear/two_level_apply.h"

static void system_destroy(void *object) {
  bw_system *system = object;
  bw_release(system->mesh);
  bw_release(system->material);
  bw_release(system->dof_map);
  bw_release(system->pattern);
  bw_release(system->factor);
  bw_release(system->two_level);
  bw_release(system->preconditioner);
  bw_release(system->solver);
  bw_release(system->external);
  bw_release(system->solution);
  bw_release(system->relaxed);
  bwi_system_forget(system);
  if (!system->shared) {
    bw_free(system->stiffness);
    bw_free(system->mass);
  }
  bw_release(system->shared);
  bw_free(system);
}

static size_t system_bytes(const void *object) {
  const bw_system *system = object;
  size_t blocks = system->pattern ? (size_t)system->pattern->block_count : 0;
  size_t numbers = (system->stiffness ? 9 : 0) + (system->mass ? 1 : 0);
  return sizeof *system + blocks * numbers * sizeof(double) + bw_bytes(system->pattern) +
         bw_bytes(system->factor) + bw_bytes(system->two_level) + bw_bytes(system->preconditioner) +
         bw_bytes(system->relaxed);
}

static const bw_kind system_kind = {"system", system_destroy, system_bytes};

bool bwi_same_topology(const bw_mesh *a, const bw_mesh *b) {
  return a == b ||
         (a->order == b->order && a->node_count == b->node_count &&
          a->element_count == b->element_count &&
          (a->element == b->element ||
           memcmp(a->element, b->element,
                  (size_t)a->element_count * (size_t)a->nodes_per_element * sizeof(int32_t)) == 0));
}

/* Nodes that take part in the order: all those of bodies with rigid-body modes (so that the order
 * also serves the matrix without isostatic constraints), and elsewhere those with an unknown. */
static void nodes_taking_part(const bw_dof_map *dof_map, uint8_t *take) {
  const bw_mesh *mesh = dof_map->mesh;
  for (int64_t i = 0; i < mesh->node_count; i++) {
    int32_t body = mesh->component[i];
    take[i] = dof_map->rigid_mode_start[body + 1] > dof_map->rigid_mode_start[body];
    for (int c = 0; c < 3; c++)
      take[i] |= dof_map->unknown[3 * i + c] >= 0;
  }
}

static bool order_fits(const bwi_order *order, bw_ordering ordering, const uint8_t *take,
                       int32_t nodes) {
  if (ordering != BW_ORDERING_AUTO && order->ordering != ordering)
    return false;
  for (int32_t i = 0; i < nodes; i++)
    if ((order->position[i] >= 0) != (take[i] != 0))
      return false;
  return true;
}

bw_status bwi_symbolic_for(bw_context *context, const bw_block_pattern *pattern,
                           const bw_dof_map *dof_map, bw_ordering ordering, int32_t subdomain_count,
                           const int32_t *element_subdomain, const bw_edits *edits,
                           bwi_symbolic *old, bwi_symbolic **symbolic) {
  bw_status status = BW_OK;
  int32_t nodes = pattern->node_count;
  bwi_order *order = NULL;
  uint8_t *take = BW_NEW(context, uint8_t, nodes);
  if (!take)
    return BW_MEMORY;
  nodes_taking_part(dof_map, take);
  if (old && order_fits(old->order, ordering, take, nodes)) {
    if (bwi_symbolic_fits(old, 3, dof_map->unknown)) {
      *symbolic = bw_retain(old);
      goto done;
    }
    order = bw_retain(old->order);
  } else if (element_subdomain && ordering == BW_ORDERING_AUTO)
    BW_TRY(bwi_order_create_subdomains(context, pattern, take, dof_map->mesh, subdomain_count,
                                       element_subdomain, edits, &order));
  else
    BW_TRY(bwi_order_create_by(context, pattern, take, ordering, &order));
  BW_TRY(bwi_symbolic_create(context, order, 3, dof_map->unknown, symbolic));
done:
  bw_free(take);
  bw_release(order);
  return status;
}

bw_status bwi_fail_singular(bw_context *context, const bw_mesh *mesh, int32_t node) {
  const double *x = mesh->node + 3 * (int64_t)node;
  bw_fail(
      context, BW_SINGULAR,
      "the stiffness is singular, or so nearly that double precision cannot tell, at node %d, "
      "(%g, %g, %g) m, although the body cannot move freely: parts that touch only in a node or an "
      "edge rotate there, elements almost without volume have almost no stiffness, and a body "
      "ten thousand times longer than thick is nearly a mechanism. Join the parts properly, or "
      "mesh again",
      node + 1, x[0], x[1], x[2]);
  bw_detail_number(context, "node", node + 1);
  bw_detail_number(context, "x", x[0]);
  bw_detail_number(context, "y", x[1]);
  bw_detail_number(context, "z", x[2]);
  return BW_SINGULAR;
}

static void begin(bw_system *system, const bw_mesh *mesh, const bw_material *material,
                  const bw_dof_map *dof_map) {
  bw_object_init(system, &system_kind);
  system->mesh = bw_retain(mesh);
  system->material = bw_retain(material);
  system->dof_map = bw_retain(dof_map);
}

bw_status bwi_system_begin(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                           const bw_dof_map *dof_map, const bw_system *previous, bw_system **out) {
  bw_status status = BW_OK;
  if (dof_map->mesh != mesh && !bwi_same_topology(dof_map->mesh, mesh))
    return bw_fail(context, BW_INVALID, "the DOF map belongs to another mesh");
  bw_system *system = BW_NEW0(context, bw_system, 1);
  if (!system)
    return BW_MEMORY;
  begin(system, mesh, material, dof_map);

  double start = bw_seconds();
  bw_progress(context, "assembly", 0);
  const char *locking = bw_locking(mesh, material);
  if (locking && (!previous || previous->material != material)) /* once, not edit after edit */
    bw_warn(context, "%s", locking);
  if (previous)
    system->pattern = bw_retain(previous->pattern);
  else
    BW_TRY(bw_block_pattern_create(context, mesh, &system->pattern));
  system->times.pattern = bw_seconds() - start;
  if (previous && previous->object.kind == system->object.kind) /* not a view: it has other bits */
    BW_TRY(bwi_system_take_over(context, previous, system));
done:
  if (status == BW_OK)
    *out = system;
  else
    bw_release(system);
  return status;
}

bw_status bw_system_stiffness(bw_context *context, bw_system *system) {
  bw_status status = bwi_need_equations(context, system);
  double start = bw_seconds();
  if (status != BW_OK || system->stiffness)
    return status;
  if (system->shared) {
    status = bw_system_stiffness(context, system->shared);
    system->stiffness = system->shared->stiffness;
    return status;
  }
  bw_progress(context, "assembly", 0);
  double *stiffness = BW_NEW(context, double, 9 * system->pattern->block_count);
  if (!stiffness)
    return BW_MEMORY;
  status = bw_stiffness(context, system->pattern, system->mesh, system->material, stiffness);
  if (status == BW_OK)
    system->stiffness = stiffness;
  else
    bw_free(stiffness);
  system->times.elements = system->mesh->element_count;
  system->times.stiffness += bw_seconds() - start;
  return status;
}

bw_status bwi_system_multiply(bw_context *context, bw_system *system, int64_t count,
                              const double *x, double *y, double *noise) {
  bw_status status = BW_OK;
  const bwi_two_level *l = system->two_level ? system->two_level->preconditioner : NULL;
  if (l && l->smoother->elements && !system->stiffness) {
    if (noise)
      *noise = bwi_two_level_noise(l, x);
    return bwi_two_level_multiply(context, l, count, x, y);
  }
  BW_TRY(bw_system_stiffness(context, system));
  if (noise)
    *noise = bwi_residual_noise(system->pattern, system->stiffness, x);
  status = bw_block_multiply(context, system->pattern, system->stiffness, 9, 3, count, x, y);
done:
  return status;
}

bw_status bwi_system_begin_external(bw_context *context, const bw_model *model,
                                    const bw_dof_map *dof_map, const bw_solver *solver,
                                    bw_system **out) {
  bw_status status = BW_OK;
  bw_system *system = BW_NEW0(context, bw_system, 1);
  if (!system)
    return BW_MEMORY;
  begin(system, model->mesh, model->material, dof_map);
  BW_TRY(bwi_external_create(context, model->material, dof_map, solver, &system->external));
  system->external_report = &system->external->report;
  bwi_external_fill_report(system->external, &system->report);
done:
  if (status == BW_OK)
    *out = system;
  else
    bw_release(system);
  return status;
}

bw_status bwi_system_by_operator(bw_context *context, const bw_model *model,
                                 const bw_dof_map *dof_map, const bw_operator *solution,
                                 bw_system **out) {
  bw_system *system = BW_NEW0(context, bw_system, 1);
  if (!system)
    return BW_MEMORY;
  begin(system, model->mesh, model->material, dof_map);
  system->solution = bw_retain(solution);
  *out = system;
  return BW_OK;
}

bw_status bwi_system_mass(bw_context *context, bw_system *system) {
  int64_t blocks = system->pattern->block_count;
  if (system->mass)
    return BW_OK;
  if (system->shared) {
    bw_status made = bwi_system_mass(context, system->shared);
    system->mass = system->shared->mass;
    return made;
  }
  double *mass = BW_NEW(context, double, blocks);
  if (!mass)
    return BW_MEMORY;
  bw_status status = bw_mass(context, system->pattern, system->mesh, system->material, mass);
  if (status != BW_OK) {
    bw_free(mass);
    return status;
  }
  system->mass = mass;
  return BW_OK;
}

/* Not even begun: memory given out but never there would end the process, or all others. */
static bw_status check_memory(bw_context *context, const bwi_symbolic *symbolic,
                              const bwi_kernels *kernels, double available) {
  double wanted =
      bwi_factor_peak_bytes(symbolic, bw_threads(context)) * (double)kernels->size / sizeof(double);
  if (wanted <= available)
    return BW_OK;
  bw_fail(context, BW_MEMORY,
          "the factor of %d unknowns takes %.3g GB of memory, more than the %.3g GB available. Use "
          "fewer elements, or a machine with more memory; a static solution needs no factor (the "
          "solver "
          "pcg), and several machines can share one (the solver cholesky with the backend petsc)",
          (int)symbolic->unknowns, wanted / 1e9, available / 1e9);
  bw_detail_number(context, "bytes", wanted);
  bw_detail_number(context, "free_bytes", available);
  return BW_MEMORY;
}

/* Whether a factor is one that the solver (NULL: any) asks for. */
static bool factor_serves(const bwi_factor *factor, const bw_solver *solver) {
  if (!factor || !solver)
    return factor != NULL;
  const bw_solver_options *o = &solver->options;
  return (o->backend == BW_BACKEND_AUTO || factor->kernels == bwi_kernels_of(solver)) &&
         (o->ordering == BW_ORDERING_AUTO || factor->symbolic->order->ordering == o->ordering);
}

/* The order for a solver's factor, which has the memory for it. */
static bw_status analyse(bw_context *context, bw_system *system, const bw_solver *solver,
                         bwi_symbolic *old, double available, bwi_symbolic **symbolic) {
  bw_status status = BW_OK;
  double start = bw_seconds();
  if (!old && system->factor)
    old = system->factor->symbolic;
  if (!old && system->two_level)
    old = system->two_level->symbolic;
  bw_progress(context, "ordering", 0);
  BW_TRY(bwi_symbolic_for(context, system->pattern, system->dof_map,
                          solver ? solver->options.ordering : BW_ORDERING_AUTO, 0, NULL, NULL, old,
                          symbolic));
  BW_TRY(check_memory(context, *symbolic, bwi_kernels_of(solver), available));
  system->times.order += bw_seconds() - start;
done:
  return status;
}

void bwi_report_way(const bw_system *system, bwi_way way, const bw_solver *solver,
                    bw_solver_report *report) {
  const bwi_preconditioner *m = system->preconditioner;
  const bwi_two_level_solver *l = system->two_level;
  const bwi_factor *factor = way == BWI_BY_FACTOR ? system->factor
                             : way == BWI_BY_PCG  ? m->factor
                                                  : NULL;
  const bw_solver_kind inner = way == BWI_BY_TWO_LEVEL ? BW_SOLVER_TWO_LEVEL
                               : m                     ? m->solver->options.kind
                                                       : 0;
  bool direct = way == BWI_BY_FACTOR || (way == BWI_BY_PCG && m->solver == solver); /* refined */
  report->solver = bw_solver_word(direct ? BW_SOLVER_CHOLESKY : BW_SOLVER_PCG);
  report->backend = factor ? factor->kernels->backend : "";
  report->preconditioner = direct ? "" : bw_solver_word(inner);
  if (factor) {
    report->reused = way == BWI_BY_FACTOR ? system->times.factor_reused : 0;
    report->flops = (1 - report->reused) * bwi_factor_flops(factor);
  } else if (way == BWI_BY_TWO_LEVEL && !bwi_coarse_iterative(l->coarse))
    report->flops = bwi_coarse_flops(l->coarse);
  report->bytes = way == BWI_BY_FACTOR      ? (double)bwi_factor_bytes(factor)
                  : way == BWI_BY_TWO_LEVEL ? (double)bw_bytes(l->preconditioner)
                                            : (double)bw_bytes(m);
  if (!solver && way != BWI_BY_FACTOR) {
    report->predicted_cost = l->prediction.pcg;
    report->rival_cost = l->prediction.factor;
  }
}

void bwi_system_report(bw_system *system, bwi_way way, const bw_solver *solver,
                       const char *reason) {
  system->report = (bw_solver_report){0};
  snprintf(system->report.reason, sizeof system->report.reason, "%s", reason);
  bwi_report_way(system, way, solver, &system->report);
}

/* Only now that there is a factor: without it the preconditioner solves. */
static void leave_pcg(bw_system *system) {
  if (!system->iterative)
    return;
  bw_release(system->preconditioner);
  bw_release(system->solver);
  system->preconditioner = NULL;
  system->solver = NULL;
  system->iterative = false;
  bwi_system_report(system, BWI_BY_FACTOR, NULL, "the equations have a factor by now");
}

bw_status bwi_system_factor(bw_context *context, bw_system *system, const bw_solver *solver,
                            bwi_symbolic *old, double available) {
  bw_status status = BW_OK;
  bwi_symbolic *symbolic = NULL;
  bwi_factor *factor = NULL;
  if (factor_serves(system->factor, solver)) {
    leave_pcg(system);
    return BW_OK;
  }
  BW_TRY(bw_system_stiffness(context, system));
  BW_TRY(analyse(context, system, solver, old, available, &symbolic));
  double start = bw_seconds();
  BW_TRY(bwi_system_mass(context, system));
  system->times.order += bw_seconds() - start;

  start = bw_seconds();
  bw_progress(context, "factorisation", 0);
  bwi_matrix matrix = {.pattern = system->pattern,
                       .stiffness = system->stiffness,
                       .dof_map = system->dof_map,
                       .memory = available};
  int32_t bad = 0;
  status = bwi_system_factorise(context, system, symbolic, &matrix, bwi_kernels_of(solver), &factor,
                                &bad);
  if (status == BW_SINGULAR)
    status = bwi_fail_singular(context, system->mesh, bad);
  if (status != BW_OK)
    goto done;
  bw_release(system->factor);
  system->factor = factor;
  leave_pcg(system);
  system->times.factor_entries = bwi_factor_entries(factor);
  system->times.factor_flops = bwi_factor_flops(factor);
  system->times.factor += bw_seconds() - start;
  bw_release(system->two_level); /* of no more use */
  system->two_level = NULL;
  bwi_system_forget(system);
done:
  bw_release(symbolic);
  return status;
}

bw_status bwi_system_precondition(bw_context *context, bw_system *system, const bw_solver *solver,
                                  bwi_symbolic *old, double available) {
  bw_status status = BW_OK;
  bwi_symbolic *symbolic = NULL;
  bwi_preconditioner *made = NULL;
  bw_solver *amg = NULL;
  int32_t bad = 0;
  if (bwi_preconditioner_serves(system->preconditioner, solver))
    return BW_OK;
  BW_TRY(bw_system_stiffness(context, system));
  bwi_matrix matrix = {.pattern = system->pattern,
                       .stiffness = system->stiffness,
                       .dof_map = system->dof_map,
                       .memory = available};
  if (!solver) {
    BW_TRY(bw_solver_create(context, &(bw_solver_options){.kind = BW_SOLVER_AMG}, &amg));
    solver = amg;
  }
  bw_release(system->preconditioner); /* its memory first */
  system->preconditioner = NULL;
  if (solver->options.kind == BW_SOLVER_CHOLESKY)
    BW_TRY(analyse(context, system, solver, old, available, &symbolic));
  double start = bw_seconds();
  bw_progress(context, "factorisation", 0);
  if (solver->options.kind == BW_SOLVER_AMG)
    BW_TRY(bwi_blocks_even(context, system->mesh, system->material, &matrix.even));
  status = bwi_preconditioner_create(context, solver, &matrix, symbolic, &made, &bad);
  if (status == BW_SINGULAR && solver->options.kind != BW_SOLVER_AMG)
    status = bwi_fail_singular(context, system->mesh, bad);
  if (status != BW_OK)
    goto done;
  system->preconditioner = made;
  system->times.pcg += bw_seconds() - start;
done:
  bw_release(amg);
  bw_release(symbolic);
  return status;
}

bw_status bw_system_factor(bw_context *context, bw_system *system) {
  bw_status status = bwi_need_equations(context, system);
  return status == BW_OK ? bwi_system_factor(context, system, NULL, NULL, bw_available_memory())
                         : status;
}

static bool same_equations(const bw_system *system, const bw_model *model,
                           const bw_dof_map *dof_map) {
  return system->mesh == model->mesh && system->material == model->material &&
         bwi_same_supports(system->dof_map, dof_map);
}

bool bwi_system_serves(const bw_system *system, const bw_model *model, const bw_dof_map *dof_map) {
  return !system->external && !system->solution && same_equations(system, model, dof_map);
}

bool bwi_external_serves(const bw_system *system, const bw_model *model, const bw_dof_map *dof_map,
                         const bw_solver *solver) {
  return system->external && (!solver || solver == system->external->solver) &&
         same_equations(system, model, dof_map);
}

static bool same_values(const bw_dof_map *a, const bw_dof_map *b) {
  return memcmp(a->value, b->value, 3 * (size_t)a->mesh->node_count * sizeof(double)) == 0;
}

bw_status bwi_system_following(bw_context *context, bw_system *given, const bw_dof_map *dof_map,
                               bw_system **out) {
  if (same_values(given->dof_map, dof_map)) {
    *out = bw_retain(given);
    return BW_OK;
  }
  *out = NULL;
  if (given->object.kind != &system_kind)
    return BW_OK;
  bw_system *system = BW_NEW0(context, bw_system, 1);
  if (!system)
    return BW_MEMORY;
  *system = *given;
  bw_object_init(system, &system_kind);
  bw_retain(system->mesh);
  bw_retain(system->material);
  bw_retain(system->pattern);
  bw_retain(system->factor);
  bw_retain(system->two_level);
  bw_retain(system->preconditioner);
  bw_retain(system->solver);
  bw_retain(system->external);
  bw_retain(system->former);
  system->dof_map = bw_retain(dof_map);
  system->shared = bw_retain(given->shared ? given->shared : given);
  *out = system;
  return BW_OK;
}

bool bwi_system_reusable(const bw_system *system, const bw_mesh *mesh) {
  return system && !system->external && !system->solution && bwi_same_topology(system->mesh, mesh);
}

bw_status bwi_need_equations(bw_context *context, const bw_system *system) {
  if (system->solution)
    return bw_fail(context, BW_UNSUPPORTED,
                   "the equations are those of a joined model: they solve for forces, but have no "
                   "matrices and modes of their own; ask the model for its modes");
  return system->external ? bw_fail(context, BW_UNSUPPORTED,
                                    "the equations are spread over several processes by the "
                                    "backend \"petsc\", and this one does not have them: take "
                                    "another solver")
                          : BW_OK;
}

typedef struct projection {
  const bw_dof_map *dof_map;
  bool force;
  double *fields;
} projection;

static bw_status project(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const projection *p = data;
  int64_t size = 3 * (int64_t)p->dof_map->mesh->node_count;
  for (int64_t k = begin; k < end; k++)
    if (p->force)
      bw_rigid_modes_balance(p->dof_map, p->fields + k * size);
    else
      bw_rigid_modes_remove(p->dof_map, p->fields + k * size);
  return BW_OK;
}

bw_status bwi_balance_fields(bw_context *context, const bw_dof_map *dof_map, int64_t count,
                             double *force) {
  projection balance = {dof_map, true, force};
  return dof_map->rigid_mode_count ? bw_parallel(context, count, 1, project, &balance) : BW_OK;
}

bw_status bwi_steady_fields(bw_context *context, const bw_dof_map *dof_map, int64_t count,
                            double *displacement) {
  projection remove = {dof_map, false, displacement};
  return dof_map->rigid_mode_count ? bw_parallel(context, count, 1, project, &remove) : BW_OK;
}

bw_status bwi_need_factor(bw_context *context, const bw_system *system) {
  if (system->factor)
    return BW_OK;
  if (system->solution)
    return bwi_need_equations(context, system);
  if (system->two_level || system->preconditioner)
    return bw_fail(context, BW_INVALID,
                   "the system was created for PCG and has no factor: factorise it first "
                   "(bw_system_factor)");
  return bw_fail(context, BW_INVALID,
                 "the system follows an edited shape and its factor is lagged: refactorise it "
                 "first (bw_incremental_system_refactor)");
}

/* What is left of a residual after a direct solution is about as much as this says without its
 * factor (measured: 0.9 to 2). */
double bwi_residual_noise(const bw_block_pattern *pattern, const double *stiffness,
                          const double *u) {
  double sum = 0;
  for (int64_t i = 0; i < pattern->node_count; i++) {
    const double *k = stiffness + 9 * (pattern->start[i + 1] - 1), *v = u + 3 * i;
    for (int c = 0; c < 3; c++) {
      double term = fabs(k[3 * c] * v[0]) + fabs(k[3 * c + 1] * v[1]) + fabs(k[3 * c + 2] * v[2]);
      sum += term * term;
    }
  }
  return BWI_RESIDUAL_NOISE * DBL_EPSILON * sqrt(sum);
}
