/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What multipliers prove about the stress of elements: the dual function, evaluated from its
 * definition (docs/theory/worst_case.md, "The certificate").
 *
 * With gains g_j per share of the force, largest shares u_j and any x,
 *     x + sum u_j max(0, g_j - x)
 * is a sum over the pressures. So all claims are evaluated side by side, a block of pressures at a
 * time: solve, stresses of all elements, one more term of each sum. Only sums are kept.
 *
 * A term takes at most ROUNDED operations for six motions, the sum of a block included; sums of
 * blocks are compensated. The sizes of all that is added, times that share of rounding, are added
 * to each bound. */
#include "barwright/certificate.h"

#include "analysis/solve_error.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A block has as many nodes as fit into NODES columns, and one at least. */
enum { WIDTH = BW_MAX_FRICTION_FACETS, NODES = 32, CLAIMS_PER_TASK = 256, ROUNDED = 128 };

typedef struct total {
  double sum, lost; /* compensated */
} total;

typedef struct claims {
  const bw_dual_claims *stated;
  const bw_pressure_basis *basis;
  int64_t elements;
  int32_t first, width; /* the block of pressures */
  const double *stress; /* width x elements x 6 */
  total *total;         /* 2 for each claim */
  double *size;         /* claim: of its stresses */
  /* of the block: the whole force over the area, the largest fraction of the force */
  double pressure[WIDTH], max[WIDTH];
} claims;

static void add(total *t, double term) {
  double sum = t->sum + term;
  t->lost += fabs(t->sum) >= fabs(term) ? (t->sum - sum) + term : (term - sum) + t->sum;
  t->sum = sum;
}

/* gain -= y . work */
static void take_off(const claims *c, const double *y, double *gain) {
  for (int32_t k = 0; k < c->stated->motions; k++) {
    const double *work = c->stated->work + (size_t)k * (size_t)c->basis->count + c->first;
    for (int32_t j = 0; j < c->width; j++)
      gain[j] -= y[k] * work[j];
  }
}

/* Terms of the block: of the columns of a node the one that gains most. */
static void add_block(const claims *c, const double *gain, double x, total *t) {
  int32_t directions = c->basis->directions;
  double sum = 0;
  for (int32_t j = 0; j < c->width; j += directions) {
    double max = gain[j];
    for (int32_t k = 1; k < directions; k++)
      max = fmax(max, gain[j + k]);
    sum += c->max[j] * fmax(0, max - x);
  }
  add(t, sum);
}

static void add_everywhere(const claims *c, const double *y, double (*response)[WIDTH], total *t) {
  int32_t motions = c->stated->motions;
  double gain[WIDTH] = {0};
  for (int r = 0; r < 6; r++) {
    take_off(c, y + r * motions, response[r]);
    for (int32_t j = 0; j < c->width; j++)
      gain[j] += (r < 3 ? 1 : 2) * response[r][j] * response[r][j];
  }
  for (int32_t j = 0; j < c->width; j++)
    gain[j] = c->pressure[j] * sqrt(gain[j]);
  add_block(c, gain, y[6 * motions], t);
}

static void add_direction(const claims *c, const double n[3], const double *y,
                          double (*response)[WIDTH], total *t) {
  const double tensor[6] = {n[0] * n[0],     n[1] * n[1],     n[2] * n[2],
                            2 * n[1] * n[2], 2 * n[2] * n[0], 2 * n[0] * n[1]};
  int32_t motions = c->stated->motions;
  double along[WIDTH] = {0}, gain[WIDTH];
  for (int r = 0; r < 6; r++)
    for (int32_t j = 0; j < c->width; j++)
      along[j] += tensor[r] * response[r][j];
  for (int sign = 0; sign < 2; sign++, y += motions + 1) {
    for (int32_t j = 0; j < c->width; j++)
      gain[j] = sign ? -along[j] : along[j];
    take_off(c, y, gain);
    for (int32_t j = 0; j < c->width; j++)
      gain[j] *= c->pressure[j];
    add_block(c, gain, y[motions], &t[sign]);
  }
}

static bool has_direction(const double n[3]) {
  return n[0] != 0 || n[1] != 0 || n[2] != 0;
}

