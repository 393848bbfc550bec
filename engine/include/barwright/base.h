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

/* The version as numbers, as one number that grows with versions (for #if), and as a text. A change
 * of MINOR may rename and remove until MAJOR is 1. */
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

/* For compilers: an argument is a printf format, a result must be used. */
#if defined(__GNUC__)
#define BW_PRINTF(text, first) __attribute__((format(printf, text, first)))
#define BW_MUST_USE __attribute__((warn_unused_result))
#else
#define BW_PRINTF(text, first)
#define BW_MUST_USE
#endif

/* ---- status and message ------------------------------------------------------------- */

/* What became of a call. */
typedef enum bw_status {
  BW_OK = 0,        /* success */
  BW_INVALID,       /* an argument or option outside what its comment allows */
  BW_MEMORY,        /* memory ran out */
  BW_IO,            /* the operating system refused a file operation */
  BW_FORMAT,        /* a file's content is not what its format says */
  BW_GEOMETRY,      /* a shape that cannot be used: open, self-intersecting, inverted, empty */
  BW_EMPTY,         /* a selection that holds nothing */
  BW_UNCONSTRAINED, /* a body with rigid-body modes, or a load that is not balanced */
  BW_SINGULAR,      /* a matrix that is not positive definite although the body is constrained */
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

/* The last failure, warnings, progress, the request to cancel, and the threads: what a sequence of
 * calls shares. bw_context_destroy releases it. Functions that take a context also accept NULL, and
 * then record nothing and use one thread, where their comment says so. */
typedef struct bw_context bw_context;

/* A context for the caller to release by bw_context_destroy; NULL when memory ran out. The thread
 * count starts at the environment variable BARWRIGHT_THREADS, or the number of processors. */
BW_API bw_context *bw_context_create(void);
BW_API void bw_context_destroy(bw_context *context);

/* Record a failure and return its status: `return bw_fail(context, BW_FORMAT, ...)`.
 * The message, by the printf `format`, names what was expected and what to do. It replaces that of
 * the failure before, and drops its details. The context may be NULL. May be called inside
 * bw_parallel bodies. */
BW_API bw_status bw_fail(bw_context *context, bw_status status, const char *format, ...)
    BW_PRINTF(3, 4);
/* Attach a number `value` (any) to the last failure under a key ("line", "byte", "element", ...).
 * Numbers of nodes, elements and the like count from 1 in details, as in messages; those of the C
 * interface from 0. The key and a text are copied, and cut where they are longer than what a
 * detail holds. A key that is there is overwritten. */
BW_API void bw_detail_number(bw_context *context, const char *key, double value);
/* The same for a key with a text `value` ("file", "limit", ...). */
BW_API void bw_detail_text(bw_context *context, const char *key, const char *value);
/* The sentence of the last failure; "" when there was none. Valid until the next failure on this
 * context. */
BW_API const char *bw_message(const bw_context *context);
/* The i-th detail of the last failure, with its *key and its *number (any), or false past the end.
 * *text is NULL for a number. Both texts are valid until the next failure. */
BW_API bool bw_detail(const bw_context *context, int i, const char **key, double *number,
                      const char **text);
/* Removes the message and the details of the last failure. */
BW_API void bw_clear_failure(bw_context *context);

/* Propagate a failure: jumps to the `done:` label with `status` set. */
#define BW_TRY(call)                                                                               \
  do {                                                                                             \
    status = (call);                                                                               \
    if (status != BW_OK)                                                                           \
      goto done;                                                                                   \
  } while (0)
/* BW_TRY with BW_MEMORY, unless all that `allocated` names is there. */
#define BW_TRY_MEMORY(allocated) BW_TRY((allocated) ? BW_OK : BW_MEMORY)

/* ---- progress and cancelling -------------------------------------------------------- */

/* Called on the caller's thread with a stage name, valid during the call, and the fraction done of
 * that stage, 0 to 1. */
typedef void bw_progress_function(void *data, const char *stage, double fraction);
/* Registers the function that bw_progress calls with `data`; NULL: none. Both are borrowed until
 * the next registration. */
BW_API void bw_set_progress(bw_context *context, bw_progress_function *function, void *data);
/* Reports the fraction done of a stage to the registered function, if there is one. Does nothing
 * inside bw_parallel bodies that run on other threads, and for a context of NULL. */
BW_API void bw_progress(bw_context *context, const char *stage, double fraction);
/* Ask running work to stop; from any thread, and async-signal-safe. */
BW_API void bw_cancel(bw_context *context);
/* Withdraws the request to stop: else every later call of long work stops too. */
BW_API void bw_clear_cancel(bw_context *context);
/* Whether bw_cancel was called; false for a context of NULL. From any thread. */
BW_API bool bw_cancelled(const bw_context *context);
/* BW_CANCELLED with a message when bw_cancel was called, else BW_OK: for use with BW_TRY. */
BW_API bw_status bw_check_cancel(bw_context *context);

/* Adds a warning that is not a failure ("the surface was repaired: ..."), by the printf `format`,
 * up to 64 of them in order; one with the same text is not repeated. From any thread; the context
 * may be NULL. */
BW_API void bw_warn(bw_context *context, const char *format, ...) BW_PRINTF(2, 3);
/* The i-th warning, valid until bw_clear_warnings; NULL past the end. */
BW_API const char *bw_warning_at(const bw_context *context, int i);
/* Removes all warnings. */
BW_API void bw_clear_warnings(bw_context *context);

/* The time of a monotonic clock (s). */
BW_API double bw_seconds(void);

/* Bytes of a bw_name with the final 0. */
enum { BW_NAME = 48 /* bytes */ };
/* A name of a bone, a loop, a tag. */
typedef struct bw_name {
  char text[BW_NAME]; /* UTF-8, ends with 0 */
} bw_name;

/* ---- memory ------------------------------------------------------------------------- */

/* count * size bytes, not initialised; NULL (with BW_MEMORY recorded) when there is no memory or
 * the product overflows. count 0 gives a valid pointer. Release with bw_free. The context may be
 * NULL. From any thread, like all functions of memory. */
BW_API void *bw_alloc(bw_context *context, size_t count, size_t size) BW_MUST_USE;
/* The same count * size bytes, all zeros; release with bw_free. */
BW_API void *bw_calloc(bw_context *context, size_t count, size_t size) BW_MUST_USE;
/* As realloc, to count * size bytes, for blocks of bw_alloc and NULL. A result of NULL leaves the
 * old block alive; else release the new one with bw_free. */
BW_API void *bw_resize(bw_context *context, void *block, size_t count, size_t size) BW_MUST_USE;
/* Releases a block of this section. NULL is fine. */
BW_API void bw_free(void *block);

/* A block for `count` values of a type, and the same with zeros; release with bw_free. */
#define BW_NEW(context, type, count) ((type *)bw_alloc((context), (size_t)(count), sizeof(type)))
#define BW_NEW0(context, type, count) ((type *)bw_calloc((context), (size_t)(count), sizeof(type)))

/* Blocks that are alive, for leak checks. */
BW_API int64_t bw_live_blocks(void);
/* Makes the n-th allocation from now fail (1 = the next), and with `repeat` every later one;
 * 0 switches this off. For tests. */
BW_API void bw_fail_allocation(int64_t n, bool repeat);
/* Allocations since the start of the process. */
BW_API int64_t bw_allocation_count(void);

/* Makes room for `extra` more items of `size` bytes behind the first `count` of *list, a block of
 * bw_alloc or NULL, of *capacity items. The capacity doubles. False, with BW_MEMORY recorded and
 * the list as it was, without memory. if (!bw_grow(context, (void **)&list, &capacity, count, 1,
 * sizeof *list)) return BW_MEMORY; */
BW_API bool bw_grow(bw_context *context, void **list, size_t *capacity, size_t count, size_t extra,
                    size_t size) BW_MUST_USE;

/* ---- reference-counted objects -------------------------------------------------------- */

/* What objects of one type share; static. */
typedef struct bw_kind {
  const char *name;                    /* of the type, for messages: "mesh" */
  void (*destroy)(void *object);       /* frees everything, also the object itself */
  size_t (*bytes)(const void *object); /* memory held by the object alone; may be NULL */
} bw_kind;

/* The first member of every reference-counted object. The revision moves only on real change. */
typedef struct bw_object {
  const bw_kind *kind; /* static */
  int64_t references;  /* the last one that is released destroys the object */
  uint64_t revision;   /* from 1; grows with each change of a mutable object */
} bw_object;

/* Gives a new object its kind, one reference and revision 1. */
BW_API void bw_object_init(void *object, const bw_kind *kind);
/* Adds a reference, for the caller to release with bw_release, and returns the object; NULL stays
 * NULL. From any thread. */
BW_API void *bw_retain(const void *object);
/* Gives up a reference; the last one destroys the object. NULL is fine. From any thread. */
BW_API void bw_release(const void *object);
/* Bytes that the object alone holds, without what it retains; 0 for NULL or where not known. */
BW_API size_t bw_bytes(const void *object);

/* ---- arrays --------------------------------------------------------------------------- */

/* The type of an array's numbers. */
typedef enum bw_type {
  BW_F64, /* double */
  BW_I32, /* int32_t */
  BW_I64, /* int64_t */
  BW_U8   /* uint8_t */
} bw_type;

/* A strided view of rows x columns numbers that keeps its owner alive. Strides are in bytes. */
typedef struct bw_array {
  bw_object object;
  bw_type type;
  int64_t rows, columns;               /* sizes, 0 or more */
  ptrdiff_t row_stride, column_stride; /* bytes from one row, or column, to the next */
  void *data;                          /* number (0, 0) */
  const void *owner; /* a retained engine object, or NULL: the data are the array's own */
} bw_array;

/* Bytes of one number. */
BW_API size_t bw_type_size(bw_type type);
/* An array of `rows` x `columns` zeros that owns its data. */
BW_API bw_status bw_array_create(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                                 bw_array **array);
/* An array of `rows` x `columns` numbers that takes over `data`, a block of bw_alloc with them row
 * by row. On failure the data stay the caller's. */
BW_API bw_status bw_array_adopt(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                                void *data, bw_array **array);
/* An array on `rows` x `columns` numbers row by row in `data`, which live as long as `owner`, an
 * object that the array retains (not NULL). */
BW_API bw_status bw_array_borrow(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                                 const void *data, const void *owner, bw_array **array);
/* A view on the same memory, which retains `array`: `rows` rows first_row, first_row + row_step,
 * ... and `columns` columns first_column, first_column + column_step, ... Steps may be negative. */
BW_API bw_status bw_array_view(bw_context *context, const bw_array *array, int64_t first_row,
                               int64_t rows, int64_t row_step, int64_t first_column,
                               int64_t columns, int64_t column_step, bw_array **view);
/* The number in a row and a column, as a double (any). Both must be inside: they are not
 * checked. */
BW_API double bw_array_get(const bw_array *array, int64_t row, int64_t column);

/* ---- threads -------------------------------------------------------------------------- */

/* How many threads work at once. */
BW_API int bw_threads(const bw_context *context);
/* Sets how many `threads` work at once, the caller's included: 1 or more, or BW_INVALID. */
BW_API bw_status bw_set_threads(bw_context *context, int threads);

/* Work on items `begin` to `end` - 1, on any thread. `worker` is 0..threads-1, for scratch memory
 * only: what is computed must not depend on it. */
typedef bw_status bw_body(void *data, int64_t begin, int64_t end, int worker);
/* Cut 0..count into chunks of `grain` (the same cut for any thread count) and run them. The status
 * is that of the failing chunk with the lowest number. Calls inside a body run serially. */
BW_API bw_status bw_parallel(bw_context *context, int64_t count, int64_t grain, bw_body *body,
                             void *data);

/* ---- small tensors -------------------------------------------------------------------- */
/* Symmetric tensors are stored xx yy zz yz zx xy (the worst-case paper's order); strains carry
 * engineering shears (twice the tensor component). Matrices are row by row. */

/* The scalar product (any) of a and b (any). */
BW_API double bw_dot(const double a[3], const double b[3]);
/* The vector product c (any) of a and b (any); c may be a or b. */
BW_API void bw_cross(const double a[3], const double b[3], double c[3]);
/* The Euclidean norm (any) of a (any). */
BW_API double bw_norm(const double a[3]);
/* Two unit vectors a and b (-) at right angles to a unit vector and to each other, so that
 * unit (-) x a = b. */
BW_API void bw_across(const double unit[3], double a[3], double b[3]);
/* The inverse (any) of a 3x3 matrix a (any). Returns the determinant (any), and does not write the
 * inverse when it is 0. */
BW_API double bw_inverse3(const double a[9], double inverse[9]);
/* The eigenvalues `values` (any), descending, of a symmetric tensor (any), and its unit
 * eigenvectors as the rows of `vectors` (-), which may be NULL. */
BW_API void bw_eigen3(const double tensor[6], double values[3], double vectors[9]);
/* The von Mises stress (Pa). */
BW_API double bw_von_mises(const double stress[6]);

/* ---- SHA-256, JSON numbers --------------------------------------------------------------- */

/* SHA-256 of a file: `digest` gets 64 hexadecimal digits and a final 0. BW_IO where it cannot be
 * read. */
BW_API bw_status bw_sha256_file(bw_context *context, const char *path, char digest[65]);
/* The same `digest` of `count` bytes. */
BW_API void bw_sha256_bytes(const void *bytes, size_t count, char digest[65]);

/* ---- folders, locks ---------------------------------------------------------------------- */

/* Makes a folder and those above it; one that is there is fine. BW_IO where this is refused. */
BW_API bw_status bw_folder_make(bw_context *context, const char *path);
/* Called for each entry of a folder, in no order: its name, valid during the call, whether it is a
 * folder, the bytes of a file, and when it changed (s) last, from 1970 on. A status other than
 * BW_OK ends the visit. */
typedef bw_status bw_folder_entry(void *data, const char *name, bool folder, int64_t bytes,
                                  double changed);
/* Calls `entry` for all that is in a folder but "." and "..". BW_IO where it cannot be read, or the
 * status of `entry`. */
BW_API bw_status bw_folder_visit(bw_context *context, const char *path, bw_folder_entry *entry,
                                 void *data);
/* Sets the time of a file's last change to now. BW_IO where this is refused. */
BW_API bw_status bw_file_touch(bw_context *context, const char *path);

/* A lock between processes: an object that ends with its last reference, or with the process. A
 * forked child does not have it. */
typedef struct bw_lock bw_lock;
/* Takes the lock on the file `path`, which is made for it and removed with it. Waits up to
 * `seconds` for the process that has it; then BW_LIMIT with the details limit = "lock" and holder.
 * BW_IO where the file cannot be made or locked. */
BW_API bw_status bw_lock_take(bw_context *context, const char *path, double seconds,
                              bw_lock **lock);

/* A generator of deterministic random numbers (splitmix64 / xoshiro256**), for one thread. */
typedef struct bw_random {
  uint64_t state[4]; /* of xoshiro256** */
} bw_random;
/* Starts the sequence of a `seed`; every seed is fine. */
BW_API void bw_random_seed(bw_random *random, uint64_t seed);
/* The next 64 random bits. */
BW_API uint64_t bw_random_bits(bw_random *random);
/* The next number of the uniform distribution (-) on [0, 1). */
BW_API double bw_random_uniform(bw_random *random);
/* The next number of the standard normal distribution (-). */
BW_API double bw_random_normal(bw_random *random);

#ifdef __cplusplus
}
#endif

#endif
