/* nonlinear: hyperelastic solids on hexahedral grids: laws, energies, statics, dynamics. */
#ifndef BARWRIGHT_NONLINEAR_H
#define BARWRIGHT_NONLINEAR_H

#include "barwright/assemble.h"
#include "barwright/grid.h"
#include "barwright/linear.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- laws ---------------------------------------------------------------------------------------
 *
 * Every law is linear in Lame's constants: W(F) = mu a(F) + lambda b(F), J/m3, which makes fitting
 * them a linear problem. F is row by row, F_ij = d x_i / d X_j; stress P_ij = dW / dF_ij (first
 * Piola-Kirchhoff); tangent A_(ij)(kl) = dP_ij / dF_kl, 9x9, row by row.
 *
 *   neo-Hookean          a = (I1 - 3)/2 - ln J      b = (ln J)^2 / 2     only J > 0
 *   St. Venant-Kirchhoff a = E : E                  b = (tr E)^2 / 2     E = (F^T F - 1)/2
 *   corotated            a = |F - R|^2              b = (tr(R^T F) - 3)^2 / 2
 *   fixed corotated      a = |F - R|^2              b = (J - 1)^2 / 2 */

/* A law of the list above. */
typedef enum bw_law {
  BW_NEO_HOOKEAN,         /* neo-Hookean */
  BW_ST_VENANT_KIRCHHOFF, /* St. Venant-Kirchhoff */
  BW_COROTATED,           /* corotated */
  BW_FIXED_COROTATED,     /* fixed corotated */
  BW_LAWS                 /* how many there are */
} bw_law;
BW_API const char *bw_law_word(bw_law law); /* "neo_hookean", ... */

/* A law with mu and lambda (Pa) at F, f (-): *energy (J/m3), stress (Pa, 9) and tangent (Pa, 9 x
 * 9), which may be NULL. `project`: the tangent with negative eigenvalues set to zero. False where
 * the law is not defined (neo-Hookean at J <= 0); the outputs are then not to be used. */
BW_API bool bw_law_evaluate(bw_law law, double mu, double lambda, const double f[9], bool project,
                            double *energy, double *stress, double *tangent);
/* The anisotropic term C (|F v| - 1)^2 of data-driven, formula (2), with C the stiffness (Pa) and a
 * unit vector v (-) at F, f (-): added to *energy (J/m3), stress (Pa, 9) and tangent (Pa, 9 x 9),
 * which may be NULL; `project` as above. */
BW_API void bw_fibre_add(double stiffness, const double v[3], const double f[9], bool project,
                         double *energy, double *stress, double *tangent);
/* F = U diag(s) V^T for f (any): rotations u and v (-), s (any) descending in size, its last with
 * the sign of det F. */
BW_API void bw_svd3(const double f[9], double u[9], double s[3], double v[9]);

/* ---- materials of elements ------------------------------------------------------------------- */

/* Points of quadrature in the unit cube. Level 0 and 1: 2 x 2 x 2 Gauss points, point k in octant
 * k (bits as corners). Level l: such points in each of the 8^(l-1) small cubes; those of octant k
 * are from 8^(l-1) k on, in the order of the level below. One object per level and process lifetime
 * is not promised: compare `level`. */
typedef struct bw_rule {
  bw_object object;
  int level; /* as above */
  int32_t count;
  double spread[3]; /* (-) 1: as above. Less: the points are nearer to the middle of the cell by
                       this factor, direction by direction, as fitted materials have them: a coarse
                       cell then resists bending less than stretching */
  double *at;       /* (-, count x 3) in the unit cube */
  double *weight;   /* (-, count) summing to one */
  double *value;    /* (-, count x 8) shape functions of the corners */
  double *gradient; /* (-, count x 8 x 3) in the unit cube */
} bw_rule;
/* The rule of a `level`. */
BW_API bw_status bw_rule_create(bw_context *context, int level, bw_rule **rule);
/* The rule of a `level` with a spread (-) above 0, to 1. */
BW_API bw_status bw_rule_create_spread(bw_context *context, int level, const double spread[3],
                                       bw_rule **rule);
/* Points 0 to 7 as of level 0, and as many in the middle of the cell: selective reduced integration
 * (bw_solid_material_b_bar). */
