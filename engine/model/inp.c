/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A model as an input deck for CalculiX, from the same supports and nodal forces that the engine's
 * own solution uses, so that the answers can be compared digit by digit. */
#include <math.h>
#include <string.h>

#include "model/inp_joints.h"
#include "model/internal.h"

/* CalculiX lists the upper triangle of D_ijkl column by column over the pairs 11 22 33 12 13 23;
 * the engine's order is xx yy zz yz zx xy. */
static void anisotropic_constants(const double elasticity[36], double constants[21]) {
  static const int pair[6] = {0, 1, 2, 5, 4, 3};
  int at = 0;
  for (int column = 0; column < 6; column++)
    for (int row = 0; row <= column; row++)
      constants[at++] = elasticity[6 * pair[row] + pair[column]];
}

typedef struct conditions {
  int64_t fixed_count, equation_count;
  int32_t *fixed_node, *equation_node;
  int *fixed_direction;
  double *fixed_value, *equation_normal;
} conditions;

static void fix(conditions *c, int32_t node, int direction, double value) {
  c->fixed_node[c->fixed_count] = node;
  c->fixed_direction[c->fixed_count] = direction;
  c->fixed_value[c->fixed_count++] = value;
}

/* What is constrained at a node with its own frame, one or two directions (three fix it altogether
 * and need no frame). Each equation must name a component that no other does, so two directions are
 * written as u_i = (t_i / t_k) u_k with the one free direction t, k its largest component. */
static bw_status oblique_node(bw_context *context, const bw_dof_map *dof_map, int32_t node,
                              conditions *c) {
  const double *frame = dof_map->frame + 9 * (size_t)dof_map->frame_of[node];
  const uint8_t *state = dof_map->state + 3 * (size_t)node;
  const double *value = dof_map->value + 3 * (size_t)node;
  if (value[0] != 0 || value[1] != 0 || value[2] != 0) {
    char at[96];
    bwi_vector_string(at, sizeof at, dof_map->mesh->node + 3 * (size_t)node, 6, 0);
    return bw_fail(
        context, BW_UNSUPPORTED,
        "node %d at %s m has an oblique sliding support and a prescribed displacement: an .inp "
        "file cannot express both; prescribe the displacement along x, y, z instead",
        node + 1, at);
  }
  int constrained = 0;
  for (int k = 0; k < 3; k++) /* isostatic constraints are wanted here too */
    constrained += state[k] != BW_DOF_UNKNOWN;
  if (constrained == 3) {
    for (int k = 0; k < 3; k++)
      fix(c, node, k, 0);
    return BW_OK;
  }
  if (constrained == 1) {
    int k = state[0] != BW_DOF_UNKNOWN ? 0 : state[1] != BW_DOF_UNKNOWN ? 1 : 2;
    c->equation_node[c->equation_count] = node;
    memcpy(c->equation_normal + 3 * c->equation_count, frame + 3 * k, 3 * sizeof *frame);
    c->equation_count++;
    return BW_OK;
  }
  int open = state[0] == BW_DOF_UNKNOWN ? 0 : state[1] == BW_DOF_UNKNOWN ? 1 : 2, max = 0;
  const double *t = frame + 3 * open;
  for (int k = 1; k < 3; k++)
    if (fabs(t[k]) > fabs(t[max]))
      max = k;
  for (int k = 0; k < 3; k++) {
    if (k == max)
      continue;
    double ratio = t[k] / t[max];
    if (fabs(ratio) < 1e-12) {
      fix(c, node, k, 0);
      continue;
    }
    double *normal = c->equation_normal + 3 * c->equation_count;
    memset(normal, 0, 3 * sizeof *normal);
    normal[k] = 1;
    /* The writer leads with the largest coefficient: at 45 degrees that must be the first. */
    normal[max] = -ratio * (1 - 1e-15);
    c->equation_node[c->equation_count++] = node;
  }
  return BW_OK;
}

/* The conditions of supports, but where joints have them, and at nodes with a frame the isostatic
 * constraints too. */
