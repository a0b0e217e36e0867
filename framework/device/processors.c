#include "framework/device/processors.h"

#include <stdio.h>
#include <string.h>

/* Reads the first line of a file; "" if there is none. */
static void read_line(const char *folder, const char *name, char *line, size_t capacity)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "r");
    if (file == NULL || fgets(line, (int)capacity, file) == NULL)
        line[0] = '\0';
    line[strcspn(line, "\n")] = '\0';
    if (file != NULL)
        fclose(file);
}

/* Puts "on" or "off" for a file that is `on`, or another number. */
static void put_switch(const char *folder, const char *name, const char *on, char word[4])
{
    char line[16];
    read_line(folder, name, line, sizeof line);
    if (line[0] != '\0')
        strcpy(word, strcmp(line, on) == 0 ? "on" : "off");
}

static void put_governors(const char *folder, const cpu_set_t *mine, char *governor,
                          size_t capacity)
{
    for (int i = 0; i < CPU_SETSIZE; i++) {
        char name[64], line[32];
        if (!CPU_ISSET(i, mine))
            continue;
        snprintf(name, sizeof name, "cpu%d/cpufreq/scaling_governor", i);
        read_line(folder, name, line, sizeof line);
        const size_t used = strlen(governor);
        if (line[0] != '\0' && strstr(governor, line) == NULL)
            snprintf(governor + used, capacity - used, "%s%s", used > 0 ? " " : "", line);
    }
}

/* Puts the set as the kernel does, so that it can be compared with a file. */
static void put_list(const cpu_set_t *mine, char *list, size_t capacity)
{
    size_t used = 0;
    for (int i = 0; i < CPU_SETSIZE && used < capacity; i++) {
        const int first = i;
        if (!CPU_ISSET(i, mine))
            continue;
        while (i + 1 < CPU_SETSIZE && CPU_ISSET(i + 1, mine))
            i++;
        used += (size_t)snprintf(list + used, capacity - used, "%s%d", used > 0 ? "," : "", first);
        if (i > first && used < capacity)
            used += (size_t)snprintf(list + used, capacity - used, "-%d", i);
    }
}

void bb_processors_read(const char *folder, const cpu_set_t *mine, bb_processors *out)
{
    char online[sizeof out->list];
    *out = (bb_processors){.governor = ""};
    put_governors(folder, mine, out->governor, sizeof out->governor);
    put_switch(folder, "smt/active", "1", out->smt);
    put_switch(folder, "cpufreq/boost", "1", out->boost);
    put_switch(folder, "intel_pstate/no_turbo", "0", out->boost);
    put_list(mine, out->list, sizeof out->list);
    read_line(folder, "online", online, sizeof online);
    if (strcmp(out->list, online) == 0)
        strcpy(out->list, "all");
}
