/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fields of rank 0, in global directions and the mesh's order, and vectors spread over the ranks,
 * in the nodes' frames and by row. */
#include <string.h>

#include "distributed/internal.h"

const double *bwd_frame_at(const bw_dof_map *dof_map, int64_t node) {
  int32_t row = dof_map->frame_of[node];
  return row < 0 ? NULL : dof_map->frame + 9 * (int64_t)row;
}

void bwd_into_frame(const double *frame, const double *global, double *own) {
  if (!frame)
    memcpy(own, global, 3 * sizeof *own);
  else
    for (int c = 0; c < 3; c++)
      own[c] = bw_dot(frame + 3 * c, global);
}

void bwd_out_of_frame(const double *frame, const double *own, double *global) {
  for (int c = 0; c < 3; c++)
    global[c] = frame ? frame[c] * own[0] + frame[3 + c] * own[1] + frame[6 + c] * own[2] : own[c];
}

bw_status bwd_spread(bw_context *context, bwd_system *system, Vec vector) {
  bw_status status = BW_OK;
  double *own = NULL;
  BWD_TRY(VecGetArray(vector, &own));
  MPI_Scatterv(system->field, system->counts, system->where, MPI_DOUBLE, own, 3 * system->local,
               MPI_DOUBLE, 0, bwd_comm());
  BWD_TRY(VecRestoreArray(vector, &own));
done:
  return status;
}

bw_status bwd_scatter(bw_context *context, bwd_system *system, const double *field, Vec vector) {
  if (system->rank == 0) {
    const bw_dof_map *dof_map = system->problem->dof_map;
    for (int64_t i = 0; i < system->nodes; i++)
      bwd_into_frame(bwd_frame_at(dof_map, i), field + 3 * i,
                     system->field + 3 * (int64_t)system->row_of[i]);
  }
  return bwd_spread(context, system, vector);
}

bw_status bwd_gather(bw_context *context, bwd_system *system, Vec vector, double *field) {
  bw_status status = BW_OK;
  const double *own = NULL;
  BWD_TRY(VecGetArrayRead(vector, &own));
  MPI_Gatherv(own, 3 * system->local, MPI_DOUBLE, system->field, system->counts, system->where,
              MPI_DOUBLE, 0, bwd_comm());
  BWD_TRY(VecRestoreArrayRead(vector, &own));
  if (system->rank == 0) {
    const bw_dof_map *dof_map = system->problem->dof_map;
    for (int64_t i = 0; i < system->nodes; i++)
      bwd_out_of_frame(bwd_frame_at(dof_map, i), system->field + 3 * (int64_t)system->row_of[i],
                       field + 3 * i);
  }
done:
  return status;
}

bw_status bwd_local_values(bw_context *context, bwd_system *system, Vec vector, double *field) {
  bw_status status = BW_OK;
  const double *own = NULL;
  BWD_TRY(
      VecScatterBegin(system->to_ghosted, vector, system->ghosted, INSERT_VALUES, SCATTER_FORWARD));
  BWD_TRY(
      VecScatterEnd(system->to_ghosted, vector, system->ghosted, INSERT_VALUES, SCATTER_FORWARD));
  BWD_TRY(VecGetArrayRead(system->ghosted, &own));
  memcpy(field, own, 3 * (size_t)system->mesh.count.nodes * sizeof *own);
  BWD_TRY(VecRestoreArrayRead(system->ghosted, &own));
done:
  return status;
}

bw_status bwd_ghosted(bw_context *context, bwd_system *system, Vec vector, double *field) {
  bw_status status = bwd_local_values(context, system, vector, field);
  for (int64_t i = 0; status == BW_OK && i < system->mesh.count.nodes; i++) {
    double own[3];
    memcpy(own, field + 3 * i, sizeof own);
    bwd_out_of_frame(bwd_local_frame(&system->mesh, (int32_t)i), own, field + 3 * i);
  }
  return status;
}