static bw_status supports(bw_context *context, const bw_dof_map *dof_map, const uint8_t *joined,
                          conditions *c) {
  bw_status status = BW_OK;
  for (int32_t i = 0; i < dof_map->mesh->node_count; i++) {
    const uint8_t *state = dof_map->state + 3 * (size_t)i;
    if (joined && joined[i])
      continue;
    if (state[0] == BW_DOF_UNKNOWN && state[1] == BW_DOF_UNKNOWN && state[2] == BW_DOF_UNKNOWN)
      continue;
    if (dof_map->frame_of[i] >= 0) {
      BW_TRY(oblique_node(context, dof_map, i, c));
      continue;
    }
    for (int k = 0; k < 3; k++)
      if (state[k] == BW_DOF_PRESCRIBED)
        fix(c, i, k, dof_map->value[3 * (size_t)i + (size_t)k]);
  }
done:
  return status;
}

/* The other isostatic constraints, after the supports; returns how many there are. */
static int64_t isostatic(const bw_dof_map *dof_map, conditions *c) {
  int64_t before = c->fixed_count;
  for (int32_t i = 0; i < dof_map->mesh->node_count; i++)
    for (int k = 0; k < 3; k++)
      if (dof_map->frame_of[i] < 0 && dof_map->state[3 * (size_t)i + k] == BW_DOF_ISOSTATIC)
        fix(c, i, k, 0);
  return c->fixed_count - before;
}

/* CalculiX takes one coefficient of expansion for a material and one temperature for each node:
 * loads with other coefficients are scaled to the largest, and those by material added. *out is
 * NULL where nothing expands. */
static bw_status temperatures(bw_context *context, const bw_model *model, const char *path,
                              bw_inp_material *material, double **out) {
  const bw_load *largest = NULL;
  *out = NULL;
  for (int l = 0; l < model->load_count; l++) {
    const bw_load *load = &model->load[l];
    if (load->kind != BW_LOAD_TEMPERATURE)
      continue;
    if (largest && largest->by_material != load->by_material)
      return bw_fail(context, BW_UNSUPPORTED,
                     "%s: one temperature has a coefficient of expansion of its own, another that "
                     "of the materials, and a deck has one temperature for each node: give both "
                     "the same way",
                     path);
    if (!largest || fabs(load->expansion) > fabs(largest->expansion))
      largest = load;
  }
  if (!largest || (!largest->by_material && largest->expansion == 0))
    return BW_OK;
  *out = BW_NEW0(context, double, model->mesh->node_count);
  if (!*out)
    return BW_MEMORY;
  for (int32_t i = 0; i < bw_material_part_count(model->material); i++)
    material[i].expansion =
        largest->by_material ? bw_material_part(model->material, i)->expansion : largest->expansion;
  for (int l = 0; l < model->load_count; l++) {
    const bw_load *load = &model->load[l];
    double scale = load->by_material ? 1 : load->expansion / largest->expansion;
    for (int32_t i = 0; load->kind == BW_LOAD_TEMPERATURE && i < model->mesh->node_count; i++)
      (*out)[i] += scale * bw_array_get(load->nodal, i, 0);
  }
  return BW_OK;
}

static bw_inp_material deck_material(const bw_material *m) {
  bw_inp_material made = {.isotropic = m->isotropic,
                          .young = m->young[0],
                          .poisson = m->poisson[0],
                          .density = m->density};
  anisotropic_constants(m->elasticity, made.stiffness);
  return made;
}

/* The joints, and the weight of masses. What is isostatic of bodies that joints hold is not so. */
static bw_status joints(bw_context *context, const bw_model *model, const char *path, int modes,
                        bw_dof_map *dof_map, bwi_inp_joints *j, uint8_t *joined, double *force) {
  bw_status status = BW_OK;
  int count = 0;
  int32_t body = -1;
  for (int64_t i = 0; i < 3 * (int64_t)model->mesh->node_count; i++)
    if (dof_map->state[i] == BW_DOF_ISOSTATIC)
      dof_map->state[i] = BW_DOF_UNKNOWN;
  BW_TRY(bwi_bonded_rigid_modes(context, model, dof_map, modes > 0, &count, &body));
  if (count > 0 && modes == 0)
    return bw_fail(context, BW_UNCONSTRAINED,
                   "%s: supports, bonds, couplings and springs leave %d rigid-body mode%s "
                   "unconstrained, and a static step has no solution: add supports or springs",
                   path, count, count == 1 ? "" : "s");
  BW_TRY(bwi_inp_joints_make(context, model, dof_map, path, modes > 0, j, joined));
  if (modes == 0)
    bwi_inp_add_weights(model, force);
done:
  return status;
}

