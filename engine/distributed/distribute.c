/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A system to all ranks: what each must know, its mesh, its rows of the matrices, masks and
 * motions. */
#include <string.h>

#include "distributed/internal.h"

/* What every rank must know before its mesh comes. */
typedef struct plan {
  int32_t nodes, motions;
  int mass_width, direct, iterations;
  double tolerance, middle[3];
  bwd_material material;
} plan;

/* On rank 0. */
static bw_status make_plan(bw_context *context, bwd_system *system, bwd_partition *partition,
                           plan *p) {
  bw_status status = BW_OK;
  const bw_dof_map *dof_map = system->problem->dof_map;
  const bw_mesh *mesh = dof_map->mesh;
  system->nodes = mesh->node_count;
  if (system->nodes > INT32_MAX / 3 - 1)
    return bw_fail(context, BW_LIMIT,
                   "%d nodes: PETSc's 32-bit numbers allow %d at most; take larger elements",
                   (int)system->nodes, INT32_MAX / 3 - 1);
  system->field = BW_NEW(context, double, 3 * (int64_t)system->nodes);
  system->counts = BW_NEW(context, int, system->ranks);
  system->where = BW_NEW(context, int, system->ranks);
  if (!system->field || !system->counts || !system->where)
    return BW_MEMORY;
  BW_TRY(bwd_partition_create(context, mesh, system->ranks, system->start, partition));
  system->row_of = partition->row_of;
  partition->row_of = NULL;
  for (int r = 0; r < system->ranks; r++) {
    system->counts[r] = 3 * (system->start[r + 1] - system->start[r]);
    system->where[r] = 3 * system->start[r];
  }
  for (int64_t i = 0; i < mesh->node_count; i++)
    for (int c = 0; c < 3; c++)
      p->middle[c] += mesh->node[3 * i + c] / mesh->node_count;
  p->nodes = system->nodes;
  p->motions = dof_map->rigid_mode_count;
  p->mass_width = !system->problem->mass ? 0 : dof_map->frame_count > 0 ? 9 : 3;
  p->direct = system->direct;
  p->iterations = system->max_iterations;
  p->tolerance = system->tolerance;
  bwd_material_read(bw_material_unrotated(system->problem->material, 0), &p->material);
done:
  return status;
}

/* The rigid-body motions R and W R of rank 0's DOF map. */
static bw_status distribute_motions(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  double *field = NULL, *one = NULL;
  if (system->motions == 0)
    return BW_OK;
  if (system->rank == 0) {
    field = BW_NEW(context, double, 3 * (int64_t)system->nodes);
    one = BW_NEW0(context, double, system->motions);
    if (!field || !one)
      status = BW_MEMORY;
  }
  BW_TRY(bwd_agree(context, status));
  BWD_TRY(VecDuplicateVecs(system->force, system->motions, &system->motion));
  BWD_TRY(VecDuplicateVecs(system->force, system->motions, &system->weighted));
  for (int m = 0; m < system->motions; m++) {
    if (system->rank == 0) {
      const bw_dof_map *dof_map = system->problem->dof_map;
      one[m] = 1;
      memset(field, 0, 3 * (size_t)system->nodes * sizeof *field);
      bw_rigid_modes_add(dof_map, one, field);
    }
    BW_TRY(bwd_scatter(context, system, field, system->motion[m]));
    if (system->rank == 0) {
      bw_rigid_modes_weighted(system->problem->dof_map, one, field);
      one[m] = 0;
    }
    BW_TRY(bwd_scatter(context, system, field, system->weighted[m]));
  }
done:
  bw_free(field);
  bw_free(one);
  return status;
}

/* 1 where a component is solved for. */
static bw_status fill_mask(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  double *mask = NULL;
  BWD_TRY(VecGetArray(system->mask, &mask));
  for (int64_t i = 0; i < 3 * (int64_t)system->local; i++) {
    uint8_t state = system->mesh.state[i];
    mask[i] = state == BW_DOF_UNKNOWN || (state == BW_DOF_ISOSTATIC && !system->direct);
  }
  BWD_TRY(VecRestoreArray(system->mask, &mask));
done:
  return status;
}

