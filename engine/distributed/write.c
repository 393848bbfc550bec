/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Results as .pvtu: each rank computes the stresses of its local mesh and writes a piece, and rank
 * 0 writes the file that names the pieces. A piece has the elements whose first node is the rank's
 * own, so that each element is in one piece. All elements around an own node are in the local mesh:
 * stresses at nodes are averaged there, and ghost nodes get theirs from their owners. */
#include <stdio.h>
#include <string.h>

#include "barwright/analysis.h"
#include "barwright/confine.h"
#include "barwright/io.h"
#include "distributed/internal.h"

enum { STRESS_FIELDS = 4, IDS = 2 };

/* What all ranks know of an output. */
typedef struct plan {
  int count, displacement, regions, path_length;
  char *path, *name;      /* name: count x BW_EXTERNAL_NAME */
  bw_mesh_region *region; /* `regions` of them */
} plan;

typedef struct piece {
  const bwd_local_mesh *local;
  int32_t element_count, *element; /* local numbers */
  int32_t node_count, *node;       /* local numbers */
  int32_t *number;                 /* of local nodes: in the piece, or -1 */
  int32_t *global, *region;        /* of the elements; region: in plan.region, NULL: none */
  int count;                       /* fields */
  bw_field *field;
  bw_array **array;
  int pieces; /* ranks that have elements, and so a piece */
  char *path;
} piece;

static void clear(plan *p, piece *q) {
  for (int i = 0; i < q->count; i++)
    bw_release(q->array[i]);
  bw_free(p->path);
  bw_free(p->name);
  bw_free(p->region);
  bw_free(q->element);
  bw_free(q->node);
  bw_free(q->number);
  bw_free(q->global);
  bw_free(q->region);
  bw_free(q->field);
  bw_free(q->array);
  bw_free(q->path);
}

/* ---- what is to be written ------------------------------------------------------------------- */

/* On rank 0, before the others write: may it be written, and is an older result out of the way? */
static bw_status prepare(bw_context *context, const plan *p, int ranks) {
  bw_status status = bw_may_use(context, p->path, BW_TO_WRITE);
  for (int r = 0; r < ranks && status == BW_OK; r++) {
    char *path = NULL;
    BW_TRY(bw_pvtu_piece_path(context, p->path, r, &path));
    status = bw_may_use(context, path, BW_TO_WRITE);
    bw_free(path);
  }
  BW_TRY(status);
  status = bw_pvtu_empty(context, p->path);
done:
  return status;
}

static bw_status make_plan(bw_context *context, const bwd_system *system,
                           const bw_external_output *output, plan *p) {
  bw_status status = BW_OK;
  int head[4] = {0};
  const bw_mesh *mesh = output ? system->problem->dof_map->mesh : NULL;
  if (output) {
    head[0] = output->count;
    head[1] = output->displacement;
    head[2] = mesh->region_count;
    head[3] = (int)strlen(output->path);
  }
  MPI_Bcast(head, 4, MPI_INT, 0, bwd_comm());
  *p = (plan){head[0], head[1], head[2], head[3], NULL, NULL, NULL};
  p->path = BW_NEW0(context, char, p->path_length + 1);
  p->name = BW_NEW0(context, char, p->count *BW_EXTERNAL_NAME + 1);
  p->region = BW_NEW0(context, bw_mesh_region, p->regions + 1);
  if (!p->path || !p->name || !p->region)
    status = BW_MEMORY;
  else if (output) {
    if (p->regions)
      memcpy(p->region, mesh->regions, (size_t)p->regions * sizeof *p->region);
    memcpy(p->path, output->path, (size_t)p->path_length);
    for (int k = 0; k < p->count; k++)
      snprintf(p->name + (int64_t)k * BW_EXTERNAL_NAME, BW_EXTERNAL_NAME, "%s", output->name[k]);
    status = prepare(context, p, system->ranks);
  }
  BW_TRY(bwd_agree(context, status));
  MPI_Bcast(p->path, p->path_length, MPI_CHAR, 0, bwd_comm());
  MPI_Bcast(p->name, p->count * BW_EXTERNAL_NAME, MPI_CHAR, 0, bwd_comm());
  MPI_Bcast(p->region, p->regions * (int)sizeof *p->region, MPI_BYTE, 0, bwd_comm());
done:
  return status;
}

/* ---- the piece ------------------------------------------------------------------------------- */

