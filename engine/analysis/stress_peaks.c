/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The largest stresses of many displacement fields at once. An element's geometry serves all of
 * them, and principal stresses are computed where a bound says that they may be a new maximum. */
#include "analysis/stress_peaks.h"

#include "barwright/analysis.h"

#include <math.h>
#include <string.h>

enum { FIELDS = BWI_PEAK_FIELDS, ELEMENTS_PER_CHUNK = 1024 };

/* Of a bound: more than what rounding takes from it. */
static const double above = 1 + 1e-12;

typedef struct peaks {
  const bw_mesh *mesh;
  const bw_material *material;
  const double *displacement;
  bwi_rule rule;
  double *stress, *utilisation;
  double *largest; /* (chunks x FIELDS) */
  int32_t *where;  /* (chunks x FIELDS) */
} peaks;

typedef struct tensors {
  double value[6][FIELDS];
  double bound[FIELDS]; /* of the principal stresses */
} tensors;

/* The means of the shape functions' gradients over the element; the first node that has any. On a
 * straight tet10 they are those of its centre, where corners have none. */
static int mean_gradient(const peaks *p, int64_t e, double mean[10][3]) {
  const bw_mesh *mesh = p->mesh;
  double x[10][3], g[4][3];
  bwi_element_nodes(mesh, e, x);
  if (mesh->order == 1 || bw_tet_is_straight((const double(*)[3])x)) {
    bw_tet_barycentric_gradient(x[0], x[1], x[2], x[3], g);
    if (mesh->order == 1)
      memcpy(mean, g, sizeof g);
    for (int m = 0; mesh->order == 2 && m < 6; m++)
      for (int k = 0; k < 3; k++)
        mean[4 + m][k] = g[bw_tet_edge[m][0]][k] + g[bw_tet_edge[m][1]][k];
    return mesh->order == 2 ? 4 : 0;
  }
  double volume = 0;
  memset(mean, 0, 10 * sizeof *mean);
  for (int q = 0; q < p->rule.points; q++) {
    double gradient[10][3];
    double part = p->rule.weight[q] *
                  bw_tet_gradient(mesh->order, (const double(*)[3])x, p->rule.l[q], gradient);
    volume += part;
    for (int a = 0; a < mesh->nodes_per_element; a++)
      for (int k = 0; k < 3; k++)
        mean[a][k] += part * gradient[a][k];
  }
  for (int a = 0; a < mesh->nodes_per_element; a++)
    for (int k = 0; k < 3; k++)
      mean[a][k] /= volume;
  return 0;
}

/* With the mean m and the deviator s, p^2 = s:s/6, principal stresses are m + 2 p cos(phi): none is
 * larger than |m| + 2 p. */
static void bound_tensors(tensors *t) {
  for (int f = 0; f < FIELDS; f++) {
    double m = (t->value[0][f] + t->value[1][f] + t->value[2][f]) / 3, square = 0;
    for (int i = 0; i < 3; i++) {
      double deviator = t->value[i][f] - m, shear = t->value[3 + i][f];
      square += deviator * deviator + 2 * shear * shear;
    }
    t->bound[f] = above * (fabs(m) + 2 * sqrt(square / 6));
  }
}

static void stress_of_fields(const peaks *p, int64_t e, tensors *t) {
  const bw_mesh *mesh = p->mesh;
  const int32_t *node = mesh->element + e * mesh->nodes_per_element;
  const double *elasticity = bw_material_elasticity(p->material, e);
  double mean[10][3], grad[9][FIELDS] = {{0}}, strain[6][FIELDS];
  for (int a = mean_gradient(p, e, mean); a < mesh->nodes_per_element; a++) {
    const double *u = p->displacement + 3 * (int64_t)node[a] * FIELDS;
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        for (int f = 0; f < FIELDS; f++)
          grad[3 * i + j][f] += u[i * FIELDS + f] * mean[a][j];
  }
  for (int f = 0; f < FIELDS; f++) {
    strain[0][f] = grad[0][f];
    strain[1][f] = grad[4][f];
    strain[2][f] = grad[8][f];
    strain[3][f] = grad[5][f] + grad[7][f];
    strain[4][f] = grad[6][f] + grad[2][f];
    strain[5][f] = grad[1][f] + grad[3][f];
  }
  memset(t->value, 0, sizeof t->value);
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++)
      for (int f = 0; f < FIELDS; f++)
        t->value[i][f] += elasticity[6 * i + j] * strain[j][f];
  bound_tensors(t);
}

