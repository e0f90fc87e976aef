// SPDX-License-Identifier: Apache-2.0
#include "tests/emulation/simt.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <numeric>
#include <random>
#include <vector>

#include "tests/emulation/fiber.h"

namespace disparityd::simt {

namespace {

enum class State { ready, at_barrier, in_warp_operation, ended };

struct Waiting {
    Collective operation = Collective::sync;
    unsigned mask = 0;
    std::uint64_t value = 0;
    int source = 0;
    Site site{"", 0};
};

// Thrown through a kernel's frames when its block is given up.
struct GivenUp {};

class Block;
thread_local Block* running = nullptr;

std::string text(Dim3 index) {
    return "(" + std::to_string(index.x) + "," + std::to_string(index.y) + "," + std::to_string(index.z) + ")";
}

std::string text(Site site) {
    return std::string(site.file) + ":" + std::to_string(site.line);
}

constexpr std::align_val_t shared_alignment{16};

struct FreeShared {
    void operator()(void* bytes) const { ::operator delete(bytes, shared_alignment); }
};

// As large as was asked for and no larger, so that the address sanitizer sees one element too far.
struct Memory {
    const void* tag;
    std::unique_ptr<void, FreeShared> bytes;
};

class Threads;

struct Thread {
    explicit Thread(Threads& threads);

    int number = 0;
    State state = State::ended;
    Indices indices;
    Waiting waiting;
    std::uint64_t result = 0;
    bool waits_for_others = false;
    Fiber fiber;
};

// The fibers of a host thread, kept from launch to launch.
class Threads {
public:
    Threads() = default;
    ~Threads() {
        leaving_ = true;
        for (auto& thread : all_) {
            thread->fiber.enter();
        }
    }
    Thread& at(int number) {
        while (static_cast<int>(all_.size()) <= number) {
            all_.push_back(std::make_unique<Thread>(*this));
        }
        return *all_[static_cast<std::size_t>(number)];
    }
    bool leaving() const { return leaving_; }

private:
    bool leaving_ = false;
    std::vector<std::unique_ptr<Thread>> all_;
};

thread_local Threads threads_of_host;

enum class Turn { moved, only_waited, ended };

class Block {
public:
    /// Its threads are those of the host thread from `first` on.
    Block(Dim3 grid, Dim3 block, std::size_t dynamic_bytes, const std::function<void()>& kernel, int first)
        : kernel_(kernel),
          grid_(grid),
          size_(block),
          count_(static_cast<int>(block.x * block.y * block.z)),
          dynamic_bytes_(dynamic_bytes),
          random_(settings().seed),
          order_(static_cast<std::size_t>(count_)) {
        for (int i = 0; i < count_; ++i) {
            threads_.push_back(&threads_of_host.at(first + i));
        }
        std::iota(order_.begin(), order_.end(), 0);
        if (settings().order == Order::descending) {
            std::reverse(order_.begin(), order_.end());
        }
    }

    void start(Dim3 index) {
        for (int i = 0; i < count_; ++i) {
            Thread& thread = at(i);
            const auto n = static_cast<unsigned>(i);
            thread.number = i;
            thread.indices = {Dim3(n % size_.x, n / size_.x % size_.y, n / size_.x / size_.y), index, size_, grid_};
            thread.state = State::ready;
        }
        memory_.clear();
        shared_memory(nullptr, dynamic_bytes_);
    }

    // Every thread that can runs until it waits.
    Turn take_turn() {
        bool any = false;
        bool moved = false;
        if (settings().order == Order::shuffled) {
            std::shuffle(order_.begin(), order_.end(), random_);
        }
        for (const int number : order_) {
            Thread& thread = at(number);
            if (thread.state == State::ready) {
                any = true;
                thread.waits_for_others = false;
                enter(thread);
                moved = moved || !thread.waits_for_others;
            }
        }
        if (any) {
            return moved ? Turn::moved : Turn::only_waited;
        }
        if (open_barrier()) {
            return Turn::moved;
        }
        memory_.clear();
        return Turn::ended;
    }

    [[noreturn]] void refuse_waiting() const {
        broken(**std::find_if(threads_.begin(), threads_.end(),
                              [](const Thread* thread) { return thread->waits_for_others; }),
               "waits for what no running thread writes");
    }

    // Every fiber that is inside the kernel unwinds.
    void give_up() {
        given_up_ = true;
        for (Thread* thread : threads_) {
            current_ = thread;
            while (thread->state != State::ended) {
                thread->fiber.enter();
            }
        }
        failure_ = nullptr;
        memory_.clear();
    }

    // On a fiber.
    void begin(Thread& thread) {
        try {
            if (!given_up_) {
                kernel_();
            }
        } catch (const GivenUp&) {
            // the host has the reason
        } catch (...) {
            failure_ = std::current_exception();
        }
        thread.state = State::ended;
    }

    void wait(State state) {
        Thread& thread = *current_;
        thread.state = state;
        thread.fiber.leave();
        if (given_up_) {
            throw GivenUp{};
        }
    }