static bw_status claim_body(void *data, int64_t begin, int64_t end, int worker) {
  claims *c = (claims *)data;
  size_t numbers = 6 * (size_t)c->stated->motions + 2;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double response[6][WIDTH], size = 0;
    const double *from = c->stress + 6 * (size_t)c->stated->element[i];
    for (int32_t j = 0; j < c->width; j++, from += 6 * c->elements) {
      double sum = 0;
      for (int r = 0; r < 6; r++) {
        response[r][j] = from[r];
        sum += fabs(from[r]);
      }
      size += c->pressure[j] * c->max[j] * sum;
    }
    c->size[i] += size;
    const double *y = c->stated->multiplier + (size_t)i * numbers;
    const double *n = c->stated->direction + 3 * i;
    if (has_direction(n))
      add_direction(c, n, y, response, &c->total[2 * i]);
    else
      add_everywhere(c, y, response, &c->total[2 * i]);
  }
  return BW_OK;
}

/* ---- the pressures, block by block --------------------------------------------------------- */

typedef struct block {
  const bw_system *system;
  const bwi_solve_error *error;
  double *force, *displacement, *stress;
  double *work;         /* 6 nodes for each pressure */
  double energy[WIDTH]; /* of the errors */
} block;

static void block_clear(block *b) {
  bw_free(b->force);
  bw_free(b->displacement);
  bw_free(b->work);
  bw_free(b->stress);
}

static bw_status error_body(void *data, int64_t begin, int64_t end, int worker) {
  block *b = (block *)data;
  size_t n = 3 * (size_t)b->system->mesh->node_count;
  (void)worker;
  for (int64_t j = begin; j < end; j++)
    b->energy[j] =
        bwi_solve_error_energy(b->error, b->force + (size_t)j * n, b->displacement + (size_t)j * n,
                               b->work + 2 * (size_t)j * n);
  return BW_OK;
}

/* Displacements, their errors, stresses. */
static bw_status solve_block(bw_context *context, bw_system *system, claims *c, block *b) {
  bw_status status = BW_OK;
  const bw_pressure_basis *basis = c->basis;
  size_t n = 3 * (size_t)system->mesh->node_count;
  memset(b->force, 0, (size_t)c->width * n * sizeof *b->force);
  for (int32_t j = 0; j < c->width; j++) {
    double *force = b->force + (size_t)j * n;
    for (int64_t k = basis->start[c->first + j]; k < basis->start[c->first + j + 1]; k++)
      for (int d = 0; d < 3; d++)
        force[3 * (size_t)basis->row[k] + (size_t)d] += basis->coefficient[3 * k + d];
    c->pressure[j] = c->stated->force / basis->area[c->first + j];
    c->max[j] = basis->area[c->first + j] * (c->stated->pressure / c->stated->force);
  }
  BW_TRY(bw_system_solve(context, system, c->width, b->force, b->displacement));
  BW_TRY(bw_parallel(context, c->width, 1, error_body, b));
  for (int32_t j = 0; j < c->width; j++)
    BW_TRY(bw_element_stress(context, system->mesh, system->material,
                             b->displacement + (size_t)j * n,
                             b->stress + 6 * (size_t)j * (size_t)c->elements));
done:
  return status;
}

/* What the multipliers y add to the sizes of terms. */
static double size_of(int32_t motions, const double *y, const double *work_size) {
  double size = 0;
  for (int32_t k = 0; k < motions; k++)
    size += fabs(y[k]) * work_size[k];
  return size;
}

static double bound_of(const claims *c, int64_t i, const double *work_size, double shares) {
  const bw_dual_claims *stated = c->stated;
  int32_t m = stated->motions;
  bool directed = has_direction(stated->direction + 3 * i);
  const double *y = stated->multiplier + (6 * (size_t)m + 2) * (size_t)i;
  const double rounding = (ROUNDED + 4.0 * m) * DBL_EPSILON;
  double bound = -INFINITY;
  for (int s = 0; s < (directed ? 2 : 1); s++) {
    double size = c->size[i], x;
    if (directed) {
      size += size_of(m, y, work_size);
      x = y[m];
      y += m + 1;
    } else {
      for (int r = 0; r < 6; r++)
        size += 2 * size_of(m, y + r * m, work_size);
      x = y[6 * m];
    }
    const total *t = &c->total[2 * i + s];
    double value = x + (t->sum + t->lost) + (stated->force_is_max ? fmax(0, -x) : 0);
    bound = fmax(bound, value + rounding * (2 * size + fabs(x) * (2 + shares)));
  }
  return bound;
}

