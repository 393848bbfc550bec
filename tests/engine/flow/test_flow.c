/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Flow and heat: exact and published flows, reactions that balance, the same answer after moving on
 * as from the start. */
#include "../check.h"

/* A rectangle with nodes drawn towards its sides: x -> (1 + tanh(2 (2 x - 1)) / tanh 2) / 2. */
static double drawn(double t, double by) {
  return by > 0 ? 0.5 * (1 + tanh(by * (2 * t - 1)) / tanh(by)) : t;
}

static bw_plane_mesh *rectangle(bw_context *context, double a, double b, int nx, int ny,
                                double by) {
  bw_plane_mesh *even, *mesh;
  check_ok(context, bw_plane_rectangle(context, 1, (double[2]){0, 0}, (double[2]){a, b}, nx, ny,
                                       BW_DIAGONAL_UNION_JACK, &even));
  const bw_plane_nodes *nodes = even->topology->nodes;
  size_t count = (size_t)nodes->node_count;
  double *point = malloc(2 * count * sizeof *point), *parameter = malloc(count * sizeof *parameter);
  for (size_t i = 0; i < count; i++) {
    double t = nodes->parameter[i];
    point[2 * i] = a * drawn(even->point[2 * i] / a, by);
    point[2 * i + 1] = b * drawn(even->point[2 * i + 1] / b, by);
    parameter[i] = nodes->segment[i] < 0 || t == 0 ? t : drawn(t, by);
  }
  check_ok(context, bw_plane_mesh_on(context, even->outline, 1, nodes->node_count, point,
                                     nodes->segment, parameter, even->topology->element_count,
                                     even->topology->element, NULL, &mesh));
  free(point);
  free(parameter);
  bw_release(even);
  return mesh;
}

enum { BOTTOM, RIGHT, TOP, LEFT };

static bw_flow *make_flow(bw_context *context, const bw_plane_mesh *mesh, double viscosity,
                          int conditions, const bw_condition *condition) {
  bw_flow_description d = {
      .density = 1, .viscosity = viscosity, .condition_count = conditions, .condition = condition};
  bw_flow *flow;
  check_ok(context, bw_flow_create(context, mesh, &d, &flow));
  return flow;
}

static double parabola(void *data, const double at[2], double time) {
  (void)data;
  (void)time;
  return 4 * at[1] * (1 - at[1]);
}

static const bw_condition channel[6] = {{.tag = BOTTOM, .component = 0},
                                        {.tag = BOTTOM, .component = 1},
                                        {.tag = TOP, .component = 0},
                                        {.tag = TOP, .component = 1},
                                        {.tag = LEFT, .component = 0, .function = parabola},
                                        {.tag = LEFT, .component = 1}};

/* Poiseuille's flow: second order in the velocity, and the outlet is left as if there were none. */
static void test_channel(void **state) {
  bw_context *context = check_context(state);
  double error[3];
  for (int k = 0; k < 3; k++) {
    bw_plane_mesh *mesh = rectangle(context, 2, 1, 8 << k, 4 << k, 0);
    bw_flow *flow = make_flow(context, mesh, 0.1, 6, channel);
    bw_plane_reuse reuse = {0};
    double force[2];
    check_ok(context, bw_flow_step(context, flow, NULL, &reuse));
    error[k] = 0;
    for (int64_t i = 0; i < mesh->topology->nodes->node_count; i++)
      error[k] = fmax(error[k], fabs(flow->state[3 * i] - parabola(NULL, mesh->point + 2 * i, 0)));
    check_ok(context, bw_flow_force(context, flow, BOTTOM, force));
    check_near(force[0], 4 * 0.1 * 2, 0.35 * pow(0.5, k));
    bw_release(flow);
    bw_release(mesh);
  }
  if (!(log2(error[1] / error[2]) > 1.8))
    fail_msg("errors %g %g %g", error[0], error[1], error[2]);
}

/* A square with a moving lid at Re = 100: extreme velocities on the middle lines, from spectral
 * calculations (Botella and Peyret 1998; Bruneau and Saad 2006). The corners stand still: moving
 * ones would let the lid carry fluid through the walls. */
