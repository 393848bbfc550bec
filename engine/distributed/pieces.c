/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Assembly a piece at a time: the rows of a rank are cut into runs, and the engine assembles the
 * elements around each run as a mesh of its own. Elements between two runs are assembled for both,
 * a tenth to a quarter of all; for this the block sparsity pattern and its lists of contributions
 * never exist for more than a piece. */
#include <string.h>

#include "distributed/internal.h"

enum { ROWS = 8192 }; /* of a piece: some 20 MB of work memory for tet10 */

typedef struct cut {
  const bwd_local_mesh *local;
  int32_t count;
  int64_t *first;   /* count + 1: of the elements of each piece in `element` */
  int32_t *element; /* ascending in each piece */
  int32_t *number;  /* local nodes: in the piece in work, or -1 */
} cut;

static void clear_cut(cut *c) {
  bw_free(c->first);
  bw_free(c->element);
  bw_free(c->number);
}

static bw_status make_cut(bw_context *context, const bwd_local_mesh *local, cut *c) {
  *c = (cut){.local = local, .count = (local->count.owned + ROWS - 1) / ROWS};
  c->number = BW_NEW(context, int32_t, local->count.nodes);
  if (!c->number)
    return BW_MEMORY;
  for (int32_t i = 0; i < local->count.nodes; i++)
    c->number[i] = i < local->count.owned ? i / ROWS : -1;
  bw_status status =
      bwd_group_elements(context, local->count.elements, local->count.nodes_per_element,
                         local->element, c->number, c->count, &c->first, &c->element);
  memset(c->number, -1, (size_t)local->count.nodes * sizeof *c->number);
  return status;
}

/* Nodes and elements of the piece, as a mesh. */
static bw_status make_mesh(bw_context *context, cut *c, int32_t p, bwd_piece *piece) {
  const bwd_local_mesh *local = c->local;
  const int32_t *list = c->element + c->first[p];
  int64_t elements = c->first[p + 1] - c->first[p];
  int width = local->count.nodes_per_element;
  int32_t nodes = 0;
  int32_t *element = BW_NEW(context, int32_t, elements * width);
  double *node = NULL;
  bw_status status = BW_MEMORY;
  piece->node = BW_NEW(context, int32_t, piece->rows + elements * width);
  if (element && piece->node) {
    for (int32_t i = 0; i < piece->rows; i++) {
      piece->node[nodes] = piece->first + i;
      c->number[piece->first + i] = nodes++;
    }
    for (int64_t e = 0; e < elements; e++)
      for (int a = 0; a < width; a++) {
        int32_t i = local->element[(int64_t)list[e] * width + a];
        if (c->number[i] < 0) {
          piece->node[nodes] = i;
          c->number[i] = nodes++;
        }
        element[e * width + a] = c->number[i];
      }
    node = BW_NEW(context, double, 3 * (int64_t)nodes);
    for (int64_t i = 0; i < nodes; i++) {
      if (node)
        memcpy(node + 3 * i, local->node + 3 * (int64_t)piece->node[i], 3 * sizeof *node);
      c->number[piece->node[i]] = -1;
    }
    if (node)
      status = bw_mesh_adopt(context, local->count.order, nodes, node, elements, element, NULL,
                             &piece->mesh);
  }
  if (status != BW_OK) {
    bw_free(node);
    bw_free(element);
  }
  return status;
}

static void clear_piece(bwd_piece *piece) {
  bw_free(piece->node);
  bw_release(piece->mesh);
  bw_release(piece->pattern);
  bw_free(piece->stiffness);
  bw_free(piece->mass);
}

static bw_status make_piece(bw_context *context, cut *c, int32_t p, bool mass, bwd_piece *piece) {
  bw_status status = BW_OK;
  const bwd_local_mesh *local = c->local;
  bw_material *material = NULL;
  int32_t rest = local->count.owned - p * ROWS;
  *piece = (bwd_piece){.local = local, .first = p * ROWS, .rows = rest < ROWS ? rest : ROWS};
  BW_TRY(make_mesh(context, c, p, piece));
  BW_TRY(bw_material_carried(context, local->material, (int32_t)(c->first[p + 1] - c->first[p]),
                             c->element + c->first[p], &material));
  BW_TRY(bw_block_pattern_create(context, piece->mesh, &piece->pattern));
  int64_t blocks = piece->pattern->block_count;
  piece->stiffness = BW_NEW(context, double, 9 * blocks);
  if (mass)
    piece->mass = BW_NEW(context, double, blocks);
  if (!piece->stiffness || (mass && !piece->mass)) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bw_stiffness(context, piece->pattern, piece->mesh, material, piece->stiffness));
  if (mass)
    BW_TRY(bw_mass(context, piece->pattern, piece->mesh, material, piece->mass));
done:
  bw_release(material);
  return status;
}

bw_status bwd_for_pieces(bw_context *context, const bwd_local_mesh *local, bool mass,
                         bw_status (*visit)(bw_context *context, void *data,
                                            const bwd_piece *piece),
                         void *data) {
  cut c;
  bw_status status = make_cut(context, local, &c);
  for (int32_t p = 0; p < c.count && status == BW_OK; p++) {
    bwd_piece piece = {0};
    status = make_piece(context, &c, p, mass, &piece);
    if (status == BW_OK)
      status = visit(context, data, &piece);
    clear_piece(&piece);
    if (status == BW_OK)
      status = bw_check_cancel(context);
  }
  clear_cut(&c);
  return status;
}
