/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The upper bound of the worst case against linear programs in rational arithmetic (glp_exact).
 *
 * Nothing of the engine's search is used: stresses by pressure come from a forward solve for each
 * pressure, balance from forces and moments about the origin, the optimum from GLPK's exact simplex
 * method. Directions are the centres of a cover of the half sphere of this test's own. */
#include "body_system.h"
#include "pressed.h"

#include "analysis/worst_internal.h"
#include "barwright/certificate.h"

#include <glpk.h>

enum { MAX = 96 }; /* pressures */

typedef struct exact {
  pressed_body body;
  bw_system *system;
  double *response; /* pressures x element_count x 6 */
  glp_prob *problem;
} exact;

static void exact_open(bw_context *context, exact *x, bw_mesh *mesh, bool fixed, double friction) {
  pressed_body *s = &x->body;
  pressed_open(context, s, mesh, fixed, friction, 3);
  x->problem = NULL;
  check_ok(context, body_system(context, mesh, s->material, s->dof_map, NULL, &x->system));
  assert_true(s->n <= MAX);
  double *force = BW_NEW(context, double, 3 * (size_t)mesh->node_count), unit[MAX] = {0};
  x->response = BW_NEW(context, double, 6 * s->n * (size_t)mesh->element_count);
  for (size_t j = 0; j < s->n; j++) {
    unit[j] = 1;
    bw_pressure_force(s->basis, unit, force);
    unit[j] = 0;
    check_ok(context, bw_system_solve(context, x->system, 1, force, force));
    check_ok(context, bw_element_stress(context, mesh, s->material, force,
                                        x->response + 6 * j * (size_t)mesh->element_count));
  }
  bw_free(force);
}

static void exact_close(exact *x) {
  glp_delete_prob(x->problem);
  bw_free(x->response);
  bw_release(x->system);
  pressed_close(&x->body);
  bw_release(x->body.mesh);
}

/* Unknowns: pressures over p_max. Rows: forces, moments (a free body), the total, each node. */
static void pose(exact *x, const bw_worst_load_options *options) {
  const bw_pressure_basis *b = x->body.basis;
  int n = b->count, nodes = n / b->directions, balance = x->body.dof_map->rigid_mode_count;
  int row[10], last = balance + 1; /* GLPK counts from 1 */
  double value[10];
  assert_true(balance == 0 || balance == 6);
  x->problem = glp_create_prob();
  glp_set_obj_dir(x->problem, GLP_MAX);
  glp_add_rows(x->problem, last + nodes);
  glp_add_cols(x->problem, n);
  for (int i = 1; i <= balance; i++)
    glp_set_row_bnds(x->problem, i, GLP_FX, 0, 0);
  double total = options->force / options->pressure;
  glp_set_row_bnds(x->problem, last, options->force_is_max ? GLP_UP : GLP_FX, total, total);
  for (int i = 1; i <= nodes; i++)
    glp_set_row_bnds(x->problem, last + i, GLP_UP, 0, 1);
  for (int j = 0; j < n; j++) {
    double sum[6] = {0};
    int count = 0;
    for (int64_t e = b->start[j]; e < b->start[j + 1]; e++) {
      double moment[3];
      bw_cross(x->body.mesh->node + 3 * (size_t)b->row[e], b->coefficient + 3 * e, moment);
      for (int k = 0; k < 3; k++) {
        sum[k] += b->coefficient[3 * e + k];
        sum[3 + k] += moment[k];
      }
    }
    for (int k = 0; k < balance; k++)
      if (sum[k] != 0) {
        row[++count] = k + 1;
        value[count] = sum[k];
      }
    glp_set_col_bnds(x->problem, j + 1, GLP_LO, 0, 0);
    row[++count] = last;
    value[count] = b->area[j];
    row[++count] = last + 1 + j / b->directions;
    value[count] = 1;
    glp_set_mat_col(x->problem, j + 1, count, row, value);
  }
}

/* The exact largest value of s n . sigma n in an element, Pa. */
static double largest(exact *x, const bw_worst_load_options *options, int32_t element,
                      const double d[3], double sign) {
  size_t elements = (size_t)x->body.mesh->element_count;
  double scale = 0, cost[MAX];
  for (int32_t j = 0; j < x->body.basis->count; j++) {
    const double *s = x->response + 6 * ((size_t)j * elements + (size_t)element);
    cost[j] = sign * (d[0] * d[0] * s[0] + d[1] * d[1] * s[1] + d[2] * d[2] * s[2] +
                      2 * (d[1] * d[2] * s[3] + d[2] * d[0] * s[4] + d[0] * d[1] * s[5]));
    scale = fmax(scale, fabs(cost[j]));
  }
  for (int32_t j = 0; j < x->body.basis->count; j++)
    glp_set_obj_coef(x->problem, j + 1, cost[j] / scale);
  glp_smcp control;
  glp_init_smcp(&control);
  control.msg_lev = GLP_MSG_OFF;
  glp_term_out(GLP_OFF);
  glp_std_basis(x->problem);
  glp_simplex(x->problem, &control);
  assert_int_equal(glp_exact(x->problem, &control), 0);
  assert_int_equal(glp_get_status(x->problem), GLP_OPT);
  return glp_get_obj_val(x->problem) * scale * options->pressure;
}

