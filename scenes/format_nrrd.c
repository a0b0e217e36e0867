/* NRRD, by teem: three axes of numbers. Unsigned values of 8 and 16 bits are kept; all others are
 * mapped linearly from their range to 16 bits.
 *
 * teem reads whatever a header asks for, from anywhere, and of any size. So the header is read
 * first, and its requests are checked. */
#include "framework/base/file.h"
#include "framework/base/limits.h"
#include "framework/base/memory.h"
#include "scenes/volume_scene.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <teem/nrrd.h>

enum { HEADER_MAX = 1 << 16 };

static const bb_option options_table[] = {BB_VOLUME_OPTIONS, {0}};

/* Fails with teem's own message, its lines joined. */
static bb_status refuse(const char *path)
{
    char *message = biffGetDone(NRRD), text[384] = "";
    for (char *line = message; line != NULL && *line != '\0';) {
        size_t length = strcspn(line, "\n"), used = strlen(text);
        while (length > 0 && *line == ' ') {
            line++;
            length--;
        }
        snprintf(text + used, sizeof text - used, "%s%.*s", used > 0 ? " " : "", (int)length, line);
        line += strcspn(line, "\n");
        line += *line == '\n';
    }
    free(message);
    return bb_fail(BB_INVALID, "%s: teem does not read it: %s", path, text);
}

/* Data may be in one other file, in this folder or below it. */
static bb_status check_data_file(const char *path, const char *name)
{
    char beside[PATH_MAX];
    const char *slash = strrchr(path, '/');
    if (strncmp(name, "LIST", 4) == 0 || strncmp(name, "SKIPLIST", 8) == 0 ||
        strpbrk(name, "% ") != NULL)
        return bb_fail(BB_INVALID, "%s: its data are in several files: join them", path);
    if (name[0] == '/' || strchr(name, ':') != NULL || strstr(name, "..") != NULL ||
        strcmp(name, "-") == 0)
        return bb_fail(BB_INVALID,
                       "%s: its data are in '%.200s': a file in its folder or below is read", path,
                       name);
    snprintf(beside, sizeof beside, "%.*s%s", slash != NULL ? (int)(slash + 1 - path) : 0, path,
             name);
    bb_input input;
    BB_TRY(bb_input_open(beside, path, &input));
    bb_input_close(&input);
    return BB_OK;
}

/* Checks the lines of the header, up to an empty one, or to the longest header: teem opens the file
 * that `data file` names while reading. */
static bb_status check_lines(const char *path, char *header, bool whole)
{
    char *rest = header;
    if (strncmp(header, "NRRD000", 7) != 0) /* teem accepts other formats too */
        return bb_fail(BB_INVALID, "%s: is no NRRD file: it does not begin with 'NRRD000'", path);
    for (char *line = strsep(&rest, "\n"); line != NULL; line = strsep(&rest, "\n")) {
        size_t length = strcspn(line, "\r");
        if (line[length] != '\0' && line[length + 1] != '\0') /* teem ends a line there, too */
            return bb_fail(BB_INVALID, "%s: has a carriage return inside a line of its header",
                           path);
        line[length] = '\0';
        if (length == 0)
            return BB_OK;
        size_t key = strcspn(line, ":");
        if ((key != 9 || strncasecmp(line, "data file", key) != 0) &&
            (key != 8 || strncasecmp(line, "datafile", key) != 0))
            continue;
        const char *name = line + key + (line[key] == ':');
        BB_TRY(check_data_file(path, name + strspn(name, " \t")));
    }
    return whole
               ? BB_OK
               : bb_fail(BB_INVALID, "%s: has no end of its header in %d bytes", path, HEADER_MAX);
}

static bb_status check_files(const char *path)
{
    bb_input input;
    BB_TRY(bb_input_open(path, "volume", &input));
    size_t size = input.size < HEADER_MAX ? (size_t)input.size : HEADER_MAX;
    char *header = malloc(size + 1);
    bb_status status = header != NULL ? bb_input_read(&input, header, size)
                                      : bb_fail(BB_REFUSED, "%s: no memory for its header", path);
    bb_input_close(&input);
    if (status == BB_OK) {
        for (size_t i = 0; i < size; i++)
            header[i] = header[i] != '\0' ? header[i] : ' '; /* a space does not end a line */
        header[size] = '\0';
        status = check_lines(path, header, size < HEADER_MAX);
    }
    free(header);
    return status;
}

/* Returns the most bytes of values that one byte of a file can stand for; 0: unlimited. */
static double most_per_byte(const NrrdIoState *io, size_t element)
{
    if (io->encoding == nrrdEncodingRaw)
        return 1;
    if (io->encoding == nrrdEncodingGzip)
        return 1100; /* deflate: two bits for 258 bytes */
    if (io->encoding == nrrdEncodingBzip2)
        return 0;
    return (double)element; /* text: at least one digit each */
}

