/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The map of a pose, for any place in or beside the mesh. */
#ifndef BWI_POSE_MAP_H
#define BWI_POSE_MAP_H

#include "barwright/shape.h"

/* Each corner node moves by an affine map, the blend of its bones' maps. Within an element the maps
 * of its corners are interpolated; a place outside of the mesh has the map of the nearest place in
 * it. So the map is continuous but for places as far from one part of the boundary as from another.
 */
typedef struct bwi_pose_map bwi_pose_map;

/* map: (m, bone_count x 12), of bw_pose_maps. Borrows the mesh of the subdomains. */
bw_status bwi_pose_map_create(bw_context *context, const bw_subdomains *subdomains,
                              const double *map, bwi_pose_map **out);
void bwi_pose_map_destroy(bwi_pose_map *map);

/* Where x goes (m). Exactly x where the maps around it are the identity. */
void bwi_pose_map_point(const bwi_pose_map *map, const double x[3], double y[3]);

/* The mean edge of the mesh's boundary (m): the map knows no finer shape. */
double bwi_pose_map_spacing(const bwi_pose_map *map);

#endif
