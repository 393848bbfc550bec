/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which displacement components are unknowns, prescribed or isostatic constraints: states, values
 * and frames from what the supports constrain; the rigid-body modes of every body; the isostatic
 * constraints are chosen in isostatic.c. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "model/internal.h"

static void dof_map_destroy(void *object) {
  bw_dof_map *dof_map = (bw_dof_map *)object;
  bw_release(dof_map->mesh);
  bw_free(dof_map->unknown);
  bw_free(dof_map->state);
  bw_free(dof_map->frame_of);
  bw_free(dof_map->frame);
  bw_free(dof_map->value);
  bw_free(dof_map->rigid_mode);
  bw_free(dof_map->rigid_mode_start);
  bw_free(dof_map->body_start);
  bw_free(dof_map->body_node);
  bw_free(dof_map->body_volume);
  bw_free(dof_map->body_centre);
  bw_free(dof_map->weight);
  bw_free(dof_map);
}

static size_t dof_map_bytes(const void *object) {
  const bw_dof_map *dof_map = (const bw_dof_map *)object;
  size_t nodes = (size_t)dof_map->mesh->node_count;
  size_t bodies = (size_t)dof_map->mesh->component_count;
  return sizeof *dof_map + nodes * (3 * 4 + 3 + 4 + 3 * 8 + 4 + (dof_map->weight ? 4 * 8 : 0)) +
         (size_t)dof_map->frame_count * 72 + bodies * 40 +
         (size_t)dof_map->rigid_mode_count * sizeof *dof_map->rigid_mode;
}

static const bw_kind dof_map_kind = {"DOF map", dof_map_destroy, dof_map_bytes};

/* A unit vector orthogonal to `count` orthonormal ones, as near to a global axis as can be. */
static void complete(int count, double (*row)[3]) {
  double best = 0, pick[3] = {0, 0, 0};
  for (int axis = 0; axis < 3; axis++) {
    double v[3] = {axis == 0, axis == 1, axis == 2};
    for (int i = 0; i < count; i++) {
      double part = bw_dot(v, row[i]);
      for (int k = 0; k < 3; k++)
        v[k] -= part * row[i][k];
    }
    double size = bw_norm(v);
    if (size > best + 1e-6) {
      best = size;
      for (int k = 0; k < 3; k++)
        pick[k] = v[k] / size;
    }
  }
  memcpy(row[count], pick, sizeof pick);
}

/* The frame of a node that is constrained along one or two directions, these first. Following an
 * edit, the rest is chosen as seen from the node's subdomain, so that where both rotate together,
 * the frame does. */
static void support_frame(const bwi_constraint *at, const bwi_follow *follow, double row[3][3]) {
  const double *rotation = NULL;
  if (follow && follow->node_subdomain[at->node] >= 0)
    rotation = follow->frame + 9 * (size_t)follow->node_subdomain[at->node];
  memcpy(row, at->direction, 3 * sizeof *row);
  if (at->count == 1 && rotation) {
    double seen[3][3];
    for (int k = 0; k < 3; k++)
      seen[0][k] = bw_dot(rotation + 3 * k, row[0]);
    complete(1, seen);
    for (int k = 0; k < 3; k++)
      row[1][k] =
          rotation[k] * seen[1][0] + rotation[3 + k] * seen[1][1] + rotation[6 + k] * seen[1][2];
  } else if (at->count == 1)
    complete(1, row);
  bw_cross(row[0], row[1], row[2]);
}

/* Turns what is constrained at nodes into states, values and frames. Following an edit, every node
 * that is constrained in part has a frame of its own, along the global axes or not: so its state
 * does not depend on how the surface lies just now. */
