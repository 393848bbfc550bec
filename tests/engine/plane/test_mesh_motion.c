/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Meshes that follow outlines: the three levels, random drags, the adjoint, the paper's drag. */
#include "outlines.h"

/* The mesh fills its outline: no element inverted, nodes on the outline, the area that of the
 * polygon along the sides (order 1), sides and neighbours right. */
static void check_mesh(bw_context *context, const bw_plane_mesh *mesh) {
  bw_plane_quality quality;
  bw_plane_measure(mesh, &quality);
  assert_int_equal(quality.inverted, 0);
  bw_plane_mesh *same = NULL;
  check_ok(context, bw_plane_mesh_moved(context, mesh, mesh->outline, mesh->point, &same));
  bw_release(same);
  const bw_plane_topology *t = mesh->topology;
  int width = t->nodes->order == 2 ? 6 : 3, per = t->nodes->order == 2 ? 3 : 2;
  double area = 0;
  for (int32_t s = 0; s < t->side_count; s++)
    for (int i = 0; i < 2; i++) {
      int32_t e = t->side_element[2 * s + i], a = t->side[per * s + i],
              b = t->side[per * s + 1 - i];
      if (e < 0)
        continue;
      const int32_t *n = t->element + width * e;
      assert_true((n[0] == a && n[1] == b) || (n[1] == a && n[2] == b) || (n[2] == a && n[0] == b));
      const double *x[3] = {mesh->point + 2 * a, mesh->point + 2 * b, NULL};
      area += (x[0][0] * x[1][1] - x[0][1] * x[1][0]) / 2;
      if (per == 3) {
        const double *m = mesh->point + 2 * t->side[per * s + 2];
        area += 2.0 / 3 *
                ((m[0] - x[0][0]) * (x[1][1] - x[0][1]) - (m[1] - x[0][1]) * (x[1][0] - x[0][0]));
      }
    }
  check_near(quality.area, area, 1e-12 * fabs(area) + 1e-12);
  for (int32_t h = 0; h < 3 * t->element_count; h++) {
    int32_t other = t->neighbour[h];
    if (other < 0)
      continue;
    const int32_t *n = t->element + h / 3 * width, *m = t->element + other * width;
    int k = m[0] == n[(h % 3 + 1) % 3] ? 0 : m[1] == n[(h % 3 + 1) % 3] ? 1 : 2;
    assert_int_equal(m[(k + 1) % 3], n[h % 3]);
    assert_int_equal(t->neighbour[3 * other + k], h / 3);
    if (width == 6)
      assert_int_equal(m[3 + k], n[3 + h % 3]);
  }
}

/* The outline of a mesh with one loop moved. */
static bw_outline *loop_at(bw_context *context, const bw_outline *outline, int32_t loop, double dx,
                           double dy) {
  double *weight = malloc(sizeof(double) * (size_t)outline->point_count);
  double *point = malloc(sizeof(double) * 2 * (size_t)outline->point_count);
  check_ok(context, bw_outline_handle(context, outline, BW_HANDLE_LOOP, loop, weight));
  for (int32_t i = 0; i < outline->point_count; i++) {
    point[2 * i] = outline->point[2 * i] + dx * weight[i];
    point[2 * i + 1] = outline->point[2 * i + 1] + dy * weight[i];
  }
  bw_outline *moved = NULL;
  check_ok(context, bw_outline_moved(context, outline, point, &moved));
  free(weight);
  free(point);
  return moved;
}

static void relocation(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *mesh = block_mesh(context, 1, order, 800);
    bw_mesh_motion *motion = NULL;
    bw_follow_report report;
    check_ok(context, bw_mesh_motion_create(context, mesh, NULL, &motion));
    check_ok(context, bw_mesh_motion_follow(context, motion, mesh->outline, &report));
    assert_int_equal(report.level, BW_LEVEL_NONE);
    bw_outline *moved = loop_at(context, mesh->outline, 1, 0.02, 0.01);
    check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
    assert_int_equal(report.level, BW_LEVEL_RELOCATION);
    assert_ptr_equal(motion->mesh->topology, mesh->topology);
    check_mesh(context, motion->mesh);
    bw_plane_quality quality;
    bw_plane_measure(motion->mesh, &quality);
    check_near(quality.worst, report.worst, 0);
    assert_int_equal(quality.worst_element, report.worst_element);
    bw_release(moved);
    /* the way there does not matter, nor what was precomputed on it */
    bw_mesh_motion *direct = NULL;
    check_ok(context, bw_mesh_motion_create(context, mesh, NULL, &direct));
    moved = loop_at(context, mesh->outline, 1, -0.01, 0.03);
    check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
    check_ok(context, bw_mesh_motion_follow(context, direct, moved, &report));
    for (int32_t i = 0; i < 2 * mesh->topology->nodes->node_count; i++)
      check_near(motion->mesh->point[i], direct->mesh->point[i], 1e-12);
    bw_release(direct);
    bw_release(moved);
    bw_release(motion);
    bw_release(mesh);
  }
}

