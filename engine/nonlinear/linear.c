/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Products with the second derivatives of a solid's energy that never become a matrix. Every
 * element multiplies its own stiffness; then every node sums what its elements have, in ascending
 * order. */
#include "nonlinear/internal.h"

enum { ELEMENTS_PER_CHUNK = 128, NODES_PER_CHUNK = 512 };

struct bw_solid_linear {
  const bw_solid *solid; /* retained */
  double *stiffness;     /* elements x 300 */
  double *product;       /* elements x 24: of the product being made */
};

bw_status bw_solid_linear_create(bw_context *context, const bw_solid *solid,
                                 bw_solid_linear **out) {
  int64_t elements = solid->grid->element_count;
  bw_solid_linear *linear = BW_NEW0(context, bw_solid_linear, 1);
  if (!linear)
    return BW_MEMORY;
  linear->solid = (const bw_solid *)bw_retain(solid);
  linear->stiffness = BW_NEW0(context, double, BWI_ELEMENT_NUMBERS *elements);
  linear->product = BW_NEW0(context, double, BWI_ELEMENT_FORCES *elements);
  if (!linear->stiffness || !linear->product) {
    bw_solid_linear_destroy(linear);
    return BW_MEMORY;
  }
  *out = linear;
  return BW_OK;
}

void bw_solid_linear_destroy(bw_solid_linear *linear) {
  if (!linear)
    return;
  bw_release(linear->solid);
  bw_free(linear->stiffness);
  bw_free(linear->product);
  bw_free(linear);
}

typedef struct data {
  const bw_solid_linear *linear;
  bw_context *context;
  const double *x;
  double *y;
  bool project;
} data;

static bw_status set_elements(void *of, int64_t begin, int64_t end, int worker) {
  const data *d = (const data *)of;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    bwi_hexahedron_state state;
    double force[BWI_ELEMENT_FORCES];
    bwi_element_evaluate(d->linear->solid, (int32_t)e, d->x, BWI_TANGENT, d->project, &state, force,
                         d->linear->stiffness + BWI_ELEMENT_NUMBERS * e);
    if (!state.defined)
      return bwi_fail_undefined(d->context, e);
  }
  return BW_OK;
}

bw_status bw_solid_linear_set(bw_context *context, bw_solid_linear *linear, const double *u,
                              bool project) {
  data d = {.linear = linear, .context = context, .x = u, .project = project};
  return bw_parallel(context, linear->solid->grid->element_count, ELEMENTS_PER_CHUNK, set_elements,
                     &d);
}

typedef struct addition {
  bw_solid_linear *linear;
  const bw_solid_linear *other;
  double of_mass, part;
} addition;

static bw_status add_elements(void *of, int64_t begin, int64_t end, int worker) {
  const addition *d = (const addition *)of;
  const bw_solid *solid = d->linear->solid;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    double *k = d->linear->stiffness + BWI_ELEMENT_NUMBERS * e;
    double density = solid->material_table->material[solid->grid->material[e]]->density;
    double mass = d->of_mass * density * bwi_solid_volume(solid->grid, (int32_t)e) / 8;
    for (int i = 0; d->other && i < BWI_ELEMENT_NUMBERS; i++)
      k[i] += d->part * d->other->stiffness[BWI_ELEMENT_NUMBERS * e + i];
    for (int a = 0; a < 8; a++) {
      double *block = k + bwi_element_block(a, a);
      block[0] += mass;
      block[3] += mass;
      block[5] += mass;
    }
  }
  return BW_OK;
}

bw_status bwi_solid_linear_add(bw_context *context, bw_solid_linear *linear, double of_mass,
                               const bw_solid_linear *other, double part) {
  addition d = {linear, other, of_mass, part};
  return bw_parallel(context, linear->solid->grid->element_count, ELEMENTS_PER_CHUNK, add_elements,
                     &d);
}

/* The elements around node i, as the diagonal of the pattern has them: from *begin to *end - 1. */
static inline void around(const bw_solid *solid, int64_t i, int64_t *begin, int64_t *end) {
  const bwi_contributions *list = solid->contributions;
  int64_t diagonal = solid->pattern->start[i + 1] - 1;
  *begin = list->start[diagonal];
  *end = list->start[diagonal + 1];
}

typedef struct shift {
  bw_solid_linear *linear;
  double value;
} shift;

