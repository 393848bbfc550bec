/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The coarse space of linear elements (coarse.h). Topology is kept; matrix and factor are those of
 * the shape last followed. */
#include "linear/coarse.h"

#include <string.h>

#include "base/cost.h"
#include "base/dense.h"
#include "linear/amg.h"
#include "linear/rigid_space.h"
#include "model/internal.h"

/* A solution by the factor, and by multigrid with its setup, are compared for so many of them. */
#define SOLUTIONS 24.0
/* The same solution with multigrid in place of the factor takes more iterations (blocks: 25 for 22,
 * docs/theory/preconditioners.md), each of which costs several of multigrid's. */
#define MORE_ITERATIONS 1.15
#define FINE_OVER_COARSE 14.0
/* Bytes for a block of two corners, of a cycle and of the setup: fitted, so that blocks, bars and
 * plates at the border take the same time either way. */
#define CYCLE_BYTES 250.0
#define SETUP_BYTES 8000.0

struct bwi_coarse {
  bw_object object;
  const bw_mesh *fine; /* retained: any of its topology */
  int32_t count;       /* corner nodes */
  int32_t *corner;     /* count: of the fine mesh, ascending */
  int32_t *parent;     /* fine nodes x 2: the corners between which a node lies; twice itself */
  bw_mesh *mesh;       /* linear, on the corners, of the shape last followed */
  bw_block_pattern *pattern;
  double *stiffness;
  bw_dof_map dof_map;     /* of the corners: what factor, multigrid and fields read of one */
  int32_t *unknown;       /* count x 3: 0 where there is one, else -1 */
  bwi_rigid_space *rigid; /* of the corners; NULL where the supports leave no mode free */
  double flops, entries;  /* of the factor; 0: not counted yet */
  int32_t unknowns;
  bool iterative; /* by a cycle of multigrid, which takes the place of the factor */
  bwi_amg *amg;   /* or NULL */
  bwi_symbolic *symbolic;
  bwi_elimination_reach *reach; /* the whole of it: refactorised in place */
  bwi_factor *factor;
};

static void coarse_destroy(void *object) {
  bwi_coarse *c = object;
  bw_release(c->fine);
  bw_release(c->mesh);
  bw_release(c->pattern);
  bw_release(c->factor);
  bw_release(c->reach);
  bw_release(c->symbolic);
  bw_release(c->rigid);
  bw_release(c->amg);
  bw_free(c->corner);
  bw_free(c->parent);
  bw_free(c->stiffness);
  bw_free(c->dof_map.frame_of);
  bw_free(c->dof_map.frame);
  bw_free(c->dof_map.state);
  bw_free(c->dof_map.rigid_mode);
  bw_free(c->dof_map.rigid_mode_start);
  bw_free(c->unknown);
  bw_free(c);
}

/* The fine mesh is its user's. */
static size_t coarse_bytes(const void *object) {
  const bwi_coarse *c = object;
  size_t blocks = c->pattern ? (size_t)c->pattern->block_count : 0;
  return sizeof *c + (size_t)c->count * (9 * sizeof(double) + 5 * sizeof(int32_t) + 3) +
         2 * (size_t)c->fine->node_count * sizeof(int32_t) +
         (c->stiffness ? blocks * 9 * sizeof(double) : 0) + bw_bytes(c->amg) + bw_bytes(c->mesh) +
         bw_bytes(c->pattern) + bw_bytes(c->symbolic) + bw_bytes(c->reach) + bw_bytes(c->factor) +
         bw_bytes(c->rigid);
}

/* The DOF map is a part of the coarse space: nothing is its own. */
static void part_destroy(void *object) {
  (void)object;
}

static size_t part_bytes(const void *object) {
  (void)object;
  return 0;
}

static const bw_kind part_kind = {"DOF map of corners", part_destroy, part_bytes};

static const bw_kind coarse_kind = {"coarse space", coarse_destroy, coarse_bytes};