/* A translation of the outline is one of the mesh, for springs once they are at rest. */
static void translation(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *mesh = block_mesh(context, 1.4, order, 600);
    bw_mesh_motion *motion = NULL;
    check_ok(context, bw_mesh_motion_create(context, mesh, NULL, &motion));
    bw_outline *moved = loop_at(context, mesh->outline, 0, 5, -3);
    bw_follow_report report;
    check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
    assert_int_equal(report.level, BW_LEVEL_RELOCATION);
    for (int32_t i = 0; i < 2 * mesh->topology->nodes->node_count; i++)
      check_near(motion->mesh->point[i], mesh->point[i] + (i % 2 ? -3 : 5), 2e-12);
    bw_release(moved);
    bw_release(motion);
    bw_release(mesh);
  }
}

/* d J / d points of J = g . nodes against finite differences. */
static void adjoint(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *mesh = block_mesh(context, 1.2, order, 300);
    bw_mesh_motion *motion = NULL;
    check_ok(context, bw_mesh_motion_create(context, mesh, NULL, &motion));
    int32_t nodes = mesh->topology->nodes->node_count, points = mesh->outline->point_count;
    double *g = malloc(sizeof(double) * 2 * (size_t)nodes);
    double *back = malloc(sizeof(double) * 2 * (size_t)points);
    double *place = malloc(sizeof(double) * 2 * (size_t)points);
    bw_random random;
    bw_random_seed(&random, 5);
    for (int32_t i = 0; i < 2 * nodes; i++)
      g[i] = bw_random_uniform(&random) - 0.5;
    check_ok(context, bw_mesh_motion_pull_back(context, motion, mesh, g, back));
    for (int trial = 0; trial < 5; trial++) {
      double slope = 0, change = 0, step = 1e-3;
      for (int32_t i = 0; i < 2 * points; i++) {
        double d = bw_random_uniform(&random) - 0.5;
        place[i] = mesh->outline->point[i] + step * d;
        slope += back[i] * d;
      }
      bw_outline *moved = NULL;
      bw_follow_report report;
      check_ok(context, bw_outline_moved(context, mesh->outline, place, &moved));
      check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
      assert_int_equal(report.level, BW_LEVEL_RELOCATION);
      for (int32_t i = 0; i < 2 * nodes; i++)
        change += g[i] * (motion->mesh->point[i] - mesh->point[i]);
      check_near(change / step, slope, 1e-9); /* linear */
      bw_release(moved);
    }
    free(g);
    free(back);
    free(place);
    bw_release(motion);
    bw_release(mesh);
  }
}

/* The paper's figure 2: a hole dragged from left to right through a block in 159 frames. */
static void the_papers_drag(void **state) {
  bw_context *context = check_context(state);
  for (int order = 1; order <= 2; order++)
    for (int springs = 0; springs < 2; springs++) {
      bw_plane_mesh *mesh = block_mesh(context, 0.4, order, 1952);
      bw_follow_options options;
      bw_follow_options_default(&options);
      options.relocation = springs ? BW_RELOCATE_SPRINGS : BW_RELOCATE_HARMONIC;
      bw_mesh_motion *motion = NULL;
      check_ok(context, bw_mesh_motion_create(context, mesh, &options, &motion));
      int levels[4] = {0, 0, 0, 0};
      double seconds[4] = {0, 0, 0, 0}, worst = 1;
      bw_outline *start = bw_retain(mesh->outline);
      for (int frame = 1; frame <= 159; frame++) {
        bw_outline *moved = loop_at(context, start, 1, 2.2 * frame / 159, 0);
        bw_follow_report report;
        check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
        levels[report.level]++;
        seconds[report.level] += report.seconds;
        worst = fmin(worst, report.worst);
        check_mesh(context, motion->mesh);
        bw_release(moved);
      }
      printf("order %d, %s: relocation %d (%.2f ms), reconnecting %d (%.2f ms), reconstruction %d "
             "(%.2f ms); worst quality %.3f; the paper: 117, 39, 3\n",
             order, springs ? "springs" : "harmonic", levels[1],
             1e3 * seconds[1] / fmax(levels[1], 1), levels[2],
             1e3 * seconds[2] / fmax(levels[2], 1), levels[3],
             1e3 * seconds[3] / fmax(levels[3], 1), worst);
      assert_int_equal(levels[0], 0);
      if (!springs)
        assert_true(levels[1] > 110 && levels[3] <= 3 && worst > 0.15);
      bw_release(start);
      bw_release(motion);
      bw_release(mesh);
    }
}