BW_API bw_status bw_rule_create_selective(bw_context *context, bw_rule **rule);

/* What an element is made of: a law and constants at every point of its rule: the metamaterial of
 * data-driven, formula (2), of which one law and the same constants everywhere is the simple case.
 * Energy of a cell of volume V: V sum over points of weight (mu a + lambda b + sum over fibres of
 * C (|F v| - 1)^2). Does not change once made. */
typedef struct bw_solid_material {
  bw_object object;
  char name[BW_NAME];      /* for messages */
  const bw_rule *rule;     /* retained */
  double density;          /* (kg/m3) 0: not known */
  bool uniform;            /* the same law and constants at all points, and no fibres */
  bool b_bar;              /* made by bw_solid_material_b_bar */
  int fibre_count;         /* at a point: 0 to 3 */
  uint8_t *law;            /* (rule->count) bw_law */
  double *mu, *lambda;     /* (Pa, rule->count) */
  double *fibre_stiffness; /* (Pa, rule->count x fibre_count) C */
  double *fibre;           /* (-, rule->count x fibre_count x 3) v */
  /* (rule->count) Points that stand for void in a coarse cell (St. Venant-Kirchhoff, mu below 1/500
   * of the largest): they only keep the cell's nodes in place, and may invert without the cell
   * counting as inverted. NULL: there are none. */
  uint8_t *empty;
} bw_solid_material;
/* A uniform material of level 0 with young (Pa) > 0, -1 < poisson < 1/2; density may be 0. The name
 * is copied. */
BW_API bw_status bw_solid_material_create(bw_context *context, const char *name, bw_law law,
                                          double young, double poisson, double density,
                                          bw_solid_material **material);
/* The same with young (Pa) and poisson for elements with B-bar, which do not lock where poisson is
 * near 1/2. The terms with lambda are evaluated in the middle of the cell, where the volumetric
 * strain of small deformations has its mean (docs/theory/elements.md). For poisson <= 0, where
 * nothing locks, the standard one. */
BW_API bw_status bw_solid_material_b_bar(bw_context *context, const char *name, bw_law law,
                                         double young, double poisson, double density,
                                         bw_solid_material **material);
/* Lame's constants *mu (Pa) and *lambda (Pa) of the law at the first point. */
BW_API void bw_solid_material_constants(const bw_solid_material *material, double *mu,
                                        double *lambda);
/* A material of a rule: law (rule->count), mu and lambda (Pa, rule->count), and for 0 to 3 fibres
 * at a point fibre_stiffness (Pa, rule->count x fibre_count) and fibre (-, rule->count x
 * fibre_count x 3), unit vectors; these may be NULL when fibre_count is 0. BW_INVALID for constants
 * that are not finite, mu < 0 and 3 lambda + 2 mu < 0. */
BW_API bw_status bw_solid_material_points(bw_context *context, const char *name,
                                          const bw_rule *rule, double density, const uint8_t *law,
                                          const double *mu, const double *lambda, int fibre_count,
                                          const double *fibre_stiffness, const double *fibre,
                                          bw_solid_material **material);
/* The materials that a grid's numbers mean: material[0] is NULL, void. */
typedef struct bw_material_table {
  bw_object object;
  int32_t count;
  const bw_solid_material **material; /* count of them, retained */
} bw_material_table;
/* A table of `count` numbers, void included: `material` has count - 1 entries, those of 1 and
 * above. */
BW_API bw_status bw_material_table_create(bw_context *context, int32_t count,
                                          const bw_solid_material *const *material,
                                          bw_material_table **material_table);

/* ---- solids ---------------------------------------------------------------------------------- */

struct bwi_contributions;
/* A grid made of a material table: the body whose energy is a function of node displacements u
 * (node_count x 3, m). Partial cells count by their fraction, never below 1e-3. Does not change
 * once built; may be used from several threads. */
typedef struct bw_solid {
  bw_object object;
  const bw_grid *grid;                     /* retained */
  const bw_material_table *material_table; /* retained */
  bw_block_pattern *pattern;               /* retained; its mesh is NULL */
  struct bwi_contributions *contributions; /* retained: which elements are in which block */
  double *mass;                            /* (kg, node_count) lumped; density 0 counts as 0 */
  bool weightless;                         /* some element's density is not known */
} bw_solid;
/* A solid of a grid. `previous` (may be NULL): one whose pattern is reused where the elements are
 * the same. BW_INVALID names the first element whose material is not in the material table. */
