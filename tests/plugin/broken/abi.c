/* A plug-in of another ABI version: nothing but the version is there to be read. */
#include <stdint.h>

static const struct {
    uint32_t abi_version;
} foreign = {999};

extern const void *const bb_plugin;
const void *const bb_plugin = &foreign;
