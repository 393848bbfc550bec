/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a solved contact says: pressures, forces, gaps, undetermined motions, and warnings. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"
#include "linear/blas.h"
#include "model/internal.h"
#include "statics/internal.h"

static const double undecided = 1e-9; /* of the stiffest motion */
static const double large_rotation = 0.05, largest_rotation = 0.2;
static const double large_displacement = 0.1; /* of the longest side */
static const double other_pressure = 0.1;     /* of the largest: what round faces may change */
static const double coarse = 0.25; /* of the elastic displacement: penetration that is too much */

static void contact_destroy(void *object) {
  bw_contact *contact = object;
  bwi_contact_pairs_release(contact->pair_count, contact->pair);
  bw_release(contact->model);
  bw_release(contact->solution);
  bw_free(contact->state);
  bw_release(contact->start);
  bw_free(contact->pressure);
  bw_free(contact->traction);
  bw_free(contact->slip);
  bw_free(contact->corner_slip);
  bw_free(contact->work);
  bw_free(contact->status);
  bw_free(contact->gap);
  bw_free(contact->free_text);
  bw_free(contact->notes);
  bw_free(contact);
}

static size_t contact_bytes(const void *object) {
  const bw_contact *contact = object;
  return sizeof *contact +
         (contact->has_friction ? 8 : 2) * (size_t)contact->model->mesh->node_count *
             sizeof(double) +
         bw_bytes(contact->solution) + bw_bytes(contact->start) +
         (size_t)contact->pair_count * (sizeof *contact->pair + sizeof *contact->state);
}

static const bw_kind contact_kind = {"contact", contact_destroy, contact_bytes};

/* The static solution of the model with the forces of contact, at the place that contact gives. */
static bw_status take_solution(bw_context *context, bwi_contact_problem *c, bw_contact *out) {
  bw_status status = BW_OK;
  bw_model *loaded = NULL;
  bw_array *force = NULL;
  bool closed = false;
  for (int i = 0; i < c->count; i++)
    closed = closed || c->p[c->rows.first[i]] > 0;
  BW_TRY(bw_model_moved(context, c->model, c->model->mesh, &loaded));
  BW_TRY(bw_array_create(context, BW_F64, c->model->mesh->node_count, 3, &force));
  bwi_contact_rows_force(&c->rows, c->p, force->data);
  if (closed)
    BW_TRY(bw_model_nodal_forces(context, loaded, force));
  BW_TRY(bwi_contact_bodies_static(context, c, loaded, &out->solution));
  out->solution->in_contact = closed;
  memcpy(c->now, out->solution->displacement, (size_t)bwi_contact_size(c) * sizeof *c->now);
done:
  bw_release(force);
  bw_release(loaded);
  return status;
}

/* The larger where pairs meet. `own` (node_count): of one pair. */
static void take_pressure(const bwi_contact_problem *c, double *own, bw_contact *out) {
  const bw_mesh *mesh = c->model->mesh;
  for (int pair = 0; pair < out->pair_count; pair++) {
    const bw_selection *on = out->pair[pair].on;
    memset(own, 0, (size_t)mesh->node_count * sizeof *own);
    for (int i = 0; i < c->count; i++)
      if (c->rows.of[i] == pair)
        own[c->rows.node[i]] = c->p[c->rows.first[i]];
    for (int32_t f = 0; f < on->facet_count; f++) {
      const int32_t *node = mesh->facet + (int64_t)on->facet[f] * mesh->nodes_per_facet;
      for (int k = 0; k < mesh->nodes_per_facet; k++) {
        double p = k < 3 ? own[node[k]] : (own[node[k - 3]] + own[node[(k - 2) % 3]]) / 2;
        out->pressure[node[k]] = fmax(out->pressure[node[k]], p);
      }
    }
  }
}

/* Traction, slip and status of the corners; mid-edge nodes have the traction's mean. Where pairs
 * meet, that of the last which touches. */
