/* Runs a command of bvhbench again and again, each time with another of its calls failing
 * (faults.cpp): driver LIBRARY PROGRAM TRACER COMMAND. By default each place in the code that calls
 * something fails once; with BVHBENCH_TEST_FAULTS set, each stack that leads to one.
 *
 * Whatever fails: the program ends with 0 and nothing missing, with 1 and a result file that says
 * what failed, or with 2 and one line; it leaks nothing, and leaves no file half-written.
 * Exit status: 0 all did; 1 one did not, and standard error says which. */
#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { STACKS = 8192, TEXT = 1 << 16, COMMAND = 8192 };

#define PREPARED_RUN                                                                               \
    "run --scene cube --builder lbvh --kernel stack --rays primary --size 2x2 --repeats 1 --quick" \
    " --no-pictures --charts no --quiet"

/* What is run in the folder, after `before`, and writes into out/. */
static const struct {
    const char *name, *before, *arguments;
} commands[] = {
    {"run", "true",
     "run --scene cube --builder lbvh --kernel stack --rays primary --size 2x2 --repeats 1 --quick"
     " --charts no --quiet --out out"},
    {"check", "true", "check --scene cube --builder lbvh --side 6"},
    {"report", "\"$P\" " PREPARED_RUN " --out a && \"$P\" " PREPARED_RUN " --out b && mkdir -p out",
     "report a b --charts no --out out/report.html"},
    {"render", "mkdir -p out",
     "render --scene cube --builder lbvh --show heat --size 8x8 --out out/heat.png"},
    {"rays", "mkdir -p out", "rays --scene cube --rays diffuse --size 4x4 --out out/a.rays"},
    {"judge",
     "\"$P\" rays --scene cube --rays primary --size 4x4 --out a.rays && \"$T\" a.rays a.hits",
     "judge --scene cube --rays-file a.rays --hits a.hits --out out"},
};

static char folder[] = "/tmp/bvhbench-faults-XXXXXX";
static const char *library, *program, *before, *arguments;
static char out[TEXT], err[TEXT];

typedef struct call {
    char line[2048]; /* KIND HASH FRAME ... */
    char kind[40], hash[20];
    char site[64]; /* kind and first frame */
} call;

static call calls[STACKS];
static size_t call_count;

/* ---- running ---- */

static size_t read_text(const char *name, char *text, size_t room)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    size_t size = file != NULL ? fread(text, 1, room - 1, file) : 0;
    text[size] = '\0';
    if (file != NULL)
        fclose(file);
    return size;
}

/* Status as the shell has it: a signal's number and 128. */
static int shell(const char *text)
{
    int status = system(text);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* LeakSanitizer itself breaks now and then (tests/again.sh). */
static int run(const char *variables)
{
    char text[COMMAND];
    int status = 0;
    snprintf(text, sizeof text,
             "cd %s && rm -rf out && { %s; } >/dev/null 2>&1; exec timeout -s KILL 60 env "
             "LD_PRELOAD='%s' %s '%s' %s"
             " >stdout 2>stderr </dev/null",
             folder, before, library, variables, program, arguments);
    for (int attempt = 0; attempt < 3; attempt++) {
        status = shell(text);
        read_text("stdout", out, sizeof out);
        read_text("stderr", err, sizeof err);
        if (strstr(err, "LeakSanitizer has encountered a fatal error") == NULL)
            break;
    }
    return status;
}

/* ---- what may be left ---- */

static const char *fault;

static bool wrong(const char *what)
{
    fault = what;
    return false;
}

static cJSON *read_json(const char *name)
{
    static char text[1 << 22];
    return read_text(name, text, sizeof text) > 0 ? cJSON_Parse(text) : NULL;
}

static bool exists(const char *name)
{
    char path[512];
    struct stat info;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return stat(path, &info) == 0;
}

/* Ends as files of its kind do. */
static bool is_whole(const char *name, const char *end, size_t size)
{
    static char text[1 << 22];
    size_t got = read_text(name, text, sizeof text);
    return !exists(name) || (got >= size && memcmp(text + got - size, end, size) == 0);
}

static bool check_files(void)
{
    char text[COMMAND];
    cJSON *results = read_json("out/results.json");
    bool good = results != NULL || !exists("out/results.json");
    cJSON_Delete(results);
    if (!good)
        return wrong("results.json is half-written");
    if (!is_whole("out/report.html", "</html>\n", 8))
        return wrong("report.html is half-written");
    if (!is_whole("out/heat.png", "IEND\xae\x42\x60\x82", 8))
        return wrong("heat.png is half-written");
    snprintf(text, sizeof text,
             "cd %s && [ -z \"$(find . -name '*.tmp' -o -name '*.part' -o -name '.bvhbench-*')\" ]",
             folder);
    return shell(text) == 0 || wrong("a temporary file is left");
}

/* One line of the program's own and nothing else, which names what it could not do. */
static bool check_refusal(void)
{
    const char *end = strchr(err, '\n');
    if (strncmp(err, "bvhbench: ", 10) != 0 || end == NULL || end[1] != '\0')
        return wrong("exit status 2 without one line");
    return true;
}

/* How many builds and traces are as they should be, and how many are not. */
static void count_rows(const cJSON *results, int counts[2])
{
    const cJSON *row;
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(results, "rows"))
    {
        const char *status = cJSON_GetStringValue(cJSON_GetObjectItem(row, "status"));
        if (status != NULL && strcmp(status, "unsupported") == 0)
            continue; /* a query that Embree lacks on this processor */
        if (cJSON_HasObjectItem(row, "builder") && !cJSON_HasObjectItem(row, "maker"))
            counts[status == NULL || strcmp(status, "ok") != 0]++;
    }
}

