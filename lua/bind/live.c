/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The live view's server as a userdata. Sending and taking what has arrived also work inside a
 * function that the engine calls (progress of long work): they do not enter the engine then. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "bind.h"
#include "live/server.h"

static lbw_live_server *self(lua_State *L) {
  return (lbw_live_server *)lbw_check(L, 1, &lbw_live_server_class);
}

/* live_server{port =, clients =, message_bytes =, queue_bytes =, queue_messages =} */
static int core_live_server(lua_State *L) {
  static const lbw_option list[] = {
      {"port", LBW_INT, offsetof(lbw_live_options, port)},
      {"clients", LBW_INT, offsetof(lbw_live_options, clients)},
      {"message_bytes", LBW_COUNT, offsetof(lbw_live_options, message_bytes)},
      {"queue_bytes", LBW_COUNT, offsetof(lbw_live_options, queue_bytes)},
      {"upload_bytes", LBW_COUNT, offsetof(lbw_live_options, upload_bytes)},
      {"queue_messages", LBW_INT, offsetof(lbw_live_options, queue_messages)},
      {NULL, LBW_OTHER, 0}};
  lbw_live_options options;
  lbw_live_defaults(&options);
  lbw_options(L, 1, "live_server", list, &options);
  if (options.port < 0 || options.port > 65535)
    return lbw_error(L, "live_server: option 'port': a port from 0 to 65535 expected, got %d",
                     options.port);
  if (options.clients < 1 || options.clients > 64)
    return lbw_error(L, "live_server: option 'clients': a number from 1 to 64 expected, got %d",
                     options.clients);
  if (options.upload_bytes < 0 || options.upload_bytes > (int64_t)4 << 30)
    return lbw_error(L, "live_server: option 'upload_bytes': a size from 0 to 4 GiB expected");
  if (options.message_bytes < 1 || options.queue_bytes < 1 || options.queue_messages < 1)
    return lbw_error(L, "live_server: limits of at least 1 expected");
  lua_settop(L, 1);
  lbw_box *box = lbw_box_new(L, &lbw_live_server_class);
  lbw_live_server *server = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status = bw_may_start(context, "a live view's server");
  if (status == BW_OK)
    status = lbw_live_create(context, &options, &server);
  if (status == BW_OK)
    lbw_box_fill(L, box, server);
  return lbw_leave(L, status, 1);
}

/* A text for a header or an address: what would need escaping there is refused. */
static const char *check_plain(lua_State *L, int argument) {
  size_t length;
  const char *text = lbw_check_text(L, argument, &length);
  for (size_t i = 0; i < length; i++)
    lbw_argument_check(L, text[i] >= ' ' && text[i] < 127 && text[i] != '"' && text[i] != '\\',
                       argument, "plain text without quotes and control characters expected");
  return text;
}

static void no_memory(lua_State *L, bw_status status) {
  if (status != BW_OK)
    lbw_error(L, "not enough memory");
}

/* server:serve(path, mime, bytes, download): what /TOKEN/path answers from now on */
static int server_serve(lua_State *L) {
  lbw_live_server *server = self(L);
  const char *path = check_plain(L, 2), *mime = check_plain(L, 3);
  size_t length;
  const char *bytes = lbw_check_text(L, 4, &length);
  const char *download = lua_isnoneornil(L, 5) ? NULL : check_plain(L, 5);
  no_memory(L, lbw_live_serve(NULL, server, path, mime, download, bytes, length));
  lua_settop(L, 1);
  return 1;
}

/* server:send(client, bytes, {binary =, replace =}): whether the client is there */
static int server_send(lua_State *L) {
  struct sending {
    bool binary;
  } sending = {false};
  static const lbw_option list[] = {{"binary", LBW_BOOLEAN, offsetof(struct sending, binary)},
                                    {"replace", LBW_OTHER, 0},
                                    {NULL, LBW_OTHER, 0}};
  lbw_live_server *server = self(L);
  lua_Integer client = lbw_check_integer(L, 2);
  size_t length;
  const char *bytes = lbw_check_text(L, 3, &length);
  lua_settop(L, 4);
  lbw_options(L, 4, "send", list, &sending);
  const char *key = lbw_option_get(L, 4, "replace") == LUA_TNIL ? NULL : lbw_check_text(L, 5, NULL);
  lbw_argument_check(L, !key || lua_rawlen(L, 5) < LBW_LIVE_KEY_BYTES, 4,
                     "replace: a key of fewer bytes expected");
  bool sent;
  no_memory(L, lbw_live_send(NULL, server, client, bytes, length, sending.binary, key, &sent));
  lua_pushboolean(L, sent);
  return 1;
}