static void test_cavity(void **state) {
  bw_context *context = check_context(state);
  static const bw_condition walls[8] = {{.tag = TOP, .component = 0, .value = 1},
                                        {.tag = TOP, .component = 1},
                                        {.tag = BOTTOM, .component = 0},
                                        {.tag = BOTTOM, .component = 1},
                                        {.tag = LEFT, .component = 0},
                                        {.tag = LEFT, .component = 1},
                                        {.tag = RIGHT, .component = 0},
                                        {.tag = RIGHT, .component = 1}};
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 32, 32, 1);
  bw_flow *flow = make_flow(context, mesh, 0.01, 8, walls);
  double mean = 0;
  check_ok(context, bw_flow_step(context, flow, NULL, NULL));
  double u_low = 0, v_low = 0, v_high = 0;
  for (int i = 1; i < 400; i++) {
    double values[3], t = i / 400.0;
    check_ok(context, bw_flow_at(context, flow, (double[2]){0.5, t}, values));
    u_low = fmin(u_low, values[0]);
    check_ok(context, bw_flow_at(context, flow, (double[2]){t, 0.5}, values));
    v_low = fmin(v_low, values[1]);
    v_high = fmax(v_high, values[1]);
  }
  check_near(u_low, -0.21404, 0.01 * 0.214);
  check_near(v_low, -0.25380, 0.015 * 0.254);
  check_near(v_high, 0.17957, 0.01 * 0.18);
  for (int64_t e = 0; e < mesh->topology->element_count; e++) {
    const int32_t *node = mesh->topology->element + 3 * e;
    const double *a = mesh->point + 2 * (int64_t)node[0], *b = mesh->point + 2 * (int64_t)node[1],
                 *c = mesh->point + 2 * (int64_t)node[2];
    double area = ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2;
    for (int i = 0; i < 3; i++)
      mean += area / 3 * flow->state[3 * (int64_t)node[i] + 2];
  }
  check_near(mean, 0, 1e-9); /* enclosed: the pressure has no mean */
  bw_release(flow);
  bw_release(mesh);
}

/* De Vahl Davis 1983: a square heated at the left, cooled at the right; heat in equals heat out. */
static void test_heated_square(void **state) {
  bw_context *context = check_context(state);
  static const double nusselt[3] = {1.118, 2.243, 4.519};
  static const bw_condition walls[4] = {{.tag = -1, .component = 0},
                                        {.tag = -1, .component = 1},
                                        {.tag = LEFT, .component = 3, .value = 1},
                                        {.tag = RIGHT, .component = 3}};
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 20, 20, 2);
  for (int k = 0; k < 3; k++) {
    double rayleigh = pow(10, 3 + k), prandtl = 0.71, in, out;
    bw_flow_description d = {.density = 1,
                             .viscosity = prandtl,
                             .diffusivity = 1,
                             .expansion = 1,
                             .reference = 0.5,
                             .gravity = {0, -rayleigh * prandtl},
                             .condition_count = 4,
                             .condition = walls};
    bw_flow *flow;
    check_ok(context, bw_flow_create(context, mesh, &d, &flow));
    check_ok(context, bw_flow_step(context, flow, NULL, NULL));
    check_ok(context, bw_flow_heat(context, flow, LEFT, &in));
    check_ok(context, bw_flow_heat(context, flow, RIGHT, &out));
    check_near(in / nusselt[k], 1, 0.01);
    check_near(in + out, 0, 1e-6 * in);
    bw_release(flow);
  }
  bw_release(mesh);
}

static double growing(void *data, const double at[2], double time) {
  return *(double *)data * at[1] * (1 - at[1]) * (1 - exp(-time));
}

static bw_flow *warm_flow(bw_context *context, const bw_plane_mesh *mesh, double diffusivity,
                          int conditions, const bw_condition *condition) {
  bw_flow_description d = {.density = 1,
                           .viscosity = 1,
                           .diffusivity = diffusivity,
                           .condition_count = conditions,
                           .condition = condition};
  bw_flow *flow;
  check_ok(context, bw_flow_create(context, mesh, &d, &flow));
  return flow;
}

/* A wall that heat comes into on the left by a flux q and leaves on the right by convection: T
 * falls by q L / alpha across it, and is q / h above the surroundings at its end. */
