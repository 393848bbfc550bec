/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of finite/ share: elements at finite displacements. */
#ifndef BWI_FINITE_INTERNAL_H
#define BWI_FINITE_INTERNAL_H

#include "assemble/internal.h"
#include "barwright/finite.h"

/* The elements of a model, ready to be evaluated again and again. */
typedef struct bwi_finite_elements {
  const bw_model *model;
  const bw_block_pattern *pattern;
  bwi_row_sums rows;
  bool expands;       /* temperatures act */
  double *of_element; /* element_count x (6 nodes_per_element + 2): forces, those of unit
                         temperatures, energy, largest strain */
} bwi_finite_elements;
/* Clear with bwi_finite_elements_clear in any case. */
bw_status bwi_finite_elements_open(bw_context *context, const bw_model *model,
                                   const bw_block_pattern *pattern, bwi_finite_elements *elements);
void bwi_finite_elements_clear(bwi_finite_elements *elements);

/* A state, and what is wanted of it. */
typedef struct bwi_finite_state {
  const double *displacement; /* node_count x 3 */
  double factor;              /* of the temperatures */
  double *force;              /* node_count x 3: internal forces */
  double *heat;               /* node_count x 3: minus their derivative by the factor; NULL */
  double *tangent;            /* block_count x 9, or NULL */
  /* out */
  double energy;
  double strain;    /* the largest size of E, the root of E : E, at a point of quadrature */
  int32_t inverted; /* the first element with det F <= 0 at a point of its quadrature, or -1: the
                       rest means nothing then */
} bwi_finite_state;
bw_status bwi_finite_evaluate(bw_context *context, bwi_finite_elements *elements,
                              bwi_finite_state *state);
/* The first element with det F <= 0 at one of its nodes, or -1. */
bw_status bwi_finite_inverted_at_nodes(bw_context *context, const bw_mesh *mesh,
                                       const double *displacement, int32_t *inverted);

/* An element's deformation at the points of its quadrature. */
typedef struct bwi_finite_deformed {
  int count, nodes;
  double volume[BW_QUADRATURE_POINTS], gradient[BW_QUADRATURE_POINTS][10][3];
  double f[BW_QUADRATURE_POINTS][9], strain[BW_QUADRATURE_POINTS][6];
  double determinant[BW_QUADRATURE_POINTS]; /* det F */
  double heat[BW_QUADRATURE_POINTS][6];     /* thermal stress at factor 1 */
  double whole, dilatation;                 /* volume; mean of the trace of the strain */
  bool inverted;
} bwi_finite_deformed;
bw_status bwi_finite_deform(bw_context *context, const bw_model *model, const double *displacement,
                            int64_t element, bool expands, bwi_finite_deformed *deformed);
/* Second Piola-Kirchhoff stress of a strain in the element, without temperatures; `projected` acts
 * on the mean of the dilatation. */
void bwi_finite_second_stress(const bwi_finite_deformed *deformed, const double strain[6],
                              const double c[36], double projected, double stress[6]);
/* grad u by the gradients of the functions of `node`. */
void bwi_finite_gradient(int nodes, const double (*gradient)[3], const int32_t *node,
                         const double *displacement, double grad[9]);

/* grad[3 i + j] = du_i/dx_j -> F, and the Green-Lagrange strain with engineering shears from
 * grad u, which keeps the digits of small strains. Returns det F. */
double bwi_finite_strain(const double grad[9], double f[9], double strain[6]);

#endif