static bw_status select_piece(bw_context *context, const bwd_system *system, const plan *p,
                              piece *q) {
  const bwd_local_mesh *local = q->local = &system->mesh;
  int width = local->count.nodes_per_element, fields = p->count + STRESS_FIELDS + IDS;
  q->element = BW_NEW(context, int32_t, local->count.elements);
  q->node = BW_NEW(context, int32_t, local->count.nodes);
  q->number = BW_NEW(context, int32_t, local->count.nodes);
  q->global = BW_NEW(context, int32_t, local->count.elements);
  if (p->regions)
    q->region = BW_NEW(context, int32_t, local->count.elements);
  q->field = BW_NEW(context, bw_field, fields);
  q->array = BW_NEW(context, bw_array *, fields);
  if (!q->element || !q->node || !q->number || !q->global || (p->regions && !q->region) ||
      !q->field || !q->array)
    return BW_MEMORY;
  memset(q->number, -1, (size_t)local->count.nodes * sizeof *q->number);
  for (int32_t e = 0; e < local->count.elements; e++) {
    const int32_t *node = local->element + (int64_t)e * width;
    if (node[0] >= local->count.owned)
      continue;
    q->element[q->element_count++] = e;
    for (int a = 0; a < width; a++)
      if (q->number[node[a]] < 0) {
        q->number[node[a]] = q->node_count;
        q->node[q->node_count++] = node[a];
      }
  }
  return BW_OK;
}

/* Ranks without an element of their own write none. */
static bw_status number_pieces(bw_context *context, const plan *p, piece *q) {
  int own = q->element_count > 0, before = 0;
  MPI_Scan(&own, &before, 1, MPI_INT, MPI_SUM, bwd_comm());
  MPI_Allreduce(&own, &q->pieces, 1, MPI_INT, MPI_SUM, bwd_comm());
  return bw_pvtu_piece_path(context, p->path, before - 1, &q->path);
}

/* On rank 0: the elements of each rank's piece, in the order of the mesh, and what is at them. */
static void list_elements(const bwd_system *system, const int32_t *value, int *counts, int *where,
                          int32_t *list) {
  const bw_mesh *mesh = system->problem->dof_map->mesh;
  memset(counts, 0, (size_t)system->ranks * sizeof *counts);
  for (int pass = 0; pass < 2; pass++) {
    for (int r = 0, next = 0; r < system->ranks && pass == 1; r++) {
      where[r] = next;
      next += counts[r];
      counts[r] = 0;
    }
    for (int32_t e = 0; e < mesh->element_count; e++) {
      int32_t row = system->row_of[mesh->element[(int64_t)e * mesh->nodes_per_element]];
      int r = 0, end = system->ranks;
      while (end - r > 1) { /* the last rank that begins at or before the row */
        int middle = (r + end) / 2;
        if (system->start[middle] <= row)
          r = middle;
        else
          end = middle;
      }
      if (pass == 1)
        list[where[r] + counts[r]] = value ? value[e] : e;
      counts[r]++;
    }
  }
}

/* Numbers in the mesh, and regions, of the piece's elements. */
static bw_status receive_elements(bw_context *context, const bwd_system *system, const plan *p,
                                  piece *q) {
  bw_status status = BW_OK;
  int32_t *list = NULL;
  int *counts = NULL, *where = NULL;
  const bw_mesh *mesh = system->rank == 0 ? system->problem->dof_map->mesh : NULL;
  if (mesh) {
    list = BW_NEW(context, int32_t, mesh->element_count);
    counts = BW_NEW(context, int, system->ranks);
    where = BW_NEW(context, int, system->ranks);
    if (!list || !counts || !where)
      status = BW_MEMORY;
  }
  BW_TRY(bwd_agree(context, status));
  for (int which = 0; which < (p->regions ? 2 : 1); which++) {
    if (mesh)
      list_elements(system, which == 0 ? NULL : mesh->region, counts, where, list);
    MPI_Scatterv(list, counts, where, MPI_INT, which == 0 ? q->global : q->region, q->element_count,
                 MPI_INT, 0, bwd_comm());
  }
done:
  bw_free(list);
  bw_free(counts);
  bw_free(where);
  return status;
}

