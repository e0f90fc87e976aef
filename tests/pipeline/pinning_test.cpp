// SPDX-License-Identifier: Apache-2.0
//
// Where the threads of the pool run. All in threads of their own, because what a thread may do passes on to what it
// starts.
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "pipeline/cores.h"
#include "pipeline/worker_pool.h"

namespace disparityd::pipeline {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

template <typename Function>
void in_a_thread(Function function) {
    std::thread(function).join();
}

void allow_only(const std::vector<int>& cores) {
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int core : cores) {
        CPU_SET(static_cast<std::size_t>(core), &set);
    }
    ASSERT_EQ(sched_setaffinity(0, sizeof set, &set), 0);
}

/// Two tasks that run at the same time say where they may run.
std::array<std::vector<int>, 2> cores_of_two_tasks(WorkerPool& pool) {
    std::array<std::vector<int>, 2> cores;
    std::atomic<int> arrived{0};
    pool.for_each(2, [&](int i) {
        cores[static_cast<std::size_t>(i)] = cores_allowed();
        arrived.fetch_add(1);
        while (arrived.load() < 2) {
            std::this_thread::yield();
        }
    });
    return cores;
}

TEST(Pinning, WorkersAtOnceHaveCoresOfTheirOwn) {
    WorkerPool pool(2);
    if (!pool.placement().pinned) {
        GTEST_SKIP() << pool.placement().text;
    }
    EXPECT_THAT(pool.placement().text, HasSubstr("pinned, each to one of cores "));
    const std::vector<int> before = cores_allowed();
    for (int round = 0; round < 50; ++round) {
        const WorkerPool::ComputeSlot slot(pool);
        const auto cores = cores_of_two_tasks(pool);
        ASSERT_EQ(cores[0].size(), 1U);
        ASSERT_EQ(cores[1].size(), 1U);
        ASSERT_NE(cores[0], cores[1]);
    }
    EXPECT_EQ(cores_allowed(), before) << "without a slot the thread runs where it could before";
}

TEST(Pinning, ManyStagesShareTheCores) {
    WorkerPool pool(2);
    if (!pool.placement().pinned) {
        GTEST_SKIP() << pool.placement().text;
    }
    std::array<std::atomic<int>, CPU_SETSIZE> on_core{};
    std::atomic<int> shared{0};
    std::vector<std::thread> stages;
    for (int stage = 0; stage < 4; ++stage) {
        stages.emplace_back([&] {
            for (int round = 0; round < 20; ++round) {
                const WorkerPool::ComputeSlot slot(pool);
                pool.for_each(5, [&](int) {
                    auto& here = on_core[static_cast<std::size_t>(cores_allowed().front())];
                    shared.fetch_add(here.fetch_add(1) > 0 ? 1 : 0);
                    std::this_thread::yield();
                    here.fetch_sub(1);
                });
            }
        });
    }
    for (std::thread& stage : stages) {
        stage.join();
    }
    EXPECT_EQ(shared.load(), 0) << "two threads of the pool on one core at the same time";
}

TEST(Pinning, SwitchedOff) {
    WorkerPool pool(2, Pinning::never);
    EXPECT_FALSE(pool.placement().pinned);
    EXPECT_EQ(pool.placement().text, "not pinned to cores: switched off");
    const WorkerPool::ComputeSlot slot(pool);
    const auto cores = cores_of_two_tasks(pool);
    EXPECT_EQ(cores[0], cores_allowed());
    EXPECT_EQ(cores[1], cores_allowed());
}

TEST(Pinning, TheMaskOfTheThreadIsRespected) {
    in_a_thread([] {
        const int only = cores_allowed().back();
        allow_only({only});
        WorkerPool pool(0);
        EXPECT_EQ(pool.workers(), 1);
        EXPECT_EQ(pool.placement().text, "pinned, each to one of cores " + std::to_string(only));
        const WorkerPool::ComputeSlot slot(pool);
        EXPECT_EQ(cores_allowed(), std::vector<int>{only});
    });
}

TEST(Pinning, MoreWorkersThanCoresAreNotPinned) {
    in_a_thread([] {
        allow_only({cores_allowed().front()});
        WorkerPool pool(2);
        EXPECT_FALSE(pool.placement().pinned);
        EXPECT_EQ(pool.placement().text, "not pinned to cores: 2 workers share 1 core");
        const WorkerPool::ComputeSlot slot(pool);
        EXPECT_EQ(cores_of_two_tasks(pool)[0], cores_allowed());
    });
}

#define SKIP_WITHOUT_PINNING()                                               \
    if (const auto placement = WorkerPool(1).placement(); !placement.pinned) \
    GTEST_SKIP() << placement.text

/// The cores of one computer, which several pools claim.
struct Computer {
    void give(int core, const CoreClaims& holder) {
        const std::lock_guard lock(mutex);
        holders[core] = &holder;
    }

