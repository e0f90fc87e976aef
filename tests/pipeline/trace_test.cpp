// SPDX-License-Identifier: Apache-2.0
#include "pipeline/trace.h"

#include <algorithm>
#include <map>
#include <set>
#include <thread>

#include <gmock/gmock.h>

#include "pipeline/pipeline.h"
#include "tests/pipeline/fakes.h"

namespace disparityd::pipeline {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr auto longest_wait = 60s;

const TraceLog::Track& track_of(const TraceLog& log, const std::string& name) {
    return *std::find_if(log.tracks.begin(), log.tracks.end(), [&](const auto& track) { return track.name == name; });
}

TEST(Tracer, RecordsOnlyWhileItIsOn) {
    Tracer tracer;
    TraceTrack track(tracer, "thread");
    const auto record = [&](std::uint64_t frame) {
        const TraceSpan span(track, TraceKind::work, tracer.index_of("match"), frame);
    };
    record(1);
    tracer.begin();
    record(2);
    record(3);
    const TraceLog log = tracer.end();
    record(4);
    ASSERT_THAT(log.tracks, SizeIs(1));
    EXPECT_EQ(log.tracks[0].name, "thread");
    ASSERT_THAT(log.tracks[0].events, SizeIs(2));
    EXPECT_EQ(log.tracks[0].events[0].frame, 2U);
    EXPECT_EQ(log.names[log.tracks[0].events[0].name], "match");
    EXPECT_LE(log.begin_ns, log.tracks[0].events[0].begin_ns);
    EXPECT_LE(log.tracks[0].events[1].end_ns, log.end_ns);
    tracer.begin();
    EXPECT_THAT(tracer.end().tracks[0].events, IsEmpty()) << "the second trace has nothing of the first";
}

TEST(Tracer, LeavesOutWhatBeganBeforeOrEndsAfter) {
    Tracer tracer;
    TraceTrack track(tracer, "thread");
    {
        const TraceSpan began_before(track, TraceKind::work, 0);
        tracer.begin();
    }
    {
        const TraceSpan ends_after(track, TraceKind::work, 0);
        EXPECT_THAT(tracer.end().tracks[0].events, IsEmpty());
    }
    tracer.begin();
    track.add({1, TraceSpan::now_ns(), 0, 0, TraceKind::queued});
    EXPECT_THAT(tracer.end().tracks[0].events, IsEmpty()) << "in a queue since before the trace";
}

TEST(Tracer, CountsWhatItHasNoRoomFor) {
    Tracer tracer;
    TraceTrack track(tracer, "thread");
    TraceTrack other(tracer, "other");
    tracer.begin();
    for (std::size_t i = 0; i < Tracer::most_events / 2 + 5; ++i) {
        const TraceSpan span(track, TraceKind::work, 0);
    }
    const TraceLog log = tracer.end();
    EXPECT_THAT(log.tracks[0].events, SizeIs(Tracer::most_events / 2));
    EXPECT_EQ(log.tracks[0].dropped, 5U);
    EXPECT_EQ(log.tracks[1].dropped, 0U);
}

TEST(Tracer, OneTraceAtATime) {
    Tracer tracer;
    EXPECT_THROW(tracer.end(), std::logic_error);
    tracer.begin();
    EXPECT_THROW(tracer.begin(), std::logic_error);
    EXPECT_THAT(tracer.end().tracks, IsEmpty());
}

TEST(Tracer, AThreadThatHasGoneHasNoTrack) {
    Tracer tracer;
    { TraceTrack track(tracer, "gone"); }
    tracer.begin();
    EXPECT_THAT(tracer.end().tracks, IsEmpty());
}

// For the thread sanitizer: traces begin and end while a thread writes.
TEST(Tracer, BeginsAndEndsBesideAThreadThatWrites) {
    Tracer tracer;
    TraceTrack track(tracer, "thread");
    std::atomic<bool> done{false};
    std::thread writer([&] {
        for (std::uint64_t frame = 1; !done; ++frame) {
            const TraceSpan span(track, TraceKind::work, 0, frame);
        }
    });
    for (std::uint64_t last = 0, traces = 0; traces < 100; ++traces) {
        tracer.begin();
        std::this_thread::yield();
        const TraceLog log = tracer.end();
        for (const TraceEvent& event : log.tracks[0].events) {
            ASSERT_GT(event.frame, last);
            last = event.frame;
        }
    }
    done = true;
    writer.join();
}

/// A pipeline over frames of the test, traced from the first to the last one.
struct TracedRun {
    explicit TracedRun(Policy policy = Policy::replay, bool traced = true, int workers_count = 2) {
        fakes::Source source(frames);
        fakes::Matcher matcher([](int, const FrameView&) {
            // The matcher says that each of its steps takes 5 us: the stage takes as long as two of them.
            const auto begin = std::chrono::steady_clock::now();
            while (std::chrono::steady_clock::now() < begin + 10us) {
            }
        });
        const calibration::Rectification rectification = fakes::rectification();
        WorkerPool workers(workers_count);
        Pipeline pipeline({.policy = policy, .slots = 3}, source, matcher, workers, rectification,
                          [this](const FrameSlot& slot) {
                              published.push_back({slot.raw.sequence, slot.view.disparity.at(0, 0)});
                              for (std::size_t i = 1; i < slot.step_times.size(); ++i) {
                                  if (pipeline_steps[i].rfind("wait-", 0) != 0) {
                                      step_ns[pipeline_steps[i]] += slot.step_times[i].count();
                                  }
                              }
                          });
        pipeline_steps = pipeline.steps();
        for (const StageInfo& stage : matcher.stages()) {
            stages.emplace_back(to_string(stage.kind));
        }
        if (traced) {
            workers.tracer().begin();
        }
        pipeline.start();
        ended = pipeline.wait_until_ended(longest_wait);
        pipeline.stop();
        status = pipeline.status();
        if (traced) {
            log = workers.tracer().end();
        }
    }

