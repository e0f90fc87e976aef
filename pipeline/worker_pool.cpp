// SPDX-License-Identifier: Apache-2.0
#include "pipeline/worker_pool.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <memory>
#include <string>
#include <thread>

#include "base/start_thread.h"
#include "kernels/spin_until.h"
#include "pipeline/cores.h"

namespace disparityd::pipeline {

/// One call of for_each(). It lies on the caller's stack, and in the pool's list while tasks are left.
struct WorkerPool::Job {
    Job(int task_count, FunctionRef<void(int)> function) : count(task_count), task(function) {}

    bool run_one() {
        const int index = next.fetch_add(1, std::memory_order_relaxed);
        if (index >= count) {
            return false;
        }
        try {
            task(index);
        } catch (...) {
            // The other tasks run all the same: some may wait for each other. The first failure counts.
            if (!failed.exchange(true)) {
                failure = std::current_exception();
            }
        }
        return true;
    }
    /// Returns whether a helper would find a task: the caller takes one itself.
    bool wants_help() const { return next.load(std::memory_order_relaxed) < count && helpers < count - 1; }

    const int count;
    FunctionRef<void(int)> task;
    const TraceWork work = trace_work;  ///< of the caller
    std::atomic<int> next{0};
    std::atomic<bool> failed{false};
    std::exception_ptr failure;  ///< read by the caller when all helpers have left
    // These change under the pool's lock.
    std::atomic<int> helpers{0};
    std::condition_variable left;
    Job* following = nullptr;
};

/// A thread that waits for a compute slot. It lies on the stack of that thread.
struct WorkerPool::Waiter {
    const pthread_t thread = pthread_self();
    bool has_slot = false;
    int core = CoreAllocator::none;
    std::condition_variable called;
    Waiter* following = nullptr;
};

struct WorkerPool::Helper {
    std::unique_ptr<TraceTrack> track;
    std::thread thread;
    Job* job = nullptr;              ///< what it works at; null: it lingers, or sleeps without a compute slot
    bool begun = false;              ///< whether it is awake and works at `job`
    bool lingering = false;          ///< whether it waits awake for another job, with its compute slot
    unsigned chosen_at = 0;          ///< value of changes_ when it got its job
    int core = CoreAllocator::none;  ///< that it is pinned to; lent to it while it works
    std::condition_variable woken;
};

WorkerPool::WorkerPool(int workers, Pinning pinning, CoreClaims* claims)
    : workers_(workers > 0 ? workers : cores_worth()),
      claims_(claims),
      cores_(workers_, pinning == Pinning::where_allowed),
      free_slots_(workers_),
      helpers_(static_cast<std::size_t>(workers_ - 1)) {
    // It fails only where the system does not say which cores there are; no thread is pinned then.
    pthread_getaffinity_np(pthread_self(), sizeof unpinned_, &unpinned_);
    if (claims_ == nullptr) {
        for (const int core : cores_.allowed()) {
            cores_.add(core);
        }
    }
    try {
        int number = 0;
        for (Helper& helper : helpers_) {
            helper.track = std::make_unique<TraceTrack>(tracer_, "worker " + std::to_string(++number));
            helper.thread = base::start_thread([this, &helper] { help(helper); });
        }
    } catch (...) {
        end_helpers();
        throw;
    }
}

WorkerPool::~WorkerPool() {
    end_helpers();
}

int WorkerPool::workers() const {
    return workers_;
}

WorkerPool::Placement WorkerPool::placement() const {
    const std::lock_guard lock(mutex_);
    return {cores_.is_complete(), cores_.text()};
}

bool WorkerPool::claim_cores() {
    if (claims_ == nullptr) {
        return false;
    }
    // Claims ask the system, for which no stage is to wait: they are made without the lock.
    const std::string before = placement().text;
    const auto lost =
        std::stable_partition(claimed_.begin(), claimed_.end(), [this](int core) { return claims_->claim(core); });
    const std::vector<int> no_more(lost, claimed_.end());
    claimed_.erase(lost, claimed_.end());
    std::string refusal = no_more.empty() ? "" : claims_->refusal();
    for (const int core : wanted_cores(no_more)) {
        if (claims_->claim(core)) {
            claimed_.push_back(core);
        } else if (refusal.empty()) {
            refusal = claims_->refusal();
        }
        if (static_cast<int>(claimed_.size()) == workers_) {
            break;
        }
    }
    {
        const std::lock_guard lock(mutex_);
        for (const int core : claimed_) {
            cores_.add(core);
        }
        cores_.explain(refusal);
        if (cores_.pinning_enabled()) {
            return cores_.text() != before;
        }
    }
    give_cores_back();  // the system has refused to pin
    return placement().text != before;
}

/// Withdraws the cores that the pool has lost. Returns those that it may try to claim, the best ones first; none where
/// each worker has one.
std::vector<int> WorkerPool::wanted_cores(const std::vector<int>& lost) {
    const auto is_in = [](const std::vector<int>& cores, int core) {
        return std::find(cores.begin(), cores.end(), core) != cores.end();
    };
    const std::lock_guard lock(mutex_);
    for (const int core : lost) {
        cores_.withdraw(core);
    }
    std::vector<int> wanted;
    for (const int core : cores_.allowed()) {
        if (cores_.missing() > 0 && !is_in(claimed_, core) && !is_in(lost, core)) {
            wanted.push_back(core);
        }
    }
    return wanted;
}

void WorkerPool::give_cores_back() {
    const std::lock_guard lock(mutex_);
    for (Helper& helper : helpers_) {
        if (!claimed_.empty() && helper.core != CoreAllocator::none && helper.job == nullptr && !helper.lingering) {
            pthread_setaffinity_np(helper.thread.native_handle(), sizeof unpinned_, &unpinned_);
            helper.core = CoreAllocator::none;
        }
    }
    for (const int core : claimed_) {
        cores_.withdraw(core);
    }
    claimed_.clear();
    if (claims_ != nullptr) {
        claims_->leave();
    }
    cores_.explain("");
}

int WorkerPool::waiting() const {
    const std::lock_guard lock(mutex_);
    return waiters_.length();
}

void WorkerPool::for_each(int count, FunctionRef<void(int)> task) {
    if (workers_ == 1 || count <= 1) {
        Serial().for_each(count, task);
        return;
    }
    Job job(count, task);
    run(job);
}

void WorkerPool::run(Job& job) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.append(job);
        changes_.fetch_add(1, std::memory_order_relaxed);
        call_helpers();
    }
    while (job.run_one()) {
    }
    std::unique_lock lock(mutex_);
    jobs_.remove(job);
    withdraw_late_helpers(job);
    if (job.helpers > 0) {
        lock.unlock();
        spin_until([&] { return job.helpers.load(std::memory_order_relaxed) == 0; });
        lock.lock();
    }
    job.left.wait(lock, [&] { return job.helpers == 0; });
    lock.unlock();
    if (job.failure) {
        std::rethrow_exception(job.failure);
    }
}

