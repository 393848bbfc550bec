/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Limbed bodies for benchmarks: a tree of tapering bones, its smooth union filled with tetrahedra,
 * and subdomains as an edit session makes them: around every joint a blended one, along every bone
 * a rigid one. */
#ifndef LIMBS_H
#define LIMBS_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "barwright.h"

enum { LIMBS_MAX = 40 };

typedef struct limbs {
  const char *name;
  int joints, bones;
  double joint[LIMBS_MAX][4]; /* position (dm) and radius */
  int bone[LIMBS_MAX][2];
} limbs;

static const limbs limbs_scenes[] = {
    {"opener",
     6,
     5,
     {{0, 0, 0, .16},
      {.5, .05, 0, .13},
      {1, 0, 0, .14},
      {1.4, .15, 0, .2},
      {1.75, .35, 0, .12},
      {1.75, -.1, 0, .1}},
     {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {3, 5}}},
    {"bird",
     13,
     12,
     {{0, 0, 0, .3},
      {.5, .1, 0, .33},
      {.85, .4, 0, .17},
      {1.15, .45, 0, .07},
      {-.6, .05, 0, .1},
      {.4, .25, .5, .11},
      {.3, .35, 1.1, .08},
      {.4, .25, -.5, .11},
      {.3, .35, -1.1, .08},
      {.2, -.45, .15, .08},
      {.3, -.8, .15, .07},
      {.2, -.45, -.15, .08},
      {.3, -.8, -.15, .07}},
     {{0, 1},
      {1, 2},
      {2, 3},
      {0, 4},
      {1, 5},
      {5, 6},
      {1, 7},
      {7, 8},
      {0, 9},
      {9, 10},
      {0, 11},
      {11, 12}}},
    {"horse",
     20,
     19,
     {{0, 0, 0, .27},         {.55, .03, 0, .24},      {1.1, 0, 0, .27},
      {1.45, .45, 0, .15},    {1.65, .75, 0, .14},     {2, .6, 0, .09},
      {-.3, -.1, 0, .07},     {-.5, -.5, 0, .06},      {1.1, -.45, .16, .11},
      {1.12, -.8, .16, .07},  {1.1, -1.15, .16, .07},  {1.1, -.45, -.16, .11},
      {1.12, -.8, -.16, .07}, {1.1, -1.15, -.16, .07}, {0, -.45, .16, .13},
      {-.06, -.8, .16, .08},  {0, -1.15, .16, .07},    {0, -.45, -.16, .13},
      {-.06, -.8, -.16, .08}, {0, -1.15, -.16, .07}},
     {{0, 1},
      {1, 2},
      {2, 3},
      {3, 4},
      {4, 5},
      {0, 6},
      {6, 7},
      {2, 8},
      {8, 9},
      {9, 10},
      {2, 11},
      {11, 12},
      {12, 13},
      {0, 14},
      {14, 15},
      {15, 16},
      {0, 17},
      {17, 18},
      {18, 19}}},
    {"dinosaur",
     18,
     17,
     {{0, 0, 0, .34},
      {.6, 0, 0, .32},
      {1, .3, 0, .18},
      {1.25, .7, 0, .14},
      {1.4, 1.1, 0, .12},
      {1.65, 1.2, 0, .11},
      {-.5, -.05, 0, .2},
      {-1, -.2, 0, .13},
      {-1.5, -.3, 0, .09},
      {-2, -.25, 0, .06},
      {.6, -.45, .22, .14},
      {.65, -.85, .22, .11},
      {.6, -.45, -.22, .14},
      {.65, -.85, -.22, .11},
      {0, -.45, .22, .15},
      {.02, -.85, .22, .12},
      {0, -.45, -.22, .15},
      {.02, -.85, -.22, .12}},
     {{0, 1},
      {1, 2},
      {2, 3},
      {3, 4},
      {4, 5},
      {0, 6},
      {6, 7},
      {7, 8},
      {8, 9},
      {1, 10},
      {10, 11},
      {1, 12},
      {12, 13},
      {0, 14},
      {14, 15},
      {0, 16},
      {16, 17}}},
    {"earphone",
     13,
     12,
     {{-.9, -.35, 0, .1},
      {-.88, .2, 0, .09},
      {-.55, .65, 0, .09},
      {0, .85, 0, .1},
      {.55, .65, 0, .09},
      {.88, .2, 0, .09},
      {.9, -.35, 0, .1},
      {-.8, -.5, 0, .22},
      {.8, -.5, 0, .22},
      {-.72, -.75, 0, .16},
      {.72, -.75, 0, .16},
      {-.9, -.8, .4, .06},
      {-.8, -.95, .8, .06}},
     {{0, 1},
      {1, 2},
      {2, 3},
      {3, 4},
      {4, 5},
      {5, 6},
      {0, 7},
      {6, 8},
      {7, 9},
      {8, 10},
      {9, 11},
      {11, 12}}}};

