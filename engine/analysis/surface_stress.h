/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stress of the surface at a corner of a facet, by the displacement of the facet's nodes and the
 * traction on it (docs/theory/breaking_force.md). */
#ifndef BARWRIGHT_ANALYSIS_SURFACE_STRESS_H
#define BARWRIGHT_ANALYSIS_SURFACE_STRESS_H

#include "barwright/analysis.h"

/* Corner k of facet f has the number 3 f + k. */
typedef struct bwi_facet_corner {
  int nodes;
  const int32_t *node;   /* of the facet */
  double gradient[6][3]; /* of the facet's shape functions, along the surface */
  double normal[3];
  double softness[9];     /* Q^-1, Q_ik = n_j C_ijkl n_l */
  double by_traction[18]; /* (C n) Q^-1, 6 x 3: the stress of a unit traction */
  double elasticity[36];  /* C_s = C - (C n) Q^-1 (n C): the stress that leaves no traction */
} bwi_facet_corner;

void bwi_facet_corner_load(const bw_mesh *mesh, const bw_material *material, int32_t corner,
                           bwi_facet_corner *at);

/* Strain (engineering shears) of the surface's own displacement gradient, full[3 i + j] =
 * du_i/dx_j. */
void bwi_facet_corner_strain(const bwi_facet_corner *at, const double *displacement, double full[9],
                             double strain[6]);

/* Mean traction of each facet, facet_count x 3, of nodal forces: each is spread over the facets
 * around its node by their areas. `area` (node_count): bwi_facet_areas_around. Facets at a sharp
 * edge share what acts on either. */
bw_status bwi_facet_areas_around(bw_context *context, const bw_mesh *mesh, double **area);
void bwi_facet_traction(const bw_mesh *mesh, const double *area, const double *force, int32_t facet,
                        double traction[3]);

/* force (node_count x 3) += the derivative of T : stress at a corner by the displacement; T a
 * symmetric tensor. */
void bwi_facet_corner_functional(const bw_mesh *mesh, const bw_material *material, int32_t corner,
                                 const double tensor[6], double *force);
/* The same by the nodal forces whose traction acts. */
void bwi_facet_corner_by_force(const bw_mesh *mesh, const bw_material *material, const double *area,
                               int32_t corner, const double tensor[6], double *by_force);

#endif
