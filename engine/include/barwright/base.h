/* base: context, status and message, allocation, reference counts, arrays, small tensors,
 * threads. See barwright.h for the contract. */
#ifndef BARWRIGHT_BASE_H
#define BARWRIGHT_BASE_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A change of MINOR may rename and remove until MAJOR is 1. BW_VERSION_NUMBER grows with versions,
 * for #if. */
#define BW_VERSION_MAJOR 0
#define BW_VERSION_MINOR 1
#define BW_VERSION_PATCH 0
#define BW_VERSION_NUMBER (BW_VERSION_MAJOR * 10000 + BW_VERSION_MINOR * 100 + BW_VERSION_PATCH)
#define BW_VERSION_TEXT_(major, minor, patch) #major "." #minor "." #patch
#define BW_VERSION_TEXT(major, minor, patch) BW_VERSION_TEXT_(major, minor, patch)
#define BW_VERSION BW_VERSION_TEXT(BW_VERSION_MAJOR, BW_VERSION_MINOR, BW_VERSION_PATCH)

/* What the library exports; all else is hidden. */
#if defined(__GNUC__)
#define BW_API __attribute__((visibility("default")))
#else
#define BW_API
#endif

#if defined(__GNUC__)
#define BW_PRINTF(text, first) __attribute__((format(printf, text, first)))
#define BW_MUST_USE __attribute__((warn_unused_result))
#else
#define BW_PRINTF(text, first)
#define BW_MUST_USE
#endif

/* ---- status and message ------------------------------------------------------------- */

typedef enum bw_status {
  BW_OK = 0,
  BW_INVALID,       /* an argument or option outside what its comment allows */
  BW_MEMORY,        /* memory ran out */
  BW_IO,            /* the operating system refused a file operation */
  BW_FORMAT,        /* a file's content is not what its format says */
  BW_GEOMETRY,      /* a shape that cannot be used: open, self-intersecting, inverted, empty */
  BW_EMPTY,         /* a selection that holds nothing */
  BW_UNCONSTRAINED, /* a body that is not held, or a load that is not balanced */
  BW_SINGULAR,      /* a matrix that is not positive definite although the body is held */
  BW_CONVERGENCE,   /* an iteration that did not reach its tolerance */
  BW_INFEASIBLE,    /* constraints that no load fulfils */
  BW_LIMIT,         /* a limit on time, memory or size was reached */
  BW_CANCELLED,     /* the caller asked to stop */
  BW_UNSUPPORTED,   /* a valid request that this build or format cannot serve */
  BW_INTERNAL,      /* a check inside the engine failed: please report it */
  BW_BROKEN = -1    /* the object that was being changed is fit only for release */
} bw_status;

/* The word for a status, e.g. "format": stable, used as details.status in Lua. */
BW_API const char *bw_status_word(bw_status status);

typedef struct bw_context bw_context;

/* A context. NULL only when memory is out. The thread count starts at BARWRIGHT_THREADS or the
 * number of processors. */
BW_API bw_context *bw_context_create(void);
BW_API void bw_context_destroy(bw_context *context);

/* Record a failure and return its status: `return bw_fail(context, BW_FORMAT, ...)`.
 * The message names what was expected and what to do. May be called inside bw_parallel bodies. */
BW_API bw_status bw_fail(bw_context *context, bw_status status, const char *format, ...)
    BW_PRINTF(3, 4);
/* Attach a number or a text to the last failure ("line", "byte", "element", "file", ...). Numbers
 * of nodes, elements and the like count from 1 in details, as in messages; those of the C interface
 * from 0. */
BW_API void bw_detail_number(bw_context *context, const char *key, double value);
BW_API void bw_detail_text(bw_context *context, const char *key, const char *value);
/* The sentence of the last failure; "" when there was none. Valid until the next failure. */
BW_API const char *bw_message(const bw_context *context);
/* The i-th detail, or false past the end. *text is NULL for a number. */
BW_API bool bw_detail(const bw_context *context, int i, const char **key, double *number,
                      const char **text);
BW_API void bw_clear_failure(bw_context *context);

/* Propagate a failure: jumps to the `done:` label with `status` set. */
#define BW_TRY(call)                                                                               \
  do {                                                                                             \
    status = (call);                                                                               \
    if (status != BW_OK)                                                                           \
      goto done;                                                                                   \
  } while (0)

