/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Products by elements (element_product.h).
 *
 * The strain of a straight tet10 is linear. With G_k the gradient of u at corner k, S_k its stress
 * and V the volume, forces are sums of V/20 (S_k + sum of S) g_j, by shape functions whose
 * gradients at corner k are 3 g_k, -g_j of the other corners, and 4 g_j of the midpoint of kj. */
#include "linear/element_product.h"

#include <string.h>

#include "assemble/gather.h"
#include "assemble/internal.h"

enum { LANES = 8, SIDES = BWI_SMOOTHER_SIDES, GROUPS = BWI_SMOOTHER_MAX_CHUNKS };

/* One number of eight elements, or of four or eight fields of one element. */
typedef double eight __attribute__((vector_size(64), aligned(8), may_alias));
typedef double four __attribute__((vector_size(32), aligned(8), may_alias));

/* Elements side by side. Those that there are not repeat the rows of the first, and their frames
 * are zeros. */
typedef struct batch {
  int32_t row[10][LANES];
  double frame[3][3][LANES]; /* sqrt(V) g of corners 1 to 3 */
} batch;

struct bwi_element_product {
  bw_object object;
  int group_count;
  int64_t start[GROUPS + 1]; /* by group: batches */
  int64_t own[GROUPS + 1];   /* rows of chunks of a group, and those between chunks of a group */
  int64_t between[GROUPS + 1];
  batch *batches;
  bool isotropic;
  double lambda, mu;       /* times unit/5 */
  double elasticity[6][6]; /* the same */
};

/* Of two corners: the midpoint between them. */
static const int middle[4][4] = {{0, 4, 6, 7}, {4, 0, 5, 8}, {6, 5, 0, 9}, {7, 8, 9, 0}};

/* Forces f of the displacements u; `frame`: of corners 1 to 3. Stresses are in the order of the
 * elasticity, xx yy zz yz zx xy. */
#define ELEMENT(suffix, all, number)                                                               \
  static inline void stress##suffix(const bwi_element_product *p, all du[3][3], all s[6]) {        \
    if (p->isotropic) {                                                                            \
      all volumetric = p->lambda * (du[0][0] + du[1][1] + du[2][2]);                               \
      for (int r = 0; r < 3; r++)                                                                  \
        s[r] = volumetric + 2 * p->mu * du[r][r];                                                  \
      s[3] = p->mu * (du[1][2] + du[2][1]);                                                        \
      s[4] = p->mu * (du[0][2] + du[2][0]);                                                        \
      s[5] = p->mu * (du[0][1] + du[1][0]);                                                        \
    } else {                                                                                       \
      all e[6] = {                                                                                 \
          du[0][0],           du[1][1], du[2][2], du[1][2] + du[2][1], du[0][2] + du[2][0],        \
          du[0][1] + du[1][0]};                                                                    \
      for (int m = 0; m < 6; m++) {                                                                \
        s[m] = p->elasticity[m][0] * e[0];                                                         \
        for (int n = 1; n < 6; n++)                                                                \
          s[m] += p->elasticity[m][n] * e[n];                                                      \
      }                                                                                            \
    }                                                                                              \
  }                                                                                                \
                                                                                                   \
  static inline void stresses##suffix(const bwi_element_product *p, all u[10][3],                  \
                                      const number g[3][3], all s[4][6]) {                         \
    all four_u[6][3];                                                                              \
    for (int m = 0; m < 6; m++)                                                                    \
      for (int r = 0; r < 3; r++)                                                                  \
        four_u[m][r] = 4 * u[4 + m][r];                                                            \
    for (int k = 0; k < 4; k++) {                                                                  \
      all du[3][3];                                                                                \
      for (int r = 0; r < 3; r++) {                                                                \
        all along[4];                                                                              \
        for (int j = 0; j < 4; j++)                                                                \
          along[j] = j == k ? 3 * u[k][r] : four_u[middle[k][j] - 4][r] - u[j][r];                 \
        for (int j = 1; j < 4; j++)                                                                \
          along[j] -= along[0];                                                                    \
        for (int c = 0; c < 3; c++)                                                                \
          du[r][c] = along[1] * g[0][c] + along[2] * g[1][c] + along[3] * g[2][c];                 \
      }                                                                                            \
      stress##suffix(p, du, s[k]);                                                                 \
    }                                                                                              \
  }                                                                                                \
                                                                                                   \
  static inline void forces##suffix(const number g[3][3], all s[4][6], all f[10][3]) {             \
    static const int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};                              \
    all sum[6];                                                                                    \
    for (int m = 0; m < 6; m++)                                                                    \
      sum[m] = s[0][m] + s[1][m] + s[2][m] + s[3][m];                                              \
    for (int r = 0; r < 3; r++) {                                                                  \
      all along[4][4]; /* at corner k along g_j */                                                 \
      for (int k = 0; k < 4; k++) {                                                                \
        for (int j = 1; j < 4; j++)                                                                \
          along[k][j] = (s[k][voigt[r][0]] + sum[voigt[r][0]]) * g[j - 1][0] +                     \
                        (s[k][voigt[r][1]] + sum[voigt[r][1]]) * g[j - 1][1] +                     \
                        (s[k][voigt[r][2]] + sum[voigt[r][2]]) * g[j - 1][2];                      \
        along[k][0] = -(along[k][1] + along[k][2] + along[k][3]);                                  \
      }                                                                                            \
      for (int k = 0; k < 4; k++) {                                                                \
        f[k][r] = along[k][k] - 0.25 * (along[0][k] + along[1][k] + along[2][k] + along[3][k]);    \
        for (int j = 0; j < k; j++)                                                                \
          f[middle[k][j]][r] = along[k][j] + along[j][k];                                          \
      }                                                                                            \
    }                                                                                              \
  }                                                                                                \
                                                                                                   \
  static inline void element##suffix(const bwi_element_product *p, all u[10][3],                   \
                                     const number g[3][3], all f[10][3], all *energy) {            \
    all s[4][6], sum = {0};                                                                        \
    stresses##suffix(p, u, g, s);                                                                  \
    forces##suffix(g, s, f);                                                                       \
    for (int a = 0; a < 10; a++)                                                                   \
      sum += u[a][0] * f[a][0] + u[a][1] * f[a][1] + u[a][2] * f[a][2];                            \
    *energy += sum;                                                                                \
  }
