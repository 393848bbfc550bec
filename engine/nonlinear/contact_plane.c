/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Contact with planes; what it computes stands in contact_plane.h.
 *
 * Invariant: every point has at least one node that is free along its contact plane's normal. */
#include "nonlinear/contact_plane.h"

#include <math.h>
#include <string.h>

#include "nonlinear/load_case.h"

/* c over the solid's own stiffness at a point. Each settling of the multipliers takes the gaps down
 * by about this factor. */
#define STIFFER 1e3

void bwi_contact_destroy(bwi_contact *c) {
  if (!c)
    return;
  if (!c->borrows) {
    bw_free(c->plane);
    bw_free(c->stiffness);
    bw_free(c->pushes);
  }
  bw_free(c->rest);
  bw_free(c->start);
  bw_free(c->node);
  bw_free(c->weight);
  bw_free(c->force);
  bw_free(c->gap);
  bw_free(c->multiplier);
  bw_free(c->offset);
  bw_free(c->shift);
  bw_free(c);
}

static bool constrained_along(const bw_load_case *load_case, int32_t node, const double normal[3]) {
  for (int d = 0; d < 3; d++)
    if (fabs(normal[d]) > 1e-9 && !load_case->constrained[3 * (int64_t)node + d])
      return false;
  return true;
}

/* Append a point with these nodes, unless none of them can move along the normal. */
static void append(bwi_contact *c, int f, const double rest[3], int terms, const int32_t *node,
                   const double *weight, const double *blocks) {
  const bw_contact_plane *plane = &c->load_case->contact_plane[f];
  double give = 0;
  int64_t at = c->start[c->count];
  for (int k = 0; k < terms; k++) {
    if (weight[k] == 0)
      continue;
    c->node[at] = node[k];
    c->weight[at++] = weight[k];
    if (constrained_along(c->load_case, node[k], plane->normal))
      continue;
    double stiff = 0;
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        stiff += plane->normal[i] * blocks[9 * (int64_t)node[k] + 3 * i + j] * plane->normal[j];
    if (stiff > 0)
      give += weight[k] * weight[k] / stiff;
  }
  if (!(give > 0))
    return;
  double y[3] = {rest[0] - plane->point[0], rest[1] - plane->point[1], rest[2] - plane->point[2]};
  c->plane[c->count] = f;
  c->rest[c->count] = bw_dot(y, plane->normal);
  c->stiffness[c->count] = STIFFER / give;
  c->start[++c->count] = at;
}

/* Nodes of boundary faces, marked. */
static bw_status mark_boundary(bw_context *context, const bw_grid *grid, uint8_t *outer) {
  bw_grid_face *face = NULL;
  int64_t count = 0;
  bw_status status = bw_grid_boundary(context, grid, &face, &count);
  for (int64_t k = 0; status == BW_OK && k < count; k++)
    for (int c = 0; c < 4; c++)
      outer[face[k].node[c]] = 1;
  bw_free(face);
  return status;
}

