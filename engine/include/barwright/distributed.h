/* distributed: several processes under MPI. A library of its own (libbarwright_distributed, over
 * MPI, PETSc and SLEPc), which nothing else links: a program that wants it loads it.
 *
 * Rank 0 decides. The others serve it in one of two ways: bw_world_serve works for the solver that
 * is registered on rank 0 (bw_external, external.h); bw_world_send and bw_world_receive exchange
 * byte strings whose meaning is the caller's. A rank that waits sleeps. */
#ifndef BARWRIGHT_DISTRIBUTED_H
#define BARWRIGHT_DISTRIBUTED_H

#include "barwright/external.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Join the other processes that mpirun started (alone: a world of one), and on rank 0 register the
 * solver. Once per process; later calls do nothing. MPI is finalised when the process exits.
 * `together`: every process calls this at the same time; without it, a world of more than one rank
 * is refused (BW_UNSUPPORTED), since each rank would run the whole script by itself. */
BW_API bw_status bw_world_start(bw_context *context, bool together);
/* This process's rank, 0 to size - 1; before the start 0 of 1. A forked child of a rank belongs to
 * no world: there, all that follows is BW_UNSUPPORTED; before the start, BW_INVALID. */
BW_API int bw_world_rank(void);
/* How many ranks there are. */
BW_API int bw_world_size(void);

/* On ranks other than 0: work for the solver of rank 0 until that one leaves. BW_UNSUPPORTED in a
 * forked child. */
BW_API bw_status bw_world_serve(bw_context *context);

/* Sends `count` bytes to a `rank` under a `tag` from 0 to 1000; a string comes whole, and those
 * from one rank in the order sent. Sending may wait until the other rank receives. BW_LIMIT beyond
 * what one message can hold, BW_UNSUPPORTED in a forked child. */
BW_API bw_status bw_world_send(bw_context *context, int rank, int tag, const void *bytes,
                               size_t count);
/* The next string from any rank, with its *rank and *tag. *bytes is NULL when none came within
 * `seconds` (0: look once; negative: wait as long as it takes); release with bw_free. BW_IO when
 * rank 0 has left, BW_UNSUPPORTED in a forked child. */
BW_API bw_status bw_world_receive(bw_context *context, double seconds, int *rank, int *tag,
                                  unsigned char **bytes, size_t *count);

/* End all ranks now, with a `message` on standard error: for failures of one rank alone. */
BW_API void bw_world_abort(const char *message);

/* A *text of "Open MPI 4.1.4", PETSc and SLEPc with versions, one line each. Release it with
 * bw_free. */
BW_API bw_status bw_world_versions(bw_context *context, char **text);

#ifdef __cplusplus
}
#endif
#endif
