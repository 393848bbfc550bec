/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Worst loads of few hands: pressure within at most k patches of the boundary
 * (docs/theory/worst_case.md, section 15).
 *
 * Which patches is a combinatorial choice; with the patches given the best pressure is a small
 * linear program. A local search exchanges patches. Multipliers of the small linear program price
 * all other patches, and those that promise most are tried, together with the patches opposite to
 * those at hand. On the way the total force may be smaller than asked for, at a cost: so a set of
 * patches that cannot be in balance has a value as well.
 *
 * Invariant: a set holds distinct centres; `seed` is a set that carries the whole force, so that
 * every objective has an answer. */
#include "analysis/load_program.h"

#include <math.h>
#include <string.h>

enum { CANDIDATES = 10, STEPS = 12, SEEDS = 64, STARTS = 3 };
/* Of the largest gain, what a fraction of the force is worth by itself. */
static const double reward = 10;
static const double facing = -0.5; /* cosine between the normals of opposite patches, at most */
static const double gain = 1e-6, whole = 1e-9;

typedef struct set {
  int32_t centre[BW_MAX_HANDS];
  int size;
  double value;
} set;

struct bwi_hands {
  const bw_pressure_basis *basis;
  const bw_dof_map *dof_map;
  bw_worst_load_options options; /* without hands */
  int count;
  int32_t nodes;   /* that carry pressure */
  double *normal;  /* nodes x 3: mean, unit */
  int64_t *start;  /* nodes + 1 */
  int32_t *member; /* nodes of the patch around each node, ascending */
  double *work;    /* motions x columns */
  set seed;
};

/* Scratch of one search. */
typedef struct bench {
  const bwi_hands *hands;
  bw_context *context;
  const double *objective;  /* columns, the reward included */
  uint8_t *taken;           /* nodes */
  double *score;            /* nodes */
  double *price;            /* nodes: of the patch around each */
  double *dual;             /* motions and one */
  double *given, *pressure; /* columns of the patches' linear program */
} bench;

void bwi_hands_destroy(bwi_hands *hands) {
  if (!hands)
    return;
  bw_free(hands->normal);
  bw_free(hands->start);
  bw_free(hands->member);
  bw_free(hands->work);
  bw_free(hands);
}

static void bench_clear(bench *b) {
  bw_free(b->taken);
  bw_free(b->score);
  bw_free(b->price);
  bw_free(b->dual);
  bw_free(b->given);
  bw_free(b->pressure);
}

/* To be cleared also where it fails. */
static bw_status bench_open(bw_context *context, const bwi_hands *hands, const double *objective,
                            bench *b) {
  size_t columns = (size_t)hands->basis->count, nodes = (size_t)hands->nodes;
  *b = (bench){.hands = hands, .context = context, .objective = objective};
  b->taken = BW_NEW(context, uint8_t, nodes);
  b->score = BW_NEW(context, double, nodes);
  b->price = BW_NEW(context, double, nodes);
  b->dual = BW_NEW(context, double, (size_t)hands->dof_map->rigid_mode_count + 1);
  b->given = BW_NEW(context, double, columns);
  b->pressure = BW_NEW(context, double, columns);
  return b->taken && b->score && b->price && b->dual && b->given && b->pressure ? BW_OK : BW_MEMORY;
}

static const double *place_of(const bwi_hands *h, int32_t node) {
  const bw_pressure_basis *basis = h->basis;
  return basis->mesh->node + 3 * (size_t)basis->node[node * basis->directions];
}

static int32_t body_of(const bwi_hands *h, int32_t node) {
  const bw_pressure_basis *basis = h->basis;
  return basis->mesh->component[basis->node[node * basis->directions]];
}

/* ---- the linear program of given patches ----------------------------------------------------- */

static void take(const bwi_hands *h, const set *s, uint8_t *taken) {
  memset(taken, 0, (size_t)h->nodes);
  for (int i = 0; i < s->size; i++)
    for (int64_t e = h->start[s->centre[i]]; e < h->start[s->centre[i] + 1]; e++)
      taken[h->member[e]] = 1;
}

