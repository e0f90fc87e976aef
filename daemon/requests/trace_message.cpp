// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/trace_message.h"

#include <algorithm>

#include "proto/framing.h"

namespace disparityd::daemon {
namespace {

/// An event takes at most 45 bytes with its tags and lengths, so a part has room for its names, too.
constexpr std::size_t events_in_a_part = 16'384;
constexpr std::size_t bytes_of_an_event = 45;
static_assert(events_in_a_part * bytes_of_an_event < proto::max_envelope_bytes * 3 / 4);

v1::TraceKind to_message(pipeline::TraceKind kind) {
    using pipeline::TraceKind;
    switch (kind) {
        case TraceKind::work: return v1::TRACE_WORK;
        case TraceKind::step: return v1::TRACE_STEP;
        case TraceKind::help: return v1::TRACE_HELP;
        case TraceKind::awake: return v1::TRACE_AWAKE;
        case TraceKind::wait_source: return v1::TRACE_WAIT_SOURCE;
        case TraceKind::wait_frame: return v1::TRACE_WAIT_FRAME;
        case TraceKind::wait_room: return v1::TRACE_WAIT_ROOM;
        case TraceKind::wait_slot: return v1::TRACE_WAIT_SLOT;
        case TraceKind::queued: return v1::TRACE_QUEUED;
    }
    return v1::TRACE_NONE;
}

void put(v1::TraceEvent& message, const pipeline::TraceEvent& event, std::int64_t begin_ns) {
    message.set_kind(to_message(event.kind));
    message.set_name(event.name);
    message.set_begin_ns(event.begin_ns - begin_ns);
    message.set_duration_ns(static_cast<std::uint64_t>(event.end_ns - event.begin_ns));
    message.set_frame(event.frame);
}

}  // namespace

std::vector<v1::Trace> to_messages(const pipeline::TraceLog& log) {
    std::vector<v1::Trace> parts(1);
    std::size_t room = events_in_a_part;
    for (const pipeline::TraceLog::Track& track : log.tracks) {
        std::size_t next = 0;
        do {
            if (room == 0) {
                parts.emplace_back();
                room = events_in_a_part;
            }
            v1::TraceTrack& piece = *parts.back().add_tracks();
            piece.set_name(track.name);
            const std::size_t end = std::min(track.events.size(), next + room);
            room -= end - next;
            for (; next < end; ++next) {
                put(*piece.add_events(), track.events[next], log.begin_ns);
            }
            piece.set_dropped(next == track.events.size() ? track.dropped : 0);
        } while (next < track.events.size());
    }
    v1::Trace& last = parts.back();
    last.set_last(true);
    last.set_begin_ns(log.begin_ns);
    last.set_duration_ns(static_cast<std::uint64_t>(log.end_ns - log.begin_ns));
    for (const std::string& name : log.names) {
        last.add_names(name);
    }
    return parts;
}

}  // namespace disparityd::daemon
