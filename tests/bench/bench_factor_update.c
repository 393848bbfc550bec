/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Factor reuse in limbed bodies: for an edit of every single subdomain the work touched and the
 * time of updating the factor and solving, beside CHOLMOD's factor and solve from
 * scratch in the same run.
 *
 *   build/tests/bench_factor_update [scene or all] [elements] [folder of meshes made before]
 *
 * One JSON object per scene and order. Meshes are kept in the folder, where one is given. */
#include "limbs.h"

#include <time.h>

#include "bench/bench.h"
#include "bench/cholmod_baseline.h"

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

static double median(double *value, int count) {
  qsort(value, (size_t)count, sizeof *value, ascending);
  return count % 2 ? value[count / 2] : 0.5 * (value[count / 2 - 1] + value[count / 2]);
}

typedef bw_status order_function(bw_context *, const bw_block_pattern *, const uint8_t *,
                                 const bw_mesh *, int32_t, const int32_t *, bwi_order **);
static bw_status plain(bw_context *context, const bw_block_pattern *pattern, const uint8_t *take,
                       const bw_mesh *mesh, int32_t subdomains, const int32_t *subdomain,
                       bwi_order **order) {
  (void)mesh;
  (void)subdomains;
  (void)subdomain;
  return bwi_order_create(context, pattern, take, order);
}
static bw_status by_subdomains(bw_context *context, const bw_block_pattern *pattern,
                               const uint8_t *take, const bw_mesh *mesh, int32_t subdomains,
                               const int32_t *subdomain, bwi_order **order) {
  return bwi_order_create_subdomains(context, pattern, take, mesh, subdomains, subdomain, NULL,
                                     order);
}

typedef struct scene {
  bw_mesh *mesh;
  bw_block_pattern *pattern;
  double *stiffness;
  uint8_t *take;
  int32_t *unknown, *subdomain, subdomains;
} scene;

/* Fixed where it is lowest. */
static bw_status open_scene(bw_context *context, const limbs *body, int64_t elements,
                            const char *folder, scene *s) {
  bw_status status = BW_OK;
  bw_material *material = NULL;
  char path[1024];
  *s = (scene){0};
  snprintf(path, sizeof path, "%s/%s_%lld.vtu", folder ? folder : "", body->name,
           (long long)elements);
  bw_mesh_file file = {0};
  if (folder && bw_mesh_read(context, path, &file) == BW_OK)
    s->mesh = bw_retain(file.mesh);
  else {
    BW_TRY(limbs_mesh(context, body, elements, &s->mesh));
    if (folder)
      BW_TRY(bw_mesh_write(context, s->mesh, path, 0, NULL));
  }
  const bw_isotropic constants = {
      .name = "resin", .young = 1.8e9, .poisson = 0.38, .density = 1180, .strength = 55e6};
  BW_TRY(bw_material_isotropic(context, &constants, &material));
  BW_TRY(bw_block_pattern_create(context, s->mesh, &s->pattern));
  size_t nodes = (size_t)s->mesh->node_count;
  s->stiffness = malloc(9 * (size_t)s->pattern->block_count * sizeof(double));
  s->take = malloc(nodes);
  s->unknown = malloc(3 * nodes * sizeof(int32_t));
  s->subdomain = malloc((size_t)s->mesh->element_count * sizeof(int32_t));
  BW_TRY(bw_stiffness(context, s->pattern, s->mesh, material, s->stiffness));
  s->subdomains = limbs_subdomains(body, s->mesh, s->subdomain);
  double low = 1e30;
  for (size_t i = 0; i < nodes; i++)
    low = fmin(low, s->mesh->node[3 * i + 1]);
  for (size_t i = 0; i < nodes; i++) {
    s->take[i] = s->mesh->node[3 * i + 1] > low + 0.004;
    for (size_t c = 0; c < 3; c++)
      s->unknown[3 * i + c] = s->take[i] ? (int32_t)(3 * i + c) : -1;
  }
done:
  bw_mesh_file_clear(&file);
  bw_release(material);
  return status;
}

static void close_scene(scene *s) {
  bw_release(s->mesh);
  bw_release(s->pattern);
  free(s->stiffness);
  free(s->take);
  free(s->unknown);
  free(s->subdomain);
}