bw_status bw_model_write_inp(bw_context *context, const bw_model *model, const char *path,
                             int modes) {
  const bw_mesh *mesh = model->mesh;
  bw_dof_map *dof_map = NULL;
  conditions c = {0};
  bwi_inp_joints j = {0};
  uint8_t *joined = NULL;
  double *force = NULL, *temperature = NULL;
  int32_t parts = bw_material_part_count(model->material);
  bw_inp_material *material = NULL;
  bw_inp_deck deck = {.mesh = mesh, .title = "written by barwright", .modes = modes};
  bw_status status;
  if (modes < 0)
    return bw_fail(context, BW_INVALID, "%d modes requested: 0 for a static step, or more", modes);
  if (model->material->formulation == BW_B_BAR)
    bw_warn(context,
            "%s: the deck has C3D10 elements, which are of the standard formulation; the model's "
            "are B-bar, and displacements differ where Poisson's ratio is near 0.5",
            path);
  material = BW_NEW(context, bw_inp_material, parts);
  BW_TRY_MEMORY(material);
  for (int32_t i = 0; i < parts; i++)
    material[i] = deck_material(bw_material_part(model->material, i));
  if (model->cyclic)
    BW_TRY(bw_model_refuse_joints(context, model));
  BW_TRY(bwi_dof_map_apart(context, model, &dof_map));
  int64_t max = 0;
  for (size_t i = 0; i < 3 * (size_t)mesh->node_count; i++)
    if (dof_map->state[i] != BW_DOF_UNKNOWN)
      max += 2; /* two conditions at most for one constrained direction */
  c.fixed_node = BW_NEW(context, int32_t, max);
  c.fixed_direction = BW_NEW(context, int, max);
  c.fixed_value = BW_NEW(context, double, max);
  c.equation_node = BW_NEW(context, int32_t, max);
  c.equation_normal = BW_NEW(context, double, 3 * max);
  force = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
  BW_TRY_MEMORY(c.fixed_node && c.fixed_direction && c.fixed_value && c.equation_node &&
                c.equation_normal && force);
  /* Modes of a free body are free; a static step needs the isostatic constraints, which carry no
   * load. */
  for (size_t i = 0; modes > 0 && i < 3 * (size_t)mesh->node_count; i++)
    if (dof_map->state[i] == BW_DOF_ISOSTATIC)
      dof_map->state[i] = BW_DOF_UNKNOWN;
  BW_TRY(bwi_force_vector(context, model, false, force));
  if (bw_model_joined(model)) {
    joined = BW_NEW0(context, uint8_t, mesh->node_count);
    BW_TRY_MEMORY(joined);
    BW_TRY(joints(context, model, path, modes, dof_map, &j, joined, force));
  }
  BW_TRY(supports(context, dof_map, joined, &c));
  deck.isostatic_count = isostatic(dof_map, &c);
  if (modes == 0 && !joined && dof_map->rigid_mode_count > 0)
    bw_warn(
        context,
        "%s: the body is free, and the deck holds it by %d isostatic constraints, which carry no "
        "load where the loads balance. Remove them before you add contact, springs or supports%s",
        path, (int)dof_map->rigid_mode_count,
        deck.isostatic_count < dof_map->rigid_mode_count
            ? "; those at nodes with an oblique support have no comment in the deck"
            : "");
  if (modes == 0)
    BW_TRY(temperatures(context, model, path, material, &temperature));
  bwi_sum_gravity(model, deck.gravity);
  deck.material_count = parts;
  deck.material = material;
  deck.material_of = model->material->parts ? model->material->parts->of_element : NULL;
  deck.fixed_count = c.fixed_count;
  deck.fixed_node = c.fixed_node;
  deck.fixed_direction = c.fixed_direction;
  deck.fixed_value = c.fixed_value;
  deck.equation_count = c.equation_count;
  deck.equation_node = c.equation_node;
  deck.equation_normal = c.equation_normal;
  deck.force = force;
  deck.temperature = temperature;
  BW_TRY(bwi_inp_write(context, &deck, joined ? &j : NULL, path));
done:
  bwi_inp_joints_clear(&j);
  bw_free(joined);
  bw_free(c.fixed_node);
  bw_free(c.fixed_direction);
  bw_free(c.fixed_value);
  bw_free(c.equation_node);
  bw_free(c.equation_normal);
  bw_free(force);
  bw_free(temperature);
  bw_free(material);
  bw_release(dof_map);
  return status;
}