static void take_friction(bwi_contact_problem *c, bw_contact *out) {
  const bw_mesh *mesh = c->model->mesh;
  for (int i = 0; i < c->count; i++) {
    int32_t node = c->rows.node[i], r = c->rows.first[i];
    double *traction = out->traction + 3 * (int64_t)node;
    if (!(c->p[r] > 0))
      continue;
    out->status[node] = c->active[c->place[i]] == BWI_STICKS ? BW_CONTACT_STICKS : BW_CONTACT_SLIPS;
    memcpy(out->slip + 3 * (int64_t)node, c->slip + 3 * (int64_t)i, 3 * sizeof *c->slip);
    memset(traction, 0, 3 * sizeof *traction);
    for (int k = 1; k < c->rows.first[i + 1] - r; k++)
      for (int l = 0; l < 3; l++)
        traction[l] += c->p[r + k] * c->rows.tangent[6 * (int64_t)i + 3 * (k - 1) + l];
  }
  for (int pair = 0; pair < out->pair_count && mesh->nodes_per_facet > 3; pair++)
    for (int32_t f = 0; f < out->pair[pair].on->facet_count; f++) {
      const int32_t *node =
          mesh->facet + (int64_t)out->pair[pair].on->facet[f] * mesh->nodes_per_facet;
      for (int k = 3; k < 6; k++)
        for (int l = 0; l < 3; l++)
          out->traction[3 * (int64_t)node[k] + l] =
              (out->traction[3 * (int64_t)node[k - 3] + l] +
               out->traction[3 * (int64_t)node[(k - 2) % 3] + l]) /
              2;
    }
  out->work = c->work;
  out->corner_slip = c->slip;
  c->work = c->slip = NULL;
}

/* The smaller gap; what is rounding is 0. */
static void take_gap(const bwi_contact_problem *c, double gap, double *smallest) {
  *smallest = fmin(*smallest, fabs(gap) <= c->rounded ? 0 : gap);
}

static void take_gaps(const bwi_contact_problem *c, bw_contact *out) {
  const bw_mesh *mesh = c->model->mesh;
  for (int32_t i = 0; i < mesh->node_count; i++)
    out->gap[i] = INFINITY;
  for (int pair = 0; pair < out->pair_count; pair++) {
    const bw_selection *on = out->pair[pair].on;
    out->state[pair].gap = INFINITY;
    for (int k = 0; k < c->count && !out->pair[pair].with; k++)
      if (c->rows.of[k] == pair && c->rows.area[k] > 0) {
        int32_t r = c->rows.first[k];
        double gap = c->p[r] > 0 ? 0 : c->w[r] / c->rows.area[k];
        take_gap(c, gap, &out->gap[c->rows.node[k]]);
        take_gap(c, gap, &out->state[pair].gap);
      }
    if (!out->pair[pair].with)
      continue;
    for (int32_t f = 0; f < on->facet_count * mesh->nodes_per_facet; f++) {
      int32_t facet = on->facet[f / mesh->nodes_per_facet];
      int32_t i = mesh->facet[(int64_t)facet * mesh->nodes_per_facet + f % mesh->nodes_per_facet];
      double x[3], normal[3];
      for (int k = 0; k < 3; k++)
        x[k] = mesh->node[3 * (int64_t)i + k] + c->now[3 * (int64_t)i + k];
      double gap = bwi_rigid_gap(out->pair[pair].with, x, normal) - out->pair[pair].interference;
      if (out->pair[pair].smooth && f % mesh->nodes_per_facet >= 3)
        gap -= c->rows.height[3 * (int64_t)facet + f % mesh->nodes_per_facet - 3];
      take_gap(c, gap, &out->gap[i]);
      take_gap(c, gap, &out->state[pair].gap);
    }
  }
}

static void take_states(const bwi_contact_problem *c, double *force, bw_contact *out) {
  const bw_mesh *mesh = c->model->mesh;
  for (int pair = 0; pair < out->pair_count; pair++) {
    bw_contact_state *state = &out->state[pair];
    state->node = -1;
    for (int i = 0; i < c->count; i++) {
      if (c->rows.of[i] != pair)
        continue;
      double p = c->p[c->rows.first[i]];
      state->candidates++;
      state->active += p > 0;
      state->area += p > 0 ? c->rows.area[i] : 0;
      if (p > state->pressure) {
        state->pressure = p;
        state->node = c->rows.node[i];
      }
      if (out->pair[pair].friction > 0 && p > 0) {
        state->stick_area += c->active[c->place[i]] == BWI_STICKS ? c->rows.area[i] : 0;
        state->slip = fmax(state->slip, bw_norm(c->slip + 3 * (int64_t)i));
      }
    }
    state->work = c->work ? c->work[pair] : 0;
    if (out->pair[pair].friction > 0) {
      bwi_contact_rows_pair_force(&c->rows, pair, true, c->p, force);
      for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
        state->friction[i % 3] += force[i];
    }
    if (state->active > 0)
      state->gap = 0;
    for (int64_t k = 0; k < c->rows.point_count; k++)
      if (c->rows.point[k].pair == pair)
        state->penetration = fmax(state->penetration, -c->rows.point[k].gap);
    if (state->active == 0 && state->gap < 0) /* at nodes of a rigid surface's facets */
      state->penetration = fmax(state->penetration, -state->gap);
    if (state->penetration < bwi_contact_small_gap(c))
      state->penetration = 0;
    bwi_contact_rows_pair_force(&c->rows, pair, false, c->p, force);
    for (int64_t i = 0; i < mesh->node_count; i++) {
      double moment[3];
      bw_cross(mesh->node + 3 * i, force + 3 * i, moment);
      for (int k = 0; k < 3; k++) {
        state->force[k] += force[3 * i + k];
        state->moment[k] += moment[k];
      }
    }
  }
}

