// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/pipeline.h"
#include "tests/pipeline/fakes.h"
#include "tests/pipeline/limited_threads.h"

// Where the system starts no more threads, as in a container with a limit: one line, and nothing hangs or is left.
namespace disparityd::pipeline {
namespace {

using testing::HasSubstr;

class ThreadFailure : public testing::Test {
protected:
    ~ThreadFailure() override { test::allow_threads(-1); }
};

template <typename Action>
std::string failure(Action action) {
    try {
        action();
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "none";
}

TEST_F(ThreadFailure, APipelineEndsTheThreadsThatItHasStarted) {
    for (const Policy policy : {Policy::live, Policy::replay}) {
        for (int allowed = 0; allowed < 4; ++allowed) {
            fakes::Source source(1000);  // frames are there at once, for threads that do not wait for each other
            fakes::Matcher matcher;
            WorkerPool workers(1);
            const calibration::Rectification rectification = fakes::rectification();
            int published = 0;
            Pipeline pipeline({.policy = policy, .slots = 3}, source, matcher, workers, rectification,
                              [&](const FrameSlot&) { ++published; });
            test::allow_threads(allowed);
            EXPECT_THAT(failure([&] { pipeline.start(); }), HasSubstr("starts no more threads")) << allowed;
            EXPECT_EQ(source.in_use(), 0U);
            test::allow_threads(-1);
            pipeline.start();
            ASSERT_TRUE(pipeline.wait_until_ended(std::chrono::seconds(60)));
            pipeline.stop();
            EXPECT_GT(published, 0);
        }
    }
}

TEST_F(ThreadFailure, APoolEndsTheHelpersThatItHasStarted) {
    for (int allowed = 0; allowed < 3; ++allowed) {
        test::allow_threads(allowed);
        EXPECT_THAT(failure([] { const WorkerPool workers(4); }), HasSubstr("starts no more threads")) << allowed;
    }
    test::allow_threads(3);
    EXPECT_EQ(failure([] { const WorkerPool workers(4); }), "none");
}

}  // namespace
}  // namespace disparityd::pipeline
