/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Quadrature on the triangle and the tetrahedron, in barycentric coordinates.
 *
 * A rule is a list of orbits: a weight and one barycentric point that stands for all its distinct
 * permutations. The weight belongs to each of them; all weights of a rule sum to one and are
 * positive, and no point lies outside. Rules with a closed form have it beside them; the constants
 * of the two others (degree 6) were refined by Newton's method on the moment equations in forty
 * digits. The tests compare every rule with the exact integrals of all monomials. */
#include "barwright/element.h"

#include <string.h>

typedef struct orbit {
  double weight;
  double point[4];
} orbit;

typedef struct rule {
  int degree, orbit_count;
  orbit orbit[4];
} rule;

static const rule tetrahedron[] = {
    {1, 1, {{1.0, {0.25, 0.25, 0.25, 0.25}}}},
    /* (5 - sqrt 5) / 20 */
    {2,
     1,
     {{0.25,
       {0.13819660112501051518, 0.13819660112501051518, 0.13819660112501051518,
        0.58541019662496845446}}}},
    /* corners 1/40, facet centroids 9/40 */
    {3, 2, {{0.025, {1, 0, 0, 0}}, {0.225, {1.0 / 3, 1.0 / 3, 1.0 / 3, 0}}}},
    /* centroid 16/135; (7 -+ sqrt 15)/34 with (2665 +- 14 sqrt 15)/37800; (10 - 2 sqrt 15)/40 with
     * 10/189 */
    {5,
     4,
     {{0.11851851851851851852, {0.25, 0.25, 0.25, 0.25}},
      {0.071937083779018620010,
       {0.091971078052723032789, 0.091971078052723032789, 0.091971078052723032789,
        0.72408676584183090163}},
      {0.069068207226272385281,
       {0.31979362782962990839, 0.31979362782962990839, 0.31979362782962990839,
        0.040619116511110274837}},
      {0.052910052910052910053,
       {0.056350832689629155741, 0.056350832689629155741, 0.44364916731037084426,
        0.44364916731037084426}}}},
    {6,
     4,
     {{0.0399227502581674920996,
       {0.2146028712591520292888, 0.2146028712591520292888, 0.2146028712591520292888,
        0.3561913862225439121336}},
      {0.0100772110553206429480,
       {0.0406739585346113531155, 0.0406739585346113531155, 0.0406739585346113531155,
        0.8779781243961659406535}},
      {0.0553571815436547220951,
       {0.3223378901422755103439, 0.3223378901422755103439, 0.3223378901422755103439,
        0.0329863295731734689683}},
      {0.0482142857142857142857,
       {0.0636610018750175252992, 0.0636610018750175252992, 0.2696723314583158080340,
        0.6030056647916491413676}}}},
};

static const rule triangle[] = {
    {1, 1, {{1.0, {1.0 / 3, 1.0 / 3, 1.0 / 3}}}},
    {2, 1, {{1.0 / 3, {1.0 / 6, 1.0 / 6, 2.0 / 3}}}},
    /* (8 - sqrt 10 +- sqrt(38 - 44 sqrt(2/5))) / 18, (620 +- sqrt(213125 - 53320 sqrt 10)) /
     * 3720 */
    {4,
     2,
     {{0.22338158967801146570,
       {0.44594849091596488632, 0.44594849091596488632, 0.10810301816807022736}},
      {0.10995174365532186764,
       {0.091576213509770743460, 0.091576213509770743460, 0.81684757298045851308}}}},
    /* centroid 9/40; (6 -+ sqrt 15)/21 with (155 -+ sqrt 15)/1200 */
    {5,
     3,
     {{0.225, {1.0 / 3, 1.0 / 3, 1.0 / 3}},
      {0.12593918054482715260,
       {0.10128650732345633880, 0.10128650732345633880, 0.79742698535308732240}},
      {0.13239415278850618074,
       {0.47014206410511508977, 0.47014206410511508977, 0.059715871789769820459}}}},
    {6,
     3,
     {{0.1167862757263793660252,
       {0.2492867451709104212916, 0.2492867451709104212916, 0.5014265096581791574168}},
      {0.0508449063702068169209,
       {0.0630890144915022283403, 0.0630890144915022283403, 0.8738219710169955433194}},
      {0.0828510756183735751935,
       {0.0531450498448169473532, 0.3103524510337844054166, 0.6365024991213986472302}}}},
};

/* Step to the next larger permutation of n numbers; false after the last. Equal numbers count
 * once. */
static bool next_permutation(double *p, int n) {
  int i = n - 2;
  while (i >= 0 && p[i] >= p[i + 1])
    i--;
  if (i < 0)
    return false;
  int j = n - 1;
  while (p[j] <= p[i])
    j--;
  double t = p[i];
  p[i] = p[j], p[j] = t;
  for (int a = i + 1, b = n - 1; a < b; a++, b--)
    t = p[a], p[a] = p[b], p[b] = t;
  return true;
}

static int expand(const rule *r, int n, double *point, double *weight) {
  int count = 0;
  for (int o = 0; o < r->orbit_count; o++) {
    double p[4];
    memcpy(p, r->orbit[o].point, sizeof p);
    for (int i = 1; i < n; i++) /* ascending: the first permutation */
      for (int j = i; j > 0 && p[j - 1] > p[j]; j--) {
        double t = p[j];
        p[j] = p[j - 1], p[j - 1] = t;
      }
    do {
      memcpy(point + (size_t)count * (size_t)n, p, (size_t)n * sizeof *p);
      weight[count++] = r->orbit[o].weight;
    } while (next_permutation(p, n));
  }
  return count;
}

static const rule *choose(const rule *rules, int count, int degree) {
  int i = 0;
  while (i < count - 1 && rules[i].degree < degree)
    i++;
  return &rules[i];
}

int bw_tet_quadrature(int degree, double (*point)[4], double *weight) {
  const rule *r = choose(tetrahedron, (int)(sizeof tetrahedron / sizeof *tetrahedron), degree);
  return expand(r, 4, &point[0][0], weight);
}

int bw_triangle_quadrature(int degree, double (*point)[3], double *weight) {
  const rule *r = choose(triangle, (int)(sizeof triangle / sizeof *triangle), degree);
  return expand(r, 3, &point[0][0], weight);
}
