/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Vertex stars (stars.h). */
#include "linear/stars.h"

#include <math.h>
#include <string.h>

enum { GRAIN = 16, LANES = 4 }; /* stars handed to a thread at once; numbers in a register */

/* The largest diagonal entry of a star's matrix times that of its inverse, at most. Couplings in
 * floats change soft motions by 6e-8 of that: at 6e6, in flat elements, iterations diverge.
 * At 1.5e5 they converge. */
#define WORST 3e5

struct bwi_stars {
  bw_object object;
  int32_t count; /* of stars, in the order of sweeps */
  int64_t rows;  /* of the smoother */
  int32_t colour_count;
  int32_t *colour_start;  /* colour_count + 1 */
  int32_t *corner;        /* of a star */
  int64_t *member_start;  /* count + 1 */
  int32_t *member;        /* its nodes, as rows of the smoother */
  int64_t *link_start;    /* by member + 1 */
  int32_t *link;          /* neighbours outside of the star, as rows */
  float *coupling;        /* 9 by link, by columns: K of the neighbour (row) and the member */
  int64_t *inverse_start; /* count + 1 */
  double *inverse; /* the lower triangle by rows, each filled with zeros to whole registers */
  int64_t longest; /* numbers in a star */
};

static void stars_destroy(void *object) {
  bwi_stars *s = object;
  bw_free(s->colour_start);
  bw_free(s->corner);
  bw_free(s->member_start);
  bw_free(s->member);
  bw_free(s->link_start);
  bw_free(s->link);
  bw_free(s->coupling);
  bw_free(s->inverse_start);
  bw_free(s->inverse);
  bw_free(s);
}

double bwi_stars_read(const bwi_stars *s) {
  int64_t members = s->member_start[s->count], links = s->link_start[members];
  return 2 *
         ((double)links * (9 * sizeof(float) + sizeof(int32_t)) +
          (double)s->inverse_start[s->count] * sizeof(double) + (double)members * sizeof(int32_t));
}

static size_t stars_bytes(const void *object) {
  const bwi_stars *s = object;
  size_t members = (size_t)s->member_start[s->count];
  return sizeof *s + (size_t)(bwi_stars_read(s) / 2) + members * sizeof(int64_t) +
         (size_t)s->count * (2 * sizeof(int64_t) + sizeof(int32_t));
}

static const bw_kind stars_kind = {"vertex stars", stars_destroy, stars_bytes};

/* ---- which nodes ----------------------------------------------------------------------------- */

/* The corner next to corner c by its a-th child: itself by its own node. */
static int32_t next_to(const bwi_two_level *l, int32_t c, int64_t a) {
  const int32_t *pair = l->parent + 2 * (int64_t)l->child[a];
  return pair[0] == c ? pair[1] : pair[0];
}

/* Colours, the lowest that no corner has which is a neighbour or a neighbour's neighbour: then two
 * stars of a colour have neither nodes nor links in common. */
static bw_status colour(bw_context *context, const bwi_two_level *l, bwi_stars *s) {
  bw_status status = BW_OK;
  int32_t *of = BW_NEW(context, int32_t, s->count);
  int32_t *last = BW_NEW(context, int32_t, (int64_t)s->count + 1); /* by colour: whose it is not */
  BW_TRY_MEMORY(of && last);
  for (int32_t c = 0; c < s->count; c++)
    of[c] = last[c] = -1;
  for (int32_t c = 0; c < s->count; c++) {
    for (int64_t a = l->child_start[c]; a < l->child_start[c + 1]; a++) {
      int32_t near = next_to(l, c, a);
      for (int64_t b = l->child_start[near]; b < l->child_start[near + 1]; b++) {
        int32_t taken = of[next_to(l, near, b)];
        if (taken >= 0)
          last[taken] = c;
      }
    }
    int32_t k = 0;
    while (last[k] == c)
      k++;
    of[c] = k;
    s->colour_count = k >= s->colour_count ? k + 1 : s->colour_count;
  }
  s->colour_start = BW_NEW0(context, int32_t, (int64_t)s->colour_count + 1);
  BW_TRY_MEMORY(s->colour_start);
  for (int32_t c = 0; c < s->count; c++)
    s->colour_start[of[c] + 1]++;
  for (int32_t k = 0; k < s->colour_count; k++)
    s->colour_start[k + 1] += s->colour_start[k];
  for (int32_t c = 0; c < s->count; c++) /* the starts run ahead, and are put back after */
    s->corner[s->colour_start[of[c]]++] = c;
  for (int32_t k = s->colour_count; k > 0; k--)
    s->colour_start[k] = s->colour_start[k - 1];
  s->colour_start[0] = 0;
done:
  bw_free(of);
  bw_free(last);
  return status;
}