static void random_drags(void **state) {
  bw_context *context = check_context(state);
  bool full = getenv("BARWRIGHT_FULL") != NULL;
  int drags = full ? 10000 : 300, levels[4] = {0, 0, 0, 0}, refused = 0, given_up = 0;
  for (int order = 1; order <= 2; order++) {
    shape s = {.points = 0};
    add_box(&s, 0, "body", 0, 0, 4, 2);
    add_ellipse(&s, 1, "inlay", 1, 1, 0.6, 0.6);
    add_ellipse(&s, -1, "hole", 1, 1, 0.25, 0.25);
    add_box(&s, -1, "window", 2.5, 0.5, 3.5, 1.5);
    bw_plane_mesh *mesh = mesh_of(context, &s, order, 400);
    bw_mesh_motion *motion = NULL;
    check_ok(context, bw_mesh_motion_create(context, mesh, NULL, &motion));
    bw_random random;
    bw_random_seed(&random, 20261121);
    for (int drag = 0; drag < drags; drag++) {
      /* a handle, somewhere; now and then back to where all began */
      const bw_outline *now = motion->mesh->outline;
      if (drag % 50 == 49)
        now = mesh->outline;
      int kind = (int)(bw_random_uniform(&random) * 3);
      int32_t of = kind == BW_HANDLE_LOOP      ? now->loop_count
                   : kind == BW_HANDLE_SEGMENT ? now->segment_count
                                               : now->point_count;
      int32_t index = (int32_t)(bw_random_uniform(&random) * of);
      double weight[64], point[128];
      double size = bw_random_uniform(&random);
      size = 1.2 * size * size * size;
      double dx = size * bw_random_normal(&random) / 2, dy = size * bw_random_normal(&random) / 2;
      bw_outline *moved = NULL;
      bw_status status = bw_outline_handle(context, now, (bw_handle_kind)kind, index, weight);
      if (status == BW_OK) {
        for (int32_t i = 0; i < now->point_count; i++) {
          point[2 * i] = now->point[2 * i] + dx * weight[i];
          point[2 * i + 1] = now->point[2 * i + 1] + dy * weight[i];
        }
        status = bw_outline_moved(context, now, point, &moved);
      }
      if (status != BW_OK) {
        refused++;
        continue;
      }
      const bw_plane_mesh *before = motion->mesh;
      bw_follow_report report;
      status = bw_mesh_motion_follow(context, motion, moved, &report);
      if (status == BW_OK) {
        levels[report.level]++;
        assert_true(report.worst > 0);
        if (!full || drag % 10 == 0)
          check_mesh(context, motion->mesh);
      } else {
        given_up++;
        assert_true(status == BW_GEOMETRY || status == BW_LIMIT);
        assert_ptr_equal(motion->mesh, before);
      }
      bw_release(moved);
    }
    bw_release(motion);
    bw_release(mesh);
  }
  printf("random drags: %d refused by the outline, %d by the mesh; relocation %d, reconnecting %d, "
         "reconstruction %d\n",
         refused, given_up, levels[1], levels[2], levels[3]);
  assert_true(given_up <= drags / 50);
}

