/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Surfaces that lie on each other, each with nodes of its own (docs/theory/heat.md). Contact
 * resists: a flux passes in proportion to the jump of the temperature. A bond does not: the nodes
 * of one side follow those of the other. */
#include "heat/internal.h"
#include "matrix/sparse.h"
#include "model/internal.h"

#include <math.h>
#include <string.h>

enum { PAIR = 12 }; /* nodes of two quadratic facets */

static const int32_t *nodes_of(const bw_mesh *mesh, int32_t facet) {
  return mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
}

/* ---- contact --------------------------------------------------------------------------------- */

/* The sum over a pair of facets. */
typedef struct pairing {
  bw_context *context;
  const bw_mesh *mesh;
  bwi_overlaps overlaps;
  int32_t facet, other; /* the other one of `with`, or -1: no sum */
  double size;          /* (m2) in contact */
  double sum[PAIR][PAIR];
  bwi_entries entries;
} pairing;

static bw_status flush(pairing *p) {
  bw_status status = BW_OK;
  const int n = p->mesh->nodes_per_facet;
  int32_t node[PAIR];
  if (p->other < 0)
    return BW_OK;
  memcpy(node, nodes_of(p->mesh, p->facet), (size_t)n * sizeof *node);
  memcpy(node + n, nodes_of(p->mesh, p->other), (size_t)n * sizeof *node);
  for (int a = 0; a < 2 * n; a++)
    for (int b = 0; b < 2 * n; b++)
      BW_TRY(bwi_entries_add(p->context, &p->entries, node[a], node[b], p->sum[a][b]));
  memset(p->sum, 0, sizeof p->sum);
  p->other = -1;
done:
  return status;
}

/* Adds a point; its weight is that of the curved facet. */
static bw_status add_point(void *data, const bwi_overlap_point *point) {
  bw_status status = BW_OK;
  pairing *p = data;
  const int n = p->mesh->nodes_per_facet;
  double jump[PAIR], normal[3];
  if (p->other != point->facet)
    BW_TRY(flush(p));
  p->other = point->facet;
  bwi_boundary_normal(p->mesh, p->facet, point->at, normal);
  double weight = point->weight * bw_norm(normal) / (2 * p->overlaps.area);
  bw_facet_shape(p->mesh->order, point->at, jump);
  bw_facet_shape(p->mesh->order, point->other_at, jump + n);
  for (int a = 0; a < n; a++)
    jump[n + a] = -jump[n + a];
  for (int a = 0; a < 2 * n; a++)
    for (int b = 0; b < 2 * n; b++)
      p->sum[a][b] += weight * (jump[a] * jump[b]);
  p->size += weight;
done:
  return status;
}

bw_status bwi_heat_pair(bw_context *context, const bw_mesh *mesh, bw_heat_condition *condition) {
  bw_status status = BW_OK;
  pairing p = {.context = context, .mesh = mesh, .other = -1};
  BW_TRY(bwi_overlaps_open(context, condition->on, condition->with,
                           condition->gap > 0 ? condition->gap : -1, "contact, which joins",
                           &p.overlaps));
  for (int32_t f = 0; f < condition->on->facet_count; f++) {
    if (f % 256 == 0)
      BW_TRY(bw_check_cancel(context));
    p.facet = condition->on->facet[f];
    BW_TRY(bwi_overlaps_of(&p.overlaps, p.facet, add_point, &p));
    BW_TRY(flush(&p));
  }
  condition->size = p.size;
  if (!(p.size > 0))
    BW_TRY(bwi_overlaps_fail_apart(&p.overlaps, "contact"));
  BW_TRY(bwi_entries_matrix(context, &p.entries, mesh->node_count, mesh->node_count,
                            &condition->joint));
done:
  bwi_overlaps_clear(&p.overlaps);
  bwi_entries_clear(&p.entries);
  return status;
}

