// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

/// CUDA's execution model on one host thread: the threads of a block are fibers, blocks run one after the other or some
/// of them in turns. A thread runs until it has to wait for others, so that whatever a kernel needs a barrier for goes
/// wrong without it in one order of threads or another.
namespace disparityd::simt {

constexpr int warp_lanes = 32;
constexpr int max_threads = 1024;  // of a block

struct Dim3 {
    unsigned x, y, z;
    constexpr Dim3(unsigned nx = 1, unsigned ny = 1, unsigned nz = 1) : x(nx), y(ny), z(nz) {}  // implicit, as dim3 is
};

/// In which order the threads of a block take their turns, and its blocks theirs.
enum class Order { ascending, descending, shuffled };

struct Settings {
    Order order = Order::ascending;
    unsigned seed = 1;            ///< of Order::shuffled
    unsigned char poison = 0xa5;  ///< what memory holds that nobody has written
    /// Another thread's turn after every atomic operation.
    bool turn_after_atomics = false;
    /// Blocks that run at the same time, taking turns; the next one begins where one has ended.
    int resident_blocks = 1;
};
/// For every launch and allocation from now on; set it while no other thread launches.
Settings& settings();

/// What a launch throws when the kernel breaks a rule of the execution model: which threads wait where.
class BrokenKernel : public std::logic_error {
public:
    using std::logic_error::logic_error;
};

/// A place in the source.
struct Site {
    const char* file;
    int line;
};

/// Runs the kernel for every thread of every block. Throws BrokenKernel, or what the kernel throws.
void run(Dim3 grid, Dim3 block, std::size_t dynamic_shared_bytes, const std::function<void()>& kernel);

/// What the kernel asks about the thread that runs.
struct Indices {
    Dim3 thread, block, block_size, grid_size;
};
const Indices& indices();

/// __syncthreads().
void block_barrier(Site site);

enum class Collective { sync, shuffle, ballot, all, any, reduce_min, reduce_max, reduce_add, reduce_and, reduce_or };
/// A warp-wide operation with the meaning of its CUDA name; `source` is the lane that a shuffle reads from.
std::uint64_t warp_operation(Collective operation, unsigned mask, std::uint64_t value, int source, Site site);
int lane();

/// After an atomic operation.
void atomic_done();

/// By a thread that waits for what another one writes. BrokenKernel when all that could run wait like this.
void wait_for_others(Site site);

/// Shared memory of the running block: one allocation of its own for each tag, poisoned.
void* shared_memory(const void* tag, std::size_t bytes);
void* dynamic_shared_memory();

template <typename T, typename Tag>
T& shared(Tag /*unique*/) {
    static const char tag = 0;
    return *static_cast<T*>(shared_memory(&tag, sizeof(T)));
}

}  // namespace disparityd::simt