static void forced_levels(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = block_mesh(context, 1, 2, 500);
  for (int level = BW_LEVEL_RELOCATION; level <= BW_LEVEL_RECONSTRUCTION; level++) {
    bw_follow_options options;
    bw_follow_options_default(&options);
    options.force = (bw_level)level;
    bw_mesh_motion *motion = NULL;
    bw_follow_report report;
    check_ok(context, bw_mesh_motion_create(context, mesh, &options, &motion));
    bw_outline *moved = loop_at(context, mesh->outline, 1, 0.02, 0);
    check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
    assert_int_equal(report.level, level);
    assert_int_equal(motion->mesh->topology->nodes == mesh->topology->nodes,
                     level != BW_LEVEL_RECONSTRUCTION);
    check_mesh(context, motion->mesh);
    bw_release(moved);
    bw_release(motion);
  }
  bw_release(mesh);
}

/* A bar pulled out to many times its length gets about as many elements as it had, and on the way
 * there never far more: the edge length of the short bar is no measure for the long one. */
static void pulled_far(void **state) {
  bw_context *context = check_context(state);
  shape s = {.points = 0};
  add_box(&s, 0, "bar", 0, 0, 0.2, 0.03);
  bw_plane_mesh *mesh = mesh_of(context, &s, 1, 60);
  bw_follow_options options;
  bw_follow_options_default(&options);
  options.force = BW_LEVEL_RECONSTRUCTION;
  options.fill.limit = 20000;
  bw_mesh_motion *motion = NULL;
  bw_follow_report report;
  check_ok(context, bw_mesh_motion_create(context, mesh, &options, &motion));
  static const double length[2] = {0.21, 6000};
  for (int i = 0; i < 2; i++) {
    const double at[4][2] = {{0, 0}, {length[i], 0}, {length[i], 0.03}, {0, 0.03}};
    bw_outline *moved = NULL;
    check_ok(context, bw_outline_moved(context, mesh->outline, &at[0][0], &moved));
    check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
    assert_in_range(motion->mesh->topology->element_count, 50, 300);
    bw_release(moved);
  }
  bw_release(motion);
  bw_release(mesh);
}

static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = block_mesh(context, 1, 2, 100);
  static const double step[3] = {0.02, 0.35, 1.5};
  for (int i = 0; i < 3; i++) {
    bw_outline *moved = loop_at(context, mesh->outline, 1, step[i], 0);
    check_each_allocation(context, status, 1) {
      bw_mesh_motion *motion = NULL;
      bw_follow_report report;
      status = bw_mesh_motion_create(context, mesh, NULL, &motion);
      if (status == BW_OK) {
        status = bw_mesh_motion_follow(context, motion, moved, &report);
        if (status != BW_OK) {
          assert_int_equal(status, BW_MEMORY);
          assert_ptr_equal(motion->mesh, mesh);
          bw_fail_allocation(0, false); /* and it still works */
          check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
        }
      }
      bw_release(motion);
    }
    bw_release(moved);
  }
  bw_release(mesh);
}

static void budgets(void **state) {
  bw_context *context = check_context(state);
  if (!getenv("BARWRIGHT_FULL"))
    return;
  for (int order = 1; order <= 2; order++) {
    bw_plane_mesh *mesh = block_mesh(context, 0.4, order, 20000);
    bw_mesh_motion *motion = NULL;
    check_ok(context, bw_mesh_motion_create(context, mesh, NULL, &motion));
    bw_outline *start = bw_retain(mesh->outline);
    double best[4] = {1, 1, 1, 1}, sum[4] = {0, 0, 0, 0}, first = 0;
    int levels[4] = {0, 0, 0, 0};
    for (int frame = 1; frame <= 159; frame++) {
      bw_outline *moved = loop_at(context, start, 1, 2.2 * frame / 159, 0.1 * sin(frame / 10.0));
      bw_follow_report report;
      check_ok(context, bw_mesh_motion_follow(context, motion, moved, &report));
      if (frame == 1)
        first = report.seconds;
      best[report.level] = fmin(best[report.level], report.seconds);
      sum[report.level] += report.seconds;
      levels[report.level]++;
      bw_release(moved);
    }
    for (int l = 1; l < 4; l++)
      printf("order %d level %d: %d times, mean %.2f ms, best %.2f ms\n", order, l, levels[l],
             1e3 * sum[l] / fmax(levels[l], 1), 1e3 * best[l]);
    printf("first relocation, with the factor: %.2f ms\n", 1e3 * first);
    bw_release(start);
    bw_release(motion);
    bw_release(mesh);
  }
}

check_main(check_test(relocation), check_test(translation), check_test(adjoint),
           check_test(forced_levels), check_test(the_papers_drag), check_test(random_drags),
           check_test(budgets), check_test(pulled_far), check_test(memory_failures))
