// SPDX-License-Identifier: Apache-2.0
#include "pipeline/worker_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include <sched.h>

namespace disparityd::pipeline {

namespace {

int cores_allowed() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) == 0) {
        return std::max(1, CPU_COUNT(&set));
    }
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

// One call of for_each(), on its caller's stack, in the pool's list while it has tasks that nobody took.
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
    bool exhausted() const { return next.load(std::memory_order_relaxed) >= count; }

    const int count;
    FunctionRef<void(int)> task;
    std::atomic<int> next{0};
    int helpers = 0;  // guarded by the pool's mutex
    Job* following = nullptr;
};

}  // namespace

class WorkerPool::Impl {
public:
    explicit Impl(int workers) : workers_(workers), free_seats_(workers) {
        for (int i = 1; i < workers; ++i) {
            helpers_.emplace_back([this] { help(); });
        }
    }

    ~Impl() {
        {
            const std::lock_guard lock(mutex_);
            stopping_ = true;
        }
        work_.notify_all();
        for (std::thread& helper : helpers_) {
            helper.join();
        }
    }

    int workers() const { return workers_; }

    void run(Job& job) {
        {
            const std::lock_guard lock(mutex_);
            job.following = jobs_;
            jobs_ = &job;
        }
        work_.notify_all();
        while (job.run_one()) {
        }
        std::unique_lock lock(mutex_);
        remove(job);
        job_left_.wait(lock, [&] { return job.helpers == 0; });
    }

    void take_seat() {
        std::unique_lock lock(mutex_);
        seats_wanted_.fetch_add(1, std::memory_order_relaxed);
        seat_freed_.wait(lock, [&] { return free_seats_ > 0; });
        seats_wanted_.fetch_sub(1, std::memory_order_relaxed);
        --free_seats_;
        lock.unlock();
        // Helpers stood back for this thread; there may be seats left for them.
        work_.notify_all();
    }

    void leave_seat() {
        {
            const std::lock_guard lock(mutex_);
            ++free_seats_;
        }
        offer_seat();
    }

private:
    void help() {
        std::unique_lock lock(mutex_);
        for (;;) {
            Job* job = nullptr;
            work_.wait(lock, [&] { return stopping_ || (job = pick_job()) != nullptr; });
            if (stopping_) {
                return;
            }
            ++job->helpers;
            --free_seats_;
            lock.unlock();
            // A stage that waits for a seat goes first: it has a frame to bring on its way.
            while (seats_wanted_.load(std::memory_order_relaxed) == 0 && job->run_one()) {
            }
            lock.lock();
            ++free_seats_;
            if (--job->helpers == 0) {
                job_left_.notify_all();
            }
            lock.unlock();
            offer_seat();
            lock.lock();
        }
    }

    Job* pick_job() const {
        if (free_seats_ == 0 || seats_wanted_.load(std::memory_order_relaxed) > 0) {
            return nullptr;
        }
        Job* best = nullptr;
        for (Job* job = jobs_; job != nullptr; job = job->following) {
            if (!job->exhausted() && (best == nullptr || job->helpers < best->helpers)) {
                best = job;
            }
        }
        return best;
    }

    void offer_seat() {
        if (seats_wanted_.load(std::memory_order_relaxed) > 0) {
            seat_freed_.notify_one();
        } else {
            work_.notify_one();
        }
    }

    void remove(Job& job) {
        Job** link = &jobs_;
        while (*link != &job) {
            link = &(*link)->following;
        }
        *link = job.following;
    }

    const int workers_;
    std::mutex mutex_;
    std::condition_variable work_;
    std::condition_variable job_left_;
    std::condition_variable seat_freed_;
    Job* jobs_ = nullptr;
    int free_seats_;
    std::atomic<int> seats_wanted_{0};
    bool stopping_ = false;
    std::vector<std::thread> helpers_;
};

WorkerPool::WorkerPool(int workers) : impl_(std::make_unique<Impl>(workers > 0 ? workers : cores_allowed())) {}

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

WorkerPool::Seat::Seat(WorkerPool& pool) : pool_(pool) {
    pool_.impl_->take_seat();
}

WorkerPool::Seat::~Seat() {
    pool_.impl_->leave_seat();
}

}  // namespace disparityd::pipeline
