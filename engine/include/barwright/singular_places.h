/* singular_places: where a model has no finite stress, by its shape, supports and loads. */
#ifndef BARWRIGHT_SINGULAR_PLACES_H
#define BARWRIGHT_SINGULAR_PLACES_H

#include "barwright/model.h"
#include "barwright/singular.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Re-entrant edges of `surface` (what the mesh was filled from; NULL: the mesh's own boundary),
 * with margin (rad) as bw_singular_edges; borders of supports and of rigid couplings whose exponent
 * is below one; loads, supports, springs and couplings at single nodes, and along lines of them. Of
 * a sector those of the whole wheel. An angle beside a support is that of the
 * mesh's boundary. Facets constrained otherwise than along their normal count as fixed. BW_GEOMETRY
 * for a surface that is open or faces inwards. */
BW_API bw_status bw_singular_places_find(bw_context *context, const bw_model *model,
                                         const bw_surface *surface, double margin,
                                         bw_singular_places **places);

#ifdef __cplusplus
}
#endif
#endif
