/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Cyclic symmetry (docs/theory/symmetry.md): two faces of a sector whose nodes and facets match by
 * a rotation about an axis, and what breaks the symmetry. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/box_tree.h"
#include "model/internal.h"

enum { LEAF = 8 };
static const double full_turn = 6.28318530717958647692;

/* Nodes match within this part of the mean edge of their faces. */
static const double match = 1e-3;
/* The angle between the faces agrees with the number of sectors within this part. */
static const double same_angle = 1e-3;
static const double most_guessed = 1000; /* sectors that a message proposes: more are rounding */
/* The sine of an angle seen from the axis that is more than rounding. */
static const double across_axis = 1e-9;
/* Conditions of supports agree within this. */
static const double same_support = 1e-3;

/* ---- rotation -------------------------------------------------------------------------------- */

void bwi_cyclic_rotation(const bw_cyclic *cyclic, int turns, double rotation[9]) {
  const double *a = cyclic->axis;
  turns = ((turns % cyclic->count) + cyclic->count) % cyclic->count;
  double angle = full_turn * turns / cyclic->count, c = cos(angle), s = sin(angle);
  if (2 * turns == cyclic->count) {
    c = -1;
    s = 0;
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      rotation[3 * i + j] = (1 - c) * a[i] * a[j] + (i == j ? c : 0);
  rotation[1] -= s * a[2];
  rotation[2] += s * a[1];
  rotation[3] += s * a[2];
  rotation[5] -= s * a[0];
  rotation[6] -= s * a[1];
  rotation[7] += s * a[0];
}

void bwi_rotate(const double rotation[9], const double v[3], double out[3]) {
  double x[3] = {v[0], v[1], v[2]};
  for (int i = 0; i < 3; i++)
    out[i] = bw_dot(rotation + 3 * i, x);
}

void bwi_cyclic_place(const bw_cyclic *cyclic, const double rotation[9], const double x[3],
                      double out[3]) {
  double y[3] = {x[0] - cyclic->point[0], x[1] - cyclic->point[1], x[2] - cyclic->point[2]};
  bwi_rotate(rotation, y, out);
  for (int k = 0; k < 3; k++)
    out[k] += cyclic->point[k];
}

/* v without its part along the axis */
static void across(const bw_cyclic *cyclic, const double v[3], double out[3]) {
  double part = bw_dot(v, cyclic->axis);
  for (int k = 0; k < 3; k++)
    out[k] = v[k] - part * cyclic->axis[k];
}

static double radius(const bw_cyclic *cyclic, const double x[3]) {
  double y[3] = {x[0] - cyclic->point[0], x[1] - cyclic->point[1], x[2] - cyclic->point[2]};
  across(cyclic, y, y);
  return bw_norm(y);
}

/* ---- object ---------------------------------------------------------------------------------- */

static void cyclic_destroy(void *object) {
  bw_cyclic *cyclic = object;
  bw_release(cyclic->low);
  bw_release(cyclic->high);
  bw_free(cyclic->partner);
  bw_free(cyclic);
}

static size_t cyclic_bytes(const void *object) {
  const bw_cyclic *cyclic = object;
  return sizeof *cyclic + (size_t)cyclic->low->mesh->node_count * sizeof *cyclic->partner;
}

static const bw_kind cyclic_kind = {"cyclic symmetry", cyclic_destroy, cyclic_bytes};

/* ---- matching -------------------------------------------------------------------------------- */

static void box_of(const void *data, int32_t item, double *min, double *max) {
  const double *x = ((const bw_mesh *)data)->node + 3 * (int64_t)item;
  memcpy(min, x, 3 * sizeof *x);
  memcpy(max, x, 3 * sizeof *x);
}

static double distance_to(void *data, int32_t item, const double *p) {
  const double *x = ((const bw_mesh *)data)->node + 3 * (int64_t)item;
  double square = 0;
  for (int k = 0; k < 3; k++)
    square += (x[k] - p[k]) * (x[k] - p[k]);
  return square;
}

/* Fills `partner`: the low node whose rotation is a high node. The largest distance, and where. */
static void match_nodes(bw_cyclic *cyclic, const bwi_box_tree *tree, int turns, double *largest,
                        int32_t *at) {
  const bw_mesh *mesh = cyclic->low->mesh;
  double rotation[9];
  bwi_cyclic_rotation(cyclic, turns, rotation);
  for (int32_t i = 0; i < mesh->node_count; i++)
    cyclic->partner[i] = -1;
  *largest = -1;
  *at = -1;
  for (int32_t i = 0; i < cyclic->low->node_count; i++) {
    int32_t node = cyclic->low->node[i];
    double p[3], square = 0;
    bwi_cyclic_place(cyclic, rotation, mesh->node + 3 * (int64_t)node, p);
    int32_t found = bwi_box_tree_nearest(tree, p, distance_to, (void *)mesh, &square);
    if (sqrt(square) > *largest) {
      *largest = sqrt(square);
      *at = node;
    }
    cyclic->partner[found] = node;
  }
}

/* Each node of the high face has a partner. */
static bool one_to_one(const bw_cyclic *cyclic) {
  bool all = cyclic->low->node_count == cyclic->high->node_count;
  for (int32_t i = 0; all && i < cyclic->high->node_count; i++)
    all = cyclic->partner[cyclic->high->node[i]] >= 0;
  return all;
}

typedef struct corners {
  int32_t node[3]; /* ascending */
} corners;

static int compare_corners(const void *a, const void *b) {
  const int32_t *p = ((const corners *)a)->node, *q = ((const corners *)b)->node;
  for (int k = 0; k < 3; k++)
    if (p[k] != q[k])
      return p[k] < q[k] ? -1 : 1;
  return 0;
}

/* The corners of a facet, as nodes of the low face. */
static corners corners_of(const bw_cyclic *cyclic, int32_t facet, bool high) {
  const bw_mesh *mesh = cyclic->low->mesh;
  const int32_t *node = mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
  corners c;
  for (int k = 0; k < 3; k++) {
    int32_t own = high ? cyclic->partner[node[k]] : node[k];
    int j = k;
    for (; j > 0 && c.node[j - 1] > own; j--)
      c.node[j] = c.node[j - 1];
    c.node[j] = own;
  }
  return c;
}

/* The facets of both faces have the same corners. */
static bw_status match_facets(bw_context *context, const bw_cyclic *cyclic, bool *same) {
  int32_t count = cyclic->low->facet_count;
  *same = count == cyclic->high->facet_count;
  if (!*same)
    return BW_OK;
  corners *low = BW_NEW(context, corners, count), *high = BW_NEW(context, corners, count);
  if (low && high) {
    for (int32_t i = 0; i < count; i++) {
      low[i] = corners_of(cyclic, cyclic->low->facet[i], false);
      high[i] = corners_of(cyclic, cyclic->high->facet[i], true);
    }
    qsort(low, (size_t)count, sizeof *low, compare_corners);
    qsort(high, (size_t)count, sizeof *high, compare_corners);
    *same = memcmp(low, high, (size_t)count * sizeof *low) == 0;
  }
  bw_status status = low && high ? BW_OK : BW_MEMORY;
  bw_free(low);
  bw_free(high);
  return status;
}

/* ---- what does not fit ----------------------------------------------------------------------- */

/* The angle by which the low face turns into the high one, from their normals; 0 where they have
 * none. */
static double angle_between(const bw_cyclic *cyclic) {
  double low[3], high[3], turn[3];
  bw_selection_normal(cyclic->low, low);
  bw_selection_normal(cyclic->high, high);
  across(cyclic, low, low);
  across(cyclic, high, high);
  if (!(bw_norm(low) > 0.1 && bw_norm(high) > 0.1))
    return 0;
  bw_cross(high, low, turn); /* -low x high */
  return atan2(bw_dot(turn, cyclic->axis), -bw_dot(low, high));
}

static bw_status fail_match(bw_context *context, const bw_cyclic *cyclic, double distance,
                            int32_t at, double allowed) {
  double angle = fabs(angle_between(cyclic)), asked = full_turn / cyclic->count;
  const double degrees = 360 / full_turn;
  if (angle > 0 && fabs(angle - asked) > same_angle * asked) {
    char number[40] = "";
    double fits = round(full_turn / angle);
    if (fits <= most_guessed && fabs(full_turn / fits - angle) <= same_angle * angle)
      snprintf(number, sizeof number, "give %.0f sectors, or ", fits);
    bw_fail(context, BW_GEOMETRY,
            "the faces of the sector are %.6g degrees apart about the axis, but those of %d "
            "sectors are %.6g degrees apart: %sgive another axis or other faces",
            angle * degrees, cyclic->count, asked * degrees, number);
    bw_detail_number(context, "angle", angle);
    return BW_GEOMETRY;
  }
  const double *x = cyclic->low->mesh->node + 3 * (int64_t)at;
  if (distance > allowed)
    bw_fail(context, BW_GEOMETRY,
            "the faces of the sector do not match: node %d at (%g, %g, %g) m of the low face, "
            "turned by %.6g degrees, is %.4g m from the nearest node of the high face, where %.2g "
            "m are allowed; mesh the sector so that the high face is the low one, turned",
            at + 1, x[0], x[1], x[2], asked * degrees, distance, allowed);
  else
    bw_fail(context, BW_GEOMETRY,
            "the faces of the sector do not match: the low one has %d nodes and %d facets, the "
            "high one %d and %d, and they are not the same ones, turned; mesh the sector so that "
            "the high face is the low one, turned",
            cyclic->low->node_count, cyclic->low->facet_count, cyclic->high->node_count,
            cyclic->high->facet_count);
  bw_detail_number(context, "distance", distance);
  return BW_GEOMETRY;
}

/* Nodes on the axis turn into themselves; no other is on both faces. */
static bw_status check_partners(bw_context *context, bw_cyclic *cyclic, double allowed) {
  const bw_mesh *mesh = cyclic->low->mesh;
  for (int32_t i = 0; i < cyclic->high->node_count; i++) {
    int32_t node = cyclic->high->node[i], own = cyclic->partner[node];
    if (own == node) {
      cyclic->axis_count++;
      continue;
    }
    if (cyclic->partner[own] >= 0)
      return bwi_fail_node(
          context, mesh, own, BW_GEOMETRY,
          "is on both faces of the sector, but not on the axis: select the two faces "
          "apart");
    if (radius(cyclic, mesh->node + 3 * (int64_t)node) <= allowed)
      return bwi_fail_node(
          context, mesh, node, BW_GEOMETRY,
          "is on the axis, but not on both faces of the sector: select each face up "
          "to the axis");
  }
  return BW_OK;
}

/* Whether the segment from p to q passes the axis between its ends. All lie across it. */
static bool passes(const double p[3], const double q[3], double allowed) {
  double d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, square = bw_dot(d, d), nearest[3];
  double t = square > 0 ? -bw_dot(p, d) / square : 0;
  if (!(t > 0 && t < 1) || bw_norm(p) <= allowed || bw_norm(q) <= allowed)
    return false;
  for (int k = 0; k < 3; k++)
    nearest[k] = p[k] + t * d[k];
  return bw_norm(nearest) <= allowed;
}

/* The axis passes the body along edges of elements only: it enters at no point inside a facet. */
static bw_status check_axis(bw_context *context, const bw_cyclic *cyclic, double allowed) {
  const bw_mesh *mesh = cyclic->low->mesh;
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + (int64_t)f * mesh->nodes_per_facet;
    double p[3][3], turn[3];
    int left = 0, right = 0;
    bool passed = false, on_axis = false;
    for (int k = 0; k < 3; k++) {
      for (int c = 0; c < 3; c++)
        p[k][c] = mesh->node[3 * (int64_t)node[k] + c] - cyclic->point[c];
      across(cyclic, p[k], p[k]);
      on_axis |= bw_norm(p[k]) <= allowed;
    }
    for (int k = 0; k < 3; k++) {
      bw_cross(p[k], p[(k + 1) % 3], turn);
      double side = bw_dot(turn, cyclic->axis);
      double least = across_axis * bw_norm(p[k]) * bw_norm(p[(k + 1) % 3]);
      left += side > least;
      right += side < -least;
      passed |= passes(p[k], p[(k + 1) % 3], allowed);
    }
    if (passed || (!on_axis && (left == 3 || right == 3)))
      return bwi_fail_node(
          context, mesh, node[0], BW_GEOMETRY,
          "is a corner of a facet that the axis passes: in a sector that reaches its "
          "axis the two faces meet there, and edges of elements lie on it");
  }
  return BW_OK;
}

