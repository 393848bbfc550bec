/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Entities, nodes and elements of MSH 4.1. Nodes and elements come in blocks, one per geometric
 * entity; physical groups belong to the entities. In binary files counts and tags of nodes and
 * elements are uint64, other numbers int32 and double. */
#include "io/msh.h"

enum { MAX_GROUPS = 64 };

static bw_status read_entity(bwi_msh *msh, int dimension) {
  bw_status status = BW_OK;
  bw_context *context = msh->raw->context;
  bwi_msh_entity entity = {dimension, 0, msh->physical_count, 0};
  int64_t count, number;
  double unused;
  BW_TRY(bwi_msh_int(msh, &entity.tag, "the tag of an entity"));
  for (int k = 0; k < (dimension == 0 ? 3 : 6); k++)
    BW_TRY(bwi_msh_real(msh, &unused, "the box of an entity"));
  BW_TRY(bwi_msh_size(msh, &count, "the number of physical groups of an entity"));
  if (count > MAX_GROUPS) /* each element is entered into each of them */
    return bwi_msh_fail(msh, "%lld physical groups of one entity: at most %d are read",
                        (long long)count, MAX_GROUPS);
  for (int64_t i = 0; i < count; i++) {
    BW_TRY(bwi_msh_int(msh, &number, "a physical group"));
    if (!bw_grow(context, (void **)&msh->physical, &msh->physical_capacity, msh->physical_count, 1,
                 sizeof *msh->physical))
      return BW_MEMORY;
    /* the sign says which way the entity is turned */
    msh->physical[msh->physical_count++] = number < 0 ? -number : number;
  }
  entity.count = (size_t)count;
  if (dimension > 0) {
    BW_TRY(bwi_msh_size(msh, &count, "the number of bounding entities"));
    BW_TRY(bwi_msh_check(msh, count, 2, 4, "the number of bounding entities"));
    for (int64_t i = 0; i < count; i++)
      BW_TRY(bwi_msh_int(msh, &number, "a bounding entity"));
  }
  if (!bw_grow(context, (void **)&msh->entity, &msh->entity_capacity, msh->entity_count, 1,
               sizeof *msh->entity))
    return BW_MEMORY;
  msh->entity[msh->entity_count++] = entity;
done:
  return status;
}

bw_status bwi_msh41_entities(bwi_msh *msh) {
  bw_status status = BW_OK;
  int64_t count[4];
  for (int d = 0; d < 4; d++)
    BW_TRY(bwi_msh_size(msh, &count[d], "the number of entities"));
  for (int d = 0; d < 4; d++) {
    BW_TRY(bwi_msh_check(msh, count[d], 10, 36, "the number of entities"));
    for (int64_t i = 0; i < count[d]; i++)
      BW_TRY(read_entity(msh, d));
  }
done:
  return status;
}

static bw_status read_node_block(bwi_msh *msh, int64_t *id, int64_t *have, int64_t all) {
  bw_status status = BW_OK;
  int64_t dimension, tag, parametric, count;
  double x[3], unused;
  BW_TRY(bwi_msh_int(msh, &dimension, "the dimension of an entity"));
  BW_TRY(bwi_msh_int(msh, &tag, "the tag of an entity"));
  BW_TRY(bwi_msh_int(msh, &parametric, "0 or 1 (parametric)"));
  BW_TRY(bwi_msh_size(msh, &count, "the number of nodes of an entity"));
  if (count > all - *have || dimension < 0 || dimension > 3)
    return bwi_msh_fail(msh,
                        "a block of %lld nodes of dimension %lld: at most %lld more nodes, of "
                        "dimension 0 to 3, were expected",
                        (long long)count, (long long)dimension, (long long)(all - *have));
  for (int64_t i = 0; i < count; i++)
    BW_TRY(bwi_msh_size(msh, &id[*have + i], "the number of a node"));
  for (int64_t i = 0; i < count; i++) {
    for (int k = 0; k < 3; k++)
      BW_TRY(bwi_msh_real(msh, &x[k], "a coordinate of a node"));
    for (int64_t k = 0; k < dimension && parametric; k++)
      BW_TRY(bwi_msh_real(msh, &unused, "a parameter of a node"));
    BW_TRY(bwi_raw_point(msh->raw, x));
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(msh->raw->context));
  }
  *have += count;
