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

/* ---- the paper's formulas ---- */

/* Elasticity tensor of a material. */
static double tensor_of(const bw_material *material, int i, int j, int k, int l) {
  static const int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
  return material->elasticity[6 * voigt[i][j] + voigt[k][l]];
}

/* alpha of eq. A.7 with the factor 1 / V that the printed one lacks (eq. 15 has it); l[k] = (b_k,
 * c_k, d_k) of eq. 11. */
static double paper_alpha(int i, int j, int first, int second, const double l[4][3],
                          double volume) {
#define S(u, v) ((u) == (v) ? 1.0 / 10 : 1.0 / 20)
  int m = i < 4 ? i : bw_tet_edge[i - 4][0], n = i < 4 ? i : bw_tet_edge[i - 4][1];
  int p = j < 4 ? j : bw_tet_edge[j - 4][0], q = j < 4 ? j : bw_tet_edge[j - 4][1];
  double sum;
  if (i < 4 && j < 4)
    sum = (4.0 / 9 * S(i, j) - 1.0 / 36) * l[i][first] * l[j][second];
  else if (i >= 4 && j >= 4)
    sum = 4.0 / 9 *
          (S(n, q) * l[m][first] * l[p][second] + S(m, q) * l[n][first] * l[p][second] +
           S(n, p) * l[m][first] * l[q][second] + S(m, p) * l[n][first] * l[q][second]);
  else if (i < 4)
    sum = (4.0 / 9 * S(i, q) - 1.0 / 36) * l[i][first] * l[p][second] +
          (4.0 / 9 * S(i, p) - 1.0 / 36) * l[i][first] * l[q][second];
  else
    sum = (4.0 / 9 * S(n, j) - 1.0 / 36) * l[m][first] * l[j][second] +
          (4.0 / 9 * S(m, j) - 1.0 / 36) * l[n][first] * l[j][second];
#undef S
  return sum / volume;
}

/* m of eq. A.8. */
static double paper_variable(int first, int second, const double s[3]) {
  return s[0] * s[1] * s[2] / (s[first] * s[second]);
}

/* Each entry of a scaled tetrahedron by A.7 and A.8 and by this engine's coefficients, against
 * quadrature on the scaled tetrahedron; isotropic and orthotropic. */