/* Corners in ascending order, and between which of them every node lies. */
static void find_parents(bwi_coarse *c) {
  const bw_mesh *mesh = c->fine;
  for (int64_t i = 0; i < 2 * (int64_t)mesh->node_count; i++)
    c->parent[i] = -1;
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 4; a++)
      c->parent[2 * (int64_t)mesh->element[10 * e + a]] = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (c->parent[2 * (int64_t)i] == 0) {
      c->corner[c->count] = i;
      c->parent[2 * (int64_t)i] = c->parent[2 * (int64_t)i + 1] = c->count++;
    }
  for (int64_t e = 0; e < mesh->element_count; e++)
    for (int a = 0; a < 6; a++) {
      const int32_t *node = mesh->element + 10 * e;
      for (int side = 0; side < 2; side++)
        c->parent[2 * (int64_t)node[4 + a] + side] =
            c->parent[2 * (int64_t)node[bw_tet_edge[a][side]]];
    }
}

static bw_status make_mesh(bw_context *context, bwi_coarse *c) {
  bw_status status = BW_OK;
  const bw_mesh *fine = c->fine;
  double *node = BW_NEW(context, double, 3 * (size_t)c->count);
  int32_t *element = BW_NEW(context, int32_t, 4 * (size_t)fine->element_count);
  BW_TRY_MEMORY(node && element);
  for (int32_t k = 0; k < c->count; k++)
    memcpy(node + 3 * (int64_t)k, fine->node + 3 * (int64_t)c->corner[k], 3 * sizeof *node);
  for (int64_t e = 0; e < fine->element_count; e++)
    for (int a = 0; a < 4; a++)
      element[4 * e + a] = c->parent[2 * (int64_t)fine->element[10 * e + a]];
  BW_TRY(bw_mesh_copy(context, 1, c->count, node, fine->element_count, element, NULL, &c->mesh));
done:
  bw_free(node);
  bw_free(element);
  return status;
}

bool bwi_coarse_fits(const bw_mesh *mesh) {
  return mesh->order == 2;
}

bw_status bwi_coarse_create(bw_context *context, const bw_mesh *mesh, bwi_coarse **out) {
  bw_status status = BW_OK;
  bwi_coarse *c = BW_NEW0(context, bwi_coarse, 1);
  if (!c)
    return BW_MEMORY;
  bw_object_init(c, &coarse_kind);
  bw_object_init(&c->dof_map, &part_kind);
  c->fine = bw_retain(mesh);
  c->corner = BW_NEW(context, int32_t, mesh->node_count);
  c->parent = BW_NEW(context, int32_t, 2 * (size_t)mesh->node_count);
  BW_TRY_MEMORY(c->corner && c->parent);
  find_parents(c);
  BW_TRY(make_mesh(context, c));
  BW_TRY(bw_block_pattern_create(context, c->mesh, &c->pattern));
  c->dof_map.frame_of = BW_NEW(context, int32_t, c->count);
  c->dof_map.state = BW_NEW(context, uint8_t, 3 * (size_t)c->count);
  c->dof_map.frame = BW_NEW(context, double, 9 * (size_t)c->count);
  c->unknown = BW_NEW(context, int32_t, 3 * (size_t)c->count);
  if (!c->dof_map.state || !c->dof_map.frame_of || !c->dof_map.frame || !c->unknown)
    status = BW_MEMORY;
done:
  if (status == BW_OK)
    *out = c;
  else
    bw_release(c);
  return status;
}

/* A direction of a support at a mid-edge node that is this far from those of its corners blocks
 * them: the sine of the angle. Less is the curvature of a support. */
#define OBLIQUE 0.3

