// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/daemon_control.h"

#include <chrono>
#include <exception>
#include <stdexcept>

#include <boost/asio/post.hpp>

#include "base/start_thread.h"
#include "clients/json/message_json.h"
#include "proto/disparity.pb.h"

namespace disparityd::web {
namespace {

constexpr std::chrono::seconds answer_patience{5};
/// Before a recording is closed, the frames that wait are written.
constexpr std::chrono::seconds patience_for_files{60};

template <typename Message>
std::string json_of(const std::string& bytes) {
    Message message;
    if (!message.ParseFromString(bytes)) {
        throw std::runtime_error("the daemon's answer is damaged or of another version");
    }
    return json::to_text(json::to_json(message), -1);
}

}  // namespace

DaemonControl::DaemonControl(DaemonAddress daemon) : daemon_(std::move(daemon)) {
    constexpr int requests_at_once = 2;
    try {
        for (int i = 0; i < requests_at_once; ++i) {
            threads_.push_back(base::start_thread([this] { requests_.run(); }));
        }
    } catch (...) {
        end();
        throw;
    }
}

void DaemonControl::end() {
    requests_.stop();
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

void DaemonControl::ask(Request request, Answer answer) {
    boost::asio::post(requests_, [this, request = std::move(request), answer = std::move(answer)] {
        ControlAnswer result;
        try {
            disparity::Client client = daemon_.connect("control", no_frames());
            result = {true, request(client.socket())};
        } catch (const std::exception& error) {
            result.text = error.what();
        }
        answer(result);
    });
}

void DaemonControl::set_controls(const std::vector<std::pair<std::string, std::int64_t>>& settings, Answer answer) {
    ask(
        [settings](disparity::SocketClient& client) {
            return json_of<v1::CameraControls>(client.control_camera(settings, answer_patience));
        },
        std::move(answer));
}

void DaemonControl::start_recording(const std::string& path, Answer answer) {
    ask(
        [path](disparity::SocketClient& client) {
            return json_of<v1::RecordStatus>(client.start_recording(path, answer_patience));
        },
        std::move(answer));
}

void DaemonControl::stop_recording(Answer answer) {
    ask(
        [](disparity::SocketClient& client) {
            return json_of<v1::RecordStatus>(client.stop_recording(patience_for_files));
        },
        std::move(answer));
}

}  // namespace disparityd::web