void bwi_mean_stress_weights(const bw_mesh *mesh, const bw_material *material, int64_t element,
                             double weight[6][10][3]) {
  peaks p = {.mesh = mesh, .material = material};
  const double *elasticity = bw_material_elasticity(material, element);
  double mean[10][3];
  bwi_rule_make(mesh->order, BWI_CURVED_DEGREE, &p.rule);
  memset(weight, 0, 6 * sizeof *weight);
  for (int a = mean_gradient(&p, element, mean); a < mesh->nodes_per_element; a++)
    for (int k = 0; k < 3; k++) {
      double grad[9] = {0}, strain[6], stress[6];
      memcpy(grad + 3 * k, mean[a], sizeof mean[a]);
      bwi_strain_of(grad, strain);
      bwi_multiply6(elasticity, strain, stress);
      for (int i = 0; i < 6; i++)
        weight[i][a][k] = stress[i];
    }
}

static void tensor_of(const tensors *t, int field, double stress[6]) {
  for (int i = 0; i < 6; i++)
    stress[i] = t->value[i][field];
}

static bool same_strengths(const double strength[3]) {
  return strength[0] > 0 && strength[0] == strength[1] && strength[1] == strength[2];
}

static void raise_utilisation(const peaks *p, int64_t e, const tensors *t) {
  const bw_material *own = bw_material_of(p->material, e);
  double least = fmin(own->strength[0], fmin(own->strength[1], own->strength[2])), stress[6];
  double *most = p->utilisation + e;
  if (same_strengths(own->strength))
    *most = fmax(*most, p->stress[e] / own->strength[0]);
  else if (least > 0)
    for (int f = 0; f < FIELDS; f++)
      if (t->bound[f] > *most * least) {
        tensor_of(t, f, stress);
        *most = fmax(*most, bw_material_utilisation(own, stress));
      }
}

static bw_status peaks_of_elements(void *data, int64_t begin, int64_t end, int worker) {
  const peaks *p = data;
  double *largest = p->largest + begin / ELEMENTS_PER_CHUNK * FIELDS;
  int32_t *where = p->where + begin / ELEMENTS_PER_CHUNK * FIELDS;
  (void)worker;
  for (int f = 0; f < FIELDS; f++) {
    largest[f] = 0;
    where[f] = (int32_t)begin;
  }
  for (int64_t e = begin; e < end; e++) {
    tensors t;
    double stress[6];
    int first = 0; /* the largest bound: the others are below the stress then, most of them */
    stress_of_fields(p, e, &t);
    for (int f = 1; f < FIELDS; f++)
      first = t.bound[f] > t.bound[first] ? f : first;
    for (int i = 0; i < FIELDS; i++) {
      int f = i == 0 ? first : i == first ? 0 : i;
      if (t.bound[f] <= p->stress[e] && t.bound[f] <= largest[f])
        continue;
      tensor_of(&t, f, stress);
      double value = bwi_max_principal(stress);
      p->stress[e] = fmax(p->stress[e], value);
      if (value > largest[f]) {
        largest[f] = value;
        where[f] = (int32_t)e;
      }
    }
    if (p->utilisation)
      raise_utilisation(p, e, &t);
  }
  return BW_OK;
}

bw_status bwi_stress_peaks(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                           const double *displacement, double *stress, double *utilisation,
                           double largest[FIELDS], int32_t where[FIELDS]) {
  bw_status status = BW_OK;
  int64_t chunks = (mesh->element_count + (int64_t)ELEMENTS_PER_CHUNK - 1) / ELEMENTS_PER_CHUNK;
  peaks p = {.mesh = mesh,
             .material = material,
             .displacement = displacement,
             .stress = stress,
             .utilisation = utilisation};
  BW_TRY(bwi_check_stress_input(context, mesh, material, displacement, "a stress field"));
  bwi_rule_make(mesh->order, BWI_CURVED_DEGREE, &p.rule);
  p.largest = BW_NEW0(context, double, chunks *FIELDS);
  p.where = BW_NEW0(context, int32_t, chunks * FIELDS);
  BW_TRY_MEMORY(p.largest && p.where);
  BW_TRY(bw_parallel(context, mesh->element_count, ELEMENTS_PER_CHUNK, peaks_of_elements, &p));
  memcpy(largest, p.largest, FIELDS * sizeof *largest);
  memcpy(where, p.where, FIELDS * sizeof *where);
  for (int64_t i = FIELDS; i < chunks * FIELDS; i++)
    if (p.largest[i] > largest[i % FIELDS]) {
      largest[i % FIELDS] = p.largest[i];
      where[i % FIELDS] = p.where[i];
    }
done:
  bw_free(p.largest);
  bw_free(p.where);
  return status;
}