/* ---- progress and cancelling -------------------------------------------------------- */

/* Called on the caller's thread with a stage name and the fraction done of that stage, 0 to 1. */
typedef void bw_progress_function(void *data, const char *stage, double fraction);
BW_API void bw_set_progress(bw_context *context, bw_progress_function *function, void *data);
BW_API void bw_progress(bw_context *context, const char *stage, double fraction);
/* Ask running work to stop; async-signal-safe. */
BW_API void bw_cancel(bw_context *context);
BW_API void bw_clear_cancel(bw_context *context);
BW_API bool bw_cancelled(const bw_context *context);
/* BW_CANCELLED with a message when bw_cancel was called, else BW_OK: for use with BW_TRY. */
BW_API bw_status bw_check_cancel(bw_context *context);

/* A warning that is not a failure ("the surface was repaired: ..."), kept in order until taken. */
BW_API void bw_warn(bw_context *context, const char *format, ...) BW_PRINTF(2, 3);
BW_API const char *bw_warning_at(const bw_context *context, int i); /* NULL past the end */
BW_API void bw_clear_warnings(bw_context *context);

/* Seconds of a monotonic clock. */
BW_API double bw_seconds(void);

/* A name of a bone, a loop, a tag. */
enum { BW_NAME = 48 };
typedef struct bw_name {
  char text[BW_NAME];
} bw_name;

/* ---- memory ------------------------------------------------------------------------- */

/* count*size bytes, checked for overflow; NULL (with BW_MEMORY recorded) when there is no memory.
 * count 0 gives a valid pointer. Release with bw_free; free(NULL) is fine. */
BW_API void *bw_alloc(bw_context *context, size_t count, size_t size) BW_MUST_USE;
BW_API void *bw_calloc(bw_context *context, size_t count, size_t size) BW_MUST_USE;
/* As realloc, NULL leaves the old block alive. */
BW_API void *bw_resize(bw_context *context, void *block, size_t count, size_t size) BW_MUST_USE;
BW_API void bw_free(void *block);

#define BW_NEW(context, type, count) ((type *)bw_alloc((context), (size_t)(count), sizeof(type)))
#define BW_NEW0(context, type, count) ((type *)bw_calloc((context), (size_t)(count), sizeof(type)))

/* Blocks that are alive, for leak checks. */
BW_API int64_t bw_live_blocks(void);
/* Let the n-th allocation from now fail (1 = the next), and with `repeat` every later one;
 * 0 switches this off. For tests. */
BW_API void bw_fail_allocation(int64_t n, bool repeat);
/* Allocations since the start of the process. */
BW_API int64_t bw_allocation_count(void);

/* A growing list: make room for `extra` more items behind `count`. Doubling growth.
 *   if (!bw_grow(context, (void **)&list, &capacity, count, 1, sizeof *list)) return BW_MEMORY; */
BW_API bool bw_grow(bw_context *context, void **list, size_t *capacity, size_t count, size_t extra,
                    size_t size) BW_MUST_USE;

/* ---- reference-counted objects -------------------------------------------------------- */

typedef struct bw_kind {
  const char *name;
  void (*destroy)(void *object);       /* frees everything, also the object itself */
  size_t (*bytes)(const void *object); /* memory held by the object alone; may be NULL */
} bw_kind;

/* The first member of every reference-counted object. The revision moves only on real change. */
typedef struct bw_object {
  const bw_kind *kind;
  int64_t references;
  uint64_t revision;
} bw_object;

BW_API void bw_object_init(void *object, const bw_kind *kind); /* one reference, revision 1 */
BW_API void *bw_retain(const void *object);                    /* returns it; NULL stays NULL */
BW_API void bw_release(const void *object);                    /* NULL is fine */
BW_API size_t bw_bytes(const void *object);
BW_API const char *bw_kind_name(const void *object);

/* ---- arrays --------------------------------------------------------------------------- */

typedef enum bw_type { BW_F64, BW_I32, BW_I64, BW_U8 } bw_type;

/* A strided view of rows x columns numbers that keeps its owner alive. Strides are in bytes. */
typedef struct bw_array {
  bw_object object;
  bw_type type;
  int64_t rows, columns;
  ptrdiff_t row_stride, column_stride;
  void *data;
  const void *owner; /* a retained engine object, or NULL: the data are the array's own */
} bw_array;

