/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A model in words: what a person checks before believing an answer. */
#include <math.h>
#include <string.h>

#include "model/internal.h"

static void describe_mesh(bwi_text *out, const bw_mesh *mesh) {
  double low[3], high[3];
  bw_mesh_box(mesh, low, high);
  bwi_text_add(out, "mesh: ");
  bwi_text_integer(out, mesh->element_count);
  bwi_text_add(out, mesh->order == 1 ? " tet4 elements, " : " tet10 elements, ");
  bwi_text_integer(out, mesh->node_count);
  bwi_text_add(out, " nodes, ");
  bwi_text_integer(out, mesh->component_count);
  bwi_text_add(out, mesh->component_count == 1 ? " body, volume " : " bodies, volume ");
  bwi_text_number(out, bw_mesh_volume(mesh), 5, 0);
  bwi_text_add(out, " m3, box ");
  bwi_text_vector(out, low, 5, 0);
  bwi_text_add(out, " to ");
  bwi_text_vector(out, high, 5, 0);
  bwi_text_add(out, " m\n");
}

/* One number when all three agree. */
static void add_three(bwi_text *out, const char *name, const double v[3], const char *unit) {
  bwi_text_add(out, name);
  if (v[0] == v[1] && v[1] == v[2])
    bwi_text_number(out, v[0], 5, 0);
  else
    bwi_text_vector(out, v, 5, 0);
  bwi_text_add(out, unit);
}

/* `turned`: its axes differ from element to element. */
static void describe_material(bwi_text *out, const bw_material *material, bool turned) {
  bwi_text_add(out, material->name[0] ? material->name : "unnamed");
  bwi_text_add(out, material->isotropic ? ", isotropic" : ", orthotropic");
  if (turned)
    bwi_text_add(out, " with axes rotated by element");
  add_three(out, ", Young's modulus ", material->young, " Pa");
  add_three(out, ", Poisson's ratio ", material->poisson, "");
  if (!material->isotropic)
    add_three(out, ", shear modulus ", material->shear, " Pa");
  if (material->formulation == BW_B_BAR)
    bwi_text_add(out, ", B-bar formulation");
  if (material->density > 0) {
    bwi_text_add(out, ", density ");
    bwi_text_number(out, material->density, 5, 0);
    bwi_text_add(out, " kg/m3");
  } else
    bwi_text_add(out, ", density not given");
  if (material->expansion != 0) {
    bwi_text_add(out, ", expansion ");
    bwi_text_number(out, material->expansion, 5, 0);
    bwi_text_add(out, " 1/K");
  }
  if (material->strength[0] > 0 || material->strength[1] > 0 || material->strength[2] > 0)
    add_three(out, ", strength ", material->strength, " Pa");
  else
    bwi_text_add(out, ", strength not given");
}

/* " of 'core', 'shell'": regions of a mesh that have elements of a material, the first eight. */
static void name_regions(bwi_text *out, const bw_mesh *mesh, const bw_material *material,
                         const bw_material *own) {
  enum { SHOWN = 8 };
  int32_t named = 0;
  for (int32_t r = 0; r < mesh->region_count; r++) {
    bool has = false;
    for (int64_t e = 0; e < mesh->element_count && !has; e++)
      has = mesh->region[e] == r && bw_material_unrotated(material, e) == own;
    if (!has)
      continue;
    if (named == SHOWN) {
      bwi_text_add(out, " and others");
      return;
    }
    bwi_text_add(out, named++ ? ", '" : " of '");
    bwi_text_add(out, mesh->regions[r].name.text);
    bwi_text_add(out, "'");
  }
}

/* A line for each material, with the regions, the volume and the mass of its elements where there
 * are several; one whose axes turn is one. */
static void describe_materials(bwi_text *out, const bw_model *model) {
  const bw_mesh *mesh = model->mesh;
  const bw_material *material = model->material;
  const bw_material_parts *p = material->parts;
  bool mixed = bw_material_mixed(material);
  for (int32_t i = 0; i < bw_material_part_count(material); i++) {
    const bw_material *own = p ? p->unrotated[i] : material;
    bool met = false, turned = p && p->part[i] != own;
    for (int32_t k = 0; k < i; k++)
      met |= p->unrotated[k] == own;
    for (int32_t k = i + 1; p && k < p->count; k++)
      turned |= p->unrotated[k] == own && p->part[k] != own;
    if (met)
      continue;
    bwi_text_add(out, "material");
    if (mixed)
      name_regions(out, mesh, material, own);
    bwi_text_add(out, ": ");
    describe_material(out, own, turned);
    double volume = 0;
    for (int64_t e = 0; mixed && e < mesh->element_count; e++)
      volume += bw_material_unrotated(material, e) == own ? mesh->volume[e] : 0;
    if (mixed) {
      bwi_text_add(out, ", volume ");
      bwi_text_number(out, volume, 5, 0);
      bwi_text_add(out, " m3");
    }
    if (mixed && own->density > 0) {
      bwi_text_add(out, ", mass ");
      bwi_text_number(out, own->density * volume, 5, 0);
      bwi_text_add(out, " kg");
    }
    bwi_text_add(out, "\n");
  }
}

