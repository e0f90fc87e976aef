// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/daemon.h"
#include "tests/pipeline/limited_threads.h"
#include "tests/temporary_folder.h"

// A system that starts no more threads, as in a container with a limit: one line, and nothing hangs or is left.
namespace disparityd {
namespace {

using testing::HasSubstr;

class DaemonThreadFailure : public testing::Test {
protected:
    DaemonThreadFailure() {
        const std::string image = "P5 64 32 255\n" + std::string(64 * 32, 'x');
        folder_.write("left0.pgm", image);
        folder_.write("right0.pgm", image);
    }
    ~DaemonThreadFailure() override { test::allow_threads(-1); }

    /// Plays one frame with so many threads to be had.
    std::string failure(int threads) {
        daemon::Config config;
        config.source.uri = folder_.file("left%d.pgm") + "," + folder_.file("right%d.pgm");
        config.match.backend = "cpu";
        config.pipeline.workers = 2;
        config.socket.tcp = "127.0.0.1:0";
        config.socket.unix_path = folder_.file("socket");
        config.shared_memory.name = "thread-failure-test-" + std::to_string(getpid());
        config.log.level = daemon::LogLevel::error;
        test::allow_threads(threads);
        try {
            daemon::DaemonOptions options;
            options.exit_at_end = true;
            daemon::Daemon daemon(options, config);
            return daemon.run() ? "none" : "the source failed";
        } catch (const std::runtime_error& error) {
            return error.what();
        }
    }

private:
    test::TemporaryFolder folder_;
};

TEST_F(DaemonThreadFailure, IsSaidAndEndsWhateverThereIs) {
    int threads = 0;
    for (std::string said; said != "none"; ++threads) {
        ASSERT_LT(threads, 50) << said;
        said = failure(threads);
        EXPECT_THAT(said, testing::AnyOf("none", HasSubstr("the system starts no more threads: "))) << threads;
    }
    EXPECT_GT(threads, 5) << "pools, server, builder and the pipeline have threads of their own";
}

}  // namespace
}  // namespace disparityd