BW_API bw_status bw_solid_create(bw_context *context, const bw_grid *grid,
                                 const bw_material_table *material_table, const bw_solid *previous,
                                 bw_solid **solid);

/* How bad a shape is. */
typedef struct bw_solid_shape {
  double min_ratio; /* (-) smallest det F over all points */
  int32_t worst;    /* (index) its element */
  int64_t inverted; /* elements with a point where det F <= 0 */
  bool defined;     /* the energy exists: no neo-Hookean point has det F <= 0 */
} bw_solid_shape;
/* At displacements u (m, node_count x 3): *energy (J), its gradient (N, node_count x 3), and its
 * second derivatives, stiffness (N/m, pattern->block_count x 9); each of the three may be NULL.
 * With `project` each point's tangent is made positive semidefinite, so that the matrix is. BW_OK
 * with shape->defined false (and nothing else to be used) where the energy does not exist: for line
 * searches. Same bits for any number of threads. */
BW_API bw_status bw_solid_evaluate(bw_context *context, const bw_solid *solid, const double *u,
                                   bool project, double *energy, double *gradient,
                                   double *stiffness, bw_solid_shape *shape);
/* A static sentence that warns of volumetric locking and names the cure, or NULL: elements of a
 * uniform material with a Poisson's ratio above 0.48 in the standard formulation. */
BW_API const char *bw_solid_locking(const bw_solid *solid);
/* Element stiffnesses kept for products without a matrix: 300 numbers an element, and 24 of
 * workspace, so that one product runs at a time. bw_solid_linear_destroy releases it. */
typedef struct bw_solid_linear bw_solid_linear;
/* Retains the solid; to be set before use. */
BW_API bw_status bw_solid_linear_create(bw_context *context, const bw_solid *solid,
                                        bw_solid_linear **linear);
BW_API void bw_solid_linear_destroy(bw_solid_linear *linear);
/* The stiffnesses at u (m, node_count x 3), with `project` as in bw_solid_evaluate. BW_GEOMETRY
 * where the energy does not exist. */
BW_API bw_status bw_solid_linear_set(bw_context *context, bw_solid_linear *linear, const double *u,
                                     bool project);
/* y = K x for x and y (any, node_count x 3). */
BW_API bw_status bw_solid_linear_multiply(bw_context *context, const bw_solid_linear *linear,
                                          const double *x, double *y);
/* The diagonal blocks (N/m, node_count x 9) of K. */
BW_API bw_status bw_solid_linear_diagonal(bw_context *context, const bw_solid_linear *linear,
                                          double *blocks);
/* Cauchy stress at u (m, node_count x 3): of_elements (Pa, element_count x 6), means over the
 * deformed volume, and of_nodes (Pa, node_count x 6), means of the elements around by their volume
 * at rest; either may be NULL. BW_GEOMETRY names an element whose energy does not exist. */
BW_API bw_status bw_solid_stress(bw_context *context, const bw_solid *solid, const double *u,
                                 double *of_elements, double *of_nodes);

/* ---- what acts on a solid -------------------------------------------------------------------- */

/* A pressure on triangles; the load case owns the lists. */
typedef struct bw_pressure_patch {
  const bw_embedding *embedding; /* retained */
  int64_t triangle_count;
  int32_t *triangle; /* (index, triangle_count x 3) points of the embedding, counter-clockwise from
                      outside */
  double *pressure;  /* (Pa, triangle_count) positive pushes inwards */
  bool follower;     /* along the normals of the deformed shape; else of the shape at rest */
} bw_pressure_patch;
/* A rigid plane without friction; the load case owns the list. */
typedef struct bw_contact_plane {
  double point[3], normal[3];    /* the solid stays where (x - point) . normal >= 0; normal unit */
  double move[3];                /* (m) the plane's displacement at load factor 1 */
  const bw_embedding *embedding; /* retained: the points that touch it, with `rest` positions;
                                    NULL: the nodes */
  double *rest;                  /* (m, point_count x 3) or NULL */
} bw_contact_plane;
/* Supports, loads and contact planes, added call by call; then used, and not changed meanwhile.
 * A case serves solids on its grid or on one with the same elements at the same places, and so do
 * embeddings it is given: BW_INVALID otherwise, and for nodes or numbers out of range. Loads,
 * prescribed displacements and gravity grow with the load factor 0..1. */
