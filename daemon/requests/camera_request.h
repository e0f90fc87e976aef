// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "daemon/engine.h"
#include "daemon/one_thread.h"

namespace disparityd::daemon {

/// Controls of the live camera for clients: requests wait for the camera in a thread of their own.
class CameraControlService {
public:
    /// Called in that thread.
    using Answer = std::function<void(const v1::CameraControls& controls, const std::string& refusal)>;

    /// `engine` gives the running engine or nullptr; any thread.
    explicit CameraControlService(std::function<std::shared_ptr<Engine>()> engine) : engine_(std::move(engine)) {}
    ~CameraControlService() { stop(); }
    CameraControlService(const CameraControlService&) = delete;
    CameraControlService& operator=(const CameraControlService&) = delete;

    /// Any thread.
    void ask(const v1::CameraRequest& request, Answer answer);

    /// Waits for what has been asked; nothing may be asked after. Safe to call twice.
    void stop() { worker_.join(); }

private:
    std::function<std::shared_ptr<Engine>()> engine_;
    boost::asio::thread_pool worker_ = one_thread();
};

}  // namespace disparityd::daemon