ELEMENT(_side_by_side, eight, eight)
ELEMENT(_of_four, four, double)
ELEMENT(_of_eight, eight, double)

/* One field of eight elements. */
static void add_batch(const bwi_element_product *p, const batch *b, const double *x, double *y,
                      eight *energy) {
  eight u[10][3], f[10][3];
  for (int a = 0; a < 10; a++)
    for (int d = 0; d < 3; d++)
      for (int w = 0; w < LANES; w++)
        u[a][d][w] = x[3 * (int64_t)b->row[a][w] + d];
  element_side_by_side(p, u, (const eight(*)[3])b->frame, f, energy);
  for (int w = 0; w < LANES; w++)
    for (int a = 0; a < 10; a++)
      for (int d = 0; d < 3; d++)
        y[3 * (int64_t)b->row[a][w] + d] += f[a][d][w];
}

/* Four or eight fields from `first` on, of one element after the other: what the next one reads and
 * adds to is asked for meanwhile. */
#define FIELDS(suffix, all)                                                                        \
  static void add_batch##suffix(const bwi_element_product *p, const batch *b, int64_t width,       \
                                int first, const double *x, double *y, double *energy) {           \
    all sum = *(const all *)(energy + first);                                                      \
    for (int w = 0; w < LANES; w++) {                                                              \
      all u[10][3], f[10][3];                                                                      \
      double g[3][3];                                                                              \
      for (int i = 0; i < 3; i++)                                                                  \
        for (int d = 0; d < 3; d++)                                                                \
          g[i][d] = b->frame[i][d][w];                                                             \
      for (int a = 0; a < 10; a++)                                                                 \
        for (int d = 0; d < 3; d++)                                                                \
          u[a][d] = *(const all *)(x + (3 * (int64_t)b->row[a][w] + d) * width + first);           \
      for (int a = 0; a < 10 && w + 1 < LANES; a++)                                                \
        for (int d = 0; d < 3; d++) {                                                              \
          __builtin_prefetch(x + (3 * (int64_t)b->row[a][w + 1] + d) * width + first);             \
          __builtin_prefetch(y + (3 * (int64_t)b->row[a][w + 1] + d) * width + first, 1);          \
        }                                                                                          \
      element##suffix(p, u, (const double(*)[3])g, f, &sum);                                       \
      for (int a = 0; a < 10; a++)                                                                 \
        for (int d = 0; d < 3; d++)                                                                \
          *(all *)(y + (3 * (int64_t)b->row[a][w] + d) * width + first) += f[a][d];                \
    }                                                                                              \
    *(all *)(energy + first) = sum;                                                                \
  }
FIELDS(_of_four, four)
FIELDS(_of_eight, eight)

typedef struct pass {
  const bwi_element_product *p;
  int width, odd;
  const double *x;
  double *y, (*energy)[SIDES];
} pass;