static bw_status allocate(bw_context *context, const bw_system *system, claims *c, block *b,
                          int32_t step, double **work_size) {
  size_t width = (size_t)step, n = 3 * (size_t)system->mesh->node_count;
  b->force = BW_NEW(context, double, width *n);
  b->displacement = BW_NEW(context, double, width *n);
  b->work = BW_NEW(context, double, 2 * width * n);
  b->stress = BW_NEW(context, double, 6 * width * (size_t)c->elements);
  c->stress = b->stress;
  c->total = BW_NEW0(context, total, 2 * c->stated->count + 1);
  c->size = BW_NEW0(context, double, c->stated->count + 1);
  *work_size = BW_NEW0(context, double, c->stated->motions + 1);
  return b->force && b->displacement && b->work && b->stress && c->total && c->size && *work_size
             ? BW_OK
             : BW_MEMORY;
}

static bw_status check_claims(bw_context *context, const bw_system *system,
                              const bw_pressure_basis *basis, const bw_dual_claims *stated) {
  if (basis->mesh->node_count != system->mesh->node_count)
    return bw_fail(context, BW_INVALID, "a pressure basis of the same mesh expected");
  if (!(stated->force > 0 && stated->pressure > 0))
    return bw_fail(context, BW_INVALID, "force and pressure must be positive");
  for (int64_t i = 0; i < stated->count; i++)
    if (stated->element[i] < 0 || stated->element[i] >= system->mesh->element_count)
      return bw_fail(context, BW_INVALID, "element %d of %d", (int)stated->element[i] + 1,
                     (int)system->mesh->element_count);
  return BW_OK;
}

bw_status bw_dual_bounds(bw_context *context, bw_system *system, const bw_pressure_basis *basis,
                         const bw_dual_claims *stated, double *bound, double *solve_error) {
  bw_status status = BW_OK;
  claims c = {.stated = stated, .basis = basis, .elements = system->mesh->element_count};
  bwi_solve_error error = {0};
  block b = {.system = system, .error = &error};
  double *work_size = NULL, energy = 0, shares = 0;
  int32_t directions = basis->directions;
  int32_t step = directions * (NODES > directions ? NODES / directions : 1);
  BW_TRY(check_claims(context, system, basis, stated));
  BW_TRY(bw_material_fits(context, system->material, system->mesh->element_count));
  BW_TRY(allocate(context, system, &c, &b, step, &work_size));
  BW_TRY(bwi_solve_error_open(context, system, &error));
  for (c.first = 0; c.first < basis->count; c.first += step) {
    c.width = basis->count - c.first < step ? basis->count - c.first : step;
    bw_progress(context, "certificate", (double)c.first / basis->count);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(solve_block(context, system, &c, &b));
    BW_TRY(bw_parallel(context, stated->count, CLAIMS_PER_TASK, claim_body, &c));
    for (int32_t j = 0; j < c.width; j++) {
      energy = fmax(energy, b.energy[j] / basis->area[c.first + j]);
      double full = c.pressure[j] * c.max[j]; /* the largest pressure */
      shares += c.max[j];
      for (int32_t k = 0; k < stated->motions; k++)
        work_size[k] +=
            full * fabs(stated->work[(size_t)k * (size_t)basis->count + (size_t)(c.first + j)]);
    }
  }
  for (int64_t i = 0; i < stated->count; i++) {
    bound[i] = bound_of(&c, i, work_size, shares);
    solve_error[i] = bwi_stress_per_energy(system, stated->element[i]) * (stated->force * energy);
  }
  bw_progress(context, "certificate", 1);
done:
  block_clear(&b);
  bwi_solve_error_close(&error);
  bw_free(c.total);
  bw_free(c.size);
  bw_free(work_size);
  return status;
}
