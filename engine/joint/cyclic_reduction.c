/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The displacements u = T x + g of a sector in a wheel with so many nodal diameters: the high face
 * follows the low one, turned and with a phase, and nodes of bonds follow others
 * (docs/theory/symmetry.md). Where these are complex, rows and columns are real and imaginary
 * parts. */
#include "joint/cyclic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double global_frame[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

/* A displacement p + i q of a node that an unknown scales. */
typedef struct direction {
  double p[3], q[3];
} direction;

typedef struct builder {
  bwi_reduction *r;
  const bw_cyclic *cyclic;
  int diameter, parts;
  double turn[9], c, s; /* from low to high, and the phase */
  int32_t *first;       /* node_count + 1: the unknowns of nodes, complex ones */
  int64_t count;        /* of entries */
  int32_t *row, *column;
  double *value;
} builder;

static int compare_indices(const void *a, const void *b) {
  int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return x < y ? -1 : x > y;
}

/* What supports leave free of v at a node. */
static void keep_free(const bw_dof_map *dof_map, int32_t node, double v[3]) {
  int32_t f = dof_map->frame_of[node];
  const double *frame = f >= 0 ? dof_map->frame + 9 * (int64_t)f : global_frame;
  for (int k = 0; k < 3; k++) {
    double part = bw_dot(frame + 3 * k, v);
    if (dof_map->state[3 * (int64_t)node + k] == BW_DOF_PRESCRIBED)
      for (int c = 0; c < 3; c++)
        v[c] -= part * frame[3 * k + c];
  }
}

/* The same of a unit vector at a node on the axis, as one; false where that is nothing. */
static bool free_part(const bw_dof_map *dof_map, int32_t node, double v[3]) {
  keep_free(dof_map, node, v);
  double size = bw_norm(v);
  for (int c = 0; c < 3 && size > 0.5; c++)
    v[c] /= size;
  return size > 0.5;
}

/* Two unit vectors across the axis, the second one by a right angle ahead of the first. */
static void across_axis(const double axis[3], double one[3], double two[3]) {
  int least = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(axis[k]) < fabs(axis[least]))
      least = k;
  double size = sqrt(1 - axis[least] * axis[least]);
  for (int k = 0; k < 3; k++)
    one[k] = ((k == least) - axis[least] * axis[k]) / size;
  bw_cross(axis, one, two);
}

/* On the axis the displacement turns into itself: it is along the axis with no nodal diameter,
 * across it with one, and zero with more. */
static int axis_directions(const builder *b, int32_t node, direction out[3]) {
  const bw_dof_map *dof_map = b->r->dof_map;
  double one[3], two[3];
  int count = 0;
  memset(out, 0, 3 * sizeof *out);
  memcpy(out[0].p, b->cyclic->axis, sizeof out[0].p);
  if (b->diameter == 0)
    return free_part(dof_map, node, out[0].p);
  if (b->diameter > 1)
    return 0;
  across_axis(b->cyclic->axis, one, two);
  if (b->parts == 2) {
    memcpy(out[0].p, one, sizeof one);
    memcpy(out[0].q, two, sizeof two);
    return free_part(dof_map, node, one);
  }
  memcpy(out[0].p, one, sizeof one);
  count += free_part(dof_map, node, out[0].p);
  bool held = count == 0 || bw_dot(out[0].p, one) < 1 - 1e-6; /* some direction across the axis */
  if (held && count == 1)
    return 1;
  memcpy(out[count].p, two, sizeof two);
  return count + free_part(dof_map, node, out[count].p);
}

/* What the unknowns of a node, which is not of the high face and follows none in a bond, displace
 * there. */
static int own_directions(const builder *b, int32_t node, direction out[3]) {
  const bw_dof_map *dof_map = b->r->dof_map;
  int32_t f = dof_map->frame_of[node];
  const double *frame = f >= 0 ? dof_map->frame + 9 * (int64_t)f : global_frame;
  int count = 0;
  if (b->r->bond_of[node])
    return 0;
  if (b->cyclic->partner[node] == node)
    return axis_directions(b, node, out);
  for (int k = 0; k < 3; k++) {
    if (dof_map->state[3 * (int64_t)node + k] == BW_DOF_PRESCRIBED)
      continue;
    out[count] = (direction){.q = {0, 0, 0}};
    memcpy(out[count++].p, frame + 3 * k, 3 * sizeof *frame);
  }
  return count;
}

