/* metamaterial: coarse materials fitted to blocks of fine ones, kept in a library, and found there
 * again by lookup (data-driven, sections 4 and 5). */
#ifndef BARWRIGHT_METAMATERIAL_H
#define BARWRIGHT_METAMATERIAL_H

#include "barwright/nonlinear.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- libraries ---------------------------------------------------------------------------------
 *
 * A block is 2 x 2 x 2 fine elements; its key is their materials, child c in octant c (bits as
 * corners). Keys that a symmetry of the cube takes into each other share one fit. A library says
 * for every key which fit and which symmetry; from level 2 on, blocks of coarse materials are
 * looked up direction by direction (x, y, z) in tables of pairs of representatives. */
/* How a library is built. */
typedef struct bw_library_options {
  int levels;     /* 1 (default) or 2; 0: no block is fitted beforehand, the library is to be
                     grown */
  bool voids;     /* blocks with void too; default true. Without, they are coarsened naively */
  int directions; /* of force, for each block; default 500, 1 to 1e6 */
  int magnitudes; /* along each; default 5, 1 to 1000 */
  int stretches;  /* directions in which a block without symmetry is stretched to find axes
                     beside those of the cube; default 500, 0 to 1e6 */
  int fibres;     /* axes of anisotropy at a point: 0 to 3, default 3 */
  double strain;  /* (-) the largest deformation sampled, roughly; default 0.1, 1e-5 to 10 */
  double ridge;   /* (-) lambda of formula (4): changing a constant by its own size costs as much
                     as this relative error; default 0.01, 0 or more */
  int representatives; /* at every stage of level 2, 8 to 4000; so many blocks are fitted;
                          default 400 */
  uint64_t seed;       /* of the samples; default 1 */
} bw_library_options;
BW_API void bw_library_options_default(bw_library_options *options);

/* How well a fit does, on deformations that it was not fitted to: of |fitted - exact| energies over
 * the exact ones, and the same of the naive material. */
typedef struct bw_fit_error {
  double median, worst, naive_median, naive_worst; /* (-) worst: the 95th percentile */
  double force, naive_force; /* (-) |difference of the coarse forces| / |force|, median, in
                                coordinates of equal energy */
  int samples;               /* that were found: blocks may refuse extreme forces */
} bw_fit_error;

/* Fits of blocks. Does not change once made. */
typedef struct bw_library {
  bw_object object;
  const bw_material_table *material_table; /* retained: the base materials, uniform, of level 0 */
  bw_library_options options;              /* that it was built by */
  int levels;                              /* that something can be looked up at */
  int32_t fit_count[2];                    /* of level 1 and 2, as it was built */
  const bw_fit_error *error[2];            /* fit_count: of each */
  int32_t grown_count[2];                  /* blocks that were fitted by bw_library_grow */
  const bw_fit_error *grown_error[2];      /* grown_count: of each */
  double seconds; /* that building took, over all runs; 0 when read from a file */
  struct bwi_library *inner;
} bw_library;

/* Builds on all threads, with progress. `checkpoint` (may be NULL): a file that finished fits are
 * added to and from which a build that was killed carries on; one of another material table or
 * other options is BW_INVALID. The same library, bit for bit, for any number of threads and kills.
 * BW_LIMIT for material tables whose keys are too many (more than 2^24), BW_FORMAT for a checkpoint
 * that is damaged, BW_IO for one that cannot be read or written. BW_CANCELLED keeps the checkpoint.
 * `options` may be NULL. */
BW_API bw_status bw_library_build(bw_context *context, const bw_material_table *material_table,
                                  const bw_library_options *options, const char *checkpoint,
                                  bw_library **library);
/* The library with fits of its own for all blocks of a grid that have none: keys of level 1 that
 * were left out, and with `levels` 2 each block of 64 for which a representative would stand. They
 * are fitted as those of the library are, with its options, and are looked up first. material_table
 * as for bw_coarsen. Runs on all threads, with progress; `checkpoint` (may be NULL) keeps what is
 * done, for any grid that the library is grown for: BW_FORMAT and BW_IO as bw_library_build. The
 * result depends on the library and the set of blocks alone. */
