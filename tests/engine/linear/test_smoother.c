/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sweeps over the rows of a stiffness beside Gauss and Seidel's iteration written down plainly, and
 * products beside those of the pattern. */
#include "base/dense.h"
#include "linear/smoother.h"

#include "incremental_bar.h"

typedef struct scene {
  bar b;
  bw_block_pattern *pattern;
  bw_dof_map *dof_map;
  double *stiffness;
  int64_t size;
} scene;

static void scene_make(bw_context *context, int across, int supports, scene *s) {
  bar_make(context, across, 2, &s->b);
  load_bar(context, &s->b, supports);
  check_ok(context, bw_block_pattern_create(context, s->b.mesh, &s->pattern));
  check_ok(context, bw_dof_map_create(context, s->b.model, &s->dof_map));
  s->stiffness = numbers(9 * s->pattern->block_count);
  s->size = 3 * (int64_t)s->b.mesh->node_count;
  check_ok(context, bw_stiffness(context, s->pattern, s->b.mesh, s->b.material, s->stiffness));
}

static void scene_clear(scene *s) {
  free(s->stiffness);
  bw_release(s->dof_map);
  bw_release(s->pattern);
  bar_clear(&s->b);
}

static bwi_smoother *smoother_of(bw_context *context, const scene *s, bool even) {
  bwi_smoother *smoother = NULL;
  bool usable = false;
  check_ok(context,
           bwi_smoother_create(context, s->b.mesh, s->pattern, even, even, NULL, &smoother));
  check_ok(context, bwi_smoother_follow(context, smoother, &(bwi_stiffness){.values = s->stiffness},
                                        s->dof_map, &usable));
  assert_true(usable);
  check_ok(context,
           bwi_smoother_follow_elements(context, smoother, s->b.mesh, s->b.material, &usable));
  assert_true(usable);
  return smoother;
}

/* Numbers of field f of `width`, from nodes to rows. */
static double *packed(const bwi_smoother *s, int width, int f, double *row, const double *field) {
  for (int64_t k = 0; k < s->count; k++)
    for (int d = 0; d < 3; d++)
      row[(3 * k + d) * width + f] = field[3 * (int64_t)s->node[k] + d];
  return row;
}

/* Nodes of different chunks have no common block. */
static void chunks_are_apart(void **state) {
  bw_context *context = check_context(state);
  scene s;
  scene_make(context, 4, 0, &s);
  bwi_smoother *smoother = smoother_of(context, &s, true);
  assert_true(smoother->chunk_count > 1);
  assert_int_equal(smoother->chunk_start[0], 0);
  int32_t inside = smoother->chunk_start[smoother->chunk_count];
  assert_true(8 * (smoother->count - inside) < smoother->count);
  for (int64_t i = 0; i < smoother->count; i++)
    for (int64_t p = s.pattern->start[i]; p < s.pattern->start[i + 1]; p++) {
      int32_t a = smoother->row_of[i], b = smoother->row_of[s.pattern->column[p]];
      for (int c = 0; c < smoother->chunk_count && a < inside && b < inside; c++)
        assert_int_equal(a >= smoother->chunk_start[c] && a < smoother->chunk_start[c + 1],
                         b >= smoother->chunk_start[c] && b < smoother->chunk_start[c + 1]);
    }
  bw_release(smoother);
  scene_clear(&s);
}

/* Blocks of six numbers lose nothing but rounding: products are those of the pattern, and energies
 * those of the products. */
static void products(void **state) {
  bw_context *context = check_context(state);
  scene s;
  scene_make(context, 2, 0, &s);
  double *x = numbers(s.size), *y = numbers(s.size), energy[BWI_SMOOTHER_SIDES];
  for (int even = 0; even < 2; even++) {
    bwi_smoother *smoother = smoother_of(context, &s, even);
    assert_int_equal(even,
                     smoother->even.start[smoother->count] > smoother->odd.start[smoother->count]);
    for (int width = 1; width <= BWI_SMOOTHER_SIDES; width = width / 4 * 4 + 4) {
      double *px = numbers(width * s.size + BWI_SMOOTHER_SPARE);
      double *py = numbers(width * s.size + BWI_SMOOTHER_SPARE);
      for (int f = 0; f < width; f++) {
        random_field(7 + (uint64_t)f, s.size, x);
        packed(smoother, width, f, px, x);
      }
      check_ok(context, bwi_smoother_product(context, smoother, width, px, py, energy));
      for (int f = 0; f < width; f++) {
        double largest = 0, off = 0, xy = 0;
        random_field(7 + (uint64_t)f, s.size, x);
        check_ok(context, bw_block_multiply(context, s.pattern, s.stiffness, 9, 3, 1, x, y));
        for (int64_t i = 0; i < s.size; i++)
          xy += smoother->unit * x[i] * y[i];
        check_near(energy[f] / xy, 1, 1e-12);
        for (int64_t k = 0; k < smoother->count; k++)
          for (int d = 0; d < 3; d++) {
            double wanted = y[3 * (int64_t)smoother->node[k] + d] * smoother->unit;
            largest = fmax(largest, fabs(wanted));
            off = fmax(off, fabs(py[(3 * k + d) * width + f] - wanted));
          }
        check_near(off / largest, 0, 1e-14);
      }
      free(px);
      free(py);
    }
    bw_release(smoother);
  }
  free(x);
  free(y);
  scene_clear(&s);
}

