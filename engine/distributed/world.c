/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The processes: joining, leaving, commands, agreement, byte strings. */
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <slepcsys.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "distributed/internal.h"

#define LONGEST_PAUSE 1e-3 /* s */
#define MAX_WAIT 60.0      /* s that a failed rank waits for the others to come to an agreement */
enum { COMMAND_TAG = 1, MESSAGE = 1000, MAX_TAG = 1000, SPINS = 20 };

static struct world {
  pid_t process; /* that joined; a forked child is none of the world */
  int rank, size;
  int together; /* ranks on this machine */
  MPI_Comm work, talk;
  bool libraries, served, ended;
} world = {.size = 1, .together = 1};

static char petsc_text[MESSAGE]; /* of the last error that PETSc raised */

/* ---- waiting --------------------------------------------------------------------------------- */

void bwd_pause(bwd_backoff *backoff) {
  if (backoff->rounds++ == 0)
    backoff->since = bw_seconds();
  if (backoff->rounds < SPINS)
    return;
  double pause = 2e-5 * (backoff->rounds - SPINS + 1);
  if (pause > LONGEST_PAUSE)
    pause = LONGEST_PAUSE;
  struct timespec span = {0, (long)(pause * 1e9)};
  nanosleep(&span, NULL);
}

/* ---- joining and leaving --------------------------------------------------------------------- */

static bool ours(void) {
  return world.process != 0 && world.process == getpid();
}

static bw_status need_world(bw_context *context) {
  if (ours())
    return BW_OK;
  if (world.process <= 0)
    return bw_fail(context, BW_INVALID,
                   "MPI is not started in this process: call "
                   "require(\"barwright.distributed\").start() first");
  return bw_fail(context, BW_UNSUPPORTED,
                 "a forked job cannot use MPI: it belongs to no rank. Solve with the engine's own "
                 "factor in trials, or run one trial at a time outside of jobs");
}

static void leave(void) {
  if (!ours() || world.ended)
    return;
  world.ended = true;
  int finished = 0;
  MPI_Finalized(&finished);
  if (finished)
    return;
  if (world.rank == 0) {
    int operation = BWD_END;
    for (int r = 1; r < world.size; r++)
      MPI_Send(&operation, 1, MPI_INT, r, COMMAND_TAG, world.work);
  }
  if (world.libraries)
    SlepcFinalize();
  MPI_Finalize();
  /* Exit handlers of libraries may wait for ever where memory ran out; rank 0 has the results. */
  if (world.served) {
    fflush(NULL);
    _exit(0);
  }
}

/* Threads of OpenMP beside the ranks would only be in each other's way. */
static void one_thread(void) {
  void (*set)(int);
  void *found = dlsym(RTLD_DEFAULT, "openblas_set_num_threads");
  memcpy(&set, &found, sizeof set);
  if (set)
    set(1);
  found = dlsym(RTLD_DEFAULT, "omp_set_num_threads");
  memcpy(&set, &found, sizeof set);
  if (set)
    set(1);
}

bw_status bw_world_start(bw_context *context, bool together) {
  if (world.process > 0)
    return need_world(context);
  int ready = 0, provided;
  /* Open MPI's plug-ins look for its symbols among the global ones. */
  dlopen("libmpi.so.40", RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
  /* A rank that waits inside MPI lets others have the processor; where there are no others it costs
   * nothing. With more ranks than processors, solves are two to three times faster for it. */
  setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
  MPI_Initialized(&ready);
  int size = world.size;
  if (world.process < 0)
    goto refuse;
  if (!ready && MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS)
    return bw_fail(context, BW_UNSUPPORTED, "MPI could not be started");
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  world.size = size;
  if (size > 1 && !together) {
    MPI_Finalize();
    world.process = -1;
    goto refuse;
  }
  MPI_Comm_rank(MPI_COMM_WORLD, &world.rank);
  MPI_Comm machine;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &world.together);
  MPI_Comm_free(&machine);
  MPI_Comm_dup(MPI_COMM_WORLD, &world.work);
  MPI_Comm_dup(MPI_COMM_WORLD, &world.talk);
  world.process = getpid();
  one_thread();
  atexit(leave);
  if (world.rank == 0)
    bw_external_register(&bwd_external);
  return BW_OK;
refuse:
  return bw_fail(context, BW_UNSUPPORTED,
                 "mpirun started %d processes, and each runs this script by itself. Start them as "
                 "`mpirun -n %d barwright --mpi script.lua`, or let the script begin with "
                 "require(\"barwright.distributed\").start()",
                 size, size);
}

int bw_world_rank(void) {
  return world.rank;
}

int bw_world_size(void) {
  return world.size;
}

MPI_Comm bwd_comm(void) {
  return world.work;
}

