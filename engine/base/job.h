/* What base shares of jobs. */
/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_BASE_JOB_H
#define BARWRIGHT_BASE_JOB_H

#include <sys/types.h>

#include "barwright/job.h"

/* What travels from the child: a head and a payload. */
enum bwi_frame_kind { BWI_DATA = 1, BWI_PROGRESS, BWI_DETAIL, BWI_FAILED, BWI_DONE };
typedef struct bwi_message_frame {
  uint32_t kind;
  int32_t value; /* FAILED: the status */
  uint64_t length;
  double seconds; /* since the fork */
} bwi_message_frame;

/* Reports the last progress again, so that the caller can cancel work that reports nothing. */
void bwi_progress_again(bw_context *context);

typedef struct bwi_progress_line {
  double fraction;
  char stage[64];
} bwi_progress_line;

typedef struct bwi_detail_line {
  char key[64];
  double number;
  bool is_text;
  char text[256];
} bwi_detail_line;

enum { BWI_JOB_TEXT = 2048, BWI_JOB_DETAILS = 12 }; /* longest payload that is no DATA; details */

struct bw_job {
  bw_object object;
  char name[128];
  double seconds_limit, processor_limit, bytes_limit;
  bool show;
  pid_t starter, child;
  int pipe; /* to read from; -1 once the job has ended */
  double start;
  bw_job_usage usage;
  char stage[64];
  bool silent_death; /* the process is gone, the pipe may hold its last words */

  unsigned char *bytes; /* DATA payloads so far */
  size_t count, capacity;
  bwi_message_frame head;
  size_t head_held; /* bytes of the head that have come */
  uint64_t left;    /* bytes of the payload still to come */
  char payload[BWI_JOB_TEXT];
  size_t payload_held;
  bool last_frame;   /* DONE or FAILED has come */
  bw_status failure; /* of FAILED, or BW_MEMORY here */
  int exit_code;     /* of a process that was left early; -1: a signal */
  int detail_count;
  bwi_detail_line detail[BWI_JOB_DETAILS];

  bw_job *previous, *next; /* in the list */
};

/* The child's whole life from the fork on: `pipe` is its end, `output` a file or -1. */
_Noreturn void bwi_job_child(bw_context *context, const bw_job_options *options, bw_job_work *work,
                             void *data, int pipe, int output, int parent);

/* Make a context that came through a fork fit for the child: its threads are forgotten (they are
 * not there), and so are its failure, warnings, progress function and request to cancel. */
void bwi_context_forked(bw_context *context);

/* Bytes of address space: in use (0 where nobody says), and left to this process by a limit on it
 * (infinite where there is none). */
double bwi_address_space(void);
double bwi_address_space_left(void);

/* Hands over what bw_job_result shows: released with bw_free. */
unsigned char *bwi_job_take(bw_job *job);

#endif