/* The columns of the nodes taken. */
static bw_status part_of(bw_context *context, const bw_pressure_basis *basis, const uint8_t *taken,
                         bw_pressure_basis **result) {
  bw_status status = BW_OK;
  bw_pressure_basis *part = NULL;
  size_t columns = 0, entries = 0, at = 0;
  for (int32_t j = 0; j < basis->count; j++)
    if (taken[j / basis->directions]) {
      columns++;
      entries += (size_t)(basis->start[j + 1] - basis->start[j]);
    }
  BW_TRY(bwi_pressure_basis_empty(context, basis->mesh, &part));
  part->directions = basis->directions;
  part->node = BW_NEW(context, int32_t, columns);
  part->at = BW_NEW(context, double, 3 * columns);
  part->area = BW_NEW(context, double, columns);
  part->start = BW_NEW0(context, int64_t, columns + 1);
  part->row = BW_NEW(context, int32_t, entries);
  part->coefficient = BW_NEW(context, double, 3 * entries);
  BW_TRY_MEMORY(part->node && part->at && part->area && part->start && part->row &&
                part->coefficient);
  for (int32_t j = 0; j < basis->count; j++) {
    if (!taken[j / basis->directions])
      continue;
    size_t size = (size_t)(basis->start[j + 1] - basis->start[j]);
    part->node[part->count] = basis->node[j];
    memcpy(part->at + 3 * (size_t)part->count, basis->at + 3 * (size_t)j, 3 * sizeof *part->at);
    part->area[part->count] = basis->area[j];
    part->start[part->count++] = (int64_t)at;
    memcpy(part->row + at, basis->row + basis->start[j], size * sizeof *part->row);
    memcpy(part->coefficient + 3 * at, basis->coefficient + 3 * basis->start[j],
           3 * size * sizeof *part->coefficient);
    at += size;
  }
  part->start[part->count] = (int64_t)at;
done:
  if (status == BW_OK)
    *result = part;
  else
    bw_release(part);
  return status;
}

/* The best pressure within a set, for b->pressure's first columns; s->value. */
static bw_status solve(bench *b, const bw_worst_load_options *options, const double *objective,
                       set *s) {
  const bwi_hands *h = b->hands;
  bw_status status = BW_OK;
  bw_pressure_basis *part = NULL;
  take(h, s, b->taken);
  BW_TRY(part_of(b->context, h->basis, b->taken, &part));
  int32_t to = 0;
  for (int32_t j = 0; j < h->basis->count; j++)
    if (b->taken[j / h->basis->directions])
      b->given[to++] = objective[j];
  BW_TRY(bw_worst_loads(b->context, part, h->dof_map, options, 1, b->given, b->pressure, &s->value,
                        b->dual, NULL));
done:
  bw_release(part);
  return status;
}

/* With a total force that may be smaller: what a set is worth to the search. */
static bw_status evaluate_set(bench *b, set *s) {
  bw_worst_load_options options = b->hands->options;
  options.force_is_max = true;
  return solve(b, &options, b->objective, s);
}

/* ---- the search ------------------------------------------------------------------------------ */

static bool holds(const set *s, int32_t centre) {
  for (int i = 0; i < s->size; i++)
    if (s->centre[i] == centre)
      return true;
  return false;
}

/* What multipliers promise of the nodes that no patch of the set has. */
static void price_patches(bench *b, const double *objective, const double *dual) {
  const bwi_hands *h = b->hands;
  const bw_pressure_basis *basis = h->basis;
  int32_t motions = h->dof_map->rigid_mode_count;
  for (int32_t g = 0; g < h->nodes; g++) {
    double max = 0;
    for (int32_t j = g * basis->directions; j < (g + 1) * basis->directions; j++) {
      double d = objective[j] - dual[motions] * basis->area[j];
      for (int32_t m = 0; m < motions; m++)
        d -= dual[m] * h->work[(size_t)m * (size_t)basis->count + (size_t)j];
      max = fmax(max, d);
    }
    b->score[g] = b->taken[g] ? 0 : max;
  }
  for (int32_t g = 0; g < h->nodes; g++) {
    b->price[g] = 0;
    for (int64_t e = h->start[g]; e < h->start[g + 1]; e++)
      b->price[g] += b->score[h->member[e]];
  }
}

/* The patch of the highest price; its nodes, and their centres, are worth nothing afterwards. */
static int32_t next_patch(bench *b) {
  const bwi_hands *h = b->hands;
  int32_t best = 0;
  for (int32_t g = 1; g < h->nodes; g++)
    if (b->price[g] > b->price[best])
      best = g;
  if (!(b->price[best] > 0))
    return -1;
  for (int64_t e = h->start[best]; e < h->start[best + 1]; e++)
    b->price[h->member[e]] = 0;
  return best;
}

