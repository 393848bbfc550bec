/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The mean of a nodal field over the boundary near each boundary node: a nonlocal stress measure
 * that stays finite where the stress itself is singular (docs/theory/error.md).
 *
 * The patch of a node is what connected facets reach within the radius, so the other side of a thin
 * wall is not part of it. Facets are sampled at the centroids of 16 equal subtriangles. A sample at
 * distance d counts by its area times 1 - (d / radius)^2: a smooth weight converges with the mesh
 * faster than a cut disc. Invariant: where no sample lies within the radius, the mean is the node's
 * own value; weights are positive and sum to one, so constants are kept and no mean exceeds the
 * largest value of its patch. */
#include "analysis/strain.h"
#include "assemble/internal.h"

#include "barwright/analysis.h"

#include <math.h>
#include <string.h>

enum { CUTS = 4, SAMPLES = CUTS * CUTS };

typedef struct sampling {
  double weight[SAMPLES][6]; /* of the facet's nodes */
} sampling;

typedef struct patches {
  const bw_mesh *mesh;
  double radius;
  int columns;
  const double *value;
  double *mean;
  sampling rule;
  bwi_incidence around; /* facets around every node */
  double *area;         /* facet_count */
  int32_t *seen;  /* threads x facet_count: the last boundary node that met the facet, plus 1 */
  int32_t *queue; /* threads x facet_count */
} patches;

/* Quadratic facets are interpolated linearly on the four triangles between corners and middles,
 * which keeps all weights positive. */
static void make_rule(int nodes, sampling *rule) {
  static const double corner[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
  static const int inner[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {4, 5, 3}};
  memset(rule, 0, sizeof *rule);
  int k = 0;
  for (int i = 0; i < CUTS; i++)
    for (int j = 0; i + j < CUTS; j++)
      for (int up = 0; up < (i + j < CUTS - 1 ? 2 : 1); up++, k++) {
        double shift = up ? 2.0 / 3 : 1.0 / 3;
        double x = (i + shift) / CUTS, y = (j + shift) / CUTS;
        if (nodes == 3) {
          rule->weight[k][0] = 1 - x - y, rule->weight[k][1] = x, rule->weight[k][2] = y;
          continue;
        }
        for (int t = 0; t < 4; t++) {
          const double *a = corner[inner[t][0]], *b = corner[inner[t][1]], *c = corner[inner[t][2]];
          double twice = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
          double u = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / twice;
          double v = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / twice;
          if (u < 0 || v < 0 || u + v > 1)
            continue;
          rule->weight[k][inner[t][0]] = 1 - u - v;
          rule->weight[k][inner[t][1]] = u;
          rule->weight[k][inner[t][2]] = v;
          break;
        }
      }
}

/* Adds the samples of a facet that lie within the radius; whether there is one. */
static bool add_facet(const patches *p, int32_t facet, const double *centre, double *total,
                      double *sum) {
  const bw_mesh *mesh = p->mesh;
  const int32_t *node = mesh->facet + (size_t)facet * mesh->nodes_per_facet;
  bool any = false;
  for (int k = 0; k < SAMPLES; k++) {
    const double *w = p->rule.weight[k];
    double square = 0;
    for (int c = 0; c < 3; c++) {
      double x = -centre[c];
      for (int a = 0; a < mesh->nodes_per_facet; a++)
        x += w[a] * mesh->node[3 * (size_t)node[a] + c];
      square += x * x;
    }
    double share = p->area[facet] / SAMPLES * (1 - square / (p->radius * p->radius));
    if (!(share > 0))
      continue;
    any = true;
    *total += share;
    for (int a = 0; a < mesh->nodes_per_facet; a++) {
      const double *value = p->value + (size_t)node[a] * p->columns;
      double part = share * w[a];
      for (int c = 0; part > 0 && c < p->columns; c++)
        sum[c] += part * value[c];
    }
  }
  return any;
}

static void mean_at(const patches *p, int32_t node, int32_t mark, int32_t *seen, int32_t *queue) {
  const double *centre = p->mesh->node + 3 * (size_t)node;
  double *mean = p->mean + (size_t)node * p->columns, total = 0;
  int32_t first = 0, last = 0;
  memset(mean, 0, (size_t)p->columns * sizeof *mean);
  for (int64_t k = p->around.start[node]; k < p->around.start[node + 1]; k++) {
    seen[p->around.element[k]] = mark;
    queue[last++] = p->around.element[k];
  }
  while (first < last) {
    int32_t facet = queue[first++];
    if (!add_facet(p, facet, centre, &total, mean))
      continue;
    for (int a = 0; a < 3; a++) {
      int32_t corner = p->mesh->facet[(size_t)facet * p->mesh->nodes_per_facet + a];
      for (int64_t k = p->around.start[corner]; k < p->around.start[corner + 1]; k++)
        if (seen[p->around.element[k]] != mark) {
          seen[p->around.element[k]] = mark;
          queue[last++] = p->around.element[k];
        }
    }
  }
  for (int c = 0; c < p->columns; c++)
    mean[c] = total > 0 ? mean[c] / total : p->value[(size_t)node * p->columns + c];
}

static bw_status means_of(void *data, int64_t begin, int64_t end, int worker) {
  const patches *p = (const patches *)data;
  size_t own = (size_t)worker * p->mesh->facet_count;
  for (int64_t i = begin; i < end; i++)
    mean_at(p, p->mesh->boundary_node[i], (int32_t)i + 1, p->seen + own, p->queue + own);
  return BW_OK;
}

bw_status bw_surface_mean(bw_context *context, const bw_mesh *mesh, double radius, int columns,
                          const double *value, double *mean) {
  bw_status status;
  patches p = {.mesh = mesh, .radius = radius, .columns = columns, .value = value, .mean = mean};
  size_t facets = (size_t)mesh->facet_count, threads = (size_t)bw_threads(context);
  p.area = BW_NEW(context, double, facets);
  p.seen = BW_NEW0(context, int32_t, facets * threads);
  p.queue = BW_NEW(context, int32_t, facets * threads);
  if (!p.area || !p.seen || !p.queue) {
    status = BW_MEMORY;
    goto done;
  }
  if (!(radius > 0) || !isfinite(radius) || columns < 1) {
    status = bw_fail(context, BW_INVALID, "a radius greater than 0 expected, got %g m", radius);
    goto done;
  }
  BW_TRY(bwi_incidence_of_elements(context, mesh->node_count, mesh->facet_count,
                                   mesh->nodes_per_facet, mesh->facet, &p.around));
  for (size_t f = 0; f < facets; f++) {
    const int32_t *node = mesh->facet + f * (size_t)mesh->nodes_per_facet;
    const double *a = mesh->node + 3 * (size_t)node[0], *b = mesh->node + 3 * (size_t)node[1],
                 *c = mesh->node + 3 * (size_t)node[2];
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++)
      u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    bw_cross(u, v, n);
    p.area[f] = 0.5 * sqrt(bw_dot(n, n));
  }
  make_rule(mesh->nodes_per_facet, &p.rule);
  memset(mean, 0, (size_t)mesh->node_count * (size_t)columns * sizeof *mean);
  BW_TRY(bw_parallel(context, mesh->boundary_node_count, 64, means_of, &p));
done:
  bwi_incidence_clear(&p.around);
  bw_free(p.area);
  bw_free(p.seen);
  bw_free(p.queue);
  return status;
}
