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

/* The sum of a block's tensors, zero but while its row is in work. Aligned, so that none of the
 * vectors lies on two lines of the cache. */
typedef struct tensor {
  _Alignas(64) bwi_vector t[3];
} tensor;
static const tensor zero;

/* What becomes of the tensors: 9 numbers per block from a material, or the trace. */
typedef enum gather_kind { ISOTROPIC, GENERAL, TRACE } gather_kind;

typedef struct gather_data {
  bwi_row_sums rows;
  bwi_frames frames;
  bwi_block_term table[256];
  gather_kind kind;
  double lambda, mu;
  /* by group: of the component T[m], what it adds to the block's rows; and of mean gradients, in
     elements with B-bar (NULL: without) */
  bwi_vector (*map)[9][3], (*mean_map)[9][3];
  const int32_t *group; /* by element: where the material is rotated by element, or NULL */
  tensor *sum; /* threads x 2 x longest row: of gradients, then of mean gradients with B-bar */
  int64_t longest;
  const uint8_t *wanted;   /* rows, or NULL: all */
  double *values;          /* all, or NULL: a row at a time, to `take` */
  double *row;             /* then threads x longest row x 9 */
  bwi_stiffness_row *take; /* with `data` */
  void *data;
} gather_data;

/* Add a curved element's tensor of local nodes (a, b). */
static void add_curved(const bwi_frames *frames, int32_t number, int a, int b, bwi_vector t[3]) {
  int high = a > b ? a : b, low = a > b ? b : a;
  const double *own =
      frames->curved_tensor + ((int64_t)number * 55 + high * (high + 1) / 2 + low) * 9;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      t[r][c] += a >= b ? own[3 * r + c] : own[3 * c + r];
}

/* Adds what an element contributes to V mean(grad N_i) (x) mean(grad N_j): on a straight tet10 the
 * means of corners vanish, and those of mid-edge nodes are s_m. */
static void add_mean(const bwi_frames *frames, int64_t e, int a, int b, bwi_vector t[3]) {
  const bwi_vector *mean = frames->vector + e * frames->vectors;
  if (frames->curved && frames->curved[e] >= 0)
    mean = frames->curved_mean + (int64_t)frames->curved[e] * 10;
  else if (a < 4 || b < 4)
    return;
  for (int r = 0; r < 3; r++)
    t[r] += mean[a][r] * mean[b];
}

/* Elements whose frames are asked for ahead: numbers of neighbours may lie far apart. */
enum { AHEAD = 8 };

/* The contributions of the k-th element around row i. `straight`: all elements are, and none has
 * B-bar. */
__attribute__((always_inline)) static inline void add_element(const gather_data *g, int64_t i,
                                                              int64_t k, const int32_t *place,
                                                              bool straight, tensor *sum) {
  const bwi_row_sums *r = &g->rows;
  const int32_t *node = bwi_row_element(r, k);
  int64_t e = r->incidence.element[k];
  if (k + AHEAD < r->incidence.start[r->pattern->node_count]) {
    const char *next = (const char *)(g->frames.vector +
                                      (int64_t)r->incidence.element[k + AHEAD] * g->frames.vectors);
    __builtin_prefetch(bwi_row_element(r, k + AHEAD));
    for (int byte = 0; byte < 32 * g->frames.vectors; byte += 64)
      __builtin_prefetch(next + byte);
  }
  int a = r->incidence.local[k], below[10], count = 0; /* listed first: half of them, at random */
  for (int b = 0; b < r->nodes_per_element; b++) {
    below[count] = b;
    count += node[b] <= i;
  }
  bool curved = !straight && g->frames.curved && g->frames.curved[e] >= 0;
  const bwi_vector *h = g->frames.vector + e * g->frames.vectors;
  const bwi_block_term *table = g->table + (a << 4);
  int n = 0;
  for (; !curved && a < 4 && n < count; n++)
    bwi_add_corner_row(&table[below[n]], h, sum[place[node[below[n]]]].t);
  for (; !curved && n < count && below[n] < 4; n++)
    bwi_add_corner_column(&table[below[n]], h, sum[place[node[below[n]]]].t);
  for (; !curved && n < count; n++)
    if (below[n] == a)
      bwi_add_middle(a, h, sum[place[i]].t);
    else
      bwi_add_middles(&table[below[n]], h, sum[place[node[below[n]]]].t);
  for (; n < count; n++)
    add_curved(&g->frames, g->frames.curved[e], a, below[n], sum[place[node[below[n]]]].t);
  for (n = 0; !straight && g->mean_map && n < count; n++)
    add_mean(&g->frames, e, a, below[n], sum[g->longest + place[node[below[n]]]].t);
}

