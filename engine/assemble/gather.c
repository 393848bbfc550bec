/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sums of gradient products, pair by pair (gather.h). */
#include "assemble/gather.h"

#include <string.h>

/* Frames are asked for this many contributions ahead: numbers of neighbours may lie far apart. */
enum { ROWS_PER_CHUNK = 256, AHEAD = 32 };

/* One contribution: first * u (x) v + second * w (x) z, the letters being numbers of frame vectors.
 * Indexed by the local pair (a << 4 | b). */
typedef struct product {
  uint8_t u, v, w, z;
  double first, second;
} product;

static bool has(int middle, int corner) {
  return bw_tet_edge[middle - 4][0] == corner || bw_tet_edge[middle - 4][1] == corner;
}

/* The other end of a middle node's edge. */
static int other(int middle, int corner) {
  const int *edge = bw_tet_edge[middle - 4];
  return edge[0] == corner ? edge[1] : edge[0];
}

/* For corners i, j and middles m = ab of tet10, with s_m = g_a + g_b and V = 1:
 *   T_ij = 3/5 g_i g_j when i = j, else -1/5 g_i g_j
 *   T_im = 4/5 g_i g_b - 1/5 g_i s_m when i = a, else -1/5 g_i s_m
 *   T_mn = 4/5 (s_m s_n + g_b g_c) for m = ab, n = ac; 4/5 s_m s_n for opposite edges
 * The diagonal of a middle node has three products and is summed on its own. */
static void make_table(int order, product table[256]) {
  memset(table, 0, 256 * sizeof *table);
  int n = order == 1 ? 4 : 10;
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++) {
      product *p = &table[a << 4 | b];
      p->u = p->w = (uint8_t)a;
      p->v = p->z = (uint8_t)b;
      if (order == 1)
        p->first = 1;
      else if (a < 4 && b < 4)
        p->first = a == b ? 0.6 : -0.2;
      else if (a >= 4 && b >= 4) {
        p->first = 0.8;
        for (int i = 0; i < 4; i++)
          if (a != b && has(a, i) && has(b, i)) {
            p->w = (uint8_t)other(a, i);
            p->z = (uint8_t)other(b, i);
            p->second = 0.8;
          }
      } else {
        int corner = a < 4 ? a : b, middle = a < 4 ? b : a;
        p->first = -0.2;
        if (has(middle, corner)) {
          p->second = 0.8;
          if (a < 4)
            p->z = (uint8_t)other(middle, corner);
          else
            p->w = (uint8_t)other(middle, corner);
        }
      }
    }
}

typedef struct gather_data {
  const bw_graph *graph;
  bwi_frames frames;
  bwi_gather_kind kind;
  product table[256];
  double lambda, mu;
  bwi_vector map[9][3]; /* of the component T[m]: what it adds to the rows of the block */
  double *values;
  int64_t contributions;
} gather_data;

/* Add a curved element's tensor of local nodes (a, b). */
static inline void add_curved(const gather_data *g, int32_t number, int code, double t[3][4]) {
  int a = code >> 4, b = code & 15;
  int high = a > b ? a : b, low = a > b ? b : a;
  const double *tensor =
      g->frames.curved_tensor + ((int64_t)number * 55 + high * (high + 1) / 2 + low) * 9;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      t[r][c] += a >= b ? tensor[3 * r + c] : tensor[3 * c + r];
}

/* T of one pair into t (rows of four, the last unused). */
static inline void sum_pair(const gather_data *g, int64_t pair, bool diagonal, double t[3][4]) {
  const bw_graph *graph = g->graph;
  const int32_t *curved = g->frames.curved;
  const int vectors = g->frames.vectors;
  bwi_vector t0 = {0}, t1 = {0}, t2 = {0};
  double extra[3][4];
  if (curved)
    memset(extra, 0, sizeof extra);
  for (int64_t k = graph->gather_start[pair]; k < graph->gather_start[pair + 1]; k++) {
    int32_t e = graph->gather_element[k];
    int code = graph->gather_local[k];
    if (k + AHEAD < g->contributions)
      __builtin_prefetch(g->frames.vector + (int64_t)graph->gather_element[k + AHEAD] * vectors);
    if (curved && curved[e] >= 0) {
      add_curved(g, curved[e], code, extra);
      continue;
    }
    const bwi_vector *h = g->frames.vector + (int64_t)e * vectors;
    if (diagonal && (code & 15) >= 4) {
      const int *edge = bw_tet_edge[(code & 15) - 4];
      bwi_vector s = h[code & 15], a = h[edge[0]], b = h[edge[1]];
      t0 += 0.8 * (s[0] * s + (a[0] * a + b[0] * b));
      t1 += 0.8 * (s[1] * s + (a[1] * a + b[1] * b));
      t2 += 0.8 * (s[2] * s + (a[2] * a + b[2] * b));
      continue;
    }
    const product *p = &g->table[code];
    const double *u = (const double *)(h + p->u), *w = (const double *)(h + p->w);
    bwi_vector v = p->first * h[p->v], z = p->second * h[p->z];
    t0 += u[0] * v + w[0] * z;
    t1 += u[1] * v + w[1] * z;
    t2 += u[2] * v + w[2] * z;
  }
  memcpy(t[0], &t0, sizeof t0);
  memcpy(t[1], &t1, sizeof t1);
  memcpy(t[2], &t2, sizeof t2);
  if (curved)
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        t[r][c] += extra[r][c];
}