/* The motions in the null space of H. */
static bw_status take_undetermined(bw_context *context, const bwi_contact_problem *c,
                                   bw_contact *out) {
  bw_status status = BW_OK;
  int m = c->motions, length = 8 * m + 8, info = 0, one = 1;
  double *value = BW_NEW(context, double, m), *work = BW_NEW(context, double, length), none = 0;
  out->free_text = BW_NEW0(context, char, (size_t)m * 300 + 1);
  BW_TRY_MEMORY(value && work && out->free_text);
  if (m > 0) { /* H^T by columns = U diag(value) V^T: U takes its place */
    bwi_blas_enter();
    dgesvd_("O", "N", &m, &m, c->h, &m, value, &none, &one, &none, &one, work, &length, &info);
    bwi_blas_leave();
    if (info != 0)
      BW_TRY(bw_fail(context, BW_INTERNAL, "dgesvd failed on %d motions (%d)", m, info));
  }
  for (int k = m - 1; k >= 0 && value[k] <= undecided * value[0]; k--) {
    char *end = out->free_text + strlen(out->free_text);
    if (out->free_count++)
      *end++ = '\n';
    BW_TRY(bwi_contact_motions_describe(context, c, c->h + (size_t)k * (size_t)m, end, 299));
  }
done:
  bw_free(value);
  bw_free(work);
  return status;
}

/* (rad) The rotation of a body, by least squares over its nodes. */
static double body_rotation(const bwi_contact_problem *c, int32_t body) {
  const bw_dof_map *dof_map = c->system->dof_map;
  const double *centre = dof_map->body_centre + 3 * (int64_t)body;
  int32_t begin = dof_map->body_start[body], end = dof_map->body_start[body + 1];
  double mean[3] = {0}, inertia[9] = {0}, rotation[3] = {0}, middle[3] = {0};
  for (int32_t n = begin; n < end; n++)
    for (int k = 0; k < 3; k++) {
      int64_t i = 3 * (int64_t)dof_map->body_node[n] + k;
      mean[k] += c->now[i] / (end - begin);
      middle[k] += (c->model->mesh->node[i] - centre[k]) / (end - begin);
    }
  for (int32_t n = begin; n < end; n++) {
    double arm[3], u[3], turn[3];
    for (int k = 0; k < 3; k++) {
      int64_t i = 3 * (int64_t)dof_map->body_node[n] + k;
      arm[k] = c->model->mesh->node[i] - centre[k] - middle[k];
      u[k] = c->now[i] - mean[k];
    }
    bw_cross(arm, u, turn);
    for (int k = 0; k < 3; k++) {
      rotation[k] += turn[k];
      for (int l = 0; l < 3; l++)
        inertia[3 * k + l] += (k == l ? bw_dot(arm, arm) : 0) - arm[k] * arm[l];
    }
  }
  if (!bwi_cholesky(3, inertia, 0))
    return 0;
  bwi_lower_solve(3, inertia, rotation);
  bwi_upper_solve(3, inertia, rotation);
  return bw_norm(rotation);
}

/* A warning that the result keeps. */
BW_PRINTF(3, 4)
static void note(bw_context *context, bwi_text *notes, const char *format, ...) {
  char text[700];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  bw_warn(context, "%s", text);
  if (notes->count > 0)
    bwi_text_add(notes, "\n");
  bwi_text_add(notes, text);
}

