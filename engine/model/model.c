/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Models: a mesh and a material with supports and loads, each checked when it is added. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "mesh/mesh_internal.h"
#include "model/internal.h"

static void clear_load(bw_load *load) {
  bw_release(load->on);
  bw_release(load->nodal);
}

static void clear_support(bw_support *support) {
  bw_release(support->on);
  bw_release(support->field);
}

static void model_destroy(void *object) {
  bw_model *model = (bw_model *)object;
  for (int i = 0; i < model->load_count; i++)
    clear_load(&model->load[i]);
  for (int i = 0; i < model->support_count; i++)
    clear_support(&model->support[i]);
  for (int i = 0; i < model->bond_count; i++)
    bwi_bond_clear(&model->bond[i]);
  for (int i = 0; i < model->attachment_count; i++)
    bw_release(model->attachment[i].on);
  for (int i = 0; i < model->coupling_count; i++)
    bwi_coupling_clear(&model->coupling[i]);
  bw_free(model->load);
  bw_free(model->support);
  bw_free(model->bond);
  bw_free(model->attachment);
  bw_free(model->coupling);
  bw_release(model->cyclic);
  bw_release(model->mesh);
  bw_release(model->material);
  bw_free(model);
}

static size_t model_bytes(const void *object) {
  const bw_model *model = (const bw_model *)object;
  return sizeof *model + (size_t)model->load_count * sizeof *model->load +
         (size_t)model->support_count * sizeof *model->support +
         (size_t)model->bond_count * sizeof *model->bond +
         (size_t)model->attachment_count * sizeof *model->attachment +
         (size_t)model->coupling_count * sizeof *model->coupling;
}

static const bw_kind model_kind = {"model", model_destroy, model_bytes};

bw_status bw_model_create(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                          bw_model **model) {
  if (!mesh || !material)
    return bw_fail(context, BW_INVALID, "a model needs a mesh and a material");
  bw_status status = bw_material_fits(context, material, mesh->element_count);
  if (status == BW_OK)
    status = bwi_mesh_check_overlaps(context, mesh);
  if (status != BW_OK)
    return status;
  bw_model *made = BW_NEW0(context, bw_model, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &model_kind);
  made->mesh = (const bw_mesh *)bw_retain(mesh);
  made->material = (const bw_material *)bw_retain(material);
  *model = made;
  return BW_OK;
}

bw_status bw_model_rotate_material(bw_context *context, bw_model *model, int32_t group_count,
                                   const int32_t *of_element, const double *rotation) {
  bw_material *rotated = NULL;
  bw_status status =
      bw_material_rotated_by_element(context, model->material, model->mesh->element_count,
                                     group_count, of_element, rotation, &rotated);
  if (status != BW_OK)
    return status;
  bw_release(model->material);
  model->material = rotated;
  model->object.revision++;
  return BW_OK;
}

/* Gravity acts on materials and masses. */
static bw_status measure_gravity(bw_context *context, bw_model *model) {
  bw_status status = BW_OK;
  for (int i = 0; i < model->load_count && status == BW_OK; i++)
    if (model->load[i].kind == BW_LOAD_GRAVITY)
      status = bwi_load_measure(context, model, &model->load[i]);
  return status;
}

bw_status bw_model_set_material(bw_context *context, bw_model *model, int32_t region,
                                const bw_material *material) {
  bw_material *changed = NULL;
  if (region < -1 || region >= model->mesh->region_count)
    return bw_fail(context, BW_INVALID, "region %d: the mesh has %d regions", region + 1,
                   model->mesh->region_count);
  bw_status status = bwi_material_region_changed(context, model->mesh, model->material, region,
                                                 material, &changed);
  for (int i = 0; status == BW_OK && i < model->load_count; i++)
    if (model->load[i].kind == BW_LOAD_TEMPERATURE && model->load[i].by_material)
      status = bwi_check_expansion(context, model->mesh, changed, model->load[i].nodal);
  const bw_material *before = model->material;
  model->material = changed;
  if (status == BW_OK)
    status = measure_gravity(context, model);
  if (status != BW_OK) {
    model->material = before;
    bw_release(changed);
    return status;
  }
  bw_release(before);
  model->object.revision++;
  return BW_OK;
}