static bw_status apply_constraints(bw_context *context, bw_dof_map *dof_map, int32_t count,
                                   const bwi_constraint *constraint, const bwi_follow *follow) {
  int32_t frames = 0;
  for (int pass = 0; pass < 2; pass++) {
    if (pass == 1 && frames > 0) {
      dof_map->frame = BW_NEW(context, double, 9 * (size_t)frames);
      if (!dof_map->frame)
        return BW_MEMORY;
    }
    dof_map->frame_count = frames;
    frames = 0;
    for (int32_t h = 0; h < count; h++) {
      const bwi_constraint *at = &constraint[h];
      size_t base = 3 * (size_t)at->node;
      /* Global components serve when every global axis is either constrained or free. */
      bool global = !follow, constrained[3];
      double value[3] = {0, 0, 0};
      for (int k = 0; k < 3; k++) {
        double part = 0;
        for (int i = 0; i < at->count; i++) {
          part += at->direction[i][k] * at->direction[i][k];
          value[k] += at->direction[i][k] * at->value[i];
        }
        constrained[k] = part > 0.5;
        if (part > 1e-18 && part < 1 - 1e-9) /* squares: an angle of 1e-9 */
          global = false;
      }
      if (global || at->count == 3) {
        for (int k = 0; pass == 1 && k < 3; k++)
          if (constrained[k]) {
            dof_map->state[base + (size_t)k] = BW_DOF_PRESCRIBED;
            dof_map->value[base + (size_t)k] = value[k];
          }
        continue;
      }
      if (pass == 1) {
        double row[3][3];
        support_frame(at, follow, row);
        memcpy(dof_map->frame + 9 * (size_t)frames, row, sizeof row);
        dof_map->frame_of[at->node] = frames;
        for (int i = 0; i < at->count; i++) {
          dof_map->state[base + (size_t)i] = BW_DOF_PRESCRIBED;
          dof_map->value[base + (size_t)i] = at->value[i];
        }
      }
      frames++;
    }
  }
  for (size_t i = 0; i < 3 * (size_t)dof_map->mesh->node_count; i++)
    if (dof_map->value[i] != 0)
      dof_map->prescribed = true;
  return BW_OK;
}

/* The rigid-body modes of every body, and their isostatic constraints. */
static bw_status free_bodies(bw_context *context, bw_dof_map *dof_map, int32_t constraint_count,
                             const bwi_constraint *constraint, const double *inertia,
                             const bw_dof_map *previous) {
  const bw_mesh *mesh = dof_map->mesh;
  bw_status status = BW_OK;
  size_t capacity = 0, bodies = (size_t)mesh->component_count;
  double(*row)[6] = NULL;
  int64_t *start = BW_NEW0(context, int64_t, bodies + 1);
  int32_t *order = BW_NEW(context, int32_t, constraint_count);
  BW_TRY_MEMORY(start && order);
  /* constraints by body */
  for (int32_t h = 0; h < constraint_count; h++)
    start[mesh->component[constraint[h].node] + 1]++;
  int64_t max = 0;
  for (size_t body = 0; body < bodies; body++) {
    max = start[body + 1] > max ? start[body + 1] : max;
    start[body + 1] += start[body];
  }
  /* backwards, with ends as cursors, then restored */
  for (int32_t h = constraint_count - 1; h >= 0; h--)
    order[--start[mesh->component[constraint[h].node] + 1]] = h;
  for (size_t body = 0; body < bodies; body++)
    start[body] = start[body + 1];
  start[bodies] = constraint_count;
  row = (double(*)[6])bw_alloc(context, 3 * (size_t)max, sizeof *row);
  BW_TRY_MEMORY(row);
  for (int32_t body = 0; body < mesh->component_count; body++) {
    const double *centre = dof_map->body_centre + 3 * (size_t)body;
    const double *j = inertia + 9 * (size_t)body;
    double length = sqrt((j[0] + j[4] + j[8]) / 2); /* radius of gyration */
    int64_t rows = 0;
    for (int64_t o = start[body]; o < start[body + 1]; o++) {
      const bwi_constraint *at = &constraint[order[o]];
      const double *x = mesh->node + 3 * (size_t)at->node;
      double y[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
      for (int i = 0; i < at->count; i++, rows++) {
        memcpy(row[rows], at->direction[i], 3 * sizeof **row);
        bw_cross(y, at->direction[i], row[rows] + 3);
        for (int k = 3; k < 6; k++)
          row[rows][k] /= length;
      }
    }
    BW_TRY(bw_check_cancel(context));
    BW_TRY_MEMORY(bw_grow(context, (void **)&dof_map->rigid_mode, &capacity,
                          (size_t)dof_map->rigid_mode_count, 6, sizeof *dof_map->rigid_mode));
    bw_rigid_mode *motion = dof_map->rigid_mode + dof_map->rigid_mode_count;
    int count = bwi_rigid_modes(dof_map, body, j, length, rows, (const double(*)[6])row, motion);
    BW_TRY(bwi_add_isostatic(context, dof_map, body, count, motion, length, previous));
    dof_map->rigid_mode_count += count;
    dof_map->rigid_mode_start[body + 1] = dof_map->rigid_mode_count;
  }
done:
  bw_free(row);
  bw_free(start);
  bw_free(order);
  return status;
}

/* Nodes with the frame of their subdomain: what is constrained is known, what is isostatic is not
 * yet. */
static bw_status take_frames(bw_context *context, bw_dof_map *dof_map, const bwi_follow *follow) {
  int32_t first = dof_map->frame_count, subdomains = follow->subdomain_count;
  if ((int64_t)first + subdomains > INT32_MAX)
    return bw_fail(
        context, BW_LIMIT,
        "%d subdomains: the frames of supports and subdomains are more than the limit of 2^31 - 1",
        subdomains);
  double *all = (double *)bw_resize(context, dof_map->frame,
                                    9 * ((size_t)first + (size_t)subdomains), sizeof *all);
  if (!all)
    return BW_MEMORY;
  dof_map->frame = all;
  dof_map->frame_count = first + subdomains;
  memcpy(all + 9 * (size_t)first, follow->frame, 9 * (size_t)subdomains * sizeof *all);
  for (int32_t i = 0; i < dof_map->mesh->node_count; i++) {
    const uint8_t *state = dof_map->state + 3 * (size_t)i;
    int32_t subdomain = follow->node_subdomain[i];
    if (subdomain < 0 || state[0] != state[1] || state[1] != state[2])
      continue;
    if (subdomain >= subdomains)
      return bw_fail(context, BW_INVALID, "node %d is in subdomain %d: the subdomains are 1 to %d",
                     i + 1, subdomain + 1, subdomains);
    dof_map->frame_of[i] = first + subdomain;
    double *value = dof_map->value + 3 * (size_t)i, global[3];
    memcpy(global, value, sizeof global);
    for (size_t k = 0; k < 3; k++)
      value[k] = bw_dot(follow->frame + 9 * (size_t)subdomain + 3 * k, global);
  }
  return BW_OK;
}

#ifndef NDEBUG
/* Numbers ascend over the unknowns and nothing else, every node belongs to one body, and there
 * are as many isostatic constraints as unconstrained rigid-body modes. */
static bool is_consistent(const bw_dof_map *dof_map) {
  const bw_mesh *mesh = dof_map->mesh;
  int32_t count = 0, isostatic = 0;
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++) {
    if (dof_map->unknown[i] != (dof_map->state[i] == BW_DOF_UNKNOWN ? count++ : -1))
      return false;
    isostatic += dof_map->state[i] == BW_DOF_ISOSTATIC;
    if (dof_map->frame_of[i / 3] < -1 || dof_map->frame_of[i / 3] >= dof_map->frame_count)
      return false;
  }
  for (int32_t b = 0; b < mesh->component_count; b++)
    for (int32_t k = dof_map->body_start[b]; k < dof_map->body_start[b + 1]; k++)
      if (mesh->component[dof_map->body_node[k]] != b)
        return false;
  return count == dof_map->unknown_count && isostatic == dof_map->rigid_mode_count &&
         dof_map->body_start[mesh->component_count] == mesh->node_count;
}
#endif