static int64_t inverse_size(int64_t numbers) {
  int64_t whole = numbers / LANES, rest = numbers % LANES;
  return LANES * (LANES * whole * (whole + 1) / 2 + rest * (whole + 1));
}

/* The place of a row among the members of a star, or -1. */
static int64_t place_in(const bwi_stars *s, int64_t star, int32_t row) {
  for (int64_t m = s->member_start[star]; m < s->member_start[star + 1]; m++)
    if (s->member[m] == row)
      return m - s->member_start[star];
  return -1;
}

/* Calls what follows for every block of K in row i of the smoother's matrix: `j` is the other row,
 * `at` the block and `across` whether it is the transpose. */
#define FOR_BLOCKS(smoother, i, body)                                                              \
  do {                                                                                             \
    const bw_block_pattern *pattern_ = (smoother)->pattern;                                        \
    int32_t node_ = (smoother)->node[i];                                                           \
    int64_t lower_ = pattern_->start[node_ + 1] - pattern_->start[node_];                          \
    int64_t upper_ = pattern_->upper_start[node_ + 1] - pattern_->upper_start[node_];              \
    for (int64_t n_ = 0; n_ < lower_ + upper_; n_++) {                                             \
      bool across = n_ >= lower_;                                                                  \
      int64_t u_ = pattern_->upper_start[node_] + n_ - lower_;                                     \
      int64_t at = across ? bw_upper_block(pattern_, u_) : pattern_->start[node_] + n_;            \
      int32_t j = (smoother)->row_of[across ? pattern_->upper_row[u_] : pattern_->column[at]];     \
      body                                                                                         \
    }                                                                                              \
  } while (0)

static bw_status list_members(bw_context *context, const bwi_two_level *l, bwi_stars *s) {
  int64_t members = 0;
  s->member = BW_NEW(context, int32_t, 2 * s->rows);
  s->link_start = BW_NEW0(context, int64_t, 2 * s->rows + 1);
  if (!s->member || !s->link_start)
    return BW_MEMORY;
  for (int32_t star = 0; star < s->count; star++) {
    int32_t c = s->corner[star], own = -1;
    s->member_start[star] = members;
    for (int64_t a = l->child_start[c]; a < l->child_start[c + 1]; a++) {
      int32_t k = l->child[a];
      if (k == own)
        continue;
      if (l->parent[2 * (int64_t)k] == l->parent[2 * (int64_t)k + 1])
        own = k;
      s->member[members++] = k;
    }
    int64_t numbers = 3 * (members - s->member_start[star]);
    s->member_start[star + 1] = members;
    s->inverse_start[star + 1] = s->inverse_start[star] + inverse_size(numbers);
    s->longest = numbers > s->longest ? numbers : s->longest;
  }
  for (int64_t star = 0; star < s->count; star++)
    for (int64_t m = s->member_start[star]; m < s->member_start[star + 1]; m++) {
      int64_t count = 0;
      FOR_BLOCKS(l->smoother, s->member[m], {
        (void)at;
        count += place_in(s, star, j) < 0;
      });
      s->link_start[m + 1] = s->link_start[m] + count;
    }
  return BW_OK;
}

/* ---- numbers --------------------------------------------------------------------------------- */

typedef struct taking {
  bw_context *context;
  const bwi_two_level *l;
  bwi_stars *s;
  const double *stiffness;
  double *works; /* workers x longest^2 */
  bool *failed;  /* workers */
} taking;

/* K of a star, n x n, and its links. */
static void collect(const taking *t, int64_t star, int64_t n, double *a) {
  const bwi_smoother *smoother = t->l->smoother;
  bwi_stars *s = t->s;
  memset(a, 0, (size_t)(n * n) * sizeof *a);
  for (int64_t m = s->member_start[star], i = 0; m < s->member_start[star + 1]; m++, i++) {
    int64_t link = s->link_start[m];
    FOR_BLOCKS(smoother, s->member[m], {
      const double *block = t->stiffness + 9 * at;
      int64_t other = place_in(s, star, j);
      for (int r = 0; r < 3 && other >= 0; r++)
        for (int c = 0; c < 3; c++)
          a[(3 * i + r) * n + 3 * other + c] =
              smoother->unit * block[across ? 3 * c + r : 3 * r + c];
      if (other >= 0)
        continue;
      s->link[link] = j;
      for (int k = 0; k < 9; k++) /* column by column, of the transpose: row by row of the block */
        s->coupling[9 * link + k] =
            (float)(smoother->unit * block[across ? 3 * (k % 3) + k / 3 : k]);
      link++;
    });
  }
}

