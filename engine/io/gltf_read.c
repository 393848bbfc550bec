/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* glTF 2.0: the meshes of a scene, from .glb, or from .gltf with data in its text or in files
 * beside it. Each mesh of a node is a group. Its equal points are welded, since glTF splits points
 * where normals or colours differ. y is up in glTF, z here: (x, y, z) becomes (x, -z, y).
 *
 * Files of hostile origin: nodes may repeat meshes to no more than REPEATED times their size. */
#include "io/gltf.h"

#include <math.h>
#include <string.h>

#include "barwright/job.h"
#include "io/gltf_data.h"
#include "mesh/surface_internal.h"

enum { REPEATED = 100, SLACK = 1 << 16, POINT_BYTES = 80 };

typedef struct reader {
  bwi_gltf data;
  bwi_gltf_list mesh, node;
  double work; /* points and facets placed */
  int32_t *stamp,
      *local; /* of the points of an accessor: primitive that used it, number in the soup */
  size_t stamp_count;
  int32_t primitive;
  bw_name *group_name;
  size_t name_count, name_capacity;
} reader;

/* ---- meshes ---------------------------------------------------------------------------------- */

/* What a primitive's corners are, in order. */
typedef struct corners {
  bwi_gltf_accessor position, index;
  bool indexed;
  int32_t value; /* of the primitive, for messages */
  const double *transform;
} corners;

static bw_status place_point(reader *g, const corners *c, int64_t i, bwi_soup *soup, int32_t *out) {
  int64_t own = i;
  if (c->indexed) {
    own = (int64_t)bwi_gltf_component(&c->index, c->index.at + (size_t)i * c->index.stride);
    if (own >= c->position.count)
      return bwi_gltf_fail(&g->data, c->value,
                           "a facet names point %lld, but there are %lld, numbered from 0",
                           (long long)own, (long long)c->position.count);
  }
  if (g->stamp[own] != g->primitive) {
    const unsigned char *at = c->position.at + (size_t)own * c->position.stride;
    const double *t = c->transform;
    double x[3], y[3];
    for (size_t k = 0; k < 3; k++)
      x[k] = bwi_gltf_component(&c->position, at + k * bwi_gltf_component_size(c->position.type));
    for (size_t k = 0; k < 3; k++)
      y[k] = t[4 * k] * x[0] + t[4 * k + 1] * x[1] + t[4 * k + 2] * x[2] + t[4 * k + 3];
    if (!isfinite(y[0]) || !isfinite(y[1]) || !isfinite(y[2]))
      return bwi_gltf_fail(&g->data, c->value, "point %lld has a coordinate that is not finite",
                           (long long)own);
    const double up[3] = {y[0], -y[2], y[1]};
    bw_status status = bwi_soup_point(soup, up);
    if (status != BW_OK)
      return status;
    g->stamp[own] = g->primitive;
    g->local[own] = (int32_t)soup->point_count - 1;
  }
  *out = g->local[own];
  return BW_OK;
}

static bw_status place_facets(reader *g, const corners *c, int64_t mode, bool mirrored,
                              bwi_soup *soup) {
  bw_status status = BW_OK;
  int64_t count = c->indexed ? c->index.count : c->position.count;
  int64_t facets = mode == 4 ? count / 3 : count < 3 ? 0 : count - 2;
  for (int64_t i = 0; i < facets; i++) {
    int64_t corner[3] = {mode == 4   ? 3 * i
                         : mode == 5 ? i
                                     : 0,
                         mode == 4 ? 3 * i + 1 : i + 1, mode == 4 ? 3 * i + 2 : i + 2};
    int32_t v[3];
    for (int k = 0; k < 3; k++)
      BW_TRY(place_point(g, c, corner[k], soup, &v[k]));
    bool turned = mirrored != (mode == 5 && i % 2 == 1);
    if (mode == 4 || (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]))
      BW_TRY(bwi_soup_triangle(soup, v[0], v[turned ? 2 : 1], v[turned ? 1 : 2]));
    if (i % 65536 == 0)
      BW_TRY(bw_check_cancel(g->data.context));
  }
done:
  return status;
}