typedef struct bw_load_case {
  bw_object object;
  const bw_grid *grid;  /* retained */
  uint8_t *constrained; /* (node_count x 3) whether the component is prescribed */
  double *value;        /* (m, node_count x 3) prescribed displacement at load factor 1 */
  double *force;        /* (N, node_count x 3) at load factor 1 */
  double gravity[3];    /* (m/s2) at load factor 1 */
  int32_t patch_count;
  bw_pressure_patch *patch; /* patch_count of them */
  int32_t contact_plane_count;
  bw_contact_plane *contact_plane; /* contact_plane_count of them */
} bw_load_case;
/* A case without supports and loads. */
BW_API bw_status bw_load_case_create(bw_context *context, const bw_grid *grid, bw_load_case **it);
/* Prescribes displacements of value (m) in the components with fixed[c] of nodes, node (index,
 * count). A contradiction with an earlier call is BW_INVALID and names the node; BW_EMPTY without
 * nodes or components. */
BW_API bw_status bw_load_case_fix(bw_context *context, bw_load_case *it, int64_t count,
                                  const int32_t *node, const bool fixed[3], const double value[3]);
/* Adds a total (N) force on the boundary faces all of whose nodes are among node (index, count), by
 * area; where there is no such face, in equal parts on the nodes. BW_EMPTY without nodes. */
BW_API bw_status bw_load_case_force(bw_context *context, bw_load_case *it, int64_t count,
                                    const int32_t *node, const double total[3]);
/* Adds gravity (m/s2). */
BW_API bw_status bw_load_case_gravity(bw_context *context, bw_load_case *it,
                                      const double gravity[3]);
/* Adds pressure (Pa, triangles) on triangle (index, triangles x 3) of points of the embedding,
 * which is of the case's grid; arrays are copied. `follower`: along the normals of the deformed
 * shape, else those at rest. BW_EMPTY without triangles. */
BW_API bw_status bw_load_case_pressure(bw_context *context, bw_load_case *it,
                                       const bw_embedding *embedding, int64_t triangles,
                                       const int32_t *triangle, const double *pressure,
                                       bool follower);
/* The same on the free faces all of whose nodes are among node (index, count): exact for faces that
 * bend, a quarter of it at each node of a plane one. The pressure is factor (Pa, or (-) with a
 * function) times pressure(data, middle of a face at rest), or `factor` where that is NULL;
 * `follower` as above. BW_EMPTY without a face. */
BW_API bw_status bw_load_case_surface_pressure(bw_context *context, bw_load_case *it, int64_t count,
                                               const int32_t *node,
                                               double (*pressure)(void *data, const double at[3]),
                                               void *data, double factor, bool follower);
/* Adds a plane that the solid does not penetrate, without adhesion and friction. The plane moves by
 * move (m) at load factor 1. Points of the embedding, with rest (m, point_count x 3), touch it;
 * NULL: nodes. Those whose nodes are all prescribed along the normal are left out. `rest` is
 * copied. */
BW_API bw_status bw_load_case_contact_plane(bw_context *context, bw_load_case *it,
                                            const double point[3], const double normal[3],
                                            const double move[3], const bw_embedding *embedding,
                                            const double *rest);

/* ---- statics --------------------------------------------------------------------------------- */