    static constexpr int frames = 50;
    std::vector<std::pair<std::uint64_t, int>> published;
    std::map<std::string, std::int64_t> step_ns;
    std::vector<std::string> pipeline_steps;
    std::vector<std::string> stages;
    PipelineStatus status;
    TraceLog log;
    bool ended = false;
};

TEST(PipelineTrace, HasEveryStageOfEveryFrame) {
    const TracedRun run;
    ASSERT_TRUE(run.ended);
    std::vector<std::string> threads{"capture"};
    threads.insert(threads.end(), run.stages.begin(), run.stages.end());
    threads.emplace_back("publish");
    for (const std::string& thread : threads) {
        SCOPED_TRACE(thread);
        std::map<TraceKind, std::set<std::uint64_t>> seen;
        for (const TraceEvent& event : track_of(run.log, thread).events) {
            seen[event.kind].insert(event.frame);
            if (event.kind == TraceKind::work) {
                EXPECT_EQ(run.log.names[event.name], thread);
            }
        }
        EXPECT_THAT(seen[TraceKind::work], SizeIs(TracedRun::frames));
        if (thread != "capture") {
            EXPECT_THAT(seen[TraceKind::queued], SizeIs(TracedRun::frames));
            EXPECT_FALSE(seen[TraceKind::wait_frame].empty());
        }
    }
}

TEST(PipelineTrace, StepsAreWhatTheStatusCounts) {
    const TracedRun run;
    std::map<std::string, std::int64_t> traced_ns;
    for (const auto& track : run.log.tracks) {
        for (const TraceEvent& event : track.events) {
            if (event.kind == TraceKind::step) {
                traced_ns[run.log.names[event.name]] += event.end_ns - event.begin_ns;
            }
        }
    }
    EXPECT_EQ(traced_ns, run.step_ns);
}

// A viewer draws what overlaps on a thread as if it were inside: it must be.
TEST(PipelineTrace, EventsOfAThreadLieInsideOrBesideEachOther) {
    for (const Policy policy : {Policy::replay, Policy::live}) {
        const TracedRun run(policy);
        for (const auto& track : run.log.tracks) {
            std::vector<TraceEvent> events;
            std::copy_if(track.events.begin(), track.events.end(), std::back_inserter(events),
                         [](const TraceEvent& event) { return event.kind != TraceKind::queued; });
            std::sort(events.begin(), events.end(), [](const TraceEvent& a, const TraceEvent& b) {
                return std::pair(a.begin_ns, -a.end_ns) < std::pair(b.begin_ns, -b.end_ns);
            });
            std::vector<std::int64_t> open;
            for (const TraceEvent& event : events) {
                ASSERT_LE(event.begin_ns, event.end_ns);
                while (!open.empty() && open.back() <= event.begin_ns) {
                    open.pop_back();
                }
                ASSERT_TRUE(open.empty() || event.end_ns <= open.back()) << track.name;
                open.push_back(event.end_ns);
            }
        }
    }
}

TEST(PipelineTrace, FramesAreTheSameWithAndWithout) {
    EXPECT_EQ(TracedRun(Policy::replay, true).published, TracedRun(Policy::replay, false).published);
}

TEST(PipelineTrace, WorkersSayWhomTheyHelp) {
    WorkerPool workers(2);
    const std::uint16_t name = workers.tracer().index_of("match");
    workers.tracer().begin();
    trace_work = {7, name};
    std::atomic<int> begun{0};
    {
        const WorkerPool::ComputeSlot slot(workers);
        workers.for_each(2, [&](int) {  // each task waits for the other one: the helper has one of them
            ++begun;
            while (begun < 2) {
                std::this_thread::yield();
            }
        });
    }
    trace_work = {};
    const TraceLog log = workers.tracer().end();
    const auto& events = track_of(log, "worker 1").events;
    const auto help = std::find_if(events.begin(), events.end(),
                                   [](const TraceEvent& event) { return event.kind == TraceKind::help; });
    ASSERT_NE(help, events.end());
    EXPECT_EQ(help->frame, 7U);
    EXPECT_EQ(log.names[help->name], "match");
}

}  // namespace
}  // namespace disparityd::pipeline
