// SPDX-License-Identifier: Apache-2.0
#include "tools/schedule/task_times.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <random>
#include <thread>
#include <vector>

#include "kernels/cpu/sgm/sgm_sweeps.h"
#include "kernels/large_buffer.h"
#include "tools/eval/median.h"

namespace disparityd::schedule {

namespace {

using cpu::MatchGeometry;
using cpu::SgmKernels;
using eval::median;
using Clock = std::chrono::steady_clock;

double microseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

// The kernels with a clock around them. A table of kernels has no place for state, so there is one of these; what is
// timed with it runs one task at a time.
struct TimedKernels {
    SgmKernels real;
    std::vector<double> costs;         // of each row
    std::vector<double> aggregate[2];  // of each group
    std::vector<double> winners;       // of each row
    Clock::time_point group_started;
};

TimedKernels timed;

void timed_matching_cost(const MatchGeometry& geometry, cpu::CensusPlanes<const std::uint8_t> planes, int y, int next,
                         cpu::SingleRowCosts* single, std::uint8_t* costs, std::uint8_t* streamed) {
    const auto start = Clock::now();
    timed.real.matching_cost(geometry, planes, y, next, single, costs, streamed);
    timed.costs.push_back(microseconds_since(start));
}

void timed_aggregate(const MatchGeometry& geometry, const cpu::SweepPass& pass, const cpu::PathRow& before,
                     const cpu::SweepRow* rows, int count, cpu::SweepSteps steps, std::uint8_t* state) {
    if (steps.first == 0) {
        timed.group_started = Clock::now();
    }
    timed.real.aggregate(geometry, pass, before, rows, count, steps, state);
    if (steps.end == cpu::steps_of(geometry.width, count) && count == timed.real.rows_at_once) {
        const std::size_t part = rows->prefetch[0] != nullptr ? 1 : 0;
        timed.aggregate[part].push_back(microseconds_since(timed.group_started));
    }
}

void timed_winner(const MatchGeometry& geometry, const PostOptions& options, const std::uint8_t* down,
                  const std::uint8_t* up, const std::uint8_t* costs, const cpu::WinnerRow& out) {
    const auto start = Clock::now();
    timed.real.winner(geometry, options, down, up, costs, out);
    timed.winners.push_back(microseconds_since(start));
}

SgmKernels with_clock(const SgmKernels& kernels) {
    timed = {};
    timed.real = kernels;
    SgmKernels table = kernels;
    table.matching_cost = timed_matching_cost;
    table.aggregate = timed_aggregate;
    table.winner = timed_winner;
    return table;
}

TaskTimes times_of_groups() {
    const int rows = timed.real.rows_at_once;
    return {rows * median(timed.costs),
            {median(timed.aggregate[0]), median(timed.aggregate[1])},
            rows * median(timed.winners)};
}

// All tasks one after the other, by one thread or by two in turn, whatever number of workers there seems to be.
class OneAtATime final : public Parallel {
public:
    OneAtATime(int workers, int threads) : workers_(workers), threads_(threads) {}
    int workers() const override { return workers_; }
    void for_each(int count, FunctionRef<void(int)> task) override {
        std::atomic<int> next{0};
        const auto run = [&](int thread) {
            for (int i = thread; i < count; i += threads_) {
                while (next.load(std::memory_order_acquire) != i) {
                    std::this_thread::yield();
                }
                task(i);
                next.store(i + 1, std::memory_order_release);
            }
        };
        if (threads_ == 1) {
            run(0);
            return;
        }
        std::thread other(run, 1);
        run(0);
        other.join();
    }

private:
    int workers_;
    int threads_;
};

// A frame to match again and again.
class Repeated {
public:
    Repeated(const Frame& frame, const SgmKernels& kernels)
        : frame_(frame),
          sweeps_(frame.width, frame.height, options(frame), kernels, frame.cache_bytes),
          census_(sweeps_.census_bytes()),
          image_(pixels()),
          disparity_(pixels()),
          winner_(pixels()),
          right_winner_(pixels()),
          confidence_(pixels()) {
        std::mt19937 random(1);
        std::generate(image_.begin(), image_.end(), [&] { return static_cast<std::uint8_t>(random() >> 24U); });
        Serial serial;
        sweeps_.census(plane(image_), plane(image_), planes(), serial);
    }

    void match(Parallel& workers) {
        sweeps_.match(planes(), plane(image_),
                      {plane(disparity_), plane(confidence_), plane(winner_), plane(right_winner_)}, workers);
    }

    static MatchOptions options(const Frame& frame) {
        MatchOptions options;
        options.range.count = frame.disparities;
        return options;
    }

private:
    std::size_t pixels() const {
        return static_cast<std::size_t>(frame_.width) * static_cast<std::size_t>(frame_.height);
    }
    std::span<std::byte> planes() const { return {census_.data(), census_.size()}; }
    template <typename T>
    Plane<T> plane(std::vector<T>& values) const {
        return {values.data(), frame_.width, frame_.height, frame_.width};
    }

    Frame frame_;
    cpu::SgmSweeps sweeps_;
    LargeBuffer census_;
    std::vector<std::uint8_t> image_;
    std::vector<std::int16_t> disparity_;
    std::vector<std::int16_t> winner_;
    std::vector<std::int16_t> right_winner_;
    std::vector<std::uint8_t> confidence_;
};

constexpr int frames = 15;

TaskTimes measure(const Frame& frame, int workers, int threads) {
    Repeated repeated(frame, with_clock(cpu::sgm_kernels(frame.target, frame.disparities)));
    OneAtATime parallel(workers, threads);
    for (int i = 0; i < frames; ++i) {
        repeated.match(parallel);
    }
    return times_of_groups();
}

}  // namespace

TaskTimes measure_alone(const Frame& frame, int workers) {
    return measure(frame, workers, 1);
}

double measure_handing_over(const Frame& frame) {
    // So many that a task is one group.
    constexpr int workers = cpu::SweepScheduler::max_workers;
    const TaskTimes alone = measure(frame, workers, 1);
    const TaskTimes in_turn = measure(frame, workers, 2);
    return (in_turn.aggregate[0] + in_turn.aggregate[1]) / (alone.aggregate[0] + alone.aggregate[1]);
}

double measure_frame(const Frame& frame, Parallel& workers) {
    Repeated repeated(frame, cpu::sgm_kernels(frame.target, frame.disparities));
    std::vector<double> times;
    for (int i = 0; i < 3 * frames; ++i) {
        const auto start = Clock::now();
        repeated.match(workers);
        times.push_back(microseconds_since(start));
    }
    return median(times);
}

Division division_of(const Frame& frame, int workers) {
    const int rows_at_once = cpu::sgm_kernels(frame.target, frame.disparities).rows_at_once;
    return {frame.width, rows_at_once,
            cpu::SweepPlan(frame.width, frame.height, rows_at_once, workers, cpu::SweepScheduler::max_workers)};
}

}  // namespace disparityd::schedule
