/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The bodies in contact, apart or joined: their equations, and the motions R that supports and
 * joints leave free. R of bodies apart is in the DOF map, that of joined ones is fields of nodes
 * (docs/theory/contact.md, "Joined bodies"). */
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"
#include "linear/internal.h"
#include "model/internal.h"

bw_status bwi_contact_bodies_open(bw_context *context, bwi_contact_problem *c, bw_system *given) {
  bw_status status = BW_OK;
  const bw_statics_options without = {.inertia_relief = true, .tolerance = 1e-6};
  if (bw_model_joined(c->model)) {
    BW_TRY(bwi_joined_parts_system(context, c->model, c->options->solver, &c->joined, &c->system));
    BW_TRY(bwi_joined_parts_start(context, c->model, c->system, c->joined, &c->start));
    c->motions = c->joined->motions;
  } else {
    BW_TRY(bw_system_of_model(context, c->model, c->options->solver, given, &c->system));
    BW_TRY(bw_statics(context, c->model, c->system, &without, &c->start));
    c->motions = c->system->dof_map->rigid_mode_count;
  }
done:
  return status;
}

/* a = field . v for each of the fields. */
static void dot(const bwi_contact_problem *c, const double *field, const double *v, double *a) {
  int64_t size = bwi_contact_size(c);
  for (int m = 0; m < c->motions; m++)
    a[m] = bwi_dot(size, field + m * size, v);
}

void bwi_contact_motions_dot(const bwi_contact_problem *c, const double *force, double *a) {
  if (c->joined)
    dot(c, c->joined->motion, force, a);
  else
    bw_rigid_modes_dot(c->system->dof_map, force, a);
}

void bwi_contact_motions_measure(const bwi_contact_problem *c, const double *u, double *a) {
  if (c->joined)
    dot(c, c->joined->weighted, u, a);
  else
    bw_rigid_modes_measure(c->system->dof_map, u, a);
}

void bwi_contact_motions_add(const bwi_contact_problem *c, const double *a, double *u) {
  int64_t size = bwi_contact_size(c);
  if (!c->joined)
    bw_rigid_modes_add(c->system->dof_map, a, u);
  for (int m = 0; c->joined && m < c->motions; m++)
    for (int64_t i = 0; i < size; i++)
      u[i] += a[m] * c->joined->motion[m * size + i];
}

/* A motion of joined bodies is one of each that its supports alone leave free. */
bw_status bwi_contact_motions_describe(bw_context *context, const bwi_contact_problem *c,
                                       const double *a, char *text, size_t size) {
  bw_status status = BW_OK;
  const bw_dof_map *dof_map = c->system->dof_map;
  double *u = NULL, *apart = NULL;
  if (!c->joined) {
    bwi_describe_motion(dof_map, a, text, size);
    return BW_OK;
  }
  u = BW_NEW0(context, double, bwi_contact_size(c));
  apart = BW_NEW(context, double, dof_map->rigid_mode_count);
  BW_TRY_MEMORY(u && apart);
  bwi_contact_motions_add(c, a, u);
  bw_rigid_modes_measure(dof_map, u, apart);
  bwi_describe_motion(dof_map, apart, text, size);
done:
  bw_free(u);
  bw_free(apart);
  return status;
}

/* By the model's equations, at the place that contact gives. */
bw_status bwi_contact_bodies_static(bw_context *context, const bwi_contact_problem *c,
                                    const bw_model *loaded, bw_static **out) {
  bw_status status = BW_OK;
  const bw_statics_options options = {.tolerance = 10 * BWI_CONTACT_BALANCED};
  double *a = NULL, *off = NULL;
  if (c->joined)
    return bwi_joined_parts_static(context, loaded, c->joined, c->now, out);
  BW_TRY(bw_statics(context, loaded, c->system, &options, out));
  if (c->motions == 0)
    goto done;
  a = BW_NEW(context, double, c->motions); /* they differ by a rigid-body motion */
  off = BW_NEW(context, double, bwi_contact_size(c));
  BW_TRY_MEMORY(a && off);
  for (int64_t i = 0; i < bwi_contact_size(c); i++)
    off[i] = c->now[i] - (*out)->displacement[i];
  bwi_contact_motions_measure(c, off, a);
  bwi_contact_motions_add(c, a, (*out)->displacement);
done:
  bw_free(a);
  bw_free(off);
  return status;
}
