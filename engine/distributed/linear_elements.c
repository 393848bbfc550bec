/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The coarse level of quadratic elements: linear elements on the same corners, as
 * docs/theory/solving.md has it for one process. Each rank assembles its rows from its local mesh,
 * as it does those of K, so that no triple product is formed. The interpolation gives a mid-edge
 * node the mean of its edge's ends. */
#include <string.h>

#include "distributed/internal.h"

void bwd_linear_elements_clear(bwd_linear_elements *linear) {
  MatDestroy(&linear->K);
  MatDestroy(&linear->interpolation);
  bw_free(linear->node);
  *linear = (bwd_linear_elements){0};
}

/* ---- the local mesh of linear elements ------------------------------------------------------- */

/* number: by node of the fine mesh, its number among the corners, or -1. */
static bw_status make_mesh(bw_context *context, const bwd_local_mesh *fine, int32_t *number,
                           bwd_local_mesh *mesh) {
  const struct bwd_local_counts *n = &fine->count;
  int32_t nodes = 0;
  memset(number, -1, (size_t)n->nodes * sizeof *number);
  for (int64_t e = 0; e < n->elements; e++)
    for (int a = 0; a < 4; a++)
      number[fine->element[e * n->nodes_per_element + a]] = 0;
  mesh->count = (struct bwd_local_counts){
      .order = 1, .nodes_per_element = 4, .elements = n->elements, .parts = n->parts};
  for (int32_t i = 0; i < n->nodes; i++) {
    if (number[i] < 0)
      continue;
    number[i] = nodes++;
    mesh->count.owned += i < n->owned;
    mesh->count.frames += bwd_local_frame(fine, i) != NULL;
  }
  mesh->count.nodes = nodes;
  bw_status status = bwd_local_mesh_allocate(context, mesh);
  if (status != BW_OK)
    return status;
  int32_t frames = 0;
  for (int64_t i = 0; i < n->nodes; i++) {
    int64_t k = number[i];
    const double *frame = bwd_local_frame(fine, (int32_t)i);
    if (k < 0)
      continue;
    memcpy(mesh->node + 3 * k, fine->node + 3 * i, 3 * sizeof(double));
    memcpy(mesh->state + 3 * k, fine->state + 3 * i, 3);
    if (mesh->frame_of)
      mesh->frame_of[k] = frame ? frames : -1;
    if (frame)
      memcpy(mesh->frame + 9 * (int64_t)frames++, frame, 9 * sizeof *frame);
  }
  for (int64_t e = 0; e < n->elements; e++)
    for (int a = 0; a < 4; a++)
      mesh->element[4 * e + a] = number[fine->element[e * n->nodes_per_element + a]];
  if (n->parts) {
    memcpy(mesh->part, fine->part, (size_t)n->elements * sizeof *fine->part);
    memcpy(mesh->kind, fine->kind, (size_t)n->parts * sizeof *fine->kind);
    memcpy(mesh->rotation, fine->rotation, 9 * (size_t)n->parts * sizeof *fine->rotation);
  }
  mesh->material = bw_retain(fine->material);
  return BW_OK;
}

/* Rows of the corners: those of a rank one after another. Ghost corners ask their owners. */
static bw_status number_rows(bw_context *context, bwd_system *system, const int32_t *number,
                             bwd_local_mesh *mesh) {
  bw_status status = BW_OK;
  int32_t first = 0;
  double *own = NULL;
  const double *all = NULL;
  MPI_Exscan(&mesh->count.owned, &first, 1, MPI_INT, MPI_SUM, bwd_comm());
  if (system->rank == 0)
    first = 0;
  BWD_TRY(VecSet(system->displacement, 0));
  BWD_TRY(VecGetArray(system->displacement, &own));
  for (int32_t i = 0; i < system->local; i++)
    own[3 * (int64_t)i] = first + number[i];
  BWD_TRY(VecRestoreArray(system->displacement, &own));
  BWD_TRY(VecScatterBegin(system->to_ghosted, system->displacement, system->ghosted, INSERT_VALUES,
                          SCATTER_FORWARD));
  BWD_TRY(VecScatterEnd(system->to_ghosted, system->displacement, system->ghosted, INSERT_VALUES,
                        SCATTER_FORWARD));
  BWD_TRY(VecGetArrayRead(system->ghosted, &all));
  for (int32_t i = 0; i < system->mesh.count.nodes; i++)
    if (number[i] >= 0)
      mesh->row[number[i]] = (int32_t)all[3 * (int64_t)i];
  BWD_TRY(VecRestoreArrayRead(system->ghosted, &all));
done:
  return status;
}

/* ---- interpolation --------------------------------------------------------------------------- */

/* F_i F_j^T times a weight, at components that no support prescribes. */
static bw_status interpolate_from(bw_context *context, const bwd_system *system, int32_t i,
                                  int32_t j, int32_t column_block, double weight, Mat matrix) {
  bw_status status = BW_OK;
  const bwd_local_mesh *mesh = &system->mesh;
  const double *left = bwd_local_frame(mesh, i), *right = bwd_local_frame(mesh, j);
  static const double global[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  left = left ? left : global;
  right = right ? right : global;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      double rotation = left == right ? r == c : bw_dot(left + 3 * r, right + 3 * c);
      bool solved = mesh->state[3 * (int64_t)i + r] != BW_DOF_PRESCRIBED &&
                    mesh->state[3 * (int64_t)j + c] != BW_DOF_PRESCRIBED;
      if (!solved || rotation == 0)
        continue;
      BWD_TRY(MatSetValue(matrix, 3 * mesh->row[i] + r, 3 * column_block + c, weight * rotation,
                          INSERT_VALUES));
    }
done:
  return status;
}

