/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* y = K x on straight tet10 of one isotropic material, by the matrix that the smoother stores and
 * by elements without a matrix: time and bytes of one product on a block of N x N x N cubes of six.
 *
 *     bench_elements [N]        19: 41,154 elements
 *
 * The strain of a straight tet10 is linear. With G_k the gradient of u at corner k, S_k its stress
 * and V the volume, forces are sums of V/20 (S_k + sum of S) g_j, by shape functions whose
 * gradients at corner k are 3 g_k, -g_j of the other corners, and 4 g_j of the midpoint of kj. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "assemble/gather.h"
#include "bench/bench.h"
#include "linear/smoother.h"

enum { LANES = 8, REPEATS = 15 };

typedef double lanes __attribute__((vector_size(64)));

/* Elements side by side; those that there are not have frames of zeros. */
typedef struct batch {
  int32_t row[10][LANES];
  double frame[3][3][LANES]; /* sqrt(V) g of corners 1 to 3 */
} batch;

typedef struct product {
  const batch *batches;
  const int64_t *start; /* by chunk of rows; then those that touch rows between chunks */
  double lambda, mu;
  int middle[4][4]; /* of corners: the midpoint between them */
  const double *x;
  double *y;
} product;

/* Stresses at the corners, in the order xx yy zz xy xz yz. */
static void stresses(const product *p, lanes u[10][3], lanes g[4][3], lanes s[4][6]) {
  for (int k = 0; k < 4; k++) {
    lanes du[3][3] = {{{0}}};
    for (int j = 0; j < 4; j++)
      for (int r = 0; r < 3; r++) {
        lanes along = j == k ? 3 * u[k][r] : 4 * u[p->middle[k][j]][r] - u[j][r];
        for (int c = 0; c < 3; c++)
          du[r][c] += along * g[j][c];
      }
    lanes volumetric = p->lambda * (du[0][0] + du[1][1] + du[2][2]);
    for (int r = 0; r < 3; r++)
      s[k][r] = volumetric + 2 * p->mu * du[r][r];
    s[k][3] = p->mu * (du[0][1] + du[1][0]);
    s[k][4] = p->mu * (du[0][2] + du[2][0]);
    s[k][5] = p->mu * (du[1][2] + du[2][1]);
  }
}

static void forces(const product *p, lanes g[4][3], lanes s[4][6], lanes f[10][3]) {
  lanes sum[6];
  for (int m = 0; m < 6; m++)
    sum[m] = s[0][m] + s[1][m] + s[2][m] + s[3][m];
  memset(f, 0, 30 * sizeof(lanes));
  for (int k = 0; k < 4; k++) {
    lanes t[6];
    for (int m = 0; m < 6; m++)
      t[m] = 0.05 * (s[k][m] + sum[m]);
    for (int j = 0; j < 4; j++) {
      lanes force[3] = {t[0] * g[j][0] + t[3] * g[j][1] + t[4] * g[j][2],
                        t[3] * g[j][0] + t[1] * g[j][1] + t[5] * g[j][2],
                        t[4] * g[j][0] + t[5] * g[j][1] + t[2] * g[j][2]};
      for (int r = 0; r < 3; r++)
        if (j == k)
          f[k][r] += 3 * force[r];
        else {
          f[j][r] -= force[r];
          f[p->middle[k][j]][r] += 4 * force[r];
        }
    }
  }
}

static void add_batch(const product *p, const batch *b) {
  lanes u[10][3], g[4][3], s[4][6], f[10][3];
  for (int a = 0; a < 10; a++)
    for (int d = 0; d < 3; d++)
      for (int w = 0; w < LANES; w++)
        u[a][d][w] = p->x[3 * (int64_t)b->row[a][w] + d];
  for (int d = 0; d < 3; d++) {
    for (int i = 1; i < 4; i++)
      memcpy(&g[i][d], b->frame[i - 1][d], sizeof g[i][d]);
    g[0][d] = -(g[1][d] + g[2][d] + g[3][d]);
  }
  stresses(p, u, g, s);
  forces(p, g, s, f);
  for (int w = 0; w < LANES; w++)
    for (int a = 0; a < 10; a++)
      for (int d = 0; d < 3; d++)
        p->y[3 * (int64_t)b->row[a][w] + d] += f[a][d][w];
}

static bw_status add_chunks(void *data, int64_t begin, int64_t end, int worker) {
  const product *p = data;
  (void)worker;
  for (int64_t b = p->start[begin]; b < p->start[end]; b++)
    add_batch(p, p->batches + b);
  return BW_OK;
}

/* ---- which elements -------------------------------------------------------------------------- */

typedef struct place {
  int32_t chunk, row, element;
} place;

static int compare(const void *a, const void *b) {
  const place *x = a, *y = b;
  if (x->chunk != y->chunk)
    return x->chunk < y->chunk ? -1 : 1;
  if (x->row != y->row)
    return x->row < y->row ? -1 : 1;
  return (x->element > y->element) - (x->element < y->element);
}

