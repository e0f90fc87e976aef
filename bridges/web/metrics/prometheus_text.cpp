// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/metrics/prometheus_text.h"

#include <array>
#include <string_view>
#include <vector>

#include "bridges/web/metrics/exposition.h"
#include "bridges/web/metrics/source_metrics.h"

namespace disparityd::web {
namespace {

using namespace std::string_view_literals;

constexpr std::array daemon_states{"running"sv, "waiting"sv, "ended"sv, "stopping"sv};

/// The step of StepTotal that is not a part of a frame's way but all of it.
constexpr std::string_view whole_way = "total";

void put_state(Exposition& out, const v1::Status& status) {
    out.info("disparityd_build_info", "Version of the daemon.", {{"version", status.server_version()}});
    out.gauge("disparityd_uptime_seconds", "Time since the start of the daemon.", status.uptime_s());
    out.states("disparityd_state", "State of the daemon, 1 for the one it is in.", daemon_states, status.state());
    out.info("disparityd_pipeline_info", "What the daemon computes, and where.",
             {{"source", status.source()}, {"method", status.method()}, {"backend", status.backend()}});
    out.gauge("disparityd_workers", "Threads that compute.", status.workers());
    out.gauge("disparityd_notices", "Things that a user should know; disparityctl status lists them.",
              status.notices_size());
    out.gauge("disparityd_synthetic", "Whether the frames are rendered, not from a camera.",
              status.synthetic() ? 1 : 0);
    out.gauge("disparityd_frame_rate_hertz", "Published frames per second over the last seconds.", status.rate());
}

void put_histogram(Exposition& out, Exposition::Labels labels, const v1::Totals& totals, const v1::StepTotal& step) {
    constexpr double us_of_s = 1e6;
    constexpr double ns_of_s = 1e9;
    std::vector<double> bounds;
    for (const std::uint32_t bound : totals.bounds_us()) {
        bounds.push_back(bound / us_of_s);
    }
    const std::vector<std::uint64_t> up_to(step.up_to().begin(), step.up_to().end());
    out.histogram(labels, bounds, up_to, step.count(), static_cast<double>(step.sum_ns()) / ns_of_s);
}

void put_steps(Exposition& out, const v1::Totals& totals) {
    if (totals.steps_size() == 0) {
        return;  // the daemon prepares its first source
    }
    out.begin("disparityd_step_seconds", "histogram", "Time that a frame takes in each step of the pipeline.");
    for (const v1::StepTotal& step : totals.steps()) {
        if (step.name() != whole_way) {
            put_histogram(out, {{"step", step.name()}}, totals, step);
        }
    }
    for (const v1::StepTotal& step : totals.steps()) {
        if (step.name() == whole_way) {
            out.begin("disparityd_frame_seconds", "histogram",
                      "Time from the capture of a frame until it is published.");
            put_histogram(out, {}, totals, step);
        }
    }
}

void put_totals(Exposition& out, const v1::Totals& totals) {
    out.counter("disparityd_frames_captured_total", "Frames taken from the source.", totals.captured());
    out.counter("disparityd_frames_published_total", "Frames that were finished and offered to clients.",
                totals.published());
    out.counter("disparityd_frames_dropped_total",
                "Frames that were captured and dropped for newer ones, or by a reload or a failure.", totals.dropped());
    out.counter("disparityd_frames_lost_total", "Frames that were lost before the daemon got them.",
                totals.lost_before());
    out.counter("disparityd_frames_corrupt_total", "Frames that came damaged and were not processed.",
                totals.corrupt());
    put_steps(out, totals);
}

void put_recording(Exposition& out, const v1::RecordStatus& record) {
    out.gauge("disparityd_recording_active", "Whether a recording runs.", record.active() ? 1 : 0);
    out.gauge("disparityd_recording_failed", "Whether the last recording ended before it was asked to.",
              record.error().empty() ? 0 : 1);
    // Gauges: they belong to one recording, and the next one starts at 0.
    out.gauge("disparityd_recording_frames", "Frames in the recording, the last one when none runs.",
              static_cast<double>(record.frames()));
    out.gauge("disparityd_recording_frames_lost", "Frames that the recording lacks: they came faster than it writes.",
              static_cast<double>(record.lost()));
    out.gauge("disparityd_recording_frames_lost_by_source", "Frames that the source lost during the recording.",
              static_cast<double>(record.source_lost()));
    out.gauge("disparityd_recording_bytes", "Size of the recording.", static_cast<double>(record.bytes()));
    out.gauge("disparityd_recording_seconds", "Length of the recording.", record.seconds());
}

void put_clients(Exposition& out, const v1::Status& status) {
    const v1::Totals& totals = status.totals();
    out.gauge("disparityd_clients", "Clients of the socket now.", status.clients_size());
    out.counter("disparityd_client_connections_total", "Clients of the socket that have connected.", totals.clients());
    out.counter("disparityd_client_frames_sent_total", "Frames sent to all clients of the socket together.",
                totals.client_frames_sent());
    out.counter("disparityd_client_frames_skipped_total",
                "Frames not sent to a client of the socket: too slow, or it wanted fewer.",
                totals.client_frames_skipped());
    out.counter("disparityd_client_sent_bytes_total", "Bytes sent to all clients of the socket together.",
                totals.client_bytes_sent());
}

void put_web(Exposition& out, const WebCounters& web) {
    out.gauge("disparity_web_clients", "Pages and viewers that this server sends frames to.",
              static_cast<double>(web.clients));
    out.counter("disparity_web_sent_bytes_total", "Bytes that this server has sent.", web.bytes_sent);
    out.counter("disparity_web_frames_sent_total", "Frames that this server has sent to all its clients together.",
                web.frames_sent);
    out.counter("disparity_web_frames_skipped_total",
                "Frames that this server has not sent to a client: too slow, or it wanted fewer.", web.frames_skipped);
    out.counter("disparity_web_requests_total", "HTTP requests to this server.", web.requests);
    out.counter("disparity_web_requests_refused_total", "HTTP requests that this server answered by an error.",
                web.refused);
}

}  // namespace

std::string prometheus_text(const v1::Status* status, const WebCounters& web) {
    Exposition out;
    out.gauge("disparityd_up", "Whether the daemon answers.", status != nullptr ? 1 : 0);
    if (status != nullptr) {
        put_state(out, *status);
        put_totals(out, status->totals());
        put_clients(out, *status);
        put_recording(out, status->record());
        if (status->has_camera()) {
            put_camera(out, status->camera());
        }
        if (status->has_sensors()) {
            put_sensors(out, status->sensors());
        }
        if (status->has_self_calibration()) {
            put_self_calibration(out, status->self_calibration());
        }
    }
    put_web(out, web);
    return out.take();
}

}  // namespace disparityd::web