static void clear_rows(const pass *m, const int64_t *start, int64_t from, int64_t to) {
  int64_t size = 3 * (int64_t)m->width;
  memset(m->y + size * start[from], 0, (size_t)(size * (start[to] - start[from])) * sizeof *m->y);
}

static bw_status add_group(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  (void)end;
  const pass *m = data;
  const bwi_element_product *p = m->p;
  int64_t g = 2 * begin + m->odd, next = g + 2 < p->group_count ? g + 2 : p->group_count;
  double sum[SIDES] = {0};
  eight lanes = {0};
  if (!m->odd) {
    clear_rows(m, p->own, g, next);
    clear_rows(m, p->between, g, next);
  }
  for (int64_t k = p->start[g]; k < p->start[g + 1]; k++) {
    const batch *b = p->batches + k;
    int first = 0;
    if (m->width == 1) {
      add_batch(p, b, m->x, m->y, &lanes);
      continue;
    }
    for (; first + 8 <= m->width; first += 8)
      add_batch_of_eight(p, b, m->width, first, m->x, m->y, sum);
    if (first < m->width)
      add_batch_of_four(p, b, m->width, first, m->x, m->y, sum);
  }
  for (int w = 0; w < LANES; w++)
    sum[0] += lanes[w];
  memcpy(m->energy[g], sum, sizeof sum);
  return BW_OK;
}

bw_status bwi_element_product_apply(bw_context *context, const bwi_element_product *p, int width,
                                    const double *x, double *y, double *energy) {
  bw_status status = BW_OK;
  double sums[GROUPS][SIDES];
  pass m = {.p = p, .width = width, .x = x, .y = y, .energy = sums};
  BW_TRY(bw_parallel(context, (p->group_count + 1) / 2, 1, add_group, &m));
  m.odd = 1;
  BW_TRY(bw_parallel(context, p->group_count / 2, 1, add_group, &m));
  for (int f = 0; energy && f < width; f++) {
    energy[f] = 0;
    for (int g = 0; g < p->group_count; g++)
      energy[f] += sums[g][f];
  }
done:
  return status;
}

/* ---- which elements -------------------------------------------------------------------------- */

bw_status bwi_element_product_serves(bw_context *context, const bw_mesh *mesh,
                                     const bw_material *material, bool *serves) {
  bw_status status = bwi_blocks_even(context, mesh, material, serves);
  *serves = *serves && mesh->order == 2;
  return status;
}

typedef struct grouping {
  bwi_element_product *p;
  const bwi_smoother *smoother;
  const bw_mesh *mesh;
  int32_t *row, *element; /* by element: the first of its rows; by lane of the batches */
  uint8_t *first, *last;  /* by element: the chunks of its rows; then its group */
} grouping;

static int chunk_of(const bwi_smoother *s, int32_t row) {
  const int32_t *start = row < s->chunk_start[s->chunk_count] ? s->chunk_start : s->between_start;
  int chunk = 0;
  while (row >= start[chunk + 1])
    chunk++;
  return chunk;
}

static bw_status find_rows(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const grouping *g = data;
  for (int64_t e = begin; e < end; e++) {
    g->row[e] = INT32_MAX;
    g->first[e] = GROUPS;
    g->last[e] = 0;
    for (int a = 0; a < 10; a++) {
      int32_t row = g->smoother->row_of[g->mesh->element[10 * e + a]];
      uint8_t chunk = (uint8_t)chunk_of(g->smoother, row);
      g->row[e] = row < g->row[e] ? row : g->row[e];
      g->first[e] = chunk < g->first[e] ? chunk : g->first[e];
      g->last[e] = chunk > g->last[e] ? chunk : g->last[e];
    }
  }
  return BW_OK;
}

/* As many groups as let the elements of each touch its own chunks and those of the next. */
static void choose_groups(const grouping *g) {
  bwi_element_product *p = g->p;
  const bwi_smoother *s = g->smoother;
  int shift = 0;
  for (int64_t e = 0; e < g->mesh->element_count; e++)
    while ((g->last[e] >> shift) - (g->first[e] >> shift) > 1)
      shift++;
  p->group_count = ((s->chunk_count - 1) >> shift) + 1;
  for (int k = 0; k <= p->group_count; k++) {
    int chunk = k << shift < s->chunk_count ? k << shift : s->chunk_count;
    p->own[k] = s->chunk_start[chunk];
    p->between[k] = s->between_start[chunk];
  }
  for (int64_t e = 0; e < g->mesh->element_count; e++)
    g->first[e] = (uint8_t)(g->first[e] >> shift);
}

