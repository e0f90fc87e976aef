// SPDX-License-Identifier: Apache-2.0
//
// The counts of Status.totals go on when a new configuration or another client comes: a monitor must see none fall.
#include <algorithm>
#include <csignal>
#include <map>

#include <gmock/gmock.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Key;

/// Returns every count by its name.
std::map<std::string, std::uint64_t> counts(const v1::Totals& totals) {
    std::map<std::string, std::uint64_t> found{
        {"captured", totals.captured()},         {"published", totals.published()},
        {"dropped", totals.dropped()},           {"lost", totals.lost()},
        {"damaged", totals.damaged()},           {"clients", totals.clients()},
        {"frames", totals.client_frames_sent()}, {"skipped", totals.client_frames_skipped()},
        {"bytes", totals.client_bytes_sent()}};
    for (const v1::StepTotal& step : totals.steps()) {
        found[step.name()] = step.count();
        found[step.name() + " ns"] = step.sum_ns();
        for (int i = 0; i < step.up_to_size(); ++i) {
            found[step.name() + " " + std::to_string(totals.bounds_us(i))] = step.up_to(i);
        }
    }
    return found;
}

void expect_none_fell(const v1::Totals& before, const v1::Totals& after) {
    const auto now = counts(after);
    for (const auto& [name, count] : counts(before)) {
        ASSERT_THAT(now, Contains(Key(name)));
        EXPECT_GE(now.at(name), count) << name;
    }
}

void expect_histograms(const v1::Totals& totals) {
    ASSERT_GT(totals.steps_size(), 3);
    for (const v1::StepTotal& step : totals.steps()) {
        SCOPED_TRACE(step.name());
        ASSERT_EQ(step.up_to_size(), totals.bounds_us_size());
        EXPECT_TRUE(std::is_sorted(step.up_to().begin(), step.up_to().end()));
        EXPECT_LE(*step.up_to().rbegin(), step.count());
    }
}

class TotalsTest : public DaemonTest {
protected:
    /// Returns the status after `frames` more frames.
    static v1::Status status_after(WireClient& client, int frames) {
        for (int i = 0; i < frames; ++i) {
            EXPECT_TRUE(client.receive_frame());
        }
        return status(client);
    }
};

TEST_F(TotalsTest, BoundsAreASeriesFromATenthOfAMillisecondToASecond) {
    const auto daemon = start_ready(config_text());
    WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY});
    EXPECT_THAT(status_after(client, 1).totals().bounds_us(),
                ElementsAre(100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000, 100000, 200000, 500000, 1000000));
}

TEST_F(TotalsTest, AgreeWithTheStepTimesOfTheFirstConfiguration) {
    const auto daemon = start_ready(config_text("scene:vga@1000?width=320&height=176&loop=8"));
    WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY});
    const v1::Status now = status_after(client, 20);
    expect_histograms(now.totals());
    EXPECT_EQ(now.totals().captured(), now.captured());
    EXPECT_EQ(now.totals().published(), now.published());
    // Frames go on between the readings: what is read later is no less, but for the one that is being recorded.
    const v1::Status later = status(client);
    ASSERT_EQ(now.totals().steps_size(), now.steps_size());
    for (int i = 0; i < now.steps_size(); ++i) {
        const v1::StepTotal& total = now.totals().steps(i);
        SCOPED_TRACE(total.name());
        EXPECT_EQ(total.name(), now.steps(i).name());
        EXPECT_GE(total.count() + 1, now.steps(i).count());
        EXPECT_LE(total.count(), later.steps(i).count());
        const auto sum_ns = [i](const v1::Status& of) {
            constexpr double ns_of_us = 1000;
            return of.steps(i).mean_us() * ns_of_us * static_cast<double>(of.steps(i).count());
        };
        constexpr double rounding_ns = 1;
        EXPECT_GE(static_cast<double>(total.sum_ns()), sum_ns(now) - rounding_ns);
        EXPECT_LE(static_cast<double>(total.sum_ns()), sum_ns(later) + rounding_ns);
    }
}

TEST_F(TotalsTest, GoOnThroughAReloadAndKeepStepsThatAreNoLongerMade) {
    const auto daemon = start_ready(config_text(scene, 160, 88, "[scan]\nenabled = true\n"));
    WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY});
    const v1::Status before = status_after(client, 5);
    EXPECT_THAT(counts(before.totals()), Contains(Key("scan")));

    folder_.write("d.toml", config_text(scene, 96, 64));
    daemon->send_signal(SIGHUP);
    v1::Status after = status(client);
    while (after.geometry().width() != 96) {
        ASSERT_TRUE(client.receive_frame());
        after = status(client);
        expect_none_fell(before.totals(), after.totals());
    }
    after = status_after(client, 1);
    expect_none_fell(before.totals(), after.totals());
    expect_histograms(after.totals());
    EXPECT_LT(after.steps_size(), before.steps_size()) << "the new configuration has no scans";
    EXPECT_GE(after.totals().captured(), before.totals().captured() + after.captured());
    EXPECT_GT(after.totals().published(), after.published());
}

TEST_F(TotalsTest, GoOnWhenAClientLeaves) {
    const auto daemon = start_ready(config_text());
    WireClient observer(daemon->address("unix:"));
    observer.hello();
    v1::Status before;
    {
        WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY});
        status_after(client, 3);
        before = status(observer);
    }
    EXPECT_EQ(before.totals().clients(), 2U);
    EXPECT_GE(before.totals().client_frames_sent(), 3U);
    v1::Status after = status(observer);
    while (after.clients_size() > 1) {
        after = status(observer);
    }
    expect_none_fell(before.totals(), after.totals());
    EXPECT_EQ(after.totals().clients(), 2U);
}

}  // namespace
}  // namespace disparityd::test
