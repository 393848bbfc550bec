/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Bodies that are laid down layer by layer (docs/theory/deposition.md). Each layer is a static
 * problem of the elements that are there; displacements, stresses and reactions add up. */
#include <math.h>
#include <string.h>

#include "barwright/deposition.h"
#include "model/internal.h"

static void deposition_destroy(void *object) {
  bw_deposition *d = object;
  bw_release(d->model);
  bw_free(d->layer);
  bw_free(d->displacement);
  bw_free(d->element_stress);
  bw_free(d->reaction);
  bw_free(d);
}

static size_t deposition_bytes(const void *object) {
  const bw_deposition *d = object;
  const bw_mesh *mesh = d->model->mesh;
  return sizeof *d + 6 * (size_t)mesh->node_count * sizeof(double) +
         (size_t)mesh->element_count * (6 * sizeof(double) + sizeof(int32_t));
}

static const bw_kind deposition_kind = {"deposition", deposition_destroy, deposition_bytes};

static bw_status start(bw_context *context, const bw_model *model, bw_deposition **deposition) {
  const bw_mesh *mesh = model->mesh;
  bw_deposition *d = BW_NEW0(context, bw_deposition, 1);
  if (!d)
    return BW_MEMORY;
  bw_object_init(d, &deposition_kind);
  d->model = bw_retain(model);
  d->layer = BW_NEW(context, int32_t, mesh->element_count);
  d->displacement = BW_NEW0(context, double, 3 * (size_t)mesh->node_count);
  d->element_stress = BW_NEW0(context, double, 6 * (size_t)mesh->element_count);
  d->reaction = BW_NEW0(context, double, 3 * (size_t)mesh->node_count);
  *deposition = d;
  return d->layer && d->displacement && d->element_stress && d->reaction ? BW_OK : BW_MEMORY;
}

/* ---- layers ---------------------------------------------------------------------------------- */

static void centroid(const bw_mesh *mesh, int64_t element, double middle[3]) {
  for (int k = 0; k < 3; k++) {
    middle[k] = 0;
    for (int a = 0; a < 4; a++)
      middle[k] += mesh->node[3 * mesh->element[element * mesh->nodes_per_element + a] + k] / 4;
  }
}

/* A layer without an element is none, so that more layers than elements are a slip. */
static bw_status check_count(bw_context *context, const bw_mesh *mesh, int32_t count) {
  if (count < 1)
    return bw_fail(context, BW_INVALID, "%d layers: 1 or more expected", count);
  if (count <= mesh->element_count)
    return BW_OK;
  bw_fail(context, BW_INVALID,
          "%d layers, but the mesh has %lld elements: give fewer layers, or a finer mesh", count,
          (long long)mesh->element_count);
  bw_detail_number(context, "elements", (double)mesh->element_count);
  return BW_INVALID;
}

bw_status bw_deposition_layers(bw_context *context, const bw_mesh *mesh, const double direction[3],
                               int32_t count, int32_t *layer) {
  double length =
      sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
  double low = INFINITY, high = -INFINITY;
  if (!(length > 0 && isfinite(length)))
    return bw_fail(context, BW_INVALID, "the direction of the layers has no length");
  bw_status status = check_count(context, mesh, count);
  if (status != BW_OK)
    return status;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    const double *x = mesh->node + 3 * (int64_t)i;
    double height = (x[0] * direction[0] + x[1] * direction[1] + x[2] * direction[2]) / length;
    low = fmin(low, height);
    high = fmax(high, height);
  }
  for (int64_t e = 0; e < mesh->element_count; e++) {
    double x[3];
    centroid(mesh, e, x);
    double height = (x[0] * direction[0] + x[1] * direction[1] + x[2] * direction[2]) / length;
    double at = floor((height - low) / (high - low) * count);
    layer[e] = (int32_t)fmax(0, fmin(at, count - 1));
  }
  return BW_OK;
}

/* Which elements are laid, and which nodes are on supports. */
typedef struct order {
  const bw_mesh *mesh;
  const int32_t *asked; /* the layer of each element */
  int32_t *laid;        /* that with which it is laid, or -1 */
  int32_t *queue;       /* of elements, element_count */
} order;