/* Whether the supports of node a leave free nothing that those of b prescribe. */
static bool constrained_as(const bw_dof_map *dof_map, int32_t a, int32_t b) {
  for (int k = 0; k < 3; k++) {
    double prescribed[3], left = 0;
    if (dof_map->state[3 * (int64_t)b + k] != BW_DOF_PRESCRIBED)
      continue;
    bwi_direction_of(dof_map, b, k, prescribed);
    for (int f = 0; f < 3; f++) {
      double free[3];
      bwi_direction_of(dof_map, a, f, free);
      double along = bw_dot(prescribed, free);
      if (dof_map->state[3 * (int64_t)a + f] != BW_DOF_PRESCRIBED)
        left += along * along;
    }
    if (left > OBLIQUE * OBLIQUE)
      return false;
  }
  return true;
}

static bool has_modes(const bw_dof_map *dof_map, int64_t node) {
  const int32_t *start = dof_map->rigid_mode_start + dof_map->mesh->component[node];
  return start[1] > start[0];
}

void bwi_coarse_supports(const bwi_coarse *c, const bw_dof_map *dof_map, bw_dof_map *corners,
                         int32_t *unknown) {
  for (int64_t k = 0; k < c->count; k++) {
    int64_t i = c->corner[k];
    int32_t row = dof_map->frame_of[i];
    corners->frame_of[k] = row < 0 ? -1 : (int32_t)k;
    if (row >= 0)
      memcpy(corners->frame + 9 * k, dof_map->frame + 9 * (int64_t)row, 9 * sizeof(double));
    for (int d = 0; d < 3; d++)
      unknown[3 * k + d] = dof_map->state[3 * i + d] == BW_DOF_PRESCRIBED ? -1 : 0;
  }
  corners->frame_count = c->count;
}

/* Unknowns and directions of the corners. A corner that would move where a mid-edge node may not is
 * fixed; but not in bodies with rigid-body modes, which the space has to contain. */
static void number_corners(bwi_coarse *c, const bw_dof_map *dof_map) {
  const bw_mesh *fine = c->fine;
  bwi_coarse_supports(c, dof_map, &c->dof_map, c->unknown);
  for (int64_t i = 0; i < fine->node_count; i++)
    for (int side = 0; side < 2 && !has_modes(dof_map, i); side++) {
      int32_t k = c->parent[2 * i + side];
      if (!constrained_as(dof_map, c->corner[k], i))
        for (int d = 0; d < 3; d++)
          c->unknown[3 * (int64_t)k + d] = -1;
    }
  for (int64_t k = 0; k < 3 * (int64_t)c->count; k++)
    c->dof_map.state[k] = c->unknown[k] < 0 ? BW_DOF_PRESCRIBED : BW_DOF_UNKNOWN;
}

/* Rigid-body modes by the bodies of the corners' mesh, whose numbers are others. */
static bw_status number_modes(bw_context *context, bwi_coarse *c, const bw_dof_map *dof_map) {
  bw_dof_map *own = &c->dof_map;
  int32_t bodies = c->mesh->component_count, count = 0;
  bw_free(own->rigid_mode);
  bw_free(own->rigid_mode_start);
  own->rigid_mode = BW_NEW0(context, bw_rigid_mode, dof_map->rigid_mode_count + 1);
  own->rigid_mode_start = BW_NEW0(context, int32_t, bodies + 1);
  own->rigid_mode_count = 0;
  if (!own->rigid_mode || !own->rigid_mode_start)
    return BW_MEMORY;
  for (int32_t k = 0, body = 0; k < c->count && body < bodies; k++) {
    if (c->mesh->component[k] != body) /* bodies come in the order of their first corners */
      continue;
    int32_t fine = c->fine->component[c->corner[k]];
    for (int32_t m = dof_map->rigid_mode_start[fine]; m < dof_map->rigid_mode_start[fine + 1];
         m++) {
      own->rigid_mode[count] = dof_map->rigid_mode[m];
      own->rigid_mode[count++].component = body;
    }
    own->rigid_mode_start[++body] = count;
  }
  own->rigid_mode_count = count;
  return BW_OK;
}

