/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The model of the whole wheel: what bonds, holds and loads a sector, turned with each of them. */
#include <math.h>
#include <string.h>

#include "joint/cyclic.h"

typedef struct turning {
  bw_context *context;
  const bwi_wheel *wheel;
  const bw_model *from;
  bw_model *to;
} turning;

/* The corner of its element that a boundary facet lacks. */
static int opposite(const bw_mesh *mesh, int32_t facet) {
  const int32_t *node = mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
  const int32_t *corner =
      mesh->element + (int64_t)mesh->facet_element[facet] * mesh->nodes_per_element;
  for (int k = 0; k < 3; k++)
    if (corner[k] != node[0] && corner[k] != node[1] && corner[k] != node[2])
      return k;
  return 3;
}

/* What a selection has in one sector, or in all where that is -1. What lies inside the wheel is
 * left out; NULL where nothing stays. */
static bw_status turn_selection(const turning *t, int sector, const bw_selection *on,
                                bw_selection **out) {
  bw_status status = BW_OK;
  const bwi_wheel *w = t->wheel;
  const bw_mesh *mesh = w->mesh, *from = w->sector;
  int32_t facets = 0, nodes = 0, *facet = BW_NEW(t->context, int32_t, mesh->facet_count),
          *node = BW_NEW(t->context, int32_t, mesh->node_count);
  uint8_t *chosen = BW_NEW0(t->context, uint8_t, from->element_count),
          *marked = BW_NEW0(t->context, uint8_t, mesh->node_count);
  *out = NULL;
  BW_TRY_MEMORY(facet && node && chosen && marked);
  for (int32_t i = 0; i < on->facet_count; i++)
    chosen[from->facet_element[on->facet[i]]] |= (uint8_t)(1 << opposite(from, on->facet[i]));
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    int32_t element = mesh->facet_element[f], s = element / from->element_count;
    if ((sector < 0 || s == sector) &&
        chosen[element % from->element_count] >> opposite(mesh, f) & 1)
      facet[facets++] = f;
  }
  for (int s = 0; s < w->cyclic->count; s++)
    for (int32_t i = 0; (sector < 0 || s == sector) && i < on->node_count; i++)
      marked[bwi_wheel_node(w, s, on->node[i])] = 1;
  for (int32_t i = 0; i < mesh->boundary_node_count; i++)
    if (marked[mesh->boundary_node[i]])
      node[nodes++] = mesh->boundary_node[i];
  if (nodes == 0 || (facets == 0 && on->facet_count > 0))
    goto done;
  BW_TRY(bwi_selection_copy(t->context, mesh, facets, facet, nodes, node, out));
  (*out)->node_set = on->node_set;
done:
  bw_free(facet);
  bw_free(node);
  bw_free(chosen);
  bw_free(marked);
  return status;
}

/* ---- supports -------------------------------------------------------------------------------- */

/* A support whose directions turn with the sectors, in each of them; `support` has its sector's
 * numbers. */
static bw_status add_turned(const turning *t, const bw_support *support, bool turns) {
  bw_status status = BW_OK;
  bw_selection *on = NULL;
  double rotation[9];
  for (int s = 0; s < (turns ? t->wheel->cyclic->count : 1); s++) {
    bw_support made = *support;
    bwi_cyclic_rotation(t->wheel->cyclic, s, rotation);
    BW_TRY(turn_selection(t, turns ? s : -1, support->on, &on));
    if (!on)
      continue;
    made.on = on;
    bwi_rotate(rotation, support->normal, made.normal);
    bwi_rotate(rotation, support->value, made.value);
    BW_TRY(bwi_model_add_support(t->context, t->to, &made));
    bw_release(on);
    on = NULL;
  }
done:
  bw_release(on);
  return status;
}

static bool along_axis(const turning *t, const double v[3]) {
  double side[3], part = bw_dot(v, t->wheel->cyclic->axis);
  for (int k = 0; k < 3; k++)
    side[k] = v[k] - part * t->wheel->cyclic->axis[k];
  return bw_norm(side) <= 1e-9 * bw_norm(v);
}

static bw_status turn_support(const turning *t, int number) {
  bw_status status = BW_OK;
  const bw_support *support = &t->from->support[number];
  bool all = support->fixed[0] && support->fixed[1] && support->fixed[2];
  if (support->field)
    return bw_fail(t->context, BW_UNSUPPORTED,
                   "support %d moves nodes by a field, which is not carried over to the whole",
                   number + 1);
  if (support->slide || all) {
    BW_TRY(
        add_turned(t, support, !along_axis(t, support->slide ? support->normal : support->value)));
    return BW_OK;
  }
  if (bw_norm(support->value) > 0)
    return bw_fail(t->context, BW_UNSUPPORTED,
                   "support %d prescribes a displacement in some directions only, which is not "
                   "carried over to the whole: directions turn with the sectors",
                   number + 1);
  for (int k = 0; k < 3; k++) {
    bw_support made = {.on = support->on, .slide = true};
    made.normal[k] = 1;
    if (support->fixed[k])
      BW_TRY(add_turned(t, &made, !along_axis(t, made.normal)));
  }
done:
  return status;
}

