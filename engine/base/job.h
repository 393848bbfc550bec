/* What base shares of jobs. */
/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_BASE_JOB_H
#define BARWRIGHT_BASE_JOB_H

#include "barwright/job.h"

/* What travels from the child: a head and a payload. */
enum bwi_frame_kind { BWI_DATA = 1, BWI_PROGRESS, BWI_DETAIL, BWI_FAILED, BWI_DONE };
typedef struct bwi_frame {
  uint32_t kind;
  int32_t value; /* FAILED: the status */
  uint64_t length;
  double seconds; /* since the fork */
} bwi_frame;

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

enum { BWI_JOB_TEXT = 2048 }; /* longest payload that is no DATA */

/* The child's whole life from the fork on: `pipe` is its end, `output` a file or -1. */
_Noreturn void bwi_job_child(bw_context *context, const bw_job_options *options, bw_job_work *work,
                             void *data, int pipe, int output, int parent);

/* Make a context that came through a fork fit for the child: its threads are forgotten (they are
 * not there), and so are its failure, remarks, progress function and wish to cancel. */
void bwi_context_forked(bw_context *context);

/* Hands over what bw_job_result shows: released with bw_free. */
unsigned char *bwi_job_take(bw_job *job);

#endif
