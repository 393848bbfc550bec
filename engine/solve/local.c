/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A system that follows edits: made, brought to another shape, factored, solved. */
#include <math.h>
#include <string.h>

#include "solve/local.h"

void bw_local_options_default(bw_local_options *options) {
  *options = (bw_local_options){.method = BW_LOCAL_AUTO, .tolerance = 1e-10};
}

static bw_status options_of(bw_context *context, const bw_local_options *given,
                            bw_local_options *options) {
  bw_local_options_default(options);
  if (given)
    *options = *given;
  if (options->tolerance == 0)
    options->tolerance = 1e-10;
  if (!(options->tolerance > 0 && options->tolerance < 1))
    return bw_fail(context, BW_INVALID,
                   "the tolerance of the iteration is %g; it must be between 0 and 1",
                   options->tolerance);
  if (options->method < BW_LOCAL_AUTO || options->method > BW_LOCAL_SCRATCH)
    return bw_fail(context, BW_INVALID, "there is no method %d", (int)options->method);
  return BW_OK;
}

/* ---- the view ------------------------------------------------------------------------------ */

static void view_destroy(void *object) {
  bw_system *view = object;
  bw_release(view->mesh);
  bw_release(view->material);
  bw_release(view->numbering);
  bw_release(view->graph);
  bw_release(view->factor);
  bw_free(view->stiffness);
  bw_free(view->mass);
  bw_free(view);
}

static const bw_kind view_kind = {"system", view_destroy, NULL};

static bw_status bring_up(bw_context *context, bw_local_system *local, bw_reuse *reuse);

/* ---- life ---------------------------------------------------------------------------------- */

static void inner_free(bwi_local *inner) {
  if (!inner)
    return;
  bw_release(inner->rest);
  bw_release(inner->model);
  bw_free(inner->element_domain);
  bw_free(inner->node_domain);
  bw_free(inner->motion);
  bw_free(inner->frame);
  bw_free(inner->touched);
  bw_release(inner->factor);
  bw_free(inner);
}

static void local_destroy(void *object) {
  bw_local_system *local = object;
  bw_release(local->system);
  bw_release(local->stiffness);
  inner_free(local->inner);
  bw_free(local);
}

void bw_local_system_memory(const bw_local_system *local, size_t *factor, size_t *updates) {
  *factor = bw_bytes(local->inner->factor);
  *updates = 0;
}

static size_t local_bytes(const void *object) {
  const bw_local_system *local = object;
  size_t factor, updates;
  bw_local_system_memory(local, &factor, &updates);
  return sizeof *local + bw_bytes(local->stiffness) + bw_bytes(local->system->graph) + factor +
         updates;
}

static const bw_kind local_kind = {"local system", local_destroy, local_bytes};

bool bwi_local_current(const bw_local_system *local) {
  const bwi_local *inner = local->inner;
  bool touched = !inner->factor;
  for (int32_t d = 0; d < inner->domain_count; d++)
    touched |= inner->touched[d];
  return !touched;
}

static void rest_frame(double frame[9]) {
  for (int k = 0; k < 9; k++)
    frame[k] = k % 4 == 0;
}

static bw_status inner_create(bw_context *context, const bw_model *model, bool material_turns,
                              int32_t domain_count, const int32_t *element_domain,
                              const int32_t *node_domain, bwi_local **out) {
  size_t elements = (size_t)model->mesh->element_count, nodes = (size_t)model->mesh->node_count;
  size_t domains = (size_t)domain_count;
  bwi_local *inner = BW_NEW0(context, bwi_local, 1);
  if (!inner)
    return BW_MEMORY;
  inner->rest = bw_retain(model);
  inner->model = bw_retain(model);
  inner->material_turns = material_turns;
  inner->domain_count = domain_count;
  inner->element_domain = BW_NEW(context, int32_t, elements);
  inner->node_domain = BW_NEW(context, int32_t, nodes);
  inner->motion = BW_NEW0(context, bw_domain_motion, domains);
  inner->frame = BW_NEW(context, double, 9 * domains);
  inner->touched = BW_NEW0(context, uint8_t, domains);
  if (!inner->element_domain || !inner->node_domain || !inner->motion || !inner->frame ||
      !inner->touched) {
    inner_free(inner);
    return BW_MEMORY;
  }
  memcpy(inner->element_domain, element_domain, elements * sizeof *element_domain);
  memcpy(inner->node_domain, node_domain, nodes * sizeof *node_domain);
  for (size_t d = 0; d < domains; d++) {
    rest_frame(inner->motion[d].linear);
    rest_frame(inner->motion[d].frame);
    rest_frame(inner->frame + 9 * d);
  }
  *out = inner;
  return BW_OK;
}

