/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sums of gradient products, block by block (gather.h). */
#include "assemble/block.h"

#include <string.h>

static bool has(int middle, int corner) {
  return bw_tet_edge[middle - 4][0] == corner || bw_tet_edge[middle - 4][1] == corner;
}

/* The other end of a mid-edge node's edge. */
static int other(int middle, int corner) {
  const int *edge = bw_tet_edge[middle - 4];
  return edge[0] == corner ? edge[1] : edge[0];
}

/* For corners i, j and mid-edge nodes m = ab of tet10, with s_m = g_a + g_b and V = 1:
 *   T_ij = 3/5 g_i g_j when i = j, else -1/5 g_i g_j
 *   T_im = 4/5 g_i g_b - 1/5 g_i s_m when i = a, else -1/5 g_i s_m
 *   T_mn = 4/5 (s_m s_n + g_b g_c) for m = ab, n = ac; 4/5 s_m s_n for opposite edges
 * The diagonal of a mid-edge node has three products and is summed on its own. */
void bwi_product_table(int order, bwi_block_term table[256]) {
  memset(table, 0, 256 * sizeof *table);
  int n = order == 1 ? 4 : 10;
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++) {
      bwi_block_term *p = &table[a << 4 | b];
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
  const bw_block_pattern *pattern;
  bwi_block_source source;
  bwi_gather_kind kind;
  double lambda, mu;
  /* by group: of the component T[m], what it adds to the block's rows; and of mean gradients, in
     elements with B-bar (NULL: without) */
  bwi_vector (*map)[9][3], (*mean_map)[9][3];
  const int32_t *group; /* by element: where the material is rotated by element, or NULL */
  double *values;
} gather_data;

static void add_general(const bwi_vector (*map)[3], double t[3][4], double *out) {
  double block[9];
  bwi_apply_general(map, t, block);
  for (int i = 0; i < 9; i++)
    out[i] += block[i];
}

/* The values of a block by general maps: run by run of elements of one group of the material. */
static void gather_general(const gather_data *g, const bwi_contributions *list, int64_t index,
                           bool diagonal, double *out) {
  int64_t k = list->start[index - list->first], end = list->start[index - list->first + 1];
  memset(out, 0, 9 * sizeof *out);
  while (k < end) {
    double t[3][4];
    int32_t group = g->group ? g->group[list->element[k]] : 0;
    int64_t next = g->group ? k + 1 : end;
    while (next < end && g->group[list->element[next]] == group)
      next++;
    bwi_sum_contributions(&g->source, list, NULL, k, next, diagonal, t);
    add_general(g->map[group], t, out);
    if (g->mean_map) {
      bwi_sum_means(&g->source, list, k, next, t);
      add_general(g->mean_map[group], t, out);
    }
    k = next;
  }
}

static void gather_rows(void *data, const bwi_contributions *list, int64_t begin, int64_t end) {
  const gather_data *g = (const gather_data *)data;
  const int64_t *start = g->pattern->start;
  for (int64_t i = begin; i < end; i++)
    for (int64_t index = start[i]; index < start[i + 1]; index++) {
      double t[3][4], *out = g->values + 9 * index;
      bool diagonal = index == start[i + 1] - 1;
      if (g->group || g->mean_map) {
        gather_general(g, list, index, diagonal, out);
        if (diagonal)
          bwi_make_symmetric(out);
        continue;
      }
      bwi_sum_block(&g->source, list, NULL, index, diagonal, t);
      if (g->kind == BWI_TRACE) {
        g->values[index] = t[0][0] + t[1][1] + t[2][2];
        continue;
      }
      if (g->kind == BWI_ISOTROPIC)
        bwi_apply_isotropic(g->lambda, g->mu, t, out);
      else
        bwi_apply_general(g->map[0], t, out);
      if (diagonal)
        bwi_make_symmetric(out);
    }
}

static void fill_map(const double c[36], bwi_vector map[9][3]) {
  static const int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
  for (int j = 0; j < 3; j++)
    for (int l = 0; l < 3; l++)
      for (int i = 0; i < 3; i++) {
        bwi_vector row = {0, 0, 0, 0};
        for (int k = 0; k < 3; k++)
          row[k] = c[6 * voigt[i][j] + voigt[k][l]];
        map[3 * j + l][i] = row;
      }
}

/* The maps of a material that is not isotropic, or of elements with B-bar: one, or one for each of
 * the material's groups. `projected` is the bulk modulus that acts on mean gradients. */
static bw_status general_maps(bw_context *context, const bw_material *material, double projected,
                              gather_data *g) {
  const bw_material_orientations *orientations = material->orientations;
  int32_t count = orientations ? orientations->count : 1;
  g->map = (bwi_vector(*)[9][3])bw_alloc(context, (size_t)count, sizeof *g->map);
  if (projected > 0)
    g->mean_map = (bwi_vector(*)[9][3])bw_alloc(context, (size_t)count, sizeof *g->mean_map);
  if (!g->map || (projected > 0 && !g->mean_map))
    return BW_MEMORY;
  for (int32_t n = 0; n < count; n++) {
    const double *c =
        orientations ? orientations->elasticity + 36 * (int64_t)n : material->elasticity;
    double rest[36], on_mean[36] = {0};
    memcpy(rest, c, sizeof rest);
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) {
        on_mean[6 * i + k] = projected;
        rest[6 * i + k] -= projected;
      }
    if (projected > 0)
      fill_map(on_mean, g->mean_map[n]);
    fill_map(rest, g->map[n]);
  }
  g->group = orientations ? orientations->of_element : NULL;
  return BW_OK;
}

bw_status bwi_gather(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                     bwi_gather_kind kind, const bw_material *material, double *values) {
  bw_status status = BW_OK;
  bwi_frames frames = {0};
  gather_data g = {
      .pattern = pattern, .source = {.frames = &frames}, .kind = kind, .values = values};
  BW_TRY(bwi_block_pattern_fits(context, pattern, mesh));
  BW_TRY(bwi_frames_create(context, mesh, &frames));
  bwi_product_table(mesh->order, g.source.table);
  if (kind == BWI_ISOTROPIC) {
    g.lambda = material->lame_lambda;
    g.mu = material->lame_mu;
  }
  if (kind == BWI_GENERAL) {
    BW_TRY(bw_material_fits(context, material, mesh->element_count));
    BW_TRY(general_maps(context, material, bwi_projected_bulk(mesh, material), &g));
  }
  BW_TRY(bwi_for_contributions(context, pattern, mesh, gather_rows, &g));
done:
  bw_free(g.map);
  bw_free(g.mean_map);
  bwi_frames_clear(&frames);
  return status;
}

bw_status bw_stiffness(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                       const bw_material *material, double *values) {
  bool isotropic = material->isotropic && bwi_projected_bulk(mesh, material) == 0;
  return bwi_gather(context, pattern, mesh, isotropic ? BWI_ISOTROPIC : BWI_GENERAL, material,
                    values);
}

bw_status bw_laplacian(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                       double *values) {
  return bwi_gather(context, pattern, mesh, BWI_TRACE, NULL, values);
}