BW_API bw_status bw_library_grow(bw_context *context, const bw_library *library,
                                 const bw_material_table *material_table, const bw_grid *fine,
                                 int levels, const char *checkpoint, bw_library **grown);
/* One file (.bwm): version, material table, options, fits, errors, tables; zlib, with a
 * checksum. */
BW_API bw_status bw_library_write(bw_context *context, const bw_library *library, const char *path);
/* Reads such a file. One that is damaged, foreign or of another version is BW_FORMAT with the
 * reason, one too large BW_LIMIT. */
BW_API bw_status bw_library_read(bw_context *context, const char *path, bw_library **library);
/* The same from `count` bytes in memory, under a name for messages. Those of bw_library_read. */
BW_API bw_status bw_library_parse(bw_context *context, const char *name, const unsigned char *bytes,
                                  size_t count, bw_library **library);
/* A few lines of *text: material table, levels, fits, errors by class of block. Release it with
 * bw_free. */
BW_API bw_status bw_library_describe(bw_context *context, const bw_library *library, char **text);
/* The fitted material of a key (8 at `level` 1, 64 at 2, child by child), and of which *fit, which
 * may be NULL: grown ones are numbered behind those of the library as it was built; -1: none.
 * BW_EMPTY for void alone. */
BW_API bw_status bw_library_material(bw_context *context, const bw_library *library, int level,
                                     const int32_t *key, bw_solid_material **material,
                                     int32_t *fit);

/* ---- coarsening ------------------------------------------------------------------------------ */

/* How coarse materials are found. */
typedef enum bw_coarse_method {
  BW_COARSE_LOOKUP, /* by a library */
  BW_COARSE_NAIVE,  /* each point takes the material of the fine element there */
  BW_COARSE_AVERAGE /* Lame's constants averaged over the block */
} bw_coarse_method;
/* A fine grid made coarse, `levels` times. Does not change once made. */
typedef struct bw_coarse {
  bw_object object;
  bw_coarse_method method;                      /* as asked for */
  int levels;                                   /* how many, 1 or 2 */
  const bw_library *library;                    /* retained; NULL for baselines */
  const bw_material_table *fine_material_table; /* retained */
  const bw_grid *fine, *grid; /* retained; the coarse grid's materials are rows of material_table,
                                 its elements those of the last coarsening */
  const bw_material_table *material_table; /* retained: the coarse materials there are */
  const bw_coarsening *coarsening[2];      /* levels: from fine to coarse, retained */
  int64_t looked_up;                       /* blocks assigned in making this one */
  double seconds_lattice, seconds_lookup;  /* (s) of the parts */
  struct bwi_coarse_keys *inner;
} bw_coarse;
/* Coarsens a grid by 1 or 2 `levels`, in time linear in the elements. `library` NULL for baselines;
 * material_table is that of the grid, and must be the library's (same laws and constants,
 * BW_INVALID names the first that differs). A library is of cubes: for lookup spacing must be the
 * same in all directions (BW_INVALID). BW_LIMIT where lattice points pass 2^31. */
BW_API bw_status bw_coarsen(bw_context *context, bw_coarse_method method, const bw_library *library,
                            const bw_material_table *material_table, const bw_grid *fine,
                            int levels, bw_coarse **coarse);
/* The same for an edited fine grid on the same lattice: only blocks in which something differs are
 * looked up again, and where no element came or went the coarse grid's lists are shared. */
BW_API bw_status bw_coarse_follow(bw_context *context, const bw_coarse *coarse, const bw_grid *fine,
                                  bw_coarse **followed);
/* Displacements u (m, node_count x 3) of the coarse grid at fine nodes, fine (m, node_count x 3),
 * through all levels. */
BW_API void bw_coarse_to_fine(const bw_coarse *coarse, const double *u, double *fine);

#ifdef __cplusplus
}
#endif
#endif
