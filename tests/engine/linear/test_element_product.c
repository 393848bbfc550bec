/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Products by elements beside those of the stored blocks. */
#include "linear/element_product.h"

#include "bodies.h"

typedef struct scene {
  bw_mesh *mesh;
  bw_block_pattern *pattern;
  bw_dof_map *dof_map;
  double *stiffness;
  bwi_smoother *smoother;
  bwi_element_product *product;
} scene;

/* A box whose corners are moved at random; `bend`: its mid-edge nodes too. */
static bw_mesh *random_mesh(bw_context *context, const int cells[3], double bend) {
  bw_random random;
  bw_mesh *moved = NULL,
          *mesh = body_box(context, cells[0], cells[1], cells[2], cells[0], cells[1], cells[2], 2);
  double *node = numbers(3 * (int64_t)mesh->node_count);
  bw_random_seed(&random, 11);
  for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
    node[i] = mesh->node[i] + 0.2 * (bw_random_uniform(&random) - 0.5);
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int m = 0; m < 6; m++)
      for (int d = 0; d < 3; d++) {
        const int32_t *of = mesh->element + 10 * e;
        node[3 * (int64_t)of[4 + m] + d] = 0.5 * (node[3 * (int64_t)of[bw_tet_edge[m][0]] + d] +
                                                  node[3 * (int64_t)of[bw_tet_edge[m][1]] + d]) +
                                           bend * (d == m % 3);
      }
  check_ok(context, bw_mesh_moved(context, mesh, node, &moved));
  bw_release(mesh);
  free(node);
  return moved;
}

static bw_material *wood(bw_context *context) {
  const bw_orthotropic constants = {.name = "wood",
                                    .young = {11e9, 0.9e9, 0.5e9},
                                    .poisson = {0.4, 0.03, 0.4},
                                    .shear = {0.04e9, 0.7e9, 0.8e9},
                                    .axes = {0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1}};
  bw_material *material = NULL;
  check_ok(context, bw_material_orthotropic(context, &constants, &material));
  return material;
}

static void scene_make(bw_context *context, bw_mesh *mesh, const bw_material *material, scene *s) {
  bool usable;
  *s = (scene){.mesh = mesh};
  check_ok(context, bw_block_pattern_create(context, mesh, &s->pattern));
  check_ok(context, bw_dof_map_unconstrained(context, mesh, &s->dof_map));
  s->stiffness = numbers(9 * s->pattern->block_count);
  check_ok(context, bw_stiffness(context, s->pattern, mesh, material, s->stiffness));
  check_ok(context,
           bwi_smoother_create(context, mesh, s->pattern, false, false, NULL, &s->smoother));
  check_ok(context,
           bwi_smoother_follow(context, s->smoother, &(bwi_stiffness){.values = s->stiffness},
                               s->dof_map, &usable));
  assert_true(usable);
  check_ok(context, bwi_element_product_create(context, s->smoother, mesh, material, &s->product));
}

static void scene_clear(scene *s) {
  bw_release(s->product);
  bw_release(s->smoother);
  bw_release(s->dof_map);
  bw_release(s->pattern);
  bw_release(s->mesh);
  free(s->stiffness);
}

/* The largest difference of two products, over the largest number in them; energies agree. Both
 * write what is there before. */
static double off(bw_context *context, const scene *s, int width) {
  int64_t size = 3 * (int64_t)s->mesh->node_count * width;
  double *x = numbers(size + BWI_SMOOTHER_SPARE), largest = 0, most = 0;
  double *y = numbers(size + BWI_SMOOTHER_SPARE), *z = numbers(size + BWI_SMOOTHER_SPARE);
  double by_blocks[BWI_SMOOTHER_SIDES], by_elements[BWI_SMOOTHER_SIDES];
  random_field(5, size, x);
  random_field(6, size, z);
  check_ok(context, bwi_smoother_product(context, s->smoother, width, x, y, by_blocks));
  check_ok(context, bwi_element_product_apply(context, s->product, width, x, z, by_elements));
  for (int64_t i = 0; i < size; i++) {
    largest = fmax(largest, fabs(y[i]));
    most = fmax(most, fabs(y[i] - z[i]));
  }
  for (int f = 0; f < width; f++)
    check_near(by_elements[f] / by_blocks[f], 1, 1e-12);
  for (int k = 0; k < BWI_SMOOTHER_SPARE; k++)
    assert_true(z[size + k] == 0);
  free(x);
  free(y);
  free(z);
  return most / largest;
}

/* Of any width, of bodies that are long, flat and too small for two chunks, isotropic and not. */
static void is_the_stored_product(void **state) {
  bw_context *context = check_context(state);
  const int cells[4][3] = {{40, 2, 2}, {9, 9, 1}, {6, 7, 8}, {1, 1, 1}};
  for (int k = 0; k < 8; k++) {
    bw_material *material = k % 2 ? wood(context) : body_material(context);
    scene s;
    scene_make(context, random_mesh(context, cells[k / 2], 0), material, &s);
    assert_true(k / 2 != 0 || s.smoother->chunk_count > 2);
    for (int width = 1; width <= BWI_SMOOTHER_SIDES; width = width / 4 * 4 + 4)
      check_near(off(context, &s, width), 0, 1e-14);
    scene_clear(&s);
    bw_release(material);
  }
}