void bwi_heat_contact(const bw_heat_condition *condition, const double *temperature, double *in,
                      double *sum) {
  const bw_sparse_matrix *joint = condition->joint;
  const bw_selection *on = condition->on;
  *sum = 0;
  for (int32_t i = 0, k = 0; i < joint->rows; i++) {
    double heat = 0;
    for (int64_t e = joint->start[i]; e < joint->start[i + 1]; e++)
      heat -= condition->coefficient * joint->value[e] *
              (temperature[joint->column[e]] - temperature[i]); /* a row sums to 0 */
    in[i] += heat;
    while (k < on->node_count && on->node[k] < i)
      k++;
    if (k < on->node_count && on->node[k] == i)
      *sum += heat;
  }
}

bw_status bwi_heat_join(bw_context *context, const bw_block_pattern *pattern,
                        const bw_heat_condition *condition, double *values, bwi_entries *cross) {
  bw_status status = BW_OK;
  const bw_sparse_matrix *joint = condition->joint;
  for (int32_t i = 0; i < joint->rows; i++)
    for (int64_t e = joint->start[i]; e < joint->start[i + 1]; e++) {
      int32_t j = joint->column[e];
      double value = condition->coefficient * joint->value[e];
      int64_t block = bwi_heat_block(pattern, i, j);
      if (pattern->column[block] != (i > j ? j : i))
        BW_TRY(bwi_entries_add(context, cross, i, j, value));
      else if (j <= i)
        values[block] += value;
    }
done:
  return status;
}

/* ---- bonds ----------------------------------------------------------------------------------- */

/* Each node follows in one bond, and none that follows itself. */
static bw_status check_bond(bw_context *context, const bw_heat *heat, const bw_bond *bond) {
  bw_status status = BW_OK;
  uint8_t *follows = BW_NEW0(context, uint8_t, heat->mesh->node_count);
  uint8_t *followed = BW_NEW0(context, uint8_t, heat->mesh->node_count);
  BW_TRY_MEMORY(follows && followed);
  for (int c = 0; c <= heat->condition_count; c++) {
    const bw_bond *b = c < heat->condition_count ? heat->condition[c].bond : bond;
    for (int32_t i = 0; b && i < b->node_count; i++) {
      if (follows[b->node[i]])
        BW_TRY(
            bwi_fail_node(context, heat->mesh, b->node[i], BW_INVALID,
                          "follows others in two bonds: let its side be b in one of them, or leave "
                          "the facets around it out"));
      follows[b->node[i]] = 1;
    }
    for (int64_t e = 0; b && e < b->follows->start[b->node_count]; e++)
      followed[b->follows->column[e]] = 1;
  }
  for (int32_t i = 0; i < heat->mesh->node_count; i++)
    if (follows[i] && followed[i])
      BW_TRY(
          bwi_fail_node(context, heat->mesh, i, BW_INVALID,
                        "is followed in one bond and follows others in another: give the sides of "
                        "one of these bonds the other way round"));
done:
  bw_free(follows);
  bw_free(followed);
  return status;
}

bw_status bwi_heat_bond(bw_context *context, const bw_heat *heat, bw_heat_condition *condition) {
  bw_status status = BW_OK;
  bw_bond *bond = BW_NEW0(context, bw_bond, 1);
  BW_TRY_MEMORY(bond);
  status = bwi_bond_make(context, condition->on, condition->with,
                         condition->gap > 0 ? condition->gap : -1, bond);
  if (status != BW_OK) {
    bw_free(bond);
    goto done;
  }
  condition->bond = bond;
  condition->size = bond->area;
  BW_TRY(check_bond(context, heat, bond));
done:
  return status;
}

void bwi_heat_unpair(bw_heat_condition *condition) {
  bw_release(condition->joint);
  if (condition->bond)
    bwi_bond_clear(condition->bond);
  bw_free(condition->bond);
  condition->joint = NULL;
  condition->bond = NULL;
}
