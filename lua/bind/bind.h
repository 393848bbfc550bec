/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of the Lua binding share.
 *
 * A box is a full userdata that holds one engine object with one reference. It is made before the
 * engine is called, so that Lua running out of memory leaks nothing; a box whose object is NULL is
 * closed (or was never filled). The engine object retains what it depends on: nothing is kept
 * alive by Lua user values alone.
 *
 * Every call into the engine stands between lbw_enter and lbw_leave. Between the two no Lua error
 * may be raised (it would jump over the engine); callbacks into Lua run protected, keep their
 * error, and lbw_leave raises it. A callback may not call the engine again nor close a box: both
 * raise inside the callback. */
#ifndef LBW_BIND_H
#define LBW_BIND_H

#include <lauxlib.h>
#include <lua.h>
#include <signal.h>

#include "barwright.h"

/* A property, or a method without arguments, whose value one call pushes. */
#define LBW_PUSH(name, push)                                                                       \
  static int name(lua_State *L) {                                                                  \
    push;                                                                                          \
    return 1;                                                                                      \
  }

/* ---- one state per Lua state ----------------------------------------------------------------- */

typedef struct lbw_class lbw_class;
typedef struct lbw_late lbw_late;
typedef struct lbw_guard {
  const struct lbw_guard *outer;
  lua_State *caller; /* the state's, from before */
  int running;
  bool open;
} lbw_guard;

typedef struct lbw_state {
  bw_context *context;
  const lbw_guard *guard;         /* the innermost; NULL: no bound function runs */
  lbw_late *late;                 /* what is released when it ends */
  lua_State *caller;              /* of the engine call that runs */
  volatile sig_atomic_t running;  /* 1 while the engine works; read by a signal handler */
  volatile sig_atomic_t stopping; /* set when an interrupt was asked for */
  bool reporting;                 /* the script's progress function runs */
  bool callback_failed;           /* its error value is kept in the registry */
  bool asked;                     /* the progress function asked the call that runs to stop */
  bool echo;                      /* print warnings on standard error as they come */
  bw_progress_function *progress; /* what shows progress when the script sets no function */
  void *progress_data;
  bw_status last_failure; /* that lbw_leave told */
  size_t external;        /* bytes held by open boxes */
  size_t external_after;  /* the same after the last full collection */
} lbw_state;

/* Makes the state on first use. Raises when there is no memory. */
lbw_state *lbw_state_of(lua_State *L);

bw_context *lbw_enter(lua_State *L);
/* `results` values are on the top of the stack for a success. On failure they are dropped: misuse
 * (BW_INVALID, BW_EMPTY) raises, the rest returns nil, message, details. */
int lbw_leave(lua_State *L, bw_status status, int results);
/* The same where only success can be reported: every failure raises. */
void lbw_leave_or_raise(lua_State *L, bw_status status);

/* In a forked child: the engine is at rest, and progress goes to this function alone. */
void lbw_forked(lua_State *L, bw_progress_function *progress, void *data);
/* In a callback from the engine: the error value on the top of the stack is kept for lbw_leave,
 * which raises it, and the engine is asked to stop. */
void lbw_keep_error(lbw_state *state);

/* Call the Lua function at `function` with three coordinates and read one number, protected, for
 * callbacks from the engine. After a failure every call returns `otherwise`. */
double lbw_call_field(lbw_state *state, int function, const double at[3], double otherwise);

/* A field over space given by a Lua function of x, y, z, by a formula in them, or by a number. A
 * Lua function is called on one thread only: lbw_field_begin sets the context to one thread, and
 * lbw_field_end sets it back. Pass lbw_field_value and the field to the engine. */
typedef struct lbw_field lbw_field;
/* Reads the value at `index`, which must stay on the stack, into a userdata that is pushed. */
lbw_field *lbw_field_read(lua_State *L, int index, const char *what);
void lbw_field_begin(lbw_field *field, bw_context *context);
void lbw_field_end(lbw_field *field, bw_context *context);
double lbw_field_value(void *field, const double at[3]);

/* ---- guards (guard.c) ------------------------------------------------------------------------ */

/* An open guard stands around a script's function that may close what it likes. Between the two no
 * error may be raised. */
