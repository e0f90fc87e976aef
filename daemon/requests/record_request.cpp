// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/record_request.h"

#include <chrono>
#include <utility>

#include "daemon/requests/recording_control.h"

namespace disparityd::daemon {
namespace {

bool always(const v1::Envelope&) {
    return true;
}

RecordingControl::Answer told_by(Reply reply) {
    return [reply = std::move(reply)](const v1::RecordStatus& status, const std::string& refusal) {
        reply(refusal.empty() ? answer_of([&](v1::Envelope& answer) { *answer.mutable_record_status() = status; })
                              : refusal_of(refusal));
    };
}

}  // namespace

Request record_start_request(RecordingControl& recording) {
    return {
        .message = v1::Envelope::kRecordStart,
        .name = "record_start",
        .word = "record",
        .changes_something = always,
        .rate = std::make_shared<RateLimit>(5, std::chrono::seconds(1)),  // each makes a file, and a line in the log
        .handle =
            [&recording](const v1::Envelope& message, const Requester& requester, Reply reply) {
                recording.start({message.record_start().path(), requester.owns_daemon, requester.client},
                                told_by(std::move(reply)));
            },
        .goes_on_for = [&recording](std::uint64_t client) { return recording.is_recording_for(client); },
        .client_is_gone = [&recording](std::uint64_t client) { recording.client_is_gone(client); }};
}

Request record_stop_request(RecordingControl& recording) {
    return {.message = v1::Envelope::kRecordStop,
            .name = "record_stop",
            .word = "record",
            .changes_something = always,
            .handle = [&recording](const v1::Envelope&, const Requester&, Reply reply) {
                recording.stop(told_by(std::move(reply)));
            }};
}

}  // namespace disparityd::daemon