bw_status bwi_number(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                     int32_t constraint_count, const bwi_constraint *constraint,
                     const bwi_follow *follow, bw_dof_map **out) {
  size_t nodes = (size_t)mesh->node_count, bodies = (size_t)mesh->component_count;
  double *inertia = NULL;
  bw_status status = BW_OK;
  if (mesh->node_count > INT32_MAX / 3)
    return bw_fail(context, BW_LIMIT, "%d nodes have more than 2^31 - 1 displacement components",
                   mesh->node_count);
  bw_dof_map *dof_map = BW_NEW0(context, bw_dof_map, 1);
  if (!dof_map)
    return BW_MEMORY;
  bw_object_init(dof_map, &dof_map_kind);
  dof_map->mesh = (const bw_mesh *)bw_retain(mesh);
  dof_map->unknown = BW_NEW(context, int32_t, 3 * nodes);
  dof_map->state = BW_NEW0(context, uint8_t, 3 * nodes);
  dof_map->frame_of = BW_NEW(context, int32_t, nodes);
  dof_map->value = BW_NEW0(context, double, 3 * nodes);
  dof_map->rigid_mode_start = BW_NEW0(context, int32_t, bodies + 1);
  dof_map->body_start = BW_NEW0(context, int32_t, bodies + 1);
  dof_map->body_node = BW_NEW(context, int32_t, nodes);
  dof_map->body_volume = BW_NEW(context, double, bodies);
  dof_map->body_centre = BW_NEW(context, double, 3 * bodies);
  dof_map->weight = BW_NEW(context, double, 4 * nodes);
  inertia = BW_NEW(context, double, 9 * bodies);
  BW_TRY_MEMORY(dof_map->unknown && dof_map->state && dof_map->frame_of && dof_map->value &&
                dof_map->rigid_mode_start && dof_map->body_start && dof_map->body_node &&
                dof_map->body_volume && dof_map->body_centre && dof_map->weight && inertia);
  for (size_t i = 0; i < nodes; i++) {
    dof_map->frame_of[i] = -1;
    dof_map->body_start[mesh->component[i] + 1]++;
  }
  for (size_t body = 0; body < bodies; body++)
    dof_map->body_start[body + 1] += dof_map->body_start[body];
  for (int32_t i = mesh->node_count - 1; i >= 0; i--) /* ends as cursors: they become the starts */
    dof_map->body_node[--dof_map->body_start[mesh->component[i] + 1]] = i;
  for (size_t body = 0; body < bodies; body++)
    dof_map->body_start[body] = dof_map->body_start[body + 1];
  dof_map->body_start[bodies] = mesh->node_count;

  BW_TRY(bwi_moments(context, dof_map, material, inertia));
  BW_TRY(apply_constraints(context, dof_map, constraint_count, constraint, follow));
  if (follow)
    BW_TRY(take_frames(context, dof_map, follow));
  BW_TRY(free_bodies(context, dof_map, constraint_count, constraint, inertia,
                     follow ? follow->previous : NULL));
  for (size_t i = 0; i < 3 * nodes; i++)
    dof_map->unknown[i] = dof_map->state[i] == BW_DOF_UNKNOWN ? dof_map->unknown_count++ : -1;
  if (dof_map->rigid_mode_count == 0) {
    bw_free(dof_map->weight);
    dof_map->weight = NULL;
  }
  assert(is_consistent(dof_map));
  *out = dof_map;
done:
  bw_free(inertia);
  if (status != BW_OK)
    bw_release(dof_map);
  return status;
}

