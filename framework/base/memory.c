/* Accounted host memory. Each block carries its size and its account in a header of 64 bytes, which
 * also keeps the block aligned to a cache line. */
#include "framework/base/memory.h"

#include "framework/base/limits.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct header {
    uint64_t bytes;
    bb_account *account;
    char pad[64 - sizeof(uint64_t) - sizeof(bb_account *)];
} header;
_Static_assert(sizeof(header) == 64, "the header keeps blocks aligned");

void bb_account_mark(bb_account *account)
{
    account->peak = account->bytes;
}

/* Builders may allocate from several host threads, hence the atomics. */
void bb_account_add(bb_account *account, uint64_t bytes)
{
    if (account == NULL)
        return;
    uint64_t now = __atomic_add_fetch(&account->bytes, bytes, __ATOMIC_RELAXED);
    uint64_t peak = __atomic_load_n(&account->peak, __ATOMIC_RELAXED);
    while (now > peak && !__atomic_compare_exchange_n(&account->peak, &peak, now, 1,
                                                      __ATOMIC_RELAXED, __ATOMIC_RELAXED))
        ;
}

void bb_account_subtract(bb_account *account, uint64_t bytes)
{
    if (account != NULL)
        __atomic_sub_fetch(&account->bytes, bytes, __ATOMIC_RELAXED);
}

/* A quarter is left for what is derived from the scene, and for other programs. */
uint64_t bb_host_limit(void)
{
    uint64_t bytes = bb_memory_limit();
    return bytes < UINT64_MAX ? bytes / 4 * 3 : bytes;
}

/* All that is booked in the process, since blocks that fit one by one may not fit together. */
static bb_account all;

bb_account *bb_host_account(void)
{
    return &all;
}

void bb_host_book(uint64_t bytes)
{
    bb_account_add(&all, bytes);
}

void bb_host_unbook(uint64_t bytes)
{
    bb_account_subtract(&all, bytes);
}

static _Atomic uint64_t missing;

uint64_t bb_host_missing(void)
{
    return atomic_exchange(&missing, 0);
}

uint64_t bb_host_most(void)
{
    const uint64_t limit = bb_memory_limit();
    return limit - limit / 16;
}

static uint64_t room_beside(uint64_t in_use)
{
    const uint64_t most = bb_host_most();
    return in_use < most ? most - in_use : 0;
}

/* Drivers and allocators overcommit: the system would not refuse. */
bb_status bb_host_has_room(uint64_t bytes, const char *what)
{
    const uint64_t in_use = __atomic_load_n(&all.bytes, __ATOMIC_RELAXED);
    const uint64_t room = room_beside(in_use);
    if (bytes <= room)
        return BB_OK;
    uint64_t before = missing;
    while (before < bytes - room && !atomic_compare_exchange_weak(&missing, &before, bytes - room))
        ;
    return bb_fail(BB_REFUSED,
                   "%s needs %llu bytes beside the %llu in use; %s is %llu, a sixteenth of it left "
                   "to drivers and compilers: take a smaller scene or fewer builders",
                   what, (unsigned long long)bytes, (unsigned long long)in_use,
                   bb_memory_limit_by(), (unsigned long long)bb_memory_limit());
}

bool bb_host_follow(int64_t bytes, bool taken, const char *what)
{
    if (bytes < 0) {
        bb_host_unbook((uint64_t)-bytes);
        return true;
    }
    if (!taken && bb_host_has_room((uint64_t)bytes, what) != BB_OK)
        return false;
    bb_host_book((uint64_t)bytes);
    return true;
}

/* Returns what the system is asked for: whole lines, and room to read beyond the last element. */
static size_t whole_block(size_t bytes)
{
    enum { BEYOND = 16 };
    return (bytes + BEYOND + sizeof(header) + 63) / 64 * 64;
}

bb_status bb_host_alloc(bb_account *account, size_t bytes, const char *what, void *out)
{
    void *old;
    memcpy(&old, out, sizeof old);
    bb_host_free(old);
    void *block = NULL;
    memcpy(out, &block, sizeof block);

    BB_TRY(bb_host_has_room(bytes, what));
    header *head = aligned_alloc(64, whole_block(bytes));
    if (head == NULL)
        return bb_fail(BB_REFUSED, "%s needs %zu bytes, which the host refused", what, bytes);
    head->bytes = bytes;
    head->account = account;
    bb_host_book(bytes);
    bb_account_add(account, bytes);
    block = head + 1;
    memcpy(out, &block, sizeof block);
    return BB_OK;
}

void bb_host_shrink(void *out, size_t bytes)
{
    void *old, *block = NULL;
    memcpy(&old, out, sizeof old);
    const header *head = (const header *)old - 1;
    assert(bytes <= head->bytes);
    if (bytes > room_beside(all.bytes) ||
        bb_host_alloc(head->account, bytes, "a smaller block", &block) != BB_OK)
        return;
    memcpy(block, old, bytes);
    bb_host_free(old);
    memcpy(out, &block, sizeof block);
}

void bb_host_free(void *pointer)
{
    if (pointer == NULL)
        return;
    header *head = (header *)pointer - 1;
    bb_account_subtract(head->account, head->bytes);
    bb_host_unbook(head->bytes);
    free(head);
}

/* Returns a figure of proc(5)'s status of this process, such as "VmRSS:"; 0 if it has none. */
static uint64_t status_bytes(const char *name)
{
    char line[128];
    unsigned long long kib = 0;
    FILE *file = fopen("/proc/self/status", "r");
    while (file != NULL && kib == 0 && fgets(line, sizeof line, file) != NULL)
        if (strncmp(line, name, strlen(name)) == 0 &&
            sscanf(line + strlen(name), "%llu", &kib) != 1)
            break;
    if (file != NULL)
        fclose(file);
    return kib * 1024;
}

static uint64_t peak_before_mark;
static bool marked = true;

uint64_t bb_host_resident(void)
{
    return status_bytes("VmRSS:");
}

uint64_t bb_host_peak_since_mark(void)
{
    return marked ? status_bytes("VmHWM:") : bb_host_resident();
}

uint64_t bb_host_peak(void)
{
    const uint64_t peak = status_bytes("VmHWM:");
    return peak > peak_before_mark ? peak : peak_before_mark;
}

void bb_host_mark_peak(void)
{
    peak_before_mark = bb_host_peak();
    FILE *file = fopen("/proc/self/clear_refs", "w");
    marked = file != NULL && fputs("5", file) >= 0; /* proc(5): resets the peak */
    if (file != NULL)
        marked = fclose(file) == 0 && marked;
}
