/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A kernel that refuses nothing, in the place of lua/program/kernel.c: the test program first_wall
 * shows what the sandbox's first wall holds alone. */
#include "program.h"

program_walls program_close_kernel(const char *folder, const char *const *readable) {
  (void)folder, (void)readable;
  return (program_walls){0, false};
}