bw_status bw_dof_map_unconstrained(bw_context *context, const bw_mesh *mesh, bw_dof_map **dof_map) {
  return bwi_number(context, mesh, NULL, 0, NULL, NULL, dof_map);
}

bw_status bw_dof_map_create(bw_context *context, const bw_model *model, bw_dof_map **dof_map) {
  bw_status status = bw_model_refuse_joints(context, model);
  return status == BW_OK ? bwi_dof_map_apart(context, model, dof_map) : status;
}

bw_status bwi_dof_map_apart(bw_context *context, const bw_model *model, bw_dof_map **dof_map) {
  int32_t count = 0;
  bwi_constraint *constraint = NULL;
  bw_status status;
  BW_TRY(bwi_node_constraints(context, model, &count, &constraint));
  BW_TRY(bwi_number(context, model->mesh, model->material, count, constraint, NULL, dof_map));
done:
  bw_free(constraint);
  return status;
}

/* ---- in words -------------------------------------------------------------------------------- */

/* Bodies listed in a message; the rest are counted. */
enum { BODIES_NAMED = 4 };

bw_status bw_dof_map_describe_rigid_modes(bw_context *context, const bw_dof_map *dof_map,
                                          char **text) {
  bwi_text out = {.context = context};
  int32_t bodies = dof_map->mesh->component_count, named = 0, more = 0;
  if (dof_map->rigid_mode_count == 0)
    bwi_text_add(&out, "no rigid-body mode is unconstrained");
  for (int32_t body = 0; body < bodies; body++) {
    int32_t first = dof_map->rigid_mode_start[body], next = dof_map->rigid_mode_start[body + 1];
    if (first == next)
      continue;
    if (named == BODIES_NAMED) {
      more++;
      continue;
    }
    if (named++ > 0)
      bwi_text_add(&out, "; ");
    if (bodies > 1) {
      bwi_text_add(&out, "body ");
      bwi_text_integer(&out, body + 1);
      bwi_text_add(&out, " of ");
      bwi_text_integer(&out, bodies);
      bwi_text_add(&out, " (around ");
      bwi_text_vector(&out, dof_map->body_centre + 3 * (size_t)body, 4, 0);
      bwi_text_add(&out, " m, ");
      bwi_text_number(&out, dof_map->body_volume[body], 4, 0);
      bwi_text_add(&out, " m3): ");
    }
    bwi_text_integer(&out, next - first);
    bwi_text_add(&out, next - first == 1 ? " rigid-body mode is unconstrained: "
                                         : " rigid-body modes are unconstrained: ");
    for (int32_t m = first; m < next; m++) {
      if (m > first)
        bwi_text_add(&out, ", ");
      bwi_text_add(&out, dof_map->rigid_mode[m].text);
    }
  }
  if (more > 0) {
    bwi_text_add(&out, "; and ");
    bwi_text_integer(&out, more);
    bwi_text_add(&out, more == 1 ? " more body" : " more bodies");
  }
  if (out.failed) {
    bw_free(out.bytes);
    return BW_MEMORY;
  }
  *text = out.bytes;
  return BW_OK;
}