void lbw_guard_begin(lbw_state *state, lbw_guard *guard, bool open);
void lbw_guard_end(lbw_state *state, const lbw_guard *guard);
/* A bound function works on objects: nothing may be closed. */
bool lbw_busy(const lbw_state *state);
/* bw_release, once nothing is busy. */
void lbw_release_unused(lbw_state *state, const void *object);
/* Pushes the function so that it runs under a guard, and only with an open box of the class as its
 * first argument (NULL: with anything). */
void lbw_push_guarded(lua_State *L, lua_CFunction function, const lbw_class *class);
/* What the pushed function is in C; upvalues: the function, the class (light userdata) or nil. */
int lbw_guarded(lua_State *L);
/* Guards the plain functions of C in a table, in the tables in it, and in their metatables. */
void lbw_guard_functions(lua_State *L, int table);

/* ---- classes and boxes ----------------------------------------------------------------------- */

struct lbw_class {
  const char *name;           /* "mesh": also the name of the metatable, with "barwright." */
  const luaL_Reg *methods;    /* called with the box first */
  const luaL_Reg *properties; /* getters: one value from the box */
  const luaL_Reg *meta;       /* further metamethods; NULL: none */
  size_t (*bytes)(const void *object); /* what the box accounts for; NULL: bw_bytes */
};

typedef struct lbw_box {
  const lbw_class *class;
  const void *object;
  const void *extra; /* a second reference (the last system of a model), or NULL */
  size_t bytes;      /* accounted */
} lbw_box;

extern const char lbw_classes_key; /* registry: metatable -> class */

/* The module is on the top of the stack. The methods, properties and metamethods are called with an
 * open box of the class as their first argument, and under a guard. */
void lbw_class_register(lua_State *L, const lbw_class *class);
/* Further methods of a registered class, from another file; likewise. */
void lbw_add_methods(lua_State *L, const lbw_class *class, const luaL_Reg *methods);
/* Metamethods whose second argument may be the box. */
void lbw_add_operators(lua_State *L, const lbw_class *class, const luaL_Reg *operators);
/* The box at `index`, of whatever class, open or closed; NULL: there is none. */
lbw_box *lbw_any_box(lua_State *L, int index);
/* Pushes an empty box. */
lbw_box *lbw_box_new(lua_State *L, const lbw_class *class);
/* Takes over one reference and tells the collector the size. */
void lbw_box_fill(lua_State *L, lbw_box *box, const void *object);
/* Leaves with it, and the box on the top of the stack, as lbw_leave does. */
int lbw_leave_object(lua_State *L, lbw_box *box, const void *object, bw_status status);
/* lbw_box_fill, retaining. */
void lbw_push(lua_State *L, const lbw_class *class, const void *object);
/* Counts the box again after its object or extra grew. */
void lbw_box_account(lua_State *L, lbw_box *box);
void lbw_box_close(lua_State *L, lbw_box *box);

lbw_box *lbw_check_box(lua_State *L, int argument, const lbw_class *class);
const void *lbw_check(lua_State *L, int argument, const lbw_class *class);
/* NULL when the value is no open box of the class. */
const void *lbw_test(lua_State *L, int index, const lbw_class *class);
/* "mesh", "surface", ... or Lua's type name. */
const char *lbw_type_name(lua_State *L, int index);
/* What a message says was found: a number or boolean as it is, "string 'abc'", "array of 3 x 2",
 * else the class or type. Left on the stack. */
const char *lbw_got(lua_State *L, int index);
/* "12.35 mm", "3.448 MPa": a quantity in a SI unit as print shows it. */
typedef struct lbw_text {
  char text[56];
} lbw_text;
lbw_text lbw_quantity(double value, const char *unit);
/* The unit in which a value in a SI unit is shown; *scale: how large it is in that SI unit. */
const char *lbw_shown_unit(double value, const char *unit, double *scale);
/* Three numbers in a unit of this scale: "(1.5, 0, 30) m"; rounding beside the largest is 0. */
lbw_text lbw_triple(const double x[3], double scale, const char *unit);
/* "(1.5, 0, 30) mm" */
lbw_text lbw_point(const double at[3]);
/* "(0, 0, -1)" */
lbw_text lbw_direction(const double direction[3]);
/* Runs `compute` once per box and key; the value is kept with the box. Called from a property. */
int lbw_cached(lua_State *L, const char *key, lua_CFunction compute);