void bw_world_abort(const char *message) {
  fprintf(stderr, "barwright: rank %d of %d: %s\n", world.rank, world.size, message);
  fflush(NULL);
  if (ours() && !world.ended)
    MPI_Abort(MPI_COMM_WORLD, 1);
  _exit(1);
}

/* ---- PETSc ----------------------------------------------------------------------------------- */

/* Keeps what PETSc says; where it was called from is of no use to whoever called us. */
static PetscErrorCode keep_error(MPI_Comm comm, int line, const char *function, const char *file,
                                 PetscErrorCode code, PetscErrorType type, const char *text,
                                 void *data) {
  (void)comm, (void)line, (void)file, (void)data;
  if (type == PETSC_ERROR_INITIAL)
    snprintf(petsc_text, sizeof petsc_text, "%s (in %s)", text && *text ? text : "no reason given",
             function ? function : "?");
  return code;
}

bw_status bwd_petsc_status(bw_context *context, PetscErrorCode code) {
  if (code == 0)
    return BW_OK;
  if (bw_message(context)[0] && code == PETSC_ERR_USER) /* ours, passed through PETSc */
    return BW_CONVERGENCE;
  bw_status status = code == PETSC_ERR_MEM ? BW_MEMORY : BW_UNSUPPORTED;
  return bw_fail(context, status, "PETSc stopped with error %d: %s", (int)code, petsc_text);
}

bw_status bwd_libraries(bw_context *context) {
  bw_status status = BW_OK;
  if (world.libraries)
    return BW_OK;
  /* PETSc would read a file of options in the working folder, and catch signals. */
  static char *words[] = {"barwright", "-skip_petscrc", "-no_signal_handler", NULL};
  int count = 3;
  char **list = words;
  BWD_TRY(SlepcInitialize(&count, &list, NULL, NULL));
  world.libraries = true;
  BWD_TRY(PetscPushErrorHandler(keep_error, NULL));
done:
  return status;
}

bw_status bw_world_versions(bw_context *context, char **text) {
  enum { SIZE = MPI_MAX_LIBRARY_VERSION_STRING + 200 };
  char mpi[MPI_MAX_LIBRARY_VERSION_STRING] = "";
  int length = 0;
  MPI_Get_library_version(mpi, &length);
  mpi[strcspn(mpi, ",\n")] = 0;
  char *out = BW_NEW(context, char, SIZE);
  if (!out)
    return BW_MEMORY;
  snprintf(out, SIZE, "%s\nPETSc %d.%d.%d\nSLEPc %d.%d.%d\n", mpi, PETSC_VERSION_MAJOR,
           PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR, SLEPC_VERSION_MAJOR, SLEPC_VERSION_MINOR,
           SLEPC_VERSION_SUBMINOR);
  *text = out;
  return BW_OK;
}

/* ---- commands and agreement ------------------------------------------------------------------ */

int bwd_ranks_together(void) {
  return world.together;
}

bw_status bwd_command(bw_context *context, bwd_operation operation) {
  bw_status status = need_world(context);
  if (status != BW_OK)
    return status;
  int word = operation;
  for (int r = 1; r < world.size; r++)
    MPI_Send(&word, 1, MPI_INT, r, COMMAND_TAG, world.work);
  return BW_OK;
}

bw_status bw_world_serve(bw_context *context) {
  bw_status status = need_world(context);
  if (status == BW_OK && !getenv("BARWRIGHT_THREADS")) {
    int threads = bw_threads(context) / world.together;
    status = bw_set_threads(context, threads > 1 ? threads : 1);
  }
  if (status != BW_OK)
    return status;
  for (;;) {
    bwd_backoff backoff = {0};
    int there = 0, operation = 0;
    for (;;) {
      MPI_Iprobe(0, COMMAND_TAG, world.work, &there, MPI_STATUS_IGNORE);
      if (there)
        break;
      bwd_pause(&backoff);
    }
    MPI_Recv(&operation, 1, MPI_INT, 0, COMMAND_TAG, world.work, MPI_STATUS_IGNORE);
    bw_clear_failure(context);
    /* All ranks have the same failure: rank 0 reports it. */
    if (operation == BWD_OPEN)
      bwd_run_open(context, NULL, NULL);
    else if (operation == BWD_MULTIPLY)
      bwd_run_multiply(context, 0, NULL, NULL, NULL, NULL);
    else if (operation == BWD_SOLVE)
      bwd_run_solve(context, 0, NULL, NULL);
    else if (operation == BWD_MODES)
      bwd_run_modes(context, NULL, NULL);
    else if (operation == BWD_WRITE)
      bwd_run_write(context, NULL);
    else if (operation == BWD_REPORT)
      bwd_run_report(NULL);
    else if (operation == BWD_CLOSE)
      bwd_run_close();
    else {
      world.served = true;
      return BW_OK;
    }
  }
}

