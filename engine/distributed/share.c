/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From the pairs of rank 0 to matrices whose rows lie on their ranks, in pieces of a few megabytes:
 * rank 0 never holds a second copy of K, and no message has more bytes than an int can count. */
#include <string.h>

#include "distributed/internal.h"

enum { ROW_TAG = 2, PIECE_BLOCKS = 32768 };

/* ---- fields ------------------------------------------------------------------------------------
 */

static const double *frame_at(const bw_numbering *numbering, int64_t node) {
  int32_t row = numbering->frame_of[node];
  return row < 0 ? NULL : numbering->frame + 9 * (int64_t)row;
}

static void into_frame(const double *frame, const double *global, double *own) {
  if (!frame)
    memcpy(own, global, 3 * sizeof *own);
  else
    for (int c = 0; c < 3; c++)
      own[c] = bw_dot(frame + 3 * c, global);
}

static void out_of_frame(const double *frame, const double *own, double *global) {
  for (int c = 0; c < 3; c++)
    global[c] = frame ? frame[c] * own[0] + frame[3 + c] * own[1] + frame[6 + c] * own[2] : own[c];
}

/* The numbers in `system->field`, already by place, to a vector. */
static bw_status spread(bw_context *context, bwd_system *system, Vec vector) {
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
    const bw_numbering *numbering = system->matrix->numbering;
    for (int64_t i = 0; i < system->nodes; i++)
      into_frame(frame_at(numbering, i), field + 3 * i,
                 system->field + 3 * (int64_t)system->place[i]);
  }
  return spread(context, system, vector);
}

bw_status bwd_gather(bw_context *context, bwd_system *system, Vec vector, double *field) {
  bw_status status = BW_OK;
  const double *own = NULL;
  BWD_TRY(VecGetArrayRead(vector, &own));
  MPI_Gatherv(own, 3 * system->local, MPI_DOUBLE, system->field, system->counts, system->where,
              MPI_DOUBLE, 0, bwd_comm());
  BWD_TRY(VecRestoreArrayRead(vector, &own));
  if (system->rank == 0) {
    const bw_numbering *numbering = system->matrix->numbering;
    for (int64_t i = 0; i < system->nodes; i++)
      out_of_frame(frame_at(numbering, i), system->field + 3 * (int64_t)system->place[i],
                   field + 3 * i);
  }
done:
  return status;
}

/* ---- rows --------------------------------------------------------------------------------------
 */

/* A run of rows: per row its number of blocks; per block its column; per row its 3 x 3n numbers of
 * K, row by row, and `mass_width` numbers per block of M. */
typedef struct piece {
  int32_t rows, blocks;
  int32_t *length, *column;
  double *stiffness, *mass;
} piece;

static size_t piece_bytes(const bwd_system *system, int64_t blocks) {
  return (size_t)blocks * (9 + (size_t)system->mass_width) * sizeof(double) +
         (2 + 2 * (size_t)blocks) * sizeof(int32_t);
}

/* Where the parts lie in a buffer: numbers first, for their alignment. Every row has a block. */
static void lay_out(const bwd_system *system, void *buffer, int64_t capacity, piece *p) {
  double *numbers = buffer;
  p->stiffness = numbers;
  p->mass = numbers + 9 * capacity;
  int32_t *words = (int32_t *)(p->mass + system->mass_width * capacity);
  p->length = words + 2;
  p->column = p->length + capacity;
}

/* A place and the pair it stands for, seen from the row: `turned` when it is stored as (k, i). */
typedef struct neighbour {
  int32_t place, node;
  int64_t pair;
  bool turned;
} neighbour;

static int32_t row_neighbours(const bwd_system *system, int32_t node, neighbour *list) {
  const bw_graph *graph = system->matrix->graph;
  int32_t count = 0;
  for (int64_t k = graph->start[node]; k < graph->start[node + 1]; k++)
    list[count++] = (neighbour){system->place[graph->column[k]], graph->column[k], k, false};
  for (int64_t k = graph->upper_start[node]; k < graph->upper_start[node + 1]; k++)
    list[count++] = (neighbour){system->place[graph->upper_row[k]], graph->upper_row[k],
                                graph->upper_pair[k], true};
  for (int32_t a = 1; a < count; a++) { /* a few dozen */
    neighbour moving = list[a];
    int32_t b = a;
    for (; b > 0 && list[b - 1].place > moving.place; b--)
      list[b] = list[b - 1];
    list[b] = moving;
  }
  return count;
}

