/* io: files of surfaces and meshes. A reader decides by content first, by name second. Every
 * message of a refusal names the file and the line (text) or byte (binary), and what was expected.
 * Writers write a temporary file and rename it: the target is the old file or the new one, never
 * a part. */
#ifndef BARWRIGHT_IO_H
#define BARWRIGHT_IO_H

#include "barwright/mesh.h"
#include "barwright/outline.h"
#include "barwright/plane.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- bytes and whole files ------------------------------------------------------------- */

/* A file being written: bytes go to a temporary file beside it (temporary.h); commit renames,
 * discard removes. The first error sticks: it is enough to look at what commit returns. Printing is
 * independent of the locale. A failed write, a full disk say, leaves the old file. Released by
 * bw_writer_commit or bw_writer_discard. */
typedef struct bw_writer bw_writer;
/* Begins a file. A target that is no regular file (a pipe, a terminal) is written directly. The
 * writer borrows the context until it is released. */
BW_API bw_status bw_writer_open(bw_context *context, const char *path, bw_writer **writer);
/* Appends `count` bytes, through a buffer. BW_IO when the system refuses to write; then, as for all
 * functions of writers, every later call returns the same. */
BW_API bw_status bw_writer_bytes(bw_writer *writer, const void *bytes, size_t count);
/* Appends a text by the printf `format`. BW_IO as bw_writer_bytes. */
BW_API bw_status bw_writer_print(bw_writer *writer, const char *format, ...) BW_PRINTF(2, 3);
/* Flushes, syncs, renames, and releases the writer whatever comes back. BW_IO when the system
 * refuses one of these, or refused one before. */
BW_API bw_status bw_writer_commit(bw_writer *writer);
/* Removes what was written and releases the writer. NULL is fine. */
BW_API void bw_writer_discard(bw_writer *writer);
/* Appends a value (any) as bw_format_number writes it. BW_IO as bw_writer_bytes. */
BW_API bw_status bw_writer_number(bw_writer *writer, double value);
/* Appends a decimal value. BW_IO as bw_writer_bytes. */
BW_API bw_status bw_writer_integer(bw_writer *writer, int64_t value);
enum { BW_NUMBER_BYTES = 32 /* of any number that bw_format_number writes, with the final 0 */ };
/* Writes a value (any) to `text` in the shortest of 15, 16 or 17 digits that reads back as the same
 * number; with a point whatever the locale. Returns the length. */
BW_API int bw_format_number(double value, char text[BW_NUMBER_BYTES]);
/* Reads a whole text as a finite decimal number *value (any), correctly rounded, whatever the
 * locale. False for anything else; *value is then not defined. */
BW_API bool bw_parse_number(const char *text, double *value);

/* The whole file in memory, followed by a 0 byte that is not counted. Release with bw_free.
 * BW_LIMIT beyond 4 GiB. */
BW_API bw_status bw_read_file(bw_context *context, const char *path, unsigned char **bytes,
                              size_t *count);

/* ---- surfaces: STL OBJ OFF PLY 3MF MSH VTU------------------------------------------------ */

/* What a reader found. */
typedef struct bw_read_info {
  char format[40];  /* "STL binary", "OBJ", "PLY binary little endian", "MSH 4.1", ... */
  int64_t polygons; /* facets with more than three corners that were cut into triangles */
  int64_t skipped;  /* records that were passed over (lines, points, unknown elements) */
  int group_count;  /* of groups, solids or objects in the file; 1 for a volume mesh */
  double unit;      /* (m) of one unit of the file, where the format says it (3MF, glTF); else 0 */
  bw_name *group_name; /* (group_count) of the objects of a 3MF or glTF file, else NULL; release
                          with bw_free */
} bw_read_info;

/* Points as in the file (no unit conversion); exactly equal points of STL facets are welded.
 * `info` may be NULL. A volume mesh (MSH, VTU) gives its boundary. BW_FORMAT where the content is
 * not what its format says, BW_GEOMETRY for indices or coordinates that make no surface. BW_LIMIT
 * beyond 2^31 - 1 points or facets and for files beyond 4 GiB, BW_UNSUPPORTED for a variant of a
 * format that is not read. Details: "file", and "line" or "byte". */
BW_API bw_status bw_surface_read(bw_context *context, const char *path, bw_surface **surface,
                                 bw_read_info *info);
/* The same from `count` bytes in memory, for fuzzing and tests; `name` stands for the file in
 * messages and its ending decides where the content does not. */
BW_API bw_status bw_surface_parse(bw_context *context, const char *name, const unsigned char *bytes,
                                  size_t count, bw_surface **surface, bw_read_info *info);
/* By the ending of the path: .stl (binary; `ascii` for text), .obj .ply .off .vtu .msh, .3mf (in
 * metres); BW_INVALID for another. */
BW_API bw_status bw_surface_write(bw_context *context, const bw_surface *surface, const char *path,
                                  bool ascii);
/* The same as .3mf, whose points are in a `unit` (m) that the file names: micron, millimetre,
 * centimetre, inch, foot or metre; BW_INVALID for another. Groups that share no point become
 * objects of their own. BW_LIMIT beyond 4 GB. */
