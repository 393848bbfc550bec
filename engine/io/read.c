/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which format a file has, by content first and by the ending of its name second; and the public
 * functions that read surfaces and read and write meshes in any of them. */
#include "io/internal.h"

#include <string.h>

#include "barwright/cad.h"
#include "io/formats.h"
#include "io/gltf.h"
#include "io/raw.h"
#include "io/vtu.h"
#include "io/zip.h"

const char *bwi_ending(const char *path) {
  const char *slash = strrchr(path, '/');
  const char *dot = strrchr(slash ? slash : path, '.');
  return dot ? dot + 1 : "";
}

bool bwi_has_ending(const char *path, const char *ending) {
  const char *own = bwi_ending(path);
  return bwi_word_is_nocase((bwi_word){(const unsigned char *)own, strlen(own)}, ending);
}

static bool begins(const bwi_cursor *cursor, const char *text) {
  size_t length = strlen(text);
  return bwi_left(cursor) >= length && memcmp(cursor->at, text, length) == 0;
}

static const char *cad_format(const bwi_cursor *cursor) {
  return bw_cad_format(cursor->begin, (size_t)(cursor->end - cursor->begin));
}

/* A file of a kind that is not read here but can be named. */
static const char *foreign_kind(const bwi_cursor *cursor) {
  static const struct {
    const char *magic;
    const char *kind;
  } known[] = {
      {"\xFF\xFE", "text in UTF-16: save it as plain text (UTF-8)"},
      {"\xFE\xFF", "text in UTF-16: save it as plain text (UTF-8)"},
      {"\x1F\x8B", "compressed by gzip: unpack it first"},
      {"PK\x03\x04", "a ZIP archive: unpack it, or read it as a surface where it is 3MF"},
      {"# vtk DataFile", "a legacy VTK file: save it as VTU (.vtu)"},
      {"$NOD", "a Gmsh file of version 1: save it as 4.1 or 2.2"},
      {"#VRML", "a VRML file: export STL, OBJ or PLY"},
      {"%PDF", "a PDF document"},
      {"\x89PNG", "a PNG picture"},
      {"\x89HDF", "an HDF5 file (MED, XDMF): save it as VTU or MSH"},
  };
  for (size_t i = 0; i < sizeof known / sizeof *known; i++)
    if (begins(cursor, known[i].magic))
      return known[i].kind;
  const char *cad = cad_format(cursor);
  return !cad ? NULL
         : strcmp(cad, "STEP") == 0
             ? "a STEP file of curved surfaces: read it as a surface, and fill it"
             : "an IGES file of curved surfaces: read it as a surface, and fill it";
}

/* "OFF" with the prefixes that say what vertices carry. */
static bool is_off_word(bwi_word word) {
  return word.length >= 3 && word.length <= 8 && memcmp(word.at + word.length - 3, "OFF", 3) == 0;
}

/* The first line that is neither empty nor a comment starts like one of an OBJ file. */
static bool looks_like_obj(bwi_cursor cursor) {
  static const char *const words[] = {"v", "vn", "vt",     "f",      "o",     "g",
                                      "s", "l",  "mtllib", "usemtl", "mtlib", "vp"};
  bwi_cursor line;
  while (bwi_next_line(&cursor, &line)) {
    bwi_word word;
    if (!bwi_next_word(&line, &word) || *word.at == '#')
      continue;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
      if (bwi_word_is(word, words[i]))
        return true;
    return false;
  }
  return false;
}

/* The first line that is neither empty nor an INP comment ("**") is a keyword line. */
static bool looks_like_inp(bwi_cursor cursor) {
  bwi_cursor line;
  while (bwi_next_line(&cursor, &line)) {
    bwi_skip_blank(&line);
    if (line.at == line.end || begins(&line, "**"))
      continue;
    return *line.at == '*' && line.end - line.at > 1 &&
           ((line.at[1] | 0x20) >= 'a' && (line.at[1] | 0x20) <= 'z');
  }
  return false;
}