bw_status bwi_coarse_constrain(bw_context *context, const bwi_coarse *c, const bw_dof_map *dof_map,
                               const bwi_rigid_space *former, int32_t *unknown,
                               bwi_rigid_space **rigid) {
  bw_status status = BW_OK;
  int32_t *row_of = NULL;
  *rigid = NULL;
  if (dof_map->rigid_mode_count == 0)
    return BW_OK;
  row_of = BW_NEW(context, int32_t, c->fine->node_count);
  if (!row_of)
    return BW_MEMORY;
  for (int64_t i = 0; i < c->fine->node_count; i++)
    row_of[i] = c->parent[2 * i] == c->parent[2 * i + 1] ? c->parent[2 * i] : -1;
  BW_TRY(bwi_rigid_space_create(context, dof_map, row_of, rigid));
  /* where there are none, the factor will find A singular */
  bwi_rigid_space_constrain(*rigid, former, unknown);
done:
  bw_free(row_of);
  return status;
}

/* Whether one solution with cycles of multigrid costs less than with a factor, by count. */
static bool multigrid_is_better(const bwi_coarse *c) {
  double blocks = (double)c->pattern->block_count;
  double factor = c->flops / bwi_cost_flops_per_second(32) +
                  SOLUTIONS * 2 * sizeof(float) * c->entries / BWI_COST_BYTES_PER_SECOND;
  double cycle = CYCLE_BYTES * blocks / BWI_COST_BYTES_PER_SECOND;
  double amg = SETUP_BYTES * blocks / BWI_COST_BYTES_PER_SECOND +
               SOLUTIONS * MORE_ITERATIONS * cycle +
               SOLUTIONS * (MORE_ITERATIONS - 1) * FINE_OVER_COARSE * cycle;
  return amg < factor;
}

static void release_factor(bwi_coarse *c) {
  bw_release(c->factor);
  bw_release(c->reach);
  bw_release(c->symbolic);
  c->factor = NULL;
  c->reach = NULL;
  c->symbolic = NULL;
}

static bw_status update_symbolic(bw_context *context, bwi_coarse *c) {
  bw_status status = BW_OK;
  bwi_order *order = NULL;
  uint8_t *take = NULL;
  if (c->iterative || (c->symbolic && bwi_symbolic_fits(c->symbolic, 3, c->unknown)))
    return BW_OK;
  release_factor(c);
  take = BW_NEW0(context, uint8_t, c->count);
  if (!take)
    return BW_MEMORY;
  for (int64_t k = 0; k < c->count; k++)
    take[k] = c->unknown[3 * k] >= 0 || c->unknown[3 * k + 1] >= 0 || c->unknown[3 * k + 2] >= 0;
  BW_TRY(bwi_order_create(context, c->pattern, take, &order));
  BW_TRY(bwi_symbolic_create(context, order, 3, c->unknown, &c->symbolic));
  c->flops = c->symbolic->flops;
  c->entries = (double)c->symbolic->panel[c->symbolic->order->super_count];
  c->unknowns = c->symbolic->unknowns;
done:
  bw_free(take);
  bw_release(order);
  return status;
}

bw_status bwi_coarse_count(bw_context *context, bwi_coarse *c, const bw_dof_map *dof_map) {
  bw_status status = BW_OK;
  bool first = c->flops == 0;
  bwi_rigid_space *former = c->rigid;
  c->rigid = NULL;
  number_corners(c, dof_map);
  BW_TRY(number_modes(context, c, dof_map));
  BW_TRY(bwi_coarse_constrain(context, c, dof_map, former, c->unknown, &c->rigid));
  BW_TRY(update_symbolic(context, c));
  if (first && multigrid_is_better(c)) {
    c->iterative = true;
    release_factor(c);
  }
done:
  bw_release(former);
  return status;
}