/* How Newton's method proceeds; all pointers are borrowed. */
typedef struct bw_newton_options {
  /* Of the linear equations of an iteration. BW_SOLVER_CHOLESKY: the engine's own factor in double
     precision, order and analysis kept. BW_SOLVER_PCG without a matrix: with BW_SOLVER_JACOBI, or
     with BW_SOLVER_TWO_LEVEL, a smoother and a coarse solid's factor; its tolerance by default by
     Eisenstat and Walker, its iterations at most 10000. Default NULL: with coarse solids
     BW_SOLVER_TWO_LEVEL, up to 20000 nodes only as long as that costs less than factors, by counted
     operations and bytes, and by the iterations that were needed so far; else the factor */
  const bw_solver *solver;
  double tolerance;    /* (-) |residual| over the norms of applied forces, reactions and pushes of
                          contact planes, added up; default 1e-6, above 0, below 1 */
  int iterations;      /* Newton iterations in a load step; default 100, 1 or more */
  int max_iterations;  /* 0 or more, in all load steps, failed ones included, where every 100 of
                           conjugate gradients count as one more; default 0: 500, and 20 more for
                           each load step to begin with beyond the first */
  int steps;           /* to begin with; default 1, 1 or more; made smaller where one fails */
  double min_step;     /* (-) smallest step of the load factor; default 1/256, above 0, to 1 */
  bool allow_inverted; /* a solution with inverted elements is a result, not BW_GEOMETRY; default
                          false */
  const double *start; /* (m, node_count x 3) initial guess; NULL: rest. From a guess, loads act in
                          full, and the residual there is reduced with the load factor */
  /* for BW_SOLVER_TWO_LEVEL: coarsening[0] is of the solid's grid, coarse[0] a solid on its coarse
     grid; coarsening[1] of that grid, and on. The last coarse solid's tangent is factored */
  int coarse_count;
  const bw_coarsening *const *coarsening;
  const bw_solid *const *coarse; /* coarse_count of each */
} bw_newton_options;
BW_API void bw_newton_options_default(bw_newton_options *options);

/* One Newton iteration, for reports and convergence plots. */
typedef struct bw_newton_entry {
  double load;      /* (-) load factor */
  double energy;    /* (J) total potential */
  double residual;  /* (-) relative residual before it */
  double step;      /* (-) accepted step length */
  int32_t cg;       /* iterations of conjugate gradients */
  int32_t contacts; /* points on contact planes */
  bool projected;   /* the tangent was made positive definite */
} bw_newton_entry;
/* What Newton's method did. */
typedef struct bw_newton_report {
  int iterations, load_steps, failed_steps, factorisations, evaluations; /* how many */
  int analyses; /* orders and analyses for a factor; 0 where those of an earlier solve were kept */
  int64_t cg_iterations;        /* of conjugate gradients in all */
  int64_t stability_iterations; /* of conjugate gradients that test stability */
  int undecided;   /* load steps after which these ended without an answer: the equilibrium may be
                      unstable; a warning says so too */
  double load;     /* (-) load factor reached: 1, or less where it failed */
  double residual; /* (-) relative, as reached */
  double seconds_quadrature, seconds_analysis, seconds_factor, seconds_solve, seconds; /* (s) */
  bw_solid_shape shape; /* of the solution */
  int64_t contacts;     /* points on contact planes */
  int history_count;
  bw_newton_entry *history; /* history_count entries; owned by the object that has the report */
} bw_newton_report;

/* What can be kept between solves of solids with the same elements: order, analysis, memory. An
 * object; mutable, one thread at a time. */
typedef struct bw_newton bw_newton;
/* Nothing kept yet. */
BW_API bw_status bw_newton_create(bw_context *context, bw_newton **newton);

/* An equilibrium of a solid. */
typedef struct bw_solid_static {
  bw_object object;
  const bw_solid *solid;         /* retained */
  const bw_load_case *load_case; /* retained */
  double *displacement;          /* (m, node_count x 3) */
  double *reaction;              /* (N, node_count x 3) of supports and contact planes */
  double energy;                 /* (J) stored */
  bool complete;                 /* load factor 1 was reached within tolerance */
  bw_newton_report newton;       /* how it was found */
  bw_solver_report report;       /* how the linear equations were solved */
} bw_solid_static;
/* The stable equilibrium that the load path from rest leads to: Newton's method on the total
 * potential with line search. Where the tangent is not positive definite, one that is made so
 * replaces it. An unstable equilibrium is not accepted. BW_UNCONSTRAINED for a solid with
 * rigid-body modes, also those that contact planes alone do not prevent. BW_CONVERGENCE, and
 * BW_GEOMETRY for inverted elements, name load factor, residual, worst element and its place, and
 * still give the last converged state in *result (complete = false), as BW_UNCONSTRAINED does where
 * a mode appears at a later load step. `newton` and `options` may be NULL. */
BW_API bw_status bw_solid_statics(bw_context *context, const bw_solid *solid,
                                  const bw_load_case *load_case, bw_newton *newton,
                                  const bw_newton_options *options, bw_solid_static **result);