bw_status bw_model_formulate(bw_context *context, bw_model *model, bw_formulation formulation) {
  bw_material *formulated = NULL;
  if (formulation == BW_B_BAR && model->mesh->order == 1)
    return bw_fail(
        context, BW_INVALID,
        "linear tetrahedra have no B-bar formulation: their volumetric strain is "
        "constant, so that its mean changes nothing. Use quadratic elements (order = 2)");
  bw_status status = bw_material_formulated(context, model->material, formulation, &formulated);
  if (status != BW_OK)
    return status;
  bw_release(model->material);
  model->material = formulated;
  model->object.revision++;
  return BW_OK;
}

/* ---- checks ---------------------------------------------------------------------------------- */

static bw_status check_finite(bw_context *context, const char *what, const double v[3]) {
  for (int k = 0; k < 3; k++)
    if (!isfinite(v[k]))
      return bw_fail(context, BW_INVALID, "component %d of the %s is not a finite number", k + 1,
                     what);
  return BW_OK;
}

/* Where this fraction of the area that a selection probably means is missing, it warns. */
static const double missed_fraction = 0.1;

static void warn_of_missed_area(bw_context *context, const bw_selection *on, const char *what) {
  double area = bw_selection_area(on), whole = area + on->missed_area;
  char covered[40], meant[40];
  if (!(on->missed_area > missed_fraction * whole))
    return;
  bwi_number_string(covered, sizeof covered, area, 4, 0);
  bwi_number_string(meant, sizeof meant, whole, 4, 0);
  bw_warn(context,
          "%s covers %s m2 of the %s m2 that lie along the border of its selection: the face is "
          "not flat to the selection's tolerance; give a larger tolerance or select the face",
          what, covered, meant);
}

bw_status bwi_check_selection(bw_context *context, const bw_model *model, const bw_selection *on,
                              bool points, const char *what) {
  if (!on)
    return bw_fail(context, BW_INVALID, "%s needs a selection of the mesh's boundary", what);
  if (on->mesh != model->mesh)
    return bw_fail(
        context, BW_INVALID,
        "%s is given on a selection of another mesh (%d nodes; the model's mesh has %d): "
        "select on the model's own mesh",
        what, on->mesh->node_count, model->mesh->node_count);
  if (on->node_count == 0)
    return bw_fail(context, BW_EMPTY, "%s is given on an empty selection", what);
  if (on->facet_count == 0 && !(points && on->node_set)) {
    char missed[96] = "";
    if (on->missed_area > 0) {
      char area[40];
      bwi_number_string(area, sizeof area, on->missed_area, 4, 0);
      snprintf(missed, sizeof missed, ": it covers 0 of the %s m2 that lie along its border", area);
    }
    bw_status status = bw_fail(
        context, BW_EMPTY,
        "%s acts on area, but the selection has %d node%s and no whole facet%s. Give a larger "
        "tolerance, select the face, or %s",
        what, on->node_count, on->node_count == 1 ? "" : "s", missed,
        points ? "make it a node set if points or edges are meant" : "give forces at nodes");
    bw_detail_number(context, "nodes", on->node_count);
    bw_detail_number(context, "missed_area", on->missed_area);
    return status;
  }
  warn_of_missed_area(context, on, what);
  return BW_OK;
}

/* Values at all nodes of the mesh, finite. */
static bw_status check_nodal(bw_context *context, const bw_model *model, const bw_array *array,
                             int columns, const char *what) {
  if (!array || array->rows != model->mesh->node_count || array->columns != columns)
    return bw_fail(context, BW_INVALID,
                   "the %s needs an array of %d rows (nodes) and %d columns, not %lld x %lld", what,
                   model->mesh->node_count, columns, array ? (long long)array->rows : 0,
                   array ? (long long)array->columns : 0);
  for (int64_t i = 0; i < array->rows; i++)
    for (int k = 0; k < columns; k++)
      if (!isfinite(bw_array_get(array, i, k)))
        return bw_fail(context, BW_INVALID, "component %d of the %s at node %lld is not finite",
                       k + 1, what, (long long)i + 1);
  return BW_OK;
}

/* A copy: an array may be part of an object that retains the model, and change after it was
 * checked. NULL stays NULL. */