/* Lays what facets connect to the elements of the queue. */
static void spread(order *o, int32_t layer, int64_t count) {
  for (int64_t at = 0; at < count; at++)
    for (int k = 0; k < 4; k++) {
      int32_t other = o->mesh->neighbour[4 * (int64_t)o->queue[at] + k];
      if (other < 0 || o->laid[other] >= 0 || o->asked[other] > layer)
        continue;
      o->laid[other] = layer;
      o->queue[count++] = other;
    }
}

/* The first element of the largest part of the first layer that facets connect. */
static int32_t largest_part(order *o) {
  const bw_mesh *mesh = o->mesh;
  int32_t best = 0;
  double most = -1;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    if (o->asked[e] != 0 || o->laid[e] >= 0)
      continue;
    double volume = 0;
    int64_t count = 1;
    o->laid[e] = 0;
    o->queue[0] = e;
    for (int64_t at = 0; at < count; at++) {
      volume += mesh->volume[o->queue[at]];
      for (int k = 0; k < 4; k++) {
        int32_t other = mesh->neighbour[4 * (int64_t)o->queue[at] + k];
        if (other < 0 || o->laid[other] >= 0 || o->asked[other] != 0)
          continue;
        o->laid[other] = 0;
        o->queue[count++] = other;
      }
    }
    if (volume > most) {
      most = volume;
      best = e;
    }
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    o->laid[e] = -1;
  return best;
}

static bool stands(const order *o, const uint8_t *supported, int32_t element) {
  int corners = 0;
  for (int a = 0; a < 4; a++)
    corners += supported[o->mesh->element[(int64_t)element * o->mesh->nodes_per_element + a]];
  return corners >= 3;
}

static bw_status lay_all(bw_context *context, const bw_model *model, int32_t layers, order *o) {
  const bw_mesh *mesh = model->mesh;
  bw_status status = BW_OK;
  int32_t first = -1, left = -1;
  int64_t missing = 0;
  double x[3];
  uint8_t *supported = BW_NEW0(context, uint8_t, mesh->node_count);
  BW_TRY_MEMORY(supported);
  for (int s = 0; s < model->support_count; s++)
    for (int32_t i = 0; i < model->support[s].on->node_count; i++)
      supported[model->support[s].on->node[i]] = 1;
  for (int32_t e = 0; e < mesh->element_count; e++)
    o->laid[e] = -1;
  bool carried = false;
  for (int32_t e = 0; e < mesh->element_count && !carried; e++)
    carried = o->asked[e] == 0 && stands(o, supported, e);
  if (!carried)
    first = largest_part(o);
  for (int32_t layer = 0; layer < layers; layer++) {
    int64_t count = 0;
    BW_TRY(bw_check_cancel(context));
    for (int32_t e = 0; e < mesh->element_count; e++) {
      bool begins =
          o->laid[e] < 0 && o->asked[e] <= layer && (e == first || stands(o, supported, e));
      for (int k = 0; k < 4 && !begins && o->laid[e] < 0 && o->asked[e] <= layer; k++) {
        int32_t other = mesh->neighbour[4 * (int64_t)e + k];
        begins = other >= 0 && o->laid[other] >= 0 && o->laid[other] < layer;
      }
      if (!begins)
        continue;
      o->laid[e] = layer;
      o->queue[count++] = e;
    }
    spread(o, layer, count);
  }
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (o->laid[e] < 0)
      left = missing++ ? left : e;
  if (missing) {
    centroid(mesh, left, x);
    status = bw_fail(context, BW_GEOMETRY,
                     "%lld elements cannot be laid: no facet connects them to a support or to the "
                     "first layer; the first one is element %d at (%.4g, %.4g, %.4g)",
                     (long long)missing, left + 1, x[0], x[1], x[2]);
  }
done:
  bw_free(supported);
  return status;
}

/* ---- what is there while a layer is laid ------------------------------------------------------
 */