static bw_status shift_nodes(void *of, int64_t begin, int64_t end, int worker) {
  const shift *d = (const shift *)of;
  const bw_solid *solid = d->linear->solid;
  const bwi_contributions *list = solid->contributions;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    int64_t first, last;
    around(solid, i, &first, &last);
    for (int64_t k = first; k < last; k++) {
      int a = list->local[k] >> 4;
      double *block = d->linear->stiffness + BWI_ELEMENT_NUMBERS * (int64_t)list->element[k] +
                      bwi_element_block(a, a);
      double part = d->value / (double)(last - first);
      block[0] += part;
      block[3] += part;
      block[5] += part;
    }
  }
  return BW_OK;
}

bw_status bwi_solid_linear_shift(bw_context *context, bw_solid_linear *linear, double value) {
  shift d = {linear, value};
  return bw_parallel(context, linear->solid->grid->node_count, NODES_PER_CHUNK, shift_nodes, &d);
}

/* y = K x of one element. Blocks below the diagonal serve their mirror images too. */
static void multiply_element(const double *k, const double x[8][3], double y[8][3]) {
  memset(y, 0, 24 * sizeof(double));
  for (int a = 0; a < 8; a++) {
    double row[3] = {0};
    const double *xa = x[a];
    for (int b = 0; b < a; b++, k += 9) {
      for (int i = 0; i < 3; i++)
        row[i] += k[3 * i] * x[b][0] + k[3 * i + 1] * x[b][1] + k[3 * i + 2] * x[b][2];
      for (int i = 0; i < 3; i++)
        y[b][i] += k[i] * xa[0] + k[3 + i] * xa[1] + k[6 + i] * xa[2];
    }
    y[a][0] += row[0] + (k[0] * xa[0] + k[1] * xa[1] + k[2] * xa[2]);
    y[a][1] += row[1] + (k[1] * xa[0] + k[3] * xa[1] + k[4] * xa[2]);
    y[a][2] += row[2] + (k[2] * xa[0] + k[4] * xa[1] + k[5] * xa[2]);
    k += 6;
  }
}

static bw_status multiply_elements(void *of, int64_t begin, int64_t end, int worker) {
  const data *d = (const data *)of;
  const bw_grid *grid = d->linear->solid->grid;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    double x[8][3];
    for (int a = 0; a < 8; a++)
      memcpy(x[a], d->x + 3 * (int64_t)grid->element[8 * e + a], sizeof x[a]);
    multiply_element(d->linear->stiffness + BWI_ELEMENT_NUMBERS * e, x,
                     (double(*)[3])(d->linear->product + BWI_ELEMENT_FORCES * e));
  }
  return BW_OK;
}

static bw_status gather_nodes(void *of, int64_t begin, int64_t end, int worker) {
  const data *d = (const data *)of;
  const bw_solid *solid = d->linear->solid;
  const bwi_contributions *list = solid->contributions;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double sum[3] = {0};
    int64_t k, last;
    for (around(solid, i, &k, &last); k < last; k++) {
      const double *from = d->linear->product + BWI_ELEMENT_FORCES * (int64_t)list->element[k] +
                           3 * (list->local[k] >> 4);
      for (int r = 0; r < 3; r++)
        sum[r] += from[r];
    }
    memcpy(d->y + 3 * i, sum, sizeof sum);
  }
  return BW_OK;
}

bw_status bw_solid_linear_multiply(bw_context *context, const bw_solid_linear *linear,
                                   const double *x, double *y) {
  bw_status status = BW_OK;
  const bw_grid *grid = linear->solid->grid;
  data d = {.linear = linear, .context = context, .x = x, .y = y};
  BW_TRY(bw_parallel(context, grid->element_count, ELEMENTS_PER_CHUNK, multiply_elements, &d));
  BW_TRY(bw_parallel(context, grid->node_count, NODES_PER_CHUNK, gather_nodes, &d));
done:
  return status;
}

static bw_status gather_blocks(void *of, int64_t begin, int64_t end, int worker) {
  const data *d = (const data *)of;
  const bw_solid *solid = d->linear->solid;
  const bwi_contributions *list = solid->contributions;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double s[6] = {0};
    int64_t k, last;
    for (around(solid, i, &k, &last); k < last; k++) {
      int a = list->local[k] >> 4;
      const double *from = d->linear->stiffness + BWI_ELEMENT_NUMBERS * (int64_t)list->element[k] +
                           bwi_element_block(a, a);
      for (int r = 0; r < 6; r++)
        s[r] += from[r];
    }
    const double full[9] = {s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]};
    memcpy(d->y + 9 * i, full, sizeof full);
  }
  return BW_OK;
}

bw_status bw_solid_linear_diagonal(bw_context *context, const bw_solid_linear *linear,
                                   double *blocks) {
  data d = {.linear = linear, .y = blocks};
  return bw_parallel(context, linear->solid->grid->node_count, NODES_PER_CHUNK, gather_blocks, &d);
}
