/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Between array.c and array_operations.c. */
#ifndef LBW_ARRAY_H
#define LBW_ARRAY_H

#include "bind.h"

const char *lbw_type_word(bw_type type);
void lbw_push_number(lua_State *L, const bw_array *array, int64_t row, int64_t column);
int lbw_push_view(lua_State *L, const bw_array *array, int64_t first_row, int64_t rows,
                  int64_t row_step, int64_t first_column, int64_t columns, int64_t column_step);
/* Adds reduce, map, gather and the operators to the registered class. */
void lbw_add_array_operations(lua_State *L);
/* Adds array.map to the table on the top. */
void lbw_add_array_functions(lua_State *L);

#endif
