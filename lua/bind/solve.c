/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Static results, modes and systems: views on what the engine computed, and stress fields that are
 * computed when they are asked for and kept with the result. */
#include "bind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- statics --------------------------------------------------------------------------------- */

static const bw_static *self(lua_State *L) {
  return (const bw_static *)lbw_check(L, 1, &lbw_static_class);
}

static size_t static_bytes(const void *object) {
  return bw_bytes(object) + bw_bytes(((const bw_static *)object)->system);
}

#define NODE_VIEW(name, field)                                                                     \
  static int name(lua_State *L) {                                                                  \
    const bw_static *result = self(L);                                                             \
    return lbw_push_borrowed(L, BW_F64, result->model->mesh->node_count, 3, result->field,         \
                             result);                                                              \
  }
NODE_VIEW(static_displacement, displacement)
NODE_VIEW(static_force, force)
NODE_VIEW(static_reaction, reaction)
#undef NODE_VIEW

static int compute_stress(lua_State *L) {
  const bw_static *result = self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, result->model->mesh->node_count, 6)->data;
  lbw_leave_or_raise(L, bw_static_stress(lbw_enter(L), result, true, out));
  return 1;
}

static int compute_element_stress(lua_State *L) {
  const bw_static *result = self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, result->model->mesh->element_count, 6)->data;
  lbw_leave_or_raise(L, bw_static_stress(lbw_enter(L), result, false, out));
  return 1;
}

static int static_stress(lua_State *L) {
  return lbw_cached(L, "stress", compute_stress);
}

static int static_element_stress(lua_State *L) {
  return lbw_cached(L, "element_stress", compute_element_stress);
}

/* The packed tensors of the array on the top of the stack. */
static const double *tensors(lua_State *L, int64_t *count) {
  const bw_array *array = (const bw_array *)lbw_test(L, -1, &lbw_array_class);
  *count = array->rows;
  return (const double *)array->data;
}

typedef bw_status row_function(bw_context *context, int64_t count, const double *stress,
                               double *value);

static bw_status principal_values(bw_context *context, int64_t count, const double *stress,
                                  double *value) {
  return bw_principal_field(context, count, stress, value, NULL);
}

static int by_rows(lua_State *L, row_function *function, int64_t columns) {
  int64_t count;
  const double *stress = tensors(L, &count);
  double *out = (double *)lbw_push_array(L, BW_F64, count, columns)->data;
  lbw_leave_or_raise(L, function(lbw_enter(L), count, stress, out));
  return 1;
}

#define DERIVED(name, source, function, columns)                                                   \
  static int compute_##name(lua_State *L) {                                                        \
    source(L);                                                                                     \
    return by_rows(L, function, columns);                                                          \
  }                                                                                                \
  static int static_##name(lua_State *L) {                                                         \
    return lbw_cached(L, #name, compute_##name);                                                   \
  }
DERIVED(von_mises, static_stress, bw_von_mises_field, 1)
DERIVED(principal, static_stress, principal_values, 3)
DERIVED(max_principal, static_stress, bw_max_principal_field, 1)
DERIVED(element_von_mises, static_element_stress, bw_von_mises_field, 1)
DERIVED(element_principal, static_element_stress, principal_values, 3)
DERIVED(element_max_principal, static_element_stress, bw_max_principal_field, 1)
#undef DERIVED

static int directions(lua_State *L) {
  int64_t count;
  const double *stress = tensors(L, &count);
  double *value = (double *)lua_newuserdatauv(L, (size_t)count * 3 * sizeof *value + 1, 0);
  double *out = (double *)lbw_push_array(L, BW_F64, count, 9)->data;
  lbw_leave_or_raise(L, bw_principal_field(lbw_enter(L), count, stress, value, out));
  return 1;
}

static int compute_principal_directions(lua_State *L) {
  static_stress(L);
  return directions(L);
}

static int static_principal_directions(lua_State *L) {
  return lbw_cached(L, "principal_directions", compute_principal_directions);
}

static int compute_utilisation(lua_State *L) {
  const bw_static *result = self(L);
  static_element_stress(L);
  int64_t count;
  const double *stress = tensors(L, &count);
  double *out = (double *)lbw_push_array(L, BW_F64, count, 1)->data;
  lbw_leave_or_raise(
      L, bw_utilisation_field(lbw_enter(L), result->model->material, count, stress, out));
  return 1;
}

static int static_utilisation(lua_State *L) {
  return lbw_cached(L, "utilisation", compute_utilisation);
}

static int compute_element_energy(lua_State *L) {
  const bw_static *result = self(L);
  const bw_model *model = result->model;
  double *out = (double *)lbw_push_array(L, BW_F64, model->mesh->element_count, 1)->data;
  lbw_leave_or_raise(
      L, bw_element_energy(lbw_enter(L), model->mesh, model->material, result->displacement, out));
  return 1;
}

static int static_element_energy(lua_State *L) {
  return lbw_cached(L, "element_energy", compute_element_energy);
}

