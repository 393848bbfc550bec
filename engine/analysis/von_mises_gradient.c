/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How the von Mises stress at a node changes when corner nodes move (docs/theory/edit.md).
 *
 * J depends on the shape directly, through the mean over the elements at the node, and through u:
 *     dJ = dJ/dx . dx + lambda . (df - dK u),     K lambda = dJ/du.
 * Inside a straight element that moves by V(x) = sum_k dx_k L_k, G = grad V is constant and
 *     d(grad u) = -(grad u) G  (nodal values fixed),   d(volume) = tr(G) volume,
 * so everything is of the form A : G = sum_k dx_k . A g_k with g_k = grad L_k: one tensor A per
 * element. With tau = C (strain(u) - alpha dT 1), the true stress, the force of thermal expansion
 * is part of
 *     A = integral of (grad lambda)^T tau + (grad u)^T sigma(lambda) - (tau : grad lambda) 1.
 *
 * On a free body f - W r balances the load f by the inertia of a rigid-body motion r (model.h). J
 * knows no rigid-body motion and lambda has none (lambda^T W s = 0 for every unconstrained
 * rigid-body mode s), so that neither the change of r's six numbers counts nor that of the volume
 * in W = M/V; what is left is lambda . d(M r)/V with those numbers fixed. */
#include "analysis/gradient.h"
#include "analysis/strain.h"

#include "barwright/analysis.h"
#include "model/internal.h"

#include <math.h>
#include <string.h>

enum { BATCH = 8, ELEMENTS_PER_CHUNK = 256, NODES_PER_CHUNK = 1024 };

/* r(x) = t + w x (x - c) of a body, and its volume */
typedef struct inertia {
  double t[3], w[3], c[3], volume;
} inertia;

typedef struct gradient_data {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *u;
  const uint8_t *wanted; /* node_count: corners whose part is asked for; NULL: all */
  bwi_incidence incidence;
  bwi_rule rule;
  double at_node[10][10][4]; /* dN_a/dL_k at each node of an element */
  double *expansion;         /* node_count: alpha dT of all temperature loads, or NULL */
  double gravity[3];         /* the sum of the gravity loads */
  inertia *body;             /* component_count, or NULL where nothing is balanced by inertia */
  int count;                 /* of the batch */
  const double *lambda;      /* count x node_count x 3 */
  double *part;              /* element_count x 4 corners x count x 3 */
  double *gradient;          /* count x node_count x 3 */
} gradient_data;

/* ---- small pieces ---------------------------------------------------------------------------- */

/* grad[3 i + j] = du_i/dx_j of nodal values u at a point of a straight element. */
static void gradient_at(const bwi_element_state *s, const double (*u)[3], const double (*by_l)[4],
                        double grad[9]) {
  memset(grad, 0, 9 * sizeof *grad);
  for (int k = 0; k < 4; k++) {
    double d[3] = {0, 0, 0};
    for (int a = 0; a < s->nodes; a++)
      for (int i = 0; i < 3; i++)
        d[i] += u[a][i] * by_l[a][k];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        grad[3 * i + j] += d[i] * s->g[k][j];
  }
}

/* stress = C : (strain - expansion 1) in one element */
static void stress_of(const bw_material *material, int64_t element, const double strain[6],
                      double expansion, double stress[6]) {
  double elastic[6];
  for (int i = 0; i < 6; i++)
    elastic[i] = strain[i] - (i < 3 ? expansion : 0);
  bwi_multiply6(bw_material_elasticity(material, element), elastic, stress);
}

static double contract(const double a[9], const double b[9]) {
  double sum = 0;
  for (int i = 0; i < 9; i++)
    sum += a[i] * b[i];
  return sum;
}

static void add_identity(double a[9], double factor) {
  a[0] += factor;
  a[4] += factor;
  a[8] += factor;
}

/* out += A g */
static void add_product(const double a[9], const double g[3], double out[3]) {
  for (int i = 0; i < 3; i++)
    out[i] += bw_dot(a + 3 * i, g);
}

/* Mean of shape function a over a straight element. */
static double shape_mean(int order, int a) {
  return order == 1 ? 0.25 : a < 4 ? -0.05 : 0.2;
}

/* Mean of shape function a times L_k. */
static double shape_moment(int order, int a, int k) {
  if (order == 1)
    return (a == k ? 2 : 1) / 20.;
  if (a < 4)
    return (a == k ? 0 : -1) / 60.;
  return (bw_tet_edge[a - 4][0] == k || bw_tet_edge[a - 4][1] == k ? 2 : 1) / 30.;
}

