/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The caller's side of a run of TetGen: start the child, take its mesh apart; and the wanted sizes,
 * which the child asks for at every element. */
#include "mesh/tetgen_run.h"

#include <math.h>
#include <string.h>

bw_status bwi_tetgen_run(bw_context *context, const bwi_tetgen_job *job,
                         bwi_tetgen_result *result) {
  unsigned char *bytes = NULL;
  size_t count = 0;
  int64_t counts[2];
  double *node = NULL;
  int32_t *element = NULL, *subdomain = NULL;
  size_t bytes_each = job->subdomains ? 20 : 16; /* of an element */
  bw_status status;
  BW_TRY(bwi_child_run(context, "filling the surface with TetGen", &job->limits, bwi_tetgen_child,
                       (void *)job, &bytes, &count));
  if (count >= sizeof counts)
    memcpy(counts, bytes, sizeof counts);
  if (count < sizeof counts || counts[0] < 4 || counts[1] < 1 || counts[0] > INT32_MAX ||
      counts[1] > INT32_MAX ||
      count != sizeof counts + (size_t)counts[0] * 24 + (size_t)counts[1] * bytes_each)
    BW_TRY(bw_fail(context, BW_INTERNAL, "%zu bytes from TetGen's process are not a mesh", count));
  node = BW_NEW(context, double, 3 * counts[0]);
  element = BW_NEW(context, int32_t, 4 * counts[1]);
  if (job->subdomains)
    subdomain = BW_NEW(context, int32_t, counts[1]);
  BW_TRY_MEMORY(node && element && (!job->subdomains || subdomain));
  memcpy(node, bytes + sizeof counts, (size_t)counts[0] * 24);
  memcpy(element, bytes + sizeof counts + (size_t)counts[0] * 24, (size_t)counts[1] * 16);
  if (subdomain)
    memcpy(subdomain, bytes + count - (size_t)counts[1] * 4, (size_t)counts[1] * 4);
  *result = (bwi_tetgen_result){counts[0], counts[1], node, element, subdomain};
done:
  bw_free(bytes);
  if (status != BW_OK) {
    bw_free(node);
    bw_free(element);
    bw_free(subdomain);
  }
  return status;
}
