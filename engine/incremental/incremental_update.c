/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A system that follows edits is brought to another shape: the DOF map, the stiffness, and which
 * subdomains the factor no longer knows. All that can fail is done before anything is changed. */
#include <math.h>
#include <string.h>

#include "incremental/incremental.h"

/* Frames of supports this near are the same: what rounding makes of a rotated surface's normals.
 * The factor is off by as much, the stiffness not at all. */
#define SAME_FRAME 1e-12

/* ---- frames of supports -------------------------------------------------------------------- */

/* The frame of a support at a node, seen from the node's subdomain; false where it has none. */
static bool support_frame(const bw_incremental_system *incremental, const bw_dof_map *dof_map,
                          const double *frame, int32_t node, double seen[9]) {
  const bwi_incremental *inner = incremental->inner;
  int32_t row = dof_map->frame_of[node], subdomain = inner->node_subdomain[node];
  if (row < 0 || row >= dof_map->frame_count - inner->subdomain_count)
    return false;
  const double *own = dof_map->frame + 9 * (size_t)row;
  if (subdomain < 0)
    memcpy(seen, own, 9 * sizeof *seen);
  for (int i = 0; subdomain >= 0 && i < 3; i++)
    for (int j = 0; j < 3; j++)
      seen[3 * i + j] = bw_dot(own + 3 * i, frame + 9 * (size_t)subdomain + 3 * j);
  return true;
}

bw_status bwi_incremental_supports(bw_context *context, const bw_incremental_system *incremental,
                                   const bw_dof_map *dof_map, const double *frame,
                                   double **reported) {
  int32_t supports = dof_map->frame_count - incremental->inner->subdomain_count;
  double *made = BW_NEW(context, double, 9 * (size_t)supports);
  if (!made)
    return BW_MEMORY;
  for (int32_t i = 0; i < dof_map->mesh->node_count; i++) {
    double seen[9];
    if (support_frame(incremental, dof_map, frame, i, seen))
      memcpy(made + 9 * (size_t)dof_map->frame_of[i], seen, sizeof seen);
  }
  *reported = made;
  return BW_OK;
}

/* Mark the subdomains of the elements around nodes whose support has rotated against their
 * subdomain: entries change there although the subdomains' own frames do not change. `now`
 * receives what was reported, renewed where it changed. */
static void touch_rotated_supports(const bw_incremental_system *incremental,
                                   const bw_dof_map *dof_map, const double *frame, double *now,
                                   uint8_t *touched) {
  const bwi_incremental *inner = incremental->inner;
  const bw_mesh *mesh = dof_map->mesh;
  int32_t supports = dof_map->frame_count - inner->subdomain_count;
  if (supports == 0)
    return;
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < mesh->nodes_per_element; a++) {
      int32_t node = mesh->element[e * mesh->nodes_per_element + a];
      double seen[9], off = 0;
      if (!support_frame(incremental, dof_map, frame, node, seen))
        continue;
      double *before = inner->supports + 9 * (size_t)dof_map->frame_of[node];
      for (int k = 0; k < 9; k++)
        off = fmax(off, fabs(seen[k] - before[k]));
      if (off > SAME_FRAME) {
        touched[inner->element_subdomain[e]] = 1;
        memcpy(now + 9 * (size_t)dof_map->frame_of[node], seen, sizeof seen);
      }
    }
}

/* ---- following an edit --------------------------------------------------------------------- */

static bw_status check_model(bw_context *context, const bw_incremental_system *incremental,
                             const bw_model *model) {
  const bw_mesh *mesh = model->mesh, *rest = incremental->inner->rest->mesh;
  if (!bwi_same_topology(mesh, rest))
    return bw_fail(context, BW_INVALID,
                   "the edited model has a mesh of %d nodes and %d elements, the system one of %d "
                   "and %d: the elements must be the same",
                   mesh->node_count, mesh->element_count, rest->node_count, rest->element_count);
  return BW_OK;
}

