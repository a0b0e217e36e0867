/* Draws the charts as SVG and PNG: gnuplot runs a script, which is written beside them. */
#include "framework/base/file.h"
#include "framework/base/steering.h"
#include "framework/report/chart_script.h"
#include "framework/report/report.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static const char script_name[] = "charts.gp";
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

bb_status bb_report_charts_folder(const char *page, char *folder, size_t capacity)
{
    size_t length = strlen(page);
    if (length > 5 && strcmp(page + length - 5, ".html") == 0)
        length -= 5;
    if (snprintf(folder, capacity, "%.*s-charts", (int)length, page) >= (int)capacity)
        return bb_fail(BB_INVALID, "%s: the path is too long", page);
    return BB_OK;
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

/* Runs `gnuplot charts.gp` in `folder` without the user's settings. Its standard error goes to
 * `errors`. */
static int start(const char *folder, int errors, pid_t *child)
{
    char *arguments[] = {"gnuplot", "--default-settings", (char *)script_name, NULL};
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

static bb_status draw(const char *folder)
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
        return bb_fail(BB_FAILED, "charts: gnuplot failed on %s/%s:%s", folder, script_name,
                       complaint[0] != '\0' ? complaint : " it does not say why");
    return BB_OK;
}

static bool ends_with(const char *text, size_t length, const char *end)
{
    size_t size = strlen(end);
    return length >= size && memcmp(text + length - size, end, size) == 0;
}

/* Checks the end of a picture, since gnuplot does not report a full disk. */
static bool is_whole(const char *path)
{
    static const char png_end[] = "IEND\xAE\x42\x60\x82", svg_end[] = "</svg>";
    size_t name = strlen(path), size = 0;
    bool png = ends_with(path, name, ".png");
    char *data = NULL;
    if (!png && !ends_with(path, name, ".svg"))
        return true;
    if (bb_file_read(path, PICTURE_BYTES_MAX, "chart", &data, &size) != BB_OK)
        return false;
    while (!png && size > 0 && (data[size - 1] == '\n' || data[size - 1] == '\r'))
        size--;
    bool whole = ends_with(data, size, png ? png_end : svg_end);
    free(data);
    return whole;
}

/* Moves each file of `from` into `to`, or removes it if `to` is NULL, then removes `from`. */
static bb_status empty_folder(const char *from, const char *to)
{
    DIR *entries = opendir(from);
    struct dirent *entry;
    bb_status status = BB_OK;
    if (entries == NULL)
        return bb_fail(BB_FAILED, "charts: cannot read %s: %s", from, strerror(errno));
    while ((entry = readdir(entries)) != NULL) {
        char source[PATH_MAX], target[PATH_MAX];
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
            snprintf(source, sizeof source, "%s/%s", from, entry->d_name) >= (int)sizeof source)
            continue;
        if (to != NULL && !is_whole(source)) {
            closedir(entries);
            return bb_fail(BB_FAILED, "charts: %s is not whole: is there room on the disk?",
                           source);
        }
        bool fits = to != NULL && snprintf(target, sizeof target, "%s/%s", to, entry->d_name) <
                                      (int)sizeof target;
        if (fits && rename(source, target) != 0)
            status = bb_fail(BB_FAILED, "charts: cannot make %s: %s", target, strerror(errno));
        if (!fits)
            remove(source);
    }
    closedir(entries);
    rmdir(from);
    return status;
}

/* Writes the script and draws in a temporary folder, and moves its files when all are complete. A
 * failure keeps the earlier charts. */
static bb_status draw_beside(const char *folder, const char *script, size_t size, bool any)
{
    char part[PATH_MAX], path[PATH_MAX];
    if (snprintf(part, sizeof part, "%s.part", folder) >= (int)sizeof part ||
        snprintf(path, sizeof path, "%s/%s", part, script_name) >= (int)sizeof path)
        return bb_fail(BB_INVALID, "%s: the path is too long", folder);
    if (mkdir(part, 0777) != 0 && errno != EEXIST)
        return bb_fail(BB_INVALID, "charts: cannot make %s: %s", part, strerror(errno));
    bb_status status = bb_file_write(path, script, size, "charts");
    if (status == BB_OK && any)
        status = draw(part);
    if (status == BB_OK)
        status = empty_folder(part, folder);
    if (status == BB_OK)
        return BB_OK;
    char reason[1024];
    snprintf(reason, sizeof reason, "%s", bb_message());
    (void)empty_folder(part, NULL);
    return bb_fail(status, "%s", reason);
}

bb_status bb_report_charts(bb_results *results, const char *folder, uint32_t *pictures)
{
    bb_charts charts = {0};
    char *script = NULL;
    size_t size = 0;
    *pictures = 0;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return bb_fail(BB_INVALID, "cannot make the folder of the charts %s: %s", folder,
                       strerror(errno));
    BB_TRY(bb_charts_make(results, &charts));
    FILE *out = open_memstream(&script, &size);
    bb_status status = out != NULL ? bb_charts_script(&charts, out, pictures)
                                   : bb_fail(BB_FAILED, "charts: no memory");
    if (out != NULL && (ferror(out) | fclose(out)) != 0 && status == BB_OK)
        status = bb_fail(BB_FAILED, "charts: no memory for the script");
    char *valid = status == BB_OK ? bb_utf8_text(script) : NULL;
    if (status == BB_OK && valid == NULL)
        status = bb_fail(BB_FAILED, "charts: no memory for the script");
    if (status == BB_OK)
        status = draw_beside(folder, valid, strlen(valid), *pictures > 0);
    free(script);
    free(valid);
    bb_charts_free(&charts);
    return status;
}