/* What is placed is counted, since many nodes may have one mesh. */
static bw_status count_work(reader *g, int32_t value, const corners *c) {
  double memory = bw_available_memory();
  g->work += 1 + (double)(c->indexed ? c->index.count : c->position.count);
  if (g->primitive < INT32_MAX && g->work <= REPEATED * g->data.bytes + SLACK &&
      (memory <= 0 || POINT_BYTES * g->work < memory + POINT_BYTES * SLACK))
    return BW_OK;
  bwi_gltf_fail(
      &g->data, value,
      "nodes repeat meshes to %.0f corners, from %.0f bytes: no plausible file does that, or "
      "it takes more than the memory that is free",
      g->work, g->data.bytes);
  return BW_LIMIT;
}

static bw_status place_primitive(reader *g, int32_t value, const double transform[12],
                                 bool mirrored, bwi_soup *soup) {
  bw_status status = BW_OK;
  int64_t mode, position, index;
  int32_t attributes = bwi_json_member(&g->data.json, value, "attributes");
  corners c = {.value = value, .transform = transform};
  BW_TRY(bwi_gltf_integer(&g->data, value, "mode", 7, 4, &mode));
  c.indexed = bwi_json_member(&g->data.json, value, "indices") != 0;
  if (mode >= 4 && attributes && bwi_json_member(&g->data.json, attributes, "POSITION")) {
    BW_TRY(
        bwi_gltf_integer(&g->data, attributes, "POSITION", g->data.accessor.count, -1, &position));
    BW_TRY(bwi_gltf_accessor_open(&g->data, position, "VEC3", 3, &c.position));
    if (c.indexed) {
      BW_TRY(bwi_gltf_integer(&g->data, value, "indices", g->data.accessor.count, -1, &index));
      BW_TRY(bwi_gltf_accessor_open(&g->data, index, "SCALAR", 1, &c.index));
      if (c.index.type != 5121 && c.index.type != 5123 && c.index.type != 5125)
        return bwi_gltf_fail(&g->data, value,
                             "the indices are of the \"componentType\" %lld: 5121, 5123 or "
                             "5125 was expected",
                             (long long)c.index.type);
    }
  } else {
    soup->skipped++;
  }
  BW_TRY(count_work(g, value, &c));
  if (c.position.count == 0)
    goto done;
  if ((size_t)c.position.count > g->stamp_count) {
    bw_free(g->stamp);
    bw_free(g->local);
    g->stamp_count = (size_t)c.position.count;
    g->stamp = BW_NEW0(g->data.context, int32_t, g->stamp_count);
    g->local = BW_NEW(g->data.context, int32_t, g->stamp_count);
    BW_TRY_MEMORY(g->stamp && g->local);
  }
  g->primitive++;
  BW_TRY(place_facets(g, &c, mode, mirrored, soup));
done:
  return status;
}

/* Merges equal points from `first` on, in the facets from `first_facet` on. */
static bw_status weld(bwi_soup *soup, size_t first, size_t first_facet) {
  bw_status status = BW_OK;
  size_t count = soup->point_count - first;
  double *point = soup->point + 3 * first;
  int32_t kept, *to = BW_NEW(soup->context, int32_t, count + 1);
  BW_TRY_MEMORY(to);
  BW_TRY(bwi_weld_map(soup->context, (int64_t)count, point, NULL, 0, to, &kept));
  for (size_t i = 0; i < count; i++) /* new numbers are no larger than the old ones */
    memmove(point + 3 * (size_t)to[i], point + 3 * i, 3 * sizeof *point);
  soup->point_count = first + (size_t)kept;
  for (size_t i = 3 * first_facet; i < 3 * soup->triangle_count; i++)
    soup->triangle[i] = (int32_t)first + to[(size_t)soup->triangle[i] - first];
done:
  bw_free(to);
  return status;
}

static bw_status keep_name(reader *g, int32_t node, int32_t mesh) {
  bw_status status = BW_OK;
  int32_t name = node ? bwi_json_member(&g->data.json, node, "name") : 0;
  name = name ? name : bwi_json_member(&g->data.json, mesh, "name");
  BW_TRY_MEMORY(bw_grow(g->data.context, (void **)&g->group_name, &g->name_capacity, g->name_count,
                        1, sizeof *g->group_name));
  bw_name *own = &g->group_name[g->name_count++];
  own->text[0] = 0;
  if (name && bwi_gltf_value(&g->data, name)->kind == BWI_JSON_STRING)
    bwi_json_text(bwi_gltf_value(&g->data, name), own->text, sizeof own->text);
done:
  return status;
}

