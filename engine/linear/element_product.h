/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* y = K x of straight tet10 of one material, element by element, without the blocks of K: they are
 * nine times as many numbers as the elements have (docs/theory/solving.md, "Products by elements").
 *
 * Elements come in groups, whose rows lie in two neighbouring chunks of a smoother. Every other
 * group runs at once, then those between them: each sum has one order, for any number of
 * threads. */
#ifndef BWI_LINEAR_ELEMENT_PRODUCT_H
#define BWI_LINEAR_ELEMENT_PRODUCT_H

#include "linear/smoother.h"

/* Whether a product by elements serves: elements are straight, of one material, and displacements
 * alone enter their energy. The blocks of two nodes with no facet of the boundary in common are
 * symmetric then, since the mean volumetric strain of B-bar couples a node's x with another's y,
 * and not y with x. */
bw_status bwi_element_product_serves(bw_context *context, const bw_mesh *mesh,
                                     const bw_material *material, bool *serves);
/* Of `unit` K in the order of the smoother's rows. Release with bw_release. */
bw_status bwi_element_product_create(bw_context *context, const bwi_smoother *smoother,
                                     const bw_mesh *mesh, const bw_material *material,
                                     bwi_element_product **out);
/* As bwi_smoother_product. */
bw_status bwi_element_product_apply(bw_context *context, const bwi_element_product *product,
                                    int width, const double *x, double *y, double *energy);

#endif
