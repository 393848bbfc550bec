/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Nodes and elements of MSH 2.2. Text: "id x y z", "id type ntags tags... nodes...". Binary: the
 * count as text, then int32 id and three doubles; elements in runs of one type, all int32. */
#include "io/msh.h"

bw_status bwi_msh22_nodes(bwi_msh *msh) {
  bw_status status = BW_OK;
  int64_t count, *id = NULL;
  BW_TRY(bwi_read_count(msh->cursor, msh->binary ? 28 : 8, &count, "the number of nodes"));
  if (msh->binary)
    bwi_skip_line(msh->cursor);
  id = BW_NEW(msh->raw->context, int64_t, count);
  if (!id)
    return BW_MEMORY;
  for (int64_t i = 0; i < count; i++) {
    double x[3];
    BW_TRY(bwi_msh_int(msh, &id[i], "the number of a node"));
    for (int k = 0; k < 3; k++)
      BW_TRY(bwi_msh_real(msh, &x[k], "a coordinate of a node"));
    BW_TRY(bwi_raw_point(msh->raw, x));
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(msh->raw->context));
  }
  int64_t *taken = id;
  id = NULL;
  BW_TRY(bwi_msh_nodes_done(msh, taken, (size_t)count));
done:
  bw_free(id);
  return status;
}

static bw_status read_element(bwi_msh *msh, int64_t id, int64_t type, int64_t tags) {
  bw_status status = BW_OK;
  int64_t node[125], physical = 0, unused;
  int width = bwi_msh_width(type);
  if (width == 0)
    return bwi_msh_fail(msh, "element %lld is of the unknown type %lld", (long long)id,
                        (long long)type);
  if (tags < 0 || tags > 1000)
    return bwi_msh_fail(msh, "element %lld has %lld tags", (long long)id, (long long)tags);
  for (int64_t i = 0; i < tags; i++)
    BW_TRY(bwi_msh_int(msh, i == 0 ? &physical : &unused, "a tag of an element"));
  for (int k = 0; k < width; k++)
    BW_TRY(bwi_msh_int(msh, &node[k], "a node of an element"));
  BW_TRY(bwi_msh_element(msh, id, type, node, &physical, 1));
done:
  return status;
}

bw_status bwi_msh22_elements(bwi_msh *msh) {
  bw_status status = BW_OK;
  int64_t count, type, run, tags, id;
  BW_TRY(bwi_read_count(msh->cursor, msh->binary ? 8 : 8, &count, "the number of elements"));
  if (msh->binary)
    bwi_skip_line(msh->cursor);
  for (int64_t i = 0; i < count;) {
    BW_TRY(bw_check_cancel(msh->raw->context));
    run = 1;
    if (msh->binary) {
      BW_TRY(bwi_msh_int(msh, &type, "the type of elements"));
      BW_TRY(bwi_msh_int(msh, &run, "the number of elements of one type"));
      BW_TRY(bwi_msh_int(msh, &tags, "the number of tags"));
      if (run < 1 || run > count - i)
        BW_TRY(bwi_msh_fail(msh, "a run of %lld elements where 1 to %lld were expected",
                            (long long)run, (long long)(count - i)));
    }
    for (int64_t k = 0; k < run; k++, i++) {
      BW_TRY(bwi_msh_int(msh, &id, "the number of an element"));
      if (!msh->binary) {
        BW_TRY(bwi_msh_int(msh, &type, "the type of an element"));
        BW_TRY(bwi_msh_int(msh, &tags, "the number of tags"));
      }
      BW_TRY(read_element(msh, id, type, tags));
    }
  }
done:
  return status;
}
