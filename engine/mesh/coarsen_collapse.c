/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Steps of coarsening that take points away, or move them: each only where the new triangles are
 * well shaped and meet nothing. */
#include "mesh/coarsen.h"

#include "base/job.h"

/* The living corners of a point; false when there are too many to bother. Dead ones are taken out
 * of the list on the way. */
bool bwi_coarsen_ring(bwi_coarsening *c, int32_t point, int32_t *ring, int *count) {
  *count = 0;
  int32_t *link = &c->first[point];
  while (*link >= 0) {
    int32_t corner = *link;
    if (c->corner[corner / 3 * 3] < 0) {
      *link = c->next[corner];
      continue;
    }
    if (*count == BWI_RING)
      return false;
    ring[(*count)++] = corner;
    link = &c->next[corner];
  }
  return true;
}

/* The neighbours of a point, each once; as many as triangles where the surface is closed. */
static int neighbours_of(const bwi_coarsening *c, const int32_t *ring, int count, int32_t *list) {
  int found = 0;
  for (int i = 0; i < count; i++) {
    int32_t t = ring[i] / 3 * 3;
    list[found++] = c->corner[t + (ring[i] - t + 1) % 3];
  }
  return found;
}

static bool planes_near(const bwi_coarsening *c, const double q[10], const double at[3]) {
  double square = q[0] * at[0] * at[0] + q[3] * at[1] * at[1] + q[5] * at[2] * at[2] +
                  2 * (q[1] * at[0] * at[1] + q[2] * at[0] * at[2] + q[4] * at[1] * at[2]) +
                  2 * (q[6] * at[0] + q[7] * at[1] + q[8] * at[2]) + q[9];
  double error = error_at(c, at);
  return square <= error * error * (q[0] + q[3] + q[5]);
}

/* Where a point of that quadric goes that would like to be at m, which is given in `at`: the
 * minimum of q(x) + w |x - m|^2. False where the planes are too far from there. */