extern const lbw_class lbw_array_class, lbw_surface_class, lbw_mesh_class, lbw_selection_class,
    lbw_material_class, lbw_model_class, lbw_static_class, lbw_modes_class, lbw_system_class,
    lbw_weak_regions_class, lbw_pressure_basis_class, lbw_skeleton_class, lbw_subdomains_class,
    lbw_incremental_system_class, lbw_joined_incremental_class, lbw_live_server_class,
    lbw_outline_class, lbw_sheet_class, lbw_plane_mesh_class, lbw_mesh_motion_class, lbw_flow_class,
    lbw_plate_class, lbw_grid_class, lbw_embedding_class, lbw_job_class, lbw_canvas_class,
    lbw_database_class, lbw_lock_class, lbw_temporary_class, lbw_solver_class, lbw_lp_solver_class,
    lbw_eigensolver_class, lbw_sparse_matrix_class, lbw_operator_class, lbw_eigenpairs_class,
    lbw_heat_class, lbw_heat_solution_class, lbw_heat_transient_class, lbw_buckling_class,
    lbw_harmonic_class, lbw_response_spectrum_class, lbw_linear_transient_class, lbw_contact_class,
    lbw_contact_system_class, lbw_deposition_class, lbw_rigid_surface_class, lbw_drop_class,
    lbw_nonlinear_class;

/* ---- misuse ---------------------------------------------------------------------------------- */

/* Raise an error at the line of the script that is to blame, past the library's own Lua files: used
 * instead of luaL_error, luaL_argerror, luaL_checkinteger and the like. */
int lbw_error(lua_State *L, const char *format, ...);
int lbw_argument_error(lua_State *L, int argument, const char *text);
/* That an object of the class is expected; where a method was called without a colon, so. */
int lbw_class_error(lua_State *L, int argument, const lbw_class *class);
/* "a mesh", "an array", "weak regions"; pushed. */
const char *lbw_spoken(lua_State *L, const char *name);
/* Raises unless the argument `what` has as many rows as there are of `each`. */
void lbw_check_rows(lua_State *L, int argument, const char *what, int64_t rows, int64_t expected,
                    const char *each);
/* The same of what no argument holds alone; `what` names the function as well. */
void lbw_require_rows(lua_State *L, const char *what, int64_t rows, int64_t expected,
                      const char *each);
/* As lbw_argument_error, with what was found where the text ends with "expected". */
int lbw_argument_refused(lua_State *L, int argument, const char *text);
#define lbw_argument_check(L, condition, argument, text)                                           \
  ((void)((condition) || lbw_argument_refused(L, argument, text)))
void lbw_check_type(lua_State *L, int argument, int type);
const char *lbw_check_text(lua_State *L, int argument, size_t *length); /* length: may be NULL */
lua_Integer lbw_check_integer(lua_State *L, int argument);
lua_Integer lbw_integer_or(lua_State *L, int argument, lua_Integer otherwise);
double lbw_check_number(lua_State *L, int argument);
double lbw_number_or(lua_State *L, int argument, double otherwise);
/* The place of a word in a list that ends with NULL; nil: the first. */
int lbw_check_word(lua_State *L, int argument, const char *const words[]);

/* ---- arguments ------------------------------------------------------------------------------- */

/* {x, y, z}, or an array of three numbers. `what` names the argument in the message. */
void lbw_check_vector(lua_State *L, int argument, const char *what, double vector[3]);
/* {x, y} at `index`; raises with `what`. */
void lbw_check_pair(lua_State *L, int index, const char *what, double pair[2]);
bool lbw_to_vector(lua_State *L, int index, double vector[3]);
void lbw_push_vector(lua_State *L, const double vector[3]);
/* Pops a text: `print` shows it of the table below. */
void lbw_prints(lua_State *L);
double lbw_check_real(lua_State *L, int argument, const char *what);
/* From 1 in Lua to 0 here, checked against `count`. */
int64_t lbw_check_index(lua_State *L, int argument, const char *what, int64_t count);
/* The text at `index` as a name; raises where it is none or too long. */
void lbw_read_name(lua_State *L, int index, const char *what, bw_name *name);
/* 1..3 or "x", "y", "z" -> 0..2 */
int lbw_check_axis(lua_State *L, int argument);
/* A bone or a joint by name, or by number from 1. */
int32_t lbw_check_bone(lua_State *L, int argument, const bw_skeleton *skeleton);
int32_t lbw_check_joint(lua_State *L, int argument, const bw_skeleton *skeleton);
/* A row of 19 numbers for every subdomain (see pose.c), as structs in a userdata that is pushed. */
bw_subdomain_motion *lbw_read_motion(lua_State *L, int argument, int32_t count);
/* options.guess, a list of fields on a mesh of `nodes` nodes; they stay on the stack. */
void lbw_read_guess(lua_State *L, int index, const char *function, int64_t nodes,
                    bw_incremental_options *options);
