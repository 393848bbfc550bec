/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Coulomb's law in the mean of hat functions by a semi-smooth Newton method (Alart and Curnier
 * 1991; Hueeber, Stadler and Wohlmuth 2008), docs/theory/contact.md, eq. 6 to 9. All is scaled so
 * that the compliance of each row is 1: x = p / D, and a gap is the pressure that closes it. The
 * equations of a step, J x + E y = r and E^T x - epsilon y = -load, are solved for x first. */
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
  double *q, *e;     /* scaled; e (motions x rows) by columns */
  double *scale;     /* (rows) D, alike for both tangents of a candidate */
  double *spring;    /* (motions) epsilon, scaled, */
  double *stretch;   /* (motions) a = stretch y, */
  double *load;      /* (motions) and the load with the springs' centre */
  double *cone;      /* (count) coefficient of friction of x */
  double *x, *y, *w; /* (rows), (motions), (rows) */
  double *new_x, *new_y;
  int *unknown;  /* (rows) place among the unknowns, or -1; where it slips that across is of both */
  double *slide; /* (count x 3) where it slips: the direction, and beta of eq. 8 */
  double *matrix; /* (unknowns x unknowns) J */
  double *right;  /* (motions + 1) x (unknowns): E, and r; then J^-1 E and J^-1 r */
  double *line;   /* (rows) */
  double *small;  /* (motions x motions) */
  int *pivot;
} newton;

static void clear(newton *v) {
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
  bw_free(v->slide);
  bw_free(v->matrix);
  bw_free(v->right);
  bw_free(v->line);
  bw_free(v->small);
  bw_free(v->pivot);
}

