// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/camera_control.h"

#include <stdexcept>
#include <utility>

#include "base/failure_text.h"
#include "daemon/requests/camera_message.h"

namespace disparityd::daemon {

void CameraControlService::ask(const v1::CameraRequest& request, Answer answer) {
    do_in(worker_, "a request about the camera is not answered", [this, request, answer = std::move(answer)] {
        v1::CameraControls controls;
        std::string refusal;
        try {
            const auto engine = engine_();
            if (!engine) {
                throw std::runtime_error("camera: the source is being prepared");
            }
            controls = to_message(engine->control_camera(to_settings(request)));
        } catch (const std::exception& error) {
            refusal = base::failure_text(error);
        }
        answer(controls, refusal);
    });
}

}  // namespace disparityd::daemon