/* ---- loads ----------------------------------------------------------------------------------- */

static bw_status turn_nodal(const turning *t, const bw_load *load) {
  bw_status status = BW_OK;
  const bwi_wheel *w = t->wheel;
  bool force = load->kind == BW_LOAD_NODAL;
  int columns = force ? 3 : 1;
  bw_load made = *load;
  double *own = BW_NEW(t->context, double, columns *(int64_t)w->sector->node_count);
  bw_array *all = NULL;
  BW_TRY_MEMORY(own);
  for (int32_t i = 0; i < w->sector->node_count; i++)
    for (int k = 0; k < columns; k++)
      own[columns * (int64_t)i + k] = bw_array_get(load->nodal, i, k);
  BW_TRY(bw_array_create(t->context, BW_F64, w->mesh->node_count, columns, &all));
  if (force)
    bwi_wheel_add_forces(w, own, all->data);
  else
    bwi_wheel_spread(w, own, all->data);
  made.nodal = all;
  BW_TRY(bwi_model_add_load(t->context, t->to, &made));
done:
  bw_free(own);
  bw_release(all);
  return status;
}

static bw_status turn_load(const turning *t, int number) {
  bw_status status = BW_OK;
  const bw_load *load = &t->from->load[number];
  bool turns = load->kind != BW_LOAD_PRESSURE && load->kind != BW_LOAD_GRAVITY;
  bw_selection *on = NULL;
  double rotation[9];
  if (load->nodal)
    return turn_nodal(t, load);
  for (int s = 0; s < (turns ? t->wheel->cyclic->count : 1); s++) {
    bw_load made = *load;
    bwi_cyclic_rotation(t->wheel->cyclic, s, rotation);
    if (turns) {
      bwi_rotate(rotation, load->vector, made.vector);
      bwi_cyclic_place(t->wheel->cyclic, rotation, load->about, made.about);
    }
    if (load->on)
      BW_TRY(turn_selection(t, turns ? s : -1, load->on, &on));
    if (load->on && !on)
      continue;
    made.on = on;
    BW_TRY(bwi_model_add_load(t->context, t->to, &made));
    bw_release(on);
    on = NULL;
  }
done:
  bw_release(on);
  return status;
}

/* ---- attachments ----------------------------------------------------------------------------- */

/* A spring that is alike in all directions, and a mass, are the same in each sector. */
static bw_status turn_attachment(const turning *t, int number) {
  bw_status status = BW_OK;
  const bw_attachment *attachment = &t->from->attachment[number];
  const double *k = attachment->stiffness;
  bw_selection *on = NULL;
  if (k[0] != k[1] || k[1] != k[2])
    return bw_fail(t->context, BW_UNSUPPORTED,
                   "attachment %d is a spring that differs along x, y and z, which is not carried "
                   "over to the whole: its directions turn with the sectors",
                   number + 1);
  for (int s = 0; s < t->wheel->cyclic->count; s++) {
    BW_TRY(turn_selection(t, s, attachment->on, &on));
    if (!on)
      return bw_fail(t->context, BW_UNSUPPORTED,
                     "attachment %d lies inside the whole: it is not carried over", number + 1);
    BW_TRY(attachment->mass > 0
               ? bw_model_attach_mass(t->context, t->to, on, attachment->mass)
               : bw_model_attach_spring(t->context, t->to, on, attachment->stiffness));
    bw_release(on);
    on = NULL;
  }
done:
  bw_release(on);
  return status;
}

/* ---- bonds ----------------------------------------------------------------------------------- */

/* One bond for those of all sectors. */
static bw_status turn_bond(const turning *t, int number) {
  bw_status status = BW_OK;
  const bw_bond *bond = &t->from->bond[number];
  bw_selection *a = NULL, *b = NULL;
  BW_TRY(turn_selection(t, -1, bond->a, &a));
  BW_TRY(turn_selection(t, -1, bond->b, &b));
  if (!a || !b)
    BW_TRY(bw_fail(t->context, BW_UNSUPPORTED,
                   "bond %d lies inside the whole: it is not carried over", number + 1));
  BW_TRY(bw_model_bond(t->context, t->to, a, b, bond->asked_gap));
done:
  bw_release(a);
  bw_release(b);
  return status;
}

bw_status bwi_wheel_model(bw_context *context, const bwi_wheel *wheel, const bw_model *from,
                          bw_model **model) {
  bw_status status = BW_OK;
  turning t = {context, wheel, from, NULL};
  BW_TRY(bw_model_create(context, wheel->mesh, wheel->material, &t.to));
  for (int i = 0; i < from->support_count; i++)
    BW_TRY(turn_support(&t, i));
  for (int i = 0; i < from->bond_count; i++)
    BW_TRY(turn_bond(&t, i));
  for (int i = 0; i < from->attachment_count; i++)
    BW_TRY(turn_attachment(&t, i));
  for (int i = 0; i < from->load_count; i++)
    BW_TRY(turn_load(&t, i));
  *model = t.to;
  t.to = NULL;
done:
  bw_release(t.to);
  return status;
}
