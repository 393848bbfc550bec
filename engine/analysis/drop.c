/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The drop test: a body falls on a horizontal peg, again and again, each time turned at random.
 *
 * One drop (docs/theory/worst_case.md, "The drop test"): in the body's frame it moves along a
 * random unit direction d; the peg is a cylinder of radius R whose axis runs across d, turned and
 * shifted at random so that it is in the body's way. Of all boundary points the one that the peg
 * reaches first is found exactly, along the boundary's edges. The contact has no friction, so the
 * impulse acts along the common normal e (from the peg's axis to the point), and the body's inertia
 * there is the effective mass m_e = 1 / (1/m + (r x e) . I^-1 (r x e)). The body bounces back as
 * fast as it came: mean force 2 m_e v_e / duration, on the contact that the peg's indentation has
 * (drop_contact.h), balanced by the body's own inertia in the solve.
 *
 * Every drop has a random sequence of its own, so drops may be worked on in any order. */
#include "analysis/drop_contact.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { BATCH = 16, PILOT = 200 };

void bw_drop_test_options_default(bw_drop_test_options *options) {
  *options = (bw_drop_test_options){.drops = 2000, .height = 1, .peg_radius = 0, .duration = 1e-3};
}

void bw_drop_test_result_clear(bw_drop_test_result *result) {
  bw_free(result->exceedance);
  bw_free(result->mean_peak);
  bw_free(result->contact);
  bw_free(result->force);
  bw_free(result->direction);
  bw_free(result->resultant);
  bw_free(result->nodes);
  bw_free(result->area);
  bw_free(result->peak);
  memset(result, 0, sizeof *result);
}

typedef struct mass_properties {
  double mass, centre[3], inverse_inertia[9];
} mass_properties;

typedef struct drop_test {
  bw_context *context;
  const bw_mesh *mesh;
  const bw_material *material;
  bw_drop_test_options options;
  mass_properties *body; /* per component */
  double speed, modulus; /* modulus: E/(1 - nu^2) */
  int64_t first;
  double *block;          /* batch x node_count x 3 */
  bwi_contact_part *part; /* workers x part_count */
  int64_t part_count;
  bw_drop_test_result *result; /* of all drops: what is known before they are solved is filled in */
  double *stress, *principal;  /* of one drop */
} drop_test;

/* ---- mass ---------------------------------------------------------------------------------- */

/* Second moments of a tetrahedron: V/20 (sum x x^T + (sum x)(sum x)^T). */
static bw_status weigh(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                       mass_properties *body) {
  double *second = BW_NEW0(context, double, 9 * (size_t)mesh->component_count);
  double low[3], high[3];
  if (!second)
    return BW_MEMORY;
  bw_mesh_box(mesh, low, high); /* moments about a point nearby lose fewer digits */
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
    int32_t c = mesh->component[node[0]];
    double m = bw_material_of(material, e)->density * mesh->volume[e], sum[3] = {0, 0, 0},
           products[9] = {0};
    for (int a = 0; a < 4; a++) {
      const double *x = mesh->node + 3 * (size_t)node[a];
      double p[3] = {x[0] - low[0], x[1] - low[1], x[2] - low[2]};
      for (int i = 0; i < 3; i++) {
        sum[i] += p[i];
        for (int k = 0; k < 3; k++)
          products[3 * i + k] += p[i] * p[k];
      }
    }
    body[c].mass += m;
    for (int i = 0; i < 3; i++) {
      body[c].centre[i] += m / 4 * sum[i];
      for (int k = 0; k < 3; k++)
        second[9 * c + 3 * i + k] += m / 20 * (products[3 * i + k] + sum[i] * sum[k]);
    }
  }
  for (int32_t c = 0; c < mesh->component_count; c++) {
    double *s = second + 9 * (size_t)c, inertia[9];
    double *x = body[c].centre;
    for (int i = 0; i < 3; i++)
      x[i] /= body[c].mass;
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        s[3 * i + k] -= body[c].mass * x[i] * x[k];
    double trace = s[0] + s[4] + s[8];
    for (int i = 0; i < 9; i++)
      inertia[i] = (i % 4 == 0 ? trace : 0) - s[i];
    bw_inverse3(inertia, body[c].inverse_inertia);
    for (int i = 0; i < 3; i++)
      x[i] += low[i];
  }
  bw_free(second);
  return BW_OK;
}