static bw_status copy_nodal(bw_context *context, const bw_array *array, const bw_array **out) {
  bw_array *made = NULL;
  *out = NULL;
  if (!array)
    return BW_OK;
  bw_status status = bw_array_create(context, BW_F64, array->rows, array->columns, &made);
  if (status != BW_OK)
    return status;
  double *value = (double *)made->data;
  for (int64_t i = 0; i < array->rows; i++)
    for (int64_t k = 0; k < array->columns; k++)
      value[i * array->columns + k] = bw_array_get(array, i, k);
  *out = made;
  return BW_OK;
}

/* ---- supports -------------------------------------------------------------------------------- */

bw_status bwi_model_add_support(bw_context *context, bw_model *model, const bw_support *support) {
  const bw_array *field;
  bw_support *list = (bw_support *)bw_resize(
      context, model->support, (size_t)model->support_count + 1, sizeof *model->support);
  if (!list)
    return BW_MEMORY;
  model->support = list;
  bw_status status = copy_nodal(context, support->field, &field);
  if (status != BW_OK)
    return status;
  list[model->support_count] = *support;
  list[model->support_count].on = (const bw_selection *)bw_retain(support->on);
  list[model->support_count].field = field;
  model->support_count++;
  model->object.revision++;
  return BW_OK;
}

bw_status bw_model_fix(bw_context *context, bw_model *model, const bw_selection *on) {
  bw_support support = {.on = on, .fixed = {true, true, true}};
  bw_status status = bwi_check_selection(context, model, on, true, "a fixed support");
  return status != BW_OK ? status : bwi_model_add_support(context, model, &support);
}

bw_status bw_model_slide(bw_context *context, bw_model *model, const bw_selection *on,
                         const double normal[3]) {
  bw_support support = {.on = on, .slide = true};
  bw_status status;
  BW_TRY(bwi_check_selection(context, model, on, true, "a sliding support"));
  if (normal) {
    BW_TRY(check_finite(context, "sliding support's normal", normal));
    double max = fmax(fabs(normal[0]), fmax(fabs(normal[1]), fabs(normal[2])));
    if (max == 0)
      BW_TRY(bw_fail(context, BW_INVALID, "the sliding support's normal is (0, 0, 0)"));
    for (int k = 0; k < 3; k++)
      support.normal[k] = normal[k] / max;
    double size = bw_norm(support.normal);
    for (int k = 0; k < 3; k++)
      support.normal[k] /= size;
  }
  BW_TRY(bwi_model_add_support(context, model, &support));
done:
  return status;
}

bw_status bw_model_prescribe(bw_context *context, bw_model *model, const bw_selection *on,
                             const bool fixed[3], const double value[3]) {
  bw_support support = {.on = on, .fixed = {fixed[0], fixed[1], fixed[2]}};
  bw_status status;
  BW_TRY(bwi_check_selection(context, model, on, true, "a prescribed displacement"));
  if (!fixed[0] && !fixed[1] && !fixed[2])
    BW_TRY(
        bw_fail(context, BW_INVALID,
                "a prescribed displacement constrains no direction: give a number for x, y or z"));
  for (int k = 0; k < 3; k++)
    support.value[k] = fixed[k] && value ? value[k] : 0;
  BW_TRY(check_finite(context, "prescribed displacement", support.value));
  BW_TRY(bwi_model_add_support(context, model, &support));
done:
  return status;
}

bw_status bw_model_prescribe_field(bw_context *context, bw_model *model, const bw_selection *on,
                                   const bool fixed[3], const bw_array *field) {
  bw_support support = {.on = on, .fixed = {fixed[0], fixed[1], fixed[2]}, .field = field};
  bw_status status;
  BW_TRY(bwi_check_selection(context, model, on, true, "a prescribed displacement"));
  if (!fixed[0] && !fixed[1] && !fixed[2])
    BW_TRY(
        bw_fail(context, BW_INVALID,
                "a prescribed displacement constrains no direction: give a number for x, y or z"));
  BW_TRY(check_nodal(context, model, field, 3, "prescribed displacement"));
  BW_TRY(bwi_model_add_support(context, model, &support));
done:
  return status;
}