static bw_status find_partners(bw_context *context, bw_cyclic *cyclic) {
  bw_status status = BW_OK;
  const bw_selection *low = cyclic->low, *high = cyclic->high;
  bwi_box_tree tree = {0};
  double area = bw_selection_area(low), other;
  double allowed = match * sqrt(2 * area / low->facet_count);
  int32_t at, other_at;
  bool same = false;
  int32_t *item = BW_NEW(context, int32_t, high->node_count);
  cyclic->partner = BW_NEW(context, int32_t, low->mesh->node_count);
  if (!item || !cyclic->partner) {
    bw_free(item);
    return BW_MEMORY;
  }
  memcpy(item, high->node, (size_t)high->node_count * sizeof *item);
  BW_TRY(bwi_box_tree_create(context, 3, LEAF, high->node_count, item, box_of, low->mesh, &tree));
  match_nodes(cyclic, &tree, 1, &cyclic->distance, &at);
  if (cyclic->distance > allowed) { /* the axis may look the other way */
    match_nodes(cyclic, &tree, -1, &other, &other_at);
    if (other <= allowed) {
      cyclic->distance = other;
      for (int k = 0; k < 3; k++)
        cyclic->axis[k] = -cyclic->axis[k];
    }
  }
  if (cyclic->distance <= allowed && one_to_one(cyclic))
    BW_TRY(match_facets(context, cyclic, &same));
  if (!same)
    BW_TRY(fail_match(context, cyclic, cyclic->distance, at, allowed));
  BW_TRY(check_partners(context, cyclic, allowed));
  BW_TRY(check_axis(context, cyclic, allowed));
done:
  bwi_box_tree_clear(&tree);
  return status;
}