static void paper_formulas_against_quadrature(void **state) {
  bw_context *context = check_context(state);
  bw_material *material[2] = {plain_material(context, 2e9, 0.3), odd_material(context)};
  bw_random random;
  bw_random_seed(&random, 11);
  for (int trial = 0; trial < 50; trial++) {
    double x[10][3], scaled[10][3], l[4][3], inverse[9], edge[9], k[900];
    double s[3];
    do {
      for (int a = 0; a < 4; a++)
        for (int c = 0; c < 3; c++)
          x[a][c] = uniform(&random, -1, 1);
      for (int a = 1; a < 4; a++)
        for (int c = 0; c < 3; c++)
          edge[3 * (a - 1) + c] = x[a][c] - x[0][c];
    } while (bw_inverse3(edge, inverse) < 0.3);
    double volume = bw_inverse3(edge, inverse) / 6;
    for (int m = 0; m < 6; m++)
      for (int c = 0; c < 3; c++)
        x[4 + m][c] = 0.5 * (x[bw_tet_edge[m][0]][c] + x[bw_tet_edge[m][1]][c]);
    for (int c = 0; c < 3; c++)
      s[c] = uniform(&random, 0.3, 3);
    for (int a = 0; a < 10; a++)
      for (int c = 0; c < 3; c++)
        scaled[a][c] = s[c] * x[a][c];
    for (int c = 0; c < 3; c++) { /* eq. 11: L_k = (a_k + b_k x + c_k y + d_k z) / 6V */
      l[0][c] = 0;
      for (int a = 1; a < 4; a++) {
        l[a][c] = 6 * volume * inverse[3 * c + a - 1];
        l[0][c] -= l[a][c];
      }
    }
    int32_t element[10] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, zero[10] = {0};
    bw_mesh *mesh = NULL, *moved = NULL;
    bw_graph *graph = NULL;
    check_ok(context, bw_mesh_copy(context, 2, 10, &x[0][0], 1, element, NULL, &mesh));
    check_ok(context, bw_mesh_moved(context, mesh, &scaled[0][0], &moved));
    check_ok(context, bw_graph_create(context, mesh, &graph));
    for (int kind = 0; kind < 2; kind++) {
      bw_domain_stiffness *kept = NULL;
      bw_domain_motion motion;
      check_ok(context, bw_domain_stiffness_create(context, graph, mesh, material[kind], false, 1,
                                                   zero, zero, &kept));
      bw_domain_motion_rest(&motion);
      for (int c = 0; c < 3; c++)
        motion.linear[4 * c] = s[c];
      check_ok(context, bw_domain_stiffness_update(context, kept, moved, &motion, NULL));
      check_ok(context,
               bw_element_stiffness(context, 2, (const double(*)[3])scaled, material[kind], k));
      double size = 0;
      for (int a = 0; a < 900; a++)
        size = fmax(size, fabs(k[a]));
      for (int i = 0; i < 10; i++)
        for (int j = 0; j <= i; j++)
          for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) {
              double sum = 0;
              for (int first = 0; first < 3; first++)
                for (int second = 0; second < 3; second++)
                  sum += tensor_of(material[kind], r, first, c, second) *
                         paper_alpha(i, j, first, second, (const double(*)[3])l, volume) *
                         paper_variable(first, second, s);
              double expected = k[(3 * i + r) * 30 + 3 * j + c];
              check_near(sum, expected, 1e-13 * size);
              check_near(kept->values[9 * (i * (i + 1) / 2 + j) + 3 * r + c], expected,
                         1e-13 * size);
            }
      bw_release(kept);
    }
    bw_release(graph);
    bw_release(moved);
    bw_release(mesh);
  }
  bw_release(material[0]);
  bw_release(material[1]);
}

/* ---- what counts as changed ---- */

typedef struct session {
  bar b;
  bw_material *material;
  bw_domain_stiffness *s;
  pose p;
  bw_domain_motion motion[DOMAINS];
  bw_domain_change change;
} session;

static void session_create(bw_context *context, int order, bool plain, bool turns, session *now) {
  bar_create(context, order, &now->b);
  now->material = plain ? plain_material(context, 2e9, 0.3) : odd_material(context);
  check_ok(context,
           bw_domain_stiffness_create(context, now->b.graph, now->b.rest, now->material, turns,
                                      DOMAINS, now->b.element_domain, now->b.node_domain, &now->s));
  pose_rest(&now->p);
}

static void session_clear(session *now) {
  bw_release(now->s);
  bw_release(now->material);
  bar_clear(&now->b);
}

static void session_update(bw_context *context, session *now) {
  bw_mesh *moved = posed(context, &now->b, &now->p, now->motion);
  assert_non_null(moved);
  check_ok(context, bw_domain_stiffness_update(context, now->s, moved, now->motion, &now->change));
  bw_release(moved);
}

/* 'K'ept, 'E'valuated or 'G'athered counts and the changed flags, as "2K 1E 2G 01000". */
static void check_state_is(const session *now, const char *expected) {
  char text[64];
  int n = snprintf(text, sizeof text, "%dK %dE %dG ", now->change.kept, now->change.evaluated,
                   now->change.gathered);
  for (int d = 0; d < DOMAINS; d++)
    text[n++] = now->s->changed[d] ? '1' : '0';
  text[n] = 0;
  assert_string_equal(text, expected);
}

/* Turn every part from `first` on by a rotation about a point. */
static void turn_from(pose *p, int first, const double q[9], const double about[3]) {
  for (int r = first; r < RIGID; r++) {
    double shift[3];
    times(q, p->rotation[r], p->rotation[r]);
    for (int i = 0; i < 3; i++)
      shift[i] = bw_dot(q + 3 * i, p->shift[r]) + about[i] - bw_dot(q + 3 * i, about);
    memcpy(p->shift[r], shift, sizeof shift);
  }
}