/* node: 0 where there are meshes only. */
static bw_status place_mesh(reader *g, int32_t node, int64_t index, const double t[12],
                            bwi_soup *soup) {
  bw_status status = BW_OK;
  int32_t mesh = g->mesh.value[index],
          primitives = bwi_json_member(&g->data.json, mesh, "primitives");
  size_t first = soup->point_count, first_facet = soup->triangle_count;
  bool mirrored = t[0] * (t[5] * t[10] - t[6] * t[9]) - t[1] * (t[4] * t[10] - t[6] * t[8]) +
                      t[2] * (t[4] * t[9] - t[5] * t[8]) <
                  0;
  if (!primitives || bwi_gltf_value(&g->data, primitives)->kind != BWI_JSON_ARRAY)
    return bwi_gltf_fail(&g->data, mesh, "this mesh has no \"primitives\"");
  bwi_soup_next_group(soup);
  for (int32_t at = bwi_gltf_value(&g->data, primitives)->first; at;
       at = bwi_gltf_value(&g->data, at)->next)
    BW_TRY(place_primitive(g, at, t, mirrored, soup));
  if (soup->triangle_count > first_facet) {
    BW_TRY(weld(soup, first, first_facet));
    BW_TRY(keep_name(g, node, mesh));
  }
done:
  return status;
}

/* ---- nodes ----------------------------------------------------------------------------------- */

/* A node's own transform, rows of [A | b]. */
static bw_status local_transform(const reader *g, int32_t node, double t[12]) {
  bw_status status = BW_OK;
  double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  double move[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
  if (bwi_json_member(&g->data.json, node, "matrix")) {
    BW_TRY(bwi_gltf_reals(&g->data, node, "matrix", 16, m));
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      BW_TRY(
          bwi_gltf_fail(&g->data, node, "the matrix of this node is none of a motion and a scale"));
    for (size_t i = 0; i < 3; i++)
      for (size_t j = 0; j < 4; j++)
        t[4 * i + j] = m[4 * j + i];
    return BW_OK;
  }
  BW_TRY(bwi_gltf_reals(&g->data, node, "translation", 3, move));
  BW_TRY(bwi_gltf_reals(&g->data, node, "rotation", 4, q));
  BW_TRY(bwi_gltf_reals(&g->data, node, "scale", 3, scale));
  double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(size > 0) || !isfinite(size))
    BW_TRY(bwi_gltf_fail(&g->data, node, "the rotation of this node is no unit quaternion"));
  for (int k = 0; k < 4; k++)
    q[k] /= size;
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                       2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                       2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
  for (size_t i = 0; i < 3; i++) {
    for (size_t j = 0; j < 3; j++)
      t[4 * i + j] = r[3 * i + j] * scale[j];
    t[4 * i + 3] = move[i];
  }
done:
  return status;
}

/* outer, then inner becomes inner's transform of the world. */
static void compose(const double outer[12], const double inner[12], double out[12]) {
  for (size_t i = 0; i < 3; i++)
    for (size_t j = 0; j < 4; j++)
      out[4 * i + j] = outer[4 * i] * inner[j] + outer[4 * i + 1] * inner[4 + j] +
                       outer[4 * i + 2] * inner[8 + j] + (j == 3 ? outer[4 * i + 3] : 0);
}

static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

typedef struct walk {
  int32_t *stack; /* nodes to be placed, the next one last */
  int64_t depth;
  bool *seen;
  double *world; /* of the node above, until it is placed */
} walk;

/* The nodes of a list, the last one first. */
static bw_status push_nodes(const reader *g, int32_t of, const char *key, const double outer[12],
                            walk *w) {
  int32_t member = bwi_json_member(&g->data.json, of, key);
  int64_t begin = w->depth;
  if (!member)
    return BW_OK;
  if (bwi_gltf_value(&g->data, member)->kind != BWI_JSON_ARRAY)
    return bwi_gltf_fail(&g->data, member, "\"%s\": numbers of nodes were expected", key);
  for (int32_t at = bwi_gltf_value(&g->data, member)->first; at;
       at = bwi_gltf_value(&g->data, at)->next) {
    double number = bwi_gltf_value(&g->data, at)->number;
    if (bwi_gltf_value(&g->data, at)->kind != BWI_JSON_NUMBER || !(number >= 0) ||
        number >= (double)g->node.count || number != floor(number))
      return bwi_gltf_fail(&g->data, at, "a node from 0 to %lld was expected",
                           (long long)g->node.count - 1);
    int64_t node = (int64_t)number;
    if (w->seen[node])
      return bwi_gltf_fail(&g->data, at, "node %lld stands below two nodes, or below itself",
                           (long long)node);
    w->seen[node] = true;
    memcpy(w->world + 12 * node, outer, 12 * sizeof *outer);
    w->stack[w->depth++] = (int32_t)node;
  }
  for (int64_t end = w->depth - 1; begin < end; begin++, end--) {
    int32_t kept = w->stack[begin];
    w->stack[begin] = w->stack[end];
    w->stack[end] = kept;
  }
  return BW_OK;
}

