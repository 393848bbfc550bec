/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Coarsening of a surface that never makes it intersect itself: edges shorter than the wanted
 * length are collapsed, the shortest first, as long as the facets that change stay well shaped,
 * keep their sides, and meet no other facet. Where walls are thinner than the wanted length the
 * surface stays finer instead of cutting through itself.
 *
 * Between passes of collapses, diagonals of nearly flat pairs of facets are exchanged where that
 * makes the worse of the two facets better.
 *
 * A collapsed edge's point goes where the squared distances from the planes of all the facets that
 * ended up in it are least (Garland and Heckbert), drawn a little to the middle of the edge: flat
 * parts stay flat and creases stay in place.
 *
 * Between collapses every point has the list of its corners (corner 3 t + k is place k of triangle
 * t), and every living triangle is entered in all cells of the grid that its box meets. Entries of
 * triangles that have changed since stay behind; boxes are compared before anything else. */
#include "mesh/fill_internal.h"
#include "mesh/mesh_internal.h"
#include "mesh/predicates.h"
#include "mesh/surface_tree.h"

#include <math.h>
#include <string.h>

enum { RING = 64, MOST_CELLS = 512 };

typedef struct entry {
  int32_t triangle;
  int64_t next; /* in the same bucket, or -1 */
} entry;

typedef struct coarse {
  bw_context *context;
  double length;   /* the side of a cell of the grid; edges do not grow much longer than this */
  double shorter;  /* edges shorter than this are collapsed */
  double error;    /* root mean square distance from the planes that a collapse may cause */
  double floor;    /* shapes as good as that are good enough */
  double deadline; /* of bw_seconds: what has been reached by then is handed over */
  bool late;
  int32_t points, triangles;
  double *x; /* relative to `origin` */
  double origin[3];
  int32_t *corner; /* triangles x 3; the first is -1 in a dead triangle */
  double (*quadric)[10];
  int32_t *first, *next; /* corners of a point */
  int64_t *bucket;       /* grid: hash of the cell -> entry */
  uint64_t buckets;      /* a power of two */
  entry *list;
  size_t entries, capacity;
  int32_t *big; /* triangles too large for the grid */
  size_t big_count, big_capacity;
  int32_t *seen; /* per triangle: the last query that met it */
  int32_t query;
} coarse;

static const double *place(const coarse *c, int32_t point) {
  return c->x + 3 * (size_t)point;
}

/* ---- the grid ------------------------------------------------------------------------------- */

static void box_of(const double *const x[3], double low[3], double high[3]) {
  for (int k = 0; k < 3; k++) {
    double a = x[0][k], b = x[1][k], d = x[2][k];
    low[k] = a < b ? (a < d ? a : d) : (b < d ? b : d);
    high[k] = a > b ? (a > d ? a : d) : (b > d ? b : d);
  }
}

static void cells_of(const coarse *c, const double low[3], const double high[3], int64_t from[3],
                     int64_t to[3]) {
  for (int k = 0; k < 3; k++) {
    from[k] = (int64_t)floor(low[k] / c->length);
    to[k] = (int64_t)floor(high[k] / c->length);
  }
}

static uint64_t bucket_of(const coarse *c, int64_t i, int64_t j, int64_t k) {
  uint64_t h = (uint64_t)i * 0x9e3779b97f4a7c15u;
  h = (h ^ h >> 29 ^ (uint64_t)j) * 0xbf58476d1ce4e5b9u;
  h = (h ^ h >> 32 ^ (uint64_t)k) * 0x94d049bb133111ebu;
  return (h ^ h >> 31) & (c->buckets - 1);
}

static bool enter(coarse *c, int32_t triangle) {
  const double *x[3];
  double low[3], high[3];
  int64_t from[3], to[3];
  for (int k = 0; k < 3; k++)
    x[k] = place(c, c->corner[3 * (size_t)triangle + (size_t)k]);
  box_of(x, low, high);
  cells_of(c, low, high, from, to);
  double cells = 1;
  for (int k = 0; k < 3; k++)
    cells *= (double)(to[k] - from[k] + 1);
  if (cells > MOST_CELLS) {
    if (!bw_grow(c->context, (void **)&c->big, &c->big_capacity, c->big_count, 1, sizeof *c->big))
      return false;
    c->big[c->big_count++] = triangle;
    return true;
  }
  if (!bw_grow(c->context, (void **)&c->list, &c->capacity, c->entries, (size_t)cells,
               sizeof *c->list))
    return false;
  for (int64_t i = from[0]; i <= to[0]; i++)
    for (int64_t j = from[1]; j <= to[1]; j++)
      for (int64_t k = from[2]; k <= to[2]; k++) {
        int64_t *head = &c->bucket[bucket_of(c, i, j, k)];
        c->list[c->entries] = (entry){triangle, *head};
        *head = (int64_t)c->entries++;
      }
  return true;
}

