// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>

#include "clients/json/message_json.h"
#include "clients/json/sensor_json.h"
#include "proto/disparity.pb.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/daemon.h"

namespace disparityd::tools {
namespace {

using json::to_text;
using std::chrono::steady_clock;

struct SensorArguments {
    DaemonArguments daemon;
    std::optional<int> lines;
    bool json = false;
};

/// Counts the samples of a second and keeps the newest value of each kind.
struct Second {
    std::uint64_t samples = 0;
    std::uint64_t skipped = 0;
    std::uint64_t lost = 0;
    disparity::SensorSample newest;

    void add(const disparity::SensorBatch& batch) {
        samples += batch.samples.size();
        skipped += batch.skipped;
        for (const disparity::SensorSample& sample : batch.samples) {
            lost += sample.lost_before;
            const auto keep = [](const auto& from, auto& to) { to = from ? from : to; };
            keep(sample.inertial, newest.inertial);
            keep(sample.magnetic_field, newest.magnetic_field);
            keep(sample.environment, newest.environment);
            keep(sample.eye_temperatures, newest.eye_temperatures);
        }
    }
};

std::string vector_text(const disparity::SensorVector& vector) {
    char text[64];
    std::snprintf(text, sizeof text, "%8.3f %8.3f %8.3f", static_cast<double>(vector.x), static_cast<double>(vector.y),
                  static_cast<double>(vector.z));
    return text;
}

/// Prints the line of a second. Text of the daemon goes through std::cout, which makes it printable.
void print_second(const Second& second, double seconds, double since_start, const std::string& why) {
    std::array<char, 256> text{};
    const auto print = [&text](const char* format, auto... values) {
        std::snprintf(text.data(), text.size(), format, values...);
        std::cout << text.data();
    };
    if (second.samples == 0) {
        print("%5.0f s          -  no sample: ", since_start);
        std::cout << why << '\n';
        return;
    }
    const disparity::Inertial inertial = second.newest.inertial.value_or(disparity::Inertial{});
    print("%5.0f s %10.1f  %s  %s %7.1f %7llu %7llu", since_start, static_cast<double>(second.samples) / seconds,
          vector_text(inertial.angular_velocity).c_str(), vector_text(inertial.acceleration).c_str(),
          static_cast<double>(inertial.celsius), static_cast<unsigned long long>(second.lost),
          static_cast<unsigned long long>(second.skipped));
    if (const auto& field = second.newest.magnetic_field) {
        print("  field %s uT", vector_text(*field).c_str());
    }
    if (const auto& air = second.newest.environment) {
        print("  %.1f C, %.2f hPa, %.0f %%", static_cast<double>(air->celsius), static_cast<double>(air->hectopascal),
              static_cast<double>(air->humidity_percent));
    }
    if (const auto& eyes = second.newest.eye_temperatures) {
        print("  eyes %.1f, %.1f C", static_cast<double>(eyes->left_celsius), static_cast<double>(eyes->right_celsius));
    }
    std::cout << '\n';
}

/// Reads samples of a source that has sensors.
class SampleReader {
public:
    /// Subscribes. Throws std::runtime_error with one line where the source has no sensors: at once for a live camera,
    /// after frames without samples for a replay.
    explicit SampleReader(disparity::SocketClient& client) : client_(client) {
        const v1::Status before = daemon_status(client_);
        if (before.has_camera() && !before.has_sensors() && !before.camera().model().empty()) {
            throw std::runtime_error(
                "the camera " + before.camera().model() +
                " has no sensors, or [source] sensors is false; a ZED Mini, ZED 2 and ZED 2i have");
        }
        subscribe();
        while (!before.has_camera() && !interrupted() && first_.samples.empty()) {
            first_ = read(patience);
            if (first_.samples.empty()) {
                check_replay(before, daemon_status(client_));
            }
        }
    }

    /// Returns the next batch; an empty one after a tenth of a second, so that Ctrl-C takes effect.
    disparity::SensorBatch next(steady_clock::time_point deadline) {
        if (!first_.samples.empty()) {
            return std::exchange(first_, {});
        }
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now());
        return read(std::clamp(left, std::chrono::milliseconds(0), patience));
    }

    /// Returns why no sample comes, from the daemon's status.
    std::string why_none() {
        const v1::Status now = daemon_status(client_);
        if (now.has_sensors() && now.sensors().state() != "streaming") {
            return "the sensors are " + now.sensors().state() +
                   (now.sensors().detail().empty() ? "" : ": " + now.sensors().detail());
        }
        return now.detail().empty() ? "the daemon is " + now.state() : now.detail();
    }

private:
    static constexpr std::chrono::milliseconds patience{100};