/* ---- one drop ------------------------------------------------------------------------------ */

typedef struct contact {
  bwi_peg peg;
  double speed;    /* of approach along the push */
  int32_t node[2]; /* the edge that is hit */
  double part;     /* where on it: 0 at node[0] */
} contact;

/* Along the edge with depths z0, z1 and lateral places y0, y1, where the peg of radius r comes
 * first: the largest z + sqrt(r^2 - y^2). False when the edge is out of reach. */
static bool reach_of_edge(double z0, double z1, double y0, double y1, double r, double *reach,
                          double *part) {
  double dz = z1 - z0, dy = y1 - y0, from = 0, to = 1, t;
  if (dy == 0) {
    if (fabs(y0) > r)
      return false;
    t = dz > 0 ? 1 : 0;
  } else {
    double a = (-r - y0) / dy, b = (r - y0) / dy;
    from = fmax(0, fmin(a, b));
    to = fmin(1, fmax(a, b));
    if (from > to)
      return false;
    /* The concave sum is stationary where y / sqrt(r^2 - y^2) = dz / dy. */
    double slope = dz / dy;
    double y = r * slope / sqrt(1 + slope * slope);
    t = fmin(fmax((y - y0) / dy, from), to);
  }
  double y = y0 + t * dy;
  *part = t;
  *reach = z0 + t * dz + sqrt(fmax(0, r * r - y * y));
  return true;
}

static void unit_vector(bw_random *random, double d[3]) {
  double length;
  do {
    for (int k = 0; k < 3; k++)
      d[k] = bw_random_normal(random);
    length = bw_norm(d);
  } while (!(length > 1e-6));
  for (int k = 0; k < 3; k++)
    d[k] /= length;
}

/* A unit vector across d, turned at random. */
static void across(bw_random *random, const double d[3], double b[3]) {
  double other[3], length;
  do {
    unit_vector(random, other);
    bw_cross(d, other, b);
    length = bw_norm(b);
  } while (!(length > 1e-2));
  for (int k = 0; k < 3; k++)
    b[k] /= length;
}

static contact find_contact(const drop_test *test, int64_t drop) {
  const bw_mesh *mesh = test->mesh;
  bw_random random;
  double d[3], b[3], best = -INFINITY;
  double r = test->options.peg_radius;
  contact found = {.peg = {.radius = r}, .node = {-1, -1}};
  bw_random_seed(&random, test->options.seed + (uint64_t)drop * 0x9e3779b97f4a7c15u);
  for (;;) {
    unit_vector(&random, d);
    across(&random, d, b);
    double low = INFINITY, high = -INFINITY;
    for (int32_t i = 0; i < mesh->boundary_node_count; i++) {
      double y = bw_dot(mesh->node + 3 * (size_t)mesh->boundary_node[i], b);
      low = fmin(low, y);
      high = fmax(high, y);
    }
    double axis = low - r + (high - low + 2 * r) * bw_random_uniform(&random);
    for (int32_t f = 0; f < mesh->facet_count; f++)
      for (int k = 0; k < 3; k++) {
        const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
        int32_t i = node[k], j = node[(k + 1) % 3];
        double reach, part;
        if (i > j)
          continue; /* every edge has two facets, one on either side */
        const double *p = mesh->node + 3 * (size_t)i, *q = mesh->node + 3 * (size_t)j;
        double y0 = bw_dot(p, b) - axis, y1 = bw_dot(q, b) - axis;
        if ((y0 > r && y1 > r) || (y0 < -r && y1 < -r))
          continue;
        if (!reach_of_edge(bw_dot(p, d), bw_dot(q, d), y0, y1, r, &reach, &part) || !(reach > best))
          continue;
        best = reach;
        found.node[0] = i;
        found.node[1] = j;
        found.part = part;
        double y = y0 + part * (y1 - y0), c = fmin(1, fmax(-1, y / r)), s = sqrt(1 - c * c);
        found.speed = test->speed * s;
        for (int m = 0; m < 3; m++) {
          found.peg.at[m] = p[m] + part * (q[m] - p[m]);
          found.peg.direction[m] = c * b[m] - s * d[m];
        }
      }
    if (found.node[0] >= 0) { /* else the peg passed between two bodies: again */
      bw_cross(d, b, found.peg.along);
      found.peg.component = mesh->component[found.node[0]];
      return found;
    }
  }
}

