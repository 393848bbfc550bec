/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The mesh of each rank: rank 0 makes them one after the other and sends them, so that beside the
 * whole mesh it has the part of one rank at a time. */
#include <string.h>

#include "distributed/internal.h"

enum { MESH_TAG = 2, ANSWER_TAG = 3, BLOCKS = 10 };
static const size_t piece_bytes = 1u << 24; /* of one message */

void bwd_local_mesh_clear(bwd_local_mesh *local) {
  bw_free(local->element);
  bw_free(local->mine);
  bw_free(local->part);
  bw_free(local->kind);
  bw_free(local->rotation);
  bw_free(local->node);
  bw_free(local->row);
  bw_free(local->state);
  bw_free(local->frame_of);
  bw_free(local->frame);
  bw_release(local->material);
  *local = (bwd_local_mesh){0};
}

const double *bwd_local_frame(const bwd_local_mesh *local, int32_t node) {
  int32_t row = local->frame_of ? local->frame_of[node] : -1;
  return row < 0 ? NULL : local->frame + 9 * (int64_t)row;
}

/* ---- material -------------------------------------------------------------------------------- */

void bwd_material_read(const bw_material *material, bwd_material *constants) {
  const bw_material *m = material;
  *constants = (bwd_material){
      .isotropic = m->isotropic, .formulation = (int)m->formulation, .density = m->density};
  memcpy(constants->young, m->young, sizeof m->young);
  memcpy(constants->poisson, m->poisson, sizeof m->poisson);
  memcpy(constants->shear, m->shear, sizeof m->shear);
  memcpy(constants->axes, m->axes, sizeof m->axes);
}

bw_status bwd_material_create(bw_context *context, const bwd_material *constants,
                              bw_material **material) {
  bw_material *standard = NULL;
  bw_status status;
  if (constants->isotropic) {
    const bw_isotropic given = {.name = "",
                                .young = constants->young[0],
                                .poisson = constants->poisson[0],
                                .density = constants->density};
    status = bw_material_isotropic(context, &given, &standard);
  } else {
    bw_orthotropic given = {.name = "", .density = constants->density};
    memcpy(given.young, constants->young, sizeof given.young);
    memcpy(given.poisson, constants->poisson, sizeof given.poisson);
    memcpy(given.shear, constants->shear, sizeof given.shear);
    memcpy(given.axes, constants->axes, sizeof given.axes);
    status = bw_material_orthotropic(context, &given, &standard);
  }
  if (status == BW_OK)
    status =
        bw_material_formulated(context, standard, (bw_formulation)constants->formulation, material);
  bw_release(standard);
  return status;
}

bw_status bwd_local_material(bw_context *context, bwd_local_mesh *local, const bwd_material *all) {
  bw_status status = BW_OK;
  int32_t count = local->count.parts;
  const bw_material **part = NULL;
  if (count == 0)
    return bwd_material_create(context, all, &local->material);
  part = BW_NEW0(context, const bw_material *, count);
  BW_TRY_MEMORY(part);
  for (int32_t i = 0; i < count; i++) {
    bw_material *unrotated = NULL, *turned = NULL;
    status = bwd_material_create(context, local->kind + i, &unrotated);
    if (status == BW_OK)
      status = bw_material_rotated(context, unrotated, local->rotation + 9 * (int64_t)i, &turned);
    bw_release(unrotated);
    part[i] = turned;
    if (status != BW_OK)
      goto done;
  }
  status = bw_material_by_element(context, local->count.elements, count, local->part, part,
                                  &local->material);
done:
  for (int32_t i = 0; part && i < count; i++)
    bw_release(part[i]);
  bw_free(part);
  return status;
}

/* ---- arrays ---------------------------------------------------------------------------------- */

typedef struct block {
  void **place;
  size_t size;   /* of an entry */
  int64_t count; /* 0: the array is left out */
} block;

static void list_blocks(bwd_local_mesh *local, block list[BLOCKS]) {
  const struct bwd_local_counts *n = &local->count;
  const block all[BLOCKS] = {
      {(void **)&local->element, sizeof(int32_t), (int64_t)n->elements * n->nodes_per_element},
      {(void **)&local->mine, 1, n->elements},
      {(void **)&local->part, sizeof(int32_t), n->parts ? n->elements : 0},
      {(void **)&local->kind, sizeof *local->kind, n->parts},
      {(void **)&local->rotation, sizeof(double), 9 * (int64_t)n->parts},
      {(void **)&local->node, sizeof(double), 3 * (int64_t)n->nodes},
      {(void **)&local->row, sizeof(int32_t), n->nodes},
      {(void **)&local->state, 1, 3 * (int64_t)n->nodes},
      {(void **)&local->frame_of, sizeof(int32_t), n->frames ? n->nodes : 0},
      {(void **)&local->frame, sizeof(double), 9 * (int64_t)n->frames}};
  memcpy(list, all, sizeof all);
}