/* The cover: a cube's upper half, faces divided into squares; cosine of twice the largest angle. */
static int cover(int parts, double (*centre)[3], double *cosine) {
  int count = 0;
  *cosine = 1;
  for (int axis = 0; axis < 3; axis++)
    for (int i = 0; i < parts; i++)
      for (int k = 0; k < parts; k++, count++) {
        double *c = centre[count];
        c[axis] = 1;
        c[(axis + 1) % 3] = (2 * i + 1.0) / parts - 1;
        c[(axis + 2) % 3] = (2 * k + 1.0) / parts - 1;
        double length = bw_norm(c);
        for (int l = 0; l < 3; l++)
          c[l] /= length;
        for (int corner = 0; corner < 4; corner++) {
          double v[3];
          v[axis] = 1;
          v[(axis + 1) % 3] = 2.0 * (i + corner % 2) / parts - 1;
          v[(axis + 2) % 3] = 2.0 * (k + corner / 2) / parts - 1;
          double near = bw_dot(c, v) / bw_norm(v);
          *cosine = fmin(*cosine, 2 * near * near - 1);
        }
      }
  return count;
}

/* Every exact value lies below the bound; the best of the cover over its cosine lies above what
 * loads reach; and the bound's own stress is reached by an exact linear program along its
 * direction. */
static void bound_holds_in_rational_arithmetic(void **state) {
  bw_context *context = check_context(state);
  double centre[3 * 16][3], cosine;
  int parts = getenv("BARWRIGHT_FULL") ? 4 : 2, directions = cover(parts, centre, &cosine);
  assert_true(cosine > 0);
  for (int kind = 0; kind < 4; kind++) {
    exact x;
    exact_open(context, &x, make_box(context, 1, 0.6, 0.3, 2, 1, 1, 1), kind == 1,
               kind == 2 ? 3 : 0);
    bw_worst_load_options options = {.pressure = 1e5, .force = 2e4, .force_is_max = kind == 3};
    bw_worst_bound bound;
    check_ok(context,
             bw_worst_bound_find(context, x.system, x.body.basis, &options, 0, 0.01, &bound, NULL));
    assert_true(bound.upper >= bound.largest && bound.upper <= 1.0101 * bound.largest);
    pose(&x, &options);
    double best = 0;
    for (int32_t e = 0; e < x.body.mesh->element_count; e++)
      for (int d = 0; d < directions; d++)
        for (int sign = -1; sign <= 1; sign += 2) {
          double value = largest(&x, &options, e, centre[d], sign);
          assert_true(value <= bound.upper * (1 + 1e-9));
          best = fmax(best, value);
        }
    assert_true(best / cosine >= bound.largest * (1 - 1e-9));
    /* Along the direction of the bound's own stress: close to the largest value there is. */
    double value[3], axis[9];
    bw_eigen3(bound.stress, value, axis);
    int which = fabs(value[0]) > fabs(value[2]) ? 0 : 2;
    double reached =
        largest(&x, &options, bound.element, axis + 3 * which, value[which] < 0 ? -1 : 1);
    assert_true(reached >= bound.largest * (1 - 1e-9));
    assert_true(reached <= bound.upper * (1 + 1e-9));
    /* From a poorer start elements and directions are closed by their bounds alone; those that hold
     * this value must not be. */
    for (int start = 0; start < 3; start++) {
      const double share[3] = {0.5, 0.8, 0.95};
      check_ok(context, bw_worst_bound_find(context, x.system, x.body.basis, &options,
                                            share[start] * reached, 0.01, &bound, NULL));
      assert_true(bound.upper >= fmax(best, reached) * (1 - 1e-9));
    }
    exact_close(&x);
  }
  glp_free_env();
}

/* The triangle of a cell, and its depth. */
static int triangle_of(int64_t cell, bwi_triangle *triangle) {
  bwi_triangle face[BWI_HALF_ICOSAHEDRON], part[4];
  int depth = 0;
  while (cell >> (2 * depth) >= 2 * BW_FIRST_FACE)
    depth++;
  bwi_half_icosahedron(face);
  *triangle = face[(cell >> (2 * depth)) - BW_FIRST_FACE];
  for (int level = depth - 1; level >= 0; level--) {
    bwi_divide_triangle(triangle, part);
    *triangle = part[(cell >> (2 * level)) & 3];
  }
  return depth;
}

/* The numbers of a leaf's multipliers: whole numbers times a power of two. */
static void read_multipliers(const bw_bound_leaves *leaves, const bw_bound_leaf *leaf, int motions,
                             double *y) {
  const int32_t *from = leaves->number + leaf->start;
  int vectors = leaf->cell == 0 ? 6 : 2;
  for (int v = 0; v < vectors; v++)
    for (int part = 0; part < (leaf->cell != 0 || v == 5 ? 2 : 1); part++) {
      int exponent = *from++;
      for (int k = 0; k < (part == 0 ? motions : 1); k++)
        *y++ = ldexp(*from++, exponent);
    }
}

