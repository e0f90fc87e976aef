// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/trace_json.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace disparityd::tools {
namespace {

/// An event and the row where it is drawn.
struct Placed {
    const v1::TraceEvent* event;
    int row;
};

std::string json_text(std::string_view text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Returns nanoseconds as microseconds, the unit of the format, without rounding.
std::string micros(std::int64_t ns) {
    constexpr std::int64_t ns_of_us = 1000;
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%lld.%03d", static_cast<long long>(ns / ns_of_us),
                  static_cast<int>(ns % ns_of_us));
    return text.data();
}

std::int64_t end_of(const v1::TraceEvent& event) {
    return event.begin_ns() + static_cast<std::int64_t>(event.duration_ns());
}

/// Returns whether the event lies within the time of the trace; other numbers are no times.
bool is_sound(const v1::TraceEvent& event, const v1::Trace& trace) {
    return event.begin_ns() >= 0 && event.duration_ns() <= trace.duration_ns() &&
           static_cast<std::uint64_t>(event.begin_ns()) <= trace.duration_ns() - event.duration_ns();
}

const char* category(v1::TraceKind kind) {
    switch (kind) {
        case v1::TRACE_WORK: return "stage";
        case v1::TRACE_STEP: return "step";
        case v1::TRACE_HELP:
        case v1::TRACE_AWAKE: return "worker";
        case v1::TRACE_QUEUED: return "queue";
        default: return "wait";
    }
}

class TraceWriter {
public:
    TraceWriter(std::ostream& out, const v1::Trace& trace) : out_(out), trace_(trace) {}

    std::uint64_t write() {
        place();
        out_ << "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n";
        begin() << R"("ph":"M","pid":1,"name":"process_name","args":{"name":"disparityd"}})";
        put_rows();
        for (const Placed& placed : placed_) {
            put(placed);
        }
        put_flows();
        out_ << "\n]}\n";
        return placed_.size();
    }

private:
    /// Gives each thread a row, in the order in which the daemon names them, the workers after the stages; sorts the
    /// events so that one comes before those inside of it.
    void place() {
        std::map<std::string, int> rows;
        for (const bool workers : {false, true}) {
            for (const v1::TraceTrack& track : trace_.tracks()) {
                if (track.name().starts_with("worker ") == workers && rows.try_emplace(track.name(), 0).second) {
                    threads_.push_back(track.name());
                    rows[track.name()] = static_cast<int>(threads_.size());
                }
            }
        }
        for (const v1::TraceTrack& track : trace_.tracks()) {
            for (const v1::TraceEvent& event : track.events()) {
                if (is_sound(event, trace_)) {
                    placed_.push_back({&event, rows[track.name()]});
                }
            }
        }
        std::stable_sort(placed_.begin(), placed_.end(), [](const Placed& a, const Placed& b) {
            return std::tuple(a.row, a.event->begin_ns(), b.event->duration_ns(), a.event->kind()) <
                   std::tuple(b.row, b.event->begin_ns(), a.event->duration_ns(), b.event->kind());
        });
    }

    std::ostream& begin() {
        out_ << (std::exchange(first_, false) ? "{" : ",\n{");
        return out_;
    }

    void put_rows() {
        for (std::size_t i = 0; i < threads_.size(); ++i) {
            const std::string row = R"("pid":1,"tid":)" + std::to_string(i + 1);
            begin() << R"("ph":"M",)" << row << R"(,"name":"thread_name","args":{"name":)" << json_text(threads_[i])
                    << "}}";
            begin() << R"("ph":"M",)" << row << R"(,"name":"thread_sort_index","args":{"sort_index":)" << i << "}}";
        }
    }

    std::string name_of(const v1::TraceEvent& event) const {
        const std::string name = event.name() < static_cast<std::uint32_t>(trace_.names_size())
                                     ? trace_.names(static_cast<int>(event.name()))
                                     : std::string();
        switch (event.kind()) {
            case v1::TRACE_HELP: return "help: " + (name.empty() ? "another thread" : name);
            case v1::TRACE_AWAKE: return "awake, no task";
            case v1::TRACE_WAIT_SOURCE: return "wait: source";
            case v1::TRACE_WAIT_FRAME: return "wait: frame";
            case v1::TRACE_WAIT_ROOM: return "wait: room";
            case v1::TRACE_WAIT_SLOT: return "wait: compute slot";
            case v1::TRACE_QUEUED: return "queue: " + name;
            default: return name;
        }
    }

    void put(const Placed& placed) {
        const v1::TraceEvent& event = *placed.event;
        const std::string name = json_text(name_of(event));
        const std::string common = R"("pid":1,"tid":)" + std::to_string(placed.row) + R"(,"cat":")" +
                                   category(event.kind()) + R"(","name":)" + name;
        const std::string frame = R"("args":{"frame":)" + std::to_string(event.frame()) + "}";
        if (event.kind() == v1::TRACE_QUEUED) {
            // Frames in a queue overlap, so they are no parts of a thread's row.
            const std::string id = R"(,"id":)" + json_text(name_of(event) + " " + std::to_string(event.frame()));
            begin() << R"("ph":"b","ts":)" << micros(event.begin_ns()) << "," << common << id << "," << frame << "}";
            begin() << R"("ph":"e","ts":)" << micros(end_of(event)) << "," << common << id << "}";
        } else {
            begin() << R"("ph":"X","ts":)" << micros(event.begin_ns()) << R"(,"dur":)"
                    << micros(static_cast<std::int64_t>(event.duration_ns())) << "," << common << "," << frame << "}";
            if (event.kind() == v1::TRACE_WORK) {
                ways_[event.frame()].push_back(placed);
            }
        }
    }

    /// Draws each frame's way through the stages.
    void put_flows() {
        for (auto& [frame, way] : ways_) {
            std::stable_sort(way.begin(), way.end(), [](const Placed& a, const Placed& b) {
                return a.event->begin_ns() < b.event->begin_ns();
            });
            for (std::size_t i = 0; way.size() > 1 && i < way.size(); ++i) {
                const char* phase = i == 0 ? R"("s")" : i + 1 < way.size() ? R"("t")" : R"("f","bp":"e")";
                begin() << R"("ph":)" << phase << R"(,"ts":)" << micros(way[i].event->begin_ns())
                        << R"(,"pid":1,"tid":)" << way[i].row << R"(,"cat":"frame","name":"frame","id":)" << frame
                        << "}";
            }
        }
    }

    std::ostream& out_;
    const v1::Trace& trace_;
    bool first_ = true;
    std::vector<std::string> threads_;
    std::vector<Placed> placed_;
    std::map<std::uint64_t, std::vector<Placed>> ways_;
};

}  // namespace

std::uint64_t write_trace_json(std::ostream& out, const v1::Trace& trace) {
    return TraceWriter(out, trace).write();
}

std::uint64_t dropped_events(const v1::Trace& trace) {
    std::uint64_t dropped = 0;
    for (const v1::TraceTrack& track : trace.tracks()) {
        dropped += track.dropped();
    }
    return dropped;
}

}  // namespace disparityd::tools
