/* Running work in a forked child process with limits on time and memory, for libraries that may
 * hang, fill memory, abort or crash on wild input. Whatever happens in the child, the caller gets
 * a status and a message.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_BASE_CHILD_H
#define BARWRIGHT_BASE_CHILD_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bwi_child_limits {
  double seconds; /* of computing; 0: no limit */
  double bytes;   /* of address space beyond what the process has at the fork; 0: no limit */
  double *spent;  /* the seconds of computing are added to it; may be NULL */
} bwi_child_limits;

typedef struct bwi_child_stream bwi_child_stream;

/* Called in the child with a context of its own: one thread, no memory of the caller's failures;
 * bw_progress in it reaches the caller's progress function. Everything in memory at the fork can be
 * read; what is written there is lost. A failure goes to the caller with message and details. The
 * child's standard output and error go to /dev/null, other files are closed. */
typedef bw_status bwi_child_work(bw_context *context, void *data, bwi_child_stream *out);

/* Append bytes to what the caller will receive. BW_IO when the caller is gone. */
bw_status bwi_child_write(bwi_child_stream *out, const void *bytes, size_t count);

/* Fork, run the work, collect what it wrote: a block of *count bytes, released with bw_free. `what`
 * names the work in messages ("filling the surface with TetGen").
 *   BW_LIMIT       time or memory ran out (detail "limit": "time" or "memory"); child killed
 *   BW_CANCELLED   bw_cancel was called; child killed
 *   BW_GEOMETRY    the child crashed, aborted or left early (detail "signal")
 *   the work's own status, message and details otherwise */
bw_status bwi_child_run(bw_context *context, const char *what, const bwi_child_limits *limits,
                        bwi_child_work *work, void *data, unsigned char **bytes, size_t *count);

#ifdef __cplusplus
}
#endif
#endif
