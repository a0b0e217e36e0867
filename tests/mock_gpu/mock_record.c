/* What went through the mock GPU: programs into a folder, counts into a file. */
#include "mock_gpu.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { KERNELS_MAX = 1024 };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static uint64_t counts[MOCK_CALLS];
static struct {
    char name[128];
    uint64_t launches;
} kernels[KERNELS_MAX];
static uint32_t kernel_count;

void mock_count(mock_call call)
{
    pthread_mutex_lock(&lock);
    counts[call]++;
    pthread_mutex_unlock(&lock);
}

void mock_count_launch(const char *kernel)
{
    mock_count(MOCK_LAUNCH);
    pthread_mutex_lock(&lock);
    uint32_t i = 0;
    while (i < kernel_count && strcmp(kernels[i].name, kernel) != 0)
        i++;
    if (i == kernel_count && i < KERNELS_MAX)
        snprintf(kernels[kernel_count++].name, sizeof kernels[i].name, "%s", kernel);
    if (i < KERNELS_MAX)
        kernels[i].launches++;
    pthread_mutex_unlock(&lock);
}

__attribute__((destructor)) static void write_counts(void)
{
    static const char *const names[MOCK_CALLS] = {
        [MOCK_LAUNCH] = "launches", [MOCK_READ] = "reads",   [MOCK_WRITE] = "writes",
        [MOCK_FILL] = "fills",      [MOCK_COPY] = "copies",  [MOCK_MAP] = "maps",
        [MOCK_FINISH] = "finishes", [MOCK_BUILD] = "builds", [MOCK_BUFFER] = "buffers",
        [MOCK_REFUSED] = "refused",
    };
    uint64_t all = 0;
    for (int i = 0; i < MOCK_CALLS; i++)
        all += counts[i];
    if (all == 0)
        return; /* a process around the program, such as `timeout` */
    FILE *file = mock.counts != NULL ? fopen(mock.counts, "w") : NULL;
    if (file == NULL)
        return;
    for (int i = 0; i < MOCK_CALLS; i++)
        fprintf(file, "%s %" PRIu64 "\n", names[i], counts[i]);
    for (uint32_t i = 0; i < kernel_count; i++)
        fprintf(file, "launches %s %" PRIu64 "\n", kernels[i].name, kernels[i].launches);
    fclose(file);
}

char *mock_program_text(cl_program program)
{
    size_t size = 0;
    clGetProgramInfo(program, CL_PROGRAM_SOURCE, 0, NULL, &size);
    char *text = calloc(1, size + 1);
    if (text == NULL)
        abort();
    clGetProgramInfo(program, CL_PROGRAM_SOURCE, size, text, NULL);
    return text;
}

void mock_program_name(const char *text, char *name, size_t capacity)
{
    const char *quote = strchr(text, '"');
    snprintf(name, capacity, "%.*s", quote != NULL ? (int)strcspn(quote + 1, "\"\n") : 0,
             quote != NULL ? quote + 1 : "");
}

static uint64_t hash_of(uint64_t hash, const char *text) /* FNV-1a */
{
    for (; *text != '\0'; text++)
        hash = (hash ^ (unsigned char)*text) * 1099511628211u;
    return hash;
}

/* By another name first: several programs may record into one folder. */
void mock_record_program(cl_program program, const char *options)
{
    char name[128], path[512], part[600];
    char *text = mock_program_text(program);
    if (options == NULL)
        options = "";
    mock_program_name(text, name, sizeof name);
    name[strcspn(name, ".")] = '\0';
    snprintf(path, sizeof path, "%s/%s-%016" PRIx64 ".cl", mock.record, name,
             hash_of(hash_of(14695981039346656037u, options), text));
    snprintf(part, sizeof part, "%s.%ld", path, (long)getpid());
    if (access(path, F_OK) != 0) {
        FILE *file = fopen(part, "w");
        if (file == NULL || fprintf(file, "// options: %s\n%s", options, text) < 0 ||
            fclose(file) != 0 || rename(part, path) != 0) {
            fprintf(stderr, "mock GPU: cannot write %s\n", path);
            abort();
        }
    }
    free(text);
}