/* a at the unknowns of its nodes, and of the rest the identity times `scale`, or without it. */
static void keep_unknowns(const taking *t, int64_t star, int64_t n, double scale, double *a) {
  const bwi_smoother *smoother = t->l->smoother;
  for (int64_t i = 0; i < n; i += 3) {
    int64_t node = smoother->node[t->s->member[t->s->member_start[star] + i / 3]];
    const uint8_t *state = t->l->dof_map->state + 3 * node;
    if (state[0] != BW_DOF_PRESCRIBED && state[1] != BW_DOF_PRESCRIBED &&
        state[2] != BW_DOF_PRESCRIBED)
      continue;
    for (int64_t r = 0; r < n; r++) {
      double column[3] = {a[i * n + r], a[(i + 1) * n + r], a[(i + 2) * n + r]};
      bwi_project_unknowns(t->l->dof_map, node, column, column);
      for (int d = 0; d < 3; d++)
        a[(i + d) * n + r] = column[d];
    }
    for (int64_t r = 0; r < n; r++)
      bwi_project_unknowns(t->l->dof_map, node, a + r * n + i, a + r * n + i);
    for (int d = 0; d < 3; d++) {
      double unit[3] = {d == 0, d == 1, d == 2}, kept[3];
      bwi_project_unknowns(t->l->dof_map, node, unit, kept);
      for (int c = 0; c < 3; c++)
        a[(i + d) * n + i + c] += scale * (unit[c] - kept[c]);
    }
  }
}

/* a^-1 in its place, by Gauss and Jordan's elimination. False where a pivot is not positive. */
static bool invert(int64_t n, double *a) {
  for (int64_t k = 0; k < n; k++) {
    double *row = a + k * n, pivot = row[k];
    if (!(pivot > 0))
      return false;
    row[k] = 1;
    for (int64_t j = 0; j < n; j++)
      row[j] /= pivot;
    for (int64_t i = 0; i < n; i++) {
      double *other = a + i * n, factor = other[k];
      if (i == k)
        continue;
      other[k] = 0;
      for (int64_t j = 0; j < n; j++)
        other[j] -= factor * row[j];
    }
  }
  return true;
}

static double largest_of_diagonal(int64_t n, const double *a) {
  double largest = 0;
  for (int64_t i = 0; i < n; i++)
    largest = fmax(largest, a[i * n + i]);
  return largest;
}

static bw_status take(void *data, int64_t begin, int64_t end, int worker) {
  const taking *t = data;
  bwi_stars *s = t->s;
  double *a = t->works + worker * s->longest * s->longest;
  for (int64_t star = begin; star < end; star++) {
    int64_t n = 3 * (s->member_start[star + 1] - s->member_start[star]);
    double *to = s->inverse + s->inverse_start[star];
    if (bw_cancelled(t->context))
      return bw_check_cancel(t->context);
    collect(t, star, n, a);
    double largest = largest_of_diagonal(n, a);
    keep_unknowns(t, star, n, largest, a);
    if (!invert(n, a) || !(largest * largest_of_diagonal(n, a) < WORST)) {
      t->failed[worker] = true;
      continue;
    }
    keep_unknowns(t, star, n, 0, a);
    for (int64_t i = 0; i < n; i++)
      for (int64_t j = 0; j < (i + LANES) / LANES * LANES; j++)
        *to++ = j > i ? 0 : 0.5 * (a[i * n + j] + a[j * n + i]);
  }
  return BW_OK;
}

