// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/metrics/prometheus_text.h"

#include <array>
#include <fstream>
#include <limits>
#include <set>
#include <span>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/bridges/metrics/filled_status.h"

namespace disparityd::web {
namespace {

using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        lines.push_back(line);
    }
    return lines;
}

std::vector<std::string> lines_of(const v1::Status& status) {
    return lines_of(prometheus_text(&status, test::web_counters()));
}

/// Returns the lines of the file of expected metrics, without the line of its licence.
std::vector<std::string> expected_lines() {
    std::ifstream file(DISPARITYD_FILLED_METRICS);
    std::stringstream text;
    text << file.rdbuf();
    std::vector<std::string> lines = lines_of(text.str());
    if (!lines.empty()) {
        lines.erase(lines.begin());
    }
    return lines;
}

// The file has what a metric looks like, of each kind. monitoring.documents compares all with docs/monitoring.md.
TEST(PrometheusText, OfAFilledStatus) {
    EXPECT_THAT(lines_of(test::filled_status()), IsSupersetOf(expected_lines()));
}

TEST(PrometheusText, EndsWithALineEnd) {
    const v1::Status status = test::filled_status();
    EXPECT_THAT(prometheus_text(&status, {}), EndsWith(" 0\n"));
}

TEST(PrometheusText, OfADaemonThatIsAway) {
    EXPECT_EQ(prometheus_text(nullptr, test::web_counters()),
              "# HELP disparityd_up Whether the daemon answers.\n"
              "# TYPE disparityd_up gauge\n"
              "disparityd_up 0\n"
              "# HELP disparity_web_clients Pages and viewers that this server sends frames to.\n"
              "# TYPE disparity_web_clients gauge\n"
              "disparity_web_clients 2\n"
              "# HELP disparity_web_sent_bytes_total Bytes that this server has sent.\n"
              "# TYPE disparity_web_sent_bytes_total counter\n"
              "disparity_web_sent_bytes_total 3\n"
              "# HELP disparity_web_frames_sent_total Frames that this server has sent to all its clients together.\n"
              "# TYPE disparity_web_frames_sent_total counter\n"
              "disparity_web_frames_sent_total 4\n"
              "# HELP disparity_web_frames_skipped_total Frames that this server has not sent to a client: too slow, "
              "or it wanted fewer.\n"
              "# TYPE disparity_web_frames_skipped_total counter\n"
              "disparity_web_frames_skipped_total 5\n"
              "# HELP disparity_web_requests_total HTTP requests to this server.\n"
              "# TYPE disparity_web_requests_total counter\n"
              "disparity_web_requests_total 6\n"
              "# HELP disparity_web_requests_refused_total HTTP requests that this server answered by an error.\n"
              "# TYPE disparity_web_requests_refused_total counter\n"
              "disparity_web_requests_refused_total 1\n");
}

