/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The thread that owns all connections of the live view. It never blocks but in poll.
 *
 * Whoever has not shown the token gets little: LIVE_WAITING connections at a time and
 * options.head_seconds for a request. A connection beyond the number ends the oldest of its group,
 * so that silent and slow ones never keep a new one out: it is accepted at once, and a request that
 * follows within LIVE_WAITING newer connections is read. The same holds for connections that load a
 * page. Windows are bounded by options.clients and never displaced. */
#include <errno.h>
#include <math.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "live/internal.h"

static const double answer_seconds = 30; /* to take an answer */
static const double drain_seconds = 2;   /* to end a connection after everything is sent */
static const double closing_seconds = 5; /* to take a closing frame */
static const double accept_pause = 0.05; /* after one that failed */
enum { READ_BYTES = 64 << 10, ROUND_BYTES = 1 << 20 };

void live_wake(lbw_live_server *server) {
  const uint64_t one = 1;
  ssize_t written = write(server->wake, &one, sizeof one);
  (void)written; /* a counter that is full wakes the loop too */
}

/* ---- the life of a connection ---------------------------------------------------------------- */

static void free_connection(live_connection *connection) {
  shutdown(connection->socket, SHUT_RDWR); /* a forked child may have the socket as well */
  close(connection->socket);
  live_free_outgoing(connection->sending);
  while (connection->first) {
    live_outgoing *message = connection->first;
    connection->first = message->next;
    live_free_outgoing(message);
  }
  bw_free(connection->close);
  bw_free(connection->upload);
  bw_free(connection->in);
  bw_free(connection);
}

/* Under the lock. */
static void end_at(lbw_live_server *server, live_connection **place) {
  live_connection *connection = *place;
  *place = connection->next;
  if (connection->upload)
    server->uploading = false;
  live_leave(server, connection);
  free_connection(connection);
}

static void mark_ended(lbw_live_server *server, live_connection *connection) {
  pthread_mutex_lock(&server->lock);
  connection->cut = true;
  pthread_mutex_unlock(&server->lock);
}

static void accept_one(lbw_live_server *server, int socket) {
  live_connection *connection = BW_NEW0(NULL, live_connection, 1);
  if (!connection) {
    close(socket);
    return;
  }
  const int yes = 1;
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  connection->socket = socket;
  connection->deadline = bw_seconds() + server->options.head_seconds;
  pthread_mutex_lock(&server->lock);
  live_connection **place = &server->connections;
  while (*place)
    place = &(*place)->next;
  *place = connection;
  pthread_mutex_unlock(&server->lock);
}

/* No descriptor is free: the oldest connection that has not shown the token gives up its own. */
static void make_descriptor_free(lbw_live_server *server) {
  pthread_mutex_lock(&server->lock);
  live_connection *oldest = server->connections;
  while (oldest && oldest->shown)
    oldest = oldest->next;
  if (oldest)
    oldest->cut = true;
  pthread_mutex_unlock(&server->lock);
  server->accept_after = bw_seconds() + accept_pause;
}

static void accept_some(lbw_live_server *server) {
  for (int i = 0; i < LIVE_ACCEPTS; i++) {
    int socket = accept4(server->listening, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket >= 0)
      accept_one(server, socket);
    else if (errno == EAGAIN)
      return;
    else if (errno != EINTR && errno != ECONNABORTED) {
      make_descriptor_free(server);
      return;
    }
  }
}

/* ---- reading --------------------------------------------------------------------------------- */

static bool reserve(live_connection *connection, size_t bytes) {
  if (connection->capacity >= bytes)
    return true;
  size_t capacity = connection->capacity ? connection->capacity : 2048;
  while (capacity < bytes)
    capacity *= 2;
  char *in = (char *)bw_resize(NULL, connection->in, capacity, 1);
  if (!in)
    return false;
  connection->in = in;
  connection->capacity = capacity;
  return true;
}

typedef enum taken { TOOK, NOTHING, ENDED } taken;

static taken receive(live_connection *connection, void *into, size_t max) {
  ssize_t got = recv(connection->socket, into, max, 0);
  if (got > 0)
    connection->filled += (size_t)got;
  return got > 0 ? TOOK : got < 0 && (errno == EAGAIN || errno == EINTR) ? NOTHING : ENDED;
}

static taken append(live_connection *connection, size_t max) {
  if (!reserve(connection, connection->filled + 1))
    return ENDED;
  size_t capacity = connection->capacity - connection->filled;
  return receive(connection, connection->in + connection->filled, capacity < max ? capacity : max);
}

static taken read_window(lbw_live_server *server, live_connection *connection) {
  taken took = append(connection, READ_BYTES);
  if (took != TOOK)
    return took;
  connection->heard = bw_seconds();
  connection->pinged = false;
  live_take_frames(server, connection);
  return TOOK;
}

