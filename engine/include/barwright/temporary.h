/* temporary: files that exist only while a process writes their target.
 *
 * Such a file is in the folder of its target and is called TARGET.partial.PID.TAG, where TAG is
 * eight hexadecimal digits; names of files that accompany it begin so and continue with "." or "-".
 * Its process has a lock (flock) on it, which ends with the process. A file of such a name without
 * a lock is that of a process that was killed: the next process of the same user that makes one in
 * the folder removes it. Where locks do not work (some network file systems), nothing is
 * removed. */
#ifndef BARWRIGHT_TEMPORARY_H
#define BARWRIGHT_TEMPORARY_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An object: the last reference removes its files, unless it was put in place. In a forked child it
 * does not. */
typedef struct bw_temporary bw_temporary;

/* An empty file beside the `target`. `with_others`: files whose names begin with its name are to be
 * removed with it. BW_IO where it cannot be made. */
BW_API bw_status bw_temporary_create(bw_context *context, const char *target, bool with_others,
                                     bw_temporary **temporary);
/* An empty folder with an unpredictable name, which only this user can enter: in $TMPDIR, else in
 * /tmp; in a confined process in its own folder. BW_IO where it cannot be made. */
BW_API bw_status bw_temporary_folder_create(bw_context *context, bw_temporary **temporary);
/* The path of the file or folder; lives as long as the object. */
BW_API const char *bw_temporary_path(const bw_temporary *temporary);
/* The descriptor of the file, for reading and writing; it is closed with the object. */
BW_API int bw_temporary_file(const bw_temporary *temporary);
/* Renames it over the `target`; nothing of it is left to be removed. Returns 0, or -1 and errno. */
BW_API int bw_temporary_put_in_place(bw_temporary *temporary, const char *target);

/* Removes what killed processes left behind in a `folder`. Making a temporary file does so once for
 * each folder and process. */
BW_API void bw_temporaries_sweep(const char *folder);
/* Removes those of this process, for a handler of a signal that ends it: async-signal-safe. */
BW_API void bw_temporaries_abandon(void);

#ifdef __cplusplus
}
#endif

#endif
