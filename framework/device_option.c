#include "framework/device_option.h"

#include "framework/builder.h"

#include <string.h>

bb_status bb_open_device(const bb_cli *cli, bb_device **device)
{
    const char *word = bb_cli_value(cli, "form");
    bb_form form = BB_FORM_AUTO;
    if (word != NULL && strcmp(word, "cpu") == 0)
        form = BB_FORM_CPU;
    else if (word != NULL && strcmp(word, "gpu") == 0)
        form = BB_FORM_GPU;
    else if (word != NULL && strcmp(word, "auto") != 0)
        return bb_fail(BB_INVALID, "--form is '%s', must be auto, cpu or gpu", word);
    return bb_device_open(bb_cli_value(cli, "device"), form, bb_cli_value(cli, "kernels-from"),
                          device);
}

bb_status bb_load_plugins(const bb_cli *cli)
{
    uint32_t count;
    char *const *paths = bb_cli_values(cli, "plugin", &count);
    for (uint32_t i = 0; i < count; i++)
        BB_TRY(bb_plugin_load(paths[i]));
    return BB_OK;
}
