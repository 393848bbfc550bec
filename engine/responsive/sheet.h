/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of elastic sheets share. */
#ifndef BWI_RESPONSIVE_SHEET_H
#define BWI_RESPONSIVE_SHEET_H

#include "responsive/internal.h"

/* ---- plane elasticity (sheet_section.c) ----------------------------------------------------- */

/* Stresses and strains in the plane are xx yy xy, strains with engineering shear. */
typedef struct bwi_section {
  double elasticity[9];    /* stress = elasticity strain */
  double across[3];        /* stress zz = across . strain; 0 in plane stress */
  double strain_across[3]; /* strain zz = strain_across . stress; 0 in plane strain */
  double compliance[9];    /* inverse of elasticity */
  double thickness, density;
} bwi_section;
bw_status bwi_section_create(bw_context *context, const bw_sheet_section *given,
                             bwi_section *section);

/* von Mises from xx yy xy and zz. */
double bwi_plane_von_mises(const double stress[3], double zz);

static inline void bwi_times3(const double a[9], const double x[3], double y[3]) {
  for (int i = 0; i < 3; i++)
    y[i] = a[3 * i] * x[0] + a[3 * i + 1] * x[1] + a[3 * i + 2] * x[2];
}

/* ---- quadrature on elements (rule.c) -------------------------------------------------------- */

enum { BWI_RULE_POINTS = 12 };
typedef struct bwi_triangle_rule {
  int order, n, count;
  double point[BWI_RULE_POINTS][3], weight[BWI_RULE_POINTS]; /* weights sum to 1/2 */
  double value[BWI_RULE_POINTS][6];                          /* shape functions */
  double slope[BWI_RULE_POINTS][6][2]; /* by L1 and L2, with L0 = 1 - L1 - L2 */
} bwi_triangle_rule;
void bwi_rule_create(int order, int degree, bwi_triangle_rule *rule);
/* What stiffness and weight are integrated with. Straight six-node elements have strains that are
 * linear in the plane, for which degree 2 is exact; on curved ones they are not polynomials, and
 * degree 4 is taken, as large deflections take it everywhere. */
typedef struct bwi_rules {
  bwi_triangle_rule straight, curved;
} bwi_rules;
void bwi_rules_create(int order, bwi_rules *rules);
const bwi_triangle_rule *bwi_rules_for(const bwi_rules *rules, const double (*x)[2]);

/* Gradients in the plane at point q of an element of N nodes; returns the Jacobian determinant.
 * N is a constant wherever this is expanded. */
static inline __attribute__((always_inline)) double bwi_rule_gradient(const bwi_triangle_rule *rule,
                                                                      int q, int N,
                                                                      const double (*x)[2],
                                                                      double (*g)[2]) {
  double a = 0, b = 0, c = 0, d = 0;
  for (int k = 0; k < N; k++) {
    const double *s = rule->slope[q][k];
    a += x[k][0] * s[0], b += x[k][0] * s[1];
    c += x[k][1] * s[0], d += x[k][1] * s[1];
  }
  double determinant = a * d - b * c, scale = 1 / determinant;
  a *= scale, b *= scale, c *= scale, d *= scale;
  for (int k = 0; k < N; k++) {
    const double *s = rule->slope[q][k];
    g[k][0] = s[0] * d - s[1] * c;
    g[k][1] = s[1] * a - s[0] * b;
  }
  return determinant;
}

/* ---- a sheet --------------------------------------------------------------------------------- */

/* All that an operation on a sheet changes (sheet_state.c). An operation makes the next state
 * beside the one that stands and puts it in its place when nothing can fail any more: it happens
 * whole or not at all, and keeping a state copies nothing. */
struct bw_sheet_state {
  bw_object object;
  const bw_plane_mesh *mesh; /* retained */
  int32_t condition_count;
  bw_condition
      *condition; /* whose tags are those of the mesh's outline; its functions are not called */
  double time;
  /* node_count x 2 each */
  double *displacement;
  double *velocity, *acceleration; /* both, or NULL */
  double *before, *former; /* the solution before the last, and of bw_sheet_large_deflection the one
                              before that; NULL: none */
  bool solved;             /* displacement is a solution of some mesh */
  bool statics;            /* the linear statics of this mesh */
  bool large;              /* by bw_sheet_large_deflection */
  bool moving;             /* acceleration fits displacement and velocity */
};

struct bwi_sheet {
  int32_t section_count;
  bwi_section *section;
  double *thickness;            /* of the sections */
  const bw_material **material; /* retained */
  int32_t condition_count;
  bw_condition *condition;
  double gravity[2];
  const bw_sheet_state *now; /* retained; the public fields are its own */