BW_API bw_status bw_surface_write_3mf(bw_context *context, const bw_surface *surface,
                                      const char *path, double unit);

/* ---- tetrahedral meshes: VTU MSH MEDIT TetGen INP ------------------------------------------ */

/* What the rows of a field belong to. */
typedef enum bw_field_place {
  BW_ON_NODES,   /* nodes of a mesh, points of a surface */
  BW_ON_ELEMENTS /* elements of a mesh, facets of a surface */
} bw_field_place;
/* A named array over nodes or elements; rows in mesh order. Name and array are borrowed. */
typedef struct bw_field {
  const char *name;      /* as the file shall have it */
  bw_field_place place;  /* what its rows belong to */
  const bw_array *array; /* rows x components; 6 components are xx yy zz yz zx xy */
} bw_field;

/* A named set of nodes or elements; owned by a bw_mesh_file. */
typedef struct bw_named_set {
  char *name;       /* as in the file */
  bool of_elements; /* else of nodes */
  int64_t count;
  int32_t *member; /* (index, count) of the mesh */
} bw_named_set;
/* What a mesh file holds; bw_mesh_file_clear releases all. */
typedef struct bw_mesh_file {
  bw_mesh *mesh; /* one reference */
  int field_count;
  char **field_name;           /* field_count names */
  bw_field_place *field_place; /* field_count places */
  bw_array **field_array;      /* field_count arrays, one reference each */
  int set_count;
  bw_named_set *set; /* set_count sets */
  bw_read_info info; /* what the reader found */
  /* (index, node_count) and (index, element_count): the numbers in the file of the nodes and
   * elements of a renumbered mesh, counted from 0 without unused ones; NULL where the mesh keeps
   * those of the file. bw_mesh_file_clear releases them. */
  int32_t *node_from, *element_from;
} bw_mesh_file;
BW_API void bw_mesh_file_clear(bw_mesh_file *file);
/* When a mesh from a file is renumbered. */
typedef enum bw_renumber {
  BW_RENUMBER_AUTO,  /* where it pays: a large mesh whose elements span far more rows than along a
                        space-filling curve */
  BW_RENUMBER_NEVER, /* the numbers of the file */
  BW_RENUMBER_ALWAYS /* along the curve */
} bw_renumber;
/* Numbers nodes and elements along a space-filling curve (bw_mesh_renumbered), fields and sets with
 * them. On failure the file is as it was. */
BW_API bw_status bw_mesh_file_renumber(bw_context *context, bw_mesh_file *file, bw_renumber when);
/* .vtu (ascii, base64 and appended raw, zlib or not), .pvtu (the .vtu files that it names, joined),
 * .msh 2.2 and 4.1 (ascii, binary), .mesh (MEDIT), .node/.ele (either name finds both), .inp
 * (nodes, C3D4, C3D10, NSET, ELSET).
 * Nodes are kept in file order except unused ones. Elements that are not tetrahedra are counted in
 * info.skipped; none at all is BW_FORMAT. Statuses as those of bw_surface_read. `file` is written
 * on success only; release what it holds with bw_mesh_file_clear. */
BW_API bw_status bw_mesh_read(bw_context *context, const char *path, bw_mesh_file *file);
/* The same from `count` bytes in memory, under a name as bw_surface_parse. */
BW_API bw_status bw_mesh_parse(bw_context *context, const char *name, const unsigned char *bytes,
                               size_t count, bw_mesh_file *file);
/* By the ending: .vtu (appended raw, zlib), .pvtu (pieces NAME_0.vtu, NAME_1.vtu, ... beside it),
 * .msh (4.1 binary), .mesh, .node or .ele (writes both), .inp (nodes, elements, regions). Fields go
 * where the format has a place (.vtu, .pvtu, .msh); a field whose rows do not fit the mesh is
 * BW_INVALID, as is another ending. */
BW_API bw_status bw_mesh_write(bw_context *context, const bw_mesh *mesh, const char *path,
                               int field_count, const bw_field *fields);

/* ---- .pvtu whose pieces several processes write ----
 *
 * Each writes its piece as a mesh of its own by bw_mesh_write to bw_pvtu_piece_path, with integers
 * that say which nodes and elements of the whole these are. The file that names the pieces is
 * written after all of them. */
#define BW_PVTU_NODE "GlobalNodeId"       /* field on nodes, BW_I64 */
#define BW_PVTU_ELEMENT "GlobalElementId" /* field on elements, BW_I64 */
/* The path of a `piece`, from 0, of the file in pieces at `path`: a.pvtu has a_0.vtu. Release
 * *piece_path with bw_free. BW_INVALID where `path` does not end in .pvtu. */
BW_API bw_status bw_pvtu_piece_path(bw_context *context, const char *path, int piece,
                                    char **piece_path);
/* Writes the file that names pieces 0 to piece_count - 1. Of `fields`, without the two above, names
 * and types count, and no values. `regions`: the pieces' meshes have regions. BW_INVALID as above.
 */
BW_API bw_status bw_pvtu_write_index(bw_context *context, const char *path, int piece_count,
                                     bool regions, int field_count, const bw_field *fields);