/* Elements to the lanes of their groups' batches, by their first rows. */
static bw_status fill_lanes(bw_context *context, grouping *g) {
  bwi_element_product *p = g->p;
  int64_t count = g->mesh->element_count, rows = g->smoother->count, next[GROUPS] = {0};
  int32_t *start = BW_NEW0(context, int32_t, rows + 1), *order = BW_NEW(context, int32_t, count);
  if (start && order) {
    for (int64_t e = 0; e < count; e++) {
      start[g->row[e] + 1]++;
      next[g->first[e]]++;
    }
    for (int64_t k = 0; k < rows; k++)
      start[k + 1] += start[k];
    for (int32_t e = 0; e < count; e++)
      order[start[g->row[e]]++] = e;
    for (int k = 0; k < p->group_count; k++) {
      p->start[k + 1] = p->start[k] + (next[k] + LANES - 1) / LANES;
      next[k] = LANES * p->start[k];
    }
    g->element = BW_NEW(context, int32_t, LANES * p->start[p->group_count]);
    for (int64_t k = 0; g->element && k < LANES * p->start[p->group_count]; k++)
      g->element[k] = -1;
    for (int64_t k = 0; g->element && k < count; k++)
      g->element[next[g->first[order[k]]]++] = order[k];
  }
  bw_free(start);
  bw_free(order);
  return g->element ? BW_OK : BW_MEMORY;
}

static bw_status fill_batches(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const grouping *g = data;
  for (int64_t k = begin; k < end; k++)
    for (int w = 0; w < LANES; w++) {
      batch *b = g->p->batches + k;
      bool exists = g->element[LANES * k + w] >= 0;
      int64_t e = g->element[LANES * k + (exists ? w : 0)];
      bwi_vector h[10];
      bwi_element_frame(g->mesh, e, h);
      for (int a = 0; a < 10; a++)
        b->row[a][w] = g->smoother->row_of[g->mesh->element[10 * e + a]];
      for (int i = 1; i < 4; i++)
        for (int d = 0; d < 3; d++)
          b->frame[i - 1][d][w] = exists ? h[i][d] : 0;
    }
  return BW_OK;
}

/* ---- life ------------------------------------------------------------------------------------ */

static void element_product_destroy(void *object) {
  bwi_element_product *p = object;
  bw_free(p->batches);
  bw_free(p);
}

static size_t element_product_bytes(const void *object) {
  const bwi_element_product *p = object;
  return sizeof *p + (size_t)p->start[p->group_count] * sizeof *p->batches;
}

static const bw_kind element_product_kind = {"product by elements", element_product_destroy,
                                             element_product_bytes};

static void take_material(bwi_element_product *p, const bw_material *material, double unit) {
  p->isotropic = material->isotropic;
  p->lambda = 0.2 * unit * material->lame_lambda;
  p->mu = 0.2 * unit * material->lame_mu;
  for (int m = 0; m < 6; m++)
    for (int n = 0; n < 6; n++)
      p->elasticity[m][n] = 0.2 * unit * material->elasticity[6 * m + n];
}

bw_status bwi_element_product_create(bw_context *context, const bwi_smoother *smoother,
                                     const bw_mesh *mesh, const bw_material *material,
                                     bwi_element_product **out) {
  bw_status status = BW_OK;
  int64_t count = mesh->element_count;
  bwi_element_product *p = BW_NEW0(context, bwi_element_product, 1);
  grouping g = {.p = p, .smoother = smoother, .mesh = mesh};
  if (!p)
    return BW_MEMORY;
  bw_object_init(p, &element_product_kind);
  take_material(p, material, smoother->unit);
  g.row = BW_NEW(context, int32_t, count);
  g.first = BW_NEW(context, uint8_t, count);
  g.last = BW_NEW(context, uint8_t, count);
  BW_TRY_MEMORY(g.row && g.first && g.last);
  BW_TRY(bw_parallel(context, count, BWI_SMOOTHER_ROWS, find_rows, &g));
  choose_groups(&g);
  BW_TRY(fill_lanes(context, &g));
  p->batches = BW_NEW(context, batch, p->start[p->group_count]);
  BW_TRY_MEMORY(p->batches);
  BW_TRY(
      bw_parallel(context, p->start[p->group_count], BWI_SMOOTHER_ROWS / LANES, fill_batches, &g));
done:
  bw_free(g.row);
  bw_free(g.element);
  bw_free(g.first);
  bw_free(g.last);
  if (status == BW_OK)
    *out = p;
  else
    bw_release(p);
  return status;
}
