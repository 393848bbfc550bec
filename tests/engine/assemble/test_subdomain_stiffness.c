/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stiffness kept subdomain by subdomain: against that from scratch after any edits, bit for bit by
 * any way, and what it refuses. */
#include "assemble/internal.h"
#include "assemble/subdomain_bar.h"

/* Element matrices by quadrature, each with its subdomain's turned material. */
static void scratch_turned(bw_context *context, const bar *b, const bw_mesh *mesh,
                           const bw_material *material, const bw_subdomain_motion *motion,
                           double *values) {
  bw_material *turned[SUBDOMAINS];
  for (int d = 0; d < SUBDOMAINS; d++) {
    double rotation[9];
    transposed(motion[d].frame, rotation);
    check_ok(context, bw_material_rotated(context, material, rotation, &turned[d]));
  }
  const bw_block_pattern *g = b->pattern;
  bwi_contributions *list = NULL;
  int per = mesh->nodes_per_element;
  double *k = (double *)malloc(sizeof *k * 900 * (size_t)mesh->element_count);
  for (int e = 0; e < mesh->element_count; e++) {
    double x[10][3];
    for (int a = 0; a < per; a++)
      memcpy(x[a], mesh->node + 3 * mesh->element[per * e + a], sizeof x[a]);
    check_ok(context, bw_element_stiffness(context, mesh->order, (const double(*)[3])x,
                                           turned[b->element_subdomain[e]], k + 900 * e));
  }
  memset(values, 0, sizeof *values * 9 * (size_t)g->block_count);
  check_ok(context,
           bwi_contributions_create(context, g, mesh->element_count, per, mesh->element, &list));
  for (int64_t p = 0; p < g->block_count; p++)
    for (int64_t q = list->start[p]; q < list->start[p + 1]; q++) {
      int row = list->local[q] >> 4, column = list->local[q] & 15;
      const double *full = k + 900 * list->element[q];
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          values[9 * p + 3 * i + j] += full[(3 * row + i) * 3 * per + 3 * column + j];
    }
  free(k);
  bw_release(list);
  for (int d = 0; d < SUBDOMAINS; d++)
    bw_release(turned[d]);
}

/* After any edits the entries are those from scratch. Materials: isotropic; orthotropic that stays;
 * orthotropic that turns. */
static void any_edits_equal_scratch(void **state) {
  bw_context *context = check_context(state);
  bw_material *plain = plain_material(context, 2e9, 0.3), *odd = odd_material(context);
  int sequences = getenv("BARWRIGHT_FULL") ? 2000 : 500, done = 0;
  double worst = 0;
  int32_t kept = 0, evaluated = 0, gathered = 0;
  bw_random random;
  bw_random_seed(&random, 2026);
  for (int order = 1; order <= 2; order++) {
    bar b;
    bar_create(context, order, &b);
    size_t entries = 9 * (size_t)b.pattern->block_count;
    double *scratch = (double *)malloc(sizeof *scratch * entries);
    for (int kind = 0; kind < 3; kind++) {
      bw_subdomain_stiffness *s = NULL;
      const bw_material *material = kind ? odd : plain;
      check_ok(context, bw_subdomain_stiffness_create(context, b.pattern, b.rest, material,
                                                      kind == 2, SUBDOMAINS, b.element_subdomain,
                                                      b.node_subdomain, &s));
      check_ok(context, bw_stiffness(context, b.pattern, b.rest, material, scratch));
      assert_true(difference(s->values, scratch, (int64_t)entries) < 1e-13);
      for (int sequence = 0; sequence < sequences / 6 + 1; sequence++, done++) {
        pose p;
        pose_rest(&p);
        bw_subdomain_motion motion[SUBDOMAINS];
        int steps = 1 + (int)(bw_random_bits(&random) % 8);
        for (int step = 0; step < steps; step++) {
          pose next = p;
          edit(&random, &next);
          bw_mesh *moved = posed(context, &b, &next, motion);
          if (!moved)
            continue; /* inverted: such an edit is refused */
          p = next;
          bw_subdomain_change change;
          uint64_t revision = s->revision;
          check_ok(context,
                   bw_subdomain_stiffness_update(context, s, moved, s->material, motion, &change));
          assert_int_equal(change.kept + change.evaluated + change.gathered, SUBDOMAINS);
          assert_int_equal(s->revision - revision, change.kept < SUBDOMAINS);
          kept += change.kept, evaluated += change.evaluated, gathered += change.gathered;
          if (step % 3 == 0 || step == steps - 1) {
            if (kind == 2)
              scratch_turned(context, &b, moved, material, motion, scratch);
            else
              check_ok(context, bw_stiffness(context, b.pattern, moved, material, scratch));
            worst = fmax(worst, difference(s->values, scratch, (int64_t)entries));
          }
          bw_release(moved);
        }
      }
      bw_release(s);
    }
    free(scratch);
    bar_clear(&b);
  }
  print_message("%d sequences, largest difference %.2g; kept %d, evaluated %d, gathered %d\n", done,
                worst, kept, evaluated, gathered);
  assert_true(worst < 1e-12);
  assert_true(done >= 500 && kept > 500 && evaluated > 500 && gathered > 500);
  bw_release(plain);
  bw_release(odd);
}