static void what_counts_as_changed(void **state) {
  bw_context *context = check_context(state);
  const double axis[3] = {0.3, -0.2, 1}, origin[3] = {0}, joint[3] = {0.75, 0.2, 0.1};
  double q[9], small[9];
  turn(1.1, axis, q);
  turn(0.1, axis, small);
  session now;
  session_create(context, 2, true, false, &now);
  session_update(context, &now);
  check_state_is(&now, "5K 0E 0G 00000");
  /* moved as a whole: nothing; turned as a whole: written, not changed */
  for (int r = 0; r < RIGID; r++)
    now.p.shift[r][1] = 0.7;
  session_update(context, &now);
  check_state_is(&now, "5K 0E 0G 00000");
  turn_from(&now.p, 0, q, origin);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 00000");
  assert_int_equal(now.change.pairs, now.b.graph->pair_count);
  /* a bend at the first joint: all that hangs on it is written, the blended domain changed */
  turn_from(&now.p, 1, small, joint);
  session_update(context, &now);
  check_state_is(&now, "1K 3E 1G 01000");
  /* turned as a whole with a bend in it: the bent domain is gathered again, and has not changed */
  turn_from(&now.p, 0, q, joint);
  session_update(context, &now);
  check_state_is(&now, "0K 4E 1G 00000");
  /* moved as a whole with a bend in it */
  for (int r = 0; r < RIGID; r++)
    now.p.shift[r][2] += 0.25;
  session_update(context, &now);
  check_state_is(&now, "5K 0E 0G 00000");
  /* the last part made thicker: it and the blended one before it */
  now.p.stretch[2][4] = 1.2;
  session_update(context, &now);
  check_state_is(&now, "3K 1E 1G 00011");
  session_update(context, &now);
  check_state_is(&now, "5K 0E 0G 00000");
  /* nodes of a domain of type R moved on their own, and back */
  now.p.bulged[2] = true;
  session_update(context, &now);
  check_state_is(&now, "4K 0E 1G 00100");
  now.p.bulged[2] = false;
  session_update(context, &now);
  check_state_is(&now, "4K 1E 0G 00100");
  /* back to rest at once */
  pose_rest(&now.p);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 01011");
  session_clear(&now);

  /* axes that stay: turning as a whole changes everything; axes that turn: nothing */
  session_create(context, 1, false, false, &now);
  turn_from(&now.p, 0, q, origin);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 11111");
  session_clear(&now);
  session_create(context, 1, false, true, &now);
  turn_from(&now.p, 0, q, origin);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 00000");
  session_clear(&now);
}

/* Nodes in the global frame, and nodes of a neighbour: a domain changes when it turns against
 * either, though it may itself be left alone. */
static void frames_of_nodes_count(void **state) {
  bw_context *context = check_context(state);
  const double axis[3] = {0, 0, 1}, origin[3] = {0};
  double q[9];
  turn(0.3, axis, q);
  session now;
  session_create(context, 1, true, false, &now);
  int first_node = -1; /* of domain 0 alone */
  for (int i = 0; i < now.b.rest->node_count && first_node < 0; i++)
    first_node = now.b.rest->node[3 * i] < 0.1 ? i : -1;
  now.b.node_domain[first_node] = -1;
  bw_release(now.s);
  check_ok(context,
           bw_domain_stiffness_create(context, now.b.graph, now.b.rest, now.material, false,
                                      DOMAINS, now.b.element_domain, now.b.node_domain, &now.s));
  turn_from(&now.p, 0, q, origin);
  session_update(context, &now);
  check_state_is(&now, "0K 5E 0G 10000");
  /* the frame of domain 2 turned alone: entries of its neighbours at shared nodes change too */
  bw_domain_motion other[DOMAINS];
  memcpy(other, now.motion, sizeof other);
  times(q, other[2].frame, other[2].frame);
  check_ok(context, bw_domain_stiffness_update(context, now.s, now.b.rest, other, &now.change));
  check_state_is(&now, "5K 0E 0G 01110");
  session_clear(&now);
}