/* ---- the stress at a node -------------------------------------------------------------------- */

/* What J = von Mises at a node is made of: the slopes dJ/dsigma (of shears twice), so that with
 * S = C : dJ/dsigma of each element around it dJ = mean of S : d(grad u) where volumes stay. */
typedef struct nodal_state {
  double von_mises, slope[6];
  double mean;   /* slope . mean stress */
  double volume; /* of the elements around */
} nodal_state;

static void nodal_state_of(const gradient_data *d, int32_t node, nodal_state *out) {
  double stress[6] = {0}, expansion = d->expansion ? d->expansion[node] : 0;
  memset(out, 0, sizeof *out);
  for (int64_t k = d->incidence.start[node]; k < d->incidence.start[node + 1]; k++) {
    int64_t e = d->incidence.element[k];
    bwi_element_state state;
    double grad[9], strain[6], own[6];
    bwi_element_state_load(d->mesh, d->material, d->u, e, &state);
    gradient_at(&state, (const double(*)[3])state.u, d->at_node[d->incidence.local[k]], grad);
    bwi_strain_of(grad, strain);
    stress_of(d->material, e, strain, expansion, own);
    out->volume += state.volume;
    for (int i = 0; i < 6; i++)
      stress[i] += state.volume * own[i];
  }
  for (int i = 0; i < 6; i++)
    stress[i] /= out->volume;
  double j = out->von_mises = bw_von_mises(stress);
  double trace = stress[0] + stress[1] + stress[2];
  for (int i = 0; i < 6 && j > 0; i++) /* a corner of the cone at J = 0: zero there */
    out->slope[i] = (i < 3 ? 3 * stress[i] - trace : 6 * stress[i]) / (2 * j);
  out->mean = bwi_dot6(out->slope, stress);
}

/* right += dJ/du where `right` is given, gradient += dJ/dx at fixed u where `gradient` is. */
static void nodal_derivative(const gradient_data *d, int32_t node, const nodal_state *j,
                             double *right, double *gradient) {
  for (int64_t k = d->incidence.start[node]; k < d->incidence.start[node + 1]; k++) {
    int64_t e = d->incidence.element[k];
    const int32_t *nodes = d->mesh->element + e * d->mesh->nodes_per_element;
    const double(*by_l)[4] = d->at_node[d->incidence.local[k]];
    bwi_element_state state;
    bwi_element_state_load(d->mesh, d->material, d->u, e, &state);
    double fraction = state.volume / j->volume, conjugate[6], s[9];
    bwi_multiply6(bw_material_elasticity(d->material, e), j->slope, conjugate);
    bwi_full_tensor(conjugate, s);
    if (right) {
      double push[4][3] = {{0}}; /* share S g_k */
      for (int l = 0; l < 4; l++) {
        add_product(s, state.g[l], push[l]);
        for (int c = 0; c < 3; c++)
          push[l][c] *= fraction;
      }
      for (int a = 0; a < state.nodes; a++)
        for (int l = 0; l < 4; l++)
          for (int c = 0; c < 3; c++)
            right[3 * (int64_t)nodes[a] + c] += by_l[a][l] * push[l][c];
    }
    if (gradient) {
      double grad[9], strain[6], stress[6], a[9] = {0};
      gradient_at(&state, (const double(*)[3])state.u, by_l, grad);
      bwi_strain_of(grad, strain);
      stress_of(d->material, e, strain, d->expansion ? d->expansion[node] : 0, stress);
      bwi_add_transposed_product(a, -fraction, grad, s);
      add_identity(a, fraction * (bwi_dot6(j->slope, stress) - j->mean));
      for (int l = 0; l < 4; l++)
        add_product(a, state.g[l], gradient + 3 * (int64_t)nodes[l]);
    }
  }
}

/* ---- the pass over the elements -------------------------------------------------------------- */

/* corner[k] -= d(lambda . M r / V) of one element by its corners */
static void inertia_part(const inertia *r, const bwi_element_state *s, const double (*x)[3],
                         const double (*lambda)[3], double (*corner)[3]) {
  double turned[10][3], value = 0;
  for (int a = 0; a < s->nodes; a++)
    bw_cross(lambda[a], r->w, turned[a]); /* lambda . (w x y) = y . (lambda x w) */
  for (int k = 0; k < 4; k++) {
    double by_position[3] = {0, 0, 0};
    for (int a = 0; a < s->nodes; a++)
      for (int c = 0; c < 3; c++)
        by_position[c] += shape_moment(s->order, a, k) * turned[a][c];
    for (int c = 0; c < 3; c++) {
      value += by_position[c] * (x[k][c] - r->c[c]);
      corner[k][c] -= s->volume / r->volume * by_position[c];
    }
  }
  for (int a = 0; a < s->nodes; a++)
    value += shape_mean(s->order, a) * bw_dot(lambda[a], r->t);
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 3; c++)
      corner[k][c] -= s->volume / r->volume * value * s->g[k][c];
}