bw_status bw_model_cyclic(bw_context *context, bw_model *model, const bw_selection *low,
                          const bw_selection *high, int count, const double axis[3],
                          const double point[3]) {
  bw_status status = BW_OK;
  bw_cyclic *made = NULL;
  double size = bw_norm(axis);
  BW_TRY(bwi_check_selection(context, model, low, false, "the low face of a sector"));
  BW_TRY(bwi_check_selection(context, model, high, false, "the high face of a sector"));
  if (count < 2)
    return bw_fail(context, BW_INVALID, "cyclic symmetry has 2 or more sectors, not %d", count);
  if (!(size > 0) || !isfinite(size) || !isfinite(bw_norm(point)))
    return bw_fail(context, BW_INVALID,
                   "the axis of the cyclic symmetry needs a direction other than (0, 0, 0) and a "
                   "point, of finite numbers");
  if (model->cyclic)
    return bw_fail(context, BW_INVALID,
                   "the model has a cyclic symmetry already: clear it before giving another one");
  if (model->coupling_count > 0)
    return bw_fail(
        context, BW_UNSUPPORTED,
        "the model has couplings: a sector of cyclic symmetry takes none; load the faces "
        "themselves");
  BW_TRY(bwi_model_refuse_preloads(
      context, model,
      "a sector of cyclic symmetry does not take: leave the preload out, or model the whole"));
  made = BW_NEW0(context, bw_cyclic, 1);
  BW_TRY_MEMORY(made);
  bw_object_init(made, &cyclic_kind);
  made->low = bw_retain(low);
  made->high = bw_retain(high);
  made->count = count;
  for (int k = 0; k < 3; k++) {
    made->axis[k] = axis[k] / size;
    made->point[k] = point[k];
  }
  BW_TRY(find_partners(context, made));
  model->cyclic = made;
  made = NULL;
  model->object.revision++;
done:
  bw_release(made);
  return status;
}

