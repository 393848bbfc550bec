/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What both versions of Gmsh files are made of: numbers, element types, groups, elements and nodes.
 * A tetrahedron's region is its first physical group; every physical group is a named set, of
 * elements in three dimensions, of nodes in fewer. */
#include "io/msh.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bw_status bwi_msh_fail(bwi_msh *msh, const char *format, ...) {
  char text[600];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return msh->binary ? bwi_fail_byte(msh->cursor, "%s", text)
                     : bwi_fail_line(msh->cursor, "%s", text);
}

bw_status bwi_msh_int(bwi_msh *msh, int64_t *value, const char *what) {
  if (!msh->binary)
    return bwi_read_integer(msh->cursor, value, what);
  const unsigned char *bytes;
  bw_status status = bwi_take(msh->cursor, 4, &bytes, what);
  if (status == BW_OK)
    *value = (int32_t)bwi_u32(bytes, msh->cursor->swap);
  return status;
}

bw_status bwi_msh_size(bwi_msh *msh, int64_t *value, const char *what) {
  bw_status status;
  if (!msh->binary) {
    status = bwi_read_integer(msh->cursor, value, what);
  } else {
    const unsigned char *bytes;
    status = bwi_take(msh->cursor, 8, &bytes, what);
    if (status == BW_OK)
      *value = (int64_t)bwi_u64(bytes, msh->cursor->swap);
  }
  if (status == BW_OK && *value < 0)
    status = bwi_msh_fail(msh, "%s is %lld: it cannot be negative", what, (long long)*value);
  return status;
}

bw_status bwi_msh_real(bwi_msh *msh, double *value, const char *what) {
  if (!msh->binary)
    return bwi_read_real(msh->cursor, value, what);
  const unsigned char *bytes;
  bw_status status = bwi_take(msh->cursor, 8, &bytes, what);
  if (status != BW_OK)
    return status;
  *value = bwi_f64(bytes, msh->cursor->swap);
  if (!isfinite(*value)) {
    msh->cursor->at = bytes;
    return bwi_fail_byte(msh->cursor, "%s is %g: a finite number was expected", what, *value);
  }
  return BW_OK;
}

bw_status bwi_msh_check(bwi_msh *msh, int64_t count, size_t text, size_t binary, const char *what) {
  return bwi_check_count(msh->cursor, (uint64_t)count, msh->binary ? binary : text, what);
}

int bwi_msh_width(int64_t type) {
  static const int width[] = {0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                              8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
  if (type == 92)
    return 64;
  if (type == 93)
    return 125;
  return type > 0 && type < (int64_t)(sizeof width / sizeof *width) ? width[type] : 0;
}

static int dimension_of(int64_t type) {
  switch (type) {
  case 15:
    return 0;
  case 1:
  case 8:
  case 26:
  case 27:
  case 28:
    return 1;
  case 2:
  case 3:
  case 9:
  case 10:
  case 16:
  case 20:
  case 21:
  case 22:
  case 23:
  case 24:
  case 25:
    return 2;
  default:
    return 3;
  }
}

bw_status bwi_msh_find_group(bwi_msh *msh, int64_t dimension, int64_t tag, bwi_msh_group **group) {
  for (size_t i = 0; i <= msh->group_count; i++) {
    size_t at = i == 0 ? msh->last_group : i - 1; /* most often the one of the element before */
    if (at < msh->group_count && msh->group[at].tag == tag &&
        msh->group[at].dimension == dimension) {
      msh->last_group = at;
      *group = &msh->group[at];
      return BW_OK;
    }
  }
  if (!bw_grow(msh->raw->context, (void **)&msh->group, &msh->group_capacity, msh->group_count, 1,
               sizeof *msh->group))
    return BW_MEMORY;
  *group = &msh->group[msh->group_count++];
  **group = (bwi_msh_group){dimension, tag, {msh->cursor->at, 0}, false, 0};
  return BW_OK;
}

/* Enter an element, or the nodes of a lower one, into the sets of its physical groups. */
static bw_status enter_sets(bwi_msh *msh, int dimension, const int32_t *member, int members,
                            const int64_t *physical, size_t physical_count) {
  bw_status status = BW_OK;
  for (size_t i = 0; i < physical_count; i++) {
    bwi_msh_group *group;
    /* A polycrystal may have a group per grain: the region says all there is to say then. */
    if (physical[i] == 0 || msh->group_count >= BWI_MAX_SETS)
      continue;
    BW_TRY(bwi_msh_find_group(msh, dimension, physical[i], &group));
    if (!group->has_set) {
      char text[60];
      bwi_word name = group->name;
      if (name.length == 0) {
        int length =
            snprintf(text, sizeof text, "physical_%d_%lld", dimension, (long long)physical[i]);
        name = (bwi_word){(const unsigned char *)text, (size_t)length};
      }
      BW_TRY(bwi_raw_find_set(msh->raw, name, dimension == 3, &group->set));
      group->has_set = true;
    }
    for (int k = 0; k < members; k++)
      BW_TRY(bwi_raw_member(msh->raw, group->set, member[k]));
  }
done:
  return status;
}

bw_status bwi_msh_element(bwi_msh *msh, int64_t id, int64_t type, const int64_t *node,
                          const int64_t *physical, size_t physical_count) {
  bw_status status = BW_OK;
  bwi_raw *raw = msh->raw;
  int width = bwi_msh_width(type), dimension = dimension_of(type);
  int32_t corner[125];
  for (int k = 0; k < width; k++) {
    corner[k] = bwi_ids_find(&msh->nodes, node[k]);
    if (corner[k] < 0)
      return bwi_msh_fail(msh, "element %lld names node %lld, which the file does not define",
                          (long long)id, (long long)node[k]);
  }
  int64_t region = physical_count ? physical[0] : 0;
  if (region < INT32_MIN || region > INT32_MAX)
    return bwi_msh_fail(msh, "element %lld is in the physical group %lld, beyond 32 bits",
                        (long long)id, (long long)region);
  if (type == 4 || type == 11) {
    if (type == 11) { /* Gmsh has the middles of the edges 23 and 13 the other way round */
      int32_t kept = corner[8];
      corner[8] = corner[9];
      corner[9] = kept;
    }
    if (!bw_grow(raw->context, (void **)&msh->tet_id, &msh->tet_capacity, raw->tet_count, 1,
                 sizeof *msh->tet_id))
      return BW_MEMORY;
    msh->tet_id[raw->tet_count] = id;
    BW_TRY(bwi_raw_tet(raw, width, corner, (int32_t)region));
    int32_t element = (int32_t)raw->tet_count - 1;
    BW_TRY(enter_sets(msh, 3, &element, 1, physical, physical_count));
    return BW_OK;
  }
  int corners = type == 2 || type == 9 ? 3 : type == 3 || type == 10 || type == 16 ? 4 : 0;
  if (corners)
    BW_TRY(bwi_raw_facet(raw, (size_t)corners, corner, (int32_t)region));
  else
    raw->skipped++, raw->solids += dimension == 3;
  if (dimension < 3)
    BW_TRY(enter_sets(msh, dimension, corner, width, physical, physical_count));
done:
  return status;
}

bw_status bwi_msh_nodes_done(bwi_msh *msh, int64_t *id, size_t count) {
  int64_t twice = 0;
  if (msh->nodes.id) {
    bw_free(id);
    return bwi_msh_fail(msh, "a second section of nodes");
  }
  bw_status status = bwi_ids_build(msh->raw->context, id, count, &msh->nodes, &twice);
  return status == BW_FORMAT ? bwi_msh_fail(msh, "node %lld is defined twice", (long long)twice)
                             : status;
}