/* Distance to bone b in local radii; *along: 0 at its first joint, 1 at its second. */
static double limbs_distance(const limbs *body, int b, const double at[3], double *along) {
  const double *p = body->joint[body->bone[b][0]], *q = body->joint[body->bone[b][1]];
  double d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]},
         r[3] = {at[0] - p[0], at[1] - p[1], at[2] - p[2]};
  double t = bw_dot(d, r) / bw_dot(d, d);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  for (int i = 0; i < 3; i++)
    r[i] -= t * d[i];
  *along = t;
  return bw_norm(r) / (p[3] + t * (q[3] - p[3]));
}

static double limbs_level(void *data, const double at[3]) {
  const limbs *body = data;
  double sum = 0, along;
  for (int b = 0; b < body->bones; b++)
    sum += exp(-14 * (limbs_distance(body, b, at, &along) - 1));
  return -log(sum + 1e-300) / 14;
}

/* A tet10 mesh in metres (a joint's unit is 0.1 m). */
static bw_status limbs_mesh(bw_context *context, const limbs *body, int64_t elements,
                            bw_mesh **mesh) {
  bw_status status = BW_OK;
  double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
  bw_surface *surface = NULL, *scaled = NULL;
  bw_fill_options options;
  bw_fill_options_default(&options);
  for (int j = 0; j < body->joints; j++)
    for (int i = 0; i < 3; i++) {
      low[i] = fmin(low[i], body->joint[j][i] - 1.6 * body->joint[j][3] - 0.05);
      high[i] = fmax(high[i], body->joint[j][i] + 1.6 * body->joint[j][3] + 0.05);
    }
  options.order = 2;
  options.elements = elements;
  limbs copy = *body;
  BW_TRY(bw_surface_implicit(context, low, high, 90, limbs_level, &copy, &surface));
  BW_TRY(bw_surface_scale(context, surface, 0.1, &scaled));
  BW_TRY(bw_mesh_fill(context, scaled, &options, mesh, NULL));
done:
  bw_release(surface);
  bw_release(scaled);
  return status;
}

/* Subdomain of each element; empty ones are left out. Returns how many there are. */
static int32_t limbs_subdomains(const limbs *body, const bw_mesh *mesh,
                                int32_t *element_subdomain) {
  int degree[LIMBS_MAX] = {0}, number[2 * LIMBS_MAX];
  int32_t count = 0;
  for (int b = 0; b < body->bones; b++)
    for (int end = 0; end < 2; end++)
      degree[body->bone[b][end]]++;
  for (int d = 0; d < 2 * LIMBS_MAX; d++)
    number[d] = -1;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    double at[3] = {0, 0, 0}, along = 0, nearest = 1e30;
    int best = 0;
    for (int k = 0; k < 4; k++)
      for (int i = 0; i < 3; i++)
        at[i] += 2.5 * mesh->node[3 * (int64_t)mesh->element[e * mesh->nodes_per_element + k] + i];
    for (int b = 0; b < body->bones; b++) {
      double distance = limbs_distance(body, b, at, &along);
      if (distance < nearest) {
        nearest = distance;
        best = b;
      }
    }
    for (int end = 0; end < 2; end++) {
      int j = body->bone[best][end];
      const double *joint = body->joint[j];
      double r[3] = {at[0] - joint[0], at[1] - joint[1], at[2] - joint[2]};
      if (degree[j] > 1 && bw_norm(r) < 1.05 * joint[3]) {
        best = LIMBS_MAX + j;
        break;
      }
    }
    if (number[best] < 0)
      number[best] = count++;
    element_subdomain[e] = number[best];
  }
  return count;
}

#endif
