/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files about domains share. */
#ifndef BWI_SHAPE_DOMAINS_H
#define BWI_SHAPE_DOMAINS_H

#include "barwright/shape.h"

/* Elements as members of a domain, and domains as members of a group: union by the lowest number,
 * so that a group is named by its first member. */
int32_t bwi_group_find(int32_t *group, int32_t i);
void bwi_group_join(int32_t *group, int32_t a, int32_t b);

/* What says which bone a part follows that touches no domain of type R: weights per node and bone,
 * or earlier domains of the same mesh, or (both NULL) the bones' distances. */
typedef struct bwi_guide {
  const double *weight;
  const bw_domains *before;
} bwi_guide;
/* Adds to score (bone_count entries) what speaks for each bone at element e. */
void bwi_guide_score(const bwi_guide *guide, const bw_mesh *mesh, const bw_skeleton *skeleton,
                     int32_t e, double *score);
int32_t bwi_highest(const double *score, int32_t count); /* the first of the highest, or -1 */

/* group[e]: the first element of the part that e belongs to among those with bone[e] < 0, joined
 * through faces and through nodes that no element with bone[e] >= 0 has; -1 for the others. */
bw_status bwi_flexible_groups(bw_context *context, const bw_mesh *mesh, const int32_t *bone,
                              int32_t *group);
/* The domains that bone[e] (-1: type F) describes, numbered by bone and then by first element.
 * The bones' elements must fulfil the invariants. */
bw_status bwi_domains_from_bones(bw_context *context, const bw_mesh *mesh,
                                 const bw_skeleton *skeleton, const int32_t *bone,
                                 const bwi_guide *guide, bw_domains **domains);
/* The same with all numbers given. */
bw_status bwi_domains_make(bw_context *context, const bw_mesh *mesh, const bw_skeleton *skeleton,
                           int32_t count, const int32_t *bone_of, const int32_t *element_domain,
                           const bwi_guide *guide, bw_domains **domains);
/* Fills in the bones of each domain and what moves each corner node (blend.c). */
bw_status bwi_domains_blend(bw_context *context, bw_domains *domains, const bwi_guide *guide);
/* Cuts the domains, with all else given, into pieces, anew where there are any (pieces.c). */
bw_status bwi_domains_cut(bw_context *context, bw_domains *domains);
void bwi_domains_clear_pieces(bw_domains *domains);
bw_status bwi_domains_check_pieces(bw_context *context, const bw_domains *domains);

#endif