/* ---- bonds ----------------------------------------------------------------------------------- */

/* The mean normal of the facets of a section and how far it is from a plane one. */
static bw_status section_normal(bw_context *context, const bw_selection *a, double normal[3]) {
  double area = 0, sum[3] = {0};
  for (int32_t f = 0; f < a->facet_count; f++) {
    bwi_boundary_point point[BW_QUADRATURE_POINTS];
    int points = bwi_boundary_points(a->mesh, a->facet[f], point);
    for (int p = 0; p < points; p++) {
      area += bw_norm(point[p].area);
      for (int k = 0; k < 3; k++)
        sum[k] += point[p].area[k];
    }
  }
  if (!(bw_norm(sum) > 0.999 * area))
    return bw_fail(
        context, BW_GEOMETRY,
        "side a of a bond with a preload is not plane: its mean normal covers %.3g of its "
        "area; cut the shank by a plane",
        area > 0 ? bw_norm(sum) / area : 0);
  for (int k = 0; k < 3; k++)
    normal[k] = sum[k] / bw_norm(sum);
  return BW_OK;
}

bw_status bw_model_bond(bw_context *context, bw_model *model, const bw_selection *a,
                        const bw_selection *b, double gap) {
  return bw_model_preload(context, model, a, b, gap, BW_NO_PRELOAD, 0);
}

bw_status bw_model_preload(bw_context *context, bw_model *model, const bw_selection *a,
                           const bw_selection *b, double gap, bw_preload_kind kind, double pull) {
  bw_status status;
  double normal[3] = {0};
  bw_bond bond;
  BW_TRY(bwi_check_selection(context, model, a, false, "side a of a bond"));
  BW_TRY(bwi_check_selection(context, model, b, false, "side b of a bond"));
  if (!isfinite(gap))
    return bw_fail(context, BW_INVALID, "the gap of a bond is not a finite number");
  if (!isfinite(pull))
    return bw_fail(context, BW_INVALID, "the %s of a bond is not a finite number",
                   kind == BW_PRELOAD_FORCE ? "preload" : "shortening");
  if (kind == BW_PRELOAD_FORCE && !(pull > 0))
    return bw_fail(
        context, BW_INVALID,
        "the preload of a bond is %g N: it pulls the sides together, and must be above 0", pull);
  if (model->cyclic && kind != BW_NO_PRELOAD)
    return bw_fail(context, BW_UNSUPPORTED,
                   "a sector of cyclic symmetry takes no preloads: leave it out, or model the "
                   "whole");
  if (kind != BW_NO_PRELOAD)
    BW_TRY(section_normal(context, a, normal));
  bw_bond *list = (bw_bond *)bw_resize(context, model->bond, (size_t)model->bond_count + 1,
                                       sizeof *model->bond);
  BW_TRY_MEMORY(list);
  model->bond = list;
  BW_TRY(bwi_bond_make(context, a, b, gap, &bond));
  bond.preload = kind;
  bond.pull = pull;
  memcpy(bond.normal, normal, sizeof normal);
  list[model->bond_count++] = bond;
  model->object.revision++;
done:
  return status;
}

void bw_model_clear_bonds(bw_model *model) {
  for (int i = 0; i < model->bond_count; i++)
    bwi_bond_clear(&model->bond[i]);
  if (model->bond_count > 0)
    model->object.revision++;
  model->bond_count = 0;
}

/* ---- attachments ----------------------------------------------------------------------------- */

static bw_status attach(bw_context *context, bw_model *model, const bw_selection *on, double mass,
                        const double stiffness[3], const char *what) {
  bw_status status;
  BW_TRY(bwi_check_selection(context, model, on, true, what));
  double area = bw_selection_area(on);
  if (on->facet_count > 0 && !(area > 0))
    return bw_fail(context, BW_GEOMETRY, "the %d facets that %s is attached to have no area",
                   on->facet_count, what);
  bw_attachment *list = (bw_attachment *)bw_resize(
      context, model->attachment, (size_t)model->attachment_count + 1, sizeof *model->attachment);
  BW_TRY_MEMORY(list);
  model->attachment = list;
  list[model->attachment_count] =
      (bw_attachment){.on = (const bw_selection *)bw_retain(on),
                      .mass = mass,
                      .stiffness = {stiffness[0], stiffness[1], stiffness[2]},
                      .area = area};
  model->attachment_count++;
  model->object.revision++;
  status = measure_gravity(context, model);
  if (status != BW_OK)
    bw_release(list[--model->attachment_count].on);
done:
  return status;
}