static bw_status run(bw_context *context, const limbs *body, const scene *s, const char *name,
                     order_function *make, double baseline[2]) {
  bw_status status = BW_OK;
  bwi_order *order = NULL;
  bwi_symbolic *symbolic = NULL;
  bwi_elimination_reach *reach = NULL;
  bwi_factor *factor = NULL;
  bwi_matrix matrix = {.pattern = s->pattern, .stiffness = s->stiffness};
  double *x = NULL, *fraction = malloc((size_t)s->subdomains * sizeof(double)),
         *seconds = malloc((size_t)s->subdomains * sizeof(double)),
         *total = malloc((size_t)s->subdomains * sizeof(double));
  uint8_t *touched = calloc((size_t)s->subdomains, 1);
  double start = bw_seconds();
  BW_TRY(make(context, s->pattern, s->take, s->mesh, s->subdomains, s->subdomain, &order));
  double seconds_order = bw_seconds() - start;
  BW_TRY(bwi_symbolic_create(context, order, 3, s->unknown, &symbolic));
  BW_TRY(bwi_elimination_reach_create(context, symbolic, s->mesh, s->subdomains, s->subdomain,
                                      &reach));
  start = bw_seconds();
  BW_TRY(
      bwi_factor_create_in(context, symbolic, &matrix, reach, &bwi_kernels_double, &factor, NULL));
  double first = bw_seconds() - start;
  start = bw_seconds();
  BW_TRY(bwi_factor_update(context, factor, &matrix, NULL, NULL, NULL));
  double again = bw_seconds() - start;
  start = processor_seconds();
  BW_TRY(bwi_factor_update(context, factor, &matrix, NULL, NULL, NULL));
  double whole_cpu = processor_seconds() - start;
  x = malloc((size_t)symbolic->unknowns * sizeof(double));
  for (int32_t i = 0; i < symbolic->unknowns; i++)
    x[i] = i % 7 - 3;
  double solves[5], solve_cpu = processor_seconds();
  for (int k = 0; k < 5; k++) {
    start = bw_seconds();
    BW_TRY(bwi_factor_solve(context, factor, 1, x));
    solves[k] = bw_seconds() - start;
  }
  solve_cpu = (processor_seconds() - solve_cpu) / 5;
  double solve = median(solves, 5);
  if (baseline[0] == 0) {
    cholmod_times times;
    BW_TRY(cholmod_baseline(context, symbolic, &matrix, x, &times));
    baseline[0] = times.factor;
    baseline[1] = times.solve;
  }
  double update = 0, update_cpu = processor_seconds();
  for (int32_t d = 0; d < s->subdomains; d++) {
    double flops;
    memset(touched, 0, (size_t)s->subdomains);
    touched[d] = 1;
    start = bw_seconds();
    BW_TRY(bwi_factor_update(context, factor, &matrix, touched, &flops, NULL));
    seconds[d] = bw_seconds() - start;
    fraction[d] = flops / symbolic->flops;
    total[d] = (baseline[0] + baseline[1]) / (seconds[d] + solve);
    update += flops;
  }
  update_cpu = processor_seconds() - update_cpu;
  size_t kept, work;
  bwi_factor_update_bytes(factor, &kept, &work);
  double entries = (double)symbolic->panel[order->super_count];
  printf("{\"scene\": \"%s\", \"order\": \"%s\", \"elements\": %d, \"unknowns\": %d, "
         "\"subdomains\": %d, \"gigaflops\": %.2f, \"entries_million\": %.1f, "
         "\"kept_megabytes\": %.0f, \"work_megabytes\": %.0f, \"seconds_order\": %.2f, "
         "\"seconds_factor_first\": %.3f, \"seconds_factor\": %.3f, \"factor_gflops_per_s\": %.1f, "
         "\"seconds_solve\": %.4f, \"solve_gb_per_s\": %.1f, "
         "\"seconds_cholmod_factor\": %.3f, \"seconds_cholmod_solve\": %.3f, ",
         body->name, name, s->mesh->element_count, symbolic->unknowns, s->subdomains,
         symbolic->flops / 1e9, entries / 1e6, (double)kept / 1e6, (double)work / 1e6,
         seconds_order, first, again, symbolic->flops / again / 1e9, solve,
         16 * entries / solve / 1e9, baseline[0], baseline[1]);
  printf("\"cpu_seconds_factor\": %.3f, \"cpu_seconds_solve\": %.4f, "
         "\"cpu_gflops_per_s_factor\": %.1f, \"cpu_gflops_per_s_updates\": %.1f, ",
         whole_cpu, solve_cpu, symbolic->flops / whole_cpu / 1e9, update / update_cpu / 1e9);
  double worst = 0, mean = 0;
  for (int32_t d = 0; d < s->subdomains; d++) {
    mean += fraction[d] / s->subdomains;
    worst = fmax(worst, fraction[d]);
  }
  printf("\"fraction_median\": %.4f, \"fraction_mean\": %.4f, \"fraction_max\": %.4f, ",
         median(fraction, s->subdomains), mean, worst);
  double middle = median(seconds, s->subdomains), faster = median(total, s->subdomains);
  printf("\"seconds_update_median\": %.4f, \"seconds_update_max\": %.4f, "
         "\"speedup_median\": %.2f, \"speedup_min\": %.2f}\n",
         middle, seconds[s->subdomains - 1], faster, total[0]);
  fflush(stdout);
done:
  bw_release(factor);
  bw_release(reach);
  bw_release(symbolic);
  bw_release(order);
  free(x);
  free(fraction);
  free(seconds);
  free(total);
  free(touched);
  return status;
}

int main(int count, char **argument) {
  const char *wanted = count > 1 ? argument[1] : "all", *folder = count > 3 ? argument[3] : NULL;
  int64_t elements = count > 2 ? atoll(argument[2]) : 0;
  static const int64_t paper_size[] = {16000, 24000, 33000, 42000, 59000};
  bw_context *context = bw_context_create();
  bw_status status = BW_OK;
  for (size_t i = 0; i < sizeof limbs_scenes / sizeof *limbs_scenes && status == BW_OK; i++) {
    const limbs *body = &limbs_scenes[i];
    scene s;
    double baseline[2] = {0, 0};
    if (strcmp(wanted, "all") != 0 && strcmp(wanted, body->name) != 0)
      continue;
    status = open_scene(context, body, elements > 0 ? elements : paper_size[i], folder, &s);
    if (status == BW_OK)
      status = run(context, body, &s, "nodes", plain, baseline);
    if (status == BW_OK)
      status = run(context, body, &s, "subdomains", by_subdomains, baseline);
    close_scene(&s);
  }
  if (status != BW_OK)
    fprintf(stderr, "%s\n", bw_message(context));
  bw_context_destroy(context);
  return status != BW_OK;
}