    std::mutex mutex;
    std::map<int, const CoreClaims*> holders;
};

class Claims final : public CoreClaims {
public:
    explicit Claims(Computer& computer) : computer_(computer) {}
    bool claim(int core) override {
        const std::lock_guard lock(computer_.mutex);
        const bool mine = computer_.holders.try_emplace(core, this).first->second == this;
        refused_ = mine ? refused_ : core;
        return mine;
    }
    void leave() override {
        const std::lock_guard lock(computer_.mutex);
        std::erase_if(computer_.holders, [this](const auto& held) { return held.second == this; });
    }
    std::string refusal() const override { return "core " + std::to_string(refused_) + " is somebody's"; }

private:
    Computer& computer_;
    int refused_ = -1;
};

TEST(Pinning, TwoPoolsNeverShareAPinnedCore) {
    SKIP_WITHOUT_PINNING();
    const std::vector<int> all = cores_allowed();
    Computer computer;
    Claims rest(computer);
    std::for_each(all.begin() + 1, all.end(), [&](int core) { rest.claim(core); });
    std::array<Claims, 2> claims{Claims(computer), Claims(computer)};
    std::array<std::atomic<int>, CPU_SETSIZE> on_core{};
    std::atomic<int> shared{0};
    std::atomic<int> pinned{0};
    std::vector<std::thread> daemons;
    for (Claims& own : claims) {
        daemons.emplace_back([&on_core, &shared, &pinned, &own] {
            WorkerPool pool(1, Pinning::where_allowed, &own);
            for (int round = 0; round < 200; ++round) {
                pool.claim_cores();
                if (pool.placement().pinned) {
                    const WorkerPool::ComputeSlot slot(pool);
                    pinned.fetch_add(1);
                    auto& count = on_core[static_cast<std::size_t>(cores_allowed().front())];
                    shared.fetch_add(count.fetch_add(1) > 0 ? 1 : 0);
                    std::this_thread::yield();
                    count.fetch_sub(1);
                }
                if (round % 10 == 9) {
                    pool.give_cores_back();
                }
            }
        });
    }
    for (std::thread& daemon : daemons) {
        daemon.join();
    }
    EXPECT_EQ(shared.load(), 0);
    EXPECT_GT(pinned.load(), 0);
}

TEST(Pinning, WhoGetsNoCoreIsNotPinnedAndSaysSo) {
    SKIP_WITHOUT_PINNING();
    const std::vector<int> all = cores_allowed();
    Computer computer;
    Claims first_claims(computer), second_claims(computer);
    const int workers = static_cast<int>(all.size());
    WorkerPool first(workers, Pinning::where_allowed, &first_claims);
    WorkerPool second(1, Pinning::where_allowed, &second_claims);
    EXPECT_TRUE(first.placement().pinned) << "it has not asked yet: no news";
    EXPECT_TRUE(first.claim_cores());
    EXPECT_FALSE(first.claim_cores()) << "nothing is new";
    EXPECT_TRUE(second.claim_cores());
    EXPECT_TRUE(first.placement().pinned) << first.placement().text;
    EXPECT_FALSE(second.placement().pinned);
    EXPECT_THAT(second.placement().text, StartsWith("not pinned to cores: core "));
    EXPECT_THAT(second.placement().text, HasSubstr(" is somebody's"));
    {
        const WorkerPool::ComputeSlot slot(second);
        EXPECT_EQ(cores_allowed(), all);
    }
    first.give_cores_back();
    EXPECT_TRUE(second.claim_cores());
    EXPECT_TRUE(second.placement().pinned) << second.placement().text;
    const WorkerPool::ComputeSlot slot(second);
    EXPECT_EQ(cores_allowed().size(), 1U);
}

TEST(Pinning, WithFewerCoresThanWorkersTheOthersRunAnywhere) {
    SKIP_WITHOUT_PINNING();
    const std::vector<int> all = cores_allowed();
    if (all.size() < 2) {
        GTEST_SKIP() << "this takes two cores";
    }
    Computer computer;
    Claims claims(computer), other(computer);
    for (std::size_t i = 2; i < all.size(); ++i) {
        other.claim(all[i]);
    }
    WorkerPool pool(2, Pinning::where_allowed, &claims);
    pool.claim_cores();
    const WorkerPool::ComputeSlot slot(pool);
    const auto both = cores_of_two_tasks(pool);
    EXPECT_EQ(both[0].size() + both[1].size(), 2U) << "the helper has slept on a core of its own since";
    // Another program gets one of the two, such as when the file of the lock was removed.
    computer.give(all[0], other);
    EXPECT_TRUE(pool.claim_cores());
    EXPECT_FALSE(pool.placement().pinned);
    EXPECT_EQ(pool.placement().text, "pinned to cores " + std::to_string(all[1]) + ", but for 1 of 2: core " +
                                         std::to_string(all[0]) + " is somebody's");
}

