/* confine: limits the files of a process that runs untrusted scripts. After bw_confine, for the
 * whole process and those that it forks, the engine opens files only in the folder, and reads those
 * that bw_confine_read_also named before (a file, or a folder with its content). This cannot be
 * undone. The program that runs a script disables what the script's language could open by
 * itself. */
#ifndef BARWRIGHT_CONFINE_H
#define BARWRIGHT_CONFINE_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Adds a file or folder that may be read once the process is confined; BW_INVALID after that,
 * BW_LIMIT beyond 12 of them. */
BW_API bw_status bw_confine_read_also(bw_context *context, const char *path);
/* Confines the process to a `folder`, which must exist (BW_IO). Once only (BW_INVALID). */
BW_API bw_status bw_confine(bw_context *context, const char *folder);
/* Whether the process is confined. From any thread. */
BW_API bool bw_confined(void);
/* The folder, static; NULL where the process is not confined. */
BW_API const char *bw_confined_to(void);

/* What a file is opened for. */
typedef enum bw_use {
  BW_TO_READ,   /* its content */
  BW_TO_WRITE,  /* new content; it may be new */
  BW_TO_REPLACE /* to be renamed over, or removed */
} bw_use;
/* Asked before every file is opened: BW_OK, or BW_IO with a message. Links are followed, so that
 * where a path leads is what counts; to replace or remove a file is to change its folder. */
BW_API bw_status bw_may_use(bw_context *context, const char *path, bw_use use);
/* As open, mkdir, remove and rename, with errno. In a confined process they refuse with EACCES what
 * bw_may_use refuses, and follow no link that is created after that. A descriptor is closed
 * when a program is started. This one takes open's `flags` and `mode` and returns a descriptor. */
BW_API int bw_open(const char *path, int flags, unsigned mode);
/* mkdir. */
BW_API int bw_make_folder(const char *path);
/* remove. */
BW_API int bw_remove(const char *path);
/* rename, `from` one path `to` another. */
BW_API int bw_rename(const char *from, const char *to);

/* Asked before `what` is started, a server or a job (a noun for the message): BW_UNSUPPORTED where
 * the process is confined. Children that the engine forks for a library's sake (child.h) need no
 * leave: they run no script. */
BW_API bw_status bw_may_start(bw_context *context, const char *what);

#ifdef __cplusplus
}
#endif

#endif
