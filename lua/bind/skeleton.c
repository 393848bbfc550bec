/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* bw.skeleton: trees of joints and bones: making, reading, writing, changing, views. Joints and
 * bones are given by name, or by number from 1. */
#include "bind.h"

#include <stdio.h>
#include <string.h>

static const bw_skeleton *self(lua_State *L) {
  return (const bw_skeleton *)lbw_check(L, 1, &lbw_skeleton_class);
}

/* ---- names ----------------------------------------------------------------------------------- */

static int32_t check_named(lua_State *L, int argument, const char *what, int32_t count,
                           const bw_name *name) {
  if (lua_type(L, argument) != LUA_TSTRING)
    return (int32_t)lbw_check_index(L, argument, what, count);
  const char *wanted = lua_tostring(L, argument);
  for (int32_t i = 0; i < count; i++)
    if (strcmp(name[i].text, wanted) == 0)
      return i;
  const char **candidate =
      (const char **)lua_newuserdatauv(L, ((size_t)count + 1) * sizeof *candidate, 0);
  for (int32_t i = 0; i < count; i++)
    candidate[i] = name[i].text;
  return lbw_error(L, "there is no %s '%s': %s", what, wanted,
                   lbw_suggestion(L, wanted, candidate, (size_t)count));
}

int32_t lbw_check_bone(lua_State *L, int argument, const bw_skeleton *skeleton) {
  return check_named(L, argument, "bone", skeleton->bone_count, skeleton->bone_name);
}

int32_t lbw_check_joint(lua_State *L, int argument, const bw_skeleton *skeleton) {
  return check_named(L, argument, "joint", skeleton->joint_count, skeleton->joint_name);
}

/* A list of `count` names (false where there is none) into a userdata that is pushed, or NULL. */
static bw_name *read_names(lua_State *L, int index, const char *what, int64_t count) {
  if (lua_isnoneornil(L, index)) {
    lua_pushnil(L);
    return NULL;
  }
  lbw_check_type(L, index, LUA_TTABLE);
  bw_name *name = (bw_name *)lua_newuserdatauv(L, (size_t)(count + 1) * sizeof *name, 0);
  memset(name, 0, (size_t)count * sizeof *name);
  for (int64_t i = 0; i < count; i++) {
    lua_rawgeti(L, index, i + 1);
    if (lua_toboolean(L, -1))
      lbw_read_name(L, -1, what, &name[i]);
    lua_pop(L, 1);
  }
  return name;
}

/* ---- making, reading, writing ---------------------------------------------------------------- */

/* skeleton.make(joints, bones, joint names, bone names, root): what skeleton.create is over */
static int skeleton_make(lua_State *L) {
  int64_t joints, bones;
  lua_settop(L, 5);
  double *joint = lbw_to_doubles(L, 1, "skeleton: joints", 3, &joints);
  int32_t *bone = lbw_to_indices(L, 2, "skeleton: bones", 2, &bones);
  bw_name *joint_name = read_names(L, 3, "skeleton: joints", joints);
  bw_name *bone_name = read_names(L, 4, "skeleton: bones", bones);
  int32_t root = lua_isnil(L, 5) ? -1 : (int32_t)lbw_check_index(L, 5, "skeleton: root", joints);
  lbw_box *box = lbw_box_new(L, &lbw_skeleton_class);
  bw_skeleton *out = NULL;
  bw_status status = bw_skeleton_create(lbw_enter(L), joints, joint, joint_name, bones, bone,
                                        bone_name, root, &out);
  return lbw_leave_object(L, box, out, status);
}

/* skeleton.extract(surface, {bones, prune, bend, minutes}) */
static int skeleton_extract(lua_State *L) {
  static const lbw_option list[] = {{"bones", LBW_INT, offsetof(bw_skeleton_options, bones)},
                                    {"prune", LBW_REAL, offsetof(bw_skeleton_options, prune)},
                                    {"bend", LBW_REAL, offsetof(bw_skeleton_options, bend)},
                                    {"minutes", LBW_REAL, offsetof(bw_skeleton_options, minutes)},
                                    {NULL, LBW_OTHER, 0}};
  const bw_surface *surface = (const bw_surface *)lbw_check(L, 1, &lbw_surface_class);
  bw_skeleton_options options;
  bw_skeleton_options_default(&options);
  lbw_options(L, 2, "skeleton.extract", list, &options);
  lbw_box *box = lbw_box_new(L, &lbw_skeleton_class);
  bw_skeleton *out = NULL;
  bw_status status = bw_skeleton_extract(lbw_enter(L), surface, &options, &out);
  return lbw_leave_object(L, box, out, status);
}