/* Some elements of a mesh. */
typedef struct part {
  bw_mesh *mesh;
  bw_model *model;
  int32_t *element; /* (index, the part's element_count) in the whole mesh */
  int32_t *node;    /* (index, the part's node_count) in the whole mesh */
} part;

static void part_clear(part *p) {
  bw_release(p->model);
  bw_release(p->mesh);
  bw_free(p->element);
  bw_free(p->node);
  *p = (part){0};
}

/* The elements whose keep is not 0: bw_mesh_subset drops the nodes that they do not use, and keeps
 * the order of the others. */
static bw_status take(bw_context *context, const bw_model *model, const uint8_t *keep, part *p) {
  const bw_mesh *mesh = model->mesh;
  bw_status status = BW_OK;
  bw_material *material = NULL;
  uint8_t *used = BW_NEW0(context, uint8_t, mesh->node_count);
  int32_t count = 0;
  BW_TRY_MEMORY(used);
  BW_TRY(bw_mesh_subset(context, mesh, keep, &p->mesh));
  p->element = BW_NEW(context, int32_t, p->mesh->element_count);
  p->node = BW_NEW(context, int32_t, p->mesh->node_count);
  BW_TRY_MEMORY(p->element && p->node);
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (keep[e]) {
      p->element[count++] = e;
      for (int a = 0; a < mesh->nodes_per_element; a++)
        used[mesh->element[(int64_t)e * mesh->nodes_per_element + a]] = 1;
    }
  count = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (used[i])
      p->node[count++] = i;
  BW_TRY(
      bw_material_carried(context, model->material, p->mesh->element_count, p->element, &material));
  BW_TRY(bw_model_create(context, p->mesh, material, &p->model));
done:
  bw_release(material);
  bw_free(used);
  return status;
}

/* The model's supports at the nodes that are there. */
static bw_status support(bw_context *context, const bw_model *model, part *p) {
  bw_status status = BW_OK;
  bw_selection *on = NULL;
  uint8_t *mask = BW_NEW(context, uint8_t, p->mesh->node_count);
  uint8_t *whole = BW_NEW(context, uint8_t, model->mesh->node_count);
  BW_TRY_MEMORY(mask && whole);
  for (int s = 0; s < model->support_count; s++) {
    const bw_support *from = &model->support[s];
    bool any = false;
    memset(whole, 0, (size_t)model->mesh->node_count);
    for (int32_t i = 0; i < from->on->node_count; i++)
      whole[from->on->node[i]] = 1;
    for (int32_t i = 0; i < p->mesh->node_count; i++) {
      mask[i] = whole[p->node[i]];
      any = any || mask[i];
    }
    if (!any)
      continue;
    BW_TRY(bw_select_mask(context, p->mesh, NULL, mask, &on));
    if (from->slide)
      BW_TRY(bw_model_slide(context, p->model, on, from->normal));
    else
      BW_TRY(bw_model_prescribe(context, p->model, on, from->fixed, NULL));
    bw_release(on);
    on = NULL;
  }
done:
  bw_release(on);
  bw_free(mask);
  bw_free(whole);
  return status;
}

/* The nodal forces of the layer's change of temperature, force (N, the whole mesh's node_count x
 * 3), and the stress without strain, which its elements lose. *size: of the largest force. */
