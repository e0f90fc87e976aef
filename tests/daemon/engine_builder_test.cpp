// SPDX-License-Identifier: Apache-2.0
#include "daemon/engine_builder.h"

#include <future>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "base/failure_text.h"
#include "tests/temporary_folder.h"

namespace disparityd::daemon {
namespace {

Config config_of(const std::string& uri) {
    Config config;
    config.source.uri = uri;
    return config;
}

TEST(EngineBuilder, GivesTheEngineWithItsReasonAndConfiguration) {
    const test::TemporaryFolder folder;
    const std::string image = "P5 64 32 255\n" + std::string(64 * 32, 'x');
    folder.write("left0.pgm", image);
    folder.write("right0.pgm", image);
    std::promise<void> done;
    EngineBuilder builder(
        [](const Config& config, const EngineBuilder::Progress& progress) {
            return std::make_shared<Engine>(config, Engine::CarryOver{}, progress);
        },
        [&] { done.set_value(); });
    EXPECT_FALSE(builder.busy());
    Config config = config_of(folder.file("left%d.pgm") + "," + folder.file("right%d.pgm"));
    config.match.backend = "cpu";
    config.pipeline.workers = 1;
    builder.build(BuildReason::source_changed, config);
    done.get_future().wait();
    const auto built = builder.take();
    ASSERT_TRUE(built);
    EXPECT_EQ(built->reason, BuildReason::source_changed);
    EXPECT_EQ(built->config->source.uri, config.source.uri);
    ASSERT_FALSE(built->failure) << base::failure_text(built->failure);
    EXPECT_EQ(built->engine->layout().geometry.width, 64U);
}

TEST(EngineBuilder, IsBusyUntilTheResultIsTaken) {
    std::promise<void> go_on;
    std::promise<void> done;
    EngineBuilder builder(
        [&](const Config&, const EngineBuilder::Progress&) {
            go_on.get_future().wait();
            return std::shared_ptr<Engine>();
        },
        [&] { done.set_value(); });
    builder.build(BuildReason::reload, config_of("a"));
    EXPECT_TRUE(builder.busy());
    EXPECT_FALSE(builder.take());
    go_on.set_value();
    done.get_future().wait();
    EXPECT_TRUE(builder.busy());
    EXPECT_TRUE(builder.take());
    EXPECT_FALSE(builder.busy());
    EXPECT_FALSE(builder.take()) << "a result is given once";
}

TEST(EngineBuilder, GivesTheFailureAndBuildsAgain) {
    std::promise<void> done;
    int builds = 0;
    EngineBuilder builder(
        [&](const Config& config, const EngineBuilder::Progress&) -> std::shared_ptr<Engine> {
            ++builds;
            throw std::runtime_error("no source " + config.source.uri);
        },
        [&] { done.set_value(); });
    for (const char* uri : {"a", "b"}) {
        done = std::promise<void>();
        builder.build(BuildReason::rollback, config_of(uri));
        done.get_future().wait();
        const auto built = builder.take();
        ASSERT_TRUE(built);
        EXPECT_EQ(built->reason, BuildReason::rollback);
        EXPECT_FALSE(built->engine);
        ASSERT_TRUE(built->failure);
        EXPECT_EQ(base::failure_text(built->failure), std::string("no source ") + uri);
        builder.wait();  // its thread may still be in `done`
    }
    EXPECT_EQ(builds, 2);
}

TEST(EngineBuilder, ACancelledBuildEndsWithoutAResult) {
    std::promise<void> begun;
    bool done = false;
    EngineBuilder builder(
        [&](const Config&, const EngineBuilder::Progress& progress) -> std::shared_ptr<Engine> {
            begun.set_value();
            for (;;) {
                progress(0, 1);
            }
        },
        [&] { done = true; });
    builder.build(BuildReason::start, config_of("endless"));
    begun.get_future().wait();
    builder.cancel();
    builder.wait();
    EXPECT_FALSE(builder.take());
    EXPECT_FALSE(done);
}

}  // namespace
}  // namespace disparityd::daemon
