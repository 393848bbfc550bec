/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The pressure basis: nodal forces of a pressure that is linear over every boundary facet, or
 * constant on cells of facets.
 *
 * Pressure pushes inwards: the traction is -p n. With p = sum_i p_i L_i over a facet (L_i a
 * barycentric coordinate, or one on a cell) and displacement shape functions phi_a, the consistent
 * force on node a is -sum_i p_i integral of L_i phi_a n dA. It is integrated exactly. On flat
 * facets the means of L_i phi_a are the same for all that are divided alike.
 *
 * Invariant: columns are by ascending mesh node, or facet, the rows within a column ascend too, and
 * every row of a column belongs to the same body. Since the shape functions add up to one and
 * reproduce rigid-body motions, a uniform pressure over a closed boundary has no resultant and no
 * moment.
 *
 * Facets that are cuts have no pressure, and are left out of the columns of their nodes.
 *
 * Nodes of forbidden facets, or their cells, have no column: the pressures that are left are those
 * of the whole boundary that are zero there, so that forbidding more never admits another load. */
#include "analysis/pressure.h"
#include "analysis/load_program.h"

#include <math.h>
#include <string.h>

static bool is_straight(const double (*x)[3]) {
  for (int k = 0; k < 3; k++) {
    const double *a = x[k], *b = x[(k + 1) % 3], *middle = x[3 + k];
    double off = 0, length = 0;
    for (int i = 0; i < 3; i++) {
      double d = middle[i] - 0.5 * (a[i] + b[i]), e = b[i] - a[i];
      off += d * d;
      length += e * e;
    }
    if (off > 1e-18 * length)
      return false;
  }
  return true;
}

/* force[i][a]: on facet node a by a unit of pressure i; area[i] the integral of its function. */
static void flat_facet(const bwi_pressure_rule *rule, int nodes, const double (*x)[3],
                       double (*force)[6][3], double *area) {
  double ab[3], ac[3], s[3];
  for (int i = 0; i < 3; i++) {
    ab[i] = x[1][i] - x[0][i];
    ac[i] = x[2][i] - x[0][i];
  }
  bw_cross(ab, ac, s);
  double size = 0.5 * bw_norm(s);
  for (int i = 0; i < rule->pressures; i++) {
    area[i] = size * rule->area[i];
    for (int a = 0; a < nodes; a++)
      for (int k = 0; k < 3; k++)
        force[i][a][k] = -0.5 * s[k] * rule->force[i][a];
  }
}

static void curved_facet(const bwi_pressure_rule *rule, const double (*x)[3], double (*force)[6][3],
                         double *area) {
  memset(force, 0, (size_t)rule->pressures * sizeof *force);
  memset(area, 0, (size_t)rule->pressures * sizeof *area);
  for (int q = 0; q < rule->points; q++) {
    double s[3], shape[6];
    bwi_area_vector(x, rule->barycentric[q], s); /* n dA is half of it times the weight */
    bw_facet_shape(2, rule->barycentric[q], shape);
    for (int j = rule->per_point * q; j < rule->per_point * (q + 1); j++) {
      int i = rule->which[j];
      double w = 0.5 * rule->weight[q] * rule->value[j];
      area[i] += w * bw_norm(s);
      for (int a = 0; a < 6; a++)
        for (int k = 0; k < 3; k++)
          force[i][a][k] -= w * shape[a] * s[k];
    }
  }
}

static void facet_forces(const bwi_pressure_rule *rule, const bw_mesh *mesh, int32_t facet,
                         double (*force)[6][3], double *area) {
  int nodes = mesh->nodes_per_facet;
  double x[6][3] = {{0}};
  const int32_t *node = mesh->facet + (size_t)facet * (size_t)nodes;
  for (int a = 0; a < nodes; a++)
    memcpy(x[a], mesh->node + 3 * (size_t)node[a], sizeof x[a]);
  if (nodes == 6 && !is_straight((const double(*)[3])x))
    curved_facet(rule, (const double(*)[3])x, force, area);
  else
    flat_facet(rule, nodes, (const double(*)[3])x, force, area);
}