/* The mean force of an impulse along the push through a point. */
static double force_at(const drop_test *test, const contact *hit, const double at[3]) {
  const mass_properties *body = &test->body[hit->peg.component];
  double arm[3], turn[3], rate[3];
  for (int k = 0; k < 3; k++)
    arm[k] = at[k] - body->centre[k];
  bw_cross(arm, hit->peg.direction, turn);
  for (int k = 0; k < 3; k++)
    rate[k] = bw_dot(body->inverse_inertia + 3 * k, turn);
  double effective = 1 / (1 / body->mass + bw_dot(turn, rate));
  return 2 * effective * hit->speed / test->options.duration;
}

/* The force on the nodes, and what the result has of it. The resultant is along the push, through
 * the centre of pressure, and its size is that of the impulse there. */
static void apply(const drop_test *test, int64_t drop, const contact *hit, bwi_contact_part *part,
                  double *force) {
  const bw_mesh *mesh = test->mesh;
  double *resultant = test->result->resultant + 3 * drop;
  bwi_contact_patch patch;
  double *fraction =
      force + 2 * (size_t)mesh->node_count; /* read before it is overwritten: 3 i <= 2 n + i */
  memset(force, 0, 3 * (size_t)mesh->node_count * sizeof *force);
  bwi_contact_press(mesh, &hit->peg, force_at(test, hit, hit->peg.at), test->modulus, part,
                    fraction, &patch);
  if (patch.count == 0) { /* nothing faces the peg: the edge that is hit */
    fraction[hit->node[0]] = 1 - hit->part;
    fraction[hit->node[1]] += hit->part;
    memcpy(patch.centre, hit->peg.at, sizeof patch.centre);
  }
  double size = force_at(test, hit, patch.centre);
  test->result->force[drop] = size;
  test->result->area[drop] = patch.area;
  test->result->nodes[drop] = 0;
  memset(resultant, 0, 3 * sizeof *resultant);
  for (int64_t i = 0; i < mesh->node_count; i++) {
    double own = size * fraction[i];
    test->result->nodes[drop] += own != 0;
    for (int k = 0; k < 3; k++) {
      force[3 * i + k] = own * hit->peg.direction[k];
      resultant[k] += force[3 * i + k];
    }
  }
}

static bw_status drop_body(void *data, int64_t begin, int64_t end, int worker) {
  const drop_test *test = (const drop_test *)data;
  for (int64_t i = begin; i < end; i++) {
    int64_t drop = test->first + i;
    contact hit = find_contact(test, drop);
    memcpy(test->result->contact + 3 * drop, hit.peg.at, sizeof hit.peg.at);
    memcpy(test->result->direction + 3 * drop, hit.peg.direction, sizeof hit.peg.direction);
    apply(test, drop, &hit, test->part + worker * test->part_count,
          test->block + (size_t)i * 3 * (size_t)test->mesh->node_count);
  }
  return BW_OK;
}

/* ---- all drops ----------------------------------------------------------------------------- */

/* Where no strength is known: the 97.5th percentile, by volume, of the stresses of the first drops,
 * from a histogram whose bins are 1/64 of an octave wide. */
