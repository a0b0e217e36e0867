/* TetGen's pair of files: the .node, a line "@", the .ele. */
#include "tests/fuzz/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    size_t node = 0;
    while (node + 2 < size &&
           !(data[node] == '\n' && data[node + 1] == '@' && data[node + 2] == '\n'))
        node++;
    bool split = node + 2 < size;
    fuzz_file("scene.ele", split ? data + node + 3 : data, split ? size - node - 3 : 0);
    fuzz_scene("scene.node", data, split ? node + 1 : size);
    return 0;
}