static bw_status prepare(bw_context *context, bwi_friction *f, newton *v) {
  bw_status status = BW_OK;
  int n = f->rows, m = f->motions;
  *v = (newton){.problem = f};
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
  v->slide = BW_NEW(context, double, 3 * (int64_t)f->count);
  v->matrix = BW_NEW(context, double, (int64_t)n *n);
  v->right = BW_NEW(context, double, (int64_t)n *(m + 1));
  v->line = BW_NEW(context, double, n);
  v->small = BW_NEW(context, double, (int64_t)m *m);
  v->pivot = BW_NEW(context, int, n + m);
  BW_TRY_MEMORY(v->q && v->e && v->scale && v->spring && v->stretch && v->load && v->cone && v->x &&
                v->y && v->w && v->new_x && v->new_y && v->unknown && v->slide && v->matrix &&
                v->right && v->line && v->small && v->pivot);
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
    v->line[r] = v->scale[r] * x[r];
  for (int r = 0; r < n; r++)
    v->w[r] =
        v->q[r] + v->scale[r] * bwi_dot(n, v->problem->s + (int64_t)r * n, v->line) + shift * x[r];
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

/* Where candidate i slips, x of its rows is p and t = cone p d + tau e, with the unknowns p and
 * tau: along the direction d, eq. 8 says that t is on the cone. */
static bool slips(const newton *v, int i) {
  const bwi_friction *f = v->problem;
  return f->state[i] == BWI_SLIPS && f->first[i + 1] - f->first[i] == 3;
}

/* Equation `place`: the sum over d of part[d] times w of row + d, in the unknowns. */
static void add_gap(newton *v, int place, int row, int width, const double *part, int held) {
  const bwi_friction *f = v->problem;
  int n = f->rows, m = f->motions;
  double *to = v->matrix + (int64_t)place * held, *line = v->line;
  memset(line, 0, (size_t)n * sizeof *line);
  for (int d = 0; d < width; d++) {
    const double *s = f->s + (int64_t)(row + d) * n;
    double factor = part[d] * v->scale[row + d];
    for (int r = 0; r < n; r++)
      line[r] += factor * s[r];
  }
  for (int r = 0; r < n; r++)
    line[r] *= v->scale[r];
  for (int d = 0; d < width; d++)
    line[row + d] += part[d] * shift;
  for (int i = 0; i < f->count; i++) {
    int r = f->first[i], end = f->first[i + 1];
    const double *d = v->slide + 3 * (int64_t)i;
    if (f->state[i] == BWI_OPEN)
      continue;
    to[v->unknown[r]] += line[r];
    if (slips(v, i)) {
      to[v->unknown[r]] += v->cone[i] * (d[0] * line[r + 1] + d[1] * line[r + 2]);
      to[v->unknown[r + 1]] += d[0] * line[r + 2] - d[1] * line[r + 1];
    } else
      while (++r < end)
        to[v->unknown[r]] += line[r];
  }
  for (int k = 0; k <= m; k++) {
    const double *from = k < m ? v->e + (int64_t)k * n + row : v->q + row;
    v->right[(int64_t)k * held + place] = (k < m ? 1 : -1) * bwi_dot(width, part, from);
  }
}

/* J by rows, E and r of Newton's method about x and w; how many unknowns. */
static int assemble(newton *v) {
  const bwi_friction *f = v->problem;
  static const double whole = 1;
  int held = 0;
  for (int i = 0; i < f->count; i++) {
    int r = f->first[i], end = f->first[i + 1];
    double *d = v->slide + 3 * (int64_t)i;
    if (slips(v, i)) {
      double t[2] = {v->x[r + 1] - v->w[r + 1], v->x[r + 2] - v->w[r + 2]};
      double length = hypot(t[0], t[1]), radius = v->cone[i] * fmax(v->x[r] - v->w[r], 0);
      d[0] = length > 0 ? t[0] / length : 1;
      d[1] = length > 0 ? t[1] / length : 0;
      d[2] = length > 0 ? fmin(radius / length, 1) : 0;
      v->unknown[r] = held++;
      v->unknown[r + 1] = v->unknown[r + 2] = held++;
    } else
      for (; r < end; r++)
        v->unknown[r] = f->state[i] == BWI_OPEN ? -1 : held++;
  }
  memset(v->matrix, 0, (size_t)held * (size_t)held * sizeof *v->matrix);
  for (int i = 0; i < f->count; i++) {
    int r = f->first[i], end = f->first[i + 1];
    if (f->state[i] == BWI_OPEN)
      continue;
    add_gap(v, v->unknown[r], r, 1, &whole, held);
    if (slips(v, i)) { /* tau - beta (tau - w e) = 0 */
      const double *d = v->slide + 3 * (int64_t)i;
      const double across[2] = {-d[2] * d[1], d[2] * d[0]};
      int place = v->unknown[r + 1];
      add_gap(v, place, r + 1, 2, across, held);
      v->matrix[(int64_t)place * held + place] += 1 - d[2];
    } else
      while (++r < end)
        add_gap(v, v->unknown[r], r, 1, &whole, held);
  }
  return held;
}

/* x (rows) of the unknowns. */
static void expand(const newton *v, const double *unknown, double *x) {
  const bwi_friction *f = v->problem;
  for (int r = 0; r < f->rows; r++)
    x[r] = v->unknown[r] < 0 ? 0 : unknown[v->unknown[r]];
  for (int i = 0; i < f->count; i++)
    if (slips(v, i)) {
      int r = f->first[i];
      const double *d = v->slide + 3 * (int64_t)i;
      double along = v->cone[i] * x[r], across = x[r + 1];
      x[r + 1] = along * d[0] - across * d[1];
      x[r + 2] = along * d[1] + across * d[0];
    }
}

/* A step of Newton's method from x, y and w to new_x, new_y, and H there; false where it is not
 * finite. */
static bool step(newton *v) {
  bwi_friction *f = v->problem;
  int n = f->rows, m = f->motions, sides = m + 1, one = 1, info = 0, held = assemble(v);
  double *force = v->new_y, *solved = v->right + (int64_t)m * held;
  if (held > 0) { /* J by rows is its transpose by columns */
    dgetrf_(&held, &held, v->matrix, &held, v->pivot, &info);
    if (info == 0)
      dgetrs_("T", &held, &sides, v->matrix, &held, v->pivot, v->right, &held, &info);
  }
  if (info != 0)
    return false;
  for (int l = 0; l <= m; l++) {
    expand(v, v->right + (int64_t)l * held, v->new_x);
    for (int k = 0; k < m; k++) {
      double sum = bwi_dot(n, v->e + (int64_t)k * n, v->new_x);
      if (l < m) {
        f->h[(int64_t)k * m + l] = sum / (v->stretch[k] * v->stretch[l]);
        v->small[(int64_t)l * m + k] = sum + (k == l ? v->spring[k] : 0);
      } else
        force[k] = v->load[k] + sum;
    }
  }
  if (m > 0) /* (H + epsilon) y = load + E^T J^-1 r */
    dgesv_(&m, &one, v->small, &m, v->pivot, force, &m, &info);
  for (int k = 0; k < m; k++)
    for (int u = 0; u < held; u++)
      solved[u] -= v->new_y[k] * v->right[(int64_t)k * held + u];
  expand(v, solved, v->new_x);
  return info == 0 && isfinite(bwi_dot(n, v->new_x, v->new_x) + bwi_dot(m, v->new_y, v->new_y));
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
      const double *s = f->s + (int64_t)(r + d) * n;
      for (int row = 0; row < n && change != 0; row++)
        v->w[row] += change * v->scale[r + d] * s[row] * v->scale[row];
      v->w[r + d] += change * shift;
      v->x[r + d] = now[d];
    }
  }
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
done:
  bwi_blas_leave();
  clear(&v);
  bw_free(trial);
  return status;
}