/* Of what the command writes when nothing fails. */
static int expected_rows;

static bool check_results(int status)
{
    cJSON *results = read_json("out/results.json");
    int counts[2] = {0, 0};
    count_rows(results, counts);
    cJSON_Delete(results);
    if (expected_rows == 0)
        expected_rows = counts[0];
    if (status == 0 && (counts[0] < expected_rows || counts[1] > 0))
        return wrong("exit status 0, but something was not measured");
    if (status == 1 && expected_rows > 0 && counts[1] == 0)
        return wrong("exit status 1, but the results do not say what failed");
    return true;
}

static bool check(int status)
{
    if (strstr(err, "Sanitizer") != NULL || strstr(err, "runtime error") != NULL)
        return wrong("a sanitizer's finding");
    if (status != 0 && status != 1 && status != 2)
        return wrong("a crash, a hang or an exit status of its own");
    if (status == 2 && !check_refusal())
        return false;
    if (status != 2 && !check_results(status))
        return false;
    return check_files();
}

/* ---- which calls there are ---- */

static void read_calls(void)
{
    char path[512];
    snprintf(path, sizeof path, "%s/calls", folder);
    FILE *file = fopen(path, "r");
    while (file != NULL && call_count < STACKS &&
           fgets(calls[call_count].line, sizeof calls[0].line, file) != NULL) {
        call *c = &calls[call_count];
        char kind[40] = "", frame[20] = "";
        if (sscanf(c->line, "%39s %19s %19s", kind, c->hash, frame) < 3)
            continue;
        memcpy(c->kind, kind, sizeof kind);
        snprintf(c->site, sizeof c->site, "%s %s", kind, frame);
        call_count++;
    }
    if (file != NULL)
        fclose(file);
}

static bool is_first_of_site(size_t i)
{
    for (size_t k = 0; k < i; k++)
        if (strcmp(calls[k].site, calls[i].site) == 0)
            return false;
    return true;
}

static void say(const call *c, int status)
{
    fprintf(stderr, "%s: exit status %d: %s; BVHBENCH_FAULTS_STACK=%s %s: %s%s\n", c->kind, status,
            fault, c->hash, arguments, c->line, err);
}

/* Each that is wanted fails once; returns how many were not coped with. */
static size_t fail_each(bool all)
{
    size_t sites = 0, failed = 0, found = 0, statuses[3] = {0, 0, 0};
    for (size_t i = 0; i < call_count; i++) {
        char variables[64];
        bool first = is_first_of_site(i);
        sites += first;
        if (!first && !all)
            continue;
        snprintf(variables, sizeof variables, "BVHBENCH_FAULTS_STACK=%s", calls[i].hash);
        int status = run(variables);
        failed++;
        if (!check(status)) {
            say(&calls[i], status);
            found++;
        }
        if (status >= 0 && status <= 2)
            statuses[status]++;
    }
    printf("%zu places, %zu stacks; %zu failures: %zu ended with 0, %zu with 1, %zu with 2; %zu "
           "findings\n",
           sites, call_count, failed, statuses[0], statuses[1], statuses[2], found);
    return found;
}

static int start(const char *name, const char *tracer)
{
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
        if (strcmp(commands[i].name, name) == 0) {
            before = commands[i].before;
            arguments = commands[i].arguments;
        }
    if (arguments == NULL || mkdtemp(folder) == NULL)
        return 2;
    setenv("P", program, 1);
    setenv("T", tracer, 1);
    char text[COMMAND];
    snprintf(text, sizeof text, "cd %s && %s", folder, before);
    if (shell(text) != 0)
        return 2;
    before = strstr(before, "mkdir -p out") != NULL ? "mkdir -p out" : "true";
    int status = run(""); /* compiles what is not yet in the driver's cache */
    status = status == 0 ? run("BVHBENCH_FAULTS_LOG=calls") : status;
    if (status != 0 || !check(status)) {
        fprintf(stderr, "without a failure: exit status %d: %s\n%s", status,
                fault != NULL ? fault : "", err);
        return 2;
    }
    read_calls();
    return call_count > 0 ? 0 : 2;
}

int main(int argc, char **argv)
{
    if (argc != 5) {
        fprintf(stderr, "usage: driver LIBRARY PROGRAM TRACER COMMAND\n");
        return 2;
    }
    library = argv[1];
    program = argv[2];
    int status = start(argv[4], argv[3]);
    if (status == 0)
        status = fail_each(getenv("BVHBENCH_TEST_FAULTS") != NULL) > 0;
    char text[COMMAND];
    snprintf(text, sizeof text, "rm -rf %s", folder);
    (void)!shell(text);
    return status;
}