static bw_status check_domains(bw_context *context, const bw_mesh *mesh, int32_t domain_count,
                               const int32_t *element_domain, const int32_t *node_domain) {
  if (domain_count < 1)
    return bw_fail(context, BW_INVALID, "a body is cut into at least one domain, not %d",
                   domain_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (element_domain[e] < 0 || element_domain[e] >= domain_count)
      return bw_fail(context, BW_INVALID, "element %d is in domain %d of %d", e,
                     element_domain[e] + 1, domain_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (node_domain[i] < -1 || node_domain[i] >= domain_count)
      return bw_fail(context, BW_INVALID, "node %d goes with domain %d of %d", i,
                     node_domain[i] + 1, domain_count);
  return BW_OK;
}

static bw_status view_create(bw_context *context, const bw_model *model, bw_system **out) {
  bw_system *view = BW_NEW0(context, bw_system, 1);
  if (!view)
    return BW_MEMORY;
  bw_object_init(view, &view_kind);
  view->mesh = bw_retain(model->mesh);
  view->material = bw_retain(model->material);
  view->density = model->material->density > 0 ? model->material->density : 1;
  *out = view;
  return BW_OK;
}

bw_status bw_local_system_create(bw_context *context, const bw_model *model, bool material_turns,
                                 int32_t domain_count, const int32_t *element_domain,
                                 const int32_t *node_domain, bw_local_system **out) {
  bw_status status = BW_OK;
  bw_local_system *local = NULL;
  bw_numbering *numbering = NULL;
  bool same;
  BW_TRY(check_domains(context, model->mesh, domain_count, element_domain, node_domain));
  local = BW_NEW0(context, bw_local_system, 1);
  if (!local)
    return BW_MEMORY;
  bw_object_init(local, &local_kind);
  BW_TRY(view_create(context, model, &local->system));
  BW_TRY(inner_create(context, model, material_turns, domain_count, element_domain, node_domain,
                      &local->inner));
  bw_system *view = local->system;
  BW_TRY(bw_numbering_follow(context, model, NULL, domain_count, node_domain, local->inner->frame,
                             &same, &numbering));
  view->numbering = numbering;
  BW_TRY(bw_graph_create(context, model->mesh, &view->graph));
  view->stiffness = BW_NEW(context, double, 9 * view->graph->pair_count);
  if (!view->stiffness) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bw_stiffness(context, view->graph, model->mesh, model->material, view->stiffness));
  BW_TRY(bring_up(context, local, NULL));
done:
  if (status == BW_OK)
    *out = local;
  else
    bw_release(local);
  return status;
}

/* ---- following an edit --------------------------------------------------------------------- */

static bw_status check_model(bw_context *context, const bw_local_system *local,
                             const bw_model *model) {
  const bw_mesh *mesh = model->mesh, *rest = local->inner->rest->mesh;
  if (mesh->node_count != rest->node_count || mesh->element_count != rest->element_count ||
      mesh->order != rest->order ||
      (mesh->element != rest->element &&
       memcmp(mesh->element, rest->element,
              (size_t)rest->element_count * (size_t)rest->nodes_per_element * sizeof(int32_t)) !=
           0))
    return bw_fail(context, BW_INVALID,
                   "the edited model has a mesh of %d nodes and %d elements, the system one of %d "
                   "and %d: the elements must be the same",
                   mesh->node_count, mesh->element_count, rest->node_count, rest->element_count);
  if (model->material != local->inner->rest->material)
    return bw_fail(context, BW_INVALID,
                   "the edited model has another material than the system that is to follow it");
  return BW_OK;
}

bw_status bw_local_system_update(bw_context *context, bw_local_system *local, const bw_model *model,
                                 const bw_domain_motion *motion, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bwi_local *inner = local->inner;
  bw_system *view = local->system;
  size_t domains = (size_t)inner->domain_count;
  bw_numbering *numbering = NULL;
  bool same;
  double start = bw_seconds(), *stiffness = NULL;
  double *frame = BW_NEW(context, double, 9 * domains);
  if (!frame)
    return BW_MEMORY;
  BW_TRY(check_model(context, local, model));
  for (size_t d = 0; d < domains; d++)
    memcpy(frame + 9 * d, motion[d].frame, 9 * sizeof *frame);
  BW_TRY(bw_numbering_follow(context, model, view->numbering, inner->domain_count,
                             inner->node_domain, frame, &same, &numbering));
  stiffness = BW_NEW(context, double, 9 * view->graph->pair_count);
  if (!stiffness) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bw_stiffness(context, view->graph, model->mesh, model->material, stiffness));

  /* From here nothing fails. */
  bw_free(view->stiffness);
  view->stiffness = stiffness;
  stiffness = NULL;
  for (size_t d = 0; d < domains; d++) {
    inner->touched[d] = 1;
    inner->motion[d] = motion[d];
  }
  bw_free(inner->frame);
  inner->frame = frame;
  frame = NULL;
  bw_retain(model);
  bw_release(inner->model);
  inner->model = model;
  bw_retain(model->mesh);
  bw_release(view->mesh);
  view->mesh = model->mesh;
  bw_release(view->numbering);
  view->numbering = numbering;
  numbering = NULL;
  bw_release(view->factor);
  view->factor = NULL;
  local->object.revision++;
  if (reuse) {
    *reuse = (bw_reuse){.pattern = true, .ordering = same};
    reuse->domains = reuse->domains_touched = inner->domain_count;
    reuse->seconds_stiffness = bw_seconds() - start;
  }
done:
  bw_free(frame);
  bw_free(stiffness);
  bw_release(numbering);
  return status;
}