/* The patch that faces a patch's push: nearest to the line along its normal. */
static int32_t opposite(const bwi_hands *h, int32_t centre) {
  const double *x = place_of(h, centre), *n = h->normal + 3 * (size_t)centre;
  int32_t best = -1;
  double min = INFINITY;
  for (int32_t g = 0; g < h->nodes; g++) {
    const double *y = place_of(h, g);
    double d[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]}, off[3];
    if (body_of(h, g) != body_of(h, centre) || bw_dot(n, h->normal + 3 * (size_t)g) > facing ||
        bw_dot(d, n) > 0)
      continue;
    bw_cross(d, n, off);
    if (bw_norm(off) < min) {
      min = bw_norm(off);
      best = g;
    }
  }
  return best;
}

static int candidates(bench *b, const set *s, int32_t *list) {
  int count = 0;
  take(b->hands, s, b->taken);
  price_patches(b, b->objective, b->dual);
  while (count < CANDIDATES) {
    int32_t c = next_patch(b);
    if (c < 0)
      break;
    list[count++] = c;
  }
  for (int i = 0; i < s->size; i++) {
    int32_t c = opposite(b->hands, s->centre[i]);
    if (c >= 0)
      list[count++] = c;
  }
  return count;
}

/* Patches are added or exchanged while the value grows. */
static bw_status improve(bench *b, set *s) {
  bw_status status = BW_OK;
  int32_t list[CANDIDATES + BW_MAX_HANDS];
  BW_TRY(evaluate_set(b, s));
  for (int step = 0; step < STEPS; step++) {
    set best = *s;
    int count = candidates(b, s, list);
    BW_TRY(bw_check_cancel(b->context));
    for (int i = 0; i < count; i++) {
      if (holds(s, list[i]))
        continue;
      /* At the end where there is room, else in the place of each in turn. */
      int from = s->size < b->hands->count ? s->size : 0;
      int to = s->size < b->hands->count ? s->size + 1 : s->size;
      for (int k = from; k < to; k++) {
        set tried = *s;
        tried.centre[k] = list[i];
        tried.size = s->size > k ? s->size : k + 1;
        BW_TRY(evaluate_set(b, &tried));
        if (tried.value > best.value)
          best = tried;
      }
    }
    if (!(best.value > s->value + gain * fabs(s->value)))
      break;
    *s = best;
    BW_TRY(evaluate_set(b, s)); /* its multipliers */
  }
done:
  return status;
}

/* Centres by price, each the best of what is left. */
static void choose_by_price(bench *b, set *s) {
  for (s->size = 0; s->size < b->hands->count;) {
    int32_t c = next_patch(b);
    if (c < 0)
      break;
    s->centre[s->size++] = c;
  }
}

/* A set by the force that a pressure has in each patch. */
static void choose_by_force(bench *b, const double *pressure, set *s) {
  const bwi_hands *h = b->hands;
  const bw_pressure_basis *basis = h->basis;
  memset(b->score, 0, (size_t)h->nodes * sizeof *b->score);
  for (int32_t j = 0; j < basis->count; j++)
    b->score[j / basis->directions] += pressure[j] * basis->area[j];
  for (s->size = 0; s->size < h->count; s->size++) {
    int32_t best = -1;
    double max = 0;
    for (int32_t g = 0; g < h->nodes; g++) {
      double sum = 0;
      for (int64_t e = h->start[g]; e < h->start[g + 1]; e++)
        sum += b->score[h->member[e]];
      if (sum > max) {
        max = sum;
        best = g;
      }
    }
    if (best < 0)
      break;
    s->centre[s->size] = best;
    for (int64_t e = h->start[best]; e < h->start[best + 1]; e++)
      b->score[h->member[e]] = 0;
  }
}

/* ---- the whole ------------------------------------------------------------------------------- */

