/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Models of edited shapes and refined meshes: supports and loads go with the surface that they were
 * given on.
 *
 * Invariants: a selection keeps its facets by number and its nodes (by number, or through the map
 * of a refilled mesh), or takes those that lie in them (refined.c), so nothing is selected again by
 * geometry. What is given in space keeps its
 * direction: forces, tractions, gravity, normals of slides that were given one. What follows from
 * the surface is that of the new shape: areas, resultants, the normals of pressure and of slides
 * along the surface. The point of a torque goes with the centre of its area. */
#include <stdlib.h>
#include <string.h>

#include "base/sort.h"
#include "model/internal.h"

typedef struct transfer {
  bw_context *context;
  const bw_model *from;
  bw_model *to;
  const bw_refinement *refinement; /* or NULL */
  const int32_t *node_from;        /* NULL: the same nodes, or refined ones */
  int32_t *node_to;                /* the inverse, -1 where a node is gone; with node_from */
  int count; /* selections made so far, so that those that share one still do */
  const bw_selection **before;
  bw_selection **after;
} transfer;

/* Old mesh node -> new, for meshes with other nodes. */
static bw_status invert(transfer *t) {
  int32_t old_count = t->from->mesh->node_count, new_count = t->to->mesh->node_count;
  t->node_to = BW_NEW(t->context, int32_t, old_count);
  if (!t->node_to)
    return BW_MEMORY;
  for (int32_t i = 0; i < old_count; i++)
    t->node_to[i] = -1;
  for (int32_t i = 0; i < new_count; i++) {
    int32_t old = t->node_from[i];
    if (old < -1 || old >= old_count || (old >= 0 && t->node_to[old] >= 0))
      return bw_fail(
          t->context, BW_INVALID,
          "node %d comes from node %d, which another node comes from too, or which is none "
          "of the %d nodes before",
          i + 1, old + 1, old_count);
    if (old >= 0)
      t->node_to[old] = i;
  }
  return BW_OK;
}

/* The selection's facets and nodes on the new mesh; NULL stays NULL. Retained by the transfer. */
static bw_status transfer_selection(transfer *t, const bw_selection *on, const bw_selection **out) {
  bw_status status = BW_OK;
  int32_t *node = NULL;
  bw_selection *made = NULL;
  *out = NULL;
  if (!on)
    return BW_OK;
  for (int i = 0; i < t->count; i++)
    if (t->before[i] == on) {
      *out = t->after[i];
      return BW_OK;
    }
  if (t->refinement) {
    BW_TRY(bwi_refined_selection(t->context, t->refinement, t->to->mesh, on, &made));
    goto keep;
  }
  if (t->node_from) {
    node = BW_NEW(t->context, int32_t, on->node_count);
    if (!node)
      return BW_MEMORY;
    for (int32_t i = 0; i < on->node_count; i++) {
      node[i] = t->node_to[on->node[i]];
      if (node[i] < 0)
        BW_TRY(bw_fail(t->context, BW_INVALID,
                       "node %d, which a support or load acts on, is not in the new mesh: give "
                       "the support or load on the new mesh",
                       on->node[i] + 1));
    }
    bwi_sort_columns(node, on->node_count);
  }
  BW_TRY(bwi_selection_copy(t->context, t->to->mesh, on->facet_count, on->facet, on->node_count,
                            node ? node : on->node, &made));
  made->node_set = on->node_set;
keep:
  t->before[t->count] = on;
  t->after[t->count++] = made;
  *out = made;
done:
  bw_free(node);
  return status;
}

/* Values at nodes on a mesh with other nodes; new nodes get `fill`, or on a refined mesh what lies
 * between. The caller's reference. */
static bw_status transfer_array(transfer *t, const bw_array *array, bool forces, double fill,
                                bw_array **out) {
  bw_array *made = NULL;
  if (array && t->refinement)
    return bwi_refined_array(t->context, t->refinement, t->from->mesh, t->to->mesh, array, !forces,
                             out);
  if (!array || !t->node_from) {
    *out = (bw_array *)bw_retain(array);
    return BW_OK;
  }
  bw_status status =
      bw_array_create(t->context, BW_F64, t->to->mesh->node_count, array->columns, &made);
  if (status != BW_OK)
    return status;
  double *value = (double *)made->data;
  for (int64_t i = 0; i < made->rows; i++)
    for (int64_t k = 0; k < made->columns; k++)
      value[i * made->columns + k] =
          t->node_from[i] < 0 ? fill : bw_array_get(array, t->node_from[i], k);
  *out = made;
  return BW_OK;
}

static bw_status transfer_support(transfer *t, const bw_support *support) {
  bw_status status = BW_OK;
  bw_support made = *support;
  bw_array *field = NULL;
  BW_TRY(transfer_selection(t, support->on, &made.on));
  BW_TRY(transfer_array(t, support->field, false, 0, &field));
  made.field = field;
  BW_TRY(bwi_model_add_support(t->context, t->to, &made));
done:
  bw_release(field);
  return status;
}

