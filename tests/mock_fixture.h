/* Programs run on the mock GPU (tests/mock_gpu), and what it counted. */
#ifndef BB_TEST_MOCK_FIXTURE_H
#define BB_TEST_MOCK_FIXTURE_H

#include "tests/program_fixture.h"

/* Before a program: the mock GPU, with `variables` of it as the shell takes them. */
#define MOCK(variables) variables " MOCK_GPU_COUNTS=counts LD_PRELOAD=" BB_TEST_MOCK_GPU

/* A count of the last program that ran on it, such as "maps"; 0 if there is none of the name. */
static inline unsigned long counted(const char *name)
{
    static char text[1 << 16];
    char line[160];
    read_file("counts", text, sizeof text);
    snprintf(line, sizeof line, "%s ", name);
    const char *at = strncmp(text, line, strlen(line)) == 0 ? text - 1 : NULL;
    for (const char *end = text; at == NULL && (end = strchr(end, '\n')) != NULL; end++)
        if (strncmp(end + 1, line, strlen(line)) == 0)
            at = end;
    return at != NULL ? strtoul(at + 1 + strlen(line), NULL, 10) : 0;
}

#endif
