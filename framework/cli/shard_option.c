#include "framework/cli/shard_option.h"

#include "framework/base/number.h"

#include <stdio.h>
#include <string.h>

bb_status bb_shard_parse(const char *text, const char *what, bb_shard *shard)
{
    char index_text[16] = "";
    size_t length = strcspn(text, "/");
    uint64_t index = 0, count = 0;
    if (length < sizeof index_text)
        memcpy(index_text, text, length);
    if (text[length] != '/' || !bb_read_whole(index_text, &index) ||
        !bb_read_whole(text + length + 1, &count) || index < 1 || index > count ||
        count > BB_SHARDS_MAX)
        return bb_fail(BB_INVALID, "%s is '%.40s', must be I/N with I from 1 to N, such as 2/8",
                       what, text);
    *shard = (bb_shard){.index = (uint32_t)index, .count = (uint32_t)count};
    return BB_OK;
}
