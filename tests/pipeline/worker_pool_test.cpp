// SPDX-License-Identifier: Apache-2.0
#include "pipeline/worker_pool.h"

#include <atomic>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

TEST(WorkerPool, RunsEachTaskOnce) {
    for (const int workers : {1, 2, 3, 8}) {
        WorkerPool pool(workers);
        EXPECT_EQ(pool.workers(), workers);
        for (const int count : {0, 1, 2, 7, 1000}) {
            std::vector<std::atomic<int>> runs(static_cast<std::size_t>(count));
            pool.for_each(count, [&](int i) { runs[static_cast<std::size_t>(i)].fetch_add(1); });
            for (const auto& run : runs) {
                EXPECT_EQ(run.load(), 1);
            }
        }
    }
}

TEST(WorkerPool, ResultsAreVisibleToTheCaller) {
    WorkerPool pool(4);
    std::vector<int> values(5000);
    for (int round = 1; round <= 50; ++round) {
        pool.for_each(static_cast<int>(values.size()), [&](int i) { values[static_cast<std::size_t>(i)] += round; });
    }
    for (const int value : values) {
        ASSERT_EQ(value, 50 * 51 / 2);
    }
}

TEST(WorkerPool, HelpersTakePart) {
    WorkerPool pool(2);
    // Each task waits for the other: only two threads at once get through.
    std::atomic<int> arrived{0};
    std::set<std::thread::id> threads;
    std::mutex mutex;
    pool.for_each(2, [&](int) {
        {
            const std::lock_guard lock(mutex);
            threads.insert(std::this_thread::get_id());
        }
        arrived.fetch_add(1);
        while (arrived.load() < 2) {
            std::this_thread::yield();
        }
    });
    EXPECT_EQ(threads.size(), 2U);
}

TEST(WorkerPool, ManyCallersNeverRunMoreThreadsThanSeats) {
    constexpr int seats = 3;
    WorkerPool pool(seats);
    std::atomic<int> running{0};
    std::atomic<int> most{0};
    std::atomic<int> tasks{0};
    std::vector<std::thread> callers;
    for (int caller = 0; caller < 5; ++caller) {
        callers.emplace_back([&] {
            for (int round = 0; round < 50; ++round) {
                const WorkerPool::Seat seat(pool);
                pool.for_each(20, [&](int) {
                    const int now = running.fetch_add(1) + 1;
                    int seen = most.load();
                    while (now > seen && !most.compare_exchange_weak(seen, now)) {
                    }
                    std::this_thread::yield();
                    tasks.fetch_add(1);
                    running.fetch_sub(1);
                });
            }
        });
    }
    for (std::thread& caller : callers) {
        caller.join();
    }
    EXPECT_EQ(tasks.load(), 5 * 50 * 20);
    EXPECT_LE(most.load(), seats);
}

TEST(WorkerPool, ZeroMeansAllCores) {
    EXPECT_GE(WorkerPool(0).workers(), 1);
}

}  // namespace
}  // namespace disparityd::pipeline