/* Entries depend on where the subdomains are and not on how they came there: bit for bit, and for
 * any number of threads. */
static void same_bits_by_any_way(void **state) {
  bw_context *context = check_context(state);
  const int threads[] = {1, 2, 3, 7};
  double *first = NULL;
  for (int t = 0; t < 4; t++) {
    session now;
    check_ok(context, bw_set_threads(context, threads[t]));
    session_create(context, 2, t % 2, false, &now);
    size_t size = sizeof(double) * 9 * (size_t)now.b.pattern->block_count;
    bw_random random;
    bw_random_seed(&random, 5 + (uint64_t)t); /* other ways */
    for (int step = 0; step < 6; step++) {
      pose before = now.p;
      edit(&random, &now.p);
      bw_mesh *moved = posed(context, &now.b, &now.p, now.motion);
      if (moved)
        check_ok(context, bw_subdomain_stiffness_update(context, now.s, moved, now.s->material,
                                                        now.motion, NULL));
      else
        now.p = before;
      bw_release(moved);
    }
    pose_rest(&now.p);
    now.p.stretch[0][0] = 1.25;
    now.p.stretch[2][8] = 0.75;
    now.p.bulged[2] = true;
    now.p.seed[2] = 99;
    session_update(context, &now);
    if (t < 2) { /* one of each material */
      first = (double *)realloc(first, 2 * size);
      memcpy(first + t * size / sizeof *first, now.s->values, size);
    } else
      assert_memory_equal(now.s->values, first + t % 2 * size / sizeof *first, size);
    session_clear(&now);
  }
  free(first);
}

/* One element per subdomain: every block of nodes is shared but for the insides; one subdomain:
 * none; seven scattered ones: all kinds of sets. The blocks of order 2 fill several tiles. */