/* K = lambda T + mu T^T + mu tr(T) I */
static inline void apply_isotropic(double lambda, double mu, double t[3][4], double *out) {
  double trace = mu * (t[0][0] + t[1][1] + t[2][2]);
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      out[3 * r + c] = lambda * t[r][c] + mu * t[c][r] + (r == c ? trace : 0);
}

/* K_ik = sum_jl C_ijkl T_jl */
static inline void apply_general(const bwi_vector (*map)[3], double t[3][4], double *out) {
  bwi_vector row[3] = {map[0][0] * t[0][0], map[0][1] * t[0][0], map[0][2] * t[0][0]};
  for (int m = 1; m < 9; m++)
    for (int r = 0; r < 3; r++)
      row[r] += map[m][r] * t[m / 3][m % 3];
  for (int r = 0; r < 3; r++)
    memcpy(out + 3 * r, &row[r], 3 * sizeof *out);
}

static bw_status gather_rows(void *data, int64_t begin, int64_t end, int worker) {
  const gather_data *g = (const gather_data *)data;
  const int64_t *start = g->graph->start;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    for (int64_t pair = start[i]; pair < start[i + 1]; pair++) {
      double t[3][4], *out = g->values + 9 * pair;
      bool diagonal = pair == start[i + 1] - 1;
      sum_pair(g, pair, diagonal, t);
      if (g->kind == BWI_TRACE) {
        g->values[pair] = t[0][0] + t[1][1] + t[2][2];
        continue;
      }
      if (g->kind == BWI_ISOTROPIC)
        apply_isotropic(g->lambda, g->mu, t, out);
      else
        apply_general(g->map, t, out);
      if (diagonal) { /* symmetric but for rounding: make it exactly so */
        out[3] = out[1];
        out[6] = out[2];
        out[7] = out[5];
      }
    }
  return BW_OK;
}

bw_status bwi_gather(bw_context *context, const bw_graph *graph, const bw_mesh *mesh,
                     bwi_gather_kind kind, const bw_material *material, double *values) {
  static const int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
  bw_status status = BW_OK;
  gather_data g = {.graph = graph, .kind = kind, .values = values};
  BW_TRY(bwi_graph_fits(context, graph, mesh));
  BW_TRY(bwi_frames_create(context, mesh, &g.frames));
  make_table(mesh->order, g.table);
  g.contributions = graph->gather_start[graph->pair_count];
  if (kind == BWI_ISOTROPIC) {
    g.lambda = material->lame_lambda;
    g.mu = material->lame_mu;
  }
  if (kind == BWI_GENERAL)
    for (int j = 0; j < 3; j++)
      for (int l = 0; l < 3; l++)
        for (int i = 0; i < 3; i++)
          for (int k = 0; k < 3; k++)
            g.map[3 * j + l][i][k] = material->elasticity[6 * voigt[i][j] + voigt[k][l]];
  BW_TRY(bw_parallel(context, graph->node_count, ROWS_PER_CHUNK, gather_rows, &g));
done:
  bwi_frames_clear(&g.frames);
  return status;
}

bw_status bw_stiffness(bw_context *context, const bw_graph *graph, const bw_mesh *mesh,
                       const bw_material *material, double *values) {
  return bwi_gather(context, graph, mesh, material->isotropic ? BWI_ISOTROPIC : BWI_GENERAL,
                    material, values);
}

bw_status bw_laplacian(bw_context *context, const bw_graph *graph, const bw_mesh *mesh,
                       double *values) {
  return bwi_gather(context, graph, mesh, BWI_TRACE, NULL, values);
}