/* block = F_i K_ij F_j^T without what is held. */
static void stiffness_block(const bwd_system *system, int32_t i, const neighbour *n,
                            double block[9]) {
  const bw_numbering *numbering = system->matrix->numbering;
  const double *value = system->matrix->stiffness + 9 * n->pair;
  const double *left = frame_at(numbering, i), *right = frame_at(numbering, n->node);
  double k[9];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      k[3 * r + c] = n->turned ? value[3 * c + r] : value[3 * r + c];
  if (right) {
    double turned[9];
    for (int r = 0; r < 3; r++)
      into_frame(right, k + 3 * r, turned + 3 * r);
    memcpy(k, turned, sizeof k);
  }
  if (left) {
    double turned[9];
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        turned[3 * r + c] =
            left[3 * r] * k[c] + left[3 * r + 1] * k[3 + c] + left[3 * r + 2] * k[6 + c];
    memcpy(k, turned, sizeof k);
  }
  const uint8_t *row = numbering->state + 3 * (int64_t)i;
  const uint8_t *column = numbering->state + 3 * (int64_t)n->node;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      bool diagonal = n->node == i && r == c;
      bool keep = diagonal || (row[r] != BW_HELD && column[c] != BW_HELD);
      block[3 * r + c] = keep ? k[3 * r + c] : 0;
    }
}

static void mass_block(const bwd_system *system, int32_t i, const neighbour *n, double *block) {
  const bw_numbering *numbering = system->matrix->numbering;
  double m = system->matrix->mass[n->pair];
  const uint8_t *row = numbering->state + 3 * (int64_t)i;
  const uint8_t *column = numbering->state + 3 * (int64_t)n->node;
  const double *left = frame_at(numbering, i), *right = frame_at(numbering, n->node);
  static const double global[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  left = left ? left : global;
  right = right ? right : global;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      bool keep = row[r] != BW_HELD && column[c] != BW_HELD;
      double value = keep ? m * (left == right ? r == c : bw_dot(left + 3 * r, right + 3 * c)) : 0;
      if (system->mass_width == 9)
        block[3 * r + c] = value;
      else if (r == c)
        block[r] = value;
    }
}

/* Rows from `next` on, up to `end`, as many as fit. */
static void pack(const bwd_system *system, const int32_t *node_at, int32_t *next, int32_t end,
                 int64_t capacity, neighbour *list, piece *p) {
  p->rows = p->blocks = 0;
  for (; *next < end; (*next)++) {
    int32_t node = node_at[*next];
    const bw_graph *graph = system->matrix->graph;
    int64_t expected = graph->start[node + 1] - graph->start[node] + graph->upper_start[node + 1] -
                       graph->upper_start[node];
    if (p->blocks + expected > capacity)
      return;
    int32_t count = row_neighbours(system, node, list);
    double *k = p->stiffness + 9 * (int64_t)p->blocks;
    for (int32_t n = 0; n < count; n++) {
      double block[9];
      stiffness_block(system, node, &list[n], block);
      for (int r = 0; r < 3; r++)
        memcpy(k + (int64_t)r * 3 * count + 3 * n, block + 3 * r, 3 * sizeof *k);
      p->column[p->blocks + n] = list[n].place;
      if (system->mass_width)
        mass_block(system, node, &list[n], p->mass + system->mass_width * ((int64_t)p->blocks + n));
    }
    p->length[p->rows++] = count;
    p->blocks += count;
  }
}

static bw_status insert_mass(bw_context *context, bwd_system *system, int32_t row, int32_t count,
                             const int32_t *column, const double *mass, PetscInt *at,
                             double *value) {
  bw_status status = BW_OK;
  if (system->mass_width == 9) {
    for (int32_t n = 0; n < count; n++)
      for (int r = 0; r < 3; r++)
        memcpy(value + (int64_t)r * 3 * count + 3 * n, mass + 9 * (int64_t)n + 3 * r,
               3 * sizeof *value);
    BWD_TRY(MatSetValuesBlocked(system->M, 1, &row, count, column, value, INSERT_VALUES));
    return status;
  }
  for (int c = 0; c < 3; c++) {
    PetscInt one = 3 * row + c;
    for (int32_t n = 0; n < count; n++) {
      at[n] = 3 * column[n] + c;
      value[n] = mass[3 * (int64_t)n + c];
    }
    BWD_TRY(MatSetValues(system->M, 1, &one, count, at, value, INSERT_VALUES));
  }
done:
  return status;
}

