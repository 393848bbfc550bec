/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Progress of long work on standard error: stage, percent, time so far and to go. Stages that end
 * within a second do not show. The time to go is that of the stage: time so far * what is left /
 * done. What follows a semicolon in the name of a stage is a part of it: the times go on. */
#include "program.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double first_after = 1, again_after = 0.2, line_every = 60;

static struct {
  char stage[64]; /* without what follows a semicolon */
  double began, shown;
  bool open; /* the cursor stands behind a line that is to be written over */
} line;

void program_progress_clear(void) {
  if (line.open)
    fputs("\r\033[K", stderr);
  line.open = false;
}

static void duration(double seconds, const char *what, char text[32]) {
  if (!isfinite(seconds) || seconds > 360000)
    text[0] = 0;
  else if (seconds >= 3600)
    snprintf(text, 32, ", %d h %02d min %s", (int)seconds / 3600, (int)seconds / 60 % 60, what);
  else if (seconds >= 90)
    snprintf(text, 32, ", %d min %s", (int)(seconds / 60 + 0.5), what);
  else
    snprintf(text, 32, ", %d s %s", (int)ceil(seconds), what);
}

void program_progress(void *data, const char *stage, double fraction) {
  (void)data;
  double now = bw_seconds();
  bool terminal = isatty(STDERR_FILENO);
  size_t length = strcspn(stage, ";");
  if (length >= sizeof line.stage)
    length = sizeof line.stage - 1;
  bool part = stage[strcspn(stage, ";")] != 0; /* a part may end without the stage */
  if (strncmp(stage, line.stage, length) != 0 || line.stage[length]) {
    snprintf(line.stage, sizeof line.stage, "%.*s", (int)length, stage);
    line.began = now;
    line.shown = terminal ? now + first_after - again_after : now;
  }
  if (terminal && fraction >= 1 && !part) {
    program_progress_clear();
    return;
  }
  if (now - line.shown < (terminal ? again_after : line_every))
    return;
  line.shown = now;
  fraction = fraction < 0 ? 0 : fraction > 1 ? 1 : fraction;
  char so_far[32], to_go[32] = "";
  duration(now - line.began, "so far", so_far);
  if (fraction > 0.01)
    duration((now - line.began) * (1 - fraction) / fraction, "to go", to_go);
  fprintf(stderr, "%s%s: %d %%%s%s%s", terminal ? "\r" : "", stage, (int)(100 * fraction), so_far,
          to_go, terminal ? "\033[K" : "\n");
  fflush(stderr);
  line.open = terminal;
}