static const lbw_option unit_option[] = {{"unit", LBW_OTHER, 0}, {NULL, LBW_OTHER, 0}};

/* skeleton.read(path, {unit}) */
static int skeleton_read(lua_State *L) {
  const char *path = lbw_check_text(L, 1, NULL);
  lbw_options(L, 2, "skeleton.read", unit_option, NULL);
  double unit = lbw_unit_option(L, 2, "skeleton.read", 1e-3);
  lbw_box *box = lbw_box_new(L, &lbw_skeleton_class);
  bw_skeleton *out = NULL;
  bw_status status = bw_skeleton_read_tgf(lbw_enter(L), path, unit, &out);
  return lbw_leave_object(L, box, out, status);
}

/* skeleton:write(path, {unit}) */
static int skeleton_write(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  const char *path = lbw_check_text(L, 2, NULL);
  lbw_options(L, 3, "write", unit_option, NULL);
  double unit = lbw_unit_option(L, 3, "write", 1e-3);
  bw_status status = bw_skeleton_write_tgf(lbw_enter(L), skeleton, path, unit);
  lua_pushboolean(L, 1);
  return lbw_leave(L, status, 1);
}

/* ---- changing: each gives a new skeleton ----------------------------------------------------- */

/* skeleton:insert_joint(bone, fraction, name) */
static int skeleton_insert_joint(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  int32_t bone = lbw_check_bone(L, 2, skeleton);
  double fraction = lbw_check_real(L, 3, "fraction");
  bw_name name;
  bool named = !lua_isnoneornil(L, 4);
  if (named)
    lbw_read_name(L, 4, "insert_joint", &name);
  lbw_box *box = lbw_box_new(L, &lbw_skeleton_class);
  bw_skeleton *out = NULL;
  bw_status status = bw_skeleton_insert_joint(lbw_enter(L), skeleton, bone, fraction,
                                              named ? name.text : NULL, &out);
  return lbw_leave_object(L, box, out, status);
}

/* skeleton:move_joint(joint, at) */
static int skeleton_move_joint(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  int32_t joint = lbw_check_joint(L, 2, skeleton);
  double at[3];
  lbw_check_vector(L, 3, "at", at);
  lbw_box *box = lbw_box_new(L, &lbw_skeleton_class);
  bw_skeleton *out = NULL;
  bw_status status = bw_skeleton_move_joint(lbw_enter(L), skeleton, joint, at, &out);
  return lbw_leave_object(L, box, out, status);
}

/* skeleton:merge(bone, bone) */
static int skeleton_merge(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  int32_t a = lbw_check_bone(L, 2, skeleton), b = lbw_check_bone(L, 3, skeleton);
  lbw_box *box = lbw_box_new(L, &lbw_skeleton_class);
  bw_skeleton *out = NULL;
  bw_status status = bw_skeleton_merge_bones(lbw_enter(L), skeleton, a, b, &out);
  return lbw_leave_object(L, box, out, status);
}

/* skeleton:remove(bone): with all below it */
static int skeleton_remove(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  int32_t bone = lbw_check_bone(L, 2, skeleton);
  lbw_box *box = lbw_box_new(L, &lbw_skeleton_class);
  bw_skeleton *out = NULL;
  bw_status status = bw_skeleton_remove_bone(lbw_enter(L), skeleton, bone, &out);
  return lbw_leave_object(L, box, out, status);
}

/* skeleton:with_root(joint) */
static int skeleton_with_root(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  int32_t joint = lbw_check_joint(L, 2, skeleton);
  lbw_box *box = lbw_box_new(L, &lbw_skeleton_class);
  bw_skeleton *out = NULL;
  bw_status status = bw_skeleton_with_root(lbw_enter(L), skeleton, joint, &out);
  return lbw_leave_object(L, box, out, status);
}

/* ---- views ----------------------------------------------------------------------------------- */

static const double *place(const bw_skeleton *skeleton, int32_t joint) {
  return skeleton->joint + 3 * (int64_t)joint;
}

/* skeleton:joint(name): {index, name, at, bones = {names}} */
static int skeleton_joint(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  int32_t joint = lbw_check_joint(L, 2, skeleton);
  lua_createtable(L, 0, 4);
  lua_pushinteger(L, (lua_Integer)joint + 1);
  lua_setfield(L, -2, "index");
  lua_pushstring(L, skeleton->joint_name[joint].text);
  lua_setfield(L, -2, "name");
  lbw_push_vector(L, place(skeleton, joint));
  lua_setfield(L, -2, "at");
  lua_newtable(L);
  for (int32_t b = 0, n = 0; b < skeleton->bone_count; b++)
    if (skeleton->bone[2 * b] == joint || skeleton->bone[2 * b + 1] == joint) {
      lua_pushstring(L, skeleton->bone_name[b].text);
      lua_rawseti(L, -2, ++n);
    }
  lua_setfield(L, -2, "bones");
  return 1;
}

