/* Reads and writes the keys of cells. */
#include "framework/record/cell.h"
#include "framework/base/number.h"
#include "framework/builder/registry.h"
#include "framework/builder/tracers.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- writing ---- */

static bool is_plain(unsigned char c)
{
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           (c != '\0' && strchr("._-:,=+", c) != NULL);
}

static void put(bb_key_writer *w, char c)
{
    w->full = w->full || w->length + 1 >= BB_CELL_KEY;
    if (!w->full)
        w->key[w->length++] = c;
}

void bb_key_put(bb_key_writer *w, const char *name, const char *value)
{
    static const char digits[] = "0123456789ABCDEF";
    if (value[0] == '\0')
        return;
    if (w->length > 0)
        put(w, '/');
    for (; *name != '\0'; name++)
        put(w, *name);
    put(w, '=');
    for (; *value != '\0'; value++) {
        unsigned char c = (unsigned char)*value;
        if (is_plain(c)) {
            put(w, *value);
            continue;
        }
        put(w, '%');
        put(w, digits[c >> 4]);
        put(w, digits[c & 15]);
    }
}

bb_status bb_cell_key_format(const bb_cell_parts *cell, char key[BB_CELL_KEY])
{
    bb_key_writer w = {.key = key};
    char size[32], most[16], seed[24], hash[20];
    bool traced = cell->rays[0] != '\0';
    snprintf(size, sizeof size, "%" PRIu32 "x%" PRIu32, cell->width, cell->height);
    snprintf(most, sizeof most, "%" PRIu32, cell->max_rays);
    snprintf(seed, sizeof seed, "%" PRIu64, cell->seed);
    snprintf(hash, sizeof hash, "%016" PRIx64, cell->rays_hash);
    bool made = traced && !cell->known_by_hash;
    bb_key_put(&w, "scene", cell->scene);
    bb_key_put(&w, "rays", cell->rays);
    bb_key_put(&w, "size", made ? size : "");
    bb_key_put(&w, "max-rays", made ? most : "");
    bb_key_put(&w, "seed", made || !traced ? seed : "");
    bb_key_put(&w, "view", cell->view);
    bb_key_put(&w, "rays-hash", cell->known_by_hash ? hash : "");
    bb_key_put(&w, "builder", cell->builder);
    bb_key_put(&w, "kernel", cell->kernel);
    bb_key_put(&w, "intersector", cell->intersector);
    key[w.length] = '\0';
    return w.full ? bb_fail(BB_INVALID, "cell '%.60s...': its key has more than %d bytes", key,
                            BB_CELL_KEY - 1)
                  : BB_OK;
}

/* ---- reading ---- */

static bb_status malformed(const char *key, const char *what)
{
    return bb_fail(BB_INVALID, "cell '%.80s%s': %s", key, strlen(key) > 80 ? "..." : "", what);
}

static int hex(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                  : -1;
}

/* Decodes bytes [at, end). */
static bb_status decode(const char *key, const char *at, const char *end, char value[BB_CELL_TEXT])
{
    size_t length = 0;
    while (at < end) {
        unsigned char c = (unsigned char)*at++;
        if (c == '%') {
            int high = end - at >= 2 ? hex(at[0]) : -1, low = high >= 0 ? hex(at[1]) : -1;
            if (low < 0 || high + low == 0)
                return malformed(key, "after a '%' two hexadecimal digits must follow, not 00");
            c = (unsigned char)(high << 4 | low);
            at += 2;
        } else if (!is_plain(c)) {
            return malformed(key, "it has a character that must be written as '%' and two digits");
        }
        if (length + 1 == BB_CELL_TEXT)
            return malformed(key, "a part of it is too long");
        value[length++] = (char)c;
    }
    value[length] = '\0';
    return length > 0 ? BB_OK : malformed(key, "a part of it is empty");
}

static bb_status read_number(const char *key, const char *text, uint64_t low, uint64_t high,
                             uint64_t *out)
{
    uint64_t number;
    if (!bb_read_whole(text, &number) || number < low || number > high)
        return malformed(key, "a number of it is none, or out of range");
    *out = number;
    return BB_OK;
}

static bb_status read_hash(const char *key, const char *text, uint64_t *hash)
{
    if (strlen(text) != 16 || strspn(text, "0123456789ABCDEFabcdef") != 16)
        return malformed(key, "its rays-hash is not 16 hexadecimal digits");
    *hash = strtoull(text, NULL, 16);
    return BB_OK;
}

static bb_status read_size(const char *key, char *text, bb_cell_parts *cell)
{
    char *x = strchr(text, 'x');
    uint64_t width = 0, height = 0;
    if (x == NULL)
        return malformed(key, "its size is not WIDTHxHEIGHT");
    *x = '\0';
    BB_TRY(read_number(key, text, 1, 65536, &width));
    BB_TRY(read_number(key, x + 1, 1, 65536, &height));
    cell->width = (uint32_t)width;
    cell->height = (uint32_t)height;
    return BB_OK;
}