    void subscribe() {
        disparity::Subscription subscription;
        subscription.products.clear();
        subscription.sensors = true;
        client_.subscribe(subscription);
    }

    disparity::SensorBatch read(std::chrono::milliseconds timeout) {
        disparity::SensorBatch batch;
        switch (client_.read_sensors(batch, timeout)) {
            case disparity::ReadResult::frame: break;
            case disparity::ReadResult::timeout: batch = {}; break;
            case disparity::ReadResult::gone: throw std::runtime_error("the daemon has stopped");
        }
        return batch;
    }

    /// A recording of a camera with sensors has samples in nearly every frame.
    static void check_replay(const v1::Status& before, const v1::Status& now) {
        constexpr std::uint64_t enough = 10;
        if (now.published() >= before.published() + enough) {
            throw std::runtime_error(now.source() + " has no sensors: " + std::to_string(enough) +
                                     " frames came without a sample");
        }
        if (now.state() == "ended") {
            throw std::runtime_error("no sample comes: " + now.detail());
        }
    }

    disparity::SocketClient& client_;
    disparity::SensorBatch first_;
};

void show_samples(SampleReader& samples, std::optional<int> most) {
    std::string told;
    auto last = steady_clock::now();
    for (int lines = 0; !interrupted();) {
        const disparity::SensorBatch batch = samples.next(steady_clock::now() + std::chrono::seconds(1));
        if (!batch.samples.empty()) {
            last = steady_clock::now();
        } else if (steady_clock::now() >= last + std::chrono::seconds(1)) {
            last = steady_clock::now();
            if (const std::string why = samples.why_none(); why != std::exchange(told, why)) {
                print_note("no sample: " + why);
            }
        }
        for (std::size_t i = 0; i < batch.samples.size(); ++i, ++lines) {
            if (most && lines >= *most) {
                return;
            }
            std::cout << to_text(json::to_json(batch.samples[i], i == 0 ? batch.skipped : 0), -1) << '\n';
        }
        std::cout.flush();
    }
}

void show_seconds(SampleReader& samples, std::optional<int> most) {
    std::cout << "   time  samples/s     turning, rad/s: x y z            acceleration, m/s2: x y z  IMU, C    lost "
                 "skipped\n";
    Second second;
    const auto start = steady_clock::now();
    auto last = start;
    for (int lines = 0; (!most || lines < *most) && !interrupted();) {
        second.add(samples.next(last + std::chrono::seconds(1)));
        const auto now = steady_clock::now();
        if (now >= last + std::chrono::seconds(1)) {
            print_second(second, std::chrono::duration<double>(now - last).count(),
                         std::chrono::duration<double>(now - start).count(),
                         second.samples == 0 ? samples.why_none() : "");
            std::cout.flush();
            second = {};
            last = now;
            ++lines;
        }
    }
}

int sensors(const SensorArguments& arguments) {
    disparity::Client client = connect(arguments.daemon);
    catch_interrupts();
    SampleReader samples(client.socket());
    if (arguments.json) {
        show_samples(samples, arguments.lines);
    } else {
        show_seconds(samples, arguments.lines);
    }
    return exit_done;
}

}  // namespace

void add_sensors(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "sensors", "Show what the sensors of a running daemon's camera measure: motion, temperature, air.");
    const auto arguments = std::make_shared<SensorArguments>();
    arguments->daemon.add_to(command);
    add_integer(command, "--count", arguments->lines, 1, 1'000'000'000,
                "stop after this many lines; default: Ctrl-C stops");
    command.add_flag("--json", arguments->json, "every sample, one JSON object per line");
    command.footer(
        "Without --json: one line per second with the newest values. The source is a live camera that has sensors\n"
        "(ZED Mini, ZED 2, ZED 2i), a recording of one, a bag or a folder of EuRoC. The values are those of the "
        "sensors,\n"
        "along their axes, not calibrated. lost: samples that the daemon lost; skipped: those that came faster than "
        "they were read here.\n"
        "Ctrl-C ends it, exit status 0; 1 when the source has no sensors.\n"
        "Examples: disparityctl sensors --count 10\n"
        "          disparityctl sensors --json | jq -c '[.monotonic_ns, .acceleration]'");
    command.callback([arguments, &action] { action = [arguments] { return sensors(*arguments); }; });
}

}  // namespace disparityd::tools
