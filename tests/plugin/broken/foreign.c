/* A shared object with a bb_plugin of its own, which means something else. */
extern int bb_plugin;
__attribute__((visibility("default"))) int bb_plugin = 7;