static bw_status take_numbers(bw_context *context, const bwi_two_level *l, const double *stiffness,
                              bwi_stars *s, bool *usable) {
  bw_status status = BW_OK;
  int64_t workers = bw_threads(context), links = s->link_start[s->member_start[s->count]];
  taking t = {.context = context, .l = l, .s = s, .stiffness = stiffness};
  s->link = BW_NEW(context, int32_t, links);
  s->coupling = BW_NEW0(context, float, 9 * links + LANES);
  s->inverse = BW_NEW(context, double, s->inverse_start[s->count]);
  t.works = BW_NEW(context, double, workers * s->longest * s->longest);
  t.failed = BW_NEW0(context, bool, workers);
  BW_TRY_MEMORY(s->link && s->coupling && s->inverse && t.works && t.failed);
  status = bw_parallel(context, s->count, GRAIN, take, &t);
  *usable = true;
  for (int64_t k = 0; k < workers; k++)
    *usable &= !t.failed[k];
done:
  bw_free(t.works);
  bw_free(t.failed);
  return status;
}

bw_status bwi_stars_create(bw_context *context, const bwi_two_level *l, const double *stiffness,
                           bwi_stars **out) {
  bw_status status = BW_OK;
  bool usable = false;
  bwi_stars *s = BW_NEW0(context, bwi_stars, 1);
  *out = NULL;
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &stars_kind);
  s->count = bwi_coarse_corners(l->coarse);
  s->rows = l->smoother->count;
  s->corner = BW_NEW(context, int32_t, s->count);
  s->member_start = BW_NEW0(context, int64_t, (int64_t)s->count + 1);
  s->inverse_start = BW_NEW0(context, int64_t, (int64_t)s->count + 1);
  BW_TRY_MEMORY(s->corner && s->member_start && s->inverse_start);
  BW_TRY(colour(context, l, s));
  BW_TRY(list_members(context, l, s));
  BW_TRY(take_numbers(context, l, stiffness, s, &usable));
  if (usable)
    *out = bw_retain(s);
done:
  bw_release(s);
  return status;
}

/* ---- sweeps ---------------------------------------------------------------------------------- */

typedef struct sweep {
  const bwi_stars *s;
  int width;
  int64_t first; /* star of the colour */
  const float *r;
  float *z, *residual;
  double *works;   /* workers x 2 x numbers */
  int64_t numbers; /* of a field of a star */
} sweep;

typedef float lanes __attribute__((vector_size(16), aligned(4), may_alias));
typedef double wide_lanes __attribute__((vector_size(32), aligned(8), may_alias));

/* y = A^-1 x of a star, n numbers of each of `width` fields. For one field in whole registers. */
static inline __attribute__((always_inline)) void apply(const double *a, int64_t n, int width,
                                                        const double *x, double *y) {
  memset(y, 0, (size_t)((n + LANES) * width) * sizeof *y);
  for (int64_t i = 0; i < n; i++) {
    int64_t length = (i + LANES) / LANES * LANES;
    if (width == 1) {
      wide_lanes sum = {0, 0, 0, 0}, own = {x[i], x[i], x[i], x[i]};
      for (int64_t j = 0; j < length; j += LANES) {
        wide_lanes entries = *(const wide_lanes *)(a + j);
        sum += entries * *(const wide_lanes *)(x + j);
        *(wide_lanes *)(y + j) += entries * own;
      }
      y[i] += sum[0] + sum[1] + sum[2] + sum[3] - a[i] * x[i]; /* the diagonal is in both */
    } else
      for (int64_t j = 0; j <= i; j++)
        for (int f = 0; f < width; f++) {
          y[i * width + f] += a[j] * x[j * width + f];
          y[j * width + f] += j < i ? a[j] * x[i * width + f] : 0;
        }
    a += length;
  }
}

/* x of a member -= what the neighbours outside of the star do to it. */
static inline __attribute__((always_inline)) void pull(const sweep *w, int64_t m, int width,
                                                       double *x) {
  const bwi_stars *s = w->s;
  lanes sum[3] = {{0}};
  for (int64_t e = s->link_start[m]; e < s->link_start[m + 1]; e++) {
    const float *a = s->coupling + 9 * e, *z = w->z + 3 * width * (int64_t)s->link[e];
    for (int c = 0; c < 3 && width == 1; c++) /* the last number of each is another's */
      sum[c] += *(const lanes *)(a + 3 * c) * *(const lanes *)z;
    for (int c = 0; c < 3 && width > 1; c++)
      for (int f = 0; f < width; f++)
        x[c * width + f] -= (double)(a[3 * c] * z[f] + a[3 * c + 1] * z[width + f] +
                                     a[3 * c + 2] * z[2 * width + f]);
  }
  for (int c = 0; c < 3 && width == 1; c++)
    x[c] -= (double)(sum[c][0] + sum[c][1] + sum[c][2]);
}

