/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Building a library of neo-Hookean materials of 1e5, 1e6, 1e7 Pa (Poisson's ratio 0.45), as in
 * data-driven, and writing it:
 *   build/tests/bench_library out.bwm [materials] [levels] [directions] [checkpoint] */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "bench/bench.h"

static void progress(void *data, const char *stage, double fraction) {
  double *last = (double *)data;
  if (bw_seconds() - *last < 10)
    return;
  *last = bw_seconds();
  fprintf(stderr, "%s: %.1f %%\n", stage, 100 * fraction);
}

int main(int arguments, char **argument) {
  static const double young[] = {1e5, 1e6, 1e7, 3e5, 3e6, 3e7, 1e8};
  bw_context *context = bw_context_create();
  int materials = arguments > 2 ? atoi(argument[2]) : 3;
  bw_solid_material *material[7];
  bw_material_table *material_table;
  bw_library_options options;
  bw_library *library, *read;
  char *text;
  struct stat file;
  double last = bw_seconds();
  if (!context || arguments < 2 || materials < 1 || materials > 7) {
    fprintf(stderr,
            "usage: bench_library out.bwm [materials] [levels] [directions] [checkpoint]\n");
    return 1;
  }
  bw_library_options_default(&options);
  options.levels = arguments > 3 ? atoi(argument[3]) : 1;
  options.directions = arguments > 4 ? atoi(argument[4]) : options.directions;
  for (int m = 0; m < materials; m++)
    OK(bw_solid_material_create(context, "", BW_NEO_HOOKEAN, young[m], 0.45, 1000, &material[m]));
  OK(bw_material_table_create(context, materials + 1, (const bw_solid_material *const *)material,
                              &material_table));
  bw_set_progress(context, progress, &last);
  OK(bw_library_build(context, material_table, &options, arguments > 5 ? argument[5] : NULL,
                      &library));
  OK(bw_library_write(context, library, argument[1]));
  double start = bw_seconds();
  OK(bw_library_read(context, argument[1], &read));
  start = bw_seconds() - start;
  OK(bw_library_describe(context, library, &text));
  fputs(text, stdout);
  stat(argument[1], &file);
  printf("{\"threads\": %d, \"fits\": [%d, %d], \"seconds\": %.4g, \"seconds_per_fit_and_thread\": "
         "%.4g, \"file_bytes\": %lld, \"read_ms\": %.3g}\n",
         bw_threads(context), (int)library->fit_count[0], (int)library->fit_count[1],
         library->seconds,
         library->seconds * bw_threads(context) / (library->fit_count[0] + library->fit_count[1]),
         (long long)file.st_size, 1e3 * start);
  bw_free(text);
  bw_release(read);
  bw_release(library);
  bw_release(material_table);
  for (int m = 0; m < materials; m++)
    bw_release(material[m]);
  bw_context_destroy(context);
  return 0;
}