void bw_model_clear_cyclic(bw_model *model) {
  if (!model->cyclic)
    return;
  bw_release(model->cyclic);
  model->cyclic = NULL;
  model->object.revision++;
}

/* ---- supports and loads ---------------------------------------------------------------------- */

/* What is constrained at a node: the projection onto the constrained directions, and the values. */
static void condition_at(const bwi_constraint *at, double projection[9], double value[3]) {
  memset(projection, 0, 9 * sizeof *projection);
  memset(value, 0, 3 * sizeof *value);
  for (int i = 0; at && i < at->count; i++)
    for (int k = 0; k < 3; k++) {
      value[k] += at->value[i] * at->direction[i][k];
      for (int c = 0; c < 3; c++)
        projection[3 * k + c] += at->direction[i][k] * at->direction[i][c];
    }
}

static bool agree(const double rotation[9], const bwi_constraint *low, const bwi_constraint *high) {
  double p[9], u[3], q[9], v[3], turned[9], all[9], most = 0;
  condition_at(low, p, u);
  condition_at(high, q, v);
  for (int i = 0; i < 3; i++)
    bwi_rotate(rotation, p + 3 * i, turned + 3 * i); /* p R^T, p being symmetric */
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      all[3 * i + j] = 0;
      for (int k = 0; k < 3; k++)
        all[3 * i + j] += rotation[3 * i + k] * turned[3 * k + j];
    }
  for (int i = 0; i < 9; i++)
    most = fmax(most, fabs(all[i] - q[i]));
  double size = fmax(bw_norm(u), bw_norm(v)), far = 0;
  bwi_rotate(rotation, u, u);
  for (int k = 0; k < 3; k++)
    far = fmax(far, fabs(u[k] - v[k]));
  return most <= same_support && far <= same_support * size;
}

