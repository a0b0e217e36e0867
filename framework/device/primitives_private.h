/* Shared by primitives.c (scan, reduction, creation) and sort.c. */
#ifndef BB_PRIMITIVES_PRIVATE_H
#define BB_PRIMITIVES_PRIVATE_H

#include "framework/base/arithmetic.h"
#include "framework/device/primitives.h"

enum {
    SCAN_LEVELS_MAX = 11, /* levels of tiles of 8 or more elements, for 2^32 elements */
    SORT_ITEMS = 4,       /* of sort_gpu.cl */
    DIGIT_BITS_GPU = 4,   /* of sort_gpu.cl */
};

typedef struct sort_kernels {
    cl_program program;
    cl_kernel count;
    cl_kernel scatter;
    cl_kernel choose;  /* CPU form */
    cl_kernel buckets; /* CPU form */
    cl_kernel alone;   /* CPU form */
} sort_kernels;

struct bb_primitives {
    bb_device *device;
    bb_account *account;
    bool gpu;       /* the form */
    uint32_t group; /* GPU form: local size, a power of two */

    cl_program scan_program;
    cl_kernel scan_sums;   /* CPU form */
    cl_kernel scan_serial; /* CPU form */
    cl_kernel scan_chunks; /* CPU form */
    cl_kernel scan_tiles;  /* GPU form */
    cl_kernel scan_add;    /* GPU form */
    cl_program reduce_program;
    cl_kernel reduce_boxes;
    cl_kernel reduce_partials;
    sort_kernels sort32;
    sort_kernels sort64;

    bb_buffer unwanted;                    /* receives totals that the caller does not want */
    bb_buffer scan_level[SCAN_LEVELS_MAX]; /* sums of chunks (level 0), of tiles */
    bb_buffer partials;                    /* two bb_box per chunk or group */
    bb_buffer counts;                      /* per digit value and chunk or tile */
    bb_buffer way;                         /* CPU form: u32, the way of the last sort */
    bb_buffer keys;                        /* the second buffer for ping-pong */
    bb_buffer values;
};

/* How the CPU form cuts its input. */
typedef struct chunking {
    uint32_t size;  /* elements in a chunk; the last may have fewer, never none */
    uint32_t count; /* chunks */
} chunking;

/* `count` is at least 1. */
chunking bb_primitives_cut(const bb_primitives *self, uint32_t count);

/* BB_INVALID, with `what`, if the buffer is smaller. */
bb_status bb_primitives_expect(const bb_buffer *buffer, uint64_t bytes, const char *what);

/* Scratch: `buffer` is one of self's. */
bb_status bb_primitives_scratch(bb_primitives *self, uint64_t bytes, const char *what,
                                bb_buffer *buffer);

/* The sums of every level that a scan of `count` (at least 1) needs. */
bb_status bb_primitives_reserve_scan(bb_primitives *self, uint32_t count);

/* Creates the kernels for one width of keys, in self's form; `key` is their type on the device. */
bb_status bb_primitives_create_sort(bb_primitives *self, const char *key, sort_kernels *sort);
void bb_primitives_destroy_sort(sort_kernels *sort);

/* Compiles STEM_cpu.cl or STEM_gpu.cl. */
bb_status bb_primitives_compile(bb_primitives *self, const char *stem, const char *key,
                                cl_program *program);

#endif
