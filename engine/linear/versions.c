/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which libraries are in use, as they are found at run time where they can tell. */
#include <stdio.h>
#include <string.h>

#include <cholmod.h>
#include <glpk.h>
#include <metis.h>
#include <zlib.h>

#include "linear/internal.h"

const char *cairo_version_string(void);
char *openblas_get_config(void);
char *openblas_get_corename(void);
int openblas_get_parallel(void);

bw_status bw_library_versions(bw_context *context, char **text) {
  static const char *const threading[] = {"single-threaded", "pthread", "OpenMP"};
  enum { SIZE = 2048 };
  char *out = BW_NEW(context, char, SIZE);
  if (!out)
    return BW_MEMORY;
  int parallel = openblas_get_parallel(), cholmod[3];
  cholmod_version(cholmod);
  snprintf(out, SIZE,
           "%s (%s, %s variant)%s\n"
           "CHOLMOD %d.%d.%d\n"
           "METIS %d.%d.%d\n"
           "ARPACK-ng %s\n"
           "GLPK %s\n"
           "zlib %s\n"
           "cairo %s\n",
           openblas_get_config(), openblas_get_corename(),
           parallel >= 0 && parallel <= 2 ? threading[parallel] : "unknown",
           parallel == 2 ? ": the OpenMP variant is several times slower here; install "
                           "libopenblas0-pthread"
                         : "",
           cholmod[0], cholmod[1], cholmod[2], METIS_VER_MAJOR, METIS_VER_MINOR, METIS_VER_SUBMINOR,
           ARPACK_VERSION, glp_version(), zlibVersion(), cairo_version_string());
  *text = out;
  return BW_OK;
}