static void many_subdomains_and_one(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = odd_material(context);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = NULL;
    bw_block_pattern *g = NULL;
    perturbed_box(context, 5 * order, 3, 3, order, 0.3, 0, &mesh);
    check_ok(context, bw_block_pattern_create(context, mesh, &g));
    int32_t n = mesh->element_count;
    int32_t *own = (int32_t *)malloc(sizeof(int32_t) * (size_t)n);
    int32_t *node = (int32_t *)malloc(sizeof(int32_t) * (size_t)mesh->node_count);
    bw_subdomain_motion *motion = (bw_subdomain_motion *)malloc(sizeof *motion * (size_t)(n + 1));
    double *values = (double *)malloc(sizeof(double) * 9 * (size_t)g->block_count);
    double *moved_node = (double *)malloc(sizeof(double) * 3 * (size_t)mesh->node_count);
    const double axis[3] = {0, 1, 1};
    double q[9];
    turn(0.7, axis, q);
    q[4] += 0.3; /* and a stretch */
    for (int i = 0; i < mesh->node_count; i++)
      for (int k = 0; k < 3; k++)
        moved_node[3 * i + k] = bw_dot(q + 3 * k, mesh->node + 3 * i);
    bw_mesh *moved = NULL;
    check_ok(context, bw_mesh_moved(context, mesh, moved_node, &moved));
    check_ok(context, bw_stiffness(context, g, moved, material, values));
    assert_true(order == 1 || g->block_count > 2 * 4096);
    for (int cut = 0; cut < 3; cut++) {
      /* a subdomain more than there are: one without elements does no harm */
      for (int e = 0; e < n; e++)
        own[e] = cut == 0 ? n - 1 - e : cut == 1 ? 0 : e % 7;
      for (int i = 0; i < mesh->node_count; i++)
        node[i] = -1;
      bw_subdomain_stiffness *s = NULL;
      check_ok(context, bw_subdomain_stiffness_create(context, g, mesh, material, false, n + 1, own,
                                                      node, &s));
      for (int32_t d = 0; d <= n; d++) {
        bw_subdomain_motion_rest(&motion[d]);
        memcpy(motion[d].linear, q, sizeof q);
        motion[d].reshaped = d % 3 == 1;
      }
      check_ok(context,
               bw_subdomain_stiffness_update(context, s, moved, s->material, motion, NULL));
      assert_true(difference(s->values, values, 9 * g->block_count) < 1e-13);
      assert_true(s->changed[0] && !s->changed[n] == !motion[n].reshaped);
      assert_true(bw_subdomain_stiffness_bytes(s) > 144 * (size_t)g->block_count);
      bw_release(s);
    }
    free(own), free(node), free(motion), free(values), free(moved_node);
    bw_release(moved);
    bw_release(g);
    bw_release(mesh);
  }
  bw_release(material);
}

/* ---- failures ---- */

