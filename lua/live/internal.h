/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Shared by the files of the live view's server:
 *   server.c   life, pages
 *   loop.c     the thread: accepts, reads, writes, ends connections
 *   request.c  judges a request and answers it
 *   frame.c    WebSocket frames
 *   client.c   windows: what arrives from them, what is queued for them */
#ifndef LBW_LIVE_INTERNAL_H
#define LBW_LIVE_INTERNAL_H

#include <poll.h>
#include <pthread.h>
#include <sys/types.h>

#include "live/server.h"

enum {
  LIVE_TOKEN_DIGITS = 32,
  LIVE_HEAD_BYTES = 16 << 10, /* longest head of a request */
  LIVE_WAITING = 64,          /* connections that have not shown the token */
  LIVE_LOADING = 64,          /* connections that have shown it and are not windows */
  LIVE_ACCEPTS = 16           /* connections accepted in a round of the loop */
};

typedef struct live_page {
  bw_object object;
  struct live_page *next;
  char *text; /* path, mime, download: one block */
  const char *path, *mime, *download;
  char *content;
  size_t length;
} live_page;

/* Bytes to be sent: its own, or the content of a page. */
typedef struct live_outgoing {
  struct live_outgoing *next;
  live_page *page; /* retained; may be NULL */
  const char *data;
  size_t length;
  char key[LBW_LIVE_KEY_BYTES];
  char bytes[];
} live_outgoing;

typedef enum live_stage {
  LIVE_HEAD,    /* reads the head of its request */
  LIVE_BODY,    /* reads the body of an upload */
  LIVE_ANSWER,  /* sends the answer */
  LIVE_WINDOW,  /* an open WebSocket */
  LIVE_CLOSING, /* sends what is queued, the closing frame last; ignores what it reads */
  LIVE_DRAIN    /* has sent everything; reads until the other side ends, so that nothing is lost */
} live_stage;

/* Belongs to the loop's thread, except for what is marked as shared: that is guarded by the
 * server's lock. */
typedef struct live_connection {
  struct live_connection *next; /* shared; the order is that of age */
  int socket;
  live_stage stage;
  bool shown;      /* the token */
  double deadline; /* when the connection ends, in every stage but LIVE_WINDOW */
  double heard;    /* when a window last took or gave a byte */
  bool pinged;     /* since then */
  char *in;
  size_t filled, capacity;
  lbw_live_event *upload; /* what is read of a body, or NULL */
  size_t uploaded;        /* bytes of its text */
  live_outgoing *sending;
  size_t sent;
  int64_t number; /* shared: of a window; 0 for none */
  live_outgoing *first;
  size_t queued;   /* shared: bytes in the queue */
  int64_t waiting; /* shared: messages that the owner has not taken, and their bytes */
  int64_t waiting_bytes;
  bool closing;          /* shared: nothing more is queued */
  bool cut;              /* shared: end it at once */
  lbw_live_event *close; /* allocated beforehand: the end is reported even without memory */
} live_connection;

/* What the loop waits for: the eventfd, the listening socket, all connections. */
typedef struct live_polls {
  struct pollfd *entry;
  live_connection **of; /* the connection of an entry; NULL for the first two */
  int count;
} live_polls;

struct lbw_live_server {
  bw_object object;
  lbw_live_options options;
  int port, listening, wake; /* sockets, -1 for none; `wake` is an eventfd */
  char token[LIVE_TOKEN_DIGITS + 1];
  pid_t owner; /* a forked child has no thread of the server */
  bool running;
  pthread_t thread;
  live_polls polls;     /* the thread's */
  double accept_after;  /* the thread's: no connection is accepted before */
  pthread_mutex_t lock; /* of everything below */
  pthread_cond_t arrived;
  live_page *pages;
  live_connection *connections;
  int window_count;
  int64_t last_window;
  lbw_live_event *first, *last;
  bool stopping;
  bool uploading; /* an upload is being read, or waits for the owner: one at a time */
};

/* ---- server.c -------------------------------------------------------------------------------- */

/* The page at a path, retained, or NULL. */
live_page *live_find_page(lbw_live_server *server, const char *path);

/* ---- loop.c ---------------------------------------------------------------------------------- */

/* Starts the thread; ends it and closes all connections. */
bw_status live_start(bw_context *context, lbw_live_server *server);
void live_stop(lbw_live_server *server);
/* Makes the loop look at what was queued. */
void live_wake(lbw_live_server *server);

/* ---- request.c ------------------------------------------------------------------------------- */

/* Answers a request. The head has its empty line, and is changed. The answer is queued and the
 * stage set; false when memory is out. */
bool live_answer(lbw_live_server *server, live_connection *connection, char *head, size_t length);
/* Answers with a status alone. */
bool live_refuse(lbw_live_server *server, live_connection *connection, int code, const char *word);

/* ---- frame.c --------------------------------------------------------------------------------- */

enum { LIVE_TEXT = 1, LIVE_BINARY = 2, LIVE_CLOSE = 8, LIVE_PING = 9, LIVE_PONG = 10 };
enum { /* RFC 6455, section 7.4.1 */
       LIVE_CLOSE_NORMAL = 1000,
       LIVE_CLOSE_PROTOCOL = 1002,
       LIVE_CLOSE_TYPE = 1003,
       LIVE_CLOSE_TEXT = 1007,
       LIVE_CLOSE_POLICY = 1008,
       LIVE_CLOSE_SIZE = 1009,
       LIVE_CLOSE_LATER = 1013
};

typedef struct live_frame {
  int opcode;
  size_t head, length; /* bytes before the payload; bytes of payload */
} live_frame;

/* Judges the head of a frame from a client. Returns 0, or the code to close with and the reason.
 * frame->head is 0 as long as bytes of the head are missing. */
int live_check_frame(const char *bytes, size_t filled, int64_t max, live_frame *frame,
                     const char **reason);
/* Removes the mask from a whole frame; gives its payload. */
char *live_unmask(char *bytes, const live_frame *frame);
bool live_is_utf8(const char *text, size_t length);
/* A frame to be sent. NULL when memory is out. */
live_outgoing *live_new_frame(bw_context *context, int opcode, const char *key, const void *payload,
                              size_t length);
live_outgoing *live_new_close(int code, const char *reason);
enum { LIVE_ACCEPT_BYTES = 29 };
/* The answer to a Sec-WebSocket-Key; false when it is none. */
bool live_accept_key(const char *key, char answer[LIVE_ACCEPT_BYTES]);

/* ---- client.c -------------------------------------------------------------------------------- */

/* Under the lock: appends to the queue, in place of an unsent message with the same key. */
void live_enqueue(live_connection *connection, live_outgoing *message);
void live_free_outgoing(live_outgoing *message);
/* Makes a window of a connection whose WebSocket is agreed on, or begins to close it. */
void live_admit(lbw_live_server *server, live_connection *connection);
/* Makes room for an upload: 0, or the status to refuse it with. */
int live_begin_upload(lbw_live_server *server, live_connection *connection, const char *query,
                      size_t length);
/* Hands the whole upload to the owner. */
void live_end_upload(lbw_live_server *server, live_connection *connection);
/* Takes the whole frames in the connection's buffer. */
void live_take_frames(lbw_live_server *server, live_connection *connection);
/* Queues a ping. */
void live_ping(lbw_live_server *server, live_connection *connection);
/* Under the lock: a window that ends is reported to the owner; nothing more is queued for it. */
void live_leave(lbw_live_server *server, live_connection *connection);

#endif
