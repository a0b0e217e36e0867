/* Gmsh's .msh (2.2 and 4.1, ASCII and binary), MEDIT's .mesh and VTK's .vtk, by Gmsh's own library
 * in a separate process (gmsh/gmsh_reader.c). */
#include "framework/base/beside.h"
#include "framework/base/clock.h"
#include "framework/base/file.h"
#include "framework/base/memory.h"
#include "framework/base/steering.h"
#include "framework/scene/tets.h"
#include "scenes/gmsh/gmsh_stream.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SECONDS = 600 }; /* if Gmsh takes longer it hangs on the file */

typedef struct reader {
    const char *path;
    char folder[PATH_MAX], name[PATH_MAX]; /* a link to the file: see make_link() */
    pid_t process;
    int pipe;
    double until; /* ms */
} reader;

/* ---- the file that Gmsh is given ---- */

static bool has(const char *text, size_t size, const char *word)
{
    return memmem(text, size, word, strlen(word)) != NULL;
}

/* Returns the file's type by its first bytes. Gmsh runs files of unknown types as scripts, which
 * may call a shell, so it only gets these types. */
static const char *ending_of(const char *text, size_t size)
{
    if (size > 11 && memcmp(text, "$MeshFormat", 11) == 0)
        return ".msh";
    if (size > 14 && memcmp(text, "# vtk DataFile", 14) == 0)
        return ".vtk";
    return has(text, size, "MeshVersionFormatted") ? ".mesh" : NULL;
}

/* Makes a link of our own in a folder of our own: Gmsh goes by the ending, and reads options, which
 * are scripts, from a file beside it. */
static bb_status make_link(reader *r)
{
    char start[4096], whole[PATH_MAX];
    struct stat info;
    bb_input input;
    BB_TRY(bb_input_open(r->path, "scene", &input));
    size_t size = input.size < sizeof start ? (size_t)input.size : sizeof start;
    bb_status status = bb_input_read(&input, start, size);
    bb_input_close(&input);
    BB_TRY(status);
    const char *ending = ending_of(start, size);
    if (ending == NULL)
        return bb_fail(BB_INVALID, "%s: does not begin like a mesh of Gmsh, MEDIT or legacy VTK",
                       r->path);
    if (realpath(r->path, whole) == NULL || stat(whole, &info) != 0)
        return bb_fail(BB_INVALID, "%s: cannot be read: %s", r->path, strerror(errno));
    const char *base = getenv("TMPDIR");
    snprintf(r->folder, sizeof r->folder, "%.4000s/bvhbench-gmsh-XXXXXX",
             base != NULL && base[0] != '\0' ? base : "/tmp");
    if (mkdtemp(r->folder) == NULL) {
        bb_fail(BB_INVALID, "%s: cannot make a folder for a link to it, %s: %s", r->path, r->folder,
                strerror(errno));
        r->folder[0] = '\0';
        return BB_INVALID;
    }
    snprintf(r->name, sizeof r->name, "%.4060s/mesh%s", r->folder, ending);
    return symlink(whole, r->name) == 0
               ? BB_OK
               : bb_fail(BB_INVALID, "%s: cannot make a link to it: %s", r->path, strerror(errno));
}

static void remove_link(const reader *r)
{
    if (r->folder[0] == '\0')
        return;
    unlink(r->name);
    rmdir(r->folder);
}

/* ---- the process ---- */

enum { NOT_STARTED = 127 };

