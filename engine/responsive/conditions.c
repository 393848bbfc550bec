/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conditions by tag: sides of the mesh know their segment, segments of the outline their tag. The
 * functions of conditions may be anything a caller gives (a script's, say): they are called on the
 * caller's thread, in a fixed order. */
#include <math.h>
#include <string.h>

#include "responsive/internal.h"

bool bwi_condition_applies(const bw_plane_mesh *mesh, const bw_condition *condition, int32_t side) {
  int32_t segment = mesh->topology->side_segment[side];
  return condition->tag < 0 || mesh->outline->segment[segment].tag == condition->tag;
}

bw_status bwi_conditions_check(bw_context *context, const bw_plane_mesh *mesh, int components,
                               int32_t count, const bw_condition *condition) {
  for (int32_t k = 0; k < count; k++) {
    const bw_condition *c = &condition[k];
    bool found = false;
    if (c->kind == BW_CONVECTION)
      return bw_fail(context, BW_INVALID, "condition %d is convection: a sheet carries no heat",
                     k + 1);
    if (c->kind != BW_PRESCRIBED && c->kind != BW_TRACTION && c->kind != BW_PRESSURE)
      return bw_fail(context, BW_INVALID, "condition %d is of no known kind", k + 1);
    if (c->kind != BW_PRESSURE && (c->component < 0 || c->component >= components))
      return bw_fail(context, BW_INVALID, "condition %d is on component %d; there are %d", k + 1,
                     c->component + 1, components);
    if (!c->function && !isfinite(c->value))
      return bw_fail(context, BW_INVALID, "the value of condition %d is not a finite number",
                     k + 1);
    if (c->tag >= mesh->outline->tag_count)
      return bw_fail(context, BW_INVALID, "condition %d is on tag %d; the outline has %d", k + 1,
                     c->tag + 1, mesh->outline->tag_count);
    for (int32_t s = 0; s < mesh->topology->side_count && !found; s++)
      found = bwi_condition_applies(mesh, c, s);
    if (!found)
      return bw_fail(context, BW_EMPTY,
                     "condition %d is on tag '%s', which no edge of the outline has", k + 1,
                     c->tag < 0 ? "" : mesh->outline->tag[c->tag].text);
  }
  return BW_OK;
}

bw_status bwi_conditions_renamed(bw_context *context, const bw_outline *from, const bw_outline *to,
                                 int32_t count, const bw_condition *condition, bw_condition **out) {
  bw_condition *renamed = BW_NEW(context, bw_condition, count);
  if (!renamed)
    return BW_MEMORY;
  for (int32_t k = 0; k < count; k++) {
    renamed[k] = condition[k];
    if (condition[k].tag < 0)
      continue;
    const char *name = condition[k].tag < from->tag_count ? from->tag[condition[k].tag].text : "";
    renamed[k].tag = bw_outline_find_tag(to, name);
    if (renamed[k].tag < 0) {
      bw_free(renamed);
      bw_fail(context, BW_INVALID, "the other outline has no tag '%s', which a condition is on",
              name);
      bw_detail_text(context, "tag", name);
      return BW_INVALID;
    }
  }
  *out = renamed;
  return BW_OK;
}

bw_status bwi_conditions_copy(bw_context *context, int32_t count, const bw_condition *condition,
                              bw_condition **out) {
  *out = BW_NEW(context, bw_condition, count);
  if (!*out)
    return BW_MEMORY;
  if (count > 0)
    memcpy(*out, condition, (size_t)count * sizeof **out);
  return BW_OK;
}

bool bwi_conditions_alike(int32_t count, const bw_condition *a, const bw_condition *b) {
  for (int32_t i = 0; i < count; i++)
    if (a[i].kind != b[i].kind || a[i].component != b[i].component)
      return false;
  return true;
}

void bwi_conditions_take_tags(int32_t count, const bw_condition *from, bw_condition *to) {
  for (int32_t i = 0; i < count; i++)
    to[i].tag = from[i].tag;
}

bw_status bwi_condition_value(bw_context *context, const bw_condition *condition,
                              const double at[2], double time, double *value) {
  *value = condition->function ? condition->function(condition->data, at, time) : condition->value;
  if (!isfinite(*value))
    return bw_fail(context, BW_INVALID,
                   "a condition is %g at (%g, %g) m and %g s: a finite number expected", *value,
                   at[0], at[1], time);
  return BW_OK;
}

/* What tags ask for one component of a node. They ask for one value, except where their edges
 * meet. */
typedef struct request {
  int32_t order;    /* the highest so far; below it a request does not count */
  double low, high; /* of that order */
  double min, max;  /* of every order, and the conditions that ask for them */
  int32_t min_by, max_by;
  bool any;
} request;

static void add_request(request *r, const bw_condition *condition, int32_t k, double value) {
  int32_t order = condition[k].order;
  if (!r->any || order > r->order)
    r->order = order, r->low = r->high = value;
  else if (order == r->order)
    r->low = fmin(r->low, value), r->high = fmax(r->high, value);
  if (!r->any || value < r->min)
    r->min = value, r->min_by = k;
  if (!r->any || value > r->max)
    r->max = value, r->max_by = k;
  r->any = true;
}

/* Neither names nor places in the list decide: of displacements and velocities the one nearest to
 * rest holds, so that no fluid passes a wall at its corner, and of temperatures the middle. */
static double decide(const request *r, int component) {
  if (component >= 2)
    return 0.5 * (r->low + r->high);
  return fmin(fmax(r->low, 0), r->high);
}

static bw_status collect_requests(bw_context *context, const bw_plane_mesh *mesh, int components,
                                  int32_t count, const bw_condition *condition, double time,
                                  request *all) {
  const bw_plane_topology *topology = mesh->topology;
  int width = topology->nodes->order + 1;
  for (int32_t k = 0; k < count; k++) {
    const bw_condition *c = &condition[k];
    if (c->kind != BW_PRESCRIBED || c->component >= components)
      continue;
    int32_t before = -1; /* the node that the last side ended with has been asked already */
    for (int32_t s = 0; s < topology->side_count; s++) {
      if (!bwi_condition_applies(mesh, c, s))
        continue;
      const int32_t *node = topology->side + (int64_t)s * width;
      for (int a = 0; a < width; a++) {
        double value;
        if (node[a] == before)
          continue;
        bw_status status =
            bwi_condition_value(context, c, mesh->point + 2 * (size_t)node[a], time, &value);
        if (status != BW_OK)
          return status;
        add_request(&all[(size_t)node[a] * (size_t)components + (size_t)c->component], condition, k,
                    value);
      }
      before = node[1];
    }
  }
  return BW_OK;
}

enum { REPORTED_CONFLICTS = 8 };

/* A warning for each pair of tags that ask for different values of a component. */
static bool report_conflicts(bw_context *context, const bw_plane_mesh *mesh, int components,
                             const bw_condition *condition, const request *all) {
  static const char *const name[] = {"x", "y", "pressure", "temperature"};
  const request *reported[REPORTED_CONFLICTS];
  size_t size = (size_t)mesh->topology->nodes->node_count * (size_t)components;
  int count = 0;
  double scale[4] = {0};
  for (size_t i = 0; i < size; i++)
    if (all[i].any)
      scale[i % (size_t)components] =
          fmax(scale[i % (size_t)components], fmax(fabs(all[i].min), fabs(all[i].max)));
  for (size_t i = 0; i < size && count < REPORTED_CONFLICTS; i++) {
    const request *r = &all[i];
    int component = (int)(i % (size_t)components);
    if (!r->any || r->max - r->min <= 1e-9 * scale[component])
      continue;
    int32_t a = condition[r->min_by].tag, b = condition[r->max_by].tag;
    bool known = a == b;
    for (int j = 0; j < count && !known; j++) {
      int32_t c = condition[reported[j]->min_by].tag, d = condition[reported[j]->max_by].tag;
      known = (int)((size_t)(reported[j] - all) % (size_t)components) == component &&
              ((a == c && b == d) || (a == d && b == c));
    }
    if (known)
      continue;
    reported[count++] = r;
    const double *at = mesh->point + 2 * (i / (size_t)components);
    const bw_name *tag = mesh->outline->tag;
    bw_warn(context,
            "conditions conflict at (%.6g, %.6g): tag '%s' prescribes %s = %.6g, tag '%s' "
            "%.6g; %.6g is used%s",
            at[0], at[1], a < 0 ? "" : tag[a].text, name[component], r->min,
            b < 0 ? "" : tag[b].text, r->max, decide(r, component),
            condition[r->min_by].order == condition[r->max_by].order
                ? "; conditions in a list are ordered, and the last one decides"
                : ", of the condition that is given last");
  }
  return count > 0;
}

bw_status bw_conditions_prescribe(bw_context *context, const bw_plane_mesh *mesh, int components,
                                  int32_t count, const bw_condition *condition, double time,
                                  uint8_t *is_prescribed, double *prescribed, bool *reported) {
  size_t size = (size_t)mesh->topology->nodes->node_count * (size_t)components;
  request *all = BW_NEW0(context, request, size);
  if (!all)
    return BW_MEMORY;
  bw_status status = collect_requests(context, mesh, components, count, condition, time, all);
  if (status == BW_OK) {
    for (size_t i = 0; i < size; i++) {
      is_prescribed[i] = all[i].any;
      prescribed[i] = all[i].any ? decide(&all[i], (int)(i % (size_t)components)) : 0;
    }
    if (reported && !*reported)
      *reported = report_conflicts(context, mesh, components, condition, all);
  }
  bw_free(all);
  return status;
}

const double bwi_side_at[3] = {0.11270166537925831148, 0.5, 0.88729833462074168852};
const double bwi_side_weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

static double thickness_at(const bw_plane_topology *topology, int32_t side, int32_t count,
                           const double *thickness) {
  return thickness[count > 1 ? topology->region[topology->side_element[2 * (size_t)side]] : 0];
}

bw_status bwi_conditions_force(bw_context *context, const bw_plane_mesh *mesh, int components,
                               int32_t count, const bw_condition *condition, double time,
                               int32_t thickness_count, const double *thickness, double *force) {
  const bw_plane_topology *topology = mesh->topology;
  int width = topology->nodes->order + 1;
  for (size_t i = 0; i < (size_t)topology->nodes->node_count * (size_t)components; i++)
    force[i] = 0;
  for (int32_t k = 0; k < count; k++) {
    const bw_condition *c = &condition[k];
    if (c->kind == BW_PRESCRIBED || c->kind == BW_CONVECTION ||
        (c->kind == BW_TRACTION && c->component >= components) ||
        (c->kind == BW_PRESSURE && components < 2))
      continue;
    for (int32_t s = 0; s < topology->side_count; s++) {
      if (!bwi_condition_applies(mesh, c, s))
        continue;
      const int32_t *node = topology->side + (int64_t)s * width;
      double thick = thickness_at(topology, s, thickness_count, thickness);
      for (int q = 0; q < BWI_SIDE_POINTS; q++) {
        double n[3], d[3], at[2], along[2], value;
        bwi_side_shape(width, bwi_side_at[q], n, d);
        bwi_side_place(mesh, node, width, n, d, at, along);
        bw_status status = bwi_condition_value(context, c, at, time, &value);
        if (status != BW_OK)
          return status;
        value *= thick * bwi_side_weight[q];
        double length = hypot(along[0], along[1]);
        for (int a = 0; a < width; a++) {
          double *f = force + (size_t)node[a] * (size_t)components;
          if (c->kind == BW_TRACTION)
            f[c->component] += value * length * n[a];
          else { /* the inner normal: the side turned to the left */
            f[0] -= value * along[1] * n[a];
            f[1] += value * along[0] * n[a];
          }
        }
      }
    }
  }
  return BW_OK;
}

bw_status bw_conditions_force(bw_context *context, const bw_plane_mesh *mesh, int components,
                              int32_t count, const bw_condition *condition, double time,
                              double thickness, double *force) {
  return bwi_conditions_force(context, mesh, components, count, condition, time, 1, &thickness,
                              force);
}

void bwi_side_shape(int width, double t, double n[3], double d[3]) {
  if (width == 2) {
    n[0] = 1 - t, n[1] = t;
    d[0] = -1, d[1] = 1;
    return;
  }
  n[0] = (1 - t) * (1 - 2 * t), n[1] = t * (2 * t - 1), n[2] = 4 * t * (1 - t);
  d[0] = 4 * t - 3, d[1] = 4 * t - 1, d[2] = 4 - 8 * t;
}

void bwi_side_place(const bw_plane_mesh *mesh, const int32_t *node, int width, const double *n,
                    const double *d, double at[2], double along[2]) {
  for (int i = 0; i < 2; i++) {
    at[i] = along[i] = 0;
    for (int a = 0; a < width; a++) {
      at[i] += n[a] * mesh->point[2 * (size_t)node[a] + (size_t)i];
      along[i] += d[a] * mesh->point[2 * (size_t)node[a] + (size_t)i];
    }
  }
}

/* dJ/dx of J = sum_i weight_i force_i, values of functions going with the nodes */
bw_status bwi_conditions_force_gradient(bw_context *context, const bw_plane_mesh *mesh,
                                        int32_t count, const bw_condition *condition, double time,
                                        int32_t thickness_count, const double *thickness,
                                        const double *weight, double *gradient) {
  const bw_plane_topology *topology = mesh->topology;
  int width = topology->nodes->order + 1;
  for (int32_t k = 0; k < count; k++) {
    const bw_condition *c = &condition[k];
    if (c->kind == BW_PRESCRIBED || c->kind == BW_CONVECTION)
      continue;
    for (int32_t s = 0; s < topology->side_count; s++) {
      if (!bwi_condition_applies(mesh, c, s))
        continue;
      const int32_t *node = topology->side + (int64_t)s * width;
      double thick = thickness_at(topology, s, thickness_count, thickness);
      for (int q = 0; q < BWI_SIDE_POINTS; q++) {
        double n[3], d[3], at[2], along[2], value, by_along[2], w[2] = {0, 0};
        bwi_side_shape(width, bwi_side_at[q], n, d);
        bwi_side_place(mesh, node, width, n, d, at, along);
        bw_status status = bwi_condition_value(context, c, at, time, &value);
        if (status != BW_OK)
          return status;
        value *= thick * bwi_side_weight[q];
        for (int a = 0; a < width; a++)
          for (int i = 0; i < 2; i++)
            w[i] += n[a] * weight[2 * (size_t)node[a] + (size_t)i];
        double length = hypot(along[0], along[1]);
        if (c->kind == BW_TRACTION)
          for (int i = 0; i < 2; i++)
            by_along[i] = length > 0 ? value * w[c->component] * along[i] / length : 0;
        else {
          by_along[0] = value * w[1];
          by_along[1] = -value * w[0];
        }
        for (int a = 0; a < width; a++)
          for (int i = 0; i < 2; i++)
            gradient[2 * (size_t)node[a] + (size_t)i] += by_along[i] * d[a];
      }
    }
  }
  return BW_OK;
}
