/* Gives a target its kept corpus, and then seeded mutations of it: replay FOLDER DICTIONARY COUNT.
 * The test that needs no clang; no dictionary is "". Prints how many inputs there were. */
#include "framework/base/random.h"
#include "tests/fuzz/fuzz.h"

#include <dirent.h>
#include <signal.h>

enum { FILES = 512, INPUT = 1 << 16, WORDS = 256 };
enum { SECONDS = 20 }; /* that one input may take, on the slowest machine */

typedef struct bytes {
    uint8_t *data;
    size_t size;
} bytes;

static bytes corpus[FILES], words[WORDS];
static size_t file_count, word_count;
static uint8_t input[INPUT];
static size_t input_size;

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name); /* in any locale the same */
}

static bytes read_whole(const char *path)
{
    FILE *file = fopen(path, "rb");
    bytes b = {malloc(INPUT), 0};
    if (file == NULL || b.data == NULL) {
        fprintf(stderr, "replay: cannot read %s\n", path);
        exit(2);
    }
    b.size = fread(b.data, 1, INPUT, file);
    fclose(file);
    return b;
}

static void read_corpus(const char *folder)
{
    struct dirent **names;
    int count = scandir(folder, &names, NULL, by_name);
    for (int i = 0; i < count; i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, names[i]->d_name);
        if (names[i]->d_name[0] != '.' && file_count < FILES)
            corpus[file_count++] = read_whole(path);
        free(names[i]);
    }
    if (file_count == 0) {
        fprintf(stderr, "replay: no corpus in %s\n", folder);
        exit(2);
    }
    free(names);
}

/* libFuzzer's form: "text" on a line, with \xHH, \\ and \". */
static void read_dictionary(const char *path)
{
    char line[1024];
    FILE *file = path[0] != '\0' ? fopen(path, "r") : NULL;
    while (file != NULL && word_count < WORDS && fgets(line, sizeof line, file) != NULL) {
        const char *from = strchr(line, '"');
        if (line[0] == '#' || from == NULL)
            continue;
        bytes word = {malloc(strlen(line)), 0};
        for (from++; word.data != NULL && *from != '"' && *from != '\0'; from++) {
            unsigned code = (unsigned char)*from;
            if (*from == '\\' && from[1] == 'x' && sscanf(from + 2, "%2x", &code) == 1)
                from += 3;
            else if (*from == '\\')
                code = (unsigned char)*++from;
            word.data[word.size++] = (uint8_t)code;
        }
        words[word_count++] = word;
    }
    if (file != NULL)
        fclose(file);
}

/* ---- mutations ---- */

static size_t below(bb_random *random, size_t limit)
{
    return limit > 0 ? (size_t)(bb_random_u64(random) % limit) : 0;
}

/* Replaces `removed` bytes at `at` by others. */
static void replace(size_t at, size_t removed, const uint8_t *data, size_t size)
{
    if (at > input_size || removed > input_size - at || input_size - removed + size > INPUT)
        return;
    memmove(input + at + size, input + at + removed, input_size - at - removed);
    if (size > 0)
        memcpy(input + at, data, size);
    input_size = input_size - removed + size;
}

static void mutate(bb_random *random)
{
    size_t at = below(random, input_size + 1), rest = input_size - at;
    const bytes *other = &corpus[below(random, file_count)];
    size_t from = below(random, other->size + 1);
    uint8_t byte = (uint8_t)bb_random_u64(random);
    switch (below(random, 7)) {
    case 0:
        if (rest > 0)
            input[at] ^= (uint8_t)(1u << below(random, 8));
        break;
    case 1:
        replace(at, rest > 0, &byte, 1);
        break;
    case 2:
        replace(at, 0, &byte, 1);
        break;
    case 3:
        replace(at, below(random, rest < 32 ? rest + 1 : 32), NULL, 0);
        break;
    case 4:
        replace(at, below(random, rest < 32 ? rest + 1 : 32), other->data + from,
                below(random, other->size - from + 1));
        break;
    case 5:
        input_size = at;
        break;
    default:
        if (word_count > 0) {
            const bytes *word = &words[below(random, word_count)];
            replace(at, below(random, 2) * (rest < word->size ? rest : word->size), word->data,
                    word->size);
        }
        break;
    }
}

/* What the target has now: kept where it ends the process. */
static bytes given;

void __sanitizer_set_death_callback(void (*callback)(void)) __attribute__((weak));

static void keep_finding(void)
{
    static const char said[] = "replay: the input is kept in replay-finding\n";
    int file = open("replay-finding", O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0 || write(file, given.data, given.size) != (ssize_t)given.size)
        return;
    close(file);
    (void)!write(2, said, sizeof said - 1);
}

static void on_signal(int number)
{
    keep_finding();
    signal(number, SIG_DFL);
    raise(number);
}

/* On a copy of its own: to read on is to be seen. */
static void give(const uint8_t *data, size_t size)
{
    uint8_t *copy = malloc(size > 0 ? size : 1);
    if (copy == NULL)
        exit(2);
    if (size > 0)
        memcpy(copy, data, size);
    given = (bytes){copy, size};
    alarm(SECONDS);
    (void)LLVMFuzzerTestOneInput(copy, size);
    free(copy);
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: replay FOLDER DICTIONARY COUNT\n");
        return 2;
    }
    size_t count = strtoull(argv[3], NULL, 10);
    signal(SIGABRT, on_signal);
    signal(SIGALRM, on_signal);
    if (__sanitizer_set_death_callback != NULL)
        __sanitizer_set_death_callback(keep_finding);
    else
        signal(SIGSEGV, on_signal);
    read_corpus(argv[1]);
    read_dictionary(argv[2]);
    give(NULL, 0);
    for (size_t i = 0; i < file_count; i++)
        give(corpus[i].data, corpus[i].size);
    for (size_t i = 0; i < count; i++) {
        const bytes *base = &corpus[i % file_count];
        bb_random random = bb_random_make(1, i);
        input_size = base->size;
        memcpy(input, base->data, base->size);
        for (size_t n = 1 + below(&random, 4); n > 0; n--)
            mutate(&random);
        give(input, input_size);
    }
    for (size_t i = 0; i < file_count; i++)
        free(corpus[i].data);
    for (size_t i = 0; i < word_count; i++)
        free(words[i].data);
    printf("%zu files, %zu mutations\n", file_count, count);
    return 0;
}
