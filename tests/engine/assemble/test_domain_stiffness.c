/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stiffness kept domain by domain: against that from scratch after any edits, the paper's formulas
 * against quadrature, what counts as changed, derivatives. */
#include "assemble/dense.h"

/* ---- a bar of five domains: R F R F R, the blended ones two cells long ---- */

enum { DOMAINS = 5, RIGID = 3 };

typedef struct bar {
  bw_mesh *rest;
  bw_graph *graph;
  int32_t *element_domain, *node_domain;
  int32_t *left, *right; /* per node: which domains of type R it follows (0, 1, 2) */
  double *weight;        /* of the right one */
} bar;

/* Domains by the place along x of an element's middle; 0 2 4 are of type R. */
static int32_t strip(double x, double length) {
  double at = 8 * x / length;
  return at < 2 ? 0 : at < 3 ? 1 : at < 5 ? 2 : at < 6 ? 3 : 4;
}

static void bar_create(bw_context *context, int order, bar *b) {
  shaken_box(context, 8, 2, 1, order, 0, 0, &b->rest);
  check_ok(context, bw_graph_create(context, b->rest, &b->graph));
  int n = b->rest->node_count, per = b->rest->nodes_per_element;
  double length = 0.3 * 8;
  b->element_domain = (int32_t *)malloc(sizeof(int32_t) * (size_t)b->rest->element_count);
  b->node_domain = (int32_t *)malloc(sizeof(int32_t) * (size_t)n);
  b->left = (int32_t *)malloc(sizeof(int32_t) * (size_t)n);
  b->right = (int32_t *)malloc(sizeof(int32_t) * (size_t)n);
  b->weight = (double *)malloc(sizeof(double) * (size_t)n);
  for (int e = 0; e < b->rest->element_count; e++) {
    double x = 0;
    for (int a = 0; a < 4; a++)
      x += 0.25 * b->rest->node[3 * b->rest->element[per * e + a]];
    b->element_domain[e] = strip(x, length);
  }
  for (int i = 0; i < n; i++) {
    double at = 8 * b->rest->node[3 * i] / length;
    b->left[i] = b->right[i] = at < 2.5 ? 0 : at < 5.5 ? 1 : 2;
    b->weight[i] = 0;
    b->node_domain[i] = at < 2 + 1e-9   ? 0
                        : at < 3 - 1e-9 ? 1
                        : at < 5 + 1e-9 ? 2
                        : at < 6 - 1e-9 ? 3
                                        : 4;
    for (int f = 0; f < 2; f++)
      if (at > 2 + 3 * f - 1e-9 && at < 3 + 3 * f + 1e-9) {
        b->left[i] = f;
        b->right[i] = f + 1;
        b->weight[i] = at - 2 - 3 * f;
      }
  }
}

static void bar_clear(bar *b) {
  free(b->element_domain), free(b->node_domain), free(b->left), free(b->right), free(b->weight);
  bw_release(b->graph);
  bw_release(b->rest);
}

/* What the three domains of type R do: x -> linear x + shift with linear = rotation * stretch. */
typedef struct pose {
  double rotation[RIGID][9], stretch[RIGID][9], shift[RIGID][3];
  bool bulged[DOMAINS]; /* inner corner nodes of the domain moved on their own */
  uint64_t seed[DOMAINS];
} pose;

static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void pose_rest(pose *p) {
  memset(p, 0, sizeof *p);
  for (int r = 0; r < RIGID; r++) {
    memcpy(p->rotation[r], one, sizeof one);
    memcpy(p->stretch[r], one, sizeof one);
  }
}

static void times(const double *a, const double *b, double *out) {
  double c[9];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
  memcpy(out, c, sizeof c);
}

static void turn(double angle, const double direction[3], double out[9]) {
  double n = bw_norm(direction), u[3] = {direction[0] / n, direction[1] / n, direction[2] / n};
  double c = cos(angle), s = sin(angle);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      out[3 * i + j] = (i == j) * c + (1 - c) * u[i] * u[j];
  out[1] -= s * u[2], out[2] += s * u[1], out[3] += s * u[2];
  out[5] -= s * u[0], out[6] -= s * u[1], out[7] += s * u[0];
}

static void transposed(const double *a, double *out) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      out[3 * i + j] = a[3 * j + i];
}

