/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Coulomb's law in the mean of hat functions by a semi-smooth Newton method (Alart and Curnier
 * 1991; Hueeber, Stadler and Wohlmuth 2008), docs/theory/contact.md, eq. 6 to 9. All is scaled so
 * that the compliance of each row is 1: x = p / D, and a gap is the pressure that closes it. */
#include <math.h>
#include <string.h>

#include "base/blas.h"
#include "base/dense.h"
#include "contact/internal.h"
#include "linear/blas.h"

enum {
  FULL_STEPS = 30,  /* Newton steps without a line search, */
  SHORT_STEPS = 60, /* then with one, */
  HALVINGS = 6,     /* which takes the best of so many lengths, */
  SWEEPS = 25,      /* and where it ends, so many sweeps candidate by candidate */
  MOST_STEPS = 400  /* in all */
};

static const double shift = 1e-13;     /* of the compliance: redundant candidates are singular */
static const double converged = 1e-10; /* of the largest pressure */

typedef struct newton {
  bwi_friction *problem;
  double *s, *q, *e; /* scaled; e (motions x rows) by columns */
  double *scale;     /* (rows) D, alike for both tangents of a candidate */
  double *spring;    /* (motions) epsilon, scaled, */
  double *stretch;   /* (motions) a = stretch y, */
  double *load;      /* (motions) and the load with the springs' centre */
  double *cone;      /* (count) coefficient of friction of x */
  double *x, *y, *w; /* (rows), (motions), (rows) */
  double *new_x, *new_y;
  int *unknown; /* (rows) place among the unknowns, or -1 */
  double *matrix, *right;
  int *pivot;
} newton;

static void clear(newton *v) {
  bw_free(v->s);
  bw_free(v->q);
  bw_free(v->e);
  bw_free(v->scale);
  bw_free(v->spring);
  bw_free(v->stretch);
  bw_free(v->load);
  bw_free(v->cone);
  bw_free(v->x);
  bw_free(v->y);
  bw_free(v->w);
  bw_free(v->new_x);
  bw_free(v->new_y);
  bw_free(v->unknown);
  bw_free(v->matrix);
  bw_free(v->right);
  bw_free(v->pivot);
}

static bw_status prepare(bw_context *context, bwi_friction *f, newton *v) {
  bw_status status = BW_OK;
  int n = f->rows, m = f->motions;
  *v = (newton){.problem = f};
  v->s = BW_NEW(context, double, (int64_t)n *n);
  v->q = BW_NEW(context, double, n);
  v->e = BW_NEW(context, double, (int64_t)n *m);
  v->scale = BW_NEW(context, double, n);
  v->spring = BW_NEW(context, double, m);
  v->stretch = BW_NEW(context, double, m);
  v->load = BW_NEW(context, double, m);
  v->cone = BW_NEW(context, double, f->count);
  v->x = BW_NEW(context, double, n);
  v->y = BW_NEW(context, double, m);
  v->w = BW_NEW(context, double, n);
  v->new_x = BW_NEW(context, double, n);
  v->new_y = BW_NEW(context, double, m);
  v->unknown = BW_NEW(context, int, n);
  v->matrix = BW_NEW(context, double, (int64_t)(n + m) * (n + m));
  v->right = BW_NEW(context, double, n + m);
  v->pivot = BW_NEW(context, int, n + m);
  BW_TRY_MEMORY(v->s && v->q && v->e && v->scale && v->spring && v->stretch && v->load && v->cone &&
                v->x && v->y && v->w && v->new_x && v->new_y && v->unknown && v->matrix &&
                v->right && v->pivot);
  for (int i = 0; i < f->count; i++) {
    int r = f->first[i];
    double normal = f->s[(int64_t)r * n + r];
    v->scale[r] = 1 / sqrt(normal);
    v->cone[i] = 0;
    if (f->first[i + 1] - r < 3)
      continue;
    double along = fmax(f->s[(int64_t)(r + 1) * (n + 1)], f->s[(int64_t)(r + 2) * (n + 1)]);
    v->scale[r + 1] = v->scale[r + 2] = 1 / sqrt(fmax(along, shift * normal));
    v->cone[i] = f->friction[i] * v->scale[r] / v->scale[r + 1];
  }
  for (int r = 0; r < n; r++) {
    for (int c = 0; c < n; c++)
      v->s[(int64_t)r * n + c] = v->scale[r] * f->s[(int64_t)r * n + c] * v->scale[c];
    v->s[(int64_t)r * n + r] += shift;
    v->q[r] = v->scale[r] * f->q[r];
    v->x[r] = f->p[r] / v->scale[r];
  }
  for (int k = 0; k < m; k++) {
    double *column = v->e + (int64_t)k * n, length;
    for (int r = 0; r < n; r++)
      column[r] = v->scale[r] * f->e[(int64_t)r * m + k];
    length = sqrt(bwi_dot(n, column, column));
    v->stretch[k] = length > 0 ? 1 / length : 1;
    for (int r = 0; r < n; r++)
      column[r] *= v->stretch[k];
    v->spring[k] = f->epsilon * v->stretch[k] * v->stretch[k];
    v->load[k] = (f->load[k] + f->epsilon * f->centre[k]) * v->stretch[k];
    v->y[k] = f->a[k] / v->stretch[k];
  }
done:
  return status;
}

