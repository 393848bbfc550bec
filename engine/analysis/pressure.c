/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The pressure basis: nodal forces of a pressure that is linear over every boundary facet.
 *
 * Pressure pushes inwards: the traction is -p n. With p = sum_i p_i L_i over a facet (L_i its
 * barycentric coordinates) and displacement shape functions phi_a, the consistent force on node a
 * is -sum_i p_i integral of L_i phi_a n dA. Flat facets have closed forms; curved ones are
 * integrated exactly (the integrand is a polynomial of degree 5 at most).
 *
 * Invariant: columns are by ascending mesh node, the rows within a column ascend too, and every
 * row of a column belongs to the same body. Since the shape functions add up to one and reproduce
 * rigid motions, a uniform pressure over a closed boundary has no resultant and no moment.
 *
 * Nodes of forbidden facets have no column: the pressures that are left are those of the whole
 * boundary that are zero there, so that forbidding more never admits another load. */
#include "analysis/programme.h"

#include <math.h>
#include <string.h>

static void basis_destroy(void *object) {
  bw_pressure_basis *basis = (bw_pressure_basis *)object;
  bw_release(basis->mesh);
  bw_free(basis->node);
  bw_free(basis->area);
  bw_free(basis->start);
  bw_free(basis->row);
  bw_free(basis->coefficient);
  bw_free(basis);
}

static size_t basis_bytes(const void *object) {
  const bw_pressure_basis *basis = (const bw_pressure_basis *)object;
  size_t entries = basis->start ? (size_t)basis->start[basis->count] : 0;
  return sizeof *basis + (size_t)basis->count * 20 + 8 + entries * 28;
}

static const bw_kind basis_kind = {"pressure basis", basis_destroy, basis_bytes};

bw_status bwi_pressure_basis_empty(bw_context *context, const bw_mesh *mesh,
                                   bw_pressure_basis **basis) {
  *basis = BW_NEW0(context, bw_pressure_basis, 1);
  if (!*basis)
    return BW_MEMORY;
  bw_object_init(*basis, &basis_kind);
  (*basis)->mesh = (const bw_mesh *)bw_retain(mesh);
  return BW_OK;
}

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

/* force[i][a]: on facet node a by a unit pressure at corner i; area[i] the integral of L_i. */
static void flat_facet(int nodes, const double (*x)[3], double force[3][6][3], double area[3]) {
  /* Times the area: integrals of L_i phi_a; first index equal to or unlike a corner, on or off the
   * edge of a middle node. */
  static const double linear[2] = {1.0 / 6, 1.0 / 12};
  static const double corner[2] = {1.0 / 30, -1.0 / 60};
  static const double middle[2] = {2.0 / 15, 1.0 / 15};
  double ab[3], ac[3], s[3];
  for (int i = 0; i < 3; i++) {
    ab[i] = x[1][i] - x[0][i];
    ac[i] = x[2][i] - x[0][i];
  }
  bw_cross(ab, ac, s);
  double size = 0.5 * bw_norm(s);
  for (int i = 0; i < 3; i++) {
    area[i] = size / 3;
    for (int a = 0; a < nodes; a++) {
      double share;
      if (nodes == 3)
        share = linear[a != i];
      else if (a < 3)
        share = corner[a != i];
      else
        share = middle[i != a - 3 && i != (a - 2) % 3];
      for (int k = 0; k < 3; k++)
        force[i][a][k] = -0.5 * s[k] * share;
    }
  }
}

void bwi_area_vector(const double (*x)[3], const double l[3], double normal[3]) {
  /* Derivatives of the six functions by L0, L1, L2, then along the two edges from corner 0. */
  const double by[6][3] = {{4 * l[0] - 1, 0, 0},    {0, 4 * l[1] - 1, 0},
                           {0, 0, 4 * l[2] - 1},    {4 * l[1], 4 * l[0], 0},
                           {0, 4 * l[2], 4 * l[1]}, {4 * l[2], 0, 4 * l[0]}};
  double u[3] = {0, 0, 0}, v[3] = {0, 0, 0};
  for (int a = 0; a < 6; a++)
    for (int k = 0; k < 3; k++) {
      u[k] += (by[a][1] - by[a][0]) * x[a][k];
      v[k] += (by[a][2] - by[a][0]) * x[a][k];
    }
  bw_cross(u, v, normal);
}

static void curved_facet(const double (*x)[3], double force[3][6][3], double area[3]) {
  double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  int points = bw_triangle_quadrature(6, point, weight);
  memset(force, 0, 3 * sizeof *force);
  memset(area, 0, 3 * sizeof *area);
  for (int q = 0; q < points; q++) {
    const double *l = point[q];
    double s[3], shape[6];
    bwi_area_vector(x, l, s); /* n dA is half of it times the weight */
    bw_facet_shape(2, l, shape);
    for (int i = 0; i < 3; i++) {
      double w = 0.5 * weight[q] * l[i];
      area[i] += w * bw_norm(s);
      for (int a = 0; a < 6; a++)
        for (int k = 0; k < 3; k++)
          force[i][a][k] -= w * shape[a] * s[k];
    }
  }
}