static bool best_point(const bwi_coarsening *c, const double q[10], double at[3]) {
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

/* Fill in the triangles around the edge after its collapse, and check their shapes: the worst must
 * be good, or at least as good as the worst before, those that go included. */
static bool plan(const bwi_coarsening *c, bwi_coarsen_change *now, const int32_t *ring, int count) {
  double worst = 1, worst_before = 1;
  double length = fmin(c->length, fraction_at(c, now->at) * c->options->length);
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
    normal_of(before, n);
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
    normal_of(now->x[m], now->normal[m]);
    worst = fmin(worst, shape_of(now->x[m], now->normal[m]));
    for (int k = 0; k < 3; k++) {
      longest = fmax(longest, distance_of(now->x[m][(k + 1) % 3], now->x[m][k]));
      longest_before = fmax(longest_before, distance_of(before[(k + 1) % 3], before[k]));
    }
    if (longest > fmax(1.6 * length, 1.05 * longest_before))
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
static bw_status collapse(bwi_coarsening *c, int32_t a, int32_t b, bool *done) {
  int32_t ring[2 * BWI_RING], around_a[BWI_RING], around_b[BWI_RING];
  int count_a, count_b, common = 0;
  *done = false;
  if (!bwi_coarsen_ring(c, a, ring, &count_a) || count_a < 3 ||
      !bwi_coarsen_ring(c, b, ring + count_a, &count_b) || count_b < 3)
    return BW_OK;
  int na = neighbours_of(c, ring, count_a, around_a);
  int nb = neighbours_of(c, ring + count_a, count_b, around_b);
  for (int i = 0; i < na; i++)
    for (int k = 0; k < nb; k++)
      if (around_a[i] == around_b[k]) {
        int32_t other[BWI_RING];
        int count;
        common++;
        if (!bwi_coarsen_ring(c, around_a[i], other, &count) || count < 4)
          return BW_OK;
      }
  if (common != 2 || count_a + count_b < 8)
    return BW_OK;
  /* First the place nearest to all planes, then either end, which leaves half of the facets as
   * they are. */
  bwi_coarsen_change now = {.kept = a, .gone = b, .pair = {-1, -1}};
  double q[10];
  for (int i = 0; i < 10; i++)
    q[i] = c->quadric[a][i] + c->quadric[b][i];
  for (int try = 0; try < 3 && !*done; try++) {
    for (int k = 0; k < 3; k++)
      now.at[k] = try == 0 ? (place(c, a)[k] + place(c, b)[k]) / 2 : place(c, try == 1 ? a : b)[k];
    *done = (try == 0 ? best_point(c, q, now.at) : planes_near(c, q, now.at)) &&
            plan(c, &now, ring, count_a + count_b) && bwi_coarsen_is_free(c, &now);
  }
  if (!*done)
    return BW_OK;
  memcpy(c->x + 3 * (size_t)a, now.at, sizeof now.at);
  c->lost[a] = now.lost;
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
    if (!bwi_coarsen_enter(c, now.triangle[i]))
      return BW_MEMORY;
  return BW_OK;
}

/* Take a point with three facets away, if that moves the surface little: edges around such a point
 * cannot be collapsed, and where they are many everything comes to a halt. */
static bw_status remove_point(bwi_coarsening *c, int32_t point, bool *done) {
  int32_t ring[BWI_RING], other[BWI_RING];
  int count;
  *done = false;
  if (!bwi_coarsen_ring(c, point, ring, &count) || count != 3)
    return BW_OK;
  bwi_coarsen_change now = {.kept = -1, .gone = point, .pair = {-1, -1}, .count = 1};
  double worst_before = 1, near[3];
  for (int i = 0; i < 3; i++) {
    const double *x[3];
    double n[3];
    for (int k = 0; k < 3; k++)
      x[k] = place(c, c->corner[ring[i] / 3 * 3 + k]);
    normal_of(x, n);
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
    if (!bwi_coarsen_ring(c, corner[k], other, &count) || count < 4)
      return BW_OK;
    now.x[0][k] = place(c, corner[k]);
  }
  normal_of(now.x[0], now.normal[0]);
  double shape = shape_of(now.x[0], now.normal[0]), far = 2 * error_at(c, place(c, point));
  if (!(shape > 1e-4 && shape >= fmin(c->floor, worst_before)) ||
      bwi_nearest_on_triangle(place(c, point), now.x[0][0], now.x[0][1], now.x[0][2], near) >
          far * far ||
      !bwi_coarsen_is_free(c, &now))
    return BW_OK;
  *done = true;
  for (int k = 0; k < 3; k++) {
    c->lost[corner[k]] = fmax(c->lost[corner[k]], now.lost);
    for (int i = 0; i < 10; i++)
      c->quadric[corner[k]][i] += c->quadric[point][i] / 3;
  }
  /* The first facet becomes the new one; its corner at the point goes to the third neighbour. */
  for (int i = 1; i < 3; i++)
    c->corner[ring[i] / 3 * 3] = -1;
  c->corner[ring[0]] = corner[2];
  c->next[ring[0]] = c->first[corner[2]];
  c->first[corner[2]] = ring[0];
  c->first[point] = -1;
  return bwi_coarsen_enter(c, ring[0] / 3) ? BW_OK : BW_MEMORY;
}

/* Where a facet is a bad one, move the point towards the middle of its facets, along the planes, if
 * that makes the worst better. Moving all points would cost thin shells much volume. */
static bw_status move(bwi_coarsening *c, int32_t point) {
  int32_t ring[BWI_RING];
  int count;
  if (c->first[point] < 0 || !bwi_coarsen_ring(c, point, ring, &count) || count < 3)
    return BW_OK;
  bwi_coarsen_change now = {.kept = point, .gone = -1, .pair = {-1, -1}};
  double weight = 0, sum[3] = {0, 0, 0}, whole[3] = {0, 0, 0}, step[3];
  for (int i = 0; i < count; i++) {
    const double *x[3];
    double n[3];
    for (int k = 0; k < 3; k++)
      x[k] = place(c, c->corner[ring[i] / 3 * 3 + k]);
    normal_of(x, n);
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
  if (!best_point(c, c->quadric[point], now.at))
    return BW_OK;
  /* A step in the plane of the normals' sum changes no volume. */
  for (int k = 0; k < 3; k++)
    step[k] = now.at[k] - place(c, point)[k];
  double along = bw_dot(step, whole) / (bw_dot(whole, whole) + 1e-300);
  for (int k = 0; k < 3; k++)
    now.at[k] -= along * whole[k];
  if (!planes_near(c, c->quadric[point], now.at) || !plan(c, &now, ring, count) ||
      now.worst_before > 0.3 || now.worst < now.worst_before + 0.02 ||
      !bwi_coarsen_is_free(c, &now))
    return BW_OK;
  memcpy(c->x + 3 * (size_t)point, now.at, sizeof now.at);
  c->lost[point] = now.lost;
  for (int i = 0; i < count; i++)
    if (!bwi_coarsen_enter(c, ring[i] / 3))
      return BW_MEMORY;
  return BW_OK;
}

/* Every thousand steps of a loop: has the caller cancelled, is there time left? */
bw_status bwi_coarsen_check(bwi_coarsening *c, size_t step) {
  if (step % 1024 != 0)
    return BW_OK;
  bwi_progress_again(c->context); /* who is shown it may cancel */
  return bwi_time_limit_check(c->context, &c->time);
}

bw_status bwi_coarsen_move(bwi_coarsening *c) {
  bw_status status = BW_OK;
  for (int32_t i = 0; i < c->points; i++) {
    BW_TRY(bwi_coarsen_check(c, (size_t)i));
    BW_TRY(move(c, i));
  }
done:
  return status;
}

static bool is_short(const bwi_coarsening *c, int32_t a, int32_t b, double length) {
  if (length >= c->shorter)
    return false;
  double middle[3];
  for (int k = 0; k < 3; k++)
    middle[k] = (place(c, a)[k] + place(c, b)[k]) / 2;
  return length < fraction_at(c, middle) * c->options->shorter;
}

bw_status bwi_coarsen_collapse(bwi_coarsening *c, int64_t *collapsed) {
  bw_status status = BW_OK;
  size_t count = 0, capacity = 0;
  bwi_keyed *edge = NULL;
  *collapsed = 0;
  for (int32_t i = 0; i < c->points; i++) {
    bool yes;
    BW_TRY(bwi_coarsen_check(c, (size_t)i));
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
      if (!is_short(c, a, b, length))
        continue;
      BW_TRY_MEMORY(bw_grow(c->context, (void **)&edge, &capacity, count, 1, sizeof *edge));
      edge[count] = (bwi_keyed){.item = a, .part = b};
      memcpy(&edge[count++].key, &length, 8); /* positive numbers sort like their bits */
    }
  }
  bwi_sort_keyed(edge, (int64_t)count);
  for (size_t i = 0; i < count; i++) {
    int32_t a = edge[i].item, b = edge[i].part;
    bool yes;
    BW_TRY(bwi_coarsen_check(c, i));
    if (c->first[a] < 0 || c->first[b] < 0)
      continue;
    if (!is_short(c, a, b, distance_of(place(c, a), place(c, b)))) /* its ends may have moved */
      continue;
    BW_TRY(collapse(c, a, b, &yes));
    *collapsed += yes;
  }
done:
  bw_free(edge);
  return status;
}