/* Nine numbers in three rows, or flat. */
void lbw_check_matrix(lua_State *L, int argument, const char *what, int rows, int columns,
                      double *matrix);

/* Metres per unit from the option "unit" of the table at `options`: a name or a number. */
double lbw_unit_option(lua_State *L, int options, const char *function, double otherwise);
/* 1 for mesh files (metres), 0.001 for surface files: what a path's ending stands for. */
double lbw_unit_of_path(const char *path);

/* The table {moved = , steps = {...}} */
void lbw_push_shape_log(lua_State *L, const bw_shape_log *log);
/* {min = , max = , size = } */
void lbw_push_box(lua_State *L, const double min[3], const double max[3]);
/* "0.123 x 0.1 x 0.04 m from (0, 0, 0)" in a unit that reads well, onto the stack. */
void lbw_push_box_text(lua_State *L, const double min[3], const double max[3]);

/* Reads the table of named arrays at `index` (nil: none) into a list of fields in a userdata that
 * is pushed; places by numbers of rows. Arrays are packed doubles or int32 as they are. */
bw_field *lbw_fields(lua_State *L, int index, const char *function, int64_t nodes, int64_t elements,
                     int *count);

typedef enum lbw_option_type {
  LBW_BOOLEAN,
  LBW_REAL,   /* double */
  LBW_INT,    /* int */
  LBW_COUNT,  /* int64_t */
  LBW_SEED,   /* uint64_t */
  LBW_VECTOR, /* double[3] */
  LBW_OTHER   /* known, read by the caller */
} lbw_option_type;
typedef struct lbw_option {
  const char *key;
  lbw_option_type type;
  size_t offset;
} lbw_option;
/* Reads the table at `index` (nil and none: nothing) into a struct. Unknown keys raise and name
 * the known one that they resemble, or all; of several the first in the alphabet, of several wrong
 * values the first in the list, in every run. The list ends with a NULL key. */
void lbw_options(lua_State *L, int index, const char *function, const lbw_option *options,
                 void *into);
/* Pushes options[key], or nil when there is no table; returns its type. */
int lbw_option_get(lua_State *L, int index, const char *key);
/* The place of a word of a list that ends with NULL. */
int lbw_word_option(lua_State *L, int index, const char *function, const char *key,
                    const char *const words[], int otherwise);
/* The option is missing; `why` ends the sentence and may be "". */
int lbw_option_missing(lua_State *L, const char *function, const char *key, const char *why);
/* An option with what was found, which is on the top of the stack: "a string" expected. */
int lbw_option_refused(lua_State *L, const char *function, const char *key, const char *expected);

/* Adds lines of what the joints of a static solution do. */
void lbw_add_joints(lua_State *L, luaL_Buffer *out, const bw_static *result);
/* Pushes a table of what a report says; fields that do not apply are left out. */
void lbw_push_report(lua_State *L, const bw_solver_report *report);
/* Whether there was a solution to report. */
bool lbw_has_report(const bw_solver_report *report);

/* An option that is an object of the class: NULL where it is left out or "auto". It stays with the
 * table. */
const void *lbw_object_option(lua_State *L, int index, const char *function, const char *key,
                              const lbw_class *class, const char *expected);
#define LBW_SOLVER_EXPECTED "a solver of bw.solver, or \"auto\""
/* The message for a figure that comes from one mesh without an estimate. */
#define LBW_ERROR_UNKNOWN "error unknown: one mesh"
/* The option "solver", an eigensolver in the second, and the option "lp", read so. */
const bw_solver *lbw_solver_option(lua_State *L, int index, const char *function);
const bw_eigensolver *lbw_eigensolver_option(lua_State *L, int index, const char *function);
const bw_lp_solver *lbw_lp_option(lua_State *L, int index, const char *function);
/* The option "damping"; what a model does not serve, the engine refuses. With a mesh its loss may
 * be a table by regions, *region_loss, whose memory is pushed; else something else is. */
void lbw_damping_option(lua_State *L, int index, const char *function, bw_damping *damping,
                        const bw_mesh *mesh, const double **region_loss);
