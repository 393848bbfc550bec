/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conditions by tag (prescribed values, tractions, pressures) from Lua, and the size of a mesh
 * where it changes from place to place. */
#ifndef LBW_CONDITION_H
#define LBW_CONDITION_H

#include "bind.h"
#include "formula/expression.h"

typedef struct lbw_conditions lbw_conditions;
/* Reads the list at `index`, {{tag = name (nil: everywhere), kind = "prescribed" | "traction" |
 * "pressure" | "convection", component = from 1, value = , coefficient = of convection, order = of
 * prescribed values that conflict}}, into a userdata that is pushed. Raises for what is none,
 * naming the nearest tag. A last one of kind "size" is no condition but the wanted length of edges.
 */
lbw_conditions *lbw_conditions_read(lua_State *L, int index, const char *what,
                                    const bw_outline *outline);
const bw_condition *lbw_conditions_list(const lbw_conditions *all, int32_t *count);
/* `fill` gets the size field, where there is one. */
void lbw_conditions_size(const lbw_conditions *all, bw_plane_options *fill);
/* The box keeps the userdata as its user value. */
void lbw_conditions_keep(lua_State *L, int box, int conditions);
/* Before lbw_enter of a call that may ask for values: puts the functions on the stack. The caller
 * returns values above them. */
void lbw_conditions_begin(lua_State *L, int box);

#endif
