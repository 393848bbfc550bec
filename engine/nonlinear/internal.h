/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of solids share. */
#ifndef BWI_NONLINEAR_INTERNAL_H
#define BWI_NONLINEAR_INTERNAL_H

#include "assemble/internal.h"
#include "barwright/nonlinear.h"
#include "nonlinear/law.h"

/* The part of a cell that counts at least, so that a cell which is hardly cut holds its nodes. */
#define BWI_MIN_FRACTION 1e-3

/* Volume of an element that energy and mass are multiplied with, m3. */
static inline double bwi_solid_volume(const bw_grid *grid, int32_t element) {
  double fraction = grid->fraction ? grid->fraction[element] : 1;
  return grid->spacing[0] * grid->spacing[1] * grid->spacing[2] *
         (fraction > BWI_MIN_FRACTION ? fraction : BWI_MIN_FRACTION);
}

/* Element stiffnesses are stored as their lower triangle: for a = 0..7 the blocks (a, b), b < a, of
 * 9 numbers, and the diagonal block's 6: 00 01 02 11 12 22. Corners and nodes are both numbered
 * along the lattice: a block (i, j), i >= j, of the pattern always has local nodes a >= b. */
enum { BWI_ELEMENT_NUMBERS = 300, BWI_ELEMENT_FORCES = 24 };
static inline int bwi_element_block(int a, int b) {
  return 9 * a * (a - 1) / 2 + 6 * a + 9 * b;
}

typedef struct bwi_hexahedron_state {
  double energy;
  double ratio; /* least det F; NaN where any is */
  bool defined;
} bwi_hexahedron_state;
/* One element at nodal displacements u of the whole grid; force (24) and stiffness (300) are
 * written as far as `want` goes. */
void bwi_element_evaluate(const bw_solid *solid, int32_t element, const double *u, bwi_want want,
                          bool project, bwi_hexahedron_state *state, double *force,
                          double *stiffness);
/* The same for a box of this material: displacements of its corners, and a volume. */
void bwi_cell_evaluate(const bw_solid_material *material, const double spacing[3], double volume,
                       const double u[8][3], bwi_want want, bool project,
                       bwi_hexahedron_state *state, double *force, double *stiffness);
/* Integrals over the element of P F^T (tensor, 9) and of det F, both by its points' weights, which
 * sum to 1; false where the energy does not exist. */
bool bwi_element_kirchhoff(const bw_solid *solid, int32_t element, const double *u,
                           double tensor[9], double *ratio);
/* What is kept of each element, plus `of_mass` times its lumped mass, plus `part` of what another
 * has (NULL: nothing). */
bw_status bwi_solid_linear_add(bw_context *context, bw_solid_linear *linear, double of_mass,
                               const bw_solid_linear *other, double part);
/* The same, plus `value` on the diagonal of the whole. */
bw_status bwi_solid_linear_shift(bw_context *context, bw_solid_linear *linear, double value);
/* BW_GEOMETRY that names an element whose energy does not exist. */
bw_status bwi_fail_undefined(bw_context *context, int64_t element);

#endif
