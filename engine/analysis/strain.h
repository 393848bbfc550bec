/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Strain and stress inside one element, for the stress fields and the error estimate.
 *
 * On a straight element grad u = sum_k D_k (x) grad L_k with D_k = sum_a u_a dN_a/dL_k, so that a
 * point costs four vectors D_k and no Jacobian. Curved elements take the long way. */
#ifndef BARWRIGHT_STRAIN_H
#define BARWRIGHT_STRAIN_H

#include <string.h>

#include "assemble/internal.h"

typedef struct bwi_element_state {
  int order, nodes;
  bool straight;
  double volume;     /* of the straight-edged element */
  double g[4][3];    /* gradients of the barycentric coordinates, for straight elements */
  double x[10][3];   /* node positions, for curved elements */
  double u[10][3];   /* node displacements */
  double projected;  /* the bulk modulus that acts on `dilatation` */
  double dilatation; /* mean volumetric strain, where it is needed */
} bwi_element_state;

void bwi_element_state_load(const bw_mesh *mesh, const bw_material *material,
                            const double *displacement, int64_t element, bwi_element_state *state);

/* grad[3 i + j] = du_i/dx_j; engineering shears */
static inline void bwi_strain_of(const double grad[9], double strain[6]) {
  strain[0] = grad[0];
  strain[1] = grad[4];
  strain[2] = grad[8];
  strain[3] = grad[5] + grad[7];
  strain[4] = grad[6] + grad[2];
  strain[5] = grad[1] + grad[3];
}

/* Strain (engineering shears) at a point; by_l
 * holds dN_a/dL_k there, l the point itself. Returns the volume per reference volume there: the
 * element's volume when it is straight. */
double bwi_strain_at(const bwi_element_state *state, const double (*by_l)[4], const double l[4],
                     double strain[6]);

/* y = A x for a 6x6 matrix */
static inline void bwi_multiply6(const double a[36], const double x[6], double y[6]) {
  for (int i = 0; i < 6; i++) {
    double sum = 0;
    for (int j = 0; j < 6; j++)
      sum += a[6 * i + j] * x[j];
    y[i] = sum;
  }
}

static inline double bwi_dot6(const double a[6], const double b[6]) {
  double sum = 0;
  for (int i = 0; i < 6; i++)
    sum += a[i] * b[i];
  return sum;
}

/* The stress that goes with a strain of the element, C being the element's elasticity. */
static inline void bwi_stress_of(const bwi_element_state *state, const double c[36],
                                 const double strain[6], double stress[6]) {
  bwi_multiply6(c, strain, stress);
  if (state->projected > 0) {
    double change = state->projected * (state->dilatation - (strain[0] + strain[1] + strain[2]));
    for (int i = 0; i < 3; i++)
      stress[i] += change;
  }
}

/* A quadrature rule with the gradients (and values) of the shape functions at its points. */
typedef struct bwi_rule {
  int points;
  double l[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  double value[BW_QUADRATURE_POINTS][10], by_l[BW_QUADRATURE_POINTS][10][4];
} bwi_rule;
void bwi_rule_make(int order, int degree, bwi_rule *rule);

/* stress.c: the stress of every node (node_count x 6) from those of points: where materials meet
 * that of the side with the largest von Mises stress, the first of equal ones. */
void bwi_governing_stress(const bw_stress_points *points, int32_t node_count,
                          const double *of_points, double *stress);

/* invariants.c: the larger of the largest principal stress and the negative smallest one. */
double bwi_max_principal(const double t[6]);

/* recovery.c: recovered stresses at points (points->count x 6), from elements of their materials.
 */
bw_status bwi_recovered_point_stress(bw_context *context, const bw_mesh *mesh,
                                     const bw_material *material, const double *displacement,
                                     const bw_stress_points *points, double *stress);

/* BW_INVALID when there is no displacement or material to work with, or one of another mesh. */
bw_status bwi_check_stress_input(bw_context *context, const bw_mesh *mesh,
                                 const bw_material *material, const double *displacement,
                                 const char *what);

/* The nine components of a stress, row by row. */
static inline void bwi_full_tensor(const double s[6], double t[9]) {
  const double full[9] = {s[0], s[5], s[4], s[5], s[1], s[3], s[4], s[3], s[2]};
  memcpy(t, full, sizeof full);
}

/* a += factor * b^T c */
static inline void bwi_add_transposed_product(double a[9], double factor, const double b[9],
                                              const double c[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      a[3 * i + j] += factor * (b[i] * c[j] + b[3 + i] * c[3 + j] + b[6 + i] * c[6 + j]);
}

#endif
