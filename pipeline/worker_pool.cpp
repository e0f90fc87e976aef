// SPDX-License-Identifier: Apache-2.0
#include "pipeline/worker_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include <pthread.h>

#include "capture/start_thread.h"
#include "kernels/look_for_a_while.h"
#include "pipeline/core_places.h"
#include "pipeline/cores.h"
#include "pipeline/waiting_line.h"

namespace disparityd::pipeline {

namespace {

/// One call of for_each(), on its caller's stack, in the pool's list while it has tasks that nobody took.
struct Job {
    Job(int task_count, FunctionRef<void(int)> function) : count(task_count), task(function) {}

    bool run_one() {
        const int index = next.fetch_add(1, std::memory_order_relaxed);
        if (index >= count) {
            return false;
        }
        task(index);
        return true;
    }
    /// The caller has a task too.
    bool wants_help() const { return next.load(std::memory_order_relaxed) < count && helpers < count - 1; }

    const int count;
    FunctionRef<void(int)> task;
    std::atomic<int> next{0};
    // Changed under the pool's lock.
    std::atomic<int> helpers{0};
    std::condition_variable left;
    Job* following = nullptr;
};

/// A thread that waits for a seat, on its own stack.
struct Waiter {
    const pthread_t thread = pthread_self();
    bool seated = false;
    int core = CorePlaces::none;
    std::condition_variable called;
    Waiter* following = nullptr;
};

struct Helper {
    std::thread thread;
    Job* job = nullptr;           ///< what it is to work at; none: it sleeps without a seat, or looks out
    bool begun = false;           ///< it is awake and at it
    bool looking_out = false;     ///< for another job, with its seat
    unsigned chosen_at = 0;       ///< value of changes_ then
    int core = CorePlaces::none;  ///< which it is bound to; taken while it works
    std::condition_variable woken;
};

}  // namespace

class WorkerPool::Impl {
public:
    Impl(int workers, Pinning pinning)
        : workers_(workers),
          cores_(workers, pinning == Pinning::where_allowed),
          free_seats_(workers),
          helpers_(static_cast<std::size_t>(workers - 1)) {
        try {
            for (Helper& helper : helpers_) {
                helper.thread = capture::start_thread([this, &helper] { help(helper); });
            }
        } catch (...) {
            end_helpers();
            throw;
        }
    }

    ~Impl() { end_helpers(); }

    int workers() const { return workers_; }

    Placement placement() const {
        const std::lock_guard lock(mutex_);
        return {cores_.bound(), cores_.text()};
    }

    int waiting() const {
        const std::lock_guard lock(mutex_);
        return waiters_.length();
    }

    void run(Job& job) {
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
            look_for_a_while([&] { return job.helpers.load(std::memory_order_relaxed) == 0; });
            lock.lock();
        }
        job.left.wait(lock, [&] { return job.helpers == 0; });
    }

    /// The core that goes with it, to which the thread is bound; or none.
    int take_seat() {
        std::unique_lock lock(mutex_);
        if (free_seats_ > 0) {
            --free_seats_;
            ++callers_;
            const int core = cores_.take(sched_getcpu(), CorePlaces::none);
            lock.unlock();
            return bind_self(core);
        }
        Waiter waiter;
        waiters_.append(waiter);
        changes_.fetch_add(1, std::memory_order_relaxed);
        waiter.called.wait(lock, [&] { return waiter.seated; });
        return waiter.core;
    }