static bwi_format detect(bwi_cursor *cursor) {
  size_t count = (size_t)(cursor->end - cursor->begin);
  if (count >= 84 && bwi_stl_is_binary(cursor->begin, count))
    return BWI_STL;
  bwi_word word = bwi_peek_word(cursor);
  bwi_cursor text = *cursor;
  bwi_skip_space(&text);
  if (bwi_word_is(word, "ply"))
    return BWI_PLY;
  if (is_off_word(word))
    return BWI_OFF;
  if (begins(&text, "$MeshFormat") || begins(&text, "$Comment"))
    return BWI_MSH;
  if (begins(&text, "<?xml") || begins(&text, "<VTKFile") || begins(&text, "<!--"))
    return BWI_VTU;
  if (word.length >= 20 && bwi_word_is_nocase((bwi_word){word.at, 20}, "MeshVersionFormatted"))
    return BWI_MEDIT;
  if (bwi_is_zip(cursor))
    return BWI_3MF;
  if (bwi_is_gltf(cursor))
    return BWI_GLTF;
  if (foreign_kind(cursor))
    return BWI_UNKNOWN;
  if (word.length >= 5 && bwi_word_is_nocase((bwi_word){word.at, 5}, "solid"))
    return BWI_STL;
  static const struct {
    const char *ending;
    bwi_format format;
  } by_name[] = {{"stl", BWI_STL},    {"obj", BWI_OBJ},     {"off", BWI_OFF},    {"ply", BWI_PLY},
                 {"mesh", BWI_MEDIT}, {"node", BWI_TETGEN}, {"ele", BWI_TETGEN}, {"inp", BWI_INP}};
  for (size_t i = 0; i < sizeof by_name / sizeof *by_name; i++)
    if (bwi_has_ending(cursor->name, by_name[i].ending))
      return by_name[i].format;
  if (looks_like_inp(*cursor))
    return BWI_INP;
  if (looks_like_obj(*cursor))
    return BWI_OBJ;
  return BWI_UNKNOWN;
}

bw_status bwi_fail_unknown(bwi_cursor *cursor, const char *considered) {
  if (cursor->begin == cursor->end)
    return bwi_fail_byte(cursor, "the file is empty (0 bytes)");
  const char *kind = foreign_kind(cursor);
  cursor->at = cursor->begin;
  if (kind) {
    bw_status status = bwi_fail_byte(cursor, "this is %s", kind);
    if (cad_format(cursor))
      bw_detail_text(cursor->context, "cad", cad_format(cursor));
    return status;
  }
  size_t left = bwi_left(cursor);
  return bwi_fail_byte(cursor, "the content, beginning '%s', is of no format that is read here: %s",
                       bwi_show((bwi_word){cursor->at, left < 41 ? left : 41}), considered);
}

/* The path with another ending of the same kind of file; release with bw_free. */
static char *with_ending(bw_context *context, const char *path, const char *ending) {
  size_t stem = (size_t)(bwi_ending(path) - path), length = strlen(ending);
  char *other = BW_NEW(context, char, stem + length + 1);
  if (other) {
    memcpy(other, path, stem);
    memcpy(other + stem, ending, length + 1);
  }
  return other;
}

/* From two files in memory, named for messages after `name`. */
static bw_status tetgen_pair(bwi_cursor *cursor, bwi_raw *raw, const char **format) {
  bw_status status = BW_OK;
  bool is_node = bwi_has_ending(cursor->name, "node");
  unsigned char *bytes = NULL;
  size_t count;
  char *other = with_ending(cursor->context, cursor->name, is_node ? "ele" : "node");
  if (!other)
    return BW_MEMORY;
  bwi_cursor second;
  BW_TRY(bw_read_file(cursor->context, other, &bytes, &count));
  bwi_cursor_init(&second, cursor->context, other, bytes, count);
  BW_TRY(bwi_tetgen_read(is_node ? cursor : &second, is_node ? &second : cursor, raw, format));
done:
  bw_free(other);
  bw_free(bytes);
  return status;
}

