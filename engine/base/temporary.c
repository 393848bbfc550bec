/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Temporary files, and those that killed processes left. See barwright/temporary.h.
 *
 * Invariant: a file of this process has a lock before its maker gets its name. Between its
 * making and its locking another process may take it for one that was left behind, lock it and
 * remove it: then the lock is refused, or taken on a file without a name, and another one is made.
 * Files that belong to it are made after it and removed before it, so that they are left behind
 * exactly if it is not there.
 * Its path is in open_files before the file is made: a signal at any time finds it. */
#include "barwright/temporary.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "barwright/confine.h"
#include "base/words.h"

enum { OPEN = 64, SWEPT = 64, TAG = 8, MAX_NAME = 255, MAX_OWN = 40, TRIES = 100 };
static const char word[] = ".partial.";

struct bw_temporary {
  bw_object object;
  pid_t owner;
  int file;
  int slot; /* in open_files, or -1 */
  bool with_others, gone;
  char *path;
  char *folder; /* NULL: none is made with it */
};

/* For bw_temporaries_abandon: a signal handler may read it at any time, so an entry is one pointer,
 * cleared before its path is freed or changed. */
static char *open_files[OPEN];

static int enter(char *path) {
  for (int i = 0; i < OPEN; i++) {
    char *none = NULL;
    if (__atomic_compare_exchange_n(&open_files[i], &none, path, false, __ATOMIC_SEQ_CST,
                                    __ATOMIC_SEQ_CST))
      return i;
  }
  return -1;
}

static void leave(bw_temporary *t) {
  if (t->slot >= 0)
    __atomic_store_n(&open_files[t->slot], NULL, __ATOMIC_SEQ_CST);
  t->slot = -1;
}

void bw_temporaries_abandon(void) {
  for (int i = 0; i < OPEN; i++) {
    char *path = __atomic_load_n(&open_files[i], __ATOMIC_SEQ_CST);
    if (path)
      unlink(path);
  }
}

/* ---- names ----------------------------------------------------------------------------------- */

typedef char path_text[PATH_MAX];

/* Whether it fits. */
static bool join(path_text path, const char *folder, const char *name) {
  size_t length = strlen(folder);
  const char *between = length > 0 && folder[length - 1] == '/' ? "" : "/";
  return snprintf(path, PATH_MAX, "%s%s%s", folder, between, name) < PATH_MAX;
}