/* Nodes and motions of a pose; NULL when an element is inverted. */
static bw_mesh *posed(bw_context *context, const bar *b, const pose *p, bw_domain_motion *motion) {
  const bw_mesh *rest = b->rest;
  int n = rest->node_count;
  double linear[RIGID][9], *node = (double *)malloc(sizeof *node * 3 * (size_t)n);
  for (int r = 0; r < RIGID; r++)
    times(p->rotation[r], p->stretch[r], linear[r]);
  bw_random random;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      const double *x = rest->node + 3 * i;
      int l = b->left[i], r = b->right[i];
      double from = bw_dot(linear[l] + 3 * k, x) + p->shift[l][k];
      double to = bw_dot(linear[r] + 3 * k, x) + p->shift[r][k];
      node[3 * i + k] = l == r ? from : (1 - b->weight[i]) * from + b->weight[i] * to;
    }
  /* nodes of one domain's elements only may move on their own */
  int per = rest->nodes_per_element;
  int32_t *only = (int32_t *)malloc(sizeof *only * (size_t)n);
  for (int i = 0; i < n; i++)
    only[i] = -1;
  for (int e = 0; e < rest->element_count; e++)
    for (int a = 0; a < 4; a++) {
      int32_t *o = &only[rest->element[per * e + a]];
      *o = *o == -1 || *o == b->element_domain[e] ? b->element_domain[e] : -2;
    }
  for (int d = 0; d < DOMAINS; d++) {
    if (!p->bulged[d])
      continue;
    bw_random_seed(&random, p->seed[d]);
    for (int i = 0; i < n; i++)
      for (int k = 0; k < 3; k++)
        if (only[i] == d)
          node[3 * i + k] += 0.04 * (bw_random_uniform(&random) - 0.5);
  }
  free(only);
  if (rest->order == 2)
    for (int e = 0; e < rest->element_count; e++) {
      const int32_t *of = rest->element + 10 * e;
      for (int m = 0; m < 6; m++)
        for (int k = 0; k < 3; k++)
          node[3 * of[4 + m] + k] =
              0.5 * (node[3 * of[bw_tet_edge[m][0]] + k] + node[3 * of[bw_tet_edge[m][1]] + k]);
    }
  for (int d = 0; d < DOMAINS; d++) {
    bw_domain_motion_rest(&motion[d]);
    if (d % 2 == 0) {
      memcpy(motion[d].linear, linear[d / 2], sizeof one);
      transposed(p->rotation[d / 2], motion[d].frame);
      motion[d].reshaped = p->bulged[d];
    } else { /* as a whole when both neighbours have one map */
      int l = d / 2;
      bool whole = memcmp(linear[l], linear[l + 1], sizeof one) == 0 &&
                   memcmp(p->shift[l], p->shift[l + 1], sizeof p->shift[l]) == 0;
      memcpy(motion[d].linear, linear[l], sizeof one);
      transposed(p->rotation[l], motion[d].frame);
      motion[d].reshaped = !whole || p->bulged[d];
    }
  }
  bw_mesh *moved = NULL;
  if (bw_mesh_moved(context, rest, node, &moved) != BW_OK)
    moved = NULL;
  free(node);
  return moved;
}

/* Largest difference of entries, relative to the largest entry. */
static double difference(const double *a, const double *b, int64_t n) {
  double most = 0, size = 0;
  for (int64_t k = 0; k < n; k++) {
    most = fmax(most, fabs(a[k] - b[k]));
    size = fmax(size, fabs(b[k]));
  }
  return most / size;
}

/* Element matrices by quadrature, each with its domain's turned material. */
static void scratch_turned(bw_context *context, const bar *b, const bw_mesh *mesh,
                           const bw_material *material, const bw_domain_motion *motion,
                           double *values) {
  bw_material *turned[DOMAINS];
  for (int d = 0; d < DOMAINS; d++) {
    double rotation[9];
    transposed(motion[d].frame, rotation);
    check_ok(context, bw_material_rotated(context, material, rotation, &turned[d]));
  }
  const bw_graph *g = b->graph;
  int per = mesh->nodes_per_element;
  double *k = (double *)malloc(sizeof *k * 900 * (size_t)mesh->element_count);
  for (int e = 0; e < mesh->element_count; e++) {
    double x[10][3];
    for (int a = 0; a < per; a++)
      memcpy(x[a], mesh->node + 3 * mesh->element[per * e + a], sizeof x[a]);
    check_ok(context, bw_element_stiffness(context, mesh->order, (const double(*)[3])x,
                                           turned[b->element_domain[e]], k + 900 * e));
  }
  memset(values, 0, sizeof *values * 9 * (size_t)g->pair_count);
  for (int64_t p = 0; p < g->pair_count; p++)
    for (int64_t q = g->gather_start[p]; q < g->gather_start[p + 1]; q++) {
      int row = g->gather_local[q] >> 4, column = g->gather_local[q] & 15;
      const double *full = k + 900 * g->gather_element[q];
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          values[9 * p + 3 * i + j] += full[(3 * row + i) * 3 * per + 3 * column + j];
    }
  free(k);
  for (int d = 0; d < DOMAINS; d++)
    bw_release(turned[d]);
}

