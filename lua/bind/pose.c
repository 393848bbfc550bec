/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Poses of a skeleton: maps of the bones, posed nodes, motions of stiffness subdomains, inverse
 * kinematics.
 *
 * A pose is an array or table with a row of 15 numbers for every bone: the rotation by rows, the
 * scale along the bone's axes, the translation of its head. Maps are rows of 12: [A | b] by rows.
 * Motions are rows of 19: linear part, frame, and 1 where the stiffness subdomain was reshaped. */
#include "bind.h"

#include <string.h>

enum { POSE = 15, MAP = 12, ROTATION = 9, MOTION = 19 };

static const bw_skeleton *check_skeleton(lua_State *L, int argument) {
  return (const bw_skeleton *)lbw_check(L, argument, &lbw_skeleton_class);
}

static const bw_subdomains *check_subdomains(lua_State *L, int argument) {
  return (const bw_subdomains *)lbw_check(L, argument, &lbw_subdomains_class);
}

/* Rows of `columns` numbers for every bone, in a userdata that is pushed. */
static double *bone_rows(lua_State *L, int argument, const char *what, int32_t bones,
                         int64_t columns) {
  int64_t rows;
  double *data = lbw_to_doubles(L, argument, what, columns, &rows);
  lbw_check_rows(L, argument, what, rows, bones, "bone");
  return data;
}

/* The pose at `argument` as the engine's structs, in a userdata that is pushed. */
static bw_bone_pose *read_pose(lua_State *L, int argument, const bw_skeleton *skeleton) {
  double *row = bone_rows(L, argument, "pose", skeleton->bone_count, POSE);
  bw_bone_pose *pose =
      (bw_bone_pose *)lua_newuserdatauv(L, ((size_t)skeleton->bone_count + 1) * sizeof *pose, 0);
  for (int32_t b = 0; b < skeleton->bone_count; b++, row += POSE) {
    memcpy(pose[b].rotation, row, sizeof pose[b].rotation);
    memcpy(pose[b].scale, row + 9, sizeof pose[b].scale);
    memcpy(pose[b].translation, row + 12, sizeof pose[b].translation);
  }
  return pose;
}

static void push_pose(lua_State *L, int32_t bones, const bw_bone_pose *pose) {
  double *row = (double *)lbw_push_array(L, BW_F64, bones, POSE)->data;
  for (int32_t b = 0; b < bones; b++, row += POSE) {
    memcpy(row, pose[b].rotation, sizeof pose[b].rotation);
    memcpy(row + 9, pose[b].scale, sizeof pose[b].scale);
    memcpy(row + 12, pose[b].translation, sizeof pose[b].translation);
  }
}

/* skeleton:rest_pose() */
static int skeleton_rest_pose(lua_State *L) {
  const bw_skeleton *skeleton = check_skeleton(L, 1);
  bw_bone_pose rest;
  bw_bone_pose_rest(&rest);
  bw_bone_pose *pose =
      (bw_bone_pose *)lua_newuserdatauv(L, ((size_t)skeleton->bone_count + 1) * sizeof *pose, 0);
  for (int32_t b = 0; b < skeleton->bone_count; b++)
    pose[b] = rest;
  push_pose(L, skeleton->bone_count, pose);
  return 1;
}

/* skeleton:pose_maps(pose): maps, rotations */
static int skeleton_pose_maps(lua_State *L) {
  const bw_skeleton *skeleton = check_skeleton(L, 1);
  bw_bone_pose *pose = read_pose(L, 2, skeleton);
  double *map = (double *)lbw_push_array(L, BW_F64, skeleton->bone_count, MAP)->data;
  double *rotation = (double *)lbw_push_array(L, BW_F64, skeleton->bone_count, ROTATION)->data;
  return lbw_leave(L, bw_pose_maps(lbw_enter(L), skeleton, pose, map, rotation), 2);
}

/* skeleton:posed_joints(maps) */
static int skeleton_posed_joints(lua_State *L) {
  const bw_skeleton *skeleton = check_skeleton(L, 1);
  double *map = bone_rows(L, 2, "maps", skeleton->bone_count, MAP);
  double *joint = (double *)lbw_push_array(L, BW_F64, skeleton->joint_count, 3)->data;
  bw_pose_joints(skeleton, map, joint);
  return 1;
}