static void add_general(const bwi_vector (*map)[3], tensor *from, double *out) {
  double block[9];
  bwi_apply_general(map, from->t, block);
  for (int i = 0; i < 9; i++)
    out[i] += block[i];
  *from = zero;
}

/* Takes the sums of a row that the elements from `begin` to `end` - 1 around it contributed to, all
 * of one group, into its values. */
static void take_group(const gather_data *g, int64_t i, int64_t begin, int64_t end,
                       const int32_t *place, tensor *sum, double *row) {
  const bwi_row_sums *r = &g->rows;
  int32_t group = g->group ? g->group[r->incidence.element[begin]] : 0;
  for (int64_t k = begin; k < end; k++) {
    const int32_t *node = bwi_row_element(r, k);
    for (int b = 0; b < r->nodes_per_element; b++) {
      if (node[b] > i || memcmp(sum[place[node[b]]].t, zero.t, sizeof zero.t) == 0)
        continue; /* taken already */
      double *out = row + 9 * (int64_t)place[node[b]];
      add_general(g->map[group], &sum[place[node[b]]], out);
      if (g->mean_map)
        add_general(g->mean_map[group], &sum[g->longest + place[node[b]]], out);
    }
  }
}

/* A row by general maps: run by run of elements of one group of the material. */
static void gather_groups(const gather_data *g, int64_t i, int64_t count, const int32_t *place,
                          tensor *sum, double *row) {
  const bwi_row_sums *r = &g->rows;
  int64_t end = r->incidence.start[i + 1];
  memset(row, 0, (size_t)count * 9 * sizeof *row);
  for (int64_t k = r->incidence.start[i], next = k; k < end; k = next) {
    int32_t group = g->group ? g->group[r->incidence.element[k]] : 0;
    for (; next < end && (!g->group || g->group[r->incidence.element[next]] == group); next++)
      add_element(g, i, next, place, false, sum);
    take_group(g, i, k, next, place, sum, row);
  }
}

/* `row`: where its values come. */
static void gather_row(const gather_data *g, int64_t i, int32_t *place, tensor *sum, double *row) {
  const bwi_row_sums *r = &g->rows;
  int64_t count = bwi_row_places(r, i, place);
  bool groups = g->group || g->mean_map;
  if (groups)
    gather_groups(g, i, count, place, sum, row);
  else if (g->frames.curved)
    for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++)
      add_element(g, i, k, place, false, sum);
  else
    for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++)
      add_element(g, i, k, place, true, sum);
  for (int64_t p = 0; !groups && p < count; p++) {
    const bwi_vector *t = sum[p].t;
    double *out = row + 9 * p;
    if (g->kind == TRACE)
      row[p] = t[0][0] + t[1][1] + t[2][2];
    else if (g->kind == ISOTROPIC)
      bwi_apply_isotropic(g->lambda, g->mu, t, out);
    else
      bwi_apply_general(g->map[0], t, out);
    sum[p] = zero;
  }
  if (g->kind != TRACE)
    bwi_make_symmetric(row + 9 * (count - 1));
}

static bw_status gather_rows(void *data, int64_t begin, int64_t end, int worker) {
  const gather_data *g = (const gather_data *)data;
  const bw_block_pattern *pattern = g->rows.pattern;
  int32_t *place = g->rows.place + (int64_t)worker * pattern->node_count;
  for (int64_t i = begin; i < end; i++) {
    if (g->wanted && !g->wanted[i])
      continue;
    double *row = g->values ? g->values + (g->kind == TRACE ? 1 : 9) * pattern->start[i]
                            : g->row + 9 * worker * g->longest;
    gather_row(g, i, place, g->sum + 2 * worker * g->longest, row);
    if (g->take)
      g->take(g->data, i, row);
  }
  return BW_OK;
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
 * its parts. The projected bulk modulus acts on mean gradients. */
static bw_status general_maps(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                              gather_data *g) {
  int32_t count = bw_material_part_count(material);
  g->map = (bwi_vector(*)[9][3])bw_alloc(context, (size_t)count, sizeof *g->map);
  bool projects = false;
  for (int32_t n = 0; n < count; n++)
    projects |= bwi_projected_bulk(mesh, bw_material_part(material, n)) > 0;
  if (projects)
    g->mean_map = (bwi_vector(*)[9][3])bw_alloc(context, (size_t)count, sizeof *g->mean_map);
  if (!g->map || (projects && !g->mean_map))
    return BW_MEMORY;
  for (int32_t n = 0; n < count; n++) {
    const bw_material *part = bw_material_part(material, n);
    double projected = bwi_projected_bulk(mesh, part), rest[36], on_mean[36] = {0};
    memcpy(rest, part->elasticity, sizeof rest);
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) {
        on_mean[6 * i + k] = projected;
        rest[6 * i + k] -= projected;
      }
    if (projects)
      fill_map(on_mean, g->mean_map[n]);
    fill_map(rest, g->map[n]);
  }
  g->group = material->parts ? material->parts->of_element : NULL;
  return BW_OK;
}

