/* The zero set of a function, by marching tetrahedra.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Each cube of a grid is cut into the six tetrahedra of its main diagonal, one for each order of
 * the axes, so that neighbouring cubes agree on their common faces. A tetrahedron's edges run from
 * a node of the cube to one that is higher along one, two or three axes: seven edges belong to each
 * node. The zero set crosses a tetrahedron in a triangle or in two; it can neither branch nor cut
 * itself. Points keep away from the ends of their edge by a thousandth, so that no facet vanishes.
 * Two layers of nodes are held at a time. */
#include <math.h>
#include <string.h>

#include "barwright/mesh.h"

typedef struct march {
  bw_context *context;
  double (*f)(void *data, const double at[3]);
  void *data;
  double min[3], step;
  int nodes[3]; /* along x, y, z */
  size_t layer; /* nodes in one */
  double *value[2];
  int32_t *on_edge[2]; /* 7 per node of a layer: the point on it, or -1 */
  double *point;
  size_t point_count, point_capacity;
  int32_t *triangle;
  size_t triangle_count, triangle_capacity;
} march;

static void node_at(const march *m, const int node[3], double at[3]) {
  for (int k = 0; k < 3; k++)
    at[k] = m->min[k] + m->step * node[k];
}

static size_t slot(const march *m, const int node[3]) {
  return (size_t)node[1] * (size_t)m->nodes[0] + (size_t)node[0];
}

static bw_status evaluate_layer(march *m, int z) {
  double *value = m->value[z % 2];
  for (size_t i = 0; i < 7 * m->layer; i++)
    m->on_edge[z % 2][i] = -1;
  for (int y = 0; y < m->nodes[1]; y++)
    for (int x = 0; x < m->nodes[0]; x++) {
      int node[3] = {x, y, z};
      double at[3];
      node_at(m, node, at);
      double v = m->f(m->data, at);
      if (isnan(v))
        return bw_fail(m->context, BW_GEOMETRY, "the function is not a number at (%g, %g, %g) m",
                       at[0], at[1], at[2]);
      bool rim = x == 0 || y == 0 || z == 0 || x == m->nodes[0] - 1 || y == m->nodes[1] - 1 ||
                 z == m->nodes[2] - 1;
      if (rim && v < 0)
        return bw_fail(m->context, BW_GEOMETRY,
                       "the function is %g at (%g, %g, %g) m on the surface of the box: it must be "
                       "positive there, or the shape is cut open; take a larger box",
                       v, at[0], at[1], at[2]);
      value[slot(m, node)] = v;
    }
  return bw_check_cancel(m->context);
}

/* The zero between two nodes: the secant, made better by a few steps of false position. */
static double find_zero(const march *m, const double a[3], const double b[3], double fa,
                        double fb) {
  double min = 0, max = 1, flow = fa, fhigh = fb, t = 0.5;
  for (int i = 0; i < 6; i++) {
    double weight = flow / (flow - fhigh);
    t = isfinite(weight) ? min + weight * (max - min) : 0.5 * (min + max);
    double at[3];
    for (int k = 0; k < 3; k++)
      at[k] = a[k] + t * (b[k] - a[k]);
    double v = m->f(m->data, at);
    if (!(fabs(v) > 1e-12 * (fabs(fa) + fabs(fb))))
      break;
    /* Illinois: halve the value at the end that stays, or it would hardly move */
    if ((v < 0) == (flow < 0)) {
      min = t;
      flow = v;
      fhigh *= 0.5;
    } else {
      max = t;
      fhigh = v;
      flow *= 0.5;
    }
  }
  return t < 0.001 ? 0.001 : t > 0.999 ? 0.999 : t;
}

/* The point on the edge from node `a` to the node higher along the axes in `bits`. */
static bw_status point_on(march *m, const int a[3], int bits, int32_t *number) {
  int b[3] = {a[0] + (bits & 1), a[1] + (bits >> 1 & 1), a[2] + (bits >> 2 & 1)};
  int32_t *known = &m->on_edge[a[2] % 2][7 * slot(m, a) + (size_t)bits - 1];
  if (*known < 0) {
    if (m->point_count >= INT32_MAX)
      return bw_fail(m->context, BW_LIMIT, "the surface has more than 2147483647 points");
    if (!bw_grow(m->context, (void **)&m->point, &m->point_capacity, m->point_count, 1,
                 3 * sizeof(double)))
      return BW_MEMORY;
    double xa[3], xb[3];
    node_at(m, a, xa);
    node_at(m, b, xb);
    double t = find_zero(m, xa, xb, m->value[a[2] % 2][slot(m, a)], m->value[b[2] % 2][slot(m, b)]);
    for (int k = 0; k < 3; k++)
      m->point[3 * m->point_count + (size_t)k] = xa[k] + t * (xb[k] - xa[k]);
    *known = (int32_t)m->point_count++;
  }
  *number = *known;
  return BW_OK;
}

static bw_status add_triangle(march *m, int32_t a, int32_t b, int32_t c, bool turn) {
  if (m->triangle_count >= INT32_MAX)
    return bw_fail(m->context, BW_LIMIT, "the surface has more than 2147483647 facets");
  if (!bw_grow(m->context, (void **)&m->triangle, &m->triangle_capacity, m->triangle_count, 1,
               3 * sizeof(int32_t)))
    return BW_MEMORY;
  int32_t *t = m->triangle + 3 * m->triangle_count++;
  t[0] = a;
  t[1] = turn ? c : b;
  t[2] = turn ? b : c;
  return BW_OK;
}