bw_status bwi_cyclic_check_supports(bw_context *context, const bw_model *model) {
  bw_status status = BW_OK;
  const bw_cyclic *cyclic = model->cyclic;
  int32_t count = 0, nodes = model->mesh->node_count;
  bwi_constraint *list = NULL;
  double rotation[9];
  const bwi_constraint **of = BW_NEW0(context, const bwi_constraint *, nodes);
  BW_TRY_MEMORY(of);
  BW_TRY(bwi_node_constraints(context, model, &count, &list));
  for (int32_t i = 0; i < count; i++)
    of[list[i].node] = &list[i];
  bwi_cyclic_rotation(cyclic, 1, rotation);
  for (int32_t i = 0; i < nodes; i++)
    if (cyclic->partner[i] >= 0 && !agree(rotation, of[cyclic->partner[i]], of[i]))
      BW_TRY(bwi_fail_node(
          context, model->mesh, i, BW_INVALID,
          cyclic->partner[i] == i
              ? "is on the axis, and its supports are not the same after a turn by one "
                "sector: hold it along the axis, across it, or altogether"
              : "of the high face has other supports than its partner on the low face, "
                "turned: supports of a sector are those of all sectors, so give both "
                "faces the same ones"));
done:
  bw_free(of);
  bw_free(list);
  return status;
}

bw_status bwi_cyclic_check_loads(bw_context *context, const bw_model *model) {
  bw_status status = BW_OK;
  const bw_cyclic *cyclic = model->cyclic;
  const bw_mesh *mesh = model->mesh;
  uint8_t *cut = BW_NEW0(context, uint8_t, mesh->facet_count);
  BW_TRY_MEMORY(cut);
  for (int32_t i = 0; i < cyclic->low->facet_count; i++)
    cut[cyclic->low->facet[i]] = cut[cyclic->high->facet[i]] = 1;
  for (int l = 0; l < model->load_count; l++) {
    const bw_load *load = &model->load[l];
    double side[3];
    across(cyclic, load->vector, side);
    if (load->kind == BW_LOAD_GRAVITY && bw_norm(side) > 1e-9 * bw_norm(load->vector))
      BW_TRY(bw_fail(context, BW_INVALID,
                     "load %d is gravity across the axis, which is not the same in every sector: "
                     "cyclic symmetry takes gravity along the axis only; model the whole for this "
                     "load",
                     l + 1));
    for (int32_t i = 0; load->on && i < load->on->facet_count; i++)
      if (cut[load->on->facet[i]])
        BW_TRY(bw_fail(context, BW_INVALID,
                       "load %d acts on a face of the sector that lies inside the whole: leave the "
                       "low and the high face out of its selection",
                       l + 1));
    for (int32_t i = 0; load->kind == BW_LOAD_TEMPERATURE && i < mesh->node_count; i++) {
      int32_t own = cyclic->partner[i];
      double here = bw_array_get(load->nodal, i, 0);
      double there = own >= 0 ? bw_array_get(load->nodal, own, 0) : here;
      if (fabs(here - there) > same_support * fmax(fabs(here), fabs(there)))
        BW_TRY(bwi_fail_node(context, mesh, i, BW_INVALID,
                             "of the high face has another temperature than its partner on the low "
                             "face: temperatures of a sector are those of all sectors"));
    }
  }
done:
  bw_free(cut);
  return status;
}