enum { HISTOGRAM_SHIFT = 46, HISTOGRAM_BINS = 1 << 17 };

static size_t histogram_bin(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return (size_t)(bits >> HISTOGRAM_SHIFT) & (HISTOGRAM_BINS - 1);
}

static double histogram_quantile(const double *histogram, double p) {
  double total = 0, below = 0;
  size_t bin = 0;
  for (size_t i = 0; i < HISTOGRAM_BINS; i++)
    total += histogram[i];
  for (bin = 0; bin < HISTOGRAM_BINS - 1; bin++) {
    below += histogram[bin];
    if (below >= p * total)
      break;
  }
  uint64_t bits = (uint64_t)(bin + 1) << HISTOGRAM_SHIFT;
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* The stresses of drops first..first+count-1; either into the histogram or into the result. */
static bw_status run_drops(drop_test *test, bw_system *system, int64_t count, double *histogram,
                           bw_drop_test_result *result) {
  bw_status status = BW_OK;
  bw_context *context = test->context;
  const bw_mesh *mesh = test->mesh;
  bool known = bw_material_strength(test->material, test->material->axes) > 0;
  BW_TRY(bw_parallel(context, count, 1, drop_body, test));
  BW_TRY(bw_system_solve(context, system, count, test->block, test->block));
  for (int64_t i = 0; i < count; i++) {
    double peak = 0;
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bw_element_stress(context, mesh, test->material,
                             test->block + (size_t)i * 3 * (size_t)mesh->node_count, test->stress));
    BW_TRY(bw_max_principal_field(context, mesh->element_count, test->stress, test->principal));
    if (histogram) {
      for (int32_t e = 0; e < mesh->element_count; e++)
        histogram[histogram_bin(test->principal[e])] += mesh->volume[e];
      continue;
    }
    for (int32_t e = 0; e < mesh->element_count; e++) {
      peak = fmax(peak, test->principal[e]);
      result->mean_peak[e] += test->principal[e];
    }
    result->peak[test->first + i] = peak;
    if (known)
      BW_TRY(bw_utilisation_field(context, test->material, mesh->element_count, test->stress,
                                  test->principal));
    double limit = known ? 1 : result->threshold;
    for (int32_t e = 0; e < mesh->element_count; e++)
      result->exceedance[e] += test->principal[e] > limit;
  }
done:
  return status;
}

static bw_status check_drops(bw_context *context, const bw_system *system,
                             const bw_drop_test_options *options) {
  if (options->drops < 1 || options->drops > 100000000)
    return bw_fail(context, BW_INVALID, "%lld drops were requested: 1 to 100000000 expected",
                   (long long)options->drops);
  if (!(options->height > 0) || !(options->duration > 0) || !(options->peg_radius >= 0) ||
      isinf(options->height) || isinf(options->duration) ||
      isinf(options->peg_radius * options->peg_radius))
    return bw_fail(context, BW_INVALID,
                   "a drop of %g m on a peg of radius %g m for %g s: height and duration must be "
                   "positive, the radius not negative",
                   options->height, options->peg_radius, options->duration);
  for (int32_t i = 0; i < bw_material_part_count(system->material); i++) {
    const bw_material *part = bw_material_part(system->material, i);
    if (!(part->density > 0))
      return bw_fail(context, BW_INVALID,
                     "a drop test needs the density of the material, and %s has none",
                     part->name[0] ? part->name : "this one");
  }
  if (system->dof_map->rigid_mode_count != 6 * system->mesh->component_count)
    return bw_fail(context, BW_INVALID,
                   "a drop test needs a body without supports: of the %d rigid-body modes of this "
                   "model %d are unconstrained; remove the supports",
                   6 * system->mesh->component_count, system->dof_map->rigid_mode_count);
  return BW_OK;
}

