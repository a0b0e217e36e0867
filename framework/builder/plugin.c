/* Plug-ins are shared objects, which are inspected before they are trusted. */
#include "framework/builder/guard.h"
#include "framework/builder/registry.h"
#include "framework/builder/terms.h"
#include "framework/builder/tracers.h"

#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* The header of this program's own file; the linker defines the name. */
extern const ElfW(Ehdr) __ehdr_start __attribute__((visibility("hidden")));

static bool read_header(FILE *file, ElfW(Ehdr) * header)
{
    return fread(header, sizeof *header, 1, file) == 1 &&
           memcmp(header->e_ident, ELFMAG, SELFMAG) == 0;
}

/* Compares class, byte order and machine: the rest of the header depends on them. */
static bool is_of_this_machine(const ElfW(Ehdr) * header)
{
    return header->e_ident[EI_CLASS] == __ehdr_start.e_ident[EI_CLASS] &&
           header->e_ident[EI_DATA] == __ehdr_start.e_ident[EI_DATA] &&
           header->e_machine == __ehdr_start.e_machine;
}

/* Whether the file contains all that its program headers map: the loader maps past the end of a
 * truncated file, and the process dies at the first access. */
static bool is_whole(const ElfW(Ehdr) * header, FILE *file, uint64_t size)
{
    if (header->e_type != ET_DYN || header->e_phentsize != sizeof(ElfW(Phdr)) ||
        fseek(file, (long)header->e_phoff, SEEK_SET) != 0)
        return false;
    for (uint32_t i = 0; i < header->e_phnum; i++) {
        ElfW(Phdr) program;
        if (fread(&program, sizeof program, 1, file) != 1)
            return false;
        if (program.p_type == PT_LOAD &&
            (program.p_offset > size || program.p_filesz > size - program.p_offset))
            return false;
    }
    return header->e_phnum > 0;
}

static bb_status check_file(const char *path)
{
    struct stat info;
    FILE *file = stat(path, &info) == 0 && S_ISREG(info.st_mode) ? fopen(path, "rb") : NULL;
    if (file == NULL)
        return bb_fail(BB_INVALID, "plug-in %s: %s", path,
                       errno != 0 ? strerror(errno) : "is no file");
    ElfW(Ehdr) header;
    bool is_elf = read_header(file, &header);
    bool is_ours = is_elf && is_of_this_machine(&header);
    bool whole = is_ours && is_whole(&header, file, (uint64_t)info.st_size);
    fclose(file);
    if (is_elf && !is_ours)
        return bb_fail(BB_INVALID,
                       "plug-in %s: is for another machine (ELF class %d, byte order %d, machine "
                       "%d; this bvhbench: %d, %d, %d): build it for this one",
                       path, header.e_ident[EI_CLASS], header.e_ident[EI_DATA], header.e_machine,
                       __ehdr_start.e_ident[EI_CLASS], __ehdr_start.e_ident[EI_DATA],
                       __ehdr_start.e_machine);
    if (!whole)
        return bb_fail(BB_INVALID, "plug-in %s: is not a shared object, or is truncated", path);
    return BB_OK;
}

/* The object's symbol bb_plugin; NULL if there is none. It is not yet known to be ours: its size is
 * read from the symbol table, so that nothing beyond it is accessed. */
static const void *find_export(void *object, size_t *bytes)
{
    Dl_info where;
    const ElfW(Sym) *symbol = NULL;
    const void *address = dlsym(object, "bb_plugin");
    *bytes = 0;
    if (address != NULL && dladdr1(address, &where, (void **)&symbol, RTLD_DL_SYMENT) != 0 &&
        where.dli_saddr == address && symbol != NULL &&
        ELF64_ST_TYPE(symbol->st_info) == STT_OBJECT)
        *bytes = symbol->st_size;
    return address;
}

/* The two kinds of plug-ins. Magic word, version and size come first in every version of either;
 * nothing else is read before they match. */
typedef struct plugin_kind {
    const char *magic;
    uint32_t abi_version;
    size_t bytes;
    bb_status (*add)(const void *registration);
} plugin_kind;