static void test_flux_and_convection(void **state) {
  bw_context *context = check_context(state);
  const double q = 0.7, h = 2, outside = 5, alpha = 0.5, length = 2;
  bw_plane_mesh *mesh = rectangle(context, length, 1, 6, 5, 1.5);
  bw_condition conditions[4] = {
      {.tag = -1, .component = 0},
      {.tag = -1, .component = 1},
      {.tag = LEFT, .kind = BW_TRACTION, .component = 3, .value = q},
      {.tag = RIGHT, .kind = BW_CONVECTION, .component = 3, .value = outside, .coefficient = h}};
  bw_flow *flow = warm_flow(context, mesh, alpha, 4, conditions);
  double heat[4];
  check_ok(context, bw_flow_step(context, flow, NULL, NULL));
  for (int64_t i = 0; i < mesh->topology->nodes->node_count; i++)
    check_near(flow->state[4 * i + 3], outside + q / h + q / alpha * (length - mesh->point[2 * i]),
               1e-7);
  for (int tag = 0; tag < 4; tag++)
    check_ok(context, bw_flow_heat(context, flow, tag, &heat[tag]));
  check_near(heat[LEFT], q, 1e-12);
  check_near(heat[RIGHT], -q, 1e-7);
  check_near(heat[BOTTOM], 0, 0);
  check_ok(context, bw_flow_heat(context, flow, -1, heat));
  check_near(heat[0], 0, 1e-7);
  bw_release(flow);
  /* heat that cannot leave: no steady state; in time, the mean rises by q t / L */
  flow = warm_flow(context, mesh, alpha, 3, conditions);
  bw_flow_options options;
  bw_flow_options_default(&options);
  check_fails(context, BW_INVALID, "no steady state", bw_flow_step(context, flow, &options, NULL));
  options.step = 0.1;
  options.linear.tolerance = 1e-11;
  for (int k = 0; k < 10; k++)
    check_ok(context, bw_flow_step(context, flow, &options, NULL));
  double area = 0, sum = 0;
  for (int64_t e = 0; e < mesh->topology->element_count; e++) {
    const int32_t *node = mesh->topology->element + 3 * e;
    const double *a = mesh->point + 2 * node[0], *b = mesh->point + 2 * node[1],
                 *c = mesh->point + 2 * node[2];
    double one = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
    area += one;
    for (int i = 0; i < 3; i++)
      sum += one / 3 * flow->state[4 * (int64_t)node[i] + 3];
  }
  check_near(sum / area, q * 1.0 / length, 1e-8);
  bw_release(flow);
  conditions[3].coefficient = -1;
  bw_flow_description d = {.density = 1,
                           .viscosity = 1,
                           .diffusivity = 1,
                           .condition_count = 4,
                           .condition = conditions};
  check_fails(context, BW_INVALID, "convection", bw_flow_create(context, mesh, &d, &flow));
  bw_release(mesh);
}

/* Half a cooling fin, symmetric about y = 0, convection on its side y = w, none at its tip x = L:
 *
 *   T = cos(k y) cosh(k (L - x)) / cosh(k L),   k tan(k w) = h / alpha,
 *
 * is the temperature in the plane where the base has T = cos(k y). */
typedef struct fin {
  double k, length;
} fin;

static double fin_base(void *data, const double at[2], double time) {
  const fin *f = data;
  (void)time;
  return cos(f->k * at[1]) * cosh(f->k * (f->length - at[0])) / cosh(f->k * f->length);
}