bw_status bwd_local_mesh_allocate(bw_context *context, bwd_local_mesh *local) {
  block list[BLOCKS];
  list_blocks(local, list);
  for (int k = 0; k < BLOCKS; k++)
    if (list[k].count > 0) {
      *list[k].place = bw_alloc(context, (size_t)list[k].count, list[k].size);
      if (!*list[k].place)
        return BW_MEMORY;
    }
  return BW_OK;
}

static void transfer(bwd_local_mesh *local, int rank, bool sending) {
  block list[BLOCKS];
  list_blocks(local, list);
  for (int k = 0; k < BLOCKS; k++) {
    size_t bytes = (size_t)list[k].count * list[k].size;
    for (size_t at = 0; at < bytes; at += piece_bytes) {
      char *data = (char *)*list[k].place + at;
      int count = (int)(bytes - at < piece_bytes ? bytes - at : piece_bytes);
      if (sending)
        MPI_Send(data, count, MPI_BYTE, rank, MESH_TAG, bwd_comm());
      else
        MPI_Recv(data, count, MPI_BYTE, rank, MESH_TAG, bwd_comm(), MPI_STATUS_IGNORE);
    }
  }
}

/* ---- on rank 0 ------------------------------------------------------------------------------- */

/* What the making of all local meshes shares. */
typedef struct maker {
  const bw_external_problem *problem;
  const bwd_partition *partition;
  int32_t *node_at;  /* by row */
  int32_t *local_of; /* by node: its local number on the rank in work, or -1 */
  int32_t *part_of;  /* by part of the material, likewise; or NULL */
  int64_t *first;    /* ranks + 1: of each rank's elements in `element` */
  int32_t *element;  /* ascending for each rank */
} maker;

static void clear_maker(maker *m) {
  bw_free(m->node_at);
  bw_free(m->local_of);
  bw_free(m->part_of);
  bw_free(m->first);
  bw_free(m->element);
}

static bw_status make_lists(bw_context *context, int ranks, maker *m) {
  const bw_mesh *mesh = m->problem->dof_map->mesh;
  const bw_material_parts *turned = m->problem->material->parts;
  m->node_at = BW_NEW(context, int32_t, mesh->node_count);
  m->local_of = BW_NEW(context, int32_t, mesh->node_count);
  if (turned)
    m->part_of = BW_NEW(context, int32_t, turned->count);
  if (!m->node_at || !m->local_of || (turned && !m->part_of))
    return BW_MEMORY;
  for (int32_t i = 0; i < mesh->node_count; i++) {
    m->node_at[m->partition->row_of[i]] = i;
    m->local_of[i] = -1;
  }
  for (int32_t g = 0; turned && g < turned->count; g++)
    m->part_of[g] = -1;
  return bwd_group_elements(context, mesh->element_count, mesh->nodes_per_element, mesh->element,
                            m->partition->owner, ranks, &m->first, &m->element);
}

static void take_node(maker *m, int32_t node, struct bwd_local_counts *n) {
  if (m->local_of[node] >= 0)
    return;
  m->local_of[node] = n->nodes++;
  n->frames += m->problem->dof_map->frame_of[node] >= 0;
}

/* Sizes, and local numbers of nodes and groups. */
static void number(maker *m, int rank, struct bwd_local_counts *n) {
  const bw_mesh *mesh = m->problem->dof_map->mesh;
  const bw_material_parts *turned = m->problem->material->parts;
  const int32_t *start = m->partition->start;
  *n = (struct bwd_local_counts){.order = mesh->order,
                                 .nodes_per_element = mesh->nodes_per_element,
                                 .elements = (int32_t)(m->first[rank + 1] - m->first[rank]),
                                 .owned = start[rank + 1] - start[rank]};
  for (int32_t row = start[rank]; row < start[rank + 1]; row++)
    take_node(m, m->node_at[row], n);
  for (int64_t k = m->first[rank]; k < m->first[rank + 1]; k++) {
    const int32_t *node = mesh->element + (int64_t)m->element[k] * n->nodes_per_element;
    for (int a = 0; a < n->nodes_per_element; a++)
      take_node(m, node[a], n);
    if (turned && m->part_of[turned->of_element[m->element[k]]] < 0)
      m->part_of[turned->of_element[m->element[k]]] = n->parts++;
  }
}

static void fill_node(const maker *m, int32_t node, int32_t *frames, bwd_local_mesh *local) {
  const bw_dof_map *dof_map = m->problem->dof_map;
  int64_t i = m->local_of[node];
  memcpy(local->node + 3 * i, dof_map->mesh->node + 3 * (int64_t)node, 3 * sizeof(double));
  memcpy(local->state + 3 * i, dof_map->state + 3 * (int64_t)node, 3);
  local->row[i] = m->partition->row_of[node];
  if (!local->frame_of)
    return;
  const double *frame = bwd_frame_at(dof_map, node);
  local->frame_of[i] = frame ? (*frames)++ : -1;
  if (frame)
    memcpy(local->frame + 9 * (int64_t)local->frame_of[i], frame, 9 * sizeof *frame);
}