/* Entries depend on where the domains are and not on how they came there: bit for bit, and for any
 * number of threads. */
static void same_bits_by_any_way(void **state) {
  bw_context *context = check_context(state);
  const int threads[] = {1, 2, 3, 7};
  double *first = NULL;
  for (int t = 0; t < 4; t++) {
    session now;
    check_ok(context, bw_set_threads(context, threads[t]));
    session_create(context, 2, t % 2, false, &now);
    size_t size = sizeof(double) * 9 * (size_t)now.b.graph->pair_count;
    bw_random random;
    bw_random_seed(&random, 5 + (uint64_t)t); /* other ways */
    for (int step = 0; step < 6; step++) {
      pose before = now.p;
      edit(&random, &now.p);
      bw_mesh *moved = posed(context, &now.b, &now.p, now.motion);
      if (moved)
        check_ok(context, bw_domain_stiffness_update(context, now.s, moved, now.motion, NULL));
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

/* dK x against central differences, for each material and domain; the sum over p of a uniform
 * scaling is K itself (K grows with the length). */
static void derivative(void **state) {
  bw_context *context = check_context(state);
  for (int kind = 0; kind < 3; kind++) {
    session now;
    session_create(context, 2, kind == 0, kind == 2, &now);
    const bw_graph *g = now.b.graph;
    size_t n = 3 * (size_t)g->node_count, entries = 9 * (size_t)g->pair_count;
    double *x = (double *)malloc(sizeof(double) * n), *y = (double *)malloc(sizeof(double) * n);
    double *z = (double *)malloc(sizeof(double) * n),
           *k = (double *)malloc(sizeof(double) * entries);
    bw_random random;
    bw_random_seed(&random, 8);
    for (size_t i = 0; i < n; i++)
      x[i] = uniform(&random, -1, 1);
    bw_domain_motion motion[DOMAINS];
    const double axis[3] = {1, 2, -1};
    double q[9];
    turn(0.5, axis, q);
    for (int d = 0; d < DOMAINS; d++) {
      bw_domain_motion_rest(&motion[d]);
      for (int r = 0; r < 9; r++)
        motion[d].linear[r] += uniform(&random, -0.2, 0.2);
      times(q, motion[d].linear, motion[d].linear);
      transposed(q, motion[d].frame);
    }
    for (int d = 0; d < DOMAINS; d += 2) {
      double direction[9], h = 1e-4, size = 0;
      for (int r = 0; r < 9; r++)
        direction[r] = uniform(&random, -1, 1);
      memset(y, 0, sizeof(double) * n);
      for (int side = 1; side >= -1; side--) { /* the middle one last but one, then back */
        bw_domain_motion at[DOMAINS];
        memcpy(at, motion, sizeof at);
        for (int r = 0; r < 9; r++)
          at[d].linear[r] += side * h * direction[r];
        check_ok(context, bw_domain_stiffness_update(context, now.s, now.b.rest, at, NULL));
        if (side == 0)
          check_ok(context, bw_domain_stiffness_derivative(context, now.s, d, direction, x, y));
        else if (side == 1)
          memcpy(k, now.s->values, sizeof(double) * entries);
        else
          for (size_t i = 0; i < entries; i++)
            k[i] = (k[i] - now.s->values[i]) / (2 * h);
      }
      check_ok(context, bw_graph_multiply(context, g, k, 9, 3, 1, x, z));
      for (size_t i = 0; i < n; i++)
        size = fmax(size, fabs(z[i]));
      for (size_t i = 0; i < n; i++)
        check_near(y[i], z[i], 1e-6 * size);
    }
    check_ok(context, bw_domain_stiffness_update(context, now.s, now.b.rest, motion, NULL));
    memset(y, 0, sizeof(double) * n);
    for (int d = 0; d < DOMAINS; d++)
      check_ok(context, bw_domain_stiffness_derivative(context, now.s, d, motion[d].linear, x, y));
    check_ok(context, bw_graph_multiply(context, g, now.s->values, 9, 3, 1, x, z));
    double size = 0;
    for (size_t i = 0; i < n; i++)
      size = fmax(size, fabs(z[i]));
    for (size_t i = 0; i < n; i++)
      check_near(y[i], z[i], 1e-13 * size);
    motion[1].reshaped = true;
    check_ok(context, bw_domain_stiffness_update(context, now.s, now.b.rest, motion, NULL));
    check_fails(context, BW_INVALID, "domain 1 is reshaped",
                bw_domain_stiffness_derivative(context, now.s, 1, q, x, y));
    check_fails(context, BW_INVALID, "domain 9",
                bw_domain_stiffness_derivative(context, now.s, 9, q, x, y));
    free(x), free(y), free(z), free(k);
    session_clear(&now);
  }
}

/* One element per domain: every pair of nodes is shared but for the insides; one domain: none;
 * seven scattered ones: all kinds of sets. The pairs of order 2 fill several tiles. */
static void many_domains_and_one(void **state) {
  bw_context *context = check_context(state);
  bw_material *material = odd_material(context);
  for (int order = 1; order <= 2; order++) {
    bw_mesh *mesh = NULL;
    bw_graph *g = NULL;
    shaken_box(context, 5 * order, 3, 3, order, 0.3, 0, &mesh);
    check_ok(context, bw_graph_create(context, mesh, &g));
    int32_t n = mesh->element_count;
    int32_t *own = (int32_t *)malloc(sizeof(int32_t) * (size_t)n);
    int32_t *node = (int32_t *)malloc(sizeof(int32_t) * (size_t)mesh->node_count);
    bw_domain_motion *motion = (bw_domain_motion *)malloc(sizeof *motion * (size_t)(n + 1));
    double *values = (double *)malloc(sizeof(double) * 9 * (size_t)g->pair_count);
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
    assert_true(order == 1 || g->pair_count > 2 * 4096);
    for (int cut = 0; cut < 3; cut++) {
      /* a domain more than there are: one without elements does no harm */
      for (int e = 0; e < n; e++)
        own[e] = cut == 0 ? n - 1 - e : cut == 1 ? 0 : e % 7;
      for (int i = 0; i < mesh->node_count; i++)
        node[i] = -1;
      bw_domain_stiffness *s = NULL;
      check_ok(context,
               bw_domain_stiffness_create(context, g, mesh, material, false, n + 1, own, node, &s));
      for (int32_t d = 0; d <= n; d++) {
        bw_domain_motion_rest(&motion[d]);
        memcpy(motion[d].linear, q, sizeof q);
        motion[d].reshaped = d % 3 == 1;
      }
      check_ok(context, bw_domain_stiffness_update(context, s, moved, motion, NULL));
      assert_true(difference(s->values, values, 9 * g->pair_count) < 1e-13);
      assert_true(s->changed[0] && !s->changed[n] == !motion[n].reshaped);
      assert_true(bw_domain_stiffness_bytes(s) > 144 * (size_t)g->pair_count);
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
  size_t size = sizeof(double) * 9 * (size_t)now.b.graph->pair_count;
  double *before = (double *)malloc(size);
  memcpy(before, now.s->values, size);
  bw_domain_motion motion[DOMAINS];
  for (int d = 0; d < DOMAINS; d++)
    bw_domain_motion_rest(&motion[d]);
  motion[0].linear[0] = 2; /* good, and must not be taken over when another is refused */
  const bw_mesh *rest = now.b.rest;

#define REFUSED(what, status, text, mesh)                                                          \
  do {                                                                                             \
    bw_domain_motion good = motion[3];                                                             \
    what;                                                                                          \
    check_fails(context, status, text,                                                             \
                bw_domain_stiffness_update(context, now.s, mesh, motion, NULL));                   \
    assert_memory_equal(now.s->values, before, size);                                              \
    motion[3] = good;                                                                              \
  } while (0)
  REFUSED(motion[3].linear[4] = 0, BW_INVALID, "map of domain 3 has determinant 0", rest);
  REFUSED(motion[3].linear[4] = -1, BW_INVALID, "determinant -1", rest);
  REFUSED(motion[3].linear[4] = NAN, BW_INVALID, "not finite", rest);
  REFUSED(motion[3].frame[4] = 1.1, BW_INVALID, "frame of domain 3 is no rotation", rest);
  REFUSED(motion[3].frame[4] = -1, BW_INVALID, "right-handed", rest);
  bw_mesh *curved = NULL, *linear = NULL;
  double *node = (double *)malloc(sizeof(double) * 3 * (size_t)rest->node_count);
  memcpy(node, rest->node, sizeof(double) * 3 * (size_t)rest->node_count);
  for (int e = 0; e < rest->element_count; e++)
    if (now.b.element_domain[e] == 3)
      node[3 * rest->element[10 * e + 4]] += 1e-3;
  check_ok(context, bw_mesh_moved(context, rest, node, &curved));
  REFUSED(motion[3].reshaped = true, BW_INVALID, "half-way", curved);
  check_ok(context, bw_mesh_with_order(context, rest, 1, &linear));
  REFUSED(, BW_INVALID, "the graph belongs to", linear);
  bw_cancel(context);
  REFUSED(, BW_CANCELLED, "", rest);
  bw_clear_cancel(context);
  bw_domain_stiffness *none = NULL;
  check_fails(context, BW_INVALID, "half-way",
              bw_domain_stiffness_create(context, now.b.graph, curved, now.material, false, DOMAINS,
                                         now.b.element_domain, now.b.node_domain, &none));
  now.b.element_domain[7] = DOMAINS;
  check_fails(context, BW_INVALID, "element 7 is said to be in domain 5",
              bw_domain_stiffness_create(context, now.b.graph, rest, now.material, false, DOMAINS,
                                         now.b.element_domain, now.b.node_domain, &none));
  now.b.element_domain[7] = 0;
  now.b.node_domain[5] = -2;
  check_fails(context, BW_INVALID, "node 5",
              bw_domain_stiffness_create(context, now.b.graph, rest, now.material, false, DOMAINS,
                                         now.b.element_domain, now.b.node_domain, &none));
  check_fails(context, BW_INVALID, "at least one",
              bw_domain_stiffness_create(context, now.b.graph, rest, now.material, false, 0,
                                         now.b.element_domain, now.b.node_domain, &none));
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
  bw_status status = BW_MEMORY;
  bw_domain_stiffness *other = NULL;
  for (int n = 1; status != BW_OK; n++) {
    bw_fail_allocation(n, true);
    status = bw_domain_stiffness_create(context, now.b.graph, now.b.rest, now.material, false,
                                        DOMAINS, now.b.element_domain, now.b.node_domain, &other);
    bw_fail_allocation(0, false);
    assert_true(status == BW_OK ? other != NULL : status == BW_MEMORY && !other);
  }
  bw_release(other);
  now.p.stretch[1][0] = 1.1;
  now.p.bulged[4] = true;
  bw_mesh *moved = posed(context, &now.b, &now.p, now.motion);
  size_t size = sizeof(double) * 9 * (size_t)now.b.graph->pair_count;
  double *before = (double *)malloc(size);
  memcpy(before, now.s->values, size);
  status = BW_MEMORY;
  for (int n = 1; status != BW_OK; n++) {
    bw_fail_allocation(n, true);
    status = bw_domain_stiffness_update(context, now.s, moved, now.motion, NULL);
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

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(paper_formulas_against_quadrature),
      check_test(any_edits_equal_scratch),
      check_test(what_counts_as_changed),
      check_test(frames_of_nodes_count),
      check_test(same_bits_by_any_way),
      check_test(derivative),
      check_test(many_domains_and_one),
      check_test(refusals),
      check_test(out_of_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