/* Where row `node` stands in the column that begins at `begin` and has `*count` rows so far: rows
 * are kept ascending by insertion, columns being short. */
static int64_t find_row(bw_pressure_basis *basis, int64_t begin, int32_t *count, int32_t node) {
  int64_t at = begin, end = begin + *count;
  while (at < end && basis->row[at] < node)
    at++;
  if (at < end && basis->row[at] == node)
    return at;
  memmove(basis->row + at + 1, basis->row + at, (size_t)(end - at) * sizeof *basis->row);
  memmove(basis->coefficient + 3 * (at + 1), basis->coefficient + 3 * at,
          (size_t)(end - at) * 3 * sizeof *basis->coefficient);
  basis->row[at] = node;
  memset(basis->coefficient + 3 * at, 0, 3 * sizeof *basis->coefficient);
  ++*count;
  return at;
}

/* How many parts the edges of each facet are divided into. */
static void divide_facets(const bw_mesh *mesh, double spacing, uint8_t *parts) {
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
    double longest = 0;
    for (int i = 0; i < 3; i++) {
      double edge[3];
      for (int k = 0; k < 3; k++)
        edge[k] = mesh->node[3 * (size_t)node[i] + (size_t)k] -
                  mesh->node[3 * (size_t)node[(i + 1) % 3] + (size_t)k];
      longest = fmax(longest, bw_norm(edge));
    }
    parts[f] = spacing > 0 ? (uint8_t)fmin(BWI_MAX_PARTS, fmax(1, ceil(longest / spacing))) : 0;
  }
}

/* Facets without a pressure. */
static void close_facets(const bw_selection *on, bw_pressure_basis *basis) {
  for (int32_t k = 0; on && k < on->facet_count; k++) {
    int64_t f = on->facet[k];
    for (int64_t i = basis->facet_start[f]; i < basis->facet_start[f + 1]; i++)
      basis->facet_column[i] = -1;
  }
}

/* Corner nodes that may be pressed, ascending: their columns into facet_column. */
static bw_status number_nodes(bw_context *context, const bw_pressure_options *options,
                              bw_pressure_basis *basis) {
  const bw_selection *forbidden = options->forbidden, *cuts = options->cuts;
  bw_status status = BW_OK;
  const bw_mesh *mesh = basis->mesh;
  size_t nodes = (size_t)mesh->nodes_per_facet, count = 0;
  int32_t *facets = BW_NEW0(context, int32_t, mesh->node_count);
  BW_TRY_MEMORY(facets);
  for (size_t f = 0; f < (size_t)mesh->facet_count; f++)
    for (size_t i = 0; i < 3; i++)
      facets[mesh->facet[f * nodes + i]]++;
  for (int32_t k = 0; cuts && k < cuts->facet_count; k++)
    for (size_t i = 0; i < 3; i++)
      facets[mesh->facet[(size_t)cuts->facet[k] * nodes + i]]--;
  for (int32_t k = 0; forbidden && k < forbidden->node_count; k++)
    facets[forbidden->node[k]] = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    count += facets[i] > 0;
  basis->node = BW_NEW(context, int32_t, count);
  basis->start = BW_NEW(context, int64_t, count + 1);
  BW_TRY_MEMORY(basis->node && basis->start);
  /* Room for every row as if no two facets shared one, tightened later. */
  basis->start[0] = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    int32_t here = facets[i];
    facets[i] = -1;
    if (here == 0)
      continue;
    facets[i] = basis->count;
    basis->node[basis->count++] = i;
    basis->start[basis->count] = basis->start[basis->count - 1] + (int64_t)here * (int64_t)nodes;
  }
  for (size_t f = 0; f < (size_t)mesh->facet_count; f++)
    for (size_t i = 0; i < 3; i++)
      basis->facet_column[3 * f + i] = facets[mesh->facet[f * nodes + i]];
  close_facets(cuts, basis);