static bw_status insert(bw_context *context, bwd_system *system, const piece *p, int32_t row,
                        int32_t most, PetscInt *at, double *value) {
  bw_status status = BW_OK;
  int64_t block = 0;
  for (int32_t i = 0; i < p->rows; i++, row++) {
    int32_t count = p->length[i];
    if (count > most)
      return bw_fail(context, BW_INTERNAL, "a row of %d blocks came; at most %d", count, most);
    BWD_TRY(MatSetValuesBlocked(system->K, 1, &row, count, p->column + block,
                                p->stiffness + 9 * block, INSERT_VALUES));
    if (system->mass_width)
      BW_TRY(insert_mass(context, system, row, count, p->column + block,
                         p->mass + system->mass_width * block, at, value));
    block += count;
  }
done:
  return status;
}

/* All rows: rank 0 packs, sends and inserts its own; the others receive and insert. A rank that
 * fails goes on receiving, so that rank 0 is not stopped in a send. */
static bw_status rows(bw_context *context, bwd_system *system, int32_t most) {
  bw_status status = BW_OK;
  int64_t capacity = most > PIECE_BLOCKS ? most : PIECE_BLOCKS;
  size_t bytes = piece_bytes(system, capacity);
  char *buffer = BW_NEW(context, char, bytes);
  PetscInt *at = BW_NEW(context, PetscInt, most);
  double *value = BW_NEW(context, double, 9 * (int64_t)most);
  neighbour *list = NULL;
  int32_t *node_at = NULL;
  piece p = {0};
  if (!buffer || !at || !value)
    status = BW_MEMORY;
  if (system->rank == 0 && status == BW_OK) {
    list = BW_NEW(context, neighbour, most);
    node_at = BW_NEW(context, int32_t, system->nodes);
    if (!list || !node_at)
      status = BW_MEMORY;
  }
  BW_TRY(bwd_agree(context, status)); /* from here on every rank has room */
  lay_out(system, buffer, capacity, &p);
  int32_t *head = p.length - 2;
  if (system->rank == 0) {
    for (int32_t i = 0; i < system->nodes; i++)
      node_at[system->place[i]] = i;
    for (int r = 0; r < system->ranks; r++) {
      int32_t next = system->start[r], end = system->start[r + 1];
      while (next < end) {
        int32_t first = next;
        pack(system, node_at, &next, end, capacity, list, &p);
        head[0] = p.rows;
        head[1] = p.blocks;
        if (r > 0)
          MPI_Send(buffer, (int)bytes, MPI_BYTE, r, ROW_TAG, bwd_comm());
        else if (status == BW_OK)
          status = insert(context, system, &p, first, most, at, value);
      }
    }
  } else {
    int32_t row = system->first, end = row + system->local;
    while (row < end) {
      bwd_patience patience = {0};
      for (int there = 0;;) {
        MPI_Iprobe(0, ROW_TAG, bwd_comm(), &there, MPI_STATUS_IGNORE);
        if (there)
          break;
        bwd_pause(&patience);
      }
      MPI_Recv(buffer, (int)bytes, MPI_BYTE, 0, ROW_TAG, bwd_comm(), MPI_STATUS_IGNORE);
      p.rows = head[0];
      p.blocks = head[1];
      if (status == BW_OK)
        status = insert(context, system, &p, row, most, at, value);
      row += p.rows;
    }
  }
  status = bwd_agree(context, status);
done:
  bw_free(buffer);
  bw_free(at);
  bw_free(value);
  bw_free(list);
  bw_free(node_at);
  return status;
}

/* ---- sizes -------------------------------------------------------------------------------------
 */