static bw_status make_interpolation(bw_context *context, bwd_system *system, const int32_t *number,
                                    const bwd_local_mesh *corners, Mat *matrix) {
  bw_status status = BW_OK;
  const bwd_local_mesh *mesh = &system->mesh;
  const struct bwd_local_counts *n = &mesh->count;
  int32_t *end = BW_NEW(context, int32_t, 2 * (int64_t)n->owned);
  PetscInt *own = BW_NEW0(context, PetscInt, 3 * (int64_t)n->owned);
  PetscInt *other = BW_NEW0(context, PetscInt, 3 * (int64_t)n->owned);
  bool complete = end && own && other;
  if (complete) {
    for (int64_t i = 0; i < 2 * (int64_t)n->owned; i++)
      end[i] = (int32_t)(i / 2); /* a corner is both of its ends */
    for (int64_t e = 0; e < n->elements; e++)
      for (int k = 0; k < 6; k++) {
        const int32_t *node = mesh->element + e * n->nodes_per_element;
        for (int s = 0; s < 2 && node[4 + k] < n->owned; s++)
          end[2 * (int64_t)node[4 + k] + s] = node[bw_tet_edge[k][s]];
      }
    for (int32_t i = 0; i < n->owned; i++)
      for (int s = 0; s < (number[i] >= 0 ? 1 : 2); s++) {
        int32_t j = end[2 * (int64_t)i + s];
        bool turned = bwd_local_frame(mesh, i) != bwd_local_frame(mesh, j);
        for (int c = 0; c < 3; c++)
          (j < n->owned ? own : other)[3 * (int64_t)i + c] += turned ? 3 : 1;
      }
  }
  BW_TRY(bwd_agree(context, complete ? BW_OK : BW_MEMORY));
  BWD_TRY(MatCreateAIJ(PETSC_COMM_WORLD, 3 * system->local, 3 * corners->count.owned,
                       3 * system->nodes, PETSC_DETERMINE, 0, own, 0, other, matrix));
  for (int32_t i = 0; i < n->owned; i++)
    for (int s = 0; s < (number[i] >= 0 ? 1 : 2); s++) {
      int32_t j = end[2 * (int64_t)i + s];
      BW_TRY(interpolate_from(context, system, i, j, corners->row[number[j]],
                              number[i] >= 0 ? 1 : 0.5, *matrix));
    }
  BWD_TRY(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  BWD_TRY(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
done:
  bw_free(end);
  bw_free(own);
  bw_free(other);
  return status;
}

/* ---- all of it ------------------------------------------------------------------------------- */

static bool projects(const bw_material *material) {
  for (int32_t i = 0; i < bw_material_part_count(material); i++)
    if (bw_material_projected_bulk(bw_material_part(material, i)) > 0)
      return true;
  return false;
}

bool bwd_has_linear_elements(const bwd_system *system) {
  const bwd_local_mesh *mesh = &system->mesh;
  int64_t own = 0, all = 0;
  if (mesh->count.order != 2 || projects(mesh->material))
    return false;
  for (int64_t e = 0; e < mesh->count.elements; e++)
    for (int a = 0; mesh->mine[e] && a < 4; a++)
      for (int c = 0; c < 3; c++)
        own += mesh->state[3 * (int64_t)mesh->element[10 * e + a] + c] == BW_DOF_PRESCRIBED;
  MPI_Allreduce(&own, &all, 1, MPI_INT64_T, MPI_SUM, bwd_comm());
  /* Supports at mid-edge nodes alone would leave the linear elements free. */
  return system->motions > 0 || all > 0;
}

bw_status bwd_linear_elements_create(bw_context *context, bwd_system *system,
                                     bwd_linear_elements *linear) {
  bw_status status = BW_OK;
  bwd_local_mesh mesh = {0};
  int32_t max = 0;
  int32_t *number = BW_NEW(context, int32_t, system->mesh.count.nodes);
  if (!number)
    status = BW_MEMORY;
  else
    status = make_mesh(context, &system->mesh, number, &mesh);
  linear->count = mesh.count.owned;
  linear->node = BW_NEW(context, int32_t, linear->count);
  if (!linear->node)
    status = BW_MEMORY;
  for (int32_t i = 0; status == BW_OK && i < system->local; i++)
    if (number[i] >= 0)
      linear->node[number[i]] = i;
  BW_TRY(bwd_agree(context, status));
  BW_TRY(number_rows(context, system, number, &mesh));
  BW_TRY(bwd_matrices_create(context, &mesh, false, 0, &linear->K, NULL, &max));
  BW_TRY(bwd_assemble(context, &mesh, 0, max, linear->K, NULL));
  BW_TRY(make_interpolation(context, system, number, &mesh, &linear->interpolation));
done:
  bw_free(number);
  bwd_local_mesh_clear(&mesh);
  return status;
}

bw_status bwd_linear_elements_inject(bw_context *context, const bwd_linear_elements *linear,
                                     Vec fine, Vec corners) {
  bw_status status = BW_OK;
  const double *from = NULL;
  double *to = NULL;
  BWD_TRY(VecGetArrayRead(fine, &from));
  BWD_TRY(VecGetArray(corners, &to));
  for (int64_t i = 0; i < linear->count; i++)
    memcpy(to + 3 * i, from + 3 * (int64_t)linear->node[i], 3 * sizeof *to);
  BWD_TRY(VecRestoreArray(corners, &to));
  BWD_TRY(VecRestoreArrayRead(fine, &from));
done:
  return status;
}