bw_status bw_model_attach_mass(bw_context *context, bw_model *model, const bw_selection *on,
                               double mass) {
  const double none[3] = {0, 0, 0};
  if (!(mass > 0) || !isfinite(mass))
    return bw_fail(context, BW_INVALID, "the attached mass is %g kg; it must be positive", mass);
  return attach(context, model, on, mass, none, "a mass");
}

bw_status bw_model_attach_spring(bw_context *context, bw_model *model, const bw_selection *on,
                                 const double stiffness[3]) {
  bw_status status;
  BW_TRY(check_finite(context, "spring's stiffness", stiffness));
  for (int k = 0; k < 3; k++)
    if (stiffness[k] < 0)
      return bw_fail(context, BW_INVALID,
                     "component %d of the spring's stiffness is %g N/m; it must be 0 or more",
                     k + 1, stiffness[k]);
  if (bw_norm(stiffness) == 0)
    return bw_fail(context, BW_INVALID,
                   "a spring has no stiffness: give x, y or z more than 0 N/m");
  BW_TRY(attach(context, model, on, 0, stiffness, "a spring"));
done:
  return status;
}

bw_status bw_model_clear_attachments(bw_context *context, bw_model *model) {
  for (int i = 0; i < model->attachment_count; i++)
    bw_release(model->attachment[i].on);
  if (model->attachment_count > 0)
    model->object.revision++;
  model->attachment_count = 0;
  return measure_gravity(context, model);
}

/* ---- couplings ------------------------------------------------------------------------------- */

bw_status bw_model_couple(bw_context *context, bw_model *model, const bw_selection *on,
                          const bw_remote_point *point) {
  bw_status status;
  BW_TRY(bwi_check_selection(context, model, on, true, "a coupling"));
  if (model->cyclic)
    return bw_fail(context, BW_UNSUPPORTED,
                   "a sector of cyclic symmetry takes no couplings: load the face itself");
  bw_coupling *list = bw_resize(context, model->coupling, (size_t)model->coupling_count + 1,
                                sizeof *model->coupling);
  BW_TRY_MEMORY(list);
  model->coupling = list;
  BW_TRY(bwi_coupling_make(context, model, on, point, &list[model->coupling_count]));
  model->coupling_count++;
  model->object.revision++;
  status = measure_gravity(context, model);
  if (status != BW_OK)
    bwi_coupling_clear(&list[--model->coupling_count]);
done:
  return status;
}

bw_status bw_model_clear_couplings(bw_context *context, bw_model *model) {
  for (int i = 0; i < model->coupling_count; i++)
    bwi_coupling_clear(&model->coupling[i]);
  if (model->coupling_count > 0)
    model->object.revision++;
  model->coupling_count = 0;
  return measure_gravity(context, model);
}

/* ---- loads ----------------------------------------------------------------------------------- */

/* Measures the load (area, resultant, moment) and adds it. */
bw_status bwi_model_add_load(bw_context *context, bw_model *model, bw_load *load) {
  bw_status status = bwi_load_measure(context, model, load);
  if (status != BW_OK)
    return status;
  if (!isfinite(bw_norm(load->resultant)) || !isfinite(bw_norm(load->moment)))
    return bw_fail(context, BW_INVALID, "the load's resultant is too large to be a number");
  bw_load *list = (bw_load *)bw_resize(context, model->load, (size_t)model->load_count + 1,
                                       sizeof *model->load);
  if (!list)
    return BW_MEMORY;
  model->load = list;
  const bw_array *nodal;
  status = copy_nodal(context, load->nodal, &nodal);
  if (status != BW_OK)
    return status;
  list[model->load_count] = *load;
  list[model->load_count].on = (const bw_selection *)bw_retain(load->on);
  list[model->load_count].nodal = nodal;
  model->load_count++;
  model->object.revision++;
  return BW_OK;
}

