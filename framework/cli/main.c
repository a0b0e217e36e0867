#include "framework/cli/cli.h"

int main(int argc, char **argv)
{
    return bb_main(argc, argv);
}