static bw_status shrink(bw_context *context, const bw_deposition_options *options, const part *hot,
                        double *force, double *stress, double *size) {
  bw_status status = BW_OK;
  bw_array *change = NULL;
  double *own = BW_NEW(context, double, 6 * (size_t)hot->mesh->element_count);
  double *nodal = BW_NEW(context, double, 3 * (size_t)hot->mesh->node_count);
  BW_TRY_MEMORY(own && nodal);
  BW_TRY(bw_array_create(context, BW_F64, hot->mesh->node_count, 1, &change));
  for (int32_t i = 0; i < hot->mesh->node_count; i++)
    ((double *)change->data)[i] = options->change[hot->node[i]];
  bw_load load = {.kind = BW_LOAD_TEMPERATURE, .nodal = change, .by_material = true};
  BW_TRY(bwi_model_add_load(context, hot->model, &load));
  BW_TRY(bw_model_force_vector(context, hot->model, nodal));
  BW_TRY(bw_model_thermal_stress(context, hot->model, NULL, own));
  for (int64_t i = 0; i < hot->mesh->node_count; i++)
    for (int k = 0; k < 3; k++) {
      force[3 * (int64_t)hot->node[i] + k] = nodal[3 * i + k];
      *size = fmax(*size, fabs(nodal[3 * i + k]));
    }
  for (int64_t e = 0; e < hot->mesh->element_count; e++)
    for (int k = 0; k < 6; k++)
      stress[6 * (int64_t)hot->element[e] + k] -= own[6 * e + k];
done:
  bw_release(change);
  bw_free(own);
  bw_free(nodal);
  return status;
}

/* Adds the static solution of what is there. */
static bw_status add(bw_context *context, const part *p, const bw_static *solution,
                     bw_deposition *d) {
  bw_status status = BW_OK;
  double *stress = BW_NEW(context, double, 6 * (size_t)p->mesh->element_count);
  BW_TRY_MEMORY(stress);
  BW_TRY(bw_element_stress(context, p->mesh, p->model->material, solution->displacement, stress));
  for (int64_t e = 0; e < p->mesh->element_count; e++)
    for (int k = 0; k < 6; k++)
      d->element_stress[6 * (int64_t)p->element[e] + k] += stress[6 * e + k];
  for (int64_t i = 0; i < p->mesh->node_count; i++)
    for (int k = 0; k < 3; k++) {
      d->displacement[3 * (int64_t)p->node[i] + k] += solution->displacement[3 * i + k];
      d->reaction[3 * (int64_t)p->node[i] + k] += solution->reaction[3 * i + k];
    }
  d->residual = fmax(d->residual, solution->residual);
done:
  bw_free(stress);
  return status;
}

static bw_statics_options statics_of(const bw_solver *solver) {
  return (bw_statics_options){.tolerance = 1e-6, .solver = solver};
}

/* Lays one layer; *size grows with the largest force of its shrinking. */
static bw_status lay(bw_context *context, const bw_deposition_options *options, int32_t layer,
                     uint8_t *keep, bw_deposition *d, double *size) {
  const bw_model *model = d->model;
  const int64_t elements = model->mesh->element_count;
  bw_status status = BW_OK;
  part hot = {0}, there = {0};
  bw_array *load = NULL;
  bw_static *solution = NULL;
  bw_statics_options statics = statics_of(options->solver);
  double own = 0;
  double *force = BW_NEW0(context, double, 3 * (size_t)model->mesh->node_count);
  BW_TRY_MEMORY(force);
  for (int64_t e = 0; e < elements; e++)
    keep[e] = d->layer[e] == layer;
  BW_TRY(take(context, model, keep, &hot));
  BW_TRY(shrink(context, options, &hot, force, d->element_stress, &own));
  *size = fmax(*size, own);
  if (own == 0)
    goto done;
  for (int64_t e = 0; e < elements; e++)
    keep[e] = d->layer[e] <= layer;
  BW_TRY(take(context, model, keep, &there));
  BW_TRY(support(context, model, &there));
  BW_TRY(bw_array_create(context, BW_F64, there.mesh->node_count, 3, &load));
  for (int64_t i = 0; i < there.mesh->node_count; i++)
    memcpy((double *)load->data + 3 * i, force + 3 * (int64_t)there.node[i], 3 * sizeof *force);
  BW_TRY(bw_model_nodal_forces(context, there.model, load));
  BW_TRY(bw_statics(context, there.model, NULL, &statics, &solution));
  BW_TRY(add(context, &there, solution, d));
done:
  bw_release(solution);
  bw_release(load);
  part_clear(&hot);
  part_clear(&there);
  bw_free(force);
  return status;
}

/* ---- what is asked for ----------------------------------------------------------------------- */

