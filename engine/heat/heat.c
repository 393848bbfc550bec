/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A body and its conditions of heat, each checked when it is added. */
#include "heat/internal.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <string.h>

static void heat_destroy(void *object) {
  bw_heat *heat = object;
  for (int i = 0; i < heat->condition_count; i++) {
    bw_release(heat->condition[i].on);
    bw_release(heat->condition[i].with);
    bw_release(heat->condition[i].nodal);
    bwi_heat_unpair(&heat->condition[i]);
  }
  bw_free(heat->condition);
  bw_release(heat->mesh);
  bw_release(heat->material);
  bw_free(heat);
}

static size_t heat_bytes(const void *object) {
  const bw_heat *heat = object;
  size_t bytes = sizeof *heat + (size_t)heat->condition_count * sizeof *heat->condition;
  for (int i = 0; i < heat->condition_count; i++) {
    const bw_heat_condition *c = &heat->condition[i];
    bytes += bw_bytes(c->joint) + (c->bond ? bw_bytes(c->bond->follows) : 0);
  }
  return bytes;
}

static const bw_kind heat_kind = {"heat", heat_destroy, heat_bytes};

bw_status bw_heat_create(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                         bw_heat **heat) {
  if (!mesh || !material)
    return bw_fail(context, BW_INVALID, "heat needs a mesh and a material");
  bw_status status = bw_material_fits(context, material, mesh->element_count);
  if (status == BW_OK)
    status = bwi_mesh_check_overlaps(context, mesh);
  if (status != BW_OK)
    return status;
  for (int32_t i = 0; i < bw_material_part_count(material); i++)
    if (!(bw_material_part(material, i)->thermal.conductivity[0] > 0))
      return bw_fail(context, BW_INVALID,
                     "material %s has no conductivity: give one in W/(m K), or take steel, "
                     "aluminium or pla of the library",
                     bw_material_part(material, i)->name);
  bw_heat *made = BW_NEW0(context, bw_heat, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &heat_kind);
  made->mesh = bw_retain(mesh);
  made->material = bw_retain(material);
  *heat = made;
  return BW_OK;
}

static const char *const kind_word[] = {"a prescribed temperature",
                                        "a heat flux",
                                        "a power",
                                        "a source",
                                        "convection",
                                        "radiation",
                                        "contact",
                                        "a bond"};

static bw_status check_value(bw_context *context, const bw_heat_condition *c, double value) {
  if (!isfinite(value))
    return bw_fail(context, BW_INVALID, "the value of %s is not a finite number",
                   kind_word[c->kind]);
  if (c->kind == BW_HEAT_RADIATION && value < 0)
    return bw_fail(context, BW_INVALID,
                   "radiation towards what is at %g K: temperatures are in kelvin, from absolute "
                   "zero",
                   value);
  return BW_OK;
}

static bw_status check_selection(bw_context *context, const bw_heat *heat,
                                 const bw_heat_condition *c) {
  const char *what = kind_word[c->kind];
  if (!c->on)
    return c->kind == BW_HEAT_SOURCE || c->kind == BW_HEAT_POWER
               ? BW_OK
               : bw_fail(context, BW_INVALID, "%s needs a selection of the mesh's boundary", what);
  if (c->kind == BW_HEAT_SOURCE)
    return bw_fail(context, BW_INVALID,
                   "a source acts in the whole body: leave the selection out, or give a flux");
  if (bwi_heat_joins(c) && !c->with)
    return bw_fail(context, BW_INVALID, "%s needs the selection that it is with", what);
  if (c->on->mesh != heat->mesh || (c->with && c->with->mesh != heat->mesh))
    return bw_fail(context, BW_INVALID,
                   "%s is given on a selection of another mesh: select on the body's own mesh",
                   what);
  bool points = c->kind == BW_HEAT_TEMPERATURE && c->on->node_set && c->on->node_count > 0;
  for (int k = 0; k < (c->with ? 2 : 1); k++) {
    const bw_selection *side = k ? c->with : c->on;
    if (side->facet_count == 0 && !points)
      return bw_fail(context, BW_EMPTY,
                     "%s acts on area, but the selection has %d nodes and no whole facet: give a "
                     "larger tolerance, or select the face",
                     what, side->node_count);
  }
  return BW_OK;
}

/* A joint far stiffer than the elements beside it takes the digits of their conduction. */
static bw_status check_conductance(bw_context *context, const bw_heat *heat,
                                   const bw_heat_condition *c) {
  const double most = 1e9; /* (-) conductance of a facet over that of an element */
  double conductivity = INFINITY, length = sqrt(bw_selection_area(c->on) / c->on->facet_count);
  for (int32_t i = 0; i < bw_material_part_count(heat->material); i++)
    for (int k = 0; k < 3; k++)
      conductivity =
          fmin(conductivity, bw_material_part(heat->material, i)->thermal.conductivity[k]);
  if (c->coefficient * length <= most * conductivity)
    return BW_OK;
  return bw_fail(context, BW_INVALID,
                 "the conductance of contact is %g W/(m2 K); on facets of this size rounding takes "
                 "the solution above %.3g: join the regions instead",
                 c->coefficient, most * conductivity / length);
}