BW_API size_t bw_type_size(bw_type type);
BW_API bw_status bw_array_create(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                                 bw_array **array); /* zeros */
BW_API bw_status bw_array_own(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                              void *data,
                              bw_array **array); /* on failure the data stay the caller's */
BW_API bw_status bw_array_borrow(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                                 const void *data, const void *owner, bw_array **array);
/* rows first..first+rows-1 by row_step, columns likewise: a view on the same memory */
BW_API bw_status bw_array_view(bw_context *context, const bw_array *array, int64_t first_row,
                               int64_t rows, int64_t row_step, int64_t first_column,
                               int64_t columns, int64_t column_step, bw_array **view);
BW_API double bw_array_get(const bw_array *array, int64_t row, int64_t column); /* as a double */

/* ---- threads -------------------------------------------------------------------------- */

BW_API int bw_threads(const bw_context *context);
BW_API bw_status bw_set_threads(bw_context *context, int threads);

/* Work on items [begin, end). `worker` is 0..threads-1, for scratch memory only: what is computed
 * must not depend on it. */
typedef bw_status bw_body(void *data, int64_t begin, int64_t end, int worker);
/* Cut 0..count into chunks of `grain` (the same cut for any thread count) and run them. The status
 * is that of the failing chunk with the lowest number. Calls inside a body run serially. */
BW_API bw_status bw_parallel(bw_context *context, int64_t count, int64_t grain, bw_body *body,
                             void *data);

/* ---- small tensors -------------------------------------------------------------------- */
/* Symmetric tensors are stored xx yy zz yz zx xy (the worst-case paper's order); strains carry
 * engineering shears (twice the tensor component). Matrices are row by row. */

BW_API double bw_dot(const double a[3], const double b[3]);
BW_API void bw_cross(const double a[3], const double b[3], double c[3]);
BW_API double bw_norm(const double a[3]);
/* Two unit vectors at right angles to a unit vector and to each other: unit x a = b. */
BW_API void bw_across(const double unit[3], double a[3], double b[3]);
/* Inverse of a 3x3 matrix; returns the determinant (inverse untouched when it is 0). */
BW_API double bw_inverse3(const double a[9], double inverse[9]);
/* Eigenvalues in descending order and, when vectors is not NULL, unit eigenvectors as rows. */
BW_API void bw_eigen3(const double tensor[6], double values[3], double vectors[9]);
BW_API double bw_von_mises(const double stress[6]);

/* ---- SHA-256, JSON numbers --------------------------------------------------------------- */

/* SHA-256 of a file as 64 hexadecimal digits and a final 0. */
BW_API bw_status bw_sha256_file(bw_context *context, const char *path, char digest[65]);
BW_API void bw_sha256_bytes(const void *bytes, size_t count, char digest[65]);

/* ---- folders, locks ---------------------------------------------------------------------- */

/* Makes a folder and those above it; one that is there is fine. */
BW_API bw_status bw_folder_make(bw_context *context, const char *path);
/* What is in a folder, in no order: bytes of a file, time of its last change in seconds. */
typedef bw_status bw_folder_entry(void *data, const char *name, bool folder, int64_t bytes,
                                  double changed);
BW_API bw_status bw_folder_visit(bw_context *context, const char *path, bw_folder_entry *entry,
                                 void *data);
/* Sets the time of a file's last change to now. */
BW_API bw_status bw_file_touch(bw_context *context, const char *path);

/* A lock between processes on the file `path`, which is made for it and removed with it. Waits up
 * to `seconds` for whoever has it; then BW_LIMIT with the details limit = "lock" and holder. It
 * ends with bw_release, or with the process; a forked child does not have it. */
typedef struct bw_lock bw_lock;
BW_API bw_status bw_lock_take(bw_context *context, const char *path, double seconds,
                              bw_lock **lock);

/* Deterministic random numbers (splitmix64 / xoshiro256**). */
typedef struct bw_random {
  uint64_t state[4];
} bw_random;
BW_API void bw_random_seed(bw_random *random, uint64_t seed);
BW_API uint64_t bw_random_bits(bw_random *random);
BW_API double bw_random_uniform(bw_random *random); /* [0, 1) */
BW_API double bw_random_normal(bw_random *random);

#ifdef __cplusplus
}
#endif
#endif