bw_status bwi_contact_create(bw_context *context, const bw_load_case *load_case,
                             const double *blocks, bwi_contact **out) {
  bw_status status = BW_OK;
  const bw_grid *grid = load_case->grid;
  int64_t max = 0, terms = 0;
  uint8_t *outer = NULL;
  bwi_contact *c = NULL;
  if (load_case->contact_plane_count == 0)
    return BW_OK;
  for (int f = 0; f < load_case->contact_plane_count; f++) {
    const bw_embedding *embedding = load_case->contact_plane[f].embedding;
    int64_t points = embedding ? embedding->point_count : grid->node_count;
    max += points;
    terms += embedding ? 8 * points : points;
  }
  c = BW_NEW0(context, bwi_contact, 1);
  outer = BW_NEW0(context, uint8_t, grid->node_count);
  BW_TRY_MEMORY(c && outer);
  c->load_case = load_case;
  c->plane = BW_NEW(context, int32_t, max);
  c->rest = BW_NEW(context, double, max);
  c->start = BW_NEW0(context, int64_t, max + 1);
  c->node = BW_NEW(context, int32_t, terms);
  c->weight = BW_NEW(context, double, terms);
  c->stiffness = BW_NEW(context, double, max);
  c->force = BW_NEW0(context, double, max);
  c->gap = BW_NEW0(context, double, max);
  c->multiplier = BW_NEW0(context, double, max);
  c->pushes = BW_NEW0(context, uint8_t, max);
  c->offset = BW_NEW0(context, double, load_case->contact_plane_count);
  c->shift = BW_NEW0(context, double, load_case->contact_plane_count);
  BW_TRY_MEMORY(c->plane && c->rest && c->start && c->node && c->weight && c->stiffness &&
                c->force && c->gap && c->multiplier && c->pushes && c->offset && c->shift);
  BW_TRY(mark_boundary(context, grid, outer));
  for (int f = 0; f < load_case->contact_plane_count; f++) {
    const bw_embedding *e = load_case->contact_plane[f].embedding;
    for (int64_t p = 0; e && p < e->point_count; p++)
      append(c, f, load_case->contact_plane[f].rest + 3 * p, 8,
             grid->element + 8 * (int64_t)e->element[p], e->weight + 8 * p, blocks);
    for (int32_t n = 0; !e && n < grid->node_count; n++) {
      const double one = 1;
      double at[3];
      if (!outer[n])
        continue;
      bw_grid_position(grid, n, at);
      append(c, f, at, 1, &n, &one, blocks);
    }
  }
  *out = c;
  c = NULL;
done:
  bwi_contact_destroy(c);
  bw_free(outer);
  return status;
}

void bwi_contact_place(bwi_contact *c, double load, bool moved) {
  for (int f = 0; f < c->load_case->contact_plane_count; f++) {
    const bw_contact_plane *plane = &c->load_case->contact_plane[f];
    c->offset[f] =
        (moved ? 1 : load) * bw_dot(plane->move, plane->normal) - (1 - load) * c->shift[f];
  }
}

static double displacement(const bwi_contact *c, int64_t p, const double *u) {
  const double *normal = c->load_case->contact_plane[c->plane[p]].normal;
  double sum = 0;
  for (int64_t k = c->start[p]; k < c->start[p + 1]; k++)
    sum += c->weight[k] * bw_dot(normal, u + 3 * (int64_t)c->node[k]);
  return sum;
}

static void add(const bwi_contact *c, int64_t p, double size, double *v) {
  const double *normal = c->load_case->contact_plane[c->plane[p]].normal;
  for (int64_t k = c->start[p]; k < c->start[p + 1]; k++)
    for (int d = 0; d < 3; d++)
      v[3 * (int64_t)c->node[k] + d] += size * c->weight[k] * normal[d];
}

void bwi_contact_begin(bwi_contact *c, const double *u) {
  memset(c->shift, 0, (size_t)c->load_case->contact_plane_count * sizeof *c->shift);
  bwi_contact_place(c, 1, true);
  for (int64_t p = 0; p < c->count; p++) {
    double gap = c->rest[p] + displacement(c, p, u) - c->offset[c->plane[p]];
    double *shift = &c->shift[c->plane[p]];
    *shift = fmax(*shift, -gap);
  }
}

int64_t bwi_contact_evaluate(bwi_contact *c, const double *u, double *energy, double *force) {
  int64_t pushing = 0;
  *energy = 0;
  for (int64_t p = 0; p < c->count; p++) {
    double stiff = c->stiffness[p], before = c->multiplier[p];
    c->gap[p] = c->rest[p] + displacement(c, p, u) - c->offset[c->plane[p]];
    double f = c->force[p] = fmax(0, before - stiff * c->gap[p]);
    *energy += (f * f - before * before) / (2 * stiff);
    c->pushes[p] = f > 0;
    if (f > 0) {
      pushing++;
      if (force)
        add(c, p, f, force);
    }
  }
  return pushing;
}

double bwi_contact_error(const bwi_contact *c) {
  double max = 0;
  for (int64_t p = 0; p < c->count; p++)
    max = fmax(max, c->force[p] > 0 ? fabs(c->gap[p]) : -c->gap[p]);
  return max;
}

void bwi_contact_settle(bwi_contact *c) {
  memcpy(c->multiplier, c->force, (size_t)c->count * sizeof *c->force);
}