/* Formats of meshes. *known is false when the format is none of them. */
static bw_status read_raw(bwi_cursor *cursor, bwi_format kind, bwi_raw *raw, const char **format,
                          bool *known) {
  *known = true;
  switch (kind) {
  case BWI_VTU:
    return bwi_vtu_read(cursor, raw, format);
  case BWI_MSH:
    return bwi_msh_read(cursor, raw, format);
  case BWI_MEDIT:
    return bwi_medit_read(cursor, raw, format);
  case BWI_INP:
    return bwi_inp_read(cursor, raw, format);
  case BWI_TETGEN:
    return tetgen_pair(cursor, raw, format);
  default:
    *known = false;
    return BW_OK;
  }
}

static bw_status surface_of_mesh(bwi_cursor *cursor, bwi_format kind, bw_surface **surface,
                                 bw_read_info *info) {
  bwi_raw raw;
  const char *format = "";
  bool known;
  bwi_raw_init(&raw, cursor->context, cursor->name);
  bw_status status = read_raw(cursor, kind, &raw, &format, &known);
  if (!known)
    status = bwi_fail_unknown(cursor,
                              "STL (text beginning with 'solid', or a binary size of 84 + 50 n "
                              "bytes), OBJ, OFF, PLY, 3MF, glTF, MSH, VTU, PVTU, MEDIT, INP, STEP, "
                              "IGES");
  if (status == BW_OK)
    status = bwi_raw_surface(&raw, format, surface, info);
  bwi_raw_clear(&raw);
  return status;
}

static bw_status parse(bwi_cursor *cursor, bwi_format kind, bw_surface **surface,
                       bw_read_info *info) {
  switch (kind) {
  case BWI_STL:
    return bwi_stl_parse(cursor, surface, info);
  case BWI_OBJ:
    return bwi_obj_parse(cursor, surface, info);
  case BWI_OFF:
    return bwi_off_parse(cursor, surface, info);
  case BWI_PLY:
    return bwi_ply_parse(cursor, surface, info);
  case BWI_3MF:
    return bwi_3mf_parse(cursor, surface, info);
  case BWI_GLTF:
    return bwi_gltf_parse(cursor, surface, info);
  default:
    return surface_of_mesh(cursor, kind, surface, info);
  }
}

/* Objects that the file names are faces of these names. */
bw_status bw_surface_parse(bw_context *context, const char *name, const unsigned char *bytes,
                           size_t count, bw_surface **surface, bw_read_info *info) {
  bwi_cursor cursor;
  bw_read_info own = {0};
  bw_surface *read = NULL;
  bwi_cursor_init(&cursor, context, name, bytes, count);
  bw_status status = parse(&cursor, count ? detect(&cursor) : BWI_UNKNOWN, &read, &own);
  if (status == BW_OK && own.group_name && read->group && !read->names)
    status = bw_face_names_create(context, own.group_count, own.group_name, NULL, &read->names);
  if (info)
    *info = own;
  if (status != BW_OK || !info)
    bw_free(own.group_name);
  if (status != BW_OK && info)
    info->group_name = NULL;
  if (status == BW_OK)
    *surface = read;
  else
    bw_release(read);
  return status;
}

