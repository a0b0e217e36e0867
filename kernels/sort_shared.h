/* The two ways of the sort's form for CPUs (sort_cpu.cl). */
#ifndef SORT_SHARED_H
#define SORT_SHARED_H

#define SORT_BUCKETS 0u
#define SORT_PASSES 1u
#define SORT_ANY 2u

#endif
