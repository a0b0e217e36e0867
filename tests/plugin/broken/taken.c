/* A plug-in whose name a built-in builder has. */
#include "tests/plugin/broken/broken.h"

static const bb_builder builder = BROKEN_BUILDER("sah", build);
BB_PLUGIN(builder, NULL);
