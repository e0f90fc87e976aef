// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/live_daemon.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <stdexcept>

#include <time.h>

#include "tests/vm/camera/test_pattern.h"

namespace vm_guest {

namespace {

std::vector<std::string> arguments(const std::string& uri, const std::string& name,
                                   const std::vector<std::string>& more) {
    std::vector<std::string> all{"--source", uri, "--name", name, "--print-address"};
    std::vector<std::string> settings{
        "socket.tcp=127.0.0.1:0", "socket.unix=",         "socket.tcp_control=true", "source.allow_unrectified=true",
        "match.method=sad",       "match.disparities=16", "match.depth=false"};
    settings.insert(settings.end(), more.begin(), more.end());
    for (const std::string& each : settings) {
        all.insert(all.end(), {"--set", each});
    }
    return all;
}

std::string unused_name() {
    static int daemons = 0;
    return "vm" + std::to_string(++daemons);
}

}  // namespace

std::int64_t monotonic_ns() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

LiveDaemon::LiveDaemon(const std::string& uri, const std::string& program, const std::vector<std::string>& settings)
    : name_(unused_name()), process_(folder_, arguments(uri, name_, settings), {}, program) {
    if (!process_.wait_until_ready(3 * patience)) {
        throw std::runtime_error("the daemon did not start: " + process_.log());
    }
    client_.emplace(process_.address("tcp:"), "never reconnects", patience);
    disparity::Subscription subscription;
    subscription.products = {disparity::Product::left};
    subscription.status_interval_s = 0.1;
    client_->subscribe(subscription);
}

void LiveDaemon::read_once() {
    switch (client_->read(frame_, milliseconds(20))) {
        case disparity::ReadResult::frame: ++frames_; break;
        case disparity::ReadResult::timeout: break;
        case disparity::ReadResult::gone:
            // An emulated machine may be silent for longer than a client waits; the next read connects anew.
            if (!client_->unanswered()) {
                throw std::runtime_error("the client lost the daemon: " + client_->why_gone() + "\n" + process_.log());
            }
            break;
    }
    if (const std::string bytes = client_->take_status(); !bytes.empty()) {
        newest_.emplace();
        if (!newest_->ParseFromString(bytes)) {
            throw std::runtime_error("a status that cannot be read");
        }
    }
}

bool LiveDaemon::wait_for(const std::function<bool(const Status&)>& condition) {
    newest_.reset();
    return eventually([&] {
        read_once();
        return newest_ && condition(*newest_);
    });
}

bool LiveDaemon::wait_for_camera(const std::string& state) {
    return wait_for([&](const Status& status) { return status.camera().state() == state; });
}

bool LiveDaemon::wait_for_new_frame() {
    const std::int64_t begin = monotonic_ns();
    const std::uint64_t frames = frames_;
    return eventually([&] {
        read_once();
        return frames_ > frames && frame_.monotonic_ns > begin;
    });
}

bool LiveDaemon::recovers() {
    if (!wait_for_camera("streaming") || !wait_for_new_frame()) {
        return false;
    }
    const std::int64_t begin = frame_.monotonic_ns;
    while (frame_.monotonic_ns < begin + 2'500'000'000) {
        if (!wait_for_new_frame()) {
            return false;
        }
    }
    return true;
}

void LiveDaemon::reload() {
    const std::string taken_over = " serving v4l2";
    const auto chains = [&] {
        const std::string log = process_.log();
        int count = 0;
        for (auto at = log.find(taken_over); at != std::string::npos; at = log.find(taken_over, at + 1)) {
            ++count;
        }
        return count;
    };
    const int before = chains();
    process_.send_signal(SIGHUP);
    if (!eventually([&] {
            read_once();
            return chains() > before;
        })) {
        throw std::runtime_error("the daemon did not load its configuration again: " + process_.log());
    }
}

LiveDaemon::Status LiveDaemon::status() {
    Status status;
    if (!status.ParseFromString(client_->status(patience))) {
        throw std::runtime_error("a status that cannot be read");
    }
    return status;
}

LiveDaemon::Resources LiveDaemon::resources() const {
    const auto entries = [](const std::string& folder) {
        return static_cast<long>(std::distance(std::filesystem::directory_iterator(folder), {}));
    };
    const std::string process = "/proc/" + std::to_string(process_.pid());
    Resources found{entries(process + "/fd"), 0, entries(process + "/task")};
    std::ifstream maps(process + "/maps");
    std::string line;
    while (std::getline(maps, line)) {
        found.video_maps += line.find("/dev/video") != std::string::npos ? 1 : 0;
    }
    return found;
}

bool LiveDaemon::comes_back_to(const Resources& before) {
    return eventually([&] {
        read_once();
        return resources() == before;
    });
}

std::string in_words(const LiveDaemon::Status& status) {
    const auto& camera = status.camera();
    return "status: " + status.state() + " (" + status.detail() + "), camera " + camera.state() + ", " +
           std::to_string(status.published()) + " published, " + std::to_string(status.lost()) + " lost, " +
           std::to_string(camera.restarts()) + " restarts, " + std::to_string(camera.reopens()) + " reopens, " +
           std::to_string(camera.resets()) + " resets";
}

std::ostream& operator<<(std::ostream& out, const LiveDaemon::Resources& resources) {
    return out << resources.descriptors << " descriptors, " << resources.video_maps << " maps, " << resources.threads
               << " threads";
}

std::optional<std::uint32_t> number_of_left_picture(const disparity::PlaneData& left) {
    // Luma is every second byte of a row, and a row of the camera's holds both eyes.
    const auto is_pixel_of = [&](std::uint32_t number, std::size_t x, std::size_t y) {
        const std::size_t index = y * 4 * left.width + 2 * x;
        return left.bytes[y * left.width + x] == simulated_camera::pattern_byte(number, index);
    };
    const auto is_row_of = [&](std::uint32_t number, std::size_t y, std::size_t pixels) {
        for (std::size_t x = 0; x < pixels; ++x) {
            if (!is_pixel_of(number, x, y)) {
                return false;
            }
        }
        return true;
    };
    for (std::uint32_t number = left.bytes.at(0); number < 65536; number += 256) {
        if (is_row_of(number, 0, 16)) {
            for (std::size_t y = 0; y < left.height; ++y) {
                if (!is_row_of(number, y, left.width)) {
                    return std::nullopt;
                }
            }
            return number;
        }
    }
    return std::nullopt;
}

}  // namespace vm_guest
