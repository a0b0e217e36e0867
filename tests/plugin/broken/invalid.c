/* A plug-in without build(). */
#include "tests/plugin/broken/broken.h"

static const bb_builder builder = BROKEN_BUILDER("invalid", NULL);
BB_PLUGIN(builder, NULL);