static bw_status transfer_bond(transfer *t, int number) {
  bw_status status = BW_OK;
  const bw_bond *bond = &t->from->bond[number];
  const bw_selection *a, *b;
  BW_TRY(transfer_selection(t, bond->a, &a));
  BW_TRY(transfer_selection(t, bond->b, &b));
  BW_TRY(bw_model_preload(t->context, t->to, a, b, bond->asked_gap, bond->preload, bond->pull));
done:
  if (status == BW_GEOMETRY)
    bw_detail_number(t->context, "bond", number + 1.0);
  return status;
}

static bw_status transfer_attachment(transfer *t, const bw_attachment *attachment) {
  bw_status status = BW_OK;
  const bw_selection *on;
  BW_TRY(transfer_selection(t, attachment->on, &on));
  BW_TRY(attachment->mass > 0
             ? bw_model_attach_mass(t->context, t->to, on, attachment->mass)
             : bw_model_attach_spring(t->context, t->to, on, attachment->stiffness));
done:
  return status;
}

static bw_status transfer_coupling(transfer *t, const bw_coupling *coupling) {
  bw_status status = BW_OK;
  const bw_selection *on;
  BW_TRY(transfer_selection(t, coupling->on, &on));
  BW_TRY(bw_model_couple(t->context, t->to, on, &coupling->point));
done:
  return status;
}

static bw_status transfer_cyclic(transfer *t, const bw_cyclic *cyclic) {
  bw_status status = BW_OK;
  const bw_selection *low, *high;
  BW_TRY(transfer_selection(t, cyclic->low, &low));
  BW_TRY(transfer_selection(t, cyclic->high, &high));
  BW_TRY(bw_model_cyclic(t->context, t->to, low, high, cyclic->count, cyclic->axis, cyclic->point));
done:
  return status;
}

/* Whether a load at nodes can be expressed at the new nodes: forces where no loaded node is gone, a
 * change of temperature that is the same everywhere. */
static bw_status check_nodal(const transfer *t, int number, const bw_load *load) {
  int32_t nodes = t->from->mesh->node_count;
  if (load->kind == BW_LOAD_NODAL)
    for (int32_t i = 0; i < nodes; i++)
      for (int k = 0; k < 3; k++)
        if (t->node_to[i] < 0 && bw_array_get(load->nodal, i, k) != 0) {
          bw_fail(t->context, BW_UNSUPPORTED,
                  "load %d is a force at node %d, which is inside the part that was filled again "
                  "and is not in the new mesh: give it on the surface",
                  number + 1, i + 1);
          bw_detail_number(t->context, "node", i + 1.0);
          return BW_UNSUPPORTED;
        }
  if (load->kind == BW_LOAD_TEMPERATURE)
    for (int32_t i = 1; i < nodes; i++)
      if (bw_array_get(load->nodal, i, 0) != bw_array_get(load->nodal, 0, 0))
        return bw_fail(t->context, BW_UNSUPPORTED,
                       "load %d is a temperature that varies over the nodes (%g K at node 1, %g K "
                       "at node %d); on a mesh that was filled again it is not known at the new "
                       "nodes: give the temperatures on the new mesh",
                       number + 1, bw_array_get(load->nodal, 0, 0), bw_array_get(load->nodal, i, 0),
                       i + 1);
  return BW_OK;
}

static bw_status transfer_load(transfer *t, int number) {
  bw_status status = BW_OK;
  const bw_load *load = &t->from->load[number];
  bw_load made = *load;
  bw_array *nodal = NULL;
  if (t->node_from && load->nodal)
    BW_TRY(check_nodal(t, number, load));
  BW_TRY(transfer_selection(t, load->on, &made.on));
  BW_TRY(transfer_array(t, load->nodal, load->kind == BW_LOAD_NODAL,
                        load->kind == BW_LOAD_TEMPERATURE ? bw_array_get(load->nodal, 0, 0) : 0,
                        &nodal));
  made.nodal = nodal;
  if (load->kind == BW_LOAD_TORQUE) {
    double before[3], after[3];
    bw_selection_centre(load->on, before);
    bw_selection_centre(made.on, after);
    for (int k = 0; k < 3; k++)
      made.about[k] = load->about[k] + (after[k] - before[k]);
  }
  BW_TRY(bwi_model_add_load(t->context, t->to, &made));
done:
  bw_release(nodal);
  return status;
}

/* The model's material on another mesh. */
static bw_status carry_material(bw_context *context, const bw_model *model, const bw_mesh *mesh,
                                bool refilled, const bw_refinement *refinement,
                                bw_material **carried) {
  if (refinement)
    return bw_material_carried(context, model->material, mesh->element_count,
                               refinement->element_parent, carried);
  if (refilled && model->material->parts)
    return bwi_material_carry_by_region(context, model->material, model->mesh, mesh, carried);
  *carried = (bw_material *)bw_retain(model->material);
  return BW_OK;
}