bw_status bwd_agree(bw_context *context, bw_status status) {
  struct {
    int status, rank;
  } own = {status < 0 ? BW_INTERNAL : (int)status, world.rank}, worst = {0, 0};
  if (world.size == 1)
    return status;
  MPI_Request request;
  MPI_Iallreduce(&own, &worst, 1, MPI_2INT, MPI_MAXLOC, world.work, &request);
  bwd_backoff backoff = {0};
  int there = 0;
  for (;;) {
    MPI_Test(&request, &there, MPI_STATUS_IGNORE);
    if (there)
      break;
    bwd_pause(&backoff);
    if (status != BW_OK && backoff.rounds > SPINS && bw_seconds() - backoff.since > MAX_WAIT) {
      char text[MESSAGE + 200];
      snprintf(
          text, sizeof text,
          "%s. The other ranks have not come to the same end within %.0f s, so all are stopped",
          bw_message(context), MAX_WAIT);
      bw_world_abort(text);
    }
  }
  if (worst.status == BW_OK)
    return BW_OK;
  char text[MESSAGE] = "";
  if (world.rank == worst.rank)
    snprintf(text, sizeof text, "%s", bw_message(context));
  MPI_Bcast(text, MESSAGE, MPI_CHAR, worst.rank, world.work);
  if (world.rank != worst.rank) {
    bw_fail(context, (bw_status)worst.status, "rank %d of %d: %s", worst.rank, world.size, text);
    bw_detail_number(context, "rank", worst.rank);
  }
  return (bw_status)worst.status;
}

bool bwd_cancelled(bw_context *context) {
  int flag = world.rank == 0 && bw_cancelled(context);
  if (world.size > 1)
    MPI_Bcast(&flag, 1, MPI_INT, 0, world.work);
  return flag != 0;
}

/* ---- byte strings ---------------------------------------------------------------------------- */

bw_status bw_world_send(bw_context *context, int rank, int tag, const void *bytes, size_t count) {
  bw_status status = need_world(context);
  if (status != BW_OK)
    return status;
  if (rank < 0 || rank >= world.size || rank == world.rank)
    return bw_fail(context, BW_INVALID,
                   "rank %d is not another rank: there are %d, numbered from 0", rank, world.size);
  if (tag < 0 || tag > MAX_TAG)
    return bw_fail(context, BW_INVALID, "the tag is %d; it must lie between 0 and %d", tag,
                   MAX_TAG);
  if (count > INT_MAX)
    return bw_fail(context, BW_LIMIT, "a string of %zu bytes is too long to send; at most %d",
                   count, INT_MAX);
  MPI_Request request;
  MPI_Isend(bytes, (int)count, MPI_BYTE, rank, tag, world.talk, &request);
  bwd_backoff backoff = {0};
  for (int sent = 0; !sent;) {
    MPI_Test(&request, &sent, MPI_STATUS_IGNORE);
    if (!sent)
      bwd_pause(&backoff);
  }
  return BW_OK;
}

/* Whoever waits for strings must not wait for ever when rank 0 ends: it sends a command to all. */
static bool rank_0_left(void) {
  int there = 0;
  if (world.rank > 0)
    MPI_Iprobe(0, COMMAND_TAG, world.work, &there, MPI_STATUS_IGNORE);
  return there;
}

bw_status bw_world_receive(bw_context *context, double seconds, int *rank, int *tag,
                           unsigned char **bytes, size_t *count) {
  bw_status status = need_world(context);
  if (status != BW_OK)
    return status;
  *bytes = NULL;
  *count = 0;
  MPI_Status found;
  bwd_backoff backoff = {0};
  double until = bw_seconds() + seconds;
  for (int there = 0;;) {
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, world.talk, &there, &found);
    if (there)
      break;
    if (seconds >= 0 && bw_seconds() >= until)
      return BW_OK;
    if (rank_0_left())
      return bw_fail(context, BW_IO, "rank 0 has ended: no message can arrive");
    if ((status = bw_check_cancel(context)) != BW_OK)
      return status;
    bwd_pause(&backoff);
  }
  int size = 0;
  MPI_Get_count(&found, MPI_BYTE, &size);
  unsigned char *out = BW_NEW(context, unsigned char, size);
  if (!out)
    return BW_MEMORY; /* the string stays where it is */
  MPI_Recv(out, size, MPI_BYTE, found.MPI_SOURCE, found.MPI_TAG, world.talk, MPI_STATUS_IGNORE);
  *rank = found.MPI_SOURCE;
  *tag = found.MPI_TAG;
  *bytes = out;
  *count = (size_t)size;
  return BW_OK;
}