/* The arrays. A node's number is forgotten as soon as it is filled in for the last time. */
static void fill(maker *m, int rank, bwd_local_mesh *local) {
  const bw_mesh *mesh = m->problem->dof_map->mesh;
  const bw_material_parts *turned = m->problem->material->parts;
  const int32_t *start = m->partition->start, *list = m->element + m->first[rank];
  int width = mesh->nodes_per_element;
  int32_t frames = 0, ghosts = local->count.owned;
  for (int32_t row = start[rank]; row < start[rank + 1]; row++)
    fill_node(m, m->node_at[row], &frames, local);
  for (int64_t e = 0; e < local->count.elements; e++) {
    const int32_t *node = mesh->element + (int64_t)list[e] * width;
    for (int a = 0; a < width; a++) {
      int32_t i = local->element[e * width + a] = m->local_of[node[a]];
      if (i == ghosts) { /* met in the order of their numbers */
        fill_node(m, node[a], &frames, local);
        ghosts++;
      }
    }
    local->mine[e] = m->partition->rank_of_element[list[e]] == rank;
    if (turned) {
      int32_t part = turned->of_element[list[e]];
      local->part[e] = m->part_of[part];
      bwd_material_read(turned->unrotated[part], local->kind + local->part[e]);
      memcpy(local->rotation + 9 * (int64_t)local->part[e], turned->rotation + 9 * (int64_t)part,
             9 * sizeof(double));
    }
  }
}

static void forget(maker *m, int rank) {
  const bw_mesh *mesh = m->problem->dof_map->mesh;
  const bw_material_parts *turned = m->problem->material->parts;
  for (int64_t k = m->first[rank]; k < m->first[rank + 1]; k++) {
    const int32_t *node = mesh->element + (int64_t)m->element[k] * mesh->nodes_per_element;
    for (int a = 0; a < mesh->nodes_per_element; a++)
      m->local_of[node[a]] = -1;
    if (turned)
      m->part_of[turned->of_element[m->element[k]]] = -1;
  }
}

static bw_status make(bw_context *context, maker *m, int rank, bwd_local_mesh *local) {
  number(m, rank, &local->count);
  bw_status status = bwd_local_mesh_allocate(context, local);
  if (status == BW_OK)
    fill(m, rank, local);
  forget(m, rank);
  return status;
}

/* ---- from rank 0 to the others --------------------------------------------------------------- */

/* To one rank. Whatever fails here or there, both know, and no array is sent. */
static bw_status send_mesh(bw_context *context, maker *m, int rank, bw_status before) {
  bwd_local_mesh local = {0};
  bw_status status = before == BW_OK ? make(context, m, rank, &local) : before;
  int ready = 0;
  if (status != BW_OK)
    local.count = (struct bwd_local_counts){.elements = -1};
  MPI_Send(&local.count, sizeof local.count, MPI_BYTE, rank, MESH_TAG, bwd_comm());
  if (status == BW_OK) {
    MPI_Recv(&ready, 1, MPI_INT, rank, ANSWER_TAG, bwd_comm(), MPI_STATUS_IGNORE);
    if (ready)
      transfer(&local, rank, true);
  } else
    local.count = (struct bwd_local_counts){0};
  bwd_local_mesh_clear(&local);
  return status;
}

static bw_status receive_mesh(bw_context *context, bwd_local_mesh *local) {
  bwd_backoff backoff = {0};
  for (int there = 0;;) {
    MPI_Iprobe(0, MESH_TAG, bwd_comm(), &there, MPI_STATUS_IGNORE);
    if (there)
      break;
    bwd_pause(&backoff);
  }
  MPI_Recv(&local->count, sizeof local->count, MPI_BYTE, 0, MESH_TAG, bwd_comm(),
           MPI_STATUS_IGNORE);
  if (local->count.elements < 0) { /* rank 0 has failed, and says so at the agreement */
    local->count = (struct bwd_local_counts){0};
    return BW_OK;
  }
  bw_status status = bwd_local_mesh_allocate(context, local);
  int ready = status == BW_OK;
  MPI_Send(&ready, 1, MPI_INT, 0, ANSWER_TAG, bwd_comm());
  if (ready)
    transfer(local, 0, false);
  return status;
}

bw_status bwd_local_mesh_distribute(bw_context *context, const bw_external_problem *problem,
                                    const bwd_partition *partition, const bwd_material *material,
                                    bwd_local_mesh *local) {
  bw_status status = BW_OK;
  if (bw_world_rank() == 0) {
    int ranks = bw_world_size();
    maker m = {.problem = problem, .partition = partition};
    status = make_lists(context, ranks, &m);
    for (int r = 1; r < ranks; r++)
      status = send_mesh(context, &m, r, status);
    if (status == BW_OK)
      status = make(context, &m, 0, local);
    clear_maker(&m);
  } else
    status = receive_mesh(context, local);
  if (status == BW_OK)
    status = bwd_local_material(context, local, material);
  return bwd_agree(context, status);
}