/* The residual of these neighbours -= what a change y of a member does to them. */
static inline __attribute__((always_inline)) void push(const sweep *w, int64_t m, int width,
                                                       const double *wide) {
  const bwi_stars *s = w->s;
  float y[3 * BWI_SMOOTHER_SIDES];
  for (int i = 0; i < 3 * width; i++)
    y[i] = (float)wide[i];
  for (int64_t e = s->link_start[m]; e < s->link_start[m + 1]; e++) {
    const float *a = s->coupling + 9 * e;
    float *to = w->residual + 3 * width * (int64_t)s->link[e];
    if (width == 1) {
      lanes sum = *(const lanes *)a * y[0] + *(const lanes *)(a + 3) * y[1] +
                  *(const lanes *)(a + 6) * y[2];
      for (int d = 0; d < 3; d++)
        to[d] -= sum[d];
      continue;
    }
    for (int d = 0; d < 3; d++)
      for (int f = 0; f < width; f++)
        to[d * width + f] -= a[d] * y[f] + a[3 + d] * y[width + f] + a[6 + d] * y[2 * width + f];
  }
}

static inline __attribute__((always_inline)) void sweep_star(const sweep *w, int64_t star,
                                                             int width, bool backwards, double *x) {
  const bwi_stars *s = w->s;
  const int64_t begin = s->member_start[star], end = s->member_start[star + 1];
  const int64_t of_node = 3 * width;
  double *y = x + w->numbers;
  for (int64_t m = begin; m < end; m++) {
    double *to = x + of_node * (m - begin);
    const float *from = (backwards ? w->r : w->residual) + of_node * s->member[m];
    for (int64_t i = 0; i < of_node; i++)
      to[i] = (double)from[i];
    if (backwards)
      pull(w, m, width, to);
  }
  apply(s->inverse + s->inverse_start[star], 3 * (end - begin), width, x, y);
  for (int64_t m = begin; m < end; m++) {
    const double *from = y + of_node * (m - begin);
    float *z = w->z + of_node * s->member[m];
    for (int64_t i = 0; i < of_node; i++)
      z[i] = (float)(backwards ? from[i] : (double)z[i] + from[i]);
    if (backwards)
      continue;
    float *own = w->residual + of_node * s->member[m];
    for (int64_t i = 0; i < of_node; i++)
      own[i] = 0;
    push(w, m, width, from);
  }
}

/* Stars of a colour. */
static bw_status sweep_stars(void *data, int64_t begin, int64_t end, int worker) {
  const sweep *w = data;
  double *work = w->works + 2 * w->numbers * worker;
  bool backwards = !w->residual;
  for (int64_t k = w->first + begin; k < w->first + end; k++)
    switch (w->width) {
    case 1:
      sweep_star(w, k, 1, backwards, work);
      break;
    case 4:
      sweep_star(w, k, 4, backwards, work);
      break;
    case 8:
      sweep_star(w, k, 8, backwards, work);
      break;
    default:
      sweep_star(w, k, 12, backwards, work);
      break;
    }
  return BW_OK;
}

static bw_status sweep_colours(bw_context *context, sweep *w) {
  bw_status status = BW_OK;
  const bwi_stars *s = w->s;
  w->numbers = (s->longest + LANES) * w->width;
  w->works = BW_NEW0(context, double, 2 * w->numbers * bw_threads(context));
  if (!w->works)
    return BW_MEMORY;
  for (int32_t k = 0; k < s->colour_count; k++) {
    int32_t colour = w->residual ? k : s->colour_count - 1 - k;
    w->first = s->colour_start[colour];
    BW_TRY(bw_parallel(context, s->colour_start[colour + 1] - w->first, GRAIN, sweep_stars, w));
  }
done:
  bw_free(w->works);
  return status;
}

bw_status bwi_stars_forward(bw_context *context, const bwi_stars *s, int width, const float *r,
                            float *z, float *residual) {
  size_t size = 3 * (size_t)s->rows * (size_t)width * sizeof *r;
  memset(z, 0, size);
  memcpy(residual, r, size);
  return sweep_colours(context, &(sweep){.s = s, .width = width, .z = z, .residual = residual});
}

bw_status bwi_stars_backward(bw_context *context, const bwi_stars *s, int width, const float *r,
                             float *z) {
  return sweep_colours(context, &(sweep){.s = s, .width = width, .r = r, .z = z});
}
