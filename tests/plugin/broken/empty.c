/* A plug-in that registers no builder. */
#include "framework/builder/builder.h"

extern const bb_registration bb_plugin;
__attribute__((visibility("default"))) const bb_registration bb_plugin = {
    BB_PLUGIN_MAGIC, BB_ABI_VERSION, sizeof(bb_registration), NULL, NULL};