/* Blocks of each row whose columns are on its own rank, and on others. */
static bw_status count_blocks(bw_context *context, bwd_system *system, int32_t **own,
                              int32_t **other, int32_t *most) {
  const bw_graph *graph = system->matrix->graph;
  int32_t *a = *own = BW_NEW0(context, int32_t, system->nodes);
  int32_t *b = *other = BW_NEW0(context, int32_t, system->nodes);
  int32_t *rank_of = BW_NEW(context, int32_t, system->nodes); /* by place */
  if (!a || !b || !rank_of) {
    bw_free(rank_of);
    return BW_MEMORY;
  }
  for (int r = 0; r < system->ranks; r++)
    for (int32_t i = system->start[r]; i < system->start[r + 1]; i++)
      rank_of[i] = r;
  for (int32_t i = 0; i < system->nodes; i++) {
    int32_t row = system->place[i];
    for (int64_t k = graph->start[i]; k < graph->start[i + 1]; k++) {
      int32_t column = system->place[graph->column[k]];
      int32_t *count = rank_of[row] == rank_of[column] ? a : b;
      count[row]++;
      if (column != row)
        count[column]++;
    }
  }
  *most = 0;
  for (int32_t i = 0; i < system->nodes; i++)
    *most = a[i] + b[i] > *most ? a[i] + b[i] : *most;
  bw_free(rank_of);
  return BW_OK;
}

static bw_status create_matrix(bw_context *context, bwd_system *system, const int32_t *own,
                               const int32_t *other, int width, Mat *matrix) {
  bw_status status = BW_OK;
  PetscInt local = 3 * system->local, size = 3 * system->nodes;
  PetscInt *diagonal = BW_NEW(context, PetscInt, local);
  PetscInt *off = BW_NEW(context, PetscInt, local);
  if (!diagonal || !off)
    status = BW_MEMORY;
  else
    for (PetscInt i = 0; i < local; i++) {
      diagonal[i] = width * own[i / 3];
      off[i] = width * other[i / 3];
    }
  BW_TRY(bwd_agree(context, status));
  BWD_TRY(MatCreate(PETSC_COMM_WORLD, matrix));
  BWD_TRY(MatSetSizes(*matrix, local, local, size, size));
  BWD_TRY(MatSetBlockSize(*matrix, 3));
  BWD_TRY(MatSetType(*matrix, MATAIJ));
  if (system->ranks == 1)
    BWD_TRY(MatSeqAIJSetPreallocation(*matrix, 0, diagonal));
  else
    BWD_TRY(MatMPIAIJSetPreallocation(*matrix, 0, diagonal, 0, off));
  BWD_TRY(MatSetOption(*matrix, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_TRUE));
  BWD_TRY(MatSetOption(*matrix, MAT_SYMMETRIC, PETSC_TRUE));
done:
  bw_free(diagonal);
  bw_free(off);
  return status;
}

/* What every rank must know before the rows come. */
typedef struct plan {
  int32_t nodes, motions, most;
  int mass_width, method, iterations;
  double rtol;
} plan;

static bw_status make_plan(bw_context *context, bwd_system *system, int32_t **own, int32_t **other,
                           plan *p) {
  bw_status status = BW_OK;
  const bw_outside_matrix *m = system->matrix;
  system->nodes = m->graph->node_count;
  if (system->nodes > INT32_MAX / 3 - 1)
    return bw_fail(context, BW_LIMIT, "%d nodes are more than PETSc's 32-bit numbers take",
                   (int)system->nodes);
  system->place = BW_NEW(context, int32_t, system->nodes);
  system->field = BW_NEW(context, double, 3 * (int64_t)system->nodes);
  system->counts = BW_NEW(context, int, system->ranks);
  system->where = BW_NEW(context, int, system->ranks);
  if (!system->place || !system->field || !system->counts || !system->where)
    return BW_MEMORY;
  BW_TRY(bwd_partition(context, m->graph, system->ranks, system->place, system->start));
  BW_TRY(count_blocks(context, system, own, other, &p->most));
  for (int r = 0; r < system->ranks; r++) {
    int64_t entries = 0;
    for (int32_t i = system->start[r]; i < system->start[r + 1]; i++)
      entries += 9 * ((int64_t)(*own)[i] + (*other)[i]);
    if (entries > INT32_MAX)
      return bw_fail(context, BW_LIMIT,
                     "rank %d would have %lld entries of the matrix; PETSc's 32-bit numbers count "
                     "to %d. Use more ranks",
                     r, (long long)entries, INT32_MAX);
    system->counts[r] = 3 * (system->start[r + 1] - system->start[r]);
    system->where[r] = 3 * system->start[r];
  }
  p->nodes = system->nodes;
  p->motions = m->numbering->motion_count;
  p->mass_width = !m->mass ? 0 : m->numbering->frame_count > 0 ? 9 : 3;
  p->method = system->options.method;
  p->iterations = system->options.iterations;
  p->rtol = system->options.rtol;
done:
  return status;
}