/* Whether one of the corners of an element is asked for. */
static bool asked_for(const gradient_data *d, const int32_t *node) {
  return !d->wanted || d->wanted[node[0]] || d->wanted[node[1]] || d->wanted[node[2]] ||
         d->wanted[node[3]];
}

static bw_status element_pass(void *data, int64_t begin, int64_t end, int worker) {
  const gradient_data *d = (const gradient_data *)data;
  size_t size = 3 * (size_t)d->mesh->node_count;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    const int32_t *node = d->mesh->element + e * d->mesh->nodes_per_element;
    if (!asked_for(d, node))
      continue;
    bwi_element_state state;
    double grad_u[BW_QUADRATURE_POINTS][9], tau[BW_QUADRATURE_POINTS][9], strain[6], stress[6];
    bwi_element_state_load(d->mesh, d->material, d->u, e, &state);
    for (int q = 0; q < d->rule.points; q++) {
      gradient_at(&state, (const double(*)[3])state.u, d->rule.by_l[q], grad_u[q]);
      bwi_strain_of(grad_u[q], strain);
      double expansion = 0;
      for (int a = 0; d->expansion && a < state.nodes; a++)
        expansion += d->rule.value[q][a] * d->expansion[node[a]];
      stress_of(d->material, e, strain, expansion, stress);
      bwi_full_tensor(stress, tau[q]);
    }
    for (int r = 0; r < d->count; r++) {
      double lambda[10][3], a[9] = {0}, corner[4][3] = {{0}};
      for (int i = 0; i < state.nodes; i++)
        memcpy(lambda[i], d->lambda + (size_t)r * size + 3 * (size_t)node[i], sizeof lambda[i]);
      for (int q = 0; q < d->rule.points; q++) {
        double grad[9], sigma[9], volume = d->rule.weight[q] * state.volume;
        gradient_at(&state, (const double(*)[3])lambda, d->rule.by_l[q], grad);
        bwi_strain_of(grad, strain);
        stress_of(d->material, e, strain, 0, stress);
        bwi_full_tensor(stress, sigma);
        bwi_add_transposed_product(a, volume, grad, tau[q]);
        bwi_add_transposed_product(a, volume, grad_u[q], sigma);
        add_identity(a, -volume * contract(tau[q], grad));
      }
      double mass = bw_material_of(d->material, e)->density * state.volume;
      for (int i = 0; i < state.nodes; i++)
        add_identity(a, mass * shape_mean(state.order, i) * bw_dot(d->gravity, lambda[i]));
      for (int k = 0; k < 4; k++)
        add_product(a, state.g[k], corner[k]);
      if (d->body) {
        double x[4][3];
        for (int k = 0; k < 4; k++)
          memcpy(x[k], d->mesh->node + 3 * (size_t)node[k], sizeof x[k]);
        inertia_part(&d->body[d->mesh->component[node[0]]], &state, (const double(*)[3])x,
                     (const double(*)[3])lambda, corner);
      }
      for (int k = 0; k < 4; k++)
        memcpy(d->part + 3 * ((4 * e + k) * d->count + r), corner[k], sizeof corner[k]);
    }
  }
  return BW_OK;
}

static bw_status gather_pass(void *data, int64_t begin, int64_t end, int worker) {
  const gradient_data *d = (const gradient_data *)data;
  size_t size = 3 * (size_t)d->mesh->node_count;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double sum[3 * BATCH] = {0};
    for (int64_t k = d->incidence.start[i]; k < d->incidence.start[i + 1]; k++) {
      if (d->incidence.local[k] >= 4 || (d->wanted && !d->wanted[i]))
        continue;
      int64_t place = 4 * (int64_t)d->incidence.element[k] + d->incidence.local[k];
      for (int c = 0; c < 3 * d->count; c++)
        sum[c] += d->part[3 * place * d->count + c];
    }
    for (int r = 0; r < d->count; r++)
      memcpy(d->gradient + (size_t)r * size + 3 * (size_t)i, sum + 3 * r, 3 * sizeof *sum);
  }
  return BW_OK;
}

/* ---- loads and supports ---------------------------------------------------------------------- */