done:
  bw_free(facets);
  return status;
}

/* Cells of the facets that may be pressed, facet after facet. */
static bw_status number_cells(bw_context *context, const bw_pressure_options *options,
                              const bwi_pressure_rules *rules, bw_pressure_basis *basis) {
  const bw_mesh *mesh = basis->mesh;
  size_t nodes = (size_t)mesh->nodes_per_facet;
  int64_t count = basis->facet_start[mesh->facet_count];
  memset(basis->facet_column, 0, (size_t)count * sizeof *basis->facet_column);
  close_facets(options->forbidden, basis);
  close_facets(options->cuts, basis);
  basis->node = BW_NEW(context, int32_t, count);
  basis->start = BW_NEW(context, int64_t, (size_t)count + 1);
  if (!basis->node || !basis->start)
    return BW_MEMORY;
  basis->start[0] = 0;
  for (int32_t f = 0; f < mesh->facet_count; f++)
    for (int64_t i = basis->facet_start[f]; i < basis->facet_start[f + 1]; i++) {
      if (basis->facet_column[i] < 0)
        continue;
      const bwi_pressure_rule *rule = bwi_facet_rule(rules, basis, f);
      int nearest = rule->nearest[i - basis->facet_start[f]];
      basis->facet_column[i] = basis->count;
      basis->node[basis->count++] = mesh->facet[(size_t)f * nodes + (size_t)nearest];
      basis->start[basis->count] = basis->start[basis->count - 1] + (int64_t)nodes;
    }
  return BW_OK;
}

/* Facets, their pressures and the columns of these. */
static bw_status number_columns(bw_context *context, const bw_pressure_options *options,
                                bwi_pressure_rules *rules, bw_pressure_basis *basis) {
  const bw_mesh *mesh = basis->mesh;
  int64_t pressures = 0;
  basis->parts = BW_NEW(context, uint8_t, mesh->facet_count);
  basis->facet_start = BW_NEW(context, int64_t, (size_t)mesh->facet_count + 1);
  if (!basis->parts || !basis->facet_start)
    return BW_MEMORY;
  divide_facets(mesh, options->spacing, basis->parts);
  bw_status status = bwi_pressure_rules_create(context, basis, rules);
  if (status != BW_OK)
    return status;
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    basis->facet_start[f] = pressures;
    pressures += bwi_facet_rule(rules, basis, f)->pressures;
  }
  basis->facet_start[mesh->facet_count] = pressures;
  if (options->spacing > 0 && pressures >= INT32_MAX)
    return bw_fail(context, BW_UNSUPPORTED,
                   "a spacing of %g m divides the boundary into %.3g cells: give a larger one",
                   options->spacing, (double)pressures);
  basis->facet_column = BW_NEW(context, int32_t, pressures);
  if (!basis->facet_column)
    return BW_MEMORY;
  return options->spacing > 0 ? number_cells(context, options, rules, basis)
                              : number_nodes(context, options, basis);
}

static bw_status check_options(bw_context *context, const bw_mesh *mesh,
                               const bw_pressure_options *options) {
  const bw_selection *forbidden = options->forbidden;
  if (options->cuts && options->cuts->mesh != mesh)
    return bw_fail(context, BW_INVALID,
                   "the cuts are selected on another mesh than the one to be pressed");
  if (forbidden && forbidden->mesh != mesh)
    return bw_fail(context, BW_INVALID,
                   "the forbidden surface is selected on another mesh than the one to be pressed");
  if (forbidden && forbidden->facet_count == 0)
    return bw_fail(context, BW_EMPTY,
                   "the forbidden surface covers no facet: give a selection of facets");
  if (!(options->spacing >= 0 && isfinite(options->spacing)))
    return bw_fail(context, BW_INVALID,
                   "pressures with a spacing of %g m: give a length, or 0 for pressures at corners",
                   options->spacing);
  if (!(options->friction >= 0 && options->friction <= 100))
    return bw_fail(context, BW_INVALID, "the coefficient of friction is %g: give from 0 to 100",
                   options->friction);
  if (options->friction > 0 &&
      (options->friction_facets < 3 || options->friction_facets > BW_MAX_FRICTION_FACETS))
    return bw_fail(context, BW_INVALID, "a friction cone of %d facets: give from 3 to %d",
                   options->friction_facets, BW_MAX_FRICTION_FACETS);
  return BW_OK;
}