static const char *name_in(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

static bool folder_of(path_text folder, const char *path) {
  size_t length = (size_t)(name_in(path) - path);
  return snprintf(folder, PATH_MAX, "%.*s", length ? (int)length : 1, length ? path : ".") <
         PATH_MAX;
}

/* The length of the part of a name that is a temporary file's, by the last word in it; 0: none. */
static size_t temporary_prefix(const char *name) {
  const char *at = NULL;
  for (const char *next = name; (next = strstr(next, word)); next++)
    at = next;
  if (!at)
    return 0;
  at += sizeof word - 1;
  const char *number = at;
  while (isdigit((unsigned char)*at))
    at++;
  if (at == number || *at++ != '.')
    return 0;
  for (int i = 0; i < TAG; i++, at++)
    if (!isdigit((unsigned char)*at) && (*at < 'a' || *at > 'f'))
      return 0;
  return *at == 0 || *at == '.' || *at == '-' ? (size_t)(at - name) : 0;
}

/* ---- removing -------------------------------------------------------------------------------- */

typedef void on_entry(void *data, const char *path, const char *name);

/* What cannot be read holds nothing that could be removed: no failure. */
static void visit(const char *folder, on_entry *entry, void *data) {
  path_text path;
  int file = bw_open(folder, O_RDONLY | O_DIRECTORY | O_NONBLOCK, 0);
  DIR *list = file >= 0 ? fdopendir(file) : NULL;
  if (!list) {
    if (file >= 0)
      close(file);
    return;
  }
  for (const struct dirent *at; (at = readdir(list));)
    if (strcmp(at->d_name, ".") != 0 && strcmp(at->d_name, "..") != 0 &&
        join(path, folder, at->d_name))
      entry(data, path, at->d_name);
  closedir(list);
}

/* A file, or a folder with what is in it. */
static void remove_all(void *data, const char *path, const char *name) {
  struct stat about;
  if (lstat(path, &about) == 0 && S_ISDIR(about.st_mode))
    visit(path, remove_all, data);
  bw_remove(path);
  (void)name;
}

/* Removes a file that nobody holds. */
static void remove_if_left(const char *path) {
  struct stat about;
  int file = bw_open(path, O_RDONLY | O_NONBLOCK | O_NOFOLLOW, 0);
  if (file < 0)
    return;
  if (fstat(file, &about) == 0 && S_ISREG(about.st_mode) && about.st_uid == geteuid() &&
      flock(file, LOCK_EX | LOCK_NB) == 0 && fstat(file, &about) == 0 && about.st_nlink > 0)
    bw_remove(path);
  close(file);
}

static void sweep_files(void *data, const char *path, const char *name) {
  size_t length = temporary_prefix(name);
  bool *others = (bool *)data;
  if (length > 0 && name[length] == 0)
    remove_if_left(path);
  *others = *others || name[length] != 0;
}

/* What belongs to a file that is not there. */
static void sweep_others(void *data, const char *path, const char *name) {
  size_t length = temporary_prefix(name);
  struct stat about;
  path_text first;
  if (length == 0 || !name[length] || lstat(path, &about) != 0 || about.st_uid != geteuid())
    return;
  snprintf(first, sizeof first, "%.*s", (int)(strlen(path) - strlen(name) + length), path);
  if (lstat(first, &about) != 0 && errno == ENOENT)
    remove_all(data, path, name);
}

void bw_temporaries_sweep(const char *folder) {
  bool others = false;
  visit(folder, sweep_files, &others);
  if (others)
    visit(folder, sweep_others, NULL);
}

/* Once for each folder, as far as they are remembered. */
static void sweep_once(const char *folder) {
  static pthread_mutex_t guard = PTHREAD_MUTEX_INITIALIZER;
  static struct {
    dev_t device;
    ino_t inode;
  } swept[SWEPT];
  static int count;
  struct stat about;
  if (stat(folder, &about) != 0)
    return;
  bool known = false;
  pthread_mutex_lock(&guard);
  for (int i = 0; i < SWEPT && i < count && !known; i++)
    known = swept[i].device == about.st_dev && swept[i].inode == about.st_ino;
  if (!known) {
    swept[count % SWEPT].device = about.st_dev;
    swept[count % SWEPT].inode = about.st_ino;
    count = count + 1 < 2 * SWEPT ? count + 1 : SWEPT;
  }
  pthread_mutex_unlock(&guard);
  if (!known)
    bw_temporaries_sweep(folder);
}

/* ---- the object ------------------------------------------------------------------------------ */

/* Of the file that is asked for. */
static void remove_other(void *data, const char *path, const char *name) {
  const char *own = (const char *)data;
  size_t length = strlen(own);
  if (strncmp(name, own, length) == 0 && (name[length] == '.' || name[length] == '-'))
    remove_all(NULL, path, name);
}

static void destroy(void *object) {
  bw_temporary *t = (bw_temporary *)object;
  leave(t);
  bool own = t->owner == getpid() && t->file >= 0;
  path_text folder;
  if (own && t->with_others && folder_of(folder, t->path))
    visit(folder, remove_other, (void *)name_in(t->path));
  if (own && !t->gone)
    bw_remove(t->path);
  if (t->file >= 0)
    close(t->file);
  bw_free(t->folder);
  bw_free(t->path);
  bw_free(t);
}

static const bw_kind kind = {"temporary file", destroy, NULL};

/* That nobody can predict, where the system gives such numbers. */
static uint32_t tag(void) {
  static uint32_t calls;
  uint32_t number;
  if (getrandom(&number, sizeof number, GRND_NONBLOCK) == (ssize_t)sizeof number)
    return number;
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  return (uint32_t)now.tv_nsec + 0x9e3779b9u * __atomic_add_fetch(&calls, 1, __ATOMIC_SEQ_CST);
}

/* A new file with a lock: 1; another name is to be tried: 0; none can be made: -1 and errno. */
static int try_once(bw_temporary *t) {
  struct stat about;
  t->file = bw_open(t->path, O_RDWR | O_CREAT | O_EXCL, 0666);
  if (t->file < 0)
    return errno == EEXIST ? 0 : -1;
  bool taken = flock(t->file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (!taken && fstat(t->file, &about) == 0 && about.st_nlink > 0)
    return 1;
  close(t->file);
  t->file = -1;
  return 0;
}

bw_status bw_temporary_create(bw_context *context, const char *target, bool with_others,
                              bw_temporary **temporary) {
  bw_status status = BW_OK;
  path_text folder;
  const char *name = name_in(target);
  size_t longest = MAX_NAME - MAX_OWN, before = (size_t)(name - target);
  size_t kept = strlen(name) < longest ? strlen(name) : longest;
  size_t bytes = before + kept + MAX_OWN + 1;
  bw_temporary *t = BW_NEW0(context, bw_temporary, 1);
  if (!t)
    return BW_MEMORY;
  bw_object_init(t, &kind);
  t->owner = getpid();
  t->file = t->slot = -1;
  t->with_others = with_others;
  BW_TRY(bw_may_use(context, target, BW_TO_WRITE));
  if (folder_of(folder, target))
    sweep_once(folder);
  t->path = BW_NEW(context, char, bytes);
  BW_TRY_MEMORY(t->path);
  int made = 0;
  for (int i = 0; i < TRIES && made == 0; i++) {
    snprintf(t->path, bytes, "%.*s%s%ld.%08x", (int)(before + kept), target, word, (long)getpid(),
             (unsigned)tag());
    t->slot = enter(t->path);
    made = try_once(t);
    if (made <= 0)
      leave(t);
  }
  if (made <= 0) {
    char text[BWI_WORDS];
    int why = errno;
    bool here = before <= 1; /* the current folder, or the root */
    status = bw_fail(context, BW_IO, "%s: cannot write: %s %.*s%s%s", target,
                     why == ENOENT ? "there is no folder" : "no file can be made in the folder",
                     (int)(here ? 1 : before - 1), before == 0 ? "." : target,
                     why == ENOENT ? "" : ": ", why == ENOENT ? "" : bwi_system_words(why, text));
    bw_detail_text(context, "file", target);
    goto done;
  }
  *temporary = t;
  t = NULL;
done:
  bw_release(t);
  return status;
}

static bw_status create_folder(bw_context *context, const char *place, bw_temporary **temporary) {
  bw_temporary *t = NULL;
  path_text target;
  char text[BWI_WORDS];
  if (!join(target, place, "barwright"))
    return bw_fail(context, BW_INVALID, "the path of the folder for temporary files is too long");
  bw_status status = bw_temporary_create(context, target, true, &t);
  if (status != BW_OK)
    return status;
  size_t bytes = strlen(t->path) + 3;
  t->folder = BW_NEW(context, char, bytes);
  if (t->folder)
    snprintf(t->folder, bytes, "%s.d", t->path);
  /* One that is there already is somebody else's. */
  if (!t->folder)
    status = BW_MEMORY;
  else if (bw_make_folder(t->folder) != 0 || (!bw_confined() && chmod(t->folder, 0700) != 0))
    status = bw_fail(context, BW_IO, "%s: cannot be made as a folder: %s", t->folder,
                     bwi_system_words(errno, text));
  if (status == BW_OK)
    *temporary = t;
  else
    bw_release(t);
  return status;
}

bw_status bw_temporary_folder_create(bw_context *context, bw_temporary **temporary) {
  const char *wished = bw_confined() ? bw_confined_to() : getenv("TMPDIR");
  if (wished && wished[0] == '/') {
    bw_status status = create_folder(context, wished, temporary);
    if (status == BW_OK || bw_confined())
      return status;
  }
  return create_folder(context, "/tmp", temporary);
}

const char *bw_temporary_path(const bw_temporary *t) {
  return t->folder ? t->folder : t->path;
}

int bw_temporary_file(const bw_temporary *t) {
  return t->file;
}

int bw_temporary_put_in_place(bw_temporary *t, const char *target) {
  if (bw_rename(t->path, target) != 0)
    return -1;
  t->gone = true;
  return 0;
}