/* subdomains:posed_nodes(maps) */
static int subdomains_posed_nodes(lua_State *L) {
  const bw_subdomains *subdomains = check_subdomains(L, 1);
  double *map = bone_rows(L, 2, "maps", subdomains->skeleton->bone_count, MAP);
  double *node = (double *)lbw_push_array(L, BW_F64, subdomains->mesh->node_count, 3)->data;
  return lbw_leave(L, bw_pose_nodes(lbw_enter(L), subdomains, map, node), 1);
}

/* subdomains:posed_surface(maps, surface, tolerance or nil): surface, how far a point moved at most
 */
static int subdomains_posed_surface(lua_State *L) {
  const bw_subdomains *subdomains = check_subdomains(L, 1);
  lua_settop(L, 4);
  double *map = bone_rows(L, 2, "maps", subdomains->skeleton->bone_count, MAP);
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 3, &lbw_surface_class);
  double tolerance = lua_isnil(L, 4) ? 0 : lbw_check_real(L, 4, "tolerance"), moved = 0;
  lbw_box *box = lbw_box_new(L, &lbw_surface_class);
  bw_surface *posed = NULL;
  bw_status status =
      bw_pose_surface(lbw_enter(L), subdomains, map, surface, tolerance, &posed, &moved);
  lbw_box_fill(L, box, posed);
  lua_pushnumber(L, moved);
  return lbw_leave(L, status, 2);
}

/* subdomains:pose_derivative(pose, bone, axis): of every node by the scale of a bone along its
 * axis */
static int subdomains_pose_derivative(lua_State *L) {
  const bw_subdomains *subdomains = check_subdomains(L, 1);
  bw_bone_pose *pose = read_pose(L, 2, subdomains->skeleton);
  int32_t bone = lbw_check_bone(L, 3, subdomains->skeleton);
  int axis = lbw_check_axis(L, 4);
  double *out = (double *)lbw_push_array(L, BW_F64, subdomains->mesh->node_count, 3)->data;
  return lbw_leave(L, bw_pose_derivative(lbw_enter(L), subdomains, pose, bone, axis, out), 1);
}

/* subdomains:motion(maps, rotations): a row of 19 for every stiffness subdomain */
static int subdomains_motion(lua_State *L) {
  const bw_subdomains *subdomains = check_subdomains(L, 1);
  double *map = bone_rows(L, 2, "maps", subdomains->skeleton->bone_count, MAP);
  double *rotation = bone_rows(L, 3, "rotations", subdomains->skeleton->bone_count, ROTATION);
  bw_subdomain_motion *motion = (bw_subdomain_motion *)lua_newuserdatauv(
      L, ((size_t)subdomains->stiffness.count + 1) * sizeof *motion, 0);
  double *row = (double *)lbw_push_array(L, BW_F64, subdomains->stiffness.count, MOTION)->data;
  bw_status status = bw_pose_motion(lbw_enter(L), subdomains, map, rotation, motion);
  if (status == BW_OK)
    for (int32_t p = 0; p < subdomains->stiffness.count; p++, row += MOTION) {
      memcpy(row, motion[p].linear, sizeof motion[p].linear);
      memcpy(row + 9, motion[p].frame, sizeof motion[p].frame);
      row[18] = motion[p].reshaped;
    }
  return lbw_leave(L, status, 1);
}

bw_subdomain_motion *lbw_read_motion(lua_State *L, int argument, int32_t count) {
  int64_t rows;
  double *row = lbw_to_doubles(L, argument, "motion", MOTION, &rows);
  lbw_check_rows(L, argument, "motion", rows, count, "stiffness subdomain");
  bw_subdomain_motion *motion =
      (bw_subdomain_motion *)lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *motion, 0);
  for (int32_t d = 0; d < count; d++, row += MOTION) {
    memcpy(motion[d].linear, row, sizeof motion[d].linear);
    memcpy(motion[d].frame, row + 9, sizeof motion[d].frame);
    motion[d].reshaped = row[18] != 0;
  }
  return motion;
}

/* ---- inverse kinematics ---------------------------------------------------------------------- */

