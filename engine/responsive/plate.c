/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A plate on a mesh that follows an outline: its life and its matrices. */
#include <math.h>

#include "responsive/plate.h"

static void plate_destroy(void *object) {
  bw_plate *plate = object;
  struct bwi_plate *in = plate->inner;
  if (in) {
    bw_release(in->now);
    bw_free(in->origin);
    bwi_lagged_destroy(in->factor);
    bw_free(in);
  }
  bw_release(plate->material);
  bw_free(plate);
}

static size_t plate_bytes(const void *object) {
  const bw_plate *plate = object;
  const bw_plate_state *now = plate->inner->now;
  size_t blocks = (size_t)now->matrices->pattern->block_count;
  return sizeof *plate + blocks * 19 * sizeof(double) + bw_bytes(now);
}

static const bw_kind plate_kind = {"plate", plate_destroy, plate_bytes};

/* ---- matrices -------------------------------------------------------------------------------- */

typedef struct assembly {
  bw_context *context;
  const bw_plane_mesh *mesh;
  const struct bwi_plate *inner;
} assembly;

static void element_points(const bw_plane_mesh *mesh, int32_t element, double x[6][2]) {
  const int32_t *node = mesh->topology->element + 6 * (int64_t)element;
  for (int a = 0; a < 6; a++)
    for (int c = 0; c < 2; c++)
      x[a][c] = mesh->point[2 * (int64_t)node[a] + c];
}

static bw_status stiffness_of(void *data, int32_t element, double *matrix) {
  const assembly *a = data;
  double x[6][2];
  element_points(a->mesh, element, x);
  double jacobian = bwi_plate_stiffness(&a->inner->reference, &a->inner->law, x, matrix, NULL);
  if (jacobian > 0)
    return BW_OK;
  bw_status status = bw_fail(a->context, BW_GEOMETRY, "element %d near (%g, %g) m is inverted",
                             element + 1, x[0][0], x[0][1]);
  bw_detail_number(a->context, "element", element + 1);
  return status;
}

static bw_status mass_of(void *data, int32_t element, double *matrix) {
  const assembly *a = data;
  double x[6][2];
  element_points(a->mesh, element, x);
  bwi_plate_mass(&a->inner->reference, x, matrix);
  return BW_OK;
}

static double component_mass(const bwi_plate_law *law, int c) {
  return c == 0 ? law->mass : law->inertia;
}

bw_status bwi_plate_multiply_mass(bw_context *context, const bw_plate *plate, const double *x,
                                  double *y) {
  (void)context;
  const bw_plane_pattern *g = plate->inner->now->matrices->pattern;
  const double *mass = plate->inner->now->matrices->mass;
  const bwi_plate_law *law = &plate->inner->law;
  for (int64_t i = 0; i < g->node_count; i++) {
    double sum[3] = {0};
    for (int64_t p = g->start[i]; p < g->start[i + 1]; p++)
      for (int c = 0; c < 3; c++)
        sum[c] += mass[p] * x[3 * (int64_t)g->column[p] + c];
    for (int c = 0; c < 3; c++)
      y[3 * i + c] = component_mass(law, c) * sum[c];
  }
  return BW_OK;
}

/* A square of the plate's box has its lowest mode near here; the shift makes the matrix definite
 * and costs rounds only as far as it is not small beside the eigenvalues sought. */
static double shift_for(const bw_plane_mesh *mesh, const bwi_plate_law *law) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int64_t i = 0; i < mesh->topology->nodes->node_count; i++)
    for (int c = 0; c < 2; c++) {
      low[c] = fmin(low[c], mesh->point[2 * i + c]);
      high[c] = fmax(high[c], mesh->point[2 * i + c]);
    }
  double length = hypot(high[0] - low[0], high[1] - low[1]);
  double rigidity = fmax(law->bending[0], law->bending[4]);
  return 50 * rigidity / (law->mass * length * length * length * length);
}

static void matrices_destroy(void *object) {
  bwi_plate_matrices *m = object;
  bw_release(m->pattern);
  bw_free(m->stiffness);
  bw_free(m->mass);
  bw_free(m->shifted);
  bw_free(m);
}

static const bw_kind matrices_kind = {"plate matrices", matrices_destroy, NULL};

/* Of a mesh of the pattern's topology. */
static bw_status make_matrices(bw_context *context, const struct bwi_plate *in,
                               bw_plane_pattern *pattern, const bw_plane_mesh *mesh,
                               bwi_plate_matrices **out) {
  bw_status status = BW_OK;
  int64_t blocks = pattern->block_count;
  bwi_plate_matrices *m = BW_NEW0(context, bwi_plate_matrices, 1);
  if (!m)
    return BW_MEMORY;
  bw_object_init(m, &matrices_kind);
  m->law = in->law;
  m->pattern = bw_retain(pattern);
  m->stiffness = BW_NEW(context, double, 9 * blocks);
  m->mass = BW_NEW(context, double, blocks);
  m->shifted = BW_NEW(context, double, 9 * blocks);
  BW_TRY_MEMORY(m->stiffness && m->mass && m->shifted);
  /* of the shape as it is: a drag may scale it */
  double shift = shift_for(mesh, &in->law);
  assembly data = {context, mesh, in};
  BW_TRY(bw_plane_assemble(context, pattern, 3, stiffness_of, &data, m->stiffness));
  BW_TRY(bw_plane_assemble(context, pattern, 1, mass_of, &data, m->mass));
  for (int64_t p = 0; p < blocks; p++)
    for (int k = 0; k < 9; k++)
      m->shifted[9 * p + k] =
          m->stiffness[9 * p + k] +
          (k % 4 == 0 ? shift * component_mass(&in->law, k / 4) * m->mass[p] : 0);
  *out = m;
  m = NULL;
done:
  bw_release(m);
  return status;
}