static bw_status check_model(bw_context *context, const bw_model *model) {
  bw_status status = bw_model_refuse_joints(context, model);
  if (status != BW_OK)
    return status;
  if (model->load_count > 0)
    return bw_fail(context, BW_INVALID,
                   "a deposition counts the change of temperature of its layers alone: the model "
                   "has %d load%s; leave %s out, and add the stress afterwards",
                   model->load_count, model->load_count == 1 ? "" : "s",
                   model->load_count == 1 ? "it" : "them");
  for (int s = 0; s < model->support_count; s++) {
    const bw_support *on = &model->support[s];
    if (on->field || on->value[0] != 0 || on->value[1] != 0 || on->value[2] != 0)
      return bw_fail(
          context, BW_INVALID,
          "support %d prescribes a displacement: those of a deposition constrain to zero", s + 1);
    if (on->slide && on->normal[0] == 0 && on->normal[1] == 0 && on->normal[2] == 0)
      return bw_fail(context, BW_UNSUPPORTED,
                     "support %d slides along the normals of its facets, which change while layers "
                     "are added: give it a normal",
                     s + 1);
  }
  return BW_OK;
}

/* The stress that was laid belongs to the stiffness that it was laid with. */
static bw_status check_material(bw_context *context, const bw_material *laid,
                                const bw_material *released, const bw_mesh *mesh) {
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const bw_material *a = bw_material_of(laid, e), *b = bw_material_of(released, e);
    if (a == b)
      continue;
    if (a->formulation != b->formulation ||
        memcmp(a->elasticity, b->elasticity, sizeof a->elasticity) != 0)
      return bw_fail(context, BW_INVALID,
                     "element %lld of the released body has another stiffness than it was laid "
                     "down with: take the same material",
                     (long long)e + 1);
  }
  return BW_OK;
}

/* Of the whole body: single layers may well be of a material that does not expand. */
static bw_status check_expansion(bw_context *context, const bw_model *model, const double *change) {
  bw_array *whole = NULL;
  int32_t count = model->mesh->node_count;
  bw_status status = bw_array_create(context, BW_F64, count, 1, &whole);
  if (status != BW_OK)
    return status;
  memcpy(whole->data, change, (size_t)count * sizeof *change);
  status = bwi_check_expansion(context, model->mesh, model->material, whole);
  bw_release(whole);
  return status;
}

static bw_status check_options(bw_context *context, const bw_mesh *mesh,
                               const bw_deposition_options *options) {
  bw_status status = check_count(context, mesh, options->layer_count);
  if (status != BW_OK)
    return status;
  for (int64_t e = 0; e < mesh->element_count; e++)
    if (options->layer[e] < 0 || options->layer[e] >= options->layer_count)
      return bw_fail(context, BW_INVALID, "element %lld is in layer %d: 1 to %d expected",
                     (long long)e + 1, options->layer[e] + 1, options->layer_count);
  for (int64_t i = 0; i < mesh->node_count; i++)
    if (!isfinite(options->change[i]))
      return bw_fail(context, BW_INVALID, "the change of temperature of node %lld is not finite",
                     (long long)i + 1);
  return BW_OK;
}

/* Numbers the layers that have elements, and counts the elements that come late. */
static void count_layers(const bw_deposition_options *options, const bw_mesh *mesh, int32_t *number,
                         bw_deposition *d) {
  for (int64_t e = 0; e < mesh->element_count; e++) {
    number[d->layer[e]] = 1;
    if (d->layer[e] > options->layer[e]) {
      d->postponed++;
      d->postponed_volume += mesh->volume[e];
    }
  }
  for (int32_t layer = 0; layer < options->layer_count; layer++)
    number[layer] = number[layer] ? d->layer_count++ : -1;
  for (int64_t e = 0; e < mesh->element_count; e++)
    d->layer[e] = number[d->layer[e]];
}