static void test_fin(void **state) {
  bw_context *context = check_context(state);
  const double width = 0.5, alpha = 0.8;
  fin f = {.k = 1.3, .length = 2};
  double h = alpha * f.k * tan(f.k * width), error[3], lost[3];
  double exact = alpha * tanh(f.k * f.length) * sin(f.k * width);
  bw_condition conditions[4] = {
      {.tag = -1, .component = 0},
      {.tag = -1, .component = 1},
      {.tag = LEFT, .component = 3, .function = fin_base, .data = &f},
      {.tag = TOP, .kind = BW_CONVECTION, .component = 3, .coefficient = h}};
  for (int r = 0; r < 3; r++) {
    bw_plane_mesh *mesh = rectangle(context, f.length, width, 8 << r, 2 << r, 0);
    bw_flow *flow = warm_flow(context, mesh, alpha, 4, conditions);
    double base, top, tip;
    check_ok(context, bw_flow_step(context, flow, NULL, NULL));
    error[r] = 0;
    for (int64_t i = 0; i < mesh->topology->nodes->node_count; i++)
      error[r] =
          fmax(error[r], fabs(flow->state[4 * i + 3] - fin_base(&f, mesh->point + 2 * i, 0)));
    check_ok(context, bw_flow_heat(context, flow, LEFT, &base));
    check_ok(context, bw_flow_heat(context, flow, TOP, &top));
    check_ok(context, bw_flow_heat(context, flow, RIGHT, &tip));
    check_near(base + top, 0, 1e-7);
    check_near(tip, 0, 0);
    lost[r] = fabs(base - exact);
    bw_release(flow);
    bw_release(mesh);
  }
  if (!(log2(error[1] / error[2]) > 1.8) || !(log2(lost[1] / lost[2]) > 1.8) || !(error[2] < 1e-3))
    fail_msg("errors %g %g %g, of the heat %g %g %g", error[0], error[1], error[2], lost[0],
             lost[1], lost[2]);
}

/* A channel set in motion: implicit Euler is of first order in the step, the other scheme of
 * second. */
static void test_order_in_time(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 6, 6, 0);
  double four = 4;
  bw_condition given[6];
  memcpy(given, channel, sizeof given);
  given[4].function = growing;
  given[4].data = &four;
  for (int bdf = 1; bdf <= 2; bdf++) {
    double value[4];
    for (int k = 0; k < 4; k++) {
      bw_flow *flow = make_flow(context, mesh, 0.05, 6, given);
      bw_flow_options options;
      bw_flow_options_default(&options);
      int steps = k == 3 ? 320 : 10 << k;
      options.step = 1.0 / steps;
      options.bdf = bdf;
      options.linear.tolerance = 1e-11;
      for (int i = 0; i < steps; i++)
        check_ok(context, bw_flow_step(context, flow, &options, NULL));
      double at[3];
      check_ok(context, bw_flow_at(context, flow, (double[2]){0.9, 0.5}, at));
      value[k] = at[0];
      bw_release(flow);
    }
    double order = log2(fabs(value[0] - value[1]) / fabs(value[1] - value[2]));
    if (!(order > bdf - 0.35))
      fail_msg("scheme %d: order %g (%.9g %.9g %.9g %.9g)", bdf, order, value[0], value[1],
               value[2], value[3]);
  }
  bw_release(mesh);
}

/* Moved nodes: a steady flow found from a former state on a lagged factor is that of a new
 * computation. */
static void test_following(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = rectangle(context, 2, 1, 16, 8, 0), *moved;
  const bw_plane_nodes *nodes = mesh->topology->nodes;
  double *point = malloc((size_t)nodes->node_count * 2 * sizeof *point);
  bw_random random;
  bw_random_seed(&random, 5);
  for (int64_t i = 0; i < 2 * (int64_t)nodes->node_count; i++)
    point[i] = mesh->point[i] +
               (nodes->segment[i / 2] < 0 ? 0.04 * (bw_random_uniform(&random) - 0.5) : 0);
  check_ok(context, bw_plane_mesh_moved(context, mesh, mesh->outline, point, &moved));
  bw_flow *flow = make_flow(context, mesh, 0.02, 6, channel);
  bw_flow *fresh = make_flow(context, moved, 0.02, 6, channel);
  bw_plane_reuse reuse = {0};
  double force[2], other[2];
  check_ok(context, bw_flow_step(context, flow, NULL, NULL));
  check_ok(context, bw_flow_follow(context, flow, moved, &reuse));
  assert_true(reuse.pattern && reuse.solution);
  check_fails(context, BW_INVALID, "no solution", bw_flow_force(context, flow, BOTTOM, force));
  check_ok(context, bw_flow_step(context, flow, NULL, &reuse));
  check_ok(context, bw_flow_step(context, fresh, NULL, NULL));
  for (int64_t i = 0; i < 3 * (int64_t)nodes->node_count; i++)
    check_near(flow->state[i], fresh->state[i], 1e-6);
  check_ok(context, bw_flow_force(context, flow, BOTTOM, force));
  check_ok(context, bw_flow_force(context, fresh, BOTTOM, other));
  check_near(force[0], other[0], 1e-6);
  bw_release(flow);
  bw_release(fresh);
  bw_release(moved);
  bw_release(mesh);
  free(point);
}

