// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <sched.h>

#include "kernels/parallel.h"

namespace disparityd::pipeline {

/// Whether threads are bound to a core each while they work.
enum class Pinning : unsigned char { where_allowed, never };

/// The one pool of workers that all stages share. A pool of N workers keeps N threads running at most: the threads that
/// hold a Seat, and sleeping helpers that take the seats left over and give them back when a stage wants one.
///
/// for_each() may be called by several threads at once: each works on its own tasks, helpers join whoever has the
/// fewest of them and look again after each task when somebody else has come. Seats are given in the order in which
/// they were asked for. Nothing is allocated by for_each() or Seat. Who waits sleeps, after some ten microseconds: the
/// steps of a frame follow each other sooner than a sleeping thread would be awake.
///
/// Pinned, each running thread has a core of its own: one that it ran on before where that is free, else another one.
/// Needs as many cores as workers and a system that allows it.
class WorkerPool final : public Parallel {
public:
    /// `workers` counts the calling thread: 1 starts no helper. 0 = cores_worth(), see pipeline/cores.h.
    explicit WorkerPool(int workers, Pinning pinning = Pinning::where_allowed);
    ~WorkerPool() override;
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    int workers() const override;
    void for_each(int count, FunctionRef<void(int)> task) override;

    /// Whether threads have cores of their own now; any thread may ask.
    struct Placement {
        bool pinned = false;
        std::string text;  ///< "pinned, each to one of cores 0-3, 6", or "not pinned to cores: " and why
    };
    Placement placement() const;

    /// How many threads wait for a seat at this moment.
    int waiting() const;

    /// Held by a thread while it works, for_each() included: one of the N places. Waits for a free one. Not taken twice
    /// by one thread. A thread that calls for_each() without one runs beside the N. Where the thread may run is set
    /// while it has the seat and afterwards as it was.
    class Seat {
    public:
        explicit Seat(WorkerPool& pool);
        ~Seat();
        Seat(const Seat&) = delete;
        Seat& operator=(const Seat&) = delete;

    private:
        WorkerPool& pool_;
        int core_;          ///< which it is bound to meanwhile; -1 = none
        cpu_set_t before_;  ///< where the thread might run without the seat
    };

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace disparityd::pipeline
