/* What was given for an option, as text, number or size. */
#include "framework/cli/cli.h"

#include "framework/base/number.h"
#include "framework/base/shell_word.h"
#include "framework/scene/camera.h"

#include <stdlib.h>
#include <string.h>

static int find(const bb_command *command, const char *name)
{
    for (int i = 0; command->options[i].name != NULL; i++)
        if (strcmp(command->options[i].name, name) == 0)
            return i;
    return -1;
}

const char *bb_cli_value(const bb_cli *cli, const char *name)
{
    int i = find(cli->command, name);
    return i >= 0 && cli->counts[i] > 0 ? cli->values[i][cli->counts[i] - 1] : NULL;
}

char *const *bb_cli_values(const bb_cli *cli, const char *name, uint32_t *count)
{
    int i = find(cli->command, name);
    *count = i >= 0 ? cli->counts[i] : 0;
    return i >= 0 ? cli->values[i] : NULL;
}

bb_status bb_cli_u64(const bb_cli *cli, const char *name, uint64_t fallback, uint64_t low,
                     uint64_t high, uint64_t *out)
{
    const char *value = bb_cli_value(cli, name);
    uint64_t number;
    char range[BB_RANGE_TEXT];
    *out = fallback;
    if (value == NULL)
        return BB_OK;
    if (!bb_read_whole(value, &number) || number < low || number > high)
        return bb_fail(BB_INVALID, "--%s is '%s', must be %s", name, value,
                       bb_range_of_whole(low, high, range));
    *out = number;
    return BB_OK;
}

bb_status bb_cli_double(const bb_cli *cli, const char *name, double fallback, double low,
                        double high, double *out)
{
    const char *value = bb_cli_value(cli, name);
    double number;
    *out = fallback;
    if (value == NULL)
        return BB_OK;
    if (!bb_read_real(value, &number) || number < low || number > high)
        return bb_fail(BB_INVALID, "--%s is '%s', must be a number from %g to %g", name, value, low,
                       high);
    *out = number;
    return BB_OK;
}

bb_status bb_cli_size(const bb_cli *cli, const char *name, uint32_t *width, uint32_t *height)
{
    enum { SIDE_MAX = 65536 };
    const char *value = bb_cli_value(cli, name);
    if (value == NULL)
        return BB_OK;
    char first[32] = "";
    size_t length = strcspn(value, "x");
    uint64_t w, h;
    if (length < sizeof first)
        memcpy(first, value, length);
    if (value[length] != 'x' || !bb_read_whole(first, &w) || !bb_read_whole(value + length + 1, &h))
        return bb_fail(BB_INVALID, "--%s is '%s', must be WIDTHxHEIGHT, such as 512x512", name,
                       value);
    if (w < 1 || h < 1 || w > SIDE_MAX || h > SIDE_MAX || w * h > BB_PIXELS_MAX)
        return bb_fail(BB_INVALID,
                       "--%s is '%s': width and height must be from 1 to %d, and %u pixels at most "
                       "together",
                       name, value, SIDE_MAX, (unsigned)BB_PIXELS_MAX);
    *width = (uint32_t)w;
    *height = (uint32_t)h;
    return BB_OK;
}

char *bb_cli_command_line(const bb_cli *cli)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL)
        return NULL;
    fputs("bvhbench", out);
    for (int i = 1; i < cli->argc; i++) {
        fputc(' ', out);
        bb_put_shell_word(out, cli->argv[i]);
    }
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}
