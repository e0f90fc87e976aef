// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "kernels/parallel.h"

namespace disparityd::pipeline {

/// The one pool of workers that all stages share. A pool of N workers keeps N threads running at most: the threads that
/// hold a Seat, and sleeping helpers that take the seats left over and give them back when a stage wants one.
///
/// for_each() may be called by several threads at once: each works on its own tasks, helpers join whoever has the
/// fewest of them. Nothing is allocated by for_each() or Seat.
class WorkerPool final : public Parallel {
public:
    /// `workers` counts the calling thread: 1 starts no helper. 0 = one per core that this process may run on.
    explicit WorkerPool(int workers);
    ~WorkerPool() override;
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    int workers() const override;
    void for_each(int count, FunctionRef<void(int)> task) override;

    /// Held by a thread while it works, for_each() included: one of the N places. Waits for a free one. Not taken twice
    /// by one thread. A thread that calls for_each() without one runs beside the N.
    class Seat {
    public:
        explicit Seat(WorkerPool& pool);
        ~Seat();
        Seat(const Seat&) = delete;
        Seat& operator=(const Seat&) = delete;

    private:
        WorkerPool& pool_;
    };

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace disparityd::pipeline