TEST(Pinning, AWorkerWhoseCoreIsLostRunsAnywhere) {
    SKIP_WITHOUT_PINNING();
    const std::vector<int> all = cores_allowed();
    if (all.size() < 2) {
        GTEST_SKIP() << "this takes two cores";
    }
    Computer computer;
    Claims claims(computer), other(computer);
    WorkerPool pool(2, Pinning::where_allowed, &claims);
    pool.claim_cores();
    {
        const WorkerPool::ComputeSlot slot(pool);
        cores_of_two_tasks(pool);
    }
    for (const int core : all) {
        computer.give(core, other);
    }
    pool.claim_cores();
    EXPECT_THAT(pool.placement().text, StartsWith("not pinned to cores: "));
    // A helper that is still awake keeps its core until it sleeps.
    std::array<std::vector<int>, 2> both;
    for (int round = 0; round < 10000 && (both[0] != all || both[1] != all); ++round) {
        const WorkerPool::ComputeSlot slot(pool);
        both = cores_of_two_tasks(pool);
    }
    EXPECT_EQ(both[0], all);
    EXPECT_EQ(both[1], all);
}

/// As a container or a service manager may: sched_setaffinity() fails from now on in this thread and those it starts.
bool forbid_binding() {
    std::array<sock_filter, 4> rules{{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                                      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_sched_setaffinity, 0, 1),
                                      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM),
                                      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)}};
    const sock_fprog filter{static_cast<unsigned short>(rules.size()), rules.data()};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

TEST(Pinning, ARefusalFromTheStartIsReported) {
    in_a_thread([] {
        if (!forbid_binding()) {
            GTEST_SKIP() << "no filters of system calls here";
        }
        WorkerPool pool(1);
        EXPECT_FALSE(pool.placement().pinned);
        EXPECT_EQ(pool.placement().text, "not pinned to cores: the system refuses it: Operation not permitted");
        int runs = 0;
        const WorkerPool::ComputeSlot slot(pool);
        pool.for_each(5, [&](int) { ++runs; });
        EXPECT_EQ(runs, 5);
    });
}

TEST(Pinning, ARefusalLaterEndsIt) {
    WorkerPool pool(1);
    ASSERT_TRUE(pool.placement().pinned) << pool.placement().text;
    in_a_thread([&pool] {
        if (!forbid_binding()) {
            GTEST_SKIP() << "no filters of system calls here";
        }
        for (int round = 0; round < 2; ++round) {
            const WorkerPool::ComputeSlot slot(pool);
            EXPECT_EQ(pool.placement().text, "not pinned to cores: the system refuses it: Operation not permitted");
        }
    });
}

class Quota : public testing::Test {
protected:
    Quota() : root_(std::filesystem::temp_directory_path() / ("quota-test-" + std::to_string(getpid()))) {}
    ~Quota() override { std::filesystem::remove_all(root_); }

    void limit(const std::string& group, const std::string& text) const {
        std::filesystem::create_directories(root_ / group);
        std::ofstream(root_ / group / "cpu.max") << text << '\n';
    }

    std::filesystem::path root_;
};

TEST_F(Quota, TheLeastOnTheWayUpCounts) {
    EXPECT_EQ(quota_of("0::/a/b\n", root_), 0) << "there is no such group";
    limit("a/b", "max 100000");
    EXPECT_EQ(quota_of("0::/a/b\n", root_), 0);
    limit("a", "350000 100000");
    EXPECT_EQ(quota_of("0::/a/b\n", root_), 4) << "three cores and a half";
    limit("a/b", "200000 100000");
    EXPECT_EQ(quota_of("3:cpuset:/\n0::/a/b\n", root_), 2);
    EXPECT_EQ(quota_of("0::/\n", root_), 0);
    limit("", "50000 100000");
    EXPECT_EQ(quota_of("0::/\n", root_), 1);
    EXPECT_EQ(quota_of("", root_), 0);
}

TEST_F(Quota, DamagedTextIsNoLimit) {
    for (const char* text : {"", "max", "-1 100000", "100000 0", "words"}) {
        limit("a", text);
        EXPECT_EQ(quota_of("0::/a\n", root_), 0) << text;
    }
}

TEST(Cores, EachOnceAndAtLeastOne) {
    const std::vector<int> cores = cores_allowed();
    ASSERT_FALSE(cores.empty());
    EXPECT_EQ(std::set<int>(cores.begin(), cores.end()).size(), cores.size());
    EXPECT_GE(cores_worth(), 1);
    EXPECT_LE(cores_worth(), static_cast<int>(cores.size()));
}

}  // namespace
}  // namespace disparityd::pipeline