/* static:error_estimate(): relative error in the energy norm, error energy of every element */
static int static_error_estimate(lua_State *L) {
  const bw_static *result = self(L);
  const bw_model *model = result->model;
  double *out = (double *)lbw_push_array(L, BW_F64, model->mesh->element_count, 1)->data;
  double relative = 0;
  bw_status status = bw_error_estimate(lbw_enter(L), model->mesh, model->material,
                                       result->displacement, out, &relative);
  lua_pushnumber(L, relative);
  lua_insert(L, -2);
  return lbw_leave(L, status, 2);
}

/* Pushes a table with the fields of tractions, which are yet to be computed. */
static void push_tractions(lua_State *L, const bw_mesh *mesh, double *data[3]) {
  static const char *const fields[] = {"traction", "normal", "shear"};
  lua_createtable(L, 0, 10);
  for (int i = 0; i < 3; i++) {
    data[i] = (double *)lbw_push_array(L, BW_F64, mesh->node_count, i == 0 ? 3 : 1)->data;
    lua_setfield(L, -2, fields[i]);
  }
}

/* What they sum to, into the table on the top. */
static void add_sums(lua_State *L, const bw_interface_force *sum) {
  lbw_push_vector(L, sum->force);
  lua_setfield(L, -2, "force");
  lbw_push_vector(L, sum->moment);
  lua_setfield(L, -2, "moment");
  lua_pushnumber(L, sum->area);
  lua_setfield(L, -2, "area");
  lua_pushinteger(L, sum->shared);
  lua_setfield(L, -2, "shared");
}

/* static:interface_traction(a, b): fields over the nodes, and what they sum to */
static int static_interface_traction(lua_State *L) {
  const bw_static *result = self(L);
  const bw_mesh *mesh = result->model->mesh;
  double *data[3];
  lua_settop(L, 3);
  int32_t a = lbw_check_region(L, 2, mesh), b = lbw_check_region(L, 3, mesh);
  if (a == b)
    lbw_error(L, "interface_traction: two different regions expected, got '%s' twice",
              mesh->regions[a].name.text);
  bw_interface_force sum;
  push_tractions(L, mesh, data);
  bw_status status =
      bw_interface_traction(lbw_enter(L), result, a, b, data[0], data[1], data[2], &sum);
  add_sums(L, &sum);
  lua_pushnumber(L, sum.imbalance);
  lua_setfield(L, -2, "imbalance");
  for (int i = 2; i <= 3; i++) {
    lua_pushvalue(L, i);
    lua_setfield(L, -2, i == 2 ? "a" : "b");
  }
  return lbw_leave(L, status, 1);
}

/* static:joint_traction(kind, number): the same of a joint or a support, and its nodes. The Lua
 * library reads the options. */
static int static_joint_traction(lua_State *L) {
  static const char *const kinds[] = {"bond", "attachment", "coupling", "support"};
  const bw_static *result = self(L);
  const bw_model *model = result->model;
  bw_interface_force sum;
  double *data[3];
  lua_settop(L, 3);
  bw_joint_kind kind = (bw_joint_kind)lbw_check_index(L, 2, "kind", 4);
  const int count[] = {model->bond_count, model->attachment_count, model->coupling_count,
                       model->support_count};
  int index = (int)lbw_check_index(L, 3, kinds[kind], count[kind]);
  push_tractions(L, model->mesh, data);
  const bw_bond *bond = kind == BW_JOINT_BOND ? &model->bond[index] : NULL;
  const bw_selection *on = kind == BW_JOINT_ATTACHMENT ? model->attachment[index].on
                           : kind == BW_JOINT_COUPLING ? model->coupling[index].on
                           : kind == BW_JOINT_SUPPORT  ? model->support[index].on
                                                       : NULL;
  int32_t nodes = bond ? bond->node_count : on->node_count;
  const int32_t *node = bond ? bond->node : on->node;
  int32_t *out = (int32_t *)lbw_push_array(L, BW_I32, nodes, 1)->data;
  for (int32_t i = 0; i < nodes; i++)
    out[i] = node[i] + 1;
  lua_setfield(L, -2, "nodes");
  bw_status status =
      bw_joint_traction(lbw_enter(L), result, kind, index, data[0], data[1], data[2], &sum);
  add_sums(L, &sum);
  return lbw_leave(L, status, 1);
}

LBW_PUSH(static_energy, lua_pushnumber(L, self(L)->energy))
LBW_PUSH(static_residual, lua_pushnumber(L, self(L)->residual))

/* Pushes what print says of a bond or an attachment. */
static void push_force_text(lua_State *L, const bw_joint_force *of, const char *on) {
  lua_pushfstring(L, "force on %s %s", on, lbw_triple(of->force, 1, "N").text);
  if (of->preloaded) {
    lua_pushfstring(L, ", preload %s, shortening %s", lbw_quantity(of->preload, "N").text,
                    lbw_quantity(of->shortening, "m").text);
    lua_concat(L, 2);
  }
  lua_pushliteral(L, "; " LBW_ERROR_UNKNOWN);
  lua_concat(L, 2);
}