  /* From here on what follows from all that, or makes it faster: made when it is needed, dropped
   * when it is not of the state's mesh any more. No result depends on what is there. */
  bw_lagged_factor *lagged;
  /* By topology; NULL until used. */
  bw_plane_pattern *pattern;
  double *stiffness; /* 4 per block: as assembled */
  double *matrix;    /* 4 per block: what is solved with */
  double *mass;      /* 1 per block, density included */
  double *workspace; /* element matrices */
  /* By nodes. */
  uint8_t *is_prescribed;                  /* node_count x 2 */
  double *prescribed, *force, *rhs, *work; /* node_count x 2 each */

  bool stiffness_current;  /* of the mesh as it is; so also mass */
  double matrix_step[4];   /* step, beta, damping: what `matrix` is made with; step 0: nothing that
                              lasts, -1: the statics of the mesh as it is */
  bool prescribed_checked; /* no piece of this topology is free */
  bool conflicts_reported; /* of the conditions' prescribed values */
};

/* The state that stands as the first draft of the next, on `mesh`, which has the same nodes where
 * `fields` is set: then fields are copied, else there are none yet. Flags are those that stand. */
bw_status bwi_sheet_next(bw_context *context, const bw_sheet *sheet, const bw_plane_mesh *mesh,
                         bool fields, bw_sheet_state **next);
/* Puts a state in the place of the one that stands. Cannot fail. */
void bwi_sheet_adopt(bw_sheet *sheet, const bw_sheet_state *state);
/* The end of an operation: the state takes its place unless somebody asked to stop meanwhile, whom
 * a result would surprise. */
bw_status bwi_sheet_commit(bw_context *context, bw_sheet *sheet, const bw_sheet_state *next);

static inline const bwi_section *bwi_section_of(const bw_sheet *sheet, int32_t element) {
  const struct bwi_sheet *inner = sheet->inner;
  return &inner->section[inner->section_count > 1 ? sheet->mesh->topology->region[element] : 0];
}
static inline void bwi_element_points(const bw_plane_mesh *mesh, int32_t element, int n,
                                      double (*x)[2]) {
  const int32_t *node = mesh->topology->element + (int64_t)element * n;
  for (int a = 0; a < n; a++) {
    x[a][0] = mesh->point[2 * (int64_t)node[a]];
    x[a][1] = mesh->point[2 * (int64_t)node[a] + 1];
  }
}
/* The values of a field with two components at an element's nodes. */
static inline void bwi_element_field(const bw_plane_mesh *mesh, const double *field,
                                     int32_t element, int n, double (*u)[2]) {
  const int32_t *node = mesh->topology->element + (int64_t)element * n;
  for (int a = 0; a < n; a++) {
    u[a][0] = field[2 * (int64_t)node[a]];
    u[a][1] = field[2 * (int64_t)node[a] + 1];
  }
}
static inline void bwi_strain(int n, const double (*g)[2], const double (*u)[2], double e[3]) {
  e[0] = e[1] = e[2] = 0;
  for (int a = 0; a < n; a++) {
    e[0] += g[a][0] * u[a][0];
    e[1] += g[a][1] * u[a][1];
    e[2] += g[a][1] * u[a][0] + g[a][0] * u[a][1];
  }
}

/* Pattern and workspace for the topology at hand; *made when there was none. */
bw_status bwi_sheet_prepare(bw_context *context, bw_sheet *sheet, bool *made);
/* Stiffness and mass of the mesh as it is, unless they are so already. */
bw_status bwi_sheet_stiffness(bw_context *context, bw_sheet *sheet);
bw_status bwi_sheet_mass(bw_context *context, bw_sheet *sheet);
/* The same for three-node elements, in closed form (sheet_tri3.c). */
bw_status bwi_sheet_tri3_stiffness(bw_context *context, const bw_sheet *sheet, double *values);
bw_status bwi_sheet_tri3_mass(bw_context *context, const bw_sheet *sheet, double *values);
/* Forces of gravity, tractions and pressures at a time: into inner->force. */
bw_status bwi_sheet_force(bw_context *context, bw_sheet *sheet, double time);
/* inner->is_prescribed and inner->prescribed at a time. */
bw_status bwi_sheet_prescribe(bw_context *context, bw_sheet *sheet, double time);
/* inner->matrix and inner->rhs: the linear statics of the sheet as it is. *made: as in prepare. */
bw_status bwi_sheet_statics(bw_context *context, bw_sheet *sheet, bool *made);
/* BW_UNCONSTRAINED where a piece of the sheet can move rigidly against inner->is_prescribed. */
bw_status bwi_sheet_check_constraints(bw_context *context, const bw_sheet *sheet);

#endif
