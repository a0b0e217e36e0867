/* Plug-ins are shared objects, which are inspected before they are trusted. */
#include "framework/builder/guard.h"
#include "framework/builder/registry.h"
#include "framework/builder/terms.h"

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

static bb_status take(const char *path, void *object)
{
    size_t bytes;
    const bb_registration *found = find_export(object, &bytes);
    if (found == NULL)
        return bb_fail(BB_INVALID,
                       "plug-in %s: is not a bvhbench builder (no symbol bb_plugin): build it with "
                       "bvhbench_add_builder()",
                       path);
    /* The magic word, version and size come first in every version; nothing else is read before
     * they match. */
    if (bytes < offsetof(bb_registration, builder) ||
        memcmp(found->magic, BB_PLUGIN_MAGIC, sizeof found->magic) != 0)
        return bb_fail(BB_INVALID,
                       "plug-in %s: its bb_plugin is no builder of this bvhbench: build it again, "
                       "with bvhbench_add_builder()",
                       path);
    if (found->abi_version != BB_ABI_VERSION)
        return bb_fail(BB_INVALID,
                       "plug-in %s: made for ABI version %u, this bvhbench has %d: build it again "
                       "with this one's headers",
                       path, found->abi_version, BB_ABI_VERSION);
    if (found->bytes != sizeof *found || bytes < sizeof *found)
        return bb_fail(BB_INVALID,
                       "plug-in %s: its bb_plugin has %zu bytes, this bvhbench's %zu, both of ABI "
                       "version %d: build it again with this one's headers",
                       path, found->bytes != sizeof *found ? found->bytes : bytes, sizeof *found,
                       BB_ABI_VERSION);
    if (found->builder == NULL)
        return bb_fail(BB_INVALID,
                       "plug-in %s: its bb_plugin has no builder: build it with "
                       "bvhbench_add_builder()",
                       path);
    bb_status status = bb_builder_add(found);
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
    return status; /* a loaded builder stays for the life of the process */
}
