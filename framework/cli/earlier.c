#include "framework/cli/earlier.h"

#include "framework/cli/inputs.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

/* Files that are moved. The results are last: if another file cannot be moved, they stay. */
static const char *const moved[] = {"report.html", "tables.txt", "report-charts", "results.json"};

static bb_status make(const char *path)
{
    if (mkdir(path, 0777) == 0 || errno == EEXIST)
        return BB_OK;
    return bb_fail(BB_INVALID, "cannot make %s for the results that are there: %s", path,
                   strerror(errno));
}

/* Makes FOLDER/earlier/20260102-030405, or the same with -2, -3 and so on at the end. */
static bb_status make_place(const char *folder, time_t written, char place[PATH_MAX])
{
    char parent[PATH_MAX], name[64];
    struct tm date;
    BB_TRY(bb_join_path(parent, folder, "earlier"));
    BB_TRY(make(parent));
    localtime_r(&written, &date);
    size_t length = strftime(name, sizeof name, "%Y%m%d-%H%M%S", &date);
    for (unsigned i = 1; i < 1000; i++) {
        if (i > 1)
            snprintf(name + length, sizeof name - length, "-%u", i);
        BB_TRY(bb_join_path(place, parent, name));
        if (mkdir(place, 0777) == 0)
            return BB_OK;
        if (errno != EEXIST)
            break;
    }
    return bb_fail(BB_INVALID, "cannot make %s for the results that are there: %s", place,
                   strerror(errno));
}

bb_status bb_keep_earlier(const char *folder, bool quiet)
{
    char path[PATH_MAX], place[PATH_MAX], target[PATH_MAX];
    struct stat info;
    BB_TRY(bb_join_path(path, folder, "results.json"));
    if (stat(path, &info) != 0)
        return BB_OK;
    BB_TRY(make_place(folder, info.st_mtime, place));
    for (size_t i = 0; i < sizeof moved / sizeof moved[0]; i++) {
        BB_TRY(bb_join_path(path, folder, moved[i]));
        BB_TRY(bb_join_path(target, place, moved[i]));
        if (rename(path, target) != 0 && errno != ENOENT)
            return bb_fail(BB_INVALID, "cannot move %s to %s: %s", path, target, strerror(errno));
    }
    if (!quiet)
        fprintf(stderr, "moved the results that were in %s to %s\n", folder, place);
    return BB_OK;
}