/* A few Newton steps from options->start, which is needed, at full load: options->iterations of
 * them with as many of conjugate gradients each as options->solver, which is needed too, has in
 * max_iterations. They do not reach an equilibrium,
 * but show where and about how far away it is; each lowers the potential. *defined false: there is
 * no energy at the start, and displacement (m, node_count x 3) is not written. */
BW_API bw_status bw_solid_correct(bw_context *context, const bw_solid *solid,
                                  const bw_load_case *load_case, const bw_newton_options *options,
                                  double *displacement, bool *defined);

/* ---- dynamics -------------------------------------------------------------------------------- */

/* The integrator of a motion. */
typedef enum bw_transient_scheme {
  BW_IMPLICIT_EULER, /* first order, with numerical damping */
  BW_NEWMARK         /* second order */
} bw_transient_scheme;
/* How a motion is integrated. */
typedef struct bw_transient_options {
  bw_transient_scheme scheme; /* default BW_IMPLICIT_EULER */
  double step;                /* (s) default 0.01, > 0 */
  double mass_damping;        /* (1/s) Rayleigh; default 0, 0 or more */
  double stiffness_damping;   /* (s) Rayleigh, of the stiffness at the step's start; default 0, 0 or
                                 more */
  double beta;                /* (-) Newmark; default 1/4, gamma / 2 to 2 */
  double gamma;               /* (-) Newmark; default 1/2, 1/2 to 2 */
  double tolerance;           /* (-) as in bw_newton_options; default 1e-6, above 0, below 1 */
  int iterations;             /* 1: linearly implicit; default 30, 1 or more */
  bool allow_inverted;        /* as in bw_newton_options; default false */
  const bw_solver *solver;    /* retained by the motion. BW_SOLVER_CHOLESKY as in
                                 bw_newton_options, or for large solids BW_SOLVER_PCG with
                                 BW_SOLVER_JACOBI, whose tolerance and iterations follow from the
                                 step; default NULL: the factor */
} bw_transient_options;
BW_API void bw_transient_options_default(bw_transient_options *options);
/* A solid in motion under a constant case, its loads at full. Mutable. */
typedef struct bw_solid_transient {
  bw_object object;
  const bw_solid *solid;         /* retained */
  const bw_load_case *load_case; /* retained */
  bw_transient_options options;  /* that it was created with */
  double time;                   /* (s) */
  int64_t steps;                 /* so far */
  double *displacement;          /* (m, node_count x 3) */
  double *velocity;              /* (m/s, node_count x 3) */
  double
      *acceleration; /* (m/s2, node_count x 3) Newmark's is without the forces of contact planes */
  double kinetic, strain, potential; /* (J) potential: of loads that do not follow */
  double dissipated; /* (J) by damping, contact planes and the scheme, so that the sum of the four
                        changes by the work of pressures that follow only */
  bw_newton_report newton; /* of the last step */
  bw_solver_report report; /* of its linear equations */
  struct bwi_transient *inner;
} bw_solid_transient;
/* A motion from displacements u (m, node_count x 3) and velocities v (m/s, node_count x 3), which
 * may be NULL: at rest. Prescribed components have their values of the case from the start.
 * BW_INVALID for a solid without density and for a solver that does not serve, BW_GEOMETRY where
 * the shape has no energy. `options` may be NULL. */
BW_API bw_status bw_solid_transient_create(bw_context *context, const bw_solid *solid,
                                           const bw_load_case *load_case,
                                           const bw_transient_options *options, const double *u,
                                           const double *v, bw_solid_transient **motion);
/* One step. On failure the motion is as it was: BW_CONVERGENCE where no solution was found
 * (never with one iteration, unless nothing lowers the potential), BW_GEOMETRY where it has
 * inverted elements; both name time, residual, worst element and its place. */
BW_API bw_status bw_solid_transient_step(bw_context *context, bw_solid_transient *motion);
/* `count` steps, with progress: all of them, or where one fails none. Those of
 * bw_solid_transient_step. */
BW_API bw_status bw_solid_transient_advance(bw_context *context, bw_solid_transient *motion,
                                            int64_t count);
/* Checks its parts against each other. */
BW_API bw_status bw_solid_transient_check(bw_context *context, const bw_solid_transient *motion);

#ifdef __cplusplus
}
#endif
#endif