static bw_status take_loads(bw_context *context, const bw_model *model, gradient_data *d) {
  for (int l = 0; l < model->load_count; l++) {
    const bw_load *load = &model->load[l];
    if (load->kind == BW_LOAD_GRAVITY)
      for (int k = 0; k < 3; k++)
        d->gravity[k] += load->vector[k];
    if (load->kind != BW_LOAD_TEMPERATURE)
      continue;
    if (!d->expansion)
      d->expansion = BW_NEW0(context, double, model->mesh->node_count);
    if (!d->expansion)
      return BW_MEMORY;
    for (int32_t i = 0; i < model->mesh->node_count; i++)
      d->expansion[i] += bwi_expansion(model, load, 0) * bw_array_get(load->nodal, i, 0);
  }
  return BW_OK;
}

/* The rigid-body motion whose inertia balances the load, body by body. */
static bw_status take_inertia(bw_context *context, const bw_model *model, const bw_dof_map *dof_map,
                              gradient_data *d) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = model->mesh;
  double *force = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
  double *part = BW_NEW(context, double, dof_map->rigid_mode_count);
  d->body = BW_NEW0(context, inertia, mesh->component_count);
  BW_TRY_MEMORY(force && part && d->body);
  BW_TRY(bw_model_force_vector(context, model, force));
  bw_rigid_modes_dot(dof_map, force, part);
  for (int32_t b = 0; b < mesh->component_count; b++) {
    inertia *body = &d->body[b];
    const double *centre = dof_map->body_centre + 3 * (size_t)b;
    double length = cbrt(dof_map->body_volume[b]), size = 0;
    int motions = dof_map->rigid_mode_start[b + 1] - dof_map->rigid_mode_start[b];
    memcpy(body->c, centre, sizeof body->c);
    body->volume = dof_map->body_volume[b];
    for (int m = dof_map->rigid_mode_start[b]; m < dof_map->rigid_mode_start[b + 1]; m++) {
      const bw_rigid_mode *motion = &dof_map->rigid_mode[m];
      double at_centre[3];
      bwi_motion_at(motion, centre, at_centre);
      for (int k = 0; k < 3; k++) {
        body->t[k] += part[m] * at_centre[k];
        body->w[k] += part[m] * motion->rotation[k];
      }
    }
    if (motions == 0 || motions == 6 || bw_norm(body->w) == 0)
      continue;
    for (int32_t j = dof_map->body_start[b]; j < dof_map->body_start[b + 1]; j++)
      size += bw_norm(force + 3 * (size_t)dof_map->body_node[j]);
    if (length * bw_norm(body->w) > 1e-6 * size)
      BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                     "body %d is partly constrained and its load acts on a rigid-body mode (%s): "
                     "shape gradients of inertia relief are implemented for bodies without "
                     "supports only. Balance the load, or constrain the body",
                     b + 1, dof_map->rigid_mode[dof_map->rigid_mode_start[b]].text));
    memset(body->w, 0, sizeof body->w);
  }
done:
  bw_free(force);
  bw_free(part);
  return status;
}

/* BW_UNSUPPORTED, with a sentence, for supports whose directions turn with the surface. */
static bw_status gradient_supports(bw_context *context, const bw_model *model) {
  for (int s = 0; s < model->support_count; s++) {
    const bw_support *support = &model->support[s];
    if (!support->slide || bw_norm(support->normal) > 0)
      continue;
    bw_fail(context, BW_UNSUPPORTED,
            "support %d slides along the surface normals, which change with the shape: their "
            "stress gradient is not implemented. Give the sliding support a direction",
            s + 1);
    bw_detail_number(context, "support", s + 1);
    return BW_UNSUPPORTED;
  }
  return BW_OK;
}

static bw_status check_input(bw_context *context, const bw_model *model, const bw_dof_map *dof_map,
                             const double *displacement, int64_t count, const int32_t *node) {
  const bw_mesh *mesh = model->mesh;
  bw_status status;
  int32_t *curved = NULL;
  int64_t curved_count = 0;
  BW_TRY(bwi_check_stress_input(context, mesh, model->material, displacement, "a stress gradient"));
  if (dof_map->mesh->node_count != mesh->node_count)
    BW_TRY(bw_fail(context, BW_INVALID,
                   "the DOF map is of a mesh of %d nodes, the model's mesh has %d",
                   dof_map->mesh->node_count, mesh->node_count));
  for (int64_t i = 0; i < count; i++)
    if (node[i] < 0 || node[i] >= mesh->node_count)
      BW_TRY(bw_fail(context, BW_INVALID, "node %d of a stress gradient: the mesh has %d nodes",
                     node[i] + 1, mesh->node_count));
  if (bw_material_mixed(model->material))
    BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                   "a stress gradient is of a body of one material; the model has several (%s)",
                   model->material->name));
  if (model->material->formulation == BW_B_BAR)
    BW_TRY(bw_fail(context, BW_UNSUPPORTED,
                   "a stress gradient is of the standard formulation; the model's is B-bar"));
  BW_TRY(gradient_supports(context, model));
  BW_TRY(bwi_find_curved(context, mesh, &curved, &curved_count));
  for (int32_t e = 0; curved_count > 0 && e < mesh->element_count; e++)
    if (curved[e] >= 0) {
      status = bw_fail(context, BW_INVALID,
                       "element %d has curved edges: a stress gradient needs straight ones (%lld "
                       "of %d elements are curved)",
                       e + 1, (long long)curved_count, mesh->element_count);
      bw_detail_number(context, "element", e + 1);
      goto done;
    }
