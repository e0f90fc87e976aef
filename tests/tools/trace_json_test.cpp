// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/trace_json.h"

#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace disparityd::tools {
namespace {

using ::testing::ElementsAre;

void add_event(v1::TraceTrack& track, v1::TraceKind kind, std::uint32_t name, std::int64_t begin_ns,
               std::uint64_t duration_ns, std::uint64_t frame) {
    v1::TraceEvent& event = *track.add_events();
    event.set_kind(kind);
    event.set_name(name);
    event.set_begin_ns(begin_ns);
    event.set_duration_ns(duration_ns);
    event.set_frame(frame);
}

/// Returns two stages, of which one has two steps, and a worker. The track of "match" comes in two pieces.
v1::Trace small_trace() {
    v1::Trace trace;
    trace.set_duration_ns(10'000'000);
    for (const char* name : {"", "capture", "match", "dsi", "wta"}) {
        trace.add_names(name);
    }
    v1::TraceTrack& worker = *trace.add_tracks();
    worker.set_name("worker 1");
    add_event(worker, v1::TRACE_HELP, 2, 3'100'000, 200'000, 17);
    add_event(worker, v1::TRACE_AWAKE, 0, 3'300'000, 50'000, 0);
    v1::TraceTrack& capture = *trace.add_tracks();
    capture.set_name("capture");
    add_event(capture, v1::TRACE_WAIT_SOURCE, 1, 0, 1'000'001, 0);
    add_event(capture, v1::TRACE_WORK, 1, 1'000'002, 998, 17);
    v1::TraceTrack& match = *trace.add_tracks();
    match.set_name("match");
    match.set_dropped(3);
    add_event(match, v1::TRACE_QUEUED, 2, 1'001'000, 2'000'000, 17);
    add_event(match, v1::TRACE_STEP, 3, 3'001'000, 500'000, 17);
    v1::TraceTrack& more = *trace.add_tracks();
    more.set_name("match");
    add_event(more, v1::TRACE_STEP, 4, 3'501'000, 400'000, 17);
    add_event(more, v1::TRACE_WORK, 2, 3'001'000, 1'000'000, 17);
    return trace;
}

nlohmann::json written(const v1::Trace& trace, std::uint64_t* events = nullptr) {
    std::ostringstream out;
    const std::uint64_t count = write_trace_json(out, trace);
    if (events != nullptr) {
        *events = count;
    }
    return nlohmann::json::parse(out.str())["traceEvents"];
}

/// Returns the names of events with this phase, in order.
std::vector<std::string> names_with(const nlohmann::json& events, const std::string& phase) {
    std::vector<std::string> names;
    for (const nlohmann::json& event : events) {
        if (event["ph"] == phase) {
            names.push_back(event["name"]);
        }
    }
    return names;
}

TEST(TraceJson, HasARowForEachThreadStagesFirst) {
    std::map<int, std::string> rows;
    for (const nlohmann::json& event : written(small_trace())) {
        if (event["name"] == "thread_name") {
            rows[event["tid"]] = event["args"]["name"];
        }
    }
    EXPECT_THAT(rows, ElementsAre(std::pair(1, "capture"), std::pair(2, "match"), std::pair(3, "worker 1")));
}

TEST(TraceJson, HasEachEventTheOuterOneFirst) {
    std::uint64_t count = 0;
    const nlohmann::json events = written(small_trace(), &count);
    EXPECT_EQ(count, 8U);
    EXPECT_THAT(names_with(events, "X"),
                ElementsAre("wait: source", "capture", "match", "dsi", "wta", "help: match", "awake, no task"));
}

TEST(TraceJson, TimesAreMicrosecondsToTheNanosecond) {
    std::ostringstream out;
    write_trace_json(out, small_trace());
    EXPECT_THAT(out.str(), testing::HasSubstr(R"("ts":1000.002,"dur":0.998,"pid":1,"tid":1)"));
    EXPECT_THAT(out.str(), testing::HasSubstr(R"("ts":0.000,"dur":1000.001,"pid":1,"tid":1)"));
}

TEST(TraceJson, QueuesAreNoPartOfAThread) {
    const nlohmann::json events = written(small_trace());
    EXPECT_THAT(names_with(events, "b"), ElementsAre("queue: match"));
    EXPECT_THAT(names_with(events, "e"), ElementsAre("queue: match"));
    for (const nlohmann::json& event : events) {
        if (event["ph"] == "b" || event["ph"] == "e") {
            EXPECT_EQ(event["id"], "queue: match 17");
            EXPECT_EQ(event["ts"], event["ph"] == "b" ? 1001.0 : 3001.0);
        }
    }
}

TEST(TraceJson, ArrowsFollowAFrame) {
    std::vector<std::pair<std::string, int>> way;
    for (const nlohmann::json& event : written(small_trace())) {
        if (event.value("cat", "") == "frame") {
            EXPECT_EQ(event["id"], 17);
            way.emplace_back(event["ph"], event["tid"]);
        }
    }
    EXPECT_THAT(way, ElementsAre(std::pair("s", 1), std::pair("f", 2)));
}

TEST(TraceJson, IsValidWhateverTheDaemonSends) {
    v1::Trace trace = small_trace();
    trace.set_names(2, "\"\\\n{");
    trace.mutable_tracks(0)->set_name("\",\"x\":[");
    constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
    constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
    v1::TraceTrack& track = *trace.mutable_tracks(0);
    const std::uint64_t sound = 8;
    add_event(track, v1::TRACE_WORK, 1, least, 5, 0);
    add_event(track, v1::TRACE_WORK, 1, most, 5, 0);
    add_event(track, v1::TRACE_WORK, 1, 5, std::numeric_limits<std::uint64_t>::max(), 0);
    add_event(track, static_cast<v1::TraceKind>(77), 4'000'000'000U, 5, 5, 0);
    std::uint64_t count = 0;
    const nlohmann::json events = written(trace, &count);
    EXPECT_EQ(count, sound + 1) << "what lies outside the trace's time is left out";
    EXPECT_THAT(names_with(events, "X"), testing::Contains("\"\\\n{"));
}

TEST(TraceJson, AnEmptyTraceIsValid) {
    EXPECT_TRUE(names_with(written({}), "X").empty());
}

TEST(TraceJson, CountsLostEvents) {
    EXPECT_EQ(dropped_events(small_trace()), 3U);
}

}  // namespace
}  // namespace disparityd::tools
