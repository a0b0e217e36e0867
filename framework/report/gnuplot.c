/* Runs gnuplot, and checks what it leaves. */
#include "framework/report/gnuplot.h"
#include "framework/base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

const char bb_gnuplot_script[] = "charts.gp";
enum { PICTURE_BYTES_MAX = 64 << 20 };

bool bb_report_can_draw(void)
{
    const char *path = getenv("PATH");
    char candidate[PATH_MAX];
    for (const char *at = path; at != NULL && *at != '\0';) {
        size_t length = strcspn(at, ":");
        int size = snprintf(candidate, sizeof candidate, "%.*s/gnuplot", (int)length, at);
        struct stat info;
        if (length > 0 && size < (int)sizeof candidate && stat(candidate, &info) == 0 &&
            S_ISREG(info.st_mode) && access(candidate, X_OK) == 0)
            return true;
        at += length + (at[length] == ':');
    }
    return false;
}

/* Reads gnuplot's messages to the end, so that it never waits, and keeps their beginning without
 * line breaks, 0-terminated. */
static void read_complaint(int from, char *text, size_t capacity)
{
    size_t size = 0;
    char rest[512];
    for (;;) {
        bool full = size == capacity - 1;
        ssize_t got =
            full ? read(from, rest, sizeof rest) : read(from, text + size, capacity - 1 - size);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            break;
        size += full ? 0 : (size_t)got;
    }
    text[size] = '\0';
    for (size_t i = 0; i < size; i++)
        if ((unsigned char)text[i] < 0x20 || text[i] == 0x7F)
            text[i] = ' ';
}

/* Copies the environment with a UTF-8 locale, without which gnuplot complains about the script.
 * Free the array, not its strings. NULL: no memory. */
static char **environment_in_utf8(void)
{
    size_t count = 0, kept = 0;
    while (environ[count] != NULL)
        count++;
    char **copy = malloc((count + 2) * sizeof *copy);
    if (copy == NULL)
        return NULL;
    for (size_t i = 0; i < count; i++)
        if (strncmp(environ[i], "LC_ALL=", 7) != 0)
            copy[kept++] = environ[i];
    copy[kept++] = "LC_ALL=C.UTF-8";
    copy[kept] = NULL;
    return copy;
}

/* Runs gnuplot on the script in `folder` without the user's settings. Its standard error goes to
 * `errors`. */
static int start(const char *folder, int errors, pid_t *child)
{
    char *arguments[] = {"gnuplot", "--default-settings", (char *)bb_gnuplot_script, NULL};
    char **environment = environment_in_utf8();
    if (environment == NULL)
        return ENOMEM;
    posix_spawn_file_actions_t actions;
    int error = posix_spawn_file_actions_init(&actions);
    if (error != 0) {
        free(environment);
        return error;
    }
    error = posix_spawn_file_actions_addchdir_np(&actions, folder);
    if (error == 0)
        error = posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    if (error == 0)
        error = posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    if (error == 0)
        error = posix_spawn_file_actions_adddup2(&actions, errors, 2);
    if (error == 0)
        error = posix_spawnp(child, "gnuplot", &actions, NULL, arguments, environment);
    posix_spawn_file_actions_destroy(&actions);
    free(environment);
    return error;
}

bb_status bb_gnuplot_draw(const char *folder)
{
    int ends[2];
    pid_t child;
    char complaint[600];
    if (pipe2(ends, O_CLOEXEC) != 0)
        return bb_fail(BB_FAILED, "charts: no pipe to gnuplot: %s", strerror(errno));
    int error = start(folder, ends[1], &child);
    close(ends[1]);
    if (error != 0) {
        close(ends[0]);
        return bb_fail(BB_FAILED, "charts: gnuplot does not start: %s", strerror(error));
    }
    read_complaint(ends[0], complaint, sizeof complaint);
    close(ends[0]);
    int status;
    pid_t waited;
    while ((waited = waitpid(child, &status, 0)) < 0 && errno == EINTR)
        continue;
    if (waited != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
        return bb_fail(BB_FAILED, "charts: gnuplot failed on %s/%s:%s", folder, bb_gnuplot_script,
                       complaint[0] != '\0' ? complaint : " it does not say why");
    return BB_OK;
}

static bool ends_with(const char *text, size_t length, const char *end)
{
    size_t size = strlen(end);
    return length >= size && memcmp(text + length - size, end, size) == 0;
}

bool bb_gnuplot_whole(const char *path)
{
    static const struct {
        const char *extension, *end;
    } formats[] = {{".png", "IEND\xAE\x42\x60\x82"}, {".svg", "</svg>"}, {".pdf", "%%EOF"}};
    const size_t name = strlen(path);
    const char *end = NULL;
    char *data = NULL;
    size_t size = 0;
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        if (ends_with(path, name, formats[i].extension))
            end = formats[i].end;
    if (end == NULL)
        return true;
    if (bb_file_read(path, PICTURE_BYTES_MAX, "chart", &data, &size) != BB_OK)
        return false;
    while (size > 0 && (data[size - 1] == '\n' || data[size - 1] == '\r'))
        size--;
    bool whole = ends_with(data, size, end);
    free(data);
    return whole;
}