/* Without a scene all nodes that stand below no other are placed. */
static bw_status push_roots(const reader *g, walk *w) {
  bw_status status = BW_OK;
  bwi_gltf_list scene = {0};
  int64_t chosen;
  BW_TRY(bwi_gltf_list_of(&g->data, 0, "scenes", &scene));
  if (scene.count > 0) {
    BW_TRY(bwi_gltf_integer(&g->data, 0, "scene", scene.count, 0, &chosen));
    status = push_nodes(g, scene.value[chosen], "nodes", identity, w);
    goto done;
  }
  for (int64_t i = 0; i < g->node.count; i++)
    BW_TRY(push_nodes(g, g->node.value[i], "children", identity, w));
  w->depth = 0;
  for (int64_t i = g->node.count - 1; i >= 0; i--) {
    if (!w->seen[i]) {
      memcpy(w->world + 12 * i, identity, sizeof identity);
      w->stack[w->depth++] = (int32_t)i;
    }
    w->seen[i] = !w->seen[i];
  }
done:
  bw_free(scene.value);
  return status;
}

static bw_status place_nodes(reader *g, bwi_soup *soup) {
  bw_status status = BW_OK;
  int64_t mesh;
  walk w = {.stack = BW_NEW(g->data.context, int32_t, g->node.count + 1),
            .seen = BW_NEW0(g->data.context, bool, g->node.count + 1),
            .world = BW_NEW(g->data.context, double, 12 * ((size_t)g->node.count + 1))};
  BW_TRY_MEMORY(w.stack && w.seen && w.world);
  if (g->node.count == 0)
    for (int64_t i = 0; i < g->mesh.count; i++)
      BW_TRY(place_mesh(g, 0, i, identity, soup));
  BW_TRY(push_roots(g, &w));
  while (w.depth > 0) {
    int64_t own = w.stack[--w.depth];
    int32_t node = g->node.value[own];
    double local[12], world[12];
    BW_TRY(local_transform(g, node, local));
    compose(w.world + 12 * own, local, world);
    if (bwi_json_member(&g->data.json, node, "mesh")) {
      BW_TRY(bwi_gltf_integer(&g->data, node, "mesh", g->mesh.count, -1, &mesh));
      BW_TRY(place_mesh(g, node, mesh, world, soup));
    }
    BW_TRY(push_nodes(g, node, "children", world, &w));
  }
done:
  bw_free(w.stack);
  bw_free(w.seen);
  bw_free(w.world);
  return status;
}

/* ---- the file -------------------------------------------------------------------------------- */

static bool is_binary(const bwi_cursor *cursor) {
  return bwi_left(cursor) >= 4 && memcmp(cursor->at, "glTF", 4) == 0;
}

bool bwi_is_gltf(const bwi_cursor *cursor) {
  bwi_cursor text = *cursor;
  if (is_binary(cursor))
    return true;
  bwi_skip_space(&text);
  return text.at < text.end && *text.at == '{' && bwi_find(&text, "\"asset\"") != NULL;
}