/* Before pieces are written: an older file of this name names none from now on, so that it does not
 * join old and new ones where writing fails. */
BW_API bw_status bw_pvtu_empty(bw_context *context, const char *path);

/* The same as .msh 2.2 (ascii), for programs that read no other. */
BW_API bw_status bw_msh22_write(bw_context *context, const bw_mesh *mesh, const char *path,
                                int field_count, const bw_field *fields);
/* A surface with fields on its points or facets, as .vtu (BW_ON_ELEMENTS = facets). */
BW_API bw_status bw_surface_write_vtu(bw_context *context, const bw_surface *surface,
                                      const char *path, int field_count, const bw_field *fields);
/* A plane mesh with fields on its nodes or elements, as .vtu at z = 0. */
BW_API bw_status bw_plane_write_vtu(bw_context *context, const bw_plane_mesh *mesh,
                                    const char *path, int field_count, const bw_field *fields);

/* Sound: sample (-, count), clipped to -1 to 1, one channel of 16-bit samples, as .wav with `rate`
 * samples per second (1000 to 768000). BW_LIMIT beyond 2 GB. */
BW_API bw_status bw_wav_write(bw_context *context, const char *path, int32_t rate, int64_t count,
                              const double *sample);

/* ---- outlines: SVG DXF ---------------------------------------------------------------------- */

/* How drawings are read; all zeros are the defaults. */
typedef struct bw_outline_read_options {
  double unit;      /* (m) of one unit of the file; default 0: what the file says, else a pixel of
                       1/96 inch (SVG), a millimetre (DXF) */
  double tolerance; /* (m) ends of open curves this near are joined; default 0: 1e-5 of the size */
} bw_outline_read_options;
/* Lines, curves and arcs (as cubics, off by 4e-6 of the radius) of a drawing. Closed curves, and
 * open ones that close when put together, are loops; those inside an even number of others are
 * material (region 0), the rest holes. y goes up: SVG's is mirrored about the middle of the page.
 * Names are the id (SVG), tags the class (SVG) or layer (DXF). `options` and `info` may be NULL.
 * What bw_outline_write wrote comes back with its regions, names and tags (SVG) or its layers as
 * tags (DXF). BW_FORMAT where the content is not what its format says, BW_GEOMETRY for curves that
 * make no outline, BW_LIMIT for files beyond 4 GiB. */
BW_API bw_status bw_outline_read(bw_context *context, const char *path,
                                 const bw_outline_read_options *options, bw_outline **outline,
                                 bw_read_info *info);
/* The same from `count` bytes in memory, under a name as bw_surface_parse. */
BW_API bw_status bw_outline_parse(bw_context *context, const char *name, const unsigned char *bytes,
                                  size_t count, const bw_outline_read_options *options,
                                  bw_outline **outline, bw_read_info *info);
/* By the ending: .svg, .dxf; in millimetres. BW_INVALID for another. */
BW_API bw_status bw_outline_write(bw_context *context, const bw_outline *outline, const char *path);

/* A material of a deck. */
typedef struct bw_inp_material {
  bool isotropic;        /* whether young and poisson describe the material, or `stiffness` */
  double young, poisson; /* (any) modulus (Pa) and ratio (-), when isotropic */
  double stiffness[21];  /* (Pa) else the upper triangle of the 6x6 matrix in CalculiX's order
                            D1111 D1122 D2222 D1133 D2233 D3333 D1112 ... D2323 (ANISO) */
  double density;        /* (kg/m3) 0: none written */
  double expansion;      /* (1/K) alike in all directions; with temperatures */
} bw_inp_material;

/* A CalculiX/Abaqus static step, ready for ccx. Written by bw_model_write_inp (model.h). All
 * pointers are borrowed. */
typedef struct bw_inp_deck {
  const bw_mesh *mesh;
  const char *title; /* one line */
  int32_t material_count;
  const bw_inp_material *material; /* (material_count) */
  const int32_t *material_of;      /* (index, element_count) from 0; NULL: all are of the first */
  double gravity[3];               /* (m/s2) */
  int64_t fixed_count;             /* single displacements: node, direction 0..2, value */
  int64_t isostatic_count;       /* the last of them only hold a free body, and a comment says so */
  const int32_t *fixed_node;     /* (index, fixed_count) */
  const int *fixed_direction;    /* (fixed_count) 0, 1 or 2 */
  const double *fixed_value;     /* (m, fixed_count) */
  int64_t equation_count;        /* a0 u0 + a1 u1 + a2 u2 = 0 at one node (oblique slides) */
  const int32_t *equation_node;  /* (index, equation_count) */
  const double *equation_normal; /* (-, equation_count x 3) the a */
  const double *force;           /* (N, node_count x 3) or NULL */
  const double *temperature;     /* (K, node_count) changes of temperature, or NULL */
  int modes;                     /* > 0: a *FREQUENCY step for so many modes instead */
} bw_inp_deck;
/* Writes a deck as .inp. */
BW_API bw_status bw_inp_write(bw_context *context, const bw_inp_deck *deck, const char *path);

#ifdef __cplusplus
}
#endif
#endif