/* server:disconnect(client, code, reason) */
static int server_disconnect(lua_State *L) {
  lbw_live_server *server = self(L);
  lua_Integer client = lbw_check_integer(L, 2), code = lbw_integer_or(L, 3, 1000);
  lbw_argument_check(L, code >= 1000 && code < 5000, 3, "a code from 1000 to 4999 expected");
  lbw_live_disconnect(server, client, (int)code,
                      lua_isnoneornil(L, 4) ? "" : lbw_check_text(L, 4, NULL));
  return 0;
}

/* Copies the event behind a protected call, so that it is released when Lua has no memory. */
static int push_event(lua_State *L) {
  static const char *const kinds[] = {"open", "message", "close", "upload"};
  const lbw_live_event *event = (const lbw_live_event *)lua_touserdata(L, 1);
  lua_pushinteger(L, event->client);
  lua_pushstring(L, kinds[event->kind]);
  lua_pushlstring(L, event->text, event->length);
  return 3;
}

static int return_event(lua_State *L, lbw_live_event *event) {
  if (!event)
    return 0;
  lua_settop(L, 0);
  lua_pushcfunction(L, push_event);
  lua_pushlightuserdata(L, event);
  int failure = lua_pcall(L, 1, 3, 0);
  bw_free(event);
  return failure ? lua_error(L) : 3;
}

/* server:receive(seconds): client, "open" | "message" | "close" | "upload", text; nothing when none
 * came in time; nil, message, details when it was cancelled (Ctrl-C). Inside a function that the
 * engine calls it does not wait. */
static int server_receive(lua_State *L) {
  static const double slice = 0.05; /* how long Ctrl-C may take */
  lbw_live_server *server = self(L);
  double seconds = lua_isnoneornil(L, 2) ? 0 : lbw_check_real(L, 2, "seconds");
  lbw_argument_check(L, seconds >= 0 && seconds <= 1e6, 2, "seconds from 0 to 1e6 expected");
  luaL_checkstack(L, 8, "too many values");
  if (lbw_state_of(L)->running || seconds == 0)
    return return_event(L, lbw_live_receive(server, 0));
  double until = bw_seconds() + seconds;
  lbw_live_event *event = NULL;
  bw_context *context = lbw_enter(L);
  bw_status status;
  do {
    double left = until - bw_seconds();
    event = lbw_live_receive(server, left < slice ? fmax(left, 0) : slice);
    status = event ? BW_OK : bw_check_cancel(context);
  } while (!event && status == BW_OK && bw_seconds() < until);
  if (status != BW_OK)
    return lbw_leave(L, status, 0);
  lbw_leave(L, BW_OK, 0);
  return return_event(L, event);
}

/* ---- properties ------------------------------------------------------------------------------ */

LBW_PUSH(server_port, lua_pushinteger(L, lbw_live_port(self(L))))
LBW_PUSH(server_token, lua_pushstring(L, lbw_live_token(self(L))))

static int server_address(lua_State *L) {
  const lbw_live_server *server = self(L);
  lua_pushfstring(L, "http://127.0.0.1:%d/%s/", lbw_live_port(server), lbw_live_token(server));
  return 1;
}

LBW_PUSH(server_client_count, lua_pushinteger(L, lbw_live_client_count(self(L))))

static int server_tostring(lua_State *L) {
  const lbw_live_server *server = (const lbw_live_server *)lbw_check(L, 1, &lbw_live_server_class);
  lua_pushfstring(L, "live server at 127.0.0.1:%d", lbw_live_port(server));
  return 1;
}

static const luaL_Reg methods[] = {{"serve", server_serve},
                                   {"send", server_send},
                                   {"receive", server_receive},
                                   {"disconnect", server_disconnect},
                                   {NULL, NULL}};
static const luaL_Reg properties[] = {{"port", server_port},
                                      {"token", server_token},
                                      {"address", server_address},
                                      {"client_count", server_client_count},
                                      {NULL, NULL}};
static const luaL_Reg meta[] = {{"__tostring", server_tostring}, {NULL, NULL}};
const lbw_class lbw_live_server_class = {"live_server", methods, properties, meta, NULL};

void lbw_open_live(lua_State *L) {
  lbw_class_register(L, &lbw_live_server_class);
  lua_pushcfunction(L, core_live_server);
  lua_setfield(L, -2, "live_server");
}
