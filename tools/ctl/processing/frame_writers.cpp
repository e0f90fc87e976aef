// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/frame_writers.h"

#include <utility>

#include <pthread.h>

#include "base/start_thread.h"

namespace disparityd::tools {

FrameWriters::FrameWriters(pipeline::WorkerPool& workers, Write write, Written written)
    : workers_(workers),
      write_(std::move(write)),
      written_(std::move(written)),
      most_(static_cast<std::size_t>(workers.workers()) + 1) {
    try {
        for (int i = 0; i < workers.workers(); ++i) {
            threads_.push_back(base::start_thread([this] {
                pthread_setname_np(pthread_self(), "write");
                work();
            }));
        }
    } catch (...) {
        end();
        throw;
    }
}

FrameWriters::~FrameWriters() {
    end();
}

void FrameWriters::end() noexcept {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

void FrameWriters::work() {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
        if (waiting_.empty()) {
            return;
        }
        Job& job = *waiting_.front();
        waiting_.pop_front();
        lock.unlock();
        try {
            const pipeline::WorkerPool::ComputeSlot slot(workers_);
            job.digests = write_(job.copy, job.name);
        } catch (...) {
            job.failure = std::current_exception();
        }
        lock.lock();
        job.done = true;
        changed_.notify_all();
    }
}

bool FrameWriters::is_done(const Job& job) const {
    const std::lock_guard lock(mutex_);
    return job.done;
}

void FrameWriters::collect(bool all) {
    std::exception_ptr failure;
    while (!at_hand_.empty() && (all || at_hand_.size() >= most_ || is_done(*at_hand_.front()))) {
        Job& job = *at_hand_.front();
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&job] { return job.done; });
        }
        if (!failed_ && !job.failure) {
            try {
                written_(std::move(job.frame), std::move(job.digests));
            } catch (...) {
                job.failure = std::current_exception();
            }
        }
        if (!failed_ && job.failure) {
            failure = job.failure;
            failed_ = true;
            all = true;  // nothing is written any more once somebody knows
        }
        spare_.push_back(std::move(at_hand_.front()));
        at_hand_.pop_front();
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
}

void FrameWriters::add(const FrameView& view, std::shared_ptr<const calibration::Rectification> rectification,
                       std::string name, Json frame) {
    collect(false);
    std::unique_ptr<Job> job;
    if (spare_.empty()) {
        job = std::make_unique<Job>();
    } else {
        job = std::move(spare_.back());
        spare_.pop_back();
        job->failure = nullptr;
        job->done = false;
    }
    job->copy.take(view, std::move(rectification));
    job->name = std::move(name);
    job->frame = std::move(frame);
    at_hand_.push_back(std::move(job));
    {
        const std::lock_guard lock(mutex_);
        waiting_.push_back(at_hand_.back().get());
    }
    changed_.notify_all();
}

void FrameWriters::settle() {
    collect(true);
}

}  // namespace disparityd::tools
