#include "framework/cli/inputs.h"

#include <stdio.h>
#include <sys/stat.h>

bb_status bb_join_path(char path[PATH_MAX], const char *folder, const char *name)
{
    if (snprintf(path, PATH_MAX, "%s/%s", folder, name) >= PATH_MAX)
        return bb_fail(BB_INVALID, "%s/%s: the path is too long", folder, name);
    return BB_OK;
}

bb_status bb_input_path(const char *argument, char path[PATH_MAX])
{
    struct stat info;
    if (stat(argument, &info) == 0 && S_ISDIR(info.st_mode))
        return bb_join_path(path, argument, "results.json");
    if (snprintf(path, PATH_MAX, "%s", argument) >= PATH_MAX)
        return bb_fail(BB_INVALID, "%.60s...: the path is too long", argument);
    return BB_OK;
}

bb_status bb_table_file_read(const char *argument, bb_table_file *file)
{
    char path[PATH_MAX];
    *file = (bb_table_file){NULL};
    BB_TRY(bb_input_path(argument, path));
    return bb_table_is_other(path, "run") ? bb_table_read(path, &file->other)
                                          : bb_results_read(path, &file->results);
}

const bb_table *bb_table_of_file(const bb_table_file *file)
{
    return file->results != NULL ? bb_results_table(file->results) : file->other;
}

void bb_table_file_free(bb_table_file *file)
{
    bb_results_destroy(file->results);
    bb_table_free(file->other);
}

bb_status bb_inputs_once(const bb_cli *cli)
{
    for (uint32_t i = 0; i < cli->positional_count; i++)
        for (uint32_t k = 0; k < i; k++) {
            char paths[2][PATH_MAX];
            struct stat files[2];
            BB_TRY(bb_input_path(cli->positional[k], paths[0]));
            BB_TRY(bb_input_path(cli->positional[i], paths[1]));
            if (stat(paths[0], &files[0]) == 0 && stat(paths[1], &files[1]) == 0 &&
                files[0].st_dev == files[1].st_dev && files[0].st_ino == files[1].st_ino)
                return bb_fail(BB_INVALID, "%s: %s is given twice: leave one out",
                               cli->command->name, paths[1]);
        }
    return BB_OK;
}