/* {{bone =, at =, along =, weight =, from = the first bone of the chain}, ...} */
static bw_reach_target *read_targets(lua_State *L, int index, const bw_skeleton *skeleton,
                                     int *count) {
  static const lbw_option list[] = {{"bone", LBW_OTHER, 0},
                                    {"from", LBW_OTHER, 0},
                                    {"at", LBW_VECTOR, offsetof(bw_reach_target, at)},
                                    {"along", LBW_REAL, offsetof(bw_reach_target, along)},
                                    {"weight", LBW_REAL, offsetof(bw_reach_target, weight)},
                                    {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, index, LUA_TTABLE);
  size_t length = lua_rawlen(L, index);
  if (length < 1 || length > 10000)
    lbw_error(L, "reach: a list of 1 to 10000 targets expected, got %I", (LUAI_UACINT)length);
  bw_reach_target *target = (bw_reach_target *)lua_newuserdatauv(L, length * sizeof *target, 0);
  for (size_t i = 0; i < length; i++) {
    target[i] = (bw_reach_target){.along = 1, .weight = 1, .chain_from = -1};
    lua_rawgeti(L, index, (lua_Integer)i + 1);
    lbw_check_type(L, -1, LUA_TTABLE);
    int at = lua_gettop(L);
    lbw_options(L, at, "reach", list, &target[i]);
    lbw_option_get(L, at, "bone");
    target[i].bone = lbw_check_bone(L, at + 1, skeleton);
    if (lbw_option_get(L, at, "from") != LUA_TNIL)
      target[i].chain_from = lbw_check_bone(L, at + 2, skeleton);
    if (lbw_option_get(L, at, "at") == LUA_TNIL)
      lbw_error(L, "reach: target %d: 'at' is missing", (int)i + 1);
    lua_settop(L, at - 1);
  }
  *count = (int)length;
  return target;
}

/* A list of {swing, twist_min, twist_max} in radians, or false, for every bone, in a userdata that
 * is pushed. */
static bw_joint_limit *read_limits(lua_State *L, int index, const bw_skeleton *skeleton) {
  static const lbw_option list[] = {{"swing", LBW_REAL, offsetof(bw_joint_limit, swing)},
                                    {"twist_min", LBW_REAL, offsetof(bw_joint_limit, twist_min)},
                                    {"twist_max", LBW_REAL, offsetof(bw_joint_limit, twist_max)},
                                    {NULL, LBW_OTHER, 0}};
  lbw_check_type(L, index, LUA_TTABLE);
  lbw_check_rows(L, index, "limits", (int64_t)lua_rawlen(L, index), skeleton->bone_count, "bone");
  bw_joint_limit *limit =
      (bw_joint_limit *)lua_newuserdatauv(L, ((size_t)skeleton->bone_count + 1) * sizeof *limit, 0);
  for (int32_t b = 0; b < skeleton->bone_count; b++) {
    bw_joint_limit_none(&limit[b]);
    lua_rawgeti(L, index, b + 1);
    if (lua_toboolean(L, -1))
      lbw_options(L, -1, "reach: limit", list, &limit[b]);
    lua_pop(L, 1);
  }
  return limit;
}

/* skeleton:reach(pose, targets, limits or nil, tolerance): pose, {distance, iterations, reached} */
static int skeleton_reach(lua_State *L) {
  const bw_skeleton *skeleton = check_skeleton(L, 1);
  lua_settop(L, 5);
  bw_bone_pose *pose = read_pose(L, 2, skeleton);
  int count;
  bw_reach_target *target = read_targets(L, 3, skeleton, &count);
  bw_joint_limit *limit = lua_isnil(L, 4) ? NULL : read_limits(L, 4, skeleton);
  double tolerance = lua_isnil(L, 5) ? 0 : lbw_check_real(L, 5, "tolerance");
  bw_reach_report report = {0};
  bw_status status =
      bw_pose_reach(lbw_enter(L), skeleton, limit, count, target, tolerance, pose, &report);
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  lbw_leave_or_raise(L, BW_OK);
  push_pose(L, skeleton->bone_count, pose);
  lua_createtable(L, 0, 3);
  lua_pushnumber(L, report.distance);
  lua_setfield(L, -2, "distance");
  lua_pushinteger(L, report.iterations);
  lua_setfield(L, -2, "iterations");
  lua_pushboolean(L, report.reached);
  lua_setfield(L, -2, "reached");
  return 2;
}

void lbw_open_pose(lua_State *L) {
  static const luaL_Reg of_skeleton[] = {{"rest_pose", skeleton_rest_pose},
                                         {"pose_maps", skeleton_pose_maps},
                                         {"posed_joints", skeleton_posed_joints},
                                         {"reach", skeleton_reach},
                                         {NULL, NULL}};
  static const luaL_Reg of_subdomains[] = {{"posed_nodes", subdomains_posed_nodes},
                                           {"posed_surface", subdomains_posed_surface},
                                           {"pose_derivative", subdomains_pose_derivative},
                                           {"motion", subdomains_motion},
                                           {NULL, NULL}};
  lbw_add_methods(L, &lbw_skeleton_class, of_skeleton);
  lbw_add_methods(L, &lbw_subdomains_class, of_subdomains);
}