/* The JSON and the binary part of a .glb. */
static bw_status open_chunks(bwi_cursor *cursor, reader *g, bwi_cursor *text) {
  enum { JSON = 0x4E4F534A, BIN = 0x004E4942 };
  const bool swap = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
  bw_status status = BW_OK;
  const unsigned char *head, *bytes;
  BW_TRY(bwi_take(cursor, 12, &head, "the head"));
  if (bwi_u32(head + 4, swap) != 2) {
    cursor->at = head + 4;
    bwi_fail_byte(cursor, "glTF of version %u is not read: save it as glTF 2.0",
                  (unsigned)bwi_u32(head + 4, swap));
    return BW_UNSUPPORTED;
  }
  for (int part = 0; part < 2 && bwi_left(cursor) > 0; part++) {
    BW_TRY(bwi_take(cursor, 8, &head, "the head of a part"));
    size_t length = bwi_u32(head, swap);
    uint32_t kind = bwi_u32(head + 4, swap);
    BW_TRY(bwi_take(cursor, length, &bytes, "a part"));
    if (part == 0 && kind != JSON) {
      cursor->at = head;
      return bwi_fail_byte(cursor, "the first part is not the JSON of a glTF file");
    }
    if (part == 0) {
      text->at = bytes;
      text->end = bytes + length;
    } else if (kind == BIN) {
      g->data.chunk = bytes;
      g->data.chunk_count = length;
    }
  }
  if (!text->at)
    status = bwi_fail_byte(cursor, "the file ends before its JSON");
done:
  return status;
}

/* Extensions without which the positions of points cannot be read. */
static bw_status check_extensions(const reader *g) {
  static const char *const fine[] = {"KHR_mesh_quantization", "KHR_lights_punctual"};
  static const char material[] = "KHR_materials_", texture[] = "KHR_texture_";
  int32_t required = bwi_json_member(&g->data.json, 0, "extensionsRequired");
  for (int32_t at = required ? bwi_gltf_value(&g->data, required)->first : 0; at;
       at = bwi_gltf_value(&g->data, at)->next) {
    bwi_word word = bwi_gltf_value(&g->data, at)->text;
    if (bwi_word_is(word, fine[0]) || bwi_word_is(word, fine[1]) ||
        (word.length > 14 && memcmp(word.at, material, 14) == 0) ||
        (word.length > 12 && memcmp(word.at, texture, 12) == 0))
      continue;
    bwi_gltf_fail(&g->data, at,
                  "the file needs the extension %s, which is not read: export without it",
                  bwi_show(word));
    return BW_UNSUPPORTED;
  }
  return BW_OK;
}

static bw_status check_version(const reader *g) {
  int32_t asset = bwi_json_member(&g->data.json, 0, "asset");
  int32_t version = asset ? bwi_json_member(&g->data.json, asset, "version") : 0;
  if (!version || bwi_gltf_value(&g->data, version)->kind != BWI_JSON_STRING)
    return bwi_gltf_fail(&g->data, asset,
                         "a glTF file with \"asset\" and its \"version\" was expected");
  bwi_word word = bwi_gltf_value(&g->data, version)->text;
  if (word.length > 1 && word.at[0] == '2' && word.at[1] == '.')
    return BW_OK;
  bwi_gltf_fail(&g->data, version, "glTF of version %s is not read: save it as glTF 2.0",
                bwi_show(word));
  return BW_UNSUPPORTED;
}

bw_status bwi_gltf_parse(bwi_cursor *cursor, bw_surface **surface, bw_read_info *info) {
  bw_status status = BW_OK;
  bwi_soup soup;
  bwi_cursor text = *cursor;
  reader g = {.data = {.context = cursor->context, .file = cursor}};
  g.data.bytes = (double)bwi_left(cursor);
  bwi_soup_init(&soup, cursor->context, cursor->name);
  if (is_binary(cursor)) {
    text.at = text.end = NULL;
    BW_TRY(open_chunks(cursor, &g, &text));
  }
  BW_TRY(bwi_json_parse(&text, &g.data.json));
  BW_TRY(check_version(&g));
  BW_TRY(check_extensions(&g));
  BW_TRY(bwi_gltf_open(&g.data));
  BW_TRY(bwi_gltf_list_of(&g.data, 0, "meshes", &g.mesh));
  BW_TRY(bwi_gltf_list_of(&g.data, 0, "nodes", &g.node));
  BW_TRY(place_nodes(&g, &soup));
  BW_TRY(bwi_soup_finish(&soup, "glTF", false, surface, info));
  if (info) {
    info->unit = 1;
    info->group_name = g.group_name;
    g.group_name = NULL;
  }
done:
  bwi_gltf_clear(&g.data);
  bw_free(g.mesh.value);
  bw_free(g.node.value);
  bw_free(g.stamp);
  bw_free(g.local);
  bw_free(g.group_name);
  bwi_soup_clear(&soup);
  return status;
}