/* Values at the rank's own nodes and ghost nodes, from vectors. */
static bw_status create_ghosted(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  IS rows = NULL;
  const bwd_local_mesh *local = &system->mesh;
  BWD_TRY(
      ISCreateBlock(PETSC_COMM_SELF, 3, local->count.nodes, local->row, PETSC_COPY_VALUES, &rows));
  BWD_TRY(VecCreateSeq(PETSC_COMM_SELF, 3 * local->count.nodes, &system->ghosted));
  BWD_TRY(VecScatterCreate(system->force, rows, system->ghosted, NULL, &system->to_ghosted));
done:
  ISDestroy(&rows);
  return status;
}

static bw_status create_vectors(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  BWD_TRY(VecCreate(PETSC_COMM_WORLD, &system->force));
  BWD_TRY(VecSetSizes(system->force, 3 * system->local, 3 * system->nodes));
  BWD_TRY(VecSetBlockSize(system->force, 3));
  BWD_TRY(VecSetType(system->force, VECSTANDARD));
  BWD_TRY(VecDuplicate(system->force, &system->displacement));
  BWD_TRY(VecDuplicate(system->force, &system->mask));
  BW_TRY(create_ghosted(context, system));
  BW_TRY(fill_mask(context, system));
done:
  return status;
}

bw_status bwd_distribute(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  int32_t max = 0;
  plan p = {0};
  bwd_partition partition = {0};
  double begin = bw_seconds();
  system->start = BW_NEW0(context, int32_t, (int64_t)system->ranks + 1);
  if (!system->start)
    status = BW_MEMORY;
  else if (system->rank == 0)
    status = make_plan(context, system, &partition, &p);
  BW_TRY(bwd_agree(context, status));
  MPI_Bcast(&p, sizeof p, MPI_BYTE, 0, bwd_comm());
  MPI_Bcast(system->start, system->ranks + 1, MPI_INT, 0, bwd_comm());
  system->nodes = p.nodes;
  system->motions = p.motions;
  system->mass_width = p.mass_width;
  memcpy(system->middle, p.middle, sizeof p.middle);
  system->tolerance = p.tolerance;
  system->max_iterations = p.iterations;
  system->direct = p.direct;
  system->first = system->start[system->rank];
  system->local = system->start[system->rank + 1] - system->first;
  if (system->rank == 0)
    partition.row_of = system->row_of;
  BW_TRY(
      bwd_local_mesh_distribute(context, system->problem, &partition, &p.material, &system->mesh));
  partition.row_of = NULL;
  bwd_partition_clear(&partition);
  system->seconds_send = bw_seconds() - begin;

  begin = bw_seconds();
  PetscBool other; /* preconditioners that are asked for by name have the whole of K */
  BWD_TRY(PetscOptionsHasName(NULL, NULL, "-barwright_pc_type", &other));
  system->two_level = !system->direct && !other && bwd_has_linear_elements(system);
  BW_TRY(create_vectors(context, system));
  BW_TRY(distribute_motions(context, system));
  system->seconds_assembly = bw_seconds() - begin;
  /* The setup of multigrid takes more memory than its result. So it comes before K. */
  if (system->two_level)
    BW_TRY(bwd_coarse_create(context, system));
  begin = bw_seconds();
  BW_TRY(bwd_matrices_create(context, &system->mesh, system->two_level, system->mass_width,
                             &system->K, &system->M, &max));
  BW_TRY(bwd_assemble(context, &system->mesh, system->mass_width, max, system->K, system->M));
  system->seconds_assembly += bw_seconds() - begin;
done:
  partition.row_of = NULL;
  bwd_partition_clear(&partition);
  return status;
}
