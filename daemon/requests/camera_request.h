// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "daemon/engine.h"
#include "daemon/one_thread.h"
#include "daemon/requests/request.h"

namespace disparityd::daemon {

/// Controls of the live camera, at most 64 in a request: all who may look may ask for them, who may control sets them.
/// Requests wait for the camera in a thread of their own.
class CameraControlService {
public:
    /// `engine` gives the running engine or nullptr; any thread.
    explicit CameraControlService(std::function<std::shared_ptr<Engine>()> engine) : engine_(std::move(engine)) {}
    ~CameraControlService() { stop(); }
    CameraControlService(const CameraControlService&) = delete;
    CameraControlService& operator=(const CameraControlService&) = delete;

    /// Any thread; the reply comes in that of this object, or at once.
    void ask(const v1::CameraRequest& request, Reply reply);

    /// Waits for what has been asked; nothing may be asked after. Safe to call twice.
    void stop() { worker_.join(); }

private:
    std::function<std::shared_ptr<Engine>()> engine_;
    boost::asio::thread_pool worker_ = one_thread();
};

/// Returns the request of clients, which `camera` must outlive.
Request camera_request(CameraControlService& camera);

}  // namespace disparityd::daemon