/* ---- what a new triangle meets -------------------------------------------------------------- */

/* Two triangles of known corners: do they meet elsewhere than in shared corners and sides? See
 * surface_intersect.c for why these tests are enough. */
static bool cross(const int32_t a[3], const double *const xa[3], const int32_t b[3],
                  const double *const xb[3]) {
  int shared = 0, lone_a = 0, lone_b = 0;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      if (a[i] == b[k]) {
        shared++;
        lone_a = i;
        lone_b = k;
      }
  if (shared == 0) {
    for (int i = 0; i < 3; i++)
      if (bwi_segment_meets_triangle(xa[i], xa[(i + 1) % 3], xb[0], xb[1], xb[2]) ||
          bwi_segment_meets_triangle(xb[i], xb[(i + 1) % 3], xa[0], xa[1], xa[2]))
        return true;
    return false;
  }
  if (shared == 1)
    return bwi_segment_meets_triangle(xa[(lone_a + 1) % 3], xa[(lone_a + 2) % 3], xb[0], xb[1],
                                      xb[2]) ||
           bwi_segment_meets_triangle(xb[(lone_b + 1) % 3], xb[(lone_b + 2) % 3], xa[0], xa[1],
                                      xa[2]);
  return false; /* neighbours: folds are refused by their angle */
}

static void normal(const double *const x[3], double n[3]) {
  double a[3], b[3];
  for (int k = 0; k < 3; k++) {
    a[k] = x[1][k] - x[0][k];
    b[k] = x[2][k] - x[0][k];
  }
  bw_cross(a, b, n);
}

/* New triangles that replace the living ones around an edge, all those at its points `kept` and
 * `gone` in a collapse, or the two `pair` in an exchange of the diagonal (kept and gone -1). */
typedef struct change {
  int32_t kept, gone; /* the second point is merged into the first */
  int32_t pair[2];
  double at[3];               /* where a goes */
  double worst, worst_before; /* shapes */
  int32_t count;              /* triangles that stay and change */
  int32_t triangle[2 * RING];
  int32_t corner[2 * RING][3]; /* with `kept` in the place of `gone` */
  const double *x[2 * RING][3];
  double normal[2 * RING][3];
} change;

/* Do two triangles with a common side lie upon each other? */
static bool folded(const double m[3], const double n[3]) {
  return bw_dot(m, n) <= -0.98 * bw_norm(m) * bw_norm(n);
}

/* May the new triangles lie beside that living one? */
static bool clear_of(coarse *c, const change *now, const double box[2 * RING][6], int32_t other) {
  const int32_t *b = c->corner + 3 * (size_t)other;
  if (b[0] < 0 || c->seen[other] == c->query || other == now->pair[0] || other == now->pair[1])
    return true;
  c->seen[other] = c->query;
  const double *xb[3];
  for (int k = 0; k < 3; k++) {
    if (b[k] == now->kept || b[k] == now->gone)
      return true; /* it changes too, or goes */
    xb[k] = place(c, b[k]);
  }
  double low[3], high[3];
  box_of(xb, low, high);
  for (int i = 0; i < now->count; i++) {
    const double *mine = box[i];
    if (low[0] > mine[3] || low[1] > mine[4] || low[2] > mine[5] || high[0] < mine[0] ||
        high[1] < mine[1] || high[2] < mine[2])
      continue;
    int shared = 0;
    for (int k = 0; k < 9; k++)
      shared += now->corner[i][k / 3] == b[k % 3];
    if (shared == 3)
      return false;
    if (shared == 2) {
      double n[3];
      normal(xb, n);
      if (folded(n, now->normal[i]))
        return false;
    } else if (cross(now->corner[i], now->x[i], b, xb)) {
      return false;
    }
  }
  return true;
}

/* The new triangles among themselves. */
static bool fan_is_plain(const change *now) {
  for (int i = 0; i < now->count; i++)
    for (int j = 0; j < i; j++) {
      int shared = 0;
      for (int k = 0; k < 9; k++)
        shared += now->corner[i][k / 3] == now->corner[j][k % 3];
      if (shared > 2 || (shared == 2 && folded(now->normal[i], now->normal[j])) ||
          cross(now->corner[i], now->x[i], now->corner[j], now->x[j]))
        return false;
    }
  return true;
}

