// A plug-in of oclgrind that writes to $MOVED, for each launch, the kernel's name and the bytes of
// global memory that it reads and writes, each byte once for either. Debian's package has no
// headers: what is declared here is the interface of oclgrind 21.10, in its order.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <unordered_map>

namespace llvm
{
class Instruction;
}
namespace oclgrind
{
class Plugin;
class Context
{
  public:
    void registerPlugin(Plugin *);
};
class Kernel
{
  public:
    const std::string &getName() const;
};
class KernelInvocation
{
  public:
    const Kernel *getKernel() const;
};
class Memory
{
  public:
    unsigned getAddressSpace() const;
};
class WorkGroup;
class WorkItem;
struct TypedValue;

class Plugin
{
  public:
    Plugin(const Context *);
    virtual ~Plugin();
    virtual void hostMemoryLoad(const Memory *, size_t, size_t)
    {
    }
    virtual void hostMemoryStore(const Memory *, size_t, size_t, const uint8_t *)
    {
    }
    virtual void instructionExecuted(const WorkItem *, const llvm::Instruction *,
                                     const TypedValue &)
    {
    }
    virtual void kernelBegin(const KernelInvocation *)
    {
    }
    virtual void kernelEnd(const KernelInvocation *)
    {
    }
    virtual void log(int, const char *)
    {
    }
    virtual void memoryAllocated(const Memory *, size_t, size_t, uint64_t, const uint8_t *)
    {
    }
    virtual void memoryAtomicLoad(const Memory *, const WorkItem *, int, size_t, size_t)
    {
    }
    virtual void memoryAtomicStore(const Memory *, const WorkItem *, int, size_t, size_t)
    {
    }
    virtual void memoryDeallocated(const Memory *, size_t)
    {
    }
    virtual void memoryLoad(const Memory *, const WorkItem *, size_t, size_t)
    {
    }
    virtual void memoryLoad(const Memory *, const WorkGroup *, size_t, size_t)
    {
    }
    virtual void memoryMap(const Memory *, size_t, size_t, size_t, uint64_t)
    {
    }
    virtual void memoryStore(const Memory *, const WorkItem *, size_t, size_t, const uint8_t *)
    {
    }
    virtual void memoryStore(const Memory *, const WorkGroup *, size_t, size_t, const uint8_t *)
    {
    }
    virtual void memoryUnmap(const Memory *, size_t, const void *)
    {
    }
    virtual void workGroupBarrier(const WorkGroup *, uint32_t)
    {
    }
    virtual void workGroupBegin(const WorkGroup *)
    {
    }
    virtual void workGroupComplete(const WorkGroup *)
    {
    }
    virtual void workItemBegin(const WorkItem *)
    {
    }
    virtual void workItemComplete(const WorkItem *)
    {
    }
    virtual bool isThreadSafe() const;

  protected:
    const Context *m_context;
};
} // namespace oclgrind

using namespace oclgrind;

enum { GLOBAL = 1, CONSTANT = 2, WORD = 32, READ = 0, WRITTEN = 1 };

class Moved : public Plugin
{
  public:
    explicit Moved(const Context *context) : Plugin(context), file(std::fopen(path(), "w"))
    {
    }
    bool isThreadSafe() const override
    {
        return false;
    }
    void memoryAtomicLoad(const Memory *m, const WorkItem *, int, size_t at, size_t n) override
    {
        note(m, READ, at, n);
    }
    void memoryAtomicStore(const Memory *m, const WorkItem *, int, size_t at, size_t n) override
    {
        note(m, WRITTEN, at, n);
    }
    void memoryLoad(const Memory *m, const WorkItem *, size_t at, size_t n) override
    {
        note(m, READ, at, n);
    }
    void memoryLoad(const Memory *m, const WorkGroup *, size_t at, size_t n) override
    {
        note(m, READ, at, n);
    }
    void memoryStore(const Memory *m, const WorkItem *, size_t at, size_t n,
                     const uint8_t *) override
    {
        note(m, WRITTEN, at, n);
    }
    void memoryStore(const Memory *m, const WorkGroup *, size_t at, size_t n,
                     const uint8_t *) override
    {
        note(m, WRITTEN, at, n);
    }
    void kernelEnd(const KernelInvocation *launch) override
    {
        std::fprintf(file, "%s %llu\n", launch->getKernel()->getName().c_str(), take());
        std::fflush(file);
    }

  private:
    static const char *path()
    {
        const char *name = std::getenv("MOVED");
        return name != nullptr ? name : "moved.txt";
    }
    void note(const Memory *memory, int way, size_t at, size_t n)
    {
        const unsigned space = memory->getAddressSpace();
        if (space == GLOBAL || space == CONSTANT)
            for (size_t i = at; i < at + n; i++)
                bytes[way][i / WORD] |= 1u << (i % WORD);
    }
    unsigned long long take()
    {
        unsigned long long sum = 0;
        for (auto &way : bytes) {
            for (const auto &word : way)
                sum += (unsigned)__builtin_popcount(word.second);
            way.clear();
        }
        return sum;
    }

    std::FILE *file;
    std::unordered_map<size_t, uint32_t> bytes[2];
};

extern "C" __attribute__((visibility("default"))) void initializePlugins(Context *context)
{
    context->registerPlugin(new Moved(context)); // it lives as long as the process
}

extern "C" __attribute__((visibility("default"))) void releasePlugins(Context *)
{
}