/* How far the rotation of an element's material is from that of its subdomain since rest. */
static double orientation_error(const bw_material *rest, const bw_material *now, int64_t element,
                                const double frame[9]) {
  static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const bw_material_parts *t = rest->parts, *u = now->parts;
  const double *before = t ? t->rotation + 9 * (int64_t)t->of_element[element] : identity;
  const double *after = u ? u->rotation + 9 * (int64_t)u->of_element[element] : identity;
  double off = 0;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      off = fmax(off, fabs(frame[r] * before[c] + frame[3 + r] * before[3 + c] +
                           frame[6 + r] * before[6 + c] - after[3 * r + c]));
  return off;
}

bool bwi_incremental_other_material(const bwi_incremental *inner, int64_t element,
                                    const bw_material **before, const bw_material **now) {
  const bw_material *then = inner->factored_material, *model = inner->model->material;
  if (then == model)
    return false;
  *before =
      inner->rotate_material ? bw_material_unrotated(then, element) : bw_material_of(then, element);
  *now = inner->rotate_material ? bw_material_unrotated(model, element)
                                : bw_material_of(model, element);
  return *before != *now &&
         memcmp((*before)->elasticity, (*now)->elasticity, sizeof(*now)->elasticity) != 0;
}

/* Where the material rotates with the subdomains, that of the model has to be rotated by element as
 * they lie now, since stresses are taken from it. */
static bw_status check_material(bw_context *context, const bw_incremental_system *incremental,
                                const bw_model *model, const bw_subdomain_motion *motion) {
  const bwi_incremental *inner = incremental->inner;
  const bw_material *rest = inner->rest->material, *now = model->material;
  bool rotates = inner->rotate_material && !rest->isotropic;
  int32_t subdomain = -1, group = -1; /* of the element before */
  for (int32_t e = 0; rotates && e < model->mesh->element_count; e++) {
    int32_t of = now->parts ? now->parts->of_element[e] : 0, d = inner->element_subdomain[e];
    if ((d == subdomain && of == group) || bw_material_unrotated(now, e)->isotropic)
      continue;
    subdomain = d;
    group = of;
    double off = orientation_error(rest, now, e, motion[d].frame);
    if (!(off <= 1e-9)) {
      bw_fail(
          context, BW_INVALID,
          "element %d of the edited model has another material orientation than its subdomain %d "
          "(off by %.3g): the orientation follows the subdomains (bw_model_rotate_material)",
          e + 1, d + 1, off);
      bw_detail_number(context, "element", e + 1);
      return BW_INVALID;
    }
  }
  return BW_OK;
}

/* Subdomains whose nodes, frames and material are bit for bit those that were factored need nothing
 * done again: an edit that was taken back while the factor was left as it was. Where supports have
 * frames of their own, which hang on the facets around a node, only if the whole shape is back.
 * `moved` is room for subdomain_count. */
static void forget_undone(bwi_incremental *inner, const bw_mesh *now, const bw_dof_map *dof_map,
                          uint8_t *moved) {
  const bw_mesh *before = inner->factored;
  bool all = dof_map->frame_count > inner->subdomain_count, any = false;
  size_t subdomains = (size_t)inner->subdomain_count, vector = 3 * sizeof(double);
  for (size_t d = 0; d < subdomains; d++) {
    moved[d] = memcmp(inner->frame + 9 * d, inner->factored_frame + 9 * d, 3 * vector) != 0;
    any |= moved[d] != 0;
  }
  for (int64_t e = 0; e < now->element_count; e++) {
    int32_t d = inner->element_subdomain[e];
    const bw_material *was, *is;
    if (moved[d] || (!all && !inner->touched[d]))
      continue;
    moved[d] = bwi_incremental_other_material(inner, e, &was, &is);
    const int32_t *node = now->element + e * now->nodes_per_element;
    for (int a = 0; a < now->nodes_per_element && !moved[d]; a++) {
      size_t at = 3 * (size_t)node[a];
      int32_t of = inner->node_subdomain[node[a]];
      moved[d] = memcmp(now->node + at, before->node + at, vector) != 0 ||
                 (of >= 0 && memcmp(inner->frame + 9 * (size_t)of,
                                    inner->factored_frame + 9 * (size_t)of, 3 * vector) != 0);
    }
    any |= moved[d] != 0;
  }
  for (size_t d = 0; d < subdomains; d++)
    if (all ? !any : !moved[d])
      inner->touched[d] = 0;
}

