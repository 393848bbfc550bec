/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The coarsest level of multigrid (amg.h).
 *
 * Where supports leave rigid-body modes free, its matrix A is singular. Its null space is known:
 * motions of the nodes are P applied to these of the level below, down to N here. With N
 * orthonormal and any s > 0, A + s N N^T is regular, and for b orthogonal to N it has the solution
 * that the pseudo-inverse A^+ has. */
#include "base/dense.h"
#include "linear/amg_setup.h"
#include "model/internal.h"

enum { MODES = BWI_AMG_MODES };

/* A mode of a body as combination of the six that are smoothed: t and size w, about their centre.
 */
static void coefficients(const bwi_amg_setup *s, const bw_rigid_mode *mode, double of[MODES]) {
  bwi_motion_at(mode, s->centre, of);
  for (int d = 0; d < 3; d++)
    of[3 + d] = s->size * mode->rotation[d];
}

/* N, a row for each mode; made orthonormal among those of its body by Gram and Schmidt's method,
 * twice. False where they are dependent. */
static bool find_null_space(bwi_amg_setup *s) {
  bwi_amg *g = s->g;
  const bw_dof_map *dof_map = s->matrix->dof_map;
  int n = g->size;
  for (int m = 0; m < g->null_count; m++) {
    const bw_rigid_mode *mode = &dof_map->rigid_mode[m];
    double *own = g->null + (int64_t)n * m, of[MODES], left;
    coefficients(s, mode, of);
    for (int32_t k = 0; k < g->level[s->at].rows; k++)
      for (int i = 0; i < MODES && s->body[k] == mode->component; i++)
        own[MODES * k + i] = bwi_dot(MODES, s->modes + (int64_t)MODES * (MODES * k + i), of);
    double whole = sqrt(bwi_dot(n, own, own));
    for (int pass = 0; pass < 2; pass++)
      for (int q = dof_map->rigid_mode_start[mode->component]; q < m; q++) {
        const double *other = g->null + (int64_t)n * q;
        double part = bwi_dot(n, other, own);
        for (int i = 0; i < n; i++)
          own[i] -= part * other[i];
      }
    left = sqrt(bwi_dot(n, own, own));
    if (!(left > 1e-8 * whole))
      return false;
    for (int i = 0; i < n; i++)
      own[i] /= left;
  }
  return true;
}

static bw_status assemble(bwi_amg_setup *s) {
  bwi_amg *g = s->g;
  const bwi_amg_level *v = &g->level[s->at];
  int u = v->unknowns, n = s->at > 0 ? v->rows * u : 0; /* 0: nothing is unknown */
  g->size = n;
  g->null_count = n > 0 ? s->matrix->dof_map->rigid_mode_count : 0;
  g->dense = BW_NEW0(s->context, double, (int64_t)n *n);
  g->dense_x = BW_NEW0(s->context, double, BWI_SMOOTHER_SIDES *n);
  g->null = BW_NEW0(s->context, double, (int64_t)n * g->null_count);
  if (!g->dense || !g->dense_x || !g->null)
    return BW_MEMORY;
  for (int32_t k = 0; s->at > 0 && k < v->rows; k++)
    BWI_AMG_FOR_ROW(s, k, {
      for (int a = 0; a < u; a++)
        for (int b = 0; b < u; b++)
          g->dense[(int64_t)n * (u * k + a) + u * j + b] +=
              bwi_amg_unit(s) * (across ? block[b * u + a] : block[a * u + b]);
    });
  for (int64_t i = 0; i < n; i++)
    if (!(g->dense[(int64_t)n * i + i] > 0))
      g->dense[(int64_t)n * i + i] = 1;
  return BW_OK;
}

bw_status bwi_amg_factor_coarsest(bwi_amg_setup *s) {
  bw_status status = BW_OK;
  bwi_amg *g = s->g;
  double shift = 0;
  BW_TRY(assemble(s));
  int n = g->size;
  bool regular = find_null_space(s);
  for (int64_t i = 0; i < n; i++)
    shift += g->dense[(n + 1) * i] / n;
  for (int m = 0; m < g->null_count; m++) {
    const double *mode = g->null + (int64_t)n * m;
    for (int64_t i = 0; i < n; i++)
      for (int64_t j = 0; j <= i; j++)
        g->dense[n * i + j] += shift * mode[i] * mode[j];
  }
  if (!regular || !bwi_cholesky(n, g->dense, 1e-14))
    status = bw_fail(s->context, BW_SINGULAR,
                     "the stiffness is singular, or so nearly that multigrid cannot tell: its "
                     "coarsest level is not positive definite");
done:
  return status;
}