static bool meets_nothing(coarse *c, const change *now) {
  double box[2 * RING][6], low[3], high[3];
  int64_t from[3], to[3];
  if (!fan_is_plain(now))
    return false;
  for (int i = 0; i < now->count; i++) {
    box_of(now->x[i], box[i], box[i] + 3);
    for (int k = 0; k < 3; k++) {
      low[k] = i && low[k] < box[i][k] ? low[k] : box[i][k];
      high[k] = i && high[k] > box[i][3 + k] ? high[k] : box[i][3 + k];
    }
  }
  if (now->count == 0)
    return false;
  cells_of(c, low, high, from, to);
  c->query++;
  double cells = 1;
  for (int k = 0; k < 3; k++)
    cells *= (double)(to[k] - from[k] + 1);
  if (cells > 512 + (double)c->triangles) { /* long facets among short ones: faster without grid */
    for (int32_t t = 0; t < c->triangles; t++)
      if (!clear_of(c, now, box, t))
        return false;
    return true;
  }
  for (int64_t p = from[0]; p <= to[0]; p++)
    for (int64_t q = from[1]; q <= to[1]; q++)
      for (int64_t r = from[2]; r <= to[2]; r++)
        for (int64_t e = c->bucket[bucket_of(c, p, q, r)]; e >= 0; e = c->list[e].next)
          if (!clear_of(c, now, box, c->list[e].triangle))
            return false;
  for (size_t e = 0; e < c->big_count; e++)
    if (!clear_of(c, now, box, c->big[e]))
      return false;
  return true;
}

/* ---- collapsing ----------------------------------------------------------------------------- */

/* The living corners of a point; false when there are too many to bother. Dead ones are taken out
 * of the list on the way. */
static bool ring_of(coarse *c, int32_t point, int32_t *ring, int *count) {
  *count = 0;
  int32_t *link = &c->first[point];
  while (*link >= 0) {
    int32_t corner = *link;
    if (c->corner[corner / 3 * 3] < 0) {
      *link = c->next[corner];
      continue;
    }
    if (*count == RING)
      return false;
    ring[(*count)++] = corner;
    link = &c->next[corner];
  }
  return true;
}

/* The neighbours of a point, each once; as many as triangles where the surface is closed. */
static int neighbours_of(const coarse *c, const int32_t *ring, int count, int32_t *list) {
  int found = 0;
  for (int i = 0; i < count; i++) {
    int32_t t = ring[i] / 3 * 3;
    list[found++] = c->corner[t + (ring[i] - t + 1) % 3];
  }
  return found;
}

static bool planes_near(const coarse *c, const double q[10], const double at[3]) {
  double square = q[0] * at[0] * at[0] + q[3] * at[1] * at[1] + q[5] * at[2] * at[2] +
                  2 * (q[1] * at[0] * at[1] + q[2] * at[0] * at[2] + q[4] * at[1] * at[2]) +
                  2 * (q[6] * at[0] + q[7] * at[1] + q[8] * at[2]) + q[9];
  return square <= c->error * c->error * (q[0] + q[3] + q[5]);
}

/* Where a point of that quadric goes that would like to be at m, which is given in `at`: the least
 * of q(x) + w |x - m|^2. False where the planes are too far from there. */
static bool best_place(const coarse *c, const double q[10], double at[3]) {
  double matrix[9], inverse[9], right[3];
  double weight = 0.01 * (q[0] + q[3] + q[5]) + 1e-300;
  memcpy(
      matrix,
      (double[9]){q[0] + weight, q[1], q[2], q[1], q[3] + weight, q[4], q[2], q[4], q[5] + weight},
      sizeof matrix);
  right[0] = -(q[0] * at[0] + q[1] * at[1] + q[2] * at[2] + q[6]);
  right[1] = -(q[1] * at[0] + q[3] * at[1] + q[4] * at[2] + q[7]);
  right[2] = -(q[2] * at[0] + q[4] * at[1] + q[5] * at[2] + q[8]);
  if (bw_inverse3(matrix, inverse) != 0) {
    double step[3];
    for (int k = 0; k < 3; k++)
      step[k] =
          inverse[3 * k] * right[0] + inverse[3 * k + 1] * right[1] + inverse[3 * k + 2] * right[2];
    if (bw_norm(step) < c->length)
      for (int k = 0; k < 3; k++)
        at[k] += step[k];
  }
  return planes_near(c, q, at);
}

static double distance_of(const double *x, const double *y) {
  double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
  return bw_norm(d);
}

/* 1 for an equilateral triangle, 0 for a flat one. */
static double shape_of(const double *const x[3], const double n[3]) {
  double sum = 0;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      double d = x[(i + 1) % 3][k] - x[i][k];
      sum += d * d;
    }
  return sum > 0 ? 3.4641016 * bw_norm(n) / sum : 0;
}

/* Fill in the triangles around the edge after its collapse, and judge their shapes: the worst must
 * be good, or at least as good as the worst before, those that go included. */