    std::uint64_t warp_operation(const Waiting& waiting) {
        Thread& thread = *current_;
        thread.waiting = waiting;
        thread.state = State::in_warp_operation;
        if ((waiting.mask >> (thread.number % warp_lanes) & 1U) == 0) {
            broken(thread, "is not in the mask of its own operation");
        }
        if (complete(thread)) {
            finish(thread);
        } else {
            wait(State::in_warp_operation);
        }
        return thread.result;
    }

    void* shared_memory(const void* tag, std::size_t bytes) {
        for (const Memory& memory : memory_) {
            if (memory.tag == tag) {
                return memory.bytes.get();
            }
        }
        Memory memory{tag, std::unique_ptr<void, FreeShared>(::operator new(bytes, shared_alignment))};
        std::memset(memory.bytes.get(), settings().poison, bytes);
        memory_.push_back(std::move(memory));
        return memory_.back().bytes.get();
    }

    Thread& current() const { return *current_; }

private:
    Thread& at(int number) const { return *threads_[static_cast<std::size_t>(number)]; }

    void enter(Thread& thread) {
        current_ = &thread;
        thread.fiber.enter();
        if (failure_) {
            std::rethrow_exception(std::exchange(failure_, nullptr));
        }
    }

    // No thread can go on by itself. False when all have ended.
    bool open_barrier() {
        const Thread& first = at(0);
        for (const Thread* thread : threads_) {
            if (thread->state == State::in_warp_operation) {
                broken(*thread, "waits for lanes that do not come");
            }
            if (thread->state != first.state || (thread->state == State::at_barrier && !same_place(*thread, first))) {
                broken(thread->state == State::at_barrier ? *thread : first,
                       "and others of its block are not at the same barrier");
            }
        }
        const bool waited = first.state == State::at_barrier;
        for (Thread* thread : threads_) {
            thread->state = waited ? State::ready : State::ended;
        }
        return waited;
    }

    static bool same_place(const Thread& a, const Thread& b) {
        return a.waiting.site.line == b.waiting.site.line && std::strcmp(a.waiting.site.file, b.waiting.site.file) == 0;
    }

    // Whether all lanes of the mask have come to the operation; refuses what cannot become complete.
    bool complete(const Thread& thread) const {
        bool all = true;
        const int first = thread.number / warp_lanes * warp_lanes;
        for (int i = 0; i < warp_lanes; ++i) {
            if ((thread.waiting.mask >> i & 1U) == 0) {
                continue;
            }
            if (first + i >= count_ || at(first + i).state == State::ended) {
                broken(thread, "names lane " + std::to_string(i) + ", which has ended or does not exist");
            }
            const Thread& other = at(first + i);
            if (other.state == State::at_barrier) {
                broken(thread, "names lane " + std::to_string(i) + ", which waits at a barrier of the block");
            }
            if (other.state == State::ready) {
                all = false;
            } else if (other.waiting.operation != thread.waiting.operation ||
                       other.waiting.mask != thread.waiting.mask || !same_place(thread, other)) {
                broken(thread, "names lane " + std::to_string(i) + ", which waits at " + text(other.waiting.site));
            }
        }
        return all;
    }

    void finish(const Thread& thread) {
        const int first = thread.number / warp_lanes * warp_lanes;
        const std::uint64_t common = reduced(thread);
        for (int i = 0; i < warp_lanes; ++i) {
            if ((thread.waiting.mask >> i & 1U) == 0) {
                continue;
            }
            Thread& lane = at(first + i);
            if (thread.waiting.operation == Collective::shuffle) {
                const int source = lane.waiting.source;
                if ((thread.waiting.mask >> source & 1U) == 0) {
                    broken(lane, "reads from lane " + std::to_string(source) + ", which takes no part");
                }
                lane.result = at(first + source).waiting.value;
            } else {
                lane.result = common;
            }
            lane.state = State::ready;
        }
    }

    static std::uint64_t join(Collective operation, int lane, std::uint64_t all, std::uint64_t value) {
        switch (operation) {
            case Collective::ballot: return all | (value != 0 ? std::uint64_t{1} << lane : 0);
            case Collective::all: return all != 0 && value != 0 ? 1 : 0;
            case Collective::any: return all != 0 || value != 0 ? 1 : 0;
            case Collective::reduce_min: return std::min(all, value);
            case Collective::reduce_max: return std::max(all, value);
            case Collective::reduce_add: return (all + value) & 0xffffffffU;
            case Collective::reduce_and: return all & value;
            case Collective::reduce_or: return all | value;
            case Collective::sync:
            case Collective::shuffle: break;
        }
        return 0;
    }

    std::uint64_t reduced(const Thread& thread) const {
        const Collective operation = thread.waiting.operation;
        const bool from_ones =
            operation == Collective::all || operation == Collective::reduce_min || operation == Collective::reduce_and;
        std::uint64_t all = from_ones ? 0xffffffffU : 0;
        for (int i = 0; i < warp_lanes; ++i) {
            if ((thread.waiting.mask >> i & 1U) != 0) {
                const int first = thread.number / warp_lanes * warp_lanes;
                all = join(operation, i, all, at(first + i).waiting.value);
            }
        }
        return all;
    }