/* The halves of a double hold it whole, and the upper one is the float below it. */
static void halves(void **state) {
  bw_random random;
  (void)state;
  bw_random_seed(&random, 5);
  for (int k = 0; k < 1000; k++) {
    uint32_t rest;
    double x = ldexp(2 * bw_random_uniform(&random) - 1, k % 120 - 118);
    float value = bwi_smoother_halves(x, &rest);
    assert_true(bwi_smoother_whole(value, rest) == x);
    assert_true(fabs((double)value) <= fabs(x) && fabs(x - (double)value) <= 0x1p-23 * fabs(x));
  }
  for (int sign = -1; sign <= 1; sign++) {
    uint32_t rest;
    float value = bwi_smoother_halves(sign * 1e-39, &rest);
    assert_true(bwi_smoother_whole(value, rest) == 0);
  }
}

/* For sweeps alone the lower halves are not kept. */
static void upper_halves_alone(void **state) {
  bw_context *context = check_context(state);
  scene s;
  scene_make(context, 2, 0, &s);
  bwi_smoother *whole = smoother_of(context, &s, false), *sweeps = NULL;
  bool usable = false;
  check_ok(context, bwi_smoother_create(context, NULL, s.pattern, false, false, NULL, &sweeps));
  check_ok(context, bwi_smoother_follow(context, sweeps, &(bwi_stiffness){.values = s.stiffness},
                                        s.dof_map, &usable));
  assert_true(usable);
  int64_t numbers = 9 * whole->odd.start[whole->count];
  assert_int_equal(bw_bytes(whole) - bw_bytes(sweeps), (size_t)numbers * sizeof(uint32_t));
  assert_memory_equal(whole->odd.value, sweeps->odd.value, (size_t)numbers * sizeof(float));
  bw_release(whole);
  bw_release(sweeps);
  scene_clear(&s);
}

/* The block of nodes i, j, as three rows, in the frames' global directions. */
static void block_of(const scene *s, int32_t i, int32_t j, double block[9]) {
  int32_t high = i > j ? i : j, low = i > j ? j : i;
  memset(block, 0, 9 * sizeof *block);
  for (int64_t p = s->pattern->start[high]; p < s->pattern->start[high + 1]; p++)
    if (s->pattern->column[p] == low)
      for (int c = 0; c < 9; c++)
        block[c] = s->stiffness[9 * p + (i >= j ? c : 3 * (c % 3) + c / 3)];
}

/* z of one node so that its equations along its unknowns hold: three coupled ones, by Cramer, held
 * directions left out. */