/* Pairs whose pressure, or whose gap, would be another between round faces. */
static bw_status note_flat_facets(bw_context *context, const bwi_contact_problem *c,
                                  const bw_contact *out, bwi_text *notes) {
  bw_status status = BW_OK;
  double *change = BW_NEW(context, double, c->count), *round = BW_NEW(context, double, c->count);
  BW_TRY_MEMORY(change && round);
  BW_TRY(bwi_contact_round_pressure(context, c, change, round));
  for (int pair = 0; pair < out->pair_count; pair++) {
    double pressure = 0, most = 0, least = INFINITY, flat = out->state[pair].pressure;
    for (int i = 0; i < c->count; i++) {
      if (c->rows.of[i] != pair || !(c->rows.area[i] > 0))
        continue;
      pressure = fmax(pressure, round[i]);
      least = fmin(least, c->w[c->rows.first[i]] / c->rows.area[i] + change[i]);
      if (flat == 0 || fmax(round[i], c->p[c->rows.first[i]]) > 0)
        most = fmax(most, fabs(change[i]));
    }
    bool smooth = c->rows.pair[pair].smooth;
    bool other = flat > 0 && fabs(pressure - flat) > other_pressure * flat;
    if (flat == 0 && !(pressure > 0 || least < -c->rounded))
      continue;
    if (flat == 0 && smooth)
      note(context, notes,
           "contact pair %d is uncertain: it stays open by less than the error of its gaps, about "
           "%.3g m, as round faces lie far over its facets: refine the facets",
           pair + 1, most);
    else if (flat == 0)
      note(context, notes,
           "contact pair %d is uncertain: its facets are flat where faces are round, and stay "
           "open. Round faces touch: their gap is %.3g m less somewhere. Set `smooth` of the "
           "pair, or give a mesh with curved elements",
           pair + 1, most);
    else if (other && smooth)
      note(
          context, notes,
          "contact pair %d is uncertain: round faces lie so far over its facets that the error "
          "of their gaps, about %.3g m, changes its largest pressure by %.0f %%: refine the facets",
          pair + 1, most, 100 * fabs(pressure - flat) / flat);
    else if (other)
      note(context, notes,
           "contact pair %d is uncertain: its facets are flat where faces are round, which changes "
           "gaps by up to %.3g m and its largest pressure by %.0f %% or more: set `smooth` of the "
           "pair, or give a mesh with curved elements",
           pair + 1, most, 100 * fabs(pressure - flat) / flat);
  }
done:
  bw_free(change);
  bw_free(round);
  return status;
}

/* How many corners of a pair carry pressure that move with a remote point. */
static int count_coupled(const bwi_contact_problem *c, int pair, const bw_coupling *coupling) {
  int count = 0, next = 0;
  for (int i = 0; i < c->count; i++) { /* nodes of both ascend */
    if (c->rows.of[i] != pair || !(c->p[c->rows.first[i]] > 0))
      continue;
    while (next < coupling->node_count && coupling->node[next] < c->rows.node[i])
      next++;
    count += next < coupling->node_count && coupling->node[next] == c->rows.node[i];
  }
  return count;
}

/* A rigid face on a rigid surface: three forces are as good as many. */
static void note_rigid_faces(bw_context *context, const bwi_contact_problem *c, bwi_text *notes) {
  for (int i = 0; i < c->rows.pair_count; i++)
    for (int k = 0; k < c->model->coupling_count; k++)
      if (c->rows.pair[i].with && c->model->coupling[k].point.kind == BW_RIGID &&
          count_coupled(c, i, &c->model->coupling[k]) > 3)
        note(context, notes,
             "contact pair %d presses the face of the rigid coupling %d, and nothing decides its "
             "pressure there: the force and the moment are right",
             i + 1, k + 1);
}

