/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The windows of the live view: what arrives from them becomes events, what is sent to them is
 * queued. Functions of server.h run on the owner's thread, the others on the loop's. */
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "live/internal.h"

/* ---- events ---------------------------------------------------------------------------------- */

static lbw_live_event *new_event(lbw_live_kind kind, int64_t client, const char *text,
                                 size_t length) {
  lbw_live_event *event = (lbw_live_event *)bw_alloc(NULL, 1, sizeof *event + length);
  if (!event)
    return NULL;
  *event = (lbw_live_event){.kind = kind, .client = client, .length = length};
  memcpy(event->text, text, length);
  return event;
}

/* Under the lock. */
static void post(lbw_live_server *server, lbw_live_event *event) {
  if (server->last)
    server->last->next = event;
  else
    server->first = event;
  server->last = event;
  pthread_cond_signal(&server->arrived);
}

/* Under the lock. Numbers of windows begin at 1; 0 and less is no window. */
static live_connection *find_window(lbw_live_server *server, int64_t number) {
  live_connection *connection = number > 0 ? server->connections : NULL;
  while (connection && connection->number != number)
    connection = connection->next;
  return connection;
}

lbw_live_event *lbw_live_receive(lbw_live_server *server, double seconds) {
  struct timespec until;
  clock_gettime(CLOCK_MONOTONIC, &until);
  int64_t nanoseconds = until.tv_nsec + (int64_t)(seconds * 1e9);
  until.tv_sec += (time_t)(nanoseconds / 1000000000);
  until.tv_nsec = (long)(nanoseconds % 1000000000);
  pthread_mutex_lock(&server->lock);
  while (!server->first && seconds > 0 &&
         pthread_cond_timedwait(&server->arrived, &server->lock, &until) == 0) {
  }
  lbw_live_event *event = server->first;
  if (event) {
    server->first = event->next;
    if (!server->first)
      server->last = NULL;
    live_connection *from =
        event->kind == LBW_LIVE_MESSAGE ? find_window(server, event->client) : NULL;
    if (event->kind == LBW_LIVE_UPLOAD)
      server->uploading = false;
    if (from) {
      from->waiting--;
      from->waiting_bytes -= (int64_t)event->length;
    }
  }
  pthread_mutex_unlock(&server->lock);
  return event;
}

/* ---- sending --------------------------------------------------------------------------------- */

void live_free_outgoing(live_outgoing *message) {
  if (message)
    bw_release(message->page);
  bw_free(message);
}

void live_enqueue(live_connection *connection, live_outgoing *message) {
  live_outgoing **place = &connection->first;
  while (*place) {
    live_outgoing *old = *place;
    if (message->key[0] && strcmp(old->key, message->key) == 0) {
      *place = old->next;
      connection->queued -= old->length;
      live_free_outgoing(old);
    } else
      place = &old->next;
  }
  *place = message;
  connection->queued += message->length;
}

bw_status lbw_live_send(bw_context *context, lbw_live_server *server, int64_t number,
                        const void *bytes, size_t length, bool binary, const char *key,
                        bool *sent) {
  *sent = false;
  live_outgoing *message =
      live_new_frame(context, binary ? LIVE_BINARY : LIVE_TEXT, key ? key : "", bytes, length);
  if (!message)
    return BW_MEMORY;
  pthread_mutex_lock(&server->lock);
  live_connection *window = find_window(server, number);
  if (window && !window->closing) {
    live_enqueue(window, message);
    if (window->queued > (size_t)server->options.queue_bytes)
      window->closing = window->cut = true;
    message = NULL;
    *sent = true;
  }
  pthread_mutex_unlock(&server->lock);
  live_free_outgoing(message);
  live_wake(server);
  return BW_OK;
}

void lbw_live_disconnect(lbw_live_server *server, int64_t number, int code, const char *reason) {
  live_outgoing *message = live_new_close(code, reason);
  pthread_mutex_lock(&server->lock);
  live_connection *window = find_window(server, number);
  if (window && !window->closing) {
    window->closing = true;
    window->cut = !message;
    if (message)
      live_enqueue(window, message);
    message = NULL;
  }
  pthread_mutex_unlock(&server->lock);
  live_free_outgoing(message);
  live_wake(server);
}

int lbw_live_client_count(lbw_live_server *server) {
  pthread_mutex_lock(&server->lock);
  int count = server->window_count;
  pthread_mutex_unlock(&server->lock);
  return count;
}

/* ---- windows that come and go ---------------------------------------------------------------- */

/* Under the lock: what is queued is left out, and the closing frame is the last that is sent. */
static void close_with(live_connection *connection, int code, const char *reason) {
  while (connection->first) {
    live_outgoing *message = connection->first;
    connection->first = message->next;
    live_free_outgoing(message);
  }
  connection->queued = 0;
  live_outgoing *last = live_new_close(code, reason);
  connection->closing = true;
  connection->cut = !last;
  if (last)
    live_enqueue(connection, last);
}