static bool plan(const coarse *c, change *now, const int32_t *ring, int count) {
  double worst = 1, worst_before = 1;
  now->count = 0;
  for (int i = 0; i < count; i++) {
    int32_t t = ring[i] / 3;
    const int32_t *old = c->corner + 3 * (size_t)t;
    const double *before[3];
    double n[3], longest = 0, longest_before = 0;
    int both = 0;
    for (int k = 0; k < 3; k++) {
      both += old[k] == now->kept || old[k] == now->gone;
      before[k] = place(c, old[k]);
    }
    normal(before, n);
    double shape_before = shape_of(before, n);
    worst_before = fmin(worst_before, shape_before);
    if (both == 2)
      continue;
    int m = now->count++;
    now->triangle[m] = t;
    for (int k = 0; k < 3; k++) {
      bool moves = old[k] == now->kept || old[k] == now->gone;
      now->corner[m][k] = moves ? now->kept : old[k];
      now->x[m][k] = moves ? now->at : before[k];
    }
    normal(now->x[m], now->normal[m]);
    worst = fmin(worst, shape_of(now->x[m], now->normal[m]));
    for (int k = 0; k < 3; k++) {
      longest = fmax(longest, distance_of(now->x[m][(k + 1) % 3], now->x[m][k]));
      longest_before = fmax(longest_before, distance_of(before[(k + 1) % 3], before[k]));
    }
    if (longest > fmax(1.6 * c->length, 1.05 * longest_before))
      return false;
    double cosine = bw_dot(n, now->normal[m]) / (bw_norm(n) * bw_norm(now->normal[m]) + 1e-300);
    if (cosine < (shape_before > 0.05 ? 0.5 : -0.2))
      return false;
  }
  now->worst = worst;
  now->worst_before = worst_before;
  return worst > 1e-4 && worst >= fmin(c->floor, worst_before);
}

/* Collapse the edge from a to b if that is allowed. */
static bw_status collapse(coarse *c, int32_t a, int32_t b, bool *done) {
  int32_t ring[2 * RING], around_a[RING], around_b[RING];
  int count_a, count_b, common = 0;
  *done = false;
  if (!ring_of(c, a, ring, &count_a) || count_a < 3 || !ring_of(c, b, ring + count_a, &count_b) ||
      count_b < 3)
    return BW_OK;
  int na = neighbours_of(c, ring, count_a, around_a);
  int nb = neighbours_of(c, ring + count_a, count_b, around_b);
  for (int i = 0; i < na; i++)
    for (int k = 0; k < nb; k++)
      if (around_a[i] == around_b[k]) {
        int32_t other[RING];
        int count;
        common++;
        if (!ring_of(c, around_a[i], other, &count) || count < 4)
          return BW_OK;
      }
  if (common != 2 || count_a + count_b < 8)
    return BW_OK;
  /* First the place nearest to all planes, then either end, which leaves half of the facets as
   * they are. */
  change now = {.kept = a, .gone = b, .pair = {-1, -1}};
  double q[10];
  for (int i = 0; i < 10; i++)
    q[i] = c->quadric[a][i] + c->quadric[b][i];
  for (int try = 0; try < 3 && !*done; try++) {
    for (int k = 0; k < 3; k++)
      now.at[k] = try == 0 ? (place(c, a)[k] + place(c, b)[k]) / 2 : place(c, try == 1 ? a : b)[k];
    *done = (try == 0 ? best_place(c, q, now.at) : planes_near(c, q, now.at)) &&
            plan(c, &now, ring, count_a + count_b) && meets_nothing(c, &now);
  }
  if (!*done)
    return BW_OK;
  memcpy(c->x + 3 * (size_t)a, now.at, sizeof now.at);
  for (int i = 0; i < 10; i++)
    c->quadric[a][i] += c->quadric[b][i];
  for (int i = 0; i < count_a; i++) { /* the triangles of both points go */
    int32_t *t = c->corner + ring[i] / 3 * 3;
    if (t[0] == b || t[1] == b || t[2] == b)
      t[0] = -1;
  }
  for (int i = count_a; i < count_a + count_b; i++) { /* the corners of b become corners of a */
    int32_t corner = ring[i];
    if (c->corner[corner / 3 * 3] < 0)
      continue;
    c->corner[corner] = a;
    c->next[corner] = c->first[a];
    c->first[a] = corner;
  }
  c->first[b] = -1;
  for (int i = 0; i < now.count; i++)
    if (!enter(c, now.triangle[i]))
      return BW_MEMORY;
  return BW_OK;
}

/* Take a point with three facets away, if that moves the surface little: edges around such a point
 * cannot be collapsed, and where they are many everything comes to a halt. */