/* A set that carries the whole force. */
static bw_status find_seed(bw_context *context, bwi_hands *h) {
  bw_status status = BW_OK;
  bench b = {0};
  double force = h->options.force, max = 0;
  BW_TRY(bench_open(context, h, h->basis->area, &b)); /* the objective is the total force */
  int32_t starts = h->nodes < SEEDS ? h->nodes : SEEDS;
  for (int32_t i = 0; i < starts; i++) {
    set s = {{(int32_t)((int64_t)i * h->nodes / starts)}, 1, 0};
    BW_TRY(improve(&b, &s));
    if (s.value > max) {
      max = s.value;
      h->seed = s;
    }
    if (h->options.force_is_max || max >= force * (1 - whole))
      break;
  }
  if (!h->options.force_is_max && max < force * (1 - whole)) {
    status = bw_fail(context, BW_INFEASIBLE,
                     "no load of %d hands was found that is in balance and amounts to %g N: the "
                     "largest that was found amounts to %g N. Give more or larger hands, fix the "
                     "part, or let the force be smaller (force_is_max)",
                     h->count, force, max);
    bw_detail_number(context, "force", force);
    bw_detail_number(context, "largest_force", max);
  }
done:
  bench_clear(&b);
  return status;
}

bw_status bwi_hands_create(bw_context *context, const bw_pressure_basis *basis,
                           const bw_dof_map *dof_map, const bw_worst_load_options *options,
                           bwi_hands **result) {
  bw_status status = BW_OK;
  if (options->hands < 0 || options->hands > BW_MAX_HANDS)
    return bw_fail(context, BW_INVALID, "%d hands: give from 1 to %d", options->hands,
                   BW_MAX_HANDS);
  if (!(options->hand_area > 0) || isinf(options->hand_area))
    return bw_fail(context, BW_INVALID, "a hand of %g m2: its area must be positive",
                   options->hand_area);
  bwi_hands *h = BW_NEW0(context, bwi_hands, 1);
  if (!h)
    return BW_MEMORY;
  h->basis = basis;
  h->dof_map = dof_map;
  h->options = *options;
  h->options.hands = 0;
  h->count = options->hands;
  h->nodes = basis->count / basis->directions;
  h->normal = BW_NEW(context, double, 3 * (size_t)h->nodes);
  h->start = BW_NEW0(context, int64_t, (size_t)h->nodes + 1);
  h->work = BW_NEW(context, double, (size_t)dof_map->rigid_mode_count *(size_t)basis->count + 1);
  BW_TRY_MEMORY(h->normal && h->start && h->work);
  bwi_column_motions(basis, dof_map, h->work);
  BW_TRY(bwi_hand_patches(context, basis, sqrt(options->hand_area / 3.14159265358979323846),
                          h->normal, h->start, &h->member));
  BW_TRY(find_seed(context, h));
done:
  if (status == BW_OK)
    *result = h;
  else
    bwi_hands_destroy(h);
  return status;
}

/* The pressure of the last linear program, spread over all columns. */
static void spread(const bench *b, double *pressure) {
  int32_t from = 0;
  for (int32_t j = 0; j < b->hands->basis->count; j++)
    pressure[j] = b->taken[j / b->hands->basis->directions] ? b->pressure[from++] : 0;
}

bw_status bwi_hands_solve(bw_context *context, const bwi_hands *h, const double *objective,
                          const double *dual, double *pressure, double *value) {
  bw_status status = BW_OK;
  bench b = {0};
  set start[STARTS];
  size_t n = (size_t)h->basis->count;
  double largest = 0;
  double *rewarded = BW_NEW(context, double, n);
  BW_TRY_MEMORY(rewarded);
  for (size_t j = 0; j < n; j++)
    largest = fmax(largest, fabs(objective[j] / h->basis->area[j]));
  double bonus = h->options.force_is_max ? 0 : reward * largest;
  for (size_t j = 0; j < n; j++)
    rewarded[j] = objective[j] + bonus * h->basis->area[j];
  BW_TRY(bench_open(context, h, rewarded, &b));
  choose_by_force(&b, pressure, &start[0]);
  memset(b.taken, 0, (size_t)h->nodes);
  price_patches(&b, objective, dual);
  choose_by_price(&b, &start[1]);
  start[2] = h->seed;
  set best = h->seed;
  bool found = false;
  for (int i = 0; i < STARTS; i++) {
    if (start[i].size == 0)
      continue;
    BW_TRY(improve(&b, &start[i]));
    if (!found || start[i].value > best.value)
      best = start[i];
    found = true;
  }
  status = solve(&b, &h->options, objective, &best);
  if (status == BW_INFEASIBLE) {
    best = h->seed;
    status = solve(&b, &h->options, objective, &best);
  }
  if (status != BW_OK)
    goto done;
  spread(&b, pressure);
  *value = best.value;
done:
  bench_clear(&b);
  bw_free(rewarded);
  return status;
}