    void leave_seat(int core) {
        const std::lock_guard lock(mutex_);
        --callers_;
        free_seat(core);
        call_helpers();
    }

private:
    /// Of those that were started.
    void end_helpers() {
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

    void help(Helper& self) {
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
                // Whoever has come since may need help more, and a stage that waits for a seat goes first: it has a
                // frame to bring on its way.
                while (changes_.load(std::memory_order_relaxed) == chosen_at && job.run_one()) {
                }
                lock.lock();
                leave(self, job, lock);
            }
        }
    }

    /// The helper goes on with another job, or gives its seat away and sleeps.
    void leave(Helper& self, Job& job, std::unique_lock<std::mutex>& lock) {
        self.job = nullptr;
        self.begun = false;
        if (--job.helpers == 0) {
            job.left.notify_one();
        }
        Job* next = job_of_helper(&job);
        if (next == nullptr) {
            look_out(self, lock);
            next = job_of_helper(nullptr);
        }
        if (next != nullptr) {
            assign(self, *next);
        } else {
            free_seat(self.core);
        }
    }

    /// None where somebody waits for the helper's seat.
    Job* job_of_helper(const Job* current) const { return waiters_.first() == nullptr ? neediest(current) : nullptr; }

    /// While somebody has a frame in work: the next step of it most likely wants help sooner than a sleeping thread
    /// would be awake.
    void look_out(Helper& self, std::unique_lock<std::mutex>& lock) {
        if (waiters_.first() != nullptr) {
            return;
        }
        const unsigned seen = changes_.load(std::memory_order_relaxed);
        self.looking_out = true;
        lock.unlock();
        look_for_a_while([&] {
            return changes_.load(std::memory_order_relaxed) != seen || callers_.load(std::memory_order_relaxed) == 0;
        });
        lock.lock();
        self.looking_out = false;
    }

    /// Nothing is left to do for those that were called and have not come yet: on a busy machine that may take long.
    void withdraw_late_helpers(Job& job) {
        for (Helper& helper : helpers_) {
            if (helper.job == &job && !helper.begun) {
                helper.job = nullptr;
                --job.helpers;
                free_seat(helper.core);
            }
        }
        call_helpers();
    }

    void assign(Helper& helper, Job& job) const {
        ++job.helpers;
        helper.job = &job;
        helper.chosen_at = changes_.load(std::memory_order_relaxed);
    }

    /// The job with the fewest helpers; of equal ones `current`, else the oldest.
    Job* neediest(const Job* current) const {
        Job* best = nullptr;
        for (Job* job = jobs_.first(); job != nullptr; job = job->following) {
            if (job->wants_help() && (best == nullptr || job->helpers < best->helpers ||
                                      (job->helpers == best->helpers && job == current))) {
                best = job;
            }
        }
        return best;
    }

    /// A seat goes to whoever waits longest for one.
    void free_seat(int core) {
        Waiter* waiter = waiters_.first();
        if (waiter == nullptr) {
            cores_.give_back(core);
            ++free_seats_;
            return;
        }
        waiters_.remove(*waiter);
        waiter->core = cores_.bound() && bind(waiter->thread, core) ? core : CorePlaces::none;
        waiter->seated = true;
        ++callers_;
        waiter->called.notify_one();
    }

    /// Wakes sleeping helpers for the jobs that want them, as far as there are free seats.
    void call_helpers() {
        while (free_seats_ > 0) {
            Job* job = neediest(nullptr);
            Helper* helper = job != nullptr ? sleeping_helper() : nullptr;
            if (helper == nullptr) {
                return;
            }
            --free_seats_;
            assign(*helper, *job);
            place(*helper);
            helper->woken.notify_one();
        }
    }

    /// Best one that can go on where it is bound.
    Helper* sleeping_helper() {
        Helper* found = nullptr;
        for (Helper& helper : helpers_) {
            if (helper.job == nullptr && !helper.looking_out && (found == nullptr || cores_.is_free(helper.core))) {
                found = &helper;
                if (cores_.is_free(helper.core)) {
                    break;
                }
            }
        }
        return found;
    }

    void place(Helper& helper) {
        const int core = cores_.take(helper.core, sched_getcpu());
        if (core != helper.core && bind(helper.thread.native_handle(), core)) {
            helper.core = core;
        }
    }

    /// Without the lock: to move to another core takes a while. The core, or none.
    int bind_self(int core) {
        const int error = core == CorePlaces::none ? 0 : bind_to_core(pthread_self(), core);
        if (error == 0) {
            return core;
        }
        const std::lock_guard lock(mutex_);
        cores_.refused(error);
        return CorePlaces::none;
    }

    // A thread that sleeps, so that it wakes where it can run at once and not behind whoever wakes it.
    bool bind(pthread_t thread, int core) {
        if (core == CorePlaces::none) {
            return false;
        }
        const int error = bind_to_core(thread, core);
        if (error != 0) {
            cores_.refused(error);
        }
        return error == 0;
    }

    const int workers_;
    mutable std::mutex mutex_;
    CorePlaces cores_;
    WaitingLine<Job> jobs_;
    WaitingLine<Waiter> waiters_;  ///< nobody waits while a seat is free
    int free_seats_;
    std::atomic<unsigned> changes_{0};  ///< of jobs_ and waiters_: somebody has come
    std::atomic<int> callers_{0};       ///< seats held by others than helpers; changed under the lock
    bool stopping_ = false;
    std::vector<Helper> helpers_;
};

WorkerPool::WorkerPool(int workers, Pinning pinning)
    : impl_(std::make_unique<Impl>(workers > 0 ? workers : cores_worth(), pinning)) {}

WorkerPool::~WorkerPool() = default;

int WorkerPool::workers() const {
    return impl_->workers();
}

void WorkerPool::for_each(int count, FunctionRef<void(int)> task) {
    if (impl_->workers() == 1 || count <= 1) {
        Serial().for_each(count, task);
        return;
    }
    Job job(count, task);
    impl_->run(job);
}

WorkerPool::Placement WorkerPool::placement() const {
    return impl_->placement();
}

int WorkerPool::waiting() const {
    return impl_->waiting();
}

WorkerPool::Seat::Seat(WorkerPool& pool) : pool_(pool) {
    // It fails only where the system does not say which cores there are; no thread is bound then.
    pthread_getaffinity_np(pthread_self(), sizeof before_, &before_);
    core_ = pool.impl_->take_seat();
}

WorkerPool::Seat::~Seat() {
    if (core_ != CorePlaces::none) {
        pthread_setaffinity_np(pthread_self(), sizeof before_, &before_);
    }
    pool_.impl_->leave_seat(core_);
}

}  // namespace disparityd::pipeline