/* Refuses a short file that claims many values before room is made for them. */
static bb_status check_length(const char *path, const NrrdIoState *io, size_t element, double bytes)
{
    bb_input input;
    double most = most_per_byte(io, element);
    if (most == 0 || io->dataFNArr->len > 0)
        return BB_OK;
    BB_TRY(bb_input_open(path, "volume", &input));
    bb_input_close(&input);
    if (bytes <= most * (double)input.size)
        return BB_OK;
    return bb_fail(BB_INVALID, "%s: is truncated: its header claims %.0f bytes of values", path,
                   bytes);
}

static bb_status check_shape(const char *path, const Nrrd *nrrd, const NrrdIoState *io)
{
    if (nrrd->dim != 3)
        return bb_fail(BB_INVALID, "%s: has %u axes: a volume of numbers has 3", path, nrrd->dim);
    if (nrrd->type == nrrdTypeBlock || nrrdElementSize(nrrd) == 0)
        return bb_fail(BB_INVALID, "%s: its values are no numbers", path);
    if (io->byteSkip < 0 && io->encoding != nrrdEncodingRaw)
        return bb_fail(BB_INVALID, "%s: counts the bytes to skip from the end of compressed data",
                       path);
    double bytes = (double)nrrdElementSize(nrrd);
    for (int k = 0; k < 3; k++) {
        if (nrrd->axis[k].size > UINT32_MAX)
            return bb_fail(BB_REFUSED, "%s: has %zu values along %c", path, nrrd->axis[k].size,
                           "xyz"[k]);
        bytes *= (double)nrrd->axis[k].size;
    }
    if (bytes > (double)bb_host_limit())
        return bb_fail(BB_REFUSED,
                       "%s: claims %.0f bytes, three quarters of %s are "
                       "%llu: take a smaller one",
                       path, bytes, bb_memory_limit_by(), (unsigned long long)bb_host_limit());
    return check_length(path, io, nrrdElementSize(nrrd), bytes);
}

static bb_status read_header(const char *path)
{
    BB_TRY(check_files(path));
    Nrrd *nrrd = nrrdNew();
    NrrdIoState *io = nrrdIoStateNew();
    nrrdIoStateSet(io, nrrdIoStateSkipData, 1);
    bb_status status = nrrdLoad(nrrd, path, io) != 0 ? refuse(path) : BB_OK;
    if (status == BB_OK)
        status = check_shape(path, nrrd, io);
    nrrdIoStateNix(io);
    nrrdNuke(nrrd);
    return status;
}

static bb_status rescale(const char *path, const Nrrd *nrrd, uint16_t *to)
{
    double (*at)(const void *, size_t) = nrrdDLookup[nrrd->type];
    size_t count = nrrdElementNumber(nrrd);
    double lo = INFINITY, hi = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        double value = at(nrrd->data, i);
        if (!isfinite(value))
            return bb_fail(BB_INVALID, "%s: value %zu (from 0) is no finite number", path, i);
        lo = fmin(lo, value);
        hi = fmax(hi, value);
    }
    double half = hi / 2 - lo / 2; /* the difference may exceed the range of doubles */
    for (size_t i = 0; i < count; i++)
        to[i] = half > 0 ? (uint16_t)lround((at(nrrd->data, i) / 2 - lo / 2) / half * 65535) : 0;
    return BB_OK;
}

static void read_spacing(const Nrrd *nrrd, double spacing[3])
{
    for (unsigned k = 0; k < 3; k++) {
        double vector[NRRD_SPACE_DIM_MAX], distance = NAN;
        nrrdSpacingCalculate(nrrd, k, &distance, vector);
        spacing[k] = isfinite(distance) && distance != 0 ? fabs(distance) : 1;
    }
}

static bb_status take(const char *path, const Nrrd *nrrd, const bb_spec *spec, bb_voxels *voxels,
                      bb_scene *scene)
{
    bool narrow = nrrd->type == nrrdTypeUChar;
    voxels->bytes = narrow ? 1 : 2;
    for (int k = 0; k < 3; k++)
        voxels->dims[k] = (uint32_t)nrrd->axis[k].size;
    read_spacing(nrrd, voxels->spacing);
    BB_TRY(bb_volume_scene_reserve(scene, spec, options_table, voxels));
    if (!narrow && nrrd->type != nrrdTypeUShort)
        return rescale(path, nrrd, voxels->values);
    memcpy(voxels->values, nrrd->data, nrrdElementNumber(nrrd) * voxels->bytes);
    return BB_OK;
}

static bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    bb_voxels voxels = {.values = NULL};
    BB_TRY(read_header(path));
    Nrrd *nrrd = nrrdNew();
    bb_status status = nrrdLoad(nrrd, path, NULL) != 0 ? refuse(path) : BB_OK;
    if (status == BB_OK)
        status = take(path, nrrd, spec, &voxels, scene);
    nrrdNuke(nrrd);
    if (status == BB_OK)
        return bb_volume_scene_make(spec, options_table, &voxels, scene);
    bb_voxels_free(&voxels);
    return status;
}

static const char *const endings[] = {".nrrd", ".nhdr", NULL};

extern const bb_scene_format bb_scene_format_nrrd;
const bb_scene_format bb_scene_format_nrrd = {
    .name = "NRRD",
    .endings = endings,
    .load = load,
    .options = options_table,
};