static void push_coupling_text(lua_State *L, const bw_coupling_result *of) {
  lua_pushfstring(
      L, "remote point moves by %s, turns by %s, reaction %s and %s; " LBW_ERROR_UNKNOWN,
      lbw_triple(of->displacement, 1, "m").text, lbw_triple(of->displacement + 3, 1, "rad").text,
      lbw_triple(of->reaction, 1, "N").text, lbw_triple(of->reaction + 3, 1, "N m").text);
}

static const char on_bond[] = "side a", on_attachment[] = "the body";

static int push_joint_forces(lua_State *L, int count, const bw_joint_force *of, const char *on) {
  lua_createtable(L, count, 0);
  for (int i = 0; i < count; i++) {
    lua_createtable(L, 0, 2);
    lbw_push_vector(L, of[i].force);
    lua_setfield(L, -2, "force");
    lbw_push_vector(L, of[i].moment);
    lua_setfield(L, -2, "moment");
    if (of[i].preloaded) {
      lua_pushnumber(L, of[i].preload);
      lua_setfield(L, -2, "preload");
      lua_pushnumber(L, of[i].shortening);
      lua_setfield(L, -2, "shortening");
    }
    push_force_text(L, &of[i], on);
    lbw_prints(L);
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

/* What the bonds transmit. */
static int static_bonds(lua_State *L) {
  return push_joint_forces(L, self(L)->bond_count, self(L)->bond, on_bond);
}

/* What masses and springs exert. */
static int static_attachments(lua_State *L) {
  return push_joint_forces(L, self(L)->attachment_count, self(L)->attachment, on_attachment);
}

/* What remote points do. */
static int static_couplings(lua_State *L) {
  const bw_static *result = self(L);
  lua_createtable(L, result->coupling_count, 0);
  for (int i = 0; i < result->coupling_count; i++) {
    const bw_coupling_result *of = &result->coupling[i];
    const struct {
      const char *name;
      const double *value;
    } field[] = {{"displacement", of->displacement},
                 {"rotation", of->displacement + 3},
                 {"force", of->load},
                 {"moment", of->load + 3},
                 {"reaction", of->reaction},
                 {"reaction_moment", of->reaction + 3}};
    lua_createtable(L, 0, 6);
    for (size_t k = 0; k < sizeof field / sizeof *field; k++) {
      lbw_push_vector(L, field[k].value);
      lua_setfield(L, -2, field[k].name);
    }
    push_coupling_text(L, of);
    lbw_prints(L);
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

LBW_PUSH(static_mesh, lbw_push(L, &lbw_mesh_class, self(L)->model->mesh))
LBW_PUSH(static_material, lbw_push(L, &lbw_material_class, self(L)->model->material))

static void push_times(lua_State *L, const bw_solve_times *times) {
  const struct {
    const char *key;
    double value;
  } list[] = {{"pattern", times->pattern},
              {"stiffness", times->stiffness},
              {"order", times->order},
              {"factor", times->factor},
              {"pcg", times->pcg},
              {"solve", times->solve},
              {"factor_flops", times->factor_flops},
              {"factor_reused", times->factor_reused}};
  lua_createtable(L, 0, 10);
  for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
    lua_pushnumber(L, list[i].value);
    lua_setfield(L, -2, list[i].key);
  }
  lua_pushinteger(L, times->factor_entries);
  lua_setfield(L, -2, "factor_entries");
  lua_pushinteger(L, times->elements);
  lua_setfield(L, -2, "elements");
}

static int static_times(lua_State *L) {
  const bw_system *system = self(L)->system;
  if (!system) /* a solution of an edit session, which has figures of its own */
    lua_pushnil(L);
  else
    push_times(L, &system->times);
  return 1;
}

/* How an external solver worked, into the table on the top. */
static void add_external(lua_State *L, const bw_external_report *report) {
  lua_pushinteger(L, report->ranks);
  lua_setfield(L, -2, "ranks");
  lua_pushnumber(L, report->send);
  lua_setfield(L, -2, "send_seconds");
  lua_pushnumber(L, report->assembly);
  lua_setfield(L, -2, "assembly_seconds");
  lua_pushnumber(L, report->setup);
  lua_setfield(L, -2, "setup_seconds");
  lua_pushnumber(L, report->solve);
  lua_setfield(L, -2, "solve_seconds");
  lua_pushnumber(L, report->processor);
  lua_setfield(L, -2, "processor_seconds");
  lua_pushnumber(L, report->largest);
  lua_setfield(L, -2, "largest_rank_bytes");
  if (report->energy_error > 0) {
    lua_pushnumber(L, report->energy_error);
    lua_setfield(L, -2, "energy_error");
  }
}

static int static_report(lua_State *L) {
  const bw_static *result = self(L);
  lbw_push_report(L, &result->report);
  if (result->external)
    add_external(L, result->external);
  return 1;
}

LBW_PUSH(unknown_error, lua_pushliteral(L, LBW_ERROR_UNKNOWN))

/* note_error(static, text): what print says of its error, where meshes were compared */
static int core_note_error(lua_State *L) {
  lbw_check(L, 1, &lbw_static_class);
  lbw_check_text(L, 2, NULL);
  lua_settop(L, 2);
  lbw_cached(L, "error", unknown_error); /* makes the table of what is kept, 3 */
  lua_pushvalue(L, 2);
  lua_setfield(L, 3, "error");
  return 0;
}

/* Bonds, attachments and couplings that print lists, of each kind. */
enum { JOINTS_PRINTED = 10 };

static void add_joint(luaL_Buffer *out, const char *kind, int number) {
  char text[40];
  snprintf(text, sizeof text, "\n  %s %d: ", kind, number);
  luaL_addstring(out, text);
}

static void add_rest(luaL_Buffer *out, const char *kind, int count) {
  char text[60];
  if (count <= JOINTS_PRINTED)
    return;
  snprintf(text, sizeof text, "\n  and %d %ss more", count - JOINTS_PRINTED, kind);
  luaL_addstring(out, text);
}

/* What joins the bodies, a line for each. */
void lbw_add_joints(lua_State *L, luaL_Buffer *out, const bw_static *result) {
  for (int i = 0; i < result->bond_count && i < JOINTS_PRINTED; i++) {
    add_joint(out, "bond", i + 1);
    push_force_text(L, &result->bond[i], on_bond);
    luaL_addvalue(out);
  }
  add_rest(out, "bond", result->bond_count);
  for (int i = 0; i < result->attachment_count && i < JOINTS_PRINTED; i++) {
    add_joint(out, "attachment", i + 1);
    push_force_text(L, &result->attachment[i], on_attachment);
    luaL_addvalue(out);
  }
  add_rest(out, "attachment", result->attachment_count);
  for (int i = 0; i < result->coupling_count && i < JOINTS_PRINTED; i++) {
    add_joint(out, "coupling", i + 1);
    push_coupling_text(L, &result->coupling[i]);
    luaL_addvalue(out);
  }
  add_rest(out, "coupling", result->coupling_count);
}

static int static_tostring(lua_State *L) {
  const bw_static *result = (const bw_static *)lbw_check(L, 1, &lbw_static_class);
  double largest = 0;
  for (int64_t i = 0; i < result->model->mesh->node_count; i++) {
    double length = bw_norm(result->displacement + 3 * i);
    largest = length > largest ? length : largest;
  }
  const bw_solver_report *report = &result->report;
  char text[400], how[120];
  lua_settop(L, 1);
  lbw_cached(L, "error", unknown_error);
  if (report->iterations > 0 && *report->preconditioner)
    snprintf(how, sizeof how, ", by %s (%s) in %d iterations", report->solver,
             report->preconditioner, report->iterations);
  else
    snprintf(how, sizeof how, ", by %s (%s)", report->solver,
             *report->preconditioner ? report->preconditioner : report->backend);
  snprintf(text, sizeof text,
           "static solution on %d nodes: largest displacement %s, strain energy %s, residual "
           "%.1e%s; %.80s",
           (int)result->model->mesh->node_count, lbw_quantity(largest, "m").text,
           lbw_quantity(result->energy, "J").text, result->residual, how, lua_tostring(L, -1));
  luaL_Buffer out;
  luaL_buffinit(L, &out);
  luaL_addstring(&out, text);
  lbw_add_joints(L, &out, result);
  luaL_pushresult(&out);
  return 1;
}

/* static:whole() */
static int static_whole(lua_State *L) {
  const bw_static *sector = self(L);
  lbw_box *box = lbw_box_new(L, &lbw_static_class);
  bw_static *whole = NULL;
  bw_status status = bw_static_whole(lbw_enter(L), sector, &whole);
  lbw_box_fill(L, box, whole);
  return lbw_leave(L, status, 1);
}

static int static_locking(lua_State *L) {
  const bw_model *model = self(L)->model;
  lua_pushstring(L, bw_locking(model->mesh, model->material));
  return 1;
}

static const luaL_Reg static_methods[] = {{"error_estimate", static_error_estimate},
                                          {"interface_traction", static_interface_traction},
                                          {"joint_traction", static_joint_traction},
                                          {"whole", static_whole},
                                          {NULL, NULL}};
static const luaL_Reg static_properties[] = {
    {"displacement", static_displacement},
    {"force", static_force},
    {"reaction", static_reaction},
    {"stress", static_stress},
    {"von_mises", static_von_mises},
    {"principal", static_principal},
    {"principal_directions", static_principal_directions},
    {"max_principal", static_max_principal},
    {"element_stress", static_element_stress},
    {"element_von_mises", static_element_von_mises},
    {"element_principal", static_element_principal},
    {"element_max_principal", static_element_max_principal},
    {"element_energy", static_element_energy},
    {"utilisation", static_utilisation},
    {"energy", static_energy},
    {"residual", static_residual},
    {"bonds", static_bonds},
    {"attachments", static_attachments},
    {"couplings", static_couplings},
    {"locking", static_locking},
    {"mesh", static_mesh},
    {"material", static_material},
    {"times", static_times},
    {"report", static_report},
    {NULL, NULL}};
static const luaL_Reg static_meta[] = {{"__tostring", static_tostring}, {NULL, NULL}};
const lbw_class lbw_static_class = {"static", static_methods, static_properties, static_meta,
                                    static_bytes};

/* ---- modes ----------------------------------------------------------------------------------- */

static const bw_modes *modes_self(lua_State *L) {
  return (const bw_modes *)lbw_check(L, 1, &lbw_modes_class);
}

/* modes:shape(i): a view, a row for every node */
static int modes_shape(lua_State *L) {
  const bw_modes *modes = modes_self(L);
  int64_t i = lbw_check_index(L, 2, "mode", modes->count);
  int64_t size = (int64_t)modes->mesh->node_count * modes->components;
  return lbw_push_borrowed(L, BW_F64, modes->mesh->node_count, modes->components,
                           modes->shape + i * size, modes);
}

static int modes_eigenvalues(lua_State *L) {
  const bw_modes *modes = modes_self(L);
  return lbw_push_borrowed(L, BW_F64, modes->count, 1, modes->eigenvalue, modes);
}

static int modes_frequencies(lua_State *L) {
  const bw_modes *modes = modes_self(L);
  if (!modes->frequency)
    return 0;
  return lbw_push_borrowed(L, BW_F64, modes->count, 1, modes->frequency, modes);
}

static int modes_residuals(lua_State *L) {
  const bw_modes *modes = modes_self(L);
  return lbw_push_borrowed(L, BW_F64, modes->count, 1, modes->residual, modes);
}

LBW_PUSH(modes_count, lua_pushinteger(L, modes_self(L)->count))
LBW_PUSH(modes_components, lua_pushinteger(L, modes_self(L)->components))
LBW_PUSH(modes_rigid_count, lua_pushinteger(L, modes_self(L)->rigid_count))
LBW_PUSH(modes_solves, lua_pushinteger(L, modes_self(L)->solves))
LBW_PUSH(modes_recovered, lua_pushinteger(L, modes_self(L)->recovered))
LBW_PUSH(modes_counted, lua_pushboolean(L, modes_self(L)->counted))
LBW_PUSH(modes_tested, lua_pushboolean(L, modes_self(L)->tested))
LBW_PUSH(modes_mesh, lbw_push(L, &lbw_mesh_class, modes_self(L)->mesh))

/* The nodal diameters of a sector's modes, or nil. */
static int modes_nodal_diameters(lua_State *L) {
  const bw_modes *modes = modes_self(L);
  if (!modes->nodal_diameter)
    return 0;
  lua_createtable(L, modes->count, 0);
  for (int k = 0; k < modes->count; k++) {
    lua_pushinteger(L, modes->nodal_diameter[k]);
    lua_rawseti(L, -2, k + 1);
  }
  return 1;
}

/* modes:whole() */
static int modes_whole(lua_State *L) {
  const bw_modes *modes = modes_self(L);
  lbw_box *box = lbw_box_new(L, &lbw_modes_class);
  bw_modes *whole = NULL;
  bw_status status = bw_modes_whole(lbw_enter(L), modes, &whole);
  lbw_box_fill(L, box, whole);
  return lbw_leave(L, status, 1);
}

static int modes_report(lua_State *L) {
  const bw_modes *modes = modes_self(L);
  lbw_push_report(L, &modes->report);
  if (modes->external)
    add_external(L, modes->external);
  return 1;
}

static int modes_length(lua_State *L) {
  return modes_count(L);
}

/* The largest estimated error of the frequencies, in cents; false where it is not known. */
static bool largest_error(lua_State *L, const bw_modes *modes, double *cents) {
  double *relative = (double *)lua_newuserdatauv(L, (size_t)modes->count * sizeof *relative, 0);
  bw_status status = bw_modes_error(lbw_enter(L), modes, relative);
  *cents = 0;
  for (int k = 0; k < modes->count && status == BW_OK; k++)
    *cents = fmax(*cents, 600 * log2(1 + relative[k]));
  lbw_leave(L, status, 0);
  return status == BW_OK;
}

static int modes_tostring(lua_State *L) {
  const bw_modes *modes = (const bw_modes *)lbw_check(L, 1, &lbw_modes_class);
  char text[280], error[60] = LBW_ERROR_UNKNOWN;
  int last = modes->count - 1;
  if (modes->count == 0)
    snprintf(text, sizeof text, "no modes");
  else if (modes->frequency) {
    double cents;
    if (largest_error(L, modes, &cents))
      snprintf(error, sizeof error,
               cents < 10 ? "about %.2g cents too high at most"
                          : "about %.0f cents too high at most",
               cents);
    snprintf(text, sizeof text,
             "%d elastic modes%s by %s, %s to %s, %d rigid-body motions left out%s; %s",
             modes->count, modes->cyclic ? " of the whole of sectors" : "", modes->report.solver,
             lbw_quantity(modes->frequency[0], "Hz").text,
             lbw_quantity(modes->frequency[last], "Hz").text, modes->rigid_count,
             modes->counted  ? ", none missing"
             : modes->tested ? ", none found missing"
                             : "",
             error);
  } else
    snprintf(text, sizeof text, "%d %s modes by %s, eigenvalues %.4g to %.4g; %s", modes->count,
             modes->components == 1 ? "Laplacian" : "elastic", modes->report.solver,
             modes->eigenvalue[0], modes->eigenvalue[last], error);
  lua_pushstring(L, text);
  return 1;
}

static const luaL_Reg modes_methods[] = {
    {"shape", modes_shape}, {"whole", modes_whole}, {NULL, NULL}};
static const luaL_Reg modes_properties[] = {{"eigenvalues", modes_eigenvalues},
                                            {"frequencies", modes_frequencies},
                                            {"residuals", modes_residuals},
                                            {"count", modes_count},
                                            {"components", modes_components},
                                            {"rigid_count", modes_rigid_count},
                                            {"solves", modes_solves},
                                            {"recovered", modes_recovered},
                                            {"counted", modes_counted},
                                            {"tested", modes_tested},
                                            {"nodal_diameters", modes_nodal_diameters},
                                            {"mesh", modes_mesh},
                                            {"report", modes_report},
                                            {NULL, NULL}};
static const luaL_Reg modes_meta[] = {
    {"__len", modes_length}, {"__tostring", modes_tostring}, {NULL, NULL}};
const lbw_class lbw_modes_class = {"modes", modes_methods, modes_properties, modes_meta, NULL};

/* ---- systems --------------------------------------------------------------------------------- */

/* A list of forces is solved in one block. */
static int solve_list(lua_State *L, bw_system *system) {
  int64_t nodes = system->mesh->node_count, count = (int64_t)lua_rawlen(L, 2), rows;
  size_t size = 3 * (size_t)nodes * sizeof(double);
  lua_settop(L, 2);
  if (!((double)count * (double)size < 0.5 * (double)INT64_MAX))
    return lbw_error(L, "solve: forces: fewer than %I entries expected", (LUAI_UACINT)count);
  char *block = (char *)lua_newuserdatauv(L, (size_t)count * size + 1, 0); /* 3 */
  for (int64_t i = 0; i < count; i++) {
    lua_rawgeti(L, 2, i + 1);
    const double *force = lbw_to_doubles(L, 4, "force", 3, &rows);
    lbw_check_rows(L, 2, lua_pushfstring(L, "forces: entry %I", (LUAI_UACINT)i + 1), rows, nodes,
                   "node");
    memcpy(block + (size_t)i * size, force, size);
    lua_settop(L, 3);
  }
  bw_status status = bw_system_solve(lbw_enter(L), system, count, (const double *)(void *)block,
                                     (double *)(void *)block);
  int results = lbw_leave(L, status, 1);
  if (status != BW_OK)
    return results;
  lua_createtable(L, (int)count, 0); /* 4 */
  for (int64_t i = 0; i < count; i++) {
    memcpy(lbw_push_array(L, BW_F64, nodes, 3)->data, block + (size_t)i * size, size);
    lua_rawseti(L, 4, i + 1);
  }
  return 1;
}

/* A table of arrays, and not one array as a table of rows. */
static bool is_list_of_arrays(lua_State *L, int index) {
  bool list = lua_istable(L, index) && lua_rawgeti(L, index, 1) == LUA_TUSERDATA;
  lua_settop(L, index);
  return list;
}

/* system:solve(force): displacement, both a row of three for every node; or lists of them */
static int system_solve(lua_State *L) {
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  if (is_list_of_arrays(L, 2))
    return solve_list(L, system);
  int64_t rows;
  double *force = lbw_to_doubles(L, 2, "force", 3, &rows);
  lbw_check_rows(L, 2, "force", rows, system->mesh->node_count, "node");
  double *out = (double *)lbw_push_array(L, BW_F64, rows, 3)->data;
  return lbw_leave(L, bw_system_solve(lbw_enter(L), system, 1, force, out), 1);
}

static int system_times(lua_State *L) {
  push_times(L, &((const bw_system *)lbw_check(L, 1, &lbw_system_class))->times);
  return 1;
}

static int system_unknown_count(lua_State *L) {
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  lua_pushinteger(L, system->dof_map->unknown_count);
  return 1;
}

static int system_rigid_mode_count(lua_State *L) {
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  lua_pushinteger(L, system->dof_map->rigid_mode_count);
  return 1;
}

/* How the equations have been solved so far; nil where they are of an edit session. */
static int system_report(lua_State *L) {
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  if (!lbw_has_report(&system->report)) {
    lua_pushnil(L);
    return 1;
  }
  lbw_push_report(L, &system->report);
  if (system->external_report)
    add_external(L, system->external_report);
  return 1;
}

static int system_tostring(lua_State *L) {
  const bw_system *system = (const bw_system *)lbw_check(L, 1, &lbw_system_class);
  char text[200];
  int written =
      snprintf(text, sizeof text, "system of %d unknowns, %d unconstrained rigid-body modes, ",
               (int)system->dof_map->unknown_count, (int)system->dof_map->rigid_mode_count);
  if (system->external_report)
    snprintf(text + written, sizeof text - (size_t)written, "solved by %s (%s)",
             system->report.solver, system->report.backend);
  else if (system->iterative)
    snprintf(text + written, sizeof text - (size_t)written, "solved by %s%s%s",
             system->report.solver, system->report.preconditioner[0] ? " with " : "",
             system->report.preconditioner);
  else
    snprintf(text + written, sizeof text - (size_t)written, "factor of %s entries",
             lbw_quantity((double)system->times.factor_entries, "").text);
  lua_pushstring(L, text);
  return 1;
}

/* system:modes{count, tolerance, sturm, seed, solver} */
static int system_modes(lua_State *L) {
  static const lbw_option list[] = {{"count", LBW_INT, offsetof(bw_modes_options, count)},
                                    {"tolerance", LBW_REAL, offsetof(bw_modes_options, tolerance)},
                                    {"sturm", LBW_BOOLEAN, offsetof(bw_modes_options, sturm)},
                                    {"seed", LBW_SEED, offsetof(bw_modes_options, seed)},
                                    {"solver", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  bw_system *system = (bw_system *)lbw_check(L, 1, &lbw_system_class);
  bw_modes_options options;
  bw_modes_options_default(&options);
  lua_settop(L, 2);
  lbw_options(L, 2, "modes", list, &options);
  options.solver = lbw_eigensolver_option(L, 2, "modes");
  if (options.solver && options.solver->options.kind == BW_EIGENSOLVER_SLEPC &&
      !system->external_report)
    return lbw_error(L, "modes: eigensolver slepc takes a model and not its equations: call "
                        "part:modes {solver = ...}");
  lbw_box *box = lbw_box_new(L, &lbw_modes_class);
  bw_modes *modes = NULL;
  bw_status status = bw_modes_elastic(lbw_enter(L), system, &options, &modes);
  return lbw_leave_object(L, box, modes, status);
}

static const luaL_Reg system_methods[] = {
    {"solve", system_solve}, {"modes", system_modes}, {NULL, NULL}};
static const luaL_Reg system_properties[] = {{"times", system_times},
                                             {"report", system_report},
                                             {"unknown_count", system_unknown_count},
                                             {"rigid_mode_count", system_rigid_mode_count},
                                             {NULL, NULL}};
static const luaL_Reg system_meta[] = {{"__tostring", system_tostring}, {NULL, NULL}};
const lbw_class lbw_system_class = {"system", system_methods, system_properties, system_meta, NULL};

/* ---- stress of a displacement ---------------------------------------------------------------- */

static const bw_mesh *mesh_and_displacement(lua_State *L, const double **displacement) {
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  lbw_check(L, 2, &lbw_material_class);
  int64_t rows;
  *displacement = lbw_to_doubles(L, 3, "displacement", 3, &rows);
  lbw_check_rows(L, 3, "displacement", rows, mesh->node_count, "node");
  return mesh;
}

/* element_stress(mesh, material, displacement) */
static int core_element_stress(lua_State *L) {
  const double *displacement;
  const bw_mesh *mesh = mesh_and_displacement(L, &displacement);
  const bw_material *material = (const bw_material *)lbw_check(L, 2, &lbw_material_class);
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->element_count, 6)->data;
  return lbw_leave(L, bw_element_stress(lbw_enter(L), mesh, material, displacement, out), 1);
}

/* nodal_stress(mesh, material, displacement) */
static int core_nodal_stress(lua_State *L) {
  const double *displacement;
  const bw_mesh *mesh = mesh_and_displacement(L, &displacement);
  const bw_material *material = (const bw_material *)lbw_check(L, 2, &lbw_material_class);
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->node_count, 6)->data;
  return lbw_leave(L, bw_nodal_stress(lbw_enter(L), mesh, material, displacement, out), 1);
}

/* surface_stress(mesh, material, displacement, force or nil): a row for every corner of every facet
 */
static int core_surface_stress(lua_State *L) {
  const double *displacement, *force = NULL;
  lua_settop(L, 4);
  const bw_mesh *mesh = mesh_and_displacement(L, &displacement);
  if (!lua_isnil(L, 4)) {
    int64_t rows;
    force = lbw_to_doubles(L, 4, "force", 3, &rows);
    lbw_check_rows(L, 4, "force", rows, mesh->node_count, "node");
  }
  const bw_material *material = (const bw_material *)lbw_check(L, 2, &lbw_material_class);
  double *out = (double *)lbw_push_array(L, BW_F64, 3 * (int64_t)mesh->facet_count, 6)->data;
  return lbw_leave(L, bw_surface_stress(lbw_enter(L), mesh, material, displacement, force, out), 1);
}

/* Means with the supports of argument 4: a system, a static solution, a model, or nil. */
static int push_means(lua_State *L, const bw_mesh *mesh, double radius, int64_t columns,
                      const double *value) {
  const bw_system *system = (const bw_system *)lbw_test(L, 4, &lbw_system_class);
  const bw_static *solution = (const bw_static *)lbw_test(L, 4, &lbw_static_class);
  const bw_model *model = solution ? solution->model : NULL;
  if (!system && !solution && !lua_isnil(L, 4))
    model = (const bw_model *)lbw_check(L, 4, &lbw_model_class);
  double *out = (double *)lbw_push_array(L, BW_F64, mesh->node_count, columns)->data;
  bw_context *context = lbw_enter(L);
  bw_dof_map *own = NULL;
  bw_status status = model ? bw_dof_map_create(context, model, &own) : BW_OK;
  if (status == BW_OK)
    status = bw_surface_mean(context, mesh, system ? system->dof_map : own, radius, (int)columns,
                             value, out);
  bw_release(own);
  return lbw_leave(L, status, 1);
}

/* surface_mean(mesh, values, radius, system or static or model or nil) */
static int core_surface_mean(lua_State *L) {
  lua_settop(L, 4);
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  const bw_array *array = (const bw_array *)lbw_check(L, 2, &lbw_array_class);
  int64_t rows, columns = array->columns;
  const double *value = lbw_to_doubles(L, 2, "values", (int)columns, &rows);
  lbw_check_rows(L, 2, "values", rows, 3 * (int64_t)mesh->facet_count, "corner of a facet");
  return push_means(L, mesh, lbw_number_or(L, 3, 0), columns, value);
}

/* surface_means(mesh, fields, radius, as above): those of a list of arrays with as many columns,
 * side by side. Patches are looked for once. */
static int core_surface_means(lua_State *L) {
  lua_settop(L, 4);
  const bw_mesh *mesh = (const bw_mesh *)lbw_check(L, 1, &lbw_mesh_class);
  lbw_argument_check(L, lua_istable(L, 2) && lua_rawlen(L, 2) > 0 && lua_rawlen(L, 2) < 10000, 2,
                     "fields: a list of arrays expected");
  int64_t count = (int64_t)lua_rawlen(L, 2), width = 0, corners = 3 * (int64_t)mesh->facet_count;
  double radius = lbw_number_or(L, 3, 0), *side = NULL;
  for (int64_t i = 0; i < count; i++) {
    lua_rawgeti(L, 2, i + 1);
    const bw_array *array = (const bw_array *)lbw_test(L, -1, &lbw_array_class);
    lbw_argument_check(
        L,
        array && array->rows == corners && array->columns < 1000 &&
            (i == 0 || array->columns == width),
        2, "fields: arrays of three rows for every facet, of as many columns, expected");
    if (i == 0) {
      width = array->columns;
      side = (double *)lbw_push_array(L, BW_F64, corners, width * count)->data;
      lua_insert(L, 5);
    }
    for (int64_t n = 0; n < corners; n++)
      for (int64_t c = 0; c < width; c++)
        side[n * width * count + i * width + c] = bw_array_get(array, n, c);
    lua_pop(L, 1);
  }
  return push_means(L, mesh, radius, width * count, side);
}

static int rows_of(lua_State *L, row_function *function, int64_t columns) {
  int64_t rows;
  double *stress = lbw_to_doubles(L, 1, "stress", 6, &rows);
  double *out = (double *)lbw_push_array(L, BW_F64, rows, columns)->data;
  return lbw_leave(L, function(lbw_enter(L), rows, stress, out), 1);
}

static int core_von_mises(lua_State *L) {
  return rows_of(L, bw_von_mises_field, 1);
}
static int core_principal(lua_State *L) {
  return rows_of(L, principal_values, 3);
}
static int core_max_principal(lua_State *L) {
  return rows_of(L, bw_max_principal_field, 1);
}

void lbw_open_solve(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"element_stress", core_element_stress}, {"nodal_stress", core_nodal_stress},
      {"surface_stress", core_surface_stress}, {"surface_mean", core_surface_mean},
      {"surface_means", core_surface_means},   {"von_mises", core_von_mises},
      {"principal", core_principal},           {"max_principal", core_max_principal},
      {"note_error", core_note_error},         {NULL, NULL}};
  lbw_class_register(L, &lbw_static_class);
  lbw_class_register(L, &lbw_modes_class);
  lbw_class_register(L, &lbw_system_class);
  luaL_setfuncs(L, functions, 0);
  lua_pushliteral(L, LBW_ERROR_UNKNOWN);
  lua_setfield(L, -2, "error_unknown");
}
