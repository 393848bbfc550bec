/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The basis of modes of one eigenvalue (docs/theory/solving.md).
 *
 * Such modes span a space that the body decides, and any rotation of them are modes too: an
 * eigensolver returns an accidental one. Here they become eigenvectors of a quadratic functional,
 *     s(u) = integral of density w(x) u . D u,
 * of a fixed smooth weight w and fixed factors D of the components, by ascending s. It depends on
 * the body and its place alone: not on the eigensolver, on threads, on the order of nodes, and on
 * the mesh only as much as the modes do. The weight is an exponential function of all coordinates,
 * so that no symmetry of a body leaves it unchanged. */
#include <math.h>
#include <string.h>

#include "eigen/internal.h"
#include "linear/blas.h"
#include "linear/multivector.h"

/* Where two of its values lie nearer to each other than this, the next functional decides. */
static const double indistinct = 1e-3;
enum { FUNCTIONALS = 4 };
/* Each steeper than the one before: an exponential of slope a has exp(-2 n^2 / a) of what tells
 * waves of n periods around an axis apart. */
static const struct functional {
  double slope[3], factor[3];
} functional[FUNCTIONALS] = {
    {{2.1, 1.3, 0.7}, {1, 1.4, 1.9}},
    {{-5, 6, 7}, {1.7, 1, 1.3}},
    {{20, -15, 17}, {1.2, 1.8, 1}},
    {{60, 70, -50}, {1.5, 1.1, 1}},
};

/* w at the nodes, in coordinates from -1 to 1 across the body; by number where there is no mesh. */
static void fill_weight(const bw_mesh *mesh, int64_t count, const struct functional *by,
                        double *w) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int64_t i = 0; mesh && i < count; i++)
    for (int k = 0; k < 3; k++) {
      low[k] = fmin(low[k], mesh->node[3 * i + k]);
      high[k] = fmax(high[k], mesh->node[3 * i + k]);
    }
  for (int64_t i = 0; i < count; i++) {
    double sum = mesh ? 0 : by->slope[0] * (2 * (double)i / (double)count - 1);
    for (int k = 0; mesh && k < 3; k++)
      if (high[k] > low[k])
        sum += by->slope[k] * (2 * (mesh->node[3 * i + k] - low[k]) / (high[k] - low[k]) - 1);
    w[i] = exp(sum);
  }
}

typedef struct rotation {
  const bwi_eigen_problem *problem;
  int64_t points;          /* nodes, or numbers of a field without a mesh */
  double *weight;          /* points */
  double *mass, *weighted; /* cluster x size */
  double *s, *value, *work;
  int length;
} rotation;

/* Eigenvectors of functional number `which` on the span of `count` M-orthonormal vectors; where it
 * does not tell some from each other, of the next one on their span. */
static bw_status rotate(bw_context *context, rotation *r, int which, int count, double *x) {
  bw_status status = BW_OK;
  const bwi_eigen_problem *problem = r->problem;
  int64_t size = problem->size, components = size / r->points;
  int info = 0;
  double *value = NULL;
  if (count == 1 || which == FUNCTIONALS)
    return BW_OK;
  fill_weight(problem->mesh, r->points, &functional[which], r->weight);
  for (int k = 0; k < count; k++)
    for (int64_t i = 0; i < r->points; i++)
      for (int64_t c = 0; c < components; c++) {
        int64_t at = k * size + i * components + c;
        r->weighted[at] = functional[which].factor[c % 3] * r->weight[i] * x[at];
      }
  BW_TRY(problem->mass(context, problem->data, count, x, r->mass));
  BW_TRY(bwi_multi_dot(context, size, count, r->weighted, count, r->mass, r->s));
  for (int a = 0; a < count; a++)
    for (int b = 0; b < a; b++)
      r->s[a + b * count] = r->s[b + a * count] = 0.5 * (r->s[a + b * count] + r->s[b + a * count]);
  dsyev_("V", "U", &count, r->s, &count, r->value, r->work, &r->length, &info);
  if (info != 0)
    return bw_fail(context, BW_INTERNAL, "dsyev failed on a matrix of order %d (%d)", count, info);
  BW_TRY(bwi_multi_combine(context, size, count, x, count, r->s, count, 1, 0, r->weighted));
  memcpy(x, r->weighted, (size_t)count * (size_t)size * sizeof *x);
  value = BW_NEW(context, double, count); /* the next functional overwrites r->value */
  BW_TRY_MEMORY(value);
  memcpy(value, r->value, (size_t)count * sizeof *value);
  for (int first = 0, end; first < count; first = end) {
    for (end = first + 1; end < count; end++)
      if (value[end] - value[end - 1] > indistinct * fabs(value[count - 1]))
        break;
    BW_TRY(rotate(context, r, which + 1, end - first, x + first * size));
  }
done:
  bw_free(value);
  return status;
}

/* Behind the last pair that is one eigenvalue with pair `first`, within what is known of both. */
static int cluster_end(const bwi_eigen_result *result, double tolerance, int first) {
  int end = first + 1;
  for (; end < result->count; end++) {
    double low = fabs(result->value[end - 1]), high = fabs(result->value[end]);
    double error =
        fmax(tolerance * high, result->residual[end - 1] * low + result->residual[end] * high);
    if (!(result->value[end] - result->value[end - 1] <= error))
      break;
  }
  return end;
}

bw_status bwi_eigen_canonical(bw_context *context, const bwi_eigen_problem *problem,
                              double tolerance, bwi_eigen_result *result, bool *changed) {
  bw_status status = BW_OK;
  int most = 1;
  *changed = false;
  for (int first = 0, end; first < result->count; first = end) {
    end = cluster_end(result, tolerance, first);
    most = end - first > most ? end - first : most;
  }
  if (most == 1)
    return BW_OK;
  rotation r = {.problem = problem,
                .points = problem->mesh ? problem->mesh->node_count : problem->size,
                .length = 8 * most + 64};
  r.weight = BW_NEW(context, double, r.points);
  r.mass = BW_NEW(context, double, most * problem->size);
  r.weighted = BW_NEW(context, double, most * problem->size);
  r.s = BW_NEW(context, double, (int64_t)most *most);
  r.value = BW_NEW(context, double, most);
  r.work = BW_NEW(context, double, r.length);
  BW_TRY_MEMORY(r.weight && r.mass && r.weighted && r.s && r.value && r.work);
  for (int first = 0, end; first < result->count; first = end) {
    end = cluster_end(result, tolerance, first);
    double sum = 0;
    for (int k = first; k < end; k++)
      sum += result->value[k];
    for (int k = first; end - first > 1 && k < end; k++)
      result->value[k] = sum / (end - first);
    BW_TRY(rotate(context, &r, 0, end - first, result->vector + first * problem->size));
  }
  *changed = true;
done:
  bw_free(r.weight);
  bw_free(r.mass);
  bw_free(r.weighted);
  bw_free(r.s);
  bw_free(r.value);
  bw_free(r.work);
  return status;
}