/* corner: the four nodes, each higher than the one before; turn: the tetrahedron is negative. */
static bw_status march_tetrahedron(march *m, int corner[4][3], const int bit[4], bool turn) {
  /* even permutations that bring one corner, or two, to the front */
  static const int first[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 0, 1, 3}, {3, 2, 1, 0}};
  static const int pair[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                 {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};
  bw_status status = BW_OK;
  int inside = 0, sum = 0;
  bool in[4];
  for (int i = 0; i < 4; i++) {
    in[i] = m->value[corner[i][2] % 2][slot(m, corner[i])] < 0;
    inside += in[i];
    sum += in[i] << i;
  }
  if (inside == 0 || inside == 4)
    return BW_OK;
  const int *order = NULL;
  if (inside == 2) {
    for (int i = 0; i < 6 && !order; i++)
      if (sum == (1 << pair[i][0] | 1 << pair[i][1]))
        order = pair[i];
  } else {
    for (int i = 0; i < 4 && !order; i++)
      if (in[i] == (inside == 1))
        order = first[i];
    turn ^= inside == 3;
  }
  /* the points: edges from the front corner(s) to the others */
  int32_t p[4];
  int count = 0;
  static const int ends[2][4][2] = {{{0, 1}, {0, 2}, {0, 3}, {0, 0}},
                                    {{0, 2}, {0, 3}, {1, 3}, {1, 2}}};
  for (; count < (inside == 2 ? 4 : 3); count++) {
    int i = order[ends[inside == 2][count][0]], j = order[ends[inside == 2][count][1]];
    int from = i < j ? i : j, to = i < j ? j : i;
    BW_TRY(point_on(m, corner[from], bit[to] ^ bit[from], &p[count]));
  }
  BW_TRY(add_triangle(m, p[0], p[1], p[2], turn));
  if (inside == 2)
    BW_TRY(add_triangle(m, p[0], p[2], p[3], turn));
done:
  return status;
}

static bw_status march_cube(march *m, const int node[3]) {
  static const int axes[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  bw_status status = BW_OK;
  for (int t = 0; t < 6; t++) {
    int corner[4][3], bit[4] = {0, 1 << axes[t][0], 1 << axes[t][0] | 1 << axes[t][1], 7};
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++)
        corner[i][k] = node[k] + (bit[i] >> k & 1);
    BW_TRY(march_tetrahedron(m, corner, bit, t >= 3));
  }
done:
  return status;
}

bw_status bw_surface_implicit(bw_context *context, const double min[3], const double max[3],
                              int cells, double (*f)(void *data, const double at[3]), void *data,
                              bw_surface **surface) {
  bw_status status = BW_OK;
  march m = {.context = context, .f = f, .data = data};
  double longest = 0;
  for (int k = 0; k < 3; k++) {
    if (!(min[k] < max[k]) || !isfinite(max[k] - min[k]))
      return bw_fail(context, BW_INVALID, "a box from %g to %g m along %c: min must lie below max",
                     min[k], max[k], "xyz"[k]);
    longest = fmax(longest, max[k] - min[k]);
  }
  if (cells < 1 || cells > 4000)
    return bw_fail(context, BW_INVALID, "%d cells along the longest side: 1 to 4000 are needed",
                   cells);
  m.step = longest / cells;
  for (int k = 0; k < 3; k++) { /* the grid may reach beyond the box, evenly at both ends */
    int count = (int)ceil((max[k] - min[k]) / m.step - 1e-9);
    m.nodes[k] = (count < 1 ? 1 : count) + 1;
    m.min[k] = 0.5 * (min[k] + max[k] - m.step * (m.nodes[k] - 1));
  }
  m.layer = (size_t)m.nodes[0] * (size_t)m.nodes[1];
  for (int i = 0; i < 2; i++) {
    m.value[i] = BW_NEW(context, double, m.layer);
    m.on_edge[i] = BW_NEW(context, int32_t, 7 * m.layer);
    BW_TRY_MEMORY(m.value[i] && m.on_edge[i]);
  }
  BW_TRY(evaluate_layer(&m, 0));
  for (int z = 0; z + 1 < m.nodes[2]; z++) {
    BW_TRY(evaluate_layer(&m, z + 1));
    bw_progress(context, "marching tetrahedra", (z + 1.0) / m.nodes[2]);
    for (int y = 0; y + 1 < m.nodes[1]; y++)
      for (int x = 0; x + 1 < m.nodes[0]; x++) {
        int node[3] = {x, y, z};
        BW_TRY(march_cube(&m, node));
      }
  }
  if (m.triangle_count == 0)
    BW_TRY(bw_fail(context, BW_EMPTY,
                   "the function is nowhere negative on a grid of %d x %d x %d nodes", m.nodes[0],
                   m.nodes[1], m.nodes[2]));
  BW_TRY(bw_surface_adopt(context, (int64_t)m.point_count, m.point, (int64_t)m.triangle_count,
                          m.triangle, NULL, surface));
  m.point = NULL;
  m.triangle = NULL;
done:
  for (int i = 0; i < 2; i++) {
    bw_free(m.value[i]);
    bw_free(m.on_edge[i]);
  }
  bw_free(m.point);
  bw_free(m.triangle);
  return status;
}