/* What was kept comes back bit for bit, whatever was done since: another shape, another mesh, time.
 */
static void test_kept(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = rectangle(context, 2, 1, 12, 6, 0),
                *other = rectangle(context, 2, 1, 9, 5, 0);
  const size_t size = 3 * (size_t)mesh->topology->nodes->node_count * sizeof(double);
  bw_flow *flow = make_flow(context, mesh, 0.05, 6, channel);
  double *state_then = malloc(size), force[2], again[2];
  bw_flow_options options;
  bw_flow_options_default(&options);
  options.step = 0.05;
  for (int k = 0; k < 3; k++)
    check_ok(context, bw_flow_step(context, flow, &options, NULL));
  check_ok(context, bw_flow_force(context, flow, BOTTOM, force));
  memcpy(state_then, flow->state, size);
  const bw_flow_state *kept = bw_flow_keep(flow);
  for (int k = 0; k < 2; k++) {
    bw_plane_mesh *now = k ? other : mesh;
    check_ok(context, bw_flow_follow(context, flow, now, NULL));
    check_ok(context, bw_flow_step(context, flow, k ? NULL : &options, NULL));
    check_ok(context, bw_flow_return(context, flow, kept));
    assert_ptr_equal(flow->mesh, mesh);
    assert_memory_equal(flow->state, state_then, size);
    check_near(flow->time, 0.15, 1e-15);
    check_ok(context, bw_flow_force(context, flow, BOTTOM, again));
    assert_memory_equal(force, again, sizeof force);
  }
  /* a step from it is the step that would have followed, up to the factor that it is solved on */
  bw_flow *straight = make_flow(context, mesh, 0.05, 6, channel);
  options.linear.tolerance = 1e-12;
  for (int k = 0; k < 4; k++)
    check_ok(context, bw_flow_step(context, straight, &options, NULL));
  check_ok(context, bw_flow_step(context, flow, &options, NULL));
  for (size_t i = 0; i < size / sizeof(double); i++)
    check_near(flow->state[i], straight->state[i], 2e-5);
  bw_flow *heated = warm_flow(context, mesh, 1, 6, channel);
  check_fails(context, BW_INVALID, "another flow", bw_flow_return(context, heated, kept));
  bw_release(heated);
  bw_release(straight);
  bw_release(kept);
  bw_release(flow);
  bw_release(mesh);
  bw_release(other);
  free(state_then);
}

static double shear(void *data, const double at[2], double time) {
  (void)data;
  (void)time;
  return at[1];
}

/* Couette's flow is linear in space: nodes that wander through it, at steps of any length, do not
 * disturb it if the equations have their velocity; if not, they carry it along. */
static void test_moving_mesh(void **state) {
  bw_context *context = check_context(state);
  static const bw_condition plates[5] = {{.tag = LEFT, .component = 0, .function = shear},
                                         {.tag = LEFT, .component = 1},
                                         {.tag = BOTTOM, .component = 0},
                                         {.tag = TOP, .component = 0, .value = 1},
                                         {.tag = -1, .component = 1}};
  double off[2] = {0};
  for (int ale = 0; ale < 2; ale++) {
    bw_plane_mesh *mesh = rectangle(context, 2, 1, 12, 6, 0);
    const bw_plane_nodes *nodes = mesh->topology->nodes;
    double *point = malloc(2 * (size_t)nodes->node_count * sizeof *point);
    bw_flow *flow = make_flow(context, mesh, 0.01, 5, plates);
    bw_flow_options options;
    bw_flow_options_default(&options);
    options.ale = ale;
    options.iterations = 12; /* what is extrapolated goes along the paths of nodes */
    options.tolerance = 1e-11;
    options.linear.tolerance = 1e-12;
    check_ok(context, bw_flow_step(context, flow, NULL, NULL));
    for (int k = 1; k <= 8; k++) {
      bw_plane_mesh *moved;
      options.step = k % 3 ? 0.02 : 0.05;
      for (int64_t i = 0; i < nodes->node_count; i++) {
        const double *x = mesh->point + 2 * i;
        double wave = nodes->segment[i] < 0 ? sin(2 * x[0] + 3 * k) * sin(3 * x[1] + k * k) : 0;
        point[2 * i] = x[0] + 0.03 * wave;
        point[2 * i + 1] = x[1] - 0.02 * wave;
      }
      check_ok(context, bw_plane_mesh_moved(context, mesh, mesh->outline, point, &moved));
      check_ok(context, bw_flow_follow(context, flow, moved, NULL));
      check_ok(context, bw_flow_step(context, flow, &options, NULL));
      bw_release(moved);
    }
    for (int64_t i = 0; i < nodes->node_count; i++)
      off[ale] = fmax(off[ale], fabs(flow->state[3 * i] - flow->mesh->point[2 * i + 1]));
    bw_release(flow);
    bw_release(mesh);
    free(point);
  }
  if (!(off[1] < 1e-9) || !(off[0] > 1e-3))
    fail_msg("off by %g, without the velocity of nodes by %g", off[1], off[0]);
}

