/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "linear/external.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>

#include "linear/internal.h"

static const bw_external *registered;
static bwi_external *open_system; /* what the registered solver has, borrowed; or NULL */

/* Memory of other processes goes back now, and not when another system is opened. */
static void close_system(void) {
  if (open_system && registered)
    registered->close();
  open_system = NULL;
}

void bw_external_register(const bw_external *external) {
  close_system(); /* the former solver has it */
  registered = external;
}

static void external_destroy(void *object) {
  bwi_external *external = object;
  if (open_system == external)
    close_system();
  bw_release(external->problem.material);
  bw_release(external->problem.dof_map);
  bw_release(external->solver);
  bw_free(external);
}

static size_t external_bytes(const void *object) {
  (void)object;
  return sizeof(bwi_external);
}

static const bw_kind external_kind = {"external system", external_destroy, external_bytes};

bw_status bwi_external_create(bw_context *context, const bw_material *material,
                              const bw_dof_map *dof_map, const bw_solver *solver,
                              bwi_external **out) {
  if (!registered)
    return bw_fail(context, BW_UNSUPPORTED,
                   "no external solver is loaded: require \"barwright.distributed\"");
  bwi_external *external = BW_NEW0(context, bwi_external, 1);
  if (!external)
    return BW_MEMORY;
  bw_object_init(external, &external_kind);
  external->problem =
      (bw_external_problem){.material = bw_retain(material), .dof_map = bw_retain(dof_map)};
  external->solver = bw_retain(solver);
  *out = external;
  return BW_OK;
}

/* The solver has this system, with the mass where it is wanted. */
static bw_status acquire(bw_context *context, bwi_external *external, bool mass) {
  bw_status status = BW_OK;
  if (open_system == external && !external->written && (!mass || external->problem.mass))
    return BW_OK;
  close_system();
  if (!registered)
    return bw_fail(context, BW_UNSUPPORTED, "the external solver is not loaded any more");
  external->problem.mass |= mass;
  external->former = external->report; /* of the system that was closed */
  BW_TRY(registered->open(context, &external->problem, external->solver));
  open_system = external;
  external->written = false;
done:
  return status;
}

/* After a failure the solver has closed the system. */
static bw_status used(bw_status status) {
  if (status != BW_OK)
    open_system = NULL;
  return status;
}

bw_status bwi_external_multiply(bw_context *context, bwi_external *external, int count,
                                const double *x, double *kx, double *mx, double *magnitude) {
  bw_status status = acquire(context, external, mx != NULL);
  return status == BW_OK ? used(registered->multiply(context, count, x, kx, mx, magnitude))
                         : status;
}

bw_status bwi_external_solve(bw_context *context, bwi_external *external, int64_t count,
                             const double *force, double *displacement) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)external->problem.dof_map->mesh->node_count;
  BW_TRY(acquire(context, external, false));
  for (int64_t first = 0; first < count; first += INT_MAX) {
    int64_t left = count - first;
    BW_TRY(used(registered->solve(context, left < INT_MAX ? (int)left : INT_MAX,
                                  force + first * size, displacement + first * size)));
  }
done:
  return status;
}

bw_status bwi_external_modes(bw_context *context, bwi_external *external,
                             const struct bw_modes_options *options, bw_external_modes *modes) {
  bw_status status = acquire(context, external, true);
  return status == BW_OK ? used(registered->modes(context, options, modes)) : status;
}

bw_status bwi_external_write(bw_context *context, bwi_external *external,
                             const bw_external_output *output) {
  bw_status status = BW_OK;
  BW_TRY(acquire(context, external, false));
  BW_TRY(used(registered->write(context, output)));
  external->written = true;
done:
  return status;
}

/* Work of all the times that the system was open; memory at its largest. */
void bwi_external_update(bw_context *context, bwi_external *external) {
  bw_external_report *now = &external->report;
  const bw_external_report *former = &external->former;
  if (open_system != external)
    return;
  registered->report(context, now);
  now->iterations += former->iterations;
  now->send += former->send;
  now->assembly += former->assembly;
  now->setup += former->setup;
  now->solve += former->solve;
  now->processor += former->processor;
  now->bytes = fmax(now->bytes, former->bytes);
  now->largest = fmax(now->largest, former->largest);
  now->energy_error = fmax(now->energy_error, former->energy_error);
}

void bwi_external_fill_report(const bwi_external *external, bw_solver_report *report) {
  const bw_solver_kind kind = external->solver->options.kind;
  report->solver = bw_solver_word(kind);
  report->backend = bw_backend_word(BW_BACKEND_PETSC);
  report->preconditioner = kind == BW_SOLVER_PCG ? bw_solver_word(BW_SOLVER_AMG) : "";
  report->iterations = external->report.iterations;
  report->bytes = external->report.bytes;
  snprintf(report->reason, sizeof report->reason, "it was given");
}
