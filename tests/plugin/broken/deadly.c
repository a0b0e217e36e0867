/* A plug-in whose constructor ends the process. */
#include <stdlib.h>

__attribute__((constructor)) static void end(void)
{
    exit(0);
}