/* w of x and y. */
static void measure(newton *v, const double *x, const double *y) {
  int n = v->problem->rows;
  for (int r = 0; r < n; r++)
    v->w[r] = v->q[r] + bwi_dot(n, v->s + (int64_t)r * n, x);
  for (int k = 0; k < v->problem->motions; k++)
    for (int r = 0; r < n; r++)
      v->w[r] += v->e[(int64_t)k * n + r] * y[k];
}

/* How far candidate i is from its law: x less its projection on the cone of x - w. */
static double off(const newton *v, const double *x, int i) {
  int r = v->problem->first[i];
  double normal = fmax(0, x[r] - v->w[r]), square = (x[r] - normal) * (x[r] - normal);
  if (v->problem->first[i + 1] - r == 3) {
    double t[2] = {x[r + 1] - v->w[r + 1], x[r + 2] - v->w[r + 2]}, length = hypot(t[0], t[1]);
    double factor = length > v->cone[i] * normal ? v->cone[i] * normal / length : 1;
    for (int k = 0; k < 2; k++)
      square += (x[r + 1 + k] - factor * t[k]) * (x[r + 1 + k] - factor * t[k]);
  }
  return sqrt(square);
}

static double merit(newton *v, const double *x, const double *y) {
  double sum = 0;
  measure(v, x, y);
  for (int i = 0; i < v->problem->count; i++)
    sum += off(v, x, i) * off(v, x, i);
  return sqrt(sum);
}

/* Whether each candidate is at its law, for w of x; else which is worst. */
static bool at_law(newton *v) {
  bwi_friction *f = v->problem;
  double largest = 0, worst = 0;
  bool all = true;
  for (int i = 0; i < f->count; i++)
    largest = fmax(largest, fabs(v->x[f->first[i]]));
  for (int i = 0; i < f->count; i++) {
    double by = off(v, v->x, i), slack = f->slack[i] * v->scale[f->first[i]];
    all = all && by <= fmax(converged * largest, slack);
    if (!(by <= worst)) {
      worst = by;
      f->worst = i;
    }
  }
  f->change = largest > 0 ? worst / largest : 0;
  return all;
}

static void take_states(newton *v) {
  bwi_friction *f = v->problem;
  for (int i = 0; i < f->count; i++) {
    int r = f->first[i];
    double normal = v->x[r] - v->w[r];
    uint8_t state = normal > 0 ? BWI_SLIPS : BWI_OPEN;
    if (normal > 0 && f->first[i + 1] - r == 3 &&
        hypot(v->x[r + 1] - v->w[r + 1], v->x[r + 2] - v->w[r + 2]) <= v->cone[i] * normal)
      state = BWI_STICKS;
    f->changes += state != f->state[i];
    f->state[i] = state;
  }
}

/* Row `place` of the equations: sum over d of part[d] times w of row + d. */
static void add_gap(newton *v, int place, int row, int width, const double *part, int total) {
  int n = v->problem->rows;
  for (int d = 0; d < width; d++) {
    const double *s = v->s + (int64_t)(row + d) * n;
    for (int r = 0; r < n && part[d] != 0; r++)
      if (v->unknown[r] >= 0)
        v->matrix[(int64_t)v->unknown[r] * total + place] += part[d] * s[r];
    for (int k = 0; k < v->problem->motions; k++)
      v->matrix[(int64_t)(total - v->problem->motions + k) * total + place] +=
          part[d] * v->e[(int64_t)k * n + row + d];
    v->right[place] -= part[d] * v->q[row + d];
  }
}

/* The equations of Newton's method about x and w, by columns, for the rows that are not open and
 * then y; *held: how many rows. */