done:
  return status;
}

bw_status bwi_msh41_nodes(bwi_msh *msh) {
  bw_status status = BW_OK;
  int64_t blocks, count, unused, have = 0, *id = NULL;
  BW_TRY(bwi_msh_size(msh, &blocks, "the number of blocks of nodes"));
  BW_TRY(bwi_msh_size(msh, &count, "the number of nodes"));
  BW_TRY(bwi_msh_size(msh, &unused, "the lowest number of a node"));
  BW_TRY(bwi_msh_size(msh, &unused, "the highest number of a node"));
  BW_TRY(bwi_msh_check(msh, blocks, 8, 20, "the number of blocks of nodes"));
  BW_TRY(bwi_msh_check(msh, count, 8, 32, "the number of nodes"));
  id = BW_NEW(msh->raw->context, int64_t, count);
  if (!id)
    return BW_MEMORY;
  for (int64_t i = 0; i < blocks; i++)
    BW_TRY(read_node_block(msh, id, &have, count));
  int64_t *taken = id;
  id = NULL;
  BW_TRY(bwi_msh_nodes_done(msh, taken, (size_t)have));
done:
  bw_free(id);
  return status;
}

static const bwi_msh_entity *find_entity(bwi_msh *msh, int64_t dimension, int64_t tag) {
  for (size_t i = 0; i <= msh->entity_count; i++) {
    size_t at = i == 0 ? msh->last_entity : i - 1;
    if (at < msh->entity_count && msh->entity[at].tag == tag &&
        msh->entity[at].dimension == dimension) {
      msh->last_entity = at;
      return &msh->entity[at];
    }
  }
  return NULL;
}

static bw_status read_element_block(bwi_msh *msh) {
  bw_status status = BW_OK;
  int64_t dimension, tag, type, count, id, node[125];
  BW_TRY(bwi_msh_int(msh, &dimension, "the dimension of an entity"));
  BW_TRY(bwi_msh_int(msh, &tag, "the tag of an entity"));
  BW_TRY(bwi_msh_int(msh, &type, "the type of elements"));
  BW_TRY(bwi_msh_size(msh, &count, "the number of elements of an entity"));
  int width = bwi_msh_width(type);
  if (width == 0)
    return bwi_msh_fail(msh, "elements of the unknown type %lld", (long long)type);
  BW_TRY(bwi_msh_check(msh, count, 2 + 2 * (size_t)width, 8 + 8 * (size_t)width,
                       "the number of elements of an entity"));
  const bwi_msh_entity *entity = find_entity(msh, dimension, tag);
  const int64_t *physical = entity ? msh->physical + entity->first : NULL;
  for (int64_t i = 0; i < count; i++) {
    BW_TRY(bwi_msh_size(msh, &id, "the number of an element"));
    for (int k = 0; k < width; k++)
      BW_TRY(bwi_msh_size(msh, &node[k], "a node of an element"));
    BW_TRY(bwi_msh_element(msh, id, type, node, physical, entity ? entity->count : 0));
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(msh->raw->context));
  }
done:
  return status;
}

bw_status bwi_msh41_elements(bwi_msh *msh) {
  bw_status status = BW_OK;
  int64_t blocks, unused;
  BW_TRY(bwi_msh_size(msh, &blocks, "the number of blocks of elements"));
  for (int k = 0; k < 3; k++)
    BW_TRY(bwi_msh_size(msh, &unused, "the number, lowest and highest number of elements"));
  BW_TRY(bwi_msh_check(msh, blocks, 8, 20, "the number of blocks of elements"));
  for (int64_t i = 0; i < blocks; i++)
    BW_TRY(read_element_block(msh));
done:
  return status;
}