static bw_status remove_point(coarse *c, int32_t point, bool *done) {
  int32_t ring[RING], other[RING];
  int count;
  *done = false;
  if (!ring_of(c, point, ring, &count) || count != 3)
    return BW_OK;
  change now = {.kept = -1, .gone = point, .pair = {-1, -1}, .count = 1};
  double worst_before = 1, near[3];
  for (int i = 0; i < 3; i++) {
    const double *x[3];
    double n[3];
    for (int k = 0; k < 3; k++)
      x[k] = place(c, c->corner[ring[i] / 3 * 3 + k]);
    normal(x, n);
    worst_before = fmin(worst_before, shape_of(x, n));
  }
  int32_t *corner = now.corner[0];
  for (int k = 0; k < 2; k++)
    corner[k] = c->corner[ring[0] / 3 * 3 + (ring[0] + 1 + k) % 3];
  corner[2] = -1;
  for (int i = 1; i < 3; i++) /* the facet that runs on from the second corner */
    if (c->corner[ring[i] / 3 * 3 + (ring[i] + 1) % 3] == corner[1])
      corner[2] = c->corner[ring[i] / 3 * 3 + (ring[i] + 2) % 3];
  if (corner[2] < 0 || corner[2] == corner[0])
    return BW_OK;
  for (int k = 0; k < 3; k++) {
    if (!ring_of(c, corner[k], other, &count) || count < 4)
      return BW_OK;
    now.x[0][k] = place(c, corner[k]);
  }
  normal(now.x[0], now.normal[0]);
  double shape = shape_of(now.x[0], now.normal[0]), far = 2 * c->error;
  if (!(shape > 1e-4 && shape >= fmin(c->floor, worst_before)) ||
      bwi_nearest_on_triangle(place(c, point), now.x[0][0], now.x[0][1], now.x[0][2], near) >
          far * far ||
      !meets_nothing(c, &now))
    return BW_OK;
  *done = true;
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 10; i++)
      c->quadric[corner[k]][i] += c->quadric[point][i] / 3;
  /* The first facet becomes the new one; its corner at the point goes to the third neighbour. */
  for (int i = 1; i < 3; i++)
    c->corner[ring[i] / 3 * 3] = -1;
  c->corner[ring[0]] = corner[2];
  c->next[ring[0]] = c->first[corner[2]];
  c->first[corner[2]] = ring[0];
  c->first[point] = -1;
  return enter(c, ring[0] / 3) ? BW_OK : BW_MEMORY;
}

/* Where a facet is a bad one, move the point towards the middle of its facets, along the planes, if
 * that makes the worst better. Moving all points would cost thin shells much volume. */
static bw_status move(coarse *c, int32_t point) {
  int32_t ring[RING];
  int count;
  if (c->first[point] < 0 || !ring_of(c, point, ring, &count) || count < 3)
    return BW_OK;
  change now = {.kept = point, .gone = -1, .pair = {-1, -1}};
  double weight = 0, sum[3] = {0, 0, 0}, whole[3] = {0, 0, 0}, step[3];
  for (int i = 0; i < count; i++) {
    const double *x[3];
    double n[3];
    for (int k = 0; k < 3; k++)
      x[k] = place(c, c->corner[ring[i] / 3 * 3 + k]);
    normal(x, n);
    double area = bw_norm(n);
    weight += area;
    for (int k = 0; k < 3; k++)
      sum[k] += area * (x[0][k] + x[1][k] + x[2][k]) / 3;
    for (int k = 0; k < 3; k++)
      whole[k] += n[k];
  }
  if (!(weight > 0))
    return BW_OK;
  for (int k = 0; k < 3; k++)
    now.at[k] = sum[k] / weight;
  if (!best_place(c, c->quadric[point], now.at))
    return BW_OK;
  /* A step in the plane of the normals' sum changes no volume. */
  for (int k = 0; k < 3; k++)
    step[k] = now.at[k] - place(c, point)[k];
  double along = bw_dot(step, whole) / (bw_dot(whole, whole) + 1e-300);
  for (int k = 0; k < 3; k++)
    now.at[k] -= along * whole[k];
  if (!planes_near(c, c->quadric[point], now.at) || !plan(c, &now, ring, count) ||
      now.worst_before > 0.3 || now.worst < now.worst_before + 0.02 || !meets_nothing(c, &now))
    return BW_OK;
  memcpy(c->x + 3 * (size_t)point, now.at, sizeof now.at);
  for (int i = 0; i < count; i++)
    if (!enter(c, ring[i] / 3))
      return BW_MEMORY;
  return BW_OK;
}

