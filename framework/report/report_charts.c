/* Draws the charts as pictures: gnuplot runs a script, which is written beside them. */
#include "framework/base/file.h"
#include "framework/base/steering.h"
#include "framework/report/chart_script.h"
#include "framework/report/gnuplot.h"
#include "framework/report/report.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bb_status bb_report_charts_folder(const char *page, char *folder, size_t capacity)
{
    size_t length = strlen(page);
    if (length > 5 && strcmp(page + length - 5, ".html") == 0)
        length -= 5;
    if (snprintf(folder, capacity, "%.*s-charts", (int)length, page) >= (int)capacity)
        return bb_fail(BB_INVALID, "%s: the path is too long", page);
    return BB_OK;
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
        if (to != NULL && !bb_gnuplot_whole(source)) {
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
static bb_status draw_beside(const char *folder, const char *script, bool any)
{
    char part[PATH_MAX], path[PATH_MAX];
    if (snprintf(part, sizeof part, "%s.part", folder) >= (int)sizeof part ||
        snprintf(path, sizeof path, "%s/%s", part, bb_gnuplot_script) >= (int)sizeof path)
        return bb_fail(BB_INVALID, "%s: the path is too long", folder);
    if (mkdir(part, 0777) != 0 && errno != EEXIST)
        return bb_fail(BB_INVALID, "charts: cannot make %s: %s", part, strerror(errno));
    bb_status status = bb_file_write(path, script, strlen(script), "charts");
    if (status == BB_OK && any)
        status = bb_gnuplot_draw(part);
    if (status == BB_OK)
        status = empty_folder(part, folder);
    if (status == BB_OK)
        return BB_OK;
    char reason[1024];
    snprintf(reason, sizeof reason, "%s", bb_message());
    (void)empty_folder(part, NULL);
    return bb_fail(status, "%s", reason);
}

/* The script of all charts, or of a figure alone, from malloc. */
static bb_status make_script(bb_results *results, const bb_chart_print *figure, char **script,
                             uint32_t *pictures)
{
    bb_charts charts = {0};
    char *text = NULL;
    size_t size = 0;
    *script = NULL;
    BB_TRY(bb_charts_make(results, &charts));
    FILE *out = open_memstream(&text, &size);
    bb_status status = out != NULL ? bb_charts_script(&charts, figure, out, pictures)
                                   : bb_fail(BB_FAILED, "charts: no memory");
    if (out != NULL && (ferror(out) | fclose(out)) != 0 && status == BB_OK)
        status = bb_fail(BB_FAILED, "charts: no memory for the script");
    if (status == BB_OK && (*script = bb_utf8_text(text)) == NULL)
        status = bb_fail(BB_FAILED, "charts: no memory for the script");
    free(text);
    bb_charts_free(&charts);
    return status;
}

bb_status bb_report_charts(bb_results *results, const char *folder, uint32_t *pictures)
{
    char *script;
    *pictures = 0;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return bb_fail(BB_INVALID, "cannot make the folder of the charts %s: %s", folder,
                       strerror(errno));
    BB_TRY(make_script(results, NULL, &script, pictures));
    bb_status status = draw_beside(folder, script, *pictures > 0);
    free(script);
    return status;
}

/* Draws in the folder, which is empty, and moves what was drawn to `path`. */
static bb_status draw_figure(const char *folder, const char *drawn, const char *script,
                             const char *path)
{
    char file[PATH_MAX], picture[PATH_MAX];
    if (snprintf(file, sizeof file, "%s/%s", folder, bb_gnuplot_script) >= (int)sizeof file ||
        snprintf(picture, sizeof picture, "%s/%s", folder, drawn) >= (int)sizeof picture)
        return bb_fail(BB_INVALID, "%s: the path is too long", path);
    BB_TRY(bb_file_write(file, script, strlen(script), "figure"));
    BB_TRY(bb_gnuplot_draw(folder));
    if (!bb_gnuplot_whole(picture))
        return bb_fail(BB_FAILED, "report: %s is not whole: is there room on the disk?", picture);
    if (rename(picture, path) != 0)
        return bb_fail(BB_FAILED, "report: cannot make %s: %s", path, strerror(errno));
    return BB_OK;
}

bb_status bb_report_figure(bb_results *results, const char *name, double width_mm, const char *path)
{
    char *script, part[PATH_MAX], drawn[16], reason[1024];
    const char *format = strrchr(path, '.');
    uint32_t pictures;
    /* whatever `path` is, gnuplot sees a name of ours */
    snprintf(drawn, sizeof drawn, "figure%.4s", format != NULL ? format : ".pdf");
    const bb_chart_print figure = {name, width_mm, drawn};
    if (snprintf(part, sizeof part, "%s.XXXXXX", path) >= (int)sizeof part)
        return bb_fail(BB_INVALID, "%s: the path is too long", path);
    BB_TRY(make_script(results, &figure, &script, &pictures));
    bb_status status = mkdtemp(part) != NULL
                           ? draw_figure(part, drawn, script, path)
                           : bb_fail(BB_INVALID, "report: cannot make a folder beside %s: %s", path,
                                     strerror(errno));
    free(script);
    snprintf(reason, sizeof reason, "%s", bb_message());
    (void)empty_folder(part, NULL);
    return status == BB_OK ? BB_OK : bb_fail(status, "%s", reason);
}
