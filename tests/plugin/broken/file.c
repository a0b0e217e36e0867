/* A plug-in with a device header of a name that is taken. */
#include "tests/plugin/broken/broken.h"

static const bb_builder builder = BROKEN_BUILDER("file", build);
static const bb_source files[] = {{"file.cl", "", files}, {"lanes.clh", "", files}, {0, 0, 0}};
BB_PLUGIN(builder, files);