/* Every thousand steps of a loop: has the caller cancelled, is it too late? */
static bw_status look_up(coarse *c, size_t step) {
  if (step % 1024 != 0)
    return BW_OK;
  c->late |= c->deadline > 0 && bw_seconds() > c->deadline;
  return bw_check_cancel(c->context);
}

static bw_status move_pass(coarse *c) {
  bw_status status = BW_OK;
  for (int32_t i = 0; i < c->points && !c->late; i++) {
    BW_TRY(look_up(c, (size_t)i));
    BW_TRY(move(c, i));
  }
done:
  return status;
}

static bw_status collapse_pass(coarse *c, int64_t *collapsed) {
  bw_status status = BW_OK;
  size_t count = 0, capacity = 0;
  bwi_keyed *edge = NULL;
  *collapsed = 0;
  for (int32_t i = 0; i < c->points; i++) {
    bool yes;
    BW_TRY(look_up(c, (size_t)i));
    BW_TRY(remove_point(c, i, &yes));
    *collapsed += yes;
  }
  for (int32_t t = 0; t < c->triangles; t++) {
    const int32_t *corner = c->corner + 3 * (size_t)t;
    for (int k = 0; corner[0] >= 0 && k < 3; k++) {
      int32_t a = corner[k], b = corner[(k + 1) % 3];
      if (a > b) /* the neighbour lists it */
        continue;
      double length = distance_of(place(c, a), place(c, b));
      if (length >= c->shorter)
        continue;
      if (!bw_grow(c->context, (void **)&edge, &capacity, count, 1, sizeof *edge)) {
        status = BW_MEMORY;
        goto done;
      }
      edge[count] = (bwi_keyed){.item = a, .part = b};
      memcpy(&edge[count++].key, &length, 8); /* positive numbers sort like their bits */
    }
  }
  bwi_sort_keyed(edge, (int64_t)count);
  for (size_t i = 0; i < count && !c->late; i++) {
    int32_t a = edge[i].item, b = edge[i].part;
    bool yes;
    BW_TRY(look_up(c, i));
    if (c->first[a] < 0 || c->first[b] < 0)
      continue;
    if (distance_of(place(c, a), place(c, b)) >= c->shorter) /* others may have moved its ends */
      continue;
    BW_TRY(collapse(c, a, b, &yes));
    *collapsed += yes;
  }
done:
  bw_free(edge);
  return status;
}

/* ---- exchanging diagonals ------------------------------------------------------------------- */

/* The other living triangle with the directed side b a, or -1; *opposite its third corner. */
static int32_t across(coarse *c, int32_t a, int32_t b, int32_t *opposite) {
  int32_t ring[RING];
  int count;
  if (!ring_of(c, b, ring, &count))
    return -1;
  for (int i = 0; i < count; i++) {
    int32_t t = ring[i] / 3, k = ring[i] % 3;
    const int32_t *corner = c->corner + 3 * (size_t)t;
    if (corner[(k + 1) % 3] == a) {
      *opposite = corner[(k + 2) % 3];
      return t;
    }
  }
  return -1;
}

static void unlink_corner(coarse *c, int32_t point, int32_t corner) {
  int32_t *link = &c->first[point];
  while (*link >= 0 && *link != corner)
    link = &c->next[*link];
  if (*link >= 0)
    *link = c->next[corner];
}