TEST(PrometheusText, EscapesWhatOthersChoose) {
    const std::vector<std::string> lines = lines_of(test::hostile_status());
    EXPECT_THAT(lines, Contains(R"(disparityd_build_info{version="1\"} 5\ndisparityd_up 7"} 1)"));
    EXPECT_THAT(lines, Contains(R"(disparityd_pipeline_info{source="back\\slash, \"quote\", two\nlines, ??? and ?",)"
                                R"(method="?? half a character ?",backend="café"} 1)"));
    EXPECT_THAT(lines, Contains(R"(disparityd_camera_info{model="{}#",serial="12345",firmware="1523",port="2-1"} 1)"));
    EXPECT_THAT(lines, Contains(R"(disparityd_step_seconds_bucket{step="\",le=\"0\\",le="0.0001"} 7)"));
    EXPECT_EQ(lines.size(), lines_of(test::filled_status()).size()) << "no text has made a line of its own";
}

TEST(PrometheusText, AStateThatItDoesNotKnowIsAnotherOne) {
    const std::vector<std::string> lines = lines_of(test::hostile_status());
    EXPECT_THAT(lines, Contains(R"(disparityd_state{state="running"} 0)"));
    EXPECT_THAT(lines, Contains(R"(disparityd_state{state="other"} 1)"));
    EXPECT_THAT(lines, Contains(R"(disparityd_camera_state{state="other"} 1)"));
}

TEST(PrometheusText, OfADaemonWithoutASourceYet) {
    const std::vector<std::string> lines = lines_of(test::starting_status());
    EXPECT_THAT(lines, Contains("disparityd_up 1"));
    EXPECT_THAT(lines, Contains(R"(disparityd_state{state="waiting"} 1)"));
    EXPECT_THAT(lines, Contains("disparityd_frames_captured_total 0"));
    for (const char* absent : {"_seconds_bucket", "disparityd_camera", "disparityd_sensors", "disparityd_self_cal"}) {
        EXPECT_THAT(lines, Not(Contains(HasSubstr(absent))));
    }
}

TEST(PrometheusText, NamesOfClientsAndNoticesMakeNoSeries) {
    v1::Status status = test::filled_status();
    const std::size_t before = lines_of(status).size();
    for (int i = 0; i < 100; ++i) {
        status.add_clients()->set_name("client " + std::to_string(i));
        status.add_notices("notice " + std::to_string(i));
    }
    EXPECT_EQ(lines_of(status).size(), before);
}

TEST(PrometheusText, WhatWasNotMeasuredHasNoSample) {
    v1::Status status = test::filled_status();
    status.mutable_self_calibration()->set_error_after_px(0);
    const std::vector<std::string> lines = lines_of(status);
    EXPECT_THAT(lines, Contains(R"(disparityd_self_calibration_error_pixels{calibration="factory"} 0.75)"));
    EXPECT_THAT(lines, Not(Contains(HasSubstr(R"({calibration="corrected"})"))));
    status.mutable_self_calibration()->set_error_before_px(0);
    EXPECT_THAT(lines_of(status), Not(Contains(HasSubstr("error_pixels"))));
}

TEST(PrometheusText, NumbersThatAreNone) {
    v1::Status status = test::filled_status();
    status.set_rate(std::numeric_limits<double>::quiet_NaN());
    status.set_uptime_s(std::numeric_limits<double>::infinity());
    status.mutable_camera()->set_rate(-std::numeric_limits<double>::infinity());
    const std::vector<std::string> lines = lines_of(status);
    EXPECT_THAT(lines, Contains("disparityd_frame_rate_hertz NaN"));
    EXPECT_THAT(lines, Contains("disparityd_uptime_seconds +Inf"));
    EXPECT_THAT(lines, Contains("disparityd_camera_rate_hertz -Inf"));
}

TEST(PrometheusText, SeveralDaemonsHaveEachMetricOnceAndTheirNamesAsALabel) {
    const v1::Status status = test::filled_status();
    const std::array daemons{NamedStatus{"away", nullptr}, NamedStatus{"front", &status}, NamedStatus{"a\"b", &status}};
    const std::vector<std::string> lines = lines_of(prometheus_text(daemons, test::web_counters()));
    EXPECT_THAT(lines, IsSupersetOf({
                           R"(disparityd_up{camera="away"} 0)",
                           R"(disparityd_up{camera="front"} 1)",
                           R"(disparityd_up{camera="a\"b"} 1)",
                           R"(disparityd_state{camera="front",state="running"} 1)",
                           R"(disparityd_step_seconds_bucket{camera="front",step="capture",le="0.02"} 9)",
                           "disparity_web_clients 2",
                       }));
    std::set<std::string> begun;
    std::string metric;
    for (const std::string& line : lines) {
        if (line.rfind("# TYPE ", 0) == 0) {
            metric = line.substr(7, line.find(' ', 7) - 7);
            EXPECT_TRUE(begun.insert(metric).second) << metric << " is begun twice";
        } else if (line.rfind("# ", 0) != 0) {
            EXPECT_EQ(line.rfind(metric, 0), 0U) << line << " stands under " << metric;
            EXPECT_EQ(line.find("{camera=") != std::string::npos, line.rfind("disparityd_", 0) == 0) << line;
        }
    }
    EXPECT_EQ(lines_of(prometheus_text(std::span<const NamedStatus>(), {})).size(), 18U) << "only the server's own";
}

TEST(PrometheusText, ARecordingThatFailed) {
    v1::Status status = test::filled_status();
    status.mutable_record()->set_active(false);
    status.mutable_record()->set_error("the disk is full");
    const std::vector<std::string> lines = lines_of(status);
    EXPECT_THAT(lines, Contains("disparityd_recording_active 0"));
    EXPECT_THAT(lines, Contains("disparityd_recording_failed 1"));
}

}  // namespace
}  // namespace disparityd::web