static bool is_high(const bw_cyclic *cyclic, int32_t node) {
  return cyclic->partner[node] >= 0 && cyclic->partner[node] != node;
}

static void put(builder *b, int64_t row, int32_t column, double value) {
  if (value == 0)
    return;
  if (b->row) {
    b->row[b->count] = (int32_t)row;
    b->column[b->count] = column;
    b->value[b->count] = value;
  }
  b->count++;
}

/* `factor` times what the unknowns of a node, or of its partner, displace there, at the rows of
 * node `at`: only what its supports leave free, where it is another one. */
static void add_followed(builder *b, int32_t at, int32_t node, double factor) {
  int64_t size = 3 * (int64_t)b->r->dof_map->mesh->node_count;
  bool high = is_high(b->cyclic, node);
  int32_t own = high ? b->cyclic->partner[node] : node;
  direction d[3];
  int count = own_directions(b, own, d);
  for (int k = 0; k < count; k++) {
    int32_t column = b->parts * (b->first[own] + k);
    if (high) {
      direction turned;
      bwi_rotate(b->turn, d[k].p, turned.p); /* those of the low face are real */
      for (int c = 0; c < 3; c++) {
        d[k].p[c] = b->c * turned.p[c];
        d[k].q[c] = b->s * turned.p[c];
      }
    }
    if (at != node) {
      keep_free(b->r->dof_map, at, d[k].p);
      keep_free(b->r->dof_map, at, d[k].q);
    }
    for (int c = 0; c < 3; c++) {
      int64_t row = 3 * (int64_t)at + c;
      double p = factor * d[k].p[c], q = factor * d[k].q[c];
      put(b, row, column, p);
      if (b->parts == 1)
        continue;
      put(b, row, column + 1, -q);
      put(b, size + row, column, q);
      put(b, size + row, column + 1, p);
    }
  }
}

static void add_node(builder *b, int32_t node) {
  const bw_bond *bond = b->r->bond_of[node];
  if (!bond) {
    add_followed(b, node, node, 1);
    return;
  }
  const bw_sparse_matrix *f = bond->follows;
  int32_t row = b->r->row_of[node];
  for (int64_t e = f->start[row]; e < f->start[row + 1]; e++)
    add_followed(b, node, f->column[e], f->value[e]);
}

/* Prescribed displacements are the same in all sectors. Modes have none. */
static void add_prescribed(const builder *b) {
  const bw_dof_map *dof_map = b->r->dof_map;
  if (b->diameter > 0)
    return;
  for (int32_t i = 0; i < dof_map->mesh->node_count; i++) {
    int32_t f = dof_map->frame_of[i];
    const double *frame = f >= 0 ? dof_map->frame + 9 * (int64_t)f : global_frame;
    for (int k = 0; k < 3; k++)
      for (int c = 0; c < 3; c++)
        b->r->g[3 * (int64_t)i + c] += dof_map->value[3 * (int64_t)i + k] * frame[3 * k + c];
  }
  for (int32_t i = 0; i < dof_map->mesh->node_count; i++) {
    if (!b->r->bond_of[i])
      continue;
    const bw_sparse_matrix *f = b->r->bond_of[i]->follows;
    double sum[3] = {0};
    int32_t row = b->r->row_of[i];
    for (int64_t e = f->start[row]; e < f->start[row + 1]; e++)
      for (int c = 0; c < 3; c++)
        sum[c] += f->value[e] * b->r->g[3 * (int64_t)f->column[e] + c];
    keep_free(dof_map, i, sum);
    for (int c = 0; c < 3; c++)
      b->r->g[3 * (int64_t)i + c] += sum[c];
  }
}