/* skeleton:bone(name): {index, name, head, tail, from, to, length, parent, children} */
static int skeleton_bone(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  int32_t bone = lbw_check_bone(L, 2, skeleton);
  int32_t head = skeleton->bone[2 * bone], tail = skeleton->bone[2 * bone + 1];
  const double *from = place(skeleton, head), *to = place(skeleton, tail);
  double along[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
  lua_createtable(L, 0, 9);
  lua_pushinteger(L, (lua_Integer)bone + 1);
  lua_setfield(L, -2, "index");
  lua_pushstring(L, skeleton->bone_name[bone].text);
  lua_setfield(L, -2, "name");
  lua_pushstring(L, skeleton->joint_name[head].text);
  lua_setfield(L, -2, "head");
  lua_pushstring(L, skeleton->joint_name[tail].text);
  lua_setfield(L, -2, "tail");
  lbw_push_vector(L, from);
  lua_setfield(L, -2, "from");
  lbw_push_vector(L, to);
  lua_setfield(L, -2, "to");
  lua_pushnumber(L, bw_norm(along));
  lua_setfield(L, -2, "length");
  if (skeleton->parent[bone] >= 0) {
    lua_pushstring(L, skeleton->bone_name[skeleton->parent[bone]].text);
    lua_setfield(L, -2, "parent");
  }
  lua_newtable(L);
  for (int32_t b = 0, n = 0; b < skeleton->bone_count; b++)
    if (skeleton->parent[b] == bone) {
      lua_pushstring(L, skeleton->bone_name[b].text);
      lua_rawseti(L, -2, ++n);
    }
  lua_setfield(L, -2, "children");
  return 1;
}

static int push_names(lua_State *L, int32_t count, const bw_name *name) {
  lua_createtable(L, count, 0);
  for (int32_t i = 0; i < count; i++) {
    lua_pushstring(L, name[i].text);
    lua_rawseti(L, -2, i + 1);
  }
  return 1;
}

static int skeleton_joint_names(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  return push_names(L, skeleton->joint_count, skeleton->joint_name);
}

static int skeleton_bone_names(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  return push_names(L, skeleton->bone_count, skeleton->bone_name);
}

static int skeleton_joints(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  return lbw_push_borrowed(L, BW_F64, skeleton->joint_count, 3, skeleton->joint, skeleton);
}

static int skeleton_bones(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  return lbw_push_indices(L, skeleton->bone_count, 2, skeleton->bone);
}

static int skeleton_parents(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  return lbw_push_indices(L, skeleton->bone_count, 1, skeleton->parent);
}

static int skeleton_frames(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  double *out = (double *)lbw_push_array(L, BW_F64, skeleton->bone_count, 9)->data;
  bw_skeleton_frames(skeleton, out);
  return 1;
}

static int skeleton_root(lua_State *L) {
  const bw_skeleton *skeleton = self(L);
  lua_pushstring(L, skeleton->joint_name[skeleton->root].text);
  return 1;
}

LBW_PUSH(skeleton_joint_count, lua_pushinteger(L, self(L)->joint_count))
LBW_PUSH(skeleton_bone_count, lua_pushinteger(L, self(L)->bone_count))

static const luaL_Reg methods[] = {{"write", skeleton_write},
                                   {"insert_joint", skeleton_insert_joint},
                                   {"move_joint", skeleton_move_joint},
                                   {"merge", skeleton_merge},
                                   {"remove", skeleton_remove},
                                   {"with_root", skeleton_with_root},
                                   {"joint", skeleton_joint},
                                   {"bone", skeleton_bone},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"joints", skeleton_joints},
                                      {"bones", skeleton_bones},
                                      {"joint_names", skeleton_joint_names},
                                      {"bone_names", skeleton_bone_names},
                                      {"parents", skeleton_parents},
                                      {"frames", skeleton_frames},
                                      {"root", skeleton_root},
                                      {"joint_count", skeleton_joint_count},
                                      {"bone_count", skeleton_bone_count},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{NULL, NULL}};
const lbw_class lbw_skeleton_class = {"skeleton", methods, properties, meta, NULL};

void lbw_open_skeleton(lua_State *L) {
  static const luaL_Reg functions[] = {{"make", skeleton_make},
                                       {"extract", skeleton_extract},
                                       {"read", skeleton_read},
                                       {NULL, NULL}};
  lbw_class_register(L, &lbw_skeleton_class);
  lua_newtable(L);
  luaL_setfuncs(L, functions, 0);
  lua_setfield(L, -2, "skeleton");
}