bw_status bw_drop_test(bw_context *context, bw_system *system, const bw_drop_test_options *options,
                       bw_drop_test_result *out) {
  bw_status status = BW_OK;
  bw_drop_test_result result = {0};
  double *histogram = NULL;
  drop_test test = {.context = context, .mesh = system->mesh, .material = system->material};
  const bw_mesh *mesh = system->mesh;
  if (options)
    test.options = *options;
  else
    bw_drop_test_options_default(&test.options);
  BW_TRY(check_drops(context, system, &test.options));
  if (test.options.peg_radius == 0) {
    double low[3], high[3];
    bw_mesh_box(mesh, low, high);
    for (int k = 0; k < 3; k++)
      high[k] -= low[k];
    test.options.peg_radius = 0.02 * bw_norm(high);
  }
  test.speed = sqrt(2 * 9.80665 * test.options.height);
  for (int32_t i = 0; i < bw_material_part_count(system->material); i++) {
    const bw_material *part = bw_material_part(system->material, i);
    double bulk = bw_material_bulk(part), shear = bw_material_mean_shear(part);
    test.modulus = fmax(test.modulus, 4 * shear * (3 * bulk + shear) / (3 * bulk + 4 * shear));
  }
  size_t drops = (size_t)test.options.drops, elements = (size_t)mesh->element_count;
  test.body = BW_NEW0(context, mass_properties, mesh->component_count);
  test.block = BW_NEW(context, double, BATCH * 3 * (size_t)mesh->node_count);
  test.stress = BW_NEW(context, double, 6 * elements);
  test.principal = BW_NEW(context, double, elements);
  result.exceedance = BW_NEW0(context, double, elements);
  result.mean_peak = BW_NEW0(context, double, elements);
  result.contact = BW_NEW(context, double, 3 * drops);
  result.force = BW_NEW(context, double, drops);
  result.direction = BW_NEW(context, double, 3 * drops);
  result.resultant = BW_NEW(context, double, 3 * drops);
  result.nodes = BW_NEW(context, int32_t, drops);
  result.area = BW_NEW(context, double, drops);
  test.part_count = bwi_contact_capacity(mesh);
  test.part = BW_NEW(context, bwi_contact_part, test.part_count * bw_threads(context));
  result.peak = BW_NEW(context, double, drops);
  result.drops = test.options.drops;
  BW_TRY_MEMORY(test.body && test.block && test.stress && test.principal && result.exceedance &&
                result.mean_peak && result.contact && result.force && result.direction &&
                result.resultant && result.nodes && result.area && result.peak && test.part);
  test.result = &result;
  BW_TRY(weigh(context, mesh, system->material, test.body));
  if (!(bw_material_strength(system->material, system->material->axes) > 0)) {
    histogram = BW_NEW0(context, double, HISTOGRAM_BINS);
    BW_TRY_MEMORY(histogram);
    int64_t pilot = result.drops < PILOT ? result.drops : PILOT;
    for (test.first = 0; test.first < pilot; test.first += BATCH)
      BW_TRY(run_drops(&test, system, pilot - test.first < BATCH ? pilot - test.first : BATCH,
                       histogram, NULL));
    result.threshold = histogram_quantile(histogram, 0.975);
  }
  for (test.first = 0; test.first < result.drops; test.first += BATCH) {
    int64_t left = result.drops - test.first;
    bw_progress(context, "drop tests", (double)test.first / (double)result.drops);
    BW_TRY(run_drops(&test, system, left < BATCH ? left : BATCH, NULL, &result));
  }
  bw_progress(context, "drop tests", 1);
  for (size_t e = 0; e < elements; e++) {
    result.exceedance[e] /= (double)result.drops;
    result.mean_peak[e] /= (double)result.drops;
  }
done:
  bw_free(test.body);
  bw_free(test.block);
  bw_free(test.stress);
  bw_free(test.principal);
  bw_free(histogram);
  bw_free(test.part);
  if (status == BW_OK)
    *out = result;
  else
    bw_drop_test_result_clear(&result);
  return status;
}