/// Returns the core that the calling thread is pinned to, or none.
int WorkerPool::acquire_slot() {
    std::unique_lock lock(mutex_);
    if (free_slots_ > 0) {
        --free_slots_;
        ++callers_;
        const int core = cores_.take(sched_getcpu(), CoreAllocator::none);
        lock.unlock();
        return pin_self(core);
    }
    Waiter waiter;
    waiters_.append(waiter);
    changes_.fetch_add(1, std::memory_order_relaxed);
    waiter.called.wait(lock, [&] { return waiter.has_slot; });
    return waiter.core;
}

void WorkerPool::release_slot(int core) {
    const std::lock_guard lock(mutex_);
    --callers_;
    free_slot(core);
    call_helpers();
}

/// Ends the helpers that were started.
void WorkerPool::end_helpers() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    for (Helper& helper : helpers_) {
        helper.woken.notify_one();
        if (helper.thread.joinable()) {
            helper.thread.join();
        }
    }
}

void WorkerPool::help(Helper& self) {
    pthread_setname_np(pthread_self(), "worker");
    std::unique_lock lock(mutex_);
    for (;;) {
        self.woken.wait(lock, [&] { return stopping_ || self.job != nullptr; });
        if (self.job == nullptr) {
            return;
        }
        while (self.job != nullptr) {
            Job& job = *self.job;
            self.begun = true;
            const unsigned chosen_at = self.chosen_at;
            lock.unlock();
            // A job that has come since may need help more. A stage that waits for a slot goes first: it has a
            // frame.
            {
                const TraceSpan span(*self.track, TraceKind::help, job.work.name, job.work.frame);
                while (changes_.load(std::memory_order_relaxed) == chosen_at && job.run_one()) {
                }
            }
            lock.lock();
            leave(self, job, lock);
        }
    }
}

/// Ends the work at `job`: the helper goes on with another job, or gives its slot away and sleeps.
void WorkerPool::leave(Helper& self, Job& job, std::unique_lock<std::mutex>& lock) {
    self.job = nullptr;
    self.begun = false;
    if (--job.helpers == 0) {
        job.left.notify_one();
    }
    Job* next = job_of_helper(&job);
    if (next == nullptr) {
        linger(self, lock);
        next = job_of_helper(nullptr);
    }
    if (next != nullptr) {
        assign(self, *next);
    } else {
        free_slot(self.core);
    }
}

/// Returns the job that a helper goes on with; null where a thread waits for the helper's slot.
WorkerPool::Job* WorkerPool::job_of_helper(const Job* current) const {
    return waiters_.first() == nullptr ? least_helped(current) : nullptr;
}

