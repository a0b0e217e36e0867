#include "framework/cli/earlier.h"

#include "framework/cli/inputs.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

enum { MOVED = 4 };

/* Names of the files that are moved. The results are last: if another file cannot be moved, they
 * stay. */
static void name_moved(const char *command, char names[MOVED][80])
{
    const bool run = strcmp(command, "run") == 0;
    snprintf(names[0], sizeof names[0], "%.64s.html", run ? "report" : command);
    snprintf(names[1], sizeof names[1], "%s", run ? "tables.txt" : "");
    snprintf(names[2], sizeof names[2], "%s", run ? "report-charts" : "");
    snprintf(names[3], sizeof names[3], "%.64s.json", run ? "results" : command);
}

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

bb_status bb_keep_earlier(const char *folder, const char *command, bool quiet)
{
    char path[PATH_MAX], place[PATH_MAX], target[PATH_MAX], moved[MOVED][80];
    struct stat info;
    name_moved(command, moved);
    BB_TRY(bb_join_path(path, folder, moved[MOVED - 1]));
    if (stat(path, &info) != 0)
        return BB_OK;
    BB_TRY(make_place(folder, info.st_mtime, place));
    for (int i = 0; i < MOVED; i++) {
        if (moved[i][0] == '\0')
            continue;
        BB_TRY(bb_join_path(path, folder, moved[i]));
        BB_TRY(bb_join_path(target, place, moved[i]));
        if (rename(path, target) != 0 && errno != ENOENT)
            return bb_fail(BB_INVALID, "cannot move %s to %s: %s", path, target, strerror(errno));
    }
    if (!quiet)
        fprintf(stderr, "moved the results that were in %s to %s\n", folder, place);
    return BB_OK;
}