/* Whether it works on the processes of barwright.distributed. */
bool lbw_solver_is_external(const bw_solver *solver);

/* The candidate that a word may have been meant for; NULL where none resembles it. */
const char *lbw_nearest(const char *word, const char *const *candidate, size_t count);
/* The rest of a sentence that says that there is no such name: "did you mean 'steel'?", or which
 * names are known. It is pushed. */
const char *lbw_suggestion(lua_State *L, const char *word, const char *const *candidate,
                           size_t count);

/* ---- arrays ---------------------------------------------------------------------------------- */

const bw_array *lbw_check_array(lua_State *L, int argument, const char *what);
/* A view on memory of an engine object. */
int lbw_push_borrowed(lua_State *L, bw_type type, int64_t rows, int64_t columns, const void *data,
                      const void *owner);
/* A new array of zeros; its data for filling. Raises when there is no memory. */
bw_array *lbw_push_array(lua_State *L, bw_type type, int64_t rows, int64_t columns);
/* Numbers that count from 0 as an array that counts from 1 (negative: 0). */
int lbw_push_indices(lua_State *L, int64_t rows, int64_t columns, const int32_t *index);
/* A packed block of doubles (or int32 counted from 0) from an array or a table of rows, in a
 * userdata that is pushed. `columns` 0: any. */
double *lbw_to_doubles(lua_State *L, int index, const char *what, int64_t columns, int64_t *rows);
/* Rows of two numbers, at most a million: the first column, and `count` numbers behind it the
 * second, in a userdata that is pushed. */
const double *lbw_to_points(lua_State *L, int index, const char *what, int64_t *count);
/* The life curve of a table. */
void lbw_check_life_curve(lua_State *L, int index, bw_life_curve *curve);
int32_t *lbw_to_indices(lua_State *L, int index, const char *what, int64_t columns, int64_t *rows);
/* The same as they are, one for each of `rows` elements. */
int32_t *lbw_to_tags(lua_State *L, int index, const char *what, int64_t rows);
/* contact.c: the pairs of the list at `index`, in a userdata that is pushed. */
bw_contact_pair *lbw_contact_pairs(lua_State *L, int index, const char *where, int *count);
/* A mask of `count` bytes from an array, in a userdata that is pushed. */
uint8_t *lbw_to_mask(lua_State *L, int index, const char *what, int64_t count);

/* The surface of a body, and the node of every point, counted from 1: two results of a method, made
 * by a function that gives a new surface and a list to be released with bw_free. */
typedef bw_status lbw_boundary(bw_context *context, const void *body, bw_surface **surface,
                               int32_t **node);
int lbw_push_boundary(lua_State *L, const void *body, lbw_boundary *boundary);

/* face_names.c: surface:named(name, face), surface:face_names(), surface:curved_faces(),
 * mesh:face_names(), polygon_triangles{...}, and a list of names in a userdata that is pushed. */
int lbw_surface_named(lua_State *L);
int lbw_surface_face_names(lua_State *L);
int lbw_surface_curved_faces(lua_State *L);
int lbw_mesh_face_names(lua_State *L);
int lbw_polygon_triangles(lua_State *L);
bw_name *lbw_to_names(lua_State *L, int index, const char *what, int32_t *count);
/* Gives the surface of a box faces by the second results of the function at `function`, called with
 * the middle of each facet: names, or nil for none. */
void lbw_name_facets(lua_State *L, int function, lbw_box *box);
/* faces.c: surface:faces{angle}, selection:face(which), mesh:curved(surface), mesh:faces(surface),
 * and the text on the top of the stack with a line for each of the largest faces behind it. */
int lbw_surface_faces(lua_State *L);
int lbw_selection_face(lua_State *L);
int lbw_mesh_curved(lua_State *L);
int lbw_mesh_faces(lua_State *L);
int lbw_face_labels(lua_State *L);
void lbw_add_faces(lua_State *L, const bw_surface *surface);

/* cad.c: surface.read of a STEP or IGES file. */
int lbw_cad_read(lua_State *L, const char *path, const bw_cad_options *options);

/* mesh_regions.c: mesh.regions, mesh.element_regions, mesh:region(name),
 * mesh:with_regions(tags, names), mesh:split(where, name), mesh:interface(a, b). */