/* The piece's rows of a field of the local mesh. */
static bw_status add(bw_context *context, piece *q, const char *name, bw_field_place place,
                     int columns, const double *values) {
  bool nodes = place == BW_ON_NODES;
  int32_t count = nodes ? q->node_count : q->element_count;
  const int32_t *from = nodes ? q->node : q->element;
  bw_array *array = NULL;
  bw_status status = bw_array_create(context, BW_F64, count, columns, &array);
  if (status != BW_OK)
    return status;
  for (int64_t i = 0; i < count; i++)
    memcpy((double *)array->data + columns * i, values + (int64_t)columns * from[i],
           (size_t)columns * sizeof *values);
  q->field[q->count] = (bw_field){name, place, array};
  q->array[q->count++] = array;
  return BW_OK;
}

/* Numbers in the mesh, behind all other fields. `number`: of the local nodes, every third. */
static bw_status add_numbers(bw_context *context, piece *q, const double *number) {
  bw_status status = BW_OK;
  for (int place = 0; place < IDS; place++) {
    bw_array *array = NULL;
    int64_t count = place == 0 ? q->node_count : q->element_count;
    BW_TRY(bw_array_create(context, BW_I64, count, 1, &array));
    for (int64_t i = 0; i < count; i++)
      ((int64_t *)array->data)[i] =
          place == 0 ? (int64_t)number[3 * (int64_t)q->node[i]] : q->global[i];
    q->field[q->count] = place == 0 ? (bw_field){BW_PVTU_NODE, BW_ON_NODES, array}
                                    : (bw_field){BW_PVTU_ELEMENT, BW_ON_ELEMENTS, array};
    q->array[q->count++] = array;
  }
done:
  return status;
}

/* ---- stresses -------------------------------------------------------------------------------- */

/* The local mesh as one of the engine's, with its material. */
static bw_status make_body(bw_context *context, const bwd_local_mesh *local, bw_mesh **mesh,
                           bw_material **material) {
  bw_status status = BW_OK;
  int64_t width = local->count.nodes_per_element;
  double *node = BW_NEW(context, double, 3 * (int64_t)local->count.nodes);
  int32_t *element = BW_NEW(context, int32_t, local->count.elements * width);
  BW_TRY_MEMORY(node && element);
  memcpy(node, local->node, 3 * (size_t)local->count.nodes * sizeof *node);
  memcpy(element, local->element, (size_t)(local->count.elements * width) * sizeof *element);
  BW_TRY(bw_mesh_adopt(context, local->count.order, local->count.nodes, node, local->count.elements,
                       element, NULL, mesh));
  node = NULL;
  element = NULL;
  *material = bw_retain(local->material);
done:
  bw_free(node);
  bw_free(element);
  return status;
}

/* Six components at own nodes to all local nodes, three at a time. */
static bw_status share_tensors(bw_context *context, bwd_system *system, double *work,
                               double *stress) {
  bw_status status = BW_OK;
  for (int half = 0; half < 6; half += 3) {
    double *own = NULL;
    BWD_TRY(VecGetArray(system->displacement, &own));
    for (int64_t i = 0; i < system->local; i++)
      memcpy(own + 3 * i, stress + 6 * i + half, 3 * sizeof *own);
    BWD_TRY(VecRestoreArray(system->displacement, &own));
    BW_TRY(bwd_local_values(context, system, system->displacement, work));
    for (int64_t i = 0; i < system->mesh.count.nodes; i++)
      memcpy(stress + 6 * i + half, work + 3 * i, 3 * sizeof *own);
  }
done:
  return status;
}

static bw_status add_stresses(bw_context *context, bwd_system *system, const double *displacement,
                              double *work, piece *q) {
  bw_status status = BW_OK;
  const struct bwd_local_counts *n = &system->mesh.count;
  int64_t rows = n->nodes > n->elements ? n->nodes : n->elements;
  bw_mesh *mesh = NULL;
  bw_material *material = NULL;
  double *stress = BW_NEW(context, double, 6 * rows);
  status = stress ? make_body(context, &system->mesh, &mesh, &material) : BW_MEMORY;
  if (status == BW_OK)
    status = bw_nodal_stress(context, mesh, material, displacement, stress);
  BW_TRY(bwd_agree(context, status));
  BW_TRY(share_tensors(context, system, work, stress));
  BW_TRY(add(context, q, "stress", BW_ON_NODES, 6, stress));
  BW_TRY(bw_von_mises_field(context, n->nodes, stress, work));
  BW_TRY(add(context, q, "von_mises", BW_ON_NODES, 1, work));
  BW_TRY(bw_max_principal_field(context, n->nodes, stress, work));
  BW_TRY(add(context, q, "max_principal", BW_ON_NODES, 1, work));
  BW_TRY(bw_element_stress(context, mesh, material, displacement, stress));
  BW_TRY(add(context, q, "element_stress", BW_ON_ELEMENTS, 6, stress));
done:
  bw_free(stress);
  bw_release(mesh);
  bw_release(material);
  return status;
}