static bw_status add_on(bw_context *context, bw_model *model, const bw_selection *on,
                        bw_load_kind kind, const double vector[3], const char *what) {
  bw_load load = {.kind = kind, .on = on};
  bw_status status;
  BW_TRY(bwi_check_selection(context, model, on, false, what));
  BW_TRY(check_finite(context, what, vector));
  memcpy(load.vector, vector, sizeof load.vector);
  BW_TRY(bwi_model_add_load(context, model, &load));
done:
  return status;
}

bw_status bw_model_gravity(bw_context *context, bw_model *model, const double acceleration[3]) {
  bw_load load = {.kind = BW_LOAD_GRAVITY};
  bw_status status;
  BW_TRY(check_finite(context, "acceleration of gravity", acceleration));
  for (int32_t i = 0; i < bw_material_part_count(model->material); i++)
    if (!(bw_material_part(model->material, i)->density > 0))
      BW_TRY(bw_fail(context, BW_INVALID,
                     "gravity needs the density of the material \"%s\", which is not given",
                     bw_material_part(model->material, i)->name));
  memcpy(load.vector, acceleration, sizeof load.vector);
  BW_TRY(bwi_model_add_load(context, model, &load));
done:
  return status;
}

bw_status bw_model_pressure(bw_context *context, bw_model *model, const bw_selection *on,
                            double pressure) {
  double vector[3] = {pressure, 0, 0};
  return add_on(context, model, on, BW_LOAD_PRESSURE, vector, "a pressure");
}

bw_status bw_model_traction(bw_context *context, bw_model *model, const bw_selection *on,
                            const double traction[3]) {
  return add_on(context, model, on, BW_LOAD_TRACTION, traction, "a traction");
}

bw_status bw_model_force(bw_context *context, bw_model *model, const bw_selection *on,
                         const double force[3]) {
  return add_on(context, model, on, BW_LOAD_FORCE, force, "a force");
}

bw_status bw_model_torque(bw_context *context, bw_model *model, const bw_selection *on,
                          const double torque[3], const double about[3]) {
  bw_load load = {.kind = BW_LOAD_TORQUE, .on = on};
  bw_status status;
  BW_TRY(bwi_check_selection(context, model, on, false, "a torque"));
  BW_TRY(check_finite(context, "torque", torque));
  if (about) {
    BW_TRY(check_finite(context, "point that the torque is about", about));
    memcpy(load.about, about, sizeof load.about);
  } else
    bw_selection_centre(on, load.about);
  memcpy(load.vector, torque, sizeof load.vector);
  BW_TRY(bwi_model_add_load(context, model, &load));
done:
  return status;
}

bw_status bw_model_nodal_forces(bw_context *context, bw_model *model, const bw_array *force) {
  bw_load load = {.kind = BW_LOAD_NODAL, .nodal = force};
  bw_status status = check_nodal(context, model, force, 3, "nodal force");
  return status != BW_OK ? status : bwi_model_add_load(context, model, &load);
}

bw_status bw_model_temperature(bw_context *context, bw_model *model, const bw_array *change,
                               const double *expansion) {
  bw_load load = {.kind = BW_LOAD_TEMPERATURE,
                  .nodal = change,
                  .by_material = !expansion,
                  .expansion = expansion ? *expansion : 0};
  if (!isfinite(load.expansion))
    return bw_fail(context, BW_INVALID, "the coefficient of expansion is not a finite number");
  bw_status status = check_nodal(context, model, change, 1, "change of temperature");
  if (status == BW_OK && load.by_material)
    status = bwi_check_expansion(context, model->mesh, model->material, change);
  return status != BW_OK ? status : bwi_model_add_load(context, model, &load);
}

void bwi_model_drop_supports(bw_model *model, int kept) {
  for (int i = kept; i < model->support_count; i++)
    clear_support(&model->support[i]);
  if (model->support_count > kept)
    model->object.revision++;
  model->support_count = kept;
}

void bw_model_clear_supports(bw_model *model) {
  bwi_model_drop_supports(model, 0);
}

void bw_model_clear_loads(bw_model *model) {
  for (int i = 0; i < model->load_count; i++)
    clear_load(&model->load[i]);
  if (model->load_count > 0)
    model->object.revision++;
  model->load_count = 0;
}
