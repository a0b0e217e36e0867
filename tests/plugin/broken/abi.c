/* A plug-in of another ABI version: nothing behind its head is there to be read. */
#include <stdint.h>

typedef struct head {
    char magic[8];
    uint32_t abi_version;
    uint32_t bytes;
} head;

extern const head bb_plugin;
__attribute__((visibility("default"))) const head bb_plugin = {"BVHBPLUG", 999, sizeof(head)};