static void describe_selection(bwi_text *out, const bw_selection *on, double size) {
  double centre[3];
  bw_selection_centre(on, centre);
  bwi_text_integer(out, on->node_count);
  bwi_text_add(out, on->node_count == 1 ? " node" : " nodes");
  if (on->facet_count > 0) {
    bwi_text_add(out, ", ");
    bwi_text_integer(out, on->facet_count);
    bwi_text_add(out, on->facet_count == 1 ? " facet, area " : " facets, area ");
    bwi_text_number(out, bw_selection_area(on), 5, 0);
    bwi_text_add(out, " m2");
  }
  bwi_text_add(out, ", centre ");
  bwi_text_vector(out, centre, 5, 1e-9 * size);
  bwi_text_add(out, " m");
}

static void describe_support(bwi_text *out, const bw_support *support, int number, double size) {
  bwi_text_add(out, "support ");
  bwi_text_integer(out, number);
  if (support->slide) {
    static const char *const what[] = {": slides, fixed along ",
                                       ": plane of symmetry, fixed along ",
                                       ": plane of antisymmetry, fixed along "};
    bwi_text_add(out, what[support->symmetry]);
    if (bw_norm(support->normal) > 0)
      bwi_text_vector(out, support->normal, 5, 1e-12);
    else
      bwi_text_add(out, "its surface's normal");
  } else if (support->fixed[0] && support->fixed[1] && support->fixed[2] &&
             bw_norm(support->value) == 0 && !support->field)
    bwi_text_add(out, ": fixed");
  else if (support->field)
    bwi_text_add(out, ": moved by a field");
  else {
    static const char *const name[3] = {"x", "y", "z"};
    bool first = true;
    bwi_text_add(out, ": moved by ");
    for (int k = 0; k < 3; k++)
      if (support->fixed[k]) {
        bwi_text_add(out, first ? "" : ", ");
        bwi_text_add(out, name[k]);
        bwi_text_add(out, " = ");
        bwi_text_number(out, support->value[k], 5, 0);
        bwi_text_add(out, " m");
        first = false;
      }
  }
  bwi_text_add(out, "; ");
  describe_selection(out, support->on, size);
  bwi_text_add(out, "\n");
}

static void describe_resultant(bwi_text *out, const double resultant[3], const double moment[3],
                               double force, double moment_size) {
  bwi_text_add(out, "resultant ");
  bwi_text_vector(out, resultant, 5, 1e-10 * force);
  bwi_text_add(out, " N, moment about the origin ");
  bwi_text_vector(out, moment, 5, 1e-10 * moment_size);
  bwi_text_add(out, " N m\n");
}

/* What counts as rounding in a resultant: forces that cancel leave about 1e-16 of their size. */
static void sizes_of(const bw_load *load, double size, double *force, double *moment_size) {
  double max = bw_norm(load->vector);
  *force = bw_norm(load->resultant);
  if (load->kind == BW_LOAD_PRESSURE || load->kind == BW_LOAD_TRACTION)
    *force = fmax(*force, max * load->area);
  else if (load->kind == BW_LOAD_TORQUE)
    *force = fmax(*force, size > 0 ? max / size : 0);
  *moment_size = fmax(bw_norm(load->moment), *force * size);
}

static void describe_load(bwi_text *out, const bw_load *load, int number, double size) {
  static const char *const name[] = {": pressure ",
                                     ": traction ",
                                     ": force ",
                                     ": torque ",
                                     ": gravity ",
                                     ": forces at nodes",
                                     ": change of temperature"};
  static const char *const unit[] = {" Pa", " Pa", " N", " N m", " m/s2", "", ""};
  double force, moment_size;
  bwi_text_add(out, "load ");
  bwi_text_integer(out, number);
  bwi_text_add(out, name[load->kind]);
  if (load->kind == BW_LOAD_PRESSURE)
    bwi_text_number(out, load->vector[0], 5, 0);
  else if (!load->nodal)
    bwi_text_vector(out, load->vector, 5, 0);
  bwi_text_add(out, unit[load->kind]);
  if (load->kind == BW_LOAD_TORQUE) {
    bwi_text_add(out, " about ");
    bwi_text_vector(out, load->about, 5, 1e-9 * size);
    bwi_text_add(out, " m");
  }
  bwi_text_add(out, "; ");
  if (load->on) {
    describe_selection(out, load->on, size);
    bwi_text_add(out, "; ");
  }
  sizes_of(load, size, &force, &moment_size);
  describe_resultant(out, load->resultant, load->moment, force, moment_size);
}