/* `also`: further selections, after those of supports and loads. */
static bw_status transfer_model(bw_context *context, const bw_model *model, const bw_mesh *mesh,
                                const int32_t *node_from, const bw_refinement *refinement,
                                int also_count, const bw_selection *const *also,
                                bw_selection **also_transferred, bw_model **out) {
  bw_status status = BW_OK;
  transfer t = {
      .context = context, .from = model, .node_from = node_from, .refinement = refinement};
  int max = model->support_count + model->load_count + 2 * model->bond_count +
            model->attachment_count + model->coupling_count + 2 + also_count;
  bw_material *material = NULL;
  BW_TRY(carry_material(context, model, mesh, node_from != NULL, refinement, &material));
  BW_TRY(bw_model_create(context, mesh, material, &t.to));
  t.before = BW_NEW(context, const bw_selection *, max);
  t.after = BW_NEW(context, bw_selection *, max);
  BW_TRY_MEMORY(t.before && t.after);
  if (node_from)
    BW_TRY(invert(&t));
  for (int i = 0; i < model->support_count; i++)
    BW_TRY(transfer_support(&t, &model->support[i]));
  for (int i = 0; i < model->bond_count; i++)
    BW_TRY(transfer_bond(&t, i));
  for (int i = 0; i < model->attachment_count; i++)
    BW_TRY(transfer_attachment(&t, &model->attachment[i]));
  for (int i = 0; i < model->coupling_count; i++)
    BW_TRY(transfer_coupling(&t, &model->coupling[i]));
  if (model->cyclic)
    BW_TRY(transfer_cyclic(&t, model->cyclic));
  for (int i = 0; i < model->load_count; i++)
    BW_TRY(transfer_load(&t, i));
  for (int i = 0; i < also_count; i++) {
    const bw_selection *made;
    if (also[i]->mesh != model->mesh)
      BW_TRY(bw_fail(context, BW_INVALID, "selection %d is not of the model's mesh", i + 1));
    BW_TRY(transfer_selection(&t, also[i], &made));
    also_transferred[i] = (bw_selection *)made;
  }
  for (int i = 0; i < also_count; i++)
    bw_retain(also_transferred[i]);
done:
  bw_release(material);
  for (int i = 0; i < t.count; i++)
    bw_release(t.after[i]);
  bw_free(t.before);
  bw_free(t.after);
  bw_free(t.node_to);
  for (int i = 0; i < also_count && status != BW_OK; i++)
    also_transferred[i] = NULL; /* released with the others */
  if (status == BW_OK)
    *out = t.to;
  else
    bw_release(t.to);
  return status;
}

static bool same_numbers(const int32_t *a, const int32_t *b, size_t count) {
  return a == b || memcmp(a, b, count * sizeof *a) == 0;
}

bw_status bw_model_moved(bw_context *context, const bw_model *model, const bw_mesh *mesh,
                         bw_model **moved) {
  const bw_mesh *old = model->mesh;
  if (mesh->order != old->order || mesh->node_count != old->node_count ||
      mesh->element_count != old->element_count || mesh->facet_count != old->facet_count ||
      !same_numbers(mesh->element, old->element,
                    (size_t)old->element_count * (size_t)old->nodes_per_element) ||
      !same_numbers(mesh->facet, old->facet,
                    (size_t)old->facet_count * (size_t)old->nodes_per_facet))
    return bw_fail(context, BW_INVALID,
                   "the mesh has %d nodes and %d elements, the model's mesh %d and %d: a model can "
                   "be moved only to a mesh with the same elements at other positions",
                   mesh->node_count, mesh->element_count, old->node_count, old->element_count);
  return transfer_model(context, model, mesh, NULL, NULL, 0, NULL, NULL, moved);
}

bw_status bw_model_transferred(bw_context *context, const bw_model *model, const bw_mesh *mesh,
                               const int32_t *node_from, bw_model **transferred) {
  const bw_mesh *old = model->mesh;
  bool fits = mesh->order == old->order && mesh->facet_count == old->facet_count;
  for (int64_t i = 0; fits && i < (int64_t)mesh->facet_count * mesh->nodes_per_facet; i++)
    fits = node_from[mesh->facet[i]] == old->facet[i];
  if (!fits)
    return bw_fail(context, BW_INVALID,
                   "the boundary of the mesh (%d facets) is not that of the model's mesh (%d "
                   "facets), in the same order: a model can be transferred only where the surface "
                   "stayed",
                   mesh->facet_count, old->facet_count);
  return transfer_model(context, model, mesh, node_from, NULL, 0, NULL, NULL, transferred);
}

bw_status bw_model_refined(bw_context *context, const bw_model *model,
                           const bw_refinement *refinement, const bw_mesh *mesh, int also_count,
                           const bw_selection *const *also, bw_selection **also_refined,
                           bw_model **refined) {
  if (mesh->element_count != refinement->mesh->element_count ||
      mesh->node_count != refinement->mesh->node_count ||
      mesh->facet_count != refinement->mesh->facet_count)
    return bw_fail(context, BW_INVALID,
                   "the mesh has %d nodes and %d elements, the refined one %d and %d: it must have "
                   "its topology",
                   mesh->node_count, mesh->element_count, refinement->mesh->node_count,
                   refinement->mesh->element_count);
  return transfer_model(context, model, mesh, NULL, refinement, also_count, also, also_refined,
                        refined);
}