/* By chunk, and by the first row of each element; `start` has room for all chunks and one more. */
static batch *make_batches(const bw_mesh *mesh, const bwi_smoother *s, int64_t *start) {
  int32_t count = mesh->element_count, between = s->chunk_start[s->chunk_count];
  place *list = malloc((size_t)count * sizeof *list);
  batch *batches = calloc((size_t)(count / LANES + s->chunk_count + 2), sizeof *batches);
  for (int32_t e = 0; e < count; e++) {
    list[e] = (place){0, INT32_MAX, e};
    int32_t last = 0;
    for (int a = 0; a < 10; a++) {
      int32_t row = s->row_of[mesh->element[10 * (int64_t)e + a]];
      list[e].row = row < list[e].row ? row : list[e].row;
      last = row > last ? row : last;
    }
    while (list[e].chunk < s->chunk_count &&
           (last >= between || list[e].row >= s->chunk_start[list[e].chunk + 1]))
      list[e].chunk++;
  }
  qsort(list, (size_t)count, sizeof *list, compare);
  int64_t used = 0;
  for (int32_t chunk = 0, k = 0; chunk <= s->chunk_count; chunk++) {
    start[chunk] = used;
    for (int w = 0; k < count && list[k].chunk == chunk; k++, w = (w + 1) % LANES) {
      bwi_vector h[10];
      if (w == 0)
        used++;
      bwi_element_frame(mesh, list[k].element, h);
      for (int a = 0; a < 10; a++)
        batches[used - 1].row[a][w] = s->row_of[mesh->element[10 * (int64_t)list[k].element + a]];
      for (int i = 1; i < 4; i++)
        for (int d = 0; d < 3; d++)
          batches[used - 1].frame[i - 1][d][w] = h[i][d];
    }
  }
  start[s->chunk_count + 1] = used;
  free(list);
  return batches;
}

/* ---- measured -------------------------------------------------------------------------------- */

int main(int argc, char **argv) {
  int n = argc > 1 ? atoi(argv[1]) : 19, cells[3] = {n, n, n};
  bw_context *context = bw_context_create();
  const double min[3] = {0, 0, 0}, max[3] = {1, 1, 1};
  const bw_isotropic constants = {.young = 1, .poisson = 0.3};
  bw_mesh *mesh = NULL;
  bw_material *material = NULL;
  bw_block_pattern *pattern = NULL;
  bw_dof_map *dof_map = NULL;
  bwi_smoother *s = NULL;
  bool usable;
  OK(bw_mesh_box_grid(context, min, max, cells, 2, &mesh));
  OK(bw_material_isotropic(context, &constants, &material));
  OK(bw_block_pattern_create(context, mesh, &pattern));
  OK(bw_dof_map_unconstrained(context, mesh, &dof_map));
  double *stiffness = malloc(9 * (size_t)pattern->block_count * sizeof *stiffness);
  OK(bw_stiffness(context, pattern, mesh, material, stiffness));
  OK(bwi_smoother_create(context, mesh, pattern, true, NULL, &s));
  OK(bwi_smoother_follow(context, s, stiffness, dof_map, &usable));
  size_t size = 3 * (size_t)mesh->node_count;
  double *x = calloc(size + BWI_SMOOTHER_SPARE, sizeof *x), energy[BWI_SMOOTHER_SIDES];
  double *y = calloc(size + BWI_SMOOTHER_SPARE, sizeof *y), *z = calloc(size, sizeof *z);
  int64_t start[BWI_SMOOTHER_MAX_CHUNKS + 2];
  product p = {.batches = make_batches(mesh, s, start),
               .start = start,
               .lambda = material->lame_lambda,
               .mu = material->lame_mu,
               .x = x,
               .y = z};
  bw_random random;
  bw_random_seed(&random, 1);
  for (size_t i = 0; i < size; i++)
    x[i] = 2 * bw_random_uniform(&random) - 1;
  for (int m = 0; m < 6; m++)
    p.middle[bw_tet_edge[m][0]][bw_tet_edge[m][1]] =
        p.middle[bw_tet_edge[m][1]][bw_tet_edge[m][0]] = 4 + m;
  double matrix = 52.0 * (double)s->even.start[s->count] + 76.0 * (double)s->odd.start[s->count];
  printf("%d tet10; one product, the least of %d\n\n", mesh->element_count, REPEATS);
  printf("| threads | by | seconds | processor seconds | MB read | difference |\n");
  printf("|---|---|---|---|---|---|\n");
  for (int threads = 1; threads <= 2; threads++) {
    double wall[2] = {INFINITY, INFINITY}, processor[2] = {INFINITY, INFINITY};
    double off = 0, largest = 0;
    OK(bw_set_threads(context, threads));
    for (int k = 0; k < 2 * REPEATS; k++) {
      double began = bw_seconds(), used = processor_seconds();
      if (k % 2 == 0)
        OK(bwi_smoother_product(context, s, 1, x, y, energy));
      else {
        memset(z, 0, size * sizeof *z);
        OK(bw_parallel(context, s->chunk_count, 1, add_chunks, &p));
        add_chunks(&p, s->chunk_count, s->chunk_count + 1, 0);
      }
      wall[k % 2] = fmin(wall[k % 2], bw_seconds() - began);
      processor[k % 2] = fmin(processor[k % 2], processor_seconds() - used);
    }
    for (size_t i = 0; i < size; i++) {
      off = fmax(off, fabs(s->unit * z[i] - y[i]));
      largest = fmax(largest, fabs(y[i]));
    }
    printf("| %d | matrix | %.4f | %.4f | %.1f | |\n", threads, wall[0], processor[0],
           matrix / 1e6);
    printf("| %d | elements | %.4f | %.4f | %.1f | %.0e |\n", threads, wall[1], processor[1],
           (double)start[s->chunk_count + 1] * sizeof(batch) / 1e6, off / largest);
  }
  free((void *)p.batches);
  free(x);
  free(y);
  free(z);
  free(stiffness);
  bw_release(s);
  bw_release(dof_map);
  bw_release(pattern);
  bw_release(material);
  bw_release(mesh);
  bw_context_destroy(context);
  return 0;
}