bw_status bw_incremental_system_update(bw_context *context, bw_incremental_system *incremental,
                                       const bw_model *model, const bw_subdomain_motion *motion,
                                       bw_reuse *reuse) {
  bw_status status = BW_OK;
  bwi_incremental *inner = incremental->inner;
  bw_system *system = incremental->system;
  size_t subdomains = (size_t)inner->subdomain_count;
  bw_dof_map *dof_map = NULL;
  bw_subdomain_change change;
  bool same;
  double start = bw_seconds(), *supports = NULL;
  double *frame = BW_NEW(context, double, 9 * subdomains);
  uint8_t *touched = BW_NEW0(context, uint8_t, subdomains);
  BW_TRY_MEMORY(frame && touched);
  BW_TRY(check_model(context, incremental, model));
  BW_TRY(check_material(context, incremental, model, motion));
  for (size_t d = 0; d < subdomains; d++)
    memcpy(frame + 9 * d, motion[d].frame, 9 * sizeof *frame);
  BW_TRY(bw_dof_map_follow(context, model, system->dof_map, inner->subdomain_count,
                           inner->node_subdomain, frame, &same, &dof_map));
  same = same && dof_map->frame_count == system->dof_map->frame_count;
  BW_TRY(bwi_incremental_supports(context, incremental, dof_map, frame, &supports));
  double unknowns = bw_seconds() - start;
  uint64_t revision = incremental->stiffness->revision;
  BW_TRY(bw_subdomain_stiffness_update(context, incremental->stiffness, model->mesh,
                                       model->material, motion, &change));
  double stiffness = bw_seconds() - start - unknowns;

  /* From here on nothing fails. */
  if (same) {
    size_t count = 9 * (size_t)(dof_map->frame_count - inner->subdomain_count);
    memcpy(supports, inner->supports, count * sizeof *supports);
    touch_rotated_supports(incremental, dof_map, frame, supports, touched);
  } else { /* the factor is of other unknowns */
    bw_release(inner->factor);
    inner->factor = NULL;
    memset(touched, 1, subdomains);
  }
  bw_free(inner->supports);
  inner->supports = supports;
  supports = NULL;
  int32_t count = 0;
  for (size_t d = 0; d < subdomains; d++) {
    touched[d] |= incremental->stiffness->changed[d];
    count += touched[d];
    inner->touched[d] |= touched[d];
    inner->latest[d] = (inner->latest[d] && !inner->answered) || touched[d];
  }
  inner->answered = false;
  if (!model->material->parts != !inner->model->material->parts) { /* their blocks differ */
    bw_release(inner->two_level);
    inner->two_level = NULL;
    inner->two_level_known = false;
  }
  bw_retain(model);
  bw_release(inner->model);
  inner->model = model;
  memcpy(inner->motion, motion, subdomains * sizeof *motion);
  memcpy(inner->frame, frame, 9 * subdomains * sizeof *frame);
  if (inner->factor && inner->factored)
    forget_undone(inner, model->mesh, dof_map, touched);
  inner->spent = 0;
  inner->two_level_known &= same && count == 0 && incremental->stiffness->revision == revision;
  inner->change = -1;
  bw_retain(model->mesh);
  bw_release(system->mesh);
  system->mesh = model->mesh;
  bw_retain(model->material);
  bw_release(system->material);
  system->material = model->material;
  bw_release(system->dof_map);
  system->dof_map = dof_map;
  dof_map = NULL;
  bw_release(system->factor);
  system->factor = NULL;
  incremental->object.revision++;
  if (reuse) {
    int32_t left = inner->subdomain_count - count;
    *reuse = (bw_reuse){.pattern = true, .ordering = true, .subdomains = inner->subdomain_count};
    reuse->subdomains_changed = count;
    reuse->subdomains_reused = change.kept < left ? change.kept : left;
    reuse->subdomains_rotated = left - reuse->subdomains_reused;
    reuse->seconds_stiffness = stiffness;
    reuse->seconds_unknowns = unknowns;
  }
done:
  bw_free(frame);
  bw_free(touched);
  bw_free(supports);
  bw_release(dof_map);
  return status;
}