static void facet_forces(const bw_mesh *mesh, int32_t facet, double force[3][6][3],
                         double area[3]) {
  int nodes = mesh->nodes_per_facet;
  double x[6][3] = {{0}};
  const int32_t *node = mesh->facet + (size_t)facet * (size_t)nodes;
  for (int a = 0; a < nodes; a++)
    memcpy(x[a], mesh->node + 3 * (size_t)node[a], sizeof x[a]);
  if (nodes == 6 && !is_straight((const double(*)[3])x))
    curved_facet((const double(*)[3])x, force, area);
  else
    flat_facet(nodes, (const double(*)[3])x, force, area);
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

/* The boundary facets of each corner node that may be pressed, 0 for all other nodes. */
static void count_facets(const bw_mesh *mesh, const bw_selection *forbidden, int32_t *facets) {
  size_t nodes = (size_t)mesh->nodes_per_facet;
  memset(facets, 0, (size_t)mesh->node_count * sizeof *facets);
  for (size_t f = 0; f < (size_t)mesh->facet_count; f++)
    for (size_t i = 0; i < 3; i++)
      facets[mesh->facet[f * nodes + i]]++;
  for (int32_t k = 0; forbidden && k < forbidden->node_count; k++)
    facets[forbidden->node[k]] = 0;
}

static bw_status check_options(bw_context *context, const bw_mesh *mesh,
                               const bw_pressure_options *options) {
  const bw_selection *forbidden = options->forbidden;
  if (forbidden && forbidden->mesh != mesh)
    return bw_fail(context, BW_INVALID,
                   "the forbidden surface is selected on another mesh than the one to be pressed");
  if (forbidden && forbidden->facet_count == 0)
    return bw_fail(context, BW_EMPTY,
                   "the forbidden surface covers no facet: give a selection of facets");
  if (!(options->friction >= 0 && options->friction <= 100))
    return bw_fail(context, BW_INVALID, "the coefficient of friction is %g: give from 0 to 100",
                   options->friction);
  if (options->friction > 0 &&
      (options->friction_facets < 3 || options->friction_facets > BW_MOST_FRICTION_FACETS))
    return bw_fail(context, BW_INVALID, "a friction cone of %d facets: give from 3 to %d",
                   options->friction_facets, BW_MOST_FRICTION_FACETS);
  return BW_OK;
}

bw_status bw_pressure_basis_create(bw_context *context, const bw_mesh *mesh,
                                   const bw_pressure_options *options, bw_pressure_basis **result) {
  bw_pressure_basis *basis;
  int32_t *column = NULL, *filled = NULL;
  int nodes = mesh->nodes_per_facet;
  const bw_selection *forbidden = options ? options->forbidden : NULL;
  bw_status status = options ? check_options(context, mesh, options) : BW_OK;
  if (status == BW_OK)
    status = bwi_pressure_basis_empty(context, mesh, &basis);
  if (status != BW_OK)
    return status;
  basis->complete = !forbidden;
  basis->directions = 1;

  /* Columns: corners of boundary facets, ascending. */
  column = BW_NEW(context, int32_t, mesh->node_count);
  if (!column) {
    status = BW_MEMORY;
    goto done;
  }
  count_facets(mesh, forbidden, column);
  int32_t count = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    count += column[i] > 0;
  if (count == 0) {
    status = bw_fail(context, BW_EMPTY,
                     "the forbidden surface holds every node of the boundary: no surface is left "
                     "on which pressure may act");
    goto done;
  }
  basis->node = BW_NEW(context, int32_t, count);
  basis->area = BW_NEW0(context, double, count);
  basis->start = BW_NEW0(context, int64_t, (size_t)count + 1);
  filled = BW_NEW0(context, int32_t, count);
  if (!basis->node || !basis->area || !basis->start || !filled) {
    status = BW_MEMORY;
    goto done;
  }
  /* Room for every row as if no two facets shared one, tightened below. */
  int64_t room = 0;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    int32_t facets = column[i];
    column[i] = -1;
    if (facets == 0)
      continue;
    column[i] = basis->count;
    basis->node[basis->count] = i;
    basis->start[basis->count++] = room;
    room += (int64_t)facets * nodes;
  }
  basis->start[count] = room;
  basis->row = BW_NEW(context, int32_t, room);
  basis->coefficient = BW_NEW(context, double, 3 * room);
  if (!basis->row || !basis->coefficient) {
    status = BW_MEMORY;
    goto done;
  }

  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + (size_t)f * (size_t)nodes;
    double force[3][6][3], area[3];
    facet_forces(mesh, f, force, area);
    for (int i = 0; i < 3; i++) {
      int32_t j = column[node[i]];
      if (j < 0)
        continue;
      basis->area[j] += area[i];
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
  if (options && options->friction > 0) {
    bw_pressure_basis *plain = basis;
    basis = NULL;
    status = bwi_pressure_with_friction(context, plain, options, &basis);
    bw_release(plain);
  }
done:
  bw_free(column);
  bw_free(filled);
  if (status == BW_OK)
    *result = basis;
  else
    bw_release(basis);
  return status;
}

void bw_pressure_force(const bw_pressure_basis *basis, const double *pressure, double *force) {
  memset(force, 0, 3 * (size_t)basis->mesh->node_count * sizeof *force);
  for (int32_t j = 0; j < basis->count; j++) {
    double p = pressure[j];
    if (p == 0)
      continue;
    for (int64_t k = basis->start[j]; k < basis->start[j + 1]; k++) {
      double *to = force + 3 * (size_t)basis->row[k];
      const double *c = basis->coefficient + 3 * k;
      to[0] += p * c[0];
      to[1] += p * c[1];
      to[2] += p * c[2];
    }
  }
}

void bw_pressure_gradient(const bw_pressure_basis *basis, const double *q, double *f) {
  for (int32_t j = 0; j < basis->count; j++) {
    double sum = 0;
    for (int64_t k = basis->start[j]; k < basis->start[j + 1]; k++)
      sum += bw_dot(basis->coefficient + 3 * k, q + 3 * (size_t)basis->row[k]);
    f[j] = sum;
  }
}