static void relax(const scene *s, int32_t i, const double *r, double *z) {
  double rest[3] = {r[3 * i], r[3 * i + 1], r[3 * i + 2]}, block[9], a[9], b[3];
  for (int32_t j = 0; j < s->b.mesh->node_count; j++) {
    if (j == i)
      continue;
    block_of(s, i, j, block);
    for (int d = 0; d < 3; d++)
      rest[d] -= bw_dot(block + 3 * d, z + 3 * (int64_t)j);
  }
  static const double global[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  int32_t row = s->dof_map->frame_of[i];
  const double *frame = row < 0 ? global : s->dof_map->frame + 9 * (int64_t)row;
  block_of(s, i, i, block);
  for (int p = 0; p < 3; p++) {
    bool unknown = s->dof_map->state[3 * i + p] == BW_DOF_UNKNOWN;
    b[p] = unknown ? bw_dot(frame + 3 * p, rest) : 0;
    for (int q = 0; q < 3; q++) {
      a[3 * p + q] = p == q;
      if (unknown && s->dof_map->state[3 * i + q] == BW_DOF_UNKNOWN) {
        a[3 * p + q] = 0;
        for (int d = 0; d < 3; d++)
          a[3 * p + q] += frame[3 * p + d] * bw_dot(block + 3 * d, frame + 3 * q);
      }
    }
  }
  double inverse[9], along[3];
  assert_true(bw_inverse3(a, inverse) > 0);
  for (int p = 0; p < 3; p++)
    along[p] = bw_dot(inverse + 3 * p, b);
  for (int d = 0; d < 3; d++)
    z[3 * (int64_t)i + d] = along[0] * frame[d] + along[1] * frame[3 + d] + along[2] * frame[6 + d];
}

static void sweeps(void **state) {
  bw_context *context = check_context(state);
  static const int supports[] = {0, 1, 4}; /* built in; slides, and on surfaces of their own */
  for (int k = 0; k < 3; k++) {
    scene s;
    scene_make(context, 2, supports[k], &s);
    double *r = numbers(s.size), *z = numbers(s.size), *again = numbers(s.size);
    double *left = numbers(s.size);
    bwi_smoother *w = smoother_of(context, &s, true);
    for (int width = 1; width <= BWI_SMOOTHER_SIDES; width = width / 4 * 4 + 4) {
      size_t capacity = (size_t)(width * s.size) + BWI_SMOOTHER_SPARE;
      float *pr = calloc(capacity, sizeof *pr), *pz = calloc(capacity, sizeof *pz);
      float *rest = calloc(capacity, sizeof *rest);
      double *p = numbers((int64_t)capacity);
      int f = width - 1;
      random_field(3, s.size, r);
      bwi_keep_states(s.dof_map, 1u << BW_DOF_UNKNOWN, r);
      packed(w, width, f, p, r);
      for (size_t i = 0; i < capacity; i++)
        pr[i] = (float)p[i];
      memset(z, 0, (size_t)s.size * sizeof *z);
      for (int32_t n = 0; n < w->count; n++)
        relax(&s, w->node[n], r, z);
      check_ok(context, bwi_smoother_forward(context, w, width, pr, pz, rest));
      check_ok(context, bw_block_multiply(context, s.pattern, s.stiffness, 9, 3, 1, z, left));
      for (int64_t i = 0; i < s.size; i++)
        left[i] = r[i] - left[i];
      bwi_keep_states(s.dof_map, 1u << BW_DOF_UNKNOWN, left);
      for (int pass = 0; pass < 2; pass++) {
        double max = 0, off = 0, off_rest = 0;
        for (int64_t i = 0; i < w->count; i++)
          for (int d = 0; d < 3; d++) {
            int64_t node = w->node[i], at = (3 * i + d) * width + f;
            max = fmax(max, fabs(z[3 * node + d]));
            off = fmax(off, fabs((double)pz[at] * w->unit - z[3 * node + d]));
            again[3 * node + d] = (double)rest[at];
          }
        bwi_keep_states(s.dof_map, 1u << BW_DOF_UNKNOWN, again);
        for (int64_t i = 0; pass == 0 && i < s.size; i++)
          off_rest = fmax(off_rest, fabs(again[i] - left[i]));
        check_near(off / max, 0, 2e-5);
        check_near(off_rest, 0, 2e-5);
        if (pass == 1)
          break;
        for (int32_t n = w->count - 1; n >= 0; n--)
          relax(&s, w->node[n], r, z);
        check_ok(context, bwi_smoother_backward(context, w, width, pr, pz, rest));
      }
      free(pr);
      free(pz);
      free(rest);
      free(p);
    }
    bw_release(w);
    free(r);
    free(z);
    free(again);
    free(left);
    scene_clear(&s);
  }
}

/* z and what is left of r by a sweep forwards (`both`: and backwards) of field f of `width`, from
 * field to field at nodes. The other fields have numbers of their own. */
static void sweep_field(bw_context *context, const scene *s, const bwi_smoother *w, int width,
                        int f, bool both, const double *r, double *z, double *rest) {
  size_t capacity = (size_t)(width * s->size) + BWI_SMOOTHER_SPARE;
  double *p = numbers((int64_t)capacity), *other = numbers(s->size);
  float *pr = calloc(capacity, sizeof *pr), *pz = calloc(capacity, sizeof *pz);
  float *left = calloc(capacity, sizeof *left);
  for (int k = 0; k < width; k++) {
    random_field(100 + (uint64_t)k, s->size, other);
    bwi_keep_states(s->dof_map, 1u << BW_DOF_UNKNOWN, other);
    packed(w, width, k, p, k == f ? r : other);
  }
  for (size_t i = 0; i < capacity; i++)
    pr[i] = (float)p[i];
  check_ok(context, bwi_smoother_forward(context, w, width, pr, pz, left));
  for (int64_t k = 0; k < w->count; k++)
    for (int d = 0; d < 3; d++)
      rest[3 * (int64_t)w->node[k] + d] = (double)left[(3 * k + d) * width + f];
  if (both)
    check_ok(context, bwi_smoother_backward(context, w, width, pr, pz, left));
  for (int64_t k = 0; k < w->count; k++)
    for (int d = 0; d < 3; d++)
      z[3 * (int64_t)w->node[k] + d] = w->unit * (double)pz[(3 * k + d) * width + f];
  bwi_keep_states(s->dof_map, 1u << BW_DOF_UNKNOWN, rest);
  free(p);
  free(other);
  free(pr);
  free(pz);
  free(left);
}

/* After a sweep forwards each block's equations hold with the rows up to its own, and what is left
 * is r - K z. */
static void check_forward(bw_context *context, const scene *s, const bwi_smoother *w,
                          const double *r, const double *z, const double *left) {
  double *part = numbers(s->size), *product = numbers(s->size);
  for (int32_t b = 0; b < w->block_count; b++) {
    memset(part, 0, (size_t)s->size * sizeof *part);
    for (int32_t k = 0; k < w->block_start[b + 1]; k++)
      memcpy(part + 3 * (int64_t)w->node[k], z + 3 * (int64_t)w->node[k], 3 * sizeof *z);
    check_ok(context, bw_block_multiply(context, s->pattern, s->stiffness, 9, 3, 1, part, product));
    for (int64_t i = 0; i < s->size; i++)
      product[i] = r[i] - product[i];
    bwi_keep_states(s->dof_map, 1u << BW_DOF_UNKNOWN, product);
    for (int32_t k = w->block_start[b]; k < w->block_start[b + 1]; k++)
      for (int d = 0; d < 3; d++)
        check_near(product[3 * (int64_t)w->node[k] + d], 0, 1e-4);
  }
  check_near(difference(left, product, s->size), 0, 1e-4);
  free(part);
  free(product);
}

/* Pressed along z, so that columns across the thickness are blocks; along x, so that lines of 21
 * nodes are; one layer of cells pressed along x, so that most nodes are none's. */
typedef enum pressed { ALONG_Z, ALONG_X, ONE_LAYER, PRESSED } pressed;

/* Rows of a stiffness that is nowhere stored make the same smoother, to the last bit. */
static void check_streamed(bw_context *context, const scene *s, const bw_mesh *mesh,
                           const bwi_smoother *stored) {
  const bwi_stiffness stiffness = {NULL, mesh, s->b.material};
  const bwi_smoother_part *parts[2][2];
  for (int threads = 1; threads <= 2; threads++) {
    bwi_smoother *w = NULL;
    bool usable = false;
    check_ok(context, bw_set_threads(context, threads));
    check_ok(context, bwi_smoother_create(context, mesh, s->pattern, true, true, &stiffness, &w));
    check_ok(context, bwi_smoother_follow(context, w, &stiffness, s->dof_map, &usable));
    assert_true(usable && w->unit == stored->unit);
    const bwi_smoother *both[2] = {w, stored};
    for (int k = 0; k < 2; k++) {
      parts[k][0] = &both[k]->even;
      parts[k][1] = &both[k]->odd;
    }
    size_t rows = (size_t)w->count, numbers[2] = {6, 9};
    assert_memory_equal(w->node, stored->node, rows * sizeof *w->node);
    assert_memory_equal(w->inverse, stored->inverse, 9 * rows * sizeof(float));
    assert_memory_equal(w->diagonal, stored->diagonal, 6 * rows * sizeof(double));
    assert_memory_equal(w->factor, stored->factor,
                        9 * (size_t)w->factor_start[rows] * sizeof(float));
    for (int n = 0; n < 2; n++) {
      size_t entries = (size_t)parts[0][n]->start[rows];
      assert_int_equal(entries, parts[1][n]->start[rows]);
      assert_memory_equal(parts[0][n]->value, parts[1][n]->value,
                          numbers[n] * entries * sizeof(float));
    }
    bw_release(w);
  }
}

static bwi_smoother *pressed_smoother(bw_context *context, scene *s, pressed how) {
  bwi_smoother *w = NULL;
  bool usable = false;
  bw_mesh *flat = NULL;
  double *node = numbers(s->size);
  for (int64_t i = 0; i < s->size; i++) {
    double x = s->b.mesh->node[i];
    node[i] = x;
    if (i % 3 == 2 && how == ALONG_Z)
      node[i] = 0.1 * x;
    if (i % 3 == 0 && how != ALONG_Z)
      node[i] = how == ALONG_X ? 0.05 * x : x - 0.99 * fmin(fmax(x - 4, 0), 1);
  }
  check_ok(context, bw_mesh_moved(context, s->b.mesh, node, &flat));
  check_ok(context, bw_stiffness(context, s->pattern, flat, s->b.material, s->stiffness));
  check_ok(context, bwi_smoother_create(context, flat, s->pattern, true, true,
                                        &(bwi_stiffness){.values = s->stiffness}, &w));
  check_ok(context, bwi_smoother_follow(context, w, &(bwi_stiffness){.values = s->stiffness},
                                        s->dof_map, &usable));
  assert_true(usable);
  assert_non_null(w->block_start);
  check_streamed(context, s, flat, w);
  assert_true(w->columns == (how != ONE_LAYER));
  int32_t longest = 0;
  for (int32_t b = 0; b < w->block_count; b++) {
    int32_t size = w->block_start[b + 1] - w->block_start[b];
    longest = size > longest ? size : longest;
  }
  if (how == ALONG_X)
    assert_in_range(longest, 17, 21);
  bw_release(flat);
  free(node);
  return w;
}

/* Blocks are solved in their turn, both halves together are symmetric, and all fields of a width
 * have the same. */
static void blocks_are_solved(void **state) {
  bw_context *context = check_context(state);
  for (int n = 0; n < 2 * PRESSED; n++) {
    scene s;
    scene_make(context, 2, n < PRESSED ? 0 : 4, &s);
    bwi_smoother *w = pressed_smoother(context, &s, (pressed)(n % PRESSED));
    double *r = numbers(s.size), *z = numbers(s.size), *left = numbers(s.size);
    double *other = numbers(s.size), *again = numbers(s.size), *first = numbers(s.size);
    random_field(3, s.size, r);
    random_field(4, s.size, other);
    bwi_keep_states(s.dof_map, 1u << BW_DOF_UNKNOWN, r);
    bwi_keep_states(s.dof_map, 1u << BW_DOF_UNKNOWN, other);
    for (int width = 1; width <= BWI_SMOOTHER_SIDES; width = width / 4 * 4 + 4)
      for (int f = 0; f < width; f += 3) {
        sweep_field(context, &s, w, width, f, false, r, z, left);
        if (f == 0 || f == width - 1)
          check_forward(context, &s, w, r, z, left);
        sweep_field(context, &s, w, width, f, true, r, z, left);
        sweep_field(context, &s, w, width, f, true, other, again, left);
        check_near(bwi_dot(s.size, z, other) / bwi_dot(s.size, again, r), 1, 1e-3);
        if (width == 1)
          memcpy(first, z, (size_t)s.size * sizeof *z);
        check_near(difference(z, first, s.size), 0, 1e-5);
      }
    bw_release(w);
    free(r);
    free(z);
    free(left);
    free(other);
    free(again);
    free(first);
    scene_clear(&s);
  }
}

static void singular_nodes_are_reported(void **state) {
  bw_context *context = check_context(state);
  scene s;
  bool usable = true;
  scene_make(context, 1, 0, &s);
  bwi_smoother *w = smoother_of(context, &s, true);
  int64_t own = s.pattern->start[s.b.mesh->node_count] - 1; /* the last node, at the free end */
  for (int c = 0; c < 9; c++)
    s.stiffness[9 * own + c] = 0;
  check_ok(context, bwi_smoother_follow(context, w, &(bwi_stiffness){.values = s.stiffness},
                                        s.dof_map, &usable));
  assert_false(usable);
  bw_release(w);
  scene_clear(&s);
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  scene s;
  scene_make(context, 1, 0, &s);
  bwi_smoother *w = NULL;
  check_allocations(context, w,
                    bwi_smoother_create(context, s.b.mesh, s.pattern, true, true,
                                        &(bwi_stiffness){.values = s.stiffness}, &w));
  scene_clear(&s);
}

check_main(check_test(chunks_are_apart), check_test(halves), check_test(products),
           check_test(upper_halves_alone), check_test(sweeps), check_test(blocks_are_solved),
           check_test(singular_nodes_are_reported), check_test(no_memory))