done:
  bw_free(curved);
  return status;
}

static bool on_facets(bw_load_kind kind) {
  return kind == BW_LOAD_PRESSURE || kind == BW_LOAD_TRACTION || kind == BW_LOAD_FORCE ||
         kind == BW_LOAD_TORQUE;
}

/* ---- all of it ------------------------------------------------------------------------------- */

bw_status bw_von_mises_gradient(bw_context *context, const bw_model *model,
                                const bw_dof_map *dof_map, const double *displacement,
                                bw_solve_function *solve, void *data, int64_t count,
                                const int32_t *node, const uint8_t *wanted, double *von_mises,
                                double *gradient) {
  const bw_mesh *mesh = model->mesh;
  size_t size = 3 * (size_t)mesh->node_count;
  bw_status status;
  double *lambda = NULL;
  gradient_data d = {
      .mesh = mesh, .material = model->material, .u = displacement, .wanted = wanted};
  nodal_state *state = NULL;
  BW_TRY(check_input(context, model, dof_map, displacement, count, node));
  BW_TRY(take_loads(context, model, &d));
  if (dof_map->rigid_mode_count > 0)
    BW_TRY(take_inertia(context, model, dof_map, &d));
  BW_TRY(bwi_incidence_create(context, mesh, &d.incidence));
  /* products of two gradients; with a temperature's shape functions between them one more degree */
  bwi_rule_make(mesh->order, mesh->order == 1 ? 1 : d.expansion ? 3 : 2, &d.rule);
  for (int a = 0; a < mesh->nodes_per_element; a++) {
    double l[4];
    bwi_node_barycentric(a, l);
    bw_tet_shape_gradient(mesh->order, l, d.at_node[a]);
  }
  size_t max = (size_t)(count < BATCH ? count : BATCH);
  state = BW_NEW(context, nodal_state, max);
  lambda = BW_NEW(context, double, max *size);
  d.part = BW_NEW(context, double, max * 12 * (size_t)mesh->element_count);
  BW_TRY_MEMORY(state && lambda && d.part);
  d.lambda = lambda;
  for (int64_t first = 0; first < count; first += BATCH) {
    BW_TRY(bw_check_cancel(context));
    d.count = (int)(count - first < BATCH ? count - first : BATCH);
    d.gradient = gradient + (size_t)first * size;
    memset(d.gradient, 0, (size_t)d.count * size * sizeof *gradient); /* right-hand sides first */
    for (int r = 0; r < d.count; r++) {
      nodal_state_of(&d, node[first + r], &state[r]);
      von_mises[first + r] = state[r].von_mises;
      nodal_derivative(&d, node[first + r], &state[r], d.gradient + (size_t)r * size, NULL);
    }
    BW_TRY(solve(data, context, d.count, d.gradient, lambda));
    BW_TRY(bw_parallel(context, mesh->element_count, ELEMENTS_PER_CHUNK, element_pass, &d));
    BW_TRY(bw_parallel(context, mesh->node_count, NODES_PER_CHUNK, gather_pass, &d));
    for (int r = 0; r < d.count; r++) {
      double *out = d.gradient + (size_t)r * size;
      nodal_derivative(&d, node[first + r], &state[r], NULL, out);
      for (int l = 0; l < model->load_count; l++)
        if (on_facets(model->load[l].kind))
          BW_TRY(bwi_gradient_surface_load(context, model, &model->load[l],
                                           lambda + (size_t)r * size, out));
    }
  }
done:
  bwi_incidence_clear(&d.incidence);
  bw_free(d.expansion);
  bw_free(d.body);
  bw_free(d.part);
  bw_free(state);
  bw_free(lambda);
  return status;
}