/* Only makes calls that are safe between fork and exec. */
static void be_reader(const char *program, const char *path, int pipe, rlim_t memory)
{
    char *const arguments[] = {(char *)(uintptr_t)program, (char *)(uintptr_t)path, NULL};
    char libraries[4096 + 32] = "LD_LIBRARY_PATH=";
    const char *set = getenv("LD_LIBRARY_PATH");
    if (set != NULL && strlen(set) < 4096)
        strcat(libraries, set);
    char *const environment[] = {(char *)(uintptr_t) "LC_ALL=C",
                                 (char *)(uintptr_t) "OMP_NUM_THREADS=1",
                                 set != NULL ? libraries : NULL, NULL};
    const struct rlimit time = {SECONDS, SECONDS}, none = {0, 0};
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setrlimit(RLIMIT_CPU, &time);
#ifdef __SANITIZE_ADDRESS__
    (void)memory; /* the sanitizer's shadow memory, terabytes that are never touched, would count */
#else
    const struct rlimit room = {memory, memory};
    setrlimit(RLIMIT_DATA, &room);
#endif
    setrlimit(RLIMIT_CORE, &none);
    setrlimit(RLIMIT_FSIZE, &none); /* limits files, not pipes */
    signal(SIGXFSZ, SIG_IGN);       /* makes attempts of Gmsh to write a file fail */
    int out = fcntl(pipe, F_DUPFD_CLOEXEC, 3), nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (out < 0 || nowhere < 0 || dup2(nowhere, STDIN_FILENO) < 0 ||
        dup2(nowhere, STDERR_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0)
        _exit(NOT_STARTED);
    execve(program, arguments, environment);
    _exit(NOT_STARTED);
}

static bb_status start(reader *r)
{
    char program[4096];
    int ends[2];
    if (!bb_find_beside("bvhbench-gmsh", program, sizeof program))
        return bb_fail(BB_UNSUPPORTED,
                       "%s: needs Gmsh: install libgmsh-dev, configure and build again (cmake "
                       "--preset release, scripts/build release), or take TetGen's .node and .ele",
                       r->path);
    BB_TRY(make_link(r));
    if (pipe2(ends, O_CLOEXEC) != 0)
        return bb_fail(BB_FAILED, "%s: cannot make a pipe to read it: %s", r->path,
                       strerror(errno));
    uint64_t limit = bb_host_limit();
    r->until = bb_wall_ms() + 1e3 * SECONDS;
    r->process = fork();
    if (r->process == 0)
        be_reader(program, r->name, ends[1], limit == UINT64_MAX ? RLIM_INFINITY : (rlim_t)limit);
    close(ends[1]);
    r->pipe = ends[0];
    if (r->process > 0)
        return BB_OK;
    close(ends[0]);
    return bb_fail(BB_FAILED, "%s: cannot start a process to read it: %s", r->path,
                   strerror(errno));
}

static bool read_all(const reader *r, void *to, uint64_t bytes)
{
    char *at = to;
    while (bytes > 0) {
        struct pollfd ready = {.fd = r->pipe, .events = POLLIN};
        double left = r->until - bb_wall_ms();
        int came = left > 0 ? poll(&ready, 1, (int)left) : 0;
        if (came < 0 && errno == EINTR)
            continue;
        ssize_t got = came > 0 ? read(r->pipe, at, bytes < 1 << 30 ? (size_t)bytes : 1 << 30) : -1;
        if (got < 0 && came > 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        at += got;
        bytes -= (uint64_t)got;
    }
    return true;
}

/* Reports why the data ended early. */
static bb_status ended(const reader *r, int status)
{
    if (bb_wall_ms() >= r->until)
        return bb_fail(BB_INVALID, "%s: Gmsh did not finish reading it in %d s", r->path, SECONDS);
    if (WIFSIGNALED(status))
        return bb_fail(BB_INVALID, "%s: Gmsh crashed on it (%s): it is damaged, or no mesh",
                       r->path, strsignal(WTERMSIG(status)));
    if (WEXITSTATUS(status) == NOT_STARTED)
        return bb_fail(BB_FAILED,
                       "%s: the program bvhbench-gmsh, or Gmsh's library, cannot be started: build "
                       "again",
                       r->path);
    return bb_fail(BB_INVALID, "%s: Gmsh failed on it (exit status %d): it is damaged, or no mesh",
                   r->path, WEXITSTATUS(status));
}

static bb_status check_head(const reader *r, bb_gmsh_head *head)
{
    head->message[sizeof head->message - 1] = '\0';
    bb_calm_text(head->message);
    if (head->message[0] != '\0')
        return bb_fail(BB_INVALID, "%s: %s", r->path, head->message);
    if (head->tets == 0 || head->vertices == 0)
        return bb_fail(BB_INVALID, "%s: has no tetrahedra: Gmsh finds none in it", r->path);
    if (head->others > 0)
        return bb_fail(BB_INVALID,
                       "%s: has %" PRIu64 " elements that are no tetrahedra (hexahedra, prisms, "
                       "pyramids, curved ones of higher order): cut them into tetrahedra first",
                       r->path, head->others);
    return BB_OK;
}

static bb_status take(const reader *r, bb_scene *scene, bool *early)
{
    bb_gmsh_head head;
    float *field = NULL;
    *early = !read_all(r, &head, sizeof head);
    if (*early || memcmp(head.magic, BB_GMSH_MAGIC, sizeof head.magic) != 0) {
        *early = true;
        return BB_FAILED;
    }
    BB_TRY(check_head(r, &head));
    BB_TRY(bb_scene_reserve(scene, head.vertices,
                            &(bb_prim_counts){.of = {[BB_TETRAHEDRON] = head.tets}}));
    if (head.fielded != 0)
        BB_TRY(bb_scene_reserve_field(scene, "first view", &field));
    *early = !read_all(r, scene->vertices, head.vertices * 3 * sizeof(float)) ||
             (field != NULL && !read_all(r, field, head.vertices * sizeof(float))) ||
             !read_all(r, scene->prims[BB_TETRAHEDRON].data, head.tets * 4 * sizeof(uint32_t));
    return *early ? BB_FAILED : BB_OK;
}

static bb_status load_link(reader *r, bb_scene *scene)
{
    bool early;
    int status = 0;
    BB_TRY(start(r));
    bb_status taken = take(r, scene, &early);
    close(r->pipe);
    if (taken != BB_OK && (!early || bb_wall_ms() >= r->until))
        kill(r->process, SIGKILL); /* it might write on, or hang */
    while (waitpid(r->process, &status, 0) < 0 && errno == EINTR)
        continue;
    return early ? ended(r, status) : taken;
}

static bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    (void)spec;
    reader r = {.path = path};
    bb_status status = load_link(&r, scene);
    remove_link(&r);
    return status;
}

static const char *const endings[] = {".msh", ".mesh", ".vtk", NULL};

extern const bb_scene_format bb_scene_format_gmsh;
const bb_scene_format bb_scene_format_gmsh = {
    .name = "gmsh",
    .endings = endings,
    .load = load,
};
