/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the bindings of nonlinear solids share. */
#ifndef LBW_SOLID_H
#define LBW_SOLID_H

#include "bind.h"

extern const lbw_class lbw_solid_material_class, lbw_material_table_class, lbw_solid_class,
    lbw_load_case_class, lbw_solid_static_class, lbw_solid_transient_class, lbw_library_class,
    lbw_coarse_class, lbw_coarsening_class;

/* A material table from the list of materials at `index`; its box is pushed. */
bw_material_table *lbw_read_material_table(lua_State *L, int index, const char *function);
/* The same, or a material table that is one already (nothing made; pushed again). */
const bw_material_table *lbw_check_material_table(lua_State *L, int index, const char *function);
/* Displacements (node_count x 3) from the array at `index`, packed in a userdata that is pushed;
 * NULL (and nil pushed) for none. */
double *lbw_read_displacement(lua_State *L, int index, const char *what, const bw_grid *grid);
/* {iterations =, residual =, seconds =, history = ...}, pushed. */
void lbw_push_newton_report(lua_State *L, const bw_newton_report *report);
/* {min_ratio =, worst_element =, inverted =, defined =}, pushed. */
void lbw_push_solid_shape(lua_State *L, const bw_solid_shape *shape);

#endif