static taken end_body(lbw_live_server *server, live_connection *connection) {
  if (connection->uploaded < connection->upload->length)
    return TOOK;
  live_end_upload(server, connection);
  return live_refuse(server, connection, 200, "OK") ? TOOK : ENDED;
}

/* What of a body came with the head. */
static taken take_body(lbw_live_server *server, live_connection *connection) {
  lbw_live_event *upload = connection->upload;
  size_t left = upload->length - connection->uploaded;
  size_t length = connection->filled < left ? connection->filled : left;
  memcpy(upload->text + connection->uploaded, connection->in, length);
  connection->uploaded += length;
  connection->filled = 0;
  return end_body(server, connection);
}

/* Takes the request off the buffer once its head is whole: what follows may be frames. */
static taken read_head(lbw_live_server *server, live_connection *connection) {
  size_t before = connection->filled;
  taken took = append(connection, LIVE_HEAD_BYTES - before);
  if (took != TOOK)
    return took;
  size_t from = before < 3 ? 0 : before - 3;
  char *end = (char *)memmem(connection->in + from, connection->filled - from, "\r\n\r\n", 4);
  bool ok = true;
  if (end) {
    size_t length = (size_t)(end + 4 - connection->in);
    ok = live_answer(server, connection, connection->in, length);
    connection->filled -= length;
    memmove(connection->in, connection->in + length, connection->filled);
  } else if (connection->filled >= LIVE_HEAD_BYTES)
    ok = live_refuse(server, connection, 431, "Request Header Fields Too Large");
  if (!ok)
    return ENDED;
  if (connection->shown)
    connection->deadline = bw_seconds() + answer_seconds;
  if (connection->stage == LIVE_WINDOW) {
    connection->heard = bw_seconds();
    live_take_frames(server, connection);
  }
  return connection->stage == LIVE_BODY ? take_body(server, connection) : TOOK;
}

/* Bytes of a body go where the owner gets them; each extends the time. */
static taken read_body(lbw_live_server *server, live_connection *connection) {
  lbw_live_event *upload = connection->upload;
  taken took = receive(connection, upload->text + connection->uploaded,
                       upload->length - connection->uploaded);
  if (took != TOOK)
    return took;
  connection->uploaded += connection->filled;
  connection->filled = 0;
  connection->deadline = bw_seconds() + answer_seconds;
  return end_body(server, connection);
}

static taken read_nothing(live_connection *connection) {
  char ignored[4096];
  taken took = receive(connection, ignored, sizeof ignored);
  connection->filled = 0;
  return took;
}

/* ---- writing --------------------------------------------------------------------------------- */

static bool next_message(lbw_live_server *server, live_connection *connection) {
  live_free_outgoing(connection->sending);
  connection->sent = 0;
  pthread_mutex_lock(&server->lock);
  connection->sending = connection->first;
  if (connection->sending) {
    connection->first = connection->sending->next;
    connection->queued -= connection->sending->length;
  }
  pthread_mutex_unlock(&server->lock);
  return connection->sending != NULL;
}

/* False when the connection is broken. */
static bool write_some(lbw_live_server *server, live_connection *connection) {
  for (size_t total = 0; total < ROUND_BYTES;) {
    if (!connection->sending && !next_message(server, connection))
      return true;
    const live_outgoing *message = connection->sending;
    ssize_t put = send(connection->socket, message->data + connection->sent,
                       message->length - connection->sent, MSG_NOSIGNAL);
    if (put < 0)
      return errno == EAGAIN || errno == EINTR;
    connection->heard = bw_seconds();
    total += (size_t)put;
    connection->sent += (size_t)put;
    if (connection->sent == message->length)
      next_message(server, connection);
  }
  return true;
}

/* Everything is sent: the other side reads it to its end, and then ends the connection. */
static void begin_drain(lbw_live_server *server, live_connection *connection) {
  shutdown(connection->socket, SHUT_WR);
  connection->stage = LIVE_DRAIN;
  double until = bw_seconds() + drain_seconds;
  if (connection->shown || until < connection->deadline)
    connection->deadline = until;
  pthread_mutex_lock(&server->lock);
  live_leave(server, connection);
  pthread_mutex_unlock(&server->lock);
}

/* ---- a round --------------------------------------------------------------------------------- */

static void serve(lbw_live_server *server, live_connection *connection, int ready) {
  taken took = NOTHING;
  if (ready & (POLLIN | POLLHUP | POLLERR))
    took = connection->stage == LIVE_HEAD     ? read_head(server, connection)
           : connection->stage == LIVE_WINDOW ? read_window(server, connection)
           : connection->stage == LIVE_BODY   ? read_body(server, connection)
           : connection->stage == LIVE_ANSWER ? NOTHING
                                              : read_nothing(connection);
  bool ok = took != ENDED;
  bool writes = connection->stage != LIVE_HEAD && connection->stage != LIVE_BODY;
  if (ok && writes && connection->stage != LIVE_DRAIN) {
    ok = write_some(server, connection);
    pthread_mutex_lock(&server->lock);
    bool sent = !connection->sending && !connection->first;
    pthread_mutex_unlock(&server->lock);
    if (ok && sent && connection->stage != LIVE_WINDOW)
      begin_drain(server, connection);
  }
  if (!ok)
    mark_ended(server, connection);
}