bw_status bw_heat_add(bw_context *context, bw_heat *heat, const bw_heat_condition *condition) {
  bw_status status = BW_OK;
  bw_heat_condition c = *condition;
  bw_array *copy = NULL;
  c.nodal = NULL;
  c.joint = NULL;
  c.bond = NULL;
  if (!bwi_heat_joins(&c))
    c.with = NULL;
  if ((unsigned)c.kind > BW_HEAT_BOND)
    return bw_fail(context, BW_INVALID, "there is no condition of heat with the number %d",
                   (int)c.kind);
  BW_TRY(check_selection(context, heat, &c));
  BW_TRY(check_value(context, &c, c.value));
  if (bwi_heat_is_film(&c) && (!isfinite(c.coefficient) || c.coefficient < 0))
    BW_TRY(bw_fail(context, BW_INVALID, "the coefficient of %s is %g; it must be 0 or more",
                   kind_word[c.kind], c.coefficient));
  if (c.kind == BW_HEAT_CONTACT && !(c.coefficient > 0 && isfinite(c.coefficient)))
    BW_TRY(bw_fail(context, BW_INVALID,
                   "the conductance of contact is %g; it must be above 0: leave the condition out "
                   "where no heat passes",
                   c.coefficient));
  if (c.kind == BW_HEAT_RADIATION && c.coefficient > 1)
    BW_TRY(bw_fail(context, BW_INVALID, "an emissivity is between 0 and 1, not %g", c.coefficient));
  if (!isfinite(c.about) || c.about < 0)
    BW_TRY(bw_fail(context, BW_INVALID,
                   "radiation is linearised about a temperature above 0 K, not %g", c.about));
  if (!isfinite(c.gap) || c.gap < 0)
    BW_TRY(bw_fail(context, BW_INVALID, "the gap of %s is %g m; it must be above 0",
                   kind_word[c.kind], c.gap));
  if (c.kind == BW_HEAT_BOND)
    BW_TRY(bwi_heat_bond(context, heat, &c));
  else if (c.kind == BW_HEAT_CONTACT) {
    BW_TRY(check_conductance(context, heat, &c));
    BW_TRY(bwi_heat_pair(context, heat->mesh, &c));
  } else if (c.on)
    c.size = bw_selection_area(c.on);
  else {
    c.size = 0;
    for (int32_t e = 0; e < heat->mesh->element_count; e++)
      c.size += heat->mesh->volume[e];
  }
  if (c.kind != BW_HEAT_TEMPERATURE && !(c.size > 0))
    BW_TRY(bw_fail(context, BW_GEOMETRY, "the facets of %s have no area", kind_word[c.kind]));
  if (condition->nodal) {
    const bw_array *nodal = condition->nodal;
    bool varies = c.kind == BW_HEAT_SOURCE || c.kind == BW_HEAT_TEMPERATURE;
    if (!varies || nodal->rows != heat->mesh->node_count || nodal->columns != 1)
      BW_TRY(bw_fail(context, BW_INVALID,
                     "%s has one number for each of the %d nodes, not an array of %lld x %lld",
                     kind_word[c.kind], heat->mesh->node_count, (long long)nodal->rows,
                     (long long)nodal->columns));
    BW_TRY(bw_array_create(context, BW_F64, nodal->rows, 1, &copy));
    for (int64_t i = 0; i < nodal->rows; i++) {
      double value = ((double *)copy->data)[i] = bw_array_get(nodal, i, 0);
      if (!isfinite(value))
        BW_TRY(bw_fail(context, BW_INVALID, "%s at node %lld is not a finite number",
                       kind_word[c.kind], (long long)i + 1));
    }
  }
  bw_heat_condition *list = bw_resize(context, heat->condition, (size_t)heat->condition_count + 1,
                                      sizeof *heat->condition);
  BW_TRY_MEMORY(list);
  heat->condition = list;
  c.on = bw_retain(c.on);
  c.with = bw_retain(c.with);
  c.nodal = bw_retain(copy);
  list[heat->condition_count++] = c;
  heat->object.revision++;
  bw_release(copy);
  return BW_OK;
done:
  bwi_heat_unpair(&c);
  bw_release(copy);
  return status;
}

bw_status bw_heat_set_value(bw_context *context, bw_heat *heat, int index, double value) {
  if (index < 0 || index >= heat->condition_count)
    return bw_fail(context, BW_INVALID, "there is no condition %d: there are %d", index + 1,
                   heat->condition_count);
  if (bwi_heat_joins(&heat->condition[index]))
    return bw_fail(context, BW_INVALID, "condition %d is %s, which has no value to change",
                   index + 1, kind_word[heat->condition[index].kind]);
  bw_status status = check_value(context, &heat->condition[index], value);
  if (status == BW_OK)
    heat->condition[index].value = value;
  return status;
}