/* ---- the factor ---------------------------------------------------------------------------- */

/* Bring the factor up to date. */
static bw_status bring_up(bw_context *context, bw_local_system *local, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bwi_local *inner = local->inner;
  bw_system *view = local->system;
  bwi_symbolic *symbolic = NULL;
  bwi_factor *factor = NULL;
  int32_t bad = 0;
  double start = bw_seconds(), kept = 1;
  if (!bwi_local_current(local)) {
    bwi_symbolic *old = inner->factor ? inner->factor->symbolic : NULL;
    BW_TRY(bwi_symbolic_for(context, view->graph, view->numbering, old, &symbolic));
    bwi_matrix matrix = {
        .graph = view->graph, .stiffness = view->stiffness, .numbering = view->numbering};
    status = bwi_factor_create(context, symbolic, &matrix, &factor, &bad);
    if (status == BW_SINGULAR)
      status = bwi_say_singular(context, view->mesh, bad);
    if (status != BW_OK)
      goto done;
    bw_release(inner->factor);
    inner->factor = factor;
    memset(inner->touched, 0, (size_t)inner->domain_count);
    kept = 0;
  }
  if (reuse) {
    reuse->method = BW_LOCAL_REFACTOR;
    reuse->factor_kept = kept;
    reuse->seconds_factor += bw_seconds() - start;
  }
done:
  bw_release(symbolic);
  return status;
}

bw_status bw_local_system_refactor(bw_context *context, bw_local_system *local, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bw_system *view = local->system;
  BW_TRY(bring_up(context, local, reuse));
  if (view->factor)
    return BW_OK;
  int64_t pairs = view->graph->pair_count;
  if (!view->mass && !(view->mass = BW_NEW(context, double, pairs)))
    return BW_MEMORY;
  BW_TRY(bw_mass(context, view->graph, view->mesh, view->mass));
  for (int64_t k = 0; k < pairs; k++)
    view->mass[k] *= view->density;
  view->factor = bw_retain(local->inner->factor);
done:
  return status;
}

/* ---- solving ------------------------------------------------------------------------------- */

bw_status bw_local_system_solve(bw_context *context, bw_local_system *local,
                                const bw_local_options *given, int64_t count, const double *force,
                                double *displacement, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bw_local_options options;
  BW_TRY(options_of(context, given, &options));
  BW_TRY(bring_up(context, local, reuse));
  double start = bw_seconds();
  const bw_numbering *numbering = local->system->numbering;
  size_t size = 3 * (size_t)numbering->mesh->node_count;
  if (force != displacement)
    memcpy(displacement, force, (size_t)count * size * sizeof(double));
  BW_TRY(bwi_balance_fields(context, numbering, count, displacement));
  BW_TRY(bwi_solve_fields(context, local->inner->factor, numbering, count, displacement,
                          displacement));
  BW_TRY(bwi_steady_fields(context, numbering, count, displacement));
  if (reuse)
    reuse->seconds_solve += bw_seconds() - start;
done:
  return status;
}

typedef struct static_data {
  bw_local_system *local;
  const bw_local_options *options;
  bw_reuse *reuse;
} static_data;

static bw_status solve_local(bw_context *context, void *data, const double *force,
                             double *displacement) {
  static_data *d = data;
  return bw_local_system_solve(context, d->local, d->options, 1, force, displacement, d->reuse);
}

bw_status bw_local_statics(bw_context *context, bw_local_system *local, const bw_model *model,
                           const bw_statics_options *statics, const bw_local_options *given,
                           bw_static **out, bw_reuse *reuse) {
  bw_status status = BW_OK;
  bw_static *result = NULL;
  bw_local_options options;
  if (model != local->inner->model)
    return bw_fail(
        context, BW_INVALID,
        "the model is not the one that the system last followed: update the system first");
  BW_TRY(options_of(context, given, &options));
  const bw_system *view = local->system;
  BW_TRY(bwi_static_begin(context, model, statics, view->numbering, &result));
  static_data data = {local, &options, reuse};
  bwi_static_solver solver = {.solve = solve_local, .data = &data, .refine_to = bwi_refine_to};
  BW_TRY(bwi_static_solve(context, view->numbering, view->graph, view->stiffness, &solver, result));
done:
  if (status == BW_OK)
    *out = result;
  else
    bw_release(result);
  return status;
}
