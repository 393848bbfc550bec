/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The sandbox's second wall: what the kernel refuses, whatever goes wrong in this process. Landlock
 * leaves the folder, and for reading the Lua files, fonts and a few files of the system that the C
 * library asks for; no file is executable and no TCP port reachable. A filter on system calls takes
 * what no script needs: programs, sockets, other processes' memory. Both hold for this thread,
 * which is the only one (see limits.c), for the threads that it starts and the children that it
 * forks. */
#include "program.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <stddef.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Bits that are younger than Debian 12's headers. */
enum {
  FS_REFER = 1 << 13,
  FS_TRUNCATE = 1 << 14,
  NET_BIND_TCP = 1 << 0,
  NET_CONNECT_TCP = 1 << 1,
  SCOPE_ABSTRACT_SOCKET = 1 << 0,
  SCOPE_SIGNAL = 1 << 1
};

typedef struct ruleset {
  uint64_t files, network, scoped;
} ruleset;

static const uint64_t reading = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;

/* What the kernel's version of Landlock can refuse. */
static ruleset all_of(int version, size_t *bytes) {
  ruleset all = {.files = (1 << 13) - 1}; /* version 1 */
  *bytes = sizeof all.files;
  if (version >= 2)
    all.files |= FS_REFER;
  if (version >= 3)
    all.files |= FS_TRUNCATE;
  if (version >= 4) {
    all.network = NET_BIND_TCP | NET_CONNECT_TCP;
    *bytes = offsetof(ruleset, scoped);
  }
  if (version >= 6) {
    all.scoped = SCOPE_ABSTRACT_SOCKET | SCOPE_SIGNAL;
    *bytes = sizeof all;
  }
  return all;
}

/* What is not there needs no rule. A rule on a file may only have the rights of files. */
static void allow(int rules, const char *path, uint64_t rights) {
  struct stat about;
  int place = open(path, O_PATH | O_CLOEXEC);
  if (place < 0)
    return;
  if (fstat(place, &about) == 0 && !S_ISDIR(about.st_mode))
    rights &= LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE | FS_TRUNCATE;
  struct landlock_path_beneath_attr rule = {.allowed_access = rights, .parent_fd = place};
  syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
  close(place);
}

static int close_files(const char *folder, const char *const *readable) {
  static const char *const system[] = {"/etc/fonts",
                                       "/usr/share/fonts",
                                       "/usr/local/share/fonts",
                                       "/usr/share/fontconfig",
                                       "/var/cache/fontconfig",
                                       "/proc",
                                       "/sys/devices/system",
                                       "/usr/share/zoneinfo",
                                       "/etc/localtime",
                                       "/etc/inputrc",
                                       "/usr/share/terminfo",
                                       "/lib/terminfo",
                                       "/etc/terminfo",
                                       NULL};
  int version = (int)syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
  if (version < 1)
    return 0;
  size_t bytes;
  ruleset all = all_of(version, &bytes);
  int rules = (int)syscall(SYS_landlock_create_ruleset, &all, bytes, 0);
  if (rules < 0)
    return 0;
  const uint64_t never = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                         LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SOCK |
                         LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_SYM;
  allow(rules, folder, all.files & ~never);
  allow(rules, "/dev/null", reading | LANDLOCK_ACCESS_FS_WRITE_FILE);
  for (int i = 0; readable[i]; i++)
    allow(rules, readable[i], reading);
  for (int i = 0; system[i]; i++)
    allow(rules, system[i], reading);
  bool closed = syscall(SYS_landlock_restrict_self, rules, 0) == 0;
  close(rules);
  return closed ? version : 0;
}

#if defined __x86_64__
#define ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined __aarch64__
#define ARCHITECTURE AUDIT_ARCH_AARCH64
#endif

#ifdef ARCHITECTURE
#define REFUSE(call)                                                                               \
  BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (call), 0, 1),                                               \
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM)

static bool close_calls(void) {
  struct sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ARCHITECTURE, 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
#ifdef __x86_64__
      /* The x32 numbers of the same calls. */
      BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 0x40000000, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
#endif
      REFUSE(SYS_execve), REFUSE(SYS_execveat), REFUSE(SYS_socket), REFUSE(SYS_socketpair),
      REFUSE(SYS_ptrace), REFUSE(SYS_process_vm_readv), REFUSE(SYS_process_vm_writev),
      REFUSE(SYS_pidfd_getfd), REFUSE(SYS_mount), REFUSE(SYS_unshare), REFUSE(SYS_setns),
      REFUSE(SYS_bpf), REFUSE(SYS_perf_event_open), REFUSE(SYS_keyctl), REFUSE(SYS_add_key),
      REFUSE(SYS_request_key), REFUSE(SYS_io_uring_setup), REFUSE(SYS_userfaultfd),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  struct sock_fprog filter = {.len = sizeof program / sizeof *program, .filter = program};
  return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter, 0, 0) == 0;
}
#else
static bool close_calls(void) {
  return false;
}
#endif

program_walls program_close_kernel(const char *folder, const char *const *readable) {
  program_walls walls = {0, false};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
    return walls;
  walls.landlock = close_files(folder, readable);
  walls.calls = close_calls();
  return walls;
}