/* Facets a b p and b a q become p q b and q p a. */
static bw_status exchange(coarse *c, int32_t t, int side, bool *done) {
  int32_t *corner = c->corner + 3 * (size_t)t;
  int32_t a = corner[side], b = corner[(side + 1) % 3], p = corner[(side + 2) % 3], q, around[RING];
  int count, count_b;
  *done = false;
  int32_t u = across(c, a, b, &q);
  if (u < 0 || p == q || !ring_of(c, a, around, &count) || count < 4 ||
      !ring_of(c, b, around, &count_b) || count_b < 4 || !ring_of(c, p, around, &count) ||
      count > RING - 2)
    return BW_OK;
  for (int i = 0; i < count; i++) { /* p and q must not be neighbours already */
    const int32_t *other = c->corner + around[i] / 3 * 3;
    if (other[0] == q || other[1] == q || other[2] == q)
      return BW_OK;
  }
  const double *xt[3] = {place(c, a), place(c, b), place(c, p)};
  const double *xu[3] = {place(c, b), place(c, a), place(c, q)};
  double nt[3], nu[3];
  normal(xt, nt);
  normal(xu, nu);
  double before = fmin(shape_of(xt, nt), shape_of(xu, nu));
  change now = {.kept = -1, .gone = -1, .pair = {t, u}, .count = 2};
  memcpy(now.corner, (int32_t[2][3]){{p, q, b}, {q, p, a}}, 2 * sizeof now.corner[0]);
  double after = 1;
  for (int i = 0; i < 2; i++) {
    for (int k = 0; k < 3; k++)
      now.x[i][k] = place(c, now.corner[i][k]);
    normal(now.x[i], now.normal[i]);
    after = fmin(after, shape_of(now.x[i], now.normal[i]));
  }
  if (!(after > 1.1 * before + 0.02))
    return BW_OK;
  /* Flat enough: every new normal close to the old ones; a needle's own normal says nothing, so
   * the sum of both stands for it. */
  double sum[3] = {nt[0] + nu[0], nt[1] + nu[1], nt[2] + nu[2]};
  double size = bw_norm(sum), limit = before < 0.05 ? 0.985 : 0.94;
  double ab[3], pq[3], across_both[3], between[3];
  for (int k = 0; k < 3; k++) {
    ab[k] = xt[1][k] - xt[0][k];
    pq[k] = xu[2][k] - xt[2][k];
    between[k] = xt[2][k] - xt[0][k];
  }
  bw_cross(ab, pq, across_both); /* how far the diagonals pass each other */
  if (fabs(bw_dot(between, across_both)) < c->error * bw_norm(across_both))
    limit = 0.7;
  for (int i = 0; i < 2; i++)
    if (!(bw_dot(now.normal[i], sum) > limit * bw_norm(now.normal[i]) * size))
      return BW_OK;
  if (bw_norm(nt) + bw_norm(nu) > (limit > 0.7 ? 1.1 : 1.4) * size || !meets_nothing(c, &now))
    return BW_OK;
  *done = true;
  int32_t two[2] = {t, u};
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 3; k++)
      unlink_corner(c, c->corner[3 * (size_t)two[i] + (size_t)k], 3 * two[i] + k);
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 3; k++) {
      int32_t at = 3 * two[i] + k, point = now.corner[i][k];
      c->corner[at] = point;
      c->next[at] = c->first[point];
      c->first[point] = at;
    }
  return enter(c, t) && enter(c, u) ? BW_OK : BW_MEMORY;
}

static bw_status exchange_pass(coarse *c) {
  bw_status status = BW_OK;
  for (int32_t t = 0; t < c->triangles && !c->late; t++) {
    bool done = false;
    BW_TRY(look_up(c, (size_t)t));
    if (c->corner[3 * (size_t)t] < 0)
      continue;
    int longest = 0; /* the diagonal whose exchange does most good */
    double length = 0;
    for (int k = 0; k < 3; k++) {
      const int32_t *corner = c->corner + 3 * (size_t)t;
      double here = distance_of(place(c, corner[k]), place(c, corner[(k + 1) % 3]));
      if (here > length) {
        length = here;
        longest = k;
      }
    }
    for (int k = 0; k < 3 && !done; k++)
      BW_TRY(exchange(c, t, (longest + k) % 3, &done));
  }
done:
  return status;
}

/* ---- the whole ------------------------------------------------------------------------------ */

static void clear(coarse *c) {
  bw_free(c->x);
  bw_free(c->corner);
  bw_free(c->quadric);
  bw_free(c->first);
  bw_free(c->next);
  bw_free(c->bucket);
  bw_free(c->list);
  bw_free(c->big);
  bw_free(c->seen);
}

/* The plane's quadric, weighted by area, to each corner. */
static void add_quadric(coarse *c, int32_t triangle) {
  const double *x[3];
  double n[3];
  for (int k = 0; k < 3; k++)
    x[k] = place(c, c->corner[3 * (size_t)triangle + (size_t)k]);
  normal(x, n);
  double size = bw_norm(n);
  if (!(size > 0))
    return;
  double d = -bw_dot(n, x[0]);
  double q[10] = {n[0] * n[0], n[0] * n[1], n[0] * n[2], n[1] * n[1], n[1] * n[2],
                  n[2] * n[2], n[0] * d,    n[1] * d,    n[2] * d,    d * d};
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 10; i++)
      c->quadric[c->corner[3 * (size_t)triangle + (size_t)k]][i] += q[i] / size;
}

