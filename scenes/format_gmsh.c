/* Gmsh's .msh (2.2 and 4.1, ASCII and binary), MEDIT's .mesh and VTK's .vtk, by Gmsh's own library
 * in a process beside (gmsh/gmsh_reader.c). */
#include "framework/base/beside.h"
#include "framework/base/memory.h"
#include "framework/scene/tets.h"
#include "scenes/gmsh/gmsh_stream.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { CPU_SECONDS = 600 }; /* a file on which Gmsh runs for longer is one on which it hangs */

typedef struct reader {
    const char *path;
    pid_t process;
    int pipe;
} reader;

/* Only calls that are safe between fork and exec. */
static void be_reader(const char *program, const char *path, int pipe, rlim_t memory)
{
    char *const arguments[] = {(char *)(uintptr_t)program, (char *)(uintptr_t)path, NULL};
    char *const environment[] = {(char *)(uintptr_t) "LC_ALL=C",
                                 (char *)(uintptr_t) "OMP_NUM_THREADS=1", NULL};
    const struct rlimit time = {CPU_SECONDS, CPU_SECONDS}, room = {memory, memory}, none = {0, 0};
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setrlimit(RLIMIT_CPU, &time);
    setrlimit(RLIMIT_DATA, &room);
    setrlimit(RLIMIT_CORE, &none);
    int nowhere = open("/dev/null", O_RDWR);
    if (nowhere < 0 || dup2(nowhere, STDIN_FILENO) < 0 || dup2(nowhere, STDERR_FILENO) < 0 ||
        dup2(pipe, STDOUT_FILENO) < 0)
        _exit(126);
    execve(program, arguments, environment);
    _exit(127);
}

static bb_status start(const char *path, reader *r)
{
    char program[4096];
    int ends[2];
    r->path = path;
    if (access(path, R_OK) != 0)
        return bb_fail(BB_INVALID, "%s: cannot be read: %s", path, strerror(errno));
    if (!bb_find_beside("bvhbench-gmsh", program, sizeof program))
        return bb_fail(BB_UNSUPPORTED,
                       "%s: needs Gmsh: install libgmsh-dev, configure and build again (cmake "
                       "--preset release, scripts/build release), or take TetGen's .node and .ele",
                       path);
    if (pipe2(ends, O_CLOEXEC) != 0)
        return bb_fail(BB_FAILED, "%s: no pipe to read it by: %s", path, strerror(errno));
    uint64_t limit = bb_host_limit();
    r->process = fork();
    if (r->process == 0)
        be_reader(program, path, ends[1], limit == UINT64_MAX ? RLIM_INFINITY : (rlim_t)limit);
    close(ends[1]);
    r->pipe = ends[0];
    if (r->process > 0)
        return BB_OK;
    close(ends[0]);
    return bb_fail(BB_FAILED, "%s: no process to read it by: %s", path, strerror(errno));
}

static bool read_all(const reader *r, void *to, uint64_t bytes)
{
    char *at = to;
    while (bytes > 0) {
        ssize_t got = read(r->pipe, at, bytes < 1 << 30 ? (size_t)bytes : 1 << 30);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        at += got;
        bytes -= (uint64_t)got;
    }
    return true;
}

/* After the pipe has ended early: why. */
static bb_status ended(const reader *r, int status)
{
    if (WIFSIGNALED(status))
        return bb_fail(BB_INVALID,
                       "%s: Gmsh does not survive it (%s): it is damaged, or no mesh at all",
                       r->path, strsignal(WTERMSIG(status)));
    return bb_fail(BB_INVALID, "%s: Gmsh ends on it (exit status %d): it is damaged, or no mesh",
                   r->path, WEXITSTATUS(status));
}

static bb_status check_head(const reader *r, const bb_gmsh_head *head)
{
    if (head->message[0] != '\0')
        return bb_fail(BB_INVALID, "%s: %.*s", r->path, (int)sizeof head->message, head->message);
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

static bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    (void)spec;
    reader r;
    bool early;
    int status = 0;
    BB_TRY(start(path, &r));
    bb_status taken = take(&r, scene, &early);
    close(r.pipe);
    if (taken != BB_OK && !early)
        kill(r.process, SIGKILL);
    while (waitpid(r.process, &status, 0) < 0 && errno == EINTR)
        continue;
    return early ? ended(&r, status) : taken;
}

static const char *const endings[] = {".msh", ".mesh", ".vtk", NULL};

extern const bb_scene_format bb_scene_format_gmsh;
const bb_scene_format bb_scene_format_gmsh = {
    .name = "gmsh",
    .endings = endings,
    .load = load,
};
