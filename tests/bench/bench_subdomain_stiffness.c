/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Ratios of the stiffness kept subdomain by subdomain to direct assembly; built with the tests, run
 * by hand: build/tests/bench_subdomain_stiffness [tetrahedra] [order] [subdomains] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench/bench.h"

enum { REPEATS = 41 };

/* The shortest of the repeats, of the clock and of the processor: the others were disturbed. The
 * methods take turns, so that a busy spell strikes all of them. */
typedef struct lap {
  double clock, processor, since, processor_since;
} lap;

static void begin(lap *l) {
  l->since = bw_seconds();
  l->processor_since = processor_seconds();
}

static void end(lap *l) {
  double passed = bw_seconds() - l->since, used = processor_seconds() - l->processor_since;
  l->clock = l->clock > 0 ? fmin(l->clock, passed) : passed;
  l->processor = l->processor > 0 ? fmin(l->processor, used) : used;
}

int main(int count, char **argument) {
  int64_t wanted = count > 1 ? atoll(argument[1]) : 40000;
  int order = count > 2 ? atoi(argument[2]) : 2;
  int subdomains = count > 3 ? atoi(argument[3]) : 20;
  bw_context *context = bw_context_create();
  /* a bar twenty times as long as wide, cut into slabs */
  int across = (int)lround(cbrt((double)wanted / 6 / 20));
  int cells[3] = {(int)lround((double)wanted / 6 / across / across), across, across};
  double low[3] = {0, 0, 0}, high[3] = {0.01 * cells[0], 0.01 * cells[1], 0.01 * cells[2]};
  bw_mesh *mesh = NULL, *moved = NULL;
  bw_block_pattern *pattern = NULL;
  bw_material *material[2] = {NULL, NULL};
  OK(bw_mesh_box_grid(context, low, high, cells, order, &mesh));
  OK(bw_block_pattern_create(context, mesh, &pattern));
  OK(bw_material_named(context, "pla", &material[0]));
  OK(bw_material_named(context, "zp150", &material[1]));
  int32_t *of_element = (int32_t *)malloc(sizeof(int32_t) * (size_t)mesh->element_count);
  int32_t *of_node = (int32_t *)calloc((size_t)mesh->node_count, sizeof(int32_t));
  for (int32_t e = 0; e < mesh->element_count; e++) {
    double x = 0;
    for (int a = 0; a < 4; a++)
      x += 0.25 * mesh->node[3 * mesh->element[(int64_t)e * mesh->nodes_per_element + a]];
    of_element[e] = (int32_t)(x / high[0] * subdomains);
    for (int a = 0; a < mesh->nodes_per_element; a++)
      of_node[mesh->element[(int64_t)e * mesh->nodes_per_element + a]] = of_element[e];
  }
  bw_subdomain_motion *motion = (bw_subdomain_motion *)malloc(sizeof *motion * (size_t)subdomains);
  double *values = (double *)malloc(sizeof *values * 9 * (size_t)pattern->block_count);
  double *node = (double *)malloc(sizeof *node * 3 * (size_t)mesh->node_count);
  printf("{\"tetrahedra\": %d, \"nodes\": %d, \"blocks\": %lld, \"subdomains\": %d, \"cases\": [\n",
         mesh->element_count, mesh->node_count, (long long)pattern->block_count, subdomains);
  for (int threads = 1; threads <= 2; threads++)
    for (int m = 0; m < 2; m++) {
      bw_subdomain_stiffness *s = NULL;
      OK(bw_set_threads(context, threads));
      double start = bw_seconds();
      OK(bw_subdomain_stiffness_create(context, pattern, mesh, material[m], false, subdomains,
                                       of_element, of_node, &s));
      double create = bw_seconds() - start;
      lap direct = {0}, all = {0}, one = {0}, gathered = {0};
      for (int r = 0; r < REPEATS; r++) {
        begin(&direct);
        OK(bw_stiffness(context, pattern, mesh, material[m], values));
        end(&direct);

        for (int d = 0; d < subdomains; d++) {
          bw_subdomain_motion_rest(&motion[d]);
          motion[d].linear[0] = 1 + 0.01 * (r + 1);
        }
        begin(&all);
        OK(bw_subdomain_stiffness_update(context, s, mesh, s->material, motion, NULL));
        end(&all);

        motion[subdomains / 2].linear[0] = 2 + 0.01 * r;
        begin(&one);
        OK(bw_subdomain_stiffness_update(context, s, mesh, s->material, motion, NULL));
        end(&one);

        motion[subdomains / 2].reshaped = true;
        for (int64_t i = 0; i < mesh->node_count; i++)
          for (int k = 0; k < 3; k++)
            node[3 * i + k] = (k ? 1 : 1 + 0.01 * r) * mesh->node[3 * i + k];
        OK(bw_mesh_moved(context, mesh, node, &moved));
        begin(&gathered);
        OK(bw_subdomain_stiffness_update(context, s, moved, s->material, motion, NULL));
        end(&gathered);
        bw_release(moved);
      }
      printf("  {\"material\": \"%s\", \"threads\": %d, \"milliseconds_create\": %.1f, "
             "\"milliseconds_direct\": %.2f, \"milliseconds_polynomials_all\": %.2f, "
             "\"milliseconds_one_subdomain\": %.3f, \"milliseconds_one_gathered\": %.3f, "
             "\"ratio_all\": %.2f, \"ratio_one\": %.1f, \"ratio_gathered\": %.1f, "
             "\"ratio_all_processor\": %.2f, \"processor_direct\": %.2f, "
             "\"processor_all\": %.2f, \"processor_one\": %.3f, \"processor_gathered\": %.3f, "
             "\"bytes\": %zu, \"bytes_entries\": "
             "%lld}%s\n",
             m ? "orthotropic" : "isotropic", threads, 1e3 * create, 1e3 * direct.clock,
             1e3 * all.clock, 1e3 * one.clock, 1e3 * gathered.clock, direct.clock / all.clock,
             direct.clock / one.clock, direct.clock / gathered.clock,
             direct.processor / all.processor, 1e3 * direct.processor, 1e3 * all.processor,
             1e3 * one.processor, 1e3 * gathered.processor, bw_subdomain_stiffness_bytes(s),
             (long long)pattern->block_count * 72, threads == 2 && m ? "" : ",");
      bw_release(s);
    }
  printf("]}\n");
  free(of_element), free(of_node), free(motion), free(values), free(node);
  bw_release(pattern);
  bw_release(mesh);
  bw_release(material[0]);
  bw_release(material[1]);
  bw_context_destroy(context);
  return 0;
}