static void set_place(const bw_mesh *mesh, const int32_t *node, const double l[3], double at[3]) {
  for (size_t k = 0; k < 3; k++)
    at[k] = l[0] * mesh->node[3 * (size_t)node[0] + k] +
            l[1] * mesh->node[3 * (size_t)node[1] + k] + l[2] * mesh->node[3 * (size_t)node[2] + k];
}

bw_status bw_pressure_basis_create(bw_context *context, const bw_mesh *mesh,
                                   const bw_pressure_options *given, bw_pressure_basis **result) {
  bw_pressure_basis *basis;
  bwi_pressure_rules rules;
  int32_t *filled = NULL;
  int nodes = mesh->nodes_per_facet;
  const bw_pressure_options plainest = {.friction = 0}, *options = given ? given : &plainest;
  memset(&rules, 0, sizeof rules);
  bw_status status = check_options(context, mesh, options);
  if (status == BW_OK)
    status = bwi_pressure_basis_empty(context, mesh, &basis);
  if (status != BW_OK)
    return status;
  basis->complete = !options->forbidden && !options->cuts;
  basis->directions = 1;
  BW_TRY(number_columns(context, options, &rules, basis));
  int32_t count = basis->count;
  if (count == 0)
    BW_TRY(bw_fail(
        context, BW_EMPTY, "the %s whole boundary: no admissible surface is left for pressures",
        options->cuts ? "forbidden surface and cuts are the" : "forbidden surface is the"));
  basis->at = BW_NEW0(context, double, 3 * (size_t)count);
  basis->area = BW_NEW0(context, double, count);
  basis->row = BW_NEW(context, int32_t, basis->start[count]);
  basis->coefficient = BW_NEW(context, double, 3 * basis->start[count]);
  filled = BW_NEW0(context, int32_t, count);
  BW_TRY_MEMORY(basis->at && basis->area && basis->row && basis->coefficient && filled);

  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + (size_t)f * (size_t)nodes;
    const bwi_pressure_rule *rule = bwi_facet_rule(&rules, basis, f);
    double force[BWI_MAX_PRESSURES][6][3], area[BWI_MAX_PRESSURES];
    facet_forces(rule, mesh, f, force, area);
    for (int i = 0; i < rule->pressures; i++) {
      int32_t j = basis->facet_column[basis->facet_start[f] + i];
      if (j < 0)
        continue;
      basis->area[j] += area[i];
      set_place(mesh, node, rule->middle[i], basis->at + 3 * (size_t)j);
      for (int a = 0; a < nodes; a++) {
        double *to = basis->coefficient + 3 * find_row(basis, basis->start[j], &filled[j], node[a]);
        for (int k = 0; k < 3; k++)
          to[k] += force[i][a][k];
      }
    }
  }

  int64_t end = 0;
  for (int32_t j = 0; j < count; j++) {
    int64_t from = basis->start[j];
    memmove(basis->row + end, basis->row + from, (size_t)filled[j] * sizeof *basis->row);
    memmove(basis->coefficient + 3 * end, basis->coefficient + 3 * from,
            (size_t)filled[j] * 3 * sizeof *basis->coefficient);
    basis->start[j] = end;
    end += filled[j];
  }
  basis->start[count] = end;
  if (options->friction > 0) {
    bw_pressure_basis *plain = basis;
    basis = NULL;
    status = bwi_pressure_with_friction(context, plain, options, &basis);
    bw_release(plain);
  }
done:
  bwi_pressure_rules_clear(&rules);
  bw_free(filled);
  if (status == BW_OK)
    *result = basis;
  else
    bw_release(basis);
  return status;
}
