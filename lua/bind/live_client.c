/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The WebSocket clients of the live view.
 *
 * A client lives from CivetWeb's ready handler to its close handler, both on the worker thread that
 * reads its connection. The close handler waits for the client's sending thread before it frees
 * anything, so a sender always has a connection. To cut a client off, its socket is shut down: the
 * worker then reads the end, a blocked send fails, and the close handler comes. */
#include <errno.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>

#include "live_internal.h"

enum { OPCODE = 0x0f, FINAL = 0x80, RESERVED = 0x70 };
enum { /* RFC 6455, section 7.4.1 */
       CLOSE_NORMAL = 1000,
       CLOSE_PROTOCOL = 1002,
       CLOSE_TYPE = 1003,
       CLOSE_TEXT = 1007,
       CLOSE_POLICY = 1008,
       CLOSE_SIZE = 1009,
       CLOSE_LATER = 1013
};

typedef struct outgoing {
  struct outgoing *next;
  int opcode;
  char key[LBW_LIVE_KEY_BYTES];
  size_t length;
  char bytes[];
} outgoing;

struct live_client {
  live_client *next;
  lbw_live_server *server;
  struct mg_connection *connection;
  int64_t number;
  int socket;
  pthread_t sender;
  pthread_cond_t wake;
  outgoing *first;
  size_t queued;   /* bytes waiting to be sent */
  int64_t waiting; /* messages and their bytes that the owner has not taken */
  int64_t waiting_bytes;
  bool closing;          /* nothing more is sent */
  lbw_live_event *close; /* made beforehand: the end is told even when memory is out */
};

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

static live_client *find_client(lbw_live_server *server, int64_t number) {
  live_client *client = server->clients;
  while (client && client->number != number)
    client = client->next;
  return client;
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
    live_client *client =
        event->kind == LBW_LIVE_MESSAGE ? find_client(server, event->client) : NULL;
    if (client) {
      client->waiting--;
      client->waiting_bytes -= (int64_t)event->length;
    }
  }
  pthread_mutex_unlock(&server->lock);
  return event;
}

/* ---- sending --------------------------------------------------------------------------------- */

/* Under the lock. */
static void cut(live_client *client) {
  client->closing = true;
  if (client->socket >= 0)
    shutdown(client->socket, SHUT_RDWR);
  pthread_cond_signal(&client->wake);
}

static void *send_queued(void *data) {
  live_client *client = (live_client *)data;
  pthread_mutex_t *lock = &client->server->lock;
  pthread_mutex_lock(lock);
  while (true) {
    while (!client->closing && !client->first)
      pthread_cond_wait(&client->wake, lock);
    if (client->closing)
      break;
    outgoing *next = client->first;
    client->first = next->next;
    client->queued -= next->length;
    pthread_mutex_unlock(lock);
    int written = mg_websocket_write(client->connection, next->opcode, next->bytes, next->length);
    bool whole = written > 0 && (size_t)written >= next->length;
    bool last = next->opcode == MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE;
    bw_free(next);
    pthread_mutex_lock(lock);
    if (!whole || last)
      cut(client);
  }
  pthread_mutex_unlock(lock);
  return NULL;
}

/* Under the lock: at the end of the queue, in place of an older one with the same key. */
static void enqueue(live_client *client, outgoing *message) {
  outgoing **place = &client->first;
  while (*place) {
    outgoing *old = *place;
    if (message->key[0] && strcmp(old->key, message->key) == 0) {
      *place = old->next;
      client->queued -= old->length;
      bw_free(old);
    } else
      place = &old->next;
  }
  *place = message;
  client->queued += message->length;
  if (client->queued > (size_t)client->server->options.queue_bytes)
    cut(client);
  pthread_cond_signal(&client->wake);
}

static outgoing *new_outgoing(bw_context *context, int opcode, const char *key, const void *bytes,
                              size_t length) {
  outgoing *message = (outgoing *)bw_alloc(context, 1, sizeof *message + length);
  if (!message)
    return NULL;
  *message = (outgoing){.opcode = opcode, .length = length};
  snprintf(message->key, sizeof message->key, "%s", key ? key : "");
  if (length > 0)
    memcpy(message->bytes, bytes, length);
  return message;
}