/* `part` of a point's derivatives. */
static void add_stiffness(const bwi_contact *c, int64_t p, double part,
                          const bw_block_pattern *pattern, double *values) {
  const double *normal = c->load_case->contact_plane[c->plane[p]].normal;
  for (int64_t k = c->start[p]; k < c->start[p + 1]; k++)
    for (int64_t l = c->start[p]; l < c->start[p + 1]; l++) {
      if (c->node[l] > c->node[k])
        continue;
      double *block = values + 9 * bwi_block_index(pattern, c->node[k], c->node[l]);
      double size = part * c->stiffness[p] * c->weight[k] * c->weight[l];
      for (int i = 0; i < 9; i++)
        block[i] += size * normal[i / 3] * normal[i % 3];
    }
}

void bwi_contact_stiffness(const bwi_contact *c, const bw_block_pattern *pattern, double *values) {
  for (int64_t p = 0; p < c->count; p++)
    if (c->pushes[p])
      add_stiffness(c, p, 1, pattern, values);
}

int64_t bwi_contact_predict(bwi_contact *c, const double *d, const bw_block_pattern *pattern,
                            double *values) {
  int64_t changed = 0;
  for (int64_t p = 0; p < c->count; p++) {
    double gap = c->gap[p] + displacement(c, p, d);
    bool pushes = c->multiplier[p] - c->stiffness[p] * gap > 0;
    if (pushes == c->pushes[p])
      continue;
    changed++;
    c->pushes[p] = pushes;
    if (values)
      add_stiffness(c, p, pushes ? 1 : -1, pattern, values);
  }
  return changed;
}

void bwi_contact_linear(const bwi_contact *c, double *force) {
  for (int64_t p = 0; p < c->count; p++)
    if (c->pushes[p])
      add(c, p, c->multiplier[p] - c->stiffness[p] * c->gap[p], force);
}

void bwi_contact_blocks(const bwi_contact *c, double *blocks) {
  for (int64_t p = 0; p < c->count; p++) {
    if (!c->pushes[p])
      continue;
    const double *normal = c->load_case->contact_plane[c->plane[p]].normal;
    for (int64_t k = c->start[p]; k < c->start[p + 1]; k++)
      for (int i = 0; i < 9; i++)
        blocks[9 * (int64_t)c->node[k] + i] +=
            c->stiffness[p] * c->weight[k] * c->weight[k] * normal[i / 3] * normal[i % 3];
  }
}

void bwi_contact_multiply(const bwi_contact *c, const double *x, double *y) {
  for (int64_t p = 0; p < c->count; p++)
    if (c->pushes[p])
      add(c, p, c->stiffness[p] * displacement(c, p, x), y);
}

bw_status bwi_contact_coarse(bw_context *context, const bwi_contact *contact,
                             const bw_coarsening *coarsening, bwi_contact **out) {
  bwi_contact *c = BW_NEW0(context, bwi_contact, 1);
  if (!c)
    return BW_MEMORY;
  int64_t max = 8 * contact->start[contact->count];
  c->load_case = contact->load_case;
  c->count = contact->count;
  c->borrows = true;
  c->plane = contact->plane;
  c->stiffness = contact->stiffness;
  c->pushes = contact->pushes;
  c->start = BW_NEW0(context, int64_t, c->count + 1);
  c->node = BW_NEW(context, int32_t, max);
  c->weight = BW_NEW(context, double, max);
  if (!c->start || !c->node || !c->weight) {
    bwi_contact_destroy(c);
    return BW_MEMORY;
  }
  for (int64_t p = 0; p < c->count; p++) {
    int64_t end = c->start[p];
    for (int64_t k = contact->start[p]; k < contact->start[p + 1]; k++)
      for (int q = 0; q < 8; q++) {
        int32_t node = coarsening->stencil[8 * (int64_t)contact->node[k] + q];
        int64_t at = c->start[p];
        while (at < end && c->node[at] != node)
          at++;
        if (at == end) {
          c->node[end] = node;
          c->weight[end++] = 0;
        }
        c->weight[at] += contact->weight[k] / 8;
      }
    c->start[p + 1] = end;
  }
  *out = c;
  return BW_OK;
}
