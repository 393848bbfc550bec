/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Processor seconds of conjugate gradients by right-hand sides solved at once: a block of N x N x N
 * cubes of six tet10, fixed at one face, under forces around as many points.
 *
 *     bench_pcg [N [THREADS [two_level|amg]]]        19 1: 41,154 elements, one thread */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench/bench.h"
#include "linear/pcg.h"
#include "linear/system_two_level.h"

enum { MOST = 16, REPEATS = 2 };

/* Unit forces of directions of their own around points of the body. */
static void forces(const bw_mesh *mesh, double *force) {
  bw_random random;
  bw_random_seed(&random, 7);
  for (int k = 0; k < MOST; k++) {
    double point[3], direction[3];
    for (int d = 0; d < 3; d++) {
      point[d] = bw_random_uniform(&random);
      direction[d] = 2 * bw_random_uniform(&random) - 1;
    }
    for (int64_t i = 0; i < mesh->node_count; i++) {
      double far = 0;
      for (int d = 0; d < 3; d++)
        far += (mesh->node[3 * i + d] - point[d]) * (mesh->node[3 * i + d] - point[d]);
      for (int d = 0; d < 3; d++)
        force[3 * ((int64_t)k * mesh->node_count + i) + d] = direction[d] * exp(-50 * far);
    }
  }
}

static void measure(bw_context *context, const bw_model *model, bw_solver_kind kind,
                    const double *force, double *displacement) {
  bw_static *result = NULL;
  bw_solver *m = NULL, *pcg = NULL;
  bw_solver_options of_m = {.kind = kind}, of_pcg = {.kind = BW_SOLVER_PCG};
  OK(bw_solver_create(context, &of_m, &m));
  of_pcg.preconditioner = m;
  OK(bw_solver_create(context, &of_pcg, &pcg));
  const bw_statics_options options = {.solver = pcg};
  OK(bw_statics(context, model, NULL, &options, &result));
  bw_system *system = result->system;
  double one = 0;
  static const int counts[] = {1, 8, 12};
  for (int c = 0; c < 3; c++) {
    double least = INFINITY;
    int iterations = 0;
    for (int pass = 0; pass < REPEATS; pass++) {
      double start = processor_seconds();
      if (kind == BW_SOLVER_TWO_LEVEL) {
        bwi_two_level_problem problem = {.tolerance = 1e-10, .limit = 200};
        OK(bwi_two_level_solve(context, system->two_level->preconditioner, &problem, counts[c],
                               force, displacement));
        iterations = problem.iterations;
      } else {
        bwi_amg_problem problem = {.tolerance = 1e-10, .limit = 200};
        OK(bwi_amg_solve(context, system->preconditioner->amg, &problem, counts[c], force,
                         displacement));
        iterations = problem.iterations;
      }
      least = fmin(least, processor_seconds() - start);
    }
    one = c == 0 ? least : one;
    printf("| %s | %d | %d | %.3f | %.2f |\n", bw_solver_word(kind), counts[c], iterations, least,
           least / one);
    fflush(stdout);
  }
  bw_release(result);
  bw_release(m);
  bw_release(pcg);
}

int main(int argc, char **argv) {
  int n = argc > 1 ? atoi(argv[1]) : 19;
  bw_context *context = bw_context_create();
  bw_mesh *mesh = NULL;
  bw_material *material = NULL;
  const bw_isotropic steel = {
      .name = "steel", .young = 200e9, .poisson = 0.3, .density = 7800, .strength = 4e8};
  const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
  const int cells[3] = {n, n, n};
  OK(bw_set_threads(context, argc > 2 ? atoi(argv[2]) : 1));
  OK(bw_mesh_box_grid(context, low, high, cells, 2, &mesh));
  OK(bw_material_isotropic(context, &steel, &material));
  bw_model *model = NULL;
  bw_selection *root = NULL;
  const double point[3] = {0, 0, 0}, normal[3] = {0, 1, 0}, pull[3] = {1e3, 0, -1e3};
  OK(bw_select_plane(context, mesh, point, normal, 1e-9, &root));
  OK(bw_model_create(context, mesh, material, &model));
  OK(bw_model_fix(context, model, root));
  OK(bw_model_gravity(context, model, pull));
  double *force = BW_NEW(context, double, 3 * (int64_t)MOST * mesh->node_count);
  double *displacement = BW_NEW(context, double, 3 * (int64_t)MOST * mesh->node_count);
  if (!force || !displacement)
    return 1;
  forces(mesh, force);
  printf("%d tet10, %d unknowns; processor seconds\n\n", (int)mesh->element_count,
         3 * (int)mesh->node_count);
  printf("| preconditioner | right-hand sides | iterations | seconds | over one "
         "|\n|---|---|---|---|---|\n");
  for (int k = 0; k < 2; k++) {
    bw_solver_kind kind = k == 0 ? BW_SOLVER_TWO_LEVEL : BW_SOLVER_AMG;
    if (argc < 4 || strcmp(argv[3], bw_solver_word(kind)) == 0)
      measure(context, model, kind, force, displacement);
  }
  bw_free(force);
  bw_free(displacement);
  bw_release(root);
  bw_release(model);
  bw_release(material);
  bw_release(mesh);
  bw_context_destroy(context);
  return 0;
}
