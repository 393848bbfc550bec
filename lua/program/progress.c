/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Progress of long work on standard error: stage, percent, time to go. Stages that end within a
 * second do not show. The time to go is that of the stage: time so far * what is left / done. */
#include "program.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double first_after = 1, again_after = 0.2, line_every = 60;

static struct {
  char stage[64];
  double began, shown;
  bool open; /* the cursor stands behind a line that is to be written over */
} line;

void program_progress_clear(void) {
  if (line.open)
    fputs("\r\033[K", stderr);
  line.open = false;
}

static void time_to_go(double seconds, char text[32]) {
  if (!isfinite(seconds) || seconds > 360000)
    text[0] = 0;
  else if (seconds >= 3600)
    snprintf(text, 32, ", %d h %02d min to go", (int)seconds / 3600, (int)seconds / 60 % 60);
  else if (seconds >= 90)
    snprintf(text, 32, ", %d min to go", (int)(seconds / 60 + 0.5));
  else
    snprintf(text, 32, ", %d s to go", (int)ceil(seconds));
}

void program_progress(void *data, const char *stage, double fraction) {
  (void)data;
  double now = bw_seconds();
  bool terminal = isatty(STDERR_FILENO);
  if (strncmp(stage, line.stage, sizeof line.stage - 1) != 0) {
    snprintf(line.stage, sizeof line.stage, "%s", stage);
    line.began = now;
    line.shown = terminal ? now + first_after - again_after : now;
  }
  if (terminal && fraction >= 1) {
    program_progress_clear();
    return;
  }
  if (now - line.shown < (terminal ? again_after : line_every))
    return;
  line.shown = now;
  fraction = fraction < 0 ? 0 : fraction > 1 ? 1 : fraction;
  char to_go[32] = "";
  if (fraction > 0.01)
    time_to_go((now - line.began) * (1 - fraction) / fraction, to_go);
  fprintf(stderr, "%s%s: %d %%%s%s", terminal ? "\r" : "", line.stage, (int)(100 * fraction), to_go,
          terminal ? "\033[K" : "\n");
  fflush(stderr);
  line.open = terminal;
}