bw_status lbw_live_send(bw_context *context, lbw_live_server *server, int64_t number,
                        const void *bytes, size_t length, bool binary, const char *key,
                        bool *sent) {
  *sent = false;
  outgoing *message = new_outgoing(
      context, binary ? MG_WEBSOCKET_OPCODE_BINARY : MG_WEBSOCKET_OPCODE_TEXT, key, bytes, length);
  if (!message)
    return BW_MEMORY;
  pthread_mutex_lock(&server->lock);
  live_client *client = find_client(server, number);
  if (client && !client->closing) {
    enqueue(client, message);
    message = NULL;
    *sent = true;
  }
  pthread_mutex_unlock(&server->lock);
  bw_free(message);
  return BW_OK;
}

/* The payload of a closing frame: the code, then a reason of at most 123 bytes. */
static size_t close_payload(char payload[126], int code, const char *reason) {
  payload[0] = (char)(code >> 8);
  payload[1] = (char)(code & 0xff);
  int length = snprintf(payload + 2, 124, "%s", reason);
  return 2 + (size_t)(length < 123 ? length : 123);
}

void lbw_live_disconnect(lbw_live_server *server, int64_t number, int code, const char *reason) {
  char payload[126];
  size_t length = close_payload(payload, code, reason);
  outgoing *message = new_outgoing(NULL, MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE, "", payload, length);
  pthread_mutex_lock(&server->lock);
  live_client *client = find_client(server, number);
  if (client && !client->closing && message) {
    enqueue(client, message);
    message = NULL;
  } else if (client)
    cut(client);
  pthread_mutex_unlock(&server->lock);
  bw_free(message);
}

int lbw_live_client_count(lbw_live_server *server) {
  pthread_mutex_lock(&server->lock);
  int count = server->client_count;
  pthread_mutex_unlock(&server->lock);
  return count;
}

/* ---- CivetWeb's handlers --------------------------------------------------------------------- */

/* CivetWeb keeps a connection's socket to itself; it is the one between these two ports. */
static int socket_of(const struct mg_connection *connection, int port) {
  const struct mg_request_info *request = mg_get_request_info(connection);
  struct rlimit limit;
  int most =
      getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < 65536 ? (int)limit.rlim_cur : 65536;
  for (int s = 3; s < most; s++) {
    struct sockaddr_in here, there;
    socklen_t length = sizeof there;
    if (getpeername(s, (struct sockaddr *)&there, &length) != 0 || there.sin_family != AF_INET ||
        ntohs(there.sin_port) != request->remote_port ||
        there.sin_addr.s_addr != htonl(INADDR_LOOPBACK))
      continue;
    length = sizeof here;
    if (getsockname(s, (struct sockaddr *)&here, &length) == 0 && ntohs(here.sin_port) == port)
      return s;
  }
  return -1;
}

static void release_client(live_client *client) {
  while (client->first) {
    outgoing *message = client->first;
    client->first = message->next;
    bw_free(message);
  }
  bw_free(client->close);
  pthread_cond_destroy(&client->wake);
  bw_free(client);
}

static live_client *new_client(lbw_live_server *server, struct mg_connection *connection,
                               lbw_live_event **open) {
  live_client *client = BW_NEW0(NULL, live_client, 1);
  if (!client)
    return NULL;
  pthread_cond_init(&client->wake, NULL);
  client->server = server;
  client->connection = connection;
  client->socket = socket_of(connection, server->port);
  client->close = new_event(LBW_LIVE_CLOSE, 0, "", 0);
  *open = new_event(LBW_LIVE_OPEN, 0, "", 0);
  if (client->close && *open && client->socket >= 0)
    return client;
  bw_free(*open);
  release_client(client);
  return NULL;
}

static void close_with(struct mg_connection *connection, int code, const char *reason) {
  char payload[126];
  size_t length = close_payload(payload, code, reason);
  mg_websocket_write(connection, MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE, payload, length);
}

/* Under the lock: whether there was room and a thread to be had. */
static bool admit(lbw_live_server *server, live_client *client, lbw_live_event *open) {
  if (server->stopping || server->client_count >= server->options.clients)
    return false;
  client->number = open->client = client->close->client = ++server->last_client;
  if (pthread_create(&client->sender, NULL, send_queued, client) != 0)
    return false;
  client->next = server->clients;
  server->clients = client;
  server->client_count++;
  mg_set_user_connection_data(client->connection, client);
  post(server, open);
  return true;
}

static void on_ready(struct mg_connection *connection, void *data) {
  lbw_live_server *server = (lbw_live_server *)data;
  lbw_live_event *open = NULL;
  live_client *client = new_client(server, connection, &open);
  mg_set_user_connection_data(connection, NULL);
  if (client) {
    pthread_mutex_lock(&server->lock);
    bool admitted = admit(server, client, open);
    pthread_mutex_unlock(&server->lock);
    if (admitted)
      return;
    close_with(connection, CLOSE_LATER, "too many windows are open");
    shutdown(client->socket, SHUT_RDWR);
    bw_free(open);
    release_client(client);
  } else
    close_with(connection, CLOSE_LATER, "out of memory");
}

