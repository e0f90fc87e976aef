// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include <pthread.h>
#include <sched.h>

#include "kernels/parallel.h"
#include "pipeline/core_allocator.h"
#include "pipeline/core_claims.h"
#include "pipeline/trace.h"

namespace disparityd::pipeline {

/// Items in the order in which they came, linked through their own member `following`. The list owns no item and
/// allocates nothing.
template <typename T>
class FifoList {
public:
    T* first() const { return first_; }

    void append(T& item) {
        item.following = nullptr;
        T** link = &first_;
        while (*link != nullptr) {
            link = &(*link)->following;
        }
        *link = &item;
    }

    /// Takes `item`, which is in the list, out of it.
    void remove(T& item) {
        T** link = &first_;
        while (*link != &item) {
            link = &(*link)->following;
        }
        *link = item.following;
    }

    int length() const {
        int count = 0;
        for (const T* item = first_; item != nullptr; item = item->following) {
            ++count;
        }
        return count;
    }

private:
    T* first_ = nullptr;
};

/// Whether each thread is pinned to a core while it works.
enum class Pinning : unsigned char { where_allowed, never };

/// The one pool of workers that all stages share. A pool of N workers keeps N threads running at most: the threads that
/// hold a ComputeSlot, and helpers that take the compute slots left over and give them back when a stage wants one.
///
/// for_each() may be called by several threads at once: each works on its own tasks, helpers join whoever has the
/// fewest of them and look again after each task when somebody else has come. Compute slots are given in the order in
/// which they were asked for. Neither for_each() nor ComputeSlot allocates. A thread that waits sleeps after 50
/// microseconds: the steps of a frame follow each other sooner than a sleeping thread would be awake. An exception of a
/// task is thrown to the caller once all tasks have ended; of several the first.
///
/// Pinned, each running thread has a core of its own: its last one where that is free, else another one. Pinning needs
/// as many cores as workers and a system that allows it. With claims a thread is pinned to claimed cores only, and runs
/// where the system puts it while there is none for it.
class WorkerPool final : public Parallel {
public:
    /// `workers` counts the calling thread: 1 starts no helper. 0 = cores_worth(), see pipeline/cores.h. `claims`,
    /// which outlives the pool, says which cores it may pin to; null: nobody else pins.
    explicit WorkerPool(int workers, Pinning pinning = Pinning::where_allowed, CoreClaims* claims = nullptr);
    ~WorkerPool() override;
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    int workers() const override;
    void for_each(int count, FunctionRef<void(int)> task) override;

    /// Whether threads have cores of their own now; any thread may ask.
    struct Placement {
        bool pinned = false;  ///< false: at least one has none; true also while cores are not claimed
        std::string text;     ///< see CoreAllocator::text()
    };
    Placement placement() const;

    /// Claims a core for each worker that lacks one, and pins no more to those that are no longer the pool's. A pool
    /// with claims pins nothing before the first call; later ones find cores that others have given back. Returns
    /// whether the placement has changed. This and the next: one thread at a time, between frames or beside them.
    bool claim_cores();
    /// Gives all claimed cores back. To be called when nobody computes any more.
    void give_cores_back();

    /// Records what the helpers do, and whoever else adds a track to it. Helpers name the work as trace_work of the
    /// thread that they help.
    Tracer& tracer() { return tracer_; }

    /// How many threads wait for a compute slot at this moment.
    int waiting() const;

    /// The right to compute, of which there are as many as workers. A thread holds one while it works, for_each()
    /// included; the constructor waits for a free one. A thread takes one at a time. A thread that calls for_each()
    /// without one runs beside the N. Pinned, the thread runs on one core while it holds the slot; the destructor
    /// restores its affinity.
    class ComputeSlot {
    public:
        explicit ComputeSlot(WorkerPool& pool);
        ~ComputeSlot();
        ComputeSlot(const ComputeSlot&) = delete;
        ComputeSlot& operator=(const ComputeSlot&) = delete;

    private:
        WorkerPool& pool_;
        int core_;            ///< which the thread is pinned to; -1 = none
        cpu_set_t affinity_;  ///< of the thread without the slot
    };

private:
    struct Job;
    struct Waiter;
    struct Helper;

    void run(Job& job);
    int acquire_slot();
    void release_slot(int core);
    void end_helpers();
    void help(Helper& self);
    void leave(Helper& self, Job& job, std::unique_lock<std::mutex>& lock);
    Job* job_of_helper(const Job* current) const;
    void linger(Helper& self, std::unique_lock<std::mutex>& lock);
    void withdraw_late_helpers(Job& job);
    void assign(Helper& helper, Job& job) const;
    Job* least_helped(const Job* current) const;
    void free_slot(int core);
    void call_helpers();
    Helper* sleeping_helper();
    void place(Helper& helper);
    std::vector<int> wanted_cores(const std::vector<int>& lost);
    int pin_self(int core);
    bool pin(pthread_t thread, int core);

    const int workers_;
    CoreClaims* const claims_;  ///< null: all allowed cores are the pool's
    cpu_set_t unpinned_;        ///< where helpers run without a core of their own
    std::vector<int> claimed_;  ///< cores that are the pool's; of the thread that claims
    Tracer tracer_;
    mutable std::mutex mutex_;
    CoreAllocator cores_;
    FifoList<Job> jobs_;
    FifoList<Waiter> waiters_;  ///< nobody waits while a slot is free
    int free_slots_;
    std::atomic<unsigned> changes_{0};  ///< counts what was added to jobs_ and waiters_
    std::atomic<int> callers_{0};       ///< slots held by others than helpers; changed under the lock
    bool stopping_ = false;
    std::vector<Helper> helpers_;
};

}  // namespace disparityd::pipeline