static void describe_bond(bwi_text *out, const bw_bond *bond, int number, double size) {
  bwi_text_add(out, "bond ");
  bwi_text_integer(out, number);
  bwi_text_add(out, ": ");
  bwi_text_number(out, bond->area, 5, 0);
  bwi_text_add(out, " m2, ");
  bwi_text_integer(out, bond->node_count);
  bwi_text_add(out, " nodes of side a follow side b, largest gap ");
  bwi_text_number(out, bond->gap, 3, 1e-12 * size);
  bwi_text_add(out, " m");
  if (bond->preload != BW_NO_PRELOAD) {
    bool force = bond->preload == BW_PRELOAD_FORCE;
    bwi_text_add(out, force ? ", preload " : ", shortened by ");
    bwi_text_number(out, bond->pull, 5, 0);
    bwi_text_add(out, force ? " N along " : " m along ");
    bwi_text_vector(out, bond->normal, 4, 1e-9);
  }
  bwi_text_add(out, "; a: ");
  describe_selection(out, bond->a, size);
  bwi_text_add(out, "; b: ");
  describe_selection(out, bond->b, size);
  bwi_text_add(out, "\n");
}

static void describe_attachment(bwi_text *out, const bw_attachment *attachment, int number,
                                double size) {
  bwi_text_add(out, "attachment ");
  bwi_text_integer(out, number);
  if (attachment->mass > 0) {
    bwi_text_add(out, ": mass ");
    bwi_text_number(out, attachment->mass, 5, 0);
    bwi_text_add(out, " kg; ");
  } else {
    bwi_text_add(out, ": spring ");
    bwi_text_vector(out, attachment->stiffness, 5, 0);
    bwi_text_add(out, " N/m; ");
  }
  describe_selection(out, attachment->on, size);
  bwi_text_add(out, "\n");
}

/* " {name} (x, y, z) unit" of three components that are not all 0. */
static void describe_part(bwi_text *out, const char *name, const double v[3], const char *unit) {
  if (bw_norm(v) == 0)
    return;
  bwi_text_add(out, name);
  bwi_text_vector(out, v, 5, 0);
  bwi_text_add(out, unit);
}

static void describe_coupling(bwi_text *out, const bw_coupling *coupling, int number, double size) {
  static const char *const component[] = {"x", "y", "z", "rotation x", "rotation y", "rotation z"};
  const bw_remote_point *point = &coupling->point;
  const double diagonal[3] = {point->inertia[0], point->inertia[4], point->inertia[8]};
  bool any = false;
  bwi_text_add(out, "coupling ");
  bwi_text_integer(out, number);
  bwi_text_add(out, point->kind == BW_RIGID ? ": rigid, " : ": distributed, ");
  bwi_text_number(out, coupling->area, 5, 0);
  bwi_text_add(out, " m2, ");
  bwi_text_integer(out, coupling->node_count);
  bwi_text_add(out, " nodes, remote point at ");
  bwi_text_vector(out, point->at, 5, 1e-9 * size);
  bwi_text_add(out, " m");
  describe_part(out, ", force ", point->load, " N");
  describe_part(out, ", moment ", point->load + 3, " N m");
  if (point->mass > 0) {
    bwi_text_add(out, ", mass ");
    bwi_text_number(out, point->mass, 5, 0);
    bwi_text_add(out, " kg");
  }
  describe_part(out, ", inertia ", diagonal, " kg m2");
  describe_part(out, ", spring ", point->spring, " N/m");
  describe_part(out, ", spring ", point->spring + 3, " N m/rad");
  for (int k = 0; k < 6; k++) {
    if (!point->fixed[k])
      continue;
    bwi_text_add(out, any ? ", " : "; prescribes ");
    any = true;
    bwi_text_add(out, component[k]);
    bwi_text_add(out, " = ");
    bwi_text_number(out, point->displacement[k], 5, 0);
    bwi_text_add(out, k < 3 ? " m" : " rad");
  }
  bwi_text_add(out, "; ");
  describe_selection(out, coupling->on, size);
  bwi_text_add(out, "\n");
}