/* Well-formed UTF-8: no overlong forms, no surrogates, nothing above U+10FFFF. */
static bool is_utf8(const unsigned char *text, size_t length) {
  for (size_t i = 0; i < length;) {
    unsigned char c = text[i];
    size_t more = c < 0x80 ? 0 : c >= 0xc2 && c < 0xe0 ? 1 : c >= 0xe0 && c < 0xf0 ? 2 : 3;
    if (more == 3 && (c < 0xf0 || c > 0xf4))
      return false;
    if (more >= length - i)
      return more == 0;
    for (size_t k = 1; k <= more; k++)
      if ((text[i + k] & 0xc0) != 0x80)
        return false;
    unsigned char second = more > 0 ? text[i + 1] : 0;
    if ((c == 0xe0 && second < 0xa0) || (c == 0xed && second > 0x9f) ||
        (c == 0xf0 && second < 0x90) || (c == 0xf4 && second > 0x8f))
      return false;
    i += more + 1;
  }
  return true;
}

/* A code to close with, or 0 for a message that the owner can have. */
static int judge_frame(const lbw_live_server *server, int bits, const char *text, size_t length,
                       const char **reason) {
  if (bits & RESERVED) {
    *reason = "reserved bits are set";
    return CLOSE_PROTOCOL;
  }
  if ((bits & OPCODE) != MG_WEBSOCKET_OPCODE_TEXT || !(bits & FINAL)) {
    *reason = "text in one frame expected";
    return CLOSE_TYPE;
  }
  if (length > (size_t)server->options.message_bytes) {
    *reason = "the message is too long";
    return CLOSE_SIZE;
  }
  if (!is_utf8((const unsigned char *)text, length)) {
    *reason = "UTF-8 expected";
    return CLOSE_TEXT;
  }
  return 0;
}

static int on_data(struct mg_connection *connection, int bits, char *text, size_t length,
                   void *data) {
  lbw_live_server *server = (lbw_live_server *)data;
  live_client *client = (live_client *)mg_get_user_connection_data(connection);
  if (!client)
    return 0;
  int opcode = bits & OPCODE;
  if (opcode == MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE) {
    close_with(connection, CLOSE_NORMAL, "");
    return 0;
  }
  if (opcode == MG_WEBSOCKET_OPCODE_PING || opcode == MG_WEBSOCKET_OPCODE_PONG)
    return 1;
  const char *reason = "";
  int code = judge_frame(server, bits, text, length, &reason);
  lbw_live_event *event = code ? NULL : new_event(LBW_LIVE_MESSAGE, client->number, text, length);
  if (!code && !event) {
    code = CLOSE_LATER;
    reason = "out of memory";
  }
  if (event) {
    pthread_mutex_lock(&server->lock);
    if (client->waiting >= server->options.queue_messages ||
        client->waiting_bytes + (int64_t)length > 16 * server->options.message_bytes) {
      code = CLOSE_POLICY;
      reason = "too many messages";
    } else {
      client->waiting++;
      client->waiting_bytes += (int64_t)length;
      post(server, event);
      event = NULL;
    }
    pthread_mutex_unlock(&server->lock);
    bw_free(event);
  }
  if (code)
    close_with(connection, code, reason);
  return code == 0;
}

static void on_close(const struct mg_connection *connection, void *data) {
  lbw_live_server *server = (lbw_live_server *)data;
  live_client *client = (live_client *)mg_get_user_connection_data(connection);
  if (!client)
    return;
  pthread_mutex_lock(&server->lock);
  live_client **place = &server->clients;
  while (*place != client)
    place = &(*place)->next;
  *place = client->next;
  server->client_count--;
  cut(client);
  post(server, client->close);
  client->close = NULL;
  pthread_mutex_unlock(&server->lock);
  pthread_join(client->sender, NULL);
  release_client(client);
}

void lbw_live_take_clients(lbw_live_server *server, const char *uri) {
  mg_set_websocket_handler(server->web, uri, NULL, on_ready, on_data, on_close, server);
}

void lbw_live_end_clients(lbw_live_server *server) {
  pthread_mutex_lock(&server->lock);
  server->stopping = true;
  for (live_client *client = server->clients; client; client = client->next)
    cut(client);
  pthread_mutex_unlock(&server->lock);
}
