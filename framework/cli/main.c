#include "framework/cli/cli.h"

#include <stddef.h>

int main(int argc, char **argv)
{
    static const bb_command *const commands[] = {
        &bb_command_list,   &bb_command_run,       &bb_command_check,
        &bb_command_render, &bb_command_report,    &bb_command_rays,
        &bb_command_judge,  &bb_command_reproduce, NULL,
    };
    return bb_cli_main(argc, argv, commands);
}