static int assemble(newton *v, int *rows_held) {
  const bwi_friction *f = v->problem;
  int n = f->rows, m = f->motions, held = 0;
  for (int i = 0; i < f->count; i++)
    for (int r = f->first[i]; r < f->first[i + 1]; r++)
      v->unknown[r] = f->state[i] == BWI_OPEN ? -1 : held++;
  int total = held + m;
  memset(v->matrix, 0, (size_t)total * (size_t)total * sizeof *v->matrix);
  memset(v->right, 0, (size_t)total * sizeof *v->right);
  for (int i = 0; i < f->count; i++) {
    int r = f->first[i], place = v->unknown[r];
    static const double whole = 1;
    if (place < 0)
      continue;
    add_gap(v, place, r, 1, &whole, total);
    if (f->first[i + 1] - r < 3)
      continue;
    if (f->state[i] == BWI_STICKS) {
      add_gap(v, place + 1, r + 1, 1, &whole, total);
      add_gap(v, place + 2, r + 2, 1, &whole, total);
      continue;
    }
    /* t - beta P (t - w) - cone p d = 0, where d is the direction of t - w and P = 1 - d d^T */
    double t[2] = {v->x[r + 1] - v->w[r + 1], v->x[r + 2] - v->w[r + 2]};
    double length = hypot(t[0], t[1]), radius = v->cone[i] * fmax(v->x[r] - v->w[r], 0);
    double beta = length > 0 ? fmin(radius / length, 1) : 0;
    double d[2] = {length > 0 ? t[0] / length : 1, length > 0 ? t[1] / length : 0};
    for (int k = 0; k < 2; k++) {
      double across[2] = {beta * ((k == 0) - d[k] * d[0]), beta * ((k == 1) - d[k] * d[1])};
      for (int l = 0; l < 2; l++)
        v->matrix[(int64_t)(place + 1 + l) * total + place + 1 + k] += (k == l) - across[l];
      v->matrix[(int64_t)place * total + place + 1 + k] -= v->cone[i] * d[k];
      add_gap(v, place + 1 + k, r + 1, 2, across, total);
    }
  }
  for (int k = 0; k < m; k++) {
    for (int r = 0; r < n; r++)
      if (v->unknown[r] >= 0)
        v->matrix[(int64_t)v->unknown[r] * total + held + k] = v->e[(int64_t)k * n + r];
    v->matrix[(int64_t)(held + k) * total + held + k] = -v->spring[k];
    v->right[held + k] = -v->load[k];
  }
  *rows_held = held;
  return total;
}

/* A step of Newton's method from x, y and w to new_x, new_y; false where it is not finite. */
static bool step(newton *v) {
  int held, one = 1, info = 0, total = assemble(v, &held);
  if (total > 0)
    dgesv_(&total, &one, v->matrix, &total, v->pivot, v->right, &total, &info);
  for (int r = 0; r < v->problem->rows; r++)
    v->new_x[r] = v->unknown[r] < 0 ? 0 : v->right[v->unknown[r]];
  memcpy(v->new_y, v->right + held, (size_t)v->problem->motions * sizeof *v->new_y);
  return info == 0 && isfinite(bwi_dot(total, v->right, v->right));
}

/* x, y += length (new_x - x, new_y - y) */
static void move(newton *v, double length) {
  for (int r = 0; r < v->problem->rows; r++)
    v->x[r] += length * (v->new_x[r] - v->x[r]);
  for (int k = 0; k < v->problem->motions; k++)
    v->y[k] += length * (v->new_y[k] - v->y[k]);
}

/* The best of some lengths of the step. */
static void search(newton *v, double *trial) {
  int n = v->problem->rows, m = v->problem->motions;
  double best = INFINITY, taken = 1, length = 1;
  for (int i = 0; i <= HALVINGS; i++, length *= 0.5) {
    for (int r = 0; r < n; r++)
      trial[r] = v->x[r] + length * (v->new_x[r] - v->x[r]);
    for (int k = 0; k < m; k++)
      trial[n + k] = v->y[k] + length * (v->new_y[k] - v->y[k]);
    double value = merit(v, trial, trial + n);
    if (value < best) {
      best = value;
      taken = length;
    }
  }
  move(v, taken);
}

/* Each candidate in turn takes the place on the cone that its own compliance asks for: slow, and it
 * comes near to where it must. */