static bw_status factor_in(bw_context *context, bwi_coarse *c, const bwi_kernels *kernels) {
  const bwi_matrix matrix = {
      .pattern = c->pattern, .stiffness = c->stiffness, .dof_map = &c->dof_map};
  bw_status status = BW_OK;
  if (c->factor && c->factor->kernels == kernels)
    status = bwi_factor_update(context, c->factor, &matrix, NULL, NULL, NULL);
  else {
    bw_release(c->factor);
    c->factor = NULL;
    if (!c->reach)
      BW_TRY(bwi_elimination_reach_create_whole(context, c->symbolic, &c->reach));
    status =
        bwi_factor_create_in(context, c->symbolic, &matrix, c->reach, kernels, &c->factor, NULL);
  }
done:
  if (status != BW_OK) {
    bw_release(c->factor);
    c->factor = NULL;
  }
  return status;
}

/* Part of a solution that its first refinement may change. */
#define MAX_CHANGE 0.1

bw_status bwi_coarse_check_digits(bw_context *context, const bw_block_pattern *pattern,
                                  const double *stiffness, bwi_coarse_solver *solve,
                                  const void *data, const double *load, bool *enough) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)pattern->node_count;
  double *x = BW_NEW(context, double, size), *y = BW_NEW(context, double, size);
  BW_TRY_MEMORY(x && y);
  memcpy(x, load, (size_t)size * sizeof *x);
  BW_TRY(solve(context, data, 1, x));
  BW_TRY(bw_block_multiply(context, pattern, stiffness, 9, 3, 1, x, y));
  for (int64_t i = 0; i < size; i++)
    y[i] = load[i] - y[i];
  BW_TRY(solve(context, data, 1, y));
  *enough = bwi_dot(size, y, y) <= MAX_CHANGE * MAX_CHANGE * bwi_dot(size, x, x);
done:
  bw_free(x);
  bw_free(y);
  return status;
}

static bw_status solve_load(bw_context *context, const void *data, int64_t count, double *x) {
  return bwi_coarse_solve(context, data, count, x);
}

/* Of bodies that can move freely: slender ones lose digits, since isostatic constraints leave
 * little of what keeps a supported body in its place. */
static bw_status is_exact_enough(bw_context *context, const bwi_coarse *c, bool *enough) {
  int64_t size = 3 * (int64_t)c->count;
  double *load = BW_NEW(context, double, size);
  bw_random random;
  bw_random_seed(&random, 1);
  if (!load)
    return BW_MEMORY;
  for (int64_t i = 0; i < size; i++)
    load[i] = 2 * bw_random_uniform(&random) - 1;
  bw_status status =
      bwi_coarse_check_digits(context, c->pattern, c->stiffness, solve_load, c, load, enough);
  bw_free(load);
  return status;
}

/* In floats, which is as good for a preconditioner, unless they lack the digits. */
static bw_status update_factor(bw_context *context, bwi_coarse *c) {
  bw_status status = BW_OK;
  bool enough = !c->factor || c->factor->kernels->bits == 32;
  if (enough) {
    status = factor_in(context, c, &bwi_kernels_single);
    enough = status == BW_OK;
    if (status == BW_SINGULAR) {
      bw_clear_failure(context);
      status = BW_OK;
    }
    if (status == BW_OK && enough && c->rigid)
      BW_TRY(is_exact_enough(context, c, &enough));
  }
  if (status == BW_OK && !enough)
    status = factor_in(context, c, &bwi_kernels_double);
done:
  return status;
}

/* Multigrid, unless the matrix is not one for it. */
static bw_status update_amg(bw_context *context, bwi_coarse *c) {
  const bwi_matrix matrix = {
      .pattern = c->pattern, .stiffness = c->stiffness, .dof_map = &c->dof_map};
  bw_release(c->amg);
  c->amg = NULL;
  bw_status status = bwi_amg_create(context, &matrix, false, &c->amg);
  if (status == BW_OK) {
    bw_free(c->stiffness);
    c->stiffness = NULL;
  } else if (status == BW_SINGULAR || status == BW_LIMIT) {
    bw_clear_failure(context);
    c->iterative = false;
    status = update_symbolic(context, c);
  }
  return status;
}