/* The rigid motions R and W R of rank 0's numbering. */
static bw_status share_motions(bw_context *context, bwd_system *system) {
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
      const bw_numbering *numbering = system->matrix->numbering;
      one[m] = 1;
      memset(field, 0, 3 * (size_t)system->nodes * sizeof *field);
      bw_motions_add(numbering, one, field);
    }
    BW_TRY(bwd_scatter(context, system, field, system->motion[m]));
    if (system->rank == 0) {
      bw_motions_weighted(system->matrix->numbering, one, field);
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
static bw_status share_mask(bw_context *context, bwd_system *system) {
  if (system->rank == 0) {
    const bw_numbering *numbering = system->matrix->numbering;
    for (int64_t i = 0; i < system->nodes; i++)
      for (int c = 0; c < 3; c++) {
        uint8_t state = numbering->state[3 * i + c];
        bool solved = state == BW_UNKNOWN || (state == BW_PINNED && !system->direct);
        system->field[3 * (int64_t)system->place[i] + c] = solved;
      }
  }
  return spread(context, system, system->mask);
}

bw_status bwd_share(bw_context *context, bwd_system *system) {
  bw_status status = BW_OK;
  int32_t *own = NULL, *other = NULL, *own_all = NULL, *other_all = NULL;
  plan p = {0};
  double begin = bw_seconds();
  system->start = BW_NEW0(context, int32_t, (int64_t)system->ranks + 1);
  if (!system->start)
    status = BW_MEMORY;
  else if (system->rank == 0)
    status = make_plan(context, system, &own_all, &other_all, &p);
  BW_TRY(bwd_agree(context, status));
  MPI_Bcast(&p, sizeof p, MPI_BYTE, 0, bwd_comm());
  MPI_Bcast(system->start, system->ranks + 1, MPI_INT, 0, bwd_comm());
  system->nodes = p.nodes;
  system->motions = p.motions;
  system->mass_width = p.mass_width;
  system->options =
      (bw_outside_options){.method = p.method, .iterations = p.iterations, .rtol = p.rtol};
  system->direct = p.method == BW_OUTSIDE_CHOLESKY;
  system->first = system->start[system->rank];
  system->local = system->start[system->rank + 1] - system->first;

  own = BW_NEW(context, int32_t, system->local);
  other = BW_NEW(context, int32_t, system->local);
  BW_TRY(bwd_agree(context, own && other ? BW_OK : BW_MEMORY));
  int *nodes_of = system->counts, *begin_of = system->where; /* a third of what they hold */
  for (int r = 0; system->rank == 0 && r < system->ranks; r++) {
    nodes_of[r] /= 3;
    begin_of[r] /= 3;
  }
  MPI_Scatterv(own_all, nodes_of, begin_of, MPI_INT, own, system->local, MPI_INT, 0, bwd_comm());
  MPI_Scatterv(other_all, nodes_of, begin_of, MPI_INT, other, system->local, MPI_INT, 0,
               bwd_comm());
  for (int r = 0; system->rank == 0 && r < system->ranks; r++) {
    nodes_of[r] *= 3;
    begin_of[r] *= 3;
  }
  BW_TRY(create_matrix(context, system, own, other, 3, &system->K));
  if (system->mass_width)
    BW_TRY(create_matrix(context, system, own, other, system->mass_width == 9 ? 3 : 1, &system->M));
  BW_TRY(rows(context, system, p.most));
  BWD_TRY(MatAssemblyBegin(system->K, MAT_FINAL_ASSEMBLY));
  BWD_TRY(MatAssemblyEnd(system->K, MAT_FINAL_ASSEMBLY));
  if (system->M) {
    BWD_TRY(MatAssemblyBegin(system->M, MAT_FINAL_ASSEMBLY));
    BWD_TRY(MatAssemblyEnd(system->M, MAT_FINAL_ASSEMBLY));
  }
  BWD_TRY(MatCreateVecs(system->K, &system->displacement, &system->force));
  BWD_TRY(VecDuplicate(system->force, &system->mask));
  BW_TRY(share_mask(context, system));
  BW_TRY(share_motions(context, system));
  system->seconds_send = bw_seconds() - begin;
done:
  bw_free(own);
  bw_free(other);
  bw_free(own_all);
  bw_free(other_all);
  return status;
}