    [[noreturn]] static void broken(const Thread& thread, const std::string& why) {
        throw BrokenKernel("thread " + text(thread.indices.thread) + " of block " + text(thread.indices.block) +
                           ", waiting at " + text(thread.waiting.site) + ", " + why);
    }

    const std::function<void()>& kernel_;
    Dim3 grid_;
    Dim3 size_;
    int count_;
    std::size_t dynamic_bytes_;
    std::mt19937 random_;
    std::vector<int> order_;
    std::vector<Thread*> threads_;
    std::vector<Memory> memory_;
    Thread* current_ = nullptr;
    std::exception_ptr failure_;
    bool given_up_ = false;
};

Thread::Thread(Threads& threads)
    : fiber([this, &threads] {
          while (!threads.leaving()) {
              running->begin(*this);
              fiber.leave();
          }
      }) {}

std::vector<Dim3> block_order(Dim3 grid) {
    std::vector<Dim3> blocks;
    for (unsigned z = 0; z < grid.z; ++z) {
        for (unsigned y = 0; y < grid.y; ++y) {
            for (unsigned x = 0; x < grid.x; ++x) {
                blocks.emplace_back(x, y, z);
            }
        }
    }
    if (settings().order == Order::descending) {
        std::reverse(blocks.begin(), blocks.end());
    } else if (settings().order == Order::shuffled) {
        std::mt19937 random(settings().seed);
        std::shuffle(blocks.begin(), blocks.end(), random);
    }
    return blocks;
}

// The blocks of a launch that run at the same time.
class Residents {
public:
    Residents(Dim3 grid, Dim3 block, std::size_t dynamic_bytes, const std::function<void()>& kernel)
        : waiting_(block_order(grid)), random_(settings().seed) {
        std::reverse(waiting_.begin(), waiting_.end());
        const auto threads = static_cast<int>(block.x * block.y * block.z);
        const int most = std::min(settings().resident_blocks, static_cast<int>(waiting_.size()));
        for (int i = 0; i < most; ++i) {
            all_.push_back(std::make_unique<Block>(grid, block, dynamic_bytes, kernel, i * threads));
        }
    }

    void run() {
        for (auto& block : all_) {
            start_next(*block);
        }
        try {
            while (!all_.empty()) {
                take_turns();
            }
        } catch (...) {
            for (auto& block : all_) {
                running = block.get();
                block->give_up();
            }
            throw;
        }
        running = nullptr;
    }

private:
    void start_next(Block& block) {
        block.start(waiting_.back());
        waiting_.pop_back();
    }

    void take_turns() {
        std::shuffle(all_.begin(), all_.end(), random_);
        bool moved = false;
        for (std::size_t i = 0; i < all_.size(); ++i) {
            if (random_() % 2 == 0 && all_.size() > 1) {
                moved = true;  // some are faster than others
                continue;
            }
            running = all_[i].get();
            const Turn turn = running->take_turn();
            moved = moved || turn != Turn::only_waited;
            if (turn != Turn::ended) {
                continue;
            }
            if (!waiting_.empty()) {
                start_next(*running);
            } else {
                all_.erase(all_.begin() + static_cast<std::ptrdiff_t>(i--));
            }
        }
        if (!moved && !all_.empty()) {
            all_.front()->refuse_waiting();
        }
    }

    std::vector<Dim3> waiting_;  // in reverse
    std::mt19937 random_;
    std::vector<std::unique_ptr<Block>> all_;
};

}  // namespace

Settings& settings() {
    static Settings all;
    return all;
}

void run(Dim3 grid, Dim3 block, std::size_t dynamic_shared_bytes, const std::function<void()>& kernel) {
    const std::size_t threads = std::size_t{block.x} * block.y * block.z;
    if (threads == 0 || threads > max_threads || std::size_t{grid.x} * grid.y * grid.z == 0) {
        throw BrokenKernel("a launch of " + text(grid) + " blocks of " + text(block) + " threads");
    }
    Residents(grid, block, dynamic_shared_bytes, kernel).run();
}

const Indices& indices() {
    return running->current().indices;
}

void block_barrier(Site site) {
    running->current().waiting = {Collective::sync, 0, 0, 0, site};
    running->wait(State::at_barrier);
}

std::uint64_t warp_operation(Collective operation, unsigned mask, std::uint64_t value, int source, Site site) {
    return running->warp_operation({operation, mask, value, source, site});
}

int lane() {
    return running->current().number % warp_lanes;
}

void atomic_done() {
    if (settings().turn_after_atomics) {
        running->wait(State::ready);
    }
}

void wait_for_others(Site site) {
    running->current().waiting.site = site;
    running->current().waits_for_others = true;
    running->wait(State::ready);
}

void* shared_memory(const void* tag, std::size_t bytes) {
    return running->shared_memory(tag, bytes);
}

void* dynamic_shared_memory() {
    return running->shared_memory(nullptr, 0);
}

}  // namespace disparityd::simt
