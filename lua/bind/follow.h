/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the bodies that follow an outline (sheets, plates, flows) share in Lua: options of meshes
 * and mesh motions, and the table of a frame, which holds reuse statistics. A box holds the body
 * and, as its second reference, the mesh motion of its mesh. Every call that belongs to a frame
 * gets the frame's table as argument 2, adds to it, and returns it. */
#ifndef LBW_FOLLOW_H
#define LBW_FOLLOW_H

#include "bind.h"

/* bw_plane_options and bw_follow_options from tables. */
void lbw_read_fill(lua_State *L, int index, const char *function, bw_plane_options *fill);
/* Raises where the number of elements is given beside what `size` names, which decides it too. */
void lbw_check_one_size(lua_State *L, int index, const char *function, const char *size);
void lbw_read_follow(lua_State *L, int index, const char *function, bw_follow_options *follow);
/* {solver =, max_lag =} over the defaults that are there. */
void lbw_read_lagged_factor(lua_State *L, int index, const char *function,
                            bw_lagged_factor_options *options);

/* What former calls wrote into the frame at `index`. */
void lbw_load_plane_reuse(lua_State *L, int index, bw_plane_reuse *reuse);
/* lbw_leave with the frame as the result, `reuse` written into it. */
int lbw_leave_frame(lua_State *L, const lbw_class *class, bw_status status,
                    const bw_plane_reuse *reuse);
/* Fills the outline, puts a mesh motion on the mesh and what `create` makes of `description` beside
 * it into a new box, which is the result. `conditions`: the stack's place of what the box is to
 * keep of them; 0: there are none. */
typedef bw_status lbw_create_function(bw_context *context, const bw_plane_mesh *mesh,
                                      const void *description, void **body);
int lbw_follow_create(lua_State *L, const lbw_class *class, const bw_outline *outline,
                      const bw_follow_options *follow, int conditions, lbw_create_function *create,
                      const void *description);
/* How a body of a class goes over to the mesh that its mesh motion made, and what it is at is kept
 * and returned to. */
typedef struct lbw_followed {
  const lbw_class *class;
  bw_status (*follow)(bw_context *context, void *body, const bw_plane_mesh *mesh,
                      bw_plane_reuse *reuse);
  const void *(*keep)(const void *body);
  bw_status (*restore)(bw_context *context, void *body, const void *state);
  bw_status (*check)(bw_context *context, const void *body);
  const bw_plane_mesh *(*mesh)(const void *body);
} lbw_followed;
/* body:follow(frame, outline): mesh motion and body go over to an outline, both or neither. */
int lbw_follow(lua_State *L, const lbw_followed *followed);
/* body:save(): what mesh motion and body are at; body:restore(state): both are so again.
 * Returning fails only for the state of a body that was made otherwise. */
int lbw_followed_keep(lua_State *L, const lbw_followed *followed);
int lbw_followed_return(lua_State *L, const lbw_followed *followed);
/* body:check(): itself, where mesh motion and body and their parts belong together; raises
 * otherwise. */
int lbw_followed_check(lua_State *L, const lbw_followed *followed);
void lbw_open_follow(lua_State *L);

#endif