static bb_status read_figure(const char *key, const char *name, char *text, bb_cell_parts *cell)
{
    if (strcmp(name, "size") == 0)
        return read_size(key, text, cell);
    if (strcmp(name, "seed") == 0)
        return read_number(key, text, 0, UINT64_MAX, &cell->seed);
    if (strcmp(name, "max-rays") == 0) {
        uint64_t most = 0;
        BB_TRY(read_number(key, text, 1, 1u << 30, &most));
        cell->max_rays = (uint32_t)most;
        return BB_OK;
    }
    cell->known_by_hash = true;
    return read_hash(key, text, &cell->rays_hash);
}

enum { FIGURE_COUNT = 4, TEXT_COUNT = 6, PART_COUNT = FIGURE_COUNT + TEXT_COUNT };

/* Reads one part, [at, end), and sets its bit in *seen. */
static bb_status read_part(const char *key, const char *at, const char *end, bb_cell_parts *cell,
                           unsigned *seen)
{
    static const char *const names[PART_COUNT] = {"size",   "max-rays",   "seed", "rays-hash",
                                                  "scene",  "rays",       "view", "builder",
                                                  "kernel", "intersector"};
    char *const texts[TEXT_COUNT] = {cell->scene,   cell->rays,   cell->view,
                                     cell->builder, cell->kernel, cell->intersector};
    const char *equals = memchr(at, '=', (size_t)(end - at));
    size_t length = equals != NULL ? (size_t)(equals - at) : 0;
    for (unsigned i = 0; i < PART_COUNT && equals != NULL; i++) {
        char figure[BB_CELL_TEXT];
        if (strlen(names[i]) != length || memcmp(names[i], at, length) != 0)
            continue;
        if ((*seen & 1u << i) != 0)
            return malformed(key, "a part of it is given twice");
        *seen |= 1u << i;
        BB_TRY(decode(key, equals + 1, end, i < FIGURE_COUNT ? figure : texts[i - FIGURE_COUNT]));
        return i < FIGURE_COUNT ? read_figure(key, names[i], figure, cell) : BB_OK;
    }
    return malformed(key, "its parts are scene=, rays=, size=, max-rays=, seed=, view=, builder=, "
                          "kernel= and intersector=, with '/' between them; a layout is "
                          "measured with each cell that traces it");
}

/* Whether the text names a builder, or several stages. A tracer's does not, be it loaded or not. */
static bool is_builder(const char *text)
{
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, ":+"), text);
    return bb_builder_find(name) != NULL || strchr(text, '+') != NULL;
}

/* Checks which parts must and must not be there, and sets defaults. */
static bb_status complete(const char *key, bb_cell_parts *cell)
{
    bool traced = cell->rays[0] != '\0', kernel = cell->kernel[0] != '\0';
    if (cell->scene[0] == '\0' || cell->builder[0] == '\0')
        return malformed(key, "it names no scene, or no builder");
    if (!traced && (kernel || cell->intersector[0] != '\0' || cell->view[0] != '\0' ||
                    cell->known_by_hash || cell->width > 0 || cell->max_rays > 0))
        return malformed(key, "it names no rays");
    if (bb_tracer_of(cell->builder) != NULL && (kernel || cell->intersector[0] != '\0'))
        return malformed(key, "a tracer traces by itself: it has no kernel and no intersector");
    if (is_builder(cell->builder) && traced && !kernel)
        return malformed(key, "it names no kernel");
    if (kernel && cell->intersector[0] == '\0')
        strcpy(cell->intersector, "exact");
    if (!traced || cell->known_by_hash)
        return BB_OK;
    if (cell->width == 0) {
        cell->width = BB_CELL_WIDTH;
        cell->height = BB_CELL_HEIGHT;
    }
    if (cell->max_rays == 0)
        cell->max_rays = BB_CELL_MAX_RAYS;
    return BB_OK;
}

bb_status bb_cell_key_parse(const char *key, bb_cell_parts *cell)
{
    unsigned seen = 0;
    memset(cell, 0, sizeof *cell);
    cell->seed = BB_CELL_SEED;
    for (const char *at = key;; at++) {
        const char *end = at + strcspn(at, "/");
        BB_TRY(read_part(key, at, end, cell, &seen));
        if (*end == '\0')
            return complete(key, cell);
        at = end;
    }
}

/* ---- parts of a key ---- */

static size_t length_before(const char *key, const char *part)
{
    const char *at = strstr(key, part);
    return at != NULL ? (size_t)(at - key) : strlen(key);
}

size_t bb_cell_key_set(const char *key)
{
    const char *rays = strstr(key, "/rays=");
    return rays != NULL ? (size_t)(rays + 1 - key) + strcspn(rays + 1, "/")
                        : length_before(key, "/");
}

size_t bb_cell_key_rays(const char *key)
{
    return length_before(key, "/builder=");
}

bool bb_cell_key_same(const char *a, size_t a_length, const char *b, size_t b_length)
{
    return a_length == b_length && memcmp(a, b, a_length) == 0;
}