static bw_status set_up(coarse *c, const bw_surface *surface) {
  size_t points = (size_t)surface->point_count, triangles = (size_t)surface->triangle_count;
  double low[3], high[3];
  c->points = surface->point_count;
  c->triangles = surface->triangle_count;
  c->buckets = 1024;
  while (c->buckets < 2 * triangles)
    c->buckets *= 2;
  c->x = BW_NEW(c->context, double, 3 * points);
  c->corner = BW_NEW(c->context, int32_t, 3 * triangles);
  c->quadric = bw_calloc(c->context, points, sizeof *c->quadric);
  c->first = BW_NEW(c->context, int32_t, points);
  c->next = BW_NEW(c->context, int32_t, 3 * triangles);
  c->bucket = BW_NEW(c->context, int64_t, c->buckets);
  c->seen = BW_NEW0(c->context, int32_t, triangles);
  if (!c->x || !c->corner || !c->quadric || !c->first || !c->next || !c->bucket || !c->seen)
    return BW_MEMORY;
  bw_surface_box(surface, low, high);
  for (int k = 0; k < 3; k++)
    c->origin[k] = (low[k] + high[k]) / 2;
  for (size_t i = 0; i < 3 * points; i++)
    c->x[i] = surface->point[i] - c->origin[i % 3];
  memcpy(c->corner, surface->triangle, 3 * triangles * sizeof *c->corner);
  for (size_t i = 0; i < points; i++)
    c->first[i] = -1;
  for (size_t i = 3 * triangles; i-- > 0;) {
    c->next[i] = c->first[c->corner[i]];
    c->first[c->corner[i]] = (int32_t)i;
  }
  for (int32_t t = 0; t < c->triangles; t++)
    add_quadric(c, t);
  return BW_OK;
}

/* Enter everything that lives in a fresh grid. */
static bw_status fresh_grid(coarse *c) {
  c->entries = c->big_count = 0;
  for (size_t i = 0; i < c->buckets; i++)
    c->bucket[i] = -1;
  for (int32_t t = 0; t < c->triangles; t++)
    if (c->corner[3 * (size_t)t] >= 0 && !enter(c, t))
      return BW_MEMORY;
  return BW_OK;
}

/* Collapse to this length. Where shapes bring that to a halt, worse ones are let pass for a while:
 * exchanges and moves mend them afterwards. */
static bw_status coarsen_to(coarse *c, double length, double shorter, double error) {
  static const double floors[] = {0.45, 0.3, 0.15};
  bw_status status = BW_OK;
  c->length = length;
  c->shorter = shorter;
  c->error = error;
  int easier = 0;
  for (int i = 0; i < 12 && !c->late; i++) {
    int64_t collapsed, living = 0;
    c->floor = floors[easier];
    BW_TRY(fresh_grid(c));
    BW_TRY(collapse_pass(c, &collapsed));
    BW_TRY(exchange_pass(c));
    BW_TRY(move_pass(c));
    for (int32_t t = 0; t < c->triangles; t++)
      living += c->corner[3 * (size_t)t] >= 0;
    if (collapsed > living / 100)
      continue;
    if (easier == 2)
      break;
    easier++;
  }
  for (int i = 0; i < 2 && !c->late; i++) {
    BW_TRY(exchange_pass(c));
    BW_TRY(move_pass(c));
  }
done:
  return status;
}

static bw_status hand_over(coarse *c, bw_surface **out) {
  int32_t triangles = 0, points = 0;
  for (int32_t i = 0; i < c->points; i++)
    c->first[i] = -1; /* from here on: the new number */
  for (int32_t t = 0; t < c->triangles; t++) {
    if (c->corner[3 * (size_t)t] < 0)
      continue;
    for (size_t k = 0; k < 3; k++)
      c->first[c->corner[3 * (size_t)t + k]] = 0;
    memmove(c->corner + 3 * (size_t)triangles++, c->corner + 3 * (size_t)t, 3 * sizeof *c->corner);
  }
  for (int32_t i = 0; i < c->points; i++)
    if (c->first[i] == 0) {
      for (size_t k = 0; k < 3; k++)
        c->x[3 * (size_t)points + k] = c->x[3 * (size_t)i + k] + c->origin[k];
      c->first[i] = points++;
    }
  for (size_t i = 0; i < 3 * (size_t)triangles; i++)
    c->corner[i] = c->first[c->corner[i]];
  return bw_surface_copy(c->context, points, c->x, triangles, c->corner, NULL, out);
}

bw_status bwi_coarsen_surface(bw_context *context, const bw_surface *surface, double length,
                              double shorter, double error, double seconds,
                              bw_surface **coarsened) {
  coarse c = {.context = context, .deadline = seconds > 0 ? bw_seconds() + seconds : 0};
  bw_status status;
  BW_TRY(set_up(&c, surface));
  /* Step by step from the present length: a grid of long cells would hold too many small
   * triangles each. */
  double area = bw_surface_area(surface), now = sqrt(area / (0.4330127 * c.triangles));
  for (now = fmax(1.5 * now, 1e-4 * length); now < 0.75 * length && now < shorter; now *= 1.8)
    BW_TRY(coarsen_to(&c, now, 0.8 * now, error));
  BW_TRY(coarsen_to(&c, length, shorter, error));
  BW_TRY(hand_over(&c, coarsened));
done:
  clear(&c);
  return status;
}
