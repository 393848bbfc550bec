/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Integration of the pressures of a facet. A facet has three pressures, one at each corner, with
 * hat functions (parts 0), or parts^2 constant ones, each on one of as many equal triangles. */
#ifndef BARWRIGHT_ANALYSIS_PRESSURE_H
#define BARWRIGHT_ANALYSIS_PRESSURE_H

#include "barwright/analysis.h"

enum { BWI_MAX_PARTS = 16, BWI_MAX_PRESSURES = BWI_MAX_PARTS * BWI_MAX_PARTS };

/* Exact for pressure times displacement times the normal of a curved quadratic facet. */
typedef struct bwi_pressure_rule {
  int pressures, points, per_point; /* per_point: pressures that act at a point */
  double (*barycentric)[3];         /* points */
  double *weight;                   /* points; their sum is one */
  int *which;                       /* points x per_point: numbers of pressures */
  double *value;                    /* points x per_point: of their functions */
  double (*middle)[3];              /* pressures: barycentric coordinates of their place */
  int *nearest;                     /* pressures: the node of the facet in or next to its middle */
  double (*force)[6], *area;        /* pressures: means of function x shape function, of function */
} bwi_pressure_rule;
typedef struct bwi_pressure_rules {
  bwi_pressure_rule rule[BWI_MAX_PARTS + 1]; /* by parts */
} bwi_pressure_rules;

/* Those that the facets of a basis need. */
bw_status bwi_pressure_rules_create(bw_context *context, const bw_pressure_basis *basis,
                                    bwi_pressure_rules *rules);
void bwi_pressure_rules_clear(bwi_pressure_rules *rules);
const bwi_pressure_rule *bwi_facet_rule(const bwi_pressure_rules *rules,
                                        const bw_pressure_basis *basis, int32_t facet);

#endif