/* A bond that reaches the cut would go on in the next sector. */
static bw_status check_bonds(bw_context *context, const bw_model *model) {
  const bw_cyclic *cyclic = model->cyclic;
  const bw_selection *cut[2] = {cyclic->low, cyclic->high};
  for (int s = 0; s < 2; s++)
    for (int32_t i = 0; i < cut[s]->node_count; i++)
      for (int b = 0; b < model->bond_count; b++) {
        int32_t node = cut[s]->node[i], count = model->bond[b].node_count;
        if (!bsearch(&node, model->bond[b].node, (size_t)count, sizeof node, compare_indices))
          continue;
        const double *x = model->mesh->node + 3 * (int64_t)node;
        bw_fail(context, BW_UNSUPPORTED,
                "side a of bond %d meets a cut face of the sector, at node %d at (%g, %g, %g) m: a "
                "bond ends inside the sector; cut the wheel elsewhere, or join the bodies in one "
                "mesh",
                b + 1, node + 1, x[0], x[1], x[2]);
        bw_detail_number(context, "node", node + 1.0);
        return BW_UNSUPPORTED;
      }
  return BW_OK;
}

bw_status bwi_cyclic_reduction_open(bw_context *context, const bw_model *model, int diameter,
                                    bwi_reduction *r) {
  bw_status status = BW_OK;
  int32_t nodes = model->mesh->node_count;
  builder b = {.r = r, .cyclic = model->cyclic, .diameter = diameter};
  *r = (bwi_reduction){0};
  BW_TRY(bwi_cyclic_check_supports(context, model));
  BW_TRY(check_bonds(context, model));
  BW_TRY(bwi_dof_map_apart(context, model, &r->dof_map));
  BW_TRY(bwi_reduction_followers(context, model, r));
  b.parts = bwi_cyclic_parts(model->cyclic, diameter);
  bwi_cyclic_rotation(model->cyclic, 1, b.turn);
  bwi_cyclic_phase(model->cyclic, diameter, &b.c, &b.s);
  if (6 * (int64_t)nodes > INT32_MAX)
    BW_TRY(bw_fail(context, BW_LIMIT, "%d nodes are too many for cyclic symmetry", nodes));
  r->g = BW_NEW0(context, double, 3 * (int64_t)nodes * b.parts);
  b.first = BW_NEW0(context, int32_t, (int64_t)nodes + 1);
  BW_TRY_MEMORY(r->g && b.first);
  for (int32_t i = 0; i < nodes; i++) {
    direction d[3];
    b.first[i + 1] = b.first[i] + (is_high(b.cyclic, i) ? 0 : own_directions(&b, i, d));
  }
  r->unknown_count = b.parts * b.first[nodes];
  for (int32_t i = 0; i < nodes; i++)
    add_node(&b, i);
  b.row = BW_NEW(context, int32_t, b.count);
  b.column = BW_NEW(context, int32_t, b.count);
  b.value = BW_NEW(context, double, b.count);
  BW_TRY_MEMORY(b.row && b.column && b.value);
  b.count = 0;
  for (int32_t i = 0; i < nodes; i++)
    add_node(&b, i);
  add_prescribed(&b);
  BW_TRY(bw_sparse_matrix_create(context, 3 * nodes * b.parts, r->unknown_count, b.count, b.row,
                                 b.column, b.value, &r->t));
  BW_TRY(bw_sparse_matrix_create(context, r->unknown_count, 3 * nodes * b.parts, b.count, b.column,
                                 b.row, b.value, &r->transposed));
done:
  bw_free(b.first);
  bw_free(b.row);
  bw_free(b.column);
  bw_free(b.value);
  return status;
}

void bwi_cyclic_move(const bw_cyclic *cyclic, double *force) {
  double back[9];
  bwi_cyclic_rotation(cyclic, -1, back);
  for (int32_t i = 0; i < cyclic->low->mesh->node_count; i++) {
    double *at = force + 3 * (int64_t)i, moved[3];
    if (!is_high(cyclic, i))
      continue;
    bwi_rotate(back, at, moved);
    for (int k = 0; k < 3; k++) {
      force[3 * (int64_t)cyclic->partner[i] + k] += moved[k];
      at[k] = 0;
    }
  }
  for (int32_t i = 0; i < cyclic->low->mesh->node_count; i++) {
    if (cyclic->partner[i] != i)
      continue;
    double *at = force + 3 * (int64_t)i, along = bw_dot(at, cyclic->axis);
    for (int k = 0; k < 3; k++)
      at[k] = along * cyclic->axis[k];
  }
}