bw_status bw_deposit(bw_context *context, const bw_model *model,
                     const bw_deposition_options *options, bw_deposition **deposition) {
  const bw_mesh *mesh = model->mesh;
  bw_status status = BW_OK;
  bw_deposition *d = NULL;
  uint8_t *keep = BW_NEW(context, uint8_t, mesh->element_count);
  int32_t *work = NULL;
  double size = 0;
  BW_TRY_MEMORY(keep);
  BW_TRY(check_model(context, model));
  BW_TRY(check_options(context, mesh, options));
  BW_TRY(check_expansion(context, model, options->change));
  BW_TRY(start(context, model, &d));
  work = BW_NEW0(context, int32_t,
                 mesh->element_count > options->layer_count ? mesh->element_count
                                                            : options->layer_count);
  BW_TRY_MEMORY(work);
  order o = {mesh, options->layer, d->layer, work};
  BW_TRY(lay_all(context, model, options->layer_count, &o));
  memset(work, 0, (size_t)options->layer_count * sizeof *work);
  count_layers(options, mesh, work, d);
  for (int32_t layer = 0; layer < d->layer_count; layer++) {
    bw_progress(context, "layers", (double)layer / d->layer_count);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(lay(context, options, layer, keep, d, &size));
  }
  if (size == 0)
    BW_TRY(bw_fail(context, BW_INVALID, "nothing shrinks: the change of temperature is zero"));
  if (d->postponed_volume > 0.01 * bw_mesh_volume(mesh))
    bw_warn(context,
            "%lld elements, %.2g %% of the volume, were laid later than asked for: nothing beneath "
            "carried them; a real part needs a support structure there",
            (long long)d->postponed, 100 * d->postponed_volume / bw_mesh_volume(mesh));
  *deposition = d;
  d = NULL;
done:
  bw_release(d);
  bw_free(keep);
  bw_free(work);
  return status;
}

bw_status bw_deposition_release(bw_context *context, const bw_deposition *deposition,
                                const bw_model *model, const bw_solver *solver,
                                bw_deposition **released) {
  const bw_mesh *mesh = deposition->model->mesh;
  bw_status status = BW_OK;
  bw_deposition *d = NULL;
  bw_model *loaded = NULL;
  bw_array *load = NULL;
  bw_static *solution = NULL;
  bw_statics_options statics = statics_of(solver);
  part all = {0};
  if (model->mesh != mesh)
    return bw_fail(context, BW_INVALID,
                   "the released body has another mesh than the one that was laid down");
  BW_TRY(check_material(context, deposition->model->material, model->material, mesh));
  BW_TRY(check_model(context, model));
  BW_TRY(start(context, model, &d));
  d->layer_count = deposition->layer_count;
  d->postponed = deposition->postponed;
  d->postponed_volume = deposition->postponed_volume;
  d->residual = deposition->residual;
  memcpy(d->layer, deposition->layer, (size_t)mesh->element_count * sizeof *d->layer);
  memcpy(d->displacement, deposition->displacement,
         3 * (size_t)mesh->node_count * sizeof *d->displacement);
  memcpy(d->element_stress, deposition->element_stress,
         6 * (size_t)mesh->element_count * sizeof *d->element_stress);
  BW_TRY(bw_array_create(context, BW_F64, mesh->node_count, 3, &load));
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    ((double *)load->data)[i] = -deposition->reaction[i];
  BW_TRY(bw_model_moved(context, model, mesh, &loaded));
  BW_TRY(bw_model_nodal_forces(context, loaded, load));
  BW_TRY(bw_statics(context, loaded, NULL, &statics, &solution));
  all = (part){.mesh = (bw_mesh *)bw_retain(mesh), .model = bw_retain(loaded)};
  all.element = BW_NEW(context, int32_t, mesh->element_count);
  all.node = BW_NEW(context, int32_t, mesh->node_count);
  BW_TRY_MEMORY(all.element && all.node);
  for (int32_t e = 0; e < mesh->element_count; e++)
    all.element[e] = e;
  for (int32_t i = 0; i < mesh->node_count; i++)
    all.node[i] = i;
  BW_TRY(add(context, &all, solution, d));
  *released = d;
  d = NULL;
done:
  bw_release(d);
  bw_release(solution);
  bw_release(load);
  bw_release(loaded);
  part_clear(&all);
  return status;
}
