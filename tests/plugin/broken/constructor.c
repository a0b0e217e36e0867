/* A plug-in whose constructor changes the process when it is loaded. */
#include "tests/plugin/broken/broken.h"

#include <sys/stat.h>

__attribute__((constructor)) static void change(void)
{
    umask(0);
}

static const bb_builder builder = BROKEN_BUILDER("constructor", build);
BB_PLUGIN(builder, NULL);
