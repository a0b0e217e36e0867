/* A shared object that exports no bb_plugin. */
extern int bb_not_a_plugin;
int bb_not_a_plugin = 1;
