/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A bar of five subdomains, its poses and edits, and a stiffness that follows them: what the tests
 * of stiffness kept subdomain by subdomain share. */
#ifndef SUBDOMAIN_BAR_H
#define SUBDOMAIN_BAR_H

#include "assemble/dense.h"

/* ---- a bar of five subdomains: R F R F R, the blended ones two cells long ---- */

enum { SUBDOMAINS = 5, RIGID = 3 };

typedef struct bar {
  bw_mesh *rest;
  bw_block_pattern *pattern;
  int32_t *element_subdomain, *node_subdomain;
  int32_t *left, *right; /* per node: which subdomains of type R it follows (0, 1, 2) */
  double *weight;        /* of the right one */
} bar;

/* Subdomains by the place along x of an element's middle; 0 2 4 are of type R. */
static inline int32_t strip(double x, double length) {
  double at = 8 * x / length;
  return at < 2 ? 0 : at < 3 ? 1 : at < 5 ? 2 : at < 6 ? 3 : 4;
}

static inline void bar_create(bw_context *context, int order, bar *b) {
  perturbed_box(context, 8, 2, 1, order, 0, 0, &b->rest);
  check_ok(context, bw_block_pattern_create(context, b->rest, &b->pattern));
  int n = b->rest->node_count, per = b->rest->nodes_per_element;
  double length = 0.3 * 8;
  b->element_subdomain = (int32_t *)malloc(sizeof(int32_t) * (size_t)b->rest->element_count);
  b->node_subdomain = (int32_t *)malloc(sizeof(int32_t) * (size_t)n);
  b->left = (int32_t *)malloc(sizeof(int32_t) * (size_t)n);
  b->right = (int32_t *)malloc(sizeof(int32_t) * (size_t)n);
  b->weight = (double *)malloc(sizeof(double) * (size_t)n);
  for (int e = 0; e < b->rest->element_count; e++) {
    double x = 0;
    for (int a = 0; a < 4; a++)
      x += 0.25 * b->rest->node[3 * b->rest->element[per * e + a]];
    b->element_subdomain[e] = strip(x, length);
  }
  for (int i = 0; i < n; i++) {
    double at = 8 * b->rest->node[3 * i] / length;
    b->left[i] = b->right[i] = at < 2.5 ? 0 : at < 5.5 ? 1 : 2;
    b->weight[i] = 0;
    b->node_subdomain[i] = at < 2 + 1e-9   ? 0
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

static inline void bar_clear(bar *b) {
  free(b->element_subdomain), free(b->node_subdomain), free(b->left), free(b->right),
      free(b->weight);
  bw_release(b->pattern);
  bw_release(b->rest);
}

/* What the three subdomains of type R do: x -> linear x + shift with linear = rotation * stretch.
 */
typedef struct pose {
  double rotation[RIGID][9], stretch[RIGID][9], shift[RIGID][3];
  bool bulged[SUBDOMAINS]; /* inner corner nodes of the subdomain moved on their own */
  uint64_t seed[SUBDOMAINS];
} pose;

static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static inline void pose_rest(pose *p) {
  memset(p, 0, sizeof *p);
  for (int r = 0; r < RIGID; r++) {
    memcpy(p->rotation[r], one, sizeof one);
    memcpy(p->stretch[r], one, sizeof one);
  }
}

static inline void times(const double *a, const double *b, double *out) {
  double c[9];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
  memcpy(out, c, sizeof c);
}

static inline void turn(double angle, const double direction[3], double out[9]) {
  double n = bw_norm(direction), u[3] = {direction[0] / n, direction[1] / n, direction[2] / n};
  double c = cos(angle), s = sin(angle);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      out[3 * i + j] = (i == j) * c + (1 - c) * u[i] * u[j];
  out[1] -= s * u[2], out[2] += s * u[1], out[3] += s * u[2];
  out[5] -= s * u[0], out[6] -= s * u[1], out[7] += s * u[0];
}

static inline void transposed(const double *a, double *out) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      out[3 * i + j] = a[3 * j + i];
}

/* Nodes and motions of a pose; NULL when an element is inverted. */
static inline bw_mesh *posed(bw_context *context, const bar *b, const pose *p,
                             bw_subdomain_motion *motion) {
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
  /* nodes of one subdomain's elements only may move on their own */
  int per = rest->nodes_per_element;
  int32_t *only = (int32_t *)malloc(sizeof *only * (size_t)n);
  for (int i = 0; i < n; i++)
    only[i] = -1;
  for (int e = 0; e < rest->element_count; e++)
    for (int a = 0; a < 4; a++) {
      int32_t *o = &only[rest->element[per * e + a]];
      *o = *o == -1 || *o == b->element_subdomain[e] ? b->element_subdomain[e] : -2;
    }
  for (int d = 0; d < SUBDOMAINS; d++) {
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
  for (int d = 0; d < SUBDOMAINS; d++) {
    bw_subdomain_motion_rest(&motion[d]);
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
static inline double difference(const double *a, const double *b, int64_t n) {
  double max = 0, size = 0;
  for (int64_t k = 0; k < n; k++) {
    max = fmax(max, fabs(a[k] - b[k]));
    size = fmax(size, fabs(b[k]));
  }
  return max / size;
}

static inline double uniform(bw_random *random, double low, double high) {
  return low + (high - low) * bw_random_uniform(random);
}

/* One random edit of a pose. */
static inline void edit(bw_random *random, pose *p) {
  int r = (int)(bw_random_bits(random) % RIGID), d = (int)(bw_random_bits(random) % SUBDOMAINS);
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
  case 4: /* move nodes of one subdomain, or put them back */
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

/* ---- a stiffness that follows a pose ---- */

typedef struct session {
  bar b;
  bw_material *material;
  bw_subdomain_stiffness *s;
  pose p;
  bw_subdomain_motion motion[SUBDOMAINS];
  bw_subdomain_change change;
} session;

static inline void session_create(bw_context *context, int order, bool plain, bool turns,
                                  session *now) {
  bar_create(context, order, &now->b);
  now->material = plain ? plain_material(context, 2e9, 0.3) : odd_material(context);
  check_ok(context, bw_subdomain_stiffness_create(
                        context, now->b.pattern, now->b.rest, now->material, turns, SUBDOMAINS,
                        now->b.element_subdomain, now->b.node_subdomain, &now->s));
  pose_rest(&now->p);
}

static inline void session_clear(session *now) {
  bw_release(now->s);
  bw_release(now->material);
  bar_clear(&now->b);
}

static inline void session_update(bw_context *context, session *now) {
  bw_mesh *moved = posed(context, &now->b, &now->p, now->motion);
  assert_non_null(moved);
  check_ok(context, bw_subdomain_stiffness_update(context, now->s, moved, now->s->material,
                                                  now->motion, &now->change));
  bw_release(moved);
}

/* 'K'ept, 'E'valuated or 'G'athered counts and the changed flags, as "2K 1E 2G 01000". */
static inline void check_state_is(const session *now, const char *expected) {
  char text[64];
  int n = snprintf(text, sizeof text, "%dK %dE %dG ", now->change.kept, now->change.evaluated,
                   now->change.gathered);
  for (int d = 0; d < SUBDOMAINS; d++)
    text[n++] = now->s->changed[d] ? '1' : '0';
  text[n] = 0;
  assert_string_equal(text, expected);
}

/* Turn every part from `first` on by a rotation about a point. */
static inline void turn_from(pose *p, int first, const double q[9], const double about[3]) {
  for (int r = first; r < RIGID; r++) {
    double shift[3];
    times(q, p->rotation[r], p->rotation[r]);
    for (int i = 0; i < 3; i++)
      shift[i] = bw_dot(q + 3 * i, p->shift[r]) + about[i] - bw_dot(q + 3 * i, about);
    memcpy(p->shift[r], shift, sizeof shift);
  }
}

#endif