/* The evaluation that shares nothing with the search gives the leaves' bounds again. */
static void check_dual_bounds(bw_context *context, const exact *x,
                              const bw_worst_load_options *options, const bw_bound_leaves *leaves) {
  const bw_pressure_basis *basis = x->body.basis;
  const bw_dof_map *dof_map = x->body.dof_map;
  int m = dof_map->rigid_mode_count;
  size_t numbers = 6 * (size_t)m + 2, count = leaves->count;
  double *work = BW_NEW0(context, double, (size_t)m * x->body.n + 1);
  double *multiplier = BW_NEW0(context, double, count *numbers);
  double *direction = BW_NEW0(context, double, 3 * count), *share = BW_NEW(context, double, count);
  double *bound = BW_NEW(context, double, count), *solve_error = BW_NEW(context, double, count);
  int32_t *element = BW_NEW(context, int32_t, count);
  bwi_column_motions(basis, dof_map, work);
  for (size_t i = 0; i < count; i++) {
    const bw_bound_leaf *leaf = &leaves->leaf[i];
    element[i] = leaf->element;
    share[i] = 1;
    if (leaf->cell != 0) {
      bwi_triangle triangle;
      triangle_of(leaf->cell, &triangle);
      share[i] = bwi_triangle_centre(&triangle, direction + 3 * i);
    }
    read_multipliers(leaves, leaf, m, multiplier + i * numbers);
  }
  bw_dual_claims claims = {.force = options->force,
                           .pressure = options->pressure,
                           .force_is_max = options->force_is_max,
                           .motions = m,
                           .work = work,
                           .count = (int64_t)count,
                           .element = element,
                           .direction = direction,
                           .multiplier = multiplier};
  check_ok(context, bw_dual_bounds(context, x->system, basis, &claims, bound, solve_error));
  for (size_t i = 0; i < count; i++) {
    double stated = leaves->leaf[i].bound * share[i];
    assert_true(fabs(bound[i] - stated) <= 1e-9 * stated);
    assert_true(solve_error[i] >= 0 && solve_error[i] <= 1e-7 * stated);
  }
  element[0] = x->body.mesh->element_count;
  check_fails(context, BW_INVALID, "element",
              bw_dual_bounds(context, x->system, basis, &claims, bound, solve_error));
  bw_free(work);
  bw_free(multiplier);
  bw_free(direction);
  bw_free(share);
  bw_free(bound);
  bw_free(solve_error);
  bw_free(element);
}

/* The leaves of each element cover all directions, and no exact optimum of a leaf's linear programs
 * exceeds its bound. */
static void leaves_hold_in_rational_arithmetic(void **state) {
  bw_context *context = check_context(state);
  double centre[3 * 4][3], cosine;
  int directions = cover(2, centre, &cosine);
  bool full = getenv("BARWRIGHT_FULL") != NULL;
  for (int kind = 0; kind < 4; kind++) {
    exact x;
    exact_open(context, &x, make_box(context, 1, 0.6, 0.3, 2, 1, 1, 1), kind == 1,
               kind == 2 ? 3 : 0);
    bw_worst_load_options options = {.pressure = 1e5, .force = 2e4, .force_is_max = kind == 3};
    bw_worst_bound bound;
    bw_bound_leaves leaves = {0};
    check_ok(context, bw_worst_bound_find(context, x.system, x.body.basis, &options, 0, 0.01,
                                          &bound, &leaves));
    pose(&x, &options);
    double covered[64] = {0}, max = 0; /* faces of each element */
    int32_t elements = x.body.mesh->element_count;
    assert_true(elements <= 64);
    for (size_t i = 0; i < leaves.count; i++) {
      const bw_bound_leaf *leaf = &leaves.leaf[i];
      max = fmax(max, leaf->bound);
      if (leaf->cell == 0) {
        covered[leaf->element] += BWI_HALF_ICOSAHEDRON;
        for (int d = 0; d < directions; d++)
          for (int sign = -1; sign <= 1; sign += 2)
            assert_true(largest(&x, &options, leaf->element, centre[d], sign) <=
                        leaf->bound * (1 + 1e-9));
        continue;
      }
      bwi_triangle triangle;
      double n[3];
      covered[leaf->element] += pow(0.25, triangle_of(leaf->cell, &triangle));
      double share = bwi_triangle_centre(&triangle, n);
      for (int sign = -1; sign <= 1 && (full || i % 5 == 0); sign += 2)
        assert_true(largest(&x, &options, leaf->element, n, sign) <=
                    leaf->bound * share * (1 + 1e-9));
    }
    for (int32_t e = 0; e < elements; e++)
      assert_true(covered[e] == BWI_HALF_ICOSAHEDRON);
    assert_true(fmax(max, bound.largest) == bound.upper);
    check_dual_bounds(context, &x, &options, &leaves);
    bw_bound_leaves_clear(&leaves);
    exact_close(&x);
  }
  glp_free_env();
}

check_main(check_test(bound_holds_in_rational_arithmetic),
           check_test(leaves_hold_in_rational_arithmetic))