static double uniform(bw_random *random, double low, double high) {
  return low + (high - low) * bw_random_uniform(random);
}

/* One random edit of a pose. */
static void edit(bw_random *random, pose *p) {
  int r = (int)(bw_random_bits(random) % RIGID), d = (int)(bw_random_bits(random) % DOMAINS);
  double axis[3] = {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, 0.1, 1)}, q[9];
  switch (bw_random_bits(random) % 7) {
  case 0: /* stretch along the axes of rest */
    memcpy(p->stretch[r], one, sizeof one);
    for (int k = 0; k < 3; k++)
      p->stretch[r][4 * k] = uniform(random, 0.8, 1.3);
    break;
  case 1: /* turn a part */
    turn(uniform(random, -0.15, 0.15), axis, q);
    times(q, p->rotation[r], p->rotation[r]);
    break;
  case 2: /* move a part */
    for (int k = 0; k < 3; k++)
      p->shift[r][k] = uniform(random, -0.05, 0.05);
    break;
  case 3: /* shear */
    p->stretch[r][1] = uniform(random, -0.2, 0.2);
    break;
  case 4: /* move nodes of one domain, or put them back */
    p->bulged[d] = bw_random_bits(random) % 3 != 0;
    p->seed[d] = bw_random_bits(random);
    break;
  case 5: /* turn everything as a whole, by any angle */
    turn(uniform(random, -3, 3), axis, q);
    for (int k = 0; k < RIGID; k++) {
      double shift[3];
      times(q, p->rotation[k], p->rotation[k]);
      for (int i = 0; i < 3; i++)
        shift[i] = bw_dot(q + 3 * i, p->shift[k]) + 0.1 * axis[i];
      memcpy(p->shift[k], shift, sizeof shift);
    }
    break;
  case 6: /* one map for all */
    for (int k = 1; k < RIGID; k++) {
      memcpy(p->rotation[k], p->rotation[0], sizeof one);
      memcpy(p->stretch[k], p->stretch[0], sizeof one);
      memcpy(p->shift[k], p->shift[0], sizeof p->shift[0]);
    }
    break;
  }
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
    size_t entries = 9 * (size_t)b.graph->pair_count;
    double *scratch = (double *)malloc(sizeof *scratch * entries);
    for (int kind = 0; kind < 3; kind++) {
      bw_domain_stiffness *s = NULL;
      const bw_material *material = kind ? odd : plain;
      check_ok(context, bw_domain_stiffness_create(context, b.graph, b.rest, material, kind == 2,
                                                   DOMAINS, b.element_domain, b.node_domain, &s));
      check_ok(context, bw_stiffness(context, b.graph, b.rest, material, scratch));
      assert_true(difference(s->values, scratch, (int64_t)entries) < 1e-13);
      for (int sequence = 0; sequence < sequences / 6 + 1; sequence++, done++) {
        pose p;
        pose_rest(&p);
        bw_domain_motion motion[DOMAINS];
        int steps = 1 + (int)(bw_random_bits(&random) % 8);
        for (int step = 0; step < steps; step++) {
          pose next = p;
          edit(&random, &next);
          bw_mesh *moved = posed(context, &b, &next, motion);
          if (!moved)
            continue; /* inverted: such an edit is refused */
          p = next;
          bw_domain_change change;
          uint64_t revision = s->revision;
          check_ok(context, bw_domain_stiffness_update(context, s, moved, motion, &change));
          assert_int_equal(change.kept + change.evaluated + change.gathered, DOMAINS);
          assert_int_equal(s->revision - revision, change.kept < DOMAINS);
          kept += change.kept, evaluated += change.evaluated, gathered += change.gathered;
          if (step % 3 == 0 || step == steps - 1) {
            if (kind == 2)
              scratch_turned(context, &b, moved, material, motion, scratch);
            else
              check_ok(context, bw_stiffness(context, b.graph, moved, material, scratch));
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

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(any_edits_equal_scratch),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