/* ---- all of it ------------------------------------------------------------------------------- */

static bw_status collect(bw_context *context, bwd_system *system, const plan *p,
                         const bw_external_output *output, piece *q) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)system->mesh.count.nodes;
  double *work = BW_NEW(context, double, size);
  double *displacement = p->displacement >= 0 ? BW_NEW(context, double, size) : NULL;
  if (!work || (p->displacement >= 0 && !displacement))
    status = BW_MEMORY;
  for (int k = 0; k < p->count; k++) {
    BW_TRY(bwd_agree(context, status));
    BW_TRY(bwd_scatter(context, system, output ? output->field[k] : NULL, system->displacement));
    BW_TRY(bwd_ghosted(context, system, system->displacement, work));
    if (k == p->displacement)
      memcpy(displacement, work, (size_t)size * sizeof *work);
    status = add(context, q, p->name + (int64_t)k * BW_EXTERNAL_NAME, BW_ON_NODES, 3, work);
  }
  BW_TRY(bwd_agree(context, status));
  if (p->displacement >= 0)
    status = add_stresses(context, system, displacement, work, q);
  BW_TRY(bwd_agree(context, status));
  for (int64_t i = 0; output && i < system->nodes; i++)
    system->field[3 * (int64_t)system->row_of[i]] = (double)i;
  BW_TRY(bwd_spread(context, system, system->displacement));
  BW_TRY(bwd_local_values(context, system, system->displacement, work));
  status = add_numbers(context, q, work);
done:
  bw_free(work);
  bw_free(displacement);
  return status;
}

static bw_status write_piece(bw_context *context, const plan *p, const piece *q) {
  bw_status status = BW_OK;
  bw_mesh *mesh = NULL;
  int width = q->local->count.nodes_per_element;
  double *node = BW_NEW(context, double, 3 * (int64_t)q->node_count);
  int32_t *element = BW_NEW(context, int32_t, (int64_t)q->element_count * width);
  bw_mesh_regions regions = {p->regions, p->region, q->region};
  BW_TRY_MEMORY(node && element);
  for (int64_t i = 0; i < q->node_count; i++)
    memcpy(node + 3 * i, q->local->node + 3 * (int64_t)q->node[i], 3 * sizeof *node);
  for (int64_t e = 0; e < q->element_count; e++)
    for (int a = 0; a < width; a++)
      element[e * width + a] = q->number[q->local->element[(int64_t)q->element[e] * width + a]];
  BW_TRY(bw_mesh_adopt(context, q->local->count.order, q->node_count, node, q->element_count,
                       element, &regions, &mesh));
  node = NULL;
  element = NULL;
  status = bw_mesh_write(context, mesh, q->path, q->count, q->field);
done:
  bw_free(node);
  bw_free(element);
  bw_release(mesh);
  return status;
}

bw_status bwd_write(bw_context *context, bwd_system *system, const bw_external_output *output) {
  bw_status status = BW_OK;
  plan p = {0};
  piece q = {0};
  bool written = false, emptied = false;
  BW_TRY(make_plan(context, system, output, &p));
  if (system->rank == 0)
    bw_progress(context, "writing", 0);
  emptied = system->rank == 0;
  BW_TRY(bwd_agree(context, select_piece(context, system, &p, &q)));
  BW_TRY(bwd_agree(context, number_pieces(context, &p, &q)));
  BW_TRY(receive_elements(context, system, &p, &q));
  BW_TRY(bwd_agree(context, collect(context, system, &p, output, &q)));
  if (q.element_count > 0)
    status = write_piece(context, &p, &q);
  written = status == BW_OK && q.element_count > 0;
  BW_TRY(bwd_agree(context, status));
  if (system->rank == 0)
    status = bw_pvtu_write_index(context, p.path, q.pieces, p.regions != 0, q.count - IDS, q.field);
  BW_TRY(bwd_agree(context, status));
done:
  if (status != BW_OK && written)
    bw_remove(q.path);
  if (status != BW_OK && emptied)
    bw_remove(p.path);
  clear(&p, &q);
  return status;
}