/* `material` NULL: the Laplacian. `g` says where values go. */
static bw_status gather(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                        const bw_material *material, gather_data *g) {
  bw_status status = BW_OK;
  void *memory = NULL;
  BW_TRY(bwi_block_pattern_fits(context, pattern, mesh));
  BW_TRY(bwi_frames_create(context, mesh, &g->frames));
  BW_TRY(bwi_row_sums_open(context, pattern, mesh->element_count, mesh->nodes_per_element,
                           mesh->element, &g->rows));
  for (int64_t i = 0; i < pattern->node_count; i++)
    if (pattern->start[i + 1] - pattern->start[i] > g->longest)
      g->longest = pattern->start[i + 1] - pattern->start[i];
  memory = BW_NEW0(context, tensor, 2 * g->longest * bw_threads(context) + 1);
  if (!g->values)
    g->row = BW_NEW(context, double, 9 * g->longest * bw_threads(context));
  BW_TRY_MEMORY(memory && (g->values || g->row));
  g->sum =
      (tensor *)(((uintptr_t)memory + _Alignof(tensor) - 1) & ~(uintptr_t)(_Alignof(tensor) - 1));
  bwi_product_table(mesh->order, g->table);
  g->kind = TRACE;
  if (material && material->isotropic && bwi_projected_bulk(mesh, material) == 0) {
    g->kind = ISOTROPIC;
    g->lambda = material->lame_lambda;
    g->mu = material->lame_mu;
  } else if (material) {
    g->kind = GENERAL;
    BW_TRY(bw_material_fits(context, material, mesh->element_count));
    BW_TRY(general_maps(context, mesh, material, g));
  }
  BW_TRY(bw_parallel(context, pattern->node_count, BWI_ROWS_PER_CHUNK, gather_rows, g));
done:
  bw_free(g->map);
  bw_free(g->mean_map);
  bw_free(g->row);
  bw_free(memory);
  bwi_row_sums_close(&g->rows);
  bwi_frames_clear(&g->frames);
  return status;
}

bw_status bwi_stiffness_update(bw_context *context, const bw_block_pattern *pattern,
                               const bw_mesh *mesh, const bw_material *material,
                               const uint8_t *rows, double *values) {
  return gather(context, pattern, mesh, material, &(gather_data){.wanted = rows, .values = values});
}

bw_status bw_stiffness(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                       const bw_material *material, double *values) {
  return gather(context, pattern, mesh, material, &(gather_data){.values = values});
}

typedef struct stored {
  const bw_block_pattern *pattern;
  const double *values;
  bwi_stiffness_row *take;
  void *data;
} stored;

static bw_status take_stored(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const stored *k = data;
  for (int64_t i = begin; i < end; i++)
    k->take(k->data, i, k->values + 9 * k->pattern->start[i]);
  return BW_OK;
}

bw_status bwi_stiffness_rows(bw_context *context, const bw_block_pattern *pattern,
                             const bwi_stiffness *stiffness, bwi_stiffness_row *take, void *data) {
  stored k = {pattern, stiffness->values, take, data};
  return k.values ? bw_parallel(context, pattern->node_count, BWI_ROWS_PER_CHUNK, take_stored, &k)
                  : gather(context, pattern, stiffness->mesh, stiffness->material,
                           &(gather_data){.take = take, .data = data});
}

bw_status bw_laplacian(bw_context *context, const bw_block_pattern *pattern, const bw_mesh *mesh,
                       double *values) {
  return gather(context, pattern, mesh, NULL, &(gather_data){.values = values});
}
