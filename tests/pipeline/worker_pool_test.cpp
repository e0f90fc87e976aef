// SPDX-License-Identifier: Apache-2.0
#include "pipeline/worker_pool.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <barrier>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <semaphore>
#include <set>
#include <stdexcept>
#include <string>
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

TEST(WorkerPool, WhatATaskThrowsComesToTheCaller) {
    WorkerPool workers(3);
    std::atomic<int> ended{0};
    const auto task = [&](int index) {
        if (index % 10 == 3) {
            throw std::runtime_error("one in ten fails");
        }
        ++ended;
    };
    EXPECT_THROW(workers.for_each(100, task), std::runtime_error);
    EXPECT_EQ(ended, 90) << "all the others are run";
    ended = 0;
    workers.for_each(3, task);
    EXPECT_EQ(ended, 3) << "and the pool works on";
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

TEST(WorkerPool, ManyCallersNeverRunMoreThreadsThanSlots) {
    constexpr int slots = 3;
    WorkerPool pool(slots);
    std::atomic<int> running{0};
    std::atomic<int> most{0};
    std::atomic<int> tasks{0};
    std::vector<std::thread> callers;
    for (int caller = 0; caller < 5; ++caller) {
        callers.emplace_back([&] {
            for (int round = 0; round < 50; ++round) {
                const WorkerPool::ComputeSlot slot(pool);
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
    EXPECT_LE(most.load(), slots);
}

// Two stages at once: none of them runs ahead of the other by more than its tasks in hand, or both would wait for ever.
TEST(WorkerPool, CallersAtOnceAllMakeProgress) {
    for (const int workers : {2, 3}) {
        WorkerPool pool(workers);
        constexpr int tasks = 300;
        constexpr int ahead = 8;
        std::array<std::atomic<int>, 2> begun{};
        std::barrier both_have_slots(2);
        const auto stage = [&](std::size_t own, std::size_t other) {
            const WorkerPool::ComputeSlot slot(pool);
            both_have_slots.arrive_and_wait();
            pool.for_each(tasks, [&](int) {
                const int mine = begun[own].fetch_add(1);
                while (begun[other].load() < std::min(mine - ahead, tasks)) {
                    std::this_thread::yield();
                }
            });
        };
        std::thread first([&] { stage(0, 1); });
        std::thread second([&] { stage(1, 0); });
        first.join();
        second.join();
        EXPECT_EQ(begun[0].load(), tasks);
        EXPECT_EQ(begun[1].load(), tasks);
    }
}

TEST(WorkerPool, WhoComesLaterGetsHelpBeforeTheFirstHasFinished) {
    constexpr int workers = 4;
    constexpr int many = 100;
    WorkerPool pool(workers);
    std::counting_semaphore<> helpers_go_on(0), caller_goes_on(0);
    std::atomic<int> begun{0};
    std::thread first([&] {
        const auto caller = std::this_thread::get_id();
        const WorkerPool::ComputeSlot slot(pool);
        pool.for_each(many, [&](int) {
            begun.fetch_add(1);
            (std::this_thread::get_id() == caller ? caller_goes_on : helpers_go_on).acquire();
        });
    });
    while (begun.load() < workers) {
        std::this_thread::yield();
    }
    // Every slot is taken by the first; the second gets that of the first helper that looks up, then the next helper.
    std::atomic<int> met{0};
    std::thread second([&] {
        const WorkerPool::ComputeSlot slot(pool);
        pool.for_each(2, [&](int) {
            met.fetch_add(1);
            while (met.load() < 2) {
                std::this_thread::yield();
            }
        });
    });
    while (pool.waiting() == 0) {
        std::this_thread::yield();
    }
    helpers_go_on.release();
    while (met.load() == 0) {
        std::this_thread::yield();
    }
    helpers_go_on.release();
    second.join();
    EXPECT_LT(begun.load(), many);
    helpers_go_on.release(many);
    caller_goes_on.release(many);
    first.join();
    EXPECT_EQ(begun.load(), many);
}

TEST(WorkerPool, SlotsAreGivenInTheOrderOfAsking) {
    WorkerPool pool(1);
    std::vector<int> order;
    auto slot = std::make_unique<WorkerPool::ComputeSlot>(pool);
    std::vector<std::thread> others;
    for (int i = 0; i < 3; ++i) {
        others.emplace_back([&pool, &order, i] {
            const WorkerPool::ComputeSlot other(pool);
            order.push_back(i);
        });
        while (pool.waiting() <= i) {
            std::this_thread::yield();
        }
    }
    slot.reset();
    slot = std::make_unique<WorkerPool::ComputeSlot>(pool);
    order.push_back(3);
    slot.reset();
    for (std::thread& other : others) {
        other.join();
    }
    EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3}));
}

/// How often each helper of this process has been switched from or to; empty while one of them is awake.
std::map<std::string, std::string> sleeping_helpers() {
    std::map<std::string, std::string> helpers;
    for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
        std::ifstream file(thread.path() / "status");
        std::string status((std::istreambuf_iterator<char>(file)), {});
        if (!status.starts_with("Name:\tworker\n")) {
            continue;
        }
        if (status.find("State:\tS") == std::string::npos) {
            return {};
        }
        helpers[thread.path()] = status.substr(status.find("voluntary_ctxt_switches"));
    }
    return helpers;
}

// Not a matter of time: a thread that sleeps and was never switched to meanwhile has used nothing.
void expect_idle_helpers_sleep(WorkerPool& pool) {
    for (int round = 0; round < 100; ++round) {
        pool.for_each(50, [](int) {});
    }
    const auto processor_ms = [] { return std::clock() * 1000 / CLOCKS_PER_SEC; };
    bool quiet = false;
    for (int attempt = 0; attempt < 100 && !quiet; ++attempt) {
        const auto before = sleeping_helpers();
        for (const auto end = processor_ms() + 20; processor_ms() < end;) {
        }
        quiet = before.size() == 3 && sleeping_helpers() == before;
    }
    EXPECT_TRUE(quiet) << "helpers without work run";
}

TEST(WorkerPool, IdleHelpersSleep) {
    WorkerPool pool(4);
    expect_idle_helpers_sleep(pool);
}

TEST(WorkerPool, IdleHelpersSleepWhileSomebodyHasAFrameInWork) {
    WorkerPool pool(4);
    const WorkerPool::ComputeSlot slot(pool);
    expect_idle_helpers_sleep(pool);
}

// A helper that lingers has a slot, which another thread wants.
TEST(WorkerPool, SlotsAreFreeAtOnceWhenTheWorkHasEnded) {
    WorkerPool pool(2);
    const WorkerPool::ComputeSlot slot(pool);
    for (int round = 0; round < 200; ++round) {
        pool.for_each(2, [](int) {});
        std::thread([&] { const WorkerPool::ComputeSlot other(pool); }).join();
    }
}

TEST(WorkerPool, ZeroMeansAllCores) {
    EXPECT_GE(WorkerPool(0).workers(), 1);
}

}  // namespace
}  // namespace disparityd::pipeline
