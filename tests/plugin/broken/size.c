/* A plug-in of this ABI version whose registration has another size: nothing behind its head is
 * there to be read. */
#include "framework/builder/builder.h"

typedef struct head {
    char magic[8];
    uint32_t abi_version;
    uint32_t bytes;
} head;

extern const head bb_plugin;
__attribute__((visibility("default"))) const head bb_plugin = {BB_PLUGIN_MAGIC, BB_ABI_VERSION, 8};