int lbw_mesh_regions(lua_State *L);
int lbw_mesh_element_regions(lua_State *L);
int lbw_mesh_region(lua_State *L);
int lbw_mesh_with_regions(lua_State *L);
int lbw_mesh_split(lua_State *L);
int lbw_mesh_interface(lua_State *L);
int lbw_mesh_overlaps(lua_State *L);
int lbw_mesh_separated(lua_State *L);
/* The region that the argument names; raises where there is none. */
int32_t lbw_check_region(lua_State *L, int argument, const bw_mesh *mesh);
/* The options mesh, and material or materials, of the table at index 1. They stay on the stack. */
const bw_mesh *lbw_check_body(lua_State *L, const char *function, const bw_material **material);
/* Names by tag, {[tag] = name}, into a userdata that is pushed; *count: how many. */
bw_mesh_region *lbw_read_region_names(lua_State *L, int index, const char *what, int32_t *count);
/* ", regions 'shell', 'core'", or "": pushed. */
const char *lbw_region_text(lua_State *L, const bw_mesh *mesh);

/* {size, elements, ...} at `index`. `field` is pushed: NULL (and nil), or what to begin and end
 * around the call. */
void lbw_read_plane_options(lua_State *L, int index, const char *function,
                            bw_plane_options *options, lbw_field **field);
/* {worst = , worst_element = , mean = , ...} */
void lbw_push_plane_quality(lua_State *L, const bw_plane_mesh *mesh);

/* ---- the parts ------------------------------------------------------------------------------- */

/* Each adds its functions to the table on the top of the stack. */
void lbw_open_classes(lua_State *L);
void lbw_open_raise(lua_State *L);
void lbw_open_quantity(lua_State *L);
void lbw_open_suggestions(lua_State *L);
void lbw_open_array(lua_State *L);
void lbw_open_surface(lua_State *L);
void lbw_open_thickness(lua_State *L);
void lbw_open_confine(lua_State *L);
void lbw_open_mesh(lua_State *L);
void lbw_open_selection(lua_State *L);
void lbw_open_material(lua_State *L);
void lbw_open_report(lua_State *L);
void lbw_open_solver(lua_State *L);
void lbw_open_lp(lua_State *L);
void lbw_open_eigensolver(lua_State *L);
void lbw_open_model(lua_State *L);
void lbw_open_solve(lua_State *L);
void lbw_open_sparse_matrix(lua_State *L);
void lbw_open_operator(lua_State *L);
void lbw_open_worst(lua_State *L);
void lbw_open_worst_loads(lua_State *L);
void lbw_open_patch_gradient(lua_State *L);
void lbw_open_picture(lua_State *L);
void lbw_open_canvas(lua_State *L);
void lbw_open_skeleton(lua_State *L);
void lbw_open_subdomains(lua_State *L);
void lbw_open_pose(lua_State *L);
void lbw_open_repair(lua_State *L);
void lbw_open_refine(lua_State *L);
void lbw_open_buckling(lua_State *L);
void lbw_open_nonlinear(lua_State *L);
void lbw_open_deposition(lua_State *L);
void lbw_open_harmonic(lua_State *L);
void lbw_open_response_spectrum(lua_State *L);
void lbw_open_contact(lua_State *L);
void lbw_open_contact_system(lua_State *L);
void lbw_open_drop(lua_State *L);
void lbw_open_fatigue(lua_State *L);
void lbw_open_singular(lua_State *L);
void lbw_open_incremental(lua_State *L);
void lbw_open_optimise(lua_State *L);
void lbw_open_live(lua_State *L);
void lbw_open_outline(lua_State *L);
void lbw_open_follow(lua_State *L);
void lbw_open_sheet(lua_State *L);
void lbw_open_plane(lua_State *L);
void lbw_open_mesh_motion(lua_State *L);
void lbw_open_flow(lua_State *L);
void lbw_open_heat(lua_State *L);
void lbw_open_linear_transient(lua_State *L);
void lbw_open_plate(lua_State *L);
void lbw_open_solid_material(lua_State *L);
void lbw_open_solid(lua_State *L);
void lbw_open_transient(lua_State *L);
void lbw_open_library(lua_State *L);
void lbw_open_grid(lua_State *L);
void lbw_open_job(lua_State *L);
void lbw_open_database(lua_State *L);
void lbw_open_sobol(lua_State *L);
void lbw_open_minimise(lua_State *L);
void lbw_open_files(lua_State *L);

int luaopen_barwright_core(lua_State *L);

#endif