/* ---- life ------------------------------------------------------------------------------------ */

static bw_status check_mesh(bw_context *context, const bw_plane_mesh *mesh) {
  if (mesh->topology->nodes->order != 2)
    return bw_fail(context, BW_INVALID,
                   "a plate needs six-node triangles: fill the outline with order 2");
  return BW_OK;
}

bw_status bw_plate_create(bw_context *context, const bw_plane_mesh *mesh,
                          const bw_material *material, double thickness, bw_plate **result) {
  bw_status status = BW_OK;
  bw_plate *plate = NULL;
  struct bwi_plate *in = NULL;
  bw_plane_pattern *pattern = NULL;
  bwi_plate_matrices *matrices = NULL;
  bw_plate_state *first = NULL;
  BW_TRY(check_mesh(context, mesh));
  plate = BW_NEW0(context, bw_plate, 1);
  in = BW_NEW0(context, struct bwi_plate, 1);
  if (!plate || !in) {
    bw_free(plate);
    bw_free(in);
    return BW_MEMORY;
  }
  bw_object_init(plate, &plate_kind);
  plate->inner = in;
  plate->thickness = thickness;
  plate->material = bw_retain(material);
  BW_TRY(bwi_plate_law_create(context, material, thickness, &in->law));
  bwi_plate_reference_fill(&in->reference);
  BW_TRY(bwi_lagged_create(context, &bwi_lagged_symmetric, 3, &in->factor));
  BW_TRY(bw_plane_pattern_create(context, mesh->topology, &pattern));
  BW_TRY(make_matrices(context, in, pattern, mesh, &matrices));
  BW_TRY(bwi_plate_blank(context, mesh, matrices, &first));
  bwi_plate_adopt(plate, first);
done:
  bw_release(pattern);
  bw_release(matrices);
  bw_release(first);
  if (status == BW_OK)
    *result = plate;
  else
    bw_release(plate);
  return status;
}

/* Everything is made beside what there is, and takes its place at the end. */
bw_status bw_plate_follow(bw_context *context, bw_plate *plate, const bw_plane_mesh *mesh,
                          bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_plate *in = plate->inner;
  const bw_plate_state *was = in->now;
  const bw_plane_topology *before = plate->mesh->topology, *now = mesh->topology;
  bool same_topology = now == before, same_nodes = now->nodes == before->nodes;
  double started = bw_seconds(), *rotation = NULL;
  bw_plane_pattern *pattern = NULL;
  bwi_plate_matrices *matrices = NULL;
  bw_plate_state *next = NULL;
  BW_TRY(check_mesh(context, mesh));
  if (same_topology)
    pattern = bw_retain(was->matrices->pattern);
  else
    BW_TRY(bw_plane_pattern_create(context, now, &pattern));
  int64_t nodes = now->nodes->node_count;
  BW_TRY(make_matrices(context, in, pattern, mesh, &matrices));
  BW_TRY(bwi_plate_blank(context, mesh, matrices, &next));
  next->mode_count = was->mode_count;
  next->known = was->known;
  next->past = was->past;
  BW_TRY(bwi_copy_block(context, was->frequency, (size_t)was->mode_count, &next->frequency));
  BW_TRY(bwi_copy_block(context, was->residual, (size_t)was->mode_count, &next->residual));
  next->shape = BW_NEW(context, double, was->known *nodes * 3);
  rotation = BW_NEW(context, double, 4 * nodes);
  BW_TRY_MEMORY(next->shape && rotation);
  for (int k = 0; k < was->known; k++)
    BW_TRY(bw_plane_transfer(context, plate->mesh, mesh, 3,
                             was->shape + k * 3 * (int64_t)before->nodes->node_count,
                             next->shape + k * 3 * nodes));
  if (same_nodes) {
    BW_TRY(bwi_plate_rotations(context, &in->reference, now, plate->mesh->point, mesh->point,
                               rotation));
    for (int k = 0; k < was->known; k++)
      bwi_plate_rotate(nodes, rotation, false, next->shape + k * 3 * nodes);
  }
  BW_TRY(bwi_plate_commit(context, plate, next));
  if (reuse) {
    reuse->pattern = same_topology;
    reuse->factor = same_topology && in->factored;
    reuse->solution = next->known > 0;
    reuse->seconds_assemble += bw_seconds() - started;
  }
done:
  bw_release(pattern);
  bw_release(matrices);
  bw_release(next);
  bw_free(rotation);
  return status;
}
