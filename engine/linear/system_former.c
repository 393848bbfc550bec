/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What equations take over from former ones on the same elements: the stiffness of elements that
 * are the same, and what these did to the factor.
 *
 * An entry of K is computed again where one of its elements has changed, from all of them, in the
 * order in which the whole is assembled: so it has the bits that it has from scratch. So has the
 * factor, since a front has the same bits whichever others are computed with it (factor.c). The
 * former equations stay as they are, and what is taken from them is copied: results hold them. */
#include <string.h>

#include "assemble/internal.h"
#include "barwright/job.h"
#include "linear/internal.h"

/* Part of the factor's work that may be done again: beyond it a whole factor, without the update
 * matrices, costs less. */
#define MAX_UPDATED_FRACTION 0.7

static void former_destroy(void *object) {
  bwi_former *former = object;
  bw_release(former->factor);
  bw_free(former->changed);
  bw_free(former);
}

static const bw_kind former_kind = {"former equations", former_destroy, NULL};

void bwi_system_forget(bw_system *system) {
  bw_release(system->former);
  system->former = NULL;
}

/* ---- what has changed ------------------------------------------------------------------------ */

bool bwi_same_stiffness(const bw_material *a, const bw_material *b) {
  return a == b || (a->isotropic == b->isotropic && a->formulation == b->formulation &&
                    a->lame_lambda == b->lame_lambda && a->lame_mu == b->lame_mu &&
                    memcmp(a->elasticity, b->elasticity, sizeof a->elasticity) == 0);
}

static bool same_node(const bw_mesh *a, const bw_mesh *b, int64_t node) {
  return memcmp(a->node + 3 * node, b->node + 3 * node, 3 * sizeof *a->node) == 0;
}

/* Marks the elements that contribute other numbers, and their nodes; returns how many there are. */
static int32_t find_changes(const bw_system *previous, const bw_system *system, uint8_t *changed,
                            uint8_t *rows) {
  const bw_mesh *mesh = system->mesh, *before = previous->mesh;
  const bw_material *material = system->material, *was = previous->material;
  /* the two are assembled in different ways */
  bool all = material->isotropic != was->isotropic || !material->parts != !was->parts;
  int32_t count = 0;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + e * mesh->nodes_per_element;
    changed[e] = all || !bwi_same_stiffness(bw_material_of(material, e), bw_material_of(was, e));
    for (int a = 0; a < mesh->nodes_per_element && mesh != before; a++)
      changed[e] |= !same_node(mesh, before, node[a]);
    for (int a = 0; a < mesh->nodes_per_element && changed[e]; a++)
      rows[node[a]] = 1;
    count += changed[e];
  }
  return count;
}

bw_status bwi_system_take_over(bw_context *context, const bw_system *previous, bw_system *system) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = system->mesh;
  int64_t size = 9 * system->pattern->block_count;
  uint8_t *rows = NULL;
  double start = bw_seconds();
  bwi_former *former = system->former = BW_NEW0(context, bwi_former, 1);
  BW_TRY_MEMORY(former);
  bw_object_init(former, &former_kind);
  former->changed = BW_NEW(context, uint8_t, mesh->element_count);
  rows = BW_NEW0(context, uint8_t, mesh->node_count);
  BW_TRY_MEMORY(former->changed && rows);
  int32_t count = find_changes(previous, system, former->changed, rows);
  if (count == mesh->element_count) {
    bwi_system_forget(system);
    goto done;
  }
  if (bwi_same_supports(previous->dof_map, system->dof_map))
    former->factor = bw_retain(previous->factor);
  if (previous->stiffness) {
    system->stiffness = BW_NEW(context, double, size);
    BW_TRY_MEMORY(system->stiffness);
    memcpy(system->stiffness, previous->stiffness, (size_t)size * sizeof(double));
    BW_TRY(bwi_stiffness_update(context, system->pattern, mesh, system->material, rows,
                                system->stiffness));
    system->times.elements = count;
    system->times.stiffness = bw_seconds() - start;
  }
done:
  bw_free(rows);
  return status;
}

/* ---- the factor ------------------------------------------------------------------------------ */

bw_status bwi_system_factorise(bw_context *context, bw_system *system, bwi_symbolic *symbolic,
                               const bwi_matrix *matrix, const bwi_kernels *kernels,
                               bwi_factor **factor, int32_t *bad_node) {
  bw_status status = BW_OK;
  const bwi_factor *former = system->former ? system->former->factor : NULL;
  bwi_elimination_reach *reach = NULL;
  uint8_t *touched = NULL;
  double flops = symbolic->flops;
  system->times.factor_reused = 0;
  if (former && former->symbolic == symbolic && former->kernels == kernels &&
      kernels == &bwi_kernels_double) {
    reach = bwi_factor_reach(former);
    bool updatable = reach && reach->part && !former->broken;
    if (updatable)
      bw_retain(reach);
    else {
      reach = NULL;
      BW_TRY(bwi_elimination_reach_create_by_plan(context, symbolic, system->mesh, &reach));
    }
    touched = BW_NEW0(context, uint8_t, reach->subdomain_count);
    BW_TRY_MEMORY(touched);
    bwi_elimination_reach_touch(reach, system->mesh, system->former->changed, touched);
    bool few =
        bwi_elimination_reach_flops(reach, touched) <= MAX_UPDATED_FRACTION * symbolic->flops;
    if (few && updatable) {
      BW_TRY(bwi_factor_create_updated(context, former, matrix, touched, &flops, factor, bad_node));
      system->times.factor_reused = symbolic->flops > 0 ? 1 - flops / symbolic->flops : 1;
      bwi_factor_release_work(*factor);
      goto done;
    }
    double wanted =
        bwi_factor_peak_bytes(symbolic, bw_threads(context)) + 8 * (double)reach->kept_numbers;
    if (!few || wanted > matrix->memory) {
      bw_release(reach);
      reach = NULL;
    }
  }
  BW_TRY(bwi_factor_create_in(context, symbolic, matrix, reach, kernels, factor, bad_node));
  bwi_factor_release_work(*factor);
done:
  bw_free(touched);
  bw_release(reach);
  return status;
}