bw_status bwi_coarse_follow(bw_context *context, bwi_coarse *c, const bw_model *model,
                            const bw_dof_map *dof_map, bool *usable) {
  bw_status status = BW_OK;
  bw_mesh *moved = NULL;
  double *node = NULL;
  *usable = false;
  node = BW_NEW(context, double, 3 * (size_t)c->count);
  if (!node)
    return BW_MEMORY;
  for (int64_t k = 0; k < c->count; k++)
    memcpy(node + 3 * k, model->mesh->node + 3 * (int64_t)c->corner[k], 3 * sizeof *node);
  BW_TRY(bw_mesh_moved(context, c->mesh, node, &moved));
  bw_release(c->mesh);
  c->dof_map.mesh = c->mesh = moved;
  BW_TRY(bwi_coarse_count(context, c, dof_map));
  if (!c->stiffness)
    c->stiffness = BW_NEW(context, double, 9 * c->pattern->block_count);
  BW_TRY_MEMORY(c->stiffness);
  BW_TRY(bw_stiffness(context, c->pattern, c->mesh, model->material, c->stiffness));
  if (c->iterative)
    BW_TRY(update_amg(context, c));
  if (!c->iterative)
    status = update_factor(context, c);
  *usable = status == BW_OK;
  if (status == BW_SINGULAR) {
    bw_clear_failure(context);
    status = BW_OK;
  }
done:
  bw_free(node);
  return status;
}

bw_status bwi_coarse_solve(bw_context *context, const bwi_coarse *c, int64_t count, double *x) {
  bw_status status = BW_OK;
  const bwi_field_layout plain = {3, 1, 3 * (int64_t)c->count};
  if (c->rigid)
    BW_TRY(bwi_rigid_space_project(context, c->rigid, &plain, (int)count, x));
  if (c->iterative)
    BW_TRY(bwi_amg_apply(context, c->amg, count, x, x));
  else
    BW_TRY(bwi_solve_fields(context, c->factor, &c->dof_map, count, x, x));
  if (c->rigid)
    BW_TRY(bwi_rigid_space_project(context, c->rigid, &plain, (int)count, x));
done:
  return status;
}

int32_t bwi_coarse_corners(const bwi_coarse *c) {
  return c->count;
}

const int32_t *bwi_coarse_nodes(const bwi_coarse *c) {
  return c->corner;
}

const int32_t *bwi_coarse_parents(const bwi_coarse *c) {
  return c->parent;
}

double bwi_coarse_bytes(const bwi_coarse *c) {
  if (c->amg)
    return bwi_amg_pass_bytes(c->amg);
  return c->factor ? 2 * (double)bwi_factor_bytes(c->factor) : 0;
}

double bwi_coarse_seconds(const bwi_coarse *c) {
  if (c->iterative)
    return SETUP_BYTES * (double)c->pattern->block_count / BWI_COST_BYTES_PER_SECOND;
  return c->flops / bwi_cost_flops_per_second(32);
}

double bwi_coarse_pass_bytes(const bwi_coarse *c) {
  return c->iterative ? CYCLE_BYTES * (double)c->pattern->block_count
                      : 2 * sizeof(float) * c->entries;
}

bool bwi_coarse_iterative(const bwi_coarse *c) {
  return c->iterative;
}

double bwi_coarse_flops(const bwi_coarse *c) {
  return c->flops;
}

double bwi_coarse_entries(const bwi_coarse *c) {
  return c->entries;
}

int32_t bwi_coarse_unknowns(const bwi_coarse *c) {
  return c->unknowns;
}