/* Its first message, the answer to the request, is in the queue and stays there. */
void live_admit(lbw_live_server *server, live_connection *connection) {
  lbw_live_event *open = new_event(LBW_LIVE_OPEN, 0, "", 0);
  connection->close = new_event(LBW_LIVE_CLOSE, 0, "", 0);
  bool memory = open && connection->close;
  live_outgoing *refusal = NULL;
  connection->stage = LIVE_WINDOW;
  pthread_mutex_lock(&server->lock);
  bool has_space = server->window_count < server->options.clients;
  if (memory && has_space) {
    connection->number = open->client = connection->close->client = ++server->last_window;
    server->window_count++;
    post(server, open);
    open = NULL;
  } else {
    refusal =
        live_new_close(LIVE_CLOSE_LATER, memory ? "too many windows are open" : "out of memory");
    connection->closing = true;
    connection->cut = !refusal;
    if (refusal)
      live_enqueue(connection, refusal);
  }
  pthread_mutex_unlock(&server->lock);
  bw_free(open);
}

void live_leave(lbw_live_server *server, live_connection *connection) {
  connection->closing = true;
  if (connection->number == 0)
    return;
  connection->number = 0;
  server->window_count--;
  post(server, connection->close);
  connection->close = NULL;
}

/* ---- what a window sends --------------------------------------------------------------------- */

static void answer_control(lbw_live_server *server, live_connection *connection, int opcode,
                           const char *payload, size_t length) {
  live_outgoing *pong =
      opcode == LIVE_PING ? live_new_frame(NULL, LIVE_PONG, "pong", payload, length) : NULL;
  pthread_mutex_lock(&server->lock);
  if (opcode == LIVE_CLOSE)
    close_with(connection, length == 1 ? LIVE_CLOSE_PROTOCOL : LIVE_CLOSE_NORMAL, "");
  else if (pong && !connection->closing) {
    live_enqueue(connection, pong);
    pong = NULL;
  }
  pthread_mutex_unlock(&server->lock);
  live_free_outgoing(pong);
}

/* Hands a message over to the owner. The code to close with, or 0. */
static int hand_over(lbw_live_server *server, live_connection *connection, const char *text,
                     size_t length, const char **reason) {
  *reason = "UTF-8 expected";
  if (!live_is_utf8(text, length))
    return LIVE_CLOSE_TEXT;
  lbw_live_event *event = new_event(LBW_LIVE_MESSAGE, connection->number, text, length);
  *reason = "out of memory";
  if (!event)
    return LIVE_CLOSE_LATER;
  pthread_mutex_lock(&server->lock);
  bool has_space =
      connection->waiting < server->options.queue_messages &&
      connection->waiting_bytes + (int64_t)length <= 16 * server->options.message_bytes;
  if (has_space) {
    connection->waiting++;
    connection->waiting_bytes += (int64_t)length;
    post(server, event);
    event = NULL;
  }
  pthread_mutex_unlock(&server->lock);
  bw_free(event);
  *reason = "too many messages";
  return has_space ? 0 : LIVE_CLOSE_POLICY;
}

int live_begin_upload(lbw_live_server *server, live_connection *connection, const char *query,
                      size_t length) {
  pthread_mutex_lock(&server->lock);
  bool busy = server->uploading;
  server->uploading = true;
  pthread_mutex_unlock(&server->lock);
  if (busy)
    return 503;
  size_t name = strlen(query);
  lbw_live_event *event = (lbw_live_event *)bw_alloc(NULL, 1, sizeof *event + name + 1 + length);
  if (!event) {
    pthread_mutex_lock(&server->lock);
    server->uploading = false;
    pthread_mutex_unlock(&server->lock);
    return 503;
  }
  *event = (lbw_live_event){.kind = LBW_LIVE_UPLOAD, .length = name + 1 + length};
  memcpy(event->text, query, name);
  event->text[name] = '\n';
  connection->upload = event;
  connection->uploaded = name + 1;
  return 0;
}

void live_end_upload(lbw_live_server *server, live_connection *connection) {
  pthread_mutex_lock(&server->lock);
  post(server, connection->upload);
  pthread_mutex_unlock(&server->lock);
  connection->upload = NULL;
}

static bool takes_more(lbw_live_server *server, const live_connection *connection) {
  pthread_mutex_lock(&server->lock);
  bool more = !connection->closing;
  pthread_mutex_unlock(&server->lock);
  return more;
}

void live_take_frames(lbw_live_server *server, live_connection *connection) {
  size_t done = 0;
  while (takes_more(server, connection)) {
    char *bytes = connection->in + done;
    size_t left = connection->filled - done;
    live_frame frame;
    const char *reason = "";
    int code = live_check_frame(bytes, left, server->options.message_bytes, &frame, &reason);
    if (!code && (frame.head == 0 || left - frame.head < frame.length))
      break;
    if (!code) {
      const char *payload = live_unmask(bytes, &frame);
      done += frame.head + frame.length;
      if (frame.opcode == LIVE_TEXT)
        code = hand_over(server, connection, payload, frame.length, &reason);
      else
        answer_control(server, connection, frame.opcode, payload, frame.length);
    }
    if (code) {
      pthread_mutex_lock(&server->lock);
      close_with(connection, code, reason);
      pthread_mutex_unlock(&server->lock);
    }
  }
  connection->filled -= done;
  memmove(connection->in, connection->in + done, connection->filled);
}

void live_ping(lbw_live_server *server, live_connection *connection) {
  live_outgoing *ping = live_new_frame(NULL, LIVE_PING, "ping", "", 0);
  pthread_mutex_lock(&server->lock);
  if (ping && !connection->closing) {
    live_enqueue(connection, ping);
    ping = NULL;
  }
  pthread_mutex_unlock(&server->lock);
  live_free_outgoing(ping);
}