static void refusals(void **state) {
  bw_context *context = check_context(state);
  session now;
  session_create(context, 2, true, false, &now);
  size_t size = sizeof(double) * 9 * (size_t)now.b.pattern->block_count;
  double *before = (double *)malloc(size);
  memcpy(before, now.s->values, size);
  bw_subdomain_motion motion[SUBDOMAINS];
  for (int d = 0; d < SUBDOMAINS; d++)
    bw_subdomain_motion_rest(&motion[d]);
  motion[0].linear[0] = 2; /* good, and must not be taken over when another is refused */
  const bw_mesh *rest = now.b.rest;

#define REFUSED(what, status, text, mesh)                                                          \
  do {                                                                                             \
    bw_subdomain_motion good = motion[3];                                                          \
    what;                                                                                          \
    check_fails(                                                                                   \
        context, status, text,                                                                     \
        bw_subdomain_stiffness_update(context, now.s, mesh, now.s->material, motion, NULL));       \
    assert_memory_equal(now.s->values, before, size);                                              \
    motion[3] = good;                                                                              \
  } while (0)
  REFUSED(motion[3].linear[4] = 0, BW_INVALID, "map of subdomain 4 has determinant 0", rest);
  REFUSED(motion[3].linear[4] = -1, BW_INVALID, "determinant -1", rest);
  REFUSED(motion[3].linear[4] = NAN, BW_INVALID, "not finite", rest);
  REFUSED(motion[3].frame[4] = 1.1, BW_INVALID, "frame of subdomain 4 is no rotation", rest);
  REFUSED(motion[3].frame[4] = -1, BW_INVALID, "right-handed", rest);
  bw_mesh *curved = NULL, *linear = NULL;
  double *node = (double *)malloc(sizeof(double) * 3 * (size_t)rest->node_count);
  memcpy(node, rest->node, sizeof(double) * 3 * (size_t)rest->node_count);
  for (int e = 0; e < rest->element_count; e++)
    if (now.b.element_subdomain[e] == 3)
      node[3 * rest->element[10 * e + 4]] += 1e-3;
  check_ok(context, bw_mesh_moved(context, rest, node, &curved));
  REFUSED(motion[3].reshaped = true, BW_INVALID, "midpoint", curved);
  check_ok(context, bw_mesh_with_order(context, rest, 1, &linear));
  REFUSED(, BW_INVALID, "the pattern belongs to", linear);
  bw_cancel(context);
  REFUSED(, BW_CANCELLED, "", rest);
  bw_clear_cancel(context);
  bw_subdomain_stiffness *none = NULL;
  check_fails(context, BW_INVALID, "midpoint",
              bw_subdomain_stiffness_create(context, now.b.pattern, curved, now.material, false,
                                            SUBDOMAINS, now.b.element_subdomain,
                                            now.b.node_subdomain, &none));
  now.b.element_subdomain[7] = SUBDOMAINS;
  check_fails(context, BW_INVALID, "element 8 is in subdomain 6",
              bw_subdomain_stiffness_create(context, now.b.pattern, rest, now.material, false,
                                            SUBDOMAINS, now.b.element_subdomain,
                                            now.b.node_subdomain, &none));
  now.b.element_subdomain[7] = 0;
  now.b.node_subdomain[5] = -2;
  check_fails(context, BW_INVALID, "node 6",
              bw_subdomain_stiffness_create(context, now.b.pattern, rest, now.material, false,
                                            SUBDOMAINS, now.b.element_subdomain,
                                            now.b.node_subdomain, &none));
  check_fails(context, BW_INVALID, "at least one",
              bw_subdomain_stiffness_create(context, now.b.pattern, rest, now.material, false, 0,
                                            now.b.element_subdomain, now.b.node_subdomain, &none));
  assert_null(none);
  free(before), free(node);
  bw_release(curved);
  bw_release(linear);
  session_clear(&now);
}

static void out_of_memory(void **state) {
  bw_context *context = check_context(state);
  session now;
  session_create(context, 2, true, false, &now);
  bw_subdomain_stiffness *other = NULL;
  check_each_allocation(context, status, 1) {
    status = bw_subdomain_stiffness_create(context, now.b.pattern, now.b.rest, now.material, false,
                                           SUBDOMAINS, now.b.element_subdomain,
                                           now.b.node_subdomain, &other);
    assert_true(status == BW_OK ? other != NULL : status == BW_MEMORY && !other);
  }
  bw_release(other);
  now.p.stretch[1][0] = 1.1;
  now.p.bulged[4] = true;
  bw_mesh *moved = posed(context, &now.b, &now.p, now.motion);
  size_t size = sizeof(double) * 9 * (size_t)now.b.pattern->block_count;
  double *before = (double *)malloc(size);
  memcpy(before, now.s->values, size);
  bw_status status = BW_MEMORY;
  for (int n = 1; status != BW_OK; n++) {
    bw_fail_allocation(n, true);
    status =
        bw_subdomain_stiffness_update(context, now.s, moved, now.s->material, now.motion, NULL);
    bw_fail_allocation(0, false);
    if (status != BW_OK) {
      assert_int_equal(status, BW_MEMORY);
      assert_memory_equal(now.s->values, before, size);
      assert_false(now.s->changed[1]);
    }
  }
  assert_true(now.s->changed[1] && now.s->changed[4]);
  free(before);
  bw_release(moved);
  session_clear(&now);
}

check_main(check_test(any_edits_equal_scratch), check_test(same_bits_by_any_way),
           check_test(many_subdomains_and_one), check_test(refusals), check_test(out_of_memory))