/* What the result leaves undecided, and where it is out of the range of the theory. */
static bw_status take_notes(bw_context *context, const bwi_contact_problem *c, bw_contact *out) {
  bw_status status = BW_OK;
  const bw_dof_map *dof_map = c->system->dof_map;
  bwi_text notes = {.context = context};
  double side = 0, min[3], max[3];
  bw_mesh_box(c->model->mesh, min, max);
  bwi_text_add(&notes, "");
  for (int k = 0; k < 3; k++)
    side = fmax(side, max[k] - min[k]);
  for (int i = 0; i < out->pair_count; i++) {
    if (out->state[i].active == 0 && out->state[i].penetration > 0)
      note(context, &notes,
           "contact pair %d is undecided: points penetrate by up to %.3g m, though its gap is open "
           "in the mean: its facets are too large for what it touches. Refine them",
           i + 1, out->state[i].penetration);
    else if (out->state[i].active == 0 && out->state[i].gap == 0)
      note(context, &notes, "contact pair %d touches without pressure", i + 1);
    else if (out->state[i].active == 0)
      note(context, &notes, "contact pair %d stays open: its smallest gap is %.3g m", i + 1,
           out->state[i].gap);
    else if (out->state[i].penetration > coarse * c->elastic)
      note(
          context, &notes,
          "contact pair %d penetrates by up to %.3g m between corners, and its pressure moves them "
          "by %.3g m: its facets are too large for what it touches. Refine them",
          i + 1, out->state[i].penetration, c->elastic);
  }
  BW_TRY(note_flat_facets(context, c, out, &notes));
  note_rigid_faces(context, c, &notes);
  for (int i = 0; i < out->pair_count && !c->finite; i++) {
    double slid = out->pair[i].with ? 0 : bwi_contact_rows_slid(&c->rows, i, c->p, c->now);
    if (slid > c->facet)
      note(context, &notes,
           "contact pair %d slides by %.3g m, more than the smallest facet of all pairs, %.3g m, "
           "and what faces what is that of the undeformed shape: take finite_sliding",
           i + 1, slid, c->facet);
  }
  for (const char *motion = out->free_text; *motion;) {
    int length = (int)strcspn(motion, "\n");
    note(context, &notes, "nothing decides the %.*s: stresses and pressure do not depend on it",
         length, motion);
    motion += length + (motion[length] == '\n');
  }
  for (int32_t b = 0; b < dof_map->mesh->component_count; b++) {
    double rotation = body_rotation(c, b);
    out->rotation = fmax(out->rotation, rotation);
    if (c->finite && rotation > largest_rotation)
      BW_TRY(bw_fail(context, BW_LIMIT,
                     "body %d rotates by %.3g degrees, and finite sliding allows %.3g: turn the "
                     "body in the mesh, "
                     "or support it against turning",
                     b + 1, rotation * 180 / M_PI, largest_rotation * 180 / M_PI));
    if (rotation > largest_rotation)
      note(context, &notes,
           "body %d rotates by %.3g degrees on its contact, and rotations are taken as small: "
           "place, "
           "gaps and pressure are wrong. Support it against turning, or turn it in the mesh",
           b + 1, rotation * 180 / M_PI);
    else if (rotation > large_rotation)
      note(context, &notes,
           "body %d rotates by %.2g degrees on its contact. Rotations are taken as small%s: points "
           "at a distance r from the axis are off by about %.2g r",
           b + 1, rotation * 180 / M_PI, c->finite ? ", also in finite sliding" : "",
           rotation * rotation / 2);
  }
  if (c->elastic > large_displacement * side)
    note(context, &notes,
         "pressure moves the facets by %.3g m, more than a tenth of the longest side: that is "
         "beyond the range of linear theory",
         c->elastic);
  out->notes = notes.bytes;
  notes.bytes = NULL;
  BW_TRY_MEMORY(!notes.failed);
done:
  bw_free(notes.bytes);
  return status;
}

bw_status bwi_contact_take_result(bw_context *context, bwi_contact_problem *c,
                                  bw_contact **contact) {
  bw_status status = BW_OK;
  int64_t nodes = c->model->mesh->node_count;
  double *force = NULL;
  bw_contact *out = BW_NEW0(context, bw_contact, 1);
  BW_TRY_MEMORY(out);
  bw_object_init(out, &contact_kind);
  out->model = bw_retain(c->model);
  force = BW_NEW(context, double, 3 * nodes);
  out->pair = BW_NEW0(context, bw_contact_pair, c->rows.pair_count);
  out->state = BW_NEW0(context, bw_contact_state, c->rows.pair_count);
  out->pressure = BW_NEW0(context, double, nodes);
  out->gap = BW_NEW(context, double, nodes);
  BW_TRY_MEMORY(force && out->pair && out->state && out->pressure && out->gap);
  out->pair_count = c->rows.pair_count;
  bwi_contact_pairs_retain(out->pair_count, c->rows.pair, out->pair);
  BW_TRY(take_solution(context, c, out));
  BW_TRY(take_undetermined(context, c, out));
  take_pressure(c, force, out);
  take_gaps(c, out);
  take_states(c, force, out);
  out->steps = c->options->steps + (c->options->after ? c->options->after->steps : 0);
  out->has_friction = c->before != NULL;
  if (out->has_friction) {
    out->start = bw_retain(c->start);
    out->joined = c->joined;
    out->traction = BW_NEW0(context, double, 3 * nodes);
    out->slip = BW_NEW0(context, double, 3 * nodes);
    out->status = BW_NEW0(context, uint8_t, nodes);
    BW_TRY_MEMORY(out->traction && out->slip && out->status);
    take_friction(c, out);
  }
  out->iterations = c->iterations;
  out->changes = c->changes;
  out->solves = c->solves;
  out->report = c->system->report;
  BW_TRY(take_notes(context, c, out));
  *contact = out;
done:
  bw_free(force);
  if (status != BW_OK)
    bw_release(out);
  return status;
}
