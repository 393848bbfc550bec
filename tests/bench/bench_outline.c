/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What a move of an outline costs, with the checks that it is still valid, beside the plainest
 * check there is: all pairs of edges (of lines, or of cubics as ten chords each). Built with the
 * tests, run by hand: build/tests/bench_outline [edges] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "bench/bench.h"

enum { CHORDS = 10, REPEATS = 41 };

static double turn(const double *a, const double *b, const double *c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static int all_pairs(const double *p, int n) {
  int crossings = 0;
  for (int i = 0; i < n; i++)
    for (int j = i + 2; j < n; j++) {
      const double *a = p + 2 * i, *b = p + 2 * ((i + 1) % n);
      const double *c = p + 2 * j, *d = p + 2 * ((j + 1) % n);
      crossings += (turn(a, b, c) > 0) != (turn(a, b, d) > 0) &&
                   (turn(c, d, a) > 0) != (turn(c, d, b) > 0) && (j + 1) % n != i;
    }
  return crossings;
}

/* A wavy ring: of lines, or of cubics whose control points lie on it too. */
static bw_outline *ring(bw_context *context, int edges, int per_edge) {
  int points = edges * per_edge;
  double *point = malloc(sizeof(double) * 2 * (size_t)points);
  bw_segment *segment = malloc(sizeof *segment * (size_t)edges);
  bw_loop loop = {0, edges, 0, -1, {"ring"}};
  bw_outline *outline = NULL;
  for (int i = 0; i < points; i++) {
    double a = 2 * 3.14159265358979323846 * i / points, r = 1 + 0.2 * cos(9 * a);
    point[2 * i] = r * cos(a);
    point[2 * i + 1] = r * sin(a);
  }
  for (int s = 0; s < edges; s++) {
    int32_t first = s * per_edge, next = (s + 1) % edges * per_edge;
    bool curve = per_edge == 3;
    segment[s] = (bw_segment){{first, curve ? first + 1 : -1, curve ? first + 2 : -1, next}, 0};
  }
  OK(bw_outline_create(context, points, point, edges, segment, 1, &loop, 0, NULL, &outline));
  free(point);
  free(segment);
  return outline;
}

int main(int count, char **argument) {
  int edges = count > 1 ? atoi(argument[1]) : 200;
  bw_context *context = bw_context_create();
  for (int per_edge = 1; per_edge <= 3; per_edge += 2) {
    bw_outline *outline = ring(context, edges, per_edge);
    int chords = per_edge == 3 ? CHORDS : 1, n = edges * chords, found = 0;
    double *sample = malloc(sizeof(double) * 2 * (size_t)n), best[2] = {HUGE_VAL, HUGE_VAL};
    for (int i = 0; i < n; i++)
      bw_outline_evaluate(outline, i / chords, (double)(i % chords) / chords, sample + 2 * i, NULL,
                          NULL);
    for (int r = 0; r < REPEATS; r++) {
      bw_outline *moved = NULL;
      clock_t begin = clock();
      for (int i = 0; i < 20; i++) {
        OK(bw_outline_moved(context, outline, outline->point, &moved));
        bw_release(moved);
      }
      best[0] = fmin(best[0], (double)(clock() - begin) / CLOCKS_PER_SEC / 20);
      begin = clock();
      found += all_pairs(sample, n);
      best[1] = fmin(best[1], (double)(clock() - begin) / CLOCKS_PER_SEC);
    }
    printf("{\"edges\": %d, \"kind\": \"%s\", \"seconds_move\": %.3g, \"seconds_all_pairs\": %.3g, "
           "\"crossings\": %d}\n",
           edges, per_edge == 3 ? "cubics" : "lines", best[0], best[1], found);
    free(sample);
    bw_release(outline);
  }
  bw_context_destroy(context);
  return 0;
}