bw_status bw_mesh_parse(bw_context *context, const char *name, const unsigned char *bytes,
                        size_t count, bw_mesh_file *file) {
  bwi_cursor cursor;
  bwi_raw raw;
  const char *format = "";
  bool known;
  memset(file, 0, sizeof *file);
  bwi_cursor_init(&cursor, context, name, bytes, count);
  bwi_raw_init(&raw, context, name);
  bwi_format kind = count ? detect(&cursor) : BWI_UNKNOWN;
  bw_status status = read_raw(&cursor, kind, &raw, &format, &known);
  if (kind == BWI_STL || kind == BWI_OBJ || kind == BWI_OFF || kind == BWI_PLY || kind == BWI_3MF ||
      kind == BWI_GLTF)
    status = bwi_fail_byte(&cursor,
                           "this is a surface (%s), not a mesh of tetrahedra: read it as "
                           "a surface and fill it",
                           kind == BWI_STL   ? "STL"
                           : kind == BWI_OBJ ? "OBJ"
                           : kind == BWI_OFF ? "OFF"
                           : kind == BWI_PLY ? "PLY"
                           : kind == BWI_3MF ? "3MF"
                                             : "glTF");
  else if (!known)
    status = bwi_fail_unknown(&cursor, "VTU, MSH 2.2 and 4.1, MEDIT, TetGen, INP");
  if (status == BW_OK)
    status = bwi_raw_mesh(&raw, format, file);
  bwi_raw_clear(&raw);
  return status;
}

bw_status bw_mesh_read(bw_context *context, const char *path, bw_mesh_file *file) {
  unsigned char *bytes;
  size_t count;
  memset(file, 0, sizeof *file);
  bw_status status = bw_read_file(context, path, &bytes, &count);
  if (status != BW_OK)
    return status;
  status = bwi_has_ending(path, "pvtu") ? bwi_pvtu_read(context, path, bytes, count, file)
                                        : bw_mesh_parse(context, path, bytes, count, file);
  bw_free(bytes);
  return status;
}

/* ---- writing ------------------------------------------------------------------------------- */

static bw_status write_plain(bw_context *context, const char *path,
                             bw_status (*write)(bw_writer *, const bw_mesh *),
                             const bw_mesh *mesh) {
  bw_writer *writer;
  bw_status status = bw_writer_open(context, path, &writer);
  if (status != BW_OK)
    return status;
  write(writer, mesh); /* commit knows of an error */
  return bw_writer_commit(writer);
}

bw_status bw_mesh_write(bw_context *context, const bw_mesh *mesh, const char *path, int field_count,
                        const bw_field *fields) {
  if (bwi_has_ending(path, "vtu"))
    return bwi_vtu_write(context, mesh, path, field_count, fields);
  if (bwi_has_ending(path, "pvtu"))
    return bwi_pvtu_write(context, mesh, path, field_count, fields);
  if (bwi_has_ending(path, "msh"))
    return bwi_msh41_write(context, mesh, path, field_count, fields);
  if (bwi_has_ending(path, "mesh"))
    return write_plain(context, path, bwi_medit_write, mesh);
  if (bwi_has_ending(path, "node") || bwi_has_ending(path, "ele")) {
    char *node = with_ending(context, path, "node"), *ele = with_ending(context, path, "ele");
    bw_status status =
        node && ele ? bwi_tetgen_write(context, mesh, node, ele) : (bw_status)BW_MEMORY;
    bw_free(node);
    bw_free(ele);
    return status;
  }
  if (bwi_has_ending(path, "inp"))
    return write_plain(context, path, bwi_inp_write_mesh, mesh);
  return bw_fail(context, BW_INVALID,
                 "%s: the ending '%s' names no format that meshes are written in: use .vtu .pvtu "
                 ".msh .mesh .node .ele or .inp",
                 path, bwi_ending(path));
}

bw_status bw_surface_read(bw_context *context, const char *path, bw_surface **surface,
                          bw_read_info *info) {
  unsigned char *bytes;
  size_t count;
  bw_status status = bw_read_file(context, path, &bytes, &count);
  if (status != BW_OK)
    return status;
  if (bwi_has_ending(path, "pvtu")) {
    bw_mesh_file file;
    status = bwi_pvtu_read(context, path, bytes, count, &file);
    if (status == BW_OK)
      status = bwi_mesh_file_surface(context, &file, surface, info);
  } else
    status = bw_surface_parse(context, path, bytes, count, surface, info);
  bw_free(bytes);
  return status;
}
