// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/camera_request.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "base/failure_text.h"
#include "daemon/requests/camera_message.h"

namespace disparityd::daemon {

Request camera_request(CameraControlService& camera) {
    return {
        .message = v1::Envelope::kCameraRequest,
        .name = "camera_request",
        .word = "camera",
        .changes_something = [](const v1::Envelope& message) { return message.camera_request().settings_size() > 0; },
        .handle = [&camera](const v1::Envelope& message, const Requester&,
                            Reply reply) { camera.ask(message.camera_request(), std::move(reply)); }};
}

void CameraControlService::ask(const v1::CameraRequest& request, Reply reply) {
    constexpr int most_settings = 64;
    if (request.settings_size() > most_settings) {
        reply(refusal_of(
            fmt::format("camera: found {} settings, allowed: at most {}", request.settings_size(), most_settings)));
        return;
    }
    do_in(worker_, "a request about the camera is not answered", [this, request, reply = std::move(reply)] {
        Answer answer;
        try {
            const auto engine = engine_();
            if (!engine) {
                throw std::runtime_error("camera: the source is being prepared");
            }
            *answer.messages.emplace_back().mutable_camera_controls() =
                to_message(engine->control_camera(to_settings(request)));
        } catch (const std::exception& error) {
            answer = refusal_of(base::failure_text(error));
        }
        reply(std::move(answer));
    });
}

}  // namespace disparityd::daemon
