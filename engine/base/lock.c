/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Locks between processes: a file that one process at a time holds.
 *
 * A record lock (fcntl) ends with its process, however that ends, and a forked child does not have
 * it. Two things follow from how these locks are defined, and are seen to here:
 *  - a process never waits for itself, and closing any descriptor of the file gives the lock up:
 *    the locks of this process are in a list, which is asked before the file is opened;
 *  - the file is removed with the lock, so that nothing is left lying about. Who opened it just
 *    before has locked a file without a name then, and tries again. */
#include "barwright/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

struct bw_lock {
  bw_object object;
  struct bw_lock *next; /* of this process */
  pid_t owner;          /* a child inherits the list, not the locks */
  dev_t device;
  ino_t inode;
  int file;
  char path[];
};

static pthread_mutex_t guard = PTHREAD_MUTEX_INITIALIZER;
static bw_lock *held;

static void unlock(void *object) {
  bw_lock *lock = (bw_lock *)object;
  pthread_mutex_lock(&guard);
  for (bw_lock **at = &held; *at; at = &(*at)->next)
    if (*at == lock) {
      *at = lock->next;
      break;
    }
  if (lock->owner == getpid()) {
    bw_remove(lock->path);
    close(lock->file);
  }
  pthread_mutex_unlock(&guard);
  bw_free(lock);
}

static const bw_kind kind = {"lock", unlock, NULL};

static bool is_ours(const struct stat *about) {
  for (const bw_lock *at = held; at; at = at->next)
    if (at->owner == getpid() && at->device == about->st_dev && at->inode == about->st_ino)
      return true;
  return false;
}

/* Who holds it, as it wrote into the file; the kernel's word where that is empty. */
static void read_holder(int file, pid_t process, char text[128]) {
  char written[96] = "";
  ssize_t got = pread(file, written, sizeof written - 1, 0);
  written[got > 0 ? got : 0] = 0;
  written[strcspn(written, "\n")] = 0;
  if (written[0])
    snprintf(text, 128, "%s", written);
  else
    snprintf(text, 128, "process %ld", (long)process);
}

/* 1: taken, 0: somebody has it, -1: the file cannot be used (errno). */
static int try_once(bw_lock *lock, char holder[128]) {
  struct stat about, named;
  if (stat(lock->path, &about) == 0 && is_ours(&about)) {
    snprintf(holder, 128, "this process (%ld)", (long)getpid());
    return 0;
  }
  int file = bw_open(lock->path, O_RDWR | O_CREAT | O_NOFOLLOW, 0666);
  if (file < 0)
    return -1;
  struct flock whole;
  memset(&whole, 0, sizeof whole);
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (fcntl(file, F_SETLK, &whole) != 0) {
    int why = errno;
    bool busy = why == EACCES || why == EAGAIN;
    if (busy && fcntl(file, F_GETLK, &whole) == 0)
      read_holder(file, whole.l_pid, holder);
    close(file);
    errno = why;
    return busy ? 0 : -1;
  }
  if (fstat(file, &about) != 0 || stat(lock->path, &named) != 0 || about.st_ino != named.st_ino ||
      about.st_dev != named.st_dev) { /* it was removed meanwhile */
    close(file);
    return 0;
  }
  char host[64] = "", text[128];
  gethostname(host, sizeof host - 1);
  int length = snprintf(text, sizeof text, "process %ld on %s\n", (long)getpid(), host);
  if (ftruncate(file, 0) != 0 || pwrite(file, text, (size_t)length, 0) < 0) {
    /* a full disk: the lock holds without its text */
  }
  lock->file = file;
  lock->owner = getpid();
  lock->device = about.st_dev;
  lock->inode = about.st_ino;
  return 1;
}

bw_status bw_lock_take(bw_context *context, const char *path, double seconds, bw_lock **result) {
  bw_status allowed = bw_may_use(context, path, BW_TO_WRITE);
  if (allowed != BW_OK)
    return allowed;
  size_t length = strlen(path) + 1;
  bw_lock *lock = (bw_lock *)bw_calloc(context, 1, sizeof *lock + length);
  if (!lock)
    return BW_MEMORY;
  bw_object_init(lock, &kind);
  lock->file = -1;
  memcpy(lock->path, path, length);
  bw_status status = BW_OK;
  char holder[128] = "another process";
  double start = bw_seconds();
  for (;;) {
    pthread_mutex_lock(&guard);
    int taken = try_once(lock, holder);
    int why = errno;
    if (taken > 0) {
      lock->next = held;
      held = lock;
    }
    pthread_mutex_unlock(&guard);
    if (taken > 0) {
      *result = lock;
      return BW_OK;
    }
    if (taken < 0) {
      status = bw_fail(context, BW_IO, "%s: cannot be locked: %s", path, strerror(why));
      bw_detail_text(context, "file", path);
      break;
    }
    if (bw_seconds() - start >= seconds) {
      status = bw_fail(context, BW_LIMIT, "%s is locked by %s", path, holder);
      bw_detail_text(context, "limit", "lock");
      bw_detail_text(context, "holder", holder);
      break;
    }
    BW_TRY(bw_check_cancel(context));
    nanosleep(&(struct timespec){0, 20000000}, NULL);
  }
done:
  bw_free(lock);
  return status;
}