static void sweep(newton *v) {
  bwi_friction *f = v->problem;
  int n = f->rows;
  for (int i = 0; i < f->count; i++) {
    int r = f->first[i], width = f->first[i + 1] - r;
    double now[3];
    for (int d = 0; d < width; d++)
      now[d] = v->x[r + d];
    now[0] = fmax(0, v->x[r] - v->w[r]);
    if (width == 3) {
      double t[2] = {v->x[r + 1] - v->w[r + 1], v->x[r + 2] - v->w[r + 2]};
      double length = hypot(t[0], t[1]), radius = v->cone[i] * now[0];
      for (int k = 0; k < 2; k++)
        now[1 + k] = length > radius ? radius / length * t[k] : t[k];
    }
    for (int d = 0; d < width; d++) {
      double change = now[d] - v->x[r + d];
      for (int row = 0; row < n && change != 0; row++)
        v->w[row] += change * v->s[(int64_t)(r + d) * n + row];
      v->x[r + d] = now[d];
    }
  }
}

/* H: how the forces on motions change with these. */
static bool take_stiffness(newton *v) {
  bwi_friction *f = v->problem;
  int m = f->motions, held, info = 0, total = assemble(v, &held);
  double *column = v->matrix + (int64_t)held * total; /* of E, then of J^-1 E */
  if (held > 0 && m > 0)
    dgesv_(&held, &m, v->matrix, &total, v->pivot, column, &total, &info);
  for (int k = 0; k < m; k++)
    for (int l = 0; l < m; l++) {
      double sum = 0;
      for (int r = 0; r < f->rows; r++)
        if (v->unknown[r] >= 0)
          sum += v->e[(int64_t)k * f->rows + r] * column[(int64_t)l * total + v->unknown[r]];
      f->h[(int64_t)k * m + l] = sum / (v->stretch[k] * v->stretch[l]);
    }
  return info == 0;
}

/* Whether the states have been these before the last step, so that full steps go round in a ring.
 * `seen` has a hash (FNV) of those of each step. */
static bool goes_round(const bwi_friction *f, int steps, uint64_t *seen) {
  bool before = false;
  seen[steps] = 14695981039346656037u;
  for (int i = 0; i < f->count; i++)
    seen[steps] = (seen[steps] ^ f->state[i]) * 1099511628211u;
  for (int i = 0; i < steps - 1; i++)
    before = before || (seen[i] == seen[steps] && seen[steps - 1] != seen[steps]);
  return before;
}

bw_status bwi_friction_solve(bw_context *context, bwi_friction *f) {
  bw_status status = BW_OK;
  newton v = {0};
  double *trial = BW_NEW(context, double, f->rows + f->motions);
  bwi_blas_enter();
  BW_TRY_MEMORY(trial);
  BW_TRY(prepare(context, f, &v));
  bool done = false, near = false;
  uint64_t seen[FULL_STEPS];
  for (int i = 0, phase = 0; i < MOST_STEPS && !done; i++, phase++) {
    BW_TRY(bw_check_cancel(context));
    measure(&v, v.x, v.y);
    if (phase == FULL_STEPS + SHORT_STEPS) {
      phase = 0;
      for (int k = 0; k < SWEEPS; k++)
        sweep(&v);
    }
    take_states(&v);
    if (phase < FULL_STEPS && goes_round(f, phase, seen))
      phase = FULL_STEPS;
    if (phase == FULL_STEPS && !f->patient)
      break;
    if (!step(&v)) {
      for (int k = 0; k < SWEEPS; k++)
        sweep(&v);
      continue;
    }
    bool full = near || phase < FULL_STEPS;
    if (full)
      move(&v, 1);
    else
      search(&v, trial);
    measure(&v, v.x, v.y);
    near = at_law(&v);
    done = near && full;
  }
  if (!done)
    BW_TRY(BW_CONVERGENCE);
  take_states(&v);
  for (int i = 0; i < f->count; i++) { /* on the cone, without rounding */
    int r = f->first[i];
    double normal = fmax(v.x[r], 0), most = v.cone[i] * normal, length = 0;
    bool open = f->state[i] == BWI_OPEN || normal == 0;
    if (open)
      f->state[i] = BWI_OPEN;
    if (f->first[i + 1] - r == 3)
      length = hypot(v.x[r + 1], v.x[r + 2]);
    for (int k = r; k < f->first[i + 1]; k++)
      v.x[k] *= open ? 0 : k > r && length > most ? most / length : 1;
  }
  for (int r = 0; r < f->rows; r++)
    f->p[r] = v.scale[r] * v.x[r];
  for (int k = 0; k < f->motions; k++)
    f->a[k] = v.stretch[k] * v.y[k];
  if (!take_stiffness(&v))
    BW_TRY(bw_fail(context, BW_SINGULAR,
                   "the compliance of %d candidates of contact is not positive definite: parts of "
                   "the body are nearly without stiffness, or nearly without a support",
                   f->count));
done:
  bwi_blas_leave();
  clear(&v);
  bw_free(trial);
  return status;
}