static void test_frequency(void **state) {
  (void)state;
  double signal[1000];
  for (int i = 0; i < 1000; i++)
    signal[i] = 3 + sin(2 * 3.14159265358979 * 7.3 * i * 0.002 + 0.4);
  check_near(bw_flow_frequency(1000, signal, 0.002, 8), 7.3, 0.01);
  check_near(bw_flow_frequency(3, signal, 0.002, 8), 0, 0);
}

static void test_wrong_input(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = rectangle(context, 1, 1, 2, 2, 0);
  bw_flow_description d = {.density = 1, .viscosity = 0};
  bw_condition hot = {.tag = LEFT, .component = 3, .value = 1};
  bw_flow *flow;
  check_fails(context, BW_INVALID, "viscosity", bw_flow_create(context, mesh, &d, &flow));
  d.viscosity = 1;
  d.condition = &hot;
  d.condition_count = 1;
  check_fails(context, BW_INVALID, "diffusivity", bw_flow_create(context, mesh, &d, &flow));
  flow = make_flow(context, mesh, 1, 6, channel);
  bw_flow_options options;
  bw_flow_options_default(&options);
  options.step = -1;
  check_fails(context, BW_INVALID, "step", bw_flow_step(context, flow, &options, NULL));
  double heat;
  check_fails(context, BW_INVALID, "carries no heat", bw_flow_heat(context, flow, LEFT, &heat));
  bw_release(flow);
  bw_release(mesh);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_plane_mesh *mesh = rectangle(context, 2, 1, 4, 3, 0),
                *other = rectangle(context, 2, 1, 3, 2, 0);
  bw_flow *first = make_flow(context, mesh, 0.1, 6, channel);
  check_ok(context, bw_flow_step(context, first, NULL, NULL)); /* makes the context's threads */
  bw_release(first);
  bw_flow_description d = {
      .density = 1, .viscosity = 0.1, .condition_count = 6, .condition = channel};
  bw_flow_options options;
  bw_flow_options_default(&options);
  options.step = 0.1;
  check_each_allocation(context, status, 1) {
    bw_flow *flow = NULL;
    status = bw_flow_create(context, mesh, &d, &flow);
    if (status == BW_OK)
      status = bw_flow_step(context, flow, &options, NULL);
    if (status == BW_OK)
      status = bw_flow_follow(context, flow, mesh, NULL);
    if (status == BW_OK)
      status = bw_flow_step(context, flow, NULL, NULL);
    const bw_flow_state *kept = flow ? bw_flow_keep(flow) : NULL;
    if (status == BW_OK)
      status = bw_flow_follow(context, flow, other, NULL);
    if (status == BW_OK)
      status = bw_flow_return(context, flow, kept);
    bw_release(kept);
    bw_release(flow);
  }
  bw_release(other);
  bw_release(mesh);
}

check_main(check_test(test_channel), check_test(test_cavity), check_test(test_heated_square),
           check_test(test_order_in_time), check_test(test_following), check_test(test_moving_mesh),
           check_test(test_frequency), check_test(test_wrong_input), check_test(test_memory),
           check_test(test_flux_and_convection), check_test(test_fin), check_test(test_kept))