/* Elements may touch chunks that are not neighbours: there are fewer groups then. Nodes in the
 * order of a random permutation stand for a body whose chunks are thin. */
static void thin_chunks(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {4, 4, 4};
  bw_material *material = body_material(context);
  scene s;
  scene_make(context, random_mesh(context, cells, 0), material, &s);
  bwi_smoother *w = s.smoother;
  w->chunk_count = 16;
  for (int c = 0; c <= 16; c++) {
    w->chunk_start[c] = (int32_t)((int64_t)c * w->count / 16);
    w->between_start[c] = w->count;
  }
  bw_release(s.product);
  s.product = NULL;
  check_ok(context, bwi_element_product_create(context, w, s.mesh, material, &s.product));
  w->chunk_count = 1; /* for the stored product */
  w->chunk_start[1] = w->count;
  check_near(off(context, &s, 1), 0, 1e-14);
  check_near(off(context, &s, 12), 0, 1e-14);
  scene_clear(&s);
  bw_release(material);
}

static void any_number_of_threads(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {40, 3, 2};
  bw_material *material = body_material(context);
  scene s;
  scene_make(context, random_mesh(context, cells, 0), material, &s);
  for (int width = 1; width <= BWI_SMOOTHER_SIDES; width = width / 4 * 4 + 4) {
    int64_t size = 3 * (int64_t)s.mesh->node_count * width;
    double *x = numbers(size + BWI_SMOOTHER_SPARE), *y[4], energy[4][BWI_SMOOTHER_SIDES] = {{0}};
    random_field(5, size, x);
    for (int threads = 1; threads <= 4; threads++) {
      y[threads - 1] = numbers(size + BWI_SMOOTHER_SPARE);
      check_ok(context, bw_set_threads(context, threads));
      check_ok(context, bwi_element_product_apply(context, s.product, width, x, y[threads - 1],
                                                  energy[threads - 1]));
      assert_memory_equal(y[0], y[threads - 1], (size_t)size * sizeof *x);
      assert_memory_equal(energy[0], energy[threads - 1], sizeof energy[0]);
    }
    for (int k = 0; k < 4; k++)
      free(y[k]);
    free(x);
  }
  scene_clear(&s);
  bw_release(material);
}

static bool serves(bw_context *context, const bw_mesh *mesh, const bw_material *material) {
  bool answer;
  check_ok(context, bwi_element_product_serves(context, mesh, material, &answer));
  return answer;
}

/* Curved elements, several orientations, B-bar and linear elements have the stored product. */
static void serves_straight_elements(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {2, 2, 2};
  bw_mesh *straight = random_mesh(context, cells, 0), *curved = random_mesh(context, cells, 0.05);
  bw_mesh *linear = body_box(context, 1, 1, 1, 2, 2, 2, 1);
  bw_material *material = body_material(context), *fibres = wood(context), *rotated = NULL;
  bw_material *soft = NULL, *mean = NULL;
  const bw_isotropic rubber = {.name = "rubber", .young = 1e6, .poisson = 0.49};
  int32_t *of_element = calloc((size_t)straight->element_count, sizeof *of_element);
  const double rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  check_ok(context, bw_material_rotated_by_element(context, fibres, straight->element_count, 1,
                                                   of_element, rotation, &rotated));
  check_ok(context, bw_material_isotropic(context, &rubber, &soft));
  check_ok(context, bw_material_formulated(context, soft, BW_B_BAR, &mean));
  assert_true(serves(context, straight, material));
  assert_true(serves(context, straight, soft));
  assert_true(serves(context, straight, fibres));
  assert_false(serves(context, curved, material));
  assert_false(serves(context, linear, material));
  assert_false(serves(context, straight, rotated));
  assert_false(serves(context, straight, mean));
  free(of_element);
  bw_release(straight);
  bw_release(curved);
  bw_release(linear);
  bw_release(material);
  bw_release(fibres);
  bw_release(rotated);
  bw_release(soft);
  bw_release(mean);
}

static void no_memory(void **state) {
  bw_context *context = check_context(state);
  const int cells[3] = {2, 2, 2};
  bw_material *material = body_material(context);
  scene s;
  scene_make(context, random_mesh(context, cells, 0), material, &s);
  bwi_element_product *product = NULL;
  check_allocations(context, product,
                    bwi_element_product_create(context, s.smoother, s.mesh, material, &product));
  scene_clear(&s);
  bw_release(material);
}

check_main(check_test(is_the_stored_product), check_test(thin_chunks),
           check_test(any_number_of_threads), check_test(serves_straight_elements),
           check_test(no_memory))