/* When something must be done about a connection though nothing happens. */
static double due(const lbw_live_server *server, const live_connection *connection) {
  double silence = server->options.silence_seconds;
  return connection->stage != LIVE_WINDOW ? connection->deadline
         : connection->pinged             ? connection->heard + silence
                                          : connection->heard + silence / 3;
}

/* Under the lock: ends what is over, then the oldest of those that are too many. */
static void end_some(lbw_live_server *server, double now) {
  int waiting = 0, loading = 0;
  for (live_connection **place = &server->connections; *place;) {
    live_connection *connection = *place;
    if (connection->stage == LIVE_WINDOW && connection->closing) {
      connection->stage = LIVE_CLOSING;
      connection->deadline = now + closing_seconds;
    }
    bool may_end = connection->stage != LIVE_WINDOW || connection->pinged;
    if (connection->cut || (may_end && due(server, connection) <= now)) {
      end_at(server, place);
      continue;
    }
    waiting += !connection->shown;
    loading += connection->shown && connection->number == 0;
    place = &(*place)->next;
  }
  for (live_connection **place = &server->connections; *place;) {
    const live_connection *connection = *place;
    int *group = !connection->shown ? &waiting : connection->number == 0 ? &loading : NULL;
    if (!group || *group <= (connection->shown ? LIVE_LOADING : LIVE_WAITING)) {
      place = &(*place)->next;
      continue;
    }
    --*group;
    end_at(server, place);
  }
}

/* Under the lock. Gives the seconds until something is due. */
static double list_all(lbw_live_server *server, live_polls *list, double now) {
  double wait = 1e9;
  bool accepts = now >= server->accept_after;
  if (!accepts)
    wait = server->accept_after - now;
  list->entry[0] = (struct pollfd){server->wake, POLLIN, 0};
  list->entry[1] = (struct pollfd){server->listening, accepts ? POLLIN : 0, 0};
  list->count = 2;
  for (live_connection *c = server->connections; c; c = c->next) {
    bool sends = c->sending || c->first || c->stage == LIVE_CLOSING;
    short events = (short)((c->stage != LIVE_ANSWER ? POLLIN : 0) | (sends ? POLLOUT : 0));
    list->entry[list->count] = (struct pollfd){c->socket, events, 0};
    list->of[list->count++] = c;
    wait = fmin(wait, due(server, c) - now);
  }
  return wait;
}

static void run(lbw_live_server *server, live_polls *list) {
  while (true) {
    double now = bw_seconds();
    pthread_mutex_lock(&server->lock);
    bool stopping = server->stopping;
    end_some(server, now);
    double wait = list_all(server, list, now);
    pthread_mutex_unlock(&server->lock);
    if (stopping)
      return;
    int milliseconds = wait > 1e6 ? -1 : wait > 0 ? (int)(wait * 1e3) + 1 : 0;
    if (poll(list->entry, (nfds_t)list->count, milliseconds) < 0)
      continue;
    uint64_t count;
    if (list->entry[0].revents && read(server->wake, &count, sizeof count) < 0)
      continue;
    now = bw_seconds();
    for (int i = 2; i < list->count; i++) {
      live_connection *connection = list->of[i];
      if (connection->stage == LIVE_WINDOW && !connection->pinged &&
          due(server, connection) <= now) {
        connection->pinged = true;
        live_ping(server, connection);
      }
      if (list->entry[i].revents)
        serve(server, connection, list->entry[i].revents);
    }
    if (list->entry[1].revents)
      accept_some(server);
  }
}

/* ---- the thread ------------------------------------------------------------------------------ */

static void *live_thread(void *data) {
  lbw_live_server *server = (lbw_live_server *)data;
  run(server, &server->polls);
  return NULL;
}

bw_status live_start(bw_context *context, lbw_live_server *server) {
  int max = 2 + LIVE_WAITING + LIVE_LOADING + server->options.clients;
  server->polls.entry = BW_NEW(context, struct pollfd, max);
  server->polls.of = BW_NEW0(context, live_connection *, max);
  if (!server->polls.entry || !server->polls.of)
    return BW_MEMORY;
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  server->running = pthread_create(&server->thread, NULL, live_thread, server) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return server->running ? BW_OK
                         : bw_fail(context, BW_MEMORY,
                                   "the thread of the live view's server cannot be started");
}

void live_stop(lbw_live_server *server) {
  if (server->running) {
    pthread_mutex_lock(&server->lock);
    server->stopping = true;
    pthread_mutex_unlock(&server->lock);
    live_wake(server);
    pthread_join(server->thread, NULL);
  }
  while (server->connections)
    end_at(server, &server->connections);
  bw_free(server->polls.entry);
  bw_free(server->polls.of);
}