static void describe_cyclic(bwi_text *out, const bw_cyclic *cyclic, double size) {
  bwi_text_add(out, "cyclic symmetry: one of ");
  bwi_text_integer(out, cyclic->count);
  bwi_text_add(out, " sectors about the axis through ");
  bwi_text_vector(out, cyclic->point, 5, 1e-9 * size);
  bwi_text_add(out, " m along ");
  bwi_text_vector(out, cyclic->axis, 5, 1e-12);
  bwi_text_add(out, ", ");
  bwi_text_integer(out, cyclic->axis_count);
  bwi_text_add(out, " nodes on it, faces match within ");
  bwi_text_number(out, cyclic->distance, 3, 1e-12 * size);
  bwi_text_add(out, " m; masses, loads and results are of one sector; low: ");
  describe_selection(out, cyclic->low, size);
  bwi_text_add(out, "; high: ");
  describe_selection(out, cyclic->high, size);
  bwi_text_add(out, "\n");
}

/* The same of bodies with bonds and springs. */
static bw_status describe_bonded(bw_context *context, bwi_text *out, const bw_model *model,
                                 const bw_dof_map *dof_map) {
  int count;
  int32_t body;
  bw_status status = model->cyclic
                         ? bwi_cyclic_rigid_modes(context, model, dof_map, 0, &count, &body)
                         : bwi_bonded_rigid_modes(context, model, dof_map, false, &count, &body);
  if (status != BW_OK)
    return status;
  if (count == 0)
    bwi_text_add(out, "no rigid-body mode is unconstrained\n");
  else {
    bwi_text_integer(out, count);
    bwi_text_add(out, count == 1 ? " rigid-body mode" : " rigid-body modes");
    bwi_text_add(out, model->cyclic ? " that all sectors share unconstrained\n"
                                    : " of the joined bodies unconstrained\n");
  }
  return BW_OK;
}

/* Which rigid-body motions the supports leave free, or why that is unknown. */
static bw_status describe_free(bw_context *context, bwi_text *out, const bw_model *model) {
  bw_dof_map *dof_map = NULL;
  char *text = NULL;
  bw_status status = bwi_dof_map_apart(context, model, &dof_map);
  if (status == BW_INVALID) {
    bwi_text_add(out, "supports contradict each other: ");
    bwi_text_add(out, bw_message(context));
    bwi_text_add(out, "\n");
    bw_clear_failure(context);
    return BW_OK;
  }
  if (status != BW_OK)
    goto done;
  if (bw_model_joined(model)) {
    BW_TRY(describe_bonded(context, out, model, dof_map));
    goto done;
  }
  BW_TRY(bw_dof_map_describe_rigid_modes(context, dof_map, &text));
  bwi_text_add(out, "unknowns: ");
  bwi_text_integer(out, dof_map->unknown_count);
  bwi_text_add(out, "; ");
  bwi_text_add(out, text);
  bwi_text_add(out, "\n");
done:
  bw_free(text);
  bw_release(dof_map);
  return status;
}

bw_status bw_model_describe(bw_context *context, const bw_model *model, char **text) {
  bwi_text out = {.context = context};
  double low[3], high[3], diagonal[3], total[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
  double all_force = 0, all_moment = 0;
  bw_mesh_box(model->mesh, low, high);
  for (int k = 0; k < 3; k++)
    diagonal[k] = high[k] - low[k];
  double size = bw_norm(diagonal);
  describe_mesh(&out, model->mesh);
  describe_materials(&out, model);
  if (model->support_count == 0)
    bwi_text_add(&out, "no support\n");
  for (int i = 0; i < model->support_count; i++)
    describe_support(&out, &model->support[i], i + 1, size);
  if (model->load_count == 0)
    bwi_text_add(&out, "no load\n");
  for (int i = 0; i < model->load_count; i++) {
    const bw_load *load = &model->load[i];
    double force, moment_size;
    describe_load(&out, load, i + 1, size);
    sizes_of(load, size, &force, &moment_size);
    all_force += force;
    all_moment += moment_size;
    for (int k = 0; k < 3; k++) {
      total[k] += load->resultant[k];
      moment[k] += load->moment[k];
    }
  }
  if (model->load_count > 1) {
    bwi_text_add(&out, "all loads: ");
    describe_resultant(&out, total, moment, all_force, all_moment);
  }
  for (int i = 0; i < model->bond_count; i++)
    describe_bond(&out, &model->bond[i], i + 1, size);
  for (int i = 0; i < model->attachment_count; i++)
    describe_attachment(&out, &model->attachment[i], i + 1, size);
  for (int i = 0; i < model->coupling_count; i++)
    describe_coupling(&out, &model->coupling[i], i + 1, size);
  if (model->cyclic)
    describe_cyclic(&out, model->cyclic, size);
  bw_status status = describe_free(context, &out, model);
  if (status == BW_OK && out.failed)
    status = BW_MEMORY;
  if (status != BW_OK) {
    bw_free(out.bytes);
    return status;
  }
  *text = out.bytes;
  return BW_OK;
}