static bb_status add_builder(const void *registration)
{
    const bb_registration *of = registration;
    if (of->builder == NULL)
        return bb_fail(BB_INVALID, "its bb_plugin has no builder: build it with "
                                   "bvhbench_add_builder()");
    if (of->builder->name != NULL && bb_tracer_find(of->builder->name) != NULL)
        return bb_fail(BB_INVALID, "there is a tracer %s already", of->builder->name);
    return bb_builder_add(of);
}

static bb_status add_tracer(const void *registration)
{
    const bb_tracer_registration *of = registration;
    if (of->tracer == NULL)
        return bb_fail(BB_INVALID, "its bb_plugin has no tracer: build it with "
                                   "bvhbench_add_tracer()");
    if (of->tracer->name != NULL && bb_builder_find(of->tracer->name) != NULL)
        return bb_fail(BB_INVALID, "there is a builder %s already", of->tracer->name);
    return bb_tracer_add(of->tracer);
}

static const plugin_kind kinds[] = {
    {BB_PLUGIN_MAGIC, BB_ABI_VERSION, sizeof(bb_registration), add_builder},
    {BB_TRACER_MAGIC, BB_TRACER_ABI_VERSION, sizeof(bb_tracer_registration), add_tracer},
};

static const plugin_kind *kind_of(const bb_registration *found, size_t bytes)
{
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (bytes >= offsetof(bb_registration, builder) &&
            memcmp(found->magic, kinds[i].magic, sizeof found->magic) == 0)
            return &kinds[i];
    return NULL;
}

static bb_status take(const char *path, void *object)
{
    size_t bytes;
    const bb_registration *found = find_export(object, &bytes);
    if (found == NULL)
        return bb_fail(BB_INVALID,
                       "plug-in %s: is not a bvhbench builder or tracer (no symbol bb_plugin): "
                       "build it with bvhbench_add_builder() or bvhbench_add_tracer()",
                       path);
    const plugin_kind *kind = kind_of(found, bytes);
    if (kind == NULL)
        return bb_fail(BB_INVALID,
                       "plug-in %s: its bb_plugin is no builder or tracer of this bvhbench: build "
                       "it again, with bvhbench_add_builder() or bvhbench_add_tracer()",
                       path);
    if (found->abi_version != kind->abi_version)
        return bb_fail(BB_INVALID,
                       "plug-in %s: made for ABI version %u, this bvhbench has %u: build it again "
                       "with this one's headers",
                       path, found->abi_version, kind->abi_version);
    if (found->bytes != kind->bytes || bytes < kind->bytes)
        return bb_fail(BB_INVALID,
                       "plug-in %s: its bb_plugin has %zu bytes, this bvhbench's %zu, both of ABI "
                       "version %u: build it again with this one's headers",
                       path, found->bytes != kind->bytes ? found->bytes : bytes, kind->bytes,
                       kind->abi_version);
    bb_status status = kind->add(found);
    return status == BB_OK ? BB_OK : bb_fail(status, "plug-in %s: %s", path, bb_message());
}

bb_status bb_plugin_load(const char *path)
{
    errno = 0;
    BB_TRY(check_file(path));
    /* Without a slash, dlopen() would search the library path. */
    char here[4096];
    int length = snprintf(here, sizeof here, "%s%s", strchr(path, '/') != NULL ? "" : "./", path);
    if (length < 0 || (size_t)length >= sizeof here)
        return bb_fail(BB_INVALID, "plug-in %.60s...: the path is too long", path);
    bb_terms terms;
    bb_terms_take(&terms);
    bb_guard_enter((bb_guarded){"", ""}, path, "dlopen"); /* its constructors */
    void *object = dlopen(here, RTLD_NOW | RTLD_LOCAL);
    bb_status status = bb_terms_check(&terms, path, "dlopen", BB_OK);
    if (object == NULL)
        return bb_fail(BB_INVALID, "plug-in %s: cannot be loaded: %s", path, dlerror());
    if (status == BB_OK)
        status = take(path, object);
    else
        status = bb_fail(BB_INVALID,
                         "plug-in %s (its constructors do so; -Ofast and -ffast-math link one: "
                         "build it without)",
                         bb_message());
    if (status != BB_OK)
        dlclose(object);
    return status; /* a loaded one stays for the life of the process */
}