/// Waits awake for a change while a stage works on a frame: its next step comes sooner than a sleeping thread wakes.
void WorkerPool::linger(Helper& self, std::unique_lock<std::mutex>& lock) {
    if (waiters_.first() != nullptr) {
        return;
    }
    const unsigned seen = changes_.load(std::memory_order_relaxed);
    self.lingering = true;
    lock.unlock();
    {
        const TraceSpan span(*self.track, TraceKind::awake, 0);
        spin_until([&] {
            return changes_.load(std::memory_order_relaxed) != seen || callers_.load(std::memory_order_relaxed) == 0;
        });
    }
    lock.lock();
    self.lingering = false;
}

/// Takes the job from helpers that are not awake yet: no task is left, and on a busy machine they may take long.
void WorkerPool::withdraw_late_helpers(Job& job) {
    for (Helper& helper : helpers_) {
        if (helper.job == &job && !helper.begun) {
            helper.job = nullptr;
            --job.helpers;
            free_slot(helper.core);
        }
    }
    call_helpers();
}

void WorkerPool::assign(Helper& helper, Job& job) const {
    ++job.helpers;
    helper.job = &job;
    helper.chosen_at = changes_.load(std::memory_order_relaxed);
}

/// Returns the job with the fewest helpers; of equal ones `current`, else the oldest.
WorkerPool::Job* WorkerPool::least_helped(const Job* current) const {
    Job* best = nullptr;
    for (Job* job = jobs_.first(); job != nullptr; job = job->following) {
        if (job->wants_help() &&
            (best == nullptr || job->helpers < best->helpers || (job->helpers == best->helpers && job == current))) {
            best = job;
        }
    }
    return best;
}

/// Gives the slot to the thread that waits longest.
void WorkerPool::free_slot(int core) {
    Waiter* waiter = waiters_.first();
    if (waiter == nullptr) {
        cores_.give_back(core);
        ++free_slots_;
        return;
    }
    waiters_.remove(*waiter);
    const int next = cores_.pass_on(core);
    waiter->core = pin(waiter->thread, next) ? next : CoreAllocator::none;
    waiter->has_slot = true;
    ++callers_;
    waiter->called.notify_one();
}

/// Wakes sleeping helpers for the jobs that want them, as far as there are free slots.
void WorkerPool::call_helpers() {
    while (free_slots_ > 0) {
        Job* job = least_helped(nullptr);
        Helper* helper = job != nullptr ? sleeping_helper() : nullptr;
        if (helper == nullptr) {
            return;
        }
        --free_slots_;
        assign(*helper, *job);
        place(*helper);
        helper->woken.notify_one();
    }
}

/// Returns a helper that sleeps, best one whose core is free; null when there is none.
WorkerPool::Helper* WorkerPool::sleeping_helper() {
    Helper* found = nullptr;
    for (Helper& helper : helpers_) {
        if (helper.job == nullptr && !helper.lingering && (found == nullptr || cores_.is_free(helper.core))) {
            found = &helper;
            if (cores_.is_free(helper.core)) {
                break;
            }
        }
    }
    return found;
}

void WorkerPool::place(Helper& helper) {
    const int core = cores_.take(helper.core, sched_getcpu());
    if (core == helper.core) {
        return;
    }
    if (core == CoreAllocator::none) {  // its last one is another thread's, of this pool or of another process
        pthread_setaffinity_np(helper.thread.native_handle(), sizeof unpinned_, &unpinned_);
        helper.core = core;
    } else if (pin(helper.thread.native_handle(), core)) {
        helper.core = core;
    }
}

/// Returns the core, or none when the system refuses. Called without the lock: moving to another core takes a while.
int WorkerPool::pin_self(int core) {
    const int error = core == CoreAllocator::none ? 0 : pin_to_core(pthread_self(), core);
    if (error == 0) {
        return core;
    }
    const std::lock_guard lock(mutex_);
    cores_.disable(error);
    return CoreAllocator::none;
}

/// Pins a thread that sleeps, so that it wakes on a free core, not behind the thread that wakes it.
bool WorkerPool::pin(pthread_t thread, int core) {
    if (core == CoreAllocator::none) {
        return false;
    }
    const int error = pin_to_core(thread, core);
    if (error != 0) {
        cores_.disable(error);
    }
    return error == 0;
}

WorkerPool::ComputeSlot::ComputeSlot(WorkerPool& pool) : pool_(pool) {
    // It fails only where the system does not say which cores there are; no thread is pinned then.
    pthread_getaffinity_np(pthread_self(), sizeof affinity_, &affinity_);
    core_ = pool.acquire_slot();
}

WorkerPool::ComputeSlot::~ComputeSlot() {
    if (core_ != CoreAllocator::none) {
        pthread_setaffinity_np(pthread_self(), sizeof affinity_, &affinity_);
    }
    pool_.release_slot(core_);
}

}  // namespace disparityd::pipeline
